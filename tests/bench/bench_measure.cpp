// SPDX-License-Identifier: GPL-3.0-or-later
// Seconds to score N samples with all default quantities, in the plane (d = 2), SE(2) (d = 3) and R^6: the headline of
// knn, D, mass, coverage, the profile along the path and JS. The target is built once, outside of the timed section, as
// for strategies that are scored on one path; "target" is the time to build it. Fitted: the growth with N.
#include <benchmark/benchmark.h>

#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/measure/efficiency.hpp>

namespace {

using namespace trellis;

Space space_of(std::int64_t d) {
  if (d == 3) return Space::se2({0, 10}, {0, 10});
  return Space::euclidean(std::vector<std::pair<double, double>>(static_cast<std::size_t>(d), {0.0, 10.0}));
}

/// A bent tube through C with an obstacle in it.
Target target_of(const Space& space) {
  Configurations path(space.dimension());
  for (Configuration point : {Configuration{1, 1, 0}, Configuration{4, 3, 2}, Configuration{7, 6, 5}}) {
    if (space.dimension() == 3) point[2] -= 4.0;  // an angle
    point.resize(space.dimension(), 5.0);
    path.push(point);
  }
  const auto valid = [](View x) { return !(x[0] > 3.5 && x[0] < 4.5 && x[1] > 3.1 && x[1] < 4.0); };
  return Target(space, path, {0, 1}, TubeSettings{}, valid, 7);
}

/// Three in four uniform, one in four about the middle of the path: as uneven as a tree.
Configurations samples_of(const Space& space, std::int64_t count) {
  Stream stream(1, "bench", "measure");
  Configurations rows(space.dimension());
  rows.reserve(static_cast<std::size_t>(count));
  Configuration x(space.dimension());
  for (std::int64_t i = 0; i < count; ++i) {
    space.sample_uniform(stream, x);
    if (stream.uniform() < 0.25) {
      x[0] = 4.0 + 0.5 * stream.normal();
      x[1] = 3.0 + 0.5 * stream.normal();
      space.reflect(x);
    }
    rows.push(x);
  }
  return rows;
}

void score(benchmark::State& state) {
  const Space space = space_of(state.range(0));
  const Target target = target_of(space);
  const Configurations rows = samples_of(space, state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(efficiency(target, rows));
  state.SetComplexityN(state.range(1));
}
BENCHMARK(score)->ArgNames({"d", "N"})->ArgsProduct({{2, 3, 6}, {1000, 10000, 100000}})->Unit(benchmark::kMillisecond);
BENCHMARK(score)
    ->Name("growth")
    ->ArgNames({"d", "N"})
    ->ArgsProduct({{3}, {15625, 31250, 62500, 125000, 250000, 500000, 1000000}})
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oNLogN);

void make_target(benchmark::State& state) {
  const Space space = space_of(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(target_of(space));
}
BENCHMARK(make_target)->Name("target")->ArgName("d")->Arg(2)->Arg(3)->Arg(6)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
