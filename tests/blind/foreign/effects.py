"""Effects that an arm's model misses, each from its textbook law.

An effect acts on the bodies (`ALTER`), as a torque at the joints (`TORQUE`: what the motor must add), in a sensor
(`TORQUE_SENSOR`, `POSITION_SENSOR`), in the gear or on the clock (both in plant.py). Laws in `OUTSIDE` are in no library.
"""

from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

# Effects that free base parameters hide wholly or nearly.
HIDDEN_BY_STRUCTURE = {"payload", "link_inertia_error", "encoder_offset", "gravity_balancer", "torque_gain"}
WHOLE_ARM = {"payload", "base_tilt", "time_delay", "external_contact"}


@dataclass
class Effect:
    """An effect on a joint (counted from 0; -1 for the whole arm); `size` multiplies the parameters in `sized`."""

    name: str
    joint: int
    parameters: dict
    sized: tuple
    size: float = 1.0
    logs: tuple = ()  # indices of the logs it acts in; all if empty
    held: dict = field(default_factory=dict)

    def values(self):
        """Parameters at the present size."""
        return {key: value * (self.size if key in self.sized else 1.0) for key, value in self.parameters.items()}


@dataclass
class State:
    """Motion of the motors (seen at the joints), [time][joint], and what it takes: `load` is the rigid bodies' torque."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    load: np.ndarray
    sign: object  # smooth or hard sign of a velocity


# Bodies ---------------------------------------------------------------------------------------------------------------


def add_payload(model, flange, p, joint):
    body = pin.Inertia(p["m"], np.array([p["cx"], p["cy"], p["cz"]]), p["m"] * p["spread"] ** 2 * np.eye(3))
    model.appendBodyToJoint(model.frames[flange].parentJoint, body, model.frames[flange].placement)


def add_link_error(model, flange, p, joint):
    com = np.array([p["cx"], p["cy"], p["cz"]])
    body = pin.Inertia(1.0, com, p["spread"] ** 2 * np.eye(3)).toDynamicParameters()
    changed = model.inertias[joint + 1].toDynamicParameters() + p["dm"] * body
    model.inertias[joint + 1] = pin.Inertia.FromDynamicParameters(changed)


def tilt(model, flange, p, joint):
    base = pin.rpy.rpyToMatrix(p["roll"], p["pitch"], 0.0)  # Rz(0) Ry(pitch) Rx(roll)
    model.gravity.linear = base.T @ model.gravity.linear


ALTER = {"payload": add_payload, "link_inertia_error": add_link_error, "base_tilt": tilt}


# Torques at one joint: (parameters, time, q, v, a, load, sign) of the joint -> torque -----------------------------------


def asymmetry(p, t, q, v, a, load, sign):
    return p["coulomb"] * np.abs(sign(v)) + p["viscous"] * np.abs(v)


def stribeck(p, t, q, v, a, load, sign):
    return p["rise"] * np.exp(-(np.abs(v) / p["velocity"]) ** p["exponent"]) * sign(v)


def power_viscous(p, t, q, v, a, load, sign):
    return p["coefficient"] * np.abs(v) ** p["exponent"] * np.sign(v)


def load_friction(p, t, q, v, a, load, sign):
    return p["coefficient"] * np.abs(load) * sign(v)


def position_friction(p, t, q, v, a, load, sign):
    return (p["cosine"] * np.cos(q) + p["sine"] * np.sin(q)) * sign(v)


def warm_up(p, t, q, v, a, load, sign):
    return p["rise"] * np.exp(-t / p["time_constant"]) * sign(v)


def dahl(p, t, q, v, a, load, sign):
    """F z with dz/dt = (v/d) (1 - z sign v), exact for steps of one direction."""
    steps = np.diff(q)
    kept, z = np.exp(-np.abs(steps) / p["distance"]), np.zeros(q.size)
    towards = np.sign(steps)
    for k in range(steps.size):
        z[k + 1] = towards[k] + (z[k] - towards[k]) * kept[k]
    return p["level"] * z


def ripple(p, t, q, v, a, load, sign):
    return p["cosine"] * np.cos(p["harmonic"] * q) + p["sine"] * np.sin(p["harmonic"] * q)


def spring(p, t, q, v, a, load, sign):
    return p["stiffness"] * q + p["preload"]


def strut(p, t, q, v, a, load, sign):
    """A strut from radius `a` on the link to radius `b` on the frame; pull F0 + k (l - l0), times dl/dq."""
    turned = q - p["angle"]
    l = np.sqrt(p["a"] ** 2 + p["b"] ** 2 - 2 * p["a"] * p["b"] * np.cos(turned))
    pull = p["pull"] + p["rate"] * (l - p["l0"])
    return pull * p["a"] * p["b"] * np.sin(turned) / l


def position_damping(p, t, q, v, a, load, sign):
    return (p["cosine"] * np.cos(q) + p["sine"] * np.sin(q)) * v


def beating(p, t, q, v, a, load, sign):
    return p["level"] * np.cos(2 * np.pi * t / p["period"]) * np.cos(p["harmonic"] * q)


def hydraulic(p, t, q, v, a, load, sign):
    """Orifice damping v|v| of two valves; the pressure follows with a first-order lag."""
    aim = np.where(v > 0, p["out"], p["back"]) * v * np.abs(v)
    return lagged(aim, t[1] - t[0], p["lag"])


TORQUE = {
    "friction_asymmetry": asymmetry,
    "stribeck_friction": stribeck,
    "nonlinear_viscous_friction": power_viscous,
    "load_dependent_friction": load_friction,
    "position_dependent_friction": position_friction,
    "friction_warm_up": warm_up,
    "presliding_hysteresis": dahl,
    "torque_ripple": ripple,
    "joint_spring": spring,
    "gravity_balancer": strut,
    "outside_position_damping": position_damping,
    "outside_beating": beating,
    "outside_hydraulic": hydraulic,
}


def coupling(p, state, joint, out):
    """Two axes on one gear train: each pays for the other."""
    one, two = joint, joint + 1
    shared = p["coulomb"] * state.sign(state.v[:, one] + state.v[:, two])
    for own, other in ((one, two), (two, one)):
        out[:, own] += p["viscous"] * state.v[:, other] + shared + p["inertia"] * state.a[:, other]


def contact(p, state, model, flange, out):
    """The motors resist a force f on the flange: -J' f, with smooth edges."""
    edge = lambda x: np.clip(x + 0.5, 0, 1) ** 2 * (3 - 2 * np.clip(x + 0.5, 0, 1))
    share = edge((state.t - p["start"]) / p["rise"]) * edge((p["end"] - state.t) / p["rise"])
    force, data = np.array([p["fx"], p["fy"], p["fz"]]), model.createData()
    for k in np.flatnonzero(share):
        jacobian = pin.computeFrameJacobian(model, data, state.q[k], flange, pin.LOCAL_WORLD_ALIGNED)
        out[k] -= share[k] * (jacobian[:3].T @ force)


# Sensors: [time][joint] in and out ------------------------------------------------------------------------------------


def lagged(signal, period, time):
    """First-order lag, exact for a signal that is straight between samples; steady before the first."""
    decay, out = np.exp(-period / time), np.empty_like(signal)
    behind = time * np.diff(signal, prepend=signal[0]) / period
    error, before = 0.0, 0.0
    for k, drag in enumerate(behind):
        error = decay * (error + drag)
        out[k] = signal[k] - drag + error
        error -= drag
    return out


def gain(p, t, tau, joint):
    tau[:, joint] *= 1 + p["error"]


def offset(p, t, tau, joint):
    tau[:, joint] += p["offset"]


def lag(p, t, tau, joint):
    tau[:, joint] = lagged(tau[:, joint], t[1] - t[0], p["time"])


def saturation(p, t, tau, joint):
    tau[:, joint] = np.clip(tau[:, joint], -p["level"], p["level"])


def drifting_gain(p, t, tau, joint):
    tau[:, joint] *= 1 + p["error"] * np.sin(2 * np.pi * t / p["period"] + p["phase"])


def crosstalk(p, t, tau, joint):
    tau[:, joint] += p["share"] * tau[:, int(p["other"])]


TORQUE_SENSOR = {
    "torque_gain": gain,
    "torque_offset": offset,
    "torque_lag": lag,
    "torque_saturation": saturation,
    "outside_drifting_gain": drifting_gain,
    "outside_crosstalk": crosstalk,
}

POSITION_SENSOR = {
    "encoder_offset": lambda p, q: q + p["offset"],
    "encoder_eccentricity": lambda p, q: q + p["sine"] * np.sin(q) + p["cosine"] * np.cos(q),
}

LIBRARY = sorted(
    {name for table in (ALTER, TORQUE, TORQUE_SENSOR, POSITION_SENSOR) for name in table if not name.startswith("outside")}
    | {"joint_coupling", "external_contact", "joint_elasticity", "backlash", "time_delay"}
)
OUTSIDE = sorted(name for table in (TORQUE, TORQUE_SENSOR) for name in table if name.startswith("outside"))
