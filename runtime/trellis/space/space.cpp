// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/space/space.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include <trellis/base/error.hpp>
#include <trellis/space/rotation.hpp>

namespace trellis {

namespace {

double shortest_difference(const Axis& axis, double delta) {
  const double period = axis.period();
  if (delta > 0.5 * period || delta <= -0.5 * period) {
    delta -= period * std::floor(delta / period);
    if (delta > 0.5 * period) delta -= period;
  }
  return delta;
}

double wrap(const Axis& axis, double x) {
  if (x >= axis.lo && x < axis.hi) return x;
  const double period = axis.period();
  double y = x - period * std::floor((x - axis.lo) / period);
  if (y >= axis.hi) y -= period;
  return y < axis.lo ? axis.lo : y;
}

double reflect_once(const Axis& axis, double x) {
  const double extent = axis.hi - axis.lo;
  double y = std::fmod(x - axis.lo, 2.0 * extent);
  if (y < 0.0) y += 2.0 * extent;
  return axis.lo + (y <= extent ? y : 2.0 * extent - y);
}

Quaternion quaternion_at(View q, const Factor& factor) {
  const double* row = q.data() + factor.column;
  return {row[0], row[1], row[2], row[3]};
}

void put(const Quaternion& rotation, const Factor& factor, MutableView out) {
  double* row = out.data() + factor.column;
  row[0] = rotation.x;
  row[1] = rotation.y;
  row[2] = rotation.z;
  row[3] = rotation.w;
}

std::vector<Factor> factors_of(std::vector<Axis> axes) {
  std::vector<Factor> factors;
  factors.reserve(axes.size());
  for (Axis& axis : axes) {
    const auto kind = axis.periodic ? Factor::Kind::circle : Factor::Kind::line;
    factors.push_back({kind, 0, std::move(axis)});
  }
  return factors;
}

}  // namespace

Space::Space(std::string name, std::vector<Axis> axes) : Space(std::move(name), factors_of(std::move(axes))) {}

Space::Space(std::string name, std::vector<Factor> factors) : name_(std::move(name)), factors_(std::move(factors)) {
  for (Factor& factor : factors_) {
    const Axis& axis = factor.axis;
    if (!std::isfinite(axis.lo) || !std::isfinite(axis.hi) || axis.hi <= axis.lo) {
      throw Error(fmt::format("space {}: axis '{}' needs finite bounds lo < hi, got [{}, {}]", name_, axis.name,
                              axis.lo, axis.hi));
    }
    if (!std::isfinite(axis.weight) || axis.weight <= 0.0) {
      throw Error(
          fmt::format("space {}: axis '{}' needs a weight greater than 0, got {}", name_, axis.name, axis.weight));
    }
    factor.column = dimension_;
    dimension_ += factor.width();
    degrees_ += factor.degrees();
  }
  if (!flat()) return;
  axes_.reserve(factors_.size());
  for (const Factor& factor : factors_) axes_.push_back(factor.axis);
}

void Space::not_flat(const char* what) const {
  throw Fault(fmt::format("{} of a space with rotations: {}", what, name_));
}

Space Space::euclidean(const std::vector<std::pair<double, double>>& bounds) {
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  std::vector<Axis> axes;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    axes.push_back(
        {i < names.size() ? names[i] : fmt::format("q{}", i + 1), bounds[i].first, bounds[i].second, 1.0, false});
  }
  return {fmt::format("R^{}", bounds.size()), std::move(axes)};
}

Space Space::so2(double weight, const std::string& name) {
  return {"SO(2)", {{name, -std::numbers::pi, std::numbers::pi, weight, true}}};
}

Space Space::se2(std::pair<double, double> x, std::pair<double, double> y, double weight) {
  return {"SE(2)",
          {{"x", x.first, x.second, 1.0, false},
           {"y", y.first, y.second, 1.0, false},
           {"theta", -std::numbers::pi, std::numbers::pi, weight, true}}};
}

Space Space::so3(double weight, const std::string& name) {
  return {"SO(3)", std::vector<Factor>{{Factor::Kind::rotation, 0, {name, 0.0, 1.0, weight, false}}}};
}

Space Space::se3(const std::array<std::pair<double, double>, 3>& bounds, double weight) {
  Space space = product({{1.0, euclidean({bounds[0], bounds[1], bounds[2]})}, {1.0, so3(weight)}});
  space.name_ = "SE(3)";
  return space;
}

Space Space::product(const std::vector<std::pair<double, Space>>& factors) {
  std::string name;
  std::vector<Factor> all;
  for (const auto& [weight, space] : factors) {
    name += (name.empty() ? "" : " x ") + space.name();
    for (Factor factor : space.factors()) {
      factor.axis.weight *= weight;
      const auto taken = [&](const std::string& n) {
        return std::any_of(all.begin(), all.end(), [&](const Factor& other) { return other.axis.name == n; });
      };
      const std::string stem = factor.axis.name;
      for (int k = 2; taken(factor.axis.name); ++k) factor.axis.name = fmt::format("{}{}", stem, k);
      all.push_back(std::move(factor));
    }
  }
  return {std::move(name), std::move(all)};
}

Space Space::part(const std::vector<std::size_t>& columns, std::string name) const {
  std::vector<const Factor*> of(dimension_);
  for (const Factor& factor : factors_) {
    for (std::size_t k = 0; k < factor.width(); ++k) of[factor.column + k] = &factor;
  }
  std::vector<Factor> kept;
  for (std::size_t j = 0; j < columns.size();) {
    const Factor& factor = *of.at(columns[j]);
    for (std::size_t k = 0; k < factor.width(); ++k, ++j) {
      if (j >= columns.size() || columns[j] != factor.column + k) {
        throw Fault(fmt::format("a part of the rotation {} of {}", factor.axis.name, name_));
      }
    }
    kept.push_back(factor);
  }
  return {std::move(name), std::move(kept)};
}

std::vector<Axis> Space::coordinates() const {
  std::vector<Axis> all;
  all.reserve(dimension_);
  for (const Factor& factor : factors_) {
    if (factor.kind != Factor::Kind::rotation) {
      all.push_back(factor.axis);
      continue;
    }
    for (const char* part : {"x", "y", "z", "w"}) {
      all.push_back({factor.axis.name + "." + part, -1.0, 1.0, factor.axis.weight, false});
    }
  }
  return all;
}

double Space::squared_distance(View a, View b) const {
  double sum = 0.0;
  if (!flat()) {
    for (const Factor& factor : factors_) {
      const std::size_t j = factor.column;
      double delta = 0.0;
      switch (factor.kind) {
        case Factor::Kind::line: delta = b[j] - a[j]; break;
        case Factor::Kind::circle: delta = shortest_difference(factor.axis, b[j] - a[j]); break;
        case Factor::Kind::rotation: delta = angle_between(quaternion_at(a, factor), quaternion_at(b, factor)); break;
      }
      delta *= factor.axis.weight;
      sum += delta * delta;
    }
    return sum;
  }
  const double* from = a.data();
  const double* to = b.data();
  for (const Axis& axis : axes_) {
    double delta = *to++ - *from++;
    if (axis.periodic) delta = shortest_difference(axis, delta);
    delta *= axis.weight;
    sum += delta * delta;
  }
  return sum;
}

double Space::distance(View a, View b) const { return std::sqrt(squared_distance(a, b)); }

void Space::difference(View a, View b, MutableView out) const {
  if (!flat()) not_flat("difference");
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    const double delta = b[j] - a[j];
    out[j] = axes_[j].periodic ? shortest_difference(axes_[j], delta) : delta;
  }
}

void Space::log(View a, View b, MutableView out) const {
  double* v = out.data();
  for (const Factor& factor : factors_) {
    const std::size_t j = factor.column;
    const double weight = factor.axis.weight;
    switch (factor.kind) {
      case Factor::Kind::line: *v++ = weight * (b[j] - a[j]); break;
      case Factor::Kind::circle: *v++ = weight * shortest_difference(factor.axis, b[j] - a[j]); break;
      case Factor::Kind::rotation: {
        const Vec3 turn = rotation_vector(quaternion_at(a, factor).inverse() * quaternion_at(b, factor));
        *v++ = weight * turn.x;
        *v++ = weight * turn.y;
        *v++ = weight * turn.z;
        break;
      }
    }
  }
}

void Space::exp(View a, View v, MutableView out) const {
  const double* along = v.data();
  for (const Factor& factor : factors_) {
    const std::size_t j = factor.column;
    const double weight = factor.axis.weight;
    switch (factor.kind) {
      case Factor::Kind::line: out[j] = a[j] + *along++ / weight; break;
      case Factor::Kind::circle: out[j] = wrap(factor.axis, a[j] + *along++ / weight); break;
      case Factor::Kind::rotation: {
        const Vec3 turn = {along[0] / weight, along[1] / weight, along[2] / weight};
        along += 3;
        put(normalised(quaternion_at(a, factor) * rotation_of(turn)), factor, out);
        break;
      }
    }
  }
}

double Space::log_jacobian(View v) const {
  if (flat()) return 0.0;
  double sum = 0.0;
  const double* along = v.data();
  for (const Factor& factor : factors_) {
    if (factor.kind == Factor::Kind::rotation) {
      sum += log_jacobian_of_rotation(norm({along[0], along[1], along[2]}) / factor.axis.weight);
    }
    along += factor.degrees();
  }
  return sum;
}

void Space::from_unit(View u, MutableView out) const {
  const double* from = u.data();
  for (const Factor& factor : factors_) {
    if (factor.kind == Factor::Kind::rotation) {
      put(rotation_from_unit({from[0], from[1], from[2]}), factor, out);
    } else {
      out[factor.column] = factor.axis.lo + (factor.axis.hi - factor.axis.lo) * *from;
    }
    from += factor.degrees();
  }
}

void Space::interpolate(View a, View b, double t, MutableView out) const {
  if (t == 1.0) {
    std::copy_n(b.begin(), dimension_, out.begin());
    return;
  }
  if (!flat()) {
    for (const Factor& factor : factors_) {
      const std::size_t j = factor.column;
      switch (factor.kind) {
        case Factor::Kind::line: out[j] = a[j] + t * (b[j] - a[j]); break;
        case Factor::Kind::circle:
          out[j] = wrap(factor.axis, a[j] + t * shortest_difference(factor.axis, b[j] - a[j]));
          break;
        case Factor::Kind::rotation:
          put(interpolated(quaternion_at(a, factor), quaternion_at(b, factor), t), factor, out);
          break;
      }
    }
    return;
  }
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    if (axes_[j].periodic) {
      out[j] = wrap(axes_[j], a[j] + t * shortest_difference(axes_[j], b[j] - a[j]));
    } else {
      out[j] = a[j] + t * (b[j] - a[j]);
    }
  }
}

void Space::normalise(MutableView q) const {
  for (const Factor& factor : factors_) {
    if (factor.kind == Factor::Kind::circle) q[factor.column] = wrap(factor.axis, q[factor.column]);
    if (factor.kind == Factor::Kind::rotation) put(normalised(quaternion_at(q, factor)), factor, q);
  }
}

void Space::reflect(MutableView q) const {
  normalise(q);
  for (const Factor& factor : factors_) {
    if (factor.kind != Factor::Kind::line) continue;
    double& x = q[factor.column];
    if (x < factor.axis.lo || x > factor.axis.hi) x = reflect_once(factor.axis, x);
  }
}

bool Space::contains(View q) const {
  return q.size() == dimension_ && std::ranges::all_of(factors_, [&](const Factor& factor) {
           const double x = q[factor.column];
           switch (factor.kind) {
             case Factor::Kind::line: return x >= factor.axis.lo && x <= factor.axis.hi;
             case Factor::Kind::circle: return std::isfinite(x);
             case Factor::Kind::rotation: break;
           }
           constexpr double rounding = 1e-9;
           const Quaternion r = quaternion_at(q, factor);
           // A coordinate that is not finite fails the comparison.
           return std::abs(std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w) - 1.0) <= rounding;
         });
}

void Space::sample_uniform(Stream& stream, MutableView out) const {
  for (const Factor& factor : factors_) {
    if (factor.kind == Factor::Kind::rotation) {
      const double first = stream.uniform();
      const double second = stream.uniform();
      put(rotation_from_unit({first, second, stream.uniform()}), factor, out);
    } else {
      out[factor.column] = stream.uniform(factor.axis.lo, factor.axis.hi);
    }
  }
}

double Space::log_volume() const {
  double sum = 0.0;
  for (const Factor& factor : factors_) {
    const Axis& axis = factor.axis;
    sum += factor.kind == Factor::Kind::rotation ? log_volume_of_rotations() + 3.0 * std::log(axis.weight)
                                                 : std::log(axis.weight * (axis.hi - axis.lo));
  }
  return sum;
}

double Space::diameter() const {
  double sum = 0.0;
  for (const Factor& factor : factors_) {
    const Axis& axis = factor.axis;
    double extent = axis.hi - axis.lo;
    if (factor.kind == Factor::Kind::circle) extent = 0.5 * axis.period();
    if (factor.kind == Factor::Kind::rotation) extent = std::numbers::pi;
    sum += axis.weight * extent * (axis.weight * extent);
  }
  return std::sqrt(sum);
}

double Space::injectivity_radius() const {
  double radius = std::numeric_limits<double>::infinity();
  for (const Factor& factor : factors_) {
    if (factor.kind == Factor::Kind::circle) radius = std::min(radius, 0.5 * factor.axis.weight * factor.axis.period());
    if (factor.kind == Factor::Kind::rotation) radius = std::min(radius, factor.axis.weight * std::numbers::pi);
  }
  return radius;
}

namespace {

/// The squared distance from q to the point at t of the motion from a to b, as a function of t alone.
class DistanceAlong {
 public:
  DistanceAlong(const Space& space, View a, View b, View q) {
    parts_.reserve(space.factors().size());
    for (const Factor& factor : space.factors()) {
      const std::size_t j = factor.column;
      Part part = {&factor};
      if (factor.kind == Factor::Kind::rotation) {
        const Quaternion from = quaternion_at(a, factor);
        const Quaternion seen = quaternion_at(q, factor).inverse() * from;
        const Vec3 turn = rotation_vector(from.inverse() * quaternion_at(b, factor));
        const double angle = norm(turn);
        const Vec3 axis = angle > 0.0 ? (1.0 / angle) * turn : Vec3{1.0, 0.0, 0.0};
        const Vec3 vector = {seen.x, seen.y, seen.z};
        // The real part of seen * rotation_of(t turn) is a cosine of t: C cos(at + t step).
        const double about = dot(vector, axis);
        const Vec3 off = cross(vector, axis);
        part.at = std::atan2(about, seen.w);
        part.step = 0.5 * angle;
        part.off = dot(off, off);
        part.square = seen.w * seen.w + about * about;
      } else {
        const bool circle = factor.kind == Factor::Kind::circle;
        part.at = a[j] - q[j];
        part.step = circle ? shortest_difference(factor.axis, b[j] - a[j]) : b[j] - a[j];
      }
      if (factor.kind != Factor::Kind::line) turn_ = std::max(turn_, std::abs(turn_of(part)));
      parts_.push_back(part);
    }
  }

  /// Returns the largest angle by which a circle or a rotation turns, the whole period of a circle being 2 pi.
  [[nodiscard]] double turn() const { return turn_; }

  double operator()(double t) const {
    double sum = 0.0;
    for (const Part& part : parts_) {
      double delta = part.at + t * part.step;
      switch (part.factor->kind) {
        case Factor::Kind::line: break;
        case Factor::Kind::circle: delta = shortest_difference(part.factor->axis, delta); break;
        case Factor::Kind::rotation: {
          const double cosine = std::cos(delta);
          const double sine = std::sin(delta);
          delta = 2.0 * std::atan2(std::sqrt(part.off + part.square * sine * sine),
                                   std::sqrt(part.square) * std::abs(cosine));
          break;
        }
      }
      delta *= part.factor->axis.weight;
      sum += delta * delta;
    }
    return sum;
  }

 private:
  struct Part {
    const Factor* factor = nullptr;
    double at = 0.0;    ///< coordinate at t = 0 relative to q; of a rotation the phase of the cosine
    double step = 0.0;  ///< its change from t = 0 to 1
    double off = 0.0;   ///< of a rotation 1 - C^2, without cancellation, and C^2
    double square = 0.0;
  };
  static double turn_of(const Part& part) {
    if (part.factor->kind == Factor::Kind::rotation) return 2.0 * part.step;
    return 2.0 * std::numbers::pi * part.step / part.factor->axis.period();
  }

  double turn_ = 0.0;
  std::vector<Part> parts_;
};

/// The same for a space with rotations. The squared distance to q is smooth along a short motion: a search over equal
/// parts finds the part of the least one, and Brent's method the place within it.
Foot searched_on_motion(const Space& space, View a, View b, View q) {
  const DistanceAlong squared(space, a, b, q);
  constexpr int most = 16;  // of a half turn
  const int parts = std::clamp(static_cast<int>(std::ceil(most * squared.turn() / std::numbers::pi)), 2, most);
  Foot foot = {0.0, squared(0.0)};
  for (int k = 1; k <= parts; ++k) {
    const double t = static_cast<double>(k) / parts;
    const double here = squared(t);
    if (here < foot.squared_distance) foot = {t, here};
  }
  constexpr int bits = std::numeric_limits<double>::digits / 2;  // a minimum is flat: more have no effect
  const double part = 1.0 / parts;
  const auto [t, least] =
      boost::math::tools::brent_find_minima(squared, std::max(0.0, foot.t - part), std::min(1.0, foot.t + part), bits);
  return least < foot.squared_distance ? Foot{t, least} : foot;
}

}  // namespace

Foot nearest_on_motion(const Space& space, View a, View b, View q) {
  if (!space.flat()) return searched_on_motion(space, a, b, q);
  // Relative to the motion's midpoint, the shorter direction to q on a periodic axis is correct for both halves.
  double along = 0.0;
  double squared = 0.0;
  double to_middle = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const Axis& axis = space.axes()[j];
    double difference_of_ends = b[j] - a[j];
    if (axis.periodic) difference_of_ends = shortest_difference(axis, difference_of_ends);
    double to = q[j] - (a[j] + 0.5 * difference_of_ends);
    if (axis.periodic) to = shortest_difference(axis, to);
    along += axis.weight * to * axis.weight * difference_of_ends;
    squared += axis.weight * difference_of_ends * axis.weight * difference_of_ends;
    to_middle += axis.weight * to * axis.weight * to;
  }
  const double t = squared > 0.0 ? std::clamp(along / squared, -0.5, 0.5) : 0.0;
  return {0.5 + t, std::max(0.0, to_middle - 2.0 * t * along + t * t * squared)};
}

double log_unit_ball(std::size_t d) {
  const double half = 0.5 * static_cast<double>(d);
  // std::lgamma writes to a global variable, the sign, so threads must not share it.
  int sign = 0;
  return half * std::log(std::numbers::pi) - ::lgamma_r(half + 1.0, &sign);
}

double path_length(const Space& space, const Configurations& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += space.distance(path[i - 1], path[i]);
  return length;
}

Configurations evenly_spread(const Space& space, const Configurations& path, std::size_t count) {
  std::vector<double> at = {0.0};
  at.reserve(path.size());
  for (std::size_t i = 1; i < path.size(); ++i) at.push_back(at.back() + space.distance(path[i - 1], path[i]));
  Configurations points(space.dimension());
  points.reserve(count);
  Configuration q(space.dimension());
  std::size_t leg = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = at.back() * static_cast<double>(i) / static_cast<double>(count - 1);
    while (leg + 2 < at.size() && at[leg + 1] < s) ++leg;
    if (path.size() == 1) {
      points.push(path[0]);
      continue;
    }
    const double length = at[leg + 1] - at[leg];
    space.interpolate(path[leg], path[leg + 1], length > 0.0 ? std::clamp((s - at[leg]) / length, 0.0, 1.0) : 0.0, q);
    points.push(q);
  }
  return points;
}

}  // namespace trellis
