//! Tests of the library through its public items, one module per subject. They are one program, since each program links
//! the simulator, Parquet and the viewer once more.

mod consistent;
mod crates;
mod dynamics;
mod effects;
mod effects_in_the_loop;
mod excite;
mod identification;
mod imports;
mod integration_error;
mod montecarlo;
mod near_dependent;
mod paper;
mod plant;
mod signal;
mod sliding;
#[cfg(feature = "viewer")]
mod viewer;
