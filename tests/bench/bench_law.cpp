// SPDX-License-Identifier: GPL-3.0-or-later
// Measures whether work is CPU time, and whether bounded loss holds in CPU time, over five classes of problems:
//
//   bench_law [N] [CLASS...]
//
// Without N: each guide of the catalogue alone, options at their limits too. With N: so many random hierarchies of
// depth 4 at most in each class. Each run is in a process of its own, in which nothing of its world is set up,
// with queries = 1.
// Prints CSV on stdout, a summary on stderr.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/strategy/executor.hpp>

#include "support/bounded_loss.hpp"
#include "support/folder.hpp"
#include "support/kinds.hpp"
#include "support/random_specs.hpp"
#include "support/renewed.hpp"

namespace {

using namespace trellis;

struct Class {
  const char* name;
  const char* program;
  const char* more;  ///< problems beside those of the tests
};

const std::array<Class, 5> classes = {{
    {"plane", test::planar_kinds,
     "{ worlds.maze { cells = 6, seed = 1, name = 'maze_6' }, worlds.boxes { name = 'boxes_120' } }"},
    {"space", test::spatial_kinds,
     "{ worlds.windows { walls = 1, name = 'windows_1' }, worlds.floating_boxes { name = 'floating_boxes_60' } }"},
    {"arms", test::arms_kinds, "{}"},
    {"teams", test::teams_kinds, "{}"},
    {"kinodynamic", test::driven_kinds, "{}"},
}};

/// Runs of less CPU time are left out of the summary.
constexpr double least_cpu = 1e-3;
/// Each run is repeated so often; the least CPU time counts, as other processes disturb it.
constexpr int repeats = 2;

struct Spent {
  double cpu = 0.0;  ///< seconds of the process during the run, set-up included, without certificates of paths
  double work = 0.0;
  double checks = 0.0;

  [[nodiscard]] double cpu_per_unit() const { return cpu / work; }
};

struct Row {
  std::string of_class, problem, strategy, guide;
  std::uint64_t seed = 0;
  Spent guided, alone;
};

double process_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Calls a function in a process of its own. Returns what it returns; none where it throws, or is ended.
template <class Result, class Body>
std::optional<Result> in_process(const Body& body) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return {};
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    constexpr rlim_t most_seconds = 60;
    const rlimit limit{most_seconds, most_seconds};
    setrlimit(RLIMIT_CPU, &limit);
    try {
      const Result result = body();
      if (write(ends[1], &result, sizeof result) < 0) _exit(1);
    } catch (const std::exception&) {
      // A guide cannot make its space from that of another one.
    }
    _exit(0);
  }
  close(ends[1]);
  Result result;
  const bool whole = child > 0 && read(ends[0], &result, sizeof result) == static_cast<ssize_t>(sizeof result);
  close(ends[0]);
  int status = 0;
  if (child > 0) waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) fmt::print(stderr, "ended by signal {}: ", WTERMSIG(status));
  return whole ? std::optional(result) : std::nullopt;
}

std::optional<Spent> spent(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed) {
  std::optional<Spent> least;
  for (int i = 0; i < repeats; ++i) {
    const auto once = in_process<Spent>([&] {
      // The program's first run takes up to a millisecond more: in another world, so that nothing is set up in this
      // one.
      static_cast<void>(execute(strategy, test::renewed(problem), seed + 1));
      const double begin = process_seconds();
      const RunRecord run = execute(strategy, problem, seed);
      return Spent{process_seconds() - begin - run.path_seconds, run.work, static_cast<double>(run.validity_checks)};
    });
    if (!once) return {};
    if (!least || once->cpu < least->cpu) least = once;
  }
  return least;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Within which factor of each other two numbers are.
double factor(double a, double b) { return std::max(a / b, b / a); }

double loss(const Row& row) { return row.guided.cpu / row.alone.cpu; }

template <class Holds>
double percent(const std::vector<double>& values, const Holds& holds) {
  return values.empty() ? 0.0
                        : 100.0 * static_cast<double>(std::count_if(values.begin(), values.end(), holds)) /
                              static_cast<double>(values.size());
}

double greatest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

/// The runs of a group: their CPU time per unit of work beside the median of all, and beside the planner alone.
void summarise(const std::string& name, const std::vector<const Row*>& rows, double middle) {
  std::vector<double> per_unit, factors, losses;
  for (const Row* row : rows) {
    if (row->guided.cpu >= least_cpu) {
      per_unit.push_back(row->guided.cpu_per_unit());
      factors.push_back(factor(row->guided.cpu_per_unit(), middle));
    }
    if (row->alone.cpu >= least_cpu) losses.push_back(loss(*row));
  }
  fmt::print(stderr, "{:<18} {:>5} {:>5} {:>8.1f} {:>6.1f} {:>6.1f} {:>7.1f} {:>6} {:>7.1f} {:>7.2f}\n", name,
             rows.size(), per_unit.size(), 1e9 * median(per_unit), percent(factors, [](double x) { return x <= 3.0; }),
             percent(factors, [](double x) { return x <= 10.0; }), greatest(factors), losses.size(),
             percent(losses, [](double x) { return x > 2.5; }), greatest(losses));
}

/// Prints the rows with the largest values.
template <class Value>
void print_worst(const char* heading, std::vector<const Row*> rows, const Value& value) {
  constexpr std::size_t most = 15;
  std::stable_sort(rows.begin(), rows.end(), [&](const Row* a, const Row* b) { return value(*a) > value(*b); });
  rows.resize(std::min(rows.size(), most));
  fmt::print(stderr, "\n{}\n", heading);
  for (const Row* row : rows) {
    fmt::print(stderr, "{:>8.2f}  {:>8.2f} ms of {:>8.2f}, {:>8.0f} units of {:>8.0f}: {} on {}, seed {}\n",
               value(*row), 1e3 * row->guided.cpu, 1e3 * row->alone.cpu, row->guided.work, row->alone.work,
               row->strategy, row->problem, row->seed);
  }
}

void summarise(const std::vector<Row>& rows) {
  std::vector<const Row*> all, long_runs, long_alone;
  std::map<std::string, std::vector<const Row*>> by_class, by_guide;
  std::vector<double> per_unit;
  for (const Row& row : rows) {
    all.push_back(&row);
    by_class[row.of_class].push_back(&row);
    by_guide[row.guide].push_back(&row);
    if (row.guided.cpu >= least_cpu) {
      per_unit.push_back(row.guided.cpu_per_unit());
      long_runs.push_back(&row);
    }
    if (row.alone.cpu >= least_cpu) long_alone.push_back(&row);
  }
  const double middle = median(per_unit);
  fmt::print(stderr,
             "\n                         1 ms   median  within (%)        factor  alone  loss in CPU time\n"
             "                    runs more  ns/unit      3     10   worst   1 ms >2.5 (%)     most\n");
  summarise("all", all, middle);
  for (const auto* groups : {&by_class, &by_guide}) {
    fmt::print(stderr, "\n");
    for (const auto& [name, group] : *groups) summarise(name, group, middle);
  }
  print_worst("CPU time per unit, as a factor of the median", long_runs,
              [&](const Row& row) { return factor(row.guided.cpu_per_unit(), middle); });
  print_worst("CPU time beside the planner alone", long_alone, loss);
}

/// A text as a field of CSV.
std::string csv_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

class Law {
 public:
  explicit Law(const Class& of) : name_(of.name), kinds_(test::load_kinds(std::string(of.program), folder_, of.more)) {
    // In a process of its own, so that nothing is set up in this one.
    in_process<int>([&] {
      test::store_paths(kinds_, test::paths_of(folder_));
      return 0;
    });
  }

  /// Each guide before the first two planners, on each problem.
  void each_guide(std::vector<Row>& rows) {
    for (const GuideSpec& guide : kinds_.guides) {
      for (std::size_t root = 0; root < std::min<std::size_t>(2, kinds_.roots.size()); ++root) {
        for (const Problem& problem : kinds_.problems) add(guide >> kinds_.roots[root], problem, 1, rows);
      }
    }
  }

  void random(std::uint64_t count, std::vector<Row>& rows) {
    constexpr int depth = 4;
    test::RandomSpecs specs(stable_hash(name_), 2.0, kinds_.guides, kinds_.roots);
    const std::size_t end = rows.size() + count;
    for (std::uint64_t drawn = 0; rows.size() < end && drawn < 20 * count; ++drawn) {
      add(specs.strategy(depth), kinds_.problems[drawn % kinds_.problems.size()], drawn, rows);
    }
  }

 private:
  void add(const StrategySpec& drawn, const Problem& problem, std::uint64_t seed, std::vector<Row>& rows) {
    const StrategySpec strategy = drawn.with("queries", 1.0).with("proposals", 5000.0);
    const auto guided = spent(strategy, problem, seed);
    const auto alone =
        alone_.try_emplace(test::undivided(strategy.planner()).text() + problem.name + std::to_string(seed));
    if (alone.second) alone.first->second = spent(test::undivided(strategy.planner()), problem, seed);
    if (!guided || !alone.first->second) {
      fmt::print(stderr, "refused: {} on {}\n", strategy.text(), problem.name);
      return;
    }
    const Spent& other = *alone.first->second;
    std::string text = strategy.text();
    const std::string folder = folder_.file("");
    for (auto at = text.find(folder); at != std::string::npos; at = text.find(folder)) text.erase(at, folder.size());
    rows.push_back({name_, problem.name, text, strategy.guide()->name(), seed, *guided, other});
    fmt::print("{},{},{},{},{:.6f},{:.0f},{:.0f},{:.6f},{:.0f},{:.0f}\n", name_, problem.name, csv_text(text), seed,
               guided->cpu, guided->checks, guided->work, other.cpu, other.work, other.checks);
  }

  test::Folder folder_;
  std::string name_;
  test::Kinds kinds_;
  std::map<std::string, std::optional<Spent>> alone_;
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  std::uint64_t count = 0;
  if (!arguments.empty() && std::isdigit(static_cast<unsigned char>(arguments.front().front())) != 0) {
    count = std::strtoull(arguments.front().c_str(), nullptr, 10);
    arguments.erase(arguments.begin());
  }
  fmt::print("class,problem,strategy,seed,cpu,checks,work,cpu_alone,work_alone,checks_alone\n");
  std::vector<Row> rows;
  for (const Class& of : classes) {
    if (!arguments.empty() && std::ranges::find(arguments, of.name) == arguments.end()) continue;
    Law law(of);
    if (count > 0) {
      law.random(count, rows);
    } else {
      law.each_guide(rows);
    }
  }
  summarise(rows);
}
