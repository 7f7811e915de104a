// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/efficiency.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <optional>

#include <trellis/base/polling.hpp>
#include <trellis/measure/along.hpp>
#include <trellis/measure/evaluation.hpp>
#include <trellis/measure/samples.hpp>
#include <trellis/measure/supported.hpp>

namespace trellis {

namespace {

constexpr double expected_hits = 10.0;    // with fewer expected uniform samples in A, N is underpowered
constexpr std::size_t enough_hits = 300;  // samples in A that give mass and arc length within 0.1 nats
constexpr double least_margin = 0.02;     // coverage must fall below uniform's by this much for a flag
constexpr double bound_margin = 0.05;     // an estimate may lie below its bound by this much: its accuracy

/// Computes -log Q(A) and its lower bound, from the upper end of Clopper and Pearson's interval.
void bound_mass(Efficiency& result) {
  const auto total = static_cast<double>(result.samples);
  const auto inside = static_cast<double>(result.in_target);
  result.mass = -std::log(inside / total);
  const double highest = boost::math::binomial_distribution<>::find_upper_bound_on_p(total, inside, 0.05);
  result.mass_lower95 = result.in_target == result.samples ? 0.0 : -std::log(highest);
  using Binomial = boost::math::binomial_distribution<>;
  constexpr double each_side = 0.025;
  const double most = Binomial::find_upper_bound_on_p(total, inside, each_side);
  result.mass_lo = result.in_target == result.samples ? 0.0 : -std::log(most);
  result.mass_hi = -std::log(result.in_target == 0 ? 0.0 : Binomial::find_lower_bound_on_p(total, inside, each_side));
}

/// Splits an estimate by the chain rule, unless its estimator already computed the parts.
void split(Estimate& estimate, const Efficiency& whole, const Target& target) {
  const bool across = target.space().degrees() < most_across;
  const auto complete = [&](ChainRule& parts, double divergence, double along) {
    if (std::isnan(parts.mass)) return;
    if (std::isinf(parts.mass)) return;  // nothing in A: all of it is mass
    parts.spread = divergence - parts.mass;
    parts.along = along;
    if (across) parts.across = parts.spread - parts.along;
  };
  ChainRule& plain = estimate.unregularised_parts;
  // Within sampling error the mass of the recorded density equals that of Q. Where it is smaller, h proposes points of
  // a path themselves: mass without a density, which only counting finds. The spread then contains the loss.
  if (plain.mass > whole.mass_hi) plain.mass = whole.mass;
  if (std::isnan(plain.mass)) plain.mass = whole.mass;
  complete(plain, estimate.unregularised, whole.along.corrected);
  if (!target.is_uniform()) return;
  const double assumed = std::isinf(plain.mass) ? measure::mass_without_hit(whole.samples) : plain.mass;
  estimate.parts.mass = regularised_mass(assumed, whole.uniform);
  complete(estimate.parts, estimate.value, whole.along.regularised);
}

/// Computes the share of the evaluation points within delta of a sample, and flags one below that of as many uniform
/// samples.
void cover(const measure::Evaluation& evaluation, Efficiency& result) {
  const Target& target = evaluation.target;
  const NearestIndex& atoms = evaluation.samples.atom_tree();
  const double square = target.delta() * target.delta();
  const auto total = static_cast<double>(result.samples);
  double covered = 0.0;
  double expected = 0.0;
  double hits = 0.0;
  for (std::size_t i = 0; i < evaluation.points; ++i) {
    poll(i);
    double nearest = evaluation.neighbours[i * measure::Evaluation::neighbour_count];
    if (nearest > square && atoms.size() > 0) {
      double atom = 0.0;
      atoms.nearest_distances(evaluation.at(i), {&atom, 1});
      nearest = std::min(nearest, atom);
    }
    covered += nearest <= square ? 1.0 : 0.0;
    expected -= std::expm1(total * target.log_miss(i));
    hits += target.hit(i);
  }
  const auto count = static_cast<double>(evaluation.points);
  result.coverage = covered / count;
  const double uniform = expected / count;
  // The coverage by uniform samples varies between sets, as for about |A| / |ball| independent positions.
  const double places = std::max(1.0, std::exp(-target.uniform()) / std::max(hits / count, 1e-300));
  const double spread = std::sqrt(uniform * (1.0 - uniform) / places);
  if (target.space().degrees() >= most_across) return;  // balls about so few samples cover nothing, whatever they are
  if (result.coverage < uniform - std::max(least_margin, 2.0 * spread)) {
    result.flags.emplace_back("partial");
  }
}

/// Returns the result on a target without any valid configuration.
Efficiency on_nothing(const Target& target, std::size_t samples) {
  Efficiency result;
  result.samples = samples;
  result.free_share = target.free_share();
  result.flags.emplace_back("empty target");
  result.reason = "the target is empty: no valid configuration lies in it";
  return result;
}

void take(Efficiency& result, const Estimate& estimate) { static_cast<Estimate&>(result) = estimate; }

/// Whether figures follow the rules for many dimensions: from five degrees of freedom on hardly a uniform sample lies
/// in any target.
bool in_many_dimensions(const Target& target) { return target.space().degrees() >= most_across; }

/// Returns for each point of the pool whether samples cannot reach it as it is invalid; empty where they may.
std::vector<char> unreachable_points(const Target& target, SampleSupport support) {
  std::vector<char> unreachable;
  if (support != SampleSupport::valid_only || !target.holds_invalid()) return unreachable;
  unreachable.reserve(target.pool().size());
  for (std::size_t i = 0; i < target.pool().size(); ++i) {
    poll(i);
    unreachable.push_back(target.valid(target.pool()[i]) ? 0 : 1);
  }
  return unreachable;
}

/// Adds the estimates: the first estimator that fits the samples gives the headline, the next ones the others.
void estimate(const measure::Evaluation& evaluation, const Scoring& scoring, Efficiency& result) {
  const Target& target = evaluation.target;
  const std::size_t hits = evaluation.in_target.count;
  const bool many = in_many_dimensions(target);
  std::string reasons;
  bool found = false;
  for (const EstimatorSpec& spec : scoring.estimators) {
    if (found && (scoring.headline_only || (scoring.brief && spec.name() != "knn"))) continue;
    const measure::EstimatorKind& kind = *measure::find_estimator(spec.name());
    const std::string reason = kind.unfit(spec.options(), evaluation);
    if (!reason.empty()) {
      // An estimator that requires more samples is skipped for the next one; a single requested estimator states why it
      // fails.
      const bool alone = scoring.estimators.size() == 1;
      const bool passed_over = spec.name() == "arc" || spec.name() == "exact";
      if (alone ? spec.name() != "exact" : !passed_over) reasons += (reasons.empty() ? "" : "; ") + reason;
      continue;
    }
    Estimate estimate = kind.estimate(spec.options(), evaluation);
    // Density that smoothing places where no sample lies is no evidence.
    if (hits == 0 && spec.name() != "exact") {
      estimate.unregularised = std::numeric_limits<double>::infinity();
    }
    estimate.estimator = spec.text();
    split(estimate, result, target);
    if (!found) {
      take(result, estimate);
      if (spec.name() == "arc") result.flags.emplace_back("lower bound");
      if (spec.name() == "knn" && many) result.flags.emplace_back("indicative");
      if (spec.name() != "exact" && many && hits > 0 && hits < enough_hits) result.flags.emplace_back("few in target");
    } else {
      result.others.push_back(std::move(estimate));
    }
    found = true;
  }
  if (found) {
    if (result.unregularised < result.mass_lower95 - bound_margin) result.flags.emplace_back("below mass bound");
    return;
  }
  result.estimator = scoring.estimators.empty() ? "" : scoring.estimators.back().text();
  result.flags.emplace_back("too few samples");
  result.reason = reasons.empty() ? "no estimator was asked for that has a figure for these samples" : reasons;
}

}  // namespace

Efficiency efficiency(const Target& target, const Configurations& samples, const Scoring& scoring) {
  if (target.empty()) return on_nothing(target, samples.size());
  return efficiency(target, PreparedSamples(target.space(), samples), scoring);
}

Efficiency efficiency(const Target& target, const PreparedSamples& samples, const Scoring& scoring) {
  if (target.empty()) return on_nothing(target, samples.total());
  if (!(samples.space() == target.space())) {
    throw Error(fmt::format("measure: the samples were made ready in the space {}, the target lies in {}",
                            samples.space().name(), target.space().name()));
  }
  Efficiency result;
  result.samples = samples.total();
  result.free_share = target.free_share();
  result.uniform = target.uniform();
  const measure::InTarget inside = measure::in_target(target, samples);
  result.in_target = inside.count;
  result.repeated = std::accumulate(samples.copies().begin(), samples.copies().end(), std::size_t{0});
  if (samples.total() == 0) {
    result.flags.emplace_back("too few samples");
    result.reason = "there are no samples";
    return result;
  }
  if (!in_many_dimensions(target) && static_cast<double>(samples.total()) * std::exp(-result.uniform) < expected_hits) {
    result.flags.emplace_back("underpowered");
  }

  constexpr std::size_t neighbours = measure::Evaluation::neighbour_count;
  const std::size_t points =
      scoring.points > 0 ? std::min(scoring.points, target.evaluation_points()) : target.evaluation_points();
  std::vector<double> squared(points * neighbours);
  const std::vector<char> unreachable = unreachable_points(target, scoring.support);
  if (std::count(unreachable.begin(), unreachable.end(), 1) > 0) result.flags.emplace_back("cannot reach");
  result.along = measure::along_path(target, inside.arcs, points,
                                     static_cast<double>(inside.count) / static_cast<double>(samples.total()));
  const measure::Evaluation evaluation{
      target,
      samples,
      inside,
      points,
      squared,
      scoring.density,
      unreachable,
      result.along,
      scoring.pool > 0 ? std::min(scoring.pool, target.pool().size()) : target.pool().size()};
  for (std::size_t i = 0; i < points; ++i) {
    poll(i);
    samples.tree().nearest_distances(evaluation.at(i), std::span(squared).subspan(i * neighbours, neighbours));
  }

  bound_mass(result);
  if (target.is_uniform()) result.perfect = regularised_mass(0.0, result.uniform);
  cover(evaluation, result);
  if (inside.count == 0) result.flags.emplace_back("censored");
  estimate(evaluation, scoring, result);
  if (covers_space(result.uniform)) result.flags.emplace_back("covers the space");
  if (scoring.interval && target.is_uniform()) {
    if (result.estimator.starts_with("exact")) {
      result.value_lo = result.value_hi = result.value;
    } else {
      const measure::Supported supported = measure::supported_interval(evaluation, scoring.rough_interval);
      result.value_lo = supported.lo;
      result.value_hi = supported.hi;
    }
  }
  return result;
}

namespace {

/// The mean over the results that have the value; infinite where one of them is.
class Mean {
 public:
  void add(double value) {
    if (std::isnan(value)) return;
    sum_ += value;
    ++count_;
  }
  [[nodiscard]] double value() const {
    return count_ > 0 ? sum_ / static_cast<double>(count_) : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

template <class Figure, class Field>
double mean_of(std::span<const Figure> figures, Field field) {
  Mean mean;
  for (const Figure& figure : figures) mean.add(field(figure));
  return mean.value();
}

Estimate mean_estimate(std::span<const Estimate> estimates) {
  Estimate result;
  result.estimator = estimates.front().estimator;
  for (double Estimate::*field : {&Estimate::value, &Estimate::unregularised, &Estimate::above_uniform}) {
    result.*field = mean_of(estimates, [&](const Estimate& e) { return e.*field; });
  }
  for (ChainRule Estimate::*parts : {&Estimate::parts, &Estimate::unregularised_parts}) {
    for (double ChainRule::*part : {&ChainRule::mass, &ChainRule::spread, &ChainRule::along, &ChainRule::across}) {
      result.*parts.*part = mean_of(estimates, [&](const Estimate& e) { return e.*parts.*part; });
    }
  }
  return result;
}

/// A profile over `count` bins, which are unions of parts of its own.
std::vector<double> resampled(const std::vector<double>& shares, std::size_t count) {
  std::vector<double> result(count, 0.0);
  const auto from = static_cast<double>(shares.size());
  const auto to = static_cast<double>(count);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double lo = static_cast<double>(i) / from * to;
    const double hi = static_cast<double>(i + 1) / from * to;
    for (auto j = static_cast<std::size_t>(lo); j < count && static_cast<double>(j) < hi; ++j) {
      const auto at = static_cast<double>(j);
      result[j] += shares[i] * std::max(0.0, std::min(hi, at + 1.0) - std::max(lo, at)) / (hi - lo);
    }
  }
  return result;
}

Along mean_along(std::span<const Efficiency> figures) {
  Along result;
  result.divergence = mean_of(figures, [](const Efficiency& e) { return e.along.divergence; });
  result.empty_share = mean_of(figures, [](const Efficiency& e) { return e.along.empty_share; });
  result.corrected = mean_of(figures, [](const Efficiency& e) { return e.along.corrected; });
  result.regularised = mean_of(figures, [](const Efficiency& e) { return e.along.regularised; });
  result.length = mean_of(figures, [](const Efficiency& e) { return e.along.length; });
  std::size_t bins = 0;
  double with = 0.0;
  for (const Efficiency& e : figures) {
    if (e.along.target.empty()) continue;
    bins = bins == 0 ? e.along.target.size() : std::min(bins, e.along.target.size());
    with += 1.0;
  }
  result.target.assign(bins, 0.0);
  result.samples.assign(bins, 0.0);
  for (const Efficiency& e : figures) {
    if (e.along.target.empty()) continue;
    const auto target = resampled(e.along.target, bins);
    const auto samples = resampled(e.along.samples, bins);
    for (std::size_t j = 0; j < bins; ++j) {
      result.target[j] += target[j] / with;
      result.samples[j] += samples[j] / with;
    }
  }
  return result;
}

}  // namespace

std::string blank_reason(double lo, double hi, double uniform) {
  if (std::isnan(lo) || std::isnan(hi)) return "no interval";
  if (hi < uniform || lo > uniform || hi - lo <= most_width) return "";
  return "too few samples to show on which side of uniform sampling they are";
}

bool covers_space(double uniform) { return uniform < least_scale; }

double least_value(const Efficiency& efficiency) {
  if (std::isnan(efficiency.perfect)) return efficiency.perfect;
  return regularised_mass(efficiency.mass_lower95, efficiency.uniform);
}

Efficiency shown(Efficiency efficiency) {
  const auto show = [&](Estimate& e) {
    // Recorded densities cannot fall below the bound by chance; a floor is no estimate either.
    const bool estimated = !e.estimator.starts_with("exact");
    const auto bound = [&](double& divergence, ChainRule& parts, double least) {
      if (std::isnan(divergence)) return;
      if (estimated && divergence < least) divergence = least;
      divergence = std::max(divergence, 0.0);
      if (std::isnan(parts.mass) || std::isnan(parts.spread)) return;
      parts.mass = std::clamp(parts.mass, 0.0, std::isfinite(divergence) ? divergence : parts.mass);
      parts.spread = divergence - parts.mass;
      if (std::isnan(parts.along)) return;
      parts.along = std::clamp(parts.along, 0.0, parts.spread);
      if (!std::isnan(parts.across)) parts.across = parts.spread - parts.along;
    };
    const double certain = efficiency.mass_lower95;
    bound(e.unregularised, e.unregularised_parts, certain);
    const double least = least_value(efficiency);
    bound(e.value, e.parts, std::isnan(least) ? 0.0 : least);
    if (!std::isnan(e.value)) e.above_uniform = efficiency.uniform - e.value;
  };
  show(efficiency);
  for (Estimate& other : efficiency.others) show(other);
  return efficiency;
}

Efficiency rounded(Efficiency e) {
  const auto round = [](double& x) {
    if (std::isfinite(x)) x = std::strtod(fmt::format("{:.7g}", x).c_str(), nullptr);
  };
  const auto round_estimate = [&](Estimate& one) {
    for (double* x : {&one.value, &one.unregularised, &one.above_uniform}) round(*x);
    for (ChainRule* parts : {&one.parts, &one.unregularised_parts}) {
      for (double* x : {&parts->mass, &parts->spread, &parts->along, &parts->across}) round(*x);
    }
  };
  round_estimate(e);
  for (Estimate& other : e.others) round_estimate(other);
  for (double* x : {&e.uniform, &e.perfect, &e.value_lo, &e.value_hi, &e.mass, &e.mass_lower95, &e.mass_lo, &e.mass_hi,
                    &e.coverage, &e.free_share, &e.along.divergence, &e.along.empty_share, &e.along.length,
                    &e.along.corrected, &e.along.regularised, &e.hitting.length, &e.hitting.samples}) {
    round(*x);
  }
  for (BallHits* hits : {&e.hitting.position, &e.hitting.full}) {
    for (double* x : {&hits->hitting, &hits->hitting_lo, &hits->hitting_hi, &hits->bottleneck, &hits->at,
                      &hits->bottleneck_lo, &hits->bottleneck_hi}) {
      round(*x);
    }
  }
  constexpr double unit = 10000.0;
  for (std::vector<double>* shares : {&e.along.target, &e.along.samples}) {
    for (double& share : *shares) share = std::round(unit * share) / unit;
  }
  return e;
}

Efficiency mean(std::span<const Efficiency> figures) {
  Efficiency result;
  if (figures.empty()) {
    result.reason = "there is no target";
    return result;
  }
  std::vector<const Efficiency*> with;
  for (const Efficiency& e : figures) {
    if (!std::isnan(e.value)) with.push_back(&e);
  }
  const Efficiency& first = with.empty() ? figures.front() : *with.front();
  result.samples = first.samples;
  result.repeated = first.repeated;
  std::vector<Estimate> headlines(figures.begin(), figures.end());
  headlines.front().estimator = first.estimator;
  take(result, mean_estimate(headlines));
  for (double Efficiency::*field :
       {&Efficiency::value_lo, &Efficiency::value_hi, &Efficiency::uniform, &Efficiency::perfect, &Efficiency::mass,
        &Efficiency::mass_lower95, &Efficiency::mass_lo, &Efficiency::mass_hi, &Efficiency::coverage,
        &Efficiency::free_share}) {
    result.*field = mean_of(figures, [&](const Efficiency& e) { return e.*field; });
  }
  double inside = 0.0;
  for (const Efficiency& e : figures) inside += static_cast<double>(e.in_target);
  result.in_target = static_cast<std::size_t>(std::llround(inside / static_cast<double>(figures.size())));
  result.along = mean_along(figures);
  std::vector<Hitting> hits;
  hits.reserve(figures.size());
  for (const Efficiency& e : figures) hits.push_back(e.hitting);
  result.hitting = mean(hits);
  for (const Estimate& other : first.others) {
    std::vector<Estimate> same;
    for (const Efficiency* e : with) {
      for (const Estimate& candidate : e->others) {
        if (candidate.estimator == other.estimator) same.push_back(candidate);
      }
    }
    result.others.push_back(mean_estimate(same));
  }
  std::vector<std::pair<std::string, std::size_t>> raised;
  for (const Efficiency& e : figures) {
    for (const std::string& flag : e.flags) {
      const auto it = std::find_if(raised.begin(), raised.end(), [&](const auto& r) { return r.first == flag; });
      if (it != raised.end()) {
        ++it->second;
      } else {
        raised.emplace_back(flag, 1);
      }
    }
  }
  for (const auto& [flag, times] : raised) {
    if (2 * times >= figures.size()) result.flags.push_back(flag);
  }
  result.reason = with.empty() ? first.reason : "";
  return result;
}

}  // namespace trellis
