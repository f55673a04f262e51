//! The load that is expected, and whether the one found agrees.

use super::answer::{Comparison, Payload, Quantity, Verdict};
use crate::error::{Error, Result};
use serde::Deserialize;
use std::path::Path;

/// Standard errors by which mass and centre may differ where no tolerance is given.
const DEVIATIONS: f64 = 2.0;

/// Share of the expected mass by which it may differ besides: torque constants are known no better.
const OF_THE_MASS: f64 = 0.05;

/// Largest standard error of a mass over the expected one that can still confirm it: less than a third separates it from none.
const CONFIRMS: f64 = 0.3;

/// A load that is expected.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::Expected;
///
/// // A mass, as on the command line, or with tolerances of one's own.
/// assert_eq!(Expected::read("1.5")?, Expected::mass(1.5)?);
/// let exact = Expected { tolerance_kg: Some(0.02), center_m: Some([0.0, 0.0, 0.09]), ..Expected::mass(1.5)? };
/// assert_eq!(exact.tolerance_m, None);
/// assert!(Expected::mass(-1.0).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expected {
    /// Mass, kg; zero where no load is expected.
    pub mass_kg: f64,
    /// By how much the mass may differ, kg. Default: two standard errors and 5 %.
    pub tolerance_kg: Option<f64>,
    /// Centre of mass in the frame of the load, m.
    pub center_m: Option<[f64; 3]>,
    /// By how much each coordinate of the centre may differ, m. Default: two standard errors.
    pub tolerance_m: Option<f64>,
}

impl Expected {
    /// A load of so large a mass.
    ///
    /// # Errors
    /// A mass below zero or not finite.
    pub fn mass(mass_kg: f64) -> Result<Self> {
        let expected = Expected { mass_kg, tolerance_kg: None, center_m: None, tolerance_m: None };
        expected.check().map_err(|problem| Error::request("--expect", problem))?;
        Ok(expected)
    }

    /// A mass in kg as a number, or a file with `mass_kg` and, where wanted, `tolerance_kg`, `center_m`, `tolerance_m`.
    ///
    /// # Errors
    /// Neither a number nor a file that can be read; numbers of no load.
    pub fn read(text: &str) -> Result<Self> {
        if let Ok(mass) = text.trim().parse::<f64>() {
            return Expected::mass(mass);
        }
        let path = Path::new(text);
        let content = std::fs::read_to_string(path).map_err(|source| {
            Error::io(path, "read the expected load (give a mass in kg, or a TOML file with mass_kg)", source)
        })?;
        let expected: Expected = toml::from_str(&content).map_err(|error| Error::toml(path, &content, &error))?;
        expected.check().map_err(|problem| Error::input(path, None, "expected load", problem))?;
        Ok(expected)
    }

    fn check(&self) -> std::result::Result<(), String> {
        let sizes = [Some(self.mass_kg), self.tolerance_kg, self.tolerance_m];
        if let Some(bad) = sizes.into_iter().flatten().find(|value| !(value.is_finite() && *value >= 0.0)) {
            return Err(format!("{bad} must be a number of zero or more"));
        }
        if self.center_m.iter().flatten().any(|value| !value.is_finite()) {
            return Err("center_m must be three finite numbers".into());
        }
        Ok(())
    }

    /// The load found against this one.
    pub(super) fn compare(&self, found: &Payload) -> Comparison {
        let mut reasons = Vec::new();
        let mut agrees = true;
        let mass = found.mass_kg.or(found.raw_mass);
        let error = mass.map_or(0.0, |mass| mass.standard_error);
        let tolerance_kg = self.tolerance_kg.unwrap_or(DEVIATIONS * error + OF_THE_MASS * self.mass_kg);
        match mass {
            // None is expected and none is found: that is decided with care for chance.
            Some(_) if self.mass_kg == 0.0 && self.tolerance_kg.is_none() && found.verdict == Verdict::NoLoad => {
                reasons.push("no load is expected, and none is found".into());
            }
            Some(Quantity { value, standard_error })
                if self.mass_kg == 0.0 || standard_error <= CONFIRMS * self.mass_kg =>
            {
                let off = (value - self.mass_kg).abs();
                let word = if off <= tolerance_kg { "agrees" } else { "differs" };
                agrees &= off <= tolerance_kg;
                reasons.push(format!(
                    "mass {word}: {value:.4} kg, expected {} kg, off by {off:.4} kg of {tolerance_kg:.4} kg allowed",
                    self.mass_kg
                ));
            }
            _ => {
                agrees = false;
                reasons.push("the logs do not determine the mass well enough to confirm it".into());
            }
        }
        for (axis, expected) in self.center_m.iter().flatten().enumerate() {
            let name = ["x", "y", "z"][axis];
            match found.center_m[axis] {
                Some(Quantity { value, standard_error }) => {
                    let allowed = self.tolerance_m.unwrap_or(DEVIATIONS * standard_error);
                    let off = (value - expected).abs();
                    agrees &= off <= allowed;
                    let word = if off <= allowed { "agrees" } else { "differs" };
                    reasons.push(format!(
                        "centre along {name} {word}: {value:.4} m, expected {expected} m, off by {off:.4} m of {allowed:.4} m allowed"
                    ));
                }
                None => {
                    agrees = false;
                    reasons.push(format!("the logs do not determine the centre along {name}"));
                }
            }
        }
        Comparison { mass_kg: self.mass_kg, tolerance_kg, agrees, reasons }
    }
}
