// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/error.hpp>
#include <trellis/planner/guidance.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/space/space.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// The tree of a bidirectional planner that a draw is for.
using Side = TreeSide;

/// What a sampler drew.
struct Draw {
  std::uint64_t id = 0;          ///< of this draw, from 1; its answer names it
  bool guided = false;           ///< by the guide; else uniform or a goal
  std::uint32_t node = no_node;  ///< the node that the guide would extend; no_node: the nearest
};

/// What a sampler assumes of its planner.
struct SamplerOptions {
  /// Longest extension of the planner's tree, metres in the metric: guides follow paths in such steps. 0: none, as of
  /// Trellis' own roadmaps, whose draws are denser.
  double step = 0.5;
  double uniform = 0.05;   ///< share of uniform draws, in [0, 1]
  double goal_bias = 0.0;  ///< share of draws that are a goal, in [0, 1), for a planner that draws none itself
  /// Work, in validity checks and proposals, that the searches below may spend before a draw; while they are not done,
  /// draws are uniform. 0: 1.5 times the checks of the straight motion from start to goal.
  double grant = unlimited;
  bool optimistic = false;                 ///< no answers will come: each draw counts as accepted
  std::function<bool()> interrupted = {};  ///< polled before each draw; if true, `draw` throws SamplerInterrupted

  static constexpr double unlimited = std::numeric_limits<double>::infinity();
};

/// Thrown by `Sampler::draw` where SamplerOptions::interrupted returned true.
class SamplerInterrupted : public Error {
 public:
  using Error::Error;
};

/// How far the search of the guiding space is.
enum class Found : std::uint8_t {
  untried,    ///< not begun
  searching,  ///< it pauses
  found,      ///< a path, or there is nothing to search: the guide draws
  nothing,    ///< it ended without a path
  impossible  ///< the guiding space is finite and contains no path
};

/// A guide (f, h) that a planner elsewhere draws from: one of OMPL, of a script in Python, of one's own. The sampler
/// searches the guiding spaces, as a run of Trellis does, and learns from what becomes of the draws.
///
/// For each draw, in this order: `spent`, `draw`, one answer (`accepted` or `rejected`), the motions that the planner
/// tries besides (answers with id 0), and `joined` for nodes of a roadmap that became connected. The same seed and the
/// same answers give the same draws, and those that the same planner draws within Trellis.
///
/// One thread uses a sampler at a time; several samplers may be used at the same time. Nodes have numbers: 0 is the
/// start, the others follow in the order of their answers.
class Sampler {
 public:
  /// Copies guide and problem. Guides are set up at the first draw.
  /// \param guide  of the planner's proposals
  /// \param problem  that the planner solves; start and goals valid
  /// \param seed  of all random streams
  /// \param options  of the planner
  /// \throws Error for a problem that fails `check`, a guide that does not suit it, or an option out of range
  Sampler(const GuideSpec& guide, const Problem& problem, std::uint64_t seed, const SamplerOptions& options = {});
  Sampler(Sampler&&) noexcept;
  Sampler& operator=(Sampler&&) noexcept;
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;
  ~Sampler();

  /// Draws the next proposal, after the searches below that it needs. A draw that has no answer at the next one counts
  /// as rejected without a place.
  /// \param out  receives it: inside the space, possibly invalid
  /// \param side  the tree that it is for
  /// \throws Error if `out` has another dimension, if a guide cannot make its space, and SamplerInterrupted
  Draw draw(MutableView out, Side side = Side::start);
  /// Draws several proposals, of which each counts as accepted.
  /// \param n  number of rows
  /// \throws Error unless SamplerOptions::optimistic; and as `draw`
  Configurations draw_many(std::size_t n, Side side = Side::start);

  /// The number of a root: the start, or a goal, which is added as a node at the first call.
  /// \param goal  index of the problem's goal; 0 for the start
  /// \throws Error for a goal that the problem does not have
  std::uint32_t root(Side side, std::size_t goal = 0);
  /// The number of the node with exactly these coordinates; no_node: there is none.
  /// \throws Error for another dimension, or coordinates that are not finite
  [[nodiscard]] std::uint32_t node(View q);
  [[nodiscard]] std::size_t nodes() const;  ///< the number of nodes
  /// The coordinates of a node.
  /// \param node  its number
  /// \throws Error for an unknown node
  [[nodiscard]] Configuration configuration(std::uint32_t node);

  /// Answers that a node was added.
  /// \param id  of the last draw; 0: the planner tried this motion without a draw
  /// \param q  the node
  /// \param parent  that it was extended from; no_node: it has none, as in a roadmap
  /// \param reached  q is the draw itself
  /// \param connected  checked motions connect it to the start; with Side::goal to a goal
  /// \param side  the tree that it belongs to
  /// \return its number
  /// \throws Error for a draw that is not the last one or has an answer, an unknown parent, or a q that is not finite
  std::uint32_t accepted(std::uint64_t id, View q, std::uint32_t parent, bool reached, bool connected = true,
                         Side side = Side::start);
  /// Answers that no node was added, or that a motion is invalid.
  /// \param id  as above
  /// \param from  valid end of the motion; empty: there was no motion
  /// \param to  its other end; for id 0 not empty
  /// \param first_invalid  a configuration on it that was found invalid; empty: it was out of reach
  /// \throws Error as above
  void rejected(std::uint64_t id, View from, View to, View first_invalid);
  /// A node of a roadmap became connected to the start or to a goal.
  /// \param node  its number
  /// \throws Error for an unknown node
  void joined(std::uint32_t node, Side side = Side::start);
  /// The planner discarded its tree or roadmap: the start has number 0 again, and the others follow anew.
  void cleared();
  /// The planner has found a path, the first or a shorter one.
  /// \param length  in metres in the metric
  void path_found(double length);

  /// Whether the guide has no evidence against a motion beyond the last draw, as to a goal or to the other tree.
  /// \throws Error as `node`
  [[nodiscard]] bool worth_connecting(View from, View to);
  /// Factor >= 1 on the cost of an edge in a search of a lazy roadmap: larger where it leaves the guiding paths.
  /// \throws Error as `node`
  [[nodiscard]] double edge_factor(View a, View b);

  /// Adds validity checks of the planner since the last call: guides divide work by them.
  void spent(std::uint64_t checks);
  /// Searches below, without a draw.
  /// \param checks  at most about so much work, in checks and proposals
  /// \return whether `level` is final
  bool allow(std::uint64_t checks);
  /// How far the search of the guiding space is; of several, the best.
  [[nodiscard]] Found level() const;
  /// Validity checks of all levels below and of the guide itself, without the planner's.
  [[nodiscard]] std::uint64_t checks() const;
  /// The density of the next draw, per volume in metric coordinates; none without a closed form. Searches below as
  /// `draw` does.
  /// \param q  of the space
  [[nodiscard]] std::optional<double> density(View q);
  /// The records of all levels, the planner's first, with its answers and checks.
  [[nodiscard]] std::vector<LevelRecord> levels();
  /// The space of the problem.
  [[nodiscard]] const Space& space() const;

 private:
  class Asked;
  std::unique_ptr<Asked> asked_;
};

/// Who takes its turn, of a planner alone and the same planner with a guide.
enum class Who : std::uint8_t { alone, guided };

/// Bounded loss for planners elsewhere: a planner alone and one with a guide, each in a thread of its own, of which one
/// runs at a time. They pause where they call `spent`, within a draw or a validity check, so neither notices. The one
/// alone begins.
///
/// Theorem. Let U be the checks of the planner alone until it has a path, where it is deterministic. Both together
/// spend at most bound U + slice + w checks, where w is the largest number that one call of `spent` announces. Proof:
/// the guided one runs only while its checks are at most (bound - 1) times those of the one alone plus `slice`, which
/// it exceeds by one call at most; the one alone spends at most U, since the first path ends both. No such bound holds
/// for planners that read a clock, as OMPL's PRM.
class Bounded {
 public:
  /// \param bound  more than 1
  /// \param slice  checks that the guided one may be ahead, at least 1
  /// \throws Error for values out of range
  explicit Bounded(double bound = 2.0, std::uint64_t slice = 256);

  /// Runs both planners until one returns true, or both have returned.
  /// \param alone, guided  return whether they have found a path; they call `spent`, and return soon after `over`
  /// \return who found a path first; none where neither did
  /// \throws what one of them threw, when both have returned
  std::optional<Who> run(const std::function<bool()>& alone, const std::function<bool()>& guided);
  /// Adds checks that the calling planner has spent, and waits for its turn.
  void spent(Who who, std::uint64_t checks);
  /// Whether the other one has a path: a planner's termination condition.
  [[nodiscard]] bool over() const;
  /// Checks so far.
  [[nodiscard]] std::uint64_t checks(Who who) const;

 private:
  [[nodiscard]] Who next() const;
  bool take_part(Who who, const std::function<bool()>& planner);

  double bound_;
  std::uint64_t slice_;
  mutable std::mutex mutex_;
  std::condition_variable turn_;
  std::array<std::uint64_t, 2> checks_{};
  std::array<bool, 2> ended_{};
  std::optional<Who> found_;
};

}  // namespace trellis
