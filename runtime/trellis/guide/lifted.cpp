// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/lifted.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace trellis {

namespace {

class ConstantDensity final : public Density {
 public:
  explicit ConstantDensity(double value) : value_(value) {}
  [[nodiscard]] double at(View) const override { return value_; }

 private:
  double value_;
};

/// Writes f(q) to `s` and returns it; an empty view if q is empty.
View projected(const Projection& projection, View q, Configuration& s) {
  if (q.empty()) return {};
  projection.project(q, s);
  return s;
}

}  // namespace

LiftedDensity::LiftedDensity(std::shared_ptr<const Projection> projection, std::size_t dimension,
                             std::shared_ptr<const Density> density)
    : projection_(std::move(projection)), dimension_(dimension), density_(std::move(density)) {}

double LiftedDensity::at(View q) const {
  Configuration s(dimension_);
  projection_->project(q, s);
  const double p = projection_->folded(s, [&](View at) { return density_->at(at); });
  return p > 0.0 ? p * std::exp(projection_->log_fibre_density(q)) : p;
}

bool LiftedDensity::mergeable(const Density& other) const {
  const auto* lifted = dynamic_cast<const LiftedDensity*>(&other);
  return lifted != nullptr && lifted->projection_ == projection_ && density_->mergeable(*lifted->density_);
}

std::shared_ptr<const Density> LiftedDensity::sum(const std::vector<Term>& terms) const {
  std::vector<Term> inner;
  inner.reserve(terms.size());
  for (const auto& term : terms) {
    inner.push_back({dynamic_cast<const LiftedDensity&>(*term.density).density_, term.weight});
  }
  return std::make_shared<LiftedDensity>(projection_, dimension_, density_->sum(inner));
}

ProjectedHeuristic::ProjectedHeuristic(std::shared_ptr<const Projection> projection, std::size_t dimension,
                                       Configuration start, Configuration goal)
    : projection_(std::move(projection)),
      start_(std::move(start)),
      goal_(std::move(goal)),
      proposal_(dimension),
      near_(dimension),
      added_(dimension),
      blocked_(dimension) {}

Guidance::Source ProjectedHeuristic::sample(Stream& stream, MutableView out) {
  const Source source = inner().sample(stream, proposal_);
  projection_->lift(proposal_, stream, out);
  return source;
}

bool ProjectedHeuristic::worth_connecting(View from, View to) const {
  return inner().worth_connecting(projected(*projection_, from, proposal_), projected(*projection_, to, near_));
}

double ProjectedHeuristic::edge_factor(View a, View b) const {
  return inner().edge_factor(projected(*projection_, a, proposal_), projected(*projection_, b, near_));
}

void ProjectedHeuristic::observe(const Outcome& outcome, bool mine) {
  // Fates, rows and tree sides remain those of the planner.
  Outcome in_s = outcome;
  in_s.proposal = projected(*projection_, outcome.proposal, proposal_);
  in_s.near = projected(*projection_, outcome.near, near_);
  in_s.added = projected(*projection_, outcome.added, added_);
  in_s.blocked_at = projected(*projection_, outcome.blocked_at, blocked_);
  inner().observe(in_s, mine);
}

LiftedHeuristic::LiftedHeuristic(std::string source, std::shared_ptr<const Projection> projection, const Space& s,
                                 std::unique_ptr<Heuristic> inner, Configuration start, Configuration goal)
    : ProjectedHeuristic(std::move(projection), s.dimension(), std::move(start), std::move(goal)),
      source_(std::move(source)),
      inner_(std::move(inner)),
      uniform_(std::make_shared<LiftedDensity>(this->projection(), s.dimension(),
                                               std::make_shared<ConstantDensity>(std::exp(-s.log_volume())))),
      s_(s.dimension()) {}

void LiftedHeuristic::record(DensityRecord& record, double share) const {
  DensityRecord now;
  now.served(*inner_);
  // A single point of S is not a single point of C: if S lacks an axis, its lift is a fibre without a density over C.
  if (!projection()->closed_form() || now.atoms() > 0.0 || !now.exact()) {
    record.add_unknown(share);
    return;
  }
  decltype(lifted_) lifted;
  const auto terms = now.now();
  lifted.reserve(terms.size());
  for (const auto& [density, weight] : terms) {
    // Lifts each density once, so that records recognise the result.
    const auto known =
        std::find_if(lifted_.begin(), lifted_.end(), [&of = density](const auto& pair) { return pair.first == of; });
    lifted.emplace_back(density, known != lifted_.end()
                                     ? known->second
                                     : std::make_shared<LiftedDensity>(projection(), s_.size(), density));
    record.add(lifted.back().second, share * weight);
  }
  record.add(uniform_, share * now.uniform());
  lifted_ = std::move(lifted);
}

}  // namespace trellis
