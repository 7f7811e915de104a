// SPDX-License-Identifier: MIT-0
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <mutex>

/// Calls of this module that are running without the GIL, and whether they shall stop: because Ctrl-C was pressed
/// meanwhile, or because Python ends. Scripts keep the function that reads it, longer than a call lasts.
class Call {
 public:
  /// Requires the GIL. \throws SystemExit while Python ends: that ends a thread without a word
  Call() {
    const std::scoped_lock lock(state().mutex);
    if (state().exiting) {
      PyErr_SetNone(PyExc_SystemExit);
      throw pybind11::error_already_set();
    }
    ++state().running;
  }
  ~Call() {
    const std::scoped_lock lock(state().mutex);
    if (--state().running == 0) {
      state().stopped = false;
      state().ended.notify_all();
    }
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  static void stop() { state().stopped = true; }
  static bool is_stopped() { return state().stopped || state().exiting; }
  /// Whether Python ends.
  static bool is_exiting() { return state().exiting; }
  /// Stops all calls, of daemon threads too, and waits for them: they cannot return into an interpreter that has ended.
  static void exit() {
    std::unique_lock lock(state().mutex);
    state().exiting = true;
    state().ended.wait(lock, [] { return state().running == 0; });
  }

 private:
  struct State {
    std::mutex mutex;
    std::condition_variable ended;
    int running = 0;
    std::atomic<bool> stopped = false;
    std::atomic<bool> exiting = false;
  };
  /// Lives as long as the process: threads may use it until its end.
  static State& state() {
    static State& one = *new State;
    return one;
  }
};
