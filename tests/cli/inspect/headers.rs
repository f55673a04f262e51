//! Headers of other programs, and the order of rows: what each is read as.

use super::{one_joint, sines};
use crate::{Case, ROOT, assert_done, text};

/// What `inspect` prints of a log.
fn inspected(case: &Case, content: &str, arguments: &[&str]) -> String {
    case.write("log.csv", content);
    let output = case.tauscope(&[&["inspect", "log.csv"], arguments].concat());
    assert_done(&output);
    text(&output.stdout)
}

/// A row of three joints: positions, then torques.
fn of_three(t: f64) -> String {
    let position = |joint: f64| format!("{:.7}", ((2.1 + 0.7 * joint) * t).sin() + 0.3 * ((5.1 + joint) * t).sin());
    let torque = |joint: f64| format!("{:.7}", 3.0 * ((2.1 + 0.7 * joint) * t).cos() + 0.5 * ((1.3 + joint) * t).cos());
    let joints = [0.0, 1.0, 2.0];
    [joints.map(position), joints.map(torque)].concat().join(",")
}

/// The joints under study are those that the columns name, whatever stands around their names.
#[test]
fn joints_of_a_tree_under_names_of_any_pattern() {
    let case = Case::new(&[]);
    let tree = format!("{ROOT}/tests/reference/trees/two_arms.urdf");
    let of = |[position, torque]: [&str; 2]| {
        let names = |pattern: &str| ["left_1", "left_2", "left_3"].map(|joint| pattern.replace('#', joint)).join(",");
        let log = sines(&format!("t,{},{}", names(position), names(torque)), of_three);
        inspected(&case, &log, &["--robot", &tree])
    };
    let plain = of(["#_position", "#_effort"]);
    assert!([" left_1 ", " left_3 "].iter().all(|joint| plain.contains(joint)), "{plain}");
    assert!(!plain.contains("torso_joint  "), "{plain}");
    for pattern in [
        ["msr_pos_#", "msr_trq_#"],
        ["#_pos_msr", "#_trq_msr"],
        ["#.actual.position", "#.actual.effort"],
        ["/joint_states/position/#", "/joint_states/effort/#"],
    ] {
        assert_eq!(of(pattern), plain, "{pattern:?}");
    }
    let behind = of(["my_robot/#/position", "my_robot/#/effort"]);
    let table = |said: &str| said.lines().filter(|line| line.starts_with(" left_")).collect::<Vec<_>>().join("\n");
    assert_eq!(table(&behind), table(&plain));
}

/// Two levels of labels as pandas writes them, with the name of the index in a line of its own, or without.
#[test]
fn labels_of_two_levels() {
    let case = Case::new(&[]);
    let rows = sines("", of_three);
    let rows = rows.trim_start();
    let plain = inspected(&case, &format!("t,q_0,q_1,q_2,tau_0,tau_1,tau_2\n{rows}"), &[]);
    assert!(plain.contains("1000 rows over 3.996 s"), "{plain}");
    for header in [
        "t,q,q,q,tau,tau,tau\n,0,1,2,0,1,2",
        ",q,q,q,tau,tau,tau\n,0,1,2,0,1,2\nt,,,,,,",
        "signal,q,q,q,tau,tau,tau\njoint,0,1,2,0,1,2\nt,,,,,,",
    ] {
        assert_eq!(inspected(&case, &format!("{header}\n{rows}"), &[]), plain, "{header}");
    }
}

/// A table that was sorted by time downwards is the log; a file of two recordings is not.
#[test]
fn rows_in_the_reverse_order_of_time() {
    let case = Case::new(&[]);
    let log = sines("t,q1,tau1", one_joint);
    let mut rows: Vec<&str> = log.lines().skip(1).collect();
    rows.reverse();
    let said = inspected(&case, &format!("t,q1,tau1\n{}", rows.join("\n")), &[]);
    assert!(said.contains("1000 rows over 3.996 s at 250 Hz") && said.contains("0 rows left out"), "{said}");
    assert!(said.contains("time runs backwards") && said.contains("in reverse order"), "{said}");
    assert!(!said.contains("warning") && !said.contains("starts again"), "{said}");
    let later: Vec<String> = log.lines().skip(300).map(str::to_owned).collect();
    case.write("log.csv", &format!("{log}{}\n", later.join("\n")));
    let output = case.tauscope(&["inspect", "log.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("give each recording as a file of its own"), "{}", text(&output.stderr));
}

/// A measurement file of LabVIEW: two headers, one of them a table, tabs, decimal commas and a column of comments.
#[test]
fn a_file_of_labview() {
    let case = Case::new(&[]);
    let rows = sines("", of_three);
    let rows = rows.trim_start();
    let plain = inspected(&case, &format!("t,q1,q2,q3,tau1,tau2,tau3\n{rows}"), &[]);
    let each = |cell: &str| format!("\t{cell}").repeat(6);
    let header = format!(
        "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nDate\t2026/03/05\nTime\t11:59:55,004\n\
         ***End_of_Header***\t\n\t\nChannels\t6\t\nSamples{}\t\nDate{}\t\nTime{}\t\nX_Dimension{}\t\nX0{}\t\nDelta_X{}\t\n\
         ***End_of_Header***\t\t\t\t\t\t\t\nX_Value\tq1\tq2\tq3\ttau1\ttau2\ttau3\tComment\n",
        each("1000"),
        each("2026/03/05"),
        each("11:59:55,004"),
        each("Time"),
        each("0,0E+0"),
        each("0,004")
    );
    let rows: String = rows.lines().map(|row| row.replace(',', "\t").replace('.', ",") + "\t\n").collect();
    let said = inspected(&case, &format!("{header}{rows}"), &[]);
    let table = |said: &str| said.lines().filter(|line| line.starts_with(' ')).collect::<Vec<_>>().join("\n");
    assert!(said.contains("1000 rows over 3.996 s") && !said.contains("warning"), "{said}");
    assert_eq!(table(&said), table(&plain));
}
