//! A blueprint, which gives the viewer its layout: views with their properties, in containers.

use super::rrd::{Archetype, Component, Index, RrdFile, Store, StoreKind, flag, numbers, texts, tuples, uuid};
use arrow_array::types::{Float32Type, UInt8Type, UInt32Type};
use std::io::{self, Write};

const VIEW: Archetype = Archetype("blueprint.archetypes.ViewBlueprint");
const CONTENTS: Archetype = Archetype("blueprint.archetypes.ViewContents");
const CONTAINER: Archetype = Archetype("blueprint.archetypes.ContainerBlueprint");
const VIEWPORT: Archetype = Archetype("blueprint.archetypes.ViewportBlueprint");

/// Kinds of views.
pub(super) const SPATIAL: &str = "3D";
pub(super) const DOCUMENT: &str = "TextDocument";
pub(super) const TEXT_LOG: &str = "TextLog";
pub(super) const TIME_SERIES: &str = "TimeSeries";

/// How a container places what is in it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Placement<'a> {
    /// One at a time.
    Tabs,
    /// Side by side, with their shares of the width.
    Horizontal(&'a [f32]),
    /// One below the other, with their shares of the height.
    Vertical(&'a [f32]),
    /// In rows and so many columns.
    Grid(u32),
}

/// A view or a container.
#[derive(Debug, Clone)]
pub(super) struct Part {
    id: u128,
    path: String,
}

/// A blueprint that is being written.
pub(super) struct Blueprint<'a, W> {
    file: &'a mut RrdFile<W>,
    store: Store,
    at: [Index; 2],
}

impl<'a, W: Write> Blueprint<'a, W> {
    /// Begins a blueprint.
    pub(super) fn new(file: &'a mut RrdFile<W>) -> io::Result<Self> {
        let store = file.store(StoreKind::Blueprint, None)?;
        // The timelines of the viewer's own blueprints.
        let at = [Index::number("blueprint", 0), Index::date("log_time", file.ids().start())];
        Ok(Blueprint { file, store, at })
    }

    /// Adds a view of what `contents` selects.
    pub(super) fn view(&mut self, kind: &str, name: &str, origin: &str, contents: &str) -> io::Result<Part> {
        let part = self.part("view");
        let query = CONTENTS.component("query", "blueprint.components.QueryExpression", texts([contents]));
        self.log(&format!("{}/ViewContents", part.path), &[query])?;
        let components = [
            VIEW.component("class_identifier", "blueprint.components.ViewClass", texts([kind])),
            VIEW.component("display_name", "components.Name", texts([name])),
            VIEW.component("space_origin", "blueprint.components.ViewOrigin", texts([origin])),
        ];
        self.log(&part.path, &components)?;
        Ok(part)
    }

    /// Sets a property of a view.
    pub(super) fn property(&mut self, view: &Part, name: &str, components: &[Component]) -> io::Result<()> {
        self.log(&format!("{}/{name}", view.path), components)
    }

    /// Adds a container of `parts`.
    pub(super) fn container(&mut self, placement: Placement, name: Option<&str>, parts: &[Part]) -> io::Result<Part> {
        let part = self.part("container");
        let paths = parts.iter().map(|part| &part.path);
        let shares = |field, kind, shares: &[f32]| {
            CONTAINER.component(field, kind, numbers::<Float32Type>(shares.iter().copied()))
        };
        let (kind, placed) = match placement {
            Placement::Tabs => (1, None),
            Placement::Horizontal(widths) => {
                (2, Some(shares("col_shares", "blueprint.components.ColumnShare", widths)))
            }
            Placement::Vertical(heights) => (3, Some(shares("row_shares", "blueprint.components.RowShare", heights))),
            Placement::Grid(columns) => {
                let columns = numbers::<UInt32Type>([columns]);
                (4, Some(CONTAINER.component("grid_columns", "blueprint.components.GridColumns", columns)))
            }
        };
        let kind = numbers::<UInt8Type>([kind]);
        let mut components = vec![
            CONTAINER.component("container_kind", "blueprint.components.ContainerKind", kind),
            CONTAINER.component("contents", "blueprint.components.IncludedContent", texts(paths)),
        ];
        components.extend(name.map(|name| CONTAINER.component("display_name", "components.Name", texts([name]))));
        components.extend(placed);
        self.log(&part.path, &components)?;
        Ok(part)
    }

    /// Adds rows of a panel or another part that the viewer knows by its path.
    pub(super) fn log(&mut self, path: &str, components: &[Component]) -> io::Result<()> {
        self.file.log(&self.store, path, &self.at, components)
    }

    /// Makes `root` the whole layout, and shows it.
    pub(super) fn show(mut self, root: &Part) -> io::Result<()> {
        let id = tuples::<UInt8Type, 16>([root.id.to_be_bytes()]);
        let components = [
            VIEWPORT.component("root_container", "blueprint.components.RootContainer", id),
            VIEWPORT.component("auto_layout", "blueprint.components.AutoLayout", flag(false)),
            VIEWPORT.component("auto_views", "blueprint.components.AutoViews", flag(false)),
        ];
        self.log("/viewport", &components)?;
        self.file.activate(&self.store)
    }

    fn part(&mut self, kind: &str) -> Part {
        let id = self.file.ids().other();
        Part { id, path: format!("/{kind}/{}", uuid(id)) }
    }
}
