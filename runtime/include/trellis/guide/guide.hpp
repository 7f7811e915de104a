// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
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

class Projection;

/// h of a guide whose space has been solved: a distribution that may request a new solve of its instance.
class Heuristic : public Guidance {
 public:
  /// Whether the instance in S must be solved again, with what the guide has learned since.
  [[nodiscard]] virtual bool stale() const { return false; }
  /// The guiding path in C (lifted from S); empty if there is none. In a sequence of spaces, the search of the next
  /// space begins along this path.
  [[nodiscard]] virtual Configurations lifted_path() const { return {}; }
};

/// What is known about C when f is applied.
struct Known {
  /// A proposal in C and its result.
  struct Sample {
    Configuration q;
    Fate fate = Fate::rejected;
    Configuration node;        ///< the node that was added; empty if none
    Configuration blocked_at;  ///< the first configuration found invalid; empty if none
    bool mine = false;         ///< whether this guide drew it
  };
  /// The path that a guide of C follows, lifted to C.
  struct Path {
    std::string guide;
    Configurations points;
  };
  std::vector<Sample> samples;  ///< in the order of the proposals
  std::size_t new_from = 0;     ///< number of samples that were known when f was last applied
  std::vector<Path> paths;      ///< of all guides of C that follow one, this guide included
  Configurations refuted;       ///< places of C that evidence refuted

  /// Whether there are samples since f was last applied.
  [[nodiscard]] bool has_new() const { return samples.size() > new_from; }
};

/// How a guide whose space is searched responds to evidence against its path: what it excludes from S before S is
/// solved again, and which further paths it asks for. By default it does nothing, and S is solved as it is.
class Repairs {
 public:
  virtual ~Repairs() = default;

  /// The maximum number of proposals for a path in S, within the budget of the search.
  /// \param again  whether S is solved again after h was refuted
  [[nodiscard]] virtual double effort(bool again) const {
    static_cast<void>(again);
    return Budget::unlimited;
  }
  /// Called after each solve of S, before `searched`. Lets a guide request another path; it may change S so that the
  /// next path differs.
  /// \param found  the path just found; nullptr if there is none
  /// \return the maximum number of proposals for the next path; 0 for none
  virtual std::int64_t another(const Solution* found) {
    static_cast<void>(found);
    return 0;
  }
  /// Called before `Guide::heuristic`. The reference is valid during the call only.
  /// \param search  the nodes of the search of S and their parents, over all solves
  virtual void searched(const Search& search) { static_cast<void>(search); }
  /// Called with a place that another guide of C refuted, or that C excluded because a level above refuted it. The
  /// guide may exclude the place from S, and treats a path through it as refuted.
  /// \param place  a configuration of C, valid during the call only
  virtual void avoid(View place) { static_cast<void>(place); }
  /// Called with each configuration found invalid in a C that presumes validity. The guide refutes a path that
  /// repeatedly leads there.
  /// \param q  a configuration of C, valid during the call only
  virtual void found_invalid(View q) { static_cast<void>(q); }
  /// Called when h is stale, before S is solved again. The guide may change S here.
  virtual void before_resolve() {}
  /// Called when a search for another path found none. h continues along the earlier path, if any, and is no longer
  /// stale.
  virtual void no_other_path() {}
  /// Returns the places of C at which evidence shows that a path in S has no counterpart in C.
  [[nodiscard]] virtual Configurations refuted_places() const { return {}; }
  /// Returns and clears the places that S has excluded since the last call, for the guide of the search of S.
  virtual Configurations take_lost_places() { return {}; }
  /// Returns and clears the configurations found invalid since the last call, in an S that presumes validity.
  virtual Configurations take_found_invalid() { return {}; }

 protected:
  Repairs() = default;
  Repairs(const Repairs&) = default;
  Repairs& operator=(const Repairs&) = default;
};

/// A guiding space (f, h) for one instance in C. It lives as long as the run; its space may be solved many times.
/// Parameters q have the dimension of C, parameters s that of S; neither is checked.
///
/// The executor calls it in this order:
///
///     sub = project(parent)                  nullptr: S = {0}
///     attach(sub)
///     once the planner in C asks h for a proposal:
///       repeat
///         S is solved                        project(q, s) for the nodes of C, lift for those of S
///         repairs().searched
///         h = heuristic(parent, sub, found)
///         for each proposal, until h is stale:
///           h.select_tree, h.sample          the planner extends a node; it may ask h.vertex and h.draw_control
///           learn(outcome), h.observe(outcome, mine)
///                                            the planner tries further motions; it may ask h.worth_connecting
///         repairs().before_resolve           S is solved again, as often as the option `resolves` allows
///
/// `learn` receives the outcomes of every guide of C. After the planner removed nodes, `restart` is called, and the
/// remaining nodes are learnt anew. A guide with S = {0} needs `heuristic` alone.
class Guide {
 public:
  virtual ~Guide() = default;

  /// f of the whole instance, with all its goals (project_ends): the instance in S; nullptr if S = {0}. Called again
  /// after the parent's world changed; the guide keeps what it has learned.
  /// \param parent  the instance in C; it outlives the guide
  /// \throws Error where the guide does not apply to the instance: the run ends with it
  virtual std::unique_ptr<Instance> project(const Instance& parent) = 0;
  /// f of one configuration. Not called where S = {0}.
  /// \param q  a configuration of C
  /// \param s  receives f(q), within the bounds of S
  virtual void project(View q, MutableView s) const = 0;
  /// Draws a configuration of C uniformly from the fibre of s: project(lift(s)) = s. Not called where S = {0}.
  /// \param s  a configuration of S
  /// \param stream  all random numbers of the draw come from it
  /// \param q  receives it; it may be invalid
  virtual void lift(View s, Stream& stream, MutableView q) const = 0;
  /// log of the density of `lift` at q, given s = f(q). A density over S at f(q) times this factor is the density of
  /// the lifted configuration at q, each with respect to volume in its own space's metric coordinates. 0 if S has the
  /// axes and weights of C; with other weights, the log of the Jacobian. Not called if S = {0}.
  /// \param q  a configuration of C
  [[nodiscard]] virtual double log_fibre_density(View q) const = 0;
  /// Makes h, the distribution over C, from the instance in S and the solution of its search. Called after every solve;
  /// keeps those observations that still apply. If S = {0}, `sub` and `found` are nullptr. A heuristic that checks
  /// validity (as the bridge test does) spends the parent's checks.
  /// \param parent  the instance in C; it outlives the heuristic
  /// \param sub  the instance in S that was searched
  /// \param found  solved or not: of a failed search its path leads to the node nearest to the goal
  /// \return never nullptr
  virtual std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) = 0;

  /// Called with every outcome in C. The guide may use it to change S before the next solve.
  /// \param outcome  its views are valid during the call only
  virtual void learn(const Outcome& outcome) { static_cast<void>(outcome); }
  /// Called when the planner in C removed nodes. The remaining nodes are then passed to `learn` again.
  virtual void restart() {}
  /// What it does with evidence against its path. The reference is valid as long as the guide.
  virtual Repairs& repairs();
  /// Passes the object that owns the instance made by `project` from now on; it outlives the search of S.
  /// \param sub  the instance that `project` returned
  virtual void attach(Instance& sub) { static_cast<void>(sub); }
  /// Whether log_fibre_density is known and gives the density of lifted samples for any density over S.
  [[nodiscard]] virtual bool closed_fibre() const { return true; }
  /// f as an object that remains valid after the guide. A record of the run uses it in place of the guide, which then
  /// ends with the run and releases what else it owns. nullptr: the record keeps the guide.
  [[nodiscard]] virtual std::shared_ptr<const Projection> shared_projection() const { return nullptr; }
  /// Whether f depends on what is known about C. Then `project_from` is called in place of `project`, and again before
  /// S is solved again because h is stale, and when the guide's turn in a sequence or a schedule comes after new
  /// samples.
  [[nodiscard]] virtual bool uses_known() const { return false; }
  /// f of the whole instance, made of what is known. The space S must be the same each time; world, robot, validity and
  /// graph may differ.
  /// \param parent  the instance in C; it outlives the guide
  /// \param known  valid during the call only
  virtual std::unique_ptr<Instance> project_from(const Instance& parent, const Known& known) {
    static_cast<void>(known);
    return project(parent);
  }
};

/// A guide with S = {0}: nothing is projected.
class SamplingGuide : public Guide {
 public:
  /// Prepares for an instance.
  /// \param parent  the instance in C; it outlives the guide
  /// \throws Error if the guide does not apply to it
  virtual void prepare(const Instance& parent) { static_cast<void>(parent); }

  std::unique_ptr<Instance> project(const Instance& parent) final {
    prepare(parent);
    return nullptr;
  }
  void project(View q, MutableView s) const final;
  void lift(View s, Stream& stream, MutableView q) const final;
  [[nodiscard]] double log_fibre_density(View q) const final;
};

/// What it costs to make a guide's space before its first search, in units of search_cost: a constant, and a rate for
/// each part.
struct SetUpRate {
  double constant = 0.0;
  double per_part = 0.0;
};

/// Such rates: for what depends on the world alone and is kept, and for the rest, which each run makes.
struct SetUpRates {
  SetUpRate world = {};
  SetUpRate run = {};
};

/// A kind of guide: its description and its factory.
struct GuideKind {
  const Component* component = nullptr;  ///< name, options and documentation; it outlives the program's use of the kind
  /// Makes a guide of one run, from validated options. Called by the threads of several runs at the same time.
  std::unique_ptr<Guide> (*make)(const Options&) = nullptr;
  /// The planner of the search of S unless a script names one; "" if S = {0}.
  std::string default_planner;
  /// The maximum number of further solves of S. The executor reads it.
  std::int64_t (*resolves)(const Options&) = nullptr;
  GuideClaims claims = {};
  /// Whether its space has an explicit graph that a sampling planner may ignore.
  bool graph_optional = false;
  /// A planner with its options. `guided_planner` searches S if a guide guides that search and the script names no
  /// planner; without a name, the default planner does.
  struct Planned {
    std::string name;
    std::vector<Options::Entry> options;
  };
  Planned guided_planner = {};
  /// Whether the search of S divides the instance by the robots of a team (guide/team.hpp): its planner and its guides
  /// are then those of each robot's search.
  bool divides_team = false;
  /// Measured by `scripts/bench-work`.
  SetUpRates planar = {};
  SetUpRates spatial = {};
  /// Returns the number of parts that the rates are for. nullptr: the size of the world (guide/set_up.hpp).
  /// \throws Error for options that would make too many
  double (*parts)(const Options&, const Scene&) = nullptr;

  /// Returns this kind with its set-up.
  /// \param in_plane  rates of planar scenes, in units of search_cost
  /// \param in_space  rates of scenes in space, in units of search_cost
  /// \param of  returns the number of parts that the rates are for; nullptr: the size of the world
  GuideKind set_up(const SetUpRates& in_plane, const SetUpRates& in_space,
                   double (*of)(const Options&, const Scene&) = nullptr) && {
    planar = in_plane;
    spatial = in_space;
    parts = of;
    return std::move(*this);
  }
};

/// Returns all guides, in the order of the reference. Thread-safe.
const std::vector<GuideKind>& guide_kinds();
/// Returns the guide with this name in scripts, as "shrink"; nullptr if there is none. Thread-safe.
/// \param name  exact
/// \return valid as long as the program
const GuideKind* find_guide(std::string_view name);

}  // namespace trellis
