// SPDX-License-Identifier: GPL-3.0-or-later
// bench_ompl_guided SCRIPT.lua [SEEDS [PLANNER [PROBLEM]]]: OMPL's RRT, RRTConnect and PRM, unchanged, alone and with
// draws from `skeleton()`, on the problems of an experiment: validity checks until the first path, on the same seeds,
// and CPU time. `ratio` is the median over seeds, `beyond 2 alone` the most checks of a run beyond twice those alone,
// `cold` the CPU time of the first run, which computes the medial axis. Needs OMPL 1.5 (scripts/setup peer). The same
// validity and resolution on both sides.
//
// PLANNER: rrt, rrt_connect, prm, optimistic (RRT whose draws all count as accepted), bounded (RRTConnect, both by
// turns within bounded loss); default: all.
#include <fmt/format.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/ompl.hpp>
#include <trellis/testing.hpp>

namespace ob = ompl::base;
namespace og = ompl::geometric;
using namespace trellis;

namespace {

constexpr double step = 0.5;
constexpr double infinity = std::numeric_limits<double>::infinity();
// A run that draws so often has no path.
constexpr std::uint64_t most_draws = 20000;
constexpr std::uint64_t most_checks = 2000000;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Result {
  bool solved = false;
  double checks = 0.0;  ///< of the planner and of the guide's levels
  double cpu_s = 0.0;
};

ob::PlannerPtr planner_named(const std::string& name, const ob::SpaceInformationPtr& information) {
  if (name == "rrt_connect" || name == "bounded") {
    auto planner = std::make_shared<og::RRTConnect>(information);
    planner->setRange(step);
    return planner;
  }
  if (name == "prm") return std::make_shared<og::PRM>(information);
  auto planner = std::make_shared<og::RRT>(information);
  planner->setRange(step);
  planner->setGoalBias(0.05);
  return planner;
}

OmplGuide::Search search_of(const std::string& name) {
  return name == "prm"                                ? OmplGuide::Search::roadmap
         : name == "rrt_connect" || name == "bounded" ? OmplGuide::Search::trees
                                                      : OmplGuide::Search::tree;
}

bool solve(const std::string& name, OmplProblem& problem, const std::function<bool()>& over) {
  const auto planner = planner_named(name, problem.information());
  planner->setProblemDefinition(problem.definition());
  planner->setup();
  return planner->solve(ob::PlannerTerminationCondition(over)) == ob::PlannerStatus::EXACT_SOLUTION;
}

/// Whether checked motions connect two states.
class Connections {
 public:
  Connections(const Configuration& a, const Configuration& b) {
    static_cast<void>(place(a));
    static_cast<void>(place(b));
  }
  void join(const Configuration& a, const Configuration& b) {
    const std::size_t from = root(place(a));
    parent_[from] = root(place(b));
    if (root(0) == root(1)) joined_ = true;
  }
  /// Called by several threads.
  [[nodiscard]] bool joined() const { return joined_; }

 private:
  std::size_t place(const Configuration& q) {
    const auto [found, added] = places_.try_emplace(q, parent_.size());
    if (added) parent_.push_back(found->second);
    return found->second;
  }
  std::size_t root(std::size_t at) {
    while (parent_[at] != at) at = parent_[at] = parent_[parent_[at]];
    return at;
  }
  std::map<Configuration, std::size_t> places_;
  std::vector<std::size_t> parent_;
  std::atomic<bool> joined_ = false;
};

/// Sees the motions of PRM alone.
class Joins final : public ob::MotionValidator {
 public:
  Joins(ob::SpaceInformation* of, ob::MotionValidatorPtr inner, Connections& connections)
      : ob::MotionValidator(of), inner_(std::move(inner)), connections_(connections) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    const bool valid = inner_->checkMotion(a, b);
    const auto& space = *si_->getStateSpace();
    if (valid) connections_.join(reals_of(space, a), reals_of(space, b));
    return valid;
  }
  bool checkMotion(const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& last) const override {
    last.second = 0.0;
    return checkMotion(a, b);
  }

 private:
  ob::MotionValidatorPtr inner_;
  Connections& connections_;
};

/// Counts the checks of a planner alone, for bounded loss.
class Counted final : public ob::MotionValidator {
 public:
  Counted(ob::SpaceInformation* of, ob::MotionValidatorPtr inner, const OmplProblem& problem, Bounded& both)
      : ob::MotionValidator(of), inner_(std::move(inner)), problem_(problem), both_(both) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    const std::uint64_t before = problem_.checks();
    const bool valid = inner_->checkMotion(a, b);
    both_.spent(Who::alone, problem_.checks() - before);
    return valid;
  }
  bool checkMotion(const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& last) const override {
    last.second = 0.0;
    return checkMotion(a, b);
  }

 private:
  ob::MotionValidatorPtr inner_;
  const OmplProblem& problem_;
  Bounded& both_;
};

void seed_ompl(std::uint64_t seed) { ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed)); }

Result alone(const std::string& name, const Problem& of, std::uint64_t seed) {
  seed_ompl(seed);
  const double begin = cpu_seconds();
  OmplProblem problem(of);
  Connections connections(problem.instance().start, problem.instance().goals.front());
  Result result;
  if (name == "prm") {
    // PRM itself looks for a path once in a millisecond.
    const auto& information = problem.information();
    information->setMotionValidator(
        std::make_shared<Joins>(information.get(), information->getMotionValidator(), connections));
    information->setup();
    solve(name, problem, [&] { return connections.joined() || problem.checks() > most_checks; });
    result.solved = connections.joined();
  } else {
    result.solved = solve(name, problem, [&] { return problem.checks() > most_checks; });
  }
  result.checks = static_cast<double>(problem.checks());
  result.cpu_s = cpu_seconds() - begin;
  return result;
}

SamplerOptions options_of(const std::string& name) {
  SamplerOptions options;
  options.step = step;
  options.optimistic = name == "optimistic";
  return options;
}

Result guided(const std::string& name, const Problem& of, std::uint64_t seed) {
  seed_ompl(seed);
  const double begin = cpu_seconds();
  OmplProblem problem(of);
  Sampler sampler(GuideSpec::make("skeleton", {}), of, seed, options_of(name));
  Result result;
  if (name == "optimistic") {
    // A sampler in bulk: no answers.
    problem.information()->getStateSpace()->setStateSamplerAllocator([&](const ob::StateSpace* space) {
      class Bulk final : public ob::StateSampler {
       public:
        Bulk(const ob::StateSpace* space, Sampler& sampler) : ob::StateSampler(space), sampler_(sampler) {}
        void sampleUniform(ob::State* state) override {
          Configuration q(sampler_.space().dimension());
          sampler_.draw(q);
          space_->copyFromReals(state, {q.begin(), q.end()});
        }
        void sampleUniformNear(ob::State* state, const ob::State*, double) override { sampleUniform(state); }
        void sampleGaussian(ob::State* state, const ob::State*, double) override { sampleUniform(state); }

       private:
        Sampler& sampler_;
      };
      return std::make_shared<Bulk>(space, sampler);
    });
    result.solved = solve(name, problem, [&] { return problem.checks() > most_checks; });
    result.checks = static_cast<double>(problem.checks() + sampler.checks());
  } else {
    OmplGuide guide(problem.information(), sampler, search_of(name));
    result.solved = solve(name, problem, [&] {
      return guide.connected() || guide.draws() >= most_draws || guide.checks() > most_checks;
    });
    result.solved = result.solved || guide.connected();
    result.checks = static_cast<double>(guide.checks() + sampler.checks());
  }
  result.cpu_s = cpu_seconds() - begin;
  return result;
}

Result bounded(const Problem& of, std::uint64_t seed) {
  seed_ompl(seed);
  Bounded both;
  OmplProblem first(of);
  OmplProblem second(of);
  Sampler sampler(GuideSpec::make("skeleton", {}), of, seed, options_of("bounded"));
  first.information()->setMotionValidator(
      std::make_shared<Counted>(first.information().get(), first.information()->getMotionValidator(), first, both));
  first.information()->setup();
  OmplGuide guide(second.information(), sampler, OmplGuide::Search::trees,
                  [&](std::uint64_t checks) { both.spent(Who::guided, checks); });
  const auto over = [&] { return both.over() || both.checks(Who::alone) > most_checks; };
  // OMPL's generators have seeds in the order in which they are made: the planner alone is first, as without the other.
  const auto found =
      both.run([&] { return solve("bounded", first, over); }, [&] { return solve("bounded", second, over); });
  return {found.has_value(), static_cast<double>(both.checks(Who::alone) + both.checks(Who::guided)), 0.0};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? NAN : n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: bench_ompl_guided SCRIPT.lua [SEEDS [PLANNER [PROBLEM]]]\n");
    return 2;
  }
  ompl::msg::noOutputHandler();
  const trellis::testing::Script script = trellis::testing::load(argv[1]);
  const std::uint64_t seeds = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 20;
  std::vector<std::string> planners = {"rrt", "rrt_connect", "prm", "optimistic", "bounded"};
  if (argc > 3) planners = {argv[3]};
  fmt::print(
      "| planner | problem | alone | solved | with skeleton() | solved | ratio | worst | beyond 2 alone | CPU ratio | "
      "cold, ms |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& planner : planners) {
    for (const std::string& name : script.problems()) {
      if (argc > 4 && name != argv[4]) continue;
      const Problem problem = script.problem(name);
      std::vector<double> a, g, ratios, times;
      int solved_alone = 0, solved_guided = 0;
      double excess = -infinity;
      // The world's medial axis is computed once.
      const double begin = cpu_seconds();
      static_cast<void>(guided(planner == "bounded" ? "rrt_connect" : planner, problem, 1));
      const double cold = cpu_seconds() - begin;
      for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const Result x = alone(planner, problem, seed);
        const Result y = planner == "bounded" ? bounded(problem, seed) : guided(planner, problem, seed);
        solved_alone += x.solved;
        solved_guided += y.solved;
        a.push_back(x.checks);
        g.push_back(y.checks);
        excess = std::max(excess, y.checks - 2.0 * x.checks);
        ratios.push_back(y.solved ? y.checks / x.checks : infinity);
        times.push_back(y.cpu_s / x.cpu_s);
      }
      fmt::print("| {} | {} | {:.0f} | {} | {:.0f} | {} | {:.3f} | {:.2f} | {:.0f} | {} | {:.1f} |\n", planner, name,
                 median(a), solved_alone, median(g), solved_guided, median(ratios),
                 *std::max_element(ratios.begin(), ratios.end()), excess,
                 planner == "bounded" ? "" : fmt::format("{:.2f}", median(times)), 1e3 * cold);
      std::fflush(stdout);
    }
  }
}
