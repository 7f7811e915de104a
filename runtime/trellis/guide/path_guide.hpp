// SPDX-License-Identifier: GPL-3.0-or-later
// What guides have in common whose space S has the coordinates of C and whose h is a tube about the path found in S.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/guide/kernels.hpp>
#include <trellis/planner/nearest.hpp>

namespace trellis {

struct PathGuideSettings {
  double radius = 0.0;
  double window = 0.2;
  std::int64_t patience = 100;
  std::int64_t resolves = 10;
};

template <class S>
Settings<S> with_path_options(Settings<S> settings) {
  settings
      .number(
          "radius", &S::radius, "m in the metric", Range::non_negative(),
          "radius of the tube about the path that proposals are drawn from; 0: half the robot's bounding radius, or "
          "1 % of the space's diameter for a point")
      .number("window", &S::window, "share of the path", {.lo = 0, .hi = 1, .open_lo = true},
              "how far beyond what the planner has reached proposals are drawn; 1: the whole rest of the path at once")
      .integer("patience", &S::patience, "proposals", Range::at_least(1),
               "guided proposals without progress along the path before its space is solved again")
      .integer("resolves", &S::resolves, "re-solves", Range::non_negative(), "how often its space may be solved again");
  return settings;
}

/// The radius that the option `radius` stands for in an instance.
double tube_radius(const PathGuideSettings& settings, const Instance& instance);

/// h along a path in C: a tube about the stretch of the path just beyond what the planner's nodes have reached.
class PathHeuristic final : public Heuristic {
 public:
  /// \param reached  the planner's nodes so far, for the stretches already covered; nullptr: none
  PathHeuristic(std::string source, const Space& space, Configurations path, double radius, double window,
                std::int64_t patience, const NearestIndex* reached);

  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] double density(View q) const override { return tube_.density(q); }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double share) const override { record.add(tube_.density(), share); }
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }
  [[nodiscard]] bool stale() const override { return stale_; }
  [[nodiscard]] Configurations lifted_path() const override { return tube_.path(); }

  /// The path was found not to hold: it is stale at once.
  void refute() { stale_ = true; }
  [[nodiscard]] double radius() const { return tube_.radius(); }

 private:
  void choose_stretches();
  /// Marks the bins that q reaches; whether any was new.
  bool cover(View q);

  std::string source_;
  Space space_;
  TubeKernel tube_;
  double window_;
  std::int64_t patience_;
  std::int64_t failures_ = 0;
  std::uint64_t epoch_ = 0;  ///< how often stretches were chosen
  bool stale_ = false;
  double bin_ = 0.0;           ///< arc length of one bin
  Configurations centres_;     ///< of the bins
  std::vector<char> covered_;  ///< by the planner's nodes
  std::size_t uncovered_ = 0;
};

/// A uniform h for a space whose search found nothing to go by.
class UniformHeuristic final : public Heuristic {
 public:
  UniformHeuristic(std::string source, const Space& space) : source_(std::move(source)), uniform_(space) {}
  Source sample(Stream& stream, MutableView out) override { return uniform_.sample(stream, out); }
  [[nodiscard]] double density(View q) const override { return uniform_.density(q); }
  void record(DensityRecord& record, double share) const override { uniform_.record(record, share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }

 private:
  std::string source_;
  UniformGuidance uniform_;
};

/// A guide with S = C as metric spaces: f is the identity on configurations.
class PathGuide : public Guide {
 public:
  PathGuide(std::string name, const PathGuideSettings& settings) : name_(std::move(name)), path_settings_(settings) {}

  void project(View q, MutableView s) const override { std::copy(q.begin(), q.end(), s.begin()); }
  void lift(View s, Stream&, MutableView q) const override { std::copy(s.begin(), s.end(), q.begin()); }
  [[nodiscard]] double log_fibre_density(View) const override { return 0.0; }
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override;
  void learn(const Outcome& outcome) override;
  using Guide::project;

 protected:
  /// A copy of the instance with everything but its validity's own state: what f starts from.
  static std::unique_ptr<Instance> same_instance(const Instance& parent);
  /// The heuristic in use; nullptr where nothing was found to go by.
  [[nodiscard]] PathHeuristic* path_heuristic() const { return current_; }

 private:
  std::string name_;
  PathGuideSettings path_settings_;
  PathHeuristic* current_ = nullptr;     ///< the last one made, owned by whoever asked for it
  std::optional<NearestIndex> reached_;  ///< the planner's nodes, made when the space is known
};

}  // namespace trellis
