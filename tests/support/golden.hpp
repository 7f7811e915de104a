// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/catch.hpp"

namespace trellis::test {

inline std::filesystem::path golden_folder() {
  return std::filesystem::path(__FILE__).parent_path().parent_path() / "golden";
}

/// TRELLIS_UPDATE_GOLDEN=1: tests write the golden files instead of comparing with them. Read them before committing.
inline bool updates_golden() {
  const char* update = std::getenv("TRELLIS_UPDATE_GOLDEN");  // NOLINT(concurrency-mt-unsafe): nothing sets it
  return update != nullptr && std::string(update) == "1";
}

/// Compares with tests/golden/NAME.
inline void check_golden(const std::string& name, const std::string& text) {
  const auto path = golden_folder() / name;
  if (updates_golden()) std::ofstream(path) << text;
  std::ifstream file(path);
  INFO("golden file " << path);
  REQUIRE(file);
  CHECK(text == std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace trellis::test
