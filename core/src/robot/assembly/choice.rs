//! Which joints of a file are under study, and whether its inertias are used.

use std::collections::BTreeMap;

/// Whether the inertias in a file are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InertiaCheck {
    /// They are believed: an impossible one is an error, friction below zero too.
    Required,
    /// They will be identified or are placeholders: impossible ones pass, and friction below zero counts as none.
    Ignored,
}

/// Which joints of a file are under study.
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
