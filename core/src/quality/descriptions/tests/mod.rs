//! Laws over many simulated logs: a right description is never accused, whatever the arm does beyond the model; a wrong one is
//! found, alone or with a second, and `corrected` logs are those of the right description.

use super::contradiction::contradict;
use super::*;
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::quality::view::View;
use crate::quality::{Kind, examine_together};
use crate::random;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::robot::{self, Inertia, InertiaCheck, Robot};
use nalgebra::Matrix3;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

fn arm(file: &str) -> Robot {
    robot::load(format!("{}/../{file}", env!("CARGO_MANIFEST_DIR")), InertiaCheck::Required).unwrap()
}

fn irb() -> Robot {
    arm("urdf/irb1600_6_120.urdf")
}

/// What an arm does beyond rigid bodies with Coulomb and viscous friction, or how its log is made.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Oddity {
    None,
    /// Friction falls from standstill to full speed, down to a third.
    Falling,
    /// A peak of friction at low speed.
    Stribeck,
    /// Friction grows with the load.
    Load,
    /// Drives without friction, as behind a torque sensor.
    Frictionless,
    /// The position follows the torque by a soft gear.
    Elastic,
    /// The position jumps by a play when the torque changes its sign.
    Backlash,
    /// The last joints hardly move.
    HardlyMoves,
    /// A load of so many kg at the flange that the description does not have.
    Payload(f64),
    /// 50 samples a second.
    Slow,
    /// A torque of few digits with much noise.
    Coarse,
    /// A slow motion, in which gravity and friction are nearly all.
    SlowMotion,
    /// Offsets of the torques.
    Offset,
    /// A spring across the second joint.
    Spring,
}

const ODDITIES: [Oddity; 14] = [
    Oddity::None,
    Oddity::Falling,
    Oddity::Stribeck,
    Oddity::Load,
    Oddity::Frictionless,
    Oddity::Elastic,
    Oddity::Backlash,
    Oddity::HardlyMoves,
    Oddity::Payload(5.0),
    Oddity::Slow,
    Oddity::Coarse,
    Oddity::SlowMotion,
    Oddity::Offset,
    Oddity::Spring,
];

/// A log of `robot` on a motion drawn from `seed`.
fn simulated(robot: &Robot, oddity: Oddity, seconds: f64, seed: u64) -> Sieved {
    let mut random = random::stream(seed, "descriptions", 0);
    let rate_hz = if oddity == Oddity::Slow { 50.0 } else { 200.0 };
    let tempo = if oddity == Oddity::SlowMotion { 0.25 } else { 1.0 };
    let samples = (rate_hz * seconds) as usize;
    let dof = robot.dof();
    let mut motion = Motion::zeros(dof, samples);
    for (j, joint) in robot.joints.iter().enumerate() {
        let (lower, upper) = (joint.limits.lower.max(-2.0), joint.limits.upper.min(2.0));
        let still = oddity == Oddity::HardlyMoves && j + 2 >= dof && dof > 2;
        let swing = if still { 0.004 } else { 0.35 * (upper - lower) };
        for part in [0.6, 0.4] {
            let (rate, phase) = (tempo * random.random_range(0.7..3.2), random.random_range(0.0..6.0));
            for i in 0..samples {
                let (sin, cos) = (rate * i as f64 / rate_hz + phase).sin_cos();
                motion.q.channel_mut(j)[i] += part * (swing * sin + 0.5 * (lower + upper));
                motion.qd.channel_mut(j)[i] += part * swing * rate * cos;
                motion.qdd.channel_mut(j)[i] -= part * swing * rate * rate * sin;
            }
        }
    }
    let mut carrying = robot.clone();
    if let Oddity::Payload(mass) = oddity {
        let last = carrying.joints.last_mut().unwrap();
        let (center, tensor) = (nalgebra::Vector3::new(0.05, 0.02, 0.15), Matrix3::identity() * 0.006 * mass);
        let body = Inertia::from_center_of_mass(mass, center, tensor);
        last.inertia = last.inertia.welded_to(&body);
    }
    let bodies = inverse_dynamics(&Chain::new(&carrying), &carrying.inertial_parameters(), &motion);
    let (mut q, mut tau) = (motion.q.clone(), bodies.clone());
    for j in 0..dof {
        let size = crate::linear::root_mean_square(bodies.channel(j)).max(0.5);
        let speed = crate::linear::root_mean_square(motion.qd.channel(j)).max(1e-3);
        for i in 0..samples {
            let v = motion.qd.channel(j)[i] / speed;
            let load = bodies.channel(j)[i].abs();
            let direction = (v / 0.01).tanh();
            let friction = match oddity {
                Oddity::Falling => size * 0.3 * direction * (1.0 / (1.0 + v.abs())),
                Oddity::Stribeck => size * direction * (0.15 + 0.25 * (-(v / 0.2).powi(2)).exp() + 0.05 * v.abs()),
                Oddity::Load => direction * (0.1 * size + 0.25 * load),
                Oddity::Frictionless => 0.0,
                _ => size * (0.2 * direction + 0.1 * v),
            };
            let more = match oddity {
                Oddity::Offset => 0.4 * size,
                Oddity::Spring if j == 1 => 0.5 * size * (motion.q.channel(j)[i] - 0.3),
                _ => 0.0,
            };
            let noise: f64 = StandardNormal.sample(&mut random);
            let noise = noise * if oddity == Oddity::Coarse { 0.15 } else { 0.02 };
            let torque = bodies.channel(j)[i] + friction + more + size * noise;
            tau.channel_mut(j)[i] = match oddity {
                Oddity::Coarse => (torque / (0.2 * size)).round() * 0.2 * size,
                _ => torque,
            };
            let follows = match oddity {
                Oddity::Elastic => 0.004 * bodies.channel(j)[i] / size,
                Oddity::Backlash => 0.001 * bodies.channel(j)[i].signum(),
                _ => 0.0,
            };
            let noise: f64 = StandardNormal.sample(&mut random);
            q.channel_mut(j)[i] += follows + 2e-6 * noise;
        }
    }
    let time = (0..samples).map(|i| i as f64 / rate_hz).collect();
    let recording = Recording { joints: robot.joint_names(), time, q, qd: None, tau, ..Recording::default() };
    Sieved { lines: (2..samples + 2).collect(), recording, ..Sieved::default() }
}

/// Arms with their right description.
fn arms() -> Vec<Robot> {
    let hanging = Robot { gravity: nalgebra::Vector3::new(0.0, 0.0, 9.81), ..irb() };
    let sideways = Robot { gravity: nalgebra::Vector3::new(0.0, 9.81, 0.0), ..arm("tests/reference/skew7.urdf") };
    vec![irb(), arm("tests/reference/skew7.urdf"), hanging, sideways, arm("tests/reference/pendulum.urdf")]
}

fn accusations(logs: &[Sieved], robot: Option<&Robot>) -> Vec<String> {
    let together = examine_together(&logs.iter().collect::<Vec<_>>(), robot).unwrap();
    let kinds = [Kind::TorqueUnit, Kind::UnsignedTorque, Kind::ClockFactor, Kind::Frozen, Kind::GravityAlone];
    let findings = together.reports.into_iter().flat_map(|report| report.findings);
    let accuses = |kind: Kind| is_description(kind) || kinds.contains(&kind);
    findings.filter(|finding| accuses(finding.kind)).map(|finding| finding.text).collect()
}

#[test]
fn right_logs_are_never_accused() {
    let mut wrong = Vec::new();
    for (place, robot) in arms().iter().enumerate() {
        for oddity in ODDITIES {
            let logs = [0, 1].map(|log| simulated(robot, oddity, 15.0, 100 * place as u64 + log));
            for (logs, known) in [(&logs[..1], Some(robot)), (&logs[..], Some(robot)), (&logs[..], None)] {
                let told = accusations(logs, known);
                if !told.is_empty() {
                    wrong.push(format!("arm {place}, {oddity:?}, {}: {told:?}", known.is_some()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} accused:\n{}", wrong.len(), wrong.join("\n"));
}

/// Logs with wrong descriptions, and what was found.
fn found(robot: &Robot, oddity: Oddity, changes: &[Change]) -> (Vec<Sieved>, Option<Verdict>) {
    let wrong = changes.iter().fold(Description::as_given(robot.dof(), robot.gravity), |d, &change| d.with(change));
    let mut logs = vec![simulated(robot, oddity, 15.0, 7), simulated(robot, oddity, 15.0, 8)];
    logs.iter_mut().for_each(|log| wrong.apply(&mut log.recording));
    let verdict = examine_together(&logs.iter().collect::<Vec<_>>(), Some(robot)).unwrap().verdict;
    (logs, verdict)
}

/// Whether the verdict holds the changes, as the best or among its alternatives.
fn holds(verdict: &Verdict, robot: &Robot, changes: &[Change]) -> bool {
    let of = |changes: &[Change]| {
        changes.iter().fold(Description::as_given(robot.dof(), robot.gravity), |d, &change| d.with(change))
    };
    let wanted = of(changes);
    let sets = std::iter::once(&verdict.description.changes[..]);
    let mut sets = sets.chain(verdict.alternatives.iter().map(|other| &other.changes[..]));
    sets.any(|set| of(set).same_as(&wanted))
}

#[test]
fn a_wrong_description_is_found() {
    let robot = irb();
    let mut cases: Vec<Vec<Change>> = (0..6).map(|joint| vec![Change::TorqueSign(joint)]).collect();
    cases.extend([
        vec![Change::AllTorqueSigns],
        vec![Change::TorqueExchange(1, 2)],
        vec![Change::TorqueExchange(3, 5)],
        vec![Change::JointExchange(1, 2)],
        vec![Change::AxisSign(1)],
        vec![Change::AxisSign(2)],
        vec![Change::PositionSign(1)],
        vec![Change::PositionSign(4)],
        vec![Change::AllPositionSigns],
        vec![Change::PositionExchange(1, 2)],
        vec![Change::PositionExchange(0, 3)],
        vec![Change::TorqueSign(1), Change::TorqueSign(4)],
        vec![Change::TorqueSign(2), Change::TorqueExchange(3, 4)],
        vec![Change::AxisSign(1), Change::TorqueSign(3)],
        vec![Change::JointExchange(1, 2), Change::TorqueSign(0)],
        vec![Change::TorqueSign(0), Change::TorqueSign(1), Change::TorqueSign(3), Change::TorqueSign(5)],
    ]);
    let mut wrong = Vec::new();
    for oddity in [Oddity::None, Oddity::Stribeck, Oddity::Payload(5.0), Oddity::Slow] {
        // Each kind of change is tried with each oddity, not each joint.
        for changes in cases.iter().step_by(if oddity == Oddity::None { 1 } else { 4 }) {
            let (_, verdict) = found(&robot, oddity, changes);
            if !verdict.as_ref().is_some_and(|verdict| holds(verdict, &robot, changes)) {
                let told = verdict.map(|v| (v.description.changes, v.before, v.after));
                wrong.push(format!("{oddity:?} {changes:?}: {told:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_mounting_is_found_and_applying_it_leaves_nothing() {
    let described = irb();
    for gravity in [[9.81, 0.0, 0.0], [0.0, -9.81, 0.0], [0.0; 3], [6.9367, 0.0, -6.9367]] {
        let mounted = Robot { gravity: gravity.into(), ..described.clone() };
        let logs = [0, 1].map(|log| simulated(&mounted, Oddity::None, 15.0, 50 + log));
        let verdict = examine_together(&[&logs[0], &logs[1]], Some(&described)).unwrap().verdict.unwrap();
        let found = verdict.description.gravity;
        let off = (found - mounted.gravity).norm();
        assert!(verdict.beyond_doubt && off < 1.0, "{gravity:?}: {found:?}, {verdict:?}");
        let right = Robot { gravity: found, ..described.clone() };
        assert_eq!(accusations(&logs, Some(&right)), [""; 0]);
    }
}

mod clocks;
mod compensated;
mod directions;
mod loads;
mod models;
mod named_units;
mod others;
mod right_logs;
mod scales;
mod signs;
mod slides;
mod turns;
mod units;
mod zeros;

#[test]
fn a_scale_of_the_torque_is_found_and_not_applied() {
    let robot = irb();
    for factor in [1e-2, 1e3, 1.0 / 150.0] {
        let mut log = simulated(&robot, Oddity::None, 15.0, 3);
        log.recording.tau.as_mut_slice().iter_mut().for_each(|torque| *torque *= factor);
        let report = &examine_together(&[&log], Some(&robot)).unwrap().reports[0];
        let verdict = report.description.as_ref().unwrap();
        let [Change::TorqueScale(found)] = verdict.description.changes[..] else { panic!("{verdict:?}") };
        assert!((found * factor - 1.0).abs() < 0.3 && !verdict.beyond_doubt, "{found} of {factor}");
    }
}

#[test]
fn a_sign_that_is_wrong_in_one_log_contradicts_the_others() {
    let robot = irb();
    for oddity in [Oddity::None, Oddity::Stribeck] {
        let contradicts = |wrong: &[usize]| {
            let mut logs: Vec<Sieved> = (1..4).map(|seed| simulated(&robot, oddity, 20.0, seed)).collect();
            for &log in wrong {
                logs[log].recording.tau.channel_mut(2).iter_mut().for_each(|torque| *torque = -*torque);
            }
            let views: Vec<View> = logs.iter().map(|log| View::new(&log.recording, Some(&robot)).unwrap()).collect();
            contradict(&views.iter().collect::<Vec<_>>(), &robot)
        };
        let found = [&[][..], &[1], &[0, 2]].map(contradicts);
        assert_eq!(found, [false, true, true], "{oddity:?}");
    }
}

#[test]
fn logs_that_contradict_each_other_are_judged_one_by_one() {
    let robot = irb();
    let mut logs = [1, 2].map(|seed| simulated(&robot, Oddity::None, 15.0, seed));
    logs[0].recording.tau.channel_mut(2).iter_mut().for_each(|torque| *torque = -*torque);
    let together = examine_together(&[&logs[0], &logs[1]], Some(&robot)).unwrap();
    assert_eq!(together.verdict, None);
    let told = |log: usize| together.reports[log].findings.iter().filter(|f| is_description(f.kind)).count();
    assert_eq!((told(0), told(1)), (1, 0));
}

#[test]
fn a_description_applied_twice_is_the_log() {
    let robot = irb();
    let log = simulated(&robot, Oddity::None, 2.0, 1).recording;
    let start = Description::as_given(6, robot.gravity);
    for change in [
        Change::AxisSign(2),
        Change::TorqueExchange(0, 4),
        Change::JointExchange(1, 5),
        Change::AllTorqueSigns,
        Change::AllPositionSigns,
    ] {
        let description = start.with(change);
        let mut twice = log.clone();
        description.apply(&mut twice);
        assert!(twice.tau != log.tau || twice.q != log.q, "{change:?}");
        description.apply(&mut twice);
        let same = |a: &Channels, b: &Channels| a.as_slice() == b.as_slice();
        assert!(same(&twice.tau, &log.tau) && same(&twice.q, &log.q), "{change:?}");
    }
}
