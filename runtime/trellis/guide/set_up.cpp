// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/set_up.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include <trellis/base/error.hpp>
#include <trellis/memory/library.hpp>

namespace trellis {

namespace {

/// Work of a set-up, in units of search_cost: a constant and a rate per obstacle.
struct Rate {
  double constant = 0.0;
  double per_obstacle = 0.0;

  [[nodiscard]] double of(double obstacles) const { return constant + per_obstacle * obstacles; }
};

struct Rates {
  Rate world, run;
};

struct Entry {
  std::string_view guide;
  Rates planar, spatial;
};

/// Measured by `scripts/bench-work`: CPU times in the worlds of scripts/pays, divided by those of a check, 0.07 us in
/// the plane and 0.3 us in space. Those of the mazes and of clutter are within a factor of 3 of these. The entries of
/// workspace and decomposition include the beginning of their first search, which prepares the whole graph; those of
/// team, decouple, prioritise and couple are those of eight discs without obstacles, by `bench_work` on
/// examples/many_robots.lua (5.2, 2.6, 2.3 and 2.4 us), and in space those of joints and of identity: for Baxter's arms
/// among 15 obstacles team takes 48 to 64 us and the others 2 to 6 us, where a check takes 1.0 to 1.3 us, so 30 is more
/// than they cost; that of learned, which needs a model, is the CPU time of its h, from a grid of 67 x 67 cells.
constexpr std::array<Entry, 30> entries = {{
    {"uniform", {{}, {10}}, {{}, {10}}},
    {"goal_bias", {{}, {10}}, {{}, {10}}},
    {"gaussian", {{}, {10}}, {{}, {10}}},
    {"bridge_test", {{}, {10}}, {{}, {10}}},
    {"obstacle_based", {{}, {10}}, {{}, {10}}},
    {"medial_axis", {{}, {10}}, {{}, {10}}},
    {"halton", {{}, {10}}, {{}, {10}}},
    {"informed", {{}, {10}}, {{}, {10}}},
    {"identity", {{}, {30}}, {{}, {30}}},
    {"workspace", {{}, {9000, 1}}, {{10000}, {15000}}},
    {"skeleton", {{5000, 3500}, {150, 3}}, {{400000, 2000}, {600, 60}}},
    {"shrink", {{}, {90, 0.5}}, {{}, {120, 1}}},
    {"joints", {{}, {110, 0.5}}, {{}, {60}}},
    {"pca", {{}, {350, 4}}, {{}, {150}}},
    {"widen", {{}, {80, 4}}, {{}, {150, 4}}},
    {"lazy", {{}, {80}}, {{}, {30}}},
    {"drop", {{}, {90, 2}}, {{}, {100, 2}}},
    {"aggregate", {{300, 450}, {100, 1}}, {{300, 200}, {100, 1}}},
    {"holonomic", {{}, {50}}, {{}, {50}}},
    {"blossom", {{}, {50}}, {{}, {50}}},
    {"decomposition", {{7000, 130}, {4000, 8}}, {{20000, 100}, {8000}}},
    {"state_cells", {{}, {10}}, {{}, {10}}},
    {"information_gain", {{}, {10}}, {{}, {10}}},
    {"path_database", {{}, {100}}, {{}, {100}}},
    {"experience", {{}, {100}}, {{}, {100}}},
    {"learned", {{}, {450000}}, {{}, {450000}}},
    {"team", {{}, {75, 0.5}}, {{}, {60}}},
    {"decouple", {{}, {40}}, {{}, {30}}},
    {"prioritise", {{}, {35}}, {{}, {30}}},
    {"couple", {{}, {35}}, {{}, {30}}},
}};

/// Work per stored path that a guide retrieves, in the same units; 0 for other guides.
double work_per_path(std::string_view guide) {
  if (guide == "experience") return 1500.0;
  return guide == "path_database" ? 1000.0 : 0.0;
}

/// The number of paths that the guide retrieves at most.
double retrieved(const Options& options) {
  const auto candidates = static_cast<double>(std::get<std::int64_t>(options.at("candidates")));
  try {
    const auto library = known_paths(std::get<std::string>(options.at("db")));
    return std::min(candidates, static_cast<double>(library->size()));
  } catch (const Error&) {
    return 0.0;  // the guide reports what is wrong with the file
  }
}

}  // namespace

SetUp set_up_of(std::string_view guide, const Options& options, const Scene& scene) {
  const auto* const entry =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.guide == guide; });
  if (entry == entries.end()) throw Fault(fmt::format("the work of setting up '{}' was not measured", guide));
  const auto obstacles = static_cast<double>(scene.obstacle_count());
  const Rates& rates = scene.world_dimension() == 3 ? entry->spatial : entry->planar;
  SetUp work{rates.world.of(obstacles), rates.run.of(obstacles)};
  if (const double each = work_per_path(guide); each > 0.0) work.run += each * retrieved(options);
  return work;
}

SetUp set_up_of_custom() { return {0.0, 100.0}; }

}  // namespace trellis
