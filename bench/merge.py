#!/usr/bin/env python3
"""Makes one file of what several benchmark programs wrote.

    bench/merge.py RESULT PART... --context KEY=VALUE...

Of each benchmark's repetitions the median is kept, with the `least` of the times and their coefficient
of variation as `cv`.
"""
import argparse
import json
import sys

# Tells nothing about speed, or where it was measured.
LEFT_OUT = ("host_name", "executable", "library_build_type", "json_schema_version")


def benchmarks_of(part):
    """Medians by name, each with the least and the variation of its times."""
    spread, least = {}, {}
    for run in part["benchmarks"]:
        name = run["run_name"]
        if run.get("aggregate_name") == "cv":
            spread[name] = run["real_time"]
        elif run["run_type"] == "iteration" and not run.get("error_occurred"):
            least[name] = min(run["real_time"], least.get(name, run["real_time"]))
    for run in part["benchmarks"]:
        if run.get("error_occurred"):
            print(f"{run['name']}: {run.get('error_message')}", file=sys.stderr)
        elif run.get("aggregate_name") == "median":
            yield {
                "name": run["run_name"].removesuffix("/manual_time"),
                "repetitions": run["repetitions"],
                "cv": spread[run["run_name"]],
                "least": least[run["run_name"]],
                **{k: v for k, v in run.items() if isinstance(v, float) and k != "cpu_time"},
                "time_unit": run["time_unit"],
            }


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("result")
    arguments.add_argument("parts", nargs="+")
    arguments.add_argument("--context", nargs="+", default=[])
    arguments = arguments.parse_args()

    context, benchmarks = {}, []
    for name in arguments.parts:
        try:
            with open(name, encoding="utf-8") as file:
                part = json.load(file)
        except ValueError:
            print(f"{name}: cut off, left out", file=sys.stderr)
            continue
        if not context:
            context = {k: v for k, v in part["context"].items() if k not in LEFT_OUT}
        benchmarks += benchmarks_of(part)
    context |= dict(pair.split("=", 1) for pair in arguments.context)
    with open(arguments.result, "w", encoding="utf-8") as file:
        json.dump({"context": context, "benchmarks": benchmarks}, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    main()
