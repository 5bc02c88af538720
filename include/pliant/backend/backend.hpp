#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <pliant/backend/field.hpp>
#include <pliant/backend/host_array.hpp>
#include <pliant/backend/patch_list.hpp>
#include <pliant/backend/patch_ranges.hpp>

// What a backend must offer: arrays, loops over nodes, loops over elements. A backend knows nothing
// of mechanics; mechanics calls these verbs and knows nothing of threads. `Reference` is the
// shortest model, and the oracle of the others.
//
// Arrays        Array<U> owns memory where the loops run. A backend makes it; without one it is empty
//               and can be assigned to.
//   array<U>(count)            zeroed; throws Error when memory runs out. `zeros<U>(backend, count)`
//                              and `upload(backend, vector)` below call it.
//   array<U>(span<U const>)    with values, which are read before it returns; for upload, may be left out
//   unset_array<U>(count)      not set, for unset<U>(backend, count) below; may be left out
//   pinned_array<U>(count)     not set, in memory that the host and loops both reach, of backends whose Array the host does not;
//                              may be left out: see backend/read_back.hpp
//   .data() .size() .upload(span<U const>, first = 0) .download(span<U>)
//                              come after what was asked of the backend before. upload has read what it is given when it
//                              returns, and writes the values from `first` on; download waits
//
// Node loops    f is a functor marked for host and device, called once for each i in [0, n). They take no list of
//               patches; body/velocities.hpp says how nodes of sleeping ones are passed over.
//   for_each(n, f)             f(i)
//   sum(n, f) maximum(n, f)    double; of f(i)
//   add_sum(n, f, to)          *to += the sum of f(i), where `to` is in the backend's memory; waits for
//                              nothing
//   histogram(n, f, bins)      adds f(i).weight to bins[f(i).number], an array of at most 256 integers
//                              in the backend's memory; a negative number: nowhere
//   select(n, f)               std::vector<Index>; the i for which f(i), a bool, ascending
//   select(n, f, to, count)    the same numbers to `to`, which has room for them, and how many to *count
//   scan(n, f, to)             to[i] = the sum of f(j), an Index, over j < i, for i <= n: to[n] is the total. Sums have 32 bits, and
//                              have to fit them. f(i) may read to[i], and no other of `to`
//   sort(n, keys, values, bits)  keys ascending in place, std::uint64_t of which no other bits than the lowest `bits` are set;
//                              values, an Index for each, go with them, those of equal keys in the order they had.
//                              These three read and write the backend's memory, and wait for nothing. Of sorted keys
//                              select finds the first of each, where f(i) tells whether keys[i] differs from
//                              keys[i - 1], and scan of the same f numbers them
//   in_turn(steps...)          several of for_each, scan and sort one after the other; may be left out: see backend/in_turn.hpp
//   for_each_task(n, f) threads()   of backends that have threads on the host, not asked of others: f(k) there,
//                              in no order, each call worth a thread (backend/host_tasks.hpp)
//   record(f)                  a Recording; its replay(n) does n times what f() does. f calls verbs
//                              that return nothing, the same ones with the same arguments each time
//                              (a GPU records them once as a graph).
//   synchronize()              waits until all that was asked for is done
//   timer()                a Timer; start() and stop() do not wait, seconds() does: the time
//                              that the work between them took, summed. A start() without stop() counts nothing
//
// Element loops run over Elements<Nodes>, which holds connectivity and a tag per element: the number
// of the element's group. Each kernel is called with the group as a compile-time constant,
// kernel(GroupNumber<g>{}, v...), where v are the values of the node fields at the element's
// nodes, Matrix<S, Nodes, Components>, and S is a scalar of the backend's choice (a pack of elements
// in SIMD lanes, or a plain number). Elements whose tag is `no_group` are passed over. A kernel or
// visitor with `reads_elements = true` gets one more argument before v...: own(field) gives it the
// values of an ElementField at its element, Vector<S, Components>.
//   Elements<Nodes>(backend, connectivity, groups, tags, nodes, order)
//                              throws Error where an element has a node outside [0, nodes); order: see NodeOrder;
//                              without tags, all elements are of group 0;
//                              two more arguments where a backend plans by blocks: see backend/element_blocks.hpp
//                              rows of nodes that are where loops run already: backend/elements_of_rows.hpp
//   .rows_of_nodes()           an ElementRows: the nodes of each element, where loops run
//   .count() .tags() .regroup()   regroup: call after tags changed, of backends that order elements by
//                              group (orders_by_group); the others look at each tag as they go
//   .take_tags()               gives the array of tags away: its new owner keeps it while loops run
//   .patch_count() .patches() .patch_bounds()  a patch is a run of consecutive elements, as large as suits the backend;
//                              a PatchRanges for loops, and the same bounds (patches + 1) on the host
//   .patch_size()              how many elements a patch has at most
//   .scratch_nodes()           rows that a field to accumulate into needs behind its nodes
//   accumulate<Groups>(elements, kernel, out, fields...)
//                              adds kernel's Matrix<S, Nodes, Components> to the rows of `out`; see Selects in
//                              backend/kernel.hpp
//   sum_elements<Groups>(elements, kernel, fields...)
//                              double; the sum of kernel's S
//   add_sum_elements<Groups>(elements, kernel, to, fields...)
//                              the same, added to *to in the backend's memory; waits for nothing. May be left out, as may
//                              add_sum_elements_at of those at some places: see backend/element_sums.hpp
//   visit<Groups>(elements, visitor, counters, fields...)
//                              values = visitor.evaluate(GroupNumber<g>{}, v...), a Vector<S, N>;
//                              then visitor.finish(GroupNumber<g>{}, element, values of that
//                              element, again, tally), where again() gathers its v... as plain
//                              numbers and tally(k, x) adds x to counters[k] of the array counters,
//                              k < Visitor::counters; see Selects in backend/kernel.hpp
// `over(elements, list)` in place of `elements` passes over the patches that are not in a list
// (backend/patch_list.hpp). What kernels and visitors have to offer is in backend/kernel.hpp.
namespace pliant {

template <int G>
struct GroupNumber {
  static constexpr int value = G;
};

/// Whether a SymmetricKernel may be given the nodes of an element in another order of the same orientation: those of
/// simplices, where any permutation that is even gives one.
enum class NodeOrder { as_given, any_even };

/// The tag of an element that no group holds.
inline constexpr Tag no_group = 255;

/// The nodes of elements, side by side; `width` entries for each, of which the first are its nodes.
struct ElementRows {
  Index const* nodes = nullptr;
  int width = 0;
  PLIANT_HOST_DEVICE Index const* operator[](Index e) const {
    return nodes + static_cast<std::ptrdiff_t>(width) * e;
  }
};

/// What a function adds to a histogram.
struct Bin {
  int number;  // negative: none
  std::int64_t weight;
};
inline constexpr int histogram_bins = 256;

/// An owning array in a backend's memory.
template <class A, class U>
concept BackendArray = std::default_initializable<A> && std::movable<A> &&
                       requires(A a, A const& c, std::span<U const> in, std::span<U> out) {
                         { a.data() } -> std::same_as<U*>;
                         { c.size() } -> std::convertible_to<std::size_t>;
                         a.upload(in);
                         a.upload(in, std::size_t{});
                         c.download(out);
                       };

namespace detail {
struct NodeProbe {
  PLIANT_HOST_DEVICE double operator()(Index) const { return 0; }
  void operator()() const {}
};
struct SelectProbe {
  PLIANT_HOST_DEVICE bool operator()(Index) const { return false; }
};
struct CountProbe {
  PLIANT_HOST_DEVICE Index operator()(Index) const { return 0; }
};
struct BinProbe {
  PLIANT_HOST_DEVICE Bin operator()(Index) const { return {0, 0}; }
};
struct KernelProbe {
  template <int G, class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<G>, V const& v) const {
    return v;
  }
};
struct SumProbe {
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, V const& v) const {
    return v(0, 0);
  }
};
struct VisitorProbe {
  static constexpr int counters = 0;
  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& v) const {
    return Vector<std::remove_cvref_t<decltype(v(0, 0))>, 1>{};
  }
  template <int G, class Values, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index, Values const&, Again const&,
                                 Tally const&) const {}
};

template <class E, class B>
concept TableOf =
    std::default_initializable<E> && std::movable<E> &&
    std::constructible_from<E, B const&,
                            std::vector<std::array<Index, E::nodes_per_element>> const&, int,
                            std::vector<Tag> const&, Index, NodeOrder> &&
    requires(E e, E const& c) {
      { e.tags() } -> std::same_as<typename B::template Array<Tag>&>;
      { c.tags() } -> std::same_as<typename B::template Array<Tag> const&>;
      { e.take_tags() } -> std::same_as<typename B::template Array<Tag>>;
      e.regroup();
      { c.count() } -> std::same_as<Index>;
      { c.rows_of_nodes() } -> std::same_as<ElementRows>;
      { c.scratch_nodes() } -> std::same_as<Index>;
      { c.patch_size() } -> std::same_as<Index>;
      { c.patch_count() } -> std::same_as<Index>;
      { c.patches() } -> std::same_as<PatchRanges>;
      { c.patch_bounds() } -> std::convertible_to<std::span<Index const>>;
    };

template <class B, class Table>
concept LoopsOver = requires(B const& b, Table const& table, NodeField<typename B::scalar, 3> out,
                             NodeField<typename B::scalar const, 3> field,
                             typename B::template Array<double>& counters) {
  { b.template accumulate<1>(table, KernelProbe{}, out, field) } -> std::same_as<void>;
  { b.template sum_elements<1>(table, SumProbe{}, field) } -> std::same_as<double>;
  { b.template visit<1>(table, VisitorProbe{}, counters, field) } -> std::same_as<void>;
};
}  // namespace detail

namespace detail {

/// How many bits a backend's sort looks at where keys are below `count`.
constexpr int key_bits(Index count) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max<Index>(count - 1, 1))));
}

}  // namespace detail

/// Where arrays live and loops run.
template <class B>
concept Backend =
    std::copy_constructible<B> && std::floating_point<typename B::scalar> &&
    BackendArray<typename B::template Array<typename B::scalar>, typename B::scalar> &&
    requires(B const& b, Index n, detail::NodeProbe f, detail::SelectProbe wanted,
             detail::CountProbe number, detail::BinProbe bin, std::int64_t* bins, Index* to,
             std::uint64_t* keys, typename B::Recording const& recording, typename B::Timer timer) {
      b.for_each(n, f);
      { b.sum(n, f) } -> std::same_as<double>;
      { b.maximum(n, f) } -> std::same_as<double>;
      { b.select(n, wanted) } -> std::same_as<std::vector<Index>>;
      { b.select(n, wanted, to, to) } -> std::same_as<void>;
      { b.scan(n, number, to) } -> std::same_as<void>;
      { b.sort(n, keys, to, 1) } -> std::same_as<void>;
      b.add_sum(n, f, static_cast<double*>(nullptr));
      b.histogram(n, bin, bins);
      { b.record(f) } -> std::same_as<typename B::Recording>;
      {
        b.template array<typename B::scalar>(std::size_t{})
      } -> std::same_as<typename B::template Array<typename B::scalar>>;
      b.synchronize();
      recording.replay(1);
      { b.timer() } -> std::same_as<typename B::Timer>;
      timer.start();
      timer.stop();
      { timer.seconds() } -> std::same_as<double>;
      { B::orders_by_group } -> std::convertible_to<bool>;
      { B::name() } -> std::convertible_to<char const*>;
    } &&
    detail::TableOf<typename B::template Elements<4>, B> &&
    detail::LoopsOver<B, typename B::template Elements<4>> &&
    detail::LoopsOver<B, ActiveElements<typename B::template Elements<4>>>;

/// An array of zeros, made by a backend.
template <class U, Backend B>
auto zeros(B const& backend, std::size_t count) {
  return backend.template array<U>(count);
}
/// An array of which all values are written before any is read.
template <class U, Backend B>
auto unset(B const& backend, std::size_t count) {
  using Array = typename B::template Array<U>;
  if constexpr (requires { backend.template unset_array<U>(count); })
    return backend.template unset_array<U>(count);
  else if constexpr (std::same_as<Array, HostArray<U>>)
    return Array::unset(count);
  else
    return zeros<U>(backend, count);
}
/// The array with some values, which are read before it returns.
template <class U, Backend B>
auto upload(B const& backend, std::span<U const> values) {
  using Array = typename B::template Array<U>;
  if constexpr (std::constructible_from<Array, std::span<U const>>) {  // without zeros
    return Array(values);
  } else if constexpr (requires { backend.template array<U>(values); }) {
    return backend.template array<U>(values);
  } else {
    auto array = zeros<U>(backend, values.size());
    array.upload(values);
    return array;
  }
}
/// The same of a vector's.
template <Backend B, class U, class Memory>
auto upload(B const& backend, std::vector<U, Memory> const& values) {
  return upload<U>(backend, std::span<U const>(values));
}
/// The values of an array, on the host.
template <class U, class A>
std::vector<U> download(A const& array) {
  std::vector<U> values(array.size());
  array.download(values);
  return values;
}
/// The same to look at: not copied where they lie on the host.
template <class U, class A>
auto on_host(A const& array) {
  if constexpr (std::same_as<A, HostArray<U>>)
    return std::span<U const>(array.data(), array.size());
  else
    return download<U>(array);
}

}  // namespace pliant
