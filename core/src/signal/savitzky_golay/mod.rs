//! Savitzky-Golay filters: polynomials fitted to a sliding window by least squares, and the window that suits a signal.

mod gram;
mod sliding;
mod smoother;
mod window;

pub use smoother::{Edge, SavitzkyGolay};
pub(crate) use window::half_gain_hz;
pub(crate) use window::noise_share;
pub use window::window_by_noise;
