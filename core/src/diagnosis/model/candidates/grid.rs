//! Grids of the parameters that are not linear: where shapes and departures of an effect are looked for on a joint.

use super::super::roles::{bends, is_event, is_level, shapes};
use crate::diagnosis::logs::Rows;
use crate::effects::{Effect, Parameter, Placed, Role, Search, varies_by_factors};

/// Points over the range of a shape, alone or one of several, and how far the range reaches to either side of the typical
/// size.
const ALONE: usize = 10;
const ONE_OF_SEVERAL: usize = 6;
const REACH: f64 = 30.0;

/// Shares of the largest logged torque at which it may be cut off: noise alone exceeds the level.
const CUT_OFF: [f64; 6] = [0.99, 0.96, 0.92, 0.87, 0.8, 0.7];

/// Highest speed of a transition at low speed, over the joint's top speed; range of a drift's time constant, over the longest
/// log.
const LOW_SPEED: f64 = 0.3;
const SHORTEST_DRIFT: f64 = 0.1;
const LONGEST_DRIFT: f64 = 3.0;

/// Least distance of a power of speed from one: nearer ones are the same bend of friction over speed, of coefficients that grow
/// beyond any bound.
const APART: f64 = 0.3;

/// Sizes of departures of which the torque is not linear: times as multiples of the typical one, and the compliance of gears by
/// how far they wind up under the largest torque of their joint, rad: gears of a base and of a hand differ by orders of magnitude
/// in all but that.
const TIMES: [f64; 7] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
const TWISTS: [f64; 6] = [1e-4, 4e-4, 1.6e-3, 6.4e-3, 2.5e-2, 0.1];

/// Highest harmonic of a ripple scan, and lengths of contacts, s.
const HIGHEST_HARMONIC: f64 = 60.0;
const CONTACTS_S: [f64; 3] = [1.5, 3.0, 6.0];

/// The effect at one place with every combination of its grids.
pub(super) fn grid(effect: &'static dyn Effect, joint: usize, rows: &Rows) -> Vec<Placed> {
    let typical = Placed::typical(effect, joint);
    if is_event(effect) {
        return contacts(&typical, rows);
    }
    let alone = shapes(effect).len() == 1;
    let mut all = vec![typical];
    for (index, parameter) in effect.parameters().iter().enumerate() {
        let values = match parameter.role {
            Role::Amplitude | Role::Held => continue,
            Role::Departure => departures(effect, index, joint, rows),
            Role::Shape => {
                let grid = shape_grid(effect, index, alone, joint, rows);
                grid.into_iter().map(|value| within_bounds(effect, index, value, joint, rows)).collect()
            }
        };
        all = all
            .into_iter()
            .flat_map(|placed| {
                values.iter().map(move |&value| {
                    let mut placed = placed.clone();
                    placed.parameters[index] = value;
                    placed
                })
            })
            .collect();
    }
    all
}

/// Effects in the log's timing bend with their size; the others are straight as far as one looks.
fn departures(effect: &dyn Effect, index: usize, joint: usize, rows: &Rows) -> Vec<f64> {
    let parameter = &effect.parameters()[index];
    if is_level(effect) {
        let largest = largest_torque(rows, joint);
        return CUT_OFF.iter().map(|share| share * largest).filter(|level| *level > 0.0).collect();
    }
    if !bends(effect, index) {
        return vec![parameter.typical];
    }
    let sizes = sizes(effect, index, joint, rows);
    let negative = sizes.iter().map(|size| -size);
    negative.chain(sizes.iter().copied()).filter(|size| (parameter.lower..=parameter.upper).contains(size)).collect()
}

/// Sizes at which the columns of a departure that bends are taken on a joint, without signs, the smallest first: below that one
/// the torque is as good as straight in it.
pub(crate) fn sizes(effect: &dyn Effect, index: usize, joint: usize, rows: &Rows) -> Vec<f64> {
    let parameter = &effect.parameters()[index];
    if effect.search(index) == Search::Compliance {
        return compliances(parameter, largest_torque(rows, joint));
    }
    TIMES.iter().map(|multiple| multiple * parameter.typical.abs()).collect()
}

/// Compliances of a gear of which the torque is at most `largest`, N m.
fn compliances(parameter: &Parameter, largest: f64) -> Vec<f64> {
    let compliances = TWISTS.iter().map(|twist| (twist / largest).min(parameter.upper));
    if largest > 0.0 { compliances.collect() } else { Vec::new() }
}

/// Largest torque of a joint in the valid rows, N m.
fn largest_torque(rows: &Rows, joint: usize) -> f64 {
    let torque = rows.torque[joint].iter().zip(&rows.valid[joint]);
    torque.fold(0.0f64, |m, (v, ok)| if *ok { m.max(v.abs()) } else { m })
}

/// Bounds of a shape on a joint as it moves in these logs: what is called a transition at low speed must lie at low speed, and
/// a time constant longer than the logs is a drift.
fn shape_bounds(effect: &dyn Effect, index: usize, joint: usize, rows: &Rows) -> (f64, f64) {
    let parameter = &effect.parameters()[index];
    let (low, high) = (parameter.lower, parameter.upper);
    let (least, most) = match effect.search(index) {
        Search::LowSpeed => (0.0, LOW_SPEED * fastest(rows, joint)),
        Search::TimeConstant => {
            let longest = duration(rows);
            (SHORTEST_DRIFT * longest, LONGEST_DRIFT * longest)
        }
        _ => (low, high),
    };
    let least = low.max(least).min(high);
    (least, high.min(most).max(least))
}

/// A shape within its bounds and away from where its effect is one of the baseline: a power of speed near one takes
/// coefficients of any size that all but cancel the viscous friction's.
pub(crate) fn within_bounds(effect: &dyn Effect, index: usize, value: f64, joint: usize, rows: &Rows) -> f64 {
    let (low, high) = shape_bounds(effect, index, joint, rows);
    let value = value.clamp(low, high);
    match effect.search(index) == Search::PowerOfSpeed && (value - 1.0).abs() < APART {
        true if value < 1.0 => 1.0 - APART,
        true => 1.0 + APART,
        false => value,
    }
}

fn fastest(rows: &Rows, joint: usize) -> f64 {
    rows.logs.iter().flat_map(|log| log.motion.qd.channel(joint)).fold(0.0, |m, v| m.max(v.abs()))
}

fn duration(rows: &Rows) -> f64 {
    rows.logs.iter().filter_map(|log| log.time.last().copied()).fold(0.0, f64::max)
}

fn shape_grid(effect: &dyn Effect, index: usize, alone: bool, joint: usize, rows: &Rows) -> Vec<f64> {
    let parameter = &effect.parameters()[index];
    let (low, high) = shape_bounds(effect, index, joint, rows);
    if effect.search(index) == Search::PerTurn {
        let step = (std::f64::consts::PI / (2.0 * range(rows, joint))).max(0.4);
        let count = ((HIGHEST_HARMONIC - low) / step) as usize;
        return (0..=count).map(|k| low + k as f64 * step).collect();
    }
    let points = if alone { ALONE } else { ONE_OF_SEVERAL };
    if varies_by_factors(low, high) {
        let (low, high) = (low.max(parameter.typical / REACH), high.min(parameter.typical * REACH));
        return (0..points).map(|k| low * (high / low).powf(k as f64 / (points - 1) as f64)).collect();
    }
    (0..points).map(|k| low + (high - low) * (k as f64 + 0.5) / points as f64).collect()
}

/// How far a joint moves, rad.
fn range(rows: &Rows, joint: usize) -> f64 {
    let positions = rows.logs.iter().flat_map(|log| log.motion.q.channel(joint));
    let (low, high) = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &q| (l.min(q), h.max(q)));
    (high - low).max(1e-6)
}

/// Contacts of a few lengths, at any time of the longest log.
fn contacts(typical: &Placed, rows: &Rows) -> Vec<Placed> {
    // A clock may have started long before the logs.
    let begin = rows.logs.iter().filter_map(|log| log.time.first().copied()).fold(f64::INFINITY, f64::min);
    let end = duration(rows);
    let of_length = |length: f64| {
        (0..).map(move |k| begin + f64::from(k) * 0.5 * length).take_while(move |start| start + 0.5 * length < end).map(
            move |start| {
                let mut placed = typical.clone();
                placed.effect.move_between(start, start + length, &mut placed.parameters);
                placed
            },
        )
    };
    CONTACTS_S.into_iter().flat_map(of_length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;

    #[test]
    fn compliances_are_those_of_the_joint() {
        // A gear that winds up by 0.1 rad under 500 N m, and one under 0.5 N m.
        let compliance = &find("joint_elasticity").unwrap().parameters()[0];
        for largest in [500.0, 0.5] {
            let sizes = compliances(compliance, largest);
            assert!((sizes[0] * largest - 1e-4).abs() < 1e-12 && (sizes.last().unwrap() * largest - 0.1).abs() < 1e-12);
        }
        assert!(compliances(compliance, 0.0).is_empty());
    }
}
