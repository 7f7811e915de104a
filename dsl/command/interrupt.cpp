// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/interrupt.hpp>

#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigaction is POSIX's
#include <unistd.h>

#include <atomic>
#include <string_view>

#include <dsl/command/commands.hpp>

namespace trellis::command {

namespace {

std::atomic<bool> running{false};
std::atomic<bool> asked{false};
std::atomic<bool> session{false};
std::atomic<bool> noted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait for a lock");

extern "C" void on_interrupt(int) {
  if (session) {
    noted = true;
    return;
  }
  if (running && !asked.exchange(true)) return;
  constexpr std::string_view message = "\ntrellis: interrupted\n";
  // There is no recovery from a failure here.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, message.data(), message.size());
  ::_exit(was_interrupted);
}

}  // namespace

void catch_interrupts() {
  struct sigaction before {};
  ::sigaction(SIGINT, nullptr, &before);
  if (before.sa_handler == SIG_IGN) return;  // nohup, and shells for background jobs, set it so
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  ::sigaction(SIGINT, &action, nullptr);
}

InterruptibleSession::InterruptibleSession() { session = true; }
InterruptibleSession::~InterruptibleSession() {
  session = false;
  noted = false;
}

bool InterruptibleSession::requested() { return noted; }
void InterruptibleSession::forget() { noted = false; }

InterruptibleRun::InterruptibleRun() { running = true; }
InterruptibleRun::~InterruptibleRun() {
  running = false;
  asked = false;
}

bool InterruptibleRun::requested() { return asked; }

}  // namespace trellis::command
