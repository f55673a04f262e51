//! Thresholds of the verdict on findings, once all are known.

use serde::Serialize;

/// Thresholds that decide which findings stay named, and whether the description as a whole is what is wrong.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Criteria, VerdictCriteria};
///
/// // Call the inertias of a description wrong as a whole already beyond one wrong body.
/// let verdict = VerdictCriteria { wrong_bodies: 1, ..VerdictCriteria::default() };
/// let criteria = Criteria { verdict, ..Criteria::default() };
/// assert!(criteria.verdict.wrong_bodies < Criteria::default().verdict.wrong_bodies);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VerdictCriteria {
    /// Share of a joint's excess over the noise, in squares, that must be explained for the findings on it to stay where structure is
    /// unexplained with certainty.
    pub explained: f64,
    /// The same where as much as the noise itself is unexplained: a finding that only comes near the law leaves a tenth of a strong one.
    pub explained_above_noise: f64,
    /// Wrong bodies beyond which it is simpler to call the inertias of the description wrong as a whole.
    pub wrong_bodies: usize,
    /// Joints with unexplained structure that is certain beyond which trusted inertias are doubted.
    pub doubtful_joints: usize,
    /// Least share of the whitened sum of squares that re-identified inertias must gain, as a lower bound, to be called wrong.
    pub inertias_gain: f64,
    /// Size of a delay or lag, over the noise of every joint, up to which it is one of the sampling.
    pub sampling_size: f64,
    /// Factor on the residual of re-identified parameters from which the description is reported to be off.
    pub misdescribed: f64,
}

impl Default for VerdictCriteria {
    fn default() -> Self {
        VerdictCriteria {
            explained: 0.7,
            explained_above_noise: 0.9,
            wrong_bodies: 2,
            doubtful_joints: 1,
            inertias_gain: 0.1,
            sampling_size: 1.0,
            misdescribed: 3.0,
        }
    }
}
