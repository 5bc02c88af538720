#pragma once

#include <pliant/backend/element_sums.hpp>
#include <pliant/backend/patch_list.hpp>
#include <pliant/force/element_kernels.hpp>
#include <pliant/force/force_term.hpp>

namespace pliant {

struct TheirOwnKernels {
  template <class Table, class Kernel>
  Kernel const& operator()(Table const&, Kernel const& kernel) const {
    return kernel;
  }
};

/// The elements of a layout, each under the law of its group, as a force term.
template <class Layout>
class ElementGroups {
  using T = typename Layout::T;
  using At = Placement<T, Layout::dim>;
  using Field = NodeField<T, Layout::dim>;
  using ConstField = NodeField<T const, Layout::dim>;
  using PatchList = typename Layout::template Array<Index>;

 public:
  /// `lists`: of each table, the patches whose forces and rows are added; null: all.
  explicit ElementGroups(Layout const& layout, std::vector<PatchList> const* lists = nullptr)
      : layout_(layout), lists_(lists) {}

  Index scratch_nodes() const {
    Index rows = 0;
    for_each_table(
        [&](auto const& table) { rows = std::max(rows, table.elements.scratch_nodes()); });
    return rows;
  }
  bool has_energy() const { return true; }

  template <class B>
  double energy(B const& backend, At const& at) const {
    double total = 0;
    for_each_table([&](auto const& table) {
      using Table = std::remove_cvref_t<decltype(table)>;
      table.with_geometry([&](auto geometry) {
        total += backend.template sum_elements<Table::groups>(
            table.elements, EnergyKernel<typename Table::Laws, geometry.value>{table.laws}, at.rest,
            at.u);
      });
    });
    return total;
  }
  /// Adds that to *to in the backend's memory.
  template <class B>
  void add_energy(B const& backend, At const& at, double* to) const {
    for_each_table([&](auto const& table) {
      using Table = std::remove_cvref_t<decltype(table)>;
      table.with_geometry([&](auto geometry) {
        add_sum_elements<Table::groups>(
            backend, table.elements, EnergyKernel<typename Table::Laws, geometry.value>{table.laws},
            to, at.rest, at.u);
      });
    });
  }
  /// By the kernels kernel_of(table, its ForceKernel).
  template <class B, class KernelOf = TheirOwnKernels>
  void add_force(B const& backend, At const& at, Field f, KernelOf const& kernel_of = {}) const {
    for_each_active([&](auto const& table, auto const& elements) {
      using Table = std::remove_cvref_t<decltype(table)>;
      table.with_geometry([&](auto geometry) {
        backend.template accumulate<Table::groups>(
            elements,
            kernel_of(table, ForceKernel<typename Table::Laws, geometry.value>{table.laws}), f,
            at.rest, at.u);
      });
    });
  }
  template <class B>
  void add_tangent_product(B const& backend, T factor, At const& at, ConstField du, Field f) const {
    for_each_table([&](auto const& table) {
      using Table = std::remove_cvref_t<decltype(table)>;
      table.with_geometry([&](auto geometry) {
        backend.template accumulate<Table::groups>(
            table.elements,
            TangentKernel<T, typename Table::Laws, geometry.value>{table.laws, factor}, f, at.rest,
            at.u, du);
      });
    });
  }
  template <class B>
  void add_diagonal(B const& backend, At const& at, int column, Field diagonal) const {
    for_each_table([&](auto const& table) {
      using Table = std::remove_cvref_t<decltype(table)>;
      backend.template accumulate<Table::groups>(
          table.elements, DiagonalKernel<typename Table::Laws>{table.laws, column}, diagonal,
          at.rest, at.u);
    });
  }
  template <class B>
  void add_row_sums(B const& backend, At const& at, Field rows) const {
    for_each_active([&](auto const& table, auto const& elements) {
      using Table = std::remove_cvref_t<decltype(table)>;
      backend.template accumulate<Table::groups>(
          elements, RowSumKernel<typename Table::Laws>{table.laws}, rows, at.rest, at.u);
    });
  }

 private:
  template <class Visit>
  void for_each_table(Visit const& visit) const {
    std::apply([&](auto const&... table) { (visit(table), ...); }, layout_.tables);
  }
  /// visit(table, its elements that pull).
  template <class Visit>
  void for_each_active(Visit const& visit) const {
    std::size_t type = 0;
    for_each_table([&](auto const& table) {
      visit(table, lists_ ? over(table.elements, (*lists_)[type]) : detail::active(table.elements));
      ++type;
    });
  }
  Layout const& layout_;
  std::vector<PatchList> const* lists_;
};

}  // namespace pliant
