// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/store/export.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/command/store/records.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <trellis/base/error.hpp>
#include <trellis/report/records.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

constexpr std::size_t largest_file = std::size_t{4} << 30U;

struct Options {
  std::vector<std::string> folders;  ///< of trellis sweep
  std::string out;                   ///< "" if not given
  std::string sqlite;                ///< a file, "" if not given
  std::string pdt;                   ///< a folder, "" if not given
  std::string csv;                   ///< a file, "" if not given
};

/// Adds a folder's records. Records of one run must be equal, except for times; the first one remains.
void add_records(Records& all, const std::string& folder) {
  const std::string path = (std::filesystem::path(folder) / "runs.jsonl").string();
  std::size_t complete = 0;
  for (const auto& [key, line] : parse_records(dsl::read_file(path, largest_file), path, complete)) {
    const auto [at, added] = all.emplace(key, line);
    if (!added && without_times(at->second) != without_times(line)) {
      throw Error(
          fmt::format("{}: {} differs from its record in a folder before; they ran on different programs or "
                      "scenes",
                      path, key.text()));
    }
  }
}

/// \throws Error that names the first missing run and the first that the experiment does not have.
void check_complete(const Manifest& manifest, const Records& records) {
  const std::vector<RunKey> keys = keys_of(manifest.experiment);
  const auto missing = [&](const RunKey& key) { return !records.contains(key); };
  const auto count = std::count_if(keys.begin(), keys.end(), missing);
  if (count > 0) {
    throw Error(fmt::format("merge: {} of {} runs are missing, the first is {}; repeat the sweep of its shard", count,
                            keys.size(), std::find_if(keys.begin(), keys.end(), missing)->text()));
  }
  if (records.size() > keys.size()) {
    throw Error(
        fmt::format("merge: {} records are of runs that the experiment does not have", records.size() - keys.size()));
  }
}

void write_folder(const Options& options, const Manifest& manifest, const Records& records) {
  OutputFolder out(options.out);
  // The same command replaces what it wrote.
  const std::string difference =
      Manifest::exists(options.out) ? Manifest::read(options.out).difference(manifest, true) : "";
  if (!difference.empty()) {
    throw Error(fmt::format("--out: '{}' holds other runs: {}; name another folder", options.out, difference));
  }
  write_results(options.out, manifest, records);
  manifest.write(options.out);
  out.keep();
}

int merge(const Options& options) {
  if (options.out.empty() && options.sqlite.empty() && options.pdt.empty() && options.csv.empty()) {
    throw Error("merge: name an output: --out FOLDER, --csv FILE, --sqlite FILE or --pdt FOLDER");
  }
  if (!options.csv.empty()) require_writable_file(options.csv);
  if (!options.sqlite.empty()) {
    require_writable_file(options.sqlite);
    require_replaceable_database(options.sqlite);
  }
  Manifest manifest = Manifest::read(options.folders.front());
  Records records;
  for (const std::string& folder : options.folders) {
    const std::string difference = manifest.difference(Manifest::read(folder), false);
    if (!difference.empty()) {
      throw Error(
          fmt::format("merge: '{}' and '{}' are of different sweeps: {}", options.folders.front(), folder, difference));
    }
    add_records(records, folder);
  }
  manifest.shard = {};
  check_complete(manifest, records);
  std::vector<std::string> written;
  if (!options.out.empty()) {
    write_folder(options, manifest, records);
    written.push_back(fmt::format("'{}'", options.out));
  }
  if (!options.csv.empty()) {
    std::vector<std::string> lines;
    for (const RunKey& key : keys_of(manifest.experiment)) lines.push_back(records.at(key));
    write_file(options.csv, runs_csv(lines));
    written.push_back(fmt::format("'{}'", options.csv));
  }
  if (!options.sqlite.empty()) {
    write_database(options.sqlite, manifest, records);
    written.push_back(fmt::format("'{}'", options.sqlite));
  }
  if (!options.pdt.empty()) {
    OutputFolder folder(options.pdt);
    write_pdt(options.pdt, manifest, records);
    folder.keep();
    written.push_back(fmt::format("'{}'", options.pdt));
  }
  print_all(fmt::format("{} runs of {} folder{} in {}\n", records.size(), options.folders.size(),
                        options.folders.size() == 1 ? "" : "s", fmt::join(written, ", ")));
  return success;
}

}  // namespace

void add_merge(CommandLine& line) {
  const auto options = std::make_shared<Options>();
  Subcommand verb = line.add(
      "merge", "join the shards of a sweep into a folder or a database, checked for missing and contradictory runs",
      [options] { return merge(*options); });
  verb.arguments("FOLDER", "FOLDER", options->folders, "folders that trellis sweep or trellis run --out wrote");
  verb.text("--out", "FOLDER", options->out, "the folder of the joined sweep");
  verb.text("--csv", "FILE", options->csv, "a table of the runs, a row for each");
  verb.text("--sqlite", "FILE", options->sqlite, "one SQLite file with all runs, also for Planner Arena");
  verb.text("--pdt", "FOLDER", options->pdt, "a CSV file for each problem, for Planner Developer Tools (PDT)");
}

}  // namespace trellis::command
