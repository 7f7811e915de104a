// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/parallel.hpp>
#include <trellis/draw/planar.hpp>
#include <trellis/draw/spatial.hpp>
#include <trellis/figures/charts/pictures.hpp>
#include <trellis/figures/scene_figures.hpp>
#include <trellis/figures/world_shapes.hpp>
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/pictures/traces.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/words.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

namespace {

using draw::CircleLayer;
using draw::Role;
using draw::WorldDisc;

using Axes = std::vector<std::size_t>;

constexpr double usual_cell = 0.5;
constexpr double most_cells = 48.0;  // along the longer side; at least a quarter of it
constexpr double most_cells_asked = 500.0;

/// \param most_asked  of the longer side, in cells
double cell_of(double longer, const std::optional<double>& asked, double most, double most_asked = most_cells_asked) {
  if (asked) {
    if (!(*asked > 0.0 && std::isfinite(*asked) && longer / *asked <= most_asked)) {
      throw Error(
          fmt::format("the cells of a picture must be greater than 0 m and at least 1/{:g} of the world's "
                      "longer side of {:g} m, got {:g}",
                      most_asked, longer, *asked));
    }
    return *asked;
  }
  double cell = usual_cell;
  while (longer / cell > most) cell *= 2.0;
  while (longer / cell < 0.25 * most) cell *= 0.5;
  return cell;
}

/// What differs between pictures of the plane and of space.
struct Planar {
  using Figure = draw::PlanarFigure;
  using Panel = draw::PlanarPanel;
  using Grid = draw::Grid;
  using Place = draw::Point;
  static constexpr std::size_t axes = 2;

  static Place position(View q, const Axes& axes) { return {q[axes[0]], q[axes[1]]}; }
  static Grid grid(const Figure& frame) { return {frame.world, frame.cell}; }
  static std::string cell_text(const Figure& frame) {
    return fmt::format("Circles: samples in each cell of {0:g} m x {0:g} m of a world of {1:g} m x {2:g} m", frame.cell,
                       frame.world.width, frame.world.height);
  }
  /// Draws the ends of a search as marks.
  static void mark_ends(Figure& figure, const LevelRecord& record) {
    figure.start = {WorldDisc{position(record.start, record.position_axes), 0.0}};
    figure.goal = {WorldDisc{position(record.goal, record.position_axes), 0.0}};
  }
  /// Returns the parts that all pictures of a problem share.
  static Figure frame(const Problem& problem, const SceneFigureOptions& options) {
    const World& world = planar(*problem.scene).world;
    const auto& [lo, hi] = world.bounds();
    Figure frame;
    frame.world = {lo.x, lo.y, hi.x - lo.x, hi.y - lo.y};
    frame.cell = cell_of(std::max(frame.world.width, frame.world.height), options.cell, most_cells);
    frame.obstacles.reserve(world.obstacles().size());
    for (const Obstacle& obstacle : world.obstacles()) frame.obstacles.push_back(drawn(obstacle.shape));
    add_ends(problem, frame);
    frame.colours = options.colours;
    // Wide worlds have wide panels.
    const double aspect = frame.world.width / frame.world.height;
    frame.columns = aspect > 5.0 ? 1 : aspect > 2.2 ? 2 : 3;
    return frame;
  }
};

struct Spatial {
  using Figure = draw::SpatialFigure;
  using Panel = draw::SpatialPanel;
  using Grid = draw::Grid3;
  using Place = draw::Point3;
  static constexpr std::size_t axes = 3;

  static Place position(View q, const Axes& axes) { return {q[axes[0]], q[axes[1]], q[axes[2]]}; }
  static Grid grid(const Figure& frame) { return {frame.lo, frame.hi, frame.cell}; }
  static std::string cell_text(const Figure& frame) {
    const draw::Point3 size = frame.hi - frame.lo;
    return fmt::format(
        "Circles: samples in each cube of {:g} m of a world of {:g} m x {:g} m x {:g} m, faint behind obstacles",
        frame.cell, size.x, size.y, size.z);
  }
  static void mark_ends(Figure& figure, const LevelRecord& record) {
    figure.start_at = position(record.start, record.position_axes);
    figure.goal_at = position(record.goal, record.position_axes);
    figure.start = {{.vertices = {figure.start_at}}};
    figure.goal = {{.vertices = {figure.goal_at}}};
  }
  static Figure frame(const Problem& problem, const SceneFigureOptions& options) {
    Figure frame = spatial_frame(problem);
    const draw::Point3 size = frame.hi - frame.lo;
    const double longest = std::max({size.x, size.y, size.z});
    constexpr double most_asked = 64.0;
    frame.cell = cell_of(longest, options.cell, most_cells, most_asked);
    // A picture of more circles shows nothing, and its file is large.
    constexpr double most = 4096.0;
    while (!options.cell &&
           std::ceil(size.x / frame.cell) * std::ceil(size.y / frame.cell) * std::ceil(size.z / frame.cell) > most) {
      frame.cell *= 2.0;
    }
    frame.colours = options.colours;
    frame.columns = size.z > 1.5 * std::max(size.x, size.y) ? 3 : 2;
    return frame;
  }
};

template <class Kind>
std::vector<typename Kind::Place> track(const Configurations& path, const Axes& axes) {
  std::vector<typename Kind::Place> positions;
  positions.reserve(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) positions.push_back(Kind::position(path[i], axes));
  return positions;
}

/// Counts of samples per cell, over any number of runs.
template <class Kind>
class Counts {
 public:
  using Grid = typename Kind::Grid;
  explicit Counts(const Grid& grid) : grid_(grid), sums_(grid.size(), 0.0) {}

  /// The samples of one run.
  void add(const Configurations& samples, const Axes& axes, double weight = 1.0) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      (grid_.count(Kind::position(samples[i], axes), weight, sums_) ? inside_ : outside_) += weight;
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

/// Describes the target for the caption.
std::string target_text(const Measure& measure) {
  const double delta = common_settings(measure.target).delta;
  if (const auto* tube = std::get_if<TubeSettings>(&measure.target)) {
    return fmt::format("uniform on the {}configurations within {:g} m of the run's path",
                       tube->support == TubeSettings::Support::free ? "valid " : "", delta);
  }
  if (std::holds_alternative<NearOptimalSettings>(measure.target)) return "configurations on paths near the optimum";
  return "the script's own";
}

/// One problem's pictures.
template <class Kind>
class ScenePictures {
 public:
  using Figure = typename Kind::Figure;
  using Panel = typename Kind::Panel;
  using Grid = typename Kind::Grid;

  ScenePictures(const Experiment& experiment, const ExperimentResult& result, const Problem& problem,
                const SceneFigureOptions& options)
      : experiment_(experiment),
        result_(result),
        problem_(problem),
        frame_(Kind::frame(problem, options)),
        grid_(Kind::grid(frame_)),
        traces_(traces_of(problem)),
        measured_(experiment.measure && !std::holds_alternative<ProgressSettings>(experiment.measure->target)),
        baseline_(experiment.baseline) {
    const auto& all = experiment.strategies;
    const bool usual = std::any_of(all.begin(), all.end(), [](const auto& entry) { return entry.first == "rrt"; });
    if (baseline_.empty() && usual) baseline_ = "rrt";
  }

  /// Returns none without a run.
  [[nodiscard]] std::optional<Figure> samples(const std::string& strategy) const {
    const auto runs = select_runs(result_, problem_.name, strategy);
    if (runs.empty()) return std::nullopt;
    Samples tree(*this);
    Samples expansion(*this);
    Samples target(*this);
    Samples baseline(*this);
    Panel world;
    bool expands = false;
    for (const RunResult* run : runs) {
      if (run->run.solved) add_paths(run->run.path, traces_, world);
      if (run->levels.empty()) continue;
      const Search& search = run->levels.front().record.search;
      const Configurations nodes = search.tree_samples(search.nodes);
      tree.add(nodes, traces_);
      if (search.expands) {
        expansion.add(search.proposals, traces_);
        expands = true;
      }
      if (run->target.empty()) continue;
      target.add(run->target, traces_, static_cast<double>(nodes.size()) / static_cast<double>(run->target.size()));
    }
    const bool compared = !baseline_.empty() && baseline_ != strategy;
    if (compared) {
      for (const RunResult* run : select_runs(result_, problem_.name, baseline_)) {
        if (run->levels.empty()) continue;
        const Search& search = run->levels.front().record.search;
        baseline.add(search.tree_samples(search.nodes), traces_);
      }
    }
    const std::string seeds = counted(runs.size(), "seed");
    const auto solved = std::count_if(runs.begin(), runs.end(), [](const RunResult* run) { return run->run.solved; });
    world.title = fmt::format("paths of {} of {}", solved, seeds);

    Figure figure = frame_;
    figure.title = fmt::format("{} on {}: where its samples lie", strategy, problem_.name);
    Panel all{.title = "all, to one scale"};
    std::vector<std::string> absent;
    const auto add = [&](const std::string& title, const Samples& counts, Role role, const std::string& what,
                         const std::string& without) {
      if (counts.none()) {
        absent.push_back(without);
        return;
      }
      Panel panel = counts.panel(title, role, what);
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
    if (all.layers.size() > 1 && !team()) figure.panels.push_back(std::move(all));

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

  /// Draws the levels below the root, each in its own space. The searches of the robots of a team are one. None where
  /// no such level has a position in the plane.
  [[nodiscard]] std::optional<Figure> levels(const std::string& strategy) const {
    struct Drawn {
      const LevelRecord* record;
      std::vector<Trace> traces;
    };
    const auto runs = select_runs(result_, problem_.name, strategy);
    std::map<std::vector<std::uint64_t>, std::vector<Drawn>> found;
    for (const RunResult* run : runs) {
      for (std::size_t i = 1; i < run->levels.size(); ++i) {
        const LevelRecord& record = run->levels[i].record;
        auto traces = traces_of(run->levels, i);
        if (traces.empty() || traces.front().axes.size() != Kind::axes) continue;
        found[joint_key(record.key)].push_back({&record, std::move(traces)});
      }
    }
    if (found.empty()) return std::nullopt;
    Figure figure = frame_;
    figure.columns = found.size() == 1 || Kind::axes == 3 ? 2 : 4;
    figure.title = fmt::format("{} on {}: where the samples of its guides lie", strategy, problem_.name);
    figure.caption =
        circles_text(counted(runs.size(), "seed")) + " Each level in its own space, with the paths found in it.";
    // Robots differ between levels: mark only their positions.
    if (!team()) Kind::mark_ends(figure, *found.begin()->second.front().record);
    bool outside = false;
    for (const auto& [key, records] : found) {
      Samples tree(*this);
      Samples expansion(*this);
      Panel paths;
      std::set<std::string> names;
      for (const auto& [record, traces] : records) {
        const Search& search = record->search;
        names.insert(record->name);
        tree.add(search.tree_samples(search.nodes), traces);
        if (search.expands) expansion.add(search.proposals, traces);
        if (record->solution.solved()) add_paths(record->solution.path, traces, paths);
      }
      outside = outside || tree.any_outside() || expansion.any_outside();
      const std::string name = names.size() == 1 ? short_level(*names.begin(), 24) : "robots, each search";
      // A level without proposals, such as a graph search, has no panel for them.
      for (const auto& [counts, role, what] :
           {std::tuple{&tree, Role::tree, "tree"}, std::tuple{&expansion, Role::expansion, "expansion"}}) {
        if (counts->none()) continue;
        Panel panel = counts->panel(what, role, "");
        panel.title = names.size() == 1 ? fmt::format("{}\n{}: {}", name, what, rounded(counts->mean()))
                                        : fmt::format("{}\n{}", name, what);
        if constexpr (Kind::axes == 2) panel.team_paths = paths.team_paths;
        panel.paths = paths.paths;
        figure.panels.push_back(std::move(panel));
      }
    }
    if (outside) figure.caption += outside_text();
    if (figure.panels.empty()) return std::nullopt;
    return figure;
  }

 private:
  [[nodiscard]] bool team() const { return traces_.size() > 1; }

  /// Counts of the samples of each robot of a team, or of the robot alone.
  class Samples {
   public:
    explicit Samples(const ScenePictures& of) : of_(of) {}

    void add(const Configurations& samples, const std::vector<Trace>& traces, double weight = 1.0) {
      for (const Trace& trace : traces) {
        counts_.try_emplace(trace.robot, of_.grid_).first->second.add(samples, trace.axes, weight);
      }
    }
    [[nodiscard]] bool none() const {
      return std::all_of(counts_.begin(), counts_.end(), [](const auto& entry) { return entry.second.none(); });
    }
    [[nodiscard]] bool any_outside() const {
      return std::any_of(counts_.begin(), counts_.end(), [](const auto& entry) { return entry.second.any_outside(); });
    }
    [[nodiscard]] std::size_t runs() const { return counts_.empty() ? 0 : counts_.begin()->second.runs(); }
    [[nodiscard]] double mean() const { return counts_.empty() ? 0.0 : counts_.begin()->second.mean(); }
    [[nodiscard]] Panel panel(const std::string& title, Role role, const std::string& what) const {
      Panel panel;
      panel.title = fmt::format("{}: {}{}", title, rounded(mean()), what);
      for (const auto& [robot, counts] : counts_) {
        if (!of_.team()) {
          panel.layers.push_back(counts.layer(title, role));
        } else if (!counts.none()) {
          const bool named = of_.traces_.size() <= draw::palette::robots.size();
          panel.layers.push_back(counts.layer(named ? fmt::format("robot {}", robot + 1) : "", role));
          panel.layers.back().colour = draw::palette::robot(robot);
        }
      }
      return panel;
    }

   private:
    const ScenePictures& of_;
    std::map<std::size_t, Counts<Kind>> counts_;  ///< by robot
  };

  void add_paths(const Configurations& path, const std::vector<Trace>& traces, Panel& panel) const {
    for (const Trace& trace : traces) {
      if constexpr (Kind::axes == 2) {
        if (team()) {
          panel.team_paths.push_back({draw::palette::robot(trace.robot), track<Kind>(path, trace.axes)});
          continue;
        }
      }
      panel.paths.push_back(track<Kind>(path, trace.axes));
    }
  }

  /// The place of a level among the panels: one for all searches that divide a level by robots.
  static std::vector<std::uint64_t> joint_key(const std::string& key) {
    std::vector<std::uint64_t> place;
    for (std::size_t at = 0; at < key.size();) {
      const std::size_t slash = key.find('/', at);
      for (const std::uint64_t number : parse_key(key.substr(at, slash == std::string::npos ? slash : slash - at))) {
        place.push_back(number);
      }
      if (slash == std::string::npos) break;
      place.push_back(std::numeric_limits<std::uint64_t>::max());
      at = key.find_first_not_of("0123456789", slash + 1);
      if (at == std::string::npos) break;
    }
    return place;
  }

  [[nodiscard]] std::string circles_text(const std::string& seeds) const {
    std::string text =
        fmt::format("{}, the mean over {}; areas are proportional to it, in each panel to a scale of its own.",
                    Kind::cell_text(frame_), seeds);
    if (team()) text += " Those of the robots are beside each other in their cell.";
    return frame_.caption.empty() ? text : frame_.caption + ' ' + text;
  }
  static std::string outside_text() { return " Samples outside of the world are not drawn."; }

  const Experiment& experiment_;
  const ExperimentResult& result_;
  const Problem& problem_;
  Figure frame_;
  Grid grid_;
  std::vector<Trace> traces_;  ///< of the root
  bool measured_ = false;
  std::string baseline_;
};

/// Draws the figures of all strategies on the problems of one kind.
template <class Kind>
void write_pictures(const Experiment& experiment, const ExperimentResult& result,
                    const std::vector<std::pair<const Problem*, std::filesystem::path>>& problems,
                    const SceneFigureOptions& options) {
  std::vector<ScenePictures<Kind>> scenes;
  scenes.reserve(problems.size());
  struct FigureJob {
    std::size_t scene;
    std::string strategy;
    std::filesystem::path place;
  };
  std::vector<FigureJob> tasks;
  for (const auto& [problem, folder] : problems) {
    scenes.emplace_back(experiment, result, *problem, options);
    Directories strategies;
    for (const auto& entry : experiment.strategies) {
      tasks.push_back({scenes.size() - 1, entry.first, folder / strategies(entry.first)});
    }
  }
  in_parallel(tasks.size(), options.jobs, [&](std::size_t i) {
    const FigureJob& task = tasks[i];
    const ScenePictures<Kind>& pictures = scenes[task.scene];
    const auto samples = pictures.samples(task.strategy);
    if (!samples) return;
    make_directory(task.place.string());
    write_figure(*samples, options.style, (task.place / "samples").string());
    if (const auto levels = pictures.levels(task.strategy)) {
      write_figure(*levels, options.style, (task.place / "levels").string());
    }
  });
}

}  // namespace

std::vector<std::string> write_scene_figures(const Experiment& experiment, const ExperimentResult& result,
                                             const std::string& directory, const SceneFigureOptions& options) {
  std::vector<std::string> left_out;
  std::vector<std::pair<const Problem*, std::filesystem::path>> of_plane;
  std::vector<std::pair<const Problem*, std::filesystem::path>> of_space;
  Directories problems;
  for (const Problem& problem : experiment.problems) {
    const std::filesystem::path folder = std::filesystem::path(directory) / problems(problem.name);
    const std::vector<Trace> traces = traces_of(problem);
    if (traces.empty() || traces.front().axes.empty()) {
      left_out.push_back(
          fmt::format("{}: no picture of its samples, its robot has no position in the plane", problem.name));
    } else {
      (problem.scene->planar() != nullptr ? of_plane : of_space).emplace_back(&problem, folder);
    }
  }
  write_pictures<Planar>(experiment, result, of_plane, options);
  write_pictures<Spatial>(experiment, result, of_space, options);
  return left_out;
}

}  // namespace trellis
