// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/verbs/report.hpp>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/report/records.hpp>

namespace trellis::command {

namespace {

struct ReportOptions {
  std::string file;  ///< a document of trellis run --json
  std::optional<std::size_t> kind;
  std::optional<std::uint64_t> width;
};

int report(const ReportOptions& options) {
  const ExperimentFacts facts = read_document(options.file);
  require_format(facts, options.file);
  print_report(summarise(facts), static_cast<ReportKind>(options.kind.value_or(0)), options.width);
  return success;
}

}  // namespace

void print_report(const ExperimentSummary& summary, ReportKind kind, std::optional<std::uint64_t> width) {
  constexpr int unbounded_width = 160;
  constexpr int overview_width = 100;
  const int usual = report_width(kind == ReportKind::overview ? overview_width : unbounded_width);
  print_all(report_text(summary, width ? static_cast<int>(*width) : usual, kind));
}

void add_report(CommandLine& line) {
  const auto options = std::make_shared<ReportOptions>();
  Subcommand verb = line.add("report", "print the report of stored results again", [options] {
    std::vector<std::string> files = {options->file};
    name_documents(files);
    options->file = files.front();
    return report(*options);
  });
  verb.argument("RESULTS", "FILE", options->file,
                "a document that trellis run --json wrote, or a folder of --out, also of sweep and merge");
  verb.choice("--report", report_kinds(), options->kind,
              "what is printed: overview (default), levels, efficiency or full");
  verb.integer(
      "--width", "N", 60, 1000, options->width,
      "the report's width in columns (default the terminal's, else COLUMNS of the environment, else 100 or 160)");
}

}  // namespace trellis::command
