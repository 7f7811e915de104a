// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/command/commands.hpp>
#include <trellis/figures/pictures.hpp>

namespace trellis::command {

/// Returns the style of figures. \throws Error for a width out of range, and for options of figures if the command
/// draws none.
FigureStyle figure_style(const FigureOptions& options, bool drawn);

/// Writes FOLDER/table.md, or FOLDER/table.tex for LaTeX.
void write_tables(const FigureOptions& options, const std::string& folder, const std::string& markdown);

/// \throws Error for an unknown format, and for a format if the command writes no table.
void check_format(const FigureOptions& options, bool written);

}  // namespace trellis::command
