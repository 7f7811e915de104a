// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/planar_checker.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/base/thread_scratch.hpp>
#include <trellis/collision/common.hpp>
#include <trellis/collision/orders.hpp>
#include <trellis/collision/planar/distance.hpp>
#include <trellis/collision/planar/part_index.hpp>
#include <trellis/collision/planar/segment.hpp>
#include <trellis/collision/planar/separation.hpp>
#include <trellis/scene/cache_by_world.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

using kernel::Box;
using kernel::Kind;
using kernel::Piece;

/// Convex shapes in the kernels' form, inflated by a slack so that rounding does not hide a contact.
class Pieces {
 public:
  void add(const ConvexShape& shape, double slack) {
    const Box2 box = bounding_box(shape);
    Piece piece;
    piece.x = 0.5 * (box.lo.x + box.hi.x);
    piece.y = 0.5 * (box.lo.y + box.hi.y);
    piece.hx = 0.5 * (box.hi.x - box.lo.x) + slack;
    piece.hy = 0.5 * (box.hi.y - box.lo.y) + slack;
    piece.xlo = box.lo.x - slack;
    piece.xhi = box.hi.x + slack;
    piece.ylo = box.lo.y - slack;
    piece.yhi = box.hi.y + slack;
    std::vector<kernel::Edge> edges;
    if (const auto* disc = std::get_if<Disc>(&shape)) {
      piece.kind = Kind::disc;
      piece.x = disc->centre.x;
      piece.y = disc->centre.y;
      piece.radius = disc->radius + slack;
    } else if (const auto& polygon = std::get<Polygon>(shape); is_box(polygon, box)) {
      piece.kind = Kind::rectangle;
    } else {
      piece.kind = Kind::polygon;
      edges = edges_of(polygon, slack);
      piece.edge_count = static_cast<unsigned>(edges.size());
    }
    edges_.push_back(std::move(edges));
    piece.edges = edges_.back().data();
    pieces_.push_back(piece);
  }

  void clear() {
    pieces_.clear();
    edges_.clear();
  }
  /// Adds a rectangle or disc that is larger than another piece on all sides.
  void add_larger(Piece piece, double by) {
    piece.hx += by;
    piece.hy += by;
    piece.xlo -= by;
    piece.xhi += by;
    piece.ylo -= by;
    piece.yhi += by;
    if (piece.kind == Kind::disc) piece.radius += by;
    pieces_.push_back(piece);
  }
  [[nodiscard]] const Piece* data() const { return pieces_.data(); }
  [[nodiscard]] std::size_t size() const { return pieces_.size(); }
  const Piece& operator[](std::size_t i) const { return pieces_[i]; }

 private:
  static bool is_box(const Polygon& polygon, const Box2& box) {
    const auto corners = rectangle_vertices(box);
    return polygon.vertices.size() == corners.size() &&
           std::is_permutation(corners.begin(), corners.end(), polygon.vertices.begin());
  }

  static std::vector<kernel::Edge> edges_of(const Polygon& polygon, double slack) {
    std::vector<kernel::Edge> edges;
    const auto& v = polygon.vertices;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const Vec2 along = v[(i + 1) % v.size()] - v[i];
      const double length = norm(along);
      const Vec2 normal{along.y / length, -along.x / length};
      edges.push_back({v[i].x, v[i].y, normal.x, normal.y, dot(normal, v[i]) + slack, length});
    }
    return edges;
  }

  std::vector<Piece> pieces_;
  std::vector<std::vector<kernel::Edge>> edges_;  ///< of each piece; moving a vector does not move its elements
};

/// The parts of a world as checkers use them.
struct Obstacles {
  Obstacles(const World& world, double slack) {
    std::vector<Box> boxes;
    for (const auto& part : world.parts()) {
      pieces.add(part.shape, 0.5 * slack);
      const Piece& piece = pieces[pieces.size() - 1];
      boxes.push_back({piece.xlo, piece.xhi, piece.ylo, piece.yhi});
    }
    index = PartIndex(std::move(boxes));
  }

  Pieces pieces;
  PartIndex index;
};

/// Returns the obstacles of a world, which all checkers of all threads share.
std::shared_ptr<const Obstacles> obstacles_of(const World& world, double slack) {
  static CacheByWorld<Obstacles, double> cache;
  return cache.get(world, slack, [&](const World& of) { return Obstacles(of, slack); });
}

/// Separating axes, eight poses in a step, and exact distances.
class PlanarPhase final : public NarrowPhase {
 public:
  PlanarPhase(std::shared_ptr<const PlanarScene> scene, Space space, const kernel::Table& kernels)
      : scene_(std::move(scene)),
        robot_(scene_->robot),
        space_(std::move(space)),
        kernels_(kernels),
        slack_(touching_slack(*scene_)),
        of_world_(obstacles_of(scene_->world, slack_)),
        obstacles_(of_world_->pieces),
        index_(of_world_->index) {
    candidates_.resize(obstacles_.size());
    const auto& [lo, hi] = scene_->world.bounds();
    bounds_ = {lo.x - slack_, hi.x + slack_, lo.y - slack_, hi.y + slack_};

    const auto& bodies = robot_.bodies();
    std::size_t corners = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (const auto& part : bodies[i].parts) {
        pieces_.add(part, 0.5 * slack_);
        body_of_.push_back(i);
        corners = std::max<std::size_t>(corners, pieces_[pieces_.size() - 1].edge_count);
      }
    }
    for (const auto& [first, second] : robot_.pairs()) add_pairs(first, second);
    hulls_.resize(pairs_.empty() ? 0 : pieces_.size());
    // Of an inflated polygon too: it has one more edge at each sharp corner.
    corners_.resize(2 * corners);
    placed_.corners = corners_.data();
    poses_.resize(bodies.size());
    frames_.resize(bodies.size());
    q_.resize(space_.dimension());
    difference_.resize(space_.dimension());

    point_ = robot_.is_point();
    // On a periodic axis a position wraps, so no box around the ends contains the whole motion.
    const bool jumps = robot_.translates() && (space_.axes()[0].periodic || space_.axes()[1].periodic);
    const bool team = !robot_.members().empty();
    rigid_ = bodies.size() == 1 && !jumps && !team;
    sweepable_ = !jumps && !team;
    continuous_ = !jumps && std::none_of(bodies.begin(), bodies.end(), [&](const Body& body) {
      const auto axis = static_cast<std::size_t>(body.position_axis);
      return body.position_axis >= 0 && (space_.axes()[axis].periodic || space_.axes()[axis + 1].periodic);
    });
    for (const Body& body : bodies) {
      if (body.angle_axis < 0) continue;
      const Axis& axis = space_.axes()[static_cast<std::size_t>(body.angle_axis)];
      if (!axis.periodic) continue;
      const double turns = axis.period() / (2.0 * std::numbers::pi);
      if (turns < 0.5 || std::abs(turns - std::round(turns)) > 1e-9) continuous_ = false;
    }
    set_reach();
    for (double& share : end_.v) share = 1.0;
  }

  [[nodiscard]] double displacement(View a, View b) const override { return robot_.displacement_bound(space_, a, b); }

  Decision begin(View a, View b, std::uint32_t n) override {
    a_ = a;
    b_ = b;
    n_ = n;
    inside_ = false;
    candidate_count_ = cull_each;
    if (sweepable_) {
      const Box swept = swept_box(a, b);
      inside_ =
          bounds_.xlo <= swept.xlo && swept.xhi <= bounds_.xhi && bounds_.ylo <= swept.ylo && swept.yhi <= bounds_.yhi;
      candidate_count_ = index_.query(swept, candidates_.data());
      if (inside_ && candidate_count_ == 0 && pairs_.empty()) return Decision::valid;
      if (inside_ && point_ && !segment_contact(segment_between(a, b), candidate_count_)) return Decision::valid;
      // A box around several bodies is much larger than they are: cull each body by its own box.
      if (candidate_count_ > 0 && poses_.size() > 1) candidate_count_ = cull_each;
    }
    in_line_ = rigid_ && line_between(a, b);
    return Decision::undecided;
  }

  Batch check(const Order& order, std::uint32_t rank) override {
    const kernel::Lanes& shares = order.shares[rank / kernel::lanes];
    const unsigned wanted = std::min(n_ - rank, kernel::lanes);
    if (in_line_) {
      kernels_.poses(line_, shares.v, poses_[0]);
    } else {
      poses_between(a_, b_, shares, wanted);
    }
    return {wanted, touched(pieces_, inside_, candidate_count_, wanted) & ((1U << wanted) - 1U)};
  }

  std::optional<double> end(std::uint32_t first) override {
    return point_ && first == n_ ? between_configurations(a_, b_) : std::nullopt;
  }

  bool sweep(View a, View b, Certificate& certificate) override {
    space_.difference(a, b, difference_);
    return sweeps_freely(a, b, certificate) || (rigid_ && certify_sweep(a, certificate)) ||
           (rigid_ && continuous_ && line_between(a, b) && certify_turn(certificate));
  }

  Distances on(View a, View b, double longest) override {
    std::vector<double> breaks = wraps(space_, a, difference_);
    clearances_.begin(*this, a, b);
    return {clearances_, clearances_.displacement(), longest, std::move(breaks)};
  }

  [[nodiscard]] bool touches(View q) const override {
    pose_at(q);
    return (touched(pieces_, false, cull_each, 1) & 1U) != 0;
  }

  [[nodiscard]] double clearance(View q) const override {
    if (touches(q)) return 0.0;
    robot_.place(q, frames_);
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < robot_.bodies().size(); ++i) {
      for (const auto& part : robot_.bodies()[i].parts) {
        move_shape(part, frames_[i], moved_);
        best = std::min(best, distance_in_world(moved_, best));
      }
    }
    for (const auto& [first, second] : robot_.pairs()) best = std::min(best, distance_between(first, second));
    return std::max(best, 0.0);
  }

  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) const override {
    robot_.place(q, frames_);
    const auto& parts = scene_->world.parts();
    std::optional<Proximity> nearest;
    for (std::size_t i = 0; i < robot_.bodies().size(); ++i) {
      for (const auto& part : robot_.bodies()[i].parts) {
        move_shape(part, frames_[i], moved_);
        const Box2 box = bounding_box(moved_);
        // Of equally near obstacles the first one, and of its parts the first one, whatever the order of the visits.
        double at_most = nearest ? nearest->distance : std::numeric_limits<double>::infinity();
        std::optional<std::size_t> first;  // the nearest part of the world to this part of the robot
        index_.nearest(box, at_most, [&](std::size_t k) {
          const Piece& o = obstacles_[k];
          if (box_distance(box, {{o.xlo, o.ylo}, {o.xhi, o.yhi}}) > at_most) return;
          const double d = distance(moved_, parts[k].shape);
          const std::size_t obstacle = parts[k].obstacle;
          const bool before = !nearest || d < nearest->distance ||
                              (d == nearest->distance && (obstacle < nearest->obstacle ||
                                                          (obstacle == nearest->obstacle && first && k < *first)));
          if (!before) return;
          nearest = Proximity{obstacle, d};
          first = k;
          at_most = d;
          if (d <= 0.0) return;
          const Vec2 point = nearest_point(moved_, parts[k].shape);
          nearest->point = Vec3{point.x, point.y, 0.0};
        });
      }
    }
    return nearest;
  }

  /// The maximum of the bounds of all overlaps. If two convex shapes overlap by a depth p, their projections overlap in
  /// every direction by at least p: they have no separating direction before points of the robot have moved by p.
  [[nodiscard]] double invalid_radius(View q) const override {
    if (!continuous_ || !touches(q)) return 0.0;
    robot_.place(q, frames_);
    double best = 0.0;
    for (std::size_t i = 0; i < robot_.bodies().size(); ++i) {
      for (const auto& part : robot_.bodies()[i].parts) {
        move_shape(part, frames_[i], moved_);
        const double depth = depth_in_world(moved_);
        if (depth <= 0.0) continue;
        set_rates(i, -1, moved_);
        best = std::max(best, radius_of(depth, {root_axis(i), -1}));
      }
    }
    // The inscribed disc about the reference point does not move when the robot turns.
    if (robot_.translates() && robot_.inscribed_radius() > 0.0) {
      rates_.assign(space_.dimension(), 0.0);
      best = std::max(best, radius_of(depth_in_world(Disc{{q[0], q[1]}, robot_.inscribed_radius()}), {0, -1}));
    }
    for (const auto& [first, second] : robot_.pairs()) {
      for (const auto& part : robot_.bodies()[first].parts) {
        move_shape(part, frames_[first], moved_);
        for (const auto& other : robot_.bodies()[second].parts) {
          move_shape(other, frames_[second], other_);
          const double depth = penetration_depth(moved_, other_);
          if (depth <= 0.0) continue;
          const int ancestor = common_ancestor(first, second);
          set_rates(first, ancestor, moved_);
          add_rates(second, ancestor, other_);
          best = std::max(best, radius_of(depth, roots_apart(first, second)));
        }
      }
    }
    return best;
  }

  [[nodiscard]] std::optional<Contact> contact(View q) const override {
    pose_at(q);
    for (std::size_t first = 0; first < pieces_.size();) {
      const std::size_t body = body_of_[first];
      std::optional<std::size_t> nearest;
      bool out = false;
      for (; first < pieces_.size() && body_of_[first] == body; ++first) {
        kernels_.place(poses_[body], pieces_[first], placed_);
        out = out || (kernels_.outside(placed_, bounds_) & 1U) != 0;
        const unsigned count = index_.query(hull(1), candidates_.data());
        for (unsigned i = 0; i < count; ++i) {
          if ((kernels_.collide(placed_, pieces_[first], obstacles_.data(), &candidates_[i], 1) & 1U) == 0) continue;
          const std::size_t obstacle = scene_->world.parts()[candidates_[i]].obstacle;
          nearest = nearest ? std::min(*nearest, obstacle) : obstacle;
        }
      }
      if (nearest || out) return Contact{body, nearest};
    }
    for (const auto& pair : pairs_) {
      if ((meeting(pair, pieces_) & 1U) != 0) return Contact{body_of_[pair.first], std::nullopt, body_of_[pair.second]};
    }
    return std::nullopt;
  }

 private:
  /// Replaces the number of candidates: look them up for each piece of the robot.
  static constexpr unsigned cull_each = std::numeric_limits<unsigned>::max();

  /// Pieces of two bodies of a self-collision pair.
  struct Pair {
    std::size_t first;
    std::size_t second;
  };

  /// A part of a motion, by its middle and half its length as shares of the motion, with the range of the pairs that
  /// may be close on it.
  struct OpenInterval {
    double middle;
    double half;
    std::size_t begin;
    std::size_t end;
  };
  /// A part of the robot and one of the obstacles near the motion, or the boundary.
  struct NearPair {
    static constexpr std::size_t boundary = std::numeric_limits<std::size_t>::max();
    std::size_t part;
    std::size_t obstacle;
    Box2 box;  ///< of the obstacle or boundary
  };
  /// What a motion with turns is certified in. Each thread has one and keeps its memory: a certificate of a short path
  /// takes less time than the allocations.
  struct TurnMemory {
    std::vector<MovingConvex> moving;    ///< the robot's parts on an interval, and others behind them
    std::vector<Box2> boxes;             ///< around these parts
    std::vector<Convex> near_obstacles;  ///< of the motion, and others behind them
    std::vector<OpenInterval> open;      ///< a stack
    std::vector<NearPair> near_pairs;    ///< of the open intervals, in ranges
  };

  /// The distances on a motion: inflated pieces decide eight configurations in a step, exact distances the others.
  class Clearances final : public MotionClearance {
   public:
    /// Begins a motion, whose difference the narrow phase holds.
    void begin(const PlanarPhase& phase, View a, View b) {
      phase_ = &phase;
      a_ = a;
      b_ = b;
      displacements_.clear();
      relative_.clear();
      displacement_ = 0.0;
      half_ = -1.0;
      const Robot& robot = phase.robot_;
      const View difference = phase.difference_;
      const double translation = robot.translates() ? norm(Vec2{difference[0], difference[1]}) : 0.0;
      for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
        displacements_.push_back(translation + robot.displacement_of(i, -1, difference));
        displacement_ = std::max(displacement_, displacements_.back());
      }
      for (const auto& [first, second] : robot.pairs()) {
        const int ancestor = phase.common_ancestor(first, second);
        relative_.push_back(robot.displacement_of(first, ancestor, difference) +
                            robot.displacement_of(second, ancestor, difference));
      }
      in_line_ = phase.rigid_ && phase.line_between(a, b);
    }

    /// Of all bodies on the whole motion, in metres.
    [[nodiscard]] double displacement() const { return displacement_; }

    [[nodiscard]] unsigned apart(std::span<const double> shares, double half, double margin) override {
      inflate(half, margin);
      unsigned found = 0;
      // The kernels stop when the first configuration is in contact: the next call begins after it.
      for (std::size_t first = 0; first < shares.size();) {
        const auto count = static_cast<unsigned>(shares.size() - first);
        kernel::Lanes at;
        for (unsigned lane = 0; lane < kernel::lanes; ++lane) at.v[lane] = shares[first + std::min(lane, count - 1)];
        if (in_line_) {
          phase_->kernels_.poses(phase_->line_, at.v, phase_->poses_[0]);
        } else {
          phase_->poses_between(a_, b_, at, count);
        }
        const unsigned hit = phase_->touched(phase_->wide_, false, cull_each, count);
        if ((hit & 1U) != 0) {
          ++first;
          continue;
        }
        found |= (~hit & ((1U << count) - 1U)) << first;
        break;
      }
      return found;
    }

    [[nodiscard]] Near near(double share, double half, double at_most) override {
      phase_->space_.interpolate(a_, b_, share, phase_->q_);
      phase_->robot_.place(phase_->q_, phase_->frames_);
      Near all{at_most, at_most};
      const auto& bodies = phase_->robot_.bodies();
      const auto add = [&](double distance, double displacement) {
        if (distance <= phase_->slack_) distance = 0.0;
        all.distance = std::min(all.distance, distance);
        all.sure = std::min(all.sure, distance - displacement);
      };
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double displacement = half * displacements_[i];
        for (const auto& part : bodies[i].parts) {
          move_shape(part, phase_->frames_[i], phase_->moved_);
          add(phase_->distance_in_world(phase_->moved_, at_most + displacement), displacement);
        }
      }
      for (std::size_t k = 0; k < relative_.size(); ++k) {
        const auto& [first, second] = phase_->robot_.pairs()[k];
        add(phase_->distance_between(first, second), half * relative_[k]);
      }
      return all;
    }

   private:
    /// Makes the pieces of the robot, each with what its body moves by on `half` of the motion and `margin` about it.
    void inflate(double half, double margin) {
      if (half == half_ && margin == margin_) return;
      half_ = half;
      margin_ = margin;
      phase_->wide_.clear();
      const auto& bodies = phase_->robot_.bodies();
      std::size_t piece = 0;
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double by = margin + half * displacements_[i];
        for (const auto& part : bodies[i].parts) {
          const Piece& own = phase_->pieces_[piece++];
          if (own.kind == Kind::polygon) {
            phase_->wide_.add(inflated(part, by), phase_->slack_);
          } else {
            phase_->wide_.add_larger(own, by + phase_->slack_);
          }
        }
      }
    }

    const PlanarPhase* phase_ = nullptr;
    View a_;
    View b_;
    std::vector<double> displacements_;  ///< of each body on the whole motion, in metres
    std::vector<double> relative_;       ///< of the bodies of each self-collision pair to each other
    double displacement_ = 0.0;
    bool in_line_ = false;
    double half_ = -1.0;  ///< of the inflated pieces
    double margin_ = -1.0;
  };

  /// Adds a motion if the box that it sweeps is farther from everything than the certificate's bound so far; returns
  /// whether it is.
  bool sweeps_freely(View a, View b, Certificate& certificate) const {
    if (!sweepable_ || !pairs_.empty() || !std::isfinite(certificate.nearest)) return false;
    const Box swept = swept_box(a, b);
    const double by = certificate.nearest;
    const Box box{swept.xlo - by, swept.xhi + by, swept.ylo - by, swept.yhi + by};
    const Box2& bounds = scene_->world.bounds();
    if (box.xlo < bounds.lo.x || box.xhi > bounds.hi.x || box.ylo < bounds.lo.y || box.yhi > bounds.hi.y) return false;
    if (index_.query(box, candidates_.data()) > 0) return false;
    announce_motion_checks(1);
    ++certificate.checks;
    return true;
  }

  /// Adds a motion without turns, by the areas that the pieces sweep; returns false where the motion turns, or where
  /// these areas are in contact, so that the place remains to be found.
  bool certify_sweep(View a, Certificate& certificate) const {
    const Body& body = robot_.bodies()[0];
    if (body.angle_axis >= 0 && difference_[static_cast<std::size_t>(body.angle_axis)] != 0.0) return false;
    robot_.place(a, frames_);
    const Vec2 along = robot_.translates() ? Vec2{difference_[0], difference_[1]} : Vec2{};
    double least = certificate.nearest;
    for (const auto& part : body.parts) {
      move_shape(part, frames_[0], moved_);
      if (const auto* disc = std::get_if<Disc>(&moved_)) {
        const Segment2 path{disc->centre, along};
        const Box2 box = swept_box_of(moved_, along);
        const double radius = disc->radius;
        least = std::min(least, nearest_part(box, least, [&](const ConvexShape& obstacle) {
                           return std::max(0.0, distance(path, obstacle) - radius);
                         }));
      } else {
        if (along != Vec2{}) moved_ = swept(std::get<Polygon>(moved_), along);
        least = std::min(least, distance_in_world(moved_, least));
      }
      if (least <= slack_) return false;
    }
    announce_motion_checks(1);
    ++certificate.checks;
    certificate.nearest = least;
    certificate.clearance = std::min(certificate.clearance, least);
    return true;
  }

  /// Adds a motion of the single body, whose line is set, by the directions in which it is separated from the obstacles
  /// near it: an interval is certified where the gaps along them exceed the certificate's bound throughout. Returns
  /// false, and leaves the certificate, where a place on the motion is undecided.
  bool certify_turn(Certificate& certificate) const {
    if (!std::isfinite(certificate.nearest)) return false;
    const auto& parts = robot_.bodies()[0].parts;
    if (convex_parts_.size() != parts.size()) {
      convex_parts_.resize(parts.size());
      for (std::size_t i = 0; i < parts.size(); ++i) write_convex(parts[i], convex_parts_[i]);
    }
    ThreadScratch<TurnMemory> scratch;
    TurnMemory& memory = *scratch;
    memory.moving.resize(std::max(memory.moving.size(), parts.size()));
    memory.boxes.resize(parts.size());
    auto& near_pairs = memory.near_pairs;
    auto& open = memory.open;
    const double displacement =
        norm(Vec2{line_.difference_x, line_.difference_y}) + std::abs(line_.turn) * robot_.bounding_radius();
    double nearest = certificate.nearest;
    const auto enough = [&] { return certified_share * nearest + slack_; };
    std::uint32_t checks = 0;
    constexpr std::uint32_t most = 1U << 20U;
    // These checks do not count where they leave the motion undecided.
    const auto undecided = [&] {
      withdraw_motion_checks(checks);
      return false;
    };
    // Depth first: what an interval leaves undecided its halves decide, and nothing else.
    near_pairs.clear();
    open.assign(1, {0.5, 0.5, 0, 0});
    for (bool first = true; !open.empty(); first = false) {
      const OpenInterval at = open.back();
      open.pop_back();
      announce_motion_checks(1);
      if (++checks > most) return undecided();
      place_parts(at, memory);
      if (first) find_near_pairs(enough(), memory);
      const std::size_t end = first ? near_pairs.size() : at.end;
      near_pairs.resize(end);
      for (std::size_t i = at.begin; i < end; ++i) {
        const NearPair pair = near_pairs[i];
        if (box_gap(pair, memory) > enough()) continue;
        const MovingConvex::Gap gap = gap_of(pair, memory);
        if (gap.middle <= slack_) return undecided();
        nearest = std::min(nearest, gap.middle);
        if (gap.throughout <= enough()) near_pairs.push_back(pair);
      }
      if (near_pairs.size() == end) continue;
      const double half = 0.5 * at.half;
      if (half * displacement <= certificate.tolerance) return undecided();
      for (const double middle : {at.middle - half, at.middle + half}) {
        open.push_back({middle, half, end, near_pairs.size()});
      }
    }
    certificate.checks += checks;
    certificate.nearest = nearest;
    certificate.clearance = std::min(certificate.clearance, certified_share * nearest);
    return true;
  }

  /// Places the robot's parts on an interval of the line.
  void place_parts(const OpenInterval& at, TurnMemory& memory) const {
    const double angle = line_.turns ? line_.angle + at.middle * line_.turn : 0.0;
    const Pose2 middle{line_.x + at.middle * line_.difference_x + line_.joint_x,
                       line_.y + at.middle * line_.difference_y + line_.joint_y, std::cos(angle), std::sin(angle)};
    const Vec2 translation = at.half * Vec2{line_.difference_x, line_.difference_y};
    const double turn = line_.turns ? at.half * line_.turn : 0.0;
    for (std::size_t i = 0; i < convex_parts_.size(); ++i) {
      memory.moving[i].set(convex_parts_[i], middle, translation, turn);
      memory.boxes[i] = memory.moving[i].box();
    }
  }

  /// Finds what the placed parts may come closer to than `by`.
  void find_near_pairs(double by, TurnMemory& memory) const {
    const Box2& bounds = scene_->world.bounds();
    std::size_t found = 0;
    for (std::size_t part = 0; part < memory.boxes.size(); ++part) {
      const Box2& box = memory.boxes[part];
      if (margin_inside(box, bounds) <= by) memory.near_pairs.push_back({part, NearPair::boundary, bounds});
      const unsigned count =
          index_.query({box.lo.x - by, box.hi.x + by, box.lo.y - by, box.hi.y + by}, candidates_.data());
      for (unsigned k = 0; k < count; ++k) {
        const Piece& o = obstacles_[candidates_[k]];
        if (box_distance(box, {{o.xlo, o.ylo}, {o.xhi, o.yhi}}) > by) continue;
        if (found == memory.near_obstacles.size()) memory.near_obstacles.emplace_back();
        const ConvexShape& shape = scene_->world.parts()[candidates_[k]].shape;
        if (o.kind == Kind::rectangle) {
          write_convex(bounding_box(shape), memory.near_obstacles[found]);
        } else {
          write_convex(shape, memory.near_obstacles[found]);
        }
        memory.near_pairs.push_back({part, found++, {{o.xlo, o.ylo}, {o.xhi, o.yhi}}});
      }
    }
  }

  /// Returns a lower bound on the distance of a pair on the interval of the placed parts: that of their boxes.
  [[nodiscard]] static double box_gap(const NearPair& pair, const TurnMemory& memory) {
    const Box2& box = memory.boxes[pair.part];
    return pair.obstacle == NearPair::boundary ? margin_inside(box, pair.box) : box_distance(box, pair.box);
  }

  [[nodiscard]] static MovingConvex::Gap gap_of(const NearPair& pair, const TurnMemory& memory) {
    const MovingConvex& part = memory.moving[pair.part];
    if (pair.obstacle == NearPair::boundary) return {margin_inside(part.middle_box(), pair.box), box_gap(pair, memory)};
    return part.gap(memory.near_obstacles[pair.obstacle]);
  }

  static Box2 swept_box_of(const ConvexShape& shape, Vec2 along) {
    const Box2 box = bounding_box(shape);
    return {{box.lo.x + std::min(along.x, 0.0), box.lo.y + std::min(along.y, 0.0)},
            {box.hi.x + std::max(along.x, 0.0), box.hi.y + std::max(along.y, 0.0)}};
  }

  /// Returns the least distance of a shape with this bounding box from obstacles and boundary; `at_most` where it is
  /// not less, 0 beyond the boundary. \param of  returns its distance from an obstacle's part
  template <class Of>
  [[nodiscard]] double nearest_part(const Box2& box, double at_most, const Of& of) const {
    const Box2& bounds = scene_->world.bounds();
    double best = std::min(at_most, margin_inside(box, bounds));
    if (best <= 0.0) return 0.0;
    index_.nearest(box, best, [&](std::size_t k) {
      const Piece& o = obstacles_[k];
      if (box_distance(box, {{o.xlo, o.ylo}, {o.xhi, o.yhi}}) >= best) return;
      best = std::min(best, of(scene_->world.parts()[k].shape));
    });
    return std::max(best, 0.0);
  }

  /// Returns the least distance of a placed shape from obstacles and boundary; `at_most` where it is not less.
  [[nodiscard]] double distance_in_world(const ConvexShape& shape, double at_most) const {
    return nearest_part(bounding_box(shape), at_most,
                        [&](const ConvexShape& obstacle) { return distance(shape, obstacle); });
  }

  /// Returns the least distance between two bodies at the current frames.
  [[nodiscard]] double distance_between(std::size_t first, std::size_t second) const {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& part : robot_.bodies()[first].parts) {
      move_shape(part, frames_[first], moved_);
      for (const auto& other : robot_.bodies()[second].parts) {
        move_shape(other, frames_[second], other_);
        best = std::min(best, distance(moved_, other_));
      }
    }
    return best;
  }

  [[nodiscard]] Segment2 segment_between(View a, View b) const { return {{a[0], a[1]}, {b[0] - a[0], b[1] - a[1]}}; }

  /// Returns the parameter of a contact of a point's motion with one of the first candidates.
  [[nodiscard]] std::optional<double> segment_contact(const Segment2& segment, unsigned candidates) const {
    for (unsigned k = 0; k < candidates; ++k) {
      if (const auto at = trellis::contact(segment, obstacles_[candidates_[k]], 0.5 * slack_)) return at;
    }
    return std::nullopt;
  }

  /// Returns the parameter of a contact of a point's motion, whose checked configurations are free.
  [[nodiscard]] std::optional<double> between_configurations(View a, View b) const {
    if (sweepable_) return contact_near(segment_between(a, b));
    // Between two ends of a period the motion is one segment.
    space_.difference(a, b, difference_);
    std::vector<double> ends = wraps(space_, a, difference_);
    ends.push_back(1.0);
    double from = 0.0;
    for (const double to : ends) {
      space_.interpolate(a, b, 0.5 * (from + to), q_);
      const Vec2 along = (to - from) * Vec2{difference_[0], difference_[1]};
      const Segment2 segment{Vec2{q_[0], q_[1]} - 0.5 * along, along};
      if (const auto at = contact_near(segment)) return from + *at * (to - from);
      from = to;
    }
    return std::nullopt;
  }

  /// As `segment_contact`, for the obstacles near the segment.
  [[nodiscard]] std::optional<double> contact_near(const Segment2& segment) const {
    const Vec2 end = segment.from + segment.along;
    const Box box{std::min(segment.from.x, end.x) - slack_, std::max(segment.from.x, end.x) + slack_,
                  std::min(segment.from.y, end.y) - slack_, std::max(segment.from.y, end.y) + slack_};
    return segment_contact(segment, index_.query(box, candidates_.data()));
  }

  /// Returns the penetration depth of a shape in an obstacle, or its distance beyond the boundary; the greatest of
  /// these.
  [[nodiscard]] double depth_in_world(const ConvexShape& shape) const {
    const Box2 box = bounding_box(shape);
    double depth = -margin_inside(box, scene_->world.bounds());
    const unsigned count = index_.query({box.lo.x, box.hi.x, box.lo.y, box.hi.y}, candidates_.data());
    for (unsigned k = 0; k < count; ++k) {
      depth = std::max(depth, penetration_depth(shape, scene_->world.parts()[candidates_[k]].shape));
    }
    return depth;
  }

  /// The first of the two axes that move the reference point of a body; -1: it is fixed to its base.
  [[nodiscard]] int root_axis(std::size_t body) const {
    if (robot_.translates()) return 0;
    const auto& bodies = robot_.bodies();
    while (bodies[body].parent >= 0) body = static_cast<std::size_t>(bodies[body].parent);
    return bodies[body].position_axis;
  }
  /// Those of two bodies; none where the same ones move both.
  [[nodiscard]] std::array<int, 2> roots_apart(std::size_t first, std::size_t second) const {
    const std::array<int, 2> roots{root_axis(first), root_axis(second)};
    return roots[0] == roots[1] ? std::array{-1, -1} : roots;
  }

  /// Returns the radius of the metric's ball in which no point of the robot moves by `depth`, of two bodies none seen
  /// from the other. Points move by at most `rates_` times each axis's change, and with their reference points.
  /// Follows from Cauchy-Schwarz.
  /// \param positions  the first of the two axes that move each reference point; -1: none does
  [[nodiscard]] double radius_of(double depth, const std::array<int, 2>& positions) const {
    const auto& axes = space_.axes();
    double squares = 0.0;
    for (const int position : positions) {
      if (position < 0) continue;
      const auto axis = static_cast<std::size_t>(position);
      const double weight = std::min(axes[axis].weight, axes[axis + 1].weight);
      squares += 1.0 / (weight * weight);
    }
    for (std::size_t j = 0; j < axes.size(); ++j) squares += rates_[j] * rates_[j] / (axes[j].weight * axes[j].weight);
    const double moved = std::max(0.0, depth - 2.0 * slack_);
    const double farthest = space_.diameter();
    return moved < farthest * std::sqrt(squares) ? moved / std::sqrt(squares) : (moved > 0.0 ? farthest : 0.0);
  }

  /// Sets the rate at which the points of a shape on a body move, at most, in metres per radian of each axis.
  /// \param ancestor  an ancestor of the body that counts as fixed; -1: the world
  void set_rates(std::size_t body, int ancestor, const ConvexShape& shape) const {
    rates_.assign(space_.dimension(), 0.0);
    add_rates(body, ancestor, shape);
  }

  /// A joint turns the bodies that it carries as one rigid body. Turn the joints from the base outwards: then the radii
  /// of later joints stay as they are at q at all angles.
  void add_rates(std::size_t body, int ancestor, const ConvexShape& shape) const {
    std::optional<Vec2>
        carried;  // the only point that an earlier joint moves: the origin beyond a body with an absolute angle
    for (int at = static_cast<int>(body); at != ancestor && at >= 0;) {
      const Body& turned = robot_.bodies()[static_cast<std::size_t>(at)];
      const Vec2 origin{frames_[static_cast<std::size_t>(at)].x, frames_[static_cast<std::size_t>(at)].y};
      if (turned.angle_axis >= 0) {
        const double farthest = carried ? norm(*carried - origin) : farthest_point(shape, origin);
        rates_[static_cast<std::size_t>(turned.angle_axis)] += farthest;
        if (turned.absolute) carried = origin;
      }
      at = turned.parent;
    }
  }

  /// Returns the largest distance of a shape's points from a centre that turns it; for a disc, that of its own centre,
  /// because a turned disc is a disc.
  static double farthest_point(const ConvexShape& shape, Vec2 centre) {
    if (const auto* disc = std::get_if<Disc>(&shape)) return norm(disc->centre - centre);
    double farthest = 0.0;
    for (const Vec2 v : std::get<Polygon>(shape).vertices) farthest = std::max(farthest, norm(v - centre));
    return farthest;
  }

  /// Returns the last body that carries both and whose turns do not change their relative pose; -1: there is none.
  [[nodiscard]] int common_ancestor(std::size_t first, std::size_t second) const {
    const auto& bodies = robot_.bodies();
    int a = static_cast<int>(first), b = static_cast<int>(second);
    while (a != b) {
      int& later = a > b ? a : b;
      // A parent's turn does not change an absolute angle.
      if (bodies[static_cast<std::size_t>(later)].absolute) return -1;
      later = bodies[static_cast<std::size_t>(later)].parent;
      if (later < 0) return -1;
    }
    return a;
  }

  void add_pairs(std::size_t first, std::size_t second) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      for (std::size_t k = 0; k < pieces_.size(); ++k) {
        if (body_of_[i] == first && body_of_[k] == second) pairs_.push_back({i, k});
      }
    }
  }

  /// Returns the lanes in which the pieces collide; the first takes the role of the obstacle, and the frame is that of
  /// its body.
  [[nodiscard]] unsigned meeting(const Pair& pair, const Pieces& pieces) const {
    const kernel::Poses& from = poses_[body_of_[pair.first]];
    const kernel::Poses& to = poses_[body_of_[pair.second]];
    for (unsigned lane = 0; lane < kernel::lanes; ++lane) {
      const double c = from.c.v[lane];
      const double s = from.s.v[lane];
      const double dx = to.x.v[lane] - from.x.v[lane];
      const double dy = to.y.v[lane] - from.y.v[lane];
      seen_.x.v[lane] = c * dx + s * dy;
      seen_.y.v[lane] = c * dy - s * dx;
      seen_.c.v[lane] = c * to.c.v[lane] + s * to.s.v[lane];
      seen_.s.v[lane] = c * to.s.v[lane] - s * to.c.v[lane];
    }
    const Piece& piece = pieces[pair.second];
    kernels_.place(seen_, piece, placed_);
    const auto first = static_cast<unsigned>(pair.first);
    return kernels_.collide(placed_, piece, pieces.data(), &first, 1);
  }

  void set_reach() {
    const double margin = 2.0 * slack_;
    if (rigid_ && robot_.bodies()[0].angle_axis < 0) {
      reach_ = {pieces_[0].xlo, pieces_[0].xhi, pieces_[0].ylo, pieces_[0].yhi};
      for (std::size_t i = 1; i < pieces_.size(); ++i) {
        reach_ = {std::min(reach_.xlo, pieces_[i].xlo), std::max(reach_.xhi, pieces_[i].xhi),
                  std::min(reach_.ylo, pieces_[i].ylo), std::max(reach_.yhi, pieces_[i].yhi)};
      }
      const Vec2 joint = robot_.bodies()[0].joint;
      reach_ = {reach_.xlo + joint.x - margin, reach_.xhi + joint.x + margin, reach_.ylo + joint.y - margin,
                reach_.yhi + joint.y + margin};
    } else {
      const double radius = robot_.bounding_radius() + margin;
      reach_ = {-radius, radius, -radius, radius};
    }
  }

  /// Returns a box around the area that the robot sweeps on the motion.
  [[nodiscard]] Box swept_box(View a, View b) const {
    const Vec2 from = robot_.translates() ? Vec2{a[0], a[1]} : robot_.base();
    const Vec2 to = robot_.translates() ? Vec2{b[0], b[1]} : robot_.base();
    return {std::min(from.x, to.x) + reach_.xlo, std::max(from.x, to.x) + reach_.xhi,
            std::min(from.y, to.y) + reach_.ylo, std::max(from.y, to.y) + reach_.yhi};
  }

  /// Sets the line of a single body's poses; returns false where its angle is too large for the kernels' sine.
  bool line_between(View a, View b) const {
    const Body& body = robot_.bodies()[0];
    const Vec2 from = robot_.translates() ? Vec2{a[0], a[1]} : robot_.base();
    const Vec2 to = robot_.translates() ? Vec2{b[0], b[1]} : robot_.base();
    line_.x = from.x;
    line_.y = from.y;
    line_.difference_x = to.x - from.x;
    line_.difference_y = to.y - from.y;
    line_.end_x = to.x;
    line_.end_y = to.y;
    line_.joint_x = body.joint.x;
    line_.joint_y = body.joint.y;
    line_.turns = body.angle_axis >= 0;
    if (!line_.turns) return true;
    const auto axis = static_cast<std::size_t>(body.angle_axis);
    if (a.data() == b.data()) {
      line_.turn = 0.0;
    } else {
      space_.difference(a, b, difference_);
      line_.turn = difference_[axis];
    }
    line_.angle = a[axis];
    line_.end_angle = b[axis];
    return std::abs(a[axis]) <= kernel::largest_angle && std::abs(b[axis]) <= kernel::largest_angle;
  }

  /// Sets all lanes to one configuration.
  void pose_at(View q) const {
    if (rigid_ && line_between(q, q)) {
      kernels_.poses(line_, end_.v, poses_[0]);
      return;
    }
    robot_.place(q, frames_);
    for (unsigned lane = 0; lane < kernel::lanes; ++lane) set_lane(lane);
  }

  void poses_between(View a, View b, const kernel::Lanes& shares, unsigned wanted) const {
    for (unsigned lane = 0; lane < kernel::lanes; ++lane) {
      if (lane < wanted) {
        space_.interpolate(a, b, shares.v[lane], q_);
        robot_.place(q_, frames_);
      }
      set_lane(lane);
    }
  }

  void set_lane(unsigned lane) const {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      poses_[i].x.v[lane] = frames_[i].x;
      poses_[i].y.v[lane] = frames_[i].y;
      poses_[i].c.v[lane] = frames_[i].c;
      poses_[i].s.v[lane] = frames_[i].s;
    }
  }

  /// Returns the lanes in which the robot touches an obstacle or leaves the world; only the first `lanes` matter. May
  /// stop early once the first lane does.
  /// \param pieces  the robot's, or larger ones in their place
  [[nodiscard]] unsigned touched(const Pieces& pieces, bool inside, unsigned candidates, unsigned lanes) const {
    unsigned hit = 0;
    for (std::size_t i = 0; i < pieces.size() && (hit & 1U) == 0; ++i) {
      const Piece& piece = pieces[i];
      kernels_.place(poses_[body_of_[i]], piece, placed_);
      if (!inside) hit |= kernels_.outside(placed_, bounds_);
      if ((hit & 1U) != 0) break;
      const bool cull = candidates == cull_each;
      if (!pairs_.empty()) hulls_[i] = hull(lanes);
      const unsigned count =
          cull ? index_.query(pairs_.empty() ? hull(lanes) : hulls_[i], candidates_.data()) : candidates;
      if (count > 0) hit |= kernels_.collide(placed_, piece, obstacles_.data(), candidates_.data(), count);
    }
    for (std::size_t i = 0; i < pairs_.size() && (hit & 1U) == 0; ++i) {
      if (overlap(hulls_[pairs_[i].first], hulls_[pairs_[i].second])) hit |= meeting(pairs_[i], pieces);
    }
    return hit;
  }

  static bool overlap(const Box& a, const Box& b) {
    return a.xlo <= b.xhi && b.xlo <= a.xhi && a.ylo <= b.yhi && b.ylo <= a.yhi;
  }

  /// Returns the bounding box of the placed piece in the first lanes.
  [[nodiscard]] Box hull(unsigned lanes) const {
    Box box{placed_.xlo.v[0], placed_.xhi.v[0], placed_.ylo.v[0], placed_.yhi.v[0]};
    for (unsigned lane = 1; lane < lanes; ++lane) {
      box.xlo = std::min(box.xlo, placed_.xlo.v[lane]);
      box.xhi = std::max(box.xhi, placed_.xhi.v[lane]);
      box.ylo = std::min(box.ylo, placed_.ylo.v[lane]);
      box.yhi = std::max(box.yhi, placed_.yhi.v[lane]);
    }
    return box;
  }

  std::shared_ptr<const PlanarScene> scene_;
  const Robot& robot_;
  Space space_;
  const kernel::Table& kernels_;
  double slack_;
  std::shared_ptr<const Obstacles> of_world_;
  const Pieces& obstacles_;  ///< the world's parts
  const PartIndex& index_;   ///< of the obstacles
  Box bounds_{};
  Pieces pieces_;  ///< the robot's, body by body
  std::vector<std::size_t> body_of_;
  std::vector<Pair> pairs_;
  Box reach_{};              ///< contains the robot about its reference point at any angle
  bool point_ = false;       ///< the robot is a point
  bool rigid_ = false;       ///< one body that moves on a line
  bool sweepable_ = false;   ///< the reference point stays in the box around a motion's ends
  bool continuous_ = false;  ///< motions on a periodic axis wrap without a jump of the robot
  kernel::Lanes end_{};

  // The motion that has begun.
  View a_;
  View b_;
  std::uint32_t n_ = 0;
  bool in_line_ = false;                  ///< `line_` gives its poses
  bool inside_ = false;                   ///< the box that it sweeps is inside the boundary
  unsigned candidate_count_ = cull_each;  ///< of `candidates_`

  // Scratch.
  mutable kernel::Line line_;
  mutable std::vector<kernel::Poses> poses_;  ///< per body
  mutable kernel::Placed placed_{};
  mutable std::vector<kernel::Corner> corners_;
  mutable std::vector<unsigned> candidates_;
  mutable std::vector<Pose2> frames_;
  mutable Configuration q_;
  mutable Configuration difference_;
  mutable ConvexShape moved_;
  mutable ConvexShape other_;
  mutable Pieces wide_;                       ///< the robot's pieces, inflated
  Clearances clearances_;                     ///< on the motion that is certified
  mutable std::vector<Convex> convex_parts_;  ///< of the robot's only body, in its frame; empty before their first use
  mutable std::vector<Box> hulls_;            ///< of the pieces, where there are pairs
  mutable kernel::Poses seen_{};              ///< a body in another body's frame
  mutable std::vector<double> rates_;         ///< metres that points move per radian of each axis
};

}  // namespace

std::unique_ptr<NarrowPhase> make_planar_phase(std::shared_ptr<const PlanarScene> scene, const Space& space,
                                               const kernel::Table& kernels) {
  return std::make_unique<PlanarPhase>(std::move(scene), space, kernels);
}

std::unique_ptr<Checker> make_planar_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution,
                                             const kernel::Table& kernels) {
  auto planar = planar_scene(std::move(scene));
  check_fits(*planar, space, resolution);
  return std::make_unique<Checker>(*planar, make_planar_phase(planar, space, kernels), resolution);
}

std::unique_ptr<Checker> make_planar_checker(std::shared_ptr<const Scene> scene, const Space& space,
                                             double resolution) {
  return make_planar_checker(std::move(scene), space, resolution, kernel::best());
}

}  // namespace trellis
