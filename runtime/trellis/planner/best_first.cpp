// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/memory/best_first_search.hpp>
#include <trellis/memory/search_model.hpp>
#include <trellis/planner/common.hpp>
#include <trellis/planner/evaluated_graph.hpp>

namespace trellis {

namespace {

struct BestFirstSettings : CommonSettings {
  BestFirstSettings() {
    goal_bias = 0.0;
    bound = 0.0;
  }
  std::string model;
  BestFirstSearch::Evaluation evaluate = BestFirstSearch::Evaluation::expansion;
  std::int64_t samples = 200;
};

const Settings<BestFirstSettings>& best_first_settings() {
  static const Settings<BestFirstSettings> settings = with_common(
      Settings<BestFirstSettings>(
          Component::Kind::planner, "best_first",
          "greedy best-first search of an explicit graph: a path, not the shortest one, after few expansions; by "
          "Euclidean distance to the goal, or with a model by a heuristic that was learnt from the state of searches "
          "(SaIL). Where it is guided, vertices near the guiding path are expanded earlier, or near proposals of a "
          "guide without a path",
          "Bhardwaj, Choudhury and Scherer 2017, Learning heuristic search via imitation; Doran and Michie 1966")
          .file("model", &BestFirstSettings::model,
                "the search heuristic, as trellis experience --search makes it; none: Euclidean distance")
          .choice(
              "evaluate", &BestFirstSettings::evaluate,
              {{"expansion", BestFirstSearch::Evaluation::expansion},
               {"selection", BestFirstSearch::Evaluation::selection}},
              "when edges are evaluated that are not known to be valid: \"expansion\", as SaIL does, all those of a "
              "vertex when it is expanded; \"selection\", the one to a vertex when the vertex is selected, which "
              "evaluates fewer edges and finds fewer invalid positions that the heuristic could use")
          .integer("samples", &BestFirstSettings::samples, "proposals", Range::at_least(1),
                   "proposals drawn per search where it is guided and the guide has no path")
          .positional({"model"}));
  return settings;
}

class BestFirst final : public GraphPlanner {
 public:
  BestFirst(const BestFirstSettings& settings, PlannerContext context)
      : GraphPlanner(settings.samples, std::move(context)), settings_(settings) {
    if (settings_.model.empty()) return;
    model_ = known_search_model(settings_.model);
    if (!model_) {
      throw Error(fmt::format(
          "best_first: option 'model': there is no file '{}'; trellis experience --search makes one", settings_.model));
    }
  }

  std::optional<Status> begin(const Budget& budget) override {
    static_cast<void>(budget);
    const Graph& graph = *context_.instance.graph;
    if (model_ && graph.vertices.dimension() != 2) {
      throw Error(
          fmt::format("best_first: option 'model' needs a graph in the plane; this space ({}) has {} coordinates",
                      context_.instance.space.name(), graph.vertices.dimension()));
    }
    const bool anew = evaluated_.begin();
    if (anew) {
      paused_.reset();
      costs_.clear();
      for (const auto& edge : graph.edges) costs_.push_back(edge.cost);
    }
    if (!graph.verified) {
      if (const auto invalid = remove_invalid_goals(context_.instance)) return invalid;
      evaluated_.renew();
    }
    return begin_drawing(anew);
  }

 private:
  std::optional<Status> search_step() override {
    BestFirstSearch& search = *paused_;
    const std::uint32_t v = search.open().begin()->vertex;
    if (search.expand(*search.open().begin()) && !context_.instance.graph->verified)
      evaluated_.add_node(v, search.state().at(v).edge);
    return ended();
  }

  [[nodiscard]] Solution found(Status status) override {
    const Graph& graph = *context_.instance.graph;
    BestFirstSearch& search = *paused_;
    std::vector<std::uint32_t> parent;
    std::vector<char> reached;
    parent.reserve(graph.vertices.size());
    reached.reserve(graph.vertices.size());
    for (std::uint32_t v = 0; v < graph.vertices.size(); ++v) {
      const SearchState::Vertex& vertex = search.state().at(v);
      parent.push_back(vertex.edge);
      reached.push_back(vertex.expanded || v == search.goal() ? 1 : 0);
    }
    if (search.goal() && !graph.verified) evaluated_.add_node(*search.goal(), parent[*search.goal()]);
    if (ended()) paused_.reset();
    return evaluated_.solution(parent, reached, status);
  }

  /// The status of a search that has ended.
  [[nodiscard]] std::optional<Status> ended() const {
    if (paused_->goal()) return Status::solved;
    return paused_->open().empty() ? std::optional(Status::no_path) : std::nullopt;
  }

  std::optional<Status> begin_search() override {
    evaluated_.begin_weighing();
    if (context_.guided || !continues()) make_search();
    return ended();
  }

  [[nodiscard]] bool continues() const override { return paused_ && version_ == evaluated_.version(); }

  void make_search() {
    version_ = evaluated_.version();
    const auto priority = [this](const SearchState& state, std::uint32_t v) {
      const Graph& graph = *context_.instance.graph;
      double ahead = std::numeric_limits<double>::infinity();
      if (model_) {
        ahead = model_->cost_to_go(state, v);
      } else {
        for (const std::uint32_t goal : graph.goals) {
          ahead = std::min(ahead, context_.instance.space.distance(graph.vertices[v], graph.vertices[goal]));
        }
      }
      return evaluated_.vertex_factor(v) * ahead;
    };
    const auto evaluate = [this](std::uint32_t e, std::uint32_t to) -> View {
      if (context_.instance.graph->verified) {
        evaluated_.record(e);
        return {};
      }
      return evaluated_.valid(e, to) ? View{} : evaluated_.invalid_at(e);
    };
    paused_.emplace(*context_.instance.graph, evaluate, priority,
                    BestFirstSearch::Rules{.evaluation = settings_.evaluate, .penalties = penalties()});
  }

  /// The increase of each edge's cost since the graph was made. Greedy search ignores costs: without these penalties a
  /// continued search would find the same path again.
  [[nodiscard]] std::vector<double> penalties() const {
    const auto& edges = context_.instance.graph->edges;
    std::vector<double> grown(edges.size(), 0.0);
    bool any = false;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      grown[e] = std::max(0.0, edges[e].cost - costs_[e]);
      any = any || grown[e] > 0.0;
    }
    return any ? grown : std::vector<double>{};
  }

  BestFirstSettings settings_;
  std::shared_ptr<const SearchModel> model_;
  std::vector<double> costs_;  ///< initial costs of the edges
  EvaluatedGraph::Version version_;
  std::optional<BestFirstSearch> paused_;  ///< of `version_`; the search until its solution is taken
};

}  // namespace

PlannerKind best_first_kind() {
  return {&best_first_settings().component(), [](const Options& o) { return common_of(best_first_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            if (!context.instance.graph) throw Fault("best_first needs an instance with an explicit graph");
            return std::make_unique<BestFirst>(best_first_settings().read(o), std::move(context));
          },
          true};
}

}  // namespace trellis
