//! How much better laws of one nature fit than what is to be preferred to them.

use super::judging::Judged;
use crate::diagnosis::model::{Session, all_candidates};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Projection;
use crate::effects::{LIBRARY, Nature};
use crate::error::Result;
use rayon::prelude::*;

impl Session<'_> {
    /// Gain of the log-likelihood of the training torque over `fit` by the best law of a nature on each joint, whatever its shape, `[joint]`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn best_gains(&self, nature: Nature, whitener: &Whitener, fit: &Projection) -> Result<Vec<f64>> {
        let of_nature = LIBRARY.iter().map(|effect| effect.about()).filter(|about| about.nature == nature);
        let names: Vec<String> = of_nature.map(|about| about.name.to_owned()).collect();
        let candidates = all_candidates(&self.model.arm, &self.logs.train.rows, self.model.asked(&names))?;
        let judged: Vec<Judged> =
            candidates.par_iter().filter_map(|candidate| self.judge(candidate, whitener, fit)).collect();
        let of_joint = |joint: usize| -> Result<f64> {
            let own = judged.iter().filter(|judged| judged.candidate.placed.joint == joint);
            let Some(best) = own.max_by(|a, b| a.test.statistic.total_cmp(&b.test.statistic)) else { return Ok(0.0) };
            Ok(0.5 * self.refined(best.clone(), whitener, fit)?.test.statistic)
        };
        (0..self.model.base.dof()).map(of_joint).collect()
    }
}
