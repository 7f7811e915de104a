// SPDX-License-Identifier: GPL-3.0-or-later
// The page: this source writes its tables; html/report.js draws its runs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/printable.hpp>
#include <trellis/base/version.hpp>
#include <trellis/draw/palette.hpp>
#include <trellis/page/html.hpp>
#include <trellis/page/html_parts.hpp>
#include <trellis/pictures/packing.hpp>
#include <trellis/report/answer.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/resolves.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/verdict.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

/// The end of one run, in words.
struct HtmlOutcome {
  std::string text;
  bool solved = false;
  std::size_t run = 0;     ///< index into the runs of the experiment
  std::vector<double> at;  ///< s, of each configuration of a team's path
};

/// The ends of the runs of one problem and strategy, by seed.
using HtmlOutcomes = std::map<std::uint64_t, HtmlOutcome>;

struct HtmlContent {
  const ExperimentSummary& summary;
  std::vector<std::vector<HtmlOutcomes>> runs;  ///< by problem and strategy
  CostData costs;                               ///< without ablations
};

using Json = nlohmann::ordered_json;

/// Escapes text for the page: markup, and bytes that are not UTF-8.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : printable(text)) {
    switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  }
  return out;
}

// Tables
// ---------------------------------------------------------------------------------------------------------------

/// Returns "1.23 ±0.08", the latter smaller, with the interval's ends as a tooltip.
std::string interval_html(const Interval& interval, int decimals = 2, bool sign = false) {
  std::string text = interval_text(interval, decimals, sign);
  const std::size_t half = text.find(" ±");
  if (half == std::string::npos) return text;
  return fmt::format(R"(<span title="95 % interval {} to {}, of {}">{}<span class="pm">{}</span></span>)",
                     fixed(interval.lo, decimals, sign), fixed(interval.hi, decimals, sign), plural(interval.n, "run"),
                     text.substr(0, half), text.substr(half + 1));
}

/// The meanings of the marks in a table, for one legend below it.
class Marks {
 public:
  std::string of(const Figure& figure) {
    std::string out;
    if (figure["SE"].infinite > 0) add(median_mark, "infinite in some runs, so the median of all", "", out);
    for (const auto& [flag, runs] : figure.flags) {
      const char mark = mark_of(flag);
      const auto* const note = std::find_if(notes.begin(), notes.end(), [&](const Note& n) { return n.mark == mark; });
      const std::string meaning = note != notes.end() ? note->meaning : flag;
      add(mark, meaning, fmt::format("{}: {} of {}", flag, runs, plural(figure.scored, "run")), out);
    }
    return out;
  }
  [[nodiscard]] std::string text() const {
    std::string out;
    for (const auto& [mark, meaning] : meanings_) {
      out += fmt::format("{}<abbr>{}</abbr> {}", out.empty() ? "" : " · ", mark, escaped(meaning));
    }
    return out.empty() ? out : R"(<p class="muted">)" + out + "</p>\n";
  }

 private:
  void add(char mark, const std::string& meaning, const std::string& title, std::string& out) {
    meanings_.emplace(mark, meaning);
    out += fmt::format(R"(<abbr title="{}">{}</abbr>)", escaped(title.empty() ? meaning : title), mark);
  }
  std::map<char, std::string> meanings_;
};

/// Returns "+0.42…+1.20" ; blank where the samples do not support an interval.
std::string above_html(const AboveUniform& above) {
  if (std::isnan(above.lo)) return "-";
  if (!above.blank.empty()) return fmt::format(R"(<span class="muted" title="{}">blank</span>)", escaped(above.blank));
  if (!std::isfinite(above.lo)) return "-";
  const std::string text = ends_text(above.lo, above.hi);
  return above.exact ? fmt::format(R"(<span title="by recorded densities">{}</span>)", text) : text;
}

std::string figure_cell(const Figure& figure, Marks& marks) {
  return fmt::format(R"(<td class="figure">{}{}</td>)", above_html(above_uniform(figure)), marks.of(figure));
}

/// The figure of all seeds together.
std::string headline_cell(const LevelSummary& level, SampleRole role) {
  const Headline found = headline(level, role);
  const AboveUniform single = over_runs(level, role).above;
  std::string mark;
  if (found.seeds > 0 && disagree(found.above, single)) {
    mark = fmt::format(R"(<abbr title="single runs: {}">≠</abbr>)", ends_text(single.lo, single.hi));
  }
  const std::string nats = found.seeds > 0 || found.runs > 0 ? above_html(found.above) : "-";
  return fmt::format(R"(<td class="figure">{}{}</td>)", nats, mark);
}

std::string cell(const std::string& content) { return "<td>" + content + "</td>"; }

/// Returns validity checks, with the proposals as a tooltip.
std::string spent_cell(const SpentSummary& spent) {
  if (std::isnan(spent.validity_checks)) return cell("-");
  return fmt::format(R"(<td title="{} proposals">{}</td>)", count_text(spent.proposals),
                     count_text(spent.validity_checks));
}

std::string milliseconds(double seconds) { return milliseconds_text(seconds, decimals_for(1000.0 * seconds)); }

/// A heading of two rows: groups over columns.
struct Columns {
  std::string group;
  std::vector<std::string> names;
};

std::string heading(const std::string& first, const std::vector<Columns>& groups) {
  std::string above = fmt::format(R"(<tr><th rowspan="2" scope="col">{}</th>)", first);
  std::string below = "<tr>";
  for (const auto& [group, names] : groups) {
    if (group.empty()) {
      for (const auto& name : names) above += fmt::format(R"(<th rowspan="2" scope="col">{}</th>)", name);
      continue;
    }
    above += fmt::format(R"(<th colspan="{}" scope="colgroup" class="over">{}</th>)", names.size(), group);
    for (const auto& name : names) below += fmt::format(R"(<th scope="col">{}</th>)", name);
  }
  return "<thead>" + above + "</tr>\n" + below + "</tr></thead>\n";
}

const LevelSummary& root_of(const RunsSummary& summary) {
  static const LevelSummary none;
  return summary.levels.empty() ? none : summary.levels.front();
}

/// The optional columns of the table of strategies.
struct SummaryColumns {
  bool measured = false;
  bool pooled = false;   ///< scored all seeds together
  bool crossed = false;  ///< scored on other seeds' paths
  bool anytime = false;  ///< some planner continues after its first path
  bool set_up = false;   ///< the set-up of guides is a considerable part of some cost
  bool lua = false;      ///< some strategy has functions in Lua
};

std::string summary_row(const RunsSummary& s, const std::string& head, const std::string& attributes,
                        const SummaryColumns& columns, Marks& marks) {
  const auto& [measured, pooled, crossed, anytime, set_up, lua] = columns;
  std::string out = fmt::format(R"(<tr{}><th scope="row">{}</th><td>{}/{}<span class="pm">{}</span></td>)", attributes,
                                head, s.solved, s.runs, wilson_text(s.success));
  if (measured) {
    const LevelSummary& root = root_of(s);
    const FigurePair& own = root.root;
    const FigurePair& cross = root.root_cross;
    out += headline_cell(root, SampleRole::tree);
    out += figure_cell(own.tree, marks);
    if (crossed) out += figure_cell(cross.tree, marks);
    out += headline_cell(root, SampleRole::expansion);
    out += figure_cell(own.expansion, marks);
    if (crossed) out += figure_cell(cross.expansion, marks);
  }
  out += cell(count_text(s.validity_checks.value));
  if (anytime) out += cell(std::isnan(s.improvement_checks) ? "" : count_text(s.improvement_checks));
  if (set_up) out += cell(s.set_up > 0.0 ? count_text(std::round(s.set_up)) : "");
  out += cell(milliseconds(s.seconds.value));
  if (lua) out += cell(escaped(lua_share_text(s.lua_share)));
  return out + cell(interval_html(s.length)) + "</tr>\n";
}

/// "#0072b2".
std::string hex(const draw::Colour& colour) {
  const auto byte = [](double part) { return static_cast<int>(std::lround(255.0 * part)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(colour.r), byte(colour.g), byte(colour.b));
}

/// Returns a strategy's colour, that of the figures in Python: the baseline is grey, the others have theirs by their
/// place.
std::string strategy_colour(const CostData& data, const std::string& strategy) {
  if (strategy == data.baseline) return "var(--muted)";
  std::size_t place = 0;
  for (const CostData::Strategy& one : data.strategies) {
    // Black would not be seen on the page's dark ground.
    const draw::Colour colour = draw::palette::nth(place);
    if (one.name == strategy) return colour == draw::palette::black ? "var(--ink)" : hex(colour);
    if (one.name != data.baseline) ++place;
  }
  return "var(--muted)";
}

/// Returns a patch of a strategy's colour in the figures; none for an ablation.
std::string swatch(const CostData& data, const std::string& strategy) {
  if (std::none_of(data.strategies.begin(), data.strategies.end(),
                   [&](const CostData::Strategy& one) { return one.name == strategy; })) {
    return "";
  }
  return fmt::format(R"(<span class="swatch" style="background:{}"></span>)", strategy_colour(data, strategy));
}

/// Explains the columns of nats, and says where all seeds together and single runs disagree.
std::string nats_notes(const HtmlContent& content, bool pooled) {
  std::string out = fmt::format(
      "<p class=\"muted\">a…b: the interval that the samples support, with 95 %; blank: too few samples to show on "
      "which "
      "side of uniform sampling they are{}</p>\n",
      pooled ? "; all seeds: their samples together, on the paths of a seed left out" : "");
  std::string items;
  for (const ProblemSummary& problem : content.summary.problems) {
    for (const StrategySummary& strategy : problem.strategies) {
      for (const LevelSummary& level : strategy.runs.levels) {
        for (const SampleRole role : {SampleRole::tree, SampleRole::expansion}) {
          const Headline together = headline(level, role);
          const AboveUniform single = over_runs(level, role).above;
          if (together.seeds == 0 || !disagree(together.above, single)) continue;
          items += fmt::format("<li>{}, {}, {}, {}: all seeds {}, single runs {}</li>\n", escaped(problem.problem),
                               escaped(strategy.strategy), escaped(level.name),
                               role == SampleRole::tree ? "tree" : "expansion",
                               ends_text(together.above.lo, together.above.hi), ends_text(single.lo, single.hi));
        }
      }
    }
  }
  if (items.empty()) return out;
  return out +
         "<details class=\"muted\"><summary>≠: where single runs have other nats than all seeds together"
         "</summary>\n<ul>\n" +
         items + "</ul>\n</details>\n";
}

std::string summary_table(const HtmlContent& content) {
  SummaryColumns shown;
  const ExperimentSummary& experiment = content.summary;
  shown.measured = experiment.measured;
  for (const ProblemSummary& problem : experiment.problems) {
    for (const StrategySummary& one : problem.strategies) {
      const LevelSummary& root = root_of(one.runs);
      shown.pooled = shown.pooled || headline(root, SampleRole::tree).seeds > 0;
      shown.crossed = shown.crossed || root.root_cross.tree.scored > 0;
      shown.anytime = shown.anytime || !std::isnan(one.runs.improvement_checks);
      shown.lua = shown.lua || one.runs.lua_share > 0.0;
      shown.set_up = shown.set_up || one.runs.set_up_share > least_set_up_share;
    }
  }
  std::vector<Columns> columns = {{"", {"solved"}}};
  if (experiment.measured) {
    std::vector<std::string> paths = {shown.pooled ? "all seeds" : "headline", "own path"};
    if (shown.crossed) paths.emplace_back("other seeds’");
    columns.push_back({"above uniform, tree", paths});
    columns.push_back({"above uniform, expansion", paths});
  }
  Columns medians = {"medians", {shown.anytime ? "checks to first path" : "checks"}};
  if (shown.anytime) medians.names.emplace_back("checks of improvement");
  if (shown.set_up) medians.names.emplace_back("set-up, checks");
  medians.names.emplace_back("time, ms");
  columns.push_back(std::move(medians));
  if (shown.lua) columns.push_back({"of the time", {"Lua %"}});
  columns.push_back({"mean", {"path, m"}});
  std::size_t width = 1;
  for (const auto& group : columns) width += group.names.size();

  Marks marks;
  std::string body;
  const auto group = [&](const std::string& name) {
    body += fmt::format("<tr class=\"group\"><th colspan=\"{}\" scope=\"rowgroup\">{}</th></tr>\n", width, name);
  };
  if (experiment.together) {
    group("all scenes together");
    for (const StrategySummary& one : experiment.together->strategies) {
      body += summary_row(one.runs, swatch(content.costs, one.strategy) + escaped(one.strategy), "", shown, marks);
    }
  }
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) {
    group(escaped(experiment.problems[p].problem));
    for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
      const std::string place = fmt::format("{}-{}", p, s);
      const std::string& name = experiment.strategies[s].name;
      body += summary_row(
          experiment.problems[p].strategies[s].runs,
          swatch(content.costs, name) +
              fmt::format(R"(<button type="button" class="link" data-cell="{}">{}</button>)", place, escaped(name)),
          fmt::format(R"( data-cell="{}")", place), shown, marks);
    }
  }
  const bool tall = experiment.problems.size() * experiment.strategies.size() > 24;
  return fmt::format("<div class=\"scroll{}\"><table id=\"summary\">\n{}<tbody>\n{}</tbody></table></div>\n{}{}",
                     tall ? " tall" : "", heading("method", columns), body,
                     experiment.measured ? nats_notes(content, shown.pooled) : "", marks.text());
}

// The answer
// ---------------------------------------------------------------------------------------------------------------

/// Returns a number of the script's order of strategies or problems.
template <class List, class Name>
std::size_t place_of(const List& list, const Name& is) {
  return static_cast<std::size_t>(std::find_if(list.begin(), list.end(), is) - list.begin());
}
std::size_t strategy_place(const HtmlContent& content, const std::string& name) {
  return place_of(content.summary.strategies, [&](const auto& one) { return one.name == name; });
}
std::size_t problem_place(const HtmlContent& content, const std::string& name) {
  const std::size_t place = place_of(content.summary.problems, [&](const auto& one) { return one.problem == name; });
  return place < content.summary.problems.size() ? place : 0;
}

/// Returns the name of a strategy as a button that shows a run of it.
/// \param problem  "": the first one
std::string run_button(const HtmlContent& content, const std::string& problem, const std::string& strategy,
                       const std::string& text) {
  const std::size_t s = strategy_place(content, strategy);
  if (s >= content.summary.strategies.size()) return escaped(text);
  return fmt::format(R"(<button type="button" class="link" data-cell="{}-{}">{}</button>)",
                     problem_place(content, problem), s, escaped(text));
}

std::string verdict_html(const AnswerVerdict& verdict) {
  if (verdict.kind == AnswerVerdict::Kind::none) return "";
  constexpr std::array<const char*, 5> classes = {"", "good", "bad", "small", "open"};
  return fmt::format(R"(<span class="{}">{}</span>{})", classes.at(static_cast<std::size_t>(verdict.kind)),
                     escaped(verdict.word),
                     verdict.more.empty() ? "" : " <small>" + escaped(verdict.more) + "</small>");
}

/// The strategies, and below each the same without each of its guides.
std::string answer_rows(const HtmlContent& content, const AnswerTable& table) {
  const double most = table.most_checks();
  std::string body;
  for (const AnswerRow& row : table.rows) {
    const bool known = most > 0.0 && !std::isnan(row.checks.lo);
    const double full = known ? std::min(1.0, std::isfinite(row.checks.lo) ? row.checks.lo / most : 1.0) : 0.0;
    const std::string name =
        row.indent > 0 ? escaped(row.label) : run_button(content, table.problem, row.strategy, row.label);
    const std::string interval = row.interval_text();
    body += fmt::format(
        R"(<tr{}><th scope="row">{}</th><td>{}</td><td class="bar"><i{} style="width:{:.1f}%;background:{}"></i></td>)"
        R"(<td class="ratio">{}{}</td><td class="verdict">{}</td><td class="wide">{}</td><td class="wide">{}</td>)"
        R"(<td class="wide">{}</td></tr>)"
        "\n",
        row.indent > 0 ? R"( class="sub")" : "", name, escaped(row.checks_text()),
        std::isinf(row.checks.lo) ? R"( class="none")" : "", 100.0 * full, strategy_colour(content.costs, row.strategy),
        row.ratio ? "× " + escaped(row.ratio_text()) : "",
        interval.empty() ? "" : " <small>" + escaped(interval) + "</small>", verdict_html(row.verdict),
        escaped(row.solved_text()), escaped(row.ms_text()), escaped(row.length_text()));
  }
  return fmt::format(
      "<table class=\"answer rows\"><thead><tr><th></th><th scope=\"col\">checks</th><th></th><th scope=\"col\" "
      "class=\"left\">ratio <small>[95 %]</small></th><th></th><th scope=\"col\" class=\"wide\">solved</th><th "
      "scope=\"col\" class=\"wide\">ms</th><th scope=\"col\" class=\"wide\">path, m</th></tr></thead>\n<tbody>\n"
      "{}</tbody></table>\n",
      body);
}

/// The ratios of several problems.
std::string answer_matrix(const HtmlContent& content, const AnswerMatrix& matrix) {
  std::string head = "<tr><th></th>";
  for (const std::string& problem : matrix.problems) head += "<th scope=\"col\">" + escaped(problem) + "</th>";
  std::string body = fmt::format(R"(<tr><th scope="row">{}, checks</th>)", escaped(matrix.reference));
  for (const std::string& checks : matrix.checks) body += "<td>" + escaped(checks) + "</td>";
  body += "<td></td></tr>\n";
  const auto add = [&](const std::string& title, const std::vector<AnswerMatrix::Line>& lines) {
    if (lines.empty()) return;
    body += fmt::format("<tr class=\"group\"><th colspan=\"{}\" scope=\"rowgroup\">{}</th></tr>\n",
                        matrix.problems.size() + 2, escaped(title));
    for (const AnswerMatrix::Line& line : lines) {
      body +=
          fmt::format(R"(<tr><th scope="row">{}</th>)",
                      line.guide.empty() ? run_button(content, "", line.strategy, line.label) : escaped(line.label));
      for (const AnswerMatrix::Cell& one : line.cells) {
        body += fmt::format(R"(<td{}>{}</td>)", one.shown ? "" : R"( class="open")", escaped(one.text()));
      }
      body += fmt::format("<td class=\"verdict\">{}</td></tr>\n", verdict_html(line.verdict));
    }
  };
  add(fmt::format("÷ {}'s", matrix.reference), matrix.strategies);
  add("a guide left out, ÷ the whole strategy's", matrix.guides);
  return fmt::format(
      "<div class=\"scroll\"><table "
      "class=\"answer\"><thead>{}<th></th></tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
      head, body);
}

/// The groups of many problems.
std::string answer_groups(const HtmlContent& content, const AnswerGroups& groups) {
  std::string head = "<tr><th></th>";
  for (const auto& [name, problems] : groups.groups) {
    head += fmt::format("<th scope=\"col\">{} ({})</th>", escaped(name), problems);
  }
  std::string body;
  for (const AnswerGroups::Line& line : groups.lines) {
    body += fmt::format(R"(<tr><th scope="row">{}</th>)", run_button(content, "", line.strategy, line.strategy));
    for (const double ratio : line.ratios) body += cell(escaped(std::isnan(ratio) ? "–" : two_figures(ratio)));
    body += cell(fmt::format("{} of {}", line.cheaper, line.runs)) +
            cell(escaped(fmt::format("{} … {}", two_figures(line.lo), two_figures(line.hi)))) + "</tr>\n";
  }
  return fmt::format(
      "<div class=\"scroll\"><table class=\"answer\"><thead>{}<th scope=\"col\">cheaper</th><th scope=\"col\">10 … 90 "
      "% "
      "of runs</th></tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
      head, body);
}

std::string answer_html(const HtmlContent& content) {
  const Answer& answer = content.summary.answer;
  std::string out;
  if (answer.matrix) out += answer_matrix(content, *answer.matrix);
  if (const AnswerTable* table = answer.table()) out += answer_rows(content, *table);
  if (answer.groups && !answer.groups->lines.empty()) out += answer_groups(content, *answer.groups);
  out += "<div class=\"notes\">\n";
  std::string more;
  for (const AnswerNote& note : answer.notes) {
    const bool warns = note.topic == "warning" || note.topic == "unsolved";
    const bool details = note.topic == "verdict" || note.topic == "search";
    (details ? more : out) += fmt::format("<p{}>{}</p>\n", warns ? R"( class="bad")" : "", escaped(note.text));
  }
  if (!more.empty()) out += "<details><summary>about verdicts and searches</summary>\n" + more + "</details>\n";
  return out + "</div>\n";
}

/// The sentence of the answer, with the name of its strategy in bold.
std::string heading_html(const Answer& answer, const std::vector<ExperimentSummary::Strategy>& strategies,
                         const std::string& otherwise) {
  std::string name;
  for (const auto& one : strategies) {
    if (answer.sentence.starts_with(one.name) && one.name.size() > name.size()) name = one.name;
  }
  if (answer.sentence.empty()) return escaped(otherwise);
  std::string rest = answer.sentence.substr(name.size());
  if (name.empty() && rest.front() >= 'a' && rest.front() <= 'z') rest.front() += 'A' - 'a';
  return (name.empty() ? "" : "<b>" + escaped(name) + "</b>") + escaped(rest) +
         (answer.sentence.ends_with('.') ? "" : ".");
}

/// Returns the strategy whose run the page shows first: of those with guides the first of the answer, else the first.
std::size_t best_strategy(const HtmlContent& content) {
  const Answer& answer = content.summary.answer;
  std::vector<std::string> order;
  if (answer.matrix) {
    for (const auto& line : answer.matrix->strategies) order.push_back(line.strategy);
  }
  if (const AnswerTable* table = answer.table()) {
    for (const auto& row : table->rows) order.push_back(row.strategy);
  }
  for (const std::string& name : order) {
    const std::size_t place = strategy_place(content, name);
    if (place < content.summary.strategies.size() && content.summary.strategies[place].guided) return place;
  }
  return 0;
}

/// Returns the reasons why levels were solved again.
std::string resolves_html(const RunsSummary& summary) {
  std::string out;
  for (const LevelSummary& level : summary.levels) {
    const std::string why = resolves_text(level);
    if (!why.empty()) out += fmt::format("<p class=\"muted\">{}: {}</p>\n", escaped(level.name), escaped(why));
  }
  return out;
}

std::string level_table(const StrategySummary& of, bool measured) {
  const RunsSummary& summary = of.runs;
  const std::vector<Verdict>& found = of.verdicts;
  bool crossed = false;
  bool pooled = false;
  for (const auto& level : summary.levels) {
    crossed = crossed || level.root_cross.tree.scored > 0;
    pooled = pooled || headline(level, SampleRole::tree).seeds > 0;
  }
  std::vector<Columns> columns = {{"", {"space", "planner", "solved"}},
                                  {"medians", {"re-solves", "proposals", "nodes", "checks", "time, ms"}}};
  const bool guided =
      std::any_of(summary.levels.begin(), summary.levels.end(), [](const LevelSummary& l) { return l.guided; });
  if (guided) columns.push_back({"checks by, medians", {"guided proposals", "unguided proposals", "levels below"}});
  if (measured) {
    std::vector<std::string> paths = {pooled ? "all seeds" : "headline", "own space", "lifted"};
    if (crossed) paths.emplace_back("other seeds’");
    columns.push_back({"above uniform, tree", paths});
    columns.push_back({"above uniform, expansion", paths});
  }
  const bool judged = found.size() == summary.levels.size() && found.size() > 1;
  if (judged) columns.front().names.insert(columns.front().names.begin(), "verdict");
  Marks marks;
  std::string body;
  std::vector<int> depth;
  depth.reserve(summary.levels.size());
  for (std::size_t i = 0; i < summary.levels.size(); ++i) {
    const LevelSummary& level = summary.levels[i];
    depth.push_back(level.parent < 0 ? 0 : depth[static_cast<std::size_t>(level.parent)] + 1);
    std::string indent;
    for (int k = 0; k < depth.back(); ++k) indent += "&#160;&#160;";
    body +=
        fmt::format(R"(<tr><th scope="row">{}{}{}</th>)", indent, depth.back() > 0 ? "└ " : "", escaped(level.name));
    if (judged) body += cell(escaped(verdict_text(found[i])));
    body += cell(escaped(level.space)) + cell(escaped(level.planner)) +
            cell(fmt::format("{}/{}", level.solved, level.runs));
    for (const double count : {level.resolves, level.proposals, level.nodes, level.validity_checks}) {
      body += cell(count_text(count));
    }
    body += cell(milliseconds(level.seconds));
    if (guided) {
      for (const SpentSummary* spent : {&level.by_guided, &level.by_unguided, &level.by_below}) {
        body += spent_cell(*spent);
      }
    }
    if (measured) {
      for (const auto role : {&FigurePair::tree, &FigurePair::expansion}) {
        body += headline_cell(level, role == &FigurePair::tree ? SampleRole::tree : SampleRole::expansion);
        body += figure_cell(level.own.*role, marks) + figure_cell(level.root.*role, marks);
        if (crossed) body += figure_cell(level.root_cross.*role, marks);
      }
    }
    body += "</tr>\n";
  }
  std::string parts;
  if (const std::string set_up = set_up_text({&summary}); !set_up.empty()) {
    parts += fmt::format("<p class=\"muted\">{}</p>\n", escaped(set_up));
  }
  const std::string beside = beside_text(summary);
  for (const GuideVerdict& part : of.parts) {
    parts += fmt::format("<p class=\"muted\">{}: {}</p>\n", escaped(part.guide), escaped(verdict_text(part.verdict)));
  }
  if (of.whole && of.whole->verdict.kind != Verdict::Kind::not_shown) {
    parts += fmt::format("<p class=\"muted\">all guides together: {}, against {}</p>\n",
                         escaped(verdict_text(of.whole->verdict)), escaped(of.whole->reference));
  }
  if (judged) parts += fmt::format("<p class=\"muted\">{}</p>\n", escaped(verdicts_note()));
  return fmt::format("<div class=\"scroll\"><table>\n{}<tbody>\n{}</tbody></table></div>\n{}{}{}{}",
                     heading("level", columns), body, marks.text(), parts,
                     beside.empty() ? "" : fmt::format("<p class=\"muted\">{}</p>\n", escaped(beside)),
                     resolves_html(summary));
}

// Data
// -----------------------------------------------------------------------------------------------------------------

std::string script(const std::string& id, const std::string& json) {
  return fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", id, json);
}

/// The runs that the page contains.
struct HeldRuns {
  std::string scripts;
  std::map<std::size_t, std::size_t> ids;  ///< of the runs, by their index
  std::size_t seeds = 0;                   ///< the number of first seeds with all their runs
  std::size_t incomplete = 0;              ///< runs of the first seed, if the page contains only some of them
  std::size_t thinned = 0;                 ///< runs with only a part of their samples
};

/// A run in the format of the page.
struct PackedRun {
  std::string text;
  bool thinned = false;
};

/// Returns JSON for a <script> element: it contains no '<', whatever its strings are.
std::string script_text(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}
std::string script_json(const Json& json) {
  return script_text(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// Returns a run with all of its samples, or with as many as fit into `most` bytes.
PackedRun packed_within(const std::string& samples, std::size_t most) {
  constexpr double spare = 0.95;  // the packed size is not exactly proportional to the samples
  constexpr int attempts = 4;
  std::string text = script_text(samples);
  if (text.size() <= most) return {std::move(text), false};
  const Json whole = Json::parse(samples);
  double share = 1.0;
  for (int i = 0; i < attempts && text.size() > most; ++i) {
    share *= spare * static_cast<double>(most) / static_cast<double>(text.size());
    text = script_json(thinned_run(whole, share));
  }
  return {std::move(text), true};
}

/// \param most_bytes   for all of them
/// \param most_of_run  bytes of one run, beyond which it is thinned out
/// \param shown  the strategy whose first run the page shows: it has more room, since a part of a tree misleads
HeldRuns held_within(const ExperimentFacts& facts, RunSamples& samples, const HtmlOptions& options,
                     std::size_t most_bytes, std::size_t most_of_run, const std::string& shown) {
  std::map<std::uint64_t, std::vector<std::size_t>> by_seed;
  for (std::size_t i = 0; i < facts.runs.size(); ++i) by_seed[facts.runs[i].seed].push_back(i);
  HeldRuns held;
  std::size_t done = 0;
  for (const std::uint64_t seed : facts.seeds) {
    const auto& runs = by_seed[seed];
    std::vector<PackedRun> packed;
    packed.reserve(runs.size());
    std::size_t size = held.scripts.size();
    for (const std::size_t run : runs) {
      const bool first = seed == facts.seeds.front() && facts.runs[run].strategy == shown &&
                         facts.runs[run].problem == facts.problems.front().name;
      packed.push_back(packed_within(samples.run(run), first ? std::max(most_of_run, most_bytes / 3) : most_of_run));
      size += packed.back().text.size();
      if (options.progress) options.progress(++done, facts.runs.size());
    }
    std::vector<std::size_t> order(runs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const bool all = size <= most_bytes;
    if (!all) {
      if (held.seeds > 0) break;
      // If only one seed fits, add as many of its runs as fit.
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return packed[a].text.size() < packed[b].text.size(); });
    }
    for (const std::size_t i : order) {
      if (!all && held.scripts.size() + packed[i].text.size() > most_bytes) break;
      if (packed[i].text.empty()) continue;
      const std::size_t id = held.ids.size();
      held.ids.emplace(runs[i], id);
      held.scripts += script(fmt::format("run-{}", id), packed[i].text);
      if (packed[i].thinned) ++held.thinned;
    }
    if (!all) {
      held.incomplete = held.ids.size();
      break;
    }
    ++held.seeds;
  }
  return held;
}

/// Packs all runs completely if they fit into `most_bytes`. If not, thins long searches, so that no search displaces
/// other runs.
HeldRuns held_runs(const ExperimentFacts& facts, RunSamples& samples, const HtmlOptions& options,
                   std::size_t most_bytes, const std::string& shown) {
  HeldRuns whole = held_within(facts, samples, options, most_bytes, most_bytes, shown);
  if (whole.ids.size() == facts.runs.size()) return whole;
  constexpr std::size_t least = 20'000;  // bytes; a smaller search shows too little
  constexpr std::size_t seeds = 2;       // the page contains at least these, if `least` permits
  const std::size_t runs_of_seed =
      std::max<std::size_t>(1, facts.runs.size() / std::max<std::size_t>(1, facts.seeds.size()));
  return held_within(facts, samples, options, most_bytes, std::max(least, most_bytes / (seeds * runs_of_seed)), shown);
}

std::string held_text(const ExperimentFacts& facts, const HeldRuns& held, std::size_t most_bytes) {
  const std::string limit = fmt::format("{:.2g} MB", static_cast<double>(most_bytes) / 1e6);
  std::string text;
  if (held.ids.size() == facts.runs.size()) {
    if (held.thinned == 0) return "";
  } else if (held.seeds > 0) {
    const auto end = facts.seeds.begin() + static_cast<std::ptrdiff_t>(held.seeds);
    text = fmt::format("This file holds the samples of {}, of {} in all: those of all would take more than {}. ",
                       seeds_text({facts.seeds.begin(), end}), facts.seeds.size(), limit);
  } else {
    text = fmt::format(
        "This file holds the samples of the {} of {} whose records are smallest, of the first seed: "
        "those of all would take more than {}. ",
        plural(held.incomplete, "run"), facts.runs.size(), limit);
  }
  if (held.thinned > 0) {
    text +=
        fmt::format("Of {} this file holds a part of the samples, evenly spread; the table of levels says how many. ",
                    plural(held.thinned, "long run"));
  }
  return R"(<p class="note">)" + escaped(text) + "The tables are of all runs.</p>";
}

/// Returns the problems as the page's script reads them: a scene, with its world in the plane, start and goals.
Json problems_json(const ExperimentFacts& facts) {
  const Json worlds = Json::parse(facts.scenery.worlds);
  const Json described = Json::parse(facts.description).at("problems");
  Json problems = Json::array();
  for (const Json& scene : Json::parse(facts.scenery.scenes)) {
    const Json& problem = described.at(problems.size());
    Json one = {{"name", scene.at("problem")}, {"bounds", nullptr}, {"obstacles", Json::array()}};
    one["start"] = problem.at("start");
    one["goals"] = Json::array({problem.at("goal")});
    for (const Json& goal : problem.value("further_goals", Json::array())) one["goals"].push_back(goal);
    one["position"] = scene.at("position");
    one["robot"] = scene.at("robot").is_null() ? Json(-1) : scene.at("robot");
    if (scene.contains("team")) {
      one["traces"] = scene.at("traces");
      one["team"] = scene.at("team");
      for (std::size_t i = 0; i < one["team"].size(); ++i) one["team"][i]["colour"] = hex(draw::palette::robot(i));
    }
    if (!scene.at("world").is_null()) {
      const Json& world = worlds.at(scene.at("world").get<std::size_t>());
      one["bounds"] = world.at("bounds");
      if (world.at("dimension") == 2) {
        one["obstacles"] = world.at("obstacles");
      } else {
        one["world"] = scene.at("world");
        one["view"] = world.at("view");
      }
    }
    problems.push_back(std::move(one));
  }
  return problems;
}

/// The table of who needs coordination, "" for no team.
std::string couplings_table(const StrategySummary& of) {
  if (of.couplings.empty()) return "";
  std::string body;
  for (const CouplingSummary& one : of.couplings) {
    const bool tested = one.pairs > 0;
    body +=
        fmt::format(R"(<tr><th scope="row">{}</th>)", escaped(one.name())) + cell(escaped(coupling_text(one))) +
        cell(fmt::format("{}/{}", one.conflicts, one.runs)) +
        cell(tested ? fmt::format("{}/{}", one.solved_without, one.pairs) : "–") +
        cell(one.needed.n > 0 ? fmt::format("{} % ({})", percent(one.needed.value), wilson_text(one.needed)) : "–") +
        cell(tested ? median_word(one.check_ratio.median) : "–") + "</tr>\n";
  }
  const std::vector<Columns> columns = {
      {"", {"coordination"}}, {"passing through each other", {"conflicts", "solved"}}, {"", {"needed", "× checks"}}};
  return fmt::format(
      "<p class=\"muted\">Who needs coordination? Each row is of runs in which these robots pass through each other "
      "during "
      "the search.</p>\n<div class=\"scroll\"><table>\n{}<tbody>\n{}</tbody></table></div>\n",
      heading("robots", columns), body);
}

/// The tables of levels, of each problem and strategy.
std::string levels_templates(const ExperimentSummary& experiment) {
  std::string out;
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) {
    for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
      const StrategySummary& one = experiment.problems[p].strategies[s];
      out += fmt::format("<template id=\"levels-{}-{}\">{}</template>\n", p, s,
                         level_table(one, experiment.measured) + couplings_table(one));
    }
  }
  return out;
}

/// The costs of the runs on each problem, for charts.js.
std::string costs_scripts(const HtmlContent& content) {
  const CostData& data = content.costs;
  std::string out;
  for (std::size_t p = 0; p < data.problems.size(); ++p) {
    Json strategies = Json::array();
    for (std::size_t s = 0; s < data.strategies.size(); ++s) {
      Json runs = Json::array();
      for (const CostData::Run& run : data.runs) {
        if (run.problem != p || run.strategy != s) continue;
        // Four digits: a pixel is more.
        Json ms;
        if (!std::isnan(run.first_seconds)) ms = std::stod(fmt::format("{:.4g}", 1e3 * run.first_seconds));
        runs.push_back({run.checks - run.improvement_checks, std::move(ms), run.solved, std::to_string(run.seed)});
      }
      if (runs.empty()) continue;
      const std::string& name = data.strategies[s].name;
      strategies.push_back({{"name", name}, {"colour", strategy_colour(data, name)}, {"runs", std::move(runs)}});
    }
    if (!strategies.empty()) out += script(fmt::format("costs-{}", p), script_json(strategies));
  }
  return out;
}

/// What the page's script draws beside the runs.
struct PageData {
  Json problems;       ///< as problems_json() returns them
  std::string worlds;  ///< JSON, as Scenery::worlds
  std::string robots;  ///< likewise
};

std::string data_scripts(const HtmlContent& content, PageData page, const HeldRuns& held) {
  Json strategies = Json::array();
  for (const ExperimentSummary::Strategy& one : content.summary.strategies)
    strategies.push_back({{"name", one.name}, {"text", one.text}});
  Json cells = Json::array();
  for (const auto& of_problem : content.runs) {
    Json row = Json::array();
    for (const HtmlOutcomes& outcomes : of_problem) {
      Json runs = Json::array();
      for (const std::uint64_t seed : content.summary.seeds) {
        const auto at = outcomes.find(seed);
        if (at == outcomes.end()) {
          runs.push_back({{"id", -1}, {"text", "no such run"}});
          continue;
        }
        const auto id = held.ids.find(at->second.run);
        const bool in_file = id != held.ids.end();
        runs.push_back({{"id", in_file ? static_cast<int>(id->second) : -1},
                        {"text", at->second.text},
                        {"solved", at->second.solved}});
        if (in_file && !at->second.at.empty()) runs.back()["at"] = at->second.at;
      }
      row.push_back({{"runs", std::move(runs)}});
    }
    cells.push_back(std::move(row));
  }
  Json classes = Json::array();
  for (int c = 0; c < 5; ++c) classes.push_back(to_string(static_cast<NodeClass>(c)));
  // Seeds as text: a number in JavaScript has 53 bits.
  Json seeds = Json::array();
  for (const std::uint64_t seed : content.summary.seeds) seeds.push_back(std::to_string(seed));
  Json data = {
      {"problems", std::move(page.problems)}, {"strategies", std::move(strategies)}, {"seeds", std::move(seeds)},
      {"robots", Json::parse(page.robots)},   {"classes", std::move(classes)},       {"cells", std::move(cells)},
      {"best", best_strategy(content)}};
  if (Json worlds = Json::parse(page.worlds); !worlds.empty()) data["worlds"] = std::move(worlds);
  return script("data", script_json(data)) + held.scripts;
}

/// "solved, path of 14.42 m · 433 validity checks · 0.4 ms".
std::string outcome_text(const RunFacts& run) {
  std::string text = run.solved ? fmt::format("solved, path of {} m", fixed(run.length, 2))
                                : fmt::format("not solved: {}", to_string(run.status));
  const double duration = run.trajectory.dt > 0.0 ? run.trajectory.duration() : 0.0;
  if (duration > 0.0) text += fmt::format(", driven in {} s", fixed(duration, 1));
  return text + fmt::format(" · {} validity checks · {} ms", run.validity_checks, milliseconds(run.seconds));
}

HtmlContent content_of(const ExperimentFacts& experiment, const ExperimentSummary& summary) {
  HtmlContent content{summary, {}, cost_data(experiment, summary)};
  for (const ProblemFacts& problem : experiment.problems) {
    std::vector<HtmlOutcomes>& row = content.runs.emplace_back();
    for (const StrategyFacts& strategy : experiment.strategies) {
      HtmlOutcomes& outcomes = row.emplace_back();
      for (const RunFacts* run : experiment.select(problem.name, strategy.name)) {
        outcomes.emplace(run->seed, HtmlOutcome{outcome_text(*run), run->solved,
                                                static_cast<std::size_t>(run - experiment.runs.data()),
                                                run->times ? run->times->at : std::vector<double>{}});
      }
    }
  }
  return content;
}

/// What was run, below the answer.
std::string about_text(const HtmlContent& content) {
  const ExperimentSummary& experiment = content.summary;
  std::string text = experiment.answer.title;
  if (experiment.problems.size() == 1 && !experiment.problems.front().strategies.empty()) {
    const RunsSummary& runs = experiment.problems.front().strategies.front().runs;
    if (!runs.levels.empty()) text += " · " + runs.levels.front().space;
  }
  return text + " · " + (experiment.script.empty() ? "" : experiment.script + ", ") + "Trellis " + experiment.version;
}

/// Replaces the page's @PLACES@. Does not expand the inserted text again.
std::string filled(std::string_view page, const std::map<std::string_view, std::string>& places) {
  std::string out;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t begin = page.find('@', at);
    const std::size_t end = begin == std::string_view::npos ? begin : page.find('@', begin + 1);
    if (end == std::string_view::npos) {
      out += page.substr(at);
      break;
    }
    const auto place = places.find(page.substr(begin + 1, end - begin - 1));
    if (place == places.end()) throw Fault("the page has a place that nothing fills");
    out += page.substr(at, begin - at);
    out += place->second;
    at = end + 1;
  }
  return out;
}

/// The parts of the page that all results have.
struct Tables {
  std::string summary;
  std::string worth;
};
Tables tables_of(const HtmlContent& content) {
  return {summary_table(content), levels_templates(content.summary) + costs_scripts(content)};
}

/// \param viewers  the scripts between the charts' and the page's that its problems need
std::string page_of(const HtmlContent& content, const Tables& tables, const std::string& notes, const std::string& data,
                    const std::string& viewers = "") {
  const HtmlParts& parts = html_parts();
  return filled(parts.page,
                {{"TITLE", escaped(content.summary.script.empty() ? "Trellis" : "Trellis: " + content.summary.script)},
                 {"HEADING", heading_html(content.summary.answer, content.summary.strategies, "Trellis: results")},
                 {"ABOUT", escaped(about_text(content))},
                 {"ANSWER", answer_html(content)},
                 {"SUMMARY_TITLE", content.summary.measured
                                       ? "Efficiency <span>nats above uniform sampling, all strategies</span>"
                                       : "Medians <span>all strategies and problems</span>"},
                 {"STYLE", std::string(parts.style)},
                 {"SUMMARY", tables.summary},
                 {"NOTES", notes},
                 {"DATA", tables.worth + data},
                 {"SCRIPT", std::string(parts.charts) + viewers + std::string(parts.script)}});
}

}  // namespace

std::string report_html(const ExperimentFacts& facts, const ExperimentSummary& summary, RunSamples* samples,
                        const HtmlOptions& options) {
  // A page opens within a second up to 5 MB. The runs get the rest of that size.
  constexpr std::size_t most_of_page = 5'000'000;
  constexpr std::size_t bytes_of_outcome = 200;  // of a run, with or without its samples
  const HtmlParts& parts = html_parts();
  const HtmlContent content = content_of(facts, summary);
  const Tables tables = tables_of(content);
  if (samples == nullptr) {
    Json problems = Json::array();
    for (const ProblemSummary& one : summary.problems) problems.push_back({{"name", one.problem}, {"bounds", nullptr}});
    const std::string note = fmt::format(
        "This page is made of {}, which has no samples: it replays no run. `trellis run --html` writes a page that "
        "does, and so does `trellis report` where the runs have stored their samples (--samples, --out).",
        options.document);
    return page_of(content, tables, R"(<p class="note">)" + escaped(note) + "</p>",
                   data_scripts(content, {std::move(problems), "[]", "[]"}, {}));
  }
  PageData data{problems_json(facts), facts.scenery.worlds, ""};
  const bool in_space =
      std::any_of(data.problems.begin(), data.problems.end(), [](const Json& one) { return one.contains("world"); });
  const bool teams =
      std::any_of(data.problems.begin(), data.problems.end(), [](const Json& one) { return one.contains("team"); });
  const std::string viewers = std::string(in_space ? parts.space : "") + std::string(teams ? parts.teams : "");
  const std::size_t viewer = viewers.size() + (in_space ? data.worlds.size() : 0);
  const std::size_t rest = parts.page.size() + parts.style.size() + parts.charts.size() + parts.script.size() +
                           tables.summary.size() + tables.worth.size() + bytes_of_outcome * facts.runs.size() + viewer;
  const std::size_t most_bytes = std::min(options.most_bytes, most_of_page - std::min(most_of_page, rest));
  const HeldRuns held = held_runs(facts, *samples, options, most_bytes,
                                  summary.strategies.empty() ? "" : summary.strategies.at(best_strategy(content)).name);
  data.robots = samples->robots();
  if (!in_space) data.worlds = "[]";
  return page_of(content, tables, held_text(facts, held, most_bytes), data_scripts(content, std::move(data), held),
                 viewers);
}

void write_html(const ExperimentFacts& facts, const ExperimentSummary& summary, RunSamples* samples,
                const std::string& path, const HtmlOptions& options) {
  write_file(path, report_html(facts, summary, samples, options));
}

}  // namespace trellis
