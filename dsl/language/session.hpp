// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <dsl/language/program.hpp>

namespace trellis::lua {
class Stack;
class State;
struct Limits;
}  // namespace trellis::lua

namespace trellis::dsl {

struct Callback;
struct GuideBook;
class ScenarioBook;
struct Uncalled;

struct SessionOptions {
  std::uint64_t seed = 1;                      ///< of math.random
  std::size_t memory = std::size_t{1} << 30U;  ///< bytes that the script may hold
  /// Where `help` in a script puts its text; the standard output by default.
  std::function<void(const std::string&)> print = {};
  /// What it may spend on loading, in instructions of Lua's or work that takes as long; each call of one of its
  /// functions afterwards a tenth.
  std::uint64_t instructions = 1'000'000'000;
  bool trust =
      false;  ///< it reaches all files, processes, the clock and the interpreter: io, os, debug, any scene file
  std::function<bool()> interrupted = {};  ///< polled while it runs; true ends it (Interrupted)
  /// Called from another thread where a script does not end however it is told; must not return to it.
  std::function<void(const std::string& message)> stuck = {};
  std::shared_ptr<ScenarioBook> scenarios = {};  ///< what the script's scenarios are written into; none: it has no say
};

struct Construct;

/// Makes the whole language known to an interpreter. `described` is told of every function that a module of the
/// standard library defines, as it is loaded; `book` collects the guides and functions that scripts make.
void open_language(lua::Stack& stack, const std::string& folder, const SessionOptions& options,
                   std::function<void(const Construct&)> described = {}, std::shared_ptr<GuideBook> book = {});

/// An interpreter with the whole language. Scripts run in it reach no file but scenes and modules, no process and no
/// clock, and come to an end. One thread at a time.
class Session {
 public:
  /// \param folder  where the script's own modules and scenes are looked for
  explicit Session(const std::string& folder, const SessionOptions& options = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Runs a script that returns an experiment, or a strategy with a problem. `name` stands in messages. Throws Error
  /// with the script's line and, where the script itself threw, a traceback. Functions that the script put into the
  /// experiment keep the interpreter alive.
  Program load(const std::string& text, const std::string& name);
  /// Runs a script that returns a problem, or a list of problems as scenes.load makes it.
  std::vector<Problem> problems(const std::string& text, const std::string& name);
  /// The names in a script that was run that nothing has, in functions that were not called too: a message each.
  std::vector<std::string> unknown_names(const std::string& text, const std::string& name);
  /// Runs a piece of script and returns the texts of what it returns.
  std::vector<std::string> evaluate(const std::string& text, const std::string& name);
  /// Runs `body` in the interpreter, as lua::State::run does.
  void with(const std::function<void(lua::Stack&)>& body);
  /// The same within what a script may spend on loading.
  void within_limits(const std::function<void(lua::Stack&)>& body);

  /// Runs a script and hands over what it returned; what is wrong with that is blamed on the script's last line. Its
  /// own guides are at work in interpreters that load it anew, one for each run.
  void run(const std::string& text, const std::string& name, const std::function<void(lua::Stack&)>& read);

 private:
  [[nodiscard]] lua::Limits loading() const;
  /// Calls `body` while the guides that are made are those of a script.
  void as_script(const std::string& text, const std::string& name, const std::function<void()>& body);
  /// Has `print` say nothing as long as `quiet` is true.
  void silence(const std::shared_ptr<const bool>& quiet);

  std::string folder_;
  SessionOptions options_;
  std::shared_ptr<GuideBook> book_;
  std::shared_ptr<lua::State> interpreter_;
};

/// Reads a script file and runs it in a session of its own.
Program load_script(const std::string& path, const SessionOptions& options = {});

}  // namespace trellis::dsl
