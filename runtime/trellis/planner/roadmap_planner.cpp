// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/roadmap_planner.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/instance/search_cost.hpp>
#include <trellis/planner/tree.hpp>

namespace trellis {

namespace {

std::size_t outside_in(std::size_t i, std::size_t n) { return i % 2 == 0 ? i / 2 : n - 1 - i / 2; }

}  // namespace

RoadmapPlanner::RoadmapPlanner(Connection connection, const Mode& mode, PlannerContext context)
    : Planner(std::move(context)),
      mode_(mode),
      connection_(connection),
      best_(context_, mode.improve),
      index_(context_.instance.space),
      blocked_motions_(dimension()),
      sample_(dimension()),
      target_(dimension()),
      blocked_(dimension()) {
  // If validity is presumed, validation of a node costs no checks.
  presumed_ = !context_.instance.validity->spends_checks();
  judged_ = mode_.lazy_nodes && !presumed_;
  // Without a guide, no level receives presumed connectivity.
  tracked_ = context_.guided || !presumed_;
  context_.search.expands = !judged_ || context_.guided;
}

std::optional<Status> RoadmapPlanner::begin(const Budget& budget) {
  static_cast<void>(budget);
  auto& instance = context_.instance;
  best_.begin();
  begin_evaluation();
  repaired_ = without_proposals_ = false;
  if (paths_.vertices() == 0) {
    if (const auto invalid = remove_invalid_goals(instance)) return invalid;
    if (instance.to_goal(instance.start) <= instance.goal_tolerance) {
      context_.search.nodes.push(instance.start);
      context_.search.parents.push_back(no_node);
      return Status::solved;
    }
    insert_ends();
  } else if (epoch_ != instance.epoch()) {
    if (const auto invalid = remove_invalid_goals(instance)) return invalid;
    repair();
    repaired_ = true;
  } else if (solved_) {
    owed_ = mode_.again;
  }
  solved_ = false;
  return owed_ > 0 ? std::nullopt : look();
}

std::optional<Status> RoadmapPlanner::follow() {
  blocked_motions_.report(context_);
  report_joined();
  enhance();
  const std::optional<Status> status = --owed_ > 0 ? std::nullopt : look();
  count_search();
  return status;
}

std::optional<Status> RoadmapPlanner::work() {
  const std::optional<Status> status = without_proposals_ ? look_without_proposals() : look();
  count_search();
  return status;
}

void RoadmapPlanner::count_search() {
  context_.instance.checks.other += search_cost::roadmap_edge * static_cast<double>(paths_.looked_at() - counted_);
  counted_ = paths_.looked_at();
}

void RoadmapPlanner::discard_paths() {
  count_search();
  paths_ = {};
  counted_ = 0;
}

std::optional<Status> RoadmapPlanner::stopped(Status limit) {
  if (without_proposals_) return limit;
  if (owed_ > 0 && repaired_) {
    // The repaired roadmap may contain another path.
    reconnects_ = lacks_proposals();
  } else if (lacks_proposals() && (owed_ == 0 || !paths_.search())) {
    reconnects_ = true;
  } else {
    return limit;
  }
  without_proposals_ = true;
  return std::nullopt;
}

std::optional<Status> RoadmapPlanner::look() {
  const std::uint32_t end = next_candidate();
  if (end == no_node) {
    if (context_.guided && mode_.lazy_edges) validate_ahead();
    owed_ = mode_.batch;
    return std::nullopt;
  }
  if (end != goal || paths_.cost() < best_cost_) {
    const bool valid = validated(end);
    report_joined();
    // The next step looks again. Each look removes at least one edge, so they end without new proposals.
    if (!valid || end != goal) return std::nullopt;
    best_cost_ = paths_.cost();
    best_.keep(path_to(goal));
  }
  if (best_.done()) {
    solved_ = true;
    return Status::solved;
  }
  owed_ = 1;
  return std::nullopt;
}

void RoadmapPlanner::begin_evaluation() {
  auto* presumed = dynamic_cast<EvaluatedValidity*>(context_.instance.validity.get());
  evaluator_ = mode_.lazy_edges && presumed != nullptr ? presumed->evaluator() : nullptr;
  if (evaluator_ == nullptr) return;
  how_ = evaluator_->how();
  const std::uint64_t epoch = evaluator_->begin();
  if (epoch == evaluation_epoch_) return;
  evaluation_epoch_ = epoch;
  for (auto* known : {&nodes_, &edges_}) {
    std::replace(known->begin(), known->end(), Known::evaluated, Known::unknown);
  }
  nearest_evaluated_ = std::numeric_limits<double>::infinity();
}

std::uint32_t RoadmapPlanner::next_candidate() {
  if (evaluator_ == nullptr || how_.event == LazyEvaluation::Event::shortest_path || evaluator_->exhausted()) {
    return paths_.search() ? goal : no_node;
  }
  return paths_.search_until([&](std::uint32_t vertex) { return is_event(vertex); });
}

bool RoadmapPlanner::is_event(std::uint32_t vertex) {
  using Event = LazyEvaluation::Event;
  const bool progress = how_.event == Event::heuristic_progress;
  if (progress && context_.instance.to_goal(node(vertex)) >= nearest_evaluated_) return false;
  paths_.path(vertex, path_);
  std::int64_t edges = 0;
  double length = 0.0;
  for (const std::uint32_t id : path_) {
    if (edges_[id] == Known::evaluated) continue;
    ++edges;
    length += context_.instance.space.distance(node(paths_.edge(id).a), node(paths_.edge(id).b));
  }
  switch (how_.event) {
    case Event::shortest_path: return false;
    case Event::constant_depth: return edges >= how_.depth;
    case Event::heuristic_progress: return edges > 0;
    case Event::subpath_existence: return std::exp(-length / mean_valid_length()) < how_.existence;
  }
  return false;
}

double RoadmapPlanner::mean_valid_length() const {
  const auto& instance = context_.instance;
  return (instance.to_goal(instance.start) + evaluated_length_) / (1.0 + evaluated_invalid_);
}

void RoadmapPlanner::insert_ends() {
  const auto& instance = context_.instance;
  epoch_ = instance.epoch();
  goals_end_ = goal + static_cast<std::uint32_t>(instance.goals.size());
  insert(instance.start, Known::valid);
  for (const auto& end : instance.goals) insert(end, Known::valid);
  // These edges extend a path to any goal to the first goal.
  for (std::uint32_t further = goal + 1; further < goals_end_; ++further) {
    jumps_.push_back(paths_.add_edge(further, goal, jump_cost));
    edges_.push_back(Known::valid);
    passes_.push_back(0);
  }
  blocked_motions_.report(context_);
  report_joined();
  // A guide proposes samples ahead of connected vertices, so the planner reports the first vertices after one batch.
  owed_ = context_.guided ? std::min(mode_.samples, mode_.batch) : mode_.samples;
  validated_ahead_ = goals_end_;
}

void RoadmapPlanner::repair() {
  auto& instance = context_.instance;
  best_.forget();
  best_cost_ = std::numeric_limits<double>::infinity();
  const auto same = [](View a, View b) { return std::equal(a.begin(), a.end(), b.begin()); };
  const auto is_goal = [&](std::uint32_t id) {
    return std::ranges::any_of(instance.goals, [&](const auto& end) { return same(node(id), end); });
  };
  std::size_t goals = 0;
  for (std::uint32_t id = goal; id < goals_end_; ++id) goals += is_goal(id) ? 1 : 0;
  if (!same(node(LifelongSearch::start), instance.start) || goals < instance.goals.size()) {
    index_ = NearestIndex(instance.space);
    discard_paths();
    connectivity_ = {};
    for (auto* rows : {&rows_, &jumps_, &presumed_edges_}) rows->clear();
    for (auto* known : {&nodes_, &edges_}) known->clear();
    invalid_nodes_ = 0;
    for (auto* bytes : {&passes_, &reported_}) bytes->clear();
    joined_.clear();
    seeds_.clear();
    pairs_.clear();
    lost_neighbour_.clear();
    reconnecting_ = false;
    insert_ends();
    return;
  }
  epoch_ = instance.epoch();
  // The validated part of the last path needs less effort from now on.
  for (const std::uint32_t id : path_) {
    const auto& edge = paths_.edge(id);
    if (edge.removed || is_jump(id)) continue;
    const View a = node(edge.a);
    const View b = node(edge.b);
    paths_.set_cost(id, instance.space.distance(a, b) * cost_factor(a, b));
  }
  refuted_.clear();
  if (presumed_) {
    // Only edges of the next paths are checked again.
    for (const std::uint32_t id : presumed_edges_) {
      if (edges_[id] == Known::valid) edges_[id] = Known::stale;
      passes_[id] = 0;
    }
    presumed_edges_.clear();
  } else {
    recheck_edges();
  }
  paths_.remove_edges(refuted_);
  refuted_.clear();
  for (auto& known : nodes_) known = known == Known::valid ? Known::stale : known;
  nodes_[LifelongSearch::start] = Known::valid;
  for (std::uint32_t id = goal; id < goals_end_; ++id) {
    nodes_[id] = Known::valid;
    if (!is_goal(id)) remove_goal(id);
  }
  disconnected_ = true;
  if (!presumed_) rebuild_connectivity();
  report_joined();
}

void RoadmapPlanner::recheck_edges() {
  auto& instance = context_.instance;
  // If a change lists what became invalid, no edge is checked again; else only edges of the next paths are.
  bool free = true;
  for (std::uint32_t id = 0; id < paths_.edges(); ++id) {
    if (edges_[id] == Known::unknown) passes_[id] = 0;
    if ((edges_[id] != Known::valid && edges_[id] != Known::stale) || paths_.edge(id).removed || is_jump(id)) continue;
    const auto& edge = paths_.edge(id);
    if (free) {
      const std::uint64_t before = instance.checks.validity;
      const bool valid = motion_still_valid(context_, node(edge.a), node(edge.b), 0);
      free = instance.checks.validity == before;
      edges_[id] = valid ? Known::valid : Known::invalid;
      if (!valid) refuted_.push_back(id);
    } else {
      edges_[id] = Known::stale;
      passes_[id] = 0;
    }
  }
}

void RoadmapPlanner::remove_goal(std::uint32_t vertex) {
  for (std::uint32_t id = 0; id < paths_.edges(); ++id) {
    const auto& edge = paths_.edge(id);
    if (edge.removed || (edge.a != vertex && edge.b != vertex)) continue;
    // Paths to the other goals end at the first goal.
    if (vertex == goal && is_jump(id)) continue;
    edges_[id] = Known::invalid;
    paths_.remove_edge(id);
  }
}

Outcome RoadmapPlanner::extend(View proposal) {
  auto& instance = context_.instance;
  Outcome outcome;
  outcome.proposal = proposal;
  const bool grows = mode_.step < std::numeric_limits<double>::infinity();
  if (!grows && mode_.lazy_nodes && !context_.guided) {
    // The search for neighbours also finds whether the node exists.
    if (insert(proposal, Known::unknown, true)) {
      outcome.fate = Fate::reached;
      outcome.added = proposal;
      note_added(outcome);
    }
    return outcome;
  }
  const bool one_search = inserts_proposals();
  NearestIndex::Neighbour near;
  if (one_search) {
    target_.assign(proposal.begin(), proposal.end());
  } else {
    near = index_.nearest(proposal);
  }
  if (grows) {
    outcome.near = node(near.id);
    outcome.near_row = rows_[near.id];
  }
  const bool reaches = one_search || steer(instance.space, node(near.id), proposal, std::sqrt(near.squared_distance),
                                           mode_.step, target_);
  if (!mode_.lazy_nodes && !target_valid()) {
    outcome.blocked_at = target_;
    return outcome;
  }
  if (one_search) find_neighbours(target_);
  if (one_search ? is_neighbour() : near.squared_distance == 0.0) return outcome;
  if (one_search) {
    if (disconnected_) rebuild_connectivity();
    context_.instance.spend(connection_work(false));
    insert_found(target_, Known::valid);
  } else {
    insert(target_, mode_.lazy_nodes ? Known::unknown : Known::valid);
  }
  outcome.fate = reaches ? Fate::reached : Fate::advanced;
  if (grows) outcome.near = node(near.id);
  outcome.added = target_;
  note_added(outcome);
  return outcome;
}

void RoadmapPlanner::note_added(Outcome& outcome) {
  const auto id = static_cast<std::uint32_t>(rows_.size() - 1);
  outcome.connected = connectivity_.connected(id, Connectivity::to_start);
  if (outcome.connected) reported_[id] |= Connectivity::to_start;
  outcome.added_row = rows_.back();
}

void RoadmapPlanner::look_ahead(std::size_t step, StepAhead& ahead, Validity& validity) const {
  static_cast<void>(step);
  const View q = ahead.proposal;
  ahead.valid = validity.state(q);
  if (!*ahead.valid) return;
  connection_.find(index_, q, ahead.neighbours);
  ahead.nodes = index_.size();
  auto& components = ahead.components;
  components.clear();
  for (const auto& neighbour : ahead.neighbours) {
    if (neighbour.squared_distance == 0.0) return;
    if (nodes_[neighbour.id] == Known::invalid) continue;
    const std::uint32_t component = connectivity_.component(neighbour.id);
    const bool later = mode_.between_components && !presumed_;
    if (later && std::find(components.begin(), components.end(), component) != components.end()) continue;
    const MotionReport report = validity.motion(node(neighbour.id), q);
    ahead.add_motion(node(neighbour.id), q, report);
    if (report.valid) components.push_back(component);
  }
}

bool RoadmapPlanner::target_valid() {
  auto& instance = context_.instance;
  const StepAhead* ahead = present();
  if (ahead == nullptr || !ahead->valid) return instance.valid(target_);
  // Counts as Instance::valid does.
  if (!instance.validity->spends_checks()) {
    instance.spend(search_cost::presumed);
    return *ahead->valid;
  }
  return instance.check_one([&] {
    announce_checks(1);
    return *ahead->valid;
  });
}

void RoadmapPlanner::mark_new_nodes(bool begins) {
  new_nodes_.reset();
  if (begins) new_nodes_.emplace(context_.instance.space);
}

void RoadmapPlanner::find_neighbours(View q) {
  const StepAhead* ahead = present();
  const bool known = ahead != nullptr && ahead->nodes > 0 &&
                     connection_.find_since(index_, q, ahead->neighbours, ahead->nodes, *new_nodes_, neighbours_);
  if (!known) connection_.find(index_, q, neighbours_);
}

void RoadmapPlanner::enhance() {
  if (seeds_.empty()) return;
  const auto& space = context_.instance.space;
  for (enhancements_ += mode_.enhance; enhancements_ >= 1.0; enhancements_ -= 1.0) {
    const auto& [a, b] = seeds_[context_.proposals.below(seeds_.size())];
    space.interpolate(node(a), node(b), 0.5, sample_);
    const double sigma = mode_.spread * space.distance(node(a), node(b));
    for (std::size_t j = 0; j < sample_.size(); ++j) {
      sample_[j] += sigma * context_.proposals.normal() / space.axes()[j].weight;
    }
    space.reflect(sample_);
    if (!space.contains(sample_) || index_.nearest(sample_).squared_distance == 0.0) continue;
    insert(sample_, Known::unknown);
    Outcome outcome;
    outcome.fate = Fate::reached;
    outcome.proposal = sample_;
    outcome.added = sample_;
    outcome.added_row = rows_.back();
    outcome.connected = false;
    context_.guidance.observe(outcome, false);
    report_joined();
  }
}

bool RoadmapPlanner::insert(View q, Known known, bool unless_there) {
  if (disconnected_) rebuild_connectivity();
  const bool among_valid = mode_.lazy_nodes && (context_.guided || presumed_);
  if (among_valid) {
    // Without a guide, invalid nodes count as neighbours, as in the published algorithm.
    connection_.find(index_, q, neighbours_, [&](std::uint32_t id) { return nodes_[id] != Known::invalid; });
  } else {
    connection_.find(index_, q, neighbours_);
  }
  context_.instance.spend(connection_work(among_valid));
  if (unless_there && is_neighbour()) return false;
  insert_found(q, known);
  return true;
}

double RoadmapPlanner::connection_work(bool among_valid) const {
  // A query of the nearest nodes compares groups of eight: a few in the plane, most of them in seven dimensions; and as
  // many more as invalid nodes are passed over.
  constexpr double of_group = 1.0 / 8.0;
  const auto all = static_cast<double>(index_.size());
  const double valid = among_valid ? std::max(1.0, all - static_cast<double>(invalid_nodes_)) : all;
  const double few =
      std::exp2(static_cast<double>(context_.instance.space.degrees())) * (valid > 0.0 ? all / valid : 1.0);
  return search_cost::node + search_cost::node_compared * std::min(few, of_group * all);
}

bool RoadmapPlanner::is_neighbour() const {
  return std::any_of(neighbours_.begin(), neighbours_.end(),
                     [](const auto& neighbour) { return neighbour.squared_distance == 0.0; });
}

void RoadmapPlanner::insert_found(View q, Known known) {
  rows_.push_back(context_.search.nodes.push(q));
  context_.search.parents.push_back(no_node);
  nodes_.push_back(known);
  if (judged_) context_.search.validated.push_back(known != Known::unknown ? 1 : 0);
  index_.add(q);
  if (new_nodes_) new_nodes_->add(q);
  // The bound is 0 for several goals, because an edge between goals costs less than the difference of their distances
  // to the start.
  const double to_goal = context_.instance.to_goal(q);
  double to_start =
      context_.instance.goals.size() > 1 ? 0.0 : context_.instance.space.distance(context_.instance.start, q);
  // A search that grows only the tree from the start uses the full bound.
  if (how_.event != LazyEvaluation::Event::shortest_path) to_start = -to_goal;
  const std::uint32_t id = paths_.add_vertex(to_goal, to_start);
  connectivity_.add_vertex(side_of(id));
  reported_.push_back(side_of(id));
  for (const auto& neighbour : neighbours_) {
    const double length = std::sqrt(neighbour.squared_distance);
    if (nodes_[neighbour.id] == Known::invalid) continue;
    const bool later = deferred(neighbour.id, id);
    if (!later) {
      const StepAhead* ahead = present();
      const MotionReport report = context_.instance.motion(
          node(neighbour.id), node(id), ahead != nullptr ? ahead->motion(node(neighbour.id), node(id)) : nullptr);
      if (!report.valid) {
        blocked_motions_.add(context_.instance.space, node(neighbour.id), node(id), report.invalid_at);
        continue;
      }
    }
    add_edge(neighbour.id, id, length, later ? Known::unknown : Known::valid);
  }
}

double RoadmapPlanner::cost_factor(View a, View b) const {
  // An eager roadmap is searched for the shortest path.
  if (!mode_.lazy_edges) return 1.0;
  double factor = context_.instance.validity->effort_factor(a, b);
  if (context_.guided) factor *= context_.guidance.edge_factor(a, b).value_or(1.0);
  return factor;
}

void RoadmapPlanner::add_edge(std::uint32_t a, std::uint32_t b, double length, Known known) {
  const std::uint32_t edge = paths_.add_edge(a, b, length * cost_factor(node(a), node(b)));
  // Without lazy edges the record has those that were found valid.
  if (mode_.lazy_edges || known != Known::unknown) context_.search.edges.push_back({rows_[a], rows_[b]});
  edges_.push_back(known);
  passes_.push_back(0);
  if (known == Known::valid && presumed_) presumed_edges_.push_back(edge);
  if (checked(edge)) join(edge);
}

void RoadmapPlanner::validate_ahead() {
  const std::uint32_t before = std::exchange(validated_ahead_, static_cast<std::uint32_t>(paths_.vertices()));
  paths_.search_all();
  for (std::uint32_t id = validated_ahead_; id-- > before;) {
    if (!paths_.reached(id) || connectivity_.connected(id, Connectivity::to_start)) continue;
    // One attempt: a node behind an obstacle has many paths, all of them invalid.
    validate_prefix(id);
    report_joined();
    return;
  }
}

void RoadmapPlanner::validate_prefix(std::uint32_t end) {
  paths_.path(end, path_);
  stops_ = {0};
  for (const std::uint32_t edge : path_) stops_.push_back(paths_.other(edge, stops_.back()));
  for (std::size_t at = 0; at < path_.size(); ++at) {
    if (!node_valid(stops_[at + 1])) {
      remove_refuted_nodes();
      return;
    }
    if (!edge_valid(at)) return;
  }
}

std::size_t RoadmapPlanner::reconnect() {
  const auto pair = [](std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32U) | std::max(a, b);
  };
  if (pairs_.empty()) {
    for (std::uint32_t id = 0; id < paths_.edges(); ++id) pairs_.insert(pair(paths_.edge(id).a, paths_.edge(id).b));
  }
  std::sort(lost_neighbour_.begin(), lost_neighbour_.end());
  lost_neighbour_.erase(std::unique(lost_neighbour_.begin(), lost_neighbour_.end()), lost_neighbour_.end());
  std::size_t added = 0;
  for (const std::uint32_t id : lost_neighbour_) {
    if (nodes_[id] == Known::invalid) continue;
    context_.instance.spend(connection_work(true));
    connection_.find(index_, node(id), neighbours_,
                     [&](std::uint32_t other) { return other != id && nodes_[other] != Known::invalid; });
    for (const auto& neighbour : neighbours_) {
      if (!pairs_.insert(pair(id, neighbour.id)).second) continue;
      add_edge(neighbour.id, id, std::sqrt(neighbour.squared_distance), Known::unknown);
      ++added;
    }
  }
  lost_neighbour_.clear();
  return added;
}

std::optional<Status> RoadmapPlanner::look_without_proposals() {
  while (!paths_.search()) {
    if (!reconnects_) return Status::budget_spent;
    if (!std::exchange(reconnecting_, true)) {
      lost_neighbour_.resize(paths_.vertices());
      std::iota(lost_neighbour_.begin(), lost_neighbour_.end(), std::uint32_t{0});
    }
    if (reconnect() == 0) return Status::budget_spent;
  }
  const bool valid = validated(goal);
  report_joined();
  if (!valid) return std::nullopt;
  solved_ = true;
  best_.keep(path_to(goal));
  return Status::solved;
}

bool RoadmapPlanner::validated(std::uint32_t end) {
  paths_.path(end, path_);
  stops_ = {0};
  for (const std::uint32_t edge : path_) stops_.push_back(paths_.other(edge, stops_.back()));
  if (evaluator_ != nullptr) return evaluated(end);
  // Removes all invalid nodes of the path at once: each of them blocks the path, and one repair of the search covers
  // all.
  refuted_.clear();
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    if (!node_valid(stops_[outside_in(i, stops_.size())]) && mode_.remove_first) break;
  }
  if (!refuted_.empty()) {
    remove_refuted_nodes();
    return false;
  }
  if (mode_.coarse_to_fine && !coarsely_valid()) return false;
  for (std::size_t i = 0; i < path_.size(); ++i) {
    if (edge_valid(outside_in(i, path_.size()))) continue;
    if (mode_.between_components) check_deferred();
    return false;
  }
  return true;
}

void RoadmapPlanner::check_deferred() {
  std::vector<std::uint32_t> edges;
  for (const std::uint32_t id : stops_) paths_.edges_of(id, edges);
  refuted_.clear();
  for (const std::uint32_t id : edges) {
    if (edges_[id] != Known::unknown) continue;
    const auto& edge = paths_.edge(id);
    const MotionReport report = context_.instance.motion(node(edge.a), node(edge.b));
    if (report.valid) {
      found_valid(id);
    } else {
      edges_[id] = Known::invalid;
      refuted_.push_back(id);
      context_.instance.space.interpolate(node(edge.a), node(edge.b), report.invalid_at, blocked_);
      report_blocked(node(edge.a), node(edge.b));
    }
  }
  paths_.remove_edges(refuted_);
  refuted_.clear();
}

void RoadmapPlanner::found_valid(std::uint32_t id) {
  // Without lazy edges the record has those that were found valid.
  if (!mode_.lazy_edges && edges_[id] == Known::unknown) {
    context_.search.edges.push_back({rows_[paths_.edge(id).a], rows_[paths_.edge(id).b]});
  }
  edges_[id] = Known::valid;
  if (presumed_) presumed_edges_.push_back(id);
  join(id);
}

bool RoadmapPlanner::evaluated(std::uint32_t end) {
  const bool valid = nodes_evaluated() && (!mode_.coarse_to_fine || coarsely_valid()) && edges_evaluated();
  // Evaluated edges need less effort from now on.
  for (const std::uint32_t id : path_) {
    if (edges_[id] != Known::evaluated || is_jump(id)) continue;
    const View a = node(paths_.edge(id).a);
    const View b = node(paths_.edge(id).b);
    paths_.set_cost(id, context_.instance.space.distance(a, b) * cost_factor(a, b));
  }
  // The part removed from S belongs to no other path that is known to be valid.
  epoch_ = context_.instance.epoch();
  if (valid) nearest_evaluated_ = std::min(nearest_evaluated_, context_.instance.to_goal(node(end)));
  return valid;
}

bool RoadmapPlanner::nodes_evaluated() {
  // A presumed invalid configuration costs no checks to detect.
  const auto holds = [&](std::uint32_t id) {
    if (!context_.instance.validity->state(node(id))) return false;
    if (!evaluator_->sparse_first() || evaluator_->exhausted()) return true;
    if (!evaluator_->state(node(id))) return false;
    nodes_[id] = Known::evaluated;
    return true;
  };
  refuted_.clear();
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    const std::uint32_t id = stops_[selected(i, stops_.size())];
    if (nodes_[id] == Known::evaluated || id < goals_end_) continue;
    if (!holds(id)) refute_node(id);
    if (!refuted_.empty() && mode_.remove_first) break;
  }
  if (refuted_.empty()) return true;
  remove_refuted_nodes();
  return false;
}

bool RoadmapPlanner::edges_evaluated() {
  auto& validity = *context_.instance.validity;
  const auto& space = context_.instance.space;
  std::vector<std::size_t> order(path_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = selected(i, order.size());
  if (how_.selector == LazyEvaluation::Selector::fail_fast) {
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return space.distance(node(stops_[a]), node(stops_[a + 1])) >
             space.distance(node(stops_[b]), node(stops_[b + 1]));
    });
  }
  const auto open = [&](std::size_t at) { return edges_[path_[at]] != Known::evaluated && !is_jump(path_[at]); };
  // Presumed invalid edges are removed at once: detecting them costs no checks, and the path needs each of its edges.
  bool presumed = true;
  for (const std::size_t at : order) {
    if (!open(at)) continue;
    const MotionReport report = validity.motion(node(stops_[at]), node(stops_[at + 1]));
    if (report.valid) continue;
    presumed = false;
    remove_edge(at, report.invalid_at);
  }
  if (!presumed) return false;
  for (const bool whole : {false, true}) {
    if (!whole && !evaluator_->sparse_first()) continue;
    for (const std::size_t at : order) {
      if (!open(at)) continue;
      if (evaluator_->exhausted()) return true;
      const View a = node(stops_[at]);
      const View b = node(stops_[at + 1]);
      const MotionReport report = whole ? evaluator_->motion(a, b) : evaluator_->sparsely(a, b);
      if (!report.valid) {
        evaluated_invalid_ += 1.0;
        remove_edge(at, report.invalid_at);
        return false;
      }
      if (!whole) continue;
      evaluated_length_ += space.distance(a, b);
      edges_[path_[at]] = nodes_[stops_[at]] = nodes_[stops_[at + 1]] = Known::evaluated;
      join(path_[at]);
    }
  }
  return true;
}

std::size_t RoadmapPlanner::selected(std::size_t i, std::size_t n) const {
  switch (how_.selector) {
    case LazyEvaluation::Selector::alternate: return outside_in(i, n);
    case LazyEvaluation::Selector::backward: return n - 1 - i;
    case LazyEvaluation::Selector::forward:
    case LazyEvaluation::Selector::fail_fast: return i;
  }
  return i;
}

bool RoadmapPlanner::node_valid(std::uint32_t id) {
  auto& instance = context_.instance;
  if (nodes_[id] == Known::valid || nodes_[id] == Known::evaluated) return true;
  if (judged_) context_.search.validated[rows_[id]] = 1;
  // A single configuration is checked as a motion to itself.
  if (nodes_[id] == Known::stale ? instance.motion_still_valid(node(id), node(id)) : instance.valid(node(id))) {
    nodes_[id] = Known::valid;
    return true;
  }
  refute_node(id);
  return false;
}

void RoadmapPlanner::refute_node(std::uint32_t id) {
  nodes_[id] = Known::invalid;
  ++invalid_nodes_;
  refuted_.push_back(id);
  disconnected_ = disconnected_ || presumed_;
  const View q = node(id);
  blocked_.assign(q.begin(), q.end());
  report_blocked(blocked_, blocked_);
}

void RoadmapPlanner::remove_refuted_nodes() {
  if (reconnecting_) {
    for (const std::uint32_t id : refuted_) paths_.neighbours(id, lost_neighbour_);
  }
  paths_.isolate(refuted_);
  refuted_.clear();
}

bool RoadmapPlanner::edge_valid(std::size_t at) {
  auto& instance = context_.instance;
  const std::uint32_t id = path_[at];
  if (edges_[id] == Known::valid || edges_[id] == Known::evaluated) return true;
  const View from = node(stops_[at]);
  const View to = node(stops_[at + 1]);
  const MotionReport report =
      edges_[id] == Known::stale ? instance.recheck_motion(from, to) : instance.motion(from, to);
  if (report.valid) {
    found_valid(id);
    return true;
  }
  remove_edge(at, report.invalid_at);
  return false;
}

bool RoadmapPlanner::coarsely_valid() {
  auto& instance = context_.instance;
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
        if (evaluator_ != nullptr ? evaluator_->exhausted() || evaluator_->state(sample_) : instance.valid(sample_)) {
          continue;
        }
        remove_edge(at, t);
        return false;
      }
      if (presumed_ && passes_[id] == 0) presumed_edges_.push_back(id);
      passes_[id] = pass;
    }
    if (!looked) break;
  }
  return true;
}

void RoadmapPlanner::remove_edge(std::size_t at, double t) {
  const std::uint32_t id = path_[at];
  disconnected_ = disconnected_ || checked(id);
  edges_[id] = Known::invalid;
  context_.instance.space.interpolate(node(stops_[at]), node(stops_[at + 1]), t, blocked_);
  paths_.remove_edge(id);
  if (mode_.enhance > 0.0) seeds_.push_back({stops_[at], stops_[at + 1]});
  report_blocked(node(stops_[at]), node(stops_[at + 1]));
}

void RoadmapPlanner::report_blocked(View from, View to) {
  Outcome outcome;
  outcome.proposal = to;
  outcome.near = from;
  outcome.blocked_at = blocked_;
  context_.guidance.observe(outcome, false);
}

void RoadmapPlanner::join(std::uint32_t edge) {
  if (tracked_) connectivity_.join(paths_.edge(edge).a, paths_.edge(edge).b, joined_);
}

void RoadmapPlanner::report_joined() {
  if (joined_.empty()) return;
  for (const auto& [vertex, side] : joined_) {
    if ((reported_[vertex] & side) != 0) continue;
    reported_[vertex] |= side;
    Outcome outcome;
    outcome.fate = Fate::reached;
    outcome.proposal = node(vertex);
    outcome.added = node(vertex);
    outcome.added_row = rows_[vertex];
    outcome.from_goal = side == Connectivity::to_goal;
    context_.guidance.observe(outcome, false);
  }
  joined_.clear();
}

void RoadmapPlanner::rebuild_connectivity() {
  disconnected_ = false;
  if (!tracked_) return;
  connectivity_ = {};
  joined_.clear();
  for (std::uint32_t id = 0; id < paths_.vertices(); ++id) connectivity_.add_vertex(side_of(id));
  for (std::uint32_t id = 0; id < paths_.edges(); ++id) {
    if (!paths_.edge(id).removed && checked(id) && !is_jump(id)) join(id);
  }
}

Configurations RoadmapPlanner::path_to(std::uint32_t end) {
  // Not `path_`: a record of a run may be made while that path is validated.
  std::vector<std::uint32_t> edges;
  paths_.path(end, edges);
  Configurations path(dimension());
  std::uint32_t at = LifelongSearch::start;
  path.push(node(at));
  for (const std::uint32_t edge : edges) {
    if (is_jump(edge)) break;
    at = paths_.other(edge, at);
    path.push(node(at));
  }
  return path;
}

Solution RoadmapPlanner::solution(Status status) {
  // The start is at the goal.
  if (paths_.vertices() == 0) return {status, path_of_start(context_.instance)};
  if (best_.known() && (solved_ || mode_.improve > 0.0)) return best_.solution(status);
  // A search that only pauses does not extend its tree.
  if (status != Status::paused) paths_.search_all();
  // Ends at the node of the search tree that is nearest to the goal.
  std::uint32_t end = LifelongSearch::start;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t id = 0; id < paths_.vertices(); ++id) {
    if (!paths_.reached(id) || id == goal) continue;
    const double distance = context_.instance.to_goal(node(id));
    if (distance < least) {
      least = distance;
      end = id;
    }
  }
  return {status, path_to(end)};
}

}  // namespace trellis
