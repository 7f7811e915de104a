// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/principal_axes.hpp>
#include <trellis/instance/search_cost.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

struct PcaSettings : PathGuideSettings {
  std::int64_t dimensions = 0;
  std::int64_t samples = 200;
  std::string db;
  bool ends = true;
};

const Settings<PcaSettings>& pca_settings() {
  static const Settings<PcaSettings> settings = with_path_options(
      Settings<PcaSettings>(
          Component::Kind::guide, "pca",
          "a flat subspace of few dimensions, fitted by principal components to valid configurations or to paths",
          "Mahoney, Bross and Johnson 2010, Deformable robot motion planning in a reduced-dimension "
          "configuration space")
          .integer("dimensions", &PcaSettings::dimensions, "axes", Range::non_negative(),
                   "dimension of S, less than that of C; 0: half of C's, rounded up")
          .integer(
              "samples", &PcaSettings::samples, "configurations", Range::at_least(1),
              "configurations that the subspace is fitted to: valid ones out of uniform ones, which are checked as "
              "checks of its level; or with `db` points spread over stored paths")
          .file("db", &PcaSettings::db,
                "a library of solved problems, as trellis run SCRIPT --learn makes it: the subspace is fitted to its "
                "paths of the same space and robot, and nothing is checked for it")
          .boolean("ends", &PcaSettings::ends,
                   "the subspace goes through start and goal, and the direction between them is its first; of several "
                   "goals, through the nearest ones, as many as it has dimensions; otherwise it goes where the samples "
                   "say, and start and goal are projected onto it")
          .positional({"dimensions"}));
  return settings;
}

/// Maximum number of uniform configurations checked per required valid one.
constexpr std::int64_t tries_per_sample = 50;

/// C as the tangent vectors at the start: a box of metric coordinates, in which circles are cut opposite to the start,
/// times a ball of rotation vectors for each rotation, cut at half turns. It is convex.
class Chart {
 public:
  Chart(Space space, View start) : space_(std::move(space)), start_(start.begin(), start.end()) {
    for (const Factor& factor : space_.factors()) {
      const Axis& axis = factor.axis;
      switch (factor.kind) {
        case Factor::Kind::line:
          lo_.push_back(axis.weight * (axis.lo - start_[factor.column]));
          hi_.push_back(axis.weight * (axis.hi - start_[factor.column]));
          break;
        case Factor::Kind::circle:
          lo_.push_back(axis.weight * (-0.5 * axis.period()));
          hi_.push_back(axis.weight * (0.5 * axis.period()));
          break;
        case Factor::Kind::rotation: {
          const double half_turn = axis.weight * std::numbers::pi;
          turns_.push_back({lo_.size(), half_turn});
          lo_.insert(lo_.end(), 3, -half_turn);
          hi_.insert(hi_.end(), 3, half_turn);
          break;
        }
      }
    }
  }
  void to(View q, std::vector<double>& y) const {
    y.resize(lo_.size());
    space_.log(start_, q, y);
  }
  void from(const std::vector<double>& y, MutableView q) const {
    space_.exp(start_, y, q);
    for (const Factor& factor : space_.factors()) {
      // Rounding must not leave the range of a bounded axis.
      if (factor.kind == Factor::Kind::line) {
        q[factor.column] = std::clamp(q[factor.column], factor.axis.lo, factor.axis.hi);
      }
    }
  }
  [[nodiscard]] bool contains(const std::vector<double>& y) const {
    for (std::size_t j = 0; j < y.size(); ++j) {
      const double slack = 1e-9 * (hi_[j] - lo_[j]);
      if (y[j] < lo_[j] - slack || y[j] > hi_[j] + slack) return false;
    }
    return std::all_of(turns_.begin(), turns_.end(),
                       [&](const Turn& turn) { return turn.angle(y) <= turn.half_turn * (1.0 + 1e-9); });
  }
  void clamp(std::vector<double>& y) const {
    for (std::size_t j = 0; j < y.size(); ++j) y[j] = std::clamp(y[j], lo_[j], hi_[j]);
    for (const Turn& turn : turns_) {
      const double angle = turn.angle(y);
      if (angle <= turn.half_turn) continue;
      for (std::size_t j = turn.column; j < turn.column + 3; ++j) y[j] *= turn.half_turn / angle;
    }
  }
  /// The distance from y, inside the chart, to its boundary along a direction.
  [[nodiscard]] double room(const std::vector<double>& y, const std::vector<double>& direction) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < y.size(); ++j) {
      if (direction[j] > 0.0) least = std::min(least, (hi_[j] - y[j]) / direction[j]);
      if (direction[j] < 0.0) least = std::min(least, (lo_[j] - y[j]) / direction[j]);
    }
    for (const Turn& turn : turns_) least = std::min(least, turn.room(y, direction));
    return std::max(0.0, least);
  }
  [[nodiscard]] double log_jacobian(const std::vector<double>& y) const { return space_.log_jacobian(y); }
  [[nodiscard]] std::size_t dimension() const { return lo_.size(); }
  [[nodiscard]] const Space& space() const { return space_; }

 private:
  /// The rotation vectors of a rotation, in metres of the metric.
  struct Turn {
    std::size_t column;  ///< of the first of its three numbers
    double half_turn;    ///< metres

    [[nodiscard]] double angle(const std::vector<double>& y) const {
      return std::hypot(y[column], y[column + 1], y[column + 2]);
    }
    [[nodiscard]] double room(const std::vector<double>& y, const std::vector<double>& direction) const {
      double square = 0.0, along = 0.0, inside = half_turn * half_turn;
      for (std::size_t j = column; j < column + 3; ++j) {
        square += direction[j] * direction[j];
        along += y[j] * direction[j];
        inside -= y[j] * y[j];
      }
      if (!(square > 0.0)) return std::numeric_limits<double>::infinity();
      inside = std::max(0.0, inside);
      const double root = std::sqrt(along * along + square * inside);
      return along > 0.0 ? inside / (along + root) : (root - along) / square;
    }
  };

  Space space_;
  Configuration start_;
  std::vector<double> lo_;
  std::vector<double> hi_;
  std::vector<Turn> turns_;
};

/// The subspace: an origin in the chart and orthonormal directions, the first `k` of which span it.
class Flat {
 public:
  Flat(Chart chart, std::vector<double> origin, std::vector<std::vector<double>> axes, std::size_t k)
      : chart_(std::move(chart)), origin_(std::move(origin)), axes_(std::move(axes)), k_(k) {}

  /// f: the orthogonal projection, in coordinates along the first `k` directions.
  void project(View q, MutableView s) const {
    std::vector<double> y;
    chart_.to(q, y);
    coefficients(y, s);
  }
  void coefficients(const std::vector<double>& y, MutableView s) const {
    for (std::size_t i = 0; i < k_; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j < y.size(); ++j) sum += axes_[i][j] * (y[j] - origin_[j]);
      s[i] = sum;
    }
  }
  /// The point of the subspace at s, in the chart.
  [[nodiscard]] std::vector<double> point(View s) const {
    std::vector<double> y = origin_;
    for (std::size_t i = 0; i < k_; ++i) {
      for (std::size_t j = 0; j < y.size(); ++j) y[j] += s[i] * axes_[i][j];
    }
    return y;
  }
  /// The configuration at s. If the point lies outside of C, sets q to the nearest configuration and returns false.
  bool at(View s, MutableView q) const {
    std::vector<double> y = point(s);
    const bool inside = chart_.contains(y);
    chart_.clamp(y);
    chart_.from(y, q);
    return inside;
  }
  /// Draws a configuration that projects to s: on a line through the point of the subspace in a uniform direction
  /// orthogonal to it, up to the bounds of C or less. If one dimension is left, it is uniform on the fibre. If the
  /// point lies outside of C, the nearest configuration.
  void lift(View s, Stream& stream, MutableView q) const {
    std::vector<double> y = point(s);
    const std::size_t m = axes_.size() - k_;
    if (!chart_.contains(y)) {
      chart_.clamp(y);
      chart_.from(y, q);
      return;
    }
    std::vector<double> direction(y.size(), 0.0);
    double squares = 0.0;
    for (std::size_t i = k_; i < axes_.size(); ++i) {
      const double weight = stream.normal();
      squares += weight * weight;
      for (std::size_t j = 0; j < y.size(); ++j) direction[j] += weight * axes_[i][j];
    }
    for (double& d : direction) d /= std::sqrt(squares);
    const auto power = static_cast<double>(m);
    double room = chart_.room(y, direction);
    const double there = std::pow(room, power);
    const double back = std::pow(room_behind(y, direction), power);
    if (stream.uniform() * (there + back) >= there) {
      for (double& d : direction) d = -d;
      room = std::pow(back, 1.0 / power);
    }
    const double r = room * std::pow(stream.uniform(), 1.0 / power);
    for (std::size_t j = 0; j < y.size(); ++j) y[j] += r * direction[j];
    chart_.from(y, q);
  }
  /// log of the density of `lift` at q on the fibre of f(q).
  [[nodiscard]] double log_fibre_density(View q) const {
    const std::size_t m = axes_.size() - k_;
    std::vector<double> y;
    chart_.to(q, y);
    const double jacobian = chart_.log_jacobian(y);
    std::vector<double> s(k_);
    coefficients(y, s);
    const std::vector<double> foot = point(s);
    if (!chart_.contains(foot)) return -std::numeric_limits<double>::infinity();
    double squares = 0.0;
    for (std::size_t j = 0; j < y.size(); ++j) {
      y[j] -= foot[j];
      squares += y[j] * y[j];
    }
    if (!(squares > 0.0)) {
      // At the subspace itself, any direction applies.
      y = axes_[k_];
      squares = 1.0;
    }
    for (double& d : y) d /= std::sqrt(squares);
    const auto power = static_cast<double>(m);
    const double both = std::pow(chart_.room(foot, y), power) + std::pow(room_behind(foot, y), power);
    return -(log_unit_ball(m) + std::log(0.5 * both)) - jacobian;
  }

  /// Whether the straight motion in S differs from the shortest motion of C between its ends: in a flat space where it
  /// goes round a circle; with rotations where their middles are more than `tolerance` metres apart.
  [[nodiscard]] bool bent(View a, View b, double tolerance) const {
    const std::vector<double> from = point(a);
    const std::vector<double> to = point(b);
    const Space& space = parent();
    if (space.flat()) {
      const auto& axes = space.axes();
      for (std::size_t j = 0; j < axes.size(); ++j) {
        if (axes[j].periodic && std::abs(to[j] - from[j]) > 0.49 * axes[j].weight * axes[j].period()) return true;
      }
      return false;
    }
    Configuration start(space.dimension()), end(space.dimension()), middle(space.dimension()), here(space.dimension());
    chart_.from(from, start);
    chart_.from(to, end);
    std::vector<double> half(from.size());
    for (std::size_t j = 0; j < half.size(); ++j) half[j] = 0.5 * (from[j] + to[j]);
    chart_.from(half, here);
    space.interpolate(start, end, 0.5, middle);
    return space.distance(middle, here) > tolerance;
  }

  [[nodiscard]] const Space& parent() const { return chart_.space(); }

 private:
  [[nodiscard]] double room_behind(const std::vector<double>& y, std::vector<double> direction) const {
    for (double& d : direction) d = -d;
    return chart_.room(y, direction);
  }

  Chart chart_;
  std::vector<double> origin_;
  std::vector<std::vector<double>> axes_;
  std::size_t k_;
};

/// Validity in S: that of the configuration on the subspace, in C. Points of the subspace outside of C are invalid.
class FlatValidity final : public Validity {
 public:
  /// \param c  validity in C
  /// \param tolerance  metres between a motion of S and the motions of C that replace it
  FlatValidity(std::shared_ptr<const Flat> flat, std::shared_ptr<Validity> c, double tolerance)
      : flat_(std::move(flat)),
        c_(std::move(c)),
        tolerance_(tolerance),
        a_(flat_->parent().dimension()),
        b_(a_.size()) {}

  [[nodiscard]] bool state(View s) override { return flat_->at(s, b_) && c_->state(b_); }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    if (!flat_->at(b, b_)) return {false, 1, 1.0};
    flat_->at(a, a_);
    if (!flat_->bent(a, b, tolerance_)) return c_->motion(a_, b_);
    // C would connect the ends by another motion. Halves are nearer to those of C.
    Configuration middle(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) middle[i] = 0.5 * (a[i] + b[i]);
    MotionReport first = motion(a, middle);
    if (!first.valid) {
      first.invalid_at *= 0.5;
      return first;
    }
    MotionReport second = motion(middle, b);
    second.checks += first.checks;
    if (!second.valid) second.invalid_at = 0.5 + 0.5 * second.invalid_at;
    return second;
  }
  [[nodiscard]] const CheckCost& cost() const override { return c_->cost(); }
  [[nodiscard]] double clearance(View s) override { return flat_->at(s, b_) ? c_->clearance(b_) : 0.0; }
  [[nodiscard]] std::optional<Contact> contact(View s) override {
    return flat_->at(s, b_) ? c_->contact(b_) : std::nullopt;
  }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View s) override {
    if (!flat_->at(s, b_)) throw Error("the configuration lies outside of C, so it has no nearest obstacle");
    return c_->nearest_obstacle(b_);
  }

 private:
  std::shared_ptr<const Flat> flat_;
  std::shared_ptr<Validity> c_;
  double tolerance_;
  Configuration a_;
  Configuration b_;
};

class Pca final : public PathGuide {
 public:
  explicit Pca(const PcaSettings& settings) : PathGuide("pca", settings), settings_(settings) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    const Space& space = parent.space;
    const std::size_t d = space.degrees();
    const auto k = settings_.dimensions > 0 ? static_cast<std::size_t>(settings_.dimensions) : (d + 1) / 2;
    if (k >= d) {
      throw Error(fmt::format("pca: S must have fewer dimensions than {}, which has {}; got {}", space.name(), d, k));
    }
    // Collision checks, even if the parent presumes validity.
    Instance checked = parent;
    checked.validity = parent.validity_in(parent.scene);
    checked.checks = {};
    Chart chart(space, parent.start);
    std::vector<double> points = settings_.db.empty() ? samples(chart, checked) : stored(chart, *parent.scene);
    std::vector<double> start;
    chart.to(parent.start, start);
    std::vector<std::vector<double>> goals;
    for (const Configuration& goal : sorted_goals(parent)) chart.to(goal, goals.emplace_back());
    std::vector<double> origin = start;
    if (!settings_.ends) {
      origin.assign(d, 0.0);
      const std::size_t rows = points.size() / d;
      const auto count = static_cast<double>(rows);
      for (std::size_t i = 0; i < points.size(); ++i) origin[i % d] += points[i] / count;
      for (std::size_t i = 0; i < points.size(); ++i) points[i] -= origin[i % d];
    }
    // The nearest goals first: of more than S has dimensions, the others lie beside it.
    const auto directions = settings_.ends ? goals : std::vector<std::vector<double>>{};
    flat_ = std::make_shared<const Flat>(chart, origin, principal_axes(points, directions, d), k);

    // The bounds of S contain the projections of the samples, the start and the goals, with a margin.
    std::vector<double> lo(k, std::numeric_limits<double>::infinity());
    std::vector<double> hi(k, -std::numeric_limits<double>::infinity());
    std::vector<double> s(k);
    const auto hold = [&](const std::vector<double>& y) {
      flat_->coefficients(y, s);
      for (std::size_t i = 0; i < k; ++i) {
        lo[i] = std::min(lo[i], s[i]);
        hi[i] = std::max(hi[i], s[i]);
      }
    };
    hold(start);
    for (const std::vector<double>& goal : goals) hold(goal);
    std::vector<double> y(d);
    for (std::size_t i = 0; i + d <= points.size(); i += d) {
      for (std::size_t j = 0; j < d; ++j) y[j] = points[i + j] + (settings_.ends ? 0.0 : origin[j]);
      hold(y);
    }
    std::vector<Axis> axes;
    axes.reserve(k);
    for (std::size_t i = 0; i < k; ++i) {
      const double margin = 0.05 * (hi[i] - lo[i]) + 1e-6 * space.diameter();
      axes.push_back({fmt::format("c{}", i + 1), lo[i] - margin, hi[i] + margin, 1.0, false});
    }
    auto instance = std::make_unique<Instance>();
    instance->space = Space(fmt::format("R^{} of {}", k, space.name()), std::move(axes));
    instance->scene = parent.scene;
    instance->validity = std::make_shared<FlatValidity>(flat_, checked.validity, parent.resolution);
    instance->validity_of = [flat = flat_, c = parent](const std::shared_ptr<const Scene>& scene) {
      return std::make_shared<FlatValidity>(flat, c.validity_in(scene), c.resolution);
    };
    project_ends(*flat_, parent, *instance);
    instance->goal_tolerance = parent.goal_tolerance;
    instance->resolution = parent.resolution;
    instance->collision = parent.collision;
    instance->checks = checked.checks;
    return instance;
  }

  void project(View q, MutableView s) const override { flat_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { flat_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View q) const override { return flat_->log_fibre_density(q); }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    Solution lifted{found->status, Configurations(parent.space.dimension()), {}};
    Configuration q(parent.space.dimension());
    for (std::size_t i = 0; i < found->path.size(); ++i) {
      // With rotations straight motions of S are no shortest motions of C: the path has their points as well.
      if (i > 0 && !parent.space.flat())
        push_between(found->path[i - 1], found->path[i], parent.resolution, lifted.path);
      flat_->at(found->path[i], q);
      lifted.path.push(q);
    }
    return PathGuide::heuristic(parent, sub, &lifted);
  }

 protected:
  /// The paths lie in C on the subspace and are valid there.
  [[nodiscard]] bool relaxes() const override { return false; }

 private:
  /// Appends the configurations strictly between those at a and b whose shortest motions replace the straight one of S.
  void push_between(View a, View b, double tolerance, Configurations& path) const {
    if (!flat_->bent(a, b, tolerance)) return;
    Configuration middle(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) middle[i] = 0.5 * (a[i] + b[i]);
    push_between(a, middle, tolerance, path);
    Configuration q(path.dimension());
    flat_->at(middle, q);
    path.push(q);
    push_between(middle, b, tolerance, path);
  }

  /// The goals of an instance in the order of sort_goals.
  [[nodiscard]] static std::vector<Configuration> sorted_goals(const Instance& instance) {
    Instance sorted;
    sorted.space = instance.space;
    sorted.start = instance.start;
    sorted.goals = instance.goals;
    sort_goals(sorted);
    return sorted.goals;
  }

  /// Valid configurations in the chart, sampled uniformly; the same in every run, because f of an instance is
  /// deterministic.
  [[nodiscard]] std::vector<double> samples(const Chart& chart, Instance& checked) const {
    const Space& space = chart.space();
    Stream stream(0, "pca", "samples");
    std::vector<double> points;
    points.reserve(static_cast<std::size_t>(settings_.samples) * chart.dimension());
    Configuration q(space.dimension());
    std::vector<double> y;
    std::int64_t found = 0;
    for (std::int64_t i = 0; i < settings_.samples * tries_per_sample && found < settings_.samples; ++i) {
      space.sample_uniform(stream, q);
      checked.spend(search_cost::coordinate * static_cast<double>(q.size()));
      if (!checked.valid(q)) continue;
      chart.to(q, y);
      points.insert(points.end(), y.begin(), y.end());
      ++found;
    }
    if (found == 0) {
      throw Error(
          fmt::format("pca: none of {} checked configurations of {} is valid, so that there is "
                      "nothing to fit a subspace to",
                      settings_.samples * tries_per_sample, space.name()));
    }
    return points;
  }

  /// Points in the chart, evenly spaced along each matching stored path; every path contributes the same number.
  [[nodiscard]] std::vector<double> stored(const Chart& chart, const Scene& scene) const {
    const Space& space = chart.space();
    const auto library = known_paths(settings_.db);
    std::vector<const Configurations*> fitting;
    for (const StoredPath& known : *library) {
      if (known.space == identity(space) && known.robot == robot_hash(scene)) fitting.push_back(&known.path);
    }
    if (fitting.empty()) {
      throw Error(
          fmt::format("pca: the library '{}' has {} paths, and none of this robot in {}; paths that are found "
                      "are added to it by: trellis run SCRIPT --learn {}",
                      settings_.db, library->size(), space.name(), settings_.db));
    }
    const auto wanted = static_cast<std::size_t>(settings_.samples);
    const std::size_t each = std::max<std::size_t>(2, (wanted + fitting.size() - 1) / fitting.size());
    std::vector<double> points;
    points.reserve(each * fitting.size() * chart.dimension());
    std::vector<double> y;
    for (const Configurations* path : fitting) {
      const Configurations spread = evenly_spread(space, *path, each);
      for (std::size_t i = 0; i < spread.size(); ++i) {
        chart.to(spread[i], y);
        points.insert(points.end(), y.begin(), y.end());
      }
    }
    return points;
  }

  PcaSettings settings_;
  std::shared_ptr<const Flat> flat_;
};

}  // namespace

GuideKind pca_kind() {
  GuideClaims claims = path_claims(
      GuideClaims::Category::robot,
      "q -> its orthogonal projection onto the subspace, in coordinates along it; periodic axes are cut open opposite "
      "to the start, and rotations are their rotation vectors from it; valid in S is what is valid in C on the "
      "subspace itself",
      "S has no path; with `ends` start and goal lie on the subspace, so that they are as valid in S as in C",
      "examples/pca.lua");
  claims.h =
      "a point of the path found on the subspace, which is one of C, from the stretch just beyond what the tree has "
      "reached, then uniform on a ball about it in C; or the path's points in turn";
  claims.relaxes = false;
  return GuideKind{
      &pca_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Pca>(pca_settings().read(o)); },
      "rrt_connect", [](const Options& o) { return pca_settings().read(o).resolves; }, std::move(claims)}
      .set_up({.run = {350, 1}}, {.run = {650}});
}

}  // namespace trellis
