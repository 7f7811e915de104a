// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <variant>

#include <trellis/scene/cache_by_world.hpp>

namespace trellis {

/// What the guides of one run compute of worlds, for a run that shares nothing of that with others.
class OwnSetUps {
 public:
  /// Returns the run's own cache in place of a shared one.
  template <class Cache>
  Cache& in_place_of(const Cache& shared) {
    std::shared_ptr<void>& own = caches_[&shared];
    if (!own) own = std::make_shared<Cache>();
    return *static_cast<Cache*>(own.get());
  }

 private:
  std::map<const void*, std::shared_ptr<void>> caches_;
};

/// What this thread uses in place of the shared caches; nullptr: it uses these.
extern constinit thread_local OwnSetUps* thread_set_ups;

/// While one exists, this thread computes set-ups of worlds anew, and caches them in `own`. Scopes nest.
class OwnSetUpsScope {
 public:
  /// \param own  outlives the scope; nullptr: without effect
  explicit OwnSetUpsScope(OwnSetUps* own);
  ~OwnSetUpsScope();
  OwnSetUpsScope(const OwnSetUpsScope&) = delete;
  OwnSetUpsScope& operator=(const OwnSetUpsScope&) = delete;

 private:
  OwnSetUps* outer_;
};

/// The cache of a set-up of guides, as a medial axis: by world, for all runs, except those that compute their own. What
/// collision checkers compute of a world is in a CacheByWorld, as planners without guides need it too.
template <class Value, class Key = std::monostate, std::size_t most_keys = 4>
class SetUpCache {
 public:
  /// As CacheByWorld::get.
  template <class World, class Make>
  std::shared_ptr<const Value> get(const World& world, const Make& make) {
    return get(world, Key(), make);
  }
  template <class World, class Make>
  std::shared_ptr<const Value> get(const World& world, const Key& key, const Make& make) {
    return (thread_set_ups != nullptr ? thread_set_ups->in_place_of(shared_) : shared_).get(world, key, make);
  }

 private:
  CacheByWorld<Value, Key, most_keys> shared_;
};

}  // namespace trellis
