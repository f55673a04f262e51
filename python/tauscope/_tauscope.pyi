"""The compiled part."""

import os
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__version__: str

class TauscopeError(ValueError):
    """Bad input: the text says what is wrong, where, and what to do."""

    answer: Any

class Arm:
    name: str
    dof: int
    bodies: int
    joint_names: list[str]
    gravity: list[float]
    notes: list[str]
    held: dict[str, float]
    limits: dict[str, Array]
    drives: dict[str, Array]
    inertial_parameters: Array
    def __new__(
        cls,
        path: str | os.PathLike[str],
        joints: Sequence[str] | None = None,
        tip: str | None = None,
        hold: Mapping[str, float] | None = None,
        gravity: Sequence[float] | None = None,
    ) -> Arm: ...
    def to_urdf(self) -> str: ...
    def to_mjcf(self) -> str: ...
    def inverse_dynamics(
        self, q: Array, qd: Array, qdd: Array, inertial: Array | None = None, drives: bool = False
    ) -> Array: ...
    def regressor_size(self, samples: int) -> int: ...
    def regressor(self, q: Array, qd: Array, qdd: Array, out: Array) -> None: ...
    def base_parameters(self) -> tuple[list[str], list[str], Array]: ...

class Held:
    path: str

def check_text(text: str) -> None: ...
def hold(
    name: str,
    joints: Sequence[str],
    t: Array,
    q: Array,
    qd: Array | None = None,
    qdd: Array | None = None,
    tau: Array | None = None,
) -> Held: ...
def read_log(path: str | os.PathLike[str], joints: Sequence[str] | None = None) -> dict: ...
def call(
    arguments: Sequence[str | os.PathLike[str]], out: str | os.PathLike[str] | None = None
) -> tuple[int, str | None, str | None, str | None, list[str]]: ...
def main(arguments: Sequence[str]) -> int: ...
def from_toml(text: str) -> str: ...
def to_toml(text: str) -> str: ...
