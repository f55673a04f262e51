//! Arrays of a program, as a log takes them: names of the joints, and one signal per joint.

use crate::channels::Channels;
use crate::error::{Error, Result};
use crate::robot::Robot;

/// The joints of a log, from base to flange: those of a robot, or names alone.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording::Log;
/// use tauscope::robot::{self, InertiaCheck};
///
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// let (t, signal) = ([0.0, 0.01, 0.02], [[0.0, 0.1, 0.2]]);
/// let of_robot = Log::new(&robot, t, signal, signal)?;
/// assert_eq!((of_robot.joints, of_robot.robot), (robot.joint_names(), robot.name));
/// let named = Log::new(["elbow"], t, signal, signal)?;
/// assert_eq!(named.joints, ["elbow"]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Joints {
    pub(super) robot: String,
    pub(super) names: Vec<String>,
}

impl From<&Robot> for Joints {
    fn from(robot: &Robot) -> Self {
        Joints { robot: robot.name.clone(), names: robot.joint_names() }
    }
}

impl<S: Into<String>> From<Vec<S>> for Joints {
    fn from(names: Vec<S>) -> Self {
        Joints { robot: String::new(), names: names.into_iter().map(S::into).collect() }
    }
}

impl<S: Into<String>, const N: usize> From<[S; N]> for Joints {
    fn from(names: [S; N]) -> Self {
        Vec::from(names).into()
    }
}

/// One signal per joint, each with one value per sample: [`Channels`], or slices and vectors of arrays.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::recording::Log;
///
/// let (hip, knee) = (vec![0.0, 0.1, 0.2], vec![1.0, 1.1, 1.2]);
/// let tau = Channels::zeros(2, 3);
/// let t = vec![0.0, 0.01, 0.02];
/// let from_slices = Log::new(["hip", "knee"], &t, [&hip, &knee], &tau)?;
/// let from_vectors = Log::new(["hip", "knee"], &t, vec![hip, knee.clone()], tau)?;
/// assert_eq!(from_slices, from_vectors);
///
/// let refused = from_slices.velocities([&knee[..], &knee[1..]]).unwrap_err();
/// assert_eq!(refused.to_string(), "qd: joint `knee` has 2 samples; 3 are wanted, one for each time");
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct JointArrays(Arrays);

#[derive(Debug, Clone, PartialEq)]
enum Arrays {
    Even(Channels),
    /// Lengths of arrays that differ in it.
    Uneven(Vec<usize>),
}

impl From<Channels> for JointArrays {
    fn from(channels: Channels) -> Self {
        JointArrays(Arrays::Even(channels))
    }
}

impl From<&Channels> for JointArrays {
    fn from(channels: &Channels) -> Self {
        channels.clone().into()
    }
}

impl<A: AsRef<[f64]>> From<&[A]> for JointArrays {
    fn from(arrays: &[A]) -> Self {
        let lengths: Vec<usize> = arrays.iter().map(|array| array.as_ref().len()).collect();
        if lengths.windows(2).any(|pair| pair[0] != pair[1]) {
            return JointArrays(Arrays::Uneven(lengths));
        }
        let samples = lengths.first().copied().unwrap_or(0);
        Channels::appended(arrays.len(), samples, |joint, data| data.extend_from_slice(arrays[joint].as_ref())).into()
    }
}

impl<A: AsRef<[f64]>> From<&Vec<A>> for JointArrays {
    fn from(arrays: &Vec<A>) -> Self {
        arrays.as_slice().into()
    }
}

impl<A: AsRef<[f64]>> From<Vec<A>> for JointArrays {
    fn from(arrays: Vec<A>) -> Self {
        arrays.as_slice().into()
    }
}

impl<A: AsRef<[f64]>, const N: usize> From<[A; N]> for JointArrays {
    fn from(arrays: [A; N]) -> Self {
        arrays.as_slice().into()
    }
}

impl<A: AsRef<[f64]>, const N: usize> From<&[A; N]> for JointArrays {
    fn from(arrays: &[A; N]) -> Self {
        arrays.as_slice().into()
    }
}

impl JointArrays {
    /// The table of the array called `name`, for these joints and so many samples.
    ///
    /// # Errors
    /// Another number of joints or samples: the array, the joint where it is one, what it has and what is wanted.
    pub(super) fn checked(self, name: &str, joints: &[String], samples: usize) -> Result<Channels> {
        let wanted = format!("{} of {}", count(joints.len(), "joint"), count(samples, "sample"));
        let refused = |problem: String| Err(Error::request(name, problem));
        match self.0 {
            Arrays::Even(table) if (table.channels(), table.samples()) == (joints.len(), samples) => Ok(table),
            Arrays::Even(table) => {
                let found = format!("{} of {}", count(table.channels(), "joint"), count(table.samples(), "sample"));
                let turned = (table.samples(), table.channels()) == (joints.len(), samples);
                let cure = if turned { "; transpose it" } else { "" };
                refused(format!("has {found}; {wanted} are wanted{cure}"))
            }
            Arrays::Uneven(lengths) if lengths.len() != joints.len() => {
                refused(format!("has {}; {wanted} are wanted", count(lengths.len(), "joint")))
            }
            Arrays::Uneven(lengths) => {
                let other = lengths.iter().zip(joints).find(|(length, _)| **length != samples);
                let (length, joint) = other.map_or((0, ""), |(length, joint)| (*length, joint.as_str()));
                let found = count(length, "sample");
                refused(format!("joint `{joint}` has {found}; {samples} are wanted, one for each time"))
            }
        }
    }
}

fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use crate::channels::Channels;
    use crate::error::Result;
    use crate::recording::Log;
    use crate::robot::{InertiaCheck, Robot, load};

    fn irb() -> Robot {
        load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Ignored).unwrap()
    }

    #[test]
    fn arrays_become_the_log_of_a_robot() {
        let robot = irb();
        let (t, each) = (vec![0.0, 0.1, 0.2], vec![vec![1.0, 2.0, 3.0]; 6]);
        let table = Channels::from_vectors(&each);
        let log = Log::new(&robot, &t, &each, &table).unwrap();
        let log = log.velocities(each.as_slice()).unwrap().accelerations(table.clone()).unwrap();
        assert_eq!((log.joints(), log.samples(), log.robot.as_str()), (6, 3, robot.name.as_str()));
        assert_eq!((log.joints, log.time), (robot.joint_names(), t));
        assert_eq!([log.q, log.tau, log.qd.unwrap(), log.qdd.unwrap()], [&table; 4].map(Clone::clone));
    }

    #[test]
    fn arrays_of_another_shape_are_named_with_what_is_wanted() {
        let robot = irb();
        let t = [0.0, 0.1];
        let whole = || vec![vec![0.0; 2]; 6];
        let (mut long, mut wide) = (whole(), whole());
        long[3].push(1.0);
        wide.push(vec![0.0; 3]);
        let log = |q, tau| Log::new(&robot, t, q, tau);
        let good = || log(whole(), whole()).unwrap();
        let cases: [(Result<Log>, &str); 6] = [
            (log(long.clone(), whole()), "q: joint `joint_4` has 3 samples; 2 are wanted, one for each time"),
            (log(whole(), wide), "tau: has 7 joints; 6 joints of 2 samples are wanted"),
            (log(whole(), Vec::new()), "tau: has 0 joints of 0 samples; 6 joints of 2 samples are wanted"),
            (
                good().velocities(vec![[0.0; 6]; 2]),
                "qd: has 2 joints of 6 samples; 6 joints of 2 samples are wanted; transpose it",
            ),
            (good().accelerations(long), "qdd: joint `joint_4` has 3 samples; 2 are wanted, one for each time"),
            (
                good().velocities(Channels::zeros(6, 1)),
                "qd: has 6 joints of 1 sample; 6 joints of 2 samples are wanted",
            ),
        ];
        for (refused, expected) in cases {
            assert_eq!(refused.unwrap_err().to_string(), expected);
        }
    }
}
