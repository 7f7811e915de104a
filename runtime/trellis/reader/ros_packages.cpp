// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/ros_packages.hpp>

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

namespace trellis {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view package_scheme = "package://";
constexpr std::size_t most_above = 4;  // folders above that of the file, whose other files count as beside it

bool is_file(const fs::path& path) {
  std::error_code fault;
  return fs::is_regular_file(path, fault);
}

bool is_folder(const fs::path& path) {
  std::error_code fault;
  return fs::is_directory(path, fault);
}

/// The name and the path of `package://NAME/PATH`; none of another URI.
std::optional<std::pair<std::string, std::string>> package_and_path(const std::string& uri) {
  if (!uri.starts_with(package_scheme)) return std::nullopt;
  std::string rest = uri.substr(package_scheme.size());
  rest.erase(0, rest.find_first_not_of('/'));  // of package:///NAME/PATH
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos) return std::pair(rest, std::string());
  return std::pair(rest.substr(0, slash), rest.substr(slash + 1));
}

/// The name of a package by the package.xml in its folder, "" without one.
std::string package_name(const fs::path& folder) {
  constexpr std::uintmax_t largest = std::uintmax_t{1} << 20U;
  const fs::path file = folder / "package.xml";
  std::error_code fault;
  if (!is_file(file) || fs::file_size(file, fault) > largest || fault) return "";
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) return "";
  const tinyxml2::XMLElement* package = document.FirstChildElement("package");
  const tinyxml2::XMLElement* name = package != nullptr ? package->FirstChildElement("name") : nullptr;
  const std::string_view text = name != nullptr && name->GetText() != nullptr ? name->GetText() : "";
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blanks);
  return begin == std::string_view::npos ? ""
                                         : std::string(text.substr(begin, text.find_last_not_of(blanks) + 1 - begin));
}

/// The folders in an environment variable, between colons.
std::vector<fs::path> folders_in(const char* variable) {
  std::vector<fs::path> folders;
  const char* value = std::getenv(variable);
  std::string_view rest = value != nullptr ? value : "";
  while (!rest.empty()) {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    if (colon > 0) folders.emplace_back(rest.substr(0, colon));
    rest.remove_prefix(std::min(colon + 1, rest.size()));
  }
  return folders;
}

/// Adds a package in a folder or below, as rospack looks for it: in folders within folders up to the first package.
/// \param left  folders that may still be examined
void add_below(const fs::path& folder, const std::string& package, int depth, std::size_t& left,
               std::vector<fs::path>& found) {
  if (left == 0 || !is_folder(folder)) return;
  --left;
  const std::string name = package_name(folder);
  if (name == package || (name.empty() && folder.filename() == package)) found.push_back(folder);
  if (!name.empty() || depth == 0) return;
  std::vector<fs::path> inside;
  std::error_code fault;
  for (fs::directory_iterator at(folder, fs::directory_options::skip_permission_denied, fault), end;
       !fault && at != end; at.increment(fault)) {
    if (!at->path().filename().string().starts_with('.') && is_folder(at->path())) inside.push_back(at->path());
  }
  std::sort(inside.begin(), inside.end());
  for (const fs::path& one : inside) add_below(one, package, depth - 1, left, found);
}

}  // namespace

RosPackages::RosPackages(const std::string& file, std::map<std::string, std::string> given) : given_(std::move(given)) {
  std::error_code fault;
  fs::path folder = fs::absolute(fs::path(file), fault).lexically_normal().parent_path();
  while (!folder.empty()) {
    above_.push_back(folder);
    if (folder == folder.parent_path()) break;
    folder = folder.parent_path();
  }
}

RosPackages::Folders RosPackages::folders_of(const std::string& package) const {
  if (const auto known = found_.find(package); known != found_.end()) return known->second;
  Folders folders;
  if (const auto known = given_.find(package); known != given_.end()) {
    folders.emplace_back(known->second);
  } else if (!package.empty() && package != "." && package != "..") {
    for (const fs::path& folder : above_) {
      if (folder.filename() == package || package_name(folder) == package) folders.push_back(folder);
    }
    for (std::size_t i = 0; i < std::min(above_.size(), most_above + 1); ++i) {
      if (is_folder(above_[i] / package)) folders.push_back(above_[i] / package);
    }
    constexpr int deepest = 4;
    std::size_t left = 20'000;
    for (const fs::path& folder : folders_in("ROS_PACKAGE_PATH")) add_below(folder, package, deepest, left, folders);
    for (const fs::path& prefix : folders_in("AMENT_PREFIX_PATH")) {
      if (is_folder(prefix / "share" / package)) folders.push_back(prefix / "share" / package);
    }
  }
  found_.emplace(package, folders);
  return folders;
}

std::optional<std::string> RosPackages::find(const std::string& uri) const {
  if (const auto parts = package_and_path(uri)) {
    for (const fs::path& folder : folders_of(parts->first)) {
      const fs::path at = folder / parts->second;
      if (is_file(at)) return at.lexically_normal().string();
    }
    return std::nullopt;
  }
  constexpr std::string_view file_scheme = "file://";
  const fs::path path(uri.starts_with(file_scheme) ? uri.substr(file_scheme.size()) : uri);
  if (path.is_absolute()) return is_file(path) ? std::optional(path.string()) : std::nullopt;
  for (std::size_t i = 0; i < std::min(above_.size(), most_above + 1); ++i) {
    const fs::path at = above_[i] / path;
    if (is_file(at)) return at.lexically_normal().string();
  }
  return std::nullopt;
}

std::string RosPackages::advice(const std::string& uri) const {
  const auto parts = package_and_path(uri);
  if (!parts) {
    return fmt::format("files without a package are beside the URDF file or in one of the {} folders above",
                       most_above);
  }
  const std::string& package = parts->first;
  const std::string& path = parts->second;
  const auto option = [&](const std::string& folder) {
    const bool plain = std::all_of(package.begin(), package.end(), [](unsigned char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    });
    return fmt::format("packages = {{ {} = \"{}\" }}", plain ? package : fmt::format("[\"{}\"]", package), folder);
  };
  if (const Folders folders = folders_of(package); !folders.empty()) {
    return fmt::format("package '{}' is {}, which lacks the file; {} names another folder", package,
                       folders.front().string(), option("FOLDER"));
  }
  std::string text = fmt::format(
      "package '{}' is no folder above or beside the file, and not in ROS_PACKAGE_PATH or AMENT_PREFIX_PATH; {} names "
      "its folder",
      package, option("FOLDER"));
  for (std::size_t i = 0; i < std::min(above_.size(), most_above + 1); ++i) {
    if (!is_file(above_[i] / path)) continue;
    text += fmt::format("; if {} is the file, write {}", (above_[i] / path).string(), option(above_[i].string()));
    break;
  }
  return text;
}

}  // namespace trellis
