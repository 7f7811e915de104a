// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/figure_options.hpp>
#include <dsl/command/outputs.hpp>
#include <dsl/language/stdlib.hpp>
#include <trellis/base/error.hpp>
#include <trellis/figures/costs_figures.hpp>
#include <trellis/figures/pictures.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/directories.hpp>

namespace trellis::command {

namespace {

constexpr std::size_t largest = std::size_t{4} << 30U;

const std::vector<std::string>& figure_names() {
  static const std::vector<std::string> names = {"success", "length", "ratios"};
  return names;
}

enum class Kind : std::uint8_t { success, length, ratios };

struct Options {
  std::vector<std::string> files;  ///< documents of trellis run --json
  std::optional<std::size_t> figure;
  std::string baseline;  ///< a strategy, "" for the one that the documents name
  std::string out;
  FigureOptions style;
};

/// Draws figures into a folder, and lists the files without their endings.
class Plotter {
 public:
  Plotter(std::string folder, FigureStyle style) : folder_(std::move(folder)), style_(style) {}

  template <class F>
  void draw(const std::optional<F>& figure, const std::string& problem, const std::string& name) {
    if (!figure) return;
    const std::filesystem::path place = problem.empty() ? folder_ : folder_ / directories_(problem);
    make_directory(place.string());
    stems_.push_back((place / name).string());
    write_figure(*figure, style_, stems_.back());
  }
  [[nodiscard]] const std::vector<std::string>& stems() const { return stems_; }

 private:
  std::filesystem::path folder_;
  FigureStyle style_;
  Directories directories_;
  std::vector<std::string> stems_;
};

void draw(const CostData& data, const std::string& baseline, Kind kind, Plotter& plotter) {
  const std::string& name = figure_names()[static_cast<std::size_t>(kind)];
  for (std::size_t p = 0; p < data.problems.size(); ++p) {
    const std::string& problem = data.problems[p].name;
    if (kind == Kind::success) plotter.draw(success_figure(data, baseline, p), problem, name);
    if (kind == Kind::length) plotter.draw(length_figure(data, baseline, p), problem, name);
    if (kind == Kind::ratios) plotter.draw(ratio_figure(data.on(p), baseline), problem, name);
  }
  if (kind == Kind::ratios && data.problems.size() > 1) plotter.draw(ratio_figure(data, baseline), "", name);
}

std::string chosen_baseline(const CostData& data, const Options& options) {
  std::string name = options.baseline.empty() ? data.baseline : options.baseline;
  std::vector<std::string> known;
  for (const CostData::Strategy& strategy : data.strategies) known.push_back(strategy.name);
  if (!name.empty() && std::find(known.begin(), known.end(), name) == known.end()) {
    throw Error(fmt::format("--baseline: there is no strategy '{}'{}; there are: {}", name, did_you_mean(name, known),
                            fmt::join(known, ", ")));
  }
  return name;
}

int plot(const Options& options) {
  check_format(options.style, false);
  const FigureStyle style = figure_style(options.style, true);
  CostData data;
  for (const std::string& file : options.files) data.add(dsl::read_file(file, largest), file);
  const std::string baseline = chosen_baseline(data, options);
  const auto only = options.figure;
  if (only && static_cast<Kind>(*only) == Kind::ratios && baseline.empty()) {
    throw Error("--figure ratios: the files name no baseline; --baseline says which strategy it is");
  }
  OutputFolder out(options.out);
  Plotter plotter(options.out, style);
  for (std::size_t i = 0; i < figure_names().size(); ++i) {
    if (!only || *only == i) draw(data, baseline, static_cast<Kind>(i), plotter);
  }
  if (plotter.stems().empty()) {
    throw Error(only && static_cast<Kind>(*only) == Kind::length
                    ? "--figure length: no strategy of the files improves its path, so there is nothing to draw"
                    : "plot: the files have no run with a path, so there is nothing to draw");
  }
  out.keep();
  for (const std::string& stem : plotter.stems()) print_all(fmt::format("{}.svg, .png, .pdf\n", stem));
  return success;
}

}  // namespace

void add_plot(CommandLine& line) {
  const auto options = std::make_shared<Options>();
  Subcommand verb =
      line.add("plot", "draw stored results of trellis run, without planning", [options] { return plot(*options); });
  verb.arguments("RESULTS", "FILE", options->files, "documents that trellis run --json wrote");
  verb.choice("--figure", figure_names(), options->figure,
              "the figure of this name alone: success, length or ratios (default all that the results suffice for)");
  verb.text("--baseline", "NAME", options->baseline,
            "the strategy that the others are compared with, instead of the experiment's");
  verb.text("--out", "FOLDER", options->out, "the folder of the figures", true);
  add_figure_options(verb, options->style);
}

}  // namespace trellis::command
