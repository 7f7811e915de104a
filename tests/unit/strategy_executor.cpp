// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <trellis/strategy/executor.hpp>

#include "support/bounded_loss.hpp"
#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/refuses.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}
PlannerSpec rrt(const std::vector<Options::Entry>& given = {}) { return PlannerSpec::make("rrt", given); }

/// Guides that search a space.
std::vector<GuideKind> searching() {
  std::vector<GuideKind> all;
  std::copy_if(guide_kinds().begin(), guide_kinds().end(), std::back_inserter(all), [](const GuideKind& kind) {
    return !kind.default_planner.empty() && kind.claims.needs != GuideClaims::Needs::team;
  });
  return all;
}

bool same(const Configurations& a, const Configurations& b) {
  return std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

ConvexShape rectangle_polygon(const Box2& box) { return Polygon{rectangle_vertices(box)}; }

std::uint64_t resolves(const LevelRecord& level) {
  const Resolves& of = level.resolves;
  return of.invalid_path + of.rejections + of.lost_place + of.presumed_valid + of.changed_world + of.new_turn +
         of.further_path + of.refuted_path;
}

void check_run(const Problem& problem, const RunRecord& run) {
  std::uint64_t checks = 0;
  for (const auto& level : run.levels) {
    checks += level.search.checks.validity;
    CHECK(level.root_nodes().size() == level.search.nodes.size());
    CHECK(level.root_proposals().size() == level.search.proposals.size());
    for (std::size_t i = 0; i < level.root_nodes().size(); i += 17) {
      CHECK(problem.space.contains(level.root_nodes()[i]));
    }
    // The root's rows are stored once.
    CHECK((&level.root_nodes() == &level.search.nodes) == (level.parent < 0));
    CHECK((&level.root_proposals() == &level.search.proposals) == (level.parent < 0));
    for (const auto source : level.search.proposal_sources) REQUIRE(source < level.search.sources.size());
    // Each solve after the first one has a reason.
    CAPTURE(level.name);
    CHECK(std::max<std::uint64_t>(level.solves, 1) == 1 + resolves(level));
  }
  CHECK(checks == run.validity_checks);
  if (!run.solved) return;
  const auto checker = make_planar_checker(problem.scene, problem.space, problem.resolution);
  REQUIRE_FALSE(run.improvements.empty());
  // A guide may raise the cost of edges: the path of least cost is then not the shortest one.
  CHECK(run.improvements.back().length <= run.length * (1.0 + 1e-12));
  CHECK(run.improvements.back().validity_checks <= run.validity_checks);
  CHECK(problem.space.distance(run.path.front(), problem.start) == 0.0);
  CHECK(problem.space.distance(run.path.back(), problem.goal()) <= problem.goal_tolerance);
  for (std::size_t i = 1; i < run.path.size(); ++i) CHECK(checker->motion(run.path[i - 1], run.path[i]).valid);
}

}  // namespace

TEST_CASE("every guide composes with every other, with all operators", "[executor][slow]") {
  const auto problem = test::cup_problem();
  int solved = 0;
  int runs = 0;
  const auto try_it = [&](const StrategySpec& strategy) {
    CAPTURE(strategy.text());
    const auto run = execute(strategy, problem, 1);
    check_run(problem, run);
    ++runs;
    solved += run.solved ? 1 : 0;
  };
  for (const auto& kind : searching()) {
    const GuideSpec a = guide(kind.component->name);
    try_it(a >> rrt());
    for (const auto* planner :
         {"rrt_connect", "prm", "lazy_prm", "rrt_star", "prm_star", "lazy_prm_star", "lazy_rrg_star"}) {
      try_it(a >> PlannerSpec::make(planner, {}));
    }
    for (const auto& guided : searching()) {
      const GuideSpec b = guide(guided.component->name);
      try_it((a + b) >> rrt());
      try_it(sequence({a, b}, 50) >> rrt());
      try_it(blend({a, b}) >> rrt());
      for (const auto* bias : {"uniform", "goal_bias", "gaussian", "bridge_test"}) try_it(guide(bias) >> b >> rrt());
      if (test::refuses(kind, guided, problem)) continue;
      try_it(a >> b >> rrt());
      for (const auto* bias : {"uniform", "goal_bias", "gaussian", "bridge_test"}) {
        try_it((0.8 * (a >> b) + 0.2 * guide(bias)) >> rrt());
      }
    }
  }
  CHECK(solved >= runs * 95 / 100);
}

TEST_CASE("each level's instance is solved before its parent's", "[executor]") {
  const auto run = execute(guide("skeleton") >> guide("shrink") >> guide("lazy") >> rrt(), test::cup_problem(), 3);
  REQUIRE(run.levels.size() == 4);
  const std::vector<std::string> names = {"root", "lazy()", "shrink(0.5)", "skeleton()"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& level = run.levels[i];
    CHECK(level.name == names[i]);
    CHECK(level.level == static_cast<int>(i));
    CHECK(level.parent == static_cast<int>(i) - 1);
    CHECK(level.solves >= 1);
    CHECK(level.solution.solved());
    // The deepest first, the root last.
    CHECK(level.solved_as == 3 - static_cast<int>(i));
  }
  CHECK(run.levels[0].solves == 1);
  CHECK(run.levels[3].space.dimension() == 2);
  // Presuming costs nothing: what is checked there validates the path that guides it, at a few points.
  CHECK(run.levels[1].search.checks.motion == 0);
  CHECK(run.levels[1].search.checks.validity < run.levels[0].search.checks.validity / 4);
}

TEST_CASE("a search in a lazy space validates edges of its candidates at its parent's expense, whatever the event",
          "[executor][lazy]") {
  const auto problem = test::trap_problem();
  for (const auto* event : {"shortest_path", "constant_depth", "heuristic_progress", "subpath_existence"}) {
    for (const auto* selector : {"alternate", "fail_fast"}) {
      CAPTURE(event, selector);
      const auto lazy = guide("lazy", {{"event", std::string(event)}, {"selector", std::string(selector)}});
      const auto run = execute(lazy >> rrt({{"step", 0.5}, {"bound", 0.0}}), problem, 2);
      check_run(problem, run);
      CHECK(run.solved);
      REQUIRE(run.levels.size() == 2);
      CHECK(run.levels[1].search.checks.validity == 0);
      CHECK(run.levels[0].guided_checks > 0);
      // One solve validates many candidates.
      CHECK(20 * run.levels[1].solves < run.levels[0].search.checks.validity);
    }
  }
  // Two levels of laziness, and one above a guide that searches for real.
  for (const StrategySpec& strategy : {guide("lazy") >> guide("lazy") >> rrt({{"step", 0.5}}),
                                       guide("shrink") >> guide("lazy") >> rrt({{"step", 0.5}}),
                                       guide("lazy") >> guide("shrink") >> rrt({{"step", 0.5}})}) {
    CAPTURE(strategy.text());
    const auto run = execute(strategy, problem, 2);
    check_run(problem, run);
    CHECK(run.solved);
  }
}

TEST_CASE("a lazy guide spends fewer checks than its planner alone around the cup", "[executor][lazy]") {
  std::uint64_t lazy = 0;
  std::uint64_t alone = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto guided = execute(guide("lazy") >> rrt({{"step", 0.5}, {"bound", 0.0}}), test::cup_problem(), seed);
    CHECK(guided.solved);
    lazy += guided.validity_checks;
    alone += execute(rrt({{"step", 0.5}}), test::cup_problem(), seed).validity_checks;
  }
  CHECK(2 * lazy < alone);
}

TEST_CASE("a guide's lift is part of the run, the same twice", "[executor]") {
  for (const auto* lift : {"uniform", "handles"}) {
    CAPTURE(lift);
    const StrategySpec strategy = guide("workspace", {{"lift", std::string(lift)}}) >> rrt({{"step", 0.5}});
    const auto one = execute(strategy, test::simple_passage_problem(), 3);
    const auto two = execute(strategy, test::simple_passage_problem(), 3);
    CHECK(one.solved);
    CHECK(same(one.path, two.path));
    CHECK(one.validity_checks == two.validity_checks);
    check_run(test::simple_passage_problem(), one);
  }
}

TEST_CASE("levels take turns, which account for all that they did", "[executor]") {
  const auto problem = test::cup_problem();
  const auto nested = guide("skeleton") >> guide("shrink") >> guide("lazy") >> rrt({{"step", 0.5}});
  const auto mixed = (guide("lazy") + guide("skeleton")) >> rrt();
  for (const StrategySpec& strategy : {StrategySpec(rrt()), nested, mixed}) {
    CAPTURE(strategy.text());
    const auto run = execute(strategy, problem, 1);
    std::vector<Turn> last(run.levels.size());
    std::vector<std::uint64_t> solves(run.levels.size(), 0);
    std::vector<bool> asked(run.levels.size(), false);
    for (const Turn& turn : run.turns) {
      const auto at = static_cast<std::size_t>(turn.level);
      CHECK(turn.proposals >= last[at].proposals);
      CHECK(turn.nodes >= last[at].nodes);
      CHECK((turn.solve_ended || turn.proposals + turn.nodes > last[at].proposals + last[at].nodes));
      CHECK((turn.path.empty() || turn.solve_ended));
      solves[at] += turn.solve_ended ? 1 : 0;
      // Nothing is drawn from guides none of which was solved.
      const auto parent = run.levels[at].parent;
      if (parent >= 0 && turn.solve_ended) asked[at] = true;
      const auto& sources = run.levels[at].search.proposal_sources;
      bool guided = false;
      for (std::size_t k = last[at].proposals; k < turn.proposals; ++k) guided = guided || sources[k] >= 3;
      bool any = false;
      for (std::size_t i = 0; i < run.levels.size(); ++i) {
        if (run.levels[i].parent == turn.level && asked[i]) any = true;
      }
      if (guided) CHECK(any);
      last[at] = turn;
    }
    REQUIRE(!run.turns.empty());
    CHECK(run.turns.back().level == 0);
    CHECK(run.turns.back().solve_ended);
    for (std::size_t i = 0; i < run.levels.size(); ++i) {
      const LevelRecord& level = run.levels[i];
      CHECK(last[i].proposals == level.search.proposals.size());
      CHECK(last[i].nodes == level.search.nodes.size());
      // The last turn is that of the planner beside the guided search, if it took a step.
      CHECK(solves[i] == level.solves + (i == 0 && run.bounded.unguided_proposals > 0 ? 1 : 0));
      CHECK(level.scene != nullptr);
      CHECK(level.presumed == (level.name == "lazy()"));
    }
    CHECK(same(run.turns.back().path, run.path));
  }
}

TEST_CASE("the same seed gives the same run, and times do not enter", "[executor][determinism]") {
  const auto strategy = guide("skeleton") >> guide("shrink") >> guide("lazy") >> rrt();
  const auto a = execute(strategy, test::cup_problem(), 5);
  const auto b = execute(strategy, test::cup_problem(), 5);
  REQUIRE(a.levels.size() == b.levels.size());
  for (std::size_t i = 0; i < a.levels.size(); ++i) {
    CHECK(same(a.levels[i].search.nodes, b.levels[i].search.nodes));
    CHECK(same(a.levels[i].search.proposals, b.levels[i].search.proposals));
    CHECK(same(a.levels[i].root_nodes(), b.levels[i].root_nodes()));
  }
  CHECK(same(a.path, b.path));
}

TEST_CASE("adding a level changes no other level's stream", "[executor][determinism]") {
  // shrink's own search is the same whether or not something beside it is searched too.
  const auto alone = execute((guide("shrink") + guide("uniform")) >> rrt(), test::cup_problem(), 7);
  const auto beside = execute((guide("shrink") + guide("identity")) >> rrt(), test::cup_problem(), 7);
  const auto first = [](const RunRecord& run) {
    const auto& p = run.levels[1].search.proposals;
    return std::vector<double>(p.values().begin(), p.values().begin() + 90);
  };
  REQUIRE(alone.levels[1].name == beside.levels[1].name);
  CHECK(first(alone) == first(beside));
}

TEST_CASE("shares of a mixture and of uniform proposals are what the spec says", "[executor][mixture]") {
  // The goal is walled in, so the budget of proposals is drawn in full.
  const auto problem = test::make_problem("walled", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(),
                                          {1, 5, 0}, {9, 5, 0});
  const auto strategy = (0.7 * guide("uniform") + 0.3 * guide("gaussian")) >>
                        rrt({{"uniform", 0.2}, {"goal_bias", 0.1}, {"bound", 0.0}, {"proposals", std::int64_t{20000}}});
  const auto run = execute(strategy, problem, 1);
  const auto& search = run.levels[0].search;
  std::vector<double> share(search.sources.size(), 0.0);
  for (const auto source : search.proposal_sources) share[source] += 1.0 / 20000.0;
  const auto of = [&](const std::string& name) {
    const auto it = std::find(search.sources.begin(), search.sources.end(), name);
    REQUIRE(it != search.sources.end());
    return share[static_cast<std::size_t>(it - search.sources.begin())];
  };
  CHECK(of("goal") == Approx(0.1).margin(0.01));
  CHECK(of("uniform") == Approx(0.9 * 0.2).margin(0.012));
  CHECK(of("gaussian(0.5)") == Approx(0.9 * 0.8 * 0.3).margin(0.012));
}

TEST_CASE("the weights of a blend follow what its parts' proposals achieved", "[executor][blend]") {
  // The goal is walled in. A goal bias proposes what is never reached; its share falls to the floor.
  const auto problem = test::make_problem("walled", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(),
                                          {1, 5, 0}, {9, 5, 0});
  const auto shares = [&](const BlendSettings& settings) {
    const auto run =
        execute(blend({guide("uniform"), guide("goal_bias", {{"share", 1.0}}), guide("uniform")}, settings) >>
                    rrt({{"uniform", 0.0}, {"goal_bias", 0.0}, {"bound", 0.0}, {"proposals", std::int64_t{6000}}}),
                problem, 1);
    std::vector<double> share(run.levels[0].search.sources.size(), 0.0);
    for (const auto source : run.levels[0].search.proposal_sources) share[source] += 1.0 / 6000.0;
    return std::vector<double>(share.begin() + 3, share.end());
  };
  for (const double floor : {0.1, 0.3}) {
    for (const std::string credit : {"node", "reach"}) {
      CAPTURE(floor, credit);
      const auto share = shares({.floor = floor, .decay = 0.98, .credit = credit});
      REQUIRE(share.size() == 3);
      CHECK(share[1] == Approx(floor / 3.0).margin(0.02));
      CHECK(share[0] + share[1] + share[2] == Approx(1.0).epsilon(1e-9));
    }
  }
  // All floor: an even mixture.
  for (const double share : shares({.floor = 1.0})) CHECK(share == Approx(1.0 / 3.0).margin(0.025));
}

TEST_CASE("a blend draws by the documented rule, step by step", "[executor][blend]") {
  const auto problem = test::cup_problem();
  const BlendSettings settings = {.floor = 0.25, .decay = 0.9, .credit = "node"};
  const auto strategy = blend({guide("uniform"), guide("goal_bias", {{"share", 0.9}})}, settings) >>
                        rrt({{"uniform", 0.0}, {"goal_bias", 0.0}, {"bound", 0.0}, {"connect_goal", false}});
  const auto first = execute(strategy, problem, 3);
  const auto& search = first.levels[0].search;
  // Brute force: the atoms of h at every step are those of the goal bias by the share that the fates so far give it.
  double successes[2] = {1.0, 1.0};
  double attempts[2] = {1.0, 1.0};
  std::size_t step = 0;
  ExecuteOptions options;
  options.watch = [&](const LevelRecord&, const Guidance& h) {
    const double w[2] = {successes[0] / attempts[0], successes[1] / attempts[1]};
    const double share = 0.5 * settings.floor + (1.0 - settings.floor) * w[1] / (w[0] + w[1]);
    CHECK(test::record_of(h).atoms() == Approx(0.9 * share).epsilon(1e-12));
    const auto part = static_cast<std::size_t>(search.proposal_sources[step] - 3);
    successes[part] = settings.decay * successes[part] + (search.fates[step] == Fate::rejected ? 0.0 : 1.0);
    attempts[part] = settings.decay * attempts[part] + 1.0;
    ++step;
  };
  execute(strategy, problem, 3, options);
  CHECK(step == search.proposals.size());
}

TEST_CASE("a level without a path reports it and the run continues", "[executor]") {
  // The shrunken robot's search has too small a budget to find anything.
  const auto weak = GuideSpec::make("shrink", {}, rrt({{"proposals", std::int64_t{5}}}));
  const auto run = execute(weak >> rrt(), test::cup_problem(), 1);
  CHECK(run.solved);
  CHECK(run.levels[1].solution.status == Status::budget_spent);
}

TEST_CASE("a level that is solved again says why", "[executor][resolves]") {
  Resolves all;
  bool exhausted = false;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    for (const auto& problem : {test::cup_problem(), test::simple_passage_problem()}) {
      for (const auto& strategy : {guide("shrink", {{"evidence", std::int64_t{5}}}) >> rrt(),
                                   guide("skeleton") >> guide("lazy") >> rrt(), guide("drop") >> rrt()}) {
        const auto run = execute(strategy, problem, seed);
        for (const LevelRecord& level : run.levels) {
          CAPTURE(level.name, seed);
          CHECK(level.solves == 1 + resolves(level));
          all.invalid_path += level.resolves.invalid_path;
          all.rejections += level.resolves.rejections;
          all.changed_world += level.resolves.changed_world;
          exhausted = exhausted || level.resolves.exhausted;
        }
        // No level requests another solve of the root; only the certificate of its path does.
        CHECK(resolves(run.levels.front()) == run.refuted_paths);
      }
    }
  }
  CHECK(all.invalid_path > 0);
  CHECK(all.rejections > 0);
}

TEST_CASE("a path that is refuted when no re-solve is left says so", "[executor][resolves]") {
  bool reached = false;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto run = execute(guide("shrink", {{"evidence", std::int64_t{1}}, {"resolves", std::int64_t{0}}}) >> rrt(),
                             test::simple_passage_problem(), seed);
    CHECK(run.levels[1].solves == 1);
    reached = reached || run.levels[1].resolves.limit_reached;
  }
  CHECK(reached);
}

TEST_CASE("a run records each shorter path with what it cost", "[executor][anytime]") {
  const auto star = PlannerSpec::make("rrt_star", {{"improve", std::int64_t{2000}}});
  std::size_t most = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto run = execute(StrategySpec(star), test::cup_problem(), seed);
    REQUIRE(run.solved);
    REQUIRE_FALSE(run.improvements.empty());
    most = std::max(most, run.improvements.size());
    for (std::size_t i = 1; i < run.improvements.size(); ++i) {
      CHECK(run.improvements[i].length < run.improvements[i - 1].length);
      CHECK(run.improvements[i].validity_checks >= run.improvements[i - 1].validity_checks);
      CHECK(run.improvements[i].cpu_seconds >= run.improvements[i - 1].cpu_seconds);
    }
    CHECK(run.improvements.back().length == Approx(run.length));
    CHECK(run.improvements.back().cpu_seconds <= run.cpu_seconds);
    CHECK(run.improvement_checks == run.validity_checks - run.improvements.front().validity_checks);
  }
  CHECK(most > 1);
  // Another planner ends with its first path.
  CHECK(execute(StrategySpec(rrt()), test::cup_problem(), 1).improvement_checks == 0);
}

TEST_CASE("a guided search keeps its path where the planner beside it ends without one", "[executor][anytime]") {
  const auto star =
      PlannerSpec::make("rrt_star", {{"proposals", std::int64_t{200}}, {"improve", std::int64_t{100000}}});
  const auto problem = test::trap_problem();
  std::size_t kept = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    CAPTURE(seed);
    const RunRecord run = execute(guide("skeleton") >> star, problem, seed);
    if (!run.solved) continue;
    CHECK(run.certified);
    CHECK(run.improvements.back().length <= run.length * (1.0 + 1e-12));
    const bool alone = execute(StrategySpec(star), problem, seed).solved;
    kept += run.bounded.unguided_won || alone ? 0 : 1;
  }
  CHECK(kept >= 5);
}

TEST_CASE("a guided run that is cut off has the first path of the whole run", "[executor][anytime]") {
  const auto star = PlannerSpec::make("lazy_prm_star", {{"proposals", std::int64_t{400}}});
  bool both = false;
  for (const auto& strategy : {guide("gaussian") >> star, guide("shrink", {{"scale", 0.5}}) >> star}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      CAPTURE(strategy.text(), seed);
      const RunRecord whole = execute(strategy, test::cup_problem(), seed);
      REQUIRE(whole.solved);
      REQUIRE_FALSE(whole.improvements.empty());
      const std::uint64_t first = whole.improvements.front().validity_checks;
      CHECK(whole.improvement_checks == whole.validity_checks - first);
      // A guide may raise the cost of edges: the path of least cost is then not the shortest one.
      CHECK(whole.improvements.back().length <= whole.length * (1.0 + 1e-12));
      for (std::size_t i = 1; i < whole.improvements.size(); ++i) {
        CHECK(whole.improvements[i].length < whole.improvements[i - 1].length);
        CHECK(whole.improvements[i].validity_checks >= whole.improvements[i - 1].validity_checks);
      }
      both = both || (whole.bounded.unguided_won && whole.levels.front().search.proposals.size() > 0);
      const RunRecord cut = execute(strategy, test::cup_problem(), seed, {.check_limit = 2 * first});
      REQUIRE_FALSE(cut.improvements.empty());
      CHECK(cut.improvements.front().validity_checks == first);
    }
  }
  CHECK(both);
}

TEST_CASE("a refuted path takes only its own point from the improvements", "[executor][anytime]") {
  const auto star = PlannerSpec::make("rrt_star", {{"improve", std::int64_t{500}}});
  Problem coarse = test::cup_problem();
  coarse.resolution = 0.6;
  std::size_t refuted = 0;
  std::size_t kept = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto run = execute(StrategySpec(star), coarse, seed);
    if (!run.solved || run.refuted_paths == 0) continue;
    ++refuted;
    REQUIRE_FALSE(run.improvements.empty());
    if (run.improvements.size() > 1) ++kept;
    for (std::size_t i = 1; i < run.improvements.size(); ++i) {
      CHECK(run.improvements[i].length < run.improvements[i - 1].length);
    }
    CHECK(run.improvements.back().length <= run.length * (1.0 + 1e-12));
  }
  CHECK(refuted > 0);
  CHECK(kept > 0);
}

TEST_CASE("seconds of the root bound the run with its set-up and its lower levels", "[executor]") {
  // No time at all: neither guide is set up, and no level begins.
  const PlannerSpec none = PlannerSpec::make("rrt", {{"seconds", 1e-12}, {"queries", 1.0}});
  const auto run = execute(guide("skeleton") >> guide("shrink") >> none, test::cup_problem(), 1);
  CHECK_FALSE(run.solved);
  CHECK(run.status == Status::budget_spent);
  CHECK_FALSE(run.bounded.guides_set_up);
  CHECK(run.set_up == 0.0);
  const PlannerSpec alone = PlannerSpec::make("rrt", {{"seconds", 1e-12}, {"bound", 0.0}});
  const auto unbounded = execute(guide("shrink") >> alone, test::cup_problem(), 1);
  CHECK(unbounded.status == Status::budget_spent);
  for (const LevelRecord& level : unbounded.levels) CHECK(level.search.proposals.empty());
}

TEST_CASE("a run ends at its limit of work, and its set-up is counted for it alone", "[executor]") {
  const StrategySpec strategy = guide("skeleton") >> guide("shrink") >> rrt();
  const auto whole = execute(strategy, test::cup_problem(), 1);
  REQUIRE(whole.solved);
  const auto cut = execute(strategy, test::cup_problem(), 1, {.measured = false, .work_limit = 0.5 * whole.work});
  CHECK(cut.status == Status::interrupted);
  CHECK(cut.work >= 0.5 * whole.work);
  CHECK(cut.work < whole.work);
  const auto same = execute(strategy, test::cup_problem(), 1, {.measured = false, .work_limit = 2.0 * whole.work});
  CHECK(same.validity_checks == whole.validity_checks);
  CHECK(same.work == whole.work);
  if (whole.bounded.guides_set_up) CHECK(whole.set_up > whole.bounded.set_up);
  const auto half =
      execute(strategy, test::cup_problem(), 1, {.measured = false, .check_limit = whole.validity_checks / 2});
  CHECK(half.status == Status::interrupted);
  CHECK(half.validity_checks >= whole.validity_checks / 2);
  CHECK(half.validity_checks < whole.validity_checks);
}

TEST_CASE("a sequence gives each space a turn and informs the next", "[executor][sequence]") {
  const auto problem = test::simple_passage_problem();
  const auto run = execute(sequence({guide("shrink"), guide("lazy")}, 10) >>
                               rrt({{"bound", 0.0}, {"step", 0.1}, {"proposals", std::int64_t{400}}}),
                           problem, 1);
  const auto& search = run.levels[0].search;
  std::string order;
  for (const auto source : search.proposal_sources) {
    if (source >= 3 && (order.empty() || order.back() != static_cast<char>('0' + source))) {
      order.push_back(static_cast<char>('0' + source));
    }
  }
  CHECK(order.substr(0, 4) == "3434");
  CHECK(run.levels[2].solves >= 1);
}

TEST_CASE("a problem is checked before anything runs, and the message names the obstacle", "[executor][errors]") {
  auto problem = test::cup_problem();
  problem.start = {6.75, 5, 0};
  CHECK_THROWS_WITH(execute(rrt(), problem, 1),
                    Contains("start (6.75, 5, 0) is in collision with") && Contains("obstacle 1"));
  problem = test::cup_problem();
  problem.goals = {{9, 5}};
  CHECK_THROWS_WITH(execute(rrt(), problem, 1), Contains("goal has 2 coordinates, expected 3 (x, y, theta)"));
  problem = test::cup_problem();
  problem.goals = {{11, 5, 0}};
  CHECK_THROWS_WITH(execute(rrt(), problem, 1), Contains("out of bounds") && Contains("x = 11") && Contains("[0, 10]"));
  problem = test::cup_problem();
  problem.goals = {{9, std::nan(""), 0}};
  CHECK_THROWS_WITH(execute(rrt(), problem, 1), Contains("finite number"));
  problem = test::cup_problem();
  problem.start = {0.1, 5, 0};
  CHECK_THROWS_WITH(execute(rrt(), problem, 1), Contains("the world's boundary"));
  problem = test::cup_problem();
  problem.resolution = 0.0;
  CHECK_THROWS_WITH(execute(rrt(), problem, 1), Contains("resolution"));
}

TEST_CASE("a hierarchy of unlimited depth is rejected", "[executor][errors]") {
  auto deep = guide("identity");
  for (int i = 0; i < 80; ++i) deep = guide("identity") >> deep;
  CHECK_THROWS_WITH(execute(deep >> rrt(), test::cup_problem(), 1), Contains("deeper than"));
}

TEST_CASE("both collision backends give the same run", "[executor]") {
  auto planar = test::cup_problem();
  auto fcl = planar;
  fcl.collision = "fcl";
  const auto a = execute(guide("shrink") >> rrt(), planar, 2);
  const auto b = execute(guide("shrink") >> rrt(), fcl, 2);
  CHECK(same(a.path, b.path));
  CHECK(a.validity_checks == b.validity_checks);
}

TEST_CASE("a run can be stopped at any proposal, and has done what the whole run does until there", "[executor]") {
  const auto problem = test::cup_problem();
  for (const char* planner : {"rrt", "rrt_connect", "prm", "lazy_prm", "rrt_star", "lazy_rrg_star"}) {
    const StrategySpec strategy =
        guide("skeleton") >> guide("shrink") >> guide("lazy") >> PlannerSpec::make(planner, {});
    CAPTURE(strategy.text());
    const auto whole = execute(strategy, problem, 3);
    std::uint64_t drawn = 0;
    std::uint64_t stop = 0;
    ExecuteOptions options;
    options.watch = [&](const LevelRecord&, const Guidance&) { ++drawn; };
    options.interrupted = [&] { return drawn >= stop; };
    for (const std::uint64_t at : {0, 1, 2, 63, 64, 65, 150, 301}) {
      drawn = 0;
      stop = at;
      const auto stopped = execute(strategy, problem, 3, options);
      if (stopped.status != Status::interrupted) {
        CHECK(same(stopped.path, whole.path));
        continue;
      }
      CHECK(test::check_part(stopped, whole) == at);
    }
  }
}

namespace {

/// Checks that two records of one run are bitwise equal, times ignored.
void check_same(const RunRecord& a, const RunRecord& b) {
  CHECK(a.status == b.status);
  CHECK(same(a.path, b.path));
  CHECK(a.validity_checks == b.validity_checks);
  CHECK(a.motion_checks == b.motion_checks);
  CHECK(a.shortcut_checks == b.shortcut_checks);
  CHECK(a.clearance == b.clearance);
  CHECK(a.improvements.size() == b.improvements.size());
  REQUIRE(a.turns.size() == b.turns.size());
  for (std::size_t i = 0; i < a.turns.size(); ++i) {
    CHECK(a.turns[i].level == b.turns[i].level);
    CHECK(a.turns[i].proposals == b.turns[i].proposals);
  }
  REQUIRE(a.levels.size() == b.levels.size());
  for (std::size_t i = 0; i < a.levels.size(); ++i) {
    CHECK(same(a.levels[i].search.nodes, b.levels[i].search.nodes));
    CHECK(same(a.levels[i].search.proposals, b.levels[i].search.proposals));
    CHECK(same(a.levels[i].solution.path, b.levels[i].solution.path));
    CHECK(same(a.levels[i].root_nodes(), b.levels[i].root_nodes()));
    CHECK(a.levels[i].search.sources == b.levels[i].search.sources);
    CHECK(a.levels[i].solves == b.levels[i].solves);
  }
}

}  // namespace

TEST_CASE("a run that stops and continues is the run that never stops", "[executor][execution]") {
  const auto problem = test::cup_problem();
  std::vector<StrategySpec> strategies = {
      rrt({{"connect_goal", false}}), (guide("shrink") + guide("workspace")) >> rrt(),
      guide("gaussian") >> guide("skeleton") >> rrt(), guide("skeleton") >> guide("shrink") >> rrt({{"bound", 2.0}})};
  for (const char* planner : {"rrt", "rrt_connect", "prm", "lazy_prm", "rrt_star", "prm_star", "lazy_rrg_star"}) {
    strategies.push_back(guide("skeleton") >> guide("shrink") >> guide("lazy") >> PlannerSpec::make(planner, {}));
  }
  for (const StrategySpec& strategy : strategies) {
    CAPTURE(strategy.text());
    const auto whole = execute(strategy, problem, 3, {.shortcut = 20});
    for (const std::uint64_t stride : {1, 7, 100}) {
      CAPTURE(stride);
      std::uint64_t drawn = 0;
      std::uint64_t stop = 0;
      ExecuteOptions options{.shortcut = 20};
      options.watch = [&](const LevelRecord&, const Guidance&) { ++drawn; };
      Execution execution(strategy, problem, 3, options);
      while (!execution.advance([&] { return drawn >= stop; })) {
        REQUIRE(drawn == stop);
        stop += stride;
        if (stride < 7) continue;
        // Its record changes nothing.
        const RunRecord so_far = execution.record();
        CHECK(so_far.status == Status::interrupted);
        CHECK_FALSE(so_far.solved);
        std::uint64_t proposals = 0;
        for (std::size_t i = 0; i < so_far.levels.size(); ++i) {
          const Search& search = so_far.levels[i].search;
          proposals += search.proposals.size();
          CHECK(search.fates.size() == search.proposals.size());
          const Configurations& own = execution.level(i).search.nodes;
          REQUIRE(own.size() <= search.nodes.size());
          CHECK(std::equal(own.values().begin(), own.values().end(), search.nodes.values().begin()));
        }
        CHECK(proposals == drawn);
        if (execution.companion() != nullptr) CHECK(execution.companion()->level == -1);
      }
      check_same(execution.record(), whole);
    }
  }
}

TEST_CASE("a run that is stopped does nothing, and can be abandoned", "[executor][execution]") {
  const auto problem = test::cup_problem();
  const StrategySpec strategy = guide("skeleton") >> guide("shrink") >> rrt();
  for (const std::uint64_t at : {0, 1, 30}) {
    std::uint64_t drawn = 0;
    ExecuteOptions options;
    options.watch = [&](const LevelRecord&, const Guidance&) { ++drawn; };
    Execution execution(strategy, problem, 3, options);
    CHECK_FALSE(execution.advance([&] { return drawn >= at; }));
    CHECK(drawn == at);
    CHECK_FALSE(execution.advance([&] { return true; }));
    CHECK(drawn == at);
  }
  auto outside = problem;
  outside.start = {-1, -1, 0};
  CHECK_THROWS_AS(Execution(strategy, outside, 1), Error);
}

TEST_CASE("an error in a projection names all levels up to the root", "[executor]") {
  Body link{{rectangle_polygon({{0, -0.1}, {1, 0.1}})}, -1, {}, 0};
  const auto arm =
      test::make_problem("arm", World({{0, 0}, {10, 10}}, {}), Robot("arm", {link}, false, {5, 5}), {0}, {1});
  const auto written = GuideSpec::make("skeleton", {}, {}, {"script.lua", 7});
  CHECK_THROWS_WITH(
      execute(written >> guide("shrink") >> guide("lazy") >> rrt(), arm, 1),
      "script.lua:7: in skeleton() >> shrink(0.5) >> lazy() >> rrt, level 3 (problem 'arm', seed 1): skeleton: needs "
      "a robot whose reference point moves in the plane, or an arm of two links or more that is fixed to its base; the "
      "robot 'arm' has one joint, so that its tip stays on a circle");
}

TEST_CASE("a run that is not measured plans the same, and records no densities", "[executor]") {
  const StrategySpec strategy = guide("skeleton") >> guide("shrink") >> rrt();
  const auto measured = execute(strategy, test::cup_problem(), 3);
  const auto other = execute(strategy, test::cup_problem(), 3, {.measured = false});
  REQUIRE(measured.solved);
  CHECK(same(other.path, measured.path));
  REQUIRE(other.levels.size() == measured.levels.size());
  for (std::size_t i = 0; i < measured.levels.size(); ++i) {
    CHECK(same(other.levels[i].search.proposals, measured.levels[i].search.proposals));
    CHECK(same(other.levels[i].search.nodes, measured.levels[i].search.nodes));
    CHECK_FALSE(other.levels[i].proposal_density);
    CHECK(other.levels[i].lifted_nodes.empty());
  }
  CHECK(measured.levels.front().proposal_density);
  CHECK_FALSE(measured.levels.back().lifted_nodes.empty());
}

namespace {

/// A call of `watch`.
struct Shown {
  int level = 0;
  std::size_t proposals = 0;
  Configuration proposal;
  bool same_thread = false;

  friend bool operator==(const Shown&, const Shown&) = default;
};

/// Adds each call to a list.
std::function<void(const LevelRecord&, const Guidance&)> adding_to(std::vector<Shown>& shown) {
  return [&shown, caller = std::this_thread::get_id()](const LevelRecord& level, const Guidance&) {
    const View last = level.search.proposals.back();
    shown.push_back(
        {level.level, level.search.proposals.size(), {last.begin(), last.end()}, std::this_thread::get_id() == caller});
  };
}

/// Strategies whose trees are long enough for helper threads, which compute steps ahead from 64 nodes on.
std::vector<StrategySpec> long_searches() {
  return {rrt({{"step", 0.05}}), PlannerSpec::make("rrt_connect", {{"step", 0.05}}),
          guide("gaussian") >> rrt({{"step", 0.05}}), guide("shrink") >> rrt({{"step", 0.05}})};
}

}  // namespace

TEST_CASE("helper threads change nothing of what a run shows, proposal by proposal", "[executor][threads]") {
  for (const StrategySpec& strategy : long_searches()) {
    CAPTURE(strategy.text());
    std::vector<Shown> alone;
    std::vector<Shown> helped;
    ExecuteOptions options;
    options.watch = adding_to(alone);
    const RunRecord one = execute(strategy, test::trap_problem(), 2, options);
    options.watch = adding_to(helped);
    options.threads = 3;
    const RunRecord three = execute(strategy, test::trap_problem(), 2, options);
    CHECK(alone.size() > 1500);
    CHECK(alone == helped);
    CHECK(std::ranges::all_of(helped, &Shown::same_thread));
    CHECK(one.validity_checks == three.validity_checks);
    CHECK(std::ranges::equal(one.path.values(), three.path.values()));
  }
}

TEST_CASE("a run with helper threads ends at the proposal at which it is interrupted", "[executor][threads]") {
  for (const StrategySpec& strategy : long_searches()) {
    CAPTURE(strategy.text());
    const RunRecord whole = execute(strategy, test::trap_problem(), 2);
    for (const std::uint64_t at : {63, 400, 1200, 1500}) {
      CAPTURE(at);
      std::uint64_t drawn = 0;
      ExecuteOptions options{.threads = 3};
      options.watch = [&](const LevelRecord&, const Guidance&) { ++drawn; };
      options.interrupted = [&] { return drawn >= at; };
      const RunRecord stopped = execute(strategy, test::trap_problem(), 2, options);
      REQUIRE(stopped.status == Status::interrupted);
      CHECK(drawn == at);
      CHECK(test::check_part(stopped, whole) == at);
    }
  }
}

TEST_CASE("what `watch` throws leaves a run with helper threads", "[executor][threads]") {
  for (const StrategySpec& strategy : long_searches()) {
    CAPTURE(strategy.text());
    std::size_t drawn = 0;
    ExecuteOptions options{.threads = 3};
    options.watch = [&](const LevelRecord&, const Guidance&) {
      if (++drawn == 1200) throw std::runtime_error("enough");
    };
    CHECK_THROWS_WITH(execute(strategy, test::trap_problem(), 2, options), "enough");
    CHECK(drawn == 1200);
  }
}

TEST_CASE("once the planner beside a guided search has a path, no level draws again", "[executor][bound]") {
  // Mixtures and blends draw while their parts search in slices; the others wait for a search below. A tree has a path
  // at its last proposal; a roadmap may find it later, in its edges.
  const std::vector<StrategySpec> strategies = {
      (guide("skeleton") + guide("shrink")) >> rrt(),
      (guide("lazy") + guide("gaussian")) >> PlannerSpec::make("rrt_connect", {}),
      blend({guide("shrink"), guide("workspace")}) >> rrt(),
      blend({guide("lazy") >> guide("shrink"), guide("shrink")}) >> PlannerSpec::make("rrt_connect", {}),
      race({guide("lazy"), guide("shrink")}) >> rrt(),
      guide("shrink") >> guide("lazy") >> PlannerSpec::make("rrt_connect", {}),
  };
  std::size_t won = 0;
  std::size_t unfinished = 0;
  for (const Problem& problem : {test::cup_problem(), test::trap_problem()}) {
    for (const StrategySpec& strategy : strategies) {
      for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        CAPTURE(strategy.text(), problem.name, seed);
        std::vector<Shown> shown;
        ExecuteOptions options;
        options.watch = adding_to(shown);
        const RunRecord run = execute(strategy, problem, seed, options);
        REQUIRE(run.bounded.bound > 1.0);
        if (!run.bounded.unguided_won) continue;
        ++won;
        REQUIRE_FALSE(shown.empty());
        CHECK(shown.back().level == -1);
        CHECK(shown.back().proposals == run.bounded.unguided_proposals);
        // The search of a level below had not ended.
        unfinished += std::ranges::any_of(run.levels, [](const LevelRecord& level) {
          return level.parent >= 0 && !level.search.proposals.empty() && !level.solution.solved();
        });
        test::check_law(strategy, problem, seed);
      }
    }
  }
  CHECK(won >= 10);
  CHECK(unfinished >= 3);
}
