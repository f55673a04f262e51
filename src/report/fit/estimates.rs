//! Effects as a diagnosis estimates them, in the tables of `tauscope identify`.

use crate::diagnosis::{Estimated, EstimatedEffect, LeftOut, NamedParameter};
use crate::report::console::{by_joint, significant, table};
use crate::robot::Robot;

/// Tables for people: the held-out residual of each joint, the effects' parameters, and the effects that were left out.
///
/// ```
/// use tauscope::diagnosis::Diagnosis;
/// use tauscope::report::fit;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// let estimated = Diagnosis::of(&robot).train([&train]).test([&test]).estimate(["torque_ripple"])?;
/// assert!(fit::estimates(&robot, &estimated).contains("torque_ripple:pivot harmonic"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub fn estimates(robot: &Robot, estimated: &Estimated) -> String {
    let (unit, names) = by_joint(robot);
    let title = format!("held-out rms as diagnose, {unit}");
    let both = estimated.test_rms_without_nm.iter().zip(&estimated.test_rms_nm);
    let rows = names.into_iter().zip(both);
    let rows = rows.map(|(name, (without, with))| vec![name, significant(*without), significant(*with)]);
    let mut text = table(&[title.as_str(), "without effects", "with effects"], rows.collect());
    let rows: Vec<Vec<String>> = estimated.effects.iter().flat_map(of_effect).collect();
    if !rows.is_empty() {
        text += &format!("\n\n{}", table(&["effect as diagnose", "value", "std", "unit"], rows));
    }
    for LeftOut { effect, joints, why } in &estimated.left_out {
        text += &format!("\n{}: left out, since it {why}", named(effect, joints));
    }
    text
}

fn of_effect(one: &EstimatedEffect) -> impl Iterator<Item = Vec<String>> {
    let own = named(one.effect, &one.joints);
    one.parameters.iter().map(move |NamedParameter { name, value, std, unit, .. }| {
        let std = if std.is_finite() { significant(*std) } else { "not determined".to_owned() };
        vec![format!("{own} {name}"), significant(*value), std, (*unit).to_owned()]
    })
}

/// An effect as the command line names it.
fn named(effect: &str, joints: &[String]) -> String {
    joints.first().map_or_else(|| effect.to_owned(), |joint| format!("{effect}:{joint}"))
}
