//! The torque model that is identified: rigid bodies, rotor inertia, viscous and Coulomb friction of every joint.

use super::linear_model::LinearModel;
use crate::channels::Channels;
use crate::dynamics::{BaseParameters, Chain, Motion, block_row, regressor};
use crate::effects::{Along, CoulombFriction, Effect, Placed, ViscousFriction, contributions};
use crate::random;
use crate::robot::{JointKind, PARAMETERS, Robot, SYMBOLS, UNITS};
use nalgebra::DMatrix;
use rand::RngExt;

/// Standard parameters of a joint: ten inertial ones, Ia, Fv, Fc.
pub const STANDARD: usize = PARAMETERS + 3;

/// States from which the base parameters are found; well above one per standard parameter of any arm.
const PROBES_PER_JOINT: usize = 40;

/// Torque linear in standard parameters (13 per joint: m, mx .. Izz, Ia, Fv, Fc) and in the base parameters that torque
/// can tell apart.
#[derive(Debug, Clone)]
pub struct Model {
    robot: Robot,
    chain: Chain,
    names: Vec<String>,
    base: BaseParameters,
}

impl Model {
    /// The model of `robot`, whose geometry and gravity it takes; its inertias play no part.
    pub fn new(robot: &Robot) -> Self {
        let chain = Chain::new(robot);
        let names = standard_names(robot.dof());
        let base = BaseParameters::new(&probe(robot, &chain), &names);
        Model { robot: robot.clone(), chain, names, base }
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.chain.dof()
    }

    /// Symbols of the standard parameters, 13 per joint: "m1", "mx1", .. "Fc6".
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The base parameters.
    pub fn base(&self) -> &BaseParameters {
        &self.base
    }

    /// The arm the model is of.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Its geometry and gravity.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Joint and kind (rotor inertia 0, viscous 1, Coulomb friction 2) of a base parameter that belongs to a drive alone.
    pub fn drive_of(&self, base: usize) -> Option<(usize, usize)> {
        let standard = self.base.kept()[base];
        (standard % STANDARD).checked_sub(PARAMETERS).map(|which| (standard / STANDARD, which))
    }

    /// Whether a base parameter is viscous or Coulomb friction.
    pub fn is_friction(&self, base: usize) -> bool {
        self.base.kept()[base] % STANDARD > PARAMETERS
    }

    /// Whether the rotor inertia of `joint` is a base parameter of its own (and not part of a link's).
    pub fn rotor_stands_alone(&self, joint: usize) -> bool {
        self.base.kept().contains(&(joint * STANDARD + PARAMETERS))
    }

    /// Unit of a standard parameter on a revolute joint.
    pub fn unit(standard: usize) -> &'static str {
        match standard % STANDARD {
            inertial if inertial < PARAMETERS => UNITS[inertial],
            PARAMETERS => "kg m2",
            11 => ViscousFriction.parameters()[0].unit,
            _ => CoulombFriction.parameters()[0].unit,
        }
    }

    /// Unit of a standard parameter on the joint it belongs to.
    pub fn unit_on_joint(&self, standard: usize) -> &'static str {
        match (self.robot.joints[standard / STANDARD].kind, standard % STANDARD) {
            (JointKind::Prismatic, PARAMETERS) => "kg",
            (JointKind::Prismatic, 11) => "N s/m",
            (JointKind::Prismatic, 12) => "N",
            _ => Self::unit(standard),
        }
    }

    /// Base columns on one joint: indices of the base parameters that can act there (those of links from the joint outwards).
    pub fn active(&self, joint: usize) -> Vec<usize> {
        (0..self.base.len())
            .filter(|&b| {
                let standard = self.base.kept()[b];
                let (link, which) = (standard / STANDARD, standard % STANDARD);
                if which < PARAMETERS { link >= joint } else { link == joint }
            })
            .collect()
    }

    /// The columns of all base parameters along a motion: for every joint a table `[active base parameter][time]` in the
    /// order of [`Model::active`]. `width` is the velocity over which the sign in dry friction is smoothed (rad/s).
    pub fn columns(&self, motion: &Motion, time: &[f64], width: f64) -> Vec<Channels> {
        self.columns_behind_gears(motion, motion, time, width)
    }

    /// [`Model::columns`] where motors and links move differently: inertial columns along `link`, rotor and friction
    /// columns along `motor`.
    pub fn columns_behind_gears(&self, motor: &Motion, link: &Motion, time: &[f64], width: f64) -> Vec<Channels> {
        let source = Source::new(&self.robot, &self.chain, motor, link, time, width);
        (0..self.dof())
            .map(|joint| {
                let columns: Vec<Vec<f64>> = self
                    .active(joint)
                    .into_iter()
                    .map(|b| source.column(self.base.kept()[b], joint).unwrap_or_else(|| vec![0.0; motor.samples()]))
                    .collect();
                Channels::from_vectors(&columns)
            })
            .collect()
    }

    /// Standard parameters of an arm, in the order of [`Model::names`].
    pub fn standard_values(robot: &Robot) -> Vec<f64> {
        robot
            .joints
            .iter()
            .flat_map(|joint| {
                let drive = joint.drive;
                joint.inertia.0.into_iter().chain([drive.armature, drive.viscous, drive.coulomb])
            })
            .collect()
    }
}

/// Linear in the base parameters; friction changes sign without a width.
impl LinearModel for Model {
    fn active(&self, joint: usize) -> Vec<usize> {
        Model::active(self, joint)
    }

    fn columns(&self, motion: &Motion, time: &[f64]) -> Vec<Channels> {
        Model::columns(self, motion, time, 0.0)
    }
}

fn standard_names(dof: usize) -> Vec<String> {
    (1..=dof)
        .flat_map(|joint| {
            SYMBOLS
                .into_iter()
                .chain(["Ia", ViscousFriction.parameters()[0].symbol, CoulombFriction.parameters()[0].symbol])
                .map(move |symbol| format!("{symbol}{joint}"))
        })
        .collect()
}

/// Everything the column of a standard parameter is made of.
struct Source<'a> {
    rows: Channels,
    motion: &'a Motion,
    /// Torque per unit viscous and per unit Coulomb friction, on each joint.
    friction: Vec<[Channels; 2]>,
}

impl<'a> Source<'a> {
    fn new(robot: &Robot, chain: &Chain, motion: &'a Motion, link: &Motion, time: &[f64], width: f64) -> Self {
        let along = Along::new(robot, chain, time, motion, width);
        let unit = |effect: &'static dyn Effect, joint| Placed { effect, joint, parameters: vec![1.0] };
        let placed: Vec<Placed> =
            (0..chain.dof()).flat_map(|joint| [unit(&ViscousFriction, joint), unit(&CoulombFriction, joint)]).collect();
        let mut torques = contributions(&placed, &along).into_iter();
        let friction = std::iter::from_fn(|| Some([torques.next()?, torques.next()?])).collect();
        Source { rows: regressor(chain, link), motion, friction }
    }

    /// Torque on `joint` per unit of a standard parameter; None where it cannot act.
    fn column(&self, standard: usize, joint: usize) -> Option<Vec<f64>> {
        let (link, which) = (standard / STANDARD, standard % STANDARD);
        match which {
            inertial if inertial < PARAMETERS => (link >= joint)
                .then(|| self.rows.channel(block_row(self.motion.joints(), link, inertial, joint)).to_vec()),
            _ if link != joint => None,
            PARAMETERS => Some(self.motion.qdd.channel(joint).to_vec()),
            friction => Some(self.friction[joint][friction - PARAMETERS - 1].channel(joint).to_vec()),
        }
    }
}

/// Regressor rows of all standard parameters at random noise-free states: what can be told apart by any motion.
fn probe(robot: &Robot, chain: &Chain) -> DMatrix<f64> {
    let dof = chain.dof();
    let samples = PROBES_PER_JOINT * dof;
    let mut random = random::stream(0, "base parameter probe", 0);
    let mut motion = Motion::zeros(dof, samples);
    for signals in [&mut motion.q, &mut motion.qd, &mut motion.qdd] {
        signals.as_mut_slice().fill_with(|| random.random_range(-3.0..3.0));
    }
    let time = vec![0.0; samples];
    let source = Source::new(robot, chain, &motion, &motion, &time, 0.0);
    let mut observation = DMatrix::zeros(samples * dof, dof * STANDARD);
    for standard in 0..dof * STANDARD {
        for joint in 0..dof {
            if let Some(column) = source.column(standard, joint) {
                observation.view_mut((joint * samples, standard), (samples, 1)).copy_from_slice(&column);
            }
        }
    }
    observation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{self, InertiaCheck};

    #[test]
    fn the_irb_1600_has_52_base_parameters_of_78() {
        let robot =
            robot::load(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf"), InertiaCheck::Required)
                .unwrap();
        let model = Model::new(&robot);
        assert_eq!(model.names().len(), 78);
        assert_eq!(model.base().len(), 52);
        let singular = probe(&robot, &Chain::new(&robot)).svd(false, false).singular_values;
        let rank = singular.iter().filter(|&&s| s > 1e-10 * singular[0]).count();
        assert_eq!(rank, 52, "the singular values must agree with the QR");
        let first = &model.base().groupings()[0];
        assert!(first.name.starts_with("Izz1 + Ia1"), "{}", first.name);
    }
}
