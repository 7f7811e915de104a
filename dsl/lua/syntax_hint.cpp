// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/syntax_hint.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <utility>
#include <vector>

namespace trellis::lua {

namespace {

bool blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
bool part_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Returns the line that the message names, counted from 1; 0 if it names none.
std::size_t line_of(std::string_view message) {
  for (std::size_t at = message.find(':'); at != std::string_view::npos; at = message.find(':', at + 1)) {
    std::size_t end = at + 1;
    while (end < message.size() && std::isdigit(static_cast<unsigned char>(message[end])) != 0) ++end;
    if (end == at + 1 || end >= message.size() || message[end] != ':') continue;
    return static_cast<std::size_t>(
        std::strtoul(std::string(message.substr(at + 1, end - at - 1)).c_str(), nullptr, 10));
  }
  return 0;
}

/// Returns a line without strings, comments and the blanks around it.
std::string code_of(std::string_view line) {
  std::string code;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line.substr(i).starts_with("--")) break;
    if (line[i] != '"' && line[i] != '\'') {
      code += line[i];
      continue;
    }
    const char quote = line[i];
    for (++i; i < line.size() && line[i] != quote; ++i) {
      if (line[i] == '\\') ++i;
    }
    code += "\"\"";
  }
  while (!code.empty() && blank(code.back())) code.pop_back();
  const auto begin = std::find_if_not(code.begin(), code.end(), blank);
  code.erase(code.begin(), begin);
  return code;
}

/// Whether `code` contains `word` as a whole word, from `from` on.
bool has_word(std::string_view code, std::string_view word) {
  for (std::size_t at = code.find(word); at != std::string_view::npos; at = code.find(word, at + 1)) {
    const bool begins = at == 0 || !part_of_word(code[at - 1]);
    const std::size_t end = at + word.size();
    if (begins && (end == code.size() || !part_of_word(code[end]))) return true;
  }
  return false;
}

bool starts_with_word(std::string_view code, std::string_view word) {
  return code.starts_with(word) && (code.size() == word.size() || !part_of_word(code[word.size()]));
}

/// The lines up to one, the last first, without strings and comments; empty ones are left out.
std::vector<std::string> lines_before(std::string_view text, std::size_t line) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < line && !text.empty(); ++i) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string code = code_of(text.substr(0, end));
    if (!code.empty() || i + 1 == line) lines.push_back(std::move(code));
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  std::reverse(lines.begin(), lines.end());
  return lines;
}

/// Whether words follow '//', and so no divisor: '1 // a comment'.
bool has_foreign_comment(std::string_view code) {
  const std::size_t at = code.find("//");
  if (at == std::string_view::npos) return false;
  std::string_view rest = code.substr(at + 2);
  const auto skip = [&](const auto& belongs) {
    std::size_t size = 0;
    while (size < rest.size() && belongs(rest[size])) ++size;
    rest.remove_prefix(size);
    return size > 0;
  };
  skip(blank);
  return skip(part_of_word) && skip(blank) && !rest.empty() && part_of_word(rest.front());
}

/// Hints that the line itself gives, and the `looked_at` - 1 lines before.
std::string hint_of_code(const std::vector<std::string>& lines, std::size_t looked_at) {
  for (std::size_t i = 0; i < std::min(lines.size(), looked_at); ++i) {
    const std::string& code = lines[i];
    if (has_word(code, "continue")) {
      return "; Lua has no 'continue': write 'goto continue', and '::continue::' before the loop's 'end'";
    }
    constexpr std::array<std::pair<const char*, const char*>, 5> blocks = {
        {{"for", "for i = 1, 3 do ... end"},
         {"while", "while a do ... end"},
         {"if", "if a then ... end"},
         {"elseif", "if a then ... elseif b then ... end"},
         {"else", "if a then ... else ... end"}}};
    for (const auto& [word, written] : blocks) {
      if (starts_with_word(code, word) && code.find('{') != std::string::npos) {
        return fmt::format("; Lua has no blocks in braces: write {}", written);
      }
    }
    if (has_word(code, "function") && code.ends_with('{')) {
      return "; Lua has no blocks in braces: write function f(a) ... end";
    }
    if (has_foreign_comment(code)) return "; a comment begins with '--' in Lua";
  }
  if (lines.empty()) return "";
  const std::string& code = lines.front();
  if (code.find("//") != std::string::npos || code.find("/*") != std::string::npos || code.starts_with('#')) {
    return "; a comment begins with '--' in Lua";
  }
  for (const auto& [word, written] : {std::pair{"else if", "'elseif'"},
                                      {"elif", "'elseif'"},
                                      {"elsif", "'elseif'"},
                                      {"var", "'local x = 1'"},
                                      {"let", "'local x = 1'"},
                                      {"const", "'local x <const> = 1'"},
                                      {"def", "'function f(a) ... end'"}}) {
    if (starts_with_word(code, word)) return fmt::format("; Lua writes {} where others write '{}'", written, word);
  }
  return "";
}

}  // namespace

std::string syntax_hint(std::string_view message, std::string_view text, bool in_session) {
  const auto says = [&](std::string_view words) { return message.find(words) != std::string_view::npos; };
  if (says("<eof>")) {
    std::string hint = in_session ? "" : hint_of_code(lines_before(text, line_of(message)), text.size());
    return hint.find("braces") != std::string::npos ? hint : "";
  }
  if (says("near '!'")) return "; Lua writes ~= for 'not equal', and not x for the opposite of x";
  if (says("near '&'")) return "; Lua writes 'and'";
  if (says("near '|'")) return "; Lua writes 'or'";
  if (says("near '?'")) return "; Lua has no 'a ? b : c': write 'a and b or c', or if a then ... else ... end";
  if (says("symbol near '//'") || says("symbol near '/'") || says("symbol near '#'")) {
    return "; a comment begins with '--' in Lua";
  }
  if (says("unexpected symbol near ','"))
    return "; is a value missing before this comma, or is there one comma too many?";
  if (says("syntax error near '+'") || says("unexpected symbol near '+'")) {
    return "; Lua has neither '++' nor '+=': write x = x + 1";
  }
  std::string hint = hint_of_code(lines_before(text, line_of(message)), 2);
  if (!hint.empty()) return hint;
  if ((says("'then' expected") || says("'do' expected")) && says("near '='")) return "; '==' compares, '=' assigns";
  if (says("'}' expected") || says("')' expected")) {
    const std::size_t at = message.rfind("near ");
    return fmt::format("; is a comma missing before {}?", message.substr(at + std::string_view("near ").size()));
  }
  return "";
}

}  // namespace trellis::lua
