//! Arrays of numpy: `.npz` with an array per quantity, `.npy` with named fields.
//!
//! In: `np.savez("log.npz", t=t, q=q, tau=tau)`: time of N samples, the others N x joints (or joints x N). Out: a [`Table`]. Arrays are
//! called as columns are (`columns::names`); an array `names` of text names the joints.

mod archive;
mod array;
mod table;
#[cfg(test)]
mod tests;

pub(crate) use table::{Table, is_npz, npy, npz};
