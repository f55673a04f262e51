//! Logs in another unit whose description is wrong besides.

use super::*;
use crate::quality::OtherUnit;

#[test]
fn a_wrong_sign_is_found_together_with_degrees() {
    let robot = irb();
    let wrong = Description::as_given(6, robot.gravity).with(Change::TorqueSign(2));
    let mut logs = [7, 8].map(|seed| simulated(&robot, Oddity::None, 15.0, seed));
    for log in &mut logs {
        wrong.apply(&mut log.recording);
        let q = &mut log.recording.q;
        (0..6).for_each(|joint| q.channel_mut(joint).iter_mut().for_each(|q| *q = q.to_degrees()));
    }
    let together = examine_together(&[&logs[0], &logs[1]], Some(&robot)).unwrap();
    assert_eq!(together.verdict.unwrap().description.changes, [Change::TorqueSign(2)]);
    assert_eq!(together.reports[0].units.positions, [Some(OtherUnit::Degree); 6]);
}
