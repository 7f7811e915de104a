// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/kinematic_tree.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <trellis/base/error.hpp>

namespace trellis {

std::pair<Vec3, Vec3> across(const Vec3& axis) {
  const Vec3 other = std::abs(axis.x) < 0.9 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
  const Vec3 first = other - dot(other, axis) * axis;
  const Vec3 u = (1.0 / norm(first)) * first;
  return {u, cross(axis, u)};
}

namespace {

/// The pose of the child frame of a joint with at most one coordinate, in the joint's frame.
Pose3 moved_by(Joint::Kind kind, const Vec3& axis, double value) {
  if (kind == Joint::Kind::fixed) return {};
  if (kind == Joint::Kind::prismatic) return {value * axis, {}};
  return {{}, rotation_of(value * axis)};
}

/// The pose of a joint's child frame in the joint's frame.
Pose3 moved(Joint::Kind kind, const Vec3& axis, View values) {
  switch (kind) {
    case Joint::Kind::fixed: return {};
    case Joint::Kind::revolute:
    case Joint::Kind::continuous:
    case Joint::Kind::prismatic: return moved_by(kind, axis, values[0]);
    case Joint::Kind::planar: {
      const auto [u, v] = across(axis);
      return {values[0] * u + values[1] * v, rotation_of(values[2] * axis)};
    }
    case Joint::Kind::translation_2: {
      const auto [u, v] = across(axis);
      return {values[0] * u + values[1] * v, {}};
    }
    case Joint::Kind::translation_3: return {{values[0], values[1], values[2]}, {}};
    case Joint::Kind::floating:
      return {{values[0], values[1], values[2]}, normalised({values[3], values[4], values[5], values[6]})};
  }
  throw Fault("unknown kind of joint");
}

std::size_t width_of(Joint::Kind kind) {
  switch (kind) {
    case Joint::Kind::fixed: return 0;
    case Joint::Kind::planar: return 3;
    case Joint::Kind::floating: return 7;
    case Joint::Kind::translation_2: return 2;
    case Joint::Kind::translation_3: return 3;
    default: return 1;
  }
}

}  // namespace

const char* to_string(Joint::Kind kind) {
  switch (kind) {
    case Joint::Kind::fixed: return "fixed";
    case Joint::Kind::revolute: return "revolute";
    case Joint::Kind::continuous: return "continuous";
    case Joint::Kind::prismatic: return "prismatic";
    case Joint::Kind::planar: return "planar";
    case Joint::Kind::floating: return "floating";
    case Joint::Kind::translation_2: return "sliding in a plane";
    case Joint::Kind::translation_3: return "sliding";
  }
  throw Fault("unknown kind of joint");
}

std::size_t Joint::width() const { return mimic ? 0 : width_of(kind); }

bool carries_robot(Joint::Kind kind) {
  using Kind = Joint::Kind;
  return kind == Kind::planar || kind == Kind::floating || kind == Kind::translation_2 || kind == Kind::translation_3;
}

bool Joint::carries_robot() const { return trellis::carries_robot(kind); }

bool Joint::limited() const { return kind == Kind::revolute || kind == Kind::prismatic; }

bool Joint::plans() const { return width() > 0 && !locked && !(limited() && lo == hi); }

KinematicTree::KinematicTree(std::string name, std::vector<Link> links, std::vector<Joint> joints)
    : name_(std::move(name)), links_(std::move(links)), joints_(std::move(joints)) {
  if (links_.empty()) throw Error(fmt::format("robot '{}' has no link", name_));
  if (links_.size() > most_links) {
    throw Error(fmt::format("robot '{}' has {} links; at most {} are possible", name_, links_.size(), most_links));
  }
  resolve_chains();
  check_joints();
  open_seams();
  order();
  body_of_.resize(links_.size());
  body_of_[base_] = base_;
  for (const Joint& joint : joints_) {
    body_of_[joint.child] = joint.kind == Joint::Kind::fixed ? body_of_[joint.parent] : joint.child;
  }
}

void KinematicTree::resolve_chains() {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (!joints_[j].mimic) continue;
    Joint::Mimic total = *joints_[j].mimic;
    for (std::size_t passed = 0; total.joint < joints_.size() && joints_[total.joint].mimic; ++passed) {
      const Joint::Mimic& next = *joints_[total.joint].mimic;
      if (total.joint == j || passed == joints_.size()) {
        throw TreeError(TreeError::Part::joint, j,
                        fmt::format("joint '{}' follows '{}' in a cycle of joints that follow each other",
                                    joints_[j].name, joints_[joints_[j].mimic->joint].name));
      }
      total = {next.joint, total.multiplier * next.multiplier, total.multiplier * next.offset + total.offset};
    }
    joints_[j].mimic = total;
  }
}

void KinematicTree::open_seams() {
  for (const Joint& joint : joints_) {
    if (!joint.mimic) continue;
    Joint& leader = joints_[joint.mimic->joint];
    if (leader.kind != Joint::Kind::continuous) continue;
    const double multiplier = joint.mimic->multiplier;
    const bool turns = joint.kind == Joint::Kind::revolute || joint.kind == Joint::Kind::continuous;
    if (multiplier == 0.0 || (turns && multiplier == std::round(multiplier))) continue;
    leader.kind = Joint::Kind::revolute;
    leader.lo = -std::numbers::pi;
    leader.hi = std::numbers::pi;
  }
}

void KinematicTree::check_joints() const {
  for (const Joint& joint : joints_) {
    const auto fail = [&](const std::string& fault) {
      throw TreeError(TreeError::Part::joint, static_cast<std::size_t>(&joint - joints_.data()),
                      fmt::format("joint '{}' {}", joint.name, fault));
    };
    if (joint.parent >= links_.size() || joint.child >= links_.size()) throw Fault("a joint of no link");
    if (!(std::abs(norm(joint.axis) - 1.0) < 1e-6)) fail("has an axis that is not of length 1");
    if (joint.limited() && (!std::isfinite(joint.lo) || !std::isfinite(joint.hi) || joint.lo > joint.hi)) {
      fail(fmt::format("has limits from {:g} to {:g}", joint.lo, joint.hi));
    }
    if (!joint.mimic) continue;
    if (joint.mimic->joint >= joints_.size()) throw Fault("a joint that follows none");
    const Joint& leader = joints_[joint.mimic->joint];
    if (width_of(leader.kind) != 1) fail(fmt::format("follows '{}', which is {}", leader.name, to_string(leader.kind)));
    if (width_of(joint.kind) != 1) fail(fmt::format("is {} and follows '{}'", to_string(joint.kind), leader.name));
    if (!(std::abs(joint.mimic->multiplier) <= most_multiplier && std::abs(joint.mimic->offset) <= most_offset)) {
      fail(fmt::format("follows '{}' by more than {:g} times, or from beyond {:g}", leader.name, most_multiplier,
                       most_offset));
    }
  }
}

void KinematicTree::order() {
  const std::size_t none = joints_.size();
  std::vector<std::size_t> carries(links_.size(), none);
  std::vector<std::vector<std::size_t>> below(links_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    std::size_t& known = carries[joint.child];
    if (known != none) {
      throw TreeError(TreeError::Part::joint, j,
                      fmt::format("link '{}' is the child of two joints, '{}' and '{}'", links_[joint.child].name,
                                  joints_[known].name, joint.name));
    }
    known = j;
    below[joint.parent].push_back(j);
  }
  std::optional<std::size_t> base;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (carries[i] != none) continue;
    if (base) {
      throw TreeError(
          TreeError::Part::link, i,
          fmt::format("no joint leads to '{}' nor to '{}'; a robot has one base", links_[*base].name, links_[i].name));
    }
    base = i;
  }
  if (!base) {
    const std::size_t j = cycle_above(carries, 0);
    throw TreeError(
        TreeError::Part::joint, j,
        fmt::format("the joints of robot '{}' make a cycle through '{}': it has no base", name_, joints_[j].name));
  }
  base_ = *base;
  // Breadth first; a link that is not reached is on a cycle.
  std::vector<std::size_t> sequence;
  std::vector<std::size_t> links = {base_};
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (const std::size_t j : below[links[i]]) {
      sequence.push_back(j);
      links.push_back(joints_[j].child);
    }
  }
  if (sequence.size() != joints_.size()) {
    std::vector<char> reached(links_.size(), 0);
    for (const std::size_t i : links) reached[i] = 1;
    const auto lost = static_cast<std::size_t>(std::find(reached.begin(), reached.end(), 0) - reached.begin());
    const std::size_t j = cycle_above(carries, lost);
    throw TreeError(TreeError::Part::joint, j,
                    fmt::format("link '{}' is on a cycle of joints: '{}' leads to it", links_[joints_[j].child].name,
                                joints_[j].name));
  }
  std::vector<std::size_t> place(joints_.size());
  std::vector<Joint> ordered;
  ordered.reserve(joints_.size());
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    place[sequence[k]] = k;
    ordered.push_back(std::move(joints_[sequence[k]]));
  }
  joints_ = std::move(ordered);
  joint_of_.assign(links_.size(), joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    joint_of_[joints_[j].child] = j;
    if (joints_[j].mimic) joints_[j].mimic->joint = place[joints_[j].mimic->joint];
  }
}

std::size_t KinematicTree::cycle_above(const std::vector<std::size_t>& carries, std::size_t link) const {
  std::vector<char> passed(links_.size(), 0);
  while (passed[link] == 0) {
    passed[link] = 1;
    link = joints_[carries[link]].parent;
  }
  return carries[link];
}

std::optional<std::size_t> KinematicTree::joint_of(std::size_t link) const {
  return joint_of_[link] < joints_.size() ? std::optional(joint_of_[link]) : std::nullopt;
}

KinematicTree KinematicTree::on_ground(Joint::Kind kind) const {
  std::vector<Link> links = links_;
  links.push_back({"ground", {}});
  std::vector<Joint> joints = joints_;
  joints.push_back({.name = "base", .kind = kind, .parent = links.size() - 1, .child = base_, .axis = {0.0, 0.0, 1.0}});
  return {name_, std::move(links), std::move(joints)};
}

std::optional<std::size_t> KinematicTree::find_link(const std::string& name) const {
  const auto it = std::find_if(links_.begin(), links_.end(), [&](const Link& link) { return link.name == name; });
  return it != links_.end() ? std::optional(static_cast<std::size_t>(it - links_.begin())) : std::nullopt;
}

std::optional<std::size_t> KinematicTree::find_joint(const std::string& name) const {
  const auto it = std::find_if(joints_.begin(), joints_.end(), [&](const Joint& joint) { return joint.name == name; });
  return it != joints_.end() ? std::optional(static_cast<std::size_t>(it - joints_.begin())) : std::nullopt;
}

Manipulator::Manipulator(KinematicTree tree, std::vector<std::size_t> moving,
                         const std::vector<std::vector<double>>& values)
    : tree_(std::move(tree)), values_(values), moving_(std::move(moving)) {
  const auto& joints = tree_.joints();
  std::vector<std::size_t> column(joints.size(), 0);
  std::vector<char> moves(joints.size(), 0);
  for (const std::size_t j : moving_) {
    const Joint& joint = joints.at(j);
    if (joint.width() == 0) {
      throw TreeError(
          TreeError::Part::joint, j,
          fmt::format("joint '{}' cannot move by itself: it {}", joint.name,
                      joint.mimic ? fmt::format("follows '{}'", joints[joint.mimic->joint].name) : "is fixed"));
    }
    if (joint.carries_robot() && joint.parent != tree_.base()) {
      throw TreeError(TreeError::Part::joint, j,
                      fmt::format("joint '{}' is {} and does not move the base", joint.name, to_string(joint.kind)));
    }
    if (moves[j] != 0) throw Error(fmt::format("joint '{}' is named twice", joint.name));
    moves[j] = 1;
    column[j] = dimension_;
    dimension_ += joint.width();
    if (joint.carries_robot() && joint.kind != Joint::Kind::planar) {
      positions_.emplace_back(column[j], joint.kind == Joint::Kind::translation_2 ? 2 : 3);
    }
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].mimic && moves[joints[j].mimic->joint] != 0) moves[j] = 2;
  }
  /// The value of a joint that does not move.
  const auto value_of = [&](std::size_t j) {
    const std::size_t from = joints[j].mimic ? joints[j].mimic->joint : j;
    const Joint& leader = joints[from];
    std::vector<double> value(width_of(leader.kind), 0.0);
    if (from < values.size() && !values[from].empty()) {
      value = values[from];
    } else if (leader.kind == Joint::Kind::floating) {
      value[6] = 1.0;
    } else if (leader.limited()) {
      value[0] = std::clamp(0.0, leader.lo, leader.hi);
    }
    // Its own limits do not bind a follower, as in MoveIt.
    if (const auto& mimic = joints[j].mimic) value[0] = mimic->multiplier * value[0] + mimic->offset;
    return value;
  };

  body_of_.assign(tree_.links().size(), 0);
  in_body_.assign(tree_.links().size(), {});
  bodies_.push_back({.name = tree_.links()[tree_.base()].name});
  bodies_.front().links = {tree_.base()};
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Joint& joint = joints[j];
    const std::size_t carrier = body_of_[joint.parent];
    const Pose3 origin = in_body_[joint.parent] * joint.origin;
    if (moves[j] == 0) {
      body_of_[joint.child] = carrier;
      in_body_[joint.child] = origin * moved(joint.kind, joint.axis, value_of(j));
      bodies_[carrier].links.push_back(joint.child);
      continue;
    }
    body_of_[joint.child] = bodies_.size();
    Body body{.name = tree_.links()[joint.child].name,
              .links = {joint.child},
              .parent = carrier,
              .origin = origin,
              .kind = joint.kind,
              .axis = joint.axis,
              .column = column[joint.mimic ? joint.mimic->joint : j]};
    if (joint.mimic) {
      body.multiplier = joint.mimic->multiplier;
      body.offset = joint.mimic->offset;
    }
    bodies_.push_back(std::move(body));
  }
  for (std::size_t i = 0; i < tree_.links().size(); ++i) {
    Body& body = bodies_[body_of_[i]];
    for (const Solid& solid : tree_.links()[i].solids) {
      const Solid placed{solid.shape, in_body_[i] * solid.pose};
      body.radius = std::max(body.radius, farthest_from_origin(placed));
      body.solids.push_back(placed);
    }
  }
  add_reaches();
}

void Manipulator::add_reaches() {
  reach_.assign(bodies_.size(), std::vector<double>(dimension_, 0.0));
  for (std::size_t b = 1; b < bodies_.size(); ++b) {
    // From the body to the base: the farthest that its points are from the origin of each joint's frame.
    double far = bodies_[b].radius;
    for (std::size_t at = b; at != 0; at = bodies_[at].parent) {
      const Body& body = bodies_[at];
      const double scale = std::abs(body.multiplier);
      switch (body.kind) {
        case Joint::Kind::prismatic: reach_[b][body.column] += scale; break;
        case Joint::Kind::planar:
          reach_[b][body.column] += 1.0;
          reach_[b][body.column + 1] += 1.0;
          reach_[b][body.column + 2] += far;
          break;
        // See `change`: the first coordinate has the distance, the fourth the angle.
        case Joint::Kind::floating:
          reach_[b][body.column] += 1.0;
          reach_[b][body.column + 3] += far;
          break;
        case Joint::Kind::translation_2:
        case Joint::Kind::translation_3: reach_[b][body.column] += 1.0; break;
        default: reach_[b][body.column] += scale * far; break;
      }
      far += norm(body.origin.position) + extension(at);
    }
  }
}

bool Manipulator::has_fixed_base() const {
  return std::none_of(moving_.begin(), moving_.end(), [&](std::size_t j) { return tree_.joints()[j].carries_robot(); });
}

double Manipulator::extension(std::size_t body) const {
  if (bodies_[body].kind != Joint::Kind::prismatic) return 0.0;
  const Joint& joint = tree_.joints()[*tree_.joint_of(bodies_[body].links.front())];
  const Joint& leader = joint.mimic ? tree_.joints()[joint.mimic->joint] : joint;
  const auto at = [&](double value) { return std::abs(bodies_[body].multiplier * value + bodies_[body].offset); };
  return std::max(at(leader.lo), at(leader.hi));
}

Manipulator Manipulator::with_moving(std::vector<std::size_t> moving) const {
  return {tree_, std::move(moving), values_};
}

Manipulator Manipulator::attached(const Link& link, std::size_t to) const {
  if (tree_.find_link(link.name)) {
    throw Error(fmt::format("robot '{}' has a link '{}' already", tree_.name(), link.name));
  }
  std::vector<Link> links = tree_.links();
  links.push_back(link);
  std::vector<Joint> joints = tree_.joints();
  joints.push_back({.name = "attach " + link.name, .parent = to, .child = links.size() - 1});
  KinematicTree tree(tree_.name(), std::move(links), std::move(joints));
  // The new joint has a place among the others, whose order stays.
  const std::size_t place = *tree.joint_of(tree.links().size() - 1);
  std::vector<std::size_t> moving = moving_;
  for (std::size_t& j : moving) j += j >= place ? 1 : 0;
  std::vector<std::vector<double>> values = values_;
  if (place < values.size()) values.insert(values.begin() + static_cast<std::ptrdiff_t>(place), std::vector<double>());
  return {std::move(tree), std::move(moving), values};
}

std::size_t Manipulator::width(std::size_t body) const { return width_of(bodies_[body].kind); }

Pose3 Manipulator::joint_pose(std::size_t body, View q) const {
  const Body& of = bodies_[body];
  if (of.is_root()) return of.origin * moved(of.kind, of.axis, q.subspan(of.column, width_of(of.kind)));
  const double value = of.multiplier * q[of.column] + of.offset;
  return of.origin * moved_by(of.kind, of.axis, value);
}

void Manipulator::poses(View q, std::vector<Pose3>& out) const {
  out.resize(bodies_.size());
  out[0] = {};
  for (std::size_t b = 1; b < bodies_.size(); ++b) out[b] = out[bodies_[b].parent] * joint_pose(b, q);
}

Pose3 Manipulator::pose_of(std::size_t link, View q) const {
  std::vector<Pose3> all;
  poses(q, all);
  return all[body_of_[link]] * in_body_[link];
}

void Manipulator::change(const Space& space, View a, View b, MutableView out) const {
  if (space.flat()) {
    space.difference(a, b, out);
  } else {
    for (const Factor& factor : space.factors()) {
      const std::size_t j = factor.column;
      if (factor.kind == Factor::Kind::rotation) {
        const auto turn = [&](View q) { return normalised({q[j], q[j + 1], q[j + 2], q[j + 3]}); };
        std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(j), factor.width(), 0.0);
        out[j] = angle_between(turn(a), turn(b));
      } else {
        out[j] = b[j] - a[j];
        if (factor.kind == Factor::Kind::circle) out[j] = std::remainder(out[j], factor.axis.period());
      }
    }
  }
  for (const auto& [column, count] : positions_) {
    double squares = 0.0;
    for (std::size_t k = 0; k < count; ++k) squares += out[column + k] * out[column + k];
    std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(column), count, 0.0);
    out[column] = std::sqrt(squares);
  }
}

double Manipulator::displacement_bound(std::size_t body, View change) const {
  double sum = 0.0;
  for (std::size_t j = 0; j < dimension_; ++j) sum += std::abs(change[j]) * reach_[body][j];
  return sum;
}

}  // namespace trellis
