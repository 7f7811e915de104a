// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/best_first_search.hpp>

namespace trellis {

BestFirstSearch::BestFirstSearch(const Graph& graph, Evaluate evaluate, Priority priority, Rules rules)
    : state_(graph),
      evaluate_(std::move(evaluate)),
      priority_(std::move(priority)),
      rules_(std::move(rules)),
      adjacency_(graph.vertices.size()),
      known_(graph.edges.size(), Known::nothing),
      entries_(graph.vertices.size(), open_.end()) {
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
    adjacency_[graph.edges[e].from].push_back(e);
    adjacency_[graph.edges[e].to].push_back(e);
  }
  state_.at(graph.start).cost = 0.0;
  entries_[graph.start] = open_.insert({priority_(state_, graph.start), graph.start, SearchState::none, 0.0}).first;
}

bool BestFirstSearch::valid(std::uint32_t edge, std::uint32_t to) {
  if (known_[edge] == Known::nothing) {
    ++evaluations_;
    const View invalid = evaluate_(edge, to);
    known_[edge] = invalid.empty() ? Known::valid : Known::invalid;
    if (!invalid.empty()) state_.add_invalid(invalid);
  }
  return known_[edge] == Known::valid;
}

std::uint32_t BestFirstSearch::other_end(std::uint32_t edge, std::uint32_t vertex) const {
  const Graph::Edge& joined = state_.graph().edges[edge];
  return joined.from == vertex ? joined.to : joined.from;
}

void BestFirstSearch::reach(std::uint32_t vertex, std::uint32_t edge, std::uint32_t from) {
  SearchState::Vertex& reached = state_.at(vertex);
  const SearchState::Vertex& parent = state_.at(from);
  reached.cost = parent.cost + state_.graph().edges[edge].cost;
  reached.penalty = parent.penalty + (rules_.penalties.empty() ? 0.0 : rules_.penalties[edge]);
  reached.edge = edge;
  reached.depth = parent.depth + 1;
}

void BestFirstSearch::generate(std::uint32_t vertex, std::uint32_t edge, std::uint32_t from) {
  const double cost = state_.at(from).cost + state_.graph().edges[edge].cost;
  const bool at_selection = rules_.evaluation == Evaluation::selection;
  const SearchState::Vertex before = state_.at(vertex);
  if (at_selection || cost < before.cost) reach(vertex, edge, from);
  const Open entry{priority_(state_, vertex) + state_.at(vertex).penalty, vertex, edge, cost};
  if (at_selection) {
    // The entry may be invalid: no evaluation has confirmed that the edge leads here.
    state_.at(vertex) = before;
    open_.insert(entry);
    return;
  }
  if (entries_[vertex] != open_.end()) open_.erase(entries_[vertex]);
  entries_[vertex] = open_.insert(entry).first;
}

bool BestFirstSearch::expand(Open entry) {
  open_.erase(entry);
  const std::uint32_t v = entry.vertex;
  if (state_.at(v).expanded) return false;
  entries_[v] = open_.end();
  if (rules_.evaluation == Evaluation::selection && entry.edge != SearchState::none) {
    if (!valid(entry.edge, v)) return false;
    reach(v, entry.edge, other_end(entry.edge, v));
  }
  state_.at(v).expanded = true;
  ++expansions_;
  if (state_.graph().is_goal(v)) {
    goal_ = v;
    return true;
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> successors;
  for (const std::uint32_t e : adjacency_[v]) {
    const std::uint32_t next = other_end(e, v);
    if (state_.at(next).expanded) continue;
    if (rules_.evaluation == Evaluation::expansion && !valid(e, next)) continue;
    successors.emplace_back(next, e);
  }
  // An invalid configuration changes the priorities of all successors.
  for (const auto& [next, e] : successors) {
    generate(next, e, v);
    if (rules_.evaluation == Evaluation::expansion && rules_.ends == Ends::generated && state_.graph().is_goal(next)) {
      goal_ = next;
      break;
    }
  }
  return true;
}

}  // namespace trellis
