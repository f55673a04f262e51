//! A law of one's own: what it is, its torque along a motion, and its parameters from a log.
//!
//! `cargo run --release --example add_an_effect`
//!
//! A law becomes a candidate of every diagnosis by its entry in `LIBRARY` (`core/src/effects/catalogue.rs`).

use tauscope::dynamics::{Chain, Motion};
use tauscope::effects::{
    About, Along, Effect, Hidden, Instant, Nature, Parameter, Placed, Role, Scope, Site, contribution,
};
use tauscope::error::Result;
use tauscope::identification::Identification;
use tauscope::robot::Unit;
use tauscope::scenario::Setup;
use tauscope::study::testbed;

/// A rubber stop: a spring that the joint touches at a position and compresses beyond.
struct RubberStop;

static ABOUT: About = About {
    name: "rubber_stop",
    equation: "tau = k max(q - q0, 0)",
    explanation: "Near the end of its range the joint leans on a rubber stop.",
    reference: "Hooke's law",
    rivals: &[],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 2] = [
    // Torque is linear in the stiffness: it is solved for.
    Parameter {
        name: "stiffness",
        symbol: "k",
        unit: Unit::Stiffness,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 200.0,
    },
    // Where it is touched is searched between the bounds, from the typical value.
    Parameter {
        name: "touch",
        symbol: "q0",
        unit: Unit::Position,
        role: Role::Shape,
        lower: -0.5,
        upper: 0.5,
        typical: 0.1,
    },
];

impl Effect for RubberStop {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * (x.q[joint] - p[1]).max(0.0);
    }
}

fn main() -> Result<()> {
    // Two motions of an arm without the stop, and what the stop adds along each: a torque of the motor at joint 2.
    let setup = Setup::load("tests/scenarios/short.toml", None)?;
    let runs = testbed::record(&setup, &mut |_| ())?;
    let hidden = Placed { effect: &RubberStop, joint: 1, parameters: vec![300.0, 0.2] };
    let chain = Chain::new(&setup.known);
    let logs = [runs.training, runs.held_out].map(|run| {
        let mut log = run.recording;
        if let Some(truth) = log.truth.clone() {
            let motion = Motion { q: truth.q.clone(), qd: truth.qd.clone(), qdd: truth.qdd.clone() };
            let added = contribution(
                std::slice::from_ref(&hidden),
                &Along::new(&setup.known, &chain, &log.time, &motion, 0.01),
            );
            log.tau.as_mut_slice().iter_mut().zip(added.as_slice()).for_each(|(tau, added)| *tau += added);
        }
        log
    });

    // The log determines what was hidden, together with the arm's base parameters and friction.
    let stop = Placed::typical(&RubberStop, 1);
    let found = Identification::of(&setup.known).train(&logs[..1]).test(&logs[1..]).effects([stop]).run()?;
    let (without, with) = (&found.without_effects, found.fitted());
    println!(
        "held-out residual of joint 2: {:.3} N m without the stop, {:.3} with it",
        without.test_rms[1], with.test_rms[1]
    );
    for (parameter, (found, hidden)) in PARAMETERS.iter().zip(with.placed[0].parameters.iter().zip(&hidden.parameters))
    {
        println!("{} {:.3} {} (hidden: {hidden})", parameter.name, found, parameter.unit);
    }
    Ok(())
}
