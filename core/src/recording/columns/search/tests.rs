//! Headers of every kind.

use super::*;

fn find(header: &str, joints: Option<&[&str]>) -> Result<Layout> {
    let header: Vec<String> = header.split(',').map(str::to_owned).collect();
    let joints: Option<Vec<String>> = joints.map(|joints| joints.iter().map(|&joint| joint.to_owned()).collect());
    Layout::find(Path::new("log.csv"), Some(1), &header, joints.as_deref())
}

fn problem(header: &str, joints: Option<&[&str]>) -> String {
    find(header, joints).unwrap_err().to_string()
}

#[test]
fn numbered_columns_in_any_order() {
    let layout = find("tau2,q1,time,q2,dq2,dq1,tau1", None).unwrap();
    assert_eq!((layout.time, layout.q, layout.tau), (2, vec![1, 3], vec![6, 0]));
    assert_eq!((layout.qd, layout.qdd, layout.truth), (Some(vec![5, 4]), None, None));
    assert_eq!(layout.joints, ["joint_1", "joint_2"]);
    assert!(layout.notes.is_empty());
}

#[test]
fn joint_names_in_columns() {
    for header in ["t,q_b,q_a,qd_a,qd_b,tau_a,tau_b", "t,b_position,a_position,a_velocity,b_velocity,a_effort,b_effort"]
    {
        let own = find(header, None).unwrap();
        assert_eq!((own.joints, own.q, own.tau), (vec!["b".into(), "a".into()], vec![1, 2], vec![6, 5]));
        let ordered = find(header, Some(&["a", "b"])).unwrap();
        assert_eq!((ordered.q, ordered.qd, ordered.tau), (vec![2, 1], Some(vec![3, 4]), vec![5, 6]));
    }
    let layout = find("t,q_1,q_2,ddq_1,ddq_2,tau_1,tau_2", Some(&["a", "b"])).unwrap();
    assert_eq!((layout.q, layout.qdd), (vec![1, 2], Some(vec![3, 4])));
}

/// Simulators log an angle with its cosine and sine; with a prefix before all names no positions were found.
#[test]
fn cosines_and_sines_of_positions_are_no_positions() {
    let of = |name: &str| format!("{name}[0],{name}[1],");
    let names = ["robot0_joint_pos", "robot0_joint_pos_cos", "robot0_joint_pos_sin", "torques"];
    let header = names.map(of).concat() + "time";
    for joints in [None, Some(&["a", "b"][..])] {
        let layout = find(&header, joints).unwrap();
        assert_eq!((layout.q, layout.tau, layout.time), (vec![0, 1], vec![6, 7], 8));
    }
}

#[test]
fn the_number_of_a_joint_among_others_in_its_name() {
    let header = "Time (ms),rob1_2 position,rob1_1 position,rob1_1 torque,rob1_2 torque";
    let layout = find(header, Some(&["a", "b"])).unwrap();
    assert_eq!((layout.q, layout.tau), (vec![2, 1], vec![3, 4]));
}

#[test]
fn quantities_of_several_words_around_a_known_joint() {
    let header = "t,qpos_X,qpos_fl,actuator_force_X,actuator_force_fl";
    assert_eq!(find(header, Some(&["X", "fl"])).unwrap().tau, [3, 4]);
    assert_eq!(find("t,X_position,Z_position,X_force,Z_force", Some(&["X", "Z"])).unwrap().tau, [3, 4]);
    // A force at the tool is none of a joint.
    let tool = find("t,q_a,tau_a,force_x,force_y", Some(&["a"])).unwrap();
    assert_eq!((tool.tau, tool.notes), (vec![2], vec!["columns not used: force_x, force_y".to_owned()]));
}

#[test]
fn torques_of_another_topic() {
    let columns = |topic: &str, field: &str| format!(",/{topic}/a/{field},/{topic}/b/{field}");
    let (positions, torques) = (columns("joint_states", "position"), columns("iiwa/torque_states", "effort"));
    let layout = find(&format!("t{positions}{torques}"), Some(&["a", "b"])).unwrap();
    assert_eq!((layout.q, layout.tau), (vec![1, 2], vec![3, 4]));
    // Those of two arms are not told apart.
    let other = columns("other/torque_states", "effort");
    let said = problem(&format!("t{positions}{torques}{other}"), Some(&["a", "b"]));
    assert!(
        said.contains("tau1: the columns of torque fit the robot's joints behind iiwa/torque_states/ and"),
        "{said}"
    );
}

#[test]
fn fields_of_a_topic_of_any_name() {
    let columns = |topic: &str| {
        let of = |field: &str| format!(",/{topic}/{field}/b,/{topic}/{field}/a");
        ["position", "velocity", "effort"].map(of).concat()
    };
    for topic in ["kinova/joint_states", "my_arm/state"] {
        let layout = find(&format!("__time{}", columns(topic)), Some(&["a", "b"])).unwrap();
        assert_eq!((layout.q, layout.qd, layout.tau), (vec![2, 1], Some(vec![4, 3]), vec![6, 5]), "{topic}");
    }
    // Names behind a prefix are surer than the numbers in them.
    let header = "__time,/a/position/j_1,/a/position/j_2,/a/effort/j_1,/a/effort/j_2";
    assert_eq!(find(header, Some(&["j_2", "j_1"])).unwrap().q, [2, 1]);
    // A point in space besides has no joints.
    let header = format!("__time{},/odom/pose/position/x,/odom/pose/position/y", columns("my_arm/state"));
    assert_eq!(
        find(&header, Some(&["a", "b"])).unwrap().notes,
        ["columns not used: /odom/pose/position/x, /odom/pose/position/y"]
    );
    let said = problem(&format!("__time{}{}", columns("left"), columns("right")), Some(&["a", "b"]));
    assert!(
        said.contains("q1: the columns of position fit the robot's joints behind left/ and right/ alike"),
        "{said}"
    );
}

#[test]
fn an_arm_of_two_is_to_be_chosen() {
    let header = "t,a_position,b_position,a_effort,b_effort";
    let said = problem(header, Some(&["left_a", "left_b", "right_a", "right_b"]));
    assert!(said.contains("behind left_ and right_ alike; choose with --tip LINK"), "{said}");
}

#[test]
fn as_many_numbers_beyond_the_joints_are_counted_from_the_lowest() {
    let layout = find("t,q_11,q_12,tau_11,tau_12", Some(&["a", "b"])).unwrap();
    assert_eq!((layout.q, layout.tau), (vec![1, 2], vec![3, 4]));
    assert_eq!(
        layout.understood,
        ["joints are numbered from 11: that is a, and the others follow in the order of the robot"]
    );
    // The numbers of each quantity may be others, as those of drives.
    assert_eq!(find("t,q_3,q_4,tau_1,tau_2", Some(&["a", "b"])).unwrap().q, [1, 2]);
    // One of them may be a joint's; there are more or fewer; there is a hole; the robot is not known.
    for (header, joints) in [
        ("t,q_2,q_3,tau_2,tau_3", Some(&["a", "b"][..])),
        ("t,q_11,q_12,q_13,tau_11,tau_12,tau_13", Some(&["a", "b"])),
        ("t,q_11,tau_11", Some(&["a", "b"])),
        ("t,q_11,q_13,tau_11,tau_13", Some(&["a", "b"])),
        ("t,q_11,q_12,tau_11,tau_12", None),
    ] {
        assert!(problem(header, joints).contains("log.csv:1: q"), "{header}");
    }
}

#[test]
fn names_in_another_encoding_and_torques_that_were_not_logged_are_told() {
    let said = problem("\u{8e}\u{9e}\u{8a}\u{d4},\u{8a}\u{d6}", Some(&["a"]));
    assert!(said.contains("save the file as UTF-8"), "{said}");
    let said = problem("t,q1,q2", Some(&["a", "b"]));
    assert!(said.contains("log the measured torques or motor currents") && !said.contains("UTF-8"), "{said}");
}

#[test]
fn other_columns_are_noted() {
    let layout = find("t,q1,tau1,current,q_reference,,status", None).unwrap();
    assert_eq!(layout.notes, ["columns not used: current, q_reference, (column 6), status"]);
    let layout = find("t,q_a,tau_a,q_gripper,tau_gripper", Some(&["a"])).unwrap();
    assert_eq!(layout.notes, ["columns not used: q_gripper, tau_gripper"]);
}

#[test]
fn truth_is_taken_only_when_whole() {
    let whole = find("t,q1,tau1,q1_true,qd1_true,qdd1_true,tau1_true", None).unwrap();
    assert_eq!(whole.truth, Some([vec![3], vec![4], vec![5], vec![6]]));
    let part = find("t,q1,tau1,q1_true,qd1_true,tau1_true", None).unwrap();
    assert_eq!(part.truth, None);
    assert!(part.notes[0].contains("_true"), "{:?}", part.notes);
}

#[test]
fn wrong_headers_are_named() {
    let six: &[&str] = &["a", "b", "c"];
    let cases = [
        ("q1,tau1", None, ["log.csv:1: t: missing column", "found: q1, tau1"]),
        ("t,tau1", None, ["log.csv:1: q1: missing column", "found: t, tau1"]),
        ("t,q1,q2,tau1", None, ["log.csv:1: tau2: missing column", "positions of 2 joints"]),
        ("t,q1,q2,qd2,tau1,tau2", None, ["log.csv:1: qd1: missing column", "hole"]),
        ("t,q1,q3,tau1,tau3", None, ["log.csv:1: q2: missing column", "a hole in the numbering: q3 is there"]),
        ("t,q1,q4000000000,tau1", None, ["log.csv:1: q2:", "hole"]),
        ("t,q1,tau1,tau2", None, ["log.csv:1: tau2:", "too many: there are positions of 1 joints"]),
        ("t,q1,q2,tau1,tau2", Some(six), ["log.csv:1: q3:", "fewer joints than the robot"]),
        ("t,q1,q2,q3,q4,tau1", Some(six), ["log.csv:1: q4:", "the robot has 3 joints (a, b, c)"]),
        ("t,q1,q3,q4,tau1", Some(six), ["log.csv:1: q2:", "a hole in the numbering: q3 is there, but no q2"]),
        ("t,q_x,tau_x", Some(six), ["log.csv:1: q1:", "(q1, q_a or a_position)"]),
        ("t,q_a,q_b,tau_a", None, ["log.csv:1: tau2:", "tau_b"]),
        ("t,q1,tau1", Some(&[]), ["log.csv:1: q1:", "the robot has 0 joints"]),
        ("t,q1,qd1,dq1,tau1", None, ["log.csv:1: dq1:", "the same as column qd1"]),
        ("t,time,q1,tau1", None, ["log.csv:1: time:", "the same as column t"]),
        ("0.0,1.5,2.5", None, ["log.csv:1: t:", "no line names the columns"]),
        ("Uhr,Stellung1,tau1", None, ["log.csv:1: t:", "in a dataset ([columns])"]),
    ];
    for (header, joints, expected) in cases {
        let problem = problem(header, joints);
        assert!(expected.iter().all(|part| problem.contains(part)), "{header}: {problem}");
    }
}

#[test]
fn joints_that_turn_and_joints_that_slide_have_words_of_their_own() {
    let header = "time,S1_angle,S2_angle,S3_position,S1_torque,S2_torque,S3_force";
    let layout = find(header, Some(&["S1", "S2", "S3"])).unwrap();
    assert_eq!((layout.q, layout.tau), (vec![1, 2, 3], vec![4, 5, 6]));
    let header = "t,X pos,C angle,X vel,C vel,X force,C torque";
    let layout = find(header, Some(&["X", "C"])).unwrap();
    assert_eq!((layout.q, layout.qd, layout.tau), (vec![1, 2], Some(vec![3, 4]), vec![5, 6]));
    assert!(layout.notes.is_empty(), "{:?}", layout.notes);
    // A second position of the same joint is another quantity, and a name on the other side another kind of name.
    let layout = find("t,a_pos,b_pos,a_angle,b_angle,a_torque,b_torque", Some(&["a", "b"])).unwrap();
    assert_eq!(layout.q, [3, 4]);
    assert!(find("t,a_pos,b_pos,angle_c,a_torque,b_torque,c_torque", Some(&["a", "b", "c"])).is_err());
}

fn search(header: &str, demand: Demand) -> Layout {
    let header: Vec<String> = header.split(',').map(str::to_owned).collect();
    let joints = ["elbow", "wrist"].map(str::to_owned);
    Layout::search(Path::new("log.csv"), Some(1), &header, Some(&joints), demand).unwrap()
}

#[test]
fn motors_stand_for_the_joints_that_they_move() {
    let motors = [("m2", "wrist"), ("m1", "elbow")].map(|(motor, joint)| (motor.to_owned(), joint.to_owned()));
    let demand = Demand { lenient: true, motors: &motors, ..Demand::default() };
    let layout = search("t,qpos_elbow,qpos_wrist,actuator_force_m1,actuator_force_m2", demand);
    assert_eq!((layout.tau, layout.of_motors), (vec![3, 4], true));
    assert!(layout.understood.iter().any(|note| note.contains("m1 for elbow")), "{:?}", layout.understood);
    // Names of joints come first.
    let layout = search("t,q_elbow,q_wrist,m1_effort,m2_effort,elbow_effort,wrist_effort", demand);
    assert_eq!((layout.tau, layout.of_motors), (vec![5, 6], false));
    // Two motors of one joint make its torque together.
    let pair = [("m1", "elbow"), ("m2", "elbow")].map(|(motor, joint)| (motor.to_owned(), joint.to_owned()));
    assert!(of_motors(&pair, &["elbow".to_owned()]).is_empty());
}

#[test]
fn currents_of_joints_without_a_torque_are_named() {
    let demand = Demand { lenient: true, ..Demand::default() };
    let layout = search("t,elbow_position,wrist_position,elbow_effort,wrist_current", demand);
    assert_eq!((layout.tau, layout.currents), (vec![3, ABSENT], false));
    let notes = layout.notes.join("; ");
    let cure =
        "tau = [\"elbow_effort\", \"wrist_current\"], [units] torque = \"A\", [motors] torque_constant_nm_a = [1, K]";
    assert!(notes.contains(cure), "{notes}");
    // Currents besides torques are left alone.
    let layout = search("t,elbow_position,wrist_position,elbow_effort,wrist_effort,wrist_current", demand);
    assert_eq!(layout.notes, ["columns not used: wrist_current"]);
}

#[test]
fn constants_are_asked_for_where_they_are_not_given() {
    let said = |constants: bool| {
        let demand = Demand { lenient: true, constants, ..Demand::default() };
        search("t,elbow_position,wrist_position,elbow_current,wrist_current", demand).understood.join("; ")
    };
    assert!(said(false).contains("a dataset with [motors] torque_constant_nm_a"), "{}", said(false));
    assert!(said(true).contains("the torque constants of the dataset") && !said(true).contains("[motors]"));
}

#[test]
fn one_quantity_somewhere_in_the_names() {
    let robot = Some(&["a", "b"][..]);
    for (position, torque) in [
        ("position/robot0/left_arm/joint_#", "effort/robot0/left_arm/joint_#"),
        ("position_robot0/left_arm/joint_#", "effort_robot0/left_arm/joint_#"),
        ("joint#_position_actual", "joint#_torque_actual"),
        ("servo_angle_#", "servo_effort_#"),
        ("EGM_FB_J# [deg]", "EGM_Torque_J# [Nm]"),
        ("关节#角度(度)", "关节#力矩(牛米)"),
        ("関節#角度", "関節#トルク"),
        ("pos_eje_#", "par_motor_eje_#"),
        ("joint#pos", "joint#tau"),
        ("J#ActualPosition", "J#ActualTorque"),
        ("joint_#_pos", "motor_#_torque"),
    ] {
        let both = |pattern: &str| ["1", "2"].map(|number| pattern.replace('#', number)).join(",");
        let wanted = "joint1_position_target,joint2_position_target,eef_pos_0,eef_pos_1,eef_pos_2";
        let layout = find(&format!("时间,{},{wanted},{}", both(position), both(torque)), robot).unwrap();
        assert_eq!((layout.time, layout.q, layout.tau), (0, vec![1, 2], vec![8, 9]), "{position} {torque}");
    }
    // Where names are in a known order nothing else is asked.
    let layout = find("t,q_1,q_2,link_pos_1,link_pos_2,tau_1,tau_2", robot).unwrap();
    assert_eq!((layout.q, layout.tau), (vec![1, 2], vec![5, 6]));
}

#[test]
fn seconds_and_nanoseconds_behind_the_same_words() {
    for header in ["time_sec,time_nsec,q1,tau1", "time_nsec,time_sec,q1,tau1"] {
        let layout = find(header, None).unwrap();
        let place = header.split(',').position(|name| name == "time_sec").unwrap();
        assert_eq!((layout.time, layout.nanoseconds, layout.time_factor), (place, Some(1 - place), None), "{header}");
    }
    let alone = find("time_sec,frame,q1,tau1", None).unwrap();
    assert_eq!((alone.nanoseconds, alone.time_factor), (None, Some(1.0)));
}

#[test]
fn numbers_are_those_in_the_names_of_the_joints() {
    // On a tree, j3 may come behind j4.
    let robot = Some(&["j1", "j2", "j4", "j3"][..]);
    for header in
        ["t,q1,q2,q3,q4,tau1,tau2,tau3,tau4", "t,q0,q1,q2,q3,tau0,tau1,tau2,tau3", "t,A1,A2,A3,A4,T_A1,T_A2,T_A3,T_A4"]
    {
        let header = header.replace("T_", "torque_");
        let layout = find(&header, robot).unwrap();
        assert_eq!((layout.q, layout.tau), (vec![1, 2, 4, 3], vec![5, 6, 8, 7]), "{header}");
    }
    let layout = find("t,q1,q2,tau1,tau2", Some(&["lift2", "pan1"])).unwrap();
    assert_eq!(layout.q, [1, 2]);
}

#[test]
fn a_joint_alone_is_its_position_and_a_letter_before_it_its_force() {
    let layout = find("t,X,Y,C,FX,FY,TC", Some(&["X", "Y", "C"])).unwrap();
    assert_eq!((layout.q, layout.tau), (vec![1, 2, 3], vec![4, 5, 6]));
    let layout =
        find("t,lift_joint,elbow_joint,lift_joint_effort,elbow_joint_effort", Some(&["elbow_joint", "lift_joint"]));
    assert_eq!(layout.unwrap().q, [2, 1]);
}

#[test]
fn torques_of_contact_alone_are_named() {
    for torque in ["tau_ext_1", "ExternalTorque_A1", "tau_ext_hat_filtered_1"] {
        let said = problem(&format!("t,q1,{torque}"), None);
        assert!(said.contains(&format!("{torque} and its like are torques of contact")), "{said}");
    }
    assert!(!problem("t,q1,x", None).contains("contact"));
}

#[test]
fn a_gripper_beside_numbered_joints_is_left_alone() {
    let demand = Demand { lenient: true, ..Demand::default() };
    let header = "t,drive_0_position,drive_1_position,gripper_position,drive_0_torque,drive_1_torque,gripper_torque";
    let layout = search(header, demand);
    assert_eq!((layout.q, layout.tau), (vec![1, 2], vec![4, 5]));
    assert!(layout.understood.iter().any(|note| note.contains("numbers in their names")), "{:?}", layout.understood);
}

#[test]
fn what_a_simulator_holds_besides_torques_is_explained() {
    let controls = problem("t,qpos_0,qpos_1,qvel_0,qvel_1,ctrl_0,ctrl_1", Some(&["a", "b"]));
    assert!(controls.contains("ctrl_0 and its like are controls") && controls.contains("qfrc_actuator"), "{controls}");
    let state = problem("t,state[0],state[1],state[2],state[3],tau1,tau2", Some(&["a", "b"]));
    assert!(state.contains("may be a state, positions and velocities behind them"), "{state}");
}
