// SPDX-License-Identifier: GPL-3.0-or-later
// Our RRT-Connect for rigid bodies among meshes: what scripts/bench-ompl --se3 puts beside OMPL's.
//
//   bench_se3 export SCENE FOLDER FILE   writes a problem for both sides; SCENE is hook or maze, FOLDER has the scenes
//   bench_se3 FILE CHECKER SEEDS         CHECKER: fcl, fcl_plain; fcl_kept keeps the world's distance field between
//   runs

#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

#include "se3_bench.hpp"

namespace {

using trellis::Vec3;

bench::Triangles triangles_of_box(const Vec3& half) {
  bench::Triangles mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        {(i & 1U) != 0 ? half.x : -half.x, (i & 2U) != 0 ? half.y : -half.y, (i & 4U) != 0 ? half.z : -half.z});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Appends a solid's triangles, at its pose.
void append(bench::Triangles& all, const trellis::Solid& solid) {
  bench::Triangles own;
  if (const auto* mesh = std::get_if<std::shared_ptr<const trellis::Mesh>>(&solid.shape)) {
    for (const Vec3& v : (*mesh)->vertices()) own.vertices.push_back({v.x, v.y, v.z});
    own.triangles = (*mesh)->triangles();
  } else if (const auto* box = std::get_if<trellis::Cuboid>(&solid.shape)) {
    own = triangles_of_box(0.5 * box->size);
  } else {
    throw std::runtime_error("the scene has a shape that is neither a mesh nor a box");
  }
  const auto offset = static_cast<std::uint32_t>(all.vertices.size());
  for (const auto& v : own.vertices) {
    const Vec3 p = solid.pose({v[0], v[1], v[2]});
    all.vertices.push_back({p.x, p.y, p.z});
  }
  for (const auto& t : own.triangles) all.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

void write_problem(const std::string& name, const std::string& folder, const std::string& file) {
  const bool hook = name == "hook";
  if (!hook && name != "maze") throw std::invalid_argument("no scene " + name);
  const std::string path =
      folder + (hook ? "/open_ppl/hook/hook.env" : "/rl/rlplan/box-6d-300505_maze_rrtConCon.mdl.sixDof.xml");
  const trellis::Problem problem = trellis::read_problems(path, {}).front();
  const trellis::SpatialScene& scene = spatial(*problem.scene);
  bench::Body body;
  body.name = name;
  const auto& [lo, hi] = scene.world.bounds();
  body.bounds = {lo.x, lo.y, lo.z, hi.x, hi.y, hi.z};
  body.whole = scene.world.contain() == trellis::Contain::robot;
  body.radius = scene.robot.bounding_radius();
  // As the examples of these scenes have them.
  body.weight = hook ? 40.0 : body.radius;
  body.resolution = hook ? 1.0 : 0.05;
  body.step = hook ? 20.0 : 1.0;
  for (std::size_t j = 0; j < 7; ++j) {
    body.start[j] = problem.start[j];
    body.goal[j] = problem.goal()[j];
  }
  for (const trellis::Solid& solid : scene.robot.solids()) append(body.robot, solid);
  if (hook) {
    for (const trellis::Obstacle3& obstacle : scene.world.obstacles()) append(body.obstacles, obstacle.solid);
  } else {
    append(body.obstacles, {trellis::read_mesh(folder + "/rl/obj/maze.obj").mesh, {}});
  }
  bench::write(file, body);
}

std::shared_ptr<const trellis::Mesh> mesh_of(const bench::Triangles& of, const std::string& what) {
  std::vector<Vec3> vertices;
  vertices.reserve(of.vertices.size());
  for (const auto& v : of.vertices) vertices.push_back({v[0], v[1], v[2]});
  return std::make_shared<const trellis::Mesh>(std::move(vertices), of.triangles, what);
}

trellis::Problem problem_of(const bench::Body& body, const std::string& collision) {
  const auto& b = body.bounds;
  trellis::World3 world({{b[0], b[1], b[2]}, {b[3], b[4], b[5]}},
                        {{"obstacles", {mesh_of(body.obstacles, "obstacles"), {}}}},
                        body.whole ? trellis::Contain::robot : trellis::Contain::reference, true);
  trellis::Problem problem;
  problem.name = body.name;
  problem.scene = std::make_shared<trellis::SpatialScene>(
      std::move(world), trellis::Robot3("robot", {trellis::Solid{mesh_of(body.robot, "robot"), {}}}));
  problem.space = problem.scene->default_space(body.weight);
  problem.start.assign(body.start.begin(), body.start.end());
  problem.goals.emplace_back(body.goal.begin(), body.goal.end());
  problem.resolution = body.resolution;
  problem.collision = collision;
  return problem;
}

bench::Run plan(const trellis::StrategySpec& strategy, const trellis::Problem& of, std::uint64_t seed) {
  const double before = bench::cpu_seconds();
  const trellis::RunRecord record = trellis::execute(strategy, of, seed);
  const double after = bench::cpu_seconds();
  const trellis::LevelRecord& root = record.levels.front();
  return {.solved = record.solved,
          .cpu = after - before,
          .planning = root.search.seconds,
          .iterations = root.search.proposals.size(),
          .checks = record.validity_checks,
          .nodes = root.search.nodes.size()};
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 5 && std::strcmp(argv[1], "export") == 0) {
      write_problem(argv[2], argv[3], argv[4]);
      return 0;
    }
    const bench::BodyArguments arguments = bench::parse_body(argc, argv);
    const bench::Body body = bench::read(arguments.file);
    const trellis::StrategySpec strategy(trellis::PlannerSpec::make(
        "rrt_connect", {{"step", body.step}, {"proposals", static_cast<double>(bench::iteration_limit)}}));
    const std::string collision = arguments.checker == "fcl_plain" ? "fcl_plain" : "fcl";
    const trellis::Problem kept = problem_of(body, collision);
    bench::measure(arguments, "trellis", body.name, [&](std::uint64_t seed) {
      // A new world has a distance field without values, which the run then computes.
      return plan(strategy, arguments.checker == "fcl_kept" ? kept : problem_of(body, collision), seed);
    });
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_se3: %s\n", error.what());
    return 1;
  }
  return 0;
}
