// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/stdlib.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <trellis/base/error.hpp>
#include <trellis/base/input_file.hpp>

namespace trellis::dsl {

namespace {

namespace fs = std::filesystem;

/// "" without.
std::string folder() {
  const char* given = std::getenv("TRELLIS_STDLIB");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  return given != nullptr ? given : "";
}

}  // namespace

std::vector<std::string> module_names() {
  std::vector<std::string> names;
  if (folder().empty()) {
    for (const auto& module : embedded_modules()) names.emplace_back(module.name);
  } else {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder(), error)) {
      if (entry.path().extension() == ".lua") names.push_back(entry.path().stem().string());
    }
    if (error) throw Error(fmt::format("cannot read TRELLIS_STDLIB '{}': {}", folder(), error.message()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<std::string> module_path(const std::string& name) {
  if (folder().empty()) return {};
  const fs::path path = fs::path(folder()) / (name + ".lua");
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  return path.string();
}

std::optional<std::string> module_text(const std::string& name) {
  const auto names = module_names();
  if (!std::binary_search(names.begin(), names.end(), name)) return {};
  if (const auto path = module_path(name)) return read_file(*path);
  const auto modules = embedded_modules();
  return std::string(
      std::find_if(modules.begin(), modules.end(), [&](const Module& m) { return m.name == name; })->text);
}

std::string read_file(const std::string& path, std::size_t largest) {
  InputFile file(path, largest);
  std::string text = file.rest();
  if (!file.fault().empty()) throw Error(fmt::format("cannot read '{}': {}", path, file.fault()));
  return text;
}

}  // namespace trellis::dsl
