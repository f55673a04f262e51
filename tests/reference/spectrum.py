"""Welch's spectrum of a short signal by scipy, for core/src/signal/spectrum.rs: python -P tests/reference/spectrum.py > tests/reference/spectrum.json"""
import json
import numpy as np
from scipy.signal import welch

rate, n = 50.0, 600
k = np.arange(n)
x = 0.7 * np.sin(2 * np.pi * 6.25 * k / rate) + 0.1 * np.cos(1.7 * k + 0.01 * k**2)
frequency, density = welch(x, rate, window="hann", nperseg=256, noverlap=128, detrend="constant")
print(json.dumps({"rate_hz": rate, "signal": x.tolist(), "frequency": frequency.tolist(), "density": np.sqrt(density).tolist()}))
