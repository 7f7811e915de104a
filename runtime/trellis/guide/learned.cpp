// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/memory/model.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

struct LearnedSettings {
  std::string model = "learned.model";
  double sharpness = 1.0;
};

const Settings<LearnedSettings>& learned_settings() {
  static const Settings<LearnedSettings> settings =
      Settings<LearnedSettings>(
          Component::Kind::guide, "learned",
          "cells of the workspace by the probability that a near-optimal path leads through them, which a classifier "
          "trained on other worlds predicts once, before the search; S = {0}",
          "after Ichter, Harrison and Pavone 2018, Learning sampling distributions for robot motion planning")
          .file("model", &LearnedSettings::model, "the classifier, as trellis experience --data makes it")
          .number("sharpness", &LearnedSettings::sharpness, "exponent", Range::non_negative(),
                  "power of the probabilities that cells are drawn by; 0: free cells evenly, above 1: the likely ones "
                  "more often than the model says")
          .positional({"model"});
  return settings;
}

/// Cells of the plane with a probability each; uniform within a cell and in all other coordinates.
class CellDensity final : public Density {
 public:
  /// \param weights  of the grid's cells; at least one is positive
  CellDensity(const Instance& instance, const WorldGrid& grid, const std::vector<double>& weights)
      : space_(instance.space), x_(instance.position_axes[0]), y_(instance.position_axes[1]), grid_(grid) {
    double sum = 0.0;
    until_.reserve(weights.size());
    for (const double w : weights) until_.push_back(sum += w);
    const auto& axes = space_.axes();
    // The volume of a cell times that of all other coordinates, in metric coordinates.
    const double share = grid_.width() * grid_.height() / (axes[x_].period() * axes[y_].period());
    const double volume = share * std::exp(space_.log_volume());
    density_.reserve(weights.size());
    for (const double w : weights) density_.push_back(w / sum / volume);
  }

  [[nodiscard]] double at(View q) const override { return density_[grid_.at({q[x_], q[y_]})]; }

  void sample(Stream& stream, MutableView out) const {
    space_.sample_uniform(stream, out);
    const double u = stream.uniform() * until_.back();
    const auto found = std::upper_bound(until_.begin(), until_.end(), u);
    const auto cell = static_cast<std::size_t>(std::min(found, std::prev(until_.end())) - until_.begin());
    const Vec2 corner = grid_.corner(cell);
    out[x_] = corner.x + grid_.width() * stream.uniform();
    out[y_] = corner.y + grid_.height() * stream.uniform();
    space_.reflect(out);
  }

 private:
  Space space_;
  std::size_t x_;
  std::size_t y_;
  WorldGrid grid_;
  std::vector<double> until_;  ///< cumulative weights, inclusive
  std::vector<double> density_;
};

class LearnedHeuristic final : public Heuristic {
 public:
  explicit LearnedHeuristic(std::shared_ptr<const CellDensity> cells) : cells_(std::move(cells)) {}
  Source sample(Stream& stream, MutableView out) override {
    cells_->sample(stream, out);
    return 0;
  }
  void record(DensityRecord& record, double share) const override { record.add(cells_, share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"learned"}; }

 private:
  std::shared_ptr<const CellDensity> cells_;
};

class Learned final : public SamplingGuide {
 public:
  explicit Learned(LearnedSettings settings) : settings_(std::move(settings)) {}

  void prepare(const Instance& parent) override {
    if (parent.position_axes.size() != 2) {
      throw Error(fmt::format("learned: needs {}; this space ({}) has no position",
                              to_string(GuideClaims::Needs::position_axes), parent.space.name()));
    }
    model_ = known_model(settings_.model);
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    if (!model_) return std::make_unique<UniformHeuristic>("learned (no model)", parent.space);
    const auto& x = parent.space.axes()[parent.position_axes[0]];
    const auto& y = parent.space.axes()[parent.position_axes[1]];
    const WorldGrid grid(planar(*parent.scene).world, Box2{{x.lo, y.lo}, {x.hi, y.hi}}, model_->cells());
    const auto position = [&](const Configuration& q) {
      return Vec2{q[parent.position_axes[0]], q[parent.position_axes[1]]};
    };
    // A cell's weight is the probability of the goal for which it is the likeliest.
    std::vector<double> weights = model_->probabilities(grid, position(parent.start), position(parent.goal()));
    for (std::size_t i = 1; i < parent.goals.size(); ++i) {
      const auto other = model_->probabilities(grid, position(parent.start), position(parent.goals[i]));
      for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = std::max(weights[k], other[k]);
    }
    bool any = false;
    for (double& w : weights) {
      w = w > 0.0 ? std::pow(w, settings_.sharpness) : 0.0;
      any = any || w > 0.0;
    }
    if (!any) return std::make_unique<UniformHeuristic>("learned (no free cell)", parent.space);
    return std::make_unique<LearnedHeuristic>(std::make_shared<const CellDensity>(parent, grid, weights));
  }

 private:
  LearnedSettings settings_;
  std::shared_ptr<const Model> model_;
};

}  // namespace

GuideKind learned_kind() {
  return GuideKind{
      &learned_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Learned>(learned_settings().read(o)); },
      "",
      [](const Options&) { return std::int64_t{0}; },
      {.category = GuideClaims::Category::experience,
       .f = "S = {0}; the classifier reads the workspace as a grid",
       .h = "a free cell of the workspace by the probability that a near-optimal path leads through it, then "
            "uniform within the cell and in all that is not position",
       .closed_form = true,
       .density = "of the mixture of cells",
       .feedback = "none",
       .relaxes = true,
       .invalid_ends = "nothing is projected",
       .fallback = GuideClaims::Fallback::none,
       .no_path = "nothing is searched",
       .example = "examples/real/learned.lua",
       .needs = GuideClaims::Needs::position_axes}}
      .set_up({.run = {450000}}, {.run = {450000}});
}

}  // namespace trellis
