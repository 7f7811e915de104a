// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
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
  Kernels(const Frame& frame, std::span<const double> rows, double bandwidth)
      : frame_(frame), rows_(rows), h_(bandwidth), images_(frame.dimension()) {
    log_norm_ = -static_cast<double>(frame.dimension()) * std::log(h_ * std::sqrt(2.0 * std::numbers::pi));
  }

  /// The log of the sum of all kernels but one at y; `without` beyond the last: of all.
  [[nodiscard]] double log_sum(View y, std::size_t without) {
    const std::size_t d = frame_.dimension();
    LogSum sum;
    for (std::size_t i = 0; i * d < rows_.size(); ++i) {
      if (i == without) continue;
      double square = 0.0;  // of the axes that have one image
      bool several = false;
      for (std::size_t j = 0; j < d; ++j) {
        Images& at = images_[j];
        at.count = 0;
        const double s = rows_[i * d + j];
        const double u = frame_.shortest(j, y[j] - s);
        at.squares[at.count++] = u * u;
        const auto offer = [&](double v) {
          if (std::abs(v) < reach * h_) at.squares[at.count++] = v * v;
        };
        if (frame_.periodic(j)) {
          offer(u - std::copysign(frame_.period(j), u));
        } else {
          offer(y[j] + s - 2.0 * frame_.lo(j));
          offer(y[j] + s - 2.0 * frame_.hi(j));
        }
        several = several || at.count > 1;
        if (at.count == 1) square += at.squares[0];
      }
      double log_kernel = -0.5 * square / (h_ * h_);
      if (several) {
        for (const Images& at : images_) {
          if (at.count == 1) continue;
          LogSum axis;
          for (std::size_t k = 0; k < at.count; ++k) axis.add(-0.5 * at.squares[k] / (h_ * h_));
          log_kernel += axis.value();
        }
      }
      sum.add(log_kernel);
    }
    return log_norm_ + sum.value();
  }

 private:
  struct Images {
    std::array<double, 3> squares{};
    std::size_t count = 0;
  };
  const Frame& frame_;
  std::span<const double> rows_;
  double h_;
  double log_norm_ = 0.0;
  std::vector<Images> images_;
};

double scott(const Frame& frame, const std::vector<double>& rows) {
  const std::size_t d = frame.dimension();
  const std::size_t n = rows.size() / d;
  double variance = 0.0;
  for (std::size_t j = 0; j < d; ++j) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += rows[i * d + j];
    const double mean = sum / static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i) squares += (rows[i * d + j] - mean) * (rows[i * d + j] - mean);
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
