// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/run_ledger.hpp>

#include <fmt/format.h>

#include <cmath>
#include <ctime>

#include <trellis/base/error.hpp>
#include <trellis/base/lua_time.hpp>
#include <trellis/guide/set_up.hpp>
#include <trellis/instance/search_cost.hpp>
#include <trellis/strategy/companion.hpp>

namespace trellis {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  constexpr double nanosecond = 1e-9;
  return static_cast<double>(now.tv_sec) + nanosecond * static_cast<double>(now.tv_nsec);
}

void Run::leave_searches() {
  abandons_levels = false;
  const MonitorScope unmonitored(nullptr);
  // A level waits for those with higher numbers.
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) (*level)->leave();
}

void Run::abandon(Level& level) {
  std::erase(levels, &level);
  if (levels.empty()) return;
  Checks& root = levels.front()->instance().checks;
  root += level.instance().checks;
  root.other += level.ledger().cost().work - level.instance().checks.work - level.instance().checks.other;
}

namespace {

SetUp set_up_of(const GuideSpec& guide, const Scene& scene) {
  return guide.custom() ? set_up_of_custom() : set_up_of(guide.name(), guide.options(), scene);
}

/// Checks that the cost of a search is finite and has not decreased: otherwise bounded loss would hold by accident.
/// \param step  difference to its cost before
void check_growth(const RunCost& step, const RunCost& cost) {
  // Sums of work are rounded.
  constexpr double rounding = 1e-9;
  const auto grows = [](double difference, double sum) {
    return std::isfinite(sum) && difference >= -rounding * std::abs(sum);
  };
  if (grows(step.checks, cost.checks) && grows(step.work, cost.work)) return;
  throw Fault(
      fmt::format("a step of the guided search has cost {} checks and {} units of work", step.checks, step.work));
}

}  // namespace

void RunLedger::begin(const ExecuteOptions& options) {
  options_ = &options;
  begin_ = std::chrono::steady_clock::now();
}

void RunLedger::begin_beside(RunLedger& guided) {
  guided_ = &guided;
  deadline_ = guided.deadline_;
}

void RunLedger::rely_on(Companion& companion, double bound, double set_up) {
  companion_ = &companion;
  bound_ = bound;
  estimated_ = set_up;
  const CheckCost& check = run_.levels.front()->instance().validity->cost();
  monitor_.emplace(SliceMonitor::CheckRates{check.on_motion, check.alone},
                   search_cost::proposal + search_cost::guided_proposal,
                   [this](const Spending& next) { return ask(next); });
}

bool RunLedger::limits_reached() const {
  if (options_ == nullptr) return false;
  if (options_->interrupted && options_->interrupted()) return true;
  if (options_->work_limit <= 0.0 && options_->check_limit == 0) return false;
  const RunCost cost = total();
  return (options_->work_limit > 0.0 && cost.work >= options_->work_limit) ||
         (options_->check_limit > 0 && cost.checks >= static_cast<double>(options_->check_limit));
}

bool RunLedger::out_of_time() {
  return deadline_ && deadline_->passed([this] { return guided_ != nullptr ? guided_->elapsed() : elapsed(); });
}

double RunLedger::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() - waited_;
}

void RunLedger::count_set_up(const GuideSpec& guide, const Scene& scene) {
  const SetUp work = set_up_of(guide, scene);
  const bool first = work.world > 0.0 && prepared_.emplace(guide.name(), scene.world_identity()).second;
  const double of_world = first ? work.world / queries_ : 0.0;
  count_set_up(work.run + of_world);
}

void RunLedger::count_set_up(double work) {
  // A guide that is set up in the world of another one, with other obstacles, may cost more than was estimated.
  const double more = std::max(0.0, set_up_ + work - std::max(set_up_, announced_));
  announce_work(more);
  unannounced_ += work - more;
  set_up_ += work;
}

bool RunLedger::count_further_set_up(const GuideSpec& guide, const Scene& scene) {
  const SetUp work = set_up_of(guide, scene);
  const auto world = std::pair(guide.name(), scene.world_identity());
  if (work.world <= 0.0 || prepared_.contains(world)) {
    count_set_up(work.run);
    return true;
  }
  // It is no part of a step.
  const double all = work.run + work.world;
  if (companion_ != nullptr) {
    const RunCost guided = cost();
    if (companion_ends_run_before(announced_only(guided) + RunCost{0.0, all}, guided)) return false;
  }
  prepared_.insert(world);
  set_up_ += all;
  unannounced_ += all;
  return true;
}

void RunLedger::begin_set_up() {
  allowed_ = {0.0, estimated_};
  announced_ = estimated_;
}

bool RunLedger::companion_goes_first() {
  companion_->keep_up(wanted({0.0, estimated_}), run_.clock);
  const bool over = out_of_time();
  return !interrupted() && !over && !companion_decides({0.0, estimated_});
}

RunCost RunLedger::cost() const {
  RunCost sum{0.0, set_up_};
  for (Level* level : run_.levels) sum = sum + level->ledger().cost();
  return sum;
}

RunCost RunLedger::total() const { return companion_ != nullptr ? cost() + companion_->cost() : cost(); }

RunCost RunLedger::wanted(const RunCost& guided) const {
  const double share = 1.0 / (bound_ - 1.0);
  return {share * (guided.checks - companion_constant.checks), share * (guided.work - companion_constant.work)};
}

bool RunLedger::companion_decides(const RunCost& guided) const {
  const RootSearch& other = companion_->search();
  if (!other.ended() || other.certified()) return other.ended();
  const RunCost most = wanted(guided);
  const RunCost done = companion_->cost();
  return most.checks > done.checks || most.work > done.work;
}

bool RunLedger::companion_ends_run_before(const RunCost& more, const RunCost& guided) {
  if (ending_) return true;
  const RunCost most = guided + more;
  companion_->keep_up(wanted(most), run_.clock);
  ending_ = companion_decides(most);
  if (!ending_) {
    note_step(guided);
    allowed_ = most;
  } else {
    // Where levels still spend something while they end, SearchEnded ends them.
    monitor_->end();
  }
  return ending_;
}

bool RunLedger::companion_ends_run() {
  if (companion_ == nullptr) return false;
  if (ending_) return true;
  const RunCost guided = cost();
  const RunCost uncounted = announced_only(guided);
  slice_begun_ = guided;
  unannounced_at_slice_ = unannounced_;
  monitor_->begin({uncounted.checks, uncounted.work});
  return companion_ends_run_before(uncounted, guided);
}

bool RunLedger::ask(const Spending& next) {
  // An exception would pass through the script.
  if (lua_depth() > run_.lua_depth) return false;
  const RunCost guided = cost();
  const RunCost uncounted = announced_only(guided);
  RunCost more = uncounted + RunCost{std::max(0.0, next.checks - largest_slice.checks),
                                     std::max(0.0, next.work - largest_slice.work)};
  // All of the set-up was estimated before it began.
  if (!is_set_up_) more.work += std::max(0.0, estimated_ - set_up_);
  // The run is stopped between two proposals, of which the companion may have drawn the last one.
  if (!companion_ends_run_before(more, guided) && !interrupted()) return true;
  monitor_->end();
  uncounted_ = uncounted;
  run_.abandons_levels = true;
  // The account may belong to what ends now.
  run_.clock.switch_to(nullptr);
  throw SearchEnded{};
}

RunCost RunLedger::announced_only(const RunCost& guided) const {
  const RunCost counted = guided - slice_begun_;
  const double set_up = unannounced_ - unannounced_at_slice_;
  return {std::max(0.0, monitor_->announced().checks - counted.checks),
          std::max(0.0, monitor_->announced().work - (counted.work - set_up))};
}

void RunLedger::end_search() {
  Checks& checks = run_.levels.front()->instance().checks;
  checks.validity += static_cast<std::uint64_t>(uncounted_.checks);
  checks.other += uncounted_.work;
  uncounted_ = {};
  note_step(cost());
}

void RunLedger::note_step(const RunCost& guided) {
  check_growth(guided - guided_before_, guided);
  guided_before_ = guided;
  const RunCost step = guided - allowed_;
  largest_step_ = {std::max(largest_step_.checks, step.checks), std::max(largest_step_.work, step.work)};
}

}  // namespace trellis
