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

/// The name of a C++ type in messages: "guide". Specialised for each type of Lua values.
template <class T>
struct TypeName;

/// Returns the memory of an object in bytes; specialised for large types.
template <class T>
struct Weight {
  static std::size_t of(const T&) { return sizeof(T); }
};

/// The C++ object of a userdata. Lua's block contains a pointer to it, so that a collected object is detectable.
class Object {
 public:
  Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  virtual ~Object() = default;
  [[nodiscard]] virtual std::size_t weight() const = 0;

  /// Objects are numbered as a process makes them, so that those of a table have the order of the script.
  std::uint64_t number = 0;
};

template <class T>
class Boxed final : public Object {
 public:
  explicit Boxed(T given) : value(std::move(given)) {}
  [[nodiscard]] std::size_t weight() const override { return Weight<T>::of(value); }
  T value;
};

enum class Type { none, nil, boolean, number, string, table, function, object, other };

/// The keys of a table of plain data, in an order that does not depend on Lua's hash order.
struct Keys {
  std::vector<std::string> names;  ///< the string keys, sorted
  std::size_t length = 0;          ///< there is a value for each of 1, ..., length
  std::string odd;                 ///< the fault of another key, "" for none
};

/// A stack slot of a call; valid until that call returns. Reading never converts between types: a script that writes
/// "3" in place of a number gets an error.
class Value {
 public:
  Value(lua_State* state, int index) : state_(state), index_(index) {}

  [[nodiscard]] Type type() const;
  /// Whether there is a value: neither nil nor beyond the arguments.
  [[nodiscard]] bool given() const;
  /// Whether it is a number that Lua stores as an integer.
  [[nodiscard]] bool is_integer() const;

  [[nodiscard]] std::optional<bool> boolean() const;
  /// A NaN has no sign: its sign depends on the machine and would be visible in messages.
  [[nodiscard]] std::optional<double> number() const;
  /// Integers, and floats with an integral value.
  [[nodiscard]] std::optional<std::int64_t> integer() const;
  [[nodiscard]] std::optional<std::string> string() const;
  /// Returns the object, nullptr for another type.
  template <class T>
  [[nodiscard]] const T* get() const {
    const auto* boxed = dynamic_cast<const Boxed<T>*>(object());
    return boxed != nullptr ? &boxed->value : nullptr;
  }
  /// Describes it for messages: "a guide", "a table", "3.5", "\"abc\"", "nothing".
  /// \throws FailedValue for a value that a mistake left without a value
  [[nodiscard]] std::string describe() const;
  /// Returns the result of tostring.
  [[nodiscard]] std::string text() const;

  // Of a table. Reading is raw: it calls no metamethods.
  [[nodiscard]] Keys keys() const;
  [[nodiscard]] Value field(const std::string& name) const;
  /// Calls `visit` with each of the values 1, ..., length and its number.
  void each(const std::function<void(std::size_t, Value)>& visit) const;
  /// Calls `visit` with each key and its value, in no particular order. `visit` must not change the table.
  void each_pair(const std::function<void(Value, Value)>& visit) const;
  /// Returns Object::number; 0 for another type.
  [[nodiscard]] std::uint64_t object_number() const;
  /// Equal only for the same table, object or function.
  [[nodiscard]] const void* identity() const;

  [[nodiscard]] int index() const { return index_; }
  [[nodiscard]] lua_State* state() const { return state_; }

 private:
  [[nodiscard]] const Object* object() const;

  lua_State* state_;
  int index_;
};

}  // namespace trellis::lua
