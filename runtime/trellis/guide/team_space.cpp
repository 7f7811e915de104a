// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/team_space.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/tail_validity.hpp>

namespace trellis {

RobotsPath::RobotsPath(const Space& team, std::vector<std::size_t> axes, Configurations path)
    : axes_(std::move(axes)), space_(AxisProjection(team, axes_, "robots").space()), path_(std::move(path)) {
  at_.push_back(0.0);
  for (std::size_t i = 1; i < path_.size(); ++i) {
    at_.push_back(at_.back() + space_.distance(std::as_const(path_)[i - 1], std::as_const(path_)[i]));
  }
}

void RobotsPath::at(double s, MutableView out) const {
  const auto next = std::upper_bound(at_.begin(), at_.end(), s);
  const auto i = static_cast<std::size_t>(next - at_.begin());
  if (i == 0 || i == at_.size()) {
    const View end = path_[i == 0 ? 0 : at_.size() - 1];
    std::copy(end.begin(), end.end(), out.begin());
    return;
  }
  space_.interpolate(path_[i - 1], path_[i], (s - at_[i - 1]) / (at_[i] - at_[i - 1]), out);
}

double RobotsPath::nearest(View q) const {
  double best = 0.0;
  double least = space_.squared_distance(path_[0], q);
  for (std::size_t i = 1; i < path_.size(); ++i) {
    const Foot foot = nearest_on_motion(space_, path_[i - 1], path_[i], q);
    if (foot.squared_distance >= least) continue;
    least = foot.squared_distance;
    best = at_[i - 1] + foot.t * (at_[i] - at_[i - 1]);
  }
  return best;
}

void RobotsPath::add_passed(double a, double b, std::vector<double>& parameters) const {
  if (a == b) return;
  const auto first = std::upper_bound(at_.begin(), at_.end(), std::min(a, b));
  for (auto it = first; it != at_.end() && *it < std::max(a, b); ++it) {
    const double t = (*it - a) / (b - a);
    if (t > 0.0 && t < 1.0) parameters.push_back(t);
  }
}

/// Where a configuration of the space places its robots.
class TeamSpace::Embedding {
 public:
  Embedding(const Space& team, std::vector<RobotsPath> along, const std::vector<std::size_t>& free)
      : along_(std::move(along)), axes_(free) {
    for (const RobotsPath& path : along_) axes_.insert(axes_.end(), path.axes().begin(), path.axes().end());
    std::sort(axes_.begin(), axes_.end());
    for (const RobotsPath& path : along_) columns_.push_back(places_of(path.axes()));
    free_ = places_of(free);
    placed_.emplace(team, axes_, "robots");
  }

  [[nodiscard]] const std::vector<RobotsPath>& along() const { return along_; }
  [[nodiscard]] const std::vector<std::size_t>& axes() const { return axes_; }
  /// Of each free axis, the place among `axes`.
  [[nodiscard]] const std::vector<std::size_t>& free() const { return free_; }
  /// Keeps the axes of the team that are placed.
  [[nodiscard]] const AxisProjection& placed() const { return *placed_; }

  void place(View s, MutableView q) const {
    Configuration part;
    for (std::size_t g = 0; g < along_.size(); ++g) {
      part.resize(columns_[g].size());
      along_[g].at(s[g], part);
      for (std::size_t j = 0; j < part.size(); ++j) q[columns_[g][j]] = part[j];
    }
    for (std::size_t j = 0; j < free_.size(); ++j) q[free_[j]] = s[along_.size() + j];
  }
  /// \param q  a configuration of `axes`
  void find(View q, MutableView s) const {
    Configuration part;
    for (std::size_t g = 0; g < along_.size(); ++g) {
      part.clear();
      for (const std::size_t column : columns_[g]) part.push_back(q[column]);
      s[g] = along_[g].nearest(part);
    }
    for (std::size_t j = 0; j < free_.size(); ++j) s[along_.size() + j] = q[free_[j]];
  }
  /// The parameters of a motion of the space at which its robots turn, with both ends, ascending.
  void turns(View a, View b, std::vector<double>& parameters) const {
    parameters.assign(1, 0.0);
    for (std::size_t g = 0; g < along_.size(); ++g) along_[g].add_passed(a[g], b[g], parameters);
    parameters.push_back(1.0);
    std::sort(parameters.begin(), parameters.end());
    parameters.erase(std::unique(parameters.begin(), parameters.end()), parameters.end());
  }

 private:
  [[nodiscard]] std::vector<std::size_t> places_of(const std::vector<std::size_t>& axes) const {
    std::vector<std::size_t> places;
    places.reserve(axes.size());
    for (const std::size_t axis : axes) {
      places.push_back(static_cast<std::size_t>(std::lower_bound(axes_.begin(), axes_.end(), axis) - axes_.begin()));
    }
    return places;
  }

  std::vector<RobotsPath> along_;
  std::vector<std::size_t> axes_;
  std::vector<std::vector<std::size_t>> columns_;  ///< of each path, where its axes are among `axes`
  std::vector<std::size_t> free_;
  std::optional<AxisProjection> placed_;
};

namespace {

/// Validity of what a configuration of S places.
/// \tparam E  TeamSpace::Embedding
template <class E>
class PlacedValidity final : public Validity {
 public:
  PlacedValidity(std::shared_ptr<const E> embedding, std::shared_ptr<Validity> placed, Space space)
      : embedding_(std::move(embedding)), placed_(std::move(placed)), space_(std::move(space)) {
    from_.resize(embedding_->axes().size());
    to_.resize(embedding_->axes().size());
    s_.resize(space_.dimension());
  }

  [[nodiscard]] bool state(View s) override { return space_.contains(s) && placed_->state(at(s)); }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    MotionReport whole{true, 0, std::numeric_limits<double>::quiet_NaN()};
    if (!space_.contains(b)) return {false, 1, 1.0};
    each_piece(a, b, [&](double from, double to) {
      const MotionReport piece = placed_->motion(from_, to_);
      whole.checks += piece.checks;
      if (piece.valid) return true;
      whole.valid = false;
      whole.invalid_at = from + piece.invalid_at * (to - from);
      return false;
    });
    return whole;
  }
  void certify(View a, View b, Certificate& certificate) override {
    each_piece(a, b, [&](double from, double to) {
      placed_->certify(from_, to_, certificate);
      if (!certificate.refuted_at) return true;
      certificate.refuted_at = from + *certificate.refuted_at * (to - from);
      return false;
    });
  }
  [[nodiscard]] double clearance(View s) override { return placed_->clearance(at(s)); }
  [[nodiscard]] bool spends_checks() const override { return placed_->spends_checks(); }
  [[nodiscard]] std::optional<Contact> contact(View s) override { return placed_->contact(at(s)); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View s) override { return placed_->nearest_obstacle(at(s)); }
  [[nodiscard]] std::uint64_t epoch() const override { return placed_->epoch(); }

 private:
  const Configuration& at(View s) {
    embedding_->place(s, from_);
    return from_;
  }
  /// Calls `f` for the straight pieces of what a motion places, with `from_` and `to_` at their ends, until it returns
  /// false.
  template <class F>
  void each_piece(View a, View b, const F& f) {
    embedding_->turns(a, b, turns_);
    embedding_->place(a, from_);
    for (std::size_t k = 1; k < turns_.size(); ++k) {
      space_.interpolate(a, b, turns_[k], s_);
      embedding_->place(s_, to_);
      if (!f(turns_[k - 1], turns_[k])) return;
      std::swap(from_, to_);
    }
  }

  std::shared_ptr<const E> embedding_;
  std::shared_ptr<Validity> placed_;
  Space space_;
  Configuration from_;
  Configuration to_;
  Configuration s_;
  std::vector<double> turns_;
};

Space space_of(const std::vector<RobotsPath>& along, const AxisProjection& placed, const std::vector<std::size_t>& free,
               const std::string& name) {
  if (along.empty()) {
    std::vector<std::size_t> all(placed.space().dimension());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return placed.space().part(all, name);
  }
  std::vector<Axis> axes;
  // The path of many robots is long: its axis counts at most as much as the coordinates of those that are free.
  const Space own = placed.space().part(free, name);
  const double widest = free.empty() ? std::numeric_limits<double>::infinity() : own.diameter();
  for (const RobotsPath& path : along) {
    // An axis needs a length; robots that stay where they are are there all along it.
    constexpr double least = 1e-6;
    const std::string number = along.size() == 1 ? "" : std::to_string(axes.size() + 1);
    const double length = std::max(path.length(), least);
    axes.push_back({"along" + number, 0.0, length, std::min(1.0, widest / length), false});
  }
  const Space product = Space::product({{1.0, Space(name, std::move(axes))}, {1.0, own}});
  std::vector<std::size_t> all(product.dimension());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return product.part(all, name);
}

}  // namespace

TeamSpace::TeamSpace(const Instance& parent, std::vector<RobotsPath> along, const std::vector<std::size_t>& free,
                     std::string name)
    : embedding_(std::make_shared<const Embedding>(parent.space, std::move(along), free)),
      space_(space_of(embedding_->along(), embedding_->placed(), embedding_->free(), name)),
      name_(std::move(name)) {}

std::unique_ptr<Instance> TeamSpace::project(const Instance& parent) {
  auto instance = std::make_unique<Instance>();
  instance->space = space_;
  const bool all = axes().size() == parent.space.dimension();
  const auto scene = all ? parent.scene : parent.scene->reduced(axes());
  if (!scene) throw Error(fmt::format("{}: these robots are placed by no coordinates of their own", name_));
  const auto validity =
      all ? parent.validity
          : make_validity(parent.collision, scene, embedding_->placed().space(), parent.resolution, nullptr);
  const bool follows = !embedding_->along().empty();
  instance->scene = scene;
  instance->validity = follows ? std::make_shared<PlacedValidity<Embedding>>(embedding_, validity, space_) : validity;
  if (follows && !embedding_->free().empty()) {
    // The robots that follow no path, alone: guides of this space see them and the world.
    std::vector<std::size_t> own;
    own.reserve(embedding_->free().size());
    for (const std::size_t column : embedding_->free()) own.push_back(axes()[column]);
    if (auto moving = parent.scene->reduced(own)) instance->scene = std::move(moving);
  }
  if (instance->scene->translates()) {
    instance->position_axes.resize(instance->scene->world_dimension());
    std::iota(instance->position_axes.begin(), instance->position_axes.end(), embedding_->along().size());
  }
  project_ends(*this, parent, *instance);
  // A path may pass the places of its ends in between.
  for (std::size_t g = 0; g < embedding_->along().size(); ++g) {
    instance->start[g] = 0.0;
    for (Configuration& goal : instance->goals) goal[g] = embedding_->along()[g].length();
  }
  instance->goal_tolerance = parent.goal_tolerance;
  instance->resolution = parent.resolution;
  instance->collision = parent.collision;
  if (follows) {
    // Another robot in the place of the one that moves: among the obstacles, without the robots that follow paths.
    std::vector<std::size_t> columns(embedding_->free().size());
    std::iota(columns.begin(), columns.end(), embedding_->along().size());
    const Space own = space_.part(columns, "robots");
    instance->validity_of = [own, first = embedding_->along().size(), collision = parent.collision,
                             resolution = parent.resolution](const std::shared_ptr<const Scene>& other) {
      return std::make_shared<TailValidity>(make_validity(collision, other, own, resolution, nullptr), first);
    };
  }
  return instance;
}

void TeamSpace::project(View q, MutableView s) const {
  if (embedding_->along().empty()) {
    embedding_->placed().project(q, s);
    return;
  }
  Configuration placed(axes().size());
  embedding_->placed().project(q, placed);
  embedding_->find(placed, s);
}

void TeamSpace::lift(View s, Stream& stream, MutableView q) const {
  Configuration placed(axes().size());
  embedding_->place(s, placed);
  embedding_->placed().lift(placed, stream, q);
}

double TeamSpace::log_fibre_density(View q) const { return embedding_->placed().log_fibre_density(q); }

bool TeamSpace::closed_fibre() const { return embedding_->along().empty(); }

std::unique_ptr<Heuristic> TeamSpace::heuristic(Instance&, const Instance*, const Solution*) {
  throw Fault("the space of some robots guides by the path of the whole team");
}

const std::vector<std::size_t>& TeamSpace::axes() const { return embedding_->axes(); }

const std::vector<RobotsPath>& TeamSpace::along() const { return embedding_->along(); }

Configurations TeamSpace::placed(const Configurations& path) const {
  Configurations all(axes().size());
  Configuration q(axes().size());
  Configuration s(space_.dimension());
  std::vector<double> turns;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i == 0) {
      embedding_->place(path[0], q);
      all.push(q);
      continue;
    }
    embedding_->turns(path[i - 1], path[i], turns);
    for (std::size_t k = 1; k < turns.size(); ++k) {
      space_.interpolate(path[i - 1], path[i], turns[k], s);
      embedding_->place(s, q);
      all.push(q);
    }
  }
  return all;
}

}  // namespace trellis
