// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include <trellis/base/configurations.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// How a search of a roadmap alternates between searching and evaluating edges: generalized lazy search (Mandalika,
/// Choudhury, Salzman and Srinivasa 2019).
struct LazyEvaluation {
  /// When the search stops for an evaluation.
  enum class Event : std::uint8_t {
    shortest_path,       ///< it holds the shortest path to the goal (LazySP)
    constant_depth,      ///< a shortest subpath has `depth` edges that were not evaluated (LRA*)
    heuristic_progress,  ///< a vertex is nearer to the goal than the end of any evaluated subpath
    subpath_existence    ///< a shortest subpath is valid with a probability less than `existence`
  };
  /// Which edge of the subpath is evaluated next.
  enum class Selector : std::uint8_t {
    alternate,  ///< the first or the last one, in turns
    forward,
    backward,
    fail_fast  ///< the one that is least likely to be valid: the longest
  };

  Event event = Event::shortest_path;
  std::int64_t depth = 1;
  double existence = 0.5;
  Selector selector = Selector::alternate;
};

/// Evaluates edges that a space presumes valid, in the space that it was made from and at that space's expense.
class EdgeEvaluator {
 public:
  virtual ~EdgeEvaluator() = default;

  [[nodiscard]] virtual const LazyEvaluation& how() const = 0;
  /// A search begins, or continues. \return grows when what was evaluated before need not hold any more
  virtual std::uint64_t begin() = 0;
  /// Whether the search has evaluated as much as it may before it returns its candidate path.
  [[nodiscard]] virtual bool exhausted() const = 0;
  /// Whether single configurations of a candidate path are to be evaluated before its edges.
  [[nodiscard]] virtual bool sparse_first() const = 0;
  [[nodiscard]] virtual bool state(View q) = 0;
  /// Evaluates single configurations of a motion, its ends excluded.
  [[nodiscard]] virtual MotionReport sparsely(View a, View b) = 0;
  [[nodiscard]] virtual MotionReport motion(View a, View b) = 0;
};

/// A validity that is presumed: who searches the space evaluates the edges of its candidate paths.
class EvaluatedValidity : public Validity {
 public:
  /// nullptr: nothing evaluates edges while the space is searched
  [[nodiscard]] virtual EdgeEvaluator* evaluator() = 0;
};

/// A guide whose space, while it is searched, spends the checks of the instance that it was made from.
class SpendsParentsChecks {
 public:
  virtual ~SpendsParentsChecks() = default;
  /// Where that instance lives. Called after it was projected. \param guided  whether a guide guides the search
  virtual void attach_parent(Instance& parent, bool guided) = 0;
};

}  // namespace trellis
