// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/manipulator_scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/spatial/sphere_cover.hpp>

namespace trellis {

namespace {

/// The balls of the leaves of a cover whose radius is a few times that of the finest.
void add_cover(const Solid& solid, std::vector<BodySphere>& balls) {
  // A link of 0.1 m gets balls of 0.02 m beyond its surface.
  constexpr double finest = 0.02;
  const SphereCover cover(solid, true, finest);
  for (const SphereCover::Node& node : cover.nodes()) {
    if (node.count == 0) balls.push_back({node.centre, node.outer});
  }
}

/// A ball that contains some balls: about the middle of their box.
BodySphere enclosing(const std::vector<BodySphere>& balls) {
  Vec3 lo = balls.front().centre;
  Vec3 hi = lo;
  for (const BodySphere& ball : balls) {
    const Vec3 r{ball.radius, ball.radius, ball.radius};
    const Vec3 a = ball.centre - r;
    const Vec3 b = ball.centre + r;
    lo = {std::min(lo.x, a.x), std::min(lo.y, a.y), std::min(lo.z, a.z)};
    hi = {std::max(hi.x, b.x), std::max(hi.y, b.y), std::max(hi.z, b.z)};
  }
  BodySphere all{0.5 * (lo + hi), 0.0};
  for (const BodySphere& ball : balls) {
    all.radius = std::max(all.radius, norm(ball.centre - all.centre) + ball.radius);
  }
  return all;
}

Vec3 nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 along = b - a;
  const double squared = dot(along, along);
  const double t = squared > 0.0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
  return a + t * along;
}

}  // namespace

SphereModel::SphereModel(Manipulator robot, Pairs may_touch)
    : robot_(std::move(robot)), may_touch_(std::move(may_touch)), pairs_(self_collision_pairs(robot_, may_touch_)) {
  for (const Manipulator::Body& body : robot_.bodies()) {
    std::vector<BodySphere>& balls = bodies_.emplace_back();
    for (const Solid& solid : body.solids) {
      if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) {
        balls.push_back({solid.pose.position, sphere->radius});
      } else {
        exact_ = false;
        add_cover(solid, balls);
      }
    }
  }
  enclose();
}

SphereModel::SphereModel(const SphereModel& whole, Manipulator robot, std::vector<std::vector<BodySphere>> bodies,
                         Pairs pairs)
    : robot_(std::move(robot)),
      bodies_(std::move(bodies)),
      may_touch_(whole.may_touch_),
      pairs_(std::move(pairs)),
      base_(whole.base_),
      exact_(whole.exact_),
      covers_shapes_(false) {
  for (auto& balls : bodies_) {
    if (!balls.empty()) balls.erase(balls.begin());
  }
  enclose();
}

void SphereModel::enclose() {
  bounding_radius_ = 0.0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& balls = bodies_[b];
    if (balls.empty()) continue;
    const BodySphere all = enclosing(balls);
    balls.insert(balls.begin(), all);
    double far = norm(all.centre) + all.radius;
    for (std::size_t at = b; at != 0; at = robot_.bodies()[at].parent) {
      far += norm(robot_.bodies()[at].origin.position) + robot_.extension(at);
    }
    bounding_radius_ = std::max(bounding_radius_, far);
  }
}

SphereModel SphereModel::team(const std::vector<SphereModel>& robots) {
  if (robots.size() < 2) throw Error("robots: a team has at least two robots");
  std::vector<Link> links = {{"world", {}}};
  std::vector<Joint> joints;
  Pairs may_touch;
  std::vector<std::string> moving;
  std::vector<std::pair<std::string, std::vector<double>>> values;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const Manipulator& one = robots[i].robot();
    const KinematicTree& tree = one.tree();
    const auto named = [&](const std::string& name) { return fmt::format("{}/{}", i + 1, name); };
    const std::size_t first_link = links.size();
    const std::size_t first_joint = joints.size();
    if (first_link + tree.links().size() > KinematicTree::most_links) {
      throw Error(fmt::format("robots: at most {} links in all", KinematicTree::most_links));
    }
    for (const Link& link : tree.links()) links.push_back({named(link.name), link.solids});
    const std::size_t first_moving = one.moving().front();
    // The parent of a base that moves is the world itself. A fixed one follows a joint of its robot by a factor of 0:
    // it stays where it is, and is a body that the other robots must not touch.
    const bool moves = tree.joints()[first_moving].kind == Joint::Kind::planar;
    joints.push_back({.name = named("base of the team"),
                      .kind = moves ? Joint::Kind::fixed : Joint::Kind::continuous,
                      .parent = 0,
                      .child = first_link + tree.base(),
                      .origin = robots[i].base(),
                      .axis = {0.0, 0.0, 1.0}});
    if (!moves) joints.back().mimic = Joint::Mimic{first_joint + 1 + first_moving, 0.0, 0.0};
    for (std::size_t j = 0; j < tree.joints().size(); ++j) {
      Joint joint = tree.joints()[j];
      if (joint.kind == Joint::Kind::planar && joint.parent == tree.base()) {
        joint.parent = 0;
        joint.origin = robots[i].base() * joint.origin;
      } else {
        joint.parent += first_link;
      }
      joint.name = named(joint.name);
      joint.child += first_link;
      if (joint.mimic) joint.mimic->joint += first_joint + 1;
      if (j < one.values().size() && !one.values()[j].empty()) values.emplace_back(joint.name, one.values()[j]);
      joints.push_back(std::move(joint));
    }
    for (const std::size_t j : one.moving()) moving.push_back(named(tree.joints()[j].name));
    for (const auto& [a, b] : robots[i].may_touch_) may_touch.emplace_back(first_link + a, first_link + b);
    if (std::find(names.begin(), names.end(), tree.name()) == names.end()) names.push_back(tree.name());
  }
  KinematicTree tree(fmt::format("{} robots ({})", robots.size(), fmt::join(names, ", ")), std::move(links),
                     std::move(joints));
  std::vector<std::size_t> numbers;
  numbers.reserve(moving.size());
  for (const std::string& joint : moving) numbers.push_back(*tree.find_joint(joint));
  std::vector<std::vector<double>> placed(tree.joints().size());
  for (auto& [joint, value] : values) placed[*tree.find_joint(joint)] = std::move(value);
  std::sort(may_touch.begin(), may_touch.end());
  SphereModel team(Manipulator(std::move(tree), std::move(numbers), placed), std::move(may_touch));
  for (const State& state : robots.front().states_) {
    State whole{state.name, {}};
    bool all = true;
    for (const SphereModel& robot : robots) {
      const auto same = std::find_if(robot.states_.begin(), robot.states_.end(),
                                     [&](const State& other) { return other.name == state.name; });
      all = all && same != robot.states_.end();
      if (all) whole.q.insert(whole.q.end(), same->q.begin(), same->q.end());
    }
    if (all) team.states_.push_back(std::move(whole));
  }
  return team;
}

std::vector<TeamMember> SphereModel::members() const {
  const auto& bodies = robot_.bodies();
  // For each coordinate the body that the base carries and that moves with it, or carries what does.
  std::vector<std::size_t> owner(robot_.dimension(), 0);
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    std::size_t root = b;
    while (bodies[root].parent != 0) root = bodies[root].parent;
    const std::size_t width = bodies[b].kind == Joint::Kind::planar ? 3 : 1;
    for (std::size_t k = 0; k < width; ++k) {
      std::size_t& of = owner[bodies[b].column + k];
      if (of == 0) of = root;
      // Bodies that follow one joint move together.
      if (of != root) std::replace(owner.begin(), owner.end(), root, std::size_t{of});
    }
  }
  std::vector<TeamMember> members;
  std::vector<std::size_t> roots;
  for (std::size_t j = 0; j < owner.size(); ++j) {
    const auto place = static_cast<std::size_t>(std::find(roots.begin(), roots.end(), owner[j]) - roots.begin());
    if (place == roots.size()) {
      roots.push_back(owner[j]);
      members.push_back({roots.size(), {}, false});
    }
    members[place].axes.push_back(j);
  }
  return members;
}

PointOnBody SphereModel::tip() const { return tip_moved_by({}); }

std::vector<PointOnBody> SphereModel::tips() const {
  const std::vector<TeamMember> parts = members();
  if (parts.size() < 2) return {tip()};
  std::vector<PointOnBody> tips;
  tips.reserve(parts.size());
  for (const TeamMember& part : parts) tips.push_back(tip_moved_by(part.axes));
  return tips;
}

PointOnBody SphereModel::tip_moved_by(const std::vector<std::size_t>& axes) const {
  PointOnBody tip;
  std::size_t longest = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::size_t column = robot_.bodies()[b].column;
    if (bodies_[b].empty()) continue;
    if (!axes.empty() && !std::binary_search(axes.begin(), axes.end(), column)) continue;
    std::size_t joints = 0;
    for (std::size_t at = b; at != 0; at = robot_.bodies()[at].parent) ++joints;
    if (joints < longest || (joints == longest && longest > 0)) continue;  // of equal chains the first
    longest = joints;
    tip = {b, bodies_[b].front().centre};
  }
  return tip;
}

Vec3 SphereModel::position(const PointOnBody& point, View q) const {
  Pose3 pose;
  std::vector<std::size_t> chain;
  for (std::size_t at = point.body; at != 0; at = robot_.bodies()[at].parent) chain.push_back(at);
  for (std::size_t i = chain.size(); i-- > 0;) pose = pose * robot_.joint_pose(chain[i], q);
  return base_(pose(point.point));
}

SphereModel SphereModel::based_at(const Pose3& base) const {
  SphereModel moved = *this;
  moved.base_ = base;
  return moved;
}

SphereModel SphereModel::with_states(std::vector<State> states) const {
  SphereModel named = *this;
  named.states_ = std::move(states);
  return named;
}

SphereModel SphereModel::attached(const std::string& name, const Solid& solid, std::size_t link,
                                  const std::vector<std::size_t>& touch) const {
  check_no_cloud(solid, fmt::format("the attached body '{}'", name));
  const std::size_t added = robot_.tree().links().size();
  Pairs may_touch = may_touch_;
  for (const std::size_t other : touch) may_touch.emplace_back(other, added);
  std::sort(may_touch.begin(), may_touch.end());
  SphereModel with(robot_.attached({name, {solid}}, link), std::move(may_touch));
  with.base_ = base_;
  with.states_ = states_;
  return with;
}

SphereModel SphereModel::thinned(double factor) const {
  std::vector<std::vector<BodySphere>> bodies = bodies_;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    // The bone of a body: from its frame to that of the farthest body that it carries.
    Vec3 end;
    for (std::size_t c = 1; c < bodies.size(); ++c) {
      const Manipulator::Body& child = robot_.bodies()[c];
      if (child.parent == b && norm(child.origin.position) > norm(end)) end = child.origin.position;
    }
    for (BodySphere& ball : bodies[b]) {
      const Vec3 bone = nearest_on_segment({}, end, ball.centre);
      if (norm(ball.centre - bone) <= ball.radius) ball.centre = bone + factor * (ball.centre - bone);
      ball.radius *= factor;
    }
  }
  SphereModel thin(*this, robot_, std::move(bodies), pairs_);
  thin.states_ = states_;
  return thin;
}

std::optional<SphereModel> SphereModel::reduced(const std::vector<std::size_t>& kept) const {
  const auto keeps = [&](std::size_t column) { return std::binary_search(kept.begin(), kept.end(), column); };
  const auto& all = robot_.bodies();
  std::vector<char> determined(all.size(), 1);
  bool any = false;
  for (std::size_t b = 1; b < all.size(); ++b) {
    bool own = keeps(all[b].column);
    if (all[b].kind == Joint::Kind::planar) own = own && keeps(all[b].column + 1) && keeps(all[b].column + 2);
    determined[b] = own && determined[all[b].parent] != 0 ? 1 : 0;
    any = any || (determined[b] != 0 && !bodies_[b].empty());
  }
  if (!any) return std::nullopt;
  std::vector<std::size_t> moving;
  std::size_t column = 0;
  for (const std::size_t j : robot_.moving()) {
    const std::size_t width = robot_.tree().joints()[j].width();
    bool whole = true;
    for (std::size_t k = 0; k < width; ++k) whole = whole && keeps(column + k);
    if (whole) moving.push_back(j);
    column += width;
  }
  Manipulator part = robot_.with_moving(moving);
  // A body of the part consists of bodies that do not move against each other any more.
  std::vector<std::vector<BodySphere>> bodies(part.bodies().size());
  for (std::size_t b = 0; b < all.size(); ++b) {
    if (determined[b] == 0 || bodies_[b].empty()) continue;
    const std::size_t link = all[b].links.front();
    auto& balls = bodies[part.body_of(link)];
    if (balls.empty()) balls.push_back({});
    const Pose3 at = part.pose_in_body(link) * robot_.pose_in_body(link).inverse();
    for (std::size_t i = 1; i < bodies_[b].size(); ++i) {
      balls.push_back({at(bodies_[b][i].centre), bodies_[b][i].radius});
    }
  }
  Pairs pairs;
  for (const auto& [a, b] : pairs_) {
    if (determined[a] == 0 || determined[b] == 0) continue;
    const std::size_t first = part.body_of(all[a].links.front());
    const std::size_t second = part.body_of(all[b].links.front());
    if (first != second) pairs.emplace_back(std::min(first, second), std::max(first, second));
  }
  return SphereModel(*this, std::move(part), std::move(bodies), std::move(pairs));
}

SphereModel::Pairs self_collision_pairs(const Manipulator& robot, const SphereModel::Pairs& may_touch) {
  const KinematicTree& tree = robot.tree();
  const std::size_t bodies = robot.bodies().size();
  // Links that fixed joints connect count as one: parent and child of a joint may touch.
  const auto beside = [&](std::size_t a, std::size_t b) {
    const auto carried = [&](std::size_t child, std::size_t parent) {
      for (std::size_t at = child;;) {
        const auto j = tree.joint_of(at);
        if (!j) return false;
        const Joint& joint = tree.joints()[*j];
        if (joint.kind != Joint::Kind::fixed) return tree.fixed_together(joint.parent, parent);
        at = joint.parent;
      }
    };
    return tree.fixed_together(a, b) || carried(a, b) || carried(b, a);
  };
  std::vector<std::vector<char>> checked(bodies, std::vector<char>(bodies, 0));
  for (std::size_t a = 0; a < tree.links().size(); ++a) {
    for (std::size_t b = a + 1; b < tree.links().size(); ++b) {
      if (tree.links()[a].solids.empty() || tree.links()[b].solids.empty()) continue;
      const std::size_t first = std::min(robot.body_of(a), robot.body_of(b));
      const std::size_t second = std::max(robot.body_of(a), robot.body_of(b));
      if (first == second || beside(a, b)) continue;
      if (std::binary_search(may_touch.begin(), may_touch.end(), std::pair(a, b))) continue;
      checked[first][second] = 1;
    }
  }
  SphereModel::Pairs pairs;
  for (std::size_t a = 0; a < bodies; ++a) {
    for (std::size_t b = a + 1; b < bodies; ++b) {
      if (checked[a][b] != 0) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

std::vector<Axis> joint_axes(const Manipulator& robot, const Box3& bounds, double weight) {
  std::vector<Axis> axes;
  for (const std::size_t j : robot.moving()) {
    const Joint& joint = robot.tree().joints()[j];
    switch (joint.kind) {
      case Joint::Kind::prismatic: axes.push_back({joint.name, joint.lo, joint.hi, 1.0, false}); break;
      case Joint::Kind::continuous:
        axes.push_back({joint.name, -std::numbers::pi, std::numbers::pi, weight, true});
        break;
      case Joint::Kind::planar:
        axes.push_back({joint.name + ".x", bounds.lo.x, bounds.hi.x, 1.0, false});
        axes.push_back({joint.name + ".y", bounds.lo.y, bounds.hi.y, 1.0, false});
        axes.push_back({joint.name + ".theta", -std::numbers::pi, std::numbers::pi, weight, true});
        break;
      default: axes.push_back({joint.name, joint.lo, joint.hi, weight, false}); break;
    }
  }
  return axes;
}

SphereModel::Pairs likely_contacts(const Manipulator& robot, const SphereModel::Pairs& may_touch, bool at_zero) {
  constexpr int samples = 1000;
  constexpr double share = 0.95;
  const SphereModel model(robot, may_touch);
  std::vector<int> contacts(model.pairs().size(), 0);
  std::vector<Pose3> poses;
  const auto touching = [&](std::size_t a, std::size_t b) {
    const auto& first = model.bodies()[a];
    const auto& second = model.bodies()[b];
    if (first.empty() || second.empty()) return false;
    const Pose3 between = poses[a].inverse() * poses[b];
    const auto apart = [](const BodySphere& ball, const Vec3& at, double radius) {
      return norm(ball.centre - at) > ball.radius + radius;
    };
    if (apart(first[0], between(second[0].centre), second[0].radius)) return false;
    for (std::size_t j = 1; j < second.size(); ++j) {
      const Vec3 at = between(second[j].centre);
      if (apart(first[0], at, second[j].radius)) continue;
      for (std::size_t i = 1; i < first.size(); ++i) {
        if (!apart(first[i], at, second[j].radius)) return true;
      }
    }
    return false;
  };
  Configuration q(robot.dimension(), 0.0);
  Stream stream(0, robot.tree().name(), "likely contacts");
  for (int k = 0; k <= samples; ++k) {
    std::size_t column = 0;
    for (const std::size_t j : robot.moving()) {
      const Joint& joint = robot.tree().joints()[j];
      const bool limited = joint.kind == Joint::Kind::revolute || joint.kind == Joint::Kind::prismatic;
      for (std::size_t i = 0; i < joint.width(); ++i, ++column) {
        const double lo = limited ? joint.lo : -std::numbers::pi;
        const double hi = limited ? joint.hi : std::numbers::pi;
        q[column] = k == 0 ? std::clamp(0.0, lo, hi) : lo + stream.uniform() * (hi - lo);
      }
    }
    robot.poses(q, poses);
    for (std::size_t p = 0; p < contacts.size(); ++p) {
      const auto& [a, b] = model.pairs()[p];
      if (touching(a, b)) contacts[p] += k > 0 ? 1 : at_zero ? samples : 0;
    }
  }
  SphereModel::Pairs bodies;
  for (std::size_t p = 0; p < contacts.size(); ++p) {
    if (contacts[p] >= share * samples) bodies.push_back(model.pairs()[p]);
  }
  return bodies;
}

SphereModel::Pairs links_of(const Manipulator& robot, const SphereModel::Pairs& bodies) {
  SphereModel::Pairs links;
  for (const auto& [first, second] : bodies) {
    for (const std::size_t a : robot.bodies()[first].links) {
      for (const std::size_t b : robot.bodies()[second].links) links.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  std::sort(links.begin(), links.end());
  return links;
}

double ManipulatorScene::magnitude() const {
  const double far = norm(robot.base().position) + robot.bounding_radius();
  return std::max(SpatialScene(world, Robot3::point()).magnitude(), far);
}

std::string ManipulatorScene::body_name(std::size_t body) const { return robot.robot().bodies().at(body).name; }

std::optional<ThinnestObstacle> ManipulatorScene::thinnest_obstacle() const {
  return SpatialScene(world, Robot3::point()).thinnest_obstacle();
}

Space ManipulatorScene::default_space(double weight) const {
  return {fmt::format("joints of {}", robot_name()), joint_axes(robot.robot(), world.bounds(), weight)};
}

std::shared_ptr<const Scene> ManipulatorScene::shrunken(double scale) const {
  return std::make_shared<ManipulatorScene>(world, robot.thinned(scale));
}

std::shared_ptr<const Scene> ManipulatorScene::with_obstacles(const std::vector<std::size_t>& kept) const {
  const auto with = SpatialScene(world, Robot3::point()).with_obstacles(kept);
  return std::make_shared<ManipulatorScene>(trellis::spatial(*with).world, robot);
}

std::shared_ptr<const Scene> ManipulatorScene::of_point() const {
  return std::make_shared<SpatialScene>(world, Robot3::point());
}

std::shared_ptr<const Scene> ManipulatorScene::reduced(const std::vector<std::size_t>& kept) const {
  std::vector<std::size_t> own;
  for (const std::size_t column : kept) {
    if (column < robot_dimension()) own.push_back(column);
  }
  auto part = robot.reduced(own);
  // The part has the coordinates of whole joints alone.
  if (!part || part->robot().dimension() != own.size()) return nullptr;
  return std::make_shared<ManipulatorScene>(world, std::move(*part));
}

std::shared_ptr<const Scene> ManipulatorScene::eroded(double distance) const {
  const auto smaller = SpatialScene(world, Robot3::point()).eroded(distance);
  return std::make_shared<ManipulatorScene>(trellis::spatial(*smaller).world, robot);
}

std::shared_ptr<const Scene> ManipulatorScene::aggregated(double error) const {
  const auto merged = SpatialScene(world, Robot3::point()).aggregated(error);
  return std::make_shared<ManipulatorScene>(trellis::spatial(*merged).world, robot);
}

}  // namespace trellis
