// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/position_guide.hpp>

#include <cmath>

#include <trellis/instance/characteristic_length.hpp>

namespace trellis {

namespace {

double ball_radius(const Instance& parent, bool complete) {
  // A lift that is one configuration of many: wide balls reach others.
  const double share = complete ? 0.5 : 0.75;
  return share * characteristic_length(parent);
}

}  // namespace

std::unique_ptr<Instance> PositionGuide::point_instance(const Instance& parent) {
  projection_ = std::make_shared<PositionProjection>(name_, parent, link_);
  patience_ = evidence_;
  if (!projection_->complete()) {
    // Where two coordinates and an angle show by so many proposals that a place is blocked, more joints take more.
    constexpr double usual = 3.0;
    patience_ = std::llround(static_cast<double>(evidence_) * static_cast<double>(parent.space.degrees()) / usual);
  }
  return projection_->point_instance(parent);
}

void PositionGuide::begin(const Instance& parent, Instance& instance, std::shared_ptr<Graph> graph, bool lifts,
                          double spacing) {
  graph_ = std::move(graph);
  instance.graph = graph_;
  lifts_ = lifts;
  excluded_ = Configurations(instance.space.dimension());
  lost_ = Configurations(instance.space.dimension());
  if (!reached_) {
    reached_.emplace(projection_->space(), instance.start);
    nodes_.begin(parent.space, parent.start, parent.goals);
    start_ = parent.start;
    position_axes_ = parent.position_axes;
    place_radius_ = 0.5 * characteristic_length(parent);
    found_invalid_.emplace(parent.space, parent.position_axes, place_radius_);
  }
  spacing_ = spacing > 0.0 ? spacing : projection_->spacing(parent, instance);
  sparse_.emplace(projection_->space(), spacing_, projection_->arm());
}

void PositionGuide::learn(const Outcome& outcome) {
  if (outcome.added.empty() || !outcome.connected) return;
  if (lifts_) nodes_.add(outcome.added, outcome.from_goal);
  thread_local Configuration position;
  position.resize(projection_->space().dimension());
  projection_->project(outcome.added, position);
  reached_->add(position);
}

void PositionGuide::restart() {
  nodes_.clear();
  reached_->clear();
}

const Configuration& PositionGuide::begin_heuristic(const Instance& parent, const Configurations& path) {
  steps_ = nullptr;
  follower_ = nullptr;
  refuted_.reset();
  path_ = path;
  return goal_choice_.choose(
      parent, [this](View q, MutableView s) { project(q, s); }, projection_->space(), path_);
}

std::unique_ptr<Heuristic> PositionGuide::along(Instance& parent, const Configuration& goal, const PointLift& lift,
                                                const PointIsFree& free) {
  // A point that had no valid lift towards another goal may have one towards this goal.
  if (goal_choice_.replaced()) sparse_.emplace(projection_->space(), spacing_, projection_->arm());
  SparsePath sparse = sparse_->validate(parent, path_, goal, lift, free);
  const StepHeuristic::Settings steps = {
      .radius = radius_option_ > 0.0 ? radius_option_ : ball_radius(parent, projection_->complete()),
      .step = step_length(parent),
      .evidence = patience_};
  std::vector<char> known = known_edges(parent, sparse.waypoints);
  auto h = std::make_unique<StepHeuristic>(name_, parent.space, std::move(sparse.waypoints), steps, nodes_.both(),
                                           std::move(known));
  steps_ = h.get();
  follower_ = h.get();
  // A lift that is not complete fails where other configurations would not: both ends of the path still lead out of
  // where start and goal are, and the planner looks for what is between them.
  if (sparse.refuted && projection_->complete() && !path_is_excluded()) {
    refuted_ = std::move(sparse.refuted);
    h->refute();
  }
  return h;
}

void PositionGuide::exclude_refuted() {
  found_invalid_->clear();
  goal_choice_.refute();
  if (!refuted_ && steps_->refuted_place()) {
    if (projection_->arm() && ++variation_ <= PositionProjection::most_variations) {
      // The tip has many configurations along the path: other ones may be valid.
      sparse_.emplace(projection_->space(), spacing_, true);
      return;
    }
    variation_ = 0;
    refuted_.emplace(projection_->space().dimension());
    projection_->project(*steps_->refuted_place(), *refuted_);
  }
  if (!refuted_) return;
  exclude_on_path(*refuted_);
  add_excluded(*refuted_);
}

void PositionGuide::add_excluded(View s) {
  excluded_.push(s);
  lost_.push(s);
}

Configurations PositionGuide::refuted_places() const {
  Configurations places(start_.size());
  // The position of an arm's tip is no axis of C.
  if (position_axes_.empty()) return places;
  const auto add = [&](View position) {
    // The position is refuted; the other coordinates do not matter.
    Configuration place = start_;
    for (std::size_t k = 0; k < position_axes_.size(); ++k) place[position_axes_[k]] = position[k];
    places.push(place);
  };
  for (std::size_t i = 0; i < excluded_.size(); ++i) add(excluded_[i]);
  if (refuted_) {
    add(*refuted_);
  } else if (steps_ != nullptr) {
    if (const auto place = steps_->refuted_place()) places.push(*place);
  }
  return places;
}

void PositionGuide::found_invalid(View q) {
  if (steps_ == nullptr || refuted_ || path_is_excluded()) return;
  found_invalid_->add(q);
  if (static_cast<std::int64_t>(found_invalid_->count(q)) < patience_) return;
  refuted_.emplace(projection_->space().dimension());
  projection_->project(q, *refuted_);
  steps_->refute();
}

void PositionGuide::avoid(View place) {
  if (!can_exclude()) return;
  Configuration s(projection_->space().dimension());
  projection_->project(place, s);
  const std::optional<bool> on_path = exclude_near(s);
  if (!on_path) return;
  add_excluded(s);
  if (*on_path && follower_ != nullptr && !follower_->stale()) follower_->refute();
}

}  // namespace trellis
