//! The columns of a recording as they are written.

use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::recording::columns::names::{ACCELERATION, POSITION, QUANTITIES, TORQUE, TRUE, VELOCITY};

/// The columns of a recording in the order they are written: numbered, `q1` and so on, or `named`, as in
/// `elbow_position`.
///
/// # Errors
/// Signals of different shapes.
pub(crate) fn table(recording: &Recording, named: bool) -> Result<Vec<(String, &[f64])>> {
    let truth = recording.truth.as_ref();
    let groups = [
        (POSITION, "", Some(&recording.q)),
        (VELOCITY, "", recording.qd.as_ref()),
        (ACCELERATION, "", recording.qdd.as_ref()),
        (TORQUE, "", Some(&recording.tau)),
        (POSITION, TRUE, truth.map(|signals| &signals.q)),
        (VELOCITY, TRUE, truth.map(|signals| &signals.qd)),
        (ACCELERATION, TRUE, truth.map(|signals| &signals.qdd)),
        (TORQUE, TRUE, truth.map(|signals| &signals.tau)),
    ];
    let shape = (recording.joints(), recording.samples());
    let mut columns = vec![("t".to_owned(), recording.time.as_slice())];
    for (quantity, ending, channels) in groups {
        let (Some(channels), quantity) = (channels, QUANTITIES[quantity]) else { continue };
        if (channels.channels(), channels.samples()) != shape {
            let problem = format!(
                "{} joints of {} samples in a recording of {} joints and {} samples; give all signals the same shape",
                channels.channels(),
                channels.samples(),
                shape.0,
                shape.1
            );
            return Err(Error::request(format!("{}{ending}", quantity.name), problem));
        }
        let name = |joint: usize| match named {
            true => format!("{}{}{ending}", recording.joints[joint], quantity.suffixes[0]),
            false => format!("{}{}{ending}", quantity.prefixes[0], joint + 1),
        };
        columns.extend(channels.iter().enumerate().map(|(joint, signal)| (name(joint), signal)));
    }
    Ok(columns)
}
