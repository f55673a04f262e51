//! Shares of the torques that decide about a description.

/// The bodies' torque counts where the residual of a joint's fit, or the mean of all joints, is less than this of its torque.
pub(super) const ALIKE: f64 = 0.35;

/// Under described bodies a torque of which less than this share is unexplained accuses nothing: masses that are wrong by a fifth
/// leave as much, and what changes the model a little always makes up for some of that.
pub(super) const WRONG_MASSES: f64 = 0.15;

/// One torque may have a cause of its own, as a spring or a factor.
pub(super) const FEWEST: usize = 2;

/// Share from which described bodies need more torque than there is: no load, friction or rotor takes that off. Of so many joints that is
/// enough.
pub(super) const MORE_THAN_ALL: f64 = 1.0;
