// SPDX-License-Identifier: GPL-3.0-or-later
// The registry is complete, and the committed documents match it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/script.hpp"

#include <dsl/language/tools/catalogue.hpp>
#include <dsl/language/tools/reference.hpp>
#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/language/tools/words.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/strategy/combinators.hpp>

namespace fs = std::filesystem;
using namespace trellis;
using Kind = dsl::Word::Kind;

namespace {

std::string content(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Numbers that have no unit: names and the like.
bool is_pure(const std::string& option) { return option == "seed"; }

void check_option(const dsl::Word& word, const Option& option) {
  INFO(word.name << ": " << option.name);
  CHECK_FALSE(option.doc.empty());
  const bool quantity = option.type == Option::Type::number || option.type == Option::Type::integer;
  CHECK((!quantity || !option.unit.empty() || is_pure(option.name)));
  CHECK((option.type != Option::Type::choice || option.choices.size() > 1));
  // The default is a valid value.
  const Component alone{Component::Kind::guide, word.name, "", "", {option}, {}};
  CHECK_NOTHROW(Options::validate(alone, {{option.name, option.default_value}}));
}

}  // namespace

TEST_CASE("every word has a complete description") {
  REQUIRE(dsl::words().size() > 60);
  std::vector<std::string> names;
  for (const dsl::Word& word : dsl::words()) {
    INFO(word.name);
    CHECK(std::find(names.begin(), names.end(), word.name) == names.end());
    names.push_back(word.name);
    CHECK_FALSE(word.summary.empty());
    CHECK_FALSE(word.summary.ends_with('.'));
    if (word.kind < Kind::constructor) CHECK_FALSE(word.source.empty());
    if (word.kind >= Kind::constructor && word.kind != Kind::module) CHECK_FALSE(word.usage.empty());
    if (word.kind != Kind::module && word.name != "help") CHECK_FALSE(word.returns.empty());
    CHECK(word.list.empty() == word.element.empty());
    for (const Option& option : word.options) check_option(word, option);
    for (const auto* fields : {&word.fields, &word.arguments}) {
      for (const dsl::Field& field : *fields) {
        INFO(field.name);
        CHECK_FALSE(field.type.empty());
        CHECK_FALSE(field.expects.empty());
        CHECK_FALSE(field.doc.empty());
      }
    }
    for (const auto& name : word.positional) {
      const auto named = word.named();
      CHECK(std::find(named.begin(), named.end(), name) != named.end());
    }
  }
}

namespace {

void check_claims(const std::string& name, const GuideClaims& claims) {
  INFO(name);
  for (const auto& [title, line] : dsl::claim_lines(claims)) {
    INFO(title);
    CHECK_FALSE(line.empty());
    CHECK_FALSE(line.ends_with('.'));
    CHECK_FALSE(line.ends_with(": "));
    CHECK(line.find('\n') == std::string::npos);
  }
  const std::string example = content(fs::path(TRELLIS_SOURCE) / claims.example);
  INFO(claims.example);
  CHECK_FALSE(example.empty());
  CHECK(claims.example.starts_with("examples/"));
}

}  // namespace

TEST_CASE("every guide says what f and h are, and its example uses it") {
  for (const GuideKind& kind : guide_kinds()) {
    const std::string& name = kind.component->name;
    check_claims(name, kind.claims);
    CHECK(content(fs::path(TRELLIS_SOURCE) / kind.claims.example).find(name) != std::string::npos);
    const std::string help = dsl::help_text("guide." + name);
    CHECK(help.find("no path in S") != std::string::npos);
    CHECK(dsl::catalogue_markdown().find(fmt::format("| [{}](reference.md#{}) |", name, name)) != std::string::npos);
  }
  for (const Combinator& combinator : combinators()) check_claims(combinator.name, combinator.claims);
}

TEST_CASE("the catalogue's example runs every guide and every combinator of the language") {
  const std::string example = content(fs::path(TRELLIS_SOURCE) / "examples/catalogue.lua");
  for (const GuideKind& kind : guide_kinds()) {
    INFO(kind.component->name);
    if (kind.claims.needs == GuideClaims::Needs::team) continue;  // examples/many_robots.lua
    CHECK(std::regex_search(example, std::regex("\\b" + kind.component->name + " ?[({]")));
  }
  for (const char* combinator :
       {"blend {", "schedule {", "race {", "split {", "guiding_space {", " + ", " .. ", " >> "}) {
    INFO(combinator);
    CHECK(example.find(combinator) != std::string::npos);
  }
}

TEST_CASE("every global that a script finds is a word, or Lua's own") {
  const auto globals = test::values(
      "local names = {} for name in pairs(_G) do names[#names + 1] = name end table.sort(names) "
      "return table.unpack(names)");
  for (const auto& name : globals) {
    INFO(name);
    const bool word = std::any_of(dsl::words().begin(), dsl::words().end(),
                                  [&](const dsl::Word& w) { return w.name == name || w.module() == name; });
    const auto& lua = dsl::lua_names();
    CHECK((word || std::find(lua.begin(), lua.end(), name) != lua.end()));
  }
  for (const dsl::Word& word : dsl::words()) {
    INFO(word.name);
    CHECK(test::value("type(" + word.name + ")") != "nil");
  }
}

TEST_CASE("the types that words speak of are described") {
  std::vector<std::string> known;
  for (const dsl::ObjectType& type : dsl::object_types()) {
    CHECK_FALSE(type.summary.empty());
    known.push_back(type.name);
    for (const dsl::Field& member : type.members) CHECK_FALSE(member.doc.empty());
  }
  const auto check = [&](const std::string& text) {
    for (std::size_t at = text.find("trellis."); at != std::string::npos; at = text.find("trellis.", at + 1)) {
      const std::size_t end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ", at + 8);
      const std::string name = text.substr(at, end == std::string::npos ? end : end - at);
      INFO(name);
      CHECK(std::find(known.begin(), known.end(), name) != known.end());
    }
  };
  for (const dsl::Word& word : dsl::words()) {
    check(word.returns);
    check(word.element);
    for (const dsl::Field& field : word.fields) check(field.type);
  }
}

TEST_CASE("what is committed of the registry is what it says: scripts/reference writes it") {
  const fs::path source = TRELLIS_SOURCE;
  const bool markdown = content(source / "docs/reference.md") == dsl::reference_markdown();
  const bool catalogue = content(source / "docs/catalogue.md") == dsl::catalogue_markdown();
  const bool luacheck = content(source / ".luacheckrc") == dsl::reference_luacheck();
  const bool python = content(source / "python/trellis/_words.pyi") == dsl::reference_python();
  CHECK(markdown);
  CHECK(catalogue);
  CHECK(luacheck);
  CHECK(python);
}

TEST_CASE("the stubs are Lua, and give every word and option") {
  const std::string stubs = dsl::reference_stubs();
  CHECK(stubs.starts_with("---@meta\n"));
  lua::State state({.memory = std::size_t{64} << 20U});
  CHECK_NOTHROW(state.run([&](lua::Stack& stack) {
    stack.load(stubs, "@trellis.lua");
    stack.call(0);
  }));
  for (const dsl::Word& word : dsl::words()) {
    INFO(word.name);
    if (word.kind == Kind::module) {
      CHECK(stubs.find("\n" + word.name + " = {}\n") != std::string::npos);
      continue;
    }
    CHECK(stubs.find("\nfunction " + word.name + "(") != std::string::npos);
    const std::size_t begin = stubs.find("---@class trellis." + word.name + ".Options\n");
    const std::string options =
        begin == std::string::npos ? "" : stubs.substr(begin, stubs.find("\n\n", begin) - begin);
    for (const Option& option : word.options) {
      CHECK(options.find("---@field " + option.name + "? ") != std::string::npos);
      CHECK(options.find(expectation(option) + "; default " + dsl::default_text(option)) != std::string::npos);
    }
    for (const dsl::Field& field : word.fields) {
      CHECK(options.find("---@field " + field.name + (field.required ? " " : "? ")) != std::string::npos);
    }
  }
  CHECK(stubs.find("---@operator shr(trellis.Planner): trellis.Strategy\n") != std::string::npos);
  CHECK(stubs.find("---@overload fun(scale: number, options?: trellis.shrink.Options): trellis.Guide\n") !=
        std::string::npos);
}

TEST_CASE("the reference has a section for each word, and a row for each option, once for those of every planner") {
  const std::string page = dsl::reference_markdown();
  const auto section_of = [&](const std::string& title) {
    const std::size_t begin = page.find("\n### " + title + "\n");
    REQUIRE(begin != std::string::npos);
    return page.substr(begin, page.find("\n### ", begin + 1) - begin);
  };
  const std::string common = section_of("Options of every planner");
  for (const dsl::Word& word : dsl::words()) {
    INFO(word.name);
    const std::string section = section_of(word.name);
    for (const auto& name : word.named()) {
      const std::string row = "\n| `" + name + "` | ";
      const bool shared = word.kind == dsl::Word::Kind::planner && common.find(row) != std::string::npos;
      CHECK((section.find(row) != std::string::npos) != shared);
    }
  }
}
