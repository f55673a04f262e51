"""Arguments as arrays. Arrays of doubles are taken as they are; others are converted."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._tauscope import TauscopeError


def numbers(name: str, value: Any) -> np.ndarray:
    """An array of doubles."""
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "fiub":
            raise TypeError(f"holds {array.dtype.name}")
        return array.astype(np.float64, copy=False)
    except (TypeError, ValueError) as problem:
        raise TauscopeError(f"{name}: is no array of numbers: {problem}") from None


def states(name: str, value: Any, joints: int | None) -> np.ndarray:
    """An array of samples x joints; of an arm with one joint the samples alone will do."""
    array = numbers(name, value)
    if array.ndim == 1 and joints in (None, 1):
        array = array[:, np.newaxis]
    if array.ndim != 2:
        wanted = "samples x joints" if joints is None else f"samples x {joints} joints"
        raise TauscopeError(f"{name}: has {array.ndim} dimensions; give an array of {wanted}")
    return array
