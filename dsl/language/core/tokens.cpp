// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/tokens.hpp>

#include <algorithm>
#include <array>
#include <cctype>

namespace trellis::dsl {

namespace {

bool letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

bool keyword(std::string_view word) {
  constexpr std::array<std::string_view, 22> words = {
      "and", "break", "do",  "else", "elseif", "end",    "false",  "for",  "function", "goto",  "if",
      "in",  "local", "nil", "not",  "or",     "repeat", "return", "then", "true",     "until", "while"};
  return std::find(words.begin(), words.end(), word) != words.end();
}

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  std::vector<Token> scan() {
    while (true) {
      while (at_ < text_.size() && blank(text_[at_])) ++at_;
      if (at_ >= text_.size()) return std::move(tokens_);
      next();
    }
  }

 private:
  [[nodiscard]] bool follows(std::string_view what, std::size_t from) const {
    return text_.substr(std::min(from, text_.size())).starts_with(what);
  }

  /// Returns the number of '=' between the brackets that open a long string at `from`; none if there is no such
  /// bracket.
  [[nodiscard]] std::size_t long_bracket(std::size_t from) const {
    if (!follows("[", from)) return std::string_view::npos;
    std::size_t level = 0;
    while (follows("=", from + 1 + level)) ++level;
    return follows("[", from + 1 + level) ? level : std::string_view::npos;
  }

  void add(Token::Kind kind, std::size_t end, bool unfinished = false) {
    tokens_.push_back({kind, text_.substr(at_, end - at_), at_, unfinished});
    at_ = end;
  }

  void add_long(Token::Kind kind, std::size_t open, std::size_t level) {
    const std::string close = "]" + std::string(level, '=') + "]";
    const std::size_t end = text_.find(close, open + level + 2);
    const bool unfinished = end == std::string_view::npos;
    add(kind, unfinished ? text_.size() : end + close.size(), unfinished);
  }

  void add_quoted() {
    const char quote = text_[at_];
    for (std::size_t end = at_ + 1; end < text_.size(); ++end) {
      if (text_[end] == '\\') {
        ++end;
      } else if (text_[end] == quote) {
        add(Token::Kind::string, end + 1);
        return;
      } else if (text_[end] == '\n') {
        break;  // error: a string ends on its line
      }
    }
    const std::size_t line = std::min(text_.find('\n', at_), text_.size());
    add(Token::Kind::string, line, line == text_.size());
  }

  void next() {
    constexpr std::array<std::string_view, 10> symbols = {"...", "..", "==", "~=", "<=", ">=", "//", "::", "<<", ">>"};
    const char c = text_[at_];
    if (letter(c)) {
      std::size_t end = at_;
      while (end < text_.size() && (letter(text_[end]) || digit(text_[end]))) ++end;
      add(keyword(text_.substr(at_, end - at_)) ? Token::Kind::keyword : Token::Kind::name, end);
    } else if (digit(c)) {
      std::size_t end = at_;
      while (end < text_.size() && (letter(text_[end]) || digit(text_[end]) || text_[end] == '.')) {
        // 1..2 is no number, but the author means `1 ..`.
        if (follows("..", end)) break;
        ++end;
      }
      add(Token::Kind::number, end);
    } else if (follows("--", at_)) {
      const std::size_t level = long_bracket(at_ + 2);
      if (level != std::string_view::npos) {
        add_long(Token::Kind::comment, at_ + 2, level);
      } else {
        const std::size_t end = std::min(text_.find('\n', at_), text_.size());
        add(Token::Kind::comment, end, end == text_.size());
      }
    } else if (const std::size_t level = long_bracket(at_); level != std::string_view::npos) {
      add_long(Token::Kind::string, at_, level);
    } else if (c == '"' || c == '\'') {
      add_quoted();
    } else {
      const auto* symbol =
          std::find_if(symbols.begin(), symbols.end(), [&](std::string_view s) { return follows(s, at_); });
      add(Token::Kind::symbol, at_ + (symbol == symbols.end() ? 1 : symbol->size()));
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<Token> tokens_;
};

}  // namespace

std::vector<Token> tokens(std::string_view text) { return Scanner(text).scan(); }

std::vector<std::string> locals_outside(std::string_view text) {
  std::vector<std::string> names;
  const std::vector<Token> all = tokens(text);
  int depth = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].kind != Token::Kind::keyword) continue;
    const std::string_view word = all[i].text;
    if (word == "local" && depth == 0) {
      // local function f, or local a <const>, b = ...
      for (std::size_t k = i + 1; k < all.size(); ++k) {
        if (all[k].text == "function") continue;
        if (all[k].kind != Token::Kind::name) break;
        names.emplace_back(all[k].text);
        if (k + 3 < all.size() && all[k + 1].text == "<") k += 3;
        if (k + 1 >= all.size() || all[k + 1].text != ",") break;
        ++k;
      }
    }
    if (word == "function" || word == "do" || word == "if" || word == "repeat") ++depth;
    if (word == "end" || word == "until") --depth;
  }
  return names;
}

}  // namespace trellis::dsl
