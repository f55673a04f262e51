"""Judges a tauscope binary on blind cases: score.py BINARY FOLDER... [--tag NAME] [--where KEY=VALUE] [--check].

Writes diagnosis.json and the console text into CASE/out-TAG, and prints tables; lines.tsv beside the cases has one line
per case. A case that fails is counted as such and does not stop the rest. With --check the exit code is 1 if a rate is
significantly worse than its target.
"""

import argparse
import json
import subprocess
import sys
import time
from collections import Counter, defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy.stats import binom

# Rates that --check asks for: at most so many quiet logs named or unexplained, wrong names, and single effects of the
# library at the size of the noise that are not found; and the level of the binomial test against each.
MOST_ALARMS, MOST_WRONG, MOST_MISSED = 0.05, 0.01, 0.05
LEVEL = 0.05

OUTCOMES = ["named", "one_of", "wide_set", "missed", "wrong", "failed"]


def diagnose(binary, case, truth, out, timeout):
    """Runs the command; what it wrote, and the seconds it took."""
    out.mkdir(exist_ok=True)
    logs = ["--train", case / "a.csv", "--train", case / "b.csv", "--test", case / "c.csv"]
    command = [binary, "diagnose", "--robot", case / "robot.urdf", *logs, "--trust", truth["mode"], "--out", out]
    start = time.time()
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
        (out / "console.txt").write_text(done.stdout + done.stderr)
    except subprocess.TimeoutExpired:
        (out / "console.txt").write_text("timed out\n")
    (out / "seconds.txt").write_text(f"{time.time() - start:.1f}\n")


def read(out):
    path = out / "diagnosis.json"
    return json.loads(path.read_text()) if path.exists() else None


def names(finding):
    """Everything a finding leaves open, the first being its own name."""
    return [(one["effect"], tuple(one["joints"])) for one in [finding, *finding["alternatives"]]]


def is_same(name, effect):
    """Whether (effect, joints) of an answer is the hidden one; on a pair of joints the first counts."""
    where = tuple(effect["joints"])
    return name[0] == effect["effect"] and (not where or name[1][:1] == where[:1])


def judge(truth, answer):
    """Outcome of every hidden effect, wrong names (without alternatives, and in sets), and z-scores of parameters."""
    if answer is None:
        return ["failed"] * max(1, len(truth["effects"])), [], [], []
    outcomes, scores, used = [], [], set()
    findings = answer["findings"]
    for effect in truth["effects"]:
        outcome = "missed"
        for index, finding in enumerate(findings):
            held = [is_same(name, effect) for name in names(finding)]
            if not any(held) or index in used:
                continue
            used.add(index)
            outcome = "named" if len(held) == 1 else "one_of" if len(held) == 2 else "wide_set"
            if held[0]:
                scores += z_scores(effect, finding)
            break
        outcomes.append(outcome)
    others = [finding for index, finding in enumerate(findings) if index not in used]
    named = [names(finding)[0] for finding in others if finding["verdict"] == "named"]
    loose = [names(finding) for finding in others if finding["verdict"] != "named"]
    if named and "missed" in outcomes:
        outcomes[outcomes.index("missed")] = "wrong"
    return outcomes, named, loose, scores


def z_scores(effect, finding):
    found = {parameter["name"]: parameter for parameter in finding["parameters"]}
    true = effect["parameters"]
    return [
        (f"{effect['effect']}.{name}", (found[name]["value"] - true[name]) / found[name]["std"])
        for name in found
        if name in true and (found[name]["std"] or 0) > 0  # null: not determined by itself
    ]


def wilson(hits, runs, z=1.96):
    if runs == 0:
        return "-"
    p, n = hits / runs, runs
    middle, half = p + z * z / (2 * n), z * np.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    low, high = (100 * (middle + sign * half) / (1 + z * z / n) for sign in (-1, 1))
    return f"{100 * p:.0f} % ({max(0, low):.0f}-{high:.0f})"


def text(name):
    return name[0] + (":" + "+".join(joint.removeprefix("joint_") for joint in name[1]) if name[1] else "")


def line(case, truth, answer, judged, seconds):
    outcomes, named, loose, _ = judged
    hidden = ["{}{}".format(e["effect"], ":" + e["joints"][0][6:] if e["joints"] else "") for e in truth["effects"]]
    alarm = [] if hidden else ["false_alarm" if named or loose else "quiet" if answer else "failed"]
    unexplained = [f"{u['joint'][6:]}:{u['structure']}" for u in (answer or {}).get("unexplained", [])]
    setting = [truth.get(key) for key in ("mode", "noise", "motion", "arm", "rate", "sign_width", "quantised", "urdf_drives", "at_rest")]
    sets = ["|".join(text(name) for name in one) for one in loose]
    fields = [
        case.name, " ".join(hidden) or "-", " ".join(outcomes if hidden else alarm),
        "named: " + " ".join(map(text, named)) if named else "", "sets: " + " ".join(sets) if sets else "",
        "unexplained: " + " ".join(unexplained) if unexplained else "", " ".join(map(str, setting)), f"{seconds:.0f} s",
    ]  # fmt: skip
    return "\t".join(fields)


def evidence(truth, effect):
    """What a test of the true shape can expect, in classes: under 30 nothing over a whole library can find the effect."""
    value = effect.get("evidence")
    return "unknown" if value is None else next((name for top, name in ((30, "1: under 30"), (100, "2: to 100"), (1000, "3: to 1000")) if value < top), "4: more")


def tables(judged):
    """`judged`: (truth, answer, judgement) of every case."""
    quiet = [(truth, answer, j) for truth, answer, j in judged if not truth["effects"] and answer]
    if quiet:
        print("\nNothing hidden: cases in which something is named, alone or in a set")
        for key in ("mode", "noise", "motion", "arm", "rate", "sign_width", "quantised", "urdf_drives", "at_rest"):
            counts = defaultdict(list)
            for truth, _, j in quiet:
                counts[truth.get(key)].append(bool(j[1] or j[2]))
            print(f"  {key:12}", "   ".join(f"{value}: {sum(c)}/{len(c)}" for value, c in sorted(counts.items(), key=str)))
        alarms = sum(bool(j[1] or j[2]) for _, _, j in quiet)
        print(f"  all          {alarms}/{len(quiet)} = {wilson(alarms, len(quiet))}")
        left = sum(bool(answer["unexplained"]) for _, answer, _ in quiet)
        print(f"  unexplained structure in {left}/{len(quiet)}")
    hidden = [(truth, effect, outcome, j) for truth, _, j in judged for effect, outcome in zip(truth["effects"], j[0])]
    for title, key in [
        ("severity", lambda t, e: t["severity"]), ("mode", lambda t, e: t["mode"]), ("noise", lambda t, e: t["noise"]),
        ("motion", lambda t, e: t["motion"]), ("at rest", lambda t, e: t.get("at_rest")), ("arm", lambda t, e: t["arm"]), ("rate", lambda t, e: t["rate"]),
        ("Coulomb smoothing velocity", lambda t, e: t["sign_width"]), ("encoder", lambda t, e: "quantised" if t["quantised"] else "white"),
        ("evidence", evidence), ("effect", lambda t, e: e["effect"]),
    ]:  # fmt: skip
        rows = defaultdict(Counter)
        for truth, effect, outcome, _ in hidden:
            rows[str(key(truth, effect))][outcome] += 1
        if rows:
            print(f"\n{title:30}" + "".join(f"{outcome:>10}" for outcome in OUTCOMES) + "   held in <= 2")
        for value, counts in sorted(rows.items()):
            good, total = counts["named"] + counts["one_of"], sum(counts.values())
            print(f"{value:30}" + "".join(f"{counts[o]:10}" for o in OUTCOMES) + f"   {wilson(good, total)}")
    with_effects = [(truth, answer, j) for truth, answer, j in judged if truth["effects"] and answer]
    if with_effects:
        named = sum(bool(j[1]) for *_, j in with_effects)
        beside = sum(bool(j[1]) and "wrong" not in j[0] for *_, j in with_effects)
        flagged = sum(
            any(u["joint"] == e["worst_joint"] or u["joint"] == e["joint"] for u in a["unexplained"] for e in t["effects"])
            for t, a, _ in with_effects
        )
        print(f"\nA wrong name in {named}/{len(with_effects)} = {wilson(named, len(with_effects))}, of which {beside} in addition to the right one")
        print(f"Unexplained structure on the joint of the effect: {flagged}/{len(with_effects)}")
        print("Wrong names:", Counter(name[0] for *_, j in with_effects for name in j[1]).most_common())
    scores = [score for *_, j in judged for score in j[3]]
    if scores:
        inside = sum(abs(z) < 3 for _, z in scores)
        print(f"\nParameters within 3 std: {inside}/{len(scores)} = {wilson(inside, len(scores))}")
        far = defaultdict(list)
        for name, z in scores:
            far[name].append(z)
        print("  outside:", {name: [round(float(z), 1) for z in zs] for name, zs in far.items() if any(abs(z) >= 3 for z in zs)})


def failures(judged):
    """The rates that are significantly worse than their targets, as lines."""
    quiet = [answer is None or bool(answer["findings"] or answer["unexplained"]) for truth, answer, _ in judged if not truth["effects"]]
    single = [(answer, j) for truth, answer, j in judged if len(truth["effects"]) == 1 and truth["effects"][0]["in_library"]]
    rates = [
        ("quiet logs named, unexplained or without an answer", quiet, MOST_ALARMS),
        ("single effects without their name", [j[0][0] not in ("named", "one_of") for _, j in single], MOST_MISSED),
        ("single effects with a wrong name", [bool(j[1]) for answer, j in single if answer], MOST_WRONG),
    ]
    lines = []
    for name, wrong, most in rates:
        count, total = sum(wrong), len(wrong)
        p = float(binom.sf(count - 1, total, most)) if total else 1.0
        print(f"{name}: {count} of {total}, at most {100 * most:.0f} % wanted, p = {p:.3g}")
        if p < LEVEL:
            lines.append(name)
    return lines


def wanted(path, conditions):
    truth = json.loads(path.read_text())
    return all(str(truth.get(key)) == value for key, value in (condition.split("=") for condition in conditions))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("binary", type=Path)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--timeout", type=float, default=240)
    parser.add_argument("--tag", default="out")
    parser.add_argument("--rescore", action="store_true", help="only read what earlier runs wrote")
    parser.add_argument("--where", action="append", default=[], help="KEY=VALUE of truth.json; only such cases")
    parser.add_argument("-j", type=int, default=1)
    parser.add_argument("--check", action="store_true", help="exit code 1 if a rate is significantly worse than its target")
    options = parser.parse_args()
    judged, times = [], []
    for folder in options.folders:
        cases = sorted(path.parent for path in folder.glob("*/truth.json") if wanted(path, options.where))

        def run(case):
            truth, out = json.loads((case / "truth.json").read_text()), case / f"out-{options.tag}"
            if not options.rescore and not (out / "seconds.txt").exists():
                diagnose(options.binary, case, truth, out, options.timeout)
            if not (out / "seconds.txt").exists():
                return None
            answer, seconds = read(out), float((out / "seconds.txt").read_text())
            return truth, answer, judge(truth, answer), seconds, line(case, truth, answer, judge(truth, answer), seconds)

        with ThreadPoolExecutor(options.j) as pool, open(folder / f"lines-{options.tag}.tsv", "w") as lines:
            for result in filter(None, pool.map(run, cases)):
                judged.append(result[:3])
                times.append(result[3])
                lines.write(result[4] + "\n")
                lines.flush()
    tables(judged)
    print(f"\n{len(judged)} cases, {np.median(times):.1f} s in the median, {np.max(times):.1f} s at most")
    return 1 if options.check and failures(judged) else 0


if __name__ == "__main__":
    sys.exit(main())
