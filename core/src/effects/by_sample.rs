//! Channels turned over: all joints of one sample side by side, as laws ask for them.

use crate::channels::Channels;
use crate::dynamics::Motion;

/// Values of all joints, sample after sample.
#[derive(Debug, Clone)]
pub(crate) struct Turned {
    joints: usize,
    values: Vec<f64>,
}

impl Turned {
    /// Of channels `[joint][time]`.
    pub(crate) fn of(channels: &Channels) -> Turned {
        let (joints, samples) = (channels.channels(), channels.samples());
        let mut values = vec![0.0; joints * samples];
        for (joint, channel) in channels.iter().enumerate() {
            channel.iter().enumerate().for_each(|(sample, value)| values[sample * joints + joint] = *value);
        }
        Turned { joints, values }
    }

    /// The values of all joints at a sample.
    #[inline]
    pub(crate) fn at(&self, sample: usize) -> &[f64] {
        &self.values[sample * self.joints..(sample + 1) * self.joints]
    }
}

/// A motion, sample after sample.
#[derive(Debug, Clone)]
pub(crate) struct BySample {
    /// Positions.
    pub q: Turned,
    /// Velocities.
    pub qd: Turned,
    /// Accelerations.
    pub qdd: Turned,
}

impl BySample {
    /// Of a motion.
    pub(crate) fn of(motion: &Motion) -> BySample {
        let [q, qd, qdd] = [&motion.q, &motion.qd, &motion.qdd].map(Turned::of);
        BySample { q, qd, qdd }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_of_a_sample_are_side_by_side() {
        let turned = Turned::of(&Channels::from_vectors(&[vec![1.0, 2.0, 3.0], vec![4.0, 5.0, 6.0]]));
        assert_eq!((turned.at(0), turned.at(2)), (&[1.0, 4.0][..], &[3.0, 6.0][..]));
    }
}
