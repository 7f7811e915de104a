// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/level.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <utility>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/lifted.hpp>
#include <trellis/guide/set_up.hpp>
#include <trellis/instance/search_cost.hpp>
#include <trellis/strategy/absorb.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/split_search.hpp>
#include <trellis/strategy/team_search.hpp>

namespace trellis {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  constexpr double nanosecond = 1e-9;
  return static_cast<double>(now.tv_sec) + nanosecond * static_cast<double>(now.tv_nsec);
}

RunCost Run::cost() const {
  RunCost sum{0.0, set_up};
  for (const Level* level : levels) sum = sum + level->cost();
  return sum;
}

namespace {

SetUp set_up_of(const GuideSpec& guide, const Scene& scene) {
  return guide.custom() ? set_up_of_custom() : set_up_of(guide.name(), guide.options(), scene);
}

}  // namespace

void Run::count_set_up(const GuideSpec& guide, const Scene& scene) {
  const SetUp work = set_up_of(guide, scene);
  const bool first = work.world > 0.0 && prepared_.emplace(guide.name(), scene.world_identity()).second;
  const double of_world = first ? work.world / queries : 0.0;
  count_set_up(work.run + of_world);
}

void Run::count_set_up(double work) {
  // A guide that is set up in the world of another one, with other obstacles, may cost more than was estimated.
  const double more = std::max(0.0, set_up + work - std::max(set_up, estimated_set_up));
  announce_work(more);
  unannounced_set_up += work - more;
  set_up += work;
}

void Run::end_searches() {
  abandons_levels = false;
  const MonitorScope unmonitored(nullptr);
  // A level waits for those with higher numbers.
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) (*level)->end_search();
}

void Run::abandon(Level& level) {
  std::erase(levels, &level);
  if (levels.empty()) return;
  Checks& root = levels.front()->instance().checks;
  root += level.instance().checks;
  root.other += level.cost().work - level.instance().checks.work - level.instance().checks.other;
}

bool Run::count_further_set_up(const GuideSpec& guide, const Scene& scene) {
  const SetUp work = set_up_of(guide, scene);
  const auto world = std::pair(guide.name(), scene.world_identity());
  if (work.world > 0.0 && !prepared_.contains(world)) {
    if (before_set_up && before_set_up(work.run + work.world)) return false;
    prepared_.insert(world);
    set_up += work.run + work.world;
    unannounced_set_up += work.run + work.world;
  } else {
    count_set_up(work.run);
  }
  return true;
}

Level::Level(Run& run, Level* parent, std::string key, std::string name, std::unique_ptr<Instance> instance,
             const PlannerSpec& planner, std::shared_ptr<Guide> lift)
    : run_(run),
      parent_(parent),
      lift_(std::move(lift)),
      instance_(std::move(instance)),
      kind_(*find_planner(planner.name())),
      planner_spec_(planner),
      common_(kind_.common(planner.options())),
      guidance_(*instance_, common_, record_.search),
      lookahead_(*instance_, guidance_, run.helpers),
      proposal_(instance_->space.dimension()) {
  if (!kind_.graph) instance_->graph = nullptr;
  instance_->step = common_.step;
  check_planner(kind_, *instance_);
  record_.level = run.companion ? -1 : static_cast<int>(run.levels.size());
  record_.parent = parent != nullptr ? parent->record_.level : -1;
  record_.depth = parent != nullptr ? parent->record_.depth + 1 : 0;
  record_.key = std::move(key);
  record_.name = std::move(name);
  record_.space = instance_->space;
  record_.start = instance_->start;
  record_.goal = instance_->goal();
  record_.position_axes = instance_->position_axes;
  record_.scene = instance_->scene;
  record_.places_robot = !instance_->validity_of;
  record_.presumed = !instance_->validity->spends_checks();
  record_.planner = planner.name();
  record_.search = Search(instance_->space.dimension());
  if (!run_.densities) record_.search.density.disable();
  guidance_.limit_slice([this] { return work_limit_ - work(); });
  if (parent != nullptr) guidance_.expect_relaxed();
  run.levels.push_back(this);
}

double Level::own_work() const {
  return static_cast<double>(instance_->checks.validity) + static_cast<double>(record_.search.proposals.size()) +
         instance_->other_in_checks();
}

RunCost Level::cost() const {
  const Checks& checks = instance_->checks;
  const double proposals = static_cast<double>(record_.search.proposals.size()) - absorbed_;
  const bool guided = parent_ != nullptr || guidance_.guide() != nullptr;
  const double proposal = search_cost::proposal + (guided ? search_cost::guided_proposal : 0.0);
  return {static_cast<double>(checks.validity),
          checks.work + checks.other + instance_->lift_work.total() + proposal * proposals};
}

double Level::work() const {
  const double below = guidance_.guide() != nullptr ? guidance_.guide()->work() : 0.0;
  return own_work() + below + parts_work_ - guidance_.deducted() - first_searches();
}

void Level::replace_instance(std::unique_ptr<Instance> instance) {
  first_searches_ = first_searches();
  searched_ = false;
  first_search_begun_ = own_work();
  instance->checks += instance_->checks;
  instance->checks.other += instance->lift_work.total();
  // Guides that were projected from the instance before count there.
  instance->lift_work = std::move(instance_->lift_work);
  instance->revision = instance_->epoch() + 1;
  instance->step = instance_->step;
  if (!kind_.graph) instance->graph = nullptr;
  *instance_ = std::move(*instance);
  record_.scene = instance_->scene;
  record_.solution = {};
  found_ = false;
}

Advance Level::advance(double proposals, const Slice& slice) {
  ++run_.searches;
  double* above = run_.clock.switch_to(&record_.search.seconds);
  if (run_.active_level != nullptr) run_.active_level->pause();
  Level* asking = std::exchange(run_.active_level, this);
  const double limit =
      std::exchange(work_limit_, slice.work < Budget::unlimited ? work() + slice.work : Budget::unlimited);
  const Advance advance = solve_own(proposals, slice);
  work_limit_ = limit;
  run_.active_level = asking;
  run_.clock.switch_to(above);
  return advance;
}

std::unique_ptr<Planner> Level::make_planner() {
  record_.search.sources = guidance_.sources();
  PlannerContext context{*instance_,     guidance_,          Stream(run_.seed, record_.key, stream_),
                         record_.search, guidance_.guided(), &lookahead_};
  if (division_) {
    TeamSearchContext of{
        run_, *this, planner_spec_, guide_spec_ ? &*guide_spec_ : nullptr, *division_, std::move(context)};
    if (instance_->motion_model) return make_driven_team_search(std::move(of));
    return division_->how == Coordination::windows ? make_conflict_search(std::move(of))
                                                   : make_team_search(std::move(of));
  }
  if (planner_spec_.dividing() == nullptr) return kind_.make(planner_spec_.options(), std::move(context));
  return make_split_search(run_, *this, planner_spec_, guide_spec_ ? &*guide_spec_ : nullptr, std::move(context));
}

Advance Level::solve_own(double proposals, const Slice& slice) {
  begin_solve(proposals, slice);
  while (!ended_) ended_ = step();
  return end_solve(solution_found());
}

void Level::begin_root_solve() {
  run_.clock.switch_to(&record_.search.seconds);
  run_.active_level = this;
  begin_solve(Budget::unlimited, {});
}

bool Level::step_root_solve() {
  if (!ended_) ended_ = step();
  if (!ended_) return false;
  static_cast<void>(end_solve(solution_found()));
  return true;
}

namespace {

/// Completes the record of a proposal whose result is not known.
void complete_proposals(Search& search, bool driven) {
  while (search.fates.size() < search.proposals.size()) {
    search.fates.push_back(Fate::rejected);
    search.near.push_back(no_node);
    search.added.push_back(no_node);
    if (driven) search.controls.ends.push_back(static_cast<std::uint32_t>(search.controls.steps.size()));
  }
}

}  // namespace

void Level::complete_proposals() { trellis::complete_proposals(record_.search, instance_->motion_model != nullptr); }

void Level::end_search() {
  complete_proposals();
  const auto solves = record_.solves;
  if (solving_) {
    // The planner's own solution needs a step that has ended, but for the path that an anytime planner has stored.
    Solution found{Status::interrupted, path_of_start(*instance_)};
    if (keeps_path() && !run_.improvements.empty()) {
      Solution best = planner_->solution(Status::budget_spent);
      if (best.solved()) found = std::move(best);
    }
    static_cast<void>(end_solve(std::move(found)));
  }
  // The root counts the reason of a further solve before it begins, a level above when it has returned.
  if (solves > 0) record_.solves = parent_ == nullptr ? 1 + record_.resolves.refuted_path : solves;
}

void Level::begin_solve(double proposals, const Slice& slice) {
  if (!planner_) planner_ = make_planner();
  const auto drawn = static_cast<double>(record_.search.proposals.size());
  // `proposals` limits all slices of a solve together.
  if (!solve_begun_) solve_begun_ = drawn;
  Budget budget = common_.budget;
  whole_ = std::min(budget.proposals, *solve_begun_ + proposals);
  budget.proposals = sliced_ = std::min(whole_, drawn + slice.proposals);
  budget_.emplace(*instance_, record_.search, budget, &run_.stopped);
  lookahead_.clear();
  ended_ = planner_->begin(budget);
  solving_ = true;
}

std::optional<Status> Level::step() {
  if (const auto limit = stop()) return planner_->stopped(*limit);
  if (const auto limit = search_below()) return planner_->stopped(*limit);
  const Plan plan = planner_->plan();
  if (!plan.proposal) return planner_->work();
  const Lookahead::Timed timed = lookahead_.begin_step(*planner_);
  record_outcome(guidance_, planner_->extend(draw(plan)), record_.search);
  return planner_->follow();
}

std::optional<Status> Level::stop() {
  if (budget_->reached(planner_->draws())) return Status::budget_spent;
  if (run_.interrupted && run_.interrupted()) return Status::interrupted;
  if (run_.before_step && run_.before_step()) return Status::interrupted;
  if (run_.out_of_time && run_.out_of_time()) return Status::budget_spent;
  return std::nullopt;
}

std::optional<Status> Level::search_below() {
  const std::uint64_t searches = run_.searches;
  const double worked = own_work();
  guidance_.prepare();
  // The run may have ended while the levels below were searched.
  const bool searched = run_.searches != searches || own_work() != worked;
  if (searched && run_.before_step && run_.before_step()) return Status::interrupted;
  if (run_.interrupted && run_.interrupted()) return Status::interrupted;
  if (searched && run_.out_of_time && run_.out_of_time()) return Status::budget_spent;
  const bool pauses = work_limit_ < Budget::unlimited && work() >= work_limit_;
  return pauses ? std::optional(Status::paused) : std::nullopt;
}

View Level::draw(const Plan& plan) {
  draw_proposal(guidance_, plan, planner_->stream(), record_.search, proposal_);
  if (run_.watch) run_.watch(record_, guidance_);
  lookahead_.drawn(proposal_);
  return proposal_;
}

Solution Level::solution_found() {
  if (keeps_path() && *ended_ == Status::interrupted) {
    Solution best = planner_->solution(Status::budget_spent);
    if (!best.solved()) best.status = Status::interrupted;
    return best;
  }
  return solution_of(*planner_, *instance_, *ended_);
}

Advance Level::end_solve(Solution found) {
  solving_ = false;
  const bool paused = found.status == Status::paused;
  if (paused) found.status = Status::budget_spent;
  found_ = found.solved();
  if (found_) guidance_.found([&] { return path_length(instance_->space, found.path); });
  const auto drawn = static_cast<double>(record_.search.proposals.size());
  const bool sliced = paused || (drawn >= sliced_ && drawn < whole_);
  const Advance advance = found_                                           ? Advance::found
                          : sliced && found.status == Status::budget_spent ? Advance::unfinished
                                                                           : Advance::nothing;
  if (advance == Advance::unfinished) {
    pause();
  } else {
    solve_begun_.reset();
    if (!searched_) first_searches_ += own_work() - first_search_begun_;
    searched_ = true;
    ++record_.solves;
    if (record_.solved_as < 0) record_.solved_as = run_.first_solves++;
    end_turn(found.solved() ? found.path : Configurations(), true);
  }
  // A later solve without a path keeps the earlier solution: its path may still guide.
  if (found.solved() && instance_->goals.size() > 1) {
    const View reached = instance_->goals[instance_->nearest_goal(found.path.back()).goal];
    record_.goal.assign(reached.begin(), reached.end());
  }
  if (found.solved() || !record_.solution.solved()) record_.solution = std::move(found);
  return advance;
}

void Level::refute() {
  ++record_.resolves.refuted_path;
  found_ = false;
  record_.solution = {};
  guidance_.refuted();
  // The points of the cost curve before the refuted path remain.
  if (!run_.improvements.empty()) run_.improvements.pop_back();
  run_.refuted = true;
}

namespace {

/// Copies a small container into memory of its own size. What it grew in is then free for the next run, which finds it
/// in the caches: each 4 KiB of new memory costs a page fault. A large one stays: the copy would double the memory of
/// the run, and the system gives no memory for what was reserved and not written.
template <class T>
void fit(T& rows) {
  constexpr std::size_t small = 1 << 16;  // rows
  if (rows.size() <= small) rows = T(std::as_const(rows));
}

void fit(Search& search) {
  fit(search.nodes);
  fit(search.parents);
  fit(search.proposals);
  fit(search.fates);
  fit(search.near);
  fit(search.added);
  fit(search.proposal_sources);
  fit(search.controls.controls);
  fit(search.controls.steps);
  fit(search.controls.driven);
  fit(search.controls.ends);
  fit(search.validated);
  fit(search.edges);
}

}  // namespace

void Level::complete(LevelRecord& record, bool lift, const Level* companion) const {
  record.scene = instance_->scene;
  record.search.checks = instance_->checks;
  if (companion != nullptr) {
    const bool expands = record.search.expands;
    absorb(companion->record_.search, record.search);
    record.search.expands = expands;
    record.search.checks += companion->instance_->checks;
    record.search.seconds += companion->record_.search.seconds;
  }
  const LevelGuidance::BothSpent spent = guidance_.spent();
  record.guided = guidance_.guided();
  record.guided_checks = record.guided ? static_cast<std::uint64_t>(spent.guided.checks) : 0;
  record.unguided_checks =
      record.search.checks.validity - std::min(record.guided_checks, record.search.checks.validity);
  const auto& sources = record.search.proposal_sources;
  record.guided_proposals = static_cast<std::uint64_t>(
      std::count_if(sources.begin(), sources.end(), [](auto source) { return LevelGuidance::is_guided(source); }));
  record.search.sources = guidance_.sources();
  if (parent_ != nullptr && lift) {
    record.lifted_nodes = lifted(record.search.nodes, "lift nodes");
    record.lifted_proposals = lifted(record.search.proposals, "lift proposals");
  }
  record.valid = [validity = instance_->validity](View q) { return validity->state(q); };
  record.valid_motion = [validity = instance_->validity](View a, View b) { return validity->motion(a, b).valid; };
  record.search.density.compact();
  if (record.search.density.exact()) {
    const auto density = std::make_shared<const DensityRecord>(record.search.density);
    record.proposal_density = [density](View q) { return density->at(q); };
    if (closed_fibres()) record.root_proposal_density = lifted(record.proposal_density);
    record.proposal_atoms = density->atoms();
  }
}

LevelRecord Level::take_record(bool lift, const Level* companion) {
  complete(record_, lift, companion);
  fit(record_.search);
  std::string key = record_.key;
  LevelRecord taken = std::move(record_);
  // The keys of the random streams for lifts from the levels below contain it.
  record_.key = std::move(key);
  return taken;
}

LevelRecord Level::record_so_far(bool lift, const Level* companion) {
  LevelRecord record = record_;
  trellis::complete_proposals(record.search, instance_->motion_model != nullptr);
  if (solving_) {
    ++record.solves;
    if (!record.solution.solved()) record.solution = planner_->solution(Status::paused);
    if (!record.solution.solved()) record.solution.status = Status::interrupted;
  }
  complete(record, lift, companion);
  return record;
}

void Level::pause() {
  const Search& search = record_.search;
  if (search.proposals.size() + search.nodes.size() > noted_) end_turn({}, false);
}

Turn Level::turn(Configurations path, bool solve_ended) const {
  const Search& search = record_.search;
  const auto length = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
  return {record_.level, length(search.proposals.size()), length(search.nodes.size()), solve_ended, std::move(path)};
}

void Level::end_turn(Configurations path, bool solve_ended) {
  noted_ = record_.search.proposals.size() + record_.search.nodes.size();
  run_.turns.push_back(turn(std::move(path), solve_ended));
}

void Level::add_open_turn(std::vector<Turn>& turns) const {
  const Search& search = record_.search;
  if (search.proposals.size() + search.nodes.size() > noted_) turns.push_back(turn({}, false));
}

Configurations Level::lifted(const Configurations& rows, const std::string& purpose) const {
  Configurations current = rows;
  for (const Level* at = this; at->parent_ != nullptr; at = at->parent_) {
    Stream stream(run_.seed, record_.key, purpose + " from " + at->record_.key);
    const std::size_t dimension = at->parent_->instance_->space.dimension();
    Configurations next(dimension);
    next.reserve(current.size());
    Configuration q(dimension);
    for (std::size_t i = 0; i < current.size(); ++i) {
      at->lift_->lift(std::as_const(current)[i], stream, q);
      next.push(q);
    }
    current = std::move(next);
  }
  return current;
}

bool Level::closed_fibres() const {
  for (const Level* at = this; at->parent_ != nullptr; at = at->parent_) {
    if (!at->lift_->closed_fibre()) return false;
  }
  return true;
}

std::function<double(View)> Level::lifted(std::function<double(View)> density) const {
  const auto through = [&](auto f, std::size_t dimension) {
    return [density = std::move(density), f = std::move(f), s = Configuration(dimension)](View q) mutable {
      f->project(q, s);
      const double p = density(s);
      return p > 0.0 ? p * std::exp(f->log_fibre_density(q)) : p;
    };
  };
  for (const Level* at = this; at->parent_ != nullptr; at = at->parent_) {
    const std::size_t dimension = at->instance_->space.dimension();
    if (auto f = at->lift_->shared_projection()) {
      density = through(std::move(f), dimension);
    } else {
      density = through(at->lift_, dimension);
    }
  }
  return density;
}

}  // namespace trellis
