// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <dsl/language/words/scenario.hpp>

namespace trellis::dsl {

/// A loaded script of scenarios.
class ScenarioFile {
 public:
  struct Options {
    SessionOptions session = {};
    std::optional<std::uint64_t> seeds = {};
    trial::Making making = {};
  };
  /// \throws Error if the script cannot be loaded, or has no scenario.
  ScenarioFile(const std::string& path, const Options& options);
  ~ScenarioFile();
  ScenarioFile(const ScenarioFile&) = delete;
  ScenarioFile& operator=(const ScenarioFile&) = delete;

  [[nodiscard]] std::vector<std::string> names() const;
  /// Calls a scenario's function, and returns the recorded scenario. Releases the runs of the previous scenario's
  /// trials. \throws Error if the function fails.
  const Scenario& play(std::size_t index);

 private:
  std::shared_ptr<ScenarioBook> book_;
  Session session_;
};

}  // namespace trellis::dsl
