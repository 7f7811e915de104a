// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/nearest_valid.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <utility>
#include <vector>

namespace trellis {

namespace {

/// A low-discrepancy sequence in the unit cube: the additive recurrence by the powers of the root of x^(d+1) = x + 1.
class Recurrence {
 public:
  explicit Recurrence(std::size_t dimension) : steps_(dimension), at_(dimension, 0.5) {
    double root = 2.0;
    constexpr int rounds = 60;
    for (int i = 0; i < rounds; ++i) root = std::pow(1.0 + root, 1.0 / static_cast<double>(dimension + 1));
    for (std::size_t j = 0; j < dimension; ++j) steps_[j] = std::pow(1.0 / root, static_cast<double>(j + 1));
  }
  const std::vector<double>& next() {
    for (std::size_t j = 0; j < at_.size(); ++j) at_[j] = std::fmod(at_[j] + steps_[j], 1.0);
    return at_;
  }

 private:
  std::vector<double> steps_;
  std::vector<double> at_;
};

class Search {
 public:
  Search(const Space& space, View q, const std::function<bool(View)>& valid)
      : space_(space), q_(q.begin(), q.end()), valid_(valid), d_(space.degrees()), points_(d_ + d_ % 2 + 1) {
    // In a world 10 m wide, a centimetre; if that fails, a millimetre.
    constexpr double digits = 3.0;
    decimals_ = std::max(0, static_cast<int>(digits - std::floor(std::log10(space.diameter()))));
  }

  std::optional<TypedConfiguration> operator()() {
    constexpr double first = 1e-3, growth = 1.25;  // of the rings' radii, as a share of the diameter
    constexpr std::size_t each = 64;               // configurations in a ring, times the dimension
    consider(within_bounds());
    double inner = 0.0;
    for (double radius = first * space_.diameter(); inner < space_.diameter(); radius *= growth) {
      if (best_ && best_->distance <= inner) break;
      // A change of a single coordinate is the shortest to type.
      for (std::size_t j = 0; j < d_; ++j) {
        for (const double sign : {-1.0, 1.0}) {
          std::vector<double> step(d_, 0.0);
          step[j] = sign * radius;
          consider(moved(step));
        }
      }
      for (std::size_t i = 0; i < each * d_; ++i) consider(in_ring(inner, radius));
      inner = radius;
    }
    pull();
    for (const Factor& factor : space_.factors()) {
      if (!best_) break;
      Configuration kept = best_->q;
      for (std::size_t j = factor.column; j < factor.column + factor.width(); ++j) kept[j] = q_[j];
      consider(kept);
    }
    pull();
    return best_;
  }

 private:
  [[nodiscard]] Configuration within_bounds() const {
    Configuration q = q_;
    for (const Factor& factor : space_.factors()) {
      if (factor.kind != Factor::Kind::line) continue;
      q[factor.column] = std::clamp(q[factor.column], factor.axis.lo, factor.axis.hi);
    }
    return q;
  }

  /// Returns q moved along a tangent vector.
  [[nodiscard]] Configuration moved(const std::vector<double>& v) const {
    Configuration q = q_;
    if (!space_.flat()) {
      space_.exp(q_, v, q);
      return q;
    }
    for (std::size_t j = 0; j < d_; ++j) q[j] += v[j] / space_.axes()[j].weight;
    return q;
  }

  Configuration in_ring(double inner, double outer) {
    const auto& u = points_.next();
    std::vector<double> direction(d_ + d_ % 2);
    double square = 0.0;
    for (std::size_t j = 0; j < direction.size(); j += 2) {
      // Box-Muller: a pair of normal numbers from a pair of uniform ones; the last pair may give one too many.
      const double length = std::sqrt(-2.0 * std::log(1.0 - u[j]));
      direction[j] = length * std::cos(2.0 * std::numbers::pi * u[j + 1]);
      direction[j + 1] = length * std::sin(2.0 * std::numbers::pi * u[j + 1]);
    }
    direction.resize(d_);
    for (const double x : direction) square += x * x;
    const double length = inner + (outer - inner) * u.back();
    for (double& x : direction) x = length * x / std::sqrt(square);
    return moved(direction);
  }

  /// Bisects between q and the best configuration.
  void pull() {
    if (!best_) return;
    constexpr int rounds = 12;
    Configuration far = best_->q;
    Configuration between(q_.size());
    double invalid = 0.0, fine = 1.0;
    for (int i = 0; i < rounds; ++i) {
      const double t = 0.5 * (invalid + fine);
      space_.interpolate(q_, far, t, between);
      (consider(between) ? fine : invalid) = t;
    }
  }

  /// Checks the rounded configuration; stores it if it is valid and the nearest so far. \return whether it is valid
  bool consider(const Configuration& q) {
    for (const int decimals : {decimals_, decimals_ + 1}) {
      TypedConfiguration typed;
      for (std::size_t j = 0; j < q.size(); ++j) {
        std::string text = fmt::format("{:.{}f}", q[j], decimals);
        if (text.find('.') != std::string::npos) {
          text.erase(text.find_last_not_of('0') + 1);
          if (text.ends_with('.')) text.pop_back();
        }
        if (text == "-0") text = "0";
        typed.q.push_back(std::strtod(text.c_str(), nullptr));
        typed.text += (j == 0 ? "(" : ", ") + text;
      }
      typed.text += ")";
      // A quaternion of few decimals is brought to norm 1 where it is read.
      if (!space_.flat()) space_.normalise(typed.q);
      typed.distance = space_.distance(q_, typed.q);
      if (best_ && best_->distance <= typed.distance) return false;
      if (!space_.contains(typed.q) || !valid_(typed.q)) continue;
      best_ = std::move(typed);
      return true;
    }
    return false;
  }

  const Space& space_;
  Configuration q_;
  const std::function<bool(View)>& valid_;
  std::size_t d_;
  Recurrence points_;
  int decimals_ = 0;
  std::optional<TypedConfiguration> best_;
};

}  // namespace

std::optional<TypedConfiguration> nearest_valid(const Space& space, View q, const std::function<bool(View)>& valid) {
  return Search(space, q, valid)();
}

}  // namespace trellis
