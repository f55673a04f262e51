//! What a file given as a robot is, by its content: names mislead.

use super::xml::{XmlText, decoded, is, line};
use super::{mjcf, urdf};
use crate::error::{Error, Result};
use crate::robot::description::{Description, Motion};
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

/// Reads a robot from a file, a URDF or a MuJoCo model whatever its name.
///
/// # Errors
/// Names file, line and element of what is wrong with it, and what to do; a file of another kind is named, with the command that
/// converts it.
pub fn read(path: &Path) -> Result<Description> {
    if path.is_dir() {
        return Err(Error::io(path, "read the URDF", std::io::Error::new(ErrorKind::IsADirectory, folder(path))));
    }
    of_bytes(path, std::fs::read(path).map_err(|e| Error::io(path, "read the URDF", e))?)
}

/// Reads a robot from the text of a URDF or a MuJoCo model. `source` is what messages call it; files that the text includes are
/// looked for in the folder of `source`.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{Choice, InertiaCheck, description};
///
/// let text = std::fs::read_to_string("../urdf/irb1600_6_120.urdf")?;
/// let robot = description::parse(&text, "arm")?.robot(&Choice::default(), InertiaCheck::Required)?;
/// assert_eq!(robot.dof(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`read`].
pub fn parse(text: &str, source: impl AsRef<Path>) -> Result<Description> {
    of_bytes(source.as_ref(), text.as_bytes().to_vec())
}

/// Reads a robot from what a file holds.
fn of_bytes(path: &Path, bytes: Vec<u8>) -> Result<Description> {
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
        return mjcf::read(&source);
    }
    if let Some((what, cure)) = other(&root) {
        return Err(refusal(path, None, what, cure));
    }
    if let Some(node) = macros(&document) {
        return Err(refusal(path, Some(line(&node)), "a xacro file, not the URDF it makes", XACRO_CURE));
    }
    let spent = spent(&document);
    let unfilled = source.text.contains("${") || source.text.contains("$(");
    let read = urdf::read(source.clone());
    match read {
        Err(error) if unfilled && is_robot(&root) => match &error {
            Error::Input { line, .. } => Err(refusal(path, *line, "a xacro file, not the URDF it makes", XACRO_CURE)),
            _ => Err(error),
        },
        Ok(description) if spent.is_some() && moves_nothing(&description) => Err(refusal(
            path,
            spent,
            "a xacro file that makes no joint that moves by itself, not the URDF it makes",
            XACRO_CURE,
        )),
        Ok(mut description) if unfilled => {
            description.notes.extend(unfilled_names(&description));
            Ok(description)
        }
        read => read,
    }
}

/// Whether a robot has no joint that can move.
fn moves_nothing(description: &Description) -> bool {
    description.joints.iter().all(|joint| matches!(joint.motion, Motion::Fixed))
}

/// Names that a xacro file left open, as `${prefix}elbow`.
fn unfilled_names(description: &Description) -> Option<String> {
    let is_open = |name: &&str| name.contains("${") || name.contains("$(");
    let joints = description.joints.iter().map(|joint| joint.name.as_str());
    let first = joints.chain(description.links.iter().map(|link| link.name.as_str())).find(is_open)?;
    let cure = cure_of(&description.source, XACRO_CURE);
    Some(format!("names hold expressions of xacro that were not evaluated, as `{first}`: {cure}"))
}

fn is_robot(root: &Node) -> bool {
    root.has_tag_name("robot")
}

fn refusal(path: &Path, line: Option<usize>, what: &str, cure: &str) -> Error {
    Error::input(path, line, "the robot", format!("this is {what}: {}", cure_of(path, cure)))
}

/// A cure with the name of the file that it is for.
fn cure_of(path: &Path, cure: &str) -> String {
    let name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
    cure.replace("FILE", &name)
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
    let found = MAGIC.iter().find(|(magic, _, _)| bytes.starts_with(magic));
    match found {
        Some((b"PK\x03\x04", what, cure)) => Some(archive(path, bytes).unwrap_or((what, cure))),
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

/// What a zip archive is, by the names of the files in it or its own.
fn archive(path: &Path, bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let named = |end: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
    // The name of the first file follows a head of 30 bytes, which gives its length.
    let length = bytes.get(26..28).map_or(0, |length| usize::from(length[0]) + 256 * usize::from(length[1]));
    let first = bytes.get(30..30 + length).map(String::from_utf8_lossy).unwrap_or_default();
    let holds = |end: &str| first.to_ascii_lowercase().ends_with(end);
    if named("usdz") || holds(".usd") || holds(".usda") || holds(".usdc") {
        Some((USD, USD_CURE))
    } else if named("npz") || holds(".npy") {
        Some(("a numpy archive", LOG_CURE))
    } else if named("xlsx") || holds("[content_types].xml") {
        Some(("a spreadsheet", LOG_CURE))
    } else {
        None
    }
}

/// What a text is that is no XML.
fn plain(path: &Path, text: &str) -> Option<(&'static str, &'static str)> {
    if text.starts_with('<') || text.is_empty() {
        return None;
    }
    let first = text.lines().next().unwrap_or_default();
    let digits = |line: &str| line.bytes().any(|byte| byte.is_ascii_digit());
    let is_table = text.lines().skip(1).take(3).any(digits) || digits(first);
    let words = |separator: char| is_table && first.split(separator).count() > 2;
    let named = |end: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
    if text.starts_with("solid") && (text.contains("facet") || named("stl")) {
        Some(("an STL mesh", MESH_CURE))
    } else if text.starts_with(['{', '[']) && path.extension().is_none_or(|e| e != "toml") && !first.contains("]]") {
        Some(("JSON", "give the arm's URDF; a robot is read from URDF or MJCF"))
    } else if text.contains("schema = \"tauscope.") {
        Some(("a tauscope file", "give the URDF that it names"))
    } else if text.contains("\nv ") && (text.contains("\nf ") || named("obj")) {
        Some(("an OBJ mesh", MESH_CURE))
    } else if words(',') || words(';') || is_table && first.split_whitespace().count() > 2 {
        Some(("a table or log", LOG_CURE))
    } else {
        Some(("a text of another kind", "give the arm's URDF, which starts with <robot>"))
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
    of_xacro(document).find(|node| !SPENT.contains(&node.tag_name().name()))
}

/// Line of the first element of xacro that needs not be expanded.
fn spent(document: &Document) -> Option<usize> {
    of_xacro(document).next().map(|node| line(&node))
}

fn of_xacro<'a>(document: &'a Document) -> impl Iterator<Item = Node<'a, 'a>> {
    let foreign = |node: &Node| node.tag_name().namespace().is_some_and(|uri| uri.contains("xacro"));
    document.descendants().filter(move |node| node.is_element() && foreign(node))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Choice, InertiaCheck};
    use proptest::prelude::*;

    const ROBOTS: [&str; 2] = [
        "<?xml version=\"1.0\"?>\n<robot name=\"a\"><link name=\"b\"/><link name=\"l\"><inertial><origin xyz=\"0 0 1\" rpy=\"0 \
         1.57 0\"/><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>\
         <joint name=\"j\" type=\"revolute\"><parent link=\"b\"/><child link=\"l\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" \
         upper=\"1\"/><mimic joint=\"k\"/></joint></robot>",
        "<mujoco><compiler angle=\"radian\"/><default><joint damping=\"1\"/><default class=\"c\"/></default><worldbody>\
         <body pos=\"0 0 1\" euler=\"0 0 1\"><joint name=\"j\" range=\"-1 1\"/><joint name=\"k\" type=\"slide\" ref=\"1\"/>\
         <geom type=\"capsule\" fromto=\"0 0 0 1 1 1\" size=\"0.1\"/><body name=\"i\"><inertial mass=\"1\" diaginertia=\"1 1 1\"/>\
         </body></body></worldbody><equality><joint joint1=\"j\" joint2=\"k\" polycoef=\"0 1\"/></equality><actuator><motor \
         joint=\"j\" gear=\"2\" ctrlrange=\"-1 1\"/></actuator></mujoco>",
    ];

    const PARTS: [&str; 24] = [
        "<",
        ">",
        "/>",
        "\"",
        "\"\"",
        "0",
        "-1",
        "nan",
        "1e400",
        "1e-320",
        "<link name=\"b\"/>",
        "<joint name=\"k\" type=\"fixed\"/>",
        "<body name=\"i\">",
        "<frame>",
        "<s:t u:v=\"\"/>",
        "<!-- -- -->",
        "<!DOCTYPE r [<!ENTITY e \"&e;\">]>",
        "&e;",
        "&amp;",
        "\u{feff}",
        "\u{1f600}",
        "<include file=\"x\"/>",
        " class=\"c\"",
        "<?xml version=\"1.0\"?>",
    ];

    fn of(text: &str) -> Result<Description> {
        of_bytes(Path::new("robot.urdf"), text.as_bytes().to_vec())
    }

    #[test]
    fn slips_in_a_file_are_noted() {
        let robot = |prefix: &str, masses: [f64; 2]| {
            let link = |name: &str, mass: f64| {
                format!(
                    "<link name=\"{name}\"><inertial><origin xyz=\"0 0 0.1\"/><mass value=\"{mass}\"/><inertia ixx=\"0.1\" ixy=\"0\" \
                     ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial></link>"
                )
            };
            let joint = |name: &str, parent: &str, child: &str| {
                format!(
                    "<joint name=\"{prefix}{name}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"{child}\"/><axis \
                     xyz=\"0 1 0\"/></joint>"
                )
            };
            let text = format!(
                "<robot name=\"a\"><link name=\"base\"/>{}{}{}{}</robot>",
                link("upper", masses[0]),
                link("fore", masses[1]),
                joint("shoulder", "base", "upper"),
                joint("elbow", "upper", "fore")
            );
            parse(&text, "arm.urdf").unwrap().robot(&Choice::default(), InertiaCheck::Ignored).unwrap().notes.join("\n")
        };
        assert_eq!(robot("", [2.0, 1.0]), "");
        let note = robot("${prefix}", [2.0, 1.0]);
        assert!(note.contains("`${prefix}shoulder`") && note.contains("xacro arm.urdf -o robot.urdf"), "{note}");
        assert!(robot("", [-2.0, 1.0]).contains("the body that moves with shoulder has a negative mass"));
        assert!(robot("", [2.0, 0.0]).contains("the body that moves with elbow has no mass"));
        // None of all links: that is no slip, and is noted elsewhere.
        assert_eq!(robot("", [0.0, 0.0]), "");
    }

    #[test]
    fn both_kinds_are_read_whatever_the_name() {
        assert_eq!(ROBOTS.map(|text| of(text).unwrap().joints.len()), [1, 3]);
    }

    #[test]
    fn files_of_other_kinds_are_named_with_what_to_do() {
        let xacro = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:include filename=\"a\"/></robot>";
        let spent =
            ROBOTS[0].replace("<link name=\"b\"/>", "<link name=\"b\"/><xacro:property name=\"p\" value=\"1\"/>");
        assert!(of(&spent).is_ok());
        for (bytes, words) in [
            (xacro.as_bytes(), ["xacro file", "`xacro robot.urdf -o robot.urdf`"]),
            (b"<robot><link name=\"${prefix}a\"/><link/></robot>", ["xacro file", "`xacro "]),
            (
                b"<robot name=\"a\"><xacro:property name=\"p\" value=\"1\"/><link name=\"b\"/></robot>",
                ["xacro file", "`xacro "],
            ),
            (b"<sdf version=\"1.9\"><model name=\"a\"/></sdf>", ["SDF", "`sdf2mjcf "]),
            (b"#usda 1.0\n", ["USD", "`usd_to_urdf "]),
            (b"PXR-USDC\0\0", ["USD", "`usd_to_urdf "]),
            (b"t,q1,q2\n0,1,2\n", ["a table or log", "--train"]),
            (b"0.0 1.0 2.0\n", ["a table or log", "--train"]),
            (b"Dear colleague, the URDF is on the share, best regards\n", ["a text of another kind", "<robot>"]),
            (b"#ROSBAG V2.0\n", ["ROS 1 bag", "--train"]),
            (b"{\"robot\": 1}", ["JSON", "URDF"]),
            (b"ISO-10303-21;\n", ["STEP", "export a URDF"]),
            (b"solid a\nfacet normal 0 0 1\n", ["STL", "URDF"]),
            (b"<mujocoinclude/>", ["a part of a MuJoCo model", "includes it"]),
            (b"<robot name=\"a\"><group name=\"arm\"/></robot>", ["SRDF", "URDF"]),
            (b"PK\x03\x04", ["zip archive", "unzip"]),
            (b"hello", ["a text of another kind", "<robot>"]),
        ] {
            let message = of_bytes(Path::new("robot.urdf"), bytes.to_vec()).unwrap_err().to_string();
            assert!(words.iter().all(|word| message.contains(word)) && message.lines().count() == 1, "{message}");
        }
        // The name tells what a text is that holds too little.
        let named = |name: &str| of_bytes(Path::new(name), b"solid a\n".to_vec()).unwrap_err().to_string();
        assert!(named("a.STL").contains("an STL mesh") && named("a.urdf").contains("a text of another kind"));
    }

    proptest! {
        /// Whatever a file holds, the readers answer with a robot or an error that is finite in every number.
        #[test]
        fn no_text_panics_the_readers(
            which in 0..2usize,
            edits in prop::collection::vec((0.0..1.0f64, 0.0..0.1f64, 0..PARTS.len()), 1..5),
        ) {
            let mut text: Vec<char> = ROBOTS[which].chars().collect();
            for (place, length, part) in edits {
                let start = (place * text.len() as f64) as usize;
                let end = (start + (length * length * text.len() as f64) as usize).min(text.len());
                text.splice(start..end, PARTS[part].chars());
            }
            if let Ok(robot) = of(&text.into_iter().collect::<String>()) {
                let numbers = robot.joints.iter().flat_map(|joint| joint.origin.translation.iter().copied().collect::<Vec<_>>());
                prop_assert!(numbers.chain(robot.links.iter().flat_map(|link| link.inertia.0)).all(f64::is_finite));
            }
        }
    }
}
