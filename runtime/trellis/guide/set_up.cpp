// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/set_up.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include <fmt/format.h>

#include <trellis/base/error.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/scene/spatial/mesh.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

SetUp set_up_of(std::string_view guide, const Options& options, const Scene& scene) {
  const GuideKind* const kind = find_guide(guide);
  if (kind == nullptr) throw Fault(fmt::format("no guide '{}'", guide));
  const double parts = kind->parts != nullptr ? kind->parts(options, scene) : world_size(scene);
  const SetUpRates& rates = scene.world_dimension() == 3 ? kind->spatial : kind->planar;
  const auto of = [&](const SetUpRate& rate) { return rate.constant + rate.per_part * parts; };
  return {of(rates.world), of(rates.run)};
}

SetUp set_up_of_custom() { return {0.0, 100.0}; }

double world_size(const Scene& scene) {
  double size = 0.0;
  if (const PlanarScene* const planar = scene.planar()) {
    constexpr double of_disc = 8.0;
    for (const auto& part : planar->world.parts()) {
      const auto* const polygon = std::get_if<Polygon>(&part.shape);
      size += polygon != nullptr ? static_cast<double>(polygon->vertices.size()) : of_disc;
    }
    return size;
  }
  constexpr double share = 1.0 / 16.0;
  for (const Obstacle3& obstacle : spatial_world(scene)->obstacles()) {
    size += 1.0;
    if (const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&obstacle.solid.shape)) {
      size += share * static_cast<double>((*mesh)->triangles().size());
    } else if (const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&obstacle.solid.shape)) {
      size += share * static_cast<double>((*cloud)->points().size());
    }
  }
  return size;
}

double retrieved_paths(const Options& options, const Scene&) {
  const auto candidates = static_cast<double>(std::get<std::int64_t>(options.at("candidates")));
  try {
    const auto library = known_paths(std::get<std::string>(options.at("db")));
    return std::min(candidates, static_cast<double>(library->size()));
  } catch (const Error&) {
    return 0.0;  // the guide reports what is wrong with the file
  }
}

}  // namespace trellis
