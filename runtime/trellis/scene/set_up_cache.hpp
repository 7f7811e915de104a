// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

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

/// What it took to compute a set-up of a world, without the other set-ups that it uses.
struct SetUpTime {
  double seconds = 0.0;
  std::vector<std::shared_ptr<const SetUpTime>> uses = {};
};

/// The shared set-ups that a run uses. The first run that needs one computes it; every run that uses it reports the
/// time that it took, and none counts that time as its own.
class SharedSetUps {
 public:
  /// Returns the time that the set-ups took, each counted once, in seconds.
  [[nodiscard]] double seconds() const;
  /// Wall-clock and CPU time of this thread within the run: it computed them, or waited for a run that did.
  [[nodiscard]] double spent() const { return spent_; }
  [[nodiscard]] double cpu_spent() const { return cpu_spent_; }

 private:
  friend class SetUpUse;
  std::vector<std::shared_ptr<const SetUpTime>> used_;
  double spent_ = 0.0;
  double cpu_spent_ = 0.0;
};

/// While one exists, this thread records what it uses of the shared caches.
class SharedSetUpsScope {
 public:
  /// \param record  outlives the scope
  explicit SharedSetUpsScope(SharedSetUps* record);
  ~SharedSetUpsScope();
  SharedSetUpsScope(const SharedSetUpsScope&) = delete;
  SharedSetUpsScope& operator=(const SharedSetUpsScope&) = delete;

 private:
  SharedSetUps* outer_;
};

/// Times one use of a shared set-up. A set-up may use others, so that uses nest.
class SetUpUse {
 public:
  SetUpUse();
  ~SetUpUse();
  SetUpUse(const SetUpUse&) = delete;
  SetUpUse& operator=(const SetUpUse&) = delete;

  /// Returns the time so far, after it was computed in this use.
  [[nodiscard]] std::shared_ptr<const SetUpTime> computed() const;
  /// Records what was found or computed.
  void found(std::shared_ptr<const SetUpTime> time) { time_ = std::move(time); }

 private:
  SetUpUse* outer_;
  double begin_;
  double cpu_begin_;
  double within_ = 0.0;  ///< wall-clock time of the uses in this one
  std::vector<std::shared_ptr<const SetUpTime>> uses_;
  std::shared_ptr<const SetUpTime> time_;
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
    if (thread_set_ups != nullptr) {
      const auto own = thread_set_ups->in_place_of(shared_).get(world, key, [&](const World& of) {
        return Timed{make(of), nullptr};
      });
      return {own, &own->value};
    }
    SetUpUse use;
    const auto timed = shared_.get(world, key, [&](const World& of) {
      Value value = make(of);
      return Timed{std::move(value), use.computed()};
    });
    use.found(timed->time);
    return {timed, &timed->value};
  }

 private:
  struct Timed {
    Value value;
    std::shared_ptr<const SetUpTime> time;
  };
  CacheByWorld<Timed, Key, most_keys> shared_;
};

}  // namespace trellis
