"""Every command has its Python call, and both give the same numbers, from files and from arrays."""

import json

import numpy as np
import pytest

import tauscope
from conftest import ARM, PAYLOAD, ROOT, SHORT

CANDIDATES = ["stribeck_friction", "torque_offset"]
CLOCKS = {"seconds", "median_seconds", "file", "folder", "log", "logs", "baseline"}


def without(value, keys):
    """A document without the fields that say how long it took, and where files are."""
    if isinstance(value, dict):
        return {key: without(one, keys) for key, one in value.items() if key not in keys}
    return [without(one, keys) for one in value] if isinstance(value, list) else value


def arrays(path, robot=None):
    log = tauscope.Log.read(path, robot)
    return {"t": log.t, "q": log.q, "qd": log.qd, "tau": log.tau}


def test_simulate(folder, runs):
    for log, file in [(runs.training, "recording"), (runs.held_out, "held_out")]:
        for ending in ["csv", "parquet"]:
            read = tauscope.Log.read(folder / f"{file}.{ending}")
            assert all(np.array_equal(getattr(log, name), getattr(read, name)) for name in ["t", "q", "tau"])
            assert np.array_equal(log.truth["qdd"], read.truth["qdd"])
    assert runs.to_urdf() == (folder / "robot.urdf").read_text()
    assert {"recording.csv", "held_out.parquet", "scenario.toml"} <= set(runs.files)


def test_simulate_a_dictionary(runs):
    scenario = tauscope.read_scenario(SHORT)
    same = tauscope.simulate(scenario)
    assert np.array_equal(same.training.tau, runs.training.tau)
    scenario["effect"] = [{"name": "stribeck_friction", "joint": "joint_2"}]
    other = tauscope.simulate(scenario)
    differ = np.abs(other.training.truth["tau"] - runs.training.truth["tau"]).max(axis=0)
    assert differ[1] > 5.0 > 1.0 > differ[3]


def test_identify(command, folder, arm, tmp_path):
    logs = [folder / "recording.parquet", folder / "held_out.parquet"]
    effect = "stribeck_friction:joint_2"
    wanted = command(
        "identify", "--robot", ARM, "--train", logs[0], "--test", logs[1], "--effect", effect, "--out", tmp_path / "out"
    )
    from_files = tauscope.identify(arm, logs[0], [logs[1]], effects=effect)
    assert from_files.to_dict() == wanted
    assert from_files.to_json() == (tmp_path / "out" / "identification.json").read_text()
    assert from_files.to_urdf() == (tmp_path / "out" / "identified.urdf").read_text()
    from_arrays = tauscope.identify(arm, arrays(logs[0]), tauscope.Log(**arrays(logs[1])), effects=[effect])
    assert without(from_arrays.to_dict(), {"notes"}) == without(wanted, {"notes"})
    assert from_arrays.without_effects.parameters[0].value == wanted["without_effects"]["parameters"][0]["value"]


def test_diagnose(command, folder, runs, arm, tmp_path):
    logs = [folder / "recording.parquet", folder / "held_out.parquet"]
    out = tmp_path / "out"
    wanted = command(
        *["diagnose", "--robot", ARM, "--train", logs[0], "--test", logs[1], "--seed", "3", "--no-resimulation"],
        *["--candidates", ",".join(CANDIDATES), "--out", out],
    )
    options = {"candidates": CANDIDATES, "seed": 3, "resimulation": False}
    from_files = tauscope.diagnose(arm, logs[0], logs[1], **options)
    assert from_files.to_dict() == wanted
    from_arrays = tauscope.diagnose(ARM, [runs.training], [runs.held_out], **options)
    assert without(from_arrays.to_dict(), {"log"}) == without(wanted, {"log"})
    assert from_arrays.to_urdf() == (out / "extended.urdf").read_text()
    assert "tauscope" in from_arrays._repr_html_() and from_arrays._repr_html_().startswith("<iframe srcdoc=")


def test_inspect(command, arm):
    arm = tauscope.Robot(PAYLOAD / "arm.urdf")
    log = PAYLOAD / "before.csv"
    wanted = command("inspect", log, "--robot", PAYLOAD / "arm.urdf")
    assert tauscope.inspect(log, arm).to_dict() == wanted
    own = tauscope.Log.read(log, arm)
    assert own.joints == arm.joint_names
    assert without(tauscope.inspect(own, arm).to_dict(), {"log"}) == without(wanted, {"log"})


def test_a_log_that_cannot_be_used_is_refused_with_its_report(arm, runs):
    log = runs.training
    still = tauscope.Log(t=log.t, q=np.tile(log.q[0], (len(log), 1)), tau=log.tau, name="parked")
    with pytest.raises(tauscope.TauscopeError, match="<parked>.*cannot be used") as refused:
        tauscope.inspect(still, arm)
    assert refused.value.answer.usable is False


def test_payload(command, tmp_path):
    files = [PAYLOAD / "before.csv", PAYLOAD / "after.csv"]
    arm = tauscope.Robot(PAYLOAD / "arm.urdf")
    wanted = command("payload", *files, "--robot", arm.path, "--expect", "1.5", "--out", tmp_path)
    found = tauscope.payload(arm, *files, expect=1.5)
    assert found.to_dict() == wanted
    assert found.code == 0
    from_arrays = tauscope.payload(arm, *(tauscope.Log.read(file, arm) for file in files), expect=3.0)
    assert from_arrays.mass_kg.value == wanted["mass_kg"]["value"]
    assert from_arrays.code == 1
    with pytest.raises(tauscope.TauscopeError, match="^after: give at least one log") as refused:
        tauscope.payload(arm, files[0])
    assert refused.value.answer is None


def test_excite(command, tmp_path):
    options = ["--evaluations", "200", "--kind", "fourier", "--duration", "6"]
    wanted = command("excite", SHORT, *options, "--out", tmp_path)
    found = tauscope.excite(SHORT, evaluations=200, kind="fourier", duration=6.0)
    assert without(found.to_dict(), CLOCKS) == without(wanted, CLOCKS)
    assert found.file("motion.toml").read_text() == (tmp_path / "motion.toml").read_text()


def test_run(command, tmp_path):
    wanted = command("run", SHORT, "--seed", "5", "--out", tmp_path)
    found = tauscope.run(SHORT, seed=5)
    assert without(found.to_dict(), CLOCKS) == without(wanted, CLOCKS)
    assert "report.html" in found.files


def test_montecarlo(command, tmp_path):
    scenario = ROOT / "tests" / "scenarios" / "montecarlo.toml"
    wanted = command("montecarlo", scenario, "--trials", "3", "--estimators", "ols,wls", "--noise-levels", "1e-5,1e-4:0.5", "--out", tmp_path)
    found = tauscope.montecarlo(scenario, trials=3, estimators=["ols", "wls"], noise_levels=[1e-5, (1e-4, 0.5)])
    assert without(found.to_dict(), CLOCKS) == without(wanted, CLOCKS)


def test_montecarlo_in_parts(command, tmp_path):
    scenario = ROOT / "tests" / "scenarios" / "montecarlo.toml"
    wanted = command("montecarlo", scenario, "--trials", "3", "--estimators", "ols", "--shard", "1/2", "--out", tmp_path / "wanted")
    options = dict(trials=3, estimators=["ols"])
    found = tauscope.montecarlo(scenario, shard=(1, 2), out=tmp_path / "b", **options)
    assert without(found.to_dict(), CLOCKS) == without(wanted, CLOCKS)
    tauscope.montecarlo(scenario, shard="0/2", out=tmp_path / "a", **options)
    merged = tauscope.command("montecarlo", "merge", tmp_path / "a", tmp_path / "b")
    whole = tauscope.montecarlo(scenario, **options)
    assert without(merged.to_dict(), CLOCKS) == without(whole.to_dict(), CLOCKS)
    for refused, words in [(dict(shard=(2, 2)), "no part 2 of 2"), (dict(shard=(1,)), "shard: give"), (dict(shards=2), "no part of an array job")]:
        with pytest.raises(tauscope.TauscopeError, match=words):
            tauscope.montecarlo(scenario, **refused, **options)


def test_check(command, tmp_path):
    baseline = tmp_path / "baseline.json"
    command("check", SHORT, "--baseline", baseline, "--update", "--trials", "2")
    wanted = command("check", SHORT, "--baseline", baseline, codes=(0, 1))
    found = tauscope.check(SHORT, baseline)
    assert without(found.to_dict(), CLOCKS) == without(wanted, CLOCKS)
    again = tauscope.check(SHORT, tmp_path / "other.json", update=True, trials=2)
    assert again.to_dict() == json.loads(baseline.read_text())


def test_blind(command, tmp_path):
    # An arm of one joint with limits, which a blind motion needs.
    urdf = (ROOT / "tests" / "reference" / "pendulum.urdf").read_text()
    urdf = urdf.replace("continuous", "revolute").replace("<limit ", '<limit lower="-3" upper="3" ')
    (tmp_path / "arm.urdf").write_text(urdf)
    scenario = tmp_path / "scenario.toml"
    text = (ROOT / "tests" / "scenarios" / "pendulum.toml").read_text()
    scenario.write_text(text.replace("../reference/pendulum.urdf", "arm.urdf"))
    effect = "torque_offset:pivot"
    options = ["--effect", effect, "--runs", "1", "--severity", "3", "--correlation", "0"]
    wanted = command("blind", "--scenario", scenario, *options, "--out", tmp_path / "out")
    found = tauscope.blind(scenario, effect=effect, runs=1, severity=3.0, correlation=[0.0])
    assert without(found.to_dict(), CLOCKS) == without(wanted, CLOCKS)
    assert found.classes[0].failed == 0 and len(found.runs) == 1


def test_effects_and_robot(command, arm):
    assert tauscope.effects().to_dict() == command("effects")
    assert tauscope.effects("backlash").effects[0].name == "backlash"
    assert arm.describe().to_dict() == command("robot", ARM)


def test_paper(command, tmp_path):
    scenario = ROOT / "scenarios" / "paper.toml"
    wanted = command("paper", scenario, "--out", tmp_path)
    found = tauscope.paper(scenario)
    assert without(found.to_dict(), CLOCKS) == without(wanted, CLOCKS)
    assert found.file("figure_7_torque.svg").read_text() == (tmp_path / "figure_7_torque.svg").read_text()


def test_view_and_any_command():
    with pytest.raises(tauscope.TauscopeError, match="is not there"):
        tauscope.view("nowhere")
    assert tauscope.command("effects", "backlash").to_dict() == tauscope.effects("backlash").to_dict()
