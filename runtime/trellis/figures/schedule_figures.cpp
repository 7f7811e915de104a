// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/figures/schedule_figures.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <trellis/collision/checker.hpp>
#include <trellis/guide/team.hpp>
#include <trellis/guide/team_space.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/report.hpp>
#include <trellis/scene/team_times.hpp>

namespace trellis {

namespace {

bool has_schedule(const Problem& problem) {
  return problem.scene != nullptr && problem.scene->members().size() > 1 && problem.space.flat() &&
         problem.space.dimension() == problem.scene->robot_dimension();
}

/// The path of one robot, by its length.
RobotsPath own_path(const Problem& problem, const TeamMember& member, const Configurations& path) {
  Configurations own(member.axes.size());
  Configuration q(member.axes.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    for (std::size_t j = 0; j < q.size(); ++j) q[j] = path[i][member.axes[j]];
    own.push(q);
  }
  return {problem.space, member.axes, std::move(own)};
}

/// Whether two robots that both move at 1 m/s touch, by the cells of a region.
bool meets(const ContactRegion& region, double first, double second) {
  const double longer = std::max(first, second);
  const std::size_t steps = 2 * region.cells;
  for (std::size_t i = 0; i <= steps && longer > 0.0; ++i) {
    const double at = longer * static_cast<double>(i) / static_cast<double>(steps);
    const auto cell = [&](double length) {
      const double share = length > 0.0 ? std::min(1.0, at / length) : 1.0;
      return std::min(region.cells - 1, static_cast<std::size_t>(share * static_cast<double>(region.cells)));
    };
    if (region.touch[cell(second) * region.cells + cell(first)] != 0) return true;
  }
  return false;
}

/// The pairs of robots that would touch if they moved at 1 m/s, then those with the largest regions of contact; at
/// most so many.
std::vector<ContactRegion> chosen_regions(const Problem& problem, const Configurations& path,
                                          const TeamProgress& progress, std::size_t most) {
  constexpr std::size_t coarse = 24;
  constexpr std::size_t fine = 96;
  const std::size_t robots = problem.scene->members().size();
  std::vector<ContactRegion> regions;
  for (std::size_t i = 0; i < robots; ++i) {
    for (std::size_t k = i + 1; k < robots; ++k) {
      ContactRegion region = contact_region(problem, path, i, k, coarse);
      if (region.size() > 0) regions.push_back(std::move(region));
    }
  }
  const auto rank = [&](const ContactRegion& region) {
    const bool first = meets(region, progress.distance[region.first].back(), progress.distance[region.second].back());
    return std::pair(first, region.size());
  };
  std::stable_sort(regions.begin(), regions.end(),
                   [&](const ContactRegion& a, const ContactRegion& b) { return rank(a) > rank(b); });
  regions.resize(std::min(regions.size(), most));
  for (ContactRegion& region : regions) region = contact_region(problem, path, region.first, region.second, fine);
  return regions;
}

/// Leaves out the points of a curve that lie on straight lines.
void add_curve(const std::vector<double>& x, const std::vector<double>& y, draw::Series& series) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i > 0 && i + 1 < x.size()) {
      const double turn = (x[i] - series.x.back()) * (y[i + 1] - y[i]) - (y[i] - series.y.back()) * (x[i + 1] - x[i]);
      if (std::abs(turn) < 1e-12) continue;
    }
    series.x.push_back(x[i]);
    series.y.push_back(y[i]);
  }
}

draw::Panel progress_panel(const TeamProgress& progress) {
  draw::Panel panel;
  panel.title = "how far each robot is";
  panel.x = {.label = "time, s", .lo = 0.0};
  panel.y = {.label = "m along its path", .lo = 0.0};
  constexpr std::size_t most_named = 8;
  for (std::size_t r = 0; r < progress.numbers.size(); ++r) {
    draw::Series& series = panel.series.emplace_back();
    if (progress.numbers.size() <= most_named) series.name = fmt::format("robot {}", progress.numbers[r]);
    series.colour = draw::palette::robot(r);
    add_curve(progress.at, progress.distance[r], series);
  }
  return panel;
}

draw::Panel pair_panel(const TeamProgress& progress, const ContactRegion& region, bool first) {
  const std::vector<double>& x = progress.distance[region.first];
  const std::vector<double>& y = progress.distance[region.second];
  draw::Panel panel;
  panel.title = fmt::format("robots {} and {}", progress.numbers[region.first], progress.numbers[region.second]);
  panel.x = {.label = fmt::format("robot {}, m", progress.numbers[region.first]), .lo = 0.0, .hi = x.back()};
  panel.y = {.label = fmt::format("robot {}, m", progress.numbers[region.second]), .lo = 0.0, .hi = y.back()};
  const double width = x.back() / static_cast<double>(region.cells);
  const double height = y.back() / static_cast<double>(region.cells);
  // Opaque, so that adjacent rectangles have no seams.
  constexpr double pale = 0.55;
  const draw::Colour& of = draw::palette::vermillion;
  const draw::Colour colour{of.r + pale * (1.0 - of.r), of.g + pale * (1.0 - of.g), of.b + pale * (1.0 - of.b), 1.0};
  const double overlap = 0.1 * height;
  bool named = !first;
  // Rows of cells that touch, as rectangles; equal rows are one.
  std::vector<std::pair<std::pair<std::size_t, std::size_t>, std::size_t>> open;  // columns, and the row of the first
  const auto close = [&](const auto& stretch, std::size_t row) {
    panel.shades.push_back({static_cast<double>(stretch.first.first) * width,
                            static_cast<double>(stretch.first.second) * width,
                            std::exchange(named, true) ? "" : "the robots touch", colour,
                            std::pair(static_cast<double>(stretch.second) * height - overlap,
                                      static_cast<double>(row) * height + overlap)});
  };
  for (std::size_t row = 0; row <= region.cells; ++row) {
    std::vector<std::pair<std::size_t, std::size_t>> stretches;
    for (std::size_t column = 0; row < region.cells && column < region.cells; ++column) {
      if (region.touch[row * region.cells + column] == 0) continue;
      if (stretches.empty() || stretches.back().second != column) stretches.emplace_back(column, column);
      stretches.back().second = column + 1;
    }
    std::erase_if(open, [&](const auto& stretch) {
      if (std::find(stretches.begin(), stretches.end(), stretch.first) != stretches.end()) return false;
      close(stretch, row);
      return true;
    });
    for (const auto& stretch : stretches) {
      const bool known = std::any_of(open.begin(), open.end(), [&](const auto& one) { return one.first == stretch; });
      if (!known) open.emplace_back(stretch, row);
    }
  }
  draw::Series together;
  together.name = first ? "both at 1 m/s" : "";
  together.dash = draw::Dash::dotted;
  together.colour = draw::palette::muted;
  together.width = 1.0;
  const double both = std::min(x.back(), y.back());
  together.x = {0.0, both, x.back()};
  together.y = {0.0, both, y.back()};
  panel.series.push_back(std::move(together));
  draw::Series path;
  path.name = first ? "the path found" : "";
  path.colour = draw::palette::black;
  add_curve(x, y, path);
  panel.series.push_back(std::move(path));
  return panel;
}

}  // namespace

std::size_t ContactRegion::size() const {
  return static_cast<std::size_t>(std::count_if(touch.begin(), touch.end(), [](char one) { return one != 0; }));
}

TeamProgress progress_of(const Problem& problem, const Configurations& path) {
  TeamProgress progress;
  const std::vector<TeamMember> members = problem.scene->members();
  progress.at = times_of(problem.space, members, path).at;
  for (const TeamMember& member : members) {
    progress.numbers.push_back(member.number);
    const Space own = space_of(problem.space, member);
    std::vector<double>& distance = progress.distance.emplace_back();
    distance.reserve(path.size());
    Configuration before(member.axes.size()), here(member.axes.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      for (std::size_t j = 0; j < here.size(); ++j) here[j] = path[i][member.axes[j]];
      distance.push_back(i == 0 ? 0.0 : distance.back() + own.distance(before, here));
      before = here;
    }
  }
  return progress;
}

ContactRegion contact_region(const Problem& problem, const Configurations& path, std::size_t first, std::size_t second,
                             std::size_t cells) {
  const std::vector<TeamMember> members = problem.scene->members();
  const std::vector<std::size_t> axes = axes_of(members, {first, second});
  const auto scene = axes.size() == problem.space.dimension() ? problem.scene : problem.scene->reduced(axes);
  std::vector<Axis> own;
  own.reserve(axes.size());
  for (const std::size_t axis : axes) own.push_back(problem.space.axes()[axis]);
  const auto checker = make_checker(problem.collision, scene, Space("pair", own), problem.resolution);
  const RobotsPath one = own_path(problem, members[first], path);
  const RobotsPath other = own_path(problem, members[second], path);
  ContactRegion region{first, second, cells, {}};
  Configuration a(one.axes().size()), b(other.axes().size()), q(axes.size());
  const auto place = [&](const RobotsPath& robot, const Configuration& at) {
    for (std::size_t j = 0; j < at.size(); ++j) {
      const auto column = std::lower_bound(axes.begin(), axes.end(), robot.axes()[j]) - axes.begin();
      q[static_cast<std::size_t>(column)] = at[j];
    }
  };
  for (std::size_t row = 0; row < cells; ++row) {
    other.at((static_cast<double>(row) + 0.5) / static_cast<double>(cells) * other.length(), b);
    place(other, b);
    for (std::size_t column = 0; column < cells; ++column) {
      one.at((static_cast<double>(column) + 0.5) / static_cast<double>(cells) * one.length(), a);
      place(one, a);
      region.touch.push_back(checker->valid(q) ? 0 : 1);
    }
  }
  return region;
}

std::optional<draw::Figure> schedule_figure(const Problem& problem, const Configurations& path) {
  if (!has_schedule(problem) || path.size() < 2) return std::nullopt;
  constexpr std::size_t most_pairs_drawn = 5;
  const TeamProgress progress = progress_of(problem, path);
  draw::Figure figure;
  figure.title = fmt::format("When the robots move: {}", problem.name);
  figure.panels.push_back(progress_panel(progress));
  const std::vector<ContactRegion> regions = chosen_regions(problem, path, progress, most_pairs_drawn);
  for (const ContactRegion& region : regions) {
    figure.panels.push_back(pair_panel(progress, region, figure.panels.size() == 1));
  }
  figure.columns = std::min<std::size_t>(3, figure.panels.size());
  figure.legend = draw::Legend::above;
  figure.caption = "Robots move at 1 m/s at most, each in the metric of its own coordinates; a level line waits.";
  if (regions.empty()) {
    figure.caption += " No two robots can touch on their paths.";
  } else {
    figure.caption +=
        fmt::format(" Where two robots touch, for every place of the one on its path and of the other on its own: {}.",
                    regions.size() < most_pairs_drawn
                        ? "all pairs that can touch"
                        : "first the pairs that would touch at 1 m/s, then those that can touch at most places");
  }
  return figure;
}

PageSchedules schedules_of(const Experiment& experiment, const ExperimentResult& result) {
  PageSchedules schedules;
  for (const Problem& problem : experiment.problems) {
    std::vector<std::string> of;
    for (const auto& entry : experiment.strategies) {
      of.emplace_back();
      for (const RunResult* run : select_runs(result, problem.name, entry.first)) {
        if (!run->run.solved) continue;
        auto figure = schedule_figure(problem, run->run.path);
        if (figure) figure->title += fmt::format(", {}, seed {}", entry.first, run->seed);
        if (figure) of.back() = draw::plot(*figure).markup("schedule");
        break;
      }
    }
    schedules.push_back(std::move(of));
  }
  return schedules;
}

void write_schedule_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                            const FigureStyle& style) {
  Directories problems;
  for (const Problem& problem : experiment.problems) {
    const std::filesystem::path folder = std::filesystem::path(directory) / problems(problem.name);
    if (!has_schedule(problem)) continue;
    Directories strategies;
    for (const auto& entry : experiment.strategies) {
      const std::filesystem::path place = folder / strategies(entry.first);
      for (const RunResult* run : select_runs(result, problem.name, entry.first)) {
        if (!run->run.solved) continue;
        auto figure = schedule_figure(problem, run->run.path);
        if (!figure) break;
        figure->title += fmt::format(", {}, seed {}", entry.first, run->seed);
        make_directory(place.string());
        write_figure(std::move(*figure), style, (place / "schedule").string());
        break;
      }
    }
  }
}

}  // namespace trellis
