// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/repl/source_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include <dsl/command/repl/verbs.hpp>
#include <dsl/language/core/tokens.hpp>
#include <dsl/language/core/types.hpp>
#include <dsl/language/words/algebra.hpp>
#include <dsl/language/words/scene_values.hpp>
#include <trellis/base/error.hpp>
#include <trellis/memory/identity.hpp>

namespace trellis::command {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

bool compiles(Stack& stack, const std::string& text) {
  const int before = stack.size();
  bool good = true;
  try {
    stack.load(text, "=input");
  } catch (const lua::Located&) {
    good = false;
  }
  stack.resize(before);
  return good;
}

/// The depth of a token within brackets and blocks, as a scan from the first token goes.
class Depth {
 public:
  /// Returns the depth before the token, and advances behind it.
  int before(const dsl::Token& token) {
    const int at = brackets_ + blocks_;
    const std::string_view text = token.text;
    if (token.kind == dsl::Token::Kind::symbol) {
      if (text == "(" || text == "{" || text == "[") ++brackets_;
      if (text == ")" || text == "}" || text == "]") --brackets_;
    } else if (token.kind == dsl::Token::Kind::keyword) {
      // `for` and `while` have a `do`.
      if (text == "function" || text == "do" || text == "if" || text == "repeat") ++blocks_;
      if (text == "end" || text == "until") --blocks_;
      // The head of a loop belongs to its block.
      if (text == "for" || text == "while") ++heads_;
      if (text == "do" && heads_ > 0) --heads_;
    }
    return at + (heads_ > 0 && text != "for" && text != "while" ? 1 : 0);
  }

 private:
  int brackets_ = 0;
  int blocks_ = 0;
  int heads_ = 0;
};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n;");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\n;") - first + 1);
}

/// The name that the user gave an obstacle; "" where it has none.
std::string given_name(const std::string& obstacle) {
  const auto open = obstacle.find('(');
  std::string name = obstacle;
  if (obstacle.starts_with("obstacle ") && obstacle.ends_with(')') && open != std::string::npos) {
    name = obstacle.substr(open + 1, obstacle.size() - open - 2);
  }
  const bool made = name.starts_with("box ") || name.starts_with("disc ") || name.starts_with("polygon ");
  return made ? "" : name;
}

std::string numbers(const std::vector<double>& values) {
  std::vector<std::string> texts;
  texts.reserve(values.size());
  for (const double x : values) texts.push_back(number_source(x));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string world_source(const World& world) {
  const auto& [lo, hi] = world.bounds();
  std::string text = fmt::format("world {{ bounds = {{{}}}", numbers({lo.x, lo.y, hi.x, hi.y}));
  for (const Obstacle& obstacle : world.obstacles()) {
    text += ", ";
    if (const auto* box = std::get_if<Box2>(&obstacle.shape)) {
      text += fmt::format("box {{ {}", numbers({box->lo.x, box->lo.y, box->hi.x, box->hi.y}));
    } else if (const auto* disc = std::get_if<Disc>(&obstacle.shape)) {
      text += fmt::format("disc {{ {}", numbers({disc->centre.x, disc->centre.y, disc->radius}));
    } else {
      text += "polygon { ";
      const auto& vertices = std::get<Polygon>(obstacle.shape).vertices;
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        text += fmt::format("{}{{{}}}", i > 0 ? ", " : "", numbers({vertices[i].x, vertices[i].y}));
      }
    }
    const std::string name = given_name(obstacle.name);
    text += name.empty() ? " }" : fmt::format(", name = {} }}", quoted(name));
  }
  return text + " }";
}

/// Numbers that identify a world and a robot; none for a world of space that has other dimensions.
std::optional<std::uint64_t> hash_of(const dsl::AnyWorld& world, const dsl::AnyRobot& robot, bool of_world) {
  try {
    const auto scene = dsl::make_scene(world, robot);
    return of_world ? world_hash(*scene) : robot_hash(*scene);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else if (std::iscntrl(static_cast<unsigned char>(c)) != 0) {
      out += fmt::format("\\{:03}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string key_text(const std::string& name) {
  const auto all = dsl::tokens(name);
  const bool plain = all.size() == 1 && all.front().kind == dsl::Token::Kind::name && all.front().text == name;
  return plain ? name : fmt::format("[{}]", quoted(name));
}

std::string number_source(double x) {
  if (std::isnan(x)) return "0/0";
  if (std::isinf(x)) return x > 0.0 ? "math.huge" : "-math.huge";
  return fmt::format("{}", x);
}

std::string number_text(double x, int digits) {
  constexpr double exact = 1e15;  // whole numbers below are written out
  if (!std::isfinite(x)) return std::isnan(x) ? "nan" : x > 0.0 ? "inf" : "-inf";
  if (x == std::floor(x) && std::abs(x) < exact) return fmt::format("{:.0f}", x == 0.0 ? 0.0 : x);
  if (std::abs(x) >= std::pow(10.0, digits) && std::abs(x) < exact) return fmt::format("{:.0f}", x);
  std::string text = fmt::format("{:.{}g}", x, digits);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  // 2.5e-07 is 2.5e-7, and 1e+20 is 1e20.
  const bool negative = text[e + 1] == '-';
  std::size_t first = e + 2;
  while (first + 1 < text.size() && text[first] == '0') ++first;
  return text.substr(0, e + 1) + (negative ? "-" : "") + text.substr(first);
}

std::vector<std::string> statements(Stack& stack, const std::string& input) {
  std::vector<std::string> parts;
  if (dsl::locals_outside(input).empty() && compiles(stack, input)) {
    const auto all = dsl::tokens(input);
    Depth depth;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool outside = depth.before(all[i]) == 0;
      using Kind = dsl::Token::Kind;
      if (!outside || i == 0 || (all[i].kind != Kind::name && all[i].kind != Kind::keyword)) continue;
      const std::string statement = input.substr(begin, all[i].begin - begin);
      if (trimmed(statement).empty() || !compiles(stack, statement) || !compiles(stack, input.substr(all[i].begin))) {
        continue;
      }
      parts.push_back(trimmed(statement));
      begin = all[i].begin;
    }
    if (std::string last = trimmed(input.substr(begin)); !last.empty() && !parts.empty()) parts.push_back(last);
  }
  if (parts.empty()) parts.push_back(input);
  return parts;
}

std::vector<std::string> arguments_of_call(const std::string& input, const std::set<std::string>& functions) {
  std::vector<std::string> arguments;
  if (!dsl::locals_outside(input).empty()) return arguments;
  const auto all = dsl::tokens(input);
  Depth depth;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool outside = depth.before(all[i]) == 0;
    const bool field = i > 0 && (all[i - 1].text == "." || all[i - 1].text == ":");
    if (!outside || field || !functions.contains(std::string(all[i].text))) continue;
    if (i + 1 >= all.size() || all[i + 1].text != "(") continue;
    std::vector<std::string> found;
    int level = 0;
    std::size_t begin = all[i + 1].begin + 1;
    for (std::size_t k = i + 1; k < all.size(); ++k) {
      const std::string_view text = all[k].text;
      const bool symbol = all[k].kind == dsl::Token::Kind::symbol;
      if (symbol && (text == "(" || text == "{" || text == "[")) ++level;
      if (symbol && (text == ")" || text == "}" || text == "]")) --level;
      const bool end = level == 0;
      if (!end && (level != 1 || text != ",")) continue;
      if (std::string argument = trimmed(input.substr(begin, all[k].begin - begin)); !argument.empty()) {
        found.push_back(std::move(argument));
      }
      begin = all[k].begin + 1;
      if (end) break;
    }
    arguments = std::move(found);
  }
  return arguments;
}

std::string scene_call(Stack& stack, const Problem& problem) {
  if (field_path("scenes", problem.name) != "scenes." + problem.name) return "";
  const int before = stack.size();
  std::string found;
  stack.load("return require('scenes')", "=repl");
  stack.call(0);
  const Value function = stack.top().field(problem.name);
  if (function.type() == Type::function) {
    try {
      stack.push(function);
      stack.call_protected(0);
      const auto* made = stack.top().get<Problem>();
      if (made != nullptr && change_of(*made, problem).empty()) found = fmt::format("scenes.{}()", problem.name);
    } catch (const Error&) {  // NOLINT(bugprone-empty-catch): a function that needs arguments makes another problem
    }
  }
  stack.resize(before);
  return found;
}

SourceWriter::SourceWriter(Stack& stack, const std::set<std::string>& lost, const Problem* known,
                           std::string known_text)
    : stack_(stack), lost_(lost), known_(known), known_text_(std::move(known_text)) {}

std::string SourceWriter::text(const Value& value) {
  const int before = stack_.size();
  std::string found;
  if (value.type() == Type::boolean) {
    found = value.text();
  } else if (value.type() == Type::number) {
    found = value.is_integer() ? value.text() : number_source(*value.number());
  } else if (const auto string = value.string()) {
    found = quoted(*string);
  } else if (value.type() == Type::table) {
    found = table(value, 0);
  } else if (const auto strategy = dsl::as_strategy(value)) {
    found = spec(*strategy, [&](const Value& made) { return dsl::as_strategy(made) == strategy; });
  } else if (const auto* guide = value.get<GuideSpec>()) {
    found = spec(*guide, [&](const Value& made) {
      const auto* other = made.get<GuideSpec>();
      return other != nullptr && *other == *guide;
    });
  } else if (const auto* one = value.get<Problem>()) {
    found = problem(*one);
  } else if (dsl::world_in(value)) {
    found = world(value);
  } else if (dsl::robot_in(value)) {
    found = robot(value);
  }
  stack_.resize(before);
  return found;
}

std::string SourceWriter::table(const Value& value, int depth) {
  constexpr int deepest = 20;
  constexpr std::size_t most = 100'000;
  const lua::Keys keys = value.keys();
  if (!keys.odd.empty() || depth > deepest) return "";
  std::vector<std::string> parts;
  bool whole = true;
  const auto add = [&](const std::string& key, const Value& element) {
    if (!whole || ++values_ > most) {
      whole = false;
      return;
    }
    const std::string part = element.type() == Type::table ? table(element, depth + 1) : text(element);
    whole = !part.empty();
    parts.push_back(key + part);
  };
  value.each([&](std::size_t, const Value& element) { add("", element); });
  const int before = stack_.size();
  for (const std::string& name : keys.names) {
    add(key_text(name) + " = ", value.field(name));
    stack_.resize(before);
  }
  if (!whole) return "";
  return parts.empty() ? "{}" : fmt::format("{{{}}}", fmt::join(parts, ", "));
}

template <class Spec>
std::string SourceWriter::spec(const Spec& value, const std::function<bool(const Value&)>& equal) {
  const std::string text = value.text();
  if (!compiles(stack_, "return " + text)) return "";
  try {
    stack_.load_within(typed_environment, "return " + text, "=input");
    stack_.call_protected(0);
  } catch (const Error&) {
    return "";  // a part of a script's own has a text that makes nothing
  }
  return equal(stack_.top()) ? text : "";
}

void SourceWriter::each_problem(const std::function<void(const std::string&, const Problem&)>& visit) {
  if (known_ != nullptr && !known_text_.empty()) visit(known_text_, *known_);
  const int before = stack_.size();
  const Value globals = stack_.push_globals();
  globals.each_pair([&](const Value& key, const Value& value) {
    const auto name = key.string();
    const auto* problem = value.get<Problem>();
    if (name && problem != nullptr && !lost_.contains(*name)) visit(*name, *problem);
  });
  const Value script = globals.field("script");
  if (script.type() == Type::table) {
    const Value problems = script.field("problems");
    if (problems.type() == Type::table) {
      for (const std::string& name : problems.keys().names) {
        if (const auto* problem = problems.field(name).get<Problem>()) {
          visit(field_path("script.problems", name), *problem);
        }
      }
    }
  }
  stack_.resize(before);
}

std::string SourceWriter::problem(const Problem& problem) {
  std::string found;
  each_problem([&](const std::string& text, const Problem& other) {
    if (other.name != problem.name || !change_of(other, problem).empty()) return;
    if (found.empty() || text < found) found = text;
  });
  return found.empty() ? scene_call(stack_, problem) : found;
}

std::string SourceWriter::world(const Value& value) {
  const dsl::AnyWorld world = *dsl::world_in(value);
  std::string found;
  each_problem([&](const std::string& text, const Problem& problem) {
    const auto hash = hash_of(world, dsl::robot_of(*problem.scene), true);
    const bool name = !text.empty() && dsl::tokens(text).size() == 1;
    if (name && hash == world_hash(*problem.scene) && (found.empty() || text < found)) found = text;
  });
  if (!found.empty()) return found + ".world";
  const auto* planar = std::get_if<World>(&world);
  return planar != nullptr ? world_source(*planar) : "";
}

std::string SourceWriter::robot(const Value& value) {
  const dsl::AnyRobot robot = *dsl::robot_in(value);
  std::string found;
  each_problem([&](const std::string& text, const Problem& problem) {
    const auto hash = hash_of(dsl::world_of(*problem.scene), robot, false);
    const bool name = !text.empty() && dsl::tokens(text).size() == 1;
    if (name && hash == robot_hash(*problem.scene) && (found.empty() || text < found)) found = text;
  });
  return found.empty() ? "" : found + ".robot";
}

}  // namespace trellis::command
