// SPDX-License-Identifier: GPL-3.0-or-later
// The training data of a model, its predictions, and its file.
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/memory/grid.hpp>
#include <trellis/memory/model.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/families.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "support/learning_tasks.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

constexpr double tolerance = TrainingSettings{}.tolerance;

TrainingSettings quick(std::uint64_t seed = 1) {
  TrainingSettings settings;
  settings.cells = 40;
  settings.samples = 300;
  settings.forest.trees = 15;
  settings.forest.seed = seed;
  return settings;
}

/// Trained on gaps in the upper half.
const Model& learnt() {
  static const Model model = Model::train(test::family(test::upper_gaps, 1, 25), quick(), "upper gaps");
  return model;
}

const Box2 square{{0, 0}, {10, 10}};

std::string fault_of(const std::string& file) {
  return test::fault_of([&] { static_cast<void>(Model::load(file)); });
}

}  // namespace

TEST_CASE("a grid's cells are free where no obstacle comes into them", "[memory][grid]") {
  const World world = test::rectangle_world({{4, 0, 4.1, 7}});
  const WorldGrid grid(world, square, 20);
  REQUIRE(grid.columns() == 20);
  REQUIRE(grid.rows() == 20);
  CHECK(grid.width() == Approx(0.5));
  CHECK(grid.at({0.1, 0.1}) == 0);
  CHECK(grid.at({9.9, 9.9}) == 399);
  CHECK(grid.at({-5, 50}) == 380);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec2 c = grid.centre(i);
    CHECK(grid.at(c) == i);
    // The wall is thinner than a cell and stands in its left part.
    CHECK(grid.free(i) == !(c.x > 4.0 && c.x < 4.5 && c.y < 7.0));
  }
  CHECK(grid.clearance()[grid.at({4.25, 3.25})] == 0.0);
  CHECK(grid.clearance()[grid.at({3.25, 3.25})] == Approx(1.0));
  const WorldGrid wide(World(Box2{{0, 0}, {10, 5}}, {}), Box2{{0, 0}, {10, 5}}, 20);
  CHECK(wide.columns() == 20);
  CHECK(wide.rows() == 10);
}

TEST_CASE("the oracle finds the shortest paths over the grid", "[memory][grid]") {
  const WorldGrid empty(test::rectangle_world({}), square, 20);
  const auto lengths = path_lengths_to(empty, empty.at({9.75, 9.75}));
  CHECK(lengths[empty.at({9.75, 9.75})] == 0.0);
  CHECK(lengths[empty.at({0.25, 0.25})] == Approx(9.5 * std::sqrt(2.0)));
  CHECK(lengths[empty.at({0.25, 9.75})] == Approx(9.5));
  CHECK(lengths[empty.at({0.25, 7.75})] == Approx(2.0 * std::sqrt(2.0) + 7.5));
  // Round the end of a wall, and not across the corner of it.
  const WorldGrid wall(test::rectangle_world({{4, 0, 4.4, 9.4}}), square, 20);
  const auto round = path_lengths_to(wall, wall.at({5.25, 0.25}));
  const double below = round[wall.at({3.25, 0.25})];
  // Up to the last row and down again: 19 steps each, and four across, of which none may cut the wall's corner.
  CHECK(below > 2 * 9.0 + 1.0);
  CHECK(below < 2 * 9.5 + 2.0);
  const WorldGrid closed(test::rectangle_world({{4, 0, 4.4, 10}}), square, 20);
  CHECK(std::isinf(path_lengths_to(closed, closed.at({5.25, 0.25}))[closed.at({3.25, 0.25})]));
  CHECK_FALSE(ask_oracle(closed, {1, 1}, {9, 9}, tolerance).has_value());
  const auto found = ask_oracle(wall, {1, 1}, {9, 1}, tolerance);
  REQUIRE(found.has_value());
  CHECK(found->on_path[wall.at({4.25, 9.75})] != 0);
  CHECK(found->on_path[wall.at({9.75, 9.75})] == 0);
  CHECK(found->shortest > 16.0);
}

TEST_CASE("the oracle's lengths satisfy the triangle inequality and are lengths of paths", "[memory][grid]") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Problem problem = test::upper_gaps(seed);
    const WorldGrid grid(planar(*problem.scene).world, square, 40);
    const auto start = grid.free_near({0.5, 5});
    const auto goal = grid.free_near({9.5, 5});
    REQUIRE((start && goal));
    const auto behind = path_lengths_to(grid, *start);
    const auto ahead = path_lengths_to(grid, *goal);
    CHECK(behind[*goal] == Approx(ahead[*start]));
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (!grid.free(i) || std::isinf(ahead[i])) continue;
      REQUIRE(behind[i] + ahead[i] >= ahead[*start] - 1e-9);
      REQUIRE(ahead[i] >= norm(grid.centre(i) - grid.centre(*goal)) - 1e-9);
    }
  }
}

TEST_CASE("a model of a family predicts paths in its held-out worlds", "[memory][model]") {
  const Validation own = validate(learnt(), test::family(test::upper_gaps, 1001, 15), tolerance);
  CAPTURE(own.learned, own.uniform, own.straight, own.error);
  REQUIRE(own.tasks == 15);
  CHECK(own.learned + 4.0 * own.error < own.uniform);
  CHECK(own.learned < own.straight);
}

TEST_CASE("what is learnt of a family misleads in the worlds of another one", "[memory][model]") {
  const Validation own = validate(learnt(), test::family(test::upper_gaps, 1001, 15), tolerance);
  const Validation other = validate(learnt(), test::family(test::lower_gaps, 1001, 15), tolerance);
  CAPTURE(own.learned, other.learned, other.uniform);
  CHECK(other.learned > own.learned + 0.5);
}

TEST_CASE("training is deterministic in its seed", "[memory][model]") {
  const auto tasks = test::family(test::upper_gaps, 1, 6);
  const std::string one = Model::train(tasks, quick(3), "a").bytes();
  CHECK(Model::train(tasks, quick(3), "a").bytes() == one);
  CHECK(Model::train(tasks, quick(4), "a").bytes() != one);
}

TEST_CASE("a model is in a file what it was", "[memory][model]") {
  const test::Folder folder;
  const std::string file = folder.file("a.model");
  const auto write = [&](const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; };
  CHECK_THAT(fault_of(file), Contains("there is no such model") && Contains("trellis experience"));
  CHECK(known_model(file) == nullptr);
  const std::string bytes = learnt().bytes();

  write(bytes);
  const Model read = Model::load(file);
  CHECK(read.bytes() == bytes);
  CHECK(read.description() == "upper gaps");
  CHECK(read.cells() == 40);
  const Problem problem = test::upper_gaps(77);
  const WorldGrid grid(planar(*problem.scene).world, square, 40);
  CHECK(read.probabilities(grid, {0.5, 5}, {9.5, 5}) == learnt().probabilities(grid, {0.5, 5}, {9.5, 5}));

  write("hello");
  CHECK_THAT(fault_of(file), Contains("is no model"));
  write("");
  CHECK_THAT(fault_of(file), Contains("is no model"));
  // However much of it is missing.
  Stream stream(1, "", "damage");
  for (int i = 0; i < 60; ++i) {
    write(bytes.substr(0, stream.below(bytes.size())));
    REQUIRE_FALSE(fault_of(file).empty());
  }
  write(bytes + "more");
  CHECK_THAT(fault_of(file), Contains("damaged"));
  for (int i = 0; i < 60; ++i) {
    std::string turned = bytes;
    const std::size_t at = stream.below(bytes.size());
    turned[at] = static_cast<char>(turned[at] ^ (1 << stream.below(8)));
    write(turned);
    CAPTURE(at);
    REQUIRE_FALSE(fault_of(file).empty());
  }
  std::string later = bytes;
  later[18] = 7;  // the version's first byte, after the name of the format
  write(later);
  CHECK_THAT(fault_of(file), Contains("version 7") && Contains("train it again"));
}

TEST_CASE("on the planning data sets the learnt heuristic beats the uniform one on worlds held out",
          "[memory][model][scenes][slow]") {
  const auto worlds = test::stored_family("gaps_and_forest", "train");
  if (worlds.empty()) return;
  TrainingSettings settings = quick();
  settings.cells = 67;
  const Model model = Model::train(worlds, settings, "gaps_and_forest");
  const Validation found = validate(model, test::stored_family("gaps_and_forest", "validation"), tolerance);
  CAPTURE(found.learned, found.uniform, found.straight, found.error, found.tasks);
  CHECK(found.tasks >= 10);
  CHECK(found.learned + 4.0 * found.error < found.uniform);
}
