// SPDX-License-Identifier: GPL-3.0-or-later
// A heuristic that records every call of a planner and returns unique values.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/path_guide.hpp>

namespace trellis::test {

/// The arguments of a call of a spy.
struct HeardCalls {
  std::vector<TreeSide> sides;
  std::vector<std::pair<Configuration, Configuration>> connections;
  std::vector<std::pair<Configuration, Configuration>> edges;
  std::vector<double> lengths;
  struct Query {
    Configuration from, proposal;
    std::uint32_t row = no_node;
    std::uint32_t longest = 0;
  };
  std::vector<Query> controls;
  int restarts = 0;
  int vertices = 0;
  int progresses = 0;
  struct Observed {
    Fate fate = Fate::rejected;
    Configuration proposal, near, added, blocked_at;
    bool from_goal = false;
    bool connected = true;
    std::uint32_t added_row = no_node;
    std::uint32_t near_row = no_node;
    Configuration control;
    std::uint32_t steps = 0;
    bool mine = false;
  };
  std::vector<Observed> outcomes;
};

/// Uniform on a space.
class SpyHeuristic final : public PathFollower {
 public:
  static constexpr std::uint32_t row = 17;
  static constexpr double metres = 2.5;
  static constexpr double factor = 3.0;
  static constexpr double atoms = 0.25;
  static constexpr std::uint32_t steps = 3;
  static constexpr double control = 0.25;  ///< each number of it

  /// \param named  the row that `vertex` names
  SpyHeuristic(const Space& space, std::shared_ptr<HeardCalls> calls, std::uint32_t named = row)
      : space_(space), uniform_(space), calls_(std::move(calls)), named_(named), path_(space.dimension()) {
    Configuration q(space.dimension());
    for (const double share : {0.25, 0.5}) {
      for (std::size_t j = 0; j < q.size(); ++j) {
        const Axis& axis = space.axes()[j];
        q[j] = axis.lo + share * (axis.hi - axis.lo);
      }
      path_.push(q);
    }
  }

  void select_tree(TreeSide side) override { calls_->sides.push_back(side); }
  Source sample(Stream& stream, MutableView out) override { return uniform_.sample(stream, out); }
  [[nodiscard]] std::uint32_t vertex() const override {
    ++calls_->vertices;
    return named_;
  }
  std::uint32_t draw_control(Stream&, const ControlQuery& query, MutableView drawn) override {
    calls_->controls.push_back({copy(query.from), copy(query.proposal), query.row, query.longest});
    std::fill(drawn.begin(), drawn.end(), control);
    return std::min(steps, query.longest);
  }
  [[nodiscard]] bool worth_connecting(View from, View to) const override {
    calls_->connections.emplace_back(copy(from), copy(to));
    return false;
  }
  [[nodiscard]] double progress() const override {
    ++calls_->progresses;
    return metres;
  }
  [[nodiscard]] double connected() const override { return 2.0 * metres; }
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override {
    calls_->edges.emplace_back(copy(a), copy(b));
    return factor;
  }
  void restart() override { ++calls_->restarts; }
  void found(double length) override { calls_->lengths.push_back(length); }
  [[nodiscard]] std::uint64_t epoch() const override { return calls_->outcomes.size(); }
  void record(DensityRecord& record, double share) const override {
    record.add_atoms(share * atoms);
    uniform_.record(record, share * (1.0 - atoms));
  }
  void observe(const Outcome& o, bool mine) override {
    calls_->outcomes.push_back({o.fate, copy(o.proposal), copy(o.near), copy(o.added), copy(o.blocked_at), o.from_goal,
                                o.connected, o.added_row, o.near_row, copy(o.control), o.steps, mine});
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"spy", "spy: other"}; }
  [[nodiscard]] Configurations lifted_path() const override { return path_; }
  [[nodiscard]] double radius() const override { return 1.0; }

 private:
  static Configuration copy(View q) { return {q.begin(), q.end()}; }

  Space space_;
  UniformGuidance uniform_;
  std::shared_ptr<HeardCalls> calls_;
  std::uint32_t named_;
  Configurations path_;
};

}  // namespace trellis::test
