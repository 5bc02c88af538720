#include "guard/kernels.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

// kernels KERNEL REPEATS: does one of them so often, for a program that counts instructions. Without arguments it
// lists the kernels with the elements of their mesh.
int main(int argc, char** argv) {
  using namespace pliant;
  std::string const asked = argc > 1 ? argv[1] : "";
  int const repeats = argc > 2 ? std::atoi(argv[2]) : 0;
  bench::on_each_guarded([&]<class K>(K) {
    using F = typename K::formulation;
    using E = typename F::element;
    using B = OpenMP<typename K::scalar>;
    constexpr int cells = E::dim == 2 ? 16 : 4;
    auto const one = [&](char const* what, auto const& add) {
      std::string const name =
          std::string(what) + "/" + E::name() + "/" + bench::precision_name<typename K::scalar>();
      if (asked.empty()) std::printf("%s %ld\n", name.c_str(), bench::element_count<E>(cells));
      if (asked != name) return;
      B const backend{{.threads = 1}};
      auto& problem = bench::Problem<B, E>::of(backend, cells);
      for (int k = 0; k < repeats; ++k) add(backend, problem);
    };
    one("force", [](auto const& b, auto& p) { bench::add_force<F>(b, p); });
    one("tangent", [](auto const& b, auto& p) { bench::add_tangent<F>(b, p); });
  });
}
