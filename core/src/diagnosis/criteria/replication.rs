//! Thresholds of what held-out logs say, for effects, structure and impacts alike.

use serde::Serialize;

/// Thresholds at which held-out logs replicate what training logs show. One question has one level, whatever it is asked about.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ReplicationCriteria {
    /// Highest p-value of the training logs, corrected for what was looked for there, at which held-out logs are asked: above it what they
    /// would confirm is as likely as not chance.
    pub asked_p: f64,
    /// Highest p-value of the held-out logs at which they show the same again, and at which they contradict it: the usual 5 %.
    pub again_p: f64,
    /// Highest p-value of the held-out logs at which they lean the same way: what goes with noise alone as often contradicts as it
    /// supports.
    pub leans_p: f64,
    /// Highest p-value of the held-out logs by themselves that confirms what has no prediction for other logs.
    pub alone_p: f64,
    /// Factor by which the level of a second attempt at held-out logs is below that of the only one. The first has the rest of the level, so
    /// that a second one is possible and the first hardly pays for it.
    pub second_attempt: f64,
}

impl Default for ReplicationCriteria {
    fn default() -> Self {
        ReplicationCriteria { asked_p: 0.5, again_p: 0.05, leans_p: 0.2, alone_p: 0.01, second_attempt: 5.0 }
    }
}

impl ReplicationCriteria {
    /// Factors on the held-out p-value by attempt, under which the attempts share one level.
    pub(crate) fn attempts(&self) -> [f64; 2] {
        [1.0 / (1.0 - 1.0 / self.second_attempt), self.second_attempt]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attempts_share_the_level() {
        let attempts = ReplicationCriteria::default().attempts();
        assert!((attempts.iter().map(|factor| 1.0 / factor).sum::<f64>() - 1.0).abs() < 1e-12, "{attempts:?}");
        assert_eq!(attempts[1], 5.0);
    }
}
