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
#include <trellis/motion/steering.hpp>

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

/// The ends of the motions that a planner could have chosen from a configuration.
class Choices {
 public:
  virtual ~Choices() = default;
  /// Draws one of them, as the planner does without a guide.
  /// \return false where there is none
  virtual bool draw(View from, Configuration& end) = 0;
};

/// Straight motions of one length in any direction.
class StraightChoices final : public Choices {
 public:
  StraightChoices(const Space& space, Stream& stream) : space_(space), stream_(stream), direction_(space.degrees()) {}
  void set_length(double length) { length_ = length; }
  bool draw(View from, Configuration& end) override {
    double square = 0.0;
    for (double& u : direction_) {
      u = stream_.normal();
      square += u * u;
    }
    const double scale = length_ / std::sqrt(square);
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

 private:
  const Space& space_;
  Stream& stream_;
  std::vector<double> direction_;
  double length_ = 0.0;
};

/// Drives a model until a control ends, the state leaves the space or the model's limits, or the longest motion is
/// over. Obstacles do not end a motion, because they do not change what the planner could choose.
class Driver {
 public:
  Driver(const Space& space, const MotionModel& model, std::uint32_t longest)
      : space_(space), model_(model), longest_(longest), next_(space.dimension()) {}
  void start(View from) {
    at_.assign(from.begin(), from.end());
    left_ = longest_;
  }
  /// \return false where the motion ends
  bool drive(View control, std::uint32_t steps) {
    for (std::uint32_t k = 0; k < steps && left_ > 0; ++k, --left_) {
      model_.step(space_, at_, control, next_);
      if (!space_.contains(next_) || !model_.admits(next_)) return false;
      std::swap(at_, next_);
    }
    return left_ > 0;
  }
  [[nodiscard]] const Configuration& end() const { return at_; }

 private:
  const Space& space_;
  const MotionModel& model_;
  std::uint32_t longest_;
  std::uint32_t left_ = 0;
  Configuration at_;
  Configuration next_;
};

/// The motions of a planner with a motion model: under controls and durations drawn uniformly within their bounds; or
/// along the shortest curves to uniform configurations at uniform speeds, where it drives along curves and there is
/// one.
class DrivenChoices final : public Choices {
 public:
  DrivenChoices(const Space& space, const MotionModel& model, const ControlRecord& record, Stream& stream)
      : space_(space),
        model_(model),
        record_(record),
        stream_(stream),
        driver_(space, model, record.longest),
        control_(model.controls().size()),
        towards_(space.dimension()) {}

  bool draw(View from, Configuration& end) override {
    driver_.start(from);
    if (!record_.curves || !drive_curve(from)) {
      model_.sample_control(stream_, control_);
      driver_.drive(control_, static_cast<std::uint32_t>(1 + stream_.below(record_.longest)));
    }
    end = driver_.end();
    return true;
  }
  /// The end of the motion that was chosen for a proposal.
  void end_of(View from, std::size_t proposal, Configuration& end) {
    driver_.start(from);
    for (std::size_t k = record_.begin_of(proposal); k < record_.ends[proposal]; ++k) {
      if (!driver_.drive(record_.controls[k], record_.steps[k])) break;
    }
    end = driver_.end();
  }

 private:
  bool drive_curve(View from) {
    space_.sample_uniform(stream_, towards_);
    const auto curve = steer_at(model_, from, towards_, stream_.uniform());
    if (!curve || curve->steps.empty()) return false;
    for (std::size_t k = 0; k < curve->steps.size(); ++k) {
      if (!driver_.drive(curve->controls[k], curve->steps[k])) break;
    }
    return true;
  }

  const Space& space_;
  const MotionModel& model_;
  const ControlRecord& record_;
  Stream& stream_;
  Driver driver_;
  std::vector<double> control_;
  Configuration towards_;
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

  const auto controls = static_cast<std::size_t>(settings.controls);
  Stream stream(seed, level.key, tree ? "progress nodes" : "progress proposals");

  const Space ranks = Space::euclidean({{0.0, 1.0}});
  Configurations samples(1);
  std::vector<double> progressing;  // of each motion, the share of its rivals that end closer to the goal
  Configuration rival(space.dimension());
  // Each motion has its own rivals: then the rank of a random motion among them is uniform. Ranks among shared rivals
  // would be too frequent where the rivals' positions have gaps.
  const auto rank = [&](View from, View end, Choices& choices) {
    const double reached = space.distance(end, level.goal);
    const double here = space.distance(from, level.goal);
    double better = 0.0;
    double equal = 0.0;
    double closer = 0.0;
    double all = 0.0;
    for (std::size_t c = 0; c < controls; ++c) {
      if (!choices.draw(from, rival)) continue;
      const double there = space.distance(rival, level.goal);
      all += 1.0;
      better += there < reached ? 1.0 : 0.0;
      equal += there == reached ? 1.0 : 0.0;
      closer += there < here ? 1.0 : 0.0;
    }
    if (closer == 0.0) return;
    // Ranks are multiples of 1 / (rivals + 1); the position within its step, and among equals, is arbitrary, so draw it
    // uniformly.
    samples.push(std::vector<double>{std::min(1.0, (better + stream.uniform() * (equal + 1.0)) / (all + 1.0))});
    progressing.push_back(closer / all);
  };
  if (model != nullptr && search.controls.longest > 0) {
    DrivenChoices choices(space, *model, search.controls, stream);
    Configuration end(space.dimension());
    for (std::size_t i = 0; i < search.controls.ends.size(); ++i) {
      poll();
      if (search.near[i] == no_node || (tree && search.added[i] == no_node)) continue;
      const View from = search.nodes[search.near[i]];
      if (tree) {
        const View added = search.nodes[search.added[i]];
        end.assign(added.begin(), added.end());
      } else {
        choices.end_of(from, i, end);
      }
      rank(from, end, choices);
    }
  } else {
    StraightChoices choices(space, stream);
    Configuration end(space.dimension());
    const auto& from = tree ? search.parents : search.near;
    const Configurations& to = tree ? search.nodes : search.proposals;
    for (std::size_t i = 0; i < to.size(); ++i) {
      poll();
      if (from[i] == no_node || (tree && from[i] == i)) continue;
      const View x = search.nodes[from[i]];
      const double wanted = space.distance(x, to[i]);
      if (!(wanted > 0.0)) continue;
      const double length = std::min(settings.step, wanted);
      space.interpolate(x, to[i], length / wanted, end);
      choices.set_length(length);
      rank(x, end, choices);
    }
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
