// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace trellis {

/// Threads that help one other thread, again and again, with tasks of microseconds. Between two calls of `run` they
/// wait, first busily; they start with the first call. Only one thread uses an object at a time.
class HelperThreads {
 public:
  /// \param workers  threads that work, the caller's included; at least 1
  explicit HelperThreads(unsigned workers);
  HelperThreads(const HelperThreads&) = delete;
  HelperThreads& operator=(const HelperThreads&) = delete;
  ~HelperThreads();

  /// The number of threads that work, the caller's included.
  [[nodiscard]] unsigned workers() const { return workers_; }
  /// Calls task(i, worker) for each i below `count`, in no certain order, and returns when all have ended.
  /// \param task  throws nothing. `worker` is below workers() and 0 for the caller's thread; no two tasks with the same
  ///     worker run at the same time
  void run(std::size_t count, const std::function<void(std::size_t, unsigned)>& task);
  /// CPU time of the helpers so far, seconds.
  [[nodiscard]] double cpu_seconds() const;

 private:
  void start();
  void serve(unsigned worker);
  void work(unsigned worker);

  unsigned workers_;
  std::vector<std::thread> threads_;
  const std::function<void(std::size_t, unsigned)>* task_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::uint32_t> turn_{0};     ///< grows with each call of `run`, and at the end
  std::atomic<std::uint32_t> working_{0};  ///< helpers that have not finished the turn
  bool ended_ = false;                     ///< written before `turn_` grows
};

}  // namespace trellis
