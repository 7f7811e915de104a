// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/along_space.hpp>

#include <algorithm>
#include <numeric>

#include <trellis/guide/tail_validity.hpp>

namespace trellis {

Space space_along(const std::vector<double>& lengths, double widest, const Space& own, const std::string& name) {
  if (lengths.empty()) return own;
  std::vector<Axis> axes;
  for (const double length : lengths) {
    const std::string number = lengths.size() == 1 ? "" : std::to_string(axes.size() + 1);
    axes.push_back({"along" + number, 0.0, length, std::min(1.0, widest / length), false});
  }
  const Space product = Space::product({{1.0, Space(name, std::move(axes))}, {1.0, own}});
  std::vector<std::size_t> all(product.dimension());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return product.part(all, name);
}

void complete_along(const Guide& f, const Instance& parent, const std::vector<double>& ends, Instance& instance) {
  const std::size_t first = ends.size();
  if (first < instance.space.dimension() && instance.scene->translates()) {
    instance.position_axes.resize(instance.scene->world_dimension());
    std::iota(instance.position_axes.begin(), instance.position_axes.end(), first);
  }
  project_ends(f, parent, instance);
  // A path may pass the places of its ends in between.
  std::fill_n(instance.start.begin(), first, 0.0);
  for (Configuration& goal : instance.goals) std::copy(ends.begin(), ends.end(), goal.begin());
  instance.resolution = parent.resolution;
  instance.collision = parent.collision;
  if (first == 0) return;
  // Another robot in the place of the one that moves: among the obstacles, without the robots that follow paths.
  std::vector<std::size_t> columns(instance.space.dimension() - first);
  std::iota(columns.begin(), columns.end(), first);
  const Space own = instance.space.part(columns, "robots");
  instance.validity_of = [own, first, collision = parent.collision,
                          resolution = parent.resolution](const std::shared_ptr<const Scene>& other) {
    return std::make_shared<TailValidity>(make_validity(collision, other, own, resolution, nullptr), first);
  };
}

}  // namespace trellis
