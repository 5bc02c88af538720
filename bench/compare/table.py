"""The table of bench/compare/run: folder of <before|after>.<round>.json, rounds, command, file for the figures."""

import json
import statistics
import sys
from pathlib import Path


def times(folder, which, rounds):
    """Of each benchmark: its time in every round, in microseconds."""
    found = {}
    for k in range(rounds):
        for run in json.loads((folder / f"{which}.{k}.json").read_text())["benchmarks"]:
            if not run.get("error_occurred"):
                name = run["name"].removesuffix("/manual_time")
                found.setdefault(name, []).append(run["real_time"])
    return found


def main():
    folder, rounds = Path(sys.argv[1]), int(sys.argv[2])
    before, after = (times(folder, which, rounds) for which in ("before", "after"))
    print("| benchmark | before, µs | after, µs | ratio | quartiles of the ratio |")
    print("|---|---|---|---|---|")
    for name in before:
        if len(before[name]) != len(after.get(name, [])):
            continue
        ratios = [b / a for a, b in zip(before[name], after[name])]
        low, middle, high = statistics.quantiles(ratios, n=4) if len(ratios) > 1 else 3 * ratios
        medians = (statistics.median(t[name]) for t in (before, after))
        print(f"| {name} | " + " | ".join(f"{m:.2f}" for m in medians)
              + f" | {middle:.3f} | {low:.3f} to {high:.3f} |")
    if len(sys.argv) > 4:
        context = json.loads((folder / "after.0.json").read_text())["context"]
        figures = {"command": sys.argv[3], "machine": context, "unit": "us",
                   "times": {"before": before, "after": after}}
        Path(sys.argv[4]).write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
