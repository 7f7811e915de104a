// SPDX-License-Identifier: GPL-3.0-or-later
// Samplers whose divergence from a target is known, in closed form or to high precision.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <trellis/measure/efficiency.hpp>

namespace trellis::verify {

struct Case {
  std::string name;
  std::string what;
  std::shared_ptr<const Target> target;
  /// The same target with other evaluation points: a common error of all repetitions would look like bias.
  std::function<std::shared_ptr<const Target>(std::uint64_t)> remake;
  std::function<void(Stream&, MutableView)> draw;
  double d = 0.0;              ///< D(T || Q)
  double d_regularised = 0.0;  ///< SE, eps = 0.05
  bool standard = false;       ///< one of the four that the required error is taken over
  bool mendable = true;        ///< false: no estimator can be right

  [[nodiscard]] Configurations samples(std::size_t count, std::uint64_t repetition) const {
    Stream stream(repetition, name, "verify");
    Configurations rows(target->space().dimension());
    rows.reserve(count);
    Configuration x(target->space().dimension());
    for (std::size_t i = 0; i < count; ++i) {
      draw(stream, x);
      rows.push(x);
    }
    return rows;
  }
};

inline Configurations path_of(const std::vector<Configuration>& points) {
  Configurations path(points.front().size());
  for (const auto& p : points) path.push(p);
  return path;
}

inline bool anywhere(View) { return true; }

/// Volume of the unit ball.
inline double ball(std::size_t d) { return std::exp(log_unit_ball(d)); }

/// SE where Q has the density q throughout A.
inline double constant_regularised(double log_a, double log_c, double q) {
  return -log_a - std::log((1.0 - uniform_mix) * q + uniform_mix * std::exp(-log_c));
}

/// D and SE of a known density, over all points of a large target.
inline std::pair<double, double> integrate(const Target& target, const std::function<double(View)>& density) {
  double plain = 0.0;
  double regularised = 0.0;
  const double u = std::exp(-target.space().log_volume());
  const auto n = static_cast<double>(target.pool().size());
  for (std::size_t i = 0; i < target.pool().size(); ++i) {
    const double q = density(target.pool()[i]);
    plain += (target.log_density(i) - std::log(q)) / n;
    regularised += (target.log_density(i) - std::log((1.0 - uniform_mix) * q + uniform_mix * u)) / n;
  }
  return {plain, regularised};
}

/// Gaussian noise about the edges of a tree in the plane, and uniform: what an RRT's nodes look like, with a density.
class TreeLike {
 public:
  explicit TreeLike(Space space) : space_(std::move(space)) {
    for (const auto& e : edges) length_ += std::hypot(e[2] - e[0], e[3] - e[1]);
  }
  void draw(Stream& stream, MutableView q) const {
    space_.sample_uniform(stream, q);
    if (stream.uniform() < uniform) return;
    double u = stream.uniform(0.0, length_);
    for (const auto& e : edges) {
      const double l = std::hypot(e[2] - e[0], e[3] - e[1]);
      if (u < l) {
        q[0] = e[0] + (e[2] - e[0]) * u / l + sd * stream.normal();
        q[1] = e[1] + (e[3] - e[1]) * u / l + sd * stream.normal();
        break;
      }
      u -= l;
    }
    space_.reflect(q);
  }
  [[nodiscard]] double density(View x) const {
    double sum = 0.0;
    const double root2 = std::numbers::sqrt2;
    for (const auto& e : edges) {
      const double l = std::hypot(e[2] - e[0], e[3] - e[1]);
      const double ux = (e[2] - e[0]) / l;
      const double uy = (e[3] - e[1]) / l;
      for (const double px : {x[0], -x[0], 20.0 - x[0]}) {
        for (const double py : {x[1], -x[1], 20.0 - x[1]}) {
          const double along = (px - e[0]) * ux + (py - e[1]) * uy;
          const double across = -(px - e[0]) * uy + (py - e[1]) * ux;
          sum += std::exp(-0.5 * across * across / (sd * sd)) / (sd * std::sqrt(2.0 * std::numbers::pi)) * 0.5 *
                 (std::erf(along / sd / root2) - std::erf((along - l) / sd / root2));
        }
      }
    }
    const double plane = std::exp(space_.log_volume()) / 100.0;  // what the other axes span
    return uniform * std::exp(-space_.log_volume()) + (1.0 - uniform) * sum / length_ / plane;
  }

 private:
  static constexpr double uniform = 0.3;
  static constexpr double sd = 0.3;
  static constexpr std::array<std::array<double, 4>, 8> edges = {{{1, 1, 3, 2.2},
                                                                  {3, 2.2, 5.5, 4.5},
                                                                  {3, 2.2, 2, 6},
                                                                  {2, 6, 4, 9},
                                                                  {5.5, 4.5, 8, 3},
                                                                  {8, 3, 9.5, 1},
                                                                  {5.5, 4.5, 7, 6},
                                                                  {4, 9, 8, 9}}};
  Space space_;
  double length_ = 0.0;
};

/// The four standard cases in the plane (d = 2) or SE(2) (d = 3): uniform, elsewhere, tree-like, and T itself, on a
/// bent tube with an obstacle in it.
inline std::vector<Case> standard_cases(std::size_t d) {
  const Space space = d == 2 ? Space::euclidean({{0, 10}, {0, 10}}) : Space::se2({0, 10}, {0, 10});
  std::vector<Configuration> points = {{1, 1, 0}, {4, 3, 2}, {7, 6, -2}};
  for (auto& p : points) p.resize(d);
  const auto valid = [](View x) { return !(x[0] > 3.5 && x[0] < 4.5 && x[1] > 3.1 && x[1] < 4.0); };
  TubeSettings fine;
  fine.pool = 1 << 18;
  const Target large(space, path_of(points), {0, 1}, fine, valid, 11);
  const auto make = [=](std::uint64_t seed) {
    return std::make_shared<const Target>(space, path_of(points), std::vector<std::size_t>{0, 1}, TubeSettings{}, valid,
                                          seed);
  };
  const auto target = make(7);
  const double log_c = space.log_volume();
  const double u = std::exp(-log_c);
  const std::string where = d == 2 ? "R^2" : "SE(2)";
  std::vector<Case> cases;
  cases.push_back({"uniform, " + where, "uniform on C", target, make,
                   [space](Stream& s, MutableView x) { space.sample_uniform(s, x); }, large.uniform(), large.uniform(),
                   true});
  const auto elsewhere = [u](View x) { return u * (0.5 + (x[0] > 7 ? 0.5 / 0.3 : 0.0)); };
  auto [d1, e1] = integrate(large, elsewhere);
  cases.push_back({"elsewhere, " + where,
                   "half uniform, half beyond the end of the path (a jump of density in the tube)", target, make,
                   [space](Stream& s, MutableView x) {
                     space.sample_uniform(s, x);
                     if (s.uniform() < 0.5) x[0] = s.uniform(7, 10);
                   },
                   d1, e1, true});
  const TreeLike tree(space);
  auto [d2, e2] = integrate(large, [&](View x) { return tree.density(x); });
  cases.push_back({"tree-like, " + where, "Gaussian noise about the edges of a tree, and 30 % uniform", target, make,
                   [tree](Stream& s, MutableView x) { tree.draw(s, x); }, d2, e2, true});
  cases.push_back({"T itself, " + where, "the target", target, make,
                   [space, target](Stream& s, MutableView x) {
                     do space.sample_uniform(s, x);
                     while (!target->contains(x));
                   },
                   0.0, constant_regularised(large.log_volume(), log_c, std::exp(-large.log_volume())), true});
  return cases;
}

/// Cases with a closed form.
inline std::vector<Case> closed_cases() {
  std::vector<Case> cases;
  const double pi = std::numbers::pi;
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  const double log_c = plane.log_volume();
  const auto uniform_on = [](const Space& space) {
    return [space](Stream& s, MutableView x) { space.sample_uniform(s, x); };
  };
  const auto tube = [&](const Space& space, const std::vector<Configuration>& points, double delta,
                        std::string_view distance) {
    TubeSettings settings;
    settings.delta = delta;
    settings.distance = distance == "planar" ? TubeSettings::Distance::planar : TubeSettings::Distance::full;
    return [=](std::uint64_t seed) {
      return std::make_shared<const Target>(space, path_of(points), std::vector<std::size_t>{0, 1}, settings, anywhere,
                                            seed);
    };
  };
  const auto add_uniform = [&](const std::string& name, const std::string& what, const auto& make, double volume) {
    const auto target = make(3);
    const double truth = target->space().log_volume() - std::log(volume);
    cases.push_back({name, what, target, make, uniform_on(target->space()), truth, truth});
  };

  const auto make_capsule = tube(plane, {{1, 5}, {9, 5}}, 0.5, "planar");
  const auto capsule = make_capsule(3);
  const double capsule_volume = 8 + 0.25 * pi;
  add_uniform("capsule, uniform", "|A| = 2 delta L + pi delta^2", make_capsule, capsule_volume);
  // A turn of phi adds an outer sector and takes the inner overlap.
  const double phi = 0.5 * pi;
  add_uniform("bent tube, uniform", "right angle: |A| = 2 delta L + pi delta^2 + delta^2 (phi / 2 - tan(phi / 2))",
              tube(plane, {{2, 2}, {7, 2}, {7, 7}}, 0.5, "planar"),
              10 + 0.25 * pi + 0.25 * (0.5 * phi - std::tan(0.5 * phi)));
  add_uniform("tube on a wall, uniform", "cut in half: |A| = delta L + pi delta^2 / 2",
              tube(plane, {{0, 2}, {0, 8}}, 0.5, "planar"), 0.5 * 6 + 0.125 * pi);
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const double length = std::hypot(6.0, (2 * pi - 6.0) / pi);
  add_uniform("SE(2) across the wrap, uniform", "theta from 3 to -3: |A| = pi delta^2 L + 4/3 pi delta^3",
              tube(se2, {{2, 5, 3.0}, {8, 5, -3.0}}, 0.5, "full"), pi * 0.25 * length + 4.0 / 3.0 * pi * 0.125);
  const Space cube = Space::euclidean(std::vector<std::pair<double, double>>(6, {0.0, 1.0}));
  Configuration from(6, 0.5);
  Configuration to(6, 0.5);
  from[0] = 0.45;
  to[0] = 0.55;
  add_uniform("R^6, uniform", "|A| = V5 delta^5 L + V6 delta^6", tube(cube, {from, to}, 0.45, "full"),
              ball(5) * std::pow(0.45, 5) * 0.1 + ball(6) * std::pow(0.45, 6));

  cases.push_back({"capsule, T itself", "the target", capsule, make_capsule,
                   [capsule](Stream& s, MutableView x) {
                     do {
                       x[0] = s.uniform(0.5, 9.5);
                       x[1] = s.uniform(4.5, 5.5);
                     } while (!capsule->contains(x));
                   },
                   0.0, constant_regularised(std::log(capsule_volume), log_c, 1.0 / capsule_volume)});

  // Gaussian against Gaussian, far from the walls of a large square.
  const Space wide = Space::euclidean({{-10, 10}, {-10, 10}});
  const double s0 = 0.8;
  const double s1 = 1.5;
  const double shift = 1.0;
  const auto log_normal = [pi](View x, double at, double sd) {
    return -0.5 * ((x[0] - at) * (x[0] - at) + x[1] * x[1]) / (sd * sd) - std::log(2 * pi * sd * sd);
  };
  const auto make_bell = [=](std::uint64_t seed) {
    Target::Distribution gaussian{Configurations(2), [=](View x) { return log_normal(x, 0.0, s0); }};
    Stream stream(seed, "", "gaussian target");
    for (int i = 0; i < 16384; ++i) {
      gaussian.samples.push(std::vector<double>{s0 * stream.normal(), s0 * stream.normal()});
    }
    return std::make_shared<const Target>(Target::distribution(wide, TargetSettings{}, gaussian));
  };
  const auto bell = make_bell(5);
  double regularised = 0.0;
  for (std::size_t i = 0; i < bell->pool().size(); ++i) {
    const View x = bell->pool()[i];
    regularised += log_normal(x, 0.0, s0) - std::log((1 - uniform_mix) * std::exp(log_normal(x, shift, s1)) +
                                                     uniform_mix * std::exp(-wide.log_volume()));
  }
  cases.push_back({"Gaussian from a Gaussian", "D = log(s1^2/s0^2) + (2 s0^2 + m^2) / (2 s1^2) - 1", bell, make_bell,
                   [=](Stream& s, MutableView x) {
                     x[0] = shift + s1 * s.normal();
                     x[1] = s1 * s.normal();
                   },
                   2 * std::log(s1 / s0) + (2 * s0 * s0 + shift * shift) / (2 * s1 * s1) - 1,
                   regularised / static_cast<double>(bell->pool().size())});

  cases.push_back({"atom at the goal", "uniform, and the goal itself with 10 %: D = uniform - log 0.9", capsule,
                   make_capsule,
                   [plane](Stream& s, MutableView x) {
                     plane.sample_uniform(s, x);
                     if (s.uniform() < 0.1) {
                       x[0] = 9;
                       x[1] = 5;
                     }
                   },
                   log_c - std::log(capsule_volume) - std::log(0.9),
                   constant_regularised(std::log(capsule_volume), log_c, 0.9 * std::exp(-log_c))});

  const double bound = std::log(1 / uniform_mix) + log_c - std::log(capsule_volume);
  cases.push_back({"disjoint", "uniform where x2 > 7: D = inf, SE = log(1/eps) + uniform", capsule, make_capsule,
                   [plane](Stream& s, MutableView x) {
                     plane.sample_uniform(s, x);
                     x[1] = s.uniform(7, 10);
                   },
                   std::numeric_limits<double>::infinity(), bound});
  // Half of the tube at the density of T on that half, nothing on the other.
  const double half = 0.5 * constant_regularised(std::log(capsule_volume), log_c, 2.0 / capsule_volume) + 0.5 * bound;
  Case one{"half covered",
           "T on one half of the tube, nothing on the other: D = inf",
           capsule,
           make_capsule,
           [capsule](Stream& s, MutableView x) {
             do {
               x[0] = s.uniform(0.5, 5);
               x[1] = s.uniform(4.5, 5.5);
             } while (!capsule->contains(x));
           },
           std::numeric_limits<double>::infinity(),
           half};
  one.mendable = false;
  cases.push_back(std::move(one));
  return cases;
}

/// Tubes of bodies in space: 30 % of the samples are draws of the target, evenly along the path or 80 % of them in its
/// first half, the others uniform in C. Nothing is lost across the path, so the bound by mass and arc length is the
/// divergence.
inline std::vector<Case> spatial_cases() {
  const Space se3 = Space::se3({{{0, 10}, {0, 10}, {0, 10}}}, 0.5);
  const Space with_joint = Space::product({{1.0, se3}, {0.5, Space::so2(1.0)}});
  const double root = std::sqrt(0.5);
  std::vector<Case> cases;
  for (const Space& space : {se3, with_joint}) {
    const std::string name = space == se3 ? "SE(3)" : "R^3 x SO(3) x S^1";
    Configurations path(space.dimension());
    for (Configuration q : {Configuration{2, 3, 5, 0, 0, 0, 1, -1}, Configuration{5, 5, 5, 0, 0, root, root, 0},
                            Configuration{7, 4, 6, 0.5, 0.5, 0.5, 0.5, 1}}) {
      q.resize(space.dimension());
      path.push(q);
    }
    TubeSettings settings;
    settings.distance = TubeSettings::Distance::full;
    const auto make = [space, path, settings](std::uint64_t seed) {
      return std::make_shared<const Target>(space, path, std::vector<std::size_t>{}, settings, anywhere, seed);
    };
    const auto target = make(3);
    const double middle = 0.5 * target->length();
    double first = 0.0;  // the share of the target nearest to the first half of the path
    const auto n = static_cast<double>(target->pool().size());
    for (std::size_t i = 0; i < target->pool().size(); ++i) {
      first += target->along(target->pool()[i]) < middle ? 1.0 / n : 0.0;
    }
    for (const double early : {first, 0.8}) {
      constexpr double guided = 0.3;
      const double u = std::exp(-space.log_volume());
      const double t = std::exp(-target->log_volume());
      const std::array<double, 2> density = {(1.0 - guided) * u + guided * t * early / first,
                                             (1.0 - guided) * u + guided * t * (1.0 - early) / (1.0 - first)};
      const auto mean = [&](const auto& term) { return first * term(density[0]) + (1.0 - first) * term(density[1]); };
      const bool even = early == first;
      cases.push_back(
          {fmt::format("{}, {}", name, even ? "even" : "skewed"),
           even ? "30 % in the target, evenly" : "30 % in the target, of these 80 % in the first half of the path",
           target, make,
           [=](Stream& stream, MutableView x) {
             if (stream.uniform() >= guided) return space.sample_uniform(stream, x);
             const bool before = even || stream.uniform() < early;
             while (true) {
               const Configurations drawn = target->draw(1, stream);
               if (!even && (target->along(drawn[0]) < middle) != before) continue;
               std::copy(drawn[0].begin(), drawn[0].end(), x.begin());
               return;
             }
           },
           mean([&](double q) { return std::log(t / q); }),
           mean([&](double q) { return constant_regularised(target->log_volume(), space.log_volume(), q); })});
    }
  }
  return cases;
}

/// The error of log|A| where the volume of a tube with rotations has a closed form.
inline double worst_volume_error(std::size_t seeds) {
  const double pi = std::numbers::pi;
  const double w = 0.5;
  const double delta = 0.5;
  const Space space = Space::so3(w);
  Configurations turn(4);
  turn.push(std::vector{0.0, 0.0, 0.0, 1.0});
  turn.push(std::vector{0.0, std::sin(0.5), 0.0, std::cos(0.5)});
  const double a = delta / w;
  // A cylinder about a turn of one radian, and half a ball of rotations at each end.
  const double volume = w * w * w * (2.0 * pi * (1.0 - std::cos(a)) + 8.0 * pi * (a - std::sin(a)));
  TubeSettings settings;
  settings.distance = TubeSettings::Distance::full;
  settings.delta = delta;
  double worst = 0.0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const Target target(space, turn, {}, settings, anywhere, seed);
    worst = std::max(worst, std::abs(target.log_volume() - std::log(volume)));
  }
  return worst;
}

}  // namespace trellis::verify
