// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/collision/spatial/sphere_kernel.hpp>

// The interface between the separating-axis kernels and the other sources: plain data and a table of functions. The
// compiler builds the kernel sources for other instruction sets than the rest. So this header must not include an
// inline function: the linker could pick the kernel's copy for the whole program.

namespace trellis::kernel {

/// Poses that a kernel checks in one step.
inline constexpr unsigned lanes = 8;
/// The largest angle, in radians, at which the kernels' sine and cosine are accurate.
inline constexpr double largest_angle = 1e5;

/// One number for each pose.
struct alignas(64) Lanes {
  double v[lanes];  // NOLINT(modernize-avoid-c-arrays): a container would bring inline functions
};

struct Poses {
  Lanes x, y, c, s;
};

/// The poses of one rigid body on a straight motion: start + share * difference; share 1 gives the end exactly.
struct Line {
  double x = 0.0, y = 0.0, angle = 0.0;                       ///< the start
  double difference_x = 0.0, difference_y = 0.0, turn = 0.0;  ///< from the start to the end
  double end_x = 0.0, end_y = 0.0, end_angle = 0.0;           ///< the end
  double joint_x = 0.0, joint_y = 0.0;                        ///< added to every position
  bool turns = false;                                         ///< otherwise all angles are 0
};

/// An edge of a convex counter-clockwise polygon: from (x, y), `length` along (-ny, nx).
struct Edge {
  double x, y;
  double nx, ny;  ///< the outward unit normal
  double offset;  ///< points p of the polygon have n.p <= offset
  double length;
};

enum class Kind : unsigned { rectangle, disc, polygon };

/// A convex piece: of a robot in its body's frame, of an obstacle in the world's. One record per piece, because the
/// lanes are poses: a kernel broadcasts the numbers of one piece to all lanes.
struct Piece {
  Kind kind = Kind::disc;
  unsigned edge_count = 0;      ///< of a polygon
  const Edge* edges = nullptr;  ///< of a polygon
  double x = 0.0, y = 0.0;      ///< centre of a rectangle or disc
  double hx = 0.0, hy = 0.0;    ///< half extents of an axis-aligned rectangle
  double radius = 0.0;          ///< of a disc
  double xlo = 0.0, xhi = 0.0;  ///< the bounding box
  double ylo = 0.0, yhi = 0.0;
};

/// A vertex of a robot's polygon at eight poses, and the normal of the edge that begins there.
struct Corner {
  Lanes x, y, nx, ny;
};

/// A piece of a robot at eight poses.
struct Placed {
  Lanes x, y, c, s;           ///< position of its centre (a polygon's frame), cosine and sine of its angle
  Lanes xlo, xhi, ylo, yhi;   ///< the bounding box
  Corner* corners = nullptr;  ///< of a polygon: memory for edge_count of them
};

struct Box {
  double xlo, xhi, ylo, yhi;
};

/// The kernels of one instruction set. Masks have a bit for each lane. All tables give bitwise equal results.
struct Table {
  const char* name;
  /// Computes the poses at eight parameters of the line.
  void (*poses)(const Line& line, const double* shares, Poses& out);
  void (*place)(const Poses& poses, const Piece& piece, Placed& out);
  /// Returns the lanes in which the piece is not completely inside the box.
  unsigned (*outside)(const Placed& placed, const Box& box);
  /// Returns the lanes in which the piece touches one of the listed obstacles. Stops early once the first lane does.
  unsigned (*collide)(const Placed& placed, const Piece& piece, const Piece* obstacles, const unsigned* candidates,
                      unsigned count);
  /// Computes the frames of a manipulator's bodies: twelve lanes each, the matrix row by row and the position. Those of
  /// the first one, the base, are given.
  /// \param values  of the coordinates
  void (*move_chain)(const ChainBody* bodies, unsigned count, const Lanes* values, Lanes* frames);
  /// Returns the lanes in which a manipulator touches something. Stops early once the first lane does; lanes after the
  /// first may lack what touches a cloud.
  /// \param centres  memory for three lanes of each ball
  /// \param scratch  memory for two numbers of each solid and one of each block of balls
  unsigned (*meet_chain)(const ChainBody* bodies, unsigned count, const Lanes* frames, const Scene3& scene,
                         Lanes* centres, unsigned* scratch);
  /// Whether a manipulator touches something at one configuration. The answer is that of meet_chain.
  /// \param values  of the coordinates
  /// \param memory  frames of the first body, the base, are given
  bool (*touches)(const ChainBody* bodies, unsigned count, const double* values, const Scene3& scene,
                  ChainMemory& memory);
  /// Computes how a manipulator's bodies move: six lanes each, the turn's rate and the velocity of the frame's origin.
  /// \param change  of each coordinate, in a unit of time
  void (*rate_chain)(const ChainBody* bodies, unsigned count, const Lanes* frames, const double* change, Lanes* rates);
  /// Returns the lanes in which a manipulator may come nearer than `scene.slack` to something on a part of a motion;
  /// in the others it certainly does not. Stops early once it may in all of them.
  /// \param rates  for motion.change
  unsigned (*approach_chain)(const ChainBody* bodies, unsigned count, const Lanes* frames, const Lanes* rates,
                             const Scene3& scene, const ChainMotion& motion, Lanes* centres, unsigned* scratch);
  /// Computes the least distance of a manipulator from everything.
  /// \param scratch  as meet_chain
  /// \param least  on entry what the distances are at most; then the least one, at most 0 in contact
  /// \param sure   on entry as `least`; then a lower bound on the distance on the part of the motion
  void (*measure_chain)(const ChainBody* bodies, unsigned count, const Lanes* frames, const Lanes* rates,
                        const Scene3& scene, const ChainMotion& motion, Lanes* centres, unsigned* scratch, Lanes& least,
                        Lanes& sure);
};

extern const Table baseline;
#if defined(__x86_64__)
extern const Table avx2;
extern const Table avx512;
#endif

/// Returns the tables that this processor can run, the fastest last. Writes their number to `count`.
const Table* const* available(unsigned& count);
/// Returns the fastest of them, or the one that the environment variable TRELLIS_KERNEL names (baseline, avx2, avx512).
/// \throws Error if the processor has no such one.
const Table& best();

}  // namespace trellis::kernel
