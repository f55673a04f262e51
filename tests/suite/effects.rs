//! Laws that every effect of the library keeps, along a random motion of the IRB 1600.

use rand::RngExt;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use tauscope::channels::Channels;
use tauscope::dynamics::{Chain, Motion};
use tauscope::effects::{
    Along, CoulombFriction, Effect, Instant, LIBRARY, Placed, Role, Scope, ViscousFriction, contribution,
};
use tauscope::random;
use tauscope::robot::{self, InertiaCheck, Robot, Unit};

/// Every name there may be.
const VOCABULARY: [&str; 29] = [
    "coulomb_friction",
    "viscous_friction",
    "friction_asymmetry",
    "stribeck_friction",
    "nonlinear_viscous_friction",
    "load_dependent_friction",
    "position_dependent_friction",
    "friction_warm_up",
    "presliding_hysteresis",
    "joint_coupling",
    "rotor_inertia",
    "joint_elasticity",
    "backlash",
    "torque_ripple",
    "joint_spring",
    "one_sided_spring",
    "gravity_balancer",
    "payload",
    "link_inertia_error",
    "base_tilt",
    "torque_gain",
    "torque_offset",
    "torque_lag",
    "time_delay",
    "torque_saturation",
    "encoder_offset",
    "encoder_eccentricity",
    "external_contact",
    "integration_error",
];

/// Frictions that say how the baseline's friction varies, and take energy only together with it.
const VARIATIONS: [&str; 2] = ["friction_asymmetry", "position_dependent_friction"];

/// Largest size of a parameter that has no bound of its own.
const UNBOUNDED: f64 = 1e6;

const PERIOD_S: f64 = 4.0;
const STEP_S: f64 = 0.002;

/// The arm on a random periodic motion.
struct Arm {
    robot: Robot,
    chain: Chain,
    time: Vec<f64>,
    motion: Motion,
}

impl Arm {
    /// Three harmonics with random coefficients on every joint, over `periods`.
    fn new(periods: usize) -> Self {
        let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf");
        let robot = robot::load(urdf, InertiaCheck::Required).unwrap();
        let mut random = random::stream(3, "random motion of the laws", 0);
        let samples = periods * (PERIOD_S / STEP_S).round() as usize;
        let time: Vec<f64> = (0..samples).map(|k| k as f64 * STEP_S).collect();
        let mut motion = Motion::zeros(robot.dof(), samples);
        for joint in 0..robot.dof() {
            for harmonic in 1..=3 {
                let w = TAU * f64::from(harmonic) / PERIOD_S;
                let [a, b]: [f64; 2] = std::array::from_fn(|_| random.random_range(-0.4..0.4));
                for (sample, t) in time.iter().enumerate() {
                    let (sine, cosine) = (w * t).sin_cos();
                    motion.q.channel_mut(joint)[sample] += a * cosine + b * sine;
                    motion.qd.channel_mut(joint)[sample] += w * (b * cosine - a * sine);
                    motion.qdd.channel_mut(joint)[sample] -= w * w * (a * cosine + b * sine);
                }
            }
        }
        Arm { chain: Chain::new(&robot), robot, time, motion }
    }

    /// Torque that a few effects add together.
    fn torque(&self, placed: &[Placed]) -> Channels {
        contribution(placed, &Along::new(&self.robot, &self.chain, &self.time, &self.motion, 0.0))
    }

    /// All that an effect changes: torque at the joints, then the logged torque and position of one joint, less what they
    /// are without it.
    fn changes(&self, placed: &Placed) -> Vec<f64> {
        let mut changes = self.torque(std::slice::from_ref(placed)).as_slice().to_vec();
        let position = self.motion.q.channel(0);
        let torque: Vec<f64> = position.iter().map(|q| 100.0 * q).collect();
        let (mut logged_torque, mut logged_position) = (torque.clone(), position.to_vec());
        placed.effect.distort_torque(&placed.parameters, &mut logged_torque, STEP_S);
        placed.effect.distort_position(&placed.parameters, &mut logged_position);
        changes.extend(logged_torque.iter().zip(&torque).map(|(logged, true_value)| logged - true_value));
        changes.extend(logged_position.iter().zip(position).map(|(logged, true_value)| logged - true_value));
        changes
    }

    /// The arm at one instant: position, velocity and acceleration, directions of motion, and torque on the bodies.
    fn at<'a>(&'a self, [q, qd, qdd]: [&'a [f64]; 3], direction: &'a [f64], load: &'a [f64]) -> Instant<'a> {
        Instant {
            t: 0.5,
            started: 0.0,
            q,
            qd,
            qdd,
            direction,
            load,
            robot: &self.robot,
            chain: &self.chain,
            frames: None,
        }
    }

    /// Every place an effect may have.
    fn places(&self, effect: &dyn Effect) -> std::ops::Range<usize> {
        match effect.about().scope {
            Scope::Joint => 0..self.robot.dof(),
            Scope::Pair => 0..self.robot.dof() - 1,
            Scope::Arm => 0..1,
        }
    }
}

fn finite(bound: f64) -> f64 {
    bound.clamp(-UNBOUNDED, UNBOUNDED)
}

fn amplitudes(effect: &dyn Effect) -> Vec<usize> {
    let is_amplitude = |&index: &usize| effect.parameters()[index].role == Role::Amplitude;
    (0..effect.parameters().len()).filter(is_amplitude).collect()
}

#[test]
fn every_file_is_registered_under_its_name_and_in_the_vocabulary() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/core/src/effects"));
    let entries = |folder: &Path| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    let rooms: Vec<PathBuf> = entries(folder);
    let files: Vec<PathBuf> = rooms.iter().filter(|room| room.is_dir()).flat_map(|room| entries(room)).collect();
    let files: Vec<String> =
        files.iter().map(|file| file.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    let names: Vec<&str> = LIBRARY.iter().map(|effect| effect.about().name).collect();
    for (index, name) in names.iter().enumerate() {
        assert!(VOCABULARY.contains(name), "{name} is not in the vocabulary");
        assert!(files.iter().any(|file| file == name), "{name} is not in a file of its name");
        assert!(!names[..index].contains(name), "{name} is registered twice");
    }
    for file in files.iter().filter(|file| VOCABULARY.contains(&file.as_str())) {
        assert!(names.contains(&file.as_str()), "{file}.rs is not registered");
    }
}

#[test]
fn every_entry_is_complete() {
    for effect in LIBRARY {
        let about = effect.about();
        let name = about.name;
        for text in [about.equation, about.explanation] {
            assert!(!text.trim().is_empty(), "{name}");
        }
        let has_year = about.reference.split(|c: char| !c.is_ascii_digit()).any(|run| run.len() == 4);
        assert!(has_year, "{name}: a reference gives its year: {}", about.reference);
        assert!(!about.rivals.is_empty(), "{name} has no rivals");
        for rival in about.rivals {
            assert!(
                VOCABULARY.contains(&rival.name) && rival.name != name,
                "{name}: rival {} is not in the vocabulary",
                rival.name
            );
            assert!(!rival.how_to_tell.trim().is_empty(), "{name}: {}", rival.name);
        }
        let mut names: Vec<&str> = effect.parameters().iter().map(|parameter| parameter.name).collect();
        for parameter in effect.parameters() {
            assert!(!parameter.symbol.is_empty(), "{name}: {}", parameter.name);
        }
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), effect.parameters().len(), "{name}: a parameter's name is used twice");
    }
}

#[test]
fn bounds_are_ordered_with_typical_inside_and_absence_within_reach() {
    for effect in LIBRARY {
        let mut present = false;
        for parameter in effect.parameters() {
            let what = format!("{}: {}", effect.about().name, parameter.name);
            assert!(parameter.lower < parameter.upper, "{what}");
            assert!(parameter.typical.is_finite(), "{what}");
            assert!((parameter.lower..=parameter.upper).contains(&parameter.typical), "{what}");
            if matches!(parameter.role, Role::Amplitude | Role::Departure) {
                assert!((parameter.lower..=parameter.upper).contains(&0.0), "{what}: zero means absent");
                present |= parameter.typical != 0.0;
            }
        }
        let sizes = effect.parameters().iter().filter(|p| matches!(p.role, Role::Amplitude | Role::Departure));
        assert!(present || sizes.count() == 0, "{}: typically absent", effect.about().name);
    }
}

#[test]
fn absent_means_exactly_no_change() {
    let arm = Arm::new(1);
    for &effect in LIBRARY {
        for joint in arm.places(effect) {
            let absent = Placed::typical(effect, joint).absent();
            assert!(arm.changes(&absent).iter().all(|&v| v == 0.0), "{} on {joint}", effect.about().name);
            assert!(effect.gear(&absent.parameters).is_none_or(|gear| gear.is_rigid()), "{}", effect.about().name);
        }
    }
}

#[test]
fn finite_at_the_bounds() {
    let arm = Arm::new(1);
    for &effect in LIBRARY {
        let parameters = effect.parameters();
        for corner in 0..1usize << parameters.len().min(10) {
            let at_corner = |(index, p): (usize, &tauscope::effects::Parameter)| {
                finite(if corner >> index & 1 == 1 { p.upper } else { p.lower })
            };
            let parameters = parameters.iter().enumerate().map(at_corner).collect();
            let placed = Placed { effect, joint: arm.places(effect).end - 1, parameters };
            assert!(arm.changes(&placed).iter().all(|v| v.is_finite()), "{placed:?}");
            if let Some(gear) = effect.gear(&placed.parameters).filter(|gear| !gear.is_rigid()) {
                let gear = gear.completed(10.0);
                assert!(gear.torque(0.1, 1.0).is_finite() && gear.twist(100.0).is_finite(), "{placed:?}");
            }
        }
    }
}

#[test]
fn amplitudes_enter_linearly() {
    let arm = Arm::new(1);
    for &effect in LIBRARY {
        let amplitudes = amplitudes(effect);
        let typical = Placed::typical(effect, arm.places(effect).end / 2);
        let at = |values: &[f64]| {
            let mut placed = typical.absent();
            for (&index, &value) in amplitudes.iter().zip(values) {
                placed.parameters[index] = value;
            }
            arm.changes(&placed)
        };
        let sizes: Vec<f64> = amplitudes.iter().map(|&index| typical.parameters[index]).collect();
        let together = at(&sizes);
        let doubled = at(&sizes.iter().map(|v| 2.0 * v).collect::<Vec<f64>>());
        let mut sum = vec![0.0; together.len()];
        for index in 0..sizes.len() {
            let mut alone = vec![0.0; sizes.len()];
            alone[index] = sizes[index];
            for (value, more) in sum.iter_mut().zip(at(&alone)) {
                *value += more;
            }
        }
        let scale = 1.0 + together.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        for ((whole, twice), parts) in together.iter().zip(&doubled).zip(&sum) {
            assert!((whole - parts).abs() < 1e-9 * scale, "{} is not additive", effect.about().name);
            assert!((twice - 2.0 * whole).abs() < 1e-9 * scale, "{} is not homogeneous", effect.about().name);
        }
    }
}

#[test]
fn a_law_of_one_joint_has_torque_on_that_joint_alone() {
    let arm = Arm::new(1);
    let dof = arm.robot.dof();
    let values = |scale: f64| (0..dof).map(|joint| scale * (1.0 + 0.3 * joint as f64)).collect::<Vec<f64>>();
    let (q, qd, qdd, load) = (values(0.4), values(-0.7), values(1.3), values(11.0));
    let direction = vec![-1.0; dof];
    let x = arm.at([&q, &qd, &qdd], &direction, &load);
    for &effect in LIBRARY.iter().filter(|effect| effect.about().scope == Scope::Joint) {
        for joint in (0..dof).filter(|&joint| effect.can_be_on(joint, &arm.robot)) {
            let mut out = vec![0.0; dof];
            effect.torque(&Placed::typical(effect, joint).parameters, joint, &x, &vec![0.1; effect.memory()], &mut out);
            let elsewhere = (0..dof).find(|&other| other != joint && out[other] != 0.0);
            assert_eq!(elsewhere, None, "{} on joint {joint}", effect.about().name);
        }
    }
}

#[test]
fn friction_never_adds_energy_over_a_cycle() {
    // The first period only warms the memory up.
    let arm = Arm::new(2);
    let period = arm.time.len() / 2;
    let is_friction = |name: &str| name.contains("friction") || name.contains("hysteresis");
    let mut checked = 0;
    for &effect in LIBRARY.iter().filter(|effect| is_friction(effect.about().name)) {
        for joint in arm.places(effect) {
            let typical = Placed::typical(effect, joint);
            let mut placed = vec![typical.clone()];
            if VARIATIONS.contains(&effect.about().name) {
                // The baseline that the variation varies, just large enough by the unit of each amplitude.
                let total = |unit: Unit| {
                    let sized = |&index: &usize| effect.parameters()[index].unit == unit;
                    amplitudes(effect).iter().filter(|i| sized(i)).map(|&i| typical.parameters[i].powi(2)).sum::<f64>()
                };
                let coulomb = Placed { effect: &CoulombFriction, joint, parameters: vec![total(Unit::Effort).sqrt()] };
                let viscous = Placed { effect: &ViscousFriction, joint, parameters: vec![total(Unit::Damping).sqrt()] };
                placed.extend([coulomb, viscous]);
            }
            let torque = arm.torque(&placed);
            let (mut lost, mut moved) = (0.0, 0.0);
            for channel in 0..arm.robot.dof() {
                let (torque, velocity) = (torque.channel(channel), arm.motion.qd.channel(channel));
                for (t, v) in torque.iter().zip(velocity).skip(period) {
                    lost += t * v * STEP_S;
                    moved += (t * v).abs() * STEP_S;
                }
            }
            assert!(lost >= -1e-9 * moved && moved > 0.0, "{} on {joint} adds {} J", effect.about().name, -lost);
            checked += 1;
        }
    }
    assert!(checked >= 8 * arm.robot.dof(), "{checked} frictions checked");
}

#[test]
fn dry_laws_hold_a_joint_at_standstill_within_a_band() {
    // At zero velocity and direction a dry law gives the middle of the band in which it can hold the joint.
    let arm = Arm::new(1);
    let dof = arm.robot.dof();
    let (still, load) = (vec![0.0; dof], vec![20.0; dof]);
    for &effect in LIBRARY.iter().filter(|effect| effect.about().dry) {
        let name = effect.about().name;
        let placed = Placed::typical(effect, 1);
        let memory = vec![0.0; effect.memory()];
        let torque = |direction: f64| {
            let direction = vec![direction; dof];
            let x = arm.at([&still; 3], &direction, &load);
            let mut out = vec![0.0; dof];
            effect.torque(&placed.parameters, 1, &x, &memory, &mut out);
            out[1]
        };
        assert_eq!(torque(0.0), 0.0, "{name} at standstill");
        let (forward, backward) = (torque(1.0), torque(-1.0));
        assert!(forward != 0.0, "{name} has no breakaway torque");
        assert!(forward == -backward || (name == "friction_asymmetry" && forward == backward), "{name}");
    }
}
