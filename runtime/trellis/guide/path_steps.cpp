// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/path_steps.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace trellis {

namespace {

/// Arc length up to each point of a path.
std::vector<double> arc_lengths(const Space& space, const Configurations& path) {
  std::vector<double> lengths = {0.0};
  lengths.reserve(path.size());
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

}  // namespace

bool SparseValidation::valid(Instance& parent, View q) {
  if (!parent.space.contains(q)) return false;
  if (parent.validity->spends_checks()) return parent.valid(q);
  if (!parent.validity->state(q)) return false;
  if (!checked_) checked_ = parent.validity_in(parent.scene);
  ++parent.checks.validity;
  return checked_->state(q);
}

SparsePath SparseValidation::validate(Instance& parent, const Configurations& path, bool whole, const PointLift& lift,
                                      const PointIsFree& free) {
  SparsePath result;
  const std::size_t dimension = parent.space.dimension();
  if (waypoints_.dimension() != dimension) waypoints_ = Configurations(dimension);
  const std::vector<double> lengths = arc_lengths(s_, path);
  const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(lengths.back() / spacing_)));
  const double piece = lengths.back() / static_cast<double>(pieces);
  // Points 0 and `pieces` are the start and, of a whole path, the goal.
  std::array<Configurations, 2> chains = {Configurations(dimension), Configurations(dimension)};
  chains[0].push(parent.start);
  if (whole) chains[1].push(parent.goal);
  std::array<std::size_t, 2> next = {1, whole ? pieces - 1 : pieces};
  Stream stream(++calls_, "", "lift waypoints");
  Configuration s(s_.dimension());
  Configuration ahead(s_.dimension());
  Configuration q(dimension);
  std::size_t side = 0;
  while (next[0] <= next[1] && next[1] > 0) {
    const std::size_t at = next[side];
    point_at(s_, path, lengths, piece * static_cast<double>(at), s);
    const double reuse = 0.25 * spacing_;
    const auto known = known_.size() > 0 ? known_.nearest(s) : NearestIndex::Neighbour{0, 2.0 * reuse * reuse};
    bool valid = false;
    if (known_.size() > 0 && known.squared_distance <= reuse * reuse) {
      const View waypoint = std::as_const(waypoints_)[known.id];
      if (usable_[known.id] != 0 && checked_at_[known.id] != parent.epoch()) {
        usable_[known.id] = parent.motion_still_valid(waypoint, waypoint) ? 1 : 0;
        checked_at_[known.id] = parent.epoch();
      }
      valid = usable_[known.id] != 0;
      if (valid) q.assign(waypoint.begin(), waypoint.end());
    } else {
      const double onward = piece * (static_cast<double>(at) + (side == 0 ? 1.0 : -1.0));
      point_at(s_, path, lengths, std::clamp(onward, 0.0, lengths.back()), ahead);
      const View previous = std::as_const(chains[side]).back();
      if (free && free(piece * static_cast<double>(at)))
        valid = lift(0, s, previous, ahead, stream, q) && parent.space.contains(q);
      for (int attempt = 0; !valid && lift(attempt, s, previous, ahead, stream, q); ++attempt) {
        valid = this->valid(parent, q);
      }
      known_.add(s);
      waypoints_.push(q);
      usable_.push_back(valid ? 1 : 0);
      checked_at_.push_back(parent.epoch());
    }
    if (!valid) {
      result.refuted = s;
      result.refuted_at = piece * static_cast<double>(at);
      break;
    }
    chains[side].push(q);
    side == 0 ? ++next[0] : --next[1];
    if (whole) side = 1 - side;
  }
  result.waypoints = std::move(chains[0]);
  for (std::size_t i = chains[1].size(); i-- > 0;) result.waypoints.push(std::as_const(chains[1])[i]);
  return result;
}

double StepHeuristic::edge_factor(View a, View b) const {
  constexpr double most = 5.0;
  if (!index_) {
    index_ = std::make_unique<NearestIndex>(space_);
    for (std::size_t i = 0; i < centres_.size(); ++i) index_->add(centres_[i]);
  }
  const auto at_a = index_->nearest(a);
  const auto at_b = index_->nearest(b);
  const double reach = 4.0 * settings_.radius;
  if (std::max(at_a.squared_distance, at_b.squared_distance) > reach * reach) return most;
  const double along = bin_ * std::abs(static_cast<double>(at_a.id) - static_cast<double>(at_b.id));
  return std::clamp(along / (space_.distance(a, b) + settings_.radius), 1.0, most);
}

StepHeuristic::StepHeuristic(std::string source, const Space& space, Configurations path, const Settings& settings,
                             const std::array<const NearestIndex*, 2>& reached)
    : source_(std::move(source)),
      space_(space),
      path_(std::move(path)),
      lengths_(arc_lengths(space_, path_)),
      settings_(settings),
      centres_(space.dimension()) {
  constexpr double most_bins = 1024.0;
  const double bins =
      std::clamp(std::ceil(length() / std::min(settings_.radius, 0.25 * settings_.step)), 1.0, most_bins);
  bin_ = length() / bins;
  Configuration centre(space_.dimension());
  for (std::size_t i = 0; i <= static_cast<std::size_t>(bins); ++i) {
    point_at(space_, path_, lengths_, bin_ * static_cast<double>(i), centre);
    centres_.push(centre);
  }
  for (std::size_t side = 0; side < 2; ++side) {
    Front& front = fronts_[side];
    front.ahead = settings_.step;
    const NearestIndex* nodes = reached[side];
    for (std::size_t i = centres_.size(); nodes != nullptr && nodes->size() > 1 && i-- > 1;) {
      const std::size_t bin = side == 0 ? i : centres_.size() - 1 - i;
      const double near = very_near();
      if (nodes->nearest(std::as_const(centres_)[bin]).squared_distance > near * near) continue;
      front.at = bin_ * static_cast<double>(i);
      break;
    }
    aim(side);
  }
}

Guidance::Source StepHeuristic::sample(Stream& stream, MutableView out) {
  fronts_[side_].kernels[fronts_[side_].size]->sample(stream, out);
  return 0;
}

std::uint32_t StepHeuristic::vertex() const {
  constexpr std::int64_t patient = 3;
  const Front& front = fronts_[side_];
  return front.failures < patient && front.at < length() ? front.row : no_node;
}

bool StepHeuristic::worth_connecting(View from, View to) const {
  const double reach = 2.0 * settings_.step;
  return length() - fronts_[0].at - fronts_[1].at <= reach || space_.squared_distance(from, to) <= reach * reach;
}

void StepHeuristic::aim(std::size_t side) {
  Front& front = fronts_[side];
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
  auto& kernel = front.kernels[size];
  if (!kernel) kernel.emplace(space_, path_, settings_.radius * 0.25 * std::exp2(static_cast<double>(size)));
  if (side == 1) {
    const double begin = length() - to;
    to = length() - from;
    from = begin;
  }
  kernel->activate({{from, to}});
  ++epoch_;
}

std::optional<double> StepHeuristic::place(std::size_t side, View q, bool far) const {
  const Front& front = fronts_[side];
  const std::size_t n = centres_.size();
  const auto centre = [&](std::size_t i) { return std::as_const(centres_)[side == 0 ? i : n - 1 - i]; };
  const auto first = static_cast<std::size_t>(front.at / bin_) + 1;
  const auto last = std::min(n - 1, static_cast<std::size_t>((front.at + front.ahead + settings_.step) / bin_));
  const double reach = std::max(settings_.radius, 0.4 * settings_.step);
  double best = reach * reach;
  std::optional<double> at;
  for (std::size_t i = first; i <= last; ++i) {
    const double distance = space_.squared_distance(centre(i), q);
    if (distance <= best) {
      best = distance;
      at = bin_ * static_cast<double>(i);
    }
  }
  if (far) {
    for (std::size_t i = n - 1; i > std::max(last, first); --i) {
      if (space_.squared_distance(centre(i), q) <= very_near() * very_near()) return bin_ * static_cast<double>(i);
    }
  }
  return at;
}

void StepHeuristic::observe(const Outcome& outcome, bool mine) {
  if (!outcome.added.empty() && outcome.connected) {
    const std::size_t side = outcome.from_goal ? 1 : 0;
    Front& front = fronts_[side];
    const auto to = front.at < length() ? place(side, outcome.added, !mine) : std::nullopt;
    if (to && *to > front.at) {
      progress_ += *to - front.at;
      // Rounding must not leave the end of the path just ahead for ever.
      front.at = *to > length() - 0.5 * bin_ ? length() : *to;
      front.row = outcome.added_row;
      front.failures = 0;
      front.blocked = 0;
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
