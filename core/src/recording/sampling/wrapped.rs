//! Clocks that begin again: times of day over midnight, and counters of a microcontroller that ran over.

/// Seconds of a day, and what counters of 16, 31 and 32 bits hold.
const TURNS: [f64; 4] = [86_400.0, 65_536.0, 2_147_483_648.0, 4_294_967_296.0];

/// A clock that ran over goes on within so many steps.
const STEPS: f64 = 20.0;

/// A clock runs over near the end of its range, within this share of it, or so many of its steps.
const NEAR_THE_END: f64 = 0.02;

/// Adds a turn where times fall from the end of a range to its beginning and go on there; returns what was done.
pub(super) fn undo(time: &mut [f64]) -> Option<String> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let middle = steps.len() / 2;
    let usual = *(middle > 0).then(|| steps.select_nth_unstable_by(middle, f64::total_cmp).1)?;
    let falls: Vec<usize> = (1..time.len()).filter(|&row| time[row] < time[row - 1]).collect();
    let (first, last) = (*falls.first()?, time.iter().copied().fold(0.0, f64::max));
    let ran_over = |turn: &f64| {
        let margin = (NEAR_THE_END * turn).min(STEPS * usual);
        last < *turn
            && time.iter().all(|t| !t.is_finite() || *t >= 0.0)
            && falls.iter().all(|&row| {
                let step = time[row] + turn - time[row - 1];
                time[row - 1] > turn - margin && step > 0.0 && step < STEPS * usual
            })
    };
    let turn = TURNS.into_iter().find(ran_over)?;
    let mut turns = 0.0;
    let mut before = time[0];
    for t in &mut time[1..] {
        turns += if *t < before { turn } else { 0.0 };
        before = *t;
        *t += turns;
    }
    Some(format!("the clock began again after {turn} in row {}, and went on: undone", first + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_that_run_over_go_on_and_others_stay() {
        for (turn, step) in [(86_400.0, 0.004), (65_536.0, 5.0), (4_294_967_296.0, 2000.0)] {
            let even: Vec<f64> = (0..400).map(|k| turn - 200.5 * step + step * f64::from(k)).collect();
            let mut wrapped: Vec<f64> = even.iter().map(|t| t % turn).collect();
            assert!(undo(&mut wrapped).is_some(), "{turn}");
            assert!(wrapped.iter().zip(&even).all(|(a, b)| (a - b).abs() < 1e-6 * step), "{turn}");
        }
        // A recording behind another, a clock that was set back, and one that only goes on.
        for mut time in [
            (0..400).map(|k| 0.01 * f64::from(k % 200)).collect::<Vec<_>>(),
            (0..400).map(|k| 86_000.0 + 0.01 * f64::from(k) - if k > 200 { 0.5 } else { 0.0 }).collect(),
            (0..400).map(|k| 0.01 * f64::from(k)).collect(),
            vec![],
        ] {
            let before = time.clone();
            assert_eq!(undo(&mut time), None);
            assert_eq!(time, before);
        }
    }
}
