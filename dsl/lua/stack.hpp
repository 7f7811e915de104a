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

/// A C++ function that a script can call: reads its arguments, pushes its results and returns their number. An
/// exception becomes a Lua error: an Error with the script's position as a prefix. Any other exception also ends the
/// script, even if the script catches it, and State::run throws it again.
using Callback = std::function<int(Stack&)>;

using Metamethods = std::vector<std::pair<std::string, Callback>>;

/// An Error whose message already contains the position.
class Located : public Error {
 public:
  using Error::Error;
};

/// A position in a script.
struct Position {
  std::string script;
  int line = 0;

  /// "script.lua:3: ".
  [[nodiscard]] std::string prefix() const;
};

/// The lines of a script that define a function.
struct Definition {
  std::string chunk;  ///< its name as loaded, without the mark of a file: "script.lua", "stdlib/scenes.lua", "input 3"
  bool file = false;  ///< the chunk is a file
  int first = 0;
  int last = 0;
  int parameters = 0;     ///< without "..."
  bool variadic = false;  ///< has "..."
};

/// The view of Lua in one call: its arguments, and a stack for results. At the return of the call, Lua drops all pushed
/// values except the results.
class Stack {
 public:
  explicit Stack(lua_State* state);

  /// How many arguments there are.
  [[nodiscard]] int count() const { return count_; }
  /// Returns argument i, counted from 1; of type `none` beyond the last.
  [[nodiscard]] Value operator[](int i) const;
  [[nodiscard]] Value top() const;
  /// Returns the number of values, arguments included.
  [[nodiscard]] int size() const;
  /// Drops all values above the first `size`.
  void resize(int size);

  /// Returns the line of the user's script: that of the innermost frame outside of the standard library.
  [[nodiscard]] std::optional<Position> where() const;
  /// Returns where a function is defined; none for other values and for functions that are not Lua's.
  [[nodiscard]] std::optional<Definition> definition(Value function);

  void push_nil();
  void push(bool value);
  void push(std::int64_t value);
  void push(double value);
  void push(std::string_view value);
  void push(const char* value) { push(std::string_view(value)); }
  void push(const std::string& value) { push(std::string_view(value)); }
  void push(Value value);
  void push_function(Callback callback);
  /// Pushes an object of a declared type.
  template <class T>
  void push_object(T value) {
    push_object(std::make_unique<Boxed<T>>(std::move(value)), TypeName<T>::value);
  }
  Value push_table();

  /// Pops the top value and appends it to the table.
  void append(Value table);
  /// Pops the top value and sets the table's field.
  void set_field(Value table, const std::string& name);
  /// Sets an element of the table.
  void set_index(Value table, std::size_t i, double value);
  /// Pops the top value and sets an element of the table.
  void set_index(Value table, std::size_t i);
  void set_global(const std::string& name);
  /// Pushes a global, nil for a missing one; calls no metamethod.
  Value push_global(const std::string& name);
  /// Pushes the table of globals.
  Value push_globals();

  /// Pushes an element of a table, or what its metamethod returns.
  Value get(Value table, Value key);
  /// Sets an element of a table, or calls its metamethod.
  void set(Value table, Value key, Value value);

  /// Pushes the table of that name that scripts cannot access, the same one in each call.
  Value push_hidden(const std::string& name);

  /// Compiles a Lua text and pushes its function. `chunk` is "@path" for a user's file, "=name" otherwise. \throws
  /// Located for a syntax error.
  void load(std::string_view text, const std::string& chunk);
  /// The same for a function whose globals are the fields of a hidden table (push_hidden).
  void load_within(const std::string& hidden, std::string_view text, const std::string& chunk);
  /// Calls the function below the top `arguments` values with these; leaves all results.
  void call(int arguments);
  /// The same. \throws Located for an error in it, so that the caller's callback has failed.
  void call_protected(int arguments);

  /// Declares a type. Call it once per type, before the first object. Without a metamethod "__newindex", an assignment
  /// to a field of its objects is an error.
  template <class T>
  void declare(const Metamethods& metamethods) {
    declare(TypeName<T>::value, metamethods);
  }
  /// Gives a table a metatable that scripts cannot access: calls `missing` with the table and a missing key, and
  /// `assigned`, if there is one, with the table, a missing key and the value that the key is to get.
  void on_missing(Value table, Callback missing, Callback assigned = {});
  /// Makes a table a function too: calls `called` with the table and the arguments. Scripts cannot access its
  /// metatable.
  void on_call(Value table, Callback called);

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
