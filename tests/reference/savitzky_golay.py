"""Writes savitzky_golay.json: scipy's savgol_filter on a fixed noisy signal, and exact results by rational arithmetic.

scipy fits by unscaled powers of the sample index, which loses digits as window and order grow: it is off by 1e-12 of the
greatest output for window 31, order 4, derivative 2, and by 2e-10 for window 51, order 5, derivative 1. Those two are
computed exactly, with scipy as a cross-check.

Run: python tests/reference/savitzky_golay.py (needs numpy and scipy; written with scipy 1.17.1)
"""

import json
from fractions import Fraction
from math import factorial
from pathlib import Path

import numpy as np
from scipy.signal import savgol_filter


def noisy_signal():
    rng = np.random.default_rng(20240517)
    t = np.arange(120) / 119.0
    clean = 1.5 * np.sin(2 * np.pi * 1.7 * t + 0.3) + 0.4 * np.cos(2 * np.pi * 9.0 * t) - 0.8 * t
    return clean + 0.1 * rng.standard_normal(t.size)


def solve(matrix, rhs):
    """Gauss-Jordan elimination in rational numbers."""
    n = len(rhs)
    rows = [list(row) + [b] for row, b in zip(matrix, rhs)]
    for i in range(n):
        pivot = next(r for r in range(i, n) if rows[r][i] != 0)
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [v / rows[i][i] for v in rows[i]]
        for r in range(n):
            if r != i and rows[r][i] != 0:
                factor = rows[r][i]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[i])]
    return [row[n] for row in rows]


def exact_weights(window, order, derivative, position):
    """Weights, per sample^derivative, at `position` samples from the centre, as rationals."""
    half = window // 2
    points = [Fraction(i) for i in range(-half, half + 1)]
    moments = [sum(x**k for x in points) for k in range(2 * order + 1)]
    matrix = [[moments[i + j] for j in range(order + 1)] for i in range(order + 1)]
    rhs = [
        Fraction(factorial(k), factorial(k - derivative)) * Fraction(position) ** (k - derivative)
        if k >= derivative
        else Fraction(0)
        for k in range(order + 1)
    ]
    c = solve(matrix, rhs)
    return [sum(ck * x**k for k, ck in enumerate(c)) for x in points]


def exact_filter(x, window, order, derivative, delta, mode):
    """savgol_filter by rational arithmetic, for the modes "interp" and "mirror"."""
    half, n = window // 2, len(x)
    rational = [Fraction(v) for v in x]
    rows = {}
    y = []
    for t in range(n):
        centre = min(max(t, half), n - 1 - half) if mode == "interp" else t
        position = t - centre
        if position not in rows:
            rows[position] = exact_weights(window, order, derivative, position)
        taken = [abs(i) if i < n else 2 * (n - 1) - i for i in range(centre - half, centre + half + 1)]
        y.append(float(sum(w * rational[i] for w, i in zip(rows[position], taken)) / Fraction(delta) ** derivative))
    return y


def main():
    x = noisy_signal()
    cases = []
    for window, order, derivative, delta in [
        (5, 2, 0, 1.0),
        (5, 2, 1, 0.01),
        (5, 4, 2, 0.01),
        (7, 3, 3, 0.5),
        (11, 3, 0, 1.0),
        (15, 4, 1, 0.004),
        (21, 2, 2, 0.004),
        (31, 3, 1, 0.002),
        (51, 3, 0, 1.0),
        (51, 2, 2, 0.002),
    ]:
        for mode in ["interp", "nearest", "mirror", "constant"]:
            cval = 0.7 if mode == "constant" else 0.0
            y = savgol_filter(x, window, order, deriv=derivative, delta=delta, mode=mode, cval=cval)
            cases.append(
                dict(
                    window=window, order=order, derivative=derivative, sample_period_s=delta,
                    edge=mode, constant=cval, output=y.tolist(),
                )
            )

    exact = []
    for window, order, derivative, delta in [(31, 4, 2, 0.002), (51, 5, 1, 0.002)]:
        for mode in ["interp", "mirror"]:
            y = exact_filter(x, window, order, derivative, delta, mode)
            scipy_y = savgol_filter(x, window, order, deriv=derivative, delta=delta, mode=mode)
            assert np.max(np.abs(scipy_y - y)) < 1e-9 * np.max(np.abs(y))
            exact.append(
                dict(
                    window=window, order=order, derivative=derivative, sample_period_s=delta,
                    edge=mode, constant=0.0, output=y,
                )
            )

    weights = []
    for window, order in [(5, 2), (9, 8), (31, 3), (31, 4), (51, 6), (101, 8), (201, 4), (201, 8), (201, 12)]:
        for derivative in [0, 1, 2]:
            for position in [-(window // 2), -(window // 4), 0]:
                weights.append(
                    dict(
                        window=window, order=order, derivative=derivative, position=position,
                        weights=[float(w) for w in exact_weights(window, order, derivative, position)],
                    )
                )

    path = Path(__file__).with_suffix(".json")
    path.write_text(json.dumps(dict(input=x.tolist(), filtered=cases, filtered_exactly=exact, exact_weights=weights)) + "\n")


if __name__ == "__main__":
    main()
