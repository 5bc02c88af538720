#pragma once

#if !defined(__CUDACC__)
#error "pliant/cuda.hpp needs nvcc: compile this file as CUDA (.cu), and link pliant::cuda."
#endif

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/kernel.hpp>
#include <pliant/cuda/accumulate.cuh>
#include <pliant/cuda/accumulate_fans.cuh>
#include <pliant/cuda/context.hpp>
#include <pliant/cuda/histogram.cuh>
#include <pliant/cuda/in_turn.cuh>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/pinned_array.hpp>
#include <pliant/cuda/point_rows.cuh>
#include <pliant/cuda/recording.hpp>
#include <pliant/cuda/reduce.cuh>
#include <pliant/cuda/scan.cuh>
#include <pliant/cuda/scatter.cuh>
#include <pliant/cuda/select.cuh>
#include <pliant/cuda/sort.cuh>
#include <pliant/cuda/timer.hpp>
#include <pliant/cuda/visit.cuh>

namespace pliant {

namespace detail {
/// A functor that stands for a list of what few nodes do. All blocks of its kernel start at once, and would let in the next
/// kernel while the one before it, a loop over elements say, still runs: blocks that start then share a multiprocessor
/// where others have none. With 111 of 13166 patches of Tet4 awake a step takes 7 µs, and 13 if the next one starts
/// early (H100).
template <class F>
concept OfFewNodes = requires { requires F::few_nodes; };

template <class F>
__global__ void __launch_bounds__(node_threads)
    call_for_each(Index n, __grid_constant__ F const f) {
  begin_after_previous_kernel<OfFewNodes<F> ? Next::in_order : Next::early>();
  Index const i = static_cast<Index>(blockIdx.x * node_threads + threadIdx.x);
  if (i < n) f(i);
}
}  // namespace detail

/// One NVIDIA GPU. Verbs are queued on a stream; those that return a value wait for it and for no
/// other (CudaOptions tells how it orders with a caller's). Sums over elements and nodes have the
/// same bits each time; accumulation adds in no fixed order. Copies share the stream; use them from
/// one thread at a time. Backends of several GPUs may take turns in one thread: every call leaves
/// the thread's current device as it was. Throws Error when there is no GPU.
template <std::floating_point T>
class Cuda {
 public:
  using scalar = T;
  template <class U>
  using Array = DeviceArray<U>;
  template <int Nodes>
  using Elements = CudaElements<T, Nodes>;
  using Recording = CudaRecording;
  using Timer = CudaTimer;
  static constexpr bool orders_by_group = false;
  static constexpr bool keeps_trees = true;     // see TopologyOn
  static constexpr bool sums_at_places = true;  // see add_sum_elements_at
  static constexpr char const* name() { return "Cuda"; }

  Cuda(CudaOptions const& options = {})
      : context_(std::make_shared<detail::CudaContext>(options)) {}

  int device() const { return context_->stream()->device(); }
  cudaStream_t stream() const { return context_->stream()->get(); }
  std::shared_ptr<detail::SideStream> const& side_stream() const { return context_->side_stream(); }
  void synchronize() const { context_->stream()->synchronize(); }
  Timer timer() const { return Timer(context_->stream()); }
  Recording record(std::function<void()> const& f) const { return {context_, f}; }
  template <class U>
  Array<U> array(std::size_t count) const {
    return {context_->stream(), count};
  }
  template <class U>
  Array<U> array(std::span<U const> values) const {
    return {context_->stream(), values};
  }

  template <class U>
  Array<U> unset_array(std::size_t count) const {
    return Array<U>::unset(context_->stream(), count);
  }
  template <class U>
  PinnedArray<U> pinned_array(std::size_t count) const {
    return {context_->stream(), count};
  }

  template <class F>
  void for_each(Index n, F const& f) const {
    if (n > 0)
      launch("for_each", {blocks(n, detail::node_threads), detail::node_threads},
             detail::call_for_each<F>, n, f);
  }
  template <class F>
  double sum(Index n, F const& f) const {
    return n <= 0 ? 0.0 : reduce<detail::Sum>("sum", n, f);
  }
  template <class F>
  void add_sum(Index n, F const& f, double* to) const {
    if (n > 0) reduce_to<detail::AddedSum>("add_sum", n, f, to);
  }
  template <class F>
  double maximum(Index n, F const& f) const {
    return n <= 0 ? -std::numeric_limits<double>::infinity()
                  : reduce<detail::Maximum>("maximum", n, f);
  }

  template <class F>
  std::vector<Index> select(Index n, F const& f) const {
    if (n <= 0) return {};
    auto words = array<std::uint32_t>(detail::selected_words(n));
    launch("select", {blocks(n, detail::node_threads), detail::node_threads},
           detail::mark_selected<F>, n, f, words.data());
    return detail::numbers_of_bits(download<std::uint32_t>(words));
  }
  template <class F>
  void select(Index n, F const& f, Index* to, Index* count) const {
    detail::select_list(*context_, n, f, to, count);
  }
  template <class F>
  void scan(Index n, F const& f, Index* to) const {
    detail::scan_list(*context_, n, f, to);
  }
  void sort(Index n, std::uint64_t* keys, Index* values, int bits) const {
    if (n > 1 && bits > 0) detail::sort_list(*context_, n, detail::KeyList{keys, values}, bits);
  }

  template <class... Steps>
  void in_turn(Steps const&... steps) const {
    if (detail::are_short(steps...))
      detail::do_in_turn(*context_, steps...);
    else
      (steps.run(*this), ...);
  }

  template <int Groups, class Table, class Kernel, int C, class... Fields>
  void accumulate(Table const& table, Kernel const& kernel, NodeField<T, C> out,
                  Fields const&... fields) const {
    static_assert((std::same_as<std::remove_const_t<decltype(*fields.data + 0)>, T> && ...),
                  "the fields of accumulate have the backend's scalar");
    constexpr int nodes = detail::table_nodes<Table>;
    require_kernel<Kernel, Matrix<T, nodes, C>, Groups, OneElement, Values<nodes, Fields>...>();
    auto const active = detail::active(table);
    if (active.most <= 0) return;
    if constexpr (detail::shares_rows<Kernel, Groups>()) {
      using E = typename Kernel::template points<0>::element;
      void (*const by_rows)(detail::ElementView<nodes>, Kernel, NodeField<T, C>, Fields...) =
          detail::accumulate_rows<Groups, E, T, Kernel, Fields...>;
      launch("accumulate",
             {blocks(element_count(active), detail::PointRows<E>::elements), detail::row_threads},
             by_rows, active.elements.view({active.list, active.most}), kernel, out, fields...);
    } else if constexpr (detail::scatters<T, nodes>) {
      accumulate_by_elements<Groups>(active, kernel, out, fields...);
    } else {
      if constexpr (nodes == detail::FanPlanner::nodes && C != 2) {  // tetrahedra
        if (active.elements.has_fans()) {
          if constexpr (C == 3 && SymmetricKernel<Kernel>)
            if (active.list == nullptr || active.most > detail::few_patches)
              return accumulate_fans<Groups>(active, kernel, out, fields...);
          return accumulate_by_elements<Groups>(active, kernel, out, fields...);
        }
      }
      using Memory = detail::PatchMemory<T, C, (Fields::components + ... + 0)>;
      void (*const by_patch)(detail::PatchView<detail::PatchRow<nodes>>, Kernel, NodeField<T, C>,
                             Fields...) =
          detail::accumulate_patches<Groups, nodes, T, C, Kernel, Fields...>;
      auto const patches = active.elements.patch_view({active.list, active.most});
      launch("accumulate",
             {active.most, active.elements.threads(), Memory::bytes(patches.capacity)}, by_patch,
             patches, kernel, out, fields...);
    }
  }
  template <int Groups, class Table, class Kernel, class... Fields>
  double sum_elements(Table const& table, Kernel const& kernel, Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    require_kernel<Kernel, double, Groups, OneElement, Values<nodes, Fields>...>();
    auto const active = detail::active(table);
    if (active.most <= 0) return 0;
    return reduce<detail::Sum>("sum_elements", element_count(active),
                               element_term<Groups>(active, kernel, fields...));
  }
  template <int Groups, class Table, class Kernel, class... Fields>
  void add_sum_elements(Table const& table, Kernel const& kernel, double* to,
                        Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    require_kernel<Kernel, double, Groups, OneElement, Values<nodes, Fields>...>();
    auto const active = detail::active(table);
    if (active.most > 0)
      reduce_to<detail::AddedSum>("add_sum_elements", element_count(active),
                                  element_term<Groups>(active, kernel, fields...), to);
  }
  template <int Groups, class Table, class Places, class Kernel, class... Fields>
  void add_sum_elements_at(Table const& table, Places const& places, Index count,
                           Kernel const& kernel, double* to, Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    require_kernel<Kernel, double, Groups, OneElement, Values<nodes, Fields>...>();
    auto const term = element_term<Groups>(detail::active(table), kernel, fields...);
    if (count > 0)
      reduce_to<detail::AddedSum>("add_sum_elements_at", count, detail::TermAt{term, places}, to);
  }
  template <int Groups, class Table, class Visitor, class... Fields>
  void visit(Table const& table, Visitor const& visitor, DeviceArray<double>& counters,
             Fields const&... fields) const {
    constexpr int nodes = detail::table_nodes<Table>;
    require_visitor<Visitor, T, Gather<nodes, Fields...>, Groups, OneElement,
                    Values<nodes, Fields>...>();
    auto const active = detail::active(table);
    if (active.most <= 0) return;
    void (*const visit_kernel)(detail::ElementView<nodes>, Visitor, double*, Fields...) =
        detail::visit_elements<Groups, nodes, Visitor, Fields...>;
    constexpr int in_block = detail::visit_threads * detail::visits_per_thread<Visitor>;
    launch("visit", {blocks(element_count(active), in_block), detail::visit_threads}, visit_kernel,
           active.elements.view({active.list, active.most}), visitor, counters.data(), fields...);
  }
  template <class F>
  void histogram(Index n, F const& f, std::int64_t* bins) const {
    if (n <= 0) return;
    Index const count =
        std::min<Index>(blocks(n, detail::reduce_threads), detail::CudaContext::max_partials);
    launch("histogram", {count, detail::reduce_threads}, detail::add_to_histogram<F>, n, f, bins);
  }

 private:
  template <int Nodes, class Field>
  using Values = Matrix<T, Nodes, Field::components>;

  template <int Groups, class Active, class Kernel, int C, class... Fields>
  void accumulate_by_elements(Active const& active, Kernel const& kernel, NodeField<T, C> out,
                              Fields const&... fields) const {
    constexpr int nodes = Active::nodes;
    void (*const scatter)(detail::ElementView<nodes>, Kernel, NodeField<T, C>, Fields...) =
        detail::scatter_elements<Groups, nodes, T, C, Kernel, Fields...>;
    launch("accumulate",
           {blocks(element_count(active), detail::scatter_threads), detail::scatter_threads},
           scatter, active.elements.view({active.list, active.most}), kernel, out, fields...);
  }
  template <int Groups, class Active, class Kernel, int C, class... Fields>
  void accumulate_fans(Active const& active, Kernel const& kernel, NodeField<T, C> out,
                       Fields const&... fields) const {
    using Memory = detail::PatchMemory<T, C, (Fields::components + ... + 0)>;
    void (*const by_fan)(detail::PatchView<detail::FanVisit>, Kernel, NodeField<T, C>, Fields...) =
        detail::accumulate_fans<Groups, T, C, Kernel, Fields...>;
    auto const fans = active.elements.fan_view({active.list, active.most});
    int const bytes = Memory::bytes(fans.capacity) + detail::tag_bytes(fans.patch_size);
    launch("accumulate", {active.most, active.elements.threads(), bytes}, by_fan, fans, kernel, out,
           fields...);
  }

  template <int Groups, class Active, class Kernel, class... Fields>
  static detail::ElementTerm<Groups, Active::nodes, Kernel, Fields...> element_term(
      Active const& active, Kernel const& kernel, Fields const&... fields) {
    return {active.elements.view({active.list, active.most}), kernel, {fields...}};
  }

  /// How many elements a loop looks at, at most.
  template <class Active>
  static Index element_count(Active const& active) {
    return active.list == nullptr ? active.elements.count()
                                  : active.most * active.elements.patch_size();
  }
  static Index blocks(Index n, int threads) { return n / threads + (n % threads != 0); }

  template <class... Parameters, class... Arguments>
  void launch(char const* verb, detail::LaunchShape const& shape, void (*kernel)(Parameters...),
              Arguments const&... arguments) const {
    auto const device = context_->stream()->enter();
    detail::launch(detail::Start::early, verb, shape, stream(), kernel, arguments...);
  }
  /// Leaves the result in memory that kernels write to; waits for nothing.
  template <class Reduction, class F>
  void reduce_to(char const* verb, Index n, F const& f, double* result) const {
    Index const count =
        std::min<Index>(blocks(n, detail::reduce_threads), detail::CudaContext::max_partials);
    launch(verb, {count, detail::reduce_threads}, detail::reduce_all<Reduction, F>, n, f,
           context_->partials(), context_->blocks_done(), result);
  }
  template <class Reduction, class F>
  double reduce(char const* verb, Index n, F const& f) const {
    reduce_to<Reduction>(verb, n, f, context_->result());
    synchronize();
    return *context_->result();
  }

  std::shared_ptr<detail::CudaContext> context_;
};

}  // namespace pliant
