"""Encoders and torque sensors: white or correlated noise, quantisation, and the CSV files."""

import numpy as np
from scipy.signal import lfilter

NOISES = {"white": 0.0, "ar130": 0.13, "ar500": 0.5}


def torque_noise(rng, samples, rms, period, correlation_s):
    """Noise [time][joint] of that rms, white or first-order autoregressive, stationary from the start."""
    white = rng.normal(size=(samples, len(rms)))
    if correlation_s > 0:
        kept = np.exp(-period / correlation_s)
        white[0] /= np.sqrt(1 - kept**2)
        white = np.sqrt(1 - kept**2) * lfilter([1.0], [1.0, -kept], white, axis=0)
    return white * rms


def read_encoder(rng, q, encoder):
    """`encoder`: rms of white noise in `white` and, where there is one, the step in `step`."""
    q = q + rng.normal(0.0, encoder["white"], q.shape)
    return encoder["step"] * np.round(q / encoder["step"]) if encoder["step"] else q


def random_encoder(rng, quantised):
    if not quantised:
        return {"white": 1.5e-5, "step": 0.0}
    return {"white": 0.0, "step": 2 * np.pi / 2 ** int(rng.integers(17, 21))}


def write_log(path, t, q, tau):
    joints = range(1, q.shape[1] + 1)
    header = ",".join(["t", *(f"q{j}" for j in joints), *(f"tau{j}" for j in joints)])
    np.savetxt(path, np.column_stack([t, q, tau]), fmt="%.10g", delimiter=",", header=header, comments="")
