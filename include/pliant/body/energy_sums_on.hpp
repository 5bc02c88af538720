#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include <pliant/backend/element_sums.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/carried_nodes.hpp>
#include <pliant/body/motion.hpp>
#include <pliant/force/element_kernels.hpp>

namespace pliant::detail {

/// Whether one of two fields is not finite at a node: 1, or 0.
template <class T, int Dim>
struct IsNotFinite {
  LargerRowSize<T, Dim> sizes;
  PLIANT_HOST_DEVICE double operator()(Index i) const { return is_finite(sizes(i)) ? 0 : 1; }
};

/// Energies of a body before and after a change of its mesh, summed in the backend's memory and read all at once.
template <class Parts>
class EnergySumsOn {
  using B = typename Parts::backend_type;
  using T = typename Parts::T;
  using Field = typename Parts::template Array<T>;
  static constexpr int dim = Parts::dim;

 public:
  enum Time : std::size_t { before, after };
  struct Sums {
    std::array<double, 2> strain, kinetic;  // J, by the time
    double not_finite;  // nodes of which displacements or velocities are not finite, before
  };

  explicit EnergySumsOn(B const& backend) : backend_(backend), sums_(zeros<double>(backend, 5)) {}

  /// Of all elements of a table.
  template <class Table, class Layout>
  void add_strain(Time time, Table const& table, Layout const& layout, Field const& u) {
    table.with_geometry([&](auto geometry) {
      add_sum_elements<Table::groups>(
          backend_, table.elements, EnergyKernel<typename Table::Laws, geometry.value>{table.laws},
          sums_.data() + time, node_field<dim>(layout.rest), node_field<dim>(u));
    });
  }
  /// Of those at some places, (count).
  template <class Table, class Layout>
  void add_strain_at(Time time, Table const& table, Tag const* tags, Index const* places,
                     Index count, Layout const& layout, Field const& u) {
    table.with_geometry([&](auto geometry) {
      add_sum_elements_at<Table::groups>(
          backend_, table.elements, tags, places, count, layout.rows,
          EnergyKernel<typename Table::Laws, geometry.value>{table.laws}, sums_.data() + time,
          node_field<dim>(layout.rest), node_field<dim>(u));
    });
  }
  /// Velocities have to be of the present time.
  void add_kinetic(Time time, Parts const& parts) {
    backend_.add_sum(parts.layout.rows, KineticEnergy<T, dim>{parts.v(), parts.layout.mass.data()},
                     sums_.data() + 2 + time);
  }
  void count_not_finite(Parts const& parts) {
    LargerRowSize<T, dim> const sizes{{node_field<dim>(parts.state.u)},
                                      {node_field<dim>(parts.state.v)}};
    backend_.add_sum(parts.layout.rows, IsNotFinite<T, dim>{sizes}, sums_.data() + 4);
  }
  [[nodiscard]] Sums read() const {
    auto const s = download<double>(sums_);
    return {{s[0], s[1]}, {s[2], s[3]}, s[4]};
  }

 private:
  B const& backend_;
  typename Parts::template Array<double> sums_;
};

}  // namespace pliant::detail
