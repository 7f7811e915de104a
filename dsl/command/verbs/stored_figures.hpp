// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <trellis/figures/charts/pictures.hpp>

namespace trellis::command {

/// Figures of stored results.
struct StoredFigureOptions {
  std::vector<std::string> files;     ///< documents of trellis run --json
  std::optional<std::size_t> figure;  ///< of stored_figure_names(); none: all that the results suffice for
  std::string baseline;               ///< a strategy, "" for the one that the documents name
  std::string folder;                 ///< receives the figures
};

/// The names of the figures.
const std::vector<std::string>& stored_figure_names();

/// Draws figures of stored results, and prints the files. They are those of the run, which drew them from its samples.
/// \throws Error where the results do not suffice for a figure that was asked for, or for any
void draw_stored_figures(const StoredFigureOptions& options, const FigureStyle& style);

/// Writes the page of a document, without replays.
/// \throws Error for several documents
void write_stored_page(const std::vector<std::string>& files, const std::string& file);

}  // namespace trellis::command
