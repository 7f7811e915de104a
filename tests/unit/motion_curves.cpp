// SPDX-License-Identifier: GPL-3.0-or-later
// The shortest curves of bounded curvature: Dubins', and Reeds and Shepp's.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/base/random.hpp>
#include <trellis/motion/curves.hpp>
#include <trellis/motion/motion_model.hpp>
#include <trellis/motion/steering.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double pi = std::numbers::pi;

CurvePose random_pose(Stream& stream, double extent) {
  return {stream.uniform(-extent, extent), stream.uniform(-extent, extent), stream.uniform(-pi, pi)};
}

double gap(const CurvePose& a, const CurvePose& b) {
  return std::hypot(a.x - b.x, a.y - b.y) + std::abs(std::remainder(a.theta - b.theta, 2.0 * pi));
}

/// Any curve of a few pieces.
Curve random_curve(Stream& stream, double radius, bool backwards) {
  Curve curve{{}, radius};
  const std::size_t count = 1 + stream.below(5);
  for (std::size_t i = 0; i < count; ++i) {
    const double length = stream.uniform(0.0, 2.5 * radius);
    const bool back = backwards && stream.uniform() < 0.5;
    curve.pieces.push_back({back ? -length : length, static_cast<int>(stream.below(3)) - 1});
  }
  return curve;
}

CurvePose end_of(const Curve& curve, const CurvePose& start) { return curve.at(start, 2.0 * curve.length() + 1.0); }

}  // namespace

TEST_CASE("curves lead from pose to pose, and are no shorter than the straight line", "[motion][curves]") {
  Stream stream(1, "", "poses");
  for (int i = 0; i < 3000; ++i) {
    // Near each other too, where the words with many turns are shortest.
    const double extent = i % 2 == 0 ? 5.0 : 0.7;
    const CurvePose a = random_pose(stream, extent);
    const CurvePose b = random_pose(stream, extent);
    const double radius = stream.uniform(0.2, 2.0);
    const Curve forwards = dubins(a, b, radius);
    const Curve both = reeds_shepp(a, b, radius);
    CHECK(gap(end_of(forwards, a), b) < 1e-9);
    CHECK(gap(end_of(both, a), b) < 1e-9);
    for (const CurvePiece& piece : forwards.pieces) CHECK(piece.length > 0.0);
    CHECK(both.length() >= std::hypot(a.x - b.x, a.y - b.y) - 1e-9);
    CHECK(both.length() <= forwards.length() + 1e-9);
    // Half of its length leads to its midpoint.
    const CurvePose middle = both.at(a, 0.5 * both.length());
    CHECK(reeds_shepp(a, middle, radius).length() <= 0.5 * both.length() + 1e-9);
  }
}

TEST_CASE("no other curve to the same pose is shorter", "[motion][curves]") {
  Stream stream(2, "", "curves");
  for (int i = 0; i < 20000; ++i) {
    const double radius = stream.uniform(0.2, 2.0);
    const CurvePose a = random_pose(stream, 3.0);
    const Curve forwards = random_curve(stream, radius, false);
    CHECK(dubins(a, end_of(forwards, a), radius).length() <= forwards.length() + 1e-7);
    const Curve both = random_curve(stream, radius, true);
    CHECK(reeds_shepp(a, end_of(both, a), radius).length() <= both.length() + 1e-7);
  }
}

TEST_CASE("Reeds and Shepp's length is a metric, Dubins' is one except for symmetry", "[motion][curves]") {
  Stream stream(3, "", "poses");
  for (int i = 0; i < 2000; ++i) {
    const CurvePose a = random_pose(stream, 2.0);
    const CurvePose b = random_pose(stream, 2.0);
    const CurvePose c = random_pose(stream, 2.0);
    const auto rs = [](const CurvePose& p, const CurvePose& q) { return reeds_shepp(p, q, 0.6).length(); };
    const auto forwards = [](const CurvePose& p, const CurvePose& q) { return dubins(p, q, 0.6).length(); };
    CHECK(rs(a, b) == Approx(rs(b, a)).margin(1e-9));
    CHECK(rs(a, c) <= rs(a, b) + rs(b, c) + 1e-9);
    CHECK(forwards(a, c) <= forwards(a, b) + forwards(b, c) + 1e-9);
    // The reversed motion with both headings turned around is the same curve.
    const auto about = [](CurvePose p) { return CurvePose{p.x, p.y, p.theta + pi}; };
    CHECK(forwards(a, b) == Approx(forwards(about(b), about(a))).margin(1e-9));
  }
}

TEST_CASE("known lengths", "[motion][curves]") {
  const CurvePose origin;
  CHECK(dubins(origin, {3, 0, 0}, 1.0).length() == Approx(3.0));
  CHECK(dubins(origin, {0, 2, pi}, 1.0).length() == Approx(pi));
  CHECK(dubins(origin, {0, -2, pi}, 1.0).length() == Approx(pi));
  CHECK(dubins(origin, {-3, 0, 0}, 1.0).length() > 3.0 + pi);
  CHECK(reeds_shepp(origin, {-3, 0, 0}, 1.0).length() == Approx(3.0));
  // Turning on the spot: three arcs of 60 degrees.
  CHECK(reeds_shepp(origin, {0, 0, pi}, 1.0).length() == Approx(pi));
  CHECK(reeds_shepp(origin, {0, 0, pi}, 0.5).length() == Approx(0.5 * pi));
  CHECK(dubins(origin, origin, 1.0).length() == Approx(0.0).margin(1e-12));
  CHECK(reeds_shepp(origin, origin, 1.0).length() == Approx(0.0).margin(1e-12));
}

TEST_CASE("steering drives models of bounded curvature close to where they are to go", "[motion][curves]") {
  Stream stream(4, "", "poses");
  struct Case {
    const char* model;
    std::vector<Options::Entry> given;
  };
  const std::vector<Case> cases = {{"unicycle1", {{"dt", 0.01}}},
                                   {"unicycle1", {{"dt", 0.01}, {"min_speed", 0.0}}},
                                   {"car", {{"dt", 0.01}, {"min_speed", -0.5}}},
                                   {"car", {{"dt", 0.01}, {"min_speed", 0.0}}}};
  const Space space = Space::se2({-50, 50}, {-50, 50});
  for (const auto& [name, given] : cases) {
    const MotionKind& kind = *find_motion(name);
    const auto model = kind.make(Options::validate(*kind.component, given));
    CAPTURE(model->text());
    for (int i = 0; i < 200; ++i) {
      const CurvePose a = random_pose(stream, 3.0);
      const CurvePose b = random_pose(stream, 3.0);
      const Configuration from = {a.x, a.y, a.theta};
      const Configuration to = {b.x, b.y, b.theta};
      const auto trajectory = steer(*model, from, to);
      REQUIRE(trajectory);
      const auto states = replay(*model, space, from, *trajectory);
      // Headings are exact, positions but for what a step turns.
      CHECK(std::abs(std::remainder(states.back()[2] - b.theta, 2.0 * pi)) < 1e-9);
      CHECK(std::hypot(states.back()[0] - b.x, states.back()[1] - b.y) < 0.05);
    }
  }
  const MotionKind& second = *find_motion("unicycle2");
  const auto model = second.make(Options::validate(*second.component, {}));
  CHECK_FALSE(steer(*model, Configuration(5, 0.0), Configuration(5, 1.0)));
}

TEST_CASE("steering at one speed keeps to what the controls allow, and ends near to where it is to go",
          "[motion][curves]") {
  Stream stream(5, "", "poses");
  const std::vector<Options::Entry> fine = {{"dt", 0.01}};
  const std::vector<Options::Entry> onwards = {
      {"dt", 0.01}, {"min_speed", 0.25}, {"max_speed", 0.5}, {"max_angular_speed", 0.5}};
  const Space space = Space::se2({-50, 50}, {-50, 50});
  for (const auto& [name, given] :
       {std::pair("unicycle1", fine), std::pair("unicycle1", onwards), std::pair("car", fine)}) {
    const MotionKind& kind = *find_motion(name);
    const auto model = kind.make(Options::validate(*kind.component, given));
    CAPTURE(model->text());
    for (int i = 0; i < 200; ++i) {
      const CurvePose a = random_pose(stream, 3.0);
      const CurvePose b = random_pose(stream, 3.0);
      const double share = stream.uniform();
      CAPTURE(share);
      const Configuration from = {a.x, a.y, a.theta};
      const auto trajectory = steer_at(*model, from, Configuration{b.x, b.y, b.theta}, share);
      REQUIRE(trajectory);
      for (std::size_t k = 0; k < trajectory->steps.size(); ++k) CHECK(model->allows(trajectory->controls[k]));
      const auto states = replay(*model, space, from, *trajectory);
      CHECK(std::abs(std::remainder(states.back()[2] - b.theta, 2.0 * pi)) < 0.05);
      CHECK(std::hypot(states.back()[0] - b.x, states.back()[1] - b.y) < 0.15);
    }
  }
  // The slower, the narrower a unicycle turns: about, it takes less room.
  const MotionKind& kind = *find_motion("unicycle1");
  const auto model = kind.make(Options::validate(*kind.component, onwards));
  const auto room = [&](double share) {
    const Configuration from = {0, 0, 0};
    const auto states = replay(*model, space, from, *steer_at(*model, from, Configuration{0, 0.9, pi}, share));
    double most = 0.0;
    for (std::size_t i = 0; i < states.size(); ++i) most = std::max(most, std::abs(states[i][1]));
    return most;
  };
  CHECK(room(0.0) < 1.2);
  CHECK(room(1.0) > 1.4);
}
