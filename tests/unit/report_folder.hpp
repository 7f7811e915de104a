// SPDX-License-Identifier: GPL-3.0-or-later
// Output folders of figures, and checks of their files.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/folder.hpp"

namespace trellis::fixture {

class Folder final : public test::Folder {
 public:
  /// All files below, as paths from here.
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path())) {
      if (entry.is_regular_file()) all.insert(std::filesystem::relative(entry.path(), path()).generic_string());
    }
    return all;
  }
};

using Files = std::set<std::string>;

inline std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

/// What is wrong with an XML document: tags that do not close in turn, a bare '<' or '&'. "" where nothing is.
inline std::string fault(const std::string& xml) {
  std::vector<std::string> open;
  bool any = false;
  for (std::size_t i = 0; i < xml.size();) {
    if (xml[i] == '&') {
      const std::size_t end = xml.find(';', i);
      if (end == std::string::npos || end - i > 10) return "a bare & at " + std::to_string(i);
    }
    if (xml[i] != '<') {
      if (any && open.empty() && std::isspace(static_cast<unsigned char>(xml[i])) == 0) return "text after the root";
      ++i;
      continue;
    }
    const std::size_t end = xml.find('>', i);
    if (end == std::string::npos) return "an unclosed tag at " + std::to_string(i);
    const std::string tag = xml.substr(i + 1, end - i - 1);
    if (tag.find('<') != std::string::npos) return "a bare < at " + std::to_string(i);
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return "an odd quote in <" + tag + ">";
    const std::string name = tag.substr(0, tag.find_first_of(" \t\r\n/"));
    if (tag.starts_with("/")) {
      if (open.empty() || open.back() != tag.substr(1)) return "</" + tag.substr(1) + "> closes nothing";
      open.pop_back();
    } else if (!tag.starts_with("?") && !tag.starts_with("!")) {
      if (any && open.empty()) return "a second root";
      any = true;
      if (!tag.ends_with("/")) open.push_back(name);
    }
    i = end + 1;
  }
  if (!open.empty()) return "<" + open.back() + "> is not closed";
  return any ? "" : "no root";
}

inline void check_pictures(const Folder& folder) {
  for (const std::string& file : folder.files()) {
    CAPTURE(file);
    const std::string content = read(folder.path() / file);
    if (file.ends_with(".svg")) {
      CHECK(fault(content).empty());
      CHECK(content.find("<svg") != std::string::npos);
      CHECK(content.find("nan") == std::string::npos);
    } else if (file.ends_with(".pdf")) {
      CHECK(content.starts_with("%PDF-"));
      CHECK(content.find("%%EOF") != std::string::npos);
    } else if (!file.ends_with(".txt")) {
      CHECK(content.starts_with("\x89PNG\r\n\x1a\n"));
    }
  }
}

}  // namespace trellis::fixture
