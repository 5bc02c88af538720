#!/usr/bin/env python3
"""Gathers what the programs of bench/work_precision printed, and writes work_precision.json, .md and .png
(needs matplotlib).

    bench/work_precision/report.py FOLDER [ROWS.jsonl...] [--context KEY=VALUE...]

Rows of programs that did not run this time are kept from FOLDER/work_precision.json.
"""
import argparse
import json
import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# The one rule for meshes, the same on all scenes and elements.
DEFAULT = "RecoveredStress bulk(0.5)"
# Errors at which static problems are compared, and the bars of the project for time over that of the best
# uniform mesh.
LEVELS = {
    "L-shape": (0.04, 0.3),
    "slit plate": (0.06, 0.15),
    "hanging beam": (0.014, 0.15),
}
ELEMENTS = ["Tri3", "Quad4"]


def interpolated(points, error):
    """The time that a curve of (error, seconds) needs for an error: a power law between the two points
    around it, or beyond the last two; and whether it lies beyond."""
    points = sorted(points, reverse=True)
    if len(points) < 2:
        return math.nan, True
    k = 1
    while k + 1 < len(points) and points[k][0] > error:
        k += 1
    (e0, t0), (e1, t1) = points[k - 1], points[k]
    slope = math.log(t1 / t0) / math.log(e1 / e0)
    return t1 * (error / e1) ** slope, not (e1 <= error <= e0)


class Problem:
    """The rows of one problem."""

    def __init__(self, name, rows):
        self.name = name
        self.rows = [row for row in rows if row["problem"] == name]
        self.contestants = list(dict.fromkeys(row["contestant"] for row in self.rows))

    def of(self, contestant):
        return [r for r in self.rows if r["contestant"] == contestant and not r["failed"]]

    def kind(self, contestant):
        return next(r["kind"] for r in self.rows if r["contestant"] == contestant)

    def points(self, contestant):
        return [(r["error"], r["seconds"]) for r in self.of(contestant) if r["error"]]

    def uniform(self, error, element=None):
        """(seconds, whether extrapolated, contestant) of the fastest uniform meshes."""
        names = [c for c in self.contestants if self.kind(c) == "uniform"]
        if element:
            names = [c for c in names if c.startswith(element + ",")]
        return min((*interpolated(self.points(c), error), c) for c in names)

    def first_within(self, contestant, error):
        """The first round of an adaptive run that is within an error."""
        return next((r for r in self.of(contestant) if r["error"] and r["error"] <= error), None)


def time(seconds):
    for size, unit in ((1, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.1e} s"


def percent(error):
    return f"{100 * error:.3g} %"


def markdown(header, rows):
    rows = [[str(cell) for cell in row] for row in [header, *rows]]
    widths = [max(len(row[k]) for row in rows) for k in range(len(header))]
    rows.insert(1, ["-" * w for w in widths])
    return "\n".join("| " + " | ".join(c.ljust(w) for c, w in zip(row, widths)) + " |" for row in rows)


def level_of(problem):
    """Where nobody has set one: what the default reaches in its last round but two, in one digit."""
    if problem.name in LEVELS:
        return LEVELS[problem.name]
    reached = [problem.of(f"{e}, {DEFAULT}")[-3:] for e in ELEMENTS]
    error = max(rows[0]["error"] for rows in reached if rows)
    size = 10 ** math.floor(math.log10(error))
    return math.ceil(error / size) * size, None


def ratio(value, extrapolated):
    return f"{value:.2f}" + (" †" if extrapolated else "")


def held(bar, value):
    if not bar:
        return ""
    return f" {'met' if value <= bar else '**missed**'}"


def static_rows(problem):
    error, bar = level_of(problem)
    for element in ELEMENTS:
        row = problem.first_within(f"{element}, {DEFAULT}", error)
        if not row:
            yield [problem.name, percent(error), element, "not reached"] + [""] * 7
            continue
        own, beyond_own, _ = problem.uniform(row["error"], element)
        best, beyond, name = problem.uniform(row["error"])
        yield [problem.name, percent(error), element, percent(row["error"]), row["unknowns"], time(row["seconds"]),
               f"≤ {bar}" if bar else "", time(own), ratio(row["seconds"] / own, beyond_own) + held(bar, row["seconds"] / own),
               f"{name.split(',')[0]}, {time(best)}", ratio(row["seconds"] / best, beyond) + held(bar, row["seconds"] / best)]


def rules_of(problem):
    return list(dict.fromkeys(c.split(", ", 1)[1] for c in problem.contestants if problem.kind(c) == "adaptive"))


def rule_rows(problem, rules):
    error, _ = level_of(problem)
    for element in ELEMENTS:
        cells = []
        for rule in rules:
            row = problem.first_within(f"{element}, {rule}", error)
            if row:
                own, beyond, _ = problem.uniform(row["error"], element)
                cells.append(ratio(row["seconds"] / own, beyond))
            else:
                cells.append("not reached")
        yield [problem.name, percent(error), element, *cells]


def share_rows(problem):
    error, _ = level_of(problem)
    for element in ELEMENTS:
        row = problem.first_within(f"{element}, {DEFAULT}", error)
        if row:
            yield [problem.name, element, row["n"], time(row["seconds"])] + [
                f"{100 * row[part] / row['seconds']:.0f} %" for part in ("making", "solving", "deciding", "refining")]


def report(data):
    problems = [Problem(name, data["rows"]) for name in dict.fromkeys(r["problem"] for r in data["rows"])]
    static = [p for p in problems if any(p.kind(c) == "adaptive" for c in p.contestants)]
    text = ["# Run time against error", "",
            "Written by `bench/work_precision/run`; [bench/work_precision](../work_precision/README.md) says what is",
            "measured and what to choose. Times are medians over rounds in which all contestants of a problem ran in",
            "turns. Adaptive runs count from the coarse mesh on: every round's solve, estimate, refinement and transfer.",
            ""]
    text += [f"- {key}: {value}" for key, value in data["context"].items()]
    text += ["", "![run time against error](work_precision.png)", ""]
    if static:
        text += ["## The default for meshes beside uniform meshes, at equal error", "",
                 f"The default is `when<F>(RecoveredStress{{}}).bulk(...).refine()` of *{DEFAULT}*, in rounds until the error",
                 "is reached. Uniform meshes' time at the same error lies on a power law between two meshes; † marks where it is",
                 "extrapolated beyond the finest mesh measured. Errors are in the energy norm, over that of the solution.", "",
                 markdown(["problem", "asked", "element", "error", "unknowns", "time", "bar", "uniform, same element",
                           "over it", "best uniform of all elements", "over it"],
                          [row for p in static for row in static_rows(p)]), "",
                 "## Rules, by their time over that of uniform meshes of the same element", ""]
        rules = list(dict.fromkeys(rule for p in static for rule in rules_of(p)))
        text += [markdown(["problem", "error", "element", *rules], [row for p in static for row in rule_rows(p, rules)]),
                 "", "## Where the time of the default goes", "",
                 markdown(["problem", "element", "rounds", "time", "first mesh", "solving", "estimating", "refining"],
                          [row for p in static for row in share_rows(p)]), ""]
    failed = [[r["problem"], r["contestant"], r["n"], r["failed"]] for r in data["rows"] if r["failed"]]
    if failed:
        text += ["## Failed", "", markdown(["problem", "contestant", "n", "why"], failed), ""]
    return "\n".join(text)


def draw(data, path):
    problems = [Problem(name, data["rows"]) for name in dict.fromkeys(r["problem"] for r in data["rows"])]
    columns = min(3, len(problems))
    lines = math.ceil(len(problems) / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(5.6 * columns, 4.6 * lines), layout="constrained", squeeze=False)
    panels = [axis for line in axes for axis in line]
    for axis in panels[len(problems):]:
        axis.remove()
    marks = "ov^sDPX*<>"
    for axis, problem in zip(panels, problems):
        mark = 0
        for contestant in problem.contestants:
            points = sorted(problem.points(contestant), key=lambda p: p[1])
            if not points:
                continue
            if problem.kind(contestant) == "uniform":
                axis.loglog(*zip(*((t, e) for e, t in points)), "-", linewidth=1.2, label=contestant)
            else:
                default = contestant.endswith(DEFAULT)
                axis.loglog(*zip(*((t, e) for e, t in points)), marks[mark % len(marks)], markersize=5 if default else 3,
                            alpha=1 if default else 0.6, label=contestant)
                mark += 1
        if problem.name in LEVELS:
            axis.axhline(LEVELS[problem.name][0], color="black", linewidth=0.6)
        axis.set_title(problem.name)
        axis.set_xlabel("run time / s")
        axis.set_ylabel("relative error")
        axis.grid(True, which="major", alpha=0.3)
        axis.legend(fontsize=5.5)
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("rows", nargs="*", type=Path)
    parser.add_argument("--context", nargs="*", default=[])
    arguments = parser.parse_args()
    path = arguments.folder / "work_precision.json"
    old = json.loads(path.read_text()) if path.exists() else {"context": {}, "rows": []}
    rows = [json.loads(line) for name in arguments.rows for line in name.read_text().splitlines()]
    new = {row["problem"] for row in rows}
    data = {"context": old["context"] | dict(pair.split("=", 1) for pair in arguments.context),
            "rows": [row for row in old["rows"] if row["problem"] not in new] + rows}
    with path.open("w") as file:
        file.write('{"context": ' + json.dumps(data["context"], ensure_ascii=False, indent=1) + ',\n"rows": [\n')
        file.write(",\n".join(json.dumps(row, ensure_ascii=False) for row in data["rows"]) + "\n]}\n")
    (arguments.folder / "work_precision.md").write_text(report(data))
    draw(data, arguments.folder / "work_precision.png")


main()
