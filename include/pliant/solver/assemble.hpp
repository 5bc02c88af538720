#pragma once

#include <limits>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include <pliant/backend/dispatch.hpp>
#include <pliant/body/body.hpp>
#include <pliant/solver/assembler.hpp>
#include <pliant/solver/linear/same_registers.hpp>
#include <pliant/solver/linear/unknowns.hpp>
#include <pliant/solver/stiffness_pattern.hpp>

namespace pliant {

/// What a body's force terms make of a displacement, assembled on the host in double precision,
/// whatever the body's own; rows run over (node, direction) in the user's order.
struct Assembled {
  double energy = 0;      // of the elements and of terms that have one, J
  Eigen::VectorXd force;  // −∂W/∂u, pressures and the user's terms included, N
  Eigen::SparseMatrix<double> stiffness;  // −∂force/∂u, N/m
};

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

/// Calls visit(GroupNumber, law) for an element of a table, by the user's number.
template <class Table, class Visit>
void with_law(Table const&, LawsOnHost<Table> const& host, Tag tag, Index element,
              Visit const& visit) {
  dispatch<Table::groups>(tag, [&]<int G>(GroupNumber<G> group) {
    visit(group, host.laws.template law<G>(OneElement{element}));
  });
}

/// Nodes that pull at each other as elements of the body's mesh, and lists besides.
template <class Parts>
auto stiffness_blocks(Parts const& parts, std::vector<std::vector<Index>> const& besides) {
  auto const& mesh = parts.state.topology->mesh();
  CoupledNodes coupled(parts.state.topology->interpolation, static_cast<Index>(mesh.nodes.size()));
  parts.for_each_type([&](auto const& table, auto const&) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    for (auto const& nodes : mesh.template elements<E>()) coupled.add(nodes);
  });
  for (auto const& nodes : besides) coupled.add(nodes);
  return coupled.template blocks<Parts::dim>();
}

/// Adds the elements of a body's groups.
template <class Parts>
void add_groups(Parts const& parts, Eigen::VectorXd const& u, double dt,
                Assembler<Parts::dim>& sum) {
  constexpr int dim = Parts::dim;
  auto const& mesh = parts.state.topology->mesh();
  std::size_t type = 0;
  parts.for_each_type([&](auto const& table, auto const& state) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using E = typename Table::element;
    LawsOnHost<Table> const host(parts, table, state, parts.state.topology->element_values[type++],
                                 dt);
    auto const& elements = mesh.template elements<E>();
    auto const tags = user_groups<E>(parts);
    auto const nodes_of = [&](Index e) -> auto const& {
      return elements[static_cast<std::size_t>(e)];
    };
    sum.add_elements(static_cast<Index>(elements.size()), nodes_of,
                     [&](Index e, double* force_out, double* stiffness_out) {
                       auto const& nodes = nodes_of(e);
                       auto const rest = nodal(mesh, nodes);
                       Nodal<E, double> own;
                       for (int a = 0; a < E::nodes; ++a)
                         for (int k = 0; k < dim; ++k)
                           own(a, k) =
                               u[Eigen::Index{dim} * nodes[static_cast<std::size_t>(a)] + k];
                       double energy_of_element = 0;
                       with_law(table, host, tags[static_cast<std::size_t>(e)], e,
                                [&]<int G>(GroupNumber<G>, auto const& law) {
                                  using F = typename Table::template formulation<G>;
                                  if (force_out != nullptr) {
                                    energy_of_element = energy<F>(law, rest, own);
                                    auto const f = force<F>(law, rest, own);
                                    for (int a = 0; a < E::nodes; ++a)
                                      for (int k = 0; k < dim; ++k) *force_out++ = f(a, k);
                                  }
                                  if (stiffness_out != nullptr) {
                                    auto const k = stiffness<F>(law, rest, own);
                                    for (int row = 0; row < dim * E::nodes; ++row)
                                      for (int column = 0; column < dim * E::nodes; ++column)
                                        *stiffness_out++ = k(row, column);
                                  }
                                });
                       return energy_of_element;
                     });
  });
}

/// Adds pressures, times a factor, and the user's force terms.
template <class Parts>
void add_terms(Parts const& parts, Eigen::VectorXd const& u, double pressure_share,
               Assembler<Parts::dim>& sum) {
  constexpr int dim = Parts::dim;
  auto const& mesh = parts.state.topology->mesh();
  auto const middle = middle_of(mesh);
  auto const user = [&](Index node) { return parts.layout.user_of(node); };
  auto const rest = [&](Index node) {
    Point<dim> place = mesh.nodes[static_cast<std::size_t>(user(node))];
    for (std::size_t k = 0; k < dim; ++k) place[k] -= middle[k];
    return place;
  };
  auto const displacement = [&](Index node) {
    Point<dim> value;
    for (int k = 0; k < dim; ++k)
      value[static_cast<std::size_t>(k)] = u[Eigen::Index{dim} * user(node) + k];
    return value;
  };
  std::vector<Index> nodes;
  std::vector<double> force, stiffness;
  auto const add = [&](auto const& terms, double share) {
    auto const scaled = [&](std::span<double const> values, std::vector<double>& to) {
      to.assign(values.begin(), values.end());
      for (double& x : to) x *= share;
      return to.data();
    };
    for (auto const& term : terms)
      term->for_each_element(
          rest, displacement, sum.with_stiffness(), [&](ElementMatrix const& element) {
            nodes.clear();
            for (Index node : element.nodes) nodes.push_back(user(node));
            double* const tangent = scaled(element.stiffness, stiffness);
            if (sum.with_stiffness() && term->has_energy())
              sum.project(tangent, dim * nodes.size());
            sum.add_element(nodes, share * element.energy, scaled(element.force, force), tangent);
          });
  };
  add(parts.pressures, pressure_share);
  add(parts.terms, 1);
}

/// Assembles into `sum`, whose stiffness keeps the pattern that it has, and gets one where it has none.
template <class Parts>
void assemble_into(AssembledBlocks<Parts::dim>& sum, Parts const& parts, Eigen::VectorXd const& u,
                   Assemble what, double dt, double pressure_share,
                   ElementTangents tangents = ElementTangents::exact) {
  HostTasks const tasks(parts.backend);
  auto const nodes = parts.layout.nodes();
  if (what != Assemble::energy_and_force && sum.stiffness.rows() == 0)
    sum.stiffness = stiffness_blocks(parts, {});
  std::vector<std::vector<Index>> besides;
  for (;;) {
    Assembler<Parts::dim> assembler(tasks, parts.state.topology->interpolation, what, nodes, sum,
                                    tangents);
    add_groups(parts, u, dt, assembler);
    add_terms(parts, u, pressure_share, assembler);
    auto const& lacking = assembler.lacking();
    if (lacking.empty()) break;
    besides.insert(besides.end(), lacking.begin(), lacking.end());
    sum.stiffness = stiffness_blocks(parts, besides);
  }
}

/// By (node, direction).
template <int N>
Eigen::SparseMatrix<double> by_scalars(BlockMatrix<N, N> const& blocks) {
  return Unknowns(std::vector<bool>(N * static_cast<std::size_t>(blocks.rows()), false))
      .restrict(blocks);
}

template <class Parts>
Assembled assembled_at(Parts const& parts, Eigen::VectorXd const& u, Assemble what, double dt,
                       double pressure_share) {
  AssembledBlocks<Parts::dim> sum;
  assemble_into(sum, parts, u, what, dt, pressure_share);
  Assembled all{sum.energy, std::move(sum.force), {}};
  if (what != Assemble::energy_and_force) all.stiffness = by_scalars(sum.stiffness);
  return all;
}

}  // namespace detail

/// Assembles at displacements u, (nodes, dim), for laws that see a time dt, s, since their internal
/// variables were committed; infinite: at rest. Rows and columns of slaves are handed to their masters:
/// their own are zero. `u` must give the slaves their interpolated displacement (see
/// `interpolate_slaves`). Throws Error for a u of another size, and a dt that is negative or not a number.
template <DeformableBody TheBody>
Assembled assemble(TheBody const& body, Eigen::VectorXd const& u, double dt,
                   Assemble what = Assemble::stiffness_too) {
  detail::check_registers();
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
