//! Diagnosis: what the model of an arm misses, named from measured logs with a controlled rate of false alarms.
//!
//! | step | file |
//! |---|---|
//! | faults of the data, before any physics | [`screening`] |
//! | what the simulation has already, logs from before a change | [`known`] |
//! | logs to rows: smooth positions, block means, reversals left out | [`cutoffs`], [`log`], [`rows`], [`smoothing`] |
//! | joints without torque, or that hardly move | [`equations`] |
//! | the low-pass that torque went through before it was logged | [`passband`], [`low_pass`] |
//! | which low-passes serve the logs best, and how sharply friction turns | [`opening`], [`preparation`], [`sign_width`] |
//! | the arm's baseline and what effects add to it | [`arm`], [`column`](mod@column) |
//! | every effect at every place, at a grid of its shapes | [`candidates`], [`grid`], [`roles`] |
//! | which bodies are believable | [`bodies`] |
//! | noise of each joint, from what a rich regression leaves | [`whitening`], [`innovations`] |
//! | logs and arm, fits of a model | [`side`], [`session`], [`solution`] |
//! | score tests, and the level of the best of many | [`score`], [`judging`], [`multiplicity`] |
//! | one round: scan, contest of the best for the name | [`contest`] |
//! | forward selection, held-out acceptance, backward pass | [`selection`], [`round`], [`eligible`], [`acceptance`], [`found`] |
//! | what only all logs together show | [`all_logs`], [`cross_validation`] |
//! | names once all is known | [`renaming`] |
//! | gain on held-out rows; evidence that does not rest on a moment | [`held_out`](mod@held_out), [`stretches`] |
//! | gears with play, by their impacts | [`impacts`], [`play`] |
//! | evidence beside slow noise and the errors of positions; torque that is flat | [`beside`](mod@beside), [`errors_of_motion`], [`cut_off`] |
//! | inertias that are wrong as a whole | [`inertias`] |
//! | structure that no candidate carries | [`unexplained`], [`structure`], [`generic`], [`harmonics`], [`disagreement`](mod@disagreement) |
//! | the answer | [`conclusion`], [`answer`], [`verdict`], [`derived`], [`residual_structure`], [`gap`], [`accounted`] |
//! | the model with what was found, back in the simulator | [`extended`], [`resimulation`] |
//! | what it rests on, row by row | [`evidence`] |

pub mod acceptance;
pub mod accounted;
pub mod all_logs;
pub mod answer;
pub mod arm;
pub mod beside;
pub mod bodies;
pub mod candidates;
pub mod column;
pub mod conclusion;
pub mod contest;
pub mod cross_validation;
pub mod cut_off;
pub mod cutoffs;
pub mod derived;
pub mod disagreement;
pub mod eligible;
pub mod equations;
pub mod errors_of_motion;
pub mod evidence;
pub mod extended;
pub mod found;
pub mod gap;
pub mod generic;
pub mod grid;
pub mod harmonics;
pub mod held_out;
pub mod impacts;
pub mod inertias;
pub mod innovations;
pub mod judging;
pub mod known;
pub mod log;
pub mod low_pass;
pub mod multiplicity;
mod noise_spectrum;
pub mod opening;
pub mod passband;
pub mod play;
pub mod preparation;
pub mod renaming;
pub mod residual_structure;
pub mod resimulation;
pub mod roles;
pub mod round;
pub mod rows;
pub mod scan;
pub mod score;
pub mod screening;
pub mod selection;
pub mod session;
pub mod side;
pub mod sign_width;
pub mod smoothing;
pub mod solution;
pub mod stretches;
pub mod structure;
pub mod unexplained;
pub mod verdict;
pub mod whitening;

pub use answer::Diagnosis;
pub use conclusion::{Conclusion, Input, conclude, diagnose, held_out};
pub use verdict::Verdict;

use crate::identification::effect_model::Trust;

/// What to look for, and how surely.
#[derive(Debug, Clone)]
pub struct Options {
    /// Which inertias are believed.
    pub trust: Trust,
    /// Probability of naming anything where there is nothing.
    pub alpha: f64,
    /// Most effects that are named.
    pub max_findings: usize,
    /// Seed of the draws behind the level.
    pub seed: u64,
    /// Names of the effects to look for; all where empty.
    pub candidates: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Options { trust: Trust::Structure, alpha: 0.05, max_findings: 12, seed: 0, candidates: Vec::new() }
    }
}
