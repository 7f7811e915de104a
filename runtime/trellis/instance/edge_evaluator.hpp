// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include <trellis/base/configurations.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// How a search of a roadmap alternates between search and edge evaluation: generalized lazy search (Mandalika,
/// Choudhury, Salzman and Srinivasa 2019).
struct LazyEvaluation {
  /// The event that stops the search for an evaluation.
  enum class Event : std::uint8_t {
    shortest_path,       ///< the search has found the shortest path to the goal (LazySP)
    constant_depth,      ///< a shortest subpath has `depth` edges without evaluation (LRA*)
    heuristic_progress,  ///< a vertex is nearer to the goal than the end of any evaluated subpath
    subpath_existence    ///< a shortest subpath is valid with a probability less than `existence`
  };
  /// Which edge of the subpath the search evaluates next.
  enum class Selector : std::uint8_t {
    alternate,  ///< the first and the last edge, in turns
    forward,
    backward,
    fail_fast  ///< the edge that is least likely to be valid: the longest
  };

  Event event = Event::shortest_path;
  std::int64_t depth = 1;
  double existence = 0.5;
  Selector selector = Selector::alternate;
};

/// Evaluates edges that a guiding space presumes valid. It checks them in the space that it was projected from, and
/// those checks count in that space's instance.
class EdgeEvaluator {
 public:
  virtual ~EdgeEvaluator() = default;

  [[nodiscard]] virtual const LazyEvaluation& how() const = 0;
  /// Starts or continues a search. \return a counter that grows when earlier evaluations may no longer be true
  virtual std::uint64_t begin() = 0;
  /// Whether the search has spent its evaluations and must return its candidate path.
  [[nodiscard]] virtual bool exhausted() const = 0;
  /// Whether the search evaluates single configurations of a candidate path before its edges.
  [[nodiscard]] virtual bool sparse_first() const = 0;
  [[nodiscard]] virtual bool state(View q) = 0;
  /// Evaluates single configurations of a motion, its ends excluded.
  [[nodiscard]] virtual MotionReport sparsely(View a, View b) = 0;
  [[nodiscard]] virtual MotionReport motion(View a, View b) = 0;
};

/// A presumed validity: the search of the space evaluates the edges of its candidate paths.
class EvaluatedValidity : public Validity {
 public:
  /// nullptr: no evaluator runs while the space is searched
  [[nodiscard]] virtual EdgeEvaluator* evaluator() = 0;
};

/// A guide whose space, during its search, spends checks of the instance that it was projected from.
class SpendsParentsChecks {
 public:
  virtual ~SpendsParentsChecks() = default;
  /// Sets that instance; the projection calls it. \param guided  whether a guide guides the search
  virtual void attach_parent(Instance& parent, bool guided) = 0;
};

}  // namespace trellis
