#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
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
  int patience = 120;   // s, for each case; see Case::patience
  int jobs = 1;         // side by side
  double budget = 1e9;  // s, for all
};

std::string flat(std::string text) {
  for (char& c : text)
    if (c == '\t' || c == '\n') c = ' ';
  return text;
}

using Clock = std::chrono::steady_clock;

/// A case in a process of its own, so that a crash or a hang is that of one case.
class Apart {
 public:
  explicit Apart(Case const& one) : one_(&one), start_(Clock::now()) {
    int ends[2];
    std::fflush(nullptr);
    if (pipe(ends) != 0) return;
    child_ = fork();
    if (child_ == 0) {
      close(ends[0]);
      tell(ends[1], judge(one));
      _exit(0);
    }
    close(ends[1]);
    pipe_ = ends[0];
  }
  Case const& one() const { return *one_; }
  int pipe_end() const { return pipe_; }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// Whether there is more to come.
  bool listen() {
    char buffer[4096];
    auto const n = read(pipe_, buffer, sizeof buffer);
    if (n > 0) line_.append(buffer, static_cast<std::size_t>(n));
    return n > 0;
  }
  Verdict end(bool hangs) {
    if (child_ < 0) return {Outcome::crashes, "", "suite: no process"};
    if (hangs) kill(child_, SIGKILL);
    close(pipe_);
    int status = 0;
    waitpid(child_, &status, 0);
    if (hangs)
      return {Outcome::hangs, "", "not done after " + std::to_string(int(seconds())) + " s"};
    if (WIFSIGNALED(status))
      return {Outcome::crashes, "", "ended by signal " + std::to_string(WTERMSIG(status))};
    auto const first = line_.find('\t'), second = line_.find('\t', first + 1);
    if (second == std::string::npos) return {Outcome::crashes, "", "ended without a verdict"};
    return {static_cast<Outcome>(std::stoi(line_)), line_.substr(first + 1, second - first - 1),
            line_.substr(second + 1, line_.size() - second - 2)};
  }

 private:
  static void tell(int to, Verdict const& verdict) {
    std::string const line = std::to_string(static_cast<int>(verdict.outcome)) + "\t" +
                             flat(verdict.figures) + "\t" + flat(verdict.text) + "\n";
    for (std::size_t sent = 0; sent < line.size();) {
      auto const n = write(to, line.data() + sent, line.size() - sent);
      if (n <= 0) _exit(3);
      sent += static_cast<std::size_t>(n);
    }
  }

  Case const* one_;
  Clock::time_point start_;
  pid_t child_ = -1;
  int pipe_ = -1;
  std::string line_;
};

/// Runs cases side by side, and calls finished(case, verdict, seconds) after each, until they are done or so many
/// seconds have gone. Returns how many were not begun.
template <class Finished>
int run_all(std::vector<Case const*> const& cases, Options const& options,
            Finished const& finished) {
  auto const begun = Clock::now();
  std::vector<Apart> running;
  auto next = cases.begin();
  for (;;) {
    double const gone = std::chrono::duration<double>(Clock::now() - begun).count();
    while (next != cases.end() && gone < options.budget && std::ssize(running) < options.jobs)
      running.emplace_back(**next++);
    if (running.empty()) return static_cast<int>(cases.end() - next);
    std::vector<pollfd> waiting;
    for (auto const& apart : running) waiting.push_back({apart.pipe_end(), POLLIN, 0});
    poll(waiting.data(), waiting.size(), 500);
    for (std::size_t k = running.size(); k-- > 0;) {
      bool const hangs = running[k].seconds() > options.patience * running[k].one().patience();
      if (running[k].pipe_end() >= 0 && !hangs && (waiting[k].revents == 0 || running[k].listen()))
        continue;
      auto const verdict = running[k].end(hangs);
      finished(running[k].one(), verdict, running[k].seconds());
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }
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
  auto const cases = all_cases(options.quick);
  std::vector<Case const*> chosen, due;
  std::set<std::string> seen;
  for (auto const& one : cases) {
    std::string const key = one.key();
    if (!options.filter.empty() && !std::regex_search(key, filter)) continue;
    if (!seen.insert(key).second) {
      std::fprintf(stderr, "stability: two cases are called %s\n", key.c_str());
      return 2;
    }
    if (options.list) std::puts(key.c_str());
    chosen.push_back(&one);
    if (!outcomes.contains(key)) due.push_back(&one);
  }
  if (options.list) return 0;
  if (chosen.empty()) {
    std::fprintf(stderr, "stability: no case is called like that\n");
    return 2;
  }
  auto const start = Clock::now();
  int const left =
      run_all(due, options, [&](Case const& one, Verdict const& verdict, double seconds) {
        std::string const key = one.key();
        outcomes[key] = verdict.outcome;
        if (results) {
          std::fprintf(results, "%s\t%s\t%s\t%s\t%.2f\n", key.c_str(), name_of(verdict.outcome),
                       verdict.figures.c_str(), verdict.text.c_str(), seconds);
          std::fflush(results);
        }
        if (verdict.outcome < Outcome::wrong) return;
        char const* const known = reason_why_known(key);
        std::printf("%s: %s (%s; %s)%s%s\n", name_of(verdict.outcome), key.c_str(),
                    verdict.figures.c_str(), verdict.text.c_str(), known ? "; known: " : "",
                    known ? known : "");
        std::fflush(stdout);
      });
  if (results) std::fclose(results);
  std::map<Outcome, int> counts;
  int defects = 0, known_ones = 0;
  for (auto const* one : chosen) {
    auto const found = outcomes.find(one->key());
    if (found == outcomes.end()) continue;
    ++counts[found->second];
    if (found->second >= Outcome::wrong) ++(reason_why_known(one->key()) ? known_ones : defects);
  }
  std::printf(
      "%d work, %d report, %d silently wrong, %d hang, %d crash; of these defects %d are known; %d "
      "cases run now in %.0f s, %d left\n",
      counts[Outcome::works], counts[Outcome::reports], counts[Outcome::wrong],
      counts[Outcome::hangs], counts[Outcome::crashes], known_ones,
      static_cast<int>(due.size()) - left,
      std::chrono::duration<double>(Clock::now() - start).count(), left);
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
    else if (argument == "--jobs" && k + 1 < count)
      options.jobs = std::max(1, std::atoi(arguments[++k]));
    else if (argument == "--budget" && k + 1 < count)
      options.budget = std::atof(arguments[++k]);
    else {
      std::fprintf(stderr, "stability: don't know '%s'; see run --help\n", argument.c_str());
      return 2;
    }
  }
  return run(options);
}
