//! Findings on a wrong description.

use super::change::Change;
use super::compare::DISTINCT;
use super::file_gears;
use super::verdict::{Alternative, Shown, Spread, Verdict};
use crate::quality::finding::{Finding, Kind, Severity};
use crate::robot::Robot;
use nalgebra::Vector3;

/// Alternatives that are named; more mean only that the logs do not decide.
const NAMED: usize = 4;

/// Most digits of a percentage by which two shares are printed as different.
const DIGITS: usize = 2;

/// Floors are level, and bases are on them, to within this angle, degrees.
const TILTED_DEG: f64 = 3.0;

/// Factors below this are written as one over their inverse, as ratios of gears are.
const SMALL: f64 = 0.1;

/// What the factor of one torque comes from.
const FACTOR_OF_ONE: &str = "its gear, torque constant or unit is another: [motors] gear_ratio, torque_constant_nm_a";

/// .. and where there are other joints too, which its motor may drive.
const OR_COUPLED: &str =
    "; or motors drive several joints, as by a parallelogram or a wrist's gears: [motors] coupling";

/// How a dataset gives torques before gears.
const BEFORE_GEARS: &str = "[motors] torque_at = \"motor\", gear_ratio";

/// Said where the described bodies do not explain the torques of a changed motion.
const ANOTHER: &str = "the URDF's bodies do not explain the torques with it: is the log that of another robot?";

/// Said where a changed motion is all that is known.
const WITHOUT_MASSES: &str = "the robot's file has no bodies that can exist (masses are missing, or inertias are none of a body), which could tell \
                              the log of another robot with such joints: is it of this one?";

/// Said where a factor is known to within bounds only.
const LOAD: &str = "; a load that is not in the robot's file changes it";

/// Said where a factor leaves much of the torques.
const MUCH_LEFT: &str = "So much is left that another cause is not excluded: motors behind gears that differ, positions in another unit, or another \
                         robot; nothing of this is certain";

/// Said where the joints feel too little of gravity.
const BY_BODIES: &str =
    "these joints feel only a part of gravity, so that its direction is one which the described bodies make likely";

/// A change in words; `joints` are the names.
pub fn words(change: Change, joints: &[String]) -> String {
    let name = |joint: usize| joints[joint].as_str();
    match change {
        Change::TorqueSign(joint) => format!("the torque of {} has the wrong sign", name(joint)),
        Change::AllTorqueSigns => "all torques have the wrong sign".into(),
        Change::TorqueExchange(a, b) => format!("the torques of {} and {} are exchanged", name(a), name(b)),
        Change::JointExchange(a, b) => {
            format!("positions and torques of {} and {} are exchanged", name(a), name(b))
        }
        Change::PositionSign(joint) => format!("the position of {} has the wrong sign", name(joint)),
        Change::AllPositionSigns => "all positions have the wrong sign".into(),
        Change::AxisSign(joint) => format!("position and torque of {} have the wrong sign", name(joint)),
        Change::PositionExchange(a, b) => format!("the positions of {} and {} are exchanged", name(a), name(b)),
        Change::WithoutGravity => "the torque lacks that of gravity: it is gravity-compensated".into(),
        Change::Gravity(gravity) => format!("gravity is along {} of the base", direction(gravity)),
        Change::TorqueScale(factor) => scale(factor),
        Change::JointScale(joint, factor) => {
            let (times, than) = times(factor);
            format!("the torque of {} is about {times} times too {than}", name(joint))
        }
        Change::ZeroOffset(joint, offset) => format!(
            "the zero of {} is another: {:.0} degrees ({offset:.3} rad) must be added to its positions",
            name(joint),
            offset.to_degrees()
        ),
    }
}

/// The changes of a set in words.
fn all_words(changes: &[Change], joints: &[String]) -> String {
    changes.iter().map(|&change| words(change, joints)).collect::<Vec<_>>().join(", and ")
}

fn direction(gravity: [f64; 3]) -> String {
    let along: Vec<usize> = (0..3).filter(|&axis| gravity[axis] != 0.0).collect();
    match along[..] {
        [axis] => format!("{}{}", if gravity[axis] > 0.0 { '+' } else { '-' }, ["x", "y", "z"][axis]),
        _ => format!("[{:.2}, {:.2}, {:.2}] m/s2", gravity[0], gravity[1], gravity[2]),
    }
}

/// How well the logs determine a direction of gravity.
fn spread_words(spread: &Spread) -> String {
    let named = |gravity: &[f64; 3]| direction(*gravity);
    let among = match spread.includes.is_empty() {
        true => String::new(),
        false => format!(", {} among them", spread.includes.iter().map(named).collect::<Vec<_>>().join(" and ")),
    };
    let degrees = spread.degrees;
    match (spread.is_narrow(), among.is_empty()) {
        (true, true) => format!("the logs determine this direction to within {degrees:.0} degrees"),
        (true, false) => format!("directions within {degrees:.0} degrees of this one explain the logs as well{among}"),
        (false, _) => format!(
            "the logs do not determine this direction well: some {} away explain them as well{among}; log a motion between more poses, or give the \
             mounting as measured ([mounting] gravity_m_s2)",
            if degrees.is_finite() { format!("up to {degrees:.0} degrees") } else { "more than 25 degrees".into() }
        ),
    }
}

fn scale(factor: f64) -> String {
    let (times, than) = times(factor);
    let than = if than == "small" { "smaller" } else { "larger" };
    format!("the torques are about {times} times {than} than the URDF's bodies need")
}

/// How many times too small or too large what must be multiplied by a factor is.
fn times(factor: f64) -> (String, &'static str) {
    let (times, than) = if factor > 1.0 { (factor, "small") } else { (1.0 / factor, "large") };
    (about(times), than)
}

/// A factor in as many digits as it is known to.
fn about(factor: f64) -> String {
    match factor {
        f if f >= 10.0 => format!("{f:.0}"),
        f if f >= 1.0 => format!("{f:.1}"),
        f if f >= 0.1 => format!("{f:.2}"),
        f => format!("{f:.1e}"),
    }
}

/// A factor, or its bounds where these are wide.
fn known(factor: f64, bounds: Option<[f64; 2]>) -> String {
    // Torques before gears are parts of those behind them.
    let one = |f: f64| if f < SMALL { format!("1/{}", about(1.0 / f)) } else { about(f) };
    match bounds {
        Some([low, high]) => format!("between {} and {}", one(low), one(high)),
        None => one(factor.abs()),
    }
}

/// The bounds of a scale that all torques share, in words after its size.
fn scale_between([low, high]: [f64; 2]) -> String {
    // Factors are how many times larger the torques are.
    let [low, high] = if high < 1.0 { [1.0 / high, 1.0 / low] } else { [low, high] };
    format!(" (between {} and {} with a load)", about(low), about(high))
}

/// What a scale may come from; the factors of a verdict are those of the joints, one where they share it.
fn origin(factor: f64, verdict: &Verdict, joints: &[String]) -> String {
    let bounds = |place: usize| verdict.factor_bounds.get(place).copied().flatten();
    let load = if verdict.factor_bounds.iter().any(Option::is_some) { LOAD } else { "" };
    let factors = &verdict.factors;
    if factors.len() > 1 {
        let each = factors.iter().zip(joints).enumerate().map(|(place, (f, joint))| match f {
            Some(f) => format!("{joint} {}", known(*f, bounds(place))),
            None => format!("{joint} not known"),
        });
        let each = each.collect::<Vec<_>>().join(", ");
        return format!(
            "the factor differs from joint to joint ({each}{load}): currents, percent, or the motor side of the gears; give \
             [units] torque, [motors] gear_ratio and torque_constant_nm_a in a dataset{OR_COUPLED}. A clock that runs wrong changes the torques of inertia \
             so too: a log without velocities may not show it otherwise. So does the log of another robot"
        );
    }
    let units = [(1e-3, "N mm, which are mN m: [units] torque = \"mNm\""), (1e3, "kN m: [units] torque = \"kNm\"")];
    match units.into_iter().find(|(unit, _)| (0.5..2.0).contains(&(factor / unit))) {
        Some((unit, name)) if unit < 1.0 => format!("they seem to be in {name} in a dataset"),
        unit => {
            let unit = unit.map_or(String::new(), |(_, name)| format!(", or in {name}"));
            // Torques before a gear are smaller.
            let gear = match factor > 1.0 {
                true => {
                    format!(
                        "at the motor side of gears of about {factor:.0} ([motors] torque_at = \"motor\", gear_ratio), "
                    )
                }
                false => String::new(),
            };
            format!(
                "they are one of: {gear}in amperes or percent (torque_constant_nm_a){unit}, or those of another robot{load}"
            )
        }
    }
}

/// Torques before the gears of the robot's file.
fn before_gears(gears: &[f64], joints: &[String]) -> String {
    let each = joints.iter().zip(gears).map(|(joint, gear)| format!("{joint} {gear}")).collect::<Vec<_>>().join(", ");
    format!(
        "the torques are those before the gears which the motors have in the robot's file ({each}): each is too small by about its gear, as the \
         controls and forces of MuJoCo's motors are; {BEFORE_GEARS} = {gears:?} in a dataset"
    )
}

/// The torque constants that make torques of motor currents, or of percent.
fn of_currents(verdict: &Verdict, joints: &[String]) -> String {
    let constants: Vec<Option<f64>> = verdict.factors.iter().map(|factor| factor.map(f64::recip)).collect();
    let unknown: Vec<&str> =
        constants.iter().zip(joints).filter(|(own, _)| own.is_none()).map(|(_, joint)| joint.as_str()).collect();
    let list =
        constants.iter().map(|own| own.map_or_else(|| "?".to_owned(), in_three_digits)).collect::<Vec<_>>().join(", ");
    let unknown = match unknown.is_empty() {
        true => String::new(),
        false => format!("; the motion does not determine that of {}: take it from the data sheet", unknown.join(", ")),
    };
    let load = if verdict.factor_bounds.iter().any(Option::is_some) {
        LOAD.replace("changes it", "changes them")
    } else {
        String::new()
    };
    format!(
        "the torques are motor currents, or percent of rated torques, by their names. The bodies of the URDF need these torque constants at the \
         joints, N m per A or per percent: [units] torque = \"A\", [motors] torque_constant_nm_a = [{list}] in a dataset makes torques of \
         them{unknown}{load}"
    )
}

/// A number in three digits.
fn in_three_digits(value: f64) -> String {
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

/// What shows a change that the residuals do not show.
fn not_by_residuals(shown: Shown, joints: &[String]) -> String {
    match shown {
        Shown::Constant { joint, constant, weight } => format!(
            "the residuals do not show it, but as described the drive of {} would push with a constant {} N, where the bodies on it weigh {} N; \
             only a balancer that is stronger than that could",
            joints[joint],
            about_signed(constant),
            about(weight)
        ),
        Shown::Effort { joint, largest, limit } => format!(
            "the residuals do not show it, but a twentieth of the samples is beyond {}, and the URDF's effort limit of {} is {}; only a \
             heavy rotor and another limit could explain it",
            about(largest),
            joints[joint],
            about(limit)
        ),
    }
}

/// A value with its sign in as many digits as it is known to.
fn about_signed(value: f64) -> String {
    format!("{}{}", if value < 0.0 { "-" } else { "" }, about(value.abs()))
}

/// By how much the residual falls. What changes few of many torques hardly changes their mean: the one that falls most is named then.
fn fall(verdict: &Verdict, joints: &[String]) -> String {
    let [after, before] = apart(verdict.after, verdict.before);
    let text = format!("with that {after} of the torque stays unexplained on parts held out instead of {before}");
    if verdict.before > DISTINCT * verdict.after {
        return text;
    }
    let [before, after] = &verdict.each;
    let each = before
        .iter()
        .zip(after)
        .zip(joints)
        .filter_map(|((before, after), joint)| Some((joint, (*before)?, (*after)?)));
    match each.max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2))) {
        Some((joint, before, after)) if before > DISTINCT * after => {
            let [after, before] = apart(after, before);
            format!("{text}, of that of {joint} {after} instead of {before}")
        }
        _ => text,
    }
}

/// Two shares in the fewest digits in which they differ.
pub(super) fn apart(one: f64, other: f64) -> [String; 2] {
    let with = |digits: usize| [one, other].map(|share| format!("{:.digits$} %", 100.0 * share));
    (0..DIGITS).map(with).find(|[one, other]| one != other).unwrap_or_else(|| with(DIGITS))
}

/// The findings of a verdict: one per change, at its column, with the held-out residual under it and under its alternatives. Gears are those
/// of the file of `robot`.
pub(crate) fn findings(verdict: &Verdict, joints: &[String], robot: Option<&Robot>) -> Vec<Finding> {
    let scale = &verdict.description.torque_scale;
    let gears = robot.map(file_gears::of_file).filter(|gears| file_gears::explain(scale, &verdict.factors, gears));
    let changes = &verdict.description.changes;
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let named = |alternative: &Alternative| {
        format!("{} ({})", all_words(&alternative.changes, joints), percent(alternative.unexplained))
    };
    let gain = match verdict.shown {
        Some(shown) => not_by_residuals(shown, joints),
        None => fall(verdict, joints),
    };
    let gain = if verdict.leaves_much() { format!("{gain}. {MUCH_LEFT}") } else { gain };
    let next = verdict.next.as_ref().map_or(String::new(), |next| format!("; the best other cause: {}", named(next)));
    let next = if verdict.unlike_bodies { format!("{next}; {ANOTHER}") } else { next };
    let next = if verdict.without_bodies { format!("{next}; {WITHOUT_MASSES}") } else { next };
    let next = if verdict.by_bodies { format!("{next}; {BY_BODIES}") } else { next };
    let next = verdict.spread.as_ref().map_or(next.clone(), |spread| format!("{next}; {}", spread_words(spread)));
    let rivals: Vec<String> = verdict.alternatives.iter().take(NAMED).map(named).collect();
    // Positions that were assumed stand for the direction of gravity, and for a zero that would be as good as that.
    let of_held = held_position(verdict, joints, &gain, &rivals);
    let is_of_held = |change: &Change| {
        let alone = changes.len() == 1 && matches!(change, Change::ZeroOffset(..));
        of_held.is_some() && (alone || matches!(change, Change::Gravity(_)))
    };
    let own_changes: Vec<Change> = changes.iter().copied().filter(|change| !is_of_held(change)).collect();
    let of_changes = own_changes
        .iter()
        .enumerate()
        .map(|(place, &change)| {
            let is_current = |other: &Change| verdict.currents && matches!(other, Change::TorqueScale(_));
            let others: Vec<Change> =
                changes.iter().copied().filter(|other| *other != change && !is_current(other)).collect();
            let own = words(change, joints);
            // The first of them holds what is known of all.
            if place > 0 && !matches!(change, Change::TorqueScale(_)) {
                let text = format!("{own} (together with: {})", words(own_changes[0], joints));
                let (kind, place) = kind(change, joints);
                return Finding::new(kind, Severity::Warning, place, text);
            }
            let also = match others.is_empty() {
                true => String::new(),
                false => format!(" (together with: {})", all_words(&others, joints)),
            };
            let own = match (change, &gears) {
                (Change::JointScale(joint, _), Some(gears)) => {
                    format!(
                        "{own} (that is the gear of {} which its motor has in the robot's file: the log has the motor's torque or \
                         control; {BEFORE_GEARS} in a dataset)",
                        gears[joint]
                    )
                }
                (Change::JointScale(..), None) if joints.len() > 1 => format!("{own} ({FACTOR_OF_ONE}{OR_COUPLED})"),
                (Change::JointScale(..), None) => format!("{own} ({FACTOR_OF_ONE})"),
                _ => own,
            };
            let text = match (change, rivals.is_empty()) {
                (Change::TorqueScale(_), _) if verdict.currents => format!("{}; {gain}", of_currents(verdict, joints)),
                (Change::TorqueScale(factor), _) => {
                    let shared = verdict.factor_bounds.first().copied().flatten();
                    let own = match verdict.factors.len() {
                        0 | 1 => own + &shared.map_or(String::new(), scale_between),
                        _ => "the torques are not as large as the URDF's bodies need".into(),
                    };
                    match &gears {
                        Some(gears) => format!("{}; {gain}", before_gears(gears, joints)),
                        None => format!("{own}: {}; {gain}", origin(factor, verdict, joints)),
                    }
                }
                (_, true) => format!("{own}{also}: {gain}{next}"),
                (_, false) => format!(
                    "one of these, which the logs do not separate: {own}{also}; or {}: {gain}{next}",
                    rivals.join("; or ")
                ),
            };
            let (kind, place) = kind(change, joints);
            // Currents that are named as such are no fault.
            let is_note = verdict.currents && matches!(change, Change::TorqueScale(_));
            Finding::new(kind, if is_note { Severity::Note } else { Severity::Warning }, place, text)
        })
        .collect::<Vec<Finding>>();
    of_held.iter().cloned().chain(of_changes).collect()
}

/// What is said of a base that is tilted from `given` gravity a little; none of less than gravity is known to.
pub(crate) fn of_tilt(tilt: Vector3<f64>, given: Vector3<f64>) -> Option<Finding> {
    let degrees = tilt.angle(&given).to_degrees();
    let text = format!(
        "the torques are explained better by gravity along {} of the base: it may be tilted by about {degrees:.0} degrees; `diagnose` estimates that \
         as base_tilt, `identify` takes gravity as described",
        direction(tilt.into())
    );
    (degrees >= TILTED_DEG).then(|| Finding::new(Kind::Mounting, Severity::Note, "gravity", text))
}

/// What is said where joints that carry those under study stand at positions that nobody gave.
fn held_position(verdict: &Verdict, joints: &[String], gain: &str, rivals: &[String]) -> Option<Finding> {
    let first = verdict.assumed.first()?;
    let assumed = crate::robot::shortened(&verdict.assumed);
    let own = all_words(&verdict.description.changes, joints);
    let or = if rivals.is_empty() { String::new() } else { format!("; or {}", rivals.join("; or ")) };
    let text = format!(
        "gravity does not come to these joints as described: the joints that carry them are not in the log, and their positions were assumed, which \
         is the first candidate; log them, or give their positions in a dataset ([hold] {first} = ..). Only if they do stand as assumed: \
         {own}{or}. {}{}",
        gain[..1].to_uppercase(),
        &gain[1..]
    );
    Some(Finding::new(Kind::HeldPosition, Severity::Warning, assumed, text))
}

/// Kind and place of a change.
fn kind(change: Change, joints: &[String]) -> (Kind, String) {
    let column = |quantity: &str, joint: usize| format!("{quantity}{} ({})", joint + 1, joints[joint]);
    match change {
        Change::TorqueSign(joint) => (Kind::TorqueSign, column("tau", joint)),
        Change::AllTorqueSigns => (Kind::TorqueSign, format!("tau1 .. tau{}", joints.len())),
        Change::TorqueExchange(a, _) => (Kind::Swapped, column("tau", a)),
        Change::JointExchange(a, _) | Change::PositionExchange(a, _) => (Kind::Swapped, column("q", a)),
        Change::PositionSign(joint) | Change::AxisSign(joint) => (Kind::PositionSign, column("q", joint)),
        Change::AllPositionSigns => (Kind::PositionSign, format!("q1 .. q{}", joints.len())),
        Change::ZeroOffset(joint, _) => (Kind::PositionZero, column("q", joint)),
        Change::WithoutGravity => (Kind::GravityCompensated, "tau".into()),
        Change::Gravity(_) => (Kind::Mounting, "gravity".into()),
        Change::TorqueScale(_) => (Kind::TorqueUnit, "tau".into()),
        Change::JointScale(joint, _) => (Kind::TorqueUnit, column("tau", joint)),
    }
}

/// Whether a kind of finding is about the description of a log, which a changed description puts right.
pub fn is_description(kind: Kind) -> bool {
    matches!(
        kind,
        Kind::TorqueSign
            | Kind::Swapped
            | Kind::PositionSign
            | Kind::PositionZero
            | Kind::HeldPosition
            | Kind::Mounting
            | Kind::GravityCompensated
    )
}

#[cfg(test)]
mod tests {
    use super::{apart, known, scale_between};

    #[test]
    fn factors_that_a_load_changes_have_bounds() {
        assert_eq!([known(-51.2, None), known(0.02, None)], ["51", "1/50"]);
        assert_eq!(known(51.0, Some([4.21, 51.0])), "between 4.2 and 51");
        assert_eq!(known(0.02, Some([0.02, 0.5])), "between 1/50 and 0.50");
        assert_eq!(scale_between([0.067, 0.125]), " (between 8.0 and 15 with a load)");
        assert_eq!(scale_between([8.0, 15.0]), " (between 8.0 and 15 with a load)");
    }

    #[test]
    fn shares_have_as_many_digits_as_tell_them_apart() {
        assert_eq!(apart(0.01, 0.16), ["1 %", "16 %"]);
        assert_eq!(apart(0.029, 0.034), ["2.9 %", "3.4 %"]);
        assert_eq!(apart(0.0312, 0.0314), ["3.12 %", "3.14 %"]);
    }
}
