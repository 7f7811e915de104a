// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of script in tests.
#pragma once

#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>

#include "support/fault.hpp"

namespace trellis::test {

/// Returns the results of a piece of script, as texts.
inline std::vector<std::string> values(const std::string& text, const dsl::SessionOptions& options = {}) {
  return dsl::Session("", options).evaluate(text, "test.lua");
}

/// Returns the single result of an expression, as text.
inline std::string value(const std::string& expression, const dsl::SessionOptions& options = {}) {
  const auto all = values("return " + expression, options);
  return all.size() == 1 ? all.front() : "not one value but " + std::to_string(all.size());
}

/// Returns the message of a script that fails, "" if it succeeds.
inline std::string failure(const std::string& text, const dsl::SessionOptions& options = {}) {
  return fault_of([&] { values(text, options); });
}

}  // namespace trellis::test
