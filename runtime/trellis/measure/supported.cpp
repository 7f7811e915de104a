// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/supported.hpp>

#include <algorithm>
#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/special_functions/digamma.hpp>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include <trellis/base/polling.hpp>
#include <trellis/base/random.hpp>

namespace trellis::measure {

namespace {

constexpr double mass_error = 0.005;       // of the lower end, by the mass in the target
constexpr double parts_error = 0.02;       // of the lower end, by the parts of the target: all features together
constexpr double upper_error = 0.0125;     // of the upper end, by the mass in the target
constexpr std::size_t most_points = 1024;  // of the target
constexpr std::size_t most_tested = 600;   // samples
constexpr std::size_t most_cells = 16;     // of a feature
constexpr std::size_t each_cell = 8;       // samples, at least
constexpr std::size_t least_half = 4;      // samples that choose the parts
constexpr std::size_t least_tested = 8;    // samples
constexpr std::size_t anchors = 4;         // points of the target, for distances to them
constexpr std::size_t least_k = 4;         // neighbours of the least smooth density
constexpr std::size_t smoother = 5;        // the ratio of the numbers of neighbours
constexpr std::size_t pool_expected = 40;  // points of the target in a ball
constexpr double contradicted = 8.0;       // the largest statistic that does not contradict a density
constexpr double atoms_each_pair = 40.0;   // samples of atoms that occurred once, for each that occurred twice
constexpr double unseen = 16.0;            // samples that a part of the target may lack unseen
constexpr double unseen_smoothed = 40.0;   // the same where the density is smoothed

using Binomial = boost::math::binomial_distribution<>;

/// The upper end of Clopper and Pearson's one-sided interval of a share.
double largest_share(std::size_t total, std::size_t count, double error) {
  if (count >= total) return 1.0;
  return Binomial::find_upper_bound_on_p(static_cast<double>(total), static_cast<double>(count), error);
}

double smallest_share(std::size_t total, std::size_t count, double error) {
  if (count == 0) return 0.0;
  return Binomial::find_lower_bound_on_p(static_cast<double>(total), static_cast<double>(count), error);
}

/// The values of a function of configurations at points of the target and at the samples in it.
struct Feature {
  std::vector<double> target;
  std::vector<double> samples;
};

class Supporter {
 public:
  explicit Supporter(const Evaluation& evaluation)
      : evaluation_(evaluation),
        target_(evaluation.target),
        d_(evaluation.frame().dimension()),
        points_(std::min(most_points, target_.pool().size())),
        total_(evaluation.samples.total()),
        once_(evaluation.in_target.inside.size() / d_),
        mixed_(defence * std::exp(-target_.uniform())),
        order_(once_) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    Stream stream(once_, "", "supported");
    for (std::size_t i = once_; i > 1; --i) std::swap(order_[i - 1], order_[stream.below(i)]);
  }

  [[nodiscard]] Supported interval() {
    add_features();
    const double hi = highest();
    const double lo = std::min(lowest(), largest());
    return {lo, std::max(lo, hi)};
  }

 private:
  [[nodiscard]] double largest() const { return -std::log(mixed_); }
  /// log of the density of T relative to that of Q in the mixture with uniform samples.
  [[nodiscard]] double loss(double relative) const { return -std::log((1.0 - defence) * relative + mixed_); }
  [[nodiscard]] View point(std::size_t i) const { return View(target_.pool_rows()).subspan(i * d_, d_); }
  /// Returns the i-th sample in the target, in a random order.
  [[nodiscard]] View sample(std::size_t i) const {
    return View(evaluation_.in_target.inside).subspan(order_[i] * d_, d_);
  }

  template <class Value>
  void add(Value value) {
    Feature feature;
    for (std::size_t i = 0; i < points_; ++i) feature.target.push_back(value(point(i)));
    for (std::size_t i = 0; i < once_; ++i) feature.samples.push_back(value(sample(i)));
    features_.push_back(std::move(feature));
  }

  /// Adds what both ends look at: arc length, distance from the path, and the axes of a flat space.
  void add_features() {
    const Frame& frame = evaluation_.frame();
    if (target_.has_path()) {
      Feature along;
      for (std::size_t i = 0; i < points_; ++i) along.target.push_back(target_.along(target_.pool()[i]));
      for (std::size_t i = 0; i < once_; ++i) along.samples.push_back(evaluation_.in_target.arcs[order_[i]]);
      features_.push_back(std::move(along));
      std::vector<double> x(d_);
      add([&](View y) {
        poll();
        frame.to_raw(y, x);
        return target_.distance(x);
      });
    }
    if (frame.flat()) {
      for (std::size_t j = 0; j < d_; ++j) add([j](View y) { return y[j]; });
    }
  }

  /// A tree of samples first .. last - 1 of the random order.
  [[nodiscard]] PointTree tree_of(std::size_t first, std::size_t last) const {
    std::vector<double> rows;
    rows.reserve((last - first) * d_);
    for (std::size_t i = first; i < last; ++i) {
      const View y = sample(i);
      rows.insert(rows.end(), y.begin(), y.end());
    }
    return {evaluation_.frame(), rows};
  }

  [[nodiscard]] static double nearest(const PointTree& tree, View y) {
    poll();
    double squared = 0.0;
    tree.nearest(y, {&squared, 1});
    return squared;
  }

  // The lower end -----------------------------------------------------------------------------------------------------

  [[nodiscard]] double lowest() const {
    const std::size_t count = evaluation_.in_target.count;
    const double most = largest_share(total_, count, mass_error);
    double lo = loss(most);
    const std::size_t half = once_ / 2;
    if (half < least_half) return lo;
    const double error = parts_error / static_cast<double>(features_.size() + 1);
    // Samples that occur more than once have no density: they count in the mass, and in no part.
    for (const Feature& feature : features_) lo = std::max(lo, by_cells(feature, half, most, error));
    const PointTree tree = tree_of(0, half);
    Feature distance;
    for (std::size_t i = 0; i < points_; ++i) distance.target.push_back(nearest(tree, point(i)));
    for (std::size_t i = 0; i < once_; ++i) {
      distance.samples.push_back(i < half ? 0.0 : nearest(tree, sample(i)));
    }
    return std::max(lo, by_distance(distance, half, most, error));
  }

  /// Cells of equal shares of T by one feature, the emptiest among the first half of the samples first.
  [[nodiscard]] double by_cells(const Feature& feature, std::size_t half, double most, double error) const {
    const std::size_t cells = std::min(most_cells, half / each_cell + 1);
    if (cells < 2) return 0.0;
    std::vector<double> sorted = feature.target;
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> limits;
    for (std::size_t j = 1; j < cells; ++j) limits.push_back(sorted[j * points_ / cells]);
    const auto cell = [&](double value) {
      return static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), value) - limits.begin());
    };
    std::vector<double> share(cells, 0.0);
    std::vector<std::size_t> chosen(cells, 0);
    std::vector<std::size_t> counted(cells, 0);
    for (const double value : feature.target) share[cell(value)] += 1.0 / static_cast<double>(points_);
    for (std::size_t i = 0; i < once_; ++i) ++(i < half ? chosen : counted)[cell(feature.samples[i])];
    std::vector<std::size_t> by(cells);
    std::iota(by.begin(), by.end(), std::size_t{0});
    std::stable_sort(by.begin(), by.end(), [&](std::size_t a, std::size_t b) { return chosen[a] < chosen[b]; });
    std::vector<double> shares;
    std::vector<std::size_t> counts;
    for (const std::size_t j : by) {
      shares.push_back(share[j]);
      counts.push_back(counted[j]);
    }
    return by_tails(shares, counts, most, error);
  }

  /// Parts by distance to the first half of the samples, the farthest first.
  [[nodiscard]] double by_distance(const Feature& feature, std::size_t half, double most, double error) const {
    constexpr std::array<double, 5> shares_within = {0.75, 0.5, 0.25, 0.125, 0.0625};
    std::vector<double> sorted = feature.target;
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> limits;  // descending
    for (const double within : shares_within) {
      limits.push_back(sorted[static_cast<std::size_t>(within * static_cast<double>(points_))]);
    }
    const auto cell = [&](double value) {
      std::size_t j = 0;
      while (j < limits.size() && value <= limits[j]) ++j;
      return j;
    };
    std::vector<double> shares(limits.size() + 1, 0.0);
    std::vector<std::size_t> counts(limits.size() + 1, 0);
    for (const double value : feature.target) shares[cell(value)] += 1.0 / static_cast<double>(points_);
    for (std::size_t i = half; i < once_; ++i) ++counts[cell(feature.samples[i])];
    return by_tails(shares, counts, most, error);
  }

  /// The least D_eps where Q has at most `most` in A, and in the first j parts of A at most what their counts allow:
  /// that of the most even Q. Its cumulative mass is the greatest convex minorant of the bounds.
  [[nodiscard]] double by_tails(const std::vector<double>& shares, const std::vector<std::size_t>& counts, double most,
                                double error) const {
    const std::size_t drawn = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
    if (drawn == 0) return 0.0;
    const double each = error / static_cast<double>(shares.size() - 1);
    std::vector<double> at = {0.0};
    std::vector<double> bound = {0.0};
    std::size_t so_far = 0;
    for (std::size_t j = 0; j < shares.size(); ++j) {
      so_far += counts[j];
      if (shares[j] == 0.0) continue;
      at.push_back(at.back() + shares[j]);
      bound.push_back(j + 1 == shares.size() ? most : most * largest_share(drawn, so_far, each));
    }
    bound.back() = most;
    std::vector<std::size_t> hull;
    for (std::size_t j = 0; j < at.size(); ++j) {
      while (hull.size() >= 2) {
        const std::size_t a = hull[hull.size() - 2];
        const std::size_t b = hull.back();
        if ((bound[b] - bound[a]) * (at[j] - at[a]) < (bound[j] - bound[a]) * (at[b] - at[a])) break;
        hull.pop_back();
      }
      hull.push_back(j);
    }
    double sum = 0.0;
    for (std::size_t h = 1; h < hull.size(); ++h) {
      const double share = at[hull[h]] - at[hull[h - 1]];
      sum += share * loss((bound[hull[h]] - bound[hull[h - 1]]) / share);
    }
    return sum;
  }

  // The upper end -----------------------------------------------------------------------------------------------------

  [[nodiscard]] double highest() {
    // Configurations that occur twice show that others, which occur once, may have no density either.
    const auto& copies = evaluation_.samples.copies();
    hidden_atoms_ = atoms_each_pair * static_cast<double>(std::count(copies.begin(), copies.end(), std::size_t{2}));
    const bool atoms = hidden_atoms_ >= static_cast<double>(once_);
    if (once_ < least_tested || atoms || !evaluation_.unreachable.empty()) return largest();
    const std::size_t tested = std::min(once_, most_tested);
    const std::size_t half = tested / 2;
    std::vector<Feature> all = features_;
    for (std::size_t a = 0; a < std::min(anchors, points_); ++a) {
      const PointTree anchor(evaluation_.frame(), point(points_ - 1 - a));
      all.push_back(distances(anchor, 0, tested));
    }
    all.push_back(distances(tree_of(0, half), half, tested));
    all.push_back(distances(tree_of(half, tested), 0, half));
    std::vector<std::vector<std::size_t>> order;
    for (Feature& feature : all) {
      feature.samples.resize(std::min(feature.samples.size(), tested));
      std::sort(feature.samples.begin(), feature.samples.end());
      auto& by = order.emplace_back(points_);
      std::iota(by.begin(), by.end(), std::size_t{0});
      std::sort(by.begin(), by.end(),
                [&](std::size_t a, std::size_t b) { return feature.target[a] < feature.target[b]; });
    }
    const PointTree tree = tree_of(0, tested);
    std::vector<double> log_density(points_, 0.0);
    for (std::size_t k = tested; k >= least_k; k /= smoother) {
      if (k < tested) smooth(tree, k, log_density);
      const Density density(log_density);
      const bool fits = [&] {
        for (std::size_t f = 0; f < all.size(); ++f) {
          poll();
          if (density.misfit(all[f].samples, all[f].target, order[f]) > contradicted) return false;
        }
        return true;
      }();
      if (fits) return divergence(log_density, density, tested, k == tested ? unseen : unseen_smoothed);
    }
    return largest();
  }

  [[nodiscard]] Feature distances(const PointTree& tree, std::size_t first, std::size_t last) const {
    Feature feature;
    for (std::size_t i = 0; i < points_; ++i) feature.target.push_back(nearest(tree, point(i)));
    for (std::size_t i = first; i < last; ++i) feature.samples.push_back(nearest(tree, sample(i)));
    return feature;
  }

  /// The density relative to T at the first points of the target, by the k nearest samples.
  void smooth(const PointTree& tree, std::size_t k, std::vector<double>& log_density) const {
    const double log_share = boost::math::digamma(static_cast<double>(k)) - std::log(static_cast<double>(tree.size()));
    const PointTree& pool = target_.pool_tree(pool_expected * tree.size() / k);
    std::vector<double> squared(k);
    for (std::size_t i = 0; i < log_density.size(); ++i) {
      poll();
      tree.nearest(point(i), squared);
      const auto inside = static_cast<double>(std::max<std::size_t>(pool.count_within(point(i), squared.back()), 1));
      log_density[i] = log_share - std::log(inside / static_cast<double>(pool.size()));
    }
  }

  /// A density relative to T, by weights of points of the target.
  struct Density {
    std::vector<double> weights;  ///< sum 1
    double effective = 0.0;       ///< as many points of equal weights determine it as well

    explicit Density(const std::vector<double>& log_density) {
      double sum = 0.0;
      double squares = 0.0;
      for (const double one : log_density) {
        weights.push_back(std::exp(one));
        sum += weights.back();
        squares += weights.back() * weights.back();
      }
      for (double& one : weights) one /= sum;
      effective = sum * sum / squares;
    }

    /// The number of samples that distinguishes as well as `samples` do from a density known at points only.
    [[nodiscard]] double compared(double samples) const { return 1.0 / (1.0 / samples + 1.0 / effective); }

    /// The largest of three statistics of the values, each on the scale of a log-likelihood ratio: that of Berk and
    /// Jones (the largest n KL(share of the samples, share of the density) below any value), the largest gap between
    /// samples, and Pearson's in 4, 8, 16 and 32 cells of equal shares.
    [[nodiscard]] double misfit(const std::vector<double>& samples, const std::vector<double>& target,
                                const std::vector<std::size_t>& order) const {
      const auto count = static_cast<double>(samples.size());
      if (samples.empty()) return 0.0;
      const double n = compared(count);
      const double least = 0.5 / effective;
      std::vector<double> shares;  // of the density below each sample
      double below = 0.0;
      std::size_t next = 0;
      for (std::size_t i = 0; i < samples.size();) {
        while (next < order.size() && target[order[next]] < samples[i]) below += weights[order[next++]];
        // Equal values (the ends of a path) are spread over their share.
        double equal = 0.0;
        while (next < order.size() && target[order[next]] == samples[i]) equal += weights[order[next++]];
        std::size_t end = i;
        while (end < samples.size() && samples[end] == samples[i]) ++end;
        const auto tied = static_cast<double>(end - i);
        for (std::size_t j = 0; j < end - i; ++j) {
          shares.push_back(below + equal * (static_cast<double>(j) + 0.5) / tied);
        }
        below += equal;
        i = end;
      }
      double worst = 0.0;
      for (std::size_t i = 0; i < shares.size(); ++i) {
        const double share = std::clamp(shares[i], least, 1.0 - least);
        const double with = static_cast<double>(i + 1) / count;
        const double without = static_cast<double>(i) / count;
        if (with > share) worst = std::max(worst, n * divergence_of(with, share));
        if (without < share) worst = std::max(worst, n * divergence_of(without, share));
      }
      double before = 0.0;
      for (std::size_t i = 0; i <= shares.size(); ++i) {
        const double after = i < shares.size() ? shares[i] : 1.0;
        const double gap = std::min(after - before, 1.0 - least) - least;
        if (gap > 0.0) worst = std::max(worst, -n * std::log1p(-gap) - std::log(count));
        before = after;
      }
      return std::max(worst, pearson(shares, n / count));
    }

    static double pearson(const std::vector<double>& shares, double scale) {
      constexpr double least_expected = 2.5;
      double worst = 0.0;
      for (std::size_t cells = 4; cells <= 32; cells *= 2) {
        const double expected = static_cast<double>(shares.size()) / static_cast<double>(cells);
        if (expected < least_expected) break;
        std::vector<double> counts(cells, 0.0);
        for (const double share : shares) {
          counts[std::min(cells - 1, static_cast<std::size_t>(share * static_cast<double>(cells)))] += 1.0;
        }
        double sum = 0.0;
        for (const double count : counts) sum += (count - expected) * (count - expected) / expected;
        const double freedom = static_cast<double>(cells - 1);
        const double normal = std::max(0.0, (scale * sum - freedom) / std::sqrt(2.0 * freedom));
        worst = std::max(worst, 0.5 * normal * normal);
      }
      return worst;
    }

    static double divergence_of(double a, double b) {
      double sum = 0.0;
      if (a > 0.0) sum += a * std::log(a / b);
      if (a < 1.0) sum += (1.0 - a) * std::log((1.0 - a) / (1.0 - b));
      return sum;
    }
  };

  /// The divergence of a density that `lacking` of the samples may be missing from, where it is lowest.
  [[nodiscard]] double divergence(const std::vector<double>& log_density, const Density& density, std::size_t tested,
                                  double lacking) const {
    const double with_density = 1.0 - hidden_atoms_ / static_cast<double>(once_);
    const double least_mass = smallest_share(total_, once_, upper_error) * with_density;
    const auto count = static_cast<double>(log_density.size());
    std::vector<std::size_t> by(log_density.size());
    std::iota(by.begin(), by.end(), std::size_t{0});
    std::sort(by.begin(), by.end(),
              [&](std::size_t a, std::size_t b) { return density.weights[a] < density.weights[b]; });
    double missing = lacking / density.compared(static_cast<double>(tested));
    double sum = 0.0;
    double variance = 0.0;
    for (const std::size_t i : by) {
      const double relative = density.weights[i] * count;
      const double kept = 1.0 - std::clamp(missing / density.weights[i], 0.0, 1.0);
      missing -= (1.0 - kept) * density.weights[i];
      sum += (kept * loss(least_mass * relative) + (1.0 - kept) * largest()) / count;
      variance += 1.0 / (relative * count);
    }
    const double margin = 2.0 * std::sqrt(std::max(0.0, variance - 1.0) / static_cast<double>(tested));
    return std::min(sum + margin, largest());
  }

  const Evaluation& evaluation_;
  const Target& target_;
  std::size_t d_;
  std::size_t points_;
  std::size_t total_;
  std::size_t once_;  ///< samples in the target that occur once
  double hidden_atoms_ = 0.0;
  double mixed_;      ///< the density of the uniform samples of the mixture, relative to T
  std::vector<std::size_t> order_;
  std::vector<Feature> features_;
};

}  // namespace

Supported supported_interval(const Evaluation& evaluation) { return Supporter(evaluation).interval(); }

}  // namespace trellis::measure
