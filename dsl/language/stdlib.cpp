// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/stdlib.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include <trellis/base/error.hpp>

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
  const auto fail = [&](const std::string& reason) -> void {
    throw Error(fmt::format("cannot read '{}': {}", path, reason));
  };
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) fail("it is a folder");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) fail(std::strerror(errno));  // NOLINT(concurrency-mt-unsafe)
  std::string text;
  std::string block(std::size_t{64} << 10U, '\0');
  while (const std::size_t size = std::fread(block.data(), 1, block.size(), file.get())) {
    text.append(block, 0, size);
    if (text.size() > largest) fail(fmt::format("it is over {} MiB", largest >> 20U));
  }
  if (std::ferror(file.get()) != 0) fail(std::strerror(errno));  // NOLINT(concurrency-mt-unsafe)
  return text;
}

}  // namespace trellis::dsl
