// SPDX-License-Identifier: GPL-3.0-or-later
// The robot of the scenes, and its contact with obstacles, by plain separating axes.
#pragma once

#include <cmath>
#include <vector>

#include "rrt_bench.hpp"

namespace bench {

inline constexpr double half_length = robot_length / 2;
inline constexpr double half_width = robot_width / 2;

/// Where the robot stands.
struct Placed {
  double x, y, c, s;

  Placed(double px, double py, double theta) : x(px), y(py), c(std::cos(theta)), s(std::sin(theta)) {}

  // Half the sides of the box around the robot.
  [[nodiscard]] double extent_x() const { return std::abs(c) * half_length + std::abs(s) * half_width; }
  [[nodiscard]] double extent_y() const { return std::abs(s) * half_length + std::abs(c) * half_width; }

  /// The boundary is convex: the robot is inside when its corners are.
  [[nodiscard]] bool inside_boundary() const {
    return x - extent_x() >= 0 && x + extent_x() <= world_size && y - extent_y() >= 0 && y + extent_y() <= world_size;
  }
};

class Obstacles {
 public:
  virtual ~Obstacles() = default;
  [[nodiscard]] virtual bool touch(const Placed& robot) = 0;
};

/// Separating axes, one obstacle after the other: the world's two axes, then the robot's.
class AxesObstacles final : public Obstacles {
 public:
  explicit AxesObstacles(const Scene& scene) {
    for (const Rectangle& r : scene.obstacles) {
      boxes_.push_back({(r.xmin + r.xmax) / 2, (r.ymin + r.ymax) / 2, (r.xmax - r.xmin) / 2, (r.ymax - r.ymin) / 2});
    }
  }

  [[nodiscard]] bool touch(const Placed& robot) override {
    const double extent_x = robot.extent_x();
    const double extent_y = robot.extent_y();
    const double c = std::abs(robot.c);
    const double s = std::abs(robot.s);
    for (const Box& box : boxes_) {
      const double dx = box.x - robot.x;
      const double dy = box.y - robot.y;
      if (std::abs(dx) > extent_x + box.half_x || std::abs(dy) > extent_y + box.half_y) continue;
      if (std::abs(dx * robot.c + dy * robot.s) > half_length + c * box.half_x + s * box.half_y) continue;
      if (std::abs(dy * robot.c - dx * robot.s) > half_width + s * box.half_x + c * box.half_y) continue;
      return true;
    }
    return false;
  }

 private:
  struct Box {
    double x, y, half_x, half_y;
  };
  std::vector<Box> boxes_;
};

}  // namespace bench
