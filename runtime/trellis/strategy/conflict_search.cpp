// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/team_space.hpp>
#include <trellis/instance/certified_validity.hpp>
#include <trellis/scene/team_times.hpp>
#include <trellis/strategy/team_parts.hpp>

namespace trellis {

namespace {

/// Solves the instance of a team by the paths of single robots, repaired where they conflict. All robots move along
/// their paths at the same speed. The first place of that motion where robots touch each other gives a window of time
/// about it; only the robots in conflict there leave their paths, and only in the window. The others move along theirs,
/// as one coordinate of each search. Where the window has no path, it grows to both sides. A repaired window does not
/// change what follows it, so each repair leaves a longer beginning without conflicts.
class ConflictSearch final : public TeamPartsSearch {
 public:
  explicit ConflictSearch(TeamSearchContext of) : TeamPartsSearch(std::move(of)) { next_number_ = members_.size(); }

  std::optional<Status> work() override {
    if (current_ != nullptr) {
      advance_part();
      return std::nullopt;
    }
    if (pruning_) {
      auto path = prune();
      if (!path) return std::nullopt;
      finish(std::move(*path));
      return Status::solved;
    }
    if (tries_left_ <= 0) return Status::budget_spent;
    if (alone_.size() < members_.size()) {
      begin_robot();
    } else if (path_.empty()) {
      move_together();
    } else if (conflict_) {
      begin_window();
    } else {
      find_conflict();
    }
    return std::nullopt;
  }

 private:
  /// Robots that conflict at a time, and the search that is to repair their paths.
  struct Conflict {
    double time = 0.0;                ///< seconds, on the path of the team
    std::vector<std::size_t> robots;  ///< members, ascending; it grows
    double reach = 0.0;               ///< seconds to either side of it, of the window
    bool together = false;            ///< the robots are searched as one next, not one after another
    std::size_t growths = 0;
    std::size_t record = 0;    ///< its place in Run::conflicts
    std::uint64_t before = 0;  ///< validity checks when it was found
  };
  /// A part of the path of the team.
  struct Window {
    double from = 0.0;  ///< seconds
    double to = 0.0;
    Configurations path;
  };

  void begin_anew() override {
    alone_.clear();
    path_ = {};
    pairs_.clear();
    conflict_.reset();
    certifies_ = false;
    valid_to_ = 0;
  }

  /// Begins the search of the next robot alone.
  void begin_robot() {
    const std::vector<std::size_t> robots = {alone_.size()};
    space_ = std::make_shared<TeamSpace>(context_.instance, std::vector<RobotsPath>(), axes_of(members_, robots),
                                         name_of(robots));
    begin_search(part_of(*space_, 0), space_, robots);
    guide_part(1);
  }

  std::optional<Status> end_part(Level& ended) override {
    // One after another, the robots of a window were certified in the search below.
    const bool divided = conflict_ && !conflict_->together;
    const Configurations path = divided ? ended.solution().path : shortened(ended);
    if (!divided && !accepts(ended, path)) return std::nullopt;
    if (conflict_) {
      repair(space_->placed(path));
    } else {
      alone_.emplace_back(context_.instance.space, space_->axes(), path);
    }
    return std::nullopt;
  }

  void fail() override {
    if (!conflict_) {
      // What a robot cannot do alone, it cannot do among others.
      tries_left_ = 0;
      return;
    }
    note_conflict(TeamConflict::Resolved::none);
    constexpr std::size_t most_together = 3;
    if (!conflict_->together && conflict_->robots.size() <= most_together) {
      conflict_->together = true;
      return;
    }
    conflict_->together = false;
    if (window_.from <= 0.0 && window_.to >= times_.back()) {
      --tries_left_;
      begin_anew();
      return;
    }
    conflict_->reach *= 2.0;
    ++conflict_->growths;
  }

  /// The path on which every robot moves at the same speed along its own, and waits at its end.
  void move_together() {
    std::set<double> times = {0.0};
    for (std::size_t r = 0; r < members_.size(); ++r) {
      const Space own = space_of(context_.instance.space, members_[r]);
      double length = 0.0;
      const Configurations& path = alone_[r].path();
      for (std::size_t i = 1; i < path.size(); ++i) {
        length += own.distance(path[i - 1], path[i]);
        times.insert(length);
      }
    }
    path_ = Configurations(context_.instance.space.dimension());
    Configuration q(path_.dimension());
    Configuration part;
    for (const double time : times) {
      for (const RobotsPath& path : alone_) {
        part.resize(path.axes().size());
        path.at(time, part);
        for (std::size_t j = 0; j < part.size(); ++j) q[path.axes()[j]] = part[j];
      }
      path_.push(q);
    }
    // A robot that does not move at all is at its start.
    if (path_.size() == 1) path_.push(q);
    valid_to_ = 0;
    note_times();
  }

  void note_times() { times_ = times_of(context_.instance.space, members_, path_).at; }

  /// Where the team is at a time.
  void at(double time, MutableView q) const {
    const auto next = std::upper_bound(times_.begin(), times_.end(), time);
    const auto i = static_cast<std::size_t>(next - times_.begin());
    if (i == 0 || i == times_.size()) {
      const View end = path_[i == 0 ? 0 : times_.size() - 1];
      std::copy(end.begin(), end.end(), q.begin());
      return;
    }
    context_.instance.space.interpolate(path_[i - 1], path_[i], (time - times_[i - 1]) / (times_[i] - times_[i - 1]),
                                        q);
  }

  /// Validates the motions of the path in turn, up to the first that is not valid: its robots are in conflict.
  void find_conflict() {
    Instance& instance = context_.instance;
    CertifiedValidity validity(instance.validity, exact_tolerance_of(instance));
    constexpr std::uint64_t piece = 256;
    const std::uint64_t before = instance.checks.validity;
    const Configurations& path = path_;
    while (valid_to_ + 1 < path.size() && instance.checks.validity < before + piece) {
      const MotionReport report =
          instance.check_certificate([&] { return validity.motion(path[valid_to_], path[valid_to_ + 1]); });
      if (report.valid) {
        ++valid_to_;
        continue;
      }
      Conflict conflict;
      conflict.time = times_[valid_to_] + report.invalid_at * (times_[valid_to_ + 1] - times_[valid_to_]);
      conflict.reach = 2.0 * instance.scene->bounding_radius();
      if (conflict.reach <= 0.0) conflict.reach = 0.1 * times_.back();
      conflict.record = run_.conflicts.size();
      conflict.before = checks();
      run_.conflicts.emplace_back().at = conflict.time;
      conflict_ = conflict;
      add_touching(path[valid_to_], path[valid_to_ + 1], report.invalid_at);
      return;
    }
    if (valid_to_ + 1 < path.size()) return;
    begin_pruning(instance, path);
  }

  /// Adds the robots of each two that touch each other at a place of a motion to those in conflict; where none do, of
  /// each two whose motion cannot be certified.
  void add_touching(View a, View b, double parameter) {
    Instance& team = context_.instance;
    Configuration q(a.size());
    team.space.interpolate(a, b, parameter, q);
    std::set<std::size_t> robots(conflict_->robots.begin(), conflict_->robots.end());
    const std::size_t known = robots.size();
    for (const bool certifies : {false, true}) {
      for (std::size_t i = 0; i < members_.size(); ++i) {
        for (std::size_t k = i + 1; k < members_.size(); ++k) {
          const Pair& pair = pair_of(i, k);
          const Configuration from = picked(certifies ? a : View(q), pair.axes);
          const Configuration to = picked(b, pair.axes);
          bool free = true;
          if (certifies) {
            Certificate certificate{exact_tolerance_of(team)};
            const Instance::Announced before = team.open_certificate();
            pair.instance->validity->certify(from, to, certificate);
            team.count_certificate(before, certificate.checks);
            free = certificate.valid();
          } else {
            free = team.check_one([&] { return pair.instance->validity->state(from); });
          }
          if (!free) touch(i, k, robots);
        }
      }
      if (robots.size() > known) break;
    }
    conflict_->robots.assign(robots.begin(), robots.end());
  }

  /// Adds two robots to those in conflict.
  void touch(std::size_t i, std::size_t k, std::set<std::size_t>& robots) {
    robots.insert({i, k});
    auto& touching = run_.conflicts[conflict_->record].touching;
    const std::vector<std::size_t> pair = numbers_of({i, k});
    if (std::find(touching.begin(), touching.end(), pair) == touching.end()) touching.push_back(pair);
  }
  /// Records what became of the conflict so far.
  void note_conflict(TeamConflict::Resolved resolved) {
    TeamConflict& record = run_.conflicts[conflict_->record];
    record.robots = numbers_of(conflict_->robots);
    record.from = window_.from;
    record.to = window_.to;
    record.resolved = resolved;
    record.checks = checks() - conflict_->before;
  }
  /// The validity checks of this level and of all its searches so far.
  [[nodiscard]] std::uint64_t checks() const {
    std::uint64_t all = context_.instance.checks.validity;
    for (const auto& level : levels_) all += level->instance().checks.validity;
    return all;
  }

  /// Two robots in the world.
  struct Pair {
    std::vector<std::size_t> axes;
    std::unique_ptr<Instance> instance;
  };
  const Pair& pair_of(std::size_t i, std::size_t k) {
    Pair& pair = pairs_[{i, k}];
    if (!pair.instance) {
      TeamSpace both(context_.instance, {}, axes_of(members_, {i, k}), "both");
      pair.axes = both.axes();
      pair.instance = both.project(context_.instance);
    }
    return pair;
  }

  /// Cuts the window of the conflict from the path: from and to valid configurations.
  void cut_window() {
    const auto valid_at = [&](double time) {
      Configuration q(path_.dimension());
      at(time, q);
      return context_.instance.valid(q);
    };
    // Of small robots in a large world, at most a thousand steps.
    const double pace = std::max(0.25 * conflict_->reach, 1e-3 * times_.back());
    // It begins where the path was validated.
    window_.from = std::max(0.0, std::min(conflict_->time - conflict_->reach, times_[valid_to_]));
    window_.to = std::min(times_.back(), conflict_->time + conflict_->reach);
    while (window_.to < times_.back() && !valid_at(window_.to)) {
      window_.to = std::min(times_.back(), window_.to + pace);
    }
    window_.path = Configurations(path_.dimension());
    Configuration q(path_.dimension());
    at(window_.from, q);
    window_.path.push(q);
    for (std::size_t i = 0; i < times_.size(); ++i) {
      if (times_[i] > window_.from && times_[i] < window_.to) window_.path.push(std::as_const(path_)[i]);
    }
    at(window_.to, q);
    window_.path.push(q);
  }

  /// The robots that are not in conflict, along their part of the window; none without any.
  [[nodiscard]] std::optional<RobotsPath> others() const {
    std::vector<std::size_t> rest;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (!std::binary_search(conflict_->robots.begin(), conflict_->robots.end(), i)) rest.push_back(i);
    }
    if (rest.empty()) return std::nullopt;
    std::vector<std::size_t> axes = axes_of(members_, rest);
    Configurations path(axes.size());
    const Configurations& all = window_.path;
    for (std::size_t i = 0; i < all.size(); ++i) path.push(picked(all[i], axes));
    return RobotsPath(context_.instance.space, std::move(axes), std::move(path));
  }

  /// Begins the search of the window. Robots that conflict with each other in it, apart from those of the conflict,
  /// join these.
  void begin_window() {
    Instance& team = context_.instance;
    cut_window();
    std::optional<RobotsPath> rest = others();
    while (rest) {
      TeamSpace along(team, {*rest}, {}, "others");
      const auto part = along.project(team);
      CertifiedValidity validity(part->validity, exact_tolerance_of(*part));
      const MotionReport report =
          team.check_certificate([&] { return validity.motion(Configuration{0.0}, Configuration{rest->length()}); });
      if (report.valid) break;
      const std::size_t known = conflict_->robots.size();
      add_touching_others(*rest, report.invalid_at * rest->length());
      if (conflict_->robots.size() == known) break;
      rest = others();
    }
    // A search of the window is a search of the team from its first configuration to its last one.
    std::vector<std::size_t> all(team.space.dimension());
    std::iota(all.begin(), all.end(), std::size_t{0});
    space_ = std::make_shared<TeamSpace>(team, std::vector<RobotsPath>(), all, "team");
    auto part = space_->project(team);
    part->start.assign(window_.path.front().begin(), window_.path.front().end());
    part->goals.assign(1, Configuration(window_.path.back().begin(), window_.path.back().end()));
    effort_ = static_cast<double>(division_.effort) * std::min(1.0, 0.1 * std::pow(2.0, conflict_->growths));
    if (conflict_->together) {
      std::vector<RobotsPath> along;
      if (rest) along.push_back(*rest);
      space_ = std::make_shared<TeamSpace>(*part, along, axes_of(members_, conflict_->robots), "window");
      begin_search(space_->project(*part), space_, conflict_->robots);
      return;
    }
    TeamDivision division;
    division.how = Coordination::order;
    division.of_window = true;
    division.order = conflict_->robots;
    division.tries = 2 * static_cast<std::int64_t>(conflict_->robots.size());
    division.effort = static_cast<std::int64_t>(std::ceil(effort_));
    if (rest) division.given = std::make_shared<const RobotsPath>(*rest);
    begin_search(std::move(part), space_, conflict_->robots);
    current_->divide(std::move(division), guide_);
  }

  /// Adds the robots in conflict at a place of the path of those that were in none.
  void add_touching_others(const RobotsPath& rest, double along) {
    Configuration part(rest.axes().size());
    rest.at(along, part);
    // The robots in conflict before are where they were in the window: only those of two others are added.
    std::set<std::size_t> robots(conflict_->robots.begin(), conflict_->robots.end());
    const std::set<std::size_t> before = robots;
    Configuration q(context_.instance.space.dimension());
    for (std::size_t j = 0; j < part.size(); ++j) q[rest.axes()[j]] = part[j];
    std::size_t nearest_first = 0, nearest_second = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < members_.size(); ++i) {
      for (std::size_t k = i + 1; k < members_.size(); ++k) {
        if (before.contains(i) || before.contains(k)) continue;
        const Pair& pair = pair_of(i, k);
        const Configuration of_pair = picked(q, pair.axes);
        if (!context_.instance.check_one([&] { return pair.instance->validity->state(of_pair); })) {
          touch(i, k, robots);
          nearest = 0.0;
        } else if (nearest > 0.0) {
          const double clearance = pair.instance->validity->clearance(of_pair);
          if (clearance < nearest) {
            nearest = clearance;
            nearest_first = i;
            nearest_second = k;
          }
        }
      }
    }
    // Those that come too close to certify that they pass.
    if (nearest > 0.0 && std::isfinite(nearest)) touch(nearest_first, nearest_second, robots);
    conflict_->robots.assign(robots.begin(), robots.end());
  }

  /// Replaces the window by a path found for it.
  void repair(const Configurations& found) {
    Configurations path(path_.dimension());
    const Configurations& old = path_;
    for (std::size_t i = 0; i < times_.size() && times_[i] < window_.from; ++i) path.push(old[i]);
    for (std::size_t i = 0; i < found.size(); ++i) path.push(found[i]);
    valid_to_ = path.size() - 1;
    for (std::size_t i = 0; i < times_.size(); ++i) {
      if (times_[i] > window_.to) path.push(old[i]);
    }
    path_ = std::move(path);
    note_conflict(conflict_->together ? TeamConflict::Resolved::together : TeamConflict::Resolved::one_by_one);
    conflict_.reset();
    note_times();
  }

  std::shared_ptr<TeamSpace> space_;  ///< of the last search
  std::vector<RobotsPath> alone_;     ///< of this try: the paths found for single robots
  Configurations path_;               ///< of the team; empty before all robots have one
  std::vector<double> times_;         ///< of its configurations, seconds
  std::size_t valid_to_ = 0;          ///< the configuration up to which it is valid
  std::optional<Conflict> conflict_;  ///< the one that is repaired
  Window window_;
  std::map<std::pair<std::size_t, std::size_t>, Pair> pairs_;
};

}  // namespace

std::unique_ptr<Planner> make_conflict_search(TeamSearchContext context) {
  return std::make_unique<ConflictSearch>(std::move(context));
}

}  // namespace trellis
