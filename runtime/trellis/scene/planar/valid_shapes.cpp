// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/valid_shapes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/polygon.hpp>
#include <trellis/scene/precision.hpp>

namespace trellis {

void check_box(const Box2& box, const std::string& what) {
  const auto fail = [&](const std::string& needed) {
    throw Error(fmt::format("{}: a box needs {}, got ({}, {}) to ({}, {})", what, needed, box.lo.x, box.lo.y, box.hi.x,
                            box.hi.y));
  };
  // Also true of coordinates that are not numbers.
  if (!(box.lo.x < box.hi.x && box.lo.y < box.hi.y)) fail("xmin < xmax and ymin < ymax");
  if (!in_range(box.lo) || !in_range(box.hi)) fail(fmt::format("coordinates within {:g} m of 0", most_distant));
  check_precision(box, farthest_of(box), what);
}

void check_disc(const Disc& disc, const std::string& what, bool point_allowed) {
  if (!in_range(disc.centre)) {
    throw Error(fmt::format("{}: a disc needs a centre within {:g} m of 0 in x and in y, got ({}, {})", what,
                            most_distant, disc.centre.x, disc.centre.y));
  }
  if (!(disc.radius <= most_distant) || disc.radius < 0.0 || (disc.radius == 0.0 && !point_allowed)) {
    throw Error(fmt::format("{}: a disc needs a radius {} 0 and at most {:g} m, got {}", what,
                            point_allowed ? "of at least" : "greater than", most_distant, disc.radius));
  }
  if (disc.radius > 0.0) check_precision(disc, farthest_of(bounding_box(disc)), what);
}

double farthest_of(const Box2& box) {
  return std::max({std::abs(box.lo.x), std::abs(box.lo.y), std::abs(box.hi.x), std::abs(box.hi.y)});
}

void check_precision(const Shape& shape, double farthest, const std::string& what) {
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    check_size(2.0 * disc->radius, farthest, "diameter", what);
    return;
  }
  const auto* polygon = std::get_if<Polygon>(&shape);
  const Box2 box = polygon != nullptr ? bounding_box(*polygon) : std::get<Box2>(shape);
  check_size(box.hi.x - box.lo.x, farthest, "length along x", what);
  check_size(box.hi.y - box.lo.y, farthest, "length along y", what);
}

void validate(Shape& shape, const std::string& what, bool point_allowed, std::vector<ConvexShape>& parts) {
  if (const auto* box = std::get_if<Box2>(&shape)) {
    check_box(*box, what);
    parts.emplace_back(Polygon{rectangle_vertices(*box)});
  } else if (const auto* disc = std::get_if<Disc>(&shape)) {
    check_disc(*disc, what, point_allowed);
    parts.emplace_back(*disc);
  } else {
    auto& polygon = std::get<Polygon>(shape);
    polygon = validated_polygon(std::move(polygon), what);
    check_precision(polygon, farthest_of(bounding_box(polygon)), what);
    auto convex = convex_parts(polygon);
    parts.insert(parts.end(), std::make_move_iterator(convex.begin()), std::make_move_iterator(convex.end()));
  }
}

}  // namespace trellis
