// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/absorb.hpp>

#include <cstddef>
#include <cstdint>

namespace trellis {

void absorb(const Search& part, Search& whole) {
  const auto offset = static_cast<std::uint32_t>(whole.nodes.size());
  const auto moved = [offset](std::uint32_t row) { return row == no_node ? no_node : row + offset; };
  if (!part.validated.empty() || !whole.validated.empty()) {
    whole.validated.resize(whole.nodes.size(), 1);
    whole.validated.insert(whole.validated.end(), part.validated.begin(), part.validated.end());
  }
  for (std::size_t i = 0; i < part.nodes.size(); ++i) whole.nodes.push(part.nodes[i]);
  if (!whole.validated.empty()) whole.validated.resize(whole.nodes.size(), 1);
  for (const auto parent : part.parents) whole.parents.push_back(moved(parent));
  for (std::size_t i = 0; i < part.proposals.size(); ++i) {
    whole.proposals.push(part.proposals[i]);
    whole.fates.push_back(part.fates[i]);
    whole.near.push_back(moved(part.near[i]));
    whole.added.push_back(moved(part.added[i]));
    whole.proposal_sources.push_back(part.proposal_sources[i]);
  }
  for (const auto& [a, b] : part.edges) whole.edges.push_back({moved(a), moved(b)});
  whole.density.append(part.density);
  whole.expands = whole.expands && part.expands;
}

}  // namespace trellis
