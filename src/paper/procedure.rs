//! The procedure of the paper's Figure 3, as the stages that ran and the time each took.

use std::time::Instant;

/// A stage, in the order of the data flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Arm, spatial model and 78-parameter model.
    Model,
    /// The reference motions.
    Excitation,
    /// Rapier with controller.
    Simulation,
    /// Sensors.
    Measurement,
    /// Savitzky-Golay, and plain differences.
    Smoothing,
    /// Regressors along the motion.
    Regression,
    /// Equations (11)-(12).
    LevenbergMarquardt,
    /// The same logs by weighted least squares on the spatial model.
    LeastSquares,
    /// Torque errors on both motions.
    Validation,
}

impl Stage {
    /// All stages in order.
    pub(crate) const ALL: [Stage; 9] = [
        Stage::Model,
        Stage::Excitation,
        Stage::Simulation,
        Stage::Measurement,
        Stage::Smoothing,
        Stage::Regression,
        Stage::LevenbergMarquardt,
        Stage::LeastSquares,
        Stage::Validation,
    ];

    /// Name in results.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Stage::Model => "model",
            Stage::Excitation => "excitation",
            Stage::Simulation => "simulation",
            Stage::Measurement => "measurement",
            Stage::Smoothing => "smoothing",
            Stage::Regression => "regression",
            Stage::LevenbergMarquardt => "levenberg_marquardt",
            Stage::LeastSquares => "least_squares",
            Stage::Validation => "validation",
        }
    }

    /// What is done in it.
    pub(crate) fn what(self) -> &'static str {
        match self {
            Stage::Model => {
                "base parameters of the spatial arm; rank and groups of the 78 parameters in three variants"
            }
            Stage::Excitation => "scenario and URDF read; Freudenstein 1-3-5 sequences fitted into the limits",
            Stage::Simulation => {
                "rapier forward dynamics with friction and an imperfect controller, training and held-out motion"
            }
            Stage::Measurement => "encoders and torque sensors with noise; velocity and acceleration by differences",
            Stage::Smoothing => "position, velocity, acceleration through Savitzky-Golay; and the raw signals",
            Stage::Regression => {
                "torque and regressor columns through the same filter, samples near reversals left out"
            }
            Stage::LevenbergMarquardt => {
                "(11)-(12) on the 78 parameters, three variants, raw and smoothed, and on the spatial model"
            }
            Stage::LeastSquares => "weighted least squares on the base parameters of the spatial arm, raw and smoothed",
            Stage::Validation => {
                "torque residual and torque error of every fit on the training and the held-out motion"
            }
        }
    }
}

/// Time spent in each stage; a stage that runs several times adds up.
#[derive(Debug, Clone, Default)]
pub(crate) struct Procedure {
    seconds: [f64; Stage::ALL.len()],
}

impl Procedure {
    /// Does `work` on the clock of `stage`.
    pub(crate) fn time<T>(&mut self, stage: Stage, work: impl FnOnce() -> T) -> T {
        let started = Instant::now();
        let result = work();
        self.seconds[stage as usize] += started.elapsed().as_secs_f64();
        result
    }

    /// Time spent in `stage`, s.
    pub(crate) fn seconds(&self, stage: Stage) -> f64 {
        self.seconds[stage as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_go_to_their_own_stage() {
        let mut procedure = Procedure::default();
        assert_eq!(procedure.time(Stage::Regression, || 7), 7);
        for stage in Stage::ALL {
            assert_eq!(procedure.seconds(stage) > 0.0, stage == Stage::Regression, "{stage:?}");
        }
        for (index, stage) in Stage::ALL.into_iter().enumerate() {
            assert_eq!(stage as usize, index, "ALL is in the order of the declaration");
        }
    }
}
