// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/axis_projection.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

std::vector<std::string> names_of_lines(const Space& space) {
  std::vector<std::string> names;
  for (const Factor& factor : space.factors()) {
    if (factor.kind != Factor::Kind::rotation) names.push_back(factor.axis.name);
  }
  return names;
}

bool are_all(const std::vector<std::size_t>& kept, const Space& parent) {
  for (std::size_t j = 0; j < kept.size(); ++j) {
    if (kept[j] != j) return false;
  }
  return kept.size() == parent.dimension();
}

/// Whether no kept coordinate has a larger weight in S.
bool keeps_short(const Space& parent, const std::vector<std::size_t>& kept, const Space& s) {
  const std::vector<Axis> mine = s.coordinates(), theirs = parent.coordinates();
  for (std::size_t j = 0; j < kept.size(); ++j) {
    if (mine[j].weight > theirs[kept[j]].weight) return false;
  }
  return true;
}

/// S with some of the parent's coordinates.
Space part_of(const Space& parent, const std::vector<std::size_t>& kept, std::string name) {
  if (!parent.flat() && are_all(kept, parent)) return parent;
  for (const Factor& factor : parent.factors()) {
    if (factor.kind != Factor::Kind::rotation) continue;
    const auto within = [&](std::size_t j) { return j >= factor.column && j < factor.column + factor.width(); };
    const auto first = std::find_if(kept.begin(), kept.end(), within);
    const auto count = static_cast<std::size_t>(std::count_if(kept.begin(), kept.end(), within));
    if (count == 0) continue;
    bool whole = count == factor.width() && kept.end() - first >= static_cast<std::ptrdiff_t>(count);
    for (std::size_t k = 0; whole && k < count; ++k) whole = first[static_cast<std::ptrdiff_t>(k)] == factor.column + k;
    if (!whole) {
      throw Error(fmt::format("the coordinates of a rotation ({}) are kept all four in order or not at all; keep {}",
                              factor.axis.name, fmt::join(names_of_lines(parent), ", ")));
    }
  }
  return parent.part(kept, std::move(name));
}

/// For each axis of S, the parent's axis of the same name.
std::vector<std::size_t> named_alike(const Space& parent, const Space& s) {
  std::vector<std::string> names;
  names.reserve(parent.dimension());
  const std::vector<Axis> all = parent.coordinates();
  for (const Axis& axis : all) names.push_back(axis.name);
  std::vector<std::size_t> kept;
  kept.reserve(s.dimension());
  for (const Axis& axis : s.coordinates()) {
    const auto found = std::find(names.begin(), names.end(), axis.name);
    if (found == names.end()) {
      throw Error(fmt::format("S has an axis '{}' that C lacks{}; C has: {}", axis.name, did_you_mean(axis.name, names),
                              fmt::join(names, ", ")));
    }
    const auto place = static_cast<std::size_t>(found - names.begin());
    const Axis& of = all[place];
    if (axis.periodic != of.periodic || axis.lo < of.lo || axis.hi > of.hi) {
      throw Error(fmt::format("S has the axis '{}' from {:g} to {:g}{}, which is not within C's, from {:g} to {:g}{}",
                              axis.name, axis.lo, axis.hi, axis.periodic ? ", periodic" : "", of.lo, of.hi,
                              of.periodic ? ", periodic" : ""));
    }
    kept.push_back(place);
  }
  return kept;
}

}  // namespace

AxisProjection::AxisProjection(Space parent, std::vector<std::size_t> kept, std::string name)
    : parent_(std::move(parent)),
      kept_(std::move(kept)),
      space_(part_of(parent_, kept_, std::move(name))),
      contracts_(keeps_short(parent_, kept_, space_)),
      log_fibre_volume_(parent_.log_volume() - space_.log_volume()) {}

AxisProjection::AxisProjection(Space parent, Space s)
    : parent_(std::move(parent)),
      kept_(named_alike(parent_, s)),
      space_(std::move(s)),
      contracts_(keeps_short(parent_, kept_, space_)),
      log_fibre_volume_(parent_.log_volume() - space_.log_volume()) {
  const std::vector<Axis> mine = space_.coordinates(), theirs = parent_.coordinates();
  for (std::size_t j = 0; j < kept_.size(); ++j) {
    log_fibre_volume_ += std::log(mine[j].period() / theirs[kept_[j]].period());
  }
}

bool AxisProjection::identity() const { return are_all(kept_, parent_); }

Configurations AxisProjection::lifted(const Configurations& path, View start, View goal) const {
  Configurations result(parent_.dimension());
  Configuration q(parent_.dimension());
  const double length = path_length(space_, path);
  double at = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) at += space_.distance(path[i - 1], path[i]);
    parent_.interpolate(start, goal, length > 0.0 ? at / length : 0.0, q);
    for (std::size_t j = 0; j < kept_.size(); ++j) q[kept_[j]] = path[i][j];
    result.push(q);
  }
  return result;
}

}  // namespace trellis
