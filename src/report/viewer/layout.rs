//! How the viewer opens: 3-D and verdict at the left, plots in tabs at the right, the whole run in view, paused.

use super::blueprint::{Blueprint, DOCUMENT, Part, Placement, SPATIAL, TEXT_LOG, TIME_SERIES};
use super::rrd::{Archetype, RrdFile, flag, interval, nanoseconds, numbers, texts, tuples};
use super::{Film, Quantity, part};
use crate::robot::Robot;
use arrow_array::types::{Float32Type, Float64Type, UInt8Type, UInt32Type};
use std::io::{self, Write};

const BACKGROUND: Archetype = Archetype("blueprint.archetypes.Background");
const EYE: Archetype = Archetype("blueprint.archetypes.EyeControls3D");
const LEGEND: Archetype = Archetype("blueprint.archetypes.PlotLegend");
const PANEL: Archetype = Archetype("blueprint.archetypes.PanelBlueprint");
const TIME_AXIS: Archetype = Archetype("blueprint.archetypes.TimeAxis");
const TIME_PANEL: Archetype = Archetype("blueprint.archetypes.TimePanelBlueprint");

/// States of panels, in the viewer's numbers.
const HIDDEN: u8 = 1;
const COLLAPSED: u8 = 2;

/// Everything below an origin.
const BELOW_ORIGIN: &str = "$origin/**";

/// Plots next to each other in a tab.
const COLUMNS: u32 = 2;

/// Behind the arm.
const BACKGROUND_RGBA: [u8; 4] = [30, 34, 40, 255];

/// Writes the layout of `film`.
pub(super) fn send(file: &mut RrdFile<impl Write>, film: &Film) -> io::Result<()> {
    let mut layout = Blueprint::new(file)?;
    let left = left(&mut layout, film)?;
    let mut tabs: Vec<Part> = Vec::new();
    for quantity in Quantity::ALL {
        let joints = (0..film.robot.dof())
            .filter(|&joint| film.signals.iter().any(|signal| signal.quantity == quantity && signal.joint == joint));
        let plots = joints.map(|joint| plot(&mut layout, film, quantity, joint)).collect::<io::Result<Vec<Part>>>()?;
        if !plots.is_empty() {
            let columns = if plots.len() < 4 { 1 } else { COLUMNS };
            tabs.push(layout.container(Placement::Grid(columns), Some(quantity.title()), &plots)?);
        }
    }
    tabs.push(layout.view(TEXT_LOG, "Findings in time", "/findings", BELOW_ORIGIN)?);
    let right = layout.container(Placement::Tabs, None, &tabs)?;
    let root = layout.container(Placement::Horizontal(&[2.0, 3.0]), None, &[left, right])?;
    panels(&mut layout)?;
    layout.show(&root)
}

fn left(layout: &mut Blueprint<impl Write>, film: &Film) -> io::Result<Part> {
    const SOLID_COLOR: u8 = 3;
    let arm = layout.view(SPATIAL, "Arm", "/arm", "/arm/**")?;
    eye(layout, &arm, film.robot)?;
    let color = numbers::<UInt32Type>([u32::from_be_bytes(BACKGROUND_RGBA)]);
    let kind = numbers::<UInt8Type>([SOLID_COLOR]);
    let background = [
        BACKGROUND.component("kind", "blueprint.components.BackgroundKind", kind),
        BACKGROUND.component("color", "components.Color", color),
    ];
    layout.property(&arm, "Background", &background)?;
    let verdict = layout.view(DOCUMENT, "Verdict", "/verdict", BELOW_ORIGIN)?;
    layout.container(Placement::Vertical(&[3.0, 2.0]), None, &[arm, verdict])
}

fn plot(layout: &mut Blueprint<impl Write>, film: &Film, quantity: Quantity, joint: usize) -> io::Result<Part> {
    // A linked axis would ignore the range.
    const INDEPENDENT: u8 = 1;
    let name = &film.robot.joints[joint].name;
    let origin = format!("/{}/{}", quantity.name(), part(name));
    let title = format!("{name}, {}", quantity.unit(film.robot, joint));
    let view = layout.view(TIME_SERIES, &title, &origin, BELOW_ORIGIN)?;
    let [from, to] = film.span().map(nanoseconds);
    let axis = [
        TIME_AXIS.component("link", "blueprint.components.LinkAxis", numbers::<UInt8Type>([INDEPENDENT])),
        TIME_AXIS.component("view_range", "blueprint.components.TimeRange", interval(from, to)),
    ];
    layout.property(&view, "TimeAxis", &axis)?;
    // One legend for all: the lines look alike in every plot.
    let visible = LEGEND.component("visible", "components.Visible", flag(joint == 0));
    layout.property(&view, "PlotLegend", &[visible])?;
    Ok(view)
}

/// A camera that has the whole reach of the arm in view.
fn eye(layout: &mut Blueprint<impl Write>, view: &Part, robot: &Robot) -> io::Result<()> {
    let reach: f64 =
        robot.joints.iter().map(|joint| joint.origin.translation.norm()).sum::<f64>() + robot.flange.translation.norm();
    let scaled = |vector: [f64; 3]| tuples::<Float32Type, 3>([vector.map(|part| (part * reach) as f32)]);
    let eye = [
        EYE.component("position", "components.Position3D", scaled([0.85, -0.95, 0.6])),
        EYE.component("look_target", "components.Position3D", scaled([0.1, 0.0, 0.3])),
        EYE.component("eye_up", "components.Vector3D", tuples::<Float32Type, 3>([[0.0, 0.0, 1.0]])),
    ];
    layout.property(view, "EyeControls3D", &eye)
}

fn panels(layout: &mut Blueprint<impl Write>) -> io::Result<()> {
    const PAUSED: u8 = 1;
    let state = |panel: Archetype, state: u8| {
        panel.component("state", "blueprint.components.PanelState", numbers::<UInt8Type>([state]))
    };
    layout.log("/blueprint_panel", &[state(PANEL, HIDDEN)])?;
    layout.log("/selection_panel", &[state(PANEL, HIDDEN)])?;
    let time = [
        state(TIME_PANEL, COLLAPSED),
        TIME_PANEL.component("timeline", "blueprint.components.TimelineName", texts(["time"])),
        TIME_PANEL.component("play_state", "blueprint.components.PlayState", numbers::<UInt8Type>([PAUSED])),
        TIME_PANEL.component("fps", "blueprint.components.Fps", numbers::<Float64Type>([60.0])),
    ];
    layout.log("/time_panel", &time)
}
