// SPDX-License-Identifier: GPL-3.0-or-later
// A pseudo-terminal that runs the built program (TRELLIS_BINARY), or another one, interactively.
#pragma once

#include <poll.h>
#include <pty.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill is POSIX's
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace trellis::test {

/// Types keys and reads the output up to an expected text; a missing text fails the test after a timeout.
class Terminal {
 public:
  using Environment = std::vector<std::pair<std::string, std::string>>;

  Terminal(const std::string& folder, std::vector<std::string> arguments, const Environment& environment = {},
           unsigned short columns = 120, unsigned short rows = 45, const char* program = TRELLIS_BINARY) {
    arguments.insert(arguments.begin(), program);
    std::vector<char*> argv;
    for (auto& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    winsize size{rows, columns, 0, 0};
    child_ = ::forkpty(&screen_, nullptr, nullptr, &size);
    if (child_ != 0) return;
    ::setenv("TERM", "xterm-256color", 1);
    for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
    if (::chdir(folder.c_str()) == 0) ::execv(program, argv.data());
    ::_exit(99);
  }
  ~Terminal() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
    ::close(screen_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void type(const std::string& keys) const {
    if (::write(screen_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size())) {
      throw std::runtime_error("the terminal takes no keys");
    }
  }

  /// Returns the output up to and with `text`, since the last call.
  std::string wait_for(const std::string& text) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (true) {
      if (const auto at = sent_.find(text); at != std::string::npos) {
        const std::string seen = sent_.substr(0, at + text.size());
        sent_.erase(0, at + text.size());
        return seen;
      }
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      if (left.count() <= 0 || !read(static_cast<int>(left.count()))) {
        throw std::runtime_error("no '" + text + "' was sent, but:\n" + sent_);
      }
    }
  }

  /// Types a line and returns what was sent until the next prompt.
  std::string enter(const std::string& line) {
    type(line + "\n");
    return wait_for(prompt);
  }

  /// Returns the output since the last call of wait_for().
  [[nodiscard]] const std::string& rest() const { return sent_; }

  /// Waits for the program to end; returns its status, 1000 + the signal if a signal ended it.
  int finish() {
    while (read(static_cast<int>(std::chrono::milliseconds(patience).count()))) {
    }
    if (silent_) ::kill(child_, SIGKILL);  // else the wait would not end
    int status = 0;
    ::waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

  static constexpr const char* prompt = "trellis> ";

 private:
  static constexpr std::chrono::seconds patience{300};

  bool read(int milliseconds) {
    pollfd input{screen_, POLLIN, 0};
    if (::poll(&input, 1, milliseconds) <= 0) {
      silent_ = true;
      return false;
    }
    char block[4096];
    const ssize_t size = ::read(screen_, block, sizeof block);
    if (size <= 0) return false;
    sent_.append(block, static_cast<std::size_t>(size));
    return true;
  }

  int screen_ = -1;
  pid_t child_ = -1;
  std::string sent_;
  bool silent_ = false;
};

}  // namespace trellis::test
