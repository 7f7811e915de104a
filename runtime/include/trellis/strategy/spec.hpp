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
// Normal form: `a >> (b + c)` is `(a >> b) + (a >> c)`; the same applies to `..`, blend, schedule and race. Sums,
// sequences and schedules are flat; blends and races are not. A schedule or race of one guide is that guide. `(a >> b)
// >> c` and `a >> (b >> c)` are the same value. `split { a >> p }` is `a >> split { p }`.
//
// Laws: `>>` is associative (also with a planner at the end), `+` and `..` are associative, weights are normalised at
// use, and nesting distributes over every combination of guides.

/// Where a spec was written. Its equality, hash and JSON ignore it.
struct Origin {
  std::string script;  ///< "" for a spec built in C++
  int line = 0;
};

/// A planner with its validated options.
class PlannerSpec {
 public:
  /// \param name  of a planner in planner_kinds()
  /// \param given  options and their values; the others have their defaults
  /// \param origin  in messages
  /// \throws Error for an unknown planner (with the nearest name) or an invalid option
  static PlannerSpec make(const std::string& name, const std::vector<Options::Entry>& given, Origin origin = {});

  /// The name of the planner that searches; for a split, the planner of its undivided halves.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] const Origin& origin() const { return origin_; }
  /// The options of a split; nullptr for other planners.
  [[nodiscard]] const Options* dividing() const;
  /// For a split: the planner of an instance at the maximum depth.
  /// \throws Fault for a planner that is no split
  [[nodiscard]] const PlannerSpec& undivided() const;
  /// For a split: the planner of a half, which divides one level less. Requires a split.
  [[nodiscard]] PlannerSpec half() const;
  /// The same planner with another value of an option; for a split, of both planners.
  /// \param option  of the planner, not of the split
  /// \param value  of the option's type and in its range
  /// \throws Error for an unknown option or an invalid value
  [[nodiscard]] PlannerSpec with(const std::string& option, const OptionValue& value) const;
  /// "rrt { step = 0.5 }": with the options that differ from their defaults.
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

/// A planner that divides its instances at sub-goals and solves each half by `part`. A split of a split with equal
/// options except for depth is one split with the sum of their depths.
/// \param part  the planner of the undivided halves, or a split
/// \param settings  depth, tries and effort
/// \throws Error for a setting out of range, or for a planner of explicit graphs
PlannerSpec split(const PlannerSpec& part, const SplitSettings& settings = {});

/// A guide: a component (f, h) with the guide of its own search, or a combination of guides.
class GuideSpec {
 public:
  enum class Kind { component, mixture, sequence, blend, schedule, race };
  struct Term;

  /// A component without a guide of its own.
  /// \param name  of a guide in guide_kinds()
  /// \param given  options and their values; the others have their defaults
  /// \param planner  of its own search; none: the component's default
  /// \param origin  in messages
  /// \throws Error for an unknown guide, an invalid option, or a planner that cannot search the guide's space
  static GuideSpec make(const std::string& name, const std::vector<Options::Entry>& given,
                        std::optional<PlannerSpec> planner = {}, Origin origin = {});
  /// The same for a custom guide, which is not in the registry.
  /// \param custom  not nullptr; the spec shares its ownership
  /// \param planner  of its own search; none: the guide's default
  /// \param origin  in messages
  /// \throws Error for a planner that cannot search the guide's space
  static GuideSpec make(std::shared_ptr<const CustomGuide> custom, std::optional<PlannerSpec> planner = {},
                        Origin origin = {});

  /// Whether it is a component, else which combination.
  [[nodiscard]] Kind kind() const;
  /// "shrink", "mixture", "schedule".
  [[nodiscard]] const std::string& name() const;
  /// For a component of the registry or a combinator with options; not for a mixture or custom guide.
  [[nodiscard]] const Options& options() const;
  // For components:
  /// nullptr for a guide in the registry.
  [[nodiscard]] const std::shared_ptr<const CustomGuide>& custom() const;
  /// The component without its guide and with its default planner. Its text is the name of its level.
  [[nodiscard]] GuideSpec alone() const;
  /// The text of `alone()`.
  [[nodiscard]] std::string text_alone() const;
  /// The planner of its own search, or the default; none if S = {0}.
  [[nodiscard]] const std::optional<PlannerSpec>& planner() const;
  /// Whether the author of the guide chose that planner.
  [[nodiscard]] bool planner_given() const;
  /// The guide of its own search; nullptr if none.
  [[nodiscard]] const GuideSpec* below() const;
  [[nodiscard]] const Origin& origin() const;
  // For combinations:
  /// The guides that are combined, with their weights; weights are 1 except in a mixture.
  [[nodiscard]] const std::vector<Term>& terms() const;
  /// The same combinator with its options for other guides, one or none for each term; a mixture keeps the weights of
  /// those that remain. None without any. Not for a component.
  /// \param parts  as many as terms(), in their order
  [[nodiscard]] std::optional<GuideSpec> with_parts(const std::vector<std::optional<GuideSpec>>& parts) const;

  /// Whether it contains a component that searches a space (S other than {0}).
  [[nodiscard]] bool searches() const;

  /// One line in the language, with the options that differ from their defaults: "skeleton() >> shrink(0.5) >> lazy()".
  [[nodiscard]] std::string text() const;
  /// Its components as a tree, one line per level, the guide nearest to the root first; ends with a newline.
  [[nodiscard]] std::string tree() const;

  friend bool operator==(const GuideSpec& a, const GuideSpec& b);
  /// `above >> guided`: `above` guides the searches of the spaces of `guided`.
  /// \param above  guides them
  /// \param guided  a component, or a combination, in each part of which that searches a space `above` is inserted
  /// \throws Error where `guided` searches no space
  friend GuideSpec operator>>(const GuideSpec& above, const GuideSpec& guided);
  /// A mixture, to which each guide contributes its weight.
  /// \param a, b  a guide without a weight has the weight 1; the terms of mixtures are joined
  friend GuideSpec operator+(const GuideSpec& a, const GuideSpec& b);
  /// A mixture with the weight of the guide multiplied.
  /// \param weight  relative to those of the other terms
  /// \param guide  of a mixture, the weight of each term is multiplied
  /// \throws Error for a weight that is not finite and positive
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

/// `a .. b .. c`: the spaces take turns, and each passes what it found to the next. `a .. b` in Lua is sequence({a,
/// b}).
/// \param parts  at least one, in the order of their turns
/// \param turn  proposals of a turn, at least 1
/// \throws Error without parts, or for a turn that is out of range
GuideSpec sequence(const std::vector<GuideSpec>& parts, std::int64_t turn = default_turn);
/// A mixture whose weights adapt to the results of its parts.
/// \param parts  at least one
/// \param settings  floor, decay, credit and rule (BlendSettings)
/// \throws Error without parts, for a setting out of range, and for credit "efficiency" with rule "exp3"
GuideSpec blend(const std::vector<GuideSpec>& parts, const BlendSettings& settings = {});
/// Guides in order, each until it is refuted.
/// \param parts  at least one, in the order in which they guide
/// \param settings  rounds, and the turn in proposals; an infinite turn ends only with the refutation
/// \throws Error without parts, or for a setting out of range
GuideSpec schedule(const std::vector<GuideSpec>& parts, const ScheduleSettings& settings = {});
/// Guides whose spaces are searched alternately with growing budgets. The first path found guides until it is refuted.
/// \param parts  at least one
/// \param settings  the first slice, in proposals
/// \throws Error without parts, or for a setting out of range
GuideSpec race(const std::vector<GuideSpec>& parts, const RaceSettings& settings = {});

/// An executable strategy: a planner at the root, with or without a guide.
class StrategySpec {
 public:
  /// \param planner  of the configuration space of the robot, without a guide
  /// \throws Error for a planner that searches only explicit graphs
  StrategySpec(PlannerSpec planner);  // NOLINT(google-explicit-constructor): a planner is a strategy
  /// A strategy whose guide guides the planner at the root.
  /// \param planner  of the configuration space of the robot
  /// \param guide  of the planner's proposals
  /// \throws Error for a planner that searches only explicit graphs
  StrategySpec(PlannerSpec planner, GuideSpec guide);

  [[nodiscard]] const PlannerSpec& planner() const { return planner_; }
  [[nodiscard]] const GuideSpec* guide() const { return guide_ ? &*guide_ : nullptr; }
  /// The same strategy with another value of an option of its planner: PlannerSpec::with.
  /// \param option  of the planner at the root
  /// \param value  of the option's type and in its range
  /// \throws Error for an unknown option or an invalid value
  [[nodiscard]] StrategySpec with(const std::string& option, const OptionValue& value) const;

  /// One line in the language.
  [[nodiscard]] std::string text() const;
  /// The hierarchy as a tree, one level per line, the root first; ends with a newline.
  [[nodiscard]] std::string tree() const;
  /// The spec as canonical JSON with every option: equal specs give equal bytes.
  [[nodiscard]] std::string json() const;
  /// A stable hash of json().
  [[nodiscard]] std::uint64_t hash() const;

  friend bool operator==(const StrategySpec& a, const StrategySpec& b) = default;
  /// `above >> guided`: `above` guides the guide of `guided`, or its planner where it has no guide.
  /// \param above  guides them
  /// \param guided  a planner, with or without a guide
  /// \throws Error where the guide of `guided` searches no space
  friend StrategySpec operator>>(const GuideSpec& above, const StrategySpec& guided);

 private:
  PlannerSpec planner_;
  std::optional<GuideSpec> guide_;
};

/// A strategy whose guide guides the planner at the root.
/// \param above  guides the planner's proposals
/// \param planner  of the configuration space of the robot
/// \throws Error for a planner that searches only explicit graphs
StrategySpec operator>>(const GuideSpec& above, const PlannerSpec& planner);
/// `split { guide >> planner }` is `guide >> split { planner }`: the guide applies to each half.
/// \param part  the strategy of each half
/// \param settings  depth, tries and effort
/// \throws Error for a setting out of range
StrategySpec split(const StrategySpec& part, const SplitSettings& settings = {});

}  // namespace trellis
