"""Reference filter outputs by scipy.signal: Savitzky-Golay smoothing and zero-phase Butterworth low-pass.

Versions: Python 3.11, scipy 1.17.1, numpy 2.4.6.
Run from the repository root: python -P tests/reference/signal.py
(-P keeps this file from hiding the standard library's module of the same name.)
Writes tests/reference/signal.json; see README.md there for the fields.
"""

import json
from pathlib import Path

import numpy as np
import scipy
from scipy import signal

HERE = Path(__file__).resolve().parent
SAMPLES = 120
RATE_HZ = 100.0

# window_length, polyorder, deriv, delta
SAVGOL = [
    (5, 2, 0, 1.0),
    (5, 2, 1, 0.01),
    (5, 4, 2, 0.01),
    (7, 3, 0, 0.01),
    (9, 4, 1, 0.01),
    (11, 3, 0, 1.0),
    (11, 3, 1, 0.004),
    (11, 3, 2, 0.004),
    (15, 5, 2, 0.01),
    (21, 2, 0, 0.01),
    (21, 4, 1, 1.0),
    (31, 3, 0, 0.01),
    (31, 5, 1, 0.01),
    (31, 6, 2, 0.01),
]
MODES = ["interp", "nearest", "mirror", "constant"]

# order, cut-off in Hz
BUTTERWORTH = [(2, 3.0), (2, 8.0), (2, 20.0), (4, 3.0), (4, 8.0), (4, 20.0), (4, 35.0)]


def noisy_signal() -> np.ndarray:
    """Two sines, a trend that leaves the ends at different heights, and noise."""
    t = np.arange(SAMPLES) / RATE_HZ
    noise = np.random.default_rng(20).normal(0.0, 0.1, SAMPLES)
    return 0.4 + 0.9 * t + np.sin(2 * np.pi * 1.3 * t) + 0.3 * np.sin(2 * np.pi * 6.0 * t + 0.5) + noise


def savgol_cases(x: np.ndarray) -> list[dict]:
    return [
        {
            "window": window,
            "polyorder": polyorder,
            "deriv": deriv,
            "delta": delta,
            "mode": mode,
            "output": signal.savgol_filter(x, window, polyorder, deriv, delta, mode=mode, cval=0.0).tolist(),
        }
        for window, polyorder, deriv, delta in SAVGOL
        for mode in MODES
    ]


def sosfiltfilt_padlen(sos: np.ndarray) -> int:
    """Samples scipy pads at each end by default (the rule in the documentation of sosfiltfilt)."""
    taps = 2 * len(sos) + 1 - min((sos[:, 2] == 0).sum(), (sos[:, 5] == 0).sum())
    return int(3 * taps)


def low_pass_cases(x: np.ndarray) -> list[dict]:
    cases = []
    for order, cutoff_hz in BUTTERWORTH:
        sos = signal.butter(order, cutoff_hz, fs=RATE_HZ, output="sos")
        b, a = signal.butter(order, cutoff_hz, fs=RATE_HZ)
        padlen = sosfiltfilt_padlen(sos)
        by_sos = signal.sosfiltfilt(sos, x)
        assert np.array_equal(by_sos, signal.sosfiltfilt(sos, x, padtype="odd", padlen=padlen))
        filtfilt_padlen = 3 * max(len(a), len(b))
        by_ba = signal.filtfilt(b, a, x)
        assert np.array_equal(by_ba, signal.filtfilt(b, a, x, padtype="odd", padlen=filtfilt_padlen))
        cases.append(
            {
                "order": order,
                "cutoff_hz": cutoff_hz,
                "padtype": "odd",
                "sos": sos.tolist(),
                "sosfilt_zi": signal.sosfilt_zi(sos).tolist(),
                "b": b.tolist(),
                "a": a.tolist(),
                "sosfiltfilt_padlen": padlen,
                "sosfiltfilt": by_sos.tolist(),
                "filtfilt_padlen": filtfilt_padlen,
                "filtfilt": by_ba.tolist(),
            }
        )
        gap = np.max(np.abs(by_ba - by_sos))
        print(f"butter order {order} at {cutoff_hz} Hz: filtfilt against sosfiltfilt {gap:.1e}")
    return cases


if __name__ == "__main__":
    x = noisy_signal()
    result = {
        "made_with": {"scipy": scipy.__version__, "numpy": np.__version__},
        "rate_hz": RATE_HZ,
        "input": x.tolist(),
        "savgol": savgol_cases(x),
        "low_pass": low_pass_cases(x),
    }
    # json prints the shortest decimal that reads back as the same double (at most 17 digits).
    (HERE / "signal.json").write_text(json.dumps(result, separators=(",", ":")) + "\n")
