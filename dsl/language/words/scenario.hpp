// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/program.hpp>
#include <dsl/language/core/script_place.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/trial/matcher.hpp>

// Scenarios in scripts: preconditions, trials and expectations. A scenario's function only records them. The trials run
// after the function has ended, so that planning does not count in the script's time.

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
  std::string text;  ///< of preconditions and trials
  std::optional<Expectation> expectation = {};
};

struct Scenario {
  std::string name;
  lua::Position where;
  std::vector<Step> steps;
};

/// Records the scenarios of a script.
class ScenarioBook {
 public:
  std::optional<std::uint64_t> seeds;  ///< of every trial, instead of its own
  trial::Making making;
  /// Loads another script, as `trellis run` does.
  std::function<Program(const std::string& path)> load;

  struct Entry {
    Scenario scenario;
    std::shared_ptr<lua::Reference> body;  ///< none: not given yet
  };
  std::vector<Entry> entries;
  Scenario* current = nullptr;       ///< the one whose function runs
  std::vector<trial::Trial> trials;  ///< its trials
};

/// Registers the words of scenarios. Without a book, words that record into it raise an error.
void open_scenario(lua::Stack& stack, const ScriptPlace& place, const std::shared_ptr<ScenarioBook>& book);

/// scenario, given, when, expect; the matchers; the criteria.
std::vector<const Construct*> scenario_constructs();

/// Preconditions, trials, matchers and criteria.
struct ObjectType;
std::vector<ObjectType> scenario_types();

}  // namespace trellis::dsl
