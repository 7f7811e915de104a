// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/pruning.hpp>

#include <algorithm>
#include <utility>

namespace trellis {

PathPruning::PathPruning(const Configurations& path, std::function<bool(View, View)> valid)
    : path_(path), valid_(std::move(valid)), pruned_(path.dimension()) {
  pruned_.push(path.front());
}

void PathPruning::step() {
  const Configurations& path = path_;
  const std::size_t target = std::min(at_ + reach_, path.size() - 1);
  if (target > best_ && valid_(path[at_], path[target])) {
    best_ = target;
    reach_ *= 2;
    return;
  }
  pruned_.push(path[best_]);
  at_ = best_;
  best_ = at_ + 1;
  reach_ = 2;
}

}  // namespace trellis
