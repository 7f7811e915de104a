// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels of manipulators, in eight configurations at a time; see planar/kernel_impl.inl.

struct V3 {
  V x, y, z;
};

inline V3 load(const Lanes* from) { return {load(from[0].v), load(from[1].v), load(from[2].v)}; }
inline void store(Lanes* to, const V3& v) {
  store(to[0].v, v.x);
  store(to[1].v, v.y);
  store(to[2].v, v.z);
}

inline V3 operator+(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V3 operator-(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V dot(const V3& a, const V3& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
inline V3 cross(const V3& a, const V3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline V length(const V3& a) { return root(dot(a, a)); }

#include <trellis/collision/spatial/cloud_kernel.inl>

/// A frame: nine lanes of the matrix, three of the position.
inline V3 at(const Lanes* frame, double x, double y, double z) {
  const V a = spread(x);
  const V b = spread(y);
  const V c = spread(z);
  return {((load(frame[0].v) * a + load(frame[1].v) * b) + load(frame[2].v) * c) + load(frame[9].v),
          ((load(frame[3].v) * a + load(frame[4].v) * b) + load(frame[5].v) * c) + load(frame[10].v),
          ((load(frame[6].v) * a + load(frame[7].v) * b) + load(frame[8].v) * c) + load(frame[11].v)};
}

void move_chain(const ChainBody* bodies, unsigned count, const Lanes* values, Lanes* frames) {
  for (unsigned b = 1; b < count; ++b) {
    const ChainBody& body = bodies[b];
    const Lanes* parent = frames + 12UL * body.parent;
    Lanes* frame = frames + 12UL * b;
    const V value = spread(body.multiplier) * load(values[body.column].v) + spread(body.offset);
    V local[9];  // NOLINT(modernize-avoid-c-arrays)
    if (body.slides) {
      for (unsigned k = 0; k < 9; ++k) local[k] = spread(body.origin[k]);
      V along[3];  // NOLINT(modernize-avoid-c-arrays)
      for (unsigned k = 0; k < 3; ++k) along[k] = spread(body.position[k]) + value * spread(body.axis[k]);
      for (unsigned i = 0; i < 3; ++i) {
        store(frame[9 + i].v, ((load(parent[3UL * i].v) * along[0] + load(parent[3UL * i + 1].v) * along[1]) +
                               load(parent[3UL * i + 2].v) * along[2]) +
                                  load(parent[9 + i].v));
      }
    } else {
      V sine = spread(0.0);
      V cosine = sine;
      sine_cosine(value, sine, cosine);
      const V rest = spread(1.0) - cosine;
      for (unsigned k = 0; k < 9; ++k) {
        local[k] = (spread(body.origin[k]) + sine * spread(body.once[k])) + rest * spread(body.twice[k]);
      }
      store(frame + 9, at(parent, body.position[0], body.position[1], body.position[2]));
    }
    for (unsigned i = 0; i < 3; ++i) {
      const V p0 = load(parent[3UL * i].v);
      const V p1 = load(parent[3UL * i + 1].v);
      const V p2 = load(parent[3UL * i + 2].v);
      for (unsigned j = 0; j < 3; ++j) {
        store(frame[3UL * i + j].v, (p0 * local[j] + p1 * local[3 + j]) + p2 * local[6 + j]);
      }
    }
  }
}

/// One solid in all lanes.
struct OneSolid {
  const Solid3& of;

  [[nodiscard]] Solid3::Kind kind() const { return of.kind; }
  [[nodiscard]] V3 centre() const { return {spread(of.x), spread(of.y), spread(of.z)}; }
  [[nodiscard]] V3 row(unsigned i) const {
    return {spread(of.r[3UL * i]), spread(of.r[3UL * i + 1]), spread(of.r[3UL * i + 2])};
  }
  [[nodiscard]] V3 half() const { return {spread(of.hx), spread(of.hy), spread(of.hz)}; }
  [[nodiscard]] V radius() const { return spread(of.radius); }
  [[nodiscard]] V length() const { return spread(of.length); }
};

/// The distance of points from a solid, or from the core of a round one.
struct CoreDistance {
  V squared;
  V round;  ///< the distance from the surface is less by this

  /// The lanes in which a ball about the point meets the solid.
  [[nodiscard]] M within(const V& radius) const {
    const V reach = radius + round;
    return squared <= reach * reach;
  }
};

template <class Solid>
inline CoreDistance core_distance(const V3& c, const Solid& solid) {
  const V zero = spread(0.0);
  const V3 d = c - solid.centre();
  if (solid.kind() == Solid3::Kind::sphere) return {dot(d, d), solid.radius()};
  const V u = dot(solid.row(0), d);
  const V v = dot(solid.row(1), d);
  const V w = dot(solid.row(2), d);
  if (solid.kind() == Solid3::Kind::box) {
    const V3 half = solid.half();
    const V3 beyond{max(abs(u) - half.x, zero), max(abs(v) - half.y, zero), max(abs(w) - half.z, zero)};
    return {dot(beyond, beyond), zero};
  }
  const V e = max(abs(w) - solid.length(), zero);
  const V across = u * u + v * v;
  if (solid.kind() == Solid3::Kind::capsule) return {across + e * e, solid.radius()};
  const V a = max(root(across) - solid.radius(), zero);
  return {a * a + e * e, zero};
}

/// Returns the lanes in which a ball about c meets the solid.
template <class Solid>
inline M ball_meets(const V3& c, const V& radius, const Solid& solid) {
  return core_distance(c, solid).within(radius);
}

/// Computes the centres of a body's balls, but for the first one, where they are not known.
inline void place_balls(const ChainBody& body, const Lanes* frame, Lanes* own, unsigned& placed) {
  if (placed != 0) return;
  placed = 1;
  for (unsigned i = 1; i < body.ball_count; ++i) {
    store(own + 3UL * i, at(frame, body.balls[i].x, body.balls[i].y, body.balls[i].z));
  }
}

/// Whether a ball lies within the bounds in all lanes.
inline bool inside_bounds(const V3& c, double radius, const Scene3& scene) {
  const auto within = [&](const V& value, unsigned k) {
    return (spread(scene.lo[k] + radius) < value) & (value < spread(scene.hi[k] - radius));
  };
  return bits(within(c.x, 0) & within(c.y, 1) & within(c.z, 2)) == 0xffU;
}

unsigned meet_chain(const ChainBody* bodies, unsigned count, const Lanes* frames, const Scene3& scene, Lanes* centres,
                    unsigned* candidates) {
  unsigned hit = 0;
  const auto decided = [&] { return (hit & 1U) != 0; };
  // Lanes after the first that touches something need no answer.
  const auto cloud_lanes = [&] { return scene.cloud_lanes & ((hit & (0U - hit)) - 1U); };
  const double slack = scene.slack;
  unsigned* const placed = candidates + scene.solid_count;
  // Contact is likelier far from the base.
  for (unsigned b = count; b-- > 0;) {
    const ChainBody& body = bodies[b];
    if (body.ball_count == 0) continue;
    const Lanes* frame = frames + 12UL * b;
    Lanes* own = centres + 3UL * body.first_centre;
    const V3 whole = at(frame, body.balls[0].x, body.balls[0].y, body.balls[0].z);
    store(own, whole);
    placed[b] = 0;
    if (scene.bounded && !inside_bounds(whole, body.balls[0].radius, scene)) {
      place_balls(body, frame, own, placed[b]);
      M inside = spread(0.0) <= spread(1.0);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = load(own + 3UL * i);
        const double r = body.balls[i].radius - slack;
        inside = inside & (spread(scene.lo[0] + r) < c.x) & (c.x < spread(scene.hi[0] - r)) &
                 (spread(scene.lo[1] + r) < c.y) & (c.y < spread(scene.hi[1] - r)) & (spread(scene.lo[2] + r) < c.z) &
                 (c.z < spread(scene.hi[2] - r));
      }
      hit |= ~bits(inside) & 0xffU;
    }
    unsigned near = 0;
    for (unsigned k = body.reached_begin; k < body.reached_end; ++k) {
      const unsigned s = scene.reached[k];
      const Solid3& solid = scene.solids[s];
      const double reach = body.balls[0].radius + solid.far + slack;
      const V dx = whole.x - spread(solid.x);
      const V dy = whole.y - spread(solid.y);
      const V dz = whole.z - spread(solid.z);
      if (bits(((dx * dx + dy * dy) + dz * dz) <= spread(reach * reach)) == 0) continue;
      if (bits(ball_meets(whole, spread(body.balls[0].radius + slack), OneSolid{solid})) != 0) candidates[near++] = s;
    }
    if (near > 0) place_balls(body, frame, own, placed[b]);
    for (unsigned i = 1; i < body.ball_count && near > 0; ++i) {
      const V3 c = load(own + 3UL * i);
      for (unsigned k = 0; k < near; ++k) {
        hit |= bits(ball_meets(c, spread(body.balls[i].radius + slack), OneSolid{scene.solids[candidates[k]]}));
      }
      if (decided()) return hit;
    }
    for (unsigned k = 0; k < scene.cloud_count; ++k) {
      const Cloud3& cloud = scene.clouds[k];
      const unsigned whole_near =
          near_cloud(whole, spread(body.balls[0].radius + slack + cloud.radius), cloud, cloud_lanes());
      if (whole_near == 0) continue;
      place_balls(body, frame, own, placed[b]);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        hit |= meets_cloud(load(own + 3UL * i), body.balls[i].radius + slack, cloud, whole_near & cloud_lanes());
        if (decided()) return hit;
      }
    }
    if (decided()) return hit;
  }
  for (unsigned p = 0; p < scene.pair_count; ++p) {
    const ChainBody& first = bodies[scene.pairs[2UL * p]];
    const ChainBody& second = bodies[scene.pairs[2UL * p + 1]];
    if (first.ball_count == 0 || second.ball_count == 0) continue;
    const Lanes* one = centres + 3UL * first.first_centre;
    const Lanes* two = centres + 3UL * second.first_centre;
    const auto meets = [&](const V3& a, const V3& b, double reach) {
      const V dx = a.x - b.x;
      const V dy = a.y - b.y;
      const V dz = a.z - b.z;
      return bits(((dx * dx + dy * dy) + dz * dz) <= spread(reach * reach));
    };
    const V3 other = load(two);
    if (meets(load(one), other, first.balls[0].radius + second.balls[0].radius + slack) == 0) continue;
    const unsigned a = scene.pairs[2UL * p];
    const unsigned b = scene.pairs[2UL * p + 1];
    place_balls(first, frames + 12UL * a, centres + 3UL * first.first_centre, placed[a]);
    place_balls(second, frames + 12UL * b, centres + 3UL * second.first_centre, placed[b]);
    for (unsigned i = 1; i < first.ball_count; ++i) {
      const V3 c = load(one + 3UL * i);
      if (meets(c, other, first.balls[i].radius + second.balls[0].radius + slack) == 0) continue;
      for (unsigned j = 1; j < second.ball_count; ++j) {
        hit |= meets(c, load(two + 3UL * j), first.balls[i].radius + second.balls[j].radius + slack);
      }
    }
    if (decided()) return hit;
  }
  return hit;
}

void rate_chain(const ChainBody* bodies, unsigned count, const Lanes* frames, const double* change, Lanes* rates) {
  for (unsigned k = 0; k < 6; ++k) store(rates[k].v, spread(0.0));
  for (unsigned b = 1; b < count; ++b) {
    const ChainBody& body = bodies[b];
    const Lanes* parent = frames + 12UL * body.parent;
    const Lanes* carrier = rates + 6UL * body.parent;
    V3 turn = load(carrier);
    V3 slide = load(carrier + 3) + cross(turn, load(frames + 12UL * b + 9) - load(parent + 9));
    const double by = body.multiplier * change[body.column];
    if (by != 0.0) {
      const V x = spread(by * body.axis[0]);
      const V y = spread(by * body.axis[1]);
      const V z = spread(by * body.axis[2]);
      const V3 own{(load(parent[0].v) * x + load(parent[1].v) * y) + load(parent[2].v) * z,
                   (load(parent[3].v) * x + load(parent[4].v) * y) + load(parent[5].v) * z,
                   (load(parent[6].v) * x + load(parent[7].v) * y) + load(parent[8].v) * z};
      if (body.slides) {
        slide = slide + own;
      } else {
        turn = turn + own;
      }
    }
    store(rates + 6UL * b, turn);
    store(rates + 6UL * b + 3, slide);
  }
}

/// How the points of a body move.
struct Rate {
  V3 turn, slide, origin;

  [[nodiscard]] V3 at(const V3& point) const { return slide + cross(turn, point - origin); }
};

inline Rate rate_of(const Lanes* frames, const Lanes* rates, unsigned body) {
  return {load(rates + 6UL * body), load(rates + 6UL * body + 3), load(frames + 12UL * body + 9)};
}

/// Where a point is about a solid, or about the axis or the centre of a round one.
struct Placement {
  V u, v, w;     ///< from the nearest point, in the solid's frame; of a cylinder (u, v) is the place beside the axis
  V squared;     ///< the distance's square
  V beside;      ///< of a cylinder: the distance from its surface beside it
  V across;      ///< of a cylinder: the distance from its axis
  double round;  ///< the distance from the surface is less by this
};

inline Placement placement(const V3& c, const Solid3& solid) {
  const V zero = spread(0.0);
  const V3 d{c.x - spread(solid.x), c.y - spread(solid.y), c.z - spread(solid.z)};
  if (solid.kind == Solid3::Kind::sphere) return {d.x, d.y, d.z, dot(d, d), zero, zero, solid.radius};
  const double* r = solid.r;
  const V u = (spread(r[0]) * d.x + spread(r[1]) * d.y) + spread(r[2]) * d.z;
  const V v = (spread(r[3]) * d.x + spread(r[4]) * d.y) + spread(r[5]) * d.z;
  const V w = (spread(r[6]) * d.x + spread(r[7]) * d.y) + spread(r[8]) * d.z;
  const auto beyond = [&](const V& value, double half) {
    return negative_where(value < zero, max(abs(value) - spread(half), zero));
  };
  if (solid.kind == Solid3::Kind::box) {
    const V a = beyond(u, solid.hx);
    const V b = beyond(v, solid.hy);
    const V e = beyond(w, solid.hz);
    return {a, b, e, (a * a + b * b) + e * e, zero, zero, 0.0};
  }
  const V e = beyond(w, solid.length);
  const V across = u * u + v * v;
  if (solid.kind == Solid3::Kind::capsule) return {u, v, e, across + e * e, zero, zero, solid.radius};
  const V far = root(across);
  const V beside = max(far - spread(solid.radius), zero);
  return {u, v, e, beside * beside + e * e, beside, far, 0.0};
}

/// A step of a point along the gradient of its distance from a solid, times that distance and `scale`.
inline V toward(const Placement& at, const V3& step, const Solid3& solid, V& scale) {
  scale = spread(1.0);
  if (solid.kind == Solid3::Kind::sphere) return (at.u * step.x + at.v * step.y) + at.w * step.z;
  const double* r = solid.r;
  const V u = (spread(r[0]) * step.x + spread(r[1]) * step.y) + spread(r[2]) * step.z;
  const V v = (spread(r[3]) * step.x + spread(r[4]) * step.y) + spread(r[5]) * step.z;
  const V w = (spread(r[6]) * step.x + spread(r[7]) * step.y) + spread(r[8]) * step.z;
  if (solid.kind != Solid3::Kind::cylinder) return (at.u * u + at.v * v) + at.w * w;
  // Beside a cylinder the gradient is (u, v) / across.
  scale = select(spread(0.0) < at.beside, at.across, scale);
  return at.beside * (at.u * u + at.v * v) + scale * (at.w * w);
}

/// Returns the lanes in which a ball may come nearer to a solid than `reach` less its radius.
/// \param step   of its centre, to either side
/// \param moved  the length of `step`
/// \param reach  the ball's radius, the margin, and what the centre leaves a straight line by
inline unsigned approaches(const V3& c, const V3& step, const V& moved, double reach, const Solid3& solid) {
  const Placement at = placement(c, solid);
  const double reached = reach + at.round;
  const V far = spread(reached) + moved;
  if (bits(at.squared <= far * far) == 0) return 0;
  // The distance from a convex solid is convex: along a straight line it is at least what its gradient says. So it
  // stays above `reached` where squared / distance - |toward| / distance does.
  V scale = far;
  const V change = abs(toward(at, step, solid, scale));
  const V left = scale * at.squared - change;
  return bits((left <= spread(0.0)) | (left * left <= (spread(reached * reached) * at.squared) * (scale * scale)));
}

/// The steps of all points of a ball that a body carries are at most this long.
inline V longest_step(const Rate& rate, const V3& centre, double radius) {
  return length(rate.at(centre)) + length(rate.turn) * spread(radius);
}

/// As longest_step, seen from another body.
inline V longest_step_from(const Rate& viewer, const Rate& body, const V3& centre, double radius) {
  return length(body.at(centre) - viewer.at(centre)) + length(body.turn - viewer.turn) * spread(radius);
}

unsigned approach_chain(const ChainBody* bodies, unsigned count, const Lanes* frames, const Lanes* rates,
                        const Scene3& scene, const ChainMotion& motion, Lanes* centres, unsigned* candidates) {
  unsigned hit = 0;
  unsigned* const placed = candidates + scene.solid_count;
  for (unsigned b = count; b-- > 0;) {
    const ChainBody& body = bodies[b];
    if (body.ball_count == 0) continue;
    const Rate rate = rate_of(frames, rates, b);
    const double slack = scene.slack + motion.bend[b];
    const Lanes* frame = frames + 12UL * b;
    Lanes* own = centres + 3UL * body.first_centre;
    const V3 whole = at(frame, body.balls[0].x, body.balls[0].y, body.balls[0].z);
    store(own, whole);
    placed[b] = 0;
    if (scene.bounded) {
      place_balls(body, frame, own, placed[b]);
      M inside = spread(0.0) <= spread(1.0);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = load(own + 3UL * i);
        const V3 step = rate.at(c);
        const V r = spread(body.balls[i].radius + slack);
        const V x = r + abs(step.x);
        const V y = r + abs(step.y);
        const V z = r + abs(step.z);
        inside = inside & (spread(scene.lo[0]) + x < c.x) & (c.x < spread(scene.hi[0]) - x) &
                 (spread(scene.lo[1]) + y < c.y) & (c.y < spread(scene.hi[1]) - y) & (spread(scene.lo[2]) + z < c.z) &
                 (c.z < spread(scene.hi[2]) - z);
      }
      hit |= ~bits(inside) & 0xffU;
    }
    const V moved = longest_step(rate, whole, body.balls[0].radius);
    unsigned near = 0;
    for (unsigned s = 0; s < scene.solid_count; ++s) {
      const Solid3& solid = scene.solids[s];
      const V ball = spread(body.balls[0].radius + slack) + moved;
      const V reach = ball + spread(solid.far);
      const V3 d{whole.x - spread(solid.x), whole.y - spread(solid.y), whole.z - spread(solid.z)};
      if (bits(dot(d, d) <= reach * reach) == 0) continue;
      const Placement place = placement(whole, solid);
      const V whole_reach = ball + spread(place.round);
      if (bits(place.squared <= whole_reach * whole_reach) != 0) candidates[near++] = s;
    }
    if (near > 0) place_balls(body, frame, own, placed[b]);
    for (unsigned i = 1; i < body.ball_count && near > 0; ++i) {
      const V3 c = load(own + 3UL * i);
      const V3 step = rate.at(c);
      const V by = length(step);
      for (unsigned k = 0; k < near; ++k) {
        hit |= approaches(c, step, by, body.balls[i].radius + slack, scene.solids[candidates[k]]);
      }
      if (hit == 0xffU) return hit;
    }
    for (unsigned k = 0; k < scene.cloud_count; ++k) {
      const Cloud3& cloud = scene.clouds[k];
      const unsigned asked = near_cloud(whole, spread(body.balls[0].radius + slack + cloud.radius) + moved, cloud,
                                        scene.cloud_lanes & ~hit);
      if (asked == 0) continue;
      place_balls(body, frame, own, placed[b]);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = load(own + 3UL * i);
        const V3 step = rate.at(c);
        hit |= approaches_cloud(c, step, length(step), body.balls[i].radius + slack, cloud, asked & ~hit);
      }
      if (hit == 0xffU) return hit;
    }
  }
  for (unsigned p = 0; p < scene.pair_count; ++p) {
    const unsigned a = scene.pairs[2UL * p];
    const unsigned b = scene.pairs[2UL * p + 1];
    const ChainBody& first = bodies[a];
    const ChainBody& second = bodies[b];
    if (first.ball_count == 0 || second.ball_count == 0) continue;
    const double slack = scene.slack + motion.pair_bend[p];
    const Lanes* one = centres + 3UL * first.first_centre;
    const Lanes* two = centres + 3UL * second.first_centre;
    const Rate rate = rate_of(frames, rates, a);
    const Rate other_rate = rate_of(frames, rates, b);
    const V3 other = load(two);
    const V moved = longest_step_from(rate, other_rate, other, second.balls[0].radius);
    const auto within = [&](const V3& c, double reach) {
      const V3 d = c - other;
      const V far = spread(reach) + moved;
      return bits(dot(d, d) <= far * far) != 0;
    };
    if (!within(load(one), first.balls[0].radius + second.balls[0].radius + slack)) continue;
    place_balls(first, frames + 12UL * a, centres + 3UL * first.first_centre, placed[a]);
    place_balls(second, frames + 12UL * b, centres + 3UL * second.first_centre, placed[b]);
    for (unsigned i = 1; i < first.ball_count; ++i) {
      const V3 c = load(one + 3UL * i);
      if (!within(c, first.balls[i].radius + second.balls[0].radius + slack)) continue;
      const V3 step = rate.at(c);
      for (unsigned j = 1; j < second.ball_count; ++j) {
        const V3 to = load(two + 3UL * j);
        const V3 d = c - to;
        const V squared = dot(d, d);
        const V left = squared - abs(dot(d, step - other_rate.at(to)));
        const double reach = first.balls[i].radius + second.balls[j].radius + slack;
        hit |= bits((left <= spread(0.0)) | (left * left <= spread(reach * reach) * squared));
      }
    }
    if (hit == 0xffU) return hit;
  }
  return hit;
}

void measure_chain(const ChainBody* bodies, unsigned count, const Lanes* frames, const Lanes* rates,
                   const Scene3& scene, const ChainMotion& motion, Lanes* centres, unsigned* placed, Lanes& least_out,
                   Lanes& sure_out) {
  V least = load(least_out.v);
  V sure = load(sure_out.v);
  // A distance of 0 has no gradient: any small number keeps its quotient finite.
  const V tiny = spread(1e-300);
  const auto note = [&](const V& distance, const V& change, double bend) {
    least = min(least, distance);
    sure = min(sure, (distance - change) - spread(bend));
  };
  // Whether no lane gets less from distances of at least this.
  const auto enough = [&](const V& distance, const V& change, double bend) {
    return bits((distance < least) | ((distance - change) - spread(bend) < sure)) == 0;
  };
  for (unsigned b = count; b-- > 0;) {
    const ChainBody& body = bodies[b];
    if (body.ball_count == 0) continue;
    const Rate rate = rate_of(frames, rates, b);
    const double bend = motion.bend[b];
    const Lanes* frame = frames + 12UL * b;
    Lanes* own = centres + 3UL * body.first_centre;
    const V3 whole = at(frame, body.balls[0].x, body.balls[0].y, body.balls[0].z);
    store(own, whole);
    placed[b] = 0;
    if (scene.bounded) place_balls(body, frame, own, placed[b]);
    for (unsigned i = 1; i < body.ball_count && scene.bounded; ++i) {
      const V3 c = load(own + 3UL * i);
      const V3 step = rate.at(c);
      const V r = spread(body.balls[i].radius);
      note(min(c.x - spread(scene.lo[0]), spread(scene.hi[0]) - c.x) - r, abs(step.x), bend);
      note(min(c.y - spread(scene.lo[1]), spread(scene.hi[1]) - c.y) - r, abs(step.y), bend);
      note(min(c.z - spread(scene.lo[2]), spread(scene.hi[2]) - c.z) - r, abs(step.z), bend);
    }
    const V moved = longest_step(rate, whole, body.balls[0].radius);
    for (unsigned s = 0; s < scene.solid_count; ++s) {
      const Solid3& solid = scene.solids[s];
      const Placement about = placement(whole, solid);
      if (enough(root(about.squared) - spread(about.round + body.balls[0].radius), moved, bend)) continue;
      place_balls(body, frame, own, placed[b]);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = load(own + 3UL * i);
        const Placement place = placement(c, solid);
        const V distance = root(place.squared);
        V scale = distance;
        const V change = abs(toward(place, rate.at(c), solid, scale));
        note(distance - spread(place.round + body.balls[i].radius), change / max(scale * distance, tiny), bend);
      }
    }
    for (unsigned k = 0; k < scene.cloud_count; ++k) {
      const Cloud3& cloud = scene.clouds[k];
      const V reach = max(least, (sure + moved) + spread(bend)) + spread(body.balls[0].radius + cloud.radius);
      if (near_cloud(whole, reach, cloud, 0xffU) == 0) continue;
      place_balls(body, frame, own, placed[b]);
      Lanes lowest, certain;
      store(lowest.v, least);
      store(certain.v, sure);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = load(own + 3UL * i);
        measure_cloud(c, rate.at(c), body.balls[i].radius, bend, cloud, lowest, certain);
      }
      least = load(lowest.v);
      sure = load(certain.v);
    }
  }
  for (unsigned p = 0; p < scene.pair_count; ++p) {
    const unsigned a = scene.pairs[2UL * p];
    const unsigned b = scene.pairs[2UL * p + 1];
    const ChainBody& first = bodies[a];
    const ChainBody& second = bodies[b];
    if (first.ball_count == 0 || second.ball_count == 0) continue;
    const double bend = motion.pair_bend[p];
    const Lanes* one = centres + 3UL * first.first_centre;
    const Lanes* two = centres + 3UL * second.first_centre;
    const Rate rate = rate_of(frames, rates, a);
    const Rate other_rate = rate_of(frames, rates, b);
    const V3 other = load(two);
    const V moved = longest_step_from(rate, other_rate, other, second.balls[0].radius);
    const auto farther = [&](const V3& c, double radius) {
      return enough(length(c - other) - spread(radius + second.balls[0].radius), moved, bend);
    };
    if (farther(load(one), first.balls[0].radius)) continue;
    place_balls(first, frames + 12UL * a, centres + 3UL * first.first_centre, placed[a]);
    place_balls(second, frames + 12UL * b, centres + 3UL * second.first_centre, placed[b]);
    for (unsigned i = 1; i < first.ball_count; ++i) {
      const V3 c = load(one + 3UL * i);
      if (farther(c, first.balls[i].radius)) continue;
      const V3 step = rate.at(c);
      for (unsigned j = 1; j < second.ball_count; ++j) {
        const V3 to = load(two + 3UL * j);
        const V3 d = c - to;
        const V distance = length(d);
        const V change = abs(dot(d, step - other_rate.at(to)));
        note(distance - spread(first.balls[i].radius + second.balls[j].radius), change / max(distance, tiny), bend);
      }
    }
  }
  store(least_out.v, least);
  store(sure_out.v, sure);
}

#include <trellis/collision/spatial/configuration_kernel.inl>
