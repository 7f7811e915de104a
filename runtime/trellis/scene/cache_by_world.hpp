// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <mutex>

namespace trellis {

/// Values that depend on a world alone, each computed once while copies of the world live. May be used by several
/// threads: callers with the same world wait for its value, those with other worlds do not.
template <class Value>
class CacheByWorld {
 public:
  /// \param world  has an identity that its copies share
  /// \param make  computes the value; if it throws, the next caller computes it
  template <class World, class Make>
  std::shared_ptr<const Value> get(const World& world, const Make& make) {
    const std::shared_ptr<Entry> entry = entry_of(world.identity());
    const std::scoped_lock lock(entry->mutex);
    if (!entry->value) entry->value = std::make_shared<const Value>(make(world));
    return entry->value;
  }

 private:
  struct Entry {
    std::mutex mutex;
    std::shared_ptr<const Value> value;
  };
  struct Slot {
    std::weak_ptr<const void> world;  // expired: another world now has this address
    std::shared_ptr<Entry> entry;
  };

  std::shared_ptr<Entry> entry_of(const std::shared_ptr<const void>& identity) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(slots_, [](const auto& item) { return item.second.world.expired(); });
    Slot& slot = slots_[identity.get()];
    if (!slot.entry) slot = {identity, std::make_shared<Entry>()};
    return slot.entry;
  }

  std::mutex mutex_;
  std::map<const void*, Slot> slots_;
};

}  // namespace trellis
