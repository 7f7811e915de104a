// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/spatial/surface_pair.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace trellis {

namespace {

using Corners = std::array<Vec3, 3>;

inline Vec3 absolute(const Vec3& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

/// Whether boxes, one of which is turned, are nearer than the margin along each side of either: never where they are
/// farther apart along one, often where they are farther apart at all.
class NearBoxes {
 public:
  NearBoxes(const Turn& place, double margin)
      : place_(place), x_(absolute(place.x)), y_(absolute(place.y)), z_(absolute(place.z)), margin_(margin) {}

  /// \param a  in the frame that is placed in that of b
  bool operator()(const Box3& a, const Box3& b) const {
    const Vec3 half_a = 0.5 * (a.hi - a.lo), half_b = 0.5 * (b.hi - b.lo);
    const Vec3 d = place_(0.5 * (a.lo + a.hi)) - 0.5 * (b.lo + b.hi);
    if (std::abs(d.x) > half_b.x + x_.x * half_a.x + y_.x * half_a.y + z_.x * half_a.z + margin_) return false;
    if (std::abs(d.y) > half_b.y + x_.y * half_a.x + y_.y * half_a.y + z_.y * half_a.z + margin_) return false;
    if (std::abs(d.z) > half_b.z + x_.z * half_a.x + y_.z * half_a.y + z_.z * half_a.z + margin_) return false;
    return std::abs(dot(d, place_.x)) <= half_a.x + dot(x_, half_b) + margin_ &&
           std::abs(dot(d, place_.y)) <= half_a.y + dot(y_, half_b) + margin_ &&
           std::abs(dot(d, place_.z)) <= half_a.z + dot(z_, half_b) + margin_;
  }

 private:
  Turn place_;
  Vec3 x_, y_, z_;
  double margin_;
};

/// Whether the gap between triangles along an axis of any length is greater than the margin.
bool separates(const Vec3& axis, const Corners& a, const Corners& b, double margin) {
  const double a0 = dot(axis, a[0]), a1 = dot(axis, a[1]), a2 = dot(axis, a[2]);
  const double b0 = dot(axis, b[0]), b1 = dot(axis, b[1]), b2 = dot(axis, b[2]);
  const double gap =
      std::max(std::min({a0, a1, a2}) - std::max({b0, b1, b2}), std::min({b0, b1, b2}) - std::max({a0, a1, a2}));
  return gap > 0.0 && gap * gap > margin * margin * dot(axis, axis);
}

Vec3 normal_of(const Corners& t) { return cross(t[1] - t[0], t[2] - t[0]); }

/// Whether the segment from p to q passes through the triangle: its ends are farther than the margin from its plane, on
/// both sides, and its point in the plane is farther than that from the triangle's edges, inside.
bool pierces(const Vec3& p, const Vec3& q, const Corners& t, const Vec3& normal, double margin) {
  const double above = dot(normal, p - t[0]), below = dot(normal, q - t[0]);
  const double length = std::sqrt(dot(normal, normal));
  if (std::min(std::abs(above), std::abs(below)) <= margin * length || (above > 0.0) == (below > 0.0)) return false;
  const Vec3 at = p + above / (above - below) * (q - p);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = t[(i + 1) % 3] - t[i];
    const double inside = dot(cross(normal, edge), at - t[i]);
    if (!(inside > 0.0 && inside * inside > margin * margin * dot(normal, normal) * dot(edge, edge))) return false;
  }
  return true;
}

/// Compares two triangles in one frame.
SurfacePair compare(const Corners& a, const Corners& b, double margin) {
  const Vec3 of_b = normal_of(b);
  if (separates(of_b, a, b, margin)) return SurfacePair::apart;
  const Vec3 of_a = normal_of(a);
  if (separates(of_a, a, b, margin)) return SurfacePair::apart;
  // Where triangles meet, an edge of one passes through the other.
  for (std::size_t i = 0; i < 3; ++i) {
    if (pierces(a[i], a[(i + 1) % 3], b, of_b, margin) || pierces(b[i], b[(i + 1) % 3], a, of_a, margin)) {
      return SurfacePair::meet;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = a[(i + 1) % 3] - a[i];
    for (std::size_t j = 0; j < 3; ++j) {
      if (separates(cross(edge, b[(j + 1) % 3] - b[j]), a, b, margin)) return SurfacePair::apart;
    }
  }
  return SurfacePair::unknown;
}

}  // namespace

SurfacePair compare_surfaces(const MeshDistance& first, const MeshDistance& second, const Turn& place, double margin,
                             TrianglePair& guess) {
  const std::size_t none = first.corners().size();
  std::size_t placed = none;
  Corners a;
  const auto compare_pair = [&](std::uint32_t i, std::uint32_t j) {
    if (i != placed) {
      for (std::size_t k = 0; k < 3; ++k) a[k] = place(first.corners()[i][k]);
      placed = i;
    }
    return compare(a, second.corners()[j], margin);
  };
  if (guess.first < none && guess.second < second.corners().size() &&
      compare_pair(guess.first, guess.second) == SurfacePair::meet) {
    return SurfacePair::meet;
  }
  SurfacePair all = SurfacePair::apart;
  first.tree().each_pair(second.tree(), NearBoxes(place, margin), [&](std::uint32_t i, std::uint32_t j) {
    const SurfacePair pair = compare_pair(i, j);
    if (pair == SurfacePair::apart) return true;
    all = pair;
    if (pair == SurfacePair::unknown) return true;
    guess = {i, j};
    return false;
  });
  return all;
}

}  // namespace trellis
