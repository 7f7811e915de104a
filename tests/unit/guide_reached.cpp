// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>

#include <trellis/guide/reached_nodes.hpp>

#include "support/catch.hpp"

using namespace trellis;

TEST_CASE("reached nodes are those reported since the last removal, whatever was asked between", "[guide][reached]") {
  for (const Space& space : {Space::se2({0, 10}, {0, 10}), Space::se3({{{0, 10}, {0, 10}, {0, 10}}}, 3.0)}) {
    CAPTURE(space.name());
    Stream stream(3, space.name(), "reached");
    const auto anywhere = [&] {
      Configuration q(space.dimension());
      space.sample_uniform(stream, q);
      return q;
    };
    const Configuration root = anywhere();
    ReachedIndex reached(space, root);
    std::vector<Configuration> nodes = {root};
    const auto agrees = [&] {
      CHECK(reached.size() == nodes.size());
      for (int i = 0; i < 5; ++i) {
        const Configuration q = anywhere();
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& node : nodes) nearest = std::min(nearest, space.squared_distance(node, q));
        CHECK(reached.squared_distance(q) == Approx(nearest).epsilon(1e-9));
      }
    };
    const auto add = [&](const Configuration& q) {
      nodes.push_back(q);
      reached.add(q);
    };
    for (int round = 0; round < 60; ++round) {
      CAPTURE(round);
      const auto many = stream.below(120);
      for (std::uint64_t i = 0; i < many; ++i) {
        // Nodes may repeat.
        add(stream.uniform() < 0.1 ? Configuration(nodes[stream.below(nodes.size())]) : anywhere());
        if (stream.uniform() < 0.05) agrees();
      }
      if (stream.uniform() < 0.7) agrees();
      // The tree is pruned, or, at times, is another one: nodes in another order, and new ones between.
      std::vector<Configuration> rest(nodes.begin() + 1, nodes.end());
      const double lost = stream.uniform();
      std::erase_if(rest, [&](const Configuration&) { return stream.uniform() < lost; });
      if (stream.uniform() < 0.2) std::ranges::reverse(rest);
      if (stream.uniform() < 0.2) rest.insert(rest.begin() + static_cast<std::ptrdiff_t>(rest.size() / 2), anywhere());
      reached.clear();
      nodes = {root};
      if (stream.uniform() < 0.3) agrees();
      for (const Configuration& q : rest) add(q);
      if (stream.uniform() < 0.5) agrees();
    }
  }
}
