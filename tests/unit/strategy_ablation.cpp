// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include <trellis/strategy/ablation.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}
GuideSpec shrink(double scale) { return guide("shrink", {{"scale", scale}}); }
PlannerSpec rrt(const std::vector<Options::Entry>& given = {}) { return PlannerSpec::make("rrt", given); }

/// The removed guide, and the remaining strategy, as texts.
std::vector<std::string> names(const std::vector<Ablation>& all) {
  std::vector<std::string> result;
  for (const Ablation& a : all) result.push_back(a.text());
  return result;
}
std::vector<std::string> texts(const std::vector<Ablation>& all) {
  std::vector<std::string> result;
  for (const Ablation& a : all) result.push_back(a.strategy.text());
  return result;
}

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("each guide is removed with all that guided it, or left out between its neighbours", "[ablation]") {
  const GuideSpec skeleton = guide("skeleton");
  const GuideSpec lazy = guide("lazy");
  const PlannerSpec root = rrt({{"step", 0.4}});
  const auto all = ablations(skeleton >> shrink(0.5) >> lazy >> root);
  REQUIRE(all.size() == 5);
  CHECK(all[0].strategy == StrategySpec(root));
  CHECK(all[1].strategy == skeleton >> shrink(0.5) >> root);
  CHECK(all[2].strategy == lazy >> root);
  CHECK(all[3].strategy == skeleton >> lazy >> root);
  CHECK(all[4].strategy == shrink(0.5) >> lazy >> root);
  for (std::size_t i = 0; i < all.size(); ++i) CHECK(all[i].skipped == (i == 1 || i == 3));
}

TEST_CASE("a blend is ablated part by part and keeps its settings", "[ablation]") {
  const BlendSettings settings = {.floor = 0.4};
  const auto all = ablations(blend({guide("skeleton"), guide("skeleton") >> shrink(0.5)}, settings) >> rrt());
  CHECK(texts(all) == Texts{"blend { skeleton() >> shrink(0.5), floor = 0.4 } >> rrt()",
                            "blend { skeleton(), floor = 0.4 } >> rrt()",
                            "blend { skeleton(), skeleton(), floor = 0.4 } >> rrt()",
                            "blend { skeleton(), shrink(0.5), floor = 0.4 } >> rrt()"});
}

TEST_CASE("the removed guide and the remaining strategy have their script texts", "[ablation]") {
  const auto all = ablations(guide("skeleton") >> shrink(0.5) >> guide("lazy") >> rrt());
  CHECK(names(all) == Texts{"without lazy()", "skipping lazy()", "without shrink(0.5)", "skipping shrink(0.5)",
                            "without skeleton()"});
  CHECK(texts(all) == Texts{"rrt()", "skeleton() >> shrink(0.5) >> rrt()", "lazy() >> rrt()",
                            "skeleton() >> lazy() >> rrt()", "shrink(0.5) >> lazy() >> rrt()"});
}

TEST_CASE("what is left keeps its options, its planners and the root's", "[ablation]") {
  const PlannerSpec own = PlannerSpec::make("rrt_connect", {{"step", 0.3}});
  const PlannerSpec root = rrt({{"step", 0.4}, {"proposals", 700.0}});
  const GuideSpec above = GuideSpec::make("shrink", {{"scale", 0.25}}, own);
  const auto all = ablations(guide("skeleton") >> above >> guide("lazy") >> root);
  REQUIRE(all.size() == 5);
  for (const Ablation& a : all) {
    INFO(a.text());
    CHECK(a.strategy.planner() == root);
  }
  CHECK(all[0].strategy.guide() == nullptr);
  // Without the skeleton: shrink >> lazy.
  const GuideSpec* lazy = all[4].strategy.guide();
  CHECK(lazy->name() == "lazy");
  const GuideSpec* shrunken = lazy->below();
  REQUIRE(shrunken != nullptr);
  CHECK(shrunken->name() == "shrink");
  CHECK(std::get<double>(shrunken->options().at("scale")) == 0.25);
  CHECK(shrunken->planner() == own);
  CHECK(shrunken->below() == nullptr);
  CHECK(all[2].guide == "shrink { 0.25, planner = rrt_connect { step = 0.3 } }");
}

TEST_CASE("guides that occur more than once are numbered, and each is taken out on its own", "[ablation]") {
  const auto chain = ablations(shrink(0.5) >> guide("lazy") >> shrink(0.5) >> rrt());
  REQUIRE(chain.size() == 5);
  for (const std::size_t i : {0U, 1U}) CHECK(chain[i].guide.ends_with(" #1"));
  for (const std::size_t i : {2U, 3U}) CHECK(chain[i].guide.find('#') == std::string::npos);
  CHECK(chain[4].guide.ends_with(" #2"));
  CHECK(chain[1].strategy == shrink(0.5) >> guide("lazy") >> rrt());
  CHECK(chain[4].strategy == guide("lazy") >> shrink(0.5) >> rrt());
  // Options distinguish two of one name.
  for (const Ablation& a : ablations(shrink(0.3) >> shrink(0.5) >> rrt())) {
    CHECK(a.guide.find('#') == std::string::npos);
  }
}

TEST_CASE("a mixture keeps its other parts and their relative shares", "[ablation]") {
  const GuideSpec a = shrink(0.5);
  const GuideSpec b = guide("lazy");
  const GuideSpec bias = guide("gaussian");
  const auto all = ablations((0.3 * a + 0.5 * (guide("skeleton") >> b) + 0.2 * bias) >> rrt());
  REQUIRE(all.size() == 5);
  CHECK(all[0].strategy == (0.5 * (guide("skeleton") >> b) + 0.2 * bias) >> rrt());
  CHECK(all[1].strategy == (0.3 * a + 0.2 * bias) >> rrt());
  CHECK(all[2].strategy == (0.3 * a + 0.5 * guide("skeleton") + 0.2 * bias) >> rrt());
  CHECK(all[3].strategy == (0.3 * a + 0.5 * b + 0.2 * bias) >> rrt());
  CHECK(all[4].strategy == (0.3 * a + 0.5 * (guide("skeleton") >> b)) >> rrt());
  CHECK(ablations((a + b) >> rrt())[0].strategy == b >> rrt());

  // A guide that a mixture guides, left out: its share goes to the mixture as a whole.
  const GuideSpec pair = guide("skeleton") + 3.0 * shrink(0.3);
  const auto shared = ablations((0.4 * (pair >> b) + 0.6 * a) >> rrt());
  const auto skipping = std::find_if(shared.begin(), shared.end(), [](const Ablation& x) { return x.skipped; });
  REQUIRE(skipping != shared.end());
  CHECK(skipping->strategy == (0.1 * guide("skeleton") + 0.3 * shrink(0.3) + 0.6 * a) >> rrt());
}

TEST_CASE("a sequence keeps its order and its turns", "[ablation]") {
  const GuideSpec a = shrink(0.5);
  const GuideSpec b = guide("lazy");
  const auto all = ablations(sequence({a, guide("skeleton") >> b}, 50) >> rrt());
  REQUIRE(all.size() == 4);
  CHECK(all[0].strategy == sequence({guide("skeleton") >> b}, 50) >> rrt());
  CHECK(all[1].strategy == sequence({a}, 50) >> rrt());
  CHECK(all[2].strategy == sequence({a, guide("skeleton")}, 50) >> rrt());
  CHECK(all[3].strategy == sequence({a, b}, 50) >> rrt());
}

TEST_CASE("a strategy without a guide has none to take out", "[ablation]") {
  CHECK(ablations(StrategySpec(rrt())).empty());
  const auto one = ablations(guide("gaussian") >> rrt());
  REQUIRE(one.size() == 1);
  CHECK_FALSE(one.front().skipped);
  CHECK(one.front().strategy == StrategySpec(rrt()));
}

TEST_CASE("what is left runs as it would on its own", "[ablation]") {
  const auto problem = test::cup_problem();
  for (const Ablation& a : ablations(guide("skeleton") >> shrink(0.5) >> rrt())) {
    INFO(a.text());
    const RunRecord run = execute(a.strategy, problem, 3);
    CHECK(run.levels.size() == (a.text().starts_with("without shrink") ? 1 : 2));
    if (a.skipped) {
      const RunRecord own = execute(guide("skeleton") >> rrt(), problem, 3);
      CHECK(run.validity_checks == own.validity_checks);
      CHECK(run.length == own.length);
    }
    for (const LevelRecord& level : run.levels) CHECK(level.name.find("planner") == std::string::npos);
  }
}

TEST_CASE("the ablations that decide are one for each guide, with its key in a run", "[ablation]") {
  const GuideSpec chain = guide("skeleton") >> shrink(0.5) >> guide("lazy");
  const auto decisive = decisive_ablations((0.5 * chain + 0.5 * guide("goal_bias")) >> rrt());
  REQUIRE(decisive.size() == 4);
  CHECK(names(decisive) ==
        Texts{"skipping lazy()", "skipping shrink(0.5)", "without skeleton()", "without goal_bias(0.05)"});
  Texts keys;
  for (const Ablation& a : decisive) keys.push_back(a.key);
  CHECK(keys == Texts{"0/0.0", "0/0.0/0", "0/0.0/0/0", "0/0.1"});
  CHECK(decisive[3].strategy == chain >> rrt());

  // The keys are those of the levels of a run, for every kind of combination.
  const auto problem = test::cup_problem();
  const GuideSpec a = shrink(0.3);
  const GuideSpec b = guide("skeleton") >> shrink(0.6);
  for (const GuideSpec& all : {a + b, sequence({a, b}, 20), blend({a, b}), schedule({a, b}, {.turn = 20}), race({a, b}),
                               (a + guide("skeleton")) >> guide("lazy")}) {
    const StrategySpec strategy = all >> rrt({{"bound", 0.0}});
    CAPTURE(strategy.text());
    for (const LevelRecord& level : execute(strategy, problem, 1).levels) {
      if (level.level == 0) continue;
      const auto known = decisive_ablations(strategy);
      const auto of = std::find_if(known.begin(), known.end(), [&](const Ablation& x) { return x.key == level.key; });
      REQUIRE(of != known.end());
      CHECK(of->guide.starts_with(level.name.substr(0, level.name.find('('))));
    }
  }
}

TEST_CASE("levels of the halves of a split search belong to the guide that made them", "[ablation]") {
  CHECK(guide_key("0").empty());
  CHECK(guide_key("0/0.1") == "0/0.1");
  CHECK(guide_key("0/1.0").empty());         // a half of the root
  CHECK(guide_key("0/1.0/0.1") == "0/0.1");  // of its guide
  CHECK(guide_key("0/1.0/2.1/0/0") == "0/0/0");
  CHECK(guide_key("0/0/1.1").empty());  // a half of the guide's own search
}
