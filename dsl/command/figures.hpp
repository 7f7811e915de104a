// SPDX-License-Identifier: GPL-3.0-or-later
// Figures are drawn by the Python package trellis.figures (python/trellis/figures), from documents of results.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

namespace trellis::command {

/// The direction from which a problem in space is seen, in degrees; none: the default of its world.
struct PlotView {
  std::optional<double> azimuth;
  std::optional<double> elevation;
};

/// Draws figures of documents into a folder: `python3 -m trellis.figures DOCUMENT... --out FOLDER`.
/// \param figure  a name; "": all that the documents have data for
/// \param baseline  a strategy; "": that of the documents
/// \param by_name  whether strategies of one name may have other options in each document
/// \return the names of the files, a line each
/// \throws Error where Python or a package is missing, with the one to install; with its message where it draws nothing
std::string draw_figures(const std::vector<std::string>& documents, const std::string& folder,
                         const std::string& figure = "", const std::string& baseline = "", bool by_name = false);

/// Draws figures of an experiment's results.
/// \throws Error as draw_figures() of documents
void draw_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& folder);

/// Returns the bytes of a picture of an experiment's one problem: its world, with the robot at start and goal, and what
/// a level of its one run searched, where there is a run.
/// \param ending  ".svg", ".png" or ".pdf"
/// \throws Error as draw_figures()
std::string picture_of(const Experiment& experiment, const ExperimentResult& result, std::size_t level,
                       const std::string& ending, const PlotView& view);

}  // namespace trellis::command
