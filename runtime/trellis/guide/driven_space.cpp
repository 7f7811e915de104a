// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/driven_space.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/tail_validity.hpp>
#include <trellis/guide/team.hpp>

namespace trellis {

/// Where a configuration of the space places its robots.
class DrivenSpace::Placement {
 public:
  Placement(const Instance& team, std::vector<DrivenPath> along, std::vector<std::size_t> robots,
            const std::string& name)
      : along_(std::move(along)), robots_(std::move(robots)), start_(team.start), team_(team.space) {
    const TeamModel& model = *team_model(*team.motion_model);
    model_holder_ = team.motion_model;
    controls_ = model.controls().size();
    dt_ = model.dt();
    const std::vector<TeamMember> members = team.scene->members();
    all_ = robots_;
    for (const DrivenPath& path : along_) all_.insert(all_.end(), path.robots.begin(), path.robots.end());
    std::sort(all_.begin(), all_.end());
    placed_ = axes_of(members, all_);
    // The state of those that follow no motion: all configurations, then all velocities.
    own_ = axes_of(members, robots_);
    std::vector<std::shared_ptr<const MotionModel>> models;
    std::vector<std::vector<std::size_t>> axes;
    std::size_t first = along_.size();
    std::vector<Axis> clocks;
    constexpr double share = 0.04;  // of the diameter of the other coordinates: to be near means to be near in these
    double widest = 1.0;
    for (const std::size_t r : robots_) {
      const TeamModel::Part& part = model.parts()[r];
      for (std::size_t j = members[r].axes.size(); j < part.columns.size(); ++j) own_.push_back(part.columns[j]);
    }
    const Space own = team.space.part(own_, name);
    if (!robots_.empty()) widest = share * own.diameter();
    for (std::size_t g = 0; g < along_.size(); ++g) {
      const double duration = dt_ * static_cast<double>(along_[g].steps());
      models.push_back(std::make_shared<const PathClock>(duration, dt_));
      axes.push_back({g});
      const std::string number = along_.size() == 1 ? "" : std::to_string(g + 1);
      const double length = duration + 0.5 * dt_;
      clocks.push_back({"along" + number, 0.0, length, std::min(1.0, widest / length), false});
    }
    for (const std::size_t r : robots_) {
      models.push_back(model.parts()[r].model);
      std::vector<std::size_t> columns(members[r].axes.size());
      std::iota(columns.begin(), columns.end(), first);
      first += columns.size();
      axes.push_back(std::move(columns));
    }
    motion_ = models.size() == 1 ? models.front() : std::make_shared<const TeamModel>(models, axes);
    if (clocks.empty()) {
      space_ = own;
    } else {
      const Space product = Space::product({{1.0, Space(name, std::move(clocks))}, {1.0, own}});
      std::vector<std::size_t> columns(product.dimension());
      std::iota(columns.begin(), columns.end(), std::size_t{0});
      space_ = product.part(columns, name);
    }
  }

  [[nodiscard]] const std::vector<DrivenPath>& along() const { return along_; }
  [[nodiscard]] const std::vector<std::size_t>& robots() const { return robots_; }
  /// The robots that it places, ascending.
  [[nodiscard]] const std::vector<std::size_t>& all() const { return all_; }
  /// The coordinates of their configurations among those of the team, ascending.
  [[nodiscard]] const std::vector<std::size_t>& placed() const { return placed_; }
  /// The coordinates of the team that are those of S after the clocks.
  [[nodiscard]] const std::vector<std::size_t>& own() const { return own_; }
  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const Space& team() const { return team_; }
  [[nodiscard]] const std::shared_ptr<const MotionModel>& motion() const { return motion_; }
  [[nodiscard]] double dt() const { return dt_; }
  [[nodiscard]] std::size_t controls() const { return controls_; }

  /// The number of steps that robots along a motion have taken.
  [[nodiscard]] std::size_t step_of(std::size_t g, double seconds) const {
    const double step = std::round(seconds / dt_);
    return static_cast<std::size_t>(std::clamp(step, 0.0, static_cast<double>(along_[g].steps())));
  }
  /// Writes the states of robots along a motion after so many steps into a state of the team.
  void overlay(std::size_t g, std::size_t step, MutableView q) const {
    const View there = along_[g].states[step];
    for (const std::size_t r : along_[g].robots) {
      for (const std::size_t column : team_model(*model_holder_)->parts()[r].columns) q[column] = there[column];
    }
  }
  /// Writes a state of the team.
  /// \param steps  of each motion
  void place(const std::vector<std::size_t>& steps, View own, MutableView q) const {
    std::copy(start_.begin(), start_.end(), q.begin());
    for (std::size_t g = 0; g < along_.size(); ++g) overlay(g, steps[g], q);
    for (std::size_t j = 0; j < own_.size(); ++j) q[own_[j]] = own[j];
  }
  void place(View s, MutableView q) const {
    std::vector<std::size_t> steps(along_.size());
    for (std::size_t g = 0; g < steps.size(); ++g) steps[g] = step_of(g, s[g]);
    place(steps, s.subspan(along_.size()), q);
  }
  /// Calls `f(steps, own)` for the states of a motion of S after each step, in turn, until it returns false; its first
  /// argument is how far it is, from 0 to 1.
  /// \return false where robots would go back
  template <class F>
  bool each_step(View a, View b, const F& f) const {
    std::vector<std::size_t> from(along_.size()), to(along_.size());
    std::size_t most = 1;
    for (std::size_t g = 0; g < along_.size(); ++g) {
      from[g] = step_of(g, a[g]);
      to[g] = step_of(g, b[g]);
      if (to[g] < from[g]) return false;
      most = std::max(most, to[g] - from[g]);
    }
    Configuration s(space_.dimension());
    for (std::size_t k = 1; k <= most; ++k) {
      std::vector<std::size_t> steps(along_.size());
      for (std::size_t g = 0; g < steps.size(); ++g) steps[g] = std::min(from[g] + k, to[g]);
      const double share = static_cast<double>(k) / static_cast<double>(most);
      space_.interpolate(a, b, share, s);
      if (!f(share, steps, View(s).subspan(along_.size()))) break;
    }
    return true;
  }
  /// The controls of the team in one step.
  /// \param before, after  steps of each motion
  /// \param u  of S; empty: the robots of S that follow no motion wait
  void control(const std::vector<std::size_t>& before, const std::vector<std::size_t>& after, View u,
               MutableView out) const {
    const TeamModel& model = *team_model(*model_holder_);
    std::fill(out.begin(), out.end(), 0.0);
    for (std::size_t g = 0; g < along_.size(); ++g) {
      if (after[g] == before[g]) continue;
      const View whole = along_[g].controls[before[g]];
      for (const std::size_t r : along_[g].robots) {
        const TeamModel::Part& part = model.parts()[r];
        const View own = part.own(whole);
        std::copy(own.begin(), own.end(), out.begin() + static_cast<std::ptrdiff_t>(part.control));
      }
    }
    if (u.empty()) return;
    std::size_t at = along_.size();
    for (const std::size_t r : robots_) {
      const TeamModel::Part& part = model.parts()[r];
      const View own = u.subspan(at, part.model->controls().size());
      std::copy(own.begin(), own.end(), out.begin() + static_cast<std::ptrdiff_t>(part.control));
      at += own.size();
    }
  }

 private:
  std::vector<DrivenPath> along_;
  std::vector<std::size_t> robots_;
  Configuration start_;  ///< of the team
  Space team_;
  std::shared_ptr<const MotionModel> model_holder_;  ///< of the team
  std::vector<std::size_t> all_;
  std::vector<std::size_t> placed_;
  std::vector<std::size_t> own_;
  std::shared_ptr<const MotionModel> motion_;
  Space space_;
  double dt_ = 0.0;
  std::size_t controls_ = 0;
};

namespace {

/// Validity of what a configuration of S places, and of the motions between: those of the steps.
/// \tparam P  DrivenSpace::Placement
template <class P>
class DrivenValidity final : public Validity {
 public:
  DrivenValidity(std::shared_ptr<const P> placement, std::shared_ptr<Validity> placed)
      : placement_(std::move(placement)),
        placed_(std::move(placed)),
        whole_(placement_->team().dimension()),
        from_(placement_->placed().size()),
        to_(placement_->placed().size()) {}

  [[nodiscard]] bool state(View s) override {
    if (!keeps_limits(s)) return false;
    placement_->place(s, whole_);
    pick(from_);
    return placed_->state(from_);
  }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    MotionReport all{true, 0, std::numeric_limits<double>::quiet_NaN()};
    if (!keeps_limits(b)) return {false, 1, 1.0};
    const bool forwards = each_piece(a, b, [&](double before, double after) {
      const MotionReport piece = placed_->motion(from_, to_);
      all.checks += piece.checks;
      if (piece.valid) return true;
      all.valid = false;
      all.invalid_at = before + piece.invalid_at * (after - before);
      return false;
    });
    return forwards ? all : MotionReport{false, 1, 1.0};
  }
  void certify(View a, View b, Certificate& certificate) override {
    if (!keeps_limits(b)) {
      certificate.refuted_at = 1.0;
      return;
    }
    const bool forwards = each_piece(a, b, [&](double before, double after) {
      placed_->certify(from_, to_, certificate);
      if (!certificate.refuted_at) return true;
      certificate.refuted_at = before + *certificate.refuted_at * (after - before);
      return false;
    });
    if (!forwards) certificate.refuted_at = 1.0;
  }
  [[nodiscard]] double clearance(View s) override { return placed_->clearance(at(s)); }
  [[nodiscard]] std::optional<Contact> contact(View s) override { return placed_->contact(at(s)); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View s) override { return placed_->nearest_obstacle(at(s)); }

 private:
  [[nodiscard]] bool keeps_limits(View s) const {
    return placement_->space().contains(s) && placement_->motion()->admits(s);
  }
  void pick(Configuration& out) const {
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = whole_[placement_->placed()[j]];
  }
  const Configuration& at(View s) {
    placement_->place(s, whole_);
    pick(from_);
    return from_;
  }
  /// Calls `f` with `from_` and `to_` at the ends of each step, until it returns false.
  template <class F>
  bool each_piece(View a, View b, const F& f) {
    at(a);
    double before = 0.0;
    return placement_->each_step(a, b, [&](double after, const std::vector<std::size_t>& steps, View own) {
      placement_->place(steps, own, whole_);
      pick(to_);
      if (!f(before, after)) return false;
      before = after;
      std::swap(from_, to_);
      return true;
    });
  }

  std::shared_ptr<const P> placement_;
  std::shared_ptr<Validity> placed_;
  Configuration whole_;
  Configuration from_;
  Configuration to_;
};

}  // namespace

DrivenSpace::DrivenSpace(const Instance& parent, std::vector<DrivenPath> along, std::vector<std::size_t> robots,
                         const std::string& name)
    : placement_(std::make_shared<const Placement>(parent, std::move(along), std::move(robots), name)) {}

std::unique_ptr<Instance> DrivenSpace::project(const Instance& parent) {
  const Placement& placement = *placement_;
  const std::vector<TeamMember> members = parent.scene->members();
  const bool all = placement.all().size() == members.size();
  const auto scene = all ? parent.scene : parent.scene->reduced(placement.placed());
  auto instance = std::make_unique<Instance>();
  instance->space = placement.space();
  instance->motion_model = placement.motion();
  instance->validity = std::make_shared<DrivenValidity<Placement>>(
      placement_, make_validity(parent.collision, scene, placement.team().part(placement.placed(), "robots"),
                                parent.resolution, nullptr));
  const std::size_t first = placement.along().size();
  instance->scene = scene;
  if (!placement.robots().empty()) {
    instance->scene = parent.scene->reduced(axes_of(members, placement.robots()));
    if (instance->scene->translates()) {
      instance->position_axes.resize(instance->scene->world_dimension());
      std::iota(instance->position_axes.begin(), instance->position_axes.end(), first);
    }
  }
  project_ends(*this, parent, *instance);
  // A motion may pass the places of its ends in between.
  for (std::size_t g = 0; g < first; ++g) {
    instance->start[g] = 0.0;
    for (Configuration& goal : instance->goals) {
      goal[g] = placement.dt() * static_cast<double>(placement.along()[g].steps());
    }
  }
  // The distances of all robots together are within the tolerance of the team where each one's is.
  instance->goal_tolerance = parent.goal_tolerance / std::sqrt(static_cast<double>(members.size()));
  instance->resolution = parent.resolution;
  instance->collision = parent.collision;
  if (first > 0) {
    // Another robot in the place of the one that is driven: among the obstacles, without those that follow motions.
    std::vector<std::size_t> columns(placement.own().size());
    std::iota(columns.begin(), columns.end(), first);
    const Space own = placement.space().part(columns, "robots");
    instance->validity_of = [own, first, collision = parent.collision,
                             resolution = parent.resolution](const std::shared_ptr<const Scene>& other) {
      return std::make_shared<TailValidity>(make_validity(collision, other, own, resolution, nullptr), first);
    };
  }
  return instance;
}

void DrivenSpace::project(View q, MutableView s) const {
  const Placement& placement = *placement_;
  for (std::size_t g = 0; g < placement.along().size(); ++g) {
    const DrivenPath& path = placement.along()[g];
    double least = std::numeric_limits<double>::infinity();
    s[g] = 0.0;
    Configuration there(q.begin(), q.end());
    for (std::size_t i = 0; i < path.states.size(); ++i) {
      placement.overlay(g, i, there);
      const double squared = placement.team().squared_distance(there, q);
      if (squared >= least) continue;
      least = squared;
      s[g] = placement.dt() * static_cast<double>(i);
    }
  }
  for (std::size_t j = 0; j < placement.own().size(); ++j) s[placement.along().size() + j] = q[placement.own()[j]];
}

void DrivenSpace::lift(View s, Stream& stream, MutableView q) const {
  const Placement& placement = *placement_;
  placement.team().sample_uniform(stream, q);
  for (std::size_t g = 0; g < placement.along().size(); ++g) placement.overlay(g, placement.step_of(g, s[g]), q);
  for (std::size_t j = 0; j < placement.own().size(); ++j) q[placement.own()[j]] = s[placement.along().size() + j];
}

double DrivenSpace::log_fibre_density(View q) const {
  return placement_->team().contains(q) ? placement_->space().log_volume() - placement_->team().log_volume()
                                        : -std::numeric_limits<double>::infinity();
}

bool DrivenSpace::closed_fibre() const { return placement_->along().empty(); }

std::unique_ptr<Heuristic> DrivenSpace::heuristic(Instance&, const Instance*, const Solution*) {
  throw Fault("the space of some robots guides by the path of the whole team");
}

std::size_t DrivenSpace::clocks() const { return placement_->along().size(); }

DrivenPath DrivenSpace::driven(const Solution& found) const {
  const Placement& placement = *placement_;
  DrivenPath motion{placement.all(), Configurations(placement.team().dimension()),
                    Configurations(placement.controls())};
  Configuration q(placement.team().dimension());
  Configuration u(placement.controls());
  // The control of each motion of the path.
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < found.trajectory.steps.size(); ++row) {
    rows.insert(rows.end(), found.trajectory.steps[row], row);
  }
  std::vector<std::size_t> steps(placement.along().size(), 0);
  placement.place(found.path[0], q);
  motion.states.push(q);
  for (std::size_t g = 0; g < steps.size(); ++g) steps[g] = placement.step_of(g, found.path[0][g]);
  for (std::size_t i = 1; i < found.path.size(); ++i) {
    const View own_control = rows.empty() ? View() : View(found.trajectory.controls[rows[i - 1]]);
    placement.each_step(found.path[i - 1], found.path[i], [&](double, const std::vector<std::size_t>& after, View own) {
      placement.place(after, own, q);
      placement.control(steps, after, own_control, u);
      motion.states.push(q);
      motion.controls.push(u);
      steps = after;
      return true;
    });
  }
  return motion;
}

}  // namespace trellis
