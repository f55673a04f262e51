"""Answers: attributes, files, frames, figures."""

import copy
import pickle

import pytest

import tauscope
from tauscope import Node


@pytest.fixture(scope="module")
def answer(runs):
    from conftest import ARM

    return tauscope.identify(ARM, runs.training, runs.held_out)


def test_fields_are_attributes(answer):
    assert answer.schema == "tauscope.identify/1" and answer.code == 0 and answer.command == "identify"
    assert answer.without_effects.parameters[3].name == answer["without_effects"]["parameters"][3]["name"]
    assert "without_effects" in dir(answer) and list(answer)[0] == "schema"
    with pytest.raises(AttributeError, match="there is no `findings`; there are schema, robot"):
        answer.findings
    table = str(answer)
    assert "residual rms, N m" in table and "Results in" not in table
    assert table in answer._repr_html_().replace("&lt;", "<").replace("&gt;", ">").replace("&#x27;", "'")


def test_nodes_are_plain_values():
    node = Node({"a": {"b": [1, {"c": None}]}})
    assert node.a.b[1].c is None and node.to_dict() == {"a": {"b": [1, {"c": None}]}}
    assert copy.deepcopy(node).a.b[0] == 1 and pickle.loads(pickle.dumps(node)) == node


def test_files_can_be_saved(answer, tmp_path):
    # A wheel with the command writes a recording for the viewer, too.
    files = set(answer.files) - {"recording.rrd"}
    assert files == {"identified.urdf", "identified.xml", "identification.json"}
    answer.save(tmp_path / "kept")
    assert (tmp_path / "kept" / "identified.urdf").read_text() == answer.to_urdf()
    assert tauscope.Robot(answer.to_urdf()).dof == 6
    assert tauscope.Robot(answer.to_mjcf()).dof == 6
    with pytest.raises(tauscope.TauscopeError, match="file: there is no `x`; there are identif"):
        answer.file("x")


def test_a_folder_of_ones_own(runs, arm, tmp_path):
    found = tauscope.identify(arm, runs.training, out=tmp_path / "mine")
    place = found.file("identified.urdf")
    del found
    assert place == tmp_path / "mine" / "identified.urdf" and place.exists()


def test_frames(answer):
    pytest.importorskip("pandas")
    frames = answer.frames()
    assert list(frames["without_effects.parameters"].columns[:3]) == ["name", "unit", "value"]
    assert len(frames["without_effects.parameters"]) == len(answer.without_effects.parameters)


def test_plots(answer, runs):
    pytest.importorskip("matplotlib")
    assert len(answer.plot().axes[0].containers) == 2
    assert len(runs.training.plot("q").axes) == 6
    with pytest.raises(tauscope.TauscopeError, match="^signal: there is no `x`; there are q"):
        runs.training.plot("x")


def test_wrong_options_are_refused(runs, arm):
    for options, message in [
        ({"trust": "blindly"}, "arguments: invalid value 'blindly' for '--trust"),
        ({"alpha": 2.0}, "--alpha: is 2; give a probability"),
        ({"candidates": "stribeck_friction"}, "candidates: give a list"),
        ({"candidates": ["stribek_friction"]}, "stribeck_friction"),
        ({"budget": -1}, "--budget"),
        ({"scenario": 3}, "scenario: give a path"),
        ({"scenario": {"name": object()}}, "scenario: "),
        ({"scenario": {"name": "x"}}, "scenario:1: schema: missing field"),
    ]:
        with pytest.raises(tauscope.TauscopeError) as refused:
            tauscope.diagnose(arm, runs.training, **options)
        assert message in str(refused.value)
