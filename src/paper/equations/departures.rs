//! Every place at which the code does not follow the print, as data.

use super::variant::Variant;
use super::velocity_form::VelocityForm;

/// One difference between print and code.
#[derive(Debug)]
pub(crate) struct Departure {
    /// Number of the equation or table, and the term in it.
    pub equation: &'static str,
    /// What is printed.
    pub printed: &'static str,
    /// What the code uses instead.
    pub used: &'static str,
    /// The reason.
    pub why: &'static str,
    /// The variants that use it; the others follow the print.
    pub variants: &'static [Variant],
    /// The printed term, where some variant still computes it.
    pub place: Place,
}

/// A printed term of (4)-(9) that differs from the corrected one. Rows and columns are joints counted from 1, numbers are
/// those of X.
#[derive(Debug)]
pub(crate) enum Place {
    /// The factor of theta_column'' in the equation of joint `row`.
    Inertia {
        /// Joint of the equation.
        row: usize,
        /// Joint that accelerates.
        column: usize,
        /// X outside the cosine.
        constant: &'static [usize],
        /// X that the cosine multiplies; on the diagonal the cosine is 1 and these only stand apart.
        cosine: &'static [usize],
    },
    /// The term with the sine of the angle between `row` and `column` in the equation of joint `row`.
    Velocity {
        /// Joint of the equation.
        row: usize,
        /// The other joint.
        column: usize,
        /// The velocity factor.
        form: VelocityForm,
        /// X that it multiplies.
        parameters: &'static [usize],
    },
    /// In no single term that [`Variant::AsPrinted`] could follow.
    Elsewhere,
}

const CORRECTED: &[Variant] = &[Variant::Consistent, Variant::EulerLagrange];
const ALL: &[Variant] = &[Variant::AsPrinted, Variant::Consistent, Variant::EulerLagrange];

/// The departures, in the order of the paper.
pub(crate) const DEPARTURES: &[Departure] = &[
    Departure {
        equation: "(4), factor of theta2''",
        printed: "X7 + cos(theta1 - theta2) (X8 + X9 + X10 + X11) + X12",
        used: "X7 + cos(theta1 - theta2) (X8 + X9 + X10 + X11 + X12)",
        why: "a bracket closed too early: the sine term of (4) and both terms of (5) treat X12 as X8..X11",
        variants: CORRECTED,
        place: Place::Inertia { row: 1, column: 2, constant: &[7, 12], cosine: &[8, 9, 10, 11] },
    },
    Departure {
        equation: "(5), sin(theta1 - theta2)",
        printed: "theta2'^2 - theta1' theta2'",
        used: "theta1' theta2' - theta1'^2",
        why: "the term of (4) is repeated; (6)-(9) all have the form used for a joint of lower number",
        variants: CORRECTED,
        place: Place::Velocity { row: 2, column: 1, form: VelocityForm::Lower, parameters: &[12, 11, 10, 9, 8] },
    },
    Departure {
        equation: "(5), sin(theta2 - theta3)",
        printed: "X37 + X36 + X35",
        used: "X38 + X37 + X36 + X35",
        why: "X38 is in the cosine of (5) and in both terms of (6)",
        variants: CORRECTED,
        place: Place::Velocity { row: 2, column: 3, form: VelocityForm::Lower, parameters: &[37, 36, 35] },
    },
    Departure {
        equation: "(6), factor of theta1''",
        printed: "X18",
        used: "X13",
        why: "(4) has X13 at theta3''; the mass matrix is symmetric",
        variants: CORRECTED,
        place: Place::Inertia { row: 3, column: 1, constant: &[18], cosine: &[14, 15, 16, 17] },
    },
    Departure {
        equation: "(6), factor of theta2''",
        printed: "X18",
        used: "X13",
        why: "(5) has X13 at theta3''; the mass matrix is symmetric",
        variants: CORRECTED,
        place: Place::Inertia { row: 3, column: 2, constant: &[18], cosine: &[35, 36, 37, 38] },
    },
    Departure {
        equation: "(6), factor of theta3''",
        printed: "X18",
        used: "X13",
        why: "each row has its own constant on the diagonal: X7 in (5), X18 in (7), X22 in (8), X25 in (9)",
        variants: CORRECTED,
        place: Place::Inertia { row: 3, column: 3, constant: &[18], cosine: &[48, 49, 50, 51] },
    },
    Departure {
        equation: "(7), sin(theta4 - theta5)",
        printed: "theta4' theta5' + theta5'^2",
        used: "theta5'^2 - theta4' theta5'",
        why: "all other terms of a joint with one of higher number have this form",
        variants: CORRECTED,
        place: Place::Velocity { row: 4, column: 5, form: VelocityForm::Sum, parameters: &[65, 64] },
    },
    Departure {
        equation: "(8), factor of theta3''",
        printed: "X56 + X57",
        used: "X55 + X56",
        why: "(6) has X55 + X56 at theta5''; by Table A1 these are the shares of m6 and m5, X57 is m6 again",
        variants: CORRECTED,
        place: Place::Inertia { row: 5, column: 3, constant: &[22], cosine: &[56, 57] },
    },
    Departure {
        equation: "(8), sin(theta3 - theta5)",
        printed: "X57 + X56",
        used: "X56 + X55",
        why: "(6) has X56 + X55",
        variants: CORRECTED,
        place: Place::Velocity { row: 5, column: 3, form: VelocityForm::Higher, parameters: &[57, 56] },
    },
    Departure {
        equation: "(8), sin(theta4 - theta5)",
        printed: "X66 + X64",
        used: "X65 + X64",
        why: "the cosine of (8) and both terms of (7) have X64 + X65",
        variants: CORRECTED,
        place: Place::Velocity { row: 5, column: 4, form: VelocityForm::Higher, parameters: &[66, 64] },
    },
    Departure {
        equation: "(8), factor of theta6''",
        printed: "X25 + m6 cos(theta5 - theta6) X71",
        used: "X25 + cos(theta5 - theta6) X71",
        why: "m6 is no known number, X71 holds it by Table A1, and the sine term of (8) is without it",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "(9), factor of theta3''",
        printed: "X25 + cos(theta3 - theta6) X58",
        used: "X25 + cos(theta3 - theta6) X57",
        why: "(6) has X57 at theta6''; X58 is gravity on joint 3",
        variants: CORRECTED,
        place: Place::Inertia { row: 6, column: 3, constant: &[25], cosine: &[58] },
    },
    Departure {
        equation: "(9), factor of theta5''",
        printed: "X25 + m6 cos(theta5 - theta6) X71",
        used: "X25 + cos(theta5 - theta6) X71",
        why: "as in (8)",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "(9), sin(theta3 - theta6)",
        printed: "X58",
        used: "X57",
        why: "(6) has X57; X58 is gravity on joint 3",
        variants: CORRECTED,
        place: Place::Velocity { row: 6, column: 3, form: VelocityForm::Higher, parameters: &[58] },
    },
    Departure {
        equation: "(4)-(9), all sine terms",
        printed: "sin(theta_i - theta_j) (theta_j'^2 - theta_i' theta_j') B_ij",
        used: "sin(theta_i - theta_j) theta_j'^2 B_ij",
        why: "the printed terms are those of d/dt dT/dtheta'; the Euler-Lagrange equation also has -dT/dtheta",
        variants: &[Variant::EulerLagrange],
        place: Place::Elsewhere,
    },
    Departure {
        equation: "(4)-(9), g",
        printed: "no value",
        used: "9.81 m/s^2",
        why: "a number is needed",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "(13)",
        printed: "theta_0 h (t - t0) / T - ...",
        used: "theta_0 + h (t - t0) / T - ...",
        why: "a lost plus sign: the move starts at theta_0",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "(14)",
        printed: "h / 2 [1 - alpha cos() + cos() / 18 + cos() / 250]",
        used: "h / T [1 - alpha (cos() + cos() / 18 + cos() / 250)]",
        why: "the derivative of (13), which also makes the velocity zero at both ends",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "(13)-(15), alpha",
        printed: "0.9438",
        used: "1125 / 1192 = 0.94379...",
        why: "the rounded value gives a velocity of 1e-5 h / T at both ends",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "(17)",
        printed: "theta_i(t0) = theta_i(t1) = 0 for the move (13)",
        used: "sequences of moves that start and end at zero",
        why: "for one move it means h = 0: the arm stands still",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "Table 1",
        printed: "row 1 twice, 475 mm on the row labelled 3, no offset of 600 mm, five distinct rows",
        used: "the six rows at the right of Table 1",
        why: "the arm has six joints and its wrist centre is 600 mm from joint 3",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "Table 2, X29..X42",
        printed: "values missing from the available text",
        used: "a dash in Table 2",
        why: "the row holds the unit of X29..X42 and then the name of X43..X56",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "Tables A1 and 2, unit of friction",
        printed: "kg/s for Coulomb and viscous friction alike",
        used: "N m for Coulomb, N m s/rad for viscous friction",
        why: "X28 sgn(theta1') and X29 theta1' are torques",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "Tables A1 and 2, unit of X27, X45, X58, X67, X72, X76",
        printed: "kg m^2",
        used: "kg m",
        why: "g cos(theta1) X27 is a torque; Table A1 itself sums products of length and mass",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "Table A1, names of X47, X59, X60, X68, X69, X73, X74, X77, X78",
        printed: "f_1v for X47 and X60, f_2s for X59, no joint number from X68 on",
        used: "f_is and f_iv with the joint i of the equation",
        why: "each multiplies the velocity of its own joint",
        variants: ALL,
        place: Place::Elsewhere,
    },
    Departure {
        equation: "Table A1, X13, X18 and X22",
        printed: "X13 and X18 as X7: 2 (Iz2 + ... + Iz6); X22: 2 (Iz2 + Iz3)",
        used: "2 (Iz3 + ... + Iz6), 2 (Iz4 + Iz5 + Iz6), 2 (Iz5 + Iz6)",
        why: "X1, X7 and X25 sum over the links from the joint outwards",
        variants: ALL,
        place: Place::Elsewhere,
    },
];
