// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/space/nearest.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <tuple>
#include <type_traits>

#include <trellis/base/clones.hpp>
#include <trellis/base/polling.hpp>
#include <trellis/space/nearest_implementation.hpp>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Points of a leaf. An index that grows has larger ones: in benchmarks faster than 8 and 16 from 500 to 100,000 points.
constexpr std::size_t growing = 32;
constexpr std::size_t built = 16;

/// Two numbers, as every 64-bit processor has them. In few dimensions wider vectors gain nothing: the search ends after
/// some buckets.
using Pair = double __attribute__((vector_size(16)));

using Four = double __attribute__((vector_size(32)));

/// Nodes that a search visits later. A descent pushes one entry per level of the tree. Only the number of points bounds
/// the depth, so further entries go to the heap.
template <class Entry>
class Waiting {
 public:
  [[nodiscard]] bool empty() const { return height_ == 0; }
  void push(const Entry& entry) {
    if (height_ < fixed_.size()) {
      fixed_[height_] = entry;
    } else {
      spilled_.push_back(entry);
    }
    ++height_;
  }
  Entry pop() {
    --height_;
    if (height_ < fixed_.size()) return fixed_[height_];
    const Entry entry = spilled_.back();
    spilled_.pop_back();
    return entry;
  }

 private:
  std::array<Entry, 64> fixed_;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before it is read
  std::vector<Entry> spilled_;
  std::size_t height_ = 0;
};

inline Pair load(const double* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}
inline Pair lesser(const Pair& a, const Pair& b) { return a < b ? a : b; }
inline double lesser_of(const Pair& pair) { return pair[0] < pair[1] ? pair[0] : pair[1]; }

/// The kd-tree for a dimension D known at compile time, so that loops unroll; D = 0 reads the dimension at run time.
template <std::size_t D, std::size_t bucket>
class Tree final : public NearestIndex::Implementation {
 public:
  explicit Tree(const Space& space) : dimension_(space.dimension()) {
    if constexpr (D == 0) {
      weight_.resize(dimension_);
      period_.resize(dimension_);
    }
    for (std::size_t j = 0; j < dim(); ++j) {
      const auto& axis = space.axes()[j];
      weight_[j] = axis.weight;
      period_[j] = axis.periodic ? axis.weight * axis.period() : infinity;
    }
  }
  Tree(const Space& space, std::span<const double> rows) : Tree(space) {
    size_ = rows.size() / dim();
    if (size_ == 0) return;
    std::vector<double> points(rows.begin(), rows.end());
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t j = 0; j < dim(); ++j) points[i * dim() + j] *= weight_[j];
    }
    std::vector<std::uint32_t> ids(size_);
    std::iota(ids.begin(), ids.end(), 0U);
    const std::size_t leaves = 2 * (size_ / bucket + 1);
    nodes_.reserve(2 * leaves);
    boxes_.reserve(4 * leaves * dim());
    coordinates_.reserve(leaves * bucket * dim());
    build(points, ids);
  }

  std::uint32_t add(View q) override {
    // Allocates memory with the first point, because many indices stay empty.
    if (nodes_.empty()) nodes_[new_node()].leaf = static_cast<std::int32_t>(new_bucket());
    const auto id = static_cast<std::uint32_t>(size_++);
    std::array<double, capacity> y{};
    std::vector<double> large;
    double* point = scaled(q, y, large);
    std::uint32_t at = 0;
    for (;;) {
      widen(at, point);
      Node& node = nodes_[at];
      ++node.points;
      if (node.leaf >= 0) break;
      at = point[node.axis] < node.split ? node.left : node.right;
    }
    auto leaf = static_cast<std::size_t>(nodes_[at].leaf);
    if (count_[leaf] == bucket) {
      const std::uint32_t child = split(at, point);
      widen(child, point);
      ++nodes_[child].points;
      leaf = static_cast<std::size_t>(nodes_[child].leaf);
    }
    const std::size_t slot = count_[leaf]++;
    for (std::size_t j = 0; j < dim(); ++j) coordinates_[(leaf * dim() + j) * bucket + slot] = point[j];
    ids_[leaf * bucket + slot] = id;
    return id;
  }

  void renumber(const std::vector<std::uint32_t>& ids, std::size_t kept) override {
    for (std::size_t leaf = 0; leaf < count_.size(); ++leaf) {
      std::size_t to = 0;
      for (std::size_t from = 0; from < count_[leaf]; ++from) {
        const std::uint32_t id = ids[static_cast<std::size_t>(ids_[leaf * bucket + from])];
        if (id == removed) continue;
        ids_[leaf * bucket + to] = id;
        for (std::size_t j = 0; j < dim(); ++j) {
          double* column = &coordinates_[(leaf * dim() + j) * bucket];
          column[to] = column[from];
        }
        ++to;
      }
      for (std::size_t j = 0; j < dim(); ++j) {
        double* column = &coordinates_[(leaf * dim() + j) * bucket];
        std::fill(column + to, column + count_[leaf], infinity);
      }
      count_[leaf] = to;
    }
    size_ = kept;
    // Children come after their parents.
    for (std::size_t at = nodes_.size(); at-- > 0;) {
      Node& node = nodes_[at];
      node.points = static_cast<std::uint32_t>(node.leaf >= 0 ? count_[static_cast<std::size_t>(node.leaf)]
                                                              : nodes_[node.left].points + nodes_[node.right].points);
      fit_box(at);
    }
  }

  [[nodiscard]] std::size_t size() const override { return size_; }

  [[nodiscard]] NearestIndex::Neighbour nearest(View q) const override {
    NearestIndex::Neighbour best{0, infinity};
    if constexpr (D == 0) {
      find_by_clones(q, best);
    } else {
      find(q, best);
    }
    return best;
  }

  [[nodiscard]] double squared_distance(View point, View q) const override {
    double square = 0.0;
    for (std::size_t j = 0; j < dim(); ++j) {
      double d = weight_[j] * point[j] - weight_[j] * q[j];
      if (period_[j] != infinity) {
        d = std::abs(d);
        d = std::min(d, period_[j] - d);
      }
      square += d * d;
    }
    return square;
  }

  void k_nearest(View q, std::size_t k, std::vector<NearestIndex::Neighbour>& out) const override {
    NearestCollector collector(k, out);
    if (k == 0) return;
    search(
        q, [&] { return collector.limit(); },
        [&](std::uint32_t id, double d2) {
          collector.offer({id, d2});
        });
    collector.finish();
  }

  void within(View q, double radius, std::vector<NearestIndex::Neighbour>& out) const override {
    out.clear();
    const double limit = radius * radius;
    search(
        q, [&] { return limit; },
        [&](std::uint32_t id, double d2) {
          if (d2 <= limit) out.push_back({id, d2});
        });
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  }

  void nearest_distances(View q, std::span<double> squared) const override { find_distances(q, squared); }
  [[nodiscard]] std::size_t count_within(View q, double squared) const override { return count(q, squared); }

 private:
  static constexpr std::size_t capacity = D == 0 ? 32 : D;
  using PerAxis = std::conditional_t<D == 0, std::vector<double>, std::array<double, capacity>>;

  struct Node {
    std::int32_t leaf = -1;  ///< its bucket; -1 for an inner node
    std::uint32_t left = 0;
    std::uint32_t right = 0;
    std::uint32_t axis = 0;
    double split = 0.0;
    std::uint32_t points = 0;  ///< below it
  };

  [[nodiscard]] std::size_t dim() const {
    if constexpr (D == 0) {
      return dimension_;
    } else {
      return D;
    }
  }

  /// Metric coordinates of q, in `y`, or in `large` if the dimension exceeds the size of `y`.
  double* scaled(View q, std::array<double, capacity>& y, std::vector<double>& large) const {
    double* out = y.data();
    if (dim() > capacity) {
      large.resize(dim());
      out = large.data();
    }
    for (std::size_t j = 0; j < dim(); ++j) out[j] = weight_[j] * q[j];
    return out;
  }

  std::uint32_t new_node() {
    nodes_.emplace_back();
    boxes_.resize(boxes_.size() + 2 * dim(), infinity);
    std::fill(boxes_.end() - static_cast<std::ptrdiff_t>(dim()), boxes_.end(), -infinity);
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }
  std::size_t new_bucket() {
    count_.push_back(0);
    coordinates_.resize(coordinates_.size() + dim() * bucket, infinity);
    ids_.resize(ids_.size() + bucket);
    return count_.size() - 1;
  }

  /// Builds the node of these points, and returns it. All leaves but the last are full or nearly so.
  std::uint32_t build(std::span<const double> points, std::span<std::uint32_t> ids) {
    poll();
    const std::uint32_t at = new_node();
    nodes_[at].points = static_cast<std::uint32_t>(ids.size());
    for (const std::uint32_t id : ids) widen(at, &points[id * dim()]);
    if (ids.size() <= bucket) {
      const std::size_t leaf = new_bucket();
      nodes_[at].leaf = static_cast<std::int32_t>(leaf);
      count_[leaf] = ids.size();
      for (std::size_t i = 0; i < ids.size(); ++i) {
        ids_[leaf * bucket + i] = ids[i];
        for (std::size_t j = 0; j < dim(); ++j) {
          coordinates_[(leaf * dim() + j) * bucket + i] = points[ids[i] * dim() + j];
        }
      }
      return at;
    }
    const std::size_t axis = widest_side(at);
    const std::size_t half = (ids.size() / 2 + bucket - 1) / bucket * bucket;
    const std::size_t middle = half < ids.size() ? half : ids.size() / 2;
    const auto coordinate = [&](std::uint32_t id) { return points[id * dim() + axis]; };
    std::nth_element(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(middle), ids.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return coordinate(a) < coordinate(b); });
    nodes_[at].axis = static_cast<std::uint32_t>(axis);
    nodes_[at].split = coordinate(ids[middle]);
    const std::uint32_t left = build(points, ids.first(middle));
    const std::uint32_t right = build(points, ids.subspan(middle));
    nodes_[at].left = left;
    nodes_[at].right = right;
    return at;
  }

  void widen(std::uint32_t at, const double* point) {
    double* box = &boxes_[at * 2 * dim()];
    for (std::size_t j = 0; j < dim(); ++j) {
      box[j] = std::min(box[j], point[j]);
      box[dim() + j] = std::max(box[dim() + j], point[j]);
    }
  }

  /// Computes the box of a node anew: from the points of a leaf, or from the boxes of the children.
  void fit_box(std::size_t at) {
    const Node& node = nodes_[at];
    double* box = &boxes_[at * 2 * dim()];
    for (std::size_t j = 0; j < dim(); ++j) {
      double lo = infinity;
      double hi = -infinity;
      if (node.leaf >= 0) {
        const auto leaf = static_cast<std::size_t>(node.leaf);
        const double* column = &coordinates_[(leaf * dim() + j) * bucket];
        for (std::size_t i = 0; i < count_[leaf]; ++i) {
          lo = std::min(lo, column[i]);
          hi = std::max(hi, column[i]);
        }
      } else {
        const double* left = &boxes_[node.left * 2 * dim()];
        const double* right = &boxes_[node.right * 2 * dim()];
        lo = std::min(left[j], right[j]);
        hi = std::max(left[dim() + j], right[dim() + j]);
      }
      box[j] = lo;
      box[dim() + j] = hi;
    }
  }

  /// The axis of the widest side of a box.
  [[nodiscard]] std::size_t widest_side(std::uint32_t at) const {
    const double* box = &boxes_[at * 2 * dim()];
    std::size_t axis = 0;
    for (std::size_t j = 1; j < dim(); ++j) {
      if (box[dim() + j] - box[j] > box[dim() + axis] - box[axis]) axis = j;
    }
    return axis;
  }

  /// Splits the full leaf at node `at` across the widest side of its box, and returns the child that `point` belongs
  /// to. If all points coincide along that side, each child gets half of them in order; then only the box test directs
  /// the search.
  std::uint32_t split(std::uint32_t at, const double* point) {
    const auto old = static_cast<std::size_t>(nodes_[at].leaf);
    const std::size_t axis = widest_side(at);
    std::array<std::size_t, bucket> order{};
    for (std::size_t i = 0; i < bucket; ++i) order[i] = i;
    const auto coordinate = [&](std::size_t slot) { return coordinates_[(old * dim() + axis) * bucket + slot]; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return coordinate(a) < coordinate(b) || (coordinate(a) == coordinate(b) && a < b);
    });
    const double value = 0.5 * (coordinate(order[bucket / 2 - 1]) + coordinate(order[bucket / 2]));

    std::vector<double> points(bucket * dim());
    std::array<double, bucket> ids{};
    for (std::size_t i = 0; i < bucket; ++i) {
      ids[i] = ids_[old * bucket + order[i]];
      for (std::size_t j = 0; j < dim(); ++j) {
        points[i * dim() + j] = coordinates_[(old * dim() + j) * bucket + order[i]];
      }
    }
    const std::uint32_t left = new_node();
    const std::uint32_t right = new_node();
    nodes_[left].leaf = nodes_[at].leaf;
    nodes_[right].leaf = static_cast<std::int32_t>(new_bucket());
    nodes_[at].leaf = -1;
    nodes_[at].left = left;
    nodes_[at].right = right;
    nodes_[at].axis = static_cast<std::uint32_t>(axis);
    nodes_[at].split = value;
    for (const std::uint32_t child : {left, right}) {
      const auto leaf = static_cast<std::size_t>(nodes_[child].leaf);
      count_[leaf] = bucket / 2;
      nodes_[child].points = static_cast<std::uint32_t>(bucket / 2);
      const std::size_t from = child == left ? 0 : bucket / 2;
      std::fill_n(&coordinates_[leaf * dim() * bucket], dim() * bucket, infinity);
      for (std::size_t i = 0; i < bucket / 2; ++i) {
        widen(child, &points[(from + i) * dim()]);
        ids_[leaf * bucket + i] = ids[from + i];
        for (std::size_t j = 0; j < dim(); ++j) {
          coordinates_[(leaf * dim() + j) * bucket + i] = points[(from + i) * dim() + j];
        }
      }
    }
    return point[axis] < value ? left : right;
  }

  [[nodiscard]] TRELLIS_ALONG double box_distance(std::uint32_t at, const double* y) const {
    const double* box = &boxes_[at * 2 * dim()];
    double sum = 0.0;
    for (std::size_t j = 0; j < dim(); ++j) {
      const double below = box[j] - y[j];
      const double above = y[j] - box[dim() + j];
      double d = std::max(std::max(below, above), 0.0);
      if (period_[j] != infinity) {
        // The distance to the box's far side across the period.
        d = std::min(d, std::max(period_[j] + std::min(below, above), 0.0));
      }
      sum += d * d;
    }
    return sum;
  }

  /// The squared distance of the farthest point that a box may contain. It takes the operations of the distances in the
  /// same order, and rounding is monotone: no point of the box has a greater one.
  [[nodiscard]] TRELLIS_ALONG double greatest_distance(std::uint32_t at, const double* y) const {
    const double* box = &boxes_[at * 2 * dim()];
    double sum = 0.0;
    for (std::size_t j = 0; j < dim(); ++j) {
      const double a = box[j] - y[j];
      const double b = box[dim() + j] - y[j];
      const double half = 0.5 * period_[j];
      const bool across = (a <= half && b >= half) || (a <= -half && b >= -half);
      const double ends =
          std::max(std::min(std::abs(a), period_[j] - std::abs(a)), std::min(std::abs(b), period_[j] - std::abs(b)));
      const double d = across ? half : ends;
      sum += d * d;
    }
    return sum;
  }

  /// The squared distances of the points of a bucket; infinity in its empty places.
  using Squares = std::array<double, bucket>;

  TRELLIS_ALONG void square_distances(std::size_t leaf, const double* y, Squares& squares) const {
    for (std::size_t i = 0; i < bucket; ++i) squares[i] = 0.0;
    for (std::size_t j = 0; j < dim(); ++j) {
      const double* column = &coordinates_[(leaf * dim() + j) * bucket];
      const double centre = y[j];
      if (period_[j] == infinity) {
        for (std::size_t i = 0; i < bucket; ++i) {
          const double d = column[i] - centre;
          squares[i] += d * d;
        }
      } else {
        const double period = period_[j];
        for (std::size_t i = 0; i < bucket; ++i) {
          double d = std::abs(column[i] - centre);
          d = std::min(d, period - d);
          squares[i] += d * d;
        }
      }
    }
  }
  /// The same of four points.
  TRELLIS_ALONG void square_distances(const double* points, const double* y, Four* squares) const {
    Four sum{};
    for (std::size_t j = 0; j < dim(); ++j) {
      Four at;
      std::memcpy(&at, points + j * bucket, sizeof at);
      const Four offset = at - y[j];
      const Four u = offset < 0.0 ? -offset : offset;
      const Four v = period_[j] - u;
      const Four d = v < u ? v : u;
      sum += d * d;
    }
    *squares = sum;
  }
  [[nodiscard]] TRELLIS_ALONG static double least_of(const Squares& squares) {
    Pair least = load(squares.data());
    for (std::size_t i = 2; i < bucket; i += 2) least = lesser(load(&squares[i]), least);
    return lesser_of(least);
  }
  /// The least id of the points of a bucket at a distance.
  [[nodiscard]] TRELLIS_ALONG double least_id(std::size_t leaf, const Squares& squares, double square) const {
    const Pair none{infinity, infinity};
    const Pair at{square, square};
    Pair least = none;
    for (std::size_t i = 0; i < bucket; i += 2) {
      least = lesser(load(&squares[i]) == at ? load(&ids_[leaf * bucket + i]) : none, least);
    }
    return lesser_of(least);
  }
  /// Whether a bucket has a point within `most`.
  [[nodiscard]] TRELLIS_ALONG static bool reaches(const Squares& squares, double most) {
    if constexpr (D == 0) {
      std::int64_t near = 0;
      for (std::size_t i = 0; i < bucket; ++i) near += squares[i] <= most ? 1 : 0;
      return near > 0;
    } else {
      return least_of(squares) <= most;
    }
  }

  TRELLIS_ALONG void find(View q, NearestIndex::Neighbour& best) const {
    visit(
        q, [&] { return best.squared_distance; },
        [&](std::size_t leaf, const double* y) TRELLIS_ALONG_LAMBDA {
          Squares squares;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before it is read
          square_distances(leaf, y, squares);
          if (!reaches(squares, best.squared_distance)) return;
          const double least = least_of(squares);
          const auto id = static_cast<std::uint32_t>(least_id(leaf, squares, least));
          if (least < best.squared_distance || id < best.id) best = {id, least};
        });
  }
  TRELLIS_WIDE_CLONES void find_by_clones(View q, NearestIndex::Neighbour& best) const { find(q, best); }

  TRELLIS_CLONES void find_distances(View q, std::span<double> squared) const {
    std::fill(squared.begin(), squared.end(), infinity);
    if (squared.empty()) return;
    double& worst = squared.back();
    visit(
        q, [&] { return worst; },
        [&](std::size_t leaf, const double* y) TRELLIS_ALONG_LAMBDA {
          for (std::size_t begin = 0; begin < bucket; begin += 4) {
            Four squares;
            square_distances(&coordinates_[leaf * dim() * bucket + begin], y, &squares);
            const auto closer = squares < worst;
            if ((closer[0] | closer[1] | closer[2] | closer[3]) == 0) continue;
            for (std::size_t i = 0; i < 4; ++i) {
              if (squares[i] < worst) insert_distance(squares[i], squared);
            }
          }
        });
  }

  [[nodiscard]] TRELLIS_CLONES std::size_t count(View q, double squared) const {
    if (size_ == 0) return 0;
    std::array<double, capacity> memory;  // NOLINT(cppcoreguidelines-pro-type-member-init): scaled() fills it
    std::vector<double> large;
    const double* y = scaled(q, memory, large);
    if (box_distance(0, y) > squared) return 0;
    Waiting<std::uint32_t> waiting;
    waiting.push(0);
    decltype(Four{} <= Four{}) near{};
    std::size_t found = 0;
    while (!waiting.empty()) {
      const std::uint32_t at = waiting.pop();
      const Node& node = nodes_[at];
      if (node.leaf >= 0) {
        const double* leaf = &coordinates_[static_cast<std::size_t>(node.leaf) * dim() * bucket];
        for (std::size_t i = 0; i < bucket; i += 4) {
          Four squares;
          square_distances(leaf + i, y, &squares);
          near -= squares <= squared;  // true is -1
        }
      } else if (greatest_distance(at, y) <= squared) {
        found += node.points;
      } else {
        for (const std::uint32_t child : {node.left, node.right}) {
          if (box_distance(child, y) <= squared) waiting.push(child);
        }
      }
    }
    return found + static_cast<std::size_t>(near[0] + near[1] + near[2] + near[3]);
  }

  /// Calls `offer` for every point that may be within `limit()`, which decreases as points are found.
  template <class Limit, class Offer>
  void search(View q, const Limit& limit, const Offer& offer) const {
    if constexpr (D == 0) {
      search_by_clones(q, limit, offer);
    } else {
      search_buckets(q, limit, offer);
    }
  }
  template <class Limit, class Offer>
  TRELLIS_WIDE_CLONES void search_by_clones(View q, const Limit& limit, const Offer& offer) const {
    search_buckets(q, limit, offer);
  }
  template <class Limit, class Offer>
  TRELLIS_ALONG void search_buckets(View q, const Limit& limit, const Offer& offer) const {
    visit(q, limit, [&](std::size_t leaf, const double* y) TRELLIS_ALONG_LAMBDA {
      Squares squares;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before it is read
      square_distances(leaf, y, squares);
      const double most = limit();
      // Most buckets that the search reaches have no such point.
      if (!reaches(squares, most)) return;
      for (std::size_t i = 0; i < count_[leaf]; ++i) {
        if (squares[i] <= most) offer(static_cast<std::uint32_t>(ids_[leaf * bucket + i]), squares[i]);
      }
    });
  }

  /// Calls `examine` for every bucket that may have a point within `limit()`.
  template <class Limit, class Examine>
  TRELLIS_ALONG void visit(View q, const Limit& limit, const Examine& examine) const {
    if (size_ == 0) return;
    std::array<double, capacity> memory{};
    std::vector<double> large;
    const double* y = scaled(q, memory, large);
    struct Far {
      std::uint32_t node;
      double distance;
    };
    Waiting<Far> waiting;
    waiting.push({0, 0.0});
    while (!waiting.empty()) {
      const Far next = waiting.pop();
      if (next.distance > limit()) continue;
      std::uint32_t at = next.node;
      while (nodes_[at].leaf < 0) {
        const std::uint32_t left = nodes_[at].left;
        const std::uint32_t right = nodes_[at].right;
        const double to_left = box_distance(left, y);
        const double to_right = box_distance(right, y);
        const bool left_first = to_left <= to_right;
        const double far = left_first ? to_right : to_left;
        if (far <= limit()) waiting.push({left_first ? right : left, far});
        at = left_first ? left : right;
        if ((left_first ? to_left : to_right) > limit()) break;
      }
      if (nodes_[at].leaf < 0) continue;
      examine(static_cast<std::size_t>(nodes_[at].leaf), y);
    }
  }

  std::size_t dimension_;
  std::size_t size_ = 0;
  PerAxis weight_{};
  PerAxis period_{};
  std::vector<Node> nodes_;
  std::vector<double> boxes_;        ///< per node: lower corner, then upper corner
  std::vector<std::size_t> count_;   ///< points per bucket
  std::vector<double> coordinates_;  ///< per bucket: one column per axis, infinity in the empty places
  std::vector<double> ids_;          ///< exact: ids have 32 bits
};

/// \param of  the space, and the rows of an index that is built at once
template <std::size_t bucket, class... Of>
std::unique_ptr<NearestIndex::Implementation> make_tree(const Of&... of) {
  switch (std::get<0>(std::tie(of...)).dimension()) {
    case 1: return std::make_unique<Tree<1, bucket>>(of...);
    case 2: return std::make_unique<Tree<2, bucket>>(of...);
    case 3: return std::make_unique<Tree<3, bucket>>(of...);
    case 4: return std::make_unique<Tree<4, bucket>>(of...);
    case 6: return std::make_unique<Tree<6, bucket>>(of...);
    default: return std::make_unique<Tree<0, bucket>>(of...);
  }
}

}  // namespace

NearestIndex::NearestIndex(const Space& space)
    : implementation_(space.flat() ? make_tree<growing>(space) : make_rotation_index(space)) {}
NearestIndex::NearestIndex(const Space& space, std::span<const double> rows)
    : implementation_(space.flat() ? make_tree<built>(space, rows) : make_rotation_index(space)) {
  if (space.flat()) return;
  for (std::size_t at = 0; at < rows.size(); at += space.dimension()) add(rows.subspan(at, space.dimension()));
}
NearestIndex::~NearestIndex() = default;
NearestIndex::NearestIndex(NearestIndex&&) noexcept = default;
NearestIndex& NearestIndex::operator=(NearestIndex&&) noexcept = default;

std::uint32_t NearestIndex::add(View q) { return implementation_->add(q); }
void NearestIndex::retain(const std::vector<std::uint8_t>& keep) {
  std::vector<std::uint32_t> ids(keep.size(), Implementation::removed);
  std::uint32_t kept = 0;
  for (std::size_t id = 0; id < keep.size(); ++id) {
    if (keep[id] != 0) ids[id] = kept++;
  }
  if (kept < keep.size()) implementation_->renumber(ids, kept);
}
std::size_t NearestIndex::size() const { return implementation_->size(); }
NearestIndex::Neighbour NearestIndex::nearest(View q) const { return implementation_->nearest(q); }
double NearestIndex::squared_distance(View point, View q) const { return implementation_->squared_distance(point, q); }
void NearestIndex::k_nearest(View q, std::size_t k, std::vector<Neighbour>& out) const {
  implementation_->k_nearest(q, k, out);
}
void NearestIndex::within(View q, double radius, std::vector<Neighbour>& out) const {
  implementation_->within(q, radius, out);
}
void NearestIndex::nearest_distances(View q, std::span<double> squared) const {
  implementation_->nearest_distances(q, squared);
}
std::size_t NearestIndex::count_within(View q, double squared) const {
  return implementation_->count_within(q, squared);
}

}  // namespace trellis
