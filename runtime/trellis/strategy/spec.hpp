// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/strategy/combinator_settings.hpp>

namespace trellis {

class CustomGuide;

// The algebra of guiding spaces as plain, immutable data. Nothing runs until a strategy is executed.
//
//   guide >> guide = guide          planner is a strategy           w * guide = guide
//   guide >> strategy = strategy    guide + guide = guide           guide .. guide = guide (sequence)
//   split { planner } = planner     blend, schedule, race { guide, ... } = guide
//
// Normal form: `a >> (b + c)` is `(a >> b) + (a >> c)`, and so with `..`, blend, schedule and race; sums, sequences and
// schedules are flat, blends and races are not; a schedule or race of one guide is that guide; `(a >> b) >> c` and
// `a >> (b >> c)` are the same value; `split { a >> p }` is `a >> split { p }`. Laws: `>>` associates (with the planner
// at the end too), `+` and `..` associate, weights are normalised where they are used, nesting distributes over every
// way of combining guides.

/// Where a spec was written. Not part of its value, hash or JSON.
struct Origin {
  std::string script;  ///< "" when built through C++
  int line = 0;
};

/// A planner with its validated options.
class PlannerSpec {
 public:
  /// Throws Error for an unknown planner (with the nearest name) or a wrong option.
  static PlannerSpec make(const std::string& name, const std::vector<Options::Entry>& given, Origin origin = {});

  /// The planner that searches in the end; of a split that of the undivided halves.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] const Origin& origin() const { return origin_; }
  /// How it divides its instances; nullptr where it does not.
  [[nodiscard]] const Options* dividing() const;
  /// Of a split: what solves an instance that was divided as often as it may be, and what solves one of its halves.
  [[nodiscard]] const PlannerSpec& undivided() const;
  [[nodiscard]] PlannerSpec half() const;
  /// "rrt { step = 0.5 }": the options that differ from their defaults.
  [[nodiscard]] std::string text() const;

  friend bool operator==(const PlannerSpec& a, const PlannerSpec& b);
  friend PlannerSpec split(const PlannerSpec& part, const SplitSettings& settings);

 private:
  struct Division;

  std::string name_;
  Options options_;
  Origin origin_;
  std::shared_ptr<const Division> division_;
};

/// A planner that divides its instances at sub-goals and solves each half by `part`. A split of a split with the same
/// options, but for their depths, is one of both depths. Throws Error for settings out of their range, or for a planner
/// of explicit graphs.
PlannerSpec split(const PlannerSpec& part, const SplitSettings& settings = {});

/// A guide: a component (f, h) with the guide of its own search, or several guides combined.
class GuideSpec {
 public:
  enum class Kind { component, mixture, sequence, blend, schedule, race };
  struct Term;

  /// A component without a guide of its own. `planner`: of its own search; none: the component's default.
  /// Throws Error for an unknown guide, a wrong option, or a planner that the guide's space cannot use.
  static GuideSpec make(const std::string& name, const std::vector<Options::Entry>& given,
                        std::optional<PlannerSpec> planner = {}, Origin origin = {});
  /// The same of a guide that is no component of the registry.
  static GuideSpec make(std::shared_ptr<const CustomGuide> custom, std::optional<PlannerSpec> planner = {},
                        Origin origin = {});

  [[nodiscard]] Kind kind() const;
  /// "shrink", "mixture", "schedule".
  [[nodiscard]] const std::string& name() const;
  /// Of a component of the registry, or of the combinator that is neither component nor mixture; none of a custom
  /// guide.
  [[nodiscard]] const Options& options() const;
  // Of a component:
  /// nullptr for a guide of the registry.
  [[nodiscard]] const std::shared_ptr<const CustomGuide>& custom() const;
  /// The component without a guide of its own, its planner the default one: what a level is called by.
  [[nodiscard]] GuideSpec alone() const;
  /// The text of `alone()`.
  [[nodiscard]] std::string text_alone() const;
  /// The planner of its own search (the default filled in); none where S = {0}.
  [[nodiscard]] const std::optional<PlannerSpec>& planner() const;
  /// Whether that planner was chosen by whoever wrote the guide.
  [[nodiscard]] bool planner_given() const;
  /// The guide of its own search, nullptr without.
  [[nodiscard]] const GuideSpec* below() const;
  [[nodiscard]] const Origin& origin() const;
  // Of any other (weights other than a mixture's are 1):
  [[nodiscard]] const std::vector<Term>& terms() const;
  /// The same way of combining, with its options, for other guides; a mixture keeps its weights. Not of a component.
  [[nodiscard]] GuideSpec with_parts(const std::vector<GuideSpec>& parts) const;

  /// Whether any component in it searches a space of its own (S other than {0}).
  [[nodiscard]] bool searches() const;

  /// One line in the language, options that differ from their defaults: "skeleton() >> shrink(0.5) >> lazy()".
  [[nodiscard]] std::string text() const;
  /// What it is made of as a tree, one line for each level, that of the guide nearest to the root first; ends with a
  /// newline.
  [[nodiscard]] std::string tree() const;

  friend bool operator==(const GuideSpec& a, const GuideSpec& b);
  friend GuideSpec operator>>(const GuideSpec& above, const GuideSpec& guided);
  friend GuideSpec operator+(const GuideSpec& a, const GuideSpec& b);
  /// Throws Error for a weight that is not finite and positive.
  friend GuideSpec operator*(double weight, const GuideSpec& guide);
  friend GuideSpec sequence(const std::vector<GuideSpec>& parts, std::int64_t turn);
  friend GuideSpec blend(const std::vector<GuideSpec>& parts, const BlendSettings& settings);
  friend GuideSpec schedule(const std::vector<GuideSpec>& parts, const ScheduleSettings& settings);
  friend GuideSpec race(const std::vector<GuideSpec>& parts, const RaceSettings& settings);

 private:
  struct Node;
  static std::string text_of_component(const Node& node, const std::string& planner);
  static GuideSpec combine(Kind kind, const std::vector<GuideSpec>& parts, Options options);
  explicit GuideSpec(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  std::shared_ptr<const Node> node_;
};

struct GuideSpec::Term {
  double weight = 1.0;
  GuideSpec guide;
};

/// `a .. b .. c`: each space serves a turn and informs the next. `a .. b` in Lua is sequence({a, b}).
GuideSpec sequence(const std::vector<GuideSpec>& parts, std::int64_t turn = default_turn);
/// A mixture whose weights follow what each part's proposals achieved. Throws Error without parts, or for settings out
/// of their range.
GuideSpec blend(const std::vector<GuideSpec>& parts, const BlendSettings& settings = {});
/// Guides that serve in order, each until it is refuted.
GuideSpec schedule(const std::vector<GuideSpec>& parts, const ScheduleSettings& settings = {});
/// Guides whose spaces are searched in turn, by growing budgets; the first path found guides until it is refuted.
GuideSpec race(const std::vector<GuideSpec>& parts, const RaceSettings& settings = {});

/// A planner at the root, with or without a guide: what can be executed.
class StrategySpec {
 public:
  /// Throws Error for a planner that searches explicit graphs only.
  StrategySpec(PlannerSpec planner);  // NOLINT(google-explicit-constructor): a planner is a strategy
  StrategySpec(PlannerSpec planner, GuideSpec guide);

  [[nodiscard]] const PlannerSpec& planner() const { return planner_; }
  [[nodiscard]] const GuideSpec* guide() const { return guide_ ? &*guide_ : nullptr; }

  /// One line in the language.
  [[nodiscard]] std::string text() const;
  /// The hierarchy as a tree, one level per line, the root first; ends with a newline.
  [[nodiscard]] std::string tree() const;
  /// The spec as JSON text, every option included; canonical (equal specs give equal bytes).
  [[nodiscard]] std::string json() const;
  /// A stable hash of json().
  [[nodiscard]] std::uint64_t hash() const;

  friend bool operator==(const StrategySpec& a, const StrategySpec& b) = default;
  friend StrategySpec operator>>(const GuideSpec& above, const StrategySpec& guided);

 private:
  PlannerSpec planner_;
  std::optional<GuideSpec> guide_;
};

StrategySpec operator>>(const GuideSpec& above, const PlannerSpec& planner);
/// `split { guide >> planner }` is `guide >> split { planner }`: each half is guided as the whole.
StrategySpec split(const StrategySpec& part, const SplitSettings& settings = {});

}  // namespace trellis
