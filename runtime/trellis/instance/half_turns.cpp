// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/half_turns.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace trellis {

namespace {

/// Whether a factor of the space turns by half a period between a and b.
/// \param tangent  memory for a tangent of the space
bool turns_half(const Space& space, View a, View b, std::vector<double>& tangent) {
  // Far above rounding: a reader that computes with fewer digits takes the same direction for all other turns.
  constexpr double rounding = 1e-6;
  space.log(a, b, tangent);
  const double* v = tangent.data();
  for (const Factor& factor : space.factors()) {
    const double weight = factor.axis.weight;
    double half = 0.0;
    double turn = 0.0;
    switch (factor.kind) {
      case Factor::Kind::line: break;
      case Factor::Kind::circle:
        half = 0.5 * factor.axis.period() * weight;
        turn = std::abs(v[0]);
        break;
      case Factor::Kind::rotation:
        half = std::numbers::pi * weight;
        turn = std::hypot(v[0], v[1], v[2]);
        break;
    }
    if (half > 0.0 && std::abs(turn - half) <= rounding * half) return true;
    v += factor.degrees();
  }
  return false;
}

}  // namespace

Configurations with_half_turns_divided(const Space& space, Validity& validity, const Configurations& path,
                                       double tolerance) {
  const auto certified = [&](View from, View to) {
    Certificate certificate{tolerance};
    validity.certify(from, to, certificate);
    return certificate.valid();
  };
  std::vector<double> tangent(space.degrees());
  const auto half = [&](std::size_t i) { return turns_half(space, path[i - 1], path[i], tangent); };
  Configurations divided(path.dimension());
  divided.reserve(path.size());
  Configuration middle(path.dimension());
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0 && half(i)) {
      const View a = path[i - 1];
      const View b = path[i];
      const bool back = !certified(a, b) && certified(b, a);
      space.interpolate(back ? b : a, back ? a : b, 0.5, middle);
      divided.push(middle);
    }
    divided.push(path[i]);
  }
  return divided;
}

}  // namespace trellis
