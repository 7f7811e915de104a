// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/team_space.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/along_space.hpp>

namespace trellis {

RobotsPath::RobotsPath(const Space& team, std::vector<std::size_t> axes, Configurations path)
    : axes_(std::move(axes)), space_(AxisProjection(team, axes_, "robots").space()), path_(std::move(path)) {
  at_.push_back(0.0);
  for (std::size_t i = 1; i < path_.size(); ++i) {
    at_.push_back(at_.back() + space_.distance(std::as_const(path_)[i - 1], std::as_const(path_)[i]));
  }
}

void RobotsPath::at(double s, MutableView out) const {
  const auto next = std::upper_bound(at_.begin(), at_.end(), s);
  const auto i = static_cast<std::size_t>(next - at_.begin());
  if (i == 0 || i == at_.size()) {
    const View end = path_[i == 0 ? 0 : at_.size() - 1];
    std::copy(end.begin(), end.end(), out.begin());
    return;
  }
  space_.interpolate(path_[i - 1], path_[i], (s - at_[i - 1]) / (at_[i] - at_[i - 1]), out);
}

double RobotsPath::nearest(View q) const {
  double best = 0.0;
  double least = space_.squared_distance(path_[0], q);
  for (std::size_t i = 1; i < path_.size(); ++i) {
    const Foot foot = nearest_on_motion(space_, path_[i - 1], path_[i], q);
    if (foot.squared_distance >= least) continue;
    least = foot.squared_distance;
    best = at_[i - 1] + foot.t * (at_[i] - at_[i - 1]);
  }
  return best;
}

void RobotsPath::add_passed(double a, double b, std::vector<double>& parameters) const {
  if (a == b) return;
  const auto first = std::upper_bound(at_.begin(), at_.end(), std::min(a, b));
  for (auto it = first; it != at_.end() && *it < std::max(a, b); ++it) {
    const double t = (*it - a) / (b - a);
    if (t > 0.0 && t < 1.0) parameters.push_back(t);
  }
}

/// Where a configuration of the space places its robots.
class TeamSpace::Embedding {
 public:
  Embedding(const Space& team, std::vector<RobotsPath> along, const std::vector<std::size_t>& free,
            const std::string& name)
      : along_(std::move(along)), axes_(free) {
    for (const RobotsPath& path : along_) axes_.insert(axes_.end(), path.axes().begin(), path.axes().end());
    std::sort(axes_.begin(), axes_.end());
    for (const RobotsPath& path : along_) columns_.push_back(places_of(path.axes()));
    free_ = places_of(free);
    placed_.emplace(team, axes_, "robots");
    // An axis needs a length; robots that stay where they are are there all along it.
    constexpr double least = 1e-6;
    std::vector<double> lengths;
    for (const RobotsPath& path : along_) lengths.push_back(std::max(path.length(), least));
    // The path of many robots is long: its axis counts at most as much as the coordinates of those that are free.
    const Space own = placed_->space().part(free_, name);
    space_ = space_along(lengths, free.empty() ? std::numeric_limits<double>::infinity() : own.diameter(), own, name);
  }

  [[nodiscard]] const std::vector<RobotsPath>& along() const { return along_; }
  [[nodiscard]] const std::vector<std::size_t>& axes() const { return axes_; }
  /// Of each free axis, the place among `axes`.
  [[nodiscard]] const std::vector<std::size_t>& free() const { return free_; }
  /// Keeps the axes of the team that are placed.
  [[nodiscard]] const AxisProjection& placed() const { return *placed_; }
  [[nodiscard]] const Space& space() const { return space_; }

  [[nodiscard]] std::size_t places() const { return axes_.size(); }
  [[nodiscard]] bool keeps(View s) const { return space_.contains(s); }

  void place(View s, MutableView q) const {
    Configuration part;
    for (std::size_t g = 0; g < along_.size(); ++g) {
      part.resize(columns_[g].size());
      along_[g].at(s[g], part);
      for (std::size_t j = 0; j < part.size(); ++j) q[columns_[g][j]] = part[j];
    }
    for (std::size_t j = 0; j < free_.size(); ++j) q[free_[j]] = s[along_.size() + j];
  }
  /// \param q  a configuration of `axes`
  void find(View q, MutableView s) const {
    Configuration part;
    for (std::size_t g = 0; g < along_.size(); ++g) {
      part.clear();
      for (const std::size_t column : columns_[g]) part.push_back(q[column]);
      s[g] = along_[g].nearest(part);
    }
    for (std::size_t j = 0; j < free_.size(); ++j) s[along_.size() + j] = q[free_[j]];
  }
  /// Calls `f(before, after)` for the straight pieces of what a motion places, with `from` and `to` at their ends,
  /// until it returns false: its robots turn in between.
  template <class F>
  bool each_piece(View a, View b, Configuration& from, Configuration& to, const F& f) const {
    std::vector<double> turns = {0.0};
    for (std::size_t g = 0; g < along_.size(); ++g) along_[g].add_passed(a[g], b[g], turns);
    turns.push_back(1.0);
    std::sort(turns.begin(), turns.end());
    turns.erase(std::unique(turns.begin(), turns.end()), turns.end());
    place(a, from);
    Configuration s(space_.dimension());
    for (std::size_t k = 1; k < turns.size(); ++k) {
      space_.interpolate(a, b, turns[k], s);
      place(s, to);
      if (!f(turns[k - 1], turns[k])) break;
      std::swap(from, to);
    }
    return true;
  }

 private:
  [[nodiscard]] std::vector<std::size_t> places_of(const std::vector<std::size_t>& axes) const {
    std::vector<std::size_t> places;
    places.reserve(axes.size());
    for (const std::size_t axis : axes) {
      places.push_back(static_cast<std::size_t>(std::lower_bound(axes_.begin(), axes_.end(), axis) - axes_.begin()));
    }
    return places;
  }

  std::vector<RobotsPath> along_;
  std::vector<std::size_t> axes_;
  std::vector<std::vector<std::size_t>> columns_;  ///< of each path, where its axes are among `axes`
  std::vector<std::size_t> free_;
  std::optional<AxisProjection> placed_;
  Space space_;
};

TeamSpace::TeamSpace(const Instance& parent, std::vector<RobotsPath> along, const std::vector<std::size_t>& free,
                     std::string name)
    : embedding_(std::make_shared<const Embedding>(parent.space, std::move(along), free, name)),
      name_(std::move(name)) {}

std::unique_ptr<Instance> TeamSpace::project(const Instance& parent) {
  auto instance = std::make_unique<Instance>();
  instance->space = embedding_->space();
  const bool all = axes().size() == parent.space.dimension();
  const auto scene = all ? parent.scene : parent.scene->reduced(axes());
  if (!scene) throw Error(fmt::format("{}: these robots are placed by no coordinates of their own", name_));
  const auto validity =
      all ? parent.validity
          : make_validity(parent.collision, scene, embedding_->placed().space(), parent.resolution, nullptr);
  const bool follows = !embedding_->along().empty();
  instance->scene = scene;
  instance->validity = follows ? std::make_shared<AlongValidity<Embedding>>(embedding_, validity) : validity;
  if (follows && !embedding_->free().empty()) {
    // The robots that follow no path, alone: guides of this space see them and the world.
    std::vector<std::size_t> own;
    own.reserve(embedding_->free().size());
    for (const std::size_t column : embedding_->free()) own.push_back(axes()[column]);
    if (auto moving = parent.scene->reduced(own)) instance->scene = std::move(moving);
  }
  std::vector<double> ends;
  for (const RobotsPath& path : along()) ends.push_back(path.length());
  complete_along(*this, parent, ends, *instance);
  instance->goal_tolerance = parent.goal_tolerance;
  return instance;
}

void TeamSpace::project(View q, MutableView s) const {
  if (embedding_->along().empty()) {
    embedding_->placed().project(q, s);
    return;
  }
  Configuration placed(axes().size());
  embedding_->placed().project(q, placed);
  embedding_->find(placed, s);
}

void TeamSpace::lift(View s, Stream& stream, MutableView q) const {
  Configuration placed(axes().size());
  embedding_->place(s, placed);
  embedding_->placed().lift(placed, stream, q);
}

double TeamSpace::log_fibre_density(View q) const { return embedding_->placed().log_fibre_density(q); }

bool TeamSpace::closed_fibre() const { return embedding_->along().empty(); }

std::unique_ptr<Heuristic> TeamSpace::heuristic(Instance&, const Instance*, const Solution*) {
  throw Fault("the space of some robots guides by the path of the whole team");
}

const std::vector<std::size_t>& TeamSpace::axes() const { return embedding_->axes(); }

const std::vector<RobotsPath>& TeamSpace::along() const { return embedding_->along(); }

Configurations TeamSpace::placed(const Configurations& path) const {
  Configurations all(axes().size());
  Configuration from(axes().size());
  Configuration to(axes().size());
  embedding_->place(path[0], from);
  all.push(from);
  for (std::size_t i = 1; i < path.size(); ++i) {
    embedding_->each_piece(path[i - 1], path[i], from, to, [&](double, double) {
      all.push(to);
      return true;
    });
  }
  return all;
}

}  // namespace trellis
