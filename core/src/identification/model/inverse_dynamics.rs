//! The torque model that is identified: rigid bodies, rotor inertia, viscous and Coulomb friction of every joint.

use super::base_columns::{BLOCK, BaseColumns};
use super::linear_model::LinearModel;
use super::standard::{COULOMB, ROTOR, STANDARD, VISCOUS};
use super::streamed::{self, Writer};
use crate::channels::Channels;
use crate::dynamics::{BaseParameters, Chain, Entries, Lanes, Motion};
use crate::effects::{direction, laws_of_drive};
use crate::error::Result;
use crate::identification::numerics::sequences::combine_into;
use crate::lane::Aligned;
use crate::random;
use crate::robot::{Drive, Inertia, Joint, PARAMETERS, Robot, SYMBOLS, UNITS, Unit};
use crate::signal::Filter;
use nalgebra::DMatrix;
use rand::RngExt;
use std::ops::Range;

/// States from which the base parameters are found; well above one per standard parameter of any arm.
const PROBES_PER_JOINT: usize = 40;

/// Torque linear in standard parameters (13 per moving body and its joint: m, mx .. Izz, Ia, Fv, Fc) and in the base parameters that torque
/// can separate.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::model::Model;
/// use tauscope::robot::{self, InertiaCheck};
///
/// // Of the 13 standard parameters of a pendulum torque shows five: two first moments, an inertia, and friction.
/// let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let model = Model::new(&pendulum);
/// assert_eq!((model.names().len(), model.base().len()), (13, 5));
///
/// let beta = model.base().values(&Model::standard_values(&pendulum));
/// let viscous = (0..5).find(|&base| model.drive_of(base) == Some((0, 1))).expect("it has viscous friction");
/// assert_eq!((beta[viscous], model.is_friction(viscous)), (0.4, true));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Model {
    robot: Robot,
    chain: Chain,
    names: Vec<String>,
    base: BaseParameters,
    columns: BaseColumns,
    equations: Vec<bool>,
}

impl Model {
    /// The model of `robot`, whose geometry and gravity it takes; its inertias play no part.
    pub fn new(robot: &Robot) -> Self {
        Self::with_equations(robot, &vec![true; robot.dof()])
    }

    /// The same where the torque of some joints is not known: they move like the others, but have no equation. What only
    /// their equations would show is no parameter.
    ///
    /// # Panics
    /// If `equations` does not have every joint.
    pub(crate) fn with_equations(robot: &Robot, equations: &[bool]) -> Self {
        assert_eq!(equations.len(), robot.dof(), "every joint has an equation or has none");
        let chain = Chain::new(robot);
        let names = standard_names(robot.bodies());
        // Joints that follow others stand behind the coordinates, and may carry some of them.
        let outwards: Vec<usize> =
            robot.outwards().into_iter().flat_map(|body| body * STANDARD..(body + 1) * STANDARD).collect();
        let base = BaseParameters::taken_in(&probe(&chain, equations), &names, &outwards);
        let columns = BaseColumns::new(&chain, equations, &base);
        Model { robot: robot.clone(), chain, names, base, columns, equations: equations.to_vec() }
    }

    /// Whether the torque of a joint is known.
    pub fn has_equation(&self, joint: usize) -> bool {
        self.equations[joint]
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
        if !self.base.merged(base).is_empty() {
            return None;
        }
        let standard = self.base.kept()[base];
        (standard % STANDARD).checked_sub(PARAMETERS).map(|which| (standard / STANDARD, which))
    }

    /// Whether a base parameter is viscous or Coulomb friction.
    pub fn is_friction(&self, base: usize) -> bool {
        self.base.kept()[base] % STANDARD > ROTOR
    }

    /// Whether the rotor inertia of `joint` is a base parameter of its own (and not part of a link's).
    pub(crate) fn rotor_stands_alone(&self, joint: usize) -> bool {
        (0..self.base.len()).any(|base| self.drive_of(base) == Some((joint, 0)))
    }

    /// Unit of a standard parameter.
    pub fn unit(standard: usize) -> Unit {
        match standard % STANDARD {
            inertial if inertial < PARAMETERS => UNITS[inertial],
            ROTOR => Unit::Inertia,
            friction => laws_of_drive()[friction - VISCOUS].parameters()[0].unit,
        }
    }

    /// Unit of a standard parameter on the joint it belongs to.
    pub fn unit_on_joint(&self, standard: usize) -> &'static str {
        self.robot.body(standard / STANDARD).kind.unit(Self::unit(standard))
    }

    /// Base columns on one joint: indices of the base parameters that can act there (those of links from the joint outwards).
    pub fn active(&self, joint: usize) -> Vec<usize> {
        self.columns.parameters(joint).to_vec()
    }

    /// How the columns of all base parameters are made.
    pub fn base_columns(&self) -> &BaseColumns {
        &self.columns
    }

    /// The columns of all base parameters along a motion: for every joint a table `[active base parameter][time]` in the
    /// order of [`Model::active`]. `width` is the velocity over which the sign in dry friction is smoothed (rad/s).
    pub fn columns(&self, motion: &Motion, width: f64) -> Vec<Channels> {
        self.columns.tables(&self.chain, [motion; 2], width)
    }

    /// [`Model::columns`] under another gravity vector in base coordinates (m/s2), without a width.
    pub(crate) fn columns_under(&self, gravity: [f64; 3], motion: &Motion) -> Vec<Channels> {
        self.columns.tables(&self.chain.clone().with_gravity(gravity), [motion; 2], 0.0)
    }

    /// [`Model::columns`] of one joint, where motors and links may move differently: inertial columns along `link`, rotor
    /// and friction columns along `motor`.
    pub(crate) fn columns_on(&self, joint: usize, motor: &Motion, link: &Motion, width: f64) -> Channels {
        let standard: Vec<usize> = self.active(joint).into_iter().map(|b| self.base.kept()[b]).collect();
        let mut table = standard_columns(&self.chain, joint, &standard, [motor, link], width);
        let rows = table.samples();
        self.columns.take_off(joint, table.as_mut_slice(), rows);
        table
    }

    /// Every `step`-th filtered sample of the columns of all joints, along the motion of motors and that of links; friction
    /// changes sign without a width.
    ///
    /// # Errors
    /// Those of the filter: the motion is too short for it.
    pub(crate) fn filtered_columns_apart(
        &self,
        motions: [&Motion; 2],
        filter: &Filter,
        step: usize,
    ) -> Result<Vec<Channels>> {
        let wanted: Vec<Range<usize>> = (0..self.dof()).map(|joint| self.columns.of(joint)).collect();
        streamed::filtered(&Along { model: self, motions }, filter, step, motions[0].samples(), &wanted)
    }

    /// Standard parameters of an arm, in the order of [`Model::names`].
    pub fn standard_values(robot: &Robot) -> Vec<f64> {
        (0..robot.bodies())
            .flat_map(|body| {
                let Joint { inertia, drive, .. } = robot.body(body);
                inertia.0.into_iter().chain([drive.armature, drive.viscous, drive.coulomb])
            })
            .collect()
    }

    /// `robot` with other standard parameters, in the order of [`Model::names`].
    pub fn with_standard_values(robot: &Robot, standard: &[f64]) -> Robot {
        let mut robot = robot.clone();
        for (body, values) in standard.chunks_exact(STANDARD).enumerate() {
            let joint = robot.body_mut(body);
            joint.inertia = Inertia(std::array::from_fn(|k| values[k]));
            joint.drive = Drive { armature: values[ROTOR], viscous: values[VISCOUS], coulomb: values[COULOMB] };
        }
        robot
    }
}

/// Linear in the base parameters; friction changes sign without a width.
impl LinearModel for Model {
    fn active(&self, joint: usize) -> Vec<usize> {
        Model::active(self, joint)
    }

    fn columns(&self, motion: &Motion, _: &[f64]) -> Vec<Channels> {
        Model::columns(self, motion, 0.0)
    }

    fn filtered_columns(&self, motion: &Motion, _: &[f64], filter: &Filter, step: usize) -> Result<Vec<Channels>> {
        self.filtered_columns_apart([motion; 2], filter, step)
    }

    fn torque(&self, motion: &Motion, _: &[f64], beta: &[f64]) -> Channels {
        let mut torque = Channels::zeros(motion.joints(), motion.samples());
        let of = |joint| self.columns.parameters(joint).iter().map(|&parameter| beta[parameter]).collect();
        let weights: Vec<Vec<f64>> = (0..self.dof()).map(of).collect();
        let mut table = Aligned::zeros(self.columns.places() * BLOCK.min(motion.samples()));
        for start in (0..motion.samples()).step_by(BLOCK) {
            let here = start..motion.samples().min(start + BLOCK);
            let rows = here.len();
            let table = &mut table[..self.columns.places() * rows];
            self.columns.write(Lanes::best(), &self.chain, [motion; 2], 0.0, here.clone(), table);
            for (joint, weights) in weights.iter().enumerate() {
                let share = self.columns.of(joint);
                let own = &table[share.start * rows..share.end * rows];
                combine_into(own, weights, &mut torque.channel_mut(joint)[here.clone()]);
            }
        }
        torque
    }
}

/// The base columns of a model along a motion.
struct Along<'a> {
    model: &'a Model,
    motions: [&'a Motion; 2],
}

impl Writer for Along<'_> {
    fn places(&self) -> usize {
        self.model.columns.places()
    }

    fn write(&self, samples: Range<usize>, table: &mut [f64]) {
        self.model.columns.write(Lanes::best(), &self.model.chain, self.motions, 0.0, samples, table);
    }
}

/// Joints that follow others have the drive of their coordinate; their own places for one stay empty.
fn standard_names(bodies: usize) -> Vec<String> {
    (1..=bodies)
        .flat_map(|joint| {
            SYMBOLS
                .into_iter()
                .chain(["Ia"])
                .chain(laws_of_drive().map(|law| law.parameters()[0].symbol))
                .map(move |symbol| format!("{symbol}{joint}"))
        })
        .collect()
}

/// Torque on `joint` per unit of some standard parameters, `[one of them][time]`, along the motion of motors and of links;
/// zero where one cannot act.
fn standard_columns(
    chain: &Chain,
    joint: usize,
    standard: &[usize],
    [motor, link]: [&Motion; 2],
    width: f64,
) -> Channels {
    let samples = motor.samples();
    let mut table = Channels::zeros(standard.len(), samples);
    let place = |wanted: usize| standard.iter().position(|&own| own == wanted);
    let entries = Entries::new(chain, |body, other| {
        std::array::from_fn(|p| place(body * STANDARD + p).filter(|_| other == joint && chain.moves(joint, body)))
    });
    entries.write(Lanes::best(), chain, link, 0..samples, table.as_mut_slice());
    // What the laws of viscous and Coulomb friction come to at unit parameters; a test holds them to it.
    let velocity = motor.qd.channel(joint);
    let drive: [&dyn Fn(usize) -> f64; 3] =
        [&|k| motor.qdd.channel(joint)[k], &|k| velocity[k], &|k| direction(velocity[k], width)];
    for (which, value) in drive.into_iter().enumerate() {
        if let Some(row) = place(joint * STANDARD + PARAMETERS + which) {
            table.channel_mut(row).iter_mut().enumerate().for_each(|(k, x)| *x = value(k));
        }
    }
    table
}

/// Regressor rows of all standard parameters at random noise-free states, for joints with an equation: what is separable
/// by any motion.
fn probe(chain: &Chain, equations: &[bool]) -> DMatrix<f64> {
    let dof = chain.dof();
    let samples = PROBES_PER_JOINT * dof;
    let motion = random_motion(dof, samples);
    let mut observation = DMatrix::zeros(samples * dof, chain.bodies() * STANDARD);
    let standard: Vec<usize> = (0..chain.bodies() * STANDARD).collect();
    for joint in (0..dof).filter(|&joint| equations[joint]) {
        let table = standard_columns(chain, joint, &standard, [&motion; 2], 0.0);
        for (column, values) in table.iter().enumerate() {
            observation.view_mut((joint * samples, column), (samples, 1)).copy_from_slice(values);
        }
    }
    observation
}

/// Independent states.
fn random_motion(dof: usize, samples: usize) -> Motion {
    let mut random = random::stream(0, "base parameter probe", 0);
    let mut motion = Motion::zeros(dof, samples);
    for signals in [&mut motion.q, &mut motion.qd, &mut motion.qdd] {
        signals.as_mut_slice().fill_with(|| random.random_range(-3.0..3.0));
    }
    motion
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{self, InertiaCheck};

    #[test]
    fn the_irb_1600_has_52_base_parameters_of_78() {
        let robot =
            robot::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required)
                .unwrap();
        let model = Model::new(&robot);
        assert_eq!(model.names().len(), 78);
        assert_eq!(model.base().len(), 52);
        let singular = probe(&Chain::new(&robot), &[true; 6]).svd(false, false).singular_values;
        let rank = singular.iter().filter(|&&s| s > 1e-10 * singular[0]).count();
        assert_eq!(rank, 52, "the singular values must agree with the QR");
        let first = &model.base().groupings()[0];
        assert!(first.name.starts_with("Izz1 + Ia1"), "{}", first.name);
    }

    #[test]
    fn a_joint_without_torque_has_no_equation() {
        let robot =
            robot::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required)
                .unwrap();
        let model = Model::with_equations(&robot, &[true, true, true, true, true, false]);
        // Rotor, friction and inertia about its own axis show in the torque of joint 6 alone.
        let own = |name: &str| model.base().groupings().iter().any(|grouping| grouping.name.starts_with(name));
        assert!(!own("Ia6") && !own("Fv6") && !own("Fc6") && own("Fv5") && model.active(5).is_empty());
        let random = random_motion(6, 30);
        let beta = model.base().values(&Model::standard_values(&robot));
        let whole = Model::new(&robot);
        let expected = whole.torque(&random, &[], &whole.base().values(&Model::standard_values(&robot)));
        let torque = model.torque(&random, &[], &beta);
        for joint in 0..5 {
            for (a, b) in torque.channel(joint).iter().zip(expected.channel(joint)) {
                assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} {b}");
            }
        }
        assert!(torque.channel(5).iter().all(|&torque| torque == 0.0));
    }

    /// A hollow wrist: the second of two tilted joints follows the first, and carries the hand.
    const WRIST: &str = r#"<robot name="wrist">
<link name="base"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="l3b"/><link name="l4"/>
<joint name="j1" type="continuous"><parent link="base"/><child link="l1"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/></joint>
<joint name="j2" type="continuous"><parent link="l1"/><child link="l2"/><origin xyz="0.15 0 0.1"/><axis xyz="0 1 0"/></joint>
<joint name="j3" type="continuous"><parent link="l2"/><child link="l3"/><origin xyz="0.6 0 0.1"/><axis xyz="0.8 0 0.6"/></joint>
<joint name="j3b" type="continuous"><parent link="l3"/><child link="l3b"/><origin xyz="0.1 0 0"/><axis xyz="0.8 0 -0.6"/>
<mimic joint="j3" multiplier="-2" offset="0"/></joint>
<joint name="j4" type="continuous"><parent link="l3b"/><child link="l4"/><origin xyz="0.1 0 0"/><axis xyz="1 0 0"/></joint>
</robot>"#;

    /// Regrouped into the hand's mass, the masses before it would have columns that hardly any motion separates.
    #[test]
    fn masses_are_regrouped_into_the_joint_that_follows_and_carries_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("wrist.urdf");
        std::fs::write(&path, WRIST).unwrap();
        let robot = robot::load(&path, InertiaCheck::Ignored).unwrap();
        assert_eq!((robot.dof(), robot.bodies()), (4, 5));
        let model = Model::new(&robot);
        assert_eq!(model.base().len(), 39);
        assert!(model.base().kept().is_sorted() && !model.base().kept().contains(&(3 * STANDARD)));
        let rows = probe(&Chain::new(&robot), &[true; 4]);
        let unit: Vec<_> = model.base().kept().iter().map(|&column| rows.column(column).normalize()).collect();
        let singular = DMatrix::from_columns(&unit).svd(false, false).singular_values;
        assert!(singular.max() < 20.0 * singular.min(), "{singular}");
    }

    #[test]
    fn friction_columns_are_the_laws_at_unit_parameters() {
        use crate::effects::{Along, Placed, contribution};
        let robot =
            robot::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required)
                .unwrap();
        let chain = Chain::new(&robot);
        let mut motion = Motion::zeros(robot.dof(), 5);
        motion.qd.as_mut_slice().iter_mut().enumerate().for_each(|(k, v)| *v = 0.02 * (k as f64 - 14.0));
        let time = [0.0; 5];
        let along = Along::new(&robot, &chain, &time, &motion, 0.05);
        for joint in 0..robot.dof() {
            let standard = [joint * STANDARD + PARAMETERS + 1, joint * STANDARD + PARAMETERS + 2];
            let table = standard_columns(&chain, joint, &standard, [&motion; 2], 0.05);
            for (column, effect) in laws_of_drive().into_iter().enumerate() {
                let law = contribution(&[Placed { effect, joint, parameters: vec![1.0] }], &along);
                assert_eq!(table.channel(column), law.channel(joint));
            }
        }
    }
}
