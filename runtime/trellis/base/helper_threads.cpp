// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/helper_threads.hpp>

#include <pthread.h>

#include <algorithm>
#include <ctime>
#include <system_error>

namespace trellis {

namespace {

/// Waits until `value` is no longer `old`: some microseconds busily, then asleep.
void wait_while(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  constexpr int busy = 2000;
  for (int i = 0; i < busy; ++i) {
    if (value.load(std::memory_order_acquire) != old) return;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

HelperThreads::HelperThreads(unsigned workers) : workers_(std::max(1U, workers)) {}

HelperThreads::~HelperThreads() {
  ended_ = true;
  turn_.fetch_add(1, std::memory_order_release);
  turn_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void HelperThreads::run(std::size_t count, const std::function<void(std::size_t, unsigned)>& task) {
  start();
  task_ = &task;
  count_ = count;
  next_.store(0, std::memory_order_relaxed);
  working_.store(workers_ - 1, std::memory_order_relaxed);
  turn_.fetch_add(1, std::memory_order_release);
  turn_.notify_all();
  work(0);
  for (;;) {
    const std::uint32_t left = working_.load(std::memory_order_acquire);
    if (left == 0) return;
    wait_while(working_, left);
  }
}

void HelperThreads::start() {
  try {
    while (threads_.size() + 1 < workers_) {
      threads_.emplace_back([this, worker = static_cast<unsigned>(threads_.size() + 1)] { serve(worker); });
    }
  } catch (const std::system_error&) {
    // The system gives no more threads: those that there are do the work.
    workers_ = static_cast<unsigned>(threads_.size() + 1);
  }
}

void HelperThreads::serve(unsigned worker) {
  std::uint32_t seen = 0;
  for (;;) {
    wait_while(turn_, seen);
    // A thread misses no turn: the next one begins when all have finished this one.
    seen = turn_.load(std::memory_order_acquire);
    if (ended_) return;
    work(worker);
    working_.fetch_sub(1, std::memory_order_release);
    working_.notify_one();
  }
}

void HelperThreads::work(unsigned worker) {
  for (std::size_t i = next_.fetch_add(1); i < count_; i = next_.fetch_add(1)) (*task_)(i, worker);
}

double HelperThreads::cpu_seconds() const {
  double sum = 0.0;
  for (const std::thread& thread : threads_) {
    clockid_t clock{};
    timespec time{};
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): the handle of a const thread
    if (pthread_getcpuclockid(const_cast<std::thread&>(thread).native_handle(), &clock) != 0) continue;
    if (clock_gettime(clock, &time) != 0) continue;
    constexpr double nanosecond = 1e-9;
    sum += static_cast<double>(time.tv_sec) + nanosecond * static_cast<double>(time.tv_nsec);
  }
  return sum;
}

}  // namespace trellis
