//! Written and read back, and files of other programs.

use super::*;
use crate::recording::samples;
use proptest::prelude::*;

fn text(recording: &Recording) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_table(&mut bytes, &written::table(recording, false).unwrap()).unwrap();
    bytes
}

fn parse(path: &Path, bytes: &[u8], joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
    strictly(path, &Text::new(path, bytes.to_vec())?, joints)
}

fn parse_text(text: &str) -> Result<(Recording, Vec<String>)> {
    parse(Path::new("log.csv"), text.as_bytes(), None)
}

#[test]
fn header_and_shortest_digits() {
    let mut recording = samples::full(1, 2);
    recording.truth = None;
    recording.qdd = None;
    recording.q.channel_mut(0).copy_from_slice(&[-0.0, 0.1]);
    recording.tau.channel_mut(0).copy_from_slice(&[1e300, 5e-324]);
    recording.qd.as_mut().unwrap().channel_mut(0).copy_from_slice(&[0.1 + 0.2, 1.0 / 3.0]);
    let expected = "t,q1,qd1,tau1\n0.0,-0.0,0.30000000000000004,1e300\n0.002,0.1,0.3333333333333333,5e-324\n";
    assert_eq!(String::from_utf8(text(&recording)).unwrap(), expected);
}

#[test]
fn semicolons_tabs_and_decimal_commas() {
    let plain = parse_text("t,q1,tau1\n0.0,1.5,-2e-3\n0.5,2.5,3\n").unwrap().0;
    for text in [
        "t;q1;tau1\n0,0;1,5;-2e-3\n0,5;2,5;3\n",
        "t;q1;tau1\r\n0.0;1.5;-2e-3\r\n0.5;2.5;3\r\n",
        "t\tq1\ttau1\n0,0\t1,5\t-2e-3\n0.5\t2.5\t3\n",
        "\n\n t ; q1 ;TAU1\n0,0;1,5;-0,002\n0,5;2,5;3,0\n",
    ] {
        assert_eq!(parse_text(text).unwrap().0, plain, "{text}");
    }
    for (text, word) in [("t;q1;tau1\n0;1.23,5;2\n", "1.23,5"), ("t;q1;tau1\n0;1,2,3;2\n", "1,2,3")] {
        let error = parse_text(text).unwrap_err().to_string();
        assert!(error.contains("log.csv:2: q1: ") && error.contains(word), "{error}");
    }
    // Points stand between thousands.
    assert_eq!(parse_text("t;q1;tau1\n0;1.234,5;2\n").unwrap().0.q.channel(0), [1234.5]);
    // With commas between the cells, none is a decimal comma.
    assert!(parse_text("t,q1,tau1\n0,1,5,2\n").unwrap_err().to_string().contains("4 cells"));
}

#[test]
fn comments_above_the_header() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    for text in [
        "# controller 7\n# 2024, a, b\nt,q1,tau1\n0,1,2\n1,2,x\n",
        "\u{feff}# by numpy\n# t,q1,tau1\n#\n0,1,2\n",
        "# by numpy\n#\n# t,q1,tau1\n0,1,2\n1,2,x\n",
    ] {
        std::fs::write(&path, text).unwrap();
        let outcome = read(&path, None).map_err(|error| error.to_string());
        match text.starts_with('#') {
            true => assert!(outcome.unwrap_err().contains("log.csv:5: tau1: 'x'"), "{text}"),
            false => assert!(outcome.unwrap_err().contains("missing column"), "{text}"),
        }
    }
    // UTF-16 is read; what is no text is not.
    std::fs::write(&path, [0xFF, 0xFE, b't', 0, b',', 0]).unwrap();
    assert!(read(&path, None).unwrap_err().to_string().contains("missing column"));
    std::fs::write(&path, [7, 0, 0, 0, 9, 9, 0, 0, 1, 2, 3, 0]).unwrap();
    assert!(read(&path, None).unwrap_err().to_string().contains("no text"));
}

#[test]
fn columns_in_their_order() {
    let bytes = text(&samples::full(2, 1));
    let header = "t,q1,q2,qd1,qd2,qdd1,qdd2,tau1,tau2,q1_true,q2_true,qd1_true,qd2_true,qdd1_true,qdd2_true,\
                  tau1_true,tau2_true\n";
    assert!(bytes.starts_with(header.as_bytes()));
}

proptest! {
    #[test]
    fn round_trip_is_bit_for_bit(recording in samples::any_recording()) {
        let (read, notes) = parse(Path::new("log.csv"), &text(&recording), Some(&recording.joints)).unwrap();
        prop_assert_eq!(samples::bits(&read), samples::bits(&recording));
        prop_assert_eq!(&read.joints, &recording.joints);
        prop_assert!(notes.is_empty());
    }

    #[test]
    fn no_input_panics(header in "[tqdau_12,]{0,20}", body in "[0-9,.\n\r\" ne-]{0,40}") {
        let _ = parse_text(&format!("{header}\n{body}"));
        let _ = parse_text(&format!("t,q1,tau1\n{body}"));
    }
}

#[test]
fn logs_of_other_programs() {
    let text = "\u{feff}Time, q_elbow ,state,dq_elbow,\"tau_elbow\"\r\n\r\n 0, 1.5 ,idle,+2,-3e1\r\n.5,2,,3,4\r\n\r\n";
    let (recording, notes) = parse_text(text).unwrap();
    assert_eq!(recording.joints, ["elbow"]);
    assert_eq!(recording.time, [0.0, 0.5]);
    assert_eq!(recording.q.channel(0), [1.5, 2.0]);
    assert_eq!(recording.qd.unwrap().channel(0), [2.0, 3.0]);
    assert_eq!(recording.tau.channel(0), [-30.0, 4.0]);
    assert_eq!(notes, ["columns not used: state"]);
}

#[test]
fn faults_are_named_by_line_and_column() {
    let cases = [
        ("", "log.csv: header: the file is empty"),
        (" \n\n", "log.csv: header: the file is empty"),
        ("t,q1,tau1\n", "log.csv:1: rows: there is no row"),
        ("\n\nt,q1\n0,1\n", "log.csv:3: tau1: missing column"),
        ("t,q1,tau1\n0,1,2\n1,x2,2\n", "log.csv:3: q1: 'x2' is not a number"),
        ("t,q1,tau1\n0,1,2\n\n\n1,2,\n", "log.csv:5: tau1: the cell is empty"),
        ("t,q1,tau1\r\n0,1,2\r\n\r\n1,2,-\r\n", "log.csv:4: tau1: '-' is not a number"),
        ("t,q1,tau1\n0,1,2\n1,2\n", "log.csv:3: column 2: 2 cells where the header names 3 columns"),
        ("t,q1,tau1\n0,1,2,3\n", "log.csv:2: column 3: 4 cells"),
        ("t,q1,tau1\n0,1,2\n1,2,NaN\n", "log.csv:3: tau1: NaN is not a finite number"),
        ("t,q1,tau1\n0,-inf,2\n1,2,NaN\n", "log.csv:2: q1: -inf is not a finite number"),
        ("t,q1,tau1\n0,1e999,2\n", "log.csv:2: q1: inf is not a finite number"),
        ("t,q1,tau1\n0,1,2\n1,1,2\n1,1,2\n", "log.csv:4: t: time must increase, but 1.0 s follows 1.0 s"),
        ("t,q1,tau1\n0,1,2\n\n-1,1,nan\n", "log.csv:4: "),
        ("t,q1,tau1\nnan,1,2\n", "log.csv:2: t: NaN"),
        ("t,q1,tau1\n0,1,2\n1,\"2,3\n2,3,4\n", "log.csv:3: q1: '\"2' has a quote that is not closed"),
    ];
    for (text, expected) in cases {
        let error = parse_text(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text:?}: {error}");
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let recording = samples::full(1, 3);
    assert!(write_table(full, &written::table(&recording, false).unwrap()).is_err());
}

#[test]
fn signals_of_other_shape_are_refused() {
    let mut recording = samples::full(2, 3);
    recording.tau = samples::full(2, 4).tau;
    let error = write(Path::new("unused.csv"), &recording).unwrap_err().to_string();
    assert!(error.starts_with("torque: 2 joints of 4 samples"), "{error}");
}
