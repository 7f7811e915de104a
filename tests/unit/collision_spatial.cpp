// SPDX-License-Identifier: GPL-3.0-or-later
// Collisions in space: the filter before FCL changes no answer and no count, and FCL's answers are right.
//
// TRELLIS_POSES sets the number of poses in each of the real scenes (default 2000).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "unit/scene_spatial.hpp"
#include "unit/scene_spatial_worlds.hpp"

#include <trellis/collision/checker.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/spatial/distance_field.hpp>
#include <trellis/scene/spatial/scene.hpp>

using namespace trellis;
using namespace trellis::spatial_tests;

namespace {

struct Pair {
  explicit Pair(const std::shared_ptr<const Scene>& of, double resolution, double weight = 1.0)
      : scene(of),
        space(of->default_space(weight)),
        plain(make_spatial_checker(of, space, resolution, false)),
        filtered(make_spatial_checker(of, space, resolution, true)) {}

  std::shared_ptr<const Scene> scene;
  Space space;
  std::unique_ptr<Checker> plain, filtered;

  [[nodiscard]] Configuration sample(Stream& stream) const {
    Configuration q(space.dimension());
    space.sample_uniform(stream, q);
    return q;
  }
  [[nodiscard]] bool agree(View q) const { return plain->valid(q) == filtered->valid(q); }
  [[nodiscard]] bool agree(View a, View b) const {
    const MotionReport first = plain->motion(a, b), second = filtered->motion(a, b);
    return first.valid == second.valid && first.checks == second.checks &&
           (first.valid || first.invalid_at == second.invalid_at);
  }
};

std::shared_ptr<const Scene> random_scene(Stream& stream, int round) {
  const auto contain = static_cast<Contain>(round % 3);
  World3 world = random_world(stream, 1 + static_cast<std::size_t>(round) % 5, round % 4 == 0, contain);
  std::vector<Solid> solids;
  const int parts = 1 + round % 2;
  const double size = round % 5 == 0 ? 4.0 : 1.0;
  for (int i = 0; i < parts; ++i) {
    Shape3 shape = random_shape(stream, size);
    solids.push_back({std::move(shape), random_pose(stream, 0.5)});
  }
  return std::make_shared<SpatialScene>(std::move(world), Robot3("body", std::move(solids)));
}

/// Halves the motion between a valid and an invalid configuration: a pair of poses closer to contact each time.
template <class Visit>
void bisect(const Pair& pair, Configuration valid, Configuration invalid, int steps, const Visit& visit) {
  Configuration middle(valid.size());
  for (int i = 0; i < steps; ++i) {
    pair.space.interpolate(valid, invalid, 0.5, middle);
    visit(middle);
    (pair.plain->valid(middle) ? valid : invalid) = middle;
  }
}

/// The disagreements of poses: uniform ones, and as many again on the path to contact.
std::size_t differences(const Pair& pair, std::size_t poses, Stream& stream) {
  std::size_t found = 0;
  Configuration valid, invalid;
  for (std::size_t i = 0; i < poses; ++i) {
    Configuration q = pair.sample(stream);
    if (!pair.agree(q)) ++found;
    (pair.plain->valid(q) ? valid : invalid) = std::move(q);
    constexpr int steps = 40;
    if (i % steps != 0 || valid.empty() || invalid.empty()) continue;
    bisect(pair, valid, invalid, steps, [&](View near) {
      if (!pair.agree(near)) ++found;
    });
  }
  return found;
}

std::size_t differences_of_motions(const Pair& pair, std::size_t motions, double length, Stream& stream) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < motions; ++i) {
    Configuration a = pair.sample(stream), b = pair.sample(stream);
    // Motions of planners begin at valid configurations.
    for (int tries = 0; tries < 20 && !pair.plain->valid(a); ++tries) a = pair.sample(stream);
    const double whole = pair.space.distance(a, b);
    Configuration end(b.size());
    pair.space.interpolate(a, b, i % 8 == 0 ? 1.0 : std::min(1.0, length / whole), end);
    if (!pair.agree(a, end)) ++found;
  }
  return found;
}

std::size_t poses() {
  const char* set = std::getenv("TRELLIS_POSES");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  return set != nullptr ? std::strtoull(set, nullptr, 10) : 2000;
}

/// The same scene, where closed meshes are surfaces or solids.
std::shared_ptr<const Scene> with_surface(const SpatialScene& scene, bool surface) {
  const World3& w = scene.world;
  return std::make_shared<SpatialScene>(World3(w.bounds(), w.obstacles(), w.contain(), surface), scene.robot);
}

void require_none(const std::shared_ptr<const Scene>& scene, double resolution, double weight,
                  const std::string& name) {
  for (const bool surface : {false, true}) {
    const Pair pair(with_surface(spatial(*scene), surface), resolution, weight);
    Stream stream(5, name, surface ? "surfaces" : "solids");
    INFO(name << ", surface " << surface);
    CHECK(differences(pair, poses(), stream) == 0);
    CHECK(differences_of_motions(pair, poses() / 20, 20.0 * resolution, stream) == 0);
  }
}

}  // namespace

TEST_CASE("the filter before FCL changes no answer about a pose") {
  Stream stream(1, "spatial", "poses");
  for (int round = 0; round < 120; ++round) {
    const Pair pair(random_scene(stream, round), 0.05);
    INFO(round);
    CHECK(differences(pair, 400, stream) == 0);
  }
}

TEST_CASE("worlds of micrometres and of hundreds of kilometres have the same answers with and without the filter") {
  for (const double factor : {1e-9, 1e-6, 1e-3, 1e3, 1e5}) {
    Stream stream(6, "spatial", "scales");
    for (int round = 0; round < 40; ++round) {
      const auto scene = random_scene(stream, round);
      const World3& world = spatial(*scene).world;
      std::vector<Obstacle3> obstacles;
      for (const Obstacle3& obstacle : world.obstacles()) {
        obstacles.push_back({obstacle.name, scaled(obstacle.solid, factor)});
      }
      std::vector<Solid> solids;
      for (const Solid& solid : spatial(*scene).robot.solids()) solids.push_back(scaled(solid, factor));
      const Box3 box{factor * world.bounds().lo, factor * world.bounds().hi};
      const Pair pair(std::make_shared<SpatialScene>(World3(box, obstacles, world.contain(), world.surface()),
                                                     Robot3("body", solids)),
                      0.05 * factor, factor);
      INFO(factor << ", " << round);
      CHECK(differences(pair, 400, stream) == 0);
      CHECK(differences_of_motions(pair, 30, factor, stream) == 0);
    }
  }
}

TEST_CASE("bodies of micrometres in a room have the same answers with and without the filter") {
  for (const double factor : {1e-12, 1e-6, 1e-4}) {
    Stream stream(7, "spatial", "small bodies");
    for (int round = 0; round < 40; ++round) {
      const auto scene = random_scene(stream, round);
      std::vector<Solid> solids;
      for (const Solid& solid : spatial(*scene).robot.solids()) solids.push_back(scaled(solid, factor));
      const Pair pair(std::make_shared<SpatialScene>(spatial(*scene).world, Robot3("body", solids)), 0.05, factor);
      INFO(factor << ", " << round);
      CHECK(differences(pair, 200, stream) == 0);
    }
  }
}

TEST_CASE("the filter before FCL changes no answer about a motion, and no count") {
  Stream stream(2, "spatial", "motions");
  for (int round = 0; round < 120; ++round) {
    const Pair pair(random_scene(stream, round), 0.05);
    INFO(round);
    CHECK(differences_of_motions(pair, 60, 1.0, stream) == 0);
  }
}

TEST_CASE("a ball is valid where the obstacles are farther than its radius") {
  Stream stream(3, "spatial", "balls");
  for (int round = 0; round < 60; ++round) {
    const World3 world = random_world(stream, 1 + static_cast<std::size_t>(round) % 5, round % 4 == 0, Contain::none);
    const double radius = round % 3 == 0 ? 0.0 : stream.uniform(0.05, 1.0);
    const auto distance = world.distances()->distance();
    const Pair pair(std::make_shared<SpatialScene>(world, Robot3("ball", {Solid{Sphere{radius}, {}}}, false)), 0.05);
    for (int i = 0; i < 300; ++i) {
      const Configuration q = pair.sample(stream);
      const double gap = (*distance)({q[0], q[1], q[2]}) - radius;
      // A point on a surface is a matter of rounding.
      if (std::abs(gap) < 1e-6) continue;
      INFO(round << ": " << q[0] << " " << q[1] << " " << q[2] << ", gap " << gap);
      CHECK(pair.plain->valid(q) == (gap > 0.0));
      CHECK(pair.filtered->valid(q) == (gap > 0.0));
    }
  }
}

TEST_CASE("solids that rest on a slab touch it, whatever their shape") {
  const World3 world({{-5, -5, -5}, {5, 5, 5}}, {{"slab", {Cuboid{{4, 4, 1}}, {{0, 0, -0.5}, {}}}}}, Contain::none);
  for (const Shape3& shape : {Shape3(Cuboid{{0.2, 0.2, 0.1}}), Shape3(Cylinder{0.2, 0.1}), Shape3(Sphere{0.05})}) {
    const auto scene = std::make_shared<const SpatialScene>(world, Robot3("body", {Solid{shape, {}}}, false));
    const Space space = scene->default_space(1.0);
    for (const std::string& backend : collision_backends(*scene)) {
      const auto checker = make_checker(backend, scene, space, 0.05);
      for (const double x : {0.0, 0.37, 1.1}) {
        CHECK_FALSE(checker->valid(Configuration{x, 0.2, 0.05}));
        CHECK(checker->valid(Configuration{x, 0.2, 0.05 + 1e-9}));
      }
    }
  }
}

TEST_CASE("the nearest obstacle in space has the distance of the clearance, and its nearest point") {
  Stream stream(11, "", "nearest obstacle");
  int free = 0, points = 0;
  for (int round = 0; round < 60; ++round) {
    const auto scene = random_scene(stream, round);
    const SpatialScene& in_space = spatial(*scene);
    const Pair pair(scene, 0.1);
    const std::vector<Obstacle3>& obstacles = in_space.world.obstacles();
    for (int i = 0; i < 50; ++i) {
      INFO(round << " " << i);
      const Configuration q = pair.sample(stream);
      const auto nearest = pair.plain->nearest_obstacle(q);
      REQUIRE(nearest);
      const auto filtered = pair.filtered->nearest_obstacle(q);
      REQUIRE(filtered);
      CHECK(filtered->obstacle == nearest->obstacle);
      CHECK(filtered->distance == nearest->distance);
      const auto contact = pair.plain->contact(q);
      if (contact && contact->obstacle) {
        CHECK(nearest->distance == 0.0);
        CHECK(nearest->obstacle == *contact->obstacle);
        CHECK_FALSE(nearest->point);
        continue;
      }
      // Where the boundary is farther away.
      if (pair.plain->valid(q)) CHECK(nearest->distance >= pair.plain->clearance(q) - 1e-9);
      ++free;
      if (!nearest->point) continue;
      ++points;
      const double tolerance = 2e-4 * nearest->distance + 2e-5;
      CHECK(distance_to(obstacles.at(nearest->obstacle).solid, *nearest->point) <= tolerance);
      double from_robot = std::numeric_limits<double>::infinity();
      const Pose3 pose = in_space.robot.pose(q);
      for (const Solid& solid : in_space.robot.solids()) {
        from_robot = std::min(from_robot, distance_to({solid.shape, pose * solid.pose}, *nearest->point));
      }
      CHECK(std::abs(from_robot - nearest->distance) <= tolerance);
    }
  }
  CHECK(free > 500);
  // FCL does not give it for every pair.
  CHECK(points > 0.6 * free);
}

TEST_CASE("the nearest obstacle of a point in space is exact") {
  const auto ball = std::make_shared<SpatialScene>(
      World3({{0, 0, 0}, {10, 10, 10}},
             {{"ball", {Sphere{1.0}, {{5, 5, 5}, {}}}}, {"box", {Cuboid{{2, 2, 2}}, {{8, 8, 8}, {}}}}}),
      Robot3::point());
  const auto checker = make_spatial_checker(ball, ball->default_space(1.0), 0.1);
  const auto nearest = checker->nearest_obstacle(Configuration{2, 5, 5});
  REQUIRE(nearest);
  CHECK(nearest->obstacle == 0);
  CHECK(nearest->distance == Approx(2.0).margin(1e-6));
  REQUIRE(nearest->point);
  CHECK(norm(*nearest->point - Vec3{4, 5, 5}) < 1e-5);
  CHECK(checker->nearest_obstacle(Configuration{8, 8, 9.5})->obstacle == 1);
  CHECK(checker->nearest_obstacle(Configuration{8, 8, 8})->distance == 0.0);
}

TEST_CASE("a robot with a point inside an obstacle is in collision") {
  Stream stream(4, "spatial", "points");
  for (int round = 0; round < 120; ++round) {
    const auto scene = random_scene(stream, round);
    const World3& world = spatial(*scene).world;
    const Robot3& robot = spatial(*scene).robot;
    // Two surfaces may lie inside each other.
    if (world.surface()) continue;
    const Pair pair(scene, 0.05);
    const auto of_world = world.distances()->distance();
    const ObstacleDistance of_robot(robot.solids(), false);
    for (int i = 0; i < 100; ++i) {
      const Configuration q = pair.sample(stream);
      const Pose3 pose = robot.pose(q);
      bool meets = false;
      for (int k = 0; k < 50 && !meets; ++k) {
        const Vec3 p = random_point(stream, robot.bounding_radius());
        meets = of_robot(p) < -1e-6 && (*of_world)(pose(p)) < -1e-6;
      }
      if (!meets) continue;
      INFO(round << ": " << q[0] << " " << q[1] << " " << q[2]);
      CHECK(!pair.plain->valid(q));
      CHECK(!pair.filtered->valid(q));
      REQUIRE(pair.filtered->contact(q));
    }
  }
}

TEST_CASE("a closed mesh with a part inside a body is in collision, whichever part it is") {
  const auto two = shared(apart({0.2, 0.2, 0.2}));
  const Robot3 room("room", {Solid{shared(box({-1, -1, -1}, {1, 1, 1})), {}}});
  for (const double side : {-1.1, 1.1}) {
    // The obstacle's one part is inside the robot, the other far outside; then the roles change.
    const World3 world(bounds, {{"two", {two, {}}}}, Contain::none);
    const Pair pair(std::make_shared<SpatialScene>(world, room), 0.05);
    CHECK(!pair.plain->valid(Configuration{side, 0, 0, 0, 0, 0, 1}));
    CHECK(!pair.filtered->valid(Configuration{side, 0, 0, 0, 0, 0, 1}));
    const World3 inverse(bounds, {{"room", room.solids().front()}}, Contain::none);
    const Pair other(std::make_shared<SpatialScene>(inverse, Robot3("two", {Solid{two, {}}})), 0.05);
    CHECK(!other.plain->valid(Configuration{side, 0, 0, 0, 0, 0, 1}));
    CHECK(!other.filtered->valid(Configuration{side, 0, 0, 0, 0, 0, 1}));
  }
}

TEST_CASE("the filter changes no answer in the hook's environment", "[poses]") {
  const auto path = test::scene("open_ppl/hook/hook.env");
  if (path.empty()) return;
  require_none(read_problems(path.string(), {}).front().scene, 1.0, 40.0, "hook");
}

TEST_CASE("the filter changes no answer in the maze of the Robotics Library", "[poses]") {
  const auto path = test::scene("rl/rlplan/box-6d-300505_maze_rrtConCon.mdl.sixDof.xml");
  const auto mesh = test::scene("rl/obj/maze.obj");
  if (path.empty() || mesh.empty()) return;
  const Problem problem = read_problems(path.string(), {}).front();
  require_none(problem.scene, 0.05, 1.5, "maze of boxes");
  const SpatialScene& scene = spatial(*problem.scene);
  const World3 world = scene.world.with({{"maze", {read_mesh(mesh.string()).mesh, {}}}});
  require_none(std::make_shared<SpatialScene>(world, scene.robot), 0.05, 1.5, "maze as a mesh");
}

TEST_CASE("the filter changes no answer among the large meshes of FCL's tests", "[poses]") {
  const auto environment = test::scene("fcl/env.obj");
  const auto robot = test::scene("fcl/rob.obj");
  if (environment.empty() || robot.empty()) return;
  const auto mesh = read_mesh(environment.string()).mesh;
  const World3 world(mesh->bounds(), {{"environment", {mesh, {}}}}, Contain::reference);
  const auto body = read_mesh(robot.string()).mesh;
  require_none(std::make_shared<SpatialScene>(world, Robot3("robot", {Solid{body, {}}})), 20.0, 500.0, "fcl");
}
