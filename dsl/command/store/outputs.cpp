// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/store/outputs.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <vector>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/lua/mistakes.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/errors.hpp>
#include <trellis/base/printable.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/results/files.hpp>
#include <trellis/results/records.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw Error(fmt::format("cannot write '{}': {}", path, reason));
}

std::string reason_of(int error) { return std::strerror(error); }  // NOLINT(concurrency-mt-unsafe): one thread yet

bool closed = false;    // stdout, by its reader
bool reported = false;  // a failure of stdout

[[noreturn]] void fail_output() {
  reported = true;
  closed = errno == EPIPE;
  fail("standard output", reason_of(errno));
}

/// Creates and removes a file in the folder: permissions do not show a read-only file system.
void try_folder(const fs::path& folder, const std::string& output) {
  // Where the system can, the file has no name, so that nothing remains of a process that ends here.
  const int nameless = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (nameless >= 0) {
    ::close(nameless);
    return;
  }
  const std::string probe = (folder / fmt::format(".trellis-{}", ::getpid())).string();
  const int file = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) fail(output, reason_of(errno));
  ::close(file);
  ::unlink(probe.c_str());
}

}  // namespace

void require_writable_file(const std::string& path) {
  if (path.empty()) fail(path, "the name is empty");
  std::error_code error;
  const auto status = fs::status(path, error);
  if (fs::is_directory(status)) fail(path, reason_of(EISDIR));
  if (fs::exists(status) && ::access(path.c_str(), W_OK) != 0) fail(path, reason_of(errno));
  if (fs::exists(status) && !fs::is_regular_file(status)) return;  // a terminal, a pipe: written as a stream
  // Replace the target of a link, not the link.
  const fs::path target = fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : fs::path(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) fail(path, fmt::format("there is no folder '{}'", folder.string()));
  if (target.filename().empty()) fail(path, reason_of(EISDIR));
  try_folder(folder, path);
}

OutputFolder::OutputFolder(const std::string& path) {
  if (path.empty()) return;
  std::error_code error;
  const bool existed = fs::exists(path, error);
  if (existed && !fs::is_directory(path, error)) fail(path, reason_of(ENOTDIR));
  if (!existed) {
    fs::create_directories(path, error);
    if (error) fail(path, error.message());
    made_ = path;
  }
  try_folder(path, path);
}

OutputFolder::~OutputFolder() {
  // remove() deletes only an empty folder.
  std::error_code ignored;
  if (!made_.empty()) fs::remove(made_, ignored);
}

void name_documents(std::vector<std::string>& paths) {
  for (std::string& path : paths) {
    std::error_code ignored;
    const fs::path document = fs::path(path) / "results.json";
    if (fs::is_directory(path, ignored) && fs::is_regular_file(document, ignored)) path = document.string();
  }
}

ExperimentFacts read_document(const std::string& file) {
  constexpr std::size_t largest = std::size_t{4} << 30U;
  return read_results(dsl::read_file(file, largest), file);
}

std::string broken_at_words(std::string_view text, int file) {
  winsize size{};
  constexpr std::size_t narrowest = 20;
  if (::isatty(file) != 1 || ::ioctl(file, TIOCGWINSZ, &size) != 0 || size.ws_col < narrowest) return std::string(text);
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string line(text.substr(0, end));
    if (display_width(line) <= size.ws_col) {
      out += line;
    } else {
      std::string broken = wrap(line, size.ws_col, "", "  ");
      if (broken.ends_with('\n')) broken.pop_back();
      out += broken;
    }
    if (end < text.size()) out += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

void print_stderr(std::string_view text) { static_cast<void>(write_all(STDERR_FILENO, printable(text))); }

void print_message(std::string_view message) {
  print_stderr(broken_at_words(fmt::format("trellis: {}\n", message), STDERR_FILENO));
}

void print_error(const Error& error) {
  std::vector<std::string> messages = {error.what()};
  std::size_t count = 1;
  if (const auto* mistakes = dynamic_cast<const lua::Mistakes*>(&error)) {
    messages = mistakes->messages();
    count = mistakes->count();
  } else if (const auto* errors = dynamic_cast<const Errors*>(&error)) {
    messages = shortened(errors->messages());
    count = errors->messages().size();
  }
  for (const std::string& message : messages) print_message(message);
  if (count > 1) print_message(fmt::format("{} mistakes", count));
}

namespace {

void write_out(const char* bytes, std::size_t size) {
  if (std::fwrite(bytes, 1, size, stdout) != size || std::fflush(stdout) != 0) fail_output();
}

}  // namespace

void print_all(std::string_view text) {
  const std::string shown = printable(text);
  write_out(shown.data(), shown.size());
}

void print_drawing(std::string_view text) { write_out(text.data(), text.size()); }

void finish_output() {
  if (reported) return;
  if (std::fflush(stdout) != 0) fail_output();
  if (std::ferror(stdout) != 0) fail("standard output", "what was printed is incomplete");
}

bool output_closed() { return closed; }

}  // namespace trellis::command
