// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace trellis::command {

/// A script and the modules that it requires, with their times of writing.
class WatchedFiles {
 public:
  explicit WatchedFiles(const std::string& script);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Returns the name of the first file that differs from what it was at construction, once one does.
  [[nodiscard]] std::string wait() const;

 private:
  struct Stamp {
    std::filesystem::file_time_type time;
    std::uintmax_t size = 0;
    friend bool operator==(const Stamp&, const Stamp&) = default;
  };
  /// None for a file that is not there.
  static std::optional<Stamp> stamp(const std::string& file);
  void add(const std::string& file, const std::filesystem::path& folder);

  std::vector<std::string> names_;
  std::vector<std::optional<Stamp>> stamps_;
};

}  // namespace trellis::command
