// SPDX-License-Identifier: GPL-3.0-or-later
// Rotations of space and poses.
#include <cmath>
#include <numbers>

#include <trellis/base/random.hpp>
#include <trellis/space/rotation.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

Quaternion random_rotation(Stream& stream) {
  const double first = stream.uniform();
  const double second = stream.uniform();
  return rotation_from_unit({first, second, stream.uniform()});
}

Vec3 random_vector(Stream& stream) {
  const double x = stream.normal();
  const double y = stream.normal();
  return {x, y, stream.normal()};
}

void check_near(const Vec3& a, const Vec3& b) {
  CHECK(a.x == Approx(b.x).margin(1e-12));
  CHECK(a.y == Approx(b.y).margin(1e-12));
  CHECK(a.z == Approx(b.z).margin(1e-12));
}

}  // namespace

TEST_CASE("a quarter turn about z takes x to y", "[space][rotation]") {
  const Quaternion quarter = rotation_of({0, 0, 0.5 * std::numbers::pi});
  check_near(quarter({1, 0, 0}), {0, 1, 0});
  check_near(quarter({0, 1, 0}), {-1, 0, 0});
  check_near(quarter({0, 0, 1}), {0, 0, 1});
}

TEST_CASE("rotations keep lengths and angles, and compose as their quaternions multiply", "[space][rotation]") {
  Stream stream(1, "rotation", "group");
  for (int i = 0; i < 1000; ++i) {
    const Quaternion a = random_rotation(stream);
    const Quaternion b = random_rotation(stream);
    const Vec3 v = random_vector(stream);
    const Vec3 u = random_vector(stream);
    CHECK(dot(a(v), a(u)) == Approx(dot(v, u)).margin(1e-12));
    check_near((a * b)(v), a(b(v)));
    check_near(a.inverse()(a(v)), v);
    check_near(cross(a(v), a(u)), a(cross(v, u)));
  }
}

TEST_CASE("a rotation by a vector is Rodrigues' formula", "[space][rotation]") {
  Stream stream(2, "rotation", "rodrigues");
  for (int i = 0; i < 1000; ++i) {
    const Vec3 v = stream.uniform(0.0, 4.0) * random_vector(stream);
    const Vec3 p = random_vector(stream);
    const double angle = norm(v);
    const Vec3 k = (1.0 / angle) * v;
    const Vec3 expected = std::cos(angle) * p + std::sin(angle) * cross(k, p) + (1.0 - std::cos(angle)) * dot(k, p) * k;
    check_near(rotation_of(v)(p), expected);
  }
}

TEST_CASE("the rotation vector is at most a half turn long and inverts the rotation by a vector", "[space][rotation]") {
  Stream stream(3, "rotation", "vector");
  for (int i = 0; i < 1000; ++i) {
    const Quaternion q = random_rotation(stream);
    const Vec3 v = rotation_vector(q);
    CHECK(norm(v) <= std::numbers::pi + 1e-15);
    CHECK(angle_between(rotation_of(v), q) < 1e-12);
    check_near(rotation_vector({-q.x, -q.y, -q.z, -q.w}), v);
  }
  for (const double angle : {0.0, 1e-150, 1e-12, 1e-5, 1.0, 3.14159}) {
    const Vec3 v = {0.6 * angle, 0.0, 0.8 * angle};
    CHECK(rotation_vector(rotation_of(v)).x == Approx(v.x).epsilon(1e-12));
    CHECK(angle_between({}, rotation_of(v)) == Approx(angle).epsilon(1e-9));
  }
}

TEST_CASE("each rotation has one normalised quaternion", "[space][rotation]") {
  Stream stream(4, "rotation", "sign");
  for (int i = 0; i < 1000; ++i) {
    const Quaternion q = random_rotation(stream);
    const Quaternion opposite = normalised({-q.x, -q.y, -q.z, -q.w});
    CHECK(normalised(q) == opposite);
    CHECK(opposite.w >= 0.0);
    const Quaternion longer = normalised({3 * q.x, 3 * q.y, 3 * q.z, 3 * q.w});
    CHECK(angle_between(longer, q) < 1e-12);
  }
  CHECK(normalised({0, 0, 0, 0}) == Quaternion{});
  CHECK(normalised({-1, 0, 0, 0}) == Quaternion{1, 0, 0, 0});
}

TEST_CASE("poses compose and invert", "[space][rotation]") {
  Stream stream(5, "rotation", "poses");
  for (int i = 0; i < 300; ++i) {
    const Vec3 first = random_vector(stream);
    const Pose3 a = {first, random_rotation(stream)};
    const Vec3 second = random_vector(stream);
    const Pose3 b = {second, random_rotation(stream)};
    const Vec3 p = random_vector(stream);
    check_near((a * b)(p), a(b(p)));
    check_near(a.inverse()(a(p)), p);
  }
}
