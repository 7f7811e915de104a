// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds and robots of an experiment as plain data, for documents and pictures (docs/formats.md).
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

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

/// The robots of an experiment's problems, in the order in which `scenery_of` lists them.
RobotTable robots_of(const Experiment& experiment);

/// Returns the worlds, robots and scenes of an experiment.
Scenery scenery_of(const Experiment& experiment);

}  // namespace trellis
