// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/visit.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <variant>

namespace trellis {

namespace {

using draw::Point3;
using draw::Surface;

/// Returns the surface of a solid of revolution about z: circles of radius r at height z from below to above, of which
/// the first and the last are points or closed by a disc.
Surface revolved(const std::vector<std::pair<double, double>>& circles, unsigned sides) {
  Surface out;
  std::vector<std::uint32_t> first;  // of each circle
  std::vector<unsigned> count;
  const auto add_circle = [&](double r, double z) {
    first.push_back(static_cast<std::uint32_t>(out.vertices.size()));
    count.push_back(r > 0.0 ? sides : 1U);
    for (unsigned i = 0; i < count.back(); ++i) {
      const double angle = 2.0 * std::numbers::pi * i / sides;
      out.vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
  };
  if (circles.front().first > 0.0) add_circle(0.0, circles.front().second);
  for (const auto& [r, z] : circles) add_circle(r, z);
  if (circles.back().first > 0.0) add_circle(0.0, circles.back().second);
  for (std::size_t ring = 0; ring + 1 < first.size(); ++ring) {
    const auto vertex = [&](std::size_t which, unsigned i) { return first[which] + i % count[which]; };
    for (unsigned i = 0; i < sides; ++i) {
      if (count[ring] > 1) out.triangles.push_back({vertex(ring, i), vertex(ring, i + 1), vertex(ring + 1, i + 1)});
      if (count[ring + 1] > 1) out.triangles.push_back({vertex(ring, i), vertex(ring + 1, i + 1), vertex(ring + 1, i)});
    }
  }
  return out;
}

/// Adds quarter circles from a pole: of a ball's lower half from -90 to 0 degrees, of the upper half from 0 to 90.
void add_half_ball(std::vector<std::pair<double, double>>& circles, double radius, double z, bool upper,
                   unsigned sides) {
  const int steps = static_cast<int>(sides) / 4;
  for (int i = 0; i <= steps; ++i) {
    const int step = upper ? i : i - steps;
    const double angle = 0.5 * std::numbers::pi * step / steps;
    circles.emplace_back(std::abs(step) == steps ? 0.0 : radius * std::cos(angle), z + radius * std::sin(angle));
  }
}

/// How many points of a cloud a picture shows.
std::size_t drawn_points(unsigned sides) { return std::size_t{50} * sides; }

/// A point that is too small to be seen is drawn larger.
double drawn_radius(const PointCloud& cloud) {
  constexpr double seen = 0.002;  // of the cloud's diagonal
  return std::max(cloud.radius(), seen * norm(cloud.bounds().hi - cloud.bounds().lo));
}

struct Tessellation {
  unsigned sides;  ///< of a turn

  Surface operator()(const Sphere& sphere) const {
    if (!(sphere.radius > 0.0)) return {};
    std::vector<std::pair<double, double>> circles;
    add_half_ball(circles, sphere.radius, 0.0, false, sides);
    circles.pop_back();
    add_half_ball(circles, sphere.radius, 0.0, true, sides);
    return revolved(circles, sides);
  }
  Surface operator()(const Cuboid& box) const {
    Surface out;
    for (unsigned i = 0; i < 8; ++i) {
      const auto side = [i](unsigned bit, double length) { return (i & bit) != 0 ? 0.5 * length : -0.5 * length; };
      out.vertices.push_back({side(1, box.size.x), side(2, box.size.y), side(4, box.size.z)});
    }
    out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return out;
  }
  Surface operator()(const Cylinder& cylinder) const {
    return revolved({{cylinder.radius, -0.5 * cylinder.length}, {cylinder.radius, 0.5 * cylinder.length}}, sides);
  }
  Surface operator()(const Capsule& capsule) const {
    std::vector<std::pair<double, double>> circles;
    add_half_ball(circles, capsule.radius, -0.5 * capsule.length, false, sides);
    add_half_ball(circles, capsule.radius, 0.5 * capsule.length, true, sides);
    return revolved(circles, sides);
  }
  Surface operator()(const std::shared_ptr<const Mesh>& mesh) const {
    Surface out{.closed = mesh->closed()};
    out.vertices.reserve(mesh->vertices().size());
    for (const Vec3& v : mesh->vertices()) out.vertices.push_back(drawn(v));
    out.triangles = mesh->triangles();
    return out;
  }
  /// Some of the points, each as an octahedron that is large enough to be seen.
  Surface operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    const auto& points = cloud->points();
    const std::size_t count = std::min(points.size(), drawn_points(sides));
    const double r = drawn_radius(*cloud);
    Surface out;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& p = points[i * points.size() / count];
      const auto first = static_cast<std::uint32_t>(out.vertices.size());
      for (const Vec3& corner : {Vec3{r, 0, 0}, Vec3{0, r, 0}, Vec3{-r, 0, 0}, Vec3{0, -r, 0}}) {
        out.vertices.push_back(drawn(p + corner));
      }
      out.vertices.push_back(drawn(p + Vec3{0, 0, r}));
      out.vertices.push_back(drawn(p - Vec3{0, 0, r}));
      for (std::uint32_t side = 0; side < 4; ++side) {
        const std::uint32_t next = (side + 1) % 4;
        out.triangles.push_back({first + side, first + next, first + 4});
        out.triangles.push_back({first + next, first + side, first + 5});
      }
    }
    return out;
  }
};

bool is_sphere(const Solid& solid) { return std::holds_alternative<Sphere>(solid.shape); }
const PointCloud* cloud_of(const Solid& solid) {
  const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&solid.shape);
  return cloud != nullptr ? cloud->get() : nullptr;
}
bool is_mesh(const Solid& solid) { return std::holds_alternative<std::shared_ptr<const Mesh>>(solid.shape); }

}  // namespace

Point3 drawn(const Vec3& p) { return {p.x, p.y, p.z}; }

Surface moved(const Surface& surface, const Pose3& pose) {
  Surface out = surface;
  for (Point3& p : out.vertices) p = drawn(pose({p.x, p.y, p.z}));
  return out;
}

Surface surface_of(const Solid& solid, unsigned sides) {
  return moved(std::visit(Tessellation{sides}, solid.shape), solid.pose);
}

Surface surface_of(const Robot3& robot) {
  Surface out;
  for (const Solid& solid : robot.solids()) append(out, surface_of(solid));
  return out;
}

std::string WorldSurfaces::note() const {
  std::string text;
  if (shown_points < points) text = fmt::format("Of {} points of clouds {} are drawn.", points, shown_points);
  if (cell == 0.0) return text;
  std::size_t drawn = 0;
  for (const Surface& surface : obstacles) drawn += surface.triangles.size();
  return fmt::format("{}{}Meshes are simplified: {} of {} triangles, vertices within {:.2g} m merged.", text,
                     text.empty() ? "" : " ", drawn, triangles, cell);
}

WorldSurfaces surfaces_of(const World3& world, std::size_t most) {
  WorldSurfaces out;
  std::size_t primitives = 0;
  for (const unsigned sides : {24U, 16U, 8U}) {
    out = {};
    primitives = 0;
    for (const Obstacle3& obstacle : world.obstacles()) {
      out.obstacles.push_back(surface_of(obstacle.solid, sides));
      const std::size_t count = out.obstacles.back().triangles.size();
      out.triangles += count;
      if (const PointCloud* cloud = cloud_of(obstacle.solid)) {
        out.points += cloud->points().size();
        out.shown_points += std::min(cloud->points().size(), drawn_points(sides));
      }
      if (!is_mesh(obstacle.solid)) primitives += count;
    }
    if (primitives <= most) break;
  }
  if (out.triangles <= most || primitives == out.triangles) return out;
  constexpr double finest = 1.0 / 512.0;  // of the world's diagonal
  constexpr double growth = 1.25;
  const double diagonal = norm(world.bounds().hi - world.bounds().lo);
  // Primitives count in full, but leave room for the meshes.
  const std::size_t room = std::max(most / 2, most - std::min(most, primitives));
  for (double cell = finest * diagonal; cell < diagonal; cell *= growth) {
    std::vector<Surface> coarse;
    std::size_t count = 0;
    for (std::size_t i = 0; i < out.obstacles.size(); ++i) {
      if (!is_mesh(world.obstacles()[i].solid)) {
        coarse.emplace_back();
        continue;
      }
      coarse.push_back(clustered(out.obstacles[i], cell));
      count += coarse.back().triangles.size();
    }
    if (count > room) continue;
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      if (is_mesh(world.obstacles()[i].solid)) out.obstacles[i] = std::move(coarse[i]);
    }
    out.cell = cell;
    break;
  }
  return out;
}

std::vector<Surface> placed(const Robot3& robot, View q, std::size_t most) {
  constexpr double finest = 1.0 / 64.0;  // of the robot's radius
  constexpr double growth = 1.3;
  std::vector<Surface> out;
  for (const Robot3::Member& member : robot.members()) {
    for (Surface& surface : placed(*member.robot, member.own(q), most)) out.push_back(std::move(surface));
  }
  if (!out.empty()) return out;
  const Pose3 pose = robot.pose(q);
  for (const Solid& solid : robot.solids()) {
    const Surface whole = surface_of(solid);
    Surface surface = whole;
    for (double cell = finest * robot.bounding_radius();
         surface.triangles.size() > most && is_mesh(solid) && cell < robot.bounding_radius(); cell *= growth) {
      surface = clustered(whole, cell);
    }
    out.push_back(moved(surface, pose));
  }
  return out;
}

Surface surface_of(const SphereModel& model, std::size_t body) {
  constexpr unsigned sides = 8;
  Surface out;
  if (model.covers_shapes()) {
    constexpr unsigned more = 16;
    for (const Solid& solid : model.robot().bodies()[body].solids) {
      append(out, surface_of(solid, is_sphere(solid) ? sides : more));
    }
    return out;
  }
  const auto& balls = model.bodies()[body];
  for (std::size_t i = 1; i < balls.size(); ++i) {
    append(out, surface_of(Solid{Sphere{balls[i].radius}, {balls[i].centre, {}}}, sides));
  }
  return out;
}

std::vector<Surface> placed(const SphereModel& model, View q) {
  std::vector<Pose3> poses;
  model.robot().poses(q, poses);
  std::vector<Surface> out;
  for (std::size_t b = 0; b < poses.size(); ++b) {
    if (!model.bodies()[b].empty()) out.push_back(moved(surface_of(model, b), model.base() * poses[b]));
  }
  return out;
}

std::vector<Surface> placed(const Scene& scene, View q, std::size_t most) {
  if (const ManipulatorScene* manipulator = scene.manipulator()) return placed(manipulator->robot, q);
  return placed(spatial(scene).robot, q, most);
}

/// The position of the reference point, or of the tip; of a team of bodies that of the first one.
Point3 position_of(const Scene& scene, View q) {
  if (const ManipulatorScene* manipulator = scene.manipulator()) return drawn(manipulator->robot.tip_at(q));
  const Robot3& robot = spatial(scene).robot;
  if (robot.members().empty()) return drawn(robot.pose(q).position);
  const Robot3::Member& first = robot.members().front();
  return drawn(first.robot->pose(first.own(q)).position);
}

View own_coordinates(const LevelRecord& record, View q) {
  const std::vector<Axis> axes = record.space.coordinates();
  const auto own =
      std::find_if(axes.begin(), axes.end(), [](const Axis& axis) { return !axis.name.starts_with("along"); });
  const auto first = static_cast<std::size_t>(own - axes.begin());
  return axes.size() - first >= record.scene->robot_dimension() ? q.subspan(first) : q;
}

bool has_positions(const LevelRecord& record) {
  if (record.scene == nullptr || spatial_world(*record.scene) == nullptr) return false;
  if (record.position_axes.size() == 3) return true;
  const bool whole = record.space.dimension() >= record.scene->robot_dimension();
  return whole && (record.scene->manipulator() != nullptr || record.scene->members().size() > 1);
}

Point3 position_in(const LevelRecord& record, View q) {
  if (record.position_axes.size() != 3) return position_of(*record.scene, own_coordinates(record, q));
  return {q[record.position_axes[0]], q[record.position_axes[1]], q[record.position_axes[2]]};
}

std::vector<Point3> positions_in(const LevelRecord& record, View q) {
  if (record.position_axes.size() == 3) return {position_in(record, q)};
  q = own_coordinates(record, q);
  if (const SpatialScene* scene = record.scene->spatial()) {
    std::vector<Point3> positions;
    for (const Robot3::Member& member : scene->robot.members()) {
      positions.push_back(drawn(member.robot->pose(member.own(q)).position));
    }
    return positions;
  }
  const SphereModel& robot = record.scene->manipulator()->robot;
  std::vector<Point3> tips;
  for (const PointOnBody& tip : robot.tips()) tips.push_back(drawn(robot.position(tip, q)));
  return tips;
}

}  // namespace trellis
