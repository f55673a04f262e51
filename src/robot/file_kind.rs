//! What a file given as a robot is, by its content: names mislead.

use super::description::Description;
use super::xml::{XmlText, decoded, is, line};
use super::{mjcf, urdf};
use crate::error::{Error, Result};
use roxmltree::{Document, Node};
use std::io::ErrorKind;
use std::path::Path;

/// Bytes that files of other kinds start with, what they are, and what to do.
const MAGIC: [(&[u8], &str, &str); 13] = [
    (b"PXR-USDC", USD, USD_CURE),
    (b"#usda", USD, USD_CURE),
    (b"#ROSBAG V", "a ROS 1 bag", LOG_CURE),
    (b"\x89MCAP0\r\n", "an MCAP log", LOG_CURE),
    (b"SQLite format 3\0", "a ROS 2 bag or another database", LOG_CURE),
    (b"PAR1", "a Parquet table", LOG_CURE),
    (b"\x93NUMPY", "a numpy array", LOG_CURE),
    (b"MATLAB 5.0 MAT-file", "a MATLAB file", LOG_CURE),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file", LOG_CURE),
    (b"ISO-10303-21", "a STEP drawing", "export a URDF from the CAD program; a drawing has no joints"),
    (b"glTF", "a glTF mesh", MESH_CURE),
    (b"\x1f\x8b", "a compressed file", "expand it with `gunzip FILE`"),
    (b"PK\x03\x04", "a zip archive", "unpack it with `unzip FILE` and give the URDF in it"),
];

const USD: &str = "a USD scene";
const USD_CURE: &str = "convert it with `usd_to_urdf -o robot.urdf FILE` (pip install nvidia-srl-usd-to-urdf)";
const SDF_CURE: &str = "convert it to a MuJoCo model with `sdf2mjcf FILE robot.xml` (pip install sdformat-mjcf)";
const XACRO_CURE: &str = "expand it with `xacro FILE -o robot.urdf`";
const LOG_CURE: &str = "give it with --train, and the arm's URDF as the robot";
const MESH_CURE: &str = "give the URDF that names it; a mesh has no joints";

/// Elements of xacro that processed files still hold, without effect.
const SPENT: [&str; 2] = ["property", "arg"];

/// Reads a robot from a URDF or a MuJoCo model, whatever its name.
///
/// # Errors
/// Those of the readers; a file of another kind is named, with the command that converts it.
pub(super) fn read(path: &Path) -> Result<Description> {
    if path.is_dir() {
        return Err(Error::io(path, "read the URDF", std::io::Error::new(ErrorKind::IsADirectory, folder(path))));
    }
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, "read the URDF", e))?;
    if let Some((what, cure)) = binary(path, &bytes) {
        return Err(refusal(path, None, what, cure));
    }
    let text = decoded(bytes);
    if let Some((what, cure)) = plain(path, text.trim_start()) {
        return Err(refusal(path, None, what, cure));
    }
    let source = XmlText::new(path, text);
    let document = source.parse()?;
    let root = document.root_element();
    if root.has_tag_name("mujoco") {
        return mjcf::read(path);
    }
    if let Some((what, cure)) = other(&root) {
        return Err(refusal(path, None, what, cure));
    }
    if let Some(node) = macros(&document) {
        return Err(refusal(path, Some(line(&node)), "a xacro file, not the URDF it makes", XACRO_CURE));
    }
    let unfilled = source.text.contains("${") || source.text.contains("$(");
    let read = urdf::read(source.clone());
    match read {
        Err(error) if unfilled && is_robot(&root) => match &error {
            Error::Input { line, .. } => Err(refusal(path, *line, "a xacro file, not the URDF it makes", XACRO_CURE)),
            _ => Err(error),
        },
        read => read,
    }
}

fn is_robot(root: &Node) -> bool {
    root.has_tag_name("robot")
}

fn refusal(path: &Path, line: Option<usize>, what: &str, cure: &str) -> Error {
    let name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
    Error::input(path, line, "the robot", format!("this is {what}: {}", cure.replace("FILE", &name)))
}

/// What to give in place of a folder.
fn folder(path: &Path) -> String {
    let mut names: Vec<String> = Vec::new();
    for place in [path.to_owned(), path.join("urdf"), path.join("robots")] {
        let entries = std::fs::read_dir(&place).into_iter().flatten().flatten().map(|entry| entry.path());
        let robots = entries
            .filter(|file| ["urdf", "xacro", "xml"].iter().any(|end| file.extension().is_some_and(|e| e == *end)));
        let shown = robots.map(|file| file.strip_prefix(path).unwrap_or(&file).display().to_string());
        names.extend(shown.filter(|name| name != "package.xml"));
    }
    names.sort();
    match names.is_empty() {
        true => "it is a directory; give the URDF itself".to_owned(),
        false => format!("it is a directory; give the file itself: {}", names.join(", ")),
    }
}

/// What a file is that is no text, or text of a known head.
fn binary(path: &Path, bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let named = |end: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
    let found = MAGIC.iter().find(|(magic, _, _)| bytes.starts_with(magic));
    match found {
        Some((b"PK\x03\x04", _, _)) if named("usdz") => Some((USD, USD_CURE)),
        Some((b"PK\x03\x04", _, _)) if named("npz") => Some(("a numpy archive", LOG_CURE)),
        Some((b"PK\x03\x04", _, _)) if named("xlsx") => Some(("a spreadsheet", LOG_CURE)),
        Some((_, what, cure)) => Some((what, cure)),
        // A binary STL has a head of 80 bytes and the number of its triangles, 50 bytes each.
        None if bytes.get(80..84).is_some_and(|count| {
            let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
            bytes.len() as u64 == 84 + 50 * u64::from(count)
        }) =>
        {
            Some(("an STL mesh", MESH_CURE))
        }
        None if bytes.iter().take(512).any(|&byte| byte == 0)
            && !bytes.starts_with(b"\xff\xfe")
            && !bytes.starts_with(b"\xfe\xff") =>
        {
            Some(("a binary file that is not known", "give the arm's URDF"))
        }
        None => None,
    }
}

/// What a text is that is no XML.
fn plain(path: &Path, text: &str) -> Option<(&'static str, &'static str)> {
    if text.starts_with('<') || text.is_empty() {
        return None;
    }
    let first = text.lines().next().unwrap_or_default();
    let words = |separator: char| first.split(separator).count() > 2;
    if text.starts_with("solid") && text.contains("facet") {
        Some(("an STL mesh", MESH_CURE))
    } else if text.starts_with(['{', '[']) && path.extension().is_none_or(|e| e != "toml") && !first.contains("]]") {
        Some(("JSON", "give the arm's URDF; a robot is read from URDF or MJCF"))
    } else if text.contains("schema = \"tauscope.") {
        Some(("a tauscope file", "give the URDF that it names"))
    } else if text.contains("\nv ") && text.contains("\nf ") {
        Some(("an OBJ mesh", MESH_CURE))
    } else if words(',') || words(';') || words('\t') {
        Some(("a table or log", LOG_CURE))
    } else {
        None
    }
}

/// What an XML document is whose root is not that of a robot.
fn other(root: &Node) -> Option<(&'static str, &'static str)> {
    match root.tag_name().name() {
        "sdf" | "gazebo" => Some(("an SDF file of Gazebo", SDF_CURE)),
        "mujocoinclude" => Some(("a part of a MuJoCo model", "give the file that includes it")),
        "COLLADA" => Some(("a COLLADA mesh", MESH_CURE)),
        "package" => Some(("the manifest of a ROS package", "give the URDF in the package")),
        "launch" => Some(("a ROS launch file", "give the URDF that it starts")),
        "robot" if !root.children().any(|node| is(&node, "link")) && root.children().any(|node| is(&node, "group")) => {
            Some(("an SRDF of MoveIt, which has no links", "give the URDF it belongs to"))
        }
        _ => None,
    }
}

/// The first element of xacro that has still to be expanded.
fn macros<'a>(document: &'a Document) -> Option<Node<'a, 'a>> {
    let foreign = |node: &Node| node.tag_name().namespace().is_some_and(|uri| uri.contains("xacro"));
    document.descendants().find(|node| node.is_element() && foreign(node) && !SPENT.contains(&node.tag_name().name()))
}
