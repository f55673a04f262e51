//! `inspect` and `identify` on logs of other programs.

mod files;
mod first_contact;
mod headers;
mod inputs;
mod motors;

use super::{Case, assert_done, assert_refusal, text};
use std::fmt::Write;

/// A log of the IRB 1600's scenario as CSV, simulated by the command itself.
fn simulated() -> Case {
    let case = Case::new(&[]);
    assert_done(&case.tauscope(&["simulate", "s.toml", "--out", "out", "--quiet"]));
    case
}

fn log_name(case: &Case) -> String {
    let names = super::names(&case.path("out"));
    let found = names.iter().find(|name| name.ends_with(".parquet") || name.ends_with(".csv")).unwrap();
    format!("out/{found}")
}

pub(super) fn sines(columns: &str, row: impl Fn(f64) -> String) -> String {
    let mut log = format!("{columns}\n");
    for i in 0..1000 {
        let t = 0.004 * f64::from(i);
        writeln!(log, "{t:.4},{}", row(t)).unwrap();
    }
    log
}

pub(super) fn one_joint(t: f64) -> String {
    format!("{:.7},{:.5}", (3.0 * t).sin(), 5.0 * (3.0 * t).cos() + (7.1 * t).sin() - 2.0 * (3.0 * t).sin())
}

#[test]
fn a_simulated_log_is_clean() {
    let case = simulated();
    let output = case.tauscope(&["inspect", &log_name(&case), "--robot", "arm.urdf", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["schema"], "tauscope.quality/1");
    assert_eq!(json["usable"], true);
    assert_eq!(json["rows_rejected"], 0);
    assert_eq!(json["joints"].as_array().unwrap().len(), 6);
    for finding in json["findings"].as_array().unwrap() {
        assert_eq!(finding["severity"], "note", "{finding}");
    }
}

#[test]
fn bad_rows_are_named_and_the_rest_is_used() {
    let case = Case::new(&[]);
    let log = sines("time,q1,tau1", one_joint);
    let mut lines: Vec<&str> = log.lines().collect();
    lines[100] = "0.3960,nan,1.0";
    lines[200] = "0.7960,0.1";
    case.write("log.csv", &lines.join("\n"));
    let output = case.tauscope(&["inspect", "log.csv"]);
    assert_done(&output);
    let said = text(&output.stdout);
    assert!(said.contains("998 rows over 3.996 s at 250 Hz") && said.contains("line 101, 201"), "{said}");
}

#[test]
fn a_log_that_cannot_be_used_is_refused_with_the_reason() {
    let case = Case::new(&[]);
    case.write("log.csv", &sines("t,q1,tau1", |_| "0.5,1.25".to_owned()));
    let output = case.tauscope(&["inspect", "log.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stdout).contains("fatal: "), "{}", text(&output.stdout));
    let said = text(&output.stderr);
    assert!(said.contains("log.csv: ") && said.contains("cannot be used") && said.lines().count() == 1, "{said}");
    assert_refusal(&case.tauscope(&["inspect", "none.csv"]), &["none.csv", "No such file"]);
    case.write("x.csv", "a,b\n1,2\n");
    assert_refusal(&case.tauscope(&["inspect", "x.csv"]), &["x.csv:1: t: missing column"]);
    assert_refusal(&case.tauscope(&["inspect", "log.csv", "--dataset", "s.toml"]), &["s.toml", "unknown field"]);
}

/// One joint with limits at 3 rad and 9 rad/s.
pub(super) const ARM: &str = r#"<robot name="one"><link name="base"/><joint name="a" type="revolute"><parent link="base"/>
<child link="l1"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="99" velocity="9"/></joint><link name="l1">
<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>"#;

#[test]
fn identify_and_diagnose_go_on_with_degrees_millimetres_and_a_clock_that_runs_wrong() {
    let case = Case::new(&[]);
    // 2 kg m2, 1.5 N m s/rad and 3 N m at the joint, without weight; times of the clock, positions and velocities in other units.
    let log = |clock: f64, angle: f64, rate: f64| {
        let mut log = "t,q1,qd1,tau1\n".to_owned();
        for i in 0..4000 {
            let t = 0.004 * f64::from(i);
            let (q, v, a) = (
                (1.3 * t).sin() + 0.3 * (3.1 * t).sin(),
                1.3 * (1.3 * t).cos() + 0.93 * (3.1 * t).cos(),
                -1.69 * (1.3 * t).sin() - 2.883 * (3.1 * t).sin(),
            );
            let torque = 2.0 * a + 1.5 * v + 3.0 * (v / 1e-3).tanh() + 0.02 * (977.0 * t).sin();
            writeln!(log, "{:.6},{:.9},{:.9},{torque:.6}", clock * t, angle * q, rate * v).unwrap();
        }
        log
    };
    let identified = |out: &str| -> Vec<f64> {
        let output = case.tauscope(&["identify", "--robot", "one.urdf", "--train", "log.csv", "--out", out, "--json"]);
        assert_done(&output);
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let parameters = json["without_effects"]["parameters"].as_array().unwrap();
        parameters.iter().map(|parameter| parameter["value"].as_f64().unwrap()).collect()
    };
    let is_corrected = |out: &str| super::names(&case.path(out)).contains(&"corrected.toml".to_owned());
    let [turns, slides] = [ARM.to_owned(), ARM.replace("revolute", "prismatic")];
    let degrees = 180.0 / std::f64::consts::PI;
    for (urdf, clock, [angle, rate], line, written, other) in [
        (
            &turns,
            1.0,
            [degrees; 2],
            "positions and velocities are in degrees",
            "position = \"deg\"\nvelocity = \"deg/s\"",
            "mm",
        ),
        (&turns, 1.0, [degrees, 1.0], "positions are in degrees", "position = \"deg\"", "velocity"),
        (
            &slides,
            1.0,
            [1e3; 2],
            "positions and velocities of joints that slide are in mm",
            "position = \"mm\"\nvelocity = \"mm/s\"",
            "deg",
        ),
        (&turns, 1.6, [1.0; 2], "true seconds per second of the clock: 0.625", "time_factor = 0.62", "position"),
    ] {
        case.write("one.urdf", urdf);
        case.write("log.csv", &log(1.0, 1.0, 1.0));
        let right = identified("right");
        assert!(!is_corrected("right"));
        case.write("log.csv", &log(clock, angle, rate));
        let found = identified("changed");
        let close = |(found, right): (&f64, &f64)| (found - right).abs() < 2e-3 * (1.0 + right.abs());
        assert!(found.iter().zip(&right).all(close), "{found:?} {right:?}");
        let corrected = case.read("changed/corrected.toml");
        assert!(corrected.contains(written) && !corrected.contains(other), "{corrected}");
        // The logs are those that the dataset names.
        let again = case.tauscope(&["inspect", "changed/corrected.toml"]);
        assert_done(&again);
        assert!(text(&again.stdout).contains("Nothing is wrong with it"), "{}", text(&again.stdout));
        let told = case.tauscope(&["diagnose", "--robot", "one.urdf", "--train", "log.csv", "--out", "answer"]);
        assert_done(&told);
        let said = text(&told.stdout);
        assert!(said.contains("Corrected: ") && said.contains(line), "{said}");
        assert!(is_corrected("answer"));
    }
}

#[test]
fn identify_takes_a_dataset() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    // 2 kg m2, 1.5 N m s/rad and 3 N m at the joint, without weight; 50 turns of the motor each, 0.1 N m/A, in degrees.
    let row = |t: f64| {
        let (q, v, a) = ((3.0 * t).sin(), 3.0 * (3.0 * t).cos(), -9.0 * (3.0 * t).sin());
        let current = (2.0 * a + 1.5 * v + 3.0 * v.signum()) / (50.0 * 0.1);
        format!("{:.9},{current:.9}", q * 50.0 * 180.0 / std::f64::consts::PI)
    };
    case.write("log.csv", &sines("t,motor,amps", row));
    case.write(
        "d.toml",
        "schema = \"tauscope.dataset/1\"\nrobot = \"one.urdf\"\n[[train]]\nfile = \"log.csv\"\nto_s = 3.0\n[[test]]\n\
         file = \"log.csv\"\nfrom_s = 3.0\n[columns]\nq = [\"motor\"]\ntau = [\"amps\"]\n[units]\nposition = \"deg\"\n\
         torque = \"A\"\n[motors]\nposition_at = \"motor\"\ngear_ratio = 50\ntorque_constant_nm_a = 0.1\n",
    );
    let output = case.tauscope(&["identify", "--dataset", "d.toml", "--out", "out", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let parameters = json["without_effects"]["parameters"].as_array().unwrap();
    let value = |symbol: &str| {
        let of = parameters.iter().find(|p| p["name"].as_str().unwrap().starts_with(symbol)).unwrap();
        of["value"].as_f64().unwrap()
    };
    for (symbol, expected) in [("Iyy1", 2.0), ("Fv1", 1.5), ("Fc1", 3.0)] {
        assert!((value(symbol) / expected - 1.0).abs() < 1e-3, "{symbol}: {}", value(symbol));
    }
    assert!(json["without_effects"]["test_rms_nm"][0].as_f64().unwrap() < 0.01);

    let output = case.tauscope(&["run", "--dataset", "d.toml", "--out", "run", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["schema"], "tauscope.measured/1");
    assert_eq!(json["variants"][1]["signals"], "savitzky_golay");
    assert!(json["variants"][1]["torque_std_held_out_nm"][0].as_f64().unwrap() < 0.01);
    assert!(super::names(&case.path("run")).contains(&"identified.urdf".to_owned()));
    let both = case.tauscope(&["run", "s.toml", "--dataset", "d.toml"]);
    assert!(both.status.code() == Some(2) && text(&both.stderr).contains("cannot be used with"), "{both:?}");
}

#[test]
fn a_log_goes_through_all_formats_and_comes_back_the_same() {
    let case = simulated();
    let original = case.read("out/recording.csv");
    let mut from = "out/recording.parquet".to_owned();
    for to in ["a.csv", "b.parquet", "c.mcap", "d.db3", "e.csv"] {
        let output = case.tauscope(&["inspect", &from, "--robot", "arm.urdf", "--convert", to]);
        // CSV and bags know the joints by number or name: a file without names is one of joint_1 and so on, as this arm is.
        assert_done(&output);
        assert!(text(&output.stdout).contains(&format!("{to}: 2001 rows written")), "{}", text(&output.stdout));
        from = to.to_owned();
    }
    // Truth and accelerations have no place in messages; all else but the time has every bit.
    let columns = |csv: &str| -> Vec<Vec<String>> {
        let mut lines = csv.lines();
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        let kept: Vec<usize> =
            (0..header.len()).filter(|&k| !header[k].ends_with("_true") && !header[k].starts_with("qdd")).collect();
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            kept.iter().map(|&k| cells[k].to_owned()).collect()
        };
        std::iter::once(row(&header.join(","))).chain(lines.map(row)).collect()
    };
    let (original, back) = (columns(&original), columns(&case.read("e.csv")));
    assert_eq!((original.len(), original[0].len()), (2002, 1 + 3 * 6));
    for (row, (now, then)) in back.iter().zip(&original).enumerate() {
        assert_eq!(now[1..], then[1..], "row {row}");
        // A message has its time in whole nanoseconds.
        let time = |cells: &[String]| cells[0].parse::<f64>().unwrap();
        assert!(row == 0 || (time(now) - time(then)).abs() < 1e-12, "row {row}: {} {}", now[0], then[0]);
    }
    let refused = case.tauscope(&["inspect", "e.csv", "--convert", "e.csv"]);
    assert_refusal(&refused, &["--convert", "the log itself"]);
    assert_refusal(&case.tauscope(&["inspect", "e.csv", "--convert", "e.xls"]), &["e.xls", ".parquet"]);
    assert_refusal(&case.tauscope(&["inspect", "e.csv", "--convert", "none/e.csv"]), &["none/e.csv"]);
}

/// Files that people have: each is read, or refused in one line that says what to do.
#[test]
fn exports_of_other_programs() {
    let case = Case::new(&[]);
    let log = sines("t,q1,tau1", one_joint);
    let rows = || log.lines().skip(1);
    let semicolons = log.replace(',', ";");
    for (what, content) in [
        ("Windows line ends", log.replace('\n', "\r\n")),
        ("byte order mark", format!("\u{feff}{log}")),
        ("semicolons", semicolons.clone()),
        ("decimal commas", semicolons.replace('.', ",")),
        ("tabs", log.replace(',', "\t")),
        ("capitals", log.replacen("t,q1,tau1", "T,Q1,TAU1", 1)),
        ("comments", format!("# made by a controller\n# t in s\n{log}")),
        ("seconds since 1970", sines_at(&log, |t| 1.7e9 + t)),
        ("milliseconds", sines_at(&log, |t| 1e3 * t)),
        ("microseconds", sines_at(&log, |t| 1e6 * t)),
        ("nanoseconds", sines_at(&log, |t| 1e9 * t)),
    ] {
        case.write("log.csv", &content);
        let output = case.tauscope(&["inspect", "log.csv"]);
        assert_eq!(output.status.code(), Some(0), "{what}: {}", text(&output.stderr));
        assert!(text(&output.stdout).contains("1000 rows over 3.996 s at 250 Hz"), "{what}: {}", text(&output.stdout));
        assert!(!text(&output.stdout).contains("warning"), "{what}: {}", text(&output.stdout));
    }
    for (what, content, words) in [
        ("nothing", String::new(), ["log.csv: header", "empty"]),
        ("a header alone", "t,q1,tau1\n".to_owned(), ["log.csv:1: rows", "no row below"]),
        ("two rows", log.lines().take(3).collect::<Vec<_>>().join("\n"), ["log.csv: rows", "too few"]),
        ("German names", log.replacen("t,q1,tau1", "Zeit,Winkel,Moment", 1), ["log.csv:1: q1", "[columns]"]),
        ("a name twice", log.replacen("t,q1,tau1", "t,q1,q1", 1), ["log.csv:1: tau1", "found: t, q1, q1"]),
        (
            "no header",
            rows().collect::<Vec<_>>().join("\n"),
            ["log.csv:1: t", "3 columns of numbers; no line names the columns"],
        ),
        (
            "two recordings",
            format!("{log}{}", rows().skip(300).collect::<Vec<_>>().join("\n")),
            ["log.csv: line", "out of time"],
        ),
        ("numbers of no arm", sines("t,q1,tau1", |t| format!("{:e},1", 1e200 * t.sin())), ["log.csv:", "far beyond"]),
        ("no numbers", sines("t,q1,tau1", |_| "nan,inf".to_owned()), ["log.csv:2: q1", "not a finite number"]),
    ] {
        case.write("log.csv", &content);
        for command in ["inspect", "identify"] {
            let arguments: &[&str] = match command {
                "inspect" => &["inspect", "log.csv"],
                _ => &["identify", "--robot", "arm.urdf", "--train", "log.csv", "--out", "out"],
            };
            let output = case.tauscope(arguments);
            let said = text(&output.stderr);
            assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{command}, {what}: {said}");
            for word in words.iter().filter(|_| command == "inspect") {
                assert!(said.contains(word), "{what}: {said} lacks {word}");
            }
        }
        assert!(!case.path("out").exists(), "{what}");
    }
    std::fs::create_dir(case.path("folder.csv")).unwrap();
    assert_refusal(&case.tauscope(&["inspect", "folder.csv"]), &["folder.csv", "directory"]);
    // UTF-16, as Windows programs write it, is read; an error names the columns.
    let wide = |text: &str| format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    std::fs::write(case.path("wide.csv"), wide(&log)).unwrap();
    let output = case.tauscope(&["inspect", "wide.csv"]);
    assert!(text(&output.stdout).contains("1000 rows over 3.996 s at 250 Hz"), "{}", text(&output.stderr));
    std::fs::write(case.path("wide.csv"), wide("t,q1")).unwrap();
    assert_refusal(&case.tauscope(&["inspect", "wide.csv"]), &["wide.csv:1: tau1", "found: t, q1"]);
}

/// The log with another clock.
fn sines_at(log: &str, clock: impl Fn(f64) -> f64) -> String {
    let mut lines = log.lines();
    let mut out = format!("{}\n", lines.next().unwrap());
    for line in lines {
        let (t, rest) = line.split_once(',').unwrap();
        writeln!(out, "{:.4},{rest}", clock(t.parse().unwrap())).unwrap();
    }
    out
}

/// Names that drivers and loggers give their columns, and what they put between the cells.
#[test]
fn names_and_clocks_of_other_programs() {
    let case = Case::new(&[]);
    let log = sines("t,q1,tau1", one_joint);
    let rows: Vec<(f64, &str, &str)> = log
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            (cells[0].parse().unwrap(), cells[1], cells[2])
        })
        .collect();
    let table = |header: &str, row: &dyn Fn(usize, f64, &str, &str) -> String| {
        let lines = rows.iter().enumerate().map(|(index, (t, q, tau))| row(index, *t, q, tau));
        std::iter::once(header.to_owned()).chain(lines).collect::<Vec<_>>().join("\n")
    };
    let nanoseconds = |t: f64| 1_700_000_000_000_000_000 + (1e9 * t).round() as i64;
    for (what, content) in [
        (
            "RTDE with blanks",
            table("timestamp actual_q_0 actual_current_0", &|_, t, q, tau| format!("{t:.4} {q} {tau}")),
        ),
        ("stamp in two", {
            table("header.stamp.sec,header.stamp.nanosec,elbow_position,elbow_effort", &|_, t, q, tau| {
                let ns = nanoseconds(t);
                format!("{},{},{q},{tau}", ns / 1_000_000_000, ns % 1_000_000_000)
            })
        }),
        ("PlotJuggler", {
            table("__time,/joint_states/elbow/position,/joint_states/elbow/effort", &|_, t, q, tau| {
                format!("{:.4},{q},{tau}", 1.7e9 + t)
            })
        }),
        ("quantity before name", {
            table("__time,/joint_states/position/elbow,/joint_states/effort/elbow", &|_, t, q, tau| {
                format!("{t:.4},{q},{tau}")
            })
        }),
        (
            "nanoseconds",
            table("time_ns,state.q[0],state.tau_J[0]", &|_, t, q, tau| format!("{},{q},{tau}", nanoseconds(t))),
        ),
        ("milliseconds", table("timestamp,q0,tau0", &|_, t, q, tau| format!("{:.1},{q},{tau}", 1e3 * t))),
        ("pandas", table(",time,q_elbow,tau_elbow", &|index, t, q, tau| format!("{index},{t:.4},{q},{tau}"))),
        ("lists", table("stamp;positions;torques", &|_, t, q, tau| format!("{t:.4};[{q}, 0.1];[{tau}, {q}]"))),
        ("dates", {
            table("datetime,elbow.pos,elbow.effort", &|_, t, q, tau| format!("2024-05-01 12:00:{t:07.4},{q},{tau}"))
        }),
        ("rostopic echo -p", {
            table("%time,field.name0,field.position0,field.effort0", &|_, t, q, tau| {
                format!("{},elbow,{q},{tau}", nanoseconds(t))
            })
        }),
        ("zeros lost in the fraction", {
            table("stamp,q1,tau1", &|_, t, q, tau| {
                let ns = nanoseconds(t);
                format!("{}.{},{q},{tau}", ns / 1_000_000_000 - 1_700_000_000, ns % 1_000_000_000)
            })
        }),
    ] {
        case.write("log.txt", &content);
        let output = case.tauscope(&["inspect", "log.txt"]);
        let (said, error) = (text(&output.stdout), text(&output.stderr));
        assert!(said.contains("1000 rows over 3.996 s at 250 Hz"), "{what}: {said}{error}");
    }
    let echo = rows.iter().map(|(t, q, tau)| {
        let ns = nanoseconds(*t);
        format!("{},{},base,elbow,{q},,{tau}", ns / 1_000_000_000, ns % 1_000_000_000)
    });
    case.write("echo.csv", &echo.collect::<Vec<_>>().join("\n"));
    let said = text(&case.tauscope(&["inspect", "echo.csv"]).stdout);
    assert!(said.contains("1000 rows over 3.996 s at 250 Hz") && said.contains(" elbow "), "{said}");
    case.write("rows.csv", &table(",q1,tau1", &|index, _, q, tau| format!("{index},{q},{tau}")));
    assert_refusal(&case.tauscope(&["inspect", "rows.csv"]), &["rows.csv:1: t", "counts the rows", "rate_hz"]);
}

/// A turn that wraps, and two programs that write into one log: the cause alone is reported.
#[test]
fn whole_turns_and_two_sources() {
    let case = Case::new(&[]);
    let turning = |t: f64| {
        let q = 2.9 + 1.5 * (3.0 * t).sin();
        let wrapped = (q + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        format!("{wrapped:.7},{:.7},{:.5}", 4.5 * (3.0 * t).cos(), 5.0 * (3.0 * t).cos() - 3.0 * (3.0 * t).sin())
    };
    case.write("log.csv", &sines("t,q1,qd1,tau1", turning));
    let said = text(&case.tauscope(&["inspect", "log.csv"]).stdout);
    assert!(said.contains("whole turns") && !said.contains("warning"), "{said}");
    let log = sines("t,q1,tau1", one_joint);
    let mixed = log.lines().enumerate().map(|(index, line)| match index > 0 && index % 2 == 0 {
        true => format!("{},0.3,0.0", line.split(',').next().unwrap()),
        false => line.to_owned(),
    });
    case.write("log.csv", &mixed.collect::<Vec<_>>().join("\n"));
    let output = case.tauscope(&["inspect", "log.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("two publishers on one topic"), "{}", text(&output.stderr));
}

/// Joints are taken by name from a log that holds more, in every format; one that has no torque costs its own equation alone.
#[test]
fn logs_with_more_joints_than_the_robot() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let row = |t: f64| format!("0.1,{},0.0", one_joint(t));
    case.write("log.csv", &sines("t,finger_position,a_position,a_effort,other_position", row));
    for to in ["log.parquet", "log.mcap", "log.db3", "back.csv"] {
        assert_done(&case.tauscope(&["inspect", "log.csv", "--convert", to]));
        let said = text(&case.tauscope(&["inspect", to, "--robot", "one.urdf"]).stdout);
        assert!(
            said.contains("1000 rows over 3.996 s") && said.contains(" a ") && !said.contains("finger "),
            "{to}: {said}"
        );
        let all = text(&case.tauscope(&["inspect", to]).stdout);
        assert!(all.contains("q1 (finger), q3 (other): these joints hardly move"), "{to}: {all}");
    }
    // Other programs find the names in the columns too.
    let content = case.read_bytes("log.parquet");
    assert!(content.windows(15).any(|part| part == b"finger_position"));
}

/// Torques of two rates of logging, a velocity that is missing on one joint, and torques that nobody measured.
#[test]
fn signals_that_lack_something() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let all = |t: f64| [(3.0 * t).sin() + 0.4 * (7.0 * t).sin(), 3.0 * (3.0 * t).cos() + 2.8 * (7.0 * t).cos()];
    let torque = |t: f64| {
        let [_, v] = all(t);
        2.0 * (-9.0 * (3.0 * t).sin() - 19.6 * (7.0 * t).sin()) + 1.5 * v + 3.0 * v.signum()
    };
    let mut log = "t,a_position,a_velocity,a_effort\n".to_owned();
    for row in 0..8000 {
        let t = 0.002 * f64::from(row);
        let [q, v] = all(t);
        let velocity = if row % 7 == 3 { String::new() } else { v.to_string() };
        let effort = if row % 4 == 0 { torque(t).to_string() } else { String::new() };
        writeln!(log, "{t:.4},{q},{velocity},{effort}").unwrap();
    }
    case.write("log.csv", &log);
    let arguments = ["identify", "--robot", "one.urdf", "--train", "log.csv", "--out", "out", "--json"];
    let output = case.tauscope(&arguments);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let said = json["notes"].to_string();
    assert!(said.contains("8000 hold positions and 2000 torques") && !said.contains("left out"), "{said}");
    let parameters = json["without_effects"]["parameters"].as_array().unwrap();
    for (symbol, expected) in [("Iyy1", 2.0), ("Fv1", 1.5), ("Fc1", 3.0)] {
        let of = parameters.iter().find(|p| p["name"].as_str().unwrap().starts_with(symbol)).unwrap();
        assert!((of["value"].as_f64().unwrap() / expected - 1.0).abs() < 0.01, "{of}");
    }

    let modelled = |t: f64| {
        let (q, a) = ((3.0 * t).sin(), -9.0 * (3.0 * t).sin());
        format!("{q:.9},{:.9}", 2.0 * a)
    };
    case.write("model.csv", &sines("t,q1,tau1", modelled));
    let output = case.tauscope(&["identify", "--robot", "one.urdf", "--train", "model.csv", "--out", "model"]);
    assert_done(&output);
    assert!(text(&output.stdout).contains("the controller's model"), "{}", text(&output.stdout));
}

#[test]
fn what_is_not_looked_at_is_said() {
    let case = Case::new(&[]);
    let slow = |t: f64| format!("{:.7},{:.5}", t.sin(), 5.0 * t.sin() + (2.3 * t).cos());
    case.write("log.csv", &sines("t,q1 [gon],tau1", slow));
    let said = text(&case.tauscope(&["inspect", "log.csv"]).stdout);
    assert!(said.contains("gon, in the name of q1 [gon], is no known unit"), "{said}");
    assert!(said.contains("too short to decide") && !said.contains("Nothing is wrong"), "{said}");
    case.write("log.csv", &sines("t,q1,tau1", |t| one_joint(3.0 * t)));
    let said = text(&case.tauscope(&["inspect", "log.csv"]).stdout);
    assert!(said.contains("Nothing is wrong with it as far as it shows without the robot"), "{said}");
}
