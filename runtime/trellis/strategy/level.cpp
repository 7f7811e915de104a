// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/level.hpp>

#include <algorithm>
#include <memory>
#include <utility>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/split_search.hpp>
#include <trellis/strategy/team_search.hpp>

namespace trellis {

Level::Level(Run& run, Level* parent, std::string key, std::string name, std::unique_ptr<Instance> instance,
             const PlannerSpec& planner, std::shared_ptr<Guide> lift)
    : run_(run),
      parent_(parent),
      lift_(std::move(lift)),
      instance_(std::move(instance)),
      kind_(*find_planner(planner.name())),
      planner_spec_(planner),
      common_(kind_.common(planner.options())),
      ledger_(run, *instance_, record_.search, common_, h_,
              kind_.graph && parent != nullptr && parent->parent_ != nullptr),
      h_(*instance_, common_, ledger_, parent != nullptr),
      lookahead_(*instance_, h_, run.helpers),
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
  run.levels.push_back(this);
}

void Level::replace_instance(std::unique_ptr<Instance> instance) {
  ledger_.replace_instance();
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

std::unique_ptr<Planner> Level::make_planner() {
  record_.search.sources = h_.sources();
  PlannerContext context{*instance_,           h_,          Stream(run_.seed, record_.key, stream_),
                         record_.search,       h_.guided(), &lookahead_,
                         kind_.component->name};
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

class Level::Active {
 public:
  Active(Level& level, const Slice& slice)
      : level_(level),
        charged_(level.run_.clock.switch_to(&level.record_.search.seconds)),
        asking_(std::exchange(level.run_.active_level, &level)) {
    level.run_.ledger.begin_search();
    if (asking_ != nullptr) asking_->pause();
    const bool limited = slice.work < Budget::unlimited;
    limit_ = level.ledger_.limit_work(limited ? level.work() + slice.work : Budget::unlimited);
  }
  ~Active() {
    level_.ledger_.limit_work(limit_);
    level_.run_.active_level = asking_;
    level_.run_.clock.switch_to(charged_);
  }
  Active(const Active&) = delete;
  Active& operator=(const Active&) = delete;

 private:
  Level& level_;
  double* charged_;
  Level* asking_;
  double limit_ = Budget::unlimited;
};

Advance Level::advance(const Grant& grant) {
  const Active active(*this, grant.slice);
  begin(grant);
  while (!ended_) take_step();
  return end();
}

void Level::take_step() {
  ended_ = step();
  for (auto next = part(); next.level != nullptr; next = part())
    ended_ = divides_->take(next.level->advance(next.grant));
}

std::optional<Status> Level::step() {
  if (const auto stop = ledger_.stop(planner_->draws())) return planner_->stopped(*stop);
  if (const auto stop = search_below()) return planner_->stopped(*stop);
  const Plan plan = planner_->plan();
  if (!plan.proposal) return planner_->work();
  const Lookahead::Timed timed = lookahead_.begin_step(*planner_);
  record_outcome(h_, planner_->extend(draw(plan)), record_.search);
  return planner_->follow();
}

std::optional<Status> Level::search_below() {
  if (ledger_.asks_guide()) {
    SearchedGuidance& guide = *h_.guide();
    const Ledger::Asking asking(ledger_);
    do {
      guide.begin(ledger_.slice());
      while (GuideSearch* search = guide.needs_search()) {
        if (search->project()) search->learn(search->level().advance(search->grant()));  // f, the recursion, h
      }
    } while (ledger_.goes_on(guide.ready()));
    ledger_.close(guide.ready());
  }
  return ledger_.stop_after_search();
}

View Level::draw(const Plan& plan) {
  draw_proposal(h_, plan, planner_->stream(), record_.search, proposal_);
  if (run_.watch != nullptr) (*run_.watch)(record_, h_);
  lookahead_.drawn(proposal_);
  return proposal_;
}

void Level::begin_root() {
  run_.clock.switch_to(&record_.search.seconds);
  run_.active_level = this;
  begin({});
}

void Level::begin(const Grant& grant) {
  if (!planner_) {
    planner_ = make_planner();
    divides_ = dynamic_cast<DividingPlanner*>(planner_.get());
  }
  lookahead_.clear();
  ended_ = planner_->begin(ledger_.begin(grant));
  solving_ = true;
}

Advance Level::end() { return end(solution_found()); }

Solution Level::solution_found() {
  if (keeps_path() && *ended_ == Status::interrupted) {
    Solution best = planner_->solution(Status::budget_spent);
    if (!best.solved()) best.status = Status::interrupted;
    return best;
  }
  return solution_of(*planner_, *instance_, *ended_);
}

Advance Level::end(Solution found) {
  solving_ = false;
  const bool paused = found.status == Status::paused;
  if (paused) found.status = Status::budget_spent;
  found_ = found.solved();
  if (found_) h_.found([&] { return path_length(instance_->space, found.path); });
  const bool sliced = ledger_.sliced(paused);
  const Advance advance = found_                                           ? Advance::found
                          : sliced && found.status == Status::budget_spent ? Advance::unfinished
                                                                           : Advance::nothing;
  if (advance == Advance::unfinished) {
    pause();
  } else {
    ledger_.end_solve();
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

void Level::leave() {
  if (divides_ != nullptr) divides_->leave();
  complete_proposals(record_.search, instance_->motion_model != nullptr);
  const auto solves = record_.solves;
  if (solving_) {
    // The planner's own solution needs a step that has ended, but for the path that an anytime planner has stored.
    Solution found{Status::interrupted, path_of_start(*instance_)};
    if (keeps_path() && !run_.improvements.empty()) {
      Solution best = planner_->solution(Status::budget_spent);
      if (best.solved()) found = std::move(best);
    }
    static_cast<void>(end(std::move(found)));
  }
  // The root counts the reason of a further solve before it begins, a level above when it has returned.
  if (solves > 0) record_.solves = parent_ == nullptr ? 1 + record_.resolves.refuted_path : solves;
}

void Level::refute() {
  ++record_.resolves.refuted_path;
  found_ = false;
  record_.solution = {};
  ledger_.found(false);
  // The points of the cost curve before the refuted path remain.
  if (!run_.improvements.empty()) run_.improvements.pop_back();
  run_.refuted = true;
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

}  // namespace trellis
