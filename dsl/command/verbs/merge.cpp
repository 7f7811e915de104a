// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/python.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/command/store/records.hpp>
#include <trellis/base/error.hpp>
#include <trellis/results/files.hpp>
#include <trellis/results/records.hpp>

namespace trellis::command {

namespace {

struct MergeOptions {
  std::vector<std::string> folders;  ///< of trellis sweep
  std::string out;                   ///< "" if not given
  std::string sqlite;                ///< a file, "" if not given
  std::string pdt;                   ///< a folder, "" if not given
  std::string csv;                   ///< a file, "" if not given
};

/// \throws Error that names the first missing run and the first that the experiment does not have.
void check_complete(const StoredRuns& records) {
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t run = records.runs().size(); run-- > 0;) {
    if (records.contains(run)) continue;
    ++count;
    first = run;
  }
  if (count > 0) {
    throw Error(fmt::format("merge: {} of {} runs are missing, the first is {}; repeat the sweep of its shard", count,
                            records.runs().size(), records.runs().key(first).text()));
  }
  if (records.others() > 0) {
    throw Error(fmt::format("merge: {} records are of runs that the experiment does not have", records.others()));
  }
}

void write_stored(const std::string& folder, const Manifest& manifest, const StoredRuns& records) {
  write_results(folder, manifest, [&](std::size_t run) { return records.line(run); });
  manifest.write(folder);
}

const PythonModule exports{"trellis.export",
                           "exports",
                           {"sqlite3"},
                           "databases and files for PDT are written by Python 3: install python3 (Debian)"};

void write_folder(const MergeOptions& options, const Manifest& manifest, const StoredRuns& records) {
  OutputFolder out(options.out);
  // The same command replaces what it wrote.
  const std::string difference =
      Manifest::exists(options.out) ? Manifest::read(options.out).difference(manifest, true) : "";
  if (!difference.empty()) {
    throw Error(fmt::format("--out: '{}' holds other runs: {}; name another folder", options.out, difference));
  }
  write_stored(options.out, manifest, records);
  out.keep();
}

int merge(const MergeOptions& options) {
  if (options.out.empty() && options.sqlite.empty() && options.pdt.empty() && options.csv.empty()) {
    throw Error("merge: name an output: --out FOLDER, --csv FILE, --sqlite FILE or --pdt FOLDER");
  }
  if (!options.csv.empty()) require_writable_file(options.csv);
  if (!options.sqlite.empty()) require_writable_file(options.sqlite);
  Manifest manifest = Manifest::read(options.folders.front());
  StoredRuns records(manifest.experiment);
  for (const std::string& folder : options.folders) {
    const std::string difference = manifest.difference(Manifest::read(folder), false);
    if (!difference.empty()) {
      throw Error(
          fmt::format("merge: '{}' and '{}' are of different sweeps: {}", options.folders.front(), folder, difference));
    }
    records.add((std::filesystem::path(folder) / "runs.jsonl").string());
  }
  manifest.shard = {};
  check_complete(records);
  std::vector<std::string> written;
  if (!options.out.empty()) {
    write_folder(options, manifest, records);
    written.push_back(fmt::format("'{}'", options.out));
  }
  if (!options.csv.empty()) {
    FileWriter table(options.csv);
    table.write(runs_csv_header());
    for (std::size_t run = 0; run < records.runs().size(); ++run) table.write(runs_csv_row(records.line(run)));
    table.publish();
    written.push_back(fmt::format("'{}'", options.csv));
  }
  if (!options.sqlite.empty() || !options.pdt.empty()) {
    std::optional<TemporaryFolder> own;
    if (options.out.empty()) write_stored(own.emplace().path(), manifest, records);
    const std::string& stored = own ? own->path() : options.out;
    for (const auto& [to, out] : {std::pair{"sqlite", options.sqlite}, std::pair{"pdt", options.pdt}}) {
      if (out.empty()) continue;
      OutputFolder folder(to == std::string_view("pdt") ? out : "");
      run_python(exports, {"--to", to, "--", stored, out}, own ? stored : "");
      folder.keep();
      written.push_back(fmt::format("'{}'", out));
    }
  }
  print_all(fmt::format("{} runs of {} folder{} in {}\n", records.runs().size(), options.folders.size(),
                        options.folders.size() == 1 ? "" : "s", fmt::join(written, ", ")));
  return success;
}

}  // namespace

void add_merge(CommandLine& line) {
  const auto options = std::make_shared<MergeOptions>();
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
