// SPDX-License-Identifier: GPL-3.0-or-later
// Roadmap metrics, information and shares of proposals: in worlds with closed forms, and by brute force.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include <trellis/experiment/search_metrics.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

struct Place {
  Problem problem;
  std::shared_ptr<Instance> instance;
  std::function<bool(View)> valid;
  std::function<bool(View, View)> motion;
  std::size_t motions = 0;

  explicit Place(Problem p) : problem(std::move(p)), instance(make_instance(problem)) {
    valid = [this](View q) { return instance->validity->state(q); };
    motion = [this](View a, View b) {
      ++motions;
      return instance->validity->motion(a, b).valid;
    };
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  [[nodiscard]] SearchMetrics measure(const Search& search, const SearchMetricsSettings& settings = {},
                                      std::uint64_t seed = 0) {
    return search_metrics(problem.space, search, valid, motion, settings, seed);
  }
};

/// Two rooms, 4.9 m wide, joined by a door of 1 m.
Problem rooms() {
  return test::make_problem("rooms", test::rectangle_world({{4.9, 0, 5.1, 4.5}, {4.9, 5.5, 5.1, 10}}), Robot::point(),
                            {1, 1}, {9, 9});
}

Search with_nodes(const std::vector<Configuration>& nodes) {
  Search search(nodes.front().size());
  for (const auto& q : nodes) {
    search.nodes.push(q);
    search.parents.push_back(no_node);
  }
  return search;
}

void propose(Search& search, const Configuration& q, Fate fate, std::uint32_t added = no_node) {
  search.proposals.push(q);
  search.fates.push_back(fate);
  search.near.push_back(no_node);
  search.added.push_back(added);
  search.proposal_sources.push_back(0);
}

using Classes = std::vector<NodeClass>;

}  // namespace

TEST_CASE("nodes of two rooms are what they do for the roadmap", "[experiment][search_metrics]") {
  Place place(rooms());
  const auto metrics = place.measure(with_nodes({
      {2, 2},        // alone
      {8, 2},        // alone, beyond the wall
      {2.001, 2},    // sees what the first sees
      {9, 8},        // sees the second, and its own corner
      {5, 1},        // inside the wall
      {5, 5},        // in the door
      {8, 2},        // there already
      {9.001, 8.0},  // sees what the one beside it sees
  }));
  CHECK(metrics.classes == Classes{NodeClass::create, NodeClass::create, NodeClass::oversample, NodeClass::expand,
                                   NodeClass::invalid, NodeClass::merge, NodeClass::oversample, NodeClass::oversample});
  CHECK(metrics.nodes == std::array<std::size_t, 5>{2, 1, 1, 3, 1});
  CHECK(metrics.components == 1);
}

TEST_CASE("coverage and connectivity of two rooms without a door", "[experiment][search_metrics]") {
  Place place(test::make_problem("closed", test::rectangle_world({{4.9, 0, 5.1, 10}}), Robot::point(), {1, 1}, {9, 9}));
  SearchMetricsSettings settings;
  settings.neighbours = 256;  // checks every witness
  const auto witnesses = valid_witnesses(place.problem.space, place.valid, settings.witnesses, 0);
  REQUIRE(witnesses.size() == 256);
  double left = 0.0;
  for (std::size_t i = 0; i < witnesses.size(); ++i) left += std::as_const(witnesses)[i][0] < 5.0 ? 1.0 : 0.0;
  const double right = 256.0 - left;
  const double pairs = 256.0 * 255.0 / 2.0;

  const auto one = place.measure(with_nodes({{2, 5}}), settings);
  CHECK(one.coverage == Approx(left / 256.0));
  CHECK(one.connectivity == Approx(left * (left - 1.0) / 2.0 / pairs));
  const auto both = place.measure(with_nodes({{2, 5}, {8, 5}, {3, 7}}), settings);
  CHECK(both.coverage == 1.0);
  CHECK(both.connectivity == Approx((left * (left - 1.0) + right * (right - 1.0)) / 2.0 / pairs));
  CHECK(both.classes == Classes{NodeClass::create, NodeClass::create, NodeClass::oversample});
  CHECK(both.components == 2);
}

TEST_CASE("a witness that two components see joins neither's others", "[experiment][search_metrics]") {
  // Through the door both rooms see some of the other's witnesses; only a node in the door joins them.
  Place place(rooms());
  SearchMetricsSettings settings;
  settings.neighbours = 256;
  const auto apart = place.measure(with_nodes({{4, 2}, {6, 2}}), settings);
  const auto joined = place.measure(with_nodes({{4, 2}, {6, 2}, {5, 5}}), settings);
  CHECK(apart.components == 2);
  CHECK(joined.components == 1);
  CHECK(joined.connectivity == Approx(joined.coverage * (256.0 * joined.coverage - 1.0) / 255.0));
  CHECK(apart.connectivity < joined.connectivity);
}

TEST_CASE("roadmap metrics are those of brute force", "[experiment][search_metrics]") {
  for (const auto& problem : {rooms(), test::point_problem(5), test::trap_problem()}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(problem.name, seed);
      Place place(problem);
      const auto& space = problem.space;
      SearchMetricsSettings settings;
      settings.neighbours = 6;
      settings.witnesses = 90;
      Stream stream(seed, "", "nodes");
      Search search(space.dimension());
      Configuration q(space.dimension());
      for (int i = 0; i < 120; ++i) {
        if (i % 10 != 9) space.sample_uniform(stream, q);  // some come twice
        search.nodes.push(q);
      }
      const auto metrics = place.measure(search, settings, seed);

      // Brute force: all neighbours and all witnesses, components by spreading labels.
      const auto witnesses = valid_witnesses(space, place.valid, settings.witnesses, seed);
      const auto nearest = [&](View to, const std::vector<View>& among) {
        std::vector<std::size_t> order(among.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
          return space.squared_distance(among[a], to) < space.squared_distance(among[b], to);
        });
        order.resize(std::min(order.size(), settings.neighbours));
        return order;
      };
      std::vector<View> nodes;
      std::vector<View> watched;
      for (std::size_t w = 0; w < witnesses.size(); ++w) watched.push_back(std::as_const(witnesses)[w]);
      std::vector<std::set<std::size_t>> seers(witnesses.size());
      std::vector<std::size_t> label;
      Classes classes;
      for (std::size_t i = 0; i < search.nodes.size(); ++i) {
        const View node = std::as_const(search.nodes)[i];
        if (!place.valid(node)) {
          classes.push_back(NodeClass::invalid);
          continue;
        }
        if (std::any_of(nodes.begin(), nodes.end(), [&](View v) { return space.distance(v, node) == 0.0; })) {
          classes.push_back(NodeClass::oversample);
          continue;
        }
        std::set<std::size_t> components;
        for (const std::size_t other : nearest(node, nodes)) {
          if (place.motion(nodes[other], node)) components.insert(label[other]);
        }
        bool news = false;
        for (const std::size_t w : nearest(node, watched)) {
          if (!place.motion(node, watched[w])) continue;
          news = news || seers[w].empty();
          seers[w].insert(nodes.size());
        }
        nodes.push_back(node);
        label.push_back(nodes.size() - 1);
        for (auto& l : label) {
          if (components.count(l) > 0) l = nodes.size() - 1;
        }
        classes.push_back(components.empty()      ? NodeClass::create
                          : components.size() > 1 ? NodeClass::merge
                          : news                  ? NodeClass::expand
                                                  : NodeClass::oversample);
      }
      CHECK(metrics.classes == classes);
      CHECK(metrics.components == std::set<std::size_t>(label.begin(), label.end()).size());
      double seen = 0.0;
      double joined = 0.0;
      for (std::size_t a = 0; a < seers.size(); ++a) {
        seen += seers[a].empty() ? 0.0 : 1.0;
        for (std::size_t b = 0; b < a; ++b) {
          std::set<std::size_t> mine;
          for (const std::size_t s : seers[a]) mine.insert(label[s]);
          joined +=
              std::any_of(seers[b].begin(), seers[b].end(), [&](std::size_t s) { return mine.count(label[s]) > 0; })
                  ? 1.0
                  : 0.0;
        }
      }
      const auto w = static_cast<double>(seers.size());
      CHECK(metrics.coverage == Approx(seen / w));
      CHECK(metrics.connectivity == Approx(joined / (w * (w - 1.0) / 2.0)));
    }
  }
}

TEST_CASE("information is what the labelled proposals foretell", "[experiment][search_metrics]") {
  const auto space = Space::euclidean({{0, 1}, {0, 1}});
  const auto anywhere = [](View) { return true; };
  const auto any_motion = [](View, View) { return true; };
  Search search(2);
  CHECK(std::isnan(search_metrics(space, search, anywhere, any_motion).information));
  // One valid sample predicts 2/3 everywhere; a repetition adds no information.
  propose(search, {0.5, 0.5}, Fate::rejected);
  CHECK(search_metrics(space, search, anywhere, any_motion).information == Approx(std::log(4.0 / 3.0)));
  propose(search, {0.5, 0.5}, Fate::rejected);
  const auto twice = search_metrics(space, search, anywhere, any_motion);
  CHECK(twice.information == Approx(std::log(4.0 / 3.0)));
  CHECK(twice.information_per_sample == Approx(0.5 * std::log(4.0 / 3.0)));
  // Five and more predict 6/7: the maximum with five neighbours.
  for (int i = 0; i < 9; ++i) propose(search, {0.1 * i, 0.3}, Fate::rejected);
  CHECK(search_metrics(space, search, anywhere, any_motion).information == Approx(std::log(12.0 / 7.0)));
  // Where validity ends within the space, samples of the one side mislead about the other, samples of both do not.
  const auto left = [](View q) { return q[0] < 0.95; };
  const auto blind = search_metrics(
      space, search, [](View q) { return q[0] < 0.9 || q[1] < 0.4; }, any_motion);
  CHECK(blind.information < std::log(12.0 / 7.0));
  Stream stream(1, "", "proposals");
  Search many(2);
  double before = -1.0;
  for (const int n : {10, 100, 1000}) {
    while (static_cast<int>(many.proposals.size()) < n) {
      propose(many, {stream.uniform(), stream.uniform()}, Fate::rejected);
    }
    const double now = search_metrics(space, many, left, any_motion).information;
    CHECK(now > before);
    CHECK(now < std::log(12.0 / 7.0));
    before = now;
  }
  // All labelled valid, most of the space invalid.
  Search wrong(2);
  for (int i = 0; i < 20; ++i) propose(wrong, {0.001 * i, 0.5}, Fate::rejected);
  CHECK(search_metrics(
            space, wrong, [](View q) { return q[0] < 0.1; }, any_motion)
            .information < 0.0);
}

TEST_CASE("every proposal falls into one share", "[experiment][search_metrics]") {
  Place place(rooms());
  auto search = with_nodes({{2, 2}, {2.001, 2}, {8, 8}});
  propose(search, {5, 1}, Fate::rejected);            // invalid
  propose(search, {5, 1.5}, Fate::advanced, 0);       // invalid, though a node came of it
  propose(search, {8, 1}, Fate::rejected);            // trapped
  propose(search, {2.002, 2}, Fate::reached, 1);      // redundant
  propose(search, {8.5, 8.5}, Fate::advanced, 2);     // useful
  propose(search, {8.5, 8.6}, Fate::advanced);        // its node is not recorded
  propose(search, {8.5, 1.0}, Fate::rejected);        // trapped
  propose(search, {2.001, 2.001}, Fate::reached, 1);  // redundant
  const auto metrics = place.measure(search);
  CHECK(metrics.invalid == 0.25);
  CHECK(metrics.trapped == 0.25);
  CHECK(metrics.redundant == 0.25);
  CHECK(metrics.useful == 0.25);
}

TEST_CASE("what is not there has no figure", "[experiment][search_metrics]") {
  Place place(rooms());
  const auto nothing = place.measure(Search(2));
  CHECK(nothing.classes.empty());
  for (const double x : {nothing.coverage, nothing.connectivity, nothing.information, nothing.information_per_sample,
                         nothing.invalid, nothing.trapped, nothing.redundant, nothing.useful}) {
    CHECK(std::isnan(x));
  }
  // No witness is valid.
  const auto space = place.problem.space;
  const auto search = with_nodes({{2, 2}});
  const auto blocked = search_metrics(
      space, search, [](View) { return false; }, place.motion);
  CHECK(blocked.classes == Classes{NodeClass::invalid});
  CHECK(std::isnan(blocked.coverage));
}

TEST_CASE("metrics of runs: trees are one component, and shares add up", "[experiment][search_metrics][slow]") {
  const auto guide = [](const char* name) { return GuideSpec::make(name, {}); };
  const auto rrt = PlannerSpec::make("rrt", {});
  const std::vector<StrategySpec> strategies = {rrt,
                                                PlannerSpec::make("rrt_connect", {}),
                                                PlannerSpec::make("prm", {}),
                                                PlannerSpec::make("lazy_prm", {}),
                                                PlannerSpec::make("rrt_star", {}),
                                                PlannerSpec::make("lazy_prm_star", {}),
                                                guide("skeleton") >> guide("shrink") >> guide("lazy") >> rrt};
  for (const auto& problem : {test::cup_problem(), test::simple_passage_problem()}) {
    for (const auto& strategy : strategies) {
      const auto run = execute(strategy, problem, 2);
      for (const auto& level : run.levels) {
        CAPTURE(problem.name, strategy.text(), level.name);
        const auto metrics = search_metrics(level.space, level.search, level.valid, level.valid_motion);
        CHECK(metrics.classes.size() == level.search.nodes.size());
        CHECK(std::accumulate(metrics.nodes.begin(), metrics.nodes.end(), std::size_t{0}) == metrics.classes.size());
        CHECK(metrics.nodes[0] >= metrics.components);
        if (level.planner == "rrt" && level.solves == 1) CHECK(metrics.components == 1);
        if (level.planner != "lazy_prm") CHECK(metrics.nodes[4] == 0);
        CHECK(metrics.coverage > 0.0);
        CHECK(metrics.connectivity <= metrics.coverage * metrics.coverage + 1e-2);
        const auto again = search_metrics(level.space, level.search, level.valid, level.valid_motion);
        CHECK(again.classes == metrics.classes);
        CHECK(again.connectivity == metrics.connectivity);
        if (level.search.proposals.empty()) continue;
        CHECK(metrics.invalid + metrics.trapped + metrics.redundant + metrics.useful == Approx(1.0));
        CHECK(again.information == metrics.information);
      }
    }
  }
}

TEST_CASE("few motions are checked for each node", "[experiment][search_metrics]") {
  const auto walled = test::make_problem("walled", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(),
                                         {1, 4, 0}, {9, 4, 0});
  for (const auto* planner : {"rrt", "rrt_connect", "prm"}) {
    CAPTURE(planner);
    const auto run = execute(PlannerSpec::make(planner, {{"proposals", std::int64_t{10000}}}), walled, 1);
    const auto& level = run.levels[0];
    std::size_t motions = 0;
    const auto metrics = search_metrics(level.space, level.search, level.valid, [&](View a, View b) {
      ++motions;
      return level.valid_motion(a, b);
    });
    CHECK(metrics.classes.size() > 2000);
    CHECK(motions < 4 * metrics.classes.size());
  }
}
