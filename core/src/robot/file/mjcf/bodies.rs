//! The tree of bodies of a MuJoCo model as links and joints.

use super::compiler::turn;
use super::defaults::Settled;
use super::element::Element;
use super::models::{Class, Models, class_within};
use super::names::Names;
use super::shapes;
use crate::error::Result;
use crate::robot::description::{JointDescription, LinkDescription, Missing, Motion};
use crate::robot::model::{Addresses, Drive, Inertia, Limits, Pose};
use nalgebra::{Matrix3, Unit, Vector3};

/// What limits no joint.
pub(super) const UNLIMITED: Limits =
    Limits { lower: f64::NEG_INFINITY, upper: f64::INFINITY, velocity: f64::INFINITY, effort: f64::INFINITY };

/// The links and joints read so far.
pub(super) struct Bodies<'a> {
    models: &'a Models,
    /// Links, the world first.
    pub links: Vec<LinkDescription>,
    /// Joints in the order of the file.
    pub joints: Vec<JointDescription>,
    /// Position at which each joint is drawn.
    pub drawn: Vec<f64>,
    /// Places of the joints in the simulator's vectors.
    pub addresses: Addresses,
    /// What was read otherwise than it is written.
    pub notes: Vec<String>,
    link_names: Names,
    joint_names: Names,
    springs: Vec<String>,
    lifted: Vec<String>,
    /// Bodies whose shapes overrule their inertial.
    overruled: Vec<String>,
    /// Bodies whose meshes would.
    kept: Vec<String>,
    /// Bodies that lack the mass of meshes.
    weightless: Vec<String>,
}

/// Where an element stands: the link, and the pose in it of the frame in which the element is given.
#[derive(Clone, Copy)]
struct Place<'a> {
    link: usize,
    frame: Pose,
    class: Class<'a>,
    /// Whether a joint moves the link: masses of others change no torque.
    moves: bool,
}

impl<'a> Bodies<'a> {
    /// Reads all bodies of a model.
    ///
    /// # Errors
    /// If a number is malformed, a name occurs twice or an axis has no direction.
    pub(super) fn of(root: &'a Element, models: &'a Models) -> Result<Self> {
        let mut bodies = Bodies {
            models,
            links: Vec::new(),
            joints: Vec::new(),
            drawn: Vec::new(),
            addresses: Addresses::default(),
            notes: Vec::new(),
            link_names: Names::of(root, "body"),
            joint_names: Names::of(root, "joint"),
            springs: Vec::new(),
            lifted: Vec::new(),
            overruled: Vec::new(),
            kept: Vec::new(),
            weightless: Vec::new(),
        };
        let name = bodies.link_names.unique("world".to_owned());
        bodies.links.push(LinkDescription {
            name,
            inertia: Inertia::default(),
            missing: None,
            gravcomp: 0.0,
            line: None,
        });
        for world in root.all("worldbody") {
            let place = Place { link: 0, frame: Pose::identity(), class: class_within(world, None), moves: false };
            bodies.contents(world, place)?;
        }
        bodies.summarise();
        Ok(bodies)
    }

    fn summarise(&mut self) {
        if !self.springs.is_empty() {
            self.notes.push(format!("springs of joints are not read ({})", self.springs.join(", ")));
        }
        for (bodies, what) in [
            (
                &self.overruled,
                "inertiafromgeom is true: as in MuJoCo, shapes and not the <inertial> give the mass of these bodies",
            ),
            (
                &self.kept,
                "inertiafromgeom is true, but meshes have no mass here: the <inertial> of these bodies is taken",
            ),
            (&self.weightless, "meshes have no mass here: these bodies lack theirs; give them an <inertial>"),
        ] {
            if !bodies.is_empty() {
                self.notes.push(format!("{what} ({})", bodies.join(", ")));
            }
        }
        if !self.lifted.is_empty() {
            let names = self.lifted.join(", ");
            self.notes.push(format!(
                "gravcomp is not modelled: in MuJoCo a force carries the weight of these bodies ({names})"
            ));
        }
    }

    /// The bodies within an element.
    fn contents(&mut self, element: &'a Element, place: Place<'a>) -> Result<()> {
        for child in &element.children {
            match child.tag.as_str() {
                "body" => self.body(child, place)?,
                "frame" => {
                    let frame = place.frame.then(&self.models.pose(child)?);
                    self.contents(child, Place { frame, class: class_within(child, place.class), ..place })?;
                }
                "composite" | "flexcomp" => {
                    self.notes.push(format!("<{}> in line {} is left out with all in it", child.tag, child.line));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn body(&mut self, element: &'a Element, outer: Place<'a>) -> Result<()> {
        let name = self.link_names.name(element, "body")?;
        let place = Place {
            class: class_within(element, outer.class),
            frame: outer.frame.then(&self.models.pose(element)?),
            ..outer
        };
        let mut joints = Vec::new();
        self.joints_of(element, Pose::identity(), place.class, &mut joints)?;
        let moves = place.moves || !joints.is_empty();
        let body = shapes::body(element, self.models, place.class)?;
        let gravcomp = Settled::plain(element).number("gravcomp")?.unwrap_or(0.0);
        if gravcomp != 0.0 && moves {
            self.lifted.push(name.clone());
        }
        let (mut link, mut frame) = (place.link, place.frame);
        if joints.is_empty() {
            let joint = self.joint_names.unique(format!("{name}_fixed"));
            let child = self.link(name.clone(), element.line);
            self.push(joint, Motion::Fixed, [link, child], frame, Vector3::z(), element.line);
            (link, frame) = (child, Pose::identity());
        }
        let count = joints.len();
        for (index, (joint, around)) in joints.into_iter().enumerate() {
            let last = index + 1 == count;
            let child = if last { name.clone() } else { self.link_names.unique(format!("{name}_{}", index + 1)) };
            let child = self.link(child, element.line);
            let anchor = self.joint(&joint, &around, &name, [link, child], &frame)?;
            // The link stands in the anchor, and the frame of the body next to it.
            (link, frame) = (child, Pose { rotation: Matrix3::identity(), translation: -anchor });
        }
        self.links[link].inertia = body.inertia.seen_from_parent(&frame.rotation, &frame.translation);
        self.links[link].gravcomp = gravcomp;
        if body.overruled && moves {
            self.overruled.push(name.clone());
        }
        if body.unknown > 0 && element.first("inertial").is_some() {
            self.kept.extend(moves.then_some(name));
        } else if body.unknown > 0 {
            self.weightless.extend(moves.then(|| name.clone()));
            self.links[link].missing = Some(Missing {
                line: element.line,
                field: format!("body `{name}`"),
                problem: format!("the mass of {} mesh(es) is not known; give the body an <inertial>", body.unknown),
            });
        }
        self.contents(element, Place { link, frame, moves, ..place })
    }

    /// The joints of a body with the pose of the frame around each.
    fn joints_of(
        &self,
        element: &'a Element,
        frame: Pose,
        class: Class<'a>,
        found: &mut Vec<(Settled<'a>, Pose)>,
    ) -> Result<()> {
        for child in &element.children {
            match child.tag.as_str() {
                "joint" => found.push((self.models.settled(child, class)?, frame)),
                "freejoint" => found.push((Settled::plain(child), frame)),
                "frame" => {
                    let inner = frame.then(&self.models.pose(child)?);
                    self.joints_of(child, inner, class_within(child, class), found)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn link(&mut self, name: String, line: usize) -> usize {
        let line = Some(line);
        self.links.push(LinkDescription { name, inertia: Inertia::default(), missing: None, gravcomp: 0.0, line });
        self.links.len() - 1
    }

    fn push(
        &mut self,
        name: String,
        motion: Motion,
        [parent, child]: [usize; 2],
        origin: Pose,
        axis: Vector3<f64>,
        line: usize,
    ) -> &mut JointDescription {
        self.drawn.push(0.0);
        self.joints.push(JointDescription {
            name,
            motion,
            parent,
            child,
            origin,
            axis,
            limits: UNLIMITED,
            drive: Drive::default(),
            mimic: None,
            line: Some(line),
        });
        let last = self.joints.len() - 1;
        &mut self.joints[last]
    }

    /// Adds a joint of a body whose frame stands at `frame` in the parent link; returns its anchor in the body frame.
    fn joint(
        &mut self,
        joint: &Settled,
        around: &Pose,
        body: &str,
        ends: [usize; 2],
        frame: &Pose,
    ) -> Result<Vector3<f64>> {
        let element = joint.element;
        let name = self.joint_names.name(element, &format!("{body}_joint"))?;
        let kind = if element.tag == "freejoint" { "free" } else { joint.get("type").unwrap_or("hinge") };
        let motion = match kind {
            "hinge" => Motion::Revolute,
            "slide" => Motion::Prismatic,
            "free" => Motion::Floating,
            "ball" => {
                self.notes.push(format!("joint `{name}` (line {}) is a ball joint: it is held as drawn", element.line));
                Motion::Floating
            }
            kind => return Err(element.error(format!("type {kind} is not known; use hinge, slide, ball or free"))),
        };
        let places = match kind {
            "free" => [7, 6],
            "ball" => [4, 3],
            _ => [1, 1],
        };
        self.addresses.add(&name, places);
        let anchor = around.rotation * joint.vector("pos")?.unwrap_or_default() + around.translation;
        // A free body is where its own frame is, wherever the joint is said to be.
        let anchor = if kind == "free" { Vector3::zeros() } else { anchor };
        let axis = joint.vector("axis")?.unwrap_or(Vector3::z());
        let Some(axis) = Unit::try_new(around.rotation * axis, 1e-9) else {
            return Err(element.error("its axis has no direction"));
        };
        let turns = motion == Motion::Revolute;
        let compiler = self.models.compiler(element);
        let in_si = |value: f64| if turns { compiler.angle(value) } else { value };
        let drawn = in_si(joint.number("ref")?.unwrap_or(0.0));
        let back = match motion {
            Motion::Revolute if drawn != 0.0 => Pose { rotation: turn(&axis, -drawn), ..Pose::identity() },
            Motion::Prismatic => Pose { translation: -drawn * *axis, ..Pose::identity() },
            _ => Pose::identity(),
        };
        let range = joint.numbers("range", [2, 2])?.map(|range| [in_si(range[0]), in_si(range[1])]);
        let limited = limits(joint.get("limited"), range.is_some(), compiler.auto_limits);
        let drive = Drive {
            viscous: joint.number("damping")?.unwrap_or(0.0),
            coulomb: joint.number("frictionloss")?.unwrap_or(0.0),
            armature: joint.number("armature")?.unwrap_or(0.0),
        };
        let stiff = joint.number("stiffness")?.unwrap_or(0.0) != 0.0 || joint.get("springdamper").is_some();
        if stiff && motion != Motion::Floating {
            self.springs.push(name.clone());
        }
        let drive = match motion {
            Motion::Revolute | Motion::Prismatic => drive.credible(&name, element.line, &mut self.notes),
            _ => drive,
        };
        let origin = frame.then(&Pose { translation: anchor, ..Pose::identity() }).then(&back);
        let added = self.push(name, motion, ends, origin, axis.into_inner(), element.line);
        if matches!(motion, Motion::Revolute | Motion::Prismatic) {
            added.drive = drive;
            added.limits.effort = largest(joint, ["actuatorfrcrange", "actuatorfrclimited"], compiler.auto_limits)?;
            if let Some([lower, upper]) = range.filter(|_| limited) {
                if lower > upper {
                    return Err(
                        element.error(format!("range {lower} {upper}: the lower end comes first; exchange them"))
                    );
                }
                (added.limits.lower, added.limits.upper) = (lower, upper);
            }
        }
        if let Some(last) = self.drawn.last_mut() {
            *last = drawn;
        }
        Ok(anchor)
    }
}

/// Whether a range limits: as the file says, or by itself.
pub(super) fn limits(said: Option<&str>, has_range: bool, auto: bool) -> bool {
    match said {
        Some("true") => true,
        Some("false") => false,
        _ => auto && has_range,
    }
}

/// The larger end of a range by its size; infinite where it limits nothing.
pub(super) fn largest(element: &Settled, [range, limited]: [&str; 2], auto: bool) -> Result<f64> {
    let ends = element.numbers(range, [2, 2])?;
    let limited = limits(element.get(limited), ends.is_some(), auto);
    let largest = ends.map(|ends| ends[0].abs().max(ends[1].abs()));
    Ok(largest.filter(|_| limited).unwrap_or(f64::INFINITY))
}
