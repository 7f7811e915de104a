// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/repl/line.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): ppoll's masks are POSIX's
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <system_error>

// These headers require <cstdio> before them.
#include <readline/history.h>
#include <readline/readline.h>

#include <dsl/command/interrupt.hpp>
#include <trellis/base/input_file.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;

constexpr int most_remembered = 5000;
/// Of the file of the history, which is read at once.
constexpr std::uintmax_t most_history_bytes = std::uintmax_t{64} << 20U;

// readline calls functions without a context argument, so the context is global.
Completer& completer() {
  static Completer one;
  return one;
}
struct Typed {
  bool done = false;
  bool end = false;
  std::string line;
};
Typed& typed() {
  static Typed one;
  return one;
}

/// The signals that are blocked while the program waits for a key.
sigset_t& waiting() {
  static sigset_t one;
  return one;
}

/// Sets up the terminal so that read() returns at once where nothing was typed. readline restores it.
void prepare_terminal(int meta) {
  rl_prep_terminal(meta);
  termios mode{};
  if (::tcgetattr(STDIN_FILENO, &mode) != 0) return;
  mode.c_cc[VMIN] = 0;
  mode.c_cc[VTIME] = 0;
  ::tcsetattr(STDIN_FILENO, TCSADRAIN, &mode);
}

/// Returns the next key; EOF at the end and after Ctrl-C. On Ctrl-C the terminal discards keys that poll() has already
/// reported, so the program never waits with the signal blocked.
int next_key(FILE* /*from*/) {
  while (!InterruptibleSession::requested()) {
    unsigned char key = 0;
    const ssize_t got = ::read(STDIN_FILENO, &key, 1);
    if (got == 1) return key;
    if (got < 0 && errno != EINTR && errno != EAGAIN) return EOF;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::ppoll(&input, 1, nullptr, &waiting()) < 0 && errno != EINTR) return EOF;
    if ((input.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0 && (input.revents & POLLIN) == 0) return EOF;
  }
  return EOF;
}

void take_line(char* line) {
  Typed& result = typed();
  result.done = true;
  result.end = line == nullptr;
  if (line != nullptr) result.line = line;
  std::free(line);  // NOLINT(cppcoreguidelines-no-malloc): readline's
  rl_callback_handler_remove();
}

std::vector<std::string>& offered() {
  static std::vector<std::string> words;
  return words;
}

char* next_word(const char* /*text*/, int again) {
  static std::size_t next = 0;
  if (again == 0) next = 0;
  return next < offered().size() ? ::strdup(offered()[next++].c_str()) : nullptr;
}

char** complete(const char* text, int /*start*/, int end) {
  const Completion found = completer()(std::string(rl_line_buffer, static_cast<std::size_t>(end)));
  rl_completion_append_character = '\0';
  rl_attempted_completion_over = found.files ? 0 : 1;
  offered() = found.words;
  return offered().empty() ? nullptr : rl_completion_matches(text, next_word);
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  return value != nullptr ? value : "";
}

/// Returns TRELLIS_HISTORY if set, empty for none; else trellis/history in the XDG state folder.
std::string history_file() {
  if (std::getenv("TRELLIS_HISTORY") != nullptr)
    return environment("TRELLIS_HISTORY");  // NOLINT(concurrency-mt-unsafe)
  fs::path folder = environment("XDG_STATE_HOME");
  if (!folder.is_absolute()) {
    folder = environment("HOME");
    if (!folder.is_absolute()) return "";
    folder /= ".local/state";
  }
  folder /= "trellis";
  std::error_code error;
  fs::create_directories(folder, error);
  return error ? "" : (folder / "history").string();
}

/// Returns why the file cannot hold the history, "" if it can.
std::string begin_history(const std::string& file) {
  using_history();
  stifle_history(most_remembered);
  // With timestamps in the file, inputs of several lines keep their lines.
  history_comment_char = '#';
  history_write_timestamps = 1;
  if (file.empty()) return "";
  // Only the user may read the history. append_history requires an existing file.
  const int made = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (made >= 0) ::close(made);
  std::string fault = input_fault(file, most_history_bytes);
  if (fault.empty()) read_history(file.c_str());
  return fault;
}

}  // namespace

LineReader::LineReader(Completer completes)
    : interactive_(::isatty(STDIN_FILENO) == 1 && ::isatty(STDOUT_FILENO) == 1) {
  if (!interactive_) return;
  completer() = std::move(completes);
  rl_readline_name = "trellis";
  rl_catch_signals = 0;  // the session handles Ctrl-C
  rl_prep_term_function = prepare_terminal;
  rl_getc_function = next_key;
  rl_attempted_completion_function = complete;
  rl_completer_word_break_characters = " \t\n\"'`@$><=;|&{}()[]+-*/%^,#~:.";
  rl_completer_quote_characters = "\"'";
  history_ = history_file();
  const std::string fault = begin_history(history_);
  if (fault.empty()) return;
  complaint_ = fmt::format("there is no history: '{}': {}", history_, fault);
  history_.clear();
}

LineReader::~LineReader() {
  if (interactive_ && !history_.empty()) history_truncate_file(history_.c_str(), most_remembered);
  completer() = nullptr;
}

LineReader::Got LineReader::read(const std::string& prompt, std::string& line) {
  if (interactive_) return edit(prompt, line);
  return std::getline(std::cin, line) ? Got::line : Got::end;
}

LineReader::Got LineReader::edit(const std::string& prompt, std::string& line) {
  // Allow Ctrl-C only while the program waits for a key.
  sigset_t blocked;
  sigset_t& before = waiting();
  ::sigemptyset(&blocked);
  ::sigaddset(&blocked, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &blocked, &before);
  InterruptibleSession::forget();
  typed() = {};
  rl_callback_handler_install(prompt.c_str(), take_line);
  Got got = Got::line;
  while (!typed().done) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const int ready = ::ppoll(&input, 1, nullptr, &before);
    if (ready > 0 && !InterruptibleSession::requested()) rl_callback_read_char();
    if (InterruptibleSession::requested()) {
      InterruptibleSession::forget();
      rl_callback_sigcleanup();
      rl_free_line_state();
      rl_point = rl_end;
      rl_redisplay();
      std::fputs("^C", stdout);
      std::fflush(stdout);
      rl_callback_handler_remove();
      std::fputs("\n", stdout);
      got = Got::interrupted;
      break;
    }
    if (ready < 0 && errno != EINTR) {
      rl_callback_handler_remove();
      got = Got::end;
      break;
    }
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (got != Got::line) return got;
  if (typed().end) {
    std::fputs("\n", stdout);
    return Got::end;
  }
  line = typed().line;
  return Got::line;
}

void LineReader::remember(const std::string& input) {
  if (!interactive_) return;
  const HIST_ENTRY* last = history_length > 0 ? history_get(history_base + history_length - 1) : nullptr;
  if (last != nullptr && input == last->line) return;
  add_history(input.c_str());
  if (!history_.empty()) append_history(1, history_.c_str());
}

}  // namespace trellis::command
