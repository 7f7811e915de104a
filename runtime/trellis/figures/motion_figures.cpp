// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <utility>

#include <trellis/base/parallel.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/draw/motion.hpp>
#include <trellis/draw/spatial.hpp>
#include <trellis/figures/charts/pictures.hpp>
#include <trellis/figures/scene_figures.hpp>
#include <trellis/figures/world_shapes.hpp>
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/pictures/traces.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

namespace {

using draw::CellMap;
using draw::MotionFigure;
using draw::MotionRow;
using draw::Point;

/// Cells of the space along its longer side.
constexpr double finest_blocked = 240.0;
constexpr double finest_density = 160.0;
constexpr std::size_t most_poses = 15;

Point point(View q) { return {q[0], q[1]}; }

draw::SpaceAxis axis_of(const Axis& axis) {
  const bool turn = axis.periodic && std::abs(axis.period() - 2.0 * std::numbers::pi) < 1e-9;
  return {axis.name, axis.lo, axis.hi, turn || axis.name.starts_with("theta")};
}

template <class F>
CellMap map_of(const Space& space, double finest, const F& value) {
  const Axis& x = space.axes()[0];
  const Axis& y = space.axes()[1];
  const double longer = std::max(x.hi - x.lo, y.hi - y.lo);
  const auto count = [&](const Axis& axis) {
    return static_cast<std::size_t>(std::max(16.0, std::round(finest * (axis.hi - axis.lo) / longer)));
  };
  CellMap map{count(x), count(y), {}};
  map.values.reserve(map.columns * map.rows);
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const Configuration q = {
          x.lo + (static_cast<double>(column) + 0.5) / static_cast<double>(map.columns) * (x.hi - x.lo),
          y.lo + (static_cast<double>(row) + 0.5) / static_cast<double>(map.rows) * (y.hi - y.lo)};
      map.values.push_back(value(q));
    }
  }
  return map;
}

/// Splits a path into straight pieces: a leg that wraps around an axis leaves the picture on one side and returns on
/// the other.
std::vector<std::vector<Point>> pieces_of(const Space& space, const Configurations& path) {
  std::vector<std::vector<Point>> pieces;
  if (path.size() == 0) return pieces;
  pieces.push_back({point(path[0])});
  Configuration difference(2);
  for (std::size_t i = 1; i < path.size(); ++i) {
    space.difference(path[i - 1], path[i], difference);
    // The parameters of the leg at which it wraps around an axis.
    std::vector<std::pair<double, std::size_t>> rounds;
    for (std::size_t j = 0; j < 2; ++j) {
      const Axis& axis = space.axes()[j];
      const double end = path[i - 1][j] + difference[j];
      if (!axis.periodic || (end >= axis.lo && end < axis.hi)) continue;
      rounds.emplace_back(((difference[j] > 0.0 ? axis.hi : axis.lo) - path[i - 1][j]) / difference[j], j);
    }
    std::sort(rounds.begin(), rounds.end());
    Point shift{};
    for (const auto& [share, j] : rounds) {
      const Point edge{path[i - 1][0] + share * difference[0] + shift.x,
                       path[i - 1][1] + share * difference[1] + shift.y};
      const double turn = difference[j] > 0.0 ? -space.axes()[j].period() : space.axes()[j].period();
      (j == 0 ? shift.x : shift.y) += turn;
      pieces.back().push_back(edge);
      pieces.push_back({j == 0 ? Point{edge.x + turn, edge.y} : Point{edge.x, edge.y + turn}});
    }
    pieces.back().push_back(point(path[i]));
  }
  return pieces;
}

/// Returns configurations at even distances along a path, with both ends.
Configurations poses_along(const Space& space, const Configurations& path) {
  Configurations poses(space.dimension());
  if (path.size() == 0) return poses;
  const double length = path_length(space, path);
  const std::size_t count = length > 0.0 ? most_poses : 1;
  Configuration q(space.dimension());
  std::size_t leg = 1;
  double before = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = count > 1 ? length * static_cast<double>(k) / static_cast<double>(count - 1) : 0.0;
    while (leg + 1 < path.size() && before + space.distance(path[leg - 1], path[leg]) < at) {
      before += space.distance(path[leg - 1], path[leg]);
      ++leg;
    }
    if (path.size() == 1 || count == 1) {
      poses.push(path[0]);
      continue;
    }
    const double span = space.distance(path[leg - 1], path[leg]);
    space.interpolate(path[leg - 1], path[leg], span > 0.0 ? std::clamp((at - before) / span, 0.0, 1.0) : 1.0, q);
    poses.push(q);
  }
  return poses;
}

/// Whether a density is the same everywhere: shades of it would show nothing.
bool flat(const CellMap& density) {
  const auto [least, most] = std::minmax_element(density.values.begin(), density.values.end());
  return density.values.empty() || *most <= 1.01 * *least;
}

/// One problem's pictures.
class MotionPictures {
 public:
  explicit MotionPictures(const Problem& problem)
      : problem_(problem), checker_(make_checker("planar", problem.scene, problem.space, problem.resolution)) {
    const World& world = planar(*problem.scene).world;
    const auto& [lo, hi] = world.bounds();
    frame_.world = {lo.x, lo.y, hi.x - lo.x, hi.y - lo.y};
    frame_.obstacles.reserve(world.obstacles().size());
    for (const Obstacle& obstacle : world.obstacles()) frame_.obstacles.push_back(drawn(obstacle.shape));
    frame_.x = axis_of(problem.space.axes()[0]);
    frame_.y = axis_of(problem.space.axes()[1]);
    Configuration end = problem.start;
    problem.space.normalise(end);
    frame_.start = point(end);
    end = problem.goal();
    problem.space.normalise(end);
    frame_.goal = point(end);
    frame_.blocked = map_of(problem.space, finest_blocked, [&](View q) { return checker_->valid(q) ? 0.0 : 1.0; });
  }

  /// Whether the space is more than the robot's position in the world.
  [[nodiscard]] static bool possible(const Problem& problem) {
    return problem.scene != nullptr && problem.scene->planar() != nullptr && problem.scene->members().size() < 2 &&
           problem.space.dimension() == 2 && problem.scene->robot_dimension() == 2 && !problem.scene->is_point();
  }

  [[nodiscard]] std::optional<MotionFigure> motion(const ExperimentResult& result, const std::string& strategy) const {
    const auto runs = select_runs(result, problem_.name, strategy);
    const auto solved = std::find_if(runs.begin(), runs.end(), [](const RunResult* run) { return run->run.solved; });
    if (runs.empty()) return std::nullopt;
    const RunResult& run = **(solved != runs.end() ? solved : runs.begin());
    if (run.levels.empty()) return std::nullopt;
    MotionFigure figure = frame_;
    figure.title = fmt::format("{} on {}: the path in the world and in its space", strategy, problem_.name);
    bool shaded = false;
    for (auto level = run.levels.rbegin(); level != run.levels.rend(); ++level) {
      const LevelRecord& record = level->record;
      if (!(record.space == problem_.space) || record.solution.path.size() == 0) continue;
      MotionRow row = row_of(record);
      if (record.parent >= 0) {
        const LevelRecord& above = run.levels[static_cast<std::size_t>(record.parent)].record;
        row.space_title = fmt::format("its path, and what {} draws from", record.parent == 0 ? "C" : above.name);
        if (above.space == problem_.space && above.search.density.exact()) {
          row.density = map_of(problem_.space, finest_density, [&](View q) { return above.search.density.at(q); });
          if (flat(row.density)) {
            row.density = {};
            row.space_title = fmt::format("its path; {} drew uniformly", record.parent == 0 ? "C" : above.name);
          }
          shaded = shaded || !row.density.values.empty();
        }
      } else {
        row.space_title = "the path, and the nodes of the search";
        const Configurations nodes = record.search.tree_samples(record.search.nodes);
        row.nodes.reserve(nodes.size());
        for (std::size_t i = 0; i < nodes.size(); ++i) row.nodes.push_back(point(nodes[i]));
      }
      figure.rows.push_back(std::move(row));
    }
    if (figure.rows.empty()) return std::nullopt;
    figure.caption = fmt::format(
        "Seed {}. Left: the robot at even distances along the path. Right: grey where the robot would touch an "
        "obstacle, the boundary or itself{}{}.",
        run.seed, round() ? "; what leaves on one side comes back on the other" : "",
        shaded
            ? "; blue, the mean density of all that was proposed, uniform proposals and the guide's, in even steps of "
              "its square root; the goal itself, where it was proposed, is a point without density"
            : "");
    return figure;
  }

 private:
  [[nodiscard]] bool round() const {
    const auto& axes = problem_.space.axes();
    return std::any_of(axes.begin(), axes.end(), [](const Axis& axis) { return axis.periodic; });
  }

  [[nodiscard]] MotionRow row_of(const LevelRecord& record) const {
    const Configurations& path = record.solution.path;
    MotionRow row;
    row.world_title =
        fmt::format("{}: {}", record.parent < 0 ? record.planner : record.name,
                    record.solution.solved() ? "the path found" : "the path to the node nearest to the goal");
    const Configurations poses = poses_along(record.space, path);
    row.poses.reserve(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      row.poses.push_back(placed(planar(*record.scene).robot, poses[i]));
      row.invalid.push_back(!checker_->valid(poses[i]));
    }
    row.path = pieces_of(record.space, path);
    return row;
  }

  const Problem& problem_;
  std::unique_ptr<Checker> checker_;
  MotionFigure frame_;
};

/// One problem's pictures of a team in the plane: its robots at moments of the path.
class TeamMotions {
 public:
  explicit TeamMotions(const Problem& problem) : problem_(problem), traces_(traces_of(problem)) {
    const World& world = planar(*problem.scene).world;
    const auto& [lo, hi] = world.bounds();
    frame_.world = {lo.x, lo.y, hi.x - lo.x, hi.y - lo.y};
    frame_.cell = std::max(frame_.world.width, frame_.world.height);
    frame_.obstacles.reserve(world.obstacles().size());
    for (const Obstacle& obstacle : world.obstacles()) frame_.obstacles.push_back(drawn(obstacle.shape));
    add_ends(problem, frame_);
    frame_.columns = frame_.world.width > 2.2 * frame_.world.height ? 2 : 3;
  }

  [[nodiscard]] static bool possible(const Problem& problem) {
    return problem.scene != nullptr && problem.scene->planar() != nullptr && problem.scene->members().size() > 1;
  }

  [[nodiscard]] std::optional<draw::PlanarFigure> motion(const ExperimentResult& result,
                                                         const std::string& strategy) const {
    const auto runs = select_runs(result, problem_.name, strategy);
    const auto solved = std::find_if(runs.begin(), runs.end(), [](const RunResult* run) { return run->run.solved; });
    if (solved == runs.end()) return std::nullopt;
    const RunResult& run = **solved;
    constexpr std::size_t panels = 6;
    constexpr std::size_t pieces = 20;  // of the path between two panels
    const Scene* scene = problem_.scene.get();
    const Configurations moments = moments_of(scene, problem_.space, run.run.path, pieces * (panels - 1) + 1);
    draw::PlanarFigure figure = frame_;
    figure.title = fmt::format("{} on {}: the robots along their paths", strategy, problem_.name);
    figure.caption = fmt::format(
        "Seed {}. The robots at even times, with their paths so far: in each motion of the team the robot "
        "with the longest motion has an even speed.",
        run.seed);
    for (std::size_t k = 0; k < panels; ++k) {
      const std::size_t now = std::min(pieces * k, moments.size() - 1);
      draw::PlanarPanel panel;
      panel.title = fmt::format("{} % of the time", 100 * k / (panels - 1));
      panel.team_at = placed_team(planar(*scene).robot, moments[now]);
      for (const Trace& trace : traces_) {
        draw::TeamPath path{draw::palette::robot(trace.robot), {}};
        for (std::size_t i = 0; i <= now; ++i) {
          path.points.push_back({moments[i][trace.axes[0]], moments[i][trace.axes[1]]});
        }
        if (now > 0) panel.team_paths.push_back(std::move(path));
      }
      figure.panels.push_back(std::move(panel));
      if (moments.size() == 1) break;
    }
    return figure;
  }

 private:
  const Problem& problem_;
  std::vector<Trace> traces_;
  draw::PlanarFigure frame_;
};

/// One problem's pictures of space: the robot of each level along the path found in it.
class SpatialMotions {
 public:
  explicit SpatialMotions(const Problem& problem) : problem_(problem), frame_(spatial_frame(problem)) {
    const draw::Point3 size = frame_.hi - frame_.lo;
    frame_.cell = std::max({size.x, size.y, size.z});
    frame_.strong_path = true;
  }

  [[nodiscard]] static bool possible(const Problem& problem) {
    return problem.scene != nullptr && spatial_world(*problem.scene) != nullptr;
  }

  [[nodiscard]] std::optional<draw::SpatialFigure> motion(const ExperimentResult& result,
                                                          const std::string& strategy) const {
    const auto runs = select_runs(result, problem_.name, strategy);
    const auto solved = std::find_if(runs.begin(), runs.end(), [](const RunResult* run) { return run->run.solved; });
    if (runs.empty()) return std::nullopt;
    const RunResult& run = **(solved != runs.end() ? solved : runs.begin());
    draw::SpatialFigure figure = frame_;
    figure.title = fmt::format("{} on {}: the paths found", strategy, problem_.name);
    for (auto level = run.levels.rbegin(); level != run.levels.rend(); ++level) {
      const LevelRecord& record = level->record;
      if (record.solution.path.size() == 0 || !has_positions(record)) continue;
      figure.panels.push_back(panel_of(record));
    }
    if (figure.panels.empty()) return std::nullopt;
    figure.columns = std::min<std::size_t>(2, figure.panels.size());
    if (figure.panels.size() == 1) figure.width = single_width;
    const std::string text =
        fmt::format("Seed {}. The robot at even distances along the path, and the curve of its {}.", run.seed,
                    problem_.scene->manipulator() != nullptr ? "tip" : "reference point");
    figure.caption = figure.caption.empty() ? text : text + ' ' + figure.caption;
    return figure;
  }

 private:
  static constexpr double single_width = 380.0;

  [[nodiscard]] draw::SpatialPanel panel_of(const LevelRecord& record) const {
    constexpr std::size_t triangles_of_pose = 150;
    constexpr std::size_t points_of_leg =
        8;  // rotations bend no curve, but the reference point may leave straight legs
    const Configurations& path = record.solution.path;
    draw::SpatialPanel panel;
    panel.title = fmt::format("{}: {}", record.parent < 0 ? record.planner : record.name,
                              record.solution.solved() ? "the path found" : "the path to the node nearest to the goal");
    for (std::size_t robot = 0; robot < positions_in(record, path[0]).size(); ++robot) {
      const auto at = [&](View q) { return positions_in(record, q)[robot]; };
      std::vector<draw::Point3> curve;
      Configuration q(record.space.dimension());
      curve.push_back(at(path[0]));
      for (std::size_t i = 1; i < path.size(); ++i) {
        for (std::size_t k = 1; k <= points_of_leg; ++k) {
          record.space.interpolate(path[i - 1], path[i], static_cast<double>(k) / points_of_leg, q);
          // Straight pieces are one.
          if (k < points_of_leg && straight(at(path[i - 1]), at(q), at(path[i]))) continue;
          curve.push_back(at(q));
        }
      }
      panel.paths.push_back(std::move(curve));
    }
    if (record.scene->is_point() || record.space.dimension() < record.scene->robot_dimension()) return panel;
    const Configurations poses = poses_along(record.space, path);
    const auto checker = make_checker(problem_.collision, problem_.scene, problem_.space, problem_.resolution);
    const bool same_space = record.space == problem_.space;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      draw::Surface pose;
      for (const draw::Surface& part : placed(*record.scene, own_coordinates(record, poses[i]), triangles_of_pose)) {
        append(pose, part);
      }
      if (i == 0) {
        panel.start = {pose};
      } else if (i + 1 == poses.size() && record.solution.solved()) {
        panel.goal = {pose};
      } else {
        panel.poses.push_back(std::move(pose));
        panel.invalid.push_back(same_space && !checker->valid(poses[i]));
      }
    }
    return panel;
  }

  [[nodiscard]] static bool straight(const draw::Point3& a, const draw::Point3& b, const draw::Point3& c) {
    const draw::Point3 area = draw::cross(b - a, c - a);
    const draw::Point3 length = c - a;
    constexpr double bend = 1e-9;
    return draw::dot(area, area) <= bend * draw::dot(length, length) * draw::dot(length, length);
  }

  const Problem& problem_;
  draw::SpatialFigure frame_;
};

/// Writes motion.* of all strategies of a problem.
template <class Pictures, class Job>
void write_motions(const Pictures& pictures, const Job& task, const ExperimentResult& result,
                   const FigureStyle& style) {
  for (const auto& [strategy, folder] : task.strategies) {
    const auto figure = pictures.motion(result, strategy);
    if (!figure) continue;
    make_directory((task.place / folder).string());
    write_figure(*figure, style, (task.place / folder / "motion").string());
  }
}

}  // namespace

void write_motion_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                          unsigned jobs, const FigureStyle& style) {
  struct FigureJob {
    const Problem* problem;
    std::filesystem::path place;
    std::vector<std::pair<std::string, std::string>> strategies;  ///< names, and their folders
  };
  std::vector<FigureJob> tasks;
  Directories problems;
  for (const Problem& problem : experiment.problems) {
    const std::filesystem::path folder = std::filesystem::path(directory) / problems(problem.name);
    if (!MotionPictures::possible(problem) && !TeamMotions::possible(problem) && !SpatialMotions::possible(problem)) {
      continue;
    }
    FigureJob task{&problem, folder, {}};
    Directories strategies;
    for (const auto& entry : experiment.strategies) task.strategies.emplace_back(entry.first, strategies(entry.first));
    tasks.push_back(std::move(task));
  }
  in_parallel(tasks.size(), jobs, [&](std::size_t i) {
    const FigureJob& task = tasks[i];
    if (SpatialMotions::possible(*task.problem)) {
      write_motions(SpatialMotions(*task.problem), task, result, style);
    } else if (TeamMotions::possible(*task.problem)) {
      write_motions(TeamMotions(*task.problem), task, result, style);
    } else {
      write_motions(MotionPictures(*task.problem), task, result, style);
    }
  });
}

}  // namespace trellis
