"""Effects at the size asked for: what the baseline leaves of them, over the torque noise."""

import numpy as np
import pinocchio as pin
from scipy.interpolate import make_interp_spline
from scipy.ndimage import uniform_filter1d

from plant import Plant, rnea

EVERY = 5  # samples between rows of the projection
EDGE_S = 0.5
RINGING_S = 0.02  # s over which the torque of teeth that bounce is averaged
MOVING = 0.03  # rad/s above which a sample is far from a reversal


class Severity:
    """Judges what an effect adds beyond viscous and Coulomb friction, rotor and (in structure mode) base parameters."""

    def __init__(self, arm, noise, structure, sign_width):
        self.arm, self.noise, self.structure, self.sign_width = arm, noise, structure, sign_width

    def of(self, logs, period, mean_s=0.0):
        """Per joint: over all samples, and over samples away from reversals. `logs` are noiseless (t, q, tau)."""
        rows, columns, moving = [], [], []
        for log in logs:
            left, baseline, far = self.judged(log, period, mean_s)
            rows.append(left)
            columns.append(baseline)
            moving.append(far)
        rows, columns = np.concatenate(rows), np.concatenate(columns)
        left = np.empty_like(rows)
        if self.structure:
            flat = columns.reshape(-1, columns.shape[2])
            left = rows - (columns @ solve(flat, rows.ravel()))
        else:
            for j in range(self.arm.dof):
                own = columns[:, j, 3 * j : 3 * j + 3]
                left[:, j] = rows[:, j] - own @ solve(own, rows[:, j])
        moving = np.concatenate(moving)
        rms = lambda weights: np.sqrt((left**2 * weights).sum(axis=0) / weights.sum(axis=0))
        return rms(np.ones_like(left)), rms(moving)

    def judged(self, log, period, mean_s=0.0):
        """Of one log, over the noise: torque beyond the nominal bodies, columns of the baseline; and which rows are far
        from reversals."""
        t, q, tau = log
        path, edge = make_interp_spline(t, q, k=5), int(EDGE_S / period)
        at = t[edge:-edge:EVERY]
        q, v, a = path(at), path.derivative(1)(at), path.derivative(2)(at)
        if mean_s:  # over what a ringing gear leaves of slow torque
            tau = uniform_filter1d(tau, int(mean_s / period) | 1, axis=0)
        left = (tau[edge:-edge:EVERY] - rnea(self.arm.model, q, v, a)) / self.noise
        return left, self.baseline(q, v, a) / self.noise[:, None], np.abs(v) > MOVING

    def evidence(self, logs, period, correlation_s):
        """Largest statistic that a test of the effect's true shape can expect over the logs: the noise is whitened, and
        rows near reversals do not count. Under about 30 no test over a whole library can find the effect."""
        rows, columns = [], []
        for log in logs:
            left, baseline, moving = self.judged(log, period)
            kept = np.exp(-EVERY * period / correlation_s) if correlation_s else 0.0
            new = np.sqrt((1 - kept**2) if correlation_s else 1 / EVERY)
            white = lambda signal: (signal[1:] - kept * signal[:-1]) / new
            counts = moving[1:] & moving[:-1]
            rows.append(white(left) * counts)
            columns.append(white(baseline) * counts[:, :, None])
        rows, columns = np.concatenate(rows).ravel(), np.concatenate(columns)
        if not self.structure:
            columns = self.apart(columns)
        flat = columns.reshape(-1, columns.shape[-1])
        return float(((rows - flat @ solve(flat, rows)) ** 2).sum())

    def apart(self, columns):
        """Columns of each joint's drive as columns of their own."""
        dof = self.arm.dof
        out = np.zeros((*columns.shape[:2], 3 * dof))
        for j in range(dof):
            out[:, j, 3 * j : 3 * j + 3] = columns[:, j, 3 * j : 3 * j + 3]
        return out

    def baseline(self, q, v, a):
        """Columns [time][joint][parameter]."""
        dof = self.arm.dof
        out = np.zeros((*q.shape, 3 * dof + (10 * dof if self.structure else 0)))
        for j in range(dof):
            out[:, j, 3 * j : 3 * j + 3] = np.stack([v[:, j], np.tanh(v[:, j] / self.sign_width), a[:, j]], axis=1)
        if self.structure:
            data = self.arm.model.createData()
            for k in range(q.shape[0]):
                out[k, :, 3 * dof :] = pin.computeJointTorqueRegressor(self.arm.model, data, q[k], v[k], a[k])
        return out


def solve(columns, rows):
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0] = 1
    return np.linalg.lstsq(columns / scale, rows, rcond=1e-10)[0] / scale


def settle(effect, arm, severity, motions, rate, duration, wanted, sign_width, correlation_s=0.0, tolerance=0.02):
    """Sets `effect.size` so that its worst joint has the severity wanted over the training logs; returns both
    severities and the evidence."""
    tried = []

    def measure():
        plant = Plant(arm, [effect], sign_width)
        logs = [plant.log(motion, rate, duration, index) for index, motion in enumerate(motions)]
        both = severity.of(logs, 1 / rate, RINGING_S if effect.name == "backlash" else 0.0)
        return both, logs

    for _ in range(9):
        (all_rows, moving), logs = measure()
        # The blows of teeth shake all joints; what counts of backlash is its own.
        reached = all_rows[effect.joint] if effect.name == "backlash" else all_rows.max()
        if abs(reached / wanted - 1) < tolerance:
            break
        tried.append((np.log(effect.size), np.log(max(reached, 1e-12))))
        slope = 1.0
        if len(tried) > 1 and tried[-1][0] != tried[-2][0]:
            slope = (tried[-1][1] - tried[-2][1]) / (tried[-1][0] - tried[-2][0])
            slope = float(np.clip(slope, 0.4, 3.0))
        effect.size *= float(np.exp(np.clip((np.log(wanted) - tried[-1][1]) / slope, -6, 6)))
    return all_rows, moving, severity.evidence(logs, 1 / rate, correlation_s)
