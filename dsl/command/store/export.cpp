// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/store/export.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <dsl/command/interrupt.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/memory/database.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/csv.hpp>
#include <trellis/results/directories.hpp>
#include <trellis/results/files.hpp>
#include <trellis/results/quantities.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int application = 0x54726C52;  // "TrlR", in the header of the file
constexpr int version_of_tables = 1;
constexpr Database::Names names{"database of trellis merge", "database"};

using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

/// Objects and lists are stored as JSON.
Value value_of(const Json& json) {
  if (json.is_null()) return {};
  if (json.is_boolean()) return std::int64_t{json.get<bool>() ? 1 : 0};
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  if (json.is_string()) return json.get<std::string>();
  return json.dump();
}

struct Column {
  std::string name;
  const char* type;
  std::string field;           ///< a JSON pointer into the entry; "": the value is given
  std::string otherwise = {};  ///< another one, for entries without that
};

class Table {
 public:
  /// Creates the table. Columns without a field come first.
  Table(const Database& database, const char* name, std::vector<Column> columns, const char* constraints = "")
      : columns_(std::move(columns)), insert_(database, create(database, name, columns_, constraints)) {}

  /// \param given  the values of the columns without a field
  void add(const std::vector<Value>& given, const Json& entry = Json()) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (i < given.size()) {
        bind(i, given[i]);
        continue;
      }
      const Json::json_pointer field(columns_[i].field);
      const Json::json_pointer otherwise(columns_[i].otherwise);
      if (entry.contains(field)) {
        bind(i, value_of(entry.at(field)));
      } else if (!otherwise.empty() && entry.contains(otherwise)) {
        bind(i, value_of(entry.at(otherwise)));
      }
    }
    insert_.step();
    insert_.reset();
  }

 private:
  /// Returns the statement that inserts a row.
  static std::string create(const Database& database, const char* name, const std::vector<Column>& columns,
                            const char* constraints) {
    std::string defined;
    std::string places;
    for (const Column& column : columns) {
      defined += fmt::format("{}{} {}", defined.empty() ? "" : ", ", column.name, column.type);
      places += places.empty() ? "?" : ", ?";
    }
    database.run(fmt::format("CREATE TABLE {} ({}{})", name, defined, constraints).c_str());
    return fmt::format("INSERT OR REPLACE INTO {} VALUES ({})", name, places);
  }

  void bind(std::size_t column, const Value& value) {
    std::visit(
        [&](const auto& x) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(x)>, std::monostate>) {
            insert_.bind(static_cast<int>(column) + 1, x);
          }
        },
        value);
  }

  std::vector<Column> columns_;
  Database::Statement insert_;
};

/// The records in the order of the runs, with the indices of their problem and strategy.
struct Entry {
  std::int64_t id = 0;        ///< from 1
  std::int64_t problem = 0;   ///< from 1
  std::int64_t strategy = 0;  ///< from 1
  Json run;
  const std::string* line = nullptr;
};

template <class Body>
void for_each_entry(const Json& experiment, const StoredRuns& records, const Body& body) {
  const auto strategies = static_cast<std::int64_t>(experiment.at("strategies").size());
  const auto seeds = static_cast<std::int64_t>(experiment.at("seeds").size());
  for (std::size_t i = 0; i < records.runs().size(); ++i) {
    if (InterruptibleRun::requested()) throw Interrupted();
    const auto at = static_cast<std::int64_t>(i);
    const std::string line = records.line(i);
    body(Entry{at + 1, at / seeds / strategies + 1, at / seeds % strategies + 1, Json::parse(line), &line});
  }
}

// The tables of trellis -----------------------------------------------------------------------------------------------

void write_inputs(const Database& database, const Manifest& manifest, const Json& experiment) {
  Table(database, "experiment",
        {{"id", "INTEGER PRIMARY KEY", ""},
         {"version", "TEXT NOT NULL", ""},
         {"script", "TEXT NOT NULL", ""},
         {"script_hash", "TEXT NOT NULL", ""},
         {"options", "TEXT NOT NULL", ""},
         {"files", "TEXT NOT NULL", ""},
         {"description", "TEXT NOT NULL", ""}})
      .add({std::int64_t{1}, manifest.version, manifest.script, manifest.script_hash, manifest.options,
            Json(manifest.files).dump(), manifest.experiment});
  Table problems(database, "problem",
                 {{"id", "INTEGER PRIMARY KEY", ""},
                  {"experiment", "INTEGER NOT NULL REFERENCES experiment", ""},
                  {"world", "TEXT", ""},
                  {"description", "TEXT NOT NULL", ""},
                  {"name", "TEXT NOT NULL UNIQUE", "/name"},
                  {"space", "TEXT NOT NULL", "/space"},
                  {"dimension", "INTEGER NOT NULL", "/dimension"},
                  {"resolution", "REAL NOT NULL", "/resolution"},
                  {"collision", "TEXT NOT NULL", "/collision"}});
  std::int64_t id = 0;
  for (const Json& problem : experiment.at("problems")) {
    const auto world = manifest.worlds.find(problem.at("name").get<std::string>());
    problems.add(
        {++id, std::int64_t{1}, world == manifest.worlds.end() ? Value() : Value(world->second), problem.dump()},
        problem);
  }
  Table strategies(database, "strategy",
                   {{"id", "INTEGER PRIMARY KEY", ""},
                    {"experiment", "INTEGER NOT NULL REFERENCES experiment", ""},
                    {"name", "TEXT NOT NULL UNIQUE", "/name"},
                    {"text", "TEXT NOT NULL", "/text"},
                    {"hash", "TEXT NOT NULL", "/hash"},
                    {"spec", "TEXT NOT NULL", "/spec"}});
  id = 0;
  for (const Json& strategy : experiment.at("strategies")) strategies.add({++id, std::int64_t{1}}, strategy);
}

std::vector<Column> run_columns() {
  std::vector<Column> columns = {{"id", "INTEGER PRIMARY KEY", ""},
                                 {"problem", "INTEGER NOT NULL REFERENCES problem", ""},
                                 {"strategy", "INTEGER NOT NULL REFERENCES strategy", ""},
                                 {"record", "TEXT NOT NULL", ""},
                                 {"seed", "INTEGER NOT NULL", "/seed"},
                                 {"status", "TEXT NOT NULL", "/status"},
                                 {"solved", "INTEGER NOT NULL", "/solved"},
                                 {"certified", "INTEGER NOT NULL", "/certified"}};
  for (const RunQuantity& quantity : run_quantities()) {
    const bool real = std::holds_alternative<double RunTotals::*>(quantity.field);
    columns.push_back({quantity.key, real ? "REAL" : "INTEGER NOT NULL", fmt::format("/{}", quantity.key)});
  }
  return columns;
}

std::vector<Column> level_columns() {
  return {
      {"run", "INTEGER NOT NULL REFERENCES run", ""},
      {"level", "INTEGER NOT NULL", "/level"},
      {"parent", "INTEGER", "/parent"},
      {"depth", "INTEGER NOT NULL", "/depth"},
      {"key", "TEXT NOT NULL", "/key"},
      {"name", "TEXT NOT NULL", "/name"},
      {"space", "TEXT NOT NULL", "/space"},
      {"dimension", "INTEGER NOT NULL", "/dimension"},
      {"planner", "TEXT NOT NULL", "/planner"},
      {"solves", "INTEGER NOT NULL", "/solves"},
      {"proposals", "INTEGER NOT NULL", "/proposals"},
      {"accepted", "INTEGER NOT NULL", "/accepted"},
      {"nodes", "INTEGER NOT NULL", "/nodes"},
      {"validity_checks", "INTEGER NOT NULL", "/validity_checks"},
      {"motion_checks", "INTEGER NOT NULL", "/motion_checks"},
      {"time_s", "REAL", "/time_s"},
      {"status", "TEXT NOT NULL", "/status"},
      {"solved", "INTEGER NOT NULL", "/solved"},
      {"tree_SE", "REAL", "/measure/tree/self/SE"},
      {"tree_above_uniform", "REAL", "/measure/tree/self/above_uniform"},
      {"expansion_SE", "REAL", "/measure/expansion/self/SE"},
      {"expansion_above_uniform", "REAL", "/measure/expansion/self/above_uniform"},
      {"root_tree_SE", "REAL", "/measure/root/tree/self/SE", "/measure/tree/self/SE"},
      {"root_tree_above_uniform", "REAL", "/measure/root/tree/self/above_uniform", "/measure/tree/self/above_uniform"},
      {"root_expansion_SE", "REAL", "/measure/root/expansion/self/SE", "/measure/expansion/self/SE"},
      {"root_expansion_above_uniform", "REAL", "/measure/root/expansion/self/above_uniform",
       "/measure/expansion/self/above_uniform"},
      {"tree_coverage", "REAL", "/measure/tree/self/coverage"}};
}

void write_runs(const Database& database, const Json& experiment, const StoredRuns& records) {
  Table runs(database, "run", run_columns(), ", UNIQUE (problem, strategy, seed)");
  Table levels(database, "level", level_columns(), ", PRIMARY KEY (run, level)");
  for_each_entry(experiment, records, [&](const Entry& entry) {
    runs.add({entry.id, entry.problem, entry.strategy, *entry.line}, entry.run);
    for (const Json& level : entry.run.at("levels")) levels.add({entry.id}, level);
  });
}

// The tables of Planner Arena: those that OMPL's ompl_benchmark_statistics.py writes ----------------------------------

/// OMPL's PlannerStatus, by value.
constexpr std::array<const char*, 10> ompl_status = {"Unknown status", "Invalid start",
                                                     "Invalid goal",   "Unrecognized goal type",
                                                     "Timeout",        "Approximate solution",
                                                     "Exact solution", "Crash",
                                                     "Abort",          "Infeasible"};

std::int64_t ompl_status_of(const std::string& status) {
  static const std::map<std::string_view, std::string_view> ompl_names = {{"solved", "Exact solution"},
                                                                          {"budget_spent", "Timeout"},
                                                                          {"no_path", "Infeasible"},
                                                                          {"invalid_start", "Invalid start"},
                                                                          {"invalid_goal", "Invalid goal"}};
  const auto name = ompl_names.find(status);
  const auto* const at =
      std::find(ompl_status.begin(), ompl_status.end(), name == ompl_names.end() ? "Unknown status" : name->second);
  return at - ompl_status.begin();
}

/// The order of the first columns is fixed: Planner Arena takes all after the twelfth as parameters of the problems.
void write_arena_inputs(const Database& database, const Manifest& manifest, const Json& experiment,
                        const std::vector<double>& seconds) {
  Table experiments(database, "experiments",
                    {{"id", "INTEGER PRIMARY KEY AUTOINCREMENT", ""},
                     {"name", "VARCHAR(512)", ""},
                     {"totaltime", "REAL", ""},
                     {"timelimit", "REAL", ""},
                     {"memorylimit", "REAL", ""},
                     {"runcount", "INTEGER", ""},
                     {"version", "VARCHAR(128)", ""},
                     {"hostname", "VARCHAR(1024)", ""},
                     {"cpuinfo", "TEXT", ""},
                     {"date", "DATETIME", ""},
                     {"seed", "INTEGER", ""},
                     {"setup", "TEXT", ""}});
  const Json& problems = experiment.at("problems");
  const Json& seeds = experiment.at("seeds");
  for (std::size_t i = 0; i < problems.size(); ++i) {
    experiments.add({static_cast<std::int64_t>(i) + 1,
                     problems[i].at("name").get<std::string>(),
                     seconds[i],
                     {},
                     {},
                     static_cast<std::int64_t>(seeds.size()),
                     "Trellis " + manifest.version,
                     "",
                     "",
                     "",
                     seeds.front().get<std::int64_t>(),
                     problems[i].dump()});
  }
  Table planners(database, "plannerConfigs",
                 {{"id", "INTEGER PRIMARY KEY AUTOINCREMENT", ""},
                  {"name", "VARCHAR(512) NOT NULL", "/name"},
                  {"settings", "TEXT", "/text"}});
  std::int64_t id = 0;
  for (const Json& strategy : experiment.at("strategies")) planners.add({++id}, strategy);
  Table enums(database, "enums", {{"name", "VARCHAR(512)", ""}, {"value", "INTEGER", ""}, {"description", "TEXT", ""}},
              ", PRIMARY KEY (name, value)");
  for (std::size_t i = 0; i < ompl_status.size(); ++i) {
    enums.add({"status", static_cast<std::int64_t>(i), ompl_status[i]});
  }
}

std::vector<Column> arena_run_columns() {
  return {{"id", "INTEGER PRIMARY KEY AUTOINCREMENT", ""},
          {"experimentid", "INTEGER", ""},
          {"plannerid", "INTEGER", ""},
          {"status", "ENUM", ""},
          {"time", "REAL", "/time_s"},
          {"cpu_time", "REAL", "/cpu_s"},
          {"solved", "BOOLEAN", "/solved"},
          {"correct_solution", "BOOLEAN", "/solved"},
          {"solution_length", "REAL", "/length"},
          {"validity_checks", "INTEGER", "/validity_checks"},
          {"motion_checks", "INTEGER", "/motion_checks"},
          {"iterations", "INTEGER", "/levels/0/proposals"},
          {"graph_states", "INTEGER", "/levels/0/nodes"},
          {"tree_above_uniform", "REAL", "/levels/0/measure/tree/self/above_uniform"},
          {"expansion_above_uniform", "REAL", "/levels/0/measure/expansion/self/above_uniform"},
          {"tree_coverage", "REAL", "/levels/0/measure/tree/self/coverage"},
          {"seed", "INTEGER", "/seed"}};
}

void write_arena(const Database& database, const Manifest& manifest, const Json& experiment,
                 const StoredRuns& records) {
  std::vector<double> seconds(experiment.at("problems").size(), 0.0);
  for_each_entry(experiment, records, [&](const Entry& entry) {
    seconds[static_cast<std::size_t>(entry.problem) - 1] += entry.run.at("time_s").get<double>();
  });
  write_arena_inputs(database, manifest, experiment, seconds);
  Table runs(database, "runs", arena_run_columns(),
             ", FOREIGN KEY (experimentid) REFERENCES experiments(id) ON DELETE CASCADE"
             ", FOREIGN KEY (plannerid) REFERENCES plannerConfigs(id) ON DELETE CASCADE");
  Table progress(database, "progress",
                 {{"runid", "INTEGER", ""},
                  {"time", "REAL", "/cpu_s"},
                  {"best_cost", "REAL", "/length"},
                  {"validity_checks", "INTEGER", "/checks"}},
                 ", PRIMARY KEY (runid, time), FOREIGN KEY (runid) REFERENCES runs(id) ON DELETE CASCADE");
  for_each_entry(experiment, records, [&](const Entry& entry) {
    runs.add({entry.id, entry.problem, entry.strategy, ompl_status_of(entry.run.at("status").get<std::string>())},
             entry.run);
    for (const Json& one : entry.run.at("improvements")) progress.add({entry.id}, one);
  });
}

/// A file beside the final one, removed unless published.
class Draft {
 public:
  explicit Draft(std::string path) : path_(std::move(path)), draft_(fmt::format("{}.part-{}", path_, ::getpid())) {
    ::unlink(draft_.c_str());
  }
  ~Draft() { ::unlink(draft_.c_str()); }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  [[nodiscard]] const std::string& name() const { return draft_; }
  /// Syncs the file and gives it its name.
  void publish() const {
    const int file = ::open(draft_.c_str(), O_RDWR | O_CLOEXEC);
    const bool synced = file >= 0 && (::fsync(file) == 0 || errno == EINVAL);
    const int reason = errno;
    if (file >= 0) ::close(file);
    if (!synced) fail(reason);
    if (::rename(draft_.c_str(), path_.c_str()) != 0) fail(errno);
  }

 private:
  [[noreturn]] void fail(int reason) const {
    throw Error(fmt::format("cannot write '{}': {}", path_, std::strerror(reason)));  // NOLINT(concurrency-mt-unsafe)
  }
  std::string path_;
  std::string draft_;
};

// PDT -----------------------------------------------------------------------------------------------------------------

std::string number(double x) { return std::isinf(x) ? "inf" : fmt::format("{}", x); }

/// The cost of a run over time, as steps. PDT interpolates between points, so each step has a point before it.
std::string pdt_lines(const Json& run, double end) {
  std::vector<std::pair<double, double>> points;  // time, cost
  double cost = std::numeric_limits<double>::infinity();
  double last = 0.0;
  const auto add = [&](double time, double value) {
    if (time <= last) return;
    points.emplace_back(time, value);
    last = time;
  };
  for (const Json& one : run.at("improvements")) {
    const double time = one.at("cpu_s").get<double>();
    add(std::nextafter(time, 0.0), cost);
    const bool solved = run.at("solved").get<bool>() && !one.at("length").is_null();
    if (solved) cost = one.at("length").get<double>();
    if (solved && time <= last && !points.empty()) points.back().second = cost;
    add(time, cost);
  }
  add(std::nextafter(end, 0.0), cost);
  add(end, cost);
  std::string times = csv_text(run.at("strategy").get<std::string>());
  std::string costs = times;
  for (const auto& [time, value] : points) {
    times += ", " + number(time);
    costs += ", " + number(value);
  }
  return times + '\n' + costs + '\n';
}

}  // namespace

void require_replaceable_database(const std::string& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return;
  const Database existing(path, Database::Mode::read, names);
  if (existing.ask("PRAGMA application_id") == application) return;
  throw Error(fmt::format("--sqlite: '{}' is a database that trellis merge did not write; it is left as it is", path));
}

void write_database(const std::string& path, const Manifest& manifest, const StoredRuns& records) {
  const InterruptibleRun interruptible;  // else a signal leaves the draft
  const Draft draft(path);
  {
    const Json experiment = Json::parse(manifest.experiment);
    const Database database(draft.name(), Database::Mode::create, names);
    database.together("BEGIN", [&] {
      database.run(
          fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", application, version_of_tables).c_str());
      write_inputs(database, manifest, experiment);
      write_runs(database, experiment, records);
      write_arena(database, manifest, experiment, records);
    });
  }
  draft.publish();
}

void write_pdt(const std::string& folder, const Manifest& manifest, const StoredRuns& records) {
  const Json experiment = Json::parse(manifest.experiment);
  const std::size_t problems = experiment.at("problems").size();
  // The files cover the same time for all runs: PDT does not extrapolate.
  std::vector<double> ends(problems, 0.0);
  for_each_entry(experiment, records, [&](const Entry& entry) {
    double& end = ends[static_cast<std::size_t>(entry.problem) - 1];
    end = std::max({end, entry.run.at("time_s").get<double>(), entry.run.at("cpu_s").get<double>()});
    for (const Json& one : entry.run.at("improvements")) end = std::max(end, one.at("cpu_s").get<double>());
  });
  // The runs come problem by problem.
  Directories files;
  std::unique_ptr<FileWriter> file;
  std::size_t current = 0;
  const auto publish = [&] {
    if (file) file->publish();
    file.reset();
  };
  for_each_entry(experiment, records, [&](const Entry& entry) {
    const std::size_t problem = static_cast<std::size_t>(entry.problem) - 1;
    if (!file || problem != current) {
      publish();
      const std::string name = files(experiment.at("problems")[problem].at("name").get<std::string>());
      file = std::make_unique<FileWriter>((fs::path(folder) / (name + ".csv")).string());
      current = problem;
    }
    file->write(pdt_lines(entry.run, ends[problem]));
  });
  publish();
}

}  // namespace trellis::command
