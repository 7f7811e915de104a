// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/lifted.hpp>

#include <algorithm>
#include <cmath>

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

LiftedHeuristic::LiftedHeuristic(std::shared_ptr<const Projection> projection, const Space& s,
                                 std::unique_ptr<Heuristic> inner, Configuration start, Configuration goal,
                                 Points points, std::string source)
    : projection_(std::move(projection)),
      inner_(std::move(inner)),
      start_(std::move(start)),
      goal_(std::move(goal)),
      points_(points),
      source_(std::move(source)),
      uniform_(std::make_shared<LiftedDensity>(projection_, s.dimension(),
                                               std::make_shared<ConstantDensity>(std::exp(-s.log_volume())))),
      proposal_(s.dimension()),
      near_(s.dimension()),
      added_(s.dimension()),
      blocked_(s.dimension()) {}

Guidance::Source LiftedHeuristic::sample(Stream& stream, MutableView out) {
  const Source source = inner_->sample(stream, proposal_);
  projection_->lift(proposal_, stream, out);
  return source_.empty() ? source : Source{0};
}

std::uint32_t LiftedHeuristic::draw_control(Stream& stream, const ControlQuery& query, MutableView control) {
  ControlQuery in_s = query;
  in_s.from = projected(*projection_, query.from, near_);
  in_s.proposal = projected(*projection_, query.proposal, proposal_);
  return inner_->draw_control(stream, in_s, control);
}

bool LiftedHeuristic::worth_connecting(View from, View to) const {
  return inner_->worth_connecting(projected(*projection_, from, proposal_), projected(*projection_, to, near_));
}

std::optional<double> LiftedHeuristic::edge_factor(View a, View b) const {
  return inner_->edge_factor(projected(*projection_, a, proposal_), projected(*projection_, b, near_));
}

void LiftedHeuristic::observe(const Outcome& outcome, bool mine) {
  // Fates, rows and tree sides remain those of the planner.
  Outcome in_s = outcome;
  in_s.proposal = projected(*projection_, outcome.proposal, proposal_);
  in_s.near = projected(*projection_, outcome.near, near_);
  in_s.added = projected(*projection_, outcome.added, added_);
  in_s.blocked_at = projected(*projection_, outcome.blocked_at, blocked_);
  inner_->observe(in_s, mine);
}

void LiftedHeuristic::record(DensityRecord& record, double share) const {
  DensityRecord now;
  now.served(*inner_);
  if (!projection_->closed_form() || !now.exact() || (points_ == Points::unknown && now.atoms() > 0.0)) {
    record.add_unknown(share);
    return;
  }
  for (const auto& [density, weight] : now.now()) record.add(lifted(density), share * weight);
  record.add(uniform_, share * now.uniform());
  record.add_atoms(share * now.atoms());
}

std::shared_ptr<const Density> LiftedHeuristic::lifted(const std::shared_ptr<const Density>& density) const {
  constexpr std::size_t many = 64;
  const auto known =
      std::find_if(lifted_.begin(), lifted_.end(), [&](const auto& pair) { return pair.first == density; });
  if (known != lifted_.end()) return known->second;
  if (lifted_.size() == many) lifted_.clear();
  lifted_.emplace_back(density, std::make_shared<LiftedDensity>(projection_, proposal_.size(), density));
  return lifted_.back().second;
}

}  // namespace trellis
