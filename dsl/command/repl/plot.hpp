// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include <dsl/command/figures.hpp>
#include <dsl/command/repl/run.hpp>

namespace trellis::command {

struct Screen {
  std::size_t columns = 80;
  std::size_t rows = 24;
  bool colour = false;
};

/// Draws a level of a run in characters: the world, the tree or roadmap, the rejected proposals, and the path.
/// \throws Error for a level without a position in the plane or in space, and for a view of a level in the plane.
std::string plot_text(const Run& run, std::size_t level, const Screen& screen, const PlotView& view = {});

/// Draws the same as a picture and returns the bytes of its file. The file's extension selects the format: .svg, .png
/// or .pdf. \throws Error for another extension, without matplotlib of Python, and as plot_text() does.
std::string plot_picture(const Run& run, std::size_t level, const std::string& path, const PlotView& view = {});

}  // namespace trellis::command
