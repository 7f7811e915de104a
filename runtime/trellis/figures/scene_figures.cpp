// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/parallel.hpp>
#include <trellis/draw/planar.hpp>
#include <trellis/figures/figures.hpp>
#include <trellis/figures/pictures.hpp>
#include <trellis/figures/world_shapes.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

using draw::CircleLayer;
using draw::Grid;
using draw::PlanarFigure;
using draw::PlanarPanel;
using draw::Point;
using draw::Role;
using draw::WorldDisc;
using draw::WorldShape;

using Axes = std::vector<std::size_t>;

constexpr double usual_cell = 0.5;
constexpr double fewest_cells = 12.0;  // along the longer side
constexpr double most_cells = 48.0;
constexpr double most_cells_asked = 500.0;

Point position(View q, const Axes& axes) { return {q[axes[0]], q[axes[1]]}; }

std::vector<Point> track(const Configurations& path, const Axes& axes) {
  std::vector<Point> positions;
  positions.reserve(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) positions.push_back(position(path[i], axes));
  return positions;
}

/// Counts of samples per cell, over any number of runs.
class Counts {
 public:
  explicit Counts(const Grid& grid) : grid_(grid), sums_(grid.size(), 0.0) {}

  /// The samples of one run.
  void add(const Configurations& samples, const Axes& axes, double weight = 1.0) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      (grid_.count(position(samples[i], axes), weight, sums_) ? inside_ : outside_) += weight;
    }
    ++runs_;
  }

  [[nodiscard]] bool none() const { return inside_ + outside_ == 0.0; }
  [[nodiscard]] bool any_outside() const { return outside_ > 0.0; }
  [[nodiscard]] std::size_t runs() const { return runs_; }
  /// Returns the mean number of samples of a run.
  [[nodiscard]] double mean() const { return runs_ == 0 ? 0.0 : (inside_ + outside_) / static_cast<double>(runs_); }
  [[nodiscard]] CircleLayer layer(std::string name, Role role) const {
    CircleLayer layer{std::move(name), role, sums_};
    for (double& sum : layer.mean) sum /= static_cast<double>(std::max<std::size_t>(1, runs_));
    return layer;
  }

 private:
  const Grid& grid_;
  std::vector<double> sums_;
  double inside_ = 0.0;
  double outside_ = 0.0;
  std::size_t runs_ = 0;
};

std::string rounded(double number) { return fmt::format("{:.{}f}", number, number < 10.0 ? 1 : 0); }

std::string counted(std::size_t n, const std::string& what) {
  return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

PlanarPanel panel_of(const std::string& title, const Counts& counts, CircleLayer layer, const std::string& what) {
  PlanarPanel panel;
  panel.title = fmt::format("{}: {}{}", title, rounded(counts.mean()), what);
  panel.layers.push_back(std::move(layer));
  return panel;
}

double cell_of(const draw::Rect& world, const std::optional<double>& asked) {
  const double longer = std::max(world.width, world.height);
  if (asked) {
    if (!(*asked > 0.0 && std::isfinite(*asked) && longer / *asked <= most_cells_asked)) {
      throw Error(
          fmt::format("the cells of a picture must be greater than 0 m and at least 1/{:g} of the world's "
                      "longer side of {:g} m, got {:g}",
                      most_cells_asked, longer, *asked));
    }
    return *asked;
  }
  double cell = usual_cell;
  while (longer / cell > most_cells) cell *= 2.0;
  while (longer / cell < fewest_cells) cell *= 0.5;
  return cell;
}

/// Describes the target for the caption.
std::string target_text(const Measure& measure) {
  const double delta = common_settings(measure.target).delta;
  if (const auto* tube = std::get_if<TubeSettings>(&measure.target)) {
    return fmt::format("uniform on the {}configurations within {:g} m of the run's path",
                       tube->support == "free" ? "valid " : "", delta);
  }
  if (std::holds_alternative<NearOptimalSettings>(measure.target)) return "configurations on paths near the optimum";
  return "the script's own";
}

/// One problem's pictures.
class ScenePictures {
 public:
  ScenePictures(const Experiment& experiment, const ExperimentResult& result, const Problem& problem,
                const SceneFigureOptions& options)
      : experiment_(experiment),
        result_(result),
        problem_(problem),
        frame_(make_frame(problem, options)),
        grid_(frame_.world, frame_.cell),
        measured_(experiment.measure && !std::holds_alternative<ProgressSettings>(experiment.measure->target)),
        baseline_(experiment.baseline) {
    const auto& all = experiment.strategies;
    const bool usual = std::any_of(all.begin(), all.end(), [](const auto& entry) { return entry.first == "rrt"; });
    if (baseline_.empty() && usual) baseline_ = "rrt";
  }

  [[nodiscard]] static bool possible(const Problem& problem) {
    return problem.scene != nullptr && problem.scene->robot.translates();
  }

  /// Returns none without a run.
  [[nodiscard]] std::optional<PlanarFigure> samples(const std::string& strategy) const {
    const auto runs = select_runs(result_, problem_.name, strategy);
    if (runs.empty()) return std::nullopt;
    Counts tree(grid_);
    Counts expansion(grid_);
    Counts target(grid_);
    Counts baseline(grid_);
    PlanarPanel world;
    bool expands = false;
    for (const RunResult* run : runs) {
      if (run->run.solved) world.paths.push_back(track(run->run.path, position_));
      if (run->levels.empty()) continue;
      const Search& search = run->levels.front().record.search;
      const Configurations nodes = search.tree_samples(search.nodes);
      tree.add(nodes, position_);
      if (search.expands) {
        expansion.add(search.proposals, position_);
        expands = true;
      }
      if (run->target.empty()) continue;
      target.add(run->target, position_, static_cast<double>(nodes.size()) / static_cast<double>(run->target.size()));
    }
    const bool compared = !baseline_.empty() && baseline_ != strategy;
    if (compared) {
      for (const RunResult* run : select_runs(result_, problem_.name, baseline_)) {
        if (run->levels.empty()) continue;
        const Search& search = run->levels.front().record.search;
        baseline.add(search.tree_samples(search.nodes), position_);
      }
    }
    const std::string seeds = counted(runs.size(), "seed");
    world.title = fmt::format("paths of {} of {}", world.paths.size(), seeds);

    PlanarFigure figure = frame_;
    figure.title = fmt::format("{} on {}: where its samples lie", strategy, problem_.name);
    PlanarPanel all{.title = "all, to one scale"};
    std::vector<std::string> absent;
    const auto add = [&](const std::string& title, const Counts& counts, Role role, const std::string& what,
                         const std::string& without) {
      if (counts.none()) {
        absent.push_back(without);
        return;
      }
      PlanarPanel panel = panel_of(title, counts, counts.layer(title, role), what);
      all.layers.insert(all.layers.end(), panel.layers.begin(), panel.layers.end());
      figure.panels.push_back(std::move(panel));
    };
    figure.panels.push_back(std::move(world));
    if (measured_) {
      add("target", target, Role::target, " samples", "no path, no target");
      if (!target.none()) figure.panels.back().title = "target, as many as the tree";
    }
    add("tree", tree, Role::tree, " nodes", "no nodes");
    add("expansion", expansion, Role::expansion, " proposals", expands ? "no proposals" : "nothing is grown");
    if (compared) add(fmt::format("tree of {}", baseline_), baseline, Role::baseline, " nodes", "no nodes");
    if (all.layers.size() > 1) figure.panels.push_back(std::move(all));

    figure.caption = circles_text(seeds);
    if (measured_ && !target.none()) {
      figure.caption +=
          fmt::format(" Target: {}, scaled to as many samples as the tree has{}.", target_text(*experiment_.measure),
                      target.runs() == runs.size() ? "" : fmt::format(", over {} of the {}", target.runs(), seeds));
    }
    if (!absent.empty()) figure.caption += fmt::format(" Not drawn: {}.", fmt::join(absent, ", "));
    if (tree.any_outside() || expansion.any_outside() || baseline.any_outside()) figure.caption += outside_text();
    return figure;
  }

  /// Draws the levels below the root, each in its own space. None where no such level has a position in the plane.
  [[nodiscard]] std::optional<PlanarFigure> levels(const std::string& strategy) const {
    const auto runs = select_runs(result_, problem_.name, strategy);
    std::map<std::vector<std::uint64_t>, std::vector<const LevelRecord*>> found;
    for (const RunResult* run : runs) {
      for (const LevelResult& level : run->levels) {
        if (level.record.level == 0 || level.record.position_axes.size() != 2) continue;
        found[parse_key(level.record.key)].push_back(&level.record);
      }
    }
    if (found.empty()) return std::nullopt;
    PlanarFigure figure = frame_;
    figure.columns = found.size() == 1 ? 2 : 4;
    figure.title = fmt::format("{} on {}: where the samples of its guides lie", strategy, problem_.name);
    figure.caption =
        circles_text(counted(runs.size(), "seed")) + " Each level in its own space, with the paths found in it.";
    // Robots differ between levels: mark only their positions.
    const LevelRecord& first = *found.begin()->second.front();
    figure.start = {WorldDisc{position(first.start, first.position_axes), 0.0}};
    figure.goal = {WorldDisc{position(first.goal, first.position_axes), 0.0}};
    bool outside = false;
    for (const auto& [key, records] : found) {
      Counts tree(grid_);
      Counts expansion(grid_);
      std::vector<std::vector<Point>> paths;
      for (const LevelRecord* record : records) {
        const Search& search = record->search;
        tree.add(search.tree_samples(search.nodes), record->position_axes);
        if (search.expands) expansion.add(search.proposals, record->position_axes);
        if (record->solution.solved()) paths.push_back(track(record->solution.path, record->position_axes));
      }
      outside = outside || tree.any_outside() || expansion.any_outside();
      const std::string name = short_level(records.front()->name, 24);
      // A level without proposals, such as a graph search, has no panel for them.
      for (const auto& [counts, role, what] :
           {std::tuple{&tree, Role::tree, "tree"}, std::tuple{&expansion, Role::expansion, "expansion"}}) {
        if (counts->none()) continue;
        figure.panels.push_back(panel_of(fmt::format("{}\n{}", name, what), *counts, counts->layer(what, role), ""));
        figure.panels.back().paths = paths;
      }
    }
    if (outside) figure.caption += outside_text();
    if (figure.panels.empty()) return std::nullopt;
    return figure;
  }

 private:
  /// Returns the parts that all pictures of a problem share.
  static PlanarFigure make_frame(const Problem& problem, const SceneFigureOptions& options) {
    const World& world = problem.scene->world;
    const auto& [lo, hi] = world.bounds();
    PlanarFigure frame;
    frame.world = {lo.x, lo.y, hi.x - lo.x, hi.y - lo.y};
    frame.cell = cell_of(frame.world, options.cell);
    frame.obstacles.reserve(world.obstacles().size());
    for (const Obstacle& obstacle : world.obstacles()) frame.obstacles.push_back(drawn(obstacle.shape));
    frame.start = placed(problem.scene->robot, problem.start);
    frame.goal = placed(problem.scene->robot, problem.goal);
    for (std::size_t i = 0; i < problem.further_goals.size(); ++i) {
      const auto further = placed(problem.scene->robot, problem.further_goals[i]);
      frame.goal.insert(frame.goal.end(), further.begin(), further.end());
    }
    frame.colours = options.colours;
    // Wide worlds have wide panels.
    const double aspect = frame.world.width / frame.world.height;
    frame.columns = aspect > 5.0 ? 1 : aspect > 2.2 ? 2 : 3;
    return frame;
  }

  [[nodiscard]] std::string circles_text(const std::string& seeds) const {
    return fmt::format(
        "Circles: samples in each cell of {0:g} m x {0:g} m of a world of {1:g} m x {2:g} m, the mean over {3}; areas "
        "are "
        "proportional to it, in each panel to a scale of its own.",
        frame_.cell, frame_.world.width, frame_.world.height, seeds);
  }
  static std::string outside_text() { return " Samples outside of the world are not drawn."; }

  const Experiment& experiment_;
  const ExperimentResult& result_;
  const Problem& problem_;
  PlanarFigure frame_;
  Grid grid_;
  Axes position_ = {0, 1};
  bool measured_ = false;
  std::string baseline_;
};

}  // namespace

std::vector<std::string> write_scene_figures(const Experiment& experiment, const ExperimentResult& result,
                                             const std::string& directory, const SceneFigureOptions& options) {
  std::vector<std::string> left_out;
  std::vector<ScenePictures> scenes;
  scenes.reserve(experiment.problems.size());
  struct FigureJob {
    std::size_t scene;
    std::string strategy;
    std::filesystem::path place;
  };
  std::vector<FigureJob> tasks;
  Directories problems;
  for (const Problem& problem : experiment.problems) {
    const std::filesystem::path folder = std::filesystem::path(directory) / problems(problem.name);
    if (!ScenePictures::possible(problem)) {
      left_out.push_back(
          fmt::format("{}: no picture of its samples, its robot has no position in the plane", problem.name));
      continue;
    }
    scenes.emplace_back(experiment, result, problem, options);
    Directories strategies;
    for (const auto& entry : experiment.strategies) {
      tasks.push_back({scenes.size() - 1, entry.first, folder / strategies(entry.first)});
    }
  }
  in_parallel(tasks.size(), options.jobs, [&](std::size_t i) {
    const FigureJob& task = tasks[i];
    const ScenePictures& pictures = scenes[task.scene];
    const auto samples = pictures.samples(task.strategy);
    if (!samples) return;
    make_directory(task.place.string());
    write_figure(*samples, options.style, (task.place / "samples").string());
    if (const auto levels = pictures.levels(task.strategy)) {
      write_figure(*levels, options.style, (task.place / "levels").string());
    }
  });
  return left_out;
}

}  // namespace trellis
