// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the built program (TRELLIS_BINARY) in its own folder, as a user would.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"

namespace trellis::test {

namespace fs = std::filesystem;

inline std::string content(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Outcome {
  int status = -1;  ///< of the exit, or 1000 + the signal
  std::string out;
  std::string err;
  long most_memory = 0;  ///< KiB, the peak memory of the process
};

/// Whether a Python with what figures need is there, as the program looks for one; says aloud that a test is skipped.
inline bool draws_figures() {
  constexpr const char* command =
      "for python in ${TRELLIS_PYTHON:-python3 /usr/bin/python3}; do "
      "$python -c 'import numpy, matplotlib, pandas' 2>/dev/null && exit; done; exit 1";
  static const bool draws = std::system(command) == 0;  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
  if (!draws) WARN("skipped: figures need matplotlib and pandas (python3-matplotlib, python3-pandas)");
  return draws;
}

/// A temporary folder of each test.
class Place {
 public:
  Place() : path_(fs::temp_directory_path() / ("trellis-cli-" + std::to_string(::getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Place() { fs::remove_all(path_); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string script(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return *this / name;
  }

  /// Starts the program in this folder.
  [[nodiscard]] pid_t start(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), TRELLIS_BINARY);
    std::vector<char*> argv;
    for (auto& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    return spawn(argv.data());
  }
  /// Runs a command of bash in this folder; it has the program's name in the variable T.
  [[nodiscard]] Outcome shell(std::string command) const {
    command.insert(0, "T='" TRELLIS_BINARY "'\n");
    std::vector<std::string> words = {"/bin/bash", "-c", std::move(command)};
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    return finish(spawn(argv.data()));
  }
  [[nodiscard]] Outcome finish(pid_t child) const {
    int status = 0;
    rusage used{};
    ::wait4(child, &status, 0, &used);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), content(path_ / "out"),
            content(path_ / "err"), used.ru_maxrss};
  }
  [[nodiscard]] Outcome run(std::vector<std::string> arguments) const { return finish(start(std::move(arguments))); }

 private:
  [[nodiscard]] pid_t spawn(char** argv) const {
    const pid_t child = ::fork();
    if (child == 0) {
      const int out = ::open((path_ / "out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      const int err = ::open((path_ / "err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      ::dup2(out, STDOUT_FILENO);
      ::dup2(err, STDERR_FILENO);
      if (::chdir(path_.c_str()) == 0) ::execv(argv[0], argv);
      ::_exit(99);
    }
    return child;
  }

  fs::path path_;
};

}  // namespace trellis::test
