use super::super::xml::XmlText;
use crate::error::Result;
use crate::robot::description::{Description, Motion};
use crate::robot::model::{Drive, Pose};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use serde_json::Value;
use std::collections::HashMap;
use std::path::Path;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/reference/mjcf");

fn reference(model: &str) -> (Description, Value) {
    let path = Path::new(FOLDER).join(format!("{model}.xml"));
    let text = std::fs::read_to_string(Path::new(FOLDER).join(format!("{model}.json"))).unwrap();
    (super::read(&XmlText::read(&path, "the model").unwrap()).unwrap(), serde_json::from_str(&text).unwrap())
}

fn read(text: &str) -> Result<Description> {
    super::read(&XmlText::new(Path::new("arm.xml"), text.to_owned()))
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().flat_map(numbers).collect(),
        value => vec![value.as_f64().unwrap()],
    }
}

fn matrix(value: &Value) -> Matrix3<f64> {
    Matrix3::from_row_slice(&numbers(value))
}

/// Poses of all links in the world.
fn frames(robot: &Description, positions: &HashMap<&str, f64>) -> Vec<Pose> {
    let mut frames = vec![Pose::identity(); robot.links.len()];
    for joint in &robot.joints {
        let q = positions.get(joint.name.as_str()).copied().unwrap_or(0.0);
        let axis = Unit::new_normalize(joint.axis);
        let moved = match joint.motion {
            Motion::Revolute => {
                Pose { rotation: Rotation3::from_axis_angle(&axis, q).into_inner(), ..Pose::identity() }
            }
            Motion::Prismatic => Pose { translation: q * joint.axis, ..Pose::identity() },
            _ => Pose::identity(),
        };
        frames[joint.child] = frames[joint.parent].then(&joint.origin).then(&moved);
    }
    frames
}

/// Positions of all centres of mass, tensors in the world, and the joints' numbers are MuJoCo's.
#[test]
fn bodies_joints_and_frames_are_mujocos() {
    is_mujocos("arm");
    is_mujocos("replicate");
}

fn is_mujocos(model: &str) {
    let (robot, reference) = reference(model);
    assert_eq!(robot.gravity.as_slice(), numbers(&reference["gravity"]));
    let moving: Vec<_> = robot.joints.iter().filter(|joint| joint.motion != Motion::Fixed).collect();
    let joints = reference["joints"].as_array().unwrap();
    assert_eq!(moving.len(), joints.len());
    for (joint, wanted) in moving.iter().zip(joints) {
        assert!(wanted["name"].as_str().is_none_or(|name| name == joint.name), "{wanted} {joint:?}");
        assert_eq!(wanted["moves"].as_bool().unwrap(), joint.motion != Motion::Floating, "{joint:?}");
        if joint.motion == Motion::Floating {
            continue;
        }
        let drive = [joint.drive.viscous, joint.drive.coulomb, joint.drive.armature];
        assert_eq!(
            drive.map(Value::from),
            ["damping", "friction", "armature"].map(|name| wanted[name].clone()),
            "{joint:?}"
        );
        let limits = [joint.limits.lower, joint.limits.upper];
        match &wanted["range"] {
            Value::Null => assert_eq!(limits, [f64::NEG_INFINITY, f64::INFINITY], "{joint:?}"),
            range => {
                assert!(numbers(range).iter().zip(limits).all(|(a, b)| (a - b).abs() < 1e-15), "{joint:?} {range}")
            }
        }
    }
    let bodies = reference["bodies"].as_array().unwrap();
    for state in reference["states"].as_array().unwrap() {
        let coordinates =
            moving.iter().filter(|joint| joint.motion != Motion::Floating).map(|joint| joint.name.as_str());
        let frames = frames(&robot, &coordinates.zip(numbers(&state["q"])).collect());
        for (index, body) in bodies.iter().enumerate().skip(1) {
            let Some(name) = body["name"].as_str() else { continue };
            let link = robot.links.iter().position(|link| link.name == name).unwrap();
            let (at, own) = (frames[link], robot.links[link].inertia);
            let rotation = matrix(&state["rotations"][index]);
            let center = Vector3::from_column_slice(&numbers(&body["center"]));
            let center = Vector3::from_column_slice(&numbers(&state["positions"][index])) + rotation * center;
            let tensor = rotation * matrix(&body["tensor"]) * rotation.transpose();
            let (mass, size) = (body["mass"].as_f64().unwrap(), tensor.norm());
            assert!((own.mass() - mass).abs() < 1e-12 * mass, "{name}: {} {mass}", own.mass());
            assert!((at.rotation * own.center_of_mass() + at.translation - center).norm() < 1e-12, "{name}");
            let turned = at.rotation * own.tensor_about_center() * at.rotation.transpose();
            assert!((turned - tensor).norm() < 1e-11 * size, "{name}: {turned} {tensor}");
            assert!((at.rotation - rotation).norm() < 1e-12, "{name}");
        }
    }
}

#[test]
fn drives_and_couplings_of_the_model() {
    let (robot, _) = reference("arm");
    let joint = |name: &str| robot.joints.iter().find(|joint| joint.name == name).unwrap();
    let efforts = ["rail", "yaw", "pitch", "elbow", "roll", "lift"].map(|name| joint(name).limits.effort);
    assert_eq!(efforts, [500.0, 80.0, 30.0, 45.0, 6.0, f64::INFINITY]);
    let right = joint("right").mimic.clone().unwrap();
    assert_eq!((right.master.as_str(), right.multiplier), ("left", 1.5));
    assert!((right.offset - 0.012).abs() < 1e-15, "{right:?}");
    assert!(["lift", "yaw", "left"].iter().all(|name| joint(name).mimic.is_none()));
    let notes = robot.notes.join("\n");
    for word in
        ["coupling of joint `yaw`", "not linear", "1 loop(s) are cut open (flange to box)", "gravity is 0.5 -1 -9.7"]
    {
        assert!(notes.contains(word), "{notes}");
    }
}

#[test]
fn degrees_are_the_default_and_rounded_radians_are_noted() {
    let arm = |compiler: &str, euler: &str| {
        let text = format!(
            "<mujoco>{compiler}<worldbody><body euler=\"{euler}\"><joint range=\"-90 90\"/><geom size=\"0.1\"/></body>\
             </worldbody></mujoco>"
        );
        read(&text).unwrap()
    };
    let degrees = arm("", "90 0 0");
    assert_eq!((degrees.joints[0].limits.upper, degrees.notes.len()), (std::f64::consts::FRAC_PI_2, 0));
    let radians = arm("<compiler angle=\"radian\"/>", "1.5708 0 0");
    assert!((radians.joints[0].origin.rotation - degrees.joints[0].origin.rotation).norm() < 1e-15);
    assert!(radians.notes[0].contains("1 rounded angle"), "{:?}", radians.notes);
    // Turned about x, then about the new y, or about the y that stands still.
    let turn =
        |sequence: &str| arm(&format!("<compiler eulerseq=\"{sequence}\"/>"), "30 40 50").joints[0].origin.rotation;
    let about = |axis, degrees: f64| Rotation3::from_axis_angle(&axis, degrees.to_radians()).into_inner();
    let (x, y, z) = (about(Vector3::x_axis(), 30.0), about(Vector3::y_axis(), 40.0), about(Vector3::z_axis(), 50.0));
    assert!((turn("xyz") - x * y * z).norm() < 1e-15);
    assert!((turn("XYZ") - z * y * x).norm() < 1e-15);
}

#[test]
fn what_a_tree_does_not_have_is_noted() {
    let model = |body: &str, rest: &str| {
        read(&format!(
            "<mujoco><worldbody><body name=\"b\"><geom size=\"0.1\"/>{body}</body></worldbody>{rest}</mujoco>"
        ))
        .unwrap()
    };
    let ball = model("<joint name=\"j\" type=\"ball\"/>", "");
    assert!(ball.joints[0].motion == Motion::Floating && ball.notes[0].contains("ball joint"), "{ball:?}");
    let spring = model("<joint name=\"j\" stiffness=\"2\"/>", "");
    assert!(spring.notes[0].contains("springs of joints are not read (j)"), "{:?}", spring.notes);
    let mesh = model("<joint/><geom type=\"mesh\" mesh=\"m\"/>", "");
    assert!(mesh.links[1].missing.as_ref().is_some_and(|missing| missing.problem.contains("<inertial>")));
    assert!(mesh.notes[0].contains("an <inertial> (b)"), "{:?}", mesh.notes);
    // Masses of bodies that no joint moves change no torque, nor does what carries them.
    let fixed = read(
        "<mujoco><worldbody><body name=\"b\" gravcomp=\"1\"><geom type=\"mesh\" mesh=\"m\"/></body></worldbody></mujoco>",
    );
    assert!(fixed.unwrap().notes.is_empty());
    let held = model("<joint name=\"j\"/>", "<equality><joint joint1=\"j\" polycoef=\"0.5\"/></equality>");
    assert!(held.joints[0].motion == Motion::Fixed && held.notes[0].contains("held at 0.5"), "{held:?}");
    let heavy = model("<joint/>", "<compiler settotalmass=\"3\"/>");
    assert!((heavy.links[1].inertia.mass() - 3.0).abs() < 1e-15);
    let still = model("<joint/>", "<option><flag gravity=\"disable\"/></option>");
    assert_eq!(still.gravity, Vector3::zeros());
}

/// Against MuJoCo: shapes overrule an inertial where they have mass; meshes would too, and their mass is not known.
#[test]
fn an_inertial_gives_way_to_shapes_that_have_mass() {
    let mass = |rule: &str, shape: &str| {
        let robot = read(&format!(
            "<mujoco><compiler inertiafromgeom=\"{rule}\"/><worldbody><body name=\"b\"><joint/><inertial pos=\"0 0 0\" mass=\"0.8\" \
             diaginertia=\"1 1 1\"/>{shape}</body></worldbody></mujoco>"
        ));
        let robot = robot.unwrap();
        (robot.links[1].inertia.mass(), robot.notes.join("\n"), robot.links[1].missing.is_some())
    };
    let (ball, air) = ("<geom size=\"0.1\" mass=\"2\"/>", "<geom size=\"0.1\" mass=\"0\"/>");
    let (own, notes, _) = mass("true", ball);
    assert!(own == 2.0 && notes.contains("not the <inertial>"), "{own} {notes}");
    for (rule, shape) in [("true", air), ("true", ""), ("auto", ball), ("false", ball)] {
        assert_eq!(mass(rule, shape), (0.8, String::new(), false), "{rule} {shape}");
    }
    let (own, notes, missing) = mass("true", "<geom type=\"mesh\" mesh=\"m\"/>");
    assert!(own == 0.8 && !missing && notes.contains("the <inertial> of these bodies is taken (b)"), "{own} {notes}");
}

/// A gripper in degrees on an arm in radians, each with its own classes.
#[test]
fn attached_models_keep_their_settings() {
    let folder = tempfile::tempdir().unwrap();
    let gripper = "<mujoco><default><joint damping=\"2\"/></default><worldbody><body name=\"finger\"><joint name=\"j\" \
                   range=\"0 90\"/><geom size=\"0.1\"/></body></worldbody><actuator><motor joint=\"j\" forcerange=\"-3 3\"/>\
                   </actuator></mujoco>";
    std::fs::write(folder.path().join("gripper.xml"), gripper).unwrap();
    let arm = "<mujoco><compiler angle=\"radian\"/><asset><model name=\"g\" file=\"gripper.xml\"/></asset><default><default \
               class=\"c\"><joint damping=\"5\"/></default></default><worldbody><body name=\"l\" childclass=\"c\"><joint name=\"j\" \
               range=\"0 1\"/><geom size=\"0.1\"/><frame pos=\"0 0 1\"><attach model=\"g\" prefix=\"left_\"/></frame></body>\
               </worldbody></mujoco>";
    let read = |text: &str| super::read(&XmlText::new(&folder.path().join("arm.xml"), text.to_owned()));
    let robot = read(arm).unwrap();
    let found: Vec<_> = robot.joints.iter().map(|j| (j.name.as_str(), j.limits.upper, j.drive.viscous)).collect();
    assert_eq!(found, [("j", 1.0, 5.0), ("left_j", std::f64::consts::FRAC_PI_2, 2.0)]);
    assert_eq!(
        (robot.joints[1].parent, robot.joints[1].origin.translation.z, robot.joints[1].limits.effort),
        (1, 1.0, 3.0)
    );
    for (from, to, word) in
        [("model=\"g\" p", "model=\"h\" p", "no <model>"), ("gripper.xml", "arm2.xml", "arm2.xml is not there")]
    {
        let message = read(&arm.replace(from, to)).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
}

/// What a joint lets through limits its drives, unless the file says that it does not.
#[test]
fn efforts_are_those_that_joints_let_through() {
    let effort = |limited: &str, drive: &str| {
        let joint = format!("<joint name=\"j\" actuatorfrcrange=\"-5 4\"{limited}/>");
        let model = format!(
            "<mujoco><worldbody><body name=\"b\">{joint}<geom size=\"0.1\"/></body></worldbody><actuator>{drive}</actuator></mujoco>"
        );
        read(&model).unwrap().joints[0].limits.effort
    };
    let motor = |range: &str| format!("<motor joint=\"j\" forcerange=\"{range}\"/>");
    assert_eq!(effort("", ""), 5.0);
    assert_eq!([effort("", &motor("-3 3")), effort("", &motor("-9 9"))], [3.0, 5.0]);
    let free = " actuatorfrclimited=\"false\"";
    assert_eq!([effort(free, ""), effort(free, &motor("-9 9"))], [f64::INFINITY, 9.0]);
}

/// A base fixed by its damping, and ranges beyond any machine.
#[test]
fn numbers_of_drives_that_no_machine_has_are_noted() {
    let joint = "<joint name=\"j\" damping=\"1e11\" stiffness=\"1e11\" range=\"-2e10 2e10\"/>";
    let read = read(&format!(
        "<mujoco><compiler angle=\"radian\"/><worldbody><body name=\"b\">{joint}<geom size=\"0.1\"/></body></worldbody>\
         <actuator><motor joint=\"j\" gear=\"1e10\" ctrlrange=\"-1 1\" ctrllimited=\"true\"/></actuator></mujoco>"
    ));
    let read = read.unwrap();
    assert_eq!(read.joints[0].drive, Drive::default());
    assert_eq!((read.joints[0].limits.upper, read.joints[0].limits.effort), (2e10, 1e10));
    let notes = read.notes.join("\n");
    assert!(notes.contains("joint `j` (line 1): damping 1e11 is beyond any machine"), "{notes}");
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let body = |inner: &str| format!("<mujoco>\n<worldbody>\n<body name=\"b\">\n{inner}</body></worldbody></mujoco>");
    for (text, words) in [
        (body("<joint axis=\"0 0 0\"/>"), ["arm.xml:4: <joint>", "no direction"]),
        (body("<joint name=\"j\" type=\"screw\"/>"), ["arm.xml:4: <joint> `j`", "type screw"]),
        (body("<joint class=\"c\"/>"), ["arm.xml:4: <joint>", "no default class `c`"]),
        (body("<joint range=\"1 -1\"/>"), ["arm.xml:4: <joint>", "exchange them"]),
        (body("<joint pos=\"0 0\"/>"), ["arm.xml:4: <joint>", "3 number(s), found 2"]),
        (body("<inertial mass=\"x\"/>"), ["arm.xml:4: <inertial>", "finite number"]),
        (body("<geom type=\"box\" size=\"1\"/>"), ["arm.xml:4: <geom>", "3 sizes, found 1"]),
        (body("<geom size=\"0\"/>"), ["arm.xml:4: <geom>", "above zero"]),
        (body("<body name=\"b\"/>"), ["arm.xml:4: <body> `b`", "same name"]),
        (body("<include file=\"none.xml\"/>"), ["arm.xml:4: <include>", "none.xml is not there"]),
        ("<mujoco/>".to_owned(), ["arm.xml: <worldbody>", "no body"]),
        ("<mujoco><compiler angle=\"grad\"/></mujoco>".to_owned(), ["arm.xml:1: <compiler>", "radian or degree"]),
        ("<mujoco><compiler coordinate=\"global\"/></mujoco>".to_owned(), ["arm.xml:1: <compiler>", "global"]),
        (
            format!("<mujoco>{}</mujoco>", "<body>".repeat(300) + &"</body>".repeat(300)),
            ["arm.xml:1: <body>", "nested"],
        ),
    ] {
        let message = read(&text).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}
