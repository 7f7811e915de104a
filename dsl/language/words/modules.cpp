// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/modules.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/replaced.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/words/functions.hpp>
#include <dsl/language/words/problem.hpp>
#include <dsl/lua/globals.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

/// Letters, digits and underscores, in parts separated by dots: such a path cannot leave the folder.
bool is_module_name(const std::string& name) {
  bool part = false;
  for (const char c : name) {
    if (c == '.') {
      if (!part) return false;
      part = false;
    } else if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_') {
      part = true;
    } else {
      return false;
    }
  }
  return part;
}

struct Source {
  std::string text;
  std::string chunk;
  bool standard = false;
};

/// Finds modules and runs each one once.
class Modules {
 public:
  Modules(const ScriptPlace& place, std::shared_ptr<std::vector<std::string>> warnings, Definitions definitions)
      : place_(place), warnings_(std::move(warnings)), definitions_(std::move(definitions)) {}

  /// Pushes the module's value. `loaded` is the table of the modules that have run.
  void require(Stack& stack, const std::string& name) {
    const Value loaded = registry(stack);
    const Value known = loaded.field(name);
    if (known.given()) return;
    if (std::find(loading_.begin(), loading_.end(), name) != loading_.end()) {
      std::string cycle;
      for (const auto& module : loading_) cycle += module + " -> ";
      throw Error(fmt::format("require: the modules need each other in a cycle: {}{}", cycle, name));
    }
    const Source source = find(name);
    stack.load(source.text, source.chunk);
    int arguments = 1;
    stack.push(name);
    if (source.standard) {
      push_natives(stack);
      ++arguments;
    }
    const int before = stack.size() - arguments - 1;
    {
      // Lua's errors unwind C++ objects too, so the destructor removes the mark in any case.
      const Mark mark(loading_, name);
      stack.call(arguments);
    }
    stack.resize(before + 1);
    if (!stack.top().given()) {
      stack.resize(before);
      stack.push(true);
    }
    if (source.standard && stack.top().type() == Type::table) stack.on_missing(stack.top(), missing_field(name));
    stack.push(stack.top());
    stack.set_field(loaded, name);
  }

 private:
  class Mark {
   public:
    Mark(std::vector<std::string>& list, const std::string& name) : list_(list) { list_.push_back(name); }
    ~Mark() { list_.pop_back(); }
    Mark(const Mark&) = delete;
    Mark& operator=(const Mark&) = delete;

   private:
    std::vector<std::string>& list_;
  };

  [[nodiscard]] Source find(const std::string& name) const {
    if (!is_module_name(name)) {
      throw Error(fmt::format("require: '{}' is no module name (letters, digits, '_', parts separated by '.')", name));
    }
    if (auto text = module_text(name)) {
      if (const auto path = module_path(name); path && place_.watch) place_.watch(name + ".lua", *path);
      return {std::move(*text), "=stdlib/" + name + ".lua", true};
    }
    std::string file = name;
    std::replace(file.begin(), file.end(), '.', '/');
    const auto path = (std::filesystem::path(place_.folder) / (file + ".lua")).lexically_normal().string();
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
      const auto standard = module_names();
      throw Error(fmt::format("require: no module '{}'{}: neither in the standard library nor at '{}'", name,
                              did_you_mean(name, standard), path));
    }
    Source source{without_shebang(read_file(path)), "@" + path, false};
    if (place_.watch) place_.watch(file + ".lua", path);
    return source;
  }

  /// Pushes the functions that only the standard library receives.
  void push_natives(Stack& stack) const {
    const Value natives = stack.push_table();
    stack.push_function(scene_loader(place_, warnings_));
    stack.set_field(natives, "load_scene");
    stack.push_function(robot_loader(place_));
    stack.set_field(natives, "load_robot");
    stack.push_function(scene_finder(place_.folder, place_.trust));
    stack.set_field(natives, "scene_exists");
    stack.push_function(definer(definitions_));
    stack.set_field(natives, "define");
    stack.push_function([](Stack& call) -> int { throw Error(call[1].text()); });
    stack.set_field(natives, "fail");
  }

  /// Returns the table of loaded modules, which scripts cannot access.
  static Value registry(Stack& stack) { return stack.push_hidden("modules"); }

  ScriptPlace place_;
  std::shared_ptr<std::vector<std::string>> warnings_;
  Definitions definitions_;
  std::vector<std::string> loading_;
};

}  // namespace

const std::vector<std::string>& left_out_names() {
  static const std::vector<std::string> names = {"debug", "dofile", "io", "loadfile", "os", "package"};
  return names;
}

const Construct& require_construct() {
  static const Construct construct = {
      .name = "require",
      .usage = "require \"mine\"",
      .summary = "the value of a module: one of the standard library, or NAME.lua in the script's folder",
      .list = "",
      .element = "",
      .fields = {},
      .options = {},
      .returns = "any",
      .arguments = {
          {"module", "string", "a name", "parts separated by '.' are folders; each module is run once", true}}};
  return construct;
}

std::vector<lua::Mistake> unknown_names(Stack& stack, const std::string& text, const std::string& script) {
  const auto uses = lua::global_uses(stack, text, "@" + script);
  const int before = stack.size();
  auto known = module_names();
  for (const auto& name : stack.push_globals().keys().names) known.push_back(name);
  stack.resize(before);
  for (const auto& use : uses) {
    if (use.set) known.push_back(use.name);
  }
  std::vector<lua::Mistake> mistakes;
  for (const auto& use : uses) {
    if (use.name.empty() || std::find(known.begin(), known.end(), use.name) != known.end()) continue;
    const lua::Position position{script, use.line};
    mistakes.push_back(
        {script, use.line,
         fmt::format("{}unknown name '{}'{}", position.prefix(), use.name, suggestion(use.name, known))});
  }
  return mistakes;
}

std::string without_shebang(std::string text) {
  if (text.starts_with('#')) text.erase(0, std::min(text.find('\n'), text.size()));
  return text;
}

void open_modules(Stack& stack, const ScriptPlace& place, std::shared_ptr<std::vector<std::string>> warnings,
                  Definitions definitions) {
  const auto modules = std::make_shared<Modules>(place, std::move(warnings), std::move(definitions));
  stack.push_function([modules](Stack& call) {
    const auto name = call[1].string();
    if (!name) throw Error(fmt::format("require: the module's name must be a string, got {}", describe(call[1])));
    modules->require(call, *name);
    return 1;
  });
  stack.set_global(require_construct().name);
  const int before = stack.size();
  stack.on_missing(stack.push_globals(), [modules](Stack& call) {
    const auto name = call[2].string();
    if (!name) throw Error(fmt::format("no global is called {}", call[2].describe()));
    if (std::binary_search(left_out_names().begin(), left_out_names().end(), *name)) {
      const bool granted = *name == "io" || *name == "os" || *name == "debug";
      throw Error(
          fmt::format("there is no '{}' here: scripts reach no files and processes, and nothing of the interpreter{}",
                      *name, granted ? "; --trust lets one that you trust" : ""));
    }
    auto known = module_names();
    if (std::binary_search(known.begin(), known.end(), *name)) {
      modules->require(call, *name);
      call.push(call.top());
      call.set_global(*name);
      return 1;
    }
    const auto globals = call.push_globals().keys().names;
    known.insert(known.end(), globals.begin(), globals.end());
    constexpr std::size_t longest = 60;
    const std::string shown = name->size() > longest ? name->substr(0, longest) + "..." : *name;
    throw Error(fmt::format("unknown name '{}'{}", shown, suggestion(*name, known)));
  });
  stack.resize(before);
}

}  // namespace trellis::dsl
