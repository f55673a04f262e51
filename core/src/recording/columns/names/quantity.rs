//! The measured quantities and what programs call them.

/// Index of position among the quantities.
pub(crate) const POSITION: usize = 0;
/// Index of velocity.
pub(crate) const VELOCITY: usize = 1;
/// Index of acceleration.
pub(crate) const ACCELERATION: usize = 2;
/// Index of torque.
pub(crate) const TORQUE: usize = 3;

/// Ending of a column of the truth behind a simulated log.
pub(crate) const TRUE: &str = "_true";

/// A measured quantity and how its columns are called: `q1`, `q_elbow` or `elbow_position`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quantity {
    /// Name in messages.
    pub name: &'static str,
    /// What stands before the joint; the first is written.
    pub prefixes: &'static [&'static str],
    /// What stands behind the joint; the first is written.
    pub suffixes: &'static [&'static str],
    /// How other programs call it, in small letters with `_` between the words.
    pub(super) words: &'static [&'static str],
}

/// The quantities by their index.
pub(crate) const QUANTITIES: [Quantity; 4] = [
    Quantity {
        name: "position",
        prefixes: &["q"],
        suffixes: &["_position"],
        words: &[
            "q",
            "pos",
            "position",
            "positions",
            "angle",
            "angles",
            "qpos",
            "dof_pos",
            "dof_position",
            "jpos",
            "jointpos",
            "istposition",
            "istwinkel",
            "state",
            "winkel",
            "posicion",
            "posicao",
            "angulo",
            "posizione",
            "theta",
            "θ",
            "axis_pos",
            "axis_position",
            "axis_act",
            "aipos",
            "axis_qmsr",
        ],
    },
    Quantity {
        name: "velocity",
        prefixes: &["qd", "dq"],
        suffixes: &["_velocity"],
        words: &[
            "qd",
            "dq",
            "qdot",
            "q_dot",
            "vel",
            "velo",
            "velocity",
            "velocities",
            "speed",
            "speeds",
            "qvel",
            "dof_vel",
            "dof_velocity",
            "jvel",
            "jointvel",
            "istgeschwindigkeit",
            "geschwindigkeit",
            "vitesse",
            "velocidad",
            "velocita",
            "velocite",
            "velocidade",
            "axis_vel",
            "axis_velocity",
            "axis_speed",
            "vel_axis",
            "motor_vel",
            "motor_velocity",
            "motor_speed",
            "theta_dot",
            "thetadot",
            "angular_velocity",
            "ang_vel",
            "omega",
            "ω",
        ],
    },
    Quantity {
        name: "acceleration",
        prefixes: &["qdd", "ddq"],
        suffixes: &["_acceleration"],
        words: &["qdd", "ddq", "qddot", "q_ddot", "acc", "accel", "acceleration", "accelerations", "qacc", "dof_acc"],
    },
    Quantity {
        name: "torque",
        prefixes: &["tau"],
        suffixes: &["_effort", "_torque"],
        words: &[
            "tau",
            "tau_j",
            "torque",
            "torques",
            "trq",
            "effort",
            "efforts",
            "eff",
            "dof_torque",
            "dof_effort",
            "dof_force",
            "dof_forces",
            "actuator_force",
            "actuatorfrc",
            "jointactuatorfrc",
            "joint_force",
            "istmoment",
            "istdrehmoment",
            "jts",
            "dtrq",
            "load_ratio",
            "load_rate",
            "load_factor",
            "jtor",
            "jtrq",
            "jtau",
            "tor",
            "tq",
            "qfrc_actuator",
            "load",
            "drehmoment",
            "moment",
            "couple",
            "coppia",
            "par",
            "par_motor",
            "axis_torque",
            "axis_tau",
            "axis_trq",
            "torque_axis",
            "motor_torque",
            "drive_torque",
            "current_as_torque",
            "m_actual",
            "qfrc",
            "u",
            "τ",
        ],
    },
];
