// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// The printed report: per problem, one table per strategy with one row per level (space and dimension, planner,
/// re-solves, proposals, nodes, validity checks, motion checks, time, sampling efficiency of tree and expansion with
/// its 95 % interval over the seeds, in the level's own space and lifted to the root), then a summary of strategies
/// side by side. UTF-8, no colour, at most `width` columns where the content allows.
std::string report_text(const Experiment& experiment, const ExperimentResult& result, int width = 160);

/// The one JSON document described in docs/formats.md. A figure that does not exist is null.
/// \param script  the path as given on the command line, "" for none
std::string report_json(const Experiment& experiment, const ExperimentResult& result, const std::string& script);

/// Writes DIR/<problem>/<strategy>/seed-<seed>/samples.csv and path.csv for every run. Each file appears whole (written
/// beside and renamed). Throws Error where a file cannot be written.
void write_samples(const ExperimentResult& result, const std::string& directory);

/// Draws the measure: DIR/<problem>/<strategy>/waterfall.svg and profile.svg, and the same as .png, for every strategy
/// that was scored. Throws Error where a file cannot be written.
void write_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory);

struct HtmlOptions {
  std::string script;  ///< the path as given on the command line, "" for none
  /// Of the runs' samples. Where those of all seeds take more, the first ones are held, and the page says so.
  std::size_t most_bytes = 24'000'000;
  std::function<void(std::size_t, std::size_t)> progress;  ///< called as runs are packed: done, in all
};

/// One self-contained HTML page: the results, and every run to replay and look into (docs/formats.md). UTF-8.
std::string report_html(const Experiment& experiment, const ExperimentResult& result, const HtmlOptions& options = {});
/// Throws Error where the file cannot be written.
void write_html(const Experiment& experiment, const ExperimentResult& result, const std::string& path,
                const HtmlOptions& options = {});

/// Writes a file whole or not at all. Throws Error naming the path and the reason.
void write_file(const std::string& path, const std::string& content);

/// The version of Trellis, e.g. "0.1.0".
std::string version();

}  // namespace trellis
