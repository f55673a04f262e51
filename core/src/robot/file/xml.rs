//! XML as robots' files hold it: a copy of the text that a strict parser takes, lines as in the file.

use crate::error::{Error, Result, line_at};
use roxmltree::{Document, Node, ParsingOptions};
use std::path::{Path, PathBuf};

/// Repairs of one text; each makes a pass over it, and no honest file needs this many.
const MOST_REPAIRS: usize = 64;

/// The text of an XML file.
#[derive(Debug, Clone)]
pub(super) struct XmlText {
    /// The file.
    pub path: PathBuf,
    /// Its text: without byte order mark, with every namespace prefix declared.
    pub text: String,
}

impl XmlText {
    /// The text of a file; `what` names it in errors.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(super) fn read(path: &Path, what: &str) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, format!("read {what}"), e))?;
        Ok(Self::new(path, decoded(bytes)))
    }

    /// A text that came from `path`.
    pub(super) fn new(path: &Path, text: String) -> Self {
        XmlText { path: path.to_owned(), text: corrected(text) }
    }

    /// The elements.
    ///
    /// # Errors
    /// If the text is no XML even after correction; the error names the line.
    pub(super) fn parse(&self) -> Result<Document<'_>> {
        parse(&self.text)
            .map_err(|e| Error::input(&self.path, Some(e.pos().row as usize), "XML", format!("not well-formed: {e}")))
    }
}

fn parse(text: &str) -> std::result::Result<Document<'_>, roxmltree::Error> {
    Document::parse_with_options(text, ParsingOptions { allow_dtd: true, ..ParsingOptions::default() })
}

/// Text in UTF-8, in UTF-16 with its mark, or else in Latin-1, in which every byte is a character.
pub(super) fn decoded(bytes: Vec<u8>) -> String {
    let words =
        |swap: fn([u8; 2]) -> u16| -> Vec<u16> { bytes[2..].chunks_exact(2).map(|c| swap([c[0], c[1]])).collect() };
    let text = match bytes.get(..2) {
        Some([0xff, 0xfe]) => String::from_utf16_lossy(&words(u16::from_le_bytes)),
        Some([0xfe, 0xff]) => String::from_utf16_lossy(&words(u16::from_be_bytes)),
        _ => String::from_utf8(bytes).unwrap_or_else(|e| e.as_bytes().iter().map(|&byte| char::from(byte)).collect()),
    };
    text.strip_prefix('\u{feff}').map_or_else(|| text.clone(), str::to_owned)
}

/// The text with what strict parsers refuse and lenient ones let pass set right: prefixes nobody declared, two hyphens in
/// a comment, an XML declaration that is not at the start.
fn corrected(mut text: String) -> String {
    for _ in 0..MOST_REPAIRS {
        let repaired = match parse(&text) {
            Err(roxmltree::Error::UnknownNamespace(prefix, _)) => declared(&text, &prefix),
            Err(roxmltree::Error::InvalidComment(_)) => Some(with_plain_comments(&text)),
            Err(roxmltree::Error::UnexpectedDeclaration(_)) => Some(without_declaration(&text)),
            _ => None,
        };
        match repaired {
            Some(repaired) if repaired != text => text = repaired,
            _ => break,
        }
    }
    text
}

/// The text with a namespace declared on its root element.
fn declared(text: &str, prefix: &str) -> Option<String> {
    let at = root_name_end(text)?;
    Some(format!("{} xmlns:{prefix}=\"urn:undeclared:{prefix}\"{}", &text[..at], &text[at..]))
}

/// Offset behind the name of the root element.
fn root_name_end(text: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        at += text[at..].find('<')?;
        let rest = &text[at..];
        if rest.starts_with("<!--") {
            at += rest.find("-->")? + 3;
        } else if rest.starts_with("<?") {
            at += rest.find("?>")? + 2;
        } else if rest.starts_with("<!") {
            // A document type may hold declarations in brackets.
            let close = rest.find('>')?;
            at += match rest.find('[') {
                Some(open) if open < close => rest.find(']')? + 1,
                _ => close + 1,
            };
        } else {
            let name = rest[1..].find(|c: char| c.is_whitespace() || c == '>' || c == '/')?;
            return Some(at + 1 + name);
        }
    }
}

/// The text with every comment's inner hyphens replaced, length and lines kept.
fn with_plain_comments(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find("<!--") {
        let (before, comment) = rest.split_at(start + 4);
        let Some(end) = comment.find("-->") else { break };
        plain += before;
        plain += &comment[..end].replace('-', "=");
        rest = &comment[end..];
    }
    plain + rest
}

/// The text with its XML declarations blanked, length and lines kept.
fn without_declaration(text: &str) -> String {
    let mut blank = text.to_owned();
    while let Some(start) = blank.find("<?xml ") {
        let end = blank[start..].find("?>").map_or(blank.len(), |end| start + end + 2);
        let spaces: String = blank[start..end].bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }).collect();
        blank.replace_range(start..end, &spaces);
    }
    blank
}

/// Whether a node is an element of this name that belongs to the document's own vocabulary: extensions such as
/// `<sensor:camera>` carry a namespace that the root does not.
pub(super) fn is(node: &Node, tag: &str) -> bool {
    node.has_tag_name(tag) && node.tag_name().namespace() == node.document().root_element().tag_name().namespace()
}

/// The first child of this name.
pub(super) fn child<'a, 'i>(node: &Node<'a, 'i>, tag: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| is(child, tag))
}

/// All children of this name.
pub(super) fn children<'a, 'i>(node: &Node<'a, 'i>, tag: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| is(child, tag))
}

/// The value of an attribute that says something.
pub(super) fn attribute<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.attribute(name).map(str::trim).filter(|value| !value.is_empty())
}

/// The words of a value; a comma behind a word counts as blank.
pub(super) fn words(value: &str) -> impl Iterator<Item = &str> {
    value.split_whitespace().map(|word| word.strip_suffix(',').unwrap_or(word)).filter(|word| !word.is_empty())
}

/// Line of a node, counted from 1.
pub(super) fn line(node: &Node) -> usize {
    line_at(node.document().input_text(), node.range().start)
}

/// A value as it is written in an attribute.
pub(super) fn escaped(value: &str) -> String {
    value.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> XmlText {
        XmlText::new(Path::new("a.xml"), decoded(bytes.to_vec()))
    }

    #[test]
    fn what_lenient_parsers_take_is_taken_with_its_lines() {
        for bytes in [
            "<?xml version=\"1.0\"?>\n<!-- <a> --><r>\n<s:c n:d=\"1\"/></r>".as_bytes(),
            b"<!DOCTYPE r [<!ENTITY m \"3\">]>\n<r>\n<s:c d=\"&m;\"/></r>",
            b"<!-- a -- b --->\n<r>\n<c d=\"1\"/></r>",
            b"\n<?xml version=\"1.0\"?>\n<r><c d=\"1\"/></r>",
            b"\xef\xbb\xbf<r>\r\n\r\n<c d=\"1\"/></r>",
            b"<r><!-- \xb0 -->\n\n<c d=\"1\"/></r>",
        ] {
            let text = text(bytes);
            let document = text.parse().unwrap();
            let node = document.descendants().find(|node| node.has_tag_name("c")).unwrap();
            assert_eq!(line(&node), 3, "{}", text.text);
        }
        let wide: Vec<u8> = "\u{feff}<r><c/></r>".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(child(&text(&wide).parse().unwrap().root_element(), "c").is_some());
    }

    #[test]
    fn extensions_are_not_the_documents_own_elements() {
        let text = text(b"<r xmlns=\"http://a\"><x:link/><link/></r>");
        let document = text.parse().unwrap();
        assert_eq!(children(&document.root_element(), "link").count(), 1);
    }

    #[test]
    fn what_is_no_xml_names_its_line() {
        for bytes in [&b"<r>\n<c"[..], b"", b"<!", b"<!--", b"<?xml ", b"<a:b", b"<r>&x;</r>", b"\xff\xfe\x3c"] {
            assert!(text(bytes).parse().is_err());
        }
    }
}
