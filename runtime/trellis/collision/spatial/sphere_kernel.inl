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

/// Returns the lanes in which a ball about c meets the solid.
inline M ball_meets(const V3& c, double radius, const Solid3& solid) {
  const V zero = spread(0.0);
  const V dx = c.x - spread(solid.x);
  const V dy = c.y - spread(solid.y);
  const V dz = c.z - spread(solid.z);
  if (solid.kind == Solid3::Kind::sphere) {
    const double reach = radius + solid.radius;
    return ((dx * dx + dy * dy) + dz * dz) <= spread(reach * reach);
  }
  const double* r = solid.r;
  const V u = (spread(r[0]) * dx + spread(r[1]) * dy) + spread(r[2]) * dz;
  const V v = (spread(r[3]) * dx + spread(r[4]) * dy) + spread(r[5]) * dz;
  const V w = (spread(r[6]) * dx + spread(r[7]) * dy) + spread(r[8]) * dz;
  if (solid.kind == Solid3::Kind::box) {
    const V a = max(abs(u) - spread(solid.hx), zero);
    const V b = max(abs(v) - spread(solid.hy), zero);
    const V e = max(abs(w) - spread(solid.hz), zero);
    return ((a * a + b * b) + e * e) <= spread(radius * radius);
  }
  const V e = max(abs(w) - spread(solid.length), zero);
  const V across = u * u + v * v;
  if (solid.kind == Solid3::Kind::capsule) {
    const double reach = radius + solid.radius;
    return (across + e * e) <= spread(reach * reach);
  }
  const V a = max(root(across) - spread(solid.radius), zero);
  return (a * a + e * e) <= spread(radius * radius);
}

unsigned meet_chain(const ChainBody* bodies, unsigned count, const Lanes* frames, const Scene3& scene, Lanes* centres,
                    unsigned* candidates) {
  unsigned hit = 0;
  const auto decided = [&] { return scene.all_lanes ? hit == 0xffU : (hit & 1U) != 0; };
  // Contact is likelier far from the base.
  for (unsigned b = count; b-- > 0;) {
    const ChainBody& body = bodies[b];
    if (body.ball_count == 0) continue;
    const double slack = scene.slack + scene.moved[b];
    const Lanes* frame = frames + 12UL * b;
    Lanes* own = centres + 3UL * body.first_centre;
    const V3 whole = at(frame, body.balls[0].x, body.balls[0].y, body.balls[0].z);
    store(own, whole);
    for (unsigned i = 1; i < body.ball_count; ++i) {
      store(own + 3UL * i, at(frame, body.balls[i].x, body.balls[i].y, body.balls[i].z));
    }
    if (scene.bounded) {
      M inside = spread(0.0) <= spread(1.0);
      for (unsigned i = 1; i < body.ball_count; ++i) {
        const V3 c = load(own + 3UL * i);
        const double r = body.balls[i].radius + (scene.moved[b] > 0.0 ? slack : -slack);
        inside = inside & (spread(scene.lo[0] + r) < c.x) & (c.x < spread(scene.hi[0] - r)) &
                 (spread(scene.lo[1] + r) < c.y) & (c.y < spread(scene.hi[1] - r)) & (spread(scene.lo[2] + r) < c.z) &
                 (c.z < spread(scene.hi[2] - r));
      }
      hit |= ~bits(inside) & 0xffU;
    }
    unsigned near = 0;
    for (unsigned s = 0; s < scene.solid_count; ++s) {
      const Solid3& solid = scene.solids[s];
      const double reach = body.balls[0].radius + solid.far + slack;
      const V dx = whole.x - spread(solid.x);
      const V dy = whole.y - spread(solid.y);
      const V dz = whole.z - spread(solid.z);
      if (bits(((dx * dx + dy * dy) + dz * dz) <= spread(reach * reach)) == 0) continue;
      if (bits(ball_meets(whole, body.balls[0].radius + slack, solid)) != 0) candidates[near++] = s;
    }
    for (unsigned i = 1; i < body.ball_count && near > 0; ++i) {
      const V3 c = load(own + 3UL * i);
      for (unsigned k = 0; k < near; ++k) {
        hit |= bits(ball_meets(c, body.balls[i].radius + slack, scene.solids[candidates[k]]));
      }
      if (decided()) return hit;
    }
    if (decided()) return hit;
  }
  for (unsigned p = 0; p < scene.pair_count; ++p) {
    const ChainBody& first = bodies[scene.pairs[2UL * p]];
    const ChainBody& second = bodies[scene.pairs[2UL * p + 1]];
    if (first.ball_count == 0 || second.ball_count == 0) continue;
    const double slack = scene.slack + scene.moved[scene.pairs[2UL * p]] + scene.moved[scene.pairs[2UL * p + 1]];
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
