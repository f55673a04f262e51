//! An arm with the dynamics of its rigid bodies.

use crate::arrays::{array, signals};
use crate::dynamics;
use crate::error::{raised, wrong};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::PathBuf;
use tauscope::dynamics::{Chain, Motion};
use tauscope::identification::model::Model;
use tauscope::robot::{self, Choice, InertiaCheck, LARGEST, Robot, description};

/// A robot arm: its joints under study, its bodies, and their dynamics on arrays of states.
#[pyclass(frozen, module = "tauscope._tauscope")]
pub(crate) struct Arm {
    robot: Robot,
    chain: Chain,
    inertial: Vec<f64>,
}

type Array<'py> = PyReadonlyArray2<'py, f64>;

/// Names of standard parameters, sums of them in words, and the matrix that makes the sums.
type Sums<'py> = (Vec<String>, Vec<String>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl Arm {
    #[new]
    #[pyo3(signature = (path, joints=None, tip=None, hold=None, gravity=None))]
    fn new(
        path: PathBuf,
        joints: Option<Vec<String>>,
        tip: Option<String>,
        hold: Option<BTreeMap<String, f64>>,
        gravity: Option<[f64; 3]>,
    ) -> PyResult<Self> {
        let file = description::read(&path).map_err(|error| raised(&error))?;
        let hold = hold.unwrap_or_default();
        if let Some(unknown) = hold.keys().find(|name| !file.moving().iter().any(|joint| joint.name == **name)) {
            let names: Vec<&str> = file.moving().iter().map(|joint| joint.name.as_str()).collect();
            let problem = format!("`{unknown}` is no joint that turns or slides; there are {}", names.join(", "));
            return Err(wrong("hold", problem));
        }
        if let Some((name, _)) = hold.iter().find(|(_, position)| !position.is_finite()) {
            return Err(wrong("hold", format!("the position of `{name}` is not a finite number")));
        }
        let choice = Choice { joints, tip, hold };
        let mut robot = file.robot(&choice, InertiaCheck::Ignored).map_err(|error| raised(&error))?;
        if let Some(gravity) = gravity {
            if !gravity.iter().all(|value| value.abs() <= LARGEST) {
                return Err(wrong("gravity", "give three numbers in m/s2, in the base frame"));
            }
            robot.gravity = gravity.into();
        }
        Ok(Arm { chain: Chain::new(&robot), inertial: robot.inertial_parameters(), robot })
    }

    /// Name of the robot.
    #[getter]
    fn name(&self) -> &str {
        &self.robot.name
    }

    /// Number of coordinates.
    #[getter]
    fn dof(&self) -> usize {
        self.robot.dof()
    }

    /// Number of moving bodies: one per coordinate, and one per joint that follows a coordinate.
    #[getter]
    fn bodies(&self) -> usize {
        self.robot.bodies()
    }

    /// Joint names from base to flange.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.robot.joint_names()
    }

    /// Gravity in the base frame, m/s2.
    #[getter]
    fn gravity(&self) -> [f64; 3] {
        self.robot.gravity.into()
    }

    /// What was read otherwise than it is written, and which joints are held.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.robot.notes.clone()
    }

    /// Moving joints of the file that stand still here, with their positions.
    #[getter]
    fn held<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let held = PyDict::new(py);
        self.robot.held.iter().try_for_each(|(name, position)| held.set_item(name, position))?;
        Ok(held)
    }

    /// Limits of the joints: arrays `lower`, `upper`, `velocity`, `effort`.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let limits = || self.robot.joints.iter().map(|joint| joint.limits);
        let columns: [(&str, Vec<f64>); 4] = [
            ("lower", limits().map(|own| own.lower).collect()),
            ("upper", limits().map(|own| own.upper).collect()),
            ("velocity", limits().map(|own| own.velocity).collect()),
            ("effort", limits().map(|own| own.effort).collect()),
        ];
        named(py, columns)
    }

    /// Friction and rotors of the drives: arrays `viscous`, `coulomb`, `armature`.
    #[getter]
    fn drives<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let drives = || self.robot.joints.iter().map(|joint| joint.drive);
        let columns: [(&str, Vec<f64>); 3] = [
            ("viscous", drives().map(|own| own.viscous).collect()),
            ("coulomb", drives().map(|own| own.coulomb).collect()),
            ("armature", drives().map(|own| own.armature).collect()),
        ];
        named(py, columns)
    }

    /// Ten parameters per body: m, mx, my, mz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the joint frame.
    #[getter]
    fn inertial_parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inertial)
    }

    /// The robot under study as a URDF, held joints fixed.
    fn to_urdf(&self) -> String {
        robot::to_urdf(&self.robot)
    }

    /// The same as a MuJoCo model.
    fn to_mjcf(&self) -> String {
        robot::to_mjcf(&self.robot)
    }

    /// Joint torques, joints x samples.
    #[pyo3(signature = (q, qd, qdd, inertial=None, drives=false))]
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: Array<'py>,
        qd: Array<'py>,
        qdd: Array<'py>,
        inertial: Option<PyReadonlyArray1<'py, f64>>,
        drives: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = self.motion(&q, &qd, &qdd)?;
        let given = inertial.map(|given| given.as_array().to_vec());
        let inertial = given.as_ref().unwrap_or(&self.inertial);
        if inertial.len() != self.inertial.len() {
            let problem = format!("has {} numbers; ten per body are wanted, {}", inertial.len(), self.inertial.len());
            return Err(wrong("inertial_parameters", problem));
        }
        let torque = py.detach(|| dynamics::torques(&self.robot, &self.chain, inertial, &motion, drives));
        array(py, torque)
    }

    /// Numbers that [`Arm::regressor`] writes for so many samples.
    fn regressor_size(&self, samples: usize) -> PyResult<usize> {
        dynamics::size(&self.chain, samples)
    }

    /// Writes the regressor, parameters x joints x samples, into an array of zeros.
    fn regressor(
        &self,
        py: Python<'_>,
        q: Array<'_>,
        qd: Array<'_>,
        qdd: Array<'_>,
        mut out: PyReadwriteArray1<'_, f64>,
    ) -> PyResult<()> {
        let motion = self.motion(&q, &qd, &qdd)?;
        let table = out.as_slice_mut().map_err(|_| wrong("out", "must be contiguous"))?;
        if table.len() != dynamics::size(&self.chain, motion.samples())? {
            return Err(wrong("out", format!("has {} numbers, which is another size", table.len())));
        }
        py.detach(|| dynamics::regressor(&self.chain, &motion, table));
        Ok(())
    }

    /// The base parameters of the arm with its drives: names of the standard parameters, sums in words, and the matrix that makes the
    /// sums.
    fn base_parameters<'py>(&self, py: Python<'py>) -> PyResult<Sums<'py>> {
        let model = py.detach(|| Model::new(&self.robot));
        let base = model.base();
        let sums = base.groupings().iter().map(|sum| sum.name.clone()).collect();
        let shares = base.regrouping();
        let rows: Vec<f64> = shares.transpose().as_slice().to_vec();
        let matrix = PyArray1::from_vec(py, rows).reshape([shares.nrows(), shares.ncols()])?;
        Ok((model.names().to_vec(), sums, matrix))
    }
}

impl Arm {
    fn motion(&self, q: &Array<'_>, qd: &Array<'_>, qdd: &Array<'_>) -> PyResult<Motion> {
        let joints = self.robot.dof();
        let motion =
            Motion { q: signals("q", q, joints)?, qd: signals("qd", qd, joints)?, qdd: signals("qdd", qdd, joints)? };
        for (name, own) in [("qd", &motion.qd), ("qdd", &motion.qdd)] {
            if own.samples() != motion.samples() {
                let problem = format!("has {} samples; q has {}", own.samples(), motion.samples());
                return Err(wrong(name, problem));
            }
        }
        Ok(motion)
    }
}

fn named<'py, const N: usize>(py: Python<'py>, columns: [(&str, Vec<f64>); N]) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    for (name, values) in columns {
        table.set_item(name, PyArray1::from_vec(py, values))?;
    }
    Ok(table)
}

/// Refuses a text that is no robot; errors name `robot`.
#[pyfunction]
pub(crate) fn check_text(text: &str) -> PyResult<()> {
    description::parse(text, "robot").map(drop).map_err(|error| raised(&error))
}
