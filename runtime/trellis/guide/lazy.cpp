// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <unordered_map>
#include <utility>

#include <trellis/guide/path_guide.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/planner/common.hpp>

namespace trellis {

namespace {

struct LazySettings : PathGuideSettings {
  LazySettings() { follow = Follow::waypoints; }
  double margin = 0.0;
  double sparse = 0.0;
  LazyEvaluation::Selector selector = LazyEvaluation::Selector::alternate;
  LazyEvaluation::Event event = LazyEvaluation::Event::shortest_path;
  std::int64_t depth = 3;
  double existence = 0.5;
  double lambda = 0.99;
};

const Settings<LazySettings>& lazy_settings() {
  static const Settings<LazySettings> settings = with_path_options(
      Settings<LazySettings>(
          Component::Kind::guide, "lazy",
          "the world without obstacle checks: everything is presumed valid; the path found is validated in C, edge by "
          "edge, and what is found invalid is taken out of S, whose search continues",
          "Bohlin and Kavraki 2000, Path planning using lazy PRM; edge selectors: Dellin and Srinivasa 2016, Lazy "
          "shortest paths (LazySP); events: Mandalika, Choudhury, Salzman and Srinivasa 2019, Generalized lazy search "
          "(GLS); effort: Dellin 2016 (LEMUR); first a sparse check: Strub and Gammell 2022, EIT*")
          .choice(
              "selector", &LazySettings::selector,
              {{"alternate", LazyEvaluation::Selector::alternate},
               {"forward", LazyEvaluation::Selector::forward},
               {"backward", LazyEvaluation::Selector::backward},
               {"fail_fast", LazyEvaluation::Selector::fail_fast}},
              "order in which the edges of a candidate path are validated: \"alternate\", from both ends inwards; "
              "\"forward\", from the start; \"backward\", from the goal; \"fail_fast\", the longest first, which is "
              "the least likely to be valid")
          .choice("event", &LazySettings::event,
                  {{"shortest_path", LazyEvaluation::Event::shortest_path},
                   {"constant_depth", LazyEvaluation::Event::constant_depth},
                   {"heuristic_progress", LazyEvaluation::Event::heuristic_progress},
                   {"subpath_existence", LazyEvaluation::Event::subpath_existence}},
                  "when a search of a roadmap in S stops to have edges validated: \"shortest_path\", at the shortest "
                  "path to the goal (LazySP); \"constant_depth\", where a shortest subpath has `depth` edges that were "
                  "not validated (LRA*); \"heuristic_progress\", at a vertex nearer to the goal than the end of any "
                  "subpath that was validated; \"subpath_existence\", where a shortest subpath is valid with a "
                  "probability less than `existence`. Later events validate fewer edges and expand more vertices; the "
                  "path found costs the same. Without effect where a tree searches S")
          .integer("depth", &LazySettings::depth, "edges", Range::at_least(1),
                   "of \"constant_depth\": edges of a subpath that were not validated when the search stops")
          .number(
              "existence", &LazySettings::existence, "probability",
              {.lo = 0, .hi = 1, .open_lo = true, .open_hi = true},
              "of \"subpath_existence\": the probability below which the search stops. A motion of length l is valid "
              "with the probability exp(-l / m), m the mean length validated for each motion found invalid")
          .number(
              "effort", &LazySettings::lambda, "share", {.lo = 0, .hi = 1, .open_hi = true},
              "lambda: share of the effort to validate an edge in its cost for a search of a roadmap in S; the rest "
              "is its length. An edge validated before has no effort. Without effect where a tree searches S")
          .number("sparse", &LazySettings::sparse, "m in the metric", Range::non_negative(),
                  "distance between single configurations of a candidate path that are checked before its edges are, "
                  "once a candidate was refuted; "
                  "0: 1.2 of the planner's step, or the diameter of the robot's bounding circle where that is more")
          .number("margin", &LazySettings::margin, "m in the metric", Range::non_negative(),
                  "least radius about a configuration found invalid that is invalid in S too; 0: the checking "
                  "resolution. Where the checker computes a penetration depth, the radius is that depth"));
  return settings;
}

/// Presumed validity: every configuration is valid, except those near a configuration that C found invalid. Makes no
/// collision checks.
class PresumedValidity final : public EvaluatedValidity {
 public:
  /// \param verified  edges of this space that were found valid in C
  /// \param checking  in C
  PresumedValidity(const Space& space, double margin, double effort, std::shared_ptr<const VerifiedMotions> verified,
                   std::shared_ptr<Validity> checking)
      : unverified_(1.0 / (1.0 - effort)), verified_(std::move(verified)), checking_(std::move(checking)) {
    for (double radius = margin; sizes_.size() < sizes; radius *= 2.0) sizes_.emplace_back(space, radius);
  }

  /// Excludes a ball from the space.
  /// \param radius  about q, in metres in the metric; every configuration within it is known to be invalid
  void forbid(View q, double radius) {
    std::size_t size = 0;
    while (size + 1 < sizes && sizes_[size + 1].radius() <= radius) ++size;
    for (std::size_t k = size; k < sizes; ++k) {
      if (sizes_[k].contains(q)) return;
    }
    Counts counts{};
    for (std::size_t k = 0; k < sizes; ++k) counts[k] = static_cast<std::uint32_t>(sizes_[k].size());
    counts_.push_back(counts);
    sizes_[size].add(q);
  }

  [[nodiscard]] bool state(View q) override {
    return std::none_of(sizes_.begin(), sizes_.end(), [&](const auto& balls) { return balls.contains(q); });
  }
  [[nodiscard]] MotionReport motion(View a, View b) override { return outside(a, b, {}); }
  /// Balls are only added, so a motion that entered none of the earlier ones is compared with the later ones alone: a
  /// search that is repaired asks for the motions of its tree again and again.
  [[nodiscard]] MotionReport motion_still_valid(View a, View b, std::uint64_t since) override {
    if (since < counts_.size()) return outside(a, b, counts_[since]);
    return {true, 0, std::numeric_limits<double>::quiet_NaN()};
  }
  [[nodiscard]] double clearance(View) override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] double effort_factor(View a, View b) const override {
    return verified_->contain(a, b) ? 1.0 : unverified_;
  }
  [[nodiscard]] bool spends_checks() const override { return false; }
  [[nodiscard]] const CheckCost& cost() const override { return checking_->cost(); }
  [[nodiscard]] std::shared_ptr<Validity> checking() const override { return checking_; }
  /// All configurations within a ball are invalid, so another space that presumes this one valid may exclude the same
  /// ball.
  [[nodiscard]] double invalid_radius(View q) override {
    double radius = 0.0;
    for (const auto& balls : sizes_) radius = std::max(radius, balls.depth(q));
    return radius;
  }
  [[nodiscard]] std::uint64_t epoch() const override { return counts_.size(); }
  [[nodiscard]] EdgeEvaluator* evaluator() override { return evaluator_; }
  /// \param evaluator  outlives every search
  void evaluate_by(EdgeEvaluator& evaluator) { evaluator_ = &evaluator; }

 private:
  static constexpr std::size_t sizes = 6;
  using Counts = std::array<std::uint32_t, sizes>;

  /// Compares the motion with the balls of each size from these numbers on.
  [[nodiscard]] MotionReport outside(View a, View b, const Counts& first) {
    for (std::size_t k = 0; k < sizes; ++k) {
      if (const auto t = sizes_[k].entered(a, b, first[k])) return {false, 0, *t};
    }
    return {true, 0, std::numeric_limits<double>::quiet_NaN()};
  }

  double unverified_;
  std::shared_ptr<const VerifiedMotions> verified_;
  std::shared_ptr<Validity> checking_;
  std::vector<ExcludedBalls> sizes_;  ///< in order of radius, each twice the radius before it
  std::vector<Counts> counts_;        ///< for each ball in the order added: the number of balls of each size before it
  EdgeEvaluator* evaluator_ = nullptr;
};

LazyEvaluation evaluation_of(const LazySettings& settings) {
  LazyEvaluation how;
  how.event = settings.event;
  how.depth = settings.depth;
  how.existence = settings.existence;
  how.selector = settings.selector;
  return how;
}

class Lazy final : public PathGuide, public SpendsParentsChecks, private EdgeEvaluator {
 public:
  explicit Lazy(const LazySettings& settings)
      : PathGuide("lazy", settings), settings_(settings), how_(evaluation_of(settings)) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    verified_ = std::make_shared<VerifiedMotions>();
    verified_->hold_at(parent.epoch());
    evaluated_ = std::make_shared<VerifiedMotions>();
    evaluated_->hold_at(parent.epoch());
    // The guide of the search of S may also verify motions.
    instance->verified = verified_;
    // In a changed world, configurations that were invalid may be valid.
    validity_ = std::make_shared<PresumedValidity>(parent.space, margin(parent), settings_.lambda, evaluated_,
                                                   checking(parent.validity));
    found_invalid_ = Configurations(parent.space.dimension());
    left_.emplace(parent.space, parent.position_axes, 0.5 * characteristic_length(parent));
    checked_ = parent.validity;
    margin_ = margin(parent);
    instance->validity = validity_;
    return instance;
  }

  /// Lets the search of a roadmap in S evaluate the edges of its candidate paths.
  void attach_parent(Instance& parent, bool guided) override {
    parent_ = &parent;
    guided_ = guided;
    validity_->evaluate_by(*this);
  }

  /// Validates the candidate path in C. An invalid edge refutes it.
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    parent_ = &parent;
    hold();
    const bool holds = !found->solved() || (leaves() && only_path()) || validated(found->path);
    auto h = PathGuide::heuristic(parent, sub, found);
    if (!holds && path_heuristic() != nullptr) path_heuristic()->refute();
    return h;
  }

  Configurations take_found_invalid() override {
    return std::exchange(found_invalid_, Configurations(found_invalid_.dimension()));
  }

  /// Excludes configurations that C found invalid elsewhere from S.
  void learn(const Outcome& outcome) override {
    PathGuide::learn(outcome);
    if (outcome.blocked_at.empty()) return;
    forbid(outcome.blocked_at);
    found_invalid_.push(outcome.blocked_at);
  }

 protected:
  /// If the planner in C could not pass an invalid part of a candidate path, S excludes the whole place.
  [[nodiscard]] bool excludes() const override { return parent_ == nullptr || leaves(); }
  /// Waypoints require a path that was validated completely.
  [[nodiscard]] Follow follow() const override {
    return leaves() && path_settings().follow == Follow::waypoints ? Follow::steps : path_settings().follow;
  }
  /// Divides the path into the steps that were validated.
  Configurations followed(Configurations path) const override {
    if (parent_->step <= 0.0) return path;
    const Space& space = parent_->space;
    Configurations steps(path.dimension());
    steps.push(path.front());
    Configuration from;
    Configuration to;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const View b = std::as_const(path)[i];
      from.assign(std::as_const(path)[i - 1].begin(), std::as_const(path)[i - 1].end());
      to.resize(from.size());
      while (!steer(space, from, b, space.distance(from, b), parent_->step, to)) {
        steps.push(to);
        std::swap(from, to);
      }
      steps.push(b);
    }
    return steps;
  }

 private:
  [[nodiscard]] double margin(const Instance& parent) const {
    return settings_.margin > 0.0 ? settings_.margin : parent.resolution;
  }

  /// Sets the epoch of the verified motions to the parent's.
  void hold() {
    parent_->verified = verified_;
    verified_->hold_at(parent_->epoch());
    evaluated_->hold_at(parent_->epoch());
  }

  /// Excludes from S the region about q that is known to be invalid, after C found q invalid.
  void forbid(View q) {
    validity_->forbid(q, std::max(margin_, checked_->invalid_radius(q)));
    if (leaves()) left_->add(q);
  }

  [[nodiscard]] const LazyEvaluation& how() const override { return how_; }
  std::uint64_t begin() override {
    evaluates_ = true;
    hold();
    evaluations_ = 0;
    checks_begun_ = parent_->checks.validity;
    return parent_->epoch();
  }
  /// A search stops soon after it has spent the least slice, so that its caller can check the limits.
  [[nodiscard]] bool exhausted() const override {
    constexpr std::uint64_t most = 64;
    return evaluations_ + (parent_->checks.validity - checks_begun_) >= most;
  }
  /// Sparse validation starts with the first refutation: the first candidate is probably valid if a guide guides the
  /// search of S; else nothing is known about it.
  [[nodiscard]] bool sparse_first() const override { return refuted_; }

  [[nodiscard]] bool state(View q) override {
    ++evaluations_;
    if (parent_->valid(q)) return true;
    refuted_ = true;
    forbid(q);
    return false;
  }

  [[nodiscard]] MotionReport sparsely(View a, View b) override {
    const auto pieces = static_cast<std::size_t>(parent_->space.distance(a, b) / sparse());
    Configuration q(a.size());
    for (std::size_t k = 1; k < pieces; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(pieces);
      parent_->space.interpolate(a, b, t, q);
      if (!state(q)) return {false, 0, t};
    }
    return {true, 0, std::numeric_limits<double>::quiet_NaN()};
  }

  /// Validates a motion of S in the steps that a planner in C will take. C need not check these steps again.
  [[nodiscard]] MotionReport motion(View a, View b) override {
    ++evaluations_;
    const Space& space = parent_->space;
    const double length = space.distance(a, b);
    // Steps below the resolution would only cost memory.
    const double step = parent_->step > 0.0 ? std::max(parent_->step, parent_->resolution) : length;
    from_.assign(a.begin(), a.end());
    to_.resize(a.size());
    for (double left = length;; left = space.distance(from_, b)) {
      const bool last = steer(space, from_, b, left, step, to_);
      MotionReport report = parent_->motion(from_, to_);
      if (!report.valid) {
        refuted_ = true;
        Configuration q(a.size());
        space.interpolate(from_, to_, report.invalid_at, q);
        forbid(q);
        if (length > 0.0) {
          report.invalid_at = std::clamp(1.0 - (left - report.invalid_at * std::min(left, step)) / length, 0.0, 1.0);
        }
        return report;
      }
      verified_->add(from_, to_);
      if (last) break;
      std::swap(from_, to_);
    }
    evaluated_->add(a, b);
    return {true, 0, std::numeric_limits<double>::quiet_NaN()};
  }

  [[nodiscard]] double sparse() const {
    return settings_.sparse > 0.0 ? settings_.sparse : 2.0 * sparse_spacing(*parent_);
  }

  /// The edges of a path in the order of the edge selector.
  [[nodiscard]] std::vector<std::size_t> selected(const Configurations& path) const {
    const std::size_t edges = path.size() - 1;
    std::vector<std::size_t> order(edges);
    for (std::size_t i = 0; i < edges; ++i) {
      switch (how_.selector) {
        case LazyEvaluation::Selector::alternate: order[i] = i % 2 == 0 ? i / 2 : edges - 1 - i / 2; break;
        case LazyEvaluation::Selector::backward: order[i] = edges - 1 - i; break;
        case LazyEvaluation::Selector::forward:
        case LazyEvaluation::Selector::fail_fast: order[i] = i; break;
      }
    }
    if (how_.selector == LazyEvaluation::Selector::fail_fast) {
      const auto length = [&](std::size_t i) { return parent_->space.squared_distance(path[i], path[i + 1]); };
      std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return length(i) > length(j); });
    }
    return order;
  }

  /// Whether the planner in C searches for a motion around the invalid part of a candidate path. This is so if a tree
  /// in S follows a guide: to exclude the small balls that a checker proves invalid one by one, the tree would need a
  /// new path around each ball; the planner in C either makes progress there or refutes the whole place.
  [[nodiscard]] bool leaves() const { return guided_ && !evaluates_; }

  /// Validates the edges of a path in the order of the edge selector, first sparsely, and excludes the first
  /// configuration found invalid. Checks no edge again that was found valid. If the planner in C searches around
  /// invalid parts (`leaves`), validation continues with the other edges and skips those through earlier invalid
  /// places.
  bool validated(const Configurations& path) {
    const double spacing = sparse();
    const auto order = selected(path);
    Configuration q(path.dimension());
    std::array<double, 2> walked = {0.0, 0.0};  // distance since the last checked configuration, from either end
    for (const bool whole : {false, true}) {
      if (!whole && (!sparse_first() || leaves())) continue;
      for (const std::size_t i : order) {
        const View a = path[i];
        const View b = path[i + 1];
        if (evaluated_->contain(a, b)) continue;
        if (whole) {
          if (left_->entered(a, b) || motion(a, b).valid || leaves()) continue;
          return false;
        }
        // The ends of the path are valid.
        const bool second = how_.selector == LazyEvaluation::Selector::alternate && 2 * i >= path.size() - 1;
        double& since = walked[second ? 1 : 0];
        const double length = parent_->space.distance(a, b);
        for (; since + length >= spacing; since -= spacing) {
          parent_->space.interpolate(a, b, std::clamp((spacing - since) / length, 0.0, 1.0), q);
          if (!state(q)) return false;
        }
        since += length;
      }
    }
    return true;
  }

  LazySettings settings_;
  LazyEvaluation how_;
  Instance* parent_ = nullptr;
  bool guided_ = false;                         ///< a guide guides the search of S
  bool evaluates_ = false;                      ///< the search of S evaluates the edges of its candidate paths
  bool refuted_ = false;                        ///< part of a candidate path was found invalid
  std::uint64_t evaluations_ = 0;               ///< since the last start of the evaluation
  std::uint64_t checks_begun_ = 0;              ///< checks of C at that time
  std::shared_ptr<Validity> checked_;           ///< validity in C
  std::shared_ptr<VerifiedMotions> verified_;   ///< motions of C: edges, in steps of C's planner
  std::shared_ptr<VerifiedMotions> evaluated_;  ///< edges of S that are valid in C
  Configurations found_invalid_;                ///< not yet passed to the guide of S
  std::optional<Places> left_;                  ///< places that the planner in C searches around
  double margin_ = 0.0;
  std::shared_ptr<PresumedValidity> validity_;
  Configuration from_;  ///< the step that `motion` validates
  Configuration to_;
};

}  // namespace

GuideKind lazy_kind() {
  GuideClaims claims = path_claims(
      GuideClaims::Category::environment, "q -> q; every configuration is presumed valid",
      "they are presumed valid, until C finds an invalid configuration within `margin` of them", "examples/nested.lua");
  claims.feedback =
      "edges of the path found in S are validated in C before it guides, once, and count as checks of C; "
      "configurations "
      "that C finds invalid, there or by proposals, become invalid in S, whose search continues where the path was "
      "refuted. Where a tree follows a guide in S, an invalid edge refutes no candidate: the planner in C searches for "
      "a path there, and `evidence` blocked proposals make the place invalid in S";
  return GuideKind{
      &lazy_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Lazy>(lazy_settings().read(o)); },
      "lazy_prm",
      [](const Options& o) { return lazy_settings().read(o).resolves; },
      std::move(claims),
      false,
      // A tree follows its guide; a roadmap would find shortcuts. Unguided proposals would pass through obstacles,
      // because every configuration is presumed valid.
      {"rrt", {{"goal_bias", 0.0}, {"uniform", 0.0}, {"bound", 0.0}}}}
      .set_up({.run = {80}}, {.run = {130}});
}

}  // namespace trellis
