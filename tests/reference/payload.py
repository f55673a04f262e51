"""Logs of payload/arm.urdf before and after a load is put on its flange, with torques by MuJoCo.

The drives have Coulomb and viscous friction and a ripple over the position that no model of the project has. Positions and
torques have noise, and positions are quantised. payload/truth.json holds the load.

Run from the repository root: python -P tests/reference/payload.py
"""

import json
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).parent / "payload"
RATE_HZ, LENGTH_S = 50.0, 16.0
SEED = 20260611
JOINTS = ["j1", "j2", "j3", "j4", "j5"]
MASS = 1.5
CENTER = np.array([0.03, -0.02, 0.09])
# About the centre of mass, in the axes of the flange.
TENSOR = np.array([[0.022, 0.002, -0.001], [0.002, 0.026, 0.0015], [-0.001, 0.0015, 0.014]])
COULOMB = np.array([2.0, 2.5, 1.5, 0.6, 0.5])
VISCOUS = np.array([1.5, 2.0, 1.2, 0.4, 0.3])
RIPPLE = np.array([0.5, 0.8, 0.5, 0.2, 0.15])
NOISE = np.array([0.10, 0.12, 0.08, 0.03, 0.03])


def arm(loaded):
    text = (HERE / "arm.urdf").read_text()
    if loaded:
        xx, xy, xz, yy, yz, zz = TENSOR[np.triu_indices(3)]
        body = (
            f'<link name="flange"><inertial><origin xyz="{" ".join(map(str, CENTER))}"/><mass value="{MASS}"/>'
            f'<inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" izz="{zz}"/></inertial></link>'
        )
        assert '<link name="flange"/>' in text
        text = text.replace('<link name="flange"/>', body)
    return mujoco.MjModel.from_xml_string(text)


def motion(which, start_s):
    """A sum of sines with its derivatives; `start_s` is where on the motion the log begins."""
    source = np.random.default_rng([SEED, which])
    t = np.arange(0, LENGTH_S, 1 / RATE_HZ) + start_s
    q, qd, qdd = (np.zeros((len(t), len(JOINTS))) for _ in range(3))
    q += np.array([0.1, -0.7, 0.8, 0.3, 0.5])
    for harmonic in range(1, 8):
        omega = 2 * np.pi * harmonic / 10.0
        size = np.array([0.5, 0.35, 0.4, 0.6, 0.5]) / harmonic ** 0.7
        phase = source.uniform(0, 2 * np.pi, len(JOINTS))
        angle = omega * t[:, None] + phase
        q += size * np.sin(angle)
        qd += size * omega * np.cos(angle)
        qdd -= size * omega**2 * np.sin(angle)
    return t - start_s, q, qd, qdd


def log(name, which, start_s, loaded, sag=0.0):
    """`sag` is what the position loop gives way under the load, rad per rad of the motion's reach."""
    t, q, qd, qdd = motion(which, start_s)
    q, qd, qdd = q + sag * np.cos(q), qd - sag * np.sin(q) * qd, qdd - sag * (np.cos(q) * qd**2 + np.sin(q) * qdd)
    model = arm(loaded)
    data = mujoco.MjData(model)
    tau = np.zeros_like(q)
    for row in range(len(t)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[row], qd[row], qdd[row]
        mujoco.mj_inverse(model, data)
        tau[row] = data.qfrc_inverse
    tau += COULOMB * np.sign(qd) + VISCOUS * qd + RIPPLE * np.sin(7 * q)
    source = np.random.default_rng([SEED, 100 + sum(map(ord, name))])
    tau += NOISE * source.standard_normal(tau.shape)
    q = np.round((q + 5e-5 * source.standard_normal(q.shape)) / 1e-4) * 1e-4
    header = ["t"] + [f"q_{joint}" for joint in JOINTS] + [f"tau_{joint}" for joint in JOINTS]
    lines = [",".join(header)]
    for row in range(len(t)):
        values = [f"{t[row]:.2f}"] + [f"{x:.4f}" for x in q[row]] + [f"{x:.3f}" for x in tau[row]]
        lines.append(",".join(values))
    (HERE / name).write_text("\n".join(lines) + "\n")


def main():
    log("before.csv", 1, 0.0, loaded=False)
    log("after.csv", 1, 0.7, loaded=True, sag=0.003)
    log("elsewhere.csv", 2, 0.0, loaded=True)
    log("nothing.csv", 1, 0.3, loaded=False)
    truth = {"mass_kg": MASS, "center_m": CENTER.tolist(), "inertia_kg_m2": TENSOR.tolist()}
    (HERE / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main()
