//! What a diagnosis rests on: the held-out rows with the residual of each model, and the first scan's candidates.

use crate::diagnosis::evidence::Ranked;
use crate::diagnosis::model::{Member, Moved, Session, columns_in};
use crate::diagnosis::regression::{Column, combined};
use crate::error::Result;

/// The held-out rows and the ranking of the candidates. Rows are means over 20 ms; tables are `[joint][row]`.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Evidence;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // What a plot of the held-out residual over the position takes.
/// let evidence: &Evidence = &diagnosis.evidence;
/// let rows = evidence.time.len();
/// assert_eq!((evidence.starts.last(), evidence.q[0].len(), evidence.extended[0].len()), (Some(&rows), rows, rows));
/// assert_eq!(evidence.ranking[0].family.effect, "torque_ripple");
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Evidence {
    /// First row of every held-out log, and the number of all rows at the end.
    pub starts: Vec<usize>,
    /// Time of the rows, each log's own, s.
    pub time: Vec<f64>,
    /// Valid rows: away from reversals.
    pub valid: Vec<Vec<bool>>,
    /// Smoothed positions, rad.
    pub q: Vec<Vec<f64>>,
    /// Their velocities, rad/s.
    pub qd: Vec<Vec<f64>>,
    /// Measured torque, N m.
    pub torque: Vec<Vec<f64>>,
    /// Measured torque less that of the arm as its URDF describes it, N m.
    pub described: Vec<Vec<f64>>,
    /// Measured torque less that of the fitted baseline, N m.
    pub baseline: Vec<Vec<f64>>,
    /// Measured torque less that of the model with all effects found, N m.
    pub extended: Vec<Vec<f64>>,
    /// Torque of every effect found, in their order, `[effect][joint][row]`, N m.
    pub effects: Vec<Vec<Vec<f64>>>,
    /// The best of every family before anything was found, the best first.
    pub ranking: Vec<Ranked>,
}

impl Evidence {
    /// Lays out the held-out rows of a session with the residuals of the arm as described, of the baseline and of the extended model.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn new(
        session: &Session,
        members: &[Member],
        ranking: Vec<Ranked>,
        [described, baseline, extended]: [&Column; 3],
    ) -> Result<Self> {
        let rows = &session.logs.test.rows;
        let table = |column: &Column| -> Vec<Vec<f64>> {
            let zeros = || vec![0.0; rows.len()];
            (0..rows.dof()).map(|joint| column.part(joint).map_or_else(zeros, <[f64]>::to_vec)).collect()
        };
        let effect = |member: &Member| -> Result<Vec<Vec<f64>>> {
            // What happened in a training log did not happen here.
            if member.candidate.log.is_some() {
                return Ok(table(&Column::default()));
            }
            let placed = std::slice::from_ref(&member.candidate.placed);
            let columns = columns_in(&session.model.arm, rows, None, placed, Moved::Modelled)?.concat();
            Ok(table(&combined(&columns, &member.factors)))
        };
        let joints = 0..rows.dof();
        Ok(Evidence {
            starts: rows.starts.clone(),
            time: rows.means(|log| log.time.clone()),
            valid: rows.valid.clone(),
            q: joints.clone().map(|joint| rows.means(|log| log.motion.q.channel(joint).to_vec())).collect(),
            qd: joints.map(|joint| rows.means(|log| log.motion.qd.channel(joint).to_vec())).collect(),
            torque: rows.torque.clone(),
            described: table(described),
            baseline: table(baseline),
            extended: table(extended),
            effects: members.iter().map(effect).collect::<Result<_>>()?,
            ranking,
        })
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.torque.len()
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }
}
