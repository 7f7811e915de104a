// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/process.hpp>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

namespace trellis {

namespace {

/// A pipe, whose ends are closed with it.
class Pipe {
 public:
  Pipe() : fault_(::pipe2(ends_.data(), O_CLOEXEC) == 0 ? 0 : errno) {}
  ~Pipe() {
    for (std::size_t end : {0U, 1U}) close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] int fault() const { return fault_; }
  [[nodiscard]] int out() const { return ends_[0]; }
  [[nodiscard]] int in() const { return ends_[1]; }
  void close_in() { close(1); }

 private:
  void close(std::size_t end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }
  std::array<int, 2> ends_{-1, -1};
  int fault_;
};

/// Returns the words as the system takes them, valid as long as they are.
std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  all.reserve(words.size() + 1);
  for (std::string& word : words) all.push_back(word.data());
  all.push_back(nullptr);
  return all;
}

/// Reads a part of a pipe. Returns whether there may be more.
bool read_part(int file, std::string& text) {
  std::array<char, 1U << 16U> block{};
  const ssize_t n = ::read(file, block.data(), block.size());
  if (n > 0) text.append(block.data(), static_cast<std::size_t>(n));
  return n > 0 || (n < 0 && (errno == EINTR || errno == EAGAIN));
}

}  // namespace

bool ProcessEnd::succeeded() const { return exit_status() == 0; }
int ProcessEnd::exit_status() const { return fault == 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1; }

ProcessEnd run_process(const Process& process) {
  ProcessEnd ended;
  Pipe output;
  Pipe errors;
  ended.fault = output.fault() != 0 ? output.fault() : errors.fault();
  if (ended.fault != 0) return ended;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, process.input.c_str(), O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, output.in(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, errors.in(), STDERR_FILENO);
  std::vector<std::string> words = process.words;
  std::vector<std::string> variables = process.environment;
  pid_t child = 0;
  ended.fault = ::posix_spawnp(&child, words.front().c_str(), &actions, nullptr, pointers(words).data(),
                               pointers(variables).data());
  ::posix_spawn_file_actions_destroy(&actions);
  if (ended.fault != 0) return ended;
  output.close_in();
  errors.close_in();
  std::array<pollfd, 2> open{pollfd{output.out(), POLLIN, 0}, pollfd{errors.out(), POLLIN, 0}};
  while (!ended.too_long && (open[0].fd >= 0 || open[1].fd >= 0)) {
    if (::poll(open.data(), open.size(), -1) < 0) continue;
    for (pollfd& one : open) {
      std::string& text = &one == open.data() ? ended.output : ended.errors;
      if (one.fd >= 0 && one.revents != 0 && !read_part(one.fd, text)) one.fd = -1;
      ended.too_long = ended.too_long || text.size() > process.most_output;
    }
  }
  if (ended.too_long) ::kill(child, SIGKILL);
  while (::waitpid(child, &ended.status, 0) < 0 && errno == EINTR) {
  }
  return ended;
}

}  // namespace trellis
