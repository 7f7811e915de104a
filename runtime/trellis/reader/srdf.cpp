// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <trellis/base/errors.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/reader/robot_root.hpp>
#include <trellis/reader/unused.hpp>
#include <trellis/reader/xml_entry.hpp>

namespace trellis {

namespace {

XmlEntry srdf_root(const SourceText& text) {
  XmlEntry robot = robot_root(text, "an SRDF file");
  if (robot.child("link") && !robot.child("group")) {
    throw robot.error(R"(it is a URDF file, which has links: robot.urdf("FILE.urdf", { srdf = "FILE.srdf" }))");
  }
  return robot;
}

class SrdfReader {
 public:
  SrdfReader(const SourceText& text, const KinematicTree& tree)
      : text_(text), tree_(tree), robot_(srdf_root(text)), groups_(robot_.children("group")) {
    for (std::size_t i = 0; i < tree.links().size(); ++i) links_.emplace(tree.links()[i].name, i);
    for (std::size_t j = 0; j < tree.joints().size(); ++j) joints_.emplace(tree.joints()[j].name, j);
    for (const XmlEntry& joint : robot_.children("virtual_joint")) {
      joint.skip({"type", "parent_frame", "child_link"});
      if (joint.has("name")) virtual_.insert(joint.word("name"));
      if (joint.has("parent_frame")) file_.world_frame = joint.word("parent_frame");
    }
    // The ends of arms are links of groups, which `reach` and `attach` name.
    robot_.skip({"name", "version", "end_effector"});
  }

  SrdfFile read() {
    if (groups_.size() > most_groups) {
      throw groups_[most_groups].error(fmt::format("more than {} groups", most_groups));
    }
    read_groups();
    for (const XmlEntry& entry : robot_.children("group_state")) {
      warn_of_fault(entry, "the state", [&] { read_state(entry); });
    }
    read_pairs();
    for (const XmlEntry& entry : robot_.children("passive_joint")) {
      // Of a virtual joint, or of another model of the robot, it says nothing here.
      const std::string name = entry.has("name") ? entry.word("name") : "";
      if (const auto known = joints_.find(name); known != joints_.end()) {
        file_.passive.emplace_back(known->second, entry.line());
      }
    }
    for (std::string& warning : unused_warnings(text_, robot_.unused())) file_.warnings.push_back(std::move(warning));
    return std::move(file_);
  }

 private:
  template <class Part>
  static std::vector<std::string> names_of(const std::vector<Part>& parts) {
    std::vector<std::string> names;
    names.reserve(parts.size());
    for (const Part& part : parts) names.push_back(part.name);
    return names;
  }

  /// Reads an element; where that fails, the element is left out by a warning. Returns the fault, "" without one.
  template <class Read>
  std::string warn_of_fault(const XmlEntry& entry, const char* what, const Read& read) {
    try {
      read();
    } catch (const Error& error) {
      file_.warnings.push_back(fmt::format("{}; {} is left out", error.what(), what));
      entry.skip_inside();
      return error.what();
    }
    return "";
  }

  void read_groups() {
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      warn_of_fault(groups_[i], "the group", [&] {
        const std::string name = groups_[i].word("name");
        if (group_numbers_.emplace(name, i).second) return;
        const std::string fault = fmt::format("a second group is called '{}'", name);
        file_.faults.emplace(name, groups_[i].error(fault).what());
        throw groups_[i].error(fault);
      });
    }
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const auto named = std::find_if(group_numbers_.begin(), group_numbers_.end(),
                                      [&](const auto& group) { return group.second == i; });
      if (named == group_numbers_.end()) continue;
      const std::string fault = warn_of_fault(groups_[i], "the group", [&] {
        std::map<std::string, bool> open;
        std::set<std::size_t> joints;
        add_group(groups_[i], joints, open);
        file_.groups.push_back({named->first, {joints.begin(), joints.end()}});
      });
      if (!fault.empty()) file_.faults.emplace(named->first, fault);
    }
  }

  void read_pairs() {
    std::set<std::pair<std::size_t, std::size_t>> pairs;
    // Files of a robot's other models name links that this one lacks.
    std::set<std::string> unknown;
    const auto known = [&](const std::string& name) {
      const auto found = links_.find(name);
      if (found == links_.end()) unknown.insert(name);
      return found == links_.end() ? std::nullopt : std::optional(found->second);
    };
    for (const XmlEntry& entry : robot_.children("disable_default_collisions")) {
      warn_of_fault(entry, "the element", [&] {
        const auto link = known(entry.word("link"));
        for (std::size_t other = 0; link && other < tree_.links().size(); ++other) {
          if (other != *link) pairs.insert({std::min(*link, other), std::max(*link, other)});
        }
      });
    }
    const auto each = [&](const char* kind, const auto& act) {
      for (const XmlEntry& entry : robot_.children(kind)) {
        warn_of_fault(entry, "the pair", [&] {
          entry.skip({"reason"});
          const auto a = known(entry.word("link1"));
          const auto b = known(entry.word("link2"));
          if (a && b) act(std::pair(std::min(*a, *b), std::max(*a, *b)));
        });
      }
    };
    each("enable_collisions", [&](const auto& pair) { pairs.erase(pair); });
    each("disable_collisions", [&](const auto& pair) { pairs.insert(pair); });
    if (!unknown.empty()) {
      file_.warnings.push_back(
          fmt::format("{}: pairs of links that the robot lacks are ignored: {}", text_.path, fmt::join(unknown, ", ")));
    }
    file_.disabled.assign(pairs.begin(), pairs.end());
  }

  [[nodiscard]] std::size_t link(const XmlEntry& entry, const char* attribute) const {
    const std::string name = entry.word(attribute);
    if (const auto found = links_.find(name); found != links_.end()) return found->second;
    throw entry.error(fmt::format("the robot has no link '{}'{}", name, did_you_mean(name, names_of(tree_.links()))));
  }
  [[nodiscard]] std::size_t joint(const XmlEntry& entry, const char* attribute) const {
    const std::string name = entry.word(attribute);
    if (const auto found = joints_.find(name); found != joints_.end()) return found->second;
    throw entry.error(fmt::format("the robot has no joint '{}'{}", name, did_you_mean(name, names_of(tree_.joints()))));
  }

  void add_joint(std::size_t j, std::set<std::size_t>& joints) const {
    if (tree_.joints()[j].width() > 0) joints.insert(j);
  }

  /// Adds the joints of a group, of its chains, links and groups.
  /// \param open  groups that were begun, and whether they contain this one
  void add_group(const XmlEntry& entry, std::set<std::size_t>& joints, std::map<std::string, bool>& open) const {
    const std::string name = entry.word("name");
    const auto [begun, added] = open.emplace(name, true);
    if (!added && begun->second) throw entry.error(fmt::format("group '{}' contains itself", name));
    if (!added) return;
    for (const XmlEntry& part : entry.children()) {
      const std::string kind = part.name();
      if (kind == "joint") {
        // The virtual joint connects the robot to the world: it is no joint of the URDF.
        if (!is_virtual(part.word("name"))) add_joint(joint(part, "name"), joints);
      } else if (kind == "link") {
        if (const auto j = tree_.joint_of(link(part, "name"))) add_joint(*j, joints);
      } else if (kind == "chain") {
        add_chain(part, joints);
      } else if (kind == "group") {
        const std::string inner = part.word("name");
        const auto found = group_numbers_.find(inner);
        if (found == group_numbers_.end()) {
          std::vector<std::string> known;
          for (const auto& [group, number] : group_numbers_) known.push_back(group);
          throw part.error(fmt::format("there is no group '{}'{}", inner, did_you_mean(inner, known)));
        }
        add_group(groups_[found->second], joints, open);
      }
    }
    begun->second = false;
  }

  void add_chain(const XmlEntry& part, std::set<std::size_t>& joints) const {
    const std::size_t base = link(part, "base_link");
    for (std::size_t at = link(part, "tip_link"); at != base;) {
      const auto j = tree_.joint_of(at);
      if (!j)
        throw part.error(
            fmt::format("no chain leads from '{}' to '{}'", part.word("base_link"), part.word("tip_link")));
      add_joint(*j, joints);
      at = tree_.joints()[*j].parent;
    }
  }

  [[nodiscard]] bool is_virtual(const std::string& name) const { return virtual_.contains(name); }

  void read_state(const XmlEntry& entry) {
    SrdfFile::State state{entry.word("name"), entry.word("group"), {}, entry.line()};
    const std::vector<std::string> known = names_of(file_.groups);
    if (std::find(known.begin(), known.end(), state.group) == known.end()) {
      throw entry.error(fmt::format("there is no group '{}'{}", state.group, did_you_mean(state.group, known)));
    }
    for (const XmlEntry& part : entry.children("joint")) {
      warn_of_fault(part, "the value", [&] { read_value(part, state); });
    }
    file_.states.push_back(std::move(state));
  }

  void read_value(const XmlEntry& part, SrdfFile::State& state) {
    if (is_virtual(part.word("name"))) {
      part.skip({"value"});
      return;
    }
    const std::size_t j = joint(part, "name");
    std::vector<double> values = part.numbers("value");
    const Joint& of = tree_.joints()[j];
    const std::size_t width = std::max<std::size_t>(1, of.width());
    if (values.size() != width) {
      throw part.error(
          fmt::format("joint '{}' has {} value{}, got {}", of.name, width, width == 1 ? "" : "s", values.size()));
    }
    if (of.limited() && !of.locked && !of.mimic && !(values[0] >= of.lo && values[0] <= of.hi)) {
      file_.warnings.push_back(
          fmt::format("{}:{}: in state '{}' joint '{}' is {:g}, outside of its limits [{:g}, {:g}]", text_.path,
                      part.line(), state.name, of.name, values[0], of.lo, of.hi));
    }
    state.values.emplace_back(j, std::move(values));
  }

  static constexpr std::size_t most_groups = 1000;

  const SourceText& text_;
  const KinematicTree& tree_;
  XmlEntry robot_;
  std::map<std::string, std::size_t> links_;
  std::map<std::string, std::size_t> joints_;
  std::map<std::string, std::size_t> group_numbers_;
  std::set<std::string> virtual_;
  std::vector<XmlEntry> groups_;
  SrdfFile file_;
};

}  // namespace

SrdfFile read_srdf(const std::string& path, const KinematicTree& tree) {
  const SourceText text = SourceText::load(path);
  return SrdfReader(text, tree).read();
}

SrdfOutline read_srdf_outline(const std::string& path) {
  const SourceText text = SourceText::load(path);
  const XmlEntry robot = srdf_root(text);
  const auto name_of = [](const XmlEntry& entry, const char* attribute) {
    return entry.has(attribute) ? entry.word(attribute) : std::string("?");
  };
  SrdfOutline outline;
  outline.robot = name_of(robot, "name");
  for (const XmlEntry& entry : robot.children("group")) {
    SrdfOutline::Part group{name_of(entry, "name"), {}, "", entry.line()};
    for (const XmlEntry& part : entry.children()) {
      group.of.push_back(part.name() == "chain"
                             ? fmt::format("chain {} to {}", name_of(part, "base_link"), name_of(part, "tip_link"))
                             : fmt::format("{} {}", part.name(), name_of(part, "name")));
    }
    outline.groups.push_back(std::move(group));
  }
  for (const XmlEntry& entry : robot.children("group_state")) {
    SrdfOutline::Part state{name_of(entry, "name"), {}, name_of(entry, "group"), entry.line()};
    for (const XmlEntry& part : entry.children("joint")) {
      state.of.push_back(fmt::format("{} {}", name_of(part, "name"), name_of(part, "value")));
    }
    outline.states.push_back(std::move(state));
  }
  outline.disabled = robot.children("disable_collisions").size();
  outline.enabled = robot.children("enable_collisions").size();
  for (const XmlEntry& entry : robot.children("disable_default_collisions")) {
    outline.default_links.push_back(name_of(entry, "link"));
  }
  return outline;
}

}  // namespace trellis
