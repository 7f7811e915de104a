// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/target.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <trellis/measure/low_discrepancy.hpp>
#include <trellis/measure/point_tree.hpp>
#include <trellis/measure/tube.hpp>

namespace trellis {

namespace {

// Points of the cover for the tube's volume: the geometry alone is cheap, so more of them than the pool needs.
constexpr std::size_t cover_points = std::size_t{1} << 16U;
// A tube that fills little of its cover (many dimensions) or is mostly invalid ends the search for its pool here,
// in multiples of the pool asked for: points of the cover, and validity checks.
constexpr std::size_t cover_limit = 256;
constexpr std::size_t check_limit = 16;
// With this share of the pool found, a third of the pool's price in checks is not exceeded.
constexpr std::size_t patience = 3;
constexpr std::size_t enough = 1024;

void check(const TubeSettings& settings) {
  const auto fail = [](const std::string& what) { throw Error("tube: " + what); };
  if (!std::isfinite(settings.delta) || settings.delta <= 0.0) {
    fail(fmt::format("delta must be greater than 0, in m, got {:g}", settings.delta));
  }
  if (settings.distance != "planar" && settings.distance != "full") {
    fail(fmt::format(R"(distance must be "planar" or "full", got "{}")", settings.distance));
  }
  if (settings.support != "free" && settings.support != "all") {
    fail(fmt::format(R"(support must be "free" or "all", got "{}")", settings.support));
  }
  if (!(settings.epsilon > 0.0 && settings.epsilon < 1.0)) {
    fail(fmt::format("epsilon must be in (0, 1), got {:g}", settings.epsilon));
  }
  if (settings.points < 1) fail(fmt::format("points must be at least 1, got {}", settings.points));
  if (settings.pool < 1) fail(fmt::format("pool must be at least 1, got {}", settings.pool));
}

void check(const Space& space, const Configurations& path, const std::vector<std::size_t>& position) {
  if (space.dimension() == 0) throw Error("tube: the space has no axes");
  if (path.empty()) throw Error("tube: the path is empty");
  if (path.dimension() != space.dimension()) {
    throw Error(fmt::format("tube: the path has {} coordinates, the space {} has {}", path.dimension(), space.name(),
                            space.dimension()));
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!space.contains(path[i])) {
      throw Error(fmt::format("tube: waypoint {} of the path lies outside of the space {}", i + 1, space.name()));
    }
  }
  for (std::size_t i = 0; i < position.size(); ++i) {
    const auto before = position.begin() + static_cast<std::ptrdiff_t>(i);
    if (position[i] >= space.dimension() || std::find(position.begin(), before, position[i]) != before) {
      throw Error(fmt::format("tube: position axis {} is not an axis of the space {} or is given twice", position[i],
                              space.name()));
    }
  }
}

}  // namespace

const Settings<TubeSettings>& tube_settings() {
  static const Settings<TubeSettings> settings = [] {
    const Range open_share{.lo = 0, .hi = 1, .open_lo = true, .open_hi = true};
    const Range count{.lo = 64, .hi = 1e7};
    Settings<TubeSettings> s(Component::Kind::target, "tube", "configurations within delta of the final path",
                             "Attali et al. 2022");
    s.number("delta", &TubeSettings::delta, "m", Range::positive(), "radius of the tube")
        .choice("distance", &TubeSettings::distance, {"planar", "full"},
                "planar: position of the reference point only; full: the space's metric")
        .choice("support", &TubeSettings::support, {"free", "all"},
                "free: valid configurations only; all: the whole tube, which no tree can reach")
        .number("epsilon", &TubeSettings::epsilon, "", open_share,
                "uniform share mixed into the sampler for the defended value")
        .integer("points", &TubeSettings::points, "points", count, "evaluation points on the target")
        .integer("pool", &TubeSettings::pool, "points", count,
                 "points of the target for the volumes of cut balls, at least as many as points")
        .positional({"delta"});
    return s;
  }();
  return settings;
}

Target::Target(const Space& space, const Configurations& path, std::vector<std::size_t> position,
               const TubeSettings& settings, const Valid& valid, std::uint64_t seed)
    : space_(space), settings_(settings), valid_(valid) {
  check(settings);
  check(space, path, position);
  const std::size_t d = space.dimension();
  if (settings.distance == "full" || position.empty()) {
    position.resize(d);
    std::iota(position.begin(), position.end(), std::size_t{0});
  }
  const bool free_only = settings.support == "free";
  if (free_only && !valid_) throw Error("tube: support \"free\" needs a validity");

  const measure::Frame frame(space);
  tube_ = std::make_shared<const measure::Tube>(frame, space, path, std::move(position), settings.delta);

  Stream stream(seed, "", "measure");
  std::vector<double> shift(d + 1);
  for (double& s : shift) s = stream.uniform();
  std::vector<double> unit = shift;
  measure::LowDiscrepancy sequence(d + 1, std::move(shift));

  const auto wanted = static_cast<std::size_t>(std::max(settings.pool, settings.points));
  std::vector<double> y(d);
  std::vector<double> x(d);
  std::vector<double> rows;
  rows.reserve(wanted * d);
  pool_ = Configurations(d);
  pool_.reserve(wanted);
  std::size_t drawn = 0;
  std::size_t in_tube = 0;
  std::size_t checked = 0;
  const auto filling = [&] {
    if (pool_.size() >= wanted || checked >= check_limit * wanted) return false;
    return checked < patience * wanted || pool_.size() < std::min(enough, wanted);
  };
  while (filling() ? drawn < std::max(cover_points, cover_limit * wanted) : drawn < cover_points) {
    sequence.next(unit);
    ++drawn;
    if (!tube_->draw(unit, y)) continue;
    ++in_tube;
    if (!filling()) continue;
    frame.to_raw(y, x);
    ++checked;
    if (free_only && !valid_(x)) continue;
    pool_.push(x);
    rows.insert(rows.end(), y.begin(), y.end());
  }
  pool_tree_ = std::make_shared<const measure::PointTree>(frame, rows);
  if (pool_.empty()) {
    log_volume_ = -std::numeric_limits<double>::infinity();
    return;
  }
  free_share_ = static_cast<double>(pool_.size()) / static_cast<double>(checked);
  const double tube_share = static_cast<double>(in_tube) / static_cast<double>(drawn);
  log_volume_ = std::log(tube_->cover_volume()) + std::log(tube_share) + std::log(free_share_);
}

bool Target::contains(View x) const {
  if (!space_.contains(x)) return false;
  std::vector<double> y(space_.dimension());
  tube_->frame().to_metric(x, y);
  return tube_->contains(y) && (settings_.support != "free" || valid_(x));
}

double Target::distance(View x) const {
  std::vector<double> y(space_.dimension());
  tube_->frame().to_metric(x, y);
  return tube_->distance(y);
}

std::size_t Target::evaluation_points() const {
  return std::min(pool_.size(), static_cast<std::size_t>(settings_.points));
}

}  // namespace trellis
