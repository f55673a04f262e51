//! The thresholds of gates: each comes from `Criteria`.

use super::tokens::{tokens, without_tests};
use std::path::{Path, PathBuf};

const JUDGEMENTS: [&str; 4] = ["at_least", "at_most", "above", "below"];

/// The thresholds, words joined, of the judgements in `source`: their third arguments.
fn thresholds(source: &str) -> Vec<Vec<String>> {
    let words = without_tests(&tokens(source));
    let mut found = Vec::new();
    for (at, window) in words.windows(4).enumerate() {
        let is_judgement = window[0] == "Judgement" && window[1] == "::" && window[3] == "(";
        if !is_judgement || !JUDGEMENTS.contains(&window[2].as_str()) {
            continue;
        }
        let (mut depth, mut arguments) = (0, vec![Vec::new()]);
        for word in &words[at + 4..] {
            match word.as_str() {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" if depth == 0 => break,
                ")" | "]" | "}" => depth -= 1,
                "," if depth == 0 => {
                    arguments.push(Vec::new());
                    continue;
                }
                _ => {}
            }
            arguments.last_mut().expect("there is a first").push(word.clone());
        }
        found.extend(arguments.into_iter().nth(2));
    }
    found
}

/// Whether `source` makes a judgement field by field, so that value, threshold and what passes need not go together.
fn is_made_by_hand(source: &str) -> bool {
    let words = without_tests(&tokens(source));
    let is_literal = |at: usize| {
        let returned = at >= 2 && words[at - 2] == "-" && words[at - 1] == ">";
        words[at] == "Judgement" && words.get(at + 1).is_some_and(|next| next == "{") && !returned
    };
    (0..words.len()).any(is_literal)
}

/// Source files below `folder`.
pub(super) fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the sources can be read");
    let of_entry = |path: PathBuf| if path.is_dir() { sources(&path) } else { vec![path] };
    entries.flat_map(|entry| of_entry(entry.expect("the sources can be read").path())).collect()
}

/// The numbers in a threshold that are its own; a square is none.
fn own_numbers(threshold: &[String]) -> Vec<&String> {
    let is_exponent = |at: usize| at >= 2 && threshold[at - 2] == "powi" && threshold[at] == "2";
    let own = threshold.iter().enumerate().filter(|(at, word)| is_own_number(word) && !is_exponent(*at));
    own.map(|(_, word)| word).collect()
}

/// Whether a word is a constant, or a number other than nothing and one.
fn is_own_number(word: &str) -> bool {
    let is_constant = word.len() > 1 && word.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    is_constant || word.starts_with(|c: char| c.is_ascii_digit()) && !["0", "1", "0f64", "1f64"].contains(&word)
}

#[test]
fn thresholds_of_gates_are_criteria() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("core/src/diagnosis");
    let files = sources(&root).into_iter().filter(|file| !file.starts_with(root.join("criteria")));
    let mut judgements = 0;
    for file in files {
        let source = std::fs::read_to_string(&file).expect("it is text");
        assert!(!is_made_by_hand(&source), "{}: a judgement has constructors", file.display());
        for threshold in thresholds(&source) {
            judgements += 1;
            let own = own_numbers(&threshold);
            assert!(own.is_empty(), "{}: a gate has a threshold of its own: {own:?}", file.display());
        }
    }
    assert!(judgements > 40, "{judgements}");
}

#[test]
fn a_judgement_made_by_hand_is_found() {
    assert!(is_made_by_hand("fn f() -> Judgement { Judgement { passed, ..other } }"));
    assert!(!is_made_by_hand("fn f() -> Judgement { Judgement::above(gate, 1.0, 0.0) }"));
}

#[test]
fn a_threshold_of_its_own_is_found() {
    let own = |threshold: &str| {
        let source = format!("fn f() {{ Judgement::at_most(Gate::Size, largest(a, b), {threshold}).or(x) }}");
        !own_numbers(&thresholds(&source).concat()).is_empty()
    };
    assert!(own("0.05") && own("LIMIT") && own("2.0 * level") && own("1e-3") && own("worse * 2"));
    assert!(
        !own("1.0 + levels.minor")
            && !own("0.0")
            && !own("worse.powi(2)")
            && !own("self.limit(k)")
            && !own("levels.strict_p,")
    );
}
