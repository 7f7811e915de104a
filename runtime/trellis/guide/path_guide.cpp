// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/path_guide.hpp>

#include <algorithm>
#include <cmath>

namespace trellis {

namespace {

constexpr std::size_t most_bins = 256;
constexpr std::int64_t patience_when_covered = 10;

}  // namespace

double tube_radius(const PathGuideSettings& settings, const Instance& instance) {
  if (settings.radius > 0.0) return settings.radius;
  const double robot = instance.scene->robot.bounding_radius();
  return robot > 0.0 ? 0.5 * robot : 0.01 * instance.space.diameter();
}

PathHeuristic::PathHeuristic(std::string source, const Space& space, Configurations path, double radius, double window,
                             std::int64_t patience, const NearestIndex* reached)
    : source_(std::move(source)),
      space_(space),
      tube_(space, std::move(path), radius),
      window_(window),
      patience_(patience),
      centres_(space.dimension()) {
  const double length = tube_.length();
  const auto bins =
      static_cast<std::size_t>(std::clamp(std::ceil(length / tube_.radius()), 1.0, static_cast<double>(most_bins)));
  bin_ = length / static_cast<double>(bins);
  covered_.assign(bins, 0);
  Configuration centre(space.dimension());
  for (std::size_t i = 0; i < bins; ++i) {
    tube_.point((static_cast<double>(i) + 0.5) * bin_, centre);
    centres_.push(centre);
    if (reached != nullptr && reached->size() > 0) {
      const double reach = tube_.radius() + 0.5 * bin_;
      if (reached->nearest(centre).squared_distance <= reach * reach) covered_[i] = 1;
    }
  }
  uncovered_ = static_cast<std::size_t>(std::count(covered_.begin(), covered_.end(), 0));
  choose_stretches();
}

Guidance::Source PathHeuristic::sample(Stream& stream, MutableView out) {
  tube_.sample(stream, out);
  return 0;
}

void PathHeuristic::observe(const Outcome& outcome, bool mine) {
  if (!outcome.added.empty() && cover(outcome.added)) {
    failures_ = 0;
    choose_stretches();
  } else if (mine) {
    // Once the whole path is reached there is no progress left to make along it; it may still serve.
    const std::int64_t patience = uncovered_ > 0 ? patience_ : patience_when_covered * patience_;
    if (++failures_ >= patience) stale_ = true;
  }
}

bool PathHeuristic::cover(View q) {
  const double reach = tube_.radius() + 0.5 * bin_;
  bool fresh = false;
  for (std::size_t i = 0; i < covered_.size(); ++i) {
    if (covered_[i] == 0 && space_.squared_distance(std::as_const(centres_)[i], q) <= reach * reach) {
      covered_[i] = 1;
      --uncovered_;
      fresh = true;
    }
  }
  return fresh;
}

void PathHeuristic::choose_stretches() {
  // Uncovered bins within `window` of a covered one or of an end of the path that the planner starts from.
  const std::size_t n = covered_.size();
  const auto ahead = static_cast<std::size_t>(std::max(1.0, std::round(window_ * static_cast<double>(n))));
  std::vector<char> active(n, 0);
  bool any_covered = false;
  for (std::size_t i = 0; i < n; ++i) {
    if (covered_[i] == 0) continue;
    any_covered = true;
    for (std::size_t k = i >= ahead ? i - ahead : 0; k <= std::min(n - 1, i + ahead); ++k) active[k] = 1;
  }
  if (!any_covered) std::fill_n(active.begin(), std::min(ahead, n), 1);
  std::vector<std::pair<double, double>> stretches;
  for (std::size_t i = 0; i < n; ++i) {
    if (active[i] == 0 || covered_[i] != 0) continue;
    const double from = static_cast<double>(i) * bin_;
    const double to = i + 1 == n ? tube_.length() : from + bin_;
    if (!stretches.empty() && stretches.back().second == from) {
      stretches.back().second = to;
    } else {
      stretches.emplace_back(from, to);
    }
  }
  // Everything reached: the whole path again.
  if (stretches.empty()) stretches.emplace_back(0.0, tube_.length());
  tube_.activate(std::move(stretches));
  ++epoch_;
}

std::unique_ptr<Instance> PathGuide::same_instance(const Instance& parent) {
  auto instance = std::make_unique<Instance>(parent);
  instance->checks = {};
  // An explicit graph is a way of searching the parent's space, not part of what is projected.
  instance->graph = nullptr;
  return instance;
}

void PathGuide::learn(const Outcome& outcome) {
  if (!outcome.added.empty() && reached_) reached_->add(outcome.added);
}

std::unique_ptr<Heuristic> PathGuide::heuristic(Instance& parent, const Instance*, const Solution* found) {
  if (!reached_) {
    reached_.emplace(parent.space);
    reached_->add(parent.start);
  }
  current_ = nullptr;
  if (found->path.size() < 2) return std::make_unique<UniformHeuristic>(name_ + " (found nothing)", parent.space);
  auto h = std::make_unique<PathHeuristic>(name_, parent.space, found->path, tube_radius(path_settings_, parent),
                                           path_settings_.window, path_settings_.patience, &*reached_);
  current_ = h.get();
  return h;
}

}  // namespace trellis
