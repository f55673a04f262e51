//! Units at the edge of a log's file.

use crate::recording::{INCH, KILOGRAM_FORCE, POUND_FORCE};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::f64::consts::{PI, TAU};
use std::fmt;
use std::marker::PhantomData;

/// A unit for all joints, or one each.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum OfJoints<T> {
    All(T),
    Each(Vec<T>),
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OfJoints<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Either<T> {
            type Value = OfJoints<T>;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("a unit, or a list of one unit per joint")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                T::deserialize(text.into_deserializer()).map(OfJoints::All)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(OfJoints::Each)
            }
        }
        deserializer.deserialize_any(Either(PhantomData))
    }
}

/// Unit of time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[allow(missing_docs, reason = "a unit says what it is")]
pub enum TimeUnit {
    #[default]
    #[serde(rename = "s")]
    Second,
    #[serde(rename = "ms")]
    Millisecond,
    #[serde(rename = "us")]
    Microsecond,
    #[serde(rename = "ns")]
    Nanosecond,
}

/// Unit of positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[allow(missing_docs, reason = "a unit says what it is")]
pub enum PositionUnit {
    #[default]
    #[serde(rename = "rad", alias = "m")]
    Si,
    #[serde(rename = "deg")]
    Degree,
    #[serde(rename = "mrad", alias = "mm")]
    Thousandth,
    #[serde(rename = "um")]
    Millionth,
    #[serde(rename = "rev")]
    Turn,
}

/// Unit of velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[allow(missing_docs, reason = "a unit says what it is")]
pub enum VelocityUnit {
    #[default]
    #[serde(rename = "rad/s", alias = "m/s")]
    Si,
    #[serde(rename = "deg/s")]
    Degree,
    #[serde(rename = "mrad/s", alias = "mm/s")]
    Thousandth,
    #[serde(rename = "um/s")]
    Millionth,
    #[serde(rename = "rpm")]
    Rpm,
    #[serde(rename = "rev/s")]
    Turn,
}

/// Unit of accelerations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub(super) enum AccelerationUnit {
    #[default]
    #[serde(rename = "rad/s2", alias = "m/s2")]
    Si,
    #[serde(rename = "deg/s2")]
    Degree,
}

/// Unit of torques, or of the currents they are made from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[allow(missing_docs, reason = "a unit says what it is")]
pub enum TorqueUnit {
    #[default]
    #[serde(rename = "Nm", alias = "N m", alias = "N")]
    Si,
    #[serde(rename = "mNm", alias = "mN m", alias = "Nmm", alias = "N mm")]
    Millinewton,
    #[serde(rename = "kNm", alias = "kN m")]
    Kilonewton,
    #[serde(rename = "kgf cm", alias = "kgf.cm", alias = "kg cm")]
    KilogramForceCentimetre,
    #[serde(rename = "kgf m", alias = "kgf.m", alias = "kg m")]
    KilogramForceMetre,
    #[serde(rename = "ozf in", alias = "ozf.in", alias = "oz in")]
    OunceForceInch,
    #[serde(rename = "lbf in", alias = "lbf.in", alias = "lb in")]
    PoundForceInch,
    #[serde(rename = "lbf ft", alias = "lbf.ft", alias = "lb ft", alias = "ft lbf")]
    PoundForceFoot,
    #[serde(rename = "A")]
    Ampere,
    #[serde(rename = "mA")]
    Milliampere,
}

impl TimeUnit {
    /// Seconds per unit.
    pub fn factor(self) -> f64 {
        match self {
            TimeUnit::Second => 1.0,
            TimeUnit::Millisecond => 1e-3,
            TimeUnit::Microsecond => 1e-6,
            TimeUnit::Nanosecond => 1e-9,
        }
    }
}

impl PositionUnit {
    /// Radians or metres per unit.
    pub fn factor(self) -> f64 {
        match self {
            PositionUnit::Si => 1.0,
            PositionUnit::Degree => PI / 180.0,
            PositionUnit::Thousandth => 1e-3,
            PositionUnit::Millionth => 1e-6,
            PositionUnit::Turn => TAU,
        }
    }
}

impl VelocityUnit {
    /// Radians or metres per second and unit.
    pub fn factor(self) -> f64 {
        match self {
            VelocityUnit::Si => 1.0,
            VelocityUnit::Degree => PI / 180.0,
            VelocityUnit::Thousandth => 1e-3,
            VelocityUnit::Millionth => 1e-6,
            VelocityUnit::Rpm => TAU / 60.0,
            VelocityUnit::Turn => TAU,
        }
    }
}

impl AccelerationUnit {
    /// Radians or metres per second squared and unit.
    pub(super) fn factor(self) -> f64 {
        match self {
            AccelerationUnit::Si => 1.0,
            AccelerationUnit::Degree => PI / 180.0,
        }
    }
}

impl TorqueUnit {
    /// Newton metres (or newtons), or amperes, per unit.
    pub fn factor(self) -> f64 {
        match self {
            TorqueUnit::Si | TorqueUnit::Ampere => 1.0,
            TorqueUnit::Millinewton | TorqueUnit::Milliampere => 1e-3,
            TorqueUnit::Kilonewton => 1e3,
            TorqueUnit::KilogramForceCentimetre => 1e-2 * KILOGRAM_FORCE,
            TorqueUnit::KilogramForceMetre => KILOGRAM_FORCE,
            TorqueUnit::OunceForceInch => POUND_FORCE / 16.0 * INCH,
            TorqueUnit::PoundForceInch => POUND_FORCE * INCH,
            TorqueUnit::PoundForceFoot => POUND_FORCE * 12.0 * INCH,
        }
    }

    /// Whether it is a current.
    pub fn is_current(self) -> bool {
        matches!(self, TorqueUnit::Ampere | TorqueUnit::Milliampere)
    }
}
