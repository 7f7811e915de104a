// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/tools/session.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/tools/help_text.hpp>
#include <dsl/language/words/experiment.hpp>
#include <dsl/language/words/guiding_space.hpp>
#include <dsl/language/words/modules.hpp>
#include <dsl/language/words/problem.hpp>
#include <dsl/language/words/scenario.hpp>
#include <dsl/lua/state.hpp>

namespace trellis::dsl {

namespace {

/// Errors in a script's result refer to its last line, which returns the result.
lua::Position last_line(const std::string& text, const std::string& name) {
  auto lines = static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  if (text.empty() || !text.ends_with('\n')) ++lines;
  return {name, lines};
}

/// Returns the line in "script.lua:3: ...".
std::optional<int> line_of(const std::string& message, const std::string& script) {
  if (!message.starts_with(script + ':')) return {};
  const char* begin = message.c_str() + script.size() + 1;
  char* end = nullptr;
  const long line = std::strtol(begin, &end, 10);
  return end != begin && *end == ':' ? std::optional(static_cast<int>(line)) : std::nullopt;
}

/// Whether a mistake of the same line is about the same unknown name: of `io` and its like there is more to say.
bool is_reported(const lua::Mistake& unknown, const std::vector<lua::Mistake>& mistakes) {
  const std::size_t begin = std::min(unknown.message.find('\''), unknown.message.size());
  const std::string name = unknown.message.substr(begin, unknown.message.find('\'', begin + 1) + 1 - begin);
  return std::any_of(mistakes.begin(), mistakes.end(), [&](const lua::Mistake& mistake) {
    return mistake.line == unknown.line && mistake.script == unknown.script &&
           mistake.message.find(name) != std::string::npos;
  });
}

/// Whether Lua reports an operation with the result of a call that had a mistake.
bool follows_a_mistake(const std::string& message) {
  constexpr std::array<std::string_view, 4> signs = {lua::TypeName<lua::FailedValue>::value,
                                                     "'for' initial value must be", "'for' limit must be",
                                                     "'for' step must be"};
  return std::any_of(signs.begin(), signs.end(),
                     [&](std::string_view sign) { return message.find(sign) != std::string::npos; });
}

lua::State::Options state_options(const SessionOptions& options) {
  lua::State::Options result;
  result.memory = options.memory;
  if (options.trust) result.longest_string = options.memory;  // a script reads files into strings
  result.stuck = options.stuck;
  if (options.interrupted) {
    result.poll = [interrupted = options.interrupted] {
      if (interrupted()) throw Interrupted();
    };
  }
  return result;
}

}  // namespace

Session::Session(const std::string& folder, const SessionOptions& options)
    : folder_(folder),
      options_(options),
      book_(std::make_shared<GuideBook>()),
      interpreter_(std::make_shared<lua::State>(state_options(options))) {
  interpreter_->run([&](lua::Stack& stack) {
    open_language(stack, folder, options, {.help = [](lua::Stack& call) { return help_of(call); }, .book = book_});
  });
}

Session::~Session() = default;

Program Session::load(const std::string& text, const std::string& name) {
  Program program;
  run(text, name, [&](lua::Stack& stack) { program = read_program(stack, 1); });
  if (program.experiment.measure) {
    if (auto* target = std::get_if<UserTarget>(&program.experiment.measure->target)) {
      target->make = [interpreter = interpreter_, make = std::move(target->make)](const UserTarget::Context& context) {
        return make(context);
      };
    }
  }
  const std::vector<std::string> warnings = take_warnings();
  program.warnings.insert(program.warnings.begin(), warnings.begin(), warnings.end());
  program.uncalled = [given = book_->given] {
    std::vector<Uncalled> sentences;
    for (const Callback& callback : *given) {
      if (!callback.called()) sentences.push_back({callback.where + callback.what, callback.guides});
    }
    return sentences;
  };
  return program;
}

std::vector<Problem> Session::problems(const std::string& text, const std::string& name) {
  std::vector<Problem> problems;
  run(text, name, [&](lua::Stack& stack) { problems = read_problems(stack, 1); });
  return problems;
}

lua::Limits Session::loading() const {
  const std::uint64_t instructions = options_.instructions;
  return {instructions, seconds_for(instructions), "the script",
          fmt::format("; is there an infinite loop? --instructions {} would allow more", 10 * instructions)};
}

void Session::as_script(const std::string& text, const std::string& name, const std::function<void()>& body) {
  const auto load = [text, name, folder = folder_, options = options_] {
    const auto quiet = std::make_shared<bool>(true);
    SessionOptions silent = options;
    silent.watch = nullptr;  // the first load has named the files
    silent.print = [quiet, print = options.print](const std::string& said) {
      if (!*quiet && print) print(said);
    };
    // The first load has already recorded the scenarios.
    if (options.scenarios) silent.scenarios = std::make_shared<ScenarioBook>();
    Session session(folder, silent);
    session.silence(quiet);
    session.run(text, name, [](lua::Stack&) {});
    *quiet = false;
    return std::make_shared<RunInterpreter>(RunInterpreter{session.interpreter_, session.book_});
  };
  // Scripts that are trusted reach files and the interpreter itself, whose state no snapshot has.
  book_->reload = std::make_shared<const Reload>(load, !options_.trust);
  book_->first = book_->definitions.size();
  try {
    body();
  } catch (...) {
    book_->reload = nullptr;
    throw;
  }
  book_->reload = nullptr;
}

void Session::silence(const std::shared_ptr<const bool>& quiet) {
  interpreter_->run([&](lua::Stack& stack) {
    const auto print = std::make_shared<const lua::Reference>(stack, stack.push_global("print"));
    stack.push_function([print, quiet](lua::Stack& call) {
      if (*quiet) return 0;
      const int count = call.count();
      print->push(call);
      for (int i = 1; i <= count; ++i) call.push(call[i]);
      call.call(count);
      return 0;
    });
    stack.set_global("print");
  });
}

void Session::run(const std::string& text, const std::string& name, const std::function<void(lua::Stack&)>& read) {
  std::vector<lua::Mistake> mistakes;
  try {
    as_script(text, name, [&] {
      interpreter_->run(
          [&](lua::Stack& stack) {
            stack.load(text, "@" + name);
            stack.call(0);
            if (!mistakes.empty() && stack.size() == 0) return;  // the value that it would return may be missing
            try {
              read(stack);
            } catch (const lua::Located&) {
              throw;
            } catch (const Error& error) {
              throw lua::Located(last_line(text, name).prefix() + error.what());
            }
          },
          loading(), &mistakes);
    });
  } catch (const Error& error) {
    if (mistakes.empty()) throw;
    const std::string message = error.what();
    const bool limit = dynamic_cast<const lua::Exhausted*>(&error) != nullptr;
    if (!limit && !follows_a_mistake(message)) {
      mistakes.push_back({name, line_of(message, name).value_or(last_line(text, name).line), message});
    }
  }
  if (mistakes.empty()) return;
  // Names in functions that the script did not call, too.
  interpreter_->run([&](lua::Stack& stack) {
    for (lua::Mistake& mistake : dsl::unknown_names(stack, text, name)) {
      if (!is_reported(mistake, mistakes)) mistakes.push_back(std::move(mistake));
    }
  });
  throw lua::Mistakes(std::move(mistakes), name);
}

std::vector<std::string> Session::unknown_names(const std::string& text, const std::string& name) {
  std::vector<std::string> messages;
  interpreter_->run([&](lua::Stack& stack) {
    for (lua::Mistake& mistake : dsl::unknown_names(stack, text, name)) messages.push_back(std::move(mistake.message));
  });
  return messages;
}

std::vector<std::string> Session::take_warnings() { return std::exchange(*book_->warnings, {}); }

std::vector<std::string> Session::evaluate(const std::string& text, const std::string& name) {
  std::vector<std::string> results;
  run(text, name, [&](lua::Stack& stack) {
    results.reserve(static_cast<std::size_t>(stack.size()));
    for (int i = 1; i <= stack.size(); ++i) results.push_back(stack[i].text());
  });
  return results;
}

void Session::with(const std::function<void(lua::Stack&)>& body) { interpreter_->run(body); }

void Session::within_limits(const std::function<void(lua::Stack&)>& body) { interpreter_->run(body, loading()); }

Program load_script(const std::string& path, const SessionOptions& options) {
  const std::string text = without_shebang(read_file(path));
  Session session(std::filesystem::path(path).parent_path().string(), options);
  return session.load(text, path);
}

}  // namespace trellis::dsl
