// SPDX-License-Identifier: GPL-3.0-or-later
// The readers of scene files: circle worlds, arms of SBPL, dynobench, PNG.
#include <trellis/scene/readers.hpp>

#include "fuzz.hpp"

namespace {

/// The other files that a scene file needs: the queries of a circle world, the model of a dynobench car.
void write_companions(const std::filesystem::path& folder) {
  std::ofstream(folder / "scene_queries.txt") << "0\tstart:\t12\t13\n0\tgoal:\t30\t25\n";
  std::filesystem::create_directories(folder / ".." / "shared" / "models");
  std::ofstream(folder / ".." / "shared" / "models" / "car1_v0.yaml")
      << "shape: box\nshape_trailer: box\nsize: [.5, .25]\nsize_trailer: [.3, .25]\nhitch_lengths: [.5]\n"
         "dt: 0.1\nl: 0.25\nmax_vel: 0.5\nmin_vel: -0.1\nmax_steering_abs: 1.0\n";
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile file("scene_obstacles.txt");
  static const bool written = (write_companions(file.folder()), true);
  static_cast<void>(written);
  return trellis::fuzz::examine([&] { static_cast<void>(trellis::read_problems(file.write(data, size), {})); });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
