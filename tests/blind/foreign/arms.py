"""Random serial arms: what is built (the truth) and the URDF that describes it (what is believed).

All lengths in m, masses in kg; rigid-body computations by Pinocchio. Friction and reflected rotor inertia of a joint are
at the joint side of the gear.
"""

from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

GRAVITY = np.array([0.0, 0.0, -9.81])

# Axes of industrial arms, base to flange.
PATTERNS_6 = ["zyyxyx", "zyyxyz", "zyyyzy", "zyyzyz", "zxxyxy"]
PATTERNS_7 = ["zyzyzyz", "zyxyxyx", "zyyxyxz"]
AXIS = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}


@dataclass
class Joint:
    """One joint, the body it moves, and its drive."""

    kind: str
    xyz: np.ndarray
    rpy: np.ndarray
    axis: np.ndarray
    reach: float  # positions within +- reach, rad or m
    speed: float
    mass: float
    com: np.ndarray
    inertia: np.ndarray  # about the centre of mass, joint axes
    viscous: float = 0.0
    coulomb: float = 0.0
    armature: float = 0.0


@dataclass
class Arm:
    """A serial arm with a flange behind its last joint."""

    joints: list
    flange_xyz: np.ndarray
    kind: str
    model: pin.Model = field(default=None)
    flange: int = 0  # frame of the flange in the model

    def __post_init__(self):
        self.model, self.flange = build(self)

    @property
    def dof(self):
        return len(self.joints)

    def names(self):
        return [f"joint_{k + 1}" for k in range(self.dof)]

    def drive(self, name):
        return np.array([getattr(joint, name) for joint in self.joints])


def random_arm(rng, kind):
    """An arm of the kind `6r`, `7r`, `skew` (frames and axes at any angle) or `prismatic` (one sliding joint)."""
    dof = 7 if kind == "7r" else 6
    pattern = rng.choice(PATTERNS_7 if dof == 7 else PATTERNS_6)
    slider = int(rng.integers(0, 3)) if kind == "prismatic" else -1
    mass, length = rng.uniform(20.0, 80.0), rng.uniform(0.3, 0.9)
    joints, bone = [], np.array([0.0, 0.0, rng.uniform(0.1, 0.5)])
    for k in range(dof):
        mass = max(2.0, mass * rng.uniform(0.45, 0.85)) if k else mass
        length = max(0.1, length * rng.uniform(0.5, 1.0)) if k else length
        previous = bone
        bone = along(rng, length, pattern[k])
        com = bone * rng.uniform(0.25, 0.65) + rng.normal(0.0, 0.06 * length + 0.01, 3)
        skew = kind == "skew"
        joints.append(
            Joint(
                kind="prismatic" if k == slider else "revolute",
                xyz=previous,
                rpy=rng.uniform(-1.2, 1.2, 3) if skew else np.zeros(3),
                axis=unit(rng.normal(size=3)) if skew and rng.random() < 0.5 else np.array(AXIS[pattern[k]]),
                reach=rng.uniform(0.25, 0.6) if k == slider else rng.uniform(1.6, 3.0),
                speed=4.0,
                mass=mass,
                com=com,
                inertia=bulk(rng, mass, bone),
            )
        )
    arm = Arm(joints, bone * rng.uniform(0.3, 1.0), kind)
    give_drives(rng, arm)
    return arm


def along(rng, length, axis):
    """A link mostly across the axis of the next bend, as industrial arms have them."""
    direction = np.array([0.0, 0.0, 1.0]) if axis == "z" else AXIS_MIX[int(rng.integers(len(AXIS_MIX)))]
    return length * unit(direction + rng.normal(0.0, 0.15, 3))


AXIS_MIX = [np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.4])]


def unit(vector):
    return vector / np.linalg.norm(vector)


def bulk(rng, mass, bone):
    """Inertia about the centre of mass of points strewn along the link: always one that a body can have."""
    points = rng.normal(size=(30, 3)) * (0.25 * np.abs(bone) + 0.06)
    points -= points.mean(axis=0)
    moments = points.T @ points / 30
    return mass * (np.trace(moments) * np.eye(3) - moments)


def give_drives(rng, arm):
    """Friction of a few per cent of the joint's load and a rotor between a tenth and the whole of the link's inertia."""
    data, loads, masses = arm.model.createData(), [], []
    for _ in range(60):
        q = rng.uniform(-1, 1, arm.dof) * 0.6 * np.array([joint.reach for joint in arm.joints])
        v, a = rng.normal(0, 1.0, arm.dof), rng.normal(0, 3.0, arm.dof)
        loads.append(pin.rnea(arm.model, data, q, v, a))
        masses.append(np.diag(pin.crba(arm.model, data, q)).copy())
    load, mass = np.sqrt(np.mean(np.square(loads), axis=0)), np.mean(masses, axis=0)
    for joint, torque, inertia in zip(arm.joints, load, mass):
        joint.coulomb = torque * rng.uniform(0.03, 0.12)
        joint.viscous = joint.coulomb * rng.uniform(0.3, 1.5)
        joint.armature = inertia * rng.uniform(0.1, 1.0)


def inertia_of(mass, com, inertia):
    return pin.Inertia(mass, np.asarray(com), np.asarray(inertia))


def build(arm):
    """The arm's Pinocchio model, built without a URDF, and the frame of its flange."""
    model, parent = pin.Model(), 0
    model.gravity.linear = GRAVITY
    for k, joint in enumerate(arm.joints):
        placement = pin.SE3(pin.rpy.rpyToMatrix(*joint.rpy), joint.xyz)
        make = pin.JointModelPrismaticUnaligned if joint.kind == "prismatic" else pin.JointModelRevoluteUnaligned
        parent = model.addJoint(parent, make(*joint.axis), placement, f"joint_{k + 1}")
        model.appendBodyToJoint(parent, inertia_of(joint.mass, joint.com, joint.inertia), pin.SE3.Identity())
    frame = pin.Frame("flange", parent, pin.SE3(np.eye(3), arm.flange_xyz), pin.FrameType.OP_FRAME)
    return model, model.addFrame(frame)


def urdf(arm, drives):
    """The URDF of the arm; `drives` holds (damping, friction, armature) of every joint, or None to leave them out."""
    text = lambda values: " ".join(repr(float(value)) for value in values)
    lines = ['<?xml version="1.0"?>', f'<robot name="foreign_{arm.kind}">', '  <link name="base"/>']
    for k, joint in enumerate(arm.joints):
        ixx, ixy, ixz, _, iyy, iyz, _, _, izz = joint.inertia.ravel()
        lines += [
            f'  <joint name="joint_{k + 1}" type="{joint.kind}">',
            f'    <parent link="{"base" if k == 0 else f"link_{k}"}"/><child link="link_{k + 1}"/>',
            f'    <origin xyz="{text(joint.xyz)}" rpy="{text(joint.rpy)}"/><axis xyz="{text(joint.axis)}"/>',
            f'    <limit lower="{-joint.reach}" upper="{joint.reach}" effort="100000" velocity="{joint.speed}"/>',
        ]
        if drives is not None:
            damping, friction, armature = (float(value) for value in drives[k])
            lines += [f'    <dynamics damping="{damping}" friction="{friction}" armature="{armature}"/>']
        lines += [
            "  </joint>",
            f'  <link name="link_{k + 1}"><inertial>',
            f'    <origin xyz="{text(joint.com)}" rpy="0 0 0"/><mass value="{joint.mass}"/>',
            f'    <inertia ixx="{ixx}" ixy="{ixy}" ixz="{ixz}" iyy="{iyy}" iyz="{iyz}" izz="{izz}"/>',
            "  </inertial></link>",
        ]
    lines += [
        '  <joint name="flange_mount" type="fixed">',
        f'    <parent link="link_{arm.dof}"/><child link="flange"/><origin xyz="{text(arm.flange_xyz)}" rpy="0 0 0"/>',
        "  </joint>",
        '  <link name="flange"/>',
        "</robot>",
    ]
    return "\n".join(lines) + "\n"
