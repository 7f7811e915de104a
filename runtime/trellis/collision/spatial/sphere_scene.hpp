// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/collision/planar/kernel.hpp>
#include <trellis/collision/spatial/cloud_grid.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/obstacle_distance.hpp>

namespace trellis {

/// A rotation, row by row.
using Matrix3 = std::array<double, 9>;

Matrix3 times(const Matrix3& a, const Matrix3& b);
Matrix3 matrix_of(const Quaternion& q);

/// A rotation as a matrix, row by row, and a position.
struct BodyFrame {
  Matrix3 r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  Vec3 p;

  [[nodiscard]] Vec3 operator()(const Vec3& v) const {
    return {r[0] * v.x + r[1] * v.y + r[2] * v.z + p.x, r[3] * v.x + r[4] * v.y + r[5] * v.z + p.y,
            r[6] * v.x + r[7] * v.y + r[8] * v.z + p.z};
  }
};

/// A convex obstacle, whose distance is computed at once.
struct Primitive {
  enum class Kind : std::uint8_t { sphere, box, cylinder, capsule };
  Kind kind = Kind::sphere;
  Matrix3 r{};  ///< from the world to its frame
  Vec3 centre;
  Vec3 half;  ///< of a box
  double radius = 0.0;
  double length = 0.0;  ///< half of it
  double far = 0.0;     ///< radius of a ball about the centre that contains it
  std::size_t obstacle = 0;

  /// The distance of a point from its surface outside, 0 inside.
  [[nodiscard]] double distance(const Vec3& at) const {
    const Vec3 d = at - centre;
    if (kind == Kind::sphere) return std::max(norm(d) - radius, 0.0);
    const Vec3 u{r[0] * d.x + r[1] * d.y + r[2] * d.z, r[3] * d.x + r[4] * d.y + r[5] * d.z,
                 r[6] * d.x + r[7] * d.y + r[8] * d.z};
    switch (kind) {
      case Kind::box:
        return norm({std::max(std::abs(u.x) - half.x, 0.0), std::max(std::abs(u.y) - half.y, 0.0),
                     std::max(std::abs(u.z) - half.z, 0.0)});
      case Kind::cylinder: {
        const double across = std::max(std::sqrt(u.x * u.x + u.y * u.y) - radius, 0.0);
        const double along = std::max(std::abs(u.z) - length, 0.0);
        return std::sqrt(across * across + along * along);
      }
      default: {
        const double along = std::max(std::abs(u.z) - length, 0.0);
        return std::max(std::sqrt(u.x * u.x + u.y * u.y + along * along) - radius, 0.0);
      }
    }
  }
};

/// An obstacle that is a cloud of points.
struct PlacedCloud {
  std::shared_ptr<const PointCloud> cloud;
  Pose3 inverse;  ///< from the world to its frame
  std::size_t obstacle = 0;
  CloudGrid grid;

  /// The distance of a point from the nearest ball, at most 0 in contact; `at_most` where it is not less.
  [[nodiscard]] double distance(const Vec3& p, double at_most) const;
};

/// The obstacles of a world: those that are primitives, the clouds, and the meshes.
struct SolidObstacles {
  std::vector<Primitive> primitives;
  std::vector<PlacedCloud> clouds;
  std::optional<ObstacleDistance> meshes;
  std::vector<std::size_t> of_mesh;  ///< for each mesh its obstacle
};

/// A body's joint: its frame is that of its parent times origin + sin * once + (1 - cos) * twice.
struct JointTurn {
  Matrix3 origin{};
  Matrix3 once{};
  Matrix3 twice{};
};

/// A joint that moves a body.
struct Lever {
  std::size_t joint = 0;  ///< the body that the joint carries directly
  double length = 0.0;    ///< the farthest that centres of the body's balls are from the joint's axis, in metres
};

/// A robot's balls as the kernels read them: kernel::ChainBody says what.
struct KernelBalls {
  std::vector<kernel::Ball> balls;    ///< those of each body after those of the body before it, by block
  std::vector<kernel::Lanes> blocks;  ///< four of each block
  std::vector<double> radii;          ///< of each block
  std::vector<unsigned> first_block;  ///< of each body; then the number of all
  std::vector<unsigned> block_begin;  ///< of each body so many as it has blocks, and one more
  std::vector<kernel::BallPart> parts;
};

/// What the checkers of a manipulator in a world share: it costs more to make than an easy search.
class SphereScene {
 public:
  SphereScene(const ManipulatorScene& scene, double slack);
  SphereScene(const SphereScene&) = delete;
  SphereScene& operator=(const SphereScene&) = delete;
  SphereScene(SphereScene&&) = default;
  SphereScene& operator=(SphereScene&&) = delete;
  ~SphereScene() = default;

  /// Returns that of a scene, for all threads: made at the first call.
  static std::shared_ptr<const SphereScene> of(const std::shared_ptr<const Scene>& scene, double slack);

  /// A bound on how far the centres of a body's balls move.
  /// \param change  of the coordinates
  [[nodiscard]] double longest_path(std::size_t body, View change) const;
  /// A bound on how far the centres of a body's balls leave straight lines, seen from the body that some of its joints
  /// begin at: half the largest norm of the second derivative, the sum over joints j and k of the product of their
  /// rates and the lever of the outer one.
  /// \param joints  so many, the outermost first
  /// \param change  of the coordinates, to either side
  [[nodiscard]] double bend(std::size_t body, std::size_t joints, View change) const;

  [[nodiscard]] const SolidObstacles& obstacles() const { return *obstacles_; }
  /// For each body.
  [[nodiscard]] const std::vector<JointTurn>& turns() const { return turns_; }
  /// For each body with balls its joints, the outermost first.
  [[nodiscard]] const std::vector<std::vector<Lever>>& levers() const { return levers_; }
  /// For each pair so many joints of either body, which the other one does not have.
  [[nodiscard]] const std::vector<std::pair<std::size_t, std::size_t>>& unshared() const { return unshared_; }

  /// The bodies whose joints carry whole robots; the base carries them.
  [[nodiscard]] const std::vector<std::size_t>& roots() const { return roots_; }
  /// Whether the kernels decide: without meshes.
  [[nodiscard]] bool batched() const { return batched_; }
  // What the kernels read.
  [[nodiscard]] const std::vector<kernel::ChainBody>& chain() const { return chain_; }
  [[nodiscard]] const kernel::Scene3& kernel_scene() const { return scene_; }
  [[nodiscard]] std::size_t ball_count() const { return balls_->balls.size(); }
  /// The memory that kernels of eight configurations need: numbers of solids, twice, and one of each block.
  [[nodiscard]] std::size_t scratch_count() const { return 2 * solids_.size() + block_count(); }
  /// Blocks of balls of all bodies.
  [[nodiscard]] std::size_t block_count() const { return balls_->radii.size(); }

 private:
  void add_turns();
  void add_levers();
  void make_batches(const World3& world, double slack);
  void list_reached(double slack);
  void add_rows();
  void add_solid_blocks();

  SphereModel model_;
  std::shared_ptr<const SolidObstacles> obstacles_;
  std::vector<JointTurn> turns_;
  std::vector<std::vector<Lever>> levers_;
  std::vector<std::pair<std::size_t, std::size_t>> unshared_;
  std::vector<std::size_t> roots_;
  bool batched_ = false;
  std::shared_ptr<const KernelBalls> balls_;
  std::vector<kernel::ChainBody> chain_;
  std::vector<kernel::JointRows> rows_;
  std::vector<kernel::Solid3> solids_;
  std::vector<kernel::SolidBlock> solid_blocks_;
  std::vector<kernel::Lanes> solid_values_;
  std::vector<kernel::Cloud3> clouds_;
  std::vector<unsigned> reached_;
  std::vector<unsigned> pairs_;
  kernel::Scene3 scene_;
};

/// The memory of the kernel of one configuration.
class ConfigurationMemory {
 public:
  /// \param base  the frame of the first body
  ConfigurationMemory(const SphereScene& scene, const BodyFrame& base);
  ConfigurationMemory(const ConfigurationMemory&) = delete;
  ConfigurationMemory& operator=(const ConfigurationMemory&) = delete;
  ConfigurationMemory(ConfigurationMemory&&) = delete;
  ConfigurationMemory& operator=(ConfigurationMemory&&) = delete;
  ~ConfigurationMemory() = default;

  [[nodiscard]] kernel::ChainMemory& get() { return memory_; }
  /// Sets the frame of a body whose joint carries a whole robot.
  void set(std::size_t body, const BodyFrame& frame);

 private:
  /// A frame by rows, as kernel::JointRows.
  struct alignas(32) Rows {
    std::array<double, 12> of{};
  };

  std::vector<kernel::Lanes> angles_;
  std::vector<Rows> frames_;
  std::vector<unsigned> placed_;
  std::vector<kernel::Lanes> centres_;
  std::vector<unsigned> order_;
  kernel::ChainMemory memory_;
};

}  // namespace trellis
