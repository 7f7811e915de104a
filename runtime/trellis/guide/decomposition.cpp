// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/goal_choice.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/position.hpp>
#include <trellis/guide/set_up.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/scene/cells.hpp>
#include <trellis/scene/planar/triangulation.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/scene/spatial/octree_cells.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

namespace {

struct DecompositionSettings {
  double size = 0.0;
  std::vector<std::string> point;
  double explore = 0.2;
  std::int64_t ahead = 2;
  double random_leads = 0.05;
  std::int64_t expansions = 100;
  double abandon = 0.05;
  std::int64_t resolves = 10000;
};

const Settings<DecompositionSettings>& decomposition_settings() {
  static const Settings<DecompositionSettings> settings = with_point(
      Settings<DecompositionSettings>(
          Component::Kind::guide, "decomposition",
          "a decomposition of the free workspace into cells, triangles of the plane and boxes of space; leads, "
          "sequences "
          "of cells from start to goal, are searched in it, with costs by how well the tree covers the cells; the "
          "nodes of a lead's cells are expanded",
          "Plaku, Kavraki and Vardi 2010, Motion planning with dynamics by a synergistic combination of layers of "
          "planning")
          .number("size", &DecompositionSettings::size, "m", Range::non_negative(),
                  "length of the triangles' sides near obstacles, about, which is doubled up to three times far from "
                  "them; in "
                  "space the longest side of a box, which is halved up to four times near obstacles; 0: twice the "
                  "robot's bounding radius, but at least 0.5 % of the world's diagonal, or 2 % of it for a point and "
                  "5 % for an arm's tip")
          .number(
              "explore", &DecompositionSettings::explore, "share of proposals", Range::share(),
              "share that is spread evenly over all cells, none where a guide guides the search for leads; the rest "
              "keeps to the lead")
          .integer("ahead", &DecompositionSettings::ahead, "cells", Range::at_least(1),
                   "how many cells of the lead, beyond the one whose node is expanded, proposals are drawn from")
          .number("random_leads", &DecompositionSettings::random_leads, "share of leads", Range::share(),
                  "share of leads that are found by a random depth-first search, none where a guide guides the search; "
                  "the rest are shortest paths")
          .integer("expansions", &DecompositionSettings::expansions, "proposals", Range::at_least(1),
                   "proposals on one lead before another one is searched; where a guide guides that search, so many "
                   "without progress along the lead")
          .number("abandon", &DecompositionSettings::abandon, "probability", Range::share(),
                  "with which a lead is abandoned after a proposal on it that improved neither the coverage of a "
                  "cell nor that of a connection between two; never where a guide guides the search")
          .integer("resolves", &DecompositionSettings::resolves, "re-solves", Range::non_negative(),
                   "how often another lead may be searched"));
  return settings;
}

/// Cells of the workspace: triangles of the plane, boxes of space; and the projection to positions.
struct Decomposition {
  std::shared_ptr<const Cells> cells;
  PositionProjection projection;
  /// Metric coordinates of S per square or cubic metre.
  double scale;
  std::vector<double> volumes;  ///< for each cell, of the cells up to it, square or cubic metres

  Decomposition(std::shared_ptr<const Cells> in, PositionProjection onto, double metric)
      : cells(std::move(in)), projection(std::move(onto)), scale(metric) {
    volumes.reserve(cells->size());
    double sum = 0.0;
    for (std::uint32_t t = 0; t < cells->size(); ++t) volumes.push_back(sum += cells->volume(t));
  }

  [[nodiscard]] std::size_t dimension() const { return projection.space().dimension(); }
  [[nodiscard]] std::optional<std::uint32_t> find(View q) const {
    std::array<double, 3> s{};
    projection.project(q, MutableView(s.data(), dimension()));
    return cells->find(View(s.data(), dimension()));
  }
  /// The density over C, at q, of lifted positions that are uniform in cells. NaN if the fibres have no closed density.
  /// \param mass  returns the probability of a cell
  template <class Mass>
  [[nodiscard]] double density(View q, const Mass& mass) const {
    if (!projection.closed_form()) return std::numeric_limits<double>::quiet_NaN();
    std::array<double, 3> s{};
    projection.project(q, MutableView(s.data(), dimension()));
    const double p = projection.folded(View(s.data(), dimension()), [&](View at) {
      const auto cell = cells->find(at);
      return cell ? mass(*cell) / (scale * cells->volume(*cell)) : 0.0;
    });
    return p > 0.0 ? p * std::exp(projection.log_fibre_density(q)) : p;
  }
};

/// A mixture of uniform distributions on cells.
class CellDensity final : public Density {
 public:
  using Mass = std::pair<std::uint32_t, double>;

  /// \param masses  in ascending order of cells, without duplicates
  CellDensity(std::shared_ptr<const Decomposition> decomposition, std::vector<Mass> masses)
      : decomposition_(std::move(decomposition)), masses_(std::move(masses)) {}

  [[nodiscard]] double at(View q) const override {
    return decomposition_->density(q, [this](std::uint32_t cell) {
      const auto mass = std::lower_bound(masses_.begin(), masses_.end(), cell,
                                         [](const Mass& m, std::uint32_t t) { return m.first < t; });
      return mass == masses_.end() || mass->first != cell ? 0.0 : mass->second;
    });
  }
  [[nodiscard]] bool mergeable(const Density& other) const override {
    const auto* same = dynamic_cast<const CellDensity*>(&other);
    return same != nullptr && same->decomposition_ == decomposition_;
  }
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override {
    std::vector<double> sums(decomposition_->cells->size(), 0.0);
    for (const auto& term : terms) {
      for (const auto& [cell, mass] : dynamic_cast<const CellDensity&>(*term.density).masses_) {
        sums[cell] += term.weight * mass;
      }
    }
    std::vector<Mass> masses;
    for (std::uint32_t t = 0; t < sums.size(); ++t) {
      if (sums[t] > 0.0) masses.emplace_back(t, sums[t]);
    }
    return std::make_shared<CellDensity>(decomposition_, std::move(masses));
  }

 private:
  std::shared_ptr<const Decomposition> decomposition_;
  std::vector<Mass> masses_;
};

/// The components of the mixtures of all leads. Each is made once.
class CellDensities {
 public:
  explicit CellDensities(std::shared_ptr<const Decomposition> decomposition)
      : decomposition_(std::move(decomposition)), alone_(decomposition_->cells->size()) {
    const Cells& cells = *decomposition_->cells;
    std::vector<CellDensity::Mass> masses;
    masses.reserve(cells.size());
    for (std::uint32_t t = 0; t < cells.size(); ++t) masses.emplace_back(t, cells.volume(t) / cells.volume());
    everywhere_ = std::make_shared<CellDensity>(decomposition_, std::move(masses));
  }

  /// Uniform over all cells.
  [[nodiscard]] const std::shared_ptr<const Density>& everywhere() const { return everywhere_; }
  /// Uniform in one cell.
  [[nodiscard]] const std::shared_ptr<const Density>& in(std::uint32_t cell) {
    auto& density = alone_[cell];
    if (!density) {
      density = std::make_shared<CellDensity>(decomposition_, std::vector<CellDensity::Mass>{{cell, 1.0}});
    }
    return density;
  }

 private:
  std::shared_ptr<const Decomposition> decomposition_;
  std::shared_ptr<const Density> everywhere_;
  std::vector<std::shared_ptr<const Density>> alone_;
};

/// Statistics of the tree over all leads: SyCLoP's estimates for regions (here: cells) and for connections between
/// neighbours.
class Exploration {
 public:
  /// \param cell  side length of the cells of a grid that measures coverage, metres
  Exploration(std::shared_ptr<const Decomposition> decomposition, double cell)
      : decomposition_(std::move(decomposition)), cell_(cell) {
    const Cells& cells = *decomposition_->cells;
    regions_.resize(cells.size());
    for (std::uint32_t t = 0; t < cells.size(); ++t) {
      regions_[t].volume = cells.importance(t);
      for (const auto& across : cells.neighbours(t)) {
        if (across.cell < t) continue;
        const auto owner = static_cast<std::uint32_t>(cells.size() + connections_.size());
        connections_.emplace(key(t, across.cell), Connection{.owner = owner});
      }
    }
  }

  /// Adds the root of a tree, and removes all nodes that were known.
  void plant(View start) {
    for (Region& r : regions_) {
      r.nodes.clear();
      r.reached = {};
    }
    const auto region = decomposition_->find(start);
    if (!region) return;
    regions_[*region].nodes.push_back({root, 0.0});
    regions_[*region].reached[0] = true;
    cover(*region, regions_[*region].covered, start);
  }

  /// Adds an outcome. Returns whether it improved the coverage of a cell or of a connection.
  bool note(const Outcome& outcome) {
    if (!outcome.blocked_at.empty()) {
      if (const auto region = decomposition_->find(outcome.blocked_at)) regions_[*region].invalid += 1.0;
    }
    if (outcome.added.empty()) return false;
    const auto region = decomposition_->find(outcome.added);
    if (!region) return false;
    Region& to = regions_[*region];
    to.valid += 1.0;
    if (!outcome.connected) return false;
    to.reached[outcome.from_goal ? 1 : 0] = true;
    // A lead starts at the start, so nodes of the tree from the goal are not expanded.
    if (outcome.added_row != no_node && !outcome.from_goal) to.nodes.push_back({outcome.added_row, 0.0});
    bool improved = cover(*region, to.covered, outcome.added);
    if (!outcome.near.empty()) {
      const auto from = decomposition_->find(outcome.near);
      const auto found = from ? connections_.find(key(*from, *region)) : connections_.end();
      if (from != region && found != connections_.end()) {
        Connection& connection = found->second;
        connection.crossed += 1.0;
        improved = cover(connection.owner, connection.covered, outcome.added) || improved;
      }
    }
    return improved;
  }

  /// Counts configurations that other levels found invalid. Returns their cell.
  std::optional<std::uint32_t> note_invalid(View q, double number) {
    const auto region = decomposition_->find(q);
    if (region) regions_[*region].invalid += number;
    return region;
  }

  /// Counts a lead through these cells.
  void include(const std::vector<std::uint32_t>& lead) {
    for (std::size_t i = 1; i < lead.size(); ++i) {
      const auto found = connections_.find(key(lead[i - 1], lead[i]));
      if (found != connections_.end() && found->second.crossed == 0.0) found->second.leads += 1.0;
    }
  }

  /// Whether the tree of that side has a node in the cell.
  [[nodiscard]] bool reached(std::uint32_t region, TreeSide side) const {
    return regions_[region].reached[static_cast<std::size_t>(side)];
  }

  /// The weight of a cell of the lead in the selection: high for large free volume, low coverage and few
  /// selections.
  [[nodiscard]] double weight(std::uint32_t region) const {
    const Region& r = regions_[region];
    return fourth(free_volume(r)) / ((1.0 + r.covered) * (1.0 + r.selections * r.selections));
  }
  /// The same where a guide has chosen the lead, without the sizes of cells, which would outweigh the order along it.
  [[nodiscard]] double guided_weight(std::uint32_t region) const {
    const Region& r = regions_[region];
    return valid_share(r) / (1.0 + r.selections * r.selections);
  }

  /// An edge of the graph of cells, and what was counted for it.
  struct Crossing {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    const void* connection = nullptr;  ///< of this object
    double length = 0.0;               ///< of the edge, metres in the metric
  };
  [[nodiscard]] Crossing crossing(std::uint32_t a, std::uint32_t b) const {
    return {.a = a, .b = b, .connection = &connections_.at(key(a, b))};
  }
  /// Calls `set` with the index and the cost of every crossing between two cells. A lead contains the edges of start
  /// and goal, so their costs do not matter: they have one cell.
  template <class Set>
  void costs(const std::vector<Crossing>& crossings, const Set& set) const {
    std::vector<double> alpha;
    alpha.reserve(regions_.size());
    for (const Region& r : regions_) alpha.push_back(1.0 / ((1.0 + r.covered) * fourth(free_volume(r))));
    for (std::size_t i = 0; i < crossings.size(); ++i) {
      const Crossing& crossing = crossings[i];
      if (crossing.connection == nullptr) continue;
      const auto& c = *static_cast<const Connection*>(crossing.connection);
      const double selections = c.crossed > 0.0 ? c.crossed : c.leads;
      set(i, (1.0 + selections * selections) / (1.0 + c.covered * c.covered) * alpha[crossing.a] * alpha[crossing.b]);
    }
  }

  /// The same where a guide chooses among leads: lengths, as the sizes of cells and the coverage would outweigh its
  /// choice, increased where the tree found configurations invalid.
  template <class Set>
  void guided_costs(const std::vector<Crossing>& crossings, const Set& set) const {
    for (std::size_t i = 0; i < crossings.size(); ++i) {
      const Crossing& crossing = crossings[i];
      if (crossing.connection == nullptr) continue;
      set(i, crossing.length / (valid_share(regions_[crossing.a]) * valid_share(regions_[crossing.b])));
    }
  }

  /// Picks a node of the cell, as an index; rarely selected nodes are more likely. None if no row is known.
  [[nodiscard]] std::optional<std::size_t> pick_node(std::uint32_t region, Stream& stream) const {
    const auto& nodes = regions_[region].nodes;
    if (nodes.empty()) return std::nullopt;
    constexpr int tries = 16;
    std::size_t node = 0;
    for (int i = 0; i < tries; ++i) {
      node = stream.below(nodes.size());
      if (stream.uniform() * (1.0 + nodes[node].selections) < 1.0) break;
    }
    return node;
  }
  [[nodiscard]] std::uint32_t row(std::uint32_t region, std::size_t node) const {
    return regions_[region].nodes[node].row;
  }
  void select(std::uint32_t region, std::optional<std::size_t> node) {
    regions_[region].selections += 1.0;
    if (node) regions_[region].nodes[*node].selections += 1.0;
  }
  /// Removes all nodes but the root: their rows belong to another tree.
  void forget_rows() {
    for (Region& r : regions_) std::erase_if(r.nodes, [](const Node& node) { return node.row != root; });
  }

 private:
  static constexpr std::uint32_t root = 0;  ///< row of the start
  struct Node {
    std::uint32_t row;
    double selections;
  };
  struct Region {
    double volume = 1.0;  ///< relative to the mean cell
    double valid = 0.0;   ///< number of configurations found valid
    double invalid = 0.0;
    double covered = 0.0;           ///< number of cells of the grid with a node
    double selections = 0.0;        ///< number of selections of its nodes
    std::array<bool, 2> reached{};  ///< for each tree, whether the cell contains a node
    std::vector<Node> nodes;
  };
  struct Connection {
    std::uint32_t owner = 0;  ///< key of its cells
    double crossed = 0.0;     ///< number of extensions from one cell to the other
    double leads = 0.0;       ///< number of leads through it before the first extension across it
    double covered = 0.0;     ///< number of cells of the grid that contain the end of an extension across it
  };

  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return (std::uint64_t{std::min(a, b)} << 32U) | std::max(a, b);
  }
  static double fourth(double x) { return x * x * x * x; }
  [[nodiscard]] static double free_volume(const Region& r) { return valid_share(r) * r.volume; }
  [[nodiscard]] static double valid_share(const Region& r) { return (1.0 + r.valid) / (1.0 + r.valid + r.invalid); }

  /// Counts the grid's cell of q for `owner`. Returns whether that is new to it.
  bool cover(std::uint32_t owner, double& covered, View q) {
    std::array<double, 3> s{};
    decomposition_->projection.project(q, MutableView(s.data(), decomposition_->dimension()));
    const auto coordinate = [&](double x) { return static_cast<std::int64_t>(std::floor(x / cell_)); };
    if (!cells_.insert({owner, coordinate(s[0]), coordinate(s[1]), coordinate(s[2])}).second) return false;
    covered += 1.0;
    return true;
  }

  std::shared_ptr<const Decomposition> decomposition_;
  double cell_;
  std::vector<Region> regions_;
  std::unordered_map<std::uint64_t, Connection> connections_;
  /// The grid's covered cells, of regions and connections.
  std::set<std::tuple<std::uint32_t, std::int64_t, std::int64_t, std::int64_t>> cells_;
};

/// The cells that a lead goes through, and whether another guide refuted a place in one of them.
struct Lead {
  std::vector<std::uint32_t> cells;
  std::vector<double> at;  ///< for each cell, the arc length at which the lead's path enters it, metres in S's metric
  bool refuted = false;
};

/// h along a lead: selects a cell that the tree has reached, then one of its nodes, and draws the proposal from this
/// cell or the next ones of the lead.
class LeadHeuristic final : public Heuristic {
 public:
  /// \param stream  random stream that selects the available cells
  /// \param guided  a guide has chosen the lead: h keeps to it, until `expansions` proposals made no progress along it
  LeadHeuristic(std::shared_ptr<const Decomposition> decomposition, const DecompositionSettings& settings,
                std::shared_ptr<Exploration> exploration, Instance& parent, std::shared_ptr<CellDensities> densities,
                std::shared_ptr<const Lead> lead, Configurations lifted, Stream stream, std::uint64_t& luck,
                bool guided)
      : decomposition_(std::move(decomposition)),
        settings_(settings),
        exploration_(std::move(exploration)),
        parent_(parent),
        densities_(std::move(densities)),
        of_guide_(std::move(lead)),
        lead_(of_guide_->cells),
        lifted_(std::move(lifted)),
        next_luck_(luck),
        parent_epoch_(parent.epoch()),
        guided_(guided),
        position_(decomposition_->dimension()) {
    if (guided_) settings_.explore = settings_.abandon = 0.0;
    // From the end of the lead: the last cell that the tree has reached, then each further one with a probability.
    for (auto& available : available_) available.assign(lead_.size(), 0);
    for (const TreeSide side : {TreeSide::start, TreeSide::goal}) {
      for (std::size_t i = 0; i < lead_.size(); ++i) {
        if (!exploration_->reached(lead_[i], side)) continue;
        advance(i, side);
        if (guided_) available_[tree_of(side)][i] = 1;
      }
    }
    for (std::size_t i = lead_.size(); !guided_ && i-- > 0;) {
      if (!exploration_->reached(lead_[i], TreeSide::start) && !exploration_->reached(lead_[i], TreeSide::goal))
        continue;
      available_[0][i] = 1;
      if (stream.uniform() >= keep_adding) break;
    }
    if (std::count(available_[0].begin(), available_[0].end(), 1) == 0) available_[0].front() = 1;
    if (std::count(available_[1].begin(), available_[1].end(), 1) == 0) available_[1].back() = 1;
    weigh();
  }

  Source sample(Stream& stream, MutableView out) override {
    on_lead_ = stream.uniform() >= settings_.explore;
    node_.reset();
    std::uint32_t drawn = 0;
    if (on_lead_) {
      region_ = pick_region(stream);
      const auto [first, last] = from_cell(region_, tree());
      drawn = lead_[first + stream.below(last - first + 1)];
      node_ = exploration_->pick_node(lead_[region_], stream);
      luck_ = stream.uniform();
    } else {
      drawn = pick_anywhere(stream);
    }
    next_luck_ = stream.below(std::uint64_t{1} << 32U);
    decomposition_->cells->sample(drawn, stream, position_);
    decomposition_->projection.lift(position_, stream, out);
    return 0;
  }

  void select_tree(TreeSide side) override {
    const std::size_t before = tree();
    side_ = side;
    if (tree() != before) weigh();
  }
  [[nodiscard]] std::uint32_t vertex() const override {
    return node_ && side_ == TreeSide::start ? exploration_->row(lead_[region_], *node_) : no_node;
  }

  /// Where validity is presumed, a motion to the goal is valid wherever it begins: the end of the lead comes first.
  [[nodiscard]] bool worth_connecting(View from, View to) const override {
    if (parent_.validity->spends_checks()) return true;
    const double reach = 2.0 * step_length(parent_);
    return of_guide_->at.back() - connected_ <= reach || parent_.space.squared_distance(from, to) <= reach * reach;
  }

  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double share) const override {
    if (!decomposition_->projection.closed_form()) {
      record.add_unknown(share);
      return;
    }
    record.add(densities_->everywhere(), share * settings_.explore);
    for (std::size_t i = 0; i < lead_.size(); ++i) {
      record.add(densities_->in(lead_[i]), share * (1.0 - settings_.explore) * masses_[i]);
    }
  }

  void observe(const Outcome& outcome, bool mine) override {
    if (parent_.epoch() != parent_epoch_) {
      // The planner has a new tree, or removed nodes.
      exploration_->forget_rows();
      parent_epoch_ = parent_.epoch();
      node_.reset();
    }
    const bool expanded = mine && on_lead_;
    if (expanded) exploration_->select(lead_[region_], node_);
    node_.reset();
    const bool improved = exploration_->note(outcome);
    if (!outcome.added.empty() && outcome.connected) {
      if (const auto cell = decomposition_->find(outcome.added)) {
        const auto place = std::find(lead_.begin(), lead_.end(), *cell);
        if (place != lead_.end()) {
          reach(static_cast<std::size_t>(place - lead_.begin()), outcome.from_goal ? TreeSide::goal : TreeSide::start);
        }
      }
    }
    if (expanded) {
      ++expansions_;
      if (expansions_ >= settings_.expansions || (!improved && luck_ < settings_.abandon)) stale_ = true;
    }
    weigh();
  }

  [[nodiscard]] bool stale() const override { return stale_ || of_guide_->refuted; }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"decomposition"}; }
  [[nodiscard]] Configurations lifted_path() const override { return lifted_; }
  /// 0 if f does not contract: lengths in S then do not bound those in C.
  [[nodiscard]] double progress() const override { return decomposition_->projection.contracts() ? progress_ : 0.0; }
  [[nodiscard]] double connected() const override { return decomposition_->projection.contracts() ? connected_ : 0.0; }

 private:
  /// The tree whose cells are available for a side: a guided lead is followed from both ends, any other from the start.
  [[nodiscard]] std::size_t tree_of(TreeSide side) const { return guided_ ? static_cast<std::size_t>(side) : 0; }
  [[nodiscard]] std::size_t tree() const { return tree_of(side_); }
  /// The cells that proposals are drawn from where the i-th cell of the lead is selected: from the first to the last.
  [[nodiscard]] std::pair<std::size_t, std::size_t> from_cell(std::size_t i, std::size_t tree) const {
    const auto ahead = static_cast<std::size_t>(settings_.ahead);
    if (tree == 1) return {i - std::min(i, ahead), i};
    return {i, std::min(lead_.size() - 1, i + ahead)};
  }
  /// Extends the part of the lead that the trees have connected to the i-th cell. Returns by how much.
  double advance(std::size_t i, TreeSide side) {
    const double length = of_guide_->at.back();
    double& to = fronts_[static_cast<std::size_t>(side)];
    to = std::max(to, side == TreeSide::start ? of_guide_->at[i] : length - of_guide_->at[i]);
    const double before = std::exchange(connected_, std::min(length, fronts_[0] + fronts_[1]));
    return connected_ - before;
  }
  /// Notes that a connected node of a tree lies in the i-th cell of the lead.
  void reach(std::size_t i, TreeSide side) {
    available_[tree_of(side)][i] = 1;
    const double length = advance(i, side);
    progress_ += length;
    if (length > 0.0 && guided_) expansions_ = 0;
  }
  /// Computes for each cell of the lead the weight of its selection and the mass of proposals in it.
  void weigh() {
    const std::size_t n = lead_.size();
    const std::vector<char>& available = available_[tree()];
    weights_.assign(n, 0.0);
    masses_.assign(n, 0.0);
    double total = 0.0;
    double share = 1.0;
    for (std::size_t k = 0; k < n; ++k) {
      // Of a guided lead, from the farthest cell back to the tree's root.
      const std::size_t i = guided_ && tree() == 0 ? n - 1 - k : k;
      if (available[i] == 0) continue;
      total += weights_[i] = guided_ ? share * exploration_->guided_weight(lead_[i]) : exploration_->weight(lead_[i]);
      share *= guided_keeps_adding;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (available[i] == 0) continue;
      weights_[i] /= total;
      const auto [first, last] = from_cell(i, tree());
      for (std::size_t k = first; k <= last; ++k) masses_[k] += weights_[i] / static_cast<double>(last - first + 1);
    }
    ++epoch_;
  }

  std::size_t pick_region(Stream& stream) const {
    double u = stream.uniform();
    std::size_t picked = 0;
    for (std::size_t i = 0; i < lead_.size(); ++i) {
      if (available_[tree()][i] == 0) continue;
      picked = i;
      u -= weights_[i];
      if (u < 0.0) break;
    }
    return picked;
  }
  std::uint32_t pick_anywhere(Stream& stream) const {
    const auto& volumes = decomposition_->volumes;
    const double u = stream.uniform() * decomposition_->cells->volume();
    const auto cell = std::upper_bound(volumes.begin(), volumes.end() - 1, u);
    return static_cast<std::uint32_t>(cell - volumes.begin());
  }

  /// The probability with which one more of the cells that the tree has reached is available, from the last one back.
  static constexpr double keep_adding = 0.5;
  /// The same for the weights of cells where a guide has chosen the lead: all are available. With 0.5 a search needs a
  /// tenth more checks.
  static constexpr double guided_keeps_adding = 0.25;

  std::shared_ptr<const Decomposition> decomposition_;
  DecompositionSettings settings_;
  std::shared_ptr<Exploration> exploration_;
  Instance& parent_;
  std::shared_ptr<CellDensities> densities_;
  std::shared_ptr<const Lead> of_guide_;
  const std::vector<std::uint32_t>& lead_;
  Configurations lifted_;
  std::uint64_t& next_luck_;  ///< seed of the next lead's random stream
  std::uint64_t parent_epoch_;
  bool guided_;
  /// For each tree and each cell of the lead: the planner may expand its nodes.
  std::array<std::vector<char>, 2> available_;
  std::vector<double> weights_;
  std::vector<double> masses_;
  double progress_ = 0.0;           ///< along the lead, metres in S's metric
  std::array<double, 2> fronts_{};  ///< for each tree, the length of the lead from its root to its farthest cell
  double connected_ = 0.0;          ///< length of the lead that both have connected
  std::int64_t expansions_ = 0;
  std::uint64_t epoch_ = 0;
  TreeSide side_ = TreeSide::start;
  // Of the last proposal:
  std::size_t region_ = 0;           ///< cell whose node is expanded, as an index into the lead
  std::optional<std::size_t> node_;  ///< index of the node in that cell
  double luck_ = 1.0;
  bool on_lead_ = false;
  bool stale_ = false;
  Configuration position_;
};

/// Returns the length of the cells' sides near obstacles, in metres.
/// \param tip  the position is that of an arm's tip, which has no size
double side_of(const DecompositionSettings& settings, const Scene& scene, bool tip) {
  if (settings.size > 0.0) return settings.size;
  const double world = scene.diagonal();
  return tip ? 0.05 * world : std::max(2.0 * size_or(scene, 0.01 * world), 0.005 * world);
}

/// Returns the number of cells that cells of the least size would be.
/// \throws Error for too many triangles
double cells_of(const Options& options, const Scene& scene) {
  const double side = side_of(decomposition_settings().read(options), scene, !scene.translates());
  if (const PlanarScene* const plane = scene.planar()) {
    constexpr double of_corner = 2.0;
    return Triangulation::at_most(plane->world.bounds(), side) + of_corner * world_size(scene);
  }
  const Vec3 extent = spatial_world(scene)->bounds().hi - spatial_world(scene)->bounds().lo;
  const double all = std::ceil(extent.x / side) * std::ceil(extent.y / side) * std::ceil(extent.z / side);
  return std::min(all, static_cast<double>(OctreeCells::most_cells));
}

class DecompositionGuide final : public Guide, public Repairs {
 public:
  explicit DecompositionGuide(const DecompositionSettings& settings) : settings_(settings) {}

  std::unique_ptr<Instance> project(const Instance& parent) override {
    PositionProjection projection("decomposition", parent, settings_.point);
    auto instance = projection.point_instance(parent);
    double scale = 1.0;
    for (const Axis& axis : instance->space.axes()) scale *= axis.weight;
    const double side = side_of(settings_, *parent.scene, projection.arm());
    // Positions of the reference point that are nearer to obstacles are invalid in C.
    const double needed = projection.arm() ? 0.0 : parent.scene->inscribed_radius();
    auto cells = free_cells(*instance->scene, side, needed);
    if (cells->size() == 0) throw Error("decomposition: the world leaves no free space");
    decomposition_ = std::make_shared<const Decomposition>(std::move(cells), std::move(projection), scale);
    constexpr double along = 4.0;  // cells of the coverage grid along a cell's side
    exploration_ = std::make_shared<Exploration>(decomposition_, side / along);
    start_ = parent.start;
    exploration_->plant(start_);
    densities_ = std::make_shared<CellDensities>(decomposition_);

    make_graph(*instance);
    before_resolve();
    instance->graph = graph_;
    return instance;
  }

  void attach(Instance& sub) override {
    if (std::exchange(guided_, sub.guided) != sub.guided) before_resolve();
  }
  Repairs& repairs() override { return *this; }
  void project(View q, MutableView s) const override { decomposition_->projection.project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { decomposition_->projection.lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View q) const override {
    return decomposition_->projection.log_fibre_density(q);
  }
  [[nodiscard]] bool closed_fibre() const override { return decomposition_->projection.closed_fibre(); }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution* found) override {
    lead_.reset();
    Stream stream(luck_, "decomposition", "lead");
    std::vector<std::uint32_t> lead;
    std::vector<double> at;
    // The first lead, before any proposal, is a shortest path.
    if (luck_ != 0 && !guided_ && stream.uniform() < settings_.random_leads) lead = random_lead(stream);
    Configurations path(decomposition_->dimension());
    if (!lead.empty()) {
      path.push(graph_->vertices[graph_->start]);
      for (const std::uint32_t t : lead) path.push(graph_->vertices[t]);
      path.push(graph_->vertices[goal_in(lead.back())]);
      lead.clear();
    } else {
      path = found->path;
    }
    double length = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (i > 0) length += decomposition_->projection.space().distance(path[i - 1], path[i]);
      const auto cell = decomposition_->cells->find(path[i]);
      if (!cell || std::find(lead.begin(), lead.end(), *cell) != lead.end()) continue;
      lead.push_back(*cell);
      at.push_back(length);
    }
    if (lead.empty()) return std::make_unique<UniformHeuristic>("decomposition (found nothing)", parent.space);
    exploration_->include(lead);
    const PositionProjection& projection = decomposition_->projection;
    const Configuration& goal = goal_choice_.choose(
        parent, [&](View q, MutableView s) { projection.project(q, s); }, projection.space(), path);
    Configurations lifted = projection.lifted(path, parent.start, goal);
    lead_ = std::make_shared<Lead>(Lead{std::move(lead), std::move(at)});
    return std::make_unique<LeadHeuristic>(decomposition_, settings_, exploration_, parent, densities_, lead_,
                                           std::move(lifted), stream, luck_, guided_);
  }

  void restart() override { exploration_->plant(start_); }

  void avoid(View place) override {
    // As many configurations as make other guides refute a place.
    constexpr double evidence = 100.0;
    const auto cell = exploration_->note_invalid(place, evidence);
    if (!cell || !lead_) return;
    const auto& cells = lead_->cells;
    if (std::find(cells.begin(), cells.end(), *cell) != cells.end()) lead_->refuted = true;
  }
  void found_invalid(View q) override { exploration_->note_invalid(q, 1.0); }

  void before_resolve() override {
    const auto set = [&](std::size_t e, double cost) { graph_->set_cost(e, cost); };
    if (guided_) {
      exploration_->guided_costs(crossings_, set);
    } else {
      exploration_->costs(crossings_, set);
    }
  }

 private:
  /// Makes the graph: cells are vertices at their centres, with edges through the points where they meet. Start and
  /// goals are connected to the cells that contain them.
  void make_graph(const Instance& instance) {
    graph_ = std::make_shared<Graph>();
    crossings_.clear();
    const std::size_t dimension = decomposition_->dimension();
    graph_->vertices = Configurations(dimension);
    const Cells& cells = *decomposition_->cells;
    Configuration centre(dimension);
    for (std::uint32_t t = 0; t < cells.size(); ++t) {
      cells.centre(t, centre);
      graph_->vertices.push(centre);
    }
    for (std::uint32_t t = 0; t < cells.size(); ++t) {
      for (const auto& across : cells.neighbours(t)) {
        if (across.cell < t) continue;
        Configurations points(dimension);
        points.push(std::as_const(graph_->vertices)[t]);
        points.push(View(across.middle.data(), dimension));
        points.push(std::as_const(graph_->vertices)[across.cell]);
        add_edge(t, across.cell, std::move(points), exploration_->crossing(t, across.cell), instance.space);
      }
    }
    graph_->start = join(instance.start, instance.space);
    for (const Configuration& goal : instance.goals) graph_->goals.push_back(join(goal, instance.space));
    if (graph_->goals.size() < 2) return;
    // Costs of crossings are no lengths, so the length within its cell must not decide between goals.
    for (Graph::Edge& edge : graph_->edges) {
      if (graph_->is_goal(edge.from)) edge.cost = 0.0;
    }
  }

  /// The cells of a random depth-first search from the start to a goal; empty if it finds no path.
  [[nodiscard]] std::vector<std::uint32_t> random_lead(Stream& stream) const {
    const Cells& cells = *decomposition_->cells;
    const auto at = [&](std::uint32_t vertex) { return cells.find(std::as_const(graph_->vertices)[vertex]); };
    const auto start = at(graph_->start);
    std::vector<char> is_goal(cells.size(), 0);
    for (const std::uint32_t vertex : graph_->goals) {
      if (const auto cell = at(vertex)) is_goal[*cell] = 1;
    }
    if (!start || std::count(is_goal.begin(), is_goal.end(), 1) == 0) return {};
    std::vector<char> seen(cells.size(), 0);
    std::vector<std::uint32_t> lead = {*start};
    seen[*start] = 1;
    std::vector<std::uint32_t> next;
    while (!lead.empty() && is_goal[lead.back()] == 0) {
      next.clear();
      for (const auto& across : cells.neighbours(lead.back())) {
        if (seen[across.cell] == 0) next.push_back(across.cell);
      }
      if (next.empty()) {
        lead.pop_back();
        continue;
      }
      lead.push_back(next[stream.below(next.size())]);
      seen[lead.back()] = 1;
    }
    return lead;
  }

  /// The first goal in a cell that contains one.
  [[nodiscard]] std::uint32_t goal_in(std::uint32_t cell) const {
    for (const std::uint32_t vertex : graph_->goals) {
      if (decomposition_->cells->find(std::as_const(graph_->vertices)[vertex]) == cell) return vertex;
    }
    throw Fault("the cell at the end of a lead contains no goal");
  }

  std::uint32_t join(const Configuration& position, const Space& space) {
    const std::uint32_t vertex = graph_->vertices.push(position);
    if (const auto cell = decomposition_->cells->find(position)) {
      Configurations points(position.size());
      points.push(position);
      points.push(std::as_const(graph_->vertices)[*cell]);
      add_edge(vertex, *cell, std::move(points), {.a = *cell, .b = *cell}, space);
    }
    return vertex;
  }

  void add_edge(std::uint32_t from, std::uint32_t to, Configurations points, const Exploration::Crossing& crossing,
                const Space& space) {
    const double length = path_length(space, points);
    graph_->edges.push_back({from, to, length, std::move(points)});
    crossings_.push_back(crossing);
    crossings_.back().length = length;
  }

  DecompositionSettings settings_;
  std::shared_ptr<const Decomposition> decomposition_;
  std::shared_ptr<Graph> graph_;
  std::vector<Exploration::Crossing> crossings_;  ///< for each edge
  std::shared_ptr<CellDensities> densities_;
  std::shared_ptr<Exploration> exploration_;
  Configuration start_;         ///< of C
  std::shared_ptr<Lead> lead_;  ///< of the last h; none before, and where that is uniform
  GoalChoice goal_choice_;      ///< where leads end in C
  bool guided_ = false;         ///< a guide guides the search for leads
  std::uint64_t luck_ = 0;      ///< last number drawn by h; seeds the random stream of the next lead
};

}  // namespace

GuideKind decomposition_kind() {
  return GuideKind{
      &decomposition_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return std::make_unique<DecompositionGuide>(decomposition_settings().read(o));
      },
      "graph_search",
      [](const Options& o) { return decomposition_settings().read(o).resolves; },
      {.category = GuideClaims::Category::robot,
       .f = "q -> the position of the reference point, in a cell of the free workspace; of an arm that is fixed to "
            "its base, that of its tip",
       .h = "a cell of the lead that the tree has reached, by free volume, coverage and how often it was "
            "selected, and one of its nodes to expand; the proposal is uniform in it or one of the next `ahead` "
            "cells, all else uniform (of an arm, by inverse kinematics); any cell with a share of `explore`. A lead "
            "that a "
            "guide chose is followed from both ends where two trees grow, mostly in the farthest cell reached",
       .closed_form = true,
       .density = "of the mixture of cells",
       .feedback = "nodes, invalid configurations and crossings are counted by cell; a place that another guide "
                   "refuted counts as 100 invalid ones, and ends a lead through its cell; a lead is abandoned after "
                   "`expansions` proposals, or with probability `abandon` after one that improved no coverage, and "
                   "another one searched, its costs by what was counted. A lead that a guide chose is kept as long as "
                   "the tree advances along it, and costs are lengths, more where configurations were invalid",
       .relaxes = true,
       .invalid_ends = "an end whose position is in no cell is joined to none, so S has no path",
       .fallback = GuideClaims::Fallback::own,
       .no_path = "the lead goes to the cell nearest to the goal that can be reached; uniform where the start "
                  "is in none",
       .example = "examples/kinodynamic.lua",
       .needs = GuideClaims::Needs::position}}
      .set_up({.world = {7000, 8}, .run = {3000, 0.25}}, {.world = {200000, 2}, .run = {34000}}, cells_of);
}

}  // namespace trellis
