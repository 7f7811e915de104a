// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/along_path.hpp>
#include <trellis/guide/custom.hpp>
#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/lengths.hpp>
#include <trellis/strategy/level.hpp>
#include <trellis/strategy/team_search.hpp>

namespace trellis {

namespace {

/// The guidance of a component: f makes the level below, whose solution gives h. h draws samples, receives outcomes,
/// and is made again after further solves.
class ComponentGuidance final : public Wrapping<SearchedGuidance, Heuristic>, public GuideSearch {
 public:
  ComponentGuidance(Run& run, Level& parent, const GuideSpec& spec, const std::string& key)
      : Wrapping(nullptr),
        run_(run),
        parent_(parent),
        spec_(spec),
        number_(run.levels.size()),
        name_(spec.text_alone()),
        guided_below_(spec.below() != nullptr) {
    double seconds = 0.0;
    double* above = run.clock.switch_to(&seconds);
    make(key);
    if (guide_->uses_known()) known_.emplace();
    auto sub = apply();
    run.clock.switch_to(above);
    if (!sub) return;
    const PlannerSpec planner = planner_for(spec, *sub, planners_above());
    level_ =
        located([&] { return std::make_unique<Level>(run, &parent, key, name_, std::move(sub), planner, guide_); });
    level_->charge(seconds);
    attach();
    if (!spec.custom() && find_guide(spec.name())->divides_team) {
      located([&] {
        TeamDivision division = division_of(spec.name(), spec.options(), level_->instance().scene->members());
        if (spec.below() != nullptr && division.how != Coordination::conflicts &&
            !guides_searches_of(*spec.below(), 1)) {
          throw Error(
              fmt::format("{0} guides no search of {1}, which have one robot each; use {0} in place of {1}, or "
                          "above couple {{ where = \"path\" }}",
                          spec.below()->text_alone(), spec.name()));
        }
        level_->divide(std::move(division), spec.below());
      });
    } else if (spec.below() != nullptr) {
      level_->guide_by(*spec.below());
    }
  }

  ~ComponentGuidance() override { replace(nullptr); }  // h may refer to its guide and to the level below

  /// The planner of the level below. A default planner suits the instance: with a motion model it is kinodynamic, and
  /// for an arm two trees replace one, which seldom finds a path there. It has the options that the guide sets for a
  /// guided search, and takes its lengths from the levels above.
  static PlannerSpec planner_for(const GuideSpec& spec, const Instance& sub,
                                 const std::vector<const PlannerSpec*>& above) {
    const PlannerSpec& standard = *spec.planner();
    if (spec.planner_given()) return standard;
    const auto in_place_of_it = [&](const char* name) {
      const bool guided = spec.below() != nullptr && !spec.custom();
      return with_lengths_of(above, PlannerSpec::make(name, guided ? find_guide(spec.name())->guided_planner.options
                                                                   : std::vector<Options::Entry>{}));
    };
    const bool driven = sub.motion_model != nullptr && !sub.graph;
    if (driven && !find_planner(standard.name())->kinodynamic) return in_place_of_it("kinodynamic_rrt");
    const bool arm = sub.scene != nullptr && sub.scene->manipulator() != nullptr;
    const bool standing = spec.custom() || find_guide(spec.name())->default_planner == standard.name();
    if (arm && standing && !driven && standard.name() == "rrt") return in_place_of_it("rrt_connect");
    return with_lengths_of(above, standard);
  }
  /// The planners of this guide's level and of those above it, the root's first.
  [[nodiscard]] std::vector<const PlannerSpec*> planners_above() const {
    std::vector<const PlannerSpec*> planners = {&parent_.planner()};
    for (int level = parent_.record().parent; level >= 0;) {
      const Level& above = *run_.levels[static_cast<std::size_t>(level)];
      planners.insert(planners.begin(), &above.planner());
      level = above.record().parent;
    }
    return planners;
  }

  void begin(const Slice& slice) override {
    slice_ = slice;
    ready_.reset();
    begins_solve_ = true;
    // A changed world requires a further solve.
    if (part() != nullptr && level_ && parent_.instance().scene != projected_ && !std::exchange(renewing_, true)) {
      renewed_for_ = &Resolves::changed_world;
    }
    // Its turn came after new samples.
    if (part() != nullptr && again_ && !std::exchange(renewing_, true)) renewed_for_ = &Resolves::new_turn;
    const bool outdated = level_ ? made_at_ != parent_.instance().epoch() : made_at_ == never;
    // A refuted h remains refuted, whatever has changed since.
    if (part() != nullptr && !renewing_ && outdated && !renewable()) make_heuristic();
    if (part() != nullptr && !renewing_ && !renewable()) ready_ = found_ ? Advance::found : Advance::nothing;
    if (ready_) return;
    if (level_) {
      begun_ = work_so_far();
      return;
    }
    make_heuristic();
    found_ = true;
    ready_ = Advance::found;
  }
  [[nodiscard]] GuideSearch* needs_search() override { return ready_ ? nullptr : this; }
  [[nodiscard]] Advance ready() const override { return ready_.value_or(Advance::unfinished); }

  bool project() override {
    if (std::exchange(begins_solve_, false)) {
      if (!begin_solve()) ready_ = Advance::unfinished;
      left_ = slice_.work - (work_so_far() - begun_);
      searched_from_ = level_->work();
    }
    if (!(work_left() > 0.0)) ready_ = Advance::unfinished;
    return !ready_;
  }
  [[nodiscard]] Level& level() override { return *level_; }
  /// The guide may request several paths.
  [[nodiscard]] Grant grant() override {
    return {more_ == 0 ? guide_->repairs().effort(renewing_) : static_cast<double>(more_),
            {slice_.proposals, work_left()}};
  }
  void learn(Advance advance) override {
    if (advance == Advance::unfinished) {
      ready_ = advance;
      return;
    }
    if (more_ == 0) {
      first_ = advance;
      if (renewing_) ++(level_->resolves().*renewed_for_);
    } else {
      ++level_->resolves().further_path;
    }
    more_ = guide_->repairs().another(level_->found() ? &level_->solution() : nullptr);
    if (more_ == 0) end_solve();
  }
  [[nodiscard]] double work() const override { return level_ ? level_->work() : 0.0; }
  [[nodiscard]] std::uint64_t refuted() const override { return refuted_; }
  [[nodiscard]] bool spent() const override { return part() != nullptr && part()->stale() && !renewable(); }
  [[nodiscard]] bool searches() const override { return level_ != nullptr; }

  /// h continues from the remaining nodes. Distributions of the registry (S = {0}) do not depend on nodes.
  void restart() override {
    guide_->restart();
    if (part() == nullptr) return;
    lost_ = std::max(lost_, part()->connected());
    Wrapping::restart();
    if (level_ || custom_) made_at_ = never;
  }
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override {
    if (parent_.instance().graph) return graph_factor(a, b);
    return part() != nullptr ? Wrapping::edge_factor(a, b) : 1.0;
  }
  Source sample(Stream& stream, MutableView out) override {
    part()->sample(stream, out);
    return 0;
  }
  [[nodiscard]] double progress() const override { return progress_ + Wrapping::progress(); }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_ + Wrapping::epoch(); }
  void record(DensityRecord& record, double share) const override {
    if (part() == nullptr) throw Fault("a guide that was not prepared has drawn nothing to record");
    part()->record(record, share);
  }

  void observe(const Outcome& outcome, bool mine) override {
    if (known_) remember(outcome, mine);
    guide_->learn(outcome);
    if (part() == nullptr) return;
    Wrapping::observe(outcome, mine);
    count_refutation(&Resolves::rejections);
  }

  void lost(View place) override {
    guide_->repairs().avoid(place);
    if (part() != nullptr) count_refutation(&Resolves::lost_place);
  }

  void found_invalid(View q) override {
    if (part() == nullptr || renewing_) return;
    guide_->repairs().found_invalid(q);
    count_refutation(&Resolves::presumed_valid);
  }

  [[nodiscard]] std::vector<std::string> sources() const override { return {name_}; }
  [[nodiscard]] Configurations guiding_path() const override {
    return part() != nullptr ? part()->lifted_path() : Configurations{};
  }

  [[nodiscard]] Configurations refuted_places() const override { return guide_->repairs().refuted_places(); }
  void add_paths(std::vector<Known::Path>& paths) const override {
    Configurations path = guiding_path();
    if (!path.empty()) paths.push_back({name_, std::move(path)});
  }

  void inform(const Finding& finding) override {
    if (!level_) return;
    again_ = again_ || (known_ && known_->has_new());
    for (std::size_t i = 0; i < finding.refuted.size(); ++i) lost(finding.refuted[i]);
    if (finding.path.empty()) return;
    const Space& space = level_->instance().space;
    Configurations projected(space.dimension());
    Configuration s(projected.dimension());
    for (std::size_t i = 0; i < finding.path.size(); ++i) {
      guide_->project(finding.path[i], s);
      if (space.contains(s)) projected.push(s);
    }
    level_->heuristic().inform(std::move(projected));
  }
  void expect_findings() override {
    if (level_) level_->heuristic().expect_paths();
  }

 private:
  using Reason = std::uint64_t Resolves::*;

  /// The factor of an edge of an explicit graph: the whole path weighs it.
  [[nodiscard]] std::optional<double> graph_factor(View a, View b) const {
    if (part() == nullptr || renewing_ || part()->stale()) return std::nullopt;
    if (!along_) along_.emplace(parent_.instance(), part()->lifted_path());
    return along_->empty() ? std::nullopt : std::optional(along_->factor(a, b));
  }

  /// \param reason  the kind of report that the heuristic just received
  void count_refutation(Reason reason) {
    if (!part()->stale()) return;
    if (!std::exchange(stale_, true)) refuted_by_ = reason;
    if (!std::exchange(counted_, true)) ++refuted_;
    if (!renewable()) note_limit();
  }
  /// Notes that h is refuted and S is not solved again.
  void note_limit() {
    if (level_ && !level_->resolves().exhausted) level_->resolves().limit_reached = true;
  }

  void make(const std::string& key) {
    if (spec_.custom()) {
      custom_ = true;
      guide_ = located([&] { return spec_.custom()->make({run_.seed, key, place(), run_.shared}); });
      resolves_left_ = spec_.custom()->description().resolves;
    } else {
      const GuideKind& kind = *find_guide(spec_.name());
      guide_ = kind.make(spec_.options());
      resolves_left_ = kind.resolves(spec_.options());
    }
  }

  /// "script.lua:7: in shrink(0.5) >> rrt, level 1 (problem 'trap', seed 3)".
  [[nodiscard]] std::string place() const {
    const auto at = [&](int i) -> const LevelRecord& { return run_.levels[static_cast<std::size_t>(i)]->record(); };
    const std::string path = level_path(parent_.record(), at);
    const std::string level = spec_.planner() ? fmt::format(", level {}", number_) : "";
    const std::string seed = run_.seeded ? fmt::format(", seed {}", run_.seed) : "";
    return fmt::format("{}in {} >> {}{} (problem '{}'{})", where(spec_.origin()), name_,
                       path.substr(0, path.rfind(',')), level, run_.problem, seed);
  }

  /// Calls `body` and adds the location to its errors.
  template <class Body>
  auto located(const Body& body) const -> decltype(body()) {
    try {
      return body();
    } catch (const PlacedError&) {
      throw;
    } catch (const Error& error) {
      throw PlacedError(fmt::format("{}: {}", place(), error.what()));
    }
  }

  /// Makes h from the solution in S; without a solution if S = {0}.
  void make_heuristic() {
    const Solution* found = level_ ? &level_->solution() : nullptr;
    epoch_ = epoch() + 1;
    const Instance* sub = level_ ? &level_->instance() : nullptr;
    if (part() != nullptr) progress_ += part()->progress();
    made_at_ = parent_.instance().epoch();
    if (level_) guide_->repairs().searched(level_->record().search);
    along_.reset();
    replace(located([&] { return guide_->heuristic(parent_.instance(), sub, found); }));
    // The remaining nodes keep their progress; the rest has to be earned again. Of what was lost, a part may be the
    // progress of nodes that were there before h, which earned nothing.
    const double lost = std::max(0.0, std::exchange(lost_, 0.0) - part()->connected());
    progress_ -= std::clamp(lost, 0.0, std::max(0.0, progress_));
    stale_ = part()->stale();
    if (stale_) refuted_by_ = &Resolves::invalid_path;
  }
  /// Reports to the guide of S the places that S excluded, and configurations presumed valid that are invalid.
  void tell() {
    const Configurations lost = guide_->repairs().take_lost_places();
    for (std::size_t i = 0; i < lost.size(); ++i) level_->heuristic().lost(lost[i]);
    const Configurations invalid = guide_->repairs().take_found_invalid();
    for (std::size_t i = 0; i < invalid.size(); ++i) level_->heuristic().found_invalid(invalid[i]);
  }

  /// Passes the instances to the guide.
  void attach() {
    guide_->attach(level_->instance());
    if (auto* spender = dynamic_cast<SpendsParentsChecks*>(guide_.get()))
      spender->attach_parent(parent_.instance(), guided_below_);
  }

  /// Applies f to the current instance.
  std::unique_ptr<Instance> apply() {
    projected_ = parent_.instance().scene;
    if (!level_) run_.ledger.count_set_up(spec_, *projected_);
    again_ = false;
    if (!known_) return marked(located([&] { return guide_->project(parent_.instance()); }));
    known_->paths.clear();
    known_->refuted = Configurations(parent_.instance().space.dimension());
    // The guidance of C is not complete before all its parts are made.
    if (const SearchedGuidance* all = parent_.heuristic().guide()) {
      all->add_paths(known_->paths);
      if (Configurations refuted = all->refuted_places(); !refuted.empty()) known_->refuted = std::move(refuted);
    }
    auto sub = located([&] { return guide_->project_from(parent_.instance(), *known_); });
    known_->new_from = known_->samples.size();
    return marked(std::move(sub));
  }
  /// Sets whether a guide guides the search of an instance; f may have copied the value of C.
  std::unique_ptr<Instance> marked(std::unique_ptr<Instance> sub) const {
    if (sub != nullptr) sub->guided = guided_below_;
    return sub;
  }
  /// Returns false, without applying f, where the run ends before.
  bool project_again() {
    if (!run_.ledger.count_further_set_up(spec_, *parent_.instance().scene)) return false;
    auto sub = apply();
    if (known_ && sub->space != level_->instance().space) {
      located([&] {
        throw Error(fmt::format("f is applied again, and S is another space than before ({}): a level keeps its space",
                                level_->instance().space.name()));
      });
    }
    level_->replace_instance(std::move(sub));
    attach();
    return true;
  }

  /// Stores the result of a proposal. Motions that the planner tries without one are no samples.
  void remember(const Outcome& outcome, bool mine) {
    const std::size_t proposals = parent_.record().search.fates.size();
    if (std::exchange(proposals_, proposals) == proposals) return;
    const auto copy = [](View q) { return Configuration(q.begin(), q.end()); };
    known_->samples.push_back(
        {copy(outcome.proposal), outcome.fate, copy(outcome.added), copy(outcome.blocked_at), mine});
  }

  /// Checks in C and work of the levels below.
  [[nodiscard]] double work_so_far() const {
    return static_cast<double>(parent_.instance().checks.validity) + level_->work();
  }

  /// Whether h was refuted and S may be solved again.
  [[nodiscard]] bool renewable() const { return part()->stale() && (renewing_ || resolves_left_ > 0); }

  /// Work of the slice that is left.
  [[nodiscard]] double work_left() const { return left_ - (level_->work() - searched_from_); }
  /// Begins a solve of S, or continues one.
  /// \return false where the run ends before
  bool begin_solve() {
    if (part() != nullptr && !renewing_) {
      renewing_ = true;
      renewed_for_ = refuted_by_;
      --resolves_left_;
      guide_->repairs().before_resolve();
      again_ = known_.has_value();
    }
    if (!std::exchange(searched_, true)) again_ = known_ && known_->has_new();
    if ((again_ || parent_.instance().scene != projected_) && !project_again()) return false;
    tell();
    return true;
  }
  /// Makes h of the paths that were found. A path with points that are invalid in C is refuted before any proposal:
  /// then S is solved again, where it may.
  void end_solve() {
    const bool again = std::exchange(renewing_, false);
    found_ = first_ == Advance::found;
    // Without another path, further solves are useless, except with new samples; the earlier path may still guide.
    if (again && !found_ && renewed_for_ != &Resolves::new_turn) {
      resolves_left_ = 0;
      guide_->repairs().no_other_path();
      level_->resolves().exhausted = true;
    }
    make_heuristic();
    counted_ = part()->stale();
    if (counted_) {
      ++refuted_;
      begins_solve_ = renewable();
      if (begins_solve_) return;
      note_limit();
    }
    ready_ = first_;
  }

  Run& run_;
  Level& parent_;
  GuideSpec spec_;
  std::size_t number_;  ///< of the level below, if there is one
  std::string name_;
  bool guided_below_;    ///< a guide guides the search of S
  bool custom_ = false;  ///< not in the registry
  std::shared_ptr<Guide> guide_;
  std::unique_ptr<Level> level_;
  mutable std::optional<AlongPath> along_;  ///< h's path, if it weighs a graph
  std::optional<Known> known_;              ///< if f depends on it
  std::size_t proposals_ = 0;               ///< of C, when the last outcome was received
  bool again_ = false;                      ///< f is applied again before the next search
  bool searched_ = false;                   ///< the first search has begun
  Slice slice_;                             ///< for this proposal
  double begun_ = 0.0;                      ///< work_so_far() when it began
  double left_ = 0.0;                       ///< work of the slice when the solve began or continued
  double searched_from_ = 0.0;              ///< work of the levels below then
  bool begins_solve_ = false;               ///< the next search begins a solve, or continues one for another proposal
  std::optional<Advance> ready_;            ///< what h answers for this proposal; none: S is to be searched
  std::uint64_t epoch_ = 0;                 ///< without that of the heuristic
  std::shared_ptr<const Scene> projected_ = parent_.instance().scene;  ///< the scene that f was applied to
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t made_at_ = never;     ///< epoch of the parent's instance when h was made
  double lost_ = 0.0;                 ///< length connected along h before nodes were removed
  double progress_ = 0.0;             ///< along earlier heuristics
  Advance first_ = Advance::nothing;  ///< result of the search for the first path
  std::int64_t more_ = 0;             ///< limit of proposals of the active search for another path; 0: none
  std::int64_t resolves_left_ = 0;
  std::uint64_t refuted_ = 0;
  bool counted_ = false;   ///< `refuted_` includes the current h
  bool stale_ = false;     ///< the current h is refuted; `refuted_by_` is the reason
  bool renewing_ = false;  ///< a further solve has begun
  Reason refuted_by_ = &Resolves::rejections;
  Reason renewed_for_ = &Resolves::rejections;  ///< reason of the further solve that has begun
  bool found_ = false;                          ///< the last search found a path, or S = {0}
};

}  // namespace

std::unique_ptr<SearchedGuidance> make_component(Run& run, Level& level, const GuideSpec& spec,
                                                 const std::string& key) {
  return std::make_unique<ComponentGuidance>(run, level, spec, key);
}

}  // namespace trellis
