// SPDX-License-Identifier: GPL-3.0-or-later
// What each loop of a planner's steps does: it compares the budget, draws proposals from h, and records them.
#pragma once

#include <chrono>

#include <trellis/planner/common.hpp>

namespace trellis {

/// Compares a budget with what a level has spent, during one solve.
class BudgetMonitor {
 public:
  /// \param stopped  the seconds that the run has waited so far, which do not count; nullptr: none
  BudgetMonitor(const Instance& instance, const Search& search, const Budget& budget, const double* stopped = nullptr)
      : instance_(instance),
        search_(search),
        budget_(budget),
        stopped_(stopped),
        begin_(std::chrono::steady_clock::now()),
        stopped_before_(stopped != nullptr ? *stopped : 0.0) {}

  /// Whether the budget is spent. Its cost permits a call before every step.
  /// \param draws  whether the limit of proposals applies
  [[nodiscard]] bool reached(bool draws) {
    if (draws && static_cast<double>(search_.proposals.size()) >= budget_.proposals) return true;
    if (static_cast<double>(instance_.checks.validity) >= budget_.checks) return true;
    // Reading the clock costs more.
    if ((asked_++ & 63U) != 0 || budget_.seconds == Budget::unlimited) return false;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
    const double waited = stopped_ != nullptr ? *stopped_ - stopped_before_ : 0.0;
    return search_.seconds + elapsed.count() - waited >= budget_.seconds;
  }

 private:
  const Instance& instance_;
  const Search& search_;
  Budget budget_;
  const double* stopped_;
  std::chrono::steady_clock::time_point begin_;
  double stopped_before_;
  unsigned asked_ = 0;
};

/// Draws a proposal from h, and records it with its source and the distribution that it was drawn from.
/// \param plan  of the step
/// \param stream  of the planner
/// \param proposal  receives it
inline void draw_proposal(Guidance& h, const Plan& plan, Stream& stream, Search& search, MutableView proposal) {
  Instance::announce_proposal();
  if (plan.tree) h.select_tree(*plan.tree);
  const Guidance::Source source = h.sample(stream, proposal);
  search.density.served(h);
  search.proposals.push(proposal);
  search.proposal_sources.push_back(source);
}

/// Records the outcome of the last proposal, and reports it to h.
inline void record_outcome(Guidance& h, const Outcome& outcome, Search& search) {
  search.fates.push_back(outcome.fate);
  search.near.push_back(outcome.near_row);
  search.added.push_back(outcome.added_row);
  h.observe(outcome, true);
}

/// The solution of a solve that ended with a status, which may be one of a search that did not begin.
inline Solution solution_of(Planner& planner, const Instance& instance, Status ended) {
  if (ended == Status::invalid_start) return {ended, Configurations(instance.space.dimension())};
  if (ended == Status::invalid_goal) return {ended, path_of_start(instance)};
  return planner.solution(ended);
}

}  // namespace trellis
