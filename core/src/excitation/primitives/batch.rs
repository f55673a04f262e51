//! Laws of motion at many times at once, several of them side by side.

use super::reference::Reference;
use super::timing;
use crate::channels::Channels;
use crate::lane::{Kernel, Lane, Lanes};
use std::ops::Range;

/// The law of one joint, or of a part of its motion. It is written once for single times and for several side by side.
pub(crate) trait Law {
    /// Position, velocity and acceleration at times `t`, s.
    fn at<L: Lane>(&self, t: L) -> [L; 3];
}

/// Times in ascending order and where to write position, velocity and acceleration at each of them.
pub(crate) struct Sheet<'a> {
    times: &'a [f64],
    out: [&'a mut [f64]; 3],
}

impl Sheet<'_> {
    /// Writes what `law` says at all times.
    pub(crate) fn write(&mut self, lanes: Lanes, law: &impl Law) {
        self.write_part(lanes, law, 0..self.times.len());
    }

    /// Writes what the law of every segment says at its times.
    pub(crate) fn write_segments<W: Law>(&mut self, knots: &[f64], law: impl Fn(usize) -> W) {
        let mut first = 0;
        while first < self.times.len() {
            let segment = timing::segment(knots, self.times[first]);
            let rest = &self.times[first..];
            // The last segment holds whatever comes after it.
            let count = match knots.get(segment + 1) {
                Some(end) if segment + 2 < knots.len() => rest.partition_point(|t| t < end),
                _ => rest.len(),
            };
            let part = first..first + count.max(1);
            first = part.end;
            self.write_part(Lanes::best(), &law(segment), part);
        }
    }

    fn write_part(&mut self, lanes: Lanes, law: &impl Law, part: Range<usize>) {
        let times = &self.times[part.clone()];
        let [q, qd, qdd] = &mut self.out;
        let out = [&mut q[part.clone()], &mut qd[part.clone()], &mut qdd[part]];
        lanes.run(Writing { law, times, out });
    }
}

/// [`Reference::along`] for a motion that is zero at both ends, from the law of each joint.
pub(crate) fn fill_along(
    reference: &impl Reference,
    times: &[f64],
    [q, qd, qdd]: [&mut Channels; 3],
    joint_law: impl Fn(usize, &mut Sheet),
) {
    let first = times.partition_point(|&t| t <= 0.0);
    let moving = first..times.partition_point(|&t| t < reference.duration_s()).max(first);
    for joint in 0..reference.joints() {
        let out = [&mut *q, &mut *qd, &mut *qdd].map(|signals| {
            let signal = signals.channel_mut(joint);
            signal[..moving.start].fill(0.0);
            signal[moving.end..].fill(0.0);
            &mut signal[moving.clone()]
        });
        joint_law(joint, &mut Sheet { times: &times[moving.clone()], out });
    }
}

struct Writing<'a, W> {
    law: &'a W,
    times: &'a [f64],
    out: [&'a mut [f64]; 3],
}

impl<W: Law> Kernel for Writing<'_, W> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let [q, qd, qdd] = self.out;
        let mut first = 0;
        while first < self.times.len() {
            let here = first..self.times.len().min(first + L::WIDTH);
            let [position, velocity, acceleration] = self.law.at(L::load_part(&self.times[here.clone()]));
            position.store_part(&mut q[here.clone()]);
            velocity.store_part(&mut qd[here.clone()]);
            acceleration.store_part(&mut qdd[here.clone()]);
            first = here.end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::encoding::{BsplineEncoding, Encoding, FourierEncoding, QuinticEncoding, random_point};
    use crate::excitation::random_sequence::FreudensteinEncoding;
    use crate::excitation::testing::{irb1600, state};

    #[test]
    fn many_times_are_as_one_at_a_time() {
        let limits = irb1600();
        let encodings: [Box<dyn Encoding>; 5] = [
            Box::new(FreudensteinEncoding::new(&limits, 6, 10.0).unwrap()),
            Box::new(FourierEncoding::new(&limits, 5, 5.0, 2).unwrap()),
            Box::new(QuinticEncoding::new(&limits, 6, 10.0, true).unwrap()),
            Box::new(QuinticEncoding::new(&limits, 6, 10.0, false).unwrap()),
            Box::new(BsplineEncoding::new(&limits, 11, 5, 10.0).unwrap()),
        ];
        for encoding in encodings {
            let motion = encoding.decode(&random_point(&*encoding, 3, "many times", 0));
            for (first, step, count) in
                [(0.0, 0.01, 1001), (-0.5, 0.37, 40), (2.013, 1e-3, 13), (9.9, 0.1, 9), (1.0, 1.0, 0)]
            {
                let times: Vec<f64> = (0..count).map(|k| first + step * f64::from(k)).collect();
                let [mut q, mut qd, mut qdd] = [(); 3].map(|()| Channels::zeros(6, times.len()));
                [&mut q, &mut qd, &mut qdd].into_iter().for_each(|signals| signals.as_mut_slice().fill(f64::NAN));
                motion.along(&times, [&mut q, &mut qd, &mut qdd]);
                for (sample, &t) in times.iter().enumerate() {
                    for (signals, expected) in [&q, &qd, &qdd].into_iter().zip(state(&motion, t)) {
                        for (own, other) in signals.at(sample).iter().zip(expected) {
                            assert!((own - other).abs() < 1e-12, "{} at {t}: {own} {other}", motion.kind());
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_series_of_very_many_periods_keeps_its_digits() {
        let encoding = FourierEncoding::new(&irb1600(), 5, 1e6, 1_000_000).unwrap();
        let motion = encoding.decode(&random_point(&encoding, 3, "many periods", 0));
        let times: Vec<f64> = (0..20).map(|k| 999_000.0 + 0.05 * f64::from(k)).collect();
        let [mut q, mut qd, mut qdd] = [(); 3].map(|()| Channels::zeros(6, times.len()));
        motion.along(&times, [&mut q, &mut qd, &mut qdd]);
        for (sample, &t) in times.iter().enumerate() {
            assert_eq!(q.at(sample), state(&motion, t)[0]);
        }
    }
}
