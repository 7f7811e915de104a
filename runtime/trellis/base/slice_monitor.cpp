// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/slice_monitor.hpp>

#include <algorithm>

namespace trellis {

namespace {

thread_local SliceMonitor* active = nullptr;

}  // namespace

void SliceMonitor::announce(const Spending& next) {
  if (announced_.checks + next.checks > limit_.checks || announced_.work + next.work > limit_.work) {
    if (ask_(announced_, next)) {
      limit_ = {announced_.checks + std::max(next.checks, largest_slice.checks),
                announced_.work + std::max(next.work, largest_slice.work)};
    }
  }
  announced_.checks += next.checks;
  announced_.work += next.work;
}

MonitorScope::MonitorScope(SliceMonitor* monitor) : outer_(std::exchange(active, monitor)) {}

MonitorScope::~MonitorScope() { active = outer_; }

void announce_motion_checks(std::uint32_t most) {
  if (active != nullptr) active->announce(active->checks(most, true));
}

void announce_checks(std::uint32_t most) {
  if (active != nullptr) active->announce(active->checks(most, false));
}

void withdraw_motion_checks(std::uint32_t unspent) {
  if (active != nullptr) active->withdraw(active->checks(unspent, true));
}

void announce_work(double work) {
  if (active != nullptr) active->announce_other(work);
}

}  // namespace trellis
