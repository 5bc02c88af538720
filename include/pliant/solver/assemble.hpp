#pragma once

#include <limits>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include <pliant/backend/dispatch.hpp>
#include <pliant/body/body.hpp>

namespace pliant {

/// What a body's force terms make of a displacement, assembled on the host in double precision,
/// whatever the body's own; rows run over (node, direction) in the user's order.
struct Assembled {
  double energy = 0;      // of the elements and of terms that have one, J
  Eigen::VectorXd force;  // −∂W/∂u, pressures and the user's terms included, N
  Eigen::SparseMatrix<double> stiffness;  // −∂force/∂u, N/m
};

/// What is assembled; the rest of an Assembled is left empty.
enum class Assemble { energy_and_force, stiffness, stiffness_too };

namespace detail {

/// A table of rows as one of columns.
inline std::vector<double> columns(std::vector<double> const& rows, std::size_t count) {
  std::vector<double> turned(rows.size());
  std::size_t const width = count > 0 ? rows.size() / count : 0;
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t k = 0; k < width; ++k) turned[k * count + e] = rows[e * width + k];
  return turned;
}

/// The middle of a mesh, from where force terms count positions at rest (see Layout).
template <class M>
Point<M::dim> middle_of(M const& mesh) {
  Point<M::dim> low = mesh.nodes.front(), high = low;
  for (auto const& p : mesh.nodes)
    for (std::size_t k = 0; k < p.size(); ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  for (std::size_t k = 0; k < low.size(); ++k) low[k] = (low[k] + high[k]) / 2;
  return low;
}

/// Adds element by element to an Assembled; what belongs to slaves goes to their masters.
template <int Dim>
class Assembler {
 public:
  Assembler(Interpolation const& interpolation, Assemble what, Eigen::Index size)
      : interpolation_(interpolation),
        with_force_(what != Assemble::stiffness),
        with_stiffness_(what != Assemble::energy_and_force) {
    if (with_force_) sum_.force = Eigen::VectorXd::Zero(size);
    if (with_stiffness_) sum_.stiffness.resize(size, size);
  }
  bool with_force() const { return with_force_; }
  bool with_stiffness() const { return with_stiffness_; }

  void add_energy(double energy) { sum_.energy += energy; }
  /// force(a, k) of the nodes of an element, by the user's numbers.
  template <class Nodes, class Force>
  void add_force(Nodes const& nodes, Force const& force) {
    for (std::size_t a = 0; a < nodes.size(); ++a)
      interpolation_.for_each_master(nodes[a], [&](Index i, double weight) {
        for (int k = 0; k < Dim; ++k)
          sum_.force[Eigen::Index{Dim} * i + k] += weight * force(static_cast<int>(a), k);
      });
  }
  /// stiffness(row, column), which run over (a, direction).
  template <class Nodes, class Stiffness>
  void add_stiffness(Nodes const& nodes, Stiffness const& stiffness) {
    for (std::size_t a = 0; a < nodes.size(); ++a)
      interpolation_.for_each_master(nodes[a], [&](Index i, double wi) {
        for (std::size_t b = 0; b < nodes.size(); ++b)
          interpolation_.for_each_master(nodes[b], [&](Index j, double wj) {
            for (int p = 0; p < Dim; ++p)
              for (int q = 0; q < Dim; ++q)
                entries_.emplace_back(
                    Dim * i + p, Dim * j + q,
                    wi * wj *
                        stiffness(static_cast<int>(a) * Dim + p, static_cast<int>(b) * Dim + q));
          });
      });
  }
  Assembled finish() {
    if (with_stiffness_) sum_.stiffness.setFromTriplets(entries_.begin(), entries_.end());
    return std::move(sum_);
  }

 private:
  Interpolation const& interpolation_;
  bool with_force_, with_stiffness_;
  Assembled sum_;
  std::vector<Eigen::Triplet<double>> entries_;
};

/// The laws of a table on the host, a time dt after internal variables were committed, over numbers per
/// element in the user's order.
template <class Table>
struct LawsOnHost {
  typename Table::HostLaws laws;
  std::vector<double> values, internal_variables;

  template <class Parts, class ElementState>
  LawsOnHost(Parts const& parts, Table const& table, ElementState const& state,
             std::vector<double> const& value_rows, double dt)
      : laws(at<Parts>(parts, dt, std::make_integer_sequence<int, Table::groups>())) {
    auto const count = static_cast<std::size_t>(table.count());
    if (!Table::Laws::reads_elements) return;
    values = columns(value_rows, count);
    if constexpr (Table::Laws::internal_variable_count > 0)
      internal_variables = columns(table.in_user_order(state.internal_variables), count);
    laws.data = {values.data(), internal_variables.data(), table.count()};
  }
  LawsOnHost(LawsOnHost const&) = delete;

 private:
  template <class Parts, int... G>
  static typename Table::HostLaws at(Parts const& parts, double dt,
                                     std::integer_sequence<int, G...>) {
    return {{prepared<typename Table::template formulation<G>>(
        parts.template law_of<typename Table::template formulation<G>>(), dt)...}};
  }
};

/// Calls visit(GroupNumber, e, law) for each element of a table, by the user's number.
template <class Table, class Visit>
void for_each_law(Table const&, LawsOnHost<Table> const& host, std::vector<Tag> const& tags,
                  Visit const& visit) {
  for (std::size_t e = 0; e < tags.size(); ++e)
    dispatch<Table::groups>(tags[e], [&]<int G>(GroupNumber<G> group) {
      visit(group, e, host.laws.template law<G>(OneElement{static_cast<Index>(e)}));
    });
}

template <class Parts>
Assembled assembled_at(Parts const& parts, Eigen::VectorXd const& u, Assemble what, double dt,
                       double pressure_share) {
  constexpr int dim = Parts::dim;
  auto const& mesh = parts.state.topology->mesh;
  auto const at = [&](Index node, int k) { return u[Eigen::Index{dim} * node + k]; };
  Assembler<dim> sum(parts.state.topology->interpolation, what, u.size());

  std::size_t type = 0;
  parts.for_each_type([&](auto const& table, auto const& state) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using E = typename Table::element;
    LawsOnHost<Table> const host(parts, table, state, parts.state.topology->element_values[type++],
                                 dt);
    auto const& elements = mesh.template elements<E>();
    for_each_law(table, host, user_groups<E>(parts),
                 [&]<int G>(GroupNumber<G>, std::size_t e, auto const& law) {
                   using F = typename Table::template formulation<G>;
                   auto const& nodes = elements[e];
                   auto const rest = nodal(mesh, nodes);
                   Nodal<E, double> own;
                   for (int a = 0; a < E::nodes; ++a)
                     for (int k = 0; k < dim; ++k)
                       own(a, k) = at(nodes[static_cast<std::size_t>(a)], k);
                   if (sum.with_force()) {
                     sum.add_energy(energy<F>(law, rest, own));
                     sum.add_force(nodes, force<F>(law, rest, own));
                   }
                   if (sum.with_stiffness()) sum.add_stiffness(nodes, stiffness<F>(law, rest, own));
                 });
  });

  auto const middle = middle_of(mesh);
  auto const user = [&](Index node) {
    return parts.layout.user_node[static_cast<std::size_t>(node)];
  };
  auto const rest = [&](Index node) {
    Point<dim> place = mesh.nodes[static_cast<std::size_t>(user(node))];
    for (std::size_t k = 0; k < dim; ++k) place[k] -= middle[k];
    return place;
  };
  auto const displacement = [&](Index node) {
    Point<dim> value;
    for (int k = 0; k < dim; ++k) value[static_cast<std::size_t>(k)] = at(user(node), k);
    return value;
  };
  auto const add = [&](auto const& terms, double share) {
    std::vector<Index> nodes;
    for (auto const& term : terms)
      term->for_each_element(
          rest, displacement, sum.with_stiffness(), [&](ElementMatrix const& element) {
            nodes.clear();
            for (Index node : element.nodes) nodes.push_back(user(node));
            std::size_t const width = dim * nodes.size();
            if (sum.with_force()) {
              sum.add_energy(share * element.energy);
              sum.add_force(nodes, [&](int a, int k) {
                return share * element.force[static_cast<std::size_t>(dim * a + k)];
              });
            }
            if (sum.with_stiffness())
              sum.add_stiffness(nodes, [&](int row, int column) {
                return share * element.stiffness[width * static_cast<std::size_t>(row) +
                                                 static_cast<std::size_t>(column)];
              });
          });
  };
  add(parts.pressures, pressure_share);
  add(parts.terms, 1);
  return sum.finish();
}

}  // namespace detail

/// Assembles at displacements u, (nodes, dim), for laws that see a time dt, s, since their internal
/// variables were committed; infinite: at rest. Rows and columns of slaves are handed to their masters:
/// their own are zero. `u` must give the slaves their interpolated displacement (see
/// `interpolate_slaves`). Throws Error for a u of another size, and a dt that is negative or not a number.
template <DeformableBody TheBody>
Assembled assemble(TheBody const& body, Eigen::VectorXd const& u, double dt,
                   Assemble what = Assemble::stiffness_too) {
  Eigen::Index const size = Eigen::Index{TheBody::dim} * body.nodes();
  if (u.size() != size)
    throw Error("assemble: got ", u.size(), " displacements, but the body has ", size,
                " (node by node)");
  if (!(dt >= 0))
    throw Error("assemble: a time of ", dt,
                " s since internal variables were committed; give 0 or more, infinity for at rest");
  return detail::assembled_at(body.parts(), u, what, dt, 1);
}
/// The same of a body whose laws have no internal variables.
template <DeformableBody TheBody>
Assembled assemble(TheBody const& body, Eigen::VectorXd const& u,
                   Assemble what = Assemble::stiffness_too) {
  static_assert(!TheBody::has_internal_variables,
                "assemble: this body's laws have internal variables; give the time since they were "
                "committed, as in assemble(body, u, dt), infinite for at rest");
  return assemble(body, u, std::numeric_limits<double>::infinity(), what);
}

/// Gives slaves the displacement that follows from their masters'.
template <DeformableBody TheBody>
void interpolate_slaves(TheBody const& body, Eigen::VectorXd& u) {
  constexpr int dim = TheBody::dim;
  body.state().topology->interpolation.apply(
      [&](Index i, int k) -> double& { return u[Eigen::Index{dim} * i + k]; }, dim);
}

}  // namespace pliant
