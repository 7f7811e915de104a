// SPDX-License-Identifier: GPL-3.0-or-later
// Samplers of known divergence that fill the target, or leave parts of it empty, for the interval that samples support.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "verify/measure_cases.hpp"

namespace trellis::verify {

/// A straight tube of radius 0.5 and length 8 in 2 (the plane), 3 (SE(2), all headings), 6 and 7 dimensions (R^n).
class StraightTube {
 public:
  explicit StraightTube(std::size_t dimension) : d_(dimension) {
    if (d_ == 3) {
      space_ = Space::se2({0, 10}, {0, 10});
    } else {
      std::vector<std::pair<double, double>> bounds = {{0, 10}, {0, 10}};
      bounds.resize(d_, {4.0, 6.0});
      space_ = Space::euclidean(bounds);
    }
  }

  [[nodiscard]] std::shared_ptr<const Target> target(std::uint64_t seed) const {
    Configuration from(d_, 5.0);
    Configuration to(d_, 5.0);
    if (d_ == 3) from[2] = to[2] = 0.0;
    from[0] = first;
    to[0] = first + length;
    TubeSettings settings;
    settings.delta = radius;
    if (d_ > 3) settings.distance = TubeSettings::Distance::full;
    settings.points = 512;
    return std::make_shared<const Target>(space_, path_of({from, to}), std::vector<std::size_t>{0, 1}, settings,
                                          anywhere, seed);
  }

  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] bool has_heading() const { return d_ == 3; }
  /// The dimension of a section across the path, headings left out, and of the tube.
  [[nodiscard]] std::size_t across() const { return d_ == 3 ? 1 : d_ - 1; }
  /// The share of the target that a cylinder of a smaller radius about the path fills.
  [[nodiscard]] double share(double smaller) const {
    return std::pow(smaller / radius, static_cast<double>(across())) * cylinder_share();
  }
  [[nodiscard]] double cylinder_share() const {
    const double cylinder = ball(across()) * length;
    return cylinder / (cylinder + ball(across() + 1) * radius);
  }

  /// Draws uniformly from a cylinder about the path.
  void draw_cylinder(Stream& s, MutableView x, double smaller) const {
    const std::vector<double> off = in_ball(s, across(), smaller);
    x[0] = s.uniform(first, first + length);
    for (std::size_t j = 0; j < off.size(); ++j) x[1 + j] = 5.0 + off[j];
    if (has_heading()) x[2] = s.uniform(-std::numbers::pi, std::numbers::pi);
  }
  /// Draws from the target.
  void draw(Stream& s, MutableView x) const {
    draw_cylinder(s, x, radius);
    if (s.uniform() < cylinder_share()) return;
    const std::vector<double> off = in_ball(s, across() + 1, radius);
    x[0] = (off[0] < 0.0 ? first : first + length) + off[0];
    for (std::size_t j = 1; j < off.size(); ++j) x[j] = 5.0 + off[j];
  }

  static constexpr double radius = 0.5;
  static constexpr double length = 8.0;
  static constexpr double first = 1.0;

 private:
  static std::vector<double> in_ball(Stream& s, std::size_t dimension, double r) {
    std::vector<double> v(dimension);
    double squares = 0.0;
    for (double& one : v) {
      one = s.normal();
      squares += one * one;
    }
    const double scale = r * std::pow(s.uniform(), 1.0 / static_cast<double>(dimension)) / std::sqrt(squares);
    for (double& one : v) one *= scale;
    return v;
  }

  std::size_t d_;
  Space space_ = Space::euclidean({{0, 1}});
};

/// A part of the target and the mass of Q in it, spread evenly.
struct Part {
  double share;
  double mass;
};

struct SupportedCase {
  std::string name;
  std::string kind;  ///< thin, thick, split, atomic, uniform
  std::function<void(Stream&, MutableView)> draw;
  double truth = 0.0;  ///< SE
};

inline std::vector<SupportedCase> supported_cases(std::size_t dimension) {
  const StraightTube tube(dimension);
  const double uniform = tube.target(1)->uniform();
  const double cylinder = tube.cylinder_share();
  using Draw = std::function<void(Stream&, MutableView)>;
  std::vector<SupportedCase> cases;
  /// The rest of the target has no mass.
  const auto add = [&](const std::string& name, const std::string& kind, const Draw& draw,
                       const std::vector<Part>& parts) {
    const double mixed = uniform_mix * std::exp(-uniform);
    double truth = 0.0;
    double rest = 1.0;
    for (const Part& part : parts) {
      truth -= part.share * std::log((1.0 - uniform_mix) * part.mass / part.share + mixed);
      rest -= part.share;
    }
    cases.push_back({name, kind, draw, truth - rest * std::log(mixed)});
  };
  const Draw all = [tube](Stream& s, MutableView x) { tube.draw(s, x); };
  const auto within = [tube](double r) {
    return Draw([tube, r](Stream& s, MutableView x) { tube.draw_cylinder(s, x, r); });
  };
  const auto moved = [tube](const auto& along) {
    return Draw([tube, along](Stream& s, MutableView x) {
      tube.draw_cylinder(s, x, StraightTube::radius);
      x[0] = StraightTube::first + StraightTube::length * along(s.uniform());
    });
  };
  const double mass = std::exp(-uniform);
  add("T itself", "uniform", all, {{1.0, 1.0}});
  add("uniform on C", "uniform", [tube](Stream& s, MutableView x) { tube.space().sample_uniform(s, x); },
      {{1.0, mass}});
  add("30 % in T, evenly, the others far away", "thick",
      [tube](Stream& s, MutableView x) {
        tube.draw(s, x);
        if (s.uniform() < 0.7) x[1] = s.uniform(0.0, 2.0);
      },
      {{1.0, 0.3}});
  for (const double r : {0.1, 0.3, 0.6, 0.85}) {
    const double radius = r * StraightTube::radius;
    add(fmt::format("a tube of {:g} radii", r), "thin", within(radius), {{tube.share(radius), 1.0}});
  }
  const double third = 0.3 * StraightTube::radius;
  add("80 % in a tube of 0.3 radii, 20 % even", "thin",
      [tube, third](Stream& s, MutableView x) {
        tube.draw_cylinder(s, x, s.uniform() < 0.8 ? third : StraightTube::radius);
      },
      {{tube.share(third), 0.8 + 0.2 * tube.share(third) / cylinder},
       {cylinder - tube.share(third), 0.2 * (1.0 - tube.share(third) / cylinder)}});
  if (dimension == 3) {
    // Guidance that proposes headings along the path only.
    const auto box = [&](double width, double heading, double waves) {
      const double share = cylinder * width / (2.0 * StraightTube::radius) * heading / (2.0 * std::numbers::pi);
      add(fmt::format("{:g} m x {:g} rad{}", width, heading, waves > 0.0 ? ", in waves" : ""), "thin",
          [=](Stream& s, MutableView x) {
            x[0] = s.uniform(1.0, 9.0);
            x[1] = 5.0 + waves * std::sin(x[0]) + width * (s.uniform() - 0.5);
            x[2] = waves * 3.0 * std::cos(x[0]) + heading * (s.uniform() - 0.5);
          },
          {{share, 1.0}});
    };
    box(0.3, 0.8, 0.0);
    box(0.3, 0.8, 0.3);
    box(0.6, 2.4, 0.0);
  }
  add("the first half of the path", "split", moved([](double u) { return 0.5 * u; }), {{0.5 * cylinder, 1.0}});
  add("both ends, a fifth missing between", "split", moved([](double u) { return u < 0.5 ? 0.8 * u : 0.2 + 0.8 * u; }),
      {{0.8 * cylinder, 1.0}});
  add("three pieces, a quarter missing", "split", moved([](double u) {
        return u < 1.0 / 3 ? 0.75 * u : u < 2.0 / 3 ? 0.125 + 0.75 * u : 0.25 + 0.75 * u;
      }),
      {{0.75 * cylinder, 1.0}});
  add("one side of the path", "split",
      [tube](Stream& s, MutableView x) {
        tube.draw_cylinder(s, x, StraightTube::radius);
        x[1] = 5.0 + std::abs(x[1] - 5.0);
      },
      {{0.5 * cylinder, 1.0}});
  const double quarter = 0.25 * StraightTube::radius;
  add("two tubes of a quarter of the radius", "split",
      [tube, quarter](Stream& s, MutableView x) {
        tube.draw_cylinder(s, x, quarter);
        x[1] += s.uniform() < 0.5 ? -2.0 * quarter : 2.0 * quarter;
      },
      {{2.0 * tube.share(quarter), 1.0}});
  std::vector<Configuration> atoms(10, Configuration(dimension));
  Stream stream(dimension, "", "atoms");
  for (Configuration& atom : atoms) tube.draw(stream, atom);
  const auto atomic = [&](double share, const Draw& rest) {
    return Draw([=](Stream& s, MutableView x) {
      const Configuration& atom = atoms[s.below(atoms.size())];
      if (s.uniform() < share) {
        std::copy(atom.begin(), atom.end(), x.begin());
      } else {
        rest(s, x);
      }
    });
  };
  add("10 points", "atomic", atomic(1.0, all), {});
  add("10 points with 50 %, T with 50 %", "atomic", atomic(0.5, all), {{1.0, 0.5}});
  add("10 points with 20 %, a tube of 0.3 radii", "atomic", atomic(0.2, within(third)), {{tube.share(third), 0.8}});
  return cases;
}

/// The results for one case and number of samples.
struct SupportedResult {
  double lo = 0.0, hi = 0.0;     ///< means
  std::size_t printed = 0;       ///< repetitions whose interval is not blank
  std::size_t missed = 0;        ///< of these, those that do not hold the truth
  std::size_t missed_blank = 0;  ///< the same of the blank ones
};

/// \param seeds  one target and one set of samples for each
/// \param rough  whether the interval uses fewer samples and points, as those of single runs do
inline SupportedResult supported_result(std::size_t dimension, const SupportedCase& c, std::size_t samples,
                                        std::size_t first_seed, std::size_t seeds, bool rough = false) {
  constexpr double accuracy = 0.01;  // of the volume of the target
  const StraightTube tube(dimension);
  // Several sets of points of the target, as every run has its own.
  std::vector<std::shared_ptr<const Target>> targets;
  for (std::size_t i = 0; i < std::min<std::size_t>(seeds, 5); ++i) targets.push_back(tube.target(first_seed + i));
  SupportedResult result;
  for (std::size_t seed = first_seed; seed < first_seed + seeds; ++seed) {
    const auto& target = targets[seed % targets.size()];
    Stream stream(seed, c.name, "supported case");
    Configurations rows(dimension);
    Configuration x(dimension);
    for (std::size_t i = 0; i < samples; ++i) {
      c.draw(stream, x);
      rows.push(x);
    }
    const Efficiency e = efficiency(*target, rows, {.headline_only = true, .rough_interval = rough, .points = 64});
    result.lo += e.value_lo / static_cast<double>(seeds);
    result.hi += e.value_hi / static_cast<double>(seeds);
    const bool blank = !blank_reason(e.value_lo, e.value_hi, e.uniform).empty();
    const bool held = e.value_lo <= c.truth + accuracy && c.truth - accuracy <= e.value_hi;
    if (!blank) ++result.printed;
    if (!held) ++(blank ? result.missed_blank : result.missed);
  }
  return result;
}

}  // namespace trellis::verify
