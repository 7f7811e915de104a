// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/custom.hpp>
#include <trellis/guide/kernels.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/prepared.hpp>

namespace trellis {

/// Charges wall-clock time to the level that is at work: solving a level below stops the clock of the one above.
class Clock {
 public:
  /// Switches to `account`; returns the one before, to switch back to.
  double* switch_to(double* account) {
    const auto now = std::chrono::steady_clock::now();
    if (account_ != nullptr) *account_ += std::chrono::duration<double>(now - since_).count();
    since_ = now;
    return std::exchange(account_, account);
  }

 private:
  double* account_ = nullptr;
  std::chrono::steady_clock::time_point since_;
};

/// What all levels of one run share.
struct Run {
  std::string problem;  ///< its name
  std::uint64_t seed = 0;
  bool seeded = false;  ///< it is run, not only checked
  std::function<bool()> interrupted;
  std::function<void(const LevelRecord&, const Guidance&)> watch;
  Clock clock;
  std::vector<Level*> levels;  ///< in the order of their numbers
  std::vector<Turn> turns;
  Level* at_work = nullptr;
  int first_solves = 0;  ///< levels whose first solve has ended
  RunShared shared;
};

/// What a level's planner draws from: the goal, uniform, the guide, and a path that another space informed it of.
class LevelGuidance final : public Guidance {
 public:
  LevelGuidance(const Instance& instance, const PlannerCommon& common)
      : instance_(instance), common_(common), uniform_(instance.space), goal_(instance) {}

  void set_guide(std::unique_ptr<Prepared> guide) { guide_ = std::move(guide); }
  [[nodiscard]] Prepared* guide() const { return guide_.get(); }
  void inform(const Configurations& path) {
    ++epoch_;
    if (path.empty()) {
      hint_.reset();
      return;
    }
    hint_.emplace(instance_.space, path, natural_distance(instance_));
  }
  [[nodiscard]] bool guided() const { return guide_ != nullptr || hint_; }

  Source sample(Stream& stream, MutableView out) override {
    double u = stream.uniform();
    drawn_ = Part::goal;
    if (u < common_.goal_bias) return goal_.sample(stream, out);
    if (!guided()) {
      drawn_ = Part::uniform;
      uniform_.sample(stream, out);
      return 1;
    }
    u = (u - common_.goal_bias) / (1.0 - common_.goal_bias);
    if (u < common_.uniform) {
      drawn_ = Part::uniform;
      uniform_.sample(stream, out);
      return 1;
    }
    u = (u - common_.uniform) / (1.0 - common_.uniform);
    if (hint_ && (guide_ == nullptr || u < hint_share)) {
      drawn_ = Part::hint;
      hint_->sample(stream, out);
      return 2;
    }
    drawn_ = Part::guide;
    return static_cast<Source>(3 + guide_->sample(stream, out));
  }

  [[nodiscard]] double density(View q) const override {
    const Shares share = shares();
    double sum = share.uniform * uniform_.density(q);
    if (share.hint > 0.0) sum += share.hint * hint_->density(q);
    if (share.guide > 0.0) sum += share.guide * guide_->density(q);
    return sum;
  }
  [[nodiscard]] double atom_mass() const override {
    const Shares share = shares();
    return share.goal + (share.guide > 0.0 ? share.guide * guide_->atom_mass() : 0.0);
  }
  [[nodiscard]] std::uint64_t epoch() const override { return guide_ == nullptr ? epoch_ : epoch_ + guide_->epoch(); }
  void record(DensityRecord& record, double share) const override {
    const Shares of = shares();
    goal_.record(record, share * of.goal);
    uniform_.record(record, share * of.uniform);
    if (of.hint > 0.0) record.add(hint_->density(), share * of.hint);
    if (of.guide > 0.0) guide_->record(record, share * of.guide);
  }

  void observe(const Outcome& outcome, bool mine) override {
    if (guide_ == nullptr) return;
    guide_->observe(outcome, mine && drawn_ == Part::guide);
    guide_->renew();
  }
  void found(double length) override {
    if (guide_ != nullptr) guide_->found(length);
  }

  [[nodiscard]] std::vector<std::string> sources() const override {
    std::vector<std::string> all = {"goal", "uniform", "informed path"};
    if (guide_ != nullptr) {
      for (auto& name : guide_->sources()) all.push_back(std::move(name));
    }
    return all;
  }

 private:
  enum class Part : std::uint8_t { goal, uniform, hint, guide };
  static constexpr double hint_share = 0.5;

  /// The probabilities that `sample` gives the parts.
  struct Shares {
    double goal = 0.0;
    double uniform = 0.0;
    double hint = 0.0;
    double guide = 0.0;
  };
  [[nodiscard]] Shares shares() const {
    const double rest = 1.0 - common_.goal_bias;
    if (!guided()) return {common_.goal_bias, rest, 0.0, 0.0};
    const double guided_share = rest * (1.0 - common_.uniform);
    const double hint = !hint_ ? 0.0 : guide_ == nullptr ? 1.0 : hint_share;
    return {common_.goal_bias, rest * common_.uniform, guided_share * hint, guided_share * (1.0 - hint)};
  }

  const Instance& instance_;
  PlannerCommon common_;
  UniformGuidance uniform_;
  GoalGuidance goal_;
  std::optional<TubeKernel> hint_;
  std::unique_ptr<Prepared> guide_;
  Part drawn_ = Part::goal;
  std::uint64_t epoch_ = 0;  ///< how often the hint changed
};

/// A level's guidance, shown to whoever watches the run each time that it has drawn.
class WatchedGuidance final : public Guidance {
 public:
  WatchedGuidance(const Run& run, const LevelRecord& level, Guidance& h) : run_(run), level_(level), h_(h) {}
  Source sample(Stream& stream, MutableView out) override {
    const Source source = h_.sample(stream, out);
    run_.watch(level_, h_);
    return source;
  }
  [[nodiscard]] double density(View q) const override { return h_.density(q); }
  [[nodiscard]] double atom_mass() const override { return h_.atom_mass(); }
  [[nodiscard]] std::uint64_t epoch() const override { return h_.epoch(); }
  void record(DensityRecord& record, double share) const override { h_.record(record, share); }
  void observe(const Outcome& outcome, bool mine) override { h_.observe(outcome, mine); }
  void found(double length) override { h_.found(length); }
  [[nodiscard]] std::vector<std::string> sources() const override { return h_.sources(); }

 private:
  const Run& run_;
  const LevelRecord& level_;
  Guidance& h_;
};

/// One level at work: an instance, its planner, its guidance and its record.
class Level {
 public:
  /// \param lift  the guide that made the instance from the parent's; nullptr at the root
  Level(Run& run, Level* parent, std::string key, std::string name, std::unique_ptr<Instance> instance,
        const PlannerSpec& planner, std::shared_ptr<const Guide> lift);

  void guide_by(const GuideSpec& spec) {
    guide_spec_ = spec;
    guidance_.set_guide(make_guidance(run_, *this, spec));
  }
  /// Lowers the budget of its planner.
  void limit(const Budget& budget) {
    common_.budget.proposals = std::min(common_.budget.proposals, budget.proposals);
    common_.budget.checks = std::min(common_.budget.checks, budget.checks);
    common_.budget.seconds = std::min(common_.budget.seconds, budget.seconds);
  }

  /// Solves the instance, or solves it again; the instances below are solved first.
  /// \param proposals  that may be spent on it, within the level's budget
  const Solution& solve(double proposals = Budget::unlimited) {
    advance(proposals, false);
    return record_.solution;
  }
  /// The same, where the proposals may be a slice of what will be spent: then each level below has a slice as well, and
  /// a search that a slice ended is unfinished, and goes on when it is called again.
  Advance advance(double proposals, bool slice);

  /// The record, completed once the run is over; given away, but for its key.
  LevelRecord take_record();

  /// Adds time spent for this level outside its solves: making its instance by f.
  void charge(double seconds) { record_.search.seconds += seconds; }

  /// Whether the last solve found a path.
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] Instance& instance() { return *instance_; }
  [[nodiscard]] LevelGuidance& guidance() { return guidance_; }
  [[nodiscard]] const LevelRecord& record() const { return record_; }
  /// The best of what its solves found.
  [[nodiscard]] const Solution& solution() const { return record_.solution; }

 private:
  [[nodiscard]] Advance solve_own(double proposals, bool slice);
  [[nodiscard]] std::unique_ptr<Planner> make_planner();
  /// A level below is asked for its solution in the middle of this one's solve.
  void pause();
  void end_turn(Configurations path, bool solve_ended);
  /// Rows of this level's space lifted to the root's by the chain of h's: each step draws from the fibre.
  [[nodiscard]] Configurations lifted(const Configurations& rows, const std::string& purpose) const;
  /// Whether the density on every fibre between this level's space and the root's is known.
  [[nodiscard]] bool closed_fibres() const;
  /// A density over this level's space as that of what is lifted to the root's: at f of a configuration, times the
  /// density on the fibre. It keeps every f that it needs.
  [[nodiscard]] std::function<double(View)> lifted(std::function<double(View)> density) const;

  Run& run_;
  Level* parent_;
  std::shared_ptr<const Guide> lift_;
  std::unique_ptr<Instance> instance_;
  const PlannerKind& kind_;
  PlannerSpec planner_spec_;
  std::optional<GuideSpec> guide_spec_;
  PlannerCommon common_;
  LevelGuidance guidance_;
  std::optional<WatchedGuidance> watched_;
  std::unique_ptr<Planner> planner_;
  LevelRecord record_;
  std::size_t noted_ = 0;  ///< proposals and nodes when its last turn ended
  bool found_ = false;
};

}  // namespace trellis
