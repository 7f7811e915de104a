// SPDX-License-Identifier: GPL-3.0-or-later
// The strategies of a script on many problems, in groups: those whose names begin alike, "cage/0001" and "cage/0003".
//
//   bench_arms SCRIPT.lua [--hard] [--library FILE] [--repair FILE N] [--moved DISTANCE] [--points N RADIUS] [--states]
//
// Prints for each strategy a line for each group: problems solved, median and 95th percentile of the CPU time of
// planning and of the path's certificate, of validity checks over all levels and of the length; and of the checks and
// the CPU time the median of the ratios to those of the first strategy on the same problem and seed. --hard: only
// problems on which the first strategy needs more checks than on half of them. --library: no planning; how far goals
// are from the nearest end of a path in this library. --repair: on the harder half, retrieval with repair (Lightning)
// beside the first strategy: of the N paths of a library whose ends are nearest to start and goal it takes the one of
// which least is invalid, and the first strategy plans each invalid part, from the last valid point before to the next
// one after. --moved: each goal is moved so far in the metric, in a random
// direction; problems for which 100 directions give no valid goal are left out. --points: the obstacles' surfaces are
// sampled, uniformly, as a cloud of N points of this radius in metres; problems whose ends touch it are left out, and
// the CPU time that its index takes is printed. --states: no planning; the CPU time of checks, of random configurations
// and along random motions of length 1 from valid ones, for each number of obstacles; with --points, of a kd-tree too.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/space/nearest.hpp>
#include <trellis/strategy/executor.hpp>

#include "se3_bench.hpp"

namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

std::string group_of(const trellis::Problem& problem) { return problem.name.substr(0, problem.name.find('/')); }

struct Sample {
  bool solved = false;
  double us = 0.0;
  double certificate_us = 0.0;
  double checks = 0.0;
  double length = 0.0;
};

void print_header() {
  std::printf("  %-24s %9s %9s %9s %9s %9s %9s %8s %7s %7s\n", "group", "solved", "us median", "us 95 %", "cert us",
              "checks", "checks95", "length", "checks:", "us:");
}

void print(const std::string& name, const std::vector<Sample>& samples, const std::vector<Sample>& baseline) {
  std::size_t solved = 0;
  std::vector<double> us, certificate, checks, lengths, checks_ratio, us_ratio;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample& s = samples[i];
    const Sample& b = baseline[i];
    if (s.solved || b.solved) {
      constexpr double infinity = std::numeric_limits<double>::infinity();
      checks_ratio.push_back(!s.solved ? infinity : !b.solved ? 0.0 : s.checks / b.checks);
      us_ratio.push_back(!s.solved ? infinity : !b.solved ? 0.0 : s.us / b.us);
    }
    if (!s.solved) continue;
    ++solved;
    us.push_back(s.us);
    certificate.push_back(s.certificate_us);
    checks.push_back(s.checks);
    lengths.push_back(s.length);
  }
  std::printf("  %-24s %4zu/%4zu %9.0f %9.0f %9.0f %9.0f %9.0f %8.2f %7.2f %7.2f\n", name.c_str(), solved,
              samples.size(), quantile(us, 0.5), quantile(us, 0.95), quantile(certificate, 0.5), quantile(checks, 0.5),
              quantile(checks, 0.95), quantile(lengths, 0.5), quantile(checks_ratio, 0.5), quantile(us_ratio, 0.5));
}

/// The problem among points on the surfaces of its obstacles.
trellis::Problem among_points(const trellis::Problem& problem, std::size_t count, double radius) {
  using namespace trellis;
  const ManipulatorScene& scene = *problem.scene->manipulator();
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<double> areas;  // of the triangles before, and of this one
  for (const Obstacle3& obstacle : scene.world.obstacles()) {
    const draw::Surface surface = surface_of(obstacle.solid);
    for (const auto& [a, b, c] : surface.triangles) {
      const auto at = [&](std::uint32_t i) {
        const draw::Point3& p = surface.vertices[i];
        return Vec3{p.x, p.y, p.z};
      };
      triangles.push_back({at(a), at(b), at(c)});
      const auto& [p, q, r] = triangles.back();
      areas.push_back((areas.empty() ? 0.0 : areas.back()) + norm(cross(q - p, r - p)));
    }
  }
  Stream stream(1, problem.name, "points");
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count && !areas.empty(); ++i) {
    const auto at = std::lower_bound(areas.begin(), areas.end(), stream.uniform(0.0, areas.back()));
    const auto& [p, q, r] = triangles[static_cast<std::size_t>(std::min(at, areas.end() - 1) - areas.begin())];
    const double u = std::sqrt(stream.uniform(0.0, 1.0)), v = stream.uniform(0.0, 1.0);
    points.push_back(p + u * (q - p) + u * v * (r - q));
  }
  auto cloud = std::make_shared<const PointCloud>(std::move(points), radius, "points");
  Problem made = problem;
  made.scene = std::make_shared<ManipulatorScene>(scene.world.with({{"points", {std::move(cloud), {}}}}), scene.robot);
  return made;
}

/// The problem with its goal moved in a random direction; none where no direction gives a valid goal.
std::optional<trellis::Problem> with_goal_moved(const trellis::Problem& problem, double distance) {
  using namespace trellis;
  constexpr int tries = 100;
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  Stream stream(1, problem.name, "moved");
  Problem made = problem;
  Configuration by(problem.space.degrees());
  for (int i = 0; i < tries; ++i) {
    double squared = 0.0;
    for (double& x : by) x = stream.normal(), squared += x * x;
    for (double& x : by) x *= distance / std::sqrt(squared);
    problem.space.exp(problem.goals.front(), by, made.goals.front());
    problem.space.normalise(made.goals.front());
    if (problem.space.contains(made.goals.front()) && checker->valid(made.goals.front())) return made;
  }
  return std::nullopt;
}

/// Prints for each group the median distance of a goal from the nearest end of a stored path.
void print_distances(const trellis::Experiment& experiment, const std::string& library) {
  using namespace trellis;
  const auto stored = known_paths(library);
  if (stored->empty()) throw std::invalid_argument("no paths in " + library);
  std::map<std::string, std::vector<double>> nearest;
  for (const Problem& problem : experiment.problems) {
    double least = std::numeric_limits<double>::infinity();
    for (const StoredPath& path : *stored) {
      if (path.path.dimension() != problem.space.dimension()) continue;
      for (const View end : {path.path.front(), path.path.back()}) {
        least = std::min(least, problem.space.distance(end, problem.goals.front()));
      }
    }
    for (const std::string& group : {group_of(problem), std::string("all")}) nearest[group].push_back(least);
  }
  std::printf("%-24s %8s %8s %8s  to the nearest end of %zu paths\n", "group", "10 %", "median", "90 %",
              stored->size());
  for (const auto& [group, of] : nearest) {
    std::printf("%-24s %8.2f %8.2f %8.2f\n", group.c_str(), quantile(of, 0.1), quantile(of, 0.5), quantile(of, 0.9));
  }
}

/// A path to repair: some of its motions are valid.
struct Retrieved {
  trellis::Configurations points;
  std::vector<bool> valid;                                   ///< of each motion
  double invalid = std::numeric_limits<double>::infinity();  ///< its length
};

/// Returns the stored paths whose ends are nearest to start and goal, with these ends, nearest first.
std::vector<trellis::Configurations> retrieved(const std::vector<trellis::StoredPath>& stored,
                                               const trellis::Problem& problem, std::size_t count) {
  using namespace trellis;
  std::vector<std::pair<double, Configurations>> all;
  for (const StoredPath& path : stored) {
    if (path.path.dimension() != problem.space.dimension()) continue;
    for (const bool back : {false, true}) {
      Configurations points(problem.space.dimension());
      points.push(problem.start);
      for (std::size_t i = 0; i < path.path.size(); ++i) points.push(path.path[back ? path.path.size() - 1 - i : i]);
      points.push(problem.goals.front());
      const double apart = problem.space.distance(points[0], points[1]) +
                           problem.space.distance(points[points.size() - 2], points[points.size() - 1]);
      all.emplace_back(apart, std::move(points));
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Configurations> nearest;
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i) nearest.push_back(std::move(all[i].second));
  return nearest;
}

/// Plans by retrieval with repair.
/// \param gap  receives the length of the longest part that is repaired, from end to end
Sample plan_by_repair(const trellis::StrategySpec& strategy, const trellis::Problem& problem, std::uint64_t seed,
                      const std::vector<trellis::StoredPath>& stored, std::size_t count, double& gap) {
  using namespace trellis;
  const double before = bench::cpu_seconds();
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  Sample sample{.solved = true};
  Retrieved best{Configurations(problem.space.dimension()), {}};
  for (Configurations& points : retrieved(stored, problem, count)) {
    Retrieved path{std::move(points), {}, 0.0};
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
      const MotionReport report = checker->motion(path.points[i], path.points[i + 1]);
      sample.checks += report.checks;
      path.valid.push_back(report.valid);
      if (!report.valid) path.invalid += problem.space.distance(path.points[i], path.points[i + 1]);
    }
    if (path.invalid < best.invalid) best = std::move(path);
  }
  gap = 0.0;
  for (std::size_t i = 0; i < best.valid.size();) {
    if (best.valid[i]) {
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    for (; end < best.valid.size(); ++end) {
      sample.checks += 1.0;
      if (best.valid[end] && checker->valid(best.points[end])) break;
    }
    const auto at = [&](std::size_t k) { return Configuration(best.points[k].begin(), best.points[k].end()); };
    Problem part = problem;
    part.start = at(i);
    part.goals = {at(end)};
    gap = std::max(gap, problem.space.distance(part.start, part.goals.front()));
    const RunRecord run = execute(strategy, part, seed);
    sample.solved = sample.solved && run.solved;
    sample.checks += static_cast<double>(run.validity_checks);
    i = end;
  }
  sample.us = 1e6 * (bench::cpu_seconds() - before);
  return sample;
}

/// Prints how retrieval with repair does on the problems on which the first strategy needs more checks than on half of
/// them.
void print_repairs(const trellis::Experiment& experiment, const std::string& library, std::size_t count) {
  using namespace trellis;
  const auto stored = known_paths(library);
  if (stored->empty()) throw std::invalid_argument("no paths in " + library);
  const StrategySpec& strategy = experiment.strategies.front().second;
  struct Plain {
    const Problem* problem;
    std::uint64_t seed;
    Sample sample;
  };
  std::vector<Plain> all;
  std::vector<double> checks;
  for (const Problem& problem : experiment.problems) {
    for (const std::uint64_t seed : experiment.seeds) {
      const double before = bench::cpu_seconds();
      const RunRecord run = execute(strategy, problem, seed);
      all.push_back({&problem, seed, {.solved = run.solved, .us = 1e6 * (bench::cpu_seconds() - before)}});
      all.back().sample.checks = run.solved ? static_cast<double>(run.validity_checks) : 1e300;
      checks.push_back(all.back().sample.checks);
    }
  }
  const double least = quantile(checks, 0.5);
  std::vector<Sample> plain, repaired;
  std::vector<double> gaps;
  for (const Plain& run : all) {
    if (run.sample.checks <= least) continue;
    plain.push_back(run.sample);
    repaired.push_back(plan_by_repair(strategy, *run.problem, run.seed, *stored, count, gaps.emplace_back()));
  }
  print_header();
  print("the first strategy", plain, plain);
  print("retrieval with repair", repaired, plain);
  std::printf("longest part that is repaired, from end to end: median %.2f\n", quantile(gaps, 0.5));
}

struct States {
  double configurations = 0.0, configuration_us = 0.0;
  double states = 0.0, motion_us = 0.0;
  double motions = 0.0, valid = 0.0;
  double tree_us = 0.0, tree_states = 0.0, tree_balls = 0.0;  ///< of a kd-tree of the cloud's points
};

/// Adds the queries of a kd-tree of the cloud's points that decide valid configurations: the nearest point of each
/// ball.
void check_by_tree(const trellis::ManipulatorScene& scene, const std::vector<trellis::Configuration>& free,
                   States& sum) {
  using namespace trellis;
  const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&scene.world.obstacles().front().solid.shape);
  if (cloud == nullptr) return;
  NearestIndex tree(Space::euclidean({{-1e3, 1e3}, {-1e3, 1e3}, {-1e3, 1e3}}));
  for (const Vec3& p : (*cloud)->points()) tree.add(std::array{p.x, p.y, p.z});
  // Of each configuration's bodies: their bounding ball, then the others.
  std::vector<std::vector<std::array<double, 4>>> bodies;
  for (const Configuration& q : free) {
    for (std::size_t body = 0; body < scene.robot.bodies().size(); ++body) {
      auto& balls = bodies.emplace_back();
      for (const BodySphere& ball : scene.robot.bodies()[body]) {
        const Vec3 at = scene.robot.position({body, ball.centre}, q);
        const double reach = ball.radius + (*cloud)->radius();
        balls.push_back({at.x, at.y, at.z, reach * reach});
      }
    }
  }
  const auto met = [&](const std::array<double, 4>& ball) {
    sum.tree_balls += 1.0;
    return tree.nearest(View(ball).first(3)).squared_distance <= ball[3];
  };
  bool near = false;
  const double begin = bench::cpu_seconds();
  for (const auto& balls : bodies) {
    if (!balls.empty() && met(balls.front())) near |= std::any_of(balls.begin() + 1, balls.end(), met);
  }
  sum.tree_us += 1e6 * (bench::cpu_seconds() - begin);
  sum.tree_states += static_cast<double>(free.size());
  if (near) throw std::logic_error("the kd-tree finds a ball of a valid configuration in collision");
}

/// Adds the checks of random configurations and motions.
void check_states(const trellis::Problem& problem, States& sum) {
  using namespace trellis;
  constexpr int count = 2000;
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  Stream stream(1, problem.name, "states");
  std::vector<Configuration> drawn(count, Configuration(problem.space.dimension()));
  for (Configuration& q : drawn) problem.space.sample_uniform(stream, q);
  std::vector<Configuration> free;
  const double before = bench::cpu_seconds();
  for (const Configuration& q : drawn) {
    if (checker->valid(q)) free.push_back(q);
  }
  const double between = bench::cpu_seconds();
  sum.configurations += count;
  sum.configuration_us += 1e6 * (between - before);
  std::vector<Configuration> ends = free;
  for (Configuration& q : ends) {
    Configuration by(q.size());
    double squared = 0.0;
    for (double& x : by) x = stream.normal(), squared += x * x;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += by[j] / std::sqrt(squared);
    problem.space.reflect(q);
  }
  const double begin = bench::cpu_seconds();
  for (std::size_t i = 0; i < free.size(); ++i) {
    const MotionReport report = checker->motion(free[i], ends[i]);
    sum.states += report.checks;
    sum.valid += report.valid ? 1.0 : 0.0;
  }
  sum.motion_us += 1e6 * (bench::cpu_seconds() - begin);
  check_by_tree(*problem.scene->manipulator(), free, sum);
  sum.motions += static_cast<double>(free.size());
}

void print_states(const trellis::Experiment& experiment, std::size_t points, double radius) {
  std::map<std::size_t, States> all;
  for (const trellis::Problem& problem : experiment.problems) {
    if (points == 0) {
      check_states(problem, all[problem.scene->obstacle_count()]);
    } else {
      check_states(among_points(problem, points, radius), all[points]);
    }
  }
  std::printf("%9s %13s %12s %13s %12s\n", points == 0 ? "obstacles" : "points", "ns a random", "ns a state",
              "us a motion", "valid share");
  for (const auto& [obstacles, s] : all) {
    std::printf("%9zu %13.0f %12.0f %13.2f %12.2f\n", obstacles, 1e3 * s.configuration_us / s.configurations,
                1e3 * s.motion_us / s.states, s.motion_us / s.motions, s.valid / s.motions);
    if (s.tree_states == 0.0) continue;
    std::printf(
        "kd-tree of the points, nearest neighbours of valid configurations' balls: %.0f ns a configuration, "
        "%.0f ns a query\n",
        1e3 * s.tree_us / s.tree_states, 1e3 * s.tree_us / s.tree_balls);
  }
}

}  // namespace

int main(int count, char** arguments) {
  using namespace trellis;
  try {
    const std::vector<std::string> given(arguments + 1, arguments + count);
    if (given.empty()) throw std::invalid_argument("needs SCRIPT.lua");
    bool hard = false;
    bool states = false;
    std::size_t points = 0;
    double radius = 0.0;
    double moved = 0.0;
    std::string library;
    std::size_t repaired = 0;
    for (std::size_t i = 1; i < given.size(); ++i) {
      if (given[i] == "--hard") {
        hard = true;
      } else if (given[i] == "--states") {
        states = true;
      } else if (given[i] == "--library" && i + 1 < given.size()) {
        library = given[++i];
      } else if (given[i] == "--repair" && i + 2 < given.size()) {
        library = given[i + 1];
        repaired = std::stoul(given[i + 2]);
        i += 2;
      } else if (given[i] == "--moved" && i + 1 < given.size()) {
        moved = std::stod(given[++i]);
      } else if (given[i] == "--points" && i + 2 < given.size()) {
        points = std::stoul(given[i + 1]);
        radius = std::stod(given[i + 2]);
        i += 2;
      } else {
        throw std::invalid_argument(
            "the options are --hard, --library FILE, --repair FILE N, --moved DISTANCE, --points N RADIUS and "
            "--states, "
            "got " +
            given[i]);
      }
    }
    std::vector<double> index_us;
    std::size_t touched = 0;
    const dsl::Program program = dsl::load_script(given[0]);
    const Experiment& experiment = program.experiment;
    if (states) {
      print_states(experiment, points, radius);
      return 0;
    }
    if (repaired > 0) {
      print_repairs(experiment, library, repaired);
      return 0;
    }
    if (!library.empty()) {
      print_distances(experiment, library);
      return 0;
    }
    std::vector<std::string> groups;
    std::vector<std::vector<Sample>> all(experiment.strategies.size());
    for (const Problem& given_problem : experiment.problems) {
      Problem problem = points > 0 ? among_points(given_problem, points, radius) : given_problem;
      if (moved > 0.0) {
        const auto with_other_goal = with_goal_moved(problem, moved);
        if (!with_other_goal) continue;
        problem = *with_other_goal;
      }
      if (points > 0) {
        const double before = bench::cpu_seconds();
        const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
        index_us.push_back(1e6 * (bench::cpu_seconds() - before));
        if (!checker->valid(problem.start) || !checker->valid(problem.goals.front())) {
          ++touched;
          continue;
        }
      }
      for (const std::uint64_t seed : experiment.seeds) {
        groups.push_back(group_of(problem));
        for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
          const double before = bench::cpu_seconds();
          const RunRecord run = execute(experiment.strategies[s].second, problem, seed);
          const double after = bench::cpu_seconds();
          all[s].push_back({run.solved, 1e6 * (after - before), 1e6 * run.path_seconds,
                            static_cast<double>(run.validity_checks), run.length});
          if (!run.solved) {
            std::fprintf(stderr, "not solved: %s by %s\n", problem.name.c_str(),
                         experiment.strategies[s].first.c_str());
          }
        }
      }
    }
    if (points > 0) {
      std::printf("%zu points of radius %g m: %zu of %zu problems have valid ends; index, us median %.0f\n", points,
                  radius, experiment.problems.size() - touched, experiment.problems.size(), quantile(index_us, 0.5));
    }
    std::vector<double> first;
    for (const Sample& sample : all[0]) first.push_back(sample.solved ? sample.checks : 1e300);
    const double least = hard ? quantile(first, 0.5) : -1.0;
    for (std::size_t s = 0; s < all.size(); ++s) {
      std::printf("%s: %s\n", experiment.strategies[s].first.c_str(), experiment.strategies[s].second.text().c_str());
      print_header();
      std::map<std::string, std::pair<std::vector<Sample>, std::vector<Sample>>> tables;
      std::pair<std::vector<Sample>, std::vector<Sample>> whole;
      for (std::size_t i = 0; i < groups.size(); ++i) {
        if (first[i] <= least) continue;
        for (auto* table : {&tables[groups[i]], &whole}) {
          table->first.push_back(all[s][i]);
          table->second.push_back(all[0][i]);
        }
      }
      for (const auto& [name, table] : tables) print(name, table.first, table.second);
      print("all", whole.first, whole.second);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_arms: %s\n", error.what());
    return 1;
  }
}
