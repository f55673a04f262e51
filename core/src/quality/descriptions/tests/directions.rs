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

/// The angle between the gravity that a verdict names and that of the mounting, degrees.
fn off(verdict: &Verdict, gravity: Vector3<f64>) -> f64 {
    verdict.description.gravity.normalize().dot(&gravity.normalize()).clamp(-1.0, 1.0).acos().to_degrees()
}

#[test]
fn a_direction_is_said_to_be_as_uncertain_as_it_is() {
    let robot = irb();
    let gravity = Vector3::new(4.1, -5.3, 7.2);
    let mounted = Robot { gravity, ..robot.clone() };
    let spread = |oddity: Oddity, seconds: f64, noise: f64| {
        let mut log = simulated(&mounted, oddity, seconds, 44);
        let mut random = random::stream(9, "noise of torques", 0);
        for joint in 0..robot.dof() {
            let size = crate::linear::root_mean_square(log.recording.tau.channel(joint));
            for torque in log.recording.tau.channel_mut(joint) {
                let own: f64 = StandardNormal.sample(&mut random);
                *torque += noise * size * own;
            }
        }
        let verdict = examine_together(&[&log], Some(&robot)).unwrap().verdict.unwrap();
        let spread = verdict.spread.clone().unwrap();
        assert!(
            off(&verdict, gravity) < spread.degrees,
            "{oddity:?}, {seconds}: {} of {spread:?}",
            off(&verdict, gravity)
        );
        let said = findings(&verdict, &robot.joint_names(), None).remove(0).text;
        assert_eq!(said.contains("do not determine this direction well"), !spread.is_narrow(), "{said}");
        assert!(spread.is_narrow() || !verdict.beyond_doubt);
        spread.degrees
    };
    let (long, short) = (spread(Oddity::None, 30.0, 0.0), spread(Oddity::SlowMotion, 6.0, 0.2));
    assert!(long <= 4.0 && short > long, "{long} {short}");
}

/// A mounting some degrees from an axis is a direction of its own, and no axis together with a zero.
#[test]
fn a_mounting_near_an_axis_is_one_direction() {
    let robot = irb();
    let gravity = Vector3::new(9.81 * 12f64.to_radians().cos(), 9.81 * 12f64.to_radians().sin(), 0.0);
    let verdict = tilted(&robot, gravity);
    assert!(
        matches!(verdict.description.changes[..], [Change::Gravity(_)]) && off(&verdict, gravity) < 2.0,
        "{verdict:?}"
    );
    // Along the axis itself it is that axis.
    let along = tilted(&robot, Vector3::new(9.81, 0.0, 0.0));
    assert_eq!(along.description.changes, [Change::Gravity([9.81, 0.0, 0.0])]);
}

/// The axis of the last joint shows by what is off it, and by nothing else.
#[test]
fn the_sign_of_the_last_axis_is_found_where_its_body_shows_it() {
    let mut robot = irb();
    // Moments about the axis act on the joints below, too.
    for (center, moment, shows) in
        [(Vector3::new(0.05, 0.06, 0.02), 0.02, true), (0.05 * robot.joints[5].axis, 1e-6, false)]
    {
        let body = Inertia::from_center_of_mass(6.0, center, Matrix3::identity() * moment);
        robot.joints[5].inertia = body;
        let (_, verdict) = found(&robot, Oddity::None, &[Change::AxisSign(5)]);
        match shows {
            true => assert!(verdict.is_some_and(|verdict| holds(&verdict, &robot, &[Change::AxisSign(5)]))),
            false => assert_eq!(verdict.map(|verdict| verdict.description.changes), None),
        }
    }
}

#[test]
fn columns_in_reverse_order_are_one_candidate() {
    let start = Description::as_given(5, Vector3::zeros());
    let reversed = start.in_reverse_order(&[true; 5]).unwrap();
    assert_eq!((reversed.position_of, reversed.torque_of), (vec![4, 3, 2, 1, 0], vec![4, 3, 2, 1, 0]));
    assert!(start.in_reverse_order(&[true, true, false, true, true]).is_none());
    assert!(Description::as_given(3, Vector3::zeros()).in_reverse_order(&[true; 3]).is_none());
}

/// A base that is tilted a little turns what the first joints carry, as a zero does.
#[test]
fn a_small_tilt_is_no_zero_and_is_noted() {
    let robot = irb();
    for degrees in [6.0, 12.0f64] {
        let gravity = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), degrees.to_radians()) * robot.gravity;
        let mounted = Robot { gravity, ..scales::with_other_masses(&robot, 5) };
        let logs = [0, 1].map(|log| simulated(&mounted, Oddity::None, 15.0, 80 + log));
        let together = examine_together(&[&logs[0], &logs[1]], Some(&robot)).unwrap();
        assert!(together.verdict.is_none(), "{degrees}: {:?}", together.verdict);
        let noted = together.reports[0].findings.iter().find(|finding| finding.kind == Kind::Mounting);
        let noted = noted.unwrap_or_else(|| panic!("{degrees}: {:?}", together.reports[0].findings));
        assert!(noted.severity == crate::quality::Severity::Note && noted.text.contains("base_tilt"), "{noted:?}");
    }
}
