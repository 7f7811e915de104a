// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/motion/steering.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <trellis/motion/curves.hpp>
#include <trellis/motion/team_model.hpp>

namespace trellis {

namespace {

/// The controls of a model whose first control is the speed and whose second control steers; empty for other models.
struct Wheels {
  ControlAxis speed;
  ControlAxis turn;

  static std::optional<Wheels> of(const MotionModel& model) {
    if (model.dimension() != 3 || model.controls().size() != 2) return std::nullopt;
    return Wheels{model.controls()[0], model.controls()[1]};
  }
  /// Returns the least turning radius in metres at a speed > 0.
  [[nodiscard]] std::optional<double> radius(const MotionModel& model, View from, double at) const {
    const std::array<double, 2> hardest = {at, turn.hi};
    std::array<double, 3> rate{};
    model.derivative(from, hardest, rate);
    const double least = at / rate[2];
    if (!(least > 0.0) || !std::isfinite(least)) return std::nullopt;
    return least;
  }
  [[nodiscard]] Curve curve(View from, View to, double radius) const {
    const CurvePose a{from[0], from[1], from[2]};
    const CurvePose b{to[0], to[1], to[2]};
    return speed.lo < 0.0 ? reeds_shepp(a, b, radius) : dubins(a, b, radius);
  }
  /// A steering angle fixes the curvature at any speed; an angular speed must be proportional to the speed.
  [[nodiscard]] std::array<double, 2> control(double v, int side, double fastest) const {
    if (turn.name == "steering") return {v, side * turn.hi};
    // The rounded quotient must not exceed the bound.
    return {v, side * std::copysign(std::min(turn.hi, turn.hi * std::abs(v) / fastest), v)};
  }
};

/// Drives each robot of a team along a curve of its own; robots that arrive wait for the others.
/// \param curve  of a robot: from its model and the ends
/// \return none where a robot has no curve, or cannot wait
template <class F>
std::optional<Trajectory> steer_team(const TeamModel& team, View from, View to, const F& curve) {
  std::vector<Trajectory> curves;
  std::vector<std::uint32_t> durations;
  std::uint32_t longest = 0;
  Configuration a, b;
  for (const TeamModel::Part& part : team.parts()) {
    a.clear();
    b.clear();
    for (const std::size_t column : part.columns) {
      a.push_back(from[column]);
      b.push_back(to[column]);
    }
    auto own = curve(*part.model, a, b);
    if (!own) return std::nullopt;
    durations.push_back(std::accumulate(own->steps.begin(), own->steps.end(), 0U));
    longest = std::max(longest, durations.back());
    curves.push_back(std::move(*own));
  }
  for (std::size_t r = 0; r < curves.size(); ++r) {
    if (durations[r] < longest && !can_wait(*team.parts()[r].model)) return std::nullopt;
  }
  Trajectory trajectory{Configurations(team.controls().size()), {}, team.dt()};
  std::vector<std::size_t> piece(curves.size(), 0);
  std::vector<std::uint32_t> used(curves.size(), 0);
  for (std::uint32_t at = 0; at < longest;) {
    Configuration u(team.controls().size(), 0.0);
    std::uint32_t next = longest - at;
    for (std::size_t r = 0; r < curves.size(); ++r) {
      if (piece[r] == curves[r].steps.size()) continue;
      const View own = std::as_const(curves[r].controls)[piece[r]];
      std::copy(own.begin(), own.end(), u.begin() + static_cast<std::ptrdiff_t>(team.parts()[r].control));
      next = std::min(next, curves[r].steps[piece[r]] - used[r]);
    }
    trajectory.controls.push(u);
    trajectory.steps.push_back(next);
    at += next;
    for (std::size_t r = 0; r < curves.size(); ++r) {
      if (piece[r] == curves[r].steps.size()) continue;
      used[r] += next;
      if (used[r] < curves[r].steps[piece[r]]) continue;
      used[r] = 0;
      ++piece[r];
    }
  }
  return trajectory;
}

}  // namespace

std::optional<Trajectory> steer(const MotionModel& model, View from, View to) {
  if (const TeamModel* team = team_model(model)) {
    return steer_team(*team, from, to, [](const MotionModel& one, View a, View b) { return steer(one, a, b); });
  }
  if (const auto* clock = dynamic_cast<const PathClock*>(&model)) return clock->to(from[0], to[0]);
  const auto wheels = Wheels::of(model);
  const auto radius = wheels ? wheels->radius(model, from, wheels->speed.hi) : std::nullopt;
  if (!radius) return std::nullopt;
  Trajectory trajectory{Configurations(2), {}, model.dt()};
  for (const CurvePiece& piece : wheels->curve(from, to, *radius).pieces) {
    const double fastest = piece.length < 0.0 ? -wheels->speed.lo : wheels->speed.hi;
    // Take the fewest whole steps, at the speed at which they add up to the piece's length.
    const double steps = std::ceil(std::abs(piece.length) / (fastest * model.dt()) - 1e-9);
    if (steps < 1.0) continue;
    const auto control = wheels->control(piece.length / (steps * model.dt()), piece.turn, wheels->speed.hi);
    if (!model.allows(control)) return std::nullopt;
    trajectory.controls.push(control);
    trajectory.steps.push_back(static_cast<std::uint32_t>(steps));
  }
  return trajectory;
}

std::optional<Trajectory> steer_at(const MotionModel& model, View from, View to, double share) {
  if (const TeamModel* team = team_model(model)) {
    return steer_team(*team, from, to,
                      [&](const MotionModel& one, View a, View b) { return steer_at(one, a, b, share); });
  }
  if (const auto* clock = dynamic_cast<const PathClock*>(&model)) return clock->to(from[0], to[0]);
  const auto wheels = Wheels::of(model);
  if (!wheels) return std::nullopt;
  // A model that may stop could turn on the spot at almost zero speed: bound the speed from below.
  const double slowest = std::max(wheels->speed.lo, 0.1 * wheels->speed.hi);
  const double pace = slowest + share * (wheels->speed.hi - slowest);
  const auto radius = wheels->radius(model, from, pace);
  if (!radius) return std::nullopt;
  Trajectory trajectory{Configurations(2), {}, model.dt()};
  for (const CurvePiece& piece : wheels->curve(from, to, *radius).pieces) {
    const double v = piece.length < 0.0 ? -std::min(pace, -wheels->speed.lo) : pace;
    const double steps = std::round(std::abs(piece.length / v) / model.dt());
    if (steps < 1.0) continue;
    trajectory.controls.push(wheels->control(v, piece.turn, pace));
    trajectory.steps.push_back(static_cast<std::uint32_t>(steps));
  }
  return trajectory;
}

double steering_work(const MotionModel& model) {
  if (const TeamModel* team = team_model(model)) {
    return std::accumulate(team->parts().begin(), team->parts().end(), 0.0,
                           [](double sum, const TeamModel::Part& part) { return sum + steering_work(*part.model); });
  }
  const auto wheels = Wheels::of(model);
  if (!wheels) return 0.5;
  constexpr double dubins_work = 12.0;
  constexpr double reeds_shepp_work = 50.0;
  return wheels->speed.lo < 0.0 ? reeds_shepp_work : dubins_work;
}

}  // namespace trellis
