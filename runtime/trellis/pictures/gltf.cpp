// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/gltf.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>
#include <variant>

#include <trellis/base/error.hpp>
#include <trellis/base/printable.hpp>
#include <trellis/base/version.hpp>
#include <trellis/draw/palette.hpp>
#include <trellis/pictures/base64.hpp>
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/results/directories.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

// Numbers of the format.
constexpr int type_float = 5126;
constexpr int type_unsigned = 5125;
constexpr int target_vertices = 34962;
constexpr int target_indices = 34963;
constexpr int mode_lines = 1;
constexpr int mode_line_strip = 3;
constexpr int mode_triangles = 4;

constexpr double seconds = 10.0;  ///< of a motion

Json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }
Json vector_json(const Quaternion& q) { return {q.x, q.y, q.z, q.w}; }

/// The document with its numbers, which grows part by part. Functions that add a part return its index.
class Document {
 public:
  Document() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "Trellis " + version()}};
    json_["scene"] = 0;
    // z up into y up: a turn by -90 degrees about x.
    const double half = std::numbers::sqrt2 / 2.0;
    root_ = add_node({{"name", "trellis"}, {"rotation", {-half, 0.0, 0.0, half}}});
    json_["scenes"] = {{{"nodes", {root_}}}};
  }

  std::size_t root() const { return root_; }

  std::size_t add_node(Json node) { return add("nodes", std::move(node)); }
  std::size_t add_child(std::size_t parent, Json node) {
    const std::size_t child = add_node(std::move(node));
    json_["nodes"][parent]["children"].push_back(child);
    return child;
  }

  std::size_t add_material(const std::string& name, const draw::Colour& colour, bool both_sides) {
    // The format has linear colours.
    const auto linear = [](double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); };
    Json material = {{"name", name},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {linear(colour.r), linear(colour.g), linear(colour.b), colour.a}},
                       {"metallicFactor", 0.0},
                       {"roughnessFactor", 0.9}}}};
    if (colour.a < 1.0) material["alphaMode"] = "BLEND";
    if (both_sides) material["doubleSided"] = true;
    return add("materials", std::move(material));
  }

  /// Adds a mesh of triangles. Without normals, which the format allows, viewers shade triangles flat.
  std::size_t add_mesh(const std::string& name, const draw::Surface& surface, std::size_t material) {
    std::vector<std::uint32_t> indices;
    indices.reserve(3 * surface.triangles.size());
    for (const auto& t : surface.triangles) indices.insert(indices.end(), t.begin(), t.end());
    return add_mesh(name, surface.vertices, indices, mode_triangles, material);
  }
  std::size_t add_mesh(const std::string& name, const std::vector<draw::Point3>& points,
                       const std::vector<std::uint32_t>& indices, int mode, std::size_t material) {
    std::vector<double> numbers;
    numbers.reserve(3 * points.size());
    for (const draw::Point3& p : points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    Json primitive = {{"attributes", {{"POSITION", add_floats(numbers, "VEC3", 3, target_vertices)}}},
                      {"material", material},
                      {"mode", mode}};
    if (!indices.empty()) primitive["indices"] = add_indices(indices);
    return add("meshes", {{"name", name}, {"primitives", {std::move(primitive)}}});
  }

  /// \param target  of the buffer's view; 0 for an animation
  std::size_t add_floats(const std::vector<double>& numbers, const char* type, std::size_t width, int target) {
    std::vector<float> floats(numbers.begin(), numbers.end());
    std::vector<float> least(floats.begin(), floats.begin() + static_cast<std::ptrdiff_t>(width));
    std::vector<float> most = least;
    std::string bytes;
    bytes.reserve(4 * floats.size());
    for (std::size_t i = 0; i < floats.size(); ++i) {
      put(std::bit_cast<std::uint32_t>(floats[i]), bytes);
      least[i % width] = std::min(least[i % width], floats[i]);
      most[i % width] = std::max(most[i % width], floats[i]);
    }
    return add("accessors", {{"bufferView", add_view(bytes, target)},
                             {"componentType", type_float},
                             {"count", floats.size() / width},
                             {"type", type},
                             {"min", least},
                             {"max", most}});
  }

  void add_animation(Json animation) { add("animations", std::move(animation)); }

  [[nodiscard]] std::string text(GltfForm form) const {
    Json json = json_;
    Json buffer = {{"byteLength", buffer_.size()}};
    if (form == GltfForm::text) buffer["uri"] = "data:application/octet-stream;base64," + base64(buffer_);
    if (!buffer_.empty()) json["buffers"] = {std::move(buffer)};
    std::string text = json.dump(form == GltfForm::text ? 1 : -1, ' ', false, Json::error_handler_t::replace);
    if (form == GltfForm::text) return text + '\n';
    // A header of 12 bytes, then a chunk of JSON and one of numbers, each of a multiple of four bytes.
    constexpr std::uint32_t magic = 0x46546C67;
    constexpr std::uint32_t json_chunk = 0x4E4F534A;
    constexpr std::uint32_t binary_chunk = 0x004E4942;
    while (text.size() % 4 != 0) text += ' ';
    std::string out;
    put(magic, out);
    put(2, out);
    put(static_cast<std::uint32_t>(12 + 8 + text.size() + (buffer_.empty() ? 0 : 8 + buffer_.size())), out);
    put(static_cast<std::uint32_t>(text.size()), out);
    put(json_chunk, out);
    out += text;
    if (!buffer_.empty()) {
      put(static_cast<std::uint32_t>(buffer_.size()), out);
      put(binary_chunk, out);
      out += buffer_;
    }
    return out;
  }

 private:
  static void put(std::uint32_t value, std::string& to) {
    for (const unsigned shift : {0U, 8U, 16U, 24U}) to += static_cast<char>((value >> shift) & 255U);
  }

  std::size_t add(const char* list, Json entry) {
    Json& all = json_[list];
    all.push_back(std::move(entry));
    return all.size() - 1;
  }

  std::size_t add_indices(const std::vector<std::uint32_t>& indices) {
    std::string bytes;
    bytes.reserve(4 * indices.size());
    for (const std::uint32_t i : indices) put(i, bytes);
    return add("accessors", {{"bufferView", add_view(bytes, target_indices)},
                             {"componentType", type_unsigned},
                             {"count", indices.size()},
                             {"type", "SCALAR"}});
  }

  /// All numbers have four bytes, so views stay aligned.
  std::size_t add_view(const std::string& bytes, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    buffer_ += bytes;
    if (buffer_.size() > most_bytes) throw Error("glTF: the scene has more than 4 GB of triangles");
    return add("bufferViews", std::move(view));
  }

  static constexpr std::size_t most_bytes = 0xF0000000;
  Json json_ = Json::object();
  std::string buffer_;
  std::size_t root_ = 0;
};

/// A problem's scene in a document.
class SceneDocument {
 public:
  explicit SceneDocument(const Problem& problem, const TrajectorySettings& settings = {})
      : problem_(problem), world_(*spatial_world(*problem.scene)), settings_(settings) {
    add_world();
    add_end("start", problem.start, draw::rgb(0x555555));
    for (std::size_t i = 0; i < problem.goals.size(); ++i) {
      add_end(i == 0 ? "goal" : fmt::format("goal {}", i + 1), problem.goals[i],
              draw::rgb(0xFFFFFF).faded(goal_opacity));
    }
  }

  void add_level(const LevelRecord& record) {
    const Configurations& path = record.solution.path;
    if (!has_positions(record)) return;
    const std::string name = fmt::format("level {}: {}", record.level, printable(record.name));
    const std::size_t node = document_.add_child(document_.root(), {{"name", name}});
    if (path.size() == 0) return;
    const draw::Colour colour = draw::palette::level(static_cast<std::size_t>(std::max(0, record.level)));
    const std::size_t material = document_.add_material(name, colour, false);
    const ManipulatorScene* manipulator = record.scene->manipulator();
    const Configurations shown = manipulator != nullptr ? dense(record.space, path) : path;
    std::vector<std::vector<draw::Point3>> curves(positions_in(record, path[0]).size());
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const std::vector<draw::Point3> positions = positions_in(record, shown[i]);
      for (std::size_t k = 0; k < curves.size(); ++k) curves[k].push_back(positions[k]);
    }
    for (std::size_t k = 0; k < curves.size() && shown.size() > 1; ++k) {
      const std::string path_name =
          curves.size() == 1 ? name + ", path" : fmt::format("{}, path of robot {}", name, k + 1);
      document_.add_child(node, {{"name", path_name},
                                 {"mesh", document_.add_mesh(path_name, curves[k], {}, mode_line_strip, material)}});
    }
    const std::vector<draw::Point3>& curve = curves.front();
    if (manipulator != nullptr) {
      if (record.places_robot && record.space.flat() && problem_.motion_model == nullptr &&
          record.space.dimension() == record.scene->robot_dimension()) {
        const TimedPath timed(record.space, path, rate_limits(*record.scene, record.space, settings_));
        Configurations places(record.space.dimension());
        std::vector<double> times;
        for (const TimedPath::Sample& sample : timed.samples(between_keys)) {
          places.push(sample.position);
          times.push_back(sample.time);
        }
        add_bodies(node, name, colour, manipulator->robot, places, times, true);
      } else {
        add_bodies(node, name, colour, manipulator->robot, shown, lengths(record.space, shown), false);
      }
      return;
    }
    const Robot3& robot = spatial(*record.scene).robot;
    if (!robot.members().empty()) {
      const std::vector<double> at = lengths(record.space, path);
      for (const Robot3::Member& member : robot.members()) {
        const std::string body = fmt::format("{}, robot {}", name, member.number);
        std::vector<Pose3> places;
        places.reserve(path.size());
        for (std::size_t i = 0; i < path.size(); ++i) {
          places.push_back(member.robot->pose(member.own(own_coordinates(record, path[i]))));
        }
        animate(body, add_body(node, body, *member.robot, places.front(), colour), places, at, member.robot->rotates());
      }
      return;
    }
    const bool moves = !robot.is_point() && record.space.dimension() >= robot.dimension();
    Json first = {{"name", name + ", robot"},
                  {"mesh", moves ? robot_mesh(robot, name, colour) : mark_mesh(name, material)},
                  {"translation", vector_json(Vec3{curve[0].x, curve[0].y, curve[0].z})}};
    if (moves && robot.rotates()) first["rotation"] = vector_json(normalised(robot.pose(path[0]).orientation));
    const std::size_t body = document_.add_child(node, std::move(first));
    std::vector<Pose3> places;
    places.reserve(path.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      places.push_back({{curve[i].x, curve[i].y, curve[i].z}, moves ? robot.pose(path[i]).orientation : Quaternion{}});
    }
    animate(name, body, places, lengths(record.space, path), moves && robot.rotates());
  }

  [[nodiscard]] std::string text(GltfForm form) const { return document_.text(form); }

 private:
  static constexpr double goal_opacity = 0.55;
  static constexpr double between_keys = 0.05;  ///< seconds, at most

  void add_world() {
    const std::size_t world = document_.add_child(document_.root(), {{"name", printable(problem_.name)}});
    const std::size_t material = document_.add_material("obstacle", draw::rgb(0xC9C9C9), false);
    const std::size_t open = document_.add_material("obstacle without an inside", draw::rgb(0xC9C9C9), true);
    std::map<const Mesh*, std::size_t> known;  // only looked up, so its order does not matter
    for (const Obstacle3& obstacle : world_.obstacles()) {
      const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&obstacle.solid.shape);
      const auto place = mesh != nullptr ? known.find(mesh->get()) : known.end();
      std::size_t index = 0;
      if (place != known.end()) {
        index = place->second;
      } else {
        const draw::Surface surface = surface_of(Solid{obstacle.solid.shape, {}});
        index = document_.add_mesh(printable(obstacle.name), surface, surface.closed ? material : open);
        if (mesh != nullptr) known.emplace(mesh->get(), index);
      }
      document_.add_child(world, {{"name", printable(obstacle.name)},
                                  {"mesh", index},
                                  {"translation", vector_json(obstacle.solid.pose.position)},
                                  {"rotation", vector_json(normalised(obstacle.solid.pose.orientation))}});
    }
    add_bounds(world);
  }

  void add_bounds(std::size_t world) {
    const auto& [lo, hi] = world_.bounds();
    std::vector<draw::Point3> corners;
    std::vector<std::uint32_t> edges;
    for (std::uint32_t i = 0; i < 8; ++i) {
      corners.push_back({(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z});
      for (const std::uint32_t bit : {1U, 2U, 4U}) {
        if ((i & bit) == 0) edges.insert(edges.end(), {i, i | bit});
      }
    }
    const std::size_t material = document_.add_material("bounds", draw::rgb(0x8C8C8C), false);
    document_.add_child(
        world, {{"name", "bounds"}, {"mesh", document_.add_mesh("bounds", corners, edges, mode_lines, material)}});
  }

  std::size_t robot_mesh(const Robot3& robot, const std::string& name, const draw::Colour& colour) {
    const draw::Surface surface = surface_of(robot);
    return document_.add_mesh(name, surface, document_.add_material(name + ", robot", colour, !surface.closed));
  }

  /// The mesh of a point that moves.
  std::size_t mark_mesh(const std::string& name, std::size_t material) {
    constexpr double share = 0.004;  // of the world's diagonal
    constexpr unsigned sides = 12;
    return document_.add_mesh(name, surface_of(Solid{Sphere{share * problem_.scene->diagonal()}, {}}, sides), material);
  }

  void add_end(const std::string& name, const Configuration& q, const draw::Colour& colour) {
    if (q.empty()) return;
    if (const ManipulatorScene* manipulator = problem_.scene->manipulator()) {
      const std::size_t node = document_.add_child(document_.root(), {{"name", name}});
      Configurations one(q.size());
      one.push(q);
      add_bodies(node, name, colour, manipulator->robot, one, {0.0}, false);
      return;
    }
    const Robot3& robot = spatial(*problem_.scene).robot;
    if (!robot.members().empty()) {
      const std::size_t node = document_.add_child(document_.root(), {{"name", name}});
      for (const Robot3::Member& member : robot.members()) {
        add_body(node, fmt::format("{}, robot {}", name, member.number), *member.robot,
                 member.robot->pose(member.own(q)), colour);
      }
      return;
    }
    const Pose3 pose = robot.pose(q);
    const std::size_t mesh = robot.is_point() ? mark_mesh(name, document_.add_material(name, colour, false))
                                              : robot_mesh(robot, name, colour);
    document_.add_child(document_.root(), {{"name", name},
                                           {"mesh", mesh},
                                           {"translation", vector_json(pose.position)},
                                           {"rotation", vector_json(normalised(pose.orientation))}});
  }

  /// Adds a body of a team at a pose.
  std::size_t add_body(std::size_t node, const std::string& name, const Robot3& robot, const Pose3& pose,
                       const draw::Colour& colour) {
    return document_.add_child(node, {{"name", name},
                                      {"mesh", robot_mesh(robot, name, colour)},
                                      {"translation", vector_json(pose.position)},
                                      {"rotation", vector_json(normalised(pose.orientation))}});
  }

  /// A path with so many more points that straight motions of the bodies between them deviate little.
  static Configurations dense(const Space& space, const Configurations& path) {
    constexpr int points_of_leg = 12;
    Configurations out(space.dimension());
    Configuration q(space.dimension());
    out.push(path[0]);
    for (std::size_t i = 1; i < path.size(); ++i) {
      for (int k = 1; k <= points_of_leg; ++k) {
        space.interpolate(path[i - 1], path[i], static_cast<double>(k) / points_of_leg, q);
        out.push(q);
      }
    }
    return out;
  }

  /// The length of a path up to each of its points.
  static std::vector<double> lengths(const Space& space, const Configurations& path) {
    std::vector<double> out = {0.0};
    for (std::size_t i = 1; i < path.size(); ++i) out.push_back(out.back() + space.distance(path[i - 1], path[i]));
    return out;
  }

  /// Adds the bodies of a robot of links and joints, which move along a path.
  /// \param at      of each configuration its time, or the length of the path up to it
  /// \param timed   whether it is the time, in seconds
  void add_bodies(std::size_t node, const std::string& name, const draw::Colour& colour, const SphereModel& model,
                  const Configurations& path, const std::vector<double>& at, bool timed) {
    const std::size_t material = document_.add_material(name + ", robot", colour, false);
    std::vector<std::vector<Pose3>> poses(path.size());
    for (std::size_t i = 0; i < path.size(); ++i) model.robot().poses(path[i], poses[i]);
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      if (model.bodies()[b].empty()) continue;
      std::vector<Pose3> places;
      places.reserve(path.size());
      for (const auto& all : poses) places.push_back(model.base() * all[b]);
      const std::string body = fmt::format("{}, {}", name, printable(model.robot().bodies()[b].name));
      const std::size_t child =
          document_.add_child(node, {{"name", body},
                                     {"mesh", document_.add_mesh(body, surface_of(model, b), material)},
                                     {"translation", vector_json(places.front().position)},
                                     {"rotation", vector_json(normalised(places.front().orientation))}});
      animate(body, child, places, at, true, timed);
    }
  }

  /// Animates a node along a path: positions and rotations between keys are those of the space, which the format
  /// interpolates alike.
  /// \param at     of each place its time in seconds, or the length of the path up to it
  /// \param timed  whether it is the time; else the animation takes 10 s
  void animate(const std::string& name, std::size_t node, const std::vector<Pose3>& path, const std::vector<double>& at,
               bool rotates, bool timed = false) {
    const double length = at.back();
    if (!(length > 0.0)) return;
    std::vector<double> times;
    std::vector<double> places;
    std::vector<double> turns;
    Quaternion last;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const auto time = static_cast<double>(static_cast<float>(timed ? at[i] : seconds * at[i] / length));
      // Keys are later than the ones before, also in 32 bits.
      if (!times.empty() && !(time > times.back())) continue;
      times.push_back(time);
      const Vec3& place = path[i].position;
      places.insert(places.end(), {place.x, place.y, place.z});
      if (!rotates) continue;
      Quaternion turn = normalised(path[i].orientation);
      // Of q and -q the one nearer to the key before, so that the turn between them is the shorter one.
      if (i > 0 && turn.x * last.x + turn.y * last.y + turn.z * last.z + turn.w * last.w < 0.0) {
        turn = {-turn.x, -turn.y, -turn.z, -turn.w};
      }
      last = turn;
      turns.insert(turns.end(), {turn.x, turn.y, turn.z, turn.w});
    }
    const std::size_t input = document_.add_floats(times, "SCALAR", 1, 0);
    Json samplers = {
        {{"input", input}, {"interpolation", "LINEAR"}, {"output", document_.add_floats(places, "VEC3", 3, 0)}}};
    Json channels = {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}};
    if (rotates) {
      samplers.push_back(
          {{"input", input}, {"interpolation", "LINEAR"}, {"output", document_.add_floats(turns, "VEC4", 4, 0)}});
      channels.push_back({{"sampler", 1}, {"target", {{"node", node}, {"path", "rotation"}}}});
    }
    document_.add_animation({{"name", name}, {"channels", std::move(channels)}, {"samplers", std::move(samplers)}});
  }

  const Problem& problem_;
  const World3& world_;
  TrajectorySettings settings_;
  Document document_;
};

}  // namespace

GltfForm gltf_form(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".gltf") return GltfForm::text;
  if (ending == ".glb") return GltfForm::binary;
  throw Error(fmt::format("glTF: a name ends with .gltf or .glb, got '{}'", path));
}

std::string gltf(const Problem& problem, GltfForm form) { return SceneDocument(problem).text(form); }

std::string gltf(const Problem& problem, const RunResult& run, GltfForm form, const TrajectorySettings& settings) {
  SceneDocument document(problem, settings);
  for (auto level = run.levels.rbegin(); level != run.levels.rend(); ++level) document.add_level(level->record);
  return document.text(form);
}

std::vector<std::string> write_gltf(const Experiment& experiment, const ExperimentResult& result,
                                    const std::string& directory, const TrajectorySettings& settings) {
  std::vector<std::string> left_out;
  Directories problems;
  for (const Problem& problem : experiment.problems) {
    const std::filesystem::path folder = std::filesystem::path(directory) / problems(problem.name);
    if (problem.scene == nullptr || spatial_world(*problem.scene) == nullptr) {
      left_out.push_back(fmt::format("{}: no glTF, its world is planar", problem.name));
      continue;
    }
    make_directory(folder.string());
    Directories strategies;
    for (const auto& entry : experiment.strategies) {
      const std::string file = strategies(entry.first) + ".glb";
      const auto runs = select_runs(result, problem.name, entry.first);
      if (runs.empty()) continue;
      const auto solved = std::find_if(runs.begin(), runs.end(), [](const RunResult* run) { return run->run.solved; });
      write_file((folder / file).string(),
                 gltf(problem, **(solved != runs.end() ? solved : runs.begin()), GltfForm::binary, settings),
                 Flush::none);
    }
  }
  return left_out;
}

}  // namespace trellis
