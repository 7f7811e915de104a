// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <unordered_set>
#include <vector>

#include <trellis/base/error.hpp>

namespace trellis {

/// Several faults of one input. Its message has a line for each of the first ones.
class Errors : public Error {
 public:
  explicit Errors(std::vector<std::string> messages);

  /// All messages, without a limit.
  [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }

 private:
  std::vector<std::string> messages_;
};

/// Returns the first messages, and of very many a line with the number of the others.
std::vector<std::string> shortened(std::vector<std::string> messages);

/// Collects the faults of an input, so that a reader reports all of them.
class ErrorList {
 public:
  /// Calls `read` and records its Error. Returns whether there was none.
  bool attempt(const std::function<void()>& read);
  void add(const Error& error);
  [[nodiscard]] bool empty() const { return messages_.empty(); }
  /// \throws Error for one fault, Errors for several
  void raise() const;

 private:
  std::vector<std::string> messages_;
  std::unordered_set<std::string> there_;  ///< the same messages
};

}  // namespace trellis
