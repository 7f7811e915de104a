// SPDX-License-Identifier: GPL-3.0-or-later
// The skeleton relaxes the space of a disc: where it reports that there is no path, the disc has none.
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

constexpr double radius = 0.1;

/// Boxes and discs, so many that about every second world has no path.
World clutter(Stream& stream, std::size_t obstacles) {
  std::vector<Obstacle> all;
  for (std::size_t i = 0; i < obstacles; ++i) {
    const std::string name = "obstacle " + std::to_string(i + 1);
    const Vec2 at{stream.uniform(0.0, 10.0), stream.uniform(0.0, 10.0)};
    if (stream.uniform() < 0.2) {
      all.push_back({name, Disc{at, stream.uniform(0.1, 0.7)}});
    } else {
      const Vec2 half{stream.uniform(0.1, 0.9), stream.uniform(0.1, 0.9)};
      all.push_back({name, Box2{at - half, at + half}});
    }
  }
  return World(Box2{{0, 0}, {10, 10}}, std::move(all));
}

/// A valid place; none after some tries.
std::optional<Configuration> place(Instance& instance, Stream& stream) {
  Configuration q(2);
  for (int tries = 0; tries < 200; ++tries) {
    instance.space.sample_uniform(stream, q);
    if (instance.valid(q)) return q;
  }
  return std::nullopt;
}

}  // namespace

TEST_CASE("the skeleton has a path wherever a disc has one", "[strategy][skeleton]") {
  const char* set = std::getenv("TRELLIS_RUNS");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  const std::uint64_t worlds = set != nullptr ? std::strtoull(set, nullptr, 10) : 300;
  const PlannerSpec alone = PlannerSpec::make("rrt_connect", {{"proposals", std::int64_t{3000}}});
  std::uint64_t none = 0;
  std::uint64_t found = 0;
  for (std::uint64_t i = 0; i < worlds; ++i) {
    Stream stream(i, "skeleton", "world");
    Problem problem =
        test::make_problem("clutter", clutter(stream, 40 + stream.below(50)), Robot::disc(radius), {0, 0}, {1, 1});
    const auto instance = make_instance(problem);
    const auto start = place(*instance, stream);
    const auto goal = place(*instance, stream);
    if (!start || !goal) continue;
    problem.start = *start;
    problem.goals = {*goal};
    const auto parent = make_instance(problem);
    const GuideKind& kind = *find_guide("skeleton");
    const auto guide = kind.make(Options::validate(*kind.component, {}));
    const auto sub = guide->project(*parent);
    const PlannerKind& search = *find_planner("graph_search");
    const Options none_given = Options::validate(*search.component, {});
    Search record(2);
    UniformGuidance uniform(sub->space);
    const Solution solution = search.make(none_given, {*sub, uniform, Stream(1, "skeleton", "search"), record, false})
                                  ->solve(uniform, search.common(none_given).budget);
    found += solution.solved() ? 1 : 0;
    if (solution.status != Status::no_path) continue;
    ++none;
    CAPTURE(i);
    CHECK_FALSE(execute(alone, problem, 1).solved);
  }
  CHECK(none > worlds / 10);
  CHECK(found > worlds / 10);
}
