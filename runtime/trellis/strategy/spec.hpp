// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/base/component.hpp>

namespace trellis {

class CustomGuide;

// The algebra of guiding spaces as plain, immutable data. Nothing runs until a strategy is executed.
//
//   guide >> guide = guide          planner is a strategy           w * guide = guide
//   guide >> strategy = strategy    guide + guide = guide           guide .. guide = guide (sequence)
//                                   blend { guide, ... } = guide
//
// Normal form: `a >> (b + c)` is `(a >> b) + (a >> c)`, and so with `..` and blend; sums and sequences are flat, blends
// are not; `(a >> b) >> c` and `a >> (b >> c)` are the same value. Laws: `>>` associates (with the planner at the end
// too), `+` and `..` associate, weights are normalised where they are used, nesting distributes over mixtures,
// sequences and blends.

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

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] const Origin& origin() const { return origin_; }
  /// "rrt { step = 0.5 }": the options that differ from their defaults.
  [[nodiscard]] std::string text() const;

  friend bool operator==(const PlannerSpec& a, const PlannerSpec& b) {
    return a.name_ == b.name_ && a.options_ == b.options_;
  }

 private:
  std::string name_;
  Options options_;
  Origin origin_;
};

/// How a blend follows what its parts achieved. Part i of n draws with probability
///
///     floor / n + (1 - floor) * w_i / sum w,    w_i = successes_i / attempts_i,
///
/// both begun at 1 and multiplied by `decay` before each outcome of a proposal of part i is counted. It is the rule by
/// which dynamic regions are chosen (Denny et al. 2016), with the parts for regions; the floor is what keeps every part
/// sampled, as exploration does in EXP3 (Auer et al. 2002).
struct BlendSettings {
  double floor = 0.2;
  double decay = 0.98;
  /// What a proposal's success is. "node": 1 where it led to a node. "reach": how long the extension to that node was,
  /// by the longest of the run so far; a node amid others is worth little.
  std::string credit = "node";

  friend bool operator==(const BlendSettings&, const BlendSettings&) = default;
};
/// The settings described, for scripts and help.
const Settings<BlendSettings>& blend_settings();

/// A guide: a component (f, h) with the guide of its own search, a mixture, a sequence, or a blend.
class GuideSpec {
 public:
  enum class Kind { component, mixture, sequence, blend };
  struct Term;

  /// A component without a guide of its own. `planner`: of its own search; none: the component's default.
  /// Throws Error for an unknown guide, a wrong option, or a planner that the guide's space cannot use.
  static GuideSpec make(const std::string& name, const std::vector<Options::Entry>& given,
                        std::optional<PlannerSpec> planner = {}, Origin origin = {});
  /// The same of a guide that is no component of the registry.
  static GuideSpec make(std::shared_ptr<const CustomGuide> custom, std::optional<PlannerSpec> planner = {},
                        Origin origin = {});

  [[nodiscard]] Kind kind() const;
  // Of a component:
  [[nodiscard]] const std::string& name() const;
  /// None of a custom guide.
  [[nodiscard]] const Options& options() const;
  /// nullptr for a guide of the registry.
  [[nodiscard]] const std::shared_ptr<const CustomGuide>& custom() const;
  /// The component without a guide of its own, its planner the default one: what a level is called by.
  [[nodiscard]] GuideSpec alone() const;
  /// The planner of its own search (the default filled in); none where S = {0}.
  [[nodiscard]] const std::optional<PlannerSpec>& planner() const;
  /// The guide of its own search, nullptr without.
  [[nodiscard]] const GuideSpec* below() const;
  [[nodiscard]] const Origin& origin() const;
  // Of a mixture, sequence or blend (weights other than a mixture's are 1):
  [[nodiscard]] const std::vector<Term>& terms() const;
  /// Proposals that each part of a sequence serves before the next one's turn.
  [[nodiscard]] std::int64_t turn() const;
  /// How a blend weighs its parts.
  [[nodiscard]] const BlendSettings& blending() const;

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

 private:
  struct Node;
  explicit GuideSpec(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  std::shared_ptr<const Node> node_;
};

struct GuideSpec::Term {
  double weight = 1.0;
  GuideSpec guide;
};

/// The default turn of a sequence, in proposals.
inline constexpr std::int64_t default_turn = 200;
/// `a .. b .. c`: each space serves a turn and informs the next. `a .. b` in Lua is sequence({a, b}).
GuideSpec sequence(const std::vector<GuideSpec>& parts, std::int64_t turn = default_turn);
/// A mixture whose weights follow what each part's proposals achieved. Throws Error without parts, or for settings out
/// of their range.
GuideSpec blend(const std::vector<GuideSpec>& parts, const BlendSettings& settings = {});

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

}  // namespace trellis
