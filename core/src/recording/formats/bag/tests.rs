//! Bags written by other programs (`tests/reference/bags.py`).

use crate::recording::lenient::{self, Cause, ColumnMap};
use crate::recording::samples;
use std::path::{Path, PathBuf};

const SAMPLES: usize = 60;

fn bag(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/reference/bags").join(name)
}

fn arm() -> Vec<String> {
    ["shoulder", "elbow", "wrist"].map(str::to_owned).to_vec()
}

/// Position, velocity and effort of a joint at a sample, as the script has them.
fn truth(sample: usize, joint: usize) -> [f64; 3] {
    let (t, k) = (sample as f64 * 0.01, joint as f64);
    [(3.0 * t + k).sin(), 3.0 * (3.0 * t + k).cos(), 10.0 * k + t]
}

#[track_caller]
fn assert_truth(log: &crate::recording::Recording) {
    for sample in 0..log.samples() {
        assert!((log.time[sample] - 0.01 * sample as f64).abs() < 1e-9, "{}", log.time[sample]);
    }
    assert_true_values(log);
}

/// The same of a log of which parts are missing.
#[track_caller]
fn assert_true_values(log: &crate::recording::Recording) {
    assert_eq!(log.joints, arm());
    let missing = log.provenance["start_unix_ns"].parse::<i64>().unwrap() - 1_700_000_000_123_456_789;
    for sample in 0..log.samples() {
        let number = 100.0 * (log.time[sample] + 1e-9 * missing as f64);
        assert!((number - number.round()).abs() < 1e-6, "{number}");
        for joint in 0..3 {
            let [q, qd, tau] = truth(number.round() as usize, joint);
            assert!((log.q.channel(joint)[sample] - q).abs() < 1e-12);
            assert!((log.tau.channel(joint)[sample] - tau).abs() < 1e-12);
            if let Some(velocity) = &log.qd {
                assert!((velocity.channel(joint)[sample] - qd).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn bags_of_every_kind() {
    let files = [
        "sqlite",
        "sqlite/sqlite.db3",
        "sqlite_messages",
        "sqlite_messages/sqlite_messages.db3",
        "sqlite_file",
        "sqlite_file/sqlite_file.db3.zstd",
        "mcap",
        "mcap/mcap.mcap",
        "mcap_messages",
        "bare.mcap",
    ];
    for file in files {
        let sieved = lenient::load(bag(file), Some(&arm()), &ColumnMap::default()).unwrap();
        assert_eq!((sieved.recording.samples(), sieved.rejected.len()), (SAMPLES, 0), "{file}");
        assert_eq!(sieved.recording.qd.is_some(), file != "bare.mcap", "{file}");
        assert_truth(&sieved.recording);
        assert_eq!(sieved.recording.provenance["topic"], "/joint_states");
        assert_eq!(sieved.recording.provenance["start_unix_ns"], "1700000000123456789");
        assert_eq!(crate::recording::load(bag(file), Some(&arm())).unwrap(), sieved.recording, "{file}");
    }
}

#[test]
fn joints_in_the_messages_own_order_where_no_arm_is_known() {
    let log = crate::recording::load(bag("mcap"), None).unwrap();
    assert_eq!(log.joints, ["wrist", "shoulder", "elbow"]);
    assert!((log.tau.channel(0)[0] - 20.0).abs() < 1e-12);
    let other = ["left".to_owned()];
    let error = crate::recording::load(bag("mcap"), Some(&other)).unwrap_err().to_string();
    assert!(error.contains("left_position") && error.contains("shoulder_position"), "{error}");
}

#[test]
fn a_truncated_log_keeps_what_comes_before() {
    let sieved = lenient::load(bag("truncated.mcap"), Some(&arm()), &ColumnMap::default()).unwrap();
    let count = sieved.recording.samples();
    assert!((20..SAMPLES).contains(&count), "{count}");
    assert_truth(&sieved.recording);
    let cut = &sieved.rejected[0];
    assert_eq!((cut.cause, cut.line), (Cause::CutOff, count + 1));
    assert!(crate::recording::load(bag("truncated.mcap"), None).is_err());
    let whole = std::fs::read(bag("bare.mcap")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for length in (0..whole.len()).step_by(97) {
        let path = folder.path().join("cut.mcap");
        std::fs::write(&path, &whole[..length]).unwrap();
        match lenient::load(&path, Some(&arm()), &ColumnMap::default()) {
            Ok(sieved) => assert!(sieved.rejected.iter().any(|row| row.cause == Cause::CutOff), "{length} bytes"),
            Err(error) => assert!(error.to_string().contains("cut.mcap: "), "{error}"),
        }
    }
}

/// Bytes that were changed in the middle of a file are never taken for a measurement where it has checksums. Two of these have
/// none, as rosbag2 writes them: what they say is then looked at as any log is, and nothing worse happens.
#[test]
fn garbage_in_a_log_is_found_by_its_checksums() {
    use crate::random;
    use rand::RngExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("garbage.mcap");
    for (name, checked) in [("bare.mcap", true), ("mcap/mcap.mcap", false), ("mcap_messages/mcap_messages.mcap", false)]
    {
        let whole = std::fs::read(bag(name)).unwrap();
        let (mut noticed, mut source) = (0, random::stream(5, "garbage", 0));
        for _ in 0..150 {
            let mut bytes = whole.clone();
            let (start, length) = (source.random_range(8..whole.len() - 8), source.random_range(1..200));
            let end = (start + length).min(whole.len() - 8);
            bytes[start..end].iter_mut().for_each(|byte| *byte = source.random());
            std::fs::write(&path, &bytes).unwrap();
            match lenient::load(&path, Some(&arm()), &ColumnMap::default()) {
                Ok(sieved) => {
                    noticed += usize::from(!sieved.rejected.is_empty() || sieved.recording.samples() < SAMPLES);
                    if checked {
                        assert_true_values(&sieved.recording);
                    }
                }
                Err(error) => {
                    noticed += 1;
                    let error = error.to_string();
                    assert!(error.contains("garbage.mcap: ") && error.len() < 400, "{error}");
                }
            }
        }
        assert!(noticed > if checked { 75 } else { 50 }, "{name}: {noticed}");
    }
}

#[test]
fn what_is_written_is_read_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let log = crate::recording::load(bag("mcap"), Some(&arm())).unwrap();
    let parquet = cfg!(feature = "parquet").then_some("a.parquet");
    for name in ["a.mcap", "a.db3"].into_iter().chain(parquet) {
        let path = folder.path().join(name);
        assert!(crate::recording::save(&path, &log).unwrap().is_empty(), "{name}");
        let back = crate::recording::load(&path, Some(&arm())).unwrap();
        assert_eq!(back, log, "{name}");
        assert_eq!(samples::bits(&back), samples::bits(&log), "{name}");
    }

    let mut simulated = samples::full(3, 50);
    // As it stands in a message, to the nanosecond.
    simulated.time = (0..50).map(|k| f64::from(k) * 2_000_000.0 / 1e9).collect();
    simulated.q.channel_mut(0)[..4].copy_from_slice(&[-0.0, 5e-324, f64::MAX, 0.1 + 0.2]);
    for name in ["b.mcap", "b.db3"] {
        let path = folder.path().join(name);
        assert_eq!(crate::recording::save(&path, &simulated).unwrap(), ["accelerations and truth"], "{name}");
        let back = crate::recording::load(&path, Some(&simulated.joints)).unwrap();
        assert_eq!(back.joints, simulated.joints);
        let kept = crate::recording::Recording { qdd: None, truth: None, ..simulated.clone() };
        assert_eq!(samples::bits(&back), samples::bits(&kept), "{name}");
    }
    let mut fast = simulated.clone();
    fast.time[7] = fast.time[6] + 1e-10;
    let error = crate::recording::save(&folder.path().join("c.mcap"), &fast).unwrap_err().to_string();
    assert!(error.contains("whole nanoseconds"), "{error}");
}

#[test]
fn damaged_databases_are_refused_or_cut() {
    let whole = std::fs::read(bag("sqlite/sqlite.db3")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.db3");
    for length in [0, 50, 5000, 20000, whole.len() - 3000] {
        std::fs::write(&path, &whole[..length]).unwrap();
        if let Err(error) = lenient::load(&path, Some(&arm()), &ColumnMap::default()) {
            assert!(error.to_string().contains("cut.db3: "), "{error}");
        }
    }
}

#[test]
fn one_of_several_topics_must_be_chosen() {
    let file = bag("two_topics.mcap");
    let error = lenient::load(&file, Some(&arm()), &ColumnMap::default()).unwrap_err().to_string();
    assert!(error.contains("/left/joint_states, /right/joint_states") && error.contains("[columns] topic"), "{error}");
    let right = ColumnMap { topic: Some("/right/joint_states".into()), ..ColumnMap::default() };
    let sieved = lenient::load(&file, Some(&arm()), &right).unwrap();
    assert_eq!(sieved.recording.samples(), 5);
    assert!(sieved.notes[0].contains("/left/joint_states (5 messages)"), "{:?}", sieved.notes);
    let none = ColumnMap { topic: Some("/middle".into()), ..ColumnMap::default() };
    let error = lenient::load(&file, Some(&arm()), &none).unwrap_err().to_string();
    assert!(
        error.contains("/middle") && error.contains("/left/joint_states (sensor_msgs/msg/JointState, cdr)"),
        "{error}"
    );
}

#[test]
fn other_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["log.mcap", "log.db3"] {
        let path = folder.path().join(name);
        let error = crate::recording::load(&path, None).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
        std::fs::write(&path, "t,q1,tau1\n0,1,2\n").unwrap();
        let error = crate::recording::load(&path, None).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}
