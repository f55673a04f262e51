"""What the tests share: small logs, and the command beside the Python call."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import tauscope

ROOT = Path(__file__).resolve().parents[2]
ARM = ROOT / "urdf" / "irb1600_6_120.urdf"
SHORT = ROOT / "tests" / "scenarios" / "short.toml"
PAYLOAD = ROOT / "tests" / "reference" / "payload"


@pytest.fixture(scope="session")
def command():
    """Runs the installed command and returns its JSON."""
    own = Path(sys.executable).with_name("tauscope")
    program = str(own) if own.exists() else shutil.which("tauscope")
    assert program, "the package installs the command"

    def run(*arguments, codes=(0,)):
        words = [program, *map(os.fspath, arguments), "--json"]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        assert done.returncode in codes, done.stderr
        return json.loads(done.stdout) if done.stdout else done.stderr

    return run


@pytest.fixture(scope="session")
def folder(command, tmp_path_factory):
    """Logs of the short scenario, as the command writes them."""
    out = tmp_path_factory.mktemp("simulated") / "logs"
    command("simulate", SHORT, "--out", out)
    return out


@pytest.fixture(scope="session")
def runs():
    """The same logs, as the Python call returns them."""
    return tauscope.simulate(SHORT)


@pytest.fixture
def arm():
    return tauscope.Robot(ARM)
