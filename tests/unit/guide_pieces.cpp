// SPDX-License-Identifier: GPL-3.0-or-later
// Distributions of which h is composed, projections by the names of axes, and lifts.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/lifted.hpp>
#include <trellis/guide/pieces.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

const Space se2 = Space::se2({0, 10}, {0, 10});

Space some_axes(const std::vector<std::size_t>& places, double weight = 1.0) {
  std::vector<Axis> axes;
  for (const std::size_t i : places) {
    axes.push_back(se2.axes()[i]);
    axes.back().weight *= weight;
  }
  return {"S", axes};
}

Configurations path_of(const std::vector<Configuration>& points) {
  Configurations path(points.front().size());
  for (const auto& q : points) path.push(q);
  return path;
}

Options plain() { return Options::validate(along_settings().component(), {{"radius", 0.5}, {"window", 1.0}}); }

/// Mass of the density by uniform points, and by how much it may be wrong.
std::pair<double, double> mass(const Space& space, const std::function<double(View)>& density) {
  Stream stream(1, "0", "mass");
  Configuration q(space.dimension());
  constexpr int points = 60000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < points; ++i) {
    space.sample_uniform(stream, q);
    const double p = density(q) * std::exp(space.log_volume());
    sum += p;
    squares += p * p;
  }
  const double mean = sum / points;
  return {mean, 4.0 * std::sqrt(std::max(0.0, squares / points - mean * mean) / points)};
}

}  // namespace

TEST_CASE("axes are identified by their names in any order", "[guide][projection]") {
  const AxisProjection f(se2, some_axes({2, 0}));
  Configuration s(2);
  f.project(Configuration{1, 2, 3}, s);
  CHECK(s == Configuration{3, 1});
  Stream stream(1, "0", "lift");
  Configuration q(3);
  for (int i = 0; i < 50; ++i) {
    f.lift(Configuration{3, 1}, stream, q);
    CHECK(q[0] == 1);
    CHECK(q[2] == 3);
    CHECK(se2.contains(q));
  }
  CHECK_FALSE(f.identity());
  CHECK(AxisProjection(se2, se2).identity());
  CHECK(AxisProjection(se2, se2).log_fibre_volume() == 0.0);
  CHECK_FALSE(AxisProjection(se2, some_axes({1, 0, 2})).identity());
  CHECK_THROWS_WITH(AxisProjection(se2, Space::euclidean({{0, 1}, {0, 1}, {0, 1}})),
                    Contains("S has an axis 'z' that C lacks; C has: x, y, theta"));
  CHECK_THROWS_WITH(AxisProjection(se2, Space("S", {{"x", 0, 11}})), Contains("which is not within C's"));
}

TEST_CASE("a density over S that is lifted integrates to 1 over C, whatever S weighs", "[guide][density]") {
  for (const double weight : {1.0, 3.0}) {
    const Space s = some_axes({0, 1}, weight);
    const auto f = std::make_shared<const AxisProjection>(se2, s);
    const auto tube = TubeKernel(s, path_of({{2, 2}, {7, 6}}), 2.0 * weight).density();
    const LiftedDensity lifted(f, 2, tube);
    const auto [mean, error] = mass(se2, [&](View q) { return lifted.at(q); });
    CHECK(std::abs(mean - 1.0) < error);
    CHECK(lifted.mergeable(LiftedDensity(f, 2, tube)));
    const auto sum = lifted.sum({{std::make_shared<LiftedDensity>(f, 2, tube), 0.25}});
    CHECK(sum->at(Configuration{3, 3, 0}) == Approx(0.25 * lifted.at(Configuration{3, 3, 0})));
  }
}

TEST_CASE("h over S is lifted with its density, as it changes", "[guide][density]") {
  auto problem = test::simple_passage_problem();
  const auto parent = make_instance(problem);
  Instance sub = *parent;
  sub.space = Space("S", {parent->space.axes()[0], parent->space.axes()[1]});
  const ReachedIndex reached(sub.space, Configuration{1, 1});
  const auto f = std::make_shared<const AxisProjection>(parent->space, sub.space);
  std::vector<SumHeuristic::Part> parts;
  parts.push_back({3.0, along(path_of({{1, 1}, {1, 9}}), plain())->over(sub, reached)});
  parts.push_back({1.0, std::make_unique<UniformHeuristic>("uniform", sub.space)});
  LiftedHeuristic h(f, sub.space, std::make_unique<SumHeuristic>("sum", std::move(parts)), parent->start,
                    parent->goal(), LiftedHeuristic::Points::unknown, "lifted");
  DensityRecord record;
  Stream stream(1, "0", "proposals");
  Configuration q(3);
  for (int i = 0; i < 200; ++i) {
    h.sample(stream, q);
    record.served(h);
    CHECK(parent->space.contains(q));
    CHECK(test::record_of(h).at(q) > 0.0);
    Outcome outcome;
    outcome.fate = Fate::reached;
    outcome.proposal = outcome.added = q;
    h.observe(outcome, true);
  }
  REQUIRE(record.exact());
  const auto [mean, error] = mass(parent->space, [&](View x) { return record.at(x); });
  CHECK(std::abs(mean - 1.0) < error + 1e-9);
  const auto [now, within] = mass(parent->space, [of = test::record_of(h)](View x) { return of.at(x); });
  CHECK(std::abs(now - 1.0) < within + 1e-9);
  CHECK(record.terms() < 100);
}

TEST_CASE("a sum of distributions draws by its weights and has their density", "[guide][density]") {
  auto problem = test::simple_passage_problem();
  const auto parent = make_instance(problem);
  const ReachedIndex reached(parent->space, parent->start);
  std::vector<SumHeuristic::Part> parts;
  parts.push_back({1.0, ball({2, 2, 0}, 0.5)->over(*parent, reached)});
  parts.push_back({3.0, ball({8, 8, 0}, 0.5)->over(*parent, reached)});
  SumHeuristic sum("sum", std::move(parts));
  Stream stream(1, "0", "proposals");
  Configuration q(3);
  int first = 0;
  constexpr int draws = 4000;
  for (int i = 0; i < draws; ++i) {
    sum.sample(stream, q);
    first += q[0] < 5 ? 1 : 0;
  }
  CHECK(std::abs(first - draws / 4) < 4 * std::sqrt(draws * 0.25 * 0.75));
  const auto [mean, error] = mass(parent->space, [of = test::record_of(sum)](View x) { return of.at(x); });
  CHECK(std::abs(mean - 1.0) < error);
  CHECK(test::record_of(sum).at(Configuration{8, 8, 0}) ==
        Approx(3.0 * test::record_of(sum).at(Configuration{2, 2, 0})));
}

TEST_CASE("pieces are distinct, and lie in the space", "[guide]") {
  const auto path = path_of({{1, 1, 0}, {2, 2, 0}});
  CHECK(along(path, plain())->description().identity == along(path, plain())->description().identity);
  CHECK(along(path, plain())->description().identity !=
        along(path_of({{1, 1, 0}, {2, 3, 0}}), plain())->description().identity);
  CHECK(ball({1, 1}, 0.5)->description().identity != ball({1, 1}, 0.6)->description().identity);
  const auto parent = make_instance(test::simple_passage_problem());
  const ReachedIndex reached(parent->space, parent->start);
  CHECK_THROWS_WITH(along(path_of({{1, 1, 0}, {2, 20, 0}}), plain())->over(*parent, reached),
                    "along: point 2 of the path, (2, 20, 0), is outside of the space SE(2)");
  CHECK_THROWS_WITH(ball({1, 1}, 0.5)->over(*parent, reached), Contains("ball: its centre has 2 coordinates"));
  // Without any information.
  CHECK(test::record_of(*along(Configurations(3), plain())->over(*parent, reached)).at(parent->start) ==
        Approx(std::exp(-parent->space.log_volume())));
}
