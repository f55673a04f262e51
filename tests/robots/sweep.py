"""Which public robot files Pinocchio, MuJoCo and tauscope read, and whether they see the same joints.

Run by sweep.sh: python -P sweep.py FOLDER, where FOLDER/packages holds a folder per package. Writes FOLDER/sweep.md and
FOLDER/sweep.json. A robot is a file that Pinocchio (URDF) or MuJoCo (MJCF) reads and that has a joint that turns or slides.
"""

import collections
import dataclasses
import hashlib
import json
import os
import re
import select
import subprocess
import sys
from pathlib import Path

REQUIRED_SHARE = 0.95
TIMEOUT_S = 60.0
# What stands behind this differs in names only; reasons are grouped by what stands before.
REASON_LENGTH = 110
# The table of differences is for looking at, not for keeping: sweep.json has all of them.
DIFFERENCES, DIFFERENCE_LENGTH = 40, 200


@dataclasses.dataclass
class File:
    """A distinct file and what each reader made of it: `read` as printed by `worker`, `ours` as by `tauscope`."""

    package: str
    path: str
    kind: str
    digest: str
    copies: int = 1
    read: dict = dataclasses.field(default_factory=dict)
    ours: dict = dataclasses.field(default_factory=dict)

    @property
    def robot(self) -> bool:
        return bool(self.read.get("joints"))


def robot_files(packages: Path) -> list[File]:
    """All URDF and MJCF files; of equal ones the first, in the order of the packages' names."""
    found: dict[str, File] = {}
    for path in sorted(packages.rglob("*")):
        if path.suffix.lower() not in (".urdf", ".xml") or not path.is_file():
            continue
        content = path.read_bytes()
        kind = "urdf" if path.suffix.lower() == ".urdf" else "mjcf"
        if kind == "mjcf" and not re.search(rb"<mujoco[\s>]", content):
            continue
        digest = hashlib.sha256(content).hexdigest()
        if digest in found:
            found[digest].copies += 1
        else:
            package = path.relative_to(packages).parts[0]
            found[digest] = File(package, str(path), kind, digest)
    return list(found.values())


def read_with_libraries(path: str, kind: str) -> dict:
    """Names of the joints with one degree of freedom as Pinocchio or MuJoCo sees them, or the error."""
    if kind == "urdf":
        import pinocchio

        model = pinocchio.buildModelFromUrdf(path)
        # The first is the universe.
        joints = [name for name, joint in list(zip(model.names, model.joints))[1:] if joint.nv == 1]
        return {"joints": joints}
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    single = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    chosen = [j for j in range(model.njnt) if int(model.jnt_type[j]) in single]
    joints = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, j) or "" for j in chosen]
    answer = {"joints": joints}
    try:
        import pinocchio

        answer["pinocchio_reads"] = pinocchio.buildModelFromMJCF(path).nv > 0
    except Exception as error:  # noqa: BLE001  whatever it refuses with is recorded
        answer["pinocchio_error"] = str(error)[:300]
    return answer


def worker() -> None:
    """Answer a line of JSON for each line "KIND PATH" of the input, on what was standard output at the start."""
    answers = os.fdopen(os.dup(1), "w")
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    for line in sys.stdin:
        kind, path = line.rstrip("\n").split(" ", 1)
        try:
            answer = read_with_libraries(path, kind)
        except Exception as error:  # noqa: BLE001  whatever a library refuses with is recorded
            answer = {"error": str(error)[:500]}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


class Library:
    """A worker process, started again when a file crashes or stalls it."""

    def __init__(self):
        self.process = None

    def read(self, file: File) -> dict:
        if self.process is None or self.process.poll() is not None:
            command = [sys.executable, "-P", __file__, "--worker"]
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.process.stdin.write(f"{file.kind} {file.path}\n")
        self.process.stdin.flush()
        ready, _, _ = select.select([self.process.stdout], [], [], TIMEOUT_S)
        line = self.process.stdout.readline() if ready else ""
        if line:
            return json.loads(line)
        self.process.kill()
        self.process.wait()
        return {"error": "crash" if ready else f"no answer in {TIMEOUT_S:.0f} s"}


def read_with_tauscope(program: str, path: str) -> dict:
    """Joint names and notes; `refused` with the reason for exit code 2, `crash` for everything that is neither."""
    try:
        done = subprocess.run([program, "robot", path, "--json"], capture_output=True, text=True, errors="replace", timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return {"crash": f"no answer in {TIMEOUT_S:.0f} s"}
    if done.returncode == 2:
        lines = done.stderr.strip().splitlines()
        return {"refused": lines[0] if lines else "without a reason"}
    if done.returncode != 0:
        return {"crash": f"exit code {done.returncode}: {done.stderr.strip()[-300:]}"}
    try:
        answer = json.loads(done.stdout)
        names = [joint["name"] for joint in answer["joints"]]
    except (ValueError, KeyError, TypeError) as error:
        return {"crash": f"not the JSON that was expected: {error!r}"}
    return {"joints": names, "notes": answer.get("notes", [])}


def reason(text: str, path: str) -> str:
    """An error without what differs from file to file: paths, names, numbers."""
    text = text.replace(path, "FILE").replace(os.path.basename(path), "FILE")
    text = re.sub(r"^(error: )?(FILE(:\d+)*(, line \d+)?:? *)*", "", " ".join(text.split()))
    text = re.sub(r"\"[^\"]*\"|'[^']*'|`[^`]*`", "…", text)
    text = re.sub(r"\b(joint|link|body|line|element|material|name) (?!with|is|of|has)[\w./:-]*[\w.]", r"\1 …", text)
    text = re.sub(r"\S*/\S*", "…", text)
    return re.sub(r"[-+]?\d[\d.eE+-]*", "N", text)[:REASON_LENGTH]


def differs(file: File) -> str | None:
    """What tauscope sees otherwise than the library, if anything."""
    theirs, ours = file.read["joints"], file.ours["joints"]
    named = sorted(name for name in theirs if name)
    if len(named) == len(theirs) and sorted(ours) != named:
        missing, extra = sorted(set(named) - set(ours)), sorted(set(ours) - set(named))
        return f"joints missing {missing}, extra {extra}"
    if len(ours) != len(theirs):
        return f"{len(ours)} joints instead of {len(theirs)}"
    return None


def share(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f} %" if whole else ""


def table(header: list[str], rows: list[list]) -> list[str]:
    left = [":--", *["--:"] * (len(header) - 1)]
    return ["| " + " | ".join(str(cell) for cell in row) + " |" for row in (header, left, *rows)]


def counts(files: list[File]) -> list:
    """Cells of a row: files, distinct, robots, read by tauscope, share, refused, crashed."""
    robots = [file for file in files if file.robot]
    read = sum("joints" in file.ours for file in robots)
    return [
        sum(file.copies for file in files),
        len(files),
        len(robots),
        read,
        share(read, len(robots)),
        sum("refused" in file.ours for file in robots),
        sum("crash" in file.ours for file in files),
    ]


def reasons(texts: list[tuple[str, str]]) -> list[list]:
    """Rows reason, count, one example, most frequent first; `texts` are pairs of error and path."""
    groups = collections.defaultdict(list)
    for text, path in texts:
        groups[reason(text, path)].append(path)
    ordered = sorted(groups.items(), key=lambda group: (-len(group[1]), group[0]))
    return [[text.replace("|", "\\|"), len(paths), example(paths[0])] for text, paths in ordered]


def example(path: str) -> str:
    parts = Path(path).parts
    return "/".join(parts[parts.index("packages") + 1 :][-3:])


def report(files: list[File]) -> str:
    header = ["files", "distinct", "robots", "tauscope reads", "share", "refuses", "crashes"]
    lines = []
    kinds = [("URDF", "urdf", "Pinocchio"), ("MJCF", "mjcf", "MuJoCo")]
    rows = [[f"{title} ({library})", *counts([f for f in files if f.kind == kind])] for title, kind, library in kinds]
    lines += table(["kind (robots are what this library reads)", *header], rows)
    both = [file for file in files if file.robot and file.read.get("pinocchio_reads")]
    taken = sum("joints" in file.ours for file in both)
    lines += ["", f"Pinocchio reads {len(both)} of the MJCF robots, tauscope {taken} of those."]
    by_package = collections.defaultdict(list)
    for file in files:
        by_package[file.package].append(file)
    lines += ["", *table(["package", *header], [[name, *counts(group)] for name, group in sorted(by_package.items())])]
    robots = [file for file in files if file.robot]
    refused = [(file.ours["refused"], file.path) for file in robots if "refused" in file.ours]
    lines += ["", "Robots that tauscope refuses", "", *table(["reason", "files", "example"], reasons(refused))]
    crashed = [(file.ours["crash"], file.path) for file in files if "crash" in file.ours]
    if crashed:
        lines += ["", "Files that crash tauscope", "", *table(["how", "files", "example"], reasons(crashed))]
    different = [(difference, file.path) for file in robots if "joints" in file.ours and (difference := differs(file))]
    if different:
        rows = [[text[:DIFFERENCE_LENGTH], example(path)] for text, path in different[:DIFFERENCES]]
        title = f"Robots whose joints differ: {len(different)}, of which the first {len(rows)}"
        lines += ["", title, "", *table(["difference", "file"], rows)]
    unread = [(file.read["error"], file.path) for file in files if "error" in file.read]
    taken = sum("error" in file.read and "joints" in file.ours for file in files)
    lines += ["", f"Files that the library does not read ({taken} of them read by tauscope)", ""]
    lines += table(["reason", "files", "example"], reasons(unread))
    return "\n".join(lines) + "\n"


def main(folder: Path) -> int:
    program = os.environ["TAUSCOPE"]
    library, files = Library(), robot_files(folder / "packages")
    # The libraries and the files are pinned: what they read is asked once per folder.
    kept = folder / "libraries.json"
    known = json.loads(kept.read_text()) if kept.exists() else {}
    for number, file in enumerate(files):
        file.read = known[file.digest] = known.get(file.digest) or library.read(file)
        file.ours = read_with_tauscope(program, file.path)
        if sys.stderr.isatty():
            print(f"\r{number + 1} of {len(files)} files", end="", file=sys.stderr)
    kept.write_text(json.dumps(known) + "\n")
    text = report(files)
    (folder / "sweep.md").write_text(text)
    (folder / "sweep.json").write_text(json.dumps([dataclasses.asdict(file) for file in files], indent=1) + "\n")
    print(text)
    robots = [file for file in files if file.robot]
    read = sum("joints" in file.ours for file in robots)
    crashes = sum("crash" in file.ours for file in files)
    print(f"tauscope reads {read} of {len(robots)} robots ({share(read, len(robots))}); {crashes} crashes. Results in {folder}")
    return 0 if robots and read >= REQUIRED_SHARE * len(robots) and not crashes else 1


if __name__ == "__main__":
    if sys.argv[1:] == ["--worker"]:
        worker()
    else:
        sys.exit(main(Path(sys.argv[1])))
