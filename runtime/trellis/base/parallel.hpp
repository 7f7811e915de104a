// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace trellis {

/// Calls task(i) for every i below `count` on at most `jobs` threads, the caller's among them. The first exception
/// stops the other threads and is rethrown to the caller.
void in_parallel(std::size_t count, unsigned jobs, const std::function<void(std::size_t)>& task);

}  // namespace trellis
