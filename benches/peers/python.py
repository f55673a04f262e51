"""The Python package compared with a loop over Pinocchio and with the command: wall time, medians, ratios.

    pip install ./python pin
    python benches/peers/python.py [--rounds 9] [--samples 60000]

The regressor of many states: `Robot.regressor` against a Python loop over `pin.computeJointTorqueRegressor` that fills one array, in
turns; and what it takes to fill such an array with one number, which no regressor can beat. The identification of a log of as many samples: `tauscope.identify` on arrays against the command `tauscope identify` of the same
installation on a .npz of them, whose time of starting and reading counts, in turns.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pinocchio as pin

import tauscope

ROOT = Path(__file__).resolve().parents[2]
URDF = ROOT / "urdf" / "irb1600_6_120.urdf"

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("--rounds", type=int, default=9)
arguments.add_argument("--samples", type=int, default=60_000)
arguments = arguments.parse_args()

arm = tauscope.Robot(URDF)
model = pin.buildModelFromUrdf(str(URDF))
data = model.createData()
rng = np.random.default_rng(1)
N, SAMPLES = arm.dof, arguments.samples
q, v, a = (rng.uniform(-2, 2, (SAMPLES, N)) for _ in range(3))


def loop():
    table = np.empty((SAMPLES, N, 10 * N))
    for k in range(SAMPLES):
        table[k] = pin.computeJointTorqueRegressor(model, data, q[k], v[k], a[k])
    return table


def timed(work):
    start = time.perf_counter()
    result = work()
    return 1e3 * (time.perf_counter() - start), result


def line(what, peer, own, unit="ms"):
    ratio = statistics.median(theirs / ours for theirs, ours in zip(peer, own))
    low, high = (statistics.quantiles(own, n=4)[k] for k in (0, 2)) if len(own) > 1 else (own[0], own[0])
    print(f"| {what} | {statistics.median(peer):.4g} {unit} | {statistics.median(own):.4g} {unit} ({low:.4g} to {high:.4g}) | {ratio:.2f} |")


def regressors():
    # pin, as a rule, takes the parameters of a link about its joint frame in the same order.
    assert np.allclose(loop()[:50], arm.regressor(q[:50], v[:50], a[:50]), atol=1e-8)
    peer, fresh, reused = [], [], []
    kept = arm.regressor(q, v, a)
    for _ in range(arguments.rounds):
        peer.append(timed(loop)[0])
        time_fresh, table = timed(lambda: arm.regressor(q, v, a))
        fresh.append(time_fresh)
        del table
        reused.append(timed(lambda: arm.regressor(q, v, a, out=kept))[0])
    line(f"regressor of {SAMPLES} states, new array", peer, fresh)
    line("the same, `out=`", peer, reused)
    line("the array filled with one number", peer, [timed(lambda: kept.fill(0.5))[0] for _ in range(arguments.rounds)])
    torque = [timed(lambda: arm.inverse_dynamics(q, v, a))[0] for _ in range(arguments.rounds)]

    def rnea():
        for k in range(SAMPLES):
            pin.rnea(model, data, q[k], v[k], a[k])

    line("inverse dynamics", [timed(rnea)[0] for _ in range(3)], torque[:3])


def identifications():
    t = np.arange(SAMPLES) * 1e-3
    phase, scale = rng.uniform(0, 6, (5, N)), np.array([1.0, 0.8, 0.7, 1.2, 1.0, 1.5])
    waves = [(0.2 + 0.13 * k) * 2 * np.pi for k in range(5)]
    position = sum(scale / (k + 1) * np.sin(w * t[:, None] + phase[k]) for k, w in enumerate(waves))
    speed = sum(scale / (k + 1) * w * np.cos(w * t[:, None] + phase[k]) for k, w in enumerate(waves))
    acceleration = sum(-scale / (k + 1) * w * w * np.sin(w * t[:, None] + phase[k]) for k, w in enumerate(waves))
    torque = arm.inverse_dynamics(position, speed, acceleration, drives=True)
    torque += rng.standard_normal(torque.shape) * np.array([3.0, 4.0, 2.0, 0.45, 0.35, 0.18])
    measured = position + 1e-5 * rng.standard_normal(position.shape)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "log.npz"
        np.savez(file, t=t, q=measured, tau=torque)
        words = [os.fspath(Path(sys.executable).with_name("tauscope")), "identify", "--robot", URDF, "--train", file]
        words = [*map(os.fspath, words), "--out", folder + "/out", "--quiet"]
        command, own = [], []
        for _ in range(arguments.rounds):
            command.append(timed(lambda: subprocess.run(words, check=True))[0])
            own.append(timed(lambda: tauscope.identify(arm, tauscope.Log(t=t, q=measured, tau=torque)))[0])
    line(f"identify {SAMPLES} samples, against the command", command, own)


print(f"{os.cpu_count()} processors, Python {sys.version.split()[0]}, numpy {np.__version__}, Pinocchio {pin.__version__}, {arguments.rounds} rounds\n")
print("| task | peer | tauscope, quartiles | ratio |\n|---|---|---|---|")
regressors()
identifications()
