// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/motion/curves.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

constexpr double pi = std::numbers::pi;
/// Smaller amounts count as rounding errors. The caller checks the end of each word, so this tolerance decides no
/// validity.
constexpr double slack = 1e-9;

/// Returns the angle in (-pi, pi].
double half_turns(double angle) {
  const double a = std::remainder(angle, 2.0 * pi);
  return a <= -pi ? a + 2.0 * pi : a;
}
/// Returns the angle in [0, 2 pi).
double whole_turn(double angle) {
  const double a = std::fmod(angle, 2.0 * pi);
  return a < 0.0 ? a + 2.0 * pi : a;
}

struct Polar {
  double r;
  double angle;
};
/// Polar coordinates of (x, y). A vector whose length is a rounding error has direction 0.
Polar polar(double x, double y) {
  const double r = std::hypot(x, y);
  return {r, r < slack ? 0.0 : std::atan2(y, x)};
}

CurvePose driven(const CurvePose& from, const CurvePiece& piece, double radius) {
  const double turned = piece.turn * piece.length / radius;
  if (piece.turn == 0) {
    return {from.x + piece.length * std::cos(from.theta), from.y + piece.length * std::sin(from.theta), from.theta};
  }
  const double r = piece.turn * radius;
  return {from.x + r * (std::sin(from.theta + turned) - std::sin(from.theta)),
          from.y - r * (std::cos(from.theta + turned) - std::cos(from.theta)), from.theta + turned};
}

/// Selects the shortest of the offered curves that reach the goal, at radius 1 from (0, 0, 0).
class Shortest {
 public:
  explicit Shortest(const CurvePose& goal) : goal_(goal) {}

  /// As `offer`, but removes whole turns that rounding makes of a turn by 0.
  void offer_forwards(std::vector<CurvePiece> pieces) {
    offer(pieces);
    constexpr double nearly = 1e-7;
    for (CurvePiece& piece : pieces) {
      if (piece.turn != 0 && piece.length > 2.0 * pi - nearly) piece.length = 0.0;
    }
    offer(pieces);
  }

  void offer(const std::vector<CurvePiece>& pieces) {
    Curve curve{pieces, 1.0};
    std::erase_if(curve.pieces, [](const CurvePiece& p) { return p.length == 0.0; });
    const double length = curve.length();
    if (!(length < length_)) return;
    const CurvePose end = curve.at({}, std::numeric_limits<double>::infinity());
    constexpr double exact = 1e-6;
    const double far = 1.0 + std::hypot(goal_.x, goal_.y);
    if (std::hypot(end.x - goal_.x, end.y - goal_.y) > exact * far ||
        std::abs(half_turns(end.theta - goal_.theta)) > exact) {
      return;
    }
    length_ = length;
    best_ = std::move(curve);
  }
  [[nodiscard]] Curve take() {
    if (!std::isfinite(length_)) throw Fault("no curve of bounded curvature was found");
    return std::move(best_);
  }

 private:
  CurvePose goal_;
  double length_ = std::numeric_limits<double>::infinity();
  Curve best_;
};

/// Returns the goal's pose in the frame of the start, in units of the radius.
CurvePose relative(const CurvePose& from, const CurvePose& to, double radius) {
  const double dx = (to.x - from.x) / radius;
  const double dy = (to.y - from.y) / radius;
  const double c = std::cos(from.theta);
  const double s = std::sin(from.theta);
  return {c * dx + s * dy, -s * dx + c * dy, half_turns(to.theta - from.theta)};
}

Curve scaled(Curve curve, double radius) {
  for (CurvePiece& piece : curve.pieces) piece.length *= radius;
  curve.radius = radius;
  return curve;
}

/// The words of Reeds and Shepp that begin with a forward left turn, with the section numbers of their paper. The other
/// words follow from these by mirroring the goal in time, in left and right, or by reversing the order.
class Words {
 public:
  Words(const CurvePose& goal, Shortest& shortest, bool backwards_in_time, bool mirrored, bool reversed)
      : shortest_(shortest), flip_(backwards_in_time ? -1.0 : 1.0), mirror_(mirrored ? -1 : 1), reversed_(reversed) {
    x_ = goal.x;
    y_ = goal.y;
    phi_ = goal.theta;
    if (reversed) {
      const double x = x_ * std::cos(phi_) + y_ * std::sin(phi_);
      y_ = x_ * std::sin(phi_) - y_ * std::cos(phi_);
      x_ = x;
    }
    if (backwards_in_time) {
      x_ = -x_;
      phi_ = -phi_;
    }
    if (mirrored) {
      y_ = -y_;
      phi_ = -phi_;
    }
  }

  void offer_all() {
    const double xi = x_ - std::sin(phi_);
    const double eta = y_ - 1.0 + std::cos(phi_);
    const Polar same = polar(xi, eta);  // between the centres of two left turns
    offer_same(same);
    const double xj = x_ + std::sin(phi_);
    const double etj = y_ - 1.0 - std::cos(phi_);
    offer_other(xj, etj);  // the last turn is to the right
  }

 private:
  static constexpr int left = 1;
  static constexpr int right = -1;

  void offer(std::vector<CurvePiece> pieces) {
    for (CurvePiece& piece : pieces) {
      piece.length *= flip_;
      piece.turn *= mirror_;
    }
    if (reversed_) std::reverse(pieces.begin(), pieces.end());
    shortest_.offer(pieces);
  }

  void offer_same(const Polar& centres) {
    const auto [r, angle] = centres;
    // C S C, 8.1.
    offer({{half_turns(angle), left}, {r, 0}, {half_turns(phi_ - angle), left}});
    // C | C C, 8.3.
    if (r <= 4.0 + slack) {
      const double u = -2.0 * std::asin(std::min(1.0, r / 4.0));
      const double t = half_turns(angle + 0.5 * u + pi);
      offer({{t, left}, {u, right}, {half_turns(phi_ - t + u), left}});
    }
    // C | C S C, 8.9.
    if (r >= 2.0) {
      const double straight = std::sqrt(r * r - 4.0);
      const double t = half_turns(angle + std::atan2(straight, -2.0));
      offer({{t, left}, {-0.5 * pi, right}, {2.0 - straight, 0}, {half_turns(phi_ - 0.5 * pi - t), left}});
    }
  }

  void offer_other(double xi, double eta) {
    const auto [r, angle] = polar(xi, eta);
    if (r >= 2.0) {
      // C S C, 8.2.
      const double straight = std::sqrt(r * r - 4.0);
      const double t = half_turns(angle + std::atan2(2.0, straight));
      offer({{t, left}, {straight, 0}, {half_turns(t - phi_), right}});
      // C | C S C, 8.10.
      const double turn = std::atan2(xi, -eta);
      offer({{turn, left}, {-0.5 * pi, right}, {2.0 - r, 0}, {half_turns(turn + 0.5 * pi - phi_), right}});
      // C | C S C | C, 8.11.
      const double u = 4.0 - straight;
      const double first = half_turns(std::atan2((4.0 - u) * xi - 2.0 * eta, -2.0 * xi + (u - 4.0) * eta));
      offer({{first, left}, {-0.5 * pi, right}, {u, 0}, {-0.5 * pi, left}, {half_turns(first - phi_), right}});
    }
    // C Cu | Cu C, 8.7.
    if (const double c = 0.25 * (2.0 + r); c <= 1.0) {
      const double u = std::acos(c);
      const auto [t, v] = ends(u, -u, xi, eta);
      offer({{t, left}, {u, right}, {-u, left}, {v, right}});
    }
    // C | Cu Cu | C, 8.8.
    if (const double c = (20.0 - r * r) / 16.0; c >= 0.0 && c <= 1.0) {
      const double u = -std::acos(c);
      const auto [t, v] = ends(u, u, xi, eta);
      offer({{t, left}, {u, right}, {u, left}, {v, right}});
    }
  }

  /// Computes the first and the last of four turns.
  [[nodiscard]] std::pair<double, double> ends(double u, double v, double xi, double eta) const {
    const double delta = half_turns(u - v);
    const double a = std::sin(u) - std::sin(delta);
    const double b = std::cos(u) - std::cos(delta) - 1.0;
    const double turn = std::atan2(eta * a - xi * b, xi * a + eta * b);
    const double side = 2.0 * (std::cos(delta) - std::cos(v) - std::cos(u)) + 3.0;
    const double first = half_turns(side < 0.0 ? turn + pi : turn);
    return {first, half_turns(first - u + v - phi_)};
  }

  Shortest& shortest_;
  double flip_;
  int mirror_;
  bool reversed_;
  double x_;
  double y_;
  double phi_;
};

}  // namespace

double Curve::length() const {
  double sum = 0.0;
  for (const CurvePiece& piece : pieces) sum += std::abs(piece.length);
  return sum;
}

CurvePose Curve::at(const CurvePose& start, double s) const {
  CurvePose pose = start;
  for (const CurvePiece& piece : pieces) {
    const double driven_length = std::min(std::abs(piece.length), std::max(0.0, s));
    pose = driven(pose, {std::copysign(driven_length, piece.length), piece.turn}, radius);
    s -= driven_length;
  }
  return pose;
}

Curve dubins(const CurvePose& from, const CurvePose& to, double radius) {
  const CurvePose goal = relative(from, to, radius);
  Shortest shortest(goal);
  // The line between the centres of the first and the last turn: an outer tangent for turns of one direction, an inner
  // tangent for opposite turns, or a third turn between two turns of one direction.
  for (const int turn : {1, -1}) {
    // A first turn to the right equals a first turn to the left with the goal mirrored.
    const CurvePose g{goal.x, turn * goal.y, turn * goal.theta};
    const auto [same, angle] = polar(g.x - std::sin(g.theta), g.y - 1.0 + std::cos(g.theta));
    shortest.offer_forwards({{whole_turn(angle), turn}, {same, 0}, {whole_turn(g.theta - angle), turn}});
    const auto [other, across] = polar(g.x + std::sin(g.theta), g.y - 1.0 - std::cos(g.theta));
    if (other >= 2.0 - slack) {
      const double straight = std::sqrt(std::max(0.0, other * other - 4.0));
      const double first = whole_turn(across + std::atan2(2.0, straight));
      shortest.offer_forwards({{first, turn}, {straight, 0}, {whole_turn(first - g.theta), -turn}});
    }
    if (same <= 4.0 + slack) {
      // The middle turn is longer than a half turn.
      const double half = std::acos(std::min(1.0, same / 4.0));
      const double first = whole_turn(angle + 0.5 * pi + half);
      const double middle = pi + 2.0 * half;
      shortest.offer_forwards({{first, turn}, {middle, -turn}, {whole_turn(g.theta - first + middle), turn}});
    }
  }
  return scaled(shortest.take(), radius);
}

Curve reeds_shepp(const CurvePose& from, const CurvePose& to, double radius) {
  const CurvePose goal = relative(from, to, radius);
  Shortest shortest(goal);
  for (const bool backwards : {false, true}) {
    for (const bool mirrored : {false, true}) {
      for (const bool reversed : {false, true}) Words(goal, shortest, backwards, mirrored, reversed).offer_all();
    }
  }
  return scaled(shortest.take(), radius);
}

}  // namespace trellis
