#include <tuple>

#include "adaptation/migration_suite.hpp"
#include "support/program.hpp"

namespace pliant::bench {

/// The part of a migration in which patches put their elements in the order of groups anew, after 1%
/// of them, scattered, changed. (On a GPU kernels read tags, and nothing is left to do.)
template <class E, class B>
void time_regroup(benchmark::State& state, B const& backend, int cells) {
  auto& [body, before, after] = made_once([&] {
    auto b = two_laws<E>(backend, cells);
    auto const tags = [&b] { return download<Tag>(std::get<0>(b.state().elements).tags); };
    auto const old_tags = tags();
    exchange_above<E>(ratio_exceeded_by<E>(0.01, b)).now(b);
    auto const new_tags = tags();
    return std::tuple{std::move(b), old_tags, new_tags};
  });
  auto& elements = body.parts().layout.template table<E>().elements;
  auto& tags = std::get<0>(body.parts().state.elements).tags;
  bool there = true;
  for (auto _ : state) {
    tags.upload(there ? before : after);
    there = !there;
    state.SetIterationTime(seconds(backend, [&] { elements.regroup(); }));
  }
  report_elements(state, body);
}

void add_regroups() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    if (role != Role::main) return;
    int const cells = usual_cells<Tet4, std::remove_cvref_t<decltype(backend)>>();
    add<Better<Tet4>, double>("regroup", name, cells, [backend, cells](benchmark::State& state) {
      time_regroup<Tet4>(state, backend, cells);
    });
  });
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  return pliant::bench::run(argc, argv, [] {
    pliant::bench::add_migrations();
    pliant::bench::add_regroups();
  });
}
