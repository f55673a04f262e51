"""Logs from arrays."""

import numpy as np
import pytest

import tauscope


def make(**changes):
    arrays = {"t": np.arange(50) * 0.01, "q": np.zeros((50, 6)), "tau": np.zeros((50, 6)), **changes}
    return tauscope.Log(**arrays)


def test_arrays_are_not_copied():
    t, q = np.arange(50) * 0.01, np.zeros((50, 6), order="F")
    log = make(t=t, q=q)
    assert log.t is t and log.q is q and log.qd is None
    assert len(log[10:20]) == 10 and np.shares_memory(log[10:20].q, q)
    assert repr(log) == "<tauscope.Log log: 50 samples, 0.49 s, q, tau of 6 joints>"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"t": np.zeros((50, 1))}, "t: has 2 dimensions"),
        ({"t": "monday"}, "t: is no array of numbers"),
        ({"q": np.zeros((49, 6))}, "q: is 49 x 6; 50 samples (t) x 6 joints (q) are wanted"),
        ({"qd": np.zeros((50, 5))}, "qd: is 50 x 5; 50 samples (t) x 6 joints (q) are wanted"),
        ({"tau": np.zeros((6, 50))}, "tau: is 6 x 50"),
        ({"tau": np.zeros(50)}, "tau: has 1 dimensions"),
        ({"q": np.zeros((50, 0))}, "q: has no joints"),
        ({"joints": ["a"]}, "joints: give a list of 6 names"),
    ],
)
def test_errors_name_the_argument(change, message):
    with pytest.raises(tauscope.TauscopeError) as refused:
        make(**change)
    assert str(refused.value).startswith(message)


def test_messages_name_the_log(arm, runs):
    log = runs.training
    with pytest.raises(tauscope.TauscopeError, match="^<monday>: "):
        tauscope.identify(arm, tauscope.Log(t=log.t, q=log.q, name="monday"))
    with pytest.raises(tauscope.TauscopeError, match="^<train>: "):
        tauscope.identify(arm, {"t": log.t, "q": log.q})
    with pytest.raises(tauscope.TauscopeError, match="^train: give a Log, a path, or a list of them, not int"):
        tauscope.identify(arm, 3)
    with pytest.raises(tauscope.TauscopeError, match="--train: give at least one log"):
        tauscope.identify(arm)
    with pytest.raises(tauscope.TauscopeError, match="^train: a log has no `torque`; it has t, q"):
        tauscope.identify(arm, {"t": log.t, "q": log.q, "torque": log.tau})
    with pytest.raises(tauscope.TauscopeError, match="^train: `q` is missing"):
        tauscope.identify(arm, {"t": log.t})
    with pytest.raises(tauscope.TauscopeError, match="none.csv"):
        tauscope.identify(arm, "none.csv")


def test_rows_that_are_no_numbers_are_left_out(arm, runs):
    log = runs.training
    q = log.q.copy()
    q[100, 2] = np.nan
    found = tauscope.inspect(tauscope.Log(t=log.t, q=q, qd=log.qd, tau=log.tau), arm)
    assert (found.rows, found.rows_rejected) == (len(log) - 1, 1)


def test_columns_in_another_order(arm, runs):
    log, order = runs.training, [3, 1, 2, 0, 5, 4]
    names = [arm.joint_names[k] for k in order]
    parts = {name: getattr(log, name)[:, order] for name in ("q", "qd", "tau")}
    mixed = tauscope.Log(t=log.t, joints=names, **parts)
    plain = [tauscope.inspect(one, arm).to_dict() for one in (log, mixed)]
    assert plain[0]["joints"] == plain[1]["joints"]


def test_as_a_frame(runs):
    pandas = pytest.importorskip("pandas")
    frame = runs.training.frame()
    assert isinstance(frame, pandas.DataFrame) and frame.index.name == "t"
    assert np.array_equal(frame["tau_joint_2"].to_numpy(), runs.training.tau[:, 1])
