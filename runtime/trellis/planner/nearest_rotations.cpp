// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest neighbours where a space has rotations: an incremental kd-tree of buckets over rows in which a distance is
// never more than the metric's. A rotation's quaternion is scaled by twice its weight: the chord between two
// quaternions is 2 sin(angle / 4), so twice the weight times the chord is at most the weight times the angle. q and -q
// are one rotation, so a box is as near as the nearer of the two. Distances of single points are the metric's own.
#include <algorithm>
#include <array>
#include <limits>

#include <trellis/planner/nearest_implementation.hpp>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t bucket = 32;
constexpr NearerNeighbour nearer;

class RotationIndex final : public NearestIndex::Implementation {
 public:
  explicit RotationIndex(const Space& space) : space_(space), rows_(space.dimension()) {}

  std::uint32_t add(View q) override {
    Configuration row(q.begin(), q.end());
    space_.normalise(row);
    const std::uint32_t id = rows_.push(row);
    if (nodes_.empty()) new_leaf();
    const Configuration point = embedded(row);
    std::uint32_t at = 0;
    for (;;) {
      widen(at, point);
      if (nodes_[at].left == 0) break;
      at = point[nodes_[at].column] < nodes_[at].split ? nodes_[at].left : nodes_[at].right;
    }
    nodes_[at].ids.push_back(id);
    if (nodes_[at].ids.size() > bucket) split(at);
    return id;
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
    Configuration lo, hi;            ///< the box of its embedded points
  };

  /// The row in metres: coordinates by their weights, quaternions by twice theirs.
  [[nodiscard]] Configuration embedded(View row) const {
    Configuration out(row.size());
    for (const Factor& factor : space_.factors()) {
      const double scale = factor.kind == Factor::Kind::rotation ? 2.0 * factor.axis.weight : factor.axis.weight;
      for (std::size_t j = factor.column; j < factor.column + factor.width(); ++j) out[j] = scale * row[j];
    }
    return out;
  }

  std::uint32_t new_leaf() {
    Node node;
    node.lo.assign(space_.dimension(), infinity);
    node.hi.assign(space_.dimension(), -infinity);
    nodes_.push_back(std::move(node));
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }

  void widen(std::uint32_t at, const Configuration& point) {
    for (std::size_t j = 0; j < point.size(); ++j) {
      nodes_[at].lo[j] = std::min(nodes_[at].lo[j], point[j]);
      nodes_[at].hi[j] = std::max(nodes_[at].hi[j], point[j]);
    }
  }

  /// Splits a leaf at the middle of the widest side of its box. A leaf whose points coincide stays whole.
  void split(std::uint32_t at) {
    std::size_t column = 0;
    for (std::size_t j = 0; j < space_.dimension(); ++j) {
      if (nodes_[at].hi[j] - nodes_[at].lo[j] > nodes_[at].hi[column] - nodes_[at].lo[column]) column = j;
    }
    const double lo = nodes_[at].lo[column];
    const double hi = nodes_[at].hi[column];
    const double middle = 0.5 * (lo + hi);
    if (!(lo < middle && middle <= hi)) return;
    const std::uint32_t left = new_leaf();
    const std::uint32_t right = new_leaf();
    for (const std::uint32_t id : nodes_[at].ids) {
      const Configuration point = embedded(std::as_const(rows_)[id]);
      const std::uint32_t child = point[column] < middle ? left : right;
      nodes_[child].ids.push_back(id);
      widen(child, point);
    }
    Node& node = nodes_[at];
    node.ids = {};
    node.left = left;
    node.right = right;
    node.column = column;
    node.split = middle;
  }

  /// At most the squared distance from y, embedded, to any point of a node's box.
  [[nodiscard]] double box_distance(const Node& node, const Configuration& y) const {
    const auto outside = [&](std::size_t j, double x) { return std::max({node.lo[j] - x, x - node.hi[j], 0.0}); };
    double sum = 0.0;
    for (const Factor& factor : space_.factors()) {
      const std::size_t j = factor.column;
      if (factor.kind == Factor::Kind::rotation) {
        double same = 0.0;
        double opposite = 0.0;
        for (std::size_t i = j; i < j + factor.width(); ++i) {
          same += outside(i, y[i]) * outside(i, y[i]);
          opposite += outside(i, -y[i]) * outside(i, -y[i]);
        }
        sum += std::min(same, opposite);
        continue;
      }
      double d = outside(j, y[j]);
      if (factor.kind == Factor::Kind::circle) {
        const double period = factor.axis.weight * factor.axis.period();
        d = std::min({d, outside(j, y[j] - period), outside(j, y[j] + period)});
      }
      sum += d * d;
    }
    return sum;
  }

  /// Calls `offer` for every point that may be within `limit()`, which decreases as points are found.
  template <class Limit, class Offer>
  void visit(View q, const Limit& limit, const Offer& offer) const {
    if (nodes_.empty()) return;
    Configuration row(q.begin(), q.end());
    space_.normalise(row);
    const Configuration y = embedded(row);
    // Rounding must not hide a point at the limit.
    constexpr double rounding = 1.0 - 1e-12;
    std::vector<std::pair<double, std::uint32_t>> waiting = {{0.0, 0}};
    while (!waiting.empty()) {
      const auto [distance, at] = waiting.back();
      waiting.pop_back();
      if (distance * rounding > limit()) continue;
      const Node& node = nodes_[at];
      if (node.left == 0) {
        for (const std::uint32_t id : node.ids) {
          offer({id, space_.squared_distance(std::as_const(rows_)[id], row)});
        }
        continue;
      }
      const std::pair<double, std::uint32_t> left = {box_distance(nodes_[node.left], y), node.left};
      const std::pair<double, std::uint32_t> right = {box_distance(nodes_[node.right], y), node.right};
      const bool left_first = left.first <= right.first;
      waiting.push_back(left_first ? right : left);
      waiting.push_back(left_first ? left : right);
    }
  }

  Space space_;
  Configurations rows_;
  std::vector<Node> nodes_;
};

}  // namespace

std::unique_ptr<NearestIndex::Implementation> make_rotation_index(const Space& space) {
  return std::make_unique<RotationIndex>(space);
}

}  // namespace trellis
