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

width = 3
height = math.ceil(len(panels) / width)
figure, axes = plt.subplots(height, width, figsize=(6 * width, 4.4 * height), squeeze=False)
for axis in axes.flat[len(panels):]:
    axis.set_axis_off()
for panel, axis in zip(panels, axes.flat):
    here = [row for row in rows if row["group"] == panel]
    lines = list(dict.fromkeys((row["problem"], row["composition"]) for row in here))
    for k, line in enumerate(lines):
        points = [(1 / float(r["n"]), abs(float(r["error"]))) for r in here
                  if (r["problem"], r["composition"]) == line]
        style = ["-", "--", ":", "-."][k // 10 % 4]
        axis.loglog(*zip(*points), style, marker="o", markersize=3, label=", ".join(line))
    axis.set_title(panel, fontsize=10)
    axis.set_xlabel("1/n")
    axis.set_ylabel("error")
    axis.grid(True, which="major", alpha=0.3)
    axis.legend(fontsize=4.5, loc="best")
figure.tight_layout()
figure.savefig(output, dpi=60)
