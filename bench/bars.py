"""The bars that the benchmarks are held against, by backend."""
import re
from dataclasses import dataclass
from typing import Callable

SVK = "SaintVenantKirchhoff"
CPU, GPU = 2e5, 1e6  # elements of the usual meshes


@dataclass
class Bar:
    name: str
    measure: Callable  # of Results; KeyError where something was not measured
    limit: float
    unit: str = "x"  # x: a ratio; %: a share; µs: a time
    at_most: bool = False

    def reached(self, value):
        return value <= self.limit if self.at_most else value >= self.limit

    def show(self, value):
        scale = {"x": 1, "%": 100, "µs": 1e6}[self.unit]
        return f"{value * scale:.3g}{'' if self.unit == 'x' else ' '}{self.unit}"

    def wanted(self):
        return ("≤ " if self.at_most else "≥ ") + self.show(self.limit)


def checks_cost(backend, size, element="Tet4", precision="float"):
    """What a check of criteria every eighth step adds to a run."""
    at = (element, SVK, precision, backend, size)
    return lambda r: r.items("step", *at) / r.items("8 steps+check", *at) - 1


def share_of_peak(element):
    at = (element, SVK, "float", "OpenMP-1", CPU)
    return lambda r: r.rate("flops", "force", *at) / r.rate("flops", "multiply-add/float/OpenMP-1")


def faster(over, under, element, precision, what="force"):
    """One backend over another."""
    at = (what, element, SVK, precision)
    return lambda r: r.items(*at, over, CPU) / r.items(*at, under, CPU)


def law_times(r):
    """(force or tangent, element, law, precision): seconds as derived, and by hand."""
    times = {}
    for name in r.runs:
        found = re.fullmatch(r"(force|tangent) (derived|by hand)/(\w+)/(\w+)/(\w+)/[^/]+/\d+", name)
        if found:
            what, how, *rest = found.groups()
            times.setdefault((what, *rest), {})[how] = r.seconds(name)
    return {at: both for at, both in times.items() if len(both) == 2}


def dearest_law(what):
    """The worst ratio over laws, elements and precisions, derived over by hand."""

    def measure(r):
        ratios = [t["derived"] / t["by hand"] for at, t in law_times(r).items() if at[0] == what]
        if not ratios:
            raise KeyError(f"{what} derived")
        return max(ratios)

    return measure


LAWS = [
    Bar(f"{what} of the dearest law, derived over by hand", dearest_law(what), 1.1, at_most=True)
    for what in ("force", "tangent")
]

OPENMP = [
    Bar("Tet4 float force, of FMA peak", share_of_peak("Tet4"), 0.20, "%"),
    Bar("Hex8 float force, of FMA peak", share_of_peak("Hex8"), 0.38, "%"),
    *(
        Bar(
            f"{element} {precision} force, packs over the scalar loop",
            faster("OpenMP-1", "Reference", element, precision),
            4.5,
        )
        for element in ("Tet4", "Hex8")
        for precision in ("float", "double")
    ),
    *(
        Bar(
            f"{element} {precision} force, two threads over one",
            faster("OpenMP-2", "OpenMP-1", element, precision),
            1.8,
        )
        for element in ("Tet4", "Hex8")
        for precision in ("float", "double")
    ),
    Bar("Tet4 criteria every 8 steps, of the run", checks_cost("OpenMP-1", CPU), 0.02, "%", True),
    *LAWS,
]


def over(other, element, precision, size):
    """The backend's forces over another kernel of the same run."""
    at = (element, SVK, precision, "Cuda", size)
    return lambda r: r.items("force", *at) / r.items(other, *at)


def node_add_limit(r):
    forces = r.items("force", "Hex8", SVK, "float", "Cuda", GPU)
    return forces / (r.items("node-add/float/Cuda") / 8)


def moving(r):
    """What moving 1% of the elements adds to a check that moves none."""
    at = ("Tet4", SVK, "float", "Cuda", GPU)
    return r.seconds("migration", *at) - r.seconds("check", *at)


def over_peer(what, element, law, precision, size, peer):
    """`peer`: elements/s, measured earlier on an H200."""

    def measure(r):
        if "H200" not in r.context["machine"]:
            raise KeyError("the peer was measured on an H200")
        return r.items(what, element, law, precision, "Cuda", size) / peer

    return measure


# G elements/s of the best peer: residual, tangent product.
PEERS = [
    ("force", "Tet4", SVK, "float", 1e6, 11.0, 4),
    ("force", "Tet4", SVK, "float", 20e6, 12.7, 4),
    ("force", "Tet4", SVK, "double", 1e6, 7.9, 3),
    ("force", "Tet4", SVK, "double", 20e6, 8.4, 3),
    ("tangent", "Tet4", SVK, "float", 1e6, 10.6, 4),
    ("tangent", "Tet4", SVK, "float", 20e6, 12.1, 4),
    ("tangent", "Tet4", SVK, "double", 1e6, 6.9, 3),
    ("tangent", "Tet4", SVK, "double", 20e6, 7.2, 3),
    ("force", "Hex8", SVK, "float", 1e6, 3.8, 2.5),
    ("force", "Hex8", SVK, "double", 1e6, 2.1, 1.6),
    ("force", "Hex8", "NeoHookean", "float", 1e6, 5.0, 2.5),
    ("force", "Hex8", "NeoHookean", "double", 1e6, 1.2, 1.6),
    ("tangent", "Hex8", SVK, "float", 1e6, 2.7, 2.5),
    ("tangent", "Hex8", SVK, "double", 1e6, 1.4, 1.6),
    ("tangent", "Hex8", "NeoHookean", "float", 1e6, 1.8, 2.5),
    ("tangent", "Hex8", "NeoHookean", "double", 1e6, 0.8, 1.6),
]
# The product with the assembled matrix, cuSPARSE CSR.
ASSEMBLED = [("float", 20e6, 17.1), ("double", 20e6, 10.9)]

CUDA = [
    *(
        Bar(f"Tet4 {precision} {size:.0e} force over {name}", over(other, "Tet4", precision, size), limit, unit)
        for precision, size, other, name, limit, unit in (
            ("float", 20e6, "compute", "gathering and computing alone", 0.70, "%"),
            ("float", 1e6, "compute", "gathering and computing alone", 0.55, "%"),
            ("float", 20e6, "scatter", "plain scatter", 2, "x"),
            ("float", 1e6, "scatter", "plain scatter", 2, "x"),
            ("double", 20e6, "compute", "gathering and computing alone", 0.60, "%"),
            ("double", 20e6, "scatter", "plain scatter", 4, "x"),
        )
    ),
    Bar("Hex8 float 1e+06 force over the node-add ceiling / 8", node_add_limit, 0.90, "%"),
    *(
        Bar(
            f"Tet4 float {size:.0e} explicit step",
            lambda r, size=size: r.seconds("step", "Tet4", SVK, "float", "Cuda", size),
            limit,
            "µs",
            True,
        )
        for size, limit in ((48e3, 6e-6), (1e6, 27e-6))
    ),
    Bar("Tet4 float 1e+06 moving 1% of the elements", moving, 8e-6, "µs", True),
    Bar("Tet4 float 1e+06 criteria every 8 steps, of the run", checks_cost("Cuda", GPU), 0.02, "%", True),
    *(
        Bar(
            f"{element} {precision} {size:.0e} {what} {law} over the best peer, {peer} G/s",
            over_peer(what, element, law, precision, size, peer * 1e9),
            limit,
        )
        for what, element, law, precision, size, peer, limit in PEERS
    ),
    *(
        Bar(
            f"Tet4 {precision} {size:.0e} tangent over the assembled product, {peer} G/s",
            over_peer("tangent", "Tet4", SVK, precision, size, peer * 1e9),
            2,
        )
        for precision, size, peer in ASSEMBLED
    ),
    *LAWS,
]

BARS = {"openmp": OPENMP, "cuda": CUDA}
