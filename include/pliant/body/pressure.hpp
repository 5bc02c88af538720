#pragma once

#include <memory>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/element/quadratic_tensor.hpp>
#include <pliant/formulation/physics.hpp>
#include <pliant/mesh/sides.hpp>

namespace pliant {

/// A pressure on facets that follows the surface.
template <int Dim>
struct Pressure {
  std::vector<Facet<Dim>> facets;
  double pascals;  // positive: against the outward normal
};

namespace detail {

template <int Dim, int Nodes>
struct FaceWith;
template <>
struct FaceWith<2, 2> {
  using type = Line2;
};
template <>
struct FaceWith<2, 3> {
  using type = Line3;
};
template <>
struct FaceWith<3, 3> {
  using type = Tri3;
};
template <>
struct FaceWith<3, 6> {
  using type = Tri6;
};
template <>
struct FaceWith<3, 4> {
  using type = Quad4;
};
template <>
struct FaceWith<3, 8> {
  using type = Quad8;
};
template <>
struct FaceWith<3, 9> {
  using type = Quad9;
};

/// F_a = −p ∫ N_a n da over the deformed facet, N.
template <int Dim, class Face, class S>
PLIANT_HOST_DEVICE Matrix<S, Face::nodes, Dim> pressure_force(
    builtin_scalar<S> p, Matrix<S, Face::nodes, Dim> const& x) {
  using T = builtin_scalar<S>;
  using Q = Gauss<SimplexCell<typename Face::cell> ? 2 * Face::degree : Face::degree + 1>;
  static constexpr auto table = tabulate<Face, Q, T>();
  auto f = Matrix<S, Face::nodes, Dim>::zero();
  for (int q = 0; q < table.count; ++q) {
    auto tangents = Matrix<S, Dim, Dim - 1>::zero();
    for (int a = 1; a < Face::nodes; ++a)  // of differences: the place in space is not rounded in
      for (int i = 0; i < Dim; ++i)
        for (int k = 0; k < Dim - 1; ++k)
          tangents(i, k) = tangents(i, k) + T(table.gradient[q][a][k]) * (x(a, i) - x(0, i));
    auto const area = area_of(tangents);
    for (int a = 0; a < Face::nodes; ++a)
      for (int i = 0; i < Dim; ++i)
        f(a, i) = f(a, i) - (p * T(table.weight[q] * table.shape[q][a])) * area[i];
  }
  return f;
}

/// Its change, by a dual number through it.
template <int Dim, class Face, class S>
PLIANT_HOST_DEVICE Matrix<S, Face::nodes, Dim> pressure_tangent_product(
    builtin_scalar<S> p, Matrix<S, Face::nodes, Dim> const& x,
    Matrix<S, Face::nodes, Dim> const& dx) {
  Matrix<Dual<S, 1>, Face::nodes, Dim> moving;
  for (int a = 0; a < Face::nodes; ++a)
    for (int i = 0; i < Dim; ++i) {
      moving(a, i).value = x(a, i);
      moving(a, i).derivative[0] = dx(a, i);
    }
  auto const f = pressure_force<Dim, Face>(p, moving);
  Matrix<S, Face::nodes, Dim> df;
  for (int a = 0; a < Face::nodes; ++a)
    for (int i = 0; i < Dim; ++i) df(a, i) = f(a, i).derivative[0];
  return df;
}

template <class T, int Dim, class Face>
struct PressureKernel {
  T p;
  template <class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<0>, V const& rest, V const& u) const {
    return pressure_force<Dim, Face>(p, rest + u);
  }
};
template <class T, int Dim, class Face>
struct PressureTangentKernel {
  T p;  // times a factor
  template <class V>
  PLIANT_HOST_DEVICE V operator()(GroupNumber<0>, V const& rest, V const& u, V const& du) const {
    return pressure_tangent_product<Dim, Face>(p, rest + u, du);
  }
};

/// Whether some element of a mesh has sides of so many nodes.
template <class M, int Nodes>
inline constexpr bool has_sides_with = false;
template <Element... Es, int Nodes>
inline constexpr bool has_sides_with<Mesh<Es...>, Nodes> = ([]<class E>(E*) {
  for (int s = 0; s < static_cast<int>(E::cell::sides().size()); ++s)
    if (mesh::nodes_on_side<E>(s).size() == Nodes) return true;
  return false;
}(static_cast<Es*>(nullptr)) || ...);

/// Calls visit(Face{}, facets) for each kind of face among some facets of a mesh.
template <class M, class Visit>
void for_each_face_type(std::vector<Facet<M::dim>> const& facets, Visit const& visit) {
  constexpr int Dim = M::dim;
  auto const of_size = [&]<int Nodes>(std::integral_constant<int, Nodes>) {
    if constexpr (has_sides_with<M, Nodes>) {
      std::vector<std::array<Index, Nodes>> same;
      for (auto const& facet : facets)
        if (facet.size() == Nodes) std::copy_n(facet.begin(), Nodes, same.emplace_back().begin());
      if (!same.empty()) visit(typename FaceWith<Dim, Nodes>::type{}, same);
    }
  };
  if constexpr (Dim == 2) {
    of_size(std::integral_constant<int, 2>{});
    of_size(std::integral_constant<int, 3>{});
  } else {
    of_size(std::integral_constant<int, 3>{});
    of_size(std::integral_constant<int, 4>{});
    of_size(std::integral_constant<int, 6>{});
    of_size(std::integral_constant<int, 8>{});
    of_size(std::integral_constant<int, 9>{});
  }
}

}  // namespace detail

/// The pressures of a body in the backend's memory. Virtual functions stand for the kernels, so that
/// bodies that are never pressed do not compile them.
template <Backend B, class M>
class SurfaceForces {
  static constexpr int Dim = M::dim;
  using T = typename B::scalar;
  using Field = NodeField<T, Dim>;
  using ConstField = NodeField<T const, Dim>;

 public:
  bool empty() const { return parts_.empty(); }
  /// Rows that a field to accumulate into needs behind its nodes.
  Index scratch_nodes() const { return scratch_; }

  /// `facets`: internal numbers of nodes.
  void press(B const& backend, std::vector<Facet<Dim>> const& facets, double pascals, Index nodes) {
    detail::for_each_face_type<M>(facets, [&]<class Face>(Face, auto const& connectivity) {
      auto part = std::make_unique<PressedFaces<Face>>();
      part->elements = {backend, connectivity, 1, std::vector<Tag>(connectivity.size(), 0), nodes};
      part->pressure = static_cast<T>(pascals);
      scratch_ = std::max(scratch_, part->elements.scratch_nodes());
      parts_.push_back(std::move(part));
    });
  }
  void add(B const& backend, ConstField rest, ConstField u, Field f) const {
    for (auto const& part : parts_) part->add(backend, rest, u, f);
  }
  void add_tangent_product(B const& backend, T factor, ConstField rest, ConstField u, ConstField du,
                           Field f) const {
    for (auto const& part : parts_) part->add_tangent_product(backend, factor, rest, u, du, f);
  }

 private:
  struct Part {
    virtual ~Part() = default;
    virtual void add(B const&, ConstField rest, ConstField u, Field f) const = 0;
    virtual void add_tangent_product(B const&, T factor, ConstField rest, ConstField u,
                                     ConstField du, Field f) const = 0;
  };
  template <class Face>
  struct PressedFaces : Part {
    typename B::template Elements<Face::nodes> elements;
    T pressure;  // Pa

    void add(B const& backend, ConstField rest, ConstField u, Field f) const override {
      backend.template accumulate<1>(elements, detail::PressureKernel<T, Dim, Face>{pressure}, f,
                                     rest, u);
    }
    void add_tangent_product(B const& backend, T factor, ConstField rest, ConstField u,
                             ConstField du, Field f) const override {
      backend.template accumulate<1>(
          elements, detail::PressureTangentKernel<T, Dim, Face>{factor * pressure}, f, rest, u, du);
    }
  };

  std::vector<std::unique_ptr<Part>> parts_;
  Index scratch_ = 0;
};

}  // namespace pliant
