// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/input_warnings.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>

#include <trellis/base/error.hpp>
#include <trellis/experiment/targets.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/planar/skeleton.hpp>
#include <trellis/scene/planar/triangulation.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

namespace {

/// Warns of joint limits that are probably degrees.
void find_limits_in_degrees(const Problem& problem, std::vector<std::string>& warnings) {
  const PlanarScene* scene = problem.scene->planar();
  if (scene == nullptr) return;
  const auto& limits = scene->robot.limits();
  for (std::size_t i = 0; i < limits.size(); ++i) {
    constexpr double usual = 4.0;  // turns
    const double turns = limits[i] ? (limits[i]->second - limits[i]->first) / (2.0 * std::numbers::pi) : 0.0;
    if (turns <= usual) continue;
    warnings.push_back(fmt::format(
        "problem '{}': the limits of joint {}, {:g} and {:g}, are {:.1f} turns apart; angles are in radians, and "
        "degrees are written math.rad({:g})",
        problem.name, i + 1, limits[i]->first, limits[i]->second, turns, limits[i]->first));
  }
}

/// Warns of angles beyond a full turn.
void find_degrees(const Problem& problem, std::vector<std::string>& warnings) {
  const std::vector<Axis> axes = problem.space.coordinates();
  constexpr double full_turn = 2.0 * std::numbers::pi;
  for (const auto& [what, q] : named_ends(problem)) {
    for (std::size_t j = 0; j < std::min(q.size(), axes.size()); ++j) {
      const bool angle = axes[j].periodic && std::abs(axes[j].period() - full_turn) < 1e-9;
      if (!angle || std::abs(q[j]) <= full_turn) continue;
      warnings.push_back(fmt::format(
          "problem '{}': {}: {} = {:g} is more than a full turn; angles are in radians, and {:g} degrees are "
          "math.rad({:g}) = {:.4f}",
          problem.name, what, axes[j].name, q[j], q[j], q[j], q[j] * std::numbers::pi / 180.0));
    }
  }
}

/// The triangles that are connected with one of them.
std::vector<bool> connected(const Triangulation& free, std::uint32_t from) {
  std::vector<bool> seen(free.triangles().size(), false);
  std::vector<std::uint32_t> open = {from};
  seen[from] = true;
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    for (const auto& next : free.triangles()[at].neighbours) {
      if (!next || seen[*next]) continue;
      seen[*next] = true;
      open.push_back(*next);
    }
  }
  return seen;
}

/// Whether the robot covers its reference point, which then must stay in free space.
bool covers_reference(const Robot& robot) { return robot.is_point() || robot.inscribed_radius() > 0.0; }

/// A resolution at which the search steps over an obstacle.
struct CoarseResolution {
  double enough = 0.0;  ///< the resolution at which it does not
  std::string text;
};

std::optional<CoarseResolution> coarse_resolution(const Problem& problem) {
  // The motions of a point are exact at any resolution.
  if (problem.scene->is_point()) return std::nullopt;
  const auto thinnest = problem.scene->thinnest_obstacle();
  if (!thinnest) return std::nullopt;
  const double body = 2.0 * problem.scene->inscribed_radius();
  const double enough = thinnest->thickness + body;
  constexpr double rounding = 1e-9;
  if (problem.resolution <= enough * (1.0 + rounding) || enough == 0.0) return std::nullopt;
  std::string text = fmt::format(
      "problem '{}': between two configurations that are checked the robot moves by up to resolution = {:g} m, and {} "
      "is {:.3g} m thick{}: a search passes through it and its paths are refuted, which costs time; with resolution = "
      "{:.2g} it does not",
      problem.name, problem.resolution, problem.scene->obstacle_name(thinnest->obstacle), thinnest->thickness,
      body > 0.0 ? fmt::format(", the largest disc or ball about the robot's reference point {:.3g} m", body) : "",
      enough);
  return CoarseResolution{enough, std::move(text)};
}

/// Warns of resolutions at which the search steps over obstacles; of many problems of the coarsest alone.
void find_coarse_resolutions(const std::vector<Problem>& problems, std::vector<std::string>& warnings) {
  constexpr std::size_t many = 3;
  std::vector<CoarseResolution> found;
  for (const Problem& problem : problems) {
    if (auto one = coarse_resolution(problem)) found.push_back(std::move(*one));
  }
  if (found.size() <= many) {
    for (CoarseResolution& one : found) warnings.push_back(std::move(one.text));
    return;
  }
  const auto least =
      std::min_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.enough < b.enough; });
  warnings.push_back(
      fmt::format("{}; in {} other problems obstacles are too thin as well", least->text, found.size() - 1));
}

}  // namespace

bool separated(const Problem& problem) {
  if (problem.scene->planar() == nullptr) return false;
  const PlanarScene& scene = *problem.scene->planar();
  const auto& obstacles = scene.world.obstacles();
  // Polygons about discs may close a gap.
  const bool polygons = std::all_of(obstacles.begin(), obstacles.end(), [](const Obstacle& obstacle) {
    return !std::holds_alternative<Disc>(obstacle.shape);
  });
  constexpr std::size_t most_obstacles = 1000;  // a tenth of a second
  if (!polygons || obstacles.size() > most_obstacles || problem.reach || problem.goals.empty()) return false;
  if (problem.space.dimension() < 2 || !scene.robot.translates() || !covers_reference(scene.robot)) return false;
  if (!problem.space.flat() || problem.space.axes()[0].periodic || problem.space.axes()[1].periodic) return false;
  const auto [lo, hi] = scene.world.bounds();
  try {
    const Triangulation free(scene.world, std::max(hi.x - lo.x, hi.y - lo.y));
    const auto start = free.find({problem.start[0], problem.start[1]});
    if (!start) return false;
    const auto reached = connected(free, *start);
    return std::all_of(problem.goals.begin(), problem.goals.end(), [&](const Configuration& q) {
      const auto goal = free.find({q[0], q[1]});
      return goal && !reached[*goal];
    });
  } catch (const Error&) {
    return false;  // a world that has no such triangulation
  }
}

namespace {

/// A point of the medial axis, and groups of them that are joined.
class WidestRoutes {
 public:
  explicit WidestRoutes(std::size_t points) : parent_(points) { std::iota(parent_.begin(), parent_.end(), 0U); }
  void join(std::size_t a, std::size_t b) { parent_[root(a)] = root(b); }
  [[nodiscard]] bool joined(std::size_t a, std::size_t b) { return root(a) == root(b); }

 private:
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<std::size_t> parent_;
};

}  // namespace

std::string narrow_warning(const Problem& problem) {
  constexpr std::size_t most_obstacles = 200;  // a tenth of a second
  constexpr double rounding = 1e-6;
  const PlanarScene* scene = problem.scene->planar();
  if (scene == nullptr || scene->world.obstacles().size() > most_obstacles || problem.reach) return "";
  if (!problem.scene->translates() || problem.scene->inscribed_radius() <= 0.0 || problem.goals.empty()) return "";
  if (problem.space.dimension() < 2 || !problem.space.flat()) return "";
  if (problem.space.axes()[0].periodic || problem.space.axes()[1].periodic) return "";
  const double radius = problem.scene->inscribed_radius();
  try {
    const double spacing = problem.scene->diagonal() / 200.0;
    const Skeleton axis = medial_axis(scene->world, spacing);
    const auto point = problem.scene->of_point();
    const Space plane = point->default_space(1.0);
    const auto validity = make_validity("planar", point, plane, problem.resolution, nullptr);
    // Links between points of the axis, with the least clearance on them; then those of start and goals.
    struct Passage {
      double clearance;
      std::size_t from, to;
    };
    std::vector<Passage> links;
    const std::size_t ends = 1 + problem.goals.size();
    std::size_t count = ends + axis.vertices.size();
    const auto view = [](Vec2 p) { return Configuration{p.x, p.y}; };
    std::vector<std::pair<Vec2, std::size_t>> samples;
    std::vector<double> clearances;
    for (const Skeleton::Edge& edge : axis.edges) {
      std::size_t before = ends + edge.from;
      for (std::size_t i = 0; i < edge.points.size(); ++i) {
        const std::size_t at = i == 0 ? before : i + 1 == edge.points.size() ? ends + edge.to : count++;
        samples.emplace_back(edge.points[i], at);
        clearances.push_back(edge.clearance[i]);
        if (i > 0) links.push_back({std::min(edge.clearance[i - 1], edge.clearance[i]), before, at});
        before = at;
      }
    }
    if (samples.empty()) return "";
    for (std::size_t end = 0; end < ends; ++end) {
      const Configuration& q = end == 0 ? problem.start : problem.goals[end - 1];
      const Configuration from = {q[0], q[1]};
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!validity->motion(from, view(samples[i].first)).valid) continue;
        // A robot at its start is where it fits, whatever the samples about it.
        const double apart = std::hypot(samples[i].first.x - q[0], samples[i].first.y - q[1]);
        const bool about = apart <= clearances[i] + 2.0 * spacing;
        links.push_back({about ? std::max(clearances[i], radius) : clearances[i], end, samples[i].second});
      }
    }
    std::sort(links.begin(), links.end(), [](const Passage& a, const Passage& b) { return a.clearance > b.clearance; });
    WidestRoutes routes(count);
    for (const Passage& link : links) {
      routes.join(link.from, link.to);
      for (std::size_t goal = 1; goal < ends; ++goal) {
        if (!routes.joined(0, goal)) continue;
        if (link.clearance >= radius * (1.0 - rounding)) return "";
        return fmt::format(
            "problem '{}': the robot fits no gap between start and goal: the widest route is {:.3g} m wide, and the "
            "robot contains a disc {:.3g} m wide about its reference point",
            problem.name, 2.0 * link.clearance, 2.0 * radius);
      }
    }
    return "";  // separated, or not joined to the axis
  } catch (const Error&) {
    return "";  // a world without free space
  }
}

namespace {

/// Warns of a start and goal that obstacles separate for a point, and so for every robot that has it.
void find_separation(const Problem& problem, std::vector<std::string>& warnings) {
  if (!separated(problem)) return;
  warnings.push_back(
      fmt::format("problem '{}': obstacles separate start and goal: not even a point has a path, so no run can succeed",
                  problem.name));
}

/// The longest side of a box.
double longest(const Box3& box) {
  const Vec3 size = box.hi - box.lo;
  return std::max({size.x, size.y, size.z});
}

void add_once(std::string warning, std::vector<std::string>& warnings) {
  if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(std::move(warning));
}

/// Warns of joints {1, 2} on a rigid body, whose axes are no joints.
void find_numbered_axes(const GuideSpec& guide, const Problem& problem, const std::string& where,
                        std::vector<std::string>& warnings) {
  const auto* axes = std::get_if<std::vector<std::string>>(&guide.options().at("axes"));
  const Scene& scene = *problem.scene;
  if (axes == nullptr || scene.body_count() != 1 || !scene.translates()) return;
  const std::vector<Axis> coordinates = problem.space.coordinates();
  std::vector<std::string> kept;
  for (const std::string& axis : *axes) {
    const double number = parse_number(axis);
    if (!(number >= 1.0) || number > static_cast<double>(coordinates.size())) return;  // a name, or an error
    kept.push_back(coordinates[static_cast<std::size_t>(number) - 1].name);
  }
  if (kept.empty()) return;
  add_once(
      fmt::format("{}: the robot of problem '{}' is a rigid body and has no joints; 1 is its axis {}{}. If S is to "
                  "keep {}, write joints {{ \"{}\" }}",
                  where, problem.name, coordinates.front().name,
                  coordinates.size() > 1 ? fmt::format(", 2 is {}", coordinates[1].name) : "", fmt::join(kept, ", "),
                  fmt::join(kept, "\", \"")),
      warnings);
}

bool is_missing(const std::string& file) {
  std::error_code ignored;
  return !std::filesystem::exists(file, ignored);
}

/// Warns of a library that is not there, or has no path that can guide.
void find_library(const GuideSpec& guide, const Problem& problem, const std::string& where,
                  std::vector<std::string>& warnings) {
  const auto& file = std::get<std::string>(guide.options().at("db"));
  if (is_missing(file)) {
    add_once(fmt::format("{}: there is no library '{}', so it guides nothing; trellis run SCRIPT --learn {} makes it",
                         where, file, file),
             warnings);
    return;
  }
  std::vector<StoredPath> paths;
  try {
    paths = Library(file).paths();
  } catch (const Error&) {
    return;  // the guide itself reports it
  }
  const bool any_robot = std::get<std::string>(guide.options().at("robots")) == "any";
  const std::uint64_t space = identity(problem.space);
  const std::uint64_t robot = robot_hash(*problem.scene);
  const auto fits = [&](const StoredPath& p) { return p.space == space && (any_robot || p.robot == robot); };
  if (paths.empty() || std::any_of(paths.begin(), paths.end(), fits)) return;
  std::vector<std::string> others;
  for (const StoredPath& path : paths) {
    std::string other = fmt::format("that of problem '{}' in {}", path.problem, path.space_name);
    if (std::find(others.begin(), others.end(), other) == others.end()) others.push_back(std::move(other));
  }
  constexpr std::size_t most = 3;
  const std::size_t more = others.size() > most ? others.size() - most : 0;
  others.resize(others.size() - more);
  const bool same_space =
      std::any_of(paths.begin(), paths.end(), [&](const StoredPath& p) { return p.space == space; });
  add_once(fmt::format(
               "{}: the library '{}' has no path of the robot '{}' of problem '{}' in {}, so it guides nothing there; "
               "its robots are {}{}{}",
               where, file, problem.scene->robot_name(), problem.name, problem.space.name(), fmt::join(others, ", "),
               more > 0 ? fmt::format(" and {} more", more) : "",
               same_space && !any_robot ? "; robots = \"any\" uses the paths of other robots" : ""),
           warnings);
}

void find_model(const GuideSpec& guide, const std::string& where, std::vector<std::string>& warnings) {
  const auto& file = std::get<std::string>(guide.options().at("model"));
  if (!is_missing(file)) return;
  add_once(fmt::format("{}: there is no model '{}', so it guides nothing; trellis experience --data makes it (trellis "
                       "help experience)",
                       where, file),
           warnings);
}

/// Warns of an arm whose thin one a single tree without bounded loss searches: thinner links leave its reach as it is,
/// so that search costs what that of the arm costs.
void find_single_tree_of_arm(const GuideSpec& guide, const Problem& problem, const std::string& strategy,
                             std::vector<std::string>& warnings) {
  if (problem.scene->translates() || !guide.planner() || guide.planner()->name() != "rrt") return;
  const auto* bound = std::get_if<double>(&guide.planner()->options().at("bound"));
  if (bound == nullptr || *bound != 0.0) return;
  add_once(fmt::format("strategy '{}': of a robot that is fixed to its base, shrink makes only the links thinner, so a "
                       "single tree reaches the goal in S no sooner than in C; two trees at every level cost less: "
                       "planner = rrt_connect {{}}, an option of strategies.irc, strategies.vonasek and shrink",
                       strategy),
           warnings);
}

/// Warns of a skeleton for a robot that has no disc about its reference point: it then plans for a point.
void find_reference_at_rim(const GuideSpec& guide, const Problem& problem, const std::string& where,
                           std::vector<std::string>& warnings) {
  constexpr double least = 0.01;  // of the bounding radius
  const Scene& scene = *problem.scene;
  if (!std::get<bool>(guide.options().at("prune")) || scene.is_point() || !scene.translates()) return;
  if (scene.inscribed_radius() > least * scene.bounding_radius()) return;
  add_once(
      fmt::format(
          "{}: the reference point of the robot of problem '{}' lies {} its body, so that the guide plans "
          "for a point and keeps gaps that are too narrow for the robot; robot:recentred() is the same body about a "
          "point well inside it, with a function for start and goal",
          where, problem.name, scene.inscribed_radius() > 0.0 ? "near the rim of" : "outside or on the rim of"),
      warnings);
}

/// Warns of `informed` under a planner that ends at its first path: until then the guide draws uniformly.
void find_uninformed(const GuideSpec& guide, const PlannerSpec& planner, const std::string& where,
                     std::vector<std::string>& warnings) {
  const PlannerKind* kind = find_planner(planner.name());
  const bool anytime = kind != nullptr && kind->component->find("improve") != nullptr;
  if (anytime || std::isfinite(std::get<double>(guide.options().at("cost")))) return;
  add_once(fmt::format("{}: it changes nothing: it draws uniformly until a path is known, and {} ends with its first "
                       "path; give it the option cost, or a planner that improves its path, such as rrt_star",
                       where, planner.name()),
           warnings);
}

/// \param root  the planner at the root if the guide's proposals are for it, else nullptr: a search below continues
/// after
///     its first path
void find_useless(const GuideSpec& guide, const PlannerSpec* root, const Problem& problem, const std::string& strategy,
                  std::vector<std::string>& warnings) {
  if (guide.kind() != GuideSpec::Kind::component) {
    for (const auto& term : guide.terms()) find_useless(term.guide, root, problem, strategy, warnings);
    return;
  }
  if (guide.name() == "shrink" && !guide.custom() && problem.scene->is_point()) {
    warnings.push_back(
        fmt::format("{} in strategy '{}': the robot of problem '{}' is a point, which has nothing to shrink",
                    guide.text_alone(), strategy, problem.name));
  }
  if (guide.name() == "shrink" && !guide.custom()) find_single_tree_of_arm(guide, problem, strategy, warnings);
  if (!guide.custom()) {
    const std::string where = fmt::format("{} in strategy '{}'", guide.text_alone(), strategy);
    if (guide.name() == "joints") find_numbered_axes(guide, problem, where, warnings);
    if (guide.name() == "experience" || guide.name() == "path_database") find_library(guide, problem, where, warnings);
    if (guide.name() == "learned") find_model(guide, where, warnings);
    if (guide.name() == "skeleton") find_reference_at_rim(guide, problem, where, warnings);
    if (guide.name() == "informed" && root != nullptr) find_uninformed(guide, *root, where, warnings);
  }
  if (guide.below() != nullptr) find_useless(*guide.below(), nullptr, problem, strategy, warnings);
}

/// Returns the planner's longest extension; none where it has no such option.
std::optional<double> step_of(const PlannerSpec& planner) {
  const PlannerKind* kind = find_planner(planner.name());
  if (kind == nullptr || kind->component->find("step") == nullptr) return std::nullopt;
  const auto* step = std::get_if<double>(&planner.options().at("step"));
  return step != nullptr ? std::optional(*step) : std::nullopt;
}

/// Warns of guided strategies with the baseline's planner and another step: the comparison is then one of steps too.
void find_unequal_steps(const Experiment& experiment, std::vector<std::string>& warnings) {
  const std::string baseline = baseline_of(experiment);
  const auto& strategies = experiment.strategies;
  const auto of =
      std::find_if(strategies.begin(), strategies.end(), [&](const auto& s) { return s.first == baseline; });
  if (of == strategies.end() || of->second.guide() != nullptr) return;
  const std::optional<double> usual = step_of(of->second.planner());
  if (!usual) return;
  for (const auto& [name, strategy] : strategies) {
    const std::optional<double> step = step_of(strategy.planner());
    const bool same = strategy.planner().name() == of->second.planner().name();
    if (strategy.guide() == nullptr || !same || !step || *step == *usual) continue;
    // Another strategy without guides may have this step.
    const bool fair = std::any_of(strategies.begin(), strategies.end(), [&](const auto& other) {
      return other.second.guide() == nullptr && step_of(other.second.planner()) == step;
    });
    if (fair) continue;
    warnings.push_back(
        fmt::format("strategy '{}': its step is {:g} m, and that of the baseline '{}' {:g} m: the comparison shows the "
                    "step and the "
                    "guide together",
                    name, *step, baseline, *usual));
  }
}

/// Warns of a target that has no figure in the problem's space.
void find_unmeasurable(const Measure& measure, const Problem& problem, std::vector<std::string>& warnings) {
  if (!std::holds_alternative<NearOptimalSettings>(measure.target)) return;
  if (const std::string reason = unfit_near_optimal(problem.space); !reason.empty()) {
    add_once(fmt::format("experiment on problem '{}': {}", problem.name, reason), warnings);
  }
}

}  // namespace

std::string unit_warning(const Problem& problem) {
  const World3* space = spatial_world(*problem.scene);
  if (space == nullptr) return "";
  double size = 0.0;
  std::string what;
  const auto examine = [&](const std::string& name, const Solid& solid) {
    if (!std::holds_alternative<std::shared_ptr<const Mesh>>(solid.shape)) return;
    const double extent = longest(bounding_box(solid));
    if (extent <= size) return;
    size = extent;
    what = name;
  };
  for (const Obstacle3& obstacle : space->obstacles()) examine(obstacle.name, obstacle.solid);
  if (const SpatialScene* scene = problem.scene->spatial()) {
    for (const Solid& solid : scene->robot.solids()) examine("the robot", solid);
  }
  constexpr double much = 30.0;  // inches are 39 times metres, centimetres 100, millimetres 1000
  const double world = longest(space->bounds());
  if (size < much * world) return "";
  return fmt::format(
      "{} extends {:.4g} m in a world of {:.4g} m; if the numbers of its mesh are millimetres, give mesh unit = \"mm\" "
      "(there are \"cm\" and \"inch\" too)",
      what, size, world);
}

std::vector<std::string> input_warnings(const Experiment& experiment) {
  std::vector<std::string> warnings;
  find_coarse_resolutions(experiment.problems, warnings);
  for (const Problem& problem : experiment.problems) {
    find_degrees(problem, warnings);
    find_limits_in_degrees(problem, warnings);
    find_separation(problem, warnings);
    if (const std::string warning = unit_warning(problem); !warning.empty()) {
      warnings.push_back(fmt::format("problem '{}': {}", problem.name, warning));
    }
    if (experiment.measure) find_unmeasurable(*experiment.measure, problem, warnings);
    for (const auto& [name, strategy] : experiment.strategies) {
      if (strategy.guide() != nullptr) find_useless(*strategy.guide(), &strategy.planner(), problem, name, warnings);
    }
  }
  find_unequal_steps(experiment, warnings);
  return warnings;
}

}  // namespace trellis
