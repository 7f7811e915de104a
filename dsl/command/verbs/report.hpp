// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include <trellis/report/report.hpp>

namespace trellis::command {

/// Prints a report.
/// \param width  in columns; none: the terminal's, else COLUMNS of the environment, else 100 for an overview and 160
/// for
///               other kinds
void print_report(const ExperimentSummary& summary, ReportKind kind, std::optional<std::uint64_t> width);

}  // namespace trellis::command
