#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

// Runs that solve one problem in different ways, measured in alternation.
namespace pliant::bench {

/// One answer and what it took: the whole way to it, and where that time went.
struct Answer {
  std::string name;  // of the contestant
  int n = 0;         // cells across, or the round of an adaptive run
  long unknowns = 0, elements = 0, iterations = 0;
  double error = std::numeric_limits<double>::quiet_NaN();     // relative
  double seconds = 0;                                          // all of it, from the mesh on
  double making = 0, solving = 0, deciding = 0, refining = 0;  // shares of `seconds`
  double share = std::numeric_limits<double>::quiet_NaN();  // of evaluations that were costly ones
  std::string failed{};
};

/// What makes one answer, or those of all rounds of an adaptive run. Errors are wanted in the first run
/// only; they cost no time of the contestant's.
struct Contestant {
  char const* kind;  // uniform, adaptive, ...
  std::function<std::vector<Answer>(bool with_errors)> run;
};

/// Adds the time that it lives to a sum.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum), started_(now()) {}
  Stopwatch(Stopwatch const&) = delete;
  ~Stopwatch() { sum_ += now() - started_; }

  /// The processor's time, in which other programs on the machine have no part; else that of the clock on the wall. Set before
  /// measurements.
  inline static bool of_the_processor = false;

 private:
  static double now() {
    timespec time;
    clock_gettime(of_the_processor ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double& sum_;
  double started_;
};

/// Options of all programs: --quick, --threads N; --reference where answers were found beforehand: how.
struct Options {
  bool quick = false, reference = false;
  int threads = 1, rounds = 5;

  Options(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
      std::string_view const option = argv[i];
      if (option == "--quick") quick = true;
      if (option == "--reference") reference = true;
      if (option == "--threads" && i + 1 < argc) threads = std::atoi(argv[++i]);
    }
    if (quick) rounds = 3;
#if !defined(__CUDACC__)
    Stopwatch::of_the_processor = threads == 1;
#endif
  }
};

inline std::string quoted(std::string const& text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + '"';
}
inline std::string number(double x) {
  if (!std::isfinite(x)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

/// The value below which a share of the values lie.
inline double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  double const at = share * static_cast<double>(values.size() - 1);
  auto const low = static_cast<std::size_t>(at);
  std::size_t const high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

/// Runs all contestants once in each round, in turns forwards and backwards, and prints a line of JSON for
/// each answer: medians and quartiles of its times.
inline void hold_contest(std::string const& problem, std::vector<Contestant> const& contestants,
                         Options const& options) {
  std::vector<std::vector<std::vector<Answer>>> answers(contestants.size());  // (contestant, round)
  for (int round = 0; round < options.rounds; ++round)
    for (std::size_t k = 0; k < contestants.size(); ++k) {
      std::size_t const c = round % 2 == 0 ? k : contestants.size() - 1 - k;
      answers[c].push_back(contestants[c].run(round == 0));
    }
  for (std::size_t c = 0; c < contestants.size(); ++c)
    for (std::size_t k = 0; k < answers[c][0].size(); ++k) {
      Answer const& first = answers[c][0][k];
      auto const median = [&](double Answer::*time, double share = 0.5) {
        std::vector<double> values;
        for (auto const& round : answers[c])
          if (k < round.size()) values.push_back(round[k].*time);
        return number(quantile(values, share));
      };
      std::printf(
          "{\"problem\": %s, \"contestant\": %s, \"kind\": %s, \"n\": %d, \"unknowns\": %ld, "
          "\"elements\": %ld, \"iterations\": %ld, \"error\": %s, \"seconds\": %s, "
          "\"lower_quartile\": %s, "
          "\"upper_quartile\": %s, \"making\": %s, \"solving\": %s, \"deciding\": %s, "
          "\"refining\": %s, \"share\": %s, \"rounds\": %zu, \"failed\": %s}\n",
          quoted(problem).c_str(), quoted(first.name).c_str(), quoted(contestants[c].kind).c_str(),
          first.n, first.unknowns, first.elements, first.iterations, number(first.error).c_str(),
          median(&Answer::seconds).c_str(), median(&Answer::seconds, 0.25).c_str(),
          median(&Answer::seconds, 0.75).c_str(), median(&Answer::making).c_str(),
          median(&Answer::solving).c_str(), median(&Answer::deciding).c_str(),
          median(&Answer::refining).c_str(), number(first.share).c_str(), answers[c].size(),
          first.failed.empty() ? "null" : quoted(first.failed).c_str());
    }
  std::fflush(stdout);
}

}  // namespace pliant::bench
