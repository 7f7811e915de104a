// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <trellis/base/clones.hpp>
#include <trellis/base/polling.hpp>
#include <trellis/measure/evaluation.hpp>

namespace trellis::measure {

namespace {

constexpr double negligible = 23.0;              // e^-23 = 1e-10 of a sum is negligible
constexpr double negligible_choice = 14.0;       // the same, e^-14 = 1e-6, to compare bandwidths
constexpr double faintest = 60.0;                // e^-60 of the largest term replaces all smaller ones
constexpr std::size_t likelihood_samples = 500;  // of the leave-one-out likelihood
constexpr int likelihood_steps = 24;             // bandwidths, from twice Scott's down to a 64th of it
constexpr int likelihood_stride = 3;

struct KdeSettings {
  double bandwidth = 0.0;
  bool scott = false;
};

const Settings<KdeSettings>& kde_settings() {
  static const Settings<KdeSettings> settings =
      Settings<KdeSettings>(Component::Kind::estimator, "kde",
                            "Gaussian kernels, reflected at walls and wrapped on periodic axes", "Parzen 1962")
          .number("bandwidth", &KdeSettings::bandwidth, "m in the metric", Range::non_negative(),
                  "standard deviation of a kernel, the same for all axes; 0: by the rule")
          .choice("rule", &KdeSettings::scott, {{"likelihood", false}, {"scott", true}},
                  "likelihood: the bandwidth with the largest leave-one-out likelihood; scott: Scott's rule")
          .positional({"bandwidth"});
  return settings;
}

constexpr std::size_t block = PointTree::block;
using Block = std::array<double, block>;

/// Computes exp of numbers in [-faintest, 0], to within 1e-12; clamps others to that interval.
TRELLIS_ALONG void exp_block(Block& x) {
  constexpr double magic = 0x1.8p52;  // moves the nearest integer into the last bits
  // Separate loops and no std::min, so that the compiler vectorises them.
  for (std::size_t i = 0; i < block; ++i) x[i] = x[i] < -faintest ? -faintest : x[i];
  for (std::size_t i = 0; i < block; ++i) x[i] = x[i] > 0.0 ? 0.0 : x[i];
  for (std::size_t i = 0; i < block; ++i) {
    const double y = x[i];
    const double shifted = y * std::numbers::log2e + magic;
    const double r = y - (shifted - magic) * std::numbers::ln2;
    double sum = 1.0 / 3628800.0;
    sum = sum * r + 1.0 / 362880.0;
    sum = sum * r + 1.0 / 40320.0;
    sum = sum * r + 1.0 / 5040.0;
    sum = sum * r + 1.0 / 720.0;
    sum = sum * r + 1.0 / 120.0;
    sum = sum * r + 1.0 / 24.0;
    sum = sum * r + 1.0 / 6.0;
    sum = sum * r + 0.5;
    sum = sum * r + 1.0;
    sum = sum * r + 1.0;
    x[i] = std::bit_cast<double>(std::bit_cast<std::uint64_t>(sum) + (std::bit_cast<std::uint64_t>(shifted) << 52U));
  }
}

/// A kernel along one axis.
struct AxisKernel {
  bool periodic = false;
  double period = 0.0;   ///< of the images
  double lo = 0.0;       ///< the lower bound
  double inverse = 0.0;  ///< 1 / 2h^2
  int turns = 0;         ///< number of periods at which an image may still count
};

/// Computes the factor of the images of a leaf's kernels along one axis: 1 + the sum of exp(-(v^2 - u^2) / 2h^2), with
/// u the distance from the kernel's own point and v from an image, which is never nearer. The difference of squares is
/// a product in every case. The leaf's box, from lo to hi, decides which images count for any of its points.
/// The caller passes |u|.
/// \param limit  the exponent beyond which an image is negligible
TRELLIS_ALONG void add_images(const AxisKernel& axis, double y, const double* points, double lo, double hi,
                              const Block& offset, double limit, Block& factor) {
  Block images{};
  bool any = false;
  const double period = axis.period;
  const auto counts = [&](double least) { return least * axis.inverse < limit; };
  const auto add = [&](Block& exponent) {
    for (std::size_t i = 0; i < block; ++i) exponent[i] *= -axis.inverse;
    exp_block(exponent);
    for (std::size_t i = 0; i < block; ++i) images[i] += exponent[i];
    any = true;
  };
  if (axis.periodic) {
    const double widest = std::min(0.5 * period, std::max(std::abs(lo - y), std::abs(hi - y)));
    for (int turn = 1; turn <= axis.turns; ++turn) {
      const double away = turn * period;
      if (!counts(away * (away - 2.0 * widest))) break;
      Block exponent;
      for (std::size_t i = 0; i < block; ++i) exponent[i] = away * (away - 2.0 * offset[i]);
      add(exponent);
      if (!counts(away * away)) continue;
      for (std::size_t i = 0; i < block; ++i) exponent[i] = away * (away + 2.0 * offset[i]);
      add(exponent);
    }
  } else {
    // Reflections: at the lower bound (turn 0), at the upper bound (turn -1), and repeated ones.
    for (int turn = -axis.turns; turn <= axis.turns; ++turn) {
      const double away = turn * period;
      const double twice = 2.0 * (y - axis.lo) + away;
      const auto mirrored = [&](double s) { return twice * (2.0 * (s - axis.lo) + away); };
      if (counts(std::min(mirrored(lo), mirrored(hi)))) {
        Block exponent;
        for (std::size_t i = 0; i < block; ++i) exponent[i] = mirrored(points[i]);
        add(exponent);
      }
      const auto repeated = [&](double s) { return away * (away + 2.0 * (y - s)); };
      if (turn != 0 && counts(std::min(repeated(lo), repeated(hi)))) {
        Block exponent;
        for (std::size_t i = 0; i < block; ++i) exponent[i] = repeated(points[i]);
        add(exponent);
      }
    }
  }
  if (!any) return;
  for (std::size_t i = 0; i < block; ++i) factor[i] *= 1.0 + images[i];
}

/// One kernel of a leaf that the sum omits.
struct LeftOut {
  std::size_t leaf = std::numeric_limits<std::size_t>::max();
  std::size_t place = 0;
};

/// Sums the kernels about the points of some leaves, at y, in units of exp(-unit): no kernel is larger than that.
/// \param limits  for each leaf the exponent beyond which its images are negligible
TRELLIS_CLONES double sum_of(const std::vector<AxisKernel>& axes, const std::vector<PointTree::Leaf>& leaves,
                             const std::vector<double>& limits, const double* y, double unit, LeftOut out) {
  Block total{};
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    const PointTree::Leaf& leaf = leaves[l];
    Block exponent;
    exponent.fill(unit);
    Block factor;
    factor.fill(1.0);
    for (std::size_t j = 0; j < axes.size(); ++j) {
      const AxisKernel& axis = axes[j];
      const double* points = leaf.points + j * block;
      const double at = y[j];
      const double wrap = axis.periodic ? axis.period : std::numeric_limits<double>::infinity();
      Block offset;
      for (std::size_t i = 0; i < block; ++i) {
        const double u = std::abs(points[i] - at);
        const double v = wrap - u;
        const double w = v < u ? v : u;
        offset[i] = w;
        exponent[i] -= w * w * axis.inverse;
      }
      add_images(axis, at, points, leaf.box[2 * j], leaf.box[2 * j + 1], offset, limits[l], factor);
    }
    if (l == out.leaf) exponent[out.place] = -faintest;
    exp_block(exponent);
    for (std::size_t i = 0; i < block; ++i) total[i] += exponent[i] * factor[i];
  }
  double sum = 0.0;
  for (const double t : total) sum += t;
  return sum;
}

/// Gaussian kernels of one bandwidth about the points of a tree.
class Kernels {
 public:
  /// \param ignored  exp(-ignored) of a sum is negligible
  Kernels(const Frame& frame, std::size_t points, double bandwidth, double ignored)
      : ignored_(ignored),
        spread_(2.0 * bandwidth * bandwidth),
        // A kernel truncated to the period of its axis is lower by an eighth per axis at most.
        beyond_(spread_ *
                (std::log(static_cast<double>(points)) + ignored + 0.125 * static_cast<double>(frame.dimension()))) {
    axes_.reserve(frame.dimension());
    for (std::size_t j = 0; j < frame.dimension(); ++j) {
      AxisKernel axis;
      axis.periodic = frame.periodic(j);
      axis.period = axis.periodic ? frame.period(j) : 2.0 * frame.extent(j);
      axis.lo = frame.lo(j);
      // A kernel as wide as the period is uniform over it; a wider one does not differ.
      const double h = std::min(bandwidth, axis.period);
      axis.inverse = 0.5 / (h * h);
      axis.turns = 1 + static_cast<int>(std::sqrt(ignored / axis.inverse) / axis.period);
      log_norm_ -= std::log(h * std::sqrt(2.0 * std::numbers::pi));
      axes_.push_back(axis);
    }
  }

  /// Returns the squared distance at which kernels are negligible, where the nearest point is at `nearest`.
  [[nodiscard]] double horizon(double nearest) const { return nearest + beyond_; }

  /// Returns the log of the sum of the kernels about the points of some leaves, the nearest of them at a squared
  /// distance of `nearest` from y.
  [[nodiscard]] double log_sum(View y, double nearest, const std::vector<PointTree::Leaf>& leaves, LeftOut out = {}) {
    const double unit = nearest / spread_;
    limits_.clear();
    for (const PointTree::Leaf& leaf : leaves) {
      limits_.push_back(std::min(ignored_, (horizon(nearest) - leaf.least) / spread_));
    }
    return log_norm_ - unit + std::log(sum_of(axes_, leaves, limits_, y.data(), unit, out));
  }

 private:
  double ignored_;
  double spread_;
  double beyond_;
  double log_norm_ = 0.0;
  std::vector<AxisKernel> axes_;
  std::vector<double> limits_;  // scratch
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
      // The mean direction: it does not depend on where the period begins.
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

/// Returns the squared distance from y to the nearest point of a leaf, omitting one point; infinite where there is no
/// other.
double nearest_of(const Frame& frame, const PointTree::Leaf& leaf, const double* y, std::size_t without) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < leaf.count; ++i) {
    if (i == without) continue;
    double square = 0.0;
    for (std::size_t j = 0; j < frame.dimension(); ++j) {
      const double u = frame.shortest(j, leaf.points[j * block + i] - y[j]);
      square += u * u;
    }
    nearest = std::min(nearest, square);
  }
  return nearest;
}

double most_likely(const Frame& frame, const std::vector<double>& rows) {
  const std::size_t d = frame.dimension();
  const std::size_t n = rows.size() / d;
  // Takes every n-th of all rows. Rows are sorted by their coordinates, so this thins them evenly. Scott's exponent
  // converts the bandwidth for m samples to n samples.
  const std::size_t stride = (n + likelihood_samples - 1) / likelihood_samples;
  std::vector<double> few;
  for (std::size_t i = 0; i < n; i += stride) {
    few.insert(few.end(), rows.begin() + static_cast<std::ptrdiff_t>(i * d),
               rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * d));
  }
  const PointTree tree(frame, few);
  const std::size_t m = tree.size();
  std::vector<PointTree::Leaf> leaves;
  tree.leaves_within(View(few).first(d), std::numeric_limits<double>::infinity(), leaves);
  std::vector<double> points;  // in the order of the leaves
  points.reserve(few.size());
  std::vector<LeftOut> places;
  places.reserve(m);
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    for (std::size_t i = 0; i < leaves[l].count; ++i) {
      for (std::size_t j = 0; j < d; ++j) points.push_back(leaves[l].points[j * block + i]);
      places.push_back({l, i});
    }
  }
  // From each point to each leaf, and to the nearest other point.
  std::vector<double> to_leaf(m * leaves.size());
  std::vector<double> to_other(m, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < m; ++i) {
    poll();
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      const double nearest =
          nearest_of(frame, leaves[l], &points[i * d], l == places[i].leaf ? places[i].place : block);
      to_leaf[i * leaves.size() + l] = nearest;
      to_other[i] = std::min(to_other[i], nearest);
    }
  }
  const double largest = 2.0 * scott(frame, few);
  const auto bandwidth = [&](int step) { return largest * std::pow(2.0, -7.0 * step / (likelihood_steps - 1)); };
  std::vector<PointTree::Leaf> near;
  near.reserve(leaves.size());
  int best = 0;
  double best_likelihood = -std::numeric_limits<double>::infinity();
  const auto offer = [&](int step) {
    Kernels kernels(frame, m, bandwidth(step), negligible_choice);
    double likelihood = 0.0;
    for (std::size_t i = 0; i < m; ++i) {
      poll();
      near.clear();
      LeftOut out;
      for (std::size_t l = 0; l < leaves.size(); ++l) {
        if (to_leaf[i * leaves.size() + l] > kernels.horizon(to_other[i])) continue;
        if (l == places[i].leaf) out = {near.size(), places[i].place};
        near.push_back(leaves[l]);
        near.back().least = to_leaf[i * leaves.size() + l];
      }
      likelihood += kernels.log_sum(View(points).subspan(i * d, d), to_other[i], near, out);
    }
    if (likelihood > best_likelihood) {
      best_likelihood = likelihood;
      best = step;
    }
  };
  // The likelihood is unimodal: the best step lies within a stride of the best coarse step.
  for (int step = 0; step < likelihood_steps; step += likelihood_stride) offer(step);
  const int middle = best;
  for (int step = std::max(0, middle - likelihood_stride + 1);
       step < std::min(likelihood_steps, middle + likelihood_stride); ++step) {
    if (step != middle) offer(step);
  }
  return bandwidth(best) *
         std::pow(static_cast<double>(n) / static_cast<double>(m), -1.0 / (static_cast<double>(d) + 4.0));
}

Estimate estimate(const Options& options, const Evaluation& evaluation) {
  const KdeSettings settings = kde_settings().read(options);
  const auto& rows = evaluation.samples.all();
  const auto chosen = [&] {
    return settings.scott ? scott(evaluation.frame(), rows) : most_likely(evaluation.frame(), rows);
  };
  const double h = settings.bandwidth > 0.0
                       ? settings.bandwidth
                       : evaluation.samples.remembered(settings.scott ? "kde scott" : "kde likelihood", chosen);
  Kernels kernels(evaluation.frame(), evaluation.samples.tree().size(), h, negligible);
  std::vector<PointTree::Leaf> leaves;
  const double log_total = std::log(static_cast<double>(evaluation.samples.total()));
  const std::size_t points =
      evaluation.kernel_points > 0 ? std::min(evaluation.points, evaluation.kernel_points) : evaluation.points;
  std::vector<double> log_density(points);
  double mass = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    poll();
    const double nearest = evaluation.neighbours[i * Evaluation::neighbour_count];
    evaluation.samples.tree().leaves_within(evaluation.at(i), kernels.horizon(nearest), leaves);
    log_density[i] = kernels.log_sum(evaluation.at(i), nearest, leaves) - log_total;
    mass += std::exp(log_density[i] - evaluation.target.log_density(i));
  }
  return estimate_from(evaluation, log_density, std::min(1.0, mass / static_cast<double>(points)));
}

std::string unfit(const Options&, const Evaluation& evaluation) {
  return evaluation.samples.tree().size() >= 2 ? "" : "too few samples: a bandwidth needs two that occur once";
}

}  // namespace

EstimatorKind kde_kind() { return {&kde_settings().component(), unfit, estimate}; }

}  // namespace trellis::measure
