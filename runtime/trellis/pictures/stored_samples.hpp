// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/pictures/run_samples.hpp>
#include <trellis/results/facts.hpp>

namespace trellis {

/// The samples that write_packed_samples() stored.
class StoredSamples : public RunSamples {
 public:
  /// \param folder  with index.json
  /// \param facts   the results whose runs they are
  /// \throws Error where the index cannot be read
  StoredSamples(std::string folder, const ExperimentFacts& facts);

  /// \throws Error that names the file, where it cannot be read or is no packed run
  std::string run(std::size_t run) override;
  std::string robots() override { return robots_; }

 private:
  std::string folder_;
  std::string robots_;
  std::vector<std::string> files_;  ///< of each run, "" for none
};

}  // namespace trellis
