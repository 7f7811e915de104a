// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/slice_monitor.hpp>

#include <algorithm>

namespace trellis {

constinit thread_local SliceMonitor* thread_monitor = nullptr;

void SliceMonitor::ask(const Spending& next) {
  if (!ask_(next)) return;
  limit_ = {announced_.checks + std::max(next.checks, largest_slice.checks),
            announced_.work + std::max(next.work, largest_slice.work)};
}

MonitorScope::MonitorScope(SliceMonitor* monitor) : outer_(std::exchange(thread_monitor, monitor)) {}

MonitorScope::~MonitorScope() { thread_monitor = outer_; }

}  // namespace trellis
