// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <trellis/measure/estimator.hpp>

namespace trellis::measure {

namespace {

constexpr double reach = 8.0;                    // bandwidths beyond which an image behind a wall counts for nothing
constexpr std::size_t likelihood_samples = 500;  // that the leave-one-out likelihood is taken over
constexpr int likelihood_steps = 24;             // bandwidths tried, from twice Scott's down to a 64th of it

struct KdeSettings {
  double bandwidth = 0.0;
  std::string rule = "likelihood";
};

const Settings<KdeSettings>& kde_settings() {
  static const Settings<KdeSettings> settings =
      Settings<KdeSettings>(Component::Kind::estimator, "kde",
                            "Gaussian kernels, reflected at walls and wrapped on periodic axes", "Parzen 1962")
          .number("bandwidth", &KdeSettings::bandwidth, "m in the metric", Range::non_negative(),
                  "standard deviation of a kernel, the same for all axes; 0: by the rule")
          .choice("rule", &KdeSettings::rule, {"likelihood", "scott"},
                  "likelihood: the bandwidth with the largest leave-one-out likelihood; scott: Scott's rule")
          .positional({"bandwidth"});
  return settings;
}

/// A sum of terms given by their logs, of any size.
class LogSum {
 public:
  void add(double log_term) {
    if (log_term > largest_) {
      sum_ = sum_ * std::exp(largest_ - log_term) + 1.0;
      largest_ = log_term;
    } else {
      sum_ += std::exp(log_term - largest_);
    }
  }
  [[nodiscard]] double value() const { return largest_ + std::log(sum_); }

 private:
  double largest_ = -std::numeric_limits<double>::infinity();
  double sum_ = 0.0;
};

class Kernels {
 public:
  Kernels(const Frame& frame, std::span<const double> rows, double bandwidth) : frame_(frame), rows_(rows) {
    for (std::size_t j = 0; j < frame.dimension(); ++j) {
      Images at;
      at.period = frame.periodic(j) ? frame.period(j) : 2.0 * frame.extent(j);
      // A kernel as wide as the period is uniform over it, and a wider one no different.
      at.h = std::min(bandwidth, at.period);
      if (reach * at.h > 0.5 * at.period) at.turns = static_cast<int>(std::ceil(reach * at.h / at.period));
      log_norm_ -= std::log(at.h * std::sqrt(2.0 * std::numbers::pi));
      images_.push_back(std::move(at));
    }
  }

  /// The log of the sum of all kernels but one at y; `without` beyond the last: of all.
  [[nodiscard]] double log_sum(View y, std::size_t without) {
    const std::size_t d = frame_.dimension();
    LogSum sum;
    for (std::size_t i = 0; i * d < rows_.size(); ++i) {
      if (i == without) continue;
      double log_kernel = 0.0;
      for (std::size_t j = 0; j < d; ++j) {
        Images& at = images_[j];
        const double s = rows_[i * d + j];
        const double u = frame_.shortest(j, y[j] - s);
        at.logs.clear();
        const auto offer = [&](double v) {
          if (std::abs(v) < reach * at.h) at.logs.push_back(-0.5 * v * v / (at.h * at.h));
        };
        for (int turn = 1; turn <= at.turns; ++turn) {
          offer(u + turn * at.period);
          offer(u - turn * at.period);
        }
        if (!frame_.periodic(j)) {
          const double mirrored = y[j] + s - 2.0 * frame_.lo(j);
          for (int turn = 0; turn <= at.turns; ++turn) {
            offer(mirrored + turn * at.period);
            offer(mirrored - (turn + 1) * at.period);
          }
        }
        const double nearest = -0.5 * u * u / (at.h * at.h);
        if (at.logs.empty()) {
          log_kernel += nearest;
          continue;
        }
        LogSum axis;
        axis.add(nearest);
        for (const double log_image : at.logs) axis.add(log_image);
        log_kernel += axis.value();
      }
      sum.add(log_kernel);
    }
    return log_norm_ + sum.value();
  }

 private:
  /// The images of one axis: across the wrap, or in the mirrors that two walls make, which repeat.
  struct Images {
    double period = 0.0;
    double h = 0.0;
    int turns = 0;             ///< periods away at which an image may still count
    std::vector<double> logs;  ///< of a kernel's further images at a point, as far as they count
  };
  const Frame& frame_;
  std::span<const double> rows_;
  double log_norm_ = 0.0;
  std::vector<Images> images_;
};

double scott(const Frame& frame, const std::vector<double>& rows) {
  const std::size_t d = frame.dimension();
  const std::size_t n = rows.size() / d;
  double variance = 0.0;
  for (std::size_t j = 0; j < d; ++j) {
    const auto total = [&](const auto& term) {
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) sum += term(rows[i * d + j]);
      return sum;
    };
    double mean = 0.0;
    if (frame.periodic(j)) {
      // The mean direction: where the period begins does not matter.
      const double turn = 2.0 * std::numbers::pi / frame.period(j);
      mean = std::atan2(total([&](double y) { return std::sin(turn * y); }),
                        total([&](double y) { return std::cos(turn * y); })) /
             turn;
    } else {
      mean = total([](double y) { return y; }) / static_cast<double>(n);
    }
    const double squares = total([&](double y) {
      const double u = frame.shortest(j, y - mean);
      return u * u;
    });
    variance += squares / static_cast<double>(n - 1);
  }
  const double sd = std::sqrt(variance / static_cast<double>(d));
  return std::max(sd, 1e-9) * std::pow(static_cast<double>(n), -1.0 / (static_cast<double>(d) + 4.0));
}

double most_likely(const Frame& frame, const std::vector<double>& rows) {
  const std::size_t d = frame.dimension();
  const std::size_t n = rows.size() / d;
  // Every n-th of all rows: they are in the order of their coordinates, so this thins them evenly. The bandwidth that
  // suits m samples is brought to n by Scott's exponent.
  const std::size_t stride = (n + likelihood_samples - 1) / likelihood_samples;
  std::vector<double> few;
  for (std::size_t i = 0; i < n; i += stride) {
    few.insert(few.end(), rows.begin() + static_cast<std::ptrdiff_t>(i * d),
               rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * d));
  }
  const std::size_t m = few.size() / d;
  const double largest = 2.0 * scott(frame, few);
  double best = largest;
  double best_likelihood = -std::numeric_limits<double>::infinity();
  for (int step = 0; step < likelihood_steps; ++step) {
    const double h = largest * std::pow(2.0, -7.0 * step / (likelihood_steps - 1));
    Kernels kernels(frame, few, h);
    double likelihood = 0.0;
    for (std::size_t i = 0; i < m; ++i) likelihood += kernels.log_sum(View(few).subspan(i * d, d), i);
    if (likelihood > best_likelihood) {
      best_likelihood = likelihood;
      best = h;
    }
  }
  return best * std::pow(static_cast<double>(n) / static_cast<double>(m), -1.0 / (static_cast<double>(d) + 4.0));
}

Estimate estimate(const Options& options, const Evaluation& evaluation) {
  const KdeSettings settings = kde_settings().read(options);
  const auto& rows = evaluation.samples.all;
  const double h = settings.bandwidth > 0.0   ? settings.bandwidth
                   : settings.rule == "scott" ? scott(evaluation.frame, rows)
                                              : most_likely(evaluation.frame, rows);
  Kernels kernels(evaluation.frame, rows, h);
  const double log_total = std::log(static_cast<double>(evaluation.samples.total));
  std::vector<double> log_density(evaluation.points);
  double mass = 0.0;
  for (std::size_t i = 0; i < evaluation.points; ++i) {
    log_density[i] = kernels.log_sum(evaluation.at(i), rows.size()) - log_total;
    mass += std::exp(log_density[i] - evaluation.target.log_density(i));
  }
  return estimate_from(evaluation, log_density, std::min(1.0, mass / static_cast<double>(evaluation.points)));
}

std::string unfit(const Options&, const Evaluation& evaluation) {
  return evaluation.all.size() >= 2 ? "" : "too few samples: a bandwidth needs two that occur once";
}

}  // namespace

EstimatorKind kde_kind() { return {&kde_settings().component(), unfit, estimate}; }

}  // namespace trellis::measure
