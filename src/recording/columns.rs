//! The table of a recording: which column is which signal of which joint. CSV and Parquet share it.

use super::{Recording, Signals};
use crate::channels::Channels;
use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Prefixes that a column's name may have, the ones that are written first, with the suffixes of the other style.
const POSITION: Quantity = Quantity { name: "position", prefixes: &["q"], suffixes: &["_position"] };
const VELOCITY: Quantity = Quantity { name: "velocity", prefixes: &["qd", "dq"], suffixes: &["_velocity"] };
const ACCELERATION: Quantity =
    Quantity { name: "acceleration", prefixes: &["qdd", "ddq"], suffixes: &["_acceleration"] };
const TORQUE: Quantity = Quantity { name: "torque", prefixes: &["tau"], suffixes: &["_effort", "_torque"] };
const QUANTITIES: [Quantity; 4] = [POSITION, VELOCITY, ACCELERATION, TORQUE];
const TRUE: &str = "_true";

/// A measured quantity and how its columns are called: `q1`, `q_elbow` or `elbow_position`.
#[derive(Debug, Clone, Copy)]
struct Quantity {
    name: &'static str,
    prefixes: &'static [&'static str],
    suffixes: &'static [&'static str],
}

/// Whose signal a column holds.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Joint<'a> {
    /// The joint's number, counted from 1.
    Number(usize),
    Name(&'a str),
}

/// Columns of one quantity: number of the joint -> index of the column.
type Found = BTreeMap<usize, usize>;

/// The columns of a recording in the order they are written.
pub fn table(recording: &Recording) -> Result<Vec<(String, &[f64])>> {
    let truth = recording.truth.as_ref();
    let groups = [
        (POSITION, "", Some(&recording.q)),
        (VELOCITY, "", recording.qd.as_ref()),
        (ACCELERATION, "", recording.qdd.as_ref()),
        (TORQUE, "", Some(&recording.tau)),
        (POSITION, TRUE, truth.map(|signals| &signals.q)),
        (VELOCITY, TRUE, truth.map(|signals| &signals.qd)),
        (ACCELERATION, TRUE, truth.map(|signals| &signals.qdd)),
        (TORQUE, TRUE, truth.map(|signals| &signals.tau)),
    ];
    let shape = (recording.joints(), recording.samples());
    let mut columns = vec![("t".to_owned(), recording.time.as_slice())];
    for (quantity, ending, channels) in groups {
        let Some(channels) = channels else { continue };
        if (channels.channels(), channels.samples()) != shape {
            let problem = format!(
                "{} joints of {} samples in a recording of {} joints and {} samples; give all signals the same shape",
                channels.channels(),
                channels.samples(),
                shape.0,
                shape.1
            );
            return Err(Error::request(format!("{}{ending}", quantity.name), problem));
        }
        let prefix = quantity.prefixes[0];
        let named =
            channels.iter().enumerate().map(|(joint, signal)| (format!("{prefix}{}{ending}", joint + 1), signal));
        columns.extend(named);
    }
    Ok(columns)
}

/// Which column of a file is which signal; every table holds one column index per joint.
#[derive(Debug)]
pub struct Layout {
    joints: Vec<String>,
    time: usize,
    q: Vec<usize>,
    qd: Option<Vec<usize>>,
    qdd: Option<Vec<usize>>,
    tau: Vec<usize>,
    truth: Option<[Vec<usize>; 4]>,
    /// What the file has and the recording will not.
    pub notes: Vec<String>,
}

/// The first value that cannot be used.
#[derive(Debug)]
pub struct Fault {
    /// Counted from 0.
    pub row: usize,
    /// Index of the column.
    pub column: usize,
    /// What is wrong.
    pub problem: String,
}

impl Layout {
    /// Finds the columns by their names in the header, which stands at `line` of the file. `joints` are the robot's
    /// joints in order; without them the header's own numbers or names are taken.
    ///
    /// # Errors
    /// A column missing or twice, a hole in the numbering, other joints than `joints`.
    pub fn find(path: &Path, line: Option<usize>, header: &[String], joints: Option<&[String]>) -> Result<Layout> {
        let meanings: Vec<_> = header.iter().map(|name| meaning(name)).collect();
        let names = match joints {
            Some(joints) => joints.to_vec(),
            None => own_names(&meanings),
        };
        let mut time = None;
        let mut found: [[Found; 4]; 2] = Default::default();
        let mut unused = Vec::new();
        for (column, name) in header.iter().enumerate() {
            let second = if name.eq_ignore_ascii_case("t") || name.eq_ignore_ascii_case("time") {
                time.replace(column)
            } else {
                let number = |joint| match joint {
                    Joint::Number(number) => Some(number),
                    Joint::Name(name) => names.iter().position(|other| other == name).map(|index| index + 1),
                };
                let place = meanings[column].and_then(|(truth, kind, joint)| Some((truth, kind, number(joint)?)));
                let Some((truth, kind, number)) = place else {
                    unused.push(if name.is_empty() { format!("(column {})", column + 1) } else { name.clone() });
                    continue;
                };
                found[usize::from(truth)][kind].insert(number, column)
            };
            if let Some(first) = second {
                let problem = format!("tells the same as column {}; leave one of them out", header[first]);
                return Err(Error::input(path, line, name, problem));
            }
        }
        let resolver = Resolver { path, line, header, names: &names, fixed: joints.is_some() };
        let Some(time) = time else { return Err(resolver.missing("t", "no column of time (t or time, in s)")) };
        let [measured, truth] = &found;
        let q = resolver.all(POSITION, &measured[0], None)?;
        let count = q.len();
        let optional = |quantity, found: &Found| {
            if found.is_empty() { Ok(None) } else { resolver.all(quantity, found, Some(count)).map(Some) }
        };
        let mut layout = Layout {
            time,
            qd: optional(VELOCITY, &measured[1])?,
            qdd: optional(ACCELERATION, &measured[2])?,
            tau: resolver.all(TORQUE, &measured[3], Some(count))?,
            q,
            truth: None,
            notes: Vec::new(),
            joints: if names.is_empty() { (1..=count).map(|joint| format!("joint_{joint}")).collect() } else { names },
        };
        if truth.iter().all(|found| found.keys().copied().eq(1..=count)) {
            layout.truth = Some(std::array::from_fn(|kind| truth[kind].values().copied().collect()));
        } else if truth.iter().any(|found| !found.is_empty()) {
            layout.notes.push(format!(
                "columns ending in {TRUE} are not used: they must be there for position, velocity, acceleration and \
                 torque of all {count} joints"
            ));
        }
        if !unused.is_empty() {
            layout.notes.push(format!("columns not used: {}", unused.join(", ")));
        }
        Ok(layout)
    }

    /// Indices of the columns that make the recording, increasing.
    pub fn used(&self) -> Vec<usize> {
        let mut used = vec![self.time];
        let optional = [&self.qd, &self.qdd].into_iter().flatten();
        let truth = self.truth.iter().flatten();
        used.extend([&self.q, &self.tau].into_iter().chain(optional).chain(truth).flatten());
        used.sort_unstable();
        used
    }

    /// Index of the column of time.
    pub fn time(&self) -> usize {
        self.time
    }

    /// The first row with a value that is not finite or a time that does not increase. `columns` is indexed as the
    /// header.
    pub fn fault(&self, columns: &[Vec<f64>]) -> Option<Fault> {
        let infinite = self.used().into_iter().filter_map(|column| {
            let row = columns[column].iter().position(|value| !value.is_finite())?;
            Some(Fault { row, column, problem: format!("{} is not a finite number", columns[column][row]) })
        });
        let time = &columns[self.time];
        let backward = time.windows(2).position(|pair| pair[1] <= pair[0]).map(|before| Fault {
            row: before + 1,
            column: self.time,
            problem: format!("time must increase, but {:?} s follows {:?} s", time[before + 1], time[before]),
        });
        infinite.chain(backward).min_by_key(|fault| fault.row)
    }

    /// The recording; `columns` is indexed as the header. Robot and provenance stay empty.
    pub fn recording(self, mut columns: Vec<Vec<f64>>) -> Recording {
        let mut take = |indices: &[usize]| {
            let vectors: Vec<_> = indices.iter().map(|&index| std::mem::take(&mut columns[index])).collect();
            Channels::from_vectors(&vectors)
        };
        let q = take(&self.q);
        let qd = self.qd.as_deref().map(&mut take);
        let qdd = self.qdd.as_deref().map(&mut take);
        let tau = take(&self.tau);
        let truth = self.truth.map(|[q, qd, qdd, tau]| {
            Arc::new(Signals { q: take(&q), qd: take(&qd), qdd: take(&qdd), tau: take(&tau) })
        });
        let time = std::mem::take(&mut columns[self.time]);
        Recording { joints: self.joints, time, q, qd, qdd, tau, truth, ..Default::default() }
    }
}

/// What a column's name says: of the truth or measured, index of the quantity, joint.
fn meaning(name: &str) -> Option<(bool, usize, Joint<'_>)> {
    let (truth, name) = name.strip_suffix(TRUE).map_or((false, name), |name| (true, name));
    let of = |kind: usize| {
        let Quantity { prefixes, suffixes, .. } = QUANTITIES[kind];
        let behind = prefixes.iter().find_map(|prefix| {
            // Exports like to shout: Q1, TAU1.
            let rest = name
                .get(..prefix.len())
                .filter(|own| own.eq_ignore_ascii_case(prefix))
                .map(|_| &name[prefix.len()..])?;
            let bare = rest.strip_prefix('_').unwrap_or(rest);
            if !bare.is_empty() && bare.bytes().all(|byte| byte.is_ascii_digit()) {
                return bare.parse().ok().map(Joint::Number);
            }
            (bare.len() < rest.len() && !bare.is_empty()).then_some(Joint::Name(bare))
        });
        let before = suffixes.iter().find_map(|suffix| name.strip_suffix(suffix)).filter(|joint| !joint.is_empty());
        behind.or(before.map(Joint::Name)).map(|joint| (truth, kind, joint))
    };
    (0..QUANTITIES.len()).find_map(of)
}

/// The joints whose positions a header names or numbers.
pub fn joint_names(header: &[String]) -> super::lenient::JointNames {
    let meanings: Vec<_> = header.iter().map(|name| meaning(name)).collect();
    let names = own_names(&meanings);
    let numbered = |meaning: &&Option<(bool, usize, Joint)>| matches!(meaning, Some((false, 0, Joint::Number(_))));
    let numbered = meanings.iter().filter(numbered).count();
    super::lenient::JointNames { names, numbered }
}

/// Joint names in the order of their positions; none where the positions are numbered.
fn own_names(meanings: &[Option<(bool, usize, Joint)>]) -> Vec<String> {
    let positions = meanings.iter().flatten().filter(|(truth, kind, _)| !truth && *kind == 0);
    let names: Option<Vec<String>> = positions
        .map(|(_, _, joint)| match joint {
            Joint::Name(name) => Some((*name).to_owned()),
            Joint::Number(_) => None,
        })
        .collect();
    let mut unique: Vec<String> = Vec::new();
    for name in names.unwrap_or_default() {
        if !unique.contains(&name) {
            unique.push(name);
        }
    }
    unique
}

/// Turns columns found into one column per joint, or says what is missing.
struct Resolver<'a> {
    path: &'a Path,
    line: Option<usize>,
    header: &'a [String],
    names: &'a [String],
    /// The names are the caller's, not the header's.
    fixed: bool,
}

impl Resolver<'_> {
    /// Column of each joint; `count` joints where that is already known.
    fn all(&self, quantity: Quantity, found: &Found, count: Option<usize>) -> Result<Vec<usize>> {
        let Quantity { name, prefixes, suffixes } = quantity;
        let named = (!self.names.is_empty() || self.fixed).then_some(self.names.len());
        let highest = found.last_key_value().map_or(0, |(&number, _)| number);
        let count = count.or(named).unwrap_or(highest);
        let robot = || format!("the robot has {} joints ({})", self.names.len(), self.names.join(", "));
        if let Some(column) = found.get(&0) {
            let problem = format!("joints are counted from 1: rename the columns to {0}1, {0}2, ...", prefixes[0]);
            return Err(Error::input(self.path, self.line, &self.header[*column], problem));
        }
        if let Some((_, &column)) = found.range(count + 1..).next() {
            let known = if self.fixed { robot() } else { format!("there are positions of {count} joints") };
            let problem = format!("a {name} too many: {known}");
            return Err(Error::input(self.path, self.line, &self.header[column], problem));
        }
        let gap = (1..=count.max(1)).find(|number| !found.contains_key(number));
        let Some(gap) = gap else { return Ok(found.values().copied().collect()) };
        let column = format!("{}{gap}", prefixes[0]);
        let accepted = match self.names.get(gap - 1) {
            Some(joint) => format!("{column}, {}_{joint} or {joint}{}", prefixes[0], suffixes[0]),
            None => column.clone(),
        };
        let reason = if found.is_empty() {
            format!("no column of {name} ({accepted})")
        } else if gap < highest {
            let next = found.range(gap..).next().map_or("", |(_, &column)| self.header[column].as_str());
            format!("a hole in the numbering: {next} is there, but no {accepted}")
        } else if self.fixed {
            format!("fewer joints than the robot: no {accepted}; {}", robot())
        } else {
            format!("no column {accepted}, though there are positions of {count} joints")
        };
        Err(self.missing(&column, &reason))
    }

    fn missing(&self, column: &str, reason: &str) -> Error {
        const SHOWN: usize = 30;
        let mut found = self.header.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
        if self.header.len() > SHOWN {
            found += &format!(" and {} more", self.header.len() - SHOWN);
        }
        let hint = if self.header.iter().all(|name| name.parse::<f64>().is_ok()) {
            "; the first line must name the columns"
        } else if self.line.is_some() {
            "; rename the columns, or tell their names in a dataset ([columns])"
        } else {
            ""
        };
        Error::input(self.path, self.line, column, format!("missing column: {reason}; found: {found}{hint}"))
    }
}

#[cfg(test)]
mod tests {
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
        for header in
            ["t,q_b,q_a,qd_a,qd_b,tau_a,tau_b", "t,b_position,a_position,a_velocity,b_velocity,a_effort,b_effort"]
        {
            let own = find(header, None).unwrap();
            assert_eq!((own.joints, own.q, own.tau), (vec!["b".into(), "a".into()], vec![1, 2], vec![6, 5]));
            let ordered = find(header, Some(&["a", "b"])).unwrap();
            assert_eq!((ordered.q, ordered.qd, ordered.tau), (vec![2, 1], Some(vec![3, 4]), vec![5, 6]));
        }
        let layout = find("t,q_1,q_2,ddq_1,ddq_2,tau_1,tau_2", Some(&["a", "b"])).unwrap();
        assert_eq!((layout.q, layout.qdd), (vec![1, 2], Some(vec![3, 4])));
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
            ("t,q0,q1,tau0,tau1", None, ["log.csv:1: q0:", "counted from 1"]),
            ("t,q1,tau1,tau2", None, ["log.csv:1: tau2:", "too many: there are positions of 1 joints"]),
            ("t,q1,q2,tau1,tau2", Some(six), ["log.csv:1: q3:", "fewer joints than the robot"]),
            ("t,q1,q2,q3,q4,tau1", Some(six), ["log.csv:1: q4:", "the robot has 3 joints (a, b, c)"]),
            ("t,q_x,tau_x", Some(six), ["log.csv:1: q1:", "(q1, q_a or a_position)"]),
            ("t,q_a,q_b,tau_a", None, ["log.csv:1: tau2:", "tau_b"]),
            ("t,q1,tau1", Some(&[]), ["log.csv:1: q1:", "the robot has 0 joints"]),
            ("t,q1,qd1,dq1,tau1", None, ["log.csv:1: dq1:", "the same as column qd1"]),
            ("t,time,q1,tau1", None, ["log.csv:1: time:", "the same as column t"]),
            ("0.0,1.5,2.5", None, ["log.csv:1: t:", "the first line must name the columns"]),
            ("Zeit,Winkel1,tau1", None, ["log.csv:1: t:", "in a dataset ([columns])"]),
        ];
        for (header, joints, expected) in cases {
            let problem = problem(header, joints);
            assert!(expected.iter().all(|part| problem.contains(part)), "{header}: {problem}");
        }
    }
}
