//! `tauscope effects`: the catalogue of physical effects.

use crate::cli::shared::{DONE, Global, print};
use crate::effects::{self, About, Effect, Hidden, LIBRARY, Parameter, Scope};
use crate::error::Result;
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use serde::Serialize;

/// Schema of the catalogue as JSON.
pub(crate) const EFFECTS_SCHEMA: &str = "tauscope.effects/1";

/// Arguments of `tauscope effects`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope effects stribeck_friction")]
pub(crate) struct Arguments {
    /// Effect to describe. Default: all are listed.
    name: Option<String>,
}

/// The catalogue as JSON. Bounds that are infinite are null.
#[derive(Serialize)]
struct Catalogue {
    effects: Vec<Entry>,
}

/// One effect: its entry in the catalogue, and its parameters.
#[derive(Serialize)]
struct Entry {
    #[serde(flatten)]
    about: &'static About,
    parameters: &'static [Parameter],
}

/// Prints the catalogue, or one entry of it.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let chosen = arguments.name.as_deref().map(effects::find).transpose()?;
    let shown = chosen.map_or(LIBRARY.to_vec(), |effect| vec![effect]);
    let entry = |effect: &&'static dyn Effect| Entry { about: effect.about(), parameters: effect.parameters() };
    let catalogue = Catalogue { effects: shown.iter().map(entry).collect() };
    print::result(global, EFFECTS_SCHEMA, &catalogue, || chosen.map_or_else(list, describe))?;
    Ok(DONE)
}

/// All effects, one line each.
fn list() -> String {
    let mut table = table(&["effect", "acts on", "placed on", "equation"]);
    for effect in LIBRARY {
        let about = effect.about();
        table.add_row([about.name, &word(about.site), place(about.scope), about.equation]);
    }
    format!("{table}\n\n`tauscope effects NAME` describes one of them.")
}

/// Everything about one effect.
fn describe(effect: &dyn Effect) -> String {
    let about = effect.about();
    let mut parameters = table(&["parameter", "symbol", "unit", "role", "lowest", "highest", "typical"]);
    for parameter in effect.parameters() {
        parameters.add_row([
            parameter.name,
            parameter.symbol,
            parameter.unit.name(),
            &word(parameter.role),
            &number(parameter.lower),
            &number(parameter.upper),
            &number(parameter.typical),
        ]);
    }
    for column in parameters.column_iter_mut().skip(4) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let mut rivals = table(&["similar to", "how to separate"]);
    for rival in about.rivals {
        rivals.add_row([rival.name, rival.how_to_tell]);
    }
    let hidden = match about.hidden_by_base_parameters {
        Hidden::No => "",
        Hidden::InPart => {
            "\n\nRe-identified inertial parameters hide a part of it; all of it shows against trusted inertias or a reference log."
        }
        Hidden::Wholly => {
            "\n\nRe-identified inertial parameters hide it; it shows against trusted inertias or a reference log."
        }
    };
    format!(
        "{}: acts on the {}, placed on {}\n\n  {}\n\n{}{hidden}\n\n{parameters}\n\n{rivals}\n\nReference: {}",
        about.name,
        word(about.site),
        place(about.scope),
        about.equation,
        about.explanation,
        about.reference,
    )
}

fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled).set_header(header);
    table
}

/// How results spell a variant: "amplitude".
fn word(variant: impl Serialize) -> String {
    serde_json::to_value(variant).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
}

/// Where an effect can be placed, in words.
fn place(scope: Scope) -> &'static str {
    match scope {
        Scope::Joint => "a joint",
        Scope::Pair => "a joint and the next",
        Scope::Arm => "the whole arm",
    }
}

/// A number to six digits; a dash where there is no bound.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    let exponential = format!("{value:.5e}");
    let rounded: f64 = exponential.parse().unwrap_or(value);
    if rounded != 0.0 && rounded.abs() < 1e-3 { format!("{rounded:e}") } else { format!("{rounded}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn describes_all_that_an_effect_holds() {
        let effect = effects::find("stribeck_friction").unwrap();
        let text = describe(effect);
        let about = effect.about();
        for part in [about.equation, about.explanation, about.reference, "amplitude", "shape", "held", "rad/s"] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        for rival in about.rivals {
            assert!(text.contains(rival.name) && text.contains(rival.how_to_tell));
        }
    }

    #[test]
    fn lists_every_effect() {
        let text = list();
        for effect in LIBRARY {
            assert!(text.contains(effect.about().name) && text.contains(effect.about().equation));
        }
    }

    #[test]
    fn numbers_are_short() {
        let shown = [0.0, 0.05, -std::f64::consts::PI, 2e-5, 1e4, f64::INFINITY].map(number);
        assert_eq!(shown, ["0", "0.05", "-3.14159", "2e-5", "10000", "-"]);
    }

    #[test]
    fn unknown_names_are_refused_with_the_nearest() {
        let arguments = Arguments { name: Some("stribek".to_owned()) };
        let error = run(&arguments, &Global { quiet: true, ..Global::default() }).unwrap_err().to_string();
        assert!(error.contains("stribeck_friction"), "{error}");
    }
}
