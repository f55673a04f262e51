//! How the viewer opens: 3-D and verdict at the left, plots in tabs at the right, the whole run in view, paused.

use super::{Film, Quantity, part};
use crate::robot::Robot;
use rerun::blueprint::components::{BackgroundKind, LinkAxis, PanelState, PlayState};
use rerun::blueprint::{
    Blueprint, BlueprintActivation, BlueprintPanel, ContainerLike, Grid, Horizontal, SelectionPanel, Spatial3DView,
    Tabs, TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical,
};
use rerun::external::re_log_types::{BlueprintActivationCommand, StoreKind};
use rerun::external::re_sdk_types::blueprint::archetypes::{Background, EyeControls3D, PlotLegend, TimeAxis};
use rerun::log::LogMsg;
use rerun::{AsComponents, RecordingStream, RecordingStreamBuilder, RecordingStreamResult};

/// Plots next to each other in a tab.
const COLUMNS: u32 = 2;

/// Behind the arm.
const BACKGROUND: [u8; 3] = [30, 34, 40];

/// Properties of views, for which the blueprint has no typed interface: entity path in the blueprint, and what it holds.
type Properties = Vec<(String, Box<dyn AsComponents>)>;

/// Sends the layout of `film` to its recording.
pub(super) fn send(stream: &RecordingStream, film: &Film) -> RecordingStreamResult<()> {
    let mut properties = Properties::new();
    let blueprint = blueprint(film, &mut properties);

    // Views can only be given properties through the blueprint's own store, so the messages pass by here.
    let application = stream.store_info().map(|info| info.application_id().clone());
    let (passing, storage) = RecordingStreamBuilder::new(application.unwrap_or_else(|| "tauscope".into())).memory()?;
    blueprint.send(&passing, BlueprintActivation::default())?;
    let is_layout = |message: &LogMsg| message.store_id().kind() == StoreKind::Blueprint;
    let (mut messages, mut id) = (Vec::new(), None);
    for message in storage.take().into_iter().filter(is_layout) {
        id.get_or_insert_with(|| message.store_id().clone());
        if !matches!(message, LogMsg::BlueprintActivationCommand(_)) {
            messages.push(message);
        }
    }
    let Some(id) = id else { return Ok(()) };
    let (own, storage) = RecordingStreamBuilder::from_store_id(&id).blueprint().memory()?;
    own.set_time_sequence("blueprint", 0);
    for (path, archetype) in &properties {
        own.log(path.as_str(), archetype.as_ref())?;
    }
    messages.extend(storage.take().into_iter().filter(|message| matches!(message, LogMsg::ArrowMsg(..))));
    stream.send_blueprint(messages, BlueprintActivationCommand::make_active(id));
    Ok(())
}

fn blueprint(film: &Film, properties: &mut Properties) -> Blueprint {
    let arm: ContainerLike = Spatial3DView::new("Arm").with_origin("/arm").with_contents(["/arm/**"]).into();
    property(properties, &arm, "EyeControls3D", eye(film.robot));
    let [r, g, b] = BACKGROUND;
    let background = Background::new(BackgroundKind::SolidColor).with_color(rerun::Color::from_rgb(r, g, b));
    property(properties, &arm, "Background", background);
    let verdict: ContainerLike = TextDocumentView::new("Verdict").with_origin("/verdict").into();
    let left = Vertical::new([arm, verdict]).with_row_shares([3.0, 2.0]);
    let mut tabs: Vec<ContainerLike> = Vec::new();
    for quantity in Quantity::ALL {
        let joints = (0..film.robot.dof())
            .filter(|&joint| film.signals.iter().any(|signal| signal.quantity == quantity && signal.joint == joint));
        let views: Vec<ContainerLike> = joints.map(|joint| plot(film, quantity, joint, properties)).collect();
        if !views.is_empty() {
            let columns = if views.len() < 4 { 1 } else { COLUMNS };
            tabs.push(Grid::new(views).with_name(quantity.title()).with_grid_columns(columns).into());
        }
    }
    tabs.push(TextLogView::new("Findings in time").with_origin("/findings").into());
    let right = Tabs::new(tabs);
    let time = TimePanel::new()
        .with_state(PanelState::Collapsed)
        .with_timeline("time")
        .with_play_state(PlayState::Paused)
        .with_fps(60.0);
    Blueprint::new(Horizontal::new([left.into(), right.into()]).with_column_shares([2.0, 3.0]))
        .with_auto_layout(false)
        .with_auto_views(false)
        .with_blueprint_panel(BlueprintPanel::from_state(PanelState::Hidden))
        .with_selection_panel(SelectionPanel::from_state(PanelState::Hidden))
        .with_time_panel(time)
}

fn plot(film: &Film, quantity: Quantity, joint: usize, properties: &mut Properties) -> ContainerLike {
    let name = &film.robot.joints[joint].name;
    let origin = format!("/{}/{}", quantity.name(), part(name));
    let title = format!("{name}, {}", quantity.unit(film.robot, joint));
    let view: ContainerLike = TimeSeriesView::new(title).with_origin(origin).into();
    let [from, to] = film.span().map(|seconds| (1e9 * seconds).round() as i64);
    // A linked axis would ignore the range.
    let axis = TimeAxis::new().with_link(LinkAxis::Independent).with_view_range(rerun::datatypes::TimeRange {
        start: rerun::datatypes::TimeRangeBoundary::Absolute(from.into()),
        end: rerun::datatypes::TimeRangeBoundary::Absolute(to.into()),
    });
    property(properties, &view, "TimeAxis", axis);
    // One legend for all: the lines look alike in every plot.
    property(properties, &view, "PlotLegend", PlotLegend::new().with_visible(joint == 0));
    view
}

fn property(properties: &mut Properties, view: &ContainerLike, name: &str, archetype: impl AsComponents + 'static) {
    if let ContainerLike::View(view) = view {
        properties.push((format!("{}/{name}", view.blueprint_path()), Box::new(archetype)));
    }
}

/// A camera that has the whole reach of the arm in view.
fn eye(robot: &Robot) -> EyeControls3D {
    let reach: f64 =
        robot.joints.iter().map(|joint| joint.origin.translation.norm()).sum::<f64>() + robot.flange.translation.norm();
    let scaled = |x: f64, y: f64, z: f64| [x, y, z].map(|part| (part * reach) as f32);
    EyeControls3D::new()
        .with_position(scaled(0.85, -0.95, 0.6))
        .with_look_target(scaled(0.1, 0.0, 0.3))
        .with_eye_up([0.0, 0.0, 1.0])
}
