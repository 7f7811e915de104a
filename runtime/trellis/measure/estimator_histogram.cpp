// SPDX-License-Identifier: GPL-3.0-or-later
// Estimators by counting in cells.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <vector>

#include <trellis/measure/evaluation.hpp>

namespace trellis::measure {

namespace {

/// What an empty cell gets (option `smoothing`).
enum class Smoothing : std::uint8_t { kt, laplace, least_share };

struct HistogramSettings {
  double bin = 0.5;
  Smoothing smoothing = Smoothing::kt;
  double floor = 1e-10;
};

const Settings<HistogramSettings>& histogram_settings() {
  static const Settings<HistogramSettings> settings =
      Settings<HistogramSettings>(Component::Kind::estimator, "histogram", "counts in a grid over the space",
                                  "Krichevsky and Trofimov 1981")
          .number("bin", &HistogramSettings::bin, "m in the metric", Range::positive(),
                  "longest side of a cell; the cells divide the space evenly")
          .choice("smoothing", &HistogramSettings::smoothing,
                  {{"kt", Smoothing::kt}, {"laplace", Smoothing::laplace}, {"floor", Smoothing::least_share}},
                  "kt: half a sample more in every cell; laplace: one more; floor: no less than `floor` of the samples")
          .number("floor", &HistogramSettings::floor, "share of the samples", Range::positive(),
                  "the least share of a cell, for smoothing = \"floor\"")
          .positional({"bin"});
  return settings;
}

struct LegacySettings {
  double cell = 1.0;
  double floor = 1e-100;
};

const Settings<LegacySettings>& legacy_settings() {
  static const Settings<LegacySettings> settings =
      Settings<LegacySettings>(Component::Kind::estimator, "legacy",
                               "a plain grid over position and the whole tube, valid or not: the reading that comes "
                               "nearest to the published table; an artefact of its floor",
                               "Attali et al. 2022")
          .number("cell", &LegacySettings::cell, "m", Range::positive(), "side of a cell")
          .number("floor", &LegacySettings::floor, "share of the samples", Range::positive(),
                  "the share of a cell without samples")
          .positional({"cell"});
  return settings;
}

/// A grid over some axes of a frame, with a count per cell.
class Grid {
 public:
  /// \param even  cells that divide each axis evenly, at most `side` long; else cells of that side from the lower bound
  Grid(const Frame& frame, std::vector<std::size_t> axes, double side, bool even)
      : frame_(frame), axes_(std::move(axes)) {
    for (const std::size_t axis : axes_) {
      const double cells = std::max(1.0, std::ceil(frame.extent(axis) / side - 1e-9));
      cells_ *= cells;
      side_.push_back(even ? frame.extent(axis) / cells : side);
      log_volume_ += std::log(side_.back());
      last_.push_back(cells - 1.0);
    }
  }

  using Key = std::vector<double>;
  [[nodiscard]] Key key(View y) const {
    Key key(axes_.size());
    for (std::size_t j = 0; j < axes_.size(); ++j) {
      key[j] = std::clamp(std::floor((y[axes_[j]] - frame_.lo(axes_[j])) / side_[j]), 0.0, last_[j]);
    }
    return key;
  }
  void count(View y, std::size_t times = 1) { counts_[key(y)] += times; }
  void count_rows(std::span<const double> rows) {
    const std::size_t d = frame_.dimension();
    for (std::size_t i = 0; i < rows.size(); i += d) count(rows.subspan(i, d));
  }
  [[nodiscard]] double at(const Key& key) const {
    const auto it = counts_.find(key);
    return it != counts_.end() ? static_cast<double>(it->second) : 0.0;
  }
  [[nodiscard]] const std::map<Key, std::size_t>& counts() const { return counts_; }
  /// Returns the number of cells.
  [[nodiscard]] double cells() const { return cells_; }
  [[nodiscard]] double log_cell_volume() const { return log_volume_; }

 private:
  const Frame& frame_;
  std::vector<std::size_t> axes_;
  std::vector<double> side_, last_;
  double cells_ = 1.0;
  double log_volume_ = 0.0;
  std::map<Key, std::size_t> counts_;
};

std::vector<std::size_t> all_axes(const Frame& frame) {
  std::vector<std::size_t> axes(frame.dimension());
  std::iota(axes.begin(), axes.end(), std::size_t{0});
  return axes;
}

Estimate estimate_histogram(const Options& options, const Evaluation& evaluation) {
  const HistogramSettings settings = histogram_settings().read(options);
  Grid grid(evaluation.frame(), all_axes(evaluation.frame()), settings.bin, true);
  grid.count_rows(evaluation.samples.all());
  const auto total = static_cast<double>(evaluation.samples.total());
  const double more = settings.smoothing == Smoothing::kt ? 0.5 : settings.smoothing == Smoothing::laplace ? 1.0 : 0.0;
  std::vector<double> log_density(evaluation.points);
  double mass = 0.0;
  for (std::size_t i = 0; i < evaluation.points; ++i) {
    double share = (grid.at(grid.key(evaluation.at(i))) + more) / (total + more * grid.cells());
    if (more == 0.0) share = std::max(share, settings.floor);
    log_density[i] = std::log(share) - grid.log_cell_volume();
    mass += std::exp(log_density[i] - evaluation.target.log_density(i));
  }
  return estimate_from(evaluation, log_density, std::min(1.0, mass / static_cast<double>(evaluation.points)));
}

std::string unfit_histogram(const Options&, const Evaluation& evaluation) {
  return evaluation.samples.tree().size() >= 1 ? "" : "too few samples: none that occurs once";
}

Estimate estimate_legacy(const Options& options, const Evaluation& evaluation) {
  const LegacySettings settings = legacy_settings().read(options);
  const Target& target = evaluation.target;
  const std::size_t d = evaluation.frame().dimension();
  Grid samples(evaluation.frame(), target.axes(), settings.cell, false);
  samples.count_rows(evaluation.samples.all());
  for (std::size_t i = 0; i < evaluation.samples.copies().size(); ++i) {
    samples.count(View(evaluation.samples.atoms()).subspan(i * d, d), evaluation.samples.copies()[i]);
  }
  Grid tube(evaluation.frame(), target.axes(), settings.cell, false);
  std::vector<double> y(d);
  for (std::size_t i = 0; i < target.whole_tube().size(); ++i) {
    evaluation.frame().to_metric(target.whole_tube()[i], y);
    tube.count(y);
  }
  const auto total = static_cast<double>(evaluation.samples.total());
  const auto points = static_cast<double>(target.whole_tube().size());
  Estimate result;
  result.unregularised = 0.0;
  for (const auto& [cell, count] : tube.counts()) {
    const double t = static_cast<double>(count) / points;
    result.unregularised += t * std::log(t / std::max(samples.at(cell) / total, settings.floor));
  }
  result.value = result.unregularised;
  return result;
}

std::string unfit_legacy(const Options&, const Evaluation& evaluation) {
  if (!evaluation.target.has_path()) return "only a tube has a legacy reading";
  return evaluation.samples.total() > 0 ? "" : "too few samples: none";
}

}  // namespace

EstimatorKind histogram_kind() { return {&histogram_settings().component(), unfit_histogram, estimate_histogram}; }

EstimatorKind legacy_kind() { return {&legacy_settings().component(), unfit_legacy, estimate_legacy}; }

}  // namespace trellis::measure
