// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/path_steps.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/slice_monitor.hpp>
#include <trellis/instance/search_cost.hpp>

namespace trellis {

namespace {

/// Arc length up to each point of a path.
std::vector<double> arc_lengths(const Space& space, const Configurations& path) {
  std::vector<double> lengths;
  lengths.reserve(std::max<std::size_t>(1, path.size()));
  lengths.push_back(0.0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    lengths.push_back(lengths.back() + space.distance(path[i - 1], path[i]));
  }
  return lengths;
}

/// The point of a path at arc length `at`.
void point_at(const Space& space, const Configurations& path, const std::vector<double>& lengths, double at,
              MutableView out) {
  if (path.size() == 1) {
    std::copy(path[0].begin(), path[0].end(), out.begin());
    return;
  }
  const auto it = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, at);
  const auto i = static_cast<std::size_t>(it - lengths.begin()) - 1;
  const double span = lengths[i + 1] - lengths[i];
  space.interpolate(path[i], path[i + 1], span > 0.0 ? std::clamp((at - lengths[i]) / span, 0.0, 1.0) : 0.0, out);
}

/// The nearest of the points within a radius; none if there is none.
std::optional<NearestIndex::Neighbour> nearest_within(const NearestIndex& index, View q, double radius,
                                                      std::vector<NearestIndex::Neighbour>& found) {
  index.within(q, radius, found);
  const auto nearest = std::min_element(
      found.begin(), found.end(), [](const auto& a, const auto& b) { return a.squared_distance < b.squared_distance; });
  return nearest != found.end() ? std::optional(*nearest) : std::nullopt;
}

/// Two configurations count as equal if they are nearer than this share of a step.
constexpr double meeting = 1e-6;

}  // namespace

bool SparseValidation::valid(Instance& parent, View q) {
  if (!parent.space.contains(q)) return false;
  if (parent.validity->spends_checks()) {
    return parent.check_one([&] { return parent.validity->needed(q); });
  }
  if (!parent.validity->state(q)) return false;
  if (!checked_) checked_ = parent.validity_in(parent.scene);
  return parent.check_one([&] { return checked_->state(q); });
}

SparsePath SparseValidation::validate(Instance& parent, const Configurations& path, View goal, const PointLift& lift,
                                      const PointIsFree& free) {
  const bool whole = !goal.empty();
  SparsePath result;
  const std::size_t dimension = parent.space.dimension();
  if (waypoints_.dimension() != dimension) waypoints_ = Configurations(dimension);
  const std::vector<double> lengths = arc_lengths(s_, path);
  const double wanted = std::max(1.0, std::ceil(lengths.back() / spacing_));
  constexpr double most_points = 1e6;
  if (wanted > most_points) {
    throw Error(fmt::format("option 'spacing' is {} m, which makes {:g} points of a path of {:g} m; at most {:g}",
                            spacing_, wanted, lengths.back(), most_points));
  }
  const auto pieces = static_cast<std::size_t>(wanted);
  const double piece = lengths.back() / static_cast<double>(pieces);
  // Points 0 and `pieces` are the start and, for a whole path, the goal.
  std::array<Configurations, 2> chains = {Configurations(dimension), Configurations(dimension)};
  std::array<std::vector<double>, 2> places;
  const std::size_t rows = (whole ? pieces / 2 : pieces) + 2;
  chains[0].reserve(whole ? pieces + 1 : rows);  // becomes the result
  chains[1].reserve(whole ? rows : 0);
  places[0].reserve(whole ? pieces + 1 : rows);
  places[1].reserve(whole ? rows : 0);
  chains[0].push(parent.start);
  places[0].push_back(0.0);
  if (whole) {
    chains[1].push(goal);
    places[1].push_back(lengths.back());
  }
  std::array<std::size_t, 2> next = {1, whole ? pieces - 1 : pieces};
  Stream stream(++calls_, "", "lift waypoints");
  Configuration s(s_.dimension());
  Configuration ahead(s_.dimension());
  Configuration q(dimension);
  // An excluded place may lie between two points.
  const auto refuted_between = [&](double from, View a, double to, View b) {
    const auto at = parent.validity->excluded(a, b);
    if (!at) return false;
    result.refuted_at = from + *at * (to - from);
    point_at(s_, path, lengths, result.refuted_at, s);
    result.refuted = s;
    return true;
  };
  Configuration moved(dimension);
  std::vector<NearestIndex::Neighbour> near;
  std::size_t side = 0;
  while (next[0] <= next[1] && next[1] > 0) {
    const std::size_t at = next[side];
    parent.spend(search_cost::path_point);
    point_at(s_, path, lengths, piece * static_cast<double>(at), s);
    const double reuse = 0.25 * spacing_;
    bool valid = false;
    if (const auto known = nearest_within(known_, s, reuse, near)) {
      const View waypoint = std::as_const(waypoints_)[known->id];
      if (usable_[known->id] != 0 && checked_at_[known->id] != parent.epoch()) {
        usable_[known->id] = parent.motion_still_valid(waypoint, waypoint, checked_at_[known->id]) ? 1 : 0;
        checked_at_[known->id] = parent.epoch();
      }
      valid = usable_[known->id] != 0;
      if (valid) q.assign(waypoint.begin(), waypoint.end());
    } else {
      const double onward = piece * (static_cast<double>(at) + (side == 0 ? 1.0 : -1.0));
      point_at(s_, path, lengths, std::clamp(onward, 0.0, lengths.back()), ahead);
      View previous = std::as_const(chains[side]).back();
      if (even_ && whole) {
        const auto left = static_cast<double>(next[1] - next[0] + 1);
        parent.space.interpolate(previous, std::as_const(chains[1 - side]).back(), 1.0 / (left + 1.0), moved);
        previous = moved;
      }
      if (free && free(piece * static_cast<double>(at)))
        valid = lift(0, s, previous, ahead, stream, q) && parent.space.contains(q);
      for (int attempt = 0; !valid && lift(attempt, s, previous, ahead, stream, q); ++attempt) {
        valid = this->valid(parent, q);
      }
      known_.add(s);
      if (waypoints_.empty()) waypoints_.reserve(pieces + 1);
      waypoints_.push(q);
      usable_.push_back(valid ? 1 : 0);
      checked_at_.push_back(parent.epoch());
    }
    if (!valid) {
      result.refuted = s;
      result.refuted_at = piece * static_cast<double>(at);
      break;
    }
    if (refuted_between(places[side].back(), std::as_const(chains[side]).back(), piece * static_cast<double>(at), q))
      break;
    chains[side].push(q);
    places[side].push_back(piece * static_cast<double>(at));
    side == 0 ? ++next[0] : --next[1];
    if (whole) side = 1 - side;
  }
  if (whole && !result.refuted) {
    refuted_between(places[0].back(), std::as_const(chains[0]).back(), places[1].back(),
                    std::as_const(chains[1]).back());
  }
  result.waypoints = std::move(chains[0]);
  for (std::size_t i = chains[1].size(); i-- > 0;) result.waypoints.push(std::as_const(chains[1])[i]);
  result.at = std::move(places[0]);
  result.at.insert(result.at.end(), places[1].rbegin(), places[1].rend());
  return result;
}

VerifiedStretches::VerifiedStretches(const Instance& instance, const Configurations& path)
    : path_(path), lengths_(arc_lengths(instance.space, path)), edges_(path.size() - 1, 0) {
  if (!instance.verified) return;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    edges_[i] = instance.verified->contain(path[i], path[i + 1]) ? 1 : 0;
  }
}

bool VerifiedStretches::all() const {
  return std::all_of(edges_.begin(), edges_.end(), [](char verified) { return verified != 0; });
}

bool VerifiedStretches::contains(double at) const {
  const auto it = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, at);
  return edges_[static_cast<std::size_t>(it - lengths_.begin()) - 1] != 0;
}

std::pair<Configurations, std::vector<char>> VerifiedStretches::merged_into(const SparsePath& sparse) const {
  Configurations points(path_.dimension());
  std::vector<char> verified;  // for each point, whether the edge that ends there is verified
  std::size_t next = 0;        // index of the next waypoint
  const auto waypoints_up_to = [&](double at) {
    for (; next < sparse.at.size() && sparse.at[next] < at; ++next) {
      if (contains(sparse.at[next])) continue;
      points.push(sparse.waypoints[next]);
      verified.push_back(0);
    }
  };
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (edges_[i] == 0) continue;
    if (i == 0 || edges_[i - 1] == 0) {
      waypoints_up_to(lengths_[i]);
      points.push(path_[i]);
      verified.push_back(0);
    }
    points.push(path_[i + 1]);
    verified.push_back(1);
  }
  waypoints_up_to(std::numeric_limits<double>::infinity());
  verified.erase(verified.begin());
  return {std::move(points), std::move(verified)};
}

std::vector<char> known_edges(const Instance& instance, const Configurations& path, std::vector<char> verified) {
  if (instance.validity->spends_checks() || path.size() < 2) return verified;
  verified.resize(path.size() - 1, 0);
  for (std::size_t i = 0; i < verified.size(); ++i) {
    if (verified[i] == 0 && instance.validity->motion(path[i], path[i + 1]).valid) verified[i] = 1;
  }
  return verified;
}

std::optional<double> StepHeuristic::edge_factor(View a, View b) const {
  constexpr double most = 5.0;
  if (!index_) {
    index_ = std::make_unique<NearestIndex>(space_);
    for (std::size_t i = 0; i < centres().size(); ++i) index_->add(centres()[i]);
  }
  const double reach = 4.0 * settings_.radius;
  // A roadmap asks about all edges of a new node, one after the other.
  if (!std::equal(b.begin(), b.end(), last_.begin(), last_.end())) {
    last_.assign(b.begin(), b.end());
    at_last_ = index_->nearest(b);
  }
  if (at_last_.squared_distance > reach * reach) return most;
  const auto at_a = index_->nearest(a);
  if (at_a.squared_distance > reach * reach) return most;
  const double along = bin_ * std::abs(static_cast<double>(at_a.id) - static_cast<double>(at_last_.id));
  return std::clamp(along / (space_.distance(a, b) + settings_.radius), 1.0, most);
}

StepHeuristic::StepHeuristic(std::string source, const Space& space, Configurations path, const Settings& settings,
                             const std::array<const ReachedIndex*, 2>& reached, std::vector<char> verified)
    : source_(std::move(source)),
      space_(space),
      path_(std::move(path)),
      lengths_(arc_lengths(space_, path_)),
      settings_(settings),
      verified_(std::move(verified)),
      centres_(space.dimension()) {
  constexpr double most_bins = 1024.0;
  const double bins =
      std::clamp(std::ceil(length() / std::min(settings_.radius, 0.25 * settings_.step)), 1.0, most_bins);
  bin_ = length() / bins;
  const auto last = static_cast<std::size_t>(bins);
  last_bin_ = last;
  for (std::size_t side = 0; side < 2; ++side) {
    Front& front = fronts_[side];
    front.ahead = settings_.step;
    front.exact = true;
    const ReachedIndex* nodes = reached[side];
    for (std::size_t i = last; nodes != nullptr && nodes->grown() && i >= 1;) {
      const std::size_t bin = side == 0 ? i : last - i;
      const double near = very_near();
      const double distance = std::sqrt(nodes->squared_distance(centres()[bin]));
      if (distance > near) {
        i -= std::min(i, bins_to(distance, near));
        continue;
      }
      front.at = bin_ * static_cast<double>(i);
      front.exact = false;
      break;
    }
    aim(side);
  }
}

const Configurations& StepHeuristic::centres() const {
  if (centres_.size() > 0) return centres_;
  Configuration centre(space_.dimension());
  centres_.reserve(last_bin_ + 1);
  std::size_t leg = 0;
  for (std::size_t i = 0; i <= last_bin_; ++i) {
    const double at = bin_ * static_cast<double>(i);
    while (leg + 2 < lengths_.size() && lengths_[leg + 1] <= at) ++leg;
    const double span = path_.size() > 1 ? lengths_[leg + 1] - lengths_[leg] : 0.0;
    space_.interpolate(path_[leg], path_[std::min(leg + 1, path_.size() - 1)],
                       span > 0.0 ? std::clamp((at - lengths_[leg]) / span, 0.0, 1.0) : 0.0, centre);
    centres_.push(centre);
  }
  return centres_;
}

Guidance::Source StepHeuristic::sample(Stream& stream, MutableView out) {
  if (const auto& vertex = target()) {
    const View point = vertex_of(side_, *vertex);
    std::copy(point.begin(), point.end(), out.begin());
    return 0;
  }
  current().sample(stream, out);
  return 0;
}

std::uint32_t StepHeuristic::vertex() const {
  constexpr std::int64_t patient = 3;
  const Front& front = fronts_[side_];
  return front.failures < patient && front.at < length() ? front.row : no_node;
}

bool StepHeuristic::worth_connecting(View from, View to) const {
  const double reach = 2.0 * settings_.step;
  // Trees along verified edges connect only once both have reached the same point.
  if (fronts_[0].target && fronts_[1].target && fronts_[0].exact && fronts_[1].exact &&
      length() - fronts_[0].at - fronts_[1].at > meeting * settings_.step) {
    return false;
  }
  return length() - fronts_[0].at - fronts_[1].at <= reach || space_.squared_distance(from, to) <= reach * reach;
}

std::optional<std::size_t> StepHeuristic::next_target(std::size_t side) const {
  const Front& front = fronts_[side];
  if (verified_.empty() || front.failures > 0 || front.at >= length()) return std::nullopt;
  if (front.exact && verified_after(side, front.vertex)) return front.vertex + 1;
  const double within = std::min(length(), front.at + front.ahead);
  for (std::size_t i = front.vertex + 1; i < path_.size() && length_to(side, i) <= within; ++i) {
    if (length_to(side, i) > front.at && verified_after(side, i)) return i;
  }
  return std::nullopt;
}

bool StepHeuristic::follow_target(std::size_t side, const Outcome& outcome) {
  Front& front = fronts_[side];
  if (!front.target) return false;
  const double left = space_.distance(outcome.added, vertex_of(side, *front.target));
  const double end = length_to(side, *front.target);
  const bool there = left <= meeting * settings_.step;
  if (!there && !front.exact) return false;
  const double to = there ? end : end - left;
  if (to <= front.at) return false;
  progress_ += to - front.at;
  front.at = to;
  front.row = outcome.added_row;
  front.failures = 0;
  front.blocked = 0;
  front.exact = true;
  if (there) front.vertex = *front.target;
  return true;
}

void StepHeuristic::aim(std::size_t side) {
  Front& front = fronts_[side];
  ++epoch_;
  front.target = next_target(side);
  if (front.target) return;
  const std::int64_t f = front.failures;
  // Radii of a quarter, a half, 1, 2 and 4 times the radius.
  std::size_t size = f < 2 ? 0 : f < 5 ? 1 : f < 10 ? 2 : f < 20 ? 3 : 4;
  double from = 0.0;
  double to = length();
  if (front.at < length()) {
    to = std::min(length(), front.at + front.ahead);
    from = to < length() ? front.at + (f < 2 ? 0.9 : 0.5) * front.ahead : to;
    if (f >= 5) from = front.at;
    if (f >= 10) {
      from = std::max(0.0, front.at - settings_.step * std::min(3.0, 0.1 * static_cast<double>(f)));
      to = std::min(length(), front.at + std::max(front.ahead, settings_.step));
    }
  } else {
    size = 2;
  }
  front.size = size;
  front.aimed = false;
  if (side == 1) {
    const double begin = length() - to;
    to = length() - from;
    from = begin;
  }
  front.from = from;
  front.to = to;
}

TubeKernel& StepHeuristic::current() const {
  Front& front = fronts_[side_];
  auto& kernel = front.kernels[front.size];
  if (!kernel) {
    kernel.emplace(space_, path_, settings_.radius * 0.25 * std::exp2(static_cast<double>(front.size)));
    front.aimed = false;
  }
  if (!std::exchange(front.aimed, true)) kernel->activate(front.from, front.to);
  return *kernel;
}

std::optional<double> StepHeuristic::place(std::size_t side, View q, bool far) const {
  const Front& front = fronts_[side];
  const Configurations& centres = this->centres();
  const std::size_t n = centres.size();
  const auto centre = [&](std::size_t i) { return centres[side == 0 ? i : n - 1 - i]; };
  const auto first = static_cast<std::size_t>(front.at / bin_) + 1;
  const auto last = std::min(n - 1, static_cast<std::size_t>((front.at + front.ahead + settings_.step) / bin_));
  const double reach = std::max(settings_.radius, 0.4 * settings_.step);
  double best = reach * reach;
  std::optional<double> at;
  for (std::size_t i = first; i <= last;) {
    const double squared = space_.squared_distance(centre(i), q);
    if (squared <= best) {
      best = squared;
      at = bin_ * static_cast<double>(i++);
    } else {
      i += bins_to(std::sqrt(squared), std::sqrt(best));
    }
  }
  if (far) {
    const std::size_t end = std::max(last, first);
    for (std::size_t i = n - 1; i > end;) {
      const double squared = space_.squared_distance(centre(i), q);
      if (squared <= very_near() * very_near()) return bin_ * static_cast<double>(i);
      i -= std::min(i - end, bins_to(std::sqrt(squared), very_near()));
    }
  }
  return at;
}

void StepHeuristic::observe(const Outcome& outcome, bool mine) {
  if (!outcome.added.empty() && outcome.connected) {
    const std::size_t side = outcome.from_goal ? 1 : 0;
    Front& front = fronts_[side];
    if (mine && side == side_ && follow_target(side, outcome)) {
      aim(side);
      return;
    }
    const auto to = front.at < length() ? place(side, outcome.added, !mine) : std::nullopt;
    // A node beside the path does not replace a node on a verified edge, unless it is one step ahead.
    const bool keep = front.target && front.exact && to && *to < front.at + settings_.step;
    if (to && *to > front.at && !keep) {
      progress_ += *to - front.at;
      // Otherwise, rounding could leave the end of the path just ahead indefinitely.
      front.at = *to > length() - 0.5 * bin_ ? length() : *to;
      front.row = outcome.added_row;
      front.failures = 0;
      front.blocked = 0;
      front.exact = false;
      while (front.vertex + 1 < path_.size() && length_to(side, front.vertex + 1) <= front.at) ++front.vertex;
      front.ahead = std::min(2.0 * front.ahead, most_ahead * settings_.step);
      aim(side);
      return;
    }
  }
  if (!mine) return;
  Front& front = fronts_[side_];
  if (front.at >= length()) return;
  ++front.failures;
  front.ahead = std::max(0.25 * settings_.step, 0.5 * front.ahead);
  if (outcome.fate == Fate::rejected && !outcome.blocked_at.empty()) ++front.blocked;
  if (settings_.evidence > 0 && front.blocked >= settings_.evidence && !refuted_place_) {
    refuted_place_.emplace(space_.dimension());
    const double along = std::min(length(), front.at + settings_.radius);
    point_at(space_, path_, lengths_, side_ == 0 ? along : length() - along, *refuted_place_);
    refute();
  }
  aim(side_);
}

}  // namespace trellis
