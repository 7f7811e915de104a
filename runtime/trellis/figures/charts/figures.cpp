// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <tuple>

#include <trellis/base/parallel.hpp>
#include <trellis/draw/chart.hpp>
#include <trellis/draw/figures.hpp>
#include <trellis/figures/charts/figures.hpp>
#include <trellis/figures/charts/pictures.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/verdict.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

draw::WaterfallStep step(const std::string& label, const Interval& interval) {
  return {label, interval.value, interval.lo, interval.hi};
}

/// Says of what the nats of a picture are: of all seeds together or means over runs, and what is not drawn.
class Headlines {
 public:
  void add(const LevelSummary& level, SampleRole role) {
    const Headline found = headline(level, role);
    if (found.seeds == 0 && found.runs == 0) return;
    seeds_ = std::max(seeds_, found.seeds);
    runs_ = std::max(runs_, found.runs);
    crossed_ = crossed_ || level.root_cross.tree.scored > 0;
    blank_ = blank_ || !found.above.blank.empty();
  }
  /// "of all 15 seeds together, on paths of seeds left out; whiskers: what the samples support, with 95 %".
  [[nodiscard]] std::string text() const {
    std::string text = seeds_ > 0 ? fmt::format("of all {} seeds together, on the paths of a seed left out", seeds_)
                                  : fmt::format("means over {}, on {}", plural(runs_, "run"),
                                                crossed_ ? "the paths of other seeds" : "their own paths");
    text += "; whiskers: what the samples support, with 95 %";
    if (blank_) text += "; not drawn: too few samples to show on which side of uniform sampling they are";
    return text;
  }

 private:
  std::size_t seeds_ = 0;
  std::size_t runs_ = 0;
  bool crossed_ = false;
  bool blank_ = false;
};

/// Records over how many runs the means of a picture are: the runs that have the value, not all runs.
class Averaged {
 public:
  void add(const Interval& interval) {
    const std::size_t n = interval.n + interval.infinite;
    if (n == 0) return;
    least_ = most_ == 0 ? n : std::min(least_, n);
    most_ = std::max(most_, n);
  }
  /// "means over 2 of 20 runs, too few for whiskers".
  /// \param marks  the symbols that show the intervals; "": none
  [[nodiscard]] std::string text(std::size_t runs, const std::string& marks) const {
    std::string means = (marks.empty() ? "Means over " : "means over ") + averaged_text(least_, most_, runs);
    if (marks.empty()) return means;
    if (most_ < least_for_interval) return fmt::format("{}, too few for {}", means, marks);
    return fmt::format("{}; {}: 95 % Student interval", means, marks);
  }

 private:
  std::size_t least_ = 0;
  std::size_t most_ = 0;
};

/// Returns the guides of a level that have their own steps, in the waterfall's order.
std::vector<const WaterfallStep*> steps_to(const Waterfall& waterfall, int level) {
  std::vector<const WaterfallStep*> steps;
  for (const WaterfallStep& s : waterfall.steps) {
    if (s.level == level) steps.push_back(&s);
  }
  return steps;
}

constexpr std::size_t narrow_name = 14;  ///< of a level, in one of several panels
constexpr std::size_t wide_name = 28;

/// Adds one panel for each path from an unguided level to the root: a chain has one, a mixture several.
void add_panels(const RunsSummary& summary, const Waterfall& waterfall, const std::string& role,
                draw::Waterfall& picture) {
  std::vector<std::vector<const WaterfallStep*>> chains;
  const auto follow = [&](int level, const std::vector<const WaterfallStep*>& chain, auto&& self) -> void {
    for (const WaterfallStep* s : steps_to(waterfall, level)) {
      auto longer = chain;
      longer.insert(longer.begin(), s);
      if (s->from < 0) {
        chains.push_back(std::move(longer));
      } else {
        self(s->from, longer, self);
      }
    }
  };
  follow(0, {}, follow);
  for (std::size_t w = 0; w < chains.size(); ++w) {
    draw::WaterfallPanel panel;
    panel.title = chains.size() == 1 ? role : fmt::format("{}, by {}", role, [&] {
      return short_level(summary.levels[static_cast<std::size_t>(chains[w].front()->level)].name, narrow_name);
    }());
    for (const WaterfallStep* s : chains[w]) {
      panel.levels.push_back(step(summary.levels[static_cast<std::size_t>(s->level)].name, s->added));
    }
    const auto of_root = std::find_if(waterfall.steps.begin(), waterfall.steps.end(),
                                      [](const WaterfallStep& s) { return s.level == 0; });
    panel.root = step("above uniform", of_root != waterfall.steps.end() ? of_root->after : Interval{});
    picture.panels.push_back(std::move(panel));
  }
}

/// Returns what a caption says of nats that are bounds, by mass and arc length; "" where none are.
std::string bound_text(const RunsSummary& summary) {
  const bool bounds = std::any_of(summary.levels.begin(), summary.levels.end(), [](const LevelSummary& level) {
    return std::any_of(level.root.tree.flags.begin(), level.root.tree.flags.end(),
                       [](const auto& flag) { return flag.first == "lower bound"; });
  });
  return bounds ? " Without recorded densities at most: from mass and arc length, which do not show losses across the "
                  "path."
                : "";
}

/// Adds a panel for the profile of one level and role, because two roles usually have different numbers of bins.
void add_profile(const Figure& figure, const std::string& level, const std::string& role, const draw::Colour& colour,
                 draw::Profile& picture) {
  if (figure.profile.empty()) return;
  const std::size_t bins = figure.profile.size();
  draw::ProfilePanel panel;
  panel.title = fmt::format("{}: {}", short_level(level, wide_name), role);
  for (std::size_t i = 0; i <= bins; ++i) panel.edges.push_back(static_cast<double>(i) / static_cast<double>(bins));
  panel.target = figure.profile_target;
  draw::ProfileSeries series;
  series.name = role;
  series.colour = colour;
  for (const Interval& share : figure.profile) {
    series.share.push_back(share.value);
    series.lo.push_back(share.lo);
    series.hi.push_back(share.hi);
  }
  panel.series.push_back(std::move(series));
  picture.panels.push_back(std::move(panel));
}

/// Whether a panel is not empty.
bool has_bars(const draw::WaterfallPanel& panel) {
  return !std::isnan(panel.root.value) || std::any_of(panel.levels.begin(), panel.levels.end(),
                                                      [](const auto& level) { return !std::isnan(level.value); });
}

/// Returns the panels of a profile as strips below each other.
draw::StripFigure strips_of(const draw::Profile& profile, const std::string& heading, const std::string& means) {
  draw::StripFigure figure;
  figure.title = heading + ": along the path, samples beside the target";
  figure.x_label = profile.x_label;
  figure.caption = fmt::format(
      "Each level in its own space along its own path. A bin's colour is the share of the samples in it, divided by "
      "the "
      "target's share; crossed out: no samples. {}.",
      means);
  for (const draw::ProfilePanel& panel : profile.panels) {
    figure.strips.push_back({panel.title, panel.edges, panel.series.front().share, panel.target});
  }
  return figure;
}

/// A point of the plane: nats above uniform by mass and by spread, with their intervals.
struct PlanePoint {
  Interval mass;
  Interval spread;
};

/// Returns the point of a level's headline; nullopt where its interval is blank.
std::optional<PlanePoint> plane_point(const LevelSummary& level, SampleRole role) {
  const Headline found = headline(level, role);
  if (!found.above.printed() || !std::isfinite(found.mass)) return std::nullopt;
  const double mass = found.uniform - found.mass;
  // Counting determines the mass far better than anything determines the spread: the whole interval is that of spread.
  const Interval spread{0.5 * (found.above.lo + found.above.hi) - mass, found.above.lo - mass, found.above.hi - mass,
                        found.runs, 0};
  return PlanePoint{{mass, mass, mass, found.runs, 0}, spread};
}

draw::Series point_series(std::size_t level, const std::string& name, const PlanePoint& at) {
  draw::Series series{.kind = draw::Series::Kind::points,
                      .name = fmt::format("{} {}", level, short_level(name, wide_name)),
                      .colour = draw::palette::level(level)};
  series.x = {at.mass.value};
  series.y = {at.spread.value};
  series.lo = {at.spread.lo};
  series.hi = {at.spread.hi};
  series.x_lo = {at.mass.lo};
  series.x_hi = {at.mass.hi};
  // Colours repeat after the fourth level.
  const bool first = level < draw::palette::levels.size();
  series.marker = first ? draw::Marker::circle : draw::Marker::square;
  return series;
}

/// Draws for each level the gain of its samples, lifted to the root, over uniform: mass to the right, spread upwards.
/// Arrows point from a guiding level to the level that it guides.
std::optional<draw::Figure> plane_figure(const std::string& heading, const RunsSummary& summary) {
  if (summary.levels.size() < 2) return std::nullopt;
  draw::Figure figure{.title = heading + ": mass and spread of its levels"};
  Headlines headlines;
  for (const auto& [role, part, falls] :
       {std::tuple{"tree", SampleRole::tree, &summary.tree_waterfall},
        std::tuple{"expansion", SampleRole::expansion, &summary.expansion_waterfall}}) {
    draw::Panel panel{.title = role};
    panel.x.label = "mass (nats above uniform)";
    panel.y.label = "spread (nats above uniform)";
    panel.series.push_back({.kind = draw::Series::Kind::points,
                            .name = "uniform sampling",
                            .x = {0.0},
                            .y = {0.0},
                            .colour = draw::palette::muted,
                            .marker = draw::Marker::cross});
    std::vector<std::optional<PlanePoint>> points;
    for (std::size_t i = 0; i < summary.levels.size(); ++i) {
      const LevelSummary& level = summary.levels[i];
      points.push_back(plane_point(level, part));
      headlines.add(level, part);
      if (!points.back()) continue;
      panel.series.push_back(point_series(i, level.name, *points.back()));
    }
    if (panel.series.size() < 2) continue;
    for (const WaterfallStep& step : falls->steps) {
      const auto place = [&](int level) -> std::optional<draw::Point> {
        if (level < 0) return draw::Point{0.0, 0.0};
        const auto& at = points[static_cast<std::size_t>(level)];
        if (!at) return std::nullopt;
        return draw::Point{at->mass.value, at->spread.value};
      };
      const auto from = place(step.from);
      const auto to = place(step.level);
      if (from && to) panel.connectors.push_back({*from, *to, true});
    }
    figure.panels.push_back(std::move(panel));
  }
  if (figure.panels.empty()) return std::nullopt;
  figure.columns = figure.panels.size();
  figure.panel_height = 190.0;
  figure.legend = draw::Legend::above;
  figure.caption = fmt::format(
      "Levels lifted to the root's space; right: more samples lie in the target; up: they cover it more evenly. The "
      "sum is what a level gains above uniform; {}. Arrows lead from a level to the one that it guides.{}",
      headlines.text(), bound_text(summary));
  return figure;
}

}  // namespace

StrategyFigures strategy_figures(const std::string& problem, const std::string& strategy, const RunsSummary& summary) {
  StrategyFigures figures;
  if (summary.levels.empty()) return figures;
  const std::string heading = fmt::format("{} on {}", strategy, problem);

  draw::Waterfall waterfall;
  waterfall.title = heading + ": what each level adds above uniform";
  Headlines in_waterfall;
  for (const LevelSummary& level : summary.levels) {
    for (const SampleRole role : {SampleRole::tree, SampleRole::expansion}) in_waterfall.add(level, role);
  }
  waterfall.caption = fmt::format("Lifted to the root's space: {}.{}", in_waterfall.text(), bound_text(summary));
  add_panels(summary, summary.tree_waterfall, "tree", waterfall);
  add_panels(summary, summary.expansion_waterfall, "expansion", waterfall);
  std::erase_if(waterfall.panels, [](const draw::WaterfallPanel& panel) { return !has_bars(panel); });
  if (!waterfall.panels.empty()) figures.waterfall = draw::waterfall(waterfall);

  draw::Profile profile;
  profile.title = heading + ": where along the path its samples lie";
  Averaged in_profile;
  for (const LevelSummary& level : summary.levels) {
    for (const Figure* shown : {&level.own.tree, &level.own.expansion}) {
      if (!shown->profile.empty()) in_profile.add(shown->profile.front());
    }
    add_profile(level.own.tree, level.name, "tree", draw::palette::tree, profile);
    add_profile(level.own.expansion, level.name, "expansion", draw::palette::expansion, profile);
  }
  profile.caption = fmt::format("Each level in its own space along its own path; dashed: the target; {}.",
                                in_profile.text(summary.runs, "bands"));
  if (!profile.panels.empty()) {
    figures.profile = draw::profile(profile);
    figures.strip = strips_of(profile, heading, in_profile.text(summary.runs, ""));
  }
  figures.plane = plane_figure(heading, summary);
  return figures;
}

std::optional<draw::Figure> waterfalls_figure(const std::string& problem, const std::vector<NamedSummary>& strategies) {
  draw::Waterfall all;
  Headlines headlines;
  std::size_t shown = 0;
  double perfect = 0.0;
  std::string bounds;
  for (const auto& [strategy, of] : strategies) {
    if (of->levels.size() < 2) continue;
    if (bounds.empty()) bounds = bound_text(*of);
    const LevelSummary& root = of->levels.front();
    draw::Waterfall own;
    add_panels(*of, of->tree_waterfall, "tree", own);
    add_panels(*of, of->expansion_waterfall, "expansion", own);
    for (const LevelSummary& level : of->levels) {
      for (const SampleRole role : {SampleRole::tree, SampleRole::expansion}) headlines.add(level, role);
    }
    const std::size_t before = all.panels.size();
    for (draw::WaterfallPanel& panel : own.panels) {
      if (!has_bars(panel)) continue;
      for (draw::WaterfallStep& level : panel.levels) level.label = short_level(level.label, narrow_name);
      panel.title = strategy + "\n" + panel.title;
      all.panels.push_back(std::move(panel));
    }
    if (all.panels.size() == before) continue;
    ++shown;
    for (const SampleRole role : {SampleRole::tree, SampleRole::expansion}) {
      const Headline top = headline(root, role);
      if (std::isfinite(top.uniform - top.perfect)) perfect = std::max(perfect, top.uniform - top.perfect);
    }
  }
  if (shown < 2) return std::nullopt;
  all.title = fmt::format("{}: what each level adds above uniform, on one scale", problem);
  all.caption = fmt::format(
      "Lifted to the root's space: {}. The scale ends above "
      "perfect guidance, and as far below uniform sampling: what is beyond has an arrow.{}",
      headlines.text(), bounds);
  draw::Figure figure = draw::waterfall(all);
  figure.columns = 4;
  figure.width = 700.0;
  figure.panel_height = 120.0;
  constexpr double above = 1.6;  // times perfect guidance: estimates may exceed it, and texts need space
  constexpr double below = 1.25;
  for (draw::Panel& panel : figure.panels) {
    if (perfect == 0.0) break;
    panel.y.lo = -below * perfect;
    panel.y.hi = above * perfect;
  }
  return figure;
}

void write_figures(const ExperimentSummary& experiment, const std::string& directory, unsigned jobs,
                   const FigureStyle& style) {
  struct FigureJob {
    const ProblemSummary* problem;
    const StrategySummary* strategy;
    std::filesystem::path place;
  };
  std::vector<FigureJob> tasks;
  std::vector<std::filesystem::path> places;
  Directories problems;
  for (const ProblemSummary& problem : experiment.problems) {
    Directories strategies;
    places.push_back(std::filesystem::path(directory) / problems(problem.problem));
    for (const StrategySummary& one : problem.strategies) {
      // Assigns names first, so that an omitted picture changes no other name.
      tasks.push_back({&problem, &one, places.back() / strategies(one.strategy)});
    }
  }
  in_parallel(tasks.size(), jobs, [&](std::size_t i) {
    const FigureJob& task = tasks[i];
    const StrategyFigures figures =
        strategy_figures(task.problem->problem, task.strategy->strategy, task.strategy->runs);
    if (!figures.waterfall && !figures.profile && !figures.plane) return;
    make_directory(task.place.string());
    if (figures.waterfall) write_figure(*figures.waterfall, style, (task.place / "waterfall").string());
    if (figures.profile) write_figure(*figures.profile, style, (task.place / "profile").string());
    if (figures.strip) write_figure(*figures.strip, style, (task.place / "strip").string());
    if (figures.plane) write_figure(*figures.plane, style, (task.place / "plane").string());
  });
  in_parallel(places.size(), jobs, [&](std::size_t p) {
    const ProblemSummary& problem = experiment.problems[p];
    std::vector<NamedSummary> named;
    for (std::size_t s = 0; s < problem.strategies.size(); ++s) {
      const StrategySummary& one = problem.strategies[s];
      if (experiment.strategies[s].ablation.empty()) named.push_back({one.strategy, &one.runs});
    }
    if (const auto figure = waterfalls_figure(problem.problem, named)) {
      write_figure(*figure, style, (places[p] / "waterfalls").string());
    }
  });
}

}  // namespace trellis
