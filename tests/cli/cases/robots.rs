//! Robots as their owners have them.

use super::case;
use tauscope::robot::description::{self, Description, Motion};

fn read(case: &crate::Case, file: &str) -> Description {
    description::read(&case.path(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn refusal(case: &crate::Case, file: &str) -> String {
    let message = description::read(&case.path(file)).err().unwrap_or_else(|| panic!("{file} is read")).to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    message
}

/// Files of other kinds are named by what they are, whatever their name, with the command that converts them.
#[test]
#[ignore = "needs the cases folder"]
fn f10_files_of_another_kind() {
    let case = case("f10_wrong_kind");
    for (file, words) in [
        ("arm.sdf", ["SDF", "sdf2mjcf arm.sdf"]),
        ("sdf_named.urdf", ["SDF", "sdf2mjcf sdf_named.urdf"]),
        ("ur10e.urdf.xacro", ["xacro file", "xacro ur10e.urdf.xacro -o"]),
        ("ur10e_robot.urdf.xacro", ["xacro file", "xacro ur10e_robot.urdf.xacro -o"]),
        ("xacro_named.urdf", ["xacro file", "xacro xacro_named.urdf -o"]),
        ("log.txt", ["a table or log", "--train"]),
        ("log.bag", ["ROS 1 bag", "--train"]),
        ("DATA_EMPS.mat", ["MATLAB", "--train"]),
        ("log.json", ["JSON", "URDF"]),
        ("log.npz", ["numpy", "--train"]),
        ("log.npy", ["numpy", "--train"]),
    ] {
        let message = refusal(&case, file);
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
    let folder = description::read(case.folder.path()).unwrap_err().to_string();
    assert!(folder.contains("directory") && folder.contains("so101.xml"), "{folder}");
}

/// A MuJoCo model is read, whatever its name.
#[test]
#[ignore = "needs the cases folder"]
fn f10_a_mujoco_model() {
    let case = case("f10_wrong_kind");
    for file in ["so101.xml", "so101_named.urdf"] {
        let robot = read(&case, file);
        let moving: Vec<_> = robot.joints.iter().filter(|joint| joint.motion == Motion::Revolute).collect();
        let names: Vec<_> = moving.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names, ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]);
        for joint in moving {
            let drive = joint.drive;
            assert_eq!([drive.viscous, drive.coulomb, drive.armature], [0.6, 0.052, 0.028], "{joint:?}");
            assert_eq!(joint.limits.effort, 3.35, "{joint:?}");
        }
        let mass: f64 = robot.links.iter().map(|link| link.inertia.mass()).sum();
        assert!((mass - 0.632006).abs() < 1e-9, "{mass}");
    }
}

/// What URDF allows and what other readers let pass refuses no arm.
#[test]
#[ignore = "needs the cases folder"]
fn f16_variants_of_one_arm() {
    let case = case("f16_urdf_strict");
    for letter in ["a", "b", "c", "d", "e", "f", "g", "h", "i", "k", "l", "m", "n", "o", "p", "q"] {
        let robot = read(&case, &format!("{letter}.urdf"));
        assert_eq!(robot.joints.iter().filter(|joint| joint.motion == Motion::Revolute).count(), 6, "{letter}");
        assert_eq!(robot.notes, [""; 0], "{letter}");
        let held = robot.joints.iter().find(|joint| matches!(joint.motion, Motion::Floating | Motion::Planar));
        assert_eq!(
            held.map(|joint| joint.motion),
            match letter {
                "a" => Some(Motion::Floating),
                "b" => Some(Motion::Planar),
                _ => None,
            }
        );
        let unlimited = robot.joints.iter().all(|joint| joint.limits.velocity == f64::INFINITY);
        assert_eq!(unlimited, ["c", "d", "m"].contains(&letter), "{letter}");
    }
    let message = refusal(&case, "j.urdf");
    assert!(message.contains("j.urdf:10: joint `shoulder_pan_joint`") && message.contains("lower"), "{message}");
}

/// Friction below zero is read; what is below rounding is zero.
#[test]
#[ignore = "needs the cases folder"]
fn f17_friction_of_a_fit() {
    let case = case("f17_negative_damping");
    let lowest = |file: &str| {
        let robot = read(&case, file);
        robot.joints.iter().flat_map(|j| [j.drive.viscous, j.drive.coulomb]).fold(f64::INFINITY, f64::min)
    };
    assert!(lowest("airbot_updated.urdf") < -0.3 && lowest("kuka_identified.urdf") < -0.3);
    assert_eq!(lowest("ar5_friction.urdf"), 0.0);
}

/// Arms that other programs read.
#[test]
#[ignore = "needs the cases folder"]
fn f07_arms_with_looks_and_extensions() {
    let case = case("f07_irb4600");
    for (file, moving) in [("irb4600.urdf", 6), ("kuka_lwr4.urdf", 7), ("kinova_robot.urdf", 7), ("fetch.urdf", 14)] {
        let robot = read(&case, file);
        let moves = |motion| matches!(motion, Motion::Revolute | Motion::Prismatic);
        assert!(robot.joints.iter().filter(|joint| moves(joint.motion)).count() >= moving, "{file}");
    }
    // Written as 3.1416 and 1.5708: the axes of neighbours are parallel or at right angles.
    let kinova = read(&case, "kinova_robot.urdf");
    let count = kinova.notes.iter().filter(|note| note.contains("rounded angles")).count();
    let exact = |joint: &&description::JointDescription| {
        joint.origin.rotation.iter().all(|v| v.abs() < 1e-15 || (v.abs() - 1.0).abs() < 1e-15)
    };
    assert!(count == 1 && kinova.joints.iter().filter(exact).count() >= 14, "{:?}", kinova.notes);
}

/// The wrist of a painting robot: joint 5b follows joint 5.
#[test]
#[ignore = "needs the cases folder"]
fn f18_a_joint_that_follows() {
    let robot = read(&case("f18_irb5400_mimic"), "irb5400.urdf");
    let followers: Vec<_> =
        robot.joints.iter().filter_map(|joint| Some((joint.name.as_str(), joint.mimic.as_ref()?))).collect();
    assert_eq!(followers.len(), 1);
    assert_eq!(
        (followers[0].0, followers[0].1.master.as_str(), followers[0].1.multiplier),
        ("joint5b", "joint5", -1.0)
    );
}
