#!/usr/bin/env python3
"""Writes what bench/run measured as Markdown, and prints how it stands to the bars.

    bench/table.py RESULT.json [TABLE.md]

All ratios are of rates measured in the same run, unless a row says that it quotes a peer.
"""
import json
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from bars import BARS, law_times  # noqa: E402


class Results:
    """What was measured, by name: what/element/law/precision/backend/elements, or ceiling/..."""

    def __init__(self, data):
        self.context = data["context"]
        self.runs = {run["name"]: run for run in data["benchmarks"]}

    def seconds(self, *path):
        run = self.runs[self._name(path)]
        return run["real_time"] * {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1}[run["time_unit"]]

    def least_seconds(self, name):
        """Of the fastest repetition."""
        run = self.runs[name]
        return self.seconds(name) * run["least"] / run["real_time"]

    def rate(self, counter, *path):
        return self.runs[self._name(path)][counter]

    def items(self, *path):
        return self.rate("items_per_second", *path)

    def _name(self, path):
        """The one run of this path; a last number stands for the mesh of about as many elements."""
        *names, last = path
        if not isinstance(last, (int, float)):
            return "/".join(path)
        prefix = "/".join(names) + "/"
        sizes = [n for n in self.runs if n.startswith(prefix) and n.count("/") == prefix.count("/")]
        near = [n for n in sizes if 0.8 < float(n.rsplit("/", 1)[1]) / last < 1.25]
        if len(near) != 1:
            raise KeyError("/".join(map(str, path)))
        return near[0]

    def ceilings(self):
        """The copy rate (bytes/s) and the multiply-add rate (flop/s) that belong to a run."""

        def of(backend, precision):
            return (
                self.runs.get(f"copy/{backend}", {}).get("bytes_per_second"),
                self.runs.get(f"multiply-add/{precision}/{backend}", {}).get("flops"),
            )

        return of


def si(value, unit=""):
    for size, prefix in ((1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")):
        if value >= size:
            return f"{value / size:.3g} {prefix}{unit}"
    return f"{value:.3g} {unit}".rstrip()


def time(seconds):
    for size, unit in ((1, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def markdown(header, rows):
    """A table whose columns also line up as text."""
    rows = [[str(cell) for cell in row] for row in [header, *rows]]
    widths = [max(len(row[k]) for row in rows) for k in range(len(header))]
    rows.insert(1, ["-" * w for w in widths])
    return "\n".join(
        "| " + " | ".join(cell.ljust(w) for cell, w in zip(row, widths)) + " |" for row in rows
    )


def bar_rows(results):
    for bar in BARS[results.context["backend"]]:
        try:
            value = bar.measure(results)
        except KeyError as missing:
            yield [bar.name, f"not measured ({missing.args[0]})", bar.wanted(), ""]
            continue
        yield [bar.name, bar.show(value), bar.wanted(), "yes" if bar.reached(value) else "no"]


def ceiling_rows(results):
    for name, run in results.runs.items():
        if name.count("/") < 5:
            for counter, unit in (
                ("bytes_per_second", "B/s"),
                ("flops", "flop/s"),
                ("items_per_second", "nodes/s"),
            ):
                if counter in run:
                    yield [name, si(run[counter], unit), f"{100 * run['cv']:.1f}%"]
                    break
            else:
                yield [name, time(results.seconds(name)), f"{100 * run['cv']:.1f}%"]


def run_rows(results):
    ceilings = results.ceilings()
    for name, run in results.runs.items():
        if name.count("/") != 5:
            continue
        what, element, law, precision, backend, elements = name.split("/")
        copy, flops = ceilings(backend, precision)

        def share(counter, ceiling):
            return f"{100 * run[counter] / ceiling:.1f}%" if counter in run and ceiling else ""

        yield [
            what, element, law, precision, backend, elements, time(results.seconds(name)),
            si(run["items_per_second"]), share("bytes_per_second", copy), share("flops", flops),
            f"{100 * run['cv']:.1f}%",
        ]  # fmt: skip


def law_rows(results):
    """A row per law: the time as the library derives it over that by hand."""
    times = law_times(results)
    for what, law in dict.fromkeys((at[0], at[2]) for at in times):
        row = [what, law]
        for element in ("Tet4", "Hex8"):
            for precision in ("float", "double"):
                both = times.get((what, element, law, precision))
                row.append(f"{both['derived'] / both['by hand']:.2f}" if both else "")
        yield row


def size_rows(results):
    """G elements/s of forces by the power of ten of boxes' elements."""
    rates = {}
    for name, run in results.runs.items():
        if found := re.fullmatch(r"force at 1e(\d)/(\w+)/\w+/(\w+)/([^/]+)/\d+", name):
            digits, *rest = found.groups()
            rates.setdefault(tuple(rest), {})[digits] = run["items_per_second"]
    for at, by_size in rates.items():
        yield [*at, *(f"{by_size[d] / 1e9:.3g}" if d in by_size else "" for d in "45678")]


def unstructured_rows(results):
    runs = {}
    for name in results.runs:
        if found := re.fullmatch(r"(\w+) of (Delaunay|box)/\w+/\w+/(\w+)/([^/]+)/(\d+)", name):
            what, kind, precision, backend, elements = found.groups()
            runs.setdefault((what, precision, backend), {})[kind] = name, elements
    for at, kinds in runs.items():
        if len(kinds) == 2:
            names, elements = zip(kinds["Delaunay"], kinds["box"])
            rates = [results.items(name) for name in names]
            yield [*at, *elements, *map(si, rates), f"{rates[0] / rates[1]:.2f}"]


def memory_rows(results):
    """Bytes of bodies by element and node, on the device and on the host."""
    for name, run in results.runs.items():
        if "host bytes/element" not in run:
            continue
        what, element, law, precision, backend = name.split("/")[:5]
        taken = (f"{run[f'{where} bytes/{of}']:.4g}" for where in ("device", "host") for of in ("element", "node"))
        yield [what, element, law, precision, backend, f"{run['elements']:.0f}", *taken]


def section(title, text, header, rows):
    """Nothing where nothing of it was measured."""
    rows = list(rows)
    return f"## {title}\n\n{text}\n\n{markdown(header, rows)}\n\n" if rows else ""


def main():
    data = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    results = Results(data)
    context = results.context
    bars = markdown(["bar", "measured", "wanted", "reached"], bar_rows(results))
    how = (
        f"{context['compiler']}, {context['date']}, commit {context['commit']}: "
        f"`{context['command']}`.\nLoad of the machine before: {context['load_avg'][0]:.1f} on "
        f"{context['num_cpus']} cores"
    )
    print(f"\n{context['machine']}, {how}\n\n{bars}")
    if len(sys.argv) < 3:
        return
    ceilings = markdown(["ceiling", "measured", "variation"], ceiling_rows(results))
    laws = markdown(
        ["what", "law", "Tet4 float", "Tet4 double", "Hex8 float", "Hex8 double"],
        sorted(law_rows(results)),
    )
    runs = markdown(
        ["what", "element", "law", "precision", "backend", "elements", "time", "elements/s",
         "of copy", "of FMA", "variation"],
        run_rows(results),
    )  # fmt: skip
    sizes = section(
        "Elements per second over mesh size",
        "G elements/s of forces under Saint Venant-Kirchhoff, of boxes of about so many elements. Empty where it was\n"
        "not measured: 10⁸ are for a GPU in single precision.",
        ["element", "precision", "backend", "10⁴", "10⁵", "10⁶", "10⁷", "10⁸"],
        size_rows(results),
    )
    unstructured = section(
        "Unstructured beside box",
        "Elements/s of Tet4 under Saint Venant-Kirchhoff: of a cube that Gmsh divided by a Delaunay triangulation, with\n"
        "nodes and elements in random order (bench/delaunay), beside a box of six tetrahedra to a cell.",
        ["what", "precision", "backend", "Delaunay elements", "box elements", "Delaunay", "box", "ratio"],
        unstructured_rows(results),
    )
    memory = section(
        "Memory",
        "Bytes that bodies hold after some explicit steps, by the element and by the node: in the memory of a GPU,\n"
        "with what its kernels reserve, and in that of the host.",
        ["what", "element", "law", "precision", "backend", "elements", "device, of an element", "of a node",
         "host, of an element", "of a node"],
        memory_rows(results),
    )  # fmt: skip
    Path(sys.argv[2]).write_text(
        f"""# {context["backend"]} on {context["machine"]}

{how}. Medians of the repetitions; variation is their
standard deviation over their mean.

## Bars

Ratios of rates measured in this run, unless a row quotes a peer.

{bars}

## Ceilings

A node add adds three values to a node at random. Copies count bytes read and bytes written.

{ceilings}

## Laws

The time of forces and tangent products as the library derives them from the energy, over that of
the same law with its stress, or its tangent too, written by hand (bench/law/by_hand.hpp). Fastest
repetitions of both: what else runs on a machine only adds.

{laws}

{sizes}{unstructured}{memory}## Everything

`of copy` is the mandatory traffic (connectivity, and each value of a node read or written, once)
over the copy ceiling; `of FMA` counts 265 operations for a Tet4 force and 2734 for a Hex8 one.

{runs}
""",
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
