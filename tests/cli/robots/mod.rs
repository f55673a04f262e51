//! Robots of all shapes: arms without and with grippers, trees, and what their files hold.

mod arms;
mod grippers;
