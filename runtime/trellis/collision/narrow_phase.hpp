// SPDX-License-Identifier: GPL-3.0-or-later
// What a backend of collision checking implements; Checker has what all backends share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include <trellis/collision/certificate.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/collision/orders.hpp>

namespace trellis {

/// Contacts and distances of a robot in a world: the part of a Checker that depends on shapes. "Touches" means here
/// that a configuration is invalid as Checker defines it.
///
/// The Checker validates a motion by `begin`, then `check` until a configuration touches or all are checked, then
/// `end`. It certifies one by `sweep`, then `on` unless that decided.
///
/// All coordinates that move the robot are finite: the Checker answers for others. A narrow phase has scratch memory:
/// only one thread may use it at a time.
class NarrowPhase {
 public:
  NarrowPhase() = default;
  NarrowPhase(const NarrowPhase&) = delete;
  NarrowPhase& operator=(const NarrowPhase&) = delete;
  virtual ~NarrowPhase() = default;

  /// Returns a bound in metres on the displacement of the robot's points on a motion: it decides the number of
  /// configurations that are checked.
  [[nodiscard]] virtual double displacement(View a, View b) const = 0;

  /// What is known of a motion before its configurations are checked in order.
  enum class Decision : std::uint8_t {
    undecided,
    valid,
    end_touches,  ///< the first configuration in order, b, touches
  };
  /// Begins a motion, and decides it where that takes less than its configurations. After a decision neither `check`
  /// nor `end` follows.
  /// \param a, b  the ends; they outlive the call of `end`
  /// \param n  the number of configurations, at least 1
  virtual Decision begin(View a, View b, std::uint32_t n) = 0;

  /// Answers about consecutive configurations of a motion.
  struct Batch {
    std::uint32_t count;    ///< how many were checked, 1 to 32
    std::uint32_t touches;  ///< bit i: the i-th of them touches; bits above the lowest one that is set may be missing
  };
  /// Checks configurations of the motion that has begun: as many in a step as suits the backend.
  /// \param order  of its n configurations
  /// \param rank  of the first of them in that order, below n: 0, then the sum of the counts so far
  virtual Batch check(const Order& order, std::uint32_t rank) = 0;
  /// Ends the motion.
  /// \param first  the rank of the first configuration that touches; n: none does
  /// \return the parameter on [0, 1] where a point touches an obstacle between the n configurations; none of other
  ///     robots, and where first is less than n
  virtual std::optional<double> end(std::uint32_t first) {
    static_cast<void>(first);
    return std::nullopt;
  }

  /// Adds a motion to a certificate where that takes less than its distances.
  /// \param certificate  not refuted; also receives what holds on every motion, whether or not this one is decided
  /// \return whether the motion is decided: certified or refuted
  virtual bool sweep(View a, View b, Certificate& certificate) = 0;

  /// The distances on a motion: what add_motion takes.
  struct Distances {
    MotionClearance& clearance;  ///< of the narrow phase; until the next call of one of its functions
    double displacement;         ///< in metres, of the robot's points on the whole motion, at most
    double first;                ///< in metres, > 0: the length of the intervals that are tried first
    /// Ascending parameters inside (0, 1) at which the robot jumps, because an axis wraps.
    std::vector<double> breaks = {};
    /// In metres, > 0, where `sweep` has shown that the motion is free of contact: a bound on the distance at places
    /// that the distances leave undecided.
    std::optional<double> sure = {};
  };
  /// Returns the distances on a motion that `sweep`, called just before, has not decided.
  /// \param a, b  the ends; they outlive the use of the distances
  /// \param longest  in metres, > 0: how long the first intervals may be
  virtual Distances on(View a, View b, double longest) = 0;

  /// Whether the robot touches something at q.
  [[nodiscard]] virtual bool touches(View q) const = 0;
  /// As Checker::clearance.
  [[nodiscard]] virtual double clearance(View q) const = 0;
  /// As Checker::nearest_obstacle.
  [[nodiscard]] virtual std::optional<Proximity> nearest_obstacle(View q) const = 0;
  /// As Checker::contact.
  [[nodiscard]] virtual std::optional<Contact> contact(View q) const = 0;
  /// As Checker::invalid_radius.
  [[nodiscard]] virtual double invalid_radius(View q) const {
    static_cast<void>(q);
    return 0.0;
  }

 protected:
  /// Checks the configurations from a rank one after the other, up to the first that touches or the end of a batch.
  /// \param n  of the motion
  /// \param touches  whether the configuration at a rank does
  template <class Touches>
  static Batch one_by_one(std::uint32_t rank, std::uint32_t n, const Touches& touches) {
    constexpr std::uint32_t most = 32;
    const std::uint32_t count = std::min(n - rank, most);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (touches(rank + i)) return {i + 1, std::uint32_t{1} << i};
    }
    return {count, 0};
  }
};

}  // namespace trellis
