// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/samples.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <trellis/base/polling.hpp>

namespace trellis {

PreparedSamples::PreparedSamples(const Space& space, const Configurations& samples)
    : space_(space), frame_(space), total_(samples.size()), tree_(space), atom_tree_(space) {
  const std::size_t d = space.dimension();
  if (!samples.empty() && samples.dimension() != d) {
    throw Error(fmt::format("measure: the samples have {} coordinates, the target's space {} has {}",
                            samples.dimension(), space.name(), d));
  }
  std::vector<double> rows(total_ * d);
  std::vector<std::uint32_t> order;
  order.reserve(total_);
  for (std::size_t i = 0; i < total_; ++i) {
    poll(i);
    const View x = samples[i];
    if (!std::all_of(x.begin(), x.end(), [](double c) { return std::isfinite(c); })) {
      throw Error(fmt::format("measure: sample {} has a coordinate that is not finite", i + 1));
    }
    if (!space.contains(x)) continue;
    frame_.to_metric(x, MutableView(rows).subspan(i * d, d));
    order.push_back(static_cast<std::uint32_t>(i));
  }
  // Sorting by coordinates makes copies adjacent; the order of equal rows has no effect below.
  const auto row = [&](std::uint32_t i) { return rows.begin() + static_cast<std::ptrdiff_t>(i * d); };
  const auto length = static_cast<std::ptrdiff_t>(d);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::lexicographical_compare(row(a), row(a) + length, row(b), row(b) + length);
  });
  all_.reserve(rows.size());
  distinct_ = Configurations(d);
  distinct_.reserve(order.size());
  Configurations repeated(d);
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && std::equal(row(order[i]), row(order[i]) + length, row(order[end]))) ++end;
    const auto first = row(order[i]);
    if (end - i > 1) {
      atoms_.insert(atoms_.end(), first, first + length);
      copies_.push_back(end - i);
      repeated.push(samples[order[i]]);
    } else {
      all_.insert(all_.end(), first, first + length);
      distinct_.push(samples[order[i]]);
    }
    i = end;
  }
  for (std::size_t i = 0; i < repeated.size(); ++i) distinct_.push(std::as_const(repeated)[i]);
  tree_ = NearestIndex(frame_.rows(), all_);
  atom_tree_ = NearestIndex(frame_.rows(), atoms_);
}

namespace measure {

InTarget in_target(const Target& target, const PreparedSamples& samples) {
  const std::size_t d = samples.frame().dimension();
  const std::size_t once = samples.tree().size();
  InTarget result;
  for (std::size_t i = 0; i < samples.distinct().size(); ++i) {
    poll(i);
    const View x = samples.distinct()[i];
    if (!target.contains(x)) continue;
    const std::size_t copies = i < once ? 1 : samples.copies()[i - once];
    result.count += copies;
    if (target.has_path()) result.arcs.insert(result.arcs.end(), copies, target.along(x));
    if (i >= once) continue;
    const View y = View(samples.all()).subspan(i * d, d);
    result.inside.insert(result.inside.end(), y.begin(), y.end());
  }
  return result;
}

}  // namespace measure

}  // namespace trellis
