// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <trellis/draw/planar.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/report/pictures.hpp>

namespace trellis {

/// The content of the printed report.
enum class ReportKind : std::uint8_t {
  overview,    ///< solved runs, costs relative to the baseline, the verdict on each level, and the next step
  levels,      ///< each level's search and verdict, and the obstacles that reject its proposals
  efficiency,  ///< how each level samples, with all values of the measure
  full,        ///< the tables of `levels` and `efficiency`, and a summary of all strategies
};
/// Returns their names, in this order.
const std::vector<std::string>& report_kinds();

/// Returns the printed report, problem by problem; reports more than six problems together. UTF-8, no colour, at most
/// `width` columns where the content allows; an overview fits into 100.
std::string report_text(const Experiment& experiment, const ExperimentResult& result, int width = 160,
                        ReportKind kind = ReportKind::full);

/// A part of the printed report: the search of each level of one run.
std::string levels_text(const RunResult& run, int width = 160);
/// A part of the printed report: how each level of one run samples, where it was scored.
std::string efficiency_text(const RunResult& run, int width = 160);
/// A part of the printed report: the strategies and their comparisons, problem by problem.
std::string summary_text(const Experiment& experiment, const ExperimentResult& result, int width = 160);

/// Returns the JSON document that docs/formats.md describes. A missing value is null.
/// \param script  the path as given on the command line, "" for none
std::string report_json(const Experiment& experiment, const ExperimentResult& result, const std::string& script);

/// Returns the root's sampling efficiency in the layout of papers, in Markdown: strategies below each other, problems
/// side by side, the tree above the expansion. It contains every estimator, on own and other seeds' paths, and the
/// other measures. With published values it lists both, with rank correlations, and states whether the results confirm
/// the published claims.
std::string report_markdown(const Experiment& experiment, const ExperimentResult& result);

/// Returns the same values as comma-separated values, one per line: problem, strategy, role, path, estimator, quantity,
/// value, lo, hi, n, infinite.
std::string report_csv(const Experiment& experiment, const ExperimentResult& result);

/// Writes DIR/<problem>/<strategy>/seed-<seed>/samples.csv and path.csv for every run. Writes each file atomically (a
/// temporary file, then a rename).
/// \throws Error where it cannot write a file.
void write_samples(const ExperimentResult& result, const std::string& directory);

/// Draws the measure: DIR/<problem>/<strategy>/waterfall.svg, profile.svg, strip.svg and plane.svg, and the same as
/// .png and .pdf, for every scored strategy; `jobs` of them concurrently. DIR/<problem>/waterfalls.* has those of all
/// strategies with guides on one scale. Omits empty pictures.
/// \throws Error where it cannot write a file.
void write_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                   unsigned jobs = 1, const FigureStyle& style = {});

struct HtmlOptions {
  std::string script = {};  ///< the path as given on the command line, "" for none
  /// Limit for the runs' samples, in a page of at most 5 MB. The page thins long searches. If the runs of all seeds
  /// exceed the limit, it contains those of the first seeds, and says so.
  std::size_t most_bytes = 5'000'000;
  std::function<void(std::size_t, std::size_t)> progress = {};  ///< called for each packed run: finished, all
};

/// Returns one self-contained HTML page: the results, and every run for replay and inspection (docs/formats.md). UTF-8.
std::string report_html(const Experiment& experiment, const ExperimentResult& result, const HtmlOptions& options = {});
/// \throws Error where it cannot write the file.
void write_html(const Experiment& experiment, const ExperimentResult& result, const std::string& path,
                const HtmlOptions& options = {});

struct SceneFigureOptions {
  draw::RoleColours colours = draw::RoleColours::safe;
  /// The side of the cells in which to count samples, metres. None: half a metre, doubled or halved until the world's
  /// longer side has about 12 to 48 cells.
  std::optional<double> cell = {};
  unsigned jobs = 1;  ///< pictures drawn concurrently
  FigureStyle style = {};
};

/// Draws the distribution of the samples in the world, as Figure 2 of Attali et al. 2022:
/// DIR/<problem>/<strategy>/samples.svg, .png and .pdf for every strategy, and levels.* where levels below the root
/// have a position in the plane. Omits problems without a position in the plane. \return a sentence about each omitted
/// problem
/// \throws Error for a cell out of range, and where it cannot write a file.
std::vector<std::string> write_scene_figures(const Experiment& experiment, const ExperimentResult& result,
                                             const std::string& directory, const SceneFigureOptions& options = {});

/// Draws motions in two-dimensional spaces, as Figure 1 of Attali et al. 2022: DIR/<problem>/<strategy>/motion.svg,
/// .png and .pdf for every strategy of a problem whose space has two axes and is more than the workspace. Each picture
/// shows the robot along its path, and beside it the space with the invalid configurations, the path, and the density
/// of the proposals. It has a row for each guide that searches the same space, the deepest first, and one for the root.
/// It shows the first run that found a path or, without one, the first run.
/// \throws Error where it cannot write a file.
void write_motion_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                          unsigned jobs = 1, const FigureStyle& style = {});

/// Writes a file atomically. \throws Error that names the path and the reason.
void write_file(const std::string& path, const std::string& content);

/// Returns the version of Trellis, e.g. "0.1.0".
std::string version();

}  // namespace trellis
