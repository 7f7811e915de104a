// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

namespace {

/// A mixture whose weights adapt to the results of its parts (BlendSettings).
class BlendGuidance final : public PartsGuidance {
 public:
  BlendGuidance(const BlendSettings& settings, const Instance& instance,
                std::vector<std::unique_ptr<SearchedGuidance>> parts)
      : PartsGuidance(std::move(parts)),
        settings_(settings),
        instance_(instance),
        rule_(settings.credit == "efficiency" ? Rule::efficiency
              : settings.rule == "exp3"       ? Rule::exp3
                                              : Rule::rates),
        credits_nodes_(settings.credit == "node"),
        arms_(parts_.size()),
        ready_(parts_.size(), 1),
        served_(rule_ == Rule::efficiency ? parts_.size() : 0),
        nearest_to_goal_(instance.to_goal(instance.start)),
        nearest_to_start_(nearest_to_goal_) {}
  /// While the space of a part is searched, the other parts share its weight.
  void begin(const Slice& slice) override { turns_.begin(slice, parts_); }
  [[nodiscard]] GuideSearch* needs_search() override {
    if (GuideSearch* next = turns_.needs_search(parts_)) return next;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const char ready = parts_[i]->ready() != Advance::unfinished ? 1 : 0;
      if (ready != std::exchange(ready_[i], ready)) ++changes_;
    }
    return nullptr;
  }
  [[nodiscard]] Advance ready() const override { return turns_.ready(parts_); }
  [[nodiscard]] bool draws_while_searching() const override { return true; }
  Source sample(Stream& stream, MutableView out) override {
    const double total = total_weight();
    double u = stream.uniform();
    drawn_ = 0;
    while (drawn_ + 1 < parts_.size() && u >= share(drawn_, total)) u -= share(drawn_++, total);
    // Rounding may select a part that cannot draw.
    while (ready_[drawn_] == 0) --drawn_;
    const Source source = draw(stream, out);
    for (std::size_t i = 0; i < served_.size(); ++i) {
      if (ready_[i] != 0) served_[i].served(*parts_[i]);
    }
    return source;
  }
  [[nodiscard]] std::uint64_t epoch() const override { return changes_ + PartsGuidance::epoch(); }
  void record(DensityRecord& record, double of) const override {
    const double total = total_weight();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (ready_[i] != 0) parts_[i]->record(record, of * share(i, total));
    }
  }
  void observe(const Outcome& outcome, bool mine) override {
    switch (rule_) {
      case Rule::rates:
        if (mine) count(arms_[drawn_], credit(outcome));
        break;
      case Rule::exp3:
        if (mine) reward(credit(outcome));
        break;
      case Rule::efficiency:
        if (!outcome.added.empty() && is_progress(outcome)) maximise(outcome.added, mine);
        break;
    }
    PartsGuidance::observe(outcome, mine);
  }
  /// The path of the part with the largest weight among those with a path.
  [[nodiscard]] Configurations guiding_path() const override {
    Configurations best;
    double most = -1.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (weight(arms_[i]) <= most) continue;
      Configurations path = parts_[i]->guiding_path();
      if (path.empty()) continue;
      most = weight(arms_[i]);
      best = std::move(path);
    }
    return best;
  }

 private:
  enum class Rule : std::uint8_t { rates, exp3, efficiency };
  struct Arm {
    double successes = 1.0;  ///< for exp3, the weight
    double attempts = 1.0;   ///< used by rates only
  };

  [[nodiscard]] static double weight(const Arm& arm) { return arm.successes / arm.attempts; }
  [[nodiscard]] double total_weight() const {
    double total = 0.0;
    for (std::size_t i = 0; i < arms_.size(); ++i) total += ready_[i] != 0 ? weight(arms_[i]) : 0.0;
    return total;
  }
  /// Number of parts that can draw.
  [[nodiscard]] double ready_count() const { return static_cast<double>(std::count(ready_.begin(), ready_.end(), 1)); }
  /// The probability that part i draws the next proposal.
  /// \param total  sum of the weights of all parts that can draw
  [[nodiscard]] double share(std::size_t i, double total) const {
    if (ready_[i] == 0) return 0.0;
    const double even = 1.0 / ready_count();
    const double follow = total > 0.0 ? weight(arms_[i]) / total : even;
    return settings_.floor * even + (1.0 - settings_.floor) * follow;
  }
  double credit(const Outcome& outcome) {
    if (outcome.added.empty()) return 0.0;
    if (credits_nodes_ || outcome.near.empty()) return 1.0;
    const double length = instance_.space.distance(outcome.near, outcome.added);
    longest_ = std::max(longest_, length);
    return longest_ > 0.0 ? length / longest_ : 0.0;
  }
  void count(Arm& arm, double success) {
    arm.successes = settings_.decay * arm.successes + success;
    arm.attempts = settings_.decay * arm.attempts + 1.0;
    ++changes_;
  }
  /// Updates the weight of the part that drew, by exp3.
  void reward(double r) {
    arms_[drawn_].successes *= std::exp(settings_.floor * r / (ready_count() * share(drawn_, total_weight())));
    // Only the ratios matter; the normalisation avoids overflow.
    double most = 0.0;
    for (const auto& arm : arms_) most = std::max(most, arm.successes);
    for (auto& arm : arms_) arm.successes /= most;
    ++changes_;
  }
  /// Whether the search came nearer to its goal than before.
  bool is_progress(const Outcome& outcome) {
    double& nearest = outcome.from_goal ? nearest_to_start_ : nearest_to_goal_;
    const double distance =
        outcome.from_goal ? instance_.space.distance(outcome.added, instance_.start) : instance_.to_goal(outcome.added);
    if (distance >= nearest) return false;
    nearest = distance;
    return true;
  }
  /// A step of expectation maximisation at a node of T.
  void maximise(View place, bool mine) {
    const double total = total_weight();
    std::vector<double> responsible(arms_.size(), 0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      const double q = served_[i].at(place);
      responsible[i] = std::isnan(q) ? 0.0 : share(i, total) * q;
      sum += responsible[i];
    }
    const bool unknown = mine && std::isnan(served_[drawn_].at(place));
    if (unknown || !(sum > 0.0)) {
      // Without densities, the part that drew the proposal is responsible; proposals of other sources give no
      // information.
      if (!mine) return;
      std::fill(responsible.begin(), responsible.end(), 0.0);
      responsible[drawn_] = 1.0;
    } else {
      for (double& r : responsible) r /= sum;
    }
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      if (ready_[i] != 0) arms_[i].successes = settings_.decay * arms_[i].successes + responsible[i];
    }
    ++changes_;
  }

  AllInTurn turns_;
  BlendSettings settings_;
  const Instance& instance_;
  Rule rule_;
  bool credits_nodes_;  ///< each node earns the same
  std::vector<Arm> arms_;
  std::vector<char> ready_;            ///< whether a part can draw: its space is not being searched
  std::vector<DensityRecord> served_;  ///< density of each part over all proposals; for efficiency only
  double longest_ = 0.0;               ///< longest extension so far
  std::uint64_t changes_ = 0;          ///< number of changes of the weights
  double nearest_to_goal_;             ///< of the nodes reached
  double nearest_to_start_;            ///< of the nodes reached by the tree from the goal
};

}  // namespace

std::unique_ptr<SearchedGuidance> make_blend(const BlendSettings& settings, const Instance& instance,
                                             std::vector<std::unique_ptr<SearchedGuidance>> parts) {
  return std::make_unique<BlendGuidance>(settings, instance, std::move(parts));
}

}  // namespace trellis
