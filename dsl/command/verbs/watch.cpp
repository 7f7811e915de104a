// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/verbs/watch.hpp>

#include <algorithm>
#include <chrono>
#include <system_error>
#include <thread>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/core/tokens.hpp>
#include <dsl/language/words/modules.hpp>
#include <trellis/base/error.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;

/// The names in `require "a"` and `require("a")`.
std::vector<std::string> required_names(const std::string& text) {
  std::vector<std::string> names;
  const auto all = dsl::tokens(text);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].text != "require") continue;
    const std::size_t argument = i + 1 < all.size() && all[i + 1].text == "(" ? i + 2 : i + 1;
    if (argument >= all.size() || all[argument].kind != dsl::Token::Kind::string) continue;
    const std::string_view quoted = all[argument].text;
    if (quoted.size() > 2 && quoted.front() != '[') names.emplace_back(quoted.substr(1, quoted.size() - 2));
  }
  return names;
}

}  // namespace

WatchedFiles::WatchedFiles(const std::string& script) { add(script, fs::path(script).parent_path()); }

std::optional<WatchedFiles::Stamp> WatchedFiles::stamp(const std::string& file) {
  std::error_code missing;
  Stamp stamp;
  stamp.time = fs::last_write_time(file, missing);
  if (missing) return {};
  stamp.size = fs::file_size(file, missing);
  return missing ? std::nullopt : std::optional(stamp);
}

void WatchedFiles::add(const std::string& file, const fs::path& folder) {
  if (std::find(names_.begin(), names_.end(), file) != names_.end()) return;
  names_.push_back(file);
  stamps_.push_back(stamp(file));
  std::string text;
  try {
    text = dsl::read_file(file);
  } catch (const Error&) {
    return;  // it may come to be there
  }
  const auto standard = dsl::module_names();
  for (std::string name : required_names(text)) {
    if (std::find(standard.begin(), standard.end(), name) != standard.end()) continue;
    std::replace(name.begin(), name.end(), '.', '/');
    add((folder / (name + ".lua")).lexically_normal().string(), folder);
  }
}

std::string WatchedFiles::wait() const {
  constexpr auto interval = std::chrono::milliseconds(200);
  while (true) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (stamp(names_[i]) != stamps_[i]) return names_[i];
    }
    std::this_thread::sleep_for(interval);
  }
}

}  // namespace trellis::command
