//! Markdown.

/// A table of numbers: first column left, the others right. A bar inside a cell is escaped.
pub(super) fn table<H: AsRef<str>>(header: &[H], rows: &[Vec<String>]) -> String {
    aligned(header, rows, "---:")
}

/// A table of text: all columns left.
pub(super) fn text_table<H: AsRef<str>>(header: &[H], rows: &[Vec<String>]) -> String {
    aligned(header, rows, "---")
}

fn aligned<H: AsRef<str>>(header: &[H], rows: &[Vec<String>], rule_of_others: &str) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let rule = (0..header.len()).map(|column| if column == 0 { "---" } else { rule_of_others }.to_owned()).collect();
    let mut text = line(header.iter().map(|cell| cell.as_ref().replace('|', "\\|")).collect()) + &line(rule);
    for row in rows {
        text += &line(row.iter().map(|cell| cell.replace('|', "\\|")).collect());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_with_a_bar() {
        let text = table(&["a", "b"], &[vec!["|x|".to_owned(), "1".to_owned()]]);
        assert_eq!(text, "| a | b |\n| --- | ---: |\n| \\|x\\| | 1 |\n");
        assert_eq!(text_table(&["a", "b"], &[]), "| a | b |\n| --- | --- |\n");
    }
}
