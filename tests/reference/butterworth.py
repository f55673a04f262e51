"""Writes butterworth.json: the usual way from a measured position and torque to regression rows, by scipy.

Positions through filtfilt with a Butterworth filter of fourth order at four times the cut-off of the torque, central differences;
torque through filtfilt at the cut-off, every n-th sample. And the frequency below which 99.9 % of the power of the velocity lies, by
the cosine transform less the share of the noise.

Run: python tests/reference/butterworth.py (needs numpy and scipy; written with scipy 1.17.1)
"""

import json
from pathlib import Path

import numpy as np
from scipy.fft import dct
from scipy.signal import butter, filtfilt

RATE_HZ = 250.0
SAMPLES = 500
CUTOFF_HZ = 5.0
DECIMATION = 20


def signals():
    rng = np.random.default_rng(34)
    t = np.arange(SAMPLES) / RATE_HZ
    q = 0.2 + 0.9 * np.sin(2 * np.pi * 0.8 * t + 0.2) + 0.1 * np.cos(2 * np.pi * 2.5 * t)
    tau = 3.0 * np.sin(2 * np.pi * 0.8 * t) + 2.0 * np.sign(np.cos(2 * np.pi * 0.8 * t + 0.2)) + 1.5
    return q + 1e-4 * rng.standard_normal(SAMPLES), tau + 0.2 * rng.standard_normal(SAMPLES)


def zero_phase(cutoff_hz, x):
    b, a = butter(4, cutoff_hz, fs=RATE_HZ)
    return filtfilt(b, a, x)


def motion_hz(q):
    velocity = np.gradient(q, 1.0 / RATE_HZ, edge_order=2)
    third = np.diff(q, 3)
    hann = np.sin(np.pi * (np.arange(len(third)) + 0.5) / len(third)) ** 2
    third = dct(hann * third, type=2, norm="ortho") / np.sqrt(0.375)
    bins = np.arange(int(np.ceil(0.2 * len(third))), len(third))  # above a tenth of the rate
    own = np.sort((third[bins] / (2 * np.sin(0.5 * np.pi * bins / len(third))) ** 3) ** 2)
    noise = np.sqrt(own[len(own) // 2] / 0.454936)  # the median square of a standard normal number
    power = dct(velocity, type=2, norm="ortho") ** 2
    power -= (noise * RATE_HZ * np.sin(np.pi * np.arange(len(q)) / len(q))) ** 2
    power = power[: len(q) // 5]  # up to a tenth of the rate
    reached = np.cumsum(power) >= 0.999 * power.sum()
    return np.argmax(reached) * 0.5 * RATE_HZ / len(q)


def main():
    q, tau = signals()
    smooth = zero_phase(4.0 * CUTOFF_HZ, q)
    acceleration = (smooth[2:] - 2.0 * smooth[1:-1] + smooth[:-2]) * RATE_HZ**2
    result = dict(
        rate_hz=RATE_HZ, cutoff_hz=CUTOFF_HZ, decimation=DECIMATION, q=q.tolist(), tau=tau.tolist(),
        q_filtered=smooth.tolist(), qd=np.gradient(smooth, 1.0 / RATE_HZ, edge_order=2).tolist(),
        qdd_inside=acceleration.tolist(), tau_rows=zero_phase(CUTOFF_HZ, tau)[::DECIMATION].tolist(),
        motion_hz=motion_hz(q),
    )
    path = Path(__file__).with_suffix(".json")
    path.write_text(json.dumps(result, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
