// SPDX-License-Identifier: GPL-3.0-or-later
// register_planner refuses what scripts and help could not use; its parts of a planning loop count and report.
#include <limits>
#include <utility>

#include "support/catch.hpp"
#include "support/recording_guidance.hpp"
#include "support/worlds.hpp"

#include <trellis/planner/own_planner.hpp>

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

struct OwnSettings : CommonSettings {
  double step = 0.5;
  std::int64_t tries = 1;
};

using Own = Settings<OwnSettings>;

class Idle final : public Planner {
 public:
  Idle(const OwnSettings& settings, PlannerContext context) : Planner(std::move(context)) {
    static_cast<void>(settings);
  }
  std::optional<Status> begin(const Budget& budget) override {
    static_cast<void>(budget);
    return Status::untried;
  }
  Outcome extend(View /*proposal*/) override { return {}; }
  Solution solution(Status status) override { return {status, {}}; }
};

Own named(const std::string& name, const std::string& summary = "a planner") {
  return {Component::Kind::planner, name, summary, ""};
}

/// Plans a step that it does not have.
class Waiting final : public Planner {
 public:
  explicit Waiting(PlannerContext context) : Planner(std::move(context)) {}
  std::optional<Status> begin(const Budget& /*budget*/) override { return std::nullopt; }
  Plan plan() override { return {.proposal = false}; }
  Outcome extend(View /*proposal*/) override { return {}; }
  Solution solution(Status status) override { return {status, {}}; }
};

void add(const Own& settings) {
  register_planner({.component = &settings.component(),
                    .common = [](const Options&) { return PlannerCommon(); },
                    .make = [](const Options&, PlannerContext context) -> std::unique_ptr<Planner> {
                      return std::make_unique<Idle>(OwnSettings(), std::move(context));
                    }});
}

}  // namespace

SCENARIO("register_planner refuses a planner that scripts could not use", "[planner][own]") {
  GIVEN("a name") {
    THEN("it is an identifier that no planner has") {
      CHECK_THROWS_WITH(add(with_common(named("rrt"))), Contains("there is a planner 'rrt' already"));
      CHECK_THROWS_WITH(add(with_common(named("my-rrt"))), Contains("must be an identifier, as my_rrt, got 'my-rrt'"));
      CHECK_THROWS_WITH(add(with_common(named(""))), Contains("got ''"));
    }
  }
  GIVEN("a description") {
    THEN("it has a summary, and the options of every planner") {
      CHECK_THROWS_WITH(add(with_common(named("own", ""))), Contains("planner 'own' has no summary"));
      CHECK_THROWS_WITH(add(named("own")),
                        Contains("has no option 'goal_bias', which every planner has") && Contains("with_common()"));
      CHECK_THROWS_WITH(add(with_common(Own(Component::Kind::guide, "own", "a guide", ""))),
                        Contains("'own' is declared as a guide"));
      CHECK_THROWS_WITH(register_planner({}), Contains("needs its component, common and make"));
    }
  }
  GIVEN("options") {
    THEN("each has a name, a description and a default that it accepts, once") {
      CHECK_THROWS_WITH(add(with_common(named("own").number("step", &OwnSettings::step, "m", Range::positive(), ""))),
                        Contains("option 'step' of planner 'own' has no description"));
      CHECK_THROWS_WITH(
          add(with_common(named("own").number("step", &OwnSettings::step, "m", Range::at_least(1), "longest step"))),
          Contains("option 'step' of planner 'own' has a default that it does not accept: "));
      CHECK_THROWS_WITH(
          add(with_common(named("own").integer("uniform", &OwnSettings::tries, "", Range::at_least(1), "tries"))),
          Contains("option 'uniform' of planner 'own' is declared twice"));
      CHECK_THROWS_WITH(
          add(with_common(named("own").integer("my tries", &OwnSettings::tries, "", Range::at_least(1), "tries"))),
          Contains("option 'my tries' of planner 'own' has a name that is no identifier"));
    }
  }
  GIVEN("planners that were used") {
    REQUIRE_FALSE(planner_kinds().empty());
    THEN("a planner comes too late") {
      CHECK_THROWS_WITH(add(with_common(named("late"))),
                        Contains("planner 'late' comes too late; register planners at the beginning"));
    }
  }
}

SCENARIO("a planner cannot wait without an end", "[planner][own]") {
  GIVEN("a planner that plans steps without a proposal, and does not override Planner::work") {
    const auto instance = make_instance(test::cup_problem());
    test::RecordingGuidance guidance(*instance);
    Search search(instance->space.dimension());
    const auto solve = [&](std::string_view name) {
      Waiting planner({.instance = *instance,
                       .guidance = guidance,
                       .proposals = Stream(1, "0", "proposals"),
                       .search = search,
                       .guided = false,
                       .name = name});
      planner.solve(guidance, Budget());
    };
    THEN("its first step throws, and says which planner it is") {
      CHECK_THROWS_AS(solve(""), Fault);
      CHECK_THROWS_WITH(solve(""), "the planner plans a step without a proposal, and does not override Planner::work");
      CHECK_THROWS_WITH(solve("waits"), Contains("the planner 'waits' plans a step without a proposal"));
      CHECK(guidance.outcomes.empty());
    }
  }
}
