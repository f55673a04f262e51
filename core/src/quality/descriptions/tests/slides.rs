//! Arms with joints that slide: their weight is a constant, their inertia that of a rotor, and their positions are no angles.

use super::*;

/// Kind, axis, limits and mass of a joint with its link.
pub(super) type Link = (&'static str, &'static str, &'static str, f64);

/// Two joints that turn about vertical axes, one that slides up and down, and a level one that carries them all.
pub(super) const STACKER: [Link; 4] = [
    ("prismatic", "1 0 0", "lower=\"0\" upper=\"1.6\" effort=\"400\"", 30.0),
    ("revolute", "0 0 1", "lower=\"-2\" upper=\"2\" effort=\"90\"", 7.0),
    ("revolute", "0 0 1", "lower=\"-2.2\" upper=\"2.2\" effort=\"60\"", 5.0),
    ("prismatic", "0 0 1", "lower=\"-0.25\" upper=\"0\" effort=\"200\"", 2.5),
];

/// Three joints that slide, none of which moves the others.
const GANTRY: [Link; 3] = [
    ("prismatic", "1 0 0", "lower=\"0\" upper=\"1.6\" effort=\"900\"", 30.0),
    ("prismatic", "0 1 0", "lower=\"0\" upper=\"1.2\" effort=\"400\"", 9.0),
    ("prismatic", "0 0 1", "lower=\"-0.5\" upper=\"0\" effort=\"200\"", 4.0),
];

/// Runs a test with the robot of some links.
pub(super) fn with_robot(links: &[Link], test: impl Fn(&Robot)) {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "<robot name=\"slides\"><link name=\"l0\"/>".to_owned();
    for (place, (kind, axis, limits, mass)) in links.iter().enumerate() {
        let next = place + 1;
        text += &format!(
            "<joint name=\"j{next}\" type=\"{kind}\"><parent link=\"l{place}\"/><child link=\"l{next}\"/><origin xyz=\"0.3 0 0.1\"/>\
             <axis xyz=\"{axis}\"/><limit {limits} velocity=\"4\"/></joint><link name=\"l{next}\"><inertial><origin xyz=\"0.15 0.01 0.03\"/>\
             <mass value=\"{mass}\"/><inertia ixx=\"{0}\" ixy=\"0\" ixz=\"0\" iyy=\"{0}\" iyz=\"0\" izz=\"{0}\"/></inertial></link>",
            0.01 * mass
        );
    }
    let path = folder.path().join("slides.urdf");
    std::fs::write(&path, text + "</robot>").unwrap();
    test(&robot::load(&path, InertiaCheck::Required).unwrap());
}

fn logs(robot: &Robot, oddity: Oddity) -> Vec<Sieved> {
    [30, 31].map(|seed| simulated(robot, oddity, 15.0, seed)).into()
}

fn judged(logs: &[Sieved], robot: &Robot) -> crate::quality::Together {
    examine_together(&logs.iter().collect::<Vec<_>>(), Some(robot)).unwrap()
}

#[test]
fn right_logs_of_slides_are_never_accused() {
    with_robot(&STACKER, |robot| {
        let other = scales::with_other_masses(robot, 4);
        for actual in [robot, &other] {
            for oddity in ODDITIES {
                let found = accusations(&logs(actual, oddity), Some(robot));
                assert!(found.is_empty(), "{oddity:?}: {found:?}");
            }
        }
    });
}

/// A balancer that carries the weight, or a part of it, is no other mounting.
#[test]
fn a_balancer_is_no_mounting() {
    with_robot(&STACKER, |robot| {
        for share in [0.5, 1.0] {
            let mut logs = logs(robot, Oddity::None);
            let weight = share * 2.5 * 9.81;
            logs.iter_mut().for_each(|log| log.recording.tau.channel_mut(3).iter_mut().for_each(|tau| *tau -= weight));
            let found = accusations(&logs, Some(robot));
            assert!(found.is_empty(), "{share}: {found:?}");
        }
    });
}

#[test]
fn a_ceiling_is_found_by_the_weight_that_a_drive_would_push_with() {
    with_robot(&STACKER, |robot| {
        let hanging = Robot { gravity: nalgebra::Vector3::new(0.0, 0.0, 9.81), ..robot.clone() };
        for actual in [hanging.clone(), scales::with_other_masses(&hanging, 4)] {
            let verdict = judged(&logs(&actual, Oddity::None), robot).verdict.unwrap();
            assert_eq!(verdict.description.changes, [Change::Gravity([0.0, 0.0, 9.81])]);
            assert!(matches!(verdict.shown, Some(Shown::Constant { joint: 3, .. })) && !verdict.beyond_doubt);
            let said = findings(&verdict, &robot.joint_names(), None);
            assert!(said[0].text.contains("the drive of j4 would push"), "{said:?}");
        }
    });
}

#[test]
fn a_force_beyond_its_drive_is_too_large_though_a_rotor_could_make_it() {
    with_robot(&GANTRY, |robot| {
        let with_factor = |factor: f64| {
            let mut logs = logs(robot, Oddity::None);
            logs.iter_mut().for_each(|log| log.recording.tau.channel_mut(1).iter_mut().for_each(|tau| *tau *= factor));
            judged(&logs, robot).verdict
        };
        let verdict = with_factor(100.0).unwrap();
        let [Change::JointScale(1, factor)] = verdict.description.changes[..] else { panic!("{verdict:?}") };
        let shown = matches!(verdict.shown, Some(Shown::Effort { joint: 1, .. }));
        assert!((factor * 100.0 - 1.0).abs() < 0.2 && shown, "{verdict:?}");
        // Bodies that are a few times heavier explain it.
        assert!(with_factor(5.0).is_none());
    });
}

#[test]
fn positions_of_a_turn_in_the_column_of_a_slide_are_exchanged_and_not_in_mm() {
    with_robot(&STACKER, |robot| {
        let mut logs = logs(robot, Oddity::None);
        let wrong = Description::as_given(4, robot.gravity).with(Change::PositionExchange(2, 3));
        logs.iter_mut().for_each(|log| wrong.apply(&mut log.recording));
        let together = judged(&logs, robot);
        assert_eq!(together.verdict.unwrap().description.changes, [Change::PositionExchange(2, 3)]);
        let findings = together.reports.iter().flat_map(|report| &report.findings);
        let others: Vec<_> = findings.filter(|f| matches!(f.kind, Kind::PositionUnit | Kind::OutsideLimits)).collect();
        assert!(others.is_empty(), "{others:?}");
        // Positions in mm stay what they are.
        let mut logs = self::logs(robot, Oddity::None);
        logs.iter_mut().for_each(|log| log.recording.q.channel_mut(3).iter_mut().for_each(|q| *q *= 1e3));
        let report = &judged(&logs, robot).reports[0];
        assert!(report.findings.iter().any(|finding| finding.kind == Kind::PositionUnit), "{:?}", report.findings);
    });
}
