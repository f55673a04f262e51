//! A load at the tip that a log may have and the description of the arm lacks: a tool, a workpiece.
//!
//! Torques grow by it on every joint, and on those of the wrist by more than by any factor of a unit. It is a body like
//! others, so that one mass and one centre explain all joints; and it is no heavier than the arm that carries it.

use crate::dynamics::{Chain, Entries, Lanes, Motion};
use crate::robot::{PARAMETERS, Robot};

/// Distance of the centre of a load from the flange, at most, over the length of the arm: a tool that is half as long as that.
const REACHES: f64 = 0.25;

/// Mass of a load, at most, over that of the moving bodies. Payloads of arms come near their own mass at most; a load as heavy at the
/// flange triples the torque of the shoulder, far less than the factors that are looked for.
const HEAVIEST: f64 = 1.0;

/// First of the moments of inertia among the parameters of a body; mass and first moments come before.
const SECOND_MOMENTS: usize = 4;

/// The columns of a load, those of its parameters for every joint.
pub(super) struct Load {
    /// `[joint][column][row]`; none on joints that do not move the tip.
    pub columns: Vec<Vec<Vec<f64>>>,
    /// Whether a parameter cannot be negative.
    pub nonnegative: Vec<bool>,
    /// What the parameters that cannot be negative come to at most, kg.
    pub heaviest: Option<f64>,
}

impl Load {
    /// By how much the load of a log differs from that of another, whose body is among the parameters of the arm: ten parameters of
    /// any sign.
    pub(super) fn difference(chain: &Chain, gravity: [f64; 3], motion: &Motion) -> Load {
        Load { columns: columns(chain, gravity, motion), nonnegative: vec![false; PARAMETERS], heaviest: None }
    }

    /// A load in addition to described bodies: point masses around the flange, which make its mass and its centre, and six moments
    /// of inertia.
    pub(super) fn on(robot: &Robot, gravity: [f64; 3], motion: &Motion) -> Load {
        let links = (0..robot.bodies()).map(|body| robot.body(body).origin.translation.norm());
        let reach = REACHES * (links.sum::<f64>() + robot.flange.translation.norm());
        // On a tree the flange may belong to another branch.
        let flange = if robot.tree.is_none() { robot.flange.translation } else { nalgebra::Vector3::zeros() };
        let around = (0..3).flat_map(|axis| [-reach, reach].map(|side| side * nalgebra::Vector3::ith(axis, 1.0)));
        let points: Vec<_> = std::iter::once(flange).chain(around.map(|side| flange + side)).collect();
        let of_joint = |ten: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
            let Some((first, second)) = ten.split_at_checked(SECOND_MOMENTS) else { return Vec::new() };
            let [mass, x, y, z] = first else { return Vec::new() };
            let at = |point: &nalgebra::Vector3<f64>| -> Vec<f64> {
                (0..mass.len()).map(|row| mass[row] + point.x * x[row] + point.y * y[row] + point.z * z[row]).collect()
            };
            points.iter().map(at).chain(second.iter().cloned()).collect()
        };
        let columns = columns(&Chain::new(robot), gravity, motion).into_iter().map(of_joint).collect();
        let second = PARAMETERS - SECOND_MOMENTS;
        let nonnegative = [vec![true; points.len()], vec![false; second]].concat();
        let mass: f64 = (0..robot.bodies()).map(|body| robot.body(body).inertia.mass()).sum();
        Load { columns, nonnegative, heaviest: Some(HEAVIEST * mass) }
    }
}

/// The regressor's columns of a body that is fixed to the tip, `[joint][parameter][row]`.
fn columns(chain: &Chain, gravity: [f64; 3], motion: &Motion) -> Vec<Vec<Vec<f64>>> {
    let chain = chain.clone().with_gravity(gravity);
    let (dof, samples) = (chain.dof(), motion.samples());
    // The body that most coordinates move; of a serial arm the last.
    let moved_by = |body: &usize| (0..dof).filter(|&coordinate| chain.moves(coordinate, *body)).count();
    let Some(tip) = (0..chain.bodies()).max_by_key(moved_by) else { return Vec::new() };
    let places = |body: usize, joint: usize| {
        let acts = body == tip && chain.moves(joint, body);
        std::array::from_fn(|parameter| acts.then_some(joint * PARAMETERS + parameter))
    };
    let mut table = vec![0.0; dof * PARAMETERS * samples];
    Entries::new(&chain, places).write(Lanes::best(), &chain, motion, 0..samples, &mut table);
    let column = |row: usize| table[row * samples..][..samples].to_vec();
    let of = |joint: usize| -> Vec<Vec<f64>> {
        let acts = chain.moves(joint, tip);
        (0..PARAMETERS).filter(|_| acts).map(|parameter| column(joint * PARAMETERS + parameter)).collect()
    };
    (0..dof).map(of).collect()
}
