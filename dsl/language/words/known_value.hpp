// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include <dsl/language/core/word.hpp>
#include <dsl/lua/stack.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/guide/guide.hpp>

// What the functions of a guiding space that make S know about C, as a value of the language.

namespace trellis::dsl {

/// What is known behind a value of the language, which may outlive it.
struct KnownAccess {
  const Known* known = nullptr;  ///< nullptr: the call that the value was passed to has ended

  /// Invalidates it at the end of a scope.
  class Scope {
   public:
    explicit Scope(KnownAccess& access) : access_(access) {}
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() { access_.known = nullptr; }

   private:
    KnownAccess& access_;
  };
};

/// What is known, as a value: its lists are made when a script first reads them.
struct KnownValue {
  std::shared_ptr<const KnownAccess> access;
  std::shared_ptr<const lua::Reference> members;  ///< a table of the lists made so far, which scripts cannot access
};

/// Pushes what is known.
void push_known(lua::Stack& stack, const std::shared_ptr<const KnownAccess>& access);

/// "reached", "advanced" or "rejected".
std::string_view fate_name(Fate fate);

/// Registers the type.
void open_known(lua::Stack& stack);

/// trellis.Known and its parts.
std::vector<ObjectType> known_types();

}  // namespace trellis::dsl

namespace trellis::lua {

template <>
struct TypeName<dsl::KnownValue> {
  static constexpr const char* value = "record of C";
};

}  // namespace trellis::lua
