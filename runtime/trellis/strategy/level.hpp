// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/custom.hpp>
#include <trellis/guide/team.hpp>
#include <trellis/planner/lookahead.hpp>
#include <trellis/planner/step.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/informed_path.hpp>
#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

/// Charges wall-clock time to the running level. While it waits for a level below, only that level is charged.
class Clock {
 public:
  /// Switches to `account` and returns the previous account, to switch back to.
  double* switch_to(double* account) {
    const auto now = std::chrono::steady_clock::now();
    if (account_ != nullptr) *account_ += std::chrono::duration<double>(now - since_).count();
    since_ = now;
    return std::exchange(account_, account);
  }

 private:
  double* account_ = nullptr;
  std::chrono::steady_clock::time_point since_;
};

/// CPU time of the calling thread, seconds.
double thread_seconds();

/// State that all levels of one run share.
struct Run {
  std::string problem;  ///< name of the problem
  std::uint64_t seed = 0;
  bool seeded = false;               ///< false if the strategy is only checked, not run
  bool densities = true;             ///< whether levels record the densities of their proposals
  HelperThreads* helpers = nullptr;  ///< of the searches; nullptr: none
  std::function<bool()> interrupted;
  std::function<void(const LevelRecord&, const Guidance&)> watch;
  Clock clock;
  std::vector<Level*> levels;  ///< in order of their numbers
  std::vector<Turn> turns;
  Level* active_level = nullptr;
  std::uint64_t searches = 0;             ///< slices of searches of levels below others, begun
  int first_solves = 0;                   ///< number of levels whose first solve has ended
  double cpu_begin = 0.0;                 ///< CPU time of the thread at the beginning of the run, seconds
  double lua_begin = 0.0;                 ///< lua_seconds() of the thread at the beginning of the run
  unsigned lua_depth = 0;                 ///< lua_depth() of the thread at the beginning of the run
  double stopped = 0.0;                   ///< time that the run waited between two steps, seconds
  std::vector<Improvement> improvements;  ///< of the root's path
  std::vector<TeamConflict> conflicts;
  bool refuted = false;  ///< its last path was refuted, and no other one is known yet
  RunShared shared;
  bool companion = false;  ///< it runs beside another run: its levels have the number -1
  double queries = 1.0;    ///< runs that share what is set up for the world
  double set_up = 0.0;     ///< work of setting up guides
  /// Called before each step of each level. Returns whether the run ends.
  std::function<bool()> before_step;
  bool ending = false;  ///< the planner beside the guided search has ended the run
  /// Called before a further set-up of so much work. Returns whether the run ends.
  std::function<bool(double work)> before_set_up;
  double estimated_set_up = 0.0;    ///< the caller has announced `set_up` up to this value
  double unannounced_set_up = 0.0;  ///< part of `set_up` that was not announced when it was counted
  bool abandons_levels = false;     ///< a level that ends now was not completed
  /// Ends the searches of all levels, after SearchEnded was thrown through them.
  void end_searches();
  /// Removes a level that was not completed. The root counts its checks from now on.
  void abandon(Level& level);
  /// Whether the time of the run is over, by the root's budget of seconds. Empty without such a budget.
  std::function<bool()> out_of_time;

  /// Counts the set-up of a guide's space. What depends on the world alone counts once in a run, with one part in
  /// `queries`.
  void count_set_up(const GuideSpec& guide, const Scene& scene);
  /// The same where f is applied again. What depends on a world that changed during this run counts with all of it: no
  /// other run asks it. Returns false, and counts nothing, where the run ends before.
  bool count_further_set_up(const GuideSpec& guide, const Scene& scene);
  /// Of all levels.
  [[nodiscard]] RunCost cost() const;

 private:
  /// Counts set-up work, and announces it as far as the caller has not announced it.
  void count_set_up(double work);

  std::set<std::pair<std::string, std::shared_ptr<const void>>> prepared_;  ///< guides and their worlds
};

/// The guidance of a level's planner: goal bias, uniform sampling, the guide, and a path received from another space.
///
/// It divides the work between guided and unguided proposals. Work is the number of validity checks and proposals, and
/// what searches of graphs do besides. The work of guided proposals and of all levels below is at most `guided_share`
/// times the work of unguided proposals, beyond a grant and beyond the work earned by progress along guiding paths. Of
/// the work below, what progress there has earned is deducted as far as guides have spent it, and the first search of a
/// graph does not count. If this limit is reached, or if the guide's space is still being searched, the planner draws
/// unguided proposals.
///
/// Beside a companion (at the root, with a bound of more than 1) the planner waits for the levels below. Their work
/// does not count, nor does the validation of their paths: the companion bounds it. The planner of a tree without a
/// path draws unguided proposals beyond the same limit, so that the tree leaves a place where its guide is stuck.
class LevelGuidance final : public Guidance {
 public:
  /// \param search  record of the level's planner; outlives this object
  LevelGuidance(const Instance& instance, const PlannerCommon& common, const Search& search)
      : instance_(instance),
        common_(common),
        search_(search),
        uniform_(instance.space),
        goal_(instance),
        informed_(instance) {}

  void set_guide(std::unique_ptr<SearchedGuidance> guide) { guide_ = std::move(guide); }
  [[nodiscard]] SearchedGuidance* guide() const { return guide_.get(); }
  /// Called before the search begins if `inform` may be called later.
  void expect_paths() { informed_.expect(); }
  void inform(Configurations path) { informed_.follow(std::move(path)); }
  [[nodiscard]] bool guided() const { return guide_ != nullptr || informed_.guides(); }

  void select_tree(TreeSide side) override {
    informed_.select_tree(side);
    if (guide_ != nullptr) guide_->select_tree(side);
  }
  /// Accounts for the work of the last proposal, decides whether the guide may draw the next one, and searches the
  /// levels below if necessary. Called before each step of the planner.
  void prepare() {
    if (!guided() || prepared_) return;
    prepared_ = true;
    charge(spent_);
    counted_ = own();
    const bool was_open = open_;
    open_ = true;
    const bool divides = common_.bound > 0.0 && !has_companion_;
    if (divides || leaves_stuck_guide()) {
      double guided = spent_.guided.work();
      if (!divides) {
        guided -= validation_;
      } else if (guide_ != nullptr) {
        guided += guide_->work();
      }
      left_ = grant() + earned() + guided_share() * spent_.unguided.work() - guided;
      open_ = left_ > 0.0;
    }
    if (open_ && guide_ != nullptr) {
      Slice slice;
      if (divides) slice.work = std::max(left_, least_slice);
      if (slice_left_) slice.work = std::min(slice.work, slice_left_());
      if (has_companion_ && guide_->draws_while_searching()) slice.work = std::min(slice.work, least_slice);
      // The guide pays for checks in this level's instance, as those that validate a path's points.
      const auto count = [this] {
        count_validation(own().checks - counted_.checks);
        counted_ = own();
      };
      Advance advance = Advance::unfinished;
      try {
        advance = guide_->prepare(slice);
        // The companion draws the planner's own proposals.
        while (has_companion_ && advance == Advance::unfinished) advance = guide_->prepare(slice);
      } catch (const SearchEnded&) {
        count();
        throw;
      }
      open_ = advance != Advance::unfinished;
      // A permanently refuted guide draws no more proposals.
      if (common_.bound > 0.0 && guide_->spent()) open_ = false;
      count();
    }
    if (open_ != was_open) ++epoch_;
  }
  Source sample(Stream& stream, MutableView out) override {
    const Source source = draw(stream, out);
    if (guided()) instance_.validity->expect_guided(drawn_ == Part::guide || drawn_ == Part::informed);
    return source;
  }
  [[nodiscard]] bool preview(Stream& stream, MutableView out) const override {
    if (guided()) return false;
    return stream.uniform() < common_.goal_bias ? goal_.preview(stream, out) : uniform_.preview(stream, out);
  }
  [[nodiscard]] std::uint32_t vertex() const override {
    const Guidance* h = drawn_from();
    return h != nullptr ? h->vertex() : no_node;
  }
  std::uint32_t draw_control(Stream& stream, const ControlQuery& query, MutableView control) override {
    if (drawn_ == Part::guide) return guide_->draw_control(stream, query, control);
    return drawn_ == Part::informed && informed_.guides() ? informed_.h().draw_control(stream, query, control) : 0;
  }
  [[nodiscard]] bool worth_connecting(View from, View to) const override {
    const Guidance* h = drawn_from();
    // Below the root more motions are valid than in C, and where validity is presumed all are: the guide alone knows
    // which ones are worth it, whichever part drew the proposal.
    if (h == nullptr && open_ && relaxed_) h = guide_.get();
    return h == nullptr || h->worth_connecting(from, to);
  }
  [[nodiscard]] double progress() const override {
    return informed_.progress() + (guide_ != nullptr ? guide_->progress() : 0.0);
  }
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override {
    return guide_ != nullptr ? guide_->edge_factor(a, b) : 1.0;
  }
  void lost(View place) {
    if (guide_ != nullptr) guide_->lost(place);
  }
  void found_invalid(View q) {
    if (guide_ != nullptr) guide_->found_invalid(q);
  }
  void restart() override {
    informed_.restart();
    if (guide_ != nullptr) guide_->restart();
  }

  [[nodiscard]] std::uint64_t epoch() const override {
    return epoch_ + informed_.epoch() + (guide_ != nullptr ? guide_->epoch() : 0);
  }
  void record(DensityRecord& record, double share) const override {
    const Shares of = shares();
    goal_.record(record, share * of.goal);
    uniform_.record(record, share * of.uniform);
    if (of.informed > 0.0) informed_.h().record(record, share * of.informed);
    if (of.guide > 0.0) guide_->record(record, share * of.guide);
  }

  void observe(const Outcome& outcome, bool mine) override {
    informed_.observe(outcome, mine && drawn_ == Part::informed);
    if (guide_ == nullptr) return;
    const double before = own().checks;
    guide_->observe(outcome, mine && drawn_ == Part::guide);
    // The guide pays for its own checks, whichever part drew the proposal.
    const double looked = own().checks - before;
    count_validation(looked);
    counted_.checks += looked;
  }
  void found(double length) override {
    has_path_ = true;
    if (path_found_) path_found_(length);
    if (guide_ != nullptr) guide_->found(length);
  }
  /// The same, without the length where nothing asks for it.
  template <class Length>
  requires std::invocable<Length>
  void found(const Length& length) { found(path_found_ || guide_ != nullptr ? length() : 0.0); }
  /// The path that the planner has found is not valid.
  void refuted() { has_path_ = false; }
  /// Sets a function that receives the length of each path that the level's planner finds.
  void report_paths(std::function<void(double)> report) { path_found_ = std::move(report); }

  /// Whether proposals of a source are guided: neither the goal nor uniform.
  [[nodiscard]] static bool is_guided(Source source) { return source >= 2; }
  [[nodiscard]] std::vector<std::string> sources() const override {
    std::vector<std::string> all = {"goal", "uniform", "informed path"};
    if (guide_ != nullptr) {
      for (auto& name : guide_->sources()) all.push_back(std::move(name));
    }
    return all;
  }

  /// The space is one below the root.
  void expect_relaxed() { relaxed_ = true; }
  /// A companion bounds the work of the levels below.
  void rely_on_companion() { has_companion_ = true; }
  /// Work of guided proposals and of the levels below, per work of unguided proposals.
  [[nodiscard]] double guided_share() const { return guided_rate * (common_.bound - 1.0); }
  /// Limits the work of the levels below in the current slice: they pause when `left` returns 0.
  void limit_slice(std::function<double()> left) { slice_left_ = std::move(left); }
  /// Work that the guide may spend initially.
  [[nodiscard]] double grant() const { return grant_rate * direct_ * instance_.checks_per_metre(); }
  /// Work that progress along guiding paths has earned.
  [[nodiscard]] double earned() const {
    return (has_companion_ ? companion_progress_rate : progress_rate) * progress_checks();
  }
  /// Work of this level that the level above does not count, because its search made progress: half of the checks of
  /// this progress; or what the guide has spent of its earnings, if that is more. The level above would end its guide's
  /// search in favour of unguided proposals though that search advances.
  [[nodiscard]] double deducted() const {
    const double half = deduction_rate * progress_checks();
    if (guide_ == nullptr) return half;
    return std::max(half, std::min(earned(), spent().guided.work() + guide_->work()));
  }
  /// Work of one kind of proposals.
  struct Spent {
    double checks = 0.0;
    double proposals = 0.0;
    double other = 0.0;
    [[nodiscard]] double work() const { return checks + proposals + other; }
  };
  struct BothSpent {
    Spent guided;  ///< includes the validation of guiding paths
    Spent unguided;
  };
  [[nodiscard]] BothSpent spent() const {
    BothSpent both = spent_;
    charge(both);
    return both;
  }

 private:
  enum class Part : std::uint8_t { goal, uniform, informed, guide };
  static constexpr double informed_share = 0.5;
  /// Of the guided share: with a bound of 2 the guided work is 0.8 of the unguided.
  static constexpr double guided_rate = 0.8;
  /// Initial grant of the guide, as a multiple of the checks of a straight motion from start to goal at the resolution:
  /// the minimum of any planner.
  static constexpr double grant_rate = 1.5;
  /// Earned by a metre of progress, as a multiple of the checks per metre. Leads of a decomposition need most: 4 to 6.
  static constexpr double progress_rate = 5.0;
  /// The same beside a companion, where it limits how long a tree stays at a place where its guide is stuck.
  static constexpr double companion_progress_rate = 3.0;
  /// Deducted for a metre of progress from the work that the level above counts, as a multiple of the checks per metre.
  /// Measured: above 0.5, nested searches cost more where the planner alone needs few checks; below, they cost more at
  /// narrow passages, where they save most.
  static constexpr double deduction_rate = 0.5;
  /// Minimum work of a level below before it pauses.
  static constexpr double least_slice = 32.0;

  /// Checks of as many metres as connected nodes have advanced along guiding paths.
  [[nodiscard]] double progress_checks() const { return instance_.checks_per_metre() * progress(); }

  /// Whether the unguided proposals of a tree, too, have a share while it has no path: they leave the place where its
  /// guide is stuck. Samples of a roadmap serve wherever they are, and the companion draws uniform ones.
  [[nodiscard]] bool leaves_stuck_guide() const {
    const bool tree = !search_.parents.empty() && search_.parents.front() != no_node;
    return common_.bound > 0.0 && has_companion_ && tree && !has_path_;
  }
  void count_validation(double checks) {
    spent_.guided.checks += checks;
    validation_ += checks;
  }

  Source draw(Stream& stream, MutableView out) {
    prepared_ = false;
    double u = stream.uniform();
    drawn_ = Part::goal;
    if (u < common_.goal_bias) return goal_.sample(stream, out);
    if (!open_ || !guided()) {
      drawn_ = Part::uniform;
      uniform_.sample(stream, out);
      return 1;
    }
    u = (u - common_.goal_bias) / (1.0 - common_.goal_bias);
    if (u < common_.uniform) {
      drawn_ = Part::uniform;
      uniform_.sample(stream, out);
      return 1;
    }
    u = (u - common_.uniform) / (1.0 - common_.uniform);
    if (informed_.guides() && (guide_ == nullptr || u < informed_share)) {
      drawn_ = Part::informed;
      informed_.h().sample(stream, out);
      return 2;
    }
    drawn_ = Part::guide;
    return static_cast<Source>(3 + guide_->sample(stream, out));
  }
  [[nodiscard]] Spent own() const {
    return {static_cast<double>(instance_.checks.validity), static_cast<double>(search_.proposals.size()),
            instance_.other_in_checks()};
  }
  /// Charges the work since `counted_` to the kind of the last proposal.
  void charge(BothSpent& both) const {
    const Spent now = own();
    Spent& side = drawn_ == Part::guide || drawn_ == Part::informed ? both.guided : both.unguided;
    side.checks += now.checks - counted_.checks;
    side.proposals += now.proposals - counted_.proposals;
    side.other += now.other - counted_.other;
  }

  /// The probability of each part in `sample`.
  struct Shares {
    double goal = 0.0;
    double uniform = 0.0;
    double informed = 0.0;
    double guide = 0.0;
  };
  [[nodiscard]] Shares shares() const {
    const double rest = 1.0 - common_.goal_bias;
    if (!guided() || !open_) return {common_.goal_bias, rest, 0.0, 0.0};
    const double guided_share = rest * (1.0 - common_.uniform);
    const double informed = !informed_.guides() ? 0.0 : guide_ == nullptr ? 1.0 : informed_share;
    return {common_.goal_bias, rest * common_.uniform, guided_share * informed, guided_share * (1.0 - informed)};
  }
  /// The part that drew the last proposal if guided, else nullptr.
  [[nodiscard]] const Guidance* drawn_from() const {
    if (drawn_ == Part::guide) return guide_.get();
    return drawn_ == Part::informed && informed_.guides() ? &informed_.h() : nullptr;
  }

  const Instance& instance_;
  PlannerCommon common_;
  const Search& search_;
  UniformGuidance uniform_;
  GoalGuidance goal_;
  InformedPath informed_;
  std::unique_ptr<SearchedGuidance> guide_;
  std::function<double()> slice_left_;
  std::function<void(double)> path_found_;
  double direct_ = instance_.to_goal(instance_.start);
  BothSpent spent_;
  Spent counted_;            ///< the level's work that `spent_` includes
  double validation_ = 0.0;  ///< part of the guided work: the checks by which guides validate their paths
  double left_ = 0.0;        ///< work that the guide may still spend
  bool open_ = false;        ///< whether the guide may draw
  bool prepared_ = false;    ///< `prepare` was called for the next proposal
  bool has_companion_ = false;
  bool relaxed_ = false;   ///< of a level below the root
  bool has_path_ = false;  ///< the planner has found a path
  Part drawn_ = Part::goal;
  std::uint64_t epoch_ = 0;  ///< number of changes of the shares
};

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
    guidance_.set_guide(make_guidance(run_, *this, spec));
  }
  /// Divides its instance by the robots of a team.
  /// \param guide  of the search of each robot; nullptr: none
  void divide(TeamDivision division, const GuideSpec* guide) {
    division_ = std::move(division);
    if (guide != nullptr) guide_spec_ = *guide;
  }
  /// Called with the work of the searches that its instance is divided into.
  void count_parts(double work) { parts_work_ = work; }
  /// Lowers the budget of its planner.
  void limit(const Budget& budget) {
    common_.budget.proposals = std::min(common_.budget.proposals, budget.proposals);
    common_.budget.checks = std::min(common_.budget.checks, budget.checks);
    common_.budget.seconds = std::min(common_.budget.seconds, budget.seconds);
  }

  /// Solves the instance, or solves it again. The levels below are solved when their guidance first has to draw.
  /// \param proposals  limit for this solve, within the level's budget
  const Solution& solve(double proposals = Budget::unlimited) {
    advance(proposals, {});
    return record_.solution;
  }
  /// Makes a planner for nothing.
  /// \throws Error if its options do not suit the instance, as `solve` does
  void try_planner() { static_cast<void>(make_planner()); }
  /// A solve of the root, step by step: begins it, and takes a step of it.
  void begin_root_solve();
  /// \return whether the solve ended
  bool step_root_solve();
  /// Completes the record of proposals whose results are not known: SearchEnded has left their step.
  void complete_proposals();
  /// Ends a solve that SearchEnded has left between two steps.
  void end_search();
  /// As `solve`, but within a slice. A search that the slice ends is unfinished; the next call continues it.
  Advance advance(double proposals, const Slice& slice);
  /// Work of this level, in validity checks: checks, proposals, and what searches of graphs do besides.
  [[nodiscard]] double own_work() const;
  /// What this level costs, without proposals that its search has from other levels.
  [[nodiscard]] RunCost cost() const;
  /// Called when its search has received the proposals of a half.
  void note_absorbed(std::size_t proposals) { absorbed_ += static_cast<double>(proposals); }
  /// Work of this level and all below it, as the level above counts it: less what is deducted for progress, and without
  /// `first_searches`.
  [[nodiscard]] double work() const;
  /// Own work of the first search of each graph that f made below the root, also in a changed world. The level above
  /// waits for these as for the set-up of a guide: without the path it would draw unguided proposals meanwhile. They
  /// end: each considers an edge at most once, and draws few proposals.
  [[nodiscard]] double first_searches() const {
    if (!kind_.graph || record_.depth <= 1) return 0.0;
    return first_searches_ + (searched_ ? 0.0 : own_work() - first_search_begun_);
  }
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
    guidance_.rely_on_companion();
    stream_ = "guided proposals";
  }

  /// Adds time spent for this level outside its solves, for the projection of its instance; seconds.
  void charge(double seconds) { record_.search.seconds += seconds; }

  /// The counts of further solves by reason. The caller that requests a further solve increments them.
  [[nodiscard]] Resolves& resolves() { return record_.resolves; }
  /// Whether the last solve found a path.
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] Instance& instance() { return *instance_; }
  [[nodiscard]] LevelGuidance& guidance() { return guidance_; }
  [[nodiscard]] const LevelRecord& record() const { return record_; }
  [[nodiscard]] const PlannerSpec& planner() const { return planner_spec_; }
  /// The options of its planner that the level itself uses.
  [[nodiscard]] const PlannerCommon& common() const { return common_; }
  /// The guide that made its instance from the parent's; nullptr at the root.
  [[nodiscard]] Guide* projection() const { return lift_.get(); }
  /// The best solution of all solves.
  [[nodiscard]] const Solution& solution() const { return record_.solution; }

 private:
  [[nodiscard]] Advance solve_own(double proposals, const Slice& slice);
  /// A solve, step by step. `end_solve` may be called when it has ended.
  void begin_solve(double proposals, const Slice& slice);
  /// Takes a step: a proposal that h draws and the planner extends towards, or work without one. The levels below are
  /// searched first, where h needs it.
  /// \return the status if the solve ends
  [[nodiscard]] std::optional<Status> step();
  /// Whether a limit ends the solve before the next step.
  [[nodiscard]] std::optional<Status> stop();
  /// Lets h search the levels below where it has to, and compares the limits again.
  [[nodiscard]] std::optional<Status> search_below();
  /// Draws a proposal from h, and records it.
  [[nodiscard]] View draw(const Plan& plan);
  /// The solution of the solve that has ended.
  [[nodiscard]] Solution solution_found();
  [[nodiscard]] Advance end_solve(Solution found);
  /// Whether an interrupted search of an anytime planner is solved by the path that it has: not in a run that is
  /// interrupted, which ends the planner beside the search too.
  [[nodiscard]] bool keeps_path() const {
    return run_.ending && parent_ == nullptr && !(run_.interrupted && run_.interrupted());
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
  double parts_work_ = 0.0;
  PlannerCommon common_;
  LevelGuidance guidance_;
  std::unique_ptr<Planner> planner_;
  LevelRecord record_;
  double work_limit_ = Budget::unlimited;  ///< value of `work()` at which the search pauses
  std::optional<double> solve_begun_;      ///< number of proposals when the unfinished solve began
  bool searched_ = false;                  ///< a solve of the instance of the present world has ended
  double first_search_begun_ = 0.0;        ///< value of `own_work()` before that instance
  double first_searches_ = 0.0;            ///< of those that have ended
  std::size_t noted_ = 0;                  ///< number of proposals and nodes when its last turn ended
  bool found_ = false;
  double absorbed_ = 0.0;             ///< proposals that its search has from other levels
  const char* stream_ = "proposals";  ///< purpose of the stream that h draws from
  bool solving_ = false;              ///< a solve has begun and not ended
  std::optional<Status> ended_;       ///< with which the steps of that solve ended
  std::optional<BudgetMonitor> budget_;
  Lookahead lookahead_;
  Configuration proposal_;  ///< the last one
  double whole_ = 0.0;      ///< limit of proposals of all slices of this solve
  double sliced_ = 0.0;     ///< limit of proposals of this slice
};

}  // namespace trellis
