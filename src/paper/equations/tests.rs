use super::departures::Place;
use super::structure::{random_states, rank_structure, scaled_regressor};
use super::terms::{Factor, terms};
use super::*;
use crate::random;
use rand::RngExt;
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::PI;

const VARIANTS: [(Variant, &str, usize); 3] = [
    (Variant::AsPrinted, "as_printed", 48),
    (Variant::Consistent, "consistent", 44),
    (Variant::EulerLagrange, "euler_lagrange", 44),
];

/// Made by tests/reference/paper78.py from the LaTeX text of the equations.
fn reference() -> Value {
    serde_json::from_str(include_str!("../../../tests/reference/paper78.json")).unwrap()
}

fn six(value: &Value) -> [f64; 6] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

fn numbers(value: &Value) -> Vec<usize> {
    value.as_array().unwrap().iter().map(|v| v.as_u64().unwrap() as usize).collect()
}

fn random_parameters(seed: u64) -> [f64; PARAMETER_COUNT] {
    let mut random = random::stream(seed, "X", 0);
    std::array::from_fn(|_| random.random_range(-1.0..1.0))
}

/// The mass matrix that the accelerations imply for the parameters `x`, in kg m^2.
fn mass_matrix(variant: Variant, theta: &[f64; JOINTS], x: &[f64; PARAMETER_COUNT]) -> [[f64; JOINTS]; JOINTS] {
    let mut mass = [[0.0; JOINTS]; JOINTS];
    for term in terms(variant) {
        let value = x[term.parameter - 1];
        match term.factor {
            Factor::Acceleration(j) => mass[term.row][j] += value,
            Factor::AccelerationCosine(j) => mass[term.row][j] += value * (theta[term.row] - theta[j]).cos(),
            _ => {}
        }
    }
    mass
}

/// The groups read off the equations: parameters that stand in the same places with the same factors.
fn groups_in_print(variant: Variant) -> Vec<Vec<usize>> {
    let mut places = vec![Vec::new(); PARAMETER_COUNT];
    for term in terms(variant) {
        places[term.parameter - 1].push((term.row, term.factor));
    }
    let mut groups: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (k, mut place) in places.into_iter().enumerate() {
        place.sort_unstable();
        groups.entry(place).or_default().push(k + 1);
    }
    let mut groups: Vec<_> = groups.into_values().collect();
    groups.sort_unstable();
    groups
}

fn torque(variant: Variant, state: &structure::State, x: &[f64; PARAMETER_COUNT]) -> [f64; 6] {
    regressor(variant, &state[0], &state[1], &state[2]).map(|row| row.iter().zip(x).map(|(y, x)| y * x).sum())
}

#[test]
fn the_regressor_is_that_of_the_latex_text() {
    let reference = reference();
    let state = &reference["state"];
    for (variant, name, _) in VARIANTS {
        let mut expected = [[0.0; 78]; 6];
        for entry in reference[name]["entries"].as_array().unwrap() {
            let (i, k) = (entry[0].as_u64().unwrap() as usize, entry[1].as_u64().unwrap() as usize);
            expected[i - 1][k - 1] = entry[2].as_f64().unwrap();
        }
        let found = regressor(variant, &six(&state[0]), &six(&state[1]), &six(&state[2]));
        for i in 0..6 {
            for k in 0..78 {
                let difference = (found[i][k] - expected[i][k]).abs();
                assert!(difference < 1e-12, "{name} ({}) X{}: {} not {}", i + 4, k + 1, found[i][k], expected[i][k]);
            }
        }
    }
}

#[test]
fn entries_computed_by_hand() {
    // theta1 - theta2 = pi/6, theta4 - theta5 = pi/2, the rest far apart; cos(pi/6) = 0.8660254037844386.
    let theta = [PI / 6.0, 0.0, 0.0, PI / 2.0, 0.0, 0.0];
    let dtheta = [2.0, -3.0, 0.0, 5.0, 7.0, 0.0];
    let ddtheta = [1.0, 10.0, 100.0, 0.0, 0.0, 0.0];
    let at = |variant, row: usize, k: usize| regressor(variant, &theta, &dtheta, &ddtheta)[row - 1][k - 1];
    let cosine = 3f64.sqrt() / 2.0;
    use Variant::*;
    for (variant, row, k, expected) in [
        (AsPrinted, 1, 1, 1.0),
        (AsPrinted, 1, 7, 10.0),
        // theta2'' cos + sin (theta2'^2 - theta1' theta2') = 10 cos + 0.5 (9 + 6)
        (AsPrinted, 1, 8, 10.0 * cosine + 7.5),
        // outside the cosine in print
        (AsPrinted, 1, 12, 10.0 + 7.5),
        (Consistent, 1, 12, 10.0 * cosine + 7.5),
        // sin theta2'^2 = 0.5 * 9
        (EulerLagrange, 1, 12, 10.0 * cosine + 4.5),
        // theta1'' cos + the sine term of (4) as printed; corrected 0.5 (-6 - 4); Euler-Lagrange -0.5 * 4
        (AsPrinted, 2, 8, cosine + 7.5),
        (Consistent, 2, 8, cosine - 5.0),
        (EulerLagrange, 2, 8, cosine - 2.0),
        (AsPrinted, 1, 27, 9.81 * cosine),
        (AsPrinted, 1, 28, 1.0),
        (AsPrinted, 2, 46, -1.0),
        (AsPrinted, 3, 59, 0.0),
        (AsPrinted, 2, 47, -3.0),
        // theta1'' + theta2'' + theta3''
        (AsPrinted, 3, 18, 111.0),
        (AsPrinted, 3, 13, 0.0),
        (Consistent, 3, 13, 111.0),
        (Consistent, 3, 18, 0.0),
        // sin(theta4 - theta5) = 1: 35 + 49 in print, 49 - 35 corrected, 49 Euler-Lagrange
        (AsPrinted, 4, 64, 84.0),
        (Consistent, 4, 64, 14.0),
        (EulerLagrange, 4, 64, 49.0),
        // 35 - 25
        (AsPrinted, 5, 64, 10.0),
        (AsPrinted, 5, 65, 0.0),
        (AsPrinted, 5, 66, 10.0),
        (Consistent, 5, 65, 10.0),
        (EulerLagrange, 5, 65, -25.0),
        // theta3'' cos(0)
        (AsPrinted, 5, 57, 100.0),
        (Consistent, 5, 57, 0.0),
        (AsPrinted, 6, 58, 100.0),
        (Consistent, 6, 57, 100.0),
    ] {
        let found = at(variant, row, k);
        assert!((found - expected).abs() < 1e-12, "{variant:?} ({}) X{k}: {found}, not {expected}", row + 3);
    }
}

#[test]
fn the_corrected_mass_matrix_is_symmetric_and_the_printed_one_is_not() {
    let x = random_parameters(1);
    let named: Vec<Vec<usize>> = reference()["asymmetric_as_printed"].as_array().unwrap().iter().map(numbers).collect();
    assert_eq!(named, [[1, 2], [1, 3], [2, 3], [3, 5], [3, 6]]);
    for [theta, ..] in random_states(3, 10) {
        for (variant, ..) in VARIANTS {
            let mass = mass_matrix(variant, &theta, &x);
            for (i, j) in (0..6).flat_map(|i| (0..i).map(move |j| (j, i))) {
                let symmetric = (mass[i][j] - mass[j][i]).abs() < 1e-12;
                let expected = variant != Variant::AsPrinted || !named.contains(&vec![i + 1, j + 1]);
                assert_eq!(symmetric, expected, "{variant:?} M{}{}", i + 1, j + 1);
            }
        }
    }
}

#[test]
fn the_mass_matrix_is_the_change_of_torque_with_acceleration() {
    let x = random_parameters(2);
    for [theta, dtheta, _] in random_states(4, 3) {
        for (variant, ..) in VARIANTS {
            let mass = mass_matrix(variant, &theta, &x);
            let rest = torque(variant, &[theta, dtheta, [0.0; 6]], &x);
            for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
                let unit = std::array::from_fn(|k| f64::from(u8::from(k == j)));
                let moved = torque(variant, &[theta, dtheta, unit], &x);
                assert!((moved[i] - rest[i] - mass[i][j]).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn only_the_euler_lagrange_variant_balances_energy() {
    // Without gravity and friction, theta' tau = d/dt (theta' M theta' / 2), the latter by central difference along
    // theta(t + h) = theta + theta' h + theta'' h^2 / 2.
    let mut x = random_parameters(5);
    for (k, parameter) in tables::PARAMETERS.iter().enumerate() {
        if parameter.unit != "kg m^2" {
            x[k] = 0.0;
        }
    }
    let imbalance = |variant, state: &structure::State| {
        let [theta, dtheta, ddtheta] = state;
        let energy = |h: f64| {
            let at: [f64; 6] = std::array::from_fn(|i| theta[i] + dtheta[i] * h + 0.5 * ddtheta[i] * h * h);
            let v: [f64; 6] = std::array::from_fn(|i| dtheta[i] + ddtheta[i] * h);
            let mass = mass_matrix(variant, &at, &x);
            (0..6).flat_map(|i| (0..6).map(move |j| (i, j))).map(|(i, j)| 0.5 * v[i] * mass[i][j] * v[j]).sum::<f64>()
        };
        let power: f64 = torque(variant, state, &x).iter().zip(dtheta).map(|(tau, v)| tau * v).sum();
        let h = 1e-5;
        (power - (energy(h) - energy(-h)) / (2.0 * h)).abs() / (1.0 + power.abs())
    };
    for state in random_states(6, 10) {
        assert!(imbalance(Variant::EulerLagrange, &state) < 1e-6, "{}", imbalance(Variant::EulerLagrange, &state));
        assert!(imbalance(Variant::Consistent, &state) > 1e-3);
        assert!(imbalance(Variant::AsPrinted, &state) > 1e-3);
    }
}

#[test]
fn rank_and_groups_are_those_of_the_reference_and_of_the_equations() {
    let reference = reference();
    for (variant, name, rank) in VARIANTS {
        let states = random_states(8, 60);
        let found = rank_structure(variant, &states).unwrap();
        assert_eq!(found.rank, rank, "{name}");
        assert_eq!(reference[name]["rank"], rank);
        assert_eq!(found.null_dimension, 78 - rank);
        let mut singular_values = scaled_regressor(variant, &states).singular_values().as_slice().to_vec();
        singular_values.sort_by(|a, b| b.total_cmp(a));
        let gap = singular_values[rank - 1] / singular_values[rank];
        assert!(gap > 1e12, "{name}: the singular values must fall off clearly, gap {gap:e}");
        let groups: Vec<Vec<usize>> = reference[name]["groups"].as_array().unwrap().iter().map(numbers).collect();
        assert_eq!(found.groups, groups, "{name}");
        assert_eq!(groups_in_print(variant), groups, "{name}");
        assert!(groups.contains(&vec![1, 2, 3, 4, 5, 6]));
    }
}

#[test]
fn a_motion_of_one_joint_determines_less() {
    let states: Vec<_> =
        random_states(9, 40).into_iter().map(|state| state.map(|v| [v[0], 0.0, 0.0, 0.0, 0.0, 0.0])).collect();
    let found = rank_structure(Variant::Consistent, &states).unwrap();
    assert!(found.rank < 44);
    assert!(!found.groups.iter().flatten().any(|&k| k == 46), "joint 2 does not move, its friction does not show");
    assert!(rank_structure(Variant::Consistent, &states[..12]).unwrap_err().to_string().contains("12 states"));
}

#[test]
fn departures_name_their_equation_and_the_variants_that_make_them() {
    for departure in DEPARTURES {
        let follows = !departure.variants.contains(&Variant::AsPrinted);
        match &departure.place {
            Place::Inertia { row, .. } | Place::Velocity { row, .. } => {
                assert!(follows, "{}", departure.equation);
                assert!(departure.equation.starts_with(&format!("({})", row + 3)), "{}", departure.equation);
            }
            Place::Elsewhere => assert!(!follows || departure.variants == [Variant::EulerLagrange]),
        }
        assert_ne!(departure.printed, departure.used);
    }
}
