// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/stored_samples.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/input_file.hpp>

namespace trellis {

namespace {

std::string read_whole(const std::string& path) {
  InputFile file(path, std::numeric_limits<std::uintmax_t>::max());
  std::string text = file.rest();
  if (!file.fault().empty()) throw Error(fmt::format("cannot read '{}': {}", path, file.fault()));
  return text;
}

}  // namespace

StoredSamples::StoredSamples(std::string folder, const ExperimentFacts& facts)
    : folder_(std::move(folder)), files_(facts.runs.size()) {
  using Json = nlohmann::ordered_json;
  const std::string path = (std::filesystem::path(folder_) / "index.json").string();
  const std::string text = read_whole(path);
  try {
    const Json index = Json::parse(text);
    robots_ = index.at("robots").dump();
    std::map<std::tuple<std::string, std::string, std::string>, std::string> files;
    for (const Json& run : index.at("runs")) {
      files[{run.at("problem").get<std::string>(), run.at("strategy").get<std::string>(),
             run.at("seed").get<std::string>()}] = run.at("file").get<std::string>();
    }
    for (std::size_t i = 0; i < facts.runs.size(); ++i) {
      const RunFacts& run = facts.runs[i];
      const auto file = files.find({run.problem, run.strategy, std::to_string(run.seed)});
      if (file != files.end()) files_[i] = file->second;
    }
  } catch (const Json::exception&) {
    throw Error(fmt::format("{}: this is no index of samples that `trellis run --samples` writes", path));
  }
}

std::string StoredSamples::run(std::size_t run) {
  using Json = nlohmann::ordered_json;
  if (files_.at(run).empty()) return "";
  const std::string path = (std::filesystem::path(folder_) / files_[run]).string();
  std::string text = read_whole(path);
  // The page has the text as it is.
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("path") || !json.value("levels", Json()).is_array() ||
      !json.value("turns", Json()).is_array()) {
    throw Error(fmt::format("{}: these are no samples that `trellis run --samples` writes", path));
  }
  return text;
}

}  // namespace trellis
