// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/search_cost.hpp>
#include <trellis/planner/evaluated_graph.hpp>

#include <algorithm>
#include <cmath>
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
    incident_[next[edge.from]++] = {e, edge.to, 0.0};
    incident_[next[edge.to]++] = {e, edge.from, 0.0};
  }
  lengths_.clear();
  index_.reset();
  weights_ = Weights::none;
  costs_.assign(graph_->edges.size(), 0.0);
  expanded_.assign(graph_->vertices.size(), 0);
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

void EvaluatedGraph::read_costs() {
  for (std::uint32_t e = 0; e < costs_.size(); ++e) {
    const Graph::Edge& edge = graph_->edges[e];
    if (edge.cost == costs_[e]) continue;
    costs_[e] = edge.cost;
    for (const std::uint32_t end : {edge.from, edge.to}) {
      for (std::uint32_t i = first_[end]; i < first_[end + 1]; ++i) {
        if (incident_[i].edge == e) incident_[i].cost = edge.cost;
      }
    }
  }
}

void EvaluatedGraph::measure() {
  if (!lengths_.empty() || graph_->edges.empty()) return;
  // So many pieces follow the shape of a graph's edges, and cost less than the search.
  constexpr double pieces = 256.0;
  const auto& vertices = std::as_const(graph_->vertices);
  const Space& space = context_.instance.space;
  lengths_.reserve(graph_->edges.size());
  length_ = 0.0;
  for (const auto& edge : graph_->edges) {
    lengths_.push_back(edge.points.size() < 2 ? space.distance(vertices[edge.from], vertices[edge.to])
                                              : path_length(space, edge.points));
    length_ += lengths_.back();
  }
  piece_ = length_ / pieces;
}

template <class Visit>
void EvaluatedGraph::for_pieces(std::uint32_t e, const Visit& visit) const {
  const auto& edge = graph_->edges[e];
  const Space& space = context_.instance.space;
  const bool straight = edge.points.size() < 2;
  const std::size_t last = straight ? 1 : edge.points.size() - 1;
  const auto point = [&](std::size_t i) -> View {
    return straight ? std::as_const(graph_->vertices)[i == 0 ? edge.from : edge.to] : std::as_const(edge.points)[i];
  };
  const double pieces = piece_ > 0.0 ? std::max(1.0, std::ceil(lengths_[e] / piece_)) : 1.0;
  std::size_t at = 0;
  double before = 0.0;
  double segment = space.distance(point(0), point(1));
  Configuration from(point(0).begin(), point(0).end());
  Configuration to(from.size());
  for (double k = 1.0; k <= pieces; k += 1.0) {
    const double end = lengths_[e] * k / pieces;
    while (at + 1 < last && before + segment < end) {
      before += segment;
      ++at;
      segment = space.distance(point(at), point(at + 1));
    }
    space.interpolate(point(at), point(at + 1), segment > 0.0 ? std::clamp((end - before) / segment, 0.0, 1.0) : 1.0,
                      to);
    visit(from, to);
    std::swap(from, to);
  }
}

double EvaluatedGraph::path_factor(std::uint32_t e) const {
  double sum = 0.0;
  double pieces = 0.0;
  for_pieces(e, [&](View from, View to) {
    sum += context_.guidance.edge_factor(from, to).value_or(1.0);
    pieces += 1.0;
  });
  return sum / pieces;
}

void EvaluatedGraph::make_index() {
  if (index_) return;
  measure();
  const Space& space = context_.instance.space;
  index_.emplace(space);
  middles_ = Configurations(space.dimension());
  middle_edge_.clear();
  Configuration middle(space.dimension());
  for (std::uint32_t e = 0; e < graph_->edges.size(); ++e) {
    for_pieces(e, [&](View from, View to) {
      space.interpolate(from, to, 0.5, middle);
      index_->add(middle);
      middles_.push(middle);
      middle_edge_.push_back(e);
    });
  }
}

void EvaluatedGraph::begin_proposals(std::int64_t samples) {
  hits_.assign(graph_->edges.size(), 0.0);
  drawn_ = 0.0;
  paths_ = false;
  proposals_left_ = samples;
  connected_ = reachable();
}

Outcome EvaluatedGraph::extend(View proposal) {
  drawn_ += 1.0;
  --proposals_left_;
  Outcome outcome;
  outcome.proposal = proposal;
  // Where the guidance has paths, one proposal is enough, and needs no index.
  if (drawn_ > 1.0 && !index_) {
    make_index();
    hit(first_proposal_);
  }
  if (!index_) {
    first_proposal_.assign(proposal.begin(), proposal.end());
    const std::uint32_t near = nearest_vertex(proposal);
    outcome.near = std::as_const(graph_->vertices)[near];
    outcome.connected = connected_[near] != 0;
  } else if (index_->size() > 0) {
    const std::uint32_t near = hit(proposal);
    outcome.near = std::as_const(middles_)[near];
    outcome.connected = connected_[graph_->edges[middle_edge_[near]].from] != 0;
  }
  outcome.added = outcome.near;
  outcome.fate = outcome.added.empty() ? Fate::rejected : Fate::advanced;
  return outcome;
}

std::uint32_t EvaluatedGraph::hit(View q) {
  if (index_->size() == 0) return none;
  const std::uint32_t near = index_->nearest(q).id;
  hits_[middle_edge_[near]] += 1.0;
  return near;
}

std::uint32_t EvaluatedGraph::nearest_vertex(View q) const {
  std::uint32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t v = 0; v < graph_->vertices.size(); ++v) {
    const double squared = context_.instance.space.squared_distance(std::as_const(graph_->vertices)[v], q);
    if (squared >= least) continue;
    least = squared;
    nearest = v;
  }
  return nearest;
}

bool EvaluatedGraph::finds_paths() {
  const auto drawn = static_cast<std::uint64_t>(drawn_);
  // Its first proposal lets the guidance search, if it has to.
  if (drawn == 0 || (drawn & (drawn - 1)) != 0) return false;
  ask_for_paths();
  return paths_;
}

void EvaluatedGraph::ask_for_paths() {
  constexpr std::size_t asked = 8;
  paths_ = false;
  measure();
  for (std::size_t i = 0; i < asked && !graph_->edges.empty(); ++i) {
    const double factor = path_factor(static_cast<std::uint32_t>(i * graph_->edges.size() / asked));
    // Without a path, all factors are 1.
    if (factor == 1.0) continue;
    paths_ = true;
    return;
  }
}

void EvaluatedGraph::begin_weighing() {
  weights_ = Weights::none;
  if (!context_.guided || graph_->edges.empty()) return;
  if (!paths_) ask_for_paths();
  weights_ = paths_ ? Weights::paths : drawn_ > 0.0 ? Weights::proposals : Weights::none;
  if (weights_ == Weights::proposals && !index_) {
    make_index();
    hit(first_proposal_);
  }
  edge_factors_.assign(graph_->edges.size(), 0.0);
  vertex_factors_.assign(graph_->vertices.size(), 0.0);
}

double EvaluatedGraph::edge_factor(std::uint32_t e) {
  if (weights_ == Weights::none) return 1.0;
  double& factor = edge_factors_[e];
  if (factor > 0.0) return factor;
  if (weights_ == Weights::paths) {
    const auto& edge = graph_->edges[e];
    // The edges of a vertex share its distance from the paths, where they are short.
    const bool is_short = lengths_[e] <= piece_ && edge.points.size() < 2;
    factor = is_short ? 0.5 * (vertex_factor(edge.from) + vertex_factor(edge.to)) : path_factor(e);
  } else {
    // One more of each, so that the few proposals of a large graph do not decide alone.
    const double expected = length_ > 0.0 ? drawn_ * lengths_[e] / length_ : 0.0;
    factor = 1.0 / (1.0 + (hits_[e] + 1.0) / (expected + 1.0));
  }
  return factor;
}

double EvaluatedGraph::least_edge_factor() {
  if (weights_ != Weights::proposals) return 1.0;
  context_.instance.spend(search_cost::edge * static_cast<double>(graph_->edges.size()));
  double least = 1.0;
  for (std::uint32_t e = 0; e < graph_->edges.size(); ++e) least = std::min(least, edge_factor(e));
  return least;
}

double EvaluatedGraph::vertex_factor(std::uint32_t v) {
  if (weights_ == Weights::none) return 1.0;
  double& factor = vertex_factors_[v];
  if (factor > 0.0) return factor;
  if (weights_ == Weights::paths) {
    const View at = std::as_const(graph_->vertices)[v];
    factor = context_.guidance.edge_factor(at, at).value_or(1.0);
  } else {
    double sum = 0.0;
    for (const Incident& next : incident(v)) sum += edge_factor(next.edge);
    factor = incident(v).empty() ? 1.0 : sum / static_cast<double>(incident(v).size());
  }
  return factor;
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
    for (const Incident& next : incident(at)) {
      if (reached[next.to] != 0 || (!graph.verified && seen_[next.edge] == found_invalid)) continue;
      reached[next.to] = 1;
      open.push_back(next.to);
    }
  }
  return reached;
}

std::optional<Status> GraphPlanner::begin_drawing(bool anew) {
  const bool resumes = std::exchange(paused_, false) && !anew;
  if (!context_.guided) return begin_search();
  if (resumes && (drawing_ || continues())) return std::nullopt;
  drawing_ = true;
  evaluated_.begin_proposals(samples_);
  return std::nullopt;
}

Plan GraphPlanner::plan() { return {.proposal = drawing_ && !evaluated_.finds_paths()}; }

std::optional<Status> GraphPlanner::follow() { return evaluated_.proposals_left() > 0 ? std::nullopt : end_drawing(); }

std::optional<Status> GraphPlanner::work() { return drawing_ ? end_drawing() : search_step(); }

std::optional<Status> GraphPlanner::stopped(Status limit) {
  paused_ = limit == Status::paused || limit == Status::interrupted;
  return drawing_ && !paused_ ? end_drawing() : std::optional(limit);
}

Solution GraphPlanner::solution(Status status) {
  return drawing_ ? Solution{status, path_of_start(context_.instance), {}} : found(status);
}

std::optional<Status> GraphPlanner::end_drawing() {
  drawing_ = false;
  return begin_search();
}

}  // namespace trellis
