//! The diagnosis around its statistics: faults of the data come before physics, what the simulation knows already is not
//! found again, and the extended model is a model that runs.

mod agreement;
mod changes;
mod entry;
mod events;
mod extended;
mod faults;
mod forms;
mod map;
mod parsimony;
mod relevance;
#[path = "../schema/mod.rs"]
mod schema;
mod smoothing;
mod structure;
mod struts;

use std::sync::LazyLock;
use tauscope::diagnosis::{Answer, Diagnosis, DiagnosisBuilder};
use tauscope::effects::Placed;
use tauscope::excitation::random_sequence::random_sequence;
use tauscope::recording::Recording;
use tauscope::robot::Robot;
use tauscope::scenario::{Setup, measure, simulate};

/// Length of the motions, s, and moves of every joint in them.
const DURATION_S: f64 = 12.0;
const MOVES: usize = 7;

/// The IRB 1600 of the main scenario.
static SETUP: LazyLock<Setup> =
    LazyLock::new(|| Setup::load(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml"), None).unwrap());

/// The answer of a diagnosis; what it is as JSON must follow the schema.
fn answer(diagnosis: DiagnosisBuilder) -> Answer {
    let answer = diagnosis.run().unwrap();
    schema::assert_valid(&serde_json::from_str(&answer.to_json()).unwrap());
    answer
}

/// The diagnosis of `logs`, the last of which is held out, against `robot`; only some effects are looked for.
fn diagnosed(robot: &Robot, logs: &[Recording], candidates: &[&str]) -> Diagnosis {
    let (test, train) = logs.split_last().unwrap();
    let diagnosis = Diagnosis::of(robot).train(train).test([test]).candidates(candidates.iter().copied());
    answer(diagnosis).into_conclusion().unwrap().diagnosis
}

/// The same arm with effects at work.
fn with(effects: &[Placed]) -> Setup {
    let mut setup = SETUP.clone();
    for placed in effects {
        placed.effect.alter(&placed.parameters, placed.joint, &mut setup.plant);
        setup.effects.push(placed.clone());
    }
    setup
}

/// Logs of an arm on motions drawn from `seed`.
fn logs(setup: &Setup, seed: u64, count: u64) -> Vec<Recording> {
    let mut setup = setup.clone();
    setup.scenario.seed = seed;
    (0..count)
        .map(|index| {
            let motion = random_sequence(seed, "diagnosed", index, MOVES, DURATION_S, &setup.limits).unwrap();
            measure(&setup, &simulate(&setup, &motion, &mut |_| ()).unwrap(), index).unwrap()
        })
        .collect()
}
