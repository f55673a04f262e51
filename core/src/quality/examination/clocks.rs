//! The clocks of logs without velocities, by their torques: one factor for all logs of a recorder.

use super::alone::Read;
use crate::error::Result;
use crate::quality::descriptions::{self, ClockFactor};
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::Robot;

/// The factor of every log's clock, where the torques show one. Logs whose time counts have another second than those in seconds. Where all
/// logs together show none and contradict each other, each is asked by itself.
///
/// # Errors
/// Those of the filters.
pub(super) fn shown(logs: &[Read], robot: Option<&Robot>) -> Result<Vec<Option<ClockFactor>>> {
    let mut clocks = vec![None; logs.len()];
    let Some(robot) = robot else { return Ok(clocks) };
    for may_count in [false, true] {
        let own = logs.iter().enumerate().filter(|(_, log)| log.may_count() == may_count);
        let (places, asking): (Vec<usize>, Vec<&Recording>) =
            own.filter_map(|(place, log)| Some((place, log.asks_for_clock()?))).unzip();
        if asking.is_empty() {
            continue;
        }
        let of_all = descriptions::clock_factor(&asking, robot)?;
        let by_themselves = of_all.is_none() && asking.len() > 1 && contradict(&asking, robot)?;
        for (place, log) in places.into_iter().zip(asking) {
            clocks[place] = if by_themselves { descriptions::clock_factor(&[log], robot)? } else { of_all };
        }
    }
    Ok(clocks)
}

fn contradict(logs: &[&Recording], robot: &Robot) -> Result<bool> {
    let views: Vec<View> = logs.iter().map(|log| View::new(log, Some(robot))).collect::<Result<_>>()?;
    Ok(descriptions::contradict(&views.iter().collect::<Vec<_>>(), robot))
}
