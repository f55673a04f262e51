//! Which parameters of the arm are taken from its description, as options give it.

use crate::identification::effect_model::Trust;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Reads a [`Trust`] by its name.
pub(crate) fn parser() -> impl TypedValueParser<Value = Trust> {
    let nominal = "Inertias are taken from the URDF; friction and rotor inertia of every joint are fitted";
    let structure =
        "Inertias are estimated: only the geometry is taken from the URDF, and all base parameters are fitted";
    let values = [("nominal", nominal), ("structure", structure)];
    let values = PossibleValuesParser::new(values.map(|(name, help)| PossibleValue::new(name).help(help)));
    values.map(|name| if name == "nominal" { Trust::Nominal } else { Trust::Structure })
}
