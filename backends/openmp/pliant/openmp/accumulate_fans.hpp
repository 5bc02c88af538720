#pragma once

#include <tuple>

#include <pliant/openmp/pack_members.hpp>

// Element loops over fans, a fan in each lane of a pack.
namespace pliant::detail {

/// Fans in the lanes of one pack, the longest first; behind `count` the last one repeats.
template <class T>
class FanPack {
 public:
  using Scalar = Pack<T>;
  static constexpr int lanes = Scalar::lanes;
  using Indices = Index[lanes];

  FanPack(PatchFans const& fans, std::span<FanRun const> runs, std::size_t first)
      : fans_(fans), count_(static_cast<int>(std::min<std::size_t>(lanes, runs.size() - first))) {
    for (int l = 0; l < lanes; ++l) {
      FanRun const& run = runs[first + static_cast<std::size_t>(std::min(l, count_ - 1))];
      ends_[l] = run.ends;
      ring_[l] = run.ring;
      elements_[l] = run.elements;
      size_[l] = run.size;
      sizes_.v[l] = static_cast<T>(run.size);
    }
  }
  int most() const { return size_[0]; }
  int least() const { return size_[lanes - 1]; }
  /// Which lanes have an element k.
  typename Scalar::Mask has(int k) const { return Scalar(static_cast<T>(k)) < sizes_; }

  /// The nodes at one end of the edges, or the k-th around them, as the patch numbers them; the last one of a fan stays.
  void end(int which, Indices& nodes) const {
    for (int l = 0; l < lanes; ++l) nodes[l] = fans_.corners[ends_[l] + which];
  }
  void ring(int k, Indices& nodes) const {
    for (int l = 0; l < lanes; ++l) nodes[l] = fans_.corners[ring_[l] + std::min(k, size_[l])];
  }
  void members(int k, PackMembers<T>& m) const {
    m.count = count_;
    for (int l = 0; l < lanes; ++l)
      m.element[l] =
          fans_.first_element +
          fans_.list.elements[static_cast<std::size_t>(elements_[l] + std::min(k, size_[l] - 1))];
  }
  template <class U, int C>
  PLIANT_INLINE Matrix<Scalar, 1, C> gather(NodeField<U, C> const& field,
                                            Indices const& of_patch) const {
    Index nodes[lanes];
    for (int l = 0; l < lanes; ++l) nodes[l] = fans_.nodes[of_patch[l]];
    typename Scalar::Register r[4];
    gather_nodes<T, lanes>(field.data, nodes, r);
    Matrix<Scalar, 1, C> values;
    for (int k = 0; k < C; ++k) values(0, k).v = r[k];
    return values;
  }
  template <int C>
  PLIANT_INLINE void scatter(NodeField<T, C> const& out, Indices const& of_patch,
                             Scalar const (&values)[C]) const {
    Index rows[lanes];
    for (int l = 0; l < lanes; ++l) rows[l] = fans_.targets[of_patch[l]];
    typename Scalar::Register r[4] = {};
    for (int k = 0; k < C; ++k) r[k] = values[k].v;
    scatter_add_nodes<T, lanes>(out.data, rows, count_, r);
  }

 private:
  PatchFans const& fans_;
  int count_;
  Indices ends_, ring_, elements_;
  int size_[lanes];
  Scalar sizes_;
};

/// The values of a field at the corners of an element of each fan, less those at the first end of its edge: kernels that
/// are symmetric look at differences alone.
template <class T, int C>
struct FanValues {
  using Scalar = Pack<T>;
  Matrix<Scalar, 1, C> origin;
  Matrix<Scalar, 4, C> at;

  template <class U>
  FanValues(FanPack<T> const& pack, NodeField<U, C> const& field,
            typename FanPack<T>::Indices const& end, typename FanPack<T>::Indices const& other,
            typename FanPack<T>::Indices const& first)
      : origin(pack.gather(field, end)) {
    for (int k = 0; k < C; ++k) at(0, k) = Scalar(0);
    set(1, pack.gather(field, other));
    set(3, pack.gather(field, first));
  }
  void set(int a, Matrix<Scalar, 1, C> const& values) {
    for (int k = 0; k < C; ++k) at(a, k) = values(0, k) - origin(0, k);
  }
};

/// To the next element of each fan, or of those that have one.
template <class S, int C>
PLIANT_INLINE inline void advance(Matrix<S, 4, C>& at) {
  for (int k = 0; k < C; ++k) at(2, k) = at(3, k);
}
template <class S, int C>
PLIANT_INLINE inline void advance(Matrix<S, 4, C>& at, typename S::Mask const& has) {
  for (int k = 0; k < C; ++k) at(2, k) = select(has, at(3, k), at(2, k));
}

template <int Group, class T, class Kernel, int C, class... Fields>
void accumulate_fan_pack(FanPack<T> const& pack, Kernel const& kernel, NodeField<T, C> out,
                         Fields const&... fields) {
  using Scalar = Pack<T>;
  typename FanPack<T>::Indices end, other, ring;
  pack.end(0, end);
  pack.end(1, other);
  pack.ring(0, ring);
  std::tuple<FanValues<T, Fields::components>...> values(
      FanValues<T, Fields::components>(pack, fields, end, other, ring)...);
  Scalar sums[3][C];  // of both ends, and where the next element begins
  for (auto& sum : sums)
    for (Scalar& x : sum) x = Scalar(0);
  PackMembers<T> m;
  std::apply(
      [&](auto&... v) PLIANT_INLINE {
        for (int k = 0; k < pack.most(); ++k) {
          typename FanPack<T>::Indices next;
          pack.ring(k + 1, next);
          if (k < pack.least()) {
            ((advance(v.at)), ...);
          } else {
            auto const has = pack.has(k);
            ((advance(v.at, has)), ...);
          }
          (v.set(3, pack.gather(fields, next)), ...);
          if constexpr (ReadsElements<Kernel>) pack.members(k, m);
          auto share = call(kernel, GroupNumber<Group>{}, m, v.at...);
          if (k >= pack.least()) {
            auto const has = pack.has(k);
            for (int a = 0; a < 4; ++a)
              for (int c = 0; c < C; ++c) share(a, c) = select(has, share(a, c), Scalar(0));
          }
          for (int c = 0; c < C; ++c) {
            sums[0][c] += share(0, c);
            sums[1][c] += share(1, c);
            sums[2][c] += share(2, c);
          }
          pack.scatter(out, ring, sums[2]);
          for (int c = 0; c < C; ++c) sums[2][c] = share(3, c);
          std::copy_n(next, Scalar::lanes, ring);
        }
      },
      values);
  pack.scatter(out, ring, sums[2]);
  pack.scatter(out, end, sums[0]);
  pack.scatter(out, other, sums[1]);
}

/// kernel's shares of all elements of a patch.
template <int Groups, class T, class Kernel, int C, class... Fields>
void accumulate_fans(Patches<4> const& elements, Index patch, Kernel const& kernel,
                     NodeField<T, C> out, Fields const&... fields) {
  PatchFans const fans = elements.fans(patch);
  [&]<int... G>(std::integer_sequence<int, G...>) {
    auto const accumulate_group = [&]<int Group>(GroupNumber<Group>) {
      auto const runs = elements.runs(patch, Group);
      constexpr std::size_t lanes = Pack<T>::lanes;
      for (std::size_t first = 0; first < runs.size(); first += lanes)
        accumulate_fan_pack<Group>(FanPack<T>(fans, runs, first), kernel, out, fields...);
    };
    (accumulate_group(GroupNumber<G>{}), ...);
  }(std::make_integer_sequence<int, Groups>());
}

}  // namespace pliant::detail
