//! The order of the joints of a log.

use crate::channels::Channels;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;

/// Takes the joints `wanted` of a log whose joints are `names`.
pub(super) fn select(sieved: &mut Sieved, names: &[String], wanted: &[String]) {
    if names != wanted {
        let place = |name: &String| names.iter().position(|own| own == name);
        let order: Vec<usize> = wanted.iter().filter_map(place).collect();
        reorder(&mut sieved.recording, &order);
        let turn = |own: usize| sieved.unwrapped.iter().find(|(joint, _)| *joint == own).map(|(_, turn)| *turn);
        sieved.unwrapped = (0..order.len()).filter_map(|joint| Some((joint, turn(order[joint])?))).collect();
    }
}

/// Puts joint `order[i]` of a log at place `i`; joints without a place are left out.
fn reorder(log: &mut Recording, order: &[usize]) {
    let pick = |table: &Channels| {
        Channels::from_vectors(&order.iter().map(|&joint| table.channel(joint).to_vec()).collect::<Vec<_>>())
    };
    log.joints = order.iter().map(|&joint| log.joints[joint].clone()).collect();
    log.q = pick(&log.q);
    // Where none of the joints that are left has one there is none.
    let of_any = |table: &Channels| Some(pick(table)).filter(|t| !t.as_slice().iter().all(|value| value.is_nan()));
    log.qd = log.qd.as_ref().and_then(of_any);
    log.qdd = log.qdd.as_ref().and_then(of_any);
    log.tau = pick(&log.tau);
}
