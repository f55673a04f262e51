//! Recordings for the tests of this module.

use super::{Recording, Signals};
use crate::channels::Channels;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A recording with every field set; no two values are alike.
pub(super) fn full(joints: usize, samples: usize) -> Recording {
    let table = |offset: f64| {
        let mut table = Channels::zeros(joints, samples);
        for (index, value) in table.as_mut_slice().iter_mut().enumerate() {
            *value = offset + (index as f64 + 1.0).sqrt();
        }
        table
    };
    Recording {
        robot: "arm".into(),
        joints: (1..=joints).map(|joint| format!("axis_{joint}")).collect(),
        time: (0..samples).map(|sample| sample as f64 * 0.002).collect(),
        q: table(0.0),
        qd: Some(table(100.0)),
        qdd: Some(table(200.0)),
        tau: table(300.0),
        truth: Some(Arc::new(Signals { q: table(400.0), qd: table(500.0), qdd: table(600.0), tau: table(700.0) })),
        provenance: BTreeMap::from([("seed".into(), "7".into()), ("qd".into(), "tachometer".into())]),
    }
}

/// All numbers of a recording, bit for bit (plain equality takes -0 for 0), with a mark for every table present.
pub(super) fn bits(recording: &Recording) -> Vec<u64> {
    let truth = recording.truth.as_ref();
    let tables = [
        Some(&recording.q),
        recording.qd.as_ref(),
        recording.qdd.as_ref(),
        Some(&recording.tau),
        truth.map(|signals| &signals.q),
        truth.map(|signals| &signals.qd),
        truth.map(|signals| &signals.qdd),
        truth.map(|signals| &signals.tau),
    ];
    let mut bits: Vec<u64> = recording.time.iter().map(|time| time.to_bits()).collect();
    for table in tables {
        bits.push(table.map_or(0, |table| table.channels() as u64));
        bits.extend(table.into_iter().flat_map(|table| table.as_slice()).map(|value| value.to_bits()));
    }
    bits
}

/// Any finite number: zeros of both signs, subnormal, normal up to the largest.
fn value() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![
        8 => POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO,
        1 => prop::sample::select(vec![-0.0, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324, -5e-324, 0.1 + 0.2]),
    ]
}

/// Any recording of 1 to 3 joints with or without the optional tables.
pub(super) fn any_recording() -> impl Strategy<Value = Recording> {
    let time = prop::collection::vec(value(), 1..12).prop_map(|mut time| {
        time.sort_by(f64::total_cmp);
        time.dedup();
        time
    });
    (1usize..4, time).prop_flat_map(|(joints, time)| {
        let samples = time.len();
        let table = move || {
            prop::collection::vec(prop::collection::vec(value(), samples), joints)
                .prop_map(|vectors| Channels::from_vectors(&vectors))
        };
        let truth = (table(), table(), table(), table()).prop_map(|(q, qd, qdd, tau)| Signals { q, qd, qdd, tau });
        (
            table(),
            prop::option::of(table()),
            prop::option::of(table()),
            table(),
            prop::option::of(truth),
            prop::collection::btree_map(".*", ".*", 0..3),
        )
            .prop_map(move |(q, qd, qdd, tau, truth, provenance)| Recording {
                robot: "any \"robot\"".into(),
                joints: (0..joints).map(|joint| format!("gelenk ä,{joint}")).collect(),
                time: time.clone(),
                q,
                qd,
                qdd,
                tau,
                truth: truth.map(Arc::new),
                provenance,
            })
    })
}
