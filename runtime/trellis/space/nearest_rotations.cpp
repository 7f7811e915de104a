// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest neighbours where a space has rotations: an incremental kd-tree of buckets over rows in which a distance is
// never more than the metric's. A rotation's quaternion is scaled by twice its weight: the chord between two
// quaternions is 2 sin(angle / 4), so twice the weight times the chord is at most the weight times the angle. q and -q
// are one rotation, so a box is as near as the nearer of the two. Rows are floats, which halves the work; limits are
// wider by what that rounding may add. Distances of single points are the metric's own, which takes an arc tangent: it
// is computed where a bound without one does not show that the point is too far.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <trellis/base/clones.hpp>
#include <trellis/space/nearest_implementation.hpp>

namespace trellis {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::size_t bucket = 64;
constexpr NearerNeighbour nearer;

/// The largest coordinate of rows in floats.
constexpr double largest_coordinate = 1e15;

/// Four floats, as every 64-bit processor has them.
constexpr std::size_t quad = 4;
using Quad = float __attribute__((vector_size(16)));
using QuadMask = std::int32_t __attribute__((vector_size(16)));

inline Quad load(const float* from) {
  Quad q;
  std::memcpy(&q, from, sizeof q);
  return q;
}
inline float sum_of(const Quad& q) { return (q[0] + q[2]) + (q[1] + q[3]); }
inline Quad positive(const Quad& q) {
  return reinterpret_cast<Quad>(reinterpret_cast<QuadMask>(q) & (q > Quad{0.0F, 0.0F, 0.0F, 0.0F}));
}
inline Quad lesser(const Quad& a, const Quad& b) {
  const QuadMask first = a < b;
  return reinterpret_cast<Quad>((first & reinterpret_cast<QuadMask>(a)) | (~first & reinterpret_cast<QuadMask>(b)));
}
inline Quad spread(float x) { return Quad{x, x, x, x}; }
/// The squares of how far coordinates are outside an interval.
inline Quad outside(const Quad& lo, const Quad& hi, const Quad& x) {
  const Quad d = positive(lo - x) + positive(x - hi);
  return d * d;
}

/// Whether four numbers are all greater than `most`.
inline bool all_above(const float* from, float most) {
  const QuadMask above = load(from) > spread(most);
  std::array<std::uint64_t, 2> halves;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
  static_assert(sizeof halves == sizeof above);
  std::memcpy(halves.data(), &above, sizeof above);
  return (halves[0] & halves[1]) == ~std::uint64_t{0};
}
/// The place of the first of the least numbers.
inline std::size_t place_of_least(const std::array<float, bucket>& numbers) {
  Quad lanes = load(numbers.data());
  for (std::size_t i = quad; i < bucket; i += quad) lanes = lesser(load(numbers.data() + i), lanes);
  const float least = std::min(std::min(lanes[0], lanes[1]), std::min(lanes[2], lanes[3]));
  std::size_t place = 0;
  while (place < bucket && all_above(numbers.data() + place, least)) place += quad;
  while (place < bucket && numbers[place] > least) ++place;
  return place < bucket ? place : 0;
}

using EmbeddedRow = std::vector<float>;

/// The distances of RotationIndex::bound_distances for three lines and a rotation, as SE(3) has. Wider vectors than
/// those of AVX2 gain nothing.
/// \param inverse  one by the sum of the squares of both chords
TRELLIS_CLONES void bound_poses(const float* points, std::size_t room, const float* y, float inverse,
                                std::array<float, bucket>& out) {
  std::array<float, bucket> sums;  // NOLINT(cppcoreguidelines-pro-type-member-init): `out` may alias the points
  const auto square = [](float x) { return x * x; };
  const auto column = [&](std::size_t j) { return points + j * room; };
  const float *x0 = column(0), *x1 = column(1), *x2 = column(2);
  const float *p0 = column(quad), *p1 = column(quad + 1), *p2 = column(quad + 2), *p3 = column(quad + 3);
  const float* w = y + quad;
  for (std::size_t i = 0; i < bucket; ++i) {
    const float lines = square(y[0] - x0[i]) + square(y[1] - x1[i]) + square(y[2] - x2[i]);
    const float same = square(w[0] - p0[i]) + square(w[1] - p1[i]) + square(w[2] - p2[i]) + square(w[3] - p3[i]);
    const float opposite = square(w[0] + p0[i]) + square(w[1] + p1[i]) + square(w[2] + p2[i]) + square(w[3] + p3[i]);
    const float chord = same < opposite ? same : opposite;
    const float s = chord * inverse;
    sums[i] = lines + chord * (1.0F + s * (1.0F / 3.0F + s * (8.0F / 45.0F)));
  }
  out = sums;
}

class RotationIndex final : public NearestIndex::Implementation {
 public:
  explicit RotationIndex(const Space& space) : space_(space), rows_(space.dimension()) {
    // Scales are at most such that squares of distances are floats; less than the weight leaves bounds that are lower.
    for (const Factor& factor : space_.factors()) {
      const double weight = factor.axis.weight;
      switch (factor.kind) {
        case Factor::Kind::line:
          lines_.push_back({factor.column, weight, 0.5 * (factor.axis.lo + factor.axis.hi)});
          break;
        case Factor::Kind::circle: {
          const double scale = std::min(weight, largest_coordinate / factor.axis.period());
          exact_ = exact_ && scale == weight;
          circles_.push_back({factor.column, scale, 0.0, static_cast<float>(scale * factor.axis.period())});
          break;
        }
        case Factor::Kind::rotation: {
          const double scale = std::clamp(2.0 * weight, 1e-15, largest_coordinate);
          exact_ = exact_ && scale == 2.0 * weight;
          const auto inverse = static_cast<float>(0.25 / (scale * scale));
          rotations_.push_back({factor.column, std::min(scale, 2.0 * weight), 0.0, 0.0F, inverse});
          break;
        }
      }
    }
    first_rotation_ = (lines_.size() + quad - 1) / quad * quad;
    width_ = first_rotation_ + quad * rotations_.size() + circles_.size();
    // Each coordinate is rounded, each sum, and the circumference of a circle; an angle changes by up to 1.5 times
    // twice the chord's change.
    constexpr double rounding = 0x1p-23;
    relative_ = 1.0 + rounding * (static_cast<double>(width_) + 8.0);
    absolute_ = 4.0 * rounding * std::sqrt(static_cast<double>(width_));
  }

  std::uint32_t add(View q) override {
    Configuration row(q.begin(), q.end());
    space_.normalise(row);
    const std::uint32_t id = rows_.push(row);
    if (nodes_.empty()) new_leaf();
    EmbeddedRow point;
    embed(row, point);
    for (const float x : point) largest_ = std::max(largest_, std::abs(x));
    std::uint32_t at = 0;
    for (;;) {
      widen(at, point.data());
      ++nodes_[at].points;
      if (nodes_[at].left == 0) break;
      at = point[nodes_[at].column] < nodes_[at].split ? nodes_[at].left : nodes_[at].right;
    }
    nodes_[at].push(id, point.data(), width_);
    if (nodes_[at].ids.size() > bucket) split(at);
    return id;
  }

  void renumber(const std::vector<std::uint32_t>& ids, std::size_t kept) override {
    Configurations rows(rows_.dimension());
    rows.reserve(kept);
    for (std::size_t id = 0; id < ids.size(); ++id) {
      if (ids[id] != removed) rows.push(std::as_const(rows_)[id]);
    }
    rows_ = std::move(rows);
    for (Node& node : nodes_) node.renumber(ids, width_);
    // Children come after their parents.
    for (std::size_t at = nodes_.size(); at-- > 0;) {
      Node& node = nodes_[at];
      node.points = node.left == 0 ? node.ids.size() : nodes_[node.left].points + nodes_[node.right].points;
      fit_box(at);
    }
  }

  [[nodiscard]] std::size_t size() const override { return rows_.size(); }

  [[nodiscard]] NearestIndex::Neighbour nearest(View q) const override {
    NearestIndex::Neighbour best{0, std::numeric_limits<double>::infinity()};
    visit(
        q, [&] { return best.squared_distance; },
        [&](const NearestIndex::Neighbour& candidate) {
          if (nearer(candidate, best)) best = candidate;
        });
    return best;
  }

  [[nodiscard]] double squared_distance(View point, View q) const override {
    thread_local Configuration from;
    thread_local Configuration to;
    from.assign(point.begin(), point.end());
    to.assign(q.begin(), q.end());
    space_.normalise(from);
    space_.normalise(to);
    return space_.squared_distance(from, to);
  }

  void k_nearest(View q, std::size_t k, std::vector<NearestIndex::Neighbour>& out) const override {
    NearestCollector collector(k, out);
    if (k == 0) return;
    visit(
        q, [&] { return collector.limit(); },
        [&](const NearestIndex::Neighbour& candidate) { collector.offer(candidate); });
    collector.finish();
  }

  void within(View q, double radius, std::vector<NearestIndex::Neighbour>& out) const override {
    out.clear();
    const double limit = radius * radius;
    visit(
        q, [&] { return limit; },
        [&](const NearestIndex::Neighbour& candidate) {
          if (candidate.squared_distance <= limit) out.push_back(candidate);
        });
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  }

  void nearest_distances(View q, std::span<double> squared) const override {
    std::fill(squared.begin(), squared.end(), std::numeric_limits<double>::infinity());
    if (squared.empty()) return;
    visit(
        q, [&] { return squared.back(); },
        [&](const NearestIndex::Neighbour& candidate) {
          if (candidate.squared_distance < squared.back()) insert_distance(candidate.squared_distance, squared);
        });
  }

  [[nodiscard]] std::size_t count_within(View q, double squared) const override {
    std::size_t found = 0;
    visit(
        q, [&] { return squared; },
        [&](const NearestIndex::Neighbour& candidate) { found += candidate.squared_distance <= squared ? 1 : 0; },
        [&](std::uint32_t at, const EmbeddedRow& y, double rounding) {
          if (!exact_ || largest_ >= static_cast<float>(largest_coordinate)) return false;
          const double reach = std::sqrt(greatest_distance(box(at), y.data())) + rounding;
          if (relative_ * reach * reach > squared) return false;
          found += nodes_[at].points;
          return true;
        });
    return found;
  }

 private:
  struct Node {
    std::uint32_t left = 0;  ///< 0 for a leaf: the root is no node's child
    std::uint32_t right = 0;
    std::size_t column = 0;
    float split = 0.0F;
    std::size_t points = 0;          ///< below it
    std::vector<std::uint32_t> ids;  ///< of a leaf
    std::size_t room = 0;            ///< points that fit in `columns`, a multiple of `bucket`
    EmbeddedRow columns;             ///< of a leaf: its embedded points, one column after the other

    [[nodiscard]] float at(std::size_t point, std::size_t j) const { return columns[j * room + point]; }
    void push(std::uint32_t id, const float* point, std::size_t width) {
      if (ids.size() == room) {
        const std::size_t more = std::max(bucket, 2 * room);
        EmbeddedRow wider(width * more, 0.0F);
        for (std::size_t j = 0; j < width; ++j) std::copy_n(columns.data() + j * room, room, wider.data() + j * more);
        columns = std::move(wider);
        room = more;
      }
      for (std::size_t j = 0; j < width; ++j) columns[j * room + ids.size()] = point[j];
      ids.push_back(id);
    }
    /// See Implementation::renumber.
    void renumber(const std::vector<std::uint32_t>& new_ids, std::size_t width) {
      std::size_t to = 0;
      for (std::size_t from = 0; from < ids.size(); ++from) {
        const std::uint32_t id = new_ids[ids[from]];
        if (id == removed) continue;
        ids[to] = id;
        for (std::size_t j = 0; j < width; ++j) columns[j * room + to] = at(from, j);
        ++to;
      }
      ids.resize(to);
    }
  };

  /// A factor of the space in the embedded rows. They have all lines first, then zeros up to a multiple of four, then
  /// all rotations, then all circles.
  struct Part {
    std::size_t column = 0;  ///< in rows of the space
    double scale = 1.0;
    double origin = 0.0;   ///< of a line: the middle of its bounds, so that floats are exact enough far from 0
    float length = 0.0F;   ///< of a circle its circumference
    float inverse = 0.0F;  ///< of a rotation one by the sum of the squares of both chords
  };

  /// The row in metres: coordinates by their weights, quaternions by twice theirs.
  void embed(View row, EmbeddedRow& out) const {
    out.clear();
    for (const Part& line : lines_) {
      const double x = line.scale * (row[line.column] - line.origin);
      out.push_back(static_cast<float>(std::clamp(x, -largest_coordinate, largest_coordinate)));
    }
    out.resize(first_rotation_, 0.0F);
    for (const Part& rotation : rotations_) {
      for (std::size_t i = 0; i < quad; ++i) {
        out.push_back(static_cast<float>(rotation.scale * row[rotation.column + i]));
      }
    }
    for (const Part& circle : circles_) out.push_back(static_cast<float>(circle.scale * row[circle.column]));
  }

  std::uint32_t new_leaf() {
    nodes_.emplace_back();
    boxes_.insert(boxes_.end(), width_, infinity);
    boxes_.insert(boxes_.end(), width_, -infinity);
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }

  /// The lowest coordinates of a node's embedded points; the highest follow.
  [[nodiscard]] const float* box(std::uint32_t at) const { return boxes_.data() + 2 * width_ * at; }

  void widen(std::size_t at, const float* point) {
    float* lo = boxes_.data() + 2 * width_ * at;
    float* hi = lo + width_;
    for (std::size_t j = 0; j < width_; ++j) {
      lo[j] = std::min(lo[j], point[j]);
      hi[j] = std::max(hi[j], point[j]);
    }
  }

  /// Computes the box of a node anew: from the points of a leaf, or from the boxes of the children.
  void fit_box(std::size_t at) {
    float* lo = boxes_.data() + 2 * width_ * at;
    std::fill_n(lo, width_, infinity);
    std::fill_n(lo + width_, width_, -infinity);
    const Node& node = nodes_[at];
    if (node.left == 0) {
      for (std::size_t j = 0; j < width_; ++j) {
        for (std::size_t i = 0; i < node.ids.size(); ++i) {
          lo[j] = std::min(lo[j], node.at(i, j));
          lo[width_ + j] = std::max(lo[width_ + j], node.at(i, j));
        }
      }
      return;
    }
    for (const std::uint32_t child : {node.left, node.right}) {
      for (std::size_t j = 0; j < width_; ++j) {
        lo[j] = std::min(lo[j], box(child)[j]);
        lo[width_ + j] = std::max(lo[width_ + j], box(child)[width_ + j]);
      }
    }
  }

  /// Splits a leaf at the middle of the widest side of its box. A leaf whose points coincide stays whole.
  void split(std::uint32_t at) {
    const auto side = [&](std::size_t j) { return box(at)[width_ + j] - box(at)[j]; };
    std::size_t column = 0;
    for (std::size_t j = 0; j < width_; ++j) {
      if (side(j) > side(column)) column = j;
    }
    const float lo = box(at)[column];
    const float hi = box(at)[width_ + column];
    const float middle = 0.5F * (lo + hi);
    if (!(lo < middle && middle <= hi)) return;
    const std::uint32_t left = new_leaf();
    const std::uint32_t right = new_leaf();
    EmbeddedRow point(width_);
    for (std::size_t i = 0; i < nodes_[at].ids.size(); ++i) {
      for (std::size_t j = 0; j < width_; ++j) point[j] = nodes_[at].at(i, j);
      const std::uint32_t child = point[column] < middle ? left : right;
      nodes_[child].push(nodes_[at].ids[i], point.data(), width_);
      ++nodes_[child].points;
      widen(child, point.data());
    }
    Node& node = nodes_[at];
    node.ids = {};
    node.columns = {};
    node.left = left;
    node.right = right;
    node.column = column;
    node.split = middle;
  }

  /// The squared distance from y, embedded, to a box.
  /// \param lines  their number, which the compiler sees where it is usual
  template <class Lines, class Rotations>
  [[nodiscard]] float box_distance(const float* lo, const float* y, Lines lines, Rotations rotations) const {
    const float* hi = lo + width_;
    Quad squares{};
    std::size_t j = 0;
    for (; j < lines; j += quad) squares += outside(load(lo + j), load(hi + j), load(y + j));
    float sum = sum_of(squares);
    for (std::size_t r = 0; r < rotations; ++r, j += quad) {
      const Quad low = load(lo + j), high = load(hi + j), at = load(y + j);
      sum += std::min(sum_of(outside(low, high, at)), sum_of(outside(low, high, -at)));
    }
    for (const Part& circle : circles_) {
      const auto beside = [&](float x) { return std::max({lo[j] - x, x - hi[j], 0.0F}); };
      const float d = std::min({beside(y[j]), beside(y[j] - circle.length), beside(y[j] + circle.length)});
      sum += d * d;
      ++j;
    }
    return sum;
  }

  /// The squared distance of the farthest point that a box may contain, up to rounding.
  [[nodiscard]] double greatest_distance(const float* lo, const float* y) const {
    const float* hi = lo + width_;
    const auto farther = [&](std::size_t j, float x) { return static_cast<double>(std::max(x - lo[j], hi[j] - x)); };
    double sum = 0.0;
    for (std::size_t j = 0; j < lines_.size(); ++j) sum += farther(j, y[j]) * farther(j, y[j]);
    std::size_t j = first_rotation_;
    for (const Part& rotation : rotations_) {
      double same = 0.0, opposite = 0.0;
      for (std::size_t k = 0; k < quad; ++k, ++j) {
        same += farther(j, y[j]) * farther(j, y[j]);
        opposite += farther(j, -y[j]) * farther(j, -y[j]);
      }
      // The sum of the squares of both chords is (2 scale)^2, so the lesser chord is at most the root of half of that.
      const double s = std::min(0.5, std::min(same, opposite) * static_cast<double>(rotation.inverse));
      const double distance = 2.0 * rotation.scale * std::asin(std::sqrt(s));
      sum += distance * distance;
    }
    for (const Part& circle : circles_) {
      const double d = std::min(farther(j, y[j]), 0.5 * static_cast<double>(circle.length));
      sum += d * d;
      ++j;
    }
    return sum;
  }

  /// The squared distances between y, embedded, and `bucket` points of a leaf: at most the metric's, and as a rule
  /// within some percent of them. Returns a number that is not above any of them.
  /// \param points  the first column, from the first of these points on
  /// \param room  distance between the columns
  template <class Lines, class Rotations>
  float bound_distances(const float* points, std::size_t room, const float* y, Lines lines, Rotations rotations,
                        std::array<float, bucket>& out) const {
    Quad least = spread(infinity);
    if constexpr (!std::is_same_v<Lines, std::size_t>) {
      bound_poses(points, room, y, rotations_.front().inverse, out);
      for (std::size_t i = 0; i < bucket; i += quad) least = lesser(load(out.data() + i), least);
      return std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
    }
    for (std::size_t i = 0; i < bucket; i += quad) {
      Quad sum{};
      for (std::size_t j = 0; j < lines; ++j) {
        const Quad d = spread(y[j]) - load(points + j * room + i);
        sum += d * d;
      }
      std::size_t j = first_rotation_;
      for (std::size_t r = 0; r < rotations; ++r) {
        Quad same{}, opposite{};
        for (std::size_t k = 0; k < quad; ++k, ++j) {
          const Quad x = spread(y[j]), p = load(points + j * room + i);
          const Quad d = x - p, e = x + p;
          same += d * d;
          opposite += e * e;
        }
        const Quad chord = lesser(same, opposite);
        // angle = 4 asin(c / 2), c the chord: the first terms of its square's series, all of which are positive.
        const Quad s = chord * spread(rotations_[r].inverse);
        sum += chord * (spread(1.0F) + s * (spread(1.0F / 3.0F) + s * spread(8.0F / 45.0F)));
      }
      for (const Part& circle : circles_) {
        for (std::size_t k = 0; k < quad; ++k) {
          const float d = std::abs(y[j] - points[j * room + i + k]);
          const float shorter = std::min(d, std::abs(circle.length - d));
          sum[k] += shorter * shorter;
        }
        ++j;
      }
      std::memcpy(out.data() + i, &sum, sizeof sum);
      least = lesser(sum, least);
    }
    return std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
  }

  struct NoNode {
    bool operator()(std::uint32_t, const EmbeddedRow&, double) const { return false; }
  };

  /// Calls `offer` for every point that may be within `limit()`, which decreases as points are found.
  /// \param whole  called for inner nodes, with q embedded and what rounding adds to a distance: whether their points
  /// need
  ///               not be offered
  template <class Limit, class Offer, class Whole = NoNode>
  void visit(View q, const Limit& limit, const Offer& offer, const Whole& whole = {}) const {
    if (nodes_.empty()) return;
    if (lines_.size() == 3 && circles_.empty() && rotations_.size() == 1) {
      constexpr std::integral_constant<std::size_t, 3> lines;
      constexpr std::integral_constant<std::size_t, 1> rotations;
      visit(q, limit, offer, whole, lines, rotations);
    } else {
      visit(q, limit, offer, whole, lines_.size(), rotations_.size());
    }
  }

  template <class Limit, class Offer, class Whole, class Lines, class Rotations>
  void visit(View q, const Limit& limit, const Offer& offer, const Whole& whole, Lines lines,
             Rotations rotations) const {
    thread_local Configuration row;
    thread_local EmbeddedRow y;
    thread_local std::vector<std::pair<float, std::uint32_t>> waiting;
    row.assign(q.begin(), q.end());
    space_.normalise(row);
    embed(row, y);
    float largest = largest_;
    for (const float x : y) largest = std::max(largest, std::abs(x));
    const double rounding = absolute_ * static_cast<double>(largest);
    // A distance in floats that is greater is also greater than limit(), whatever rounding did.
    double last = -1.0;
    float most = 0.0F;
    const auto farthest = [&] {
      if (const double now = limit(); now != last) {
        last = now;
        const double reach = std::sqrt(now) + rounding;
        const double squared_reach = relative_ * reach * reach;
        most = squared_reach < std::numeric_limits<float>::max() ? static_cast<float>(squared_reach) : infinity;
      }
      return most;
    };
    const auto too_far = [&](float squared) { return squared > farthest(); };
    waiting.assign(1, {0.0F, 0});
    while (!waiting.empty()) {
      const auto [distance, at] = waiting.back();
      waiting.pop_back();
      if (too_far(distance)) continue;
      const Node& node = nodes_[at];
      if (node.left == 0) {
        const auto offer_point = [&](std::size_t i) {
          const std::uint32_t id = node.ids[i];
          offer({id, space_.squared_distance(std::as_const(rows_)[id], row)});
        };
        for (std::size_t begin = 0; begin < node.ids.size(); begin += bucket) {
          const std::size_t count = std::min(bucket, node.ids.size() - begin);
          std::array<float, bucket> bounds;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
          if (too_far(bound_distances(node.columns.data() + begin, node.room, y.data(), lines, rotations, bounds))) {
            continue;
          }
          // The point with the least bound first: it excludes most of the others.
          std::fill(bounds.begin() + static_cast<std::ptrdiff_t>(count), bounds.end(), infinity);
          const std::size_t first = place_of_least(bounds);
          if (too_far(bounds[first])) continue;
          offer_point(begin + first);
          for (std::size_t i = 0; i < count; i += quad) {
            if (all_above(bounds.data() + i, farthest())) continue;
            for (std::size_t k = i; k < std::min(count, i + quad); ++k) {
              if (k != first && !too_far(bounds[k])) offer_point(begin + k);
            }
          }
        }
        continue;
      }
      if (whole(at, y, rounding)) continue;
      const std::pair<float, std::uint32_t> left = {box_distance(box(node.left), y.data(), lines, rotations),
                                                    node.left};
      const std::pair<float, std::uint32_t> right = {box_distance(box(node.right), y.data(), lines, rotations),
                                                     node.right};
      const bool left_first = left.first <= right.first;
      const auto& farther = left_first ? right : left;
      if (!too_far(farther.first)) waiting.push_back(farther);
      waiting.push_back(left_first ? left : right);
    }
  }

  Space space_;
  Configurations rows_;
  std::size_t first_rotation_ = 0;  ///< its column in embedded rows
  std::size_t width_ = 0;           ///< of an embedded row
  double relative_ = 1.0;           ///< what rounding may multiply a squared distance by
  double absolute_ = 0.0;           ///< what it may add to a distance, as a share of the largest coordinate
  float largest_ = 0.0F;            ///< the largest coordinate of the embedded points
  bool exact_ = true;               ///< no scale differs from the metric's
  std::vector<Part> lines_, circles_, rotations_;
  std::vector<Node> nodes_;
  std::vector<float> boxes_;  ///< by node
};

}  // namespace

std::unique_ptr<NearestIndex::Implementation> make_rotation_index(const Space& space) {
  return std::make_unique<RotationIndex>(space);
}

}  // namespace trellis
