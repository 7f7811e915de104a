// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/guide.hpp>

namespace trellis {

/// An Error whose message already says where in a run it arose.
class PlacedError : public Error {
 public:
  using Error::Error;
};

/// What guides of one run have in common: made by the first that asks for it.
class RunShared {
 public:
  /// \param key   tells what is asked for from what others ask for
  /// \param make  returns a std::shared_ptr<T>
  template <class T, class Make>
  std::shared_ptr<T> get(const void* key, const Make& make) {
    std::shared_ptr<void>& held = held_[key];
    if (!held) held = make();
    return std::static_pointer_cast<T>(held);
  }

 private:
  std::map<const void*, std::shared_ptr<void>> held_;
};

/// Where in a run a guide is at work.
struct GuideSite {
  std::uint64_t seed = 0;
  std::string key;    ///< its place in the hierarchy, that random streams are keyed by
  std::string place;  ///< the same for messages: "script.lua:7: in half >> rrt, level 1 (problem 'trap', seed 3)"
  RunShared& shared;
};

/// A guide that is no component of the registry: somebody made it, and it stands in specs beside those. Immutable, and
/// shared by the runs of all threads.
class CustomGuide {
 public:
  struct Description {
    std::string name;             ///< how specs, reports and messages call it
    std::string identity;         ///< equal for equal guides and for no others, on every machine
    std::string default_planner;  ///< of its own search, "" where S = {0}
    std::int64_t resolves = 0;    ///< how often its space may be solved again
    GuideClaims claims = {};      ///< what it says of its f and h
  };

  explicit CustomGuide(Description description) : description_(std::move(description)) {}
  CustomGuide(const CustomGuide&) = delete;
  CustomGuide& operator=(const CustomGuide&) = delete;
  virtual ~CustomGuide() = default;

  [[nodiscard]] const Description& description() const { return description_; }
  /// The guide at work in one place of one run.
  [[nodiscard]] virtual std::unique_ptr<Guide> make(const GuideSite& site) const = 0;

 private:
  Description description_;
};

}  // namespace trellis
