//! Logs of motors: their names, their currents besides torques, and motions in files of their own.

use super::{ARM, one_joint, sines};
use crate::{Case, assert_done, text};

/// Two joints behind motors with other names.
const MODEL: &str = r#"<mujoco model="two"><compiler angle="radian"/><worldbody><body name="upper">
<joint name="shoulder" axis="0 1 0" range="-3 3"/><inertial pos="0.3 0 0" mass="2" diaginertia="0.05 0.05 0.05"/>
<body name="lower" pos="0.6 0 0"><joint name="elbow" axis="0 1 0" range="-3 3"/>
<inertial pos="0.2 0 0" mass="1" diaginertia="0.02 0.02 0.02"/></body></body></worldbody>
<actuator><motor name="m1" joint="shoulder" gear="50"/><motor name="m2" joint="elbow" gear="30"/></actuator></mujoco>"#;

/// Positions of two joints, and two other signals.
fn two_joints(t: f64) -> String {
    let signal = |rate: f64| format!("{:.6}", (rate * t).sin() + 0.3 * (2.3 * rate * t).cos());
    [2.1, 2.9, 1.7, 3.7].map(signal).join(",")
}

/// A log of the two joints with these columns, and what an inspection of it says.
fn inspected(columns: &str) -> (Case, String) {
    let case = Case::new(&[]);
    case.write("two.xml", MODEL);
    case.write("log.csv", &sines(columns, two_joints));
    let said = case.tauscope(&["inspect", "log.csv", "--robot", "two.xml"]);
    assert_done(&said);
    let said = text(&said.stdout).to_owned();
    (case, said)
}

#[test]
fn columns_may_be_called_for_the_motors_of_a_model() {
    let (_, said) = inspected("t,qpos_shoulder,qpos_elbow,actuator_force_m1,actuator_force_m2");
    assert!(said.contains("m1 for shoulder and so on") && said.contains("gear_ratio = [50.0, 30.0]"), "{said}");
}

/// A dump of all of a simulator's vectors, with a free body before the arm: seven positions and six velocities are not the arm's.
#[test]
fn vectors_of_a_simulator_with_a_free_body() {
    let case = Case::new(&[]);
    let body = "<body name='box'><freejoint name='box_free'/><geom size='.1'/></body>";
    let model = MODEL.replace("<worldbody>", &format!("<worldbody>{body}"));
    case.write("two.xml", &model);
    let numbered =
        |name: &str, count: usize| (0..count).map(|place| format!("{name}_{place}")).collect::<Vec<_>>().join(",");
    let header = |torque: &str, count: usize| format!("t,{},{}", numbered("qpos", 9), numbered(torque, count));
    let row = |of_motors: bool| {
        move |t: f64| {
            let own = two_joints(t);
            let (q, tau) = own.match_indices(',').nth(1).map(|(at, _)| own.split_at(at)).unwrap();
            let free = if of_motors { String::new() } else { ",0".repeat(6) };
            format!("0.5,0.1,0.02,1,0,0,0,{q}{free}{tau}")
        }
    };
    let said = |header: &str, of_motors: bool, robot: &str| {
        case.write("log.csv", &sines(header, row(of_motors)));
        case.tauscope(&["inspect", "log.csv", "--robot", robot])
    };
    case.write("log.csv", &sines("t,q1,q2,tau1,tau2", two_joints));
    let table = |said: &str| {
        said.lines()
            .filter(|line| line.starts_with(" shoulder") || line.starts_with(" elbow"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let plain = case.tauscope(&["inspect", "log.csv", "--robot", "two.xml"]);
    assert_done(&plain);
    for (header, of_motors) in [(header("qfrc_actuator", 8), false), (header("actuator_force", 2), true)] {
        let output = said(&header, of_motors, "two.xml");
        assert_done(&output);
        let output = text(&output.stdout);
        assert_eq!(table(&output), table(&text(&plain.stdout)), "{header}");
        assert!(output.contains("qpos_7 is that of shoulder"), "{output}");
        assert_eq!(output.contains("gear_ratio = [50.0, 30.0]"), of_motors, "{output}");
    }
    // Without the model it is not known which numbers are the arm's.
    case.write("alone.xml", MODEL);
    let refused = said(&header("actuator_force", 2), true, "alone.xml");
    crate::assert_refusal(&refused, &["qpos_2", "a free one takes 7 places", "give the model"]);
}

#[test]
fn torques_of_some_joints_and_currents_of_others_are_taken_together_as_the_note_tells() {
    let (case, said) = inspected("t,shoulder_position,elbow_position,shoulder_effort,elbow_current");
    let start = said.find("[columns] tau").unwrap_or_else(|| panic!("{said}"));
    let told = said[start..].split(", with 1 where").next().unwrap().replace(", [", "\n[").replace("] ", "]\n");
    let dataset =
        format!("schema = \"tauscope.dataset/1\"\nrobot = \"two.xml\"\n[[train]]\nfile = \"log.csv\"\n{told}\n");
    case.write("d.toml", &dataset.replace("[1, K]", "[1, 2.5]"));
    let said = case.tauscope(&["inspect", "--dataset", "d.toml", "--convert", "both.csv"]);
    assert_done(&said);
    let [logged, taken] = [case.read("log.csv"), case.read("both.csv")].map(|log| {
        let last = log.lines().last().unwrap().to_owned();
        last.split(',').rev().take(2).map(|cell| cell.parse::<f64>().unwrap()).collect::<Vec<f64>>()
    });
    assert!((taken[0] - 2.5 * logged[0]).abs() < 1e-9 && taken[1] == logged[1], "{taken:?} {logged:?}");
    assert!(!text(&said.stdout).contains("there is no torque"), "{}", text(&said.stdout));
}

/// One file for each joint, with a time of its own.
#[test]
fn a_file_for_each_joint() {
    let case = Case::new(&[]);
    case.write("two.xml", MODEL);
    for joint in 1..=2 {
        case.write(&format!("axis_{joint}.csv"), &sines("time,position,torque", |t| one_joint(t + f64::from(joint))));
    }
    case.write(
        "d.toml",
        "schema = \"tauscope.dataset/1\"\nrobot = \"two.xml\"\n[[train]]\nfiles = [\"axis_1.csv\", \"axis_2.csv\"]\n",
    );
    let said = case.tauscope(&["inspect", "--dataset", "d.toml"]);
    assert_done(&said);
    let said = text(&said.stdout);
    assert!(said.contains("1000 rows over 3.996 s at 250 Hz") && said.contains(" elbow "), "{said}");
}

/// Times in both files, rows without a number in one, and two recordings in each.
#[test]
fn files_of_one_log_have_no_gaps_of_their_own() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let log = sines("", one_joint);
    let rows: Vec<Vec<&str>> = log.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let of = |name: &str, place: usize, lost: &[usize]| {
        // The second recording begins in the middle of the motion of the first.
        let value = |row: usize| if row < 500 { row } else { row - 250 };
        let cell = |row: usize| if lost.contains(&row) { "nan" } else { rows[value(row)][place] };
        let again = (0..rows.len()).map(|row| (rows[row % 500][0], cell(row)));
        again.fold(format!("time,{name}\n"), |text, (time, cell)| text + &format!("{time},{cell}\n"))
    };
    case.write("q.csv", &of("q1", 1, &[100, 700]));
    case.write("tau.csv", &of("tau1", 2, &[200]));
    case.write(
        "d.toml",
        "schema = \"tauscope.dataset/1\"\nrobot = \"one.urdf\"\n[[train]]\nfiles = [\"q.csv\", \"tau.csv\"]\n",
    );
    let said = case.tauscope(&["inspect", "d.toml"]);
    assert_done(&said);
    let said = text(&said.stdout);
    assert!(said.contains("0 gaps, 3 rows left out") && said.contains("2 recordings"), "{said}");
    assert!(!said.contains("rows lost") && !said.contains("columns not used"), "{said}");
}
