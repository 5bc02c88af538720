#!/usr/bin/env python3
"""Plots the error of single precision from rows that float_error printed (needs matplotlib).

    bench/accuracy/plot.py bench/results/float_error.png bench/results/float_error*.csv
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

output, *inputs = sys.argv[1:]
rows = [row for name in inputs for row in csv.DictReader(open(name))]
backends = sorted({row["backend"] for row in rows})
elements = list(dict.fromkeys(row["element"] for row in rows))
laws = list(dict.fromkeys(row["law"] for row in rows))

quantities = ["force error over largest force", "relative energy error"]
colours = dict(zip(laws, matplotlib.colormaps["tab20"].colors))
figure, axes = plt.subplots(len(quantities), len(elements), figsize=(16, 8.5), sharex=True, sharey="row",
                            layout="constrained")
for line, quantity in zip(axes, quantities):
    for axis, element in zip(line, elements):
        for law, colour in colours.items():
            for backend, style in zip(backends, ["-", "--"]):
                points = [(float(r["strain"]), float(r[quantity])) for r in rows
                          if (r["backend"], r["element"], r["law"]) == (backend, element, law)]
                if points:
                    axis.loglog(*zip(*points), style, color=colour, label=f"{law}, {backend}")
        axis.set_title(element)
        axis.grid(True, which="major", alpha=0.3)
        axis.axhline(2.0**-24, color="black", linewidth=0.6)
    line[0].set_ylabel(quantity)
for axis in axes[-1]:
    axis.set_xlabel("strain")
# Every line once, whichever element has it.
lines = {}
for axis in axes[0]:
    lines |= {label: line for line, label in zip(*axis.get_legend_handles_labels())}
lines = dict(sorted(lines.items()))
figure.get_layout_engine().set(rect=(0, 0.08, 1, 0.92))  # room for the legend
figure.legend(lines.values(), lines.keys(), loc="lower center", ncols=5, fontsize=8)
figure.suptitle("float against Reference<double>; the black line is half a unit in the last place of 1")
figure.savefig(output, dpi=110)
