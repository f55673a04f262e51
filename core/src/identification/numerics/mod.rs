//! Linear algebra of regressions. Tables of columns and signals come in; Gram matrices, triangles, solutions and eigenvalues go
//! out. Nothing here knows of arms or logs.

pub(super) mod bounded;
pub(crate) mod gram;
pub(super) mod scaled_normal;
pub(crate) mod sequences;
pub(crate) mod spectrum;
pub mod tsqr;
