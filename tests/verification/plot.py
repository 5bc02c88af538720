#!/usr/bin/env python3
"""Plots errors against mesh size from rows that the programs here printed (needs matplotlib).

    tests/verification/plot.py errors.png errors.csv
"""
import csv
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

output, *inputs = sys.argv[1:]
columns = ["group", "problem", "composition", "n", "error"]
rows = [row for name in inputs for row in csv.DictReader(open(name), columns)]
panels = list(dict.fromkeys(row["group"] for row in rows))

MARKERS = "osv^D<>pPX*hHd8"
STYLES = ["-", "--", ":", "-."]


def distinct(rows, column):
    return list(dict.fromkeys(row[column] for row in rows))


# Colours tell compositions, marks and dashes tell what was asked.
width = 2
height = math.ceil(len(panels) / width)
figure, axes = plt.subplots(height, width, figsize=(9 * width, 4.2 * height), squeeze=False,
                            layout="constrained")
for axis in axes.flat[len(panels):]:
    axis.set_axis_off()
for panel, axis in zip(panels, axes.flat):
    here = [row for row in rows if row["group"] == panel]
    problems, compositions = distinct(here, "problem"), distinct(here, "composition")
    look = {p: {"marker": MARKERS[k % len(MARKERS)], "linestyle": STYLES[k % len(STYLES)], "markersize": 4}
            for k, p in enumerate(problems)}
    colour = dict(zip(compositions, matplotlib.colormaps["tab20"].colors))
    for problem in problems:
        for composition in compositions:
            points = [(1 / float(r["n"]), abs(float(r["error"]))) for r in here
                      if (r["problem"], r["composition"]) == (problem, composition)]
            if points:
                axis.loglog(*zip(*points), color=colour[composition], linewidth=1, **look[problem])
    axis.set_title(panel, fontsize=10)
    axis.set_xlabel("1/n")
    axis.set_ylabel("error")
    axis.grid(True, which="major", alpha=0.3)
    legend = [plt.Line2D([], [], color="black", label=p, **look[p]) for p in problems]
    legend += [plt.Line2D([], [], color=colour[c], linewidth=4, label=c) for c in compositions]
    axis.legend(handles=legend, fontsize=6, loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
figure.savefig(output, dpi=70)
