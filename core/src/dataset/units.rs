//! Units at the edge of a log's file.

use crate::recording::Unit;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
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
pub(super) enum TimeUnit {
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

/// Unit of the quantity of this index: that of the names of columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UnitOf<const QUANTITY: usize>(Unit);

impl<'de, const QUANTITY: usize> Deserialize<'de> for UnitOf<QUANTITY> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let unknown =
            || D::Error::custom(format!("unknown unit `{text}`, expected one of {}", Unit::symbols(QUANTITY)));
        Unit::of(&text, QUANTITY).map(UnitOf).ok_or_else(unknown)
    }
}

impl<const QUANTITY: usize> UnitOf<QUANTITY> {
    /// Units of SI, or amperes, per unit.
    pub(super) fn factor(self) -> f64 {
        self.0.factor
    }

    /// Whether it is a current.
    pub(super) fn is_current(self) -> bool {
        self.0.is_current()
    }
}

impl TimeUnit {
    /// Seconds per unit.
    pub(super) fn factor(self) -> f64 {
        match self {
            TimeUnit::Second => 1.0,
            TimeUnit::Millisecond => 1e-3,
            TimeUnit::Microsecond => 1e-6,
            TimeUnit::Nanosecond => 1e-9,
        }
    }
}
