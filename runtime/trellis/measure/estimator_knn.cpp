// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/special_functions/digamma.hpp>
#include <cmath>

#include <trellis/base/polling.hpp>
#include <trellis/measure/cut_ball.hpp>
#include <trellis/measure/evaluation.hpp>

namespace trellis::measure {

namespace {

constexpr std::size_t space_points = 256;  // of a ball, for its share in C
constexpr std::size_t target_points = 32;  // of a ball, for its share in A: each costs a validity check
constexpr double pool_enough = 30.0;       // pool points in a ball that determine its volume in A
constexpr std::size_t pool_expected = 40;  // target number of pool points in a ball, for a large pool

struct KnnSettings {
  std::int64_t k = 3;
  std::int64_t k_all = 8;
  bool blend = true;
  bool boundary = true;
};

const Settings<KnnSettings>& knn_settings() {
  static const Settings<KnnSettings> settings =
      Settings<KnnSettings>(Component::Kind::estimator, "knn",
                            "k nearest neighbours among all samples and among those in the target, blended",
                            "Kozachenko and Leonenko 1987; Singh et al. 2003")
          .integer("k", &KnnSettings::k, "neighbours", {.lo = 1, .hi = 1000},
                   "the neighbour among the samples in the target whose distance counts; few keep the target's border "
                   "sharp")
          .integer("k_all", &KnnSettings::k_all, "neighbours", {.lo = 1, .hi = 1000},
                   "the same among all samples, or as many as there are; more of them vary less")
          .boolean("blend", &KnnSettings::blend,
                   "whether the density among the samples in the target is blended in; false: all samples only")
          .boolean("boundary", &KnnSettings::boundary,
                   "whether balls are cut to the space; false: their whole volume, as textbooks have it")
          .positional({"k"});
  return settings;
}

double digamma(std::size_t n) { return boost::math::digamma(static_cast<double>(n)); }

/// log q at points of A by blended k nearest neighbours.
///
/// The plain term uses all samples and ignores the boundary of A; the in-tube term uses the samples in A only, and the
/// part of its ball in A. Each is accurate where the other is not, and the share of samples in A weighs them.
class BlendedNeighbours {
 public:
  BlendedNeighbours(const KnnSettings& settings, const Evaluation& evaluation)
      : evaluation_(evaluation),
        target_(evaluation.target),
        inside_(evaluation.frame().rows(), evaluation.in_target.inside),
        space_ball_(evaluation.frame(), space_points),
        target_ball_(evaluation.frame(), target_points),
        degrees_(evaluation.frame().degrees()),
        boundary_(settings.boundary),
        k_all_(std::min(static_cast<std::size_t>(settings.k_all), evaluation.samples.tree().size())),
        k_inside_(settings.blend ? std::min(static_cast<std::size_t>(settings.k), inside_.size()) : 0),
        // Atoms raise N, and so lower the density of the other samples, but do not improve the in-tube term.
        share_(k_inside_ == 0
                   ? 0.0
                   : static_cast<double>(inside_.size()) / static_cast<double>(evaluation.samples.tree().size())),
        log_mass_all_(digamma(k_all_) - digamma(evaluation.samples.total() + 1)),
        log_mass_inside_(k_inside_ > 0 ? digamma(k_inside_) - digamma(evaluation.samples.total() + 1) : 0.0),
        least_radius_(1e-9 * target_.space().diameter()),
        squared_(std::max(k_all_, k_inside_)) {
    // With few samples in A the balls are wide and contain much of the pool. 40 pool points per ball correspond to 13
    // pool points per sample and add no measurable error; the whole pool would cost a multiple.
    if (k_inside_ > 0 && target_.is_uniform()) {
      part_ = &target_.pool_tree(pool_expected * inside_.size() / k_inside_);
    }
  }

  /// Returns log q at the i-th evaluation point.
  [[nodiscard]] double log_density(std::size_t i) {
    const View y = evaluation_.at(i);
    double kth = 0.0;
    if (k_all_ <= Evaluation::neighbour_count) {
      kth = evaluation_.neighbours[i * Evaluation::neighbour_count + k_all_ - 1];
    } else {
      evaluation_.samples.tree().nearest_distances(y, std::span(squared_).first(k_all_));
      kth = squared_[k_all_ - 1];
    }
    const double r = std::max(std::sqrt(kth), least_radius_);
    const double volume = boundary_ ? space_ball_.log_volume(y, r)
                                    : log_unit_ball(degrees_) + static_cast<double>(degrees_) * std::log(r);
    const double plain = log_mass_all_ - volume;
    if (k_inside_ == 0) return plain;
    inside_.nearest_distances(y, std::span(squared_).first(k_inside_));
    const double in_tube = log_mass_inside_ - log_volume_in_target(i, y, squared_[k_inside_ - 1]);
    return share_ * in_tube + (1.0 - share_) * plain;
  }

 private:
  /// Returns the log of the volume of the part in A of a ball around the i-th point of the pool.
  [[nodiscard]] double log_volume_in_target(std::size_t i, View y, double squared) const {
    if (!target_.is_uniform()) return by_draws(y, squared);
    // Points of low discrepancy repel each other: a ball about one of them contains, with its centre, as many as its
    // volume predicts, and their number varies little. (With independent points it would contain one more, and psi
    // would be correct.)
    const auto by_pool = [&](std::size_t with_centre, std::size_t pool) {
      return target_.log_volume() + std::log(static_cast<double>(with_centre) / static_cast<double>(pool));
    };
    // The choice of the method depends on the ball only; a choice by the number of points in it would bias that number.
    const double r = std::max(std::sqrt(squared), least_radius_);
    const double ball = std::exp(log_unit_ball(degrees_) + static_cast<double>(degrees_) * std::log(r) -
                                 target_.log_volume());  // in volumes of A
    if (ball * static_cast<double>(part_->size()) >= pool_enough) {
      const std::size_t self = i < part_->size() ? 0 : 1;
      return by_pool(part_->count_within(y, squared) + self, part_->size() + self);
    }
    if (ball * static_cast<double>(target_.pool().size()) < pool_enough) {
      std::vector<double> x(y.size());
      const double by_points = target_ball_.log_volume(y, r, [&](View at) {
        evaluation_.frame().to_raw(at, x);
        return target_.contains(x);
      });
      if (std::isfinite(by_points)) return by_points;
    }
    const std::size_t pool = target_.pool().size();
    return by_pool(std::max<std::size_t>(target_.pool_tree(pool).count_within(y, squared), 1), pool);
  }

  /// The same for a target that is a distribution with its own support: uses fixed points of the ball.
  [[nodiscard]] double by_draws(View y, double squared) const {
    std::vector<double> x(y.size());
    const double r = std::max(std::sqrt(squared), least_radius_);
    const double volume = target_ball_.log_volume(y, r, [&](View at) {
      evaluation_.frame().to_raw(at, x);
      return target_.contains(x);
    });
    return std::isfinite(volume) ? volume : space_ball_.log_volume(y, r);
  }

  const Evaluation& evaluation_;
  const Target& target_;
  NearestIndex inside_;
  CutBall space_ball_;
  CutBall target_ball_;
  std::size_t degrees_;
  bool boundary_;
  std::size_t k_all_;
  std::size_t k_inside_;
  double share_;
  double log_mass_all_;
  double log_mass_inside_;
  double least_radius_;
  std::vector<double> squared_;         // scratch
  const NearestIndex* part_ = nullptr;  // of the pool, for wide balls
};

Estimate estimate(const Options& options, const Evaluation& evaluation) {
  const std::vector<double>& inside = evaluation.in_target.inside;
  const KnnSettings settings = knn_settings().read(options);
  std::vector<double> log_density(evaluation.points);
  if (inside.empty()) {
    // Half a sample, uniform over A: compatible with N samples without a hit.
    for (std::size_t i = 0; i < evaluation.points; ++i) {
      log_density[i] = evaluation.target.log_density(i) - mass_without_hit(evaluation.samples.total());
    }
    Estimate result = estimate_from(evaluation, log_density);
    result.unregularised = std::numeric_limits<double>::infinity();
    return result;
  }
  BlendedNeighbours density(settings, evaluation);
  for (std::size_t i = 0; i < evaluation.points; ++i) {
    poll(i);
    log_density[i] = density.log_density(i);
  }
  return estimate_from(evaluation, log_density);
}

std::string unfit(const Options& options, const Evaluation& evaluation) {
  const PreparedSamples& samples = evaluation.samples;
  const auto k = static_cast<std::size_t>(knn_settings().read(options).k);
  const std::size_t distinct = samples.tree().size();
  if (distinct >= k) return "";
  if (samples.total() >= k && distinct == 0 && !samples.atoms().empty()) {
    return "all samples occur more than once: they have no density";
  }
  return fmt::format("too few samples: {} that occur once, k = {} are needed", distinct, k);
}

}  // namespace

EstimatorKind knn_kind() { return {&knn_settings().component(), unfit, estimate}; }

}  // namespace trellis::measure
