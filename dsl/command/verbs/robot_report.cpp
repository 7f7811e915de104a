// SPDX-License-Identifier: GPL-3.0-or-later
// What is in the files of a robot of links and joints.
#include <dsl/command/verbs/robot_report.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include <nlohmann/json.hpp>

#include <trellis/base/error.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/reader/robot_root.hpp>

namespace trellis::command {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Returns the file beside another one that has the same name with another ending; "" without one.
std::string beside(const std::string& path, const char* ending) {
  const fs::path other = fs::path(path).replace_extension(ending);
  std::error_code fault;
  return fs::is_regular_file(other, fault) ? other.string() : "";
}

std::string unit_of(const Joint& joint) { return joint.kind == Joint::Kind::prismatic ? "m" : "rad"; }

std::string motion_text(const KinematicTree& tree, const Joint& joint) {
  if (joint.mimic) {
    return fmt::format("follows '{}', {:g} times, from {:g}", tree.joints()[joint.mimic->joint].name,
                       joint.mimic->multiplier, joint.mimic->offset);
  }
  if (joint.locked) return "stays where it is";
  if (!joint.limited()) return "";
  const std::string limits = fmt::format("{:.6g} to {:.6g} {}", joint.lo, joint.hi, unit_of(joint));
  return joint.plans() ? limits : limits + ": it cannot move";
}

/// The files of a robot, and their report.
class RobotReport {
 public:
  RobotReport(std::string shown, const std::string& urdf, const std::string& srdf)
      : shown_(std::move(shown)), urdf_path_(urdf), srdf_path_(srdf) {
    if (!urdf.empty()) urdf_ = read_urdf(urdf, {.leave_out_missing = true});
    if (srdf.empty()) return;
    outline_ = read_srdf_outline(srdf);
    if (urdf_) srdf_ = read_srdf(srdf, urdf_->tree);
  }

  [[nodiscard]] std::string text(const char* format) const {
    std::string text = fmt::format("{}: {}\n\n", shown_, format);
    const auto line = [&](const char* name, const std::string& value) {
      text += fmt::format("  {:<9} {}\n", name, value);
    };
    line("robot", fmt::format("'{}'", urdf_ ? urdf_->tree.name() : outline_->robot));
    if (urdf_) add_tree(line);
    if (outline_) add_groups(line);
    for (const std::string& warning : warnings()) line("warning", warning);
    line("use", use());
    return text;
  }

  [[nodiscard]] Json json(const char* format) const {
    Json document = {{"file", shown_}, {"format", format}, {"robot", urdf_ ? urdf_->tree.name() : outline_->robot}};
    if (urdf_) {
      const KinematicTree& tree = urdf_->tree;
      Json links = Json::array();
      for (const Link& link : tree.links()) links.push_back({{"name", link.name}, {"shapes", link.solids.size()}});
      Json joints = Json::array();
      for (const Joint& joint : tree.joints()) {
        Json one = {{"name", joint.name},
                    {"kind", to_string(joint.kind)},
                    {"parent", tree.links()[joint.parent].name},
                    {"child", tree.links()[joint.child].name},
                    {"line", urdf_->joint_lines.at(joint.name)},
                    {"plans", joint.plans()}};
        if (joint.limited() && !joint.locked) one["limits"] = {joint.lo, joint.hi};
        if (joint.mimic) {
          one["follows"] = {{"joint", tree.joints()[joint.mimic->joint].name},
                            {"multiplier", joint.mimic->multiplier},
                            {"offset", joint.mimic->offset}};
        }
        joints.push_back(std::move(one));
      }
      Json meshes = Json::array();
      for (const UrdfFile::MeshUse& mesh : urdf_->meshes) {
        meshes.push_back({{"file", mesh.uri},
                          {"link", mesh.link},
                          {"line", mesh.line},
                          {"path", mesh.path.empty() ? Json(nullptr) : Json(mesh.path)}});
      }
      document["links"] = links;
      document["joints"] = joints;
      document["meshes"] = meshes;
    }
    if (outline_) {
      Json groups = Json::array();
      for (const SrdfOutline::Part& group : outline_->groups) {
        Json one = {{"name", group.name}, {"of", group.of}, {"line", group.line}};
        if (srdf_) one["joints"] = joints_of(group.name);
        groups.push_back(std::move(one));
      }
      Json states = Json::array();
      for (const SrdfOutline::Part& state : outline_->states) {
        states.push_back({{"name", state.name}, {"group", state.group}, {"values", state.of}, {"line", state.line}});
      }
      document["groups"] = groups;
      document["states"] = states;
      document["disabled"] = srdf_ ? srdf_->disabled.size() : outline_->disabled;
    }
    document["warnings"] = warnings();
    document["use"] = use();
    return document;
  }

 private:
  template <class Line>
  void add_tree(const Line& line) const {
    const KinematicTree& tree = urdf_->tree;
    const auto shaped =
        std::count_if(tree.links().begin(), tree.links().end(), [](const Link& link) { return !link.solids.empty(); });
    line("links", fmt::format("{}, {} with collision geometry; the base is '{}'", tree.links().size(), shaped,
                              tree.links()[tree.base()].name));
    const auto fixed = std::count_if(tree.joints().begin(), tree.joints().end(),
                                     [](const Joint& joint) { return joint.kind == Joint::Kind::fixed; });
    const auto planned =
        std::count_if(tree.joints().begin(), tree.joints().end(), [](const Joint& joint) { return joint.plans(); });
    line("joints", fmt::format("{}, {} can plan, {} fixed", tree.joints().size(), planned, fixed));
    std::size_t widest = 0;
    for (const Joint& joint : tree.joints()) {
      if (joint.kind != Joint::Kind::fixed) widest = std::max(widest, joint.name.size());
    }
    for (const Joint& joint : tree.joints()) {
      if (joint.kind == Joint::Kind::fixed) continue;
      std::string value =
          fmt::format("{:<{}}  {:<10}  {}", joint.name, widest, to_string(joint.kind), motion_text(tree, joint));
      value.erase(value.find_last_not_of(' ') + 1);
      line("joint", value);
    }
    if (urdf_->meshes.empty()) return;
    std::set<std::string> files;
    std::set<std::string> missing;
    for (const UrdfFile::MeshUse& mesh : urdf_->meshes) (mesh.path.empty() ? missing : files).insert(mesh.uri);
    line("meshes", fmt::format("{} files found{}", files.size(),
                               missing.empty() ? "" : fmt::format(", {} not found", missing.size())));
  }

  template <class Line>
  void add_groups(const Line& line) const {
    if (urdf_) line("srdf", srdf_path_);
    for (const SrdfOutline::Part& group : outline_->groups) {
      std::string value = fmt::format("{}: {}", group.name, fmt::join(group.of, ", "));
      if (srdf_ && !srdf_->faults.contains(group.name)) {
        const std::vector<std::string> joints = joints_of(group.name);
        value += fmt::format(" ({} joint{}{}{})", joints.size(), joints.size() == 1 ? "" : "s",
                             joints.empty() ? "" : ": ", fmt::join(joints, " "));
      }
      line("group", value);
    }
    for (const SrdfOutline::Part& state : outline_->states) {
      line("state", fmt::format("{} of {}: {}", state.name, state.group, fmt::join(state.of, ", ")));
    }
    if (srdf_) {
      line("pairs", fmt::format("{} of links that may touch", srdf_->disabled.size()));
    } else {
      std::string value = fmt::format("{} of links that may touch", outline_->disabled);
      if (!outline_->default_links.empty()) {
        value += fmt::format(", and all of {} but for {} pairs", fmt::join(outline_->default_links, ", "),
                             outline_->enabled);
      }
      line("pairs", value);
    }
  }

  /// The joints of a group that have coordinates.
  [[nodiscard]] std::vector<std::string> joints_of(const std::string& group) const {
    std::vector<std::string> names;
    for (const SrdfFile::Group& one : srdf_->groups) {
      if (one.name != group) continue;
      for (const std::size_t j : one.joints) names.push_back(urdf_->tree.joints()[j].name);
    }
    return names;
  }

  [[nodiscard]] std::vector<std::string> warnings() const {
    std::vector<std::string> all;
    if (urdf_) all = urdf_->warnings;
    if (srdf_) all.insert(all.end(), srdf_->warnings.begin(), srdf_->warnings.end());
    return all;
  }

  /// How a script reads the robot.
  [[nodiscard]] std::string use() const {
    const std::string urdf = urdf_ ? fs::path(urdf_path_).filename().string() : "FILE.urdf";
    std::vector<std::string> options;
    if (outline_) options.push_back(fmt::format("srdf = \"{}\"", fs::path(srdf_path_).filename().string()));
    if (const std::string group = largest_group(); !group.empty()) {
      options.push_back(fmt::format("group = \"{}\"", group));
    }
    const bool missing = urdf_ && std::any_of(urdf_->meshes.begin(), urdf_->meshes.end(),
                                              [](const UrdfFile::MeshUse& mesh) { return mesh.path.empty(); });
    if (missing) options.emplace_back("missing_meshes = \"leave_out\"");
    if (options.empty()) return fmt::format("robot.urdf(\"{}\")", urdf);
    return fmt::format("robot.urdf(\"{}\", {{ {} }})", urdf, fmt::join(options, ", "));
  }

  /// The group with most joints, without the robot the first; "" without groups.
  [[nodiscard]] std::string largest_group() const {
    if (!outline_) return "";
    std::string group = outline_->groups.empty() ? "" : outline_->groups.front().name;
    std::size_t most = 0;
    for (const SrdfFile::Group& one : srdf_ ? srdf_->groups : std::vector<SrdfFile::Group>{}) {
      if (one.joints.size() <= most) continue;
      most = one.joints.size();
      group = one.name;
    }
    return group;
  }

  std::string shown_;
  std::string urdf_path_;
  std::string srdf_path_;
  std::optional<UrdfFile> urdf_;
  std::optional<SrdfOutline> outline_;
  std::optional<SrdfFile> srdf_;
};

}  // namespace

std::optional<std::string> robot_report(const std::string& path, const std::string& shown, const std::string& robot,
                                        bool json) {
  const RobotFile kind = robot_file(path);
  if (kind == RobotFile::none) return std::nullopt;
  const bool is_urdf = kind == RobotFile::urdf;
  const std::string urdf = is_urdf ? path : !robot.empty() ? robot : beside(path, ".urdf");
  const std::string srdf = is_urdf ? beside(path, ".srdf") : path;
  const RobotReport report(shown, urdf, srdf);
  const char* format = is_urdf ? "URDF, a robot of links and joints" : "SRDF, groups and states of a robot";
  return json ? report.json(format).dump(2) + "\n" : report.text(format);
}

}  // namespace trellis::command
