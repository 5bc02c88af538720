#pragma once

#include "work_precision/energy_error.hpp"
#include "work_precision/statics.hpp"

// A square plate with a slit from its left side to its middle, opened by the exact field of mode I (Williams,
// Journal of Applied Mechanics 24 (1957) 109), u ~ √r, which is prescribed on the outer sides.
namespace pliant::bench {

struct SlitPlate {
  static constexpr char const* name = "slit plate";
  static constexpr int coarse = 4;
  static constexpr double enough = 0.012;
  template <class S>
  using law = Hooke<S>;

  static constexpr double open = 1e-6;

  static Elastic material() { return {.young = 1e5, .poisson = 0.3, .density = 1}; }

  /// The plate [−1, 1]², n × n cells, n even, whose nodes on y = 0, x < 0 are there twice. The slit stands open by
  /// a millionth of its length, since a node in the middle of an edge that lies elsewhere is refused as hanging.
  template <Element E>
  static Mesh<E> mesh(int n) {
    using Linear = std::conditional_t<SimplexCell<typename E::cell>, Tri3, Quad4>;
    auto mesh = mesh::rectangle<Linear>({.size = {2, 2}, .cells = {n, n}, .origin = {-1, -1}});
    std::vector<Index> above(mesh.nodes.size());
    auto const count = mesh.nodes.size();
    for (std::size_t i = 0; i < count; ++i) {
      above[i] = static_cast<Index>(i);
      auto const p = mesh.nodes[i];
      if (!(std::abs(p[1]) < 1e-9 && p[0] < -1e-9)) continue;
      above[i] = static_cast<Index>(mesh.nodes.size());
      mesh.nodes[i][1] = p[0] * open;
      mesh.nodes.push_back({p[0], -p[0] * open});
    }
    for (auto& element : mesh.template elements<Linear>()) {
      double y = 0;
      for (Index node : element) y += mesh.nodes[static_cast<std::size_t>(node)][1];
      if (y > 0)
        for (Index& node : element) node = above[static_cast<std::size_t>(node)];
    }
    mesh.boundaries.clear();
    if constexpr (E::degree > 1)
      return mesh::raised<E>(mesh);
    else
      return mesh;
  }

  /// The displacement at a place (px, py), of dual numbers too.
  template <class S>
  static Vector<S, 2> field(S const& x, S const& y, double px, double py) {
    double const mu = material().lame_mu(), kappa = 3 - 4 * material().poisson;
    double const r = std::hypot(px, py), theta = std::atan2(py, px);
    if (r < 1e-14) return Vector<S, 2>::zero();
    auto const lifted = [&](double value, double by_x, double by_y) {
      S s(value);
      if constexpr (!std::same_as<S, double>)
        for (int k = 0; k < 2; ++k)
          s.derivative[k] = by_x * x.derivative[k] + by_y * y.derivative[k];
      return s;
    };
    double const root = std::sqrt(r), c = std::cos(theta / 2), s = std::sin(theta / 2);
    S const power = lifted(root, px / (2 * r * root), py / (2 * r * root));
    double const along_x = -py / (r * r) / 2, along_y = px / (r * r) / 2;  // of θ/2
    S const cosine = lifted(c, -s * along_x, -s * along_y),
            sine = lifted(s, c * along_x, c * along_y);
    double const scale = 1000 / (2 * mu) / std::sqrt(2 * std::numbers::pi);
    return {{{scale * power * cosine * (kappa - 1 + 2 * (sine * sine))},
             {scale * power * sine * (kappa + 1 - 2 * (cosine * cosine))}}};
  }
  static Tensor<double, 2> gradient(Point<2> const& p) {
    using Variable = Dual<double, 2>;
    auto const u = field(Variable::variable(p[0], 0), Variable::variable(p[1], 1), p[0], p[1]);
    Tensor<double, 2> h;
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 2; ++k) h(i, k) = u[i].derivative[k];
    return h;
  }

  template <class M>
  static auto outside(M const& mesh) {
    return mesh::outer_sides_where(mesh, [](Point<2> const& p) {
      return std::max(std::abs(p[0]), std::abs(p[1])) > 1 - 1e-9;
    });
  }
  template <class TheBody>
  static void hold(TheBody& body) {
    body.drive(outside(body.mesh()), [](Point<2> const& X, double) {
      auto const u = field(X[0], X[1], X[0], X[1]);
      return Point<2>{u[0], u[1]};
    });
  }
  template <class TheBody>
  static void load(TheBody&) {}

  inline static double reference = 0;
  template <Element... Es, class TheBody>
  static double error(TheBody const& body, NewtonReport const&) {
    auto const law = Hooke<double>::from(material());
    return std::sqrt((energy_of_error<Es>(body, law, gradient, Point<2>{0, 0}) + ...) / reference);
  }
  /// The strain energy of the field: that of the error of a body at rest.
  static void find_reference() {
    Body const still{OpenMP<double>{{.threads = 1}}, mesh<Quad4>(64), material(),
                     Group<Formulation<Quad4, Gauss<2>, Hooke>>{}};
    reference =
        energy_of_error<Quad4>(still, Hooke<double>::from(material()), gradient, Point<2>{0, 0});
    std::fprintf(stderr, "slit plate: reference energy %.12g J\n", reference);
  }
};

}  // namespace pliant::bench
