// SPDX-License-Identifier: GPL-3.0-or-later
// A judge of paths that shares nothing with collision checking, for the law that a reported path is valid everywhere,
// between its points too.
//
// The motions of a point are segments: exact arithmetic decides. For other robots the judge halves the parameters of a
// motion. In an interval the robot is free of an obstacle where their distance in the middle exceeds a bound on the
// displacement of the robot's points from there. It computes distances with brute force, in long double: in the plane
// between edges, in space from a separating direction, which it verifies.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis::test {

enum class Verdict {
  free,       ///< no contact anywhere
  hit,        ///< a configuration in contact or outside of the boundary
  undecided,  ///< contact within the touching slack, which counts as either; or too many intervals
};

struct Judgement {
  Verdict verdict = Verdict::free;
  std::size_t leg = 0;  ///< the motion from point `leg` to the next one
  double at = 0.0;      ///< its parameter
  std::string what;     ///< of a hit: what the robot touches
};

/// Judges the motions of a robot in a world: straight in the space, circles by the shorter direction, rotations at
/// constant speed. A turn of half a period has two shortest motions, and a path does not say which: both must be free.
class PathJudge {
 public:
  /// \param bodies  of a planar robot: its shapes as the test gave them, body by body; empty: its convex parts
  PathJudge(std::shared_ptr<const Scene> scene, Space space, std::vector<std::vector<Shape>> bodies = {});
  ~PathJudge();
  PathJudge(const PathJudge&) = delete;
  PathJudge(PathJudge&&) = delete;
  PathJudge& operator=(const PathJudge&) = delete;
  PathJudge& operator=(PathJudge&&) = delete;

  [[nodiscard]] Judgement motion(View a, View b) const;
  /// Returns the first judgement of a motion that is not free.
  [[nodiscard]] Judgement path(const Configurations& path) const;
  /// Returns a hit where the robot comes nearer to contact than 99 percent of `clearance` metres on the path.
  [[nodiscard]] Judgement nearer(const Configurations& path, double clearance) const;
  /// Whether the robot at q is farther than `gap` metres from contact.
  [[nodiscard]] bool clear(View q, double gap) const;

  struct Work;

 private:
  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<const Work> work_;
};

}  // namespace trellis::test
