//! XML files given as logs: descriptions of robots, and pages that came in the place of a download.

/// What an XML file given as a log is, and what to do about it; `name` is that of the file.
pub(super) fn kind(text: &str, name: &str) -> (&'static str, String) {
    const LOG: &str = "and as the log a table, a ROS 2 bag or .npz";
    let robot = || format!("give it with --robot, {LOG}");
    let elsewhere = || format!("give a robot with --robot, {LOG}");
    match root(text).to_ascii_lowercase().as_str() {
        "robot" if is_xacro(text) => {
            let cure = format!("expand it with `xacro {name} -o robot.urdf`, give that with --robot, {LOG}");
            ("a xacro file, from which the URDF of a robot is made", cure)
        }
        "robot" => ("a URDF, the description of a robot", robot()),
        "mujoco" | "mujocoinclude" => ("a model of MuJoCo", robot()),
        "sdf" | "gazebo" => {
            let cure = format!(
                "convert it with `sdf2mjcf {name} robot.xml` (pip install sdformat-mjcf), give that with --robot, {LOG}"
            );
            ("an SDF model, the description of a robot for Gazebo", cure)
        }
        "rob" => (
            "a list of telegrams of KUKA's RSI",
            "make a table of it: a row for each telegram, with columns IPOC and AIPos.A1, Torque.A1 and so on by the names of their elements \
             and attributes"
                .to_owned(),
        ),
        "collada" => ("a COLLADA mesh", elsewhere()),
        "launch" => ("a ROS launch file", elsewhere()),
        "html" => {
            ("a page of HTML, perhaps that of a site in the place of the file", "download the file itself".to_owned())
        }
        _ => ("an XML file", elsewhere()),
    }
}

/// Whether macros are still to be expanded. Files that xacro made hold neither of its elements nor of its brackets.
fn is_xacro(text: &str) -> bool {
    text.contains("<xacro:") || text.contains("${") || text.contains("$(")
}

/// Name of the first element, behind declarations and comments.
fn root(text: &str) -> &str {
    let mut rest = text;
    loop {
        rest = rest.trim_start();
        let end = match rest {
            _ if rest.starts_with("<!--") => "-->",
            _ if rest.starts_with("<?") => "?>",
            _ if rest.starts_with("<!") => {
                let mut words = rest[2..].split(['>', ' ', '\n', '[']).filter(|word| !word.is_empty());
                if words.next().is_some_and(|word| word.eq_ignore_ascii_case("doctype"))
                    && words.next().is_some_and(|word| word.trim_end().eq_ignore_ascii_case("html"))
                {
                    return "html";
                }
                ">"
            }
            _ => break,
        };
        let Some((_, behind)) = rest.split_once(end) else { return "" };
        rest = behind;
    }
    let name = rest.strip_prefix('<').unwrap_or_default();
    let name =
        name.split(|letter: char| letter.is_whitespace() || matches!(letter, '>' | '/')).next().unwrap_or_default();
    name.rsplit_once(':').map_or(name, |(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_of_robots_are_named() {
        let long = format!("<?xml version=\"1.0\"?>\n<!-- {} <sdf> -->\n", "a".repeat(9000));
        for (text, words) in [
            ("<robot name=\"r\"><link name=\"a\"/></robot>", ["a URDF", "give it with --robot"]),
            ("<robot xmlns:xacro=\"w\"><link name=\"a\"/></robot>", ["a URDF", "--robot"]),
            (
                "<robot xmlns:xacro=\"w\"><xacro:include filename=\"a\"/></robot>",
                ["a xacro", "`xacro a.txt -o robot.urdf`"],
            ),
            ("<robot name=\"r\"><link name=\"${prefix}a\"/></robot>", ["a xacro", "`xacro a.txt"]),
            ("<sdf version=\"1.6\"><model/></sdf>", ["an SDF", "`sdf2mjcf a.txt robot.xml`"]),
            ("<mujoco model=\"r\"/>", ["MuJoCo", "give it with --robot"]),
            ("<!DOCTYPE html>\n<body/>", ["HTML", "download"]),
            ("<!DOCTYPE robot>\n<robot/>", ["a URDF", "--robot"]),
            ("<Rob Type=\"KUKA\"><AIPos A1=\"1\"/></Rob>\n<Rob/>", ["RSI", "AIPos.A1"]),
            ("<kml/>", ["an XML file", "--robot"]),
            ("<!-- never closed", ["an XML file", "--robot"]),
        ] {
            for head in ["", &long] {
                let (what, cure) = kind(&format!("{head}{text}"), "a.txt");
                assert!(what.contains(words[0]) && cure.contains(words[1]), "{text}: {what}; {cure}");
            }
        }
    }
}
