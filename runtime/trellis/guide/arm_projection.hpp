// SPDX-License-Identifier: GPL-3.0-or-later
// f of an arm that is fixed to its base: the position of its tip. Its lift is inverse kinematics.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <trellis/guide/tip_projection.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// The kinematic chain of an arm that is fixed to its base. The tip is the end of its last link.
struct ArmChain {
  struct Link {
    std::size_t axis = 0;   ///< axis of the joint that turns it
    bool absolute = false;  ///< the axis is the angle in the world, not relative to the previous link
    double length = 0.0;    ///< from its joint to the next joint or to the tip; metres, > 0
    double bearing = 0.0;   ///< direction from its joint to the next joint or the tip, in the link's frame; radians
  };
  Vec2 base;
  std::vector<Link> links;  ///< at least two
  std::size_t body = 0;     ///< index of the robot's body that contains the tip
  Vec2 tip;                 ///< in that body's frame
};

/// The chain of an instance's robot. If the robot is no such arm, the reason, as the end of a sentence.
std::variant<ArmChain, std::string> arm_chain(const Instance& instance);

/// f: the position of the tip. `lift` draws the angles of the links from the base outwards, each uniformly among those
/// from which the remaining links can reach the position. The last two links have two solutions of equal probability.
///
/// S is a box and also contains positions that the arm cannot reach. `lift` reflects them, along the line through the
/// base, at the boundary of the reachable set. Joint limits may leave a position without a configuration; `lift`
/// detects this only by sampling, and then draws a uniform configuration.
class ArmProjection final : public TipProjection {
 public:
  ArmProjection(const Instance& parent, ArmChain chain);

  void project(View q, MutableView s) const override;
  void lift(View s, Stream& stream, MutableView q) const override;
  /// True without joint limits.
  [[nodiscard]] bool closed_form() const override { return !limited_; }
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] double folded(View s, const std::function<double(View)>& density) const override;

  [[nodiscard]] bool complete() const override { return true; }
  /// By the shortest motion, to a millionth of the arm's length.
  [[nodiscard]] bool follow(View s, MutableView q) const override { return bring(s, q, 1e-6 * rest_[0].most); }
  [[nodiscard]] const Space& space() const override { return space_; }
  /// A point in the reachable part of the world: the rest is an obstacle. Copies of a world share it.
  [[nodiscard]] std::shared_ptr<const Scene> point_scene() const override;
  /// Whether the arm could reach a position without joint limits.
  [[nodiscard]] bool reaches(View s) const override;

 private:
  /// Distances from a link's joint at which that link and the later ones can place the tip.
  struct Reach {
    double least = 0.0;
    double most = 0.0;
  };
  /// Directions whose angle to the direction of the tip's position, to either side, is in [least, most]; radians.
  struct Arc {
    double least = 0.0;
    double most = 0.0;
  };

  /// The directions of a link from which the later links reach a position `distance` metres from its joint.
  [[nodiscard]] Arc arc(std::size_t link, double distance) const;
  /// The reflection of a position into the set that the arm reaches without joint limits.
  [[nodiscard]] Vec2 reflected(Vec2 s) const;
  bool bring(View s, MutableView q, double near) const;
  /// Draws angles that place the tip at s. Returns false if joint limits prevent it.
  bool draw(Vec2 s, Stream& stream, MutableView q) const;
  /// The angle of a link's body at which the link points in a direction; radians.
  /// \param before  angle of the previous body, radians
  [[nodiscard]] double angle(std::size_t link, double direction, double before) const;
  /// Sets a link's joint to a direction; if its limits contain the direction in several turns, to any of them. Returns
  /// false if the limits exclude it.
  bool turn(std::size_t link, double direction, double before, Stream& stream, MutableView q) const;
  /// Draws a direction of a link, within its limits, from an arc about `towards`. Returns false if there is none.
  bool draw_direction(std::size_t link, const Arc& arc, double towards, double before, Stream& stream,
                      double& direction) const;

  std::shared_ptr<const Scene> scene_;
  ArmChain chain_;
  std::vector<Reach> rest_;  ///< for each link
  World world_;
  Space space_;
  bool limited_ = false;
  double log_others_ = 0.0;  ///< log density of the axes that are no joints of the arm, and of the joints' weights
  bool others_ = false;      ///< whether there are such axes
  double tolerance_ = 0.0;   ///< metres
  double farthest_ = 0.0;    ///< distance from the base to the farthest corner of S, metres
};

}  // namespace trellis
