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
/// `description` and `units` change.
///
/// # Errors
/// Those of [`corrected`] and of writing.
pub(crate) fn write(
    folder: &ResultFolder,
    dataset: Option<&Dataset>,
    named: &Named,
    robot: &Robot,
    description: Option<&Description>,
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
    if description.scale_is_partial {
        tracing::warn!(
            "{FILE} is not written: the factor is known of some torques only, and differs from joint to joint"
        );
        return Ok(false);
    }
    let source = || Some(robot.source.clone()).filter(|_| dataset.and_then(Dataset::robot).is_none());
    let named = &Named { robot: named.robot.clone().or_else(source), ..named.clone() };
    folder.write_text(FILE, &corrected(dataset, named, robot, description, units)?)?;
    Ok(true)
}

/// Reports that a verdict leaves too much of the torques to be written.
pub(crate) fn refused(verdict: &Verdict) {
    tracing::warn!(
        "{FILE} is not written: {:.0} % of the torque would stay unexplained with it, so that another cause is not excluded",
        100.0 * verdict.after
    );
}
