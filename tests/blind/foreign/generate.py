"""Writes blind cases from a plant that shares no code with tauscope: generate.py SET COUNT FOLDER [--seed N] [--from N].

Every case is a folder with robot.urdf, a.csv, b.csv, c.csv and truth.json; the same seed gives the same files.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

import mujoco_plant
from arms import random_arm, urdf
from cases import case
from draw import as_in_library, draw
from effects import WHOLE_ARM
from motions import random_motion
from plant import Plant
from sensors import NOISES, random_encoder, read_encoder, torque_noise, write_log
from sizing import Severity, settle

LOGS = ["a", "b", "c"]


def make(set_name, number, seed, folder, fixed):
    rng, truth = case(set_name, number, seed, fixed)
    arm = random_arm(rng, truth["arm"])
    rate, duration, width = truth["rate"], truth["duration"], truth["sign_width"]
    reach = [joint.reach for joint in arm.joints]
    motions = [random_motion(rng, truth["motion"], reach, duration, truth["at_rest"]) for _ in LOGS]
    bare = Plant(arm, [], width)
    plain = [bare.log(motion, rate, duration, index) for index, motion in enumerate(motions)]
    noise = truth["noise_level"] * np.sqrt(np.mean(np.concatenate([tau for _, _, tau in plain]) ** 2, axis=0))
    severity = Severity(arm, noise, truth["mode"] == "structure", width)
    effects, sizes = [], []
    for name in truth.pop("names"):
        effect = draw(rng, name, arm, duration)
        if effect.joint >= 0:  # saturation is a share of the largest torque in the logs to train with, where it is sized
            effect.held["peak"] = max(np.abs(tau[:, effect.joint]).max() for _, _, tau in plain[:2])
        sizes.append(settle(effect, arm, severity, motions[:2], rate, duration, truth["severity"], width, NOISES[truth["noise"]]))
        effects.append(effect)
    if set_name == "mujoco":
        logs = mujoco_plant.logs(rng, arm, effects, motions, rate, duration)
        truth["tracking_rms"] = [float(np.sqrt(np.mean((log[1] - motion.at(log[0])[0]) ** 2))) for log, motion in zip(logs, motions)]
    else:
        plant = Plant(arm, effects, width)
        logs = [plant.log(motion, rate, duration, index) for index, motion in enumerate(motions)]
    folder.mkdir(parents=True, exist_ok=True)
    encoder = random_encoder(rng, truth["quantised"])
    for name, (t, q, tau) in zip(LOGS, logs):
        logged = tau + torque_noise(rng, t.size, noise, 1 / rate, NOISES[truth["noise"]])
        write_log(folder / f"{name}.csv", t, read_encoder(rng, q, encoder), logged)
    (folder / "robot.urdf").write_text(urdf(arm, believed_drives(rng, arm, truth["urdf_drives"])))
    truth |= {"encoder": encoder, "noise_rms_nm": noise.tolist(), "joints": arm.names()}
    truth["effects"] = [described(effect, size, arm) for effect, size in zip(effects, sizes)]
    (folder / "truth.json").write_text(json.dumps(truth, indent=1, default=float) + "\n")


def believed_drives(rng, arm, kind):
    if kind == "absent":
        return None
    drives = np.stack([arm.drive(name) for name in ("viscous", "coulomb", "armature")], axis=1)
    return drives if kind == "right" else drives * rng.uniform(0.5, 1.5, drives.shape)


def described(effect, size, arm):
    all_rows, moving, evidence = size
    outside = effect.name.startswith("outside")
    joint = int(np.argmax(all_rows)) if effect.name in WHOLE_ARM else effect.joint
    return {
        "effect": effect.name,
        "joints": [] if effect.joint < 0 else [f"joint_{effect.joint + 1}"],
        "worst_joint": f"joint_{int(np.argmax(all_rows)) + 1}",
        "joint": f"joint_{joint + 1}",
        "in_library": not outside,
        "logs": list(effect.logs),
        "severity": all_rows.tolist(),
        "severity_moving": moving.tolist(),
        "evidence": evidence,
        "parameters": effect.values() if outside else as_in_library(effect),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("set")
    parser.add_argument("count", type=int)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--from", dest="first", type=int, default=0)
    parser.add_argument("--fix", action="append", default=[], help="KEY=JSON of truth.json for all cases, as at_rest=true")
    options = parser.parse_args()
    fixed = {key: json.loads(value) for key, value in (pair.split("=") for pair in options.fix)}
    for number in range(options.first, options.first + options.count):
        folder = options.folder / f"{number:04d}"
        if not (folder / "truth.json").exists():
            make(options.set, number, options.seed, folder, fixed)
            print(folder, flush=True)


if __name__ == "__main__":
    sys.exit(main())
