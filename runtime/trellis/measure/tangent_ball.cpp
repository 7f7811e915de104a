// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/tangent_ball.hpp>

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

namespace trellis::measure {

void in_unit_ball(View unit, double level, MutableView out) {
  using boost::math::policies::policy;
  using boost::math::policies::promote_double;
  double square = 0.0;
  for (std::size_t j = 0; j < out.size(); ++j) {
    // Within double precision: directions need no more.
    out[j] = boost::math::erf_inv(std::clamp(2.0 * unit[j] - 1.0, -1.0 + 1e-15, 1.0 - 1e-15),
                                  policy<promote_double<false>>());
    square += out[j] * out[j];
  }
  const double radius = std::pow(level, 1.0 / static_cast<double>(out.size()));
  const double scale = square > 0.0 ? radius / std::sqrt(square) : 0.0;
  for (double& v : out) v *= scale;
}

bool before_cut(const Space& space, View tangent) {
  const double* v = tangent.data();
  for (const Factor& factor : space.factors()) {
    const Axis& axis = factor.axis;
    if (factor.kind == Factor::Kind::circle && std::abs(*v) > 0.5 * axis.weight * axis.period()) return false;
    if (factor.kind == Factor::Kind::rotation) {
      const double turn = axis.weight * std::numbers::pi;
      if (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] > turn * turn) return false;
    }
    v += factor.degrees();
  }
  return true;
}

}  // namespace trellis::measure
