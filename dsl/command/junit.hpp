// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis::command {

/// A scenario as JUnit has it.
struct JunitCase {
  std::string name;
  double seconds = 0.0;
  std::string failure;  ///< what did not hold, a line; "" where all did
  std::string error;    ///< what went wrong instead, "" without
  std::string text;     ///< all that was said of it
};

/// A file of scenarios.
struct JunitSuite {
  std::string name;
  std::vector<JunitCase> cases;
};

/// The document: testsuites, a testsuite for each file, a testcase for each scenario. UTF-8.
std::string junit_text(const std::vector<JunitSuite>& suites);

}  // namespace trellis::command
