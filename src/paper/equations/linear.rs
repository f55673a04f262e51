//! The 78-parameter model along a motion, for regression.

use super::tables::joint_angles;
use super::terms::terms;
use super::{JOINTS, PARAMETER_COUNT, Variant, regressor};
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::internal::identification::LinearModel;

/// Parameter k, counted from 0, is X_(k+1). Positions are those of the URDF; the equations get the angles of Table 1
/// ([`joint_angles`]).
impl LinearModel for Variant {
    fn active(&self, joint: usize) -> Vec<usize> {
        let mut parameters: Vec<usize> =
            terms(*self).iter().filter(|term| term.row == joint).map(|term| term.parameter - 1).collect();
        parameters.sort_unstable();
        parameters.dedup();
        parameters
    }

    /// # Panics
    /// If the motion is not one of six joints.
    fn columns(&self, motion: &Motion, time: &[f64]) -> Vec<Channels> {
        columns(self, motion, time, |q, dtheta, ddtheta| regressor(*self, &joint_angles(q), &dtheta, &ddtheta))
    }
}

/// The other reading of the equations: the angle of joint 3 is absolute, theta2 + q3, as a planar chain has it (axes 2 and 3
/// are parallel; no others are at all times). By virtual work row 3 is then the torque of joint 3, and joint 2 carries
/// rows 2 and 3. Friction stays with the velocity of the joint. The gravity and coupling of joints 2 and 3 are right
/// now, but a rotor, which turns with the joint and not with the absolute angle, no longer has a parameter of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct AbsoluteAngles(pub Variant);

impl LinearModel for AbsoluteAngles {
    fn active(&self, joint: usize) -> Vec<usize> {
        let mut parameters = self.0.active(joint);
        if joint == 1 {
            parameters.extend(self.0.active(2).into_iter().filter(|k| !FRICTION_3.contains(k)));
            parameters.sort_unstable();
            parameters.dedup();
        }
        parameters
    }

    /// # Panics
    /// If the motion is not one of six joints.
    fn columns(&self, motion: &Motion, time: &[f64]) -> Vec<Channels> {
        columns(self, motion, time, |q, qd, qdd| {
            let [mut theta, mut dtheta, mut ddtheta] = [joint_angles(q), qd, qdd];
            for signal in [&mut theta, &mut dtheta, &mut ddtheta] {
                signal[2] += signal[1];
            }
            let mut rows = regressor(self.0, &theta, &dtheta, &ddtheta);
            let of_the_joint = regressor(self.0, &theta, &qd, &qdd)[2];
            for k in 0..PARAMETER_COUNT {
                if FRICTION_3.contains(&k) {
                    rows[2][k] = of_the_joint[k];
                } else {
                    rows[1][k] += rows[2][k];
                }
            }
            rows
        })
    }
}

/// X59 and X60, Coulomb and viscous friction of joint 3, counted from 0.
const FRICTION_3: [usize; 2] = [58, 59];

/// Table `[active parameter][time]` of every joint from the rows at each instant's position, velocity and acceleration.
fn columns(
    model: &impl LinearModel,
    motion: &Motion,
    time: &[f64],
    rows: impl Fn([f64; JOINTS], [f64; JOINTS], [f64; JOINTS]) -> [[f64; PARAMETER_COUNT]; JOINTS],
) -> Vec<Channels> {
    assert_eq!(motion.joints(), JOINTS, "the paper's model is that of an arm of six joints");
    let mut tables = vec![Channels::zeros(PARAMETER_COUNT, time.len()); JOINTS];
    for sample in 0..time.len() {
        let [q, qd, qdd] =
            [&motion.q, &motion.qd, &motion.qdd].map(|signals| std::array::from_fn(|j| signals.channel(j)[sample]));
        for (table, row) in tables.iter_mut().zip(rows(q, qd, qdd)) {
            table.set(sample, &row);
        }
    }
    let kept = |(joint, table): (usize, &Channels)| {
        let vectors: Vec<Vec<f64>> = model.active(joint).into_iter().map(|k| table.channel(k).to_vec()).collect();
        Channels::from_vectors(&vectors)
    };
    tables.iter().enumerate().map(kept).collect()
}

#[cfg(test)]
mod tests {
    use super::super::structure::random_states;
    use super::*;

    #[test]
    fn columns_are_the_regressor_without_what_is_zero_by_construction() {
        let states = random_states(4, 20);
        let signals = |which: usize| {
            let joints: Vec<Vec<f64>> =
                (0..JOINTS).map(|j| states.iter().map(|state| state[which][j]).collect()).collect();
            Channels::from_vectors(&joints)
        };
        let motion = Motion { q: signals(0), qd: signals(1), qdd: signals(2) };
        for variant in [Variant::AsPrinted, Variant::Consistent, Variant::EulerLagrange] {
            let columns = variant.columns(&motion, &[0.0; 20]);
            for (sample, [q, dtheta, ddtheta]) in states.iter().enumerate() {
                for (joint, row) in regressor(variant, &joint_angles(*q), dtheta, ddtheta).iter().enumerate() {
                    let active = variant.active(joint);
                    assert_eq!(columns[joint].channels(), active.len());
                    for (k, &value) in row.iter().enumerate() {
                        let found =
                            active.iter().position(|&a| a == k).map_or(0.0, |c| columns[joint].channel(c)[sample]);
                        assert_eq!(found, value, "{variant:?} joint {joint} X{}", k + 1);
                    }
                }
            }
        }
        // (9): X25, X26, X44, X57, X66, X71 and X75..X78.
        assert_eq!(Variant::Consistent.active(5), [24, 25, 43, 56, 65, 70, 74, 75, 76, 77]);
    }

    /// A double pendulum of point masses m2 and m3 on rods l2 and l3, turning about parallel horizontal axes 2 and 3, by
    /// the textbook (Craig, Introduction to Robotics, section 6.7), theta2 from the horizontal.
    #[test]
    fn in_absolute_angles_joints_2_and_3_are_a_double_pendulum() {
        let (m2, m3, l2, l3) = (2.0, 3.0, 0.5, 0.4);
        let (q2, q3, v2, v3, a2, a3) = (0.3, -0.8, 1.1, -0.7, 2.0, 4.0);
        let mut x = [0.0; PARAMETER_COUNT];
        // X30: inertia of joint 2, X35: coupling, X48: inertia of joint 3, X45 and X58: gravity.
        for (k, value) in
            [(30, (m2 + m3) * l2 * l2), (35, m3 * l2 * l3), (48, m3 * l3 * l3), (45, (m2 + m3) * l2), (58, m3 * l3)]
        {
            x[k - 1] = value;
        }
        let at = |second: f64, third: f64| {
            Channels::from_vectors(&[vec![0.0], vec![second], vec![third], vec![0.0], vec![0.0], vec![0.0]])
        };
        let motion = Motion { q: at(q2 + std::f64::consts::FRAC_PI_2, q3), qd: at(v2, v3), qdd: at(a2, a3) };
        let model = AbsoluteAngles(Variant::EulerLagrange);
        let torque = |joint: usize| -> f64 {
            let table = &model.columns(&motion, &[0.0])[joint];
            model.active(joint).into_iter().zip(table.iter()).map(|(k, column)| x[k] * column[0]).sum()
        };
        let (c3, s3, g) = (q3.cos(), q3.sin(), super::super::GRAVITY);
        let (c2, c23) = (q2.cos(), (q2 + q3).cos());
        let tau2 = m3 * l3 * l3 * (a2 + a3) + m3 * l2 * l3 * c3 * (2.0 * a2 + a3) + (m2 + m3) * l2 * l2 * a2
            - m3 * l2 * l3 * s3 * v3 * v3
            - 2.0 * m3 * l2 * l3 * s3 * v2 * v3
            + m3 * l3 * g * c23
            + (m2 + m3) * l2 * g * c2;
        let tau3 = m3 * l2 * l3 * c3 * a2 + m3 * l2 * l3 * s3 * v2 * v2 + m3 * l3 * g * c23 + m3 * l3 * l3 * (a2 + a3);
        assert!((torque(1) - tau2).abs() < 1e-12, "{} {tau2}", torque(1));
        assert!((torque(2) - tau3).abs() < 1e-12, "{} {tau3}", torque(2));
    }
}
