//! Other arms than the IRB 1600, drives at their limits, and rapier's own stepping.

use crate::{Case, ROOT, assert_done, text};

/// Runs a shipped scenario and returns what it prints and its two JSON files.
fn run(scenario: &str) -> (String, serde_json::Value, serde_json::Value) {
    let case = Case::new(&[]);
    let output = case.tauscope(&["run", &format!("{ROOT}/tests/scenarios/{scenario}.toml"), "--out", "out"]);
    assert_done(&output);
    let json = |name: &str| serde_json::from_str(&case.read(&format!("out/{name}.json"))).unwrap();
    (text(&output.stdout), json("identification"), json("score"))
}

/// Without noise the plant's parameters are found, with it their intervals hold most of them.
fn assert_identified(identification: &serde_json::Value) {
    let parameters = |variant: usize| identification["variants"][variant]["parameters"].as_array().unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let largest = parameters(0).iter().map(|p| number(&p["truth"]).abs()).fold(0.0, f64::max);
    for parameter in parameters(0) {
        let (value, truth) = (number(&parameter["value"]), number(&parameter["truth"]));
        assert!((value - truth).abs() <= 1e-6 * truth.abs() + 1e-9 * largest, "{parameter}");
    }
    let held = parameters(2).iter().filter(|p| {
        let (truth, interval) = (number(&p["truth"]), &p["interval_95"]);
        (number(&interval[0])..=number(&interval[1])).contains(&truth)
    });
    assert!(held.count() * 100 >= parameters(2).len() * 80);
}

#[test]
fn seven_joints_one_of_which_slides() {
    let (printed, identification, score) = run("skew7");
    assert_identified(&identification);
    assert!(printed.contains("joint_4 (slides, in N)") && !printed.contains("paper"), "{printed}");
    assert_eq!(score["effort_units"], serde_json::json!(["N m", "N m", "N m", "N", "N m", "N m", "N m"]));
    let unit = |start: &str| {
        let parameters = identification["variants"][0]["parameters"].as_array().unwrap().iter();
        let mut found = parameters.filter(|p| p["name"].as_str().unwrap().starts_with(start));
        found.next().unwrap_or_else(|| panic!("no {start}"))["unit"].clone()
    };
    assert_eq!([unit("Fv4"), unit("Fc4"), unit("Ia4")], ["N s/m", "N", "kg"]);
    assert_eq!([unit("Fv5"), unit("Fc5")], ["N m s/rad", "N m"]);
}

#[test]
fn three_joints_with_links_between_fixed_joints() {
    let (printed, identification, _) = run("fixed_links");
    assert_identified(&identification);
    assert!(printed.contains("of 3 joints"), "{printed}");
}

#[test]
fn one_joint_that_turns_without_end() {
    let (_, identification, _) = run("pendulum");
    assert_identified(&identification);
    let parameters = identification["variants"][0]["parameters"].as_array().unwrap();
    let truth: Vec<f64> = parameters.iter().map(|p| p["truth"].as_f64().unwrap()).collect();
    // By hand: mx, mz = 2 kg * -0.5 m, Iyy + Ia = 0.17 + 2 * 0.25 + 0.1, Fv, Fc.
    for (value, expected) in truth.iter().zip([0.0, -1.0, 0.77, 0.4, 0.6]) {
        assert!((value - expected).abs() < 1e-12, "{truth:?}");
    }
}

#[test]
fn a_drive_at_its_limit_is_told() {
    let case = Case::new(&[]).with_urdf("effort=\"1800\"", "effort=\"100\"");
    let output = case.tauscope(&["run", "s.toml", "--out", "out"]);
    assert_done(&output);
    let printed = text(&output.stdout);
    assert!(printed.contains("joint_2 was at its limit of 100 N m for"), "{printed}");
    let score: serde_json::Value = serde_json::from_str(&case.read("out/score.json")).unwrap();
    let share = |joint: usize| score["at_effort_limit"]["training"][joint].as_f64().unwrap();
    assert!(share(1) > 0.1 && share(0) == 0.0, "{score}");
}

/// A loop too fast for the time step, with drives that nothing limits.
#[test]
fn a_simulation_that_runs_away() {
    let case = Case::new(&[("bandwidth_hz = 5.0", "bandwidth_hz = 500.0")]);
    let unlimited = ["1400", "1800", "900", "140", "120", "75"].map(|effort| format!("effort=\"{effort}\""));
    let case = unlimited.iter().fold(case, |case, effort| case.with_urdf(effort, "effort=\"0\""));
    case.assert_refused(&["joint_", "ran away at t = 0.0", "controller.bandwidth_hz"]);
}

#[test]
fn rapiers_own_stepping_runs() {
    let case = Case::new(&[("\"rk4\"", "\"rapier_native\"")]);
    assert_done(&case.tauscope(&["run", "s.toml", "--out", "out"]));
    let other = Case::new(&[]);
    assert_done(&other.tauscope(&["simulate", "s.toml", "--out", "out"]));
    assert_ne!(case.read("out/recording.csv"), other.read("out/recording.csv"));
}
