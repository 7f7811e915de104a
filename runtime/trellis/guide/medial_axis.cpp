// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <trellis/guide/bias.hpp>
#include <trellis/guide/rays.hpp>

namespace trellis {

namespace {

struct MedialAxisSettings {
  std::int64_t rays = 8;
  std::int64_t climbs = 3;
  std::int64_t tries = 100;
};

const Settings<MedialAxisSettings>& medial_axis_settings() {
  static const Settings<MedialAxisSettings> settings =
      Settings<MedialAxisSettings>(
          Component::Kind::guide, "medial_axis",
          "uniform configurations moved and turned away from the nearest obstacle until another is as near; invalid "
          "ones are moved out first; S = {0}",
          "Wilmarth, Amato and Stiller 1999, MAPRM: a probabilistic roadmap planner with sampling on the medial axis")
          .integer("rays", &MedialAxisSettings::rays, "rays", {.lo = 2, .hi = 1024},
                   "directions of C in which the nearest surface is searched where a configuration is invalid")
          .integer("climbs", &MedialAxisSettings::climbs, "steps", {.lo = 0, .hi = 1000},
                   "steps of the ascent of clearance in which all coordinates change; 0: the position alone")
          .integer("tries", &MedialAxisSettings::tries, "configurations", Range::at_least(1),
                   "configurations tried, where none can be moved out, before a uniform proposal is made instead");
  return settings;
}

/// Retraction by clearance. First, all coordinates ascend the gradient of clearance until its direction turns with
/// respect to the position: another point of the obstacles is then the nearest. Last, only the position moves onto the
/// medial axis: at fixed angles, a robot's clearance equals the clearance of a point among grown obstacles. So away
/// from the nearest point, clearance grows by one metre per metre up to the axis.
class MedialAxis final : public Heuristic {
 public:
  MedialAxis(Instance& parent, const MedialAxisSettings& settings)
      : parent_(parent),
        settings_(settings),
        ray_(parent),
        from_(parent.space.dimension()),
        probe_(parent.space.dimension()),
        slope_(parent.space.degrees()),
        last_slope_(parent.space.degrees()),
        tangent_(parent.space.degrees()) {}

  Source sample(Stream& stream, MutableView out) override {
    for (std::int64_t i = 0; i < settings_.tries; ++i) {
      parent_.space.sample_uniform(stream, out);
      if (!parent_.valid(out) && !move_out(stream, out)) continue;
      climb(out);
      if (positioned()) retract(out);
      return 0;
    }
    parent_.space.sample_uniform(stream, out);
    return 1;
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"medial_axis", "medial_axis: uniform"}; }

 private:
  /// Whether the space has position axes.
  [[nodiscard]] bool positioned() const { return !parent_.position_axes.empty(); }
  /// Whether a degree of freedom is one of the position. Those of a body in space are its first coordinates.
  [[nodiscard]] bool is_position(std::size_t degree) const {
    const auto& axes = parent_.position_axes;
    return std::find(axes.begin(), axes.end(), degree) != axes.end();
  }

  /// Moves q to the nearest surface on one of several rays: evenly spaced in a plane, else in random directions.
  bool move_out(Stream& stream, MutableView q) {
    std::copy(q.begin(), q.end(), from_.begin());
    const bool planar = parent_.position_axes.size() == 2 && q.size() == 2;
    const double turn = 2.0 * std::numbers::pi / static_cast<double>(settings_.rays);
    const double first = stream.uniform() * turn;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::int64_t i = 0; i < settings_.rays; ++i) {
      if (planar) {
        ray_.set_direction(first + static_cast<double>(i) * turn);
      } else {
        ray_.draw_direction(stream);
      }
      const double distance = ray_.walk(from_, probe_);
      if (distance >= nearest) continue;
      nearest = distance;
      std::copy(probe_.begin(), probe_.end(), q.begin());
    }
    return nearest < std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] double clearance_at(double distance) {
    return ray_.at(from_, distance, probe_) ? parent_.clearance(probe_) : 0.0;
  }

  /// Clearance after a step along a degree of freedom from q, in metres in the metric.
  [[nodiscard]] double clearance_beside(View q, std::size_t axis, double step) {
    if (parent_.space.flat()) {
      std::copy(q.begin(), q.end(), probe_.begin());
      probe_[axis] += step / parent_.space.axes()[axis].weight;
    } else {
      std::fill(tangent_.begin(), tangent_.end(), 0.0);
      tangent_[axis] = step;
      parent_.space.exp(q, tangent_, probe_);
    }
    parent_.space.reflect(probe_);
    return parent_.clearance(probe_);
  }

  /// Computes the gradient of clearance at q in metric coordinates into slope_; returns its norm.
  double measure_slope(View q) {
    const double step = difference_step();
    double squares = 0.0;
    for (std::size_t j = 0; j < slope_.size(); ++j) {
      slope_[j] = (clearance_beside(q, j, step) - clearance_beside(q, j, -step)) / (2.0 * step);
      squares += slope_[j] * slope_[j];
    }
    return std::sqrt(squares);
  }

  /// Whether another point of the obstacles has become the nearest: the direction of the gradient (of its position
  /// part, if there is one) turned by more than 60 degrees.
  [[nodiscard]] bool turned_round() const {
    double product = 0.0, squares = 0.0, last_squares = 0.0;
    for (std::size_t j = 0; j < slope_.size(); ++j) {
      if (positioned() && !is_position(j)) continue;
      product += slope_[j] * last_slope_[j];
      squares += slope_[j] * slope_[j];
      last_squares += last_slope_[j] * last_slope_[j];
    }
    return product < 0.5 * std::sqrt(squares * last_squares);
  }

  void climb(MutableView q) {
    constexpr double flat = 0.1;      // metres of clearance per metre
    constexpr double straight = 0.9;  // share of the increase that the gradient predicts
    for (std::int64_t i = 0; i < settings_.climbs; ++i) {
      const double here = parent_.clearance(q);
      if (!std::isfinite(here)) return;
      const double steepness = measure_slope(q);
      if (steepness < flat || (i > 0 && turned_round())) return;
      std::copy(q.begin(), q.end(), from_.begin());
      last_slope_ = slope_;
      const auto rises = [&](double t) {
        along_slope(t, steepness, probe_);
        return parent_.space.contains(probe_) &&
               parent_.clearance(probe_) >= here + straight * steepness * t - difference_step();
      };
      const double t = farthest(rises, std::max(here, parent_.resolution));
      if (t <= 0.0) return;
      along_slope(t, steepness, q);
    }
  }

  /// Computes the configuration at a distance from from_ along the gradient.
  void along_slope(double t, double steepness, MutableView out) {
    if (parent_.space.flat()) {
      for (std::size_t j = 0; j < out.size(); ++j) {
        out[j] = from_[j] + t * slope_[j] / steepness / parent_.space.axes()[j].weight;
      }
    } else {
      for (std::size_t j = 0; j < tangent_.size(); ++j) tangent_[j] = t * slope_[j] / steepness;
      parent_.space.exp(from_, tangent_, out);
    }
    parent_.space.normalise(out);
  }

  /// The largest distance up to which a condition is true, to within the resolution. The condition is true at 0 and
  /// false at some distance.
  template <class Holds>
  double farthest(Holds&& holds, double far) const {
    double near = 0.0;
    while (holds(far)) {
      near = far;
      far *= 2.0;
    }
    while (far - near > parent_.resolution) {
      const double middle = 0.5 * (near + far);
      (holds(middle) ? near : far) = middle;
    }
    return near;
  }

  /// Step of the finite differences of the gradient: small, to stay on one side of the medial axis.
  [[nodiscard]] double difference_step() const { return 0.1 * parent_.resolution; }

  void retract(MutableView q) {
    std::copy(q.begin(), q.end(), from_.begin());
    const double here = parent_.clearance(from_);
    if (!std::isfinite(here)) return;
    const double step = difference_step();
    if (!(parent_.position_axes.size() == 2 ? face_upwards(step) : face_upwards_in_space(step))) return;
    const auto still_nearest = [&](double t) { return clearance_at(t) >= here + t - step - 0.02 * t; };
    const double near = farthest(still_nearest, std::max(here, parent_.resolution));
    if (near > 0.0) ray_.at(from_, near, q);
  }

  /// Turns the ray to where clearance grows. Returns whether it grows: on the medial axis it grows in no direction.
  bool face_upwards(double step) {
    ray_.set_direction(0.0);
    const double x = clearance_at(step) - clearance_at(-step);
    ray_.set_direction(0.5 * std::numbers::pi);
    const double y = clearance_at(step) - clearance_at(-step);
    if (std::hypot(x, y) < step) return false;
    ray_.set_direction(std::atan2(y, x));
    return true;
  }

  bool face_upwards_in_space(double step) {
    std::array<double, 3> rise{};
    double squares = 0.0;
    for (std::size_t k = 0; k < rise.size(); ++k) {
      std::array<double, 3> direction{};
      direction[k] = 1.0;
      ray_.set_direction(direction);
      rise[k] = clearance_at(step) - clearance_at(-step);
      squares += rise[k] * rise[k];
    }
    if (std::sqrt(squares) < step) return false;
    for (double& x : rise) x /= std::sqrt(squares);
    ray_.set_direction(rise);
    return true;
  }

  Instance& parent_;
  MedialAxisSettings settings_;
  SurfaceRay ray_;
  Configuration from_;
  Configuration probe_;
  std::vector<double> slope_;  ///< gradient, metres of clearance per metre of the metric
  std::vector<double> last_slope_;
  std::vector<double> tangent_;
};

}  // namespace

GuideKind medial_axis_kind() {
  return sampling_kind(
      medial_axis_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return bias([settings = medial_axis_settings().read(o)](Instance& parent) -> std::unique_ptr<Heuristic> {
          return std::make_unique<MedialAxis>(parent, settings);
        });
      },
      "a uniform configuration retracted by ascent of clearance to where another point of the obstacles is as near, "
      "about the medial axis of the free part of C; each clearance that it measures counts as a check of C",
      "it lies on surfaces that depend on the obstacles", false);
}

}  // namespace trellis
