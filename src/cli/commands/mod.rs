//! The commands, one file each. The arguments of a command come in; its exit code goes out, and what it printed or wrote.

pub(super) mod blind;
pub(super) mod check;
pub(super) mod diagnose;
pub(super) mod effects;
pub(super) mod excite;
pub(super) mod identify;
pub(super) mod inspect;
pub(super) mod montecarlo;
pub(super) mod paper;
pub(super) mod payload;
pub(super) mod robot;
pub(super) mod run;
pub(super) mod simulate;
pub(super) mod view;
