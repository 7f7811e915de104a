// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/ball_graph.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include <trellis/base/error.hpp>
#include <trellis/scene/set_up_cache.hpp>
#include <trellis/scene/spatial/free_distance.hpp>

namespace trellis {

namespace {

using Ball = BallGraph::Ball;

constexpr double infinity = std::numeric_limits<double>::infinity();

double longest_side(const Vec3& extent) { return std::max({extent.x, extent.y, extent.z}); }

/// Balls in a grid of buckets: each ball is in all buckets that it may meet.
class Buckets {
 public:
  Buckets(const Box3& region, double side) : lo_(region.lo) {
    const Vec3 extent = region.hi - region.lo;
    const std::array<double, 3> sides = {extent.x, extent.y, extent.z};
    for (std::size_t i = 0; i < 3; ++i) {
      counts_[i] = static_cast<std::size_t>(std::max(1.0, std::ceil(sides[i] / side)));
      per_metre_[i] = static_cast<double>(counts_[i]) / sides[i];
    }
    buckets_.resize(counts_[0] * counts_[1] * counts_[2]);
  }

  void add(std::uint32_t id, const Ball& ball) {
    for_each(ball, [&](std::vector<std::uint32_t>& bucket) { bucket.push_back(id); });
  }
  /// The balls that may contain p.
  [[nodiscard]] const std::vector<std::uint32_t>& at(const Vec3& p) const {
    return buckets_[index(place(0, p.x - lo_.x), place(1, p.y - lo_.y), place(2, p.z - lo_.z))];
  }
  /// Calls f with each bucket that a ball may meet.
  template <class F>
  void for_each(const Ball& ball, const F& f) {
    const Vec3 c = ball.centre - lo_;
    const double r = ball.radius;
    for (std::size_t k = place(2, c.z - r); k <= place(2, c.z + r); ++k) {
      for (std::size_t j = place(1, c.y - r); j <= place(1, c.y + r); ++j) {
        for (std::size_t i = place(0, c.x - r); i <= place(0, c.x + r); ++i) f(buckets_[index(i, j, k)]);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t place(std::size_t axis, double along) const {
    const auto last = static_cast<double>(counts_[axis] - 1);
    return static_cast<std::size_t>(std::clamp(std::floor(along * per_metre_[axis]), 0.0, last));
  }
  [[nodiscard]] std::size_t index(std::size_t i, std::size_t j, std::size_t k) const {
    return (k * counts_[1] + j) * counts_[0] + i;
  }

  Vec3 lo_;
  std::array<std::size_t, 3> counts_{};
  std::array<double, 3> per_metre_{};
  std::vector<std::vector<std::uint32_t>> buckets_;
};

/// Finds the balls of a world.
class BallSearch {
 public:
  BallSearch(const FreeDistance& distance, const Box3& bounds, double resolution)
      : distance_(distance), bounds_(bounds), resolution_(resolution), buckets_(bounds, 4.0 * resolution) {}

  [[nodiscard]] std::vector<Ball> balls() {
    constexpr double largest = 16.0;  // cells, in the smallest ones
    const Vec3 extent = bounds_.hi - bounds_.lo;
    const auto count = [&](double side) { return std::max(1.0, std::ceil(side / (largest * resolution_))); };
    const Vec3 counts{count(extent.x), count(extent.y), count(extent.z)};
    const Vec3 half{0.5 * extent.x / counts.x, 0.5 * extent.y / counts.y, 0.5 * extent.z / counts.z};
    for (double k = 0.5; k < counts.z; k += 1.0) {
      for (double j = 0.5; j < counts.y; j += 1.0) {
        for (double i = 0.5; i < counts.x; i += 1.0) {
          enter(bounds_.lo + Vec3{2.0 * i * half.x, 2.0 * j * half.y, 2.0 * k * half.z}, half);
        }
      }
    }
    while (!open_.empty()) {
      const Cell cell = open_.top();
      open_.pop();
      visit(cell);
    }
    return std::move(balls_);
  }

  /// Returns the largest ball that touches the obstacle nearest to c where the one about c does. It contains that one.
  [[nodiscard]] Ball maximal(const Vec3& c) const {
    const FreeDistance::Nearest touched = distance_.nearest(c);
    if (!(touched.distance > 0.0)) return {c, 0.0};
    const Vec3 away = (1.0 / touched.distance) * (c - touched.point);
    // Balls that touch there shrink until nothing is nearer than that point (the shrinking ball algorithm: Ma, Bae and
    // Choi 2012, 3D medial axis point approximation using nearest neighbors and the normal field). Each one is as large
    // as the nearest point of the last one's centre allows, or larger.
    double radius = std::max(touched.distance, reach(c, away) + touched.distance);
    constexpr int most_steps = 60;
    constexpr double close = 1e-6;
    for (int step = 0; step < most_steps; ++step) {
      const Vec3 centre = touched.point + radius * away;
      const FreeDistance::Nearest found = distance_.nearest(centre);
      if (found.distance >= (1.0 - close) * radius) return {centre, found.distance};
      const Vec3 chord = found.point - touched.point;
      const double along = dot(chord, away);
      const double next = along > 0.0 ? 0.5 * dot(chord, chord) / along : 0.5 * radius;
      radius = std::max(touched.distance, std::min(next, (1.0 - 0.1 * close) * radius));
      if (radius == touched.distance) break;
    }
    return {c, touched.distance};
  }

 private:
  struct Cell {
    Vec3 centre;
    Vec3 half;              ///< sides
    double distance = 0.0;  ///< of the centre
    double key = 0.0;       ///< no point of the cell has a greater distance
    std::uint64_t order = 0;
    friend bool operator<(const Cell& a, const Cell& b) {
      return a.key < b.key || (a.key == b.key && a.order > b.order);
    }
  };

  void enter(const Vec3& centre, const Vec3& half) {
    Cell cell{centre, half, distance_(centre), 0.0, order_++};
    const double reach = norm(half);
    // The world without obstacles has no balls.
    if (cell.distance == infinity || cell.distance + reach < resolution_) return;
    cell.key = cell.distance + (divisible(cell) ? reach : 0.0);
    open_.push(cell);
  }

  [[nodiscard]] bool divisible(const Cell& cell) const { return 2.0 * longest_side(cell.half) > 1.5 * resolution_; }

  /// Whether a ball contains the ball of this radius about p.
  [[nodiscard]] bool covered(const Vec3& p, double radius) const {
    const auto& near = buckets_.at(p);
    return std::any_of(near.begin(), near.end(),
                       [&](std::uint32_t id) { return norm(p - balls_[id].centre) + radius <= balls_[id].radius; });
  }

  void visit(const Cell& cell) {
    const double reach = norm(cell.half);
    // A cell that is small for its distance, or as small as cells are, is given up where what is covered about its
    // centre meets what is covered about the centres of its neighbours.
    constexpr double small = 0.25;
    const bool whole = !divisible(cell) || reach <= small * cell.distance;
    if (covered(cell.centre, whole ? std::min(reach, 0.5 * cell.distance) : reach)) return;
    if (!whole) {
      const Vec3 half = 0.5 * cell.half;
      for (const double z : {-half.z, half.z}) {
        for (const double y : {-half.y, half.y}) {
          for (const double x : {-half.x, half.x}) enter(cell.centre + Vec3{x, y, z}, half);
        }
      }
      return;
    }
    if (cell.distance < resolution_) return;
    const Ball ball = maximal(cell.centre);
    buckets_.add(static_cast<std::uint32_t>(balls_.size()), ball);
    balls_.push_back(ball);
  }

  /// Returns how far a ray goes from c, a point of the bounds, until it leaves them.
  [[nodiscard]] double reach(const Vec3& c, const Vec3& direction) const {
    double least = infinity;
    const auto offer = [&](double from, double along, double lo, double hi) {
      if (along > 0.0) least = std::min(least, (hi - from) / along);
      if (along < 0.0) least = std::min(least, (lo - from) / along);
    };
    offer(c.x, direction.x, bounds_.lo.x, bounds_.hi.x);
    offer(c.y, direction.y, bounds_.lo.y, bounds_.hi.y);
    offer(c.z, direction.z, bounds_.lo.z, bounds_.hi.z);
    return std::max(0.0, least);
  }

  const FreeDistance& distance_;
  Box3 bounds_;
  double resolution_;
  std::priority_queue<Cell> open_;
  std::uint64_t order_ = 0;
  std::vector<Ball> balls_;
  Buckets buckets_;
};

/// Which balls overlap.
class Overlaps {
 public:
  Overlaps(const std::vector<Ball>& balls, const Box3& bounds, double resolution) : balls_(balls) {
    Buckets buckets(bounds, 4.0 * resolution);
    near_.resize(balls.size());
    for (std::uint32_t i = 0; i < balls.size(); ++i) {
      std::vector<std::uint32_t>& mine = near_[i];
      buckets.for_each(balls[i], [&](std::vector<std::uint32_t>& bucket) {
        mine.insert(mine.end(), bucket.begin(), bucket.end());
        bucket.push_back(i);
      });
      std::sort(mine.begin(), mine.end());
      mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
      std::erase_if(mine, [&](std::uint32_t j) { return !(width(i, j) > 0.0); });
    }
    for (std::uint32_t i = 0; i < balls.size(); ++i) {
      for (const std::uint32_t j : std::vector(near_[i])) {
        if (j < i) near_[j].push_back(i);
      }
    }
  }

  [[nodiscard]] const std::vector<std::uint32_t>& of(std::uint32_t i) const { return near_[i]; }
  [[nodiscard]] double length(std::uint32_t i, std::uint32_t j) const {
    return norm(balls_[j].centre - balls_[i].centre);
  }
  /// How far the portal of two balls is from the centre of the first, along the line of both.
  [[nodiscard]] double portal(std::uint32_t i, std::uint32_t j) const {
    const double d = length(i, j);
    const double r = balls_[i].radius, s = balls_[j].radius;
    return d > 0.0 ? std::clamp(0.5 * (d * d + r * r - s * s) / d, 0.0, d) : 0.0;
  }
  /// The radius of the disc in which the surfaces of two balls meet; of two balls of which one contains the other's
  /// centre, at least the radius of the smaller; 0 where they are apart.
  [[nodiscard]] double width(std::uint32_t i, std::uint32_t j) const {
    const double r = balls_[i].radius, s = balls_[j].radius;
    if (length(i, j) >= r + s) return 0.0;
    const double x = portal(i, j);
    const double y = length(i, j) - x;
    return std::sqrt(std::max(0.0, std::min(r * r - x * x, s * s - y * y)));
  }

  /// Takes the balls away that are less than half as large as a neighbour and whose neighbours are connected without
  /// them, the smallest ones first.
  void drop_corners() {
    std::vector<std::uint32_t> order(balls_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return balls_[a].radius < balls_[b].radius; });
    constexpr double small = 0.5;
    for (const std::uint32_t i : order) {
      double largest = 0.0;
      for (const std::uint32_t j : near_[i]) largest = std::max(largest, balls_[j].radius);
      if (balls_[i].radius >= small * largest || !connected(near_[i])) continue;
      for (const std::uint32_t j : near_[i]) std::erase(near_[j], i);
      near_[i].clear();
      dropped_.push_back(i);
    }
    std::sort(dropped_.begin(), dropped_.end());
  }
  [[nodiscard]] bool dropped(std::uint32_t i) const { return std::binary_search(dropped_.begin(), dropped_.end(), i); }

  /// Whether an edge is needed: there is no ball by which the detour is short and as wide, over edges that are shorter.
  /// Those are needed or have such a detour themselves, so that nothing is disconnected, and no passage gets narrower.
  [[nodiscard]] bool needed(std::uint32_t i, std::uint32_t j) const {
    constexpr double detour = 1.3;
    const double direct = length(i, j);
    const double wide = width(i, j);
    return std::none_of(near_[i].begin(), near_[i].end(), [&](std::uint32_t k) {
      if (k == j) return false;
      const double first = length(i, k), second = length(k, j);
      return first < direct && second < direct && first + second <= detour * direct && width(i, k) >= wide &&
             width(k, j) >= wide;
    });
  }

 private:
  /// Whether balls are connected by overlaps among them.
  [[nodiscard]] bool connected(const std::vector<std::uint32_t>& some) const {
    if (some.empty()) return false;
    std::vector<char> reached(some.size(), 0);
    std::vector<std::size_t> open = {0};
    reached[0] = 1;
    std::size_t count = 1;
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      for (std::size_t k = 0; k < some.size(); ++k) {
        if (reached[k] != 0 || !(width(some[at], some[k]) > 0.0)) continue;
        reached[k] = 1;
        ++count;
        open.push_back(k);
      }
    }
    return count == some.size();
  }

  const std::vector<Ball>& balls_;
  std::vector<std::vector<std::uint32_t>> near_;
  std::vector<std::uint32_t> dropped_;
};

/// Makes the edge between the centres of two balls.
class EdgeMaker {
 public:
  EdgeMaker(const FreeDistance& distance, double spacing) : distance_(distance), spacing_(spacing) {}

  [[nodiscard]] BallGraph::Edge edge(const Ball& a, const Ball& b, double portal, double width) const {
    BallGraph::Edge edge;
    const double length = norm(b.centre - a.centre);
    edge.points.push_back(a.centre);
    edge.clearance.push_back(a.radius);
    if (length > 0.0) {
      const Vec3 along = (1.0 / length) * (b.centre - a.centre);
      const Vec3 middle = moved_away(a.centre + portal * along, along, width);
      append(edge, middle);
      append(edge, b.centre);
    } else {
      edge.points.push_back(b.centre);
      edge.clearance.push_back(b.radius);
    }
    edge.clearance.back() = b.radius;
    for (std::size_t i = 1; i < edge.points.size(); ++i) edge.length += norm(edge.points[i] - edge.points[i - 1]);
    return edge;
  }

 private:
  /// Appends points of the straight line to p, and p.
  void append(BallGraph::Edge& edge, const Vec3& p) const {
    const Vec3 from = edge.points.back();
    const double length = norm(p - from);
    if (!(length > 0.0)) return;
    const double pieces = std::max(1.0, std::ceil(length / spacing_));
    for (double i = 1.0; i <= pieces; i += 1.0) {
      const Vec3 at = i == pieces ? p : from + (i / pieces) * (p - from);
      edge.points.push_back(at);
      edge.clearance.push_back(std::max(0.0, distance_(at)));
    }
  }

  /// Returns the point of a disc about p, across `along`, that is farthest from obstacles, as steps uphill find it.
  [[nodiscard]] Vec3 moved_away(const Vec3& p, const Vec3& along, double radius) const {
    Vec3 best = p;
    FreeDistance::Nearest at = distance_.nearest(p);
    constexpr double least = 1.0 / 64.0;
    for (double step = 0.5 * radius; step > least * radius;) {
      const Vec3 up = best - at.point;
      const Vec3 across = up - dot(up, along) * along;
      const double slope = norm(across);
      if (!(slope > 1e-3 * norm(up))) break;
      const Vec3 next = best + (step / slope) * across;
      if (norm(next - p) <= radius) {
        const FreeDistance::Nearest there = distance_.nearest(next);
        if (there.distance > at.distance) {
          best = next;
          at = there;
          continue;
        }
      }
      step *= 0.5;
    }
    return best;
  }

  const FreeDistance& distance_;
  double spacing_;
};

}  // namespace

BallGraph ball_graph(const World3& world, double resolution, double spacing) {
  const Vec3 extent = world.bounds().hi - world.bounds().lo;
  BallGraph graph;
  constexpr double most_along_a_side = 128.0;
  constexpr double most_cells = 200'000.0;
  graph.resolution = resolution > 0.0 ? resolution
                                      : std::max(longest_side(extent) / most_along_a_side,
                                                 std::cbrt(extent.x * extent.y * extent.z / most_cells));
  if (!(spacing > 0.0)) spacing = norm(extent) / 200.0;
  const FreeDistance distance(world);
  const std::vector<Ball> all = BallSearch(distance, world.bounds(), graph.resolution).balls();
  if (all.empty()) {
    if (world.obstacles().empty()) return graph;
    throw Error("the world leaves no free space for a skeleton");
  }
  Overlaps overlaps(all, world.bounds(), graph.resolution);
  overlaps.drop_corners();
  std::vector<std::uint32_t> number(all.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    number[i] = static_cast<std::uint32_t>(graph.balls.size());
    if (!overlaps.dropped(i)) graph.balls.push_back(all[i]);
  }
  const EdgeMaker maker(distance, spacing);
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    for (const std::uint32_t j : overlaps.of(i)) {
      if (j < i || !overlaps.needed(i, j)) continue;
      graph.edges.push_back(maker.edge(all[i], all[j], overlaps.portal(i, j), overlaps.width(i, j)));
      graph.edges.back().from = number[i];
      graph.edges.back().to = number[j];
    }
  }
  return graph;
}

std::shared_ptr<const BallGraph> cached_ball_graph(const World3& world) {
  static SetUpCache<BallGraph> cache;
  return cache.get(world, [](const World3& of) { return ball_graph(of); });
}

}  // namespace trellis
