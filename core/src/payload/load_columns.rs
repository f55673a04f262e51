//! The torque of a body fixed to the flange: ten columns, linear in its inertial parameters.

use crate::channels::Channels;
use crate::dynamics::{Chain, Entries, Lanes, Motion};
use crate::effects::seen_from_parent;
use crate::identification::linear_model::LinearModel;
use crate::robot::{Inertia, PARAMETERS, Robot};
use nalgebra::{SMatrix, SVector};

/// Length that makes first moments and inertias comparable with masses, m: about the distance of a load from its flange.
pub(super) const LENGTH: f64 = 0.3;

/// Units in which the fit takes the ten parameters: a mass of 1 kg at [`LENGTH`].
pub(super) const SCALE: [f64; PARAMETERS] = {
    let (h, i) = (LENGTH, LENGTH * LENGTH);
    [1.0, h, h, h, i, i, i, i, i, i]
};

/// The columns of a load, in the frame of the flange and in the units of [`SCALE`].
#[derive(Debug)]
pub(super) struct LoadColumns {
    chain: Chain,
    tip: usize,
    /// Joints with an equation.
    equations: Vec<bool>,
    /// Parameters about the frame of the joint that carries the flange, from those about the flange.
    from_flange: SMatrix<f64, PARAMETERS, PARAMETERS>,
}

impl LoadColumns {
    /// The columns of a load on the flange of `robot`, for the joints with an equation.
    pub(super) fn new(robot: &Robot, equations: &[bool]) -> Self {
        let mut from_flange = SMatrix::<f64, PARAMETERS, PARAMETERS>::zeros();
        for (k, scale) in SCALE.iter().enumerate() {
            let mut unit = [0.0; PARAMETERS];
            unit[k] = *scale;
            from_flange.set_column(k, &SVector::from(seen_from_parent(&Inertia(unit), &robot.flange).0));
        }
        LoadColumns { chain: Chain::new(robot), tip: robot.tip(), equations: equations.to_vec(), from_flange }
    }

    fn acts_on(&self, joint: usize) -> bool {
        self.equations[joint] && self.chain.moves(joint, self.tip)
    }
}

impl LinearModel for LoadColumns {
    fn active(&self, joint: usize) -> Vec<usize> {
        if self.acts_on(joint) { (0..PARAMETERS).collect() } else { Vec::new() }
    }

    fn columns(&self, motion: &Motion, _: &[f64]) -> Vec<Channels> {
        let (dof, samples) = (self.chain.dof(), motion.samples());
        let entries = Entries::new(&self.chain, |link, joint| {
            let wanted = link == self.tip && self.acts_on(joint);
            std::array::from_fn(|parameter| wanted.then_some(joint * PARAMETERS + parameter))
        });
        let mut table = Channels::zeros(dof * PARAMETERS, samples);
        entries.write(Lanes::best(), &self.chain, motion, 0..samples, table.as_mut_slice());
        let of_joint = |joint: usize| {
            let mut columns = Channels::zeros(if self.acts_on(joint) { PARAMETERS } else { 0 }, samples);
            for k in 0..columns.channels() {
                let column = columns.channel_mut(k);
                for parameter in 0..PARAMETERS {
                    let weight = self.from_flange[(parameter, k)];
                    if weight != 0.0 {
                        let source = table.channel(joint * PARAMETERS + parameter);
                        column.iter_mut().zip(source).for_each(|(value, x)| *value += weight * x);
                    }
                }
            }
            columns
        };
        (0..dof).map(of_joint).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::inverse_dynamics;
    use crate::effects::{Effect, Payload};
    use crate::random;
    use crate::robot::{self, InertiaCheck};
    use rand::RngExt;

    #[test]
    fn the_columns_are_the_torque_of_the_body() {
        for arm in ["urdf/irb1600_6_120.urdf", "tests/reference/skew7.urdf", "tests/reference/branching.urdf"] {
            let path = format!("{}/../{arm}", env!("CARGO_MANIFEST_DIR"));
            let robot = robot::load(path, InertiaCheck::Ignored).unwrap();
            let mut source = random::stream(3, "load columns", 0);
            let mut motion = Motion::zeros(robot.dof(), 9);
            for table in [&mut motion.q, &mut motion.qd, &mut motion.qdd] {
                table.as_mut_slice().fill_with(|| source.random_range(-2.0..2.0));
            }
            let load: [f64; PARAMETERS] = std::array::from_fn(|_| source.random_range(-1.0..1.0));
            let mut loaded = robot.clone();
            Payload.alter(&load, 0, &mut loaded);
            let torque = |robot: &Robot| inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion);
            let (with, without) = (torque(&loaded), torque(&robot));
            let model = LoadColumns::new(&robot, &vec![true; robot.dof()]);
            let beta: Vec<f64> = load.iter().zip(SCALE).map(|(value, scale)| value / scale).collect();
            let made = model.torque(&motion, &[], &beta);
            for joint in 0..robot.dof() {
                for sample in 0..motion.samples() {
                    let expected = with.channel(joint)[sample] - without.channel(joint)[sample];
                    let own = made.channel(joint)[sample];
                    assert!((own - expected).abs() < 1e-9, "{arm}: joint {joint}: {own} {expected}");
                }
            }
        }
    }
}
