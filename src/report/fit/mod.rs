//! The result of `tauscope identify`.

mod estimates;
mod held_out;
mod notes;

pub use estimates::estimates;
pub use held_out::{of_another_arm, undetermined_held_out};
pub use notes::{
    between_logs, constants, falling_friction, longer_window, negative_coulomb, negative_rotor, not_of_bodies,
    undetermined, unlike_described,
};

use super::console::{by_joint, column_with_unit, measured, significant, table};
use crate::diagnosis::Estimated;
use crate::identification::consistent::Consistent;
use crate::identification::effect_model::Trust;
use crate::identification::fit::{BetweenLogs, Fitted};
use crate::robot::{Joint, Robot, Unit};
use serde::Serialize;

/// Schema of the `identification.json` that `tauscope identify` writes.
pub const SCHEMA: &str = "tauscope.identify/1";

/// Parameters found, and what they leave.
///
/// ```
/// use tauscope::report::fit::{self, Found};
/// # use tauscope::identification::effect_model::{Preparation, Trust};
/// # use tauscope::identification::fit::{Logs, fit_effects};
/// # use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("tests/reference/payload/before.csv", None)?;
/// # let logs = Logs { train: &[&log], test: &[] };
/// # let fitted = fit_effects(&Model::new(&robot), Trust::Structure, logs, Preparation::usual(&log), Vec::new())?;
///
/// // What `identification.json` holds of a fit.
/// let found = Found { plain: &fitted, extended: None, consistent: None, torque_is_scaled: false };
/// let json = serde_json::to_value(fit::result(&robot, Trust::Structure, found, &[])).expect("it has a JSON form");
/// assert_eq!(json["joints"][1], "j2");
/// assert!(json["without_effects"]["parameters"].as_array().is_some_and(|parameters| parameters.len() > 20));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Serialize)]
pub struct FitResult {
    robot: String,
    joints: Vec<String>,
    /// Units of the joints' efforts and residuals.
    effort_units: Vec<&'static str>,
    trust: Trust,
    /// What had to be done to the logs, and what looks wrong in them.
    notes: Vec<String>,
    without_effects: OneFit,
    #[serde(skip_serializing_if = "Option::is_none")]
    with_effects: Option<OneFit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    consistent: Option<Bodies>,
    /// The effects as a diagnosis estimates them.
    #[serde(skip_serializing_if = "Option::is_none")]
    as_diagnose: Option<Estimated>,
}

impl FitResult {
    /// With the effects as a diagnosis estimates them, where they were estimated so.
    #[must_use]
    pub fn with_estimates(self, as_diagnose: Option<Estimated>) -> Self {
        FitResult { as_diagnose, ..self }
    }
}

/// What `tauscope identify` found.
///
/// ```
/// use tauscope::report::fit::{self, Found};
/// # use tauscope::identification::effect_model::{Preparation, Trust};
/// # use tauscope::identification::fit::{Logs, fit_effects};
/// # use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("tests/reference/payload/before.csv", None)?;
/// # let logs = Logs { train: &[&log], test: &[] };
/// # let fitted = fit_effects(&Model::new(&robot), Trust::Structure, logs, Preparation::usual(&log), Vec::new())?;
///
/// // The tables of a fit without effects, for people.
/// let found = Found { plain: &fitted, extended: None, consistent: None, torque_is_scaled: false };
/// let tables = fit::tables(&robot, found);
/// assert!(tables.contains("j5") && tables.contains("residual"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Found<'a> {
    /// The fit without effects.
    pub plain: &'a Fitted,
    /// The fit with effects.
    pub extended: Option<&'a Fitted>,
    /// Bodies that can exist, of the fit without effects.
    pub consistent: Option<&'a Consistent>,
    /// Whether the logged torques are in another unit than those of the joints.
    pub torque_is_scaled: bool,
}

/// Bodies that can exist, as in `identified.urdf`.
#[derive(Debug, Serialize)]
struct Bodies {
    /// Whether they have the fitted base parameters themselves.
    exact: bool,
    /// Rise of the weighted sum of squared residuals that consistency costs.
    cost: f64,
    /// By which the best possible cost is lower at most.
    gap: f64,
    train_rms_nm: Vec<f64>,
    test_rms_nm: Vec<f64>,
    links: Vec<Link>,
}

#[derive(Debug, Serialize)]
struct Link {
    link: String,
    mass_kg: f64,
    center_m: [f64; 3],
    /// About the centre of mass, ascending.
    principal_moments_kg_m2: [f64; 3],
    rotor_inertia_kg_m2: f64,
    viscous_nm_s_rad: f64,
    coulomb_nm: f64,
    /// Units of the last three on this joint.
    drive_units: [&'static str; 3],
}

/// One fit.
#[derive(Debug, Serialize)]
struct OneFit {
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
    /// Whether the value is at a bound of what makes sense; it then has no standard deviation.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    at_bound: bool,
    /// Whether the value is the description's because the logs do not separate it from others; it then has no standard deviation.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    undetermined: bool,
    /// The parameter in each of several training logs, all others being common.
    #[serde(skip_serializing_if = "Option::is_none")]
    between_logs: Option<BetweenLogs>,
}

/// The content of `identification.json`.
pub fn result(robot: &Robot, trust: Trust, found: Found, notes: &[String]) -> FitResult {
    FitResult {
        robot: robot.name.clone(),
        joints: robot.joint_names(),
        effort_units: robot.effort_units(),
        trust,
        notes: notes.to_vec(),
        without_effects: one_fit(robot, found.plain),
        with_effects: found.extended.map(|fitted| one_fit(robot, fitted)),
        consistent: found.consistent.map(|consistent| bodies(robot, consistent)),
        as_diagnose: None,
    }
}

fn bodies(robot: &Robot, consistent: &Consistent) -> Bodies {
    let link = |joint: &Joint| {
        let mut moments: Vec<f64> =
            joint.inertia.tensor_about_center().symmetric_eigenvalues().iter().copied().collect();
        moments.sort_by(f64::total_cmp);
        Link {
            link: joint.link.clone(),
            mass_kg: joint.inertia.mass(),
            center_m: joint.inertia.center_of_mass().into(),
            principal_moments_kg_m2: [moments[0], moments[1], moments[2]],
            rotor_inertia_kg_m2: joint.drive.armature,
            viscous_nm_s_rad: joint.drive.viscous,
            coulomb_nm: joint.drive.coulomb,
            drive_units: [Unit::Inertia, Unit::Damping, Unit::Effort].map(|unit| joint.kind.unit(unit)),
        }
    };
    Bodies {
        exact: consistent.exact,
        cost: consistent.cost,
        gap: consistent.gap,
        train_rms_nm: consistent.train_rms.clone(),
        test_rms_nm: consistent.test_rms.clone(),
        links: consistent.robot(robot).joints.iter().map(link).collect(),
    }
}

fn one_fit(robot: &Robot, fitted: &Fitted) -> OneFit {
    let estimate = &fitted.fit.estimate;
    let (std, intervals) = (estimate.std(), estimate.intervals());
    let value = |index: usize, name: String, unit: String| Value {
        name,
        unit,
        value: estimate.beta[index],
        std: std[index],
        interval_95: intervals[index],
        at_bound: fitted.fit.at_bound[index],
        undetermined: fitted.fit.undetermined[index],
        between_logs: fitted.fit.between_logs[index].clone(),
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
                value(index, parameter.name.to_owned(), placed.unit(k, robot).to_owned())
            })
            .collect(),
    });
    OneFit {
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

/// Sum of the squares that a fit leaves on joints of so many rows, with their residuals and the standard deviations of their noise: each
/// over its variance. A joint without an equation has no rows, and no residual.
fn weighted_squares(joints: impl Iterator<Item = (usize, f64, f64)>) -> f64 {
    joints
        .filter(|(rows, _, sigma)| *rows > 0 && *sigma > 0.0)
        .map(|(rows, left, sigma)| rows as f64 * (left / sigma).powi(2))
        .sum()
}

/// What is added to a sum, with its share of the sum before; nothing is no measure of it.
fn added(amount: f64, before: f64) -> String {
    let share = (before > 0.0).then(|| format!(" ({} %)", significant(100.0 * amount / before)));
    significant(amount) + &share.unwrap_or_default()
}

/// Place of a joint's parameter among those of a fit, by its symbol: a sum is called by its first part.
fn place_of(fitted: &Fitted, joint: usize, symbol: &str) -> Option<usize> {
    let name = format!("{symbol}{}", joint + 1);
    fitted.fit.names.iter().position(|own| own.split_whitespace().next() == Some(name.as_str()))
}

/// A table of the friction and, where it stands alone, the rotor of every joint, with standard deviations.
fn drives(robot: &Robot, fitted: &Fitted) -> String {
    let std = fitted.fit.estimate.std();
    let cell = |joint: usize, symbol: &str| {
        let Some(index) = place_of(fitted, joint, symbol) else { return "-".to_owned() };
        let value = significant(fitted.fit.estimate.beta[index]);
        match (fitted.fit.undetermined[index], fitted.fit.at_bound[index]) {
            (true, _) => format!("{value} (as described)"),
            (_, true) => format!("{value} (at its bound)"),
            _ => measured(fitted.fit.estimate.beta[index], std[index]),
        }
    };
    let columns = [
        ("Fv", "viscous friction", Unit::Damping),
        ("Fc", "Coulomb friction", Unit::Effort),
        ("Ia", "rotor inertia", Unit::Inertia),
    ];
    let columns = columns.map(|(symbol, what, unit)| (symbol, column_with_unit(Some(robot), what, unit)));
    let headers = columns.iter().map(|(_, (header, _))| header.clone());
    let header: Vec<String> = std::iter::once("identified".to_owned()).chain(headers).collect();
    let in_unit = |value: String, unit: &str| if value == "-" { value } else { value + unit };
    let mut rows: Vec<Vec<String>> = (0..robot.dof())
        .map(|joint| {
            let cells = columns.iter().map(|(symbol, (_, units))| in_unit(cell(joint, symbol), &units[joint]));
            std::iter::once(robot.joints[joint].name.clone()).chain(cells).collect()
        })
        .collect();
    let mut header: Vec<&str> = header.iter().map(String::as_str).collect();
    // Rotors that are in sums with their links' inertias alone are no column.
    if rows.iter().all(|row| row[3] == "-") {
        header.pop();
        rows.iter_mut().for_each(|row| row.truncate(3));
    }
    table(&header, rows)
}

/// Tables for people: the residual of each joint, its drive, and the effects' parameters.
pub fn tables(robot: &Robot, found: Found) -> String {
    let Found { plain, extended, consistent, .. } = found;
    let (unit, names) = by_joint(robot);
    let unit = if found.torque_is_scaled { "unit of the log" } else { unit };
    let title = format!("residual rms, {unit}");
    let mut header = vec![title.as_str(), "training"];
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
    if consistent.is_some() {
        header.push("training, consistent");
        if held_out {
            header.push("held-out, consistent");
        }
    }
    let rows = names
        .into_iter()
        .enumerate()
        .map(|(j, name)| {
            let columns = [Some(plain), extended].into_iter().flatten();
            let numbers = columns.map(|fitted| [&fitted.train_rms, &fitted.test_rms]);
            let numbers = numbers.chain(consistent.map(|found| [&found.train_rms, &found.test_rms]));
            let numbers = numbers.flat_map(|[train, test]| [train.get(j), test.get(j)]).flatten();
            [name].into_iter().chain(numbers.map(|&value| significant(value))).collect()
        })
        .collect();
    let mut text = table(&header, rows);
    if let Some(found) = consistent {
        let cost = match found.exact {
            true => "bodies that can exist have the fitted base parameters: consistency costs nothing".to_owned(),
            false => {
                let estimate = &plain.fit.estimate;
                let joints = estimate.rows.iter().zip(&plain.train_rms).zip(&estimate.sigma);
                let before = weighted_squares(joints.map(|((rows, left), sigma)| (*rows, *left, *sigma)));
                format!(
                    "no bodies that can exist have the fitted base parameters; the nearest raise the weighted sum of squared \
                     residuals by {}",
                    added(found.cost, before)
                )
            }
        };
        text += &format!("\n\nidentified.urdf: {cost}");
    }
    text += &format!("\n\n{}", drives(robot, extended.unwrap_or(plain)));
    if let Some(fitted) = extended {
        let std = fitted.fit.estimate.std();
        let rows: Vec<Vec<String>> = fitted
            .fit
            .places
            .iter()
            .enumerate()
            .filter_map(|(index, place)| {
                let (effect, k) = (*place)?;
                let unit = fitted.placed[effect].unit(k, robot);
                let value = fitted.fit.estimate.beta[index];
                Some(vec![
                    fitted.fit.names[index].clone(),
                    significant(value),
                    if fitted.fit.at_bound[index] { "at its bound".to_owned() } else { significant(std[index]) },
                    unit.to_owned(),
                ])
            })
            .collect();
        text += &format!("\n\n{}", table(&["effect", "value", "std", "unit"], rows));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_without_an_equation_is_no_part_of_a_sum() {
        let before = weighted_squares([(10, 2.0, 1.0), (0, f64::NAN, 1.0), (5, 0.0, 0.0)].into_iter());
        assert_eq!((before, added(2.0, before)), (40.0, "2.00 (5.00 %)".to_owned()));
        assert_eq!([added(2.0, 0.0), added(2.0, f64::NAN)], ["2.00", "2.00"]);
    }
}
