// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/targets.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <trellis/base/polling.hpp>
#include <trellis/experiment/cost_field.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/measure/estimator.hpp>
#include <trellis/measure/frame.hpp>
#include <trellis/measure/low_discrepancy.hpp>
#include <trellis/measure/tube.hpp>

namespace trellis {

namespace {

constexpr std::uint64_t cost_seed = 0x6f7074696d756d00;

/// Whether a path has positive length over some axes.
bool has_length(const Space& space, const Configurations& path, const std::vector<std::size_t>& axes) {
  if (!space.flat()) return measure::make_tube(measure::Frame(space), path, axes, 1.0)->length() > 0.0;
  Configuration step(space.dimension());
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    space.difference(path[i], path[i + 1], step);
    for (const std::size_t axis : axes) {
      if (step[axis] != 0.0) return true;
    }
  }
  return false;
}

std::vector<std::size_t> all_axes(const Space& space) {
  std::vector<std::size_t> axes(space.dimension());
  for (std::size_t j = 0; j < axes.size(); ++j) axes[j] = j;
  return axes;
}

/// Samples the end configurations of motions from a configuration.
class Steering {
 public:
  Steering(const Space& space, const MotionModel* model, Stream& stream)
      : space_(space), model_(model), stream_(stream), direction_(space.degrees()) {
    if (model != nullptr) control_.resize(model->controls().size());
  }

  /// Computes the end of a random motion of a given length: in any direction, or with a constant random control of the
  /// motion model until the robot has moved that far. \return false where it leaves the space or the model's limits
  bool draw(View from, double length, Configuration& end) {
    if (model_ != nullptr) return drive(from, length, end);
    double square = 0.0;
    for (double& u : direction_) {
      u = stream_.normal();
      square += u * u;
    }
    const double scale = length / std::sqrt(square);
    if (space_.flat()) {
      for (std::size_t j = 0; j < end.size(); ++j) {
        end[j] = from[j] + scale * direction_[j] / space_.axes()[j].weight;
      }
    } else {
      for (double& u : direction_) u *= scale;
      space_.exp(from, direction_, end);
    }
    space_.normalise(end);
    return space_.contains(end);
  }

  /// Computes the end of a motion towards a configuration: straight, or with the one of several random controls that
  /// ends nearest to it, as planners steer.
  bool towards(View from, View to, double length, Configuration& end) {
    const double wanted = space_.distance(from, to);
    if (model_ == nullptr) {
      space_.interpolate(from, to, length / wanted, end);
      return true;
    }
    double nearest = std::numeric_limits<double>::infinity();
    Configuration option(end.size());
    for (std::size_t c = 0; c < tried_controls; ++c) {
      if (!draw(from, length, option)) continue;
      const double rest = space_.distance(option, to);
      if (rest >= nearest) continue;
      nearest = rest;
      end = option;
    }
    return std::isfinite(nearest);
  }

 private:
  bool drive(View from, double length, Configuration& end) {
    model_->sample_control(stream_, control_);
    std::copy(from.begin(), from.end(), end.begin());
    // Limits the duration of a control that hardly moves the robot, such as braking.
    for (std::size_t k = 0; k < longest_hold && space_.distance(from, end) < length; ++k) {
      model_->step(space_, end, control_, end);
      if (!space_.contains(end) || !model_->admits(end)) return false;
    }
    return true;
  }

  static constexpr std::size_t tried_controls = 16;
  static constexpr std::size_t longest_hold = 20;
  const Space& space_;
  const MotionModel* model_;
  Stream& stream_;
  std::vector<double> direction_;
  std::vector<double> control_;
};

}  // namespace

MadeTarget make_tube(const LevelRecord& level, const Configurations& path, const TubeSettings& settings,
                     std::uint64_t seed) {
  const bool planar = settings.distance == TubeSettings::Distance::planar && !level.position_axes.empty();
  std::vector<std::size_t> axes = planar ? level.position_axes : all_axes(level.space);
  if (!has_length(level.space, path, axes)) return {nullptr, "the path has no length"};
  auto target = std::make_shared<const Target>(level.space, path, std::move(axes), settings, level.valid, seed);
  if (target->empty()) return {nullptr, "no valid configuration within delta of the path"};
  return {std::move(target), ""};
}

std::string unfit_near_optimal(const Space& space) {
  if (space.degrees() < most_across) return "";
  return fmt::format(
      "near_optimal has no target in {}: from {} degrees of freedom on a PRM* has no near-optimal costs; "
      "use tube",
      space.name(), most_across);
}

MadeTarget make_near_optimal(const LevelRecord& level, const NearOptimalSettings& settings) {
  if (std::string reason = unfit_near_optimal(level.space); !reason.empty()) return {nullptr, std::move(reason)};
  if (!level.valid(level.start) || !level.valid(level.goal)) return {nullptr, "start or goal is invalid in this space"};
  const auto field = std::make_shared<CostField>(
      CostFieldInstance{level.space, level.start, level.goal, level.valid, level.valid_motion},
      CostFieldSettings{static_cast<std::size_t>(settings.nodes)}, cost_seed);
  const double limit = (1.0 + settings.epsilon) * field->optimum();
  if (!std::isfinite(limit)) return {nullptr, "the PRM* found no path from start to goal"};
  auto target = std::make_shared<const Target>(Target::region(
      level.space, settings, [field, limit](View q) { return field->cost(q) <= limit; }, cost_seed));
  if (target->empty()) return {nullptr, "no configuration was found near the optimum"};
  return {std::move(target), ""};
}

Ranks rank_motions(const LevelRecord& level, bool tree, const ProgressSettings& settings, std::uint64_t seed,
                   const MotionModel* model) {
  const Space& space = level.space;
  const Search& search = level.search;
  const std::size_t d = space.dimension();
  const auto& from = tree ? search.parents : search.near;
  const Configurations& to = tree ? search.nodes : search.proposals;

  const auto controls = static_cast<std::size_t>(settings.controls);
  Stream stream(seed, level.key, tree ? "progress nodes" : "progress proposals");
  Steering steering(space, model, stream);

  const Space ranks = Space::euclidean({{0.0, 1.0}});
  Configurations samples(1);
  std::vector<double> progressing;  // of each motion, the share of its rivals that end closer to the goal
  Configuration end(d);
  for (std::size_t i = 0; i < to.size(); ++i) {
    poll();
    if (from[i] == no_node || (tree && from[i] == i)) continue;
    const View x = search.nodes[from[i]];
    const double wanted = space.distance(x, to[i]);
    if (!(wanted > 0.0)) continue;
    const double length = std::min(settings.step, wanted);
    if (!steering.towards(x, to[i], length, end)) continue;
    const double reached = space.distance(end, level.goal);
    const double here = space.distance(x, level.goal);
    double better = 0.0;
    double closer = 0.0;
    double all = 0.0;
    // Each motion has its own rivals: then the rank of a random direction among them is uniform. Ranks among shared
    // rivals would be too frequent where the rivals' positions have gaps.
    for (std::size_t c = 0; c < controls; ++c) {
      if (!steering.draw(x, length, end)) continue;
      const double there = space.distance(end, level.goal);
      all += 1.0;
      better += there < reached ? 1.0 : 0.0;
      closer += there < here ? 1.0 : 0.0;
    }
    if (closer == 0.0) continue;
    // Ranks are multiples of 1 / (rivals + 1); the position within its step is arbitrary, so draw it uniformly.
    samples.push(std::vector<double>{std::min(1.0, (better + stream.uniform()) / (all + 1.0))});
    progressing.push_back(closer / all);
  }
  Ranks result{{}, std::move(samples)};
  if (progressing.empty()) {
    result.target.reason = "the planner makes no motions from node to node";
    return result;
  }

  // T is the mean of the uniform distributions on [0, share]: a falling step function.
  std::sort(progressing.begin(), progressing.end());
  const std::size_t n = progressing.size();
  std::vector<double> above(n + 1, 0.0);  // sum of 1 / share over the motions from this one on
  for (std::size_t i = n; i-- > 0;) above[i] = above[i + 1] + 1.0 / progressing[i];
  const auto log_density = [progressing, above, n](View z) {
    const auto first = std::upper_bound(progressing.begin(), progressing.end(), z[0]) - progressing.begin();
    return std::log(above[static_cast<std::size_t>(first)] / static_cast<double>(n));
  };
  Target::Distribution distribution{Configurations(1), log_density};
  measure::LowDiscrepancy sequence(2, {stream.uniform(), stream.uniform()});
  std::vector<double> unit(2);
  const auto wanted = static_cast<std::size_t>(std::max(settings.points, settings.pool));
  for (std::size_t i = 0; i < wanted; ++i) {
    poll();
    sequence.next(unit);
    const auto which = std::min(n - 1, static_cast<std::size_t>(unit[0] * static_cast<double>(n)));
    distribution.samples.push(std::vector<double>{progressing[which] * unit[1]});
  }
  result.target.target = std::make_shared<const Target>(Target::distribution(ranks, settings, distribution));
  return result;
}

}  // namespace trellis
