// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_formats.hpp>
#include <trellis/reader/spatial_formats.hpp>
#include <trellis/reader/vrml.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;
using Node = tinyxml2::XMLElement;

/// An XML file.
class Document {
 public:
  Document(const SourceText& text, const char* root) : source_(text), xml_(std::make_unique<tinyxml2::XMLDocument>()) {
    const std::string all = source_.joined();
    xml_->Parse(all.data(), all.size());
    if (xml_->Error()) {
      throw source_.error(line_at(xml_->ErrorLineNum()), fmt::format("it is no XML file ({})", xml_->ErrorName()));
    }
    root_ = xml_->FirstChildElement(root);
    if (root_ == nullptr) throw source_.error(1, fmt::format("expected the element <{}>", root));
  }

  [[nodiscard]] const Node& root() const { return *root_; }
  [[nodiscard]] const std::string& path() const { return source_.path; }
  [[nodiscard]] Error error(const Node& node, const std::string& fault) const {
    return source_.error(line_at(node.GetLineNum()), fault);
  }
  [[nodiscard]] const Node& child(const Node& node, const char* name) const {
    const Node* found = node.FirstChildElement(name);
    if (found == nullptr) throw error(node, fmt::format("<{}> has no <{}>", node.Name(), name));
    return *found;
  }
  [[nodiscard]] std::string attribute(const Node& node, const char* name) const {
    const char* value = node.Attribute(name);
    if (value == nullptr) throw error(node, fmt::format("<{}> has no attribute '{}'", node.Name(), name));
    return value;
  }
  [[nodiscard]] double number(const Node& node) const {
    const char* text = node.GetText();
    std::string_view line = text != nullptr ? text : "";
    const auto value = number_in(take_word(line));
    if (!value || !std::isfinite(*value) || !take_word(line).empty()) {
      throw error(node, fmt::format("<{}> needs a number", node.Name()));
    }
    return *value;
  }
  /// The numbers of all children of one name.
  [[nodiscard]] std::vector<double> numbers(const Node& node, const char* name, std::size_t wanted) const {
    std::vector<double> all;
    for (const Node* at = node.FirstChildElement(name); at != nullptr; at = at->NextSiblingElement(name)) {
      all.push_back(number(*at));
    }
    if (all.size() != wanted) {
      throw error(node, fmt::format("<{}> needs {} elements <{}>, got {}", node.Name(), wanted, name, all.size()));
    }
    return all;
  }

 private:
  static std::size_t line_at(int line) { return line < 1 ? 1 : static_cast<std::size_t>(line); }

  SourceText source_;
  std::unique_ptr<tinyxml2::XMLDocument> xml_;
  const Node* root_ = nullptr;
};

/// A body with six degrees of freedom, of rlmdl.
struct Kinematics {
  std::string body;
  Box3 bounds;
};

bool is_zero(const Document& document, const Node& node, const char* part) {
  const Node* vector = node.FirstChildElement(part);
  if (vector == nullptr) return true;
  constexpr std::array<const char*, 3> axes{"x", "y", "z"};
  return std::all_of(axes.begin(), axes.end(),
                     [&](const char* axis) { return document.number(document.child(*vector, axis)) == 0.0; });
}

Kinematics read_kinematics(const std::string& path) {
  const Document document(SourceText::load(path), "rlmdl");
  const Node& model = document.child(document.root(), "model");
  const Node& world = document.child(model, "world");
  if (!is_zero(document, world, "rotation") || !is_zero(document, world, "translation")) {
    throw document.error(world, "a world that is moved or turned is not read");
  }
  for (const char* joint : {"revolute", "prismatic", "spherical", "cylindrical", "helical"}) {
    if (const Node* found = model.FirstChildElement(joint)) {
      throw document.error(*found,
                           fmt::format("<{}>: only a body with six degrees of freedom (sixDof) is read", joint));
    }
  }
  const Node& joint = document.child(model, "sixDof");
  if (joint.NextSiblingElement("sixDof") != nullptr) {
    throw document.error(*joint.NextSiblingElement("sixDof"), "a second <sixDof>: only one body is read");
  }
  const Node& frame = document.child(joint, "frame");
  const std::string from = document.attribute(document.child(frame, "a"), "idref");
  if (from != document.attribute(world, "id")) {
    throw document.error(frame, fmt::format("the joint must begin at the world, not at '{}'", from));
  }
  const auto lo = document.numbers(joint, "min", 3), hi = document.numbers(joint, "max", 3);
  return {document.attribute(document.child(frame, "b"), "idref"), {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}}};
}

/// Reads x y z and a quaternion x y z w, which files give in about eight digits.
Pose3 pose_of(const Document& document, const Node& node) {
  const auto q = document.numbers(node, "q", 7);
  const double length = std::hypot(std::hypot(q[3], q[4]), std::hypot(q[5], q[6]));
  constexpr double rounding = 1e-3;
  if (!(std::abs(length - 1.0) < rounding)) {
    throw document.error(node, fmt::format("<{}>: the last four numbers must be a quaternion of norm 1, got norm {}",
                                           node.Name(), length));
  }
  return {{q[0], q[1], q[2]}, normalised({q[3], q[4], q[5], q[6]})};
}

/// The scene of rlsg: a file in VRML, and the names of its models.
struct Models {
  std::vector<VrmlShape> shapes;
  std::string robot;  ///< the name of the model that moves
};

Models read_models(const std::string& path, double index) {
  const Document document(SourceText::load(path), "rlsg");
  const Node& scene = document.child(document.root(), "scene");
  Models models;
  const Node* model = scene.FirstChildElement("model");
  for (double i = 0; i < index && model != nullptr; ++i) model = model->NextSiblingElement("model");
  if (model == nullptr) throw document.error(scene, fmt::format("the scene has no model {} (counted from 0)", index));
  models.robot = document.attribute(*model, "name");
  models.shapes = read_vrml(beside(path, document.attribute(scene, "href")));
  return models;
}

/// The place of a name among the nodes that a shape lies in.
std::size_t place_of(const VrmlShape& shape, const std::string& name) {
  return static_cast<std::size_t>(std::find(shape.groups.begin(), shape.groups.end(), name) - shape.groups.begin());
}

}  // namespace

bool is_rl_plan(const SourceText& text) {
  return std::any_of(text.lines.begin(),
                     text.lines.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(text.lines.size(), 20)),
                     [](const std::string& line) { return line.find("<rlplan") != std::string::npos; });
}

SceneFile read_rl_plan(const SourceText& text, const ReadOptions& options) {
  const Document document(text, "rlplan");
  const Node* planner = document.root().FirstChildElement();
  if (planner == nullptr) throw document.error(document.root(), "<rlplan> has no planner");
  const Node& model = document.child(*planner, "model");
  const Node& kinematics_node = document.child(model, "kinematics");
  if (const std::string type = document.attribute(kinematics_node, "type"); type != "mdl") {
    throw document.error(kinematics_node,
                         fmt::format("kinematics of type {} are not read, only 'mdl'", in_quotes(type)));
  }
  const Kinematics kinematics = read_kinematics(beside(text.path, document.attribute(kinematics_node, "href")));
  const Node& scene = document.child(model, "scene");
  const Models models = read_models(beside(text.path, document.attribute(scene, "href")),
                                    document.number(document.child(model, "model")));
  std::vector<Solid> body;
  std::vector<Obstacle3> obstacles;
  for (const VrmlShape& shape : models.shapes) {
    if (place_of(shape, models.robot) == shape.groups.size()) {
      const std::string name = shape.groups.empty() ? "" : fmt::format(" ({})", shape.groups.back());
      obstacles.push_back({fmt::format("obstacle {}{}", obstacles.size() + 1, name), {shape.shape, shape.pose}});
      continue;
    }
    const std::size_t at = place_of(shape, kinematics.body);
    if (at == shape.groups.size()) {
      throw document.error(
          scene, fmt::format("a shape of the model '{}' is not part of its body '{}'", models.robot, kinematics.body));
    }
    body.push_back({shape.shape, shape.frames[at].inverse() * shape.pose});
  }
  if (body.empty()) {
    throw document.error(scene,
                         fmt::format("the model '{}' has no shape in a body '{}'", models.robot, kinematics.body));
  }
  SceneFile file;
  file.format = "plan of the Robotics Library";
  file.units = "1 unit = 1 m";
  file.frame = "the robot's reference point is the origin of its body";
  const Robot3 robot(models.robot, std::move(body));
  // The limits of the joint bound the reference point.
  Problem problem =
      spatial_problem(fs::path(text.path).stem().stem().stem().string(),
                      World3(kinematics.bounds, std::move(obstacles), Contain::reference), robot, options);
  problem.start = configuration_of(robot, pose_of(document, document.child(*planner, "start")));
  problem.goals = {configuration_of(robot, pose_of(document, document.child(*planner, "goal")))};
  file.problems.push_back(std::move(problem));
  return file;
}

}  // namespace trellis
