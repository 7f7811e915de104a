// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <dsl/command/command_line.hpp>
#include <trellis/figures/charts/pictures.hpp>

namespace trellis::command {

/// The style of figures and tables, for papers.
struct FigureOptions {
  std::optional<double> column;  ///< width in millimetres; none: each figure's own
  bool untitled = false;
  bool serif = false;
  bool scale_bar = false;
  std::optional<std::size_t> panels;    ///< of costs: 0 for checks, 1 for CPU time, 2 or none for both
  std::optional<std::uint64_t> curves;  ///< in a panel of costs, beside the baseline's
  std::optional<double> azimuth;        ///< of the view of pictures of space, in degrees
  std::optional<double> elevation;
  std::optional<std::size_t> format;  ///< of tables: 0 or none for Markdown, 1 for LaTeX
};

void add_figure_options(Subcommand& verb, FigureOptions& options);

/// Adds --azimuth and --elevation, for a command that draws pictures of space.
void add_view_options(Subcommand& verb, FigureOptions& options);

/// Returns the style of figures. \throws Error for a width out of range, and for options of figures if the command
/// draws none.
FigureStyle figure_style(const FigureOptions& options, bool drawn);

/// Writes FOLDER/table.md, or FOLDER/table.tex for LaTeX.
void write_tables(const FigureOptions& options, const std::string& folder, const std::string& markdown);

/// \throws Error for a format if the command writes no table.
void check_format(const FigureOptions& options, bool written);

}  // namespace trellis::command
