// SPDX-License-Identifier: GPL-3.0-or-later
// The motion model of a team: that of each robot, all at the same time.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/motion/steering.hpp>
#include <trellis/motion/team_model.hpp>

#include "support/catch.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::shared_ptr<const MotionModel> model_of(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  const MotionKind& kind = *find_motion(name);
  return kind.make(Options::validate(*kind.component, given));
}

const Space& se2() {
  static const Space space = Space::se2({-50, 50}, {-50, 50});
  return space;
}
const Space& trailer_space() {
  static const Space space("R^2 x SO(2)^2", Space::product({{1.0, se2()}, {1.0, Space::so2()}}).axes());
  return space;
}

/// A car, a unicycle of the second order and a car with a trailer.
struct Team {
  std::vector<std::shared_ptr<const MotionModel>> models = {model_of("car"), model_of("unicycle2"),
                                                            model_of("car_with_trailer")};
  std::shared_ptr<const TeamModel> model = std::make_shared<const TeamModel>(
      models, std::vector<std::vector<std::size_t>>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8, 9}});
  std::vector<Space> own = {se2(), state_space(se2(), *models[1]), trailer_space()};
  Space space = state_space(Space::product({{1.0, se2()}, {1.0, se2()}, {1.0, trailer_space()}}), *model);

  [[nodiscard]] Configuration part(std::size_t robot, View x) const {
    Configuration result;
    for (const std::size_t column : model->parts()[robot].columns) result.push_back(x[column]);
    return result;
  }
};

}  // namespace

TEST_CASE("a team takes the steps of each robot's own model, bit for bit", "[motion][team]") {
  const Team team;
  CHECK(team.model->dimension() == 12);
  CHECK(team.model->controls().size() == 6);
  CHECK(team.model->controls()[4].name == "speed3");
  CHECK(team.model->parts()[1].columns == std::vector<std::size_t>{3, 4, 5, 10, 11});
  CHECK(team.model->name() == "car, unicycle2, car_with_trailer");
  Stream stream(1, "team", "steps");
  Configuration x(12), u(6);
  for (int i = 0; i < 200; ++i) {
    team.space.sample_uniform(stream, x);
    team.model->sample_control(stream, u);
    REQUIRE(team.model->allows(u));
    std::vector<Configuration> each;
    bool admitted = true;
    for (std::size_t r = 0; r < 3; ++r) {
      each.push_back(team.part(r, x));
      admitted = admitted && team.models[r]->admits(each.back());
    }
    CHECK(team.model->admits(x) == admitted);
    for (int k = 0; k < 20; ++k) {
      team.model->step(team.space, x, u, x);
      for (std::size_t r = 0; r < 3; ++r) {
        team.models[r]->step(team.own[r], each[r], team.model->parts()[r].own(u), each[r]);
        REQUIRE(team.part(r, x) == each[r]);
      }
    }
  }
}

TEST_CASE("a control of 0 lets those robots wait that can", "[motion][team]") {
  CHECK(can_wait(*model_of("car")));
  CHECK(can_wait(*model_of("car", {{"min_speed", 0.0}})));
  CHECK(can_wait(*model_of("car_with_trailer")));
  CHECK_FALSE(can_wait(*model_of("car", {{"min_speed", 0.1}})));
  CHECK_FALSE(can_wait(*model_of("unicycle2")));
  Stream stream(2, "team", "waiting");
  for (const char* name : {"unicycle1", "car"}) {
    const auto model = model_of(name);
    Configuration x(3), after(3);
    for (int i = 0; i < 100; ++i) {
      se2().sample_uniform(stream, x);
      model->step(se2(), x, Configuration{0.0, 0.0}, after);
      REQUIRE(after == x);
    }
  }
}

TEST_CASE("robots of a team drive along the curves of their own models, and wait at their ends", "[motion][team]") {
  const auto car = model_of("car", {{"max_speed", 1.0}}), forwards = model_of("car", {{"min_speed", 0.0}});
  const TeamModel team({car, forwards}, {{0, 1, 2}, {3, 4, 5}});
  const Space space = Space::product({{1.0, se2()}, {1.0, se2()}});
  Stream stream(3, "team", "curves");
  Configuration a(6), b(6);
  for (int i = 0; i < 50; ++i) {
    space.sample_uniform(stream, a);
    space.sample_uniform(stream, b);
    for (std::size_t j : {0, 1, 3, 4}) {
      a[j] *= 0.1;
      b[j] *= 0.1;
    }
    const auto curve = steer(team, a, b);
    REQUIRE(curve.has_value());
    const Configurations states = replay(team, space, a, *curve);
    std::size_t longest = 0;
    for (std::size_t r = 0; r < 2; ++r) {
      const MotionModel& model = *team.parts()[r].model;
      const auto own = steer(model, View(a).subspan(3 * r, 3), View(b).subspan(3 * r, 3));
      REQUIRE(own.has_value());
      const Configurations alone = replay(model, se2(), View(a).subspan(3 * r, 3), *own);
      longest = std::max(longest, alone.size());
      for (std::size_t k = 0; k < states.size(); ++k) {
        const View at = std::as_const(alone)[std::min(k, alone.size() - 1)];
        REQUIRE(std::ranges::equal(std::as_const(states)[k].subspan(3 * r, 3), at));
      }
    }
    CHECK(states.size() == longest);
  }
  // One that cannot wait must not arrive earlier.
  const TeamModel hurried({car, model_of("car", {{"min_speed", 0.1}})}, {{0, 1, 2}, {3, 4, 5}});
  CHECK_FALSE(steer(hurried, Configuration{0, 0, 0, 0, 5, 0}, Configuration{30, 0, 0, 1, 5, 0}).has_value());
  CHECK(steer(hurried, Configuration{0, 0, 0, 0, 5, 0}, Configuration{0, 0, 0, 1, 5, 0}).has_value());
}

TEST_CASE("the clock of a path continues or stands still, and never goes back", "[motion][team]") {
  const PathClock clock(1.0, 0.1);
  const Space seconds("seconds", {{"along", 0.0, 1.05, 1.0, false}});
  Configuration at = {0.0};
  clock.step(seconds, at, Configuration{0.4}, at);
  CHECK(at[0] == 0.0);
  for (int k = 1; k <= 15; ++k) {
    clock.step(seconds, at, Configuration{0.7}, at);
    CHECK(at[0] == Approx(std::min(0.1 * k, 1.0)));
  }
  CHECK(steer(clock, Configuration{0.2}, Configuration{0.9})->steps == std::vector<std::uint32_t>{7});
  CHECK_FALSE(steer(clock, Configuration{0.9}, Configuration{0.2}).has_value());
}

TEST_CASE("a team whose models do not fit is refused", "[motion][team]") {
  CHECK_THROWS_WITH(TeamModel({model_of("car"), model_of("car", {{"dt", 0.2}})}, {{0, 1, 2}, {3, 4, 5}}),
                    Contains("steps of the same duration") && Contains("robot 2 has 0.2 s"));
  CHECK_THROWS_WITH(TeamModel({model_of("car"), model_of("car")}, {{0, 1, 2}, {3, 4}}),
                    Contains("robot 2 of the team has 2"));
}
