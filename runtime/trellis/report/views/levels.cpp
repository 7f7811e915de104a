// SPDX-License-Identifier: GPL-3.0-or-later
// The report that a run prints: solved runs, costs relative to the baseline, the verdict on each level, and the next
// step.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <trellis/report/resolves.hpp>
#include <trellis/report/views/overview.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/report/views/tables.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

/// More tables of levels than these would not fit a screen: --report levels prints them.
constexpr std::size_t most_level_tables = 4;
/// Longest name of a level, in columns, so that a row fits a line; the heading shows the full names.
constexpr std::size_t longest_label = 24;

Table::Column number_column(std::vector<std::string> heading, std::string group = "") {
  return {std::move(heading), std::move(group), false};
}
Table::Column text_column(std::string heading, std::string group = "") {
  return {{std::move(heading)}, std::move(group), true};
}

/// One strategy of the script, which is no ablation.
struct Row {
  const ExperimentSummary::Strategy* strategy;
  const StrategySummary* of;

  [[nodiscard]] const std::string& name() const { return strategy->name; }
  [[nodiscard]] const RunsSummary& runs() const { return of->runs; }
  /// "nested = skeleton() >> rrt {}"
  [[nodiscard]] std::string equation() const {
    return strategy->name == strategy->text ? strategy->text : strategy->name + " = " + strategy->text;
  }
};

/// One problem, or all of them together, with the strategies of the script.
struct Section {
  const ProblemSummary* problem;
  std::string heading;
  std::string baseline;
  std::vector<Row> rows;
};

const Comparison* comparison_of(const Section& section, const std::string& strategy) {
  const std::vector<Comparison>& comparisons = section.problem->comparisons;
  const auto it =
      std::find_if(comparisons.begin(), comparisons.end(), [&](const Comparison& c) { return c.strategy == strategy; });
  return it != comparisons.end() ? &*it : nullptr;
}

std::vector<Section> sections_of(const ExperimentSummary& experiment) {
  std::vector<Section> sections;
  for (const ProblemSummary* problem : experiment.listed()) {
    std::string heading = problem->problem;
    if (heading.empty()) {
      heading = fmt::format("{} problems together ({} … {})", experiment.problems.size(),
                            experiment.problems.front().problem, experiment.problems.back().problem);
    }
    Section section{problem, std::move(heading), experiment.baseline, {}};
    for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
      if (!experiment.strategies[s].ablation.empty()) continue;
      section.rows.push_back({&experiment.strategies[s], &problem->strategies[s]});
    }
    sections.push_back(std::move(section));
  }
  return sections;
}

/// Returns a bar of eighths of a column, `share` of `width` columns long; never empty for a positive share.
std::string bar(double share, std::size_t width) {
  static constexpr std::array<const char*, 8> eighths = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  if (!(share > 0.0)) return "";
  const auto parts = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::lround(8.0 * std::min(share, 1.0) * static_cast<double>(width))));
  std::string text;
  for (std::size_t i = 0; i < parts / 8; ++i) text += "█";
  return text + eighths[parts % 8];
}

std::string strategies_table(const Section& section, std::size_t width) {
  constexpr std::size_t bar_width = 16;
  const bool compared = section.rows.size() > 1 && !section.baseline.empty();
  double most = 0.0;
  double slowest = 0.0;
  bool anytime = false;
  bool set_up = false;
  bool lua = false;
  for (const Row& row : section.rows) {
    anytime = anytime || !std::isnan(row.runs().improvement_checks);
    lua = lua || row.runs().lua_share > 0.0;
    set_up = set_up || row.runs().set_up_share > least_set_up_share;
    if (std::isfinite(row.runs().validity_checks.value)) most = std::max(most, row.runs().validity_checks.value);
    if (std::isfinite(row.runs().seconds.value)) slowest = std::max(slowest, 1000.0 * row.runs().seconds.value);
  }
  const std::string checks = "validity checks, median";
  std::vector<Table::Column> columns = {text_column("strategy"), number_column({"solved"}),
                                        number_column({anytime ? "first path" : ""}, checks), text_column("", checks)};
  if (anytime) columns.push_back(number_column({"improvement"}, checks));
  if (set_up) columns.push_back(number_column({"set-up,", "units"}));
  const std::string beside = "× " + section.baseline;
  if (compared) {
    columns.push_back(number_column({"checks [95 %]"}, beside));
    columns.push_back(number_column({"p"}, beside));
  }
  columns.push_back(number_column({"ms"}, "median"));
  if (lua) columns.push_back(number_column({"Lua %"}));
  const bool team = std::any_of(section.rows.begin(), section.rows.end(),
                                [](const Row& row) { return !std::isnan(row.runs().makespan.value); });
  columns.push_back(number_column({"path m"}, "mean"));
  if (team) columns.push_back(number_column({"makespan s"}, "mean"));
  if (team) columns.push_back(number_column({"sum of costs"}, "mean"));
  Table table(columns);
  for (const Row& row : section.rows) {
    const RunsSummary& s = row.runs();
    std::vector<std::string> cells = {row.name(), fmt::format("{}/{}", s.solved, s.runs),
                                      count_text(s.validity_checks.value),
                                      std::isfinite(s.validity_checks.value) && most > 0.0 && section.rows.size() > 1
                                          ? bar(s.validity_checks.value / most, bar_width)
                                          : ""};
    if (anytime) cells.push_back(std::isnan(s.improvement_checks) ? "" : count_text(s.improvement_checks));
    if (set_up) cells.push_back(s.set_up > 0.0 ? count_text(std::round(s.set_up)) : "");
    if (compared) {
      const Comparison* c = comparison_of(section, row.name());
      cells.push_back(row.name() == section.baseline ? "1" : c != nullptr ? ratio_text(c->validity_checks.ratio) : "-");
      cells.push_back(row.name() == section.baseline || c == nullptr ? "" : p_text(c->validity_checks.holm_p));
    }
    cells.push_back(milliseconds_text(s.seconds.value, decimals_for(slowest)));
    if (lua) cells.push_back(lua_share_text(s.lua_share));
    cells.push_back(std::isnan(s.length.value) ? "-" : fixed(s.length.value, 1));
    if (team) cells.push_back(std::isnan(s.makespan.value) ? "-" : fixed(s.makespan.value, 1));
    if (team) cells.push_back(std::isnan(s.sum_of_costs.value) ? "-" : fixed(s.sum_of_costs.value, 1));
    table.add(std::move(cells));
  }
  return table.text(width);
}

/// The nats of a level above uniform sampling.
struct Nats {
  Headline proposals, nodes;

  explicit Nats(const LevelSummary& level)
      : proposals(headline(level, SampleRole::expansion)), nodes(headline(level, SampleRole::tree)) {}
  [[nodiscard]] bool blank() const { return !proposals.above.blank.empty() || !nodes.above.blank.empty(); }
  [[nodiscard]] std::string mass() const {
    const double mass = nodes.uniform - nodes.mass;
    return nodes.runs > 0 && std::isfinite(mass) ? fixed(mass, 2, true) : "";
  }
};

std::string nats_text(const Headline& of) { return of.above.printed() ? ends_text(of.above.lo, of.above.hi) : ""; }

/// Joins the texts of the levels' proposals and nodes: "root proposals 1.05, nodes 0.42…0.61; lazy() proposals 2.4".
template <class Text>
std::string texts_of(const std::vector<LevelSummary>& levels, const Text& text) {
  std::string all;
  for (const LevelSummary& level : levels) {
    std::string of;
    for (const SampleRole role : {SampleRole::expansion, SampleRole::tree}) {
      const std::string one = text(level, role);
      if (one.empty()) continue;
      of += fmt::format("{}{} {}", of.empty() ? "" : ", ", role == SampleRole::tree ? "nodes" : "proposals", one);
    }
    if (!of.empty()) all += fmt::format("{}{} {}", all.empty() ? "" : "; ", level.name, of);
  }
  return all;
}

/// Explains the nats of a table: over what they are, and where single runs differ.
std::string nats_notes(const std::vector<LevelSummary>& levels, std::size_t width) {
  std::string notes;
  const auto add = [&](const std::string& note) {
    if (!note.empty()) notes += wrap(note, width, "  ", "  ");
  };
  const Headline root = headline(levels.front(), SampleRole::tree);
  const double perfect = root.uniform - root.perfect;
  std::string scale = std::isfinite(perfect)
                          ? fmt::format("nats: 0 is uniform sampling, {} perfect guidance", fixed(perfect, 2, true))
                          : "";
  if (root.seeds > 0) {
    scale += fmt::format("{}the samples of all {} seeds together", scale.empty() ? "nats: " : "; ", root.seeds);
  }
  add(scale);
  const std::string single = texts_of(levels, [](const LevelSummary& level, SampleRole role) -> std::string {
    const Headline together = headline(level, role);
    const AboveUniform alone = over_runs(level, role).above;
    return together.seeds > 0 && disagree(together.above, alone) ? ends_text(alone.lo, alone.hi) : "";
  });
  if (!single.empty()) add("single runs differ: " + single);
  if (std::any_of(levels.begin(), levels.end(), [](const LevelSummary& level) { return Nats(level).blank(); })) {
    add("blank: too few samples to show on which side of uniform sampling they are");
  }
  if (std::find(root.flags.begin(), root.flags.end(), "covers the space") != root.flags.end()) {
    add("the target covers nearly the whole space: perfect guidance and none are the same");
  }
  return notes;
}

/// Shortens a text to a number of columns; an ellipsis replaces the rest.
std::string shortened(const std::string& text, std::size_t columns) {
  if (display_width(text) <= columns) return text;
  std::string cut = text;
  // Removes whole code points: a continuation byte never ends a text.
  while (display_width(cut) >= columns) {
    while ((static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U) cut.pop_back();
    cut.pop_back();
  }
  return cut + "…";
}

/// Whether a strategy has a table of its levels: it has several, or a guide without a space.
bool has_levels_table(const Row& row) {
  const std::vector<LevelSummary>& levels = row.runs().levels;
  const bool unseen = std::any_of(row.of->parts.begin(), row.of->parts.end(), [](const GuideVerdict& one) {
    return one.verdict.kind == Verdict::Kind::never_set_up;
  });
  return levels.size() > 1 || (!levels.empty() && (unseen || !levels.front().parts.empty()));
}

/// Adds a row for each part of a level that has no level of its own.
void add_parts(Table& table, const Row& row, std::size_t level, std::size_t indent, std::size_t columns) {
  for (const PartSummary& part : row.runs().levels[level].parts) {
    std::vector<std::string> cells(columns);
    cells.front() = shortened(std::string(indent, ' ') + "+ " + part.name, longest_label);
    cells.back() = fmt::format("draws {} % of proposals", percent(part.share));
    std::vector<std::string> verdicts;
    for (const Verdict& one : verdicts_on(*row.of, level, part)) verdicts.push_back(verdict_text(one));
    if (!verdicts.empty()) cells.back() = fmt::format("{}; {}", fmt::join(verdicts, ", "), cells.back());
    table.add(std::move(cells));
  }
}

/// Returns the verdicts on guides that have no row, because no run set them up.
std::string unseen_guides(const Row& row, std::size_t width) {
  std::string out;
  for (const GuideVerdict& one : row.of->parts) {
    if (one.verdict.kind != Verdict::Kind::never_set_up) continue;
    out += wrap(fmt::format("{}: {}", one.guide, verdict_text(one.verdict)), width, "  ", "  ");
  }
  return out;
}

/// Returns the verdict on all guides of a strategy together, where there is one with a direction.
std::string whole_text(const Row& row, std::size_t width) {
  const auto& whole = row.of->whole;
  if (!whole || (whole->verdict.kind != Verdict::Kind::pays && whole->verdict.kind != Verdict::Kind::costs)) return "";
  return wrap(fmt::format("all guides together: {}, against {}", verdict_text(whole->verdict), whole->reference), width,
              "  ", "  ");
}

/// Whether a strategy has a verdict in its table, so that a note explains them.
bool has_verdict(const Row& row) {
  const auto decided = [](const Verdict& one) { return one.kind != Verdict::Kind::none && one.counts.pairs > 0; };
  return std::any_of(row.of->verdicts.begin(), row.of->verdicts.end(), decided) ||
         std::any_of(row.of->parts.begin(), row.of->parts.end(),
                     [&](const GuideVerdict& one) { return decided(one.verdict); });
}

/// Returns the table of the verdicts on one strategy's levels.
std::string levels_table(bool measured, const Row& row, std::size_t width) {
  const std::vector<LevelSummary>& levels = row.runs().levels;
  if (!has_levels_table(row)) return "";
  const std::vector<Verdict>& found = row.of->verdicts;
  const std::string share = "share, %";
  const std::string nats = "nats above uniform";
  std::vector<Table::Column> columns = {text_column("level"), number_column({"checks"}, share),
                                        number_column({"time"}, share)};
  if (measured) {
    columns.insert(columns.end(),
                   {number_column({"proposals"}, nats), number_column({"nodes"}, nats), number_column({"mass"}, nats)});
  }
  columns.push_back(text_column("verdict"));
  const std::vector<std::string> labels = level_labels(levels);
  Table table(columns);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    std::vector<std::string> cells = {shortened(labels[i], longest_label), percent(levels[i].check_share),
                                      percent(levels[i].time_share)};
    if (measured) {
      const Nats of(levels[i]);
      cells.insert(cells.end(), {nats_text(of.proposals), nats_text(of.nodes), of.mass()});
    }
    cells.push_back(i < found.size() ? verdict_text(found[i]) : "");
    table.add(std::move(cells));
    add_parts(table, row, i, display_width(labels[i]) - display_width(levels[i].name), columns.size());
  }
  std::string out = wrap("Which level pays? " + row.equation(), width, "", "  ") + table.text(width);
  out += unseen_guides(row, width) + whole_text(row, width);
  if (measured) out += nats_notes(levels, width);
  return out;
}

/// "schedule 3, one by one 8": what became of conflicts, in runs together.
std::string resolved_text(const CouplingSummary& coupling) {
  std::string text;
  for (std::size_t i = 0; i < coupling.resolved.size(); ++i) {
    if (coupling.resolved[i] == 0) continue;
    std::string name = resolved_names()[i];
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, coupling.resolved[i]);
  }
  return text;
}

/// "11/11 [0.74, 1.00]": the seeds that need a coupling, of those that are solved with it.
std::string needed_text(const CouplingSummary& coupling) {
  const auto seeds =
      static_cast<std::size_t>(std::lround(coupling.needed.value * static_cast<double>(coupling.needed.n)));
  if (coupling.needed.n == 0) return "0/0";
  return fmt::format("{}/{} [{:.2f}, {:.2f}]", seeds, coupling.needed.n, coupling.needed.lo, coupling.needed.hi);
}

/// Returns the table of who needs coordination.
/// \param most  rows; of the robots, and of the pairs, those that seeds need most remain
std::string couplings_table(const Row& row, std::size_t width, std::size_t most) {
  std::vector<const CouplingSummary*> rows;
  for (const CouplingSummary& one : row.of->couplings) rows.push_back(&one);
  if (rows.empty()) return "";
  std::stable_sort(rows.begin(), rows.end(), [](const CouplingSummary* a, const CouplingSummary* b) {
    if (a->robots.size() != b->robots.size()) return a->robots.size() < b->robots.size();
    if (a->needed.value != b->needed.value) return a->needed.value > b->needed.value;
    return a->conflicts > b->conflicts;
  });
  const std::size_t shown = std::min(most, rows.size());
  const std::string without = "passing through each other";
  Table table({text_column("robots"), number_column({"conflicts"}, without), number_column({"solved"}, without),
               number_column({"needed in [95 %]"}), number_column({"× checks"}), text_column("coordination"),
               text_column("conflicts resolved")});
  for (std::size_t i = 0; i < shown; ++i) {
    const CouplingSummary& one = *rows[i];
    const bool tested = one.pairs > 0;
    std::string name = one.name();
    if (one.robots.size() == 2) name = fmt::format("{}", fmt::join(one.robots, ", "));
    table.add({name, one.runs > 0 ? fmt::format("{}/{}", one.conflicts, one.runs) : "-",
               tested ? fmt::format("{}/{}", one.solved_without, one.pairs) : "-", tested ? needed_text(one) : "-",
               tested ? median_word(one.check_ratio.median) : "-", coupling_text(one), resolved_text(one)});
  }
  std::string out = wrap("Who needs coordination? " + row.equation(), width, "", "  ") + table.text(width);
  std::map<std::string, std::size_t> counts;
  for (std::size_t i = shown; i < rows.size(); ++i) {
    const std::string text = coupling_text(*rows[i]);
    ++counts[text.substr(0, text.find(" ("))];
  }
  for (const auto& [text, count] : counts) {
    out += wrap(fmt::format("and {} more: {}", plural(count, "row"), text), width, "  ", "  ");
  }
  if (rows.back()->verdict.kind == Verdict::Kind::not_tested) {
    out += wrap("--ablation allows more work for what was not tested", width, "  ", "  ");
  }
  return out;
}

/// Lists runs without a path, with the reasons, and strategies whose guides perform worse than no guide.
std::string warnings(const Section& section, std::size_t width) {
  std::string out;
  for (const Row& row : section.rows) {
    if (!row.of->unsolved.empty()) out += wrap(fmt::format("{}: {}", row.name(), row.of->unsolved), width, "", "  ");
  }
  for (const std::string& sentence : section.problem->warnings) out += wrap("warning: " + sentence, width, "", "  ");
  return out;
}

/// Suggests the next step, in one line.
std::string next_step(const ExperimentSummary& experiment, const std::vector<Section>& sections) {
  for (const Section& section : sections) {
    for (const Row& row : section.rows) {
      const RunsSummary& runs = row.runs();
      if (!mostly_unsolved(runs)) continue;
      if (!section.problem->obstruction.empty()) return section.problem->obstruction;
      return fmt::format(
          "{} solves {} of {}: give its planner more `proposals`, or see --report levels for where it "
          "stopped",
          row.name(), runs.solved, runs.runs == 1 ? "1 run" : fmt::format("{} runs", runs.runs));
    }
  }
  bool guided = false;
  bool tested = true;
  double more_ablation = 0.0;
  const GuideVerdict* costly = nullptr;
  const GuideVerdict* open = nullptr;
  std::vector<GuideVerdict> all;
  for (const Section& section : sections) {
    for (const Row& row : section.rows) {
      guided = guided || row.strategy->guided;
      for (std::size_t i = 0; i < row.of->verdicts.size(); ++i) {
        all.push_back({section.problem->problem, row.name(), "", row.runs().levels[i].name, row.of->verdicts[i]});
      }
      all.insert(all.end(), row.of->parts.begin(), row.of->parts.end());
    }
  }
  for (const GuideVerdict& one : all) {
    const Verdict& verdict = one.verdict;
    if (verdict.kind == Verdict::Kind::not_tested) tested = false;
    more_ablation = std::max(more_ablation, verdict.more_ablation);
    if (verdict.kind == Verdict::Kind::costs && costly == nullptr) costly = &one;
    if (verdict.pairs_needed > 0 && (open == nullptr || verdict.pairs_needed < open->verdict.pairs_needed)) open = &one;
  }
  if (!guided) {
    if (experiment.strategies.size() > 1) return "--report full prints every figure";
    return fmt::format("put a guide before the planner, for instance {} >> {}",
                       experiment.spatial ? "workspace()" : "skeleton()", experiment.strategies.front().text);
  }
  if (costly != nullptr) {
    const double without = 1.0 / costly->verdict.ratio.median.hi;
    return fmt::format("leave out {} of {}: without it the strategy takes {} the validity checks", costly->guide,
                       costly->strategy, without > 0.0 ? ratio_word(without) + " times" : "a fraction of");
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
  if (sections.front().rows.size() == 1) {
    return "add a strategy without a guide to the experiment, to see what the guides save";
  }
  return "--report full prints every figure; --html FILE shows the runs";
}

std::string heading_of(const ExperimentSummary& experiment, const Section& section, std::size_t width) {
  std::string heading = fmt::format("{} · {}", section.heading, seeds_text(experiment.seeds));
  if (!section.baseline.empty() && section.rows.size() > 1) heading += " · baseline: " + section.baseline;
  return wrap(heading, width, "", "  ");
}

/// Lists why levels were solved again, over the runs.
std::string resolves_lines(const Row& row, std::size_t width) {
  std::string out;
  for (const LevelSummary& level : row.runs().levels) {
    const std::string why = resolves_text(level);
    if (!why.empty()) out += wrap(fmt::format("{}: {}", level.name, why), width, "", "  ");
  }
  return out;
}

/// Names the obstacle that rejected most of each level's proposals, over the runs.
std::string rejections_text(const Row& row, std::size_t width) {
  const auto share = [](std::size_t part, std::size_t whole) {
    return percent(static_cast<double>(part) / static_cast<double>(whole)) + " %";
  };
  std::string out;
  for (const LevelSummary& level : row.runs().levels) {
    const RejectionsSummary& of = level.rejections;
    if (of.by.empty()) continue;
    const auto& [obstacle, count] = of.by.front();
    out += wrap(fmt::format("{}: {} of {} proposals rejected, {} of these by {}", level.name,
                            share(of.rejected, of.proposals), of.proposals, share(count, of.examined), obstacle),
                width, "", "  ");
  }
  return out;
}

/// Says for each strategy in how many runs its guides drew nothing, because the problem was solved first.
std::string undrawn_text(const Section& section, std::size_t width) {
  std::string out;
  for (const Row& row : section.rows) {
    const BesideSummary& beside = row.runs().beside;
    if (beside.not_set_up + beside.no_guided == 0) continue;
    out += wrap(row.name() + ": " + beside_text(row.runs()), width, "", "  ");
  }
  return out;
}

/// Says what the set-up of guides costs, where that has a column, and which runs share it.
std::string set_ups_text(const Section& section, std::size_t width) {
  std::vector<const RunsSummary*> runs;
  for (const Row& row : section.rows) runs.push_back(&row.runs());
  const std::string text = set_up_text(runs);
  return text.empty() ? "" : wrap(text, width, "", "  ");
}

/// Says that the paths are certified, and which one comes closest to contact.
std::string certificates_text(const Section& section, std::size_t width) {
  const Row* closest = nullptr;
  std::size_t paths = 0;
  for (const Row& row : section.rows) {
    const CertifiedSummary& certified = row.runs().certified;
    paths += certified.paths;
    if (certified.paths == 0) continue;
    if (closest == nullptr || certified.clearance < closest->runs().certified.clearance) closest = &row;
  }
  if (closest == nullptr || !std::isfinite(closest->runs().certified.clearance)) return "";
  return wrap(fmt::format("{} path{} certified free of contact; smallest clearance {:.2g} m ({}, seed {})", paths,
                          paths == 1 ? "" : "s", closest->runs().certified.clearance, closest->name(),
                          closest->runs().certified.seed),
              width, "", "  ");
}

/// Returns the note on the confidence in all verdicts; "" where there is none.
std::string note_of(const std::vector<Section>& sections, std::size_t width) {
  const bool any = std::any_of(sections.begin(), sections.end(), [](const Section& section) {
    return std::any_of(section.rows.begin(), section.rows.end(), has_verdict);
  });
  return any ? wrap(verdicts_note(), width, "\n", "  ") : "";
}

}  // namespace

std::string levels_report_text(const ExperimentSummary& experiment, std::size_t width) {
  const std::vector<Section> sections = sections_of(experiment);
  std::string out;
  for (const Section& section : sections) {
    out += (out.empty() ? "" : "\n") + heading_of(experiment, section, width);
    for (const Row& row : section.rows) {
      const RunsSummary& runs = row.runs();
      const std::string verdict = levels_table(experiment.measured, row, width);
      out += '\n' + (verdict.empty() ? wrap(row.equation(), width, "", "  ") : verdict);
      out += wrap(fmt::format("solved {}/{} runs · {}", runs.solved, runs.runs, row.strategy->shares), width, "", "  ");
      out += search_table(runs, width) + resolves_lines(row, width) + rejections_text(row, width);
      const std::string couplings = couplings_table(row, width, std::numeric_limits<std::size_t>::max());
      if (!couplings.empty()) out += '\n' + couplings;
    }
    out += warnings(section, width);
  }
  return out + note_of(sections, width);
}

std::string overview_text(const ExperimentSummary& experiment, std::size_t width) {
  const std::vector<Section> sections = sections_of(experiment);
  std::size_t tables = 0;
  for (const Section& section : sections) {
    for (const Row& row : section.rows) tables += has_levels_table(row) ? 1 : 0;
  }
  std::string out;
  for (const Section& section : sections) {
    out += (out.empty() ? "" : "\n") + heading_of(experiment, section, width) + strategies_table(section, width);
    out += certificates_text(section, width) + set_ups_text(section, width) + undrawn_text(section, width);
    out += warnings(section, width);
    for (const Row& row : section.rows) {
      constexpr std::size_t most_couplings = 16;
      if (const std::string table = couplings_table(row, width, most_couplings); !table.empty()) out += '\n' + table;
    }
    if (tables > most_level_tables) continue;
    for (const Row& row : section.rows) {
      if (const std::string table = levels_table(experiment.measured, row, width); !table.empty()) {
        out += '\n' + table;
      }
    }
  }
  if (tables > most_level_tables) {
    out += wrap(fmt::format("{} strategies with guides: --report levels says which of their levels pay", tables), width,
                "\n", "");
  } else {
    out += note_of(sections, width);
  }
  return out + '\n' + wrap(next_step(experiment, sections), width, "→ ", "  ") +
         wrap("more: --report levels, efficiency or full; `trellis help report` explains the columns", width, "  ",
              "  ");
}

}  // namespace trellis
