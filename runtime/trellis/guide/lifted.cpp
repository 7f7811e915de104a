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

}  // namespace

LiftedDensity::LiftedDensity(std::shared_ptr<const Projection> projection, std::size_t dimension,
                             std::shared_ptr<const Density> density)
    : projection_(std::move(projection)), dimension_(dimension), density_(std::move(density)) {}

double LiftedDensity::at(View q) const {
  Configuration s(dimension_);
  projection_->project(q, s);
  const double p = density_->at(s);
  return p > 0.0 ? p * std::exp(projection_->log_fibre_density(q)) : p;
}

bool LiftedDensity::akin(const Density& other) const {
  const auto* lifted = dynamic_cast<const LiftedDensity*>(&other);
  return lifted != nullptr && lifted->projection_ == projection_ && density_->akin(*lifted->density_);
}

std::shared_ptr<const Density> LiftedDensity::sum(const std::vector<Term>& terms) const {
  std::vector<Term> inner;
  inner.reserve(terms.size());
  for (const auto& term : terms) {
    inner.push_back({dynamic_cast<const LiftedDensity&>(*term.density).density_, term.weight});
  }
  return std::make_shared<LiftedDensity>(projection_, dimension_, density_->sum(inner));
}

LiftedHeuristic::LiftedHeuristic(std::string source, std::shared_ptr<const Projection> projection, const Space& s,
                                 std::unique_ptr<Heuristic> inner)
    : source_(std::move(source)),
      projection_(std::move(projection)),
      inner_(std::move(inner)),
      uniform_(std::make_shared<LiftedDensity>(projection_, s.dimension(),
                                               std::make_shared<ConstantDensity>(std::exp(-s.log_volume())))),
      s_(s.dimension()) {}

Guidance::Source LiftedHeuristic::sample(Stream& stream, MutableView out) {
  inner_->sample(stream, s_);
  projection_->lift(s_, stream, out);
  return 0;
}

double LiftedHeuristic::density(View q) const {
  if (!projection_->closed_form()) return std::numeric_limits<double>::quiet_NaN();
  projection_->project(q, s_);
  const double p = inner_->density(s_);
  return p > 0.0 ? p * std::exp(projection_->log_fibre_density(q)) : p;
}

void LiftedHeuristic::record(DensityRecord& record, double share) const {
  DensityRecord now;
  now.served(*inner_);
  // A single point of S is no single point of C: where S lacks an axis, its fibre has no density of its own.
  if (!projection_->closed_form() || now.atoms() > 0.0 || !now.exact()) {
    record.add_unknown(share);
    return;
  }
  decltype(lifted_) lifted;
  const auto terms = now.now();
  lifted.reserve(terms.size());
  for (const auto& [density, weight] : terms) {
    // The same density is lifted once, so that records know it again.
    const auto known =
        std::find_if(lifted_.begin(), lifted_.end(), [&of = density](const auto& pair) { return pair.first == of; });
    lifted.emplace_back(density, known != lifted_.end()
                                     ? known->second
                                     : std::make_shared<LiftedDensity>(projection_, s_.size(), density));
    record.add(lifted.back().second, share * weight);
  }
  record.add(uniform_, share * now.uniform());
  lifted_ = std::move(lifted);
}

void LiftedHeuristic::observe(const Outcome& outcome, bool mine) {
  // Of an outcome in C, what guides the search of S by a path goes by: the node.
  Outcome in_s;
  in_s.fate = outcome.fate;
  in_s.from_goal = outcome.from_goal;
  if (!outcome.added.empty()) {
    projection_->project(outcome.added, s_);
    in_s.added = s_;
  }
  inner_->observe(in_s, mine);
}

}  // namespace trellis
