// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <functional>
#include <utility>

#include <trellis/planner/planner.hpp>

namespace trellis {

Configurations shortcut(Instance& instance, const Configurations& path, std::int64_t rounds, Stream& stream,
                        const std::function<bool(const Configurations&)>& certified) {
  const auto& space = instance.space;
  const std::size_t d = space.dimension();
  Configurations current = path;
  Configuration a(d);
  Configuration b(d);
  std::vector<double> at;
  for (std::int64_t round = 0; round < rounds && current.size() > 2; ++round) {
    // Arc length up to each point.
    at.assign(1, 0.0);
    for (std::size_t i = 1; i < current.size(); ++i) {
      at.push_back(at.back() + space.distance(std::as_const(current)[i - 1], std::as_const(current)[i]));
    }
    double s = stream.uniform(0.0, at.back());
    double t = stream.uniform(0.0, at.back());
    if (t < s) std::swap(s, t);
    const auto leg = [&](double length) {
      const auto it = std::upper_bound(at.begin() + 1, at.end() - 1, length);
      return static_cast<std::size_t>(it - at.begin()) - 1;
    };
    const std::size_t i = leg(s);
    const std::size_t j = leg(t);
    if (i == j) continue;
    const auto point = [&](std::size_t k, double length, Configuration& out) {
      const double span = at[k + 1] - at[k];
      space.interpolate(std::as_const(current)[k], std::as_const(current)[k + 1],
                        span > 0.0 ? std::min(1.0, (length - at[k]) / span) : 0.0, out);
    };
    point(i, s, a);
    point(j, t, b);
    if (space.distance(a, b) >= t - s) continue;
    // A point between two checked configurations may be unchecked itself.
    if (!instance.valid(a) || !instance.motion(a, b).valid) continue;
    if (!instance.motion(std::as_const(current)[i], a).valid ||
        !instance.motion(b, std::as_const(current)[j + 1]).valid) {
      continue;
    }
    if (certified) {
      Configurations changed(d);
      for (const View q : {std::as_const(current)[i], View(a), View(b), std::as_const(current)[j + 1]}) {
        changed.push(q);
      }
      if (!certified(changed)) continue;
    }
    Configurations next(d);
    for (std::size_t k = 0; k <= i; ++k) next.push(std::as_const(current)[k]);
    next.push(a);
    next.push(b);
    for (std::size_t k = j + 1; k < current.size(); ++k) next.push(std::as_const(current)[k]);
    current = std::move(next);
  }
  return current;
}

}  // namespace trellis
