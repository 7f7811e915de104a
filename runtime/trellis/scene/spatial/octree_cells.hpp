// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include <trellis/scene/cells.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// Boxes of the free space of a world, the leaves of an octree. Each is free for certain: its centre is farther from
/// obstacles (and from bounds that contain the robot, see FreeDistance) than its corners are from the centre.
class OctreeCells final : public Cells {
 public:
  /// The largest number of cells, and the largest number of divisions of the first ones.
  static constexpr std::size_t most_cells = 20'000;
  static constexpr int most_divisions = 4;

  /// \param size  the longest side of the first cells, metres
  /// \param needed  cells are divided until points with at least this distance from obstacles are in one, metres
  /// \throws Error where the first cells are more than most_cells
  OctreeCells(const World3& world, double size, double needed);

  [[nodiscard]] std::size_t size() const override { return leaves_.size(); }
  [[nodiscard]] double volume(std::uint32_t cell) const override {
    const Box3 box = this->box(cell);
    return (box.hi.x - box.lo.x) * (box.hi.y - box.lo.y) * (box.hi.z - box.lo.z);
  }
  [[nodiscard]] double volume() const override { return volume_; }
  [[nodiscard]] double importance(std::uint32_t) const override { return 1.0; }
  void centre(std::uint32_t cell, MutableView out) const override;
  [[nodiscard]] const std::vector<Neighbour>& neighbours(std::uint32_t cell) const override {
    return neighbours_[cell];
  }
  [[nodiscard]] std::optional<std::uint32_t> find(View p) const override;
  void sample(std::uint32_t cell, Stream& stream, MutableView out) const override;

  [[nodiscard]] Box3 box(std::uint32_t cell) const;
  /// Returns the sides of the smallest cells that were looked for.
  [[nodiscard]] const Vec3& smallest() const { return smallest_; }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  struct Node {
    Vec3 centre;
    int divisions = 0;              ///< of a first cell that make this one
    std::uint32_t children = none;  ///< the first of eight nodes
    std::uint32_t cell = none;      ///< of a free leaf
  };

  [[nodiscard]] Vec3 half(int divisions) const {
    return (1.0 / static_cast<double>(1U << static_cast<unsigned>(divisions))) * half_;
  }
  /// The leaf of the tree that contains a point of the bounds.
  [[nodiscard]] std::uint32_t leaf_at(const Vec3& p) const;
  void join();

  Box3 bounds_;
  std::array<std::size_t, 3> counts_{};  ///< first cells along x, y and z
  Vec3 half_;                            ///< sides of a first cell
  Vec3 smallest_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaves_;  ///< for each cell its node
  double volume_ = 0.0;
  std::vector<std::vector<Neighbour>> neighbours_;
};

}  // namespace trellis
