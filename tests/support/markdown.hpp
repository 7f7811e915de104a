// SPDX-License-Identifier: GPL-3.0-or-later
// The fenced blocks of a Markdown document, and whether what a program printed is what a document shows.
#pragma once

#include <algorithm>
#include <cctype>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace trellis::test {

/// A fenced block. `mark` is what an HTML comment on the line above its fence says: readers do not see it.
struct Block {
  std::string language;
  std::string mark;
  std::string text;
  int line = 0;  ///< of the fence
};

struct Document {
  std::vector<Block> blocks;
  std::vector<std::string> links;     ///< the targets of its links and pictures
  std::vector<std::string> headings;  ///< as anchors
  std::vector<int> indented;          ///< lines that Markdown takes for code by their indentation alone
};

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The anchor of a heading, as GitHub makes it.
inline std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_') {
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (c == ' ') {
      anchor += '-';
    }
  }
  return anchor;
}

inline Document read_markdown(const std::string& text) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  static const std::regex comment("<!-- (.*) -->");
  Document document;
  Block block;
  bool inside = false;
  std::string above;
  int number = 0;
  for (const std::string& line : lines_of(text)) {
    ++number;
    if (line.starts_with("```")) {
      if (inside) {
        document.blocks.push_back(block);
      } else {
        std::smatch found;
        block = {line.substr(3), std::regex_match(above, found, comment) ? found[1].str() : "", "", number};
      }
      inside = !inside;
    } else if (inside) {
      block.text += line + "\n";
    } else {
      if (line.starts_with("    ") && above.empty()) document.indented.push_back(number);
      if (line.starts_with("#")) document.headings.push_back(anchor_of(line.substr(line.find_first_not_of("# "))));
      for (std::sregex_iterator it(line.begin(), line.end(), link), end; it != end; ++it) {
        document.links.push_back((*it)[1].str());
      }
    }
    above = line;
  }
  return document;
}

/// Normalises a printed text for the comparison: no colours, single blanks between words, rules of one dash; and no
/// times, as they vary: numbers before ' ms' or ' s', and those under a heading 'ms' or 'time'.
inline std::vector<std::string> comparable(const std::string& text) {
  static const std::regex colour("\x1b\\[[0-9;?]*[A-Za-z]|\r");
  static const std::regex time(R"([0-9]+(\.[0-9]+)?(e-?[0-9]+)? (ms|s)\b)");
  static const std::regex blanks(" +");
  static const std::regex rule("(─|━)+");
  const auto place = [](const std::string& line, std::size_t end) {  // in characters
    return std::count_if(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(end),
                         [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
  };
  // Returns where headings of times end, in a line of headings: "ms", "time" or "Lua %" among words without digits,
  // ignoring brackets.
  const auto ends_of_headings = [&place](const std::string& line) -> std::vector<std::ptrdiff_t> {
    static const std::regex brackets(R"(\[[^\]]*\])");
    if (std::regex_replace(line, brackets, "").find_first_of("0123456789") != std::string::npos) return {};
    std::vector<std::ptrdiff_t> ends;
    for (const std::string heading : {" ms", " time", " Lua %"}) {
      const auto at = line.find(heading);
      if (at == std::string::npos) continue;
      const std::size_t end = at + heading.size();
      if (end == line.size() || line[end] == ' ') ends.push_back(place(line, end));
    }
    return ends;
  };
  std::vector<std::string> result;
  std::vector<std::ptrdiff_t> columns;  // where the numbers of columns of times end
  for (const std::string& raw : lines_of(text)) {
    const auto erased = raw.rfind("\r\x1b[K");  // drawn by a progress bar
    std::string line = std::regex_replace(erased == std::string::npos ? raw : raw.substr(erased), colour, "");
    line.erase(line.find_last_not_of(' ') + 1);
    if (line.empty() || line == "...") columns.clear();  // what dots stand for ends with a table
    if (auto ends = ends_of_headings(line); !ends.empty()) {
      columns = std::move(ends);
    } else {
      // From the right, because the text that replaces a number may be longer.
      for (std::size_t end = columns.empty() ? 0 : line.size(); end-- > 0;) {
        const bool last = std::isdigit(static_cast<unsigned char>(line[end])) != 0 &&
                          (end + 1 == line.size() || line[end + 1] == ' ');
        if (!last || std::find(columns.begin(), columns.end(), place(line, end + 1)) == columns.end()) continue;
        const auto begin = line.find_last_of(' ', end) + 1;
        line.replace(begin, end + 1 - begin, "TIME");
        end = begin;
      }
    }
    line = std::regex_replace(line, time, "TIME");
    line = std::regex_replace(line, rule, "─");
    result.push_back(std::regex_replace(line, blanks, " "));
  }
  while (!result.empty() && result.back().empty()) result.pop_back();
  return result;
}

/// Whether `line` is `shown`, in which '...' stands for any text.
inline bool shows_line(std::string shown, const std::string& line) {
  std::size_t at = 0;
  bool first = true;
  for (std::size_t gap = shown.find("..."); gap != std::string::npos; gap = shown.find("...")) {
    const auto found = line.find(shown.substr(0, gap), at);
    if (found == std::string::npos || (first && found != 0)) return false;
    at = found + gap;
    shown.erase(0, gap + 3);
    first = false;
  }
  return first ? shown == line : line.size() >= at + shown.size() && line.ends_with(shown);
}

/// Whether the output `printed` of a program matches the `shown` text of a document. A line '...' matches any number of
/// lines, '...' within a line any text.
inline bool shows(const std::string& shown, const std::string& printed) {
  const auto expected = comparable(shown);
  const auto actual = comparable(printed);
  // reached[j]: the lines of `expected` so far match the first j of `actual`.
  std::vector<bool> reached(actual.size() + 1, false);
  reached[0] = true;
  for (const std::string& line : expected) {
    std::vector<bool> next(actual.size() + 1, false);
    const bool any =
        line.find_first_not_of(' ') != std::string::npos && line.substr(line.find_first_not_of(' ')) == "...";
    for (std::size_t j = 0; j <= actual.size(); ++j) {
      if (any) {
        next[j] = reached[j] || (j > 0 && next[j - 1]);
      } else if (j > 0) {
        next[j] = reached[j - 1] && shows_line(line, actual[j - 1]);
      }
    }
    reached = next;
  }
  return reached.back();
}

}  // namespace trellis::test
