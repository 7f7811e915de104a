// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/language/modules.hpp>
#include <dsl/language/program.hpp>
#include <dsl/language/session.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/trial/matcher.hpp>

// Scenarios in scripts: what is given, when it runs, and what is expected of it. A scenario's function only writes down
// what is to be tried; the trials are made when it has ended, so that planning is none of the script's time.

namespace trellis::dsl {

/// A line of a scenario.
struct Step {
  enum class Kind { given, when, expect };
  struct Expectation {
    trial::Trial trial;
    trial::MatcherPointer matcher;
  };

  Kind kind = Kind::given;
  lua::Position where;
  std::string text;  ///< of what is given, and of what runs
  std::optional<Expectation> expectation = {};
};

struct Scenario {
  std::string name;
  lua::Position where;
  std::vector<Step> steps;
};

/// What the scenarios of a script are written into.
class ScenarioBook {
 public:
  std::optional<std::uint64_t> seeds;  ///< of every trial, instead of what it asks for
  trial::Making making;
  /// Loads another script, as `trellis run` would.
  std::function<Program(const std::string& path)> load;

  struct Entry {
    Scenario scenario;
    std::shared_ptr<lua::Reference> body;  ///< none until it is given
  };
  std::vector<Entry> entries;
  Scenario* current = nullptr;       ///< the one whose function runs
  std::vector<trial::Trial> trials;  ///< that it made
};

/// A script of scenarios, loaded.
class ScenarioFile {
 public:
  struct Options {
    SessionOptions session = {};
    std::optional<std::uint64_t> seeds = {};
    trial::Making making = {};
  };
  /// Throws Error where the script cannot be loaded, and where it has no scenario.
  ScenarioFile(const std::string& path, const Options& options);
  ~ScenarioFile();
  ScenarioFile(const ScenarioFile&) = delete;
  ScenarioFile& operator=(const ScenarioFile&) = delete;

  [[nodiscard]] std::vector<std::string> names() const;
  /// Calls a scenario's function, and gives what it wrote down. Throws Error where the function fails. The trials of
  /// the scenario before let go of their runs.
  const Scenario& play(std::size_t index);

 private:
  std::shared_ptr<ScenarioBook> book_;
  Session session_;
};

/// Makes the words of scenarios known. Without a book, those that write into it say where they belong.
void open_scenario(lua::Stack& stack, const ScriptPlace& place, const std::shared_ptr<ScenarioBook>& book);

/// scenario, given, when, expect; the matchers; the criteria.
std::vector<const Construct*> scenario_constructs();

/// What is given, trials, matchers and criteria.
struct ObjectType;
std::vector<ObjectType> scenario_types();

}  // namespace trellis::dsl
