"""The sets of cases: what is drawn for the n-th case of a set."""

import numpy as np

from effects import HIDDEN_BY_STRUCTURE, LIBRARY, OUTSIDE
from sensors import NOISES

ARMS = ["6r", "6r", "7r", "skew", "prismatic"]
MOTIONS = ["fourier", "quintic", "trapezoid"]
MUJOCO = [
    "payload", "stribeck_friction", "joint_spring", "external_contact", "time_delay", "torque_gain", "torque_offset",
    "encoder_offset", "encoder_eccentricity", "base_tilt", "backlash", "joint_elasticity", "nonlinear_viscous_friction",
    "load_dependent_friction", "friction_asymmetry", "torque_lag",
]  # fmt: skip


def names_of(set_name, number, mode, rng):
    """Effects hidden in case `number` of a set; none in every third of a mixed set."""
    visible = [name for name in LIBRARY if mode == "nominal" or name not in HIDDEN_BY_STRUCTURE]
    pick = lambda names, count=1: [str(name) for name in rng.choice(names, count, replace=False)]
    match set_name:
        case "quiet":
            return []
        case "first":
            return [] if number < 24 else [visible[(number - 24) % len(visible)]]
        case "single1" | "single03":
            return [visible[number % len(visible)]]
        case "pairs":
            return pick(visible, 2)
        case "outside":
            return [OUTSIDE[number % len(OUTSIDE)]]
        case "mujoco":
            visible = [name for name in MUJOCO if name in visible]
            return [] if number % 3 == 0 else [visible[(number // 3 * 2 + number % 3) % len(visible)]]
    raise SystemExit(f"there is no set {set_name}")


def case(set_name, number, seed, fixed):
    """Everything about a case that is drawn before the arm is; `fixed` overrules what is drawn."""
    rng = np.random.default_rng([seed, sum(set_name.encode()), number])
    structure = rng.random() < 0.35
    mode = fixed.get("mode", "structure" if structure else "nominal")
    drawn = {
        "set": set_name,
        "case": number,
        "seed": seed,
        "mode": mode,
        "names": names_of(set_name, number, mode, rng),
        "severity": 0.3 if set_name == "single03" else 1.0,
        "arm": ARMS[int(rng.integers(len(ARMS)))],
        "motion": MOTIONS[(number + number // 9) % 3],
        "noise": list(NOISES)[number // 3 % 3],
        "rate": float(rng.choice([500, 500, 500, 250, 1000])),
        "duration": 20.0,
        "noise_level": rng.uniform(0.005, 0.01),
        "quantised": bool(rng.random() < 0.25),
        "sign_width": float(rng.choice([1e-5, 1e-3, 1e-2])),
        "at_rest": bool(rng.random() < 0.7),
        "urdf_drives": str(rng.choice(["right", "absent", "wrong"])),
    }
    return rng, drawn | fixed
