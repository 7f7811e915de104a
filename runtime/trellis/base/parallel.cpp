// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace trellis {

void in_parallel(std::size_t count, unsigned jobs, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;  // guards the failure
  std::exception_ptr failure;
  const auto work = [&] {
    while (!stop.load()) {
      const std::size_t index = next.fetch_add(1);
      if (index >= count) return;
      try {
        task(index);
      } catch (...) {
        // Keep the first exception only: the others follow from the request to stop.
        const std::scoped_lock lock(mutex);
        if (!failure) failure = std::current_exception();
        stop.store(true);
      }
    }
  };
  {
    std::vector<std::jthread> others;  // beside the caller's thread
    for (std::size_t i = 1; i < std::min<std::size_t>(std::max(1U, jobs), count); ++i) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace trellis
