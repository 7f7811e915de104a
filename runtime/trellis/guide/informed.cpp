// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <trellis/guide/bias.hpp>
#include <trellis/guide/kernels.hpp>

namespace trellis {

namespace {

/// Limit of the hyperspheroids' volume, as a multiple of the space's.
constexpr double most_reflections = 64.0;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct InformedSettings {
  double cost = infinity;
};

const Settings<InformedSettings>& informed_settings() {
  static const Settings<InformedSettings> settings =
      Settings<InformedSettings>(
          Component::Kind::guide, "informed",
          "only what a path shorter than the best one known may pass through: a prolate hyperspheroid about start and "
          "goal, one for each goal; uniform while no path is known; S = {0}",
          "Gammell, Srinivasa and Barfoot 2014, Informed RRT*")
          .number("cost", &InformedSettings::cost, "m in the metric", Range::positive(),
                  "length that paths of interest are below, before one is known; infinite: none");
  return settings;
}

/// Uniform distribution on the configurations with a sum of distances to start and goal of at most a cost. In metric
/// coordinates the set is a prolate hyperspheroid. There is one for each goal, and with periodic axes one for each
/// image of it, that is near enough. Samples beyond a bound of the space are reflected; this brings them nearer to both
/// foci, so they stay inside.
class InformedSet final : public Density {
 public:
  InformedSet(const Space& space, View start, const std::vector<Configuration>& goals, double cost)
      : space_(space), cost_(cost), start_(metric(start)) {
    std::vector<double> difference(start.size());
    std::vector<double> focus(start.size());
    for (const Configuration& goal : goals) {
      space.difference(start, goal, difference);
      for (std::size_t j = 0; j < focus.size(); ++j) focus[j] = start_[j] + space.axes()[j].weight * difference[j];
      add_images(0, focus);
    }
  }

  /// In metric coordinates. Overlaps of hyperspheroids count repeatedly.
  [[nodiscard]] double volume() const { return volume_; }

  void sample(Stream& stream, MutableView out) const {
    double u = stream.uniform() * volume_;
    std::size_t i = 0;
    while (i + 1 < parts_.size() && u >= parts_[i].volume) u -= parts_[i++].volume;
    const Part& part = parts_[i];
    const std::size_t d = out.size();
    // Uniform on the unit ball, stretched; the first axis is mirrored onto the axis through the foci.
    std::vector<double> y(d);
    double squares = 0.0;
    for (double& x : y) {
      x = stream.normal();
      squares += x * x;
    }
    const double radius = std::pow(stream.uniform(), 1.0 / static_cast<double>(d)) / std::sqrt(squares);
    for (std::size_t j = 0; j < d; ++j) y[j] *= radius * (j == 0 ? part.along : part.across);
    double product = 0.0;
    for (std::size_t j = 0; j < d; ++j) product += part.mirror[j] * y[j];
    for (std::size_t j = 0; j < d; ++j) {
      y[j] += part.centre[j] - 2.0 * product * part.mirror[j];
      out[j] = y[j] / space_.axes()[j].weight;
    }
    space_.reflect(out);
  }

  [[nodiscard]] double at(View q) const override {
    std::vector<double> y(q.size());
    double count = 0.0;
    for (const Part& part : parts_) count += images(part, q, 0, y);
    return count / volume_;
  }

 private:
  struct Part {
    std::vector<double> focus;  ///< image of a goal
    std::vector<double> centre;
    std::vector<double> mirror;  ///< normal of the plane whose mirror maps the first axis to the axis through the foci
    std::vector<double> extent;  ///< half width along each axis
    double along = 0.0;          ///< major semi-axis
    double across = 0.0;
    double volume = 0.0;
  };

  [[nodiscard]] std::vector<double> metric(View q) const {
    std::vector<double> y(q.begin(), q.end());
    for (std::size_t j = 0; j < y.size(); ++j) y[j] *= space_.axes()[j].weight;
    return y;
  }

  /// Adds a goal's images along the periodic axes from j on, as far as a path may wrap around.
  void add_images(std::size_t j, std::vector<double>& focus) {
    if (j == focus.size()) {
      add(focus);
      return;
    }
    const Axis& axis = space_.axes()[j];
    if (!axis.periodic) {
      add_images(j + 1, focus);
      return;
    }
    const double first = focus[j];
    const double period = axis.weight * axis.period();
    const auto least = static_cast<std::int64_t>(std::ceil((start_[j] - cost_ - first) / period));
    const auto most = static_cast<std::int64_t>(std::floor((start_[j] + cost_ - first) / period));
    for (std::int64_t k = least; k <= most; ++k) {
      focus[j] = first + static_cast<double>(k) * period;
      add_images(j + 1, focus);
    }
    focus[j] = first;
  }

  void add(const std::vector<double>& focus) {
    const std::size_t d = focus.size();
    double squares = 0.0;
    for (std::size_t j = 0; j < d; ++j) squares += (focus[j] - start_[j]) * (focus[j] - start_[j]);
    const double apart = std::sqrt(squares);
    if (apart >= cost_) return;
    Part part;
    part.focus = focus;
    part.along = 0.5 * cost_;
    part.across = 0.5 * std::sqrt((cost_ - apart) * (cost_ + apart));
    part.volume = std::exp(log_unit_ball(d)) * part.along * std::pow(part.across, static_cast<double>(d - 1));
    part.mirror.assign(d, 0.0);
    for (std::size_t j = 0; j < d; ++j) {
      const double u = apart > 0.0 ? (focus[j] - start_[j]) / apart : (j == 0 ? 1.0 : 0.0);
      part.centre.push_back(0.5 * (start_[j] + focus[j]));
      part.mirror[j] = (j == 0 ? 1.0 : 0.0) - u;
      part.extent.push_back(
          std::sqrt((part.along * part.along - part.across * part.across) * u * u + part.across * part.across));
    }
    double length = 0.0;
    for (const double x : part.mirror) length += x * x;
    if (length > 0.0) {
      for (double& x : part.mirror) x /= std::sqrt(length);
    }
    volume_ += part.volume;
    parts_.push_back(std::move(part));
  }

  /// The number of points of the part that wrapping and reflection map to q. y contains the coordinates before j of one
  /// such point.
  [[nodiscard]] double images(const Part& part, View q, std::size_t j, std::vector<double>& y) const {
    if (j == q.size()) {
      double to_start = 0.0;
      double to_goal = 0.0;
      for (std::size_t k = 0; k < y.size(); ++k) {
        to_start += (y[k] - start_[k]) * (y[k] - start_[k]);
        to_goal += (y[k] - part.focus[k]) * (y[k] - part.focus[k]);
      }
      return std::sqrt(to_start) + std::sqrt(to_goal) <= cost_ ? 1.0 : 0.0;
    }
    const Axis& axis = space_.axes()[j];
    const double width = axis.weight * (axis.hi - axis.lo);
    const double inside = axis.weight * q[j];
    double count = 0.0;
    const auto copies = [&](double first, double period) {
      const auto least = static_cast<std::int64_t>(std::ceil((part.centre[j] - part.extent[j] - first) / period));
      const auto most = static_cast<std::int64_t>(std::floor((part.centre[j] + part.extent[j] - first) / period));
      for (std::int64_t k = least; k <= most; ++k) {
        y[j] = first + static_cast<double>(k) * period;
        count += images(part, q, j + 1, y);
      }
    };
    if (axis.periodic) {
      copies(inside, width);
    } else {
      copies(inside, 2.0 * width);
      copies(2.0 * axis.weight * axis.lo - inside, 2.0 * width);
    }
    return count;
  }

  Space space_;
  double cost_;
  std::vector<double> start_;
  std::vector<Part> parts_;
  double volume_ = 0.0;
};

/// The same set in a space with rotations, by rejection: the position of a configuration of the set lies in the set of
/// positions, and its rotation is drawn uniformly.
class InformedRotations {
 public:
  InformedRotations(const Instance& instance, double cost)
      : space_(instance.space),
        cost_(cost),
        start_(instance.start),
        goals_(instance.goals),
        flat_("flat factors", flat_axes(space_)),
        positions_(flat_, flat_part(start_), flat_parts(goals_), cost),
        flat_q_(flat_.dimension()) {}

  [[nodiscard]] double volume() const { return positions_.volume(); }
  [[nodiscard]] const Space& flat() const { return flat_; }

  /// Returns whether one of a bounded number of draws lies in the set.
  bool sample(Stream& stream, MutableView out) {
    constexpr int tries = 200;
    for (int i = 0; i < tries; ++i) {
      space_.sample_uniform(stream, out);
      positions_.sample(stream, flat_q_);
      std::size_t at = 0;
      for (const Factor& factor : space_.factors()) {
        if (factor.kind != Factor::Kind::rotation) out[factor.column] = flat_q_[at++];
      }
      const double from_start = space_.distance(out, start_);
      const auto within = [&](const Configuration& goal) { return from_start + space_.distance(out, goal) <= cost_; };
      if (std::any_of(goals_.begin(), goals_.end(), within)) return true;
    }
    return false;
  }

 private:
  static std::vector<Axis> flat_axes(const Space& space) {
    std::vector<Axis> axes;
    for (const Factor& factor : space.factors()) {
      if (factor.kind != Factor::Kind::rotation) axes.push_back(factor.axis);
    }
    return axes;
  }
  [[nodiscard]] Configuration flat_part(View q) const {
    Configuration part;
    for (const Factor& factor : space_.factors()) {
      if (factor.kind != Factor::Kind::rotation) part.push_back(q[factor.column]);
    }
    return part;
  }

  [[nodiscard]] std::vector<Configuration> flat_parts(const std::vector<Configuration>& rows) const {
    std::vector<Configuration> parts;
    parts.reserve(rows.size());
    for (const Configuration& q : rows) parts.push_back(flat_part(q));
    return parts;
  }

  Space space_;
  double cost_;
  Configuration start_;
  std::vector<Configuration> goals_;
  Space flat_;
  InformedSet positions_;
  Configuration flat_q_;
};

class Informed final : public Heuristic {
 public:
  Informed(const Instance& parent, double cost)
      : parent_(parent), uniform_(parent.space), given_(cost), least_(least_bound(parent)) {
    bound(given_);
  }

  Source sample(Stream& stream, MutableView out) override {
    // After a change of validity, the path that gave the bound may be invalid.
    if (found_at_ && *found_at_ != parent_.validity->epoch()) {
      found_at_.reset();
      bound(given_);
    }
    if (rotations_ && rotations_->sample(stream, out)) return 0;
    if (!set_) {
      uniform_.sample(stream, out);
      return 1;
    }
    set_->sample(stream, out);
    return 0;
  }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double share) const override {
    if (rotations_) {
      Heuristic::record(record, share);  // of rejection, no density
    } else if (set_) {
      record.add(set_, share);
    } else {
      uniform_.record(record, share);
    }
  }
  void found(double length) override {
    const bool known = found_at_ && *found_at_ == parent_.validity->epoch();
    if (known && length >= bound_) return;
    found_at_ = parent_.validity->epoch();
    bound(std::min(length, given_));
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"informed", "informed: uniform"}; }

 private:
  /// Lower limit of the cost: below it, the set would be thinner than the resolution of validity checks.
  static double least_bound(const Instance& parent) {
    return std::hypot(parent.to_goal(parent.start), 2.0 * parent.resolution);
  }

  void bound(double cost) {
    ++epoch_;
    bound_ = cost;
    set_.reset();
    rotations_.reset();
    if (cost >= 2.0 * parent_.space.diameter()) return;
    const bool positions = parent_.space.factors().front().kind != Factor::Kind::rotation;
    if (!parent_.space.flat()) {
      if (!positions) return;
      auto set = std::make_unique<InformedRotations>(parent_, std::max(cost, least_));
      if (set->volume() < most_reflections * std::exp(set->flat().log_volume())) rotations_ = std::move(set);
      return;
    }
    auto set = std::make_shared<const InformedSet>(parent_.space, parent_.start, parent_.goals, std::max(cost, least_));
    // A hyperspheroid far larger than the space would require many reflections and exclude nothing.
    if (set->volume() < most_reflections * std::exp(parent_.space.log_volume())) set_ = std::move(set);
  }

  const Instance& parent_;
  UniformGuidance uniform_;
  double given_;  ///< bound before a path is found
  double least_;
  double bound_ = infinity;
  std::optional<std::uint64_t> found_at_;  ///< epoch of validity at which the path of the current bound was found
  std::shared_ptr<const InformedSet> set_;
  std::unique_ptr<InformedRotations> rotations_;  ///< instead, in a space with rotations
  std::uint64_t epoch_ = 0;
};

}  // namespace

GuideKind informed_kind() {
  return sampling_kind(
      informed_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        const double cost = informed_settings().read(o).cost;
        return bias(
            [cost](Instance& parent) -> std::unique_ptr<Heuristic> { return std::make_unique<Informed>(parent, cost); },
            [cost](const Instance& parent) {
              const double straight = parent.to_goal(parent.start);
              if (cost >= straight) return;
              throw Error(
                  fmt::format("informed: option 'cost' is {:g}, and the straight path from start to "
                              "{} is {:g} m in the metric: no path is as short",
                              cost, parent.goals.size() > 1 ? "the nearest goal" : "goal", straight));
            });
      },
      "uniform where start and goal, or any of several goals, are no farther together than the best path known is "
      "long; before one is known, "
      "and where that is all of C, uniform on C",
      "of the hyperspheroids about start and goal, one for each goal and each direction of a periodic axis, reflected "
      "at "
      "the bounds; "
      "none "
      "where the space has rotations, which are drawn by rejection",
      true,
      "after each path found, it draws from the set that a shorter path can pass through; a path that stopped being "
      "valid "
      "is forgotten");
}

}  // namespace trellis
