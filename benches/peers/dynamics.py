"""Regressor and inverse dynamics of the ABB IRB 1600: this crate against Pinocchio, in turns within one run.

    cargo build --release --example kernel_times
    pip install pin numpy
    python benches/peers/dynamics.py

All numbers are CPU time of one thread, medians over the rounds, in nanoseconds a sample. Pinocchio is called from Python, so
the time of a call that does nothing comparable (`pinocchio.neutral`) is taken too and shown, not subtracted.
"""

import json
import os
import platform
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pinocchio

ROOT = Path(__file__).resolve().parents[2]
ROUNDS = int(sys.argv[1]) if len(sys.argv) > 1 else 15
SAMPLES = 2000


def cpu(run):
    start = time.process_time()
    run()
    return (time.process_time() - start) * 1e9 / SAMPLES


model = pinocchio.buildModelFromUrdf(str(ROOT / "urdf" / "irb1600_6_120.urdf"))
data = model.createData()
rng = np.random.default_rng(1)
q, v, a = (rng.uniform(-2, 2, (SAMPLES, model.nq)) for _ in range(3))
states = list(zip(q, v, a))


def regressor():
    for x in states:
        pinocchio.computeJointTorqueRegressor(model, data, *x)


def inverse_dynamics():
    for x in states:
        pinocchio.rnea(model, data, *x)


def call():
    for _ in states:
        pinocchio.neutral(model)


times = {}
for _ in range(ROUNDS):
    for name, run in [("pinocchio regressor", regressor), ("pinocchio inverse dynamics", inverse_dynamics), ("call", call)]:
        times.setdefault(name, []).append(cpu(run))
    own = subprocess.run([ROOT / "target/release/examples/kernel_times"], capture_output=True, check=True, text=True)
    for name, value in json.loads(own.stdout).items():
        times.setdefault(name, []).append(value)

median = {name: statistics.median(values) for name, values in times.items()}
processor = next((l.split(":")[1].strip() for l in open("/proc/cpuinfo") if l.startswith("model name")), platform.machine())
print(f"{processor}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; Python {platform.python_version()}, ", end="")
print(f"Pinocchio {pinocchio.__version__}, numpy {np.__version__}; {ROUNDS} rounds\n")
print("| what | ns a sample | spread | against Pinocchio |\n|---|---|---|---|")
for name, value in median.items():
    peer = median.get("pinocchio " + name.split(" in ")[0])
    ratio = f"{peer / value:.1f}x" if peer and not name.startswith("pinocchio") else ""
    quartiles = statistics.quantiles(times[name], n=4)
    print(f"| {name} | {value:.0f} | {quartiles[0]:.0f} to {quartiles[2]:.0f} | {ratio} |")
