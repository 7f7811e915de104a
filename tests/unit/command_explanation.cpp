// SPDX-License-Identifier: GPL-3.0-or-later
// Compares `trellis explain` with the registry and with actual runs.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include <dsl/command/explanation.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/planner/common_options.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

constexpr std::size_t width = 100;

Problem block_problem() {
  return test::make_problem("block", test::rectangle_world({{1.5, 1, 2, 3}, {2.4, 1.2, 2.8, 2}}, 4.0),
                            test::rectangle_robot(), {0.6, 2, 0}, {3.4, 2, 0});
}

PlannerSpec planner() { return PlannerSpec::make("rrt", {{"step", 0.5}, {"proposals", std::int64_t{120}}}); }

GuideSpec guide(const GuideKind& kind) { return GuideSpec::make(kind.component->name, {}); }

ExplainedStrategy explained(const StrategySpec& strategy, const Problem& problem = block_problem()) {
  return {"it", strategy.text(), problem.name, {}, explain(strategy, problem)};
}

/// The text with the tree's lines and line ends made spaces, one between two words.
std::string on_one_line(const std::string& text) {
  std::string out;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (word != "│" && word != "└─" && word != "├─") out += word + ' ';
  }
  return out;
}

/// A claim up to its first option in backquotes, behind which its value stands.
std::string beginning(const std::string& claim) { return claim.substr(0, claim.find('`')); }

void collect(const LevelExplanation& level, std::map<int, const LevelExplanation*>& levels);
void collect(const GuideExplanation& guide, std::map<int, const LevelExplanation*>& levels) {
  if (guide.level) collect(*guide.level, levels);
  for (const GuideExplanation& part : guide.parts) collect(part, levels);
}
void collect(const LevelExplanation& level, std::map<int, const LevelExplanation*>& levels) {
  levels[level.number] = &level;
  if (level.guide) collect(*level.guide, levels);
}

/// The levels that are explained are those that run, by number, name, space and planner.
void check_levels(const StrategySpec& strategy) {
  CAPTURE(strategy.text());
  const LevelExplanation root = explain(strategy, block_problem());
  std::map<int, const LevelExplanation*> levels;
  collect(root, levels);
  const RunRecord run = execute(strategy, block_problem(), 3, {.companion = false});
  REQUIRE(run.levels.size() == levels.size());
  for (const LevelRecord& level : run.levels) {
    const LevelExplanation& said = *levels.at(level.level);
    CHECK(said.name == level.name);
    CHECK(said.space == level.space);
    CHECK(said.planner.name() == level.planner);
    CHECK(said.presumed == level.presumed);
    if (said.presumed) CHECK(level.search.checks.validity == 0);
  }
}

void check_width(const std::string& text, std::size_t most) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    INFO(line);
    CHECK(display_width(line) <= most);
    CHECK_FALSE(line.ends_with(' '));
  }
}

}  // namespace

TEST_CASE("every guide of the registry is explained by what it claims and by its options", "[report][explain]") {
  for (const GuideKind& kind : guide_kinds()) {
    CAPTURE(kind.component->name);
    const bool team = kind.claims.needs == GuideClaims::Needs::team;
    const std::string text =
        explanation_text(explained(guide(kind) >> planner(), team ? test::team_problem() : block_problem()), width);
    check_width(text, width);
    const std::string line = on_one_line(text);
    CHECK_THAT(line, Contains(guide(kind).text_alone() + " guides level 0"));
    CHECK_THAT(line, Contains(beginning(on_one_line(kind.claims.f))));
    CHECK_THAT(line, Contains(beginning(on_one_line(kind.claims.h))));
    CHECK_THAT(line,
               Contains(std::string(kind.claims.closed_form ? "density closed form: " : "density no closed form: ") +
                        beginning(on_one_line(kind.claims.density))));
    CHECK_THAT(line, Contains(beginning(on_one_line(kind.claims.feedback))));
    for (const Option& option : kind.component->options) CHECK_THAT(line, Contains(option.name + " = "));
    CHECK((line.find("level 1: ") != std::string::npos) == !kind.default_planner.empty());
  }
}

TEST_CASE("every planner is explained with its options, and the ones that all have as bound and limits",
          "[report][explain]") {
  for (const PlannerKind& kind : planner_kinds()) {
    if (kind.graph) continue;  // searches explicit graphs, which no problem is
    CAPTURE(kind.component->name);
    const Problem problem = kind.kinodynamic ? test::driven(block_problem(), "unicycle1") : block_problem();
    const PlannerSpec spec = PlannerSpec::make(kind.component->name, {{"proposals", std::int64_t{777}}});
    const std::string all = on_one_line(explanation_text(explained(spec, problem), width));
    const std::string line = all.substr(all.find("level 0: "));
    CHECK_THAT(line, Contains("planner " + kind.component->name + ": " + on_one_line(kind.component->summary)));
    CHECK_THAT(line, Contains("proposals 777, validity checks unlimited (default)"));
    for (const Option& option : kind.component->options) {
      CHECK((line.find(option.name + " = ") != std::string::npos) == !every_planner_has(option.name));
    }
  }
}

TEST_CASE("the levels that are explained are those that run", "[report][explain]") {
  for (const GuideKind& kind : test::guides_of_one_robot()) check_levels(guide(kind) >> planner());
  const GuideSpec shrink = GuideSpec::make("shrink", {{"scale", 0.5}});
  const GuideSpec lazy = GuideSpec::make("lazy", {});
  const GuideSpec skeleton = GuideSpec::make("skeleton", {});
  const GuideSpec bias = GuideSpec::make("goal_bias", {{"share", 0.3}});
  check_levels(skeleton >> shrink >> lazy >> planner());
  check_levels((0.7 * skeleton + 0.3 * bias) >> planner());
  check_levels(skeleton >> race({schedule({shrink, blend({lazy, bias})}), sequence({lazy, shrink})}) >> planner());
}

TEST_CASE("an explanation says which parts a combinator has, and who pays for what", "[report][explain]") {
  const GuideSpec shrink = GuideSpec::make("shrink", {{"scale", 0.5}});
  const GuideSpec lazy = GuideSpec::make("lazy", {{"resolves", std::int64_t{7}}});
  const GuideSpec bias = GuideSpec::make("goal_bias", {});
  const auto line = [](const StrategySpec& strategy) {
    return on_one_line(explanation_text(explained(strategy), width));
  };

  const std::string mixed = line((0.75 * (shrink >> lazy) + 0.25 * bias) >> planner());
  CHECK_THAT(mixed, Contains("mixture guides level 0"));
  CHECK_THAT(mixed, Contains("density closed form: the weighted sum"));
  CHECK_THAT(mixed, Contains("part 1 of 2, 75 % of its proposals: level 1: lazy { resolves = 7 } guides level 0"));
  CHECK_THAT(mixed, Contains("part 2 of 2, 25 % of its proposals: goal_bias"));
  CHECK_THAT(mixed, Contains("re-solves at most 7 times;") || Contains("re-solves at most 7 times no path"));
  CHECK_THAT(mixed, Contains("level 2: shrink(0.5) guides level 1"));
  CHECK_THAT(mixed, Contains("checks none: this space presumes that everything is valid"));
  CHECK_THAT(mixed, Contains("h validates edges of the path found at level 1 in the space of level 0, and their checks "
                             "count at level 0"));
  CHECK_THAT(mixed, Contains("5 % are the goal, 4.75 % uniform, 90.25 % from h"));
  CHECK_THAT(
      mixed,
      Contains(
          "a run costs at most 2 (default) times the checks of rrt without guides on the same seed, plus 864 checks"));
  CHECK_THAT(mixed,
             Contains("set-up of all guides: about 181 units of work, with 1 / 1000 (default) of what is kept") &&
                 Contains("it begins at once"));
  CHECK_THAT(line(bias >> shrink >> planner()),
             Contains("proposals from h cost at most 0.8 (bound - 1) = 0.8 times the work of the other proposals"));
  const std::string once = line(GuideSpec::make("skeleton", {}) >> PlannerSpec::make("rrt", {{"queries", 1.0}}));
  CHECK_THAT(once, Contains("it begins when rrt without guides has done as much work beyond 1200, unless that ends"));

  const GuideSpec bridge = GuideSpec::make("bridge_test", {});
  CHECK_THAT(line((bias + bridge) >> planner()),
             Contains("density no closed form: part 2 has none; else the weighted sum"));
  CHECK_THAT(line(race({shrink, bias + bridge}) >> planner()),
             Contains("density no closed form while part 2 serves; else as of the part that leads"));

  const std::string divided = line(split(shrink >> StrategySpec(planner()), {.depth = 2}));
  CHECK_THAT(divided, Contains("split an instance divided at a sub-goal"));
  CHECK_THAT(divided, Contains("depth = 2; by default tries = 3, effort = 2000"));

  const std::string unbound = line(shrink >> PlannerSpec::make("rrt", {{"bound", 0.0}}));
  CHECK_THAT(unbound, Contains("bound none (bound = 0): h draws its share whatever it costs"));
}

TEST_CASE("a guide that does not suit a problem is refused as by a run", "[report][explain]") {
  const StrategySpec driven = PlannerSpec::make("kinodynamic_rrt", {});
  CHECK_THROWS_WITH(explain(driven, block_problem()), Contains("drives a motion model and this space has none"));
}

TEST_CASE("a space of many axes alike is written in few words, and any text fits its width", "[report][explain]") {
  const Arm arm{.links = std::vector<double>(20, 0.4), .widths = std::vector<double>(20, 0.1), .base = {5, 5}};
  const Problem problem = test::make_problem("arm", test::rectangle_world({{9, 9, 9.5, 9.5}}), Robot::arm(arm),
                                             Configuration(20, 0.01), Configuration(20, -0.1));
  const ExplainedStrategy one = explained(GuideSpec::make("shrink", {}) >> planner(), problem);
  const std::string text = explanation_text(one, width);
  check_width(text, width);
  CHECK_THAT(on_one_line(text), Contains("20 dimensions: "));
  CHECK(std::count(text.begin(), text.end(), '[') <= 4);
  check_width(explanation_text(one, 72), 72);
}

TEST_CASE("the document of an explanation has the levels, options and limits", "[report][explain]") {
  const GuideSpec shrink = GuideSpec::make("shrink", {{"scale", 0.5}});
  const auto document = nlohmann::json::parse(explanation_json({explained(shrink >> planner())}, "it.lua"));
  CHECK(document["script"] == "it.lua");
  const auto& root = document["strategies"][0]["root"];
  CHECK(root["level"] == 0);
  CHECK(root["guides"].is_null());
  CHECK(root["limits"]["proposals"] == 120);
  CHECK(root["limits"]["seconds"].is_null());
  const auto& guide = root["guide"];
  CHECK(guide["name"] == "shrink");
  CHECK(guide["guides"] == 0);
  CHECK(guide["options"]["scale"]["value"] == 0.5);
  CHECK(guide["options"]["evidence"]["default"] == true);
  CHECK(guide["level"]["level"] == 1);
  CHECK(guide["level"]["guides"] == 0);
  CHECK(guide["level"]["space"]["axes"].size() == 3);
  CHECK(guide["parts"].empty());
}
