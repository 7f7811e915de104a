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
    if (body.given) continue;
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

/// The balls of a body in eight configurations. Their centres are computed where they are needed, a block at a time.
struct PlacedBody {
  const ChainBody& body;
  const Lanes* frame;
  Lanes* centres;
  unsigned* placed;  ///< of each block: 0; 1 where its first ball is placed; 2 where all are

  PlacedBody(const ChainBody* bodies, unsigned b, const Lanes* frames, const Scene3& scene, Lanes* all,
             unsigned* scratch)
      : body(bodies[b]),
        frame(frames + 12UL * b),
        centres(all + 3UL * body.first_centre),
        placed(scratch + 2UL * scene.solid_count + body.first_block) {}

  /// Computes the centre of the ball about the body, and forgets the others.
  V3 begin() {
    for (unsigned k = 0; k < body.block_count; ++k) placed[k] = 0;
    return place(0);
  }
  [[nodiscard]] V3 whole() const { return load(centres); }
  [[nodiscard]] V3 centre(unsigned ball) const { return load(centres + 3UL * ball); }
  [[nodiscard]] double radius(unsigned ball) const { return body.balls[ball].radius; }
  [[nodiscard]] unsigned first(unsigned block) const { return body.block_begin[block]; }
  [[nodiscard]] unsigned end(unsigned block) const { return body.block_begin[block + 1]; }
  /// The radius of the ball about the first one's centre that contains a block.
  [[nodiscard]] double block_radius(unsigned block) const { return body.block_radii[block]; }
  /// The centre of a block's first ball.
  V3 block(unsigned k) {
    if (placed[k] != 0) return centre(first(k));
    placed[k] = 1;
    return place(first(k));
  }
  /// Computes the centres of a block's balls.
  void fill(unsigned k) {
    if (placed[k] == 2) return;
    for (unsigned i = first(k) + (placed[k] == 1 ? 1 : 0); i < end(k); ++i) place(i);
    placed[k] = 2;
  }
  void fill_all() {
    for (unsigned k = 0; k < body.block_count; ++k) fill(k);
  }

 private:
  V3 place(unsigned ball) const {
    const Ball& of = body.balls[ball];
    const V3 c = at(frame, of.x, of.y, of.z);
    store(centres + 3UL * ball, c);
    return c;
  }
};

/// Two parts that are compared with each other.
struct PairOfParts {
  const BallPart& first;
  const BallPart& second;

  PairOfParts(const Scene3& scene, unsigned pair)
      : first(scene.parts[scene.pairs[2UL * pair]]), second(scene.parts[scene.pairs[2UL * pair + 1]]) {}

  /// Whether both parts are of the same bodies as the pair before.
  [[nodiscard]] bool same_bodies(const Scene3& scene, unsigned pair) const {
    return pair > 0 && scene.parts[scene.pairs[2UL * pair - 2]].body == first.body &&
           scene.parts[scene.pairs[2UL * pair - 1]].body == second.body;
  }
  /// Whether the parts are their bodies.
  [[nodiscard]] bool all() const { return first.all && second.all; }
  /// Calls a function for each pair of blocks that may be near each other, whose balls are placed: of the first block,
  /// of the second one, and with the centre and the radius of a ball that contains the second one.
  /// \param other  the centre of the ball about the second part
  /// \param near   whether balls about two points, the first of `one` and the second of `two`, may be near each other
  template <class Near, class Body>
  void each(PlacedBody& one, PlacedBody& two, const V3& other, const Near& near, const Body& call) const {
    const bool many = first.end_block - first.first_block > 1;
    const bool many_others = second.end_block - second.first_block > 1;
    for (unsigned k = first.first_block; k < first.end_block; ++k) {
      if (many && !near(one.block(k), one.block_radius(k), other, second.whole.radius)) continue;
      one.fill(k);
      for (unsigned l = second.first_block; l < second.end_block; ++l) {
        const V3 centre = many_others ? two.block(l) : other;
        const double radius = many_others ? two.block_radius(l) : second.whole.radius;
        if (many && many_others && !near(one.block(k), one.block_radius(k), centre, radius)) continue;
        two.fill(l);
        call(k, l, centre, radius);
      }
    }
  }
  /// The centre of the ball about a part.
  static V3 whole(const BallPart& part, const PlacedBody& body) {
    return part.all ? body.whole() : at(body.frame, part.whole.x, part.whole.y, part.whole.z);
  }
};

/// Whether a ball lies within the bounds in all lanes.
inline bool inside_bounds(const V3& c, double radius, const Scene3& scene) {
  const auto within = [&](const V& value, unsigned k) {
    return (spread(scene.lo[k] + radius) < value) & (value < spread(scene.hi[k] - radius));
  };
  return bits(within(c.x, 0) & within(c.y, 1) & within(c.z, 2)) == 0xffU;
}

/// The solids near a block, of those near its body: all where the body is one block.
/// \param near  whether a ball about a point may meet a solid
/// \return their number; they are written to `to`
template <class Near>
inline unsigned near_block(PlacedBody& body, unsigned block, const unsigned* candidates, unsigned count, unsigned* to,
                           const Near& near) {
  unsigned some = 0;
  const bool only = body.body.block_count == 1;
  const V3 c = only ? body.whole() : body.block(block);
  for (unsigned n = 0; n < count; ++n) {
    if (only || near(c, body.block_radius(block), candidates[n])) to[some++] = candidates[n];
  }
  return some;
}

unsigned meet_chain(const ChainBody* bodies, unsigned count, const Lanes* frames, const Scene3& scene, Lanes* centres,
                    unsigned* scratch) {
  unsigned hit = 0;
  const auto decided = [&] { return (hit & 1U) != 0; };
  // Lanes after the first that touches something need no answer.
  const auto cloud_lanes = [&] { return scene.cloud_lanes & ((hit & (0U - hit)) - 1U); };
  const double slack = scene.slack;
  unsigned* const candidates = scratch;
  unsigned* const of_block = scratch + scene.solid_count;
  // Contact is likelier far from the base.
  for (unsigned b = count; b-- > 0;) {
    const ChainBody& body = bodies[b];
    if (body.ball_count == 0) continue;
    PlacedBody own(bodies, b, frames, scene, centres, scratch);
    const V3 whole = own.begin();
    if (scene.bounded && !inside_bounds(whole, body.balls[0].radius, scene)) {
      own.fill_all();
      M inside = spread(0.0) <= spread(1.0);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = own.centre(i);
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
    for (unsigned k = 0; k < body.block_count && near > 0; ++k) {
      const unsigned some = near_block(own, k, candidates, near, of_block, [&](const V3& c, double radius, unsigned s) {
        return bits(ball_meets(c, spread(radius + slack), OneSolid{scene.solids[s]})) != 0;
      });
      if (some == 0) continue;
      own.fill(k);
      for (unsigned i = own.first(k); i < own.end(k); ++i) {
        const V3 c = own.centre(i);
        const V radius = spread(own.radius(i) + slack);
        for (unsigned n = 0; n < some; ++n) hit |= bits(ball_meets(c, radius, OneSolid{scene.solids[of_block[n]]}));
        if (decided()) return hit;
      }
    }
    for (unsigned k = 0; k < scene.cloud_count; ++k) {
      const Cloud3& cloud = scene.clouds[k];
      const unsigned whole_near =
          near_cloud(whole, spread(body.balls[0].radius + slack + cloud.radius), cloud, cloud_lanes());
      if (whole_near == 0) continue;
      own.fill_all();
      for (unsigned i = 1; i < body.ball_count; ++i) {
        hit |= meets_cloud(own.centre(i), own.radius(i) + slack, cloud, whole_near & cloud_lanes());
        if (decided()) return hit;
      }
    }
    if (decided()) return hit;
  }
  bool near = false;
  for (unsigned p = 0; p < scene.pair_count; ++p) {
    const PairOfParts pair(scene, p);
    PlacedBody one(bodies, pair.first.body, frames, scene, centres, scratch);
    PlacedBody two(bodies, pair.second.body, frames, scene, centres, scratch);
    const auto meets = [&](const V3& a, const V3& b, double reach) {
      const V dx = a.x - b.x;
      const V dy = a.y - b.y;
      const V dz = a.z - b.z;
      return bits(((dx * dx + dy * dy) + dz * dz) <= spread(reach * reach));
    };
    if (!pair.same_bodies(scene, p)) {
      near = meets(one.whole(), two.whole(), one.radius(0) + two.radius(0) + slack) != 0;
    }
    if (!near) continue;
    const V3 other = PairOfParts::whole(pair.second, two);
    if (!pair.all() && meets(PairOfParts::whole(pair.first, one), other,
                             pair.first.whole.radius + pair.second.whole.radius + slack) == 0) {
      continue;
    }
    const auto near_balls = [&](const V3& a, double radius, const V3& b, double other_radius) {
      return meets(a, b, radius + other_radius + slack) != 0;
    };
    pair.each(one, two, other, near_balls, [&](unsigned k, unsigned l, const V3& block, double block_radius) {
      for (unsigned i = one.first(k); i < one.end(k); ++i) {
        const V3 c = one.centre(i);
        if (meets(c, block, one.radius(i) + block_radius + slack) == 0) continue;
        for (unsigned j = two.first(l); j < two.end(l); ++j) {
          hit |= meets(c, two.centre(j), one.radius(i) + two.radius(j) + slack);
        }
      }
    });
    if (decided()) return hit;
  }
  return hit;
}

void rate_chain(const ChainBody* bodies, unsigned count, const Lanes* frames, const double* change, Lanes* rates) {
  for (unsigned k = 0; k < 6; ++k) store(rates[k].v, spread(0.0));
  for (unsigned b = 1; b < count; ++b) {
    const ChainBody& body = bodies[b];
    if (body.given) continue;
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
                        const Scene3& scene, const ChainMotion& motion, Lanes* centres, unsigned* scratch) {
  unsigned hit = 0;
  unsigned* const candidates = scratch;
  unsigned* const of_block = scratch + scene.solid_count;
  for (unsigned b = count; b-- > 0;) {
    const ChainBody& body = bodies[b];
    if (body.ball_count == 0) continue;
    const Rate rate = rate_of(frames, rates, b);
    const double slack = scene.slack + motion.bend[b];
    PlacedBody own(bodies, b, frames, scene, centres, scratch);
    const V3 whole = own.begin();
    if (scene.bounded) {
      own.fill_all();
      M inside = spread(0.0) <= spread(1.0);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = own.centre(i);
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
    /// Whether balls that follow a ball may come near a solid.
    const auto near_solid = [&](const V3& c, const V& reach, unsigned s) {
      const Placement place = placement(c, scene.solids[s]);
      const V far = reach + spread(place.round);
      return bits(place.squared <= far * far) != 0;
    };
    const V moved = longest_step(rate, whole, body.balls[0].radius);
    const V ball = spread(body.balls[0].radius + slack) + moved;
    unsigned near = 0;
    for (unsigned s = 0; s < scene.solid_count; ++s) {
      const Solid3& solid = scene.solids[s];
      const V reach = ball + spread(solid.far);
      const V3 d{whole.x - spread(solid.x), whole.y - spread(solid.y), whole.z - spread(solid.z)};
      if (bits(dot(d, d) <= reach * reach) == 0) continue;
      if (near_solid(whole, ball, s)) candidates[near++] = s;
    }
    for (unsigned k = 0; k < body.block_count && near > 0; ++k) {
      const unsigned some = near_block(own, k, candidates, near, of_block, [&](const V3& c, double radius, unsigned s) {
        return near_solid(c, spread(radius + slack) + longest_step(rate, c, radius), s);
      });
      if (some == 0) continue;
      own.fill(k);
      for (unsigned i = own.first(k); i < own.end(k); ++i) {
        const V3 c = own.centre(i);
        const V3 step = rate.at(c);
        const V by = length(step);
        for (unsigned n = 0; n < some; ++n) {
          hit |= approaches(c, step, by, own.radius(i) + slack, scene.solids[of_block[n]]);
        }
        if (hit == 0xffU) return hit;
      }
    }
    for (unsigned k = 0; k < scene.cloud_count; ++k) {
      const Cloud3& cloud = scene.clouds[k];
      const unsigned asked = near_cloud(whole, spread(body.balls[0].radius + slack + cloud.radius) + moved, cloud,
                                        scene.cloud_lanes & ~hit);
      if (asked == 0) continue;
      own.fill_all();
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = own.centre(i);
        const V3 step = rate.at(c);
        hit |= approaches_cloud(c, step, length(step), body.balls[i].radius + slack, cloud, asked & ~hit);
      }
      if (hit == 0xffU) return hit;
    }
  }
  bool near = false;
  for (unsigned p = 0; p < scene.pair_count; ++p) {
    const PairOfParts pair(scene, p);
    PlacedBody one(bodies, pair.first.body, frames, scene, centres, scratch);
    PlacedBody two(bodies, pair.second.body, frames, scene, centres, scratch);
    const double slack = scene.slack + motion.pair_bend[p];
    const Rate rate = rate_of(frames, rates, pair.first.body);
    const Rate other_rate = rate_of(frames, rates, pair.second.body);
    const auto within = [](const V3& c, const V3& other, double reach, const V& moved) {
      const V3 d = c - other;
      const V far = spread(reach) + moved;
      return bits(dot(d, d) <= far * far) != 0;
    };
    const auto near_balls = [&](const V3& a, double radius, const V3& b, double other_radius) {
      return within(a, b, radius + other_radius + slack, longest_step_from(rate, other_rate, b, other_radius));
    };
    if (!pair.same_bodies(scene, p)) {
      near = near_balls(one.whole(), one.radius(0), two.whole(), two.radius(0));
    }
    if (!near) continue;
    const V3 other = PairOfParts::whole(pair.second, two);
    if (!pair.all() &&
        !near_balls(PairOfParts::whole(pair.first, one), pair.first.whole.radius, other, pair.second.whole.radius)) {
      continue;
    }
    pair.each(one, two, other, near_balls, [&](unsigned k, unsigned l, const V3& block, double block_radius) {
      const V moved = longest_step_from(rate, other_rate, block, block_radius);
      for (unsigned i = one.first(k); i < one.end(k); ++i) {
        const V3 c = one.centre(i);
        if (!within(c, block, one.radius(i) + block_radius + slack, moved)) continue;
        const V3 step = rate.at(c);
        for (unsigned j = two.first(l); j < two.end(l); ++j) {
          const V3 to = two.centre(j);
          const V3 d = c - to;
          const V squared = dot(d, d);
          const V left = squared - abs(dot(d, step - other_rate.at(to)));
          const double reach = one.radius(i) + two.radius(j) + slack;
          hit |= bits((left <= spread(0.0)) | (left * left <= spread(reach * reach) * squared));
        }
      }
    });
    if (hit == 0xffU) return hit;
  }
  return hit;
}

void measure_chain(const ChainBody* bodies, unsigned count, const Lanes* frames, const Lanes* rates,
                   const Scene3& scene, const ChainMotion& motion, Lanes* centres, unsigned* scratch, Lanes& least_out,
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
    PlacedBody own(bodies, b, frames, scene, centres, scratch);
    const V3 whole = own.begin();
    if (scene.bounded) own.fill_all();
    for (unsigned i = 1; i < body.ball_count && scene.bounded; ++i) {
      const V3 c = own.centre(i);
      const V3 step = rate.at(c);
      const V r = spread(body.balls[i].radius);
      note(min(c.x - spread(scene.lo[0]), spread(scene.hi[0]) - c.x) - r, abs(step.x), bend);
      note(min(c.y - spread(scene.lo[1]), spread(scene.hi[1]) - c.y) - r, abs(step.y), bend);
      note(min(c.z - spread(scene.lo[2]), spread(scene.hi[2]) - c.z) - r, abs(step.z), bend);
    }
    const V moved = longest_step(rate, whole, body.balls[0].radius);
    /// Whether balls that are within a ball say nothing more.
    const auto farther = [&](const V3& c, double radius, const V& by, const Solid3& solid) {
      const Placement about = placement(c, solid);
      return enough(root(about.squared) - spread(about.round + radius), by, bend);
    };
    for (unsigned s = 0; s < scene.solid_count; ++s) {
      const Solid3& solid = scene.solids[s];
      if (farther(whole, body.balls[0].radius, moved, solid)) continue;
      for (unsigned k = 0; k < body.block_count; ++k) {
        if (body.block_count > 1) {
          const V3 c = own.block(k);
          const double radius = own.block_radius(k);
          if (farther(c, radius, longest_step(rate, c, radius), solid)) continue;
        }
        own.fill(k);
        for (unsigned i = own.first(k); i < own.end(k); ++i) {
          const V3 c = own.centre(i);
          const Placement place = placement(c, solid);
          const V distance = root(place.squared);
          V scale = distance;
          const V change = abs(toward(place, rate.at(c), solid, scale));
          note(distance - spread(place.round + own.radius(i)), change / max(scale * distance, tiny), bend);
        }
      }
    }
    for (unsigned k = 0; k < scene.cloud_count; ++k) {
      const Cloud3& cloud = scene.clouds[k];
      const V reach = max(least, (sure + moved) + spread(bend)) + spread(body.balls[0].radius + cloud.radius);
      if (near_cloud(whole, reach, cloud, 0xffU) == 0) continue;
      own.fill_all();
      Lanes lowest, certain;
      store(lowest.v, least);
      store(certain.v, sure);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = own.centre(i);
        measure_cloud(c, rate.at(c), body.balls[i].radius, bend, cloud, lowest, certain);
      }
      least = load(lowest.v);
      sure = load(certain.v);
    }
  }
  bool near = false;
  for (unsigned p = 0; p < scene.pair_count; ++p) {
    const PairOfParts pair(scene, p);
    PlacedBody one(bodies, pair.first.body, frames, scene, centres, scratch);
    PlacedBody two(bodies, pair.second.body, frames, scene, centres, scratch);
    const double bend = motion.pair_bend[p];
    const Rate rate = rate_of(frames, rates, pair.first.body);
    const Rate other_rate = rate_of(frames, rates, pair.second.body);
    const auto farther = [&](const V3& c, const V3& other, double reach, const V& by) {
      return enough(length(c - other) - spread(reach), by, bend);
    };
    const auto near_balls = [&](const V3& a, double radius, const V3& b, double other_radius) {
      return !farther(a, b, radius + other_radius, longest_step_from(rate, other_rate, b, other_radius));
    };
    if (!pair.same_bodies(scene, p)) {
      near = near_balls(one.whole(), one.radius(0), two.whole(), two.radius(0));
    }
    if (!near) continue;
    const V3 other = PairOfParts::whole(pair.second, two);
    if (!pair.all() &&
        !near_balls(PairOfParts::whole(pair.first, one), pair.first.whole.radius, other, pair.second.whole.radius)) {
      continue;
    }
    pair.each(one, two, other, near_balls, [&](unsigned k, unsigned l, const V3& block, double block_radius) {
      const V by = longest_step_from(rate, other_rate, block, block_radius);
      for (unsigned i = one.first(k); i < one.end(k); ++i) {
        const V3 c = one.centre(i);
        if (farther(c, block, one.radius(i) + block_radius, by)) continue;
        const V3 step = rate.at(c);
        for (unsigned j = two.first(l); j < two.end(l); ++j) {
          const V3 to = two.centre(j);
          const V3 d = c - to;
          const V distance = length(d);
          const V change = abs(dot(d, step - other_rate.at(to)));
          note(distance - spread(one.radius(i) + two.radius(j)), change / max(distance, tiny), bend);
        }
      }
    });
  }
  store(least_out.v, least);
  store(sure_out.v, sure);
}

#include <trellis/collision/spatial/configuration_kernel.inl>
