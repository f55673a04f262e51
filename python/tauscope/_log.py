"""Logs: signals of an arm over time."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Sequence

import numpy as np

from . import _tauscope
from ._arrays import numbers, states
from ._tauscope import TauscopeError


class Log:
    """Signals of an arm over time, in SI units at the joints: arrays of samples x joints, and ``t`` of the samples.

    The arrays are kept as they are, without a copy where they are of doubles. ``joints`` are the names of the columns; without, they
    are the robot's joints in their order. ``name`` stands for the log in messages. Commands examine a log as they examine a file.
    """

    def __init__(
        self,
        *,
        t: Any,
        q: Any,
        qd: Any = None,
        qdd: Any = None,
        tau: Any = None,
        joints: Sequence[str] | None = None,
        name: str = "log",
    ) -> None:
        self.t = numbers("t", t)
        if self.t.ndim != 1:
            raise TauscopeError(f"t: has {self.t.ndim} dimensions; give the time of every sample, s")
        self.q = states("q", q, None)
        shape = (len(self.t), self.q.shape[1])
        if shape[1] == 0:
            raise TauscopeError("q: has no joints; give an array of samples x joints")
        self.qd = self.qdd = self.tau = None
        for signal, value in [("qd", qd), ("qdd", qdd), ("tau", tau)]:
            if value is not None:
                setattr(self, signal, states(signal, value, shape[1]))
        for signal in ("q", "qd", "qdd", "tau"):
            array = getattr(self, signal)
            if array is not None and array.shape != shape:
                raise TauscopeError(
                    f"{signal}: is {array.shape[0]} x {array.shape[1]}; "
                    f"{shape[0]} samples (t) x {shape[1]} joints (q) are wanted"
                )
        if joints is not None and (isinstance(joints, str) or len(joints) != shape[1]):
            raise TauscopeError(f"joints: give a list of {shape[1]} names")
        self.joints = list(joints) if joints is not None else [f"joint_{k + 1}" for k in range(shape[1])]
        self.name = name
        self.truth: dict[str, np.ndarray] | None = None
        """The signals without noise, ``q``, ``qd``, ``qdd``, ``tau``, of a simulated log."""
        self.notes: list[str] = []
        """What was corrected or left out when the log was read from a file."""

    @classmethod
    def read(cls, path: str | os.PathLike[str], robot: Any = None) -> Log:
        """Reads a log as the commands do: .csv, .parquet, .npz, .mcap, .db3, or the folder of a ROS 2 bag.

        With a ``robot`` it takes that robot's joints in their order, whatever else the file holds.
        """
        found = _tauscope.read_log(os.fspath(path), None if robot is None else robot.joint_names)
        arrays = {name: None if found[name] is None else found[name].T for name in ("q", "qd", "qdd", "tau")}
        log = cls(t=found["t"], joints=found["joints"], name=Path(path).stem, **arrays)
        if "truth" in found:
            log.truth = {name: signals.T for name, signals in found["truth"].items()}
        log.notes = found["notes"]
        return log

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, samples: slice) -> Log:
        """A part of the log: ``log[:1000]``."""
        if not isinstance(samples, slice):
            raise TauscopeError("samples: give a slice, as in log[:1000]")
        parts = {name: self._part(name, samples) for name in ("q", "qd", "qdd", "tau")}
        part = Log(t=self.t[samples], joints=self.joints, name=self.name, **parts)
        part.truth = self.truth and {name: signals[samples] for name, signals in self.truth.items()}
        return part

    def _part(self, name: str, samples: slice) -> np.ndarray | None:
        array = getattr(self, name)
        return None if array is None else array[samples]

    def frame(self) -> Any:
        """The log as a pandas frame with the time as its index."""
        import pandas

        columns = {}
        for name in ("q", "qd", "qdd", "tau"):
            array = getattr(self, name)
            if array is not None:
                columns.update({f"{name}_{joint}": array[:, k] for k, joint in enumerate(self.joints)})
        return pandas.DataFrame(columns, index=pandas.Index(self.t, name="t"))

    def plot(self, signal: str = "tau") -> Any:
        """A figure of one signal of all joints over time."""
        from ._plots import signals

        return signals(self, signal)

    def _hold(self, name: str | None = None) -> _tauscope.Held:
        """The log for a command, as long as what is returned lives."""
        return _tauscope.hold(name or self.name, self.joints, self.t, self.q, self.qd, self.qdd, self.tau)

    def __repr__(self) -> str:
        seconds = float(self.t[-1] - self.t[0]) if len(self.t) > 1 else 0.0
        signals = [name for name in ("q", "qd", "qdd", "tau") if getattr(self, name) is not None]
        return f"<tauscope.Log {self.name}: {len(self)} samples, {seconds:.3g} s, {', '.join(signals)} of {len(self.joints)} joints>"
