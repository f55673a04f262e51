"""Reference inverse dynamics of three arms by Pinocchio and MuJoCo, for the tests of kinematics, dynamics and loading.

Versions: Python 3.11, pinocchio (package pin) 4.1.0, mujoco 4.0.0, numpy 2.4.6.
Run from the repository root: python -P tests/reference/dynamics.py
(-P keeps the signal.py beside it from hiding the standard library's module of that name.)
Writes tests/reference/{irb1600,skew7,fixed_links}_dynamics.json; see README.md there for the fields.

The torques are those of the rigid bodies alone: no friction, no rotor inertia, no limits, no contacts. The script stops
unless both libraries agree to 1e-10 relative and regressor @ parameters gives back Pinocchio's torque to 1e-10.
"""

import json
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
ARMS = [
    ("irb1600", HERE.parent.parent / "urdf" / "irb1600_6_120.urdf", "tool0"),
    ("skew7", HERE / "skew7.urdf", "link_7"),
    ("fixed_links", HERE / "fixed_links.urdf", "tcp"),
]
STATES = 20
STANDARD_GRAVITY = [0.0, 0.0, -9.81]
TILTED_GRAVITY = [[0.5, -0.3, -9.7], [9.81, 0.0, 0.0], [-2.1, 6.4, 7.0]]
PARAMETER_ORDER = ["m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"]
TOLERANCE = 1e-10


def mujoco_model(urdf: Path) -> mujoco.MjModel:
    """Compile the URDF as it stands: inertias unaltered, fixed links merged, no friction, rotors, limits or contacts."""
    compiler = (
        '<mujoco><compiler balanceinertia="false" boundmass="0" boundinertia="0" '
        'discardvisual="true" fusestatic="true" inertiafromgeom="false"/></mujoco>'
    )
    text = urdf.read_text().replace("</robot>", compiler + "</robot>")
    spec = mujoco.MjSpec.from_string(text)
    spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model = spec.compile()
    model.dof_damping[:] = 0.0
    model.dof_frictionloss[:] = 0.0
    model.dof_armature[:] = 0.0
    return model


def relative(a, b) -> float:
    """Largest difference over the largest entry."""
    return float(np.max(np.abs(a - b)) / max(1.0, np.max(np.abs(b))))


def reference(name: str, urdf: Path, tip: str, rng: np.random.Generator) -> dict:
    model = pin.buildModelFromUrdf(str(urdf))
    # rnea and crba would add rotor inertia if the URDF reader ever took it up.
    model.armature = np.zeros(model.nv)
    data = model.createData()
    frame = model.getFrameId(tip)
    other = mujoco_model(urdf)
    other_data = mujoco.MjData(other)
    joints = list(model.names)[1:]
    assert joints == [mujoco.mj_id2name(other, mujoco.mjtObj.mjOBJ_JOINT, j) for j in range(other.njnt)]

    parameters = [np.asarray(model.inertias[j].toDynamicParameters()) for j in range(1, model.njoints)]
    stacked = np.concatenate(parameters)

    states, worst_mujoco, worst_regressor = [], 0.0, 0.0
    for k in range(STATES):
        q = rng.uniform(model.lowerPositionLimit, model.upperPositionLimit)
        qd = rng.uniform(-2.0, 2.0, model.nv)
        qdd = rng.uniform(-5.0, 5.0, model.nv)
        # The first ten stand upright; the rest are tilted, as on a wall, a slope or a ceiling.
        gravity = STANDARD_GRAVITY if k < STATES // 2 else TILTED_GRAVITY[k % len(TILTED_GRAVITY)]

        model.gravity.linear = np.array(gravity)
        tau = pin.rnea(model, data, q, qd, qdd).copy()
        upper = np.triu(pin.crba(model, data, q))
        mass_matrix = upper + np.triu(upper, 1).T
        inertial = tau - pin.rnea(model, data, q, qd, np.zeros(model.nv))
        assert relative(mass_matrix @ qdd, inertial) < TOLERANCE
        gravity_torque = pin.computeGeneralizedGravity(model, data, q).copy()
        regressor = pin.computeJointTorqueRegressor(model, data, q, qd, qdd).copy()
        pin.framesForwardKinematics(model, data, q)
        pose = data.oMf[frame]

        other.opt.gravity[:] = gravity
        other_data.qpos[:], other_data.qvel[:], other_data.qacc[:] = q, qd, qdd
        mujoco.mj_inverse(other, other_data)
        tau_mujoco = other_data.qfrc_inverse.copy()

        worst_mujoco = max(worst_mujoco, relative(tau_mujoco, tau))
        worst_regressor = max(worst_regressor, relative(regressor @ stacked, tau))
        states.append(
            {
                "q": q.tolist(),
                "qd": qd.tolist(),
                "qdd": qdd.tolist(),
                "gravity": list(gravity),
                "tau": tau.tolist(),
                "tau_mujoco": tau_mujoco.tolist(),
                "mass_matrix": mass_matrix.tolist(),
                "gravity_torque": gravity_torque.tolist(),
                "regressor": regressor.tolist(),
                "tip_position": pose.translation.tolist(),
                "tip_rotation": pose.rotation.tolist(),
            }
        )

    print(f"{name}: MuJoCo against Pinocchio {worst_mujoco:.1e}, regressor against rnea {worst_regressor:.1e}")
    assert worst_mujoco < TOLERANCE
    assert worst_regressor < TOLERANCE
    return {
        "urdf": urdf.name,
        "made_with": {"pinocchio": pin.__version__, "mujoco": mujoco.__version__, "numpy": np.__version__},
        "joints": joints,
        "tip": tip,
        "parameter_order": PARAMETER_ORDER,
        "parameters": [p.tolist() for p in parameters],
        "states": states,
    }


def check_flange_at_zero(urdf: Path) -> None:
    """The flange of the 1.2 m arm at q = 0 stands at the sums of the published link lengths and points forward."""
    model = pin.buildModelFromUrdf(str(urdf))
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.zeros(model.nq))
    flange = data.oMf[model.getFrameId("tool0")]
    assert np.allclose(flange.translation, [0.15 + 0.3 + 0.3 + 0.065, 0.0, 0.4865 + 0.475], rtol=0, atol=1e-14)
    assert np.allclose(flange.rotation @ [0, 0, 1], [1, 0, 0], rtol=0, atol=1e-14)


def check_inertias(urdf: Path) -> None:
    """Every link is possible: positive mass, principal moments within the triangle inequality with 2 % to spare."""
    model = pin.buildModelFromUrdf(str(urdf))
    for inertia in list(model.inertias)[1:]:
        low, mid, high = np.linalg.eigvalsh(inertia.inertia)
        assert inertia.mass > 0 and low > 0 and low + mid > 1.02 * high


if __name__ == "__main__":
    for seed, (name, urdf, tip) in enumerate(ARMS):
        check_inertias(urdf)
        if name == "irb1600":
            check_flange_at_zero(urdf)
        result = reference(name, urdf, tip, np.random.default_rng(1600 + seed))
        # json prints the shortest decimal that reads back as the same double (at most 17 digits).
        (HERE / f"{name}_dynamics.json").write_text(json.dumps(result, separators=(",", ":")) + "\n")
