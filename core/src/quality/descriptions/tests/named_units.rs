//! Doubtful units in the names of columns.

use super::*;
use crate::quality::settle_named_units;
use crate::recording::lenient::DoubtfulUnit;

/// A log whose names give a unit, by which it was converted; `quantities` are those of it.
fn named(mut log: Sieved, symbol: &'static str, factor: f64, quantities: [bool; 4]) -> Sieved {
    let notes = vec![format!("in {symbol}")];
    log.corrections.extend(notes.iter().cloned());
    log.doubts = vec![DoubtfulUnit { symbol, factor, quantities, notes }];
    log
}

/// Positions of another size with torques that belong to them, of an arm with friction.
fn swung(robot: &Robot, swing: f64) -> Sieved {
    let mut log = simulated(robot, Oddity::None, 20.0, 3);
    let samples = log.recording.samples();
    let mut random = random::stream(3, "named units", 0);
    let mut motion = Motion::zeros(robot.dof(), samples);
    for joint in 0..robot.dof() {
        for part in [0.6, 0.4] {
            let (rate, phase) = (random.random_range(1.0..4.0), random.random_range(0.0..6.0));
            for row in 0..samples {
                let (sin, cos) = (rate * log.recording.time[row] + phase).sin_cos();
                motion.q.channel_mut(joint)[row] += part * swing * sin;
                motion.qd.channel_mut(joint)[row] += part * swing * rate * cos;
                motion.qdd.channel_mut(joint)[row] -= part * swing * rate * rate * sin;
            }
        }
    }
    let bodies = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion);
    for joint in 0..robot.dof() {
        let size = crate::linear::root_mean_square(bodies.channel(joint)).max(0.1);
        for row in 0..samples {
            let noise: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut random));
            let direction = (motion.qd.channel(joint)[row] / (0.01 * swing)).tanh();
            log.recording.q.channel_mut(joint)[row] = motion.q.channel(joint)[row] + 2e-6 * noise[0];
            log.recording.tau.channel_mut(joint)[row] =
                bodies.channel(joint)[row] + size * (0.1 * direction + 0.01 * noise[1]);
        }
    }
    log
}

#[test]
fn names_in_degrees_stay_unless_the_torques_are_those_of_radians() {
    let robot = irb();
    let degree = 1f64.to_radians();
    let positions = [true, false, false, false];
    // A small motion in degrees, as it was converted.
    for swing in [0.5, 2.5, 6.0] {
        let right = named(swung(&robot, swing * degree), "deg", degree, positions);
        let mut settled = right.clone();
        settle_named_units(&mut settled, &robot).unwrap();
        assert_eq!(settled, Sieved { doubts: Vec::new(), ..right }, "{swing}");
    }
    // Radians that their names made degrees.
    let radians = swung(&robot, 0.6);
    let mut wrong = named(radians.clone(), "deg", degree, positions);
    for joint in 0..robot.dof() {
        wrong.recording.q.channel_mut(joint).iter_mut().for_each(|q| *q *= degree);
    }
    settle_named_units(&mut wrong, &robot).unwrap();
    let (found, right) = (wrong.recording.q.channel(1), radians.recording.q.channel(1));
    assert!(found.iter().zip(right).all(|(found, right)| (found - right).abs() < 1e-12));
    let [note] = &wrong.corrections[..] else { panic!("{:?}", wrong.corrections) };
    assert!(note.contains("are taken in rad"), "{note}");
}

#[test]
fn names_in_millinewton_metres_stay_unless_the_bodies_deny_them() {
    let robot = irb();
    let right = swung(&robot, 0.6);
    let peak = right.recording.tau.channel(1)[77];
    // How many times the torques are those of the bodies, and whether the name is denied.
    for (times, denied) in [(1.0, false), (1.0 / 25.0, false), (1.0 / 40.0, true), (1e-3, true)] {
        let mut log = named(right.clone(), "mN m", 1e-3, [false, false, false, true]);
        for joint in 0..robot.dof() {
            log.recording.tau.channel_mut(joint).iter_mut().for_each(|tau| *tau *= times);
        }
        settle_named_units(&mut log, &robot).unwrap();
        let found = log.recording.tau.channel(1)[77] / peak / times;
        assert!((found - if denied { 1e3 } else { 1.0 }).abs() < 1e-6 * found, "{times}: {found}");
        assert_eq!(log.corrections[0].contains("are taken in N m"), denied);
    }
}
