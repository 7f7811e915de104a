// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <dsl/lua/value.hpp>
#include <trellis/base/error.hpp>

namespace trellis::lua {

class Stack;

/// One mistake of a script.
struct Mistake {
  std::string script;  ///< "" if no line is known
  int line = 0;
  std::string message;  ///< with its position as a prefix
};

/// All mistakes of one script, one line of the message for each.
class Mistakes : public Error {
 public:
  /// Sorts the mistakes of each file by line. \param script  the file whose mistakes come first
  Mistakes(std::vector<Mistake> mistakes, const std::string& script);

  /// The messages, in order; of very many the first, and a line on the others.
  [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }
  /// How many there are.
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  explicit Mistakes(std::vector<std::string> messages);

  std::size_t count_;
  std::vector<std::string> messages_;
};

/// Several faults of one call. Its message is the first of them.
class SeveralFaults : public Error {
 public:
  explicit SeveralFaults(std::vector<std::string> messages) : Error(messages.front()), messages_(std::move(messages)) {}
  [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }

 private:
  std::vector<std::string> messages_;
};

/// An Error of a call whose result has a field that says whether there was a fault: `problem { ... }.valid`. Where the
/// Error is recorded, the field is false, and a script that reads it has dealt with the fault: the record is withdrawn.
class DeniedError : public Error {
 public:
  DeniedError(std::string field, const std::string& message) : Error(message), field_(std::move(field)) {}
  [[nodiscard]] const std::string& field() const { return field_; }

 private:
  std::string field_;
};

/// A call received a value that an earlier mistake left without a value. That mistake has been recorded: nothing else
/// is.
class FailedValue : public std::exception {
 public:
  FailedValue() = default;
  /// Of a DeniedError. \param mistake  as it was recorded
  FailedValue(std::string field, Mistake mistake)
      : denial_(std::make_shared<Denial>(Denial{std::move(field), std::move(mistake)})) {}

  /// Whether the field is the one that says that there was a fault; then returns the mistake, to withdraw it, else
  /// null.
  [[nodiscard]] const Mistake* denied_by(const std::optional<std::string>& field) const;
  void withdraw() const { denial_->withdrawn = true; }
  /// \throws Located for a mistake that was withdrawn, since a script uses the value all the same
  void insist() const;

  [[nodiscard]] const char* what() const noexcept override { return "a value that could not be made"; }

 private:
  struct Denial {
    std::string field;
    Mistake mistake;
    bool withdrawn = false;
  };
  std::shared_ptr<Denial> denial_;
};

template <>
struct TypeName<FailedValue> {
  static constexpr const char* value = "value that could not be made";
};

/// An Error that ends the script, because what follows depends on the call's result.
class EndingError : public Error {
 public:
  using Error::Error;
};

/// Collects the faults of one call, so that one that follows another is not hidden by it.
class Faults {
 public:
  /// Calls `body` and records its Error. Returns whether there was none.
  bool attempt(const std::function<void()>& body);
  void add(std::string message) { messages_.push_back(std::move(message)); }
  [[nodiscard]] bool none() const { return messages_.empty() && !failed_value_; }
  /// \throws Error, SeveralFaults or FailedValue if `attempt` recorded one.
  void raise() const;

 private:
  std::vector<std::string> messages_;
  bool failed_value_ = false;
};

/// Declares the type of the value that a call with a mistake returns: every operation with it gives another such value,
/// as a list it has one element, and Value::describe throws FailedValue for it.
void declare_failed_value(Stack& stack);

}  // namespace trellis::lua
