// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <trellis/guide/bias.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/instance/search_cost.hpp>

namespace trellis {

namespace {

struct StateCellsSettings {
  double cell = 0.0;
  double explore = 0.1;
};

const Settings<StateCellsSettings>& state_cells_settings() {
  static const Settings<StateCellsSettings> settings =
      Settings<StateCellsSettings>(
          Component::Kind::guide, "state_cells",
          "aggregated states: the configurations of one cell of a grid over C count as one state, which is entered "
          "once; h proposes in cells without a node that border on one with a node, and names that node to extend",
          "Barraquand and Latombe 1993, Nonholonomic multibody mobile robots: controllability and motion planning in "
          "the presence of obstacles")
          .number("cell", &StateCellsSettings::cell, "m in the metric", Range::non_negative(),
                  "side length of a cell along each line and circle; rotations of space are not divided; 0: 0.8 of the "
                  "planner's step, so that an extension enters the next cell")
          .number("explore", &StateCellsSettings::explore, "share of proposals", Range::share(),
                  "share that is uniform on C")
          .positional({"cell"});
  return settings;
}

/// The cell of each configuration: its coordinates on lines and circles, in whole side lengths.
class Grid {
 public:
  using Cell = std::vector<std::int32_t>;

  Grid(const Space& space, double cell) {
    constexpr double most = 1e6;
    for (const Factor& factor : space.factors()) {
      if (factor.kind == Factor::Kind::rotation) continue;
      const double extent = factor.axis.period();
      const double count = std::clamp(std::round(extent * factor.axis.weight / cell), 1.0, most);
      axes_.push_back({factor.column, factor.axis.lo, extent / count, static_cast<std::int32_t>(count),
                       factor.kind == Factor::Kind::circle});
    }
  }

  [[nodiscard]] Cell of(View q) const {
    Cell cell(axes_.size());
    for (std::size_t j = 0; j < cell.size(); ++j) {
      const Side& side = axes_[j];
      cell[j] = std::clamp(static_cast<std::int32_t>(std::floor((q[side.column] - side.lo) / side.length)), 0,
                           side.count - 1);
    }
    return cell;
  }

  /// Calls f for every cell that shares a side with a cell.
  template <class F>
  void for_each_neighbour(Cell cell, const F& f) const {
    for (std::size_t j = 0; j < cell.size(); ++j) {
      const std::int32_t at = cell[j];
      for (const std::int32_t by : {-1, 1}) {
        cell[j] = at + by;
        if (axes_[j].periodic) cell[j] = (cell[j] + axes_[j].count) % axes_[j].count;
        if (cell[j] >= 0 && cell[j] < axes_[j].count && cell[j] != at) f(std::as_const(cell));
      }
      cell[j] = at;
    }
  }

  /// Draws uniformly from a cell.
  void sample(const Cell& cell, const Space& space, Stream& stream, MutableView out) const {
    space.sample_uniform(stream, out);
    for (std::size_t j = 0; j < cell.size(); ++j) {
      const Side& side = axes_[j];
      out[side.column] = side.lo + (static_cast<double>(cell[j]) + stream.uniform()) * side.length;
    }
    space.reflect(out);
  }

 private:
  struct Side {
    std::size_t column;
    double lo;
    double length;
    std::int32_t count;
    bool periodic;
  };
  std::vector<Side> axes_;
};

struct CellHash {
  std::size_t operator()(const Grid::Cell& cell) const {
    return std::hash<std::string_view>{}(
        {reinterpret_cast<const char*>(cell.data()), cell.size() * sizeof(std::int32_t)});
  }
};

class StateCells final : public Heuristic {
 public:
  StateCells(Instance& parent, const StateCellsSettings& settings)
      : parent_(parent),
        space_(parent.space),
        settings_(settings),
        grid_(parent.space, settings.cell > 0.0 ? settings.cell : share_of_step * step_length(parent)),
        start_(parent.start),
        goals_(parent.goals) {
    plant();
  }

  void select_tree(TreeSide side) override { side_ = static_cast<std::size_t>(side); }

  Source sample(Stream& stream, MutableView out) override {
    const Frontier& frontier = frontiers_[side_];
    drawn_.reset();
    parent_.spend(search_cost::node_rated);
    if (frontier.cells.empty() || stream.uniform() < settings_.explore) {
      space_.sample_uniform(stream, out);
      return 1;
    }
    // Cells by how seldom they were tried: the odds of rejection are those of the least tried one.
    std::size_t at = 0;
    constexpr int tries = 16;
    for (int i = 0; i < tries; ++i) {
      at = stream.below(frontier.cells.size());
      const double tried = frontier.cells[at].tried;
      if (stream.uniform() * (1.0 + tried * tried) < 1.0) break;
    }
    drawn_ = at;
    grid_.sample(frontier.cells[at].cell, space_, stream, out);
    return 0;
  }

  [[nodiscard]] std::uint32_t vertex() const override {
    return drawn_ ? frontiers_[side_].cells[*drawn_].from : no_node;
  }

  void observe(const Outcome& outcome, bool mine) override {
    if (mine && drawn_) frontiers_[side_].cells[*drawn_].tried += 1.0;
    drawn_.reset();
    if (outcome.added.empty() || !outcome.connected) return;
    enter(frontiers_[outcome.from_goal ? 1 : 0], outcome.added, outcome.added_row);
  }

  void restart() override { plant(); }

  [[nodiscard]] std::vector<std::string> sources() const override {
    return {"state_cells", "state_cells: whole space"};
  }

 private:
  static constexpr double share_of_step = 0.8;

  struct Border {
    Grid::Cell cell;
    std::uint32_t from = no_node;  ///< the node of the cell with a node that it borders on
    double tried = 0.0;            ///< number of proposals from it
  };
  /// The cells without a node of one tree that border on cells with a node.
  struct Frontier {
    std::vector<Border> cells;
    std::unordered_map<Grid::Cell, std::size_t, CellHash> places;  ///< in `cells`; `entered` for cells with a node
  };
  static constexpr std::size_t entered = static_cast<std::size_t>(-1);

  void plant() {
    frontiers_ = {};
    drawn_.reset();
    enter(frontiers_[0], start_, no_node);
    for (const Configuration& goal : goals_) enter(frontiers_[1], goal, no_node);
  }

  /// Enters the cell of a node: from then on its configurations count as one state.
  void enter(Frontier& frontier, View q, std::uint32_t row) {
    const Grid::Cell cell = grid_.of(q);
    const auto [place, fresh] = frontier.places.try_emplace(cell, entered);
    if (!fresh) {
      if (place->second == entered) return;
      const std::size_t at = std::exchange(place->second, entered);
      if (at + 1 < frontier.cells.size()) {
        frontier.cells[at] = std::move(frontier.cells.back());
        frontier.places[frontier.cells[at].cell] = at;
      }
      frontier.cells.pop_back();
    }
    grid_.for_each_neighbour(cell, [&](const Grid::Cell& next) {
      if (frontier.places.try_emplace(next, frontier.cells.size()).second) frontier.cells.push_back({next, row});
    });
  }

  Instance& parent_;
  Space space_;
  StateCellsSettings settings_;
  Grid grid_;
  Configuration start_;
  std::vector<Configuration> goals_;
  std::array<Frontier, 2> frontiers_;  ///< of the tree from the start, of the tree from the goal
  std::size_t side_ = 0;
  std::optional<std::size_t> drawn_;  ///< the cell of the last proposal
};

}  // namespace

GuideKind state_cells_kind() {
  GuideKind kind = sampling_kind(
      state_cells_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return bias([settings = state_cells_settings().read(o)](Instance& parent) -> std::unique_ptr<Heuristic> {
          return std::make_unique<StateCells>(parent, settings);
        });
      },
      "uniform in a cell without a node that borders on a cell with one, seldom tried cells more often; it names the "
      "node of that cell to extend",
      "it would need the odds of all border cells after each node", false,
      "a node enters its cell, whose neighbours without a node become border cells; proposals from a cell make it less "
      "likely");
  kind.claims.f = "S = {0}; the cells of a grid over C are its aggregated states";
  return kind;
}

}  // namespace trellis
