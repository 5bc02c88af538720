#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "stability/cases.hpp"
#include "stability/known.hpp"

// Runs cases, each in a process of its own, and appends a line for each to a file: key, outcome, figures, text,
// seconds, between tabs. Cases that are in the file already are not run again.
namespace {
using namespace pliant::stability;

struct Options {
  bool quick = false, list = false;
  std::string results{}, filter{};
  int patience = 120;   // s, for each case
  double budget = 1e9;  // s, for all
};

std::string flat(std::string text) {
  for (char& c : text)
    if (c == '\t' || c == '\n') c = ' ';
  return text;
}

/// In a child, so that a crash or a hang is that of one case.
Verdict run_apart(Case const& one, int patience) {
  int ends[2];
  if (pipe(ends) != 0) return {Outcome::crashes, "", "suite: no pipe"};
  std::fflush(nullptr);
  pid_t const child = fork();
  if (child < 0) return {Outcome::crashes, "", "suite: no process"};
  if (child == 0) {
    close(ends[0]);
    Verdict const verdict = judge(one);
    std::string const line = std::to_string(static_cast<int>(verdict.outcome)) + "\t" +
                             flat(verdict.figures) + "\t" + flat(verdict.text) + "\n";
    std::size_t sent = 0;
    while (sent < line.size()) {
      auto const n = write(ends[1], line.data() + sent, line.size() - sent);
      if (n <= 0) _exit(3);
      sent += static_cast<std::size_t>(n);
    }
    _exit(0);
  }
  close(ends[1]);
  std::string line;
  bool hangs = false;
  auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(patience);
  for (;;) {
    auto const left = std::chrono::duration_cast<std::chrono::milliseconds>(
                          end - std::chrono::steady_clock::now())
                          .count();
    pollfd waiting{ends[0], POLLIN, 0};
    int const ready = left > 0 ? poll(&waiting, 1, static_cast<int>(left)) : 0;
    if (ready < 0) continue;
    if (ready == 0) {
      hangs = true;
      kill(child, SIGKILL);
      break;
    }
    char buffer[4096];
    auto const n = read(ends[0], buffer, sizeof buffer);
    if (n <= 0) break;
    line.append(buffer, static_cast<std::size_t>(n));
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (hangs) return {Outcome::hangs, "", "not done after " + std::to_string(patience) + " s"};
  if (WIFSIGNALED(status))
    return {Outcome::crashes, "", "ended by signal " + std::to_string(WTERMSIG(status))};
  auto const first = line.find('\t'), second = line.find('\t', first + 1);
  if (second == std::string::npos) return {Outcome::crashes, "", "ended without a verdict"};
  return {static_cast<Outcome>(std::stoi(line)), line.substr(first + 1, second - first - 1),
          line.substr(second + 1, line.size() - second - 2)};
}

std::map<std::string, Outcome> finished_in(std::string const& file) {
  std::map<std::string, Outcome> done;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    auto const first = line.find('\t'), second = line.find('\t', first + 1);
    if (second == std::string::npos) continue;  // cut off
    auto const name = line.substr(first + 1, second - first - 1);
    for (auto const outcome :
         {Outcome::works, Outcome::reports, Outcome::wrong, Outcome::hangs, Outcome::crashes})
      if (name == name_of(outcome)) done[line.substr(0, first)] = outcome;
  }
  return done;
}

int run(Options const& options) {
  std::map<std::string, Outcome> outcomes;
  if (!options.results.empty()) outcomes = finished_in(options.results);
  std::FILE* const results =
      options.results.empty() ? nullptr : std::fopen(options.results.c_str(), "a");
  if (!options.results.empty() && !results) {
    std::fprintf(stderr, "stability: cannot write %s\n", options.results.c_str());
    return 2;
  }
  std::regex const filter(options.filter);
  std::map<Outcome, int> counts;
  std::set<std::string> seen;
  int left = 0, fresh = 0, defects = 0, known_ones = 0;
  double spent = 0;
  for (auto const& one : all_cases(options.quick)) {
    std::string const key = one.key();
    if (!options.filter.empty() && !std::regex_search(key, filter)) continue;
    if (!seen.insert(key).second) {
      std::fprintf(stderr, "stability: two cases are called %s\n", key.c_str());
      return 2;
    }
    if (options.list) {
      std::puts(key.c_str());
      continue;
    }
    if (!outcomes.contains(key)) {
      if (spent > options.budget) {
        ++left;
        continue;
      }
      auto const start = std::chrono::steady_clock::now();
      Verdict const verdict = run_apart(one, options.patience);
      double const seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      spent += seconds;
      ++fresh;
      outcomes[key] = verdict.outcome;
      if (results) {
        std::fprintf(results, "%s\t%s\t%s\t%s\t%.2f\n", key.c_str(), name_of(verdict.outcome),
                     verdict.figures.c_str(), verdict.text.c_str(), seconds);
        std::fflush(results);
      }
      if (verdict.outcome >= Outcome::wrong)
        std::printf("%s: %s (%s; %s)%s\n", name_of(verdict.outcome), key.c_str(),
                    verdict.figures.c_str(), verdict.text.c_str(),
                    reason_why_known(key) ? ", known" : "");
      std::fflush(stdout);
    }
    auto const outcome = outcomes[key];
    ++counts[outcome];
    if (outcome >= Outcome::wrong) ++(reason_why_known(key) ? known_ones : defects);
  }
  if (results) std::fclose(results);
  if (options.list) return 0;
  std::printf(
      "%d work, %d report, %d silently wrong, %d hang, %d crash; of these defects %d are known; %d "
      "cases "
      "run now in %.0f s, %d left\n",
      counts[Outcome::works], counts[Outcome::reports], counts[Outcome::wrong],
      counts[Outcome::hangs], counts[Outcome::crashes], known_ones, fresh, spent, left);
  return defects > 0 || left > 0 ? 1 : 0;
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  for (int k = 1; k < count; ++k) {
    std::string const argument = arguments[k];
    if (argument == "--quick")
      options.quick = true;
    else if (argument == "--list")
      options.list = true;
    else if (argument == "--results" && k + 1 < count)
      options.results = arguments[++k];
    else if (argument == "--filter" && k + 1 < count)
      options.filter = arguments[++k];
    else if (argument == "--patience" && k + 1 < count)
      options.patience = std::atoi(arguments[++k]);
    else if (argument == "--budget" && k + 1 < count)
      options.budget = std::atof(arguments[++k]);
    else {
      std::fprintf(stderr, "stability: don't know '%s'; see run --help\n", argument.c_str());
      return 2;
    }
  }
  return run(options);
}
