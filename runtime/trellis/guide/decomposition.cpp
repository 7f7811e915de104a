// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/kinds.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/position.hpp>
#include <trellis/scene/triangulation.hpp>

namespace trellis {

namespace {

struct DecompositionSettings {
  double size = 0.0;
  double explore = 0.2;
  std::int64_t ahead = 2;
  std::int64_t patience = 50;
  std::int64_t resolves = 1000;
};

const Settings<DecompositionSettings>& decomposition_settings() {
  static const Settings<DecompositionSettings> settings =
      Settings<DecompositionSettings>(
          Component::Kind::guide, "decomposition",
          "a triangulation of the free workspace; leads, sequences of triangles from start to goal, are searched in it "
          "and weighed anew by how well they were covered",
          "Plaku, Kavraki and Vardi 2010, Motion planning with dynamics by a synergistic combination of layers of "
          "planning")
          .number("size", &DecompositionSettings::size, "m", Range::non_negative(),
                  "length of the triangles' sides, about; 0: twice the robot's bounding radius, or 2 % of the world's "
                  "diagonal for a point")
          .number("explore", &DecompositionSettings::explore, "share of proposals", Range::share(),
                  "share that is spread evenly over all triangles; the rest keeps to the lead")
          .integer("ahead", &DecompositionSettings::ahead, "triangles", Range::at_least(1),
                   "how far along the lead beyond what the planner has reached proposals are drawn")
          .integer("patience", &DecompositionSettings::patience, "proposals", Range::at_least(1),
                   "proposals on the lead without reaching a triangle farther along it before another lead is searched")
          .integer("resolves", &DecompositionSettings::resolves, "re-solves", Range::non_negative(),
                   "how often another lead may be searched");
  return settings;
}

/// Triangles, and the position in the plane of what lies in them, in a space.
struct Decomposition {
  Triangulation triangulation;
  PositionProjection projection;
  /// Of positions: metric coordinates per square metre.
  double scale;

  [[nodiscard]] std::optional<std::uint32_t> find(View q) const {
    std::array<double, 2> s{};
    projection.project(q, s);
    return triangulation.find({s[0], s[1]});
  }
  /// What a probability of a triangle is as a density over C.
  [[nodiscard]] double density(std::uint32_t triangle) const {
    return std::exp(-projection.log_fibre_volume()) / (scale * triangulation.triangles()[triangle].area);
  }
};

/// Uniform within each triangle; triangles have masses.
class TriangleDensity final : public Density {
 public:
  using Mass = std::pair<std::uint32_t, double>;

  /// \param masses  in the order of triangles, each once
  TriangleDensity(std::shared_ptr<const Decomposition> decomposition, std::vector<Mass> masses)
      : decomposition_(std::move(decomposition)), masses_(std::move(masses)) {}

  [[nodiscard]] double at(View q) const override {
    const auto triangle = decomposition_->find(q);
    if (!triangle) return 0.0;
    const auto mass = std::lower_bound(masses_.begin(), masses_.end(), *triangle,
                                       [](const Mass& m, std::uint32_t t) { return m.first < t; });
    if (mass == masses_.end() || mass->first != *triangle) return 0.0;
    return mass->second * decomposition_->density(*triangle);
  }
  [[nodiscard]] bool akin(const Density& other) const override {
    const auto* same = dynamic_cast<const TriangleDensity*>(&other);
    return same != nullptr && same->decomposition_ == decomposition_;
  }
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override {
    std::vector<double> sums(decomposition_->triangulation.triangles().size(), 0.0);
    for (const auto& term : terms) {
      for (const auto& [triangle, mass] : dynamic_cast<const TriangleDensity&>(*term.density).masses_) {
        sums[triangle] += term.weight * mass;
      }
    }
    std::vector<Mass> masses;
    for (std::uint32_t t = 0; t < sums.size(); ++t) {
      if (sums[t] > 0.0) masses.emplace_back(t, sums[t]);
    }
    return std::make_shared<TriangleDensity>(decomposition_, std::move(masses));
  }

 private:
  std::shared_ptr<const Decomposition> decomposition_;
  std::vector<Mass> masses_;
};

/// What became of the proposals of each triangle, over all leads.
struct Coverage {
  std::vector<double> drawn;  ///< proposals on a lead
  std::vector<double> nodes;  ///< of the planner

  /// How many proposals a node costs here; 1 before anything is known.
  [[nodiscard]] double difficulty(std::uint32_t triangle) const {
    return (1.0 + drawn[triangle]) / (1.0 + nodes[triangle]);
  }
};

/// h: along a lead, the triangles up to a few beyond the farthest that a node lies in, those with fewer nodes more.
class LeadHeuristic final : public Heuristic {
 public:
  LeadHeuristic(std::shared_ptr<const Decomposition> decomposition, const DecompositionSettings& settings,
                Coverage& coverage, std::vector<std::uint32_t> lead, Configurations lifted)
      : decomposition_(std::move(decomposition)),
        settings_(settings),
        coverage_(coverage),
        lead_(std::move(lead)),
        lifted_(std::move(lifted)),
        position_(2) {
    const auto& triangles = decomposition_->triangulation.triangles();
    std::vector<TriangleDensity::Mass> everywhere;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      everywhere.emplace_back(t, triangles[t].area / decomposition_->triangulation.area());
    }
    everywhere_ = std::make_shared<TriangleDensity>(decomposition_, std::move(everywhere));
    for (const std::uint32_t t : lead_) {
      alone_.push_back(std::make_shared<TriangleDensity>(decomposition_, std::vector<TriangleDensity::Mass>{{t, 1.0}}));
    }
    advance();
  }

  Source sample(Stream& stream, MutableView out) override {
    on_lead_ = stream.uniform() >= settings_.explore;
    drawn_ = on_lead_ ? lead_[pick(stream)] : pick_anywhere(stream);
    const Vec2 p = decomposition_->triangulation.sample(drawn_, stream);
    position_[0] = p.x;
    position_[1] = p.y;
    decomposition_->projection.lift(position_, stream, out);
    return 0;
  }

  [[nodiscard]] double density(View q) const override {
    const auto triangle = decomposition_->find(q);
    if (!triangle) return 0.0;
    double sum = settings_.explore * everywhere_->at(q);
    const double total = total_weight();
    for (std::size_t i = 0; i < available_; ++i) {
      if (lead_[i] != *triangle) continue;
      sum += (1.0 - settings_.explore) * weight(i) / total * decomposition_->density(*triangle);
    }
    return sum;
  }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double share) const override {
    record.add(everywhere_, share * settings_.explore);
    const double total = total_weight();
    for (std::size_t i = 0; i < available_; ++i) {
      record.add(alone_[i], share * (1.0 - settings_.explore) * weight(i) / total);
    }
  }

  void observe(const Outcome& outcome, bool mine) override {
    if (mine && on_lead_) {
      coverage_.drawn[drawn_] += 1.0;
      ++idle_;
    }
    if (outcome.added.empty()) return;
    if (const auto triangle = decomposition_->find(outcome.added)) {
      coverage_.nodes[*triangle] += 1.0;
      ++epoch_;
      if (std::find(lead_.begin() + static_cast<std::ptrdiff_t>(reached_), lead_.end(), *triangle) != lead_.end()) {
        advance();
      }
    }
  }

  [[nodiscard]] bool stale() const override { return idle_ >= settings_.patience; }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"decomposition"}; }
  [[nodiscard]] Configurations lifted_path() const override { return lifted_; }

 private:
  /// Triangles with fewer nodes draw more.
  [[nodiscard]] double weight(std::size_t i) const { return 1.0 / (1.0 + coverage_.nodes[lead_[i]]); }
  [[nodiscard]] double total_weight() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < available_; ++i) sum += weight(i);
    return sum;
  }

  std::size_t pick(Stream& stream) const {
    double u = stream.uniform() * total_weight();
    for (std::size_t i = 0; i + 1 < available_; ++i) {
      u -= weight(i);
      if (u < 0.0) return i;
    }
    return available_ - 1;
  }
  std::uint32_t pick_anywhere(Stream& stream) const {
    const auto& triangles = decomposition_->triangulation.triangles();
    double u = stream.uniform() * decomposition_->triangulation.area();
    for (std::uint32_t t = 0; t + 1 < triangles.size(); ++t) {
      u -= triangles[t].area;
      if (u < 0.0) return t;
    }
    return static_cast<std::uint32_t>(triangles.size() - 1);
  }

  /// Makes available what lies up to `ahead` triangles beyond the farthest with a node.
  void advance() {
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < lead_.size(); ++i) {
      if (coverage_.nodes[lead_[i]] > 0.0) farthest = i + 1;
    }
    if (farthest > reached_) idle_ = 0;
    reached_ = farthest;
    available_ = std::min(lead_.size(), std::max<std::size_t>(reached_, 1) + static_cast<std::size_t>(settings_.ahead));
    ++epoch_;
  }

  std::shared_ptr<const Decomposition> decomposition_;
  DecompositionSettings settings_;
  Coverage& coverage_;
  std::vector<std::uint32_t> lead_;
  Configurations lifted_;
  std::shared_ptr<const Density> everywhere_;
  std::vector<std::shared_ptr<const Density>> alone_;  ///< of each triangle of the lead
  std::size_t reached_ = 0;                            ///< triangles of the lead up to the farthest with a node
  std::size_t available_ = 0;                          ///< that draw
  std::int64_t idle_ = 0;                              ///< own proposals on the lead since it went on
  std::uint64_t epoch_ = 0;
  std::uint32_t drawn_ = 0;
  bool on_lead_ = false;
  Configuration position_;
};

class DecompositionGuide final : public Guide {
 public:
  explicit DecompositionGuide(const DecompositionSettings& settings) : settings_(settings) {}

  std::unique_ptr<Instance> project(const Instance& parent) override {
    const World& world = parent.scene->world;
    const auto& axes = parent.space.axes();
    decomposition_ = std::make_shared<const Decomposition>(
        Decomposition{Triangulation(world, side_length(parent)), PositionProjection("decomposition", parent),
                      axes[parent.position_axes[0]].weight * axes[parent.position_axes[1]].weight});
    const std::size_t count = decomposition_->triangulation.triangles().size();
    if (count == 0) throw Error("decomposition: the world leaves no free space");
    coverage_ = {std::vector<double>(count, 0.0), std::vector<double>(count, 0.0)};

    auto instance = decomposition_->projection.point_instance(parent);
    make_graph(*instance);
    instance->graph = graph_;
    if (const auto triangle = decomposition_->find(parent.start)) coverage_.nodes[*triangle] = 1.0;
    return instance;
  }

  void project(View q, MutableView s) const override { decomposition_->projection.project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { decomposition_->projection.lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View) const override { return -decomposition_->projection.log_fibre_volume(); }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution* found) override {
    std::vector<std::uint32_t> lead;
    for (std::size_t i = 0; i < found->path.size(); ++i) {
      const auto triangle = decomposition_->triangulation.find({found->path[i][0], found->path[i][1]});
      if (triangle && std::find(lead.begin(), lead.end(), *triangle) == lead.end()) lead.push_back(*triangle);
    }
    if (lead.empty()) return std::make_unique<UniformHeuristic>("decomposition (found nothing)", parent.space);
    return std::make_unique<LeadHeuristic>(decomposition_, settings_, coverage_, std::move(lead),
                                           decomposition_->projection.lifted(found->path, parent.start, parent.goal));
  }

  /// The longer it takes to get nodes into triangles, the dearer are the ways through them.
  void before_resolve() override {
    for (std::size_t e = 0; e < graph_->edges.size(); ++e) {
      const auto& [a, b] = sides_[e];
      graph_->edges[e].cost = lengths_[e] * 0.5 * (coverage_.difficulty(a) + coverage_.difficulty(b));
    }
  }

 private:
  [[nodiscard]] double side_length(const Instance& parent) const {
    if (settings_.size > 0.0) return settings_.size;
    const double robot = parent.scene->robot.bounding_radius();
    const Box2& bounds = parent.scene->world.bounds();
    return robot > 0.0 ? 2.0 * robot : 0.02 * norm(bounds.hi - bounds.lo);
  }

  /// Triangles as vertices at their centroids, joined through the middles of the sides that they share; start and goal
  /// are joined to the triangles that they lie in.
  void make_graph(const Instance& instance) {
    graph_ = std::make_shared<Graph>();
    graph_->vertices = Configurations(2);
    const auto& triangles = decomposition_->triangulation.triangles();
    for (const auto& triangle : triangles)
      graph_->vertices.push(std::array{triangle.centroid().x, triangle.centroid().y});
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto across = triangles[t].neighbours[k];
        if (!across || *across < t) continue;
        const Vec2 middle = 0.5 * (triangles[t].corners[(k + 1) % 3] + triangles[t].corners[(k + 2) % 3]);
        Configurations points(2);
        points.push(std::as_const(graph_->vertices)[t]);
        points.push(std::array{middle.x, middle.y});
        points.push(std::as_const(graph_->vertices)[*across]);
        add_edge(t, *across, std::move(points), {t, *across}, instance.space);
      }
    }
    graph_->start = join(instance.start, instance.space);
    graph_->goal = join(instance.goal, instance.space);
  }

  std::uint32_t join(const Configuration& position, const Space& space) {
    const std::uint32_t vertex = graph_->vertices.push(position);
    if (const auto triangle = decomposition_->triangulation.find({position[0], position[1]})) {
      Configurations points(2);
      points.push(position);
      points.push(std::as_const(graph_->vertices)[*triangle]);
      add_edge(vertex, *triangle, std::move(points), {*triangle, *triangle}, space);
    }
    return vertex;
  }

  void add_edge(std::uint32_t from, std::uint32_t to, Configurations points,
                std::pair<std::uint32_t, std::uint32_t> sides, const Space& space) {
    const double length = path_length(space, points);
    graph_->edges.push_back({from, to, length, std::move(points)});
    sides_.push_back(sides);
    lengths_.push_back(length);
  }

  DecompositionSettings settings_;
  std::shared_ptr<const Decomposition> decomposition_;
  std::shared_ptr<Graph> graph_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides_;  ///< of each edge: the triangles that it joins
  std::vector<double> lengths_;                                 ///< of each edge
  Coverage coverage_;
};

}  // namespace

GuideKind decomposition_kind() {
  return {&decomposition_settings().component(),
          [](const Options& o) -> std::unique_ptr<Guide> {
            return std::make_unique<DecompositionGuide>(decomposition_settings().read(o));
          },
          "graph_search",
          [](const Options& o) { return decomposition_settings().read(o).resolves; },
          {.category = GuideClaims::Category::robot,
           .f = "q -> the position of the reference point, in a triangle of the free workspace",
           .h = "a triangle of the lead, no more than `ahead` beyond what the tree has reached, those with fewer nodes "
                "more often; uniform in it, all else uniform; any triangle with a share of `explore`",
           .closed_form = true,
           .density = "of the mixture of triangles",
           .feedback = "nodes and proposals are counted by triangle; `patience` proposals without progress, and the "
                       "edges are weighed by proposals per node and another lead is searched",
           .relaxes = true,
           .invalid_ends = "an end whose position is in no triangle is joined to none, so S has no path",
           .fallback = GuideClaims::Fallback::own,
           .no_path = "the lead goes to the triangle nearest to the goal that can be reached; uniform where the start "
                      "is in none",
           .example = "examples/kinodynamic.lua",
           .needs = GuideClaims::Needs::position}};
}

}  // namespace trellis
