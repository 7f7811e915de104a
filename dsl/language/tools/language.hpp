// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/script_place.hpp>
#include <dsl/lua/state.hpp>

namespace trellis::dsl {

struct GuideBook;
class ScenarioBook;

struct SessionOptions {
  std::uint64_t seed = 1;                      ///< of math.random
  std::size_t memory = std::size_t{1} << 30U;  ///< limit of the script's memory, bytes
  /// Receives the text of `help` in a script; by default the standard output.
  std::function<void(const std::string&)> print = {};
  /// Limit for loading the script, in Lua instructions or equivalent work; each later call of one of its functions may
  /// spend a tenth.
  std::uint64_t instructions = 1'000'000'000;
  bool trust =
      false;  ///< it reaches all files, processes, the clock and the interpreter: io, os, debug, any scene file
  std::function<bool()> interrupted = {};  ///< polled while it runs; true ends it (Interrupted)
  /// Called from another thread if a script does not stop at its limits; must not return.
  std::function<void(const std::string& message)> stuck = {};
  /// Called for each module, scene, library and model that the script names while it loads; not for the embedded ones.
  FileWatch watch = {};
  std::shared_ptr<ScenarioBook> scenarios = {};  ///< records the script's scenarios; nullptr: scenarios are not allowed
};

/// What the interpreter of a session has beside the words.
struct LanguageParts {
  /// Called for every function of the standard library, when its module loads.
  std::function<void(const Construct&)> described = {};
  /// The text of `help` for the arguments of a call; empty: the language has no `help`.
  std::function<std::string(lua::Stack&)> help = {};
  std::shared_ptr<GuideBook> book = {};  ///< collects the guides and functions of scripts
};

/// Registers the complete language in an interpreter.
/// \param folder  of the script's modules and scenes
void open_language(lua::Stack& stack, const std::string& folder, const SessionOptions& options,
                   LanguageParts parts = {});

/// Returns the constructs of the language that are no planner, guide, target or estimator.
std::vector<const Construct*> constructs();

/// Limits of one call of a script's function, if loading may spend `instructions`.
lua::Limits call_limits(std::uint64_t instructions);
/// Time for so many instructions, in seconds.
double seconds_for(std::uint64_t instructions);

}  // namespace trellis::dsl
