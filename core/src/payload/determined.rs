//! What an estimate determines: numbers with their standard errors, and words for the rest.

use super::answer::{Quantity, Verdict};
use super::estimate::{Estimate, SIGNIFICANT};
use super::load_columns::SCALE;
use crate::identification::nearest_body;
use crate::robot::{Inertia, PARAMETERS};
use nalgebra::{DMatrix, Matrix3, SMatrix, SVector, Vector3};

/// Largest standard error of a mass, first moment or inertia over its size at which it is a number: three and a third standard
/// errors from zero, beyond chance for ten parameters.
const LARGEST_ERROR: f64 = 0.3;

/// Largest standard error of a coordinate of the centre over the arm's reach: a twentieth, 4 cm on an arm of 0.85 m. A centre
/// that is known no better is a guess.
const OF_THE_REACH: f64 = 0.05;

/// Standard errors of the limit of a load that was not found.
const LIMIT: f64 = 2.0;

/// Standard errors beyond which a negative mass is a load that was taken off.
const TAKEN_OFF: f64 = 1.0 / LARGEST_ERROR;

/// Share of a mass by which the nearest body that can exist may differ from the fit before that is said.
const MOVED: f64 = 0.05;

/// Places of the moments of inertia among the ten parameters.
const MOMENTS: [usize; 3] = [4, 6, 9];

/// About how far the parts of a load are from each other, m, where its inertia says nothing.
const SIZE: f64 = 0.05;

/// Places of a tensor's six numbers xx, xy, yy, xz, yz, zz.
const PLACES: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];

/// Numbers of a load, as far as they are determined.
#[derive(Debug, Clone)]
pub(super) struct Determined {
    pub verdict: Verdict,
    pub mass: Option<Quantity>,
    pub mass_below: Option<f64>,
    pub center: [Option<Quantity>; 3],
    pub inertia: [Option<Quantity>; 6],
    pub first_moment: [Option<Quantity>; 3],
    pub inertia_about_frame: [Option<Quantity>; 6],
    /// Sentences about what is not determined.
    pub words: Vec<String>,
    /// Remarks on the result.
    pub notes: Vec<String>,
    /// Mass before anything is left out.
    pub raw_mass: Option<Quantity>,
    /// Whether the mass is so far below zero that a load was taken off.
    pub taken_off: bool,
    /// Mass, centre, and inertia where it is determined, of the body that can exist.
    pub body: Option<(f64, Vector3<f64>, Option<Matrix3<f64>>)>,
}

impl Determined {
    /// What is determined of a fit that holds what the model of the arm lacks: inertia about the centre, which acts as little as that, is
    /// left out.
    pub(super) fn without_inertia(mut self) -> Determined {
        if self.inertia.iter().any(Option::is_some) {
            self.inertia = [None; 6];
            self.words.push(
                "inertia: in one fit what the model of the arm lacks acts as much as it does; log one motion at one pace before and after".into(),
            );
        }
        self.body = self.body.map(|(mass, center, _)| (mass, center, None));
        self
    }

    /// What is determined of a load that other torque offsets explain as well: its numbers are left out. No load stays none.
    pub(super) fn or_offsets(self) -> Determined {
        if self.verdict == Verdict::NoLoad || self.verdict == Verdict::NoBody {
            return self;
        }
        Determined {
            verdict: Verdict::LoadOrOffsets,
            mass: None,
            center: [None; 3],
            inertia: [None; 6],
            first_moment: [None; 3],
            inertia_about_frame: [None; 6],
            words: vec![
                "all of it: with a free torque offset at every joint no load is left; move the arm through more attitudes".into(),
            ],
            body: None,
            ..self
        }
    }
}

/// What is determined of an estimate on an arm of so long a `reach`, m. `matters` says whether the load's torque is of a size that matters.
pub(super) fn determined(estimate: &Estimate, reach: f64, matters: bool) -> Determined {
    let fitted: [f64; PARAMETERS] = std::array::from_fn(|k| estimate.load[k] * SCALE[k]);
    let covariance =
        SMatrix::<f64, PARAMETERS, PARAMETERS>::from_fn(|i, j| estimate.covariance[(i, j)] * SCALE[i] * SCALE[j]);
    let visible = estimate.visible;
    let plain = SMatrix::<f64, PARAMETERS, PARAMETERS>::from_fn(|i, j| estimate.plain[(i, j)] * SCALE[i] * SCALE[j]);
    let error = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    let raw_mass = visible[0].then(|| Quantity { value: fitted[0], standard_error: error(0) });
    let is_seen = (0..PARAMETERS).any(|k| visible[k] && fitted[k].abs() > SIGNIFICANT * error(k)) && matters;
    let nearest = |values: &[f64; PARAMETERS]| {
        (is_seen && visible[..4].iter().all(|&v| v)).then(|| possible(values, &plain, &visible)).flatten()
    };
    let body = nearest(&fitted);
    let lighter = visible[0] && fitted[0] < -TAKEN_OFF * error(0) && matters;
    // A load that was taken off is a body with the other sign.
    let taken_off = lighter
        && match (body, nearest(&fitted.map(|value| -value))) {
            (Some((_, put_on)), Some((_, taken_off))) => taken_off < put_on,
            _ => true,
        };
    let mut found = Determined {
        verdict: Verdict::MassNotDetermined,
        mass: None,
        mass_below: None,
        center: [None; 3],
        inertia: [None; 6],
        first_moment: [None; 3],
        inertia_about_frame: [None; 6],
        words: Vec::new(),
        notes: Vec::new(),
        raw_mass,
        taken_off,
        body: None,
    };
    if !is_seen || found.taken_off {
        found.verdict = Verdict::NoLoad;
        match raw_mass {
            Some(mass) => found.mass_below = Some(mass.value.max(0.0) + LIMIT * mass.standard_error),
            None => found.words.push(format!("mass: {NO_TORQUE}")),
        }
        return found;
    }
    let moments = || MOMENTS.into_iter().filter(|&k| visible[k]);
    let largest = moments().map(|k| fitted[k]).fold(0.0, f64::max);
    if let Some(k) = moments().find(|&k| fitted[k] < -SIGNIFICANT * error(k) && fitted[k] < -largest) {
        found.verdict = Verdict::NoBody;
        found.words.push(format!(
            "all of it: the torques changed as no body makes them change (a moment of inertia of {:.4} +- {:.4} kg m2); friction, \
             offsets or the arm itself changed, or the load is on another link",
            fitted[k],
            error(k)
        ));
        return found;
    }
    // What a body cannot be is an error of the model; standard errors that know the scatter alone grow by it.
    let misfit = body.map_or(0.0, |(_, cost)| cost * plain[(0, 0)] / covariance[(0, 0)].max(f64::MIN_POSITIVE));
    let inflation = (misfit / PARAMETERS as f64).max(1.0);
    let covariance = covariance * inflation;
    let error = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    let values = body.map_or(fitted, |(body, _)| body.0);
    let heavy = visible[0] && error(0) <= LARGEST_ERROR * values[0];
    if (values[0] - fitted[0]).abs() > MOVED * fitted[0].abs() {
        found.notes.push(format!(
            "no body has the inertia that the torques ask for: given is the nearest that can exist, of {:.3} kg instead of {:.3} kg, with \
             standard errors {:.1} times as large; look at the constants of the torques",
            values[0],
            fitted[0],
            inflation.sqrt()
        ));
    }
    if heavy {
        found.verdict = Verdict::Load;
        found.mass = Some(Quantity { value: values[0], standard_error: error(0) });
    } else if visible[0] {
        found.words.push(format!(
            "mass: the motions do not separate it from the rest (standard error {:.3} kg); move the wrist through more attitudes",
            error(0)
        ));
    } else {
        found.words.push(format!("mass: {NO_TORQUE}"));
    }
    about_frame(&mut found, &values, &visible, error);
    if heavy {
        about_center(&mut found, &values, &covariance, &visible, reach);
    }
    found
}

/// Why a mass is not seen.
const NO_TORQUE: &str = "no torque of these joints depends on it alone";

/// The body that can exist nearest to the fit, the best fit of those that can, with its squared distance; what is not visible is
/// free.
fn possible(
    fitted: &[f64; PARAMETERS],
    covariance: &SMatrix<f64, PARAMETERS, PARAMETERS>,
    visible: &[bool; PARAMETERS],
) -> Option<(Inertia, f64)> {
    let mass = fitted[0].abs();
    let free = [mass, mass * SIZE, mass * SIZE, mass * SIZE].into_iter().chain([mass * SIZE * SIZE; 6]);
    let free: Vec<f64> = free.collect();
    // In units of the standard errors, so that the inverse is of correlations.
    let error: Vec<f64> =
        (0..PARAMETERS).map(|k| if visible[k] { covariance[(k, k)].sqrt() } else { 10.0 * free[k] }).collect();
    if error.iter().any(|e| !(e.is_finite() && *e > 0.0)) {
        return None;
    }
    let both = |i: usize, j: usize| visible[i] && visible[j];
    let correlation = DMatrix::from_fn(PARAMETERS, PARAMETERS, |i, j| match i == j {
        // A little of the identity keeps few blocks from making it singular.
        true => 1.0 + 1e-6,
        false if both(i, j) => covariance[(i, j)] / (error[i] * error[j]),
        false => 0.0,
    });
    let inverse = correlation.cholesky()?.inverse();
    let normal = DMatrix::from_fn(PARAMETERS, PARAMETERS, |i, j| inverse[(i, j)] / (error[i] * error[j]));
    nearest_body(&normal, fitted, SIZE)
}

/// First moments and inertias about the frame, each where it is known to a part of the largest.
fn about_frame(
    found: &mut Determined,
    values: &[f64; PARAMETERS],
    visible: &[bool; PARAMETERS],
    error: impl Fn(usize) -> f64,
) {
    let largest =
        |places: std::ops::Range<usize>| places.filter(|&k| visible[k]).map(|k| values[k].abs()).fold(0.0, f64::max);
    let quantity = |k: usize, size: f64| {
        let quantity = Quantity { value: values[k], standard_error: error(k) };
        (visible[k] && quantity.standard_error <= LARGEST_ERROR * size).then_some(quantity)
    };
    let (first, second) = (largest(1..4), largest(4..PARAMETERS));
    found.first_moment = std::array::from_fn(|axis| quantity(1 + axis, first));
    found.inertia_about_frame = std::array::from_fn(|k| quantity(4 + k, second));
}

/// Centre and inertia about it, of a load whose mass is determined.
fn about_center(
    found: &mut Determined,
    values: &[f64; PARAMETERS],
    covariance: &SMatrix<f64, PARAMETERS, PARAMETERS>,
    visible: &[bool; PARAMETERS],
    reach: f64,
) {
    let body = Inertia(*values);
    let (mass, center) = (body.mass(), body.center_of_mass());
    let deviation = |slope: &SVector<f64, PARAMETERS>| (slope.transpose() * covariance * slope)[0].max(0.0).sqrt();
    for axis in 0..3 {
        // c = h / m.
        let mut slope = SVector::zeros();
        slope[0] = -center[axis] / mass;
        slope[1 + axis] = 1.0 / mass;
        let standard_error = deviation(&slope);
        let name = ["x", "y", "z"][axis];
        if !visible[1 + axis] {
            found.words.push(format!("centre along {name}: {NO_TORQUE}"));
        } else if standard_error > OF_THE_REACH * reach {
            found.words.push(format!(
                "centre along {name}: its standard error is {standard_error:.3} m, more than a twentieth of the arm's reach"
            ));
        } else {
            found.center[axis] = Some(Quantity { value: center[axis], standard_error });
        }
    }
    let whole = visible.iter().all(|&v| v);
    let tensor = body.tensor_about_center();
    let size = tensor.symmetric_eigenvalues().max();
    let first = body.first_moment();
    let deviations: [f64; 6] = std::array::from_fn(|place| {
        // I about the centre = I - (h'h 1 - h h') / m.
        let (i, j) = PLACES[place];
        let delta = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
        let mut slope = SVector::<f64, PARAMETERS>::zeros();
        slope[0] = (first.norm_squared() * delta(i, j) - first[i] * first[j]) / (mass * mass);
        for k in 0..3 {
            let part = 2.0 * first[k] * delta(i, j) - delta(i, k) * first[j] - first[i] * delta(j, k);
            slope[1 + k] = -part / mass;
        }
        slope[4 + place] = 1.0;
        deviation(&slope)
    });
    for (place, name) in ["xx", "xy", "yy", "xz", "yz", "zz"].into_iter().enumerate() {
        let standard_error = deviations[place];
        if whole && standard_error <= LARGEST_ERROR * size {
            found.inertia[place] = Some(Quantity { value: tensor[PLACES[place]], standard_error });
        } else if !visible[4 + place] {
            found.words.push(format!("inertia {name}: {NO_TORQUE}"));
        }
    }
    if found.inertia.iter().any(Option::is_none) && whole {
        let missing: Vec<&str> = ["xx", "xy", "yy", "xz", "yz", "zz"]
            .into_iter()
            .zip(&found.inertia)
            .filter_map(|(name, value)| value.is_none().then_some(name))
            .collect();
        let largest = deviations.iter().copied().fold(0.0, f64::max);
        found.words.push(format!(
            "inertia {}: too small for these motions, which see it to {largest:.2e} kg m2; move the wrist faster",
            missing.join(", ")
        ));
    }
    if found.center.iter().all(Option::is_some) {
        let inertia = found.inertia.iter().all(Option::is_some).then_some(tensor);
        found.body = Some((mass, center, inertia));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    fn diagonal(errors: [f64; PARAMETERS]) -> DMatrix<f64> {
        DMatrix::from_fn(PARAMETERS, PARAMETERS, |i, j| if i == j { (errors[i] / SCALE[i]).powi(2) } else { 0.0 })
    }

    /// An estimate of a body with these standard errors.
    fn estimate(body: &Inertia, errors: [f64; PARAMETERS], visible: [bool; PARAMETERS]) -> Estimate {
        Estimate {
            load: DVector::from_fn(PARAMETERS, |k, _| body.0[k] / SCALE[k]),
            covariance: diagonal(errors),
            plain: diagonal(errors),
            visible,
            changes: Vec::new(),
            beta: DVector::zeros(PARAMETERS),
            blocks: 20,
        }
    }

    fn brick() -> Inertia {
        Inertia::from_center_of_mass(
            2.0,
            Vector3::new(0.02, 0.0, 0.1),
            Matrix3::from_diagonal(&Vector3::new(0.01, 0.012, 0.006)),
        )
    }

    const EXACT: [f64; PARAMETERS] = [1e-3, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4];

    #[test]
    fn a_well_seen_load_has_all_its_numbers() {
        let found = determined(&estimate(&brick(), EXACT, [true; PARAMETERS]), 1.0, true);
        assert_eq!(found.verdict, Verdict::Load);
        assert!(found.words.is_empty(), "{:?}", found.words);
        assert!((found.center[2].unwrap().value - 0.1).abs() < 1e-12);
        // c = h / m: sqrt(1e-4^2 + (0.1 * 1e-3)^2) / 2.
        assert!((found.center[2].unwrap().standard_error - 0.5e-4 * 2f64.sqrt()).abs() < 1e-9);
        assert!((found.inertia[0].unwrap().value - 0.01).abs() < 1e-12);
        assert!(found.body.unwrap().2.is_some());
    }

    #[test]
    fn a_mass_is_a_number_up_to_its_largest_error() {
        for (error, is_number) in [(0.59, true), (0.61, false)] {
            let mut errors = EXACT;
            errors[0] = error;
            let found = determined(&estimate(&brick(), errors, [true; PARAMETERS]), 1.0, true);
            assert_eq!(found.mass.is_some(), is_number, "{error}");
            assert_eq!(found.verdict == Verdict::Load, is_number);
            assert_eq!(found.words.iter().any(|word| word.starts_with("mass")), !is_number);
        }
    }

    #[test]
    fn a_centre_is_a_number_up_to_a_twentieth_of_the_reach() {
        for (error, is_number) in [(0.049, true), (0.051, false)] {
            let mut errors = EXACT;
            errors[2] = 2.0 * error;
            let found = determined(&estimate(&brick(), errors, [true; PARAMETERS]), 1.0, true);
            assert_eq!(found.center[1].is_some(), is_number, "{error}");
            assert_eq!(found.body.is_some(), is_number);
        }
    }

    #[test]
    fn an_inertia_is_a_number_up_to_a_part_of_the_largest() {
        // The largest moment is 0.012 kg m2.
        for (error, is_number) in [(0.0035, true), (0.0037, false)] {
            let mut errors = EXACT;
            errors[9] = error;
            let found = determined(&estimate(&brick(), errors, [true; PARAMETERS]), 1.0, true);
            assert_eq!(found.inertia[5].is_some(), is_number, "{error}");
            assert_eq!(found.body.unwrap().2.is_some(), is_number);
        }
    }

    #[test]
    fn no_load_has_a_limit_and_no_numbers() {
        let nothing = Inertia([0.01, 0.001, 0.0, 0.0, 0.001, 0.0, 0.001, 0.0, 0.0, 0.001]);
        let errors = [0.02, 0.002, 0.002, 0.002, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01];
        let found = determined(&estimate(&nothing, errors, [true; PARAMETERS]), 1.0, true);
        assert_eq!((found.verdict, found.mass), (Verdict::NoLoad, None));
        assert!((found.mass_below.unwrap() - 0.05).abs() < 1e-12);
        assert!(found.center.iter().chain(&found.first_moment).all(Option::is_none));
        let small = determined(&estimate(&brick(), EXACT, [true; PARAMETERS]), 1.0, false);
        assert_eq!(small.verdict, Verdict::NoLoad, "a torque that does not matter is no load");
    }

    #[test]
    fn a_load_that_was_taken_off_is_recognised() {
        let lighter = Inertia(brick().0.map(|value| -value));
        assert!(determined(&estimate(&lighter, EXACT, [true; PARAMETERS]), 1.0, true).taken_off);
        let mut errors = EXACT;
        errors[0] = 1.0;
        assert!(!determined(&estimate(&lighter, errors, [true; PARAMETERS]), 1.0, true).taken_off);
    }

    #[test]
    fn what_no_torque_shows_is_left_out() {
        let mut visible = [false; PARAMETERS];
        visible[3] = true;
        visible[9] = true;
        let found = determined(&estimate(&brick(), EXACT, visible), 1.0, true);
        assert_eq!((found.verdict, found.mass), (Verdict::MassNotDetermined, None));
        assert!((found.first_moment[2].unwrap().value - 0.2).abs() < 1e-12 && found.first_moment[0].is_none());
        assert!(found.inertia_about_frame[5].is_some() && found.inertia[5].is_none());
    }

    #[test]
    fn an_impossible_inertia_becomes_a_possible_one() {
        let mut body = brick();
        body.0[9] = -0.005;
        let mut errors = EXACT;
        errors[9] = 0.01;
        let found = determined(&estimate(&body, errors, [true; PARAMETERS]), 1.0, true);
        let (mass, center, inertia) = found.body.unwrap();
        assert!(inertia.is_none() && (mass - 2.0).abs() < 0.01 && (center.z - 0.1).abs() < 0.001);
        assert!(found.inertia[5].is_none() && found.notes.is_empty());
    }
}
