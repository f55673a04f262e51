"""Figures, where matplotlib is there."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._tauscope import TauscopeError

ERRORS: dict[str, list[tuple[str, tuple[str, ...]]]] = {
    "diagnose": [
        ("as described", ("simulation", "test_rms_nm")),
        ("re-identified", ("baseline", "test_rms_nm")),
        ("with findings", ("extended", "test_rms_nm")),
        ("noise", ("noise_floor_nm",)),
    ],
    "identify": [
        ("training", ("without_effects", "train_rms_nm")),
        ("held-out", ("without_effects", "test_rms_nm")),
        ("held-out with effects", ("with_effects", "test_rms_nm")),
    ],
}
"""Errors per joint in the answers of the commands."""


def signals(log: Any, signal: str) -> Any:
    """One signal of all joints over time."""
    names = {"q": "position", "qd": "velocity", "qdd": "acceleration", "tau": "torque"}
    values = getattr(log, signal, None) if signal in names else None
    if values is None:
        there = [name for name in names if getattr(log, name) is not None]
        raise TauscopeError(f"signal: there is no `{signal}`; there are {', '.join(there)}")
    figure, axes = _figure(len(log.joints), sharex=True, squeeze=False)
    for axis, joint, column in zip(axes[:, 0], log.joints, values.T):
        axis.plot(log.t, column, linewidth=0.8)
        axis.set_ylabel(joint)
    axes[-1, 0].set_xlabel("time, s")
    figure.suptitle(f"{names[signal]} of {log.name}")
    return figure


def errors(answer: Any) -> Any:
    """Bars of the errors of every joint, over the torque of the joint where it is known."""
    document = answer.to_dict()
    found = []
    for label, path in ERRORS.get(answer.command, []):
        value: Any = document
        for key in path:
            value = value.get(key) if isinstance(value, dict) else None
        if value:
            found.append((label, np.array([np.nan if one is None else one for one in value], dtype=float)))
    if not found:
        raise TauscopeError(f"plot: an answer of `{answer.command}` has no errors per joint")
    figure, axes = _figure(1)
    width = 0.8 / len(found)
    joints = document["joints"]
    for k, (label, values) in enumerate(found):
        axes.bar(np.arange(len(joints)) + (k - 0.5 * (len(found) - 1)) * width, values, width, label=label)
    axes.set_yscale("log")
    axes.set_xticks(range(len(joints)), joints)
    axes.set_ylabel("error of the torque, rms, N m (N)")
    axes.legend()
    return figure


def _figure(rows: int, **options: Any) -> tuple[Any, Any]:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(rows, 1, figsize=(8, max(3.5, 1.4 * rows)), layout="constrained", **options)
    # A notebook shows the figure once: as the answer of the call.
    plt.close(figure)
    return figure, axes
