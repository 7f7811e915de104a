// SPDX-License-Identifier: GPL-3.0-or-later
// Distributions that a script makes and h is put together from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/custom.hpp>
#include <trellis/guide/path_guide.hpp>

namespace trellis {

/// A distribution over a space. By itself a guide with S = {0}.
class Piece : public CustomGuide {
 public:
  using CustomGuide::CustomGuide;
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite& site) const final;
  /// Over the space of an instance. Throws Error where it does not lie in it.
  /// \param reached  the nodes of who draws from it, the start at least; outlives what is made
  [[nodiscard]] virtual std::unique_ptr<Heuristic> over(Instance& instance, const NearestIndex& reached) const = 0;
};

/// The options of `along`.
const Settings<PathGuideSettings>& along_settings();

/// Along a path; uniform where that has fewer than two points, as nothing was found to go by.
/// \param path  configurations of as many coordinates each
std::shared_ptr<const Piece> along(Configurations path, const Options& options);
/// Uniform on the ball about a configuration, metres of the metric.
std::shared_ptr<const Piece> ball(Configuration centre, double radius);

/// A weighted sum of heuristics; stale where one of them is.
class SumHeuristic final : public Heuristic {
 public:
  struct Part {
    double weight = 1.0;
    std::unique_ptr<Heuristic> heuristic;
  };
  /// \param parts  at least one
  SumHeuristic(std::string source, std::vector<Part> parts);

  void select_tree(TreeSide side) override;
  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint32_t vertex() const override { return parts_[drawn_].heuristic->vertex(); }
  [[nodiscard]] bool worth_connecting(View from, View to) const override {
    return parts_[drawn_].heuristic->worth_connecting(from, to);
  }
  [[nodiscard]] double progress() const override;
  [[nodiscard]] double connected() const override;
  /// The least of what the parts say.
  [[nodiscard]] double edge_factor(View a, View b) const override;
  void restart() override;
  void found(double length) override;
  [[nodiscard]] double density(View q) const override;
  [[nodiscard]] double atom_mass() const override;
  [[nodiscard]] std::uint64_t epoch() const override;
  void record(DensityRecord& record, double share) const override;
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }
  [[nodiscard]] bool stale() const override;
  [[nodiscard]] Configurations lifted_path() const override;

 private:
  std::string source_;
  std::vector<Part> parts_;  ///< weights add up to 1
  std::size_t drawn_ = 0;
};

}  // namespace trellis
