use super::super::xml::{XmlText, decoded};
use crate::error::Result;
use crate::robot::description::{Description, Motion};
use crate::robot::model::Drive;
use nalgebra::{Matrix3, Vector3};
use std::fmt::Write;
use std::path::Path;

/// Factors by which an arm is printed in other units.
#[derive(Clone, Copy)]
struct Printed {
    length: f64,
    center: f64,
    mass: f64,
    moment: f64,
    angle: f64,
    limit: f64,
}

const SI: Printed = Printed { length: 1.0, center: 1.0, mass: 1.0, moment: 1.0, angle: 1.0, limit: 1.0 };

/// Degrees in a radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// An arm of three turning joints and a finger that mimics nothing, printed in the given units.
fn arm(units: Printed) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n<robot name=\"arm\">\n<link name=\"l0\"/>\n");
    let joints =
        [([0.0, 0.0, 0.3], 0.0, 8.0, 2.9), ([0.1, 0.0, 0.1], -90.0, 5.0, 1.8), ([0.45, 0.05, 0.0], 45.0, 2.0, 2.6)];
    for (k, (xyz, roll, mass, limit)) in joints.into_iter().enumerate() {
        let [x, y, z] = xyz.map(|value| value * units.length);
        let (roll, limit) = (roll / DEGREES * units.angle, limit * units.limit);
        let (mass, center, moment) = (mass * units.mass, 0.12 * units.center, 0.02 * mass * units.moment);
        let next = k + 1;
        let _ = writeln!(
            text,
            "<joint name=\"j{next}\" type=\"revolute\"><parent link=\"l{k}\"/><child link=\"l{next}\"/><origin xyz=\"{x} {y} {z}\" \
             rpy=\"{roll} 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-{limit}\" upper=\"{limit}\" velocity=\"{}\" effort=\"50\"/>\
             <dynamics damping=\"0.5\" friction=\"0.2\" armature=\"0.1\"/></joint>\n<link name=\"l{next}\"><inertial>\
             <origin xyz=\"{center} 0 0\"/><mass value=\"{mass}\"/><inertia ixx=\"{}\" ixy=\"0\" ixz=\"0\" iyy=\"{moment}\" \
             iyz=\"0\" izz=\"{moment}\"/></inertial></link>",
            2.0 * units.limit,
            0.3 * moment,
        );
    }
    text + "</robot>\n"
}

fn read(text: &str) -> Result<Description> {
    super::read(XmlText::new(Path::new("arm.urdf"), decoded(text.as_bytes().to_vec())))
}

/// The arm with one change of its text.
fn changed(from: &str, to: &str) -> Result<Description> {
    let text = arm(SI);
    assert!(text.contains(from), "{from}");
    read(&text.replacen(from, to, 1))
}

/// What a body that is fixed to the base weighs says nothing about the arm; of a body that moves it must be known.
#[test]
fn bodies_fixed_to_the_base_may_be_anything() {
    let body = |mass: &str| {
        format!(
            "<inertial><mass value=\"{mass}\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>"
        )
    };
    let with_bolt = |mass: &str, on: &str| {
        let bolt = format!(
            "<link name=\"bolt\">{}</link><joint name=\"f\" type=\"fixed\"><parent link=\"{on}\"/><child link=\"bolt\"/></joint></robot>",
            body(mass)
        );
        changed("</robot>", &bolt)
    };
    for mass in ["nan", "heavy", "-3", "1e99", "1 2"] {
        assert!(with_bolt(mass, "l0").is_ok(), "{mass}: {:?}", with_bolt(mass, "l0").err());
    }
    let refused = with_bolt("nan", "l1").unwrap_err().to_string();
    assert!(refused.contains("`bolt`") && refused.contains("finite number"), "{refused}");
    // The base's own, and a link that hangs on nothing.
    assert!(changed("<link name=\"l0\"/>", &format!("<link name=\"l0\">{}</link>", body("nan"))).is_ok());
    assert!(changed("</robot>", &format!("<link name=\"loose\">{}</link></robot>", body("nan"))).is_ok());
}

/// Two descriptions hold the same robot to rounding.
fn assert_same(a: &Description, b: &Description) {
    assert_eq!(a.links.len(), b.links.len());
    for (a, b) in a.links.iter().zip(&b.links) {
        let near = a.inertia.0.iter().zip(b.inertia.0).all(|(a, b)| (a - b).abs() <= 1e-12 * (1.0 + b.abs()));
        assert!(near && a.name == b.name, "{a:?} {b:?}");
    }
    for (a, b) in a.joints.iter().zip(&b.joints) {
        assert!((a.origin.rotation - b.origin.rotation).norm() < 1e-12, "{a:?} {b:?}");
        assert!((a.origin.translation - b.origin.translation).norm() < 1e-12, "{a:?} {b:?}");
        assert!((a.limits.upper - b.limits.upper).abs() < 1e-12, "{a:?} {b:?}");
        assert!((a.limits.velocity - b.limits.velocity).abs() < 1e-12, "{a:?} {b:?}");
        assert_eq!((&a.name, a.motion, a.drive), (&b.name, b.motion, b.drive));
    }
}

#[test]
fn looks_and_extensions_refuse_no_arm() {
    let plain = read(&arm(SI)).unwrap();
    assert_eq!(plain.notes, [""; 0]);
    for extra in [
        "<material/><material name=\"grey\"/>",
        "<gazebo reference=\"l1\"><sensor:camera name=\"c\"/></gazebo>",
        "<transmission name=\"t\"><joint name=\"j1\"/><mechanicalReduction>x</mechanicalReduction></transmission>",
        "<ros2_control><joint name=\"j1\"><param>{-2*pi}</param></joint></ros2_control>",
        "<sensor name=\"s\"><parent link=\"l1\"/><origin xyz=\"bad\"/></sensor>",
        "<!-- two -- hyphens -->",
    ] {
        assert_same(&changed("</robot>", &format!("{extra}</robot>")).unwrap(), &plain);
    }
    for looks in [
        "<visual/><collision><geometry/></collision>",
        "<visual><geometry/><material/><material name=\"\"><color rgba=\"1\"/></material></visual>",
        "<visual><origin rpy=\"x\"/><geometry><box/></geometry></visual>",
        "<visual><geometry><mesh filename=\"a.stl\" scale=\"1\"/></geometry></visual>",
    ] {
        assert_same(&changed("<link name=\"l1\">", &format!("<link name=\"l1\">{looks}")).unwrap(), &plain);
    }
    for (from, to) in [
        ("<robot ", "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" "),
        ("<robot ", "<robot xmlns=\"http://www.ros.org\" "),
        ("<?xml version=\"1.0\"?>", "<?xml version=\"1.0\"?><!DOCTYPE robot [<!ENTITY m \"8\">]>"),
        ("<?xml", "\u{feff}<?xml"),
        ("<?xml", "\n<?xml"),
        ("0.1 0 0.1", "0.1, 0, 0.1"),
        ("type=\"revolute\"", "type=\" Revolute \""),
        (" ixy=\"0\"", ""),
    ] {
        assert_same(&changed(from, to).unwrap(), &plain);
    }
    assert_same(&read(&arm(SI).replace('\n', "\r\n")).unwrap(), &plain);
}

#[test]
fn what_urdf_leaves_out_has_its_default() {
    let joint = |from: &str, to: &str| changed(from, to).unwrap().joints[0].clone();
    assert_eq!(joint("<axis xyz=\"0 0 1\"/>", "").axis, Vector3::x());
    assert_eq!(joint("<axis xyz=\"0 0 1\"/>", "<axis/>").axis, Vector3::x());
    assert_eq!(joint(" xyz=\"0 0 0.3\"", "").origin.translation, Vector3::zeros());
    assert_eq!(joint("rpy=\"0 0 0\"", "rpy=\"\"").origin.rotation, Matrix3::identity());
    let limits = "<limit lower=\"-2.9\" upper=\"2.9\" velocity=\"2\" effort=\"50\"/>";
    for without in
        ["", "<limit/>", "<limit effort=\"0\" velocity=\"0\"/>", "<limit lower=\"0\" upper=\"0\" effort=\"0\"/>"]
    {
        let free = joint(limits, without).limits;
        assert_eq!((free.lower, free.upper, free.velocity, free.effort), {
            let none = f64::INFINITY;
            (-none, none, none, none)
        });
    }
    let continuous = read(&arm(SI).replace("revolute", "continuous")).unwrap();
    assert!(continuous.joints.iter().all(|joint| joint.limits.upper == f64::INFINITY && joint.limits.effort == 50.0));
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    for (from, to, words) in [
        ("lower=\"-2.9\"", "lower=\"3\"", ["arm.urdf:4: joint `j1`", "lower must not exceed upper"]),
        ("type=\"revolute\"", "type=\"rotary\"", ["arm.urdf:4: joint `j1`", "type rotary"]),
        ("type=\"revolute\"", "", ["arm.urdf:4: joint `j1`", "no type"]),
        ("<parent link=\"l0\"/>", "", ["arm.urdf:4: joint `j1`", "no <parent"]),
        ("<parent link=\"l0\"/>", "<parent link=\"x\"/>", ["arm.urdf:4: joint `j1`", "no link `x`"]),
        ("<child link=\"l2\"/>", "<child link=\"l1\"/>", ["arm.urdf:6: joint `j2`", "closed loop"]),
        ("0.1 0 0.1", "0.1 nan 0.1", ["arm.urdf:6: xyz of <origin> in `j2`", "finite"]),
        ("0.1 0 0.1", "0.1 0", ["arm.urdf:6: xyz of <origin> in `j2`", "3 number(s), found 2"]),
        ("<mass value=\"8\"", "<mass value=\"1e300\"", ["arm.urdf:5: value of <mass> in `l1`", "1e9"]),
        ("<link name=\"l0\"", "<link name=\"\"", ["arm.urdf:3: <link>", "no name"]),
        ("armature=\"0.1\"", "armature=\"x\"", ["arm.urdf:4: armature of <dynamics> in `j1`", "\"x\""]),
        (
            "</robot>",
            "<joint name=\"j9\" type=\"fixed\"><parent link=\"l3\"/><child link=\"l0\"/></joint></robot>",
            ["arm.urdf: <robot>", "cycle"],
        ),
        (
            "</robot>",
            "<link name=\"a\"/><link name=\"b\"/><joint name=\"j9\" type=\"revolute\"><parent link=\"a\"/>\
                      <child link=\"b\"/></joint></robot>",
            ["arm.urdf: <robot>", "l0, a"],
        ),
    ] {
        let message = changed(from, to).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}

/// Friction beyond any machine is none, and refuses no arm.
#[test]
fn numbers_of_drives_that_no_machine_has_are_noted() {
    for (from, to, word) in [
        ("damping=\"0.5\"", "damping=\"1e11\"", "damping 1e11"),
        ("friction=\"0.2\"", "friction=\"-3e20\"", "friction -3e20"),
        ("armature=\"0.1\"", "armature=\"1e12\"", "armature 1e12"),
    ] {
        let read = changed(from, to).unwrap();
        let Drive { viscous, coulomb, armature } = read.joints[0].drive;
        assert!([viscous, coulomb, armature].contains(&0.0), "{to}");
        assert!(read.notes[0].contains(word) && read.notes.len() == 1, "{:?}", read.notes);
        assert_eq!(read.joints[1].drive, Drive { viscous: 0.5, coulomb: 0.2, armature: 0.1 });
    }
}

#[test]
fn bodies_that_are_incomplete_are_noted() {
    let note = |description: &Description| description.notes.join("\n");
    let point =
        read(&arm(SI).replace("<inertia ixx=\"0.048\" ixy=\"0\" ixz=\"0\" iyy=\"0.16\" iyz=\"0\" izz=\"0.16\"/>", ""))
            .unwrap();
    assert!(note(&point).contains("`l1` (line 5) has a mass and no <inertia>"), "{:?}", point.notes);
    assert!((point.links[1].inertia.0[9] - 8.0 * 0.12 * 0.12).abs() < 1e-15);
    let no_mass = changed("<mass value=\"8\"/>", "<mass/>").unwrap();
    assert_eq!(no_mass.links[1].missing.as_ref().map(|missing| missing.line), Some(5));
    assert_eq!(no_mass.links[1].inertia.mass(), 0.0);
    let odd = read(&arm(SI).replacen("damping=\"0.5\"", "damping=\"-0.3\"", 1).replacen(
        "friction=\"0.2\"",
        "friction=\"-7.6e-30\"",
        1,
    ));
    assert_eq!((odd.as_ref().unwrap().joints[0].drive.viscous, odd.unwrap().joints[0].drive.coulomb), (-0.3, 0.0));
    let apart = changed("</robot>", "<link name=\"a\"/></robot>").unwrap();
    assert!(note(&apart).contains("(a)") && apart.links.len() == 4, "{:?}", apart.notes);
}

#[test]
fn joints_that_follow() {
    let with = |joint: &str, mimic: &str| {
        let limit = arm(SI).replacen(
            &format!("<joint name=\"{joint}\" type=\"revolute\">"),
            &format!("<joint name=\"{joint}\" type=\"revolute\">{mimic}"),
            1,
        );
        read(&limit)
    };
    let plain = with("j2", "<mimic joint=\"j1\"/>").unwrap().joints[1].mimic.clone().unwrap();
    assert_eq!((plain.master.as_str(), plain.multiplier, plain.offset), ("j1", 1.0, 0.0));
    let full =
        with("j3", "<mimic joint=\"j1\" multiplier=\"-2\" offset=\"0.5\"/>").unwrap().joints[2].mimic.clone().unwrap();
    assert_eq!((full.multiplier, full.offset), (-2.0, 0.5));
    let lost = with("j3", "<mimic joint=\"other\"/>").unwrap();
    assert!(lost.joints[2].mimic.is_none() && lost.notes[0].contains("mimics `other`"), "{:?}", lost.notes);
    let message = with("j1", "<mimic joint=\"j1\"/>").unwrap_err().to_string();
    assert!(message.contains("arm.urdf:4: joint `j1`") && message.contains("circle"), "{message}");
    let held = read(&arm(SI).replacen("revolute", "floating", 1).replacen("revolute", "planar", 1)).unwrap();
    assert_eq!([0, 1, 2].map(|k| held.joints[k].motion), [Motion::Floating, Motion::Planar, Motion::Revolute]);
}

#[test]
fn other_units_are_recognised() {
    let plain = read(&arm(SI)).unwrap();
    let mm = Printed { length: 1e3, ..SI };
    let cm = Printed { length: 1e2, ..SI };
    for (printed, words) in [
        (mm, vec!["lengths of joints are read as mm"]),
        (Printed { center: 1e3, ..mm }, vec!["lengths of joints", "centres of mass are read as mm"]),
        (cm, vec!["lengths of joints are read as cm"]),
        (Printed { center: 1e2, ..cm }, vec!["lengths of joints", "centres of mass are read as cm"]),
        (Printed { center: 1e2, moment: 1e4, ..cm }, vec!["read as cm", "centres of mass", "kg cm2"]),
        (Printed { center: 1e3, ..SI }, vec!["centres of mass are read as mm"]),
        (Printed { mass: 1e3, moment: 1e3, ..SI }, vec!["masses are read as g", "read as g m2"]),
        (Printed { mass: 1e3, ..SI }, vec!["masses are read as g"]),
        (Printed { moment: 1e4, ..SI }, vec!["read as kg cm2"]),
        (Printed { moment: 1e7, ..SI }, vec!["read as g cm2"]),
        (Printed { moment: 1e7, mass: 1e3, ..SI }, vec!["masses are read as g", "read as g cm2"]),
        (Printed { moment: 1e6, ..SI }, vec!["read as kg mm2"]),
        (Printed { moment: 1e9, ..SI }, vec!["read as g mm2"]),
        (Printed { moment: 1e9, mass: 1e3, ..SI }, vec!["masses are read as g", "read as g mm2"]),
        (Printed { moment: 1e6, mass: 1e3, ..SI }, vec!["masses are read as g", "read as kg mm2"]),
        (Printed { moment: 1e9, mass: 1e3, center: 1e3, ..mm }, vec!["lengths", "centres", "masses", "g mm2"]),
        (Printed { angle: DEGREES, ..SI }, vec!["rpy of joints is read in degrees"]),
        (Printed { limit: DEGREES, ..SI }, vec!["limits of turning joints are read in degrees", "deg/s"]),
    ] {
        let description = read(&arm(printed)).unwrap();
        let notes = description.notes.join("\n");
        assert!(
            description.notes.len() == words.len() && words.iter().all(|word| notes.contains(word)),
            "{words:?}: {notes}"
        );
        assert_same(&description, &plain);
    }
}

#[test]
fn plausible_and_ambiguous_numbers_stay() {
    let stays = |text: &str, note: Option<&str>| {
        let notes = read(text).unwrap().notes;
        assert_eq!(notes.len(), note.map_or(0, |_| 1), "{notes:?}");
        assert!(note.is_none_or(|note| notes[0].contains(note)), "{notes:?}");
    };
    // A large crane, limits that stand for none, a heavy and a light arm, placeholders.
    stays(&arm(Printed { length: 10.0, center: 10.0, mass: 50.0, moment: 5000.0, ..SI }), None);
    stays(&arm(Printed { length: 50.0, center: 50.0, mass: 1e4, moment: 2e7, ..SI }), Some("45 m long"));
    stays(&arm(Printed { length: 0.2, center: 0.2, mass: 0.02, moment: 0.001, ..SI }), None);
    stays(&arm(SI).replace("2.9", "100").replace("1.8", "100").replace("2.6", "100"), Some("check their unit"));
    stays(&arm(SI).replace("2.9", "1e16").replace("1.8", "1e16").replace("2.6", "1e16"), None);
    let mixed = arm(SI).replacen("rpy=\"0 0 0\"", "rpy=\"0 0 90\"", 1);
    stays(&mixed, Some("goes up to 90 and is read in rad"));
    for file in ["urdf/irb1600_6_120.urdf", "tests/reference/skew7.urdf", "tests/reference/fixed_links.urdf"] {
        let path = format!("{}/../{file}", env!("CARGO_MANIFEST_DIR"));
        if let Ok(text) = std::fs::read_to_string(path) {
            stays(&text, None);
        }
    }
}
