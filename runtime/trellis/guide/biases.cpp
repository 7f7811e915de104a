// SPDX-License-Identifier: GPL-3.0-or-later
// Guides with S = {0}: sampling biases.
#include <cmath>
#include <limits>

#include <trellis/base/error.hpp>
#include <trellis/guide/bias.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/instance/search_cost.hpp>

namespace trellis {

namespace {

struct UniformSettings {};
struct GoalBiasSettings {
  double share = 0.05;
};
struct NearObstacleSettings {
  double sigma = 0.5;
  std::int64_t tries = 100;
};

const Settings<UniformSettings>& uniform_settings() {
  static const Settings<UniformSettings> settings(Component::Kind::guide, "uniform",
                                                  "uniform proposals: S = {0}, no guidance", "Attali et al. 2022");
  return settings;
}

const Settings<GoalBiasSettings>& goal_bias_settings() {
  static const Settings<GoalBiasSettings> settings =
      Settings<GoalBiasSettings>(Component::Kind::guide, "goal_bias",
                                 "the goal itself with a share of the proposals, uniform with the rest: S = {0}",
                                 "LaValle and Kuffner 2001")
          .number("share", &GoalBiasSettings::share, "share of proposals", Range::share(), "share that is the goal")
          .positional({"share"});
  return settings;
}

Settings<NearObstacleSettings> near_obstacle(Settings<NearObstacleSettings> settings) {
  return settings
      .number("sigma", &NearObstacleSettings::sigma, "m in the metric", Range::positive(),
              "standard deviation, per axis, of the distance between the two configurations of a pair")
      .integer("tries", &NearObstacleSettings::tries, "pairs", Range::at_least(1),
               "pairs tried before a uniform proposal is made instead")
      .positional({"sigma"});
}

const Settings<NearObstacleSettings>& gaussian_settings() {
  static const Settings<NearObstacleSettings> settings =
      near_obstacle({Component::Kind::guide, "gaussian",
                     "valid configurations near invalid ones: of a pair at Gaussian distance with one of each, the "
                     "valid one; S = {0}",
                     "Boor, Overmars and van der Stappen 1999"});
  return settings;
}

const Settings<NearObstacleSettings>& bridge_test_settings() {
  static const Settings<NearObstacleSettings> settings =
      near_obstacle({Component::Kind::guide, "bridge_test",
                     "valid middles of short bridges between two invalid configurations: narrow passages; S = {0}",
                     "Hsu, Jiang, Reif and Sun 2003"});
  return settings;
}

class GoalBias final : public Heuristic {
 public:
  GoalBias(const Instance& parent, double share) : uniform_(parent.space), goal_(parent), share_(share) {}
  Source sample(Stream& stream, MutableView out) override {
    if (stream.uniform() < share_) return goal_.sample(stream, out);
    uniform_.sample(stream, out);
    return 1;
  }
  void record(DensityRecord& record, double share) const override {
    record.add_atoms(share * share_);
    uniform_.record(record, share * (1.0 - share_));
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"goal_bias: goal", "goal_bias: uniform"}; }

 private:
  UniformGuidance uniform_;
  GoalGuidance goal_;
  double share_;
};

/// Gaussian sampling and the bridge test. They check pairs of configurations; the parent's instance counts the checks.
class NearObstacle final : public Heuristic {
 public:
  enum class Test : std::uint8_t { gaussian, bridge };
  NearObstacle(Instance& parent, const NearObstacleSettings& settings, Test test)
      : parent_(parent),
        settings_(settings),
        test_(test),
        a_(parent.space.dimension()),
        b_(parent.space.dimension()),
        tangent_(parent.space.degrees()) {}

  Source sample(Stream& stream, MutableView out) override {
    const auto& space = parent_.space;
    for (std::int64_t i = 0; i < settings_.tries; ++i) {
      parent_.spend(search_cost::coordinate * static_cast<double>(a_.size() + b_.size()));
      space.sample_uniform(stream, a_);
      if (space.flat()) {
        for (std::size_t j = 0; j < b_.size(); ++j) {
          b_[j] = a_[j] + settings_.sigma * stream.normal() / space.axes()[j].weight;
        }
      } else {
        for (double& x : tangent_) x = settings_.sigma * stream.normal();
        space.exp(a_, tangent_, b_);
      }
      space.normalise(b_);
      if (!space.contains(b_)) continue;
      if (test_ == Test::gaussian) {
        const bool a_valid = parent_.valid(a_);
        if (a_valid == parent_.valid(b_)) continue;
        const Configuration& q = a_valid ? a_ : b_;
        std::copy(q.begin(), q.end(), out.begin());
        return 0;
      }
      if (parent_.valid(a_) || parent_.valid(b_)) continue;
      space.interpolate(a_, b_, 0.5, out);
      if (parent_.valid(out)) return 0;
    }
    space.sample_uniform(stream, out);
    return 1;
  }
  [[nodiscard]] std::vector<std::string> sources() const override {
    const std::string name = test_ == Test::gaussian ? "gaussian" : "bridge_test";
    return {name, name + ": uniform"};
  }

 private:
  Instance& parent_;
  NearObstacleSettings settings_;
  Test test_;
  Configuration a_;
  Configuration b_;
  std::vector<double> tangent_;
};

}  // namespace

GuideKind sampling_kind(const Component& component, std::unique_ptr<Guide> (*make)(const Options&), std::string h,
                        std::string density, bool closed_form, std::string feedback) {
  GuideKind kind{&component, make, "", [](const Options&) { return std::int64_t{0}; }};
  kind.planar = kind.spatial = {.run = {10}};
  GuideClaims& claims = kind.claims;
  claims.category = GuideClaims::Category::sampling;
  claims.f = "S = {0}";
  claims.h = std::move(h);
  claims.closed_form = closed_form;
  claims.density = std::move(density);
  claims.feedback = std::move(feedback);
  claims.invalid_ends = "nothing is projected";
  claims.no_path = "nothing is searched";
  claims.example = "examples/samplers.lua";
  return kind;
}

GuideKind uniform_kind() {
  return sampling_kind(
      uniform_settings().component(),
      [](const Options&) -> std::unique_ptr<Guide> {
        return bias([](Instance& parent) -> std::unique_ptr<Heuristic> {
          return std::make_unique<UniformHeuristic>("uniform", parent.space);
        });
      },
      "uniform on C", "of C's volume", true);
}

GuideKind goal_bias_kind() {
  return sampling_kind(
      goal_bias_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return bias([share = goal_bias_settings().read(o).share](Instance& parent) -> std::unique_ptr<Heuristic> {
          return std::make_unique<GoalBias>(parent, share);
        });
      },
      "the goal with probability `share`, else uniform on C", "of the uniform part; the goal is an atom", true);
}

GuideKind gaussian_kind() {
  return sampling_kind(
      gaussian_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return bias([settings = gaussian_settings().read(o)](Instance& parent) -> std::unique_ptr<Heuristic> {
          return std::make_unique<NearObstacle>(parent, settings, NearObstacle::Test::gaussian);
        });
      },
      "the valid one of a pair at Gaussian distance of which the other is invalid; the pair's checks are C's",
      "it would need the share of C near q that is invalid", false);
}

GuideKind bridge_test_kind() {
  return sampling_kind(
      bridge_test_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return bias([settings = bridge_test_settings().read(o)](Instance& parent) -> std::unique_ptr<Heuristic> {
          return std::make_unique<NearObstacle>(parent, settings, NearObstacle::Test::bridge);
        });
      },
      "the valid middle of a pair at Gaussian distance that is invalid at both ends; the pair's checks are C's",
      "it would need the share of C about q that is invalid on both sides", false);
}

}  // namespace trellis
