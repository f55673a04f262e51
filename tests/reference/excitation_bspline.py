"""Makes excitation_bspline.csv: position, velocity and acceleration of clamped uniform B-splines, from scipy."""

import csv
import pathlib

import numpy as np
from scipy.interpolate import BSpline

DURATION = 7.0
CONTROL = np.array([0, 0, 0, 1.0, -2.0, 0.5, 1.5, -0.7, 0, 0, 0])

with open(pathlib.Path(__file__).with_suffix(".csv"), "w", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["degree", "t", "q", "qd", "qdd"])
    for degree in range(3, 8):
        inner = np.linspace(0, DURATION, len(CONTROL) - degree + 1)
        knots = np.concatenate([np.zeros(degree), inner, np.full(degree, DURATION)])
        spline = BSpline(knots, CONTROL, degree)
        for t in (np.arange(40) + 0.5) / 40 * DURATION:
            writer.writerow([degree, *(repr(float(x)) for x in (t, spline(t), spline(t, 1), spline(t, 2)))])
