// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/stored_paths.hpp>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

using Json = nlohmann::json;

Configurations rows(const Json& array) {
  Configurations result(array.empty() ? 0 : array.front().size());
  Configuration row;
  for (const Json& entry : array) {
    row = entry.get<Configuration>();
    if (row.size() != result.dimension()) throw Error("configurations of a path have different dimensions");
    result.push(row);
  }
  return result;
}

}  // namespace

StoredPaths read_stored_paths(const std::string& document, const std::string& file) {
  try {
    const Json json = Json::parse(document);
    StoredPaths result;
    result.script = json.at("script").get<std::string>();
    for (const Json& entry : json.at("runs")) {
      if (!entry.at("solved").get<bool>()) {
        ++result.unsolved;
        continue;
      }
      StoredRunPath run;
      run.problem = entry.at("problem").get<std::string>();
      run.strategy = entry.at("strategy").get<std::string>();
      run.seed = entry.at("seed").get<std::uint64_t>();
      run.path = rows(entry.at("path"));
      if (const auto driven = entry.find("trajectory"); driven != entry.end()) {
        run.trajectory.dt = driven->at("dt").get<double>();
        run.trajectory.steps = driven->at("steps").get<std::vector<std::uint32_t>>();
        run.trajectory.controls = rows(driven->at("controls"));
        if (run.trajectory.controls.size() != run.trajectory.steps.size()) {
          throw Error("a trajectory has another number of controls than of steps");
        }
      }
      result.paths.push_back(std::move(run));
    }
    return result;
  } catch (const Json::exception&) {
    throw Error(fmt::format("{}: this is no document that trellis run --json writes", file));
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", file, error.what()));
  }
}

}  // namespace trellis
