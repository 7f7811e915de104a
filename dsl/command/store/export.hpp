// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/command/store/records.hpp>

namespace trellis::command {

/// Checks that a database can be written. \throws Error for an existing file that write_database() did not write
void require_replaceable_database(const std::string& path);

/// Writes a complete sweep into one SQLite file: the tables experiment, problem, strategy, run and level, and the
/// tables that Planner Arena reads. The file has its old content or its new one.
void write_database(const std::string& path, const Manifest& manifest, const StoredRuns& records);

/// Writes for each problem a CSV file that Planner Developer Tools (PDT) reads.
void write_pdt(const std::string& folder, const Manifest& manifest, const StoredRuns& records);

}  // namespace trellis::command
