// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace trellis {

/// A certificate of motions: everywhere on them the robot's distance from all that it must not touch (closed obstacles,
/// the boundary, the bodies of self-collision pairs) is greater than 0. Checker::certify adds motions to it.
///
/// A motion is covered by intervals. On each, the distance at its middle is greater than the largest displacement of
/// the robot's points from there to the interval's ends, or a direction separates the robot throughout. Where that
/// cannot be shown for an interval with a displacement of at most `tolerance`, the motion is refuted.
struct Certificate {
  /// In metres, > 0: intervals are not divided further once the displacement from their middle to their ends is at most
  /// this.
  double tolerance = 0.0;
  /// The distance, in metres, at the nearest of the configurations whose distance was computed; infinity before the
  /// first. The least distance on the motions is at most this.
  double nearest = std::numeric_limits<double>::infinity();
  /// A lower bound, in metres, on the distance at all configurations of the motions. At least nine tenths of `nearest`
  /// unless the motions are closer to contact than ten times the tolerance, or distances there are inexact (Near).
  double clearance = std::numeric_limits<double>::infinity();
  std::uint64_t checks = 0;  ///< configurations that were checked
  /// The parameter on [0, 1], on the last motion added, of a configuration in contact, or too close to contact to
  /// decide; none while all motions are certified.
  std::optional<double> refuted_at = {};

  /// Whether all motions added so far are free of contact.
  [[nodiscard]] bool valid() const { return !refuted_at; }
};

/// The default of a certificate's tolerance, as a share of the resolution.
inline constexpr double certificate_share = 1e-6;

/// The bound that is certified is at least this share of the least distance found, so that few intervals are divided
/// for it alone.
inline constexpr double certified_share = 0.9;

/// The distances of a robot on one motion. Displacements are those of the robot's points on a part of the motion: they
/// are proportional to its share of the motion.
class MotionClearance {
 public:
  MotionClearance() = default;
  MotionClearance(const MotionClearance&) = delete;
  MotionClearance& operator=(const MotionClearance&) = delete;
  virtual ~MotionClearance() = default;

  /// The most configurations that one call of `apart` decides.
  static constexpr unsigned lanes = 8;
  /// Returns the bits of the configurations at which everything is certainly farther from the robot than `margin`
  /// metres plus its displacement on `half` of the motion.
  /// \param shares  parameters on the motion, at most `lanes`
  /// \param half  share of the motion, in (0, 0.5]
  /// \param margin  in metres, finite
  /// \return bit i is set for `shares[i]`; a bit that is not set decides nothing
  [[nodiscard]] virtual unsigned apart(std::span<const double> shares, double half, double margin) = 0;

  /// The distance at a configuration of the motion.
  struct Near {
    double distance = 0.0;  ///< metres; of several, the least; 0 in contact
    double sure = 0.0;      ///< the least distance less the displacement on `half` of the motion; may be negative
    bool inexact = false;   ///< the distance is computed with a larger error than a tenth of it
  };
  /// The share of the least distance found up to which the displacement on half an interval decides that its distance
  /// is computed. Of longer intervals it is not: most of them need only be divided. None: where the distance decides
  /// about the interval, because it costs as much as many configurations that `apart` decides.
  [[nodiscard]] virtual std::optional<double> measured_from() const { return std::nullopt; }
  /// Returns the distance at a parameter. Distances of at least `at_most` plus the displacement may count as that.
  /// \param share  parameter on the motion, in (0, 1)
  /// \param half  share of the motion, in (0, 0.5]
  /// \param at_most  in metres; infinity: the distance is computed in any case
  [[nodiscard]] virtual Near near(double share, double half, double at_most) = 0;
};

/// Adds one motion to a certificate.
/// \param certificate  valid so far; receives distances, checks and the place where the motion is refuted
/// \param motion  the robot's distances on the motion; used during the call only
/// \param displacement  in metres, of the robot's points on the whole motion, at most
/// \param first  in metres: the length of the intervals that are tried first
/// \param breaks  ascending parameters inside (0, 1) at which the robot jumps, because an axis wraps
void add_motion(Certificate& certificate, MotionClearance& motion, double displacement, double first,
                std::span<const double> breaks = {});

}  // namespace trellis
