// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

namespace trellis {

/// Merges clusters bottom-up: the pair with the least error first, ties by their order, until no pair may merge.
/// Appends merged clusters. \param error_of  maps two indices a < b to an optional error; none: they do not merge
/// \param merged  maps two clusters to the cluster of both
/// \return of each cluster whether it was merged into a later one
template <class Cluster, class ErrorOf, class Merged>
std::vector<char> merge_bottom_up(std::vector<Cluster>& clusters, const ErrorOf& error_of, const Merged& merged) {
  struct Merge {
    double error = 0.0;
    std::size_t a = 0;  // a < b
    std::size_t b = 0;
  };
  std::vector<char> gone(clusters.size(), 0);
  std::vector<Merge> merges;
  const auto offer = [&](std::size_t a, std::size_t b) {
    if (const auto error = error_of(a, b)) merges.push_back({*error, a, b});
  };
  for (std::size_t b = 0; b < clusters.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) offer(a, b);
  }
  while (true) {
    std::erase_if(merges, [&](const Merge& m) { return gone[m.a] != 0 || gone[m.b] != 0; });
    const auto best = std::min_element(merges.begin(), merges.end(), [](const Merge& m, const Merge& n) {
      return std::tie(m.error, m.a, m.b) < std::tie(n.error, n.a, n.b);
    });
    if (best == merges.end()) return gone;
    const Merge merge = *best;
    gone[merge.a] = gone[merge.b] = 1;
    clusters.push_back(merged(clusters[merge.a], clusters[merge.b]));
    gone.push_back(0);
    for (std::size_t a = 0; a + 1 < clusters.size(); ++a) {
      if (gone[a] == 0) offer(a, clusters.size() - 1);
    }
  }
}

}  // namespace trellis
