// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis {

struct ExperimentResult;

/// Writes DIR/<problem>/<strategy>/seed-<seed>/samples.csv and path.csv for every run. Writes each file atomically (a
/// temporary file, then a rename).
/// \throws Error where it cannot write a file.
void write_samples(const ExperimentResult& result, const std::string& directory);

}  // namespace trellis
