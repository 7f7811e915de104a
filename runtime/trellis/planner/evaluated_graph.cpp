// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/evaluated_graph.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace trellis {

bool EvaluatedGraph::begin() {
  if (graph_ == context_.instance.graph) return false;
  graph_ = context_.instance.graph;
  first_.assign(graph_->vertices.size() + 1, 0);
  for (const auto& edge : graph_->edges) {
    ++first_[edge.from + 1];
    ++first_[edge.to + 1];
  }
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  incident_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t e = 0; e < graph_->edges.size(); ++e) {
    const auto& edge = graph_->edges[e];
    incident_[next[edge.from]++] = {e, edge.to};
    incident_[next[edge.to]++] = {e, edge.from};
  }
  seen_.assign(graph_->edges.size(), 0);
  blocked_.clear();
  rows_.assign(graph_->vertices.size(), no_node);
  // Every vertex and every point of an edge is recorded once at most.
  std::size_t points = context_.search.nodes.size() + graph_->vertices.size();
  for (const auto& edge : graph_->edges) points += edge.points.size();
  context_.search.nodes.reserve(points);
  context_.search.parents.reserve(points);
  return true;
}

void EvaluatedGraph::renew() {
  if (context_.instance.epoch() == epoch_) return;
  epoch_ = context_.instance.epoch();
  for (char& seen : seen_) seen = seen == found_valid || seen == stale ? stale : char{0};
}

bool EvaluatedGraph::valid(std::uint32_t e, std::uint32_t to) {
  if (seen_[e] == 0 || seen_[e] == stale) {
    const std::uint32_t from = graph_->edges[e].from == to ? graph_->edges[e].to : graph_->edges[e].from;
    const View a = std::as_const(graph_->vertices)[from];
    const View b = std::as_const(graph_->vertices)[to];
    const MotionReport report =
        seen_[e] == stale ? context_.instance.recheck_motion(a, b) : context_.instance.motion(a, b);
    seen_[e] = report.valid ? found_valid : found_invalid;
    if (!report.valid) {
      Configuration& blocked = blocked_[e];
      blocked.resize(a.size());
      context_.instance.space.interpolate(a, b, report.invalid_at, blocked);
      Outcome outcome;
      outcome.proposal = b;
      outcome.near = a;
      outcome.blocked_at = blocked;
      context_.guidance.observe(outcome, false);
    }
  }
  return seen_[e] == found_valid;
}

void EvaluatedGraph::add_node(std::uint32_t v, std::uint32_t edge) {
  if (rows_[v] != no_node) return;
  auto& search = context_.search;
  rows_[v] = search.nodes.push(graph_->vertices[v]);
  search.parents.push_back(no_node);
  if (edge == none) return;
  const std::uint32_t from = graph_->edges[edge].from == v ? graph_->edges[edge].to : graph_->edges[edge].from;
  search.edges.push_back({rows_[from], rows_[v]});
}

void EvaluatedGraph::record(std::uint32_t e) {
  if (seen_[e] != 0) return;
  seen_[e] = 1;
  auto& search = context_.search;
  for (std::size_t i = 0; i < graph_->edges[e].points.size(); ++i) {
    const std::uint32_t row = search.nodes.push(graph_->edges[e].points[i]);
    search.parents.push_back(no_node);
    if (i > 0) search.edges.push_back({row - 1, row});
  }
}

void EvaluatedGraph::begin_proposals(std::int64_t samples) {
  const Graph& graph = *context_.instance.graph;
  index_.emplace(context_.instance.space);
  for (std::uint32_t v = 0; v < graph.vertices.size(); ++v) index_->add(graph.vertices[v]);
  proposals_ = {std::vector<double>(graph.vertices.size(), 0.0), 0.0};
  proposals_left_ = samples;
  connected_ = reachable();
  sample_.resize(context_.instance.space.dimension());
}

void EvaluatedGraph::draw_proposal() {
  const Graph& graph = *context_.instance.graph;
  propose(context_, sample_);
  const auto near = index_->nearest(sample_);
  proposals_.hits[near.id] += 1.0;
  proposals_.drawn += 1.0;
  --proposals_left_;
  Outcome outcome;
  outcome.proposal = sample_;
  outcome.near = std::as_const(graph.vertices)[near.id];
  outcome.added = outcome.near;
  outcome.fate = Fate::advanced;
  outcome.connected = connected_[near.id] != 0;
  record_outcome(context_, outcome);
}

Status EvaluatedGraph::result(const std::vector<char>& reached) const {
  const auto& goals = graph_->goals;
  const bool found = std::any_of(goals.begin(), goals.end(), [&](std::uint32_t v) { return reached[v] != 0; });
  return found ? Status::solved : Status::no_path;
}

Solution EvaluatedGraph::solution(const std::vector<std::uint32_t>& parent, const std::vector<char>& reached,
                                  Status otherwise) const {
  const Graph& graph = *graph_;
  const auto goal =
      std::find_if(graph.goals.begin(), graph.goals.end(), [&](std::uint32_t v) { return reached[v] != 0; });
  Solution solution{goal != graph.goals.end() ? Status::solved : otherwise,
                    Configurations(context_.instance.space.dimension())};
  std::uint32_t end = graph.start;
  if (solution.solved()) {
    end = *goal;
  } else {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t v = 0; v < graph.vertices.size(); ++v) {
      if (reached[v] == 0) continue;
      const double to_goal = context_.instance.to_goal(graph.vertices[v]);
      if (to_goal < least) {
        least = to_goal;
        end = v;
      }
    }
  }
  std::vector<std::uint32_t> edges;
  std::size_t points = 1;
  for (std::uint32_t at = end; at != graph.start;) {
    const auto& edge = graph.edges[parent[at]];
    edges.push_back(parent[at]);
    points += std::max<std::size_t>(1, edge.points.size());
    at = edge.from == at ? edge.to : edge.from;
  }
  solution.path.reserve(points);
  solution.path.push(graph.vertices[graph.start]);
  std::uint32_t at = graph.start;
  for (auto it = edges.rbegin(); it != edges.rend(); ++it) {
    const auto& edge = graph.edges[*it];
    const bool forward = edge.from == at;
    const std::size_t count = edge.points.size();
    for (std::size_t i = 1; i < count; ++i) solution.path.push(edge.points[forward ? i : count - 1 - i]);
    at = forward ? edge.to : edge.from;
    if (count == 0) solution.path.push(graph.vertices[at]);
  }
  return solution;
}

std::vector<char> EvaluatedGraph::reachable() const {
  const Graph& graph = *context_.instance.graph;
  std::vector<char> reached(graph.vertices.size(), 0);
  std::vector<std::uint32_t> open = {graph.start};
  reached[graph.start] = 1;
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    for (const auto& [edge, next] : incident(at)) {
      if (reached[next] != 0 || (!graph.verified && seen_[edge] == found_invalid)) continue;
      reached[next] = 1;
      open.push_back(next);
    }
  }
  return reached;
}

std::optional<Status> GraphPlanner::begin_drawing() {
  drawing_ = context_.guided;
  if (!drawing_) return begin_search();
  evaluated_.begin_proposals(samples_);
  return std::nullopt;
}

std::optional<Status> GraphPlanner::step() {
  if (!drawing_) return search_step();
  evaluated_.draw_proposal();
  return evaluated_.proposals_left() > 0 ? std::nullopt : end_drawing();
}

Solution GraphPlanner::solution(Status status) {
  return drawing_ ? Solution{status, path_of_start(context_.instance), {}} : found(status);
}

std::optional<Status> GraphPlanner::end_drawing() {
  drawing_ = false;
  return begin_search();
}

}  // namespace trellis
