//! Torques that are not those of the described arm, whatever is changed: those of another robot, or bodies that are placeholders.

use super::super::change::Description;
use super::super::compare::EXPLAINED_ALONE;
use super::super::fitting::{Evaluation, Fit, Physics, Rows};
use super::super::shares::{FEWEST, MORE_THAN_ALL, WRONG_MASSES};
use super::super::tried::Tried;
use super::compensation;
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::view::View;
use crate::robot::Robot;

/// Share of a torque from which the described bodies, with any load, friction and rotor, do not explain it: masses that are wrong by a fifth leave
/// half of that ..
const UNLIKE: f64 = 0.3;

/// .. where free bodies leave so many times less: what neither explains is friction, or noise.
const LESS: f64 = 3.0;

/// Share of the torques, as a geometric mean, up to which bodies of any masses may leave more than free ones: their shapes are described wrongly.
const SHAPES: f64 = 0.05;

/// .. and so many times more than these: shapes that are wrong by 15 % leave one and a half times as much, those of other robots three times and more.
const UNLIKE_SHAPES: f64 = 2.0;

/// Share of the torques, as a geometric mean, from which masses of the described arm that are wrong do not explain it: less is a note.
const NOT_MASSES: f64 = 0.3;

/// A finding where no bodies explain half of the torques, or only others than those described.
pub(crate) fn finding(views: &[&View], robot: &Robot, description: Option<&Description>) -> Option<Finding> {
    let rows = Rows::new(views, Some(robot))?;
    let as_given = Description::as_given(robot.dof(), robot.gravity);
    let description = description.unwrap_or(&as_given);
    let under = |physics: &Physics| Tried::new(physics, &rows, description.clone());
    let physics = Physics::free(robot);
    // What little motion does not determine, free bodies predict badly: nothing explains a torque that all rows together leave.
    let whole = rows.whole();
    let residuals = Fit::new(&physics.tables(&whole, description), &whole, description).residuals()?;
    let free = under(&physics)?;
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let changed = if description.changes.is_empty() { "" } else { ", with what is named besides" };
    let (severity, text) = if nothing_explains(&residuals) {
        let text = format!(
            "no bodies on these joints explain the torques{changed}: more than half of the torque of most joints stays unexplained. The log may be that of \
             another robot or of other joints, or its torques are not these joints'"
        );
        (Severity::Warning, text)
    } else {
        let bodies = under(&Physics::bodies(robot)?)?;
        let moved = (0..robot.dof()).any(|joint| description.changes_position_of(joint));
        let masses = under(&Physics::masses(robot)?)?;
        // Torques of this arm under other conventions of its joints are those of its bodies, whatever they weigh; of another they are not.
        let unlike = moved && is_unlike(masses.share(), free.share());
        let others = bodies.share() >= WRONG_MASSES && others_explain(&bodies.evaluation, &free.evaluation);
        if !(others || unlike) || compensation::is_explained(robot, &rows, description) {
            return None;
        }
        let (left, cause) = match others {
            true => (&bodies, "the file's masses are wrong, as placeholders are"),
            false => (&masses, "the file describes other shapes"),
        };
        let text = format!(
            "the robot's bodies do not explain the torques{changed}, whatever they carry{}: {} stay unexplained on parts held out, {} with other bodies on \
             these joints. Either {cause}, or the log is that of another robot or of other joints",
            if others { "" } else { " and weigh" },
            percent(left.share()),
            percent(free.share())
        );
        (if bodies.share() < NOT_MASSES && !unlike { Severity::Note } else { Severity::Warning }, text)
    };
    Some(Finding::new(Kind::OtherRobot, severity, "robot", text))
}

/// Whether bodies of any masses leave much more of the torques than free ones do.
fn is_unlike(masses: f64, free: f64) -> bool {
    masses > SHAPES.max(UNLIKE_SHAPES * free)
}

/// Whether most torques stay unexplained.
fn nothing_explains(shares: &[f64]) -> bool {
    2 * shares.iter().filter(|share| **share > EXPLAINED_ALONE).count() > shares.len()
}

/// Whether other bodies explain half of the torques, at least, that those described do not.
fn others_explain(bodies: &Evaluation, free: &Evaluation) -> bool {
    let both: Vec<(f64, f64)> =
        bodies.unexplained.iter().zip(&free.unexplained).filter_map(|(own, free)| (*own).zip(*free)).collect();
    let beyond = |share: f64| both.iter().filter(|(own, free)| *own > share && *own > LESS * free).count();
    let unlike = beyond(UNLIKE);
    unlike >= FEWEST && (2 * unlike >= both.len() || beyond(MORE_THAN_ALL) >= FEWEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaving(shares: &[f64]) -> Evaluation {
        Evaluation { held_out: Vec::new(), unexplained: shares.iter().copied().map(Some).collect() }
    }

    #[test]
    fn bodies_disagree_where_half_of_the_torques_are_others() {
        let others = |bodies: &[f64], free: &[f64]| others_explain(&leaving(bodies), &leaving(free));
        assert!(others(&[0.31, 0.31, 0.02, 0.02], &[0.1, 0.1, 0.02, 0.02]));
        assert!(!others(&[0.31, 0.02, 0.02], &[0.1, 0.02, 0.02]) && !others(&[0.29, 0.29], &[0.02, 0.02]));
        // Few torques, of which the bodies need more than there is.
        assert!(others(&[0.1, 0.1, 0.1, 1.1, 1.1], &[0.02; 5]) && !others(&[0.1, 0.1, 0.1, 0.9, 0.9], &[0.02; 5]));
        // What no body explains.
        assert!(!others(&[0.6, 0.6], &[0.21, 0.21]));
    }

    #[test]
    fn shapes_are_unlike_where_no_masses_make_up_for_them() {
        assert!(is_unlike(0.051, 0.025) && !is_unlike(0.051, 0.026) && !is_unlike(0.049, 0.01));
    }

    #[test]
    fn nothing_explains_where_most_torques_are_left() {
        assert!(
            nothing_explains(&[0.51, 0.51, 0.1]) && !nothing_explains(&[0.51, 0.1]) && !nothing_explains(&[0.49, 0.49])
        );
    }
}
