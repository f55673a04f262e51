//! The number type of the kernels: one sample, or several side by side.

mod aligned;
#[cfg(target_arch = "x86_64")]
mod chacha;
pub(crate) mod dispatch;
#[cfg(target_arch = "aarch64")]
mod neon;
mod number;
mod portable;
mod sin_cos;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(crate) use aligned::Aligned;
pub(crate) use dispatch::Kernel;
pub use dispatch::Lanes;
pub use number::Lane;
pub(crate) use number::WIDEST;
