#pragma once

#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "verification/support/form.hpp"
#include "verification/support/printed.hpp"

namespace pliant::verification {

/// What came out on one mesh of a sequence.
struct Run {
  int n;                       // size of the mesh, however it is counted
  std::vector<double> values;  // NaN where there was no solution
};
using Runs = std::vector<Run>;

/// solve(n) -> std::vector<double> on each mesh. What it throws makes the values NaN and goes to stderr.
template <class Solve>
Runs on_meshes(std::vector<int> const& sizes, std::size_t values, Solve const& solve) {
  Runs runs;
  for (int n : sizes) {
    runs.push_back({n, std::vector<double>(values, std::numeric_limits<double>::quiet_NaN())});
    try {
      auto const found = solve(n);
      std::copy_n(found.begin(), values, runs.back().values.begin());
    } catch (std::exception const& e) {
      std::fprintf(stderr, "n = %d: %s\n", n, e.what());
    }
  }
  return runs;
}

/// Which problem with what; `meshes` says what n counts.
struct Labels {
  std::string problem, composition, meshes;
};

/// Rows of one group of problems: prints them as Markdown, and keeps what a plot needs.
/// Options of the program: --quick (without the dear problems and finest meshes), --csv FILE (errors by mesh
/// size are added).
class Table {
 public:
  Table(std::string title, int argc, char** argv) : title_(std::move(title)) {
    for (int i = 1; i < argc; ++i) {
      if (std::string_view(argv[i]) == "--quick") full_ = false;
      if (std::string_view(argv[i]) == "--csv" && i + 1 < argc) csv_.open(argv[++i], std::ios::app);
    }
    std::printf(
        "\n### %s\n\n"
        "| problem | composition | meshes | value | reference | error | allowed | order | |\n"
        "|---|---|---|---|---|---|---|---|---|\n",
        title_.c_str());
  }

  bool full() const { return full_; }

  /// The value on the finest mesh against a reference; the order at which the error fell on the last
  /// two, where it is more than the reference's digits can hide.
  void compare(Labels const& labels, Runs const& runs, std::size_t component,
               Printed const& reference) {
    double const value = runs.back().values[component], error = value - reference.value;
    std::optional<double> order;
    std::vector<double> errors;
    for (auto const& run : runs)
      errors.push_back(std::abs(run.values[component] - reference.value));
    if (errors.size() > 1 && errors.back() > reference.tolerance / 2)
      order = order_of(runs, errors);
    plot(labels, runs, errors);
    print(labels, runs, number(value), reference.text, error, number(reference.tolerance, "%.0e"),
          order, std::abs(error) <= reference.tolerance);
  }
  void compare(Labels const& labels, double value, Printed const& reference) {
    compare(labels, {{0, {value}}}, 0, reference);
  }

  /// A value whose distance from a reference has to fall with at least an order (less a fifteenth) on the
  /// last two meshes, where digits would ask for finer ones.
  void approach(Labels const& labels, Runs const& runs, std::size_t component,
                Printed const& reference, double expected) {
    std::vector<double> errors;
    for (auto const& run : runs)
      errors.push_back(std::abs(run.values[component] - reference.value));
    double const order = order_of(runs, errors);
    plot(labels, runs, errors);
    print(labels, runs, number(runs.back().values[component]), reference.text,
          runs.back().values[component] - reference.value, "order " + number(expected), order,
          order >= expected - expected / 15);
  }
  /// The same of an error.
  void converge(Labels const& labels, Runs const& runs, std::size_t component, double expected) {
    approach(labels, runs, component, {0, 0, "0"}, expected);
  }

  /// 0 when no row was missed.
  int finish() const {
    if (missed_ > 0) std::printf("\n%d of %d rows missed.\n", missed_, rows_);
    return missed_ > 0 || rows_ == 0 ? 1 : 0;
  }

 private:
  static double order_of(Runs const& runs, std::vector<double> const& errors) {
    std::size_t const last = runs.size() - 1;
    return std::log(errors[last - 1] / errors[last]) /
           std::log(static_cast<double>(runs[last].n) / runs[last - 1].n);
  }
  void plot(Labels const& labels, Runs const& runs, std::vector<double> const& errors) {
    if (!csv_.is_open() || runs.size() < 2) return;
    for (std::size_t i = 0; i < runs.size(); ++i)
      csv_ << '"' << title_ << "\",\"" << labels.problem << (labels.meshes.empty() ? "" : ", ")
           << labels.meshes << "\",\"" << labels.composition << "\"," << runs[i].n << ','
           << errors[i] << '\n';
  }
  void print(Labels const& labels, Runs const& runs, std::string const& value,
             std::string const& reference, double error, std::string const& allowed,
             std::optional<double> order, bool met) {
    std::string meshes = labels.meshes;
    if (runs.size() > 1 || runs[0].n > 0) {
      meshes += meshes.empty() ? "n = " : ", n = ";
      for (std::size_t i = 0; i < runs.size(); ++i)
        meshes += (i ? ", " : "") + std::to_string(runs[i].n);
    }
    std::printf("| %s | %s | %s | %s | %s | %s | %s | %s | %s |\n", labels.problem.c_str(),
                labels.composition.c_str(), meshes.c_str(), value.c_str(), reference.c_str(),
                number(error, "%.1e").c_str(), allowed.c_str(),
                order ? number(*order, "%.2f").c_str() : "", met ? "met" : "**missed**");
    std::fflush(stdout);
    ++rows_;
    missed_ += met ? 0 : 1;
  }

  std::string title_;
  bool full_ = has_full_form;
  std::ofstream csv_;
  int rows_ = 0, missed_ = 0;
};

}  // namespace pliant::verification
