// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of problems in space: surfaces of solids, and the files of an experiment.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/figures/scene_figures.hpp>
#include <trellis/pictures/spatial_shapes.hpp>

#include "report_folder.hpp"
#include "support/catch.hpp"
#include "support/space.hpp"

using namespace trellis;
using fixture::check_pictures;
using fixture::Files;
using fixture::Folder;
using fixture::read;

namespace {

double volume(const draw::Surface& surface) {
  double sum = 0.0;
  for (const auto& t : surface.triangles) {
    const auto& v = surface.vertices;
    sum += draw::dot(v[t[0]], draw::cross(v[t[1]], v[t[2]])) / 6.0;
  }
  return sum;
}

}  // namespace

TEST_CASE("surfaces of solids are closed, turn outwards, and have about the solid's volume", "[figures]") {
  constexpr double pi = std::numbers::pi;
  const Pose3 pose{{3, -2, 1}, rotation_of({0.3, -0.4, 0.5})};
  for (const auto& [shape, expected] :
       {std::pair{Shape3{Sphere{0.5}}, pi / 6.0}, std::pair{Shape3{Cuboid{{1, 2, 3}}}, 6.0},
        std::pair{Shape3{Cylinder{0.5, 2.0}}, pi / 2.0}, std::pair{Shape3{Capsule{0.5, 2.0}}, pi / 2.0 + pi / 6.0}}) {
    const draw::Surface surface = surface_of(Solid{shape, pose});
    CAPTURE(shape.index());
    CHECK(surface.closed);
    CHECK(volume(surface) > 0.96 * expected);
    CHECK(volume(surface) < expected * (1.0 + 1e-9));
    const Mesh mesh({[&] {
                      std::vector<Vec3> all;
                      for (const auto& p : surface.vertices) all.push_back({p.x, p.y, p.z});
                      return all;
                    }()},
                    surface.triangles, "surface");
    CHECK(mesh.closed());
    CHECK(mesh.convex());
  }
  CHECK(surface_of(Robot3::point()).triangles.empty());
}

TEST_CASE("meshes of a world are simplified to a limit, and primitives are not", "[figures]") {
  std::vector<Vec3> points;
  for (int i = 0; i < 2000; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / 2000.0;
    const double r = std::sqrt(1.0 - z * z);
    points.push_back({r * std::cos(2.4 * i), r * std::sin(2.4 * i), z});
  }
  const auto ball = std::make_shared<const Mesh>(Mesh::hull(points, "ball"));
  const World3 world({{-2, -2, -2}, {2, 2, 2}}, {{"ball", {ball, {}}}, {"box", {Cuboid{{1, 1, 1}}, {}}}});
  const WorldSurfaces all = surfaces_of(world, 10000);
  CHECK(all.note().empty());
  CHECK(all.obstacles[0].triangles.size() == ball->triangles().size());
  const WorldSurfaces few = surfaces_of(world, 800);
  CHECK(few.obstacles[0].triangles.size() <= 800);
  CHECK(few.obstacles[0].triangles.size() > 100);
  CHECK(few.obstacles[1].triangles.size() == 12);
  CHECK_THAT(few.note(), Catch::Matchers::Contains("of 4008 triangles"));
  CHECK(volume(few.obstacles[0]) > 3.5);
}

TEST_CASE("pictures of space are seen from where the style says", "[figures]") {
  const draw::SpatialFigure frame = spatial_frame(test::slot_experiment().problems.front());
  const Folder folder;
  const auto picture = [&](const std::string& name, const FigureStyle& style) {
    write_figure(frame, style, (folder.path() / name).string());
    return read(folder.path() / (name + ".svg"));
  };
  const std::string usual = picture("usual", {});
  CHECK(picture("same", {.azimuth = frame.camera.azimuth, .elevation = frame.camera.elevation}) == usual);
  const std::string turned = picture("turned", {.azimuth = 20.0});
  CHECK(turned != usual);
  CHECK(picture("above", {.azimuth = 20.0, .elevation = 90.0}) != turned);
}

TEST_CASE("figures of a problem in space have the names of planar ones", "[figures][slow]") {
  const Experiment experiment = test::slot_experiment();
  const ExperimentResult result = run(experiment);
  const Folder folder;
  CHECK(write_scene_figures(experiment, result, folder.path().string()).empty());
  write_motion_figures(experiment, result, folder.path().string());
  Files expected;
  for (const char* stem : {"slot/rrt_connect/samples", "slot/rrt_connect/motion", "slot/nested/samples",
                           "slot/nested/levels", "slot/nested/motion"}) {
    for (const char* format : {".svg", ".png", ".pdf"}) expected.insert(std::string(stem) + format);
  }
  CHECK(folder.files() == expected);
  check_pictures(folder);
  for (const std::string& file : folder.files()) CHECK(read(folder.path() / file).size() < 3'000'000);

  SceneFigureOptions fine;
  fine.cell = 0.1;
  CHECK_THROWS_AS(write_scene_figures(experiment, result, folder.path().string(), fine), Error);

  const Folder again;
  SceneFigureOptions options;
  options.jobs = 2;
  write_scene_figures(experiment, result, again.path().string(), options);
  write_motion_figures(experiment, result, again.path().string(), 2);
  for (const std::string& file : folder.files()) {
    CAPTURE(file);
    const bool same = read(folder.path() / file) == read(again.path() / file);
    CHECK(same);
  }
}
