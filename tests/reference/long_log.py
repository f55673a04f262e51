"""A long log to time the reading and the identification of: `python long_log.py OUT.csv [MINUTES]`.

Seven joints at 1 kHz on sums of sines, torque by Pinocchio with friction and noise, for `skew7.urdf`.
"""

import sys
from pathlib import Path

import numpy as np
import pinocchio

RATE = 1000
model = pinocchio.buildModelFromUrdf(str(Path(__file__).parent / "skew7.urdf"))
data = model.createData()
minutes = float(sys.argv[2]) if len(sys.argv) > 2 else 30.0
rng = np.random.default_rng(7)
samples = int(minutes * 60 * RATE)
n = model.nq
phases = rng.uniform(0, 2 * np.pi, (n, 5))
rates = rng.uniform(0.4, 5.0, (n, 5))
shares = rng.dirichlet(np.ones(5), n) * 0.6

with open(sys.argv[1], "w") as out:
    names = [f"{what}{joint}" for what in ("q", "qd", "tau") for joint in range(1, n + 1)]
    out.write(",".join(["t", *names]) + "\n")
    for start in range(0, samples, 60_000):
        t = np.arange(start, min(start + 60_000, samples)) / RATE
        angle = rates[:, :, None] * t + phases[:, :, None]
        q = np.einsum("jk,jkt->tj", shares, np.sin(angle))
        v = np.einsum("jk,jkt->tj", shares * rates, np.cos(angle))
        a = np.einsum("jk,jkt->tj", -shares * rates**2, np.sin(angle))
        tau = np.array([pinocchio.rnea(model, data, q[i], v[i], a[i]) for i in range(len(t))])
        tau += 0.5 * np.sign(v) + 0.3 * v + rng.normal(0, 0.05, tau.shape)
        q += rng.normal(0, 1e-5, q.shape)
        v += rng.normal(0, 1e-3, v.shape)
        np.savetxt(out, np.column_stack([t, q, v, tau]), delimiter=",", fmt=["%.3f"] + ["%.8g"] * (3 * n))
