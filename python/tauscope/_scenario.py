"""Scenarios: what to simulate, as files or as dictionaries of the same keys."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Mapping

from . import _tauscope
from ._tauscope import TauscopeError

Scenario = "str | os.PathLike[str] | Mapping[str, Any]"


def read_scenario(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Reads a scenario file as a dictionary that can be changed and given to the commands; files in it get absolute paths."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as problem:
        raise TauscopeError(f"{path}: cannot read the scenario: {problem.strerror}") from None
    scenario = json.loads(_tauscope.from_toml(text))
    for table, key in [("robot", "urdf"), ("motion", "file"), ("held_out", "file")]:
        part = scenario.get(table)
        if isinstance(part, dict) and isinstance(part.get(key), str):
            part[key] = str((path.parent / part[key]).resolve())
    return scenario


def written(scenario: Any, folder: Path) -> str:
    """The file of a scenario; one in ``folder`` where it is a dictionary."""
    if not isinstance(scenario, Mapping):
        try:
            return os.fspath(scenario)
        except TypeError:
            raise TauscopeError("scenario: give a path, or a dictionary as read_scenario returns it") from None
    plain = dict(scenario)
    robot = plain.get("robot")
    if isinstance(robot, Mapping) and isinstance(robot.get("urdf"), os.PathLike):
        plain["robot"] = {**robot, "urdf": os.fspath(robot["urdf"])}
    try:
        text = _tauscope.to_toml(json.dumps(plain, default=_number))
    except TypeError as problem:
        raise TauscopeError(f"scenario: {problem}") from None
    path = folder / "scenario_given.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def _number(value: Any) -> Any:
    """Numbers and arrays of numpy as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"`{value!r}` has no place in a scenario")
