// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of when the robots of a team move.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <trellis/draw/chart.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/figures/charts/pictures.hpp>
#include <trellis/figures/html.hpp>

namespace trellis {

/// How far each robot of a team is along its path, in the metric of its own coordinates.
struct TeamProgress {
  std::vector<std::size_t> numbers;           ///< of the robots
  std::vector<double> at;                     ///< seconds, of each configuration of the path (TeamTimes)
  std::vector<std::vector<double>> distance;  ///< metres, by robot and configuration
};
/// \param problem  of a team of flat spaces
TeamProgress progress_of(const Problem& problem, const Configurations& path);

/// Where two robots touch that are anywhere on their paths: a coordination diagram (O'Donnell and Lozano-Perez 1989).
struct ContactRegion {
  std::size_t first = 0;  ///< robots, from 0 on
  std::size_t second = 0;
  std::size_t cells = 0;    ///< along each path
  std::vector<char> touch;  ///< by cell of the second robot's path, then of the first one's
  [[nodiscard]] std::size_t size() const;
};
/// Returns the region of two robots on the path of a team.
ContactRegion contact_region(const Problem& problem, const Configurations& path, std::size_t first, std::size_t second,
                             std::size_t cells);

/// Returns the picture of a team's path: how far each robot is at a time, and the coordination diagrams of the pairs
/// with the largest regions of contact. None of a problem without a team, or whose robots' spaces are not flat.
std::optional<draw::Figure> schedule_figure(const Problem& problem, const Configurations& path);

/// Returns schedule_figure() of the first run of each strategy that found a path, for the page.
PageSchedules schedules_of(const Experiment& experiment, const ExperimentResult& result);

/// Draws schedule_figure() of the first run of each strategy that found a path: DIR/<problem>/<strategy>/schedule.svg,
/// .png and .pdf. \throws Error where it cannot write a file.
void write_schedule_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                            const FigureStyle& style = {});

}  // namespace trellis
