// SPDX-License-Identifier: GPL-3.0-or-later
// What URDF and SRDF files share: their outermost element, and the files that are mistaken for them.
#include <trellis/reader/robot_root.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include <trellis/reader/unread.hpp>

namespace trellis {

namespace {

/// Whether a value has an expression that xacro replaces.
bool has_expression(std::string_view value) {
  if (value.find('$') == std::string_view::npos) return false;
  constexpr std::array<std::string_view, 7> begins = {"${",        "$(find ", "$(arg ",    "$(env ",
                                                      "$(optenv ", "$(eval ", "$(dirname)"};
  return std::any_of(begins.begin(), begins.end(),
                     [&](std::string_view begin) { return value.find(begin) != std::string_view::npos; });
}

/// \throws Error at the first element of xacro. Files that xacro has expanded may declare its namespace.
void require_expanded(const SourceText& text, const XmlEntry& robot) {
  const auto of_xacro = [](std::string_view name) { return name.starts_with("xacro:"); };
  if (const auto entry = robot.find(of_xacro, has_expression)) {
    throw entry->error(fmt::format("a xacro file: expand it first: {}", xacro_command(text.path)));
  }
}

}  // namespace

std::string xacro_command(const std::string& path) {
  std::filesystem::path name = std::filesystem::path(path).filename();
  const std::string kind = path.find(".srdf") != std::string::npos ? ".srdf" : ".urdf";
  while (!name.extension().empty()) name = name.stem();
  std::string expanded = name.string() + kind;
  if (std::filesystem::path(path).filename() == expanded) expanded = name.string() + "_expanded" + kind;
  return fmt::format("xacro {} > {}", path, expanded);
}

RobotFile robot_file(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const bool named = ending == ".urdf" || ending == ".srdf" || ending == ".xacro";
  if (!named && ending != ".xml") return RobotFile::none;
  const SourceText text = SourceText::load(path);
  try {
    const XmlEntry robot = robot_root(text, ending == ".srdf" ? "an SRDF file" : "a URDF file");
    return robot.child("link") || (ending != ".srdf" && !robot.child("group")) ? RobotFile::urdf : RobotFile::srdf;
  } catch (const Error&) {
    if (named) throw;
    return RobotFile::none;
  }
}

XmlEntry robot_root(const SourceText& text, const char* expected) {
  XmlEntry root = XmlEntry::root(text, "");
  if (root.name() != "robot") {
    const std::string known = known_xml(root.name());
    throw text.error(root.line(), fmt::format("the outermost element is no 'robot' but '{}'{}; {} is expected",
                                              root.name(), known.empty() ? "" : ": it is " + known, expected));
  }
  require_expanded(text, root);
  return root;
}

}  // namespace trellis
