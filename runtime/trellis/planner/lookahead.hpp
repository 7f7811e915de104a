// SPDX-License-Identifier: GPL-3.0-or-later
// Several threads for one search: what its coming steps will ask is computed ahead, so its results stay the same.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/helper_threads.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

/// What one coming step will ask: nearest nodes, and motions. One thread fills it in.
class StepAhead {
 public:
  struct Nearest {
    const void* tree = nullptr;
    Configuration q;
    NearestIndex::Neighbour node;
  };
  struct Motion {
    Configuration from;
    Configuration to;
    MotionReport report;
  };

  Configuration proposal;
  Configuration target;  ///< memory for the end of an extension
  // Of a roadmap:
  std::optional<bool> valid;                        ///< the proposal
  std::vector<NearestIndex::Neighbour> neighbours;  ///< of a valid proposal
  std::size_t nodes = 0;                            ///< number of nodes among which they were found
  std::vector<std::uint32_t> components;            ///< memory for the components that it is connected to

  void clear() {
    nearest_count_ = motion_count_ = 0;
    valid.reset();
    nodes = 0;
  }
  /// Adds a node of a tree that is the nearest to q of those that the tree has now.
  void add_nearest(const void* tree, View q, NearestIndex::Neighbour node) {
    if (nearest_count_ == nearest_.size()) nearest_.emplace_back();
    Nearest& entry = nearest_[nearest_count_++];
    entry.tree = tree;
    entry.q.assign(q.begin(), q.end());
    entry.node = node;
  }
  void add_motion(View from, View to, const MotionReport& report) {
    if (motion_count_ == motions_.size()) motions_.emplace_back();
    Motion& entry = motions_[motion_count_++];
    entry.from.assign(from.begin(), from.end());
    entry.to.assign(to.begin(), to.end());
    entry.report = report;
  }
  /// The node that was added for this tree and q; nullptr: none was.
  [[nodiscard]] const NearestIndex::Neighbour* nearest(const void* tree, View q) const {
    for (std::size_t i = 0; i < nearest_count_; ++i) {
      if (nearest_[i].tree == tree && equal(nearest_[i].q, q)) return &nearest_[i].node;
    }
    return nullptr;
  }
  /// The report that was added for this motion; nullptr: none was.
  [[nodiscard]] const MotionReport* motion(View from, View to) const {
    for (std::size_t i = 0; i < motion_count_; ++i) {
      if (equal(motions_[i].from, from) && equal(motions_[i].to, to)) return &motions_[i].report;
    }
    return nullptr;
  }

 private:
  static bool equal(View a, View b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

  std::vector<Nearest> nearest_;
  std::vector<Motion> motions_;
  std::size_t nearest_count_ = 0;
  std::size_t motion_count_ = 0;
};

/// The coming steps of a planner, as far as they are computed ahead.
class StepsAhead {
 public:
  virtual ~StepsAhead() = default;
  /// The number of nodes of the search; 0 where steps cannot be computed ahead.
  [[nodiscard]] virtual std::size_t nodes() const = 0;
  /// Fills in a step, from its proposal on. Called by helpers.
  /// \param step  index of the step among those to come: 0 is the next one
  virtual void look_ahead(std::size_t step, StepAhead& ahead, Validity& validity) const = 0;
  /// Called when steps have been computed, and where that ends.
  /// \param begins  nodes that are added from now on are new to the steps; else none is
  virtual void mark_new_nodes(bool begins) = 0;
};

/// The steps ahead of one planner, computed in turns by its helpers while the search waits. Answers are those that the
/// search would find itself, because motions are asked of equal checkers, and nodes that were added since are compared
/// (Tree::nearest). A step that does not come, or that asks something else, costs time alone.
///
/// It works for proposals that do not depend on the search (Guidance::preview), and for validities that have equals for
/// other threads (Validity::for_thread). It measures from time to time whether steps take less time with helpers, and
/// does without them where they do not.
class Lookahead {
 public:
  /// Measures a step, while it exists.
  class Timed {
   public:
    explicit Timed(Lookahead* measures) : measures_(measures) {
      if (measures_ != nullptr) begin_ = Clock::now();
    }
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;
    ~Timed() {
      if (measures_ != nullptr) measures_->spent_ += Clock::now() - begin_;
    }

   private:
    Lookahead* measures_;
    std::chrono::steady_clock::time_point begin_;
  };

  /// \param h  that the proposals are drawn from
  /// \param helpers  nullptr: nothing is computed ahead
  Lookahead(const Instance& instance, const Guidance& h, HelperThreads* helpers)
      : instance_(instance), h_(h), helpers_(helpers) {}

  /// Begins a step with a proposal: computes further ones if none is left.
  [[nodiscard]] Timed begin_step(Planner& planner) {
    if (helpers_ == nullptr) return Timed(nullptr);
    StepsAhead* of = planner.coming();
    return of != nullptr ? begin(*of, planner.stream()) : Timed(nullptr);
  }
  /// Called with the proposal that was drawn.
  void drawn(View proposal) {
    if (next_ < count_) find(proposal);
  }
  /// Forgets all steps: trees have lost nodes, or the instance has changed.
  void clear() {
    next_ = count_ = 0;
    present_ = nullptr;
  }
  /// What was computed for the present step; nullptr: nothing.
  [[nodiscard]] const StepAhead* present() const { return present_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Phase : std::uint8_t { measure_alone, measure_ahead, alone, ahead };

  Timed begin(StepsAhead& of, const Stream& stream);
  void next_phase(StepsAhead& of);
  void enter(Phase phase, std::size_t steps);
  /// Returns whether steps were computed.
  bool compute(StepsAhead& of, Stream stream);
  void find(View proposal);
  [[nodiscard]] bool has_validities();

  const Instance& instance_;
  const Guidance& h_;
  HelperThreads* helpers_;
  std::vector<StepAhead> steps_;
  std::size_t count_ = 0;  ///< steps of this turn
  std::size_t next_ = 0;
  const StepAhead* present_ = nullptr;
  std::vector<std::shared_ptr<Validity>> validities_;  ///< of each worker; that of the search for the first
  std::uint64_t epoch_ = 0;                            ///< of the instance that they are equal to
  Phase phase_ = Phase::alone;
  std::size_t left_ = 512;  ///< steps of the phase: short searches do without helpers
  std::size_t taken_ = 0;   ///< steps that were measured
  Clock::duration spent_{};
  double alone_ = 0.0;      ///< seconds of a step without helpers
  std::size_t rounds_ = 0;  ///< how often helpers were no gain, one after the other
};

}  // namespace trellis
