// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/set_up_cache.hpp>

#include <utility>

namespace trellis {

constinit thread_local OwnSetUps* thread_set_ups = nullptr;

OwnSetUpsScope::OwnSetUpsScope(OwnSetUps* own)
    : outer_(own != nullptr ? std::exchange(thread_set_ups, own) : thread_set_ups) {}

OwnSetUpsScope::~OwnSetUpsScope() { thread_set_ups = outer_; }

}  // namespace trellis
