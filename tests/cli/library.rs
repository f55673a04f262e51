//! The library's entry and the command give the same answer, byte for byte.

use super::diagnose::{LOGS, changed};
use super::{assert_done, assert_stopped};
use std::sync::Arc;
use tauscope::cli::{self, Host};
use tauscope::dataset;
use tauscope::diagnosis::{Answer, Consequence, Diagnosis, Outcome, Verdict};
use tauscope::quality::Kind;
use tauscope::recording::{self, memory::Held};
use tauscope::robot::{self, InertiaCheck};
use tauscope::simulation::engine::EngineKind;

/// `diagnosis.json` of the command for a training log.
fn by_command(train: &str, out: &str) -> Vec<u8> {
    let arguments = ["diagnose", "--robot", "arm.urdf", "--train", train, "--test", "out/held_out.csv", "--quiet"];
    let more = ["--candidates", "stribeck_friction,torque_offset", "--seed", "3", "--out", out];
    let output = LOGS.tauscope(&[&arguments[..], &more].concat());
    if out == "stopped" {
        assert_stopped(&output)
    } else {
        assert_done(&output)
    }
    LOGS.read_bytes(&format!("{out}/diagnosis.json"))
}

/// The answer of the library.
fn by_library(train: &str) -> Answer {
    let robot = robot::load(LOGS.path("arm.urdf"), InertiaCheck::Ignored).unwrap();
    let read = |name: &'static str| (name, dataset::read(&LOGS.path(name), &robot).unwrap());
    let train = (train.to_owned(), dataset::read(&LOGS.path(train), &robot).unwrap());
    let diagnosis = Diagnosis::of(&robot).train([train]).test([read("out/held_out.csv")]);
    diagnosis.candidates(["stribeck_friction", "torque_offset"]).seed(3).run().unwrap()
}

fn json(answer: &Answer) -> Vec<u8> {
    answer.to_json().into_bytes()
}

#[test]
fn the_library_answers_as_the_command_does() {
    let mut answer = by_library("out/recording.csv");
    assert_eq!(answer.verdict(), Verdict::Named);
    let findings: Vec<_> = answer.findings().into_iter().map(|one| (one.effect, one.joints)).collect();
    assert_eq!(findings, [("stribeck_friction", vec!["joint_2".to_owned()])]);
    let Outcome::Concluded(conclusion) = &mut answer.outcome else { panic!("stopped: {:?}", answer.faults) };
    conclusion.resimulate(EngineKind::Rapier).unwrap();
    assert!(json(&answer) == by_command("out/recording.csv", "as_library"), "the bytes differ");
}

#[test]
fn the_library_screens_the_logs_as_the_command_does() {
    changed("negative.csv", 0.., |column, cell| {
        if column == "tau3" { (-cell.parse::<f64>().unwrap()).to_string() } else { cell.to_owned() }
    });
    let answer = by_library("negative.csv");
    assert_eq!(answer.verdict(), Verdict::NotTestable);
    assert_eq!((answer.faults[0].kind, answer.faults[0].consequence), (Kind::TorqueSign, Consequence::Stops));
    assert!(answer.findings().is_empty());
    assert!(json(&answer) == by_command("negative.csv", "stopped"), "the bytes differ");
    let refusal = answer.into_conclusion().unwrap_err().to_string();
    assert!(refusal.starts_with("negative.csv: tau3"), "{refusal}");
}

#[test]
fn a_program_gets_what_the_command_prints() {
    let [log, robot] = ["out/recording.csv", "arm.urdf"].map(|name| LOGS.path(name).display().to_string());
    let by_command = LOGS.tauscope(&["inspect", &log, "--robot", &robot, "--json"]);
    assert_done(&by_command);
    let by_command = String::from_utf8(by_command.stdout).unwrap();
    let host = Arc::new(Host::default());
    let called = |log: &str| {
        assert_eq!(cli::call(["inspect", log, "--robot", &robot], &host).unwrap(), cli::DONE);
        host.take().unwrap()
    };
    let printed = called(&log);
    assert!(printed.json == by_command, "the bytes differ");
    assert!(printed.text.contains("joint_1") && host.take().is_none());
    let held = Held::new("monday", recording::load(&log, None).unwrap()).unwrap();
    let from_memory = called(held.path().to_str().unwrap()).json;
    assert!(from_memory == by_command.replace(&log, "<monday>"), "the bytes of a log in memory differ");
}

#[test]
fn a_program_stops_a_command() {
    let [log, robot, out] =
        ["out/recording.csv", "arm.urdf", "stopped_by_a_program"].map(|name| LOGS.path(name).display().to_string());
    let host = Arc::new(Host::default());
    host.stop();
    let arguments = ["diagnose", "--robot", &robot, "--train", &log, "--no-resimulation", "--out", &out];
    assert_eq!(cli::call(arguments, &host).unwrap(), cli::DONE);
    assert!(host.take().unwrap().json.contains("\"unfinished\": true"));
}
