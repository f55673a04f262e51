use super::*;
use crate::random;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::RngExt;

const RULES: [(Damping, Scaling); 4] = [
    (Damping::Marquardt { down: 9.0, up: 11.0 }, Scaling::Diagonal),
    (Damping::Marquardt { down: 9.0, up: 11.0 }, Scaling::Identity),
    (Damping::Quadratic, Scaling::Identity),
    (Damping::Nielsen, Scaling::Identity),
];

fn options((damping, scaling): (Damping, Scaling)) -> Options {
    Options { damping, scaling, ..Options::default() }
}

/// A random matrix with singular values from 1 down to 1 / `condition` and columns of scales 10^(-3..3).
fn random_matrix(seed: u64, rows: usize, columns: usize, condition: f64) -> DMatrix<f64> {
    let mut random = random::stream(seed, "matrix", 0);
    let mut uniform = || random.random_range(-1.0..1.0);
    let left = DMatrix::from_fn(rows, columns, |_, _| uniform()).qr().q();
    let right = DMatrix::from_fn(columns, columns, |_, _| uniform()).qr().q();
    let values = DVector::from_fn(columns, |k, _| condition.powf(-(k as f64) / (columns as f64 - 1.0)));
    let scales = DVector::from_fn(columns, |_, _| 10f64.powf(3.0 * uniform()));
    left * DMatrix::from_diagonal(&values) * right.transpose() * DMatrix::from_diagonal(&scales)
}

fn linear(j: &DMatrix<f64>, y: &DVector<f64>, w: &DVector<f64>) -> impl LeastSquaresProblem {
    let (model, jacobian) = (j.clone(), j.clone());
    let predict = move |p: &[f64]| &model * DVector::from_column_slice(p);
    DenseProblem::new(y.clone(), w.clone(), j.ncols(), predict, move |_: &[f64]| jacobian.clone()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]
    #[test]
    fn a_linear_problem_gives_weighted_least_squares(
        seed in 0u64..1_000_000, columns in 2usize..9, log_condition in 0.0..4.0f64
    ) {
        let rows = 40;
        let j = random_matrix(seed, rows, columns, 10f64.powf(log_condition));
        let mut random = random::stream(seed, "values", 0);
        let y = DVector::from_fn(rows, |_, _| random.random_range(-1.0..1.0));
        let w = DVector::from_fn(rows, |_, _| random.random_range(0.1..10.0));
        let root = DMatrix::from_diagonal(&w.map(f64::sqrt));
        let qr = (&root * &j).qr();
        let expected = qr.r().solve_upper_triangular(&qr.q().tr_mul(&(&root * &y))).unwrap();

        let fit = minimize(&mut linear(&j, &y, &w), &vec![0.0; columns], &Options::default()).unwrap();

        prop_assert!(fit.stop.converged(), "{:?}", fit.stop);
        let norms = DVector::from_fn(columns, |k, _| j.column(k).norm());
        let error = (DVector::from_column_slice(&fit.parameters) - &expected).component_mul(&norms).norm();
        let size = expected.component_mul(&norms).norm();
        // Rounding grows with the condition number, which the weights add to.
        prop_assert!(error <= 1e-8 * size, "relative error {:e}", error / size);
    }
}

#[test]
fn every_rule_solves_a_well_scaled_linear_problem_exactly() {
    let j = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0]);
    // Unweighted line through (0,1) (1,3) (2,5) (3,9): slope 2.6, intercept 0.6. The last point without weight: 2, 1.
    let y = DVector::from_column_slice(&[1.0, 3.0, 5.0, 9.0]);
    for rule in RULES {
        for (weight, expected) in [(1.0, [0.6, 2.6]), (0.0, [1.0, 2.0])] {
            let w = DVector::from_column_slice(&[1.0, 1.0, 1.0, weight]);
            let fit = minimize(&mut linear(&j, &y, &w), &[10.0, -10.0], &options(rule)).unwrap();
            assert!(fit.stop.converged(), "{rule:?} {:?}", fit.stop);
            for (found, expected) in fit.parameters.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-10, "{rule:?}: {:?}", fit.parameters);
            }
        }
    }
}

#[test]
fn the_covariance_of_a_mean_is_the_variance_of_the_mean() {
    let j = DMatrix::from_element(4, 1, 1.0);
    let y = DVector::from_column_slice(&[1.0, 2.0, 3.0, 6.0]);
    let fit = minimize(&mut linear(&j, &y, &DVector::from_element(4, 1.0)), &[0.0], &Options::default()).unwrap();
    // Mean 3, squares 4 + 1 + 0 + 9 = 14, variance 14/3, of the mean 14/12.
    assert!((fit.parameters[0] - 3.0).abs() < 1e-12);
    assert!((fit.chi2() - 14.0).abs() < 1e-12);
    assert!((fit.reduced_chi2.unwrap() - 14.0 / 3.0).abs() < 1e-12);
    assert!((fit.covariance.unwrap()[(0, 0)] - 14.0 / 12.0).abs() < 1e-12);
}

/// 100 (y - x^2)^2 + (1 - x)^2, minimum 0 at (1, 1).
fn rosenbrock() -> impl LeastSquaresProblem {
    DenseProblem::new(
        DVector::zeros(2),
        DVector::from_element(2, 1.0),
        2,
        |p: &[f64]| DVector::from_column_slice(&[10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]),
        |p: &[f64]| DMatrix::from_row_slice(2, 2, &[-20.0 * p[0], 10.0, -1.0, 0.0]),
    )
    .unwrap()
}

#[test]
fn rosenbrock_is_solved_by_every_rule() {
    for rule in RULES {
        let fit = minimize(&mut rosenbrock(), &[-1.2, 1.0], &options(rule)).unwrap();
        assert!(fit.stop.converged(), "{rule:?} {:?}", fit.stop);
        assert!(fit.parameters.iter().all(|p| (p - 1.0).abs() < 1e-10), "{rule:?}: {:?}", fit.parameters);
        assert!(fit.chi2_history.windows(2).all(|pair| pair[1] <= pair[0]), "{rule:?}: {:?}", fit.chi2_history);
        assert_eq!(fit.chi2_history.len(), fit.iterations + 1);
        assert_eq!(fit.lambda_history.len(), fit.iterations + 1);
        assert!((fit.chi2_history[0] - 24.2).abs() < 1e-12);
    }
}

#[test]
fn a_wall_holds_rosenbrock_at_its_constrained_minimum() {
    // With y <= 0.25 the minimum on the wall solves d/dx [100 (0.25 - x^2)^2 + (1 - x)^2] = 400 x^3 - 98 x - 2 = 0.
    let x = {
        let mut x: f64 = 0.5;
        for _ in 0..20 {
            x -= (400.0 * x.powi(3) - 98.0 * x - 2.0) / (1200.0 * x * x - 98.0);
        }
        x
    };
    let bounds = Some(Bounds { lower: vec![f64::NEG_INFINITY; 2], upper: vec![f64::INFINITY, 0.25] });
    for rule in RULES {
        let fit =
            minimize(&mut rosenbrock(), &[0.2, 0.1], &Options { bounds: bounds.clone(), ..options(rule) }).unwrap();
        assert!(fit.stop.converged(), "{rule:?} {:?}", fit.stop);
        assert_eq!(fit.parameters[1], 0.25);
        assert!((fit.parameters[0] - x).abs() < 1e-8, "{rule:?}: {:?}", fit.parameters);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]
    #[test]
    fn a_boxed_linear_problem_meets_the_optimality_conditions(seed in 0u64..1_000_000) {
        let j = random_matrix(seed, 30, 5, 30.0);
        let scales = DVector::from_fn(5, |k, _| j.column(k).norm());
        let j = DMatrix::from_fn(30, 5, |i, k| j[(i, k)] / scales[k]);
        let mut random = random::stream(seed, "values", 0);
        let y = DVector::from_fn(30, |_, _| random.random_range(-1.0..1.0));
        let w = DVector::from_element(30, 1.0);
        let bounds = Bounds { lower: vec![-0.3; 5], upper: vec![0.3; 5] };
        let fit = minimize(
            &mut linear(&j, &y, &w), &[0.0; 5], &Options { bounds: Some(bounds), ..Options::default() }
        ).unwrap();
        prop_assert!(fit.stop.converged(), "{:?}", fit.stop);
        let p = DVector::from_column_slice(&fit.parameters);
        let descent = j.tr_mul(&(&y - &j * &p));
        for k in 0..5 {
            prop_assert!(p[k].abs() <= 0.3);
            let optimal = if p[k] == 0.3 { descent[k] >= -1e-9 } else if p[k] == -0.3 { descent[k] <= 1e-9 } else { descent[k].abs() <= 1e-9 };
            prop_assert!(optimal, "parameter {k} at {} with descent {:e}", p[k], descent[k]);
        }
    }
}

#[test]
fn an_exponential_decay_is_recovered_from_exact_data() {
    let t: Vec<f64> = (0..50).map(|i| 0.1 * f64::from(i)).collect();
    let model = |p: &[f64]| DVector::from_fn(50, |i, _| p[0] * (-p[1] * t[i]).exp() + p[2]);
    let jacobian = |p: &[f64]| {
        DMatrix::from_fn(50, 3, |i, k| {
            let decay = (-p[1] * t[i]).exp();
            [decay, -p[0] * t[i] * decay, 1.0][k]
        })
    };
    let truth = [5.0, 1.3, -0.7];
    for rule in RULES {
        let mut problem = DenseProblem::new(model(&truth), DVector::from_element(50, 4.0), 3, model, jacobian).unwrap();
        let fit = minimize(&mut problem, &[1.0, 0.1, 0.0], &options(rule)).unwrap();
        assert!(fit.stop.converged(), "{rule:?} {:?}", fit.stop);
        for (found, truth) in fit.parameters.iter().zip(truth) {
            assert!((found - truth).abs() < 1e-9 * truth.abs(), "{rule:?}: {:?}", fit.parameters);
        }
    }
}

#[test]
fn parameters_that_only_occur_as_a_sum_still_fit_and_have_no_covariance() {
    let j = DMatrix::from_fn(10, 3, |i, k| [1.0, i as f64, i as f64][k]);
    let y = DVector::from_fn(10, |i, _| 2.0 + 3.0 * i as f64 + if i % 2 == 0 { 0.1 } else { -0.1 });
    let w = DVector::from_element(10, 1.0);
    let fit = minimize(&mut linear(&j, &y, &w), &[0.0; 3], &Options::default()).unwrap();
    assert!(fit.stop.converged(), "{:?}", fit.stop);
    assert!(fit.covariance.is_none());
    let reduced = j.columns(0, 2).into_owned();
    let expected = reduced.svd(true, true).solve(&y, 0.0).unwrap();
    assert!((fit.parameters[0] - expected[0]).abs() < 1e-8);
    assert!((fit.parameters[1] + fit.parameters[2] - expected[1]).abs() < 1e-8);
}

#[test]
fn a_step_into_nowhere_is_shortened() {
    // ln p has no value for p <= 0; the first Gauss-Newton step from 20 goes there.
    let mut problem = DenseProblem::new(
        DVector::from_element(1, 0.0),
        DVector::from_element(1, 1.0),
        1,
        |p: &[f64]| DVector::from_element(1, p[0].ln()),
        |p: &[f64]| DMatrix::from_element(1, 1, 1.0 / p[0]),
    )
    .unwrap();
    for rule in RULES {
        let fit = minimize(&mut problem, &[20.0], &options(rule)).unwrap();
        assert!((fit.parameters[0] - 1.0).abs() < 1e-9, "{rule:?}: {fit:?}");
    }
}

#[test]
fn a_wrong_jacobian_is_told_apart_from_convergence() {
    let mut problem = DenseProblem::new(
        DVector::from_element(2, 1.0),
        DVector::from_element(2, 1.0),
        1,
        |p: &[f64]| DVector::from_column_slice(&[p[0], 2.0 * p[0]]),
        |_: &[f64]| DMatrix::from_column_slice(2, 1, &[-1.0, -2.0]),
    )
    .unwrap();
    let fit = minimize(&mut problem, &[0.0], &Options::default()).unwrap();
    assert_eq!(fit.stop, StopReason::Damping);
    assert!(!fit.stop.converged());
}

#[test]
fn errors_name_what_is_wrong() {
    let say = |p: &[f64], bounds: Option<Bounds>| {
        minimize(&mut rosenbrock(), p, &Options { bounds, ..Options::default() }).unwrap_err().to_string()
    };
    assert!(say(&[0.0], None).contains("1 start values for 2 parameters"));
    let walls = Bounds { lower: vec![0.0; 2], upper: vec![1.0; 2] };
    assert!(say(&[0.5, 2.0], Some(walls)).contains("parameter 1: the start 2"));
    assert!(say(&[0.0, f64::NAN], None).contains("parameter 1"));
    assert!(say(&[0.0; 2], Some(Bounds { lower: vec![0.0], upper: vec![1.0; 2] })).contains("1 lower bounds"));

    let values = |n| DVector::from_element(n, 1.0);
    let problem = |weights, parameters, jacobian: fn(&[f64]) -> DMatrix<f64>| {
        DenseProblem::new(values(2), weights, parameters, |p: &[f64]| values(2) * p[0].sqrt(), jacobian)
    };
    let column: fn(&[f64]) -> DMatrix<f64> = |p| DMatrix::from_element(2, 1, 0.5 / p[0].sqrt());
    assert!(problem(values(3), 1, column).err().unwrap().to_string().contains("2 values but 3 weights"));
    assert!(problem(-values(2), 1, column).err().unwrap().to_string().contains("weight 0 is -1"));
    let fit = |p: &[f64]| {
        let mut problem = problem(values(2), p.len(), column).unwrap();
        minimize(&mut problem, p, &Options::default()).unwrap_err().to_string()
    };
    assert!(fit(&[-1.0]).contains("numerical problem"), "{}", fit(&[-1.0]));
    assert!(fit(&[0.0]).contains("derivative by parameter 0"), "{}", fit(&[0.0]));
    assert!(fit(&[1.0, 1.0]).contains("1 Jacobian columns; it must be 2"));
}
