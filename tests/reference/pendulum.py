"""Two logs of pendulum.urdf: the motions of the examples in the documentation, with torques in closed form.

Friction of the pivot has a ripple of seven periods a turn, which the description has not. Positions and torques have noise,
and positions are quantised.

Run from the repository root: python -P tests/reference/pendulum.py
"""

import math
import random
from pathlib import Path

HERE = Path(__file__).parent / "pendulum"
RATE_HZ, LENGTH_S = 50.0, 20.0
INERTIA = 0.17 + 2.0 * 0.5**2 + 0.1  # rod and rotor about the pivot, kg m2
WEIGHT = 2.0 * 9.81 * 0.5  # N m
VISCOUS, COULOMB, RIPPLE = 0.4, 0.6, 0.8
TORQUE_NOISE, ENCODER_NOISE, ENCODER_STEP = 0.05, 2e-5, 1e-5


def log(name, seed):
    source = random.Random(seed)
    waves = [(0.1 * n, 0.8 / n**0.7, source.uniform(0.0, 2.0 * math.pi)) for n in range(1, 8)]
    lines = ["t,q_pivot,tau_pivot"]
    for row in range(round(LENGTH_S * RATE_HZ)):
        t = row / RATE_HZ
        q = qd = qdd = 0.0
        for hz, size, phase in waves:
            omega = 2.0 * math.pi * hz
            angle = omega * t + phase
            q += size * math.sin(angle)
            qd += size * omega * math.cos(angle)
            qdd -= size * omega**2 * math.sin(angle)
        tau = INERTIA * qdd + WEIGHT * math.sin(q) + VISCOUS * qd
        tau += math.copysign(COULOMB, qd) + RIPPLE * math.sin(7.0 * q)
        tau += source.gauss(0.0, TORQUE_NOISE)
        q = round((q + source.gauss(0.0, ENCODER_NOISE)) / ENCODER_STEP) * ENCODER_STEP
        lines.append(f"{t:.2f},{q:.5f},{tau:.3f}")
    (HERE / name).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    log("train.csv", 1)
    log("test.csv", 2)
