// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <dsl/lua/stack.hpp>

namespace trellis::lua {

class Reference;

/// The values that functions of a script can reach: those in the globals, in the loaded modules, in the metatable of
/// strings, and in the upvalues of functions, at any depth. Shows whether a later call has changed any of them.
///
/// Values are compared by identity, so an equal table in the place of another one is a change. Coroutines, and tables
/// with weak references, change without an assignment: with one of these every snapshot counts as changed.
class Snapshot {
 public:
  /// Takes a snapshot, and keeps the values alive, so that no new value has the address of one of them.
  /// \param roots  further values
  Snapshot(Stack& stack, const std::vector<const Reference*>& roots);
  ~Snapshot();
  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

  /// Whether each value is as it was. Calls no function of the script; costs some tens of nanoseconds for each value.
  [[nodiscard]] bool unchanged(Stack& stack) const;

 private:
  struct Entry {
    int type = 0;
    std::uint64_t bits = 0;
    friend bool operator==(const Entry&, const Entry&) = default;
  };
  class Walk;

  std::unique_ptr<Reference> containers_;  ///< a list of the tables and functions, and of all values in them
  std::size_t count_ = 0;                  ///< the number of containers, the first elements of the list
  std::vector<Entry> entries_;             ///< the content of each container in turn
  bool constant_ = true;                   ///< no value changes without an assignment
};

}  // namespace trellis::lua
