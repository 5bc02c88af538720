#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include <pliant/openmp.hpp>
#include <pliant/pliant.hpp>
#include <pliant/solver/assemble.hpp>

#include "deal_ii.hpp"
#include "support/formulations.hpp"
#include "support/problem.hpp"

// One mesh, on which Pliant and others compute nodal forces and tangent products in turns.
namespace pliant::bench {

using Rows = std::vector<Point<3>>;
using Core = OpenMP<double>;

enum class Kind { pliant, deal_ii, assembled, plain };

/// What is timed, and how it did.
struct Contestant {
  Kind kind;
  std::string name;
  std::function<void()> work;
  std::function<Rows()> result;
  double least = 1e30;  // s
};

struct Row {
  std::string element, law, product;
  long elements;
  std::vector<Contestant> all;  // Pliant first

  /// M elements/s, of the fastest of a kind; 0 where there is none.
  double rate(Kind kind) const {
    double best = 0;
    for (auto const& one : all)
      if (one.kind == kind) best = std::max(best, rate(one));
    return best;
  }
  double rate(Contestant const& one) const {
    return 1e-6 * static_cast<double>(elements) / one.least;
  }
};

double seconds(std::function<void()> const& work) {
  using Clock = std::chrono::steady_clock;
  auto const start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// By the numbers that the mesh of an OrderedMesh has inside a body.
template <Element E>
Rows in_order(OrderedMesh<E> const& ordered, Rows const& by_user) {
  Rows rows(by_user.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = by_user[static_cast<std::size_t>(ordered.numbering.user_node[i])];
  return rows;
}

template <Element E>
PeerMesh peer_mesh(OrderedMesh<E> const& ordered) {
  constexpr bool simplex = SimplexCell<typename E::cell>;
  PeerMesh mesh{
      simplex,       E::degree, in_order(ordered, ordered.mesh.nodes), {}, {}, soft.lame_lambda(),
      soft.lame_mu()};
  for (auto const& element : std::get<0>(ordered.numbering.tables))
    mesh.elements.insert(mesh.elements.end(), element.begin(), element.end());
  for (int a = 0; a < E::nodes; ++a) {
    auto& place = mesh.places.emplace_back();
    for (int k = 0; k < 3; ++k)
      place[static_cast<std::size_t>(k)] = simplex ? E::place(a)[k] : (E::place(a)[k] + 1) / 2;
  }
  return mesh;
}

/// Puts the nodes between the corners into the middle of their edges.
template <Element E>
void straighten(Mesh<E>& mesh) {
  constexpr auto edges = E::edges();
  for (auto const& element : mesh.template elements<E>())
    for (std::size_t e = 0; e < edges.size(); ++e) {
      auto const node = [&](std::size_t a) -> auto& {
        return mesh.nodes[static_cast<std::size_t>(element[a])];
      };
      for (std::size_t k = 0; k < 3; ++k)
        node(E::cell::corners + e)[k] = (node(static_cast<std::size_t>(edges[e][0]))[k] +
                                         node(static_cast<std::size_t>(edges[e][1]))[k]) /
                                        2;
    }
}

/// Gives up where results differ by more than rounding.
void demand_agreement(std::vector<Contestant> const& all, std::string const& what) {
  auto const expected = all.front().result();
  double largest = 0;
  for (auto const& row : expected)
    for (double x : row) largest = std::max(largest, std::abs(x));
  for (auto const& other : all) {
    auto const rows = other.result();
    double apart = rows.size() == expected.size() ? 0 : largest;
    for (std::size_t i = 0; apart < largest && i < rows.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (double const d = std::abs(rows[i][k] - expected[i][k]); !(d <= apart)) apart = d;
    if (apart <= 1e-10 * largest && largest > 0) continue;
    std::fprintf(stderr, "%s: %s is apart from Pliant by %.2g of the largest value, %.3g\n",
                 what.c_str(), other.name.c_str(), apart / largest, largest);
    std::exit(1);
  }
}

/// A first call brings its own data into the caches, then two are timed.
void run_in_turns(std::vector<Contestant>& all, int turns) {
  for (int turn = 0; turn < turns; ++turn)
    for (auto& one : all) {
      one.work();
      for (int k = 0; k < 2; ++k) one.least = std::min(one.least, seconds(one.work));
    }
}

template <Element E>
class Contest {
  using Nodes = std::vector<std::array<Index, E::nodes>>;

 public:
  Contest(std::string name, OrderedMesh<E> const& ordered, std::vector<MakePeer*> const& libraries)
      : name_(std::move(name)),
        ordered_(ordered),
        problem_(backend_, ordered),
        u_(in_order(ordered, shaken(ordered.mesh.nodes, 1))),
        du_(in_order(ordered, shaken(ordered.mesh.nodes, 2))),
        plain_(zeros<double>(backend_, node_stride * static_cast<std::size_t>(problem_.nodes))) {
    auto const mesh = peer_mesh(ordered);
    for (auto const& make : libraries) {
      peers_.emplace_back(make(mesh));
      peers_.back()->set_displacements(u_, du_);
    }
  }

  template <template <class> class L, Geometry How>
  void run(PeerLaw law, int turns, std::vector<Row>& table) {
    using F = Usual<E, L>;
    using Laws = GroupLaws<double, F>;
    auto const laws = soft_laws<double, F>();
    auto all = contestants(ForceKernel<Laws, How>{laws}, problem_.rest(), problem_.u());
    for (auto& peer : peers_) add_peer(all, *peer, [&peer, law] { peer->force(law); });
    finish<F>(all, "force", turns, table);

    all = contestants(TangentKernel<double, Laws, How>{laws, 1.0}, problem_.rest(), problem_.u(),
                      problem_.du());
    for (auto& peer : peers_) add_peer(all, *peer, [&peer, law] { peer->tangent_product(law); });
    if constexpr (E::degree == 1) add_assembled<F>(all);
    finish<F>(all, "tangent product", turns, table);
  }

 private:
  /// Pliant's loop, and for linear elements a plain one with the same kernel.
  template <class Kernel, class... Fields>
  std::vector<Contestant> contestants(Kernel const& kernel, Fields... fields) {
    std::vector<Contestant> all;
    all.push_back({Kind::pliant, "Pliant",
                   [=, this] {
                     problem_.clear_forces(backend_);
                     backend_.template accumulate<1>(problem_.elements, kernel, problem_.f(),
                                                     fields...);
                   },
                   [this] { return rows_of(problem_.f_values); }});
    if constexpr (E::degree == 1)
      all.push_back({Kind::plain, "plain loop with atomics",
                     [=, this] { accumulate_plainly(kernel, fields...); },
                     [this] { return rows_of(plain_); }});
    return all;
  }
  static void add_peer(std::vector<Contestant>& all, Peer& peer, std::function<void()> work) {
    all.push_back({Kind::deal_ii, peer.name(), std::move(work), [&peer] { return peer.result(); }});
  }
  /// The product with the stiffness of the same elements, whose order is that of the body.
  template <class F>
  void add_assembled(std::vector<Contestant>& all) {
    Mesh<E> mesh{in_order(ordered_, ordered_.mesh.nodes), {ordered_.numbering.tables}};
    Body const body{backend_, mesh, soft, Group<F>{}};
    auto const flat = [](Rows const& rows) {
      return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd const>(
          rows.front().data(), 3 * static_cast<Eigen::Index>(rows.size())));
    };
    using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
    auto const k = std::make_shared<Matrix>(-assemble(body, flat(u_)).stiffness);
    auto const du = std::make_shared<Eigen::VectorXd>(flat(du_));
    auto const product = std::make_shared<Eigen::VectorXd>(du->size());
    all.push_back({Kind::assembled, "assembled, by Eigen", [=] { product->noalias() = *k * *du; },
                   [=] {
                     Rows rows(static_cast<std::size_t>(product->size()) / 3);
                     std::copy_n(product->data(), product->size(), rows.front().data());
                     return rows;
                   }});
  }
  template <class Kernel, class... Fields>
  void accumulate_plainly(Kernel const& kernel, Fields const&... fields) {
    std::fill_n(plain_.data(), plain_.size(), 0.0);
    auto const& elements = std::get<0>(ordered_.numbering.tables);
    for (auto const& nodes : elements) {
      auto const gather = [&](auto const& field) {
        Nodal<E, double> values;
        for (int a = 0; a < E::nodes; ++a)
          for (int k = 0; k < 3; ++k) values(a, k) = field(nodes[static_cast<std::size_t>(a)], k);
        return values;
      };
      auto const shares = kernel(GroupNumber<0>{}, gather(fields)...);
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < 3; ++k) {
          double& sum = plain_.data()[node_stride * nodes[static_cast<std::size_t>(a)] + k];
#pragma omp atomic
          sum += shares(a, k);
        }
    }
  }
  Rows rows_of(Core::Array<double> const& values) const {
    Rows rows(static_cast<std::size_t>(problem_.nodes));
    for (std::size_t i = 0; i < rows.size(); ++i)
      std::copy_n(values.data() + node_stride * i, 3, rows[i].data());
    return rows;
  }
  template <class F>
  void finish(std::vector<Contestant>& all, std::string const& product, int turns,
              std::vector<Row>& table) {
    for (auto& one : all) one.work();
    demand_agreement(all, name_ + ", " + law_name<F>() + ", " + product);
    run_in_turns(all, turns);
    for (auto& one : all) one.work = nullptr, one.result = nullptr;
    table.push_back({name_, law_name<F>(), product, problem_.elements.count(), all});
  }

  std::string name_;
  OrderedMesh<E> const& ordered_;
  Core backend_{{.threads = 1}};
  Problem<Core, E> problem_;
  Rows u_, du_;
  Core::Array<double> plain_;
  std::vector<std::unique_ptr<Peer>> peers_;
};

}  // namespace pliant::bench
