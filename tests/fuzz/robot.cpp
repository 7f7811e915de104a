// SPDX-License-Identifier: GPL-3.0-or-later
// The readers of robots. The first byte chooses the file that the input is: a URDF file (`u`), or the SRDF file of a
// small robot (`s`).
#include <trellis/reader/robot_files.hpp>

#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz.hpp"

namespace {

constexpr std::string_view urdf = R"(<robot name="r"><link name="a"/>
<link name="b"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="c"><collision><origin xyz="0 0 0.2"/><geometry><box size="0.1 0.1 0.3"/></geometry></collision></link>
<link name="d"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="k" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2"/></joint>
<joint name="l" type="prismatic"><parent link="c"/><child link="d"/><limit lower="0" upper="0.1"/></joint>
</robot>
)";

void write(const std::string& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

/// What every robot that was read has; else the program ends, which is a finding.
void check(const trellis::SphereModel& model) {
  const trellis::Manipulator& robot = model.robot();
  bool good = robot.dimension() > 0 && std::isfinite(model.bounding_radius());
  for (const auto& balls : model.bodies()) {
    for (const trellis::BodySphere& ball : balls) good = good && ball.radius >= 0.0 && std::isfinite(norm(ball.centre));
  }
  for (const auto& [a, b] : model.pairs()) good = good && a < b && b < model.parts().size();
  for (const auto& state : model.states()) good = good && state.q.size() == robot.dimension();
  const trellis::Configuration zero(robot.dimension(), 0.0);
  good = good && std::isfinite(norm(model.tip_at(zero)));
  if (!good) std::abort();
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile place("robot.urdf");
  if (size == 0) return 0;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const bool is_srdf = input.front() == 's';
  trellis::ManipulatorFiles files;
  files.urdf = (place.folder() / "robot.urdf").string();
  write(files.urdf, is_srdf ? urdf : input.substr(1));
  if (is_srdf) {
    files.srdf = (place.folder() / "robot.srdf").string();
    write(files.srdf, input.substr(1));
  }
  return trellis::fuzz::examine([&] {
    std::vector<std::string> warnings;
    if (is_srdf) {
      // Each group is a robot.
      const trellis::SrdfFile srdf = trellis::read_srdf(files.srdf, trellis::read_urdf(files.urdf).tree);
      if (!srdf.groups.empty()) files.group = srdf.groups.front().name;
    }
    check(trellis::read_manipulator(files, warnings));
  });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
