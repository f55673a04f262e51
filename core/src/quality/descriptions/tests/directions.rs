//! Directions of gravity that a mechanism does not determine, and those that joints at assumed positions make.

use super::slides::{Link, STACKER, with_robot};
use super::*;
use nalgebra::Vector3;

/// Two joints on parallel axes.
const PARALLEL: [Link; 2] = [
    ("revolute", "0 0 1", "lower=\"-2\" upper=\"2\" effort=\"90\"", 4.0),
    ("revolute", "0 0 1", "lower=\"-2.2\" upper=\"2.2\" effort=\"60\"", 2.0),
];

/// Logs of a robot mounted otherwise, judged as described.
fn tilted(robot: &Robot, gravity: Vector3<f64>) -> Verdict {
    let mounted = Robot { gravity, ..robot.clone() };
    let logs = [40, 41].map(|seed| simulated(&mounted, Oddity::None, 15.0, seed));
    examine_together(&[&logs[0], &logs[1]], Some(robot)).unwrap().verdict.unwrap()
}

/// Directions of gravity that a verdict names.
fn directions(verdict: &Verdict) -> Vec<Vector3<f64>> {
    let of = |changes: &[Change]| {
        changes.iter().find_map(|change| match change {
            Change::Gravity(gravity) => Some(Vector3::from(*gravity)),
            _ => None,
        })
    };
    let sets = std::iter::once(&verdict.description.changes[..]);
    sets.chain(verdict.alternatives.iter().map(|other| &other.changes[..])).filter_map(of).collect()
}

fn holds_direction(directions: &[Vector3<f64>], wanted: Vector3<f64>) -> bool {
    directions.iter().any(|direction| direction.normalize().dot(&wanted.normalize()) > 15f64.to_radians().cos())
}

#[test]
fn parallel_axes_do_not_feel_the_side_of_gravity() {
    with_robot(&PARALLEL, |robot| {
        let gravity = Vector3::new(-5.4, -5.1, 6.4);
        let verdict = tilted(robot, gravity);
        let named = directions(&verdict);
        assert!(!verdict.beyond_doubt, "{verdict:?}");
        assert!(holds_direction(&named, gravity), "{named:?}");
        assert!(holds_direction(&named, Vector3::new(gravity.x, gravity.y, -gravity.z)), "{named:?}");
    });
}

#[test]
fn a_slide_that_is_tilted_does_not_show_the_side_of_gravity_without_doubt() {
    with_robot(&STACKER, |robot| {
        for gravity in [Vector3::new(4.0, 7.0, 5.5), Vector3::new(6.2, -4.0, -6.4)] {
            let verdict = tilted(robot, gravity);
            let named = directions(&verdict);
            assert!(holds_direction(&named, gravity), "{named:?}");
            assert!(!verdict.beyond_doubt || holds_direction(&named[..1], gravity), "{verdict:?}");
        }
    });
}

#[test]
fn positions_that_were_assumed_come_before_a_mounting() {
    let robot = Robot { assumed: vec!["torso_pitch".into()], ..irb() };
    let mounted = Robot { gravity: Vector3::new(4.9, 0.0, -8.5), ..robot.clone() };
    let logs = [0, 1].map(|log| simulated(&mounted, Oddity::None, 15.0, 60 + log));
    let together = examine_together(&[&logs[0], &logs[1]], Some(&robot)).unwrap();
    assert!(!together.verdict.unwrap().beyond_doubt);
    let kinds: Vec<Kind> = together.reports[0].findings.iter().map(|finding| finding.kind).collect();
    assert!(kinds.contains(&Kind::HeldPosition) && !kinds.contains(&Kind::Mounting), "{kinds:?}");
    assert!(
        together.reports[0].findings.iter().any(|f| f.place == "torso_pitch" && f.text.contains("[hold] torso_pitch"))
    );
}

#[test]
fn the_sign_of_all_torques_is_found_with_the_factor_of_one() {
    let robot = irb();
    let (_, verdict) = found(&robot, Oddity::None, &[Change::AllTorqueSigns, Change::JointScale(2, 0.01)]);
    let verdict = verdict.unwrap();
    let has = |wanted: fn(&Change) -> bool| verdict.description.changes.iter().any(wanted);
    assert!(has(|change| matches!(change, Change::AllTorqueSigns)), "{verdict:?}");
    assert!(
        has(|change| matches!(change, Change::JointScale(2, factor) if (50.0..200.0).contains(factor))),
        "{verdict:?}"
    );
}
