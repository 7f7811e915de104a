// SPDX-License-Identifier: GPL-3.0-or-later
// The record of h, and of the sources of proposals and nodes.
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/planner.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// A constant, and how many of them were summed.
class Constant final : public Density {
 public:
  explicit Constant(double value) : value_(value) {}
  [[nodiscard]] double at(View) const override { return value_; }
  [[nodiscard]] bool mergeable(const Density& other) const override {
    return dynamic_cast<const Constant*>(&other) != nullptr;
  }
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override {
    double sum = 0.0;
    for (const auto& term : terms) sum += term.weight * term.density->at({});
    return std::make_shared<Constant>(sum);
  }

 private:
  double value_;
};

/// An h with a given density, which counts its calls.
class GivenDensity final : public Guidance {
 public:
  double uniform = 1.0;
  double atoms = 0.0;
  double unknown = 0.0;
  std::vector<std::pair<std::shared_ptr<const Density>, double>> others;
  std::uint64_t changes = 0;
  mutable int asked = 0;

  Source sample(Stream&, MutableView) override { return 0; }
  [[nodiscard]] std::uint64_t epoch() const override { return changes; }
  void record(DensityRecord& record, double share) const override {
    ++asked;
    record.add_uniform(share * uniform, 0.5);
    record.add_atoms(share * atoms);
    record.add_unknown(share * unknown);
    for (const auto& [density, of] : others) record.add(density, share * of);
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"other"}; }

  /// The density that the record must have.
  [[nodiscard]] double density() const {
    double sum = 0.5 * uniform;
    for (const auto& [density, share] : others) sum += share * density->at({});
    return sum;
  }
};

/// The problem as a planner can have it.
Problem fitting(const PlannerKind& kind, const Problem& problem) {
  return kind.kinodynamic ? test::driven(problem) : problem;
}

Search search_with(const PlannerKind& kind, const Problem& given, int solves = 1) {
  const Problem problem = fitting(kind, given);
  auto instance = make_instance(problem);
  UniformGuidance guidance(instance->space);
  Search search(instance->space.dimension());
  const Options options = Options::validate(*kind.component, {});
  auto planner = kind.make(options, {*instance, guidance, Stream(1, "0", "proposals"), search, false});
  for (int i = 0; i < solves; ++i) static_cast<void>(planner->solve(guidance, kind.common(options).budget));
  return search;
}

}  // namespace

TEST_CASE("a record is the mean of the densities that served", "[planner][density]") {
  DensityRecord record;
  CHECK_FALSE(record.exact());
  CHECK(std::isnan(record.at({})));
  GivenDensity h;
  const auto a = std::make_shared<Constant>(3.0);
  const auto b = std::make_shared<Constant>(7.0);
  double sum = 0.0;
  double atoms = 0.0;
  int served = 0;
  const auto serve = [&](int times) {
    for (int i = 0; i < times; ++i) record.served(h);
    served += times;
    sum += times * h.density();
    atoms += times * h.atoms;
    CHECK(record.exact());
    CHECK(record.total() == served);
    CHECK(record.at({}) == Approx(sum / served).epsilon(1e-12));
    CHECK(record.atoms() == Approx(atoms / served).margin(1e-15));
  };
  serve(5);
  h.uniform = 0.25;
  h.atoms = 0.25;
  h.others = {{a, 0.5}};
  ++h.changes;
  serve(10);
  h.others = {{b, 0.25}, {a, 0.25}};
  ++h.changes;
  serve(1);
  h.others = {{b, 0.5}};
  ++h.changes;
  serve(4);
  CHECK(h.asked == 4);
  CHECK(record.terms() == 2);

  SECTION("a copy is independent") {
    const DensityRecord copy = record;
    const double before = copy.at({});
    for (int i = 0; i < 100; ++i) record.served(h);
    CHECK(copy.at({}) == before);
    CHECK(copy.total() == 20);
  }
  SECTION("compacting changes no value, and the record continues") {
    record.compact();
    CHECK(record.terms() == 1);
    CHECK(record.at({}) == Approx(sum / served).epsilon(1e-12));
    serve(3);
    h.others.clear();
    h.uniform = 1.0;
    h.atoms = 0.0;
    ++h.changes;
    serve(7);
  }
  SECTION("a part without closed form makes it inexact for good") {
    h.uniform = 0.2;
    h.unknown = 0.05;
    h.atoms = 0.25;
    ++h.changes;
    record.served(h);
    CHECK_FALSE(record.exact());
    CHECK(std::isnan(record.at({})));
    CHECK(record.unknown() == Approx(0.05 / 21));
    h.unknown = 0.0;
    ++h.changes;
    record.served(h);
    CHECK_FALSE(record.exact());
  }
}

TEST_CASE("a record of ever new densities has bounded size", "[planner][density]") {
  DensityRecord record;
  GivenDensity h;
  h.uniform = 0.0;
  double sum = 0.0;
  for (int i = 0; i < 30000; ++i) {
    h.others = {{std::make_shared<Constant>(i % 13), 1.0}};
    ++h.changes;
    record.served(h);
    sum += h.density();
  }
  CHECK(record.terms() < 5000);
  CHECK(record.at({}) == Approx(sum / 30000).epsilon(1e-9));
}

TEST_CASE("unless it says otherwise an h has no closed form", "[planner][density]") {
  class Silent final : public Guidance {
   public:
    Source sample(Stream&, MutableView) override { return 0; }
    [[nodiscard]] std::vector<std::string> sources() const override { return {"silent"}; }
  };
  DensityRecord record;
  record.served(Silent());
  CHECK(record.unknown() == 1.0);
  CHECK_FALSE(record.exact());
}

TEST_CASE("every planner's proposals are recorded with what h was", "[planner][density]") {
  for (const auto& kind : planner_kinds()) {
    if (kind.graph) continue;
    CAPTURE(kind.component->name);
    const auto search = search_with(kind, test::cup_problem());
    CHECK(search.density.total() == static_cast<double>(search.proposals.size()));
    CHECK(search.density.exact());
    CHECK(search.density.uniform() == 1.0);
    CHECK(search.density.at(test::cup_problem().start) ==
          Approx(std::exp(-test::cup_problem().space.log_volume())).epsilon(1e-12));
  }
}

TEST_CASE("nodes know their parents, and proposals the nodes that they grew from and became", "[planner][tree]") {
  const auto problem = test::cup_problem();
  const auto& space = problem.space;
  for (const auto& kind : planner_kinds()) {
    if (kind.graph) continue;
    CAPTURE(kind.component->name);
    const auto search = search_with(kind, problem, 2);
    const std::size_t n = search.nodes.size();
    REQUIRE(search.parents.size() == n);
    REQUIRE(search.near.size() == search.proposals.size());
    REQUIRE(search.added.size() == search.proposals.size());
    const std::string& name = kind.component->name;
    const bool tree = kind.kinodynamic || name.substr(0, 3) == "rrt" || name == "drrt";
    const bool grows = tree || name == "lazy_rrg_star";
    const bool hung_anew = name == "rrt_star";
    std::vector<char> seen(n, 0);
    for (std::size_t i = 0; i < search.proposals.size(); ++i) {
      const bool came = search.fates[i] != Fate::rejected;
      REQUIRE((search.added[i] != no_node) == came);
      REQUIRE((search.near[i] != no_node) == grows);
      if (grows) {
        // Nothing grows from a node that is yet to come.
        REQUIRE(search.near[i] < n);
        if (came) CHECK(search.near[i] < search.added[i]);
      }
      if (!came) continue;
      REQUIRE(search.added[i] < n);
      CHECK(seen[search.added[i]]++ == 0);
      if (tree && !hung_anew) CHECK(search.parents[search.added[i]] == search.near[i]);
      if (search.fates[i] == Fate::reached) {
        CHECK(space.distance(search.nodes[search.added[i]], search.proposals[i]) == 0.0);
      }
    }
    std::size_t roots = 0;
    for (std::uint32_t row = 0; row < n; ++row) {
      if (!tree) {
        CHECK(search.parents[row] == no_node);
        continue;
      }
      REQUIRE(search.parents[row] < n);
      roots += search.parents[row] == row ? 1 : 0;
      if (hung_anew) continue;
      if (name == "drrt") continue;  // its motions are the edges of roadmaps
      REQUIRE(search.parents[row] <= row);
      // The step of the trees; for a kinodynamic tree, the longest duration of a control, a second, at two metres per
      // second.
      CHECK(space.distance(search.nodes[search.parents[row]], search.nodes[row]) <=
            (kind.kinodynamic ? 2.3 : 0.5 + 1e-9));
    }
    // When resumed, a planner that keeps its tree creates no other one.
    if (tree) CHECK(roots == (name == "rrt_connect" ? 4 : hung_anew ? 1 : 2));
    CHECK(search.edges.empty() == tree);
    const auto checker = make_planar_checker(problem.scene, space, problem.resolution);
    for (const auto& [a, b] : search.edges) {
      REQUIRE(a < b);
      REQUIRE(b < n);
      if (name.substr(0, 4) != "lazy") CHECK(checker->motion(search.nodes[a], search.nodes[b]).valid);
    }
  }
}
