"""While a command works: other threads run, and an interrupt ends it."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import tauscope
from conftest import ARM, PAYLOAD

WAITING = """
import sys, tauscope
print("begun", flush=True)
try:
    tauscope.diagnose(sys.argv[1], sys.argv[2])
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_the_interpreter_runs_on(runs, arm):
    done, count = threading.Event(), 0

    def tick():
        nonlocal count
        while not done.is_set():
            count += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    tauscope.identify(arm, runs.training)
    elapsed = time.monotonic() - start
    done.set()
    thread.join()
    assert count > 100 * elapsed


def test_answers_do_not_depend_on_threads(runs, arm):
    found = [None, None]

    def work(k):
        found[k] = tauscope.inspect([runs.training, runs.held_out][k], arm).to_dict()

    threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    alone = [tauscope.inspect(log, arm).to_dict() for log in (runs.training, runs.held_out)]
    assert [one["joints"] for one in found] == [one["joints"] for one in alone]


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent as Unix has them")
def test_an_interrupt_ends_a_diagnosis(folder):
    words = [sys.executable, "-c", WAITING, ARM, folder / "recording.parquet"]
    with subprocess.Popen(list(map(os.fspath, words)), stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout.readline() == "begun\n"
        time.sleep(1.0)
        start = time.monotonic()
        program.send_signal(signal.SIGINT)
        rest, _ = program.communicate(timeout=20)
        assert rest == "interrupted\n" and program.returncode == 0
        assert time.monotonic() - start < 8.0


def test_the_command_is_there():
    program = Path(sys.executable).with_name("tauscope")
    for words in ([program], [sys.executable, "-m", "tauscope"]):
        done = subprocess.run([*map(os.fspath, words), "--version"], capture_output=True, text=True, check=True)
        assert done.stdout == f"tauscope {tauscope.__version__}\n"
    refused = subprocess.run([os.fspath(program), "inspect", "none.csv"], capture_output=True, text=True, check=False)
    assert refused.returncode == 2 and "none.csv" in refused.stderr


def test_other_libraries_can_be_loaded_after_it():
    """A library that takes the room for static variables of threads keeps OpenMP, and so Pinocchio, from being loaded."""
    words = [sys.executable, "-c", "import tauscope, ctypes, ctypes.util as u; ctypes.CDLL(u.find_library('gomp') or None)"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_warnings_are_pythons(tmp_path):
    header, *rows = (PAYLOAD / "before.csv").read_text().split()
    turned = header.split(",").index("tau_j2")
    cells = [row.split(",") for row in rows]
    lines = [",".join([*row[:turned], str(-float(row[turned])), *row[turned + 1 :]]) for row in cells]
    (tmp_path / "turned.csv").write_text("\n".join([header, *lines]))
    unit = [[float(row == column) for column in range(5)] for row in range(5)]
    dataset = tmp_path / "dataset.toml"
    dataset.write_text(f'schema = "tauscope.dataset/1"\n[[train]]\nfile = "turned.csv"\n[motors]\ncoupling = {unit}\n')
    with pytest.warns(UserWarning, match="corrected.toml is not written"):
        found = tauscope.inspect(tmp_path / "turned.csv", PAYLOAD / "arm.urdf", dataset=dataset)
    assert found.joints[0].name == "j1"
