// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/ledger.hpp>

#include <algorithm>
#include <cmath>

#include <trellis/instance/search_cost.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

namespace {

/// Of the guided share: with a bound of 2 the guided work is 0.8 of the unguided.
constexpr double guided_rate = 0.8;
/// Initial grant of the guide, as a multiple of the checks of a straight motion from start to goal at the resolution:
/// the minimum of any planner.
constexpr double grant_rate = 1.5;
/// Earned by a metre of progress, as a multiple of the checks per metre. Leads of a decomposition need most: 4 to 6.
constexpr double progress_rate = 5.0;
/// The same beside a companion, where it limits how long a tree stays at a place where its guide is stuck.
constexpr double companion_progress_rate = 3.0;
/// Deducted for a metre of progress from the work that the level above counts, as a multiple of the checks per metre.
/// Measured: above 0.5, nested searches cost more where the planner alone needs few checks; below, they cost more at
/// narrow passages, where they save most.
constexpr double deduction_rate = 0.5;
/// Minimum work of a level below before it pauses.
constexpr double least_slice = 32.0;

}  // namespace

Ledger::Ledger(Run& run, const Instance& instance, const Search& search, const PlannerCommon& common,
               const LevelHeuristic& h, bool graph)
    : run_(run),
      instance_(instance),
      search_(search),
      common_(common),
      h_(h),
      graph_(graph),
      direct_(instance.to_goal(instance.start)) {}

Budget Ledger::begin(const Grant& grant) {
  const auto drawn = static_cast<double>(search_.proposals.size());
  if (!solve_begun_) solve_begun_ = drawn;
  Budget budget = common_.budget;
  whole_ = std::min(budget.proposals, *solve_begun_ + grant.solve);
  budget.proposals = sliced_ = std::min(whole_, drawn + grant.slice.proposals);
  budget_.emplace(instance_, search_, budget, &run_.ledger.waited());
  return budget;
}

bool Ledger::sliced(bool paused) const {
  const auto drawn = static_cast<double>(search_.proposals.size());
  return paused || (drawn >= sliced_ && drawn < whole_);
}

void Ledger::end_solve() {
  solve_begun_.reset();
  if (!searched_) first_searches_ += own_work() - first_begun_;
  searched_ = true;
}

void Ledger::replace_instance() {
  first_searches_ = first_searches();
  searched_ = false;
  first_begun_ = own_work();
}

double Ledger::limit_work(double limit) { return std::exchange(work_limit_, limit); }

std::optional<Status> Ledger::stop(bool draws) {
  if (budget_->reached(draws)) return Status::budget_spent;
  RunLedger& run = run_.ledger;
  if (run.interrupted() || run.companion_ends_run()) return Status::interrupted;
  if (run.out_of_time()) return Status::budget_spent;
  searches_ = run.searches();
  worked_ = own_work();
  return std::nullopt;
}

std::optional<Status> Ledger::stop_after_search() {
  RunLedger& run = run_.ledger;
  const bool searched = run.searches() != searches_ || own_work() != worked_;
  if (searched && run.companion_ends_run()) return Status::interrupted;
  if (run.interrupted()) return Status::interrupted;
  if (searched && run.out_of_time()) return Status::budget_spent;
  const bool pauses = work_limit_ < Budget::unlimited && work() >= work_limit_;
  return pauses ? std::optional(Status::paused) : std::nullopt;
}

bool Ledger::asks_guide() {
  if (!h_.guided() || asked_) return false;
  asked_ = true;
  charge(spent_);
  counted_ = own();
  was_open_ = open_;
  open_ = true;
  if (divides() || leaves_stuck_guide()) {
    double guided = spent_.guided.work();
    if (divides()) {
      guided += below();
    } else {
      guided -= validation_;
    }
    left_ = grant() + earned() + guided_share() * spent_.unguided.work() - guided;
    open_ = left_ > 0.0;
  }
  if (open_ && h_.guide() != nullptr) return true;
  set_open(open_);
  return false;
}

Slice Ledger::slice() const {
  Slice slice;
  if (divides()) slice.work = std::max(left_, least_slice);
  slice.work = std::min(slice.work, work_limit_ - work());
  if (has_companion_ && h_.guide()->draws_while_searching()) slice.work = std::min(slice.work, least_slice);
  return slice;
}

bool Ledger::goes_on(Advance ready) const { return has_companion_ && ready == Advance::unfinished; }

void Ledger::close(Advance ready) {
  // A permanently refuted guide draws no more proposals.
  set_open(ready != Advance::unfinished && !(common_.bound > 0.0 && h_.guide()->spent()));
}

void Ledger::set_open(bool open) {
  open_ = open;
  if (open_ != was_open_) ++changes_;
}

void Ledger::count_validation(double checks) {
  spent_.guided.checks += checks;
  validation_ += checks;
  counted_.checks += checks;
}

void Ledger::count_asking() {
  count_validation(own().checks - counted_.checks);
  counted_ = own();
}

Ledger::Spent Ledger::own() const {
  return {static_cast<double>(instance_.checks.validity), static_cast<double>(search_.proposals.size()),
          instance_.other_in_checks()};
}

void Ledger::charge(BothSpent& both) const {
  const Spent now = own();
  Spent& side = guided_ ? both.guided : both.unguided;
  side.checks += now.checks - counted_.checks;
  side.proposals += now.proposals - counted_.proposals;
  side.other += now.other - counted_.other;
}

Ledger::BothSpent Ledger::spent() const {
  BothSpent both = spent_;
  charge(both);
  return both;
}

bool Ledger::leaves_stuck_guide() const {
  const bool tree = !search_.parents.empty() && search_.parents.front() != no_node;
  return common_.bound > 0.0 && has_companion_ && tree && !has_path_;
}

double Ledger::guided_share() const { return guided_rate * (common_.bound - 1.0); }

double Ledger::grant() const { return grant_rate * direct_ * instance_.checks_per_metre(); }

double Ledger::progress_checks() const { return instance_.checks_per_metre() * h_.progress(); }

double Ledger::earned() const { return (has_companion_ ? companion_progress_rate : progress_rate) * progress_checks(); }

double Ledger::deducted() const {
  const double half = deduction_rate * progress_checks();
  return h_.guide() == nullptr ? half : std::max(half, std::min(earned(), spent().guided.work() + below()));
}

double Ledger::below() const { return h_.guide() != nullptr ? h_.guide()->work() : 0.0; }

double Ledger::first_searches() const {
  if (!graph_) return 0.0;
  return first_searches_ + (searched_ ? 0.0 : own_work() - first_begun_);
}

double Ledger::own_work() const {
  return static_cast<double>(instance_.checks.validity) + static_cast<double>(search_.proposals.size()) +
         instance_.other_in_checks();
}

double Ledger::work() const { return own_work() + below() + parts_ - deducted() - first_searches(); }

RunCost Ledger::cost() const {
  const Checks& checks = instance_.checks;
  const double proposals = static_cast<double>(search_.proposals.size()) - absorbed_;
  const bool guided = h_.below_root() || h_.guide() != nullptr;
  const double proposal = search_cost::proposal + (guided ? search_cost::guided_proposal : 0.0);
  return {static_cast<double>(checks.validity),
          checks.work + checks.other + instance_.lift_work.total() + proposal * proposals};
}

}  // namespace trellis
