// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/program.hpp>
#include <dsl/language/tools/language.hpp>

namespace trellis::lua {
class Stack;
class State;
struct Limits;
}  // namespace trellis::lua

namespace trellis::dsl {

struct GuideBook;

/// An interpreter with the complete language. Scripts in it are sandboxed: they access no file except scenes and
/// modules, no process and no clock, and terminate at their limits. Only one thread may use it at a time.
class Session {
 public:
  /// \param folder  the folder of the script's modules and scenes
  explicit Session(const std::string& folder, const SessionOptions& options = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Runs a script that returns an experiment, or a strategy with a problem. Messages call it `name`. Functions of the
  /// script in the experiment keep the interpreter alive.
  /// \throws Error with the script's line and, for an error that the script raised, a traceback.
  Program load(const std::string& text, const std::string& name);
  /// Runs a script that returns a problem, or a list of problems as from scenes.load.
  std::vector<Problem> problems(const std::string& text, const std::string& name);
  /// Returns a message for each undefined name in a script that has run, even in functions without a call.
  std::vector<std::string> unknown_names(const std::string& text, const std::string& name);
  /// Returns what scripts of this session have that does something else than it seems to, and forgets it.
  std::vector<std::string> take_warnings();
  /// Runs a piece of script and returns the texts of its results.
  std::vector<std::string> evaluate(const std::string& text, const std::string& name);
  /// Runs `body` in the interpreter, as lua::State::run does.
  void with(const std::function<void(lua::Stack&)>& body);
  /// The same with the limits of loading.
  void within_limits(const std::function<void(lua::Stack&)>& body);

  /// Runs a script and passes its results on; errors in these refer to the script's last line. Its guides run in
  /// separate interpreters, which load it again for each run.
  void run(const std::string& text, const std::string& name, const std::function<void(lua::Stack&)>& read);

 private:
  [[nodiscard]] lua::Limits loading() const;
  /// Calls `body`; guides created in it belong to a script.
  void as_script(const std::string& text, const std::string& name, const std::function<void()>& body);
  /// Suppresses `print` as long as `quiet` is true.
  void silence(const std::shared_ptr<const bool>& quiet);

  std::string folder_;
  SessionOptions options_;
  std::shared_ptr<GuideBook> book_;
  std::shared_ptr<lua::State> interpreter_;
};

/// Reads a script file and runs it in a new session.
Program load_script(const std::string& path, const SessionOptions& options = {});

}  // namespace trellis::dsl
