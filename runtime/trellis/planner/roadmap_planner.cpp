// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/roadmap_planner.hpp>

#include <algorithm>
#include <cmath>

namespace trellis {

namespace {

std::size_t outside_in(std::size_t i, std::size_t n) { return i % 2 == 0 ? i / 2 : n - 1 - i / 2; }

}  // namespace

RoadmapPlanner::RoadmapPlanner(Connection connection, const Mode& mode, Task task)
    : mode_(mode),
      task_(std::move(task)),
      connection_(connection),
      best_(task_, mode.improve),
      index_(task_.instance.space),
      sample_(dimension()),
      target_(dimension()),
      blocked_(dimension()) {
  // What is presumed is looked at for nothing.
  judged_ = mode_.lazy_nodes && task_.instance.validity->spends_checks();
  task_.search.expands = !judged_ || task_.guided;
}

Solution RoadmapPlanner::solve(const Budget& budget) {
  auto& instance = task_.instance;
  Meter meter(task_, budget);
  best_.begin();
  if (paths_.vertices() == 0) {
    if (auto nothing = invalid_ends(instance)) return std::move(*nothing);
    if (instance.to_goal(instance.start) <= instance.goal_tolerance) {
      Solution solution{Status::solved, Configurations(dimension())};
      task_.search.nodes.push(instance.start);
      task_.search.parents.push_back(no_node);
      solution.path.push(instance.start);
      return solution;
    }
    epoch_ = instance.validity->epoch();
    insert(instance.start, Known::valid);
    for (std::size_t i = 0; i < instance.goals(); ++i) insert(instance.goal_at(i), Known::valid);
    // A way to any of the goals is one to the first.
    for (std::uint32_t further = goal + 1; further <= instance.further_goals.size() + goal; ++further) {
      jumps_.push_back(paths_.add_edge(further, goal, jump_cost));
      edges_.push_back(Known::valid);
      passes_.push_back(0);
    }
    owed_ = mode_.samples;
  } else if (epoch_ != instance.validity->epoch()) {
    // What was found valid may not be so any more; only what the next paths use is looked at again.
    epoch_ = instance.validity->epoch();
    for (auto& known : nodes_) known = known == Known::valid ? Known::unknown : known;
    for (auto& known : edges_) known = known == Known::valid ? Known::unknown : known;
    std::fill(passes_.begin(), passes_.end(), std::uint8_t{0});
    nodes_[0] = nodes_[1] = Known::valid;
    for (const std::uint32_t jump : jumps_) edges_[jump] = Known::valid;
    best_.forget();
    best_cost_ = std::numeric_limits<double>::infinity();
  } else if (solved_) {
    owed_ = mode_.again;
  }
  solved_ = false;
  for (;;) {
    for (; owed_ > 0; --owed_) {
      if (const auto reason = meter.spent()) return finish(*reason);
      grow();
      enhance();
    }
    if (!paths_.search()) {
      owed_ = mode_.batch;
      continue;
    }
    if (paths_.cost() < best_cost_) {
      if (!validated()) {
        // Each round removes at least one edge, so without new proposals this ends; the budget of checks still holds.
        if (const auto reason = meter.spent()) return finish(*reason);
        continue;
      }
      best_cost_ = paths_.cost();
      best_.keep(way_to(goal));
    }
    if (best_.done()) {
      solved_ = true;
      return best_.solution(Status::solved);
    }
    owed_ = 1;
  }
}

void RoadmapPlanner::grow() {
  auto& instance = task_.instance;
  propose(task_, sample_);
  Outcome outcome;
  outcome.proposal = sample_;
  const auto near = index_.nearest(sample_);
  const bool grows = mode_.step < std::numeric_limits<double>::infinity();
  const std::uint32_t from = grows ? rows_[near.id] : no_node;
  if (grows) outcome.near = node(near.id);
  const bool reaches =
      steer(instance.space, node(near.id), sample_, std::sqrt(near.squared_distance), mode_.step, target_);
  if (!mode_.lazy_nodes && !instance.valid(target_)) {
    outcome.blocked_at = target_;
    settle(task_, outcome, from);
    return;
  }
  if (near.squared_distance == 0.0) {
    settle(task_, outcome, from);
    return;
  }
  insert(target_, mode_.lazy_nodes ? Known::unknown : Known::valid);
  outcome.fate = reaches ? Fate::reached : Fate::advanced;
  if (grows) outcome.near = node(near.id);
  outcome.added = target_;
  settle(task_, outcome, from, rows_.back());
}

void RoadmapPlanner::enhance() {
  if (seeds_.empty()) return;
  const auto& space = task_.instance.space;
  for (enhancements_ += mode_.enhance; enhancements_ >= 1.0; enhancements_ -= 1.0) {
    const auto& [a, b] = seeds_[task_.proposals.below(seeds_.size())];
    space.interpolate(node(a), node(b), 0.5, sample_);
    const double sigma = mode_.spread * space.distance(node(a), node(b));
    for (std::size_t j = 0; j < sample_.size(); ++j) {
      sample_[j] += sigma * task_.proposals.normal() / space.axes()[j].weight;
    }
    space.reflect(sample_);
    if (space.contains(sample_) && index_.nearest(sample_).squared_distance > 0.0) insert(sample_, Known::unknown);
  }
}

void RoadmapPlanner::insert(View q, Known known) {
  connection_.find(index_, q, neighbours_);
  rows_.push_back(task_.search.nodes.push(q));
  task_.search.parents.push_back(no_node);
  nodes_.push_back(known);
  if (judged_) task_.search.looked_at.push_back(known != Known::unknown ? 1 : 0);
  index_.add(q);
  const std::uint32_t id = paths_.add_vertex(task_.instance.to_goal(q));
  for (const auto& neighbour : neighbours_) {
    const double length = std::sqrt(neighbour.squared_distance);
    if (nodes_[neighbour.id] == Known::invalid) continue;
    if (!mode_.lazy_edges && !task_.instance.motion(node(neighbour.id), node(id)).valid) continue;
    paths_.add_edge(neighbour.id, id, length);
    task_.search.edges.push_back({rows_[neighbour.id], rows_[id]});
    edges_.push_back(mode_.lazy_edges ? Known::unknown : Known::valid);
    passes_.push_back(0);
  }
}

bool RoadmapPlanner::validated() {
  auto& instance = task_.instance;
  paths_.path(goal, path_);
  stops_ = {0};
  for (const std::uint32_t edge : path_) stops_.push_back(paths_.other(edge, stops_.back()));
  // All invalid nodes of the path may go at once: each would have to go before this way could be ruled out, and one
  // repair of the search serves them all.
  bool sound = true;
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    const std::size_t at = outside_in(i, stops_.size());
    const std::uint32_t id = stops_[at];
    if (nodes_[id] != Known::unknown) continue;
    if (judged_) task_.search.looked_at[rows_[id]] = 1;
    if (instance.valid(node(id))) {
      nodes_[id] = Known::valid;
      continue;
    }
    sound = false;
    nodes_[id] = Known::invalid;
    paths_.isolate(id);
    const View q = node(id);
    blocked_.assign(q.begin(), q.end());
    tell_blocked();
    if (mode_.remove_first) return false;
  }
  if (!sound || (mode_.coarse_to_fine && !coarsely_valid())) return false;
  for (std::size_t i = 0; i < path_.size(); ++i) {
    const std::size_t at = outside_in(i, path_.size());
    const std::uint32_t id = path_[at];
    if (edges_[id] != Known::unknown) continue;
    const MotionReport report = instance.motion(node(stops_[at]), node(stops_[at + 1]));
    if (report.valid) {
      edges_[id] = Known::valid;
      continue;
    }
    remove_edge(at, report.invalid_at);
    return false;
  }
  return true;
}

bool RoadmapPlanner::coarsely_valid() {
  auto& instance = task_.instance;
  for (std::uint8_t pass = 1; pass < 32; ++pass) {
    const std::uint32_t pieces = std::uint32_t{1} << pass;
    bool looked = false;
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const std::size_t at = outside_in(i, path_.size());
      const std::uint32_t id = path_[at];
      if (edges_[id] != Known::unknown || paths_.edge(id).cost / pieces < 4.0 * instance.resolution) continue;
      looked = true;
      if (passes_[id] >= pass) continue;
      for (std::uint32_t k = 1; k < pieces; k += 2) {
        const double t = static_cast<double>(k) / pieces;
        instance.space.interpolate(node(stops_[at]), node(stops_[at + 1]), t, sample_);
        if (instance.valid(sample_)) continue;
        remove_edge(at, t);
        return false;
      }
      passes_[id] = pass;
    }
    if (!looked) break;
  }
  return true;
}

void RoadmapPlanner::remove_edge(std::size_t at, double t) {
  const std::uint32_t id = path_[at];
  edges_[id] = Known::invalid;
  task_.instance.space.interpolate(node(stops_[at]), node(stops_[at + 1]), t, blocked_);
  paths_.remove_edge(id);
  if (mode_.enhance > 0.0) seeds_.push_back({stops_[at], stops_[at + 1]});
  tell_blocked();
}

void RoadmapPlanner::tell_blocked() {
  Outcome outcome;
  outcome.proposal = blocked_;
  outcome.blocked_at = blocked_;
  task_.guidance.observe(outcome, false);
}

Configurations RoadmapPlanner::way_to(std::uint32_t end) {
  paths_.path(end, path_);
  Configurations way(dimension());
  std::uint32_t at = LifelongSearch::start;
  way.push(node(at));
  for (const std::uint32_t edge : path_) {
    if (std::find(jumps_.begin(), jumps_.end(), edge) != jumps_.end()) break;
    at = paths_.other(edge, at);
    way.push(node(at));
  }
  return way;
}

Solution RoadmapPlanner::finish(Status status) {
  if (best_.known() && mode_.improve > 0.0) return best_.solution(status);
  // Of the nodes that the search tree holds, the one nearest to the goal.
  paths_.search();
  std::uint32_t end = LifelongSearch::start;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t id = 0; id < paths_.vertices(); ++id) {
    if (!paths_.reached(id) || id == goal) continue;
    const double distance = task_.instance.to_goal(node(id));
    if (distance < least) {
      least = distance;
      end = id;
    }
  }
  return {status, way_to(end)};
}

}  // namespace trellis
