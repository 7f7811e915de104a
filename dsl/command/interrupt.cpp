// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/interrupt.hpp>

#include <fcntl.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigaction is POSIX's
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <string_view>

#include <dsl/command/commands.hpp>

namespace trellis::command {

namespace {

constexpr unsigned patience = 5;       ///< seconds that a run has to end after the first signal
constexpr int status_of_signal = 128;  ///< the shells' convention: this plus the number of the signal

std::atomic<bool> running{false};
std::atomic<bool> asked{false};
std::atomic<bool> seen{false};  // the request, by the run
std::atomic<bool> session{false};
std::atomic<bool> noted{false};
std::atomic<bool> terminal_saved{false};
std::atomic<bool> ending{false};
std::atomic<int> received{SIGINT};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait for a lock");
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not wait for a lock");

/// What a session changes while it edits a line.
termios& terminal() {
  static termios saved{};
  return saved;
}

std::string_view message_of(int signal) {
  switch (signal) {
    case SIGTERM: return "\ntrellis: terminated\n";
    case SIGHUP: return "\ntrellis: the terminal was closed\n";
    default: return "\ntrellis: interrupted\n";
  }
}

/// Ends the process from a signal handler.
void end(int signal) {
  if (ending.exchange(true)) return;  // another thread, or the handler of another signal, prints the line
  if (session && terminal_saved) ::tcsetattr(STDIN_FILENO, TCSANOW, &terminal());
  const std::string_view message = message_of(signal);
  // There is no recovery from a failure here.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, message.data(), message.size());
  ::_exit(status_of_signal + signal);
}

extern "C" void on_signal(int signal) {
  if (session && signal == SIGINT) {
    noted = true;
    return;
  }
  received = signal;
  if (running && !asked.exchange(true)) {
    ::alarm(patience);  // a run that polls no request in time ends like any other program
    return;
  }
  end(signal);
}

extern "C" void on_alarm(int) { end(received); }

/// Installed instead of SIG_IGN, which an editor that a session starts would inherit.
extern "C" void on_failed_write(int) {}

void handle(int signal, void (*handler)(int)) {
  struct sigaction before {};
  ::sigaction(signal, nullptr, &before);
  if (before.sa_handler == SIG_IGN) return;  // nohup, and shells for background jobs, set it so
  struct sigaction action {};
  action.sa_handler = handler;
  ::sigaction(signal, &action, nullptr);
}

/// Opens what the caller closed, in the wrong direction: reading and writing fail, and no file that the program opens
/// has the number of stdout.
void occupy_standard_streams() {
  for (const auto& [number, mode] :
       {std::array{STDIN_FILENO, O_WRONLY}, std::array{STDOUT_FILENO, O_RDONLY}, std::array{STDERR_FILENO, O_RDONLY}}) {
    if (::fcntl(number, F_GETFD) < 0 && errno == EBADF) static_cast<void>(::open("/dev/null", mode));
  }
}

}  // namespace

void catch_signals() {
  occupy_standard_streams();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) handle(signal, on_signal);
  handle(SIGALRM, on_alarm);
  // A write to a closed pipe, or beyond the limit of a file's size, then fails with a reason that is reported.
  for (const int signal : {SIGPIPE, SIGXFSZ}) handle(signal, on_failed_write);
}

int interrupted_status() { return status_of_signal + received; }

InterruptibleSession::InterruptibleSession() {
  terminal_saved = ::tcgetattr(STDIN_FILENO, &terminal()) == 0;
  session = true;
}
InterruptibleSession::~InterruptibleSession() {
  session = false;
  noted = false;
}

bool InterruptibleSession::requested() { return noted; }
void InterruptibleSession::forget() { noted = false; }

InterruptibleRun::InterruptibleRun() { running = true; }
InterruptibleRun::~InterruptibleRun() {
  running = false;
  if (asked) ::alarm(0);
  asked = false;
  seen = false;
}

bool InterruptibleRun::requested() {
  if (!asked) return false;
  if (!seen.exchange(true)) ::alarm(0);
  return true;
}

}  // namespace trellis::command
