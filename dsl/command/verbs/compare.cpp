// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/figure_options.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/base/error.hpp>
#include <trellis/figures/charts/costs_figures.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

struct CompareOptions {
  std::vector<std::string> files;      ///< documents of trellis run --json
  std::string baseline;                ///< a strategy, "" for the one that the documents name
  std::string out;                     ///< a folder, "" if not given
  bool by_name = false;                ///< strategies of one name may have other options in each file
  std::optional<std::uint64_t> width;  ///< of what is printed, in columns
  FigureOptions style;
};

int compare(const CompareOptions& options) {
  constexpr int unbounded_width = 160;
  check_format(options.style, !options.out.empty());
  const FigureStyle style = figure_style(options.style, !options.out.empty());
  OutputFolder out(options.out);
  CostData data;
  data.by_name = options.by_name;
  for (const std::string& file : options.files) {
    const ExperimentFacts facts = read_document(file);
    data.add(facts, summarise(facts), file);
  }
  const std::string baseline = options.baseline.empty() ? data.reference() : options.baseline;
  if (baseline.empty()) throw Error("compare: the files have one strategy, so there is nothing to compare it with");
  const auto width =
      static_cast<std::size_t>(options.width.value_or(static_cast<std::uint64_t>(report_width(unbounded_width))));
  print_all(costs_text(data, baseline, width));
  if (options.out.empty()) return success;
  const std::filesystem::path folder(options.out);
  write_tables(options.style, options.out, costs_markdown(data, baseline));
  write_file((folder / "table.csv").string(), costs_csv(data, baseline));
  write_cost_figures(data, baseline, (folder / "figures").string(), style);
  out.keep();
  return success;
}

}  // namespace

void add_compare(CommandLine& line) {
  const auto options = std::make_shared<CompareOptions>();
  Subcommand verb =
      line.add("compare", "compare what strategies cost, seed by seed, in results of trellis run", [options] {
        name_documents(options->files);
        return compare(*options);
      });
  verb.arguments("RESULTS", "FILE", options->files, "documents that trellis run --json wrote, or folders of --out");
  verb.text("--baseline", "NAME", options->baseline,
            "the strategy that the others are compared with, instead of the experiment's");
  verb.flag(
      "--by-name", options->by_name,
      "compare strategies by name, where their options differ between files (as steps that follow a world's size)");
  verb.text("--out", "FOLDER", options->out, "write tables and figures into a folder");
  verb.integer("--width", "N", 60, 1000, options->width,
               "the tables' width in columns (default the terminal's, else COLUMNS of the environment, else 160)");
  add_figure_options(verb, options->style);
}

}  // namespace trellis::command
