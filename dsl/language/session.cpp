// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/session.hpp>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>

#include <dsl/language/algebra.hpp>
#include <dsl/language/experiment.hpp>
#include <dsl/language/help.hpp>
#include <dsl/language/measure.hpp>
#include <dsl/language/modules.hpp>
#include <dsl/language/problem.hpp>
#include <dsl/language/publication.hpp>
#include <dsl/language/random.hpp>
#include <dsl/language/stdlib.hpp>
#include <dsl/language/world.hpp>
#include <dsl/lua/state.hpp>

namespace trellis::dsl {

namespace {

/// What is wrong with a script's result is blamed on its last line, where the result is returned.
lua::Position last_line(const std::string& text, const std::string& name) {
  auto lines = static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  if (text.empty() || !text.ends_with('\n')) ++lines;
  return {name, lines};
}

}  // namespace

void open_language(lua::Stack& stack, const std::string& folder, const SessionOptions& options,
                   std::function<void(const Construct&)> described) {
  open_libraries(stack);
  open_random(stack, options.seed);
  open_algebra(stack);
  open_world(stack);
  open_problem(stack);
  open_measure(stack);
  open_publication(stack);
  open_experiment(stack);
  open_help(stack, options.print);
  open_modules(stack, folder, std::move(described));
}

Session::Session(const std::string& folder, const SessionOptions& options)
    : interpreter_(std::make_shared<lua::State>(options.memory)) {
  interpreter_->run([&](lua::Stack& stack) { open_language(stack, folder, options); });
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
  return program;
}

std::vector<Problem> Session::problems(const std::string& text, const std::string& name) {
  std::vector<Problem> problems;
  run(text, name, [&](lua::Stack& stack) { problems = read_problems(stack, 1); });
  return problems;
}

void Session::run(const std::string& text, const std::string& name, const std::function<void(lua::Stack&)>& read) {
  interpreter_->run([&](lua::Stack& stack) {
    stack.load(text, "@" + name);
    stack.call(0);
    try {
      read(stack);
    } catch (const Error& error) {
      throw lua::Located(last_line(text, name).prefix() + error.what());
    }
  });
}

std::vector<std::string> Session::evaluate(const std::string& text, const std::string& name) {
  std::vector<std::string> results;
  interpreter_->run([&](lua::Stack& stack) {
    stack.load(text, "@" + name);
    stack.call(0);
    for (int i = 1; i <= stack.size(); ++i) results.push_back(stack[i].text());
  });
  return results;
}

void Session::with(const std::function<void(lua::Stack&)>& body) { interpreter_->run(body); }

Program load_script(const std::string& path, const SessionOptions& options) {
  const std::string text = without_shebang(read_file(path));
  Session session(std::filesystem::path(path).parent_path().string(), options);
  return session.load(text, path);
}

}  // namespace trellis::dsl
