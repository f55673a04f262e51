//! Cases of this area.
