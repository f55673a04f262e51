//! Bodies that can exist, from the simulated IRB 1600: identified, written as a URDF and read back.

use nalgebra::DVector;
use std::path::PathBuf;
use tauscope::channels::Channels;
use tauscope::dynamics::{Chain, Motion, inverse_dynamics, mass_matrix};
use tauscope::identification::consistent::consistent;
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::{Smoothing, measured};
use tauscope::robot::{InertiaCheck, load, with_parameters};
use tauscope::scenario::Setup;
use tauscope::simulation::rapier_arm::RapierArm;
use tauscope::study::testbed;

#[test]
fn the_identified_urdf_reproduces_the_identified_torque() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios/short.toml");
    let setup = Setup::load(path, None).unwrap();
    let runs = testbed::record(&setup, &mut |_| {}).unwrap();
    let model = Model::new(&setup.known);
    let smoothing = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
    let preparation = Preparation { smoothing: smoothing.clone(), band: 0.03.into() };
    let (train, test) = ([&runs.training.recording], [&runs.held_out.recording]);
    let logs = Logs { train: &train, test: &test };
    let fitted = fit_effects(&model, Trust::Structure, logs, preparation.clone(), Vec::new()).unwrap();
    let found = consistent(&model, logs, preparation, &fitted).unwrap();
    println!(
        "exact {}, cost {:.3}, train {:.3?} for {:.3?}",
        found.exact, found.cost, found.train_rms, fitted.train_rms
    );
    println!("held out {:.3?} for {:.3?}", found.test_rms, fitted.test_rms);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("identified.urdf");
    std::fs::write(&path, with_parameters(&found.robot(&setup.known)).unwrap()).unwrap();
    let written = load(&path, InertiaCheck::Required).unwrap();

    // Inverse dynamics, friction and rotors of the file against the torque of the base parameters.
    let prepared = measured(&runs.held_out.recording, smoothing, 0.03).unwrap();
    let identified = prepared.predict(&model, &found.beta);
    let Motion { qd, qdd, .. } = &prepared.motion;
    let mut torque = inverse_dynamics(model.chain(), &written.inertial_parameters(), &prepared.motion);
    for (j, joint) in written.joints.iter().enumerate() {
        let drive = joint.drive;
        let largest = identified.channel(j).iter().fold(1.0f64, |m, v| m.max(v.abs()));
        for (i, tau) in torque.channel_mut(j).iter_mut().enumerate() {
            let v = qd.channel(j)[i];
            *tau += drive.armature * qdd.channel(j)[i] + drive.viscous * v + drive.coulomb * v.signum();
            let wanted = identified.channel(j)[i];
            assert!((*tau - wanted).abs() < 1e-9 * largest, "joint {} sample {i}: {tau} {wanted}", j + 1);
        }
    }
    // The same by an engine that shares no line with the identification: under that torque, less friction, rapier's arm
    // accelerates as the motion does. What is missing is told as torque, by the mass matrix.
    let mut arm = RapierArm::new(&written).unwrap();
    let chain = Chain::new(&written);
    for i in (0..prepared.motion.samples()).step_by(20) {
        let at = |table: &Channels| (0..model.dof()).map(|j| table.channel(j)[i]).collect::<Vec<f64>>();
        let (q, v, a) = (at(&prepared.motion.q), at(qd), at(qdd));
        let net: Vec<f64> = at(&identified)
            .iter()
            .zip(&v)
            .zip(&written.joints)
            .map(|((tau, v), joint)| tau - joint.drive.viscous * v - joint.drive.coulomb * v.signum())
            .collect();
        let mut acceleration = vec![0.0; model.dof()];
        arm.forward_dynamics(&q, &v, &net, &mut acceleration);
        let off = DVector::from_iterator(a.len(), acceleration.iter().zip(&a).map(|(own, wanted)| own - wanted));
        let mut mass = mass_matrix(&chain, &written.inertial_parameters(), &q);
        written.joints.iter().enumerate().for_each(|(j, joint)| mass[(j, j)] += joint.drive.armature);
        for (j, missing) in (mass * off).iter().enumerate() {
            let largest = identified.channel(j).iter().fold(1.0f64, |m, v| m.max(v.abs()));
            assert!(missing.abs() < 1e-9 * largest, "joint {} sample {i}: {missing} of {largest}", j + 1);
        }
    }
    // Noise moves the fit off what bodies can be; the way back costs little on motions not seen.
    for (own, plain) in found.test_rms.iter().zip(&fitted.test_rms) {
        assert!(*own < 1.05 * plain, "{own} {plain}");
    }
}
