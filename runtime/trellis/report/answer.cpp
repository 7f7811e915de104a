// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/answer.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

using Kind = AnswerVerdict::Kind;

/// A name of a guide in a label, in columns.
constexpr std::size_t longest_guide = 24;

/// "0.11", "≥4.0", "≤0.25", "0.3–0.5"; "–" where nothing is known.
std::string bracket_text(const RatioBracket& ratio) {
  if (std::isnan(ratio.lo) || (ratio.lo == 0.0 && std::isinf(ratio.hi))) return "–";
  std::string lo = two_figures(ratio.lo);
  const std::string hi = two_figures(ratio.hi);
  if (lo == hi) return lo;
  if (std::isinf(ratio.hi)) return "≥" + lo;
  return ratio.lo == 0.0 ? "≤" + hi : lo + "–" + hi;
}

bool has_ratio(const Verdict& verdict) { return verdict.counts.pairs > 0; }

bool directed(const Verdict& verdict) {
  return verdict.kind == Verdict::Kind::pays || verdict.kind == Verdict::Kind::costs;
}

/// Whether a difference is shown that hardly matters.
bool hardly_matters(const Verdict& verdict) {
  const RatioBracket& median = verdict.ratio.median;
  return directed(verdict) && median.lo > 1.0 / least_effect && median.hi < least_effect;
}

/// \param pays, costs  the words for these verdicts
AnswerVerdict answer_on(const Verdict& verdict, const char* pays, const char* costs) {
  if (hardly_matters(verdict)) return {Kind::small, "hardly matters", ""};
  switch (verdict.kind) {
    case Verdict::Kind::none: return {};
    case Verdict::Kind::pays: return {Kind::good, pays, ""};
    case Verdict::Kind::costs: return {Kind::bad, costs, ""};
    case Verdict::Kind::no_difference: return {Kind::small, verdict_word(verdict), ""};
    case Verdict::Kind::changes_nothing:
      return {Kind::small, verdict_word(verdict), verdict.unsolved ? "no path with or without it" : ""};
    case Verdict::Kind::not_shown: {
      std::string more;
      if (verdict.more_ablation > 0.0) {
        more = fmt::format("budget spent: --ablation {:g}", verdict.more_ablation);
      } else if (verdict.pairs_needed > 0) {
        more = fmt::format("~{} seeds would probably show it", verdict.pairs_needed);
      }
      return {Kind::open, verdict_word(verdict), std::move(more)};
    }
    default: return {Kind::open, verdict_word(verdict), ""};
  }
}

/// Returns the verdict on a guide of a strategy; of the kind `none` where there is none.
Verdict guide_verdict(const StrategySummary& strategy, const std::string& key) {
  const std::vector<LevelSummary>& levels = strategy.runs.levels;
  for (std::size_t i = 0; i < std::min(levels.size(), strategy.verdicts.size()); ++i) {
    if (guide_key(levels[i].key) == key) return strategy.verdicts[i];
  }
  for (const GuideVerdict& one : strategy.parts) {
    if (one.key == key) return one.verdict;
  }
  return {};
}

/// All that the rows are computed from.
class Source {
 public:
  Source(const ExperimentFacts& experiment, const ExperimentSummary& summary)
      : experiment_(experiment), summary_(summary) {}

  [[nodiscard]] const std::string& baseline() const { return summary_.baseline; }
  [[nodiscard]] const ExperimentSummary& summary() const { return summary_; }
  [[nodiscard]] const ExperimentFacts& experiment() const { return experiment_; }

  /// The strategies of the script, by their place in the summary.
  [[nodiscard]] std::vector<std::size_t> strategies() const {
    std::vector<std::size_t> own;
    for (std::size_t s = 0; s < summary_.strategies.size(); ++s) {
      if (summary_.strategies[s].ablation.empty()) own.push_back(s);
    }
    return own;
  }

  /// The guides of a strategy that have rows. A strategy without one that is the baseline is in the baseline's row.
  [[nodiscard]] std::vector<const GuideFacts*> guides(const StrategyFacts& strategy) const {
    std::vector<const GuideFacts*> found;
    for (const GuideFacts& guide : strategy.guides) {
      if (guide.equal.empty() || guide.equal != baseline()) found.push_back(&guide);
    }
    return found;
  }

  /// The verdict on a strategy against the baseline. A guide without which the strategy is the baseline may have been
  /// tested on more seeds.
  [[nodiscard]] Verdict on_strategy(const ProblemSummary& problem, std::size_t s) const {
    const StrategyFacts& facts = summary_.strategies[s];
    if (baseline().empty() || facts.name == baseline()) return {};
    Verdict verdict = strategy_verdict(experiment_, problem.problem, facts.name, baseline()).value_or(Verdict{});
    for (const GuideFacts& guide : facts.guides) {
      if (guide.equal != baseline()) continue;
      Verdict other = guide_verdict(problem.strategies[s], guide.key);
      const bool never = other.kind == Verdict::Kind::never_set_up;
      if (other.counts.pairs > verdict.counts.pairs) verdict = std::move(other);
      if (never) verdict.kind = Verdict::Kind::never_set_up;
    }
    return verdict;
  }

  [[nodiscard]] AnswerRow strategy_row(const ProblemSummary& problem, std::size_t s) const {
    const RunsSummary& runs = problem.strategies[s].runs;
    AnswerRow row;
    row.label = row.strategy = summary_.strategies[s].name;
    row.solved = runs.solved;
    row.runs = runs.runs;
    row.checks = {runs.validity_checks.value, runs.validity_checks.value};
    row.seconds = runs.seconds.value;
    row.length = runs.length.value;
    const Verdict verdict = on_strategy(problem, s);
    if (has_ratio(verdict)) row.ratio = verdict.ratio;
    row.verdict = answer_on_strategy(verdict);
    return row;
  }

  [[nodiscard]] AnswerRow guide_row(const ProblemSummary& problem, std::size_t s, const GuideFacts& guide) const {
    AnswerRow row;
    row.strategy = summary_.strategies[s].name;
    row.label = "without " + short_level(guide.guide, longest_guide);
    row.guide = guide.key;
    row.indent = 1;
    bool further = false;
    std::vector<double> least;
    std::vector<double> most;
    for (const ProblemFacts& one : experiment_.problems) {
      if (!problem.problem.empty() && one.name != problem.problem) continue;
      for (const TestedPair& pair : pairs_of_guide(experiment_, one.name, row.strategy, guide)) {
        const CensoredCost& cost = pair.without;
        const bool cut_off = cost.cut_off && !cost.solved;
        ++row.runs;
        row.solved += cost.solved ? 1 : 0;
        row.cut_off += cut_off ? 1 : 0;
        least.push_back(cut_off ? cost.spent : cost.cost());
        most.push_back(cost.cost());
      }
      further = further || std::any_of(experiment_.left_out.begin(), experiment_.left_out.end(), [&](const LeftOut& l) {
                  return l.problem == one.name && l.strategy == row.strategy && l.key == guide.key && !l.pairs.empty();
                });
    }
    row.checks = {median(least), median(most)};
    // Runs that only test the guide have no times.
    if (row.runs > 0 && !further) {
      for (const StrategySummary& other : problem.strategies) {
        if (other.strategy != guide.equal) continue;
        row.seconds = other.runs.seconds.value;
        row.length = other.runs.length.value;
      }
    }
    const Verdict verdict = guide_verdict(problem.strategies[s], guide.key);
    if (has_ratio(verdict)) row.ratio = inverse(verdict.ratio);
    row.verdict = answer_on_guide(verdict);
    return row;
  }

 private:
  const ExperimentFacts& experiment_;
  const ExperimentSummary& summary_;
};

/// The logarithm of a ratio to the baseline, by which strategies are sorted; infinite without one.
double rank_of(const std::optional<MedianRatio>& ratio) {
  constexpr double extreme = 1e4;  // one problem without a path does not outweigh all others
  if (!ratio) return std::numeric_limits<double>::infinity();
  const double value = ratio->median.lo > 0.0 ? ratio->median.lo : ratio->median.hi;
  return std::log(std::clamp(value, 1.0 / extreme, extreme));
}

/// By which strategies are sorted: the rank of their ratios, then of equal ones their checks.
using Rank = std::pair<double, double>;

/// Returns the strategies, the baseline first, then by rank.
/// \param rank  of a strategy of the summary
std::vector<std::size_t> in_order(const Source& source, const std::function<Rank(std::size_t)>& rank) {
  std::vector<std::pair<Rank, std::size_t>> ranked;
  for (const std::size_t s : source.strategies()) {
    const bool first = source.summary().strategies[s].name == source.baseline();
    ranked.emplace_back(first ? Rank{-std::numeric_limits<double>::infinity(), 0.0} : rank(s), s);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::size_t> order;
  order.reserve(ranked.size());
  for (const auto& one : ranked) order.push_back(one.second);
  return order;
}

constexpr const char* first_path_checks = "validity checks until the first path";

/// "15 seeds", "seed 7", "5 seeds (16–20)".
std::string seeds_word(const std::vector<std::uint64_t>& seeds) {
  if (seeds.size() == 1) return fmt::format("seed {}", seeds.front());
  const bool usual = !seeds.empty() && seeds.front() == 1 && seeds.back() == seeds.size();
  return usual ? plural(seeds.size(), "seed") : seeds_text(seeds);
}

std::string title_of(const Source& source, const std::string& problem) {
  const ExperimentSummary& summary = source.summary();
  const std::string seeds = seeds_word(summary.seeds);
  if (!problem.empty()) {
    return fmt::format("{}, {}: {}{}", problem, seeds, first_path_checks, summary.seeds.size() > 1 ? ", medians" : "");
  }
  const bool many = summary.problems.size() > most_single_problems;
  std::string title = fmt::format("{} problems, {}{}: {}", summary.problems.size(), seeds,
                                  summary.seeds.size() > 1 ? " each" : "", first_path_checks);
  if (summary.seeds.size() > 1 || many) title += ", medians";
  if (many) title += fmt::format(" of {} runs", summary.problems.size() * summary.seeds.size());
  return title;
}

AnswerTable table_of(const Source& source, const ProblemSummary& problem) {
  AnswerTable table{problem.problem, title_of(source, problem.problem), {}};
  std::map<std::size_t, AnswerRow> rows;
  for (const std::size_t s : source.strategies()) rows[s] = source.strategy_row(problem, s);
  for (const std::size_t s : in_order(source, [&](std::size_t one) {
         const double checks = rows[one].checks.lo;
         return Rank{rank_of(rows[one].ratio), std::isnan(checks) ? std::numeric_limits<double>::infinity() : checks};
       })) {
    table.rows.push_back(std::move(rows[s]));
    const StrategyFacts& facts = source.summary().strategies[s];
    for (const GuideFacts* guide : source.guides(facts)) table.rows.push_back(source.guide_row(problem, s, *guide));
  }
  return table;
}

/// Returns the row of a strategy, or of it without a guide; nullptr where the table has none.
const AnswerRow* find_row(const AnswerTable& table, const std::string& strategy, const std::string& guide) {
  const auto found = std::find_if(table.rows.begin(), table.rows.end(),
                                  [&](const AnswerRow& row) { return row.strategy == strategy && row.guide == guide; });
  return found == table.rows.end() ? nullptr : &*found;
}

/// "pays 5 of 6", "keep 2, drop 1 of 6"; the word that all have; "not shown".
AnswerVerdict tally(const std::vector<const AnswerRow*>& rows, const char* good, const char* bad) {
  const auto count = [&](Kind kind) {
    return std::count_if(rows.begin(), rows.end(),
                         [&](const AnswerRow* row) { return row != nullptr && row->verdict.kind == kind; });
  };
  const auto most = static_cast<std::ptrdiff_t>(rows.size());
  const std::ptrdiff_t better = count(Kind::good);
  const std::ptrdiff_t worse = count(Kind::bad);
  std::string word;
  if (better > 0) word = fmt::format("{} {}", good, better);
  if (worse > 0) word += fmt::format("{}{} {}", word.empty() ? "" : ", ", bad, worse);
  if (!word.empty()) return {better >= worse ? Kind::good : Kind::bad, fmt::format("{} of {}", word, most), ""};
  if (count(Kind::none) == most) return {};
  if (count(Kind::small) == most) {
    const bool same = std::all_of(rows.begin(), rows.end(), [&](const AnswerRow* row) {
      return row->verdict.word == rows.front()->verdict.word;
    });
    return {Kind::small, same ? rows.front()->verdict.word : "hardly matters", ""};
  }
  for (const char* all : {"never set up", "not tested"}) {
    const auto is = [&](const AnswerRow* row) { return row != nullptr && row->verdict.word == all; };
    if (std::all_of(rows.begin(), rows.end(), is)) return {Kind::open, all, ""};
  }
  return {Kind::open, "not shown", ""};
}

AnswerMatrix matrix_of(const Source& source, const std::vector<AnswerTable>& tables) {
  AnswerMatrix matrix;
  for (const AnswerTable& table : tables) matrix.problems.push_back(table.problem);
  const auto rows_of = [&](const std::string& strategy, const std::string& guide) {
    std::vector<const AnswerRow*> rows;
    rows.reserve(tables.size());
    for (const AnswerTable& table : tables) rows.push_back(find_row(table, strategy, guide));
    return rows;
  };
  const auto line_of = [&](std::string label, const std::string& strategy, const std::string& guide) {
    const std::vector<const AnswerRow*> rows = rows_of(strategy, guide);
    AnswerMatrix::Line line{std::move(label), strategy, guide, {}, {}};
    for (const AnswerRow* row : rows) {
      AnswerMatrix::Cell& cell = line.cells.emplace_back();
      if (row == nullptr || !row->ratio) continue;
      cell.ratio = row->ratio->median;
      cell.shown =
          row->verdict.kind == Kind::good || row->verdict.kind == Kind::bad || row->verdict.word == "hardly matters";
    }
    line.verdict = guide.empty() ? tally(rows, "pays", "costs") : tally(rows, "keep", "drop");
    return line;
  };
  const auto rank = [&](std::size_t s) {
    double sum = 0.0;
    for (const AnswerRow* row : rows_of(source.summary().strategies[s].name, "")) {
      sum += row != nullptr ? rank_of(row->ratio) : 0.0;
    }
    return sum;
  };
  const std::vector<std::size_t> order = in_order(source, [&](std::size_t s) { return Rank{rank(s), 0.0}; });
  matrix.reference = source.baseline();
  if (matrix.reference.empty() && !order.empty()) {
    matrix.reference = source.summary().strategies[order.front()].name;
  }
  for (const AnswerRow* row : rows_of(matrix.reference, "")) {
    matrix.checks.push_back(row != nullptr ? row->checks_text() : "");
  }
  for (const std::size_t s : order) {
    const StrategyFacts& facts = source.summary().strategies[s];
    if (facts.name != matrix.reference) matrix.strategies.push_back(line_of(facts.name, facts.name, ""));
    for (const GuideFacts* guide : source.guides(facts)) {
      const std::string label = fmt::format("{} without {}", facts.name, short_level(guide->guide, longest_guide));
      matrix.guides.push_back(line_of(label, facts.name, guide->key));
    }
  }
  return matrix;
}

/// The group of a problem: its own, else its name up to a "/", as "gap/07" has; else "others".
std::string group_of(const ProblemFacts& problem) {
  if (!problem.group.empty()) return problem.group;
  const std::size_t end = problem.name.find('/');
  return end == std::string::npos || end == 0 ? "others" : problem.name.substr(0, end);
}

std::optional<AnswerGroups> groups_of(const Source& source, const AnswerTable& table) {
  if (source.baseline().empty()) return std::nullopt;
  AnswerGroups groups;
  const std::vector<ProblemFacts>& problems = source.experiment().problems;
  for (const ProblemFacts& one : problems) {
    const auto found = std::find_if(groups.groups.begin(), groups.groups.end(),
                                    [&](const auto& group) { return group.first == group_of(one); });
    if (found == groups.groups.end()) {
      groups.groups.emplace_back(group_of(one), 1);
    } else {
      ++found->second;
    }
  }
  // Of one group, and of problems that have none, the table above says it.
  if (groups.groups.size() == 1 || groups.groups.size() == problems.size()) groups.groups.clear();
  for (const AnswerRow& row : table.rows) {
    if (row.indent > 0 || row.strategy == source.baseline()) continue;
    AnswerGroups::Line line{row.strategy, {}, 0, 0, AnswerRow::none, AnswerRow::none};
    std::map<std::string, std::vector<double>> of_group;
    std::vector<double> all;
    for (const ProblemFacts& one : problems) {
      for (const TestedPair& pair : pairs_of_runs(source.experiment(), one.name, row.strategy, source.baseline())) {
        if (!pair.with.solved && !pair.without.solved) continue;
        const double ratio = cost_ratio(pair.with, pair.without);
        line.cheaper += ratio < 1.0 ? 1 : 0;
        of_group[group_of(one)].push_back(ratio);
        all.push_back(ratio);
      }
    }
    for (const auto& group : groups.groups) line.ratios.push_back(median(of_group[group.first]));
    line.runs = all.size();
    std::sort(all.begin(), all.end());
    if (!all.empty()) {
      line.lo = all[all.size() / 10];
      line.hi = all[9 * all.size() / 10];
    }
    groups.lines.push_back(std::move(line));
  }
  if (groups.lines.empty()) return std::nullopt;
  return groups;
}

// Notes --------------------------------------------------------------------------------------------------------------

/// The problem whose summary the notes are from: the only one, or all together.
const ProblemSummary& overall(const ExperimentSummary& summary) {
  return summary.together ? *summary.together : summary.problems.front();
}

std::string joined(const std::vector<std::string>& parts, const char* separator = ", ") {
  return fmt::format("{}", fmt::join(parts, separator));
}

/// How many times as many of a strategy's nodes lie in the target as of uniform samples; NaN where the runs do not show
/// it.
double near_path_factor(const RunsSummary& runs) {
  if (runs.levels.empty()) return AnswerRow::none;
  // On the paths of other seeds: a run has nodes on its own one in any case.
  const Figure& of_runs = runs.levels.front().root_cross.tree;
  const Interval& mass = of_runs["SE_parts.mass"];
  const double even = of_runs["D_uniform"].value;
  if (of_runs.scored < least_for_interval || !(mass.hi < even || mass.lo > even)) return AnswerRow::none;
  const Headline found = headline(runs.levels.front(), SampleRole::tree);
  // The mass has uniform samples mixed in.
  const double factor = (std::exp(found.uniform - found.mass) - uniform_mix) / (1.0 - uniform_mix);
  return factor > 0.0 && (factor > 1.0) == (mass.hi < even) ? factor : AnswerRow::none;
}

/// "within 0.5 m of the path", of a tube; "" for other targets.
std::string near_path_text(const ExperimentFacts& experiment) {
  if (!experiment.measured || experiment.description.empty()) return "";
  const auto description = nlohmann::json::parse(experiment.description);
  const auto& measure = description.at("measure");
  const auto delta = measure.find("delta");
  if (measure.value("target", "") != "tube" || delta == measure.end() || !delta->is_number()) return "";
  return fmt::format("within {:g} m of the path", delta->get<double>());
}

std::string why_text(const Source& source) {
  const ExperimentSummary& summary = source.summary();
  const std::string near = near_path_text(source.experiment());
  if (near.empty()) return "";
  std::vector<std::pair<std::string, double>> found;
  for (const std::size_t s : source.strategies()) {
    const StrategyFacts& facts = summary.strategies[s];
    if (!facts.guided || facts.name == source.baseline()) continue;
    const double factor = near_path_factor(overall(summary).strategies[s].runs);
    if (std::isfinite(factor)) found.emplace_back(facts.name, factor);
  }
  if (found.size() == 1) {
    return fmt::format("why: {} times as many of {}'s nodes lie {} as of uniform samples",
                       two_figures(found.front().second), found.front().first, near);
  }
  std::vector<std::string> parts;
  parts.reserve(found.size());
  for (const auto& [name, factor] : found) parts.push_back(fmt::format("{} {}", name, two_figures(factor)));
  return parts.empty() ? "" : fmt::format("why: nodes {}, ÷ as many uniform samples: {}", near, joined(parts));
}

/// The largest set-up, and the assumption by which runs share it.
std::vector<std::string> set_up_notes(const Source& source) {
  const ExperimentSummary& summary = source.summary();
  const RunsSummary* largest = nullptr;
  std::string name;
  double ms = 0.0;
  for (const std::size_t s : source.strategies()) {
    const RunsSummary& runs = overall(summary).strategies[s].runs;
    if (!(runs.set_up_share > least_set_up_share) || std::isnan(runs.queries)) continue;
    // The strategy that ran first has computed it for all.
    ms = std::max(ms, 1000.0 * runs.set_up_seconds);
    if (largest != nullptr && runs.set_up <= largest->set_up) continue;
    largest = &runs;
    name = summary.strategies[s].name;
  }
  if (largest == nullptr) return {};
  const std::string cost = fmt::format("{} {} ms ({} units of work)", name, ms < 10.0 ? fixed(ms, 1) : fixed(ms, 0),
                                       thousands(largest->set_up));
  if (largest->queries <= 1.0) return {"set-up, in each run (queries = 1), in ms: " + cost};
  // On a line of its own, so that the time does not decide where the line ends.
  return {"set-up, once per world, beside ms: " + cost,
          fmt::format("  shared by {:g} queries, by assumption", largest->queries)};
}

/// "0.16 mm", "0.25 m".
std::string clearance_text(double metres) {
  return metres < 0.1 ? two_figures(1000.0 * metres) + " mm" : two_figures(metres) + " m";
}

std::string certified_text(const Source& source) {
  const ExperimentSummary& summary = source.summary();
  std::size_t paths = 0;
  double least = std::numeric_limits<double>::infinity();
  std::string where;
  for (const ProblemSummary& problem : summary.problems) {
    for (const std::size_t s : source.strategies()) {
      const CertifiedSummary& certified = problem.strategies[s].runs.certified;
      paths += certified.paths;
      if (certified.paths == 0 || !(certified.clearance < least)) continue;
      least = certified.clearance;
      where = fmt::format("{}{}, seed {}", summary.strategies[s].name,
                          summary.problems.size() > 1 ? ", " + problem.problem : "", certified.seed);
    }
  }
  if (paths == 0) return "";
  std::string text =
      fmt::format("{} path{} certified free of contact", thousands(static_cast<double>(paths)), paths == 1 ? "" : "s");
  if (where.empty()) return text;
  return text + (paths == 1 ? fmt::format(", by {} ({})", clearance_text(least), where)
                            : fmt::format(", the tightest by {} ({})", clearance_text(least), where));
}

/// Says for each strategy which runs found no path, and why.
std::vector<std::string> unsolved_notes(const Source& source) {
  const ExperimentSummary& summary = source.summary();
  std::vector<std::string> notes;
  for (const std::size_t s : source.strategies()) {
    const StrategySummary& all = overall(summary).strategies[s];
    if (all.unsolved.empty()) continue;
    std::string text = all.strategy + ": " + all.unsolved;
    std::vector<std::string> where;
    for (const ProblemSummary& problem : summary.problems) {
      const RunsSummary& runs = problem.strategies[s].runs;
      if (runs.solved == runs.runs) continue;
      where.push_back(fmt::format("{} of {} in {}", runs.runs - runs.solved, runs.runs, problem.problem));
    }
    if (summary.problems.size() > 1 && summary.problems.size() <= most_single_problems) {
      text += " (" + joined(where) + ")";
    }
    notes.push_back(std::move(text));
  }
  return notes;
}

/// The warnings of what the report lists.
std::vector<std::string> warning_notes(const ExperimentSummary& summary) {
  constexpr std::size_t most = 6;
  std::vector<std::string> notes;
  const std::vector<const ProblemSummary*> listed = summary.listed();
  for (const ProblemSummary* problem : listed) {
    for (const std::string& sentence : problem->warnings) {
      notes.push_back(fmt::format("warning: {}{}", listed.size() > 1 ? problem->problem + ": " : "", sentence));
    }
  }
  if (notes.size() > most) {
    const std::size_t more = notes.size() - most;
    notes.resize(most);
    notes.push_back(fmt::format("and {}: --report levels", plural(more, "warning")));
  }
  return notes;
}

/// What else the runs of a strategy did: an anytime planner, functions in Lua, times of a team, the planner beside the
/// guided search.
std::vector<AnswerNote> search_notes(const Source& source) {
  const ExperimentSummary& summary = source.summary();
  std::vector<std::string> improved;
  std::vector<std::string> lua;
  std::vector<std::string> makespans;
  std::vector<std::string> sums;
  std::vector<AnswerNote> notes;
  for (const std::size_t s : source.strategies()) {
    const RunsSummary& runs = overall(summary).strategies[s].runs;
    const std::string& name = summary.strategies[s].name;
    if (!std::isnan(runs.improvement_checks)) {
      improved.push_back(fmt::format("{} {} checks", name, thousands(runs.improvement_checks)));
    }
    if (runs.lua_share > 0.0) lua.push_back(fmt::format("{} {} %", name, lua_share_text(runs.lua_share)));
    if (!std::isnan(runs.makespan.value)) makespans.push_back(fmt::format("{} {:.1f} s", name, runs.makespan.value));
    if (!std::isnan(runs.sum_of_costs.value)) sums.push_back(fmt::format("{} {:.1f} s", name, runs.sum_of_costs.value));
  }
  if (!improved.empty()) {
    notes.push_back({"search", "after the first path, for shorter ones, medians: " + joined(improved)});
  }
  if (!makespans.empty()) notes.push_back({"team", "makespan, mean: " + joined(makespans)});
  if (!sums.empty()) notes.push_back({"team", "sum of costs, mean: " + joined(sums)});
  if (!lua.empty()) notes.push_back({"search", "functions in Lua, of the CPU time: " + joined(lua)});
  for (const std::size_t s : source.strategies()) {
    const RunsSummary& runs = overall(summary).strategies[s].runs;
    if (runs.beside.not_set_up + runs.beside.no_guided == 0) continue;
    notes.push_back({"search", summary.strategies[s].name + ": " + beside_text(runs)});
  }
  return notes;
}

/// What would decide the verdicts that are open, and the guides of a strategy together where that is another comparison
/// than with the baseline.
std::vector<AnswerNote> verdict_notes(const Source& source, const Answer& answer) {
  std::vector<AnswerNote> notes;
  const ExperimentSummary& summary = source.summary();
  for (const std::size_t s : source.strategies()) {
    const std::optional<WholeVerdict>& whole = overall(summary).strategies[s].whole;
    if (!whole || whole->reference == source.baseline() || !directed(whole->verdict)) continue;
    AnswerRow row;
    row.ratio = whole->verdict.ratio;
    notes.push_back({"verdict", fmt::format("all guides of {} together: {}, {} {} times the checks of {}",
                                            summary.strategies[s].name, answer_on_strategy(whole->verdict).word,
                                            row.ratio_text(), row.interval_text(), whole->reference)});
  }
  if (const AnswerTable* table = answer.table()) {
    for (const AnswerRow& row : table->rows) {
      if (row.verdict.more.empty()) continue;
      notes.push_back({"verdict", fmt::format("{}{}: {}; {}", row.indent > 0 ? row.strategy + " " : "", row.label,
                                              row.verdict.word, row.verdict.more)});
    }
    return notes;
  }
  std::map<std::string, std::size_t> budgets;
  for (const AnswerTable& table : answer.tables) {
    for (const AnswerRow& row : table.rows) {
      if (row.verdict.more.starts_with("budget spent")) ++budgets[row.verdict.more];
    }
  }
  for (const auto& [text, count] : budgets) {
    notes.push_back({"verdict", fmt::format("not shown in {}: {}", plural(count, "test"), text)});
  }
  return notes;
}

std::vector<AnswerNote> legend_notes(const Answer& answer) {
  if (answer.matrix) {
    const bool open = [&] {
      for (const auto* lines : {&answer.matrix->strategies, &answer.matrix->guides}) {
        for (const AnswerMatrix::Line& line : *lines) {
          for (const AnswerMatrix::Cell& cell : line.cells) {
            if (cell.ratio && !cell.shown) return true;
          }
        }
      }
      return false;
    }();
    if (!open) return {};
    return {{"legend",
             fmt::format("~ no difference shown (same seeds, sequential test, {:g} %)", 100.0 * sequential_error)}};
  }
  bool strategies = false;
  bool guides = false;
  bool intervals = false;
  bool cut_off = false;
  for (const AnswerRow& row : answer.table()->rows) {
    if (!row.ratio) continue;
    (row.indent > 0 ? guides : strategies) = true;
    intervals = intervals || !row.interval_text().empty();
    cut_off = cut_off || row.cut_off > 0;
  }
  if (!strategies && !guides) return {};
  std::string text = "ratio: ";
  if (strategies) text += fmt::format("checks ÷ {}'s", answer.baseline);
  if (guides) text += fmt::format("{}below a strategy ÷ the strategy's", strategies ? "; " : "checks ");
  text += "; same seeds";
  if (intervals) text += fmt::format(", [{:g} % interval]", 100.0 * (1.0 - sequential_error));
  std::vector<AnswerNote> notes = {{"legend", std::move(text)}};
  if (cut_off) notes.push_back({"legend", "≥: runs without the guide were cut off at so many checks"});
  return notes;
}

/// Suggests the next step.
std::string next_step(const Source& source) {
  const ExperimentSummary& experiment = source.summary();
  const std::vector<const ProblemSummary*> listed = experiment.listed();
  const std::vector<std::size_t> own = source.strategies();
  bool guided = false;
  std::vector<GuideVerdict> all;
  for (const ProblemSummary* problem : listed) {
    for (const std::size_t s : own) {
      const StrategySummary& strategy = problem->strategies[s];
      if (mostly_unsolved(strategy.runs)) {
        if (!problem->obstruction.empty()) return problem->obstruction;
        return fmt::format(
            "{} solves {} of {}: give its planner more `proposals`, or see --report levels for where it stopped",
            strategy.strategy, strategy.runs.solved, plural(strategy.runs.runs, "run"));
      }
    }
    for (const std::size_t s : own) {
      const StrategyFacts& facts = experiment.strategies[s];
      guided = guided || facts.guided;
      for (const GuideFacts& guide : facts.guides) {
        all.push_back(
            {problem->problem, facts.name, guide.key, guide.guide, guide_verdict(problem->strategies[s], guide.key)});
      }
    }
  }
  bool tested = true;
  double more_ablation = 0.0;
  const GuideVerdict* costly = nullptr;
  const GuideVerdict* open = nullptr;
  for (const GuideVerdict& one : all) {
    const Verdict& verdict = one.verdict;
    if (verdict.kind == Verdict::Kind::not_tested) tested = false;
    more_ablation = std::max(more_ablation, verdict.more_ablation);
    if (answer_on_guide(verdict).kind == Kind::bad && costly == nullptr) costly = &one;
    if (verdict.pairs_needed > 0 && (open == nullptr || verdict.pairs_needed < open->verdict.pairs_needed)) open = &one;
  }
  if (!guided) {
    if (experiment.strategies.size() > 1) return "--report full prints every figure";
    return fmt::format("put a guide before the planner, for instance {} >> {}",
                       experiment.spatial ? "workspace()" : "skeleton()", experiment.strategies.front().text);
  }
  if (costly != nullptr) {
    const double without = inverse(costly->verdict.ratio.median).lo;
    const std::string where = listed.size() > 1 ? " in " + costly->problem : "";
    return fmt::format("leave out {} of {}: without it the strategy takes {} the validity checks{}", costly->guide,
                       costly->strategy, without > 0.0 ? two_figures(without) + " times" : "a fraction of", where);
  }
  if (!tested && experiment.ablation == 0.0) {
    return "trellis run --ablation 2, or trellis sweep --ablate, tests which levels pay";
  }
  if (more_ablation > 0.0) {
    return fmt::format("--ablation {:g} allows more work for the test of which levels pay", more_ablation);
  }
  if (open != nullptr) {
    // A test of n seeds takes 2 n pairs.
    const std::size_t seeds = (open->verdict.pairs_needed + 1) / 2;
    if (seeds <= 4 * experiment.seeds.size()) {
      return fmt::format("--seeds {} would probably show whether {} of {} pays", seeds, open->guide, open->strategy);
    }
  }
  if (own.size() == 1) return "add a strategy without a guide to the experiment, to see what the guides save";
  return "--report full prints every figure; --html FILE shows the runs";
}

// The sentence -------------------------------------------------------------------------------------------------------

/// "9 times fewer", "15 % fewer", "2.2 times as many".
std::string fewer_text(const RatioBracket& ratio) {
  constexpr double half = 0.5;
  const double value = ratio.hi;
  if (value > 1.0) return two_figures(ratio.lo) + " times as many";
  if (value > half) return fmt::format("{:.0f} % fewer", 100.0 * (1.0 - value));
  const double times = 1.0 / value;
  return (times >= 3.0 && times < 99.5 ? fmt::format("{:.0f}", times) : two_figures(times)) + " times fewer";
}

/// "skeleton() and lazy() earn their place, shrink(0.5) does not".
/// \param guides  the rows without one, or the lines of the matrix
template <class Row>
std::string guides_text(const std::string& strategy, const std::vector<Row>& rows) {
  std::vector<std::string> good;
  std::vector<std::string> bad;
  std::size_t all = 0;
  for (const Row& row : rows) {
    if (row.strategy != strategy || row.guide.empty()) continue;
    ++all;
    const std::size_t from = row.label.find("without ");
    std::string name = row.label.substr(from + std::string("without ").size());
    if (row.verdict.kind == Kind::good)
      good.push_back(std::move(name));
    else if (row.verdict.kind == Kind::bad)
      bad.push_back(std::move(name));
  }
  if (all == 0) return "";
  if (good.size() == all && all > 1) {
    return all == 2 ? "both its guides earn their place" : fmt::format("all its {} guides earn their place", all);
  }
  std::string text;
  if (!good.empty()) text = joined(good, " and ") + (good.size() == 1 ? " earns its place" : " earn their place");
  if (!bad.empty()) {
    text += fmt::format("{}{} cost{} more than {} save{}", text.empty() ? "" : ", ", joined(bad, " and "),
                        bad.size() == 1 ? "s" : "", bad.size() == 1 ? "it" : "they", bad.size() == 1 ? "s" : "");
  }
  return text.empty() ? "no guide of it is shown to earn its place" : text;
}

std::string with_guides(const std::string& sentence, const std::string& guides) {
  return guides.empty() ? sentence : sentence + "; " + guides;
}

std::string table_sentence(const Source& source, const AnswerTable& table) {
  const AnswerRow* baseline = find_row(table, source.baseline(), "");
  const AnswerRow* first = nullptr;
  bool any = false;
  bool all_worse = true;
  for (const AnswerRow& row : table.rows) {
    if (row.indent > 0) continue;
    any = any || row.solved > 0;
    if (&row == baseline) continue;
    if (first == nullptr || (row.verdict.kind == Kind::good && first->verdict.kind != Kind::good)) first = &row;
    all_worse = all_worse && row.verdict.kind == Kind::bad;
  }
  if (!any) return "no run found a path";
  if (first == nullptr) first = baseline;
  if (first == nullptr) return "";
  const std::string guides = guides_text(first->strategy, table.rows);
  if (baseline == nullptr || first == baseline) {
    return with_guides(fmt::format("{} solves {} of {}, with {} validity checks in the median", first->label,
                                   first->solved, plural(first->runs, "run"), first->checks_text()),
                       guides);
  }
  if (first->verdict.kind == Kind::good && first->ratio) {
    const RatioBracket& ratio = first->ratio->median;
    if (ratio.hi == 0.0) {
      return with_guides(fmt::format("{} solves {} of {}, {} solves {}", first->label, first->solved,
                                     plural(first->runs, "run"), baseline->label, baseline->solved),
                         guides);
    }
    return with_guides(
        fmt::format("{} needs {} validity checks than {}", first->label, fewer_text(ratio), baseline->label), guides);
  }
  if (all_worse && first->ratio) {
    return fmt::format("no strategy needs fewer validity checks than {}: {} needs {}", baseline->label, first->label,
                       std::isinf(first->ratio->median.lo) ? "infinitely many" : fewer_text(first->ratio->median));
  }
  return fmt::format("no strategy is shown to need fewer validity checks than {}", baseline->label);
}

std::string matrix_sentence(const AnswerMatrix& matrix) {
  const AnswerMatrix::Line* best = nullptr;
  for (const AnswerMatrix::Line& line : matrix.strategies) {
    if (best == nullptr && line.verdict.kind == Kind::good) best = &line;
  }
  if (matrix.strategies.empty()) return guides_text(matrix.reference, matrix.guides);
  if (best == nullptr)
    return fmt::format("no strategy is shown to need fewer validity checks than {}", matrix.reference);
  const auto shown = std::count_if(best->cells.begin(), best->cells.end(), [](const AnswerMatrix::Cell& cell) {
    return cell.shown && cell.ratio && cell.ratio->hi < 1.0 / least_effect;
  });
  return with_guides(fmt::format("{} needs fewer validity checks than {} in {} of {} problems", best->label,
                                 matrix.reference, shown, best->cells.size()),
                     guides_text(best->strategy, matrix.guides));
}

bool any_verdict(const Answer& answer) {
  const auto decided = [](const AnswerRow& row) { return row.ratio.has_value(); };
  std::vector<const AnswerTable*> tables;
  for (const AnswerTable& table : answer.tables) tables.push_back(&table);
  return std::any_of(tables.begin(), tables.end(), [&](const AnswerTable* table) {
    return std::any_of(table->rows.begin(), table->rows.end(), decided);
  });
}

}  // namespace

std::string AnswerRow::solved_text() const {
  return runs == 0 ? "" : fmt::format("{}{}/{}", cut_off > 0 ? "≥" : "", solved, runs);
}

std::string AnswerRow::checks_text() const {
  if (std::isnan(checks.lo)) return "";
  if (std::isinf(checks.lo)) return "none";
  return (checks.lo < checks.hi ? "≥" : "") + thousands(checks.lo);
}

std::string AnswerRow::ratio_text() const { return ratio ? bracket_text(ratio->median) : ""; }

std::string AnswerRow::interval_text() const {
  if (!ratio || (ratio->interval.lo == 0.0 && std::isinf(ratio->interval.hi))) return "";
  return fmt::format("[{}, {}]", two_figures(ratio->interval.lo), two_figures(ratio->interval.hi));
}

std::string AnswerRow::ms_text() const {
  constexpr double exact = 0.1;
  constexpr double whole = 100.0;
  if (std::isnan(seconds)) return "";
  const double ms = 1000.0 * seconds;
  return std::isinf(ms) ? "none" : ms < exact ? two_figures(ms) : ms < whole ? fixed(ms, 1) : thousands(ms);
}

std::string AnswerRow::length_text() const {
  return std::isnan(length) ? "" : length < 1.0 ? two_figures(length) : fixed(length, 1);
}

double AnswerTable::most_checks() const {
  double most = 0.0;
  for (const AnswerRow& row : rows) {
    if (std::isfinite(row.checks.lo)) most = std::max(most, row.checks.lo);
  }
  return most;
}

std::string AnswerMatrix::Cell::text() const { return ratio ? bracket_text(*ratio) + (shown ? "" : "~") : ""; }

const AnswerTable* Answer::table() const {
  if (matrix) return nullptr;
  return together ? &*together : tables.empty() ? nullptr : &tables.front();
}

Answer answer_of(const ExperimentFacts& experiment, const ExperimentSummary& summary) {
  Answer answer;
  answer.baseline = summary.baseline;
  if (summary.problems.empty() || summary.strategies.empty()) return answer;
  const Source source(experiment, summary);
  for (const ProblemSummary& problem : summary.problems) answer.tables.push_back(table_of(source, problem));
  if (summary.together) {
    answer.together = table_of(source, *summary.together);
    if (summary.problems.size() <= most_single_problems) {
      answer.matrix = matrix_of(source, answer.tables);
    } else {
      answer.groups = groups_of(source, *answer.together);
    }
  }
  answer.title = answer.together ? answer.together->title : answer.tables.front().title;
  answer.sentence = answer.matrix ? matrix_sentence(*answer.matrix) : table_sentence(source, *answer.table());
  const auto add = [&](const char* topic, std::string text) {
    if (!text.empty()) answer.notes.push_back({topic, std::move(text)});
  };
  answer.notes = legend_notes(answer);
  for (std::string& text : unsolved_notes(source)) add("unsolved", std::move(text));
  for (std::string& text : warning_notes(summary)) add("warning", std::move(text));
  add("why", why_text(source));
  for (std::string& text : set_up_notes(source)) add("set-up", std::move(text));
  add("certified", certified_text(source));
  for (AnswerNote& note : search_notes(source)) answer.notes.push_back(std::move(note));
  for (AnswerNote& note : verdict_notes(source, answer)) answer.notes.push_back(std::move(note));
  if (any_verdict(answer)) add("verdict", verdicts_note());
  answer.next = next_step(source);
  return answer;
}

AnswerVerdict answer_on_strategy(const Verdict& verdict) { return answer_on(verdict, "pays", "costs"); }
AnswerVerdict answer_on_guide(const Verdict& verdict) { return answer_on(verdict, "keep it", "drop it"); }

MedianRatio inverse(const MedianRatio& ratio) { return {inverse(ratio.median), inverse(ratio.interval)}; }

}  // namespace trellis
