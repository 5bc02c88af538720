#include <memory>

#include <pliant/openmp.hpp>
#include <pliant/pliant.hpp>
#include <pliant/solver/local_steps.hpp>

#include "work_precision/contest.hpp"

// A cube of Tet4 in which one compact hundredth of the elements is ten times smaller, clamped at its left, swings
// under gravity: a time step for each element against one for all. Errors are those of the history of a corner
// beside global steps a quarter as long on the same mesh.
namespace pliant::bench {

using F = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
using History = std::vector<Point<3>>;

/// A ball of a hundredth of the cube, drawn together to a tenth; the shell around it takes up the room.
inline Mesh<Tet4> cube_with_a_small_ball(int cells) {
  auto mesh = mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
  Point<3> const middle{0.31, 0.37, 0.43};
  double const ball = std::cbrt(0.01 * 3 / (4 * std::numbers::pi)), shell = 0.25, factor = 0.1;
  for (auto& p : mesh.nodes) {
    double r = 0;
    for (std::size_t k = 0; k < 3; ++k) r += square(p[k] - middle[k]);
    r = std::sqrt(r);
    if (r >= shell) continue;
    double const shrink =
        r < ball ? factor
                 : (factor * ball + (r - ball) * (shell - factor * ball) / (shell - ball)) / r;
    for (std::size_t k = 0; k < 3; ++k) p[k] = middle[k] + shrink * (p[k] - middle[k]);
  }
  return mesh;
}

/// √(Σ |u − v|² / Σ |v|²).
inline double apart(History const& u, History const& v) {
  double off = 0, all = 0;
  for (std::size_t i = 0; i < v.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      off += square(u[i][k] - v[i][k]);
      all += square(v[i][k]);
    }
  return std::sqrt(off / all);
}

class Cube {
  static constexpr double apart_ = 0.02;  // s between samples

  template <class T>
  auto made() const {
    Body body{OpenMP<T>{{.threads = threads_}}, *mesh_, Elastic{1e5, 0.3, 1e3}, Group<F>{}};
    body.clamp(body.mesh().boundary("left"));
    body.set_gravity({0, 0, -1});
    return body;
  }
  auto global(double safety) const {
    return [this, safety](auto& body, double& seconds) {
      int const steps = static_cast<int>(std::ceil(apart_ / (safety * stable_)));
      CentralDifference step{{.step = apart_ / steps}};
      return sampled(body, step, steps, seconds);
    };
  }
  template <class TheBody, class Step>
  History sampled(TheBody& body, Step& step, int steps, double& seconds) const {
    History history;
    std::size_t const corner = body.mesh().nodes.size() - 1;
    for (int sample = 0; sample < samples_; ++sample) {
      {
        Stopwatch const watch(seconds);
        step(body, steps);
      }
      history.push_back(body.displacements()[corner]);
    }
    if (std::abs(body.time() - samples_ * apart_) > 1e-9 * apart_)
      throw Error("the integrator went back, and did not reach the last sample");
    return history;
  }
  template <class T, class Run>
  History swing(Run const& run, double& seconds) const {
    auto body = made<T>();
    return run(body, seconds);
  }
  template <class T, class Run>
  void add(char const* kind, char const* integrator, double safety, Run const& run) {
    char name[64];
    std::snprintf(name, sizeof name, "%s, safety %g, %s", integrator, safety,
                  std::same_as<T, float> ? "float" : "double");
    contestants_.push_back({kind, [this, run, text = std::string(name)](bool) {
                              Answer answer{.name = text};
                              answer.unknowns = 3 * static_cast<long>(mesh_->nodes.size());
                              answer.elements = static_cast<long>(mesh_->elements<Tet4>().size());
                              try {
                                answer.error = apart(swing<T>(run, answer.seconds), *truth_);
                              } catch (std::exception const& e) {
                                answer.failed = e.what();
                              }
                              return std::vector{answer};
                            }});
  }

 public:
  Cube(Options const& options, int cells) : threads_(options.threads) {
    mesh_ = std::make_shared<Mesh<Tet4> const>(cube_with_a_small_ball(cells));
    samples_ = options.quick ? 4 : cells > 30 ? 3 : cells > 20 ? 6 : 12;
    auto body = made<double>();
    stable_ = stable_step(body);
    double unused = 0;
    truth_ = std::make_shared<History>(swing<double>(global(0.25), unused));
  }

  template <class T>
  void add_global(double safety) {
    add<T>("global steps", "CentralDifference", safety, global(safety));
  }
  template <class T>
  void add_local(double safety) {
    add<T>("local steps", "LocalSteps", safety, [this, safety](auto& body, double& seconds) {
      // The macro step that it chooses itself, made shorter to end with each sample.
      auto scratch = made<T>();
      LocalSteps own{{.safety = safety}};
      own(scratch);
      int const steps = static_cast<int>(std::ceil(apart_ / own.macro_step()));
      LocalSteps step{{.safety = safety, .macro_step = apart_ / steps}};
      return sampled(body, step, steps, seconds);
    });
  }
  std::vector<Contestant> const& contestants() const { return contestants_; }

 private:
  int threads_, samples_;
  std::shared_ptr<Mesh<Tet4> const> mesh_;
  double stable_;
  std::shared_ptr<History const> truth_;
  std::vector<Contestant> contestants_;
};

}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant::bench;
  Options const options(argc, argv);
  for (int cells : options.quick ? std::vector{12} : std::vector{14, 24, 32}) {
    Cube cube(options, cells);
    for (double safety : {0.9, 0.45}) cube.add_global<double>(safety);
    for (double safety : {0.8, 0.4}) cube.add_local<double>(safety);
    cube.add_global<float>(0.9);
    cube.add_local<float>(0.8);
    hold_contest("cube with a small ball, " + std::to_string(6 * cells * cells * cells) + " Tet4",
                 cube.contestants(), options);
  }
}
