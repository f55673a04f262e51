"""What MuJoCo reads from the models in mjcf/: bodies, joints, frames and dynamics, for the tests of the reader and of the writer.

Run from the repository root: python -P tests/reference/mjcf.py
"""

import json
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).parent / "mjcf"
STATES = 5


def name(model, kind, index):
    return mujoco.mj_id2name(model, kind, index)


def body(model, index):
    """Mass, centre of mass and tensor about the centre, in the axes of the body frame."""
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[index])
    turn = turn.reshape(3, 3)
    tensor = turn @ np.diag(model.body_inertia[index]) @ turn.T
    return {
        "name": name(model, mujoco.mjtObj.mjOBJ_BODY, index),
        "mass": float(model.body_mass[index]),
        "center": model.body_ipos[index].tolist(),
        "tensor": tensor.tolist(),
    }


def joint(model, index):
    dof = model.jnt_dofadr[index]
    turning = model.jnt_type[index] != mujoco.mjtJoint.mjJNT_FREE
    return {
        "name": name(model, mujoco.mjtObj.mjOBJ_JOINT, index),
        "moves": bool(turning),
        "range": model.jnt_range[index].tolist() if model.jnt_limited[index] else None,
        "damping": float(np.ravel(model.dof_damping[dof])[0]),
        "friction": float(model.dof_frictionloss[dof]),
        "armature": float(model.dof_armature[dof]),
    }


def state(model, rng):
    data = mujoco.MjData(model)
    moving = [j for j in range(model.njnt) if model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]
    place, dof = model.jnt_qposadr[moving], model.jnt_dofadr[moving]
    data.qpos[:] = model.qpos0
    data.qpos[place] = rng.uniform(-1, 1, len(moving))
    data.qvel[dof] = rng.uniform(-2, 2, len(moving))
    acceleration = rng.uniform(-5, 5, len(moving))
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    mass = mass[np.ix_(dof, dof)]
    rigid = mass - np.diag(model.dof_armature[dof])
    return {
        "q": data.qpos[place].tolist(),
        "qd": data.qvel[dof].tolist(),
        "qdd": acceleration.tolist(),
        "positions": data.xpos.tolist(),
        "rotations": [matrix.reshape(3, 3).tolist() for matrix in data.xmat],
        "mass_matrix_with_rotors": mass.tolist(),
        "tau": (rigid @ acceleration + data.qfrc_bias[dof]).tolist(),
    }


def reference(file):
    model = mujoco.MjModel.from_xml_path(str(HERE / f"{file}.xml"))
    rng = np.random.default_rng(1)
    result = {
        "mujoco": mujoco.__version__,
        "gravity": model.opt.gravity.tolist(),
        "bodies": [body(model, index) for index in range(model.nbody)],
        "joints": [joint(model, index) for index in range(model.njnt)],
        "states": [state(model, rng) for _ in range(STATES)],
    }
    (HERE / f"{file}.json").write_text(json.dumps(result, indent=1) + "\n")


def main():
    for file in ["arm", "replicate", "written"]:
        reference(file)


if __name__ == "__main__":
    main()
