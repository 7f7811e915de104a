// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "support/worlds.hpp"

using namespace trellis;

using Catch::Matchers::Contains;

namespace {

std::uint64_t hash_of(const Robot& robot) { return robot_hash(PlanarScene(World(), robot)); }

namespace fs = std::filesystem;

/// The path number n of a family: straight lines at different heights, otherwise equal.
Configurations numbered(int n, int points = 8) {
  Configurations path(3);
  for (int i = 0; i < points; ++i) path.push(Configuration{0.5 + i, 0.25 + 0.01 * n, 1e-3 * n + 0.1 * i});
  return path;
}

StoredPath stored(int n) {
  StoredPath path = stored_path(test::cup_problem(), numbered(n));
  path.problem = "problem " + std::to_string(n);
  return path;
}

const Space& space() {
  static const Space all = test::cup_problem().space;
  return all;
}

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write(const std::string& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

std::string fault_of(const std::string& file, Library::Mode mode) {
  return test::fault_of([&] { static_cast<void>(Library(file, mode).paths()); });
}

bool same(const Configurations& a, const Configurations& b) {
  return a.dimension() == b.dimension() &&
         std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

}  // namespace

TEST_CASE("a library gives back what was put into it, to the last bit", "[memory][library]") {
  const test::Folder folder;
  const std::string file = folder.file("a.db");
  {
    Library library(file, Library::Mode::write);
    CHECK(library.paths().empty());
    for (int n = 0; n < 5; ++n) CHECK(library.add(stored(n), space(), 0.0));
  }
  const auto paths = Library(file).paths();
  REQUIRE(paths.size() == 5);
  const Problem problem = test::cup_problem();
  for (int n = 0; n < 5; ++n) {
    const StoredPath& path = paths[static_cast<std::size_t>(n)];
    CHECK(path.problem == "problem " + std::to_string(n));
    CHECK(path.space_name == problem.space.name());
    CHECK(path.space == identity(problem.space));
    CHECK(path.robot == robot_hash(*problem.scene));
    CHECK(path.world == world_hash(*problem.scene));
    CHECK(path.length == path_length(problem.space, numbered(n)));
    CHECK(same(path.path, numbered(n)));
  }
  // One file, and nothing beside it once it is closed.
  CHECK(std::distance(fs::directory_iterator(fs::path(file).parent_path()), fs::directory_iterator()) == 1);
}

TEST_CASE("a path is added only when it is new, in either direction and with any waypoints", "[memory][library]") {
  const test::Folder folder;
  Library library(folder.file("a.db"), Library::Mode::write);
  REQUIRE(library.add(stored(0), space(), 0.3));
  CHECK_FALSE(library.add(stored(0), space(), 0.3));
  StoredPath other = stored(0);
  other.path = Configurations(3);
  for (int i = 7; i >= 0; --i) other.path.push(numbered(0)[static_cast<std::size_t>(i)]);
  CHECK_FALSE(library.add(other, space(), 0.3));
  other.path = numbered(0, 2);
  other.path.push(numbered(0).back());
  CHECK_FALSE(library.add(other, space(), 0.3));
  // 0.1 m higher all along, and turned a little more.
  CHECK_FALSE(library.add(stored(10), space(), 0.3));
  CHECK(library.add(stored(10), space(), 0.05));
  CHECK(library.add(stored(60), space(), 0.3));
  // The same path of another robot is another experience.
  other = stored(0);
  other.robot = hash_of(Robot::disc(0.3));
  CHECK(library.add(other, space(), 0.3));
  CHECK(library.paths().size() == 4);
}

TEST_CASE("the distance of paths is zero for equal paths, symmetric, and the gap for parallel ones",
          "[memory][library]") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  const auto path_of = [](std::initializer_list<std::array<double, 2>> points) {
    Configurations path(2);
    for (const auto& p : points) path.push(p);
    return path;
  };
  const auto flat = path_of({{1, 1}, {9, 1}});
  const auto divided = path_of({{1, 1}, {2, 1}, {2.5, 1}, {9, 1}});
  const auto above = path_of({{9, 1.7}, {1, 1.7}});
  const auto round = path_of({{1, 1}, {1, 9}, {9, 9}, {9, 1}});
  const auto farther = [&](const Configurations& a, const Configurations& b, double than) {
    const test::Folder folder;
    Library library(folder.file("a.db"), Library::Mode::write);
    StoredPath first = stored(0);
    first.path = a;
    StoredPath second = stored(0);
    second.path = b;
    REQUIRE(library.add(first, plane, 0.0));
    return library.add(second, plane, than);
  };
  CHECK_FALSE(farther(flat, flat, 0.0));
  CHECK_FALSE(farther(flat, divided, 1e-12));
  CHECK(farther(flat, above, 0.7 - 1e-9));
  CHECK_FALSE(farther(flat, above, 0.7 + 1e-9));
  CHECK(farther(flat, round, 2.0));
  for (double d = 2.0; d < 6.0; d += 0.125) CHECK(farther(flat, round, d) == farther(round, flat, d));
}

TEST_CASE("identities distinguish the spaces, robots and worlds of paths", "[memory][library]") {
  const Problem cup = test::cup_problem();
  CHECK(identity(cup.space) == identity(test::trap_problem().space));
  CHECK(world_hash(*cup.scene) != world_hash(*test::trap_problem().scene));
  CHECK(robot_hash(*cup.scene) == hash_of(test::rectangle_robot()));
  CHECK(robot_hash(*cup.scene) != hash_of(test::rectangle_robot(0.6, 0.21)));
  auto axes = cup.space.axes();
  axes[2].weight *= 2;
  CHECK(identity(cup.space) != identity(Space(cup.space.name(), axes)));
  CHECK(identity(cup.space) == identity(Space("another name", cup.space.axes())));
}

TEST_CASE("a file that is no library is an error and stays unchanged", "[memory][library][slow]") {
  const test::Folder folder;
  const std::string file = folder.file("a.db");
  const auto both = [&](const std::string& fault) {
    const std::string before = bytes_of(file);
    for (const auto mode : {Library::Mode::read, Library::Mode::write}) {
      CHECK_THAT(fault_of(file, mode), Contains(fault) && Contains(file));
      CHECK(bytes_of(file) == before);
    }
  };
  CHECK_THAT(fault_of(file, Library::Mode::read), Contains("there is no such library") && Contains("--learn"));
  CHECK_FALSE(fs::exists(file));
  SECTION("text") {
    write(file, std::string(5000, 'x'));
    both("is no library of paths");
  }
  SECTION("a short text") {
    write(file, "hello");
    both("is no library of paths");
  }
  SECTION("a folder") {
    fs::create_directory(file);
    CHECK_THAT(fault_of(file, Library::Mode::write), Contains("is a folder"));
  }
  SECTION("a library of a later version") {
    Library(file, Library::Mode::write).add(stored(1), space(), 0.0);
    std::string bytes = bytes_of(file);
    bytes[63] = 9;  // the last byte of the user version in SQLite's header
    write(file, bytes);
    both("version 9");
  }
  SECTION("a database of another program") {
    Library(file, Library::Mode::write).add(stored(1), space(), 0.0);
    std::string bytes = bytes_of(file);
    bytes[68] = 'X';  // of the application's id
    write(file, bytes);
    both("no library of paths of trellis");
  }
  SECTION("a library that lost its end") {
    {
      Library library(file, Library::Mode::write);
      for (int n = 0; n < 100; ++n) library.add(stored(100 * n), space(), 0.0);
    }
    const std::string bytes = bytes_of(file);
    write(file, bytes.substr(0, bytes.size() / 2 / 4096 * 4096));
    both("damaged");
  }
  SECTION("a path with a bit turned over") {
    Library(file, Library::Mode::write).add(stored(1), space(), 0.0);
    std::string bytes = bytes_of(file);
    const double x = numbered(1)[3][0];
    const auto at = bytes.find(std::string(reinterpret_cast<const char*>(&x), sizeof x));
    REQUIRE(at != std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    write(file, bytes);
    CHECK_THAT(fault_of(file, Library::Mode::read), Contains("path 1 of the library is damaged"));
  }
  SECTION("garbage over a library's pages") {
    {
      Library library(file, Library::Mode::write);
      for (int n = 0; n < 100; ++n) library.add(stored(100 * n), space(), 0.0);
    }
    const std::string sound = bytes_of(file);
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Stream stream(seed, "", "garbage");
      std::string bytes = sound;
      for (int i = 0; i < 200; ++i) {
        bytes[100 + stream.below(bytes.size() - 100)] = static_cast<char>(stream.below(256));
      }
      write(file, bytes);
      CAPTURE(seed);
      CHECK_FALSE(fault_of(file, Library::Mode::read).empty());
    }
  }
}

TEST_CASE("an empty file is a library to which nothing was added yet", "[memory][library]") {
  const test::Folder folder;
  const std::string file = folder.file("a.db");
  write(file, "");
  CHECK(Library(file).paths().empty());
  CHECK(Library(file, Library::Mode::write).add(stored(1), space(), 0.0));
  CHECK(Library(file).paths().size() == 1);
}

TEST_CASE("killed at any time, a library opens and has every path that was committed", "[memory][library]") {
  const test::Folder folder;
  const std::string file = folder.file("a.db");
  int committed = 0;  // known to be
  int killed_amid = 0;
  for (std::uint64_t round = 0; round < 25; ++round) {
    std::array<int, 2> pipe_ends{};
    REQUIRE(pipe(pipe_ends.data()) == 0);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      // Reports each path as soon as `add` has returned, and continues until it is killed.
      try {
        Library library(file, Library::Mode::write);
        for (int n = static_cast<int>(library.paths().size());; ++n) {
          if (!library.add(stored(n), space(), 0.0)) _exit(2);
          if (::write(pipe_ends[1], &n, sizeof n) != sizeof n) _exit(3);
        }
      } catch (...) {
        _exit(4);
      }
    }
    close(pipe_ends[1]);
    // From the very beginning, when the tables are made, to the middle of its work.
    std::this_thread::sleep_for(std::chrono::microseconds(500 + 3000 * round));
    REQUIRE(kill(child, SIGKILL) == 0);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status));
    int n = 0;
    while (read(pipe_ends[0], &n, sizeof n) == sizeof n) committed = n + 1;
    close(pipe_ends[0]);
    if (!fs::exists(file)) continue;
    killed_amid += fs::exists(file + "-journal") ? 1 : 0;
    const auto paths = Library(file).paths();
    CAPTURE(round, committed, killed_amid);
    REQUIRE(static_cast<int>(paths.size()) >= committed);
    REQUIRE(static_cast<int>(paths.size()) <= committed + 1);
    for (std::size_t i = 0; i < paths.size(); ++i) REQUIRE(same(paths[i].path, numbered(static_cast<int>(i))));
    committed = static_cast<int>(paths.size());
  }
  CHECK(committed > 0);
  // It can still be added to.
  CHECK(Library(file, Library::Mode::write).add(stored(committed), space(), 0.0));
}

TEST_CASE("processes that add to one library at once lose nothing of each other's", "[memory][library]") {
  const test::Folder folder;
  const std::string file = folder.file("a.db");
  constexpr int writers = 3;
  constexpr int each = 15;
  std::vector<pid_t> children;
  for (int w = 0; w < writers; ++w) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      try {
        Library library(file, Library::Mode::write);
        // All of them try all paths: who is first has it.
        for (int n = 0; n < each; ++n) static_cast<void>(library.add(stored(n), space(), 0.0));
        _exit(0);
      } catch (...) {
        _exit(1);
      }
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
  }
  std::vector<char> there(each, 0);
  for (const auto& path : Library(file).paths()) {
    const int n = std::stoi(path.problem.substr(8));
    CHECK(there[static_cast<std::size_t>(n)]++ == 0);
  }
  CHECK(std::count(there.begin(), there.end(), 1) == each);
}
