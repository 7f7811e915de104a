// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/erosion.hpp>
#include <trellis/scene/spatial/obstacle_distance.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/robot.hpp>
#include <trellis/scene/spatial/world.hpp>

#include "support/catch.hpp"

using namespace trellis;
using Catch::Matchers::Contains;
using Catch::Matchers::WithinAbs;

namespace {

std::vector<Vec3> random_points(Stream& stream, std::size_t count) {
  std::vector<Vec3> points;
  // Crowded in places, as scans are.
  for (std::size_t i = 0; i < count; ++i) {
    const double size = i % 3 == 0 ? 1.0 : 0.1;
    points.push_back({size * stream.uniform(-1.0, 1.0), size * stream.uniform(-1.0, 1.0), stream.uniform(0.0, 0.3)});
  }
  return points;
}

double nearest_by_hand(const std::vector<Vec3>& points, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& q : points) least = std::min(least, norm(q - p));
  return least;
}

}  // namespace

TEST_CASE("a cloud refuses what is no point and no radius, and leaves repeated points out", "[scene]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(PointCloud({}, 0.1, "scan"), Contains("scan: it has no points"));
  CHECK_THROWS_WITH(PointCloud({{0, 0, 0}}, 0.0, "scan"), Contains("scan: the radius of its points must be greater"));
  CHECK_THROWS_WITH(PointCloud({{0, 0, 0}}, -1.0, "scan"), Contains("got -1"));
  CHECK_THROWS_WITH(PointCloud({{0, 0, 0}}, nan, "scan"), Contains("got nan"));
  CHECK_THROWS_WITH(PointCloud({{0, 0, 0}, {0, nan, 0}}, 0.1, "scan"), Contains("scan: point 2 must lie within"));
  CHECK(PointCloud({{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}}, 0.1, "scan").points() ==
        std::vector<Vec3>{{1, 0, 0}, {0, 0, 0}});
  const auto cloud = std::make_shared<const PointCloud>(std::vector<Vec3>{{0, 0, 0}}, 0.1, "scan");
  CHECK_THROWS_WITH(Robot3("body", {{cloud, {}}}, true), Contains("a cloud of points can be an obstacle"));
}

TEST_CASE("the nearest point of a cloud is that of a search through all", "[scene]") {
  Stream stream(1, "0", "clouds");
  for (const std::size_t count : {1U, 2U, 7U, 500U}) {
    const PointCloud cloud(random_points(stream, count), 0.01, "scan");
    for (int i = 0; i < 200; ++i) {
      const Vec3 p{stream.uniform(-2, 2), stream.uniform(-2, 2), stream.uniform(-1, 1)};
      const double least = nearest_by_hand(cloud.points(), p);
      const auto found = cloud.nearest(p);
      REQUIRE(found.distance == least);
      REQUIRE(norm(cloud.points()[found.index] - p) == least);
      REQUIRE(cloud.nearest(p, 0.5 * least).distance == 0.5 * least);
      const Box3 box{p - Vec3{0.3, 0.2, 0.1}, p + Vec3{0.1, 0.2, 0.3}};
      std::vector<bool> seen(cloud.points().size());
      cloud.each_near(box, [&](std::size_t at) { return seen[at] = true; });
      for (std::size_t at = 0; at < seen.size(); ++at) {
        const Vec3& q = cloud.points()[at];
        const bool inside = q.x >= box.lo.x && q.x <= box.hi.x && q.y >= box.lo.y && q.y <= box.hi.y &&
                            q.z >= box.lo.z && q.z <= box.hi.z;
        if (inside) REQUIRE(seen[at]);
      }
    }
  }
}

TEST_CASE("the balls of a thinned cloud contain those of the cloud, and are no larger than the law says", "[scene]") {
  Stream stream(2, "0", "clouds");
  const PointCloud cloud(random_points(stream, 3000), 0.01, "scan");
  std::size_t before = cloud.points().size();
  for (const double spacing : {0.0, 1e-9, 0.01, 0.05, 0.3}) {
    const PointCloud thin = cloud.thinned(spacing);
    INFO("spacing " << spacing);
    CHECK(thin.points().size() <= before);
    before = thin.points().size();
    CHECK(thin.radius() >= cloud.radius());
    CHECK(thin.radius() <= (cloud.radius() + spacing) * (1.0 + 1e-9));
    for (const Vec3& p : thin.points()) REQUIRE(nearest_by_hand(cloud.points(), p) == 0.0);
    for (const Vec3& p : cloud.points()) {
      REQUIRE(nearest_by_hand(thin.points(), p) + cloud.radius() <= thin.radius());
    }
  }
  CHECK(before < 500);
}

TEST_CASE("the signed distance of a cloud is that of its balls", "[scene]") {
  Stream stream(3, "0", "clouds");
  const auto points = random_points(stream, 200);
  const auto cloud = std::make_shared<const PointCloud>(points, 0.05, "scan");
  const Pose3 pose{{0.3, -0.2, 0.1}, normalised(rotation_of({0.4, 0.2, -1.0}))};
  std::vector<Solid> balls;
  for (const Vec3& p : points) balls.push_back({Sphere{0.05}, {pose(p), {}}});
  const ObstacleDistance one({{cloud, pose}}, false), many(balls, false);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p{stream.uniform(-1.5, 1.5), stream.uniform(-1.5, 1.5), stream.uniform(-0.5, 0.7)};
    REQUIRE_THAT(one(p), WithinAbs(many(p), 1e-12));
    const NearestObstacle found = one.nearest(p);
    REQUIRE_THAT(norm(found.point - many.nearest(p).point), WithinAbs(0.0, 1e-9));
  }
  const Box3 box = bounding_box({cloud, pose});
  CHECK_THAT(norm(box.lo - many.bounds().lo), WithinAbs(0.0, 1e-12));
  CHECK_THAT(norm(box.hi - many.bounds().hi), WithinAbs(0.0, 1e-12));
}

TEST_CASE("a cloud is eroded by smaller balls, and vanishes by its radius", "[scene]") {
  const auto cloud = std::make_shared<const PointCloud>(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}}, 0.1, "scan");
  const World3 world({{-2, -2, -2}, {2, 2, 2}}, {{"scan", {cloud, {}}}});
  const World3 less = eroded(world, 0.04);
  REQUIRE(less.obstacles().size() == 1);
  const auto& rest = *std::get<std::shared_ptr<const PointCloud>>(less.obstacles()[0].solid.shape);
  CHECK_THAT(rest.radius(), WithinAbs(0.06, 1e-15));
  CHECK(rest.points() == cloud->points());
  CHECK(rest.hash() != cloud->hash());
  CHECK(eroded(world, 0.1).obstacles().empty());
}
