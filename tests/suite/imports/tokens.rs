//! The words and signs of Rust source text, without comments, literals and test code.

/// Whether `c` may stand in a name.
fn in_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Names, `::` and single signs of `source`. Comments and the contents of literals are left out.
pub(super) fn tokens(source: &str) -> Vec<String> {
    let text: Vec<char> = source.chars().collect();
    let (mut found, mut at) = (Vec::new(), 0);
    while at < text.len() {
        let next = text.get(at + 1).copied();
        match text[at] {
            '/' if next == Some('/') => at = line_end(&text, at),
            '/' if next == Some('*') => at = block_comment_end(&text, at),
            '"' => at = string_end(&text, at + 1),
            '\'' => at = quote_end(&text, at),
            ':' if next == Some(':') => {
                found.push("::".to_owned());
                at += 2;
            }
            c if in_name(c) => {
                let end = (at..text.len()).find(|&i| !in_name(text[i])).unwrap_or(text.len());
                let name: String = text[at..end].iter().collect();
                at = match (name.as_str(), text.get(end)) {
                    ("r" | "br", Some('"' | '#')) => raw_string_end(&text, end),
                    ("b", Some('"')) => string_end(&text, end + 1),
                    ("b", Some('\'')) => quote_end(&text, end),
                    _ => {
                        found.push(name);
                        end
                    }
                };
            }
            c => {
                if !c.is_whitespace() {
                    found.push(c.to_string());
                }
                at += 1;
            }
        }
    }
    found
}

fn line_end(text: &[char], at: usize) -> usize {
    (at..text.len()).find(|&i| text[i] == '\n').unwrap_or(text.len())
}

fn block_comment_end(text: &[char], at: usize) -> usize {
    let (mut depth, mut i) = (0, at);
    while i + 1 < text.len() {
        match (text[i], text[i + 1]) {
            ('/', '*') => (depth, i) = (depth + 1, i + 2),
            ('*', '/') => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            return i;
        }
    }
    text.len()
}

/// Position after the quote that ends the string whose text starts at `at`.
fn string_end(text: &[char], mut at: usize) -> usize {
    while at < text.len() && text[at] != '"' {
        at += if text[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// Position after the raw string whose hashes (or quote) start at `at`.
fn raw_string_end(text: &[char], at: usize) -> usize {
    let hashes = text[at..].iter().take_while(|&&c| c == '#').count();
    if text.get(at + hashes) != Some(&'"') {
        return at + hashes; // A raw identifier.
    }
    let ends = |i: usize| text[i] == '"' && text[i + 1..].iter().take(hashes).filter(|&&c| c == '#').count() == hashes;
    (at + hashes + 1..text.len()).find(|&i| ends(i)).map_or(text.len(), |i| i + 1 + hashes)
}

/// Position after the character literal or the lifetime that starts with the quote at `at`.
fn quote_end(text: &[char], at: usize) -> usize {
    match (text.get(at + 1), text.get(at + 2)) {
        (Some('\\'), _) => (at + 3..text.len()).find(|&i| text[i] == '\'').map_or(text.len(), |i| i + 1),
        (Some(_), Some('\'')) => at + 3,
        _ => (at + 1..text.len()).find(|&i| !in_name(text[i])).unwrap_or(text.len()),
    }
}

/// The tokens without the items under `#[cfg(test)]`: a test may use rooms that its own room must not know.
pub(super) fn without_tests(tokens: &[String]) -> Vec<String> {
    const TEST: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        if tokens[at..].iter().take(TEST.len()).eq(TEST.iter()) {
            at = item_end(tokens, at + TEST.len());
        } else {
            kept.push(tokens[at].clone());
            at += 1;
        }
    }
    kept
}

/// Position after the item that starts at `at`: its semicolon, or the brace that closes it.
fn item_end(tokens: &[String], at: usize) -> usize {
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate().skip(at) {
        match token.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" => depth -= 1,
            "}" => {
                depth -= 1;
                if depth == 0 && tokens.get(i + 1).map(String::as_str) != Some(";") {
                    return i + 1;
                }
            }
            ";" if depth == 0 => return i + 1,
            _ => {}
        }
    }
    tokens.len()
}

#[test]
fn comments_literals_and_lifetimes_are_no_names() {
    let source = r##"
        // crate::a
        /* crate::b /* crate::c */ */
        fn f<'a>(x: &'a str) -> char { g::h("crate::d \" crate::e", r#"crate::f""#, '\'', 'x', b"crate::i") }
    "##;
    let found = tokens(source).concat();
    assert_eq!(found, "fnf<>(x:&str)->char{g::h(,,,,)}");
}

#[test]
fn items_for_tests_are_left_out_and_the_rest_is_kept() {
    let source = "#[cfg(test)] use a::{b}; use c; #[cfg(test)] mod tests { fn x() { { } } } fn y() -> [u8; 2] { z() }";
    assert_eq!(without_tests(&tokens(source)).concat(), "usec;fny()->[u8;2]{z()}");
}
