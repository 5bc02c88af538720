#pragma once

#include <omp.h>

#include <array>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/dispatch.hpp>
#include <pliant/backend/host_lists.hpp>
#include <pliant/backend/host_recording.hpp>
#include <pliant/backend/host_timer.hpp>
#include <pliant/backend/kernel.hpp>
#include <pliant/error.hpp>
#include <pliant/openmp/accumulate_fans.hpp>
#include <pliant/openmp/few_patches.hpp>
#include <pliant/openmp/pack_members.hpp>
#include <pliant/openmp/patches.hpp>
#include <pliant/openmp/threads.hpp>
#include <pliant/openmp/transpose.hpp>
#include <pliant/openmp/without_avx.hpp>

#if !defined(_OPENMP)
#error "pliant/openmp.hpp needs OpenMP: link pliant::openmp, or compile with -fopenmp."
#endif

namespace pliant {

struct OpenMPOptions {
  int threads = 0;  // 0: as many as the OpenMP runtime gives
};

/// Threads over patches of elements, SIMD lanes over the elements of a patch. The results have the
/// same bits for any number of threads. Threads that wait keep their cores busy for a while; where other
/// programs want these, every loop then waits for its slowest thread: ask for fewer threads than
/// idle cores, or start the program with OMP_WAIT_POLICY=passive in its environment. An exception that a
/// functor throws leaves the verb; what the verb wrote until then is unspecified.
template <std::floating_point T>
class OpenMP {
 public:
  using scalar = T;
  using Scalar = Pack<T>;
  template <class U>
  using Array = HostArray<U>;
  using Recording = HostRecording;
  using Timer = HostTimer;
  static constexpr bool orders_by_group = true;
  static constexpr char const* name() { return "OpenMP"; }

  OpenMP(OpenMPOptions options = {})
      : threads_(options.threads == 0 ? omp_get_max_threads() : options.threads) {
    if (options.threads < 0)
      throw Error("OpenMP: ", options.threads,
                  " threads asked for; give a positive number, or 0 for all");
  }
  int threads() const { return threads_.count(); }

  template <int Nodes>
  class Elements : public detail::Patches<Nodes> {
   public:
    Elements() = default;
    Elements(OpenMP const&, std::vector<std::array<Index, Nodes>> connectivity, int groups,
             std::vector<Tag> const& tags, Index nodes, NodeOrder order = NodeOrder::as_given,
             ElementBlocks const& blocks = {}, Elements const* before = nullptr)
        : detail::Patches<Nodes>(std::move(connectivity), groups, tags, nodes, order, blocks,
                                 before) {}
  };

  template <class F>
  void for_each(Index n, F const& f) const {
    threads_.for_each_part(n, small_loop, [&](Index first, Index last) {
      F const own = f;  // a compiler sees that what f writes to is not f
      for (Index i = first; i < last; ++i) own(i);
    });
  }
  /// f(k) for each k < n on the host, in no order, each call worth a thread.
  void for_each_task(Index n, FunctionRef<void(Index)> f) const { threads_.for_each_block(n, f); }
  template <class F>
  double sum(Index n, F const& f) const {
    std::vector<double> partial((static_cast<std::size_t>(n) + sum_block - 1) / sum_block);
    auto const sum_of_blocks = [&](Index first, Index last) {
      for (Index b = first; b < last; ++b) {
        double total = 0;
        Index const end = std::min(n, (b + 1) * sum_block);
        for (Index i = b * sum_block; i < end; ++i) total += static_cast<double>(f(i));
        partial[static_cast<std::size_t>(b)] = total;
      }
    };
    threads_.for_each_part(static_cast<Index>(partial.size()), small_loop / sum_block,
                           sum_of_blocks);
    return sum_in_order(partial);
  }
  template <class F>
  void add_sum(Index n, F const& f, double* to) const {
    *to += sum(n, f);
  }
  template <class F>
  void histogram(Index n, F const& f, std::int64_t* bins) const {
    threads_.for_each_part(n, small_loop, [&](Index first, Index last) {
      std::array<std::int64_t, histogram_bins> own{};
      for (Index i = first; i < last; ++i)
        if (Bin const bin = f(i); bin.number >= 0)
          own[static_cast<std::size_t>(bin.number)] += bin.weight;
#pragma omp critical(pliant_histogram)
      for (std::size_t k = 0; k < own.size(); ++k)
        if (own[k] != 0) bins[k] += own[k];
    });
  }
  template <class F>
  double maximum(Index n, F const& f) const {
    double largest = -std::numeric_limits<double>::infinity();
    threads_.for_each_part(n, small_loop, [&](Index first, Index last) {
      double mine = -std::numeric_limits<double>::infinity();
      for (Index i = first; i < last; ++i) mine = std::max(mine, static_cast<double>(f(i)));
#pragma omp critical(pliant_maximum)
      largest = std::max(largest, mine);
    });
    return largest;
  }
  template <class F>
  std::vector<Index> select(Index n, F const& f) const {
    std::map<Index, std::vector<Index>> of_parts;
    threads_.for_each_part(n, small_loop, [&](Index first, Index last) {
      std::vector<Index> own;
      for (Index i = first; i < last; ++i)
        if (f(i)) own.push_back(i);
#pragma omp critical(pliant_select)
      of_parts.emplace(first, std::move(own));
    });
    std::vector<Index> found;
    for (auto const& [first, own] : of_parts) found.insert(found.end(), own.begin(), own.end());
    return found;
  }
  template <class F>
  void select(Index n, F const& f, Index* to, Index* count) const {
    detail::select_in_parts(list_parts(n), f, to, count);
  }
  template <class F>
  void scan(Index n, F const& f, Index* to) const {
    detail::scan_in_parts(list_parts(n), f, to);
  }
  void sort(Index n, std::uint64_t* keys, Index* values, int bits) const {
    detail::sort_in_parts(list_parts(n), keys, values, bits);
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
    require_kernel<Kernel, Matrix<Scalar, nodes, C>, Groups, PackMembers,
                   Values<nodes, Fields>...>();
    auto const active = detail::active(table);
    auto const& elements = active.elements;
    auto const accumulate_in = [&](Index k) {
      accumulate_patch<Groups>(elements, active.patch(k), kernel, out, fields...);
    };
    if (active.list != nullptr && 4 * active.patch_count() < 3 * elements.patch_count())
      return detail::accumulate_few(threads_, active, accumulate_in, out);
    if (active.list != nullptr) clear_scratch(elements, out);
    threads_.for_each_block(active.patch_count(), accumulate_in, elements.rows().folded_count(),
                            [&](Index first, Index last) {
                              for (Index k = first; k < last; ++k) {
                                auto const f = elements.rows().folded(k);
                                for (Index row : f.rows)
                                  for (int c = 0; c < C; ++c) out(f.node, c) += out(row, c);
                              }
                            });
  }

  template <int Groups, class Table, class Kernel, class... Fields>
  double sum_elements(Table const& table, Kernel const& kernel, Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    require_kernel<Kernel, Scalar, Groups, PackMembers, Values<nodes, Fields>...>();
    auto const active = detail::active(table);
    std::vector<double> partial(static_cast<std::size_t>(active.patch_count()));
    threads_.for_each_block(active.patch_count(), [&](Index k) {
      double total = 0;
      detail::for_each_pack<Groups, T>(
          active.elements, active.patch(k), kernel, [&](auto group, PackMembers const& m) {
            Scalar const values =
                call(kernel, group, m, detail::gather_pack<nodes>(active.elements, m, fields)...);
            for (int l = 0; l < m.count; ++l) total += static_cast<double>(values[l]);
          });
      partial[static_cast<std::size_t>(k)] = total;
    });
    return sum_in_order(partial);
  }

  template <int Groups, class Table, class Visitor, class... Fields>
  void visit(Table const& table, Visitor const& visitor, HostArray<double>& counters,
             Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    require_visitor<Visitor, T, Gather<nodes, Fields...>, Groups, PackMembers,
                    Values<nodes, Fields>...>();
    auto const active = detail::active(table);
    constexpr std::size_t own = Visitor::counters;
    std::vector<double> partial(own * static_cast<std::size_t>(active.patch_count()));
    threads_.for_each_block(active.patch_count(), [&](Index k) {
      auto const mine = visit_patch<Groups>(active.elements, active.patch(k), visitor, fields...);
      for (std::size_t c = 0; c < own; ++c)
        partial[static_cast<std::size_t>(k) * own + c] = mine[c];
    });
    if constexpr (own > 0)
      for (std::size_t k = 0; k < partial.size(); ++k) counters.data()[k % own] += partial[k];
  }

 private:
  static constexpr Index small_loop = 16384;  // to here, waking threads costs more than the loop
  static constexpr Index sum_block = 4096;

  template <int Nodes, class Field>
  using Values = Matrix<Scalar, Nodes, Field::components>;

  using PackMembers = detail::PackMembers<T>;

  detail::ListParts list_parts(Index n) const { return {HostTasks(*this), n, small_loop}; }

  /// Patches that are passed over add nothing.
  template <int Nodes, int C>
  void clear_scratch(Elements<Nodes> const& elements, NodeField<T, C> out) const {
    if (elements.patch_count() == 0) return;
    Index const first = elements.rows().scratch_of(0).first;
    threads_.for_each_part(elements.scratch_nodes(), small_loop, [&](Index from, Index to) {
      std::fill_n(out.data + std::ptrdiff_t{node_stride} * (first + from),
                  std::ptrdiff_t{node_stride} * (to - from), T(0));
    });
  }

  template <int Groups, int Nodes, class Kernel, int C, class... Fields>
  static void accumulate_patch(Elements<Nodes> const& elements, Index patch, Kernel const& kernel,
                               NodeField<T, C> out, Fields const&... fields) {
    auto const [first, last] = elements.rows().scratch_of(patch);
    std::fill_n(out.data + std::ptrdiff_t{node_stride} * first,
                std::ptrdiff_t{node_stride} * (last - first), T(0));
    if constexpr (Elements<Nodes>::may_have_fans && SymmetricKernel<Kernel>)
      if (elements.has_fans())
        return detail::accumulate_fans<Groups>(elements, patch, kernel, out, fields...);
    detail::PatchTargets<Nodes> const targets(elements, patch);
    detail::for_each_pack<Groups, T>(
        elements, patch, kernel, [&](auto group, PackMembers const& m) {
          detail::prefetch_next<Nodes>(elements, m, out, fields...);
          auto const values =
              call(kernel, group, m, detail::gather_pack<Nodes>(elements, m, fields)...);
          for (int a = 0; a < Nodes; ++a) {
            Index rows[Scalar::lanes];
            for (int l = 0; l < Scalar::lanes; ++l) rows[l] = targets.of(m.element[l])[a];
            typename Scalar::Register r[4] = {};
            for (int k = 0; k < C; ++k) r[k] = values(a, k).v;
            detail::scatter_add_nodes<T, Scalar::lanes>(out.data, rows, m.count, r);
          }
        });
  }

  template <int Groups, int Nodes, class Visitor, class... Fields>
  static auto visit_patch(Elements<Nodes> const& elements, Index patch, Visitor const& visitor,
                          Fields const&... fields) {
    std::array<double, Visitor::counters> counters{};
    auto const tally = [&](int k, double x) { counters[static_cast<std::size_t>(k)] += x; };
    detail::for_each_pack<Groups, T>(
        elements, patch, visitor, [&](auto group, PackMembers const& m) {
          auto const values =
              evaluate_at(visitor, group, m, detail::gather_pack<Nodes>(elements, m, fields)...);
          for (int l = 0; l < m.count; ++l) {
            Gather<Nodes, Fields...> const again{elements.nodes(patch, m.element[l]), {fields...}};
            visitor.finish(group, m.element[l], detail::lane_of(values, l), again, tally);
          }
        });
    return counters;
  }

  static double sum_in_order(std::vector<double> const& partial) {
    double total = 0;
    for (double x : partial) total += x;
    return total;
  }

  detail::Threads threads_;
};

}  // namespace pliant
