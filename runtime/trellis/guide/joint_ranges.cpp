// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/joint_ranges.hpp>
#include <trellis/instance/search_cost.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace trellis {

namespace {

/// Share of values drawn uniformly, so that the support is the whole fibre.
constexpr double uniform_share = 0.1;

}  // namespace

JointRanges::JointRanges(const Instance& parent, std::shared_ptr<const AxisProjection> kept, std::size_t slices)
    : kept_(std::move(kept)), slices_(slices) {
  const auto& of = kept_->kept();
  std::vector<std::size_t> before(of.begin(), of.end());
  for (std::size_t axis = 0; axis < parent.space.dimension(); ++axis) {
    if (std::find(of.begin(), of.end(), axis) != of.end()) continue;
    Stage stage;
    stage.axis = axis;
    stage.before = before;
    before.push_back(axis);
    stage.placed = before;
    std::sort(stage.placed.begin(), stage.placed.end());
    // Velocities do not place any body.
    const bool places = axis < parent.scene->robot_dimension();
    if (const auto scene = places ? parent.scene->reduced(stage.placed) : nullptr) {
      const AxisProjection placed(parent.space, stage.placed, "slices");
      stage.validity = make_validity(parent.collision, scene, placed.space(), parent.resolution, nullptr);
    }
    stages_.push_back(std::move(stage));
  }
}

double JointRanges::width(std::size_t axis) const {
  const Axis& of = kept_->parent().axes()[axis];
  return (of.hi - of.lo) / static_cast<double>(slices_);
}

std::size_t JointRanges::slice(View q, std::size_t axis) const {
  const double place = std::floor((q[axis] - kept_->parent().axes()[axis].lo) / width(axis));
  return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(slices_ - 1)));
}

JointRanges::Key JointRanges::key(const Stage& stage, View q) const {
  Key key;
  key.reserve(stage.before.size());
  for (const std::size_t axis : stage.before) key.push_back(static_cast<std::uint16_t>(slice(q, axis)));
  return key;
}

JointRanges::Range& JointRanges::range(Stage& stage, const Key& key) const {
  Range& range = stage.ranges[key];
  if (range.slices.empty()) range.slices.assign(slices_, State::unknown);
  return range;
}

bool JointRanges::is_free(Stage& stage, const Key& key, Range& range, std::size_t slice, std::uint64_t& checks) {
  State& state = range.slices[slice];
  if (state == State::unknown) {
    bool valid = true;
    if (stage.validity) {
      Configuration middle;
      for (const std::size_t axis : stage.placed) {
        const auto place = std::find(stage.before.begin(), stage.before.end(), axis) - stage.before.begin();
        const std::size_t at = axis == stage.axis ? slice : key[static_cast<std::size_t>(place)];
        middle.push_back(kept_->parent().axes()[axis].lo + (static_cast<double>(at) + 0.5) * width(axis));
      }
      valid = stage.validity->state(middle);
      ++checks;
    }
    state = valid ? State::free : State::blocked;
    if (!valid) ++range.blocked;
  }
  return state == State::free;
}

bool JointRanges::draw(std::size_t stage_index, Stream& stream, MutableView q) {
  const std::scoped_lock lock(mutex_);
  Stage& stage = stages_[stage_index];
  const Key at = key(stage, q);
  Range& of = range(stage, at);
  // Rejection sampling among slices not known to be blocked: uniform over the free slices, with few checks of others.
  while (of.blocked < slices_) {
    std::size_t nth = stream.below(slices_ - of.blocked);
    std::size_t slice = 0;
    while (of.slices[slice] == State::blocked || nth-- > 0) ++slice;
    if (!is_free(stage, at, of, slice, checks_)) continue;
    q[stage.axis] =
        kept_->parent().axes()[stage.axis].lo + (static_cast<double>(slice) + stream.uniform()) * width(stage.axis);
    return true;
  }
  return false;
}

double JointRanges::density_factor(std::size_t stage_index, View q) {
  const std::scoped_lock lock(mutex_);
  Stage& stage = stages_[stage_index];
  const Key at = key(stage, q);
  Range& of = range(stage, at);
  // What densities check is no part of the search.
  const MonitorScope unmonitored(nullptr);
  std::uint64_t uncounted = 0;
  for (std::size_t k = 0; k < slices_; ++k) static_cast<void>(is_free(stage, at, of, k, uncounted));
  const std::size_t free = slices_ - of.blocked;
  if (free == 0) return -1.0;
  return of.slices[slice(q, stage.axis)] == State::free ? static_cast<double>(slices_) / static_cast<double>(free)
                                                        : 0.0;
}

bool JointRanges::open(View s) {
  if (stages_.empty()) return true;
  const std::scoped_lock lock(mutex_);
  Stage& stage = stages_.front();
  Configuration q(kept_->parent().dimension());
  for (std::size_t j = 0; j < s.size(); ++j) q[kept_->kept()[j]] = s[j];
  const Key at = key(stage, q);
  Range& of = range(stage, at);
  if (std::find(of.slices.begin(), of.slices.end(), State::free) != of.slices.end()) return true;
  // Checks halves first, then quarters and so on: finds a free range after about the inverse of its share of checks.
  std::size_t stride = 1;
  while (2 * stride < slices_) stride *= 2;
  for (; stride > 0; stride /= 2) {
    for (std::size_t k = 0; k < slices_; k += stride) {
      if (is_free(stage, at, of, k, checks_)) return true;
    }
  }
  return false;
}

void JointRanges::declare_free(View q) {
  const std::scoped_lock lock(mutex_);
  for (Stage& stage : stages_) {
    Range& of = range(stage, key(stage, q));
    State& state = of.slices[slice(q, stage.axis)];
    if (state == State::blocked) --of.blocked;
    state = State::free;
  }
}

std::uint64_t JointRanges::take_checks() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(checks_, 0);
}

void RangedProjection::lift(View s, Stream& stream, MutableView q) const {
  ranges_->kept().lift(s, stream, q);
  const Instance::Announced before = counted_ != nullptr ? counted_->open_checks() : Instance::Announced{};
  for (std::size_t stage = 0; stage < ranges_->size(); ++stage) {
    if (stream.uniform() >= uniform_share) ranges_->draw(stage, stream, q);
  }
  if (counted_ != nullptr) counted_->count_alone(before, ranges_->take_checks());
}

double RangedProjection::log_fibre_density(View q) const {
  double density = ranges_->kept().log_fibre_density(q);
  if (!std::isfinite(density)) return density;
  for (std::size_t stage = 0; stage < ranges_->size(); ++stage) {
    const double factor = ranges_->density_factor(stage, q);
    if (factor >= 0.0) density += std::log(uniform_share + (1.0 - uniform_share) * factor);
  }
  return density;
}

bool RangedValidity::state(View s) {
  if (!inner_->state(s)) return false;
  const Instance::Announced before = counted_ != nullptr ? counted_->open_checks() : Instance::Announced{};
  const bool open = ranges_->open(s);
  if (counted_ != nullptr) counted_->count_alone(before, ranges_->take_checks());
  return open;
}

MotionReport RangedValidity::motion(View a, View b) {
  MotionReport report = inner_->motion(a, b);
  if (!report.valid) return report;
  const Space& space = ranges_->kept().space();
  Configuration at(a.size());
  // Checks points at most half a slice apart along every axis.
  Configuration change(a.size());
  space.difference(a, b, change);
  double pieces = 1.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const Axis& axis = space.axes()[j];
    const double slice = (axis.hi - axis.lo) / static_cast<double>(ranges_->slices());
    pieces = std::max(pieces, std::ceil(2.0 * std::abs(change[j]) / slice));
  }
  if (counted_ != nullptr) counted_->spend(search_cost::slice * pieces);
  for (double k = 1.0; k <= pieces; k += 1.0) {
    space.interpolate(a, b, k / pieces, at);
    if (ranges_->open(at)) continue;
    report.valid = false;
    report.invalid_at = k / pieces;
    break;
  }
  report.checks += static_cast<std::uint32_t>(ranges_->take_checks());
  return report;
}

}  // namespace trellis
