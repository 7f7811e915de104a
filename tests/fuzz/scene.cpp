// SPDX-License-Identifier: GPL-3.0-or-later
// The readers of scene files but drawings: circle worlds, arms of SBPL, dynobench, images, grid maps, BARN, maps of
// ROS.
#include <trellis/reader/readers.hpp>

#include "fuzz.hpp"

namespace {

/// The other files that a scene file needs: the queries of a circle world, the model of a dynobench car, the map of
/// queries, the reference paths of BARN, the image of a map.
void write_companions(const std::filesystem::path& folder) {
  std::ofstream(folder / "scene_queries.txt") << "0\tstart:\t12\t13\n0\tgoal:\t30\t25\n";
  std::ofstream(folder / "yard.map") << "type octile\nheight 3\nwidth 4\nmap\n..@.\n.G@S\nTTW.\n";
  std::ofstream(folder / "reference_path.csv") << "world,i,x,y\n7,0,-1,0\n7,1,2,3\n";
  std::ofstream(folder / "map.pgm") << "P2\n3 2 255\n254 0 205\n254 230 10\n";
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
  return trellis::fuzz::examine([&] { static_cast<void>(trellis::read_scene(file.write(data, size), {})); });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
