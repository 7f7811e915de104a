// SPDX-License-Identifier: GPL-3.0-or-later
// Distributions from which scripts compose h.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/custom.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/planner/composed.hpp>

namespace trellis {

/// A distribution over a space. It is also a guide with S = {0}.
class Piece : public CustomGuide {
 public:
  using CustomGuide::CustomGuide;
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite& site) const final;
  /// Makes the heuristic over the space of an instance.
  /// \param reached  the nodes of the planner that draws from it, with at least the start; outlives the result
  /// \throws Error if the distribution does not lie in the space
  [[nodiscard]] virtual std::unique_ptr<Heuristic> over(Instance& instance, const ReachedIndex& reached) const = 0;
};

/// The options of `along`.
const Settings<PathGuideSettings>& along_settings();

/// A distribution along a path; uniform if the path has fewer than two points.
/// \param path  configurations of equal dimension
std::shared_ptr<const Piece> along(Configurations path, const Options& options);
/// Uniform distribution on the ball about a configuration; radius in metres in the metric.
std::shared_ptr<const Piece> ball(Configuration centre, double radius);

/// A weighted sum of heuristics. It is stale if one of them is.
class SumHeuristic final : public Composed<Heuristic> {
 public:
  struct Part {
    double weight = 1.0;
    std::unique_ptr<Heuristic> heuristic;
  };
  /// \param parts  at least one
  SumHeuristic(std::string source, std::vector<Part> parts);

  Source sample(Stream& stream, MutableView out) override;
  void record(DensityRecord& record, double share) const override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }
  [[nodiscard]] bool stale() const override;
  [[nodiscard]] Configurations lifted_path() const override;

 private:
  [[nodiscard]] std::size_t part_count() const override { return parts_.size(); }
  [[nodiscard]] Guidance* part_at(std::size_t i) const override { return parts_[i].heuristic.get(); }
  [[nodiscard]] Guidance* drew_last() const override { return parts_[drawn_].heuristic.get(); }

  std::string source_;
  std::vector<Part> parts_;  ///< weights add up to 1
  std::size_t drawn_ = 0;
};

}  // namespace trellis
