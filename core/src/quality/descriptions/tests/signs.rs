//! A torque that lost its sign, beside one that has the wrong one.

use super::*;
use crate::quality::Severity;

/// Two logs in which the torque of a joint is above zero for a share of the time, by a constant of its drive.
fn above_zero(joint: usize, share: f64) -> [Sieved; 2] {
    let mut logs = [50, 51].map(|seed| simulated(&irb(), Oddity::None, 15.0, seed));
    let mut all: Vec<f64> = logs.iter().flat_map(|log| log.recording.tau.channel(joint).to_vec()).collect();
    all.sort_by(f64::total_cmp);
    let zero = all[((1.0 - share) * (all.len() - 1) as f64) as usize];
    logs.iter_mut().for_each(|log| log.recording.tau.channel_mut(joint).iter_mut().for_each(|tau| *tau -= zero));
    logs
}

/// What is found wrong with logs of which the torque of a joint is changed.
fn told(logs: &[Sieved; 2], joint: usize, change: fn(f64) -> f64) -> Vec<(Kind, String)> {
    let mut logs = logs.clone();
    logs.iter_mut().flat_map(|log| log.recording.tau.channel_mut(joint)).for_each(|tau| *tau = change(*tau));
    let together = examine_together(&[&logs[0], &logs[1]], Some(&irb())).unwrap();
    let findings = together.reports.into_iter().flat_map(|report| report.findings);
    findings.filter(|f| f.severity > Severity::Note).map(|finding| (finding.kind, finding.place)).collect()
}

#[test]
fn a_torque_without_its_sign_has_no_wrong_sign() {
    for joint in [1, 2] {
        let place = format!("tau{} ({})", joint + 1, irb().joints[joint].name);
        let logs = above_zero(joint, 0.08);
        assert_eq!(told(&logs, joint, f64::abs), [(); 2].map(|()| (Kind::UnsignedTorque, place.clone())));
        assert_eq!(told(&logs, joint, |tau| -tau), [(); 2].map(|()| (Kind::TorqueSign, place.clone())));
        // It is on one side of zero, and so is the model's.
        let logs = above_zero(joint, 0.0);
        assert_eq!(told(&logs, joint, |tau| -tau), [(); 2].map(|()| (Kind::TorqueSign, place.clone())));
    }
}

/// Conventions of makers: axes of an arm that the URDF has the other way round, and a zero. Its mirror images explain it nearly as well.
#[test]
fn several_axes_the_other_way_round_are_found_and_no_mirror_image() {
    use std::f64::consts::FRAC_PI_2;
    let robot = irb();
    for changes in [
        vec![Change::AxisSign(1), Change::AxisSign(2), Change::ZeroOffset(1, FRAC_PI_2)],
        vec![Change::AxisSign(1), Change::AxisSign(2)],
    ] {
        let (_, verdict) = found(&robot, Oddity::None, &changes);
        let verdict = verdict.unwrap_or_else(|| panic!("{changes:?}"));
        let own = &verdict.description.changes;
        assert!(own.len() == changes.len() && holds(&verdict, &robot, &changes), "{changes:?}: {own:?}");
    }
}

/// An arm with three parallel axes: half a turn of one of them reverses the wrist behind it, so that the image of a set has a sign too many.
#[test]
fn axes_before_three_parallel_ones_are_found_and_no_mirror_image() {
    let link = |place: usize, axis: &str, at: &str, mass: f64| {
        format!(
            "<link name='l{place}'><inertial><origin xyz='{at}'/><mass value='{mass}'/>\
             <inertia ixx='{0}' iyy='{0}' izz='{1}' ixy='0' ixz='0' iyz='0'/></inertial></link>\
             <joint name='j{place}' type='revolute'><parent link='l{2}'/><child link='l{place}'/><origin xyz='{at}'/><axis xyz='{axis}'/>\
             <limit lower='-3' upper='3' effort='100' velocity='3'/></joint>",
            0.01 * mass,
            0.004 * mass,
            place - 1
        )
    };
    let links = link(1, "0 0 1", "0 0 .1", 3.7)
        + &link(2, "0 1 0", "0 .13 .05", 8.0)
        + &link(3, "0 1 0", ".2 -.06 .01", 2.3)
        + &link(4, "0 1 0", ".18 .03 0", 1.2)
        + &link(5, "0 0 1", "0 .1 -.02", 1.2)
        + &link(6, "0 1 0", ".01 .03 -.09", 0.4);
    let robot = Robot::from_urdf_str(&format!("<robot name='r'><link name='l0'/>{links}</robot>")).unwrap();
    let changes = [Change::AxisSign(1), Change::AxisSign(2), Change::ZeroOffset(1, std::f64::consts::FRAC_PI_2)];
    let (_, verdict) = found(&robot, Oddity::None, &changes);
    let verdict = verdict.unwrap();
    assert!(verdict.description.changes.len() == 3 && holds(&verdict, &robot, &changes), "{:?}", verdict.description);
}
