#include <dlfcn.h>

#include <ctime>
#include <fstream>

#include "peer_contest.hpp"

// Pliant's forces and tangent products beside those of other libraries, on one core in double precision: deal.II's
// MatrixFree, and for linear elements the product with the assembled stiffness by Eigen and a plain loop over elements
// with atomic additions. All compute on one mesh, agree to 1e-10 of the largest value or stop the program, and run in
// turns; the least times count. It prints a table in M elements/s and writes JSON. Arguments: the JSON file, turns, and libraries
// of the target forces_of_deal_ii, by several compilers if wanted: Pliant is put over the fastest.
namespace pliant::bench {

MakePeer* loaded(char const* file) {
  void* const library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  void* const function = library == nullptr ? nullptr : dlsym(library, make_peer_name);
  if (function == nullptr) {
    std::fprintf(stderr, "cannot load %s: %s\n", file, dlerror());
    std::exit(1);
  }
  return reinterpret_cast<MakePeer*>(function);
}

std::string compiler() {
#if defined(__clang__)
  return "clang++ " + std::to_string(__clang_major__);
#else
  return "g++ " + std::to_string(__GNUC__);
#endif
}

std::string today() {
  std::time_t const now = std::time(nullptr);
  char text[16];
  std::strftime(text, sizeof(text), "%F", std::gmtime(&now));
  return text;
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

void print_head() {
  std::printf("Pliant by %s on one core, double precision, M elements/s\n\n", compiler().c_str());
  std::printf(
      "| element | law | product | Pliant | deal.II, its fastest | ratio | assembled, by Eigen | "
      "plain "
      "loop |\n|---|---|---|---|---|---|---|---|\n");
}
void print(Row const& row) {
  Contestant const* best = nullptr;
  for (auto const& one : row.all)
    if (one.kind == Kind::deal_ii && (best == nullptr || one.least < best->least)) best = &one;
  std::printf("| %s | %s | %s | %.3g |", row.element.c_str(), row.law.c_str(), row.product.c_str(),
              row.rate(Kind::pliant));
  if (best == nullptr)
    std::printf(" – | – |");
  else
    std::printf(" %.3g (%s) | **%.2f** |", row.rate(*best), best->name.c_str(),
                row.rate(Kind::pliant) / row.rate(*best));
  for (Kind const kind : {Kind::assembled, Kind::plain})
    if (double const rate = row.rate(kind); rate > 0)
      std::printf(" %.3g |", rate);
    else
      std::printf(" – |");
  std::printf("\n");
  std::fflush(stdout);
}

void write(std::string const& file, std::vector<Row> const& table, std::string const& command) {
  std::ofstream out(file);
  out.precision(4);
  out << "{\n \"context\": {\n  \"date\": \"" << today() << "\",\n  \"machine\": \"" << processor()
      << "\",\n  \"compiler\": \"" << compiler()
      << "\",\n  \"unit\": \"M elements/s on one core, double\""
      << ",\n  \"command\": \"" << command << "\"\n },\n \"rows\": [";
  char const* between = "\n";
  for (auto const& row : table) {
    out << between << "  {\n   \"element\": \"" << row.element << "\",\n   \"law\": \"" << row.law
        << "\",\n   \"product\": \"" << row.product << "\",\n   \"elements\": " << row.elements
        << ",\n   \"compiler\": \"" << compiler() << "\"";
    for (auto const& one : row.all) out << ",\n   \"" << one.name << "\": " << row.rate(one);
    if (double const peer = row.rate(Kind::deal_ii); peer > 0)
      out << ",\n   \"Pliant over the fastest deal.II\": " << row.rate(Kind::pliant) / peer;
    out << "\n  }";
    between = ",\n";
  }
  out << "\n ]\n}\n";
  if (!out.flush()) {
    std::fprintf(stderr, "cannot write %s\n", file.c_str());
    std::exit(1);
  }
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant;
  using namespace pliant::bench;
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s JSON TURNS [LIBRARY...]\n", argv[0]);
    return 1;
  }
  int const turns = std::max(1, std::atoi(argv[2]));
  std::vector<MakePeer*> libraries;
  for (int k = 3; k < argc; ++k) libraries.push_back(loaded(argv[k]));
  std::vector<Row> table;
  print_head();
  auto const compare = [&]<class E, Geometry How>(std::string const& name, double elements) {
    OrderedMesh<E> ordered(cells_for<E>(elements));
    if constexpr (How == Geometry::straight) straighten(ordered.mesh);
    Contest<E> contest(name, ordered, libraries);
    auto const begin = table.size();
    contest.template run<SaintVenantKirchhoff, How>(PeerLaw::saint_venant_kirchhoff, turns, table);
    contest.template run<NeoHookean, How>(PeerLaw::neo_hookean, turns, table);
    for (auto k = begin; k < table.size(); ++k) print(table[k]);
  };
  constexpr auto isoparametric = Geometry::isoparametric;
  compare.operator()<Tet4, isoparametric>("Tet4", 2e5);
  compare.operator()<Tet10, Geometry::straight>("Tet10, straight", 5e4);
  compare.operator()<Tet10, isoparametric>("Tet10, curved", 5e4);
  compare.operator()<Hex8, isoparametric>("Hex8", 2e5);
  compare.operator()<Hex27, isoparametric>("Hex27", 2.5e4);
  write(argv[1], table,
        "OMP_NUM_THREADS=1 bench/forces_against_peers JSON " + std::to_string(turns) +
            " libforces_of_deal_ii.so of g++ and of clang++; targets forces_against_peers, "
            "forces_of_deal_ii");
}
