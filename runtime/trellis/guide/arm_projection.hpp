// SPDX-License-Identifier: GPL-3.0-or-later
// f of an arm that is fixed to its base: the position of its tip. Inverse kinematics is the lift.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <trellis/guide/lifted.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// The joints of an arm that is fixed to its base, one after another, up to its tip: the end of its last link.
struct ArmChain {
  struct Link {
    std::size_t axis = 0;   ///< that turns it
    bool absolute = false;  ///< the axis has the angle in the world, not relative to the link before
    double length = 0.0;    ///< from its joint to the next one, or to the tip; metres, > 0
    double bearing = 0.0;   ///< direction of that in the link's frame, radians
  };
  Vec2 base;
  std::vector<Link> links;  ///< two or more
  std::size_t body = 0;     ///< of the robot, that the tip belongs to
  Vec2 tip;                 ///< in the frame of that body
};

/// The chain of the arm that an instance's robot is; or why it is none, as the rest of a sentence.
std::variant<ArmChain, std::string> arm_chain(const Instance& instance);

/// f: the position of the tip. lift draws the angles of the links from the base on, each uniform among those from which
/// the rest of the arm reaches the position; the last two links have two solutions, each as likely as the other.
///
/// S is a box and holds positions that the arm does not reach. lift reflects them, along the line through the base, at
/// the border of what it reaches. Limits of joints may leave a position without a configuration, which is not known
/// before some were drawn; then lift draws a uniform one.
class ArmProjection final : public Projection {
 public:
  ArmProjection(const Instance& parent, ArmChain chain);

  void project(View q, MutableView s) const override;
  void lift(View s, Stream& stream, MutableView q) const override;
  /// Without limits of joints.
  [[nodiscard]] bool closed_form() const override { return !limited_; }
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] double folded(View s, const std::function<double(View)>& density) const override;

  /// Moves q, along the least way in the metric and within limits of joints, until f(q) is s to within a millionth of
  /// the arm's length; whether it got there.
  [[nodiscard]] bool follow(View s, MutableView q) const { return bring(s, q, 1e-6 * rest_[0].most); }
  [[nodiscard]] const Space& space() const { return space_; }
  /// The world as far as the arm reaches: what lies beyond is an obstacle. Copies of a world share it.
  [[nodiscard]] const World& world() const { return world_; }
  /// Whether the arm without limits of joints reaches a position.
  [[nodiscard]] bool reaches(View s) const;
  /// A path in S as configurations near the straight motion from `start` to `goal`.
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const override;

 private:
  /// Of the links from one on: distances from its joint at which they can bring the tip.
  struct Reach {
    double least = 0.0;
    double most = 0.0;
  };
  /// Directions at an angle of `least` to `most`, to either side, from that to the tip's position.
  struct Arc {
    double least = 0.0;
    double most = 0.0;
  };

  /// Directions of a link from which the links after it reach a position `distance` from its joint.
  [[nodiscard]] Arc arc(std::size_t link, double distance) const;
  /// The nearest position that the arm reaches without limits of joints, by reflection.
  [[nodiscard]] Vec2 reflected(Vec2 s) const;
  bool bring(View s, MutableView q, double near) const;
  /// Draws angles that bring the tip to s; false where limits prevent it.
  bool draw(Vec2 s, Stream& stream, MutableView q) const;
  /// The angle of a link's body from which it points in a direction.
  /// \param before  angle of the body before it
  [[nodiscard]] double angle(std::size_t link, double direction, double before) const;
  /// Sets the axis of a link for a direction; false where limits exclude it.
  bool turn(std::size_t link, double direction, double before, MutableView q) const;
  /// Draws a direction of a link from an arc about `towards`, within its limits; false where these leave none.
  bool draw_direction(std::size_t link, const Arc& arc, double towards, double before, Stream& stream,
                      double& direction) const;

  Space parent_;
  std::shared_ptr<const Scene> scene_;
  ArmChain chain_;
  std::vector<Reach> rest_;  ///< of each link
  World world_;
  Space space_;
  bool limited_ = false;
  double log_others_ = 0.0;  ///< log density of the axes that are no joints of the arm, and of the joints' weights
  bool others_ = false;      ///< whether there are such axes
  double tolerance_ = 0.0;   ///< metres
  double farthest_ = 0.0;    ///< distance of a corner of S from the base
};

}  // namespace trellis
