// SPDX-License-Identifier: GPL-3.0-or-later
// glTF of problems in space: what the format demands, the motion, and another reader.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/pictures/base64.hpp>
#include <trellis/pictures/gltf.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

#ifdef TRELLIS_TINYGLTF
#include <tiny_gltf.h>
#endif

#include "report_folder.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/manipulators.hpp"
#include "support/space.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using fixture::Files;
using fixture::Folder;
using fixture::read;
using Json = nlohmann::json;

namespace {

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes.at(at + i));
  return value;
}

/// The parts of a binary file.
struct Glb {
  Json json;
  std::string buffer;
};

Glb glb_of(const std::string& file) {
  REQUIRE(file.size() % 4 == 0);
  CHECK(file.substr(0, 4) == "glTF");
  CHECK(word(file, 4) == 2);
  CHECK(word(file, 8) == file.size());
  const std::size_t length = word(file, 12);
  CHECK(length % 4 == 0);
  CHECK(file.substr(16, 4) == "JSON");
  Glb glb;
  glb.json = Json::parse(file.substr(20, length));
  CHECK(word(file, 20 + length) % 4 == 0);
  CHECK(file.substr(24 + length, 4) == std::string("BIN\0", 4));
  glb.buffer = file.substr(28 + length);
  CHECK(glb.buffer.size() == word(file, 20 + length));
  return glb;
}

std::vector<double> numbers(const Glb& glb, std::size_t accessor) {
  const Json& a = glb.json["accessors"].at(accessor);
  const Json& view = glb.json["bufferViews"].at(a["bufferView"].get<std::size_t>());
  const std::size_t width = a["type"] == "SCALAR" ? 1 : a["type"] == "VEC3" ? 3 : 4;
  const std::size_t count = a["count"].get<std::size_t>() * width;
  const std::size_t offset = view["byteOffset"].get<std::size_t>();
  REQUIRE(view["byteLength"].get<std::size_t>() == 4 * count);
  REQUIRE(offset + 4 * count <= glb.buffer.size());
  CHECK(offset % 4 == 0);
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t bits = word(glb.buffer, offset + 4 * i);
    float number = 0.0F;
    std::memcpy(&number, &bits, sizeof(number));
    out.push_back(a["componentType"] == 5126 ? static_cast<double>(number) : static_cast<double>(bits));
  }
  return out;
}

/// Checks what the specification demands of the parts that Trellis writes.
void check_valid(const Glb& glb) {
  const Json& json = glb.json;
  CHECK(json["asset"]["version"] == "2.0");
  CHECK(json["buffers"][0]["byteLength"] == glb.buffer.size());
  const auto& accessors = json["accessors"];
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    const Json& a = accessors[i];
    CHECK(a["count"].get<std::size_t>() > 0);
    const std::vector<double> all = numbers(glb, i);
    if (!a.contains("min")) continue;
    const std::size_t width = a["min"].size();
    for (std::size_t axis = 0; axis < width; ++axis) {
      double least = all[axis];
      double most = all[axis];
      for (std::size_t k = axis; k < all.size(); k += width) {
        REQUIRE(std::isfinite(all[k]));
        least = std::min(least, all[k]);
        most = std::max(most, all[k]);
      }
      CHECK(a["min"][axis].get<double>() == least);
      CHECK(a["max"][axis].get<double>() == most);
    }
  }
  for (const Json& mesh : json["meshes"]) {
    const Json& part = mesh["primitives"].at(0);
    CHECK(part["material"].get<std::size_t>() < json["materials"].size());
    const std::size_t position = part["attributes"]["POSITION"].get<std::size_t>();
    CHECK(accessors.at(position).contains("min"));
    if (!part.contains("indices")) continue;
    const auto count = accessors.at(position)["count"].get<double>();
    const std::vector<double> indices = numbers(glb, part["indices"].get<std::size_t>());
    CHECK(std::all_of(indices.begin(), indices.end(), [&](double index) { return index < count; }));
    CHECK(indices.size() % (part["mode"] == 4 ? 3 : 2) == 0);
  }
  // Each node but the root is the child of one.
  std::vector<int> parents(json["nodes"].size(), 0);
  for (const Json& node : json["nodes"]) {
    if (node.contains("mesh")) CHECK(node["mesh"].get<std::size_t>() < json["meshes"].size());
    if (node.contains("rotation")) {
      double norm = 0.0;
      for (const Json& x : node["rotation"]) norm += x.get<double>() * x.get<double>();
      CHECK(norm == Approx(1.0).epsilon(1e-9));
    }
    if (!node.contains("children")) continue;
    for (const Json& child : node["children"]) ++parents.at(child.get<std::size_t>());
  }
  for (std::size_t i = 1; i < parents.size(); ++i) CHECK(parents[i] == 1);
  CHECK(parents[0] == 0);
  if (!json.contains("animations")) return;
  for (const Json& animation : json["animations"]) {
    for (const Json& channel : animation["channels"]) {
      const Json& sampler = animation["samplers"].at(channel["sampler"].get<std::size_t>());
      const std::vector<double> times = numbers(glb, sampler["input"].get<std::size_t>());
      const std::vector<double> values = numbers(glb, sampler["output"].get<std::size_t>());
      CHECK(times.front() == 0.0);
      CHECK(times.back() == Approx(10.0));
      CHECK(std::is_sorted(times.begin(), times.end(), std::less_equal<>()));
      const bool turns = channel["target"]["path"] == "rotation";
      CHECK(values.size() == times.size() * (turns ? 4 : 3));
      if (!turns) continue;
      for (std::size_t i = 0; i < values.size(); i += 4) {
        const auto product = [&](std::size_t a, std::size_t b) {
          return values[a] * values[b] + values[a + 1] * values[b + 1] + values[a + 2] * values[b + 2] +
                 values[a + 3] * values[b + 3];
        };
        CHECK(product(i, i) == Approx(1.0).epsilon(1e-6));
        if (i > 0) CHECK(product(i - 4, i) >= 0.0);
      }
    }
  }
}

}  // namespace

TEST_CASE("base 64 pads", "[figures]") {
  CHECK(base64("").empty());
  CHECK(base64("f") == "Zg==");
  CHECK(base64("fo") == "Zm8=");
  CHECK(base64("foobar") == "Zm9vYmFy");
}

TEST_CASE("glTF of a scene of space is valid, in text and in binary", "[figures]") {
  const Problem problem = test::slot_problem();
  const std::string binary = gltf(problem, GltfForm::binary);
  const Glb glb = glb_of(binary);
  check_valid(glb);
  CHECK_FALSE(glb.json.contains("animations"));
  Json text = Json::parse(gltf(problem, GltfForm::text));
  CHECK(text["buffers"][0]["uri"] == "data:application/octet-stream;base64," + base64(glb.buffer));
  text["buffers"][0].erase("uri");
  CHECK(text == glb.json);
  CHECK(gltf(problem, GltfForm::binary) == binary);
  // The obstacles by name, at their places.
  std::vector<std::string> names;
  for (const Json& node : glb.json["nodes"]) names.push_back(node["name"]);
  CHECK(names == std::vector<std::string>{"trellis", "slot", "lower block", "upper block", "ball", "post", "rod",
                                          "tetrahedron", "bounds", "start", "goal"});
  CHECK(glb.json["nodes"][4]["translation"] == Json{2.5, 5.0, 5.0});
  // A scene without start and goal, and one with a name that is not UTF-8.
  Problem bare = problem;
  bare.start.clear();
  bare.goals.clear();
  bare.name = "b\xFF";
  check_valid(glb_of(gltf(bare, GltfForm::binary)));

  CHECK(gltf_form("x.glb") == GltfForm::binary);
  CHECK(gltf_form("x.gltf") == GltfForm::text);
  CHECK_THROWS_AS(gltf_form("x.obj"), Error);
}

TEST_CASE("glTF of a run moves the robot of each level along the path that it found", "[figures]") {
  const Experiment experiment = test::slot_experiment();
  const ExperimentResult result = run(experiment);
  const RunResult& nested = result.runs.back();
  REQUIRE(nested.levels.size() == 3);
  const Problem& problem = experiment.problems.front();
  const Glb glb = glb_of(gltf(problem, nested, GltfForm::binary));
  check_valid(glb);
  std::size_t animated = 0;
  for (const auto& level : nested.levels) animated += level.record.solution.path.size() > 1 ? 1U : 0U;
  REQUIRE(glb.json["animations"].size() == animated);

  // The root's animation is the last, and its keys are the points of the path.
  const Json& animation = glb.json["animations"].back();
  const Configurations& path = nested.levels.front().record.solution.path;
  const auto values = [&](std::size_t channel) {
    const std::size_t sampler = animation["channels"][channel]["sampler"].get<std::size_t>();
    return numbers(glb, animation["samplers"][sampler]["output"].get<std::size_t>());
  };
  const std::vector<double> places = values(0);
  const std::vector<double> turns = values(1);
  REQUIRE(places.size() == 3 * path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) CHECK(places[3 * i + axis] == Approx(path[i][axis]).margin(1e-5));
    const Quaternion expected{path[i][3], path[i][4], path[i][5], path[i][6]};
    const Quaternion written{turns[4 * i], turns[4 * i + 1], turns[4 * i + 2], turns[4 * i + 3]};
    CHECK(angle_between(expected, written) < 1e-5);
  }

  const Folder folder;
  Experiment both = experiment;
  both.problems.push_back(test::simple_passage_problem());
  const auto notes = write_gltf(both, result, folder.path().string());
  CHECK(notes == std::vector<std::string>{"simple_passage: no glTF, its world is planar"});
  CHECK(folder.files() == Files{"slot/rrt_connect.glb", "slot/nested.glb"});
  CHECK(read(folder.path() / "slot/nested.glb") == gltf(problem, nested, GltfForm::binary));
}

TEST_CASE("glTF of an arm moves it at the limits of its joints, and stops where the path bends", "[figures]") {
  const test::Folder folder;
  ManipulatorFiles files;
  files.urdf = folder.write("six.urdf", test::six_joints);
  std::vector<std::string> warnings;
  Problem problem;
  problem.name = "arm";
  problem.scene = std::make_shared<const ManipulatorScene>(World3({{-2, -2, -2}, {2, 2, 2}}, {}, Contain::none),
                                                           read_manipulator(files, warnings));
  problem.space = problem.scene->default_space(1.0);
  problem.start = {0, 0.1, 0, 0, 0, 0};
  problem.goals = {{1, 0.1, 1, 0, 0, 0}};
  RunResult run;
  run.levels.emplace_back();
  LevelRecord& record = run.levels.front().record;
  record.space = problem.space;
  record.scene = problem.scene;
  record.solution.path = Configurations(6);
  for (const Configuration& q : {problem.start, Configuration{1, 0.1, 0, 0, 0, 0}, problem.goals.front()}) {
    record.solution.path.push(q);
  }
  for (const double acceleration : {1.0, 4.0}) {
    // Two legs of 1 rad: a triangle of speeds at 1 rad/s^2, a trapezoid with at most 1 rad/s at 4.
    const double expected = acceleration == 1.0 ? 4.0 : 2.5;
    const Glb glb = glb_of(gltf(problem, run, GltfForm::binary, {.velocity = 1.0, .acceleration = acceleration}));
    REQUIRE(glb.json.contains("animations"));
    for (const Json& animation : glb.json["animations"]) {
      const auto times = numbers(glb, animation["samplers"][0]["input"].get<std::size_t>());
      CHECK(times.front() == 0.0);
      CHECK(times.back() == Approx(expected));
      CHECK(std::is_sorted(times.begin(), times.end(), std::less_equal<>()));
    }
  }
}

TEST_CASE("another reader of glTF reads the same", "[figures]") {
#ifdef TRELLIS_TINYGLTF
  const Experiment experiment = test::slot_experiment();
  const ExperimentResult result = run(experiment);
  const Problem& problem = experiment.problems.front();
  tinygltf::TinyGLTF reader;
  for (const GltfForm form : {GltfForm::text, GltfForm::binary}) {
    const std::string file = gltf(problem, result.runs.back(), form);
    tinygltf::Model model;
    std::string error;
    std::string warning;
    const bool loaded =
        form == GltfForm::text
            ? reader.LoadASCIIFromString(&model, &error, &warning, file.data(), static_cast<unsigned>(file.size()), "")
            : reader.LoadBinaryFromMemory(&model, &error, &warning,
                                          reinterpret_cast<const unsigned char*>(file.data()),  // NOLINT
                                          static_cast<unsigned>(file.size()), "");
    CHECK(loaded);
    CHECK(error.empty());
    CHECK(warning.empty());
    const Json json = glb_of(gltf(problem, result.runs.back(), GltfForm::binary)).json;
    CHECK(model.nodes.size() == json["nodes"].size());
    CHECK(model.meshes.size() == json["meshes"].size());
    CHECK(model.accessors.size() == json["accessors"].size());
    CHECK(model.animations.size() == json["animations"].size());
    CHECK(model.nodes[2].name == "lower block");
    CHECK(model.accessors[0].minValues.size() == 3);
  }
#else
  WARN("SKIPPED: built without libtinygltf-dev");
#endif
}
