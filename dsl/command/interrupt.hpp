// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trellis::command {

/// Ctrl-C. From `catch_interrupts` on it ends the program at once with the shell's status 130; while an
/// InterruptibleRun lives, the first one only sets `requested`, so that the run can clean up, and a second one ends it.
void catch_interrupts();

/// While one lives, a Ctrl-C ends nothing: it is noted until somebody takes note of it. For sessions at a terminal.
class InterruptibleSession {
 public:
  InterruptibleSession();
  ~InterruptibleSession();
  InterruptibleSession(const InterruptibleSession&) = delete;
  InterruptibleSession& operator=(const InterruptibleSession&) = delete;

  /// Whether there was one since the last call of forget(). Safe from any thread.
  [[nodiscard]] static bool requested();
  static void forget();
};

class InterruptibleRun {
 public:
  InterruptibleRun();
  ~InterruptibleRun();
  InterruptibleRun(const InterruptibleRun&) = delete;
  InterruptibleRun& operator=(const InterruptibleRun&) = delete;

  /// Safe from any thread.
  [[nodiscard]] static bool requested();
};

}  // namespace trellis::command
