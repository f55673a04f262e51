//! The first answer: what the residual of the baseline follows, before any law is looked for.

use crate::diagnosis::Options;
use crate::diagnosis::logs::{Input, split};
use crate::diagnosis::model::{Known, Session};
use crate::diagnosis::variance::ResidualMap;
use crate::error::Result;
use crate::identification::model::Model;
use crate::recording::Recording;

/// What the residual of the arm of `model` follows in all logs but those from before a change.
///
/// # Errors
/// If there is no log, a log is too short or does not fit the arm, or a joint hardly moves.
pub fn first_look(model: &Model, input: &Input, options: &Options) -> Result<ResidualMap> {
    let known = Known { effects: input.present.clone(), ..Known::nothing(model.robot(), options.trust) };
    let (early, late) = split(&input.train);
    let (early, late): (Vec<&Recording>, Vec<&Recording>) = (early.iter().collect(), late.iter().collect());
    let (train, test) = if input.test.is_empty() { (&early, &late) } else { (&input.train, &input.test) };
    let mut session = Session::knowing(model, options.trust, known, train, test)?;
    let noise = session.noise_under(&session.train.baseline);
    session.settle(&mut [], &noise.whitener)?;
    Ok(session.map(&[], options)?)
}

impl Session<'_> {
    /// What the residual of the model with `members` follows in all logs.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn map(&self, members: &[crate::diagnosis::model::Member], options: &Options) -> Result<ResidualMap> {
        let all = self.over_all_logs();
        let fixed = all.all_columns(&all.train, members)?;
        Ok(ResidualMap::new(&all.train, &fixed, &self.arm, options.alpha, options.seed))
    }
}
