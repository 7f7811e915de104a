// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/link_shapes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// What FCL's distances may be too large by, as a share.
constexpr double inexact = 1e-3;

/// Whether a cover is of a shape that it may differ from.
bool protrudes(const MedialCover& cover) { return cover.excess > 0.0; }

/// How finer covers are made: with more balls than usual, in a few seconds for the largest links.
CoverOptions fit_options(double excess) {
  constexpr double work = 6.0;
  return {excess, excess, std::numeric_limits<std::size_t>::max(), work};
}

std::vector<Pose3> link_poses(const SphereModel& model, View q) {
  const Manipulator& robot = model.robot();
  std::vector<Pose3> bodies(robot.bodies().size(), model.base());
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    bodies[b] = bodies[robot.bodies()[b].parent] * robot.joint_pose(b, q);
  }
  std::vector<Pose3> links;
  for (std::size_t l = 0; l < robot.tree().links().size(); ++l) {
    links.push_back(bodies[robot.body_of(l)] * robot.pose_in_body(l));
  }
  return links;
}

}  // namespace

/// Distances of a link from what does not move with it.
class ShapeChecker::Distance {
 public:
  Distance(const Link& link, World3 world)
      : scene_(std::make_shared<const SpatialScene>(std::move(world), Robot3(link.name, link.solids))),
        checker_(make_spatial_checker(scene_, scene_->default_space(1.0), 1.0, false)) {}

  /// What the link is nearest to, or in contact with.
  struct Found {
    double distance = infinite;                ///< metres; 0 in contact
    std::optional<std::size_t> obstacle = {};  ///< none: the boundary
  };
  [[nodiscard]] Found at(const Pose3& pose) const {
    const Quaternion& turn = pose.orientation;
    const Configuration q = {pose.position.x, pose.position.y, pose.position.z, turn.x, turn.y, turn.z, turn.w};
    if (const auto contact = checker_->contact(q)) return {0.0, contact->obstacle};
    return {checker_->clearance(q) * (1.0 - inexact)};
  }

 private:
  std::shared_ptr<const SpatialScene> scene_;
  std::unique_ptr<Checker> checker_;
};

ShapeChecker::ShapeChecker(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {
  for (const MedialCover& cover : scene_->manipulator()->robot.covers().links) {
    wholes_.push_back(cover.balls.empty() ? BodySphere{} : enclosing(cover.balls));
  }
  finest_.assign(wholes_.size(), std::numeric_limits<double>::quiet_NaN());
}
ShapeChecker::~ShapeChecker() = default;
ShapeChecker::ShapeChecker(ShapeChecker&&) noexcept = default;
ShapeChecker& ShapeChecker::operator=(ShapeChecker&&) noexcept = default;

ShapeChecker::Distance& ShapeChecker::of_world(std::size_t link) {
  auto& known = known_[{link, link}];
  const ManipulatorScene& scene = *scene_->manipulator();
  if (!known) known = std::make_unique<Distance>(scene.robot.robot().tree().links()[link], scene.world);
  return *known;
}

ShapeChecker::Distance& ShapeChecker::of_links(std::size_t first, std::size_t second) {
  auto& known = known_[{first, second}];
  if (known) return *known;
  const std::vector<Link>& links = scene_->manipulator()->robot.robot().tree().links();
  std::vector<Obstacle3> obstacles;
  for (const Solid& solid : links[first].solids) obstacles.push_back({links[first].name, solid});
  // Bounds that contain nothing, about both links where they are near each other.
  const double far = norm(wholes_[first].centre) + 2.0 * (wholes_[first].radius + wholes_[second].radius) + 1.0;
  World3 world({{-far, -far, -far}, {far, far, far}}, std::move(obstacles), Contain::none);
  known = std::make_unique<Distance>(links[second], std::move(world));
  return *known;
}

double ShapeChecker::distance(std::size_t first, std::size_t second, const Pose3& place) {
  return of_links(first, second).at(place).distance;
}

double ShapeChecker::finest(std::size_t link) {
  double& known = finest_[link];
  if (std::isnan(known)) {
    const SphereModel& robot = scene_->manipulator()->robot;
    known = protrudes(robot.covers().links[link]) ? finest_excess(robot.robot().tree().links()[link]) : 0.0;
  }
  return known;
}

bool ShapeChecker::fits(const ShapeReport& report) {
  if (report.contact) return false;
  for (std::size_t l = 0; l < report.room.size(); ++l) {
    if (!std::isinf(report.room[l]) && report.room[l] <= finest(l)) return false;
  }
  return true;
}

std::pair<double, double> ShapeChecker::divide(double distance, std::size_t first, std::size_t second) {
  const double rest = 0.5 * (distance - finest(first) - finest(second));
  return {finest(first) + rest, finest(second) + rest};
}

ShapeReport ShapeChecker::at(View q) {
  const ManipulatorScene& scene = *scene_->manipulator();
  const SphereModel& model = scene.robot;
  const std::vector<MedialCover>& covers = model.covers().links;
  const std::vector<Link>& links = model.robot().tree().links();
  const std::vector<Pose3> poses = link_poses(model, q);
  ShapeReport report{std::nullopt, std::vector<double>(links.size(), infinite)};
  for (std::size_t l = 0; l < links.size(); ++l) {
    if (covers[l].balls.empty()) continue;
    const Distance::Found found = of_world(l).at(poses[l]);
    if (!(found.distance > 0.0)) {
      report.contact = Contact{model.robot().body_of(l), found.obstacle};
      return report;
    }
    if (found.distance <= covers[l].excess) report.room[l] = found.distance;
  }
  for (std::size_t a = 0; a < links.size(); ++a) {
    if (covers[a].balls.empty()) continue;
    for (std::size_t b = a + 1; b < links.size(); ++b) {
      if (covers[b].balls.empty() || !model.checked(a, b) || model.stands_apart(a, b)) continue;
      const double apart = norm(poses[a](wholes_[a].centre) - poses[b](wholes_[b].centre));
      if (apart > wholes_[a].radius + wholes_[b].radius) continue;
      const double distance = this->distance(a, b, poses[a].inverse() * poses[b]);
      if (!(distance > 0.0)) {
        report.contact =
            Contact{model.robot().body_of(a), std::nullopt, model.robot().body_of(b), links[a].name, links[b].name};
        return report;
      }
      if (distance > covers[a].excess + covers[b].excess) continue;
      const auto [of_a, of_b] = divide(distance, a, b);
      for (const auto& [link, share] : {std::pair(a, of_a), std::pair(b, of_b)}) {
        if (protrudes(covers[link])) report.room[link] = std::min(report.room[link], share);
      }
    }
  }
  return report;
}

double finest_excess(const Link& link) {
  constexpr double finest = 1e-3;
  return std::max(finest, least_cover_excess(link.solids, fit_options(finest)));
}

std::vector<std::string> fit_covers(Problem& problem, const CoverMaker& cover) {
  const ManipulatorScene* scene = problem.scene ? problem.scene->manipulator() : nullptr;
  if (scene == nullptr || scene->robot.exact()) return {};
  const std::vector<Link>& links = scene->robot.robot().tree().links();
  std::vector<View> ends = {problem.start};
  ends.insert(ends.end(), problem.goals.begin(), problem.goals.end());
  std::erase_if(ends, [&](View q) { return q.size() != problem.space.dimension() || !problem.space.contains(q); });
  std::shared_ptr<const Scene> fitted = problem.scene;
  std::map<std::size_t, MedialCover> finer;
  // Finer balls may lie where coarser ones do not, so an end may become invalid that was valid.
  for (bool changed = true; changed;) {
    changed = false;
    const auto checker = make_checker(problem.collision, fitted, problem.space, problem.resolution);
    ShapeChecker shapes(fitted);
    std::map<std::size_t, double> room;
    for (const View q : ends) {
      if (checker->valid(q)) continue;
      const ShapeReport report = shapes.at(q);
      if (!shapes.fits(report)) continue;
      for (std::size_t l = 0; l < links.size(); ++l) {
        // Of two links that are too near to each other, one cover may protrude less than its share already.
        if (report.room[l] > fitted->manipulator()->robot.covers().links[l].excess) continue;
        const auto [known, first] = room.emplace(l, report.room[l]);
        known->second = std::min(known->second, report.room[l]);
      }
    }
    for (const auto& [link, most] : room) {
      double excess = 0.5 * scene->robot.covers().options.excess;
      while (excess >= most) excess *= 0.5;
      finer[link] = cover(links[link].solids, fit_options(std::max(excess, shapes.finest(link))));
      changed = true;
    }
    if (changed) fitted = std::make_shared<const ManipulatorScene>(scene->world, scene->robot.with_covers(finer));
  }
  if (finer.empty()) return {};
  std::vector<std::string> texts;
  texts.reserve(finer.size());
  for (const auto& [link, own] : finer) {
    texts.push_back(
        fmt::format("'{}' is covered by {} balls that protrude at most {:.2g} cm, in place of {} and {:.2g} cm",
                    links[link].name, own.balls.size(), 100.0 * own.excess,
                    scene->robot.covers().links[link].balls.size(), 100.0 * scene->robot.covers().links[link].excess));
  }
  problem.scene = std::move(fitted);
  return {
      fmt::format("problem '{}': start or goal is so near to something that balls touch where the robot's shapes do "
                  "not: {}",
                  problem.name, fmt::join(texts, "; "))};
}

SphereModel with_standing_shapes(const SphereModel& robot, std::vector<StandingContact>& contacts) {
  const std::vector<Link>& links = robot.robot().tree().links();
  const std::vector<MedialCover>& covers = robot.covers().links;
  ShapeChecker shapes(std::make_shared<const ManipulatorScene>(World3(), robot));
  std::map<std::pair<std::size_t, std::size_t>, double> distances;
  for (std::size_t a = 0; a < links.size(); ++a) {
    for (std::size_t b = a + 1; b < links.size(); ++b) {
      if (covers[a].balls.empty() || covers[b].balls.empty() || !robot.stand(a, b) || !robot.checked(a, b)) continue;
      const Pose3 place = robot.robot().pose_in_body(a).inverse() * robot.robot().pose_in_body(b);
      const bool touch = std::any_of(covers[b].balls.begin(), covers[b].balls.end(), [&](const BodySphere& ball) {
        const Vec3 centre = place(ball.centre);
        return std::any_of(covers[a].balls.begin(), covers[a].balls.end(), [&](const BodySphere& other) {
          return norm(centre - other.centre) <= ball.radius + other.radius;
        });
      });
      if (!touch) continue;
      const double distance = shapes.distance(a, b, place);
      if (distance > shapes.finest(a) + shapes.finest(b)) {
        distances[{a, b}] = distance;
      } else {
        contacts.push_back({a, b, distance});
      }
    }
  }
  return distances.empty() ? robot : robot.with_standing_distances(distances);
}

}  // namespace trellis
