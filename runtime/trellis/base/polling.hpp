// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace trellis {

/// While one exists, `poll` in this thread calls a function: long work in the layers below a caller ends soon after the
/// function throws. Scopes nest; the innermost counts.
class PollScope {
 public:
  /// \param function  must outlive the scope; an exception from it leaves the work
  explicit PollScope(const std::function<void()>& function);
  ~PollScope();
  PollScope(const PollScope&) = delete;
  PollScope& operator=(const PollScope&) = delete;

 private:
  const std::function<void()>* outer_;
};

/// Calls the function of this thread's PollScope, if there is one. For loops whose rounds cost a microsecond or more.
void poll();

/// The same in each 16th round, for loops whose rounds cost less than that.
inline void poll(std::size_t round) {
  if (round % 16 == 0) poll();
}

}  // namespace trellis
