// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of an experiment as one table, from their entries in the JSON document.
#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include <trellis/experiment/experiment.hpp>
#include <trellis/report/csv.hpp>
#include <trellis/report/records.hpp>

namespace trellis {

namespace {

using Json = nlohmann::json;

struct Column {
  const char* name;
  const char* place;  ///< a JSON pointer into the entry of a run
};

constexpr std::array columns = {
    Column{"problem", "/problem"},
    Column{"strategy", "/strategy"},
    Column{"seed", "/seed"},
    Column{"status", "/status"},
    Column{"solved", "/solved"},
    Column{"validity_checks", "/validity_checks"},
    Column{"motion_checks", "/motion_checks"},
    Column{"improvement_checks", "/improvement_checks"},
    Column{"shortcut_checks", "/shortcut_checks"},
    Column{"path_checks", "/path_checks"},
    Column{"work", "/work"},
    Column{"set_up_work", "/set_up_work"},
    Column{"time_s", "/time_s"},
    Column{"cpu_s", "/cpu_s"},
    Column{"lua_s", "/lua_s"},
    Column{"set_up_s", "/set_up_s"},
    Column{"path_cpu_s", "/path_cpu_s"},
    Column{"length", "/length"},
    Column{"makespan", "/times/makespan"},
    Column{"sum_of_costs", "/times/sum_of_costs"},
    Column{"first_length", "/improvements/0/length"},
    Column{"first_checks", "/improvements/0/checks"},
    Column{"first_cpu_s", "/improvements/0/cpu_s"},
    Column{"certified", "/certified"},
    Column{"clearance", "/clearance"},
    Column{"refuted_paths", "/refuted_paths"},
    Column{"won", "/bounded_loss/won"},
    Column{"proposals", "/levels/0/proposals"},
    Column{"accepted", "/levels/0/accepted"},
    Column{"nodes", "/levels/0/nodes"},
    Column{"tree_D_eps", "/levels/0/efficiency/tree/value"},
    Column{"tree_D_eps_lo", "/levels/0/measure/tree/self/D_eps_lo"},
    Column{"tree_D_eps_hi", "/levels/0/measure/tree/self/D_eps_hi"},
    Column{"tree_mass", "/levels/0/measure/tree/self/D_eps_parts/mass"},
    Column{"tree_uniform", "/levels/0/efficiency/tree/uniform"},
    Column{"tree_coverage", "/levels/0/efficiency/tree/coverage"},
    Column{"expansion_D_eps", "/levels/0/efficiency/expansion/value"},
    Column{"expansion_D_eps_lo", "/levels/0/measure/expansion/self/D_eps_lo"},
    Column{"expansion_D_eps_hi", "/levels/0/measure/expansion/self/D_eps_hi"},
    Column{"expansion_mass", "/levels/0/measure/expansion/self/D_eps_parts/mass"},
    Column{"expansion_uniform", "/levels/0/efficiency/expansion/uniform"},
    Column{"expansion_coverage", "/levels/0/efficiency/expansion/coverage"},
};

std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (value.is_string()) return csv_text(value.get<std::string>());
  return value.dump();
}

}  // namespace

std::string runs_csv_header() {
  std::string text;
  for (const Column& column : columns) text += std::string(column.name) + ',';
  return text + "levels,resolves\n";
}

std::string runs_csv_row(const std::string& line) {
  const Json run = Json::parse(line);
  std::string text;
  for (const Column& column : columns) {
    const Json::json_pointer place(column.place);
    if (run.contains(place)) text += cell(run.at(place));
    text += ',';
  }
  std::uint64_t resolves = 0;
  for (const Json& level : run.at("levels")) {
    const auto solves = level.at("solves").get<std::uint64_t>();
    resolves += solves > 0 ? solves - 1 : 0;
  }
  return text + std::to_string(run.at("levels").size()) + ',' + std::to_string(resolves) + '\n';
}

std::string runs_csv(const ExperimentResult& result) {
  std::string text = runs_csv_header();
  for (const RunResult& run : result.runs) text += runs_csv_row(run_line(run));
  return text;
}

}  // namespace trellis
