//! The columns of a recording as they are written.

use crate::error::{Error, Result};
use crate::recording::Recording;
#[cfg(any(test, feature = "parquet"))]
use crate::recording::columns::Layout;
use crate::recording::columns::names::{ACCELERATION, POSITION, QUANTITIES, TORQUE, TRUE, VELOCITY};
#[cfg(any(test, feature = "parquet"))]
use std::path::Path;

/// Columns with their names.
pub(crate) type Columns<'a> = Vec<(String, &'a [f64])>;

/// The columns of a recording in the order they are written: numbered, `q1` and so on, or `named`, as in
/// `elbow_position`.
///
/// # Errors
/// Signals of different shapes.
pub(crate) fn table(recording: &Recording, named: bool) -> Result<Columns<'_>> {
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

/// The named columns of a recording, where its joints are found in them again: one may be called like a quantity.
///
/// # Errors
/// Those of [`table`].
#[cfg(any(test, feature = "parquet"))]
pub(crate) fn named(recording: &Recording) -> Result<Option<Columns<'_>>> {
    let columns = table(recording, true)?;
    let header: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
    let tables = 1 + usize::from(recording.qd.is_some()) + usize::from(recording.qdd.is_some());
    let is_found = |layout: Layout| {
        let [positions, torques] = [1, 1 + tables * recording.joints()];
        layout.used().into_iter().eq(0..header.len())
            && layout.positions().iter().copied().eq(positions..positions + recording.joints())
            && layout.torques().iter().copied().eq(torques..torques + recording.joints())
    };
    let found = Layout::find(Path::new(""), None, &header, Some(&recording.joints));
    Ok(found.is_ok_and(is_found).then_some(columns))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::samples;

    #[test]
    fn names_stand_in_columns_where_they_are_found_again() {
        let mut recording = samples::full(2, 3);
        let mut first = |joints: [&str; 2]| {
            recording.joints = joints.map(str::to_owned).to_vec();
            named(&recording).unwrap().map(|columns| columns[1].0.clone())
        };
        assert_eq!(first(["elbow", "wrist 1"]).as_deref(), Some("elbow_position"));
        assert_eq!(first(["target", "1"]).as_deref(), Some("target_position"));
        // The position of a joint q reads as that of a joint called position too, and there is none.
        assert_eq!(first(["q", "tau"]).as_deref(), Some("q_position"));
        assert_eq!(first(["q", "position"]), None);
        assert_eq!(first(["a", "a"]), None);
    }
}
