// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/results/directories.hpp>

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// Converts a name to a directory name: letters, digits and other characters that are safe in shells and file systems;
/// everything else becomes '-'.
std::string safe(const std::string& name) {
  std::string out = name;
  for (auto& c : out) {
    const auto byte = static_cast<unsigned char>(c);
    const bool keep = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z') ||
                      byte >= 0x80 || std::string_view("._+=@,()-").find(c) != std::string_view::npos;
    if (!keep) c = '-';
  }
  if (out.empty()) return "-";
  if (out.front() == '.') out.front() = '-';  // neither ".." nor hidden
  return out;
}

}  // namespace

const std::string& Directories::operator()(const std::string& name) {
  const auto known = names_.find(name);
  if (known != names_.end()) return known->second;
  std::string directory = safe(name);
  for (int k = 2; !taken_.insert(directory).second; ++k) directory = fmt::format("{}-{}", safe(name), k);
  return names_.emplace(name, std::move(directory)).first->second;
}

void make_directory(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw Error(fmt::format("cannot make the directory '{}': {}", path, error.message()));
}

}  // namespace trellis
