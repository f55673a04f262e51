//! A law over all kinds of findings: there is a fault for each, and it is found where it was put in.

use super::tests::{irb, log};
use super::view::View;
use super::*;
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::recording::lenient::{self, Cause, ColumnMap, Rejected, Sieved};
use crate::recording::{self, Recording};
use crate::robot::Robot;

/// All kinds; the law below knows no way round the compiler for a new one.
const ALL: [Kind; 45] = [
    Kind::TooShort,
    Kind::CutOff,
    Kind::BadRows,
    Kind::DuplicateTime,
    Kind::BackwardTime,
    Kind::Jitter,
    Kind::Gap,
    Kind::NoMotion,
    Kind::NoTorque,
    Kind::Frozen,
    Kind::HeldSamples,
    Kind::Clipped,
    Kind::Spike,
    Kind::Wrapped,
    Kind::UnsignedTorque,
    Kind::TorqueSign,
    Kind::TorqueUnit,
    Kind::VelocitySign,
    Kind::VelocityUnit,
    Kind::VelocityMismatch,
    Kind::VelocityDelay,
    Kind::PositionUnit,
    Kind::OutsideLimits,
    Kind::Swapped,
    Kind::DeadTime,
    Kind::HardlyMoves,
    Kind::PoorExcitation,
    Kind::TwoSources,
    Kind::Corrected,
    Kind::UnusedColumns,
    Kind::PositionSign,
    Kind::Mounting,
    Kind::GravityCompensated,
    Kind::GravityAlone,
    Kind::ClockFactor,
    Kind::MotorOff,
    Kind::ModelTorque,
    Kind::PositionZero,
    Kind::TorqueSpike,
    Kind::HeldPosition,
    Kind::OtherRobot,
    Kind::NothingExplains,
    Kind::PositionJump,
    Kind::LostRows,
    Kind::JointName,
];

/// A fault put into a clean log.
enum Fault {
    /// Into the signals.
    Signals(fn(&mut Recording)),
    /// Into the lines of the log as CSV.
    Lines(fn(&mut Vec<String>)),
    /// Into what reading reports.
    Reading(fn(&mut Sieved)),
}

/// A fault of every kind, and how the place begins at which it must be found.
fn fault(kind: Kind) -> (Fault, &'static str) {
    use Fault::{Lines, Reading, Signals};
    match kind {
        Kind::TooShort => (Signals(|log| *log = log.slice(0..40)), "rows"),
        Kind::CutOff => (
            Reading(|sieved| {
                let line = sieved.recording.samples() + 2;
                let (column, problem) = ("file".to_owned(), "ended in the middle of a record".to_owned());
                sieved.rejected.push(Rejected { line, column, cause: Cause::CutOff, problem });
            }),
            "line 3002",
        ),
        Kind::BadRows => (Lines(|lines| lines[100] = lines[100].replacen('.', "x", 1)), "line 101"),
        Kind::DuplicateTime => (Lines(|lines| lines.insert(200, lines[199].clone())), "line 201"),
        Kind::BackwardTime => (Lines(|lines| lines.insert(300, lines[100].clone())), "line 301"),
        Kind::Jitter => (
            Signals(|log| {
                let mut wobble = [0.4, -0.7, 0.9, -0.2, 0.6, -1.0, 0.1].iter().cycle();
                log.time.iter_mut().zip(&mut wobble).for_each(|(t, w)| *t += 0.001 * w);
            }),
            "t",
        ),
        Kind::Gap => (Lines(|lines| drop(lines.drain(1000..1020))), "3.9920 s (line 1000)"),
        Kind::NoMotion => (
            Signals(|log| {
                log.q.as_mut_slice().fill(0.3);
                log.qd = None;
            }),
            "q",
        ),
        Kind::NoTorque => (Signals(|log| log.tau.channel_mut(5).fill(0.0)), "tau6"),
        Kind::Frozen => (
            Signals(|log| {
                let held = log.tau.channel(4)[1000];
                log.tau.channel_mut(4)[1000..1100].fill(held);
            }),
            "tau5 (joint_5) from 4.0000 s",
        ),
        Kind::HeldSamples => (
            Signals(|log| {
                let tau = log.tau.channel(0).to_vec();
                (0..tau.len()).for_each(|i| log.tau.channel_mut(0)[i] = tau[i - i % 2]);
            }),
            "tau1",
        ),
        Kind::Clipped => (
            Signals(|log| {
                let top = 0.7 * log.tau.channel(2).iter().fold(0.0f64, |m, v| m.max(v.abs()));
                log.tau.channel_mut(2).iter_mut().for_each(|v| *v = v.clamp(-top, top));
            }),
            "tau3",
        ),
        Kind::Spike => (Signals(|log| log.q.channel_mut(3)[700] += 0.8), "q4 (joint_4) at 2.8000 s"),
        Kind::TorqueSpike => (Signals(|log| log.tau.channel_mut(3)[700] += 500.0), "tau4 (joint_4) at 2.8000 s"),
        Kind::Wrapped => (
            Signals(|log| {
                let turn = std::f64::consts::TAU;
                log.q.channel_mut(5).iter_mut().filter(|v| **v > 0.2).for_each(|v| *v -= turn);
            }),
            "q6",
        ),
        Kind::UnsignedTorque => (Signals(|log| log.tau.channel_mut(3).iter_mut().for_each(|v| *v = v.abs())), "tau4"),
        Kind::TorqueSign => (Signals(|log| log.tau.channel_mut(1).iter_mut().for_each(|v| *v = -*v)), "tau2"),
        Kind::TorqueUnit => (Signals(|log| log.tau.as_mut_slice().iter_mut().for_each(|v| *v *= 1e3)), "tau"),
        Kind::VelocitySign => (Signals(|log| velocity(log, 2, |_, v| -v)), "qd3"),
        Kind::VelocityUnit => (Signals(|log| velocity(log, 0, |_, v| v * 30.0 / std::f64::consts::PI)), "qd1"),
        Kind::VelocityMismatch => (Signals(|log| velocity(log, 4, |t, v| 0.5 * v + (17.0 * t).sin())), "qd5"),
        Kind::VelocityDelay => (
            Signals(|log| {
                let Some(qd) = &mut log.qd else { return };
                let own = qd.channel(1).to_vec();
                (5..own.len()).for_each(|i| qd.channel_mut(1)[i] = own[i - 5]);
            }),
            "qd2",
        ),
        Kind::PositionUnit => (
            Signals(|log| {
                log.q.as_mut_slice().iter_mut().for_each(|v| *v = v.to_degrees());
                log.qd = None;
            }),
            "q",
        ),
        Kind::OutsideLimits => (Signals(|log| log.q.channel_mut(0).iter_mut().for_each(|v| *v += 3.0)), "q1"),
        Kind::PositionZero => (Signals(|log| log.q.channel_mut(2).iter_mut().for_each(|v| *v += 1.2)), "q3"),
        Kind::Swapped => (
            Signals(|log| {
                let (second, fourth) = (log.tau.channel(1).to_vec(), log.tau.channel(3).to_vec());
                log.tau.channel_mut(1).copy_from_slice(&fourth);
                log.tau.channel_mut(3).copy_from_slice(&second);
            }),
            "tau2",
        ),
        Kind::DeadTime => (
            Signals(|log| {
                for joint in 0..6 {
                    let tau = log.tau.channel(joint).to_vec();
                    (3..tau.len()).for_each(|i| log.tau.channel_mut(joint)[i] = tau[i - 3]);
                }
            }),
            "tau",
        ),
        Kind::HardlyMoves => (
            Signals(|log| {
                let still: Vec<f64> = log.time.iter().map(|t| 0.1 + 0.004 * (2.0 * t).sin()).collect();
                log.q.channel_mut(5).copy_from_slice(&still);
                log.qd = None;
            }),
            "q6",
        ),
        Kind::PoorExcitation => (Signals(together), "motion"),
        Kind::TwoSources => (
            Lines(|lines| {
                let rest = lines[1].split_once(',').map(|(_, rest)| rest.to_owned()).unwrap_or_default();
                for line in lines.iter_mut().skip(2).step_by(2) {
                    let time = line.split_once(',').map_or("", |(time, _)| time);
                    *line = format!("{time},{rest}");
                }
            }),
            "rows",
        ),
        Kind::Corrected => (
            Lines(|lines| {
                lines[0] = lines[0].replacen('t', "time_ms", 1);
                for line in &mut lines[1..] {
                    let (time, rest) = line.split_once(',').unwrap();
                    *line = format!("{:?},{rest}", 1e3 * time.parse::<f64>().unwrap());
                }
            }),
            "log",
        ),
        Kind::UnusedColumns => (
            Lines(|lines| {
                lines[0] += ",temperature";
                lines[1..].iter_mut().for_each(|line| *line += ",35.5");
            }),
            "header",
        ),
        Kind::PositionSign => (
            Signals(|log| {
                log.q.channel_mut(1).iter_mut().for_each(|v| *v = -*v);
                log.qd = None;
            }),
            "q2",
        ),
        Kind::Mounting => (Signals(|log| with_gravity(log, [9.81, 0.0, 0.0])), "gravity"),
        Kind::HeldPosition => (Signals(|log| with_gravity(log, [6.9, 0.0, -6.9])), "torso"),
        Kind::OtherRobot => (Signals(of_another_robot), "robot"),
        // Torques of another time.
        Kind::NothingExplains => {
            (Signals(|log| (0..6).for_each(|joint| log.tau.channel_mut(joint).reverse())), "robot")
        }
        Kind::PositionJump => {
            (Signals(|log| log.q.channel_mut(2)[1500..].iter_mut().for_each(|q| *q += 0.1)), "q3 (joint_3) at 5.9960 s")
        }
        Kind::LostRows => (
            Signals(|log| {
                let without = |table: &Channels| table.map(|_, own| [&own[..1000], &own[1100..]].concat());
                log.q = without(&log.q);
                log.qd = log.qd.as_ref().map(without);
                log.tau = without(&log.tau);
                log.time.truncate(log.tau.samples());
            }),
            "rows at 3.9960 s",
        ),
        Kind::JointName => (Reading(|sieved| sieved.unknown_joints = vec!["tosro".into()]), "header (tosro)"),
        Kind::GravityAlone => (
            Signals(|log| {
                let view = View::new(log, None).unwrap();
                log.tau = inverse_dynamics(
                    &Chain::new(&irb()),
                    &irb().inertial_parameters(),
                    &Motion::at_rest(view.q.clone()),
                );
            }),
            "tau",
        ),
        Kind::GravityCompensated => (Signals(|log| with_gravity(log, [0.0; 3])), "tau"),
        Kind::ClockFactor => (Signals(|log| log.time.iter_mut().for_each(|t| *t *= 0.625)), "t"),
        Kind::MotorOff => (Signals(|log| log.tau.channel_mut(2)[1000..1200].fill(0.0)), "tau3"),
        Kind::ModelTorque => (
            Signals(|log| {
                let view = View::new(log, None).unwrap();
                let motion = Motion { q: view.q.clone(), qd: view.qd.clone(), qdd: view.qdd.clone() };
                log.tau = inverse_dynamics(&Chain::new(&irb()), &irb().inertial_parameters(), &motion);
            }),
            "tau",
        ),
    }
}

/// The arm, of which for some faults a joint below the others is held.
fn robot_for(kind: Kind) -> Robot {
    let mut robot = irb();
    if matches!(kind, Kind::HeldPosition | Kind::JointName) {
        (robot.held, robot.assumed) = (vec![("torso".into(), 0.0)], vec!["torso".into()]);
    }
    robot
}

/// The torques of an arm on the same joints, whose bodies have their centres of mass on the other side and further out.
fn of_another_robot(log: &mut Recording) {
    let mut robot = irb();
    for joint in &mut robot.joints {
        joint.inertia.0[1..4].iter_mut().for_each(|moment| *moment *= -3.0);
    }
    let view = View::new(log, None).unwrap();
    let motion = Motion { q: view.q.clone(), qd: view.qd.clone(), qdd: view.qdd.clone() };
    log.tau = inverse_dynamics(&Chain::new(&robot), &robot.inertial_parameters(), &motion);
}

/// The torque under another gravity.
fn with_gravity(log: &mut Recording, gravity: [f64; 3]) {
    let robot = irb();
    let view = View::new(log, None).unwrap();
    let motion = Motion { q: view.q.clone(), qd: view.qd.clone(), qdd: view.qdd.clone() };
    let torque = |gravity: [f64; 3]| {
        inverse_dynamics(&Chain::new(&robot).with_gravity(gravity), &robot.inertial_parameters(), &motion)
    };
    let (described, other) = (torque(robot.gravity.into()), torque(gravity));
    for (tau, (a, b)) in log.tau.as_mut_slice().iter_mut().zip(described.as_slice().iter().zip(other.as_slice())) {
        *tau += b - a;
    }
}

/// Changes the velocities of a joint, given time and velocity.
fn velocity(log: &mut Recording, joint: usize, change: fn(f64, f64) -> f64) {
    let Some(qd) = &mut log.qd else { return };
    log.time.iter().zip(qd.channel_mut(joint)).for_each(|(t, v)| *v = change(*t, *v));
}

/// All joints move as one, by the torque that this takes.
fn together(log: &mut Recording) {
    let robot = irb();
    let mut motion = Motion::zeros(6, log.samples());
    for joint in 0..6 {
        for (i, t) in log.time.iter().enumerate() {
            motion.q.channel_mut(joint)[i] = 0.2 * (2.0 * t).sin();
            motion.qd.channel_mut(joint)[i] = 0.4 * (2.0 * t).cos();
            motion.qdd.channel_mut(joint)[i] = -0.8 * (2.0 * t).sin();
        }
    }
    log.tau = inverse_dynamics(&Chain::new(&robot), &robot.inertial_parameters(), &motion);
    (log.q, log.qd) = (motion.q, None);
}

#[test]
fn every_kind_of_fault_is_found_where_it_is() {
    let robot = irb();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    for (place, kind) in ALL.into_iter().enumerate() {
        assert_eq!(kind as usize, place, "{kind:?} is not at its place in the list of all");
        let mut sieved = log(&robot, 250.0, 12.0);
        let (fault, expected) = fault(kind);
        match fault {
            Fault::Reading(change) => change(&mut sieved),
            Fault::Signals(change) => change(&mut sieved.recording),
            Fault::Lines(change) => {
                recording::csv::write(&path, &sieved.recording).unwrap();
                let text = std::fs::read_to_string(&path).unwrap();
                let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
                change(&mut lines);
                std::fs::write(&path, lines.join("\n")).unwrap();
                sieved = lenient::load(&path, Some(&robot.joint_names()), &ColumnMap::default()).unwrap();
            }
        }
        sieved.lines = sieved.lines[..sieved.recording.samples()].to_vec();
        let report = examine(&sieved, Some(&robot_for(kind))).unwrap();
        let found: Vec<_> = report.findings.iter().map(|finding| (finding.kind, finding.place.as_str())).collect();
        assert!(found.iter().any(|(k, p)| *k == kind && p.starts_with(expected)), "{kind:?} at {expected}: {found:?}");
        assert_eq!(
            report.usable,
            !matches!(kind, Kind::TooShort | Kind::NoMotion | Kind::TwoSources),
            "{kind:?}: {found:?}"
        );
    }
    assert_eq!(ALL.len(), Kind::JointName as usize + 1);
}
