//! The arm as identified so far: what effects in gears and sensors, and friction under load, act upon.

use super::arm_parameters::Trust;
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics, mass_matrix};
use crate::effects::{Along, Contribution, Placed, Poses, Rounding, Site, of_law};
use crate::identification::model::Model;
use crate::identification::standard::{ROTOR, STANDARD};
use crate::robot::Robot;

/// Mass and first moments, after which a link's moments of inertia come.
const MOMENTS: usize = 4;

/// The arm with the parameters found for its baseline.
#[derive(Debug, Clone)]
pub struct Arm {
    /// The arm as its URDF describes it.
    known: Robot,
    /// The same geometry with the parameters found. Where only base parameters are determined, the standard parameters
    /// that carry them make up for the others, which are as described: the torque is the same.
    found: Robot,
    chain: Chain,
    trust: Trust,
    /// What each joint's rotor has of the inertia of its link, where only their sum is determined, more than the description says, kg m2 (kg);
    /// zero where nothing shows it.
    to_rotors: Vec<f64>,
    /// Speed over which the dry friction of each joint changes its direction, rad/s or m/s: tanh(v / width); zero for the plain sign.
    pub coulomb_rounding: Vec<Rounding>,
}

impl Arm {
    /// The arm before anything is identified.
    pub fn new(robot: &Robot, trust: Trust) -> Self {
        let coulomb_rounding = vec![Rounding::Sharp; robot.dof()];
        let to_rotors = vec![0.0; robot.dof()];
        Arm { known: robot.clone(), found: robot.clone(), chain: Chain::new(robot), trust, to_rotors, coulomb_rounding }
    }

    /// The same with `more` of a joint's inertia in its rotor, kg m2 (kg). None where the motion or the description tells the rotor's
    /// inertia, or one of the two would be negative.
    pub(crate) fn with_more_in_rotor(&self, model: &Model, joint: usize, more: f64) -> Option<Self> {
        let is_open = self.known.joints[joint].drive.armature == 0.0 && !model.rotor_stands_alone(joint);
        let rotor = self.found.joints[joint].drive.armature + more;
        if self.trust == Trust::Nominal || !is_open || rotor < 0.0 {
            return None;
        }
        let mut arm = self.clone();
        arm.to_rotors[joint] += more;
        let mut standard = Model::standard_values(&arm.found);
        move_to_rotor(model, joint, more, &mut standard);
        arm.found = Model::with_standard_values(&arm.found, &standard);
        Some(arm)
    }

    /// The same with friction that changes its direction over some speed on each joint, rad/s or m/s.
    pub(crate) fn with_coulomb_rounding(self, coulomb_rounding: Vec<Rounding>) -> Self {
        Arm { coulomb_rounding, ..self }
    }

    /// The arm as found.
    pub fn found(&self) -> &Robot {
        &self.found
    }

    /// The arm as described.
    pub fn described(&self) -> &Robot {
        &self.known
    }

    /// Its bodies and joints, as described.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Whether its inertias are taken from the description, or estimated.
    pub fn trust(&self) -> Trust {
        self.trust
    }

    /// All that was found of the arm or described since, bit by bit: what the torque of effects upon it depends on.
    pub(crate) fn state(&self) -> Vec<u64> {
        let of = |robot: &Robot| {
            Model::standard_values(robot).into_iter().chain(robot.gravity.iter().copied().collect::<Vec<_>>())
        };
        [&self.known, &self.found].into_iter().flat_map(of).map(f64::to_bits).collect()
    }

    /// Takes over values of the baseline: base parameters where the inertias are estimated; else frictions among these, then the rotor
    /// inertia of every joint that has an equation.
    pub fn take(&mut self, model: &Model, values: &[f64]) {
        let mut standard = Model::standard_values(&self.known);
        match self.trust {
            Trust::Structure => {
                // What motion does not determine is as described. It matters to what gears carry, which is the torque of the bodies
                // alone though only the sum of a rotor's and a link's inertia is determined, and to gravity of another direction.
                model.base().kept().iter().for_each(|&kept| standard[kept] = 0.0);
                let described = model.base().values(&standard);
                let sums: Vec<f64> = values.iter().zip(described).map(|(value, described)| value - described).collect();
                for (&kept, value) in model.base().kept().iter().zip(model.base().carried(&sums)) {
                    standard[kept] = value;
                }
                self.split_off_rotors(model, &mut standard);
            }
            Trust::Nominal => {
                let friction = (0..model.base().len()).filter(|&b| model.is_friction(b));
                let rotors = (0..model.dof()).filter(|&joint| model.has_equation(joint));
                let rotors = rotors.map(|joint| joint * STANDARD + ROTOR);
                let places = friction.map(|b| model.base().kept()[b]).chain(rotors);
                for (place, &value) in places.zip(values) {
                    standard[place] = value;
                }
            }
        }
        self.found = Model::with_standard_values(&self.known, &standard);
    }

    /// Takes a change of the standard parameters that no base parameter shows into the description: what effects that turn gravity showed.
    pub fn describe(&mut self, change: &[f64]) {
        for robot in [&mut self.known, &mut self.found] {
            let mut standard = Model::standard_values(robot);
            standard.iter_mut().zip(change).for_each(|(value, change)| *value += change);
            *robot = Model::with_standard_values(robot, &standard);
        }
    }

    /// Takes what a link's inertia has more than described for that of its joint's rotor, where only their sum is determined and the
    /// description knows of no rotor: descriptions without rotors are more common than arms that have none. What impacts in a gear show of
    /// its rotor is added.
    fn split_off_rotors(&self, model: &Model, standard: &mut [f64]) {
        let described = Model::standard_values(&self.known);
        let (kept, regrouping) = (model.base().kept(), model.base().regrouping());
        for joint in (0..model.dof()).filter(|joint| !model.rotor_stands_alone(*joint)) {
            let (first, rotor) = (joint * STANDARD, joint * STANDARD + ROTOR);
            let shares = regrouping.column(rotor);
            let own = (0..kept.len()).find(|&b| (first + MOMENTS..rotor).contains(&kept[b]) && shares[b] > 0.5);
            let more = own.map_or(0.0, |own| (standard[kept[own]] - described[kept[own]]) / shares[own]);
            let of_rotor = if described[rotor] == 0.0 { more.max(0.0) } else { 0.0 };
            let more = of_rotor + self.to_rotors[joint];
            if more != 0.0 {
                move_to_rotor(model, joint, more, standard);
            }
        }
    }

    /// What laws at a site ask about a motion. What rapier's step gets wrong depends on where each mass really is: in the description.
    pub(crate) fn laws_along<'a>(&'a self, site: Site, time: &'a [f64], motion: &'a Motion) -> Along<'a> {
        let robot = if site == Site::Integrator { &self.known } else { &self.found };
        Along::turning_over(robot, &self.chain, time, motion, &self.coulomb_rounding)
    }

    /// Torque of effects along a motion, one each: that of laws at joints, on bodies and in the integrator, none of gears and sensors.
    pub(crate) fn contributions(&self, placed: &[Placed], time: &[f64], motion: &Motion) -> Vec<Contribution> {
        let sites: Vec<(Site, Along)> =
            law_sites(placed).map(|site| (site, self.laws_along(site, time, motion))).collect();
        let mut laws = Laws::new(&sites);
        placed.iter().map(|one| laws.torque(one).unwrap_or_default()).collect()
    }

    /// Torque that the gears of the arm as found carry, `[joint][time]`: that of the bodies alone.
    pub fn load(&self, motion: &Motion) -> Channels {
        inverse_dynamics(&self.chain, &self.found.inertial_parameters(), motion)
    }

    /// Inertia of the arm as found about one of its joints at a sample of a motion, kg m2 (kg for one that slides).
    pub(crate) fn inertia_along(&self, joint: usize, motion: &Motion, sample: usize) -> f64 {
        let q: Vec<f64> = (0..motion.joints()).map(|other| motion.q.channel(other)[sample]).collect();
        self.inertia_about(joint, &q)
    }

    /// The same at the positions `q`.
    pub(crate) fn inertia_about(&self, joint: usize, q: &[f64]) -> f64 {
        mass_matrix(&self.chain, &self.found.inertial_parameters(), q)[(joint, joint)]
    }

    /// Inertia of a joint's rotor seen at the joint, kg m2 (kg for one that slides): as found, or as described where only its
    /// sum with the link's is determined; None where neither is known.
    pub fn rotor(&self, joint: usize) -> Option<f64> {
        let of = |robot: &Robot| Some(robot.joints[joint].drive.armature).filter(|rotor| *rotor > 0.0);
        of(&self.found).or_else(|| of(&self.known))
    }

    /// Torque of the arm as found, `[joint][time]`: bodies along `link`, rotors and friction along `motor`.
    pub fn torque(&self, motor: &Motion, link: &Motion) -> Channels {
        let mut torque = inverse_dynamics(&self.chain, &self.found.inertial_parameters(), link);
        for (joint, spec) in self.found.joints.iter().enumerate() {
            let drive = spec.drive;
            let moving = motor.qd.channel(joint).iter().zip(motor.qdd.channel(joint));
            for (value, (&v, &a)) in torque.channel_mut(joint).iter_mut().zip(moving) {
                let direction = self.coulomb_rounding[joint].direction(v, a);
                *value += drive.armature * a + drive.viscous * v + drive.coulomb * direction;
            }
        }
        torque
    }
}

/// Where the law of an effect has torque along a known motion: at the joints or in the integrator. None for effects in gears and sensors.
fn law_site(placed: &Placed) -> Option<Site> {
    match placed.effect.about().site {
        Site::Body | Site::Joint => Some(Site::Joint),
        Site::Integrator => Some(Site::Integrator),
        _ => None,
    }
}

/// The sites at which some of these effects have laws.
pub(crate) fn law_sites(placed: &[Placed]) -> impl Iterator<Item = Site> {
    [Site::Joint, Site::Integrator].into_iter().filter(|site| placed.iter().any(|one| law_site(one) == Some(*site)))
}

/// Laws along a motion, by what they ask at each of their sites.
pub(crate) struct Laws<'s, 'a> {
    sites: Vec<(Site, &'s Along<'a>, Poses)>,
}

impl<'s, 'a> Laws<'s, 'a> {
    pub(crate) fn new(sites: &'s [(Site, Along<'a>)]) -> Self {
        Laws { sites: sites.iter().map(|(site, along)| (*site, along, Poses::default())).collect() }
    }

    /// Torque of an effect; None for effects in gears and sensors.
    pub(crate) fn torque(&mut self, placed: &Placed) -> Option<Contribution> {
        let own = law_site(placed)?;
        let (_, along, poses) = self.sites.iter_mut().find(|(site, ..)| *site == own)?;
        Some(of_law(placed, along, poses))
    }
}

/// Moves inertia from the bodies to a joint's rotor in `standard` parameters where only their sum is determined: the torque stays as it is.
fn move_to_rotor(model: &Model, joint: usize, more: f64, standard: &mut [f64]) {
    let rotor = joint * STANDARD + ROTOR;
    standard[rotor] += more;
    let shares = model.base().carried(model.base().regrouping().column(rotor).as_slice());
    model.base().kept().iter().zip(shares).for_each(|(&kept, share)| standard[kept] -= share * more);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{InertiaCheck, load};

    /// The IRB 1600, and its description without rotors.
    fn with_and_without_rotors() -> [Robot; 2] {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let real = load(path, InertiaCheck::Required).unwrap();
        let mut described = real.clone();
        described.joints.iter_mut().for_each(|joint| joint.drive.armature = 0.0);
        [real, described]
    }

    /// Base parameters of the IRB 1600 as they are give its torque back, shared rightly among bodies and rotors.
    #[test]
    fn a_description_without_rotors_leaves_what_is_more_to_them() {
        let [real, described] = with_and_without_rotors();
        let model = Model::new(&described);
        let mut arm = Arm::new(&described, Trust::Structure);
        arm.take(&model, &model.base().values(&Model::standard_values(&real)));
        assert!(!model.rotor_stands_alone(0) && !model.rotor_stands_alone(1));
        for (found, real) in arm.found().joints.iter().zip(&real.joints) {
            assert!((found.drive.armature - real.drive.armature).abs() < 1e-9, "{}", real.name);
        }
    }

    #[test]
    fn what_motion_does_not_tell_is_as_described() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let robot = load(path, InertiaCheck::Required).unwrap();
        let model = Model::new(&robot);
        let wave = |f: fn(f64) -> f64, size: f64| {
            Channels::from_vectors(
                &(0..6).map(|j| (0..20).map(|t| size * f(0.3 * t as f64 + j as f64)).collect()).collect::<Vec<_>>(),
            )
        };
        let motion = Motion { q: wave(f64::sin, 1.0), qd: wave(f64::cos, 2.0), qdd: wave(f64::sin, -4.0) };
        let mut arm = Arm::new(&robot, Trust::Structure);
        let (torque, load) = (arm.torque(&motion, &motion), arm.load(&motion));
        let close = |a: &Channels, b: &Channels| {
            a.as_slice().iter().zip(b.as_slice()).all(|(a, b)| (a - b).abs() < 1e-9 * (1.0 + b.abs()))
        };
        assert!(!model.rotor_stands_alone(0) && robot.joints[0].drive.armature > 0.0);
        arm.take(&model, &model.base().values(&Model::standard_values(&robot)));
        assert!(close(&arm.torque(&motion, &motion), &torque));
        assert!(close(&arm.load(&motion), &load), "a gear carries the bodies alone");
        // A vertical axis that is tilted feels what it never did before.
        let mut tilted = robot.clone();
        tilted.gravity = nalgebra::Vector3::new(1.0, 0.5, -9.7);
        let under = |robot: &Robot| inverse_dynamics(&Chain::new(&tilted), &robot.inertial_parameters(), &motion);
        assert!(close(&under(arm.found()), &under(&robot)), "under another gravity");
    }

    /// Only the sum of link and rotor is determined on the first two joints of a 6R arm; the third turns parallel to the second.
    #[test]
    fn inertia_moves_to_a_rotor_where_only_the_sum_is_determined() {
        let [real, robot] = with_and_without_rotors();
        let model = Model::new(&robot);
        let arm = Arm::new(&robot, Trust::Structure);
        let wave = |order: i32| -> Vec<Vec<f64>> {
            let at = |joint: usize, k: usize| {
                1.7f64.powi(order) * (0.1 * k as f64 + joint as f64 + 1.57 * f64::from(order)).sin()
            };
            (0..6).map(|joint| (0..50).map(|k| at(joint, k)).collect()).collect()
        };
        let [q, qd, qdd] = [0, 1, 2].map(|order| Channels::from_vectors(&wave(order)));
        let motion = Motion { q, qd, qdd };
        let more = 0.2 * arm.inertia_about(1, &[0.0; 6]);
        let divided = arm.with_more_in_rotor(&model, 1, more).unwrap();
        let all = [&arm, &divided].map(|arm| arm.torque(&motion, &motion));
        let largest = all[0].as_slice().iter().fold(0.0f64, |most, x| most.max(x.abs()));
        assert!(all[0].as_slice().iter().zip(all[1].as_slice()).all(|(a, b)| (a - b).abs() < 1e-9 * largest));
        let carried = [&arm, &divided].map(|arm| arm.load(&motion));
        for ((a, b), acceleration) in carried[0].channel(1).iter().zip(carried[1].channel(1)).zip(motion.qdd.channel(1))
        {
            assert!((a - b - more * acceleration).abs() < 1e-9 * largest);
        }
        // A rotor has no negative inertia, one that the motion determines stays, and described bodies are as described.
        assert!(
            arm.with_more_in_rotor(&model, 1, -1e-3).is_none()
                && divided.with_more_in_rotor(&model, 1, -1e-3).is_some()
        );
        assert!(Arm::new(&real, Trust::Structure).with_more_in_rotor(&model, 1, more).is_none());
        assert!(arm.with_more_in_rotor(&model, 2, more).is_none());
        assert!(Arm::new(&robot, Trust::Nominal).with_more_in_rotor(&model, 1, more).is_none());
    }
}
