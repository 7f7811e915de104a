// SPDX-License-Identifier: GPL-3.0-or-later
// The density of a level's proposals, recorded during the run, compared with h at every step; and the queries that a
// level answers after the run.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}
PlannerSpec planner(const std::string& name, std::int64_t proposals = 3000) {
  return PlannerSpec::make(name, {{"proposals", proposals}});
}
GuideSpec with_planner(const std::string& name, const std::string& of) {
  return GuideSpec::make(name, {}, planner(of));
}

/// Every kind of guide under every combinator, with every planner somewhere.
std::vector<StrategySpec> strategies() {
  const auto shrink = guide("shrink");
  const auto lazy = guide("lazy");
  const auto skeleton = guide("skeleton");
  const auto identity = guide("identity");
  const auto bias = guide("goal_bias", {{"share", 0.3}});
  return {
      planner("rrt"),
      bias >> planner("rrt"),
      identity >> planner("rrt_connect"),
      shrink >> planner("prm"),
      lazy >> planner("lazy_prm"),
      skeleton >> planner("rrt"),
      (0.5 * guide("informed") + 0.5 * lazy) >> planner("rrt_star"),
      guide("informed") >> planner("lazy_prm_star"),
      with_planner("shrink", "lazy_rrg_star") >> planner("prm_star"),
      (0.5 * shrink + 0.3 * skeleton + 0.2 * bias) >> planner("rrt"),
      sequence({shrink, skeleton, bias}, 15) >> planner("rrt"),
      sequence({0.7 * lazy + 0.3 * guide("uniform"), skeleton}, 20) >> planner("rrt_connect"),
      skeleton >> shrink >> lazy >> planner("rrt"),
      blend({shrink, skeleton, bias}, {.floor = 0.1, .decay = 0.9}) >> planner("rrt"),
      (0.5 * (skeleton >> blend({shrink, lazy, guide("uniform")}, {.credit = "reach"})) + 0.5 * bias) >> planner("rrt"),
      shrink >> skeleton >> planner("rrt"),
      (0.6 * (bias >> with_planner("identity", "rrt")) + 0.4 * sequence({skeleton, shrink}, 30)) >> planner("prm"),
      sequence({skeleton >> with_planner("shrink", "prm"), lazy >> with_planner("shrink", "lazy_prm")}, 25) >>
          planner("rrt"),
      schedule({shrink, skeleton, bias}, {.turn = 40}) >> planner("rrt"),
      schedule({guide("shrink", {{"scale", 0.2}, {"evidence", std::int64_t{30}}}), lazy}) >> planner("rrt"),
      race({lazy, 0.5 * shrink + 0.5 * skeleton}, {.slice = 20}) >> planner("rrt_connect"),
      blend({shrink, skeleton, bias}, {.credit = "efficiency"}) >> planner("rrt"),
      blend({shrink, lazy}, {.credit = "reach", .rule = "exp3"}) >> planner("rrt"),
      split(skeleton >> planner("rrt"), {.depth = 2, .effort = 300}),
      split(planner("rrt_connect"), {.effort = 300}),
  };
}

/// A wall between start and goal, so that every proposal of the budget is drawn and spaces are solved again.
Problem walled() {
  return test::make_problem("walled", test::rectangle_world({{4, 0, 6, 4.95}, {4, 5.05, 6, 10}, {1, 7, 3, 8}}),
                            test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
}

std::vector<Problem> problems() { return {test::cup_problem(), test::point_problem(5), walled()}; }

/// Brute force: h at the probes, after every proposal.
struct Sums {
  Configurations probes;
  std::vector<double> densities;
  double atoms = 0.0;
  double proposals = 0.0;
};

/// The share of the mass in each cell of a grid, stratified: cells that hold samples, and those beside them, get many
/// points, the others a few.
struct Grid {
  const Space& space;
  std::vector<int> cells;

  explicit Grid(const Space& s) : space(s) {
    for (std::size_t j = 0; j < s.dimension(); ++j) cells.push_back(s.dimension() == 2 ? 25 : (j < 2 ? 20 : 8));
  }
  [[nodiscard]] std::size_t size() const {
    std::size_t n = 1;
    for (const int c : cells) n *= static_cast<std::size_t>(c);
    return n;
  }
  [[nodiscard]] std::size_t cell(View q) const {
    std::size_t at = 0;
    for (std::size_t j = 0; j < q.size(); ++j) {
      const auto& axis = space.axes()[j];
      const int i = static_cast<int>((q[j] - axis.lo) / (axis.hi - axis.lo) * cells[j]);
      at = at * static_cast<std::size_t>(cells[j]) + static_cast<std::size_t>(std::clamp(i, 0, cells[j] - 1));
    }
    return at;
  }
  /// Point i of a sequence that fills the cell evenly: the additive recurrence by powers of the root of x^(d+1) = x
  /// + 1.
  void point(std::size_t cell, int i, MutableView out) const {
    const double root = cells.size() == 2 ? 1.32471795724474603 : 1.22074408460575947;
    double share = 1.0;
    for (std::size_t j = cells.size(); j-- > 0;) {
      const auto n = static_cast<std::size_t>(cells[j]);
      const auto& axis = space.axes()[j];
      const double width = (axis.hi - axis.lo) / cells[j];
      share /= root;
      double u = 0.5 + share * (i + 1);
      u -= std::floor(u);
      out[j] = axis.lo + (static_cast<double>(cell % n) + u) * width;
      cell /= n;
    }
  }
};

struct Mass {
  std::vector<double> cells;
  std::vector<double> variances;
  double sum = 0.0;
};

/// The mass in a cell, and the variance of that estimate.
std::pair<double, double> integrate(const Grid& grid, const std::function<double(View)>& density, std::size_t cell,
                                    int points) {
  const double volume = std::exp(grid.space.log_volume()) / static_cast<double>(grid.size());
  Configuration q(grid.space.dimension());
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < points; ++i) {
    grid.point(cell, i, q);
    const double p = density(q) * volume;
    sum += p;
    squares += p * p;
  }
  return {sum / points, (squares / points - sum / points * sum / points) / points};
}

Mass integrate(const Grid& grid, const std::function<double(View)>& density, const std::vector<char>& dense) {
  Mass mass;
  for (std::size_t c = 0; c < grid.size(); ++c) {
    const auto [mean, variance] = integrate(grid, density, c, dense[c] != 0 ? 1000 : 8);
    mass.cells.push_back(mean);
    mass.variances.push_back(variance);
    mass.sum += mean;
  }
  return mass;
}

/// Cells within one of a sample's along every axis.
std::vector<char> beside(const Grid& grid, const Configurations& samples) {
  std::vector<char> dense(grid.size(), 0);
  Configuration q(grid.space.dimension());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::size_t around = 1;
    for (std::size_t j = 0; j < q.size(); ++j) around *= 3;
    for (std::size_t k = 0; k < around; ++k) {
      std::size_t digits = k;
      for (std::size_t j = 0; j < q.size(); ++j, digits /= 3) {
        const auto& axis = grid.space.axes()[j];
        q[j] = samples[i][j] + (static_cast<double>(digits % 3) - 1.0) * (axis.hi - axis.lo) / grid.cells[j];
      }
      grid.space.reflect(q);
      dense[grid.cell(q)] = 1;
    }
  }
  return dense;
}

/// The density integrates to one less its atoms, and samples fall where it says.
void check_distribution(const Space& space, const std::function<double(View)>& density, double atoms,
                        const Configurations& samples, const std::vector<char>& is_atom) {
  const Grid grid(space);
  auto mass = integrate(grid, density, beside(grid, samples));
  // A ball of two centimetres may lie between 1000 points.
  const auto refine = [&](std::size_t c) {
    const auto [mean, variance] = integrate(grid, density, c, 30000);
    mass.sum += mean - mass.cells[c];
    mass.cells[c] = mean;
    mass.variances[c] = variance;
  };
  std::vector<double> drawn(grid.size(), 0.0);
  double drawn_atoms = 0.0;
  const auto n = static_cast<double>(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    (is_atom[i] != 0 ? drawn_atoms : drawn[grid.cell(samples[i])]) += 1.0 / n;
  }
  CHECK(std::abs(drawn_atoms - atoms) < 5.0 * std::sqrt(atoms / n) + 1e-12);
  // Counts less the sum of the probabilities at each step are a martingale: their variance is at most the expected
  // count. Its quadratic sum over the cells, against its own expectation and spread.
  double statistic = 0.0;
  double cells = 0.0;
  for (std::size_t c = 0; c < grid.size(); ++c) {
    const auto squared = [&] {
      const double d = drawn[c] - mass.cells[c];
      return d * d / (mass.cells[c] / n + mass.variances[c]);
    };
    if (mass.variances[c] > 1e-6 || (mass.cells[c] * n >= 4.0 && squared() > 30.0)) refine(c);
    if (mass.cells[c] * n < 4.0) continue;
    statistic += squared();
    cells += 1.0;
  }
  CHECK(std::abs(mass.sum - (1.0 - atoms)) < 1e-2);
  CHECK(statistic < cells + 6.0 * std::sqrt(2.0 * cells) + 6.0);
}

}  // namespace

TEST_CASE("the recorded density is that of every step", "[executor][density][slow]") {
  for (const auto& problem : problems()) {
    for (const auto& strategy : strategies()) {
      CAPTURE(problem.name, strategy.text());
      // Where a run proposes, so that the probes of a second, equal run lie where it has density.
      const auto first = execute(strategy, problem, 1);
      std::map<std::string, Sums> sums;
      for (const auto& level : first.levels) {
        Sums& mine = sums[level.key];
        mine.probes = Configurations(level.space.dimension());
        Stream stream(1, level.key, "probes");
        Configuration q(level.space.dimension());
        const auto& proposals = level.search.proposals;
        for (int i = 0; i < 24; ++i) {
          level.space.sample_uniform(stream, q);
          if (i % 4 != 0 && !proposals.empty()) {
            const View at = proposals[stream.below(proposals.size())];
            for (std::size_t j = 0; j < q.size(); ++j) q[j] = at[j] + stream.uniform(-0.1, 0.1);
            level.space.reflect(q);
          }
          mine.probes.push(q);
        }
        mine.densities.assign(mine.probes.size(), 0.0);
      }
      ExecuteOptions options;
      options.watch = [&](const LevelRecord& level, const Guidance& h) {
        const DensityRecord now = test::record_of(h);
        // What the planner beside the guided search draws is in the record of level 0; what the halves of a split draw
        // is drawn for the whole as well.
        for (const LevelRecord* at = &first.levels[static_cast<std::size_t>(std::max(level.level, 0))];;
             at = &first.levels[static_cast<std::size_t>(at->parent)]) {
          Sums& mine = sums[at->key];
          mine.proposals += 1.0;
          mine.atoms += now.atoms();
          for (std::size_t i = 0; i < mine.densities.size(); ++i) {
            mine.densities[i] += now.at(std::as_const(mine.probes)[i]);
          }
          if (!at->name.ends_with(" half")) break;
        }
      };
      const auto run = execute(strategy, problem, 1, options);
      REQUIRE(run.levels.size() == first.levels.size());
      for (const auto& level : run.levels) {
        CAPTURE(level.name);
        const Sums& mine = sums[level.key];
        REQUIRE(mine.proposals == static_cast<double>(level.search.proposals.size()));
        REQUIRE(mine.proposals == level.search.density.total());
        REQUIRE(static_cast<bool>(level.proposal_density) == (mine.proposals > 0.0));
        REQUIRE(static_cast<bool>(level.root_proposal_density) == (mine.proposals > 0.0));
        // What is kept does not grow with the proposals; a split keeps what its halves do, and what is informed of ever
        // shorter paths a set for each.
        const auto halves = std::count_if(run.levels.begin(), run.levels.end(),
                                          [](const LevelRecord& one) { return one.name.ends_with(" half"); });
        const std::size_t shorter = strategy.text().find("informed") != std::string::npos ? 20 : 0;
        CHECK(level.search.density.terms() <= 6 * static_cast<std::size_t>(1 + halves) + shorter);
        if (mine.proposals == 0.0) continue;
        CHECK(level.proposal_atoms == Approx(mine.atoms / mine.proposals).margin(1e-12));
        for (std::size_t i = 0; i < mine.densities.size(); ++i) {
          const double q = level.proposal_density(std::as_const(mine.probes)[i]);
          CHECK(q == Approx(mine.densities[i] / mine.proposals).epsilon(1e-9).margin(1e-300));
        }
      }
    }
  }
}

TEST_CASE("proposals fall where the recorded density says, in S and lifted to the root", "[executor][density][slow]") {
  for (const auto& problem : {walled(), test::point_problem(5)}) {
    for (const auto& strategy : strategies()) {
      const auto run = execute(strategy, problem, 2);
      for (const auto& level : run.levels) {
        CAPTURE(problem.name, strategy.text(), level.name);
        const auto& search = level.search;
        if (search.proposals.size() < 100) continue;
        // The goal of S is the projection of the root's goal. Atoms are identified by their source, or because they are
        // proposed again, or are vertices of a path found in a space that guides and has these coordinates.
        std::vector<char> is_atom(search.proposals.size(), 0);
        std::map<std::vector<double>, int> times;
        for (std::size_t i = 0; i < is_atom.size(); ++i) {
          const View q = search.proposals[i];
          ++times[{q.begin(), q.end()}];
        }
        for (const auto& turn : run.turns) {
          const LevelRecord& below = run.levels[static_cast<std::size_t>(turn.level)];
          const bool guides = below.parent == level.level && !below.name.ends_with(" half");
          if (!guides || turn.path.dimension() != search.proposals.dimension()) continue;
          for (std::size_t i = 0; i < turn.path.size(); ++i) ++times[{turn.path[i].begin(), turn.path[i].end()}];
        }
        for (std::size_t i = 0; i < is_atom.size(); ++i) {
          const View q = search.proposals[i];
          is_atom[i] = times[{q.begin(), q.end()}] > 1 || search.proposal_sources[i] == 0 ? 1 : 0;
        }
        check_distribution(level.space, level.proposal_density, level.proposal_atoms, search.proposals, is_atom);
        check_distribution(problem.space, level.root_proposal_density, level.proposal_atoms, level.root_proposals(),
                           is_atom);
      }
    }
  }
}

TEST_CASE("a part of h without closed form leaves the level without a density", "[executor][density]") {
  const auto strategy = (0.9 * guide("shrink") + 0.1 * guide("gaussian")) >>
                        PlannerSpec::make("rrt", {{"bound", 0.0}, {"proposals", std::int64_t{1200}}});
  const auto run = execute(strategy, walled(), 1);
  CHECK_FALSE(run.levels[0].proposal_density);
  CHECK_FALSE(run.levels[0].root_proposal_density);
  CHECK(std::isnan(run.levels[0].proposal_atoms));
  CHECK(run.levels[0].search.density.unknown() == Approx(0.95 * 0.95 * 0.1).epsilon(1e-9));
  CHECK(run.levels[1].proposal_density);
}

TEST_CASE("an unguided level's density is uniform less the goal's atom", "[executor][density]") {
  const auto run = execute(PlannerSpec::make("rrt", {{"goal_bias", 0.2}}), test::cup_problem(), 1);
  const auto& level = run.levels[0];
  CHECK(level.proposal_atoms == Approx(0.2).epsilon(1e-12));
  CHECK(level.proposal_density(test::cup_problem().start) ==
        Approx(0.8 * std::exp(-level.space.log_volume())).epsilon(1e-12));
}

TEST_CASE("watching a run changes nothing of it", "[executor][density]") {
  const auto strategy = sequence({guide("shrink"), guide("skeleton")}, 10) >> planner("rrt");
  std::size_t shown = 0;
  ExecuteOptions options;
  options.watch = [&](const LevelRecord&, const Guidance&) { ++shown; };
  const auto a = execute(strategy, test::cup_problem(), 3);
  const auto b = execute(strategy, test::cup_problem(), 3, options);
  std::size_t proposals = 0;
  for (std::size_t i = 0; i < a.levels.size(); ++i) {
    const auto x = a.levels[i].search.nodes.values();
    const auto y = b.levels[i].search.nodes.values();
    CHECK(std::equal(x.begin(), x.end(), y.begin(), y.end()));
    proposals += b.levels[i].search.proposals.size();
  }
  CHECK(shown == proposals);
}

TEST_CASE("validity of a level can be asked after the run, and is counted nowhere", "[executor]") {
  const auto run =
      execute(guide("skeleton") >> guide("shrink") >> guide("lazy") >> planner("rrt"), test::cup_problem(), 1);
  for (const auto& level : run.levels) {
    CAPTURE(level.name);
    const auto& path = level.solution.path;
    REQUIRE(level.solution.solved());
    for (std::size_t i = 0; i < path.size(); ++i) {
      CHECK(level.valid(path[i]));
      if (i > 0) CHECK(level.valid_motion(path[i - 1], path[i]));
    }
    // Through the cup's back: only the lazy level may presume that this is free.
    const Configuration inside = {5, 5, 0};
    const Configuration beyond = {8, 5, 0};
    const std::size_t d = level.space.dimension();
    if (level.name != "lazy()") CHECK_FALSE(level.valid_motion(View(inside).first(d), View(beyond).first(d)));
  }
}
