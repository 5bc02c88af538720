#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <pliant/body/exact_sum.hpp>
#include <pliant/body/layout_change.hpp>
#include <pliant/error.hpp>
#include <pliant/formulation/affine.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/shared_list.hpp>

// The masses of a body's nodes, as sums that do not depend on the order of elements: those of a mesh that was changed have
// the bits of those of one made anew.
namespace pliant::detail {

/// The unit of the masses of nodes in a mesh of which the box around has a volume, m³, at a density, kg/m³: elements at a
/// node lie beside each other, and curved ones not far outside of the box.
inline SumUnit unit_of_masses(double density, double volume_of_box) {
  return SumUnit(64 * density * volume_of_box);
}

/// A node's mass, kg, in a body's precision. Throws Error where that cannot hold it.
template <class T>
T checked_mass(double exact, double density) {
  T const m = static_cast<T>(exact);
  if (!(std::isfinite(m) && (m > T(0) || !(exact > 0)) && std::isfinite(static_cast<T>(density))))
    throw Error("body: ", 8 * sizeof(T), " bits cannot hold the mass of a node under the density ",
                density, " kg/m³; take double, or other units");
  return m;
}

/// Calls add(node, share) for the share that each of an element's nodes has of its mass. Throws Error where that is no number
/// or too large.
template <Element E, class M, class Add>
void share_mass(M const& mesh, Connectivity<E> const& nodes, double density, SumUnit const& unit,
                Add const& add) {
  auto const shares = host_nodal_masses<E>(nodal(mesh, nodes), density);
  ExactSum share;
  for (std::size_t a = 0; a < E::nodes; ++a) {
    int const k = static_cast<int>(a);
    if (a == 0 || shares[k] != shares[k - 1]) {  // those of linear simplices are the same
      if (!unit.holds(shares[k]))
        throw Error("body: the share of a node in the mass of an element is ", shares[k],
                    " kg under the density ", density, " kg/m³; take other units");
      share = unit.multiple_of(shares[k]);
    }
    add(static_cast<std::size_t>(nodes[a]), share);
  }
}

/// Adds to a sum in a loop over parts, which others may add to beside it.
inline void add_in_parts(HostParts<Index> const& parts, ExactSum& sum, ExactSum const& share) {
  if (parts.count() > 1)
    sum.add_from_threads(share);
  else
    sum += share;
}

/// The lumped masses of a mesh's nodes, slaves' with them.
template <Element... Es>
std::vector<ExactSum> lumped_masses(Mesh<Es...> const& mesh, double density, SumUnit const& unit) {
  std::vector<ExactSum> masses(mesh.nodes.size());
  auto const add_type = [&]<Element E>(E) {
    auto const& elements = mesh.template elements<E>();
    HostParts const parts(static_cast<Index>(elements.size()), few_elements(E::nodes));
    parts([&](Index from, Index to, int) {
      for (auto e = static_cast<std::size_t>(from); e < static_cast<std::size_t>(to); ++e)
        share_mass<E>(mesh, elements[e], density, unit, [&](std::size_t node, ExactSum const& x) {
          add_in_parts(parts, masses[node], x);
        });
    });
  };
  (add_type(Es{}), ...);
  return masses;
}

/// A list of values per node after a change of the topology: those of nodes that stay, and V{} of new ones.
template <class V, int Dim>
SharedList<V> carried_list(SharedList<V> list, Transfer<Dim> const& transfer) {
  if (transfer.renumbers())
    list.keep(static_cast<std::size_t>(transfer.first_renumbered()),
              [&](std::size_t i) { return transfer.renumbered(static_cast<Index>(i)) >= 0; });
  for (Index node = transfer.staying_nodes(); node < transfer.nodes(); ++node) list.push_back(V{});
  return list;
}

/// The sums of lumped_masses after a change of the topology: those before it less the shares of elements that go, and
/// with those of elements that come.
template <class L, class M>
SharedList<ExactSum> changed_masses(LayoutChange<L, M> const& change, double density) {
  constexpr Index few_families = 128;
  auto const& transfer = change.transfer;
  auto const& touched = change.touched;
  auto const& unit = change.before.mass_unit;
  auto masses = carried_list(change.before.own_masses(), transfer);
  for (Index const node : touched.nodes())
    if (touched.changes_elements(node)) masses.edit(static_cast<std::size_t>(node));
  auto const &gone = touched.families_before(), &come = touched.families_after();
  HostParts const parts(static_cast<Index>(transfer.families().size()), few_families);
  parts([&](Index from, Index to, int) {
    for (auto f = static_cast<std::size_t>(from); f < static_cast<std::size_t>(to); ++f) {
      gone.visit_all(f, [&]<Element E>(E, Connectivity<E> const& nodes) {
        share_mass<E>(gone.topology(), nodes, density, unit, [&](std::size_t i, ExactSum const& x) {
          if (Index const node = transfer.renumbered(static_cast<Index>(i)); node >= 0)
            add_in_parts(parts, masses.edited(static_cast<std::size_t>(node)), -x);
        });
      });
      come.visit_all(f, [&]<Element E>(E, Connectivity<E> const& nodes) {
        share_mass<E>(come.topology(), nodes, density, unit, [&](std::size_t i, ExactSum const& x) {
          add_in_parts(parts, masses.edited(i), x);
        });
      });
    }
  });
  return masses;
}

/// Sums in kg.
inline SharedList<double> in_kilograms(SharedList<ExactSum> const& masses, SumUnit const& unit) {
  std::vector<double> values(masses.size());
  for_each_on_host(static_cast<Index>(values.size()), 16384, [&](Index node) {
    auto const i = static_cast<std::size_t>(node);
    values[i] = unit.value_of(masses[i]);
  });
  return SharedList(values);
}

/// The same after a change of the topology, by the list before it: slaves and masters, before and now, are among the nodes that
/// the change looks at.
template <class L, class M>
SharedList<double> changed_in_kilograms(LayoutChange<L, M> const& change,
                                        SharedList<ExactSum> const& masses) {
  auto values = carried_list(change.before.mass_list(), change.transfer);
  values.edit_listed(change.looked_at, [&](double& value, std::size_t k) {
    value = change.before.mass_unit.value_of(masses[static_cast<std::size_t>(change.looked_at[k])]);
  });
  return values;
}

}  // namespace pliant::detail
