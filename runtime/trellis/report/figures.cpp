// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <trellis/base/parallel.hpp>
#include <trellis/draw/chart.hpp>
#include <trellis/draw/figures.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/figures.hpp>
#include <trellis/report/pictures.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

draw::WaterfallStep step(const std::string& label, const Interval& interval) {
  return {label, interval.value, interval.lo, interval.hi};
}

/// How many runs the figures of a picture are means over: those that have one, not all that were made.
class Averaged {
 public:
  void add(const Interval& interval) {
    const std::size_t n = interval.n + interval.infinite;
    if (n == 0) return;
    least_ = most_ == 0 ? n : std::min(least_, n);
    most_ = std::max(most_, n);
  }
  /// "means over 2 of 20 runs, too few for whiskers".
  [[nodiscard]] std::string text(std::size_t runs, const std::string& marks) const {
    const std::string means = "means over " + averaged_text(least_, most_, runs);
    if (most_ < least_for_interval) return fmt::format("{}, too few for {}", means, marks);
    return fmt::format("{}; {}: 95 % Student interval", means, marks);
  }

 private:
  std::size_t least_ = 0;
  std::size_t most_ = 0;
};

/// The guides of a level that have steps of their own, in the waterfall's order.
std::vector<const WaterfallStep*> steps_to(const Waterfall& waterfall, int level) {
  std::vector<const WaterfallStep*> steps;
  for (const WaterfallStep& s : waterfall.steps) {
    if (s.level == level) steps.push_back(&s);
  }
  return steps;
}

/// One panel for each way from a level that nothing guides to the root: a chain has one, a mixture several.
void add_panels(const RunsSummary& summary, const Waterfall& waterfall, const Figure& root, const std::string& role,
                draw::Waterfall& picture) {
  std::vector<std::vector<const WaterfallStep*>> ways;
  const auto follow = [&](int level, const std::vector<const WaterfallStep*>& way, auto&& self) -> void {
    for (const WaterfallStep* s : steps_to(waterfall, level)) {
      auto longer = way;
      longer.insert(longer.begin(), s);
      if (s->from < 0) {
        ways.push_back(std::move(longer));
      } else {
        self(s->from, longer, self);
      }
    }
  };
  follow(0, {}, follow);
  for (std::size_t w = 0; w < ways.size(); ++w) {
    draw::WaterfallPanel panel;
    panel.title = ways.size() == 1 ? role : fmt::format("{}, by {}", role, [&] {
      return summary.levels[static_cast<std::size_t>(ways[w].front()->level)].name;
    }());
    for (const WaterfallStep* s : ways[w]) {
      panel.levels.push_back(step(summary.levels[static_cast<std::size_t>(s->level)].name, s->added));
    }
    panel.root = step("above uniform", root.gain);
    picture.panels.push_back(std::move(panel));
  }
}

/// A panel for the profile of one level and role: the bins of two roles are seldom as many.
void add_profile(const Figure& figure, const std::string& level, const std::string& role, draw::Profile& picture) {
  if (figure.profile.empty()) return;
  const std::size_t bins = figure.profile.size();
  draw::ProfilePanel panel;
  panel.title = fmt::format("{}: {}", level, role);
  for (std::size_t i = 0; i <= bins; ++i) panel.edges.push_back(static_cast<double>(i) / static_cast<double>(bins));
  panel.target = figure.profile_target;
  draw::ProfileSeries series;
  series.name = role;
  for (const Interval& share : figure.profile) {
    series.share.push_back(share.value);
    series.lo.push_back(share.lo);
    series.hi.push_back(share.hi);
  }
  panel.series.push_back(std::move(series));
  picture.panels.push_back(std::move(panel));
}

}  // namespace

StrategyFigures strategy_figures(const std::string& problem, const std::string& strategy, const RunsSummary& summary) {
  StrategyFigures figures;
  if (summary.levels.empty()) return figures;
  const std::string heading = fmt::format("{} on {}", strategy, problem);

  draw::Waterfall waterfall;
  waterfall.title = heading + ": what each level adds above uniform";
  const FigurePair& root = summary.levels.front().root;
  Averaged in_waterfall;
  for (const Waterfall* shown : {&summary.tree_waterfall, &summary.expansion_waterfall}) {
    for (const WaterfallStep& s : shown->steps) in_waterfall.add(s.added);
  }
  waterfall.caption = fmt::format("Lifted to the root's space, against the root's own path; {}.",
                                  in_waterfall.text(summary.runs, "whiskers"));
  add_panels(summary, summary.tree_waterfall, root.tree, "tree", waterfall);
  add_panels(summary, summary.expansion_waterfall, root.expansion, "expansion", waterfall);
  if (!waterfall.panels.empty()) figures.waterfall = draw::waterfall(waterfall);

  draw::Profile profile;
  profile.title = heading + ": where along the path its samples lie";
  Averaged in_profile;
  for (const LevelSummary& level : summary.levels) {
    for (const Figure* shown : {&level.own.tree, &level.own.expansion}) {
      if (!shown->profile.empty()) in_profile.add(shown->profile.front());
    }
    add_profile(level.own.tree, level.name, "tree", profile);
    add_profile(level.own.expansion, level.name, "expansion", profile);
  }
  profile.caption = fmt::format("Each level in its own space along its own path; dashed: the target; {}.",
                                in_profile.text(summary.runs, "bands"));
  if (!profile.panels.empty()) figures.profile = draw::profile(profile);
  return figures;
}

void write_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                   unsigned jobs) {
  struct Task {
    std::string problem;
    std::string strategy;
    std::filesystem::path place;
  };
  std::vector<Task> tasks;
  tasks.reserve(experiment.problems.size() * experiment.strategies.size());
  Directories problems;
  for (const auto& problem : experiment.problems) {
    Directories strategies;
    for (const auto& entry : experiment.strategies) {
      // Named first, so that what is left out changes no other's name.
      tasks.push_back({problem.name, entry.first,
                       std::filesystem::path(directory) / problems(problem.name) / strategies(entry.first)});
    }
  }
  in_parallel(tasks.size(), jobs, [&](std::size_t i) {
    const Task& task = tasks[i];
    const RunsSummary summary = summarise(select_runs(result, task.problem, task.strategy));
    const StrategyFigures figures = strategy_figures(task.problem, task.strategy, summary);
    if (!figures.waterfall && !figures.profile) return;
    make_directory(task.place.string());
    if (figures.waterfall) write_picture(draw::plot(*figures.waterfall), (task.place / "waterfall").string());
    if (figures.profile) write_picture(draw::plot(*figures.profile), (task.place / "profile").string());
  });
}

}  // namespace trellis
