// SPDX-License-Identifier: GPL-3.0-or-later
// The oracle's paths on grids have the lengths that the Moving AI Lab publishes for its queries.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include <trellis/memory/grid.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace trellis;

TEST_CASE("every query of Moving AI has the published length: octile, no corner cut", "[memory][scenes][slow]") {
  const std::filesystem::path folder = test::scene("bench_mr/moving_ai");
  if (folder.empty()) return;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".scen") continue;
    ++files;
    const SceneFile file = read_scene(entry.path().string(), {});
    REQUIRE(file.lengths.size() == file.problems.size());
    const World& world = planar(*file.problems.front().scene).world;
    const Vec2 size = world.bounds().hi - world.bounds().lo;
    const WorldGrid grid(world, world.bounds(), static_cast<std::size_t>(std::max(size.x, size.y)));
    REQUIRE(grid.width() == 1.0);
    REQUIRE(grid.height() == 1.0);
    std::size_t matched = 0;
    for (std::size_t i = 0; i < file.problems.size(); ++i) {
      const Problem& problem = file.problems[i];
      const std::size_t goal = grid.at({problem.goal()[0], problem.goal()[1]});
      const double length = path_lengths_to(grid, goal)[grid.at({problem.start[0], problem.start[1]})];
      // Published with eight decimals.
      constexpr double rounding = 1e-6;
      const bool same = std::abs(length - file.lengths[i]) <= rounding;
      if (!same) UNSCOPED_INFO(problem.name << ": " << length << ", published " << file.lengths[i]);
      matched += same ? 1 : 0;
    }
    std::printf("%s: %zu of %zu lengths matched\n", entry.path().filename().c_str(), matched, file.problems.size());
    CHECK(matched == file.problems.size());
  }
  CHECK(files >= 2);
}
