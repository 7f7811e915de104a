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

/// An Error whose message already contains its location in the run.
class PlacedError : public Error {
 public:
  using Error::Error;
};

/// Objects that the guides of one run share. The first guide that needs an object creates it.
class RunShared {
 public:
  /// The object of a key; creates it at the first call.
  /// \param key  identifies the object
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

/// The location of a guide in a run.
struct GuideSite {
  std::uint64_t seed = 0;
  std::string key;    ///< location in the hierarchy, the key of random streams
  std::string place;  ///< the location for messages: "script.lua:7: in half >> rrt, level 1 (problem 'trap', seed 3)"
  RunShared& shared;
};

/// A guide that is not in the registry: a script or another caller defines it. Specs contain it beside registered
/// guides. Immutable; the runs of all threads share it.
class CustomGuide {
 public:
  struct Description {
    std::string name;             ///< in specs, reports and messages
    std::string identity;         ///< equal for equal guides only, on every machine
    std::string default_planner;  ///< planner of the search of S; "" if S = {0}
    std::int64_t resolves = 0;    ///< maximum number of further solves of S
    GuideClaims claims = {};      ///< the properties of f and h
  };

  explicit CustomGuide(Description description) : description_(std::move(description)) {}
  CustomGuide(const CustomGuide&) = delete;
  CustomGuide& operator=(const CustomGuide&) = delete;
  virtual ~CustomGuide() = default;

  [[nodiscard]] const Description& description() const { return description_; }
  /// Makes the guide for one location of one run.
  [[nodiscard]] virtual std::unique_ptr<Guide> make(const GuideSite& site) const = 0;

 private:
  Description description_;
};

}  // namespace trellis
