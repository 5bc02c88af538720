#!/usr/bin/env python3
"""Writes RESULTS.md and its maps from the lines that the program stability appended (needs matplotlib).

    tests/stability/report.py FOLDER results.tsv CASES
"""
import collections
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

folder, source, expected = sys.argv[1:]
OUTCOMES = ["works", "reports", "SILENTLY WRONG", "HANGS", "CRASHES"]
COLOURS = ["#4c9f70", "#e3b23c", "#c1292e", "#7b2d8b", "#111111"]
INTEGRATORS = ["CentralDifference", "LocalSteps", "implicit", "BackwardEuler", "static"]
SHORT = ["C", "L", "I", "B", "S"]


class Row:
    def __init__(self, line):
        key, self.outcome, self.figures, self.text, seconds = line.rstrip("\n").split("\t")
        self.scene, self.variant, self.element, self.law, self.integrator, self.backend = key.split("|")
        self.key, self.seconds = key, float(seconds)
        self.rank = OUTCOMES.index(self.outcome)


rows = [Row(line) for line in open(source) if line.count("\t") == 4]


def distinct(values):
    return list(dict.fromkeys(values))


def worst(found):
    return max((row.rank for row in found), default=None)


def paint(axis, title, down, across, cell, column_names):
    """A map: cell(row name, column) is an outcome's rank, or None where there is no case."""
    for i, name in enumerate(down):
        for j, column in enumerate(across):
            rank = cell(name, column)
            if rank is not None:
                axis.add_patch(plt.Rectangle((j, i), 1, 1, facecolor=COLOURS[rank], edgecolor="white", linewidth=0.5))
    axis.set_xlim(0, len(across))
    axis.set_ylim(len(down), 0)
    axis.set_yticks([i + 0.5 for i in range(len(down))], down, fontsize=6)
    axis.set_xticks([j + 0.5 for j in range(len(across))], column_names, fontsize=5)
    axis.tick_params(length=0)
    for side in axis.spines.values():
        side.set_visible(False)
    axis.set_title(title, fontsize=8)


def finish(figure, name, title):
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for colour in COLOURS]
    figure.legend(handles, [outcome.lower() for outcome in OUTCOMES], loc="lower center", ncol=5, fontsize=7, frameon=False)
    margin = 0.3 / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, margin, 1, 1 - margin))
    figure.suptitle(title, fontsize=9)
    figure.savefig(f"{folder}/{name}", dpi=110)
    plt.close(figure)


# Law x element x integrator, a panel for each scene, its variants' worst; a picture for each backend.
pictures = []
for backend in distinct(row.backend for row in rows):
    mine = [row for row in rows if row.backend == backend]
    table = collections.defaultdict(list)
    for row in mine:
        table[row.scene, row.law, row.element, row.integrator].append(row)
    scenes, laws, elements = (distinct(getattr(row, what) for row in mine) for what in ("scene", "law", "element"))
    across = [(element, integrator) for element in elements for integrator in INTEGRATORS]
    names = [SHORT[INTEGRATORS.index(i)] + (f"\n{e}" if i == "LocalSteps" else "") for e, i in across]
    wide = max(1, min(4, 28 // max(1, len(elements))))
    high = -(-len(scenes) // wide)
    figure, axes = plt.subplots(high, wide, figsize=((1.2 + 0.55 * len(elements)) * wide, 0.7 + (0.5 + 0.14 * len(laws)) * high),
                                squeeze=False, layout="constrained")
    for axis in axes.flat[len(scenes):]:
        axis.set_axis_off()
    for scene, axis in zip(scenes, axes.flat):
        paint(axis, scene, laws, across, lambda law, c: worst(table[scene, law, *c]), names)
    name = "map_" + re.sub(r"\W+", "_", backend.lower()) + ".png"
    finish(figure, name, f"{backend}: law by element and integrator (C CentralDifference, L LocalSteps, I implicit, B BackwardEuler, S static)")
    pictures.append((name, backend))

# Poisson's ratio x mesh x step, the worst of all laws, elements of a dimension and backends.
poisson = [row for row in rows if row.scene == "Poisson's ratio"]
if poisson:
    figure, axes = plt.subplots(2, 4, figsize=(11, 4.4), squeeze=False, layout="constrained")
    for line, plane in zip(axes, (True, False)):
        for axis, integrator in zip(line, INTEGRATORS):
            table = collections.defaultdict(list)
            for row in poisson:
                if row.integrator == integrator and (row.element[:3] in ("Tri", "Qua")) == plane:
                    ratio, rest = row.variant.split(", ", 1)
                    table[ratio, rest].append(row)
            down = distinct(key[0] for key in table)
            across = distinct(key[1] for key in table)
            names = [re.sub(r"(\d+) cells, step (\S+)", r"n = \1\n\2 Δt", c) for c in across]
            paint(axis, f"{'plane' if plane else 'solid'}, {integrator}", down, across, lambda r, c: worst(table[r, c]), names)
    finish(figure, "map_poisson.png", "Poisson's ratio by cells along an edge and share of the stable step, the worst of all laws and elements")


def counts(found):
    return " / ".join(str(sum(row.rank == k for row in found)) for k in range(3))


with open(f"{folder}/RESULTS.md", "w") as out:
    say = lambda text="": print(text, file=out)
    total = collections.Counter(row.outcome for row in rows)
    say("# Where each method works, says that it does not, or is wrong\n")
    say("Written by `tests/stability/run`. A case is a scene with one element, law, integrator, precision and backend. It")
    say("*works* when what its scene asks in cases.cpp holds: displacements within 1% of Reference in double at a quarter of")
    say("the step, or an invariant kept to the bound that stands in cases.cpp; values are finite always. It *reports* when an Error")
    say("says in words what failed and the body that is left is finite, or when a roll-back is told and what is asked does not hold.")
    say("Told, too, are a saddle, by the report of solve_static, and errors of displacements, by those of implicit steps: at least as large as")
    say("they are off at every sample, or said to be too large to be known.")
    say("Explicit integrators are asked by `check` whether the states that count are good, and go back where they are not.")
    say("Else it is silently wrong, hangs or crashes. Each case is a process of its own.")
    say("*det F* tells of explicit steps whose body is folded somewhere in the end, which they do not look for: laws that take")
    say("inversion go on. Steps are half the stable one, after sudden starts a tenth; implicit ones half of these.\n")
    say(f"{len(rows)} of {expected} cases, {sum(row.seconds for row in rows) / 60:.0f} minutes of processes, as many side by side as there are cores: "
        + ", ".join(f"{total[outcome]} {outcome.lower()}" for outcome in OUTCOMES) + ".\n")
    for name, backend in pictures:
        say(f"![{backend}]({name})\n")
    if poisson:
        say("![Poisson's ratio](map_poisson.png)\n")
    say("## Scenes\n")
    say("works / reports / silently wrong\n")
    say("| scene | variant | " + " | ".join(INTEGRATORS) + " |")
    say("|---" * (2 + len(INTEGRATORS)) + "|")
    for scene in distinct(row.scene for row in rows):
        here = [row for row in rows if row.scene == scene]
        variants = distinct(row.variant for row in here)
        if scene == "Poisson's ratio":
            variants = [""]
        for variant in variants:
            found = here if variants == [""] else [row for row in here if row.variant == variant]
            cells = [counts(own) if (own := [row for row in found if row.integrator == integrator]) else ""
                     for integrator in INTEGRATORS]
            say(f"| {scene} | {variant} | " + " | ".join(cells) + " |")
    defects = [row for row in rows if row.rank >= 2]
    say("\n## Defects\n")
    if not defects:
        say("None.")
    else:
        say("| case | outcome | measured / bound | what is missed |\n|---|---|---|---|")
        for row in defects:
            say(f"| {row.key.replace('|', ', ')} | {row.outcome} | {row.figures} | {row.text} |")
    say("\n## What reports say\n")
    kinds = collections.defaultdict(list)
    for row in rows:
        if row.rank == 1:
            kinds[re.sub(r"[-+]?\d[\d.e+-]*", "#", row.text)[:90]].append(row)
    say("| cases | first of them | its words |\n|---|---|---|")
    for found in sorted(kinds.values(), key=len, reverse=True)[:40]:
        say(f"| {len(found)} | {found[0].key.replace('|', ', ')} | {found[0].text} |")
