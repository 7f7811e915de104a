// SPDX-License-Identifier: GPL-3.0-or-later
// Free ranges of joints, per slice of the previous joints' ranges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include <trellis/guide/axis_projection.hpp>
#include <trellis/instance/forwarding_validity.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// Free ranges of the axes that a projection drops, after Lozano-Perez 1987. Each axis is divided into slices. A slice
/// of a dropped axis, given slices of the axes before it (the kept axes, then the dropped axes in order), is free if
/// the part of the robot that these axes place is valid at the middle of the slices. A slice is checked when it is
/// first needed. Thread-safe.
class JointRanges {
 public:
  /// \param slices  per axis, at least 1
  JointRanges(const Instance& parent, std::shared_ptr<const AxisProjection> kept, std::size_t slices);

  [[nodiscard]] const AxisProjection& kept() const { return *kept_; }
  [[nodiscard]] std::size_t slices() const { return slices_; }
  /// The number of dropped axes.
  [[nodiscard]] std::size_t size() const { return stages_.size(); }
  [[nodiscard]] std::size_t axis(std::size_t stage) const { return stages_[stage].axis; }
  /// The slice of an axis of C that contains q.
  [[nodiscard]] std::size_t slice(View q, std::size_t axis) const;

  /// Draws the value of a dropped axis uniformly from its free slices, given the earlier axes of q.
  /// \return false if no slice is free; q then keeps its value
  bool draw(std::size_t stage, Stream& stream, MutableView q);
  /// The density of `draw` at q, as a factor on the uniform density; -1 if no slice is free. Counts no checks.
  [[nodiscard]] double density_factor(std::size_t stage, View q);
  /// Whether the first dropped axis has a free slice, given the slice of the kept axes at s, a configuration of S.
  [[nodiscard]] bool open(View s);
  /// Marks the slices that contain q, a valid configuration, as free.
  void declare_free(View q);

  /// Returns and resets the number of validity checks made by `draw` and `open`.
  std::uint64_t take_checks();

 private:
  using Key = std::vector<std::uint16_t>;
  enum class State : std::uint8_t { unknown, free, blocked };
  struct Range {
    std::vector<State> slices;
    std::size_t blocked = 0;
  };
  struct Stage {
    std::size_t axis = 0;                ///< of C
    std::vector<std::size_t> before;     ///< axes of C that its slices depend on: kept axes, then dropped ones
    std::vector<std::size_t> placed;     ///< `before` and `axis`, ascending
    std::shared_ptr<Validity> validity;  ///< of the part of the robot that `placed` determines; nullptr: no part
    std::map<Key, Range> ranges;
  };

  [[nodiscard]] double width(std::size_t axis) const;
  [[nodiscard]] Key key(const Stage& stage, View q) const;
  Range& range(Stage& stage, const Key& key) const;
  /// Whether a slice is free. Checks it if its state is unknown.
  /// \param checks  counter of validity checks, incremented
  bool is_free(Stage& stage, const Key& key, Range& range, std::size_t slice, std::uint64_t& checks);

  std::shared_ptr<const AxisProjection> kept_;
  std::size_t slices_;
  std::vector<Stage> stages_;
  std::mutex mutex_;  ///< guards the ranges and the scratch memory of their checks
  std::uint64_t checks_ = 0;
};

/// Keeps some axes of C. Draws the dropped ones from their free ranges, and a share of them uniformly.
class RangedProjection final : public Projection {
 public:
  explicit RangedProjection(std::shared_ptr<JointRanges> ranges) : ranges_(std::move(ranges)) {}

  /// Sets the counter for the checks of `lift`.
  void count_in(Instance& instance) { counted_ = &instance; }

  void project(View q, MutableView s) const override { ranges_->kept().project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override;
  [[nodiscard]] bool closed_form() const override { return true; }
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] bool contracts() const override { return ranges_->kept().contracts(); }
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const override {
    return ranges_->kept().lifted(path, start, goal);
  }

 private:
  std::shared_ptr<JointRanges> ranges_;
  Instance* counted_ = nullptr;
};

/// Validity in S that also requires a free range of the first dropped joint, in every slice that a motion crosses.
class RangedValidity final : public ForwardingValidity<> {
 public:
  RangedValidity(std::shared_ptr<Validity> own, std::shared_ptr<JointRanges> ranges)
      : ForwardingValidity(std::move(own)), ranges_(std::move(ranges)) {}

  /// Sets the counter for checks of single configurations.
  void count_in(Instance& instance) { counted_ = &instance; }

  [[nodiscard]] bool state(View s) override;
  [[nodiscard]] MotionReport motion(View a, View b) override;

 private:
  std::shared_ptr<JointRanges> ranges_;
  Instance* counted_ = nullptr;
};

}  // namespace trellis
