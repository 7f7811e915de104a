// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/along.hpp>

#include <algorithm>
#include <cmath>

#include <trellis/measure/estimator.hpp>

namespace trellis::measure {

Along along_path(const Target& target, std::span<const double> arcs, std::size_t points, double mass) {
  Along along;
  if (!target.has_path()) return along;
  along.length = target.length();
  const double bins = std::min(std::max(1.0, std::floor(along.length / target.delta())),
                               std::floor(static_cast<double>(arcs.size()) / 5.0));
  if (bins < 1.0) {
    if (arcs.empty()) along.empty_share = 1.0;
    return along;
  }
  const auto count = static_cast<std::size_t>(bins);
  along.target.assign(count, 0.0);
  along.samples.assign(count, 0.0);
  const auto bin = [&](double arc) {
    return std::min(count - 1, static_cast<std::size_t>(std::max(0.0, arc / along.length * bins)));
  };
  for (std::size_t i = 0; i < points; ++i) along.target[bin(target.arc(i))] += 1.0;
  for (const double arc : arcs) along.samples[bin(arc)] += 1.0;
  const auto n = static_cast<double>(arcs.size());
  along.divergence = 0.0;
  along.empty_share = 0.0;
  double regularised = 0.0;
  const double mixed = uniform_mix * std::exp(-target.uniform());  // uniform samples in A, distributed as the target
  const double own = (1.0 - uniform_mix) * mass;
  for (std::size_t j = 0; j < count; ++j) {
    const double t = along.target[j] / static_cast<double>(points);
    const double c = along.samples[j];
    const double q = (c + 0.5) / (n + 0.5 * bins);
    if (t > 0.0) along.divergence += t * std::log(t / q);
    if (t > 0.0) regularised += t * std::log(t * (own + mixed) / (own * q + mixed * t));
    if (c == 0.0) along.empty_share += t;
    along.target[j] = t;
    along.samples[j] = c / n;
  }
  const double bias = (bins - 1.0) / (2.0 * n);
  along.corrected = along.divergence - bias;
  if (target.is_uniform()) {
    const double kept = own / (own + mixed);  // the error of q enters squared
    along.regularised = regularised - bias * kept * kept;
  }
  return along;
}

}  // namespace trellis::measure
