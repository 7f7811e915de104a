// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/target.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>

#include <trellis/base/polling.hpp>
#include <trellis/measure/cut_ball.hpp>
#include <trellis/measure/low_discrepancy.hpp>
#include <trellis/measure/target_feature.hpp>
#include <trellis/measure/tube.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

namespace {

// Points of the cover for the tube's volume: they need geometry only, no checks, so use more than for the pool.
constexpr std::size_t cover_share = 4;  // per point of the pool
constexpr std::size_t least_cover = std::size_t{1} << 14U;
// Limits of the search for the pool, as multiples of the requested pool: points of the cover, and validity checks. A
// tube that fills little of its cover (many dimensions) or is mostly invalid reaches them.
constexpr std::size_t cover_limit = 256;
constexpr std::size_t check_limit = 16;
// After this share of the pool, the search costs at most a third of the pool's checks.
constexpr std::size_t patience = 3;
constexpr std::size_t enough = 1024;
constexpr std::size_t region_limit = 64;  // points of the space for a region's pool, in multiples of the pool
constexpr std::size_t least_draws = 64;   // of a distribution
constexpr std::size_t ball_points = 256;  // of a ball, for its share in C

void check(const char* name, const TargetSettings& settings) {
  const auto fail = [&](const std::string& what) { throw Error(fmt::format("{}: {}", name, what)); };
  if (!std::isfinite(settings.delta) || settings.delta <= 0.0) {
    fail(fmt::format("delta must be greater than 0, in m, got {:g}", settings.delta));
  }
  if (settings.points < 1) fail(fmt::format("points must be at least 1, got {}", settings.points));
  if (settings.pool < 1) fail(fmt::format("pool must be at least 1, got {}", settings.pool));
}

void check(const TubeSettings& settings) { check("tube", settings); }

void check(const Space& space, const Configurations& path, const std::vector<std::size_t>& position) {
  if (space.dimension() == 0) throw Error("tube: the space has no axes");
  if (path.empty()) throw Error("tube: the path is empty");
  if (path.size() == 1) throw Error("tube: the path is a single configuration; a tube needs two at least");
  if (path.dimension() != space.dimension()) {
    throw Error(fmt::format("tube: the path has {} coordinates, the space {} has {}", path.dimension(), space.name(),
                            space.dimension()));
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    for (const double c : path[i]) {
      if (!std::isfinite(c)) throw Error(fmt::format("tube: waypoint {} of the path is not finite", i + 1));
    }
    if (!space.contains(path[i])) {
      throw Error(fmt::format("tube: waypoint {} of the path lies outside of the space {}", i + 1, space.name()));
    }
  }
  for (std::size_t i = 0; i < position.size(); ++i) {
    const auto before = position.begin() + static_cast<std::ptrdiff_t>(i);
    if (position[i] >= space.dimension() || std::find(position.begin(), before, position[i]) != before) {
      throw Error(fmt::format("tube: position axis {} is not an axis of the space {} or is given twice", position[i],
                              space.name()));
    }
  }
}

const Range count{.lo = 64, .hi = 1e7};

/// The options that every target has.
template <class S>
Settings<S> with_target_options(Settings<S> settings, const std::string& delta, const std::string& unit = "m") {
  return settings.number("delta", &S::delta, unit, Range::positive(), delta)
      .integer("points", &S::points, "points", count, "evaluation points on the target")
      .integer("pool", &S::pool, "points", count,
               "points of the target for the volumes of cut balls and for `exact`, at least as many as points");
}

/// Draws the shift of a low-discrepancy sequence.
measure::LowDiscrepancy sequence_of(std::uint64_t seed, std::size_t dimension, std::vector<double>& unit) {
  Stream stream(seed, "", "measure");
  unit.resize(dimension);
  for (double& s : unit) s = stream.uniform();
  return {dimension, unit};
}

/// Returns the relative standard error of a share of independent draws; those of low discrepancy have less.
double relative_error(double share, std::size_t draws) {
  return std::sqrt((1.0 - share) / (share * static_cast<double>(draws)));
}

}  // namespace

std::string to_string(TubeSettings::Distance distance) {
  return distance == TubeSettings::Distance::planar ? "planar" : "full";
}

std::string to_string(TubeSettings::Support support) { return support == TubeSettings::Support::free ? "free" : "all"; }

const Settings<TubeSettings>& tube_settings() {
  static const Settings<TubeSettings> settings =
      with_target_options(Settings<TubeSettings>(Component::Kind::target, "tube",
                                                 "configurations within delta of the final path", "Attali et al. 2022"),
                          "radius of the tube")
          .choice("distance", &TubeSettings::distance,
                  {{"planar", TubeSettings::Distance::planar}, {"full", TubeSettings::Distance::full}},
                  "planar: position of the reference point only; full: the space's metric")
          .choice("support", &TubeSettings::support,
                  {{"free", TubeSettings::Support::free}, {"all", TubeSettings::Support::all}},
                  "free: valid configurations only; all: the whole tube, which no tree can reach")
          .positional({"delta"});
  return settings;
}

const Settings<NearOptimalSettings>& near_optimal_settings() {
  static const Settings<NearOptimalSettings> settings =
      with_target_options(
          Settings<NearOptimalSettings>(Component::Kind::target, "near_optimal",
                                        "configurations on paths of at most (1 + epsilon) times the optimal length, by "
                                        "cost-to-come and cost-to-go of a PRM*",
                                        "Attali et al. 2022; Karaman and Frazzoli 2011")
              .number("epsilon", &NearOptimalSettings::epsilon, "share of the optimum", Range::positive(),
                      "how much longer than the optimum")
              .integer("nodes", &NearOptimalSettings::nodes, "nodes", {.lo = 16, .hi = 1e6},
                       "nodes of the PRM*; with more of them the optimum comes nearer to the true one"),
          "radius of the balls that coverage counts")
          .positional({"epsilon"});
  return settings;
}

const Settings<ProgressSettings>& progress_settings() {
  static const Settings<ProgressSettings> settings =
      with_target_options(
          Settings<ProgressSettings>(
              Component::Kind::target, "progress",
              "controls that bring the robot closer to the goal; a motion's coordinate is its rank "
              "in [0, 1] among those that the planner could choose from the same node, 0 the one that comes closest",
              "Attali et al. 2022")
              .number("step", &ProgressSettings::step, "m in the metric", Range::positive(),
                      "length of a motion of a planner without motion model; one with a model has its own controls and "
                      "durations")
              .integer("controls", &ProgressSettings::controls, "motions", {.lo = 16, .hi = 1e6},
                       "motions that each one is ranked among"),
          "radius of the balls that coverage counts", "ranks")
          .positional({"step"});
  return settings;
}

/// The trees of the first points of a pool: of `least`, twice as many, and so on; the last tree has the whole pool.
struct Target::PoolTrees {
  static constexpr std::size_t least = 1024;
  std::array<std::once_flag, 32> built;
  std::array<std::unique_ptr<const NearestIndex>, 32> trees;
  std::once_flag features_made;
  std::vector<measure::TargetFeature> features;
};

Target::Target(const Space& space, const TargetSettings& settings) : space_(space), settings_(settings) {}

Target::Target(const Space& space, const Configurations& path, std::vector<std::size_t> position,
               const TubeSettings& settings, const Valid& valid, std::uint64_t seed)
    : space_(space), settings_(settings), valid_(valid) {
  check(settings);
  check(space, path, position);
  const std::size_t d = space.dimension();
  if (settings.distance == TubeSettings::Distance::full || position.empty()) {
    position.resize(d);
    std::iota(position.begin(), position.end(), std::size_t{0});
  }
  const bool free_only = settings.support == TubeSettings::Support::free;
  if (free_only && !valid_) throw Error("tube: support \"free\" needs a validity");
  holds_invalid_ = !free_only;

  const measure::Frame frame(space);
  tube_ = measure::make_tube(frame, path, std::move(position), settings.delta);
  if (!(tube_->length() > 0.0)) throw Error("tube: the path has no length");

  std::vector<double> unit;
  measure::LowDiscrepancy sequence = sequence_of(seed, tube_->unit_dimension(), unit);
  const auto wanted = static_cast<std::size_t>(std::max(settings.pool, settings.points));
  std::vector<double> y(d);
  std::vector<double> x(d);
  pool_ = Configurations(d);
  pool_.reserve(wanted);
  std::size_t drawn = 0;
  std::size_t in_tube = 0;
  std::size_t checked = 0;
  const auto filling = [&] {
    if (pool_.size() >= wanted || checked >= check_limit * wanted) return false;
    return checked < patience * wanted || pool_.size() < std::min(enough, wanted);
  };
  while (drawn < std::max(least_cover, (filling() ? cover_limit : cover_share) * wanted)) {
    poll(drawn);
    sequence.next(unit);
    ++drawn;
    if (!tube_->draw(unit, y)) continue;
    ++in_tube;
    if (!filling()) continue;
    frame.to_raw(y, x);
    ++checked;
    if (free_only && !valid_(x)) continue;
    pool_.push(x);
  }
  if (!pool_.empty()) {
    free_share_ = static_cast<double>(pool_.size()) / static_cast<double>(checked);
    const double tube_share = static_cast<double>(in_tube) / static_cast<double>(drawn);
    log_volume_ = tube_->log_cover_volume() + std::log(tube_share) + std::log(free_share_);
    log_volume_error_ = std::hypot(relative_error(tube_share, drawn), relative_error(free_share_, checked));
  } else {
    free_share_ = 0.0;
  }
  finish();
}

Target Target::region(const Space& space, const TargetSettings& settings, const Valid& contains, std::uint64_t seed) {
  check("region", settings);
  Target target(space, settings);
  target.contains_ = contains;
  const std::size_t d = space.dimension();
  const measure::Frame frame(space);
  std::vector<double> unit;
  measure::LowDiscrepancy sequence = sequence_of(seed, space.degrees(), unit);
  const auto wanted = static_cast<std::size_t>(std::max(settings.pool, settings.points));
  target.pool_ = Configurations(d);
  std::vector<double> y(d);
  std::vector<double> x(d);
  std::size_t drawn = 0;
  for (; drawn < region_limit * wanted && target.pool_.size() < wanted; ++drawn) {
    poll(drawn);
    sequence.next(unit);
    frame.from_unit(unit, y);
    frame.to_raw(y, x);
    if (contains(x)) target.pool_.push(x);
  }
  if (!target.pool_.empty()) {
    const double share = static_cast<double>(target.pool_.size()) / static_cast<double>(drawn);
    target.log_volume_ = space.log_volume() + std::log(share);
    target.log_volume_error_ = relative_error(share, drawn);
  }
  target.finish();
  return target;
}

Target Target::distribution(const Space& space, const TargetSettings& settings, const Distribution& distribution) {
  check("target", settings);
  Target target(space, settings);
  const Configurations& samples = distribution.samples;
  if (samples.size() < least_draws) {
    throw Error(fmt::format("target: {} draws; at least {} are needed", samples.size(), least_draws));
  }
  if (samples.dimension() != space.dimension()) {
    throw Error(fmt::format("target: the draws have {} coordinates, the space {} has {}", samples.dimension(),
                            space.name(), space.dimension()));
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    poll(i);
    if (!space.contains(samples[i])) {
      throw Error(fmt::format("target: draw {} lies outside of the space {}", i + 1, space.name()));
    }
    const double log_density = distribution.log_density(samples[i]);
    if (!std::isfinite(log_density)) {
      throw Error(fmt::format("target: log_density is {:g} at draw {}, expected a finite number", log_density, i + 1));
    }
    target.log_weights_.push_back(log_density);
  }
  target.pool_ = samples;
  target.contains_ = [log_density = distribution.log_density](View x) {
    return log_density(x) > -std::numeric_limits<double>::infinity();
  };
  target.finish();
  return target;
}

void Target::finish() {
  const measure::Frame frame(space_);
  const std::size_t d = space_.dimension();
  pool_rows_.resize(pool_.size() * d);
  for (std::size_t i = 0; i < pool_.size(); ++i) {
    poll(i);
    frame.to_metric(std::as_const(pool_)[i], MutableView(pool_rows_).subspan(i * d, d));
  }
  pool_trees_ = std::make_shared<PoolTrees>();
  if (pool_.empty()) {
    log_volume_ = -std::numeric_limits<double>::infinity();
    uniform_ = std::numeric_limits<double>::infinity();
    return;
  }
  const std::size_t evaluated = evaluation_points();
  if (is_uniform()) {
    uniform_ = space_.log_volume() - log_volume_;
  } else {
    uniform_ = space_.log_volume() + std::accumulate(log_weights_.begin(), log_weights_.end(), 0.0) /
                                         static_cast<double>(log_weights_.size());
  }
  const measure::CutBall ball(frame, ball_points);
  const auto chance = [&](View y, double radius) {
    return std::min(1.0, std::exp(ball.log_volume(y, radius) - space_.log_volume()));
  };
  hits_.reserve(evaluated);
  log_misses_.reserve(evaluated);
  if (tube_) arcs_.reserve(evaluated);
  for (std::size_t i = 0; i < evaluated; ++i) {
    poll(i);
    const View y = View(pool_rows_).subspan(i * d, d);
    hits_.push_back(chance(y, settings_.delta));
    log_misses_.push_back(std::log1p(-hits_.back()));
    if (tube_) arcs_.push_back(tube_->along(y));
  }
}

const NearestIndex& Target::pool_tree(std::size_t points) const {
  std::size_t i = 0;
  std::size_t size = PoolTrees::least;
  while (3 * size < 2 * points && size < pool_.size()) {
    size *= 2;
    ++i;
  }
  if (2 * size >= pool_.size()) {
    size = pool_.size();
    i = pool_trees_->trees.size() - 1;
  }
  std::call_once(pool_trees_->built[i], [&] {
    pool_trees_->trees[i] = std::make_unique<const NearestIndex>(
        measure::Frame(space_).rows(), std::span(pool_rows_).first(size * space_.dimension()));
  });
  return *pool_trees_->trees[i];
}

const std::vector<measure::TargetFeature>& Target::features() const {
  using measure::TargetFeature;
  std::call_once(pool_trees_->features_made, [&] {
    const measure::Frame frame(space_);
    const std::size_t d = space_.dimension();
    const std::size_t count = std::min(TargetFeature::most_points, pool_.size());
    std::vector<TargetFeature> made;
    const auto row = [&](std::size_t i) { return View(pool_rows_).subspan(i * d, d); };
    const auto add = [&](const auto& value) {
      TargetFeature feature;
      feature.values.reserve(count);
      for (std::size_t i = 0; i < count; ++i) {
        poll(i);
        feature.values.push_back(value(row(i)));
      }
      feature.order.resize(count);
      std::iota(feature.order.begin(), feature.order.end(), std::uint32_t{0});
      std::sort(feature.order.begin(), feature.order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return feature.values[a] != feature.values[b] ? feature.values[a] < feature.values[b] : a < b;
      });
      made.push_back(std::move(feature));
    };
    if (tube_) {
      add([&](View y) { return tube_->along(y); });
      add([&](View y) { return tube_->distance(y); });
    }
    if (frame.flat()) {
      for (std::size_t j = 0; j < d; ++j) add([j](View y) { return y[j]; });
    }
    for (std::size_t a = 0; a < std::min(TargetFeature::anchors, count); ++a) {
      const NearestIndex anchor(frame.rows(), row(pool_.size() - 1 - a));
      add([&](View y) {
        double squared = 0.0;
        anchor.nearest_distances(y, {&squared, 1});
        return squared;
      });
    }
    pool_trees_->features = std::move(made);
  });
  return pool_trees_->features;
}

bool Target::contains(View x) const {
  if (!space_.contains(x)) return false;
  if (!tube_) return contains_(x);
  std::vector<double> y(space_.dimension());
  tube_->frame().to_metric(x, y);
  return tube_->contains(y) && (holds_invalid_ || valid_(x));
}

Configurations Target::draw(std::size_t count, Stream& stream) const {
  const std::size_t d = space_.dimension();
  Configurations drawn(d);
  if (empty()) return drawn;
  drawn.reserve(count);
  if (!is_uniform()) {
    // The user's own draws, from the end: those at the beginning are the evaluation points.
    for (std::size_t i = pool_.size(); i-- > evaluation_points() && drawn.size() < count;) {
      drawn.push(std::as_const(pool_)[i]);
    }
    return drawn;
  }
  const measure::Frame frame(space_);
  std::vector<double> unit(tube_ ? tube_->unit_dimension() : space_.degrees() + 1);
  std::vector<double> y(d);
  std::vector<double> x(d);
  const auto attempts = static_cast<std::size_t>(static_cast<double>(cover_limit * count) / free_share_);
  for (std::size_t tried = 0; tried < attempts && drawn.size() < count; ++tried) {
    poll(tried);
    for (double& u : unit) u = stream.uniform();
    if (tube_) {
      if (!tube_->draw(unit, y)) continue;
    } else {
      frame.from_unit(unit, y);
    }
    frame.to_raw(y, x);
    if (tube_ ? holds_invalid_ || valid_(x) : contains_(x)) drawn.push(x);
  }
  return drawn;
}

double Target::distance(View x) const {
  std::vector<double> y(space_.dimension());
  tube_->frame().to_metric(x, y);
  return tube_->distance(y);
}

double Target::distance_at_row(View y) const { return tube_->distance(y); }

double Target::length() const { return tube_->length(); }

double Target::along(View x) const {
  std::vector<double> y(space_.dimension());
  tube_->frame().to_metric(x, y);
  return tube_->along(y);
}

const std::vector<std::size_t>& Target::axes() const { return tube_->axes(); }

std::size_t Target::evaluation_points() const {
  return std::min(pool_.size(), static_cast<std::size_t>(settings_.points));
}

}  // namespace trellis
