//! Units other than SI in a URDF, recognised by sizes that no arm has: millimetres, centimetres, grams, kg mm2 and its like, and degrees.

mod readings;
mod sizes;

use super::super::xml::child;
use super::edits::{Edit, words};
use readings::Reading;
use roxmltree::{Document, Node};
use sizes::{BodyNumbers, JointNumbers, Sizes, median, numbers};
use std::f64::consts::{PI, TAU};

/// A way from base to tip beyond this, with joints [`LONG_LINK`] apart, is printed in mm: no arm is 50 m long, and one of
/// 50 mm is the smallest.
const LONG_REACH: f64 = 50.0;

/// Distance of joints that is long for metres, and 5 mm in mm.
const LONG_LINK: f64 = 5.0;

/// A reach from here to [`LONG_REACH`] is worth a note: an excavator in metres, or a very small arm in mm.
const NOTED_REACH: f64 = 20.0;

/// Centres of mass so many times as far out as the reach (or 1 m) are printed in mm; in metres they lie within it.
const FAR_CENTER: f64 = 20.0;

/// Half of the centres of mass are farther out than this if they are printed in mm: some are small or zero.
const USUAL_CENTER: f64 = 1.0;

/// Share of the reach within which centres of mass have its unit; in metres they would be a thousandth of a reach in mm.
const NEAR_CENTER: f64 = 0.003;

/// Total mass over the cube of the size, kg/m3, beyond which masses may be printed in g: arms have 1 to 100.
const HEAVY: f64 = 500.0;

/// Total mass that may be printed in g: below, a robot would weigh less than 100 g.
const LIGHTEST: f64 = 100.0;

/// Half of the masses are larger than this if they are printed in g; a few absurd ones make no unit.
const USUAL_MASS: f64 = 2.0;

/// Total mass, kg, that no robot has which is as [`HEAVY`]: 5 t within 2 m. Below, a short and heavy table may be meant, and
/// the bodies must be [`DENSE`].
const HEAVIEST: f64 = 5000.0;

/// Mass over the cube of the radius of gyration, kg/m3, that no body has: a ball of steel has 70000.
const DENSE: f64 = 2e5;

/// Radius of gyration over the size of the robot from which moments are printed in mm2 or cm2: in SI it is .01 to .5, a
/// placeholder may have 5, and moments in mm2 have a thousand times as much.
const WIDE: f64 = 10.0;

/// The same where the bodies have moments of their own, which are no placeholders: half of the links are not wider than all of the robot.
/// Moments in cm2 have a hundred times what those in SI have.
const WIDER_THAN_ALL: f64 = 1.0;

/// The same where masses are far too large as well: grams shrink the radius by a factor of 32.
const WIDE_AND_HEAVY: f64 = 1.0;

/// Range of a turning joint, rad, that is printed in degrees: cables and hoses allow a few turns. A quarter of the joints
/// must have one, and more than half a range of more than [`TURNS`].
const WIDE_RANGE: f64 = 60.0;

/// Range of a turning joint that few have in rad, and nearly all in degrees.
const TURNS: f64 = 2.0 * TAU;

/// Limits beyond this are degrees of no arm, but placeholders for none.
const PLACEHOLDER: f64 = 1000.0;

/// Speed of a turning joint, rad/s, from which it is printed in deg/s if the range is in degrees.
const FAST: f64 = 10.0;

/// Angle of a frame from which roll, pitch and yaw are printed in degrees: three half turns say nothing more than one.
const WIDE_ANGLE: f64 = 3.0 * PI;

/// The edits that turn the numbers of a URDF into SI units, with a note on each unit.
pub(super) fn edits(document: &Document, notes: &mut Vec<String>) -> Vec<Edit> {
    let sizes = Sizes::of(document);
    // What does not move is no robot: things of any size stand in scenes.
    if sizes.joints.iter().all(|joint| joint.kind == "fixed") {
        return Vec::new();
    }
    let mut units = Units { sizes: &sizes, edits: Vec::new(), notes };
    let scale = units.lengths();
    units.masses(scale);
    units.frames();
    units.ranges(scale);
    units.edits
}

struct Units<'s, 'a, 'i> {
    sizes: &'s Sizes<'a, 'i>,
    edits: Vec<Edit>,
    notes: &'s mut Vec<String>,
}

/// What a printed number is divided by to be in SI.
#[derive(Clone, Copy)]
struct Divisors {
    joint: f64,
    center: f64,
}

impl Units<'_, '_, '_> {
    /// Divides all numbers of an element's attributes.
    fn divide(&mut self, node: Option<Node>, names: &[&str], divisor: f64) {
        self.convert(node, names, |value| value / divisor);
    }

    /// Turns all numbers of an element's attributes from degrees to radians.
    fn degrees(&mut self, node: Option<Node>, names: &[&str]) {
        self.convert(node, names, |value| value / 180.0 * PI);
    }

    fn convert(&mut self, node: Option<Node>, names: &[&str], to_si: impl Fn(f64) -> f64) {
        let Some(node) = node else { return };
        for (range, word) in names.iter().flat_map(|name| words(&node, name)) {
            if let Ok(value) = word.parse() {
                self.edits.push((range, format!("{:?}", to_si(value))));
            }
        }
    }

    /// Recognises millimetres and centimetres.
    fn lengths(&mut self) -> Divisors {
        let reach = self.sizes.reach;
        let links = self.sizes.joints.iter().map(|joint| joint.length).filter(|&length| length > 0.0).collect();
        let centers = self.sizes.bodies.iter().map(|body| body.center).filter(|&center| center > 0.0).collect();
        let (link, center) = (median(links).unwrap_or(0.0), median(centers).unwrap_or(0.0));
        let farthest = self.sizes.bodies.iter().map(|body| body.center).fold(0.0, f64::max);
        let mut scale = Divisors { joint: 1.0, center: 1.0 };
        if reach > LONG_REACH && link > LONG_LINK {
            let Reading { divisor, unit } = readings::of_lengths(reach, &self.sizes.bodies);
            scale.joint = divisor;
            self.notes.push(format!("lengths of joints are read as {unit}: the robot would be {reach:.0} m long"));
            self.sizes.joints.iter().for_each(|joint| self.divide(child(&joint.node, "origin"), &["xyz"], divisor));
        } else if reach > NOTED_REACH {
            self.notes.push(format!("the robot is {reach:.0} m long if lengths are in m, as they are read"));
        }
        let is_far = match scale.joint == 1.0 {
            true => farthest > FAR_CENTER * reach.max(1.0) && center > USUAL_CENTER,
            false => center > NEAR_CENTER * reach,
        };
        if is_far {
            // Programs that keep joints in m print centres of mass in mm, and others both alike.
            scale.center = if scale.joint == 1.0 { 1000.0 } else { scale.joint };
            let unit = if scale.center == 100.0 { "cm" } else { "mm" };
            self.notes.push(format!(
                "centres of mass are read as {unit}: they would be up to {farthest:.0} m from their joints"
            ));
            self.sizes.bodies.iter().for_each(|body| self.divide(child(&body.node, "origin"), &["xyz"], scale.center));
        }
        scale
    }

    /// Recognises grams, and the unit of the moments.
    fn masses(&mut self, scale: Divisors) {
        let bodies = &self.sizes.bodies;
        let far = bodies.iter().map(|body| body.center / scale.center).fold(0.0, f64::max);
        let size = (self.sizes.reach / scale.joint).max(2.0 * far);
        let solid: Vec<&BodyNumbers> =
            bodies.iter().filter(|body| body.mass > 0.0 && body.moments != [0.0; 3]).collect();
        let placeholder = solid.iter().all(|body| body.moments == solid[0].moments);
        let wide = |moments: f64, mass: f64| {
            let radii = solid.iter().map(|body| readings::gyration(body, moments, mass) / size).collect();
            median(radii).unwrap_or(0.0)
        };
        if size == 0.0 || solid.is_empty() || placeholder && solid.len() > 1 {
            return;
        }
        let total: f64 = bodies.iter().map(|body| body.mass).sum();
        let usual = median(solid.iter().map(|body| body.mass).collect()).unwrap_or(0.0);
        let heavy = total / size.powi(3) > HEAVY && total > LIGHTEST && usual > USUAL_MASS;
        let widest = match heavy && total > HEAVIEST {
            true => WIDE_AND_HEAVY,
            false if readings::have_own_moments(&solid) => WIDER_THAN_ALL,
            false => WIDE,
        };
        let is_wide = wide(1.0, 1.0) > widest;
        let density = |moments: f64| {
            median(solid.iter().map(|body| body.mass / readings::gyration(body, moments, 1.0).powi(3)).collect())
                .unwrap_or(0.0)
        };
        let in_grams = heavy && (total > HEAVIEST || density(if is_wide { 1e6 } else { 1.0 }) > DENSE);
        let mass = if in_grams { 1000.0 } else { 1.0 };
        let Reading { divisor: moments, unit } = match is_wide || in_grams {
            true => readings::of_moments(&solid, size, mass),
            false => Reading { divisor: 1.0, unit: "kg m2" },
        };
        if in_grams {
            self.notes.push(format!("masses are read as g: a robot {size:.2} m long would weigh {total:.0} kg"));
            bodies.iter().for_each(|body| self.divide(child(&body.node, "mass"), &["value"], mass));
        } else if heavy && density(1.0) > DENSE {
            self.notes
                .push(format!("a robot {size:.2} m long weighs {total:.0} kg if masses are in kg, as they are read"));
        }
        if moments != 1.0 {
            let radius = wide(1.0, 1.0) * size;
            self.notes.push(format!(
                "moments of inertia are read as {unit}: bodies would have radii of gyration of {radius:.1} m"
            ));
            let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
            bodies.iter().for_each(|body| self.divide(child(&body.node, "inertia"), &names, moments));
        }
    }

    /// Recognises degrees of roll, pitch and yaw.
    fn frames(&mut self) {
        let joints = self.sizes.joints.iter().filter_map(|joint| child(&joint.node, "origin"));
        let bodies = self.sizes.bodies.iter().filter_map(|body| child(&body.node, "origin"));
        for (origins, whose) in [(joints.collect::<Vec<_>>(), "joints"), (bodies.collect(), "centres of mass")] {
            let angles: Vec<f64> = origins.iter().filter_map(|origin| numbers(origin, "rpy")).flatten().collect();
            let widest = angles.iter().fold(0.0f64, |most, angle| most.max(angle.abs()));
            if widest <= WIDE_ANGLE || widest > 720.0 {
                continue;
            }
            let turned: Vec<f64> = angles.into_iter().filter(|angle| angle.abs() > 1e-3).collect();
            let wide = turned.iter().filter(|angle| angle.abs() > TAU).count();
            if turned.iter().any(|&angle| is_radian(angle)) || 2 * wide < turned.len() {
                self.notes.push(format!("rpy of {whose} goes up to {widest} and is read in rad: check its unit"));
                continue;
            }
            self.notes.push(format!("rpy of {whose} is read in degrees: it goes up to {widest}"));
            origins.into_iter().for_each(|origin| self.degrees(Some(origin), &["rpy"]));
        }
    }

    /// Recognises degrees of ranges and speeds, and ranges of sliding joints in the unit of the lengths.
    fn ranges(&mut self, scale: Divisors) {
        let turning: Vec<&JointNumbers> =
            self.sizes.joints.iter().filter(|joint| joint.kind == "revolute" && joint.range.is_some()).collect();
        let ends = || turning.iter().filter_map(|joint| joint.range).flatten().map(f64::abs);
        let wider =
            |than| turning.iter().filter(|joint| joint.range.is_some_and(|[low, high]| high - low > than)).count();
        let wide = wider(WIDE_RANGE);
        let most_are_wide = 4 * wide > turning.len() && 2 * wider(TURNS) > turning.len();
        // Some degrees look like radians by chance.
        let radians = ends().filter(|&end| is_radian(end)).count();
        let plausible = ends().all(|end| end <= PLACEHOLDER) && 4 * radians < wide;
        // One, two or five times a power of ten on all joints is no range, but "none".
        let distinct = ends().any(|end| end != 0.0 && !is_placeholder(end));
        if most_are_wide && plausible && distinct {
            self.notes.push(format!(
                "limits of turning joints are read in degrees: they go up to {}",
                ends().fold(0.0, f64::max)
            ));
            let speeds = turning.iter().filter_map(|joint| joint.speed).collect();
            let fast = median(speeds).is_some_and(|speed| speed > FAST);
            let names: &[&str] = if fast { &["lower", "upper", "velocity"] } else { &["lower", "upper"] };
            if fast {
                self.notes.push("speed limits of turning joints are read in deg/s".to_owned());
            }
            for joint in turning {
                self.degrees(child(&joint.node, "limit"), names);
                self.degrees(child(&joint.node, "mimic"), &["offset"]);
            }
        } else if plausible && most_are_wide {
            self.notes.push("limits of turning joints are many turns and read in rad: check their unit".to_owned());
        }
        if scale.joint != 1.0 {
            for joint in self.sizes.joints.iter().filter(|joint| joint.kind == "prismatic") {
                self.divide(child(&joint.node, "limit"), &["lower", "upper", "velocity"], scale.joint);
            }
        }
    }
}

/// Whether an angle is a printed multiple of pi/12 and no whole number.
fn is_radian(angle: f64) -> bool {
    let steps = angle / (PI / 12.0);
    angle.fract() != 0.0 && angle.abs() <= 2.0 * TAU && (steps - steps.round()).abs() * PI / 12.0 < 1e-3
}

/// Whether a limit is 1, 2 or 5 times a power of ten, as people write where they mean none.
fn is_placeholder(limit: f64) -> bool {
    [1.0, 2.0, 5.0].iter().any(|first| (limit.abs() / first).log10().fract() == 0.0)
}
