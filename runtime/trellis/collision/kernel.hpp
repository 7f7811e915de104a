// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the separating-axis kernels share with the rest: plain data and a table of functions. The kernel sources are
// compiled with other instruction sets than the rest, so nothing here may pull in an inline function that the linker
// could take from them.

namespace trellis::kernel {

/// Poses that are looked at in one step.
inline constexpr unsigned lanes = 8;
/// The largest angle, in radians, that the kernels' own sine and cosine are accurate for.
inline constexpr double largest_angle = 1e5;

/// One number for each pose.
struct alignas(64) Lanes {
  double v[lanes];  // NOLINT(modernize-avoid-c-arrays): a container would bring inline functions
};

struct Poses {
  Lanes x, y, c, s;
};

/// The poses of one rigid body on a straight motion: start + share * way, the end taken exactly at share 1.
struct Line {
  double x = 0.0, y = 0.0, angle = 0.0;              ///< the start
  double way_x = 0.0, way_y = 0.0, turn = 0.0;       ///< from the start to the end
  double end_x = 0.0, end_y = 0.0, end_angle = 0.0;  ///< the end
  double joint_x = 0.0, joint_y = 0.0;               ///< added to every position
  bool turns = false;                                ///< otherwise all angles are 0
};

/// An edge of a convex counter-clockwise polygon: from (x, y), `length` along (-ny, nx).
struct Edge {
  double x, y;
  double nx, ny;  ///< the unit normal outward
  double offset;  ///< points p of the polygon have n.p <= offset
  double length;
};

enum class Kind : unsigned { rectangle, disc, polygon };

/// A convex piece: of a robot in its body's frame, of an obstacle in the world's. One record per piece, because the
/// lanes are poses: a kernel spreads the numbers of one piece over all lanes.
struct Piece {
  Kind kind = Kind::disc;
  unsigned edge_count = 0;      ///< of a polygon
  const Edge* edges = nullptr;  ///< of a polygon
  double x = 0.0, y = 0.0;      ///< centre of a rectangle or disc
  double hx = 0.0, hy = 0.0;    ///< half extents of an axis-aligned rectangle
  double radius = 0.0;          ///< of a disc
  double xlo = 0.0, xhi = 0.0;  ///< the box around it
  double ylo = 0.0, yhi = 0.0;
};

/// A corner of a robot's polygon at eight poses, and the normal of the edge that begins there.
struct Corner {
  Lanes x, y, nx, ny;
};

/// A piece of a robot at eight poses.
struct Placed {
  Lanes x, y, c, s;           ///< where its centre (a polygon's frame) lies, and how it is turned
  Lanes xlo, xhi, ylo, yhi;   ///< the box around it
  Corner* corners = nullptr;  ///< of a polygon: room for edge_count of them
};

struct Box {
  double xlo, xhi, ylo, yhi;
};

/// The kernels of one instruction set. Masks have a bit for each lane. Every table gives the same bits.
struct Table {
  const char* name;
  /// The poses at eight shares of the line.
  void (*poses)(const Line& line, const double* shares, Poses& out);
  void (*place)(const Poses& poses, const Piece& piece, Placed& out);
  /// The lanes in which the piece is not wholly inside the box.
  unsigned (*outside)(const Placed& placed, const Box& box);
  /// The lanes in which the piece touches one of the obstacles named. Stops early once the first lane does.
  unsigned (*collide)(const Placed& placed, const Piece& piece, const Piece* obstacles, const unsigned* candidates,
                      unsigned count);
};

extern const Table baseline;
#if defined(__x86_64__)
extern const Table avx2;
extern const Table avx512;
#endif

/// The tables that this processor can run, the fastest last. `count` receives how many.
const Table* const* available(unsigned& count);
/// The fastest of them.
const Table& best();

}  // namespace trellis::kernel
