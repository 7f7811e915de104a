// SPDX-License-Identifier: GPL-3.0-or-later
// One configuration of a manipulator: the lanes are its joints, its balls or the solids. All numbers are computed by
// the operations of meet_chain, so the answers are the same. See planar/kernel_impl.inl.

/// Eight solids of one kind.
struct EightSolids {
  const SolidBlock& of;

  [[nodiscard]] Solid3::Kind kind() const { return of.kind; }
  [[nodiscard]] V3 centre() const { return load(of.values); }
  [[nodiscard]] V3 row(unsigned i) const { return load(of.values + 3UL + 3UL * i); }
  [[nodiscard]] V3 half() const { return load(of.values + 12); }
  [[nodiscard]] V radius() const { return load(of.values[12].v); }
  [[nodiscard]] V length() const { return load(of.values[13].v); }
};

/// A manipulator at one configuration.
class OneChain {
 public:
  OneChain(const ChainBody* bodies, unsigned count, const double* values, const Scene3& scene,
           const ChainMemory& memory)
      : bodies_(bodies), scene_(scene), memory_(memory) {
    // The base stays where it is.
    for (unsigned b = 1; b < count; ++b) memory.placed[b] = bodies[b].given ? moved : 0;
    for (unsigned first = 0; first < count; first += lanes) {
      Lanes* own = memory.angles + 3UL * (first / lanes);
      for (unsigned k = 0; k < lanes; ++k) {
        const unsigned b = first + k;
        own[0].v[k] = b == 0 || b >= count ? 0.0 : bodies[b].multiplier * values[bodies[b].column] + bodies[b].offset;
      }
      V sine = spread(0.0);
      V cosine = sine;
      sine_cosine(load(own[0].v), sine, cosine);
      store(own[1].v, sine);
      store(own[2].v, spread(1.0) - cosine);
    }
  }

  /// Whether a body touches a solid, a cloud, or the bounds.
  bool touches_world(unsigned b) {
    const ChainBody& body = bodies_[b];
    move(b);
    const V slack = spread(scene_.slack);
    if (scene_.bounded && leaves_bounds(b)) return true;
    for (unsigned k = 0; k < body.block_count; ++k) {
      const V3 c = centres(b, k);
      const V radius = radii(b, k) + slack;
      const V3 first = ball(b, k, 0);
      const V own = spread(body.ball_blocks[4UL * k + 3].v[0]) + slack;
      const V whole = spread(body.block_radii[k]) + slack;
      for (unsigned s = 0; s < scene_.solid_block_count; ++s) {
        const SolidBlock& block = scene_.solid_blocks[s];
        const CoreDistance distance = core_distance(first, EightSolids{block});
        unsigned near = bits(distance.within(whole));
        if (near == 0) continue;
        if (bits(distance.within(own)) != 0) return true;
        for (; near != 0; near &= near - 1) {
          const OneSolid solid{scene_.solids[block.solid[__builtin_ctz(near)]]};
          if (bits(ball_meets(c, radius, solid)) != 0) return true;
        }
      }
      for (unsigned i = 0; i < scene_.cloud_count; ++i) {
        if (touches_cloud(b, k, scene_.clouds[i])) return true;
      }
    }
    return false;
  }

  /// Whether two parts touch.
  bool touch(const BallPart& one, const BallPart& other_part) {
    const unsigned a = one.body;
    const unsigned b = other_part.body;
    const ChainBody& first = bodies_[a];
    const ChainBody& second = bodies_[b];
    const V slack = spread(scene_.slack);
    for (unsigned k = one.first_block; k < one.end_block; ++k) {
      for (unsigned l = other_part.first_block; l < other_part.end_block; ++l) {
        const V3 two = centres(b, l);
        const V radius = radii(b, l);
        const V3 other = ball(b, l, 0);
        const V3 apart = centres(a, k) - other;
        const V reach = (radii(a, k) + spread(second.block_radii[l])) + slack;
        for (unsigned near = bits(dot(apart, apart) <= reach * reach); near != 0; near &= near - 1) {
          const auto i = static_cast<unsigned>(__builtin_ctz(near));
          const V3 d = ball(a, k, i) - two;
          const V far = (spread(first.ball_blocks[4UL * k + 3].v[i]) + radius) + slack;
          if (bits(dot(d, d) <= far * far) != 0) return true;
        }
      }
    }
    return false;
  }

 private:
  /// Of a body: its frame is known. Larger numbers: so are centres of so many of its blocks, less one.
  static constexpr unsigned moved = 1;

  /// Computes the frame of a body, and of those that carry it.
  void move(unsigned b) {
    using Row = double __attribute__((vector_size(32), may_alias));
    if (memory_.placed[b] != 0) return;
    const ChainBody& body = bodies_[b];
    move(body.parent);
    const double* parent = memory_.frames + 12UL * body.parent;
    double* frame = memory_.frames + 12UL * b;
    const Lanes* angles = memory_.angles + 3UL * (b / lanes);
    const double once = angles[body.slides ? 0 : 1].v[b % lanes];
    const double twice = body.slides ? 0.0 : angles[2].v[b % lanes];
    Row local[3];  // NOLINT(modernize-avoid-c-arrays)
    const auto row = [](const double* from) -> const Row& { return *reinterpret_cast<const Row*>(from); };
    for (unsigned k = 0; k < 3; ++k) {
      local[k] = (row(body.rows->origin + 4UL * k) + once * row(body.rows->once + 4UL * k)) +
                 twice * row(body.rows->twice + 4UL * k);
    }
    for (unsigned i = 0; i < 3; ++i) {
      const double* p = parent + 4UL * i;
      *reinterpret_cast<Row*>(frame + 4UL * i) =
          ((p[0] * local[0] + p[1] * local[1]) + p[2] * local[2]) + Row{0.0, 0.0, 0.0, p[3]};
    }
    memory_.placed[b] = moved;
  }

  [[nodiscard]] V radii(unsigned b, unsigned block) const { return load(bodies_[b].ball_blocks[4UL * block + 3].v); }
  /// The centres of a block, computed where they are not known.
  V3 centres(unsigned b, unsigned block) {
    const ChainBody& body = bodies_[b];
    const double* f = memory_.frames + 12UL * b;
    for (unsigned& known = memory_.placed[b]; known <= block + moved; ++known) {
      const V3 c = load(body.ball_blocks + 4UL * (known - moved));
      const auto along = [&](unsigned i) {
        const double* p = f + 4UL * i;
        return dot(V3{spread(p[0]), spread(p[1]), spread(p[2])}, c) + spread(p[3]);
      };
      store(memory_.centres + 3UL * (body.first_block + known - moved), V3{along(0), along(1), along(2)});
    }
    return load(memory_.centres + 3UL * (body.first_block + block));
  }
  /// The centre of a ball in all lanes.
  V3 ball(unsigned b, unsigned block, unsigned lane) {
    static_cast<void>(centres(b, block));
    const Lanes* own = memory_.centres + 3UL * (bodies_[b].first_block + block);
    return {spread(own[0].v[lane]), spread(own[1].v[lane]), spread(own[2].v[lane])};
  }

  bool touches_cloud(unsigned b, unsigned block, const Cloud3& cloud) {
    const ChainBody& body = bodies_[b];
    const double slack = scene_.slack;
    const V reach = spread(body.block_radii[block] + slack + cloud.radius);
    if (near_cloud(ball(b, block, 0), reach, cloud, 1U) == 0) return false;
    for (unsigned i = 0; i < lanes; ++i) {
      const double radius = body.ball_blocks[4UL * block + 3].v[i];
      if (radius == radius && meets_cloud(ball(b, block, i), radius + slack, cloud, 1U) != 0) return true;
    }
    return false;
  }

  bool leaves_bounds(unsigned b) {
    for (unsigned k = 0; k < bodies_[b].block_count; ++k) {
      const V3 c = centres(b, k);
      const V radius = radii(b, k);
      const V r = radius - spread(scene_.slack);
      const auto within = [&](const V& value, unsigned j) {
        return (spread(scene_.lo[j]) + r < value) & (value < spread(scene_.hi[j]) - r);
      };
      // NaN is not equal to itself.
      const unsigned balls = bits(equal(radius, radius));
      if ((~bits(within(c.x, 0) & within(c.y, 1) & within(c.z, 2)) & balls) != 0) return true;
    }
    return false;
  }

  const ChainBody* bodies_;
  const Scene3& scene_;
  const ChainMemory& memory_;
};

bool touches(const ChainBody* bodies, unsigned count, const double* values, const Scene3& scene, ChainMemory& memory) {
  using Base = ChainMemory::Base;
  OneChain chain(bodies, count, values, scene, memory);
  if (memory.base == Base::unknown) memory.base = chain.touches_world(0) ? Base::touches : Base::free;
  if (memory.base == Base::touches) return true;
  for (unsigned k = 0; k < memory.order_count; ++k) {
    const unsigned b = memory.order[k];
    if (!chain.touches_world(b)) continue;
    if (k > 0) {
      memory.order[k] = memory.order[k - 1];
      memory.order[k - 1] = b;
    }
    return true;
  }
  for (unsigned p = 0; p < scene.pair_count; ++p) {
    if (chain.touch(scene.parts[scene.pairs[2UL * p]], scene.parts[scene.pairs[2UL * p + 1]])) return true;
  }
  return false;
}
