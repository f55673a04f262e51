//! Names of columns as programs write them.

use super::*;

fn first(column: &str) -> Option<(usize, Joint)> {
    let measured = |meaning: &Meaning| !meaning.exact_only && !meaning.of_controller;
    meanings(column).into_iter().find(measured).map(|meaning| (meaning.quantity, meaning.joint))
}

#[test]
fn numbers_behind_the_quantity() {
    for (column, quantity, number) in [
        ("q1", POSITION, 1),
        ("TAU_2", TORQUE, 2),
        ("actual_q_0", POSITION, 0),
        ("actual_qd_5", VELOCITY, 5),
        ("state.q[0]", POSITION, 0),
        ("dq[6]", VELOCITY, 6),
        ("tau_J[3]", TORQUE, 3),
        ("tau_J_3", TORQUE, 3),
        ("/joint_states/position[2]", POSITION, 2),
        ("/joint_states/velocity.2", VELOCITY, 2),
        ("/arm/joint_states/position[2]", POSITION, 2),
        ("/franka_state_controller/joint_states/velocity[3]", VELOCITY, 3),
        ("/torques/effort[0]", TORQUE, 0),
        ("field.effort4", TORQUE, 4),
        ("observation.state[1]", POSITION, 1),
        ("observation.effort[1]", TORQUE, 1),
        ("jointPositions_3", POSITION, 3),
        ("measured_torque_4", TORQUE, 4),
        ("joint_pos_2", POSITION, 2),
        ("q_dot_1", VELOCITY, 1),
        ("q1 [rad]", POSITION, 1),
        ("torques[0]", TORQUE, 0),
        ("$TORQUE_AXIS_ACT[1]", TORQUE, 1),
        ("$VEL_AXIS_ACT[1]", VELOCITY, 1),
        ("$AXIS_ACT_MEAS[1]", POSITION, 1),
        ("('q', 0)", POSITION, 0),
        ("present_position_1", POSITION, 1),
        ("Actual Joint Positions 2", POSITION, 2),
        ("measured_joint_state.position[0]", POSITION, 0),
        ("joint_torque_measured[3]", TORQUE, 3),
        ("applied_torque_0", TORQUE, 0),
        ("actuator_force[2]", TORQUE, 2),
        ("tau_out_1", TORQUE, 1),
        ("feedback_pos_4", POSITION, 4),
        ("dof_force_1", TORQUE, 1),
        ("DTRQ2(%)", TORQUE, 2),
        ("Load ratio 3 (%)", TORQUE, 3),
        ("axisQMsr_LBR_iiwa_7_R800_1[0]", POSITION, 0),
        ("axisTauMsr_LBR_iiwa_14_R820_1[6]", TORQUE, 6),
    ] {
        assert_eq!(first(column), Some((quantity, Joint::Number(number))), "{column}");
    }
    for column in ["actual_current_2", "i_actual[0]", "joint_control_output_3", "$CURR_ACT[1]", "effort_current_5"] {
        assert!(meanings(column)[0].current, "{column}");
    }
}

#[test]
fn names_before_and_behind_the_quantity() {
    for (column, quantity, name) in [
        ("q_elbow", POSITION, "elbow"),
        ("elbow_joint_effort", TORQUE, "elbow_joint"),
        ("/joint_states/position/elbow_joint", POSITION, "elbow_joint"),
        ("/joint_states/elbow_joint/velocity", VELOCITY, "elbow_joint"),
        ("position_elbow_joint", POSITION, "elbow_joint"),
        ("effort_joint_1", TORQUE, "joint_1"),
        ("elbow_eff", TORQUE, "elbow"),
        ("elbow_flex.pos", POSITION, "elbow_flex"),
        ("joint_1_vel", VELOCITY, "joint_1"),
        ("q_joint_1", POSITION, "joint_1"),
        ("$AXIS_ACT.A1", POSITION, "A1"),
        ("$AXIS_ACT_A1", POSITION, "A1"),
        ("AxisVel_A1", VELOCITY, "A1"),
        ("Torque_A1", TORQUE, "A1"),
        ("TorqueAct_A1", TORQUE, "A1"),
        ("MotorTorque_A1", TORQUE, "A1"),
        ("TORQUE_AXIS_ACT_A1", TORQUE, "A1"),
        ("rob1_1 position", POSITION, "rob1_1"),
        ("('elbow', 'effort')", TORQUE, "elbow"),
        ("/dynamic_joint_states/elbow/velocity", VELOCITY, "elbow"),
        ("elbow.actual.position", POSITION, "elbow"),
        ("left/elbow/position", POSITION, "left/elbow"),
        ("jointpos_elbow", POSITION, "elbow"),
        ("/kinova/joint_states/position/j2s6s200_joint_6", POSITION, "kinova/joint_states/j2s6s200_joint_6"),
        ("/my_arm/state/effort/elbow", TORQUE, "my_arm/state/elbow"),
    ] {
        assert_eq!(first(column), Some((quantity, Joint::Name(name.to_owned()))), "{column}");
    }
    assert!(meanings("elbow_current")[0].current);
}

#[test]
fn what_was_not_measured_at_a_joint_is_left() {
    for column in [
        "target_q_0",
        "target_moment_3",
        "actual_TCP_pose_0",
        "actual_TCP_speed_1",
        "elbow_position_0",
        "q_d[1]",
        "tau_J_d_0",
        "tau_ext_hat_filtered_2",
        "O_T_EE[12]",
        "desired_position_0",
        "q_cmd_1",
        "action[0]",
        "robot_mode",
        "status",
        "current",
        "actual_joint_voltage_0",
        "joint_temperatures_0",
        "frame_index",
        "/my_arm/desired/position/elbow",
        "/my_arm/elbow/position/actual",
    ] {
        assert_eq!(first(column), None, "{column}");
    }
    // A joint may be called like that.
    assert!(meanings("q_tool").iter().any(|meaning| meaning.joint == Joint::Name("tool".into())));
}

#[test]
fn torques_of_a_controller_are_known_as_that() {
    let of = |column: &str| meanings(column).into_iter().find(|meaning| meaning.of_controller);
    for (column, joint) in [
        ("target_moment_0", Joint::Number(0)),
        ("tau_J_d_3", Joint::Number(3)),
        ("torque_cmd_2", Joint::Number(2)),
        ("desired_torque[1]", Joint::Number(1)),
        ("computed_torque_1", Joint::Number(1)),
        ("elbow_effort_cmd", Joint::Name("elbow".into())),
    ] {
        let meaning = of(column).unwrap_or_else(|| panic!("{column}"));
        assert_eq!((meaning.quantity, meaning.joint), (TORQUE, joint), "{column}");
    }
    for column in ["target_q_0", "actual_TCP_force_0", "tau_ext_hat_filtered_2", "tau_1", "position_error_1"] {
        assert_eq!(of(column), None, "{column}");
    }
}

#[test]
fn units_in_names() {
    for (column, symbol) in [
        ("q1 [deg]", Some("deg")),
        ("q1 (deg)", Some("deg")),
        ("q1_deg", Some("deg")),
        ("q_deg_1", Some("deg")),
        ("elbow_position[deg]", Some("deg")),
        ("elbow_position_deg", Some("deg")),
        ("elbow_velocity_rpm", Some("rpm")),
        ("velocity_rpm[2]", Some("rpm")),
        ("qd3 [mm/s]", Some("mm/s")),
        ("tau2 [kgf.cm]", Some("kgf cm")),
        ("tau2_mNm", Some("mN m")),
        ("tau2_Ncm", Some("N cm")),
        ("tau2_N_m", Some("N m")),
        ("qd2_rad_s", Some("rad/s")),
        ("elbow_torque_kgf_cm", Some("kgf cm")),
        ("tau2_lbf-in", Some("lbf in")),
        ("elbow_position_radians", Some("rad")),
        ("tau2 [%]", None),
        ("q1 [rad/s]", None),
        ("q1", None),
    ] {
        let meaning = &meanings(column)[0];
        assert_eq!(meaning.unit.map(|unit| unit.symbol), symbol, "{column}");
        assert!(matches!(&meaning.joint, Joint::Number(_)) || meaning.joint == Joint::Name("elbow".into()), "{column}");
    }
    assert!(meanings("tau1 [mA]")[0].current && meanings("MtrCur2[%]")[0].current);
    // A letter is a unit behind its quantity alone.
    let of = |column: &str| {
        meanings(column).into_iter().find(|meaning| meaning.unit.is_some()).map(|m| (m.joint, m.unit.unwrap().symbol))
    };
    assert_eq!(of("axis1_current_A"), Some((Joint::Name("axis1".into()), "A")));
    assert_eq!((of("axis1_position_A"), of("effort_a")), (None, None));
    // A joint may be called like a unit.
    assert_eq!(meanings("q_elbow_deg")[0].joint, Joint::Name("elbow_deg".into()));
}

#[test]
fn columns_of_time() {
    let factor = |column: &str| time(column, 1).map(|time| time.factor);
    for column in [
        "t",
        "Time",
        "('t', '')",
        "timestamp",
        "SampleTime",
        "stamp",
        "__time",
        "%time",
        "rosbagTimestamp",
        "/joint_states/header/stamp",
    ] {
        assert_eq!(factor(column), Some(None), "{column}");
    }
    for (column, expected) in [
        ("millis", 1e-3),
        ("time_ns", 1e-9),
        ("timestamp_us", 1e-6),
        ("Time (ms)", 1e-3),
        ("t[s]", 1.0),
        ("time_sec", 1.0),
        ("t_min", 60.0),
        ("utime", 1e-6),
    ] {
        assert_eq!(factor(column), Some(Some(expected)), "{column}");
    }
    for column in ["header.stamp.sec", "/joint_states/header/stamp/sec", "field.header.stamp.secs", "sec"] {
        assert_eq!(time(column, 1).unwrap().part, Part::Seconds, "{column}");
    }
    for column in ["header.stamp.nanosec", "stamp_nsecs", "nanosec"] {
        assert_eq!(time(column, 1).unwrap().part, Part::Nanoseconds, "{column}");
    }
    assert_eq!(time("ZeitInSec", 0).unwrap().part, Part::Seconds);
    assert_eq!(time("ZeitInNanoSec", 1).unwrap().part, Part::Nanoseconds);
    assert_eq!(time("", 0).unwrap().rank, INDEX);
    assert_eq!((time("", 3), time("dead_time_ms", 0), time("seq", 0)), (None, None, None));
}

#[test]
fn the_present_value_and_units_of_words() {
    let joint = |column: &str| first(column).map(|(quantity, joint)| (quantity, joint, meanings(column)[0].current));
    for (column, quantity) in [
        ("joint1 current torque", TORQUE),
        ("joint1_Drehmoment", TORQUE),
        ("joint1 present velocity", VELOCITY),
        ("joint1 actual position", POSITION),
    ] {
        assert_eq!(joint(column), Some((quantity, Joint::Name("joint1".into()), false)), "{column}");
    }
    assert_eq!(joint("current_torque_2"), Some((TORQUE, Joint::Number(2), false)));
    for column in ["joint1_current", "joint1_motor_current", "joint1_actual_current"] {
        assert!(meanings(column)[0].current, "{column}");
    }
    // The current of an axis of the motor is no position.
    assert!(first("current_q_1").is_none_or(|(quantity, _)| quantity != POSITION));
    let unit = |column: &str| {
        let found = meanings(column).into_iter().find(|meaning| meaning.unit.is_some())?;
        Some((found.quantity, found.joint, found.unit?.symbol))
    };
    let achse = || Joint::Name("Achse1".into());
    assert_eq!(unit("Achse1_Istposition_Grad"), Some((POSITION, achse(), "deg")));
    assert_eq!(unit("Achse1_Winkel_Grad"), Some((POSITION, achse(), "deg")));
    assert_eq!(unit("Achse1_Geschwindigkeit_Grad/s"), Some((VELOCITY, achse(), "deg/s")));
    assert_eq!(unit("Achse1_Drehmoment_Nm"), Some((TORQUE, achse(), "N m")));
    for column in ["joint1_torque_N-m", "joint1_torque_N.m", "joint1_torque_N*m", "joint1_torque_Nm"] {
        assert_eq!(unit(column), Some((TORQUE, Joint::Name("joint1".into()), "N m")), "{column}");
    }
}
