// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/figures.hpp>

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include <dsl/command/python.hpp>
#include <trellis/pictures/packed_run.hpp>
#include <trellis/pictures/scenery.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/results/files.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;

const PythonModule figures{"trellis.figures",
                           "figures",
                           {"numpy", "matplotlib", "pandas"},
                           "figures are drawn by Python 3 with matplotlib and pandas: install python3-matplotlib and "
                           "python3-pandas (Debian)"};

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Writes the document and the samples of results into a folder, and returns the document's name.
std::string write_results(const Experiment& experiment, const ExperimentResult& result, const std::string& folder) {
  ExperimentFacts facts = facts_of(experiment, result);
  facts.scenery = scenery_of(experiment);
  facts.samples = "samples";
  write_packed_samples(experiment, result, (fs::path(folder) / facts.samples).string());
  std::string document = (fs::path(folder) / "results.json").string();
  write_file(document, report_json(facts, summarise(facts)), Flush::none);
  return document;
}

}  // namespace

std::string draw_figures(const std::vector<std::string>& documents, const std::string& folder,
                         const std::string& figure, const std::string& baseline, bool by_name) {
  std::vector<std::string> arguments = documents;
  arguments.insert(arguments.end(), {"--out", folder});
  if (!figure.empty()) arguments.insert(arguments.end(), {"--figure", figure});
  if (!baseline.empty()) arguments.insert(arguments.end(), {"--baseline", baseline});
  if (by_name) arguments.emplace_back("--by-name");
  return run_python(figures, arguments);
}

void draw_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& folder) {
  const TemporaryFolder place;
  const std::string document = write_results(experiment, result, place.path());
  static_cast<void>(run_python(figures, {document, "--out", folder}, document));
}

std::string picture_of(const Experiment& experiment, const ExperimentResult& result, std::size_t level,
                       const std::string& ending, const PlotView& view) {
  const TemporaryFolder place;
  const std::string picture = (fs::path(place.path()) / ("picture" + ending)).string();
  const std::string document = write_results(experiment, result, place.path());
  std::vector<std::string> arguments = {document, "--figure", "world", "--file", picture};
  if (!result.runs.empty()) arguments.insert(arguments.end(), {"--level", std::to_string(level)});
  if (view.azimuth) arguments.insert(arguments.end(), {"--azimuth", fmt::format("{}", *view.azimuth)});
  if (view.elevation) arguments.insert(arguments.end(), {"--elevation", fmt::format("{}", *view.elevation)});
  static_cast<void>(run_python(figures, arguments, document));
  return text_of(picture);
}

}  // namespace trellis::command
