// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings: worlds, and outlines of robots.
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>

#include <cstdlib>

#include "fuzz.hpp"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile file("drawing.svg");
  const std::string& path = file.write(data, size);
  trellis::fuzz::examine([&] {
    const trellis::SceneFile scene = trellis::read_scene(path, {});
    // Of a drawing every obstacle is convex: one part.
    const trellis::World& world = trellis::planar(*scene.problems.front().scene).world;
    if (scene.format.starts_with("SVG") && world.parts().size() != world.obstacles().size()) std::abort();
  });
  return trellis::fuzz::examine([&] { static_cast<void>(trellis::read_robot(path)); });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
