// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/guide/claims.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/planner/guidance.hpp>
#include <trellis/planner/planner.hpp>

namespace trellis {

/// h of a guide whose space has been solved: a distribution that may ask for its instance to be solved again.
class Heuristic : public Guidance {
 public:
  /// Whether the instance in S should be solved again with what was learnt.
  [[nodiscard]] virtual bool stale() const { return false; }
  /// The path in C along which it guides (lifted from S); empty where it has none. The search of the next space of a
  /// sequence begins along it.
  [[nodiscard]] virtual Configurations lifted_path() const { return {}; }
};

/// A guiding space (f, h) for one instance in C. Lives as long as the run; `solve` of its space may happen many times.
class Guide {
 public:
  virtual ~Guide() = default;

  /// f of the whole instance: the instance in S. Called again where the parent's world changed; what was learnt since
  /// stays. nullptr where S = {0}.
  virtual std::unique_ptr<Instance> project(const Instance& parent) = 0;
  /// Where the instance that `project` made lives from now on.
  virtual void attach(Instance& sub) { static_cast<void>(sub); }
  /// f of one configuration. Not called where S = {0}.
  virtual void project(View q, MutableView s) const = 0;
  /// A configuration of C drawn from the fibre of s (uniform on it): project(lift(s)) = s.
  virtual void lift(View s, Stream& stream, MutableView q) const = 0;
  /// log of the density of lift at q given s = f(q): what a density over S at f(q) is multiplied by to be that of the
  /// lifted configuration at q, each with respect to volume in its own space's metric coordinates. 0 where S has the
  /// axes of C with their weights; other weights make it the Jacobian's. Not called where S = {0}.
  [[nodiscard]] virtual double log_fibre_density(View q) const = 0;
  /// Whether log_fibre_density is known, and gives the density of what is lifted from any density over S.
  [[nodiscard]] virtual bool closed_fibre() const { return true; }
  /// h: the distribution over C from the instance in S and what its search found. Called after every solve; keeps what
  /// was observed before where that still holds. For S = {0}, `sub` and `found` are nullptr. A heuristic that looks at
  /// validity (bridge test) spends the parent's checks.
  virtual std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) = 0;
  /// Called before `heuristic` where S was searched: its nodes and their parents, over all solves. The view of them
  /// holds during the call only.
  virtual void searched(const Search& search) { static_cast<void>(search); }
  /// How many proposals a search of S for its first path may spend, within its own budget.
  [[nodiscard]] virtual double effort() const { return Budget::unlimited; }
  /// The same where S is searched again because h was refuted.
  [[nodiscard]] virtual double effort_again() const { return effort(); }
  /// Asked after each solve of the instance in S whether another path is wanted before h is made: how many proposals
  /// may be spent on finding it; 0: none is wanted. S may have been changed so that it will be another. \param found
  /// the path just found; nullptr where there was none
  virtual std::int64_t another(const Solution* found) {
    static_cast<void>(found);
    return 0;
  }
  /// Places of C through which evidence showed that no path in S leads to one in C.
  [[nodiscard]] virtual Configurations refuted_places() const { return {}; }
  /// Called with each such place that another guide of C found, or that C lost because evidence refuted it above: S may
  /// leave it out, and a path that leads through it is refuted.
  virtual void avoid(View place) { static_cast<void>(place); }
  /// Places that S has lost since this was asked last, for what guides the search of S.
  virtual Configurations take_lost_places() { return {}; }
  /// Called where C presumes validity, with each configuration of C that was found invalid after all: what leads there
  /// time and again is refuted.
  virtual void found_invalid(View q) { static_cast<void>(q); }
  /// Configurations of S, if that presumes validity, that were found invalid since this was asked last.
  virtual Configurations take_found_invalid() { return {}; }
  /// Told of every outcome in C, so that the instance in S can learn before it is solved again.
  virtual void learn(const Outcome& outcome) { static_cast<void>(outcome); }
  /// Called when the planner in C removed nodes: those that are left are learnt again.
  virtual void restart() {}
  /// Called when h was stale, before the instance in S is solved again: the time to change it.
  virtual void before_resolve() {}
  /// Called when a search for another path found none: h goes on along the path that was found before, if there is one,
  /// and is stale no more.
  virtual void no_other_path() {}
};

/// One kind of guide: its description and how to make it.
struct GuideKind {
  const Component* component = nullptr;
  std::unique_ptr<Guide> (*make)(const Options&) = nullptr;
  /// The planner of its own search unless a script names another; "" where S = {0}.
  std::string default_planner;
  /// How often a level below may be solved again; read by whoever runs it.
  std::int64_t (*resolves)(const Options&) = nullptr;
  GuideClaims claims = {};
  /// Its space comes with an explicit graph that a sampling planner may do without.
  bool graph_optional = false;
  /// The planner of its own search, unless a script names another, where a guide guides that search; no name: the
  /// default one.
  struct Planned {
    std::string name;
    std::vector<Options::Entry> options;
  };
  Planned guided_planner = {};
};

/// All guides, in the order of the reference.
const std::vector<GuideKind>& guide_kinds();
/// nullptr for an unknown name.
const GuideKind* find_guide(std::string_view name);

}  // namespace trellis
