// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/lifted.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/base/error.hpp>

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

AxesProjection::AxesProjection(Space c, Space s)
    : c_(std::move(c)), s_(std::move(s)), log_fibre_density_(s_.log_volume() - c_.log_volume()) {
  std::vector<std::string> names;
  names.reserve(c_.dimension());
  for (const Axis& axis : c_.axes()) names.push_back(axis.name);
  axes_.reserve(s_.dimension());
  for (const Axis& axis : s_.axes()) {
    const auto found = std::find(names.begin(), names.end(), axis.name);
    if (found == names.end()) {
      throw Error(fmt::format("S has an axis '{}' that C lacks{}; C has: {}", axis.name, did_you_mean(axis.name, names),
                              fmt::join(names, ", ")));
    }
    const auto place = static_cast<std::size_t>(found - names.begin());
    const Axis& of = c_.axes()[place];
    if (axis.periodic != of.periodic || axis.lo < of.lo || axis.hi > of.hi) {
      throw Error(fmt::format("S has the axis '{}' from {:g} to {:g}{}, which is not within C's, from {:g} to {:g}{}",
                              axis.name, axis.lo, axis.hi, axis.periodic ? ", periodic" : "", of.lo, of.hi,
                              of.periodic ? ", periodic" : ""));
    }
    log_fibre_density_ += std::log(of.period() / axis.period());
    identity_ = identity_ && place == axes_.size();
    axes_.push_back(place);
  }
  identity_ = identity_ && axes_.size() == c_.dimension();
}

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
