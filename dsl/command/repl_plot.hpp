// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include <dsl/command/repl_run.hpp>

namespace trellis::command {

struct Screen {
  std::size_t columns = 80;
  std::size_t rows = 24;
  bool colour = false;
};

/// A level of a run in characters: the world, the tree or roadmap, the proposals that led to nothing, and the path.
/// Throws Error for a level that has no place in the plane.
std::string plot_text(const Run& run, std::size_t level, const Screen& screen);

/// The same as a picture; the ending of the file's name says which: .svg, .png or .pdf.
void plot_file(const Run& run, std::size_t level, const std::string& path);

}  // namespace trellis::command
