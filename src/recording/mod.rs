//! x
use crate::channels::Channels;
use std::collections::BTreeMap;
/// x
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct Signals { pub q: Channels, pub qd: Channels, pub qdd: Channels, pub tau: Channels }
/// x
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct Recording {
    pub robot: String, pub joints: Vec<String>, pub time: Vec<f64>,
    pub q: Channels, pub qd: Option<Channels>, pub qdd: Option<Channels>, pub tau: Channels,
    pub truth: Option<Signals>,
    pub provenance: BTreeMap<String,String>
}
impl Recording { /// x
 pub fn rate_hz(&self)->f64 {1.0/(self.time[1]-self.time[0])}}
