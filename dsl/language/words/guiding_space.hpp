// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <dsl/language/core/random.hpp>
#include <dsl/language/core/word.hpp>
#include <dsl/language/words/measure.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/guide/custom.hpp>

namespace trellis::dsl {

struct GuideBook;

/// The parts of a user-defined guide, each an entry of `guiding_space { ... }`.
enum class Slot : std::uint8_t {
  space,
  project,
  lift,
  valid,
  robot,
  world,
  graph,
  heuristic,
  density,
  observe,
  stale,
  restart,
  count
};
inline constexpr auto slots = static_cast<std::size_t>(Slot::count);
inline constexpr int most_parameters = 255;  ///< of a function of Lua
std::string_view slot_name(Slot slot);

/// One `guiding_space { ... }` in one interpreter.
struct GuideDefinition {
  std::string name;
  Origin origin;
  std::string identity;                         ///< its name, script and line, and a digest of its content
  std::shared_ptr<const lua::Reference> table;  ///< its source table
  std::array<std::shared_ptr<const lua::Reference>, slots> values;  ///< nullptr: not given
  std::array<lua::Type, slots> types{};
  std::array<int, slots> parameters{};  ///< of a function, those that it names; most_parameters for one with "..."
  std::array<bool, slots> known{};  ///< functions that make S of what is known: they take it as their second argument
  std::string validity;             ///< "free" or "parent" where `valid` has that value
  bool spaceless = false;           ///< S = {0}

  [[nodiscard]] const lua::Reference* operator[](Slot slot) const {
    return values[static_cast<std::size_t>(slot)].get();
  }
  [[nodiscard]] bool calls(Slot slot) const { return types[static_cast<std::size_t>(slot)] == lua::Type::function; }
  /// How many of `count` arguments a function receives; those that it does not name need not be made.
  [[nodiscard]] int arguments(Slot slot, int count) const {
    return std::min(parameters[static_cast<std::size_t>(slot)], count);
  }
  /// Whether a function makes S of what is known about C.
  [[nodiscard]] bool uses_known() const {
    return std::any_of(known.begin(), known.end(), [](bool takes) { return takes; });
  }
};

/// Which functions of a guide were called, in any run.
struct CalledSlots {
  std::array<std::atomic<bool>, slots> flags{};
};

/// The interpreter for the functions of a run's guides. Only one thread may use it at a time.
struct RunInterpreter {
  std::shared_ptr<lua::State> state;
  std::shared_ptr<const GuideBook> book;
  /// The lock of a session's own interpreter, for which other threads may wait.
  std::shared_ptr<std::recursive_mutex> shared = nullptr;
  bool failed = false;  ///< a call ended with an error
};

/// A script that can be loaded again, so that each run has an interpreter in the state that loading left. A run returns
/// its interpreter when the last user of it has gone; the next run on any thread takes it, unless a value that the
/// script's functions can reach has changed. So no run receives a state of another, and most runs do not load.
class Reload : public std::enable_shared_from_this<Reload> {
 public:
  /// \param load   loads the script into a new interpreter
  /// \param reuse  whether runs may take interpreters of others
  Reload(std::function<std::shared_ptr<RunInterpreter>()> load, bool reuse);
  ~Reload();
  Reload(const Reload&) = delete;
  Reload& operator=(const Reload&) = delete;

  /// Thread-safe.
  [[nodiscard]] std::shared_ptr<RunInterpreter> interpreter() const;

 private:
  struct Loaded;
  void take_back(std::shared_ptr<Loaded> loaded) const;

  std::function<std::shared_ptr<RunInterpreter>()> load_;
  bool reuse_;
  mutable std::mutex mutex_;
  mutable std::vector<std::shared_ptr<Loaded>> idle_;  ///< guarded by the mutex
};

/// The guides that the scripts of one interpreter have created.
struct GuideBook {
  lua::Limits each;  ///< limits of one call of their functions
  /// Functions of guides and other objects of scripts, with a record of calls.
  std::shared_ptr<std::vector<Callback>> given = std::make_shared<std::vector<Callback>>();
  std::shared_ptr<RandomSource> random;  ///< math.random's
  std::shared_ptr<const Reload> reload;  ///< of the current script; nullptr: none
  std::size_t first = 0;                 ///< number of definitions before that script
  std::vector<std::shared_ptr<const GuideDefinition>> definitions;
  std::shared_ptr<std::recursive_mutex> mutex = std::make_shared<std::recursive_mutex>();
  /// Parts of scripts that do something else than they seem to, with their lines.
  std::shared_ptr<std::vector<std::string>> warnings = std::make_shared<std::vector<std::string>>();
};

/// Registers user-defined guides, and the distributions of which their heuristics are composed.
void open_guiding_space(lua::Stack& stack, const std::shared_ptr<GuideBook>& book);

/// guiding_space, along, ball, lifted.
std::vector<const Construct*> guiding_space_constructs();
/// The arguments of the functions.
std::vector<ObjectType> guiding_space_types();

/// A distribution over S that the guide lifts to C. Has no meaning by itself.
class Lifted final : public CustomGuide {
 public:
  explicit Lifted(GuideSpec distribution);
  [[nodiscard]] const GuideSpec& distribution() const { return distribution_; }
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite& site) const override;

 private:
  GuideSpec distribution_;
};

/// Creates the guide of one run.
std::unique_ptr<Guide> make_script_guide(std::shared_ptr<RunInterpreter> run,
                                         std::shared_ptr<const GuideDefinition> definition,
                                         std::shared_ptr<CalledSlots> called, const GuideSite& site);

}  // namespace trellis::dsl
