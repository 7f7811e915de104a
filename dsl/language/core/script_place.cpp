// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/script_place.hpp>

#include <algorithm>
#include <filesystem>

namespace trellis::dsl {

bool lies_within(const std::string& file, const std::vector<std::string>& folders) {
  namespace fs = std::filesystem;
  const auto stays = [](const fs::path& relative) { return !relative.empty() && *relative.begin() != ".."; };
  const fs::path path = fs::path(file).lexically_normal();
  if (!path.is_absolute()) return stays(path);
  return std::any_of(folders.begin(), folders.end(), [&](const std::string& folder) {
    std::error_code error;
    return stays(path.lexically_relative(fs::absolute(folder.empty() ? "." : folder, error).lexically_normal()));
  });
}

}  // namespace trellis::dsl
