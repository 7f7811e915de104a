// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <trellis/space/nearest.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

std::vector<Space> spaces() {
  const auto r2 = Space::euclidean({{0, 10}, {-3, 4}});
  return {Space::so2(),
          r2,
          Space::se2({0, 10}, {0, 10}),
          Space::product({{1.0, r2}, {0.7, Space::so2()}, {2.0, Space::so2(1.0, "phi")}}),
          Space::euclidean({{0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}}),
          Space::so3(),
          Space::se3({{{0, 10}, {0, 10}, {0, 10}}}, 3.0),
          Space::se3({{{5e8, 5e8 + 1}, {-1e-9, 1e-9}, {0, 1}}}, 0.01),
          Space::se3({{{0, 10}, {0, 10}, {0, 10}}}, 1e25),
          Space::product({{1e-25, r2}, {1e-25, Space::so3()}, {1e-20, Space::so2()}}),
          Space::product({{1e25, r2}, {1.0, Space::so3()}, {1e25, Space::so2()}}),
          Space::product({{1.0, r2}, {0.5, Space::so3()}, {2.0, Space::so2()}, {1.0, Space::so3()}})};
}

/// Brute force: all points by distance, then by number.
std::vector<NearestIndex::Neighbour> sorted(const Space& space, const Configurations& points, View q) {
  std::vector<NearestIndex::Neighbour> all;
  for (std::uint32_t i = 0; i < points.size(); ++i) all.push_back({i, space.squared_distance(points[i], q)});
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.squared_distance < b.squared_distance; });
  return all;
}

}  // namespace

TEST_CASE("nearest neighbours agree with brute force in every space", "[nearest]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(7, space.name(), "nearest");
    NearestIndex index(space);
    Configurations points(space.dimension());
    Configuration q(space.dimension());
    std::vector<NearestIndex::Neighbour> found;
    for (int i = 0; i < 3000; ++i) {
      space.sample_uniform(stream, q);
      if (i % 10 == 0 && i > 0) {  // duplicates
        const View old = std::as_const(points)[stream.below(points.size())];
        q.assign(old.begin(), old.end());
      }
      points.push(q);
      REQUIRE(index.add(q) == static_cast<std::uint32_t>(i));
      if (i % 29 != 0) continue;
      space.sample_uniform(stream, q);
      const auto expected = sorted(space, points, q);
      CHECK(
          index.nearest(q).squared_distance ==
          Approx(expected.front().squared_distance).epsilon(1e-9).margin(1e-15 * space.diameter() * space.diameter()));
      const auto nearest = index.nearest(q);
      CHECK(index.squared_distance(std::as_const(points)[nearest.id], q) == nearest.squared_distance);
      index.k_nearest(q, 7, found);
      REQUIRE(found.size() == std::min<std::size_t>(7, points.size()));
      for (std::size_t k = 0; k < found.size(); ++k) {
        CHECK(found[k].squared_distance ==
              Approx(expected[k].squared_distance).epsilon(1e-9).margin(1e-15 * space.diameter() * space.diameter()));
      }
      const double radius = 0.1 * space.diameter();
      index.within(q, radius, found);
      const auto inside = std::count_if(expected.begin(), expected.end(),
                                        [&](const auto& n) { return n.squared_distance <= radius * radius; });
      CHECK(found.size() == static_cast<std::size_t>(inside));
    }
  }
}

TEST_CASE("after points were removed, an index answers as one of the points that were kept", "[nearest]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(11, space.name(), "nearest");
    NearestIndex index(space);
    Configurations points(space.dimension());
    Configuration q(space.dimension());
    std::vector<NearestIndex::Neighbour> found, expected;
    // One round removes all points, and the index starts again.
    for (const double share : {0.5, 0.02, 0.9, 0.0, 0.3, 1.0, 0.5}) {
      CAPTURE(share);
      for (int i = 0; i < 700; ++i) {
        space.sample_uniform(stream, q);
        if (i % 10 == 0 && !points.empty()) {  // duplicates
          const View old = std::as_const(points)[stream.below(points.size())];
          q.assign(old.begin(), old.end());
        }
        points.push(q);
        REQUIRE(index.add(q) + 1 == points.size());
      }
      std::vector<std::uint8_t> keep;
      Configurations kept(space.dimension());
      NearestIndex fresh(space);
      for (std::uint32_t id = 0; id < points.size(); ++id) {
        keep.push_back(stream.uniform() < share ? 0 : 1);
        if (keep.back() == 0) continue;
        kept.push(std::as_const(points)[id]);
        fresh.add(std::as_const(points)[id]);
      }
      index.retain(keep);
      points = kept;
      REQUIRE(index.size() == points.size());
      for (int i = 0; i < 50 && !points.empty(); ++i) {
        space.sample_uniform(stream, q);
        CHECK(index.nearest(q).id == fresh.nearest(q).id);
        index.k_nearest(q, 9, found);
        fresh.k_nearest(q, 9, expected);
        REQUIRE(found.size() == expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) CHECK(found[k].id == expected[k].id);
        index.within(q, 0.1 * space.diameter(), found);
        fresh.within(q, 0.1 * space.diameter(), expected);
        REQUIRE(found.size() == expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) CHECK(found[k].id == expected[k].id);
      }
      index.within(q, 2.0 * space.diameter(), found);
      CHECK(found.size() == points.size());
      CHECK(index.count_within(q, 0.01 * space.diameter() * space.diameter()) ==
            fresh.count_within(q, 0.01 * space.diameter() * space.diameter()));
    }
  }
}

TEST_CASE("distances and counts agree with brute force, of indices that grew and that were built at once",
          "[nearest]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    for (const std::size_t n : {0U, 1U, 2U, 15U, 16U, 17U, 33U, 500U, 3000U}) {
      CAPTURE(n);
      Stream stream(n, space.name(), "nearest");
      Configurations points(space.dimension());
      std::vector<double> rows;
      NearestIndex grown(space);
      Configuration q(space.dimension());
      for (std::size_t i = 0; i < n; ++i) {
        space.sample_uniform(stream, q);
        // Clusters and ties stress the splits.
        if (i % 3 == 0 && space.flat()) q[0] = space.axes()[0].lo;
        if (i % 10 == 0 && i > 0) q = Configuration(points[i / 2].begin(), points[i / 2].end());
        points.push(q);
        grown.add(q);
        rows.insert(rows.end(), q.begin(), q.end());
      }
      const NearestIndex built(space, rows);
      REQUIRE(built.size() == n);
      std::vector<double> found(5), of_grown(5);
      std::vector<NearestIndex::Neighbour> near, near_grown;
      for (int query = 0; query < 60; ++query) {
        space.sample_uniform(stream, q);
        if (query % 5 == 0 && space.flat()) q.back() = space.axes().back().lo;
        const auto expected = sorted(space, points, q);
        const double scale = space.diameter() * space.diameter();
        built.nearest_distances(q, found);
        grown.nearest_distances(q, of_grown);
        CHECK(found == of_grown);
        built.k_nearest(q, found.size(), near);
        grown.k_nearest(q, found.size(), near_grown);
        REQUIRE(near.size() == std::min(n, found.size()));
        for (std::size_t k = 0; k < found.size(); ++k) {
          if (k >= n) {
            CHECK(std::isinf(found[k]));
            continue;
          }
          CHECK(found[k] == Approx(expected[k].squared_distance).epsilon(1e-9).margin(1e-15 * scale));
          CHECK(near[k].squared_distance == found[k]);
          CHECK(near[k].id == near_grown[k].id);
        }
        // Halfway between two distances no rounding can move a point over the border.
        for (const std::size_t m : {std::size_t{1}, n / 10, n / 3, n / 2, 9 * n / 10, n - 1}) {
          if (m == 0 || m >= n) continue;
          const double least = expected[m - 1].squared_distance, next = expected[m].squared_distance;
          if (next - least < 1e-9 * scale) continue;
          CHECK(built.count_within(q, 0.5 * (least + next)) == m);
          CHECK(grown.count_within(q, 0.5 * (least + next)) == m);
        }
        CHECK(built.count_within(q, 4.0 * scale) == n);
        CHECK(grown.count_within(q, 4.0 * scale) == n);
        // Without duplicates a radius that is exactly a distance counts its point.
        for (std::size_t k = 0; k + 1 < std::min(n, found.size()); ++k) {
          if (found[k] < found[k + 1]) CHECK(built.count_within(q, found[k]) == k + 1);
        }
      }
    }
  }
}

TEST_CASE("of equally near points the first added is returned", "[nearest]") {
  const Space space = Space::euclidean({{0, 1}, {0, 1}});
  NearestIndex index(space);
  for (int i = 0; i < 200; ++i) index.add(Configuration{0.5, 0.5});
  CHECK(index.nearest(Configuration{0.1, 0.9}).id == 0);
  std::vector<NearestIndex::Neighbour> found;
  index.k_nearest(Configuration{0.1, 0.9}, 5, found);
  for (std::uint32_t i = 0; i < 5; ++i) CHECK(found[i].id == i);
}

TEST_CASE("the nearest neighbour is found across the seam of an angle", "[nearest]") {
  const Space space = Space::se2({0, 10}, {0, 10});
  NearestIndex index(space);
  index.add(Configuration{5, 5, 3.1});
  index.add(Configuration{5, 5, -2.0});
  CHECK(index.nearest(Configuration{5, 5, -3.1}).id == 0);
}
