//! A sliding axis that is slow in m/s: its friction is found, in its own units.

use std::f64::consts::TAU;
use tauscope::channels::Channels;
use tauscope::effects::{Placed, find};
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Fitted, Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::identification::reversals::Band;
use tauscope::quality::{Kind, examine};
use tauscope::recording::Recording;
use tauscope::recording::lenient::Sieved;
use tauscope::report::fit::{self as report, Found};
use tauscope::robot::{self, InertiaCheck, Robot};

const MASS: f64 = 40.0;
const VISCOUS: f64 = 900.0;
const COULOMB: f64 = 15.0;
const OFFSET: f64 = -4.0;
const RATE: f64 = 500.0;

/// A carriage on a horizontal rail.
fn carriage() -> Robot {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("carriage.urdf");
    let urdf = "<robot name=\"carriage\"><link name=\"rail\"/><link name=\"carriage\"><inertial><mass value=\"1\"/>\
                <inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>\
                <joint name=\"slide\" type=\"prismatic\"><parent link=\"rail\"/><child link=\"carriage\"/>\
                <axis xyz=\"1 0 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"1000\" velocity=\"2\"/></joint></robot>";
    std::fs::write(&path, urdf).unwrap();
    robot::load(&path, InertiaCheck::Ignored).unwrap()
}

/// Forty seconds at up to 0.012 m/s, positions in steps of a micrometre.
fn slow_log() -> Recording {
    let samples = (40.0 * RATE) as usize;
    let time: Vec<f64> = (0..samples).map(|k| k as f64 / RATE).collect();
    let parts = [(0.2, 0.006, 0.3), (0.31, 0.002, 1.1), (1.7, 0.0002, 0.0)];
    let sum = |t: f64, order: i32| -> f64 {
        let of = |&(hz, size, phase): &(f64, f64, f64)| {
            let turn = TAU * hz * t + phase;
            let rate: f64 = TAU * hz;
            size * rate.powi(order) * [turn.sin(), turn.cos(), -turn.sin()][order as usize]
        };
        parts.iter().map(of).sum()
    };
    let torque = |&t: &f64| MASS * sum(t, 2) + VISCOUS * sum(t, 1) + COULOMB * sum(t, 1).signum() + OFFSET;
    Recording {
        joints: vec!["slide".into()],
        q: Channels::from_vectors(&[time.iter().map(|&t| (sum(t, 0) * 1e6).round() * 1e-6).collect()]),
        tau: Channels::from_vectors(&[time.iter().map(torque).collect()]),
        time,
        ..Recording::default()
    }
}

fn fitted(band: Band) -> Fitted {
    let (robot, log) = (carriage(), slow_log());
    let smoothing = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
    let placed = vec![Placed::typical(find("torque_offset").unwrap(), 0)];
    let preparation = Preparation { smoothing, band };
    fit_effects(&Model::new(&robot), Trust::Structure, Logs { train: &[&log], test: &[] }, preparation, placed).unwrap()
}

#[test]
fn friction_of_a_slow_axis_is_found_from_all_of_its_motion() {
    let found = fitted(Band::OfNoise).fit;
    // Base parameters m1, Fv1, Fc1 and the offset.
    assert_eq!(found.arm_units, ["kg", "N s/m", "N"]);
    for (value, truth) in found.estimate.beta.iter().zip([MASS, VISCOUS, COULOMB, OFFSET]) {
        assert!((value / truth - 1.0).abs() < 0.015, "{:?}", found.estimate.beta);
    }
    let fitted = fitted(Band::OfNoise);
    let printed = report::tables(
        &carriage(),
        Found { plain: &fitted, extended: Some(&fitted), consistent: None, torque_is_scaled: false },
    );
    assert!(printed.contains("residual rms, N ") && !printed.contains("N m"), "{printed}");
    let all = slow_log().samples() / 5;
    assert!(found.estimate.rows[0] > all * 9 / 10, "{} of {all}", found.estimate.rows[0]);
}

/// It moves by 16 mm at up to 12 mm/s, which would be a rest in rad; a tenth of that is a held axis that the others move.
#[test]
fn a_slow_axis_is_known_to_move_and_a_held_one_to_stand() {
    let kinds = |factor: f64| -> Vec<Kind> {
        let mut recording = slow_log();
        recording.q.as_mut_slice().iter_mut().for_each(|q| *q *= factor);
        let lines = (1..=recording.samples()).collect();
        let sieved = Sieved { recording, lines, ..Sieved::default() };
        let report = examine(&sieved, Some(&carriage())).unwrap();
        report.findings.into_iter().map(|finding| finding.kind).collect()
    };
    let moves = kinds(1.0);
    assert!(!moves.contains(&Kind::NoMotion) && !moves.contains(&Kind::HardlyMoves), "{moves:?}");
    assert_eq!(kinds(0.1), [Kind::NoMotion]);
}

/// A band that suits arms in rad/s leaves nothing of it.
#[test]
fn a_given_band_is_kept() {
    let (robot, log) = (carriage(), slow_log());
    let smoothing = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
    let preparation = Preparation { smoothing, band: Band::Given(0.03) };
    let logs = Logs { train: &[&log], test: &[] };
    let refused = fit_effects(&Model::new(&robot), Trust::Structure, logs, preparation, Vec::new());
    let problem = refused.unwrap_err().to_string();
    assert!(problem.starts_with("slide: 0 usable samples"), "{problem}");
}
