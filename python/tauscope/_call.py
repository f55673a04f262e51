"""From arguments of Python to a command and back to an answer."""

from __future__ import annotations

import os
import tempfile
import warnings
from pathlib import Path
from typing import Any, Iterable, Mapping, Sequence, Union

from . import _scenario, _tauscope
from ._answer import Answer, Folder
from ._log import Log
from ._robot import Robot
from ._tauscope import TauscopeError

PathLike = Union[str, "os.PathLike[str]"]
AnyRobot = Union[Robot, PathLike]
AnyLog = Union[Log, PathLike, Mapping[str, Any]]
Logs = Union[AnyLog, Sequence[AnyLog]]
Scenario = Union[PathLike, Mapping[str, Any], Answer]


PARTS = ("t", "q", "qd", "qdd", "tau", "joints", "name")
"""What a log has where it is given as a dictionary."""


class Call:
    """A command in the making."""

    def __init__(self, command: str, *arguments: str) -> None:
        self.command = command
        self.arguments = [command, *arguments]
        self.kept: list[Any] = []
        self.names: dict[str, str] = {}
        self.scratch: tempfile.TemporaryDirectory[str] | None = None

    def robot(self, robot: AnyRobot | None) -> None:
        """The arm."""
        if robot is None:
            return
        if not isinstance(robot, Robot):
            robot = Robot(robot)
        if robot._text is not None:
            self.names[robot.path] = "robot"
        self.kept.append(robot)
        self.arguments += robot._options()

    def logs(self, name: str, logs: Logs | None) -> list[str]:
        """Where the command finds logs."""
        if logs is None:
            return []
        if isinstance(logs, (Log, str, os.PathLike, Mapping)):
            logs = [logs]
        if not isinstance(logs, Iterable):
            raise _no_log(name, logs)
        return [self._log(name, log) for log in logs]

    def _log(self, name: str, log: AnyLog) -> str:
        if isinstance(log, Mapping):
            unknown = [key for key in log if key not in PARTS]
            if unknown:
                raise TauscopeError(f"{name}: a log has no `{unknown[0]}`; it has {', '.join(PARTS)}")
            if missing := [key for key in ("t", "q") if key not in log]:
                raise TauscopeError(f"{name}: `{missing[0]}` is missing")
            log = Log(**log)
        if not isinstance(log, Log):
            try:
                return os.fspath(log)
            except TypeError:
                raise _no_log(name, log) from None
        held = log._hold(name if log.name == "log" else None)
        self.kept.append(held)
        return str(held.path)

    def scenario(self, scenario: Scenario) -> str:
        """The file of a scenario."""
        # An answer is a mapping, too.
        if isinstance(scenario, Answer):
            for name in ("extended.toml", "scenario.toml"):
                if name in scenario.files:
                    return str(scenario.file(name))
            raise TauscopeError(f"scenario: `{scenario.command}` wrote none")
        if self.scratch is None:
            self.scratch = tempfile.TemporaryDirectory(prefix="tauscope_")
        path = _scenario.written(scenario, Path(self.scratch.name))
        if isinstance(scenario, Mapping):
            self.names[path] = "scenario"
        return path

    def options(self, **options: Any) -> None:
        """Options of the command by their names; what is None or False is left out."""
        for name, value in options.items():
            flag = "--" + name.replace("_", "-")
            if value is None or value is False:
                continue
            if value is True:
                self.arguments.append(flag)
            elif isinstance(value, (list, tuple)):
                if value:
                    self.arguments.append(f"{flag}={','.join(map(_word, value))}")
            else:
                self.arguments.append(f"{flag}={_word(value)}")

    def repeated(self, flag: str, values: Sequence[str]) -> None:
        """An option once for each value."""
        self.arguments += [f"{flag}={value}" for value in values]

    def run(self, out: PathLike | None = None, seed: int | None = None, answer: type[Answer] = Answer) -> Any:
        """Runs the command."""
        self.options(seed=seed)
        folder = Folder(out)
        arguments = [*self.arguments, f"--out={folder.path}"]
        try:
            found = _tauscope.call(arguments, folder.path if folder.is_own else None)
        finally:
            # Names of logs are free again, whatever keeps this frame alive.
            self.kept.clear()
            if self.scratch is not None:
                self.scratch.cleanup()
        code, document, text, error, told = found
        for line in told:
            warnings.warn(self._named(line), stacklevel=3)
        made = answer(self.command, code, document, text and self._named(text), folder)
        if error is not None:
            raised = TauscopeError(self._named(error))
            # A log that cannot be used is refused after the report on it.
            raised.answer = made if document else None
            try:
                raise raised
            finally:
                # Else the error and this frame would keep each other, and the answer's files.
                del raised
        return made

    def _named(self, text: str) -> str:
        for path, name in self.names.items():
            text = text.replace(path, name)
        return text


def _no_log(name: str, value: Any) -> TauscopeError:
    return TauscopeError(f"{name}: give a Log, a path, or a list of them, not {type(value).__name__}")


def _word(value: Any) -> str:
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, (list, tuple)):
        return ":".join(map(_word, value))
    return repr(float(value)) if isinstance(value, float) else str(value)
