//! Joints that a file spells otherwise than the robot: in other cases, or with blanks or hyphens in the place of underscores.

use super::names::{Joint, Meaning};
use std::collections::BTreeSet;

/// A name without cases and without what stands between words.
fn plain(name: &str) -> String {
    name.chars().filter(|letter| !matches!(letter, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect()
}

/// Whether a joint is a part of a path that goes on behind it, as to the link that it moves: `elbow/forearm`. Those at the end of paths are
/// found by the prefix that all share.
fn is_part(path: &str, joint: &str) -> bool {
    path.rsplit('/').skip(1).any(|part| plain(part) == plain(joint))
}

/// Puts the names of `known` joints in the place of other spellings of them. A joint that has its own name in the file keeps that; one of
/// which the file has two spellings, or that another joint is spelled like, is left as it is.
pub(super) fn correct(meanings: &mut [Vec<Meaning>], known: &[String]) {
    let name = |meaning: &Meaning| match &meaning.joint {
        Joint::Name(name) => Some(name.clone()),
        Joint::Number(_) => None,
    };
    let of_file: BTreeSet<String> = meanings.iter().flatten().filter_map(name).collect();
    let sure = |readings: &Vec<Meaning>| readings.iter().find(|meaning| !meaning.exact_only).and_then(name);
    let likely: BTreeSet<String> = meanings.iter().filter_map(sure).collect();
    for joint in known.iter().filter(|joint| !of_file.contains(*joint)) {
        let is_alike =
            |other: &&String| plain(other) == plain(joint) || (likely.contains(*other) && is_part(other, joint));
        let mut spellings = of_file.iter().filter(is_alike);
        let (Some(spelling), None) = (spellings.next(), spellings.next()) else { continue };
        if known.iter().filter(is_alike).count() > 1 {
            continue;
        }
        let theirs = Joint::Name(spelling.clone());
        let readings = meanings.iter_mut().flatten().filter(|meaning| meaning.joint == theirs);
        readings.for_each(|meaning| meaning.joint = Joint::Name(joint.clone()));
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::columns::{Layout, joint_names};

    fn list(names: &str) -> Vec<String> {
        names.split(',').map(str::to_owned).collect()
    }

    /// Whether a header with these names of two joints has the joints of a robot.
    fn is_found(columns: &str, robot: &str) -> bool {
        let header: Vec<String> = ["position", "effort"]
            .iter()
            .flat_map(|signal| columns.split(',').map(move |joint| format!("{joint}_{signal}")))
            .collect();
        let header = [list("t"), header].concat();
        let found = Layout::find("log.csv".as_ref(), None, &header, Some(&list(robot)));
        let is_named = joint_names(&header, &list(robot)).names == list(robot);
        found.is_ok_and(|layout| layout.positions() == [1, 2] && layout.torques() == [3, 4]) && is_named
    }

    #[test]
    fn joints_are_found_in_another_spelling() {
        let robot = "Shoulder_Pan,Elbow";
        for columns in [
            "Shoulder_Pan,Elbow",
            "shoulder_pan,elbow",
            "SHOULDER_PAN,Elbow",
            "Shoulder Pan,Elbow",
            "shoulder-pan,elbow",
        ] {
            assert!(is_found(columns, robot), "{columns}");
        }
        assert!(!is_found("shoulder_pam,elbow", robot));
        // With the link that each moves.
        for columns in ["shoulder_pan/upper_arm,elbow/forearm", "arm/shoulder_pan/x,arm/elbow/y"] {
            assert!(is_found(columns, robot), "{columns}");
        }
        assert!(!is_found("left/elbow/a,right/elbow/b", robot));
    }

    #[test]
    fn a_spelling_of_two_joints_is_that_of_none() {
        assert!(is_found("A_x,a_x", "A_x,a_x") && !is_found("AX,b", "A_x,a_x") && !is_found("A_x,a_x", "AX,b"));
    }
}
