// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the estimators' errors for known divergences, and prints the results: a section of Markdown.
// scripts/verify-measure puts the section into docs/measure.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <thread>

#include <trellis/base/parallel.hpp>
#include <trellis/experiment/experiment.hpp>

#include "support/worlds.hpp"
#include "verify/measure_cases.hpp"
#include "verify/supported_cases.hpp"

namespace {

using namespace trellis;
using verify::Case;

const std::vector<std::size_t> numbers = {300, 1000, 3000};
unsigned jobs() { return std::max(1U, std::thread::hardware_concurrency()); }

struct Errors {
  double bias = 0.0;
  double spread = 0.0;
  double rmse = 0.0;
  std::size_t infinite = 0;
  std::map<std::string, std::size_t> flags;
};

Errors errors_of(const std::vector<double>& values, double truth) {
  Errors e;
  double sum = 0.0;
  double squares = 0.0;
  double n = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) {
      ++e.infinite;
      continue;
    }
    sum += v - truth;
    squares += (v - truth) * (v - truth);
    n += 1.0;
  }
  e.bias = sum / n;
  e.spread = std::sqrt(std::max(0.0, squares / n - e.bias * e.bias));
  e.rmse = std::sqrt(squares / n);
  return e;
}

struct Measured {
  Errors regularised;
  Errors plain;
  std::vector<double> values;
};

/// A case's target with several sets of evaluation points, as every run has its own.
const std::vector<std::shared_ptr<const Target>>& targets_of(const Case& c) {
  static std::map<std::string, std::vector<std::shared_ptr<const Target>>> made;
  auto& targets = made[c.name];
  for (std::uint64_t seed = targets.size(); seed < 25; ++seed) targets.push_back(c.remake(100 + seed));
  return targets;
}

Measured measure(const Case& c, std::size_t n, std::size_t repetitions, const EstimatorSpec& estimator,
                 std::uint64_t first = 0) {
  std::vector<Efficiency> found(repetitions);
  const auto& targets = targets_of(c);
  in_parallel(repetitions, jobs(), [&](std::size_t r) {
    found[r] = efficiency(*targets[r % targets.size()], c.samples(n, first + r),
                          {.support = SampleSupport::anything,
                           .estimators = {estimator},
                           .points = c.target->space().flat() ? std::size_t{0} : std::size_t{1024}});
  });
  Measured m;
  std::vector<double> plain;
  for (const Efficiency& e : found) {
    m.values.push_back(e.value);
    plain.push_back(e.unregularised);
  }
  m.regularised = errors_of(m.values, c.d_regularised);
  m.plain = errors_of(plain, c.d);
  for (const Efficiency& e : found) {
    for (const auto& flag : e.flags) ++m.regularised.flags[flag];
  }
  return m;
}

std::string signed_text(double x) { return fmt::format("{:+.3f}", x); }
std::string truth_text(double x) { return std::isinf(x) ? "inf" : fmt::format("{:.3f}", x); }

struct Report {
  std::string text;
  std::string requirements;
  std::size_t repetitions = 200;
  bool passed = true;

  void require(bool holds, const std::string& what) {
    requirements += fmt::format("| {} | {} |\n", what, holds ? "yes" : "**no**");
    passed = passed && holds;
  }
};

/// A text in a table of Markdown.
std::string cell(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

void error_tables(Report& report, const std::vector<Case>& cases) {
  const EstimatorSpec knn = EstimatorSpec::make("knn");
  report.text += fmt::format(
      "### Bias and spread\n\nThe error of SE by the default estimator over {} repetitions: mean ± standard "
      "deviation, in nats. `D inf` counts the repetitions where D was given as infinite.\n\n"
      "| case | D | SE | N = 300 | N = 1000 | N = 3000 | D inf at 1000 | flags at 1000 |\n"
      "|---|---|---|---|---|---|---|---|\n",
      report.repetitions);
  for (const Case& c : cases) {
    std::string row =
        fmt::format("| {}: {} | {} | {} |", c.name, cell(c.what), truth_text(c.d), truth_text(c.d_regularised));
    std::string infinite;
    std::string flags;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const Measured m = measure(c, numbers[k], report.repetitions, knn);
      row += fmt::format(" {} ± {:.3f} |", signed_text(m.regularised.bias), m.regularised.spread);
      if (numbers[k] != 1000) continue;
      infinite = fmt::format("{}", m.plain.infinite);
      for (const auto& [flag, times] : m.regularised.flags)
        flags += fmt::format("{}{} {}", flags.empty() ? "" : ", ", flag, times);
      if (std::isinf(c.d) && c.mendable) {
        report.require(m.plain.infinite == report.repetitions, c.name + ": D is inf in every repetition");
        report.require(std::all_of(m.values.begin(), m.values.end(),
                                   [&](double v) { return v <= c.d_regularised + 0.01 && v > c.d_regularised - 0.15; }),
                       fmt::format("{}: SE at its bound log(1/eps) + uniform = {:.3f}, but for the half sample that "
                                   "N samples without a hit leave possible ({:+.3f} at N = 1000)",
                                   c.name, c.d_regularised, m.regularised.bias));
      }
    }
    report.text += fmt::format("{} {} | {} |\n", row, infinite, flags.empty() ? "-" : flags);
  }
  report.text += '\n';
}

void estimator_table(Report& report, const std::vector<Case>& cases) {
  report.text +=
      "### The four standard cases, by estimator\n\nRMSE of SE over the four standard cases (uniform, elsewhere, "
      "tree-like, T itself).\n\n| estimator | R^2, 300 | R^2, 1000 | R^2, 3000 | SE(2), 300 | SE(2), 1000 | SE(2), "
      "3000 "
      "| repetitions |\n|---|---|---|---|---|---|---|---|\n";
  struct Row {
    std::string name;
    std::vector<Options::Entry> options;
    std::size_t repetitions;
  };
  const std::vector<Row> rows = {
      {"knn", {}, report.repetitions},
      {"knn", {{"k_all", std::int64_t{3}}}, report.repetitions},
      {"knn", {{"k", std::int64_t{3}}, {"k_all", std::int64_t{3}}, {"blend", false}}, report.repetitions},
  };
  for (const Row& row : rows) {
    const EstimatorSpec spec = EstimatorSpec::make(row.name, row.options);
    std::string line = fmt::format("| `{}` |", spec.text());
    for (const char* space : {"R^2", "SE(2)"}) {
      for (const std::size_t n : numbers) {
        double squares = 0.0;
        for (const Case& c : cases) {
          if (!c.standard || c.name.find(space) == std::string::npos) continue;
          const double rmse = measure(c, n, row.repetitions, spec).regularised.rmse;
          squares += 0.25 * rmse * rmse;
        }
        const double rmse = std::sqrt(squares);
        line += fmt::format(" {:.3f} |", rmse);
        if (row.name == "knn" && row.options.empty() && n == 1000) {
          const double limit = std::string_view(space) == "R^2" ? 0.08 : 0.12;
          report.require(rmse <= limit,
                         fmt::format("RMSE over the four standard cases in {}, N = 1000: {:.3f}, at most "
                                     "{:.2f}",
                                     space, rmse, limit));
        }
      }
    }
    report.text += fmt::format("{} {} |\n", line, row.repetitions);
  }
  report.text += '\n';
}

/// The coverage of Student's interval over the runs of an experiment.
constexpr std::size_t runs_each = 15;

void interval_table(Report& report, const std::vector<Case>& cases) {
  const std::size_t experiments = report.repetitions;
  report.text += fmt::format(
      "### Where the interval is too narrow\n\nThe interval is about the spread between runs. It cannot "
      "see "
      "an error that all runs share. Runs of a planner differ more than sets of N = 1000 independent samples of one "
      "density do; over {} such sets the smoothing of an uneven density is as large as the interval's half-width. How "
      "often it then holds the truth, in {} experiments:\n\n"
      "| case | covered | bias | mean half-width |\n|---|---|---|---|\n",
      runs_each, experiments);
  for (const Case& c : cases) {
    if (!c.standard) continue;
    const Measured m = measure(c, 1000, runs_each * experiments, EstimatorSpec::make("knn"), 100000);
    std::size_t covered = 0;
    double half = 0.0;
    for (std::size_t e = 0; e < experiments; ++e) {
      const Interval interval = student_interval(std::span(m.values).subspan(e * runs_each, runs_each));
      if (interval.lo <= c.d_regularised && c.d_regularised <= interval.hi) ++covered;
      half += 0.5 * (interval.hi - interval.lo) / static_cast<double>(experiments);
    }
    report.text += fmt::format("| {} | {:.0f} % | {} | {:.3f} |\n", c.name,
                               100.0 * static_cast<double>(covered) / static_cast<double>(experiments),
                               signed_text(m.regularised.bias), half);
  }
  report.text += '\n';
}

/// The proposals of plain RRT: uniform, and 5 % the goal itself.
void rrt_table(Report& report) {
  const std::size_t experiments = std::max<std::size_t>(10, report.repetitions / 2);
  report.text += fmt::format(
      "### Proposals of plain RRT\n\nTheir density is known: D = log(\\|C\\|/\\|A\\|) - log 0.95. Experiments as users "
      "run them: {} seeds, every run's proposals scored on the paths of 4 other seeds. `knn` and `exact` against the "
      "truth in one experiment, then how often the 95 % interval of `knn` holds the truth in {} experiments.\n\n"
      "| scene | error of knn | 95 % interval | error of exact | interval holds the truth |\n|---|---|---|---|---|\n",
      runs_each, experiments);
  std::size_t all = 0;
  std::size_t held = 0;
  double worst = 0.0;
  for (const Problem& problem : {test::simple_passage_problem(), test::trap_problem(), test::cup_problem()}) {
    std::size_t covered = 0;
    std::string first;
    for (std::size_t e = 0; e < experiments; ++e) {
      Experiment experiment;
      experiment.problems = {problem};
      experiment.strategies = {{"rrt", StrategySpec(PlannerSpec::make("rrt", {{"step", 0.5}}))}};
      for (std::uint64_t seed = 1; seed <= runs_each; ++seed) experiment.seeds.push_back(1000 * e + seed);
      experiment.measure = Measure{};
      experiment.measure->estimators = {EstimatorSpec::make("knn")};
      if (e == 0)
        experiment.measure->estimators.insert(experiment.measure->estimators.begin(), EstimatorSpec::make("exact"));
      const ExperimentResult result = run(experiment, {.jobs = jobs(), .progress = {}, .interrupted = {}});
      std::vector<double> knn;
      std::vector<double> exact;
      for (const RunResult& r : result.runs) {
        if (r.levels.empty() || !r.levels.front().root_cross) continue;
        const Efficiency& found = r.levels.front().root_cross->expansion;
        const double truth = found.uniform - std::log(0.95);
        if (e > 0) {
          knn.push_back(found.unregularised - truth);
          continue;
        }
        exact.push_back(found.unregularised - truth);
        if (!found.others.empty()) knn.push_back(found.others.front().unregularised - truth);
      }
      const Interval k = student_interval(knn);
      if (k.lo <= 0.0 && 0.0 <= k.hi) ++covered;
      if (e > 0) continue;
      worst = std::max(worst, std::abs(k.value));
      first = fmt::format("| {} | {} | {} to {} | {:.0e} |", problem.name, signed_text(k.value), signed_text(k.lo),
                          signed_text(k.hi), std::abs(student_interval(exact).value));
    }
    report.text +=
        fmt::format("{} {:.0f} % |\n", first, 100.0 * static_cast<double>(covered) / static_cast<double>(experiments));
    held += covered;
    all += experiments;
  }
  const double share = static_cast<double>(held) / static_cast<double>(all);
  report.require(
      worst <= 0.05,
      fmt::format("plain RRT's proposals on other seeds' paths: worst error of knn {:.3f}, at most 0.05", worst));
  report.require(share >= 0.92 && share <= 0.97,
                 fmt::format("the 95 % interval over {} runs holds the truth: {:.1f} % of {} experiments, 92 to 97 %",
                             runs_each, 100.0 * share, all));
  report.text += '\n';
}

/// `exact` at the default number of points against a fine quasi Monte Carlo integral of the same density.
void exact_table(Report& report) {
  report.text +=
      "### Exact densities\n\n`exact` as it is by default (8192 points) against an integral over 2^18 points of the "
      "recorded density: nested strategy (skeleton >> shrink >> lazy >> rrt), seed 1, its own path. Beside it `knn` on "
      "the N samples: the proposals lie in a thin tube of SE(2), the target holds all headings, and so few samples "
      "cannot show how little is proposed elsewhere. The report says so where the two disagree.\n\n"
      "| scene | level | SE, 8192 points | SE, 2^18 points | difference | N | `knn` |\n"
      "|---|---|---|---|---|---|---|\n";
  double worst = 0.0;
  const StrategySpec nested = GuideSpec::make("skeleton", {}) >> GuideSpec::make("shrink", {{"scale", 0.5}}) >>
                              GuideSpec::make("lazy", {}) >> PlannerSpec::make("rrt", {{"step", 0.5}});
  for (const Problem& problem : {test::simple_passage_problem(), test::trap_problem(), test::cup_problem()}) {
    const RunRecord record = execute(nested, problem, 1);
    if (!record.solved) continue;
    for (const LevelRecord& level : record.levels) {
      if (!level.root_proposal_density || level.root_proposals().empty()) continue;
      const LevelRecord& root = record.levels.front();
      const auto regularised = [&](std::int64_t pool, const char* estimator) {
        TubeSettings settings;
        settings.pool = pool;
        const Target target(root.space, record.path, root.position_axes, settings, root.valid, 1);
        return efficiency(target, level.root_proposals(),
                          {.estimators = {EstimatorSpec::make(estimator)}, .density = level.root_proposal_density})
            .value;
      };
      const double coarse = regularised(TubeSettings{}.pool, "exact");
      const double fine = regularised(1 << 18, "exact");
      report.text +=
          fmt::format("| {} | {} | {:.4f} | {:.4f} | {:+.4f} | {} | {:.2f} |\n", problem.name, level.name, coarse, fine,
                      coarse - fine, level.root_proposals().size(), regularised(TubeSettings{}.pool, "knn"));
      worst = std::max(worst, std::abs(coarse - fine));
    }
  }
  report.require(worst <= 0.01,
                 fmt::format("`exact` against a fine integral: worst difference {:.4f}, at most 0.01", worst));
  report.text += '\n';
}

/// The bound by mass and arc length in six and seven degrees of freedom, by the number of samples in the target.
void spatial_table(Report& report) {
  const std::size_t repetitions = std::min<std::size_t>(report.repetitions, 40);
  const std::size_t few = std::max<std::size_t>(10, report.repetitions / 20);
  report.text += fmt::format(
      "### Bodies in space\n\nThe bound by mass and arc length (`arc`), the headline from five degrees of freedom on, "
      "in "
      "bent tubes of SE(3) and of R^3 x SO(3) x S^1: weight 0.5 m, delta 0.5 m, a world of 10 m. Nothing is lost "
      "across "
      "the path, so the bound is the divergence. RMSE of SE over {} repetitions by the expected number of samples "
      "in "
      "the target, n; N = n / 0.3. Beside it `knn`, over {} repetitions.\n\n"
      "| case | uniform | SE | n = 100 | n = 300 | n = 1000 | n = 3000 | `knn`, n = 300 | `knn`, n = 1000 |\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      repetitions, few);
  const EstimatorSpec arc = EstimatorSpec::make("arc");
  const EstimatorSpec knn = EstimatorSpec::make("knn");
  double worst = 0.0;
  for (const Case& c : verify::spatial_cases()) {
    std::string row = fmt::format("| {}: {} | {:.3f} | {:.3f} |", c.name, c.what, c.target->uniform(), c.d_regularised);
    for (const std::size_t n : {100U, 300U, 1000U, 3000U}) {
      const double rmse = measure(c, 10 * n / 3, repetitions, arc).regularised.rmse;
      if (n >= 300) worst = std::max(worst, rmse);
      row += fmt::format(" {:.3f} |", rmse);
    }
    for (const std::size_t n : {300U, 1000U}) {
      const Errors errors = measure(c, 10 * n / 3, few, knn).regularised;
      row += fmt::format(" {:.3f} ({}) |", errors.rmse, signed_text(errors.bias));
    }
    report.text += row + '\n';
  }
  report.text += '\n';
  report.require(worst <= 0.1,
                 fmt::format("the bound by mass and arc length in SE(3) and R^3 x SO(3) x S^1, 300 samples "
                             "in the target or more: RMSE {:.3f}, at most 0.1",
                             worst));
  const double volume = verify::worst_volume_error(20);
  report.require(
      volume <= 0.01,
      fmt::format("volume of a tube in SO(3) against its closed form: worst error {:.4f} of 20, at most 0.01", volume));
}

/// Misses of `repetitions` that an interval of 95 % exceeds with a probability below 1 %.
std::size_t most_misses(std::size_t repetitions) {
  double below = 0.0;
  double log_term = static_cast<double>(repetitions) * std::log(0.95);  // of no miss
  for (std::size_t k = 0; k < repetitions; ++k) {
    below += std::exp(log_term);
    if (below >= 0.99) return k;
    log_term += std::log(static_cast<double>(repetitions - k) / static_cast<double>(k + 1) * 0.05 / 0.95);
  }
  return repetitions;
}

/// The interval of SE that samples support, for samples that fill the target or leave parts of it empty.
void supported_table(Report& report) {
  const std::vector<std::size_t> counts = {20, 40, 100, 300, 1000, 3000};
  const std::size_t repetitions = std::min<std::size_t>(40, report.repetitions);
  report.text += fmt::format(
      "### The interval, case by case\n\nThe interval of SE for N samples in and about a straight tube (radius 0.5 "
      "m, "
      "length 8 m; SE(2): all headings): the mean of its ends over {} repetitions, the share of them whose interval is "
      "printed, and, where any missed, that of the printed ones that hold the truth. Without a share: blank in all.\n",
      repetitions);
  /// Of the intervals from all samples, and of the rough ones of single runs.
  struct Coverage {
    std::size_t printed = 0;
    std::size_t missed = 0;
    std::size_t worst = 0;
    std::string where = "none";
  };
  std::array<Coverage, 2> coverage;
  for (const std::size_t d : {2U, 3U, 6U, 7U}) {
    const std::vector<verify::SupportedCase> cases = verify::supported_cases(d);
    const double uniform = verify::StraightTube(d).target(1)->uniform();
    report.text += fmt::format("\n| {}, uniform {:.2f} | truth |", d == 3 ? "SE(2)" : fmt::format("R^{}", d), uniform);
    for (const std::size_t n : counts) report.text += fmt::format(" N = {} |", n);
    report.text += "\n|---|---|---|---|---|---|---|---|\n";
    const std::size_t cells = cases.size() * counts.size();
    std::vector<verify::SupportedResult> results(2 * cells);
    in_parallel(results.size(), jobs(), [&](std::size_t i) {
      const std::size_t at = i % cells;
      results[i] = verify::supported_result(d, cases[at / counts.size()], counts[at % counts.size()], 1, repetitions,
                                            i >= cells);
    });
    for (std::size_t i = 0; i < results.size(); ++i) {
      Coverage& of = coverage[i / cells];
      const verify::SupportedResult& r = results[i];
      of.printed += r.printed;
      of.missed += r.missed;
      if (r.missed <= of.worst) continue;
      of.worst = r.missed;
      of.where = fmt::format("d = {}, {}, N = {}", d, cases[i % cells / counts.size()].name, counts[i % counts.size()]);
    }
    for (std::size_t c = 0; c < cases.size(); ++c) {
      report.text += fmt::format("| {}: {} | {:.2f} |", cases[c].kind, cases[c].name, cases[c].truth);
      for (std::size_t k = 0; k < counts.size(); ++k) {
        const verify::SupportedResult& r = results[c * counts.size() + k];
        const auto percent = [](std::size_t part, std::size_t of) {
          return 100.0 * static_cast<double>(part) / static_cast<double>(of);
        };
        report.text += fmt::format(" {:.2f} to {:.2f}", r.lo, r.hi);
        if (r.printed > 0) report.text += fmt::format(", {:.0f} %", percent(r.printed, repetitions));
        if (r.missed > 0) report.text += fmt::format(" ({:.0f} %)", percent(r.printed - r.missed, r.printed));
        report.text += " |";
      }
      report.text += '\n';
    }
  }
  report.text += '\n';
  for (const bool rough : {false, true}) {
    const Coverage& of = coverage[rough ? 1 : 0];
    const char* name = rough ? "the rough interval of single runs" : "the interval that samples support";
    report.require(of.worst <= most_misses(repetitions),
                   fmt::format("{} holds the truth or is blank, in each case and for each N: at most {} of {} missed "
                               "({}), {} allowed at 95 %",
                               name, of.worst, repetitions, of.where, most_misses(repetitions)));
    const double share =
        static_cast<double>(of.printed - of.missed) / static_cast<double>(std::max<std::size_t>(of.printed, 1));
    report.require(share >= 0.95, fmt::format("{}: {:.1f} % of all {} printed ones hold the truth, at least 95 %", name,
                                              100.0 * share, of.printed));
  }
}

}  // namespace

int main(int argc, char** argv) {
  // [REPETITIONS [supported]]
  Report report;
  if (argc > 1) report.repetitions = static_cast<std::size_t>(std::max(20, std::atoi(argv[1])));
  // The last section alone.
  const bool alone = argc > 2 && std::string_view(argv[2]) == "supported";
  if (alone) {
    supported_table(report);
    std::printf("| required | holds |\n|---|---|\n%s\n%s", report.requirements.c_str(), report.text.c_str());
    return report.passed ? 0 : 1;
  }
  std::vector<Case> cases = verify::standard_cases(2);
  for (auto& c : verify::standard_cases(3)) cases.push_back(std::move(c));
  const std::vector<Case> standard = cases;
  for (auto& c : verify::closed_cases()) cases.push_back(std::move(c));
  error_tables(report, cases);
  estimator_table(report, standard);
  rrt_table(report);
  exact_table(report);
  spatial_table(report);
  interval_table(report, standard);
  supported_table(report);
  std::printf("| required | holds |\n|---|---|\n%s\n%s", report.requirements.c_str(), report.text.c_str());
  std::fprintf(stderr, "%s\n", report.passed ? "all requirements hold" : "some requirement does not hold");
  return report.passed ? 0 : 1;
}
