// SPDX-License-Identifier: GPL-3.0-or-later
// Exact numbers, and exact tests of a segment against closed shapes of the plane and of space. They take the doubles of
// a scene as they are and use sums and products alone, so nothing is rounded.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>
#include <trellis/scene/spatial/shapes.hpp>

namespace trellis::test {

/// The number m 2^e with whole m and e. Every finite double is one, and so are sums and products of them.
class Exact {
 public:
  Exact() = default;
  Exact(double x) {  // NOLINT(google-explicit-constructor): a double is such a number
    if (x == 0.0) return;
    constexpr int digits = std::numeric_limits<double>::digits;
    int exponent = 0;
    const double fraction = std::frexp(x, &exponent);
    m_ = static_cast<std::int64_t>(std::ldexp(fraction, digits));
    e_ = exponent - digits;
  }

  [[nodiscard]] int sign() const { return m_.sign(); }

  friend Exact operator*(const Exact& a, const Exact& b) {
    Exact product;
    product.m_ = a.m_ * b.m_;
    product.e_ = product.m_.is_zero() ? 0 : a.e_ + b.e_;
    return product;
  }
  friend Exact operator+(const Exact& a, const Exact& b) { return sum(a, b, false); }
  friend Exact operator-(const Exact& a, const Exact& b) { return sum(a, b, true); }
  friend bool operator<(const Exact& a, const Exact& b) { return (a - b).sign() < 0; }
  friend bool operator<=(const Exact& a, const Exact& b) { return (a - b).sign() <= 0; }

 private:
  static Exact sum(const Exact& a, const Exact& b, bool minus) {
    Exact result;
    if (a.m_.is_zero() || b.m_.is_zero()) {
      result = a.m_.is_zero() ? b : a;
      if (a.m_.is_zero() && minus) result.m_ = -result.m_;
      return result;
    }
    result.e_ = std::min(a.e_, b.e_);
    boost::multiprecision::cpp_int left = a.m_, right = b.m_;
    left <<= static_cast<unsigned>(a.e_ - result.e_);
    right <<= static_cast<unsigned>(b.e_ - result.e_);
    result.m_ = left;
    if (minus) {
      result.m_ -= right;
    } else {
      result.m_ += right;
    }
    if (result.m_.is_zero()) result.e_ = 0;
    return result;
  }

  boost::multiprecision::cpp_int m_;
  int e_ = 0;
};

/// A quotient of exact numbers; the denominator is positive.
struct Fraction {
  Exact over = 0.0;
  Exact under = 1.0;
  friend bool operator<(const Fraction& a, const Fraction& b) { return a.over * b.under < b.over * a.under; }
};

struct Exact3 {
  Exact x, y, z;

  friend Exact3 operator+(const Exact3& a, const Exact3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Exact3 operator-(const Exact3& a, const Exact3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Exact3 operator*(const Exact& s, const Exact3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

inline Exact3 exact(Vec2 p) { return {p.x, p.y, 0.0}; }
inline Exact3 exact(const Vec3& p) { return {p.x, p.y, p.z}; }
inline Exact dot(const Exact3& a, const Exact3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Exact3 cross(const Exact3& a, const Exact3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Whether the distance of p from the segment a b is at most r. `squared` is r^2.
inline bool within(const Exact3& p, const Exact3& a, const Exact3& b, const Exact& squared) {
  const Exact3 along = b - a, to = p - a;
  const Exact length = dot(along, along), foot = dot(to, along);
  if (foot.sign() <= 0) return dot(to, to) <= squared;
  if (length <= foot) return dot(p - b, p - b) <= squared;
  const Exact3 normal = cross(to, along);
  return dot(normal, normal) <= squared * length;
}

/// Whether the distance of the segments a b and c d is at most r.
inline bool within(const Exact3& a, const Exact3& b, const Exact3& c, const Exact3& d, const Exact& squared) {
  if (within(a, c, d, squared) || within(b, c, d, squared) || within(c, a, b, squared) || within(d, a, b, squared)) {
    return true;
  }
  // Else the nearest points lie inside both segments, on the common normal of their lines.
  const Exact3 u = b - a, v = d - c, w = c - a, n = cross(u, v);
  const Exact area = dot(n, n);
  if (area.sign() == 0) return false;
  const Exact s = dot(cross(w, v), n), t = dot(cross(w, u), n);
  if (s.sign() < 0 || area < s || t.sign() < 0 || area < t) return false;
  const Exact height = dot(w, n);
  return height * height <= squared * area;
}

/// Twice the signed area of the triangle a b c of the plane.
inline Exact turn(const Exact3& a, const Exact3& b, const Exact3& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether closed segments of the plane touch.
inline bool touch(const Exact3& a, const Exact3& b, const Exact3& c, const Exact3& d) {
  const int p = turn(a, b, c).sign(), q = turn(a, b, d).sign();
  const int r = turn(c, d, a).sign(), s = turn(c, d, b).sign();
  if (p * q < 0 && r * s < 0) return true;
  const Exact none = 0.0;
  return within(a, c, d, none) || within(b, c, d, none) || within(c, a, b, none) || within(d, a, b, none);
}

/// Whether a point of the plane that lies on no edge lies inside the polygon.
inline bool inside(const std::vector<Exact3>& polygon, const Exact3& p) {
  bool odd = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const bool above = p.y < polygon[i].y, before = p.y < polygon[j].y;
    if (above == before) continue;
    // The edge crosses the height of p. Count it where the crossing lies to the right.
    const int side = turn(polygon[j], polygon[i], p).sign();
    if (above ? side > 0 : side < 0) odd = !odd;
  }
  return odd;
}

/// Whether a segment of the plane touches the closed polygon.
inline bool touches(const std::vector<Exact3>& polygon, const Exact3& a, const Exact3& b) {
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    if (touch(a, b, polygon[j], polygon[i])) return true;
  }
  return inside(polygon, a);
}

/// Clips the parameters [from, to] of a + t (b - a) to -half <= coordinate <= half.
inline bool clip(const Exact& a, const Exact& b, const Exact& half, Fraction& from, Fraction& to) {
  const Exact along = b - a;
  if (along.sign() == 0) return !(half < a) && !(a < Exact(0.0) - half);
  Fraction enter{Exact(0.0) - half - a, along}, leave{half - a, along};
  if (along.sign() < 0) {
    for (Fraction* f : {&enter, &leave}) *f = {Exact(0.0) - f->over, Exact(0.0) - f->under};
    std::swap(enter, leave);
  }
  if (from < enter) from = enter;
  if (leave < to) to = leave;
  return !(to < from);
}

/// Whether the segment touches the closed box about the origin with these half lengths.
inline bool touches_box(const Exact3& a, const Exact3& b, const Exact3& half) {
  Fraction from{0.0, 1.0}, to{1.0, 1.0};
  return clip(a.x, b.x, half.x, from, to) && clip(a.y, b.y, half.y, from, to) && clip(a.z, b.z, half.z, from, to);
}

/// Whether the segment touches the closed cylinder about the z axis.
inline bool touches_cylinder(const Exact3& a, const Exact3& b, const Exact& radius, const Exact& half) {
  Fraction from{0.0, 1.0}, to{1.0, 1.0};
  if (!clip(a.z, b.z, half, from, to)) return false;
  const Exact dx = b.x - a.x, dy = b.y - a.y;
  const Exact square = dx * dx + dy * dy, slope = Exact(0.0) - (a.x * dx + a.y * dy);
  Fraction at = from;  // the parameter at which the segment is nearest to the axis
  if (square.sign() > 0) {
    const Fraction nearest{slope, square};
    if (at < nearest) at = to < nearest ? to : nearest;
  }
  const Exact x = at.under * a.x + at.over * dx, y = at.under * a.y + at.over * dy, r = radius * at.under;
  return x * x + y * y <= r * r;
}

/// Whether the segment touches the closed triangle in space.
inline bool touches_triangle(const Exact3& a, const Exact3& b, const std::array<Exact3, 3>& v) {
  const Exact3 n = cross(v[1] - v[0], v[2] - v[0]);
  const Exact at_a = dot(n, a - v[0]), at_b = dot(n, b - v[0]);
  const int side = at_a.sign() * at_b.sign();
  if (side > 0) return false;
  if (at_a.sign() == 0 && at_b.sign() == 0) {
    // In the triangle's plane: drop the coordinate in which the projection has an area.
    const auto flat = [&n](const Exact3& p) -> Exact3 {
      if (n.z.sign() != 0) return {p.x, p.y, 0.0};
      if (n.y.sign() != 0) return {p.x, p.z, 0.0};
      return {p.y, p.z, 0.0};
    };
    return touches({flat(v[0]), flat(v[1]), flat(v[2])}, flat(a), flat(b));
  }
  // The line a b passes the edges on one side of all of them, or through an edge.
  int positive = 0, negative = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const int s = dot(cross(v[i] - a, v[(i + 1) % 3] - a), b - a).sign();
    positive += s > 0 ? 1 : 0;
    negative += s < 0 ? 1 : 0;
  }
  return positive == 0 || negative == 0;
}

/// Whether a point that lies on no triangle of a closed mesh lies inside: the parity of the triangles that a segment to
/// a far point crosses.
inline bool inside(const Mesh& mesh, const Vec3& p) {
  const Vec3 size = mesh.bounds().hi - mesh.bounds().lo;
  // The direction of the segment is arbitrary; another one where it meets an edge or a vertex.
  for (double spread = 0.1234567;; spread *= 1.37) {
    const double far = 4.0 * (norm(size) + norm(p - mesh.bounds().lo));
    const Exact3 a = exact(p), b = exact(p + far * Vec3{1.0, spread, 0.71 * spread + 0.01});
    bool odd = false, degenerate = false;
    for (const Triangle& t : mesh.triangles()) {
      const std::array<Exact3, 3> v = {exact(mesh.vertices()[t[0]]), exact(mesh.vertices()[t[1]]),
                                       exact(mesh.vertices()[t[2]])};
      if (!touches_triangle(a, b, v)) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        degenerate = degenerate || dot(cross(v[i] - a, v[(i + 1) % 3] - a), b - a).sign() == 0;
      }
      odd = !odd;
    }
    if (!degenerate) return odd;
  }
}

/// A quaternion's rotation times its squared norm, which sums and products give exactly.
inline Exact3 turned(const Quaternion& q, const Exact3& p) {
  const Exact3 axis{q.x, q.y, q.z};
  const Exact w = q.w;
  // (w^2 - |axis|^2) p + 2 (axis . p) axis + 2 w axis x p
  return (w * w - dot(axis, axis)) * p + Exact(2.0) * (dot(axis, p) * axis) + Exact(2.0) * (w * cross(axis, p));
}

}  // namespace trellis::test
