// SPDX-License-Identifier: GPL-3.0-or-later
// The search of every planner without a guide, as a digest: the exchange with guides must not change it.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/planner.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// A share of goal proposals, the others uniform: the guidance of a level without a guide.
class Unguided final : public Guidance {
 public:
  Unguided(const Instance& instance, double goal_bias)
      : uniform_(instance.space), goal_(instance), goal_bias_(goal_bias) {}
  Source sample(Stream& stream, MutableView out) override {
    if (stream.uniform() < goal_bias_) return goal_.sample(stream, out);
    uniform_.sample(stream, out);
    return 1;
  }
  void record(DensityRecord& record, double share) const override {
    goal_.record(record, share * goal_bias_);
    uniform_.record(record, share * (1.0 - goal_bias_));
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"goal", "uniform"}; }

 private:
  UniformGuidance uniform_;
  GoalGuidance goal_;
  double goal_bias_;
};

/// FNV-1a, 64 bits.
class Fingerprint {
 public:
  template <class Values>
  void add(const Values& values) {
    for (const auto value : values) add_number(static_cast<std::uint64_t>(value));
  }
  void add_number(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      hash_ = (hash_ ^ ((value >> (8 * byte)) & 0xffU)) * 0x100000001b3ULL;
    }
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

/// Everything but coordinates, whose last bits depend on the mathematical library.
void add_search(Fingerprint& print, const Search& search, const Checks& checks, const Solution& solution) {
  print.add_number(static_cast<std::uint64_t>(solution.status));
  if (solution.solved()) print.add_number(solution.path.size());
  print.add_number(search.nodes.size());
  print.add_number(search.proposals.size());
  print.add(search.parents);
  print.add(search.fates);
  print.add(search.near);
  print.add(search.added);
  print.add(search.proposal_sources);
  print.add(search.validated);
  for (const auto& edge : search.edges) print.add(edge);
  print.add_number(checks.validity);
  print.add_number(checks.motion);
}

std::uint64_t fingerprint(const std::string& planner, std::vector<Options::Entry> given) {
  const PlannerKind& kind = *find_planner(planner);
  given.emplace_back("proposals", std::int64_t{3000});
  const Options options = Options::validate(*kind.component, given);
  const PlannerCommon common = kind.common(options);
  std::vector<Problem> problems;
  if (kind.kinodynamic) {
    problems = {test::driven(test::cup_problem()), test::driven(test::cup_problem(), "car")};
  } else {
    problems = {test::cup_problem(), test::trap_problem(), test::simple_passage_problem(), test::point_problem(3)};
  }
  Fingerprint print;
  for (const auto& problem : problems) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      auto instance = make_instance(problem);
      Unguided guidance(*instance, common.goal_bias);
      Search search(instance->space.dimension());
      auto plan = kind.make(options, {*instance, guidance, Stream(seed, "0", "proposals"), search, false});
      for (int solve = 0; solve < 2; ++solve) {
        const Solution solution = plan->solve(guidance, common.budget);
        // A lazy roadmap that has spent its proposals continues without them; these digests predate that.
        if (planner == "lazy_prm" && search.proposals.size() >= 3000) break;
        add_search(print, search, instance->checks, solution);
      }
    }
  }
  return print.value();
}

}  // namespace

TEST_CASE("without a guide a planner's search is the same as ever", "[planner][determinism][unguided][slow]") {
  struct Case {
    std::string planner;
    std::vector<Options::Entry> options;
    std::uint64_t expected;
  };
  // Those of rrt_star and prm_star are new since the motions of a point, in the last problem, are exact.
  const std::vector<Case> cases = {
      {"rrt", {}, 0xa05b9c9c28c0207eULL},
      {"rrt", {{"connect_goal", false}}, 0x16a31ffd1f497ce9ULL},
      {"rrt_connect", {}, 0xa1f09ab885995fdcULL},
      {"prm", {}, 0x1d26368afc094e35ULL},
      {"lazy_prm", {}, 0xc092762e2d4760b7ULL},
      {"lazy_prm",
       {{"remove", std::string("first")}, {"edges", std::string("coarse_to_fine")}, {"enhance", 1.0}},
       0xfd6738762d00897bULL},
      {"rrt_star", {}, 0xaee4e8eefc42b3ddULL},
      {"prm_star", {{"improve", 300.0}}, 0xdfec719cc1426a19ULL},
      {"lazy_prm_star", {{"improve", 300.0}}, 0x1473b301bde0db76ULL},
      {"lazy_rrg_star", {{"improve", 300.0}}, 0xc54476a64995bfd4ULL},
      {"kinodynamic_rrt", {}, 0x159c6195f5e651beULL},
      {"kinodynamic_rrt", {{"extend", std::string("curves")}}, 0x35acaadce732ae80ULL},
  };
  for (const auto& c : cases) {
    CAPTURE(c.planner, c.options.size());
    CHECK(fingerprint(c.planner, c.options) == c.expected);
  }
}
