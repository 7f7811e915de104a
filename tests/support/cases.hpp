// SPDX-License-Identifier: GPL-3.0-or-later
// Many scripts with the message that each must give, in few files: golden/FOLDER/TOPIC.cases. A case is
//
//   ## NAME
//   the script
//   => the message, each of its lines after an arrow
//
// To add one, write its name and script and run the test with TRELLIS_UPDATE_GOLDEN=1, which writes the messages.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/golden.hpp"

namespace trellis::test {

struct Case {
  std::string name;
  std::string script;
  std::string message;
};

/// The cases of one file.
struct CaseFile {
  std::filesystem::path path;
  std::string head;  ///< comments above the first case
  std::vector<Case> cases;

  explicit CaseFile(const std::filesystem::path& file) : path(file) {
    std::ifstream stream(file);
    bool in_message = false;
    for (std::string line; std::getline(stream, line);) {
      if (line.starts_with("## ")) {
        cases.push_back({line.substr(3), "", ""});
        in_message = false;
      } else if (cases.empty()) {
        head += line + "\n";
      } else if (line.starts_with("=>")) {
        cases.back().message += line.substr(std::min<std::size_t>(3, line.size())) + "\n";
        in_message = true;
      } else if (!in_message) {
        cases.back().script += line + "\n";
      } else {
        REQUIRE(line.empty());  // only empty lines between a message and the next case
      }
    }
  }

  void write() const {
    std::ofstream file(path);
    file << head;
    for (const Case& one : cases) {
      file << (&one == cases.data() ? "" : "\n") << "## " << one.name << "\n" << one.script;
      for (std::size_t at = 0, end = 0; at < one.message.size(); at = end + 1) {
        end = one.message.find('\n', at);
        file << (end == at ? "=>" : "=> ") << one.message.substr(at, end - at) << "\n";
      }
    }
  }
};

inline std::vector<CaseFile> case_files(const std::string& folder) {
  std::vector<CaseFile> files;
  for (const auto& entry : std::filesystem::directory_iterator(golden_folder() / folder)) {
    INFO(entry.path());
    REQUIRE(entry.path().extension() == ".cases");
    files.emplace_back(entry);
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return files;
}

/// The message of the case FOLDER/NAME; "" if there is none.
inline std::string message_of_case(const std::string& folder, const std::string& name) {
  for (const CaseFile& file : case_files(folder)) {
    for (const Case& one : file.cases) {
      if (one.name == name) return one.message;
    }
  }
  return "";
}

/// Runs every case of FOLDER and compares what `message_of` returns, which ends with a line's end.
inline void check_cases(const std::string& folder, std::size_t least,
                        const std::function<std::string(const Case&)>& message_of) {
  std::set<std::string> names;
  for (CaseFile& file : case_files(folder)) {
    for (Case& one : file.cases) {
      INFO(file.path.filename().string() << ": " << one.name);
      CHECK(names.insert(one.name).second);
      const std::string message = message_of(one);
      if (updates_golden()) one.message = message;
      CHECK(message == one.message);
    }
    if (updates_golden()) file.write();
  }
  CHECK(names.size() >= least);
}

}  // namespace trellis::test
