//! The messages of a log as a table.

/// The messages of one topic about the same joints as a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Table {
    /// The topic.
    pub topic: String,
    /// Time of the first message, ns since 1970.
    pub start_ns: i64,
    /// `t` and one column per joint and quantity that was sent.
    pub header: Vec<String>,
    /// Values, indexed as the header; NaN where a message has none.
    pub columns: Vec<Vec<f64>>,
    /// Number of every message on its topic, counted from 1.
    pub numbers: Vec<usize>,
    /// Messages that cannot be read: number, what is wrong.
    pub bad: Vec<(usize, String)>,
    /// Why reading ended before the end of the log.
    pub cut_off: Option<String>,
    /// What the log has and the table has not.
    pub notes: Vec<String>,
}
