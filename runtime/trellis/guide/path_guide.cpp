// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/path_guide.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/goal_choice.hpp>
#include <trellis/guide/kept_tree.hpp>
#include <trellis/guide/path_steps.hpp>
#include <trellis/instance/characteristic_length.hpp>

namespace trellis {

namespace {

constexpr std::size_t most_bins = 256;

/// Maximum number of attempts to lift a point of a path in S to a valid configuration of C.
constexpr int lift_attempts = 24;

}  // namespace

GuideClaims path_claims(GuideClaims::Category category, std::string f, std::string invalid_ends, std::string example) {
  return {
      .category = category,
      .f = std::move(f),
      .h = "a point of the path found in S, from the stretch just beyond what the tree has reached, then uniform on a "
           "ball about it; or the path's points in turn",
      .closed_form = true,
      .density = "of the tube about the stretch; points that are proposed themselves are atoms",
      .feedback =
          "new nodes move the stretch on; a point of the path that is invalid in C, or `evidence` proposals at "
          "one place that were found blocked, refute it: S loses that place and its search continues",
      .relaxes = true,
      .invalid_ends = std::move(invalid_ends),
      .fallback = GuideClaims::Fallback::nearest,
      .no_path =
          "h follows the path to the node nearest to the goal; uniform where that is the "
          "start alone",
      .example = std::move(example)};
}

double sparse_spacing(const Instance& instance) {
  constexpr double share_of_step = 0.8;
  return std::max(characteristic_length(instance), share_of_step * instance.step);
}

double tube_radius(const PathGuideSettings& settings, const Instance& instance) {
  return settings.radius > 0.0 ? settings.radius : 0.5 * characteristic_length(instance);
}

PathHeuristic::PathHeuristic(std::string source, const Space& space, Configurations path, double radius, double window,
                             std::int64_t evidence, const ReachedIndex* reached)
    : source_(std::move(source)),
      space_(space),
      tube_(space, std::move(path), radius),
      window_(window),
      evidence_(evidence),
      centres_(space.dimension()) {
  const double length = tube_.length();
  const auto bins =
      static_cast<std::size_t>(std::clamp(std::ceil(length / tube_.radius()), 1.0, static_cast<double>(most_bins)));
  bin_ = length / static_cast<double>(bins);
  covered_.assign(bins, 0);
  blocked_in_bin_.assign(bins, 0);
  Configuration centre(space.dimension());
  for (std::size_t i = 0; i < bins; ++i) {
    tube_.point((static_cast<double>(i) + 0.5) * bin_, centre);
    centres_.push(centre);
    if (reached != nullptr && reached->size() > 0) {
      const double reach = tube_.radius() + 0.5 * bin_;
      if (reached->squared_distance(centre) <= reach * reach) covered_[i] = 1;
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
  if (!outcome.added.empty() && outcome.connected && cover(outcome.added)) {
    blocked_ = 0;
    blocked_in_bin_.assign(covered_.size(), 0);
    choose_stretches();
  } else if (mine && uncovered_ > 0 && outcome.fate == Fate::rejected && !outcome.blocked_at.empty()) {
    // A path that the planner reached completely is not refuted: it may still be useful.
    count_blocked(outcome.blocked_at);
    if (++blocked_ < evidence_) return;
    const auto most = std::max_element(blocked_in_bin_.begin(), blocked_in_bin_.end());
    const View place = std::as_const(centres_)[static_cast<std::size_t>(most - blocked_in_bin_.begin())];
    refuted_place_.emplace(place.begin(), place.end());
    refute();
  }
}

void PathHeuristic::count_blocked(View blocked_at) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < covered_.size(); ++i) {
    if (covered_[i] != 0) continue;
    const double squared = space_.squared_distance(std::as_const(centres_)[i], blocked_at);
    if (squared < least) {
      least = squared;
      nearest = i;
    }
  }
  ++blocked_in_bin_[nearest];
}

bool PathHeuristic::cover(View q) {
  const double reach = tube_.radius() + 0.5 * bin_;
  bool fresh = false;
  for (std::size_t i = 0; i < covered_.size(); ++i) {
    if (covered_[i] == 0 && space_.squared_distance(std::as_const(centres_)[i], q) <= reach * reach) {
      covered_[i] = 1;
      --uncovered_;
      progress_ += bin_;
      fresh = true;
    }
  }
  return fresh;
}

void PathHeuristic::choose_stretches() {
  // Uncovered bins within the window of a covered bin, or of an end of the path where a tree starts.
  const std::size_t n = covered_.size();
  const auto ahead = static_cast<std::size_t>(
      std::max(1.0, bin_ > 0.0 ? std::round(std::min(window_ / bin_, static_cast<double>(n))) : 1.0));
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
  // If all bins are covered, the whole path is active.
  if (stretches.empty()) stretches.emplace_back(0.0, tube_.length());
  tube_.activate(std::move(stretches));
  ++epoch_;
}

WaypointHeuristic::WaypointHeuristic(std::string source, Instance& parent, Configurations path, double radius,
                                     std::int64_t evidence, const ReachedIndex& reached)
    : source_(std::move(source)),
      parent_(parent),
      tube_(parent.space, std::move(path), radius),
      evidence_(evidence),
      reached_(reached) {
  const auto& points = tube_.path();
  // If the path ends at the goal and has a verified motion, only its other motions need repair.
  const bool whole = parent.to_goal(points.back()) <= parent.goal_tolerance;
  const std::size_t examined = whole ? points.size() : std::min<std::size_t>(points.size(), 2);
  for (std::size_t i = 1; i < examined && !exact_; ++i) {
    exact_ = parent.is_verified(points[i - 1], points[i]);
  }
  back_ = points.size() - 1;
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
    const View point = tube_.path()[backwards_ ? back_ - 1 : at_];
    std::copy(point.begin(), point.end(), out.begin());
  } else {
    tube_.sample(stream, out);
  }
  return 0;
}

double WaypointHeuristic::share_of_waypoint() const {
  switch (draw_) {
    case Draw::itself: return 1.0;
    case Draw::both: return 0.5;
    case Draw::near: return 0.0;
  }
  throw Fault("unknown rule of drawing");
}

void WaypointHeuristic::record(DensityRecord& record, double share) const {
  const double atom = share_of_waypoint();
  record.add_atoms(share * atom);
  record.add(tube_.density(), share * (1.0 - atom));
}

void WaypointHeuristic::observe(const Outcome& outcome, bool mine) {
  const std::size_t before = at_;
  // The next extension starts at the node added between waypoints, which may be farther apart than a step.
  if (mine && drew_itself_ && !outcome.added.empty() && (exact_ || !outcome.from_goal)) {
    (backwards_ ? back_row_ : row_) = outcome.added_row;
  }
  if (exact_ && outcome.from_goal && !outcome.added.empty()) {
    if (back_ > 0 && parent_.space.distance(tube_.path()[back_ - 1], outcome.added) <= parent_.goal_tolerance) {
      --back_;
      back_row_ = outcome.added_row;
    }
    return;
  }
  if (!outcome.added.empty() && outcome.connected && at_ < tube_.path().size()) {
    const double reach = exact_ || at_ + 1 == tube_.path().size() ? parent_.goal_tolerance : tube_.radius();
    if (parent_.space.distance(tube_.path()[at_], outcome.added) <= reach) go_on();
  }
  if (at_ != before) {
    row_ = outcome.added_row;
    progress_ += lengths_[std::min(at_, lengths_.size() - 1)] - lengths_[before];
    blocked_ = 0;
    return;
  }
  if (!mine) return;
  if (drew_itself_ && outcome.fate == Fate::rejected && draw_ == Draw::itself) {
    draw_ = Draw::both;
    ++epoch_;
  }
  if (at_ == tube_.path().size() || outcome.fate != Fate::rejected || outcome.blocked_at.empty()) return;
  if (++blocked_ >= evidence_) refute();
}

void WaypointHeuristic::go_on() {
  const auto& path = tube_.path();
  const auto is_reached = [&](std::size_t i) {
    const double reach = exact_ || i + 1 == path.size() ? parent_.goal_tolerance : tube_.radius();
    return reached_.squared_distance(path[i]) <= reach * reach;
  };
  while (at_ < path.size() && is_reached(at_)) ++at_;
  ++epoch_;
  if (at_ == path.size()) {
    draw_ = Draw::near;
    tube_.activate(0.0, tube_.length());
    return;
  }
  const bool known = at_ > 0 && parent_.is_verified(path[at_ - 1], path[at_]);
  draw_ = known || parent_.valid(path[at_]) ? Draw::itself : Draw::near;
  tube_.activate(lengths_[at_], lengths_[at_]);
}

SeveralPaths::SeveralPaths(std::vector<std::unique_ptr<PathFollower>> parts)
    : parts_(std::move(parts)), live_(parts_.size()) {
  std::iota(live_.begin(), live_.end(), std::size_t{0});
}

Guidance::Source SeveralPaths::sample(Stream& stream, MutableView out) {
  drawn_ = live_[stream.below(live_.size())];
  return parts_[drawn_]->sample(stream, out);
}

std::uint64_t SeveralPaths::epoch() const { return changes_ + Composed::epoch(); }

void SeveralPaths::record(DensityRecord& record, double share) const {
  for (const std::size_t i : live_) parts_[i]->record(record, share / static_cast<double>(live_.size()));
}

void SeveralPaths::observe(const Outcome& outcome, bool mine) {
  Composed::observe(outcome, mine);
  std::vector<std::size_t> live;
  live.reserve(live_.size());
  for (const std::size_t i : live_) {
    if (!parts_[i]->stale()) live.push_back(i);
  }
  if (live.empty()) {
    refute();
  } else if (live.size() != live_.size()) {
    live_ = std::move(live);
    ++changes_;
  }
}

std::optional<double> SeveralPaths::edge_factor(View a, View b) const {
  std::optional<double> least;
  for (const std::size_t i : live_) least = least_factor(least, parts_[i]->edge_factor(a, b));
  return least;
}

std::optional<Configuration> SeveralPaths::refuted_place() const {
  for (const auto& part : parts_) {
    if (auto place = part->refuted_place()) return place;
  }
  return std::nullopt;
}

std::unique_ptr<PathFollower> follow_path(const std::string& source, const PathGuideSettings& settings,
                                          Instance& parent, const Configurations& path,
                                          const std::array<const ReachedIndex*, 2>& reached) {
  const double radius = tube_radius(settings, parent);
  if (settings.follow == Follow::waypoints) {
    return std::make_unique<WaypointHeuristic>(source, parent, path, radius, settings.evidence, *reached[0]);
  }
  if (settings.follow == Follow::tube) {
    const double window = settings.window > 0.0 ? settings.window : 2.0 * step_length(parent);
    return std::make_unique<PathHeuristic>(source, parent.space, path, radius, window, settings.evidence, reached[0]);
  }
  const StepHeuristic::Settings steps = {.radius = radius, .step = step_length(parent), .evidence = settings.evidence};
  return std::make_unique<StepHeuristic>(source, parent.space, path, steps, reached);
}

std::unique_ptr<Instance> PathGuide::same_instance(const Instance& parent) {
  auto instance = std::make_unique<Instance>(parent);
  instance->checks = {};
  instance->revision = 0;
  instance->verified = nullptr;
  instance->shared_resolution = 0.0;
  if (parent.scene->translates()) {
    instance->needed_clearance = std::max(parent.needed_clearance, parent.scene->inscribed_radius());
    instance->needed_reach = std::max(parent.needed_reach, parent.scene->bounding_radius());
  }
  sort_goals(*instance);
  // An explicit graph belongs to the search of the parent's space, so f does not map it.
  instance->graph = nullptr;
  return instance;
}

void PathGuide::learn(const Outcome& outcome) {
  if (outcome.added.empty() || !outcome.connected) return;
  reached_.add(outcome.added, outcome.from_goal);
  if (tree_ && !outcome.from_goal) tree_->add(outcome.added, outcome.added_row);
}

void PathGuide::restart() {
  reached_.clear();
  if (tree_) tree_->clear();
}

void PathGuide::searched(const Search& search) {
  if (tree_) tree_->update(search);
}

std::unique_ptr<Instance> PathGuide::project(const Instance& parent) {
  auto instance = reduced(parent);
  relaxed_ = nullptr;
  if (relaxes() && instance->validity->spends_checks() && !parent.motion_model) {
    // Where C presumes validity, by collision checks in its world.
    std::shared_ptr<Validity> c = parent.validity->spends_checks() ? parent.validity : parent.validity->checking();
    if (c == nullptr) c = parent.validity_in(parent.scene);
    relaxed_ = std::make_shared<RelaxedValidity>(instance->validity, std::move(c));
    instance->validity = relaxed_;
    instance->shared_resolution = parent.resolution;
  }
  // Records nodes from here on, so that h starts from the current state of the search, however late it is made.
  const Instance& in = followed_in(parent, *instance);
  if (!reached_.begun()) reached_.begin(in.space, in.start, in.goals);
  if (path_settings_.keep_tree && !tree_) tree_ = std::make_shared<KeptTree>(in.space, in.start);
  if (path_settings_.paths > 1 || excludes()) {
    const double place_radius = 0.5 * characteristic_length(parent);
    const double distinct = path_settings_.distinct > 0.0 ? path_settings_.distinct : characteristic_length(parent);
    auto excluding = std::make_shared<ExcludingValidity>(instance->validity, instance->space, distinct,
                                                         instance->position_axes, place_radius);
    if (excluding_) excluding->replace(*excluding_);
    excluding_ = std::move(excluding);
    goals_.clear();
    instance->validity = excluding_;
    parents_ = parent.validity;
    lost_ = Configurations(instance->space.dimension());
    found_invalid_.emplace(parent.space, parent.position_axes, place_radius);
  }
  return instance;
}

std::int64_t PathGuide::another(const Solution* found) {
  if (path_settings_.paths <= 1) return 0;
  if (std::exchange(complete_, false)) paths_.clear();
  if (found != nullptr) {
    // A search for separated paths may drop goals near these paths.
    if (paths_.empty()) goals_ = sub_->goals;
    paths_.push_back(found->path);
    const bool more = static_cast<std::int64_t>(paths_.size()) < path_settings_.paths;
    if (more && keep_apart_from(found->path)) return path_settings_.effort;
  }
  // Ends the exclusion of paths: they are valid configurations.
  if (!paths_.empty()) excluding_->include_paths();
  if (!goals_.empty()) sub_->goals = std::exchange(goals_, {});
  complete_ = true;
  return 0;
}

bool PathGuide::keep_apart_from(const Configurations& path) {
  if (!path_settings_.inhibit_bottlenecks) {
    excluding_->exclude(path);
    return true;
  }
  // As dense as the balls of `exclude`: half the radius apart.
  const Configurations bottlenecks = excluding_->points_along(path, [&](View q) {
    if (!parents_->spends_checks()) return !parents_->state(q);
    return !sub_->check_one([&] { return parents_->state(q); });
  });
  excluding_->exclude_points(bottlenecks);
  return !bottlenecks.empty();
}

std::optional<Configuration> PathGuide::take_refuted() {
  if (refuted_) return std::exchange(refuted_, std::nullopt);
  return current_ != nullptr ? current_->refuted_place() : std::nullopt;
}

void PathGuide::before_resolve() {
  if (found_invalid_) found_invalid_->clear();
  if (!excludes() || current_ == nullptr) return;
  const std::optional<Configuration> place = take_refuted();
  // Another guide, or a level above, refuted the path, and the place is already excluded.
  if (!place && !lost_.empty()) return;
  // A place that contains the start or the last goal cannot be excluded: the path is followed although it is refuted.
  last_ = !place || !exclude_place(*place);
  if (!last_) lost_.push(*place);
}

bool PathGuide::exclude_place(View place) {
  const auto remains = [&](const Configuration& goal) {
    return !excluding_->in_place(goal) && !excluding_->same_place(place, goal);
  };
  std::vector<Configuration> keep = {sub_->start};
  if (std::none_of(sub_->goals.begin(), sub_->goals.end(), remains)) {
    keep.insert(keep.end(), sub_->goals.begin(), sub_->goals.end());
  }
  return excluding_->exclude_place(place, keep);
}

PointLift PathGuide::near_point(const Instance& parent) {
  std::vector<std::size_t> headings;
  const auto& positions = parent.position_axes;
  const std::vector<Axis> coordinates = parent.space.coordinates();
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    const bool moves = std::find(positions.begin(), positions.end(), j) != positions.end();
    if (!moves && coordinates[j].periodic) headings.push_back(j);
  }
  const double reach = characteristic_length(parent);
  // The attempts, in order: the point itself; with the non-position coordinates of the previous waypoint; with the
  // heading along the path, in either direction; then at increasing distance: near the point, along the path near its
  // position, any configuration at its position.
  return [&parent, headings = std::move(headings), reach, ball = BallKernel(parent.space, reach),
          drawn = Configuration(parent.space.dimension())](int attempt, View s, View previous, View ahead,
                                                           Stream& stream, MutableView q) mutable {
    const auto& position_axes = parent.position_axes;
    const bool turns = position_axes.size() == 2 && !headings.empty();
    const auto along_path = [&](bool backwards) {
      const double angle =
          std::atan2(ahead[position_axes[1]] - s[position_axes[1]], ahead[position_axes[0]] - s[position_axes[0]]);
      for (const std::size_t axis : headings) q[axis] = angle + (backwards ? std::numbers::pi : 0.0);
      parent.space.normalise(q);
    };
    const auto at_position = [&](View rest) {
      std::copy(rest.begin(), rest.end(), q.begin());
      for (const std::size_t axis : position_axes) q[axis] = s[axis];
    };
    constexpr int fixed = 4;
    if (attempt >= lift_attempts) return false;
    std::copy(s.begin(), s.end(), q.begin());
    if (attempt == 0) return true;
    const double share = std::min(1.0, static_cast<double>(attempt) / (0.5 * lift_attempts));
    if (!position_axes.empty() && attempt == 1) {
      at_position(previous);
    } else if (turns && attempt < fixed) {
      at_position(previous);
      along_path(attempt == 3);
    } else if (turns && attempt % 3 == 0) {
      at_position(previous);
      along_path(stream.uniform() < 0.5);
      for (const std::size_t axis : position_axes) q[axis] += share * reach * stream.uniform(-1.0, 1.0);
      parent.space.reflect(q);
    } else if (!position_axes.empty() && share == 1.0 && attempt % 3 == 1) {
      parent.space.sample_uniform(stream, drawn);
      at_position(drawn);
    } else {
      ball.sample(s, stream, drawn);
      parent.space.interpolate(s, drawn, share, q);
    }
    return true;
  };
}

Configurations PathGuide::refuted_places() const {
  if (!excluding_ || !excludes()) return {};
  Configurations places = excluding_->excluded_places();
  if (refuted_) {
    places.push(*refuted_);
  } else if (current_ != nullptr) {
    if (const auto place = current_->refuted_place()) places.push(*place);
  }
  return places;
}

void PathGuide::refute_lost_path() {
  if (relaxes() || only_path_ || current_ == nullptr || current_->stale()) return;
  // Between two changes of what is excluded the path stays valid.
  if (std::exchange(lost_checked_at_, sub_->epoch()) == sub_->epoch()) return;
  const Configurations path = current_->lifted_path();
  if (path.dimension() != sub_->space.dimension()) return;
  Validity& validity = *sub_->validity;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const View a = std::as_const(path)[i - 1], b = std::as_const(path)[i];
    const bool lost = validity.excluded(a, b) || (!validity.spends_checks() && !validity.motion(a, b).valid);
    if (lost) return current_->refute();
  }
}

void PathGuide::found_invalid(View q) {
  refute_lost_path();
  if (!excludes() || only_path_ || current_ == nullptr || path_settings_.evidence <= 0) return;
  found_invalid_->add(q);
  const auto there = static_cast<std::int64_t>(found_invalid_->count(q));
  if (there < path_settings_.evidence) return;
  refuted_.emplace(sub_->space.dimension());
  project(q, *refuted_);
  current_->refute();
}

void PathGuide::avoid(View place) {
  refute_lost_path();
  if (!excluding_ || !excludes()) return;
  Configuration s(sub_->space.dimension());
  project(place, s);
  if (excluding_->in_place(s) || !exclude_place(s)) return;
  lost_.push(s);
  if (current_ != nullptr && !only_path_ && leads_through_lost_place(current_->lifted_path())) current_->refute();
}

bool PathGuide::leads_through_lost_place(const Configurations& path) const {
  // h may be over C or over S.
  const bool over_s = path.dimension() == sub_->space.dimension();
  Configuration from(sub_->space.dimension());
  Configuration to(sub_->space.dimension());
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (over_s) {
      to.assign(path[i].begin(), path[i].end());
    } else {
      project(path[i], to);
    }
    if (i > 0 && excluding_->excluded(from, to)) return true;
    std::swap(from, to);
  }
  return false;
}

std::unique_ptr<PathFollower> PathGuide::follower_of_one(Instance& parent, const Configurations& path, bool whole) {
  const Configurations chosen = followed(path);
  PathGuideSettings settings = path_settings_;
  settings.follow = follow();
  if (!relaxes() || only_path_) settings.evidence = std::numeric_limits<std::int64_t>::max();
  if (settings.follow != Follow::steps || !relaxes()) {
    return follow_path(name_, settings, parent, chosen, reached_.both());
  }
  if (!sparse_) {
    const double spacing = path_settings_.spacing > 0.0 ? path_settings_.spacing : sparse_spacing(parent);
    sparse_ = std::make_shared<SparseValidation>(parent.space, spacing);
  }
  const PointLift lift = near_point(parent);
  const StepHeuristic::Settings steps = {
      .radius = tube_radius(settings, parent), .step = step_length(parent), .evidence = settings.evidence};
  const VerifiedStretches verified(parent, chosen);
  if (verified.all()) {
    return std::make_unique<StepHeuristic>(name_, parent.space, chosen, steps, reached_.both(), verified.edges());
  }
  const Configuration goal = whole ? goal_at_end(parent, chosen.back()) : Configuration();
  SparsePath sparse = sparse_->validate(parent, chosen, goal, lift, [&](double at) { return verified.contains(at); });
  auto [waypoints, edges] = verified.merged_into(sparse);
  edges = known_edges(parent, waypoints, std::move(edges));
  auto follower = std::make_unique<StepHeuristic>(name_, parent.space, std::move(waypoints), steps, reached_.both(),
                                                  std::move(edges));
  if (sparse.refuted && !std::exchange(last_, false) && !only_path_) {
    refuted_ = std::move(sparse.refuted);
    follower->refute();
  }
  return follower;
}

std::unique_ptr<PathFollower> PathGuide::follower(Instance& parent, const Configurations& path, bool whole) {
  if (paths_.size() > 1) {
    std::vector<std::unique_ptr<PathFollower>> parts;
    parts.reserve(paths_.size());
    for (const auto& one : paths_) parts.push_back(follower_of_one(parent, one, true));
    return std::make_unique<SeveralPaths>(std::move(parts));
  }
  return follower_of_one(parent, path, whole);
}

void PathGuide::share_verified(Instance& parent, const Configurations& path) {
  if (!relaxed_) return;
  // A space with presumed validity verifies its motions itself, if at all.
  if (parent.validity->spends_checks()) {
    if (!parent.verified) parent.verified = std::make_shared<VerifiedMotions>();
    parent.verified->hold_at(parent.epoch());
  }
  if (!parent.verified) return;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    if (relaxed_->valid_in_c(path[i], path[i + 1])) parent.verified->add(path[i], path[i + 1]);
  }
}

std::unique_ptr<Heuristic> PathGuide::heuristic(Instance& parent, const Instance*, const Solution* found) {
  current_ = nullptr;
  refuted_.reset();
  if (found->path.size() < 2) return std::make_unique<UniformHeuristic>(name_ + " (found nothing)", parent.space);
  share_verified(parent, found->path);
  auto h = follower(parent, found->path, found->solved());
  if (tree_) h = std::make_unique<TreeAndPath>(tree_, std::move(h));
  current_ = h.get();
  lost_checked_at_.reset();
  return h;
}

}  // namespace trellis
