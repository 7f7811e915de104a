// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels, written once against eight-lane numbers V and masks M of the including source, in its unnamed
// namespace. Only operations that every instruction set rounds alike are used, so all tables give the same bits.

/// Computes sine and cosine to about one unit in the last place for |angle| <= largest_angle: reduces the angle to a
/// quarter turn with pi/2 in three parts, then evaluates the polynomials of fdlibm.
inline void sine_cosine(const V& angle, V& sine, V& cosine) {
  // Adding and subtracting 1.5 * 2^52 rounds to the nearest integer.
  const V to_integer = spread(6755399441055744.0);
  const V quarters = (angle * spread(6.36619772367581382433e-01) + to_integer) - to_integer;
  V r = angle - quarters * spread(1.57079632673412561417e+00);
  r = r - quarters * spread(6.07710050630396597660e-11);
  r = r - quarters * spread(2.02226624879595063154e-21);
  const V z = r * r;
  // Evaluates the polynomials by pairs of terms: a shorter dependency chain than Horner's scheme.
  const V z2 = z * z;
  const V s56 = spread(-2.50507602534068634195e-08) + z * spread(1.58969099521155010221e-10);
  const V s34 = spread(-1.98412698298579493134e-04) + z * spread(2.75573137070700676789e-06);
  const V s12 = spread(-1.66666666666666324348e-01) + z * spread(8.33333333332248946124e-03);
  const V sin_r = r + (r * z) * (s12 + z2 * (s34 + z2 * s56));
  const V c56 = spread(2.08757232129817482790e-09) + z * spread(-1.13596475577881948265e-11);
  const V c34 = spread(2.48015872894767294178e-05) + z * spread(-2.75573143513906633035e-07);
  const V c12 = spread(4.16666666666666019037e-02) + z * spread(-1.38888888888741095749e-03);
  const V half = spread(0.5) * z;
  const V near = spread(1.0) - half;
  const V cos_r = near + (((spread(1.0) - near) - half) + z2 * (c12 + z2 * (c34 + z2 * c56)));
  // The quadrant, as -2, -1, 0, 1 or 2.
  const V quarter = quarters - spread(4.0) * ((quarters * spread(0.25) + to_integer) - to_integer);
  const M odd = equal(abs(quarter), spread(1.0));
  const M back = equal(abs(quarter), spread(2.0));
  sine = negative_where(back | equal(quarter, spread(-1.0)), select(odd, cos_r, sin_r));
  cosine = negative_where(back | equal(quarter, spread(1.0)), select(odd, sin_r, cos_r));
}

void poses_of(const Line& line, const double* shares, Poses& out) {
  const V share = load(shares);
  const M last = equal(share, spread(1.0));
  const V x = select(last, spread(line.end_x), spread(line.x) + share * spread(line.difference_x));
  const V y = select(last, spread(line.end_y), spread(line.y) + share * spread(line.difference_y));
  store(out.x.v, x + spread(line.joint_x));
  store(out.y.v, y + spread(line.joint_y));
  V c = spread(1.0);
  V s = spread(0.0);
  if (line.turns) {
    sine_cosine(select(last, spread(line.end_angle), spread(line.angle) + share * spread(line.turn)), s, c);
  }
  store(out.c.v, c);
  store(out.s.v, s);
}

void place(const Poses& poses, const Piece& piece, Placed& out) {
  const V px = load(poses.x.v);
  const V py = load(poses.y.v);
  const V c = load(poses.c.v);
  const V s = load(poses.s.v);
  store(out.c.v, c);
  store(out.s.v, s);
  if (piece.kind == Kind::polygon) {
    store(out.x.v, px);
    store(out.y.v, py);
    V xlo = spread(0.0);
    V xhi = xlo;
    V ylo = xlo;
    V yhi = xlo;
    for (unsigned k = 0; k < piece.edge_count; ++k) {
      const Edge& e = piece.edges[k];
      const V x = px + (c * spread(e.x) - s * spread(e.y));
      const V y = py + (s * spread(e.x) + c * spread(e.y));
      Corner& corner = out.corners[k];
      store(corner.x.v, x);
      store(corner.y.v, y);
      store(corner.nx.v, c * spread(e.nx) - s * spread(e.ny));
      store(corner.ny.v, s * spread(e.nx) + c * spread(e.ny));
      xlo = k == 0 ? x : min(xlo, x);
      xhi = k == 0 ? x : max(xhi, x);
      ylo = k == 0 ? y : min(ylo, y);
      yhi = k == 0 ? y : max(yhi, y);
    }
    store(out.xlo.v, xlo);
    store(out.xhi.v, xhi);
    store(out.ylo.v, ylo);
    store(out.yhi.v, yhi);
    return;
  }
  const V x = px + (c * spread(piece.x) - s * spread(piece.y));
  const V y = py + (s * spread(piece.x) + c * spread(piece.y));
  V ex = spread(piece.radius);
  V ey = ex;
  if (piece.kind == Kind::rectangle) {
    ex = spread(piece.hx) * abs(c) + spread(piece.hy) * abs(s);
    ey = spread(piece.hx) * abs(s) + spread(piece.hy) * abs(c);
  }
  store(out.x.v, x);
  store(out.y.v, y);
  store(out.xlo.v, x - ex);
  store(out.xhi.v, x + ex);
  store(out.ylo.v, y - ey);
  store(out.yhi.v, y + ey);
}

unsigned outside(const Placed& placed, const Box& box) {
  const M inside = (spread(box.xlo) <= load(placed.xlo.v)) & (load(placed.xhi.v) <= spread(box.xhi)) &
                   (spread(box.ylo) <= load(placed.ylo.v)) & (load(placed.yhi.v) <= spread(box.yhi));
  return ~bits(inside) & 0xffU;
}

/// Returns the lanes in which the two boxes are disjoint.
inline M boxes_apart(const Placed& p, const Piece& o) {
  return (spread(o.xhi) < load(p.xlo.v)) | (load(p.xhi.v) < spread(o.xlo)) | (spread(o.yhi) < load(p.ylo.v)) |
         (load(p.yhi.v) < spread(o.ylo));
}

/// Returns the lanes in which the point lies in the polygon or within the square root of `radius2` of it.
inline unsigned near_polygon(const V& px, const V& py, const V& radius2, const Piece& polygon) {
  M out = nowhere();
  M near = nowhere();
  for (unsigned k = 0; k < polygon.edge_count; ++k) {
    const Edge& e = polygon.edges[k];
    const V nx = spread(e.nx);
    const V ny = spread(e.ny);
    out = out | (spread(e.offset) < nx * px + ny * py);
    const V rx = px - spread(e.x);
    const V ry = py - spread(e.y);
    const V along = min(max(ry * nx - rx * ny, spread(0.0)), spread(e.length));
    const V qx = rx + along * ny;
    const V qy = ry - along * nx;
    near = near | ((qx * qx + qy * qy) <= radius2);
  }
  return (~bits(out) | bits(near)) & 0xffU;
}

inline unsigned rectangle_rectangle(const Placed& p, const Piece& piece, const Piece& o) {
  const V c = load(p.c.v);
  const V s = load(p.s.v);
  const V dx = spread(o.x) - load(p.x.v);
  const V dy = spread(o.y) - load(p.y.v);
  const V hx = spread(o.hx);
  const V hy = spread(o.hy);
  const V u = abs(dx * c + dy * s);
  const V v = abs(dy * c - dx * s);
  const M apart = boxes_apart(p, o) | ((spread(piece.hx) + (hx * abs(c) + hy * abs(s))) < u) |
                  ((spread(piece.hy) + (hx * abs(s) + hy * abs(c))) < v);
  return ~bits(apart) & 0xffU;
}

inline unsigned rectangle_disc(const Placed& p, const Piece& piece, const Piece& o) {
  const V c = load(p.c.v);
  const V s = load(p.s.v);
  const V dx = spread(o.x) - load(p.x.v);
  const V dy = spread(o.y) - load(p.y.v);
  const V u = max(abs(dx * c + dy * s) - spread(piece.hx), spread(0.0));
  const V v = max(abs(dy * c - dx * s) - spread(piece.hy), spread(0.0));
  return bits((u * u + v * v) <= spread(o.radius * o.radius));
}

inline unsigned rectangle_polygon(const Placed& p, const Piece& piece, const Piece& o) {
  M apart = boxes_apart(p, o);
  if (bits(apart) == 0xffU) return 0;
  const V c = load(p.c.v);
  const V s = load(p.s.v);
  const V x = load(p.x.v);
  const V y = load(p.y.v);
  const V hx = spread(piece.hx);
  const V hy = spread(piece.hy);
  V ulo = spread(0.0);
  V uhi = ulo;
  V vlo = ulo;
  V vhi = ulo;
  for (unsigned k = 0; k < o.edge_count; ++k) {
    const Edge& e = o.edges[k];
    const V nx = spread(e.nx);
    const V ny = spread(e.ny);
    const V reach = hx * abs(c * nx + s * ny) + hy * abs(c * ny - s * nx);
    apart = apart | (spread(e.offset) + reach < nx * x + ny * y);
    const V dx = spread(e.x) - x;
    const V dy = spread(e.y) - y;
    const V u = dx * c + dy * s;
    const V v = dy * c - dx * s;
    ulo = k == 0 ? u : min(ulo, u);
    uhi = k == 0 ? u : max(uhi, u);
    vlo = k == 0 ? v : min(vlo, v);
    vhi = k == 0 ? v : max(vhi, v);
  }
  const V zero = spread(0.0);
  apart = apart | (hx < ulo) | (uhi < zero - hx) | (hy < vlo) | (vhi < zero - hy);
  return ~bits(apart) & 0xffU;
}

inline unsigned disc_rectangle(const Placed& p, const Piece& piece, const Piece& o) {
  const V x = load(p.x.v);
  const V y = load(p.y.v);
  const V zero = spread(0.0);
  const V dx = max(max(spread(o.xlo) - x, x - spread(o.xhi)), zero);
  const V dy = max(max(spread(o.ylo) - y, y - spread(o.yhi)), zero);
  return bits((dx * dx + dy * dy) <= spread(piece.radius * piece.radius));
}

inline unsigned disc_disc(const Placed& p, const Piece& piece, const Piece& o) {
  const V dx = spread(o.x) - load(p.x.v);
  const V dy = spread(o.y) - load(p.y.v);
  const double reach = piece.radius + o.radius;
  return bits((dx * dx + dy * dy) <= spread(reach * reach));
}

inline unsigned disc_polygon(const Placed& p, const Piece& piece, const Piece& o) {
  if (bits(boxes_apart(p, o)) == 0xffU) return 0;
  return near_polygon(load(p.x.v), load(p.y.v), spread(piece.radius * piece.radius), o);
}

/// Returns the lanes in which an edge of the robot's polygon separates it from the obstacle's box.
inline unsigned polygon_rectangle(const Placed& p, const Piece& piece, const Piece& o) {
  M apart = boxes_apart(p, o);
  if (bits(apart) == 0xffU) return 0;
  const V dx = spread(o.x) - load(p.x.v);
  const V dy = spread(o.y) - load(p.y.v);
  for (unsigned k = 0; k < piece.edge_count; ++k) {
    const V nx = load(p.corners[k].nx.v);
    const V ny = load(p.corners[k].ny.v);
    const V reach = spread(o.hx) * abs(nx) + spread(o.hy) * abs(ny);
    apart = apart | (spread(piece.edges[k].offset) + reach < nx * dx + ny * dy);
  }
  return ~bits(apart) & 0xffU;
}

inline unsigned polygon_disc(const Placed& p, const Piece& piece, const Piece& o) {
  if (bits(boxes_apart(p, o)) == 0xffU) return 0;
  // The obstacle's centre in the robot's frame, where the polygon is fixed.
  const V c = load(p.c.v);
  const V s = load(p.s.v);
  const V dx = spread(o.x) - load(p.x.v);
  const V dy = spread(o.y) - load(p.y.v);
  return near_polygon(dx * c + dy * s, dy * c - dx * s, spread(o.radius * o.radius), piece);
}

inline unsigned polygon_polygon(const Placed& p, const Piece& piece, const Piece& o) {
  M apart = boxes_apart(p, o);
  if (bits(apart) == 0xffU) return 0;
  for (unsigned j = 0; j < o.edge_count; ++j) {
    const V nx = spread(o.edges[j].nx);
    const V ny = spread(o.edges[j].ny);
    V nearest = nx * load(p.corners[0].x.v) + ny * load(p.corners[0].y.v);
    for (unsigned k = 1; k < piece.edge_count; ++k) {
      nearest = min(nearest, nx * load(p.corners[k].x.v) + ny * load(p.corners[k].y.v));
    }
    apart = apart | (spread(o.edges[j].offset) < nearest);
  }
  if (bits(apart) == 0xffU) return 0;
  const V x = load(p.x.v);
  const V y = load(p.y.v);
  for (unsigned k = 0; k < piece.edge_count; ++k) {
    const V nx = load(p.corners[k].nx.v);
    const V ny = load(p.corners[k].ny.v);
    V nearest = nx * (spread(o.edges[0].x) - x) + ny * (spread(o.edges[0].y) - y);
    for (unsigned j = 1; j < o.edge_count; ++j) {
      nearest = min(nearest, nx * (spread(o.edges[j].x) - x) + ny * (spread(o.edges[j].y) - y));
    }
    apart = apart | (spread(piece.edges[k].offset) < nearest);
  }
  return ~bits(apart) & 0xffU;
}

unsigned collide(const Placed& placed, const Piece& piece, const Piece* obstacles, const unsigned* candidates,
                 unsigned count) {
  unsigned hit = 0;
  for (unsigned i = 0; i < count && (hit & 1U) == 0; ++i) {
    const Piece& o = obstacles[candidates[i]];
    switch (piece.kind) {
      case Kind::rectangle:
        hit |= o.kind == Kind::rectangle ? rectangle_rectangle(placed, piece, o)
               : o.kind == Kind::disc    ? rectangle_disc(placed, piece, o)
                                         : rectangle_polygon(placed, piece, o);
        break;
      case Kind::disc:
        hit |= o.kind == Kind::rectangle ? disc_rectangle(placed, piece, o)
               : o.kind == Kind::disc    ? disc_disc(placed, piece, o)
                                         : disc_polygon(placed, piece, o);
        break;
      case Kind::polygon:
        hit |= o.kind == Kind::rectangle ? polygon_rectangle(placed, piece, o)
               : o.kind == Kind::disc    ? polygon_disc(placed, piece, o)
                                         : polygon_polygon(placed, piece, o);
        break;
    }
  }
  return hit;
}
