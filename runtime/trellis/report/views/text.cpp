// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <trellis/base/error.hpp>
#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/views/overview.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/report/views/tables.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

// Figures and what is to be said about them -------------------------------------------------------------------------

/// The position of a value: a row and a column of the table.
struct Place {
  std::string row;
  std::string column;
};

/// Collects the meanings of the marks in a table, in the order of the legend.
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
  /// "0 own tree 3/15, root tree 3/15; 2 own tree 1/15": names each row once.
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

/// A column of nats above uniform: intervals and marks, aligned. Blank where the samples do not support one that shows
/// anything.
class FigureColumn {
 public:
  /// An interval without marks.
  void add(const AboveUniform& above, std::size_t runs) {
    Cell cell;
    if (runs == 0 || std::isnan(above.lo)) {
      cell.mean = "-";
    } else if (above.blank.empty()) {
      cell.mean = ends_text(above.lo, above.hi);
    }
    cells_.push_back(std::move(cell));
  }
  void add(const Figure& figure, const Place& where, Notes& notes) {
    Cell cell;
    const AboveUniform above = above_uniform(figure);
    if (figure.scored == 0 || std::isnan(above.lo)) {
      cell.mean = "-";
    } else if (above.blank.empty()) {
      cell.mean = ends_text(above.lo, above.hi);
    }
    for (const auto& [flag, runs] : figure.flags) {
      const char mark = mark_of(flag);
      if (cell.marks.find(mark) == std::string::npos) cell.marks += mark;
      notes.add(flag, where, runs, figure.scored);
    }
    cells_.push_back(std::move(cell));
  }

  /// Aligns decimal points; marks follow their value directly.
  [[nodiscard]] std::vector<std::string> text() const {
    std::size_t mean = 0;
    for (const auto& cell : cells_) mean = std::max(mean, display_width(cell.mean));
    std::vector<std::string> out;
    std::size_t widest = 0;
    for (const auto& cell : cells_) {
      out.push_back(pad(cell.mean, mean, true) + cell.marks);
      widest = std::max(widest, display_width(out.back()));
    }
    for (auto& text : out) text = pad(text, widest, false);
    return out;
  }

 private:
  struct Cell {
    std::string mean;
    std::string marks;
  };
  std::vector<Cell> cells_;
};

// The table of one strategy ------------------------------------------------------------------------------------------

Table::Column number_column(std::vector<std::string> heading, std::string group = "") {
  return {std::move(heading), std::move(group), false};
}
Table::Column text_column(std::string heading) { return {{std::move(heading)}, "", true}; }

bool any_figure(const std::vector<LevelSummary>& levels) {
  const auto has = [](const FigurePair& pair) {
    return std::isfinite(pair.tree["D_uniform"].value) || std::isfinite(pair.expansion["D_uniform"].value);
  };
  return std::any_of(levels.begin(), levels.end(), [&](const LevelSummary& l) {
    return has(l.own) || has(l.root) || has(l.own_cross) || has(l.root_cross);
  });
}

/// "uniform 0 → skeleton() +0.54 ±0.04 → root +0.38 ±0.03": the nats above uniform that each level adds.
std::string waterfall_text(const std::string& label, const Waterfall& waterfall,
                           const std::vector<LevelSummary>& levels, std::size_t width) {
  if (waterfall.steps.empty() || !std::isfinite(waterfall.uniform.value)) return "";
  const auto name = [&](int level) { return levels[static_cast<std::size_t>(level)].name; };
  const bool chain = std::all_of(waterfall.steps.begin(), waterfall.steps.end(), [&](const WaterfallStep& step) {
    const auto same = [&](const WaterfallStep& other) { return other.level == step.level || other.from == step.from; };
    return std::count_if(waterfall.steps.begin(), waterfall.steps.end(), same) == 1;
  });
  std::string line = "uniform 0";
  for (const WaterfallStep& step : waterfall.steps) {
    std::string item = name(step.level);
    if (!chain) item += " from " + (step.from < 0 ? std::string("uniform") : name(step.from));
    item += ' ' + (std::isnan(step.added.value) ? "blank" : interval_text(step.added, 2, true));
    std::replace(item.begin(), item.end(), ' ', no_break);
    line += fmt::format(" {} {}", chain ? "→" : "·", item);
  }
  return wrap(line, width, label, std::string(display_width(label), ' '));
}

}  // namespace

std::string search_table(const RunsSummary& summary, std::size_t width) {
  const std::vector<LevelSummary>& levels = summary.levels;
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
  const bool guided = std::any_of(levels.begin(), levels.end(), [](const LevelSummary& l) { return l.guided; });
  if (guided) {
    const std::string by = "validity checks by";
    columns.insert(columns.end(),
                   {number_column({"guided", "proposals"}, by), number_column({"unguided", "proposals"}, by),
                    number_column({"levels", "below"}, by)});
  }
  double slowest = 1000.0 * summary.spent_seconds;
  for (const auto& level : levels) slowest = std::max(slowest, 1000.0 * level.seconds);
  const int decimals = decimals_for(slowest);
  const auto labels = level_labels(levels);
  Table table(columns);
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
    if (guided) {
      for (const SpentSummary* spent : {&level.by_guided, &level.by_unguided, &level.by_below}) {
        cells.push_back(count_text(spent->validity_checks));
      }
    }
    table.add(std::move(cells));
  }
  if (levels.size() > 1) {
    std::vector<std::string> cells(columns.size());
    cells[0] = "all levels";
    cells[7] = count_text(summary.spent_validity_checks);
    cells[8] = count_text(summary.spent_motion_checks);
    cells[9] = fixed(1000.0 * summary.spent_seconds, decimals);
    table.rule();
    table.add(std::move(cells));
  }
  std::string out = table.text(width);
  if (levels.size() > 1 && summary.runs > 1) {
    out += wrap("medians over the runs: those of the levels do not sum to that of all levels", width, "  ", "  ");
  }
  if (const std::string beside = beside_text(summary); !beside.empty()) out += wrap(beside, width, "  ", "  ");
  return out;
}

namespace {

bool any_sample(const FigurePair& a, const FigurePair& b, Figure FigurePair::*role) {
  return (a.*role).scored > 0 || (b.*role).scored > 0;
}

/// Returns why runs with samples have no value.
std::string reasons_text(const std::vector<LevelSummary>& levels, std::size_t width) {
  std::string out;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (const bool tree : {true, false}) {
      const Figure& f = tree ? levels[i].own.tree : levels[i].own.expansion;
      for (const std::string& reason : f.reasons) {
        if (reason == "there are no samples") continue;
        out += wrap(fmt::format("level {} {}: no figure in some runs: {}", i, tree ? "tree" : "expansion", reason),
                    width, "", "  ");
      }
    }
  }
  return out;
}

/// Returns SE, as an interval; "" where the samples do not support one.
std::string se_text(const Figure& figure) {
  const AboveUniform above = above_uniform(figure);
  if (figure.scored == 0 || std::isnan(above.lo)) return "-";
  if (!above.blank.empty()) return "";
  const std::string lo = fixed(figure["D_uniform"].value - above.hi, 2);
  const std::string hi = fixed(figure["D_uniform"].value - above.lo, 2);
  return lo == hi ? lo : lo + "…" + hi;
}

/// Returns the measure of every level and role: in its own space on its own path, and lifted to the root.
/// \param pooled  whether there are the samples of all seeds together
std::vector<Table::Column> measure_columns(bool pooled) {
  const std::string own = "own space, own path";
  const std::string root = "root space: above uniform on";
  std::vector<Table::Column> columns = {text_column("level"),
                                        Table::Column{{"samples"}, "", true, true},
                                        number_column({"runs"}),
                                        number_column({"N"}),
                                        number_column({"in", "target"}),
                                        number_column({"uniform", "nats"}, own),
                                        number_column({"above", "uniform"}, own),
                                        number_column({"SE", "nats"}, own),
                                        number_column({"mass", "nats"}, own),
                                        number_column({"spread", "nats"}, own),
                                        number_column({"D", "nats"}, own),
                                        number_column({"D at", "least"}, own),
                                        number_column({"along", "nats"}, own),
                                        number_column({"empty", "%"}, own),
                                        number_column({"covered", "%"}, own),
                                        number_column({"own", "path"}, root),
                                        number_column({"other", "seeds'"}, root)};
  if (pooled) columns.push_back(number_column({"all seeds", "together"}, root));
  return columns;
}

/// The rows of the measure: each level's tree and expansion.
class MeasureRows {
 public:
  /// A level's role, where it has samples.
  void add(std::size_t i, const LevelSummary& level, const std::string& label, bool tree) {
    Figure FigurePair::*const role = tree ? &FigurePair::tree : &FigurePair::expansion;
    if (!any_sample(level.own, level.root, role) && !any_sample(level.own_cross, level.root_cross, role)) return;
    const char* name = tree ? "tree" : "expansion";
    const std::string row = fmt::format("level {} {}", i, name);
    own_.add(level.own.*role, {row, "own"}, notes_);
    // The root's own target is the root's target: print it once.
    Notes discarded;
    root_.add(level.root.*role, {row, "root"}, i == 0 ? discarded : notes_);
    cross_.add(level.root_cross.*role, {row, "other seeds'"}, notes_);
    const Headline first = headline(level, tree ? SampleRole::tree : SampleRole::expansion);
    any_pooled_ = any_pooled_ || first.seeds > 0;
    pooled_.add(first.seeds > 0 ? first.above : AboveUniform{}, first.seeds);
    lines_.push_back({label, name, &(level.own.*role)});
  }

  /// Perfect guidance or uniform sampling: the estimators' results for as many samples of it.
  void add_reference(const std::string& name, const FigurePair& pair) {
    static const Figure nothing;
    Notes unread;
    for (const auto& [role, figure] : {std::pair{"tree", &pair.tree}, std::pair{"expansion", &pair.expansion}}) {
      if (figure->scored == 0) continue;
      own_.add(*figure, {name, role}, unread);
      root_.add(*figure, {name, role}, unread);
      cross_.add(nothing, {name, role}, unread);
      pooled_.add(AboveUniform{}, 0);
      lines_.push_back({name, role, figure});
    }
  }

  [[nodiscard]] std::string text(std::size_t width) const { return table().text(width) + notes_.text(width); }

 private:
  [[nodiscard]] Table table() const {
    const auto own = own_.text();
    const auto root = root_.text();
    const auto cross = cross_.text();
    const auto pooled = pooled_.text();
    const auto nats = [](double x) { return std::isfinite(x) ? fixed(x, 2) : "-"; };
    Table table(measure_columns(any_pooled_));
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      const Figure& f = *lines_[k].own;
      const bool first = k == 0 || lines_[k - 1].label != lines_[k].label;
      // An estimate that the samples do not support is not printed.
      const bool blank = !above_uniform(f).blank.empty();
      const auto supported = [&](const std::string& text) { return blank ? "" : text; };
      std::vector<std::string> cells = {first ? lines_[k].label : "",
                                        lines_[k].role,
                                        std::to_string(f.scored),
                                        count_text(f.samples),
                                        count_text(f.in_target),
                                        nats(f["D_uniform"].value),
                                        own[k],
                                        se_text(f),
                                        interval_text(f["SE_parts.mass"]),
                                        supported(interval_text(f["SE_parts.spread"])),
                                        supported(std::isinf(f["D"].value) ? "inf" : nats(f["D"].value)),
                                        nats(f["D_mass_lower95"].value),
                                        nats(f["along.D"].value),
                                        percent(f["along.empty_share"].value),
                                        percent(f["coverage"].value),
                                        root[k],
                                        cross[k]};
      if (any_pooled_) cells.push_back(pooled[k]);
      table.add(std::move(cells));
    }
    return table;
  }

  struct Line {
    std::string label;
    const char* role;
    const Figure* own;
  };
  Notes notes_;
  FigureColumn own_;
  FigureColumn root_;
  FigureColumn cross_;
  FigureColumn pooled_;
  bool any_pooled_ = false;
  std::vector<Line> lines_;
};

std::string measure_table(const std::vector<LevelSummary>& levels, std::size_t width) {
  MeasureRows rows;
  const auto labels = level_labels(levels);
  if (!levels.empty()) rows.add_reference("oracle", levels.front().oracle);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (const bool tree : {true, false}) rows.add(i, levels[i], labels[i], tree);
  }
  if (!levels.empty()) rows.add_reference("uniform", levels.front().uniform);
  return rows.text(width) + reasons_text(levels, width);
}

/// Returns hitting and the bottleneck of every level and role, lifted to the root; "" where there is none.
std::string hitting_table(const std::vector<LevelSummary>& levels, std::size_t width) {
  const std::string nats = "hitting, nats above uniform";
  Table table({text_column("level"), Table::Column{{"samples"}, "", true, true}, number_column({"N"}),
               number_column({"by", "position"}, nats), number_column({"full", "metric"}, nats),
               text_column("bottleneck, by position")});
  const auto labels = level_labels(levels);
  bool any = false;
  bool any_own = false;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    bool named = false;
    for (const SampleRole role : {SampleRole::tree, SampleRole::expansion}) {
      bool own = false;
      const Hitting hitting = hitting_of(levels[i], role, &own);
      if (std::isnan(hitting.position.hitting)) continue;
      any = true;
      any_own = any_own || own;
      table.add({named ? "" : labels[i], role == SampleRole::tree ? "tree" : "expansion", count_text(hitting.samples),
                 hitting_text(hitting.position), hitting_text(hitting.full),
                 bottleneck_text(hitting.position, hitting.length)});
      named = true;
    }
  }
  if (!any) return "";
  return table.text(width) +
         (any_own
              ? wrap("on each run's own path, which its samples fit; other seeds give other paths", width, "  ", "  ")
              : "") +
         '\n';
}

/// Lists where a headline without estimation and the estimate beside it differ by more than their interval.
std::string check_text(const std::vector<LevelSummary>& levels, std::size_t width) {
  constexpr double agreed = 0.1;  // nats: about the estimators' own bias
  std::string out;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Figure& f = levels[i].own.expansion;
    const Interval& d = f.check_difference.difference;
    if (f.check.empty() || !std::isfinite(d.lo)) continue;
    const double nearest = d.lo > 0.0 ? d.lo : (d.hi < 0.0 ? -d.hi : 0.0);
    if (nearest <= agreed) continue;
    out += wrap(fmt::format("level {} expansion: {} gives {} nats against {}: they do not agree", i, f.check,
                            interval_text(d, 2, true), f.estimators.empty() ? "" : f.estimators.front()),
                width, "", "  ");
  }
  return out;
}

std::string metrics_table(const std::vector<LevelSummary>& levels, std::size_t width) {
  const bool any =
      std::any_of(levels.begin(), levels.end(), [](const LevelSummary& l) { return l.metrics.measured > 0; });
  if (!any) return "";
  const std::string nodes = "nodes, %";
  const std::string roadmap = "roadmap of the nodes";
  const std::string proposals = "proposals, %";
  std::vector<Table::Column> columns = {text_column("level"),
                                        number_column({"create"}, nodes),
                                        number_column({"merge"}, nodes),
                                        number_column({"expand"}, nodes),
                                        number_column({"over-", "sample"}, nodes),
                                        number_column({"invalid"}, nodes),
                                        number_column({"compo-", "nents"}, roadmap),
                                        number_column({"coverage", "%"}, roadmap),
                                        number_column({"connectivity", "%"}, roadmap),
                                        number_column({"information", "nats"}),
                                        number_column({"invalid"}, proposals),
                                        number_column({"trapped"}, proposals),
                                        number_column({"redundant"}, proposals),
                                        number_column({"useful"}, proposals)};
  const auto share = [](const Interval& interval) {
    Interval scaled = interval;
    for (double* x : {&scaled.value, &scaled.lo, &scaled.hi}) *x *= 100.0;
    return interval_text(scaled, 0);
  };
  const auto labels = level_labels(levels);
  Table table(columns);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const MetricsSummary& m = levels[i].metrics;
    std::vector<std::string> cells = {labels[i]};
    for (const Interval& c : m.classes) cells.push_back(share(c));
    cells.insert(cells.end(), {interval_text(m.components, 1), share(m.coverage), share(m.connectivity),
                               interval_text(m.information), share(m.invalid), share(m.trapped), share(m.redundant),
                               share(m.useful)});
    table.add(std::move(cells));
  }
  return table.text(width);
}

}  // namespace

std::string efficiency_tables(const RunsSummary& summary, std::size_t width) {
  const std::vector<LevelSummary>& levels = summary.levels;
  if (!any_figure(levels)) return "no path, so no target to score against\n";
  std::string out = hitting_table(levels, width) + measure_table(levels, width);
  if (levels.size() > 1) {
    out += waterfall_text("what each level adds, tree:       ", summary.tree_waterfall, levels, width);
    out += waterfall_text("what each level adds, expansion:  ", summary.expansion_waterfall, levels, width);
  }
  return out + check_text(levels, width);
}

namespace {

/// "samples of 14 seeds taken together, on 4 paths of a seed left out: tree -0.42…+1.20 nats above uniform (mass 0.31),
/// expansion ...".
std::string pooled_text(const RunsSummary& summary, std::size_t width) {
  if (summary.levels.empty() || !summary.levels.front().pooled) return "";
  const PooledSummary& pooled = *summary.levels.front().pooled;
  std::string text =
      fmt::format("samples of {} taken together, on {} of a seed left out:", plural(pooled.seeds, "seed"),
                  plural(pooled.targets, "path"));
  const auto add = [&](const char* name, const Efficiency& estimated) {
    if (std::isnan(estimated.value)) return;
    const Efficiency e = shown(estimated);
    const AboveUniform above = above_uniform(e);
    const bool printed = above.blank.empty() && std::isfinite(above.lo);
    text += fmt::format(" {} {} above uniform (mass {})", name,
                        printed ? ends_text(above.lo, above.hi) + " nats" : "too few samples to show",
                        fixed(e.parts.mass, 2));
  };
  add("tree", pooled.tree);
  add("expansion", pooled.expansion);
  std::string out = wrap(text, width, "", "  ");
  for (const LevelSummary& level : summary.levels) {
    for (const SampleRole role : {SampleRole::tree, SampleRole::expansion}) {
      const Headline together = headline(level, role);
      const AboveUniform alone = over_runs(level, role).above;
      if (together.seeds == 0 || !disagree(together.above, alone)) continue;
      out += wrap(fmt::format("{} {}: all seeds together have {} nats above uniform, single runs {}", level.name,
                              role == SampleRole::tree ? "tree" : "expansion",
                              ends_text(together.above.lo, together.above.hi), ends_text(alone.lo, alone.hi)),
                  width, "", "  ");
    }
  }
  return out;
}

/// \param search  whether to include the table of each level's search
std::string strategy_table(const RunsSummary& summary, bool measured, bool search, std::size_t width) {
  const std::vector<LevelSummary>& levels = summary.levels;
  if (levels.empty()) return "no level was reached\n";
  std::string out = search ? search_table(summary, width) : "";
  if (!measured) return search ? out : "the experiment measures nothing (measure = false)\n";
  out += (search && any_figure(levels) ? "\n" : "") + efficiency_tables(summary, width);
  if (const std::string table = metrics_table(levels, width); !table.empty()) out += "\n" + table;
  return out;
}

// The summary --------------------------------------------------------------------------------------------------------

/// Returns the number of runs of a pair of means: "14", or "14, 12" where tree and expansion differ.
std::string scored_text(const FigurePair& pair) {
  if (pair.tree.scored == pair.expansion.scored || pair.expansion.scored == 0) return std::to_string(pair.tree.scored);
  if (pair.tree.scored == 0) return std::to_string(pair.expansion.scored);
  return fmt::format("{}, {}", pair.tree.scored, pair.expansion.scored);
}

const LevelSummary& root_of(const StrategySummary& row) {
  static const LevelSummary none;
  return row.runs.levels.empty() ? none : row.runs.levels.front();
}

std::string above_text(const Figure& figure) {
  const AboveUniform above = above_uniform(figure);
  if (figure.scored == 0 || std::isnan(above.lo)) return "-";
  return above.blank.empty() ? ends_text(above.lo, above.hi) : "";
}

/// The columns of the root's efficiency in the summary: on the own path, on other seeds' paths, and with equally many
/// samples, each where any strategy has it.
class RootColumns {
 public:
  explicit RootColumns(const std::vector<StrategySummary>& rows) {
    for (const StrategySummary& row : rows) {
      const LevelSummary& root = root_of(row);
      crossed_ = crossed_ || root.root_cross.tree.scored > 0;
      equal_ = equal_ || root.equal.tree.scored + root.equal.expansion.scored > 0;
      const Headline nodes = headline(root, SampleRole::tree);
      const Headline proposals = headline(root, SampleRole::expansion);
      seeds_ = std::max({seeds_, nodes.seeds, proposals.seeds});
      hitting_tree_.push_back(hitting_text(hitting_of(root, SampleRole::tree).position));
      hitting_expansion_.push_back(hitting_text(hitting_of(root, SampleRole::expansion).position));
      hits_ = hits_ || hitting_tree_.back() != "-" || hitting_expansion_.back() != "-";
      pooled_tree_.add(nodes.seeds > 0 ? nodes.above : AboveUniform{}, nodes.seeds);
      pooled_expansion_.add(proposals.seeds > 0 ? proposals.above : AboveUniform{}, proposals.seeds);
      tree_.add(root.root.tree, {row.strategy, "tree"}, notes_);
      expansion_.add(root.root.expansion, {row.strategy, "expansion"}, notes_);
      cross_tree_.add(root.root_cross.tree, {row.strategy, "tree on other seeds'"}, notes_);
      cross_expansion_.add(root.root_cross.expansion, {row.strategy, "expansion on other seeds'"}, notes_);
    }
  }

  void add_columns(std::vector<Table::Column>& columns) const {
    const auto add = [&](const std::string& group, std::initializer_list<const char*> names) {
      for (const char* name : names) columns.push_back(number_column({name}, group));
    };
    if (hits_) add("hitting, by position", {"tree", "expansion"});
    if (seeds_ > 0) add("above uniform, all seeds together", {"tree", "expansion"});
    add("above uniform, own path", {"n", "tree", "expansion"});
    if (crossed_) add("above uniform, other seeds' paths", {"n", "tree", "expansion"});
    if (equal_) add("with equally many samples", {"tree", "expansion"});
  }

  /// Adds the cells of row `i`.
  void add_cells(std::size_t i, const LevelSummary& root, std::vector<std::string>& cells) const {
    if (hits_) cells.insert(cells.end(), {hitting_tree_[i], hitting_expansion_[i]});
    if (seeds_ > 0) cells.insert(cells.end(), {pooled_tree_.text()[i], pooled_expansion_.text()[i]});
    cells.insert(cells.end(), {scored_text(root.root), tree_.text()[i], expansion_.text()[i]});
    if (crossed_) {
      cells.insert(cells.end(), {scored_text(root.root_cross), cross_tree_.text()[i], cross_expansion_.text()[i]});
    }
    if (equal_) {
      cells.insert(cells.end(), {above_text(root.equal.tree), above_text(root.equal.expansion)});
    }
  }

  [[nodiscard]] const Notes& notes() const { return notes_; }

 private:
  Notes notes_;
  FigureColumn tree_;
  FigureColumn expansion_;
  FigureColumn cross_tree_;
  FigureColumn cross_expansion_;
  FigureColumn pooled_tree_;
  FigureColumn pooled_expansion_;
  std::vector<std::string> hitting_tree_;
  std::vector<std::string> hitting_expansion_;
  bool hits_ = false;      // any of them has a value
  std::size_t seeds_ = 0;  // of all seeds together
  bool crossed_ = false;
  bool equal_ = false;
};

std::string summary_table(const std::vector<StrategySummary>& rows, bool measured, std::size_t width) {
  std::vector<Table::Column> columns = {text_column("strategy"),
                                        number_column({"solved"}, "success"),
                                        number_column({"95 %", "interval"}, "success"),
                                        number_column({"validity", "checks"}, "medians, all levels"),
                                        number_column({"motion", "checks"}, "medians, all levels"),
                                        number_column({"time", "ms"}, "medians, all levels"),
                                        number_column({"path length", "m, mean"})};
  const bool anytime = std::any_of(rows.begin(), rows.end(),
                                   [](const StrategySummary& r) { return !std::isnan(r.runs.improvement_checks); });
  const bool set_up = std::any_of(rows.begin(), rows.end(),
                                  [](const StrategySummary& r) { return r.runs.set_up_share > least_set_up_share; });
  const std::string medians = "medians, all levels";
  if (set_up) columns.insert(columns.begin() + 4, number_column({"set-up,", "units"}, medians));
  if (anytime) {
    columns[3] = number_column({"checks to", "first path"}, medians);
    columns.insert(columns.begin() + 4, number_column({"checks of", "improvement"}, medians));
  }
  const bool lua =
      std::any_of(rows.begin(), rows.end(), [](const StrategySummary& r) { return r.runs.lua_share > 0.0; });
  if (lua) columns.insert(columns.end() - 1, number_column({"Lua %"}));
  const RootColumns root(rows);
  if (measured) root.add_columns(columns);
  double slowest = 0.0;
  for (const auto& row : rows) {
    if (std::isfinite(row.runs.seconds.value)) slowest = std::max(slowest, 1000.0 * row.runs.seconds.value);
  }
  Table table(columns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RunsSummary& s = rows[i].runs;
    std::vector<std::string> cells = {rows[i].strategy, fmt::format("{}/{}", s.solved, s.runs), wilson_text(s.success),
                                      count_text(s.validity_checks.value)};
    if (anytime) cells.push_back(std::isnan(s.improvement_checks) ? "" : count_text(s.improvement_checks));
    if (set_up) cells.push_back(s.set_up > 0.0 ? count_text(std::round(s.set_up)) : "");
    cells.insert(cells.end(),
                 {count_text(s.motion_checks.value), milliseconds_text(s.seconds.value, decimals_for(slowest))});
    if (lua) cells.push_back(lua_share_text(s.lua_share));
    cells.push_back(interval_text(s.length));
    if (measured) root.add_cells(i, root_of(rows[i]), cells);
    table.add(std::move(cells));
  }
  return table.text(width) + root.notes().text(width);
}

/// Returns the verdict on the guide that a strategy is without; nullptr where there is none.
const Verdict* left_out_verdict(const ProblemSummary& problem, const std::string& strategy) {
  for (const StrategySummary& one : problem.strategies) {
    if (one.strategy == strategy && one.left_out) return &*one.left_out;
  }
  return nullptr;
}

/// Compares strategies with a baseline, paired by seed; one table for each baseline.
std::string comparison_tables(const ProblemSummary& problem, bool measured, std::size_t width) {
  const std::vector<Comparison>& comparisons = problem.comparisons;
  std::vector<std::string> baselines;
  for (const Comparison& c : comparisons) {
    if (std::find(baselines.begin(), baselines.end(), c.baseline) == baselines.end()) baselines.push_back(c.baseline);
  }
  std::string out;
  for (const std::string& baseline : baselines) {
    const std::string solved = "solved";
    const std::string checks = "validity checks";
    const std::string tree = "above uniform, tree";
    const std::string expansion = "above uniform, expansion";
    std::vector<Table::Column> columns = {text_column("strategy"),
                                          number_column({"difference", "%"}, solved),
                                          number_column({"here"}, solved),
                                          number_column({"there"}, solved),
                                          number_column({"both"}, solved),
                                          number_column({"ratio, median", "[95 % interval]"}, checks),
                                          number_column({"difference,", "median"}, checks),
                                          number_column({"p"}, checks)};
    if (measured) {
      for (const std::string& role : {tree, expansion}) {
        columns.insert(columns.end(),
                       {number_column({"n"}, role), number_column({"difference"}, role), number_column({"p"}, role)});
      }
    }
    const bool judged = std::any_of(comparisons.begin(), comparisons.end(), [&](const Comparison& c) {
      return c.baseline == baseline && left_out_verdict(problem, c.strategy) != nullptr;
    });
    if (judged) columns.push_back(text_column("verdict"));
    Table table(columns);
    std::size_t pairs = 0;
    bool cross = false;
    bool ablated = false;
    for (const Comparison& c : comparisons) {
      if (c.baseline != baseline) continue;
      Interval success = c.solved.difference;
      for (double* x : {&success.value, &success.lo, &success.hi}) *x *= 100.0;
      const PairedCosts& v = c.validity_checks;
      pairs = std::max(pairs, v.pairs);
      cross = cross || c.cross;
      ablated = ablated || !c.text.empty();
      std::vector<std::string> cells = {c.text.empty() ? c.strategy : c.text,
                                        range_text(success, 0),
                                        std::to_string(v.solved),
                                        std::to_string(v.reference_solved),
                                        std::to_string(v.both_solved),
                                        ratio_text(v.ratio),
                                        std::isinf(v.difference.value) ? (v.difference.value > 0.0 ? "inf" : "-inf")
                                                                       : fixed(v.difference.value, 0, true),
                                        p_text(v.holm_p)};
      if (measured) {
        for (const Paired* paired : {&c.tree_above, &c.expansion_above}) {
          const bool any = !std::isnan(paired->difference.value);
          cells.push_back(std::to_string(paired->less + paired->greater + paired->equal));
          cells.push_back(interval_text(paired->difference, 2, true));
          cells.push_back(any ? p_text(paired->holm_p) : "-");
        }
      }
      if (judged) {
        const Verdict* verdict = left_out_verdict(problem, c.strategy);
        cells.push_back(verdict != nullptr ? verdict_text_without(*verdict) : "");
      }
      table.add(std::move(cells));
    }
    out +=
        '\n' + wrap(fmt::format("{} {}, {} paired by seed; unsolved counts as infinite{}; p: sign test, corrected by "
                                "Holm over the comparisons shown",
                                ablated ? "ablation of" : "compared with", baseline, plural(pairs, "run"),
                                measured ? (cross ? "; nats above uniform on other seeds' paths"
                                                  : "; nats above uniform on each run's own path")
                                         : ""),
                    width, "", "  ");
    out += table.text(width);
    if (judged) out += wrap(verdicts_note(), width, "  ", "  ");
  }
  return out;
}

std::string warnings_text(const ProblemSummary& problem, std::size_t width) {
  std::string out;
  for (const std::string& warning : problem.warnings) out += wrap("warning: " + warning, width, "", "  ");
  return out.empty() ? out : '\n' + out;
}

// The whole ----------------------------------------------------------------------------------------------------------

std::string title(const std::string& text, std::size_t width) {
  std::string line = "━━ " + text + ' ';
  for (std::size_t shown = display_width(line); shown < width; ++shown) line += "━";
  return line + '\n';
}

std::string legend(const ExperimentSummary& experiment, std::size_t width) {
  std::string out = fmt::format("{} × {} × {}. ", plural(experiment.problems.size(), "problem"),
                                plural_y(experiment.strategies.size(), "strateg"), seeds_text(experiment.seeds));
  out += experiment.seeds.size() * experiment.problems.size() > 1
             ? "Counts and times of levels: medians of what all runs spent; of strategies: an unsolved run counts as "
               "infinite. Efficiencies: means over the runs that have a target, as many as `runs` says; a…b: the "
               "interval that the samples support, with Student's over the runs; blank: too few samples to show on "
               "which side of uniform sampling they are; ±: half-width of a 95 % Student interval, none for fewer than "
               "5 runs."
             : "One run of each strategy: no intervals.";
  out = wrap(out, width);
  if (!experiment.measured) return out;
  const std::string names = fmt::format("{}", fmt::join(experiment.estimators, ", "));
  out += wrap(
      fmt::format(
          "Hitting: how much sooner than uniform samples these hit the balls along a path in turn, nats, 0 is uniform "
          "sampling, more is better; guides with more of it mostly need fewer checks. Bottleneck: where on that path "
          "they are "
          "rarest. "
          "Above uniform: nats by which samples are nearer to the target than uniform ones, more is better; it is "
          "uniform - SE. SE: sampling efficiency, the divergence of the target from the samples with {:g} % uniform "
          "mixed in, the sum of mass, how seldom a sample lies in the target, and spread, how unevenly those that "
          "do cover it; oracle: samples of the target itself, perfect guidance; uniform: no guidance; D: the "
          "divergence with nothing mixed in, at least -log of the share in the target (95 %); along: the divergence "
          "of arc length along the path. docs/measure.md explains them.",
          100.0 * uniform_mix),
      width);
  out += wrap(fmt::format("Target: {}{}.{}{}{}{}", experiment.target, names.empty() ? "" : "; estimator: " + names,
                          experiment.tubes.empty() ? "" : " ", experiment.tubes, experiment.omitted.empty() ? "" : " ",
                          experiment.omitted),
              width);
  return out;
}

std::size_t columns_of(int width) { return static_cast<std::size_t>(std::max(width, 20)); }

std::string summary_section(const ExperimentSummary& experiment, const ProblemSummary& problem, std::size_t columns) {
  std::vector<const RunsSummary*> runs;
  for (const StrategySummary& one : problem.strategies) runs.push_back(&one.runs);
  const std::string set_up = set_up_text(runs);
  return "\nsummary of " + (problem.problem.empty() ? "all problems" : problem.problem) + '\n' +
         summary_table(problem.strategies, experiment.measured, columns) +
         (set_up.empty() ? "" : wrap(set_up, columns, "", "  ")) +
         comparison_tables(problem, experiment.measured, columns) + warnings_text(problem, columns);
}

}  // namespace

std::string levels_text(const RunsSummary& run, int width) { return search_table(run, columns_of(width)); }

std::string efficiency_text(const RunsSummary& run, int width) { return efficiency_tables(run, columns_of(width)); }

std::string summary_text(const ExperimentSummary& experiment, int width) {
  std::string out;
  for (const ProblemSummary& one : experiment.problems) out += summary_section(experiment, one, columns_of(width));
  return out;
}

const std::vector<std::string>& report_kinds() {
  static const std::vector<std::string> names = {"overview", "levels", "efficiency", "full"};
  return names;
}

std::string report_text(const ExperimentSummary& experiment, int width, ReportKind kind) {
  const std::size_t columns = columns_of(width);
  if (kind == ReportKind::overview) return overview_text(experiment, columns);
  if (kind == ReportKind::levels) return levels_report_text(experiment, columns);
  std::string out = legend(experiment, columns);
  for (const ProblemSummary* problem : experiment.listed()) {
    const std::string heading = problem->problem.empty()
                                    ? fmt::format("{} problems taken together ({} … {}), {} in all for each strategy",
                                                  experiment.problems.size(), experiment.problems.front().problem,
                                                  experiment.problems.back().problem,
                                                  plural(experiment.problems.size() * experiment.seeds.size(), "run"))
                                    : fmt::format("{}, {}", problem->problem, seeds_text(experiment.seeds));
    out += '\n' + title(heading, columns);
    for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
      const StrategyFacts& of = experiment.strategies[s];
      const RunsSummary& runs = problem->strategies[s].runs;
      out += '\n' + wrap(of.name == of.text ? of.name : fmt::format("{} = {}", of.name, of.text), columns, "", "    ");
      out += wrap(
          fmt::format("solved {}/{} runs{} · {}", runs.solved, runs.runs,
                      runs.runs >= least_for_interval ? fmt::format(" ({}, 95 % Wilson)", wilson_text(runs.success))
                                                      : std::string(),
                      of.shares),
          columns, "", "    ");
      out += strategy_table(runs, experiment.measured, kind == ReportKind::full, columns);
      if (experiment.measured) out += pooled_text(runs, columns);
    }
    out += summary_section(experiment, *problem, columns);
  }
  return out;
}

}  // namespace trellis
