#pragma once

#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/vector_memory.cuh>
#include <pliant/formulation/point_kernel.hpp>

// Accumulation of elements with many nodes: in one thread, their values would not fit the registers.
namespace pliant::detail {

/// How an element's columns of nodes along ξ₂, and its rows of points, are shared among threads.
template <class E>
struct PointRows {
  static constexpr int dim = E::dim, size = Lattice<E>::size, count = Lattice<E>::count;
  static constexpr int threads = size * size;             // of an element
  static constexpr int elements = row_threads / threads;  // of a block
  static constexpr bool complete = E::nodes == count;  // a node at each place; else a Serendipity

  /// The nodes at the places of the lattice; −1 where there is none.
  struct Nodes {
    int at[count];
  };
  static constexpr Nodes nodes() {
    Nodes all{};
    for (int l = 0; l < count; ++l) all.at[l] = Lattice<E>::node_at(l);
    return all;
  }
};

/// Whether the rows of points of a kernel's elements are shared among threads.
template <class Kernel, int Groups>
constexpr bool shares_rows() {
  if constexpr (PointKernel<Kernel, Groups>) {
    using E = typename Kernel::template points<0>::element;
    return []<int... G>(std::integer_sequence<int, G...>) {
      return E::dim == 3 && E::degree == 2 &&
             ((points_per_direction(
                   Kernel::template points<G>::quadrature::template rule<typename E::cell>()) <=
               E::degree + 1) &&
              ...);
    }(std::make_integer_sequence<int, Groups>());
  } else {
    return false;
  }
}

/// One of Lagrange's polynomials on −1, 0, 1, and its slope.
template <class T>
struct LineShape {
  T value, slope;
  __device__ __forceinline__ static LineShape of(int a, T x) {
    if (a == 1) return {T(1) - x * x, T(-2) * x};
    T const end = a == 0 ? T(-0.5) : T(0.5);
    return {end * x + T(0.5) * x * x, end + x};
  }
};

/// What the nodes (a, b, ·) weigh in the polynomials along a row of points, by their values at ξ₂ = −1, 0, 1: those of
/// the slopes along ξ₀ and ξ₁, and of the field itself.
template <class E, class T>
struct ColumnWeights {
  T ends[3];    // of nodes at ξ₂ = ∓1, in the value there
  T across[3];  // of the same, in the value at 0
  T middle[3];  // of a node at 0, in the value there

  /// By the polynomials in ξ₀ and ξ₁ of the column, and by those of the middle column.
  __device__ __forceinline__ ColumnWeights(LineShape<T> const& a, LineShape<T> const& b,
                                           LineShape<T> const& middle_a,
                                           LineShape<T> const& middle_b, bool is_corner) {
    auto const weight = [](int k, LineShape<T> const& p, LineShape<T> const& q) {
      return k == 0 ? p.slope * q.value : k == 1 ? p.value * q.slope : p.value * q.value;
    };
#pragma unroll
    for (int k = 0; k < 3; ++k) {
      T const own = weight(k, a, b);
      ends[k] = middle[k] = own;
      across[k] = T(0);
      if constexpr (!PointRows<E>::complete) {
        // The functions of a Serendipity's nodes at the places that have none: −1/4 of corners and 1/2 of edges in the
        // middle of a side, −1/4 and 1/4 in the middle of the cell.
        T const centre = weight(k, middle_a, middle_b);
        T const sides = weight(k, middle_a, b) + weight(k, a, middle_b);
        ends[k] = is_corner ? own - T(0.25) * centre : own + T(0.5) * centre;
        across[k] = is_corner ? T(-0.25) * (sides + centre) : T(0.5) * own + T(0.25) * centre;
        middle[k] = own + T(0.5) * sides + T(0.25) * centre;
      }
    }
  }
};

/// Rows of shared memory. Several threads read the same ones, which counts once for pieces of 8 bytes, and in single
/// precision for longer ones too.
template <int N, class T>
inline constexpr int shared_row = sizeof(T) == 4 ? (N + 1) / 2 * 2 : N;
template <int N, class T>
__device__ __forceinline__ void load_shared(T const* row, T* values) {
  if constexpr (sizeof(T) == 4)
    load_values<N>(row, values);
  else
#pragma unroll
    for (int i = 0; i < N; ++i) values[i] = row[i];
}

/// Threads of which each has a row of an element's points along ξ₂: values of the nodes in shared memory, sums over ξ₀
/// and ξ₁ to the row's polynomials in ξ₂, fluxes along it, and back.
template <int Groups, class E, class T, class Kernel, class... Fields>
__global__ void __launch_bounds__(row_threads, row_blocks<T>)
    accumulate_rows(ElementView<E::nodes> const elements, __grid_constant__ Kernel const kernel,
                    NodeField<T, E::dim> const out, Fields... fields) {
  using Rows = PointRows<E>;
  constexpr int dim = E::dim, size = Rows::size, count = Rows::count, all = Rows::threads;
  constexpr int field_count = sizeof...(Fields), values = field_count * dim;
  constexpr int row_width = shared_row<values, T>;
  constexpr int sum_width = shared_row<size * dim * dim, T>;
  static constexpr auto nodes = Rows::nodes();
  __shared__ __align__(16) T nodal[Rows::elements][count][row_width];
  // Of each row: (ξ₂, slope, direction).
  __shared__ __align__(16) T sums[Rows::elements][all][sum_width];

  begin_after_previous_kernel();
  int const own = static_cast<int>(threadIdx.x) / all, t = static_cast<int>(threadIdx.x) % all;
  Index const e = own < Rows::elements
                      ? elements.element(static_cast<Index>(blockIdx.x) * Rows::elements + own)
                      : -1;
  Index const* const row =
      elements.connectivity + static_cast<std::ptrdiff_t>(elements.width) * (e < 0 ? 0 : e);
  Tag const tag = e < 0 ? no_group : elements.tags[e];
  if (e >= 0) {
    T origin[values];  // differences to node 0: an element's place is not rounded into gradients
    int offset = 0;
    ((load_node(fields, row[0], origin + offset), offset += dim), ...);
#pragma unroll
    for (int c = 0; c < size; ++c) {
      int const a = nodes.at[t + c * all];
      if (a < 0) continue;
      T at[values];
      offset = 0;
      ((load_node(fields, row[a], at + offset), offset += dim), ...);
#pragma unroll
      for (int i = 0; i < values; ++i) nodal[own][t + c * all][i] = at[i] - origin[i];
    }
  }
  __syncthreads();

  dispatch<Groups>(tag, [&]<int G>(GroupNumber<G> group) {
    using Rule = ProductRule<typename Kernel::template points<G>::quadrature, typename E::cell, T>;
    static constexpr auto rule = Rule::make();
    constexpr int n = Rule::count;
    if (t >= n * n) return;
    LineShape<T> at0[size], at1[size];
#pragma unroll
    for (int a = 0; a < size; ++a) {
      at0[a] = LineShape<T>::of(a, rule.place[t % n]);
      at1[a] = LineShape<T>::of(a, rule.place[t / n]);
    }
    T column[3][size][values] = {};
#pragma unroll
    for (int b = 0; b < size; ++b)
#pragma unroll
      for (int a = 0; a < size; ++a) {
        if (!Rows::complete && a == 1 && b == 1) continue;
        bool const is_corner = a != 1 && b != 1;
        ColumnWeights<E, T> const weight(at0[a], at1[b], at0[1], at1[1], is_corner);
        T first[row_width], last[row_width];
        load_shared<row_width>(nodal[own][a + size * b], first);
        load_shared<row_width>(nodal[own][a + size * b + 2 * all], last);
#pragma unroll
        for (int k = 0; k < 3; ++k)
#pragma unroll
          for (int i = 0; i < values; ++i) {
            column[k][0][i] += weight.ends[k] * first[i];
            column[k][2][i] += weight.ends[k] * last[i];
            if constexpr (!Rows::complete)
              column[k][1][i] += weight.across[k] * (first[i] + last[i]);
          }
        if (!Rows::complete && !is_corner) continue;
        T middle[row_width];
        load_shared<row_width>(nodal[own][a + size * b + all], middle);
#pragma unroll
        for (int k = 0; k < 3; ++k)
#pragma unroll
          for (int i = 0; i < values; ++i) column[k][1][i] += weight.middle[k] * middle[i];
      }
    T sum[size * dim * dim] = {};
#pragma unroll 1
    for (int p = 0; p < n; ++p) {
      T along[3][size];  // of the polynomials: their values at the point, of the last one its slope
#pragma unroll
      for (int c = 0; c < size; ++c) {
        auto const at2 = LineShape<T>::of(c, rule.place[p]);
        along[0][c] = along[1][c] = at2.value;
        along[2][c] = at2.slope;
      }
      auto const slopes = [&](int f) {
        Tensor<T, dim> g;
#pragma unroll
        for (int i = 0; i < dim; ++i)
#pragma unroll
          for (int k = 0; k < dim; ++k) {
            g(i, k) = along[k][0] * column[k][0][f * dim + i];
#pragma unroll
            for (int c = 1; c < size; ++c) g(i, k) += along[k][c] * column[k][c][f * dim + i];
          }
        return g;
      };
      int const q = t + n * n * p;
      auto const flux = [&]<int... F>(std::integer_sequence<int, F...>) {
        return flux_at(kernel, group, OneElement{e}, q, rule.weight[q], slopes(F)...);
      }(std::make_integer_sequence<int, field_count>());
#pragma unroll
      for (int c = 0; c < size; ++c)
#pragma unroll
        for (int k = 0; k < dim; ++k)
#pragma unroll
          for (int i = 0; i < dim; ++i) sum[(c * dim + k) * dim + i] += along[k][c] * flux(i, k);
    }
#pragma unroll
    for (int i = 0; i < size * dim * dim; ++i) sums[own][t][i] = sum[i];
  });
  __syncthreads();

  T force[size][dim] = {};
  dispatch<Groups>(tag, [&]<int G>(GroupNumber<G>) {
    using Rule = ProductRule<typename Kernel::template points<G>::quadrature, typename E::cell, T>;
    static constexpr auto rule = Rule::make();
    constexpr int n = Rule::count;
    int const a = t % size, b = t / size;
    LineShape<T> at0[n], at1[n], middle[n];
#pragma unroll
    for (int p = 0; p < n; ++p) {
      at0[p] = LineShape<T>::of(a, rule.place[p]);
      at1[p] = LineShape<T>::of(b, rule.place[p]);
      middle[p] = LineShape<T>::of(1, rule.place[p]);
    }
#pragma unroll
    for (int j = 0; j < n; ++j)
#pragma unroll
      for (int i = 0; i < n; ++i) {
        ColumnWeights<E, T> const weight(at0[i], at1[j], middle[i], middle[j], a != 1 && b != 1);
        T sum[sum_width];
        load_shared<sum_width>(sums[own][i + n * j], sum);
        auto const add = [&](int to, T const(&by)[3], int from) {
#pragma unroll
          for (int k = 0; k < dim; ++k)
#pragma unroll
            for (int d = 0; d < dim; ++d) force[to][d] += by[k] * sum[(from * dim + k) * dim + d];
        };
        add(0, weight.ends, 0);
        add(1, weight.middle, 1);
        add(2, weight.ends, 2);
        if constexpr (!Rows::complete) {
          add(0, weight.across, 1);
          add(2, weight.across, 1);
        }
      }
  });
  if (tag >= Groups) return;
#pragma unroll
  for (int c = 0; c < size; ++c)
    if (int const a = nodes.at[t + c * all]; a >= 0) add_to_node(out, row[a], force[c]);
}

}  // namespace pliant::detail
