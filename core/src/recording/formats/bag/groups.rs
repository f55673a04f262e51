//! Messages of a log in groups of one topic and the same joints.

use super::joint_state::JointState;
use super::storage::Topic;
use super::table::Table;
use crate::error::{Error, Result};
use std::path::Path;

/// Messages on one topic about the same joints.
#[derive(Debug)]
struct Group {
    topic: String,
    names: Vec<String>,
    numbers: Vec<usize>,
    stamps: Vec<i64>,
    logged: Vec<i64>,
    /// Position, velocity and effort, `[quantity][joint][message]`.
    values: [Vec<Vec<f64>>; 3],
}

/// All messages so far.
#[derive(Debug, Default)]
pub(super) struct Groups {
    all: Vec<Group>,
    /// Messages heard on every topic.
    heard: Vec<(String, usize)>,
    bad: Vec<(String, usize, String)>,
}

impl Groups {
    /// Adds a message, of which `logged` is the time at which it was logged.
    pub(super) fn add(&mut self, topic: &str, logged: i64, data: &[u8]) {
        let heard = match self.heard.iter_mut().find(|(own, _)| own == topic) {
            Some((_, count)) => {
                *count += 1;
                *count
            }
            None => {
                self.heard.push((topic.to_owned(), 1));
                1
            }
        };
        let state = match JointState::decode(data) {
            Ok(state) => state,
            Err(problem) => return self.bad.push((topic.to_owned(), heard, problem)),
        };
        let same = |group: &Group| group.topic == topic && group.order(&state.names).is_some();
        let place = self.all.iter().rposition(same).unwrap_or_else(|| {
            let columns = || vec![Vec::new(); state.names.len()];
            self.all.push(Group {
                topic: topic.to_owned(),
                names: state.names.clone(),
                numbers: Vec::new(),
                stamps: Vec::new(),
                logged: Vec::new(),
                values: std::array::from_fn(|_| columns()),
            });
            self.all.len() - 1
        });
        self.all[place].push(heard, logged, &state);
    }

    /// The messages that are wanted, as a table.
    pub(super) fn choose(
        self,
        path: &Path,
        topics: &[Topic],
        joints: Option<&[String]>,
        topic: Option<&str>,
    ) -> Result<Table> {
        let listed = || {
            let named = topics.iter().map(|topic| format!("{} ({}, {})", topic.name, topic.kind, topic.encoding));
            named.collect::<Vec<_>>().join(", ")
        };
        let mut groups = self.all;
        if let Some(topic) = topic {
            groups.retain(|group| group.topic == topic);
        }
        // A gripper may have a topic of its own.
        let wanted = |group: &Group| match joints {
            Some(joints) => joints.iter().filter(|joint| group.names.contains(joint)).count(),
            None => 0,
        };
        let most = groups.iter().map(wanted).max().unwrap_or(0);
        groups.retain(|group| wanted(group) == most);
        if groups.iter().any(Group::has_effort) {
            groups.retain(Group::has_effort);
        }
        groups.sort_by_key(|group| std::cmp::Reverse(group.numbers.len()));
        let Some(first) = groups.first() else {
            let wanted = topic.unwrap_or("sensor_msgs/msg/JointState in cdr");
            let problem = match topics.is_empty() {
                true => "there is no message in it".to_owned(),
                false => format!("no message of {wanted} that can be read; the log has {}", listed()),
            };
            return Err(Error::input(path, None, "topic", problem));
        };
        let mut rivals: Vec<&str> = groups.iter().map(|group| group.topic.as_str()).collect();
        rivals.sort_unstable();
        rivals.dedup();
        if rivals.len() > 1 {
            let problem = format!("{} hold joint states; choose one in a dataset: [columns] topic", rivals.join(", "));
            return Err(Error::input(path, None, "topic", problem));
        }
        let chosen = first.topic.clone();
        let mut notes = Vec::new();
        let others = self.heard.iter().filter(|(topic, _)| *topic != chosen);
        notes.extend(others.map(|(topic, count)| format!("topic not used: {topic} ({count} messages)")));
        let rest: usize = groups[1..].iter().map(|group| group.numbers.len()).sum();
        if rest > 0 {
            notes.push(format!("{rest} messages of {chosen} about other joints are not used"));
        }
        let group = groups.swap_remove(0);
        let bad = self.bad.into_iter().filter(|(topic, ..)| *topic == chosen);
        let bad = bad.map(|(_, number, problem)| (number, problem)).collect();
        Ok(Table { bad, ..group.table(notes) })
    }
}

impl Group {
    /// Where each of this group's joints is among `names`; None for other joints.
    fn order(&self, names: &[String]) -> Option<Vec<usize>> {
        if names.len() != self.names.len() {
            return None;
        }
        self.names.iter().map(|own| names.iter().position(|name| name == own)).collect()
    }

    fn has_effort(&self) -> bool {
        self.values[2].iter().any(|column| column.iter().any(|value| value.is_finite()))
    }

    fn push(&mut self, number: usize, logged: i64, state: &JointState) {
        let order: Vec<usize> = match state.names == self.names {
            true => (0..self.names.len()).collect(),
            false => self.order(&state.names).unwrap_or_default(),
        };
        let sent = [&state.position, &state.velocity, &state.effort];
        for (columns, sent) in self.values.iter_mut().zip(sent) {
            for (column, &place) in columns.iter_mut().zip(&order) {
                column.push(sent.get(place).copied().unwrap_or(f64::NAN));
            }
        }
        self.numbers.push(number);
        self.stamps.push(state.stamp_ns);
        self.logged.push(logged);
    }

    fn table(self, mut notes: Vec<String>) -> Table {
        let stamped = self.stamps.iter().any(|&stamp| stamp != 0);
        if !stamped {
            notes.push("the messages carry no time; that at which they were logged is used".to_owned());
        }
        let stamps = if stamped { self.stamps } else { self.logged };
        let start_ns = stamps.first().copied().unwrap_or_default();
        let mut header = vec!["t".to_owned()];
        let mut columns: Vec<Vec<f64>> =
            vec![stamps.iter().map(|stamp| stamp.saturating_sub(start_ns) as f64 / 1e9).collect()];
        for (ending, values) in ["position", "velocity", "effort"].into_iter().zip(self.values) {
            if values.iter().all(|column| column.iter().all(|value| value.is_nan())) {
                continue;
            }
            header.extend(self.names.iter().map(|name| format!("{name}_{ending}")));
            columns.extend(values);
        }
        Table { topic: self.topic, start_ns, header, columns, numbers: self.numbers, notes, ..Table::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(topic: &str, names: &[&str]) -> Group {
        Group {
            topic: topic.to_owned(),
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            numbers: vec![1, 2],
            stamps: vec![0, 10],
            logged: vec![0, 10],
            values: std::array::from_fn(|_| vec![vec![0.5, 0.6]; names.len()]),
        }
    }

    #[test]
    fn the_topic_of_the_joints_that_are_wanted() {
        let all = || vec![group("/gripper/joint_states", &["finger"]), group("/joint_states", &["a", "b"])];
        let chosen = |joints: Option<&[&str]>| {
            let groups = Groups { all: all(), ..Groups::default() };
            let joints: Option<Vec<String>> = joints.map(|all| all.iter().map(|&name| name.to_owned()).collect());
            groups.choose(Path::new("log"), &[], joints.as_deref(), None).map(|table| table.topic)
        };
        // A robot with its gripper, of which no topic has all joints, and the arm alone.
        assert_eq!(chosen(Some(&["a", "b", "finger"])).unwrap(), "/joint_states");
        assert_eq!(chosen(Some(&["a", "b"])).unwrap(), "/joint_states");
        assert_eq!(chosen(Some(&["finger"])).unwrap(), "/gripper/joint_states");
        assert!(chosen(None).unwrap_err().to_string().contains("choose one"));
    }
}
