// SPDX-License-Identifier: GPL-3.0-or-later
// Checks per second of the collision backends: a 0.6 x 0.2 rectangle among random rectangles in a 10 x 10 world.
// items_per_second counts configurations (states) or motions (edges); "valid" is the share of them that is.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/collision/planar/planar_checker.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace {

using namespace trellis;

constexpr double world_size = 10.0;
constexpr double resolution = 0.05;
constexpr double edge_length = 0.5;
constexpr std::size_t queries = 4096;

std::shared_ptr<const Scene> random_scene(std::size_t obstacles) {
  Stream stream(1, "bench", "scene");
  // The area of 20 obstacles stays constant, so that more obstacles are smaller.
  const double scale = std::sqrt(20.0 / static_cast<double>(obstacles));
  std::vector<Obstacle> boxes;
  for (std::size_t i = 0; i < obstacles; ++i) {
    const double width = scale * stream.uniform(0.3, 1.5);
    const double height = scale * stream.uniform(0.3, 1.5);
    const double x = stream.uniform(0.0, world_size - width);
    const double y = stream.uniform(0.0, world_size - height);
    boxes.push_back({"", Box2{{x, y}, {x + width, y + height}}});
  }
  const Box2 robot{{-0.3, -0.1}, {0.3, 0.1}};
  return std::make_shared<const PlanarScene>(World({{0.0, 0.0}, {world_size, world_size}}, std::move(boxes)),
                                             Robot::rigid({robot}));
}

struct Queries {
  Space space = Space::se2({0.0, world_size}, {0.0, world_size});
  Configurations from{3};
  Configurations to{3};

  Queries() {
    Stream stream(2, "bench", "queries");
    Configuration a(3);
    Configuration b(3);
    while (from.size() < queries) {
      space.sample_uniform(stream, a);
      // A direction of the metric, uniform on the sphere.
      double norm = 0.0;
      for (double& x : b) {
        x = stream.normal();
        norm += x * x;
      }
      for (std::size_t j = 0; j < 3; ++j) b[j] = a[j] + edge_length * b[j] / (std::sqrt(norm) * space.axes()[j].weight);
      space.normalise(b);
      if (!space.contains(b)) continue;
      from.push(a);
      to.push(b);
    }
  }
};

std::unique_ptr<Checker> make(const std::string& backend, std::size_t obstacles, const Space& space) {
  unsigned count = 0;
  const kernel::Table* const* tables = kernel::available(count);
  for (unsigned i = 0; i < count; ++i) {
    if (backend == tables[i]->name) {
      return make_planar_checker(random_scene(obstacles), space, resolution, *tables[i]);
    }
  }
  return make_checker(backend, random_scene(obstacles), space, resolution);
}

void states(benchmark::State& state, const std::string& backend) {
  const Queries q;
  const auto checker = make(backend, static_cast<std::size_t>(state.range(0)), q.space);
  std::size_t valid = 0;
  std::size_t i = 0;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    valid += checker->valid(q.from[i % queries]) ? 1U : 0U;
    ++i;
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["valid"] = static_cast<double>(valid) / static_cast<double>(i);
}

/// `from_valid`: only motions from a valid configuration, as a planner checks them.
void edges(benchmark::State& state, const std::string& backend, bool from_valid) {
  const Queries q;
  const auto checker = make(backend, static_cast<std::size_t>(state.range(0)), q.space);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < queries; ++i) {
    if (!from_valid || checker->valid(q.from[i])) rows.push_back(i);
  }
  std::size_t valid = 0;
  std::size_t checks = 0;
  std::size_t i = 0;
  std::size_t done = 0;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    const MotionReport report = checker->motion(q.from[rows[i]], q.to[rows[i]]);
    valid += report.valid ? 1U : 0U;
    checks += report.checks;
    if (++i == rows.size()) i = 0;
    ++done;
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["valid"] = static_cast<double>(valid) / static_cast<double>(done);
  state.counters["checks"] = static_cast<double>(checks) / static_cast<double>(done);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> backends = {"planar", "fcl"};
  unsigned count = 0;
  const trellis::kernel::Table* const* tables = trellis::kernel::available(count);
  for (unsigned i = 0; i < count; ++i) backends.emplace_back(tables[i]->name);
  for (const auto& backend : backends) {
    benchmark::RegisterBenchmark(("states/" + backend).c_str(), states, backend)->Arg(20)->Arg(200);
    benchmark::RegisterBenchmark(("edges/" + backend).c_str(), edges, backend, false)->Arg(20)->Arg(200);
    benchmark::RegisterBenchmark(("edges_from_valid/" + backend).c_str(), edges, backend, true)->Arg(20)->Arg(200);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
