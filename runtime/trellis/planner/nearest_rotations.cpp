// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest neighbours where a space has rotations: an incremental kd-tree of buckets over rows in which a distance is
// never more than the metric's. A rotation's quaternion is scaled by twice its weight: the chord between two
// quaternions is 2 sin(angle / 4), so twice the weight times the chord is at most the weight times the angle. q and -q
// are one rotation, so a box is as near as the nearer of the two. Distances of single points are the metric's own,
// which takes an arc tangent: it is computed where a bound without one does not show that the point is too far.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <trellis/planner/nearest_implementation.hpp>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t bucket = 32;
constexpr NearerNeighbour nearer;

class RotationIndex final : public NearestIndex::Implementation {
 public:
  explicit RotationIndex(const Space& space) : space_(space), rows_(space.dimension()), width_(space.dimension()) {
    for (const Factor& factor : space_.factors()) {
      const double weight = factor.axis.weight;
      switch (factor.kind) {
        case Factor::Kind::line: lines_.push_back({factor.column, weight, 0.0}); break;
        case Factor::Kind::circle: circles_.push_back({factor.column, weight, weight * factor.axis.period()}); break;
        case Factor::Kind::rotation: rotations_.push_back({factor.column, 2.0 * weight, 16.0 * weight * weight}); break;
      }
    }
  }

  std::uint32_t add(View q) override {
    Configuration row(q.begin(), q.end());
    space_.normalise(row);
    const std::uint32_t id = rows_.push(row);
    if (nodes_.empty()) new_leaf();
    const Configuration point = embedded(row);
    std::uint32_t at = 0;
    for (;;) {
      widen(at, point.data());
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
    for (std::size_t at = nodes_.size(); at-- > 0;) fit_box(at);
  }

  [[nodiscard]] std::size_t size() const override { return rows_.size(); }

  [[nodiscard]] NearestIndex::Neighbour nearest(View q) const override {
    NearestIndex::Neighbour best{0, infinity};
    visit(
        q, [&] { return best.squared_distance; },
        [&](const NearestIndex::Neighbour& candidate) {
          if (nearer(candidate, best)) best = candidate;
        });
    return best;
  }

  void k_nearest(View q, std::size_t k, std::vector<NearestIndex::Neighbour>& out) const override {
    out.clear();
    if (k == 0) return;
    visit(
        q, [&] { return out.size() < k ? infinity : out.front().squared_distance; },
        [&](const NearestIndex::Neighbour& candidate) { offer_nearest(out, k, candidate); });
    std::sort_heap(out.begin(), out.end(), nearer);
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

 private:
  struct Node {
    std::uint32_t left = 0;  ///< 0 for a leaf: the root is no node's child
    std::uint32_t right = 0;
    std::size_t column = 0;
    double split = 0.0;
    std::vector<std::uint32_t> ids;  ///< of a leaf
    std::size_t room = 0;            ///< points that fit in `columns`, a multiple of `bucket`
    std::vector<double> columns;     ///< of a leaf: its embedded points, one column after the other

    [[nodiscard]] double at(std::size_t point, std::size_t j) const { return columns[j * room + point]; }
    void push(std::uint32_t id, const double* point, std::size_t width) {
      if (ids.size() == room) {
        const std::size_t more = std::max(bucket, 2 * room);
        std::vector<double> wider(width * more, 0.0);
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

  /// A factor of the space in the embedded rows, which have all lines first, then all circles, then all rotations.
  struct Part {
    std::size_t column = 0;  ///< in rows of the space
    double scale = 1.0;
    double length = 0.0;  ///< of a circle its circumference; of a rotation 16 weight^2: the squares of both chords
  };

  /// The row in metres: coordinates by their weights, quaternions by twice theirs.
  void embed(View row, Configuration& out) const {
    out.clear();
    for (const Part& line : lines_) out.push_back(line.scale * row[line.column]);
    for (const Part& circle : circles_) out.push_back(circle.scale * row[circle.column]);
    for (const Part& rotation : rotations_) {
      for (std::size_t i = 0; i < 4; ++i) out.push_back(rotation.scale * row[rotation.column + i]);
    }
  }
  [[nodiscard]] Configuration embedded(View row) const {
    Configuration out;
    embed(row, out);
    return out;
  }

  std::uint32_t new_leaf() {
    nodes_.emplace_back();
    boxes_.insert(boxes_.end(), width_, infinity);
    boxes_.insert(boxes_.end(), width_, -infinity);
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }

  /// The lowest coordinates of a node's embedded points; the highest follow.
  [[nodiscard]] const double* box(std::uint32_t at) const { return boxes_.data() + 2 * width_ * at; }

  void widen(std::size_t at, const double* point) {
    double* lo = boxes_.data() + 2 * width_ * at;
    double* hi = lo + width_;
    for (std::size_t j = 0; j < width_; ++j) {
      lo[j] = std::min(lo[j], point[j]);
      hi[j] = std::max(hi[j], point[j]);
    }
  }

  /// Computes the box of a node anew: from the points of a leaf, or from the boxes of the children.
  void fit_box(std::size_t at) {
    double* lo = boxes_.data() + 2 * width_ * at;
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
    const double lo = box(at)[column];
    const double hi = box(at)[width_ + column];
    const double middle = 0.5 * (lo + hi);
    if (!(lo < middle && middle <= hi)) return;
    const std::uint32_t left = new_leaf();
    const std::uint32_t right = new_leaf();
    Configuration point(width_);
    for (std::size_t i = 0; i < nodes_[at].ids.size(); ++i) {
      for (std::size_t j = 0; j < width_; ++j) point[j] = nodes_[at].at(i, j);
      const std::uint32_t child = point[column] < middle ? left : right;
      nodes_[child].push(nodes_[at].ids[i], point.data(), width_);
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

  /// At most the squared distance from y, embedded, to any point of a box.
  /// \param lines  their number, which the compiler sees where it is usual
  template <class Lines, class Rotations>
  [[nodiscard]] double box_distance(const double* lo, const double* y, Lines lines, Rotations rotations) const {
    const double* hi = lo + width_;
    const auto outside = [&](std::size_t j, double x) { return std::max({lo[j] - x, x - hi[j], 0.0}); };
    double sum = 0.0;
    std::size_t j = 0;
    for (; j < lines; ++j) {
      const double d = outside(j, y[j]);
      sum += d * d;
    }
    for (const Part& circle : circles_) {
      const double d = std::min({outside(j, y[j]), outside(j, y[j] - circle.length), outside(j, y[j] + circle.length)});
      sum += d * d;
      ++j;
    }
    for (std::size_t r = 0; r < rotations; ++r) {
      double same = 0.0;
      double opposite = 0.0;
      for (std::size_t i = 0; i < 4; ++i, ++j) {
        const double d = outside(j, y[j]), e = outside(j, -y[j]);
        same += d * d;
        opposite += e * e;
      }
      sum += std::min(same, opposite);
    }
    return sum;
  }

  /// At most the squared distances between y, embedded, and `bucket` points of a leaf, and as a rule within some
  /// percent of them. \param points  the first column, from the first of these points on \param room  distance between
  /// the columns
  template <class Lines, class Rotations>
  void bound_distances(const double* points, std::size_t room, const double* y, Lines lines, Rotations rotations,
                       std::array<double, bucket>& out) const {
    out.fill(0.0);
    for (std::size_t j = 0; j < lines; ++j, points += room) {
      for (std::size_t i = 0; i < bucket; ++i) {
        const double d = y[j] - points[i];
        out[i] += d * d;
      }
    }
    y += lines;
    for (const Part& circle : circles_) {
      for (std::size_t i = 0; i < bucket; ++i) {
        const double d = std::abs(*y - points[i]);
        const double shorter = std::min(d, std::abs(circle.length - d));
        out[i] += shorter * shorter;
      }
      points += room;
      ++y;
    }
    for (std::size_t r = 0; r < rotations; ++r) {
      const double length = rotations_[r].length;
      std::array<double, bucket> same{};
      for (std::size_t k = 0; k < 4; ++k, points += room, ++y) {
        for (std::size_t i = 0; i < bucket; ++i) {
          const double d = *y - points[i];
          same[i] += d * d;
        }
      }
      // The norms of quaternions are 1 up to rounding.
      constexpr double rounding = 1e-13;
      for (std::size_t i = 0; i < bucket; ++i) {
        const double chord = std::max(std::min(same[i], length - same[i]) - rounding * length, 0.0);
        // angle = 4 asin(c / 2), c the chord: the first terms of its square's series, all of which are positive.
        const double s = chord / length;
        out[i] += chord * (1.0 + s * (1.0 / 3.0 + s * (8.0 / 45.0)));
      }
    }
  }

  /// Calls `offer` for every point that may be within `limit()`, which decreases as points are found.
  template <class Limit, class Offer>
  void visit(View q, const Limit& limit, const Offer& offer) const {
    if (nodes_.empty()) return;
    if (lines_.size() == 3 && circles_.empty() && rotations_.size() == 1) {
      visit(q, limit, offer, std::integral_constant<std::size_t, 3>(), std::integral_constant<std::size_t, 1>());
    } else {
      visit(q, limit, offer, lines_.size(), rotations_.size());
    }
  }

  template <class Limit, class Offer, class Lines, class Rotations>
  void visit(View q, const Limit& limit, const Offer& offer, Lines lines, Rotations rotations) const {
    thread_local Configuration row, y;
    thread_local std::vector<std::pair<double, std::uint32_t>> waiting;
    row.assign(q.begin(), q.end());
    space_.normalise(row);
    embed(row, y);
    // Rounding must not hide a point at the limit.
    constexpr double rounding = 1.0 - 1e-12;
    waiting.assign(1, {0.0, 0});
    while (!waiting.empty()) {
      const auto [distance, at] = waiting.back();
      waiting.pop_back();
      if (distance * rounding > limit()) continue;
      const Node& node = nodes_[at];
      if (node.left == 0) {
        const auto offer_point = [&](std::size_t i) {
          const std::uint32_t id = node.ids[i];
          offer({id, space_.squared_distance(std::as_const(rows_)[id], row)});
        };
        for (std::size_t begin = 0; begin < node.ids.size(); begin += bucket) {
          const std::size_t count = std::min(bucket, node.ids.size() - begin);
          std::array<double, bucket> bounds;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
          bound_distances(node.columns.data() + begin, node.room, y.data(), lines, rotations, bounds);
          // The point with the least bound first: it excludes most of the others.
          const auto first = static_cast<std::size_t>(
              std::min_element(bounds.begin(), bounds.begin() + static_cast<std::ptrdiff_t>(count)) - bounds.begin());
          if (bounds[first] * rounding > limit()) continue;
          offer_point(begin + first);
          for (std::size_t i = 0; i < count; ++i) {
            if (i != first && bounds[i] * rounding <= limit()) offer_point(begin + i);
          }
        }
        continue;
      }
      const std::pair<double, std::uint32_t> left = {box_distance(box(node.left), y.data(), lines, rotations),
                                                     node.left};
      const std::pair<double, std::uint32_t> right = {box_distance(box(node.right), y.data(), lines, rotations),
                                                      node.right};
      const bool left_first = left.first <= right.first;
      const auto& farther = left_first ? right : left;
      if (farther.first * rounding <= limit()) waiting.push_back(farther);
      waiting.push_back(left_first ? left : right);
    }
  }

  Space space_;
  Configurations rows_;
  std::size_t width_;  ///< of a row
  std::vector<Part> lines_, circles_, rotations_;
  std::vector<Node> nodes_;
  std::vector<double> boxes_;  ///< by node
};

}  // namespace

std::unique_ptr<NearestIndex::Implementation> make_rotation_index(const Space& space) {
  return std::make_unique<RotationIndex>(space);
}

}  // namespace trellis
