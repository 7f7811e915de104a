// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/custom.hpp>
#include <trellis/guide/team.hpp>
#include <trellis/planner/lookahead.hpp>
#include <trellis/planner/step.hpp>
#include <trellis/strategy/dividing_planner.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/ledger.hpp>
#include <trellis/strategy/level_heuristic.hpp>
#include <trellis/strategy/run.hpp>
#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

/// Completes the record of a proposal whose result is not known: SearchEnded has left its step.
/// \param driven  the planner has a motion model
void complete_proposals(Search& search, bool driven);

/// A level of a run: an instance, its planner, its guidance and its record.
class Level {
 public:
  /// \param lift  the guide that made the instance from the parent's; nullptr at the root
  Level(Run& run, Level* parent, std::string key, std::string name, std::unique_ptr<Instance> instance,
        const PlannerSpec& planner, std::shared_ptr<Guide> lift);

  /// See Run::abandon.
  ~Level() {
    if (run_.abandons_levels) run_.abandon(*this);
  }
  Level(const Level&) = delete;
  Level& operator=(const Level&) = delete;

  void guide_by(const GuideSpec& spec) {
    guide_spec_ = spec;
    h_.set_guide(make_guidance(run_, *this, spec));
  }
  /// Divides its instance by the robots of a team.
  /// \param guide  of the search of each robot; nullptr: none
  void divide(TeamDivision division, const GuideSpec* guide) {
    division_ = std::move(division);
    if (guide != nullptr) guide_spec_ = *guide;
  }
  /// Lowers the budget of its planner.
  void limit(const Budget& budget) {
    common_.budget.proposals = std::min(common_.budget.proposals, budget.proposals);
    common_.budget.checks = std::min(common_.budget.checks, budget.checks);
    common_.budget.seconds = std::min(common_.budget.seconds, budget.seconds);
  }

  /// Solves the instance, solves it again, or continues a solve: takes steps until the solve ends or the grant is
  /// spent. The levels below are searched when h needs them.
  Advance advance(const Grant& grant);
  /// A solve of the root, which pauses between any two steps: begins it, takes a step, and ends it once `ended`.
  void begin_root();
  void take_step();
  [[nodiscard]] bool ended() const { return ended_.has_value(); }
  Advance end();
  /// Ends a solve that SearchEnded has left.
  void leave();

  // Of a root whose planner is elsewhere (Sampler), which takes the place of `step`:
  /// \param planner  stands for it: it neither extends nor follows
  void plan_elsewhere(std::unique_ptr<Planner> planner) { planner_ = std::move(planner); }
  /// Searches the levels below where h needs it before the next proposal.
  /// \return the status if a limit ends the solve then
  [[nodiscard]] std::optional<Status> search_below();
  /// Draws a proposal from h, and records it.
  [[nodiscard]] View draw(const Plan& plan);
  /// What the planner has made.
  [[nodiscard]] Search& search() { return record_.search; }

  /// Makes a planner for nothing.
  /// \throws Error if its options do not suit the instance, as `advance` does
  void try_planner() { static_cast<void>(make_planner()); }

  /// Replaces the instance by a new projection of the parent's. The search keeps its valid part.
  void replace_instance(std::unique_ptr<Instance> instance);
  /// Refutes the path found, because its certificate failed. The next solve finds another path, and keeps what of the
  /// search its validity, which the caller has revised, still allows.
  void refute();

  /// Completes the record after the run and moves it out, except for its key.
  /// \param lift  see ExecuteOptions
  /// \param companion  a level whose samples and checks are added; nullptr: none
  LevelRecord take_record(bool lift, const Level* companion = nullptr);
  /// The record of a run that has not ended, completed. The run can continue.
  LevelRecord record_so_far(bool lift, const Level* companion = nullptr);
  /// Adds the turn that has not ended, if the level has made something in it.
  void add_open_turn(std::vector<Turn>& turns) const;

  /// Its proposals are those of a guided search beside a companion, which has the other random stream.
  void rely_on_companion() {
    ledger_.rely_on_companion();
    stream_ = "guided proposals";
  }
  /// Adds time spent for this level outside its solves, for the projection of its instance; seconds.
  void charge(double seconds) { record_.search.seconds += seconds; }

  /// What it has spent.
  [[nodiscard]] Ledger& ledger() { return ledger_; }
  /// Work of this level and all below it, as the level above counts it (Ledger::work).
  [[nodiscard]] double work() const { return ledger_.work(); }
  /// The counts of further solves by reason. The caller that requests a further solve increments them.
  [[nodiscard]] Resolves& resolves() { return record_.resolves; }
  /// Whether the last solve found a path.
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] Instance& instance() { return *instance_; }
  [[nodiscard]] LevelHeuristic& heuristic() { return h_; }
  [[nodiscard]] const LevelRecord& record() const { return record_; }
  [[nodiscard]] const PlannerSpec& planner() const { return planner_spec_; }
  /// The options of its planner that the level itself uses.
  [[nodiscard]] const PlannerCommon& common() const { return common_; }
  /// The guide that made its instance from the parent's; nullptr at the root.
  [[nodiscard]] Guide* projection() const { return lift_.get(); }
  /// The best solution of all solves.
  [[nodiscard]] const Solution& solution() const { return record_.solution; }

 private:
  /// While it exists, this level is charged and may spend a slice.
  class Active;

  /// Begins a solve, or continues one.
  void begin(const Grant& grant);
  /// A step: a proposal that h draws and the planner extends towards, or work without one.
  /// \return the status if the solve ends
  [[nodiscard]] std::optional<Status> step();
  /// The part that the present step searches.
  [[nodiscard]] DividingPlanner::Part part() {
    return ended_ || divides_ == nullptr ? DividingPlanner::Part{} : divides_->part();
  }
  /// The solution of the solve that has ended.
  [[nodiscard]] Solution solution_found();
  /// Ends a solve with a solution.
  Advance end(Solution found);
  /// Whether an interrupted search of an anytime planner is solved by the path that it has: not in a run that is
  /// interrupted, which ends the planner beside the search too.
  [[nodiscard]] bool keeps_path() const {
    return run_.ledger.ending() && parent_ == nullptr && !run_.ledger.interrupted();
  }
  [[nodiscard]] std::unique_ptr<Planner> make_planner();
  /// Ends this level's turn while a level below is solved.
  void pause();
  void end_turn(Configurations path, bool solve_ended);
  [[nodiscard]] Turn turn(Configurations path, bool solve_ended) const;
  /// Completes a record of this level.
  void complete(LevelRecord& record, bool lift, const Level* companion) const;
  /// Lifts rows of this level's space to the root's space, through all levels between. Each lift draws from the fibre.
  [[nodiscard]] Configurations lifted(const Configurations& rows, const std::string& purpose) const;
  /// Whether all fibres between this level's space and the root's have known densities.
  [[nodiscard]] bool closed_fibres() const;
  /// Lifts a density over this level's space to the root's space: its value at f of a configuration, times the density
  /// on the fibre. The result owns every f that it needs.
  [[nodiscard]] std::function<double(View)> lifted(std::function<double(View)> density) const;

  Run& run_;
  Level* parent_;
  std::shared_ptr<Guide> lift_;
  std::unique_ptr<Instance> instance_;
  const PlannerKind& kind_;
  PlannerSpec planner_spec_;
  std::optional<GuideSpec> guide_spec_;
  std::optional<TeamDivision> division_;
  PlannerCommon common_;
  LevelRecord record_;
  Ledger ledger_;
  LevelHeuristic h_;
  Lookahead lookahead_;
  std::unique_ptr<Planner> planner_;
  DividingPlanner* divides_ = nullptr;  ///< the planner, if it divides the instance
  Configuration proposal_;              ///< the last one
  bool solving_ = false;                ///< a solve has begun and not ended
  std::optional<Status> ended_;         ///< with which the steps of that solve ended
  bool found_ = false;
  std::size_t noted_ = 0;             ///< number of proposals and nodes when its last turn ended
  const char* stream_ = "proposals";  ///< purpose of the stream that h draws from
};

}  // namespace trellis
