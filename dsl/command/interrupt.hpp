// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trellis::command {

/// Handles SIGINT (Ctrl-C), SIGTERM and SIGHUP. After `catch_signals` each ends the program at once, with one line on
/// stderr and the shell's status 128 + signal. While an InterruptibleRun exists, the first one only sets `requested`,
/// so that the run can clean up; a second one ends the program, and so do five seconds in which the run does not ask.
/// Writes to a closed pipe or beyond a limit of the system fail; they do not end the program.
void catch_signals();

/// The status of a program that a signal has ended: 128 + the signal.
int interrupted_status();

/// While one exists, a Ctrl-C ends nothing: the session reads and clears the request. For sessions at a terminal.
class InterruptibleSession {
 public:
  InterruptibleSession();
  ~InterruptibleSession();
  InterruptibleSession(const InterruptibleSession&) = delete;
  InterruptibleSession& operator=(const InterruptibleSession&) = delete;

  /// Whether there was one since the last call of forget(). Thread-safe.
  [[nodiscard]] static bool requested();
  static void forget();
};

class InterruptibleRun {
 public:
  InterruptibleRun();
  ~InterruptibleRun();
  InterruptibleRun(const InterruptibleRun&) = delete;
  InterruptibleRun& operator=(const InterruptibleRun&) = delete;

  /// Thread-safe.
  [[nodiscard]] static bool requested();
};

}  // namespace trellis::command
