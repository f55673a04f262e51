//! Struts are found wherever they stand.

use super::{SETUP, diagnosed, logs, with};
use tauscope::effects::{Placed, find};

/// The test of a strut has several maxima over its angle: a constant pull at 0.3 rad was taken for a spring a quarter turn away.
#[test]
fn the_angle_of_a_strut_is_found_all_around_its_joint() {
    for (angle, seed) in [(-1.0, 61), (0.3, 62), (1.9, 63)] {
        let parameters = vec![600.0, 0.0, 0.66, angle];
        let strut = Placed { effect: find("gravity_balancer").unwrap(), joint: 1, parameters };
        let logs = logs(&with(&[strut]), seed, 3);
        let diagnosis = diagnosed(&SETUP.known, &logs, &["gravity_balancer"]);
        let [found] = &diagnosis.found[..] else { panic!("{angle}: {:?}", diagnosis.found) };
        let (value, std) = (found.member.placed.parameters[3], found.member.std[3]);
        assert!(found.member.candidate.family().joint == 1 && (value - angle).abs() < 4.0 * std.max(0.01), "{value}");
    }
}
