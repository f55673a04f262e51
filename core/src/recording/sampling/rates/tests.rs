//! Logs of two sources, from the file to the recording.

use crate::recording::lenient::{ColumnMap, Sieved, load};

const COUNT: usize = 4000;

fn angle(t: f64, joint: usize) -> f64 {
    (1.0 + 0.3 * joint as f64) * (2.0 * t + joint as f64).sin()
}

fn torque(t: f64, joint: usize) -> f64 {
    5.0 * (3.0 * t + joint as f64).cos()
}

/// A log of two joints at 500 Hz; `cells` makes a row from time, positions and torques.
fn read(cells: &dyn Fn(usize, f64, [f64; 2], [f64; 2]) -> Vec<String>) -> Sieved {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let mut text = "t,q1,q2,tau1,tau2\n".to_owned();
    for row in 0..COUNT {
        let t = 0.002 * row as f64;
        for line in cells(row, t, [0, 1].map(|joint| angle(t, joint)), [0, 1].map(|joint| torque(t, joint))) {
            text += &(line + "\n");
        }
    }
    std::fs::write(&path, text).unwrap();
    load(&path, None, &ColumnMap::default()).unwrap()
}

#[track_caller]
fn assert_read(sieved: &Sieved, rate: f64, words: &[&str]) {
    let log = &sieved.recording;
    assert!((log.rate_hz() / rate - 1.0).abs() < 0.01, "{}", log.rate_hz());
    assert!((log.duration() - 8.0).abs() < 0.05 && sieved.rejected.len() < 10, "{:?}", sieved.rejected);
    for (row, &t) in log.time.iter().enumerate() {
        for joint in 0..2 {
            assert!((log.q.channel(joint)[row] - angle(t, joint)).abs() < 1e-5, "{t}");
            assert!((log.tau.channel(joint)[row] - torque(t, joint)).abs() < 1e-9, "{t}");
        }
    }
    let said = sieved.corrections.join("; ");
    assert!(words.iter().all(|word| said.contains(word)), "{said}");
}

#[test]
fn torques_in_every_fourth_row() {
    let blank = read(&|row, t, q, tau| {
        let torques = if row % 4 == 1 { format!("{},{}", tau[0], tau[1]) } else { ",".into() };
        vec![format!("{t},{},{},{torques}", q[0], q[1])]
    });
    assert_read(&blank, 125.0, &["4000 hold positions and 1000 torques", "rows of the torques"]);
    let repeated = read(&|row, t, q, _| {
        // The last new one came in the row before this that is one more than a multiple of four.
        let then = 0.002 * row.saturating_sub((row + 3) % 4) as f64;
        vec![format!("{t},{},{},{},{}", q[0], q[1], torque(then, 0), torque(then, 1))]
    });
    assert!(repeated.corrections.iter().any(|note| note.contains("change at 125.0 Hz")), "{:?}", repeated.corrections);
    assert!((repeated.recording.rate_hz() - 125.0).abs() < 0.1);
    let late = |row: usize| (repeated.recording.tau.channel(0)[row] - torque(repeated.recording.time[row], 0)).abs();
    assert!((10..900).all(|row| late(row) < 1e-9));
}

#[test]
fn rows_of_two_publishers() {
    // Torques 1 ms behind every fourth position.
    let alternating = read(&|row, t, q, _| {
        let mut lines = vec![format!("{t},{},{},,", q[0], q[1])];
        if row % 4 == 0 {
            let t = t + 0.001;
            lines.push(format!("{t},,,{},{}", torque(t, 0), torque(t, 1)));
        }
        lines
    });
    assert_read(&alternating, 125.0, &["4000 hold positions and 1000 torques", "two sources"]);
    let slow_positions = read(&|row, t, q, tau| {
        let mut lines = vec![format!("{t},,,{},{}", tau[0], tau[1])];
        if row % 2 == 0 {
            lines.push(format!("{t},{},{},,", q[0], q[1]));
        }
        lines
    });
    assert_read(&slow_positions, 250.0, &["rows of the positions"]);
    // A gripper in rows of its own.
    let gripper = read(&|_, t, q, tau| {
        vec![format!("{t},{},{},{},{}", q[0], q[1], tau[0], tau[1]), format!("{},,,,", t + 0.0013)]
    });
    assert_read(&gripper, 500.0, &["4000 of 8000 rows hold nothing of these joints"]);
}

#[test]
fn gaps_and_torques_of_few_digits_are_no_rate() {
    let broken = read(&|row, t, q, tau| {
        let torques = if (1000..1600).contains(&row) { ",".into() } else { format!("{},{}", tau[0], tau[1]) };
        vec![format!("{t},{},{},{torques}", q[0], q[1])]
    });
    assert_eq!((broken.rejected.len(), broken.recording.samples()), (600, 3400));
    let coarse = read(&|_, t, q, tau| vec![format!("{t},{},{},{:.1},{:.1}", q[0], q[1], tau[0], tau[1])]);
    assert_eq!((coarse.recording.samples(), coarse.corrections.len()), (COUNT, 0), "{:?}", coarse.corrections);
    // A constant speed changes a coarse position at even steps.
    let ramp = read(&|row, t, _, tau| {
        let position = 0.01 * (row as f64 / 2.67).floor();
        vec![format!("{t},{position:.2},{:.2},{},{}", 2.0 * position, tau[0], tau[1])]
    });
    assert_eq!((ramp.recording.samples(), ramp.corrections.len()), (COUNT, 0), "{:?}", ramp.corrections);
}
