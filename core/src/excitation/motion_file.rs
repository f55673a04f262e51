//! Motion files: one motion for one arm, as TOML.
//!
//! ```toml
//! schema = "tauscope.motion/1"
//! robot = "irb1600-6-1.2"
//! joints = ["joint_1", "joint_2"]     # from the base outwards
//! kind = "freudenstein"               # or "fourier", "quintic", "bspline"
//!
//! [data]                              # the unknowns of that kind; rad and s
//! duration_s = 3.0
//! [[data.joints]]
//! duration_s = [1.0, 2.0]
//! via = [0.4]
//! [[data.joints]]
//! duration_s = [3.0]
//! via = []
//! ```
//!
//! | kind | `data` |
//! |---|---|
//! | `freudenstein` | `duration_s`; per joint `duration_s`, `via` |
//! | `fourier` | `period_s`, `periods`; per joint `a`, `b` |
//! | `quintic` | `duration_s`; per joint `duration_s`, `position` and optionally `velocity`, `acceleration` |
//! | `bspline` | `duration_s`, `degree`; per joint `control_points` |
//!
//! Keys not named here are refused. Numbers are written with as many digits as reading them back exactly takes.

use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{Motion, Reference};
use crate::error::{Error, Result, line_at};

/// Version of the format, the value of `schema`.
pub(crate) const SCHEMA: &str = "tauscope.motion/1";

/// A motion with the arm it is meant for.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::{MotionFile, Reference};
///
/// let text = r#"
/// schema = "tauscope.motion/1"
/// robot = "bench"
/// joints = ["pan"]
/// kind = "freudenstein"
/// data = { duration_s = 3.0, joints = [{ duration_s = [1.0, 2.0], via = [0.4] }] }
/// "#;
/// let file = MotionFile::parse("motion.toml", text)?;
/// assert_eq!((file.motion.kind(), file.motion.duration_s()), ("freudenstein", 3.0));
///
/// // It comes back exactly, and only for the joints that it was made for.
/// assert_eq!(MotionFile::parse("motion.toml", &file.to_toml()?)?, file);
/// assert!(file.for_arm("bench", &["tilt"]).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MotionFile {
    /// Name of the robot.
    pub robot: String,
    /// Names of its joints from the base outwards, one per joint of the motion.
    pub joints: Vec<String>,
    /// The motion.
    pub motion: Motion,
}

/// The keys of a file; `motion` is spread over `kind` and `data`.
#[derive(Serialize)]
struct Written<'a> {
    schema: &'static str,
    robot: &'a str,
    joints: &'a [String],
    #[serde(flatten)]
    motion: &'a Motion,
}

/// The same keys for a known kind. Reading `data` straight from the text keeps the lines of its errors, which an enum
/// that first collects its content would lose.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Read<D> {
    #[serde(rename = "schema")]
    _schema: String,
    robot: String,
    joints: Vec<String>,
    #[serde(rename = "kind")]
    _kind: String,
    data: D,
}

#[derive(Deserialize)]
struct Header {
    schema: toml::Spanned<String>,
    kind: toml::Spanned<String>,
}

impl MotionFile {
    /// Reads a motion file.
    ///
    /// # Errors
    /// Names the file, and the line and key at fault.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| Error::io(path, "read the motion", source))?;
        Self::parse(path, &text)
    }

    /// Writes a motion file.
    ///
    /// # Errors
    /// Names the file that cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        std::fs::write(path, self.to_toml()?).map_err(|source| Error::io(path, "write the motion", source))
    }

    /// The motion as the text of a motion file.
    ///
    /// # Errors
    /// When the motion has another number of joints than there are names.
    pub fn to_toml(&self) -> Result<String> {
        if self.joints.len() != self.motion.joints() {
            return Err(Error::request("joints", self.wrong_count()));
        }
        let written = Written { schema: SCHEMA, robot: &self.robot, joints: &self.joints, motion: &self.motion };
        toml::to_string(&written).map_err(|error| Error::request("motion", format!("cannot be written: {error}")))
    }

    /// Reads a motion from the text of a motion file; `path` is where errors say it is.
    ///
    /// # Errors
    /// Names the file, and the line and key at fault.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        let path = path.as_ref();
        let header: Header = from_toml(path, text)?;
        if header.schema.get_ref() != SCHEMA {
            let problem = format!("must be \"{SCHEMA}\", found \"{}\"", header.schema.get_ref());
            return Err(Error::input(path, Some(line_at(text, header.schema.span().start)), "schema", problem));
        }
        match header.kind.get_ref().as_str() {
            "freudenstein" => Self::parse_kind(path, text, Motion::Freudenstein),
            "fourier" => Self::parse_kind(path, text, Motion::Fourier),
            "quintic" => Self::parse_kind(path, text, Motion::Quintic),
            "bspline" => Self::parse_kind(path, text, Motion::Bspline),
            other => {
                let problem = format!("must be one of {}, found \"{other}\"", Motion::KINDS.join(", "));
                Err(Error::input(path, Some(line_at(text, header.kind.span().start)), "kind", problem))
            }
        }
    }

    fn parse_kind<D: DeserializeOwned>(path: &Path, text: &str, motion: impl Fn(D) -> Motion) -> Result<Self> {
        let Read::<D> { robot, joints, data, .. } = from_toml(path, text)?;
        let file = MotionFile { robot, joints, motion: motion(data) };
        if file.joints.len() != file.motion.joints() {
            return Err(Error::input(path, None, "joints", file.wrong_count()));
        }
        Ok(file)
    }

    fn wrong_count(&self) -> String {
        format!("names {} joints, but the motion has {}; name every one", self.joints.len(), self.motion.joints())
    }

    /// The motion, for the arm whose joints are `joint_names`, in this order.
    ///
    /// # Errors
    /// When the motion is for other joints; says which one differs first.
    pub fn for_arm<S: AsRef<str>>(self, robot: &str, joint_names: &[S]) -> Result<Motion> {
        let meant_for = format!("the motion was made for \"{}\"", self.robot);
        if self.joints.len() != joint_names.len() {
            return Err(Error::request(
                format!("motion for {robot}"),
                format!(
                    "{meant_for} with {} joints, but {robot} has {}; take a motion made for this arm",
                    self.joints.len(),
                    joint_names.len()
                ),
            ));
        }
        for (j, (made_for, name)) in self.joints.iter().zip(joint_names).enumerate() {
            if made_for != name.as_ref() {
                return Err(Error::request(
                    format!("motion for {robot}"),
                    format!(
                        "{meant_for}, whose joint {} is \"{made_for}\", but that of {robot} is \"{}\"; take a motion \
                         made for this arm, or rename the joints if they are the same",
                        j + 1,
                        name.as_ref()
                    ),
                ));
            }
        }
        Ok(self.motion)
    }
}

fn from_toml<D: DeserializeOwned>(path: &Path, text: &str) -> Result<D> {
    toml::from_str(text).map_err(|error| Error::toml(path, text, &error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::encoding::{BsplineEncoding, Encoding, FourierEncoding, QuinticEncoding, random_point};
    use crate::excitation::random_sequence::FreudensteinEncoding;
    use crate::excitation::testing::irb1600;

    fn names() -> Vec<String> {
        (1..=6).map(|j| format!("joint_{j}")).collect()
    }

    fn sample() -> String {
        let lines = [
            "schema = \"tauscope.motion/1\"",
            "robot = \"two-link\"",
            "joints = [\"a\", \"b\"]",
            "kind = \"freudenstein\"",
            "[data]",
            "duration_s = 3",
            "[[data.joints]]",
            "duration_s = [1.0, 2.0]",
            "via = [0.4]",
            "[[data.joints]]",
            "duration_s = [3.0]",
            "via = []",
        ];
        lines.join("\n")
    }

    fn refusal(text: &str) -> String {
        MotionFile::parse("motion.toml", text).unwrap_err().to_string()
    }

    #[test]
    fn every_kind_comes_back_exactly() {
        let limits = irb1600();
        let encodings: Vec<Box<dyn Encoding>> = vec![
            Box::new(FreudensteinEncoding::new(&limits, 6, 10.0).unwrap()),
            Box::new(FourierEncoding::new(&limits, 5, 10.0, 2).unwrap()),
            Box::new(QuinticEncoding::new(&limits, 6, 10.0, true).unwrap()),
            Box::new(QuinticEncoding::new(&limits, 6, 10.0, false).unwrap()),
            Box::new(BsplineEncoding::new(&limits, 11, 5, 10.0).unwrap()),
        ];
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("motion.toml");
        for encoding in encodings {
            for index in 0..20 {
                let motion = encoding.decode(&random_point(&*encoding, 3, "round trip", index));
                let file = MotionFile { robot: "irb1600".into(), joints: names(), motion };
                file.write(&path).unwrap();
                assert_eq!(MotionFile::read(&path).unwrap(), file);
            }
        }
    }

    #[test]
    fn a_hand_written_file_is_read() {
        let file = MotionFile::parse("motion.toml", &sample()).unwrap();
        assert_eq!((file.motion.kind(), file.motion.duration_s(), file.motion.joints()), ("freudenstein", 3.0, 2));
        assert!(file.for_arm("two-link", &["a", "b"]).is_ok());
    }

    #[test]
    fn refusals_name_file_line_and_key() {
        for (from, to, expected) in [
            ("motion/1", "motion/9", &["motion.toml:1: schema", "motion/9"][..]),
            ("\"freudenstein\"", "\"fast\"", &["motion.toml:4: kind", "bspline"]),
            ("via = [0.4]", "vias = [0.4]", &["motion.toml:9: vias", "unknown field"]),
            ("robot =", "arm =", &["motion.toml:2: arm", "unknown field"]),
            ("duration_s = 3\n", "duration_s = \"3\"\n", &["motion.toml:6: duration_s", "invalid type"]),
            ("duration_s = [3.0]", "duration_s = [2.0]", &["motion.toml:5: data", "joint 2", "add up to 2"]),
            ("[0.4]", "[nan]", &["motion.toml:5: data", "joint 1: via", "finite"]),
            ("[\"a\", \"b\"]", "[\"a\"]", &["motion.toml: joints", "names 1 joints", "has 2"]),
            ("[data]", "[data", &["motion.toml:5"]),
            ("kind", "sort", &["motion.toml", "missing field `kind`"]),
        ] {
            let text = sample();
            assert!(text.contains(from));
            let message = refusal(&text.replacen(from, to, 1));
            for word in expected {
                assert!(message.contains(word), "{message} lacks {word}");
            }
        }
    }

    #[test]
    fn a_motion_for_another_arm_is_refused() {
        let file = MotionFile::parse("motion.toml", &sample()).unwrap();
        let count = file.clone().for_arm("irb1600", &names()).unwrap_err().to_string();
        assert!(count.contains("\"two-link\" with 2 joints, but irb1600 has 6"), "{count}");
        let name = file.for_arm("scara", &["a", "c"]).unwrap_err().to_string();
        assert!(name.contains("joint 2 is \"b\"") && name.contains("\"c\""), "{name}");
    }

    #[test]
    fn a_motion_with_other_names_than_joints_is_not_written() {
        let mut file = MotionFile::parse("motion.toml", &sample()).unwrap();
        file.joints.pop();
        assert!(file.to_toml().unwrap_err().to_string().contains("names 1 joints"));
    }

    #[test]
    fn a_missing_file_is_named() {
        assert!(MotionFile::read("no/such.toml").unwrap_err().to_string().contains("no/such.toml"));
    }
}
