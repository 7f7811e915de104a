// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trellis {

class SliceMonitor;

/// Receives what this thread announces (base/slice_monitor.hpp); nullptr: announcements have no effect.
extern constinit thread_local SliceMonitor* thread_monitor;

}  // namespace trellis
