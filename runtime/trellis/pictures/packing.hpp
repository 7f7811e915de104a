// SPDX-License-Identifier: GPL-3.0-or-later
// The rows of a search as documents and pages hold them: for pictures alone, with 16 bits a coordinate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace trellis {

/// Integers of variable length: seven bits to a byte, the lowest first.
class PackedNumbers {
 public:
  void add(std::uint64_t value);
  /// Adds 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
  void add_signed(std::int64_t value) { add(zigzag(value)); }
  static std::uint64_t zigzag(std::int64_t value);
  [[nodiscard]] std::string text() const;

 private:
  std::string bytes_;
};

/// What a level of a run drew and kept. Rows that do not exist are `no_row`.
struct LevelRows {
  static constexpr std::uint32_t no_row = 0xFFFFFFFFU;

  std::size_t dimension = 0;  ///< coordinates of a configuration
  std::string nodes;          ///< 2 bytes a coordinate, the low one first: the share of its axis's extent times 65535
  std::vector<std::uint32_t> parents;  ///< of each node, itself for a root; empty without a tree
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::string classes;    ///< NodeClass of each node; empty where they were not computed
  std::string proposals;  ///< as `nodes`
  std::string fates;  ///< of each proposal its Fate and, from bit 2, its own validity: 0 unknown, 1 valid, 2 invalid
  std::vector<std::uint32_t> sources;  ///< of each proposal, an index into the level's list
  std::vector<std::uint32_t> near;     ///< of each proposal, the node that was extended
  std::vector<std::uint32_t> added;    ///< of each proposal, the node that it led to

  [[nodiscard]] std::size_t node_count() const { return dimension > 0 ? nodes.size() / (2 * dimension) : 0; }
  [[nodiscard]] std::size_t proposal_count() const { return fates.size(); }
};

/// Adds the rows to a level's object: nodes, parents, edges, classes, proposals, fates, source, near, added.
void add_rows(const LevelRows& rows, nlohmann::ordered_json& level);

/// Returns a run with a share of each level's proposals and nodes, evenly spaced over the search; trees stay connected,
/// because a node's parent becomes its nearest included ancestor.
/// \param run    as packed_run() returns it
/// \param share  in (0, 1]
/// \throws Error for another object
nlohmann::ordered_json thinned_run(const nlohmann::ordered_json& run, double share);

}  // namespace trellis
