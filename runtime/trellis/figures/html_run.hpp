// SPDX-License-Identifier: GPL-3.0-or-later
// The page's records, in the format that its script reads (html/report.js).
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/figures/traces.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// A list of distinct robots: all runs of a strategy share the shrunken ones.
class RobotTable {
 public:
  /// Returns the index of the scene's robot in the list; -1 without a scene.
  int add(const Scene* scene);
  [[nodiscard]] const nlohmann::ordered_json& list() const { return list_; }

 private:
  nlohmann::ordered_json list_ = nlohmann::ordered_json::array();
  std::map<std::string, int> places_;
};

/// A list of distinct worlds of space: problems of one world share it.
class WorldTable {
 public:
  /// Returns the index of the world in the list.
  int add(const World3& world);
  [[nodiscard]] const nlohmann::ordered_json& list() const { return list_; }

 private:
  nlohmann::ordered_json list_ = nlohmann::ordered_json::array();
  std::map<const void*, int> places_;  ///< only looked up, so its order does not matter
};

/// Returns "[x, y, radius]" of a disc, "[x, y, x, y, ...]" of a polygon.
nlohmann::ordered_json shape_json(const Shape& shape);

/// Where a level of a team, or its problem, has the position of each robot.
nlohmann::ordered_json traces_json(const std::vector<Trace>& traces);

/// Packs one run: levels with their nodes and proposals, and the turns of the levels. Coordinates have 16 bits, as
/// shares of their axis's extent. Checks the validity of rejected proposals; these checks do not count.
/// \param share  in (0, 1]: the share of each level's proposals and nodes to include, evenly spaced over the search;
///     trees stay connected, because a node's parent becomes its nearest included ancestor
nlohmann::ordered_json packed_run(const RunResult& run, const Problem& problem, RobotTable& robots, double share = 1.0);

/// Returns JSON for a <script> element: it contains no '<', whatever its strings are.
std::string script_json(const nlohmann::ordered_json& json);

}  // namespace trellis
