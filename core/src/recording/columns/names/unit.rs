//! Units that stand in the names of columns, or in a line below them.

use super::quantity::{ACCELERATION, POSITION, TORQUE, VELOCITY};
use std::f64::consts::{PI, TAU};

/// The unit of a column, as its name has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    /// How it is written.
    pub symbol: &'static str,
    /// The unit of SI that takes its place.
    pub si: &'static str,
    /// How many of these it is.
    pub factor: f64,
}

/// Force of a kilogram and of a pound under standard gravity, N, and an inch, m.
const KILOGRAM_FORCE: f64 = 9.806_65;
const POUND_FORCE: f64 = 0.453_592_37 * KILOGRAM_FORCE;
const INCH: f64 = 0.0254;

const DEGREE: f64 = PI / 180.0;

/// Ampere, in which currents are that stand for torques.
const AMPERE: &str = "A";

/// Quantity, symbol, unit of SI, factor, and spellings in small letters without what stands between the parts of a unit.
type Row = (usize, &'static str, &'static str, f64, &'static [&'static str]);

const UNITS: [Row; 36] = [
    (POSITION, "rad", "rad", 1.0, &["rad", "rads", "radian", "radians"]),
    (POSITION, "deg", "rad", DEGREE, &["deg", "degs", "degree", "degrees", "grad", "°"]),
    (POSITION, "mrad", "rad", 1e-3, &["mrad"]),
    (POSITION, "mdeg", "rad", 1e-3 * DEGREE, &["mdeg", "m°"]),
    (POSITION, "rev", "rad", TAU, &["rev", "revs", "turn", "turns", "revolution", "revolutions"]),
    (POSITION, "m", "m", 1.0, &["m", "metre", "metres", "meter", "meters"]),
    (POSITION, "cm", "m", 1e-2, &["cm"]),
    (POSITION, "mm", "m", 1e-3, &["mm"]),
    (POSITION, "um", "m", 1e-6, &["um"]),
    (VELOCITY, "rad/s", "rad/s", 1.0, &["rad/s", "radps", "rads1", "rad/sec"]),
    (VELOCITY, "deg/s", "rad/s", DEGREE, &["deg/s", "°/s", "dps", "degps", "degs1", "deg/sec", "degrees/s", "grad/s"]),
    (VELOCITY, "mrad/s", "rad/s", 1e-3, &["mrad/s"]),
    (VELOCITY, "mdeg/s", "rad/s", 1e-3 * DEGREE, &["mdeg/s", "m°/s"]),
    (VELOCITY, "rpm", "rad/s", TAU / 60.0, &["rpm", "r/min", "rev/min", "u/min", "1/min", "min1"]),
    (VELOCITY, "rev/s", "rad/s", TAU, &["rev/s", "turns/s", "turn/s"]),
    (VELOCITY, "m/s", "m/s", 1.0, &["m/s", "ms1", "m/sec"]),
    (VELOCITY, "cm/s", "m/s", 1e-2, &["cm/s"]),
    (VELOCITY, "mm/s", "m/s", 1e-3, &["mm/s", "mms1", "mm/sec"]),
    (VELOCITY, "um/s", "m/s", 1e-6, &["um/s"]),
    (ACCELERATION, "rad/s2", "rad/s2", 1.0, &["rad/s2", "rads2", "rad/s/s"]),
    (ACCELERATION, "deg/s2", "rad/s2", DEGREE, &["deg/s2", "°/s2", "degs2", "deg/s/s"]),
    (ACCELERATION, "m/s2", "m/s2", 1.0, &["m/s2", "ms2", "m/s/s"]),
    (ACCELERATION, "mm/s2", "m/s2", 1e-3, &["mm/s2"]),
    (TORQUE, "N m", "N m", 1.0, &["nm", "newtonmetre", "newtonmeter", "newtonmeters", "newtonmetres"]),
    (TORQUE, "mN m", "N m", 1e-3, &["mnm", "nmm"]),
    (TORQUE, "N cm", "N m", 1e-2, &["ncm"]),
    (TORQUE, "kN m", "N m", 1e3, &["knm"]),
    (TORQUE, "kgf cm", "N m", 1e-2 * KILOGRAM_FORCE, &["kgfcm", "kgcm", "kpcm"]),
    (TORQUE, "kgf m", "N m", KILOGRAM_FORCE, &["kgfm", "kgm", "kpm"]),
    (TORQUE, "ozf in", "N m", POUND_FORCE / 16.0 * INCH, &["ozfin", "ozin", "inoz"]),
    (TORQUE, "lbf in", "N m", POUND_FORCE * INCH, &["lbfin", "lbin", "inlbf", "inlb"]),
    (TORQUE, "lbf ft", "N m", POUND_FORCE * 12.0 * INCH, &["lbfft", "lbft", "ftlbf", "ftlb"]),
    (TORQUE, "N", "N", 1.0, &["n", "newton", "newtons"]),
    (TORQUE, "kN", "N", 1e3, &["kn"]),
    (TORQUE, AMPERE, AMPERE, 1.0, &["a", "amp", "amps", "ampere", "amperes"]),
    (TORQUE, "mA", AMPERE, 1e-3, &["ma"]),
];

/// Units of time that a line below the names may hold.
const OF_TIME: [&str; 5] = ["s", "sec", "ms", "us", "ns"];

impl Unit {
    /// The unit of a quantity by its text. A velocity of which the name says `deg` alone is in deg/s.
    pub(crate) fn of(text: &str, quantity: usize) -> Option<Unit> {
        let text = bare(text);
        let find = |quantity: usize, text: &str| {
            let row = UNITS.iter().find(|row| row.0 == quantity && row.4.contains(&text))?;
            Some(Unit { symbol: row.1, si: row.2, factor: row.3 })
        };
        find(quantity, &text).or_else(|| match quantity {
            VELOCITY => find(VELOCITY, &format!("{}/s", find(POSITION, &text)?.symbol)),
            _ => None,
        })
    }

    /// The quantity that is in a unit, by its text.
    pub(super) fn quantity(text: &str) -> Option<usize> {
        let text = bare(text);
        UNITS.iter().find(|row| row.4.contains(&text.as_str())).map(|row| row.0)
    }

    /// The units of a quantity, as a list.
    pub(crate) fn symbols(quantity: usize) -> String {
        UNITS.iter().filter(|row| row.0 == quantity).map(|row| row.1).collect::<Vec<_>>().join(", ")
    }

    /// Whether it is one of a motor current.
    pub(crate) fn is_current(self) -> bool {
        self.si == AMPERE
    }
}

/// Whether a text is a unit of anything that a log holds.
pub(crate) fn is_unit(text: &str) -> bool {
    let text = bare(text);
    OF_TIME.contains(&text.as_str()) || UNITS.iter().any(|row| row.4.contains(&text.as_str()))
}

/// A unit in small letters without what stands between its parts: `N·m`, `kgf.cm`, `rad s^-1`.
pub(super) fn bare(text: &str) -> String {
    let between = |letter: &char| !matches!(letter, ' ' | '*' | '·' | '.' | '^' | '_' | '-');
    let plain = |letter: char| match letter {
        'µ' | 'μ' => 'u',
        '²' => '2',
        other => other,
    };
    text.to_lowercase().chars().filter(between).map(plain).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_many_spellings() {
        for (quantity, texts, factor) in [
            (POSITION, &["deg", "Degrees", "Grad", "°"][..], DEGREE),
            (POSITION, &["turns", "rev"], TAU),
            (POSITION, &["mdeg"], 1e-3 * DEGREE),
            (VELOCITY, &["deg/s", "°/s", "dps", "deg s^-1", "deg"], DEGREE),
            (VELOCITY, &["rpm", "1/min", "U/min", "min-1"], TAU / 60.0),
            (VELOCITY, &["rad", "rad/s", "rad s-1", "m/s"], 1.0),
            (ACCELERATION, &["deg/s^2", "deg/s²"], DEGREE),
            (TORQUE, &["Nm", "N m", "N*m", "N·m", "N.m", "N-m", "A"], 1.0),
            (TORQUE, &["mNm", "Nmm", "N mm", "mA"], 1e-3),
            (TORQUE, &["kgf.cm", "kgf cm", "kg-cm", "kgcm"], 0.098_066_5),
            (TORQUE, &["lbf in", "lb-in", "in-lb"], 0.112_984_829),
            (TORQUE, &["ft-lbf", "lb ft"], 1.355_817_948),
            (TORQUE, &["oz-in"], 0.007_061_551_8),
        ] {
            for text in texts {
                let unit = Unit::of(text, quantity).unwrap_or_else(|| panic!("{text}"));
                assert!((unit.factor / factor - 1.0).abs() < 1e-8, "{text}: {unit:?}");
                assert!(is_unit(text));
            }
        }
        for (quantity, text) in [(POSITION, "rad/s"), (POSITION, "Nm"), (TORQUE, "%"), (TORQUE, "rad"), (POSITION, "x")]
        {
            assert_eq!(Unit::of(text, quantity), None, "{text}");
        }
        assert!(is_unit("ms") && !is_unit("elbow") && !is_unit(""));
        assert!(Unit::of("mA", TORQUE).unwrap().is_current() && !Unit::of("N", TORQUE).unwrap().is_current());
    }
}
