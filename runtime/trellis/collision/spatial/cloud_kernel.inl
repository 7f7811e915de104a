// SPDX-License-Identifier: GPL-3.0-or-later
// Balls of a manipulator against the points of clouds; see sphere_kernel.inl. A ball is at another place in each lane:
// the lanes are decided one after the other, and eight points at a time.

/// Where the balls of all lanes are among the cells of a cloud.
struct CloudPlace {
  Lanes x, y, z;  ///< the cell of the nearest point of the grid, as numbers with fractions
  Lanes beyond;   ///< the square of the distance from the grid
};

inline void place_in(const Cloud3& cloud, const V3& c, CloudPlace& out) {
  const auto along = [&](const V& at, unsigned k, Lanes& to) {
    const V inside = min(max(at, spread(cloud.lo[k])), spread(cloud.hi[k]));
    store(to.v, (inside - spread(cloud.lo[k])) * spread(cloud.per_metre));
    return at - inside;
  };
  const V3 out_by{along(c.x, 0, out.x), along(c.y, 1, out.y), along(c.z, 2, out.z)};
  store(out.beyond.v, dot(out_by, out_by));
}

/// A number that the square of the distance of the nearest point is not below.
inline double least_squared(const Cloud3& cloud, const CloudPlace& place, unsigned lane) {
  const auto i = static_cast<unsigned>(place.x.v[lane]);
  const auto j = static_cast<unsigned>(place.y.v[lane]);
  const auto k = static_cast<unsigned>(place.z.v[lane]);
  const auto clear = static_cast<double>(cloud.clear[(k * cloud.count[1] + j) * cloud.count[0] + i]);
  // The grid is convex: seen from its nearest place, all points are farther by what lies beyond.
  return (place.beyond.v[lane] + clear * clear) * (1.0 - 1e-9);
}

/// Calls `visit` with the blocks of points that may lie within `reach` of (x, y, z), from the middle outwards, until it
/// returns true; returns whether it did. Blocks have other points of the cloud too.
template <class Visit>
inline bool any_block(const Cloud3& cloud, double x, double y, double z, double reach, const Visit& visit) {
  // More than rounding.
  const double wide = reach * (1.0 + 1e-9) + cloud.cell * 1e-9;
  const auto first = [&](double at, unsigned k) {
    const double cell = (at - cloud.lo[k]) * cloud.per_metre;
    if (!(cell > 0.0)) return 0;
    const auto last = static_cast<double>(cloud.count[k] - 1);
    return static_cast<int>(cell < last ? cell : last);
  };
  const auto away = [&](double at, int cell, unsigned k) {
    const double from = cloud.lo[k] + cell * cloud.cell;
    const double below = from - at;
    const double above = at - (from + cloud.cell);
    const double by = (below > above ? below : above) - cloud.cell * 1e-9;
    return by > 0.0 ? by : 0.0;
  };
  if (x + wide < cloud.lo[0] || y + wide < cloud.lo[1] || z + wide < cloud.lo[2] || x - wide > cloud.hi[0] ||
      y - wide > cloud.hi[1] || z - wide > cloud.hi[2]) {
    return false;
  }
  const int j0 = first(y - wide, 1), j1 = first(y + wide, 1), jm = first(y, 1);
  const int k0 = first(z - wide, 2), k1 = first(z + wide, 2), km = first(z, 2);
  const double most = wide * wide;
  for (int s = 0; s <= 2 * (k1 - k0) + 1; ++s) {
    const int k = (s & 1) != 0 ? km - (s + 1) / 2 : km + s / 2;
    if (k < k0 || k > k1) continue;
    const double dz = away(z, k, 2);
    for (int t = 0; t <= 2 * (j1 - j0) + 1; ++t) {
      const int j = (t & 1) != 0 ? jm - (t + 1) / 2 : jm + t / 2;
      if (j < j0 || j > j1) continue;
      const double dy = away(y, j, 1);
      const double left = most - (dy * dy + dz * dz);
      if (left < 0.0) continue;
      const double half = __builtin_sqrt(left);
      const unsigned row = (static_cast<unsigned>(k) * cloud.count[1] + static_cast<unsigned>(j)) * cloud.count[0];
      const unsigned begin = cloud.begin[row + static_cast<unsigned>(first(x - half, 0))];
      const unsigned end = cloud.begin[row + static_cast<unsigned>(first(x + half, 0)) + 1];
      if (begin == end) continue;
      for (unsigned block = begin / lanes; block <= (end - 1) / lanes; ++block) {
        if (visit(V3{load(cloud.x[block].v), load(cloud.y[block].v), load(cloud.z[block].v)})) return true;
      }
    }
  }
  return false;
}

/// Returns the lanes, of those asked for, in which a ball about c may come within `radius` of a point.
inline unsigned near_cloud(const V3& c, const V& radius, const Cloud3& cloud, unsigned asked) {
  CloudPlace place;
  Lanes reach;
  place_in(cloud, c, place);
  store(reach.v, radius * radius);
  unsigned near = 0;
  for (unsigned lane = 0; lane < lanes; ++lane) {
    if ((asked >> lane & 1U) != 0 && least_squared(cloud, place, lane) <= reach.v[lane]) near |= 1U << lane;
  }
  return near;
}

/// Returns the lanes, of those asked for, in which a ball about c meets a ball of the cloud. Once one does, the lanes
/// after it are not decided.
inline unsigned meets_cloud(const V3& c, double radius, const Cloud3& cloud, unsigned asked) {
  const double reach = radius + cloud.radius;
  const unsigned near = near_cloud(c, spread(reach), cloud, asked);
  if (near == 0) return 0;
  Lanes x, y, z;
  store(x.v, c.x);
  store(y.v, c.y);
  store(z.v, c.z);
  const V most = spread(reach * reach);
  for (unsigned lane = 0; lane < lanes; ++lane) {
    if ((near >> lane & 1U) == 0) continue;
    const V3 at{spread(x.v[lane]), spread(y.v[lane]), spread(z.v[lane])};
    const auto meets = [&](const V3& points) {
      const V3 d = at - points;
      return bits(dot(d, d) <= most) != 0;
    };
    if (any_block(cloud, x.v[lane], y.v[lane], z.v[lane], reach, meets)) return 1U << lane;
  }
  return 0;
}

/// As `approaches`, from the balls of a cloud, in the lanes asked for.
inline unsigned approaches_cloud(const V3& c, const V3& step, const V& moved, double reach, const Cloud3& cloud,
                                 unsigned asked) {
  const double reached = reach + cloud.radius;
  const V far = spread(reached) + moved;
  const unsigned near = near_cloud(c, far, cloud, asked);
  if (near == 0) return 0;
  Lanes x, y, z, dx, dy, dz, within;
  store(x.v, c.x);
  store(y.v, c.y);
  store(z.v, c.z);
  store(dx.v, step.x);
  store(dy.v, step.y);
  store(dz.v, step.z);
  store(within.v, far);
  unsigned hit = 0;
  for (unsigned lane = 0; lane < lanes; ++lane) {
    if ((near >> lane & 1U) == 0) continue;
    const V3 at{spread(x.v[lane]), spread(y.v[lane]), spread(z.v[lane])};
    const V3 by{spread(dx.v[lane]), spread(dy.v[lane]), spread(dz.v[lane])};
    const V most = spread(within.v[lane] * within.v[lane]);
    const auto may = [&](const V3& points) {
      const V3 d = at - points;
      const V squared = dot(d, d);
      const V left = squared - abs(dot(d, by));
      const M closes = (left <= spread(0.0)) | (left * left <= spread(reached * reached) * squared);
      return bits((squared <= most) & closes) != 0;
    };
    if (any_block(cloud, x.v[lane], y.v[lane], z.v[lane], within.v[lane], may)) hit |= 1U << lane;
  }
  return hit;
}

/// The least number of a vector's lanes.
inline double least_lane(const V& v) {
  Lanes all;
  store(all.v, v);
  double least = all.v[0];
  for (unsigned lane = 1; lane < lanes; ++lane) least = all.v[lane] < least ? all.v[lane] : least;
  return least;
}

/// Lowers `least` to the distance of a ball from those of a cloud, and `sure` to what is certain on the motion.
inline void measure_cloud(const V3& c, const V3& step, double radius, double bend, const Cloud3& cloud, Lanes& least,
                          Lanes& sure) {
  CloudPlace place;
  place_in(cloud, c, place);
  Lanes x, y, z, dx, dy, dz, moved;
  store(x.v, c.x);
  store(y.v, c.y);
  store(z.v, c.z);
  store(dx.v, step.x);
  store(dy.v, step.y);
  store(dz.v, step.z);
  store(moved.v, length(step));
  const double reached = radius + cloud.radius;
  for (unsigned lane = 0; lane < lanes; ++lane) {
    const double at_least = __builtin_sqrt(least_squared(cloud, place, lane));
    const double by = moved.v[lane];
    // Farther points lower neither.
    const double enough =
        reached + (least.v[lane] > sure.v[lane] + by + bend ? least.v[lane] : sure.v[lane] + by + bend);
    if (!(at_least < enough)) continue;
    // The nearest point is not farther than the far corner of the cell that `clear` is measured to, but where the ball
    // lies beyond the grid.
    const double diagonal = 2.0 * 1.7320508075688774 * 1.0001 * cloud.cell;
    const double beyond = __builtin_sqrt(place.beyond.v[lane]);
    const double nearest = at_least + diagonal + beyond + by;
    const double reach = nearest < enough ? nearest : enough;
    const V3 at{spread(x.v[lane]), spread(y.v[lane]), spread(z.v[lane])};
    const V3 along{spread(dx.v[lane]), spread(dy.v[lane]), spread(dz.v[lane])};
    V lowest = spread(least.v[lane]);
    V certain = spread(sure.v[lane]);
    static_cast<void>(any_block(cloud, x.v[lane], y.v[lane], z.v[lane], reach, [&](const V3& points) {
      const V3 d = at - points;
      const V distance = length(d);
      const V gap = distance - spread(reached);
      lowest = min(lowest, gap);
      const V change = abs(dot(d, along)) / max(distance, spread(1e-300));
      certain = min(certain, (gap - change) - spread(bend));
      return false;
    }));
    least.v[lane] = least_lane(lowest);
    sure.v[lane] = least_lane(certain);
  }
}
