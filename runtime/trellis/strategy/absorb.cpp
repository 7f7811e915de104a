// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/absorb.hpp>

#include <cstddef>
#include <cstdint>

namespace trellis {

namespace {

/// Appends the controls of proposals.
void absorb(const ControlRecord& part, ControlRecord& whole) {
  if (part.longest == 0) return;
  if (whole.longest == 0) {
    whole = part;
    return;
  }
  const auto pieces = static_cast<std::uint32_t>(whole.steps.size());
  for (std::size_t i = 0; i < part.controls.size(); ++i) whole.controls.push(part.controls[i]);
  whole.steps.insert(whole.steps.end(), part.steps.begin(), part.steps.end());
  whole.driven.insert(whole.driven.end(), part.driven.begin(), part.driven.end());
  for (const std::uint32_t end : part.ends) whole.ends.push_back(pieces + end);
}

}  // namespace

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
  absorb(part.controls, whole.controls);
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
