"""Answers of commands: the fields of their JSON as attributes, and the files that they write."""

from __future__ import annotations

import html
import json
import os
import shutil
import tempfile
import weakref
from pathlib import Path
from typing import Any, Iterator, Mapping

from ._log import Log
from ._tauscope import TauscopeError

URDFS = ("extended.urdf", "identified.urdf", "robot.urdf")
MODELS = ("extended.xml", "identified.xml")
"""Robots that commands write, as URDF and for MuJoCo, the most telling first."""

PAGE = "report.html"


class Node(Mapping[str, Any]):
    """An object of a JSON document: its fields are attributes, and keys in brackets as well."""

    def __init__(self, fields: dict[str, Any]) -> None:
        self._fields = fields

    def __getattr__(self, name: str) -> Any:
        # Names of Python's own, which a copy is asked for before it has fields.
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._fields:
            return _seen(self._fields[name])
        raise AttributeError(f"there is no `{name}`; there are {', '.join(self._fields)}")

    def __getitem__(self, key: str) -> Any:
        return _seen(self._fields[key])

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._fields})

    def to_dict(self) -> dict[str, Any]:
        """A copy in dictionaries and lists."""
        return json.loads(json.dumps(self._fields))

    def frames(self) -> dict[str, Any]:
        """Its tables as pandas frames: every list of objects by its name, those of objects inside behind a dot."""
        import pandas

        return {name: pandas.json_normalize(rows) for name, rows in _tables(self._fields)}

    def __repr__(self) -> str:
        return json.dumps(self._fields, indent=1)


class Answer(Node):
    """What a command found.

    The fields of the command's JSON are attributes. ``str(answer)`` is what the command prints. In a notebook it shows its report.
    """

    def __init__(self, command: str, code: int, document: str | None, text: str | None, folder: Folder) -> None:
        super().__init__(json.loads(document) if document else {})
        self._command = command
        self._document = document or ""
        self._text = "\n".join(line for line in (text or "").splitlines() if not line.startswith(PLACES)).strip()
        self._folder = folder
        self._code = code

    @property
    def command(self) -> str:
        """The command that found it."""
        return self._command

    @property
    def code(self) -> int:
        """Exit code of the command: 0 done, 1 a check failed, 2 bad input."""
        return self._code

    @property
    def files(self) -> list[str]:
        """Names of the files that the command writes."""
        return self._folder.names()

    def file(self, name: str) -> Path:
        """The place of one of the files; it is there as long as the answer is."""
        return self._folder.file(name)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Copies all files to a folder, as ``--out`` of the command writes them."""
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        for name in self.files:
            place = target / name
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(self.file(name), place)
        return target

    def to_json(self) -> str:
        """The JSON text of the command, byte for byte."""
        return self._document

    def to_urdf(self) -> str:
        """The robot that the command writes: identified, extended by what was found, or as simulated."""
        return self._robot("to_urdf", URDFS)

    def to_mjcf(self) -> str:
        """The same as a MuJoCo model, with rotors, friction, gravity and couplings."""
        return self._robot("to_mjcf", MODELS)

    def _robot(self, asked: str, names: tuple[str, ...]) -> str:
        written = [name for name in names if name in self.files]
        if not written:
            raise TauscopeError(f"{asked}: `{self._command}` writes no robot here")
        return self.file(written[0]).read_text(encoding="utf-8")

    def to_html(self) -> str | None:
        """The report as a page of its own, where the command writes one."""
        return self.file(PAGE).read_text(encoding="utf-8") if PAGE in self.files else None

    def plot(self) -> Any:
        """A figure of the errors of every joint."""
        from ._plots import errors

        return errors(self)

    def __str__(self) -> str:
        return self._text or json.dumps(self._fields, indent=1)

    def __repr__(self) -> str:
        return f"<tauscope.Answer of {self._command}: {', '.join(self._fields)}>"

    def _repr_html_(self) -> str:
        page = self.to_html()
        if page is None:
            return f"<pre>{html.escape(str(self))}</pre>"
        return f'<iframe srcdoc="{html.escape(page)}" style="width: 100%; height: 40em; border: 0"></iframe>'


class Simulated(Answer):
    """The two logs of a scenario, with the truth behind them."""

    @property
    def training(self) -> Log:
        """The log of the motion that is identified from."""
        return self._log("recording.parquet", "training")

    @property
    def held_out(self) -> Log:
        """The log of the motion that a model is judged by."""
        return self._log("held_out.parquet", "held out")

    def plot(self) -> Any:
        """A figure of the torques of the training log."""
        return self.training.plot()

    def _log(self, file: str, name: str) -> Log:
        log = Log.read(self.file(file))
        log.name = name
        return log


PLACES = ("Results in ", "Recordings in ", "Motion in ", "Tables, figures and numbers in ", "A corrected description is in ")
"""Lines that name a folder, which may not outlive the answer."""


class Folder:
    """A folder of results: the user's, or one that goes with the answer."""

    def __init__(self, path: str | os.PathLike[str] | None) -> None:
        self.is_own = path is None
        if path is None:
            self.path = Path(tempfile.mkdtemp(prefix="tauscope_"))
            weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)
        else:
            self.path = Path(path)

    def __deepcopy__(self, memo: dict[int, Any]) -> Folder:
        # Copies of an answer share its files.
        return self

    def names(self) -> list[str]:
        """The files of the command in it."""
        manifest = self.path / "manifest.json"
        if manifest.is_file():
            return list(json.loads(manifest.read_text(encoding="utf-8"))["files"])
        if self.path.is_dir():
            return sorted(str(file.relative_to(self.path)) for file in self.path.rglob("*") if file.is_file())
        return [self.path.name] if self.path.is_file() else []

    def file(self, name: str) -> Path:
        """The place of a file."""
        place = self.path if self.path.is_file() and name == self.path.name else self.path / name
        if not place.is_file():
            raise TauscopeError(f"file: there is no `{name}`; there are {', '.join(self.names()) or 'none'}")
        return place


def _seen(value: Any) -> Any:
    if isinstance(value, dict):
        return Node(value)
    if isinstance(value, list):
        return [_seen(one) for one in value]
    return value


def _tables(fields: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, list[dict[str, Any]]]]:
    for name, value in fields.items():
        if isinstance(value, dict):
            yield from _tables(value, f"{prefix}{name}.")
        elif isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
            yield f"{prefix}{name}", value
