// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/efficiency.hpp>

#include <algorithm>
#include <array>
#include <boost/math/special_functions/digamma.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include <trellis/measure/cut_ball.hpp>
#include <trellis/measure/point_tree.hpp>
#include <trellis/measure/samples.hpp>

namespace trellis {

namespace {

constexpr std::size_t neighbours = 3;      // k
constexpr std::size_t space_points = 256;  // of a ball, for its share in C
constexpr std::size_t target_points = 32;  // of a ball, for its share in A: each costs a validity check
constexpr std::size_t pool_enough = 30;    // pool points in a ball that tell its volume in A
constexpr std::size_t pool_expected = 64;  // pool points wanted in a ball, where the pool could give many more
constexpr std::size_t least_pool = 2048;
constexpr double expected_hits = 10.0;  // uniform samples in A below which N is underpowered

double digamma(std::size_t n) { return boost::math::digamma(static_cast<double>(n)); }

/// The first `count` points of a target's pool in metric coordinates, row by row.
std::vector<double> pool_rows(const Target& target, const measure::Frame& frame, std::size_t count) {
  const std::size_t d = frame.dimension();
  std::vector<double> rows(count * d);
  for (std::size_t i = 0; i < count; ++i) {
    frame.to_metric(target.pool()[i], MutableView(rows).subspan(i * d, d));
  }
  return rows;
}

/// log q at points of A by blended k nearest neighbours.
///
/// The plain term sees all samples and is blind to the border of A; the in-tube term sees the samples in A only, and
/// the part of its ball in A. Each is best where the other is worst, and the share of samples in A weighs them.
class BlendedNeighbours {
 public:
  BlendedNeighbours(const Target& target, const measure::Frame& frame, const measure::SampleSet& samples)
      : target_(target),
        frame_(frame),
        all_(frame, samples.all),
        inside_(frame, samples.inside),
        space_ball_(frame, space_points),
        target_ball_(frame, target_points),
        k_all_(std::min(neighbours, all_.size())),
        k_inside_(std::min(neighbours, inside_.size())),
        // Atoms raise N, and with it lower the density of the rest, but do not make the in-tube term any better.
        share_(static_cast<double>(inside_.size()) / static_cast<double>(std::max<std::size_t>(all_.size(), 1))),
        log_mass_all_(k_all_ > 0 ? digamma(k_all_) - digamma(samples.total + 1) : 0.0),
        log_mass_inside_(k_inside_ > 0 ? digamma(k_inside_) - digamma(samples.total + 1) : 0.0),
        least_radius_(1e-9 * target.space().diameter()) {
    // With few samples in A the balls are wide and hold a good part of the pool. 64 points a ball make 20 points of the
    // pool to a sample, and add no more than a twentieth to the variance; the whole pool would cost many times that.
    const std::size_t wanted = std::max<std::size_t>(least_pool, pool_expected * inside_.size() / neighbours);
    if (2 * wanted < target.pool().size()) {
      part_size_ = wanted;
      part_ = std::make_unique<measure::PointTree>(frame, pool_rows(target, frame, wanted));
    }
  }

  [[nodiscard]] bool censored() const { return inside_.size() == 0; }
  [[nodiscard]] const measure::PointTree& all() const { return all_; }

  /// log q at the i-th point of the pool, at y in metric coordinates.
  /// \param nearest  receives the squared distance to the nearest sample
  [[nodiscard]] double log_density(std::size_t i, View y, double& nearest) const {
    std::array<double, neighbours> squared{};
    all_.nearest(y, std::span(squared).first(k_all_));
    nearest = squared[0];
    const double r = std::max(std::sqrt(squared[k_all_ - 1]), least_radius_);
    const double plain = log_mass_all_ - space_ball_.log_volume(y, r);
    inside_.nearest(y, std::span(squared).first(k_inside_));
    const double in_tube = log_mass_inside_ - log_volume_in_target(i, y, squared[k_inside_ - 1]);
    return share_ * in_tube + (1.0 - share_) * plain;
  }

 private:
  /// log of the volume of the part of a ball around the i-th point of the pool that lies in A.
  [[nodiscard]] double log_volume_in_target(std::size_t i, View y, double squared) const {
    // The mean of psi(1 + m) over Poisson counts m of the other points is the log of their mean, so the centre, a
    // point of the pool itself, is counted once.
    const auto by_pool = [&](std::size_t with_centre, std::size_t pool) {
      return target_.log_volume() + digamma(with_centre) - std::log(static_cast<double>(pool));
    };
    if (part_) {
      const std::size_t self = i < part_size_ ? 0 : 1;
      const std::size_t m = part_->count_within(y, squared) + self;
      if (m >= pool_enough) return by_pool(m, part_size_ + self);
    }
    const std::size_t m = target_.pool_tree().count_within(y, squared);
    if (m < pool_enough) {
      std::vector<double> x(frame_.dimension());
      const double r = std::max(std::sqrt(squared), least_radius_);
      const double by_points = target_ball_.log_volume(y, r, [&](View at) {
        frame_.to_raw(at, x);
        return target_.contains(x);
      });
      if (std::isfinite(by_points)) return by_points;
    }
    return by_pool(std::max<std::size_t>(m, 1), target_.pool_tree().size());
  }

  const Target& target_;
  const measure::Frame& frame_;
  measure::PointTree all_;
  measure::PointTree inside_;
  measure::CutBall space_ball_;
  measure::CutBall target_ball_;
  std::size_t k_all_;
  std::size_t k_inside_;
  double share_;
  double log_mass_all_;
  double log_mass_inside_;
  double least_radius_;
  std::size_t part_size_ = 0;
  std::unique_ptr<measure::PointTree> part_;  // a prefix of the pool; null where the whole pool is wanted
};

/// The figures that follow from log q at the evaluation points, whichever estimator gave it.
void score(const Target& target, std::span<const double> log_density, Efficiency& result) {
  const double epsilon = target.settings().epsilon;
  const double log_uniform = std::log(epsilon) - target.space().log_volume();
  double plain = 0.0;
  double defended = 0.0;
  for (const double log_q : log_density) {
    plain += log_q;
    const double log_guided = std::log1p(-epsilon) + log_q;
    const double larger = std::max(log_guided, log_uniform);
    defended += larger + std::log1p(std::exp(std::min(log_guided, log_uniform) - larger));
  }
  const auto count = static_cast<double>(log_density.size());
  result.undefended = -target.log_volume() - plain / count;
  result.value = -target.log_volume() - defended / count;
  result.gain = result.uniform - result.value;
}

}  // namespace

Efficiency efficiency(const Target& target, const Configurations& samples, Held held) {
  const measure::Frame frame(target.space());
  const std::size_t d = frame.dimension();
  Efficiency result;
  result.samples = samples.size();
  if (target.empty()) {
    result.flags.emplace_back("empty target");
    return result;
  }
  result.uniform = target.uniform();
  const measure::SampleSet set = measure::prepare(target, frame, samples);
  result.in_target = set.in_target;
  const auto total = static_cast<double>(set.total);
  if (total * std::exp(-result.uniform) < expected_hits) result.flags.emplace_back("underpowered");
  if (set.all.size() / d < neighbours) result.flags.emplace_back("too few samples");
  if (set.total == 0) return result;

  const std::size_t count = target.evaluation_points();
  const std::vector<double> points = pool_rows(target, frame, count);
  const auto point = [&](std::size_t i) { return View(points).subspan(i * d, d); };

  const BlendedNeighbours density(target, frame, set);
  const measure::PointTree atoms(frame, set.atoms);
  const double delta = target.settings().delta;
  const measure::CutBall ball(frame, space_points);
  std::vector<double> log_density(count);
  std::size_t covered = 0;
  double uniformly_covered = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const View y = point(i);
    double nearest = 0.0;
    if (density.censored()) {
      density.all().nearest(y, {&nearest, 1});
      log_density[i] = std::log(0.5 / (total + 1.0)) - target.log_volume();
    } else {
      log_density[i] = density.log_density(i, y, nearest);
    }
    if (nearest <= delta * delta || atoms.any_within(y, delta * delta)) ++covered;
    const double hit = std::min(1.0, std::exp(ball.log_volume(y, delta) - target.space().log_volume()));
    uniformly_covered -= std::expm1(total * std::log1p(-hit));
  }
  if (held == Held::valid_only && target.settings().support == "all") {
    bool reaches = true;
    for (std::size_t i = 0; i < count; ++i) {
      if (target.valid(target.pool()[i])) continue;
      log_density[i] = -std::numeric_limits<double>::infinity();
      reaches = false;
    }
    if (!reaches) result.flags.emplace_back("cannot reach");
  }
  score(target, log_density, result);
  if (density.censored()) {
    result.undefended = std::numeric_limits<double>::infinity();
    result.flags.emplace_back("censored");
  }
  result.coverage = static_cast<double>(covered) / static_cast<double>(count);
  result.uniform_coverage = uniformly_covered / static_cast<double>(count);
  // The coverage is a multiple of 1 / count; a difference below half of that says nothing.
  if (result.coverage + 0.5 / static_cast<double>(count) < result.uniform_coverage) {
    result.flags.emplace_back("partial");
  }
  return result;
}

}  // namespace trellis
