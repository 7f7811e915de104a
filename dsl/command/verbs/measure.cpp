// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <dsl/command/case_file.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/measurement.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/csv.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

struct MeasureOptions {
  std::string file;       ///< the case
  std::string json;       ///< a file, "-" for stdout, "" if not given
  std::string estimator;  ///< a name, "all", "" for the default
  ScriptOptions scripts;
};

std::vector<EstimatorSpec> estimators(const MeasureOptions& options, std::size_t degrees) {
  try {
    return measure_estimators(options.estimator, degrees);
  } catch (const Error& error) {
    throw Error(fmt::format("--estimator: {}", error.what()));
  }
}

int measure(const MeasureOptions& options) {
  static_cast<void>(estimators(options, 1));  // reports an unknown estimator before it reads the case
  const bool to_stdout = options.json == "-";
  const bool to_file = !options.json.empty() && !to_stdout;
  if (to_file) require_writable_file(options.json);
  const Case c = read_case(options.file, session_options(options.scripts));
  Configurations samples = read_csv(c.samples, c.coordinates, c.file + ": samples");
  const Measurement m = measure_samples(c, std::move(samples), estimators(options, c.space.degrees()));
  const std::string json = measurement_json(c, m);
  if (to_file) write_file(options.json, json);
  print_all(to_stdout ? json : measurement_table(c, m));
  return success;
}

}  // namespace

void add_measure(CommandLine& line) {
  const auto options = std::make_shared<MeasureOptions>();
  Subcommand verb = line.add("measure", "measure samples that any program drew, and print the figures",
                             [options] { return measure(*options); });
  verb.argument("CASE", "FILE", options->file, "a case file: the space, the path, and where the samples are");
  verb.text("--json", "FILE", options->json, "write all figures to a file, - for the standard output");
  verb.text("--estimator", "NAME", options->estimator,
            "the estimator instead of knn (arc from five degrees of freedom on), or all");
  add_script_options(verb, options->scripts);
}

}  // namespace trellis::command
