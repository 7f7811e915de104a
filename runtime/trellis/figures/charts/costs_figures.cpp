// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>

#include <trellis/figures/charts/costs_figures.hpp>
#include <trellis/figures/charts/pictures.hpp>
#include <trellis/measure/censored_cost.hpp>
#include <trellis/report/cost_correlation.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/parameter_sweeps.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The least of a median's 95 % interval by order statistics: 2 / 2^6 is below 5 %.
constexpr std::size_t pairs_of_interval = 6;

// Ratios
// ---------------------------------------------------------------------------------------------------------------

/// Returns the groups in the order of the problems: circles for those on which the strategies were tuned, discs for the
/// others. Problems without a group have a colour each, if they are few.
std::vector<draw::RatioGroup> groups_of(const CostData& data, std::vector<std::size_t>& group_of_problem) {
  std::vector<draw::RatioGroup> groups;
  std::map<std::string, std::size_t> known;
  const bool ungrouped =
      std::all_of(data.problems.begin(), data.problems.end(), [](const auto& p) { return p.group.empty(); });
  const bool apart = ungrouped && data.problems.size() <= draw::palette::series.size();
  for (const auto& problem : data.problems) {
    const auto [found, fresh] = known.emplace(apart ? problem.name : problem.group, groups.size());
    if (fresh) {
      std::string name = apart ? problem.name : "problem";
      if (!ungrouped) {
        name = fmt::format("{} ({})", problem.group.empty() ? "no group" : problem.group,
                           problem.tuned ? "tuned on" : "held out");
      }
      groups.push_back({std::move(name), draw::palette::nth(groups.size()), problem.tuned});
    }
    group_of_problem.push_back(found->second);
  }
  return groups;
}

/// With a single problem the ratio is printed beside the dot, as in a forest plot; with several problems, the problem
/// of the largest ratio.
draw::RatioDot dot(const CostData& data, const CostComparison& c, const CostRatio& ratio, std::size_t group) {
  draw::RatioDot dot{group, data.problems[c.problem].name, ratio.ratio.value, ratio.ratio.lo, ratio.ratio.hi};
  if (ratio.pairs < pairs_of_interval) dot.lo = dot.hi = nan;
  if (data.problems.size() == 1) {
    dot.text = ratio_text(ratio.ratio);
    for (auto at = dot.text.find("inf"); at != std::string::npos; at = dot.text.find("inf"))
      dot.text.replace(at, 3, "∞");
  }
  return dot;
}

void fill(const CostData& data, const std::vector<CostComparison>& comparisons, const FigureStyle& style,
          draw::RatioFigure& figure) {
  std::vector<std::size_t> group_of;
  figure.groups = groups_of(data, group_of);
  if (style.checks) figure.panels.emplace_back("validity checks, all levels");
  if (style.seconds) figure.panels.emplace_back("CPU time");
  if (data.problems.size() == 1) figure.texts = "[95 %]";
  figure.x_label = "cost / cost of the reference (left of 1: costs less)";
  std::map<std::size_t, draw::RatioRow> rows;
  for (const CostComparison& c : comparisons) {
    draw::RatioRow& row = rows[c.strategy];
    row.name = data.strategies[c.strategy].name;
    row.panels.resize(figure.panels.size());
    if (style.checks) row.panels.front().push_back(dot(data, c, c.checks, group_of[c.problem]));
    if (style.seconds) row.panels.back().push_back(dot(data, c, c.seconds, group_of[c.problem]));
  }
  for (auto& [strategy, row] : rows) figure.rows.push_back(std::move(row));
}

/// Explains a figure of ratios, with the number of pairs of the medians.
std::string ratios_caption(const CostData& data, const std::vector<CostComparison>& comparisons) {
  std::size_t least = std::numeric_limits<std::size_t>::max();
  std::size_t most = 0;
  for (const CostComparison& c : comparisons) {
    least = std::min(least, c.checks.pairs);
    most = std::max(most, c.checks.pairs);
  }
  const bool intervals = most >= pairs_of_interval;
  const bool one = data.problems.size() == 1;
  return fmt::format(
      "{} median of the strategy's cost divided by the reference's on the same seed, over {} of runs, {}. A run "
      "without a path costs infinitely much. Left of 1 the strategy costs less. An arrow instead of a dot: to the "
      "right, most of its runs found no path; to the left, most of the reference's.{}{}",
      one ? "A dot is the" : "A dot is a problem: the",
      least >= most ? plural(most, "pair") : fmt::format("{} to {}", least, plural(most, "pair")),
      intervals ? "with its 95 % interval" : "too few for a 95 % interval",
      intervals ? " An arrowhead: the interval continues beyond the axis." : "",
      one ? "" : " The problem with the largest ratio of a row has its name beside it.");
}

void write(const CostData& data, const std::vector<CostComparison>& comparisons, draw::RatioFigure figure,
           const FigureStyle& style, const std::string& stem) {
  if (comparisons.empty()) return;
  figure.caption = ratios_caption(data, comparisons);
  fill(data, comparisons, style, figure);
  write_figure(std::move(figure), style, stem);
}

/// Colours for strategies other than the baseline; beyond them lines are dashed.
constexpr std::size_t strategy_colours = 6;

// Curves
// ---------------------------------------------------------------------------------------------------------------

struct Quantity {
  CostKind kind;
  const char* label;
  double unit;                ///< of the axis, in the unit of the costs
  bool FigureStyle::*chosen;  ///< whether it has panels
};
constexpr std::array<Quantity, 2> quantities = {
    {{CostKind::checks, "validity checks, all levels", 1.0, &FigureStyle::checks},
     {CostKind::seconds, "CPU time (ms)", 1e-3, &FigureStyle::seconds}}};

std::size_t index_of(const CostData& data, const std::string& strategy) {
  const auto found = std::find_if(data.strategies.begin(), data.strategies.end(),
                                  [&](const CostData::Strategy& s) { return s.name == strategy; });
  return static_cast<std::size_t>(found - data.strategies.begin());
}

/// Distributes the strategies over rows of panels with few curves each; every row includes the baseline.
/// \param most_curves  in a panel, without the baseline's
std::vector<std::vector<std::size_t>> rows_of(const std::vector<std::size_t>& strategies, std::size_t baseline,
                                              std::size_t most_curves) {
  const bool has = std::find(strategies.begin(), strategies.end(), baseline) != strategies.end();
  std::vector<std::vector<std::size_t>> rows;
  std::size_t in_row = most_curves;
  for (const std::size_t s : strategies) {
    if (s == baseline) continue;
    if (in_row == most_curves) {
      rows.push_back(has ? std::vector{baseline} : std::vector<std::size_t>());
      in_row = 0;
    }
    rows.back().push_back(s);
    ++in_row;
  }
  if (rows.empty() && has) rows.push_back({baseline});
  return rows;
}

/// A step function of a cost; `before` is its value before the first cost.
struct Curve {
  std::size_t strategy = 0;
  std::vector<double> at;
  std::vector<Interval> y;
  Interval before;
  double spent = 0.0;  ///< the end of the curve
};

/// The logarithmic axis of all panels of a quantity.
struct CostAxis {
  double first = infinity;  ///< less than each cost above 0
  double last = 0.0;

  void add(const Curve& curve) {
    constexpr double before = 0.8;  // the axis begins at this share of the first cost
    for (const double at : curve.at) first = at > 0.0 ? std::min(first, before * at) : first;
    last = std::max(last, curve.spent);
  }
};

draw::Panel curves_panel(const CostData& data, const std::string& baseline, const std::vector<Curve>& curves,
                         const CostAxis& axis) {
  draw::Panel panel;
  panel.x.scale = draw::AxisScale::log;
  panel.x.lo = axis.first;
  panel.x.hi = axis.last;
  for (const Curve& curve : curves) {
    draw::Series series{.kind = draw::Series::Kind::steps,
                        .name = data.strategies[curve.strategy].name,
                        .x = {axis.first},
                        .colour = strategy_colour(data, baseline, curve.strategy)};
    constexpr std::array dashes = {draw::Dash::solid, draw::Dash::dashed, draw::Dash::dotted};
    const std::size_t earlier = index_of(data, baseline) < curve.strategy ? 1 : 0;
    series.dash = dashes.at((curve.strategy - earlier) / strategy_colours % dashes.size());
    const auto add = [&](const Interval& y) {
      series.y.push_back(y.value);
      series.lo.push_back(y.lo);
      series.hi.push_back(y.hi);
    };
    add(curve.before);
    for (std::size_t i = 0; i < curve.at.size(); ++i) {
      series.x.push_back(std::max(curve.at[i], axis.first));
      add(curve.y[i]);
    }
    series.x.push_back(std::max(axis.last, series.x.back()));
    panel.series.push_back(std::move(series));
  }
  return panel;
}

/// Draws panels of checks and of CPU time side by side, few strategies per row; one axis for all panels of a quantity.
/// None without any curve.
std::optional<draw::Figure> curves_figure(const CostData& data, const std::string& baseline,
                                          const std::vector<std::size_t>& strategies, const std::string& y_label,
                                          const FigureStyle& style,
                                          const std::function<Curve(std::size_t strategy, CostKind kind)>& curve_of) {
  draw::Figure figure{.columns = 0, .share_y = true, .panel_height = 130.0};
  const auto rows = rows_of(strategies, index_of(data, baseline), style.curves);
  std::vector<std::vector<draw::Panel>> columns;
  for (const Quantity& quantity : quantities) {
    if (!(style.*quantity.chosen)) continue;
    CostAxis axis;
    std::vector<std::vector<Curve>> curves;
    for (const auto& row : rows) {
      curves.emplace_back();
      for (const std::size_t s : row) {
        curves.back().push_back(curve_of(s, quantity.kind));
        for (double& at : curves.back().back().at) at /= quantity.unit;
        curves.back().back().spent /= quantity.unit;
        axis.add(curves.back().back());
      }
    }
    if (!(axis.first < axis.last)) continue;
    columns.emplace_back();
    for (const auto& row : curves) {
      draw::Panel panel = curves_panel(data, baseline, row, axis);
      panel.x.label = quantity.label;
      panel.y.label = y_label;
      columns.back().push_back(std::move(panel));
    }
  }
  if (columns.empty()) return std::nullopt;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (auto& column : columns) figure.panels.push_back(std::move(column[r]));
  }
  figure.columns = columns.size();
  figure.legend = draw::Legend::above;
  return figure;
}

/// "15 runs of each strategy".
class Runs {
 public:
  void add(std::size_t runs) {
    if (runs == 0) return;
    least_ = most_ == 0 ? runs : std::min(least_, runs);
    most_ = std::max(most_, runs);
  }
  [[nodiscard]] std::string text() const {
    return (least_ == most_ ? plural(most_, "run") : fmt::format("{} to {}", least_, plural(most_, "run"))) +
           " of each strategy";
  }

 private:
  std::size_t least_ = 0;
  std::size_t most_ = 0;
};

std::vector<std::size_t> strategies_on(const CostData& data, std::size_t problem) {
  std::vector<std::size_t> found;
  for (std::size_t s = 0; s < data.strategies.size(); ++s) {
    const auto of = [&](const CostData::Run& run) { return run.problem == problem && run.strategy == s; };
    if (std::any_of(data.runs.begin(), data.runs.end(), of)) found.push_back(s);
  }
  return found;
}

}  // namespace

draw::Colour strategy_colour(const CostData& data, const std::string& baseline, std::size_t strategy) {
  using namespace draw::palette;  // NOLINT(google-build-using-namespace): its names say what they are
  if (data.strategies[strategy].name == baseline) return draw::palette::baseline;
  // The baseline has its own colour; blue, which is similar, comes last.
  constexpr std::array<draw::Colour, strategy_colours> colours = {vermillion, green, purple, orange, black, blue};
  const std::size_t before = index_of(data, baseline) < strategy ? 1 : 0;
  return colours.at((strategy - before) % colours.size());
}

std::optional<draw::Figure> success_figure(const CostData& data, const std::string& baseline, std::size_t problem,
                                           const FigureStyle& style) {
  Runs runs;
  const auto percent = [](Interval share) {
    for (double* x : {&share.value, &share.lo, &share.hi}) *x *= 100.0;
    return share;
  };
  auto figure =
      curves_figure(data, baseline, strategies_on(data, problem), "runs with a path (%)", style,
                    [&](std::size_t strategy, CostKind kind) {
                      const SuccessCurve found = success_curve(data, problem, strategy, kind);
                      runs.add(found.runs);
                      Curve curve{strategy, found.at, {}, percent(wilson_interval(0, found.runs)), found.spent};
                      for (const Interval& share : found.share) curve.y.push_back(percent(share));
                      return curve;
                    });
  if (!figure) return figure;
  figure->title = fmt::format("{}: runs that found a path over what they cost", data.problems[problem].name);
  figure->caption = fmt::format("{}; bands: 95 % Wilson interval of the share.", runs.text());
  for (draw::Panel& panel : figure->panels) {
    panel.y.lo = 0.0;
    panel.y.hi = 100.0;
  }
  return figure;
}

std::optional<draw::Figure> length_figure(const CostData& data, const std::string& baseline, std::size_t problem,
                                          const FigureStyle& style) {
  std::vector<std::size_t> anytime;
  for (const std::size_t s : strategies_on(data, problem)) {
    if (length_curve(data, problem, s, CostKind::checks).improves) anytime.push_back(s);
  }
  Runs runs;
  auto figure =
      curves_figure(data, baseline, anytime, "length of the path (m)", style, [&](std::size_t strategy, CostKind kind) {
        const LengthCurve found = length_curve(data, problem, strategy, kind);
        runs.add(found.runs);
        Curve curve{strategy, found.at, {}, {}, found.spent};
        for (Interval length : found.length) {
          // Until half of the runs have a path there is no median; an infinite interval has no band.
          if (!std::isfinite(length.value)) length.value = nan;
          if (!std::isfinite(length.hi) || std::isnan(length.value)) length.lo = length.hi = nan;
          curve.y.push_back(length);
        }
        return curve;
      });
  if (!figure) return figure;
  figure->title = fmt::format("{}: length of the shortest path known over what it cost", data.problems[problem].name);
  figure->caption = fmt::format(
      "Planners that improve their path; medians over {}, a run without a path infinite; bands: 95 % interval by order "
      "statistics. A curve begins where half of the runs have a path.",
      runs.text());
  return figure;
}

std::optional<draw::RatioFigure> ratio_figure(const CostData& data, const std::string& baseline,
                                              const FigureStyle& style) {
  if (baseline.empty() || data.strategies.size() < 2) return std::nullopt;
  auto comparisons = compare_costs(data, CostReference::baseline, baseline);
  bool swept = false;
  for (const ParameterSweep& sweep : parameter_sweeps(data)) {
    const auto of_sweep = [&](const CostComparison& c) { return sweep.has(c.strategy); };
    swept = std::erase_if(comparisons, of_sweep) > 0 || swept;
  }
  if (comparisons.empty()) return std::nullopt;
  constexpr double default_width = 504.0;
  draw::RatioFigure figure{
      .title = data.problems.size() == 1
                   ? fmt::format("{}: costs beside {}, paired by seed", data.problems.front().name, baseline)
                   : fmt::format("Costs beside {}, paired by seed", baseline),
      .caption = ratios_caption(data, comparisons),
      .lines = {{1.0, "as " + baseline, draw::Dash::solid}},
      .width = default_width};
  if (swept) figure.caption += " Strategies that differ in one number are in the figure of its sweep.";
  fill(data, comparisons, style, figure);
  return figure;
}

namespace {

/// One quantity of all points of a sweep, in a panel.
struct SweepPanel {
  draw::Panel panel;
  std::function<Interval(std::size_t problem, std::size_t strategy)> value;
};

/// Returns the median cost of a strategy's runs; an unsolved run costs infinitely much.
Interval median_of(const CostData& data, std::size_t problem, std::size_t strategy, CostKind kind) {
  std::vector<CensoredCost> costs;
  for (const CostData::Run& run : data.runs) {
    if (run.problem != problem || run.strategy != strategy) continue;
    const bool checks = kind == CostKind::checks;
    if (checks || !std::isnan(run.seconds)) {
      costs.push_back({checks ? run.checks - run.improvement_checks : run.seconds, run.solved});
    }
  }
  Interval median = costs.empty() ? Interval{} : median_cost(costs);
  if (costs.size() < pairs_of_interval) median.lo = median.hi = nan;
  return median;
}

Interval success_of(const CostData& data, std::size_t problem, std::size_t strategy) {
  std::size_t runs = 0;
  std::size_t solved = 0;
  for (const CostData::Run& run : data.runs) {
    if (run.problem != problem || run.strategy != strategy) continue;
    ++runs;
    if (run.solved) ++solved;
  }
  Interval share = wilson_interval(solved, runs);
  for (double* x : {&share.value, &share.lo, &share.hi}) *x *= 100.0;
  return share;
}

/// Adds a curve and its whiskers.
/// \param aside  where it stands beside its values, so that whiskers of several curves do not cover each other: a share
/// of their range
void add_curve(const ParameterCurve& curve, std::size_t problem, const std::string& name, const draw::Colour& colour,
               draw::Marker marker, double aside, SweepPanel& to) {
  draw::Series points{.kind = draw::Series::Kind::points, .name = name, .colour = colour, .marker = marker};
  const double least = curve.values.front();
  const double most = curve.values.back();
  const bool log = to.panel.x.scale == draw::AxisScale::log;
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    const Interval at = to.value(problem, curve.strategies[i]);
    const double x = curve.values[i];
    points.x.push_back(log ? x * std::pow(most / least, aside) : x + aside * (most - least));
    points.y.push_back(at.value);
    points.lo.push_back(at.lo);
    points.hi.push_back(at.hi);
  }
  draw::Series line{
      .kind = draw::Series::Kind::line, .x = points.x, .y = points.y, .colour = colour.faded(0.7), .width = 1.0};
  to.panel.series.push_back(std::move(line));
  to.panel.series.push_back(std::move(points));
}

/// The panels of a sweep, without curves.
std::vector<SweepPanel> sweep_panels(const CostData& data, const std::string& baseline, const FigureStyle& style) {
  std::vector<SweepPanel> panels;
  std::vector<CostComparison> comparisons;
  if (!baseline.empty()) comparisons = compare_costs(data, CostReference::baseline, baseline);
  const std::size_t reference = index_of(data, baseline);
  for (const Quantity& quantity : quantities) {
    if (!(style.*quantity.chosen)) continue;
    SweepPanel one;
    one.panel.y.scale = draw::AxisScale::log;
    if (baseline.empty()) {
      one.panel.y.label = quantity.label;
      one.value = [&data, quantity](std::size_t p, std::size_t s) {
        Interval median = median_of(data, p, s, quantity.kind);
        for (double* x : {&median.value, &median.lo, &median.hi}) *x /= quantity.unit;
        return median;
      };
    } else {
      const bool checks = quantity.kind == CostKind::checks;
      one.panel.y.label = fmt::format("{} {}", checks ? "checks / those of" : "CPU time / that of", baseline);
      one.panel.references = {{1.0, "as " + baseline}};
      one.value = [comparisons, checks, reference](std::size_t p, std::size_t s) {
        if (s == reference) return Interval{.value = 1.0};
        for (const CostComparison& c : comparisons) {
          if (c.problem != p || c.strategy != s) continue;
          const CostRatio& ratio = checks ? c.checks : c.seconds;
          Interval at = ratio.ratio;
          if (ratio.pairs < pairs_of_interval) at.lo = at.hi = nan;
          return at;
        }
        return Interval{.value = nan};
      };
    }
    panels.push_back(std::move(one));
  }
  SweepPanel success;
  success.panel.y = {.label = "runs with a path (%)", .lo = -3.0, .hi = 103.0};
  if (!baseline.empty() && data.problems.size() == 1) {
    success.panel.references = {{success_of(data, 0, reference).value, baseline}};
  }
  success.value = [&data](std::size_t p, std::size_t s) { return success_of(data, p, s); };
  panels.push_back(std::move(success));
  return panels;
}

}  // namespace

std::vector<draw::Figure> sweep_figures(const CostData& data, const std::string& baseline, const FigureStyle& style) {
  std::vector<draw::Figure> figures;
  for (const ParameterSweep& sweep : parameter_sweeps(data)) {
    const ParameterCurve& first = sweep.curves.front();
    const double least = first.values.front();
    draw::Figure figure;
    std::vector<SweepPanel> panels = sweep_panels(data, baseline, style);
    Runs runs;
    const bool one = data.problems.size() == 1;
    constexpr double decade = 10.0;
    constexpr double apart = 0.015;
    for (SweepPanel& panel : panels) {
      panel.panel.x.label = sweep.option;
      if (least > 0.0 && first.values.back() >= decade * least) panel.panel.x.scale = draw::AxisScale::log;
    }
    std::size_t place = 0;
    const std::size_t count = sweep.curves.size() * data.problems.size();
    for (const ParameterCurve& curve : sweep.curves) {
      for (std::size_t p = 0; p < data.problems.size(); ++p) {
        for (const std::size_t s : curve.strategies) {
          runs.add(static_cast<std::size_t>(std::count_if(data.runs.begin(), data.runs.end(), [&](const auto& run) {
            return run.problem == p && run.strategy == s;
          })));
        }
        const std::string name = one                       ? curve.name
                                 : sweep.curves.size() > 1 ? data.problems[p].name + ": " + curve.name
                                                           : data.problems[p].name;
        const auto marker = static_cast<draw::Marker>(place / draw::palette::series.size() % 4);
        const double aside = apart * (static_cast<double>(place) - 0.5 * static_cast<double>(count - 1));
        for (SweepPanel& panel : panels) add_curve(curve, p, name, draw::palette::nth(place), marker, aside, panel);
        ++place;
      }
    }
    for (SweepPanel& panel : panels) figure.panels.push_back(std::move(panel.panel));
    figure.title = fmt::format("{}{} over {}", one ? data.problems.front().name + ": " : "",
                               baseline.empty() ? "costs" : "costs beside " + baseline, sweep.option);
    figure.caption = fmt::format(
        "Strategies that differ in this number alone{}; {}. Costs: medians{}, a run without a path infinite; whiskers: "
        "95 % interval by order statistics. Runs with a path: whiskers: 95 % Wilson interval. An arrow: without a "
        "bound, or beyond the axis.",
        one || sweep.curves.size() > 1 ? "" : ": " + first.name, runs.text(),
        baseline.empty() ? "" : " of the ratios on the same seed");
    if (!one) figure.title.front() = 'C';
    figure.columns = figure.panels.size();
    constexpr double column = 210.0;
    figure.width = column * static_cast<double>(figure.columns);
    figure.panel_height = 150.0;
    figure.legend = draw::Legend::above;
    figures.push_back(std::move(figure));
  }
  return figures;
}

std::optional<draw::Figure> correlation_figure(const CostData& data, const std::string& baseline) {
  const auto found = cost_correlation(data, baseline);
  if (!found) return std::nullopt;
  constexpr std::array labels = {"nats above uniform by hitting", "nats above uniform by mass",
                                 "nats above uniform by spread", "nats above uniform"};
  constexpr std::size_t markers = 5;  // of draw::Marker
  constexpr std::size_t colours = draw::palette::series.size();
  const bool named = found->problems <= markers * colours;
  draw::Figure figure{.title = fmt::format("Which nats predict the checks? Costs beside {}, paired by seed", baseline),
                      .columns = predictors.size(),
                      .share_y = true,
                      .width = 600.0,
                      .panel_height = 190.0,
                      .legend = draw::Legend::above};
  for (std::size_t i = 0; i < predictors.size(); ++i) {
    draw::Panel panel{.title = fmt::format("{}\nρ = {}", predictors[i], correlation_text(found->rho[i])),
                      .x = {.label = labels[i]},
                      .y = {.label = "checks / those of " + baseline, .scale = draw::AxisScale::log},
                      .references = {{1.0, "as " + baseline}}};
    for (const CostCorrelation::Dot& dot : found->dots) {
      const std::string& name = data.problems[dot.problem].name;
      if (panel.series.empty() || (named && panel.series.back().name != name)) {
        const std::size_t place = panel.series.size();
        panel.series.push_back({.kind = draw::Series::Kind::points,
                                .name = named ? name : "a strategy on a problem",
                                .colour = draw::palette::nth(place),
                                .marker = static_cast<draw::Marker>(place / colours % markers)});
      }
      panel.series.back().x.push_back(dot.nats[i]);
      panel.series.back().y.push_back(dot.ratio);
    }
    figure.panels.push_back(std::move(panel));
  }
  figure.caption = "Nodes of the root. " + correlation_explanation(*found, baseline) +
                   " An arrow: most runs found no path, or most of the reference's found none.";
  return figure;
}

namespace {

/// For each problem: FOLDER/PROBLEM/success and length.
void write_curves(const CostData& data, const std::string& baseline, const std::string& folder,
                  const FigureStyle& style) {
  Directories problems;
  for (std::size_t p = 0; p < data.problems.size(); ++p) {
    const std::filesystem::path place = std::filesystem::path(folder) / problems(data.problems[p].name);
    const auto success = success_figure(data, baseline, p, style);
    const auto length = length_figure(data, baseline, p, style);
    if (success || length) make_directory(place.string());
    if (success) write_figure(*success, style, (place / "success").string());
    if (length) write_figure(*length, style, (place / "length").string());
  }
}

}  // namespace

namespace {

void write_sweeps(const CostData& data, const std::string& baseline, const std::filesystem::path& folder,
                  const FigureStyle& style) {
  const auto figures = sweep_figures(data, baseline, style);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    make_directory(folder.string());
    write_figure(figures[i], style, (folder / sweep_name(i)).string());
  }
}

}  // namespace

std::string sweep_name(std::size_t i) { return i == 0 ? "sweep" : fmt::format("sweep-{}", i + 1); }

void write_comparison_figures(const CostData& data, const std::string& folder, const FigureStyle& style) {
  write_curves(data, data.baseline, folder, style);
  const std::filesystem::path root(folder);
  Directories problems;
  for (std::size_t p = 0; p < data.problems.size(); ++p) {
    const std::filesystem::path place = root / problems(data.problems[p].name);
    const CostData here = data.on(p);
    write_sweeps(here, data.baseline, place, style);
    const auto ratios = ratio_figure(here, data.baseline, style);
    if (!ratios) continue;
    make_directory(place.string());
    write_figure(*ratios, style, (place / "ratios").string());
  }
  if (data.problems.size() < 2) return;
  write_sweeps(data, data.baseline, root, style);
  if (const auto correlation = correlation_figure(data, data.baseline)) {
    write_figure(*correlation, style, (root / "correlation").string());
  }
  if (const auto ratios = ratio_figure(data, data.baseline, style))
    write_figure(*ratios, style, (root / "ratios").string());
}

void write_cost_figures(const CostData& data, const std::string& baseline, const std::string& folder,
                        const FigureStyle& style) {
  make_directory(folder);
  const auto stem = [&](const char* name) { return (std::filesystem::path(folder) / name).string(); };
  constexpr double bounded_loss = 2.2;
  constexpr double of_parts = 1.3;
  write(data, compare_costs(data, CostReference::baseline, baseline),
        {.title = fmt::format("Does guidance pay? Costs beside {} without guides", baseline),
         .lines = {{1.0, "as without guides", draw::Dash::solid}, {bounded_loss, "2.2 times", draw::Dash::dashed}}},
        style, stem("baseline"));
  write(data, compare_costs(data, CostReference::own_planner, baseline),
        {.title = "What can a guide lose? Costs beside the same planner without guides",
         .lines = {{1.0, "as without guides", draw::Dash::solid}, {bounded_loss, "2.2 times", draw::Dash::dashed}}},
        style, stem("own_planner"));
  write(data, compare_costs(data, CostReference::best_part, baseline),
        {.title = "Does nesting pay? Costs of a >> b beside the better one of a and b",
         .lines = {{1.0, "as the better part", draw::Dash::solid}, {of_parts, "1.3 times", draw::Dash::dashed}}},
        style, stem("parts"));
  if (const auto correlation = correlation_figure(data, baseline)) {
    write_figure(*correlation, style, stem("correlation"));
  }
  write_curves(data, baseline, folder, style);
}

}  // namespace trellis
