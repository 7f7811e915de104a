// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/manipulator_scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

namespace {

/// The distance of balls from others, of which each first one contains the others; `enough` where it is not less.
double gap_between(const std::vector<BodySphere>& first, const std::vector<BodySphere>& second, double enough) {
  const auto gap = [](const BodySphere& a, const BodySphere& b) {
    return norm(a.centre - b.centre) - a.radius - b.radius;
  };
  double least = enough;
  if (gap(first[0], second[0]) >= least) return least;
  for (std::size_t i = 1; i < first.size(); ++i) {
    if (gap(first[i], second[0]) >= least) continue;
    for (std::size_t j = 1; j < second.size(); ++j) least = std::min(least, gap(first[i], second[j]));
  }
  return least;
}

/// A shape that is scaled about its origin, then grown. Of a mesh vertices move away from their mean.
Shape3 grown(const Shape3& shape, double scale, double padding) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return Sphere{scale * sphere->radius + padding};
  if (const auto* box = std::get_if<Cuboid>(&shape)) {
    return Cuboid{scale * box->size + Vec3{2.0 * padding, 2.0 * padding, 2.0 * padding}};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    return Cylinder{scale * cylinder->radius + padding, scale * cylinder->length + 2.0 * padding};
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    return Capsule{scale * capsule->radius + padding, scale * capsule->length};
  }
  const Mesh& mesh = *std::get<std::shared_ptr<const Mesh>>(shape);
  Vec3 middle;
  for (const Vec3& v : mesh.vertices()) middle = middle + (1.0 / static_cast<double>(mesh.vertices().size())) * v;
  std::vector<Vec3> vertices;
  vertices.reserve(mesh.vertices().size());
  for (const Vec3& v : mesh.vertices()) {
    const Vec3 out = v - middle;
    const double away = norm(out);
    constexpr double nothing = 1e-6;
    vertices.push_back(away > nothing ? middle + (scale + padding / away) * out : v);
  }
  return std::make_shared<const Mesh>(std::move(vertices), mesh.triangles(), "a padded mesh");
}

Vec3 nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 along = b - a;
  const double squared = dot(along, along);
  const double t = squared > 0.0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
  return a + t * along;
}

}  // namespace

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

LinkCovers link_covers(const KinematicTree& tree, const CoverOptions& options) {
  LinkCovers covers{options, {}};
  covers.links.reserve(tree.links().size());
  for (const Link& link : tree.links()) covers.links.push_back(medial_cover(link.solids, options));
  return covers;
}

SphereModel::Pairs neighbours(const KinematicTree& tree) {
  SphereModel::Pairs pairs;
  for (std::size_t a = 0; a < tree.links().size(); ++a) {
    if (tree.links()[a].solids.empty()) continue;
    // From the parent of the link on: the links without geometry beyond it connect it to others.
    std::vector<std::pair<std::size_t, std::size_t>> open;  // a link, and the one that it was reached from
    const auto pass = [&](std::size_t link, std::size_t from) {
      if (const auto j = tree.joint_of(link); j && tree.joints()[*j].parent != from) {
        open.emplace_back(tree.joints()[*j].parent, link);
      }
      for (const Joint& joint : tree.joints()) {
        if (joint.parent == link && joint.child != from) open.emplace_back(joint.child, link);
      }
    };
    pass(a, a);
    while (!open.empty()) {
      const auto [link, from] = open.back();
      open.pop_back();
      if (tree.links()[link].solids.empty()) {
        pass(link, from);
      } else if (a < link) {
        pairs.emplace_back(a, link);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

SphereModel::SphereModel(const Manipulator& robot, Pairs may_touch)
    : SphereModel(robot, link_covers(robot.tree()), std::move(may_touch)) {}

SphereModel::SphereModel(Manipulator robot, LinkCovers covers, Pairs may_touch)
    : SphereModel(std::make_shared<const LinkCovers>(std::move(covers)), std::move(robot), std::move(may_touch)) {
  const KinematicTree& tree = robot_.tree();
  touching_ = neighbours(tree);
  for (std::size_t a = 0; a < tree.links().size(); ++a) {
    if (tree.links()[a].solids.empty()) continue;
    for (std::size_t b = a + 1; b < tree.links().size(); ++b) {
      if (!tree.links()[b].solids.empty() && tree.fixed_together(a, b)) touching_.emplace_back(a, b);
    }
  }
  std::sort(touching_.begin(), touching_.end());
  Pairs all = std::move(may_touch_);
  all.insert(all.end(), touching_.begin(), touching_.end());
  permit(std::move(all));
}

SphereModel::SphereModel(std::shared_ptr<const LinkCovers> covers, Manipulator robot, Pairs may_touch,
                         Distances distances)
    : robot_(std::move(robot)), covers_(std::move(covers)), distances_(std::move(distances)) {
  for (const Manipulator::Body& body : robot_.bodies()) {
    exact_ = exact_ && std::all_of(body.solids.begin(), body.solids.end(),
                                   [](const Solid& solid) { return std::holds_alternative<Sphere>(solid.shape); });
  }
  may_touch_ = std::move(may_touch);
}

SphereModel::SphereModel(const SphereModel& whole, Manipulator robot, std::vector<std::vector<BodySphere>> bodies)
    : robot_(std::move(robot)),
      covers_(whole.covers_),
      bodies_(std::move(bodies)),
      may_touch_(whole.may_touch_),
      base_(whole.base_),
      world_frame_(whole.world_frame_),
      exact_(whole.exact_),
      covers_shapes_(false) {}

void SphereModel::keep(const SphereModel& other) {
  base_ = other.base_;
  states_ = other.states_;
  world_frame_ = other.world_frame_;
  touching_ = other.touching_;
}

SphereModel SphereModel::with_standing_distances(Distances distances) const {
  SphereModel with = *this;
  with.distances_ = std::move(distances);
  with.add_standing();
  return with;
}

SphereModel SphereModel::with_touching(const Pairs& touching) const {
  SphereModel with = *this;
  with.touching_.insert(with.touching_.end(), touching.begin(), touching.end());
  std::sort(with.touching_.begin(), with.touching_.end());
  return with;
}

void SphereModel::permit(Pairs may_touch) {
  may_touch_ = std::move(may_touch);
  for (auto& [a, b] : may_touch_) {
    if (a > b) std::swap(a, b);
  }
  std::sort(may_touch_.begin(), may_touch_.end());
  may_touch_.erase(std::unique(may_touch_.begin(), may_touch_.end()), may_touch_.end());
  divide();
  enclose();
}

double SphereModel::excess() const {
  double excess = 0.0;
  for (const MedialCover& link : covers_->links) excess = std::max(excess, link.excess);
  return excess;
}

bool SphereModel::checked(std::size_t first_link, std::size_t second_link) const {
  const auto [a, b] = std::minmax(first_link, second_link);
  return a != b && !std::binary_search(may_touch_.begin(), may_touch_.end(), std::pair<std::size_t, std::size_t>(a, b));
}

bool SphereModel::always_touch(std::size_t first_link, std::size_t second_link) const {
  const auto [a, b] = std::minmax(first_link, second_link);
  return std::binary_search(touching_.begin(), touching_.end(), std::pair<std::size_t, std::size_t>(a, b));
}

void SphereModel::divide() {
  const std::size_t links = covers_->links.size();
  const auto balls_of = [&](std::size_t link) -> const std::vector<BodySphere>& { return covers_->links[link].balls; };
  // For each link with balls the links of other bodies that it must not touch.
  std::vector<std::vector<char>> apart(links);
  for (std::size_t a = 0; a < links; ++a) {
    if (balls_of(a).empty()) continue;
    apart[a].resize(links, 0);
    for (std::size_t b = 0; b < links; ++b) {
      if (!balls_of(b).empty() && robot_.body_of(a) != robot_.body_of(b)) apart[a][b] = checked(a, b) ? 1 : 0;
    }
  }
  bodies_.assign(robot_.bodies().size(), {});
  ball_links_.assign(bodies_.size(), {});
  parts_.clear();
  std::vector<std::size_t> first_link;  // of each part
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    std::vector<std::size_t> left;
    for (const std::size_t link : robot_.bodies()[body].links) {
      if (!balls_of(link).empty()) left.push_back(link);
    }
    // By number, whatever the order of the joints.
    std::sort(left.begin(), left.end());
    if (left.empty()) continue;
    bodies_[body].push_back({});
    ball_links_[body].push_back(0);
    while (!left.empty()) {
      const std::size_t first = left.front();
      parts_.push_back({body, bodies_[body].size(), 0, {}});
      first_link.push_back(first);
      std::erase_if(left, [&](std::size_t link) {
        if (apart[link] != apart[first]) return false;
        for (const BodySphere& ball : balls_of(link)) {
          bodies_[body].push_back({robot_.pose_in_body(link)(ball.centre), ball.radius});
          ball_links_[body].push_back(link);
        }
        return true;
      });
      parts_.back().end = bodies_[body].size();
    }
  }
  pairs_.clear();
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    for (std::size_t q = p + 1; q < parts_.size(); ++q) {
      if (apart[first_link[p]][first_link[q]] != 0) pairs_.emplace_back(p, q);
    }
  }
  add_standing();
}

void SphereModel::add_standing() {
  standing_.assign(bodies_.size(), std::nullopt);
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    // The balls of each link after one that contains them.
    std::vector<std::size_t> links;
    std::vector<std::vector<BodySphere>> balls;
    for (std::size_t i = 1; i < bodies_[body].size(); ++i) {
      const std::size_t link = ball_links_[body][i];
      if (links.empty() || links.back() != link) {
        links.push_back(link);
        balls.push_back({{}});
      }
      balls.back().push_back(bodies_[body][i]);
    }
    for (auto& own : balls) own.front() = enclosing({own.begin() + 1, own.end()});
    std::optional<Standing>& nearest = standing_[body];
    for (std::size_t i = 0; i < links.size(); ++i) {
      for (std::size_t j = i + 1; j < links.size(); ++j) {
        if (!checked(links[i], links[j])) continue;
        const double enough = nearest ? nearest->gap : std::numeric_limits<double>::infinity();
        const auto given = distances_.find(std::minmax(links[i], links[j]));
        const double gap = given == distances_.end() ? gap_between(balls[i], balls[j], enough) : given->second;
        if (gap < enough) nearest = Standing{std::min(links[i], links[j]), std::max(links[i], links[j]), gap};
      }
    }
  }
}

std::optional<SphereModel::Standing> SphereModel::standing() const {
  std::optional<Standing> nearest;
  for (const auto& of_body : standing_) {
    if (of_body && (!nearest || of_body->gap < nearest->gap)) nearest = of_body;
  }
  return nearest;
}

void SphereModel::enclose() {
  bounding_radius_ = 0.0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& balls = bodies_[b];
    if (balls.empty()) continue;
    const BodySphere all = enclosing({balls.begin() + 1, balls.end()});
    balls.front() = all;
    double far = norm(all.centre) + all.radius;
    for (std::size_t at = b; at != 0; at = robot_.bodies()[at].parent) {
      far += norm(robot_.bodies()[at].origin.position) + robot_.extension(at);
    }
    bounding_radius_ = std::max(bounding_radius_, far);
  }
  for (Part& part : parts_) {
    const auto own = bodies_[part.body].begin();
    part.whole =
        enclosing({own + static_cast<std::ptrdiff_t>(part.begin), own + static_cast<std::ptrdiff_t>(part.end)});
  }
}

double SphereModel::radius_carried_by(std::size_t joint) const {
  const std::size_t carrier = robot_.body_of(robot_.tree().joints()[joint].child);
  double radius = 0.0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    double far = 0.0;
    for (std::size_t i = 1; i < bodies_[b].size(); ++i) {
      far = std::max(far, norm(bodies_[b][i].centre) + bodies_[b][i].radius);
    }
    std::size_t at = b;
    for (; at != carrier && at != 0; at = robot_.bodies()[at].parent) {
      far += norm(robot_.bodies()[at].origin.position) + robot_.extension(at);
    }
    if (at == carrier) radius = std::max(radius, far);
  }
  return radius;
}

SphereModel SphereModel::team(const std::vector<SphereModel>& robots) {
  if (robots.size() < 2) throw Error("robots: a team has at least two robots");
  std::vector<Link> links = {{"world", {}}};
  std::vector<Joint> joints;
  Pairs may_touch;
  Distances distances;
  LinkCovers covers{robots.front().covers_->options, std::vector<MedialCover>(1)};
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
    const std::vector<MedialCover>& own = robots[i].covers_->links;
    covers.links.insert(covers.links.end(), own.begin(), own.end());
    const std::size_t first_moving = one.moving().front();
    // The parent of a base that moves is the world itself. A fixed one follows a joint of its robot by a factor of 0:
    // it stays where it is, and is a body that the other robots must not touch.
    const bool moves = tree.joints()[first_moving].carries_robot();
    joints.push_back({.name = named("base of the team"),
                      .kind = moves ? Joint::Kind::fixed : Joint::Kind::continuous,
                      .parent = 0,
                      .child = first_link + tree.base(),
                      .origin = robots[i].base(),
                      .axis = {0.0, 0.0, 1.0}});
    if (!moves) joints.back().mimic = Joint::Mimic{first_joint + 1 + first_moving, 0.0, 0.0};
    for (std::size_t j = 0; j < tree.joints().size(); ++j) {
      Joint joint = tree.joints()[j];
      if (joint.carries_robot() && joint.parent == tree.base()) {
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
    for (const auto& [pair, distance] : robots[i].distances_) {
      distances[{first_link + pair.first, first_link + pair.second}] = distance;
    }
    if (std::find(names.begin(), names.end(), tree.name()) == names.end()) names.push_back(tree.name());
  }
  KinematicTree tree(fmt::format("{} robots ({})", robots.size(), fmt::join(names, ", ")), std::move(links),
                     std::move(joints));
  std::vector<std::size_t> numbers;
  numbers.reserve(moving.size());
  for (const std::string& joint : moving) numbers.push_back(*tree.find_joint(joint));
  std::vector<std::vector<double>> placed(tree.joints().size());
  for (auto& [joint, value] : values) placed[*tree.find_joint(joint)] = std::move(value);
  // Permissions of the robots alone: neither the world nor a base makes links of two robots neighbours.
  SphereModel team(std::make_shared<const LinkCovers>(std::move(covers)),
                   Manipulator(std::move(tree), std::move(numbers), placed), {}, std::move(distances));
  team.permit(std::move(may_touch));
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
    const std::size_t width = robot_.width(b);
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
  Manipulator robot = robot_.attached({name, {solid}}, link);
  LinkCovers covers = *covers_;
  covers.links.push_back(medial_cover(std::span(&solid, 1), covers.options));
  Pairs may_touch = may_touch_;
  for (const std::size_t other : touch) may_touch.emplace_back(other, added);
  // Links that do not move against it.
  for (std::size_t other = 0; other < added; ++other) {
    if (robot.tree().fixed_together(other, added)) may_touch.emplace_back(other, added);
  }
  SphereModel with(std::make_shared<const LinkCovers>(std::move(covers)), std::move(robot), {}, distances_);
  with.permit(std::move(may_touch));
  with.keep(*this);
  return with;
}

SphereModel SphereModel::with_world_frame(std::string name) const {
  SphereModel named = *this;
  named.world_frame_ = std::move(name);
  return named;
}

SphereModel SphereModel::with_values(const std::vector<std::vector<double>>& values) const {
  SphereModel with(covers_, Manipulator(robot_.tree(), robot_.moving(), values), {});
  with.permit(Pairs(may_touch_));
  with.keep(*this);
  return with;
}

SphereModel SphereModel::with_covers(const std::map<std::size_t, MedialCover>& covers) const {
  LinkCovers all = *covers_;
  for (const auto& [link, cover] : covers) all.links[link] = cover;
  SphereModel with(std::make_shared<const LinkCovers>(std::move(all)), robot_, {}, distances_);
  with.permit(Pairs(may_touch_));
  with.keep(*this);
  return with;
}

SphereModel SphereModel::with_permissions(const Pairs& may_touch) const {
  Pairs pairs = may_touch_;
  pairs.insert(pairs.end(), may_touch.begin(), may_touch.end());
  SphereModel with = *this;
  with.permit(std::move(pairs));
  return with;
}

SphereModel SphereModel::padded(const std::vector<double>& scale, const std::vector<double>& padding) const {
  const std::vector<Link>& links = robot_.tree().links();
  Manipulator robot = robot_;
  LinkCovers covers = *covers_;
  Pairs may_touch = may_touch_;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].solids.empty() || (scale[i] == 1.0 && padding[i] == 0.0)) continue;
    const std::size_t added = robot.tree().links().size();
    if (added == KinematicTree::most_links) {
      throw Error(fmt::format("a robot has at most {} links, with a padded copy of each", KinematicTree::most_links));
    }
    Link link{links[i].name + " (padded)", {}};
    for (const Solid& solid : links[i].solids)
      link.solids.push_back({grown(solid.shape, scale[i], padding[i]), solid.pose});
    robot = robot.attached(link, i);
    covers.links.push_back(medial_cover(link.solids, covers.options));
    for (std::size_t other = 0; other < added; ++other) may_touch.emplace_back(other, added);
  }
  SphereModel whole(std::make_shared<const LinkCovers>(std::move(covers)), std::move(robot), {}, distances_);
  whole.permit(std::move(may_touch));
  whole.keep(*this);
  return whole;
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
  SphereModel thin(*this, robot_, std::move(bodies));
  thin.ball_links_ = ball_links_;
  thin.parts_ = parts_;
  thin.pairs_ = pairs_;
  // Links that do not move against each other are at least as far apart.
  thin.standing_ = standing_;
  thin.enclose();
  thin.states_ = states_;
  return thin;
}

std::optional<SphereModel> SphereModel::reduced(const std::vector<std::size_t>& kept) const {
  const auto keeps = [&](std::size_t column) { return std::binary_search(kept.begin(), kept.end(), column); };
  const auto& all = robot_.bodies();
  std::vector<char> determined(all.size(), 1);
  bool any = false;
  for (std::size_t b = 1; b < all.size(); ++b) {
    bool own = true;
    for (std::size_t k = 0; k < robot_.width(b); ++k) own = own && keeps(all[b].column + k);
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
  SphereModel part(*this, robot_.with_moving(moving), {});
  const std::size_t count = part.robot_.bodies().size();
  part.bodies_.resize(count);
  part.ball_links_.resize(count);
  part.standing_.resize(count);
  // A body of the part consists of bodies that do not move against each other any more.
  std::vector<std::size_t> place(parts_.size(), parts_.size());  // of each part among those of the new model
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Part& old = parts_[p];
    if (determined[old.body] == 0) continue;
    const std::size_t link = all[old.body].links.front();
    const std::size_t body = part.robot_.body_of(link);
    auto& balls = part.bodies_[body];
    auto& links = part.ball_links_[body];
    if (balls.empty()) {
      balls.push_back({});
      links.push_back(0);
    }
    place[p] = part.parts_.size();
    part.parts_.push_back({body, balls.size(), balls.size() + old.count(), {}});
    const Pose3 at = part.robot_.pose_in_body(link) * robot_.pose_in_body(link).inverse();
    for (std::size_t i = old.begin; i < old.end; ++i) {
      balls.push_back({at(bodies_[old.body][i].centre), bodies_[old.body][i].radius});
      links.push_back(ball_links_[old.body][i]);
    }
    if (const auto& standing = standing_[old.body]; standing) {
      auto& nearest = part.standing_[body];
      if (!nearest || standing->gap < nearest->gap) nearest = standing;
    }
  }
  for (const auto& [a, b] : pairs_) {
    if (determined[parts_[a].body] == 0 || determined[parts_[b].body] == 0) continue;
    if (part.parts_[place[a]].body != part.parts_[place[b]].body) part.pairs_.emplace_back(place[a], place[b]);
  }
  part.enclose();
  return part;
}

namespace {

/// Returns the axes of the coordinates of a joint; those of a quaternion too.
std::vector<Axis> axes_of(const Joint& joint, const Box3& bounds, double weight) {
  constexpr double pi = std::numbers::pi;
  const auto position = [&](std::size_t count) {
    std::vector<Axis> axes = {{joint.name + ".x", bounds.lo.x, bounds.hi.x, 1.0, false},
                              {joint.name + ".y", bounds.lo.y, bounds.hi.y, 1.0, false},
                              {joint.name + ".z", bounds.lo.z, bounds.hi.z, 1.0, false}};
    axes.resize(count);
    return axes;
  };
  switch (joint.kind) {
    case Joint::Kind::fixed: return {};
    case Joint::Kind::prismatic: return {{joint.name, joint.lo, joint.hi, 1.0, false}};
    case Joint::Kind::continuous: return {{joint.name, -pi, pi, weight, true}};
    case Joint::Kind::revolute: return {{joint.name, joint.lo, joint.hi, weight, false}};
    case Joint::Kind::translation_2: return position(2);
    case Joint::Kind::translation_3: return position(3);
    case Joint::Kind::planar: {
      std::vector<Axis> axes = position(2);
      axes.push_back({joint.name + ".theta", -pi, pi, weight, true});
      return axes;
    }
    case Joint::Kind::floating: {
      std::vector<Axis> axes = position(3);
      for (const char* of : {"x", "y", "z", "w"}) {
        axes.push_back({fmt::format("{}.rotation.{}", joint.name, of), -1.0, 1.0, weight, false});
      }
      return axes;
    }
  }
  throw Fault("unknown kind of joint");
}

}  // namespace

std::vector<Axis> joint_axes(const Manipulator& robot, const Box3& bounds, double weight) {
  std::vector<Axis> axes;
  for (const std::size_t j : robot.moving()) {
    const std::vector<Axis> own = axes_of(robot.tree().joints()[j], bounds, weight);
    axes.insert(axes.end(), own.begin(), own.end());
  }
  return axes;
}

Space joint_space(const Manipulator& robot, const Box3& bounds, const std::function<double(std::size_t)>& weight) {
  std::vector<std::pair<double, Space>> factors;
  std::vector<Axis> axes;  // of the joints since the last rotation
  const auto close = [&] {
    if (!axes.empty()) factors.emplace_back(1.0, Space("R", std::exchange(axes, {})));
  };
  for (const std::size_t j : robot.moving()) {
    const Joint& joint = robot.tree().joints()[j];
    const std::vector<Axis> own = axes_of(joint, bounds, weight(j));
    const bool turns = joint.kind == Joint::Kind::floating;
    axes.insert(axes.end(), own.begin(), turns ? own.end() - 4 : own.end());
    if (!turns) continue;
    close();
    factors.emplace_back(1.0, Space::so3(weight(j), joint.name + ".rotation"));
  }
  std::string name = fmt::format("joints of {}", robot.tree().name());
  if (factors.empty()) return {std::move(name), std::move(axes)};
  close();
  const Space product = Space::product(factors);
  std::vector<std::size_t> all(product.dimension());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return product.part(all, std::move(name));
}

SphereModel::Pairs likely_contacts(const KinematicTree& tree, const LinkCovers& covers,
                                   const SphereModel::Pairs& may_touch) {
  constexpr int samples = 1000;
  constexpr int most_free = 50;  // of these
  std::vector<std::size_t> moving;
  for (std::size_t j = 0; j < tree.joints().size(); ++j) {
    // A base that moves changes no distance between links.
    if (tree.joints()[j].width() == 1 && tree.joints()[j].plans()) moving.push_back(j);
  }
  if (moving.empty()) return {};
  const Manipulator robot(tree, moving);
  /// Two links, and in how many configurations they were apart.
  struct Candidate {
    std::size_t first, second;
    int free = 0;
  };
  const auto balls_of = [&](std::size_t link) -> const std::vector<BodySphere>& { return covers.links[link].balls; };
  const std::size_t count = covers.links.size();
  SphereModel::Pairs excluded = neighbours(tree);
  for (const auto& [a, b] : may_touch) excluded.emplace_back(std::min(a, b), std::max(a, b));
  std::sort(excluded.begin(), excluded.end());
  std::vector<Candidate> left;
  std::vector<BodySphere> wholes(count);
  for (std::size_t a = 0; a < count; ++a) {
    if (balls_of(a).empty()) continue;
    wholes[a] = enclosing(balls_of(a));
    for (std::size_t b = a + 1; b < count; ++b) {
      if (balls_of(b).empty() || tree.fixed_together(a, b)) continue;
      if (!std::binary_search(excluded.begin(), excluded.end(), std::pair(a, b))) left.push_back({a, b});
    }
  }
  std::vector<Pose3> bodies;
  std::vector<Pose3> poses(count);
  const auto touch = [&](std::size_t first, std::size_t second) {
    const Pose3 between = poses[first].inverse() * poses[second];
    const auto apart = [](const BodySphere& ball, const Vec3& at, double radius) {
      return norm(ball.centre - at) > ball.radius + radius;
    };
    if (apart(wholes[first], between(wholes[second].centre), wholes[second].radius)) return false;
    for (const BodySphere& ball : balls_of(second)) {
      const Vec3 at = between(ball.centre);
      if (apart(wholes[first], at, ball.radius)) continue;
      for (const BodySphere& other : balls_of(first)) {
        if (!apart(other, at, ball.radius)) return true;
      }
    }
    return false;
  };
  Configuration q(robot.dimension(), 0.0);
  Stream stream(0, tree.name(), "likely contacts");
  for (int k = 0; k < samples && !left.empty(); ++k) {
    for (std::size_t c = 0; c < moving.size(); ++c) {
      const Joint& joint = tree.joints()[moving[c]];
      const double lo = joint.limited() ? joint.lo : -std::numbers::pi;
      const double hi = joint.limited() ? joint.hi : std::numbers::pi;
      q[c] = lo + stream.uniform() * (hi - lo);
    }
    robot.poses(q, bodies);
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = bodies[robot.body_of(i)] * robot.pose_in_body(i);
    std::erase_if(left, [&](Candidate& pair) {
      if (!touch(pair.first, pair.second)) ++pair.free;
      return pair.free > most_free;
    });
  }
  SphereModel::Pairs links;
  for (const Candidate& pair : left) links.emplace_back(pair.first, pair.second);
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

Space ManipulatorScene::own_space() const {
  const auto& joints = robot.robot().tree().joints();
  return joint_space(robot.robot(), world.bounds(), [&](std::size_t j) {
    return joints[j].kind == Joint::Kind::floating ? robot.radius_carried_by(j) : 1.0;
  });
}

Space ManipulatorScene::default_space(double weight) const {
  return joint_space(robot.robot(), world.bounds(), [&](std::size_t) { return weight; });
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
