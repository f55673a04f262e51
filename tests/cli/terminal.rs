//! What a terminal is shown and a pipe is not: progress with the time left, and colours.

use super::{Case, ROOT, assert_done, text};

/// Runs the command on a terminal of its own, with a line of bash in front; None where there is no `script` to make one.
fn on_terminal(case: &Case, before: &str, arguments: &str) -> Option<String> {
    if !case.bash("script --version").status.success() {
        eprintln!("skipped: `script` (util-linux) is not there to make a terminal");
        return None;
    }
    let line = format!(
        "unset NO_COLOR CLICOLOR CLICOLOR_FORCE; export TERM=xterm; {before} script -qec \
         \"\\\"$TAUSCOPE\\\" {arguments}\" /dev/null < /dev/null"
    );
    let output = case.bash(&line);
    assert_done(&output);
    Some(text(&output.stdout))
}

#[test]
fn a_terminal_sees_progress_with_the_time_left_and_a_pipe_does_not() {
    let case = Case::new(&[]);
    for command in ["run s.toml --out out", "identify --scenario s.toml --out out", "simulate s.toml --out out"] {
        let Some(shown) = on_terminal(&case, "", command) else { return };
        assert!(
            shown.contains("[          ") && shown.contains(" %, ") && shown.contains(" so far"),
            "{command}: {shown}"
        );
        // The bar is gone before the result is there.
        let result = shown.rsplit(" %, ").next().unwrap();
        assert!(result.contains("\u{1b}[2K") && result.contains("/out"), "{command}: {result}");
        let quiet = on_terminal(&case, "", &format!("{command} --quiet")).unwrap();
        assert_eq!(quiet, "", "{command} --quiet");
        let json = on_terminal(&case, "", &format!("{command} --json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&json).unwrap_or_else(|error| panic!("{command}: {error}: {json}"));
        let piped = case.bash(&format!("\"$TAUSCOPE\" {command} 2>&1 | cat; exit ${{PIPESTATUS[0]}}"));
        assert_done(&piped);
        assert!(!text(&piped.stdout).contains(" so far") && !text(&piped.stdout).contains('\u{1b}'), "{command}");
    }
}

#[test]
fn a_diagnosis_shows_its_time_left_and_sets_off_the_verdict() {
    let case = Case::new(&[]);
    let scenario = format!("{ROOT}/scenarios/effects/stribeck_friction.toml");
    assert_done(&case.tauscope(&["simulate", &scenario, "--out", "logs", "-q"]));
    let command = "diagnose --robot arm.urdf --train logs/recording.csv --test logs/held_out.csv --candidates \
                   stribeck_friction --out out";
    let Some(shown) = on_terminal(&case, "", command) else { return };
    for part in ["examining the logs", " found, testing for the next", "simulating the extended model", " left"] {
        assert!(shown.contains(part), "{part} is not in {shown}");
    }
    assert!(shown.contains("\u{1b}[1mVerdict:") && shown.contains("\u{1b}[2mResults in"), "{shown}");
    let plain = on_terminal(&case, "NO_COLOR=1", command).unwrap();
    assert!(plain.contains("Verdict:") && plain.contains(" left"), "{plain}");
    assert!(!plain.contains("\u{1b}[1mVerdict:") && !plain.contains("\u{1b}[2mResults"), "{plain}");
}

#[test]
fn errors_are_red_on_a_terminal_only() {
    let case = Case::new(&[]);
    let line =
        |before: &str| format!("true; {before} script -qec \"\\\"$TAUSCOPE\\\" run none.toml\" /dev/null < /dev/null");
    if !case.bash("script --version").status.success() {
        return;
    }
    let shown = text(&case.bash(&line("TERM=xterm")).stdout);
    assert!(shown.contains("\u{1b}[1m\u{1b}[31mtauscope:") || shown.contains("\u{1b}[31m"), "{shown:?}");
    let plain = text(&case.bash(&line("TERM=xterm NO_COLOR=1")).stdout);
    assert!(plain.contains("none.toml") && !plain.contains('\u{1b}'), "{plain:?}");
}
