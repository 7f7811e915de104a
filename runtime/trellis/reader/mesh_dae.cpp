// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include <trellis/reader/mesh_formats.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_output = std::size_t{256} << 20U;

/// A file descriptor that is closed with it.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

/// Returns the path of the program that converts, "" if there is none: beside this program, or as installed.
std::string converter() {
  std::error_code fault;
  const fs::path folder = fs::read_symlink("/proc/self/exe", fault).parent_path();
  if (fault) return "";
  for (const char* place :
       {"trellis-mesh", "../trellis-mesh", "../../trellis-mesh", "../libexec/trellis/trellis-mesh"}) {
    if (const fs::path path = folder / place; ::access(path.c_str(), X_OK) == 0) return path.string();
  }
  return "";
}

/// What a process printed, and how it ended.
struct Ended {
  std::string output;
  int status = 0;  ///< as of waitpid
};

/// Runs the converter with the file as its standard input.
Ended convert(const MeshSource& source, const std::string& program) {
  const auto fail = [&](int reason) {
    return source.error(0, fmt::format("it cannot be converted: {}", std::generic_category().message(reason)));
  };
  const Descriptor file(::open(source.path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.number() < 0) throw fail(errno);
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw fail(errno);
  const Descriptor out(ends[0]);
  Descriptor in(ends[1]);

  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, file.number(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, in.number(), STDOUT_FILENO);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::string name = "trellis-mesh";
  std::string ending = "dae";
  std::array<char*, 3> arguments{name.data(), ending.data(), nullptr};
  std::array<char*, 1> environment{nullptr};
  pid_t child = 0;
  const int failed = ::posix_spawn(&child, program.c_str(), &actions, nullptr, arguments.data(), environment.data());
  ::posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw fail(failed);
  in.close();

  Ended ended;
  std::array<char, 1U << 16U> block{};
  while (ended.output.size() <= most_output) {
    const ssize_t n = ::read(out.number(), block.data(), block.size());
    if (n > 0) ended.output.append(block.data(), static_cast<std::size_t>(n));
    if (n == 0 || (n < 0 && errno != EINTR)) break;
  }
  if (ended.output.size() > most_output) ::kill(child, SIGKILL);
  while (::waitpid(child, &ended.status, 0) < 0 && errno == EINTR) {
  }
  return ended;
}

}  // namespace

void read_dae(const MeshSource& source, Polygons& polygons) {
  if (source.unit != 1.0) throw source.error(0, "COLLADA states its unit; leave out unit");
  const std::string program = converter();
  if (program.empty()) {
    throw source.error(0,
                       "COLLADA is read by the program trellis-mesh, which is not installed: build Trellis where "
                       "libassimp-dev is, or convert the file to OBJ or STL");
  }
  Ended ended = convert(source, program);
  if (ended.output.size() > most_output) throw source.error(0, "it is larger than a mesh may be");
  if (WIFSIGNALED(ended.status)) {
    const int signal = WTERMSIG(ended.status);
    throw source.error(0, signal == SIGXCPU || signal == SIGKILL ? "reading it takes too long or too much memory"
                                                                 : "it is damaged: reading it failed");
  }
  if (WEXITSTATUS(ended.status) != 0) {
    std::string_view line = std::string_view(ended.output).substr(0, ended.output.find('\n'));
    if (line.starts_with("error ")) line.remove_prefix(6);
    throw source.error(0, line.empty() ? std::string("it is damaged: reading it failed") : std::string(line));
  }
  const MeshSource converted{source.path, std::move(ended.output), 1.0};
  read_off(converted, polygons);
  polygons.format = "COLLADA";
}

}  // namespace trellis
