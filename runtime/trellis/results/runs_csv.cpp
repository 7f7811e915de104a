// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of an experiment as one table, from their entries in the JSON document.
#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include <trellis/results/csv.hpp>
#include <trellis/results/quantities.hpp>
#include <trellis/results/records.hpp>

namespace trellis {

namespace {

using Json = nlohmann::json;

struct Column {
  const char* name;
  const char* place;  ///< a JSON pointer into the entry of a run
};

/// Those before the quantities of a run, and after them.
constexpr std::array first_columns = {
    Column{"problem", "/problem"}, Column{"strategy", "/strategy"}, Column{"seed", "/seed"},
    Column{"status", "/status"},   Column{"solved", "/solved"},
};
constexpr std::array last_columns = {
    Column{"makespan", "/times/makespan"},
    Column{"sum_of_costs", "/times/sum_of_costs"},
    Column{"first_length", "/improvements/0/length"},
    Column{"first_checks", "/improvements/0/checks"},
    Column{"first_cpu_s", "/improvements/0/cpu_s"},
    Column{"certified", "/certified"},
    Column{"won", "/bounded_loss/won"},
    Column{"proposals", "/levels/0/proposals"},
    Column{"accepted", "/levels/0/accepted"},
    Column{"nodes", "/levels/0/nodes"},
};

/// Calls `visit` with the name and the place of each column.
template <class Visit>
void each_column(const Visit& visit) {
  for (const Column& column : first_columns) visit(std::string(column.name), std::string(column.place));
  for (const RunQuantity& quantity : run_quantities()) visit(quantity.key, fmt::format("/{}", quantity.key));
  for (const Column& column : last_columns) visit(std::string(column.name), std::string(column.place));
  for (const char* role : {"tree", "expansion"}) {
    for (const MeasureQuantity& quantity : measure_quantities) {
      const std::string group = *quantity.group == '\0' ? "" : fmt::format("/{}", quantity.group);
      if (!quantity.in_table) continue;
      visit(fmt::format("{}_{}", role, quantity.name()),
            fmt::format("/levels/0/measure/{}/self{}/{}", role, group, quantity.key));
    }
  }
}

std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (value.is_string()) return csv_text(value.get<std::string>());
  return value.dump();
}

}  // namespace

std::string runs_csv_header() {
  std::string text;
  each_column([&](const std::string& name, const std::string&) { text += name + ','; });
  return text + "levels,resolves\n";
}

std::string runs_csv_row(const std::string& line) {
  const Json run = Json::parse(line);
  std::string text;
  each_column([&](const std::string&, const std::string& place) {
    const Json::json_pointer pointer(place);
    if (run.contains(pointer)) text += cell(run.at(pointer));
    text += ',';
  });
  std::uint64_t resolves = 0;
  for (const Json& level : run.at("levels")) {
    const auto solves = level.at("solves").get<std::uint64_t>();
    resolves += solves > 0 ? solves - 1 : 0;
  }
  return text + std::to_string(run.at("levels").size()) + ',' + std::to_string(resolves) + '\n';
}

std::string runs_csv(const ExperimentFacts& experiment) {
  std::string text = runs_csv_header();
  for (const RunFacts& run : experiment.runs) text += runs_csv_row(run_line(run));
  return text;
}

}  // namespace trellis
