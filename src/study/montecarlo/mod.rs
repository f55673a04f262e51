//! Monte Carlo studies: the same identification on many draws of noise and, where the scenario says so, of plants, motions
//! and starts.
//!
//! Every trial draws from random streams of its own, keyed by the seed and its index, so that a trial can be replayed alone
//! and the results do not depend on the number of threads or machines.

mod folder;
mod held_out;
mod join;
mod plan;
mod shard;
mod summary;
mod table;
mod trial;

pub use folder::{Progress, StudyFolder};
pub use join::{Report, SUMMARY_SCHEMA, merge};
pub use plan::{Identity, Overrides, Plan};
pub use shard::Shard;
pub use summary::{BestWindow, Cell, Quantiles, Summary};
pub use table::Timings;
pub use trial::{Found, Row};

use crate::error::Result;
use crate::identification::model::Model;
use crate::scenario::Setup;
use crate::simulation::{Truth, simulate};
use held_out::HeldOut;

/// A study ready to run: the plan and what all trials share.
pub struct Study {
    /// The scenario.
    pub setup: Setup,
    /// What is drawn and compared.
    pub plan: Plan,
    model: Model,
    /// The exact run that trials put noise on; None where each trial is simulated anew.
    shared: Option<Truth>,
    held_out: HeldOut,
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
