// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/left_out.hpp>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/parallel.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/strategy/ablation.hpp>

namespace trellis {

namespace {

constexpr double scoring_work = 20'000.0;  // of a run: scoring takes as long as so many checks, or longer
constexpr double least_work = 200'000.0;   // of an experiment: less takes no time that a user notices

/// With uniform sampling in place of its guide, a strategy samples as its planner alone does.
bool same_search(const StrategySpec& a, const StrategySpec& b) {
  const auto plain = [](const StrategySpec& s) { return s.guide() == nullptr || s.guide()->text() == "uniform()"; };
  return a == b || (plain(a) && plain(b) && a.planner() == b.planner());
}

/// A strategy to run, and the guides that it is without.
struct Rest {
  StrategySpec strategy;
  std::vector<std::size_t> tests;    ///< indices into the costs
  std::vector<std::size_t> runs_of;  ///< indices of the complete strategies
  bool impossible = false;           ///< its guides cannot make their spaces
};

/// The runs on one problem.
class ProblemAblation {
 public:
  ProblemAblation(const Experiment& experiment, const ExperimentResult& result, std::size_t problem,
                  std::vector<LeftOut>& left_out)
      : experiment_(experiment),
        problem_(experiment.problems[problem]),
        first_run_(&result.runs[problem * experiment.strategies.size() * experiment.seeds.size()]),
        left_out_(left_out),
        budget_(ablation_budget(experiment, result, problem_.name)) {
    for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
      const auto& [name, strategy] = experiment.strategies[s];
      if (is_ablation(experiment, name)) continue;
      for (const Ablation& ablation : decisive_ablations(strategy)) {
        if (equal_strategy(experiment, name, ablation.strategy) == nullptr) add(s, ablation);
      }
    }
  }
  [[nodiscard]] std::size_t steps() const { return rests_.size() * experiment_.seeds.size(); }

  /// \param progress  called after each run
  void run(const ExperimentOptions& options, const std::function<void()>& progress) {
    double spent = 0.0;
    std::size_t tested = 0;
    while (tested < experiment_.seeds.size() && spent < budget_ && !rests_.empty()) {
      spent += run_seed(tested++, options, progress);
      // An estimate for as many seeds as a verdict takes.
      const auto seeds = static_cast<double>(std::max(tested, least_tested_seeds));
      if (tested < least_tested_seeds && spent / static_cast<double>(tested) * seeds > budget_) break;
    }
    for (const Rest& rest : rests_) {
      for (const std::size_t test : rest.tests) {
        if (tested < least_tested_seeds || rest.impossible) left_out_[test].costs.clear();
      }
    }
  }

 private:
  void add(std::size_t strategy, const Ablation& ablation) {
    left_out_.push_back({problem_.name, experiment_.strategies[strategy].first, ablation.key, {}});
    auto rest = std::find_if(rests_.begin(), rests_.end(),
                             [&](const Rest& known) { return same_search(known.strategy, ablation.strategy); });
    if (rest == rests_.end()) rest = rests_.insert(rest, Rest{ablation.strategy, {}, {}, false});
    rest->tests.push_back(left_out_.size() - 1);
    rest->runs_of.push_back(strategy);
  }

  /// The work at which a run without a guide is cut off.
  [[nodiscard]] double limit(const Rest& rest, std::size_t seed) const {
    double most = 0.0;
    for (const std::size_t strategy : rest.runs_of) {
      most = std::max(most, first_run_[strategy * experiment_.seeds.size() + seed].run.work);
    }
    return most_left_out_work * most + companion_constant.work;
  }

  /// Returns the work of all runs on the seed.
  double run_seed(std::size_t seed, const ExperimentOptions& options, const std::function<void()>& progress) {
    std::vector<double> work(rests_.size(), 0.0);
    std::vector<CensoredCost> costs(rests_.size());
    in_parallel(rests_.size(), options.jobs, [&](std::size_t i) {
      Rest& rest = rests_[i];
      if (options.interrupted && options.interrupted()) throw Interrupted();
      if (!rest.impossible) {
        try {
          const RunRecord run = execute(rest.strategy, problem_, experiment_.seeds[seed],
                                        {.interrupted = options.interrupted,
                                         .measured = false,
                                         .threads = options.threads,
                                         .work_limit = limit(rest, seed)});
          if (options.interrupted && options.interrupted()) throw Interrupted();
          work[i] = run.work;
          // An anytime planner that was cut off has its first path all the same.
          costs[i] = {static_cast<double>(run.validity_checks - run.improvement_checks),
                      run.solved || run.improvement_checks > 0};
        } catch (const Error&) {
          rest.impossible = true;
        }
      }
      progress();
    });
    double sum = 0.0;
    for (std::size_t i = 0; i < rests_.size(); ++i) {
      sum += work[i];
      for (const std::size_t test : rests_[i].tests) left_out_[test].costs.push_back(costs[i]);
    }
    return sum;
  }

  const Experiment& experiment_;
  const Problem& problem_;
  const RunResult* first_run_;
  std::vector<LeftOut>& left_out_;
  std::vector<Rest> rests_;
  double budget_;
};

}  // namespace

bool is_ablation(const Experiment& experiment, const std::string& strategy) {
  return std::any_of(experiment.ablations.begin(), experiment.ablations.end(),
                     [&](const AblationLink& link) { return link.strategy == strategy; });
}

const std::pair<std::string, StrategySpec>* equal_strategy(const Experiment& experiment, const std::string& strategy,
                                                           const StrategySpec& spec) {
  for (const auto& entry : experiment.strategies) {
    if (entry.first != strategy && same_search(entry.second, spec)) return &entry;
  }
  return nullptr;
}

double ablation_budget(const Experiment& experiment, const ExperimentResult& result, const std::string& problem) {
  double work = 0.0;
  for (const RunResult& run : result.runs) {
    if (run.problem == problem) work += run.run.work + (experiment.measure ? scoring_work : 0.0);
  }
  return experiment.ablation * std::max(work, least_work);
}

void run_left_out(const Experiment& experiment, ExperimentResult& result, const ExperimentOptions& options) {
  result.left_out.clear();
  if (experiment.ablation <= 0.0 || experiment.seeds.size() < least_tested_seeds) return;
  std::vector<LeftOut> left_out;
  std::vector<ProblemAblation> problems;
  problems.reserve(experiment.problems.size());
  std::size_t all = 0;
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) {
    problems.emplace_back(experiment, result, p, left_out);
    all += problems.back().steps();
  }
  std::mutex mutex;
  std::size_t done = 0;
  const auto progress = [&] {
    const std::scoped_lock lock(mutex);
    ++done;
    if (options.ablation_progress) options.ablation_progress(done, all);
  };
  for (ProblemAblation& problem : problems) problem.run(options, progress);
  result.left_out = std::move(left_out);
}

}  // namespace trellis
