//! Grids of the parameters of a law that are not linear: where a fit looks for them on a joint, given how far the joint goes in the logs.

use super::about::{Parameter, Role};
use super::law::Effect;
use super::placed::Placed;
use super::search::{Search, varies_by_factors};

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
const TWISTS: [f64; 7] = [2e-4, 5e-4, 1.25e-3, 3.1e-3, 7.8e-3, 2e-2, 5e-2];

/// Sizes of a gear's play, as multiples of the typical one: the time of flight through it grows by a quarter from one to the next, and
/// torque that comes half a swing too late is torque of the other sign.
const GAPS: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0];

/// Highest harmonic of a ripple that is looked for whatever the speed, the highest of all (twice per turn of the wave generator of a strain
/// wave gear of 160 to 1), and the narrowest step.
const ALWAYS_HARMONIC: f64 = 60.0;
const HIGHEST_HARMONIC: f64 = 330.0;
const HARMONIC_STEP: f64 = 0.4;

/// Factor on the step above the first of these: half the distance of independent harmonics, at which a scan sees at least 81 % of the
/// statistic (the square of the sine cardinal of a quarter), and the refinement the rest.
const COARSER: f64 = 2.0;

/// Least number of periods over a joint's range: fewer are any bend over the position.
const LEAST_PERIODS: f64 = 1.5;

/// Distance that a joint moves at least, rad or m: one that stands still has no ripple to look for.
const LEAST_RANGE: f64 = 1e-6;

/// Least distance of a bend over the position from either end of the range of motion, over that range: nearer ones rest on few rows.
const INSIDE: f64 = 0.1;

/// Lengths of what happens once, s.
const EVENTS_S: [f64; 3] = [1.5, 3.0, 6.0];

/// Size below which a departure drowns in rounding, over its typical one.
const LEAST_SIZE: f64 = 1e-3;

/// How far a joint goes in logs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    /// Highest speed, rad/s or m/s.
    pub speed: f64,
    /// Its farthest positions, rad or m.
    pub positions: [f64; 2],
    /// Largest torque, N m or N.
    pub torque: f64,
    /// First and last instant of all logs by their clocks, s.
    pub time: [f64; 2],
    /// Duration of the longest log, s; of all of them together where their clocks run on from one to the next.
    pub duration: f64,
    /// Whether they do: no two logs share an instant, and less time passes between them than in them.
    pub runs_on: bool,
}

impl Extent {
    /// Every combination of the values at which the law is looked for on a joint whose rows hold up to a `harmonic` of its turn.
    pub(crate) fn grid(&self, effect: &'static dyn Effect, joint: usize, harmonic: f64) -> Vec<Placed> {
        let typical = Placed::typical(effect, joint);
        let parameters = effect.parameters();
        if parameters.iter().enumerate().any(|(index, _)| effect.search(index) == Search::Instant) {
            return self.events(&typical);
        }
        let alone = parameters.iter().filter(|parameter| parameter.role == Role::Shape).count() == 1;
        let mut all = vec![typical];
        for (index, parameter) in parameters.iter().enumerate() {
            let values = match parameter.role {
                Role::Held if self.runs_on && effect.search(index) == Search::ClockStart => {
                    vec![parameter.typical, self.time[0]]
                }
                Role::Amplitude | Role::Held => continue,
                Role::Departure => self.departures(effect, index),
                Role::Shape => {
                    let values = self.shapes(effect, index, alone, harmonic);
                    values.into_iter().map(|value| self.within_bounds(effect, index, value)).collect()
                }
            };
            let with = |placed: &Placed, value: f64| {
                let mut placed = placed.clone();
                placed.parameters[index] = value;
                placed
            };
            all = all.iter().flat_map(|placed| values.iter().map(|&value| with(placed, value))).collect();
        }
        all
    }

    /// Values of a departure. Those in the log's timing bend with their size; the others are straight as far as one looks.
    fn departures(&self, effect: &dyn Effect, index: usize) -> Vec<f64> {
        let parameter = &effect.parameters()[index];
        match effect.search(index) {
            Search::Level => CUT_OFF.iter().map(|share| share * self.torque).filter(|level| *level > 0.0).collect(),
            Search::Shift | Search::Compliance | Search::Gap => {
                let sizes = self.sizes(effect, index);
                let both = sizes.iter().map(|size| -size).chain(sizes.iter().copied());
                both.filter(|size| (parameter.lower..=parameter.upper).contains(size)).collect()
            }
            _ => vec![parameter.typical],
        }
    }

    /// Sizes at which the columns of a departure that bends are taken, without signs, the smallest first: below that one the torque is as
    /// good as straight in it.
    pub(crate) fn sizes(&self, effect: &dyn Effect, index: usize) -> Vec<f64> {
        let parameter = &effect.parameters()[index];
        match effect.search(index) {
            Search::Compliance if self.torque > 0.0 => {
                TWISTS.iter().map(|twist| (twist / self.torque).min(parameter.upper)).collect()
            }
            Search::Compliance => Vec::new(),
            Search::Gap => GAPS.iter().map(|multiple| multiple * parameter.typical).collect(),
            _ => TIMES.iter().map(|multiple| multiple * parameter.typical.abs()).collect(),
        }
    }

    /// Bounds of a shape beyond which the law is another on this joint: a ripple of few periods over its range is any bend.
    pub(crate) fn bounds_of_law(&self, effect: &dyn Effect, index: usize) -> (f64, f64) {
        let Parameter { lower: low, upper: high, .. } = effect.parameters()[index];
        match effect.search(index) {
            Search::PerTurn => (low.max(LEAST_PERIODS * std::f64::consts::TAU / self.range()).min(high), high),
            Search::Position => {
                let [first, last] = inside(self.positions);
                (low.max(first), high.min(last))
            }
            _ => (low, high),
        }
    }

    /// Distance between its farthest positions, rad or m.
    fn range(&self) -> f64 {
        (self.positions[1] - self.positions[0]).max(LEAST_RANGE)
    }

    fn shapes(&self, effect: &dyn Effect, index: usize, alone: bool, harmonic: f64) -> Vec<f64> {
        let parameter = &effect.parameters()[index];
        let (low, high) = self.bounds(effect, index);
        if effect.search(index) == Search::PerTurn {
            let step = (std::f64::consts::PI / (2.0 * self.range())).max(HARMONIC_STEP);
            let upwards = |from: f64, step: f64| (0..).map(move |k| from + f64::from(k) * step);
            let always = upwards(low, step).take_while(|order| *order <= ALWAYS_HARMONIC);
            let coarse = COARSER * step;
            let highest = harmonic.min(HIGHEST_HARMONIC);
            let higher = upwards(low.max(ALWAYS_HARMONIC) + coarse, coarse).take_while(|order| *order <= highest);
            return always.chain(higher).collect();
        }
        let points = if alone { ALONE } else { ONE_OF_SEVERAL };
        if effect.search(index) != Search::Position && varies_by_factors(low, high) {
            let (low, high) = (low.max(parameter.typical / REACH), high.min(parameter.typical * REACH));
            return (0..points).map(|k| low * (high / low).powf(k as f64 / (points - 1) as f64)).collect();
        }
        (0..points).map(|k| low + (high - low) * (k as f64 + 0.5) / points as f64).collect()
    }

    /// Bounds of a shape on this joint: what is called a transition at low speed must lie at low speed, and a time constant longer than the
    /// logs is a drift.
    fn bounds(&self, effect: &dyn Effect, index: usize) -> (f64, f64) {
        let (low, high) = self.bounds_of_law(effect, index);
        let (least, most) = match effect.search(index) {
            Search::LowSpeed => (0.0, LOW_SPEED * self.speed),
            Search::TimeConstant => (SHORTEST_DRIFT * self.duration, LONGEST_DRIFT * self.duration),
            _ => (low, high),
        };
        let least = low.max(least).min(high);
        (least, high.min(most).max(least))
    }

    /// A shape within its bounds and away from where its effect is one of the baseline: a power of speed near one takes coefficients of any
    /// size that all but cancel the viscous friction's.
    pub(crate) fn within_bounds(&self, effect: &dyn Effect, index: usize, value: f64) -> f64 {
        let (low, high) = self.bounds(effect, index);
        let value = value.clamp(low, high);
        match effect.search(index) == Search::PowerOfSpeed && (value - 1.0).abs() < APART {
            true if value < 1.0 => 1.0 - APART,
            true => 1.0 + APART,
            false => value,
        }
    }

    /// A shape moved `from` a value within its bounds. A power of speed stays on its side of one: below one a positive coefficient bends
    /// as a negative one above, and the laws are two.
    pub(crate) fn moved_within_bounds(&self, effect: &dyn Effect, index: usize, from: f64, wanted: f64) -> f64 {
        let wanted = match effect.search(index) {
            Search::PowerOfSpeed if from < 1.0 => wanted.min(1.0 - APART),
            Search::PowerOfSpeed => wanted.max(1.0 + APART),
            _ => wanted,
        };
        self.within_bounds(effect, index, wanted)
    }

    /// What happens once, for a few lengths, at any time of the longest log.
    fn events(&self, typical: &Placed) -> Vec<Placed> {
        // A clock may have started long before the logs.
        let [begin, end] = self.time;
        let of_length = |length: f64| {
            let starts = (0..).map(move |k| begin + f64::from(k) * 0.5 * length);
            starts.take_while(move |start| start + 0.5 * length < end).map(move |start| {
                let mut placed = typical.clone();
                placed.effect.move_between(start, start + length, &mut placed.parameters);
                placed
            })
        };
        EVENTS_S.into_iter().flat_map(of_length).collect()
    }
}

/// Positions between which a law may bend where a joint moves between these.
pub(crate) fn inside([first, last]: [f64; 2]) -> [f64; 2] {
    let margin = INSIDE * (last - first);
    [first + margin, last - margin]
}

/// The value of a shape moved by a `share`: of itself where it is positive and wide, else of its range.
pub(crate) fn moved(effect: &dyn Effect, index: usize, value: f64, share: f64) -> f64 {
    let Parameter { lower: low, upper: high, .. } = effect.parameters()[index];
    match effect.search(index) {
        Search::PerTurn => value + 2.0 * share,
        Search::Instant => value + 4.0 * share,
        Search::Position => value + 0.5 * share,
        _ if low == 0.0 || varies_by_factors(low, high) => value * (4.0 * share).exp(),
        _ => value + 0.4 * share * (high - low),
    }
}

/// An estimate as the size at which the column of a parameter is taken next: within its bounds, and no smaller than rounding.
pub(crate) fn as_size(parameter: &Parameter, estimate: f64) -> f64 {
    let least = LEAST_SIZE * parameter.typical.abs();
    let size = if estimate.abs() < least { least } else { estimate };
    size.clamp(parameter.lower, parameter.upper)
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::{LIBRARY, find};
    use super::*;

    fn extent() -> Extent {
        Extent {
            speed: 2.0,
            positions: [-1.0, 2.0],
            torque: 50.0,
            time: [100.0, 120.0],
            duration: 20.0,
            runs_on: false,
        }
    }

    #[test]
    fn compliances_are_those_of_the_joint() {
        // A gear that winds up by 0.05 rad under 500 N m, and one under 0.5 N m.
        let elasticity = find("joint_elasticity").unwrap();
        for torque in [500.0, 0.5] {
            let sizes = Extent { torque, ..extent() }.sizes(elasticity, 0);
            assert!((sizes[0] * torque - 2e-4).abs() < 1e-12 && (sizes.last().unwrap() * torque - 0.05).abs() < 1e-12);
        }
        assert!(Extent { torque: 0.0, ..extent() }.sizes(elasticity, 0).is_empty());
    }

    #[test]
    fn a_transition_at_low_speed_lies_at_low_speed() {
        let stribeck = find("stribeck_friction").unwrap();
        // 30 % of 2 rad/s.
        assert!((extent().within_bounds(stribeck, 1, 2.5) - 0.6).abs() < 1e-12);
        assert_eq!(extent().within_bounds(stribeck, 1, 0.1), 0.1);
        let power = find("nonlinear_viscous_friction").unwrap();
        let index = power.parameters().iter().position(|parameter| parameter.name == "exponent").unwrap();
        let of = |exponent: f64| extent().within_bounds(power, index, exponent);
        assert_eq!([of(0.9), of(1.1), of(0.5), of(2.0)], [0.7, 1.3, 0.5, 2.0]);
        // Moved, it stays on its side of one.
        let moved = |from: f64, to: f64| extent().moved_within_bounds(power, index, from, to);
        assert_eq!([moved(0.6, 1.9), moved(0.6, 0.5), moved(1.9, 0.6), moved(1.9, 2.0)], [0.7, 0.5, 1.3, 2.0]);
        assert_eq!(extent().moved_within_bounds(stribeck, 1, 0.1, 0.2), 0.2);
    }

    #[test]
    fn a_law_bends_inside_the_range_of_motion() {
        let spring = find("one_sided_spring").unwrap();
        let bends: Vec<f64> = extent().grid(spring, 0, 0.0).iter().map(|placed| placed.parameters[2]).collect();
        // A tenth of three radians from either end.
        assert!(bends.len() == ALONE && bends.iter().all(|bend| (-0.7..=1.7).contains(bend)), "{bends:?}");
        let within = [-2.0, 0.5, 3.0].map(|bend| extent().within_bounds(spring, 2, bend));
        assert!((within[0] + 0.7).abs() < 1e-12 && within[1] == 0.5 && (within[2] - 1.7).abs() < 1e-12, "{within:?}");
        // Far from zero it is looked for in equal steps too.
        let far = Extent { positions: [0.1, 3.1], ..extent() };
        let bends: Vec<f64> = far.grid(spring, 0, 0.0).iter().map(|placed| placed.parameters[2]).collect();
        assert!(bends.windows(2).all(|pair| (pair[1] - pair[0] - 0.24).abs() < 1e-9), "{bends:?}");
    }

    #[test]
    fn ripples_are_looked_for_up_to_what_slow_motions_show() {
        let ripple = find("torque_ripple").unwrap();
        let highest = |harmonic: f64| {
            let grid = extent().grid(ripple, 0, harmonic);
            grid.last().unwrap().parameters[2]
        };
        // The step is pi / (2 * 3 rad).
        let step = std::f64::consts::PI / 6.0;
        // One and a half periods over 3 rad.
        assert!((extent().grid(ripple, 0, 0.0)[0].parameters[2] - std::f64::consts::PI).abs() < 1e-12);
        for (resolved, expected) in [(0.0, 60.0), (100.0, 100.0), (1e9, 330.0)] {
            assert!(
                (expected - 2.0 * step..=expected).contains(&highest(resolved)),
                "{resolved}: {}",
                highest(resolved)
            );
        }
    }

    #[test]
    fn a_law_that_counts_time_may_count_from_the_first_log_where_clocks_run_on() {
        let warm_up = find("friction_warm_up").unwrap();
        let starts = |runs_on: bool| {
            let mut starts: Vec<f64> = Extent { runs_on, ..extent() }
                .grid(warm_up, 0, 0.0)
                .iter()
                .map(|placed| placed.parameters[2])
                .collect();
            starts.dedup();
            starts
        };
        assert_eq!((starts(false), starts(true).first().copied()), (vec![-1.0], Some(-1.0)));
        assert!(starts(true).contains(&100.0));
        // A tenth of the log to three times the log, whatever its clock says.
        let bounds = [0.1, 1e3].map(|time| extent().within_bounds(warm_up, 1, time));
        assert_eq!(bounds, [2.0, 60.0]);
    }

    #[test]
    fn torque_is_cut_off_near_its_largest() {
        let levels: Vec<f64> =
            extent().grid(find("torque_saturation").unwrap(), 0, 0.0).iter().map(|p| p.parameters[0]).collect();
        assert!(levels.len() == CUT_OFF.len() && levels.iter().all(|level| (35.0..50.0).contains(level)), "{levels:?}");
    }

    #[test]
    fn events_lie_in_the_logs() {
        let contacts = extent().grid(find("external_contact").unwrap(), 0, 0.0);
        assert!(contacts.len() > 20);
        for contact in contacts {
            let [from, to] = contact.effect.acts_between(&contact.parameters);
            assert!(from < 120.0 && to > 100.0, "{from} to {to}");
        }
    }

    #[test]
    fn every_law_is_looked_for_within_its_bounds() {
        for &effect in LIBRARY {
            let grid = extent().grid(effect, 0, 0.0);
            assert!(!grid.is_empty(), "{}", effect.about().name);
            for placed in grid {
                let bounds = effect.parameters().iter().zip(&placed.parameters);
                assert!(bounds.clone().all(|(p, v)| (p.lower..=p.upper).contains(v)), "{placed:?}");
            }
        }
    }
}
