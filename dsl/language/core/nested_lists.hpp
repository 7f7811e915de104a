// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <dsl/lua/value.hpp>

namespace trellis::dsl {

/// Limits of lists within lists while they are read. Tables may share tables: 40 lines of a script make a list of 2^40
/// elements, so every value counts each time that it is read.
class NestedLists {
 public:
  /// \param prefix  of the messages: "world: "
  /// \param most    how many values may be read, the lists among them
  NestedLists(std::string prefix, std::size_t most) : prefix_(std::move(prefix)), most_(most) {}

  /// Counts a value. Returns false after the limit was passed: then nothing more is to be read.
  /// \throws Error for the first value beyond the limit
  bool count();

  /// A list that is read, until the destruction.
  class Within {
   public:
    Within(NestedLists& lists, lua::Value list, const std::string& what);
    ~Within() { lists_.within_.pop_back(); }
    Within(const Within&) = delete;
    Within& operator=(const Within&) = delete;

   private:
    NestedLists& lists_;
  };

  /// Begins to read a list. \throws Error for one that contains itself, and for lists that are nested too deep
  /// \param what  the list in messages: "element 3"
  [[nodiscard]] Within enter(lua::Value list, const std::string& what) { return {*this, list, what}; }

 private:
  std::string prefix_;
  std::size_t most_;
  std::size_t read_ = 0;
  std::vector<const void*> within_;  // the lists that are currently read
};

}  // namespace trellis::dsl
