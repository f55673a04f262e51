"""A robot arm."""

from __future__ import annotations

import os
import tempfile
import weakref
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from . import _tauscope
from ._arrays import numbers, states
from ._tauscope import TauscopeError


class BaseParameters(NamedTuple):
    """The combinations of standard parameters that torque determines: ``sums = matrix @ standard``."""

    standard: list[str]
    """Symbols of the standard parameters, 13 per body: m, mx .. Izz, rotor inertia Ia, friction Fv and Fc."""
    sums: list[str]
    """The base parameters in words, as ``Izz1 + Ia1 + 0.0225 m2``."""
    matrix: np.ndarray
    """One row per base parameter, one column per standard parameter."""


class Robot:
    """A robot arm from a URDF or a MuJoCo model.

    ``robot`` is a path, or the text of such a file. ``joints`` are those under study, all others are held; ``tip`` is the link at the
    end of the arm in their place. ``hold`` says where held joints stand (rad or m). ``gravity`` is in the base frame, m/s2.

    Without ``joints`` and ``tip`` all joints that move by themselves are under study here; the commands take those that the logs name.
    """

    def __init__(
        self,
        robot: str | os.PathLike[str],
        *,
        joints: Sequence[str] | None = None,
        tip: str | None = None,
        hold: Mapping[str, float] | None = None,
        gravity: Sequence[float] | None = None,
    ) -> None:
        if joints is not None and tip is not None:
            raise TauscopeError("tip: give joints or a tip, not both")
        path, self._text = _file(robot)
        self.joints = _names(joints)
        self.tip = tip
        asked = None if gravity is None else _vector(gravity)
        self._asked_gravity = asked
        self._arm = _tauscope.Arm(path, self.joints, tip, dict(hold) if hold else None, asked)
        if hold:
            # The commands take held joints from the file.
            path, self._text = _kept(self._arm.to_urdf())
        self._path = path

    @property
    def path(self) -> str:
        """The file; one of its own where the robot was given as text or joints are held."""
        return self._path

    @property
    def name(self) -> str:
        """Name of the robot."""
        return self._arm.name

    @property
    def dof(self) -> int:
        """Number of joints under study."""
        return self._arm.dof

    @property
    def bodies(self) -> int:
        """Number of moving bodies: one per joint under study, and one per joint that follows another."""
        return self._arm.bodies

    @property
    def joint_names(self) -> list[str]:
        """Names of the joints under study, from base to flange."""
        return self._arm.joint_names

    @property
    def gravity(self) -> np.ndarray:
        """Gravity in the base frame, m/s2."""
        return np.array(self._arm.gravity)

    @property
    def limits(self) -> dict[str, np.ndarray]:
        """Limits of the joints: ``lower``, ``upper``, ``velocity``, ``effort``; infinite where the file has none."""
        return self._arm.limits

    @property
    def drives(self) -> dict[str, np.ndarray]:
        """Friction and rotors as the file has them: ``viscous``, ``coulomb``, ``armature``."""
        return self._arm.drives

    @property
    def held(self) -> dict[str, float]:
        """Joints of the file that stand still, with their positions, rad or m."""
        return self._arm.held

    @property
    def notes(self) -> list[str]:
        """What was read otherwise than it is written, and which joints are held."""
        return self._arm.notes

    @property
    def inertial_parameters(self) -> np.ndarray:
        """Bodies x 10: m, mx, my, mz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the joint frame."""
        return self._arm.inertial_parameters.reshape(-1, 10)

    def inverse_dynamics(
        self, q: Any, qd: Any, qdd: Any, *, inertial_parameters: Any = None, drives: bool = False
    ) -> np.ndarray:
        """Joint torques of many states, samples x joints. The arguments are arrays of samples x joints.

        The torques are those of the rigid bodies; with ``drives`` those of friction and rotors of the file are added.
        ``inertial_parameters`` (bodies x 10) takes the place of the file's.
        """
        given = None
        if inertial_parameters is not None:
            given = np.ascontiguousarray(numbers("inertial_parameters", inertial_parameters)).reshape(-1)
        return self._arm.inverse_dynamics(*self._states(q, qd, qdd), given, drives).T

    def regressor(self, q: Any, qd: Any, qdd: Any, *, out: np.ndarray | None = None) -> np.ndarray:
        """The torque regressor Y of many states, samples x joints x parameters: ``tau = Y @ robot.inertial_parameters.ravel()``.

        In memory the samples of an entry lie behind each other. ``out`` is what an earlier call with as many samples returned: it is
        written over, which saves the system the work of finding new memory.
        """
        q, qd, qdd = self._states(q, qd, qdd)
        samples = len(q)
        shape = (10 * self.bodies, self.dof, samples)
        if out is None:
            table = np.zeros(self._arm.regressor_size(samples))
        else:
            whole = out.T if isinstance(out, np.ndarray) else None
            if whole is None or whole.shape != shape or not whole.flags.c_contiguous or whole.dtype != np.float64:
                raise TauscopeError("out: is no regressor of as many samples that an earlier call returned")
            table = whole.reshape(-1)
        self._arm.regressor(q, qd, qdd, table)
        return table.reshape(shape).T

    def base_parameters(self) -> BaseParameters:
        """What torque can tell of the arm's bodies and drives."""
        return BaseParameters(*self._arm.base_parameters())

    def to_urdf(self) -> str:
        """The joints under study as a URDF: held joints are fixed, links that move as one are merged."""
        return self._arm.to_urdf()

    def to_mjcf(self) -> str:
        """The same as a MuJoCo model, with rotors, friction, gravity and couplings."""
        return self._arm.to_mjcf()

    def describe(self) -> Any:
        """What the file holds, as the command ``tauscope robot`` says it."""
        from ._commands import robot

        return robot(self)

    def _states(self, q: Any, qd: Any, qdd: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return states("q", q, self.dof), states("qd", qd, self.dof), states("qdd", qdd, self.dof)

    def _options(self) -> list[str]:
        """The robot on a command line."""
        options = ["--robot", self._path]
        if self.joints:
            options += ["--joints", ",".join(self.joints)]
        if self.tip is not None:
            options += ["--tip", self.tip]
        if self._asked_gravity is not None:
            options += ["--gravity=" + ",".join(map(repr, self._asked_gravity))]
        return options

    def __repr__(self) -> str:
        return f"<tauscope.Robot {self.name}: {', '.join(self.joint_names)}>"


def _names(joints: Sequence[str] | None) -> list[str] | None:
    if joints is None:
        return None
    if isinstance(joints, str) or not all(isinstance(name, str) for name in joints):
        raise TauscopeError("joints: give a list of names")
    return list(joints) or None


def _vector(gravity: Sequence[float]) -> list[float]:
    vector = numbers("gravity", gravity)
    if vector.shape != (3,):
        raise TauscopeError("gravity: give three numbers in m/s2, in the base frame")
    return [float(value) for value in vector]


def _file(robot: str | os.PathLike[str]) -> tuple[str, Any]:
    """The file of a robot that is given as a path or as text, and what keeps it."""
    if isinstance(robot, str) and "<" in robot:
        _tauscope.check_text(robot)
        return _kept(robot)
    try:
        return os.fspath(robot), None
    except TypeError:
        raise TauscopeError("robot: give a path, or the text of a URDF or MuJoCo model") from None


class _Kept:
    """A file that is there as long as this is."""

    def __init__(self, text: str) -> None:
        folder = tempfile.TemporaryDirectory(prefix="tauscope_")
        weakref.finalize(self, folder.cleanup)
        self.path = str(Path(folder.name) / "robot.urdf")
        Path(self.path).write_text(text, encoding="utf-8")


def _kept(text: str) -> tuple[str, _Kept]:
    kept = _Kept(text)
    return kept.path, kept
