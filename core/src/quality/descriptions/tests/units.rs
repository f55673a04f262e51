//! Logs in another unit whose description is wrong besides.

use super::*;
use crate::quality::OtherUnit;

#[test]
fn a_wrong_sign_is_found_together_with_degrees() {
    let robot = irb();
    let wrong = Description::as_given(6, robot.gravity).with(Change::TorqueSign(2));
    let mut logs = [7, 8].map(|seed| simulated(&robot, Oddity::None, 15.0, seed));
    for log in &mut logs {
        wrong.apply(&mut log.recording);
        let q = &mut log.recording.q;
        (0..6).for_each(|joint| q.channel_mut(joint).iter_mut().for_each(|q| *q = q.to_degrees()));
    }
    let together = examine_together(&[&logs[0], &logs[1]], Some(&robot)).unwrap();
    assert_eq!(together.verdict.unwrap().description.changes, [Change::TorqueSign(2)]);
    assert_eq!(together.reports[0].units.positions, [Some(OtherUnit::Degree); 6]);
}

/// A log of which positions of some joints are in degrees.
fn in_degrees(oddity: Oddity, joints: std::ops::Range<usize>) -> Sieved {
    let mut log = simulated(&irb(), oddity, 20.0, 9);
    for joint in joints {
        log.recording.q.channel_mut(joint).iter_mut().for_each(|q| *q = q.to_degrees());
    }
    log
}

#[test]
fn joints_that_fit_rad_stay_in_rad_where_others_are_in_degrees() {
    let report = examine_together(&[&in_degrees(Oddity::None, 3..6)], Some(&irb())).unwrap().reports.remove(0);
    let degree = Some(OtherUnit::Degree);
    assert_eq!(report.units.positions, [None, None, None, degree, degree, degree]);
    let of_motion: Vec<&str> =
        report.findings.iter().filter(|f| f.place.starts_with('q')).map(|f| f.place.as_str()).collect();
    assert_eq!(of_motion, ["q4 (joint_4), q5 (joint_5), q6 (joint_6)"], "{:?}", report.findings);
}

#[test]
fn joints_that_hardly_move_are_in_the_degrees_of_the_others() {
    let report = examine_together(&[&in_degrees(Oddity::HardlyMoves, 0..6)], Some(&irb())).unwrap().reports.remove(0);
    assert_eq!(report.units.positions, [Some(OtherUnit::Degree); 6]);
}

#[test]
fn positions_before_gears_are_in_no_unit() {
    for (ratio, named) in
        [(101.0, Some("gears of about 101:")), (50.0, Some("gears of about 50:")), (180.0 / std::f64::consts::PI, None)]
    {
        let mut log = simulated(&irb(), Oddity::None, 20.0, 10);
        log.recording.q.as_mut_slice().iter_mut().for_each(|q| *q *= ratio);
        let report = examine_together(&[&log], Some(&irb())).unwrap().reports.remove(0);
        let told: Vec<&str> = report.findings.iter().map(|finding| finding.text.as_str()).collect();
        match named {
            Some(named) => assert!(told.len() == 1 && told[0].contains(named), "{ratio}: {told:?}"),
            None => assert_eq!(report.units.positions, [Some(OtherUnit::Degree); 6]),
        }
    }
}

/// Motors of which some turn the other way than their joints, with their torques before the gears too.
#[test]
fn positions_before_gears_with_other_signs_are_in_no_unit() {
    let robot = irb();
    let mut log = simulated(&robot, Oddity::None, 20.0, 10);
    let reversed = [1, 3, 5].iter().fold(Description::as_given(6, robot.gravity), |d, &j| d.with(Change::AxisSign(j)));
    reversed.apply(&mut log.recording);
    log.recording.q.as_mut_slice().iter_mut().for_each(|q| *q *= 101.0);
    log.recording.tau.as_mut_slice().iter_mut().for_each(|torque| *torque /= 101.0);
    let report = examine_together(&[&log], Some(&robot)).unwrap().reports.remove(0);
    let [finding] = &report.findings[..] else { panic!("{:?}", report.findings) };
    assert!(finding.text.contains("gears of about 101:") && finding.text.contains("[motors] sign"), "{finding:?}");
    assert!(report.units.is_none() && report.description.is_none());
}

/// A log of a motion of so many degrees to either side of zero, with positions that are so many times larger than in rad.
fn of_a_few_degrees(robot: &Robot, degrees: f64, times: f64) -> Sieved {
    let mut log = simulated(robot, Oddity::None, 20.0, 11);
    let samples = log.recording.samples();
    let mut motion = Motion::zeros(6, samples);
    for joint in 0..6 {
        let rate = 0.5 + 0.17 * joint as f64;
        for i in 0..samples {
            let (sin, cos) = (rate * log.recording.time[i] + joint as f64).sin_cos();
            let swing = degrees.to_radians();
            motion.q.channel_mut(joint)[i] = swing * sin;
            motion.qd.channel_mut(joint)[i] = swing * rate * cos;
            motion.qdd.channel_mut(joint)[i] = -swing * rate * rate * sin;
        }
    }
    let mut tau = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion);
    let mut random = random::stream(11, "few_degrees", 0);
    for joint in 0..6 {
        let size = crate::linear::root_mean_square(tau.channel(joint)).max(0.1);
        for (torque, rate) in tau.channel_mut(joint).iter_mut().zip(motion.qd.channel(joint)) {
            let noise: f64 = StandardNormal.sample(&mut random);
            *torque += size * (0.1 * (rate / 1e-4).tanh() + 0.003 * noise);
        }
    }
    log.recording.q = motion.q.map(|_, q| q.iter().map(|q| times * q).collect());
    log.recording.tau = tau;
    log
}

#[test]
fn a_few_degrees_are_no_radians_though_these_are_within_the_limits() {
    let robot = irb();
    let other = scales::with_other_masses(&robot, 3);
    let units = |log: &Sieved| examine_together(&[log], Some(&robot)).unwrap().reports.remove(0).units.positions;
    for degrees in [1.5, 2.5] {
        let log = of_a_few_degrees(&other, degrees, 1f64.to_degrees());
        assert_eq!(units(&log), [Some(OtherUnit::Degree); 6], "{degrees}");
        assert!(units(&of_a_few_degrees(&other, degrees, 1.0)).is_empty(), "{degrees}");
    }
    // Torques without gravity, or of another scale, are none of a motion that is smaller.
    for oddity in [Oddity::SlowMotion, Oddity::None] {
        let compensated = Robot { gravity: nalgebra::Vector3::zeros(), ..irb() };
        let mut log = simulated(&compensated, oddity, 15.0, 12);
        assert!(units(&log).is_empty(), "{oddity:?}");
        log.recording.tau.as_mut_slice().iter_mut().for_each(|torque| *torque *= 0.01);
        assert!(units(&log).is_empty(), "{oddity:?}");
    }
}

/// Shares of the limits, or of ranges that nobody gave: as degrees they would be within the limits.
#[test]
fn shares_of_ranges_are_no_degrees() {
    let robot = irb();
    let said = |range: &dyn Fn(usize, &[f64]) -> [f64; 2]| {
        let mut log = simulated(&robot, Oddity::None, 20.0, 10);
        for joint in 0..6 {
            let own = log.recording.q.channel_mut(joint);
            let [low, high] = range(joint, own);
            own.iter_mut().for_each(|q| *q = 200.0 * (*q - low) / (high - low) - 100.0);
        }
        log.recording.qd = None;
        let report = examine_together(&[&log], Some(&robot)).unwrap().reports.remove(0);
        assert!(report.units.is_none(), "{:?}", report.units);
        let of_unit = report.findings.iter().find(|finding| finding.kind == Kind::PositionUnit);
        of_unit.map(|finding| finding.text.clone()).unwrap_or_else(|| panic!("{:?}", report.findings))
    };
    let limits = said(&|joint, _| [robot.joints[joint].limits.lower, robot.joints[joint].limits.upper]);
    assert!(limits.contains("shares of each joint's range") && limits.contains("limits of the URDF"), "{limits}");
    let half = 0.5 * (robot.joints[0].limits.upper - robot.joints[0].limits.lower);
    assert!(limits.contains(&format!("gear_ratio = [{:.5}", 100.0 / half)), "{limits}");
    let calibrated = said(&|joint, q| {
        let (low, high) =
            q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
        [low - 0.02 * joint as f64, high + 0.01]
    });
    assert!(calibrated.contains("calibrated range in a dataset"), "{calibrated}");
}
