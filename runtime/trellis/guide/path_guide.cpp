// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/path_guide.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

constexpr std::size_t most_bins = 256;
constexpr std::int64_t patience_when_covered = 10;

}  // namespace

GuideClaims path_claims(GuideClaims::Category category, std::string f, std::string invalid_ends, std::string example) {
  return {
      .category = category,
      .f = std::move(f),
      .h = "a point of the path found in S, from the stretch just beyond what the tree has reached, then uniform on a "
           "ball about it; or the path's points in turn",
      .closed_form = true,
      .density = "of the tube about the stretch; points that are proposed themselves are atoms",
      .feedback = "new nodes move the stretch on; `patience` proposals without progress, and S is solved again",
      .relaxes = true,
      .invalid_ends = std::move(invalid_ends),
      .fallback = GuideClaims::Fallback::nearest,
      .no_path =
          "h goes along the way to what the search came nearest to the goal with; uniform where that is the "
          "start alone",
      .example = std::move(example)};
}

double natural_distance(const Instance& instance) {
  const Robot& robot = instance.scene->robot;
  if (!robot.translates()) return 0.1 * instance.space.diameter();
  return robot.bounding_radius() > 0.0 ? robot.bounding_radius() : 0.02 * instance.space.diameter();
}

double tube_radius(const PathGuideSettings& settings, const Instance& instance) {
  return settings.radius > 0.0 ? settings.radius : 0.5 * natural_distance(instance);
}

PathHeuristic::PathHeuristic(std::string source, const Space& space, Configurations path, double radius, double window,
                             std::int64_t patience, const NearestIndex* reached)
    : source_(std::move(source)),
      space_(space),
      tube_(space, std::move(path), radius),
      window_(window),
      patience_(patience),
      centres_(space.dimension()) {
  const double length = tube_.length();
  const auto bins =
      static_cast<std::size_t>(std::clamp(std::ceil(length / tube_.radius()), 1.0, static_cast<double>(most_bins)));
  bin_ = length / static_cast<double>(bins);
  covered_.assign(bins, 0);
  Configuration centre(space.dimension());
  for (std::size_t i = 0; i < bins; ++i) {
    tube_.point((static_cast<double>(i) + 0.5) * bin_, centre);
    centres_.push(centre);
    if (reached != nullptr && reached->size() > 0) {
      const double reach = tube_.radius() + 0.5 * bin_;
      if (reached->nearest(centre).squared_distance <= reach * reach) covered_[i] = 1;
    }
  }
  uncovered_ = static_cast<std::size_t>(std::count(covered_.begin(), covered_.end(), 0));
  choose_stretches();
}

Guidance::Source PathHeuristic::sample(Stream& stream, MutableView out) {
  tube_.sample(stream, out);
  return 0;
}

void PathHeuristic::observe(const Outcome& outcome, bool mine) {
  if (!outcome.added.empty() && cover(outcome.added)) {
    failures_ = 0;
    choose_stretches();
  } else if (mine) {
    // Once the whole path is reached there is no progress left to make along it; it may still serve.
    const std::int64_t patience = uncovered_ > 0 ? patience_ : patience_when_covered * patience_;
    if (++failures_ >= patience) refute();
  }
}

bool PathHeuristic::cover(View q) {
  const double reach = tube_.radius() + 0.5 * bin_;
  bool fresh = false;
  for (std::size_t i = 0; i < covered_.size(); ++i) {
    if (covered_[i] == 0 && space_.squared_distance(std::as_const(centres_)[i], q) <= reach * reach) {
      covered_[i] = 1;
      --uncovered_;
      fresh = true;
    }
  }
  return fresh;
}

void PathHeuristic::choose_stretches() {
  // Uncovered bins within `window` of a covered one or of an end of the path that the planner starts from.
  const std::size_t n = covered_.size();
  const auto ahead = static_cast<std::size_t>(std::max(1.0, std::round(window_ * static_cast<double>(n))));
  std::vector<char> active(n, 0);
  bool any_covered = false;
  for (std::size_t i = 0; i < n; ++i) {
    if (covered_[i] == 0) continue;
    any_covered = true;
    for (std::size_t k = i >= ahead ? i - ahead : 0; k <= std::min(n - 1, i + ahead); ++k) active[k] = 1;
  }
  if (!any_covered) std::fill_n(active.begin(), std::min(ahead, n), 1);
  std::vector<std::pair<double, double>> stretches;
  for (std::size_t i = 0; i < n; ++i) {
    if (active[i] == 0 || covered_[i] != 0) continue;
    const double from = static_cast<double>(i) * bin_;
    const double to = i + 1 == n ? tube_.length() : from + bin_;
    if (!stretches.empty() && stretches.back().second == from) {
      stretches.back().second = to;
    } else {
      stretches.emplace_back(from, to);
    }
  }
  // Everything reached: the whole path again.
  if (stretches.empty()) stretches.emplace_back(0.0, tube_.length());
  tube_.activate(std::move(stretches));
  ++epoch_;
}

WaypointHeuristic::WaypointHeuristic(std::string source, Instance& parent, Configurations path, double radius,
                                     std::int64_t patience, const NearestIndex& reached)
    : source_(std::move(source)),
      parent_(parent),
      tube_(parent.space, std::move(path), radius),
      patience_(patience),
      reached_(reached) {
  const auto& points = tube_.path();
  lengths_.reserve(points.size());
  lengths_.push_back(0.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    lengths_.push_back(lengths_.back() + parent.space.distance(points[i - 1], points[i]));
  }
  go_on();
}

Guidance::Source WaypointHeuristic::sample(Stream& stream, MutableView out) {
  drew_itself_ = draw_ == Draw::itself || (draw_ == Draw::both && stream.uniform() < 0.5);
  if (drew_itself_) {
    const View point = tube_.path()[at_];
    std::copy(point.begin(), point.end(), out.begin());
  } else {
    tube_.sample(stream, out);
  }
  return 0;
}

double WaypointHeuristic::atom_mass() const {
  switch (draw_) {
    case Draw::itself: return 1.0;
    case Draw::both: return 0.5;
    case Draw::near: return 0.0;
  }
  throw Fault("unknown way of drawing");
}

void WaypointHeuristic::record(DensityRecord& record, double share) const {
  const double atom = atom_mass();
  record.add_atoms(share * atom);
  record.add(tube_.density(), share * (1.0 - atom));
}

void WaypointHeuristic::observe(const Outcome& outcome, bool mine) {
  const std::size_t before = at_;
  if (!outcome.added.empty() && at_ < tube_.path().size()) {
    const double reach = at_ + 1 == tube_.path().size() ? parent_.goal_tolerance : tube_.radius();
    if (parent_.space.distance(tube_.path()[at_], outcome.added) <= reach) go_on();
  }
  if (at_ != before) {
    failures_ = 0;
    return;
  }
  if (!mine) return;
  if (drew_itself_ && outcome.fate == Fate::rejected && draw_ == Draw::itself) {
    draw_ = Draw::both;
    ++epoch_;
  }
  const std::int64_t patience = at_ < tube_.path().size() ? patience_ : patience_when_covered * patience_;
  if (++failures_ >= patience) refute();
}

void WaypointHeuristic::go_on() {
  const auto& path = tube_.path();
  const auto is_reached = [&](std::size_t i) {
    const double reach = i + 1 == path.size() ? parent_.goal_tolerance : tube_.radius();
    return reached_.nearest(path[i]).squared_distance <= reach * reach;
  };
  while (at_ < path.size() && is_reached(at_)) ++at_;
  ++epoch_;
  if (at_ == path.size()) {
    draw_ = Draw::near;
    tube_.activate({{0.0, tube_.length()}});
    return;
  }
  draw_ = parent_.valid(path[at_]) ? Draw::itself : Draw::near;
  tube_.activate({{lengths_[at_], lengths_[at_]}});
}

SeveralPaths::SeveralPaths(std::vector<std::unique_ptr<PathFollower>> parts)
    : parts_(std::move(parts)), live_(parts_.size()) {
  std::iota(live_.begin(), live_.end(), std::size_t{0});
}

Guidance::Source SeveralPaths::sample(Stream& stream, MutableView out) {
  drawn_ = live_[stream.below(live_.size())];
  return parts_[drawn_]->sample(stream, out);
}

double SeveralPaths::density(View q) const {
  double sum = 0.0;
  for (const std::size_t i : live_) sum += parts_[i]->density(q);
  return sum / static_cast<double>(live_.size());
}

double SeveralPaths::atom_mass() const {
  double sum = 0.0;
  for (const std::size_t i : live_) sum += parts_[i]->atom_mass();
  return sum / static_cast<double>(live_.size());
}

std::uint64_t SeveralPaths::epoch() const {
  std::uint64_t sum = epoch_;
  for (const auto& part : parts_) sum += part->epoch();
  return sum;
}

void SeveralPaths::record(DensityRecord& record, double share) const {
  for (const std::size_t i : live_) parts_[i]->record(record, share / static_cast<double>(live_.size()));
}

void SeveralPaths::observe(const Outcome& outcome, bool mine) {
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i]->observe(outcome, mine && i == drawn_);
  std::vector<std::size_t> live;
  live.reserve(live_.size());
  for (const std::size_t i : live_) {
    if (!parts_[i]->stale()) live.push_back(i);
  }
  if (live.empty()) {
    refute();
  } else if (live.size() != live_.size()) {
    live_ = std::move(live);
    ++epoch_;
  }
}

std::unique_ptr<PathFollower> follow_path(const std::string& source, const PathGuideSettings& settings,
                                          Instance& parent, const Configurations& path, const NearestIndex& reached) {
  const double radius = tube_radius(settings, parent);
  if (settings.follow == "waypoints") {
    return std::make_unique<WaypointHeuristic>(source, parent, path, radius, settings.patience, reached);
  }
  return std::make_unique<PathHeuristic>(source, parent.space, path, radius, settings.window, settings.patience,
                                         &reached);
}

std::unique_ptr<Instance> PathGuide::same_instance(const Instance& parent) {
  auto instance = std::make_unique<Instance>(parent);
  instance->checks = {};
  // An explicit graph is a way of searching the parent's space, not part of what is projected.
  instance->graph = nullptr;
  return instance;
}

void PathGuide::learn(const Outcome& outcome) {
  if (!outcome.added.empty() && reached_) reached_->add(outcome.added);
}

std::unique_ptr<Instance> PathGuide::project(const Instance& parent) {
  auto instance = reduced(parent);
  if (path_settings_.paths > 1) {
    const double distinct = path_settings_.distinct > 0.0 ? path_settings_.distinct : natural_distance(parent);
    excluding_ = std::make_shared<ExcludingValidity>(instance->validity, instance->space, distinct);
    instance->validity = excluding_;
  }
  return instance;
}

std::int64_t PathGuide::another(const Solution* found) {
  if (!excluding_) return 0;
  if (std::exchange(complete_, false)) paths_.clear();
  if (found != nullptr) {
    paths_.push_back(found->path);
    if (static_cast<std::int64_t>(paths_.size()) < path_settings_.paths) {
      excluding_->exclude(found->path);
      return path_settings_.effort;
    }
  }
  // What was excluded is valid all the same.
  if (!paths_.empty()) excluding_->include_all();
  complete_ = true;
  return 0;
}

std::unique_ptr<PathFollower> PathGuide::follower(Instance& parent, const Configurations& path) const {
  if (paths_.size() > 1) {
    std::vector<std::unique_ptr<PathFollower>> parts;
    parts.reserve(paths_.size());
    for (const auto& one : paths_)
      parts.push_back(follow_path(name_, path_settings_, parent, followed(one), *reached_));
    return std::make_unique<SeveralPaths>(std::move(parts));
  }
  return follow_path(name_, path_settings_, parent, followed(path), *reached_);
}

std::unique_ptr<Heuristic> PathGuide::heuristic(Instance& parent, const Instance*, const Solution* found) {
  if (!reached_) {
    reached_.emplace(parent.space);
    reached_->add(parent.start);
  }
  current_ = nullptr;
  if (found->path.size() < 2) return std::make_unique<UniformHeuristic>(name_ + " (found nothing)", parent.space);
  auto h = follower(parent, found->path);
  current_ = h.get();
  return h;
}

}  // namespace trellis
