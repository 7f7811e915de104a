// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/store/junit.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace trellis::command {

namespace {

/// Returns the length of the UTF-8 character at the beginning of the text; 0 if it is invalid or not allowed in XML.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80U) return first >= 0x20U || first == '\n' || first == '\t' ? 1 : 0;
  const std::size_t length = first >= 0xF0U ? 4 : first >= 0xE0U ? 3 : 2;
  if (first < 0xC2U || first > 0xF4U || text.size() < length) return 0;
  unsigned code = first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
    code = code << 6U | (byte(i) & 0x3FU);
  }
  const bool surrogate = code >= 0xD800U && code <= 0xDFFFU;
  const bool too_long = (length == 3 && code < 0x800U) || (length == 4 && code < 0x10000U);
  return surrogate || too_long || code > 0x10FFFFU || code == 0xFFFEU || code == 0xFFFFU ? 0 : length;
}

/// Replaces characters that XML does not allow by U+FFFD.
std::string escaped(std::string_view text) {
  std::string all;
  while (!text.empty()) {
    const std::size_t length = character(text);
    if (length == 0) {
      all += "\xEF\xBF\xBD";
    } else if (text[0] == '&') {
      all += "&amp;";
    } else if (text[0] == '<') {
      all += "&lt;";
    } else if (text[0] == '>') {
      all += "&gt;";
    } else if (text[0] == '"') {
      all += "&quot;";
    } else {
      all += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  return all;
}

/// XML would turn line breaks in an attribute into spaces.
std::string attribute(std::string_view text) {
  std::string all;
  for (const char c : escaped(text)) all += c == '\n' ? std::string("&#10;") : c == '\t' ? "&#9;" : std::string(1, c);
  return all;
}

std::string case_text(const JunitSuite& suite, const JunitCase& one) {
  std::string text = fmt::format(R"(    <testcase name="{}" classname="{}" time="{:.3f}">)", attribute(one.name),
                                 attribute(suite.name), one.seconds);
  text += '\n';
  for (const auto& [tag, message] : {std::pair{"failure", &one.failure}, {"error", &one.error}}) {
    if (message->empty()) continue;
    text += fmt::format("      <{} message=\"{}\">{}</{}>\n", tag, attribute(*message), escaped(one.text), tag);
  }
  if (one.failure.empty() && one.error.empty() && !one.text.empty()) {
    text += fmt::format("      <system-out>{}</system-out>\n", escaped(one.text));
  }
  return text + "    </testcase>\n";
}

std::string counts(const std::vector<const JunitCase*>& cases) {
  const auto count = [&](std::string JunitCase::*message) {
    return std::count_if(cases.begin(), cases.end(), [&](const JunitCase* one) { return !(one->*message).empty(); });
  };
  double seconds = 0.0;
  for (const JunitCase* one : cases) seconds += one->seconds;
  return fmt::format(R"(tests="{}" failures="{}" errors="{}" time="{:.3f}")", cases.size(), count(&JunitCase::failure),
                     count(&JunitCase::error), seconds);
}

}  // namespace

std::string junit_text(const std::vector<JunitSuite>& suites) {
  std::vector<const JunitCase*> all;
  std::string body;
  for (const JunitSuite& suite : suites) {
    std::vector<const JunitCase*> own;
    own.reserve(suite.cases.size());
    for (const JunitCase& one : suite.cases) own.push_back(&one);
    all.insert(all.end(), own.begin(), own.end());
    body += fmt::format("  <testsuite name=\"{}\" {}>\n", attribute(suite.name), counts(own));
    for (const JunitCase& one : suite.cases) body += case_text(suite, one);
    body += "  </testsuite>\n";
  }
  return fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {}>\n{}</testsuites>\n", counts(all),
                     body);
}

}  // namespace trellis::command
