// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/figures/html_run.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/figures/base64.hpp>
#include <trellis/figures/spatial_shapes.hpp>
#include <trellis/figures/traces.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

/// Variable-length integers: seven bits to a byte, the lowest first.
class Numbers {
 public:
  void add(std::uint64_t value) {
    for (; value > 127U; value >>= 7U) bytes_ += static_cast<char>((value & 127U) | 128U);
    bytes_ += static_cast<char>(value);
  }
  /// Maps 0, -1, 1, -2, ... to 0, 1, 2, 3, ...
  void add_signed(std::int64_t value) { add(zigzag(value)); }
  static std::uint64_t zigzag(std::int64_t value) {
    return value < 0 ? 2U * static_cast<std::uint64_t>(-(value + 1)) + 1U : 2U * static_cast<std::uint64_t>(value);
  }
  [[nodiscard]] std::string text() const { return base64(bytes_); }

 private:
  std::string bytes_;
};

std::string packed(const Configurations& rows, const Space& space) {
  const std::vector<Axis> axes = space.coordinates();
  std::string bytes;
  bytes.reserve(2 * rows.values().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const View q = rows[i];
    for (std::size_t j = 0; j < q.size(); ++j) {
      const Axis& axis = axes[j];
      const double share = (q[j] - axis.lo) / (axis.hi - axis.lo);
      const auto value =
          static_cast<std::uint32_t>(share > 0.0 ? std::lround(65535.0 * std::min(share, 1.0)) : 0);  // NaN: 0
      bytes += static_cast<char>(value & 255U);
      bytes += static_cast<char>(value >> 8U);
    }
  }
  return base64(bytes);
}

double rounded(double x) { return std::isfinite(x) ? std::round(x * 1e6) / 1e6 : 0.0; }

Json shape_json(const Disc& disc) { return {rounded(disc.centre.x), rounded(disc.centre.y), rounded(disc.radius)}; }

Json points_json(const std::vector<Vec2>& points) {
  Json out = Json::array();
  for (const Vec2& p : points) {
    out.push_back(rounded(p.x));
    out.push_back(rounded(p.y));
  }
  return out;
}

Json shape_json(const ConvexShape& shape) {
  if (const auto* disc = std::get_if<Disc>(&shape)) return shape_json(*disc);
  return points_json(std::get<Polygon>(shape).vertices);
}

Json robot_json(const Robot& robot) {
  Json bodies = Json::array();
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    const Body& body = robot.bodies()[i];
    Json parts = Json::array();
    for (const auto& part : body.parts) parts.push_back(shape_json(part));
    bodies.push_back({{"parts", std::move(parts)},
                      {"parent", body.parent},
                      {"joint", {rounded(body.joint.x), rounded(body.joint.y)}},
                      {"axis", body.angle_axis},
                      {"absolute", body.absolute}});
    if (!robot.members().empty()) {
      bodies.back()["position"] = body.position_axis;
      bodies.back()["robot"] = robot.members()[robot.member_of(i)].number - 1;
    }
  }
  return {{"translates", robot.translates()},
          {"base", {rounded(robot.base().x), rounded(robot.base().y)}},
          {"dimension", robot.dimension()},
          {"radius", rounded(robot.bounding_radius())},
          {"bodies", std::move(bodies)}};
}

Json axes_json(const Space& space) {
  Json out = Json::array();
  for (const Axis& axis : space.coordinates()) {
    out.push_back({axis.name, axis.lo, axis.hi, axis.periodic ? 1 : 0, axis.weight});
  }
  return out;
}

/// Returns the first column of each rotation.
Json rotations_json(const Space& space) {
  Json out = Json::array();
  for (const Factor& factor : space.factors()) {
    if (factor.kind == Factor::Kind::rotation) out.push_back(factor.column);
  }
  return out;
}

/// Packs surfaces: vertices as 32-bit floats; of each surface the numbers of vertices, triangles and edges, and whether
/// it is closed; triangles and edges as indices of vertices of their surface.
Json surfaces_json(const std::vector<draw::Surface>& surfaces) {
  std::string floats;
  Numbers parts;
  Numbers triangles;
  Numbers edges;
  for (const draw::Surface& surface : surfaces) {
    for (const draw::Point3& p : surface.vertices) {
      for (const double x : {p.x, p.y, p.z}) {
        const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(x));
        for (const unsigned shift : {0U, 8U, 16U, 24U}) floats += static_cast<char>((bits >> shift) & 255U);
      }
    }
    const auto sharp = draw::feature_edges(surface);
    for (const std::size_t n : {surface.vertices.size(), surface.triangles.size(), sharp.size()}) parts.add(n);
    parts.add(surface.closed ? 1 : 0);
    for (const auto& t : surface.triangles) {
      for (const std::uint32_t i : t) triangles.add(i);
    }
    for (const auto& [a, b] : sharp) {
      edges.add(a);
      edges.add(b);
    }
  }
  return {
      {"vertices", base64(floats)}, {"parts", parts.text()}, {"triangles", triangles.text()}, {"edges", edges.text()}};
}

Json robot_json(const Robot3& robot) {
  constexpr std::size_t most_triangles = 3000;
  std::vector<draw::Surface> surfaces;
  const auto add = [&](const Robot3& one) {
    if (one.is_point()) return;
    for (draw::Surface& surface : placed(one, Configuration{0, 0, 0, 0, 0, 0, 1}, most_triangles)) {
      surfaces.push_back(std::move(surface));
    }
  };
  Json out = {
      {"dimension", robot.dimension()}, {"rotates", robot.rotates()}, {"radius", rounded(robot.bounding_radius())}};
  if (robot.members().empty()) {
    add(robot);
  } else {
    // Of each surface, which coordinates move it, and whether they turn it.
    Json columns = Json::array();
    for (const Robot3::Member& member : robot.members()) {
      add(*member.robot);
      while (columns.size() < surfaces.size()) columns.push_back({member.column, member.robot->rotates()});
    }
    out["columns"] = std::move(columns);
  }
  out["surfaces"] = surfaces_json(surfaces);
  return out;
}

/// A robot of links and joints: the page computes the poses of its bodies.
Json robot_json(const SphereModel& model) {
  const auto pose = [](const Pose3& p) {
    const Quaternion& q = p.orientation;
    return Json{p.position.x, p.position.y, p.position.z, q.x, q.y, q.z, q.w};
  };
  std::vector<draw::Surface> surfaces;
  Json bodies = Json::array();
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const Manipulator::Body& body = model.robot().bodies()[b];
    surfaces.push_back(surface_of(model, b));
    bodies.push_back({{"parent", body.parent},
                      {"origin", pose(body.origin)},
                      {"kind", to_string(body.kind)},
                      {"axis", {body.axis.x, body.axis.y, body.axis.z}},
                      {"column", body.column},
                      {"multiplier", body.multiplier},
                      {"offset", body.offset}});
  }
  const auto tip_json = [](const PointOnBody& tip) { return Json{tip.body, tip.point.x, tip.point.y, tip.point.z}; };
  Json tips = Json::array();
  for (const PointOnBody& tip : model.tips()) tips.push_back(tip_json(tip));
  return {{"dimension", model.robot().dimension()},
          {"rotates", false},
          {"radius", rounded(model.bounding_radius())},
          {"base", pose(model.base())},
          {"bodies", std::move(bodies)},
          {"tip", tip_json(model.tip())},
          {"tips", std::move(tips)},
          {"surfaces", surfaces_json(surfaces)}};
}

/// Returns of each proposal its outcome and, from bit 2, its own validity: 0 unknown, 1 valid, 2 invalid.
std::string packed_fates(const LevelRecord& record, const Search& search, const Problem& problem) {
  std::unique_ptr<Checker> checker;
  if (record.scene && record.places_robot && !record.presumed &&
      record.space.dimension() >= record.scene->robot_dimension()) {
    // A space may be that of another kind of robot, as the hand's positions are of an arm.
    const std::vector<std::string> known = collision_backends(*record.scene);
    const bool same = std::find(known.begin(), known.end(), problem.collision) != known.end();
    checker = make_checker(same ? problem.collision : known.front(), record.scene, record.space, problem.resolution);
  }
  std::string bytes;
  bytes.reserve(search.proposals.size());
  for (std::size_t i = 0; i < search.proposals.size(); ++i) {
    const Fate fate = i < search.fates.size() ? search.fates[i] : Fate::rejected;
    unsigned validity = 0;
    if (fate == Fate::reached && !record.presumed) {
      validity = 1;
    } else if (checker) {
      validity = checker->valid(search.proposals[i]) ? 1 : 2;
    }
    bytes += static_cast<char>(static_cast<unsigned>(fate) | (validity << 2U));
  }
  return base64(bytes);
}

/// Returns for each node the signed difference of its index and its parent's, 0 for a root: after a rewiring the parent
/// may have a larger index. null without a tree.
Json packed_parents(const Search& search) {
  const auto& parents = search.parents;
  if (parents.size() != search.nodes.size() ||
      std::all_of(parents.begin(), parents.end(), [](std::uint32_t p) { return p == no_node; })) {
    return nullptr;
  }
  Numbers out;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    out.add_signed(parents[i] == no_node ? 0 : static_cast<std::int64_t>(i) - static_cast<std::int64_t>(parents[i]));
  }
  return out.text();
}

/// Stores each index plus one; 0 for none.
std::string packed_near(const Search& search) {
  Numbers out;
  for (std::size_t i = 0; i < search.proposals.size(); ++i) {
    const std::uint32_t near = i < search.near.size() ? search.near[i] : no_node;
    out.add(near < search.nodes.size() ? near + std::uint64_t{1} : 0);
  }
  return out.text();
}

/// Stores the signed difference from the previous index plus one; 0 for none.
std::string packed_added(const Search& search) {
  Numbers out;
  std::int64_t last = 0;
  for (std::size_t i = 0; i < search.proposals.size(); ++i) {
    const std::uint32_t added = i < search.added.size() ? search.added[i] : no_node;
    if (added >= search.nodes.size()) {
      out.add(0);
      continue;
    }
    out.add(Numbers::zigzag(static_cast<std::int64_t>(added) - last) + 1);
    last = added;
  }
  return out.text();
}

/// Stores for each edge its first end relative to that of the edge before, and its second end relative to its first.
std::string packed_edges(const Search& search) {
  Numbers out;
  std::int64_t last = 0;
  for (const auto& [a, b] : search.edges) {
    out.add_signed(static_cast<std::int64_t>(a) - last);
    out.add_signed(static_cast<std::int64_t>(b) - static_cast<std::int64_t>(a));
    last = a;
  }
  return out.text();
}

std::string packed_sources(const Search& search) {
  Numbers out;
  for (std::size_t i = 0; i < search.proposals.size(); ++i) {
    out.add(i < search.proposal_sources.size() ? search.proposal_sources[i] : 0);
  }
  return out.text();
}

/// The rows of a search that the page contains, in ascending order.
struct HeldRows {
  std::vector<std::uint32_t> proposals;
  std::vector<std::uint32_t> nodes;
};

bool is_all(double share) { return share >= 1.0; }

/// Returns a `share` of the rows, evenly spaced, with the first and the last. \param always  rows to include in any
/// case
std::vector<std::uint32_t> spread(std::size_t rows, double share, const std::vector<char>& always = {}) {
  std::vector<std::uint32_t> held;
  double due = 1.0;
  for (std::size_t i = 0; i < rows; ++i) {
    if (due >= 1.0 || i + 1 == rows || (!always.empty() && always[i] != 0)) {
      held.push_back(static_cast<std::uint32_t>(i));
      due = std::max(0.0, due - 1.0);
    }
    due += share;
  }
  return held;
}

HeldRows held_rows(const Search& search, double share) {
  std::vector<char> roots(search.nodes.size(), 0);
  for (std::size_t i = 0; i < std::min(search.parents.size(), roots.size()); ++i) {
    if (search.parents[i] == i) roots[i] = 1;
  }
  return {spread(search.proposals.size(), share), spread(search.nodes.size(), share, roots)};
}

/// Returns how many of the ascending rows are smaller than `row`.
std::uint32_t rows_before(const std::vector<std::uint32_t>& rows, std::uint32_t row) {
  return static_cast<std::uint32_t>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
}

/// Returns the search with the selected rows. A reference to an omitted node becomes one to its nearest selected
/// ancestor; an edge with an omitted end is removed.
Search thinned(const Search& search, const HeldRows& held) {
  std::vector<std::uint32_t> at(search.nodes.size(), no_node);
  for (std::size_t i = 0; i < held.nodes.size(); ++i) at[held.nodes[i]] = static_cast<std::uint32_t>(i);
  const auto ancestor = [&](std::uint32_t row) {
    // A path to a tree's root visits each node at most once.
    for (std::size_t steps = 0; row < at.size() && steps <= at.size(); ++steps) {
      if (at[row] != no_node) return at[row];
      if (row >= search.parents.size() || search.parents[row] == row) break;
      row = search.parents[row];
    }
    return no_node;
  };
  Search out(search.nodes.dimension());
  out.sources = search.sources;
  const bool tree = search.parents.size() == search.nodes.size();
  for (const std::uint32_t row : held.nodes) {
    out.nodes.push(search.nodes[row]);
    if (!tree) continue;
    const std::uint32_t parent = search.parents[row];
    out.parents.push_back(parent == no_node ? no_node : parent == row ? at[row] : ancestor(parent));
  }
  for (const std::uint32_t row : held.proposals) {
    out.proposals.push(search.proposals[row]);
    out.fates.push_back(row < search.fates.size() ? search.fates[row] : Fate::rejected);
    out.near.push_back(row < search.near.size() ? ancestor(search.near[row]) : no_node);
    const std::uint32_t added = row < search.added.size() ? search.added[row] : no_node;
    out.added.push_back(added < at.size() ? at[added] : no_node);
    out.proposal_sources.push_back(row < search.proposal_sources.size() ? search.proposal_sources[row] : 0);
  }
  for (const auto& [a, b] : search.edges) {
    if (a < at.size() && b < at.size() && at[a] != no_node && at[b] != no_node) out.edges.push_back({at[a], at[b]});
  }
  return out;
}

/// Packs a level with the selected rows; nullptr selects all rows.
Json level_json(const std::vector<LevelResult>& levels, std::size_t number, const Search& search, const HeldRows* held,
                const Problem& problem, RobotTable& robots) {
  const LevelResult& level = levels[number];
  const LevelRecord& record = level.record;
  Json classes = nullptr;
  if (level.metrics && level.metrics->classes.size() == record.search.nodes.size()) {
    std::string bytes;
    const auto& all = level.metrics->classes;
    for (std::size_t i = 0; i < search.nodes.size(); ++i) {
      bytes += static_cast<char>(all[held != nullptr ? held->nodes[i] : i]);
    }
    classes = base64(bytes);
  }
  Json position = Json::array();
  for (const std::size_t axis : record.position_axes) position.push_back(axis);
  Json json = {{"name", record.name},
               {"parent", record.parent},
               {"depth", record.depth},
               {"space", record.space.name()},
               {"planner", record.planner},
               {"solves", record.solves},
               {"axes", axes_json(record.space)},
               {"position", std::move(position)},
               {"robot", robots.add(record.scene.get())},
               {"sources", search.sources},
               {"nodes", packed(search.nodes, record.space)},
               {"parents", packed_parents(search)},
               {"edges", packed_edges(search)},
               {"classes", std::move(classes)},
               {"proposals", packed(search.proposals, record.space)},
               {"fates", packed_fates(record, search, problem)},
               {"source", packed_sources(search)},
               {"near", packed_near(search)},
               {"added", packed_added(search)},
               {"all", {record.search.proposals.size(), record.search.nodes.size()}}};
  if (!record.space.flat()) json["rotations"] = rotations_json(record.space);
  if (problem.scene && problem.scene->members().size() > 1) {
    json["traces"] = traces_json(traces_of(levels, number));
    json["first"] = first_coordinate(levels, number);
  }
  return json;
}

/// Packs the turns of a run with the selected rows of each level; an empty list selects all rows.
Json turns_json(const RunResult& run, const std::vector<HeldRows>& held) {
  Json out = Json::array();
  const auto add = [&](const Turn& turn) {
    const auto at = static_cast<std::size_t>(turn.level);
    const LevelRecord& record = run.levels[at].record;
    const std::string path = packed(turn.path, record.space);
    out.push_back({turn.level, held.empty() ? turn.proposals : rows_before(held[at].proposals, turn.proposals),
                   held.empty() ? turn.nodes : rows_before(held[at].nodes, turn.nodes), turn.solve_ended ? 1 : 0,
                   path.empty() ? Json(nullptr) : Json(path)});
  };
  for (const Turn& turn : run.run.turns) add(turn);
  if (!run.run.turns.empty()) return out;
  // Records of other executors: one turn for each level, the deepest first.
  for (auto level = run.levels.rbegin(); level != run.levels.rend(); ++level) {
    const LevelRecord& record = level->record;
    add({record.level, static_cast<std::uint32_t>(record.search.proposals.size()),
         static_cast<std::uint32_t>(record.search.nodes.size()), true,
         record.solution.solved() ? record.solution.path : Configurations()});
  }
  return out;
}

}  // namespace

int RobotTable::add(const Scene* scene) {
  if (scene == nullptr) return -1;
  Json robot = visit(*scene, [](const auto& one) { return robot_json(one.robot); });
  const auto [at, fresh] = places_.emplace(robot.dump(), static_cast<int>(list_.size()));
  if (fresh) list_.push_back(std::move(robot));
  return at->second;
}

Json traces_json(const std::vector<Trace>& traces) {
  Json out = Json::array();
  for (const Trace& trace : traces) {
    Json one = {{"robot", trace.robot}, {"position", trace.axes}};
    if (trace.axes.empty()) {
      one["tip"] = {trace.tip.body, trace.tip.point.x, trace.tip.point.y, trace.tip.point.z};
    }
    out.push_back(std::move(one));
  }
  return out;
}

int WorldTable::add(const World3& world) {
  constexpr std::size_t most_triangles = 12'000;
  const auto [at, fresh] = places_.emplace(world.identity().get(), static_cast<int>(list_.size()));
  if (!fresh) return at->second;
  const WorldSurfaces surfaces = surfaces_of(world, most_triangles);
  Json json = surfaces_json(surfaces.obstacles);
  json["note"] = surfaces.note();
  list_.push_back(std::move(json));
  return at->second;
}

Json shape_json(const Shape& shape) {
  if (const auto* disc = std::get_if<Disc>(&shape)) return shape_json(*disc);
  if (const auto* box = std::get_if<Box2>(&shape)) return points_json(rectangle_vertices(*box));
  return points_json(std::get<Polygon>(shape).vertices);
}

Json packed_run(const RunResult& run, const Problem& problem, RobotTable& robots, double share) {
  Json levels = Json::array();
  std::vector<HeldRows> held;
  for (std::size_t i = 0; i < run.levels.size(); ++i) {
    const Search& search = run.levels[i].record.search;
    if (is_all(share)) {
      levels.push_back(level_json(run.levels, i, search, nullptr, problem, robots));
      continue;
    }
    held.push_back(held_rows(search, share));
    levels.push_back(level_json(run.levels, i, thinned(search, held.back()), &held.back(), problem, robots));
  }
  Json path = nullptr;
  if (run.run.solved && !run.levels.empty()) path = packed(run.run.path, run.levels.front().record.space);
  return {{"levels", std::move(levels)}, {"turns", turns_json(run, held)}, {"path", std::move(path)}};
}

std::string script_json(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace trellis
