// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/tools/completion.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/tools/words.hpp>

namespace trellis::dsl {

namespace {

constexpr std::array<std::string_view, 22> keywords = {
    "and", "break", "do",  "else", "elseif", "end",    "false",  "for",  "function", "goto",  "if",
    "in",  "local", "nil", "not",  "or",     "repeat", "return", "then", "true",     "until", "while"};

enum class Lexeme { name, number, string, symbol };

struct Token {
  Lexeme kind = Lexeme::symbol;
  std::string_view text;  ///< of a string: the text between the quotes
  std::size_t begin = 0;
};

bool letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Tokenises a script up to the cursor.
class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {
    while (at_ < text_.size() && !unfinished_) step();
  }

  [[nodiscard]] const std::vector<Token>& tokens() const { return tokens_; }
  /// Whether the text ends inside a comment or a string in long brackets.
  [[nodiscard]] bool hidden() const { return unfinished_ && !open_string_; }
  /// Returns the position after the opening quote of an unfinished string at the end.
  [[nodiscard]] std::optional<std::size_t> open_string() const { return open_string_; }

 private:
  void step() {
    const char c = text_[at_];
    const std::string_view rest = text_.substr(at_);
    if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      ++at_;
    } else if (rest.starts_with("--")) {
      at_ += 2;
      if (!long_bracket(false)) line_comment();
    } else if (letter(c)) {
      take(Lexeme::name, [](char x) { return letter(x) || digit(x); });
    } else if (digit(c) || (c == '.' && rest.size() > 1 && digit(rest[1]))) {
      // 0.7 .. a needs the space in Lua too; the sign of an exponent is not part of the token here, which has no
      // effect.
      take(Lexeme::number, [](char x) { return letter(x) || digit(x) || x == '.'; });
    } else if (c == '"' || c == '\'') {
      quoted(c);
    } else if (c == '[' && long_bracket(true)) {
      return;
    } else {
      constexpr std::array<std::string_view, 10> longer = {"...", "..", ">>", "<<", "==", "~=", "<=", ">=", "//", "::"};
      const auto* const found =
          std::find_if(longer.begin(), longer.end(), [&](std::string_view symbol) { return rest.starts_with(symbol); });
      const std::size_t size = found != longer.end() ? found->size() : 1;
      tokens_.push_back({Lexeme::symbol, rest.substr(0, size), at_});
      at_ += size;
    }
  }

  template <class Belongs>
  void take(Lexeme kind, const Belongs& belongs) {
    const std::size_t begin = at_;
    while (at_ < text_.size() && belongs(text_[at_])) ++at_;
    tokens_.push_back({kind, text_.substr(begin, at_ - begin), begin});
  }

  void line_comment() {
    const std::size_t end = text_.find('\n', at_);
    unfinished_ = end == std::string_view::npos;
    at_ = unfinished_ ? text_.size() : end + 1;
  }

  /// Skips [[...]] or [=[...]=] if one begins here.
  bool long_bracket(bool is_token) {
    std::size_t level = at_;
    if (level >= text_.size() || text_[level] != '[') return false;
    do ++level;
    while (level < text_.size() && text_[level] == '=');
    if (level >= text_.size() || text_[level] != '[') return false;
    const std::string close = fmt::format("]{}]", text_.substr(at_ + 1, level - at_ - 1));
    const std::size_t begin = level + 1;
    const std::size_t end = text_.find(close, begin);
    unfinished_ = end == std::string_view::npos;
    if (is_token && !unfinished_) tokens_.push_back({Lexeme::string, text_.substr(begin, end - begin), at_});
    at_ = unfinished_ ? text_.size() : end + close.size();
    return true;
  }

  void quoted(char quote) {
    const std::size_t begin = at_ + 1;
    std::size_t end = begin;
    while (end < text_.size() && text_[end] != quote && text_[end] != '\n') end += text_[end] == '\\' ? 2 : 1;
    if (end >= text_.size()) {
      unfinished_ = true;
      open_string_ = begin;
      return;
    }
    tokens_.push_back({Lexeme::string, text_.substr(begin, end - begin), at_});
    at_ = end + 1;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool unfinished_ = false;
  std::optional<std::size_t> open_string_;
  std::vector<Token> tokens_;
};

bool is(const Token& token, std::string_view symbol) { return token.kind == Lexeme::symbol && token.text == symbol; }

/// Returns "scenes.load" if the tokens before `end` are such a chain, else "".
std::string chain_before(const std::vector<Token>& tokens, std::size_t end) {
  std::string chain;
  while (end > 0 && tokens[end - 1].kind == Lexeme::name) {
    chain = fmt::format("{}{}{}", tokens[--end].text, chain.empty() ? "" : ".", chain);
    if (end == 0 || !is(tokens[end - 1], ".")) return chain;
    --end;
  }
  // Another expression stands before the dot: a call, an index, a string.
  return "";
}

const Word* find_word(const std::string& name) {
  const auto& all = words();
  const auto it = std::find_if(all.begin(), all.end(),
                               [&](const Word& w) { return w.name == name && w.kind != Word::Kind::module; });
  return it != all.end() ? &*it : nullptr;
}

/// The context at the end of the text: the innermost table argument of a word.
struct Place {
  const Word* word = nullptr;
  std::vector<std::string> given;  ///< the names that already have a value
};

/// Returns the context after `end` tokens.
Place place_after(const std::vector<Token>& tokens, std::size_t end) {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < end; ++i) {
    if (is(tokens[i], "{") || is(tokens[i], "(") || is(tokens[i], "[")) {
      open.push_back(i);
    } else if ((is(tokens[i], "}") || is(tokens[i], ")") || is(tokens[i], "]")) && !open.empty()) {
      open.pop_back();
    }
  }
  Place place;
  if (open.empty() || !is(tokens[open.back()], "{")) return place;
  const std::size_t table = open.back();
  open.pop_back();
  std::string chain = chain_before(tokens, table);
  const bool argument = table > 0 && (is(tokens[table - 1], "(") || is(tokens[table - 1], ","));
  if (argument && !open.empty() && is(tokens[open.back()], "(")) chain = chain_before(tokens, open.back());
  place.word = find_word(chain);
  int depth = 0;
  for (std::size_t i = table + 1; i < end; ++i) {
    if (is(tokens[i], "{") || is(tokens[i], "(") || is(tokens[i], "[")) ++depth;
    if (is(tokens[i], "}") || is(tokens[i], ")") || is(tokens[i], "]")) --depth;
    const bool named = depth == 0 && tokens[i].kind == Lexeme::name && i + 1 < end && is(tokens[i + 1], "=");
    if (named) place.given.emplace_back(tokens[i].text);
  }
  return place;
}

/// Returns the option whose value follows the "=" at the end of `end` tokens; nullptr for none.
const Option* option_before(const std::vector<Token>& tokens, std::size_t end) {
  if (end < 2 || !is(tokens[end - 1], "=") || tokens[end - 2].kind != Lexeme::name) return nullptr;
  const Place place = place_after(tokens, end);
  if (place.word == nullptr) return nullptr;
  const auto& options = place.word->options;
  const auto it =
      std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.name == tokens[end - 2].text; });
  return it != options.end() ? &*it : nullptr;
}

void add_globals(std::span<const std::string> names, std::vector<std::string>& all) {
  for (const Word& word : words()) all.push_back(word.name.substr(0, word.name.find('.')));
  for (const auto& name : lua_names()) {
    if (name.find('.') == std::string::npos) all.push_back(name);
  }
  all.insert(all.end(), keywords.begin(), keywords.end());
  all.insert(all.end(), names.begin(), names.end());
}

std::vector<std::string> in_string(const std::vector<Token>& tokens) {
  if (const Option* option = option_before(tokens, tokens.size())) return option->choices;
  std::size_t end = tokens.size();
  if (end > 0 && is(tokens[end - 1], "(")) --end;
  const std::string function = chain_before(tokens, end);
  std::vector<std::string> all;
  if (function == "help") {
    for (const Word& word : words()) all.push_back(word.name);
  } else if (function == "require") {
    all = module_names();
  }
  return all;
}

std::vector<std::string> after_dot(const std::string& table) {
  std::vector<std::string> all;
  const std::string prefix = table + '.';
  for (const Word& word : words()) {
    if (word.module() == table) all.push_back(word.name.substr(prefix.size()));
  }
  for (const auto& name : lua_names()) {
    if (name.starts_with(prefix)) all.push_back(name.substr(prefix.size()));
  }
  return all;
}

/// Returns what `>>` may lead to: guides, planners, functions that return one, and the given names.
std::vector<std::string> composable(std::span<const std::string> names) {
  std::vector<std::string> all(names.begin(), names.end());
  constexpr std::array<std::string_view, 3> types = {"trellis.Guide", "trellis.Planner", "trellis.Strategy"};
  for (const Word& word : words()) {
    const bool made = std::find(types.begin(), types.end(), word.returns) != types.end();
    if (word.kind == Word::Kind::guide || word.kind == Word::Kind::planner) {
      all.push_back(word.name);
    } else if (made) {
      all.push_back(word.name.substr(0, word.name.find('.')));
    }
  }
  return all;
}

/// Returns the words that may follow the first `end` tokens, which do not end in an open string.
/// \param options  set if only an option may follow
std::vector<std::string> following(const std::vector<Token>& tokens, std::size_t end,
                                   std::span<const std::string> names, bool& options) {
  std::vector<std::string> all;
  const Token last = end > 0 ? tokens[end - 1] : Token{};
  if (is(last, ".")) {
    const std::string table = chain_before(tokens, end - 1);
    return table.empty() ? all : after_dot(table);
  }
  if (is(last, ":")) {
    for (const ObjectType& type : object_types()) {
      for (const Field& member : type.members) {
        if (member.type.starts_with("fun(self")) all.push_back(member.name);
      }
    }
    return all;
  }
  if (is(last, ">>")) return composable(names);
  const Place place = place_after(tokens, end);
  if (place.word != nullptr && (is(last, "{") || is(last, ",") || is(last, ";"))) {
    for (const auto& name : place.word->named()) {
      if (std::find(place.given.begin(), place.given.end(), name) == place.given.end()) all.push_back(name);
    }
    options = place.word->element.empty();
    if (options) return all;
  }
  if (const Option* option = option_before(tokens, end)) {
    if (option->type == Option::Type::boolean) return {"false", "true"};
    for (const auto& choice : option->choices) all.push_back(fmt::format("\"{}\"", choice));
    if (!all.empty()) return all;
  }
  add_globals(names, all);
  return all;
}

}  // namespace

Completions completions(std::string_view text, std::span<const std::string> names) {
  const Lexer lexer(text);
  const auto& tokens = lexer.tokens();
  Completions result;
  result.begin = text.size();
  if (lexer.hidden()) return result;
  if (const auto begin = lexer.open_string()) {
    result.begin = *begin;
    result.words = in_string(tokens);
  } else {
    std::size_t end = tokens.size();
    const bool touches = end > 0 && tokens[end - 1].begin + tokens[end - 1].text.size() == text.size();
    if (touches && tokens[end - 1].kind == Lexeme::number) return result;
    if (touches && tokens[end - 1].kind == Lexeme::name) result.begin = tokens[--end].begin;
    result.words = following(tokens, end, names, result.options);
  }
  const std::string_view fragment = text.substr(result.begin);
  std::erase_if(result.words, [&](const std::string& word) { return !word.starts_with(fragment); });
  std::sort(result.words.begin(), result.words.end());
  result.words.erase(std::unique(result.words.begin(), result.words.end()), result.words.end());
  return result;
}

}  // namespace trellis::dsl
