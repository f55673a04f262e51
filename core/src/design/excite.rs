//! The search for an excitation motion from beginning to end: what is asked for is checked, searched for, put together
//! from blocks when it is long, and checked again at 10 kHz.
//!
//! Information adds up over time, so a long motion is put together from blocks that each start and end at rest at zero.
//! The first block is found on its own and stands in for all of them; then every other block is searched for in turn, to
//! complement the rest; then all are refined in turn. There is a whole motion to return at any time, and it only ever
//! gets better. Kinds that cannot be joined are searched for at full length.

use super::envelope::{Clearance, Violation};
use super::families::Family;
use super::information::Information;
use super::problem::{Problem, Worth};
use super::search::{self, Plan, Progress};
use crate::error::{Error, Result};
use crate::excitation::encoding::Encoding;
use crate::excitation::freudenstein::{PEAK_ACCELERATION, PEAK_VELOCITY};
use crate::excitation::{JointLimits, Motion};
use crate::robot::Unit;

/// Length of a block, s: long enough for a motion on its own, short enough for CMA-ES.
const BLOCK_S: f64 = 10.0;

/// Improvements kept in case the last ones do not pass the check at 10 kHz.
const KEPT: usize = 50;

/// Share of the evaluations for the first block, the others, and refining.
const FIRST_SHARE: f64 = 0.4;
const OTHERS_SHARE: f64 = 0.3;

/// What to search for, and how long.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The parametrisation.
    pub family: Family,
    /// Length, s.
    pub duration_s: f64,
    /// Moves, segments, harmonics or control points per joint over the whole length; the usual number where absent.
    pub size: Option<usize>,
    /// Speed below which rows do not count in the identification, rad/s.
    pub still_band: f64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Independent runs.
    pub starts: usize,
    /// Evaluations of the criterion in all.
    pub evaluations: usize,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The motion.
    pub motion: Motion,
    /// Its criterion on the search's grid.
    pub value: f64,
    /// How close it comes to the limits, from samples at 10 kHz.
    pub clearance: Clearance,
    /// Evaluations made.
    pub evaluations: usize,
    /// Whether it was stopped before its evaluations were used up.
    pub stopped: bool,
}

/// Told after every generation, with the whole motion when there is a better one. Returns whether to go on.
pub(crate) type Watch<'a> = dyn FnMut(Progress, Option<&Motion>) -> bool + 'a;

/// Searches for the motion that is asked for.
///
/// # Errors
/// Names the limit or option that makes the request impossible, before the search where that shows, else after it.
pub fn excite(problem: &Problem, request: &Request, watch: &mut Watch) -> Result<Outcome> {
    let blocks = blocks(request);
    let size = request.size.unwrap_or_else(|| request.family.usual_size(request.duration_s));
    if size < blocks {
        let text = format!("{size} for {blocks} blocks of {BLOCK_S} s; ask for more or a shorter motion");
        return Err(Error::request("size", text));
    }
    require_long_enough(problem, request, size)?;
    let block_s = request.duration_s / blocks as f64;
    let encoding = request.family.encoding(problem.envelope.joints(), block_s, size.div_ceil(blocks))?;
    let mut session = Session {
        problem,
        request,
        encoding: &*encoding,
        watch,
        blocks: Vec::new(),
        value: f64::INFINITY,
        improvements: Vec::new(),
        least_violation: None,
        evaluations: 0,
        stopped: false,
    };
    session.run(blocks)?;
    session.finish()
}

/// Blocks that a motion of the length asked for is put together from.
fn blocks(request: &Request) -> usize {
    match request.family {
        Family::Freudenstein | Family::Quintic => ((request.duration_s / BLOCK_S).round() as usize).max(1),
        Family::Fourier | Family::Bspline => 1,
    }
}

/// Refuses lengths in which some joint cannot be moved fast enough for its rows to count, or with too few rows.
fn require_long_enough(problem: &Problem, request: &Request, size: usize) -> Result<()> {
    let duration = request.duration_s;
    if !(duration.is_finite() && duration > 0.0) {
        return Err(Error::request("duration", format!("must be a number above zero, found {duration}")));
    }
    let dof = problem.envelope.joints().len();
    let rows = (duration * problem.experiment.rate_hz()).floor() * dof as f64;
    let parameters = problem.experiment.beta().len();
    if rows < 2.0 * parameters as f64 {
        let problem = format!(
            "{duration} s give {rows} rows at {} Hz for {parameters} parameters; at least twice as many rows are wanted: \
             lengthen it or raise the rate",
            problem.experiment.rate_hz()
        );
        return Err(Error::request("duration", problem));
    }
    let move_s = duration / size as f64;
    for (limits, joint) in problem.envelope.joints().iter().zip(&problem.envelope.robot().joints) {
        let JointLimits { acceleration, .. } = *limits;
        let speed = acceleration * move_s * PEAK_VELOCITY / PEAK_ACCELERATION;
        if speed <= request.still_band {
            let problem = format!(
                "in a move of {move_s:.4} s the acceleration limit of {}, {acceleration} {}, allows {speed:.4} {unit}, \
                 which is inside the reversal band of {} {unit}, where rows do not count: lengthen the motion, ask for \
                 fewer moves or raise the limit",
                joint.name,
                joint.kind.unit(Unit::Acceleration),
                request.still_band,
                unit = joint.velocity_unit()
            );
            return Err(Error::request("duration", problem));
        }
    }
    Ok(())
}

/// A block of the motion.
#[derive(Clone)]
struct Block {
    x: Vec<f64>,
    motion: Motion,
    information: Information,
}

struct Session<'a, 'w> {
    problem: &'a Problem,
    request: &'a Request,
    encoding: &'a dyn Encoding,
    watch: &'a mut Watch<'w>,
    blocks: Vec<Block>,
    /// Criterion of the whole motion.
    value: f64,
    /// Whole motions with their criteria, each better than the one before.
    improvements: Vec<(f64, Motion)>,
    least_violation: Option<Violation>,
    evaluations: usize,
    stopped: bool,
}

impl Session<'_, '_> {
    fn run(&mut self, blocks: usize) -> Result<()> {
        let all = self.request.evaluations as f64;
        if blocks == 1 {
            return self.stage(0, 1, all, None);
        }
        self.stage(0, blocks, FIRST_SHARE * all, None)?;
        let Some(first) = self.blocks.first().cloned() else { return Ok(()) };
        self.blocks = vec![first; blocks];
        for k in 1..blocks {
            self.stage(k, 1, OTHERS_SHARE * all / (blocks - 1) as f64, None)?;
        }
        for k in 0..blocks {
            let from = self.blocks[k].x.clone();
            self.stage(k, 1, (1.0 - FIRST_SHARE - OTHERS_SHARE) * all / blocks as f64, Some(from))?;
        }
        Ok(())
    }

    /// Searches for block `k`, given the other blocks, counted `copies` times.
    fn stage(&mut self, k: usize, copies: usize, evaluations: f64, from: Option<Vec<f64>>) -> Result<()> {
        if self.stopped {
            return Ok(());
        }
        let Session { problem, encoding, .. } = *self;
        let others = self.others(k);
        let motions: Vec<Motion> = self.blocks.iter().map(|block| block.motion.clone()).collect();
        let whole = |motion: &Motion| -> Result<Motion> {
            let mut parts = motions.clone();
            if parts.is_empty() {
                parts = vec![motion.clone(); copies];
            } else {
                parts[k] = motion.clone();
            }
            if parts.len() == 1 { Ok(motion.clone()) } else { Motion::joined(&parts) }
        };
        let total = |information: &Information| (0..copies).fold(others.clone(), |sum, _| sum.joined(information));
        let worth = |motion: &Motion| -> Worth {
            let (information, violation) = problem.observe(motion);
            problem.worth(&total(&information), violation)
        };
        let label = format!("block {k}{}", if from.is_some() { " refined" } else { "" });
        let plan = Plan {
            seed: self.request.seed,
            label,
            starts: if from.is_some() { 1 } else { self.request.starts },
            evaluations: evaluations.round() as usize,
            from,
        };
        let (watch, improvements, before) = (&mut *self.watch, &mut self.improvements, self.evaluations);
        let mut value = self.value;
        let mut failed = None;
        let found = search::minimise(encoding, &worth, &plan, &mut |progress, better| {
            let better = better.filter(|candidate| candidate.worth.value < value);
            let mut shown = None;
            if let Some(candidate) = better {
                match whole(&candidate.motion) {
                    Ok(motion) => {
                        value = candidate.worth.value;
                        if improvements.len() == KEPT {
                            improvements.remove(0);
                        }
                        improvements.push((value, motion.clone()));
                        shown = Some(motion);
                    }
                    Err(error) => failed = Some(error),
                }
            }
            let best = value.is_finite().then_some(value);
            watch(Progress { evaluations: before + progress.evaluations, best }, shown.as_ref()) && failed.is_none()
        });
        if let Some(error) = failed {
            return Err(error);
        }
        self.evaluations += found.evaluations;
        self.stopped |= found.stopped;
        if self.least_violation.is_none() {
            self.least_violation = found.least_violation;
        }
        if let Some(best) = found.best.filter(|best| best.worth.value < self.value) {
            self.value = best.worth.value;
            let (information, _) = problem.observe(&best.motion);
            let block = Block { x: best.x, motion: best.motion, information };
            if self.blocks.is_empty() {
                self.blocks.push(block);
            } else {
                self.blocks[k] = block;
            }
        }
        Ok(())
    }

    /// Information of all blocks but `k`.
    fn others(&self, k: usize) -> Information {
        let none = Information::none(self.problem.experiment.beta().len());
        self.blocks
            .iter()
            .enumerate()
            .filter(|(index, _)| *index != k)
            .fold(none, |sum, (_, b)| sum.joined(&b.information))
    }

    /// The best motion that passes the check at 10 kHz.
    fn finish(self) -> Result<Outcome> {
        let mut last = None;
        for (value, motion) in self.improvements.into_iter().rev() {
            match self.problem.envelope.check(&motion) {
                Ok(clearance) => {
                    let (evaluations, stopped) = (self.evaluations, self.stopped);
                    return Ok(Outcome { motion, value, clearance, evaluations, stopped });
                }
                Err(error) => last = Some(error),
            }
        }
        Err(last.unwrap_or_else(|| nothing_found(self.least_violation, self.evaluations)))
    }
}

/// Why no candidate was inside the limits.
fn nothing_found(least: Option<Violation>, evaluations: usize) -> Error {
    let Some(Violation { torque, floor, column }) = least.filter(|violation| !violation.is_none()) else {
        return Error::request(
            "motion",
            format!("none of {evaluations} candidates separates the parameters; take a longer motion or more moves"),
        );
    };
    let most = torque.max(floor).max(column);
    let (subject, amount) = if most == torque {
        ("torque limits", format!("by {:.3} of the effort", torque))
    } else if most == floor {
        ("workspace.floor_m", format!("by {floor:.4} m"))
    } else {
        ("workspace.column_radius_m", format!("by {column:.4} m"))
    };
    Error::request(
        subject,
        format!(
            "none of {evaluations} candidates keeps to this; the closest passes it {amount} on average over the motion: \
             relax it, or allow more evaluations"
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::super::Criterion;
    use super::super::tests::problem;
    use super::*;
    use crate::excitation::Reference;

    fn request(family: Family, duration_s: f64, evaluations: usize) -> Request {
        Request { family, duration_s, size: None, still_band: 0.03, seed: 5, starts: 1, evaluations }
    }

    fn run(problem: &Problem, request: &Request) -> Result<Outcome> {
        excite(problem, request, &mut |_, _| true)
    }

    #[test]
    fn the_same_seed_gives_the_same_motion_on_any_number_of_threads() {
        let problem = problem(Criterion::default());
        let request = request(Family::Freudenstein, 10.0, 600);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| run(&problem, &request).unwrap())
        };
        let (one, two) = (on(1), on(2));
        assert_eq!(one, two);
        let other = run(&problem, &Request { seed: 6, ..request.clone() }).unwrap();
        assert_ne!(one.motion, other.motion);
    }

    #[test]
    fn every_kind_is_improved_and_keeps_every_limit_at_10_khz() {
        let problem = problem(Criterion::default());
        for family in Family::ALL {
            let request = request(family, 6.0, 500);
            let mut values = Vec::new();
            let outcome = excite(&problem, &request, &mut |progress, _| {
                values.extend(progress.best);
                true
            })
            .unwrap();
            assert!(values.is_sorted_by(|a, b| a >= b), "{}: the best never gets worse", family.name());
            assert!(outcome.value < values[0] && outcome.value == *values.last().unwrap(), "{}", family.name());
            assert!(outcome.evaluations >= 500 && !outcome.stopped);
            let [mut q, mut qd, mut qdd] = [[0.0; 6]; 3];
            let robot = problem.envelope.robot();
            for k in 0..=60_000 {
                outcome.motion.at(f64::from(k) / 1e4, &mut q, &mut qd, &mut qdd);
                for (j, limits) in problem.envelope.joints().iter().enumerate() {
                    assert!(q[j] >= limits.lower && q[j] <= limits.upper);
                    assert!(qd[j].abs() <= limits.velocity && qdd[j].abs() <= limits.acceleration);
                }
                let frames = robot.frames(&q);
                assert!(frames[3..].iter().all(|frame| frame.translation.z >= 0.0));
                let clear = |p: &nalgebra::Vector3<f64>| p.x.hypot(p.y) >= 0.35 || p.z >= 0.7;
                assert!(frames[3..].iter().all(|frame| clear(&frame.translation)));
            }
        }
    }

    #[test]
    fn long_motions_are_better_than_their_first_block_repeated() {
        let problem = problem(Criterion::LogDeterminant);
        let short = run(&problem, &request(Family::Freudenstein, 10.0, 800)).unwrap();
        let long = run(&problem, &request(Family::Freudenstein, 20.0, 2000)).unwrap();
        assert_eq!(long.motion.duration_s(), 20.0);
        assert!(long.value < short.value - 0.5 * 2f64.ln(), "{} against {}", long.value, short.value);
        let information = problem.experiment.information(&long.motion, problem.grid_hz);
        let whole = super::super::criterion::log_determinant(&information);
        assert!((whole - long.value).abs() < 0.01, "blocks {} against the whole {whole}", long.value);
    }

    #[test]
    fn it_stops_when_told_with_the_best_so_far() {
        let problem = problem(Criterion::default());
        let mut generations = 0;
        let outcome = excite(&problem, &request(Family::Freudenstein, 10.0, 1_000_000), &mut |_, _| {
            generations += 1;
            generations < 4
        })
        .unwrap();
        assert!(outcome.stopped && outcome.evaluations < 200);
        assert!(problem.envelope.check(&outcome.motion).is_ok());
    }

    #[test]
    fn impossible_requests_name_what_conflicts() {
        let fine = problem(Criterion::default());
        let message = |problem: &Problem, request: &Request| run(problem, request).unwrap_err().to_string();
        let text = message(&fine, &request(Family::Freudenstein, 0.02, 100));
        assert!(text.contains("duration") && text.contains("rows"), "{text}");
        let many = Request { size: Some(200), ..request(Family::Freudenstein, 1.0, 100) };
        let text = message(&fine, &many);
        assert!(text.contains("acceleration limit of joint_1") && text.contains("reversal band"), "{text}");
        let text = message(&fine, &request(Family::Freudenstein, f64::NAN, 100));
        assert!(text.contains("duration"), "{text}");
        let few = Request { size: Some(2), ..request(Family::Freudenstein, 40.0, 100) };
        assert!(message(&fine, &few).contains("size"));

        // Enough torque to hold the zero pose, not enough for friction once a joint moves.
        let mut robot = super::super::tests::irb1600();
        robot.joints[0].limits.effort = 61.0;
        let limits = super::super::tests::limits(&robot);
        let envelope = super::super::Envelope::new(&robot, &limits, None).unwrap();
        let weak = Problem::new(fine.experiment.clone(), envelope, Criterion::default(), 50.0, 0.03).unwrap();
        let text = message(&weak, &request(Family::Freudenstein, 10.0, 200));
        assert!(text.starts_with("torque limits"), "{text}");
    }
}
