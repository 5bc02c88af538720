#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/check_nodes.hpp>
#include <pliant/backend/dispatch.hpp>
#include <pliant/backend/host_array.hpp>
#include <pliant/backend/host_recording.hpp>
#include <pliant/backend/host_timer.hpp>
#include <pliant/backend/kernel.hpp>
#include <pliant/backend/patch_cuts.hpp>
#include <pliant/backend/patch_list.hpp>

namespace pliant {

/// The serial oracle: plain loops in the order of the elements, one number at a time.
template <std::floating_point T>
class Reference {
 public:
  using scalar = T;
  template <class U>
  using Array = HostArray<U>;
  using Recording = HostRecording;
  using Timer = HostTimer;
  static constexpr bool orders_by_group = false;
  static constexpr char const* name() { return "Reference"; }

  template <int Nodes>
  class Elements {
   public:
    static constexpr int nodes_per_element = Nodes;
    Elements() = default;
    Elements(Reference const&, std::vector<std::array<Index, Nodes>> connectivity, int,
             std::vector<Tag> const& tags, Index nodes, NodeOrder = NodeOrder::as_given,
             Index patch_size = 512)
        : connectivity_(std::move(connectivity)),
          tags_(connectivity_.size()),
          patches_(static_cast<Index>(connectivity_.size()), patch_size) {
      detail::check_nodes(connectivity_, nodes);
      if (!tags.empty()) tags_.upload(tags);
      tag_data_ = tags_.data();
    }
    Index count() const { return static_cast<Index>(connectivity_.size()); }
    Index scratch_nodes() const { return 0; }
    Index patch_size() const { return patches_.size(); }
    Index patch_count() const { return patches_.count(); }
    PatchRanges patches() const { return patches_.ranges(); }
    std::span<Index const> patch_bounds() const { return patches_.first(); }
    HostArray<Tag>& tags() { return tags_; }
    HostArray<Tag> const& tags() const { return tags_; }
    HostArray<Tag> take_tags() { return std::move(tags_); }
    Tag tag(Index e) const { return tag_data_[e]; }
    void regroup() {}
    ElementRows rows_of_nodes() const {
      return {connectivity_.empty() ? nullptr : nodes(0), Nodes};
    }
    Index const* nodes(Index e) const { return connectivity_[static_cast<std::size_t>(e)].data(); }

   private:
    std::vector<std::array<Index, Nodes>> connectivity_;
    HostArray<Tag> tags_;
    Tag const* tag_data_ = nullptr;  // whoever owns them
    detail::HostPatches patches_;
  };

  template <class F>
  void for_each(Index n, F const& f) const {
    for (Index i = 0; i < n; ++i) f(i);
  }
  template <class F>
  double sum(Index n, F const& f) const {
    double total = 0;
    for (Index i = 0; i < n; ++i) total += static_cast<double>(f(i));
    return total;
  }
  template <class F>
  void add_sum(Index n, F const& f, double* to) const {
    *to += sum(n, f);
  }
  template <class F>
  double maximum(Index n, F const& f) const {
    double largest = -std::numeric_limits<double>::infinity();
    for (Index i = 0; i < n; ++i) largest = std::max(largest, static_cast<double>(f(i)));
    return largest;
  }
  template <class F>
  std::vector<Index> select(Index n, F const& f) const {
    std::vector<Index> found;
    for (Index i = 0; i < n; ++i)
      if (f(i)) found.push_back(i);
    return found;
  }
  template <class F>
  void select(Index n, F const& f, Index* to, Index* count) const {
    auto const found = select(n, f);
    std::copy(found.begin(), found.end(), to);
    *count = static_cast<Index>(found.size());
  }
  template <class F>
  void scan(Index n, F const& f, Index* to) const {
    Index sum = 0;
    for (Index i = 0; i < n; ++i) {
      Index const value = f(i);
      to[i] = sum;
      sum += value;
    }
    to[n] = sum;
  }
  void sort(Index n, std::uint64_t* keys, Index* values, int) const {
    std::vector<std::pair<std::uint64_t, Index>> sorted;
    for (Index i = 0; i < n; ++i) sorted.emplace_back(keys[i], values[i]);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](auto const& a, auto const& b) { return a.first < b.first; });
    for (auto const& [key, value] : sorted) {
      *keys++ = key;
      *values++ = value;
    }
  }
  template <class U>
  Array<U> array(std::size_t count) const {
    return Array<U>(count);
  }
  Recording record(std::function<void()> f) const { return HostRecording(std::move(f)); }
  void synchronize() const {}
  Timer timer() const { return {}; }

  template <int Groups, class Table, class Kernel, int C, class... Fields>
  void accumulate(Table const& table, Kernel const& kernel, NodeField<T, C> out,
                  Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    require_kernel<Kernel, Matrix<T, nodes, C>, Groups, OneElement, Values<nodes, Fields>...>();
    loop<Groups>(table, [&](auto group, Index e, Index const* row) {
      if constexpr (Selects<Kernel>)
        if (!kernel.selects(e, static_cast<Tag>(group.value))) return;
      auto const values = call(kernel, group, OneElement{e}, gather<nodes>(fields, row)...);
      for (int a = 0; a < nodes; ++a)
        for (int k = 0; k < C; ++k) out(row[a], k) += values(a, k);
    });
  }
  template <int Groups, class Table, class Kernel, class... Fields>
  double sum_elements(Table const& table, Kernel const& kernel, Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    require_kernel<Kernel, double, Groups, OneElement, Values<nodes, Fields>...>();
    double total = 0;
    loop<Groups>(table, [&](auto group, Index e, Index const* row) {
      total +=
          static_cast<double>(call(kernel, group, OneElement{e}, gather<nodes>(fields, row)...));
    });
    return total;
  }
  template <int Groups, class Table, class Visitor, class... Fields>
  void visit(Table const& table, Visitor const& visitor, HostArray<double>& counters,
             Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    using Again = Gather<nodes, Fields...>;
    require_visitor<Visitor, T, Again, Groups, OneElement, Values<nodes, Fields>...>();
    auto const tally = [&counters](int k, double x) { counters.data()[k] += x; };
    loop<Groups>(table, [&](auto group, Index e, Index const* row) {
      if constexpr (Selects<Visitor>)
        if (!visitor.selects(e, static_cast<Tag>(group.value))) return;
      auto const values = evaluate_at(visitor, group, OneElement{e}, gather<nodes>(fields, row)...);
      visitor.finish(group, e, values, Again{row, {fields...}}, tally);
    });
  }
  template <class F>
  void histogram(Index n, F const& f, std::int64_t* bins) const {
    for (Index i = 0; i < n; ++i)
      if (Bin const bin = f(i); bin.number >= 0) bins[bin.number] += bin.weight;
  }

 private:
  template <int Nodes, class Field>
  using Values = Matrix<T, Nodes, Field::components>;

  template <int Groups, class Table, class F>
  static void loop(Table const& table, F const& f) {
    auto const active = detail::active(table);
    auto const& elements = active.elements;
    for (Index k = 0; k < active.patch_count(); ++k) {
      auto const patch = static_cast<std::size_t>(active.patch(k));
      auto const bounds = elements.patch_bounds();
      for (Index e = bounds[patch]; e < bounds[patch + 1]; ++e)
        dispatch<Groups>(elements.tag(e), [&](auto group) { f(group, e, elements.nodes(e)); });
    }
  }
};

}  // namespace pliant
