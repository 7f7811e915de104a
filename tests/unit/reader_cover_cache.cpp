// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/folder.hpp"

#include <trellis/reader/cover_cache.hpp>
#include <trellis/reader/robot_files.hpp>

using namespace trellis;
using trellis::test::Folder;
namespace fs = std::filesystem;

namespace {

Solid pyramid(double height) {
  return {std::make_shared<const Mesh>(std::vector<Vec3>{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, height}},
                                       std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, "pyramid"),
          {}};
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool same(const MedialCover& a, const MedialCover& b) { return a.balls == b.balls && a.excess == b.excess; }

}  // namespace

TEST_CASE("a stored cover has the same bits as one that is made") {
  const Folder folder;
  const CoverCache cache(folder.path() / "trellis" / "covers");
  const Solid solid = pyramid(0.2);
  const std::span one(&solid, 1);
  const MedialCover made = medial_cover(one);
  CHECK(same(cache.cover(one, {}), made));
  const auto files = files_in(folder.path() / "trellis" / "covers");
  REQUIRE(files.size() == 1);
  const std::string stored = bytes_of(files[0]);
  // A cover in the file, which no method would make: it is read.
  CHECK(same(cache.cover(one, {}), made));
  CHECK(files_in(folder.path() / "trellis" / "covers") == files);
  CHECK(bytes_of(files[0]) == stored);
  // Other shapes, options and poses have files of their own.
  const Solid other = pyramid(0.3);
  CHECK(same(cache.cover(std::span(&other, 1), {}), medial_cover(std::span(&other, 1))));
  const CoverOptions finer{.excess = 0.005};
  CHECK(same(cache.cover(one, finer), medial_cover(one, finer)));
  Solid moved = solid;
  moved.pose.position.x = 0.1;
  CHECK(same(cache.cover(std::span(&moved, 1), {}), medial_cover(std::span(&moved, 1))));
  CHECK(files_in(folder.path() / "trellis" / "covers").size() == 4);
}

TEST_CASE("a stored cover is read in place of being made") {
  const Folder folder;
  const CoverCache cache(folder.path());
  const Solid solid = pyramid(0.2);
  const std::span one(&solid, 1);
  const MedialCover made = cache.cover(one, {});
  // The file of one shape under the name of another is not taken: it contains its name.
  const Solid other = pyramid(0.3);
  const fs::path first = files_in(folder.path()).front();
  const MedialCover others = cache.cover(std::span(&other, 1), {});
  for (const fs::path& file : files_in(folder.path())) {
    if (file != first) fs::copy_file(first, file, fs::copy_options::overwrite_existing);
  }
  CHECK(same(cache.cover(std::span(&other, 1), {}), others));
}

TEST_CASE("a damaged cover is made and written anew") {
  const Folder folder;
  const CoverCache cache(folder.path());
  const Solid solid = pyramid(0.2);
  const std::span one(&solid, 1);
  const MedialCover made = cache.cover(one, {});
  const fs::path file = files_in(folder.path()).front();
  const std::string stored = bytes_of(file);
  std::vector<std::string> damaged = {"", "trellis", stored.substr(0, stored.size() - 1), stored + "x"};
  for (std::size_t at = 0; at < stored.size(); at += 37) {
    damaged.push_back(stored);
    damaged.back()[at] = static_cast<char>(damaged.back()[at] ^ 0x10);
  }
  for (const std::string& bytes : damaged) {
    std::ofstream(file, std::ios::binary) << bytes;
    CHECK(same(cache.cover(one, {}), made));
    CHECK(bytes_of(file) == stored);
  }
}

TEST_CASE("a cover is made where none can be stored") {
  const Folder folder;
  const Solid solid = pyramid(0.2);
  const std::span one(&solid, 1);
  const std::string file = folder.write("file", "no folder");
  CHECK(same(CoverCache(fs::path(file) / "covers").cover(one, {}), medial_cover(one)));
  CHECK(same(CoverCache(std::nullopt).cover(one, {}), medial_cover(one)));
  CHECK(bytes_of(file) == "no folder");
  // Spheres need no file.
  const Solid sphere{Sphere{0.1}, {}};
  CHECK(CoverCache(folder.path() / "covers").cover(std::span(&sphere, 1), {}).balls.size() == 1);
  CHECK(!fs::exists(folder.path() / "covers"));
}

TEST_CASE("the oldest covers are removed where all are too large") {
  const Folder folder;
  const CoverCache cache(folder.path());
  const auto now = fs::file_time_type::clock::now();
  for (int i = 0; i < 5; ++i) {
    const std::string file = folder.write(std::to_string(9 - i) + ".cover", std::string(100, 'x'));
    fs::last_write_time(file, now - std::chrono::hours(10 - i));
  }
  cache.trim();
  CHECK(files_in(folder.path()).size() == 5);
  cache.trim(250);
  CHECK(files_in(folder.path()).size() == 2);
  CHECK(fs::exists(folder.path() / "5.cover"));
  CHECK(fs::exists(folder.path() / "6.cover"));
}

TEST_CASE("covers are stored in the user's cache folder") {
  const auto with = [](const char* off, const char* cache, const char* home) {
    struct Restore {
      Restore() : name{"TRELLIS_NO_CACHE", "XDG_CACHE_HOME", "HOME"} {
        for (int i = 0; i < 3; ++i) {
          const char* value = std::getenv(name[i]);
          if (value != nullptr) before[i] = value;
        }
      }
      ~Restore() {
        for (int i = 0; i < 3; ++i) {
          if (before[i]) {
            setenv(name[i], before[i]->c_str(), 1);
          } else {
            unsetenv(name[i]);
          }
        }
      }
      const char* name[3];
      std::optional<std::string> before[3];
    } restore;
    setenv("TRELLIS_NO_CACHE", off, 1);
    setenv("XDG_CACHE_HOME", cache, 1);
    setenv("HOME", home, 1);
    return user_cover_folder();
  };
  CHECK(with("", "/cache", "/home/a") == fs::path("/cache/trellis/covers"));
  CHECK(with("0", "", "/home/a") == fs::path("/home/a/.cache/trellis/covers"));
  CHECK(with("", "relative", "/home/a") == fs::path("/home/a/.cache/trellis/covers"));
  CHECK(with("", "", "") == std::nullopt);
  CHECK(with("1", "/cache", "/home/a") == std::nullopt);
}

TEST_CASE("a robot is read with a note on how far its balls protrude") {
  const Folder folder;
  ManipulatorFiles files;
  files.urdf = folder.write("bar.urdf", R"(<robot name="bar">
    <link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <link name="arm"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.3 0.05 0.05"/></geometry></collision></link>
    <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  </robot>)");
  std::vector<std::string> warnings;
  const SphereModel robot = read_manipulator(files, warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("bar.urdf: link arm is covered by ") != std::string::npos);
  CHECK(warnings[0].find(" balls that protrude at most 0.8 cm") != std::string::npos);
  CHECK(robot.excess() > 0.007);
  CHECK(robot.excess() <= 0.008 + 1e-9);
  CHECK(robot.covers().links[0].excess == 0.0);
  files.cover = 0.005;
  const SphereModel finer = read_manipulator(files, warnings);
  CHECK(finer.excess() <= 0.005 + 1e-9);
  CHECK(finer.bodies()[1].size() > robot.bodies()[1].size());
  // A shape that is attached is covered as the robot is.
  const SphereModel with = finer.attached("box", {Cuboid{{0.1, 0.1, 0.1}}, {{0.6, 0, 0}, {}}}, 1, {});
  CHECK(with.excess() <= 0.005 + 1e-9);
  CHECK(with.bodies()[1].size() > finer.bodies()[1].size() + 10);
}
