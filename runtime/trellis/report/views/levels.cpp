// SPDX-License-Identifier: GPL-3.0-or-later
// The report of levels: the search of each level, the verdict on it, and who needs coordination.
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

/// Longest name of a level, in columns, so that a row fits a line; the heading shows the full names.
constexpr std::size_t longest_label = 24;

Table::Column number_column(std::vector<std::string> heading, std::string group = "") {
  return {std::move(heading), std::move(group), false};
}
Table::Column text_column(std::string heading, std::string group = "") {
  return {{std::move(heading)}, std::move(group), true};
}

/// "nested = skeleton() >> rrt {}"
std::string equation(const StrategyFacts& strategy) {
  return strategy.name == strategy.text ? strategy.text : strategy.name + " = " + strategy.text;
}

/// One strategy of the script, which is no ablation.
struct Row {
  const ExperimentSummary::Strategy* strategy;
  const StrategySummary* of;

  [[nodiscard]] const std::string& name() const { return strategy->name; }
  [[nodiscard]] const RunsSummary& runs() const { return of->runs; }
  [[nodiscard]] std::string equation() const { return trellis::equation(*strategy); }
};

/// One problem, or all of them together, with the strategies of the script.
struct Section {
  const ProblemSummary* problem;
  const AnswerTable* table;
  std::string heading;
  std::string baseline;
  std::vector<Row> rows;
};

std::vector<Section> sections_of(const ExperimentSummary& experiment) {
  std::vector<Section> sections;
  for (const ProblemSummary* problem : experiment.listed()) {
    std::string heading = problem->problem;
    if (heading.empty()) {
      heading = fmt::format("{} problems together ({} … {})", experiment.problems.size(),
                            experiment.problems.front().problem, experiment.problems.back().problem);
    }
    const Answer& answer = experiment.answer;
    const auto named = std::find_if(answer.tables.begin(), answer.tables.end(),
                                    [&](const AnswerTable& one) { return one.problem == problem->problem; });
    const AnswerTable* table = named != answer.tables.end() ? &*named : &*answer.together;
    Section section{problem, table, std::move(heading), experiment.baseline, {}};
    for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
      if (!experiment.strategies[s].ablation.empty()) continue;
      section.rows.push_back({&experiment.strategies[s], &problem->strategies[s]});
    }
    sections.push_back(std::move(section));
  }
  return sections;
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

}  // namespace

std::string couplings_table(const StrategyFacts& strategy, const StrategySummary& of, std::size_t width,
                            std::size_t most) {
  std::vector<const CouplingSummary*> rows;
  for (const CouplingSummary& one : of.couplings) rows.push_back(&one);
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
  std::string out = wrap("Who needs coordination? " + equation(strategy), width, "", "  ") + table.text(width);
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

namespace {

/// Lists runs without a path, with the reasons, and strategies whose guides perform worse than no guide.
std::string warnings(const Section& section, std::size_t width) {
  std::string out;
  for (const Row& row : section.rows) {
    if (!row.of->unsolved.empty()) out += wrap(fmt::format("{}: {}", row.name(), row.of->unsolved), width, "", "  ");
  }
  for (const std::string& sentence : section.problem->warnings) out += wrap("warning: " + sentence, width, "", "  ");
  return out;
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
    out += (out.empty() ? "" : "\n") + heading_of(experiment, section, width) + answer_table(*section.table, width);
    for (const Row& row : section.rows) {
      const RunsSummary& runs = row.runs();
      const std::string verdict = levels_table(experiment.measured, row, width);
      out += '\n' + (verdict.empty() ? wrap(row.equation(), width, "", "  ") : verdict);
      out += wrap(fmt::format("solved {}/{} runs · {}", runs.solved, runs.runs, row.strategy->shares), width, "", "  ");
      out += search_table(runs, width) + resolves_lines(row, width) + rejections_text(row, width);
      const std::string couplings =
          couplings_table(*row.strategy, *row.of, width, std::numeric_limits<std::size_t>::max());
      if (!couplings.empty()) out += '\n' + couplings;
    }
    out += warnings(section, width);
  }
  return out + note_of(sections, width);
}

}  // namespace trellis
