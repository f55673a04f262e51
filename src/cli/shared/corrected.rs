//! `corrected.toml`: a dataset that describes logs as they were found to be.

use crate::dataset::{Dataset, Named, corrected};
use crate::error::Result;
use crate::output::ResultFolder;
use crate::quality::UnitChanges;
use crate::quality::descriptions::{Description, Verdict};
use crate::robot::Robot;

/// Its name in the folder of results.
pub(crate) const FILE: &str = "corrected.toml";

/// Writes it where there is a change, and returns whether it is written: `dataset`, or a new one of the files `named`, with what
/// `description` and `units` change. What is known roughly, or not at all, of the factors of `verdict` stands above it.
///
/// # Errors
/// Those of [`corrected`] and of writing.
pub(crate) fn write(
    folder: &ResultFolder,
    dataset: Option<&Dataset>,
    named: &Named,
    robot: &Robot,
    description: Option<&Description>,
    verdict: Option<&Verdict>,
    units: UnitChanges,
) -> Result<bool> {
    if description.is_none() && units.is_none() {
        return Ok(false);
    }
    let as_given = Description::as_given(robot.dof(), robot.gravity);
    let description = description.unwrap_or(&as_given);
    if dataset.is_some_and(Dataset::is_coupled) {
        tracing::warn!("{FILE} is not written: the motors are coupled, so apply the change to the columns by hand");
        return Ok(false);
    }
    let source = || Some(robot.source.clone()).filter(|_| dataset.and_then(Dataset::robot).is_none());
    let named = &Named { robot: named.robot.clone().or_else(source), ..named.clone() };
    let remarks = verdict.map_or_else(String::new, |verdict| remarks(verdict, &robot.joint_names()));
    folder.write_text(FILE, &(remarks + &corrected(dataset, named, robot, description, units)?))?;
    Ok(true)
}

/// Comments on factors of torques that are known to within wide bounds, or not at all.
fn remarks(verdict: &Verdict, joints: &[String]) -> String {
    let of = |place: usize| match verdict.factors.len() {
        1 => "all joints",
        _ => joints.get(place).map_or("", String::as_str),
    };
    let times =
        |place: usize, [low, high]: [f64; 2]| format!("{} {:.3e} to {:.3e}", of(place), high.recip(), low.recip());
    let bounds = verdict.factor_bounds.iter().enumerate().filter_map(|(place, bounds)| Some(times(place, (*bounds)?)));
    let bounds = bounds.collect::<Vec<_>>().join(", ");
    let is_partial = verdict.description.scale_is_partial;
    let unknown = verdict.factors.iter().enumerate().filter(|(_, factor)| is_partial && factor.is_none());
    let unknown = unknown.map(|(place, _)| of(place)).collect::<Vec<_>>().join(", ");
    let mut text = String::new();
    if !bounds.is_empty() {
        text += &format!(
            "# Factors to N m (N) that are known roughly, since a load that is not in the robot's file changes them: {bounds}.\n"
        );
    }
    if !unknown.is_empty() {
        text += &format!(
            "# The factors of {unknown} are not known. What stands there is no measurement: put in what the drive has.\n"
        );
    }
    text
}

/// Reports that a verdict leaves too much of the torques to be written.
pub(crate) fn refused(verdict: &Verdict) {
    tracing::warn!(
        "{FILE} leaves the torques as they are: {:.0} % of them would stay unexplained with it, so that another cause is not excluded",
        100.0 * verdict.after
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::descriptions::Change;

    #[test]
    fn factors_that_are_not_sure_have_remarks() {
        let joints = ["a".to_owned(), "b".to_owned(), "c".to_owned()];
        let given = Description::as_given(3, [0.0, 0.0, -9.81].into());
        let of = |factors: Vec<Option<f64>>, factor_bounds: Vec<Option<[f64; 2]>>| {
            let description =
                Description { scale_is_partial: factors.contains(&None), ..given.with(Change::TorqueScale(0.1)) };
            let verdict = Verdict {
                description,
                before: 0.5,
                after: 0.01,
                each: [Vec::new(), Vec::new()],
                alternatives: Vec::new(),
                next: None,
                shown: None,
                factors,
                currents: false,
                factor_bounds,
                by_bodies: false,
                spread: None,
                assumed: Vec::new(),
                unlike_bodies: false,
                without_bodies: false,
                beyond_doubt: false,
            };
            remarks(&verdict, &joints)
        };
        assert_eq!(of(vec![Some(10.0)], vec![None]), "");
        assert!(of(vec![Some(10.0)], vec![Some([5.0, 10.0])]).contains("all joints 1.000e-1 to 2.000e-1."));
        let text = of(vec![Some(2.0), Some(50.0), None], vec![None, Some([4.0, 50.0]), None]);
        assert!(text.contains("changes them: b 2.000e-2 to 2.500e-1.") && text.contains("factors of c are not known"));
        assert!(text.lines().all(|line| line.starts_with("# ")), "{text}");
    }
}
