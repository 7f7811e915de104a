// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <dsl/lua/value.hpp>
#include <trellis/base/error.hpp>

namespace trellis::lua {

class Stack;

/// A C++ function that a script can call: reads its arguments, pushes its results and returns their number. What it
/// throws becomes a Lua error: an Error with the script's position in front; any other exception also ends the whole
/// script, whatever the script catches, and is thrown again where State::run was called.
using Callback = std::function<int(Stack&)>;

using Metamethods = std::vector<std::pair<std::string, Callback>>;

/// An Error whose message already says where.
class Located : public Error {
 public:
  using Error::Error;
};

/// Where a script is.
struct Position {
  std::string script;
  int line = 0;

  /// "script.lua:3: ".
  [[nodiscard]] std::string prefix() const;
};

/// The view that one call has of Lua: its arguments, and a place to push results on. What is pushed goes when the call
/// returns, except the results.
class Stack {
 public:
  explicit Stack(lua_State* state);

  /// How many arguments there are.
  [[nodiscard]] int count() const { return count_; }
  /// Argument i, counted from 1; of type `none` beyond the last.
  [[nodiscard]] Value operator[](int i) const;
  [[nodiscard]] Value top() const;
  /// How many values there are, arguments included.
  [[nodiscard]] int size() const;
  /// Drops all values above the first `size`.
  void resize(int size);

  /// The line of the user's script that led here: the innermost frame that is not of the standard library.
  [[nodiscard]] std::optional<Position> where() const;

  void push_nil();
  void push(bool value);
  void push(std::int64_t value);
  void push(double value);
  void push(std::string_view value);
  void push(const char* value) { push(std::string_view(value)); }
  void push(const std::string& value) { push(std::string_view(value)); }
  void push(Value value);
  void push_function(Callback callback);
  /// An object of a type that was declared.
  template <class T>
  void push_object(T value) {
    push_object(std::make_unique<Boxed<T>>(std::move(value)), TypeName<T>::value);
  }
  Value push_table();

  /// Takes the top value off and puts it at the end of the table.
  void append(Value table);
  /// Takes the top value off and sets the table's field.
  void set_field(Value table, const std::string& name);
  /// Sets an element of the table.
  void set_index(Value table, std::size_t i, double value);
  void set_global(const std::string& name);
  /// Pushes a global, nil where there is none; asks no metamethod.
  Value push_global(const std::string& name);
  /// Pushes the table of globals.
  Value push_globals();

  /// Pushes a table of that name that scripts do not reach, the same one each time.
  Value push_hidden(const std::string& name);

  /// Pushes the function that a text in Lua stands for. `chunk` is "@path" for a user's file, "=name" otherwise.
  /// Throws Located for a syntax error.
  void load(std::string_view text, const std::string& chunk);
  /// Calls the function below the top `arguments` values with these; leaves the results, all of them.
  void call(int arguments);

  /// Makes a type known. Each type once, before the first object.
  template <class T>
  void declare(const Metamethods& metamethods) {
    declare(TypeName<T>::value, metamethods);
  }
  /// Gives a table a metatable out of the script's reach: `missing` is called with the table and a key that it lacks.
  void on_missing(Value table, Callback missing);

  // One result.
  template <class T>
  int result(T&& value) {
    using Plain = std::remove_cvref_t<T>;
    if constexpr (std::same_as<Plain, bool> || std::same_as<Plain, double> || std::same_as<Plain, std::int64_t> ||
                  std::convertible_to<T, std::string_view>) {
      push(value);
    } else {
      push_object(Plain(std::forward<T>(value)));
    }
    return 1;
  }

  [[nodiscard]] lua_State* state() const { return state_; }

 private:
  void push_object(std::unique_ptr<Object> object, const char* type);
  void declare(const char* type, const Metamethods& metamethods);

  lua_State* state_;
  int count_;
};

}  // namespace trellis::lua
