// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/checker.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>

namespace trellis {

std::unique_ptr<Checker> make_checker(const std::string& backend, std::shared_ptr<const Scene> scene,
                                      const Space& space, double resolution) {
  const std::vector<std::string> known = collision_backends(*scene);
  if (std::find(known.begin(), known.end(), backend) == known.end()) {
    throw Error(fmt::format("no collision backend '{}'; there are '{}' and '{}'{}", backend, known.front(),
                            known.back(), did_you_mean(backend, known)));
  }
  if (scene->manipulator() != nullptr) return make_sphere_checker(std::move(scene), space, resolution);
  if (scene->spatial() != nullptr) {
    return make_spatial_checker(std::move(scene), space, resolution, backend == "fcl");
  }
  if (backend == "planar") return make_planar_checker(std::move(scene), space, resolution);
  return make_fcl_checker(std::move(scene), space, resolution);
}

std::vector<std::string> collision_backends(const Scene& scene) {
  if (scene.manipulator() != nullptr) return {"spheres"};
  if (scene.spatial() != nullptr) return {"fcl", "fcl_plain"};
  return {"planar", "fcl"};
}

std::string describe(const Contact& contact, const Scene& scene) {
  if (contact.other) {
    return fmt::format("itself ({} meets {})", contact.link.empty() ? scene.body_name(contact.body) : contact.link,
                       contact.other_link.empty() ? scene.body_name(*contact.other) : contact.other_link);
  }
  if (!contact.obstacle) return "the world's boundary";
  return scene.obstacle_name(*contact.obstacle);
}

std::vector<std::uint32_t> bisection_order(std::uint32_t n) {
  std::vector<std::uint32_t> order;
  if (n == 0) return order;
  order.reserve(n);
  order.push_back(n);
  // Intervals whose midpoints come next; each level contains the halves of the intervals before, from the left.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> level = {{0, n}};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> next;
  while (!level.empty()) {
    next.clear();
    for (const auto& [lo, hi] : level) {
      if (hi - lo < 2) continue;
      const std::uint32_t middle = lo + (hi - lo) / 2;
      order.push_back(middle);
      next.emplace_back(lo, middle);
      next.emplace_back(middle, hi);
    }
    std::swap(level, next);
  }
  return order;
}

}  // namespace trellis
