//! The arm as identified so far: what effects in gears and sensors, and friction under load, act upon.

use super::roles::is_shift;
use crate::channels::Channels;
use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::regression::Column;
use crate::dynamics::{Chain, Motion, inverse_dynamics, mass_matrix};
use crate::effects::{
    Along, Contribution, GearTrain, Placed, Scope, Site, behind_encoder, behind_gears, contributions, direction,
};
use crate::error::Result;
use crate::identification::effect_model::Trust;
use crate::identification::model::Model;
use crate::identification::standard::{COULOMB, ROTOR, STANDARD};
use crate::robot::Robot;
use crate::signal::second_derivative;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

/// Placed effects whose torque is worked out in one pass over a log; bounds the memory that takes.
const BATCH: usize = 24;

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
    /// Speed over which the dry friction of each joint changes its direction, rad/s or m/s: tanh(v / width); zero for the plain sign.
    pub sign_widths: Vec<f64>,
}

/// Which torque is moved in time by what shifts or spreads it. Moved torque holds the noise of the accelerations twice, once as it is in what
/// is left of the measured one: that looks like a shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Moved {
    /// To test for a shift: along accelerations that stand clear of the noise, which omits some of the motion.
    Tested,
    /// In a model: the same on joints that [`Log::noisy`] has, along all of the motion on the others.
    Modelled,
}

impl Arm {
    /// The arm before anything is identified.
    pub fn new(robot: &Robot, trust: Trust) -> Self {
        let sign_widths = vec![0.0; robot.dof()];
        Arm { known: robot.clone(), found: robot.clone(), chain: Chain::new(robot), trust, sign_widths }
    }

    /// The same with friction that changes its direction over some speed on each joint, rad/s or m/s.
    pub fn with_sign_widths(self, sign_widths: Vec<f64>) -> Self {
        Arm { sign_widths, ..self }
    }

    /// The arm as found.
    pub fn found(&self) -> &Robot {
        &self.found
    }

    /// Columns of the baseline: rotor inertia, viscous and Coulomb friction of every joint, and where the inertias are
    /// estimated all base parameters.
    pub fn baseline(&self, model: &Model, rows: &Rows) -> Vec<Column> {
        let tables: Vec<Vec<Channels>> = rows.logs.par_iter().map(|log| model.columns(&log.motion, 0.0)).collect();
        let dry = |b: usize| model.base().kept()[b] % STANDARD == COULOMB;
        let base = (0..model.base().len()).filter(|&b| self.trust == Trust::Structure || model.is_friction(b));
        let mut columns: Vec<Column> = base
            .map(|b| {
                let on = |joint: usize| {
                    let place = model.active(joint).into_iter().position(|other| other == b)?;
                    if dry(b) {
                        let width = self.sign_widths[joint];
                        let turned =
                            |log: &Log| log.motion.qd.channel(joint).iter().map(|&v| direction(v, width)).collect();
                        return Some(rows.signal(turned));
                    }
                    let logs = rows.logs.iter().zip(&tables);
                    Some(logs.flat_map(|(log, table)| log.as_logged(table[joint].channel(place))).collect())
                };
                Column::new((0..rows.dof()).map(|joint| on(joint).unwrap_or_default()))
            })
            .collect();
        if self.trust == Trust::Nominal {
            columns.extend(
                (0..rows.dof())
                    .filter(|&joint| model.has_equation(joint))
                    .map(|joint| Column::on(joint, rows.signal(|log| log.motion.qdd.channel(joint).to_vec()))),
            );
        }
        columns
    }

    /// Torque that is known before anything is fitted: that of the bodies where their inertias are taken from the URDF.
    pub fn believed(&self, rows: &Rows) -> Column {
        match self.trust {
            Trust::Structure => Column::default(),
            Trust::Nominal => {
                let inertial = self.known.inertial_parameters();
                let logs: Vec<Channels> =
                    rows.logs.par_iter().map(|log| inverse_dynamics(&self.chain, &inertial, &log.motion)).collect();
                all_over_rows(rows, &logs)
            }
        }
    }

    /// The arm as described.
    pub fn described(&self) -> &Robot {
        &self.known
    }

    /// Takes over values of the baseline, in the order of [`Arm::baseline`].
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

    /// Takes what a link's inertia has more than described for that of its joint's rotor, where only their sum is determined and the
    /// description knows of no rotor: descriptions without rotors are more common than arms that have none.
    fn split_off_rotors(&self, model: &Model, standard: &mut [f64]) {
        let described = Model::standard_values(&self.known);
        let (kept, regrouping) = (model.base().kept(), model.base().regrouping());
        for joint in 0..model.dof() {
            let (first, rotor) = (joint * STANDARD, joint * STANDARD + ROTOR);
            if kept.contains(&rotor) || described[rotor] != 0.0 {
                continue;
            }
            let shares = regrouping.column(rotor);
            let own = (0..kept.len()).find(|&b| (first + MOMENTS..rotor).contains(&kept[b]) && shares[b] > 0.5);
            let Some(own) = own else { continue };
            let more = (standard[kept[own]] - described[kept[own]]) / shares[own];
            if more > 0.0 {
                standard[rotor] = more;
                let shares = model.base().carried(shares.as_slice());
                kept.iter().zip(shares).for_each(|(&kept, share)| standard[kept] -= share * more);
            }
        }
    }

    /// Torque of the arm as found along every log, `[joint][time]`.
    pub fn along(&self, rows: &Rows) -> Vec<Channels> {
        rows.logs.par_iter().map(|log| self.torque(&log.motion, &log.motion)).collect()
    }

    /// Torque of the arm as found over the rows.
    pub fn all_torque(&self, rows: &Rows) -> Column {
        all_over_rows(rows, &self.along(rows))
    }

    /// Torque of the arm as found along `other` motions of the logs less `along` the smooth ones, over the rows.
    ///
    /// # Errors
    /// Those of `other`, which is given the number of a log and the log.
    pub fn departure(
        &self,
        rows: &Rows,
        along: &[Channels],
        other: impl Fn(usize, &Log) -> Result<Motion> + Sync,
    ) -> Result<Column> {
        let each = rows.logs.par_iter().zip(along).enumerate().map(|(index, (log, along))| {
            let motion = other(index, log)?;
            let mut torque = self.torque(&motion, &motion);
            torque.as_mut_slice().iter_mut().zip(along.as_slice()).for_each(|(value, along)| *value -= along);
            Ok(torque)
        });
        Ok(all_over_rows(rows, &each.collect::<Result<Vec<Channels>>>()?))
    }

    /// Second derivative of the torque that the gears of the arm as found carry, over the rows, N m/s2.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn bend(&self, rows: &Rows) -> Result<Column> {
        let each = rows.logs.par_iter().map(|log| {
            let load = self.load(&log.motion);
            let mut bend = load.clone();
            for joint in 0..load.channels() {
                second_derivative(load.channel(joint), log.period, bend.channel_mut(joint))?;
            }
            Ok(bend)
        });
        Ok(all_over_rows(rows, &each.collect::<Result<Vec<Channels>>>()?))
    }

    /// Torque that the gears of the arm as found carry, `[joint][time]`: that of the bodies alone.
    pub fn load(&self, motion: &Motion) -> Channels {
        inverse_dynamics(&self.chain, &self.found.inertial_parameters(), motion)
    }

    /// Inertia of the arm as found about one of its joints at `q`, kg m2 (kg for one that slides).
    pub fn inertia_about(&self, joint: usize, q: &[f64]) -> f64 {
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
                *value +=
                    drive.armature * a + drive.viscous * v + drive.coulomb * direction(v, self.sign_widths[joint]);
            }
        }
        torque
    }

    /// What each placed effect adds to the logged torque over the rows from after the change in question (all rows where no
    /// log is from before), against the arm as found.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn added(&self, placed: &[Placed], rows: &Rows) -> Result<Vec<Column>> {
        self.added_in(rows.before..rows.logs.len(), placed, rows, Moved::Modelled)
    }

    /// [`Arm::added`] over all rows, those from before the change too.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn added_throughout(&self, placed: &[Placed], rows: &Rows) -> Result<Vec<Column>> {
        self.added_in(0..rows.logs.len(), placed, rows, Moved::Modelled)
    }

    /// The same over all rows where they act in some of the logs only.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn added_in(&self, acting: Range<usize>, placed: &[Placed], rows: &Rows, moved: Moved) -> Result<Vec<Column>> {
        // What laws may ask about a motion is worked out once for all batches, where there are such laws.
        let asked = [Site::Joint, Site::Integrator]
            .map(|site| placed.iter().any(|one| law_site(one) == Some(site)).then_some(site));
        let sites = rows.logs.iter().enumerate().map(|(k, log)| {
            let asked = asked.into_iter().flatten().filter(|_| acting.contains(&k));
            let along = asked.map(|site| {
                // What rapier's step gets wrong depends on where each mass really is.
                let robot = if site == Site::Integrator { &self.known } else { &self.found };
                (site, Along::turning_over(robot, &self.chain, &log.time, &log.motion, &self.sign_widths))
            });
            along.collect()
        });
        let sites: Vec<Vec<(Site, Along)>> = sites.collect();
        let jobs: Vec<&[Placed]> = placed.chunks(BATCH).collect();
        let batches: Vec<Vec<Column>> = jobs
            .into_par_iter()
            .map(|batch| {
                let logs = rows.logs.iter().zip(&sites).enumerate();
                let logs = logs.map(|(k, (log, sites))| match acting.contains(&k) {
                    true => self.added_to(batch, log, sites, moved),
                    false => Ok(vec![Contribution::default(); batch.len()]),
                });
                let logs: Vec<Vec<Contribution>> = logs.collect::<Result<_>>()?;
                Ok((0..batch.len()).map(|index| over_rows(rows, |log, joint| logs[log][index].on(joint))).collect())
            })
            .collect::<Result<_>>()?;
        Ok(batches.into_iter().flatten().collect())
    }

    fn added_to(
        &self,
        batch: &[Placed],
        log: &Log,
        sites: &[(Site, Along)],
        moved: Moved,
    ) -> Result<Vec<Contribution>> {
        let mut out: Vec<Option<Contribution>> = vec![None; batch.len()];
        for (site, along) in sites {
            let of_site: Vec<usize> = (0..batch.len()).filter(|&k| law_site(&batch[k]) == Some(*site)).collect();
            if of_site.is_empty() {
                continue;
            }
            let placed: Vec<Placed> = of_site.iter().map(|&k| batch[k].clone()).collect();
            for (k, torque) in of_site.into_iter().zip(contributions(&placed, along)) {
                out[k] = Some(torque);
            }
        }
        let (mut plain, mut to_move) = (None, None);
        let mut all = Vec::with_capacity(batch.len());
        for (placed, done) in batch.iter().zip(out) {
            let torque = match done {
                Some(torque) => torque,
                None => {
                    let plain = plain.get_or_insert_with(|| self.torque(&log.motion, &log.motion));
                    if is_shift(placed.effect) && to_move.is_none() {
                        to_move = Some(self.torque_to_move(log, plain, moved)?);
                    }
                    let before = to_move.as_ref().filter(|_| is_shift(placed.effect)).unwrap_or(plain);
                    self.changed(placed, log, before)?.into()
                }
            };
            all.push(torque);
        }
        Ok(all)
    }

    /// Torque that is to be moved in time, where `plain` is that along the motion: along accelerations that stand clear of the encoders'
    /// noise, on all joints or where that noise is most of it once it is moved.
    fn torque_to_move(&self, log: &Log, plain: &Channels, moved: Moved) -> Result<Channels> {
        let is_clear = |joint: usize| moved == Moved::Tested || log.noisy[joint];
        let mut torque = plain.clone();
        if (0..torque.channels()).any(is_clear) {
            let motion = log.clear()?;
            let clear = self.torque(motion, motion);
            for joint in (0..torque.channels()).filter(|joint| is_clear(*joint)) {
                torque.channel_mut(joint).copy_from_slice(clear.channel(joint));
            }
        }
        Ok(torque)
    }

    /// Change of the logged torque by an effect in a gear or a sensor.
    fn changed(&self, placed: &Placed, log: &Log, plain: &Channels) -> Result<Channels> {
        let mut torque = match placed.effect.gear(&placed.parameters) {
            Some(gear) => {
                let link = behind_gears(&AlongLog { arm: self, log }, &[(placed.joint, gear)])?;
                self.torque(&log.motion, &link)
            }
            None => match behind_encoder(std::iter::once(placed), log.motion.q.channel(placed.joint)) {
                Some(behind) => {
                    let mut q = log.motion.q.clone();
                    q.channel_mut(placed.joint).copy_from_slice(&behind);
                    let motion = Log::motion_of(q, log.period)?;
                    self.torque(&motion, &motion)
                }
                None => plain.clone(),
            },
        };
        let joints = match placed.effect.about().scope {
            Scope::Arm => 0..torque.channels(),
            _ => placed.joint..placed.joint + 1,
        };
        for joint in joints {
            placed.effect.distort_torque(&placed.parameters, torque.channel_mut(joint), log.period);
        }
        torque.as_mut_slice().iter_mut().zip(plain.as_slice()).for_each(|(value, before)| *value -= before);
        Ok(torque)
    }
}

/// The arm as found along a log.
struct AlongLog<'a> {
    arm: &'a Arm,
    log: &'a Log,
}

impl GearTrain for AlongLog<'_> {
    fn motors(&self) -> &Motion {
        &self.log.motion
    }

    fn measured(&self) -> Result<Cow<'_, Motion>> {
        Ok(Cow::Borrowed(self.log.unsmoothed()?))
    }

    fn period(&self) -> f64 {
        self.log.period
    }

    fn carried(&self, joints: &[usize], motion: &Motion) -> Vec<Vec<f64>> {
        let load = self.arm.load(motion);
        joints.iter().map(|&joint| load.channel(joint).to_vec()).collect()
    }

    fn rotor(&self, joint: usize) -> f64 {
        self.arm.found.joints[joint].drive.armature
    }

    fn smoothed(&self, joint: usize, signal: &[f64]) -> Result<Vec<f64>> {
        let mut smooth = signal.to_vec();
        self.log.low_pass[joint].apply_in_place(&mut smooth)?;
        Ok(smooth)
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

/// The torque that `of` gives for a log, at its own rate, and a joint as a column over the rows; None where there is none.
fn over_rows<'a>(rows: &Rows, of: impl Fn(usize, usize) -> Option<&'a [f64]>) -> Column {
    let logs = || 0..rows.logs.len();
    Column::new((0..rows.dof()).map(|joint| {
        match logs().all(|log| of(log, joint).is_none()) {
            true => Vec::new(),
            false => logs()
                .flat_map(|log| match of(log, joint) {
                    Some(torque) => rows.logs[log].as_logged(torque),
                    None => vec![0.0; rows.starts[log + 1] - rows.starts[log]],
                })
                .collect(),
        }
    }))
}

/// Torques of all logs, `[joint][time]`, at their own rates as a column over the rows.
fn all_over_rows(rows: &Rows, logs: &[Channels]) -> Column {
    over_rows(rows, |log, joint| Some(logs[log].channel(joint)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{InertiaCheck, load};

    /// Base parameters of the IRB 1600 as they are give its torque back, shared rightly among bodies and rotors.
    #[test]
    fn a_description_without_rotors_leaves_what_is_more_to_them() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let real = load(path, InertiaCheck::Required).unwrap();
        let mut described = real.clone();
        described.joints.iter_mut().for_each(|joint| joint.drive.armature = 0.0);
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
}
