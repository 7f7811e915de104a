// SPDX-License-Identifier: GPL-3.0-or-later
// What the page holds of the records, in the form that its script reads (html/report.js).
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Robots, each once: shrunken ones are shared by all runs of a strategy.
class RobotTable {
 public:
  /// Its place in the list; -1 without one.
  int add(const Scene* scene);
  [[nodiscard]] const nlohmann::ordered_json& list() const { return list_; }

 private:
  nlohmann::ordered_json list_ = nlohmann::ordered_json::array();
  std::map<std::string, int> places_;
};

/// "[x, y, radius]" of a disc, "[x, y, x, y, ...]" of a polygon.
nlohmann::ordered_json shape_json(const Shape& shape);

/// One run: levels with their nodes and proposals, and the turns that they took. Coordinates have 16 bits, shares of
/// their axis's extent. Whether rejected proposals are themselves valid is looked up here, on nobody's account.
/// \param share  in (0, 1]: of each level's proposals and nodes that are held, evenly spread over the search; trees
/// stay
///               whole, as the parent of a node is the nearest of its ancestors that is held
nlohmann::ordered_json packed_run(const RunResult& run, const Problem& problem, RobotTable& robots, double share = 1.0);

/// JSON to stand in a <script> element: it holds no '<', whatever the names in it.
std::string script_json(const nlohmann::ordered_json& json);

}  // namespace trellis
