// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/samples.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace trellis::measure {

SampleSet prepare(const Target& target, const Frame& frame, const Configurations& samples) {
  const Space& space = target.space();
  const std::size_t d = space.dimension();
  if (!samples.empty() && samples.dimension() != d) {
    throw Error(fmt::format("measure: the samples have {} coordinates, the target's space {} has {}",
                            samples.dimension(), space.name(), d));
  }
  SampleSet set;
  set.total = samples.size();
  std::vector<double> rows(set.total * d);
  std::vector<std::uint32_t> order;
  order.reserve(set.total);
  for (std::size_t i = 0; i < set.total; ++i) {
    const View x = samples[i];
    if (!std::all_of(x.begin(), x.end(), [](double c) { return std::isfinite(c); })) {
      throw Error(fmt::format("measure: sample {} has a coordinate that is not finite", i + 1));
    }
    if (!space.contains(x)) continue;
    frame.to_metric(x, MutableView(rows).subspan(i * d, d));
    order.push_back(static_cast<std::uint32_t>(i));
  }
  // Copies meet in the order of the coordinates; the order of equal rows does not matter to anything below.
  const auto row = [&](std::uint32_t i) { return rows.begin() + static_cast<std::ptrdiff_t>(i * d); };
  const auto length = static_cast<std::ptrdiff_t>(d);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::lexicographical_compare(row(a), row(a) + length, row(b), row(b) + length);
  });
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && std::equal(row(order[i]), row(order[i]) + length, row(order[end]))) ++end;
    const auto first = row(order[i]);
    const bool inside = target.contains(samples[order[i]]);
    if (inside) {
      set.in_target += end - i;
      if (target.has_path()) set.arcs.insert(set.arcs.end(), end - i, target.along(samples[order[i]]));
    }
    if (end - i > 1) {
      set.atoms.insert(set.atoms.end(), first, first + length);
      set.copies.push_back(end - i);
    } else {
      set.all.insert(set.all.end(), first, first + length);
      if (inside) set.inside.insert(set.inside.end(), first, first + length);
    }
    i = end;
  }
  return set;
}

}  // namespace trellis::measure
