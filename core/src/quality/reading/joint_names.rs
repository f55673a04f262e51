//! Joints of a log that the robot does not have by that name, but by one that is nearly the same: a misspelt joint is held, and its
//! torque does not count.

use crate::quality::finding::{Finding, Kind, Severity};
use crate::recording::lenient::Sieved;
use crate::robot::Robot;

/// Letters by which a misspelt name differs: two, and no more than one in so many.
const LETTERS: usize = 2;
const OF_LETTERS: usize = 4;

/// One finding for each joint of a log that is probably one of those that are not under study.
pub(crate) fn findings(sieved: &Sieved, robot: &Robot) -> Vec<Finding> {
    let of = |name: &String| {
        let near = robot.held.iter().map(|(own, _)| (distance(name, own), own));
        let (letters, own) = near.min_by_key(|(letters, _)| *letters)?;
        let text = format!(
            "the log has a joint {name}, which the robot has not: {own} is probably meant, which is held where it is assumed to stand, without \
             its motion and torque; rename the columns, or map them in a dataset ([columns])"
        );
        let misspelt = (1..=LETTERS).contains(&letters) && letters * OF_LETTERS <= own.chars().count();
        misspelt.then(|| Finding::new(Kind::JointName, Severity::Warning, format!("header ({name})"), text))
    };
    sieved.unknown_joints.iter().filter_map(of).collect()
}

/// Letters to change, add, leave out or exchange with their neighbours to make one name of another.
fn distance(a: &str, b: &str) -> usize {
    let [a, b] = [a, b].map(|name| name.to_lowercase().chars().collect::<Vec<char>>());
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let changed = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = changed.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_between_names() {
        let of = |a: &str, b: &str| distance(a, b);
        assert_eq!([of("joint", "jiont"), of("elbow", "elbw"), of("elbow", "Elbow"), of("a", "xyz")], [1, 1, 0, 3]);
    }

    #[test]
    fn a_misspelt_joint_is_one_of_those_that_are_held() {
        let mut robot = crate::quality::tests::irb();
        robot.held = vec![("shoulder_pan".into(), 0.0), ("j7".into(), 0.0)];
        let unknown = ["shoulder_pna", "shuolder_pam", "shoulder_lift", "j8"].map(str::to_owned).to_vec();
        let sieved = Sieved { unknown_joints: unknown, ..Sieved::default() };
        let found = findings(&sieved, &robot);
        let places: Vec<&str> = found.iter().map(|finding| finding.place.as_str()).collect();
        assert_eq!(places, ["header (shoulder_pna)", "header (shuolder_pam)"]);
    }
}
