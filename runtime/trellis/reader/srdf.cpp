// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <trellis/base/errors.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/reader/xml_entry.hpp>

namespace trellis {

namespace {

class SrdfReader {
 public:
  SrdfReader(const SourceText& text, const KinematicTree& tree)
      : tree_(tree), robot_(XmlEntry::root(text, "robot")), groups_(robot_.children("group")) {
    for (std::size_t i = 0; i < tree.links().size(); ++i) links_.emplace(tree.links()[i].name, i);
    for (std::size_t j = 0; j < tree.joints().size(); ++j) joints_.emplace(tree.joints()[j].name, j);
    for (const XmlEntry& joint : robot_.children("virtual_joint")) {
      if (joint.has("name")) virtual_.insert(joint.word("name"));
    }
  }

  SrdfFile read() {
    if (groups_.size() > most_groups) {
      throw groups_[most_groups].error(fmt::format("more than {} groups", most_groups));
    }
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      errors_.attempt([&] {
        if (!group_numbers_.emplace(groups_[i].word("name"), i).second) {
          throw groups_[i].error(fmt::format("a second group is called '{}'", groups_[i].word("name")));
        }
      });
    }
    errors_.raise();
    for (const XmlEntry& entry : groups_) {
      errors_.attempt([&] {
        std::map<std::string, bool> open;
        std::set<std::size_t> joints;
        add_group(entry, joints, open);
        file_.groups.push_back({entry.word("name"), {joints.begin(), joints.end()}});
      });
    }
    for (const XmlEntry& entry : robot_.children("group_state")) errors_.attempt([&] { read_state(entry); });
    // Files of a robot's other models name links that this one lacks.
    std::set<std::string> unknown;
    for (const XmlEntry& entry : robot_.children("disable_collisions")) {
      errors_.attempt([&] {
        const std::string first = entry.word("link1");
        const std::string second = entry.word("link2");
        const auto a = links_.find(first);
        const auto b = links_.find(second);
        if (a == links_.end()) unknown.insert(first);
        if (b == links_.end()) unknown.insert(second);
        if (a == links_.end() || b == links_.end()) return;
        file_.disabled.emplace_back(std::min(a->second, b->second), std::max(a->second, b->second));
      });
    }
    if (!unknown.empty()) {
      file_.warnings.push_back(
          fmt::format("pairs of links that the robot lacks are ignored: {}", fmt::join(unknown, ", ")));
    }
    errors_.raise();
    std::sort(file_.disabled.begin(), file_.disabled.end());
    file_.disabled.erase(std::unique(file_.disabled.begin(), file_.disabled.end()), file_.disabled.end());
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
    SrdfFile::State state{entry.word("name"), entry.word("group"), {}};
    const std::vector<std::string> known = names_of(file_.groups);
    if (std::find(known.begin(), known.end(), state.group) == known.end()) {
      throw entry.error(fmt::format("there is no group '{}'{}", state.group, did_you_mean(state.group, known)));
    }
    for (const XmlEntry& part : entry.children("joint")) {
      if (is_virtual(part.word("name"))) continue;
      const std::size_t j = joint(part, "name");
      state.values.emplace_back(j, std::vector<double>{part.number("value")});
    }
    file_.states.push_back(std::move(state));
  }

  static constexpr std::size_t most_groups = 1000;

  const KinematicTree& tree_;
  XmlEntry robot_;
  std::map<std::string, std::size_t> links_;
  std::map<std::string, std::size_t> joints_;
  std::map<std::string, std::size_t> group_numbers_;
  std::set<std::string> virtual_;
  std::vector<XmlEntry> groups_;
  SrdfFile file_;
  ErrorList errors_;
};

}  // namespace

SrdfFile read_srdf(const std::string& path, const KinematicTree& tree) {
  const SourceText text = SourceText::load(path);
  return SrdfReader(text, tree).read();
}

}  // namespace trellis
