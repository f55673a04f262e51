"""Robots from files and texts, and which of their joints are under study."""

import gc
from pathlib import Path

import numpy as np
import pytest

import tauscope
from conftest import ARM, ROOT

FINGERS = ROOT / "tests" / "reference" / "trees" / "two_finger.urdf"


def test_a_file(arm):
    assert (arm.dof, arm.bodies, arm.name) == (6, 6, "irb1600_6_120")
    assert arm.joint_names == [f"joint_{k}" for k in range(1, 7)]
    assert arm.limits["upper"].shape == (6,) and np.all(arm.limits["lower"] < arm.limits["upper"])
    assert arm.inertial_parameters.shape == (6, 10) and arm.inertial_parameters[0, 0] == 103.8
    assert repr(arm) == "<tauscope.Robot irb1600_6_120: joint_1, joint_2, joint_3, joint_4, joint_5, joint_6>"


def test_a_text(arm, runs):
    own = tauscope.Robot(ARM.read_text())
    assert np.array_equal(own.inertial_parameters, arm.inertial_parameters)
    mujoco = tauscope.Robot((ROOT / "tests" / "reference" / "trees" / "palletiser.xml").read_text())
    assert mujoco.bodies > mujoco.dof > 0
    answers = [tauscope.inspect(runs.training, robot) for robot in (arm, own)]
    assert answers[0].to_json() == answers[1].to_json()
    path = Path(own.path)
    assert path.exists()
    del own, answers
    gc.collect()
    assert not path.exists()


def test_joints_under_study():
    whole = tauscope.Robot(FINGERS)
    some = tauscope.Robot(FINGERS, joints=whole.joint_names[:2])
    assert some.joint_names == whole.joint_names[:2] and set(some.held) > set(whole.joint_names[2:])
    last = whole.joint_names[2]
    placed = tauscope.Robot(FINGERS, joints=whole.joint_names[:2], hold={last: 0.01})
    assert placed.held[last] == 0.01
    assert np.allclose(tauscope.Robot(placed.path).inertial_parameters, placed.inertial_parameters)
    assert tauscope.Robot(placed.to_urdf()).joint_names == placed.joint_names


@pytest.mark.parametrize(
    ("robot", "options", "message"),
    [
        ("nowhere.urdf", {}, "nowhere.urdf: cannot read the URDF"),
        ("<robot name='a'><link/></robot>", {}, "robot:1: <link>: it has no name"),
        ("<html/>", {}, "robot: "),
        (3, {}, "robot: give a path"),
        (ARM, {"joints": ["elbow"]}, "elbow"),
        (ARM, {"joints": "joint_1"}, "joints: give a list of names"),
        (ARM, {"joints": ["joint_1"], "tip": "link_3"}, "tip: give joints or a tip"),
        (ARM, {"hold": {"elbow": 0.0}}, "hold: `elbow` is no joint"),
        (ARM, {"hold": {"joint_1": np.nan}}, "hold: the position of `joint_1`"),
        (ARM, {"gravity": [0.0, 9.81]}, "gravity: give three numbers"),
        (ARM, {"gravity": [0.0, 0.0, np.inf]}, "gravity: give three numbers"),
    ],
)
def test_errors_name_what_is_wrong(robot, options, message):
    with pytest.raises(tauscope.TauscopeError) as refused:
        tauscope.Robot(robot, **options)
    assert message in str(refused.value)
