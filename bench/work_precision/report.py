#!/usr/bin/env python3
"""Gathers what the programs of bench/work_precision printed, and writes work_precision.json, .md and .png
(needs matplotlib).

    bench/work_precision/report.py FOLDER [ROWS.jsonl...] [--name work_precision] [--context KEY=VALUE...]

Rows of programs that did not run this time are kept from FOLDER/NAME.json.
"""
import argparse
import json
import math
import re
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# The one rule for meshes, the same on all scenes and elements.
DEFAULT = "RecoveredStress bulk(0.65)"
# Errors at which static problems are compared, and the bars of the project for time over that of the best
# uniform mesh. From Cook's membrane on, problems had no say in the choice of the default.
LEVELS = {
    "L-shape": (0.04, 0.3),
    "slit plate": (0.06, 0.15),
    "slit plate, explicit": (0.065, 0.2),
    "hanging beam": (0.014, 0.15),
    "cantilever": (0.03, None),
    "Cook's membrane": (0.05, None),
    "plate with a square hole": (0.03, None),
    "smooth field, finite strain": (0.02, None),
    "notched block": (0.04, None),
    "twisted bar": (0.05, None),
    "artery ring": (0.03, None),
}
# "A to B": elements A that are raised to B where rules say, and then refined. They stand beside uniform meshes of B.
ELEMENTS = ["Tri3", "Quad4", "Tri6", "Quad9", "Tri3 to Tri6", "Quad4 to Quad9",
            "Tet4", "Hex8", "Tet10", "Hex27", "Hex8 to Hex27"]


def interpolated(points, error):
    """The time that a curve of (error, seconds) needs for an error: a power law between the two points
    around it, or beyond the last two; and whether it lies beyond. Infinite where errors stopped falling before it."""
    points = sorted(points, reverse=True)
    if len(points) < 2:
        return math.nan, True
    k = 1
    while k + 1 < len(points) and points[k][0] > error:
        k += 1
    (e0, t0), (e1, t1) = points[k - 1], points[k]
    slope = math.log(t1 / t0) / math.log(e1 / e0)
    beyond = not e1 <= error <= e0
    if beyond and not -20 < slope < 0:  # errors that fall no more
        return math.inf, True
    return t1 * (error / e1) ** slope, beyond


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
        """(seconds, whether extrapolated, contestant) of the fastest uniform meshes, in double precision as adaptive ones are."""
        names = [c for c in self.contestants if self.kind(c) == "uniform" and "float" not in c]
        if element:
            names = [c for c in names if c.startswith(element.split(" to ")[-1] + ",")]
        return min((*interpolated(self.points(c), error), c) for c in names)

    def first_within(self, contestant, error):
        """The first round of an adaptive run that is within an error."""
        return next((r for r in self.of(contestant) if r["error"] and r["error"] <= error), None)


def time(seconds):
    if math.isinf(seconds):
        return "not reached"
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
    return LEVELS[problem.name]


def ratio(seconds, uniform, extrapolated, bar=None):
    """Empty where uniform meshes do not reach the error."""
    if math.isinf(uniform):
        return ""
    value = seconds / uniform
    return f"{value:.2g}" + (" †" if extrapolated else "") + held(bar, value)


def pays_below(problem, contestant):
    """The error from which on down an adaptive run is faster than all uniform meshes."""
    points = problem.points(contestant)
    error, crossing = min(points)[0], None
    while error < max(points)[0] and interpolated(points, error)[0] < problem.uniform(error)[0]:
        crossing = error
        error *= 1.02
    return f"{percent(crossing)[:-2][:4]} %" if crossing else f"nowhere down to {percent(min(points)[0])}"


def held(bar, value):
    if not bar:
        return ""
    return f" {'met' if value <= bar else '**missed**'}"


def static_rows(problem):
    error, bar = level_of(problem)
    for element in ELEMENTS:
        name = f"{element}, {DEFAULT}"
        if name not in problem.contestants:
            continue
        row = problem.first_within(name, error)
        if not row:
            yield [problem.name, percent(error), element, "not reached"] + [""] * 7
            continue
        seconds, _ = interpolated(problem.points(name), error)
        own, beyond_own, _ = problem.uniform(error, element)
        best, beyond, fastest = problem.uniform(error)
        yield [problem.name, percent(error), element, time(seconds), f"≤ {bar}" if bar else "",
               time(own), ratio(seconds, own, beyond_own, bar),
               f"{fastest.split(',')[0]}, {time(best)}", ratio(seconds, best, beyond, bar),
               f"{row['n']}: {percent(row['error'])}, {row['unknowns']} unknowns, {time(row['seconds'])}",
               pays_below(problem, name)]


def rules_of(problem):
    return list(dict.fromkeys(c.split(", ", 1)[1] for c in problem.contestants if problem.kind(c) == "adaptive"))


def rule_rows(problem, rules):
    """At the same error on both sides, from power laws between rounds and between meshes."""
    error, _ = level_of(problem)
    for element in ELEMENTS:
        cells = []
        if f"{element}, {DEFAULT}" not in problem.contestants:
            continue
        own, beyond_own, _ = problem.uniform(error, element)
        for rule in rules:
            points = problem.points(f"{element}, {rule}")
            seconds, beyond = interpolated(points, error)
            # Too far from the error to say.
            far = not points or min(points)[0] > 1.5 * error
            cells.append("" if f"{element}, {rule}" not in problem.contestants else "not reached" if far
                         else ratio(seconds, own, beyond or beyond_own))
        yield [problem.name, percent(error), element, *cells]


def share_rows(problem):
    error, _ = level_of(problem)
    for element in ELEMENTS:
        row = problem.first_within(f"{element}, {DEFAULT}", error)
        if row:
            yield [problem.name, element, row["n"], time(row["seconds"])] + [
                f"{100 * row[part] / row['seconds']:.0f} %" for part in ("making", "solving", "deciding", "refining")]


def law_rows(problem):
    """All elements under one law, and switching between two, beside all under the costly one."""
    costly = problem.name.rsplit(", ", 1)[1]
    seconds = {c: problem.of(c)[0]["seconds"] for c in problem.contestants if problem.of(c)}
    for contestant in problem.contestants:
        for row in problem.of(contestant):
            cells = [problem.name.rsplit(", ", 1)[0], contestant, time(row["seconds"]),
                     f"{row['seconds'] / seconds[costly]:.2f}", percent(row["error"])]
            share = row.get("share")
            if problem.kind(contestant) == "switching":
                # The dearest of the cheap laws, where there are several.
                cheap = max(seconds[law] for law in contestant.removeprefix("cheapest of ").split(", ") if law in seconds and law != costly)
                expected = share * seconds[costly] + (1 - share) * cheap
                cells += [percent(share), f"{row['seconds'] / expected:.2f}"]
                within = row["error"] <= 0.001
                cells.append("" if not within else "met" if row["seconds"] <= 0.5 * seconds[costly] else "slower than 0.5")
            else:
                cells += ["", "", ""]
            yield cells


def step_rows(problem):
    reference = problem.of("CentralDifference, safety 0.9, double")[0]["seconds"]
    for contestant in problem.contestants:
        for row in problem.of(contestant):
            yield [problem.name, contestant, time(row["seconds"]), f"{row['seconds'] / reference:.2f}", percent(row["error"])]


def motion_rows(problem):
    """Every run; those that no other one of the problem beats in both time and error are on the front."""
    for contestant in problem.contestants:
        for row in problem.of(contestant):
            beaten = any(r["seconds"] < row["seconds"] and r["error"] <= row["error"]
                         for c in problem.contestants for r in problem.of(c) if r["error"] is not None)
            yield [problem.name, contestant, row["n"], row["unknowns"], time(row["seconds"]), percent(row["error"]),
                   "" if beaten else "front"]


def report(data, name):
    problems = [Problem(name, data["rows"]) for name in dict.fromkeys(r["problem"] for r in data["rows"])]
    static = [p for p in problems if p.name in LEVELS and any(p.kind(c) == "adaptive" for c in p.contestants)]
    text = ["# Run time against error", "",
            "Written by `bench/work_precision/run`; [bench/work_precision](../work_precision/README.md) says what is",
            "measured and what to choose. Times are medians over rounds in which all contestants of a problem ran in",
            "turns. Adaptive runs count from the coarse mesh on: every round's solve, estimate, refinement and transfer.",
            ""]
    text += [f"- {key}: {value}" for key, value in data["context"].items()]
    runs = {}
    for problem in problems:
        how = data["measured"][problem.name]
        runs.setdefault((how["command"], how["commit"], how["date"], how.get("clock", "wall")), []).append(problem.name)
    text += [f"- `{command}` at {commit}, {date}, {clock} clock: {'; '.join(names)}"
             for (command, commit, date, clock), names in runs.items()]
    text += ["", f"![run time against error]({name}.png)", ""]
    if static:
        text += ["## The default for meshes beside uniform meshes, at equal error", "",
                 f"The default is `when<F>(RecoveredStress{{}}).bulk(...).refine()` of *{DEFAULT}*, in rounds until the error",
                 "is reached. Times at the same error lie on power laws between two rounds and between two meshes; † marks where",
                 "they are extrapolated beyond the finest mesh measured. Errors are in the energy norm, over that of the solution; of the",
                 "artery's ring those of the gradient of the displacements.", "",
                 markdown(["problem", "error", "element", "time", "bar", "uniform, same element", "over it",
                           "best uniform of all elements", "over it", "first round within the error", "faster than all uniform below"],
                          [row for p in static for row in static_rows(p)]), "",
                 "## Rules, by their time over that of uniform meshes of the same element", "",
                 "The default was chosen by the L-shape, the slit plate and the beams; the others had no say.", ""]
        rules = list(dict.fromkeys(rule for p in static for rule in rules_of(p)))
        text += [markdown(["problem", "error", "element", *rules], [row for p in static for row in rule_rows(p, rules)]),
                 "", "## Where the time of the default goes", "",
                 markdown(["problem", "element", "rounds", "time", "first mesh", "solving", "estimating", "refining"],
                          [row for p in static for row in share_rows(p)]), ""]
    laws = [p for p in problems if any(p.kind(c) == "switching" for c in p.contestants)]
    if laws:
        text += ["## Laws: solids that move", "",
                 "Explicit steps of one size; the error is that of the history of one node, beside the costly law in half",
                 "the steps. *Expected* is share costly × its time + share cheap × its time; the bars of the project are 1.1 of it, and 0.5",
                 "of all costly, within 0.1 %.", "",
                 markdown(["scene", "elements' laws", "time", "over all costly", "error", "share costly", "over expected", "≤ 0.5 of all costly"],
                          [row for p in laws for row in law_rows(p)]), ""]
    steps = [p for p in problems if any(p.kind(c) == "local steps" for c in p.contestants)]
    if steps:
        text += ["## Time steps: a hundredth of the elements ten times smaller", "",
                 "The error is that of the history of a corner, beside global steps a quarter as long.", "",
                 markdown(["problem", "integrator", "time", "over global at 0.9", "error"],
                          [row for p in steps for row in step_rows(p)]), ""]
    motion = [p for p in problems if p not in static + laws + steps]
    if motion:
        text += ["## Bodies that move", "",
                 "Explicit steps unless said; errors are those of displacements at equal times, over all that is compared. *Front*:",
                 "no other run of the problem is faster and as good.", "",
                 markdown(["problem", "contestant", "cells", "unknowns", "time", "error", ""],
                          [row for p in motion for row in motion_rows(p)]), ""]
    failed = [[r["problem"], r["contestant"], r["n"], r["failed"]] for r in data["rows"] if r["failed"]]
    if failed:
        text += ["## Failed", "", markdown(["problem", "contestant", "n", "why"], failed), ""]
    return "\n".join(text)


# What the plot of the README shows.
OVERVIEW = ["L-shape", "slit plate", "hanging beam", "notched block", "twisted bar", "artery ring",
            "block with a thin arm, Tet4, Ogden", "twisting bar, Hex8, Ogden"]
# Elements of one colour; plane and solid.
COLOURS = dict(zip([("Tri3", "Tet4"), ("Quad4", "Hex8"), ("Tri6", "Tet10"), ("Quad8", "Hex20"), ("Quad9", "Hex27"),
                    ("Tri3 to Tri6", "Tet4 to Tet10"), ("Quad4 to Quad9", "Hex8 to Hex27"),
                    ("Tri3 and Tri6", "Tet4 and Tet10"), ("Quad4 and Quad9", "Hex8 and Hex27")],
                   matplotlib.colormaps["tab10"].colors))
DASHES = {"uniform": "-", "uniform, float": "-.", "uniform, FBar": ":"}
MARKS = "ovsDPX*<>"
# In legends.
SHORT = {"Saint Venant-Kirchhoff": "SVK", "isochoric neo-Hookean": "NH-iso", "neo-Hookean": "NH", "Holzapfel-Gasser-Ogden": "HGO"}


def draw_static(axis, problem, overview):
    """Uniform meshes as lines, rounds of adaptive ones as marks; for an overview the default rule and full quadratures alone."""
    rules = rules_of(problem)
    for contestant in problem.contestants:
        points = sorted((t, e) for e, t in problem.points(contestant))
        element, how = contestant.split(", ", 1)
        if not points or overview and how not in ("uniform", DEFAULT):
            continue
        names, colour = next((n, c) for n, c in COLOURS.items() if element in n)
        label = f"{' / '.join(names)}, {'adaptive' if overview and how == DEFAULT else how}"
        if how.startswith("uniform"):
            axis.loglog(*zip(*points), DASHES.get(how, "--"), linewidth=1.2, label=label, color=colour)
        else:
            default = how == DEFAULT
            axis.loglog(*zip(*points), linestyle="none", label=label, color=colour,
                        marker="^" if default else MARKS[rules.index(how) % len(MARKS)],
                        markersize=5 if default else 3, alpha=1 if default else 0.5)


def draw_others(axis, problem, legend_size):
    """One mark for each contestant; those that differ by a threshold have the same."""
    series = {}
    for contestant in problem.contestants:
        name = re.sub(" (above|at) [0-9.e-]+", "", contestant) if problem.kind(contestant) == "switching" else contestant
        for law, short in SHORT.items():
            name = name.replace(law, short)
        series.setdefault(name, []).extend((t, e) for e, t in problem.points(contestant))
    for k, (name, points) in enumerate(series.items()):
        if points:
            axis.loglog(*zip(*points), linestyle="none", label=name, marker=MARKS[k % len(MARKS)], markersize=5)
    # The legend stands above the points. Whole powers of ten along the axis keep its numbers apart.
    low, high = axis.get_ylim()
    axis.set_ylim(low, high * (high / low) ** (0.13 * len(series)))
    shortest, longest = (math.log10(time) for time in axis.get_xlim())
    axis.set_xlim(10 ** math.floor(shortest), 10 ** math.ceil(longest))
    axis.legend(fontsize=legend_size, loc="upper right")


def draw(data, path, overview=False):
    """All problems and contestants; for an overview, some of them."""
    names = list(dict.fromkeys(r["problem"] for r in data["rows"]))
    if overview:
        names = [name for name in OVERVIEW if name in names]
    problems = [Problem(name, data["rows"]) for name in names]
    if not problems:
        return
    columns = min(3 if overview else 4, len(problems))
    lines = len(problems) // columns + 1
    width, height = (3.7, 3.3) if overview else (5.2, 5)
    figure, axes = plt.subplots(lines, columns, figsize=(width * columns, height * lines), layout="constrained", squeeze=False)
    *panels, corner = [axis for line in axes for axis in line]
    for axis in panels[len(problems):]:
        axis.remove()
    corner.axis("off")  # for the legend of all static problems
    shared = {}
    for axis, problem in zip(panels, problems):
        if any(problem.kind(c) == "uniform" for c in problem.contestants):
            draw_static(axis, problem, overview)
            shared |= {label: line for line, label in zip(*axis.get_legend_handles_labels())}
        else:
            draw_others(axis, problem, 6.5 if overview else 6)
        if problem.name in LEVELS:
            axis.axhline(LEVELS[problem.name][0], color="black", linewidth=0.6)
        axis.set_title(problem.name, fontsize=10)
        axis.set_xlabel("run time / s")
        axis.set_ylabel("relative error")
        axis.grid(True, which="major", alpha=0.3)
    if shared:
        order = sorted(shared, key=lambda label: "uniform" not in label)
        corner.legend([shared[label] for label in order], order, loc="center", fontsize=9 if overview else 8)
    figure.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("rows", nargs="*", type=Path)
    parser.add_argument("--name", default="work_precision")
    parser.add_argument("--context", nargs="*", default=[])
    arguments = parser.parse_args()
    path = arguments.folder / f"{arguments.name}.json"
    old = json.loads(path.read_text()) if path.exists() else {"context": {}, "rows": []}
    rows = [json.loads(line) for name in arguments.rows for line in name.read_text().splitlines()]
    new = {row["problem"] for row in rows}
    context = dict(pair.split("=", 1) for pair in arguments.context)
    # Problems may have been measured one at a time: what differs from run to run stands with each.
    each = {key: context.pop(key) for key in ("commit", "date", "command", "clock") if key in context}
    measured = old.get("measured", {}) | {problem: each for problem in new}
    rows = [row for row in old["rows"] if row["problem"] not in new] + rows
    order = list(LEVELS)
    rows.sort(key=lambda row: (order.index(row["problem"]) if row["problem"] in order else len(order), row["problem"]))
    data = {"context": old["context"] | context, "measured": measured, "rows": rows}
    with path.open("w") as file:
        for part in ("context", "measured"):
            file.write(("{" if part == "context" else "") + f'"{part}": ' + json.dumps(data[part], ensure_ascii=False, indent=1) + ",\n")
        file.write('"rows": [\n')
        file.write(",\n".join(json.dumps(row, ensure_ascii=False) for row in data["rows"]) + "\n]}\n")
    (arguments.folder / f"{arguments.name}.md").write_text(report(data, arguments.name))
    draw(data, arguments.folder / f"{arguments.name}.png")
    draw(data, arguments.folder / f"{arguments.name}_overview.png", overview=True)


main()
