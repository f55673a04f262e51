//! Torques that are not those of the described arm, whatever is changed: those of another robot, or bodies that are placeholders.

use super::super::change::Description;
use super::super::compare::{EXPLAINED, EXPLAINED_ALONE};
use super::super::fitting::{Evaluation, Fit, Physics, Rows};
use super::super::shares::{FEWEST, MORE_THAN_ALL, WRONG_MASSES};
use super::super::tried::Tried;
use super::{compensation, lengths};
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::view::View;
use crate::robot::Robot;

/// Share of a torque from which the described bodies, with any load, friction and rotor, do not explain it: masses that are wrong by a
/// fifth leave half of that ..
const UNLIKE: f64 = 0.3;

/// .. where free bodies leave so many times less: what neither explains is friction, or noise.
const LESS: f64 = 3.0;

/// Torques that carry most of all are those of no described body where two of them stay unexplained by more than this, and all together do,
/// as a share of the root mean square of all: a wrist of which little is known explains itself.
const MOST: f64 = 0.5;

/// Share of the torques, as a geometric mean, up to which bodies of any masses may leave more than free ones: their shapes are described
/// wrongly.
const SHAPES: f64 = 0.05;

/// .. and so many times more than these: shapes that are wrong by 15 % leave one and a half times as much, those of other robots three
/// times and more.
const UNLIKE_SHAPES: f64 = 2.0;

/// Share of the torques, as a geometric mean, from which masses of the described arm that are wrong do not explain it: less is a note.
const NOT_MASSES: f64 = 0.3;

/// A finding where no bodies explain the torques, or only others than those described.
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
    let of_lengths = lengths::other(robot, &rows, description, &free, views.iter().any(|view| view.log.qd.is_some()));
    let (kind, severity, text) = if let Some(lengths) = of_lengths {
        (Kind::OtherRobot, Severity::Warning, lengths.text(robot, free.share(), changed))
    } else if nothing_explains(&residuals) {
        let text = format!(
            "no bodies on these joints explain the torques{changed}: more than half of the torque of most joints stays unexplained. The log may be that of \
             another robot or of other joints, or its torques are not these joints', as where motors drive several of them ([motors] coupling)"
        );
        (Kind::NothingExplains, Severity::Warning, text)
    } else {
        let bodies = under(&Physics::bodies(robot)?)?;
        let moved = (0..robot.dof()).any(|joint| description.changes_position_of(joint));
        let masses = under(&Physics::masses(robot)?)?;
        // Torques of this arm under other conventions of its joints are those of its bodies, whatever they weigh; of another they are not.
        let unlike = moved && is_unlike(masses.share(), free.share());
        let both = [&bodies.evaluation, &free.evaluation];
        let heavy = others_explain_most(both, &rows.size);
        let others = heavy || bodies.share() >= WRONG_MASSES && others_explain(both[0], both[1]);
        if !(others || unlike) || compensation::is_explained(robot, &rows, description) {
            return None;
        }
        let (left, cause) = match others {
            true => (&bodies, "the file's masses are wrong, as placeholders are"),
            false => (&masses, "the file describes other shapes"),
        };
        let text = format!(
            "the robot's bodies do not explain the torques{changed}, whatever they carry{}: {} stay unexplained on parts held out, {} with other bodies on \
             these joints. Either {cause}{}, or the log is that of another robot or of other joints",
            if others { "" } else { " and weigh" },
            percent(left.share()),
            percent(free.share()),
            if others {
                ", or the torques are in another unit on each joint (amperes: [motors] torque_constant_nm_a)"
            } else {
                ""
            }
        );
        // Right joints with bodies of their own leave noise and what friction has beyond the model.
        let text = match free.share() < EXPLAINED {
            true => text,
            false => format!(
                "{text}. On the right joints other bodies leave less: another robot, or motors that drive several joints, is likelier"
            ),
        };
        let is_note = bodies.share() < NOT_MASSES && !unlike && !heavy;
        (Kind::OtherRobot, if is_note { Severity::Note } else { Severity::Warning }, text)
    };
    Some(Finding::new(kind, severity, "robot", text))
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
    let (unlike, more_than_all) = (beyond(UNLIKE), beyond(MORE_THAN_ALL));
    // A load that no arm carries makes up for heavier bodies on all joints but one or two.
    let by_load = more_than_all > 0 && 2 * beyond(WRONG_MASSES) >= both.len();
    unlike >= FEWEST && (2 * unlike >= both.len() || more_than_all >= FEWEST) || by_load
}

/// Whether other bodies explain the torques of which all joints have the most, and those described do not; `sizes` are the root mean
/// squares of the torques.
fn others_explain_most([bodies, free]: [&Evaluation; 2], sizes: &[f64]) -> bool {
    let each = bodies.unexplained.iter().zip(&free.unexplained).zip(sizes);
    let each: Vec<(f64, f64, f64)> = each.filter_map(|((own, free), size)| Some(((*own)?, (*free)?, *size))).collect();
    let unlike = each.iter().filter(|(own, free, _)| *own > MOST && *own > LESS * free).count();
    let all =
        |share: &dyn Fn(&(f64, f64, f64)) -> f64| each.iter().map(|own| (share(own) * own.2).powi(2)).sum::<f64>();
    unlike >= FEWEST && all(&|own| own.0) > MOST.powi(2) * all(&|_| 1.0)
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
    fn bodies_disagree_where_two_large_torques_are_others() {
        let most = |bodies: &[f64], free: &[f64]| {
            others_explain_most([&leaving(bodies), &leaving(free)], &[5.0, 50.0, 30.0, 1.0])
        };
        assert!(most(&[0.1, 0.51, 0.52, 0.02], &[0.02; 4]));
        // One of them alone, as with a balancer; small ones; what no body explains.
        assert!(!most(&[0.1, 0.9, 0.4, 0.02], &[0.02; 4]) && !most(&[0.9, 0.4, 0.1, 0.9], &[0.02; 4]));
        assert!(!most(&[0.1, 0.51, 0.52, 0.02], &[0.18; 4]));
    }

    #[test]
    fn bodies_disagree_where_a_load_makes_up_for_them_on_all_joints_but_one() {
        let others = |bodies: &[f64]| others_explain(&leaving(bodies), &leaving(&[0.02; 6]));
        assert!(others(&[0.21, 0.18, 0.11, 2.8, 0.28, 0.05]));
        assert!(!others(&[0.14, 0.14, 0.11, 2.8, 0.28, 0.05]) && !others(&[0.21, 0.18, 0.11, 0.9, 0.28, 0.05]));
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
