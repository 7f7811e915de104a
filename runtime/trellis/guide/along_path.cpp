// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/along_path.hpp>

#include <algorithm>
#include <cmath>

#include <trellis/guide/path_guide.hpp>

namespace trellis {

AlongPath::AlongPath(const Instance& instance, const Configurations& path)
    : space_(instance.space),
      radius_(tube_radius({}, instance)),
      index_(instance.space),
      middle_(instance.space.dimension()) {
  if (path.size() < 2) return;
  constexpr double most_points = 1024.0;
  const double length = path_length(space_, path);
  const double apart = std::max(radius_, length / most_points);
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double pieces = std::max(1.0, std::ceil(space_.distance(path[i], path[i + 1]) / apart));
    for (double k = 0.0; k < pieces; k += 1.0) {
      space_.interpolate(path[i], path[i + 1], k / pieces, middle_);
      index_.add(middle_);
    }
  }
  index_.add(path.back());
}

double AlongPath::factor(View a, View b) const {
  space_.interpolate(a, b, 0.5, middle_);
  return 1.0 + std::sqrt(index_.nearest(middle_).squared_distance) / radius_;
}

}  // namespace trellis
