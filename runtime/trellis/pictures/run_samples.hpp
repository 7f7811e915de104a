// SPDX-License-Identifier: GPL-3.0-or-later
// The packed samples of an experiment's runs, wherever they are.
#pragma once

#include <cstddef>
#include <string>

namespace trellis {

/// Gives the packed samples of runs (docs/formats.md, run.json), one at a time.
class RunSamples {
 public:
  RunSamples() = default;
  virtual ~RunSamples() = default;
  RunSamples(const RunSamples&) = delete;
  RunSamples& operator=(const RunSamples&) = delete;

  /// Returns the samples of a run as JSON; "" where there are none.
  /// \param run  its index among the runs of the results
  virtual std::string run(std::size_t run) = 0;
  /// Returns the robots that the levels of the runs name by their indices, as a JSON array. Call it after run().
  virtual std::string robots() = 0;
};

}  // namespace trellis
