"""The programs whose compilation is measured."""
from dataclasses import dataclass

CONSTRUCTORS = {
    "reference": ("pliant/reference.hpp", "Reference<double>"),
    "openmp": ("pliant/openmp.hpp", "OpenMP<double>"),
    "cuda": ("pliant/cuda.hpp", "Cuda<double>"),
}
NARROW = ["body/body", "element/linear", "law/neo_hookean", "mesh/box", "quadrature/gauss"]


@dataclass
class Unit:
    name: str
    what: str
    includes: list  # of pliant/, without the backend's
    main: str = ""
    backend: bool = True  # whether the backend's header is included too
    define: str = ""


ONE = """
using F = Formulation<Tet4, Gauss<1>, NeoHookean>;
int main() {{
  {backend} backend;
  auto const mesh = mesh::box<Tet4>({{.size = {{1, 1, 1}}, .cells = {{4, 4, 4}}}});
  Body body{{backend, mesh, Elastic{{5e5, 0.4, 1e3}}, Group<F>{{}}}};
  body.clamp(mesh.boundary("left"));
  {use}
}}
"""
FORCES = ONE.replace("{use}", "return body.forces().empty();")
REST = ONE.replace("{use}", "return solve_static(body).iterations;")
STEP = ONE.replace("{use}", "CentralDifference step;\n  step(body);\n  return body.forces().empty();")

LAWS = ["Hooke", "SaintVenantKirchhoff", "NeoHookean", "StableNeoHookean", "MooneyRivlin", "Yeoh"]
TWELVE = (
    """
int main() {{
  {backend} backend;
  auto const box = mesh::box<Hex8>({{.size = {{1, 1, 1}}, .cells = {{4, 4, 4}}}});
  Mesh<Tet4, Hex8> mesh{{box.nodes, {{}}}};
  mesh.elements<Hex8>() = box.elements<Hex8>();
  Body body{{backend, mesh, Elastic{{5e5, 0.4, 1e3}}, """
    + ", ".join(
        f"Group<Formulation<{element}, {{law}}>>{{{{}}}}".replace("{law}", f"Gauss<{points}>, {law}")
        for element, points in (("Tet4", 1), ("Hex8", 2))
        for law in LAWS
    )
    + """}};
  CentralDifference step;
  step(body);
  return body.forces().empty();
}}
"""
)

UNITS = [
    Unit("empty", "nothing: the compiler itself", [], "int main() {{}}\n", backend=False),
    Unit("include_narrow", "one element, one law and a body, not used", NARROW, "int main() {{}}\n"),
    Unit("include_umbrella", "pliant.hpp, not used", ["pliant"], "int main() {{}}\n"),
    Unit("include_eigen", "Eigen/Core alone, which only implicit solvers include", [],
         "#include <Eigen/Core>\nint main() {{}}\n", backend=False),  # fmt: skip
    Unit("forces_narrow", "Tet4, Gauss<1>, NeoHookean: body and forces", NARROW, FORCES),
    Unit("one_formulation_narrow", "the same with an explicit step",
         [*NARROW, "solver/central_difference"], STEP),  # fmt: skip
    Unit("one_formulation", "the same from pliant.hpp", ["pliant"], STEP),
    Unit("twelve_groups", "six laws on Tet4 and on Hex8 in one body, and an explicit step",
         ["pliant"], TWELVE),  # fmt: skip
    Unit("static", "one formulation brought to rest, from pliant.hpp and solve.hpp",
         ["pliant", "solve"], REST),  # fmt: skip
    Unit("static_with_solvers", "the same beside pliant::solvers", ["pliant", "solve"], REST,
         define="PLIANT_COMPILED_SOLVERS"),  # fmt: skip
]


def source_of(unit, backend):
    header, constructor = CONSTRUCTORS[backend]
    includes = [f"pliant/{name}.hpp" for name in unit.includes]
    if unit.backend:
        includes.append(header)
    lines = [f"#define {unit.define}"] if unit.define else []
    lines += [f"#include <{name}>" for name in includes]
    if includes:
        lines.append("using namespace pliant;")
    return "\n".join(lines) + "\n" + unit.main.format(backend=constructor)
