"""Random exciting motions, each a spline with four continuous derivatives."""

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.ndimage import convolve1d

KNOT = 0.01  # s between knots of the spline
REST = 0.5  # s of rest at either end of a log that begins and ends at rest
RISE = 1.5  # s in which a Fourier motion comes up from there
LEAD = 1.0  # s of motion known before the start and after the end, for delays


class Motion:
    """Positions of all joints over time, [time][joint], with derivatives."""

    def __init__(self, times, q):
        self.path = make_interp_spline(times, q, k=5)
        self.rates = [self.path] + [self.path.derivative(n) for n in (1, 2)]

    def at(self, t):
        """Position, velocity and acceleration at times t, each [time][joint]."""
        return [rate(t) for rate in self.rates]


def random_motion(rng, kind, reach, duration, at_rest):
    """A motion of the kind `fourier`, `quintic` (point to point with dwells) or `trapezoid`.

    `reach` is the largest position of every joint, rad or m; speeds come out at 0.5 to 2.5 rad/s at their largest.
    The log begins and ends at rest, or is cut out of a longer motion.
    """
    times = np.arange(-LEAD, duration + LEAD + KNOT / 2, KNOT)
    q = np.empty((times.size, len(reach)))
    if kind == "fourier":
        for k, limit in enumerate(reach):
            q[:, k] = fourier(rng, times, duration, limit)
        if at_rest:
            q *= (step((times - REST) / RISE) * step((duration - REST - times) / RISE))[:, None]
    else:
        start, end = (REST, duration - 2 * REST) if at_rest else (times[0], np.inf)
        q = point_to_point(rng, times, kind, np.asarray(reach), start, end)
        # A controller limits the jerk; short smoothing stands for it.
        q = smoothed(q, rng.uniform(0.08, 0.2))
    return Motion(times, q)


def fourier(rng, times, duration, limit):
    terms = int(rng.integers(5, 11))
    base = rng.choice([1, 2]) / duration if rng.random() < 0.5 else rng.uniform(0.05, 0.12)
    order = np.arange(1, terms + 1)
    amplitudes = rng.normal(size=(2, terms)) / order ** rng.uniform(0.3, 1.0)
    phase = 2 * np.pi * base * np.outer(times, order)
    path = np.sin(phase) @ amplitudes[0] + np.cos(phase) @ amplitudes[1]
    path -= path.mean()
    speed = np.abs(np.gradient(path, times)).max()
    size = min(0.8 * limit / np.abs(path).max(), rng.uniform(0.8, 2.5) * min(1.0, limit) / speed)
    return size * path + rng.uniform(-0.1, 0.1) * limit


def point_to_point(rng, times, kind, reach, start, end):
    """Moves of all joints that begin and end together, with dwells between most of them; at rest outside start and end."""
    joints, at = reach.size, start
    here = rng.uniform(-0.5, 0.5, joints) * reach
    q = np.tile(here, (times.size, 1))
    while at < times[-1]:
        there = rng.uniform(-0.8, 0.8, joints) * reach
        speed = rng.uniform(0.6, 2.2) * np.minimum(1.0, reach)
        peak = 1.875 if kind == "quintic" else 1.4
        time = max(0.5, peak * (np.abs(there - here) / speed).max())
        if at + time > end:
            break
        s = np.clip((times - at) / time, 0.0, 1.0)
        later = times >= at
        q[later] = (here + np.outer(step(s) if kind == "quintic" else trapezoid(s), there - here))[later]
        here, at = there, at + time + (rng.uniform(0.1, 0.8) if rng.random() < 0.7 else 0.0)
    return q


def step(s):
    """From 0 to 1 with two continuous derivatives."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10 - 15 * s + 6 * s**2)


def trapezoid(s, ramp=0.28):
    """Constant acceleration, constant speed, constant deceleration over 0 to 1."""
    v = 1 / (1 - ramp)
    up = v * s**2 / (2 * ramp)
    down = 1 - v * (1 - s) ** 2 / (2 * ramp)
    return np.where(s < ramp, up, np.where(s > 1 - ramp, down, v * (s - ramp / 2)))


def smoothed(q, time):
    n = int(round(time / KNOT)) | 1
    window = np.hanning(n + 2)[1:-1]
    window /= window.sum()
    return convolve1d(convolve1d(q, window, axis=0, mode="nearest"), window, axis=0, mode="nearest")
