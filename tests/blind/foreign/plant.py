"""The open-loop arm: joints follow a motion exactly, and the torque that this takes is logged."""

import numpy as np
import pinocchio as pin
from scipy.interpolate import make_interp_spline

from effects import ALTER, POSITION_SENSOR, TORQUE, TORQUE_SENSOR, State, contact, coupling

SETTLE = 0.5  # s at either end that sizing leaves out
DENSE_HZ = 2000.0
NEEDS_DENSE = {"joint_elasticity", "backlash", "presliding_hysteresis", "torque_lag", "outside_hydraulic"}


def rnea(model, q, v, a):
    """Torque of the rigid bodies, [time][joint]."""
    data = model.createData()
    return np.array([pin.rnea(model, data, *row) for row in zip(q, v, a)])


def smooth_sign(width):
    return lambda v: np.tanh(v / width)


class Plant:
    """An arm with effects; noiseless logs of it."""

    def __init__(self, arm, effects, sign_width):
        self.arm, self.effects, self.sign = arm, effects, smooth_sign(sign_width)
        self.model = pin.Model(arm.model)
        for effect in effects:
            if effect.name in ALTER:
                ALTER[effect.name](self.model, arm.flange, effect.values(), effect.joint)

    def acting(self, log):
        return [effect for effect in self.effects if not effect.logs or log in effect.logs]

    def log(self, motion, rate, duration, index):
        """Times, logged position and logged torque without noise."""
        acting = self.acting(index)
        finer = int(np.ceil(DENSE_HZ / rate)) if any(e.name in NEEDS_DENSE for e in acting) else 1
        t = np.arange(int(round(duration * rate)) * finer) / (rate * finer)
        delay = sum(e.values()["delay"] for e in acting if e.name == "time_delay")
        motor, tau = self.torque(motion, t - delay, acting)
        q = motor.q if delay == 0.0 else self.torque(motion, t, acting)[0].q
        q = q.copy()
        for effect in acting:
            if effect.name in TORQUE_SENSOR:
                values = effect.values()
                if effect.name == "torque_saturation":
                    values["level"] = (1 - min(values["clipped"], 0.9)) * effect.held["peak"]
                TORQUE_SENSOR[effect.name](values, t, tau, effect.joint)
            if effect.name in POSITION_SENSOR:
                q[:, effect.joint] = POSITION_SENSOR[effect.name](effect.values(), q[:, effect.joint])
        return t[::finer], q[::finer], tau[::finer]

    def torque(self, motion, t, acting):
        q, v, a = motion.at(t)
        link = State(t, q, v, a, rnea(self.model, q, v, a), self.sign)
        motor = State(t, q.copy(), v.copy(), a.copy(), link.load, self.sign)
        for effect in acting:
            if effect.name == "joint_elasticity":
                wind_up(effect, motor)
            if effect.name == "backlash":
                link = rattle(self.model, effect, motor)
                motor.load = link.load
        tau = motor.load.copy()
        for drive, column in (("viscous", motor.v), ("coulomb", self.sign(motor.v)), ("armature", motor.a)):
            tau += self.arm.drive(drive) * column
        for effect in acting:
            if effect.name in TORQUE:
                j = effect.joint
                own = (motor.t, motor.q[:, j], motor.v[:, j], motor.a[:, j], motor.load[:, j])
                tau[:, j] += TORQUE[effect.name](effect.values(), *own, self.sign)
            if effect.name == "joint_coupling":
                coupling(effect.values(), motor, effect.joint, tau)
            if effect.name == "external_contact":
                contact(effect.values(), motor, self.model, self.arm.flange, tau)
        return motor, tau


def wind_up(effect, motor):
    """The link follows the motion; the motor runs ahead by compliance times load."""
    j = effect.joint
    twist = make_interp_spline(motor.t, effect.values()["compliance"] * motor.load[:, j], k=5)
    motor.q[:, j] += twist(motor.t)
    motor.v[:, j] += twist.derivative(1)(motor.t)
    motor.a[:, j] += twist.derivative(2)(motor.t)


def rattle(model, effect, motor):
    """The motor follows the motion; the link hangs on a stiff gear with play. Returns the link's state."""
    p, j, period = effect.values(), effect.joint, motor.t[1] - motor.t[0]
    data = model.createData()
    every = 20
    mass = np.array([pin.crba(model, data, q)[j, j] for q in motor.q[::every]])
    mass = np.interp(motor.t, motor.t[::every], mass)
    omega = 2 * np.pi * p["hertz"]
    stiffness, damping, gap = omega**2, 2 * p["damping_ratio"] * omega, p["half_gap"]
    pull = motor.load[:, j] / mass
    twist, rate, substeps = gap * np.sign(pull[0]) + pull[0] / stiffness, 0.0, 8
    path, step = np.empty((motor.t.size, 3)), period / substeps

    def gear(twist, rate):
        beyond = twist - gap if twist > gap else twist + gap if twist < -gap else 0.0
        push = stiffness * beyond + damping * rate
        return push if push * beyond > 0 else 0.0

    for k in range(motor.t.size):
        path[k] = twist, rate, pull[k] - gear(twist, rate)
        slope = (pull[min(k + 1, pull.size - 1)] - pull[k]) / substeps
        for n in range(substeps):
            load = pull[k] + n * slope
            middle = rate + 0.5 * step * (load - gear(twist, rate))
            half = twist + 0.5 * step * rate
            rate += step * (load + 0.5 * slope - gear(half, middle))
            twist += step * middle
    link = State(motor.t, motor.q.copy(), motor.v.copy(), motor.a.copy(), None, motor.sign)
    for signal, moved in zip((link.q, link.v, link.a), path.T):
        signal[:, j] -= moved
    link.load = rnea(model, link.q, link.v, link.a)
    return link
