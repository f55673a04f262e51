//! The commands, one file each. The arguments of a command come in; its exit code goes out, and what it printed or wrote.

pub mod blind;
pub mod check;
pub mod diagnose;
pub mod effects;
pub mod excite;
pub mod identify;
pub mod inspect;
pub mod montecarlo;
pub mod paper;
pub mod payload;
pub mod robot;
pub mod run;
pub mod simulate;
pub mod view;
