// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>

namespace trellis {

/// Values that are costly to make, by key, for all threads: one is kept while any user has it, and the last small ones
/// after that, since each level of each run makes a checker of its own.
template <class Key, class Value>
class SharedCache {
 public:
  /// Returns the value of the key; `make()` makes it where no user has it.
  template <class Make>
  std::shared_ptr<const Value> get(const Key& key, bool small, const Make& make) {
    const std::lock_guard lock(mutex_);
    auto& slot = values_[key];
    if (auto known = slot.lock()) return known;
    auto value = std::make_shared<const Value>(make());
    slot = value;
    if (small) recent_[next_++ % recent_.size()] = value;
    std::erase_if(values_, [](const auto& entry) { return entry.second.expired(); });
    return value;
  }

 private:
  std::mutex mutex_;
  std::map<Key, std::weak_ptr<const Value>> values_;
  std::array<std::shared_ptr<const Value>, 8> recent_;
  std::size_t next_ = 0;
};

}  // namespace trellis
