// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/scenery.hpp>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <variant>

#include <trellis/draw/camera.hpp>
#include <trellis/pictures/axes_json.hpp>
#include <trellis/pictures/base64.hpp>
#include <trellis/pictures/packing.hpp>
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/pictures/traces.hpp>
#include <trellis/results/run_json.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

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
  return {{"kind", "planar"},
          {"translates", robot.translates()},
          {"base", {rounded(robot.base().x), rounded(robot.base().y)}},
          {"dimension", robot.dimension()},
          {"radius", rounded(robot.bounding_radius())},
          {"bodies", std::move(bodies)}};
}

Json shape_json(const Shape& shape) {
  if (const auto* disc = std::get_if<Disc>(&shape)) return shape_json(*disc);
  if (const auto* box = std::get_if<Box2>(&shape)) return points_json(rectangle_vertices(*box));
  return points_json(std::get<Polygon>(shape).vertices);
}

/// Packs surfaces: vertices as 32-bit floats; of each surface the numbers of vertices, triangles and edges, and whether
/// it is closed; triangles and edges as indices of vertices of their surface.
Json surfaces_json(const std::vector<draw::Surface>& surfaces) {
  std::string floats;
  PackedNumbers parts;
  PackedNumbers triangles;
  PackedNumbers edges;
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
  Json out = {{"kind", "rigid"},
              {"dimension", robot.dimension()},
              {"rotates", robot.rotates()},
              {"radius", rounded(robot.bounding_radius())}};
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
  return {{"kind", "tree"},
          {"dimension", model.robot().dimension()},
          {"rotates", false},
          {"radius", rounded(model.bounding_radius())},
          {"base", pose(model.base())},
          {"bodies", std::move(bodies)},
          {"tip", tip_json(model.tip())},
          {"tips", std::move(tips)},
          {"surfaces", surfaces_json(surfaces)}};
}

Json world_json(const PlanarScene& scene) {
  const Box2& box = scene.world.bounds();
  Json obstacles = Json::array();
  for (const auto& obstacle : scene.world.obstacles()) obstacles.push_back(shape_json(obstacle.shape));
  return {{"dimension", 2}, {"bounds", {box.lo.x, box.lo.y, box.hi.x, box.hi.y}}, {"obstacles", std::move(obstacles)}};
}

Json world_json(const World3& world) {
  constexpr std::size_t most_triangles = 12'000;
  const auto& [lo, hi] = world.bounds();
  const draw::Camera camera = draw::camera_for(drawn(lo), drawn(hi));
  const WorldSurfaces surfaces = surfaces_of(world, most_triangles);
  return {{"dimension", 3},
          {"bounds", {lo.x, lo.y, lo.z, hi.x, hi.y, hi.z}},
          {"view", {camera.azimuth, camera.elevation}},
          {"surfaces", surfaces_json(surfaces.obstacles)},
          {"note", surfaces.note()}};
}

/// A list of distinct worlds: problems of one world share it.
class WorldTable {
 public:
  /// Returns the index of the scene's world in the list; null without a scene.
  Json add(const Scene* scene) {
    if (scene == nullptr) return nullptr;
    const World3* space = spatial_world(*scene);
    if (space == nullptr && scene->planar() == nullptr) return nullptr;
    if (space != nullptr) {
      if (const auto known = same_.find(space->identity().get()); known != same_.end()) return known->second;
    }
    Json world = space != nullptr ? world_json(*space) : world_json(*scene->planar());
    const auto [at, fresh] = places_.emplace(world.dump(), list_.size());
    if (fresh) list_.push_back(std::move(world));
    if (space != nullptr) same_.emplace(space->identity().get(), at->second);
    return at->second;
  }
  [[nodiscard]] const Json& list() const { return list_; }

 private:
  Json list_ = Json::array();
  std::map<std::string, std::size_t> places_;
  std::map<const void*, std::size_t> same_;  ///< only looked up, so its order does not matter
};

Json scene_json(const Problem& problem, RobotTable& robots, WorldTable& worlds) {
  const Scene* scene = problem.scene.get();
  Json position = Json::array();
  for (std::size_t i = 0; scene != nullptr && scene->translates() && i < scene->world_dimension(); ++i) {
    position.push_back(i);
  }
  const int robot = robots.add(scene);
  Json json = {{"problem", problem.name},
               {"world", worlds.add(scene)},
               {"robot", robot < 0 ? Json(nullptr) : Json(robot)},
               {"axes", axes_json(problem.space)},
               {"rotations", rotations_json(problem.space)},
               {"position", std::move(position)}};
  if (scene == nullptr) return json;
  json["traces"] = traces_json(traces_of(problem));
  const std::vector<TeamMember> members = scene->members();
  if (members.size() < 2) return json;
  Json team = Json::array();
  for (const TeamMember& member : members) team.push_back({{"number", member.number}, {"axes", member.axes}});
  json["team"] = std::move(team);
  return json;
}

}  // namespace

int RobotTable::add(const Scene* scene) {
  if (scene == nullptr) return -1;
  Json robot = visit(*scene, [](const auto& one) { return robot_json(one.robot); });
  const auto [at, fresh] = places_.emplace(robot.dump(), static_cast<int>(list_.size()));
  if (fresh) list_.push_back(std::move(robot));
  return at->second;
}

RobotTable robots_of(const Experiment& experiment) {
  RobotTable robots;
  for (const Problem& problem : experiment.problems) robots.add(problem.scene.get());
  return robots;
}

Scenery scenery_of(const Experiment& experiment) {
  RobotTable robots;
  WorldTable worlds;
  Json scenes = Json::array();
  for (const Problem& problem : experiment.problems) scenes.push_back(scene_json(problem, robots, worlds));
  const auto text = [](const Json& list) { return json::lines(list.get_ref<const Json::array_t&>()); };
  return {text(worlds.list()), text(robots.list()), text(scenes)};
}

}  // namespace trellis
