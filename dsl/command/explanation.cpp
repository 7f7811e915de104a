// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/explanation.hpp>
#include <trellis/base/version.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <trellis/planner/common_options.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/report/words.hpp>
#include <trellis/strategy/combinators.hpp>
#include <trellis/strategy/executor.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

// Words
// ----------------------------------------------------------------------------------------------------------------

constexpr const char* default_mark = " (default)";

std::string percent(double share) { return fmt::format("{:.4g} %", 100.0 * share); }

std::string count(double number) { return std::isinf(number) ? "unlimited" : fmt::format("{:.15g}", number); }

/// "level 1", "levels 1 and 2", "levels 1, 3 and 4".
std::string levels_text(const std::vector<int>& numbers) {
  if (numbers.size() == 1) return fmt::format("level {}", numbers.front());
  const std::vector<int> first(numbers.begin(), numbers.end() - 1);
  return fmt::format("levels {} and {}", fmt::join(first, ", "), numbers.back());
}

/// Returns "step = 0.5 m", on one line. Omits units that are no unit of measurement: the option's name states what it
/// counts.
std::string option_text(const Option& option, const OptionValue& value) {
  constexpr std::size_t longest_symbol = 3;  // m, s, rad
  const std::string symbol = option.unit.substr(0, option.unit.find(' '));
  const bool number = std::holds_alternative<double>(value);
  std::string text = fmt::format("{} = {}{}", option.name, to_string(value),
                                 number && !symbol.empty() && symbol.size() <= longest_symbol ? " " + symbol : "");
  if (!std::holds_alternative<std::vector<std::string>>(value)) std::replace(text.begin(), text.end(), ' ', no_break);
  return text;
}

/// "scale = 0.5; by default radius = 0 m, evidence = 60". \param left_out  options that other lines show
std::string options_text(const Component& component, const Options& options,
                         bool (*left_out)(std::string_view) = nullptr) {
  std::string given;
  std::string defaults;
  for (const auto& [name, value] : options.entries()) {
    if (left_out != nullptr && left_out(name)) continue;
    const Option& option = *component.find(name);
    std::string& list = value == option.default_value ? defaults : given;
    list += (list.empty() ? "" : ", ") + option_text(option, value);
  }
  if (defaults.empty()) return given;
  return (given.empty() ? "by default " : given + "; by default ") + defaults;
}

/// Returns the text of a claim with each option's name in backquotes followed by its value: "`evidence` = 60 blocked
/// proposals".
std::string with_values(const std::string& text, const Options& options) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t begin = text.find('`', i);
    const std::size_t end = begin == std::string::npos ? begin : text.find('`', begin + 1);
    if (end == std::string::npos) return out + text.substr(i);
    out += text.substr(i, end + 1 - i);
    const std::string name = text.substr(begin + 1, end - begin - 1);
    const auto& entries = options.entries();
    const auto found =
        std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first == name; });
    if (found != entries.end()) out += fmt::format(" ({})", to_string(found->second));
    i = end + 1;
  }
  return out;
}

/// "x, y in [0, 10], theta periodic in [-3.142, 3.142) with weight 0.3183".
std::string axes_text(const Space& space) {
  std::string text;
  const auto& factors = space.factors();
  for (std::size_t i = 0; i < factors.size();) {
    const Axis& axis = factors[i].axis;
    if (!text.empty()) text += "; ";
    if (factors[i].kind == Factor::Kind::rotation) {
      text += axis.name;
      ++i;
    } else {
      std::vector<std::string> names;
      for (; i < factors.size(); ++i) {
        Axis same = factors[i].axis;
        same.name = axis.name;
        if (!(same == axis) || factors[i].kind == Factor::Kind::rotation) break;
        names.push_back(factors[i].axis.name);
      }
      text += fmt::format("{} {}in [{:.4g}, {:.4g}{}", fmt::join(names, ", "), axis.periodic ? "periodic " : "",
                          axis.lo, axis.hi, axis.periodic ? ")" : "]");
    }
    if (axis.weight != 1.0) text += fmt::format(", weight {:.4g}", axis.weight);
  }
  return text;
}

std::string space_text(const LevelExplanation& level) {
  std::string text =
      fmt::format("{}, {}: {}", level.space.name(), plural(level.space.degrees(), "dimension"), axes_text(level.space));
  if (level.goals > 1) text += fmt::format("; {} goals", level.goals);
  return text;
}

std::string motions_text(const LevelExplanation& level) {
  if (level.graph) {
    return fmt::format("along the edges of an explicit graph: {} vertices, {} edges", level.graph->vertices,
                       level.graph->edges);
  }
  return level.motion_model.empty() ? "straight" : level.motion_model;
}

/// States which instance counts the checks of a level's space. \param above  the number of the level that it guides
std::string checks_text(const LevelExplanation& level, int above) {
  const std::string collision =
      fmt::format("collision checks ({}), one each {:g} m of a motion", level.collision, level.resolution);
  std::string text;
  if (level.presumed) {
    text = "none: this space presumes that everything is valid";
  } else if (level.graph && level.graph->verified) {
    text = fmt::format(
        "start, goal and the motions that join them to the graph count at level {}; all other edges are known to be "
        "valid",
        level.number);
  } else {
    text = fmt::format("{}, count at level {}", collision, level.number);
    if (level.shared_resolution > 0.0 && level.guide) {
      text += fmt::format(
          "; motions towards guided proposals are checked with the robot and world of level {} first, which counts "
          "here too, and level {} does not check them again",
          above, above);
    }
  }
  if (level.guide && !level.presumed) {
    text += fmt::format("; what h validates in this space counts at level {}, as guided work", level.number);
  }
  return text;
}

const OptionValue& default_of(const PlannerKind& kind, std::string_view option) {
  return kind.component->find(option)->default_value;
}

/// "0.8 (default)".
std::string marked(const LevelExplanation& level, std::string_view option, double value) {
  return count(value) + (default_of(*level.kind, option) == OptionValue(value) ? default_mark : "");
}

/// Whether the planner runs beside the guided search, without guides.
bool has_companion(const LevelExplanation& level) {
  return level.number == 0 && level.guide && level.common.bound > 1.0;
}

std::string proposals_text(const LevelExplanation& level) {
  if (!level.guide && level.kind->graph) return "none: without a guide the search is exact";
  const double goal = level.common.goal_bias;
  const double uniform = (1.0 - goal) * (level.guide ? level.common.uniform : 1.0);
  std::vector<std::string> shares;
  if (goal > 0.0) shares.push_back(percent(goal) + " are the goal");
  if (uniform > 0.0) shares.push_back(percent(uniform) + " uniform");
  if (!level.guide) return fmt::format("{}", fmt::join(shares, ", "));
  shares.push_back(percent(1.0 - goal - uniform) + " from h");
  std::vector<std::string> closed;
  if (!level.below.empty()) closed.emplace_back("the search below is unfinished");
  if (level.common.bound > 0.0 && !has_companion(level)) closed.emplace_back("the bound is reached");
  return fmt::format(
      "{}{}", fmt::join(shares, ", "),
      closed.empty() ? "" : fmt::format("; the share of h is uniform too while {}", fmt::join(closed, " or ")));
}

std::string bound_text(const LevelExplanation& level) {
  if (level.common.bound <= 0.0) return "none (bound = 0): h draws its share whatever it costs";
  if (has_companion(level)) {
    return fmt::format(
        "a run costs at most {} times the checks of {} without guides on the same seed, plus {:g} checks, and at most "
        "so many times its work, plus {:g} units; {} runs beside the guided search, and the "
        "first path ends the run; work is CPU time by a model: checks, proposals, searches of graphs, and the set-up "
        "of "
        "guides",
        marked(level, "bound", level.common.bound), level.planner.name(),
        companion_constant.checks + companion_step.checks, companion_constant.work + companion_step.work,
        level.planner.name());
  }
  return fmt::format(
      "proposals from h{} cost at most 0.8 (bound - 1) = {:g} times the work of the other proposals, beyond a grant of "
      "{:.0f} and what progress along a guiding path earns",
      level.below.empty() ? "" : " and the searches of " + levels_text(level.below), 0.8 * (level.common.bound - 1.0),
      level.grant);
}

std::string set_up_text(const LevelExplanation& level) {
  return fmt::format(
      "of all guides: about {:.0f} units of work, with 1 / {} of what is kept for the world; {}", level.set_up,
      marked(level, "queries", level.common.queries),
      level.set_up <= companion_constant.work
          ? "it begins at once"
          : fmt::format("it begins when {} without guides has done as much work beyond {:g}, unless that "
                        "ends before",
                        level.planner.name(), companion_constant.work));
}

std::string limits_text(const LevelExplanation& level) {
  const Budget& budget = level.common.budget;
  return fmt::format("proposals {}, validity checks {}, seconds {}, each over all searches of this level",
                     marked(level, "proposals", budget.proposals), marked(level, "checks", budget.checks),
                     marked(level, "seconds", budget.seconds));
}

std::string planner_text(const LevelExplanation& level, const std::string& guide) {
  const Component& component = *level.kind->component;
  std::string whose = level.planner_given ? "" : fmt::format(", which {} takes by default", guide);
  if (!level.inherited.empty()) {
    whose += fmt::format(", with the {} of the level above", fmt::join(level.inherited, ", "));
  }
  return fmt::format("{}{}: {}", component.name, whose, component.summary);
}

std::string resolves_text(const GuideExplanation& guide) {
  std::string text;
  if (guide.level) {
    const Option* option = guide.component != nullptr ? guide.component->find("resolves") : nullptr;
    const bool by_default = option != nullptr && option->default_value == OptionValue(guide.resolves);
    text = guide.resolves == 0 ? "never"
                               : fmt::format("at most {} {}{}", guide.resolves, guide.resolves == 1 ? "time" : "times",
                                             by_default ? default_mark : "");
    if (guide.effort < Budget::unlimited)
      text += fmt::format("; the first search has {} proposals", count(guide.effort));
    if (guide.resolves > 0 && guide.effort_again < Budget::unlimited) {
      text += fmt::format("; each further search has {} proposals", count(guide.effort_again));
    }
  }
  return text;
}

/// Returns the options for the claims; those of a custom guide belong to its script.
const Options& options_of(const GuideExplanation& guide) {
  static const Options none;
  return guide.component != nullptr ? guide.spec.options() : none;
}

/// Whether h has a density in closed form; for a combinator, whether its parts have one.
bool closed_form(const GuideExplanation& guide) {
  return guide.claims->closed_form && std::all_of(guide.parts.begin(), guide.parts.end(), closed_form);
}

std::string density_text(const GuideExplanation& guide) {
  const std::string density = with_values(guide.claims->density, options_of(guide));
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < guide.parts.size(); ++i) {
    if (!closed_form(guide.parts[i])) open.push_back(i + 1);
  }
  if (open.empty()) return fmt::format("{}: {}", guide.claims->closed_form ? "closed form" : "no closed form", density);
  const std::string parts = fmt::format("part{} {}", open.size() == 1 ? "" : "s", fmt::join(open, ", "));
  // A mixture sums all parts; other combinators use one part at a time.
  const bool sum = guide.spec.kind() == GuideSpec::Kind::mixture || guide.spec.kind() == GuideSpec::Kind::blend;
  return sum ? fmt::format("no closed form: {} {} none; else {}", parts, open.size() == 1 ? "has" : "have", density)
             : fmt::format("no closed form while {} {}; else {}", parts, open.size() == 1 ? "serves" : "serve",
                           density);
}

const Combinator& split_combinator() {
  const auto& all = combinators();
  return *std::find_if(all.begin(), all.end(), [](const Combinator& c) { return c.name == "split"; });
}

// The tree
// ----------------------------------------------------------------------------------------------------------------

/// A node of the printed tree.
struct Block {
  std::string title;
  std::vector<std::pair<std::string, std::string>> entries;  ///< label and text
  std::vector<Block> children;

  void add(std::string label, std::string text) {
    if (!text.empty()) entries.emplace_back(std::move(label), std::move(text));
  }
};

void add_level(const LevelExplanation& level, const std::string& guide, int above, Block& block) {
  block.add(above < 0 ? "space C" : "space S", space_text(level));
  block.add("motions", motions_text(level));
  if (const Options* dividing = level.planner.dividing()) {
    const Combinator& split = split_combinator();
    block.add("split",
              fmt::format("{}; {}; f: {}; h: {}", split.summary, options_text(split_settings().component(), *dividing),
                          split.claims.f, split.claims.h));
    block.add("", "each half is a level of its own, which the run makes and numbers when it divides the instance");
  }
  block.add("planner", planner_text(level, guide));
  block.add("", options_text(*level.kind->component, level.planner.options(), every_planner_has));
  block.add("proposals", proposals_text(level));
  if (level.guide) block.add("bound", bound_text(level));
  if (has_companion(level)) block.add("set-up", set_up_text(level));
  block.add("limits", limits_text(level));
  block.add("checks", checks_text(level, above));
}

/// \param above  the number of the level that it guides  \param place  "part 1 of 2: " of a combinator's
Block block_of(const GuideExplanation& guide, int above, const std::string& place) {
  Block block;
  const std::string name =
      guide.spec.kind() == GuideSpec::Kind::component ? guide.spec.text_alone() : guide.spec.name();
  const GuideClaims& claims = *guide.claims;
  const Options& options = options_of(guide);
  block.title = place + (guide.level ? fmt::format("level {}: ", guide.level->number) : "") +
                fmt::format("{} guides level {}", name, above);
  block.add("purpose", guide.summary);
  if (guide.spec.custom() && !guide.spec.origin().script.empty()) {
    block.add("written at", fmt::format("{}:{}", guide.spec.origin().script, guide.spec.origin().line));
  }
  const std::string spaces =
      guide.level ? fmt::format("from C, the space of level {}, to S, that of level {}: ", above, guide.level->number)
                  : "";
  block.add("f", spaces + with_values(claims.f, options));
  block.add("h", with_values(claims.h, options));
  block.add("density", density_text(guide));
  if (guide.component != nullptr) block.add("options", options_text(*guide.component, guide.spec.options()));
  block.add("feedback", with_values(claims.feedback, options));
  block.add("re-solves", resolves_text(guide));
  if (guide.spec.searches()) block.add("no path", with_values(claims.no_path, options));
  if (guide.validates_edges) {
    block.add("edges", fmt::format("h validates edges of the path found at level {} in the space of level {}, and "
                                   "their checks count at level {}",
                                   guide.level->number, above, above));
  }
  if (guide.level) {
    add_level(*guide.level, guide.spec.name(), above, block);
    if (guide.level->guide) block.children.push_back(block_of(*guide.level->guide, guide.level->number, ""));
  }
  for (std::size_t i = 0; i < guide.parts.size(); ++i) {
    const std::string share =
        guide.shares.empty() ? "" : fmt::format(", {} of its proposals", percent(guide.shares[i]));
    block.children.push_back(
        block_of(guide.parts[i], above, fmt::format("part {} of {}{}: ", i + 1, guide.parts.size(), share)));
  }
  return block;
}

Block block_of_root(const LevelExplanation& root) {
  Block block;
  block.title = fmt::format("level {}: {}", root.number, root.name);
  add_level(root, "", -1, block);
  if (root.guide) block.children.push_back(block_of(*root.guide, root.number, ""));
  return block;
}

/// \param first  prefix of the title  \param rest  prefix of all other lines
void print(const Block& block, const std::string& first, const std::string& rest, std::size_t width, std::string& out) {
  constexpr std::size_t label_width = 11;
  const std::string bar = rest + (block.children.empty() ? "  " : "│ ");
  out += wrap(block.title, width, first, bar);
  for (const auto& [label, text] : block.entries) {
    out += wrap(text, width, bar + pad(label, label_width, false), bar + std::string(label_width, ' '));
  }
  for (std::size_t i = 0; i < block.children.size(); ++i) {
    const bool last = i + 1 == block.children.size();
    print(block.children[i], rest + (last ? "└─ " : "├─ "), rest + (last ? "   " : "│  "), width, out);
  }
}

// JSON
// ----------------------------------------------------------------------------------------------------------------

/// Infinity becomes null: no limit.
Json number_json(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json options_json(const Component& component, const Options& options) {
  Json out = Json::object();
  for (const auto& [name, value] : options.entries()) {
    const Option& option = *component.find(name);
    Json json = std::visit(
        [](const auto& v) -> Json {
          if constexpr (std::is_same_v<std::decay_t<decltype(v)>, double>) {
            return number_json(v);
          } else {
            return v;
          }
        },
        value);
    out[name] = {{"value", std::move(json)}, {"unit", option.unit}, {"default", value == option.default_value}};
  }
  return out;
}

Json level_json(const LevelExplanation& level, int above);

Json guide_json(const GuideExplanation& guide, int above) {
  const GuideClaims& claims = *guide.claims;
  Json out = {{"name", guide.spec.name()},
              {"text", guide.spec.text()},
              {"guides", above},
              {"f", claims.f},
              {"h", claims.h},
              {"closed_form", closed_form(guide)},
              {"density", claims.density},
              {"feedback", claims.feedback},
              {"options", guide.component != nullptr ? options_json(*guide.component, guide.spec.options())
                                                     : Json(Json::object())},
              {"resolves", guide.resolves},
              {"validates_edges_above", guide.validates_edges},
              {"level", guide.level ? level_json(*guide.level, above) : Json(nullptr)}};
  Json parts = Json::array();
  for (const GuideExplanation& part : guide.parts) parts.push_back(guide_json(part, above));
  out["shares"] = guide.shares;
  out["parts"] = std::move(parts);
  return out;
}

Json level_json(const LevelExplanation& level, int above) {
  Json axes = Json::array();
  for (const Axis& axis : level.space.coordinates()) {
    axes.push_back(
        {{"name", axis.name}, {"lo", axis.lo}, {"hi", axis.hi}, {"weight", axis.weight}, {"periodic", axis.periodic}});
  }
  Json graph = nullptr;
  if (level.graph) {
    graph = {{"vertices", level.graph->vertices}, {"edges", level.graph->edges}, {"verified", level.graph->verified}};
  }
  const Options* dividing = level.planner.dividing();
  return {{"level", level.number},
          {"guides", above < 0 ? Json(nullptr) : Json(above)},
          {"name", level.name},
          {"space", {{"name", level.space.name()}, {"dimension", level.space.dimension()}, {"axes", std::move(axes)}}},
          {"graph", std::move(graph)},
          {"motion_model", level.motion_model},
          {"presumed", level.presumed},
          {"collision", level.collision},
          {"resolution", level.resolution},
          {"planner",
           {{"name", level.kind->component->name},
            {"given", level.planner_given},
            {"inherited", level.inherited},
            {"options", options_json(*level.kind->component, level.planner.options())},
            {"split", dividing != nullptr ? options_json(split_settings().component(), *dividing) : Json(nullptr)}}},
          {"limits",
           {{"proposals", number_json(level.common.budget.proposals)},
            {"checks", number_json(level.common.budget.checks)},
            {"seconds", number_json(level.common.budget.seconds)}}},
          {"shares",
           {{"goal", level.common.goal_bias}, {"uniform", (1.0 - level.common.goal_bias) * level.common.uniform}}},
          {"bound", level.common.bound},
          {"grant", level.grant},
          {"set_up", has_companion(level) ? Json(level.set_up) : Json(nullptr)},
          {"guide", level.guide ? guide_json(*level.guide, level.number) : Json(nullptr)}};
}

}  // namespace

std::string explanation_text(const ExplainedStrategy& explained, std::size_t width) {
  constexpr std::size_t most_names = 5;
  std::string problems = explained.problem;
  if (!explained.similar.empty()) {
    const std::size_t shown = std::min(most_names, explained.similar.size());
    const std::vector<std::string> names(explained.similar.begin(),
                                         explained.similar.begin() + static_cast<std::ptrdiff_t>(shown));
    problems += fmt::format(
        " (the same hierarchy on {}{})", fmt::join(names, ", "),
        shown < explained.similar.size() ? fmt::format(" and {} more", explained.similar.size() - shown) : "");
  }
  std::string text = wrap(fmt::format("{} on {}", explained.name, problems), width, "", "  ");
  text += wrap(explained.text, width, "  ", "    ") + '\n';
  print(block_of_root(explained.root), "", "", width, text);
  return text;
}

std::string explanation_json(const std::vector<ExplainedStrategy>& explained, const std::string& script) {
  Json strategies = Json::array();
  for (const ExplainedStrategy& one : explained) {
    strategies.push_back({{"strategy", one.name},
                          {"text", one.text},
                          {"problem", one.problem},
                          {"similar_problems", one.similar},
                          {"root", level_json(one.root, -1)}});
  }
  const Json document = {
      {"trellis", {{"version", version()}}}, {"script", script}, {"strategies", std::move(strategies)}};
  return document.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace trellis
