"""The product compared with its strongest peers, in turns within one run: CPU time of one thread, medians, ratios.

    python3 benches/peers/compare.py --install VENV [--rounds 9] [--markdown FILE]

`--install VENV` makes a virtual environment there and lets pip install the peers into it (pin, mujoco, figaroh, scipy, numpy and
the Eigen headers); without it the peers of the running Python are measured. Needs cargo and a C++ compiler (CXX, g++ if not
set): Pinocchio's algorithms are compiled here for this machine, with joints specialised by their axis.

Every round runs each peer and the product once, so that all see the same machine; what counts is CPU time (user and system) of
one thread, and of many rounds the median. A ratio is the median of the rounds' ratios: a machine that is slow for a while is so for
both.
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PEERS = Path(__file__).resolve().parent
PACKAGES = ["pin", "cmeel-eigen", "mujoco", "figaroh", "scipy", "numpy"]
URDF = ROOT / "urdf" / "irb1600_6_120.urdf"
ONE_THREAD = {name: "1" for name in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"]}

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("--install", metavar="VENV")
arguments.add_argument("--rounds", type=int, default=9)
arguments.add_argument("--markdown", metavar="FILE")
arguments = arguments.parse_args()

if arguments.install:
    venv = Path(arguments.install).resolve()
    if not (venv / "bin" / "python").exists():
        subprocess.run([sys.executable, "-m", "venv", venv], check=True)
    subprocess.run([venv / "bin" / "pip", "install", "--quiet", *PACKAGES], check=True)
    rest = ["--rounds", str(arguments.rounds)] + (["--markdown", arguments.markdown] if arguments.markdown else [])
    os.execve(venv / "bin" / "python", [str(venv / "bin" / "python"), __file__, *rest], os.environ | ONE_THREAD)

os.environ.update(ONE_THREAD)
import mujoco  # noqa: E402
import numpy as np  # noqa: E402
import pinocchio as pin  # noqa: E402
import scipy.linalg  # noqa: E402
import scipy.signal  # noqa: E402

CMEEL = Path(pin.__file__).parents[4]
model = pin.buildModelFromUrdf(str(URDF))
data = model.createData()
N = model.nv
rng = np.random.default_rng(1)


def cpu_ms(run):
    start = time.process_time()
    result = run()
    return (time.process_time() - start) * 1e3, result


def states(samples):
    return tuple(rng.uniform(-2, 2, (samples, N)) for _ in range(3))


def columns(q, v, a):
    """Pinocchio's regressor of all samples with rotor inertia, viscous and Coulomb friction: [sample, joint, parameter]."""
    table = np.zeros((len(q), N, 13 * N))
    for k in range(len(q)):
        table[k, :, : 10 * N] = pin.computeJointTorqueRegressor(model, data, q[k], v[k], a[k])
    joints = np.arange(N)
    table[:, joints, 10 * N + joints] = a
    table[:, joints, 11 * N + joints] = v
    table[:, joints, 12 * N + joints] = np.sign(v)
    return table


def base(samples=300):
    table = columns(*states(samples)).reshape(samples * N, -1)
    _, r, order = scipy.linalg.qr(table, mode="economic", pivoting=True)
    rank = int(np.sum(np.abs(np.diag(r)) > 1e-8 * abs(r[0, 0])))
    return np.sort(order[:rank])


KEPT = base()
TRUTH = rng.uniform(0.5, 2, len(KEPT))


def identify(q, v, a, tau, solve):
    """Regressor, base columns, ordinary solution, weights per joint, weighted solution."""
    table = columns(q, v, a)[:, :, KEPT]
    rows, right = table.reshape(-1, len(KEPT)), tau.reshape(-1)
    beta = solve(rows, right)
    sigma = np.std((right - rows @ beta).reshape(-1, N), axis=0)
    return solve((table / sigma[None, :, None]).reshape(-1, len(KEPT)), (tau / sigma).reshape(-1))


def lstsq(a, b):
    return np.linalg.lstsq(a, b, rcond=None)[0]


def by_qr(a, b):
    q, r = np.linalg.qr(a)
    return scipy.linalg.solve_triangular(r, q.T @ b)


def normal_equations(a, b):
    return np.linalg.solve(a.T @ a, a.T @ b)


def log(samples):
    q, v, a = states(samples)
    tau = columns(q, v, a)[:, :, KEPT] @ TRUTH + rng.uniform(-1, 1, (samples, N))
    return q, v, a, tau


LONG = log(60_000)
SHORT = log(5_000)
THOUSAND = states(1_000)
WIDE = rng.uniform(-1, 1, (360_000, 60))
SIGNALS = rng.uniform(-1, 1, (N, 60_000))


def smooth(q):
    return [scipy.signal.savgol_filter(q, 31, 4, deriv=d, delta=1e-3, axis=-1) for d in range(3)]


def trial(solve):
    """Noise on positions and torque of 5 s at 1 kHz, smoothing, regressor, solution."""
    q, _, _, tau = SHORT
    measured = q + 1e-5 * rng.standard_normal(q.shape)
    torque = tau + rng.standard_normal(tau.shape)
    q, v, a = (np.ascontiguousarray(x.T) for x in smooth(measured.T))
    return identify(q, v, a, torque, solve)


def objective():
    """Base columns at 1000 points and ln det of their weighted information matrix."""
    table = columns(*THOUSAND)[:, :, KEPT] / np.array([3.0, 4.0, 2.0, 0.45, 0.35, 0.18])[None, :, None]
    rows = table.reshape(-1, len(KEPT))
    return np.linalg.slogdet(rows.T @ rows)


def figaroh(q, v, a, tau):
    """FIGAROH's own path: regressor with rotor and friction columns, base parameters by its double QR, least squares."""
    from types import SimpleNamespace

    from figaroh.tools.qrdecomposition import QRDecomposer
    from figaroh.tools.regressor import build_regressor_basic, build_regressor_reduced, get_index_eliminate

    config = {"is_joint_torques": True, "has_friction": True, "has_actuator_inertia": True, "act_idxv": list(range(N))}
    table = build_regressor_basic(SimpleNamespace(model=model, data=data, nv=N), q, v, a, config)
    standard = {f"p{k}": 1.0 for k in range(table.shape[1])}
    left_out, kept = get_index_eliminate(table, standard, 1e-6)
    table = build_regressor_reduced(table, left_out)
    return QRDecomposer().double_decomposition(tau.T.reshape(-1), table, kept, standard)


def build(directory):
    """Compiles the C++ and C peers; None where that fails."""
    compiler = os.environ.get("CXX", "g++")
    text = ""
    for j in range(1, model.njoints):
        placement, inertia = model.jointPlacements[j], model.inertias[j]
        numbers = [*placement.rotation.flatten(), *placement.translation, inertia.mass, *inertia.lever, *inertia.inertia.flatten()]
        text += " ".join([model.joints[j].shortname()[-1].lower(), *map(repr, map(float, numbers))]) + "\n"
    (directory / "model.txt").write_text(text)
    defines = ["NDEBUG", "BOOST_MPL_LIMIT_LIST_SIZE=30", "BOOST_MPL_LIMIT_VECTOR_SIZE=30",
               "BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "BOOST_FUSION_INVOKE_MAX_ARITY=12"]
    include = [f"-I{CMEEL}/include", f"-I{CMEEL}/include/eigen3"]
    commands = {}
    own = directory / "pinocchio_times"
    done = subprocess.run([compiler, "-std=c++17", "-O3", "-march=native", "-w", *[f"-D{d}" for d in defines], *include, "-o",
                           own, PEERS / "pinocchio.cpp"])
    if done.returncode == 0:
        commands["Pinocchio C++"] = [own, directory / "model.txt", "1"]
    package = Path(mujoco.__file__).parent
    library = next(package.glob("libmujoco.so*"))
    spec = mujoco.MjModel.from_xml_path(str(URDF))
    mujoco.mj_saveLastXML(str(directory / "arm.xml"), spec)
    own = directory / "mujoco_times"
    done = subprocess.run([compiler, "-O3", "-x", "c++", "-w", f"-I{package}/include", "-o", own, PEERS / "mujoco.c", "-x", "none",
                           library, f"-Wl,-rpath,{package}"])
    if done.returncode == 0:
        commands["MuJoCo C"] = [own, directory / "arm.xml", "1"]
    return commands


def numpy_rows():
    rows = {
        "lstsq": lambda: identify(*LONG, lstsq),
        "QR": lambda: identify(*LONG, by_qr),
        "normal equations": lambda: identify(*LONG, normal_equations),
    }
    times = {f"identify 60k, {name}": cpu_ms(run)[0] for name, run in rows.items()}
    times["QR 360k x 60"] = cpu_ms(lambda: np.linalg.qr(WIDE, mode="r"))[0]
    times["Savitzky-Golay"] = statistics.median(cpu_ms(lambda: smooth(SIGNALS))[0] for _ in range(5))
    times["trial"] = statistics.median(cpu_ms(lambda: trial(normal_equations))[0] for _ in range(3))
    times["objective"] = statistics.median(cpu_ms(objective)[0] for _ in range(5))
    return times


def main():
    subprocess.run(["cargo", "build", "--release", "--example", "peer_times"], cwd=ROOT, check=True)
    measured = {}

    def note(prefix, numbers):
        for name, value in numbers.items():
            measured.setdefault(prefix + name, []).append(value)

    with tempfile.TemporaryDirectory() as directory:
        commands = build(Path(directory))
        try:
            note("FIGAROH ", {"identify 60k": cpu_ms(lambda: figaroh(*LONG))[0]})
        except Exception as problem:  # its interface changes from version to version
            print(f"FIGAROH is left out: {problem!r}", file=sys.stderr)
        for round in range(arguments.rounds):
            note("numpy ", numpy_rows())
            for name, command in commands.items():
                done = subprocess.run(command, capture_output=True, text=True, check=True)
                note(name + " ", json.loads(done.stdout))
            own = ROOT / "target" / "release" / "examples" / "peer_times"
            note("", json.loads(subprocess.run([own], capture_output=True, text=True, check=True).stdout))
            print(f"round {round + 1} of {arguments.rounds}, load {os.getloadavg()[0]:.1f}", file=sys.stderr)
    report({name: statistics.median(values) for name, values in measured.items()}, measured)


def report(median, measured):
    lanes = [name.split(", ")[1] for name in median if name.startswith("regressor, ")]
    best = min(lanes, key=lambda lane: median[f"regressor, {lane}, ns"])
    rows = [
        ("regressor 6 x 60, a sample", "ns", "Pinocchio C++ regressor", f"regressor, {best}, ns", "20"),
        ("inverse dynamics, a sample", "ns", "Pinocchio C++ inverse dynamics", f"inverse dynamics, {best}, ns", "15"),
        ("forward dynamics, a state (against mj_forward)", "ns", "MuJoCo C mj_forward", f"forward dynamics, {best}, ns", ""),
        ("forward dynamics, a state, alone", "ns", "MuJoCo C mj_forward", "forward dynamics, scalar, ns", ""),
        ("identify 60k samples, against lstsq", "ms", "numpy identify 60k, lstsq", "identify 60k, ms", "80"),
        ("against QR", "ms", "numpy identify 60k, QR", "identify 60k, ms", ""),
        ("against normal equations", "ms", "numpy identify 60k, normal equations", "identify 60k, ms", "40"),
        ("against FIGAROH", "ms", "FIGAROH identify 60k", "identify 60k, ms", ""),
        ("QR of 360k x 60 (numpy, R only)", "ms", "numpy QR 360k x 60", "TSQR 360k x 60, ms", ""),
        ("QR of the rows of 60k samples, by joint", "ms", "numpy QR 360k x 60", "structured TSQR of 60k, ms", ""),
        ("Savitzky-Golay, signal and two derivatives, 6 x 60k, window 31", "ms", "numpy Savitzky-Golay", "Savitzky-Golay, ms", "15"),
        ("Monte Carlo trial, 5 s at 1 kHz", "ms", "numpy trial", "Monte Carlo trial, ms", "30"),
        ("excitation objective, 1000 given states", "ms", "numpy objective", "excitation objective of given states, ms", "25"),
        ("against own evaluation of the motion too", "ms", "numpy objective", "excitation objective and the motion, ms", ""),
    ]
    processor = platform.processor() or platform.machine()
    for line in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []:
        if line.startswith("model name"):
            processor = line.split(":")[1].strip()
    rustc = subprocess.run(["rustc", "--version"], capture_output=True, text=True).stdout.split()[1]
    compiler = subprocess.run([os.environ.get("CXX", "g++"), "-dumpfullversion"], capture_output=True, text=True).stdout.strip()
    text = f"{processor}, {os.cpu_count()} cores, {best} lanes; rustc {rustc}, {os.environ.get('CXX', 'g++')} {compiler}, "
    text += f"Python {platform.python_version()}, Pinocchio {pin.__version__}, MuJoCo {mujoco.__version__}, numpy {np.__version__}, "
    text += f"scipy {scipy.__version__}; {arguments.rounds} rounds.\n\n"
    text += "| task | peer | time | tauscope | ratio | target |\n|---|---|---|---|---|---|\n"
    for task, unit, peer, own, target in rows:
        if peer in median and own in median:
            # What is measured once, as it takes long, is printed with the median of the others.
            rounds = zip(measured[peer], measured[own]) if len(measured[peer]) > 1 else [(median[peer], median[own])]
            ratio = statistics.median(theirs / ours for theirs, ours in rounds)
            name = peer.removesuffix(" 60k").split(" ")[0] if not peer.startswith(("Pinocchio", "MuJoCo")) else " ".join(peer.split(" ")[:2])
            text += f"| {task} | {name} | {median[peer]:.4g} {unit} | {median[own]:.3g} {unit} | {ratio:.1f} | {target} |\n"
    text += "\nEverything measured, medians with quartiles:\n\n| what | median | quartiles |\n|---|---|---|\n"
    for name, values in sorted(measured.items()):
        low, _, high = statistics.quantiles(values, n=4) if len(values) > 1 else (values[0],) * 3
        unit = "" if name.endswith((" ns", " ms", " x")) else " ns" if name.startswith(("Pinocchio", "MuJoCo")) else " ms"
        text += f"| {name}{unit and ',' + unit} | {statistics.median(values):.4g} | {low:.4g} to {high:.4g} |\n"
    print(text)
    if arguments.markdown:
        Path(arguments.markdown).write_text(text)


main()
