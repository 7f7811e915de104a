// SPDX-License-Identifier: GPL-3.0-or-later
// A robot from its URDF and SRDF files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <utility>

#include <trellis/base/errors.hpp>
#include <trellis/instance/link_shapes.hpp>
#include <trellis/reader/cover_cache.hpp>
#include <trellis/reader/robot_files.hpp>

namespace trellis {

namespace {

template <class Part>
std::vector<std::string> names_of(const std::vector<Part>& parts) {
  std::vector<std::string> names;
  names.reserve(parts.size());
  for (const Part& part : parts) names.push_back(part.name);
  return names;
}

std::size_t joint_named(const KinematicTree& tree, const std::string& name) {
  if (const auto found = tree.find_joint(name)) return *found;
  throw Error(
      fmt::format("robot '{}' has no joint '{}'{}", tree.name(), name, did_you_mean(name, names_of(tree.joints()))));
}

/// Why a joint with coordinates cannot plan, with file and line; "" where it can.
std::string fault_of(const ManipulatorFiles& files, const UrdfFile& urdf, const KinematicTree& tree, std::size_t j) {
  const Joint& joint = tree.joints()[j];
  if (const auto fault = urdf.faults.find(joint.name); fault != urdf.faults.end()) return fault->second;
  const auto line = urdf.joint_lines.find(joint.name);
  const std::string place =
      line == urdf.joint_lines.end() ? files.urdf : fmt::format("{}:{}", files.urdf, line->second);
  if (joint.carries_robot() && joint.parent != tree.base()) {
    return fmt::format("{}: joint '{}' is {} and does not move the base", place, joint.name, to_string(joint.kind));
  }
  if (!joint.plans()) {
    return fmt::format("{}: joint '{}' has the limits {:g} and {:g}: it cannot move", place, joint.name, joint.lo,
                       joint.hi);
  }
  return "";
}

std::vector<std::size_t> group_joints(const ManipulatorFiles& files, const KinematicTree& tree,
                                      const std::optional<SrdfFile>& srdf) {
  if (!srdf) {
    throw Error(
        fmt::format("group '{}': groups are defined in a SRDF file; name it as srdf = \"{}.srdf\", or list "
                    "the joints that move",
                    files.group, tree.name()));
  }
  if (const auto fault = srdf->faults.find(files.group); fault != srdf->faults.end()) throw Error(fault->second);
  const auto group = std::find_if(srdf->groups.begin(), srdf->groups.end(),
                                  [&](const SrdfFile::Group& one) { return one.name == files.group; });
  if (group == srdf->groups.end()) {
    const auto known = names_of(srdf->groups);
    throw Error(fmt::format("{}: there is no group '{}'{}; there are: {}", files.srdf, files.group,
                            did_you_mean(files.group, known), fmt::join(known, ", ")));
  }
  if (group->joints.empty()) {
    throw Error(fmt::format("{}: group '{}' has no joint that moves", files.srdf, files.group));
  }
  return group->joints;
}

/// \param warnings  receives the joints that cannot plan and stay where they are
std::vector<std::size_t> moving_joints(const ManipulatorFiles& files, const UrdfFile& urdf, const KinematicTree& tree,
                                       const std::optional<SrdfFile>& srdf, std::vector<std::string>& warnings) {
  std::vector<std::size_t> named;
  const bool listed = files.group.empty() && !files.joints.empty();
  if (!files.group.empty()) {
    named = group_joints(files, tree, srdf);
  } else if (listed) {
    ErrorList errors;
    for (const std::string& name : files.joints) errors.attempt([&] { named.push_back(joint_named(tree, name)); });
    errors.raise();
  } else {
    for (std::size_t j = 0; j < tree.joints().size(); ++j) {
      if (tree.joints()[j].width() > 0) named.push_back(j);
    }
  }
  std::vector<std::size_t> moving;
  std::string reasons;
  ErrorList errors;
  for (const std::size_t j : named) {
    const Joint& joint = tree.joints()[j];
    // Fixed joints and followers are refused by the robot, which says what they are.
    const std::string fault = joint.width() == 0 && !joint.locked ? "" : fault_of(files, urdf, tree, j);
    if (fault.empty()) {
      moving.push_back(j);
      continue;
    }
    if (listed || (!files.group.empty() && joint.locked)) {
      errors.add(Error(fault));
      continue;
    }
    reasons += "\n  " + fault;
    // The reader of the file has reported a locked joint.
    if (!joint.locked) warnings.push_back(fmt::format("{}; it stays where it is", fault));
  }
  errors.raise();
  if (files.base) moving.push_back(joint_named(tree, "base"));
  std::sort(moving.begin(), moving.end());
  moving.erase(std::unique(moving.begin(), moving.end()), moving.end());
  if (moving.empty()) {
    throw Error(fmt::format("{}: robot '{}' has no joint that moves{}{}", files.urdf, tree.name(),
                            reasons.empty() ? "" : ":", reasons));
  }
  return moving;
}

std::vector<std::vector<double>> values_of(const ManipulatorFiles& files, const KinematicTree& tree,
                                           const std::vector<std::size_t>& moving) {
  std::vector<std::vector<double>> values(tree.joints().size());
  ErrorList errors;
  for (const auto& [name, value] : files.values) {
    errors.attempt([&, &name = name, &value = value] {
      const std::size_t j = joint_named(tree, name);
      const Joint& joint = tree.joints()[j];
      if (std::binary_search(moving.begin(), moving.end(), j)) {
        throw Error(fmt::format("joint '{}' moves: it has no fixed value", name));
      }
      if (joint.width() != 1) throw Error(fmt::format("joint '{}' has no value of its own", name));
      if (joint.limited() && !(value >= joint.lo && value <= joint.hi)) {
        throw Error(
            fmt::format("joint '{}': {:g} is outside of its limits [{:g}, {:g}]", name, value, joint.lo, joint.hi));
      }
      values[j] = {value};
    });
  }
  errors.raise();
  return values;
}

/// Returns the configuration of the joints that move by a state; none where it does not place each of them.
std::optional<Configuration> configuration_of(const SrdfFile::State& state, const Manipulator& robot) {
  Configuration q;
  for (const std::size_t j : robot.moving()) {
    const Joint& joint = robot.tree().joints()[j];
    const auto found =
        std::find_if(state.values.begin(), state.values.end(), [&](const auto& value) { return value.first == j; });
    if (found != state.values.end() && found->second.size() == joint.width()) {
      q.insert(q.end(), found->second.begin(), found->second.end());
    } else if (joint.carries_robot()) {
      q.insert(q.end(), joint.width(), 0.0);
      if (joint.kind == Joint::Kind::floating) q.back() = 1.0;
    } else {
      return std::nullopt;
    }
  }
  return q;
}

/// The states that place each moving joint: of those with one name that of the group, else the first of a group with
/// the same joints, else the first.
std::vector<SphereModel::State> states_of(const SrdfFile& srdf, const std::string& group, const Manipulator& robot) {
  const auto rank = [&](const SrdfFile::State& state) {
    if (state.group == group) return 0;
    const bool same = std::any_of(srdf.groups.begin(), srdf.groups.end(), [&](const SrdfFile::Group& one) {
      return one.name == state.group && one.joints == robot.moving();
    });
    return same ? 1 : 2;
  };
  std::vector<SphereModel::State> states;
  std::vector<int> ranks;
  for (const SrdfFile::State& state : srdf.states) {
    auto q = configuration_of(state, robot);
    if (!q) continue;
    const int own = rank(state);
    const auto known = std::find_if(states.begin(), states.end(),
                                    [&](const SphereModel::State& other) { return other.name == state.name; });
    const auto place = static_cast<std::size_t>(known - states.begin());
    if (known == states.end()) {
      states.push_back({state.name, std::move(*q)});
      ranks.push_back(own);
    } else if (own < ranks[place]) {
      known->q = std::move(*q);
      ranks[place] = own;
    }
  }
  return states;
}

/// Names the pairs of links that are not checked because they touch in nearly every configuration.
std::string touching_warning(const ManipulatorFiles& files, const KinematicTree& tree,
                             const SphereModel::Pairs& touching) {
  std::vector<std::string> pairs;
  pairs.reserve(touching.size());
  for (const auto& [a, b] : touching) {
    pairs.push_back(fmt::format("'{}' and '{}'", tree.links()[a].name, tree.links()[b].name));
  }
  return fmt::format(
      "{}: pairs of links that touch in nearly every configuration are not checked against each other, "
      "though {}: {}",
      files.srdf.empty() ? files.urdf : files.srdf,
      files.srdf.empty() ? "no SRDF file disables them" : "the file does not disable them", fmt::join(pairs, ", "));
}

SphereModel::Pairs all_pairs(std::size_t links) {
  SphereModel::Pairs pairs;
  for (std::size_t a = 0; a < links; ++a) {
    for (std::size_t b = a + 1; b < links; ++b) pairs.emplace_back(a, b);
  }
  return pairs;
}

/// Names the links that touch at all configurations.
std::string standing_warning(const ManipulatorFiles& files, const KinematicTree& tree,
                             const std::vector<StandingContact>& contacts) {
  std::vector<std::string> pairs;
  for (const StandingContact& one : contacts) {
    pairs.push_back(fmt::format("'{}' meets '{}'", tree.links()[one.first].name, tree.links()[one.second].name));
    constexpr double in_cm = 100.0;
    if (one.distance > 0.0) pairs.back() += fmt::format(" (nearly: {:.2g} cm)", in_cm * one.distance);
  }
  return fmt::format(
      "{}: {} at the values of the joints that do not move: no configuration is valid; values = {{ JOINT = VALUE }} "
      "places these joints",
      files.urdf, fmt::join(pairs, ", "));
}

/// Says how many balls cover the links that are not made of spheres, and how far they protrude.
std::string excess_text(const KinematicTree& tree, const LinkCovers& covers) {
  const double usual = covers.options.excess;
  const auto centimetres = [](double metres) { return fmt::format("{:.1f} cm", 100.0 * metres); };
  std::vector<std::string> names;
  std::vector<std::pair<double, std::string>> more;  // links whose balls protrude more than usual
  std::size_t balls = 0;
  double excess = 0.0;
  for (std::size_t l = 0; l < covers.links.size(); ++l) {
    const MedialCover& link = covers.links[l];
    if (link.excess == 0.0) continue;
    names.push_back(tree.links()[l].name);
    balls += link.balls.size();
    if (link.excess > usual) {
      more.emplace_back(link.excess, names.back());
    } else {
      excess = std::max(excess, link.excess);
    }
  }
  if (names.empty()) return "";
  constexpr std::size_t most_named = 12;
  const std::string links = names.size() == 1            ? "link " + names.front()
                            : names.size() <= most_named ? fmt::format("links {}", fmt::join(names, ", "))
                                                         : fmt::format("{} links", names.size());
  std::string text = fmt::format("{} {} covered by {} balls", links, names.size() == 1 ? "is" : "are", balls);
  if (names.size() == 1) {
    return text + fmt::format(" that protrude at most {}", centimetres(more.empty() ? excess : more.front().first));
  }
  if (names.size() > more.size()) text += fmt::format(" that protrude at most {}", centimetres(excess));
  if (more.empty()) return text;
  // Those that protrude most.
  constexpr std::size_t most_excesses = 5;
  std::stable_sort(more.begin(), more.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < std::min(more.size(), most_excesses); ++i) {
    parts.push_back(fmt::format("of {} {}", more[i].second, centimetres(more[i].first)));
  }
  if (more.size() > most_excesses) {
    parts.push_back(
        fmt::format("of {} more at most {}", more.size() - most_excesses, centimetres(more[most_excesses].first)));
  }
  return fmt::format("{}{}{}", text, names.size() > more.size() ? "; those " : " that protrude: those ",
                     fmt::join(parts, ", "));
}

}  // namespace

SphereModel read_manipulator(const ManipulatorFiles& files, std::vector<std::string>& warnings) {
  const UrdfFile urdf = read_urdf(files.urdf, files.reading);
  warnings.insert(warnings.end(), urdf.warnings.begin(), urdf.warnings.end());
  const KinematicTree tree = files.base ? urdf.tree.on_ground(*files.base) : urdf.tree;
  std::optional<SrdfFile> srdf;
  if (!files.srdf.empty()) {
    srdf = read_srdf(files.srdf, tree);
    warnings.insert(warnings.end(), srdf->warnings.begin(), srdf->warnings.end());
  }
  const std::vector<std::size_t> moving = moving_joints(files, urdf, tree, srdf, warnings);
  if (srdf) {
    for (const auto& [joint, line] : srdf->passive) {
      if (!std::binary_search(moving.begin(), moving.end(), joint)) continue;
      warnings.push_back(fmt::format("{}:{}: joint '{}' is passive, without a motor, and moves here", files.srdf, line,
                                     tree.joints()[joint].name));
    }
  }
  const Manipulator robot = [&] {
    const auto values = values_of(files, tree, moving);
    try {
      return Manipulator(tree, moving, values);
    } catch (const TreeError& e) {
      // The joint under a mobile base is in no line of the file.
      const auto line = urdf.joint_lines.find(tree.joints().at(e.number).name);
      if (line == urdf.joint_lines.end()) throw Error(fmt::format("{}: {}", files.urdf, e.what()));
      throw Error(fmt::format("{}:{}: {}", files.urdf, line->second, e.what()));
    } catch (const Error& e) {
      throw Error(fmt::format("{}: {}", files.urdf, e.what()));
    }
  }();
  CoverOptions options;
  if (files.cover) options.excess = options.most_excess = *files.cover;
  const CoverCache cache(user_cover_folder());
  LinkCovers covers = cache.covers(tree, options);
  cache.trim();
  if (const std::string text = excess_text(tree, covers); !text.empty()) {
    warnings.push_back(fmt::format("{}: {}", files.urdf, text));
  }
  SphereModel::Pairs may_touch;
  SphereModel::Pairs touching;
  if (!files.self_collision) {
    touching = all_pairs(tree.links().size());
  } else {
    if (srdf) may_touch = srdf->disabled;
    touching = likely_contacts(tree, covers, may_touch);
    if (!touching.empty()) warnings.push_back(touching_warning(files, tree, touching));
  }
  may_touch.insert(may_touch.end(), touching.begin(), touching.end());
  const SphereModel covered(robot, std::move(covers), std::move(may_touch));
  std::vector<StandingContact> contacts;
  SphereModel model = with_standing_shapes(covered.with_touching(touching), contacts);
  if (!contacts.empty()) warnings.push_back(standing_warning(files, tree, contacts));
  if (!srdf) return model;
  return model.with_states(states_of(*srdf, files.group, robot)).with_world_frame(srdf->world_frame);
}

}  // namespace trellis
