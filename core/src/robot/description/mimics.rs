//! Joints that follow others.

use super::tree::JointDescription;
use crate::error::{Error, Result};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Takes away the coupling of joints that follow a joint the file does not have, with a note.
///
/// # Errors
/// If joints follow each other in a circle.
pub(crate) fn settle_mimics(path: &Path, joints: &mut [JointDescription], notes: &mut Vec<String>) -> Result<()> {
    let index: HashMap<String, usize> = joints.iter().enumerate().map(|(at, joint)| (joint.name.clone(), at)).collect();
    for joint in joints.iter_mut() {
        if let Some(mimic) = joint.mimic.take_if(|mimic| !index.contains_key(&mimic.master)) {
            let (name, line, master) = (&joint.name, joint.line.unwrap_or(0), mimic.master);
            notes.push(format!(
                "joint `{name}` (line {line}) mimics `{master}`, which is not in the file: it is taken to move by itself"
            ));
        }
    }
    for joint in joints.iter() {
        let mut seen = HashSet::new();
        let mut at = joint;
        while let Some(mimic) = &at.mimic {
            if !seen.insert(&at.name) {
                let problem = "it mimics itself in a circle; let one joint of the circle move by itself";
                return Err(Error::input(path, joint.line, format!("joint `{}`", joint.name), problem));
            }
            at = &joints[index[&mimic.master]];
        }
    }
    Ok(())
}
