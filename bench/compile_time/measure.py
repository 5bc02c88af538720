#!/usr/bin/env python3
"""Measures what it costs to compile a program that uses Pliant: seconds and memory.

    bench/compile_time/measure.py [--backend BACKEND...] [--unit UNIT...] [--repetitions N]
                                  [--output FOLDER]

    --backend BACKEND   reference, openmp and cuda; all that have a compiler here unless given
    --unit UNIT         names of units.py; all unless given
    --repetitions N     the least of so many; 3 unless given
    --output FOLDER     where compile_time.json and .md go; bench/results unless given

Every unit is compiled alone, on one core, into an object file; nothing is linked or run. CXX and NVCC
in the environment name the compilers. A run replaces what it measures in the results, and leaves the rest.
"""
import argparse
import datetime
import json
import os
import re
import resource
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from units import UNITS, source_of

ROOT = Path(__file__).resolve().parents[2]
# What one formulation may take, s.
BARS = {"openmp": 6, "cuda": 20}


def flags_of(backend):
    """Those of the targets pliant::pliant, pliant::openmp and pliant::cuda, in Release."""
    roots = [ROOT / "include", ROOT / "backends/reference"]
    if backend != "reference":
        roots.append(ROOT / "backends" / backend)
    includes = [f"-I{root}" for root in roots]
    eigen = os.environ.get("EIGEN", "/usr/include/eigen3")
    if backend == "cuda":
        nvcc = os.environ.get("NVCC") or shutil.which("nvcc") or "/usr/local/cuda/bin/nvcc"
        code = "--generate-code=arch=compute_90,code=[compute_90,sm_90]"
        return [nvcc, *includes, f"-isystem={eigen}", "-O3", "-DNDEBUG", code, "-std=c++20",
                "--expt-relaxed-constexpr", "--diag-suppress=20012"]  # fmt: skip
    flags = [os.environ.get("CXX", "g++"), *includes, "-isystem", eigen, "-O3", "-DNDEBUG",
             "-std=gnu++20"]  # fmt: skip
    if backend == "openmp":
        flags += ["-march=native", "-fopenmp"]
        if "g++" in flags[0] and version_of(flags[0]) < 13:
            flags.append("-fno-tree-slp-vectorize")
    return flags


def version_of(compiler):
    return int(subprocess.check_output([compiler, "-dumpversion"], text=True).split(".")[0])


def compile_once(command):
    """Wall and processor seconds, and the most memory that one process of the compiler held, MiB.

    In a process of its own: what children used is known of all of them together only.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        started = time.monotonic()
        done = subprocess.run(command, capture_output=True, text=True)
        wall = time.monotonic() - started
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        result = {"wall": wall, "processor": used.ru_utime + used.ru_stime,
                  "memory": used.ru_maxrss / 1024, "errors": done.stderr[-2000:] if done.returncode else ""}  # fmt: skip
        os.write(writing, json.dumps(result).encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        result = json.loads(pipe.read())
    os.waitpid(child, 0)
    if result["errors"]:
        raise SystemExit(" ".join(command) + "\n" + result["errors"])
    return result


def measure(backend, unit, repetitions, folder):
    source = folder / f"{unit.name}_{backend}{'.cu' if backend == 'cuda' else '.cpp'}"
    source.write_text(source_of(unit, backend), encoding="utf-8")
    command = [*flags_of(backend), "-c", str(source), "-o", str(folder / "unit.o")]
    runs = [compile_once(command) for _ in range(repetitions)]
    least = {what: min(run[what] for run in runs) for what in ("wall", "processor", "memory")}
    print(f"{backend:10} {unit.name:28} {least['processor']:6.2f} s {least['memory']:6.0f} MiB",
          flush=True)  # fmt: skip
    return {
        "backend": backend,
        "unit": unit.name,
        "what": unit.what,
        "seconds": round(least["processor"], 3),
        "wall seconds": round(least["wall"], 3),
        "largest seconds": round(max(run["processor"] for run in runs), 3),
        "memory MiB": round(least["memory"], 1),
        "object KiB": round((folder / "unit.o").stat().st_size / 1024, 1),
        "repetitions": repetitions,
    }


def context_of(backend):
    command = flags_of(backend)
    text = subprocess.check_output([command[0], "--version"], text=True)
    compiler = next(line for line in reversed(text.splitlines()) if re.search(r"\d+\.\d+", line))
    if backend != "cuda":
        compiler = text.splitlines()[0]
    processor = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M)
    shown = [part.replace(str(ROOT) + "/", "") for part in command]
    return {
        "machine": f"{processor.group(1) if processor else 'unknown'}, {os.cpu_count()} cores",
        "compiler": compiler.strip(),
        "command": " ".join([Path(shown[0]).name, *shown[1:]]) + " -c",
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d"),
        "commit": subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"],
                                 capture_output=True, text=True).stdout.strip() or "unknown",
        "load before": os.getloadavg()[0],
    }  # fmt: skip


def table_of(results):
    lines = [
        "# Compile time",
        "",
        "What `bench/compile_time/measure.py` measured: processor seconds (user and system) of one",
        "compiler run on one core, the least of the repetitions, and the memory of its largest",
        "process. Nothing is linked. A machine with other work to do takes longer: see the load.",
    ]
    for backend, context in results["context"].items():
        lines += [
            "",
            f"## {backend}",
            "",
            f"{context['machine']}, {context['compiler']}, {context['date']}, commit"
            f" {context['commit']}, load before {context['load before']:.1f}:",
            "",
            f"    {context['command']}",
            "",
            "| unit | what | seconds | memory, MiB | object, KiB | bar |",
            "| --- | --- | --- | --- | --- | --- |",
        ]
        for run in results["units"]:
            if run["backend"] != backend:
                continue
            bar = ""
            if run["unit"].startswith("one_formulation") and backend in BARS:
                reached = "reached" if run["seconds"] < BARS[backend] else "not reached"
                bar = f"< {BARS[backend]} s: {reached}"
            lines.append(
                f"| {run['unit']} | {run['what']} | {run['seconds']:.2f} | {run['memory MiB']:.0f} |"
                f" {run['object KiB']:.0f} | {bar} |"
            )
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--backend", nargs="+", choices=["reference", "openmp", "cuda"])
    parser.add_argument("--unit", nargs="+", choices=[unit.name for unit in UNITS])
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--output", type=Path, default=ROOT / "bench/results")
    arguments = parser.parse_args()
    backends = arguments.backend or ["reference", "openmp"]
    if not arguments.backend and shutil.which(flags_of("cuda")[0]):
        backends.append("cuda")

    file = arguments.output / "compile_time.json"
    results = {"context": {}, "units": []}
    if file.exists():
        results = json.loads(file.read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        for backend in backends:
            results["context"][backend] = context_of(backend)
            for unit in UNITS:
                if arguments.unit and unit.name not in arguments.unit:
                    continue
                run = measure(backend, unit, arguments.repetitions, Path(folder))
                results["units"] = [
                    other for other in results["units"]
                    if (other["backend"], other["unit"]) != (backend, unit.name)
                ] + [run]  # fmt: skip
                write(results, file)


def write(results, file):
    order = [unit.name for unit in UNITS]
    results["units"].sort(key=lambda run: (run["backend"], order.index(run["unit"])))
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    file.with_suffix(".md").write_text(table_of(results), encoding="utf-8")


if __name__ == "__main__":
    main()
