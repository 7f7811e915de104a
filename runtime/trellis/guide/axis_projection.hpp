// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/density.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// f that keeps some axes of a space, with their weights. The fibre is everything else, uniform.
class AxisProjection {
 public:
  /// \param kept  axes of the parent, in the order of S
  /// \param name  of S
  AxisProjection(Space parent, std::vector<std::size_t> kept, std::string name)
      : parent_(std::move(parent)),
        kept_(std::move(kept)),
        space_(std::move(name), axes_of(parent_, kept_)),
        log_fibre_volume_(parent_.log_volume() - space_.log_volume()) {}

  void project(View q, MutableView s) const {
    for (std::size_t j = 0; j < kept_.size(); ++j) s[j] = q[kept_[j]];
  }
  void lift(View s, Stream& stream, MutableView q) const {
    parent_.sample_uniform(stream, q);
    for (std::size_t j = 0; j < kept_.size(); ++j) q[kept_[j]] = s[j];
  }
  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const Space& parent() const { return parent_; }
  [[nodiscard]] const std::vector<std::size_t>& kept() const { return kept_; }
  /// Per volume in metric coordinates of C and S. The weights of what is kept are the same in both; were they not, the
  /// quotient of the volumes would hold the Jacobian too.
  [[nodiscard]] double log_fibre_volume() const { return log_fibre_volume_; }
  /// A path in S with the other coordinates turned evenly from those of `start` to those of `goal`.
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const {
    Configurations result(parent_.dimension());
    Configuration q(parent_.dimension());
    const double length = path_length(space_, path);
    double at = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (i > 0) at += space_.distance(path[i - 1], path[i]);
      parent_.interpolate(start, goal, length > 0.0 ? at / length : 0.0, q);
      for (std::size_t j = 0; j < kept_.size(); ++j) q[kept_[j]] = path[i][j];
      result.push(q);
    }
    return result;
  }

 private:
  static std::vector<Axis> axes_of(const Space& parent, const std::vector<std::size_t>& kept) {
    std::vector<Axis> axes;
    axes.reserve(kept.size());
    for (const std::size_t j : kept) axes.push_back(parent.axes()[j]);
    return axes;
  }

  Space parent_;
  std::vector<std::size_t> kept_;
  Space space_;
  double log_fibre_volume_;
};

/// A density over S with the uniform fibre on it.
class FibredDensity final : public Density {
 public:
  FibredDensity(std::shared_ptr<const AxisProjection> projection, std::shared_ptr<const Density> base)
      : projection_(std::move(projection)), base_(std::move(base)) {}

  [[nodiscard]] double at(View q) const override {
    if (!projection_->parent().contains(q)) return 0.0;
    Configuration s(projection_->space().dimension());
    projection_->project(q, s);
    return base_->at(s) * std::exp(-projection_->log_fibre_volume());
  }
  [[nodiscard]] bool akin(const Density& other) const override {
    const auto* fibred = dynamic_cast<const FibredDensity*>(&other);
    return fibred != nullptr && fibred->projection_ == projection_ && base_->akin(*fibred->base_);
  }
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override {
    std::vector<Term> base;
    base.reserve(terms.size());
    for (const auto& term : terms) {
      base.push_back({dynamic_cast<const FibredDensity&>(*term.density).base_, term.weight});
    }
    return std::make_shared<FibredDensity>(projection_, base_->sum(base));
  }

 private:
  std::shared_ptr<const AxisProjection> projection_;
  std::shared_ptr<const Density> base_;
};

}  // namespace trellis
