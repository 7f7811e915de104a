// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of a run as plain data, for pictures and the page (docs/formats.md).
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include <trellis/experiment/experiment.hpp>
#include <trellis/pictures/run_samples.hpp>
#include <trellis/pictures/scenery.hpp>

namespace trellis {

/// Packs one run: levels with their nodes and proposals, and the turns of the levels. Coordinates have 16 bits, as
/// shares of their axis's extent. Checks the validity of rejected proposals; these checks do not count.
/// \param robots  receives the robots of the levels
nlohmann::ordered_json packed_run(const RunResult& run, const Problem& problem, RobotTable& robots);

/// The samples of runs in memory.
class PackedRuns : public RunSamples {
 public:
  /// Both must outlive this object.
  PackedRuns(const Experiment& experiment, const ExperimentResult& result);

  std::string run(std::size_t run) override;
  std::string robots() override;

 private:
  const ExperimentResult& result_;
  std::map<std::string, const Problem*> problems_;
  RobotTable robots_;
};

/// Writes the samples of all runs: DIR/<problem>/<strategy>/seed-<seed>/run.json, and DIR/index.json with the robots
/// and the names of these files.
/// \throws Error where it cannot write a file
void write_packed_samples(const Experiment& experiment, const ExperimentResult& result, const std::string& directory);

}  // namespace trellis
