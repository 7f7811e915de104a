// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

namespace trellis {

/// Scratch memory that a thread keeps between the calls of a function, so that a call allocates nothing. A call within
/// another one, as by a search that continues while an announcement waits (slice_monitor.hpp), has memory of its own.
template <class T>
class ThreadScratch {
 public:
  ThreadScratch() : value_(std::exchange(kept(), T())) {}
  ~ThreadScratch() { kept() = std::move(value_); }
  ThreadScratch(const ThreadScratch&) = delete;
  ThreadScratch& operator=(const ThreadScratch&) = delete;

  /// With what the last call left in it.
  [[nodiscard]] T& operator*() { return value_; }

 private:
  static T& kept() {
    thread_local T kept;
    return kept;
  }

  T value_;
};

}  // namespace trellis
