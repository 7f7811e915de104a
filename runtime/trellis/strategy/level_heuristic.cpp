// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/level_heuristic.hpp>

namespace trellis {

void LevelHeuristic::select_tree(TreeSide side) {
  informed_.select_tree(side);
  if (guide_ != nullptr) guide_->select_tree(side);
}

Guidance::Source LevelHeuristic::sample(Stream& stream, MutableView out) {
  drawn_ = choose(stream.uniform());
  const bool guides = drawn_ == Part::guide || drawn_ == Part::informed;
  ledger_.drew(guides);
  Source source = 0;
  switch (drawn_) {
    case Part::goal: source = goal_.sample(stream, out); break;
    case Part::uniform:
      uniform_.sample(stream, out);
      source = 1;
      break;
    case Part::informed:
      informed_.h().sample(stream, out);
      source = 2;
      break;
    case Part::guide: source = static_cast<Source>(3 + guide_->sample(stream, out)); break;
  }
  if (guided()) instance_.validity->expect_guided(guides);
  return source;
}

LevelHeuristic::Part LevelHeuristic::choose(double u) const {
  if (u < common_.goal_bias) return Part::goal;
  if (!ledger_.open() || !guided()) return Part::uniform;
  u = (u - common_.goal_bias) / (1.0 - common_.goal_bias);
  if (u < common_.uniform) return Part::uniform;
  u = (u - common_.uniform) / (1.0 - common_.uniform);
  return informed_.guides() && (guide_ == nullptr || u < informed_share) ? Part::informed : Part::guide;
}

LevelHeuristic::Shares LevelHeuristic::shares() const {
  const double rest = 1.0 - common_.goal_bias;
  if (!guided() || !ledger_.open()) return {common_.goal_bias, rest, 0.0, 0.0};
  const double guided_share = rest * (1.0 - common_.uniform);
  const double informed = !informed_.guides() ? 0.0 : guide_ == nullptr ? 1.0 : informed_share;
  return {common_.goal_bias, rest * common_.uniform, guided_share * informed, guided_share * (1.0 - informed)};
}

bool LevelHeuristic::preview(Stream& stream, MutableView out) const {
  if (guided()) return false;
  return stream.uniform() < common_.goal_bias ? goal_.preview(stream, out) : uniform_.preview(stream, out);
}

const Guidance* LevelHeuristic::drawn_from() const {
  if (drawn_ == Part::guide) return guide_.get();
  return drawn_ == Part::informed && informed_.guides() ? &informed_.h() : nullptr;
}

std::uint32_t LevelHeuristic::vertex() const {
  const Guidance* h = drawn_from();
  return h != nullptr ? h->vertex() : no_node;
}

std::uint32_t LevelHeuristic::draw_control(Stream& stream, const ControlQuery& query, MutableView control) {
  if (drawn_ == Part::guide) return guide_->draw_control(stream, query, control);
  return drawn_ == Part::informed && informed_.guides() ? informed_.h().draw_control(stream, query, control) : 0;
}

bool LevelHeuristic::worth_connecting(View from, View to) const {
  const Guidance* h = drawn_from();
  // Below the root more motions are valid than in C, and where validity is presumed all are: the guide alone knows
  // which ones are worth it, whichever part drew the proposal.
  if (h == nullptr && ledger_.open() && below_root_) h = guide_.get();
  return h == nullptr || h->worth_connecting(from, to);
}

void LevelHeuristic::restart() {
  informed_.restart();
  if (guide_ != nullptr) guide_->restart();
}

void LevelHeuristic::record(DensityRecord& record, double share) const {
  const Shares of = shares();
  goal_.record(record, share * of.goal);
  uniform_.record(record, share * of.uniform);
  if (of.informed > 0.0) informed_.h().record(record, share * of.informed);
  if (of.guide > 0.0) guide_->record(record, share * of.guide);
}

void LevelHeuristic::observe(const Outcome& outcome, bool mine) {
  informed_.observe(outcome, mine && drawn_ == Part::informed);
  if (guide_ == nullptr) return;
  const std::uint64_t before = instance_.checks.validity;
  guide_->observe(outcome, mine && drawn_ == Part::guide);
  // The guide pays for its own checks, whichever part drew the proposal.
  ledger_.count_validation(static_cast<double>(instance_.checks.validity - before));
}

void LevelHeuristic::found(double length) {
  ledger_.found(true);
  if (path_found_) path_found_(length);
  if (guide_ != nullptr) guide_->found(length);
}

std::vector<std::string> LevelHeuristic::sources() const {
  std::vector<std::string> all = {"goal", "uniform", "informed path"};
  if (guide_ != nullptr) {
    for (auto& name : guide_->sources()) all.push_back(std::move(name));
  }
  return all;
}

}  // namespace trellis
