// SPDX-License-Identifier: GPL-3.0-or-later
// The strategies of a script on many problems, in groups: those whose names begin alike, "cage/0001" and "cage/0003".
//
//   bench_arms SCRIPT.lua [--hard]
//
// Prints for each strategy a line for each group: problems solved, median and 95th percentile of the CPU time of
// planning and of the path's certificate, of validity checks over all levels and of the length; and of the checks and
// the CPU time the median of the ratios to those of the first strategy on the same problem and seed. --hard: only
// problems on which the first strategy needs more checks than on half of them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/strategy/executor.hpp>

#include "se3_bench.hpp"

namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

struct Sample {
  bool solved = false;
  double us = 0.0;
  double certificate_us = 0.0;
  double checks = 0.0;
  double length = 0.0;
};

void print_header() {
  std::printf("  %-24s %9s %9s %9s %9s %9s %9s %8s %7s %7s\n", "group", "solved", "us median", "us 95 %", "cert us",
              "checks", "checks95", "length", "checks:", "us:");
}

void print(const std::string& name, const std::vector<Sample>& samples, const std::vector<Sample>& baseline) {
  std::size_t solved = 0;
  std::vector<double> us, certificate, checks, lengths, checks_ratio, us_ratio;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample& s = samples[i];
    const Sample& b = baseline[i];
    if (s.solved || b.solved) {
      constexpr double infinity = std::numeric_limits<double>::infinity();
      checks_ratio.push_back(!s.solved ? infinity : !b.solved ? 0.0 : s.checks / b.checks);
      us_ratio.push_back(!s.solved ? infinity : !b.solved ? 0.0 : s.us / b.us);
    }
    if (!s.solved) continue;
    ++solved;
    us.push_back(s.us);
    certificate.push_back(s.certificate_us);
    checks.push_back(s.checks);
    lengths.push_back(s.length);
  }
  std::printf("  %-24s %4zu/%4zu %9.0f %9.0f %9.0f %9.0f %9.0f %8.2f %7.2f %7.2f\n", name.c_str(), solved,
              samples.size(), quantile(us, 0.5), quantile(us, 0.95), quantile(certificate, 0.5), quantile(checks, 0.5),
              quantile(checks, 0.95), quantile(lengths, 0.5), quantile(checks_ratio, 0.5), quantile(us_ratio, 0.5));
}

}  // namespace

int main(int count, char** arguments) {
  using namespace trellis;
  try {
    const std::vector<std::string> given(arguments + 1, arguments + count);
    if (given.empty()) throw std::invalid_argument("needs SCRIPT.lua");
    const bool hard = given.size() > 1 && given[1] == "--hard";
    const dsl::Program program = dsl::load_script(given[0]);
    const Experiment& experiment = program.experiment;
    std::vector<std::string> groups;
    std::vector<std::vector<Sample>> all(experiment.strategies.size());
    for (const Problem& problem : experiment.problems) {
      for (const std::uint64_t seed : experiment.seeds) {
        groups.push_back(problem.name.substr(0, problem.name.find('/')));
        for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
          const double before = bench::cpu_seconds();
          const RunRecord run = execute(experiment.strategies[s].second, problem, seed);
          const double after = bench::cpu_seconds();
          all[s].push_back({run.solved, 1e6 * (after - before), 1e6 * run.path_seconds,
                            static_cast<double>(run.validity_checks), run.length});
          if (!run.solved) {
            std::fprintf(stderr, "not solved: %s by %s\n", problem.name.c_str(),
                         experiment.strategies[s].first.c_str());
          }
        }
      }
    }
    std::vector<double> first;
    for (const Sample& sample : all[0]) first.push_back(sample.solved ? sample.checks : 1e300);
    const double least = hard ? quantile(first, 0.5) : -1.0;
    for (std::size_t s = 0; s < all.size(); ++s) {
      std::printf("%s: %s\n", experiment.strategies[s].first.c_str(), experiment.strategies[s].second.text().c_str());
      print_header();
      std::map<std::string, std::pair<std::vector<Sample>, std::vector<Sample>>> tables;
      std::pair<std::vector<Sample>, std::vector<Sample>> whole;
      for (std::size_t i = 0; i < groups.size(); ++i) {
        if (first[i] <= least) continue;
        for (auto* table : {&tables[groups[i]], &whole}) {
          table->first.push_back(all[s][i]);
          table->second.push_back(all[0][i]);
        }
      }
      for (const auto& [name, table] : tables) print(name, table.first, table.second);
      print("all", whole.first, whole.second);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_arms: %s\n", error.what());
    return 1;
  }
}
