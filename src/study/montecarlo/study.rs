//! A study ready to run.

use super::held_out::HeldOut;
use super::plan::Plan;
use crate::error::Result;
use crate::identification::model::Model;
use crate::scenario::{Setup, simulate};
use crate::simulation::Truth;

/// A study ready to run: the plan and what all trials share.
///
/// ```
/// use tauscope::scenario::Setup;
/// use tauscope::study::montecarlo::{Overrides, Plan, Study};
///
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let plan = Plan::new(&setup, Overrides { windows: Some(vec![61]), ..Overrides::default() })?;
/// let study = Study::new(setup, plan)?;
///
/// // One trial: the noise is drawn, and every estimator has its row.
/// let rows = study.trial(0);
/// assert_eq!(rows.len(), study.plan.cells());
/// assert_eq!(study.parameters().len(), rows[0].truth.len());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct Study {
    /// The scenario.
    pub setup: Setup,
    /// What is drawn and compared.
    pub plan: Plan,
    pub(super) model: Model,
    /// The exact run that trials put noise on; None where each trial is simulated anew.
    pub(super) shared: Option<Truth>,
    pub(super) held_out: HeldOut,
}

impl Study {
    /// Prepares a study: simulates in rapier what all trials share.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn new(setup: Setup, plan: Plan) -> Result<Self> {
        let model = Model::new(&setup.known);
        let truth = simulate(&setup, &setup.held_out, &mut |_| ())?;
        let held_out = HeldOut::new(&setup, &model, &truth)?;
        let shared = if plan.draws_runs() { None } else { Some(simulate(&setup, &setup.motion, &mut |_| ())?) };
        Ok(Study { setup, plan, model, shared, held_out })
    }

    /// Names of the base parameters.
    pub fn parameters(&self) -> Vec<String> {
        self.model.base().groupings().iter().map(|grouping| grouping.name.clone()).collect()
    }
}
