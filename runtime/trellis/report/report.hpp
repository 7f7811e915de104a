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

/// What the printed report has in it.
enum class ReportKind : std::uint8_t {
  overview,    ///< what was solved, at which cost beside the baseline, which level pays, what to try next
  levels,      ///< what each level did and whether it pays, with what rejects its proposals
  efficiency,  ///< how each level sampled, with every figure of the measure
  full,        ///< the tables of `levels` and `efficiency`, and a summary of strategies side by side
};
/// Their names, in this order.
const std::vector<std::string>& report_kinds();

/// The printed report, problem by problem; more than six problems are taken together. UTF-8, no colour, at most `width`
/// columns where the content allows; an overview fits 100.
std::string report_text(const Experiment& experiment, const ExperimentResult& result, int width = 160,
                        ReportKind kind = ReportKind::full);

/// Parts of the printed report, for who asks about one thing at a time. What each level of one run did.
std::string levels_text(const RunResult& run, int width = 160);
/// How each level of one run sampled, where it was scored.
std::string efficiency_text(const RunResult& run, int width = 160);
/// The strategies side by side and their comparisons, problem by problem.
std::string summary_text(const Experiment& experiment, const ExperimentResult& result, int width = 160);

/// The one JSON document described in docs/formats.md. A figure that does not exist is null.
/// \param script  the path as given on the command line, "" for none
std::string report_json(const Experiment& experiment, const ExperimentResult& result, const std::string& script);

/// The root's sampling efficiency as papers print it, in Markdown: strategies below each other, problems side by side,
/// the tree above the expansion; by every estimator, on own and other seeds' paths; the other measures; and, where
/// something was published, both beside each other, rank correlations, and whether its claims are borne out.
std::string report_markdown(const Experiment& experiment, const ExperimentResult& result);

/// The same figures as comma-separated values, one to a line: problem, strategy, role, path, estimator, quantity,
/// value, lo, hi, n, infinite.
std::string report_csv(const Experiment& experiment, const ExperimentResult& result);

/// Writes DIR/<problem>/<strategy>/seed-<seed>/samples.csv and path.csv for every run. Each file appears whole (written
/// beside and renamed). Throws Error where a file cannot be written.
void write_samples(const ExperimentResult& result, const std::string& directory);

/// Draws the measure: DIR/<problem>/<strategy>/waterfall.svg, profile.svg, strip.svg and plane.svg, and the same as
/// .png and .pdf, for every strategy that was scored; `jobs` of them at the same time. DIR/<problem>/waterfalls.* has
/// those of all strategies with guides on one scale. What would show nothing is not drawn. Throws Error where a file
/// cannot be written.
void write_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                   unsigned jobs = 1, const FigureStyle& style = {});

struct HtmlOptions {
  std::string script = {};  ///< the path as given on the command line, "" for none
  /// Of the runs' samples, in a page of at most 5 MB. Long searches are thinned out. Where the runs of all seeds take
  /// more, those of the first seeds are held, and the page says so.
  std::size_t most_bytes = 5'000'000;
  std::function<void(std::size_t, std::size_t)> progress = {};  ///< called as runs are packed: done, in all
};

/// One self-contained HTML page: the results, and every run to replay and look into (docs/formats.md). UTF-8.
std::string report_html(const Experiment& experiment, const ExperimentResult& result, const HtmlOptions& options = {});
/// Throws Error where the file cannot be written.
void write_html(const Experiment& experiment, const ExperimentResult& result, const std::string& path,
                const HtmlOptions& options = {});

struct SceneFigureOptions {
  draw::RoleColours colours = draw::RoleColours::safe;
  /// The side of the cells that samples are counted in, metres. None: half a metre, doubled or halved until the world's
  /// longer side has about 12 to 48 cells.
  std::optional<double> cell = {};
  unsigned jobs = 1;  ///< pictures drawn at the same time
  FigureStyle style = {};
};

/// Draws where in the world the samples lie, Figure 2 of Attali et al. 2022: DIR/<problem>/<strategy>/samples.svg, .png
/// and .pdf for every strategy, and levels.* where levels below the root have a position in the plane. Problems without
/// one are left out. Returns a sentence about each of them. Throws Error for a cell out of range, and where a file
/// cannot be written.
std::vector<std::string> write_scene_figures(const Experiment& experiment, const ExperimentResult& result,
                                             const std::string& directory, const SceneFigureOptions& options = {});

/// Draws motions in two-dimensional spaces, Figure 1 of Attali et al. 2022: DIR/<problem>/<strategy>/motion.svg, .png
/// and .pdf for every strategy of a problem whose space has two axes and is more than the workspace: the robot on its
/// way, and beside it the space with what is invalid in it, the path, and the density of what is proposed. A row for
/// each guide that searches the same space, the deepest first, and one for the root; of the first run that found a path
/// or, without one, the first. Throws Error where a file cannot be written.
void write_motion_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                          unsigned jobs = 1, const FigureStyle& style = {});

/// Writes a file whole or not at all. Throws Error naming the path and the reason.
void write_file(const std::string& path, const std::string& content);

/// The version of Trellis, e.g. "0.1.0".
std::string version();

}  // namespace trellis
