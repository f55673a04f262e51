//! A URDF with nothing in it but what is read: the URDF crate refuses files for what is only looks, for extensions and for
//! what URDF lets out.

use super::super::xml::{attribute, child, children, escaped, is, words};
use super::elements::joint_type;
use super::{numbers, tree};
use roxmltree::{Document, Node};
use std::fmt::Write;
use std::path::Path;

/// Attributes of a body's elements.
const BODY: [(&str, &[&str]); 3] = [
    ("origin", &["xyz", "rpy", "quat_xyzw"]),
    ("mass", &["value"]),
    ("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]),
];

/// Attributes of a joint's elements that are copied where they say something.
const JOINT: [(&str, &[&str]); 5] = [
    ("origin", &["xyz", "rpy", "quat_xyzw"]),
    ("axis", &["xyz"]),
    ("limit", &["lower", "upper", "velocity", "effort"]),
    ("dynamics", &["damping", "friction"]),
    ("mimic", &["joint", "multiplier", "offset"]),
];

/// Shapes with the attributes they need and how many numbers each holds, none where it is a name.
const SHAPES: [(&str, &[(&str, usize)]); 5] = [
    ("box", &[("size", 3)]),
    ("cylinder", &[("radius", 1), ("length", 1)]),
    ("capsule", &[("radius", 1), ("length", 1)]),
    ("sphere", &[("radius", 1)]),
    ("mesh", &[("filename", 0)]),
];

/// The URDF of `document` with links and joints alone, every number that its crate wants written out; with `looks`, the
/// visual shapes it understands are kept.
pub(super) fn clean(document: &Document, looks: bool) -> String {
    let root = document.root_element();
    let mut text = String::from("<robot");
    write_attributes(&mut text, &root, &["name", "version"]);
    text += ">";
    let moved = tree::moved(&root);
    for node in root.children() {
        if is(&node, "link") {
            open(&mut text, &node, &["name"]);
            // The body of a link that is fixed to the base says nothing about the arm, whatever stands there.
            let moves = attribute(&node, "name").is_some_and(|name| moved.contains(name));
            if moves || numbers::check_body(Path::new(""), &node).is_ok() {
                body(&mut text, &node);
            }
            if looks {
                children(&node, "visual").for_each(|visual| shape(&mut text, &visual));
            }
            text += "</link>";
        } else if is(&node, "joint") {
            joint(&mut text, &node);
        } else if looks && is(&node, "material") {
            material(&mut text, &node);
        }
    }
    text + "</robot>"
}

fn body(text: &mut String, link: &Node) {
    let Some(inertial) = child(link, "inertial") else { return };
    *text += "<inertial>";
    for (tag, names) in BODY {
        let node = child(&inertial, tag);
        let _ = write!(text, "<{tag}");
        for name in names {
            let value = node.and_then(|node| attribute(&node, name));
            if let Some(value) = value.or((tag != "origin").then_some("0")) {
                write_numbers(text, name, value);
            }
        }
        *text += "/>";
    }
    *text += "</inertial>";
}

fn joint(text: &mut String, node: &Node) {
    open(text, node, &["name"]);
    let kind = joint_type(node);
    // Kinds that URDF does not know are held, as a floating joint is.
    let known = ["fixed", "revolute", "continuous", "prismatic", "planar"].contains(&kind.as_str());
    text.truncate(text.len() - 1);
    write_attribute(text, "type", if known { &kind } else { "floating" });
    *text += ">";
    for tag in ["parent", "child"] {
        let link = child(node, tag).and_then(|end| attribute(&end, "link"));
        let _ = write!(text, "<{tag}");
        write_attribute(text, "link", link.unwrap_or_default());
        *text += "/>";
    }
    let elements = if kind == "fixed" { &JOINT[..1] } else { &JOINT };
    for (tag, names) in elements {
        let Some(element) = child(node, tag) else { continue };
        if *tag == "axis" && attribute(&element, "xyz").is_none() {
            continue;
        }
        let _ = write!(text, "<{tag}");
        for name in *names {
            match attribute(&element, name) {
                Some(value) if *name == "joint" => write_attribute(text, name, value),
                Some(value) => write_numbers(text, name, value),
                None => {}
            }
        }
        if *tag == "limit" && attribute(&element, "velocity").is_none() {
            write_attribute(text, "velocity", "0");
        }
        *text += "/>";
    }
    *text += "</joint>";
}

/// A visual whose shape the URDF crate can read.
fn shape(text: &mut String, visual: &Node) {
    let Some(geometry) = child(visual, "geometry") else { return };
    let readable = |node: &Node| {
        let (tag, needed) = SHAPES.iter().find(|(tag, _)| is(node, tag))?;
        needed.iter().all(|(name, count)| numbers_fit(node, name, *count)).then_some((*tag, *needed))
    };
    let Some((node, (tag, needed))) = geometry.children().find_map(|node| Some((node, readable(&node)?))) else {
        return;
    };
    *text += "<visual>";
    if let Some(origin) = child(visual, "origin") {
        *text += "<origin";
        let fitting = |name: &&str| numbers_fit(&origin, name, 3);
        for name in ["xyz", "rpy"].into_iter().filter(fitting) {
            write_numbers(text, name, attribute(&origin, name).unwrap_or_default());
        }
        *text += "/>";
    }
    let _ = write!(text, "<geometry><{tag}");
    for (name, _) in needed {
        write_attributes(text, &node, &[name]);
    }
    if tag == "mesh" && numbers_fit(&node, "scale", 3) {
        write_attributes(text, &node, &["scale"]);
    }
    *text += "/></geometry>";
    if let Some(node) = child(visual, "material") {
        material(text, &node);
    }
    *text += "</visual>";
}

fn material(text: &mut String, node: &Node) {
    *text += "<material";
    write_attribute(text, "name", node.attribute("name").unwrap_or_default());
    *text += ">";
    if let Some(color) = child(node, "color").filter(|color| numbers_fit(color, "rgba", 4)) {
        *text += "<color";
        write_attributes(text, &color, &["rgba"]);
        *text += "/>";
    }
    *text += "</material>";
}

/// Whether an attribute is there and holds so many finite numbers, or any text where no number is wanted.
fn numbers_fit(node: &Node, name: &str, count: usize) -> bool {
    attribute(node, name).is_some_and(|value| {
        let finite = |word: &str| word.parse::<f64>().is_ok_and(f64::is_finite);
        count == 0 || words(value).filter(|word| finite(word)).count() == count
    })
}

fn open(text: &mut String, node: &Node, names: &[&str]) {
    let _ = write!(text, "<{}", node.tag_name().name());
    write_attributes(text, node, names);
    *text += ">";
}

fn write_attributes(text: &mut String, node: &Node, names: &[&str]) {
    for name in names {
        if let Some(value) = attribute(node, name) {
            write_attribute(text, name, value);
        }
    }
}

fn write_numbers(text: &mut String, name: &str, value: &str) {
    write_attribute(text, name, &words(value).collect::<Vec<_>>().join(" "));
}

fn write_attribute(text: &mut String, name: &str, value: &str) {
    let _ = write!(text, " {name}=\"{}\"", escaped(value));
}
