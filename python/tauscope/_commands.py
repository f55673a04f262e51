"""The commands as functions. Options are those of the command line, with underscores; ``tauscope COMMAND --help`` explains them.

``out`` is a folder for the results, as ``--out``; without, they live as long as the answer. ``seed`` is that of every random number.
"""

from __future__ import annotations

import os
from typing import Any, Sequence

from ._answer import Answer, Simulated
from ._call import AnyRobot, Call, Logs, PathLike, Scenario
from ._robot import Robot
from ._tauscope import TauscopeError


def diagnose(
    robot: AnyRobot | None = None,
    train: Logs | None = None,
    test: Logs | None = None,
    *,
    reference: Logs | None = None,
    dataset: PathLike | None = None,
    scenario: Scenario | None = None,
    trust: str = "structure",
    alpha: float = 0.05,
    max_findings: int = 24,
    candidates: Sequence[str] | None = None,
    least_share: float = 2.0,
    budget: float | str | None = None,
    resimulation: bool = True,
    engine: str = "rapier",
    seed: int | None = None,
    out: PathLike | None = None,
) -> Answer:
    """Says from logs what the model of an arm misses: effect, joint, size.

    ``train`` and ``test`` are logs or paths, or lists of them; without ``test`` 30 % of every training log is held out.
    ``reference`` logs are from before a change: the question is then what changed. ``scenario`` is the simulation as it stands: a
    file, a dictionary, or an earlier answer. ``trust`` is "structure" (estimate the inertias) or "nominal" (take them from the robot).
    ``budget`` is the time for the search, s. An interrupt ends the search.
    """
    call = Call("diagnose")
    call.robot(robot)
    for name, logs in [("train", train), ("test", test), ("reference", reference)]:
        call.repeated(f"--{name}", call.logs(name, logs))
    call.options(
        dataset=dataset,
        scenario=None if scenario is None else call.scenario(scenario),
        trust=trust,
        alpha=alpha,
        max_findings=max_findings,
        candidates=_list("candidates", candidates),
        least_share=least_share,
        budget=_time(budget),
        no_resimulation=not resimulation,
        engine=engine,
    )
    return call.run(out, seed)


def identify(
    robot: AnyRobot | None = None,
    train: Logs | None = None,
    test: Logs | None = None,
    *,
    effects: Sequence[str] | str | None = None,
    dataset: PathLike | None = None,
    scenario: Scenario | None = None,
    as_diagnose: bool = False,
    trust: str = "structure",
    window: int | None = None,
    order: int | None = None,
    low_pass_hz: float | None = None,
    block_means_hz: float | list[float] | None = None,
    decimation: int | None = None,
    band: float | None = None,
    seed: int | None = None,
    out: PathLike | None = None,
) -> Answer:
    """Fits an arm's parameters, and named ``effects`` ("NAME" or "NAME:JOINT"), to logs. Without logs those of ``scenario`` are simulated."""
    call = Call("identify")
    call.robot(robot)
    for name, logs in [("train", train), ("test", test)]:
        call.repeated(f"--{name}", call.logs(name, logs))
    call.repeated("--effect", [effects] if isinstance(effects, str) else list(effects or []))
    call.options(
        dataset=dataset,
        scenario=None if scenario is None else call.scenario(scenario),
        as_diagnose=as_diagnose,
        trust=trust,
        window=window,
        order=order,
        low_pass_hz=low_pass_hz,
        block_means_hz=block_means_hz,
        decimation=decimation,
        band=band,
    )
    return call.run(out, seed)


def inspect(
    logs: Logs,
    robot: AnyRobot | None = None,
    *,
    dataset: PathLike | None = None,
    convert: PathLike | None = None,
    out: PathLike | None = None,
) -> Answer:
    """Checks logs for faults: clock, bad rows, channels, units, signs, range, dead time.

    A log that cannot be used raises a :class:`TauscopeError` whose ``answer`` has the report. ``convert`` writes the usable rows of one
    log to a file.
    """
    call = Call("inspect")
    call.robot(robot)
    call.options(dataset=dataset, convert=convert)
    call.arguments += call.logs("log", logs)
    return call.run(out)


def payload(
    robot: AnyRobot | None = None,
    before: Logs | None = None,
    after: Logs | None = None,
    *,
    at: str | None = None,
    expect: float | PathLike | None = None,
    tolerance: float | None = None,
    out: PathLike | None = None,
) -> Answer:
    """Finds the load that was added to an arm between logs: mass, centre, inertia.

    ``at`` is the link that carries it. With ``expect`` (a mass in kg, or a TOML file) ``answer.code`` is 1 if the load differs. Logs, or
    datasets (.toml) of such logs.
    """
    call = Call("payload")
    places = {name: call.logs(name, logs) for name, logs in [("before", before), ("after", after)]}
    for name, found in places.items():
        if not found:
            raise TauscopeError(f"{name}: give at least one log")
        call.repeated(f"--{name}", found[1:])
    call.robot(robot)
    call.options(at=at, expect=expect, tolerance=tolerance)
    call.arguments[1:1] = [places["before"][0], places["after"][0]]
    return call.run(out)


def simulate(scenario: Scenario, *, seed: int | None = None, out: PathLike | None = None) -> Simulated:
    """Simulates and measures both motions of a scenario: a file, a dictionary as :func:`read_scenario` returns it, or the answer of a
    diagnosis, whose extended model is then simulated."""
    call = Call("simulate")
    call.arguments.append(call.scenario(scenario))
    return call.run(out, seed, Simulated)


def run(
    scenario: Scenario | None = None,
    *,
    dataset: PathLike | None = None,
    seed: int | None = None,
    out: PathLike | None = None,
) -> Answer:
    """Simulates, measures, identifies and scores a scenario; with a ``dataset`` it identifies and scores with measured logs."""
    call = Call("run")
    call.options(dataset=dataset)
    if scenario is not None:
        call.arguments.append(call.scenario(scenario))
    return call.run(out, seed)


def excite(
    scenario: Scenario,
    *,
    kind: str = "freudenstein",
    duration: float = 10.0,
    moves: int | None = None,
    criterion: str = "compromise",
    kappa_weight: float | None = None,
    evaluations: int | None = None,
    budget: float | str | None = None,
    starts: int = 1,
    grid_hz: float = 50.0,
    compare: bool = False,
    seed: int | None = None,
    out: PathLike | None = None,
) -> Answer:
    """Searches for an excitation motion inside all limits. ``answer.file("motion.toml")`` is the motion.

    ``budget`` is the time for the search, s.
    """
    call = Call("excite")
    call.arguments.append(call.scenario(scenario))
    call.options(
        kind=kind,
        duration=duration,
        moves=moves,
        criterion=criterion,
        kappa_weight=kappa_weight,
        evaluations=evaluations,
        budget=_time(budget),
        starts=starts,
        grid_hz=grid_hz,
        compare=compare,
    )
    return call.run(out, seed)


def montecarlo(
    scenario: Scenario,
    *,
    trials: int | None = None,
    estimators: Sequence[str] | None = None,
    sg_windows: Sequence[int] | None = None,
    butterworth: bool = False,
    noise_levels: Sequence[float | tuple[float, float]] | None = None,
    trial: int | None = None,
    resume: bool = False,
    shard: str | tuple[int, int] | None = None,
    shards: int | None = None,
    seed: int | None = None,
    out: PathLike | None = None,
) -> Answer:
    """Repeats the identification on many draws of noise, plants or motions. ``noise_levels`` are encoder noise in rad, or pairs with torque
    noise in N m.

    ``shard`` is one part of the study alone, ``(0, 4)`` or "0/4" for the first of four; in an array job of Slurm or Kubernetes it is
    that of the environment, and ``shards`` the number of parts where the scheduler does not give it. ``command("montecarlo", "merge",
    "a", "b")`` joins the ``out`` folders of the parts."""
    call = Call("montecarlo")
    call.options(
        trials=trials,
        estimators=_list("estimators", estimators),
        sg_windows=_list("sg_windows", sg_windows),
        butterworth=butterworth,
        noise_levels=_list("noise_levels", noise_levels),
        trial=trial,
        resume=resume,
        shard=_shard(shard),
        shards=shards,
    )
    call.arguments.append(call.scenario(scenario))
    return call.run(out, seed)


def blind(
    scenario: Scenario | None = None,
    *,
    full: bool = False,
    classes: Sequence[str] | None = None,
    run: int | None = None,
    jobs: int | None = None,
    resume: bool = False,
    effect: str | None = None,
    runs: int | None = None,
    severity: float | None = None,
    correlation: Sequence[float] | None = None,
    trust: str | None = None,
    seed: int | None = None,
    out: PathLike | None = None,
) -> Answer:
    """Hides effects in simulated arms and counts how often the diagnosis names them."""
    call = Call("blind")
    call.options(
        scenario=None if scenario is None else call.scenario(scenario),
        full=full,
        run=run,
        jobs=jobs,
        resume=resume,
        effect=effect,
        runs=runs,
        severity=severity,
        correlation=_list("correlation", correlation),
        trust=trust,
    )
    call.options(**{"class": _list("classes", classes)})
    return call.run(out, seed)


def check(
    scenario: Scenario,
    baseline: PathLike,
    *,
    update: bool = False,
    trials: int | None = None,
    diagnoses: int | None = None,
    seed: int | None = None,
) -> Answer:
    """Compares the identification with a stored baseline: ``answer.code`` is 1 if it is significantly worse."""
    call = Call("check")
    call.options(baseline=baseline, update=update, trials=trials, diagnoses=diagnoses)
    call.arguments.append(call.scenario(scenario))
    return call.run(None, seed)


def paper(scenario: Scenario, *, seed: int | None = None, out: PathLike | None = None) -> Answer:
    """Reproduces the paper's study and compares it with the printed one."""
    call = Call("paper")
    call.arguments.append(call.scenario(scenario))
    return call.run(out, seed)


def effects(name: str | None = None) -> Answer:
    """The catalogue of physical effects, or one entry of it."""
    return Call("effects", *([] if name is None else [name])).run()


def robot(robot: Robot | PathLike, *, hold: dict[str, float] | None = None) -> Answer:
    """What a robot file holds: joints under study, coupled and held joints, notes."""
    arm = robot if isinstance(robot, Robot) else Robot(robot)
    call = Call("robot")
    call.kept.append(arm)
    call.arguments.append(arm.path)
    call.options(joints=arm.joints, tip=arm.tip)
    call.repeated("--hold", [f"{joint}={position!r}" for joint, position in (hold or {}).items()])
    return call.run()


def view(place: PathLike) -> None:
    """Opens the recording of a results folder in the rerun viewer, and waits until it is closed."""
    command("view", os.fspath(place))


def command(*arguments: str | os.PathLike[str], out: PathLike | None = None) -> Answer:
    """Runs any command with the arguments of the command line: ``command("montecarlo", "merge", "a", "b")``."""
    if not arguments:
        raise TauscopeError("command: name one")
    words = [os.fspath(word) for word in arguments]
    call = Call(words[0], *words[1:])
    return call.run(out)


def _time(time: float | str | None) -> str | None:
    """A time as the command line takes it; a number is in seconds."""
    return f"{time!r}s" if isinstance(time, (int, float)) else time


def _shard(shard: str | tuple[int, int] | None) -> str | None:
    """A part of a study as the command line takes it."""
    if shard is None or isinstance(shard, str):
        return shard
    if len(shard) != 2:
        raise TauscopeError('shard: give (part, parts), as (0, 4), or "0/4"')
    return f"{shard[0]}/{shard[1]}"


def _list(name: str, values: Any) -> list[Any] | None:
    if values is None:
        return None
    if isinstance(values, (str, bytes)):
        raise TauscopeError(f"{name}: give a list")
    return list(values)
