// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include <trellis/guide/holonomic.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/instance/search_cost.hpp>
#include <trellis/motion/motion_model.hpp>

namespace trellis {

namespace {

struct BlossomSettings : HolonomicSettings {
  std::int64_t controls = 32;
  double share = 0.8;
};

const Settings<BlossomSettings>& blossom_settings() {
  static const Settings<BlossomSettings> settings =
      with_holonomic_options(
          Settings<BlossomSettings>(
              Component::Kind::guide, "blossom",
              "the robot without its motion model, as holonomic, whose path gives states a cost to go; h names the "
              "node to extend and draws its control: of random controls of the node, rated by the cost to go of the "
              "states in which they end, the best one that it was not extended under before",
              "the order of a node's controls: Littlefield and Bekris 2018, Efficient and asymptotically optimal "
              "kinodynamic motion planning via dominance-informed regions; the choice of nodes is ours")
              .integer(
                  "controls", &BlossomSettings::controls, "controls", {.lo = 1, .hi = 10000},
                  "random controls, each for a random duration, that a node has; when it was extended under all of "
                  "them it receives as many new ones")
              .number(
                  "share", &BlossomSettings::share, "share of proposals", Range::share(),
                  "share with a control; for the others h is that of holonomic, and the planner chooses the control"))
          .positional({"controls"});
  return settings;
}

/// The nodes that a planner reported, as a guide that makes h anew needs them.
struct Reported {
  Configurations states;
  std::vector<std::uint32_t> rows;
  std::vector<std::uint32_t> parents;  ///< rows
};

/// h over extensions along a path in S: the node, a point of the path ahead of it, and a control.
class BlossomHeuristic final : public Wrapping<Heuristic, Heuristic> {
 public:
  /// \param along  h without controls
  /// \param path  in S, at least two points
  BlossomHeuristic(Instance& parent, std::unique_ptr<Heuristic> along, std::shared_ptr<const AxisProjection> f,
                   const Configurations& path, const BlossomSettings& settings, const Reported& nodes)
      : Wrapping(std::move(along)),
        parent_(parent),
        model_(parent.motion_model),
        f_(std::move(f)),
        controls_(static_cast<std::size_t>(settings.controls)),
        share_(settings.share),
        centres_(path.dimension()),
        in_s_(path.dimension()),
        state_(parent.space.dimension()),
        control_(model_->controls().size()) {
    constexpr double most_bins = 1000.0;
    const Space& s = f_->space();
    double length = 0.0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) length += s.distance(path[i], path[i + 1]);
    bin_ = std::max({0.25 * characteristic_length(parent), length / most_bins, std::numeric_limits<double>::min()});
    centres_.push(path.front());
    Configuration q(path.dimension());
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const double piece = s.distance(path[i], path[i + 1]);
      const auto parts = static_cast<std::size_t>(std::max(1.0, std::ceil(piece / bin_)));
      for (std::size_t k = 1; k <= parts; ++k) {
        s.interpolate(path[i], path[i + 1], static_cast<double>(k) / static_cast<double>(parts), q);
        centres_.push(q);
      }
    }
    togo_.assign(centres_.size(), 0.0);
    for (std::size_t i = centres_.size() - 1; i-- > 0;) {
      togo_[i] = togo_[i + 1] + s.distance(centres_[i], centres_[i + 1]);
    }
    plant();
    for (std::size_t i = 0; i < nodes.rows.size(); ++i) add(nodes.states[i], nodes.rows[i], nodes.parents[i], 0);
  }

  Source sample(Stream& stream, MutableView out) override {
    aims_ = stream.uniform() < share_;
    if (!aims_) {
      part()->sample(stream, out);
      return 1;
    }
    aim_ = choose(stream);
    // Where the path leads on, about as far as the extension.
    std::size_t ahead = nodes_[aim_].at;
    while (ahead + 1 < centres_.size() && togo_[nodes_[aim_].at] - togo_[ahead] < reach_) ++ahead;
    f_->lift(std::as_const(centres_)[ahead], stream, out);
    return 0;
  }
  [[nodiscard]] std::uint32_t vertex() const override { return aims_ ? nodes_[aim_].row : Wrapping::vertex(); }

  std::uint32_t draw_control(Stream& stream, const ControlQuery& query, MutableView control) override {
    if (!aims_) return Wrapping::draw_control(stream, query, control);
    Node* const node = find(query.row, query.from);
    if (node == nullptr) return 0;
    node->row = query.row;
    rows_[query.row] = static_cast<std::uint32_t>(node - nodes_.data());
    if (node->blossom.empty()) draw_blossom(*node, query, stream);
    if (node->blossom.empty()) return 0;
    const Candidate next = std::move(node->blossom.back());
    node->blossom.pop_back();
    std::copy(next.control.begin(), next.control.end(), control.begin());
    return std::min(next.steps, query.longest);
  }

  void observe(const Outcome& outcome, bool mine) override {
    const bool aimed = mine && aims_;
    Wrapping::observe(outcome, mine);
    if (aimed) {
      if (Node* const node = find(outcome.near_row, outcome.near)) {
        ++node->extended;
        queue(static_cast<std::uint32_t>(node - nodes_.data()));
      }
      ++failures_;
    }
    if (outcome.added.empty() || !outcome.connected || outcome.from_goal) return;
    // A node in front of an obstacle leads on seldom.
    add(outcome.added, outcome.added_row, outcome.near_row, outcome.blocked_at.empty() ? 0 : 2);
  }

  void restart() override {
    Wrapping::restart();
    plant();
  }
  [[nodiscard]] bool worth_connecting(View from, View to) const override { return part()->worth_connecting(from, to); }
  void record(DensityRecord& record, double share) const override {
    if (share_ > 0.0) record.add_unknown(share * share_);
    if (share_ < 1.0) part()->record(record, share * (1.0 - share_));
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"blossom", "blossom: tube"}; }
  [[nodiscard]] bool stale() const override { return part()->stale(); }
  [[nodiscard]] Configurations lifted_path() const override { return part()->lifted_path(); }

 private:
  [[nodiscard]] Guidance* drew_last() const override { return aims_ ? nullptr : part(); }

  struct Candidate {
    double cost = 0.0;
    std::uint32_t steps = 0;
    Configuration control;
  };
  struct Node {
    std::uint32_t row = no_node;     ///< unknown of the start before it is extended
    std::size_t at = 0;              ///< index of the path's point where it is
    double cost = 0.0;               ///< to go
    std::uint32_t extended = 0;      ///< number of extensions under a control of h
    std::vector<Candidate> blossom;  ///< controls that it was not extended under, the best one last
  };
  /// A node in the queue of its point of the path: those seldom extended first, of these the one with the least cost.
  using Entry = std::tuple<std::uint32_t, double, std::uint32_t>;
  using Queue = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

  /// A metre beside the path costs as much as so many along it.
  static constexpr double beside = 2.0;

  struct Place {
    std::size_t at = 0;
    double cost = std::numeric_limits<double>::infinity();
  };
  /// The cost to go of a state: that of a point of the path, and the length to it.
  /// \param from,  to  of the points of the path that count
  [[nodiscard]] Place place(View q, std::size_t from, std::size_t to) {
    f_->project(q, in_s_);
    Place best;
    for (std::size_t i = from; i <= to; ++i) {
      const double cost = togo_[i] + beside * f_->space().distance(std::as_const(centres_)[i], in_s_);
      if (cost < best.cost) best = {i, cost};
    }
    // At the end of the path velocities count too.
    if (togo_[best.at] <= reach_) best.cost = std::max(best.cost, parent_.to_goal(q));
    return best;
  }
  /// The same for a state that was driven to from a node: it advances along the path at most twice as far as it moved,
  /// so that a point of the path behind a wall is none.
  [[nodiscard]] Place place_after(const Node& node, double moved, View q) {
    const double reach = moved + bin_;
    std::size_t from = node.at;
    while (from > 0 && togo_[from] - togo_[node.at] < reach) --from;
    std::size_t to = node.at;
    while (to + 1 < centres_.size() && togo_[node.at] - togo_[to] < 2.0 * reach) ++to;
    return place(q, from, to);
  }

  Node* find(std::uint32_t row, View q) {
    const auto found = rows_.find(row);
    if (found != rows_.end()) return &nodes_[found->second];
    return std::ranges::equal(q, parent_.start) ? nodes_.data() : nullptr;
  }

  void plant() {
    nodes_.clear();
    rows_.clear();
    queues_.assign(centres_.size(), {});
    front_ = 0;
    failures_ = 0;
    aims_ = false;
    nodes_.push_back({});
    nodes_.back().cost = togo_.front();
    queue(0);
  }

  void add(View q, std::uint32_t row, std::uint32_t parent, std::uint32_t extended) {
    const auto known = rows_.find(parent);
    Place at;
    if (known == rows_.end()) {
      at = place(q, 0, centres_.size() - 1);
    } else {
      const Node& from = nodes_[known->second];
      f_->project(q, in_s_);
      at = place_after(from, f_->space().distance(std::as_const(centres_)[from.at], in_s_), q);
    }
    rows_[row] = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({row, at.at, at.cost, extended, {}});
    queue(static_cast<std::uint32_t>(nodes_.size() - 1));
    if (at.at <= front_) return;
    front_ = at.at;
    failures_ = 0;
  }
  void queue(std::uint32_t node) { queues_[nodes_[node].at].emplace(nodes_[node].extended, nodes_[node].cost, node); }

  /// A node near the one that is farthest along the path; the longer none came farther, the farther back.
  std::uint32_t choose(Stream& stream) {
    constexpr double patience = 8.0;
    const double back = bin_ * (2.0 + static_cast<double>(failures_) / patience) * stream.uniform();
    std::size_t at = front_;
    while (at > 0 && togo_[at] - togo_[front_] < back) --at;
    // Nodes that were extended since are in the queue again.
    const auto top = [&](std::size_t i) {
      Queue& queue = queues_[i];
      while (!queue.empty() && std::get<0>(queue.top()) != nodes_[std::get<2>(queue.top())].extended) queue.pop();
      return !queue.empty();
    };
    while (at > 0 && !top(at)) --at;
    while (!top(at)) ++at;
    return std::get<2>(queues_[at].top());
  }

  void draw_blossom(Node& node, const ControlQuery& query, Stream& stream) {
    const Space& space = parent_.space;
    Configuration at(in_s_.size());
    f_->project(query.from, at);
    for (std::size_t i = 0; i < controls_; ++i) {
      model_->sample_control(stream, control_);
      const auto steps = static_cast<std::uint32_t>(1 + stream.below(query.longest));
      parent_.spend(search_cost::node_rated + model_->step_work() * static_cast<double>(steps));
      std::copy(query.from.begin(), query.from.end(), state_.begin());
      for (std::uint32_t k = 0; k < steps; ++k) model_->step(space, state_, control_, state_);
      if (!space.contains(state_) || !model_->admits(state_)) continue;
      f_->project(state_, in_s_);
      const double moved = f_->space().distance(at, in_s_);
      reach_ = std::max(reach_, moved);
      node.blossom.push_back({place_after(node, moved, state_).cost, steps, control_});
    }
    std::stable_sort(node.blossom.begin(), node.blossom.end(),
                     [](const Candidate& a, const Candidate& b) { return a.cost > b.cost; });
  }

  Instance& parent_;
  std::shared_ptr<const MotionModel> model_;
  std::shared_ptr<const AxisProjection> f_;
  std::size_t controls_;
  double share_;
  double bin_ = 0.0;                                       ///< distance between points of the path, metres in S
  double reach_ = 0.0;                                     ///< farthest that a control has moved the robot, metres in S
  Configurations centres_;                                 ///< points of the path in S
  std::vector<double> togo_;                               ///< length of the path from each of them
  std::vector<Node> nodes_;                                ///< the start first
  std::unordered_map<std::uint32_t, std::uint32_t> rows_;  ///< node of each row
  std::vector<Queue> queues_;                              ///< of each point of the path
  std::size_t front_ = 0;                                  ///< the point of the path that nodes have reached
  std::uint64_t failures_ = 0;                             ///< extensions since a node came farther
  bool aims_ = false;                                      ///< the last sample has a control
  std::uint32_t aim_ = 0;                                  ///< its node
  Configuration in_s_;                                     // scratch
  Configuration state_;
  Configuration control_;
};

class Blossom final : public Holonomic {
 public:
  explicit Blossom(const BlossomSettings& settings) : Holonomic("blossom", settings), settings_(settings) {}

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    auto along = Holonomic::heuristic(parent, sub, found);
    if (!parent.motion_model || found->path.size() < 2) return along;
    return std::make_unique<BlossomHeuristic>(parent, std::move(along), projection(), followed(found->path), settings_,
                                              reported_);
  }

  void learn(const Outcome& outcome) override {
    Holonomic::learn(outcome);
    if (outcome.added.empty() || !outcome.connected || outcome.from_goal) return;
    if (reported_.rows.empty()) reported_.states = Configurations(outcome.added.size());
    reported_.states.push(outcome.added);
    reported_.rows.push_back(outcome.added_row);
    reported_.parents.push_back(outcome.near_row);
  }
  void restart() override {
    Holonomic::restart();
    reported_ = {};
  }

 private:
  BlossomSettings settings_;
  Reported reported_;
};

}  // namespace

GuideKind blossom_kind() {
  GuideClaims claims = path_claims(
      GuideClaims::Category::robot,
      "(q, velocities) -> q, joined by straight motions; the identity without a motion model",
      "a start or goal that is valid in C stays valid: S drops the bounds on velocities", "examples/controls.lua");
  claims.h =
      "the node, a point of the path ahead of it, and the node's best control that was not tried, by the cost to go of "
      "the state in which it ends; else as holonomic";
  claims.density += "; the share with a control has none: it would need the odds of all controls of all nodes";
  claims.feedback =
      "nodes have a cost to go along the path and a number of extensions; the longer none came farther along the path, "
      "the farther back nodes are extended";
  return GuideKind{
      &blossom_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Blossom>(blossom_settings().read(o)); },
      "rrt_connect", [](const Options& o) { return blossom_settings().read(o).resolves; }, std::move(claims)}
      .set_up({.run = {50}}, {.run = {200}});
}

}  // namespace trellis
