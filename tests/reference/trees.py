"""Reference dynamics of trees with followers (mimic joints) and held joints by Pinocchio, checked with MuJoCo.

Versions: Python 3.11, pinocchio (package pin) 4.1.0, mujoco 4.0.0, numpy 2.4.6.
Run from the repository root:
  python -P tests/reference/trees.py                       the models of tests/reference/trees, a JSON file each
  python -P tests/reference/trees.py ROBOT.urdf --out FILE [--joints a,b,c] [--hold name=value ...] [--seed N] [--bodies COPY.urdf]
                                                           any other URDF
See README.md for the fields. The joints are q = A x + b of the coordinates x; the torque at the coordinates is A' tau.
Torques are those of the rigid bodies alone: no friction, no rotor inertia, no limits, no contacts.
"""

import argparse
import json
import re
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent / "trees"
MODELS = ["two_finger", "two_arms", "palletiser", "hollow_wrist", "humanoid_free"]
STATES = 20
STANDARD_GRAVITY = [0.0, 0.0, -9.81]
TILTED_GRAVITY = [[0.5, -0.3, -9.7], [9.81, 0.0, 0.0], [-2.1, 6.4, 7.0]]
PARAMETER_ORDER = ["m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"]
# Pinocchio with itself; MuJoCo keeps frames as quaternions, so that heavy trees differ somewhat more.
TOLERANCE, TOLERANCE_MUJOCO = 1e-10, 1e-9
MOVING = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
# Half the range of joints without limits in the random states, rad or m.
FREE_RANGE = {"revolute": np.pi, "prismatic": 0.5}


@dataclass
class Joint:
    """A joint of the file; `mimic` is (master, multiplier, offset)."""

    name: str
    kind: str
    parent: str
    child: str
    lower: float
    upper: float
    damping: float
    friction: float
    armature: float
    mimic: tuple | None


def number(element, attribute: str, default: float) -> float:
    text = None if element is None else element.get(attribute)
    return default if text is None else float(text)


def parse(urdf: Path) -> ElementTree.Element:
    """The file without a byte order mark; prefixes that are not declared lose their colon."""
    text = urdf.read_bytes().decode("utf-8-sig", errors="replace").lstrip()
    text = re.sub(r"<(/?)([A-Za-z_][\w.-]*):", r"<\1\2_", text)
    return ElementTree.fromstring(text)


def joints_of(root: ElementTree.Element) -> list[Joint]:
    """The joints, depth first, children of a link in the order of the file."""
    found = []
    for element in root.findall("joint"):
        limit, dynamics, mimic = (element.find(tag) for tag in ("limit", "dynamics", "mimic"))
        kind = element.get("type")
        limited = kind in ("revolute", "prismatic") and limit is not None
        found.append(
            Joint(
                element.get("name"),
                kind,
                element.find("parent").get("link"),
                element.find("child").get("link"),
                number(limit, "lower", 0.0) if limited else -np.inf,
                number(limit, "upper", 0.0) if limited else np.inf,
                *(number(dynamics, key, 0.0) for key in ("damping", "friction", "armature")),
                None
                if mimic is None
                else (mimic.get("joint"), number(mimic, "multiplier", 1.0), number(mimic, "offset", 0.0)),
            )
        )
    children = {joint.child for joint in found}
    roots = [link.get("name") for link in root.findall("link") if link.get("name") not in children]

    def below(link: str) -> list[Joint]:
        return [each for joint in found if joint.parent == link for each in (joint, *below(joint.child))]

    return [joint for link in roots for joint in below(link)]


def add_bodies(urdf: Path, out: Path, seed: int) -> None:
    """Write the file with arbitrary bodies for the links without one, so that a robot without inertials has dynamics."""
    rng, root = np.random.default_rng(seed), parse(urdf)
    for link in root.findall("link"):
        if link.find("inertial") is None:
            inertial = ElementTree.SubElement(link, "inertial")
            ElementTree.SubElement(inertial, "origin", xyz=" ".join(f"{v:.4f}" for v in rng.uniform(-0.1, 0.1, 3)))
            ElementTree.SubElement(inertial, "mass", value=f"{rng.uniform(1.0, 9.0):.4f}")
            # A diagonally dominant tensor with moments between 0.1 and 0.15 is always possible.
            moments, products = rng.uniform(0.1, 0.15, 3), rng.uniform(-0.01, 0.01, 3)
            values = dict(zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), [*moments, *products]))
            ElementTree.SubElement(inertial, "inertia", {key: f"{value:.5f}" for key, value in values.items()})
    out.write_text(ElementTree.tostring(root, encoding="unicode") + "\n")


class Tree:
    """A URDF of which some joints are coordinates, some follow them and the others are held."""

    def __init__(self, urdf: Path, wanted: list[str] | None, hold: dict[str, float]):
        self.urdf, self.root = urdf, parse(urdf)
        self.joints = {joint.name: joint for joint in joints_of(self.root)}
        moving = [joint for joint in self.joints.values() if joint.kind in MOVING]
        unknown = [name for name in [*(wanted or []), *hold] if name not in self.joints]
        assert not unknown, f"{urdf} has no joint {', '.join(unknown)}"
        self.follows = {joint.name: self.resolve(joint.name) for joint in moving}
        masters = [joint for joint in moving if self.follows[joint.name][0] == joint.name]
        self.coordinates = [
            joint.name for joint in masters if joint.name not in hold and (wanted is None or joint.name in wanted)
        ]
        self.held = {}
        for joint in moving:
            master, multiplier, offset = self.follows[joint.name]
            if joint.name in hold:
                self.held[joint.name] = hold[joint.name]
            elif master not in self.coordinates:
                # Not told where: the middle of its range, zero without a range.
                low, high = self.joints[master].lower, self.joints[master].upper
                middle = (low + high) / 2 if np.isfinite([low, high]).all() else 0.0
                self.held[joint.name] = multiplier * hold.get(master, middle) + offset
        followers = [joint.name for joint in moving if joint.name not in self.coordinates and joint.name not in self.held]
        self.moving = self.coordinates + followers

    def resolve(self, name: str) -> tuple[str, float, float]:
        """The master at the end of the chain of followers, and q = multiplier q_master + offset."""
        master, multiplier, offset = name, 1.0, 0.0
        while self.joints[master].mimic is not None:
            master, ratio, shift = self.joints[master].mimic
            offset += multiplier * shift
            multiplier *= ratio
        return master, multiplier, offset

    def coupling(self, rows: list[str]) -> tuple[np.ndarray, np.ndarray]:
        """A and b of q = A x + b for the joints `rows`; a held joint is a row of zeros and its position."""
        matrix, shift = np.zeros((len(rows), len(self.coordinates))), np.zeros(len(rows))
        for row, name in enumerate(rows):
            if name in self.held:
                shift[row] = self.held[name]
            else:
                master, multiplier, shift[row] = self.follows[name]
                matrix[row, self.coordinates.index(master)] = multiplier
        return matrix, shift

    def standing_links(self) -> set[str]:
        """Links that no moving joint carries."""
        moved = set()
        for joint in self.joints.values():
            if joint.kind in MOVING or joint.parent in moved:
                moved.add(joint.child)
        return {link.get("name") for link in self.root.findall("link")} - moved

    def sample(self, rng: np.random.Generator) -> np.ndarray:
        """Coordinates within their limits."""
        low, high = [], []
        for name in self.coordinates:
            joint = self.joints[name]
            free = FREE_RANGE[MOVING[joint.kind]]
            known = np.isfinite(joint.lower) and joint.upper > joint.lower
            low.append(joint.lower if known else -free)
            high.append(joint.upper if known else free)
        return rng.uniform(low, high)


class Pinocchio:
    """The tree with the held joints welded; followers are joints of their own until A takes them together."""

    def __init__(self, tree: Tree):
        full = pin.buildModelFromUrdf(str(tree.urdf))
        names = list(full.names)[1:]
        assert set(tree.moving) | set(tree.held) <= set(names), set(tree.moving) - set(names)
        locked = [name for name in names if name not in tree.moving]
        at = np.zeros(full.nv)
        for name in locked:
            joint = full.joints[full.getJointId(name)]
            if joint.nv == 1:
                at[joint.idx_v] = tree.held[name]
        self.model = pin.buildReducedModel(
            full, [full.getJointId(name) for name in locked], pin.integrate(full, pin.neutral(full), at)
        )
        # rnea and crba would add rotor inertia if the URDF reader ever took it up.
        self.model.armature = np.zeros(self.model.nv)
        self.data = self.model.createData()
        self.names = list(self.model.names)[1:]
        assert sorted(self.names) == sorted(tree.moving)
        self.coupling, self.shift = tree.coupling(self.names)
        # Columns of the regressor in the order of tree.moving.
        self.columns = np.concatenate(
            [np.arange(PARAMETERS) + PARAMETERS * self.names.index(name) for name in tree.moving]
        )
        self.parameters = [
            np.asarray(self.model.inertias[self.model.getJointId(name)].toDynamicParameters()) for name in tree.moving
        ]

    def position(self, x):
        return pin.integrate(self.model, pin.neutral(self.model), self.coupling @ x + self.shift)

    def torque(self, gravity, x, xd, xdd):
        self.model.gravity.linear = np.array(gravity)
        return self.coupling.T @ pin.rnea(
            self.model, self.data, self.position(x), self.coupling @ xd, self.coupling @ xdd
        )

    def mass_matrix(self, x):
        upper = np.triu(pin.crba(self.model, self.data, self.position(x)))
        return self.coupling.T @ (upper + np.triu(upper, 1).T) @ self.coupling

    def regressor(self, gravity, x, xd, xdd):
        self.model.gravity.linear = np.array(gravity)
        rows = pin.computeJointTorqueRegressor(
            self.model, self.data, self.position(x), self.coupling @ xd, self.coupling @ xdd
        )
        return self.coupling.T @ rows[:, self.columns]


class MuJoCo:
    """The whole tree, held joints included: A projects the joint space that MuJoCo computes onto the coordinates."""

    def __init__(self, tree: Tree):
        still = tree.standing_links()
        for link in tree.root.findall("link"):
            # Bodies that stand need not be possible ones.
            for tag in ("visual", "collision", *(["inertial"] if link.get("name") in still else [])):
                for shape in link.findall(tag):
                    link.remove(shape)
        for tag in ("mujoco", "gazebo", "transmission", "ros2_control"):
            for element in tree.root.findall(tag):
                tree.root.remove(element)
        # MuJoCo knows free joints at the top only; like planar ones they are held here anyway.
        for joint in tree.root.findall("joint"):
            if joint.get("type") in ("floating", "planar"):
                joint.set("type", "fixed")
        options = dict(balanceinertia="false", boundmass="0", boundinertia="0", fusestatic="false", inertiafromgeom="false")
        ElementTree.SubElement(ElementTree.SubElement(tree.root, "mujoco"), "compiler", options)
        self.use(tree, mujoco.MjSpec.from_string(ElementTree.tostring(tree.root, encoding="unicode")))

    @classmethod
    def of_mjcf(cls, tree: Tree, mjcf: Path):
        """The same tree from a file of MuJoCo's own, which must have the couplings as equality constraints."""
        self = cls.__new__(cls)
        self.use(tree, mujoco.MjSpec.from_file(str(mjcf)))
        found = {}
        for k in range(self.model.neq):
            follower, master = (self.joint_name(j) for j in (self.model.eq_obj1id[k], self.model.eq_obj2id[k]))
            found[follower] = (master, self.model.eq_data[k, 1], self.model.eq_data[k, 0])
        assert found == {joint.name: joint.mimic for joint in tree.joints.values() if joint.mimic}, found
        for name in tree.moving:
            dof, joint = self.model.joint(name).dofadr[0], tree.joints[name]
            numbers = self.file_drives[:, dof]
            assert numbers.tolist() == [joint.damping, joint.friction, joint.armature], name
        return self

    def use(self, tree: Tree, spec):
        spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT)
        self.model = spec.compile()
        model = self.model
        self.file_drives = np.array([model.dof_damping, model.dof_frictionloss, model.dof_armature])
        model.dof_damping[:] = model.dof_frictionloss[:] = model.dof_armature[:] = 0.0
        self.data = mujoco.MjData(model)
        names = [self.joint_name(j) for j in range(model.njnt) if self.joint_name(j) in tree.follows]
        assert sorted(names) == sorted(tree.follows), set(tree.follows) ^ set(names)
        self.positions = [model.joint(name).qposadr[0] for name in names]
        dofs = [model.joint(name).dofadr[0] for name in names]
        rows, self.shift = tree.coupling(names)
        self.map, self.rows = np.zeros((model.nv, len(tree.coordinates))), rows
        self.map[dofs] = rows
        self.rotors = np.zeros(model.nv)
        self.rotors[dofs] = [tree.joints[name].armature for name in names]

    def joint_name(self, index: int) -> str:
        return mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_JOINT, index)

    def torque(self, gravity, x, xd, xdd):
        self.model.dof_armature[:] = 0.0
        self.model.opt.gravity[:] = gravity
        self.data.qpos[:] = self.model.qpos0
        self.data.qpos[self.positions] = self.rows @ x + self.shift
        self.data.qvel[:], self.data.qacc[:] = self.map @ xd, self.map @ xdd
        mujoco.mj_inverse(self.model, self.data)
        return self.map.T @ self.data.qfrc_inverse

    def mass_matrix_with_rotors(self, x):
        self.model.dof_armature[:] = self.rotors
        self.data.qpos[:] = self.model.qpos0
        self.data.qpos[self.positions] = self.rows @ x + self.shift
        mujoco.mj_forward(self.model, self.data)
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return self.map.T @ full @ self.map


def relative(a, b) -> float:
    """Largest difference over the largest entry."""
    return float(np.max(np.abs(np.asarray(a) - b), initial=0.0) / max(1.0, np.max(np.abs(b), initial=0.0)))


def state(gravity, tree: Tree, ours: Pinocchio, others: list[MuJoCo], rng: np.random.Generator, worst: dict) -> dict:
    """One random state; differences between the programs are collected in `worst`."""
    count = len(tree.coordinates)
    x, xd, xdd = tree.sample(rng), rng.uniform(-2.0, 2.0, count), rng.uniform(-5.0, 5.0, count)
    zero = np.zeros(count)
    tau = ours.torque(gravity, x, xd, xdd)
    at_rest = ours.torque(gravity, x, zero, zero)
    without_acceleration = ours.torque(gravity, x, xd, zero)
    mass_matrix = ours.mass_matrix(x)
    rotors = ours.coupling.T @ np.diag([tree.joints[name].armature for name in ours.names]) @ ours.coupling
    regressor = ours.regressor(gravity, x, xd, xdd)
    note(worst, "mass matrix against rnea", relative(mass_matrix @ xdd, tau - without_acceleration))
    note(worst, "regressor against rnea", relative(regressor @ np.concatenate(ours.parameters), tau))
    for other in others:
        note(worst, "MuJoCo torque", relative(other.torque(gravity, x, xd, xdd), tau))
        note(worst, "MuJoCo mass matrix", relative(other.mass_matrix_with_rotors(x), mass_matrix + rotors))
    found = {
        "x": x.tolist(),
        "xd": xd.tolist(),
        "xdd": xdd.tolist(),
        "gravity": list(gravity),
        "tau": tau.tolist(),
        "gravity_torque": at_rest.tolist(),
        "mass_matrix": mass_matrix.tolist(),
        "mass_matrix_with_rotors": (mass_matrix + rotors).tolist(),
        "regressor": regressor.tolist(),
    }
    if np.linalg.matrix_rank(mass_matrix) == count:
        # A torque of the size that the state needs, so that the accelerations stay moderate.
        applied = without_acceleration + mass_matrix @ rng.uniform(-5.0, 5.0, count)
        found["applied"] = applied.tolist()
        found["acceleration"] = np.linalg.solve(mass_matrix, applied - without_acceleration).tolist()
    return found


def note(worst: dict, what: str, value: float) -> None:
    worst[what] = max(worst.get(what, 0.0), value)


def reference(tree: Tree, mjcf: Path | None, seed: int, must_check: bool) -> dict:
    ours, others = Pinocchio(tree), []
    try:
        others.append(MuJoCo(tree))
        if mjcf:
            others.append(MuJoCo.of_mjcf(tree, mjcf))
    except (ValueError, AssertionError) as error:
        if must_check:
            raise
        print(f"{tree.urdf.name}: not checked with MuJoCo: {error}", file=sys.stderr)
    rng, worst, states = np.random.default_rng(seed), {}, []
    for k in range(STATES):
        # The first ten stand upright; the rest are tilted, as on a wall, a slope or a ceiling.
        gravity = STANDARD_GRAVITY if k < STATES // 2 else TILTED_GRAVITY[k % len(TILTED_GRAVITY)]
        states.append(state(gravity, tree, ours, others, rng, worst))
    print(f"{tree.urdf.name}: " + ", ".join(f"{what} {value:.1e}" for what, value in worst.items()))
    for what, value in worst.items():
        assert value < (TOLERANCE_MUJOCO if "MuJoCo" in what else TOLERANCE), what
    coupling, shift = tree.coupling(tree.moving)
    return {
        "urdf": tree.urdf.name,
        "made_with": {"pinocchio": pin.__version__, "mujoco": mujoco.__version__, "numpy": np.__version__},
        "checked_with_mujoco": bool(others),
        "coordinates": tree.coordinates,
        "joints": [joint_entry(tree, name) for name in tree.moving],
        "held": tree.held,
        "coupling": coupling.tolist(),
        "offset": shift.tolist(),
        "parameter_order": PARAMETER_ORDER,
        "parameters": [p.tolist() for p in ours.parameters],
        "states": states,
    }


def joint_entry(tree: Tree, name: str) -> dict:
    joint, (master, multiplier, offset) = tree.joints[name], tree.follows[name]
    return {
        "name": name,
        "body": joint.child,
        "kind": MOVING[joint.kind],
        "coordinate": master,
        "multiplier": multiplier,
        "offset": offset,
        "damping": joint.damping,
        "friction": joint.friction,
        "armature": joint.armature,
    }


def write(result: dict, path: Path) -> None:
    # json prints the shortest decimal that reads back as the same double (at most 17 digits).
    path.write_text(json.dumps(result, separators=(",", ":")) + "\n")


PARAMETERS = len(PARAMETER_ORDER)

if __name__ == "__main__":
    options = argparse.ArgumentParser(description="Reference dynamics of trees by Pinocchio, checked with MuJoCo.")
    options.add_argument("urdf", nargs="?", type=Path)
    options.add_argument("--joints", help="coordinates, separated by commas; all others are held")
    options.add_argument("--hold", action="append", default=[], metavar="NAME=VALUE")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--bodies", type=Path, metavar="COPY", help="write a copy with arbitrary bodies and use it")
    options.add_argument("--out", type=Path)
    chosen = options.parse_args()
    if chosen.urdf is None:
        for number_of_model, model_name in enumerate(MODELS):
            source = HERE / f"{model_name}.urdf"
            mjcf = source.with_suffix(".xml")
            result = reference(Tree(source, None, {}), mjcf if mjcf.exists() else None, 100 + number_of_model, True)
            write(result, HERE / f"{model_name}.json")
    else:
        held = {name: float(value) for name, value in (text.rsplit("=", 1) for text in chosen.hold)}
        wanted = chosen.joints.split(",") if chosen.joints else None
        if chosen.bodies:
            add_bodies(chosen.urdf, chosen.bodies, chosen.seed)
            chosen.urdf = chosen.bodies
        result = reference(Tree(chosen.urdf, wanted, held), None, chosen.seed, False)
        write(result, chosen.out or Path(chosen.urdf.stem + ".json"))
