// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <variant>
#include <vector>

namespace trellis {

/// Values that depend on a world and perhaps a key, each computed once while copies of the world live; of each world
/// the last few keys are known: `most_keys`, as a value may take some hundred megabytes. May be used by several
/// threads: callers with the same world wait for its value, those with other worlds do not.
template <class Value, class Key = std::monostate, std::size_t most_keys = 4>
class CacheByWorld {
 public:
  /// \param world  has an identity that its copies share
  /// \param make  computes the value; if it throws, the next caller computes it
  template <class World, class Make>
  std::shared_ptr<const Value> get(const World& world, const Make& make) {
    return get(world, Key(), make);
  }
  template <class World, class Make>
  std::shared_ptr<const Value> get(const World& world, const Key& key, const Make& make) {
    const std::shared_ptr<Entry> entry = entry_of(world.identity());
    const std::scoped_lock lock(entry->mutex);
    auto& values = entry->values;
    const auto known = std::find_if(values.begin(), values.end(), [&](const auto& item) { return item.first == key; });
    if (known != values.end()) return known->second;
    auto value = std::make_shared<const Value>(make(world));
    if (values.size() == most_keys) values.erase(values.begin());
    values.emplace_back(key, value);
    return value;
  }

 private:
  /// Of one world.
  struct Entry {
    std::mutex mutex;
    std::vector<std::pair<Key, std::shared_ptr<const Value>>> values;
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
