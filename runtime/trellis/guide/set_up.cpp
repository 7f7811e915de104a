// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/set_up.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// Work of a set-up, in validity checks: a constant and a rate per obstacle.
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

/// Measured by `bench_work` (scripts/bench-work): CPU times in the worlds of scripts/pays, divided by those of a check,
/// 0.07 us in the plane and 0.3 us in space. The measured figures are within a factor of about 2 of these.
constexpr std::array<Entry, 25> entries = {{
    {"uniform", {{}, {4}}, {{}, {4}}},
    {"goal_bias", {{}, {4}}, {{}, {4}}},
    {"gaussian", {{}, {4}}, {{}, {4}}},
    {"bridge_test", {{}, {4}}, {{}, {4}}},
    {"obstacle_based", {{}, {4}}, {{}, {4}}},
    {"medial_axis", {{}, {4}}, {{}, {4}}},
    {"halton", {{}, {4}}, {{}, {4}}},
    {"informed", {{}, {4}}, {{}, {4}}},
    {"identity", {{}, {30}}, {{}, {30}}},
    {"workspace", {{}, {20000, 5}}, {{10000}, {15000}}},
    {"skeleton", {{5000, 3500}, {150, 3}}, {{400000, 2000}, {600, 60}}},
    {"shrink", {{}, {90, 0.5}}, {{}, {120, 1}}},
    {"joints", {{}, {110, 0.5}}, {{}, {60}}},
    {"pca", {{}, {350, 4}}, {{}, {150}}},
    {"widen", {{}, {80, 4}}, {{}, {150, 4}}},
    {"lazy", {{}, {80}}, {{}, {30}}},
    {"drop", {{}, {90, 2}}, {{}, {100, 2}}},
    {"aggregate", {{300, 450}, {100, 1}}, {{300, 200}, {100, 1}}},
    {"holonomic", {{}, {50}}, {{}, {50}}},
    {"decomposition", {{7000, 130}, {4000, 8}}, {{20000, 100}, {8000}}},
    {"state_cells", {{}, {10}}, {{}, {10}}},
    {"information_gain", {{}, {10}}, {{}, {10}}},
    {"path_database", {{}, {100}}, {{}, {100}}},
    {"experience", {{}, {100}}, {{}, {100}}},
    {"learned", {{}, {100}}, {{}, {100}}},
}};

}  // namespace

SetUp set_up_of(std::string_view guide, const Scene& scene) {
  const auto* const entry =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.guide == guide; });
  if (entry == entries.end()) throw Fault(fmt::format("the work of setting up '{}' was not measured", guide));
  const auto obstacles = static_cast<double>(scene.obstacle_count());
  const Rates& rates = scene.spatial() != nullptr ? entry->spatial : entry->planar;
  return {rates.world.of(obstacles), rates.run.of(obstacles)};
}

SetUp set_up_of_custom() { return {0.0, 100.0}; }

}  // namespace trellis
