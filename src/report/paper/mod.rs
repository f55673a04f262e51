//! Results of the study of the paper: its tables and figures reproduced, and a verdict.

pub(crate) mod figures;
pub(crate) mod results;
pub(crate) mod tables;
pub(crate) mod verdict;

pub(crate) use results::SCHEMA;
pub(crate) use verdict::Verdict;

use crate::paper::equations;
use crate::paper::planar::PlanarFit;
use crate::paper::{PaperStudy, SpatialFit};
use crate::study::testbed::Variant;

/// The fit of a variant of the 78-parameter model to the raw or the smoothed log.
fn planar(study: &PaperStudy, variant: equations::Variant, signals: Variant) -> &PlanarFit {
    let fits = study.planar.iter().filter(|model| model.variant == variant).flat_map(|model| &model.fits);
    fits.into_iter().find(|fit| fit.signals == signals).expect("the study fits every variant to both")
}

/// The fit of the spatial model to the raw or the smoothed log.
fn spatial(study: &PaperStudy, signals: Variant) -> &SpatialFit {
    study.spatial.iter().find(|fit| fit.signals == signals).expect("the study fits both")
}

/// Entry by entry, `a` over `b`.
fn ratios(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a / b).collect()
}
