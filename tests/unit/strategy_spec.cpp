// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <trellis/strategy/explanation.hpp>
#include <trellis/strategy/registry.hpp>
#include <trellis/strategy/spec.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}
PlannerSpec rrt() { return PlannerSpec::make("rrt", {{"step", 0.5}}); }

}  // namespace

TEST_CASE("nesting associates, with the planner at the end too", "[spec][laws]") {
  const auto a = guide("skeleton");
  const auto b = guide("shrink");
  const auto c = guide("lazy");
  CHECK((a >> b) >> c == a >> (b >> c));
  CHECK(((a >> b) >> c) >> rrt() == a >> (b >> (c >> rrt())));
  CHECK(a >> b >> c >> rrt() == a >> StrategySpec(b >> c >> rrt()));
  CHECK_FALSE(a >> b >> c == b >> a >> c);
}

TEST_CASE("nesting distributes over mixtures and sequences", "[spec][laws]") {
  const auto a = guide("skeleton");
  const auto b = guide("shrink");
  const auto c = guide("lazy");
  CHECK(a >> (b + c) == (a >> b) + (a >> c));
  CHECK(a >> (0.7 * b + 0.3 * c) == 0.7 * (a >> b) + 0.3 * (a >> c));
  CHECK(a >> sequence({b, c}) == sequence({a >> b, a >> c}));
  // What searches no space is guided by nothing.
  CHECK(a >> (b + guide("goal_bias")) == (a >> b) + guide("goal_bias"));
}

TEST_CASE("nesting distributes over blends, which keep their settings", "[spec][laws][blend]") {
  const auto a = guide("skeleton");
  const auto b = guide("shrink");
  const auto c = guide("lazy");
  const BlendSettings settings = {.floor = 0.4, .decay = 0.9, .credit = "reach"};
  CHECK(a >> blend({b, c}, settings) == blend({a >> b, a >> c}, settings));
  CHECK(a >> blend({b, guide("goal_bias")}) == blend({a >> b, guide("goal_bias")}));
  CHECK((a >> blend({b, c})) >> rrt() == a >> (blend({b, c}) >> rrt()));
  CHECK_FALSE(blend({b, c}, settings) == blend({b, c}));
  CHECK_FALSE(blend({b, c}) == b + c);
  CHECK_FALSE(blend({b, c}) == sequence({b, c}));
  CHECK(blend({a, blend({b, c})}).terms().size() == 2);
  const auto strategy = blend({a, b}, {.floor = 0.5}) >> rrt();
  CHECK(strategy.text() == "blend { skeleton(), shrink(0.5), floor = 0.5 } >> rrt()");
  CHECK(strategy.tree() ==
        "rrt()\n"
        "└─ blend, floor 0.5, decay 0.98, credit node, rule rates\n"
        "   ├─ 1. skeleton()  searched by graph_search()\n"
        "   └─ 2. shrink(0.5)  searched by rrt()\n");
  CHECK(strategy.json().find("\"floor\":0.5,\"decay\":0.98,\"credit\":\"node\"") != std::string::npos);
  CHECK(strategy.hash() != (blend({a, b}) >> rrt()).hash());
  CHECK_THROWS_WITH(blend({}), Contains("at least one guide"));
  CHECK_THROWS_WITH(blend({a}, {.floor = 0.0}), Contains("blend: option 'floor'"));
  CHECK_THROWS_WITH(blend({a}, {.decay = 1.5}), Contains("blend: option 'decay'"));
  CHECK_THROWS_WITH(blend({a}, {.credit = "luck"}), Contains("blend: option 'credit'"));
}

TEST_CASE("weights are normalised, sums and sequences are flat", "[spec][laws]") {
  const auto a = guide("shrink");
  const auto b = guide("lazy");
  const auto c = guide("identity");
  CHECK((a + b) + c == a + (b + c));
  CHECK(0.5 * a + 0.5 * b == a + b);
  CHECK(7.0 * a + 3.0 * b == 0.7 * a + 0.3 * b);
  CHECK(0.5 * (a + b) + 1.0 * c == 0.25 * a + 0.25 * b + 0.5 * c);
  CHECK(sequence({sequence({a, b}), c}) == sequence({a, sequence({b, c})}));
  CHECK_FALSE(0.6 * a + 0.4 * b == a + b);
}

TEST_CASE("what does not compose says why", "[spec][errors]") {
  CHECK_THROWS_WITH(guide("shrink") >> guide("goal_bias"),
                    Contains("searches no space") && Contains("shrink(0.5) + goal_bias"));
  CHECK_THROWS_WITH(0.0 * guide("shrink"), Contains("weight") && Contains("greater than 0"));
  CHECK_THROWS_WITH(-1.0 * guide("shrink"), Contains("greater than 0"));
  CHECK_THROWS_WITH(StrategySpec(PlannerSpec::make("graph_search", {})), Contains("graph_search") && Contains("root"));
  CHECK_THROWS_WITH(GuideSpec::make("shrink", {}, PlannerSpec::make("graph_search", {})),
                    Contains("no explicit graph"));
  CHECK_THROWS_WITH(GuideSpec::make("skeleton", {}, rrt()),
                    Contains("explicit graph; 'rrt' cannot search it") && Contains("best_first"));
  CHECK_THROWS_WITH(GuideSpec::make("uniform", {}, rrt()), Contains("takes no planner"));
  CHECK_THROWS_WITH(sequence({}), Contains("at least one guide"));
}

TEST_CASE("options are validated with the nearest right name", "[spec][errors]") {
  CHECK_THROWS_WITH(PlannerSpec::make("rrt", {{"stepp", 0.5}}),
                    Contains("unknown option 'stepp'") && Contains("'step'"));
  CHECK_THROWS_WITH(PlannerSpec::make("rtr", {}), Contains("unknown planner 'rtr'"));
  CHECK_THROWS_WITH(GuideSpec::make("shrnk", {}), Contains("did you mean 'shrink'?"));
  CHECK_THROWS_WITH(PlannerSpec::make("rrt", {{"step", 0.0}}), Contains("'step'") && Contains("at least 1e-06"));
  CHECK_THROWS_WITH(PlannerSpec::make("rrt", {{"step", std::nan("")}}), Contains("'step'"));
  CHECK_THROWS_WITH(PlannerSpec::make("rrt", {{"step", std::string("long")}}),
                    Contains("a number") && Contains("\"long\""));
  CHECK_THROWS_WITH(GuideSpec::make("shrink", {{"scale", 1.5}}), Contains("in (0, 1]") && Contains("1.5"));
  CHECK_THROWS_WITH(GuideSpec::make("lazy", {{"evidence", 2.5}}), Contains("an integer"));
}

TEST_CASE("a spec prints as it is written, as a tree, and as JSON with a stable hash", "[spec]") {
  const auto nested = guide("skeleton") >> guide("shrink") >> guide("lazy") >> rrt();
  CHECK(nested.text() == "skeleton() >> shrink(0.5) >> lazy() >> rrt()");
  CHECK(nested.tree() ==
        "rrt()\n"
        "└─ lazy()  searched by rrt { goal_bias = 0, uniform = 0, bound = 0 }\n"
        "   └─ shrink(0.5)  searched by rrt()\n"
        "      └─ skeleton()  searched by graph_search()\n");
  CHECK((guide("skeleton") >> guide("shrink")).tree() ==
        "shrink(0.5)  searched by rrt()\n"
        "└─ skeleton()  searched by graph_search()\n");
  CHECK((guide("skeleton") + guide("goal_bias")).tree() ==
        "mixture\n"
        "├─ 0.5 x skeleton()  searched by graph_search()\n"
        "└─ 0.5 x goal_bias(0.05)  S = {0}\n");
  const auto mixed = (0.7 * guide("shrink", {{"scale", 0.3}}) + 0.3 * guide("goal_bias")) >> rrt();
  CHECK(mixed.text() == "(0.7*shrink(0.3) + 0.3*goal_bias(0.05)) >> rrt()");
  CHECK(nested.json() == (guide("skeleton") >> (guide("shrink") >> (guide("lazy") >> rrt()))).json());
  CHECK(nested.hash() != mixed.hash());
  CHECK(nested.json().find("\"scale\":0.5") != std::string::npos);
}

TEST_CASE("every component is described in full", "[registry]") {
  for (const auto* c : components()) {
    CAPTURE(c->name);
    CHECK_FALSE(c->summary.empty());
    CHECK_FALSE(c->source.empty());
    for (const auto& option : c->options) {
      CAPTURE(option.name);
      CHECK_FALSE(option.doc.empty());
      if (option.type == Option::Type::number) CHECK_FALSE(option.unit.empty());
      if (option.type == Option::Type::number) {
        const double d = std::get<double>(option.default_value);
        CHECK((std::isinf(d) || option.range.contains(d)));
      }
    }
    for (const auto& name : c->positional) CHECK(c->find(name) != nullptr);
  }
}

TEST_CASE("a default planner takes its lengths from the level above", "[spec]") {
  const auto tree = [](const StrategySpec& strategy) { return strategy.tree(); };
  const auto long_rrt = [](double step) { return PlannerSpec::make("rrt", {{"step", step}}); };
  CHECK(tree(guide("widen") >> guide("shrink") >> long_rrt(30.0)) ==
        "rrt { step = 30 }\n"
        "└─ shrink(0.5)  searched by rrt { step = 30 }\n"
        "   └─ widen(0)  searched by rrt_connect { step = 30 }\n");
  // A planner without that option passes it on; one that the script names keeps its own, for the levels below too.
  CHECK(tree(guide("shrink") >> guide("skeleton") >> long_rrt(30.0)) ==
        "rrt { step = 30 }\n"
        "└─ skeleton()  searched by graph_search()\n"
        "   └─ shrink(0.5)  searched by rrt { step = 30 }\n");
  CHECK(tree(guide("shrink") >> GuideSpec::make("shrink", {}, PlannerSpec::make("rrt", {})) >> long_rrt(30.0)) ==
        "rrt { step = 30 }\n"
        "└─ shrink(0.5)  searched by rrt()\n"
        "   └─ shrink(0.5)  searched by rrt()\n");
  // The roadmap's longest edge is a length; its number of neighbours is none.
  const PlannerSpec prm = PlannerSpec::make("prm", {{"radius", 3.0}, {"neighbours", std::int64_t{5}}});
  CHECK(tree(guide("lazy") >> prm) ==
        "prm { neighbours = 5, radius = 3 }\n"
        "└─ lazy()  searched by lazy_prm { radius = 3 }\n");
  // Without an explicit length nothing changes, and equal strategies have equal hashes.
  CHECK(tree(guide("shrink") >> PlannerSpec::make("rrt", {})).find("searched by rrt()") != std::string::npos);
  CHECK((guide("shrink") >> long_rrt(30.0)).hash() == (guide("shrink") >> long_rrt(30.0)).hash());
  CHECK((guide("shrink") >> long_rrt(30.0)).json() !=
        (GuideSpec::make("shrink", {}, PlannerSpec::make("rrt", {})) >> long_rrt(30.0)).json());
  // What runs is what is printed.
  const LevelExplanation root = explain(guide("shrink") >> long_rrt(2.0), test::cup_problem());
  REQUIRE(root.guide);
  const LevelExplanation& below = *root.guide->level;
  CHECK(below.common.step == 2.0);
  CHECK(below.inherited == std::vector<std::string>{"step"});
  CHECK_FALSE(below.planner_given);
}
