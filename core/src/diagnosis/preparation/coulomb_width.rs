//! The Coulomb smoothing velocity. Books write a sign; simulators and drivers write tanh(v / width), a ramp, a soft constraint or
//! v / sqrt(v^2 + width^2), whose tails reach far beyond the rows that are left out near reversals and look like friction that falls at low
//! speed.
//!
//! One law that is wrong on one joint must not be taken for it: what the joints that gain most by it gain does not count, unless they gain
//! more by it than by any friction law of speed in the library.

use super::coulomb_forms::{Forms, Tried};
use crate::diagnosis::criteria::Levels;
use crate::diagnosis::logs::Log;
use crate::diagnosis::model::{Member, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::effects::{Nature, Rounding};
use crate::error::Result;

/// Times that the joints are decided: with a plain sign on the others and in the noise under it, then with the best of the time before.
const SWEEPS: usize = 2;

/// No share of a slow joint's speed in that of a fast one is less: so slow a joint creeps.
const LEAST_SHARE: f64 = 1e-3;

/// What the rounding of the joints is taken for.
#[derive(Debug)]
pub(super) struct Likeliest {
    /// The rounding of each joint.
    pub rounding: Vec<Rounding>,
    /// Gain of the log-likelihood by the likeliest rounding of each joint where that was not taken.
    pub gains: Vec<f64>,
}

impl Likeliest {
    /// Those of the likeliest roundings that were `tried` which are `taken`.
    fn new(tried: &Tried, taken: Vec<Rounding>) -> Self {
        let open =
            |((_, gain), taken): (&(Rounding, f64), &Rounding)| if taken.width() > 0.0 { 0.0 } else { gain.max(0.0) };
        Likeliest { gains: tried.iter().zip(&taken).map(open).collect(), rounding: taken }
    }
}

impl Session<'_> {
    /// Decides on the rounding again with `members` in the model, and returns the joints on which it is another: what misses a load may
    /// look like a wide smoothing of friction's sign. What is known from before a change stays, and low-pass filtered torque does not determine it.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn round_again(&mut self, members: &[Member]) -> Result<Vec<usize>> {
        if !self.model.known.reference.is_empty() || self.logs.passband.is_some() {
            return Ok(Vec::new());
        }
        let pooled = self.logs.apart.then(|| self.over_all_logs());
        let others: Vec<Member> =
            members.iter().filter(|member| member.placed.effect.about().nature != Nature::OfSpeed).cloned().collect();
        let Likeliest { rounding, gains } = likeliest(pooled.as_ref().unwrap_or(self), &others)?;
        self.take_rounding_gains(gains);
        let before = &self.model.arm.coulomb_rounding;
        let others: Vec<usize> = (0..rounding.len()).filter(|&joint| rounding[joint] != before[joint]).collect();
        if !others.is_empty() {
            tracing::debug!(?rounding, "rounding of the sign of friction with what was found");
            self.round_friction(rounding);
        }
        Ok(others)
    }
}

/// The rounding of each joint under which its torque is likeliest with `members` in the model; a plain sign where that does as well. The
/// `session` is that over all logs: slow motions determine it best, and those may be the held-out ones.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn likeliest(session: &Session, members: &[Member]) -> Result<Likeliest> {
    let (model, train) = (session.model.base, &session.logs.train);
    let arm = &session.model.arm;
    let dry_columns = |rounding: &[Rounding]| arm.dry_columns(model, &train.rows, rounding);
    let mut present = session.model.columns(train, members)?;
    let sharp = vec![Rounding::Sharp; model.dof()];
    let places: Vec<usize> = dry_columns(&sharp).into_iter().map(|(at, _)| at).collect();
    let mut rounded = |rounding: &[Rounding]| -> Vec<Column> {
        dry_columns(rounding).into_iter().for_each(|(at, column)| present[at] = column);
        present.clone()
    };
    // A rounding changes the columns of Coulomb friction alone: all others are fitted once.
    let others = |whitener: &Whitener, present: &[Column]| {
        let others = present.iter().enumerate().filter(|(at, _)| !places.contains(at));
        whitener.fit(&others.map(|(_, column)| column.clone()).collect::<Vec<_>>(), &train.torque)
    };
    let shares = shares(&session.logs.train.rows.logs, model.dof());
    // Another form, and a rounding in the place of a law of the library, must be likelier: though a rounding has fewer parameters than any
    // law.
    let Levels { log_odds: odds, misfit, few, .. } = session.criteria.levels;
    let clearly = session.criteria.criterion_gap();
    let rows = &train.rows;
    let roundings = |tried: &Tried| tried.iter().map(|(own, _)| *own).collect::<Vec<Rounding>>();
    // The noise under a plain sign holds what the plain sign misses: forms are compared in the noise under the first that come out best.
    let mut given = sharp.clone();
    for _ in 1..SWEEPS {
        let whitener = Whitener::new(rows, &train.torque, &rounded(&given));
        let others = others(&whitener, &rounded(&given));
        let forms = Forms { arm, model, rows, whitener: &whitener, others: &others, shares: &shares, odds };
        given = roundings(&forms.likeliest(&given));
    }
    let whitener = Whitener::new(rows, &train.torque, &rounded(&given));
    let present = rounded(&sharp);
    let (plain, others) = (whitener.fit(&present, &train.torque), others(&whitener, &present));
    let forms = Forms { arm, model, rows, whitener: &whitener, others: &others, shares: &shares, odds };
    let best = forms.likeliest(&given);
    let by_laws = session.best_gains(Nature::OfSpeed, &whitener, &plain)?;
    tracing::debug!(?best, ?by_laws, "rounding of the sign of friction");
    let surely = surely(&best, &by_laws, odds);
    let gained = best.iter().zip(&surely).map(|((_, gain), surely)| if *surely { *gain } else { 0.0 }).collect();
    if of_most(gained, few) < clearly {
        // One joint alone must be explained by its width: what is much beyond the noise may look like anything.
        let (left, count) = (forms.left(&roundings(&best)), whitener.rows());
        let of_noise = |joint: usize| left[joint] / (count[joint] as f64) < misfit;
        let alone = |joint: &usize| surely[*joint] && best[*joint].1 > clearly && of_noise(*joint);
        let joints = 0..model.dof();
        let taken = joints.map(|joint| if alone(&joint) { best[joint].0 } else { Rounding::Sharp }).collect();
        return Ok(Likeliest::new(&best, taken));
    }
    // The others have the form of most and its median width, if their torque does not contradict it.
    let of_fast = best.iter().zip(&shares).zip(&surely).filter(|(_, surely)| **surely);
    let of_fast: Vec<Rounding> = of_fast.map(|(((own, _), share), _)| own.scaled(1.0 / share)).collect();
    let of_most = shares.iter().map(|share| of_most_joints(&of_fast).scaled(*share)).collect();
    let as_most = forms.each(&roundings(&best), of_most).into_iter();
    let as_most = as_most.map(|(own, gain)| if gain > 0.0 { own } else { Rounding::Sharp });
    let all = best.iter().zip(surely).zip(as_most);
    let taken =
        all.map(|(((own, gain), surely), as_most)| if surely && *gain > odds { *own } else { as_most }).collect();
    Ok(Likeliest::new(&best, taken))
}

/// The commonest form, with the median of its widths.
fn of_most_joints(each: &[Rounding]) -> Rounding {
    let count = |own: &Rounding| each.iter().filter(|other| own.is_like(**other)).count();
    let Some(commonest) = each.iter().rev().max_by_key(|own| count(own)) else { return Rounding::Sharp };
    let mut alike: Vec<Rounding> = each.iter().copied().filter(|own| own.is_like(*commonest)).collect();
    alike.sort_by(|a, b| a.width().total_cmp(&b.width()));
    alike[alike.len() / 2]
}

/// Share of each joint's speed in that of a fast joint, from the log in which it is fastest.
fn shares(logs: &[Log], joints: usize) -> Vec<f64> {
    let of_joint = |joint: usize| logs.iter().map(|log| log.slow[joint].share).fold(LEAST_SHARE, f64::max);
    (0..joints).map(of_joint).collect()
}

/// Whether each joint gains more by its width than by any law.
fn surely(best: &Tried, by_laws: &[f64], odds: f64) -> Vec<bool> {
    let is_sure = |((own, gain), by_law): (&(Rounding, f64), &f64)| own.width() > 0.0 && *gain > odds + by_law;
    best.iter().zip(by_laws).map(is_sure).collect()
}

/// The sum without the `few` largest, where more than twice as many are left.
fn of_most(mut gains: Vec<f64>, few: usize) -> f64 {
    gains.sort_by(f64::total_cmp);
    let counted = gains.len() - few.min(gains.len().saturating_sub(1) / 2);
    gains[..counted].iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::recording::Recording;

    #[test]
    fn what_one_or_two_joints_gain_does_not_count() {
        assert_eq!(of_most(vec![900.0, 1.0, 2.0, 800.0, -1.0, 0.5], 2), 2.5);
        assert_eq!(of_most(vec![5.0, 9.0, 4.0], 2), 9.0);
        assert_eq!(of_most(vec![7.0], 2), 7.0);
    }

    #[test]
    fn a_joint_with_a_plain_sign_has_gained_by_no_width() {
        let tanh = Rounding::Tanh(0.02);
        let best = vec![(tanh, 13.0), (Rounding::Sharp, 59.0), (tanh, 10.9), (tanh, 11.1)];
        assert_eq!(surely(&best, &[2.0, 2.0, 8.0, 8.0], 3.0), [true, false, false, true]);
    }

    #[test]
    fn widths_of_a_slow_joint_are_less_by_the_share_of_its_speed() {
        // Swings of 0.25 Hz at these speeds in two logs.
        let log = |speeds: [f64; 4]| {
            let swing = |speed: f64| (0..4000).map(|k| speed / 1.57 * (1.57 * 0.005 * f64::from(k)).sin()).collect();
            let q = Channels::from_vectors(&speeds.map(swing));
            let time = (0..4000).map(|k| 0.005 * f64::from(k)).collect();
            let (joints, tau) = (["a", "b", "c", "d"].map(String::from).to_vec(), Channels::zeros(4, 4000));
            let recording = Recording { joints, time, q, tau, ..Recording::default() };
            Log::new(&recording, (&[5.0; 4], 5.0), None, &Levels::default()).unwrap()
        };
        let found = shares(&[log([2.0, 0.29, 0.012, 0.0]), log([0.1, 0.1, 0.003, 0.0])], 4);
        let wanted = [1.0, 0.29 / 0.3, 0.012 / 0.3, LEAST_SHARE];
        assert!(found.iter().zip(wanted).all(|(own, wanted)| (own / wanted - 1.0).abs() < 0.02), "{found:?}");
    }

    #[test]
    fn most_joints_are_of_one_form() {
        let [a, b, c, d] = [Rounding::Tanh(0.01), Rounding::Ramp(0.3), Rounding::Tanh(0.03), Rounding::Tanh(0.02)];
        assert_eq!(of_most_joints(&[a, b, c, d]), d);
        assert_eq!(of_most_joints(&[a, b]), a);
    }
}
