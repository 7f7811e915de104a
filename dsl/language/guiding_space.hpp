// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

#include <dsl/language/measure.hpp>
#include <dsl/language/random.hpp>
#include <dsl/language/words.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/guide/custom.hpp>

namespace trellis::dsl {

struct GuideBook;

/// What a guide of a script's own may consist of, each an entry of `guiding_space { ... }`.
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
std::string_view slot_name(Slot slot);

/// One `guiding_space { ... }` in one interpreter.
struct GuideDefinition {
  std::string name;
  Origin origin;
  std::string identity;                         ///< its name, script and line, and a digest of what it is made of
  std::shared_ptr<const lua::Reference> table;  ///< that it was made of
  std::array<std::shared_ptr<const lua::Reference>, slots> values;  ///< nullptr: not given
  std::array<lua::Type, slots> types{};
  std::string validity;    ///< "free" or "parent" where `valid` is that
  bool spaceless = false;  ///< S = {0}

  [[nodiscard]] const lua::Reference* operator[](Slot slot) const {
    return values[static_cast<std::size_t>(slot)].get();
  }
  [[nodiscard]] bool calls(Slot slot) const { return types[static_cast<std::size_t>(slot)] == lua::Type::function; }
};

/// Which functions of a guide were called, in any run.
struct CalledSlots {
  std::array<std::atomic<bool>, slots> flags{};
};

/// The interpreter that the functions of a run's guides are called in. One thread at a time.
struct RunInterpreter {
  std::shared_ptr<lua::State> state;
  std::shared_ptr<const GuideBook> book;
  /// Where it is a session's own, which others may be waiting for.
  std::shared_ptr<std::recursive_mutex> shared = nullptr;
};

/// A script that can be loaded anew, as it was when it made its guides.
struct Reload {
  std::function<std::shared_ptr<RunInterpreter>()> load;
};

/// The guides that the scripts of one interpreter have made.
struct GuideBook {
  lua::Limits each;  ///< what one call of their functions may spend
  /// Functions that wait to be called, of guides and of whatever else the scripts make.
  std::shared_ptr<std::vector<Callback>> given = std::make_shared<std::vector<Callback>>();
  std::shared_ptr<RandomSource> random;  ///< math.random's
  std::shared_ptr<const Reload> reload;  ///< of the script that is being loaded; nullptr: none is
  std::size_t first = 0;                 ///< definitions that were there before that script
  std::vector<std::shared_ptr<const GuideDefinition>> definitions;
  std::shared_ptr<std::recursive_mutex> mutex = std::make_shared<std::recursive_mutex>();
};

/// Makes guides of a script's own known, and the distributions that their heuristics are made of.
void open_guiding_space(lua::Stack& stack, const std::shared_ptr<GuideBook>& book);

/// guiding_space, along, ball, lifted.
std::vector<const Construct*> guiding_space_constructs();
/// What the functions are told.
std::vector<ObjectType> guiding_space_types();

/// A distribution over S that is to be lifted to C. Means nothing by itself.
class Lifted final : public CustomGuide {
 public:
  explicit Lifted(GuideSpec distribution);
  [[nodiscard]] const GuideSpec& distribution() const { return distribution_; }
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite& site) const override;

 private:
  GuideSpec distribution_;
};

/// The guide at work in one run.
std::unique_ptr<Guide> make_script_guide(std::shared_ptr<RunInterpreter> run,
                                         std::shared_ptr<const GuideDefinition> definition,
                                         std::shared_ptr<CalledSlots> called, const GuideSite& site);

}  // namespace trellis::dsl
