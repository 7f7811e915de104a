// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

struct lua_State;

namespace trellis::lua {

/// How messages call a C++ type that scripts hold: "guide". Specialised once for each such type.
template <class T>
struct TypeName;

/// The bytes that an object of a type holds; specialised for those that may hold much.
template <class T>
struct Weight {
  static std::size_t of(const T&) { return sizeof(T); }
};

/// What stands behind a userdata. Lua's block holds a pointer to it, so that a collected object can be told.
class Object {
 public:
  Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  virtual ~Object() = default;
  [[nodiscard]] virtual std::size_t weight() const = 0;
};

template <class T>
class Boxed final : public Object {
 public:
  explicit Boxed(T given) : value(std::move(given)) {}
  [[nodiscard]] std::size_t weight() const override { return Weight<T>::of(value); }
  T value;
};

enum class Type { none, nil, boolean, number, string, table, function, object, other };

/// The keys of a table that is plain data, in an order that does not depend on where Lua put them.
struct Keys {
  std::vector<std::string> names;  ///< the string keys, sorted
  std::size_t length = 0;          ///< there is a value for each of 1, ..., length
  std::string odd;                 ///< what is wrong with another key, "" without one
};

/// A slot of the stack that a call sees; valid until that call returns. Reading never converts between types: a script
/// that writes "3" where a number belongs is told so.
class Value {
 public:
  Value(lua_State* state, int index) : state_(state), index_(index) {}

  [[nodiscard]] Type type() const;
  /// Whether there is something: neither nil nor beyond the arguments.
  [[nodiscard]] bool given() const;
  /// Whether it is a number that Lua keeps as an integer.
  [[nodiscard]] bool is_integer() const;

  [[nodiscard]] std::optional<bool> boolean() const;
  /// A NaN comes without its sign, which depends on the machine and would show in messages.
  [[nodiscard]] std::optional<double> number() const;
  /// Integers, and floats with an integral value.
  [[nodiscard]] std::optional<std::int64_t> integer() const;
  [[nodiscard]] std::optional<std::string> string() const;
  /// The object inside, nullptr where it is something else.
  template <class T>
  [[nodiscard]] const T* get() const {
    const auto* boxed = dynamic_cast<const Boxed<T>*>(object());
    return boxed != nullptr ? &boxed->value : nullptr;
  }
  /// What it is, for messages: "a guide", "a table", "3.5", "\"abc\"", "nothing".
  [[nodiscard]] std::string describe() const;
  /// What tostring gives.
  [[nodiscard]] std::string text() const;

  // Of a table. Reading is raw: what a script passes as data has no behaviour.
  [[nodiscard]] Keys keys() const;
  [[nodiscard]] Value field(const std::string& name) const;
  /// Calls `visit` with each of the values 1, ..., length and its number.
  void each(const std::function<void(std::size_t, Value)>& visit) const;
  /// Calls `visit` with each key and its value, in no particular order. The table must not be changed meanwhile.
  void each_pair(const std::function<void(Value, Value)>& visit) const;
  /// Equal for the same table, object or function only.
  [[nodiscard]] const void* identity() const;

  [[nodiscard]] int index() const { return index_; }
  [[nodiscard]] lua_State* state() const { return state_; }

 private:
  [[nodiscard]] const Object* object() const;

  lua_State* state_;
  int index_;
};

}  // namespace trellis::lua
