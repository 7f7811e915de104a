// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/verbs/report.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/figures.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/base/error.hpp>
#include <trellis/page/html.hpp>
#include <trellis/pictures/stored_samples.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/results/records.hpp>

namespace trellis::command {

namespace {

constexpr int unbounded_width = 160;

struct ReportOptions {
  std::vector<std::string> files;  ///< documents of trellis run --json
  std::optional<std::size_t> kind;
  std::optional<std::uint64_t> width;
  std::string baseline;  ///< a strategy, "" for the one that the documents name
  bool by_name = false;  ///< strategies of one name may have other options in each file
  std::string figures;   ///< a folder, "" if not given
  std::string figure;    ///< a name, "" for all
  std::string html;      ///< a file, "" if not given

  /// Whether the costs of strategies are printed.
  [[nodiscard]] bool costs() const { return kind ? *kind == report_kinds().size() : files.size() > 1 || by_name; }
  /// Whether text is printed, and not only figures or a page are written.
  [[nodiscard]] bool prints() const { return kind || width || by_name || (figures.empty() && html.empty()); }
};

/// The kinds of trellis run --report, and one more.
std::vector<std::string> kinds_of_stored() {
  std::vector<std::string> kinds = report_kinds();
  kinds.emplace_back("costs");
  return kinds;
}

void check(const ReportOptions& options) {
  if (!options.figure.empty() && options.figures.empty())
    throw Error("--figure: --figures FOLDER says where the figure goes");
  if (options.costs() || !options.prints()) return;
  if (options.files.size() > 1) {
    throw Error(
        fmt::format("--report {}: it is of one document, whose efficiencies do not add up with those of others; "
                    "expected one RESULTS, or --report costs",
                    report_kinds()[*options.kind]));
  }
  if (options.by_name) throw Error("--by-name: it is of --report costs");
  if (!options.baseline.empty() && options.figures.empty()) {
    throw Error("--baseline: it is of --report costs and --figures; a report has the baseline of its experiment");
  }
}

void report_costs(const ReportOptions& options) {
  CostData data;
  data.by_name = options.by_name;
  for (const std::string& file : options.files) {
    const ExperimentFacts facts = read_document(file);
    data.add(facts, summarise(facts), file);
  }
  const std::string baseline = options.baseline.empty() ? data.reference() : options.baseline;
  if (baseline.empty())
    throw Error("--report costs: the files have one strategy, so there is nothing to compare it with");
  const auto width =
      static_cast<std::size_t>(options.width.value_or(static_cast<std::uint64_t>(report_width(unbounded_width))));
  print_all(costs_text(data, baseline, width));
}

/// Writes the page of a document, with replays where it has stored its samples.
void write_page(const ReportOptions& options) {
  if (options.files.size() != 1) {
    throw Error("--html: the page is of one document, whose efficiencies it shows; those of several do not add up");
  }
  require_writable_file(options.html);
  const std::string& file = options.files.front();
  const ExperimentFacts facts = read_document(file);
  require_format(facts, file);
  std::optional<StoredSamples> samples;
  if (!facts.samples.empty()) {
    samples.emplace((std::filesystem::path(file).parent_path() / facts.samples).string(), facts);
  }
  write_html(facts, summarise(facts), samples ? &*samples : nullptr, options.html, {.document = file});
}

int report(const ReportOptions& options) {
  check(options);
  if (options.prints()) {
    if (options.costs()) {
      report_costs(options);
    } else {
      const ExperimentFacts facts = read_document(options.files.front());
      require_format(facts, options.files.front());
      print_report(summarise(facts), static_cast<ReportKind>(options.kind.value_or(0)), options.width);
    }
  }
  if (!options.html.empty()) write_page(options);
  if (!options.figures.empty()) {
    for (const std::string& file : options.files) static_cast<void>(read_document(file));
    OutputFolder folder(options.figures);
    const std::string files =
        draw_figures(options.files, options.figures, options.figure, options.baseline, options.by_name);
    folder.keep();
    print_all(files);
  }
  return success;
}

}  // namespace

void print_report(const ExperimentSummary& summary, ReportKind kind, std::optional<std::uint64_t> width) {
  constexpr int overview_width = 100;
  const int usual = report_width(kind == ReportKind::overview ? overview_width : unbounded_width);
  print_all(report_text(summary, width ? static_cast<int>(*width) : usual, kind));
}

void add_report(CommandLine& line) {
  const auto options = std::make_shared<ReportOptions>();
  Subcommand verb =
      line.add("report", "print, compare and draw stored results of trellis run, without planning", [options] {
        name_documents(options->files);
        return report(*options);
      });
  verb.arguments("RESULTS", "FILE", options->files,
                 "documents that trellis run --json wrote, or folders of --out, also of sweep and merge");
  verb.choice("--report", kinds_of_stored(), options->kind,
              "what is printed: overview (default of one RESULTS), levels, efficiency or full as of trellis run; or "
              "costs (default of several), what strategies cost, seed by seed");
  verb.text("--baseline", "NAME", options->baseline,
            "the strategy that the others are compared with, instead of the experiment's");
  verb.flag(
      "--by-name", options->by_name,
      "compare strategies by name, where their options differ between files (as steps that follow a world's size)");
  verb.text("--figures", "FOLDER", options->figures,
            "draw figures and tables for papers into a folder (needs matplotlib of Python)");
  verb.text(
      "--figure", "NAME", options->figure,
      "the figure of this name alone: costs, success, ratios, world, ... (default all that the results suffice for)");
  verb.text("--html", "FILE", options->html, "write the page of trellis run --html");
  verb.integer(
      "--width", "N", 60, 1000, options->width,
      "the report's width in columns (default the terminal's, else COLUMNS of the environment, else 100 or 160)");
}

}  // namespace trellis::command
