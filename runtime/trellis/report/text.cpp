// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/table.hpp>

namespace trellis {

namespace {

/// Above so many problems one table each would bury the reader: they are taken together.
constexpr std::size_t most_single_problems = 6;

// Numbers ---------------------------------------------------------------------------------------------------------

/// A fixed number of decimals, without "-0.00".
std::string fixed(double x, int decimals, bool sign = false) {
  std::string text = sign ? fmt::format("{:+.{}f}", x, decimals) : fmt::format("{:.{}f}", x, decimals);
  if (!text.empty() && text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) {
    text.erase(0, 1);
    if (sign) text.insert(0, "+");
  }
  return text;
}

/// A median of counts: halves happen, and matter only where the count is small.
std::string count_text(double x) {
  if (!std::isfinite(x)) return "-";
  return fixed(x, x < 100 && x != std::floor(x) ? 1 : 0);
}

/// Decimals of a column of milliseconds, by its largest: small ones should not vanish beside it.
int decimals_for(double largest) {
  if (!std::isfinite(largest) || largest >= 1000) return 0;
  return largest >= 100 ? 1 : (largest >= 1 ? 2 : 3);
}

std::string percent(double share) { return std::isfinite(share) ? fixed(100.0 * share, 0) : "-"; }

/// "1.23 ±0.08", "1.23" where there is no interval, "-" where there is no figure.
std::string interval_text(const Interval& interval, int decimals = 2, bool sign = false) {
  if (std::isnan(interval.value)) return "-";
  if (std::isinf(interval.value)) return interval.value > 0 ? "inf" : "-inf";
  std::string text = fixed(interval.value, decimals, sign);
  if (std::isfinite(interval.hi)) text += " ±" + fixed(0.5 * (interval.hi - interval.lo), decimals);
  return text;
}

std::string plural(std::size_t n, const std::string& noun) {
  return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s");
}

std::string plural_y(std::size_t n, const std::string& stem) {
  return fmt::format("{} {}{}", n, stem, n == 1 ? "y" : "ies");
}

// Figures and what is to be said about them -------------------------------------------------------------------------

struct Note {
  char mark;
  const char* flag;
  const char* meaning;
};
constexpr std::array<Note, 5> notes = {{
    {'c', "censored", "censored: no sample in the target, the figure is a floor"},
    {'p', "partial", "partial: covers less of the target than as many uniform samples would"},
    {'u', "underpowered", "underpowered: as many uniform samples would put fewer than 10 in the target"},
    {'f', "too few samples", "too few samples"},
    {'i', "cannot reach", "infinite undefended: part of the target is invalid, and these samples never are"},
}};
constexpr char median_mark = 'm';
constexpr char other_mark = 'x';

char mark_of(const std::string& flag) {
  const auto* const it = std::find_if(notes.begin(), notes.end(), [&](const Note& n) { return n.flag == flag; });
  return it != notes.end() ? it->mark : other_mark;
}

/// Where a figure stands: a row and a column of the table.
struct Place {
  std::string row;
  std::string column;
};

/// Collects what the marks in a table stand for, in the order of the legend.
class Notes {
 public:
  void add(const std::string& flag, const Place& place, std::size_t runs, std::size_t of) {
    auto it = std::find_if(found_.begin(), found_.end(), [&](const Found& f) { return f.flag == flag; });
    if (it == found_.end()) it = found_.insert(found_.end(), {flag, {}});
    it->where.add(place, runs, of);
  }
  void add_infinite(const Place& place, std::size_t runs, std::size_t of) { infinite_.add(place, runs, of); }

  [[nodiscard]] std::string text(std::size_t width) const {
    std::string out;
    const auto line = [&](char mark, const std::string& meaning, const Places& where) {
      out += wrap(fmt::format("{}  {}; runs: {}", mark, meaning, where.text), width, "", "   ");
    };
    if (!infinite_.text.empty()) line(median_mark, "infinite in some runs, so the median of all", infinite_);
    for (const auto& note : notes) {
      for (const auto& [flag, where] : found_) {
        if (flag == note.flag) line(note.mark, note.meaning, where);
      }
    }
    for (const auto& [flag, where] : found_) {
      if (mark_of(flag) == other_mark) line(other_mark, flag, where);
    }
    return out;
  }

 private:
  /// "0 own tree 3/15, root tree 3/15; 2 own tree 1/15": each row is named once.
  struct Places {
    std::string text;
    std::string row;

    void add(const Place& place, std::size_t runs, std::size_t of) {
      const bool same = !text.empty() && row == place.row;
      if (!text.empty()) text += same ? ", " : "; ";
      text += fmt::format("{}{} {}/{}", same ? "" : place.row + ' ', place.column, runs, of);
      row = place.row;
    }
  };
  struct Found {
    std::string flag;
    Places where;
  };

  std::vector<Found> found_;
  Places infinite_;
};

/// A column of figures: means, half-widths and marks below each other.
class FigureColumn {
 public:
  void add(const Figure& figure, const Place& where, Notes& told) {
    Cell cell;
    const Interval& value = figure.value;
    if (std::isnan(value.value)) {
      cell.mean = "-";
    } else {
      cell.mean = std::isinf(value.value) ? "inf" : fixed(value.value, 2);
      if (std::isfinite(value.hi)) cell.half = "±" + fixed(0.5 * (value.hi - value.lo), 2);
      if (value.infinite > 0) {
        cell.marks += median_mark;
        told.add_infinite(where, value.infinite, value.n + value.infinite);
      }
    }
    for (const auto& [flag, runs] : figure.flags) {
      const char mark = mark_of(flag);
      if (cell.marks.find(mark) == std::string::npos) cell.marks += mark;
      told.add(flag, where, runs, figure.scored);
    }
    cells_.push_back(std::move(cell));
  }

  /// Decimal points below each other; marks stand right behind their figure.
  [[nodiscard]] std::vector<std::string> text() const {
    std::size_t mean = 0;
    for (const auto& cell : cells_) mean = std::max(mean, display_width(cell.mean));
    std::vector<std::string> out;
    std::size_t widest = 0;
    for (const auto& cell : cells_) {
      out.push_back(pad(cell.mean, mean, true) + (cell.half.empty() ? "" : " " + cell.half) + cell.marks);
      widest = std::max(widest, display_width(out.back()));
    }
    for (auto& text : out) text = pad(text, widest, false);
    return out;
  }

 private:
  struct Cell {
    std::string mean;
    std::string half;
    std::string marks;
  };
  std::vector<Cell> cells_;
};

// A strategy's heading ---------------------------------------------------------------------------------------------

struct UniformShare {
  std::string level;
  double share;
};

void collect_shares(const GuideSpec* guide, const PlannerSpec& planner, const std::string& name,
                    std::vector<UniformShare>& out);

/// The levels that search the spaces of a guide's parts.
void collect_parts(const GuideSpec& guide, std::vector<UniformShare>& out) {
  if (guide.kind() != GuideSpec::Kind::component) {
    for (const auto& term : guide.terms()) collect_parts(term.guide, out);
  } else if (guide.planner()) {
    collect_shares(guide.below(), *guide.planner(), guide.name(), out);
  }
}

void collect_shares(const GuideSpec* guide, const PlannerSpec& planner, const std::string& name,
                    std::vector<UniformShare>& out) {
  if (guide == nullptr) return;  // an unguided search draws from nothing but itself
  for (const auto& [option, value] : planner.options().entries()) {
    const auto* share = std::get_if<double>(&value);
    if (option == "uniform" && share != nullptr) out.push_back({name, *share});
  }
  collect_parts(*guide, out);
}

std::string shares_text(const StrategySpec& spec) {
  std::vector<UniformShare> shares;
  collect_shares(spec.guide(), spec.planner(), "root", shares);
  if (shares.empty()) return "no guide";
  const bool same =
      std::all_of(shares.begin(), shares.end(), [&](const UniformShare& s) { return s.share == shares.front().share; });
  if (same) {
    return fmt::format("uniform share of proposals {:g}{}", shares.front().share,
                       shares.size() > 1 ? " at each guided level" : "");
  }
  std::string text = "uniform share of proposals: ";
  for (std::size_t i = 0; i < shares.size(); ++i) {
    text += fmt::format("{}{} {:g}", i == 0 ? "" : ", ", shares[i].level, shares[i].share);
  }
  return text;
}

std::string wilson_text(const Interval& success) {
  return std::isfinite(success.lo) ? fmt::format("{}–{}", percent(success.lo), percent(success.hi)) : "-";
}

// The table of one strategy ------------------------------------------------------------------------------------------

/// "0 root", "1 └ lazy()", "2   └ shrink(0.5)".
std::vector<std::string> level_labels(const std::vector<LevelSummary>& levels) {
  const std::size_t digits = fmt::format("{}", levels.size()).size();
  const auto last_child = [&](std::size_t i) {
    return std::none_of(levels.begin() + static_cast<std::ptrdiff_t>(i) + 1, levels.end(),
                        [&](const LevelSummary& other) { return other.parent == levels[i].parent; });
  };
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    std::string branches;
    for (int at = static_cast<int>(i); at >= 0 && levels[static_cast<std::size_t>(at)].parent >= 0;
         at = levels[static_cast<std::size_t>(at)].parent) {
      const bool last = last_child(static_cast<std::size_t>(at));
      const bool self = at == static_cast<int>(i);
      branches.insert(0, self ? (last ? "└ " : "├ ") : (last ? "  " : "│ "));
    }
    labels.push_back(fmt::format("{:>{}} {}{}", i, digits, branches, levels[i].name));
  }
  return labels;
}

Table::Column number_column(std::vector<std::string> heading, std::string group = "") {
  return {std::move(heading), std::move(group), false};
}
Table::Column text_column(std::string heading) { return {{std::move(heading)}, "", true}; }

bool any_figure(const std::vector<LevelSummary>& levels) {
  return std::any_of(levels.begin(), levels.end(), [](const LevelSummary& l) {
    return std::isfinite(l.own.tree.uniform.value) || std::isfinite(l.root.tree.uniform.value);
  });
}

/// "label  0 root +1.31 ±0.04 · 1 lazy() +1.11 ±0.04": one figure of every level that has it, in one line; "" if none
/// has.
template <class F>
std::string by_level(const std::string& label, const std::vector<LevelSummary>& levels, std::size_t width, F text) {
  std::string line;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::string value = text(levels[i]);
    if (value.empty()) continue;
    line += line.empty() ? "" : " · ";
    std::string item = levels.size() > 1 ? fmt::format("{} {} {}", i, levels[i].name, value) : value;
    std::replace(item.begin(), item.end(), ' ', no_break);
    line += item;
  }
  return line.empty() ? ""
                      : wrap(line, width, label, std::string(std::min<std::size_t>(display_width(label), 13), ' '));
}

/// What stands below the table: the zero of the scale, what was won over it, and what of the target was reached.
std::string below_table(const std::vector<LevelSummary>& levels, std::size_t width) {
  const auto gain = [](const Figure& f) {
    return std::isnan(f.gain.value) ? std::string() : interval_text(f.gain, 2, true);
  };
  const Interval& uniform = levels.front().root.tree.uniform;
  std::string out;
  if (!std::isfinite(uniform.value)) {
    out += "root space: no path, so no target to score against\n";
  } else if (levels.size() == 1) {
    const std::string tree = gain(levels.front().root.tree);
    const std::string expansion = gain(levels.front().root.expansion);
    out += wrap(fmt::format("uniform {} nats; gain over it: tree {}, expansion {}", interval_text(uniform),
                            tree.empty() ? "-" : tree, expansion.empty() ? "-" : expansion),
                width, "", "  ");
  } else {
    out += wrap(fmt::format("root space: uniform {} nats; gain over it:", interval_text(uniform)), width, "", "  ");
    out += by_level("  tree       ", levels, width, [&](const LevelSummary& l) { return gain(l.root.tree); });
    out += by_level("  expansion  ", levels, width, [&](const LevelSummary& l) { return gain(l.root.expansion); });
  }
  out += by_level("own target covered by the tree (by as many uniform samples), %:  ", levels, width,
                  [](const LevelSummary& l) {
                    const Figure& f = l.own.tree;
                    if (std::isnan(f.coverage.value)) return std::string();
                    return fmt::format("{} ({})", percent(f.coverage.value), percent(f.uniform_coverage.value));
                  });
  return out;
}

std::string strategy_table(const RunsSummary& summary, bool measured, std::size_t width) {
  const std::vector<LevelSummary>& levels = summary.levels;
  if (levels.empty()) return "no level was reached\n";
  const bool figures = measured && any_figure(levels);

  std::vector<Table::Column> columns = {text_column("level"),
                                        text_column("space"),
                                        text_column("planner"),
                                        number_column({"level", "solved"}),
                                        number_column({"re-", "solves"}),
                                        number_column({"proposals"}),
                                        number_column({"nodes"}),
                                        number_column({"validity", "checks"}),
                                        number_column({"motion", "checks"}),
                                        number_column({"time", "ms"})};
  if (figures) {
    const std::string own = "own space: efficiency, nats";
    const std::string root = "root space: eff., nats";
    columns.push_back(number_column({"uniform"}, own));
    columns.push_back(number_column({"tree"}, own));
    columns.push_back(number_column({"expansion"}, own));
    columns.push_back(number_column({"tree"}, root));
    columns.push_back(number_column({"expansion"}, root));
  }

  Notes told;
  FigureColumn own_tree;
  FigureColumn own_expansion;
  FigureColumn root_tree;
  FigureColumn root_expansion;
  double slowest = 1000.0 * summary.seconds;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::string row = fmt::format("level {}", i);
    own_tree.add(levels[i].own.tree, {row, "own tree"}, told);
    own_expansion.add(levels[i].own.expansion, {row, "own expansion"}, told);
    // The root's own target is the root's target: said once.
    Notes heard_already;
    Notes& notes_of = i == 0 ? heard_already : told;
    root_tree.add(levels[i].root.tree, {row, "root tree"}, notes_of);
    root_expansion.add(levels[i].root.expansion, {row, "root expansion"}, notes_of);
    slowest = std::max(slowest, 1000.0 * levels[i].seconds);
  }
  const auto own_tree_text = own_tree.text();
  const auto own_expansion_text = own_expansion.text();
  const auto root_tree_text = root_tree.text();
  const auto root_expansion_text = root_expansion.text();

  Table table(columns);
  const int decimals = decimals_for(slowest);
  const auto labels = level_labels(levels);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelSummary& level = levels[i];
    std::vector<std::string> cells = {
        labels[i],
        level.space.empty() ? "several" : fmt::format("{} {}", level.space, level.dimension),
        level.planner,
        fmt::format("{}/{}", level.solved, level.runs),
        count_text(level.resolves),
        count_text(level.proposals),
        count_text(level.nodes),
        count_text(level.validity_checks),
        count_text(level.motion_checks),
        fixed(1000.0 * level.seconds, decimals)};
    if (figures) {
      const double uniform = level.own.tree.uniform.value;
      cells.push_back(std::isfinite(uniform) ? fixed(uniform, 2) : "-");
      cells.push_back(own_tree_text[i]);
      cells.push_back(own_expansion_text[i]);
      cells.push_back(root_tree_text[i]);
      cells.push_back(root_expansion_text[i]);
    }
    table.add(std::move(cells));
  }
  if (levels.size() > 1) {
    std::vector<std::string> cells(columns.size());
    cells[0] = "all levels";
    cells[7] = count_text(summary.validity_checks);
    cells[8] = count_text(summary.motion_checks);
    cells[9] = fixed(1000.0 * summary.seconds, decimals);
    table.rule();
    table.add(std::move(cells));
  }

  std::string out = table.text(width);
  if (figures) out += below_table(levels, width) + told.text(width);
  return out;
}

// The summary --------------------------------------------------------------------------------------------------------

struct Row {
  std::string strategy;
  RunsSummary summary;
};

std::string summary_table(const std::vector<Row>& rows, bool measured, std::size_t width) {
  std::vector<Table::Column> columns = {text_column("strategy"),
                                        number_column({"solved"}, "success"),
                                        number_column({"95 %", "interval"}, "success"),
                                        number_column({"validity", "checks"}, "medians, all levels"),
                                        number_column({"motion", "checks"}, "medians, all levels"),
                                        number_column({"time", "ms"}, "medians, all levels"),
                                        number_column({"path length", "m"})};
  if (measured) {
    const std::string se = "efficiency of the root, nats";
    const std::string gain = "gain of the root, nats";
    columns.push_back(number_column({"uniform"}, se));
    columns.push_back(number_column({"tree"}, se));
    columns.push_back(number_column({"expansion"}, se));
    columns.push_back(number_column({"tree"}, gain));
    columns.push_back(number_column({"expansion"}, gain));
  }
  Notes told;
  FigureColumn tree;
  FigureColumn expansion;
  double slowest = 0.0;
  static const LevelSummary none;
  const auto root = [](const Row& row) -> const LevelSummary& {
    return row.summary.levels.empty() ? none : row.summary.levels.front();
  };
  for (const auto& row : rows) {
    const FigurePair& pair = root(row).root;
    tree.add(pair.tree, {row.strategy, "tree"}, told);
    expansion.add(pair.expansion, {row.strategy, "expansion"}, told);
    slowest = std::max(slowest, 1000.0 * row.summary.seconds);
  }
  const auto tree_text = tree.text();
  const auto expansion_text = expansion.text();
  Table table(columns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RunsSummary& s = rows[i].summary;
    std::vector<std::string> cells = {rows[i].strategy,
                                      fmt::format("{}/{}", s.solved, s.runs),
                                      wilson_text(s.success) + " %",
                                      count_text(s.validity_checks),
                                      count_text(s.motion_checks),
                                      std::isfinite(s.seconds) ? fixed(1000.0 * s.seconds, decimals_for(slowest)) : "-",
                                      interval_text(s.length)};
    if (measured) {
      const FigurePair& pair = root(rows[i]).root;
      cells.push_back(interval_text(pair.tree.uniform));
      cells.push_back(tree_text[i]);
      cells.push_back(expansion_text[i]);
      cells.push_back(interval_text(pair.tree.gain, 2, true));
      cells.push_back(interval_text(pair.expansion.gain, 2, true));
    }
    table.add(std::move(cells));
  }
  return table.text(width) + told.text(width);
}

// The whole ----------------------------------------------------------------------------------------------------------

std::string seeds_text(const std::vector<std::uint64_t>& seeds) {
  if (seeds.size() == 1) return fmt::format("1 seed ({})", seeds.front());
  bool consecutive = true;
  for (std::size_t i = 1; i < seeds.size(); ++i) consecutive = consecutive && seeds[i] == seeds[i - 1] + 1;
  return consecutive ? fmt::format("{} seeds ({}–{})", seeds.size(), seeds.front(), seeds.back())
                     : fmt::format("{} seeds", seeds.size());
}

std::string title(const std::string& text, std::size_t width) {
  std::string line = "━━ " + text + ' ';
  for (std::size_t shown = display_width(line); shown < width; ++shown) line += "━";
  return line + '\n';
}

std::string legend(const Experiment& experiment, const ExperimentResult& result, std::size_t width) {
  std::string out = fmt::format("{} × {} × {}. ", plural(experiment.problems.size(), "problem"),
                                plural_y(experiment.strategies.size(), "strateg"), seeds_text(experiment.seeds));
  out += experiment.seeds.size() * experiment.problems.size() > 1
             ? "Counts and times: medians over the runs; ±: half-width of the 95 % Student interval of the mean over "
               "the runs."
             : "One run of each strategy: no intervals.";
  out = wrap(out, width);
  if (!experiment.measure) return out;
  const TubeSettings& m = *experiment.measure;
  std::vector<std::string> estimators;
  const auto see = [&](const std::optional<Scores>& scores) {
    if (!scores) return;
    for (const Efficiency* e : {&scores->tree, &scores->expansion}) {
      if (std::isnan(e->value)) continue;
      if (std::find(estimators.begin(), estimators.end(), e->estimator) == estimators.end()) {
        estimators.push_back(e->estimator);
      }
    }
  };
  for (const auto& run : result.runs) {
    for (const auto& level : run.levels) {
      see(level.own);
      see(level.root);
    }
  }
  std::string names;
  for (const auto& name : estimators) names += (names.empty() ? "" : ", ") + name;
  out += wrap(
      fmt::format("Efficiency: divergence of the target from the samples ({:g} % uniform mixed in), nats, lower is "
                  "better; uniform: of uniform sampling; gain: uniform - efficiency.",
                  100.0 * m.epsilon),
      width);
  out += wrap(fmt::format("Target: {} within {:g} m ({}) of the run's own path{}.",
                          m.support == "free" ? "valid configurations" : "configurations, valid or not,", m.delta,
                          m.distance == "planar" ? "position only" : "full metric",
                          names.empty() ? "" : "; estimator: " + names),
              width);
  return out;
}

}  // namespace

std::string report_text(const Experiment& experiment, const ExperimentResult& result, int width) {
  const auto columns = static_cast<std::size_t>(std::max(width, 20));
  const bool measured = experiment.measure.has_value();
  std::string out = legend(experiment, result, columns);

  const auto section = [&](const std::string& problem, const std::string& heading) {
    std::vector<Row> rows;
    out += '\n' + title(heading, columns);
    for (const auto& [name, spec] : experiment.strategies) {
      rows.push_back({name, summarise(select_runs(result, problem, name))});
      const RunsSummary& summary = rows.back().summary;
      const std::string text = spec.text();
      out += '\n' + wrap(name == text ? name : fmt::format("{} = {}", name, text), columns, "", "    ");
      out += wrap(fmt::format("solved {}/{} runs ({} %, 95 % Wilson) · {}", summary.solved, summary.runs,
                              wilson_text(summary.success), shares_text(spec)),
                  columns, "", "    ");
      out += strategy_table(summary, measured, columns);
    }
    out += "\nsummary of " + (problem.empty() ? "all problems" : problem) + '\n';
    out += summary_table(rows, measured, columns);
  };

  if (experiment.problems.size() > most_single_problems) {
    section("",
            fmt::format("{} problems taken together ({} … {}), {} in all for each strategy", experiment.problems.size(),
                        experiment.problems.front().name, experiment.problems.back().name,
                        plural(experiment.problems.size() * experiment.seeds.size(), "run")));
  } else {
    for (const auto& problem : experiment.problems) {
      section(problem.name, fmt::format("{}, {}", problem.name, seeds_text(experiment.seeds)));
    }
  }
  return out;
}

}  // namespace trellis
