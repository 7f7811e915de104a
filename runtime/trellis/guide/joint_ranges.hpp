// SPDX-License-Identifier: GPL-3.0-or-later
// Free ranges of joints, for slices of the ranges of the joints before them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include <trellis/guide/axis_projection.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// The ranges of the axes that a projection leaves out, after Lozano-Perez 1987. Each axis is divided into slices. An
/// axis that is left out is free in a slice of the axes before it (those kept, then those left out, in their order)
/// where what these axes place of the robot is valid at the middle of the slices. A slice is checked when it is asked
/// for first. May be shared by threads.
class JointRanges {
 public:
  /// \param slices  of each axis, at least 1
  JointRanges(const Instance& parent, std::shared_ptr<const AxisProjection> kept, std::size_t slices);

  [[nodiscard]] const AxisProjection& kept() const { return *kept_; }
  [[nodiscard]] std::size_t slices() const { return slices_; }
  /// The axes of C that are left out, in their order.
  [[nodiscard]] std::size_t size() const { return stages_.size(); }
  [[nodiscard]] std::size_t axis(std::size_t stage) const { return stages_[stage].axis; }
  /// The slice of an axis of C that a configuration lies in.
  [[nodiscard]] std::size_t slice(View q, std::size_t axis) const;

  /// Draws the value of an axis left out uniformly from its free slices, given those before it in q.
  /// \return false, and q keeps its value, where none is free
  bool draw(std::size_t stage, Stream& stream, MutableView q);
  /// The density of `draw` at q, as a factor on that of a uniform value; -1 where no slice is free. Counts no checks.
  [[nodiscard]] double density_factor(std::size_t stage, View q);
  /// Whether the slice of the kept axes at s, a configuration of S, leaves the first axis left out a free slice.
  [[nodiscard]] bool open(View s);
  /// Declares the slices that q, a valid configuration, lies in free.
  void declare_free(View q);

  /// Validity checks of `draw` and `open` since this was asked last.
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
    std::vector<std::size_t> before;     ///< axes of C that its slices depend on: those kept, then those left out
    std::vector<std::size_t> placed;     ///< `before` and `axis`, ascending
    std::shared_ptr<Validity> validity;  ///< of what `placed` places; nullptr: of nothing
    std::map<Key, Range> ranges;
  };

  [[nodiscard]] double width(std::size_t axis) const;
  [[nodiscard]] Key key(const Stage& stage, View q) const;
  Range& range(Stage& stage, const Key& key) const;
  /// Checks a slice where that was not done. \param checks  counts it
  bool is_free(Stage& stage, const Key& key, Range& range, std::size_t slice, std::uint64_t& checks);

  std::shared_ptr<const AxisProjection> kept_;
  std::size_t slices_;
  std::vector<Stage> stages_;
  std::mutex mutex_;  ///< of the ranges and of the scratch of what checks them
  std::uint64_t checks_ = 0;
};

/// Keeps axes of C, and draws those left out from their free ranges, with a share that is uniform.
class RangedProjection final : public Projection {
 public:
  explicit RangedProjection(std::shared_ptr<JointRanges> ranges) : ranges_(std::move(ranges)) {}

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
};

/// Validity in S that also asks for a free range of the next joint: at every slice that a motion passes through.
class RangedValidity final : public Validity {
 public:
  RangedValidity(std::shared_ptr<Validity> own, std::shared_ptr<JointRanges> ranges)
      : own_(std::move(own)), ranges_(std::move(ranges)) {}

  /// Where the checks of single configurations are counted.
  void count_in(Checks& checks) { counted_ = &checks; }

  [[nodiscard]] bool state(View s) override;
  [[nodiscard]] MotionReport motion(View a, View b) override;
  [[nodiscard]] double clearance(View s) override { return own_->clearance(s); }
  [[nodiscard]] std::optional<Contact> contact(View s) override { return own_->contact(s); }
  [[nodiscard]] double invalid_radius(View s) override { return own_->invalid_radius(s); }

 private:
  std::shared_ptr<Validity> own_;
  std::shared_ptr<JointRanges> ranges_;
  Checks* counted_ = nullptr;
};

}  // namespace trellis
