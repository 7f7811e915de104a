// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <trellis/collision/checker.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace trellis;

namespace {

struct Read {
  UrdfFile urdf;
  SrdfFile srdf;
  SphereModel model;
};

Read panda(const std::string& folder) {
  UrdfFile urdf = read_urdf(folder + "/panda_spherized.urdf");
  SrdfFile srdf = read_srdf(folder + "/panda.srdf", urdf.tree);
  Manipulator robot(urdf.tree, srdf.groups.front().joints);
  SphereModel model(robot, srdf.disabled);
  return {std::move(urdf), std::move(srdf), std::move(model)};
}

}  // namespace

TEST_CASE("starts and goals of the Panda's problems are valid but one", "[collision][robot]") {
  const std::string folder = test::scene("vamp_mbm").string();
  if (folder.empty()) return;
  const char* extracted = std::getenv("TRELLIS_MBM");
  const std::string problems = extracted != nullptr ? extracted : folder + "/panda_samples";
  const Read robot = panda(folder + "/robots/panda");
  CHECK(robot.model.exact());
  int count = 0;
  int valid = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(problems)) {
    const std::string path = entry.path().string();
    if (path.find("scene0") == std::string::npos && path.find("_scene") == std::string::npos) continue;
    if (!path.ends_with(".yaml")) continue;
    const MoveitFile file = read_moveit(path, robot.model);
    const auto scene = std::make_shared<ManipulatorScene>(file.world, robot.model);
    const auto checker = make_checker("spheres", scene, scene->default_space(1.0), 0.05);
    ++count;
    const bool both = checker->valid(file.start) && checker->valid(file.goal);
    valid += both ? 1 : 0;
    if (!both) {
      for (const auto* q : {&file.start, &file.goal}) {
        if (const auto contact = checker->contact(*q))
          UNSCOPED_INFO(path << ": " << scene->body_name(contact->body) << " " << describe(*contact, *scene));
      }
    }
  }
  CHECK(count > 0);
  CHECK(valid == count);
}
