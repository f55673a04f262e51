//! Which joints of a file are under study, and whether its inertias are used.

use std::collections::BTreeMap;

/// Whether the inertias in a file are used.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{Choice, InertiaCheck, description};
///
/// // A body with ixx = 9 and iyy = izz = 1 kg m2 cannot be: ixx exceeds the sum of the others.
/// let text = r#"<robot name="r"><link name="base"/>
/// <joint name="j" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
/// <link name="rod"><inertial><mass value="1"/>
/// <inertia ixx="9" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#;
/// let file = description::parse(text, "r.urdf")?;
/// assert!(file.robot(&Choice::default(), InertiaCheck::Ignored).is_ok());
/// let refused = file.robot(&Choice::default(), InertiaCheck::Required).unwrap_err();
/// assert!(refused.to_string().contains("triangle inequality"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InertiaCheck {
    /// They are believed: an impossible one is an error, friction below zero too.
    Required,
    /// They will be identified or are placeholders: impossible ones pass, and friction below zero counts as none.
    Ignored,
}

/// Which joints of a file are under study.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{Choice, InertiaCheck, description};
///
/// // Joints 2 and 3 are under study; joint 1 stands at 0.5 rad, the wrist in the middle of its range.
/// let choice = Choice {
///     joints: Some(vec!["joint_2".to_owned(), "joint_3".to_owned()]),
///     hold: [("joint_1".to_owned(), 0.5)].into(),
///     ..Choice::default()
/// };
/// let arm = description::read("../urdf/irb1600_6_120.urdf".as_ref())?.robot(&choice, InertiaCheck::Required)?;
/// assert_eq!(arm.joint_names(), ["joint_2", "joint_3"]);
/// assert!(arm.held.contains(&("joint_1".to_owned(), 0.5)));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Choice {
    /// Joints with a coordinate, in any order; without, all that move by themselves.
    pub joints: Option<Vec<String>>,
    /// Link at the end of the arm: where no joints are named, those between the base and it are meant. The flange is there.
    pub tip: Option<String>,
    /// Where joints stand that are not under study, rad or m, by name. Those not named stand in the middle of their range, or
    /// at zero where they have none.
    pub hold: BTreeMap<String, f64>,
}
