//! The models under which descriptions are compared, as inner products of their columns.
//!
//! Every joint has, in addition to the columns of the bodies, nuisance columns of its drive: a constant and the size of its friction
//! at three speeds. The sizes cannot be negative, since friction takes power at any speed; how they change with speed is
//! free, so that neither falling nor Stribeck-like friction looks like a fault of the description.
//!
//! Each log may have a load of its own at the tip, which all joints share. Free base parameters hold that of the first log.

use super::super::change::Description;
use super::load::Load;
use super::masses;
use super::rows::Rows;
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::identification::model::Model;
use crate::linear::gram_matrix;
use crate::robot::Robot;
use crate::signal::hat;
use nalgebra::{DMatrix, DVector, Vector3};
use std::ops::Range;

/// Quantiles of a joint's speed at which the size of its friction is free; linear between.
const FRICTION_KNOTS: [f64; 3] = [0.05, 0.4, 0.95];

/// Quantiles of a joint's position between which a torque that depends on it is linear; at the first it is a part of the constant.
const POSITION_KNOTS: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];

/// Columns of friction, the last ones of every joint.
pub(crate) const FRICTION_COLUMNS: usize = FRICTION_KNOTS.len();

/// What is known of the bodies.
pub(crate) enum Physics {
    /// The geometry: base parameters are free, and shared by all joints.
    Free(Box<Model>),
    /// The bodies as described; rotors are free.
    Bodies(Box<Robot>),
    /// The same, and a torque on one joint that depends on its position alone, as those of springs and balancers do.
    Sprung(Box<Robot>, usize),
    /// The bodies as described, but for their masses: a factor of each is free, and rotors are.
    Masses(Box<Robot>),
    /// The bodies as described, of whose torques each joint shows another multiple; rotors are free. The multiple of one joint has no
    /// information on the others, so that no load can be estimated.
    Multiples(Box<Robot>),
    /// Nothing: each joint has gravity on a level axis and an inertia of its own.
    Alone,
}

/// The columns of a joint, row by row.
struct JointColumns {
    /// Place of every column among all parameters, by log.
    parameters: Vec<Vec<Option<usize>>>,
    columns: Vec<Vec<f64>>,
    /// The torque that is known, that of described bodies.
    known: Option<Vec<f64>>,
    /// Rows in which the joint surely moves.
    valid: Vec<usize>,
}

/// Inner products of a joint's columns with each other and with every torque, block by block.
pub(crate) struct JointTable {
    /// Place of every column among all parameters, by log; none where a column plays no part in a log.
    pub parameters: Vec<Vec<Option<usize>>>,
    /// Normal matrix of each block.
    pub gram: Vec<DMatrix<f64>>,
    /// Columns times the torque that is known (that of described bodies), of each block.
    pub with_known: Vec<DVector<f64>>,
    /// Sum of squares of the known torque, of each block.
    pub known_squares: Vec<f64>,
    /// Columns times torque, `[channel][block]`.
    pub with_torque: Vec<Vec<DVector<f64>>>,
    /// Known torque times torque, `[channel][block]`.
    pub known_torque: Vec<Vec<f64>>,
    /// Sum of squares of the torque, `[channel][block]`.
    pub squares: Vec<Vec<f64>>,
    /// Rows of each block.
    pub rows: Vec<usize>,
}

/// Parameters whose sum is bounded from above; none of them is negative.
pub(crate) struct Limit {
    /// The parameters.
    pub parameters: Vec<usize>,
    /// The largest sum.
    pub most: f64,
}

/// What is known of the values of parameters.
#[derive(Default)]
pub(crate) struct Bounds {
    /// Whether a parameter cannot be negative.
    pub nonnegative: Vec<bool>,
    /// Bounded sums.
    pub limits: Vec<Limit>,
}

/// The tables of all joints under one description of the motion.
pub(crate) struct Tables {
    /// One per joint.
    pub joints: Vec<JointTable>,
    /// Bounds of the parameters.
    pub bounds: Bounds,
}

impl Physics {
    /// The geometry of an arm, with base parameters that serve any direction of gravity.
    pub(crate) fn free(robot: &Robot) -> Physics {
        // No direction of this vector is special, so that what no gravity can separate is merged and nothing else.
        let gravity = Vector3::new(4.1, -5.3, 7.2);
        Physics::Free(Box::new(Model::new(&Robot { gravity, ..robot.clone() })))
    }

    /// The bodies as described, where they are bodies that can exist.
    pub(crate) fn bodies(robot: &Robot) -> Option<Physics> {
        let possible = robot
            .joints
            .iter()
            .all(|joint| joint.inertia.0.iter().all(|v| *v == 0.0) || joint.inertia.physical_fault(1e-3).is_none());
        let mass: f64 = robot.joints.iter().map(|joint| joint.inertia.mass()).sum();
        (possible && mass > 0.0).then(|| Physics::Bodies(Box::new(robot.clone())))
    }

    /// The same of a description that is no placeholder, which describes no bodies.
    pub(crate) fn described(robot: &Robot) -> Option<Physics> {
        Some(robot).filter(|robot| robot.placeholders().is_none()).and_then(Physics::bodies)
    }

    /// The bodies as described, each as heavy as the logs have it.
    pub(crate) fn masses(robot: &Robot) -> Option<Physics> {
        Physics::bodies(robot).map(|_| Physics::Masses(Box::new(robot.clone())))
    }

    /// The bodies as described, in a unit of its own on each joint.
    pub(crate) fn multiples(robot: &Robot) -> Option<Physics> {
        Physics::bodies(robot).map(|_| Physics::Multiples(Box::new(robot.clone())))
    }

    /// The arm, where its geometry is known.
    pub(crate) fn robot(&self) -> Option<&Robot> {
        match self {
            Physics::Free(model) => Some(model.robot()),
            Physics::Bodies(robot) | Physics::Sprung(robot, _) | Physics::Masses(robot) | Physics::Multiples(robot) => {
                Some(robot)
            }
            Physics::Alone => None,
        }
    }

    /// The tables of a description.
    pub(crate) fn tables(&self, rows: &Rows, description: &Description) -> Tables {
        let (columns, bounds) = self.columns(rows, description);
        Tables { joints: columns.into_iter().map(|own| JointTable::new(own, rows)).collect(), bounds }
    }

    /// The torque that the model has on a joint under a description, row by row, with parameters in the order of the tables.
    pub(crate) fn predicted(
        &self,
        rows: &Rows,
        description: &Description,
        joint: usize,
        parameters: &[f64],
    ) -> Vec<f64> {
        let (mut columns, _) = self.columns(rows, description);
        let own = columns.swap_remove(joint);
        let at = |row: usize| {
            let places = own.parameters[rows.log[rows.block[row]]].iter().zip(&own.columns);
            let known = own.known.as_ref().map_or(0.0, |known| known[row]);
            known + places.filter_map(|(place, column)| Some(parameters[(*place)?] * column[row])).sum::<f64>()
        };
        (0..rows.block.len()).map(at).collect()
    }

    /// The columns of all joints under a description.
    fn columns(&self, rows: &Rows, description: &Description) -> (Vec<JointColumns>, Bounds) {
        let dof = description.dof();
        let (q, speeds) = (description.positions(&rows.motion.q), description.rates(&rows.motion.qd));
        let motion = match rows.at_rest {
            true => Motion::at_rest(q),
            false => Motion { q, qd: speeds.clone(), qdd: description.rates(&rows.motion.qdd) },
        };
        // Gravity of masses that a controller does not know stays in a torque that it compensates.
        let compensated = description.gravity == Vector3::zeros();
        let gravity = match self {
            Physics::Masses(robot) if compensated => robot.gravity.into(),
            _ => description.gravity.into(),
        };
        let known = match self {
            Physics::Bodies(robot) | Physics::Sprung(robot, _) => {
                let chain = Chain::new(robot).with_gravity(gravity);
                Some(inverse_dynamics(&chain, &robot.inertial_parameters(), &motion))
            }
            Physics::Masses(robot) if compensated => Some(masses::compensation(robot, &motion)),
            _ => None,
        };
        let mut nonnegative = Vec::new();
        // Columns of the bodies of every joint, with their places.
        let bodies: Vec<(Vec<usize>, Vec<Vec<f64>>)> = match self {
            Physics::Free(model) => {
                nonnegative = (0..model.base().len()).map(|b| matches!(model.drive_of(b), Some((_, 0)))).collect();
                let columns = model.columns_under(gravity, &motion);
                let of = |(joint, table): (usize, &Channels)| {
                    let active = model.active(joint).into_iter().enumerate().filter(|(_, b)| !model.is_friction(*b));
                    active.map(|(place, b)| (b, table.channel(place).to_vec())).unzip()
                };
                columns.iter().enumerate().map(of).collect()
            }
            Physics::Bodies(_) | Physics::Sprung(..) => {
                nonnegative.resize(dof, true);
                let rotor = |joint: usize| (vec![joint], vec![motion.qdd.channel(joint).to_vec()]);
                let mut joints: Vec<(Vec<usize>, Vec<Vec<f64>>)> = (0..dof).map(rotor).collect();
                if let Physics::Sprung(_, sprung) = self {
                    let (places, columns) = &mut joints[*sprung];
                    columns.extend(position_columns(motion.q.channel(*sprung)));
                    places.extend(dof..dof + columns.len() - 1);
                    nonnegative.resize(dof + columns.len() - 1, false);
                }
                joints
            }
            Physics::Masses(robot) => {
                let bodies = robot.bodies();
                nonnegative.resize(bodies + dof, true);
                let torques = masses::torques(robot, gravity, &motion);
                let of = |joint: usize| {
                    let own = torques.iter().map(|torque| torque.channel(joint).to_vec());
                    let columns = own.chain([motion.qdd.channel(joint).to_vec()]).collect();
                    ((0..bodies).chain([bodies + joint]).collect(), columns)
                };
                (0..dof).map(of).collect()
            }
            Physics::Multiples(robot) => {
                nonnegative.resize(2 * dof, true);
                let chain = Chain::new(robot).with_gravity(gravity);
                let torques = inverse_dynamics(&chain, &robot.inertial_parameters(), &motion);
                let of = |joint: usize| {
                    let columns = vec![torques.channel(joint).to_vec(), motion.qdd.channel(joint).to_vec()];
                    (vec![joint, dof + joint], columns)
                };
                (0..dof).map(of).collect()
            }
            Physics::Alone => {
                nonnegative = (0..3 * dof).map(|place| place % 3 == 2).collect();
                let of = |joint: usize| {
                    let q = motion.q.channel(joint);
                    let columns = vec![
                        q.iter().map(|q| q.sin()).collect(),
                        q.iter().map(|q| q.cos()).collect(),
                        motion.qdd.channel(joint).to_vec(),
                    ];
                    ((3 * joint..3 * joint + 3).collect(), columns)
                };
                (0..dof).map(of).collect()
            }
        };
        let mut bounds = Bounds { nonnegative, limits: Vec::new() };
        let logs = rows.logs();
        let loads = self.loads(gravity, &motion, logs, &mut bounds);
        let mut joints = Vec::with_capacity(dof);
        for (joint, (shared, mut columns)) in bodies.into_iter().enumerate() {
            let valid: Vec<usize> = {
                let moves = &rows.moves[description.position_of[joint]];
                (0..moves.len()).filter(|&row| moves[row]).collect()
            };
            let mut parameters = vec![shared.into_iter().map(Some).collect::<Vec<_>>(); logs];
            if let Some(Loads { load, first }) = &loads {
                columns.extend(load.columns[joint].iter().cloned());
                for (own, first) in parameters.iter_mut().zip(first) {
                    own.extend((0..load.columns[joint].len()).map(|place| first.map(|first| first + place)));
                }
            }
            for (place, column) in drive_columns(speeds.channel(joint), &valid).into_iter().enumerate() {
                parameters.iter_mut().for_each(|own| own.push(Some(bounds.nonnegative.len())));
                bounds.nonnegative.push(place > 0);
                columns.push(column);
            }
            let known = known.as_ref().map(|known| known.channel(joint).to_vec());
            joints.push(JointColumns { parameters, columns, known, valid });
        }
        (joints, bounds)
    }

    /// The load of every log: free base parameters hold that of the first; where nothing is known of the bodies, nothing is known of
    /// a load.
    fn loads(&self, gravity: [f64; 3], motion: &Motion, logs: usize, bounds: &mut Bounds) -> Option<Loads> {
        let (load, held) = match self {
            Physics::Free(model) if logs > 1 => (Load::difference(model.chain(), gravity, motion), 1),
            Physics::Bodies(robot) | Physics::Sprung(robot, _) | Physics::Masses(robot) => {
                (Load::on(robot, gravity, motion), 0)
            }
            Physics::Free(_) | Physics::Multiples(_) | Physics::Alone => return None,
        };
        let mut first = vec![None; logs];
        for first in &mut first[held..] {
            let start = bounds.nonnegative.len();
            *first = Some(start);
            let masses = (0..load.nonnegative.len()).filter(|&place| load.nonnegative[place]);
            let parameters = masses.map(|place| start + place).collect();
            bounds.limits.extend(load.heaviest.map(|most| Limit { parameters, most }));
            bounds.nonnegative.extend(&load.nonnegative);
        }
        Some(Loads { load, first })
    }
}

/// The loads of all logs.
struct Loads {
    /// Their columns.
    load: Load,
    /// Place of the first parameter of each among all parameters.
    first: Vec<Option<usize>>,
}

/// Quantiles of some values; zeros where there are none.
fn quantiles<const N: usize>(values: impl Iterator<Item = f64>, shares: [f64; N]) -> [f64; N] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    shares.map(|share| values.get(((values.len().max(1) - 1) as f64 * share) as usize).copied().unwrap_or(0.0))
}

/// Hats of the position, without the first, which the others and the constant of the drive make up.
fn position_columns(position: &[f64]) -> Vec<Vec<f64>> {
    let knots = quantiles(position.iter().copied(), POSITION_KNOTS);
    (1..knots.len()).map(|knot| position.iter().map(|q| hat(&knots, knot, *q)).collect()).collect()
}

/// A constant, and the direction of motion weighted by hats of the speed; `valid` rows place their knots.
fn drive_columns(velocity: &[f64], valid: &[usize]) -> Vec<Vec<f64>> {
    let knots = quantiles(valid.iter().map(|&row| velocity[row].abs()), FRICTION_KNOTS);
    let mut columns = vec![vec![1.0; velocity.len()]];
    columns.extend(
        (0..knots.len()).map(|knot| velocity.iter().map(|v| v.signum() * hat(&knots, knot, v.abs())).collect()),
    );
    columns
}

impl JointTable {
    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.gram.first().map_or(0, |gram| gram.ncols())
    }

    /// Columns of the constant of the drive, which is the first, and of its friction; none of an empty table.
    pub(crate) fn constant_and_friction(&self) -> Option<Range<usize>> {
        Some(self.width().checked_sub(FRICTION_COLUMNS + 1)?..self.width())
    }

    fn new(JointColumns { parameters, columns, known, valid }: JointColumns, rows: &Rows) -> JointTable {
        let (blocks, width, channels) = (rows.log.len(), columns.len(), rows.tau.channels());
        let mut table = JointTable {
            parameters,
            gram: Vec::with_capacity(blocks),
            with_known: Vec::with_capacity(blocks),
            known_squares: Vec::with_capacity(blocks),
            with_torque: vec![Vec::with_capacity(blocks); channels],
            known_torque: vec![Vec::with_capacity(blocks); channels],
            squares: vec![Vec::with_capacity(blocks); channels],
            rows: Vec::with_capacity(blocks),
        };
        // The signals that the columns are multiplied with come after these, so that one product holds all sums of a block.
        let torques = (0..channels).map(|channel| rows.tau.channel(channel));
        let signals: Vec<&[f64]> = columns.iter().map(Vec::as_slice).chain(known.as_deref()).chain(torques).collect();
        let first_torque = signals.len() - channels;
        for block in 0..blocks {
            let own: Vec<usize> = valid.iter().copied().filter(|&row| rows.block[row] == block).collect();
            let values = signals.iter().flat_map(|signal| own.iter().map(|&row| signal[row]));
            let sums = gram_matrix(&DMatrix::from_iterator(own.len(), signals.len(), values));
            let with = |signal: usize| sums.view((0, signal), (width, 1)).column(0).into_owned();
            let known = known.as_ref().map(|_| width);
            table.gram.push(sums.view((0, 0), (width, width)).into_owned());
            table.with_known.push(known.map_or_else(|| DVector::zeros(width), with));
            table.known_squares.push(known.map_or(0.0, |known| sums[(known, known)]));
            for channel in 0..channels {
                let torque = first_torque + channel;
                table.with_torque[channel].push(with(torque));
                table.known_torque[channel].push(known.map_or(0.0, |known| sums[(known, torque)]));
                table.squares[channel].push(sums[(torque, torque)]);
            }
            table.rows.push(own.len());
        }
        table
    }
}
