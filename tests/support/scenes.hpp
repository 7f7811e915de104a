// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>

#include "support/catch.hpp"

namespace trellis::test {

/// PATH in the folder of scenes made by others, which the environment's TRELLIS_SCENES names. "" where it is missing,
/// and then the test warns that it was skipped.
inline std::filesystem::path scene(const std::filesystem::path& path = {}) {
  const char* folder = std::getenv("TRELLIS_SCENES");  // NOLINT(concurrency-mt-unsafe): nothing sets it
  const std::filesystem::path found = folder != nullptr && *folder != '\0' ? folder / path : std::filesystem::path();
  if (!found.empty() && std::filesystem::exists(found)) return found;
  WARN("SKIPPED: TRELLIS_SCENES names no folder of scenes with " << (path.empty() ? "files" : path.string()));
  return {};
}

}  // namespace trellis::test
