// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trellis::command {

/// Handles Ctrl-C. After `catch_interrupts` it ends the program at once with the shell's status 130. While an
/// InterruptibleRun exists, the first Ctrl-C only sets `requested`, so that the run can clean up, and a second one ends
/// the program.
void catch_interrupts();

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
