// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/supported.hpp>

#include <algorithm>
#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/special_functions/digamma.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <trellis/base/clones.hpp>
#include <trellis/base/polling.hpp>
#include <trellis/base/random.hpp>
#include <trellis/measure/target_feature.hpp>

namespace trellis::measure {

namespace {

constexpr double mass_error = 0.005;       // of the lower end, by the mass in the target
constexpr double parts_error = 0.02;       // of the lower end, by the parts of the target: all features together
constexpr double upper_error = 0.0125;     // of the upper end, by the mass in the target
constexpr std::size_t most_cells = 16;     // of a feature
constexpr std::size_t each_cell = 8;       // samples, at least
constexpr std::size_t least_half = 4;      // samples that choose the parts
constexpr std::size_t least_tested = 8;    // samples
constexpr std::size_t least_k = 4;         // neighbours of the least smooth density
constexpr std::size_t smoother = 5;        // the ratio of the numbers of neighbours
constexpr std::size_t pool_expected = 40;  // points of the target in a ball
constexpr double contradicted = 8.0;       // the largest statistic that does not contradict a density
constexpr double atoms_each_pair = 40.0;   // samples of atoms that occurred once, for each that occurred twice

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

/// Adds the squares of the shorter distances from y along one axis; the first axis begins the sums.
TRELLIS_CLONES void add_squares(const double* column, std::size_t count, double y, double period, bool first,
                                double* square) {
  for (std::size_t i = 0; i < count; ++i) {
    const double u = std::abs(column[i] - y);
    const double other = period - u;
    const double short_way = other < u ? other : u;
    const double before = first ? 0.0 : square[i];
    square[i] = before + short_way * short_way;
  }
}

/// The points of the target and the samples that the interval uses.
struct Effort {
  std::size_t points;
  std::size_t tested;      ///< samples whose goodness of fit is tested
  std::size_t counted;     ///< samples that are counted in parts of the target
  double unseen;           ///< samples that a part of the target may lack unseen
  double unseen_smoothed;  ///< the same where the density is smoothed
};
constexpr Effort fine = {TargetFeature::most_points, 2400, 10000, 16.0, 40.0};
constexpr Effort coarse = {512, 300, 1000, 24.0, 48.0};

/// The values of a function of configurations at points of the target and at the samples in it.
struct Feature {
  std::vector<double> own;  ///< values that no other set of samples has; empty: `target` is the target's
  std::span<const double> target;
  std::vector<std::uint32_t> order;  ///< the points by ascending value
  std::vector<double> samples;
};

class Supporter {
 public:
  Supporter(const Evaluation& evaluation, const Effort& effort)
      : evaluation_(evaluation),
        target_(evaluation.target),
        effort_(effort),
        d_(evaluation.frame().dimension()),
        points_(std::min(effort.points, target_.pool().size())),
        total_(evaluation.samples.total()),
        once_(evaluation.in_target.inside.size() / d_),
        used_(std::min(once_, effort.counted)),
        mixed_(uniform_mix * std::exp(-target_.uniform())),
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
  [[nodiscard]] double loss(double relative) const { return -std::log((1.0 - uniform_mix) * relative + mixed_); }
  [[nodiscard]] View point(std::size_t i) const { return View(target_.pool_rows()).subspan(i * d_, d_); }
  /// Returns the i-th sample in the target, in a random order.
  [[nodiscard]] View sample(std::size_t i) const {
    return View(evaluation_.in_target.inside).subspan(order_[i] * d_, d_);
  }

  template <class Value>
  void add(Value value) {
    const TargetFeature& of_target = target_.features()[features_.size()];
    Feature feature;
    feature.target = std::span(of_target.values).first(points_);
    feature.order.reserve(points_);
    std::copy_if(of_target.order.begin(), of_target.order.end(), std::back_inserter(feature.order),
                 [&](std::uint32_t i) { return i < points_; });
    feature.samples.reserve(used_);
    for (std::size_t i = 0; i < used_; ++i) {
      poll(i);
      feature.samples.push_back(value(i));
    }
    features_.push_back(std::move(feature));
  }

  /// Adds what both ends examine: arc length, distance from the path, and the axes of a flat space, as
  /// Target::features() has them.
  void add_features() {
    if (target_.has_path()) {
      add([&](std::size_t i) { return evaluation_.in_target.arcs[order_[i]]; });
      add([&](std::size_t i) { return target_.distance_at_row(sample(i)); });
    }
    if (evaluation_.frame().flat()) {
      for (std::size_t j = 0; j < d_; ++j) add([&](std::size_t i) { return sample(i)[j]; });
    }
  }

  /// A tree of samples first .. last - 1 of the random order.
  [[nodiscard]] NearestIndex tree_of(std::size_t first, std::size_t last) const {
    std::vector<double> rows;
    rows.reserve((last - first) * d_);
    for (std::size_t i = first; i < last; ++i) {
      const View y = sample(i);
      rows.insert(rows.end(), y.begin(), y.end());
    }
    return {evaluation_.frame().rows(), rows};
  }

  [[nodiscard]] static double nearest(const NearestIndex& tree, View y) {
    double squared = 0.0;
    tree.nearest_distances(y, {&squared, 1});
    return squared;
  }

  /// Distances to the samples first .. last - 1, of the points of the target and of the samples from .. to - 1.
  [[nodiscard]] Feature distances(std::size_t first, std::size_t last, std::size_t from, std::size_t to) const {
    const NearestIndex tree = tree_of(first, last);
    Feature feature;
    for (std::size_t i = 0; i < points_; ++i) {
      poll(i);
      feature.own.push_back(nearest(tree, point(i)));
    }
    feature.target = feature.own;
    feature.order.resize(points_);
    std::iota(feature.order.begin(), feature.order.end(), std::uint32_t{0});
    std::sort(feature.order.begin(), feature.order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return feature.own[a] != feature.own[b] ? feature.own[a] < feature.own[b] : a < b;
    });
    for (std::size_t i = from; i < to; ++i) {
      poll(i);
      feature.samples.push_back(nearest(tree, sample(i)));
    }
    return feature;
  }

  // The lower end -----------------------------------------------------------------------------------------------------

  [[nodiscard]] double lowest() const {
    const std::size_t count = evaluation_.in_target.count;
    const double most = largest_share(total_, count, mass_error);
    double lo = loss(most);
    const std::size_t half = used_ / 2;
    if (half < least_half) return lo;
    const double error = parts_error / static_cast<double>(features_.size() + 1);
    // Samples that occur more than once have no density: they count in the mass, and in no part.
    for (const Feature& feature : features_) lo = std::max(lo, by_cells(feature, half, most, error));
    return std::max(lo, by_distance(distances(0, half, half, used_), most, error));
  }

  /// Cells of equal shares of T by one feature, the emptiest among the first half of the samples first.
  [[nodiscard]] double by_cells(const Feature& feature, std::size_t half, double most, double error) const {
    const std::size_t cells = std::min(most_cells, half / each_cell + 1);
    if (cells < 2) return 0.0;
    std::vector<double> limits;
    for (std::size_t j = 1; j < cells; ++j) limits.push_back(feature.target[feature.order[j * points_ / cells]]);
    const auto cell = [&](double value) {
      return static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), value) - limits.begin());
    };
    std::vector<double> share(cells, 0.0);
    std::vector<std::size_t> chosen(cells, 0);
    std::vector<std::size_t> counted(cells, 0);
    for (const double value : feature.target) share[cell(value)] += 1.0 / static_cast<double>(points_);
    for (std::size_t i = 0; i < used_; ++i) ++(i < half ? chosen : counted)[cell(feature.samples[i])];
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
  [[nodiscard]] double by_distance(const Feature& feature, double most, double error) const {
    constexpr std::array<double, 5> shares_within = {0.75, 0.5, 0.25, 0.125, 0.0625};
    std::vector<double> limits;  // descending
    limits.reserve(shares_within.size());
    for (const double within : shares_within) {
      limits.push_back(feature.target[feature.order[static_cast<std::size_t>(within * static_cast<double>(points_))]]);
    }
    const auto cell = [&](double value) {
      std::size_t j = 0;
      while (j < limits.size() && value <= limits[j]) ++j;
      return j;
    };
    std::vector<double> shares(limits.size() + 1, 0.0);
    std::vector<std::size_t> counts(limits.size() + 1, 0);
    for (const double value : feature.target) shares[cell(value)] += 1.0 / static_cast<double>(points_);
    for (const double value : feature.samples) ++counts[cell(value)];
    return by_tails(shares, counts, most, error);
  }

  /// The least SE where Q has at most `most` in A, and in the first j parts of A at most what their counts allow:
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
    const std::size_t tested = std::min(used_, effort_.tested);
    const std::size_t half = tested / 2;
    const std::size_t looked_at = features_.size();
    for (std::size_t a = looked_at; a < target_.features().size(); ++a) {
      const NearestIndex anchor(evaluation_.frame().rows(), point(target_.pool().size() - 1 - (a - looked_at)));
      add([&](std::size_t i) { return nearest(anchor, sample(i)); });
    }
    std::vector<Feature> all(features_.begin(), features_.end());
    features_.resize(looked_at);
    all.push_back(distances(0, half, half, tested));
    all.push_back(distances(half, tested, 0, half));
    for (Feature& feature : all) {
      if (!feature.own.empty()) feature.target = feature.own;
      feature.samples.resize(std::min(feature.samples.size(), tested));
      std::sort(feature.samples.begin(), feature.samples.end());
    }
    Neighbours neighbours(*this, tested);
    std::vector<double> log_density(points_, 0.0);
    for (std::size_t k = tested; k >= least_k; k /= smoother) {
      if (k < tested) smooth(neighbours, k, log_density);
      const Density density(log_density);
      const bool fits = [&] {
        return std::all_of(all.begin(), all.end(), [&](const Feature& feature) {
          poll();
          return density.misfit(feature) <= contradicted;
        });
      }();
      if (fits) return divergence(log_density, density, tested, k == tested ? effort_.unseen : effort_.unseen_smoothed);
    }
    return largest();
  }

  /// The squared distances of the k-th nearest of the first samples, for fewer and fewer neighbours. Of each point it
  /// keeps the k nearest: among them are all for which it is asked next.
  class Neighbours {
   public:
    Neighbours(const Supporter& of, std::size_t count)
        : of_(of), tree_(of.tree_of(0, of.evaluation_.frame().flat() ? 0 : count)), size_(count), kept_(count) {
      if (!frame().flat()) return;
      columns_.resize(of.d_ * count);
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < of.d_; ++j) columns_[j * count + i] = of.sample(i)[j];
      }
      squared_.resize(count);
    }
    [[nodiscard]] std::size_t size() const { return size_; }
    /// \param k  at most that of the call before
    [[nodiscard]] std::vector<double> kth(std::size_t k) {
      std::vector<double> found(of_.points_);
      std::vector<double> kept(columns_.empty() ? 0 : of_.points_ * k);
      for (std::size_t i = 0; i < found.size(); ++i) {
        poll(i);
        found[i] = columns_.empty() ? by_tree(i, k) : by_scan(i, k, kept);
      }
      nearest_ = std::move(kept);
      kept_ = k;
      return found;
    }

   private:
    [[nodiscard]] const Frame& frame() const { return of_.evaluation_.frame(); }
    double by_tree(std::size_t i, std::size_t k) {
      squared_.resize(k);
      tree_.nearest_distances(of_.point(i), squared_);
      return squared_.back();
    }
    double by_scan(std::size_t i, std::size_t k, std::vector<double>& kept) {
      if (nearest_.empty()) {
        const View y = of_.point(i);
        for (std::size_t j = 0; j < y.size(); ++j) {
          add_squares(&columns_[j * size_], size_, y[j], frame().period(j), j == 0, squared_.data());
        }
      } else {
        std::copy_n(&nearest_[i * kept_], kept_, squared_.begin());
      }
      const auto first = squared_.begin();
      const auto at = first + static_cast<std::ptrdiff_t>(k - 1);
      std::nth_element(first, at, first + static_cast<std::ptrdiff_t>(kept_));
      std::copy_n(first, k, &kept[i * k]);
      return *at;
    }

    const Supporter& of_;
    NearestIndex tree_;  // of a space with rotations
    std::size_t size_;
    std::size_t kept_;
    std::vector<double> nearest_;  // of each point: the `kept_` nearest, in any order
    std::vector<double> columns_;  // of a flat space: the first coordinates, then the second ones, ...
    std::vector<double> squared_;
  };

  /// The density relative to T at the first points of the target, by the k nearest samples.
  void smooth(Neighbours& samples, std::size_t k, std::vector<double>& log_density) const {
    const auto count = static_cast<double>(samples.size());
    const double log_share = boost::math::digamma(static_cast<double>(k)) - std::log(count);
    const NearestIndex& pool = target_.pool_tree(pool_expected * samples.size() / k);
    const std::vector<double> radii = samples.kth(k);
    for (std::size_t i = 0; i < log_density.size(); ++i) {
      poll(i);
      const std::size_t within = pool.count_within(point(i), radii[i]);
      const auto inside = static_cast<double>(std::max<std::size_t>(within, 1));
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
    [[nodiscard]] double misfit(const Feature& feature) const {
      const auto& [own, target, order, samples] = feature;
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
        const auto freedom = static_cast<double>(cells - 1);
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
  const Effort& effort_;
  std::size_t d_;
  std::size_t points_;
  std::size_t total_;
  std::size_t once_;  ///< samples in the target that occur once
  std::size_t used_;  ///< the first of these, in the random order, that are used
  double hidden_atoms_ = 0.0;
  double mixed_;  ///< the density of the uniform samples of the mixture, relative to T
  std::vector<std::size_t> order_;
  std::vector<Feature> features_;
};

}  // namespace

Supported supported_interval(const Evaluation& evaluation, bool rough) {
  return Supporter(evaluation, rough ? coarse : fine).interval();
}

}  // namespace trellis::measure
