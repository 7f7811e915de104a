// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <trellis/report/report.hpp>
#include "support/catch.hpp"

namespace trellis::test {

/// Compares with tests/golden/NAME; TRELLIS_UPDATE_GOLDEN=1 rewrites it instead.
inline void check_golden(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(__FILE__).parent_path().parent_path() / "golden" / name;
  const char* update = std::getenv("TRELLIS_UPDATE_GOLDEN");
  if (update != nullptr && std::string(update) == "1") write_file(path.string(), text);
  std::ifstream file(path);
  INFO("golden file " << path);
  REQUIRE(file);
  std::ostringstream golden;
  golden << file.rdbuf();
  CHECK(text == golden.str());
}

}  // namespace trellis::test
