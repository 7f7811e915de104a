// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/split_search.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/planner/common.hpp>
#include <trellis/strategy/absorb.hpp>

namespace trellis {

namespace {

/// Appends the trajectory of the second half, which starts at the end of the first.
void append(const Trajectory& half, Trajectory& whole) {
  if (half.steps.empty()) return;
  if (whole.steps.empty()) {
    whole = half;
    return;
  }
  for (std::size_t i = 0; i < half.controls.size(); ++i) whole.controls.push(half.controls[i]);
  whole.steps.insert(whole.steps.end(), half.steps.begin(), half.steps.end());
}

/// Proposals of which one becomes the sub-goal: the valid one that minimises the longer of the distances to start and
/// goal.
struct Candidates {
  static constexpr int wanted = 8;
  static constexpr int most = 200;
  int drawn = 0;
  int valid = 0;
  std::optional<Configuration> best;
  double shortest = 0.0;
};

/// Divides an instance at a sub-goal, which lies on the guiding path or is a valid proposal, and solves both halves by
/// the same strategy. If a half is not solved, tries other sub-goals; finally solves the undivided instance.
class SplitSearch final : public DividingPlanner {
 public:
  SplitSearch(Run& run, Level& level, const PlannerSpec& planner, const GuideSpec* guide, PlannerContext context)
      : DividingPlanner(std::move(context)),
        run_(run),
        level_(level),
        planner_(planner),
        guide_(guide),
        settings_(split_settings().read(*planner.dividing())),
        lift_(find_guide("identity")->make(GuideSpec::make("identity", {}).options())) {}

  std::optional<Status> begin(const Budget& budget) override {
    budget_ = budget;
    if (undivided_) return undivided_->begin(budget);
    if (!ends_checked_) {
      if (const auto invalid = remove_invalid_goals(context_.instance)) return invalid;
      ends_checked_ = true;
    }
    found_.reset();
    if (context_.instance.to_goal(context_.instance.start) <= context_.instance.goal_tolerance) {
      if (context_.search.nodes.empty()) {
        context_.search.nodes.push(context_.instance.start);
        context_.search.parents.push_back(no_node);
      }
      return Status::solved;
    }
    return tries_ < settings_.tries ? std::nullopt : undivide();
  }

  [[nodiscard]] bool draws() const override { return !undivided_ || undivided_->draws(); }

  Plan plan() override { return undivided_ ? undivided_->plan() : Plan{.proposal = candidates_ && !spent(budget_)}; }

  /// A proposal is a candidate for the sub-goal.
  Outcome extend(View proposal) override { return undivided_ ? undivided_->extend(proposal) : candidate(proposal); }

  std::optional<Status> follow() override {
    if (undivided_) return undivided_->follow();
    if (candidates_->drawn < Candidates::most && candidates_->valid < Candidates::wanted) return std::nullopt;
    return divide_at(candidates_->best);
  }

  /// Begins a try, and its first half where the sub-goal is known.
  std::optional<Status> work() override {
    if (undivided_) return undivided_->work();
    if (spent(budget_)) return stopped(Status::budget_spent);
    if (const auto goal = on_path()) return divide_at(goal);
    candidates_.emplace();
    return std::nullopt;
  }

  [[nodiscard]] Stream& stream() override { return undivided_ ? undivided_->stream() : Planner::stream(); }
  [[nodiscard]] StepsAhead* coming() override { return undivided_ ? undivided_->coming() : nullptr; }

  std::optional<Status> stopped(Status limit) override {
    if (undivided_) return undivided_->stopped(limit);
    if (!candidates_) return limit;
    // The best candidate so far may still divide the instance.
    limit_ = limit;
    return divide_at(candidates_->best);
  }

  [[nodiscard]] Part part() override {
    if (undivided_) return undivided_divides_ != nullptr ? undivided_divides_->part() : Part{};
    return {half_, {}};
  }
  std::optional<Status> take(Advance advance) override {
    if (undivided_) return undivided_divides_->take(advance);
    Level& ended = *std::exchange(half_, nullptr);
    absorb_half(ended);
    const Solution& found = ended.solution();
    halves_.validity += ended.instance().checks.validity;
    seconds_ += ended.record().search.seconds;
    if (!found.solved()) return end_try();
    for (std::size_t k = number_ == 0 ? 0 : 1; k < found.path.size(); ++k) whole_.path.push(found.path[k]);
    append(found.trajectory, whole_.trajectory);
    if (++number_ < names.size()) return begin_half();
    found_ = std::move(whole_);
    return end_try();
  }
  void leave() override {
    if (undivided_divides_ != nullptr) undivided_divides_->leave();
    if (half_ != nullptr) absorb_half(*std::exchange(half_, nullptr));
  }

  [[nodiscard]] Solution solution(Status status) override {
    if (undivided_) return undivided_->solution(status);
    if (status == Status::solved && found_) return *found_;
    return {status, path_of_start(context_.instance), {}};
  }

 private:
  /// The remaining budget.
  [[nodiscard]] Budget left(const Budget& budget) const {
    Budget rest;
    rest.proposals = budget.proposals - static_cast<double>(context_.search.proposals.size());
    rest.checks = budget.checks - static_cast<double>(context_.instance.checks.validity + halves_.validity);
    rest.seconds = budget.seconds - context_.search.seconds - seconds_;
    return rest;
  }
  /// Whether this level and the halves together have spent the budget.
  [[nodiscard]] bool spent(const Budget& budget) const {
    const Budget rest = left(budget);
    return rest.proposals <= 0.0 || rest.checks <= 0.0 || rest.seconds <= 0.0;
  }

  /// Divides the instance at the sub-goal of a try, if it has one.
  std::optional<Status> divide_at(const std::optional<Configuration>& sub_goal) {
    ++tries_;
    if (!sub_goal) return end_try();
    sub_goal_ = *sub_goal;
    number_ = 0;
    whole_ = {Status::solved, Configurations(context_.instance.space.dimension()), {}};
    return begin_half();
  }
  /// Ends a try. After the last one the instance is not divided.
  std::optional<Status> end_try() {
    candidates_.reset();
    const std::optional<Status> limit = std::exchange(limit_, std::nullopt);
    if (found_) return Status::solved;
    const std::optional<Status> ended = tries_ < settings_.tries ? std::nullopt : undivide();
    return ended ? ended : limit;
  }

  /// Begins the search of the undivided instance.
  std::optional<Status> undivide() {
    const PlannerSpec& leaf = planner_.undivided();
    PlannerContext context = context_;
    context.proposals = Stream(run_.seed, level_.record().key, "proposals undivided");
    if (leaf.dividing() != nullptr) {
      auto divides = make_split_search(run_, level_, leaf, guide_, std::move(context));
      undivided_divides_ = divides.get();
      undivided_ = std::move(divides);
    } else {
      undivided_ = find_planner(leaf.name())->make(leaf.options(), std::move(context));
    }
    return undivided_->begin(budget_);
  }

  /// The sub-goal of this try if there is a guiding path: its point in the middle of a gap between earlier tries, or a
  /// valid configuration near it.
  std::optional<Configuration> on_path() {
    if (guide_ == nullptr) return std::nullopt;
    const Configurations path = level_.heuristic().guide()->guiding_path();
    return path.size() >= 2 ? near(point(path, share(tries_))) : std::nullopt;
  }

  /// 1/2, 1/4, 3/4, 1/8, ...: the van der Corput sequence.
  static double share(std::int64_t number) {
    double result = 0.0;
    double digit = 0.5;
    for (std::int64_t n = number + 1; n > 0; n /= 2) {
      if (n % 2 == 1) result += digit;
      digit /= 2.0;
    }
    return result;
  }

  [[nodiscard]] Configuration point(const Configurations& path, double share) const {
    const Space& space = context_.instance.space;
    double ahead = share * path_length(space, path);
    Configuration q(space.dimension());
    for (std::size_t i = 1; i < path.size(); ++i) {
      const double leg = space.distance(path[i - 1], path[i]);
      if (leg > 0.0 && (ahead <= leg || i + 1 == path.size())) {
        space.interpolate(path[i - 1], path[i], std::min(1.0, ahead / leg), q);
        return q;
      }
      ahead -= leg;
    }
    const View end = path.back();
    return {end.begin(), end.end()};
  }

  /// q if valid, else the first valid sample in shells of increasing radius about q.
  std::optional<Configuration> near(const Configuration& q) {
    Instance& instance = context_.instance;
    if (instance.space.contains(q) && instance.valid(q)) return q;
    constexpr int rings = 8;
    constexpr int each = 8;
    const double reach = characteristic_length(instance);
    Stream stream(run_.seed, level_.record().key, fmt::format("sub-goal {}", tries_));
    Configuration at(q.size());
    Configuration away(q.size());
    for (int ring = 1; ring <= rings; ++ring) {
      for (int i = 0; i < each; ++i) {
        instance.space.sample_uniform(stream, away);
        const double distance = instance.space.distance(q, away);
        if (distance <= 0.0) continue;
        instance.space.interpolate(q, away, std::min(1.0, reach * ring / rings / distance), at);
        if (instance.space.contains(at) && instance.valid(at)) return at;
      }
    }
    return {};
  }

  Outcome candidate(View q) {
    Instance& instance = context_.instance;
    Candidates& of = *candidates_;
    ++of.drawn;
    Outcome outcome;
    outcome.proposal = q;
    const double to_goal = instance.to_goal(q);
    const double to_start = instance.space.distance(q, instance.start);
    if (std::min(to_goal, to_start) > instance.goal_tolerance) {
      if (instance.valid(q)) {
        ++of.valid;
        if (!of.best || std::max(to_goal, to_start) < of.shortest) {
          of.shortest = std::max(to_goal, to_start);
          of.best.emplace(q.begin(), q.end());
        }
      } else {
        outcome.blocked_at = q;
      }
    }
    return outcome;
  }

  void absorb_half(const Level& half) {
    absorb(half.record().search, context_.search);
    level_.ledger().note_absorbed(half.record().search.proposals.size());
  }

  /// Begins the search of a half.
  std::optional<Status> begin_half() {
    auto half = std::make_unique<Instance>(context_.instance);
    half->checks = {};
    // The second half starts where the first one ended, within the goal tolerance of the sub-goal.
    if (number_ == 0) {
      half->goals = {sub_goal_};
    } else {
      const View reached = whole_.path.back();
      half->start.assign(reached.begin(), reached.end());
    }
    levels_.push_back(std::make_unique<Level>(run_, &level_,
                                              fmt::format("{}/{}.{}", level_.record().key, tries_, number_),
                                              names[number_], std::move(half), planner_.half(), lift_));
    Level& level = *levels_.back();
    if (guide_ != nullptr) level.guide_by(*guide_);
    Budget allowed = left(budget_);
    allowed.proposals = std::min(allowed.proposals, static_cast<double>(settings_.effort));
    if (allowed.proposals <= 0.0 || allowed.checks <= 0.0 || allowed.seconds <= 0.0) return end_try();
    level.limit(allowed);
    half_ = &level;
    return std::nullopt;
  }

  static constexpr std::array<const char*, 2> names = {"first half", "second half"};

  Run& run_;
  Level& level_;
  PlannerSpec planner_;
  const GuideSpec* guide_;
  SplitSettings settings_;
  std::shared_ptr<Guide> lift_;
  std::vector<std::unique_ptr<Level>> levels_;    ///< of all tries; their records are taken after the run
  std::unique_ptr<Planner> undivided_;            ///< after the last try
  DividingPlanner* undivided_divides_ = nullptr;  ///< if it divides too
  Configuration sub_goal_;
  std::size_t number_ = 0;                ///< of the half that is searched
  Level* half_ = nullptr;                 ///< its search
  Solution whole_;                        ///< of the halves that were solved
  std::optional<Status> limit_;           ///< reached before the halves were searched
  Budget budget_;                         ///< of this solve
  std::optional<Candidates> candidates_;  ///< for the sub-goal of this try, while they are drawn
  std::optional<Solution> found_;         ///< the solution of both halves
  Checks halves_;
  double seconds_ = 0.0;
  std::int64_t tries_ = 0;
  bool ends_checked_ = false;
};

}  // namespace

std::unique_ptr<DividingPlanner> make_split_search(Run& run, Level& level, const PlannerSpec& planner,
                                                   const GuideSpec* guide, PlannerContext context) {
  return std::make_unique<SplitSearch>(run, level, planner, guide, std::move(context));
}

}  // namespace trellis
