//! The result of `tauscope identify`.

use super::console::{significant, table};
use crate::identification::effect_model::Trust;
use crate::identification::fit::Fitted;
use crate::robot::Robot;
use serde::Serialize;

/// Schema of the `identification.json` that `tauscope identify` writes.
pub const SCHEMA: &str = "tauscope.identify/1";

/// Parameters found, and what they leave.
#[derive(Debug, Serialize)]
pub struct FitResult {
    robot: String,
    joints: Vec<String>,
    trust: Trust,
    without_effects: Side,
    #[serde(skip_serializing_if = "Option::is_none")]
    with_effects: Option<Side>,
}

/// One fit.
#[derive(Debug, Serialize)]
struct Side {
    condition_number: f64,
    rows: Vec<usize>,
    train_rms_nm: Vec<f64>,
    test_rms_nm: Vec<f64>,
    parameters: Vec<Value>,
    effects: Vec<EffectValues>,
}

#[derive(Debug, Serialize)]
struct EffectValues {
    effect: &'static str,
    joints: Vec<String>,
    parameters: Vec<Value>,
}

#[derive(Debug, Serialize)]
struct Value {
    name: String,
    unit: String,
    value: f64,
    std: f64,
    interval_95: [f64; 2],
}

/// The content of `identification.json`.
pub fn result(robot: &Robot, trust: Trust, plain: &Fitted, extended: Option<&Fitted>) -> FitResult {
    FitResult {
        robot: robot.name.clone(),
        joints: robot.joint_names(),
        trust,
        without_effects: side(robot, plain),
        with_effects: extended.map(|fitted| side(robot, fitted)),
    }
}

fn side(robot: &Robot, fitted: &Fitted) -> Side {
    let estimate = &fitted.fit.estimate;
    let (std, intervals) = (estimate.std(), estimate.intervals());
    let value = |index: usize, name: String, unit: String| Value {
        name,
        unit,
        value: estimate.beta[index],
        std: std[index],
        interval_95: intervals[index],
    };
    let places = || fitted.fit.places.iter().enumerate();
    let arm = places().filter(|(_, place)| place.is_none());
    let effects = fitted.placed.iter().enumerate().map(|(effect, placed)| EffectValues {
        effect: placed.effect.about().name,
        joints: placed.joints().into_iter().map(|joint| robot.joints[joint].name.clone()).collect(),
        parameters: places()
            .filter_map(|(index, place)| place.filter(|(owner, _)| *owner == effect).map(|(_, k)| (index, k)))
            .map(|(index, k)| {
                let parameter = &placed.effect.parameters()[k];
                value(index, parameter.name.to_owned(), parameter.unit.to_owned())
            })
            .collect(),
    });
    Side {
        condition_number: estimate.condition_number,
        rows: estimate.rows.clone(),
        train_rms_nm: fitted.train_rms.clone(),
        test_rms_nm: fitted.test_rms.clone(),
        parameters: arm
            .map(|(index, _)| value(index, fitted.fit.names[index].clone(), fitted.fit.arm_units[index].to_owned()))
            .collect(),
        effects: effects.collect(),
    }
}

/// Tables for people: what is left per joint, and the effects' parameters.
pub fn tables(robot: &Robot, plain: &Fitted, extended: Option<&Fitted>) -> String {
    let mut header = vec!["residual rms, N m", "training"];
    let held_out = !plain.test_rms.is_empty();
    if held_out {
        header.push("held-out");
    }
    if extended.is_some() {
        header.push("training with effects");
        if held_out {
            header.push("held-out with effects");
        }
    }
    let rows = robot
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let columns = [Some(plain), extended].into_iter().flatten();
            let numbers = columns.flat_map(|fitted| [fitted.train_rms.get(j), fitted.test_rms.get(j)]).flatten();
            [joint.name.clone()].into_iter().chain(numbers.map(|&value| significant(value))).collect()
        })
        .collect();
    let mut text = table(&header, rows).to_string();
    if let Some(fitted) = extended {
        let std = fitted.fit.estimate.std();
        let rows: Vec<Vec<String>> = fitted
            .fit
            .places
            .iter()
            .enumerate()
            .filter_map(|(index, place)| {
                let (effect, k) = (*place)?;
                let unit = fitted.placed[effect].effect.parameters()[k].unit;
                let value = fitted.fit.estimate.beta[index];
                Some(vec![
                    fitted.fit.names[index].clone(),
                    significant(value),
                    significant(std[index]),
                    unit.to_owned(),
                ])
            })
            .collect();
        text += &format!("\n\n{}", table(&["effect", "value", "std", "unit"], rows));
    }
    text
}
