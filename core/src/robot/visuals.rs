//! What an arm looks like: the visual shapes of its URDF, each on the body that carries it, and capsules for bodies that
//! have none.

use super::file;
use super::model::{JointKind, Pose, Robot};
use std::path::{Path, PathBuf};

/// Radius of a capsule over the reach of the arm.
const CAPSULE_SHARE: f64 = 0.025;

/// Colour of shapes to which the URDF gives none.
const PLAIN: [f64; 4] = [0.62, 0.65, 0.69, 1.0];

/// Formats of meshes that viewers read.
const MESH_FORMATS: [&str; 5] = ["stl", "obj", "glb", "gltf", "dae"];

/// A solid, in its own frame.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::visuals::{self, Shape};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // The pendulum has no shapes in its file, so that links are drawn as capsules.
/// let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// assert!(visuals::load(&pendulum).shapes.iter().all(|visual| matches!(visual.shape, Shape::Capsule { .. })));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Full lengths of the sides, m; the frame is at the centre.
    Box([f64; 3]),
    /// Along z, centred.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// Length along z, m.
        length: f64,
    },
    /// Centred.
    Sphere {
        /// Radius, m.
        radius: f64,
    },
    /// From the origin along z, with half spheres around both ends.
    Capsule {
        /// Radius, m.
        radius: f64,
        /// Distance of the centres of the half spheres, m.
        length: f64,
    },
    /// A file.
    Mesh {
        /// Where it is.
        path: PathBuf,
        /// Factors along the axes.
        scale: [f64; 3],
    },
}

/// A shape on a body.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::visuals;
/// use tauscope::robot::{self, InertiaCheck};
///
/// // Base and six links: every body has a shape, in the frame of its joint.
/// let arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let shapes = visuals::load(&arm).shapes;
/// assert!((0..=6).all(|body| shapes.iter().any(|visual| visual.body == body)));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Visual {
    /// 0 for the base, `j + 1` for the body behind joint `j`.
    pub body: usize,
    /// Pose of the shape in the body's joint frame (the root link's frame for the base).
    pub pose: Pose,
    /// The shape.
    pub shape: Shape,
    /// Red, green, blue, alpha; 0 to 1.
    pub color: [f64; 4],
}

/// All shapes of an arm, and what could not be shown.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::visuals;
/// use tauscope::robot::{self, InertiaCheck};
///
/// let arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let visuals = visuals::load(&arm);
/// assert!(visuals.shapes.len() >= 7 && visuals.notes.is_empty());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Visuals {
    /// The shapes.
    pub shapes: Vec<Visual>,
    /// One sentence for every shape that could not be shown as the URDF has it.
    pub notes: Vec<String>,
}

/// Reads what `robot` looks like from the file it came from. Bodies without any shape become capsules between joints; so
/// does the whole arm if its file cannot be read any longer.
pub fn load(robot: &Robot) -> Visuals {
    let mut visuals = Visuals::default();
    match file::looks(&robot.source) {
        Ok(urdf) => Walk { urdf: &urdf, robot, visuals: &mut visuals }.all(),
        Err(problem) => visuals.notes.push(format!("the URDF cannot be read again ({problem}): capsules are drawn")),
    }
    skeleton(robot, &mut visuals);
    visuals
}

struct Walk<'a> {
    urdf: &'a urdf_rs::Robot,
    robot: &'a Robot,
    visuals: &'a mut Visuals,
}

impl Walk<'_> {
    fn all(&mut self) {
        let is_child = |link: &str| self.urdf.joints.iter().any(|joint| joint.child.link == link);
        let Some(root) = self.urdf.links.iter().find(|link| !is_child(&link.name)) else { return };
        let mut open = vec![(root.name.as_str(), 0, Pose::identity())];
        while let Some((name, body, place)) = open.pop() {
            if let Some(link) = self.urdf.links.iter().find(|link| link.name == name) {
                for visual in &link.visual {
                    self.add(name, visual, body, &place);
                }
            }
            for joint in self.urdf.joints.iter().filter(|joint| joint.parent.link == name) {
                let child = joint.child.link.as_str();
                match (0..self.robot.bodies()).find(|&body| self.robot.body(body).name == joint.name) {
                    Some(index) => open.push((child, index + 1, Pose::identity())),
                    None => open.push((child, body, place.then(&self.standing(joint)))),
                }
            }
        }
    }

    /// Pose of the link behind a joint that does not move.
    fn standing(&self, joint: &urdf_rs::Joint) -> Pose {
        let origin = file::pose_of(&joint.origin);
        let Some((_, position)) = self.robot.held.iter().find(|(name, _)| *name == joint.name) else { return origin };
        let axis = nalgebra::Vector3::from(joint.axis.xyz.0).try_normalize(1e-9).unwrap_or(nalgebra::Vector3::x());
        let kind = match joint.joint_type {
            urdf_rs::JointType::Prismatic => JointKind::Prismatic,
            _ => JointKind::Revolute,
        };
        origin.then(&kind.motion(&axis, *position))
    }

    fn add(&mut self, link: &str, visual: &urdf_rs::Visual, body: usize, place: &Pose) {
        let shape = match &visual.geometry {
            urdf_rs::Geometry::Box { size } => Shape::Box(size.0),
            urdf_rs::Geometry::Cylinder { radius, length } => Shape::Cylinder { radius: *radius, length: *length },
            urdf_rs::Geometry::Sphere { radius } => Shape::Sphere { radius: *radius },
            urdf_rs::Geometry::Capsule { radius, length } => {
                let down = Pose { translation: nalgebra::Vector3::new(0.0, 0.0, -0.5 * length), ..Pose::identity() };
                let pose = place.then(&file::pose_of(&visual.origin)).then(&down);
                let shape = Shape::Capsule { radius: *radius, length: *length };
                return self.visuals.shapes.push(Visual { body, pose, shape, color: self.color(visual) });
            }
            urdf_rs::Geometry::Mesh { filename, scale } => match mesh(&self.robot.source, filename) {
                Ok(path) => Shape::Mesh { path, scale: scale.map_or([1.0; 3], |scale| scale.0) },
                Err(problem) => {
                    return self.visuals.notes.push(format!("link `{link}`: mesh `{filename}` {problem}"));
                }
            },
        };
        let pose = place.then(&file::pose_of(&visual.origin));
        self.visuals.shapes.push(Visual { body, pose, shape, color: self.color(visual) });
    }

    fn color(&self, visual: &urdf_rs::Visual) -> [f64; 4] {
        let own = visual.material.as_ref();
        let global = own.and_then(|own| self.urdf.materials.iter().find(|material| material.name == own.name));
        let color = own.and_then(|own| own.color.as_ref()).or_else(|| global.and_then(|global| global.color.as_ref()));
        color.map_or(PLAIN, |color| color.rgba.0)
    }
}

/// Finds a mesh beside the URDF; `package://NAME/...` is looked for in a folder NAME around the URDF.
fn mesh(urdf: &Path, name: &str) -> Result<PathBuf, String> {
    let format = Path::new(name).extension().and_then(|end| end.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !MESH_FORMATS.contains(&format.as_str()) {
        return Err(format!("is not one of {}", MESH_FORMATS.join(", ")));
    }
    let around = urdf.parent().unwrap_or(Path::new("."));
    let places: Vec<PathBuf> = match name.split_once("package://") {
        Some((_, inside)) => {
            let without = inside.split_once('/').map_or(inside, |(_, rest)| rest);
            around.ancestors().flat_map(|folder| [folder.join(inside), folder.join(without)]).collect()
        }
        None => vec![around.join(name.strip_prefix("file://").unwrap_or(name))],
    };
    places.into_iter().find(|path| path.is_file()).ok_or_else(|| "is not there".to_owned())
}

/// Capsules from joint to joint for the bodies that have no shape.
fn skeleton(robot: &Robot, visuals: &mut Visuals) {
    let lengths = (0..robot.bodies()).map(|body| robot.body(body).origin.translation.norm());
    let radius = CAPSULE_SHARE * (lengths.sum::<f64>() + robot.flange.translation.norm()).max(1e-3);
    for body in 0..=robot.bodies() {
        if visuals.shapes.iter().any(|visual| visual.body == body) {
            continue;
        }
        let next = (0..robot.bodies()).find(|&next| robot.parent(next).map_or(0, |parent| parent + 1) == body);
        let end = next.map_or(robot.flange.translation, |next| robot.body(next).origin.translation);
        let shape = Shape::Capsule { radius, length: end.norm() };
        // A body without length is a ball at its joint; the turn that takes z to a given direction is not unique against z.
        let rotation = nalgebra::Rotation3::rotation_between(&nalgebra::Vector3::z(), &end).unwrap_or_else(|| {
            nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::x_axis(), std::f64::consts::PI)
        });
        let rotation = if end.norm() > 0.0 { rotation.into_inner() } else { nalgebra::Matrix3::identity() };
        let pose = Pose { rotation, translation: nalgebra::Vector3::zeros() };
        visuals.shapes.push(Visual { body, pose, shape, color: PLAIN });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::InertiaCheck;

    fn arm(name: &str) -> Robot {
        crate::robot::load(format!("{}/../{name}", env!("CARGO_MANIFEST_DIR")), InertiaCheck::Ignored).unwrap()
    }

    #[test]
    fn the_irb1600_has_a_shape_on_every_body() {
        let visuals = load(&arm("urdf/irb1600_6_120.urdf"));
        assert_eq!(visuals.notes, [""; 0]);
        for body in 0..=6 {
            assert!(visuals.shapes.iter().any(|visual| visual.body == body), "body {body}");
        }
        let foot = &visuals.shapes[0];
        assert_eq!((foot.body, &foot.shape), (0, &Shape::Box([0.52, 0.40, 0.08])));
        assert_eq!(foot.color, [0.22, 0.23, 0.25, 1.0]);
        assert_eq!(foot.pose.translation, nalgebra::Vector3::new(-0.08, 0.0, 0.04));
        assert!(!visuals.shapes.iter().any(|visual| matches!(visual.shape, Shape::Capsule { .. })));
    }

    #[test]
    fn bodies_without_shapes_are_capsules_from_joint_to_joint() {
        let robot = arm("tests/reference/skew7.urdf");
        let visuals = load(&robot);
        assert_eq!(visuals.shapes.len(), robot.dof() + 1);
        for visual in &visuals.shapes {
            let next = robot.joints.get(visual.body).map_or(robot.flange.translation, |joint| joint.origin.translation);
            let Shape::Capsule { length, .. } = visual.shape else { panic!("{visual:?}") };
            let end = visual.pose.rotation * nalgebra::Vector3::new(0.0, 0.0, length);
            assert!((end - next).norm() < 1e-12, "body {}: {end} {next}", visual.body);
        }
    }

    #[test]
    fn a_mesh_that_is_missing_is_named_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let text = std::fs::read_to_string(format!("{}/../tests/reference/pendulum.urdf", env!("CARGO_MANIFEST_DIR")));
        let visual =
            "<visual><geometry><mesh filename=\"package://some_arm/meshes/a.stl\"/></geometry></visual></link>";
        let path = folder.path().join("arm.urdf");
        std::fs::write(&path, text.unwrap().replace("</link>", visual)).unwrap();
        let robot = crate::robot::load(&path, InertiaCheck::Ignored).unwrap();
        let visuals = load(&robot);
        assert!(visuals.notes[0].contains("`package://some_arm/meshes/a.stl` is not there"), "{:?}", visuals.notes);
        assert_eq!(visuals.shapes.len(), robot.dof() + 1);

        std::fs::create_dir(folder.path().join("meshes")).unwrap();
        std::fs::write(folder.path().join("meshes/a.stl"), "").unwrap();
        let visuals = load(&robot);
        assert_eq!(visuals.notes, [""; 0]);
        let found = |visual: &Visual| matches!(&visual.shape, Shape::Mesh { path, .. } if path.is_file());
        assert!(visuals.shapes.iter().any(found), "{:?}", visuals.shapes);
    }
}
