"""Inverse dynamics and regressors of arrays of states."""

import json

import numpy as np
import pytest

import tauscope
from conftest import ARM, ROOT


def states(samples, joints=6, seed=1):
    return tuple(np.random.default_rng(seed).uniform(-2, 2, (samples, joints)) for _ in range(3))


@pytest.mark.parametrize("samples", [1, 7, 1000, 5000])
def test_the_regressor_gives_the_torques(arm, samples):
    q, qd, qdd = states(samples)
    table = arm.regressor(q, qd, qdd)
    assert table.shape == (samples, 6, 60)
    torque = arm.inverse_dynamics(q, qd, qdd)
    assert np.allclose(table @ arm.inertial_parameters.ravel(), torque, rtol=1e-10, atol=1e-9)
    other = 2.0 * arm.inertial_parameters
    assert np.allclose(arm.inverse_dynamics(q, qd, qdd, inertial_parameters=other), 2.0 * torque)


def test_a_regressor_may_be_written_over(arm):
    first = arm.regressor(*states(3000))
    kept = first.copy()
    second = arm.regressor(*states(3000, seed=2), out=first)
    assert np.shares_memory(first, second)
    assert np.array_equal(arm.regressor(*states(3000), out=second), kept)
    with pytest.raises(tauscope.TauscopeError, match="^out: "):
        arm.regressor(*states(2999), out=first)
    with pytest.raises(tauscope.TauscopeError, match="^out: "):
        arm.regressor(*states(3000), out=kept)


def test_arrays_of_any_layout(arm):
    q, qd, qdd = states(300)
    wanted = arm.inverse_dynamics(q, qd, qdd)
    wide = np.zeros((300, 12))
    wide[:, ::2] = q
    for same in [np.asfortranarray(q), wide[:, ::2], q[::-1][::-1], q.tolist()]:
        assert np.array_equal(arm.inverse_dynamics(same, qd, qdd), wanted)
    assert np.allclose(arm.inverse_dynamics(q.astype(np.float32), qd, qdd), wanted, rtol=1e-4, atol=1e-3)
    assert arm.inverse_dynamics(q[:0], qd[:0], qdd[:0]).shape == (0, 6)


def test_pinocchios_numbers():
    reference = json.loads((ROOT / "tests" / "reference" / "irb1600_dynamics.json").read_text())
    for state in reference["states"]:
        arm = tauscope.Robot(ARM, gravity=state["gravity"])
        q, qd, qdd = ([state[key]] for key in ("q", "qd", "qdd"))
        assert np.allclose(arm.inverse_dynamics(q, qd, qdd), [state["tau"]], rtol=1e-10, atol=1e-10)
        assert np.allclose(arm.regressor(q, qd, qdd)[0], state["regressor"], rtol=1e-10, atol=1e-10)


def test_drives_and_gravity(arm):
    q, qd, qdd = states(50)
    drives = arm.drives
    friction = drives["armature"] * qdd + drives["viscous"] * qd + drives["coulomb"] * np.sign(qd)
    both = arm.inverse_dynamics(q, qd, qdd, drives=True)
    assert np.allclose(both, arm.inverse_dynamics(q, qd, qdd) + friction)
    floating = tauscope.Robot(ARM, gravity=[0.0, 0.0, 0.0])
    zero = np.zeros_like(q)
    assert np.abs(floating.inverse_dynamics(q, zero, zero)).max() < 1e-12
    assert floating.gravity.tolist() == [0.0, 0.0, 0.0]


def test_base_parameters(arm):
    base = arm.base_parameters()
    assert base.matrix.shape == (52, 78) == (len(base.sums), len(base.standard))
    assert base.standard[:2] == ["m1", "mx1"] and base.sums[0].startswith("Izz1 + Ia1")
    leader = base.standard.index("Izz1")
    assert base.matrix[0, leader] == 1.0
    assert base.matrix[0, base.standard.index("m2")] == pytest.approx(0.0225)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"q": np.zeros((5, 5))}, "q: has 5 columns; give an array of samples x 6 joints"),
        ({"qd": np.zeros((4, 6))}, "qd: has 4 samples; q has 5"),
        ({"qdd": np.zeros(6)}, "qdd: has 1 dimensions; give an array of samples x 6 joints"),
        ({"q": "text"}, "q: is no array of numbers"),
        ({"qd": [[1.0], [1.0, 2.0]]}, "qd: is no array of numbers"),
        ({"inertial_parameters": [1.0]}, "inertial_parameters: has 1 numbers; ten per body are wanted, 60"),
    ],
)
def test_errors_name_the_argument(arm, change, message):
    arguments = {name: np.zeros((5, 6)) for name in ("q", "qd", "qdd")}
    with pytest.raises(tauscope.TauscopeError) as refused:
        arm.inverse_dynamics(**{**arguments, **change})
    assert str(refused.value).startswith(message)
    assert isinstance(refused.value, ValueError)
