// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/command/commands.hpp>
#include <trellis/report/pictures.hpp>

namespace trellis::command {

/// How figures are set. Throws Error for a width out of range, and for options of figures where nothing is drawn.
FigureStyle figure_style(const FigureOptions& options, bool drawn);

/// Writes FOLDER/table.md, or FOLDER/table.tex for LaTeX.
void write_tables(const FigureOptions& options, const std::string& folder, const std::string& markdown);

/// Throws Error for a format that does not exist, and for one where no table is written.
void check_format(const FigureOptions& options, bool written);

}  // namespace trellis::command
