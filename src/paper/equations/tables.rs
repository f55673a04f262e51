//! The tables of the paper: names and units of the parameters, and the printed numbers.

/// One of X1..X78.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Parameter {
    /// Name in print, "X1" to "X78".
    pub symbol: &'static str,
    /// What it is, after Table A1 and the place in (4)-(9). "share of m6 in ..." is m6 times a sum of products of lengths.
    pub meaning: &'static str,
    /// Unit that makes the equations give torques in N m.
    pub unit: &'static str,
    /// Unit in Tables A1 and 2.
    pub printed_unit: &'static str,
}

/// X1..X78 of Table A1.
pub(crate) const PARAMETERS: [Parameter; 78] = [
    inertia("X1", "2 (Iz1 + Iz2 + Iz3 + Iz4 + Iz5 + Iz6)"),
    inertia("X2", "share of m6 in the inertia of joint 1"),
    inertia("X3", "share of m5 in the inertia of joint 1"),
    inertia("X4", "share of m4 in the inertia of joint 1"),
    inertia("X5", "share of m3 in the inertia of joint 1"),
    inertia("X6", "share of m2 in the inertia of joint 1"),
    inertia("X7", "2 (Iz2 + Iz3 + Iz4 + Iz5 + Iz6)"),
    inertia("X8", "share of m6 in the coupling of joints 1 and 2"),
    inertia("X9", "share of m5 in the coupling of joints 1 and 2"),
    inertia("X10", "share of m4 in the coupling of joints 1 and 2"),
    inertia("X11", "share of m3 in the coupling of joints 1 and 2"),
    inertia("X12", "share of m2 in the coupling of joints 1 and 2"),
    inertia("X13", "2 (Iz3 + Iz4 + Iz5 + Iz6)"),
    inertia("X14", "share of m6 in the coupling of joints 1 and 3"),
    inertia("X15", "share of m5 in the coupling of joints 1 and 3"),
    inertia("X16", "share of m4 in the coupling of joints 1 and 3"),
    inertia("X17", "share of m3 in the coupling of joints 1 and 3"),
    inertia("X18", "2 (Iz4 + Iz5 + Iz6)"),
    inertia("X19", "share of m6 in the coupling of joints 1 and 4"),
    inertia("X20", "share of m5 in the coupling of joints 1 and 4"),
    inertia("X21", "share of m4 in the coupling of joints 1 and 4"),
    inertia("X22", "2 (Iz5 + Iz6)"),
    inertia("X23", "share of m6 in the coupling of joints 1 and 5"),
    inertia("X24", "share of m5 in the coupling of joints 1 and 5"),
    inertia("X25", "2 Iz6"),
    inertia("X26", "share of m6 in the coupling of joints 1 and 6"),
    gravity("X27", "gravity moment about joint 1"),
    coulomb("X28", "Coulomb friction f1s of joint 1"),
    viscous("X29", "viscous friction f1v of joint 1"),
    inertia("X30", "share of m6 in the inertia of joint 2"),
    inertia("X31", "share of m5 in the inertia of joint 2"),
    inertia("X32", "share of m4 in the inertia of joint 2"),
    inertia("X33", "share of m3 in the inertia of joint 2"),
    inertia("X34", "share of m2 in the inertia of joint 2"),
    inertia("X35", "share of m6 in the coupling of joints 2 and 3"),
    inertia("X36", "share of m5 in the coupling of joints 2 and 3"),
    inertia("X37", "share of m4 in the coupling of joints 2 and 3"),
    inertia("X38", "share of m3 in the coupling of joints 2 and 3"),
    inertia("X39", "share of m6 in the coupling of joints 2 and 4"),
    inertia("X40", "share of m5 in the coupling of joints 2 and 4"),
    inertia("X41", "share of m4 in the coupling of joints 2 and 4"),
    inertia("X42", "share of m6 in the coupling of joints 2 and 5"),
    inertia("X43", "share of m5 in the coupling of joints 2 and 5"),
    inertia("X44", "share of m6 in the coupling of joints 2 and 6"),
    gravity("X45", "gravity moment about joint 2"),
    coulomb("X46", "Coulomb friction f2s of joint 2"),
    viscous("X47", "viscous friction f2v of joint 2"),
    inertia("X48", "share of m6 in the inertia of joint 3"),
    inertia("X49", "share of m5 in the inertia of joint 3"),
    inertia("X50", "share of m4 in the inertia of joint 3"),
    inertia("X51", "share of m3 in the inertia of joint 3"),
    inertia("X52", "share of m6 in the coupling of joints 3 and 4"),
    inertia("X53", "share of m5 in the coupling of joints 3 and 4"),
    inertia("X54", "share of m4 in the coupling of joints 3 and 4"),
    inertia("X55", "share of m6 in the coupling of joints 3 and 5"),
    inertia("X56", "share of m5 in the coupling of joints 3 and 5"),
    inertia("X57", "share of m6 in the coupling of joints 3 and 6"),
    gravity("X58", "gravity moment about joint 3"),
    coulomb("X59", "Coulomb friction f3s of joint 3"),
    viscous("X60", "viscous friction f3v of joint 3"),
    inertia("X61", "share of m6 in the inertia of joint 4"),
    inertia("X62", "share of m5 in the inertia of joint 4"),
    inertia("X63", "share of m4 in the inertia of joint 4"),
    inertia("X64", "share of m6 in the coupling of joints 4 and 5"),
    inertia("X65", "share of m5 in the coupling of joints 4 and 5"),
    inertia("X66", "share of m6 in the coupling of joints 4 and 6"),
    gravity("X67", "gravity moment about joint 4"),
    coulomb("X68", "Coulomb friction f4s of joint 4"),
    viscous("X69", "viscous friction f4v of joint 4"),
    inertia("X70", "share of m5 and m6 in the inertia of joint 5"),
    inertia("X71", "share of m6 in the coupling of joints 5 and 6"),
    gravity("X72", "gravity moment about joint 5"),
    coulomb("X73", "Coulomb friction f5s of joint 5"),
    viscous("X74", "viscous friction f5v of joint 5"),
    inertia("X75", "share of m6 in the inertia of joint 6"),
    gravity("X76", "gravity moment about joint 6"),
    coulomb("X77", "Coulomb friction f6s of joint 6"),
    viscous("X78", "viscous friction f6v of joint 6"),
];

const fn inertia(symbol: &'static str, meaning: &'static str) -> Parameter {
    Parameter { symbol, meaning, unit: "kg m^2", printed_unit: "kg m^2" }
}

const fn gravity(symbol: &'static str, meaning: &'static str) -> Parameter {
    Parameter { symbol, meaning, unit: "kg m", printed_unit: "kg m^2" }
}

const fn coulomb(symbol: &'static str, meaning: &'static str) -> Parameter {
    Parameter { symbol, meaning, unit: "N m", printed_unit: "kg/s" }
}

const fn viscous(symbol: &'static str, meaning: &'static str) -> Parameter {
    Parameter { symbol, meaning, unit: "N m s/rad", printed_unit: "kg/s" }
}

/// Values of X1..X78 in Table 2. None where the available text of the paper has lost the value: each row goes from the
/// unit of X29..X42 straight to the name of X43..X56, whose values have the sizes of their kind (gravity X45 like X27,
/// viscous friction X47 like X60), so it is these fourteen that are missing and not others.
pub(crate) const PRINTED_TABLE_2: [Option<f64>; 78] = [
    Some(10.90),
    Some(-0.73),
    Some(-0.73),
    Some(-5.93),
    Some(-1.43),
    Some(9.11),
    Some(1.56),
    Some(0.39),
    Some(0.40),
    Some(0.29),
    Some(0.04),
    Some(-1.12),
    Some(-5.84),
    Some(-0.34),
    Some(-0.35),
    Some(-0.034),
    Some(0.72),
    Some(-1.59),
    Some(-0.001),
    Some(0.0026),
    Some(-0.002),
    Some(-0.46),
    Some(-0.002),
    Some(0.0018),
    Some(0.052),
    Some(-9.5e-11),
    Some(0.00013),
    Some(0.001),
    None,
    None,
    None,
    None,
    None,
    None,
    None,
    None,
    None,
    None,
    None,
    None,
    None,
    None,
    Some(0.013),
    Some(-1.95e-9),
    Some(-8.9e-5),
    Some(-0.004),
    Some(9.3e-5),
    Some(-0.23),
    Some(-0.137),
    Some(0.10),
    Some(-0.34),
    Some(1.50),
    Some(-0.01),
    Some(0.018),
    Some(-0.01),
    Some(-0.013),
    Some(-6.45e-9),
    Some(5.86e-8),
    Some(0.007),
    Some(-0.0001),
    Some(1.87),
    Some(1.87),
    Some(1.9),
    Some(-1.2e-7),
    Some(2e-7),
    Some(9.3e-10),
    Some(2.8e-5),
    Some(-0.0022),
    Some(3.17e-5),
    Some(1.72),
    Some(7.7e-10),
    Some(2.5e-5),
    Some(-0.001),
    Some(2.09e-5),
    Some(0.033),
    Some(-8.31e-6),
    Some(-0.0006),
    Some(4.21e-6),
];

/// Table 3: standard deviation of the torque of joints 1..6, identified by nonlinear least squares alone and after
/// Savitzky-Golay filters. The paper prints no unit.
pub(crate) const PRINTED_TABLE_3: [[f64; 2]; 6] =
    [[0.00142, 0.0013], [0.0017, 0.0016], [0.0035, 0.0033], [0.0011, 0.0010], [0.00051, 0.00047], [0.00036, 0.00029]];

/// A row of Denavit-Hartenberg parameters (classic convention): turn about z by theta, shift along z by d, shift along
/// the new x by a, turn about it by alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DenavitHartenberg {
    /// Label of the row.
    pub linkage: usize,
    /// Twist alpha in degrees.
    pub alpha_deg: f64,
    /// Length a in mm.
    pub a_mm: f64,
    /// Offset d in mm.
    pub d_mm: f64,
    /// Joint whose angle is theta.
    pub joint: usize,
    /// Angle added to that of the joint in degrees.
    pub offset_deg: f64,
}

const fn dh(linkage: usize, alpha_deg: f64, a_mm: f64, d_mm: f64, joint: usize, offset_deg: f64) -> DenavitHartenberg {
    DenavitHartenberg { linkage, alpha_deg, a_mm, d_mm, joint, offset_deg }
}

/// Table 1 as printed: joint 1 twice, no row of joint 3, and no wrist offset.
pub(crate) const PRINTED_TABLE_1: [DenavitHartenberg; 6] = [
    dh(1, -90.0, 150.0, 486.5, 1, 0.0),
    dh(2, -90.0, 150.0, 486.5, 1, 0.0),
    dh(3, 0.0, 475.0, 0.0, 2, 0.0),
    dh(4, -90.0, 0.0, 0.0, 4, 0.0),
    dh(5, 90.0, 0.0, 0.0, 5, 0.0),
    dh(6, 0.0, 0.0, 65.0, 6, 0.0),
];

/// Table 1 corrected for the arm of 1.2 m reach. With all joints at zero the upper arm stands up and the forearm points
/// ahead; that is the offset of joint 2.
pub(crate) const CORRECTED_TABLE_1: [DenavitHartenberg; 6] = [
    dh(1, -90.0, 150.0, 486.5, 1, 0.0),
    dh(2, 0.0, 475.0, 0.0, 2, -90.0),
    dh(3, -90.0, 0.0, 0.0, 3, 0.0),
    dh(4, 90.0, 0.0, 600.0, 4, 0.0),
    dh(5, -90.0, 0.0, 0.0, 5, 0.0),
    dh(6, 0.0, 0.0, 65.0, 6, 0.0),
];

/// The angles theta of [`CORRECTED_TABLE_1`] for joint positions `q` (rad) that are zero with the upper arm upright and
/// the forearm ahead, as the URDF has them. Axes and directions are the same; joint 2 differs by a quarter turn, which
/// makes cos(theta2) the lever of gravity on the upper arm.
pub(crate) fn joint_angles(q: [f64; 6]) -> [f64; 6] {
    std::array::from_fn(|joint| q[joint] + CORRECTED_TABLE_1[joint].offset_deg.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

    fn flange(table: &[DenavitHartenberg; 6]) -> Isometry3<f64> {
        table.iter().fold(Isometry3::identity(), |frame, row| {
            let about_z = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), row.offset_deg.to_radians());
            let about_x = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), row.alpha_deg.to_radians());
            frame * about_z * Translation3::new(row.a_mm, 0.0, row.d_mm) * about_x
        })
    }

    #[test]
    fn the_corrected_table_puts_the_flange_where_the_drawing_does() {
        let flange = flange(&CORRECTED_TABLE_1);
        let expected = Vector3::new(150.0 + 600.0 + 65.0, 0.0, 486.5 + 475.0);
        assert!((flange.translation.vector - expected).norm() < 1e-9, "{flange}");
        assert!((flange * Vector3::z() - Vector3::x()).norm() < 1e-12, "{flange}");
    }

    #[test]
    fn the_printed_table_lacks_joint_3_and_600_mm() {
        assert!(PRINTED_TABLE_1.iter().all(|row| row.joint != 3 && row.d_mm != 600.0));
        assert_eq!(PRINTED_TABLE_1[0], DenavitHartenberg { linkage: 1, ..PRINTED_TABLE_1[1] });
    }

    #[test]
    fn the_lost_values_of_table_2_are_x29_to_x42() {
        for (k, value) in (1..).zip(PRINTED_TABLE_2) {
            assert_eq!(value.is_none(), (29..=42).contains(&k), "X{k}");
        }
        assert_eq!(PRINTED_TABLE_2[0], Some(10.90));
        assert_eq!(PRINTED_TABLE_2[42], Some(0.013));
        assert_eq!(PRINTED_TABLE_2[77], Some(4.21e-6));
    }

    #[test]
    fn symbols_are_in_order_and_units_follow_the_kind() {
        for (k, parameter) in (1..).zip(PARAMETERS) {
            assert_eq!(parameter.symbol, format!("X{k}"));
        }
        let count = |unit| PARAMETERS.iter().filter(|p| p.unit == unit).count();
        assert_eq!([count("kg m^2"), count("kg m"), count("N m"), count("N m s/rad")], [60, 6, 6, 6]);
    }
}
