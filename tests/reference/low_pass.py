"""Writes low_pass.json: scipy's sosfiltfilt with Butterworth sections on a fixed noisy signal.

Run: python tests/reference/low_pass.py (needs numpy and scipy; written with scipy 1.17.1)
"""

import json
from pathlib import Path

import numpy as np
from scipy.signal import butter, sosfiltfilt

from savitzky_golay import noisy_signal


def main():
    x = noisy_signal()
    cases = []
    for order in [2, 3, 4, 5]:
        for cutoff_hz, rate_hz in [(12.5, 250.0), (30.0, 250.0), (250.0, 1000.0), (100.0, 250.0)]:
            sos = butter(order, cutoff_hz, fs=rate_hz, output="sos")
            cases.append(
                dict(
                    order=order, cutoff_hz=cutoff_hz, rate_hz=rate_hz, sos=sos.tolist(),
                    output=sosfiltfilt(sos, x).tolist(),
                )
            )
    path = Path(__file__).with_suffix(".json")
    path.write_text(json.dumps(dict(input=x.tolist(), filtered=cases)) + "\n")


if __name__ == "__main__":
    main()
