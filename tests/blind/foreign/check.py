"""Checks of the generator: MuJoCo must agree on the torque of rigid bodies, and the sizes must be as asked."""

import mujoco
import numpy as np

from arms import random_arm, urdf
from draw import draw
from effects import LIBRARY, OUTSIDE
from motions import random_motion
from plant import Plant, rnea
from sizing import Severity, settle


def worst_difference(arm, rng):
    """Largest difference of inverse dynamics from MuJoCo's reading of the arm's URDF, over the largest torque."""
    model = mujoco.MjModel.from_xml_string(urdf(arm, None))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data, largest, torque = mujoco.MjData(model), 0.0, 0.0
    for _ in range(20):
        data.qpos[:], data.qvel[:], data.qacc[:] = rng.uniform(-1, 1, (3, arm.dof)) * [[1], [2], [8]]
        ours = rnea(arm.model, [data.qpos.copy()], [data.qvel.copy()], [data.qacc.copy()])[0]
        mujoco.mj_inverse(model, data)
        largest = max(largest, np.abs(ours - data.qfrc_inverse).max())
        torque = max(torque, np.abs(ours).max())
    return largest / torque


def derivatives(rng):
    """Largest difference of a motion's velocity and acceleration from differences of its positions."""
    t, step = np.linspace(1, 19, 500), 1e-4
    worst = 0.0
    for kind in ("fourier", "quintic", "trapezoid"):
        motion = random_motion(rng, kind, [2.0] * 6, 20.0, bool(rng.integers(2)))
        q, v, a = motion.at(t)
        before, after = motion.path(t - step), motion.path(t + step)
        worst = max(worst, np.abs((after - before) / (2 * step) - v).max(), np.abs((after - 2 * q + before) / step**2 - a).max())
    return worst


def main():
    rng = np.random.default_rng(0)
    for kind in ("6r", "7r", "skew", "prismatic"):
        print(f"{kind}: inverse dynamics differ from MuJoCo's by {worst_difference(random_arm(rng, kind), rng):.1e}")
    print(f"motions: derivatives differ from differences by {derivatives(rng):.1e}")
    for structure in (False, True):
        arm = random_arm(rng, "6r")
        motions = [random_motion(rng, "quintic", [joint.reach for joint in arm.joints], 20.0, True) for _ in range(2)]
        bare = Plant(arm, [], 1e-3)
        logs = [bare.log(motion, 500.0, 20.0, k) for k, motion in enumerate(motions)]
        noise = 0.007 * np.sqrt(np.mean(np.concatenate([tau for *_, tau in logs]) ** 2, axis=0))
        severity = Severity(arm, noise, structure, 1e-3)
        print(f"structure {structure}: nothing hidden has severity {severity.of(logs, 1 / 500)[0].max():.1e}")
        for name in LIBRARY + OUTSIDE:
            effect = draw(rng, name, arm, 20.0)
            effect.held["peak"] = max(np.abs(tau[:, effect.joint]).max() for *_, tau in logs)
            reached, moving, evidence = settle(effect, arm, severity, motions, 500.0, 20.0, 1.0, 1e-3)
            worst = int(np.argmax(reached)) + 1
            values = {key: float(f"{value:.3g}") for key, value in effect.values().items()}
            print(f"  {name:28} on {effect.joint + 1}: {reached.max():.3f} at joint {worst}, away from reversals {moving.max():.3f}, evidence {evidence:.0f}, {values}")


if __name__ == "__main__":
    main()
