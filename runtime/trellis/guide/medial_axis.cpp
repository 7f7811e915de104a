// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <trellis/guide/bias.hpp>
#include <trellis/guide/kinds.hpp>
#include <trellis/guide/rays.hpp>

namespace trellis {

namespace {

struct MedialAxisSettings {
  std::int64_t rays = 8;
  std::int64_t tries = 100;
};

const Settings<MedialAxisSettings>& medial_axis_settings() {
  static const Settings<MedialAxisSettings> settings =
      Settings<MedialAxisSettings>(
          Component::Kind::guide, "medial_axis",
          "uniform configurations moved, as they are turned, away from the nearest obstacle until another is as near; "
          "invalid ones are moved out first; S = {0}",
          "Wilmarth, Amato and Stiller 1999, MAPRM: a probabilistic roadmap planner with sampling on the medial axis")
          .integer("rays", &MedialAxisSettings::rays, "rays", {.lo = 2, .hi = 1024},
                   "directions in which the nearest way out is looked for where a configuration is invalid")
          .integer("tries", &MedialAxisSettings::tries, "configurations", Range::at_least(1),
                   "configurations tried, where none can be moved out, before a uniform proposal is made instead");
  return settings;
}

/// Retraction by clearance. A robot that does not turn as it moves is an obstacle's distance away from a point's, so
/// away from the nearest point of an obstacle clearance grows by a metre a metre, up to the medial axis.
class MedialAxis final : public Heuristic {
 public:
  MedialAxis(Instance& parent, const MedialAxisSettings& settings)
      : parent_(parent),
        settings_(settings),
        ray_(parent),
        from_(parent.space.dimension()),
        probe_(parent.space.dimension()) {}

  Source sample(Stream& stream, MutableView out) override {
    for (std::int64_t i = 0; i < settings_.tries; ++i) {
      parent_.space.sample_uniform(stream, out);
      if (!parent_.valid(out) && !move_out(stream, out)) continue;
      retract(out);
      return 0;
    }
    parent_.space.sample_uniform(stream, out);
    return 1;
  }
  [[nodiscard]] double density(View) const override { return std::numeric_limits<double>::quiet_NaN(); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"medial_axis", "medial_axis: uniform"}; }

 private:
  /// To the nearest surface that one of the rays meets.
  bool move_out(Stream& stream, MutableView q) {
    std::copy(q.begin(), q.end(), from_.begin());
    const double turn = 2.0 * std::numbers::pi / static_cast<double>(settings_.rays);
    const double first = stream.uniform() * turn;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::int64_t i = 0; i < settings_.rays; ++i) {
      ray_.set_direction(first + static_cast<double>(i) * turn);
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

  void retract(MutableView q) {
    std::copy(q.begin(), q.end(), from_.begin());
    const double here = parent_.clearance(from_);
    if (!std::isfinite(here)) return;
    // The direction in which clearance grows, from differences over a step that stays on this side.
    const double step = 0.1 * parent_.resolution;
    ray_.set_direction(0.0);
    const double x = clearance_at(step) - clearance_at(-step);
    ray_.set_direction(0.5 * std::numbers::pi);
    const double y = clearance_at(step) - clearance_at(-step);
    if (std::hypot(x, y) < step) return;  // on the axis: it grows nowhere
    ray_.set_direction(std::atan2(y, x));
    const double slack = 0.1 * parent_.resolution;
    const auto still_nearest = [&](double t) { return clearance_at(t) >= here + t - slack - 0.02 * t; };
    double near = 0.0;
    double far = std::max(here, parent_.resolution);
    while (still_nearest(far)) {
      near = far;
      far *= 2.0;
    }
    while (far - near > parent_.resolution) {
      const double middle = 0.5 * (near + far);
      (still_nearest(middle) ? near : far) = middle;
    }
    if (near > 0.0) ray_.at(from_, near, q);
  }

  Instance& parent_;
  MedialAxisSettings settings_;
  WayOut ray_;
  Configuration from_;
  Configuration probe_;
};

}  // namespace

GuideKind medial_axis_kind() {
  GuideKind kind = sampling_kind(
      medial_axis_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return bias(
            [settings = medial_axis_settings().read(o)](Instance& parent) -> std::unique_ptr<Heuristic> {
              return std::make_unique<MedialAxis>(parent, settings);
            },
            [](const Instance& parent) {
              if (parent.position_axes.size() == 2) return;
              throw Error("medial_axis: needs a robot whose reference point moves in the plane; this space (" +
                          parent.space.name() + ") has no position");
            });
      },
      "a uniform configuration retracted, at its angles, to the medial axis of what is free; each clearance that it "
      "looks at counts as a check of C",
      "it lies on surfaces that depend on the obstacles", false);
  kind.claims.needs = GuideClaims::Needs::position;
  return kind;
}

}  // namespace trellis
