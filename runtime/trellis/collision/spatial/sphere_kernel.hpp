// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the kernels of manipulators share with the other sources: plain data, as planar/kernel.hpp says.

namespace trellis::kernel {

struct Lanes;

struct Ball {
  double x, y, z, radius;
};

/// A joint, as rows of four numbers: of a matrix of three columns and of a position, both in the parent's frame. The
/// joint's rows are origin + sin * once + (1 - cos) * twice, or, of a slide, origin + value * once.
struct alignas(32) JointRows {
  double origin[12] = {};  // NOLINT(modernize-avoid-c-arrays): as in Lanes
  double once[12] = {};    // NOLINT
  double twice[12] = {};   // NOLINT
};

/// A body of a manipulator and the joint that carries it. Matrices are row by row.
struct ChainBody {
  unsigned parent = 0;  ///< of lower number; the first body is the base
  bool slides = false;  ///< along `axis`; otherwise it turns
  /// Its joint carries a whole robot: the caller computes its frame, and its rates, before it calls a kernel.
  bool given = false;
  unsigned column = 0;  ///< of its joint's coordinate
  double multiplier = 1.0, offset = 0.0;
  double origin[9] = {};        // NOLINT(modernize-avoid-c-arrays): as in Lanes
  double once[9] = {};          // NOLINT: the turn's matrix is origin + sin * once + (1 - cos) * twice
  double twice[9] = {};         // NOLINT
  double position[3] = {};      // NOLINT: of the joint in the parent's frame
  double axis[3] = {};          // NOLINT: in the parent's frame, of a slide
  const Ball* balls = nullptr;  ///< the first one contains the others
  unsigned ball_count = 0;
  unsigned first_centre = 0;  ///< of its balls among those of all bodies
  // For one configuration.
  const JointRows* rows = nullptr;
  /// Its balls, eight that are near each other to a block: four lanes, the centre and the radius. Lanes after the last
  /// ball have NaN as radius.
  const Lanes* ball_blocks = nullptr;
  /// Of each block: the radius of a ball about the centre of its first one that contains all.
  const double* block_radii = nullptr;
  const unsigned* block_begin = nullptr;  ///< of each block its first ball in `balls`; then the number of all
  unsigned block_count = 0;
  unsigned first_block = 0;  ///< of its blocks among those of all bodies
  /// The solids that it can touch, from `reached_begin` to `reached_end` in Scene3::reached.
  unsigned reached_begin = 0, reached_end = 0;
};

/// A convex obstacle of space.
struct Solid3 {
  enum class Kind : unsigned char { sphere, box, cylinder, capsule };
  Kind kind = Kind::sphere;
  double r[9] = {};  // NOLINT: from the world to its frame
  double x = 0.0, y = 0.0, z = 0.0;
  double hx = 0.0, hy = 0.0, hz = 0.0;  ///< half extents of a box
  double radius = 0.0, length = 0.0;    ///< length: half of it
  double far = 0.0;                     ///< radius of a ball about its centre that contains it
};

/// Eight solids of one kind.
struct SolidBlock {
  Solid3::Kind kind = Solid3::Kind::sphere;
  unsigned solid[8] = {};  // NOLINT(modernize-avoid-c-arrays): the number of each
  /// 15 lanes: x, y, z, the nine of r, and hx, hy and hz of boxes, else radius and length. Lanes without a solid are
  /// far away.
  const Lanes* values = nullptr;
};

/// The balls of a cloud of points, all of one radius, with their centres in cubic cells.
struct Cloud3 {
  const Lanes* x = nullptr;  ///< of the centres, those of a cell after those of the cell before it
  const Lanes* y = nullptr;
  const Lanes* z = nullptr;
  const unsigned* begin = nullptr;  ///< of each cell the number of its first centre; then the number of all
  const float* clear = nullptr;     ///< no centre is nearer to any place in the cell than this
  double lo[3] = {}, hi[3] = {};    // NOLINT: the box of the centres; cells begin at lo
  double cell = 1.0, per_metre = 1.0;
  unsigned count[3] = {1, 1, 1};  // NOLINT: of cells along the axes
  double radius = 0.0;
};

/// Balls of a body that are compared with those of another body.
struct BallPart {
  unsigned body = 0;
  bool all = true;           ///< they are all balls of the body
  Ball whole = {};           ///< contains them
  unsigned first_block = 0;  ///< among the blocks of the body
  unsigned end_block = 0;
};

/// What a manipulator must not touch.
struct Scene3 {
  const Solid3* solids = nullptr;
  unsigned solid_count = 0;
  const SolidBlock* solid_blocks = nullptr;  ///< the same solids
  unsigned solid_block_count = 0;
  const Cloud3* clouds = nullptr;
  unsigned cloud_count = 0;
  unsigned cloud_lanes = 0xff;        ///< clouds are compared in these lanes
  const unsigned* reached = nullptr;  ///< solids, see ChainBody
  const BallPart* parts = nullptr;
  const unsigned* pairs = nullptr;  ///< two parts each, of different bodies; those of two bodies follow each other
  unsigned pair_count = 0;
  bool bounded = false;  ///< whether the balls must lie within lo and hi
  double lo[3] = {};     // NOLINT
  double hi[3] = {};     // NOLINT
  double slack = 0.0;    ///< a gap of at most this is contact
};

/// Memory of `touches`.
struct ChainMemory {
  Lanes* angles = nullptr;     ///< three for each eight bodies
  double* frames = nullptr;    ///< twelve numbers for each body, aligned as JointRows: rows of matrix and position
  unsigned* placed = nullptr;  ///< a number for each body: 1 for the first one, the base; then of the kernel
  Lanes* centres = nullptr;    ///< three for each block of balls
  /// The other bodies that have balls, in the order in which they are compared with the solids. A body that touches one
  /// moves up, for contact is likelier where it was before.
  unsigned* order = nullptr;
  unsigned order_count = 0;
  enum class Base : unsigned char { unknown, free, touches };
  Base base = Base::unknown;  ///< whether the base, which does not move, touches something of the world
};

/// A part of a motion on which the coordinates change at constant rates, seen from its middle.
struct ChainMotion {
  const double* change = nullptr;  ///< of each coordinate, from the middle to the end
  /// For each body: how far, in metres, the centres of its balls leave the straight lines that their velocities at the
  /// middle give, at most.
  const double* bend = nullptr;
  const double* pair_bend = nullptr;  ///< the same for each pair, of the difference of two centres
};

}  // namespace trellis::kernel
