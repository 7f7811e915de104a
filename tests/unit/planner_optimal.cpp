// SPDX-License-Identifier: GPL-3.0-or-later
// Properties of asymptotically optimal planners: paths become shorter, and approach the shortest one.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/planner/connection.hpp>
#include <trellis/planner/planner.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// Uniform; receives the paths found.
class LengthRecorder final : public Guidance {
 public:
  explicit LengthRecorder(const Space& space) : uniform_(space) {}
  Source sample(Stream& stream, MutableView out) override { return uniform_.sample(stream, out); }
  void record(DensityRecord& record, double share) const override { uniform_.record(record, share); }
  void found(double length) override { lengths.push_back(length); }
  [[nodiscard]] std::vector<std::string> sources() const override { return uniform_.sources(); }

  std::vector<double> lengths;

 private:
  UniformGuidance uniform_;
};

struct Run {
  Solution solution;
  Search search;
  Checks checks;
  std::vector<double> reported;
  double length = std::numeric_limits<double>::infinity();
};

Run run(const std::string& planner, const Problem& problem, std::uint64_t seed, double improve, int solves = 1,
        std::vector<Options::Entry> given = {}) {
  const PlannerKind& kind = *find_planner(planner);
  auto instance = make_instance(problem);
  LengthRecorder guidance(instance->space);
  Run out;
  out.search = Search(instance->space.dimension());
  given.emplace_back("improve", improve);
  const Options options = Options::validate(*kind.component, given);
  auto search_planner = kind.make(options, {*instance, guidance, Stream(seed, "0", "proposals"), out.search, false});
  for (int i = 0; i < solves; ++i) out.solution = search_planner->solve(guidance, kind.common(options).budget);
  out.checks = instance->checks;
  out.reported = guidance.lengths;
  if (out.solution.solved()) out.length = path_length(problem.space, out.solution.path);
  return out;
}

const std::vector<std::string>& optimal_planners() {
  static const std::vector<std::string> names = {"rrt_star", "prm_star", "lazy_prm_star", "lazy_rrg_star"};
  return names;
}

Problem point_among(const std::string& name, const test::Rectangles& rectangles, const Configuration& start,
                    const Configuration& goal) {
  return test::make_problem(name, test::rectangle_world(rectangles), Robot::point(), start, goal);
}

/// The shortest path leads along the upper edge of the block, 8.63 m; the one along the lower edge has 9.62 m.
Problem corner() { return point_among("corner", {{4, 2, 5, 6}}, {1, 4.5}, {9, 4.5}); }
double round_corner() { return std::hypot(3.0, 1.5) + 1.0 + std::hypot(4.0, 1.5); }

}  // namespace

TEST_CASE("the more is spent, the shorter the path, and h hears of each better one", "[planner][optimal]") {
  for (const auto& planner : optimal_planners()) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      CAPTURE(planner, seed);
      double before = std::numeric_limits<double>::infinity();
      double first = 0.0;
      for (const double improve : {0.0, 50.0, 200.0, 800.0, 1600.0}) {
        const Run out = run(planner, test::cup_problem(), seed, improve);
        REQUIRE(out.solution.solved());
        if (improve == 0.0) first = out.length;
        CHECK(out.length <= before);
        before = out.length;
        REQUIRE_FALSE(out.reported.empty());
        CHECK(std::is_sorted(out.reported.rbegin(), out.reported.rend()));
        CHECK(std::adjacent_find(out.reported.begin(), out.reported.end()) == out.reported.end());
        CHECK(out.reported.front() == first);
        CHECK(out.reported.back() == out.length);
        if (improve == 0.0) CHECK(out.reported.size() == 1);
      }
      CHECK(before < first);
    }
  }
}

TEST_CASE("round one corner the paths come near the shortest", "[planner][optimal]") {
  const Problem problem = corner();
  for (const auto& planner : optimal_planners()) {
    for (const std::string connect : {"k_nearest", "within"}) {
      for (const std::uint64_t seed : {1, 2, 3}) {
        CAPTURE(planner, connect, seed);
        const Run out = run(planner, problem, seed, 2000, 1, {{"connect", connect}});
        REQUIRE(out.solution.solved());
        CHECK(out.length < 1.02 * round_corner());
        // The corners are cut by no more than the resolution of the checks lets pass.
        CHECK(out.length > round_corner() - 2.0 * problem.resolution);
      }
    }
  }
}

TEST_CASE("in an empty world the path is straight", "[planner][optimal]") {
  const Problem problem = point_among("empty", {}, {1, 2}, {9, 8});
  for (const auto& planner : optimal_planners()) {
    CAPTURE(planner);
    const Run out = run(planner, problem, 1, 2000);
    REQUIRE(out.solution.solved());
    CHECK(out.length < 1.01 * 10.0);
    // A roadmap joins start and goal at once, and no path is shorter.
    if (planner != "rrt_star") CHECK(out.search.proposals.size() == 0);
  }
}

TEST_CASE("the costs of RRT*'s tree are path lengths, and no neighbour gives a shorter path",
          "[planner][optimal][tree]") {
  const Problem problem = test::cup_problem();
  const auto& space = problem.space;
  for (const std::uint64_t seed : {1, 2, 3}) {
    // All nodes are neighbours, so that the tree has to be the shortest paths of the whole graph of valid motions.
    const Run out =
        run("rrt_star", problem, seed, 150, 1, {{"factor", 1000.0}, {"first_factor", 1000.0}, {"goal_bias", 0.0}});
    REQUIRE(out.solution.solved());
    const std::size_t n = out.search.nodes.size();
    const auto instance = make_instance(problem);
    std::vector<double> cost(n, std::numeric_limits<double>::infinity());
    cost[0] = 0.0;
    std::vector<std::vector<double>> length(n, std::vector<double>(n, std::numeric_limits<double>::infinity()));
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (!instance->motion(out.search.nodes[a], out.search.nodes[b]).valid) continue;
        length[a][b] = length[b][a] = space.distance(out.search.nodes[a], out.search.nodes[b]);
      }
    }
    // Bellman and Ford.
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t a = 0; a < n; ++a) {
        for (std::size_t b = 0; b < n; ++b) {
          if (cost[a] + length[a][b] >= cost[b]) continue;
          cost[b] = cost[a] + length[a][b];
          changed = true;
        }
      }
    }
    std::size_t same = 0;
    for (std::size_t row = 0; row < n; ++row) {
      CAPTURE(seed, row);
      double length_of_path = 0.0;
      std::size_t steps = 0;
      for (std::size_t at = row; out.search.parents[at] != at; at = out.search.parents[at]) {
        REQUIRE(steps++ < n);
        REQUIRE(std::isfinite(length[at][out.search.parents[at]]));
        length_of_path += length[at][out.search.parents[at]];
      }
      // A node passes a shorter path of its parent on to its own children, but not to their other neighbours.
      CHECK(length_of_path >= cost[row] * (1.0 - 1e-9));
      same += length_of_path <= cost[row] * (1.0 + 1e-9) ? 1 : 0;
    }
    CHECK(same > 9 * n / 10);
    double end = std::numeric_limits<double>::infinity();
    for (std::size_t row = 0; row < n; ++row) {
      if (space.distance(out.search.nodes[row], problem.goal()) > problem.goal_tolerance) continue;
      double length_of_path = 0.0;
      for (std::size_t at = row; out.search.parents[at] != at; at = out.search.parents[at]) {
        length_of_path += length[at][out.search.parents[at]];
      }
      end = std::min(end, length_of_path);
    }
    CHECK(out.length == Approx(end).epsilon(1e-12));
  }
}

TEST_CASE("Lazy-PRM* finds the paths of PRM* and checks a fraction of its edges", "[planner][optimal][lazy]") {
  for (const auto& problem : {test::cup_problem(), test::trap_problem(), corner(), test::point_problem(3)}) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
      CAPTURE(problem.name, seed);
      const Run eager = run("prm_star", problem, seed, 800);
      const Run lazy = run("lazy_prm_star", problem, seed, 800);
      REQUIRE(eager.solution.solved());
      REQUIRE(lazy.solution.solved());
      CHECK(lazy.search.proposals.size() == eager.search.proposals.size());
      CHECK(lazy.search.nodes.size() == eager.search.nodes.size());
      CHECK(lazy.length == Approx(eager.length).epsilon(1e-12));
      CHECK(lazy.reported.front() == Approx(eager.reported.front()).epsilon(1e-12));
      CHECK(10 * lazy.checks.motion < eager.checks.motion);
    }
  }
}

TEST_CASE("a resumed optimal planner continues with its tree or roadmap", "[planner][optimal]") {
  for (const auto& planner : optimal_planners()) {
    CAPTURE(planner);
    const Run once = run(planner, test::cup_problem(), 2, 300);
    const Run twice = run(planner, test::cup_problem(), 2, 300, 2);
    const Run longer = run(planner, test::cup_problem(), 2, 600);
    CHECK(twice.search.proposals.size() == once.search.proposals.size() + 300);
    CHECK(twice.length == longer.length);
    CHECK(twice.length <= once.length);
    // Without any proposal left nothing new is found.
    const auto spent = static_cast<std::int64_t>(once.search.proposals.size());
    const Run no_more = run(planner, test::cup_problem(), 2, 300, 2, {{"proposals", spent}});
    CHECK(no_more.solution.status == Status::budget_spent);
    CHECK(no_more.search.proposals.size() == once.search.proposals.size());
  }
}

TEST_CASE("a budget that ends while paths get shorter leaves the best one", "[planner][optimal]") {
  for (const auto& planner : optimal_planners()) {
    CAPTURE(planner);
    const Run out = run(planner, test::cup_problem(), 3, 1e6, 1, {{"proposals", std::int64_t{2000}}});
    CHECK(out.search.proposals.size() == 2000);
    CHECK(out.solution.solved());
    CHECK(out.length == out.reported.back());
  }
}

TEST_CASE("neighbours are as many or as far as the paper says", "[planner][optimal][nearest]") {
  const Space space = Space::euclidean({{0, 10}, {0, 5}, {0, 2}});
  NearestIndex index(space);
  Stream stream(1, "", "connection");
  Configuration q(3);
  std::vector<NearestIndex::Neighbour> near;
  for (std::size_t n = 1; n <= 2000; ++n) {
    space.sample_uniform(stream, q);
    const double log_n = std::log(static_cast<double>(n));
    Connection::k_nearest(space, 1.0).find(index, q, near);
    const auto k = static_cast<std::size_t>(std::ceil(std::numbers::e * 4.0 / 3.0 * log_n));
    CHECK(near.size() == std::min(k, index.size()));
    // zeta_3 = 4/3 pi, |C| = 100
    const double radius =
        2.0 * std::cbrt(4.0 / 3.0 * 100.0 / (4.0 / 3.0 * std::numbers::pi) * log_n / static_cast<double>(n));
    Connection::within(space, 1.0).find(index, q, near);
    for (const auto& neighbour : near) CHECK(neighbour.squared_distance <= radius * radius * (1.0 + 1e-12));
    std::vector<NearestIndex::Neighbour> wider;
    index.within(q, radius * (1.0 + 1e-9), wider);
    CHECK(near.size() == wider.size());
    index.add(q);
  }
  Connection(5, 0.5).find(index, q, near);
  CHECK(near.size() <= 5);
  for (const auto& neighbour : near) CHECK(std::sqrt(neighbour.squared_distance) <= 0.5);
}
