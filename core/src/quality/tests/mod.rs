//! Faults put into clean logs are found and named; clean logs of different arms and rates have none.

use super::view::View;
use super::*;
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::linear::root_mean_square;
use crate::random;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::robot::{self, InertiaCheck, Robot};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn arm(file: &str) -> Robot {
    robot::load(format!("{ROOT}/{file}"), InertiaCheck::Required).unwrap()
}

pub(super) fn irb() -> Robot {
    arm("urdf/irb1600_6_120.urdf")
}

/// A log of `robot` on a motion of two sines per joint, with friction of a tenth of the torque and noise.
pub(super) fn log(robot: &Robot, rate_hz: f64, seconds: f64) -> Sieved {
    let samples = (rate_hz * seconds) as usize;
    let time: Vec<f64> = (0..samples).map(|i| i as f64 / rate_hz).collect();
    let mut motion = Motion::zeros(robot.dof(), samples);
    for (j, joint) in robot.joints.iter().enumerate() {
        let (lower, upper) = (joint.limits.lower.max(-2.0), joint.limits.upper.min(2.0));
        let (middle, swing) = (0.5 * (lower + upper), 0.3 * (upper - lower));
        for (i, &t) in time.iter().enumerate() {
            for (k, (part, rate)) in [(0.6, 1.3 + 0.37 * j as f64), (0.4, 2.9 + 0.53 * j as f64)].iter().enumerate() {
                let phase = rate * t + 0.7 * (j + k) as f64;
                motion.q.channel_mut(j)[i] += part * swing * phase.sin() + if k == 0 { middle } else { 0.0 };
                motion.qd.channel_mut(j)[i] += part * swing * rate * phase.cos();
                motion.qdd.channel_mut(j)[i] -= part * swing * rate * rate * phase.sin();
            }
        }
    }
    let mut tau = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion);
    let mut noise = random::stream(6, "quality", 0);
    let mut normal = || -> f64 { StandardNormal.sample(&mut noise) };
    let (mut q, mut qd) = (motion.q.clone(), motion.qd.clone());
    for j in 0..robot.dof() {
        let size = root_mean_square(tau.channel(j));
        let speed = root_mean_square(motion.qd.channel(j));
        for i in 0..samples {
            let v = motion.qd.channel(j)[i];
            tau.channel_mut(j)[i] += size * (0.2 * (v / 0.01).tanh() + 0.1 * v / speed + 0.01 * normal());
            q.channel_mut(j)[i] += 2e-6 * normal();
            qd.channel_mut(j)[i] += 0.005 * speed * normal();
        }
    }
    let recording = Recording { joints: robot.joint_names(), time, q, qd: Some(qd), tau, ..Recording::default() };
    Sieved { lines: (2..samples + 2).collect(), recording, ..Sieved::default() }
}

fn found(sieved: &Sieved, robot: Option<&Robot>) -> Vec<(Kind, String)> {
    let report = examine(sieved, robot).unwrap();
    report.findings.into_iter().map(|finding| (finding.kind, finding.place)).collect()
}

/// Puts a fault in and checks that it alone is found, at a place that begins with `place`.
#[track_caller]
fn assert_found(kind: Kind, place: &str, robot: Option<&Robot>, fault: impl Fn(&mut Recording)) {
    let mut sieved = log(&irb(), 250.0, 12.0);
    fault(&mut sieved.recording);
    sieved.lines = (2..sieved.recording.samples() + 2).collect();
    let found = found(&sieved, robot);
    assert!(found.iter().any(|(k, p)| *k == kind && p.starts_with(place)), "{kind:?} at {place}: {found:?}");
    assert!(found.iter().all(|(k, _)| *k == kind), "{kind:?} at {place}, but also others: {found:?}");
}

mod consequences;
mod frozen;
mod presliding;

#[test]
fn clean_logs_have_no_finding() {
    let planar = arm("tests/reference/skew7.urdf");
    for (robot, rate) in [(irb(), 125.0), (irb(), 250.0), (irb(), 1000.0), (planar, 500.0)] {
        for quantised in [false, true] {
            let mut sieved = log(&robot, rate, 12.0);
            if quantised {
                let steps = [(&mut sieved.recording.q, 1e-5), (&mut sieved.recording.tau, 0.01)];
                for (table, step) in steps {
                    table.as_mut_slice().iter_mut().for_each(|v| *v = (*v / step).round() * step);
                }
                sieved.recording.qd = None;
            }
            for known in [None, Some(&robot)] {
                let found = found(&sieved, known);
                assert!(found.is_empty(), "{} at {rate} Hz: {found:?}", robot.name);
            }
        }
    }
}

#[test]
fn a_long_gap_is_the_only_finding_about_itself() {
    let robot = irb();
    let mut sieved = log(&robot, 250.0, 16.0);
    let later = sieved.recording.slice(2500..4000);
    let first = sieved.recording.slice(0..1500);
    sieved.lines.drain(1500..2500);
    let join = |a: &Channels, b: &Channels| a.map(|joint, signal| [signal, b.channel(joint)].concat());
    sieved.recording = Recording {
        time: [first.time, later.time].concat(),
        q: join(&first.q, &later.q),
        qd: first.qd.as_ref().zip(later.qd.as_ref()).map(|(a, b)| join(a, b)),
        tau: join(&first.tau, &later.tau),
        qdd: None,
        truth: None,
        ..first
    };
    let found = found(&sieved, Some(&robot));
    assert!(found.len() == 1 && format!("{found:?}").contains("Gap"), "{found:?}");
}

#[test]
fn torque_faults() {
    let robot = irb();
    for known in [None, Some(&robot)] {
        assert_found(Kind::TorqueSign, "tau2", known, |log| log.tau.channel_mut(1).iter_mut().for_each(|v| *v = -*v));
        assert_found(Kind::Clipped, "tau3", known, |log| {
            let top = log.tau.channel(2).iter().fold(0.0f64, |m, v| m.max(v.abs()));
            log.tau.channel_mut(2).iter_mut().for_each(|v| *v = v.clamp(-0.7 * top, 0.7 * top));
        });
        assert_found(Kind::Frozen, "tau5", known, |log| {
            let held = log.tau.channel(4)[1000];
            log.tau.channel_mut(4)[1000..1100].fill(held);
        });
        assert_found(Kind::HeldSamples, "tau1", known, |log| {
            let tau = log.tau.channel(0).to_vec();
            (0..tau.len()).for_each(|i| log.tau.channel_mut(0)[i] = tau[i - i % 2]);
        });
        assert_found(Kind::NoTorque, "tau6", known, |log| log.tau.channel_mut(5).fill(0.0));
    }
    assert_found(Kind::UnsignedTorque, "tau4", None, |log| {
        log.tau.channel_mut(3).iter_mut().for_each(|v| *v = v.abs());
    });
    assert_found(Kind::TorqueUnit, "tau", Some(&robot), |log| {
        log.tau.as_mut_slice().iter_mut().for_each(|v| *v *= 1e3);
    });
    assert_found(Kind::DeadTime, "tau", Some(&robot), |log| {
        for joint in 0..6 {
            let tau = log.tau.channel(joint).to_vec();
            (3..tau.len()).for_each(|i| log.tau.channel_mut(joint)[i] = tau[i - 3]);
        }
    });
    assert_found(Kind::Swapped, "tau2", Some(&robot), |log| {
        let (second, fourth) = (log.tau.channel(1).to_vec(), log.tau.channel(3).to_vec());
        log.tau.channel_mut(1).copy_from_slice(&fourth);
        log.tau.channel_mut(3).copy_from_slice(&second);
    });
}

#[test]
fn a_torque_that_turns_near_zero_has_its_sign() {
    let mut sieved = log(&irb(), 250.0, 12.0);
    let tau = sieved.recording.tau.channel_mut(1);
    for (i, tau) in tau.iter_mut().enumerate() {
        *tau = -10.0 * (1.01 + (0.01 * i as f64).cos()) - 0.05 * (i % 7) as f64 / 7.0;
    }
    let report = examine(&sieved, None).unwrap();
    assert!(report.findings.iter().all(|finding| finding.kind != Kind::UnsignedTorque), "{:?}", report.findings);
}

#[test]
fn dead_time_is_measured() {
    let robot = irb();
    let mut sieved = log(&robot, 250.0, 12.0);
    for joint in 0..6 {
        let tau = sieved.recording.tau.channel(joint).to_vec();
        (3..tau.len()).for_each(|i| sieved.recording.tau.channel_mut(joint)[i] = tau[i - 3]);
    }
    let report = examine(&sieved, Some(&robot)).unwrap();
    for lag in report.joints.iter().filter_map(|joint| joint.dead_time_s) {
        assert!((lag - 0.012).abs() < 0.002, "{lag}");
    }
    assert_eq!(report.description, None);
}

/// The time that all torques come behind is taken off before descriptions are judged.
#[test]
fn descriptions_are_judged_on_torques_at_their_time() {
    let robot = irb();
    let late = |by: usize| {
        let mut sieved = log(&robot, 250.0, 12.0);
        for joint in 0..6 {
            let tau = sieved.recording.tau.channel(joint).to_vec();
            (by..tau.len()).for_each(|i| sieved.recording.tau.channel_mut(joint)[i] = tau[i - by]);
        }
        let view = View::new(&sieved.recording, Some(&robot)).unwrap();
        let mut summaries = motion::summaries(&view, Some(&robot));
        torque::examined(&view, &mut summaries, Some(&robot)).late
    };
    assert_eq!([late(0), late(1), late(3)], [0, 0, 3]);
}

#[test]
fn torques_that_come_half_a_second_late_or_early_are_found() {
    let robot = irb();
    for (rate_hz, delay) in [(250.0, 0.1), (250.0, 0.4), (50.0, 0.2), (100.0, -0.15)] {
        let mut sieved = log(&robot, rate_hz, 20.0);
        let by = (delay * rate_hz).round() as isize;
        let (all, cut) = (sieved.recording.samples(), by.unsigned_abs());
        let [first, last] = [sieved.recording.slice(0..all - cut), sieved.recording.slice(cut..all)];
        let (motion, torques) = if by > 0 { (last, first) } else { (first, last) };
        sieved.recording = Recording { tau: torques.tau, ..motion };
        sieved.lines.truncate(all - cut);
        let report = examine(&sieved, Some(&robot)).unwrap();
        let told: Vec<&Finding> = report.findings.iter().filter(|f| f.kind == Kind::DeadTime).collect();
        let [told] = told[..] else { panic!("{delay}: {:?}", report.findings) };
        let side = if delay > 0.0 { "comes behind" } else { "comes ahead of" };
        assert!(told.text.contains(side), "{}", told.text);
        for lag in report.joints.iter().filter_map(|joint| joint.dead_time_s) {
            assert!((lag - delay).abs() < 0.02, "{lag} of {delay}");
        }
    }
}

/// A joint on a level axis that goes to and fro at one speed, and whose torque comes to zero twice: on the way, with its sign lost, and
/// where the joint reverses.
#[test]
fn a_few_visits_of_zero_are_chance_unless_the_sign_explains_the_torque() {
    let is_lost = |law: &dyn Fn(f64) -> f64| {
        let samples = 3600;
        let time: Vec<f64> = (0..samples).map(|i| 0.005 * i as f64).collect();
        let q: Vec<f64> = time.iter().map(|t| 1.0 - 0.25 * (t % 16.0 - 8.0).abs()).collect();
        let mut noise = random::stream(8, "visits", 0);
        let mut normal = || -> f64 { StandardNormal.sample(&mut noise) };
        let tau = q.iter().map(|&q| (law(q) + 1e-3 * normal()).abs()).collect();
        let of = |signal: Vec<f64>| Channels::from_vectors(&[signal]);
        let recording =
            Recording { joints: vec!["a".into()], time, q: of(q), qd: None, tau: of(tau), ..Recording::default() };
        let sieved = Sieved { lines: (2..samples + 2).collect(), recording, ..Sieved::default() };
        let report = examine(&sieved, None).unwrap();
        report.findings.iter().any(|finding| finding.kind == Kind::UnsignedTorque)
    };
    assert!(is_lost(&|q| 10.0 * q.sin()));
    assert!(!is_lost(&|q| 10.0 * (q.sin() + 1f64.sin()) + 0.005));
}

#[test]
fn position_and_velocity_faults() {
    let robot = irb();
    let degrees = 180.0 / std::f64::consts::PI;
    for known in [None, Some(&robot)] {
        assert_found(Kind::VelocitySign, "qd3", known, |log| {
            log.qd.as_mut().unwrap().channel_mut(2).iter_mut().for_each(|v| *v = -*v);
        });
        assert_found(Kind::VelocityUnit, "qd", known, |log| {
            log.qd.as_mut().unwrap().as_mut_slice().iter_mut().for_each(|v| *v *= degrees);
        });
        assert_found(Kind::VelocityUnit, "qd1", known, |log| {
            log.qd.as_mut().unwrap().channel_mut(0).iter_mut().for_each(|v| *v *= 30.0 / std::f64::consts::PI);
        });
        assert_found(Kind::Swapped, "qd1", known, |log| {
            let (first, third) =
                (log.qd.as_ref().unwrap().channel(0).to_vec(), log.qd.as_ref().unwrap().channel(2).to_vec());
            log.qd.as_mut().unwrap().channel_mut(0).copy_from_slice(&third);
            log.qd.as_mut().unwrap().channel_mut(2).copy_from_slice(&first);
        });
        assert_found(Kind::VelocityDelay, "qd2", known, |log| {
            let qd = log.qd.as_ref().unwrap().channel(1).to_vec();
            (5..qd.len()).for_each(|i| log.qd.as_mut().unwrap().channel_mut(1)[i] = qd[i - 5]);
        });
        assert_found(Kind::PositionUnit, "q", known, |log| {
            log.q.as_mut_slice().iter_mut().for_each(|v| *v *= degrees);
            log.qd.as_mut().unwrap().as_mut_slice().iter_mut().for_each(|v| *v *= degrees);
        });
        assert_found(Kind::Spike, "q4 (", known, |log| log.q.channel_mut(3)[700] += 0.8);
        assert_found(Kind::Frozen, "q2", known, |log| {
            let held = log.q.channel(1)[990];
            log.q.channel_mut(1)[990..1040].fill(held);
        });
        assert_found(Kind::NoMotion, "q", known, |log| {
            log.q.as_mut_slice().fill(0.3);
            log.qd.as_mut().unwrap().as_mut_slice().fill(0.0);
        });
    }
    assert_found(Kind::OutsideLimits, "q2", Some(&robot), |log| {
        let upper = irb().joints[1].limits.upper;
        let before = torque_of_bodies(log);
        let top = log.q.channel(1).iter().fold(f64::MIN, |m, v| m.max(*v));
        log.q.channel_mut(1).iter_mut().for_each(|v| *v += upper - top + 0.05);
        // The torque is that of the true positions.
        let after = torque_of_bodies(log);
        let change = after.as_slice().iter().zip(before.as_slice()).map(|(after, before)| after - before);
        log.tau.as_mut_slice().iter_mut().zip(change).for_each(|(tau, change)| *tau += change);
    });
}

/// Torque of the bodies along a log's own positions, without friction.
fn torque_of_bodies(log: &Recording) -> Channels {
    let view = View::new(log, None).unwrap();
    let motion = Motion { q: view.q.clone(), qd: view.qd.clone(), qdd: view.qdd.clone() };
    inverse_dynamics(&Chain::new(&irb()), &irb().inertial_parameters(), &motion)
}

/// A torque that was not logged is reported as that, and not taken for columns in the wrong order.
#[test]
fn a_constant_torque_is_no_exchange() {
    let robot = irb();
    for (joint, level) in [(0, 12.5), (0, 0.0), (1, -300.0), (4, 3.0)] {
        let mut sieved = log(&robot, 250.0, 12.0);
        sieved.recording.tau.channel_mut(joint).fill(level);
        let report = examine(&sieved, Some(&robot)).unwrap();
        let worse = |finding: &&Finding| finding.severity != Severity::Note;
        let told: Vec<&Finding> = report.findings.iter().filter(worse).collect();
        assert_eq!(told.len(), 1, "joint {joint} at {level}: {told:?}");
        assert_eq!(told[0].kind, Kind::NoTorque);
        assert!(told[0].place.contains(&format!("tau{}", joint + 1)), "{told:?}");
    }
}

/// A joint that stands and has no torque gets one finding, that it stands; one that moves without torque gets that of its torque.
#[test]
fn a_joint_that_stands_without_torque_is_one_matter() {
    let robot = irb();
    for (stands, torque, kind) in
        [(true, false, Kind::HardlyMoves), (false, false, Kind::NoTorque), (true, true, Kind::HardlyMoves)]
    {
        let mut sieved = log(&robot, 250.0, 12.0);
        let recording = &mut sieved.recording;
        if stands {
            recording.q.channel_mut(4).fill(0.2);
            [&mut recording.qd, &mut recording.qdd]
                .into_iter()
                .flatten()
                .for_each(|rate| rate.channel_mut(4).fill(0.0));
        }
        if !torque {
            recording.tau.channel_mut(4).fill(0.0);
        }
        let report = examine(&sieved, Some(&robot)).unwrap();
        let own = |finding: &&Finding| finding.place.contains("joint_5") && finding.severity != Severity::Note;
        let told: Vec<Kind> = report.findings.iter().filter(own).map(|finding| finding.kind).collect();
        assert_eq!(told, [kind], "{:?}", report.findings);
    }
}

#[test]
fn rows_that_were_lost_are_no_jitter() {
    let robot = irb();
    let mut sieved = log(&robot, 250.0, 12.0);
    let recording = &mut sieved.recording;
    let kept: Vec<usize> = (0..recording.samples()).filter(|row| ![700, 1500, 2400].contains(row)).collect();
    let thin = |table: &Channels| table.map(|_, signal| kept.iter().map(|&row| signal[row]).collect());
    (recording.q, recording.tau) = (thin(&recording.q), thin(&recording.tau));
    recording.qd = recording.qd.as_ref().map(thin);
    recording.time = kept.iter().map(|&row| recording.time[row]).collect();
    sieved.lines = kept.iter().map(|row| row + 2).collect();
    let report = examine(&sieved, Some(&robot)).unwrap();
    assert!(report.findings.iter().all(|finding| finding.kind != Kind::Jitter), "{:?}", report.findings);
    let gap = report.findings.iter().find(|finding| finding.kind == Kind::Gap).unwrap();
    assert!(gap.text.starts_with("3 gaps") && gap.text.contains("3 rows lost"), "{gap:?}");
    assert!(gap.place.starts_with("2.7960 s (line 701)"), "{gap:?}");
    assert!(report.clock.jitter_s < 1e-9, "{}", report.clock.jitter_s);
}

/// Currents of few digits rest between them, and stay what they are when a jittered log is taken at even steps.
#[test]
fn a_torque_of_few_digits_is_not_frozen() {
    let robot = irb();
    let mut sieved = log(&robot, 2000.0, 12.0);
    let recording = &mut sieved.recording;
    let mut random = random::stream(8, "jitter", 0);
    let rows: Vec<usize> = (1..2400).map(|k| 10 * k + random.random_range(0..3)).collect();
    let thin = |table: &Channels| table.map(|_, signal| rows.iter().map(|&row| signal[row]).collect());
    (recording.q, recording.tau) = (thin(&recording.q), thin(&recording.tau));
    recording.qd = recording.qd.as_ref().map(thin);
    recording.time = rows.iter().map(|&row| recording.time[row]).collect();
    recording.tau = recording.tau.map(|_, tau| {
        let step = 0.05 * tau.iter().fold(0.0f64, |most, tau| most.max(tau.abs()));
        tau.iter().map(|tau| (tau / step).round() * step).collect()
    });
    sieved.lines = rows.iter().map(|row| row + 2).collect();
    let report = examine(&sieved, Some(&robot)).unwrap();
    assert!(report.clock.is_irregular());
    let told = report.findings.iter().filter(|finding| finding.kind == Kind::Frozen);
    assert_eq!(told.count(), 0, "{:?}", report.findings);
}

/// A joint that comes to rest at full speed, of which the velocity still shows the last two samples of motion, stands.
#[test]
fn a_joint_that_stops_is_not_frozen() {
    let mut sieved = log(&irb(), 250.0, 12.0);
    let (q, qd) = (&mut sieved.recording.q, sieved.recording.qd.as_mut().unwrap());
    let speed = |k: &usize| qd.channel(1)[*k].abs();
    let at = (300..1200).max_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap();
    let lost = q.channel(1)[at + 50] - q.channel(1)[at];
    let held = q.channel(1)[at];
    q.channel_mut(1)[at..at + 50].fill(held);
    q.channel_mut(1)[at + 50..].iter_mut().for_each(|q| *q -= lost);
    qd.channel_mut(1)[at + 2..at + 50].fill(0.0);
    let report = examine(&sieved, Some(&irb())).unwrap();
    assert!(report.findings.iter().all(|finding| finding.kind != Kind::Frozen), "{:?}", report.findings);
}

/// A joint that waits for most of a log until it is its turn has the noise of its velocity meanwhile; one whose encoder hangs for as long a
/// velocity.
#[test]
fn a_joint_that_waits_for_its_turn_is_not_frozen() {
    let waiting = |speed: f64| {
        let mut sieved = log(&irb(), 250.0, 12.0);
        let samples = sieved.recording.samples();
        let until = samples - samples / 30;
        let (q, qd) = (&mut sieved.recording.q, sieved.recording.qd.as_mut().unwrap());
        let (held, mut noise) = (q.channel(5)[until], random::stream(9, "waiting", 0));
        q.channel_mut(5)[..until].fill(held);
        let mut normal = || -> f64 { StandardNormal.sample(&mut noise) };
        qd.channel_mut(5)[..until].iter_mut().for_each(|qd| *qd = speed + 0.3 * normal());
        let report = examine(&sieved, Some(&irb())).unwrap();
        report.findings.iter().any(|finding| finding.kind == Kind::Frozen)
    };
    assert!(!waiting(0.0));
    assert!(waiting(2.0));
}

/// Of torques without their signs nothing is said about signs; where all have lost theirs, that is one cause.
#[test]
fn unsigned_torques_have_no_wrong_sign() {
    let unsigned = |joints: &[usize]| {
        let mut sieved = log(&irb(), 250.0, 12.0);
        let tau = &mut sieved.recording.tau;
        joints.iter().for_each(|&joint| tau.channel_mut(joint).iter_mut().for_each(|v| *v = v.abs()));
        let report = examine(&sieved, Some(&irb())).unwrap();
        assert_eq!(report.description, None, "{:?}", report.findings);
        let worse = report.findings.into_iter().filter(|finding| finding.severity != Severity::Note);
        worse.map(|finding| (finding.kind, finding.place)).collect::<Vec<_>>()
    };
    assert_eq!(unsigned(&[0, 1, 2, 3, 4, 5]), [(Kind::UnsignedTorque, "tau1 .. tau6".to_owned())]);
    let mut all = log(&irb(), 250.0, 12.0);
    all.recording.tau.as_mut_slice().iter_mut().for_each(|v| *v = v.abs());
    assert!(!examine(&all, Some(&irb())).unwrap().usable);
    let some = unsigned(&[3, 4]);
    assert!(some.len() == 2 && some.iter().all(|(kind, _)| *kind == Kind::UnsignedTorque), "{some:?}");
}

/// A position that was wrapped at half a turn is that: no degrees, and no fault of what is compared with it.
#[test]
fn a_position_wrapped_at_half_a_turn_is_told_as_that() {
    let half = std::f64::consts::FRAC_PI_2;
    for known in [None, Some(&irb())] {
        let mut sieved = log(&irb(), 250.0, 12.0);
        sieved.recording.qd = None;
        let q = sieved.recording.q.channel_mut(5);
        q.iter_mut().for_each(|q| *q = q.rem_euclid(2.0 * half));
        let told = found(&sieved, known);
        assert!(told.len() == 1 && told[0].0 == Kind::Wrapped && told[0].1.starts_with("q6"), "{told:?}");
    }
}

#[test]
fn clock_faults() {
    let robot = irb();
    assert_found(Kind::Gap, "5.0000 s (line 1252)", Some(&robot), |log| {
        let (head, tail) = (log.slice(0..1251), log.slice(1265..log.samples()));
        let join = |a: &Channels, b: &Channels| a.map(|j, signal| [signal, b.channel(j)].concat());
        *log = Recording {
            time: [head.time, tail.time].concat(),
            q: join(&head.q, &tail.q),
            qd: head.qd.zip(tail.qd).map(|(a, b)| join(&a, &b)),
            tau: join(&head.tau, &tail.tau),
            ..log.clone()
        };
    });
    assert_found(Kind::TooShort, "rows", Some(&robot), |log| *log = log.slice(0..40));
    let mut sieved = log(&robot, 250.0, 12.0);
    let mut random = random::stream(7, "jitter", 0);
    for time in &mut sieved.recording.time {
        let shift: f64 = StandardNormal.sample(&mut random);
        *time += 0.0004 * shift.clamp(-3.0, 3.0);
    }
    let report = examine(&sieved, Some(&robot)).unwrap();
    assert!(report.findings.iter().any(|finding| finding.kind == Kind::Jitter), "{:?}", report.findings);
    assert!((report.clock.jitter_s / (0.0004 * 2f64.sqrt()) - 1.0).abs() < 0.1, "{}", report.clock.jitter_s);
}

/// Counts of an encoder, and velocities in a unit of their own: they are in no proportion that a clock explains.
#[test]
fn counts_show_no_clock() {
    let robot = irb();
    let mut sieved = log(&robot, 250.0, 12.0);
    let recording = &mut sieved.recording;
    recording.q.as_mut_slice().iter_mut().for_each(|q| *q = (2048.0 + *q * 4096.0 / std::f64::consts::TAU).round());
    let qd = recording.qd.as_mut().unwrap();
    qd.as_mut_slice().iter_mut().for_each(|v| *v = (*v * 30.0 / std::f64::consts::PI / 0.229).round());
    let report = examine(&sieved, Some(&robot)).unwrap();
    let kinds: Vec<Kind> = report.findings.iter().map(|finding| finding.kind).collect();
    assert_eq!((kinds, report.units.is_none()), (vec![Kind::PositionUnit], true), "{:?}", report.findings);
}
