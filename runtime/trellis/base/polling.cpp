// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/polling.hpp>

#include <utility>

namespace trellis {

namespace {

thread_local const std::function<void()>* polled = nullptr;

}  // namespace

PollScope::PollScope(const std::function<void()>& function) : outer_(std::exchange(polled, &function)) {}

PollScope::~PollScope() { polled = outer_; }

void poll() {
  if (polled != nullptr) (*polled)();
}

}  // namespace trellis
