//! Which of several units printed numbers are in: the one under which reach, masses and radii of gyration are those of arms.
//!
//! What is usual is taken from 84 public URDFs of arms, hands and legs that describe their bodies: logarithms of the reach (half of them
//! 0.8 to 1.3 m), of the mass over the cube of the size (2 to 85 kg/m3), of the radius of gyration over the size (0.02 to 0.25) and of the
//! mass over the cube of the radius of gyration (550 to 13000 kg/m3), each with a middle and a spread.

use super::sizes::{BodyNumbers, median};

/// Reach, m.
const REACH: Usual = Usual { middle: 1.0, spread: 0.6 };

/// Total mass over the cube of the size, kg/m3.
const FILLING: Usual = Usual { middle: 17.0, spread: 0.95 };

/// Radius of gyration of a link over the size of the robot.
const RADIUS: Usual = Usual { middle: 0.055, spread: 0.55 };

/// Mass of a link over the cube of its radius of gyration, kg/m3.
const DENSITY: Usual = Usual { middle: 4000.0, spread: 0.85 };

/// Twice the logarithm of how many files are in mm for one in cm: machines are drawn in mm.
const RARE: f64 = 6.0;

/// Total mass, kg, that no arm falls below: numbers in g are larger.
const LIGHTEST: f64 = 0.1;

/// Units of lengths and of masses, by what numbers in them are divided to be in SI.
const LENGTHS: [Reading; 2] = [Reading { divisor: 1e3, unit: "mm" }, Reading { divisor: 1e2, unit: "cm" }];
const MASSES: [f64; 2] = [1.0, 1e3];

/// Units of moments of inertia, likewise. Moments in g m2 belong to masses in g.
const MOMENTS: [Reading; 6] = [
    Reading { divisor: 1.0, unit: "kg m2" },
    Reading { divisor: 1e4, unit: "kg cm2" },
    Reading { divisor: 1e6, unit: "kg mm2" },
    Reading { divisor: 1e7, unit: "g cm2" },
    Reading { divisor: 1e9, unit: "g mm2" },
    Reading { divisor: 1e3, unit: "g m2" },
];

/// A unit in which printed numbers may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reading {
    /// What a number in it is divided by to be in SI.
    pub divisor: f64,
    /// Its name.
    pub unit: &'static str,
}

/// What a size of arms usually is.
struct Usual {
    middle: f64,
    /// Standard deviation of the logarithm.
    spread: f64,
}

impl Usual {
    /// How unusual a size is: the square of its distance in standard deviations.
    fn off(&self, size: f64) -> f64 {
        ((size / self.middle).ln() / self.spread).powi(2)
    }
}

/// The unit of lengths that are too long for metres, of a robot with this reach as printed.
pub(super) fn of_lengths(reach: f64, bodies: &[BodyNumbers]) -> Reading {
    let masses: Vec<f64> = bodies.iter().map(|body| body.mass).filter(|mass| *mass > 0.0).collect();
    // One mass for all is a placeholder.
    let are_described = masses.iter().any(|mass| *mass != masses[0]);
    let total: f64 = masses.iter().sum();
    let off = |reading: &Reading| {
        let length = reach / reading.divisor;
        let filling = MASSES.iter().map(|unit| total / unit).filter(|total| *total >= LIGHTEST);
        let filling = filling.map(|total| FILLING.off(total / length.powi(3))).fold(f64::INFINITY, f64::min);
        let filling = if are_described && filling.is_finite() { filling } else { 0.0 };
        REACH.off(length) + filling + if reading.divisor == LENGTHS[0].divisor { 0.0 } else { RARE }
    };
    least(&LENGTHS, off)
}

/// The unit of moments that are too large for kg m2, of bodies with masses, which are divided by `mass`, on a robot of a size in m.
pub(super) fn of_moments(solid: &[&BodyNumbers], size: f64, mass: f64) -> Reading {
    let middle = |of: &dyn Fn(&BodyNumbers) -> f64| median(solid.iter().map(|body| of(body)).collect()).unwrap_or(0.0);
    let off = |reading: &Reading| {
        let radius = |body: &BodyNumbers| gyration(body, reading.divisor, mass);
        let density = middle(&|body| body.mass / mass / radius(body).powi(3));
        RADIUS.off(middle(&radius) / size) + DENSITY.off(density)
    };
    let units = if mass == 1.0 { &MOMENTS[..MOMENTS.len() - 1] } else { &MOMENTS[..] };
    least(units, off)
}

/// Whether most bodies have moments that no other has.
pub(super) fn have_own_moments(solid: &[&BodyNumbers]) -> bool {
    let is_own = |body: &&&BodyNumbers| solid.iter().filter(|other| other.moments == body.moments).count() == 1;
    2 * solid.iter().filter(is_own).count() > solid.len()
}

/// Radius of gyration of a body whose printed moments and mass are divided by these.
pub(super) fn gyration(body: &BodyNumbers, moments: f64, mass: f64) -> f64 {
    let trace: f64 = body.moments.iter().sum();
    (0.5 * trace.abs() / moments / (body.mass / mass)).sqrt()
}

fn least(readings: &[Reading], off: impl Fn(&Reading) -> f64) -> Reading {
    *readings.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("there are units to choose from")
}
