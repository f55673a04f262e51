"""Effects at random places with random shapes, and the sizes that the library's parameters have."""

import numpy as np

from effects import WHOLE_ARM, Effect


def draw(rng, name, arm, duration, joint=None):
    """An effect of that name; its size is set later."""
    if joint is None:
        joint = int(rng.integers(arm.dof - 1 if name == "joint_coupling" else arm.dof))
    if name == "joint_coupling":
        joint = min(joint, arm.dof - 2)
    if name == "link_inertia_error":
        joint = max(joint, 1)  # of an upright arm's first link the rotor hides everything
    make = globals().get("draw_" + name)
    parameters, sized = make(rng, arm, joint, duration)
    logs = (int(rng.integers(2)),) if name == "external_contact" and rng.random() < 0.5 else ()
    return Effect(name, -1 if name in WHOLE_ARM else joint, parameters, sized, logs=logs)


def turn(rng, names, size=1.0):
    angle = rng.uniform(0, 2 * np.pi)
    return dict(zip(names, size * np.array([np.cos(angle), np.sin(angle)])))


def either(rng):
    return float(rng.choice([-1.0, 1.0]))


def place(rng, spread=0.08):
    return dict(zip(("cx", "cy", "cz"), rng.normal(0, spread, 3)))


def draw_payload(rng, arm, joint, duration):
    return {"m": 1.0, **place(rng), "spread": rng.uniform(0.02, 0.1)}, ("m",)


def draw_link_inertia_error(rng, arm, joint, duration):
    body = arm.joints[joint]
    where = dict(zip(("cx", "cy", "cz"), body.com + rng.normal(0, 0.08, 3)))
    return {"dm": either(rng), **where, "spread": rng.uniform(0.03, 0.2)}, ("dm",)


def draw_base_tilt(rng, arm, joint, duration):
    return turn(rng, ("roll", "pitch"), 0.01), ("roll", "pitch")


def draw_friction_asymmetry(rng, arm, joint, duration):
    return {"coulomb": either(rng), "viscous": rng.uniform(-1, 1)}, ("coulomb", "viscous")


def draw_stribeck_friction(rng, arm, joint, duration):
    shape = {"velocity": rng.uniform(0.05, 0.4), "exponent": float(rng.choice([1.0, 2.0]))}
    return {"rise": 1.0, **shape}, ("rise",)


def draw_nonlinear_viscous_friction(rng, arm, joint, duration):
    exponent = rng.uniform(0.3, 0.7) if rng.random() < 0.5 else rng.uniform(1.5, 2.5)
    return {"coefficient": 1.0, "exponent": exponent}, ("coefficient",)


def draw_load_dependent_friction(rng, arm, joint, duration):
    return {"coefficient": 0.02}, ("coefficient",)


def draw_position_dependent_friction(rng, arm, joint, duration):
    return turn(rng, ("cosine", "sine")), ("cosine", "sine")


def draw_friction_warm_up(rng, arm, joint, duration):
    return {"rise": 1.0, "time_constant": rng.uniform(2.0, 0.6 * duration)}, ("rise",)


def draw_presliding_hysteresis(rng, arm, joint, duration):
    return {"level": 1.0, "distance": rng.uniform(0.005, 0.05)}, ("level",)


def draw_torque_ripple(rng, arm, joint, duration):
    fast = rng.random() < 0.2
    harmonic = float(rng.integers(60, 200)) if fast else rng.integers(8, 120) / 2
    return {**turn(rng, ("cosine", "sine")), "harmonic": harmonic}, ("cosine", "sine")


def draw_joint_spring(rng, arm, joint, duration):
    return {"stiffness": 1.0, "preload": rng.uniform(-1, 1)}, ("stiffness", "preload")


def draw_gravity_balancer(rng, arm, joint, duration):
    a, b = rng.uniform(0.15, 0.35), rng.uniform(0.4, 0.9)
    lengths = {"a": a, "b": b, "l0": rng.uniform(0.6, 1.0) * (b - a), "angle": rng.uniform(-np.pi, np.pi)}
    return {"pull": rng.uniform(0, 1.0), "rate": rng.uniform(1.0, 5.0), **lengths}, ("pull", "rate")


def draw_joint_coupling(rng, arm, joint, duration):
    sizes = {"viscous": rng.uniform(0.3, 1), "coulomb": rng.uniform(0.3, 1), "inertia": rng.uniform(0.02, 0.2)}
    return sizes, tuple(sizes)


def draw_external_contact(rng, arm, joint, duration):
    start = rng.uniform(1.5, duration - 7.0)
    force = dict(zip(("fx", "fy", "fz"), rng.normal(size=3)))
    return {**force, "start": start, "end": start + rng.uniform(1.5, 5.5), "rise": rng.uniform(0.05, 0.3)}, tuple(force)


def draw_joint_elasticity(rng, arm, joint, duration):
    return {"compliance": 1e-6}, ("compliance",)


def draw_backlash(rng, arm, joint, duration):
    return {"half_gap": 3e-4, "hertz": rng.uniform(70, 110), "damping_ratio": rng.uniform(0.3, 0.7)}, ("half_gap",)


def draw_torque_gain(rng, arm, joint, duration):
    return {"error": 0.01 * either(rng)}, ("error",)


def draw_torque_offset(rng, arm, joint, duration):
    return {"offset": either(rng)}, ("offset",)


def draw_torque_lag(rng, arm, joint, duration):
    return {"time": 2e-3}, ("time",)


def draw_torque_saturation(rng, arm, joint, duration):
    return {"clipped": 0.05}, ("clipped",)


def draw_time_delay(rng, arm, joint, duration):
    return {"delay": 1e-3 * either(rng)}, ("delay",)


def draw_encoder_offset(rng, arm, joint, duration):
    return {"offset": 1e-3 * either(rng)}, ("offset",)


def draw_encoder_eccentricity(rng, arm, joint, duration):
    return turn(rng, ("sine", "cosine"), 1e-3), ("sine", "cosine")


def draw_outside_position_damping(rng, arm, joint, duration):
    return turn(rng, ("cosine", "sine")), ("cosine", "sine")


def draw_outside_beating(rng, arm, joint, duration):
    return {"level": 1.0, "period": rng.uniform(5, 12), "harmonic": rng.integers(16, 120) / 2}, ("level",)


def draw_outside_hydraulic(rng, arm, joint, duration):
    return {"out": 1.0, "back": rng.uniform(2, 4), "lag": rng.uniform(0.05, 0.2)}, ("out", "back")


def draw_outside_drifting_gain(rng, arm, joint, duration):
    return {"error": 0.02, "period": rng.uniform(7, 18), "phase": rng.uniform(0, 6.28)}, ("error",)


def draw_outside_crosstalk(rng, arm, joint, duration):
    other = int(rng.choice([k for k in range(arm.dof) if abs(k - joint) in (1, 2)]))
    return {"share": 0.02 * either(rng), "other": other}, ("share",)


def as_in_library(effect):
    """Parameters in the library's terms, to compare with what a diagnosis estimates."""
    p = effect.values()
    com = lambda mass: {"mx": mass * p["cx"], "my": mass * p["cy"], "mz": mass * p["cz"]}
    match effect.name:
        case "payload":
            return {"m": p["m"], **com(p["m"])}
        case "link_inertia_error":
            return {"dm": p["dm"], **{"d" + name: value for name, value in com(p["dm"]).items()}}
        case "gravity_balancer":
            s2 = p["a"] ** 2 + p["b"] ** 2
            preload = s2**0.5 * (p["pull"] + p["rate"] * (s2**0.5 - p["l0"]))
            return {"preload": preload, "stiffness": p["rate"] * s2, "geometry": 2 * p["a"] * p["b"] / s2, "angle": p["angle"]}
        case "backlash":
            return {"half_gap": p["half_gap"]}
        case "torque_saturation":
            return {"level": (1 - min(p["clipped"], 0.9)) * effect.held["peak"]}
        case "external_contact":
            return {name: p[name] for name in ("fx", "fy", "fz", "start", "end")}
    return p
