//! Whether logs of one arm contradict each other, so that each is judged by itself.
//!
//! A description that is wrong in one log and right in another is not seen in both together: no change explains both. The logs then have
//! parameters of the bodies that differ, or one leaves much more of a torque unexplained than another. A search in every log by itself
//! takes as long as that in all of them; logs that agree are spared it.

use super::change::Description;
use super::compare::{EXPLAINED, mean};
use super::fitting::{Physics, Rows};
use super::search::CLEAN;
use super::tried::Tried;
use crate::quality::view::View;
use crate::robot::Robot;

/// Factor between residuals, root mean squares, from which they differ; shares of a torque below [`CLEAN`] do not.
const DIFFERS: f64 = 2.0;

/// Whether some of these logs contradict each other. Those that cannot be compared may.
pub(crate) fn contradict(views: &[&View], robot: &Robot) -> bool {
    let bodies = Physics::described(robot);
    let agree = |physics: &Physics| agree(views, robot, physics) == Some(true);
    !(agree(&Physics::free(robot)) && bodies.as_ref().is_none_or(agree))
}

/// Whether one set of parameters explains all logs about as well as each has its own, and all about as well; None where they cannot be
/// fitted.
fn agree(views: &[&View], robot: &Robot, physics: &Physics) -> Option<bool> {
    let tried = |rows: &Rows| Tried::new(physics, rows, Description::as_given(robot.dof(), robot.gravity));
    let rows = Rows::new(views, Some(robot))?;
    let together = tried(&rows)?;
    let mut shares: Vec<Vec<f64>> = vec![Vec::new(); together.evaluation.held_out.len()];
    for (log, view) in views.iter().enumerate() {
        // A residual is compared with the torque of all logs, also that of one by itself.
        let own = Rows { size: rows.size.clone(), ..Rows::new(&[view], Some(robot))? };
        let alone = tried(&own)?;
        for (channel, of_channel) in shares.iter_mut().enumerate() {
            let blocks = together.evaluation.held_out[channel].iter().zip(&rows.log);
            let in_log: Vec<f64> = blocks.filter(|(_, own)| **own == log).filter_map(|(value, _)| *value).collect();
            let by_itself: Vec<f64> = alone.evaluation.held_out[channel].iter().copied().flatten().collect();
            // Logarithms of mean squares. What explains a torque may still explain that of one log better: friction is not the same at the
            // speeds of every log.
            let is_in_both = !in_log.is_empty() && !by_itself.is_empty();
            let [shared, own] = [mean(&in_log), mean(&by_itself)];
            let is_unexplained = shared > 2.0 * (EXPLAINED * rows.size[channel]).ln();
            if is_in_both && shared - own > 2.0 * DIFFERS.ln() && is_unexplained {
                return Some(false);
            }
            of_channel.extend(alone.evaluation.unexplained[channel]);
        }
    }
    Some(shares.iter().all(|shares| are_alike(shares)))
}

/// Whether no log leaves a much larger share of a torque than another.
fn are_alike(shares: &[f64]) -> bool {
    let [least, most] =
        shares.iter().fold([f64::INFINITY, 0.0f64], |[least, most], share| [least.min(*share), most.max(*share)]);
    shares.is_empty() || most <= DIFFERS * least + CLEAN
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_alike_up_to_a_factor_of_two_and_a_margin() {
        assert!(are_alike(&[]) && are_alike(&[0.1, 0.23]) && !are_alike(&[0.1, 0.25]) && are_alike(&[0.0, 0.039]));
    }
}
