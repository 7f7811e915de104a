// SPDX-License-Identifier: GPL-3.0-or-later
// Records of levels: what a search has made, completed and lifted to the root's space.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <trellis/guide/lifted.hpp>
#include <trellis/strategy/absorb.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

/// Completes the record of a proposal whose result is not known.
void complete_proposals(Search& search, bool driven) {
  while (search.fates.size() < search.proposals.size()) {
    search.fates.push_back(Fate::rejected);
    search.near.push_back(no_node);
    search.added.push_back(no_node);
    if (driven) search.controls.ends.push_back(static_cast<std::uint32_t>(search.controls.steps.size()));
  }
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
  const Ledger::BothSpent spent = ledger_.spent();
  record.guided = h_.guided();
  record.guided_checks = record.guided ? static_cast<std::uint64_t>(spent.guided.checks) : 0;
  record.unguided_checks =
      record.search.checks.validity - std::min(record.guided_checks, record.search.checks.validity);
  const auto& sources = record.search.proposal_sources;
  record.guided_proposals = static_cast<std::uint64_t>(
      std::count_if(sources.begin(), sources.end(), [](auto source) { return LevelHeuristic::is_guided(source); }));
  record.search.sources = h_.sources();
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
  complete_proposals(record.search, instance_->motion_model != nullptr);
  if (solving_) {
    ++record.solves;
    if (!record.solution.solved()) record.solution = planner_->solution(Status::paused);
    if (!record.solution.solved()) record.solution.status = Status::interrupted;
  }
  complete(record, lift, companion);
  return record;
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
