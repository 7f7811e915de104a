// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/density.hpp>

#include <algorithm>
#include <limits>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/planner/guidance.hpp>

namespace trellis {

std::shared_ptr<const Density> Density::sum(const std::vector<Term>&) const {
  throw Fault("a density without kin has no sum");
}

void DensityRecord::add_uniform(double share, double density) {
  now_.uniform += share;
  uniform_density_ = density;
}

void DensityRecord::add(const std::shared_ptr<const Density>& density, double share) {
  if (share <= 0.0) return;
  const auto [it, fresh] = places_.try_emplace(density.get(), static_cast<std::uint32_t>(terms_.size()));
  if (fresh) terms_.push_back({density, 0.0});
  now_terms_.emplace_back(it->second, share);
}

std::vector<Density::Term> DensityRecord::now() const {
  std::vector<Density::Term> terms;
  terms.reserve(now_terms_.size());
  for (const auto& [place, share] : now_terms_) terms.push_back({terms_[place].density, share});
  return terms;
}

void DensityRecord::flush() {
  past_.total += served_;
  past_.uniform += served_ * now_.uniform;
  past_.atoms += served_ * now_.atoms;
  past_.unknown += served_ * now_.unknown;
  for (const auto& [place, share] : now_terms_) terms_[place].weight += served_ * share;
  served_ = 0.0;
}

void DensityRecord::append(const DensityRecord& other) {
  flush();
  DensityRecord record = other;
  record.flush();
  past_.total += record.past_.total;
  past_.uniform += record.past_.uniform;
  past_.atoms += record.past_.atoms;
  past_.unknown += record.past_.unknown;
  if (record.uniform_density_ > 0.0) uniform_density_ = record.uniform_density_;
  terms_.insert(terms_.end(), record.terms_.begin(), record.terms_.end());
  if (terms_.size() <= most_terms_) return;
  compact();
  most_terms_ = std::max(most_terms_, 2 * terms_.size());
}

void DensityRecord::renew(const Guidance& h) {
  flush();
  if (terms_.size() > most_terms_) {
    compact();
    most_terms_ = std::max(most_terms_, 2 * terms_.size());
  }
  now_ = {};
  now_terms_.clear();
  h.record(*this, 1.0);
  epoch_ = h.epoch();
}

void DensityRecord::compact() {
  flush();
  std::vector<std::vector<Density::Term>> families;
  for (auto& term : terms_) {
    if (term.weight <= 0.0) continue;
    const auto family = std::find_if(families.begin(), families.end(),
                                     [&](const auto& f) { return f.front().density->mergeable(*term.density); });
    if (family == families.end()) {
      families.push_back({std::move(term)});
    } else {
      family->push_back(std::move(term));
    }
  }
  terms_.clear();
  for (auto& family : families) {
    terms_.push_back(family.size() == 1 ? std::move(family.front())
                                        : Density::Term{family.front().density->sum(family), 1.0});
  }
  // The indices have changed, so h is recorded again before its next proposal.
  places_.clear();
  now_terms_.clear();
  epoch_ = never;
}

double DensityRecord::at(View q) const {
  if (!exact()) return std::numeric_limits<double>::quiet_NaN();
  double sum = (past_.uniform + served_ * now_.uniform) * uniform_density_;
  for (const auto& term : terms_) {
    if (term.weight > 0.0) sum += term.weight * term.density->at(q);
  }
  for (const auto& [place, share] : now_terms_) sum += served_ * share * terms_[place].density->at(q);
  return sum / total();
}

}  // namespace trellis
