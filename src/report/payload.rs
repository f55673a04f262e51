//! The result of `tauscope payload`.

use super::console::{measured, table};
use crate::payload::{Change, Controllers, Estimator, Payload, Quantity, Verdict};

/// The answer for people.
pub(crate) fn text(payload: &Payload) -> String {
    let mut lines = vec![headline(payload), String::new()];
    lines.push(how(payload));
    let numbers = numbers(payload);
    if !numbers.is_empty() {
        let title = format!("load at {}", payload.frame);
        lines.push(String::new());
        lines.push(table(&[&title, "value", "standard error", "unit"], numbers));
        lines.push(format!("{}.", payload.scaled_by));
    }
    let open: Vec<String> = payload.not_determined.iter().map(|text| format!("- {text}")).collect();
    if !open.is_empty() {
        lines.push(String::new());
        lines.push("Not determined by these logs:".into());
        lines.extend(open);
    }
    if !payload.changed.is_empty() {
        lines.push(String::new());
        lines.push("Changed as well between the logs, and taken into account:".into());
        lines.extend(payload.changed.iter().map(|change| {
            let what = match change.what {
                Change::Offset => "torque offset",
                Change::Viscous => "viscous friction",
                Change::Coulomb => "Coulomb friction",
            };
            format!("- {}: {what} by {} {}", change.joint, both(&change.change), change.unit)
        }));
    }
    lines.push(String::new());
    lines.push(joints(payload));
    lines.extend(payload.notes.iter().map(|note| format!("Note: {note}.")));
    if let Some(controllers) = &payload.controllers {
        lines.push(String::new());
        lines.extend(formats(payload, controllers));
    }
    if let Some(expected) = &payload.expected {
        lines.push(String::new());
        let word = if expected.agrees { "As expected" } else { "Not as expected" };
        lines.push(format!("{word}: {}.", expected.reasons.join("; ")));
    }
    lines.push(String::new());
    lines.join("\n")
}

/// A load that a diagnosis found, in a sentence or two.
pub(crate) fn weighed(payload: &Payload) -> Vec<String> {
    let number = |quantity: &Option<Quantity>| quantity.as_ref().map_or("not determined".to_owned(), both);
    let load = match &payload.mass_kg {
        None => "Load weighed by itself: these logs do not determine its mass; `tauscope payload` reports what they do determine."
            .to_owned(),
        Some(mass) => format!(
            "Load weighed by itself, as a body that can exist (more by `tauscope payload`): mass {} kg, centre ({}) m in the frame of the \
             {}, {}.",
            both(mass),
            payload.center_m.each_ref().map(number).join(", "),
            payload.frame,
            payload.scaled_by
        ),
    };
    [load].into_iter().chain(payload.disagreement().map(|text| format!("Note: {text}."))).collect()
}

fn headline(payload: &Payload) -> String {
    match (payload.verdict, &payload.mass_kg, payload.mass_below_kg) {
        (Verdict::Load, Some(mass), _) => format!("Verdict: a load of {} kg was added", both(mass)),
        (Verdict::NoLoad, _, Some(limit)) => {
            format!("Verdict: no load is found; one above {} kg would have been", rounded(limit, limit))
        }
        (Verdict::NoLoad, ..) => "Verdict: no load is found".into(),
        (Verdict::LoadOrOffsets, ..) => {
            "Verdict: a load was added, or the torque offsets changed: both explain these logs".into()
        }
        (Verdict::NoBody, ..) => "Verdict: the torques changed, but not as a load on this link changes them".into(),
        _ => "Verdict: something was added, and these logs do not determine its mass".into(),
    }
}

fn how(payload: &Payload) -> String {
    let [before, after] = payload.logs.map(|count| if count == 1 { "1 log".into() } else { format!("{count} logs") });
    let way = match payload.estimator {
        Estimator::Difference => "differences of torque at equal states",
        Estimator::JointFit => "one fit of the arm to all logs and of the load to those after",
    };
    let mut text = format!(
        "From {before} before and {after} after, by {way}; {:.0} % of the states after have an equal one before. Standard errors are \
         between {} blocks and between logs.",
        100.0 * payload.matched_share,
        payload.blocks
    );
    if let Some(other) = &payload.other {
        let name = match other.estimator {
            Estimator::Difference => "Differences at equal states",
            Estimator::JointFit => "One fit to all logs",
        };
        let mass = other.mass_kg.map_or("no mass".to_owned(), |mass| format!("{} kg", both(&mass)));
        text += &format!(
            " {name} would give {mass} (uncertainty of the load's torque {} against {}).",
            rounded(other.uncertainty, other.uncertainty),
            rounded(payload.uncertainty, payload.uncertainty)
        );
    }
    text
}

/// The determined numbers, those about the frame only where those about the centre are not there.
fn numbers(payload: &Payload) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let mut push = |name: String, quantity: &Option<Quantity>, unit: &str| {
        if let Some(quantity) = quantity {
            let error = quantity.standard_error;
            rows.push(vec![name, rounded(quantity.value, error), rounded(error, error), unit.to_owned()]);
        }
    };
    const AXES: [&str; 3] = ["x", "y", "z"];
    const TENSOR: [&str; 6] = ["xx", "xy", "yy", "xz", "yz", "zz"];
    push("mass".into(), &payload.mass_kg, "kg");
    for (axis, center) in AXES.iter().zip(&payload.center_m) {
        push(format!("centre {axis} in {}", payload.frame), center, "m");
    }
    for ((axis, moment), center) in AXES.iter().zip(&payload.first_moment_kg_m).zip(&payload.center_m) {
        if center.is_none() {
            push(format!("mass times centre {axis} in {}", payload.frame), moment, "kg m");
        }
    }
    for (name, inertia) in TENSOR.iter().zip(&payload.inertia_kg_m2) {
        push(format!("inertia {name} about the centre"), inertia, "kg m2");
    }
    for ((name, about_frame), about_center) in
        TENSOR.iter().zip(&payload.inertia_about_frame_kg_m2).zip(&payload.inertia_kg_m2)
    {
        if about_center.is_none() && payload.mass_kg.is_none() {
            push(format!("inertia {name} about the frame"), about_frame, "kg m2");
        }
    }
    rows
}

fn joints(payload: &Payload) -> String {
    let rows = payload.joints.iter().map(|joint| {
        let share = joint.share.map_or("-".into(), |share| both(&share));
        let small = |value: f64| rounded(value, 0.1 * value);
        vec![joint.joint.clone(), small(joint.load), small(joint.residual), share, joint.unit.into()]
    });
    table(&["joint", "torque of the load, rms", "residual, rms", "share shown", "unit"], rows.collect())
}

fn formats(payload: &Payload, controllers: &Controllers) -> Vec<String> {
    vec![
        format!("For controllers, where the frame of `{}` is the flange as they have it:", payload.frame),
        format!("  Franka Desk  {}", controllers.franka_desk),
        format!("  UR           {}", controllers.ur_set_payload),
        format!("               {}", controllers.ur_set_target_payload),
        format!("  KUKA         {}", controllers.kuka_load),
        format!("  ABB          {}", controllers.abb_loaddata),
    ]
}

/// A number with its standard error.
fn both(quantity: &Quantity) -> String {
    measured(quantity.value, quantity.standard_error)
}

/// A number to two digits of its standard error.
fn rounded(value: f64, error: f64) -> String {
    if !(error.is_finite() && error > 0.0) {
        return format!("{value:.4}");
    }
    let digits = (1.0 - error.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_two_digits_of_their_error() {
        assert_eq!(both(&Quantity { value: 1.23456, standard_error: 0.0234 }), "1.235 +- 0.023");
        assert_eq!(both(&Quantity { value: 123.4, standard_error: 25.0 }), "123 +- 25");
        assert_eq!(rounded(0.5, 0.0), "0.5000");
    }
}
