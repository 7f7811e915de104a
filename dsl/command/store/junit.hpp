// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis::command {

/// The result of a scenario in JUnit's terms.
struct JunitCase {
  std::string name;
  double seconds = 0.0;
  std::string failure;  ///< the failed expectation, a line; "" for none
  std::string error;    ///< the error, "" for none
  std::string text;     ///< the complete output
};

/// A file of scenarios.
struct JunitSuite {
  std::string name;
  std::vector<JunitCase> cases;
};

/// The document: testsuites, a testsuite for each file, a testcase for each scenario. UTF-8.
std::string junit_text(const std::vector<JunitSuite>& suites);

}  // namespace trellis::command
