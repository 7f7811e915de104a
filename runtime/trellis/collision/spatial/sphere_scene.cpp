// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/spatial/sphere_scene.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <span>

#include <trellis/base/error.hpp>
#include <trellis/scene/cache_by_world.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>

namespace trellis {

Matrix3 times(const Matrix3& a, const Matrix3& b) {
  Matrix3 c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
  }
  return c;
}

Matrix3 matrix_of(const Quaternion& q) {
  const Vec3 x = q({1, 0, 0});
  const Vec3 y = q({0, 1, 0});
  const Vec3 z = q({0, 0, 1});
  return {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
}

namespace {

Primitive primitive_of(const Solid& solid, std::size_t obstacle) {
  Primitive made;
  made.r = matrix_of(solid.pose.orientation.inverse());
  made.centre = solid.pose.position;
  made.obstacle = obstacle;
  made.far = farthest_from_origin({solid.shape, {}});
  if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) {
    made.radius = sphere->radius;
  } else if (const auto* box = std::get_if<Cuboid>(&solid.shape)) {
    made.kind = Primitive::Kind::box;
    made.half = 0.5 * box->size;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&solid.shape)) {
    made.kind = Primitive::Kind::cylinder;
    made.radius = cylinder->radius;
    made.length = 0.5 * cylinder->length;
  } else if (const auto* capsule = std::get_if<Capsule>(&solid.shape)) {
    made.kind = Primitive::Kind::capsule;
    made.radius = capsule->radius;
    made.length = 0.5 * capsule->length;
  } else {
    throw Fault("a mesh is no primitive");
  }
  return made;
}

/// What all checkers of a world share.
std::shared_ptr<const SolidObstacles> obstacles_in(const World3& world) {
  static CacheByWorld<SolidObstacles> cache;
  return cache.get(world, [](const World3& of) {
    SolidObstacles all;
    std::vector<Solid> meshes;
    for (std::size_t i = 0; i < of.obstacles().size(); ++i) {
      const Solid& solid = of.obstacles()[i].solid;
      if (std::holds_alternative<std::shared_ptr<const Mesh>>(solid.shape)) {
        meshes.push_back(solid);
        all.of_mesh.push_back(i);
      } else if (const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&solid.shape)) {
        std::vector<Vec3> points = (*cloud)->points();
        for (Vec3& p : points) p = solid.pose(p);
        all.clouds.push_back({*cloud, solid.pose.inverse(), i, CloudGrid(points, (*cloud)->radius())});
      } else {
        all.primitives.push_back(primitive_of(solid, i));
      }
    }
    if (!meshes.empty()) all.meshes.emplace(meshes, of.surface());
    return all;
  });
}

/// A ball about others, nearly as small as possible: moves the centre to the farthest ball, by less each time (Badoiu
/// and Clarkson 2003).
/// \param best  contains them
BodySphere enclosing(std::span<const BodySphere> balls, BodySphere best) {
  Vec3 centre = best.centre;
  constexpr int steps = 64;
  for (int k = 0; k < steps; ++k) {
    double far = 0.0;
    const BodySphere* farthest = nullptr;
    for (const BodySphere& ball : balls) {
      const double distance = norm(ball.centre - centre) + ball.radius;
      if (distance > far) far = distance, farthest = &ball;
    }
    if (far < best.radius) best = {centre, far};
    if (farthest == nullptr) break;
    const Vec3 towards = farthest->centre - centre;
    const double length = norm(towards);
    if (!(length > 0.0)) break;
    // The farthest point of that ball.
    centre = centre + ((length + farthest->radius) / (length * (k + 2))) * towards;
  }
  // More than rounding, so that it contains the others.
  best.radius *= 1.0 + 1e-12;
  return best;
}

/// Sorts balls so that each eight are near each other: halves them across their longest side.
void group(std::span<kernel::Ball> balls) {
  constexpr std::size_t lanes = kernel::lanes;
  if (balls.size() <= lanes) return;
  double longest = -1.0;
  double kernel::Ball::*along = nullptr;
  for (const auto axis : {&kernel::Ball::x, &kernel::Ball::y, &kernel::Ball::z}) {
    const auto [lo, hi] = std::ranges::minmax(balls, {}, axis);
    if (const double side = hi.*axis - lo.*axis; side > longest) longest = side, along = axis;
  }
  std::ranges::stable_sort(balls, {}, along);
  const std::size_t half = (balls.size() / 2 + lanes - 1) / lanes * lanes;
  group(balls.first(half));
  group(balls.subspan(half));
}

/// Moves the ball to the front about whose centre the ball that contains all is smallest, and returns its radius.
double put_central_first(std::span<kernel::Ball> balls) {
  const auto containing = [&](const kernel::Ball& central) {
    double radius = 0.0;
    for (const kernel::Ball& ball : balls) {
      const Vec3 d{ball.x - central.x, ball.y - central.y, ball.z - central.z};
      radius = std::max(radius, norm(d) + ball.radius);
    }
    return radius;
  };
  const auto central = std::ranges::min_element(balls, {}, containing);
  // More than rounding.
  const double radius = containing(*central) * (1.0 + 1e-12);
  std::iter_swap(balls.begin(), central);
  return radius;
}

/// Adds balls of a body, eight that are near each other to a block.
/// \param first  the number of the first one among the balls of the body
void add_blocks(std::vector<kernel::Ball> balls, std::size_t first, KernelBalls& to) {
  group(balls);
  for (std::size_t begin = 0; begin < balls.size(); begin += kernel::lanes) {
    const std::size_t count = std::min<std::size_t>(kernel::lanes, balls.size() - begin);
    const std::span<kernel::Ball> own = std::span(balls).subspan(begin, count);
    to.radii.push_back(put_central_first(own));
    to.block_begin.push_back(static_cast<unsigned>(first + begin));
    to.balls.insert(to.balls.end(), own.begin(), own.end());
    to.blocks.resize(to.blocks.size() + 4);
    kernel::Lanes* block = &to.blocks[to.blocks.size() - 4];
    for (std::size_t lane = 0; lane < kernel::lanes; ++lane) {
      const kernel::Ball& ball = own[lane < count ? lane : 0];
      block[0].v[lane] = ball.x;
      block[1].v[lane] = ball.y;
      block[2].v[lane] = ball.z;
      block[3].v[lane] = lane < count ? ball.radius : std::numeric_limits<double>::quiet_NaN();
    }
  }
}

using Balls = std::vector<std::vector<BodySphere>>;
using Parts = std::vector<SphereModel::Part>;

KernelBalls make_balls(const Balls& bodies, const Parts& parts) {
  KernelBalls made;
  const auto ball_of = [](const BodySphere& ball) {
    return kernel::Ball{ball.centre.x, ball.centre.y, ball.centre.z, ball.radius};
  };
  auto part = parts.begin();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::vector<BodySphere>& balls = bodies[b];
    const auto first_block = static_cast<unsigned>(made.radii.size());
    made.first_block.push_back(first_block);
    if (balls.empty()) continue;
    const std::span<const BodySphere> own = std::span(balls).subspan(1);
    const kernel::Ball whole = ball_of(enclosing(own, balls.front()));
    made.balls.push_back(whole);
    for (; part != parts.end() && part->body == b; ++part) {
      const std::span<const BodySphere> of_part = std::span(balls).subspan(part->begin, part->count());
      kernel::BallPart& to = made.parts.emplace_back();
      to.body = static_cast<unsigned>(b);
      to.all = part->count() == own.size();
      to.whole = to.all ? whole : ball_of(enclosing(of_part, part->whole));
      to.first_block = static_cast<unsigned>(made.radii.size()) - first_block;
      std::vector<kernel::Ball> copies;
      for (const BodySphere& ball : of_part) copies.push_back(ball_of(ball));
      add_blocks(std::move(copies), part->begin, made);
      to.end_block = static_cast<unsigned>(made.radii.size()) - first_block;
    }
    made.block_begin.push_back(static_cast<unsigned>(balls.size()));
  }
  made.first_block.push_back(static_cast<unsigned>(made.radii.size()));
  return made;
}

/// Those of the last few robots are known: they cost more to make than an easy search.
std::shared_ptr<const KernelBalls> balls_of(const Balls& bodies, const Parts& parts) {
  constexpr std::size_t most = 8;
  struct Known {
    Balls bodies;
    Parts parts;
    std::shared_ptr<const KernelBalls> made;
  };
  static std::mutex mutex;
  static std::vector<Known> known;
  const auto same = [](const BodySphere& a, const BodySphere& b) {
    return a.centre.x == b.centre.x && a.centre.y == b.centre.y && a.centre.z == b.centre.z && a.radius == b.radius;
  };
  const auto alike = [](const SphereModel::Part& a, const SphereModel::Part& b) {
    return a.body == b.body && a.begin == b.begin && a.end == b.end;
  };
  const std::scoped_lock lock(mutex);
  for (const Known& one : known) {
    const auto equal_bodies = [&](const auto& a, const auto& b) { return std::ranges::equal(a, b, same); };
    if (std::ranges::equal(one.parts, parts, alike) && std::ranges::equal(one.bodies, bodies, equal_bodies)) {
      return one.made;
    }
  }
  if (known.size() == most) known.erase(known.begin());
  known.push_back({bodies, parts, std::make_shared<const KernelBalls>(make_balls(bodies, parts))});
  return known.back().made;
}

}  // namespace

double PlacedCloud::distance(const Vec3& p, double at_most) const {
  const double most = at_most + cloud->radius();
  if (!(most > 0.0)) return at_most;
  const double found = cloud->nearest(inverse(p), most).distance;
  return found < most ? found - cloud->radius() : at_most;
}

std::shared_ptr<const SphereScene> SphereScene::of(const std::shared_ptr<const Scene>& scene, double slack) {
  /// A scene as a world, whose copies are one object.
  struct Shared {
    const std::shared_ptr<const Scene>& scene;
    [[nodiscard]] std::shared_ptr<const void> identity() const { return scene; }
  };
  static CacheByWorld<SphereScene> cache;
  return cache.get(Shared{scene}, [&](const Shared& of) { return SphereScene(*of.scene->manipulator(), slack); });
}

SphereScene::SphereScene(const ManipulatorScene& scene, double slack)
    : model_(scene.robot), obstacles_(obstacles_in(scene.world)) {
  add_turns();
  add_levers();
  make_batches(scene.world, slack);
}

void SphereScene::add_turns() {
  for (const Manipulator::Body& body : model_.robot().bodies()) {
    const Vec3& a = body.axis;
    const Matrix3 skew = {0, -a.z, a.y, a.z, 0, -a.x, -a.y, a.x, 0};
    const Matrix3 origin = matrix_of(body.origin.orientation);
    const Matrix3 once = times(origin, skew);
    turns_.push_back({origin, once, times(once, skew)});
  }
}

void SphereScene::add_levers() {
  levers_.resize(model_.bodies().size());
  for (std::size_t b = 0; b < levers_.size(); ++b) {
    if (model_.bodies()[b].empty()) continue;
    double far = 0.0;
    for (const BodySphere& ball : model_.bodies()[b]) far = std::max(far, norm(ball.centre));
    for (std::size_t at = b; at != 0; at = model_.robot().bodies()[at].parent) {
      levers_[b].push_back({at, far});
      far += norm(model_.robot().bodies()[at].origin.position) + model_.robot().extension(at);
    }
  }
  for (const auto& [first, second] : model_.pairs()) {
    const std::size_t a = model_.parts()[first].body;
    const std::size_t b = model_.parts()[second].body;
    std::size_t own = levers_[a].size();
    std::size_t other = levers_[b].size();
    while (own > 0 && other > 0 && levers_[a][own - 1].joint == levers_[b][other - 1].joint) {
      --own;
      --other;
    }
    unshared_.emplace_back(own, other);
  }
}

double SphereScene::longest_path(std::size_t body, View change) const {
  double sum = 0.0;
  for (const Lever& lever : levers_[body]) {
    const Manipulator::Body& joint = model_.robot().bodies()[lever.joint];
    const double by = std::abs(joint.multiplier * change[joint.column]);
    switch (joint.kind) {
      case Joint::Kind::prismatic: sum += by; break;
      case Joint::Kind::planar:
        sum += by + std::abs(change[joint.column + 1]) + std::abs(change[joint.column + 2]) * lever.length;
        break;
      // See Manipulator::change.
      case Joint::Kind::floating: sum += by + std::abs(change[joint.column + 3]) * lever.length; break;
      case Joint::Kind::translation_2:
      case Joint::Kind::translation_3: sum += by; break;
      default: sum += by * lever.length; break;
    }
  }
  return sum;
}

double SphereScene::bend(std::size_t body, std::size_t joints, View change) const {
  double sum = 0.0;
  double turned = 0.0;  // by the joints that carry those of before
  for (std::size_t k = joints; k-- > 0;) {
    const Lever& lever = levers_[body][k];
    const Manipulator::Body& joint = model_.robot().bodies()[lever.joint];
    const std::size_t turn = joint.kind == Joint::Kind::floating ? 3 : joint.kind == Joint::Kind::planar ? 2 : 0;
    const double by = std::abs(joint.multiplier * change[joint.column + turn]);
    if (joint.slides()) {
      // The base carries the joints of whole robots, so `turned` is 0 for their translations.
      sum += by * turned;
    } else {
      sum += by * lever.length * (0.5 * by + turned);
      turned += by;
    }
  }
  return sum;
}

void SphereScene::make_batches(const World3& world, double slack) {
  const auto& bodies = model_.robot().bodies();
  batched_ = !obstacles_->meshes;
  if (!batched_) return;
  balls_ = balls_of(model_.bodies(), model_.parts());
  unsigned centres = 0;
  unsigned bodies_with_balls = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Manipulator::Body& body = bodies[b];
    kernel::ChainBody& made = chain_.emplace_back();
    made.parent = static_cast<unsigned>(body.parent);
    made.slides = body.kind == Joint::Kind::prismatic;
    made.given = body.is_root();
    if (made.given) roots_.push_back(b);
    made.column = static_cast<unsigned>(body.column);
    made.multiplier = body.multiplier;
    made.offset = body.offset;
    std::copy(turns_[b].origin.begin(), turns_[b].origin.end(), made.origin);
    std::copy(turns_[b].once.begin(), turns_[b].once.end(), made.once);
    std::copy(turns_[b].twice.begin(), turns_[b].twice.end(), made.twice);
    const Vec3 axis = BodyFrame{turns_[b].origin, {}}(body.axis);
    const Vec3& p = body.origin.position;
    made.position[0] = p.x;
    made.position[1] = p.y;
    made.position[2] = p.z;
    made.axis[0] = axis.x;
    made.axis[1] = axis.y;
    made.axis[2] = axis.z;
    made.balls = balls_->balls.data() + centres;
    made.ball_count = static_cast<unsigned>(model_.bodies()[b].size());
    made.first_centre = centres;
    centres += made.ball_count;
    made.first_block = balls_->first_block[b];
    made.block_count = balls_->first_block[b + 1] - made.first_block;
    made.ball_blocks = balls_->blocks.data() + std::size_t{4} * made.first_block;
    made.block_radii = balls_->radii.data() + made.first_block;
    // Each body with balls before it has one number more than blocks.
    made.block_begin = balls_->block_begin.data() + made.first_block + bodies_with_balls;
    if (made.ball_count > 0) ++bodies_with_balls;
  }
  for (const Primitive& primitive : obstacles_->primitives) {
    kernel::Solid3& made = solids_.emplace_back();
    made.kind = static_cast<kernel::Solid3::Kind>(primitive.kind);
    std::copy(primitive.r.begin(), primitive.r.end(), made.r);
    made.x = primitive.centre.x;
    made.y = primitive.centre.y;
    made.z = primitive.centre.z;
    made.hx = primitive.half.x;
    made.hy = primitive.half.y;
    made.hz = primitive.half.z;
    made.radius = primitive.radius;
    made.length = primitive.length;
    made.far = primitive.far;
  }
  for (const PlacedCloud& cloud : obstacles_->clouds) clouds_.push_back(cloud.grid.data());
  list_reached(slack);
  add_rows();
  add_solid_blocks();
  for (const auto& [a, b] : model_.pairs()) {
    pairs_.push_back(static_cast<unsigned>(a));
    pairs_.push_back(static_cast<unsigned>(b));
  }
  scene_.solids = solids_.data();
  scene_.solid_count = static_cast<unsigned>(solids_.size());
  scene_.solid_blocks = solid_blocks_.data();
  scene_.solid_block_count = static_cast<unsigned>(solid_blocks_.size());
  scene_.clouds = clouds_.data();
  scene_.cloud_count = static_cast<unsigned>(clouds_.size());
  scene_.reached = reached_.data();
  scene_.parts = balls_->parts.data();
  scene_.pairs = pairs_.data();
  scene_.pair_count = static_cast<unsigned>(model_.pairs().size());
  scene_.slack = slack;
  scene_.bounded = world.contain() == Contain::robot;
  const auto& [lo, hi] = world.bounds();
  for (unsigned k = 0; k < 3; ++k) {
    scene_.lo[k] = k == 0 ? lo.x : k == 1 ? lo.y : lo.z;
    scene_.hi[k] = k == 0 ? hi.x : k == 1 ? hi.y : hi.z;
  }
}

/// Adds the joints by rows.
void SphereScene::add_rows() {
  for (const kernel::ChainBody& body : chain_) {
    kernel::JointRows& rows = rows_.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        rows.origin[4 * i + j] = body.origin[3 * i + j];
        if (body.slides) continue;
        rows.once[4 * i + j] = body.once[3 * i + j];
        rows.twice[4 * i + j] = body.twice[3 * i + j];
      }
      rows.origin[4 * i + 3] = body.position[i];
      if (body.slides) rows.once[4 * i + 3] = body.axis[i];
    }
  }
  for (std::size_t b = 0; b < chain_.size(); ++b) chain_[b].rows = &rows_[b];
}

/// Adds the solids by kind, eight to a block.
void SphereScene::add_solid_blocks() {
  using Kind = kernel::Solid3::Kind;
  constexpr std::size_t values = 15;
  constexpr double far = 1e100;
  for (const Kind kind : {Kind::sphere, Kind::box, Kind::cylinder, Kind::capsule}) {
    unsigned lane = kernel::lanes;
    for (unsigned s = 0; s < solids_.size(); ++s) {
      const kernel::Solid3& solid = solids_[s];
      if (solid.kind != kind) continue;
      if (lane == kernel::lanes) {
        lane = 0;
        solid_blocks_.push_back({.kind = kind});
        solid_values_.resize(solid_values_.size() + values);
        kernel::Lanes* of = &solid_values_[solid_values_.size() - values];
        for (const std::size_t k : {0, 3, 7, 11}) {
          for (double& x : of[k].v) x = k == 0 ? far : 1.0;
        }
      }
      kernel::Lanes* of = &solid_values_[solid_values_.size() - values];
      const bool box = kind == Kind::box;
      const std::array<double, 6> others = {
          solid.x, solid.y, solid.z, box ? solid.hx : solid.radius, box ? solid.hy : solid.length, solid.hz};
      for (std::size_t k = 0; k < 3; ++k) of[k].v[lane] = others[k];
      for (std::size_t k = 0; k < 9; ++k) of[3 + k].v[lane] = solid.r[k];
      for (std::size_t k = 0; k < 3; ++k) of[12 + k].v[lane] = others[3 + k];
      solid_blocks_.back().solid[lane++] = s;
    }
  }
  for (std::size_t k = 0; k < solid_blocks_.size(); ++k) solid_blocks_[k].values = &solid_values_[values * k];
}

/// Lists the solids that each body can touch: those within the lengths of the links that carry it.
void SphereScene::list_reached(double slack) {
  for (std::size_t b = 0; b < chain_.size(); ++b) {
    chain_[b].reached_begin = static_cast<unsigned>(reached_.size());
    const auto& balls = model_.bodies()[b];
    // From the origin of the first joint's frame, which does not move, to the farthest point of a ball.
    double reach = 0.0;
    for (const BodySphere& ball : balls) reach = std::max(reach, norm(ball.centre) + ball.radius);
    std::size_t first = 0;
    for (std::size_t at = b; at != 0; first = at, at = model_.robot().bodies()[at].parent) {
      if (model_.robot().bodies()[at].is_root()) reach = std::numeric_limits<double>::infinity();
      if (first != 0) reach += norm(model_.robot().bodies()[first].origin.position);
      reach += model_.robot().extension(at);
    }
    const Vec3 from = model_.base()(first == 0 ? Vec3{} : model_.robot().bodies()[first].origin.position);
    // More than rounding: what is left out must be out of reach.
    constexpr double more = 1e-6;
    for (const Primitive& primitive : obstacles_->primitives) {
      if (balls.empty() || primitive.distance(from) > reach + slack + more) continue;
      reached_.push_back(static_cast<unsigned>(&primitive - obstacles_->primitives.data()));
    }
    chain_[b].reached_end = static_cast<unsigned>(reached_.size());
  }
}

void ConfigurationMemory::set(std::size_t body, const BodyFrame& frame) {
  Rows& rows = frames_[body];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) rows.of[4 * i + j] = frame.r[3 * i + j];
  }
  rows.of[3] = frame.p.x;
  rows.of[7] = frame.p.y;
  rows.of[11] = frame.p.z;
}

ConfigurationMemory::ConfigurationMemory(const SphereScene& scene, const BodyFrame& base)
    : angles_(3 * ((scene.chain().size() + kernel::lanes - 1) / kernel::lanes)),
      frames_(scene.chain().size()),
      placed_(scene.chain().size()),
      centres_(3 * scene.block_count()) {
  placed_[0] = 1;
  set(0, base);
  // Contact is likelier far from the base.
  for (std::size_t b = scene.chain().size(); b-- > 1;) {
    if (scene.chain()[b].ball_count > 0) order_.push_back(static_cast<unsigned>(b));
  }
  memory_ = {angles_.data(),  frames_[0].of.data(), placed_.data(),
             centres_.data(), order_.data(),        static_cast<unsigned>(order_.size())};
}

}  // namespace trellis
