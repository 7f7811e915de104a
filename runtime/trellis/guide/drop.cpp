// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/changing_world.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

namespace {

struct DropSettings : PathGuideSettings {
  DropSettings() { resolves = 100; }
  std::vector<std::string> obstacles;
};

const Settings<DropSettings>& drop_settings() {
  static const Settings<DropSettings> settings = with_path_options(
      Settings<DropSettings>(
          Component::Kind::guide, "drop",
          "the world without some of its obstacles; each returns when C finds that it blocks the path",
          "Bayazit, Xie and Amato 2005, Iterative relaxation of constraints; with feedback as in "
          "Bohlin and Kavraki 2000")
          .names("obstacles", &DropSettings::obstacles,
                 "names of obstacles that are left out, as the world gives them (name = ...) or messages (\"obstacle "
                 "3\"); none: all")
          .positional({"obstacles"}));
  return settings;
}

class Drop final : public PathGuide {
 public:
  explicit Drop(const DropSettings& settings) : PathGuide("drop", settings), names_(settings.obstacles) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    const Scene& scene = *parent.scene;
    for (const auto& name : names_) require(scene, name);
    for (std::size_t i = 0; i < scene.obstacle_count(); ++i) {
      const auto named = [&](const std::string& name) { return is_called(scene.obstacle_name(i), name); };
      if (names_.empty() || std::any_of(names_.begin(), names_.end(), named)) dropped_.push_back(i);
    }
    validity_ = std::make_shared<ChangingWorld>(parent, parent.scene->with_obstacles(kept(parent)));
    left_out_ = std::make_unique<ChangingWorld>(parent, parent.scene->with_obstacles(dropped_));
    instance->validity = validity_;
    instance->scene = validity_->scene();
    return instance;
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    auto h = PathGuide::heuristic(parent, sub, found);
    parent_ = &parent;
    path_ = found->path;
    vertices_ = NearestIndex(parent.space);
    longest_ = 0.0;
    for (std::size_t i = 0; i < path_.size(); ++i) {
      vertices_->add(std::as_const(path_)[i]);
      if (i > 0) longest_ = std::max(longest_, parent.space.distance(path_[i - 1], path_[i]));
    }
    return h;
  }

  /// A configuration beside the path that C found invalid may be due to a dropped obstacle. S restores the obstacle
  /// before its next solve; immediately if the path collides with it there. Obstacles elsewhere remain dropped.
  void learn(const Outcome& outcome) override {
    PathGuide::learn(outcome);
    if (outcome.blocked_at.empty() || dropped_.empty() || path_heuristic() == nullptr) return;
    const std::vector<std::size_t> legs = legs_beside(outcome.blocked_at);
    if (legs.empty()) return;
    if (bring_back(outcome.blocked_at) && runs_into_what_is_back(legs)) path_heuristic()->refute();
  }

  void before_resolve() override {
    if (const auto place = take_refuted()) bring_back(*place);
    if (back_.empty()) return;
    back_.clear();
    validity_->set(parent_->scene->with_obstacles(kept(*parent_)));
    // The guide of the search of S uses the same obstacles.
    sub_->scene = validity_->scene();
  }
  void attach(Instance& sub) override {
    PathGuide::attach(sub);
    sub_ = &sub;
  }

 protected:
  [[nodiscard]] bool excludes() const override { return false; }

 private:
  /// Restores the dropped obstacles at q, one after another. Returns whether there was one. Each test is a validity
  /// check in C.
  bool bring_back(View q) {
    bool found = false;
    while (!dropped_.empty()) {
      const auto hit = parent_->check_one([&] { return left_out_->contact(q); });
      if (!hit || !hit->obstacle) break;
      back_.push_back(dropped_[*hit->obstacle]);
      dropped_.erase(dropped_.begin() + static_cast<std::ptrdiff_t>(*hit->obstacle));
      left_out_->set(parent_->scene->with_obstacles(dropped_));
      found = true;
    }
    return found;
  }

  /// The name that the script gave the obstacle: "left door" of "obstacle 3 (left door)".
  static std::string given_name(const std::string& obstacle) {
    const std::size_t open = obstacle.find(" (");
    if (open == std::string::npos || !obstacle.ends_with(')')) return obstacle;
    return obstacle.substr(open + 2, obstacle.size() - open - 3);
  }
  static bool is_called(const std::string& obstacle, const std::string& name) {
    return obstacle == name || given_name(obstacle) == name || obstacle.starts_with(name + " (");
  }

  static void require(const Scene& scene, const std::string& name) {
    std::vector<std::string> known;
    known.reserve(scene.obstacle_count());
    for (std::size_t i = 0; i < scene.obstacle_count(); ++i) {
      const std::string& obstacle = scene.obstacle_name(i);
      if (is_called(obstacle, name)) return;
      known.push_back(given_name(obstacle));
    }
    throw Error(fmt::format("drop: the world has no obstacle '{}'{}; it has: {}", name, did_you_mean(name, known),
                            fmt::join(known, ", ")));
  }

  /// The obstacles of S at its next solve.
  [[nodiscard]] std::vector<std::size_t> kept(const Instance& parent) const {
    std::vector<std::size_t> rest;
    for (std::size_t i = 0; i < parent.scene->obstacle_count(); ++i) {
      if (std::find(dropped_.begin(), dropped_.end(), i) == dropped_.end()) rest.push_back(i);
    }
    return rest;
  }

  /// The edges of the path within twice its tube's radius of q.
  [[nodiscard]] std::vector<std::size_t> legs_beside(View q) {
    const double reach = 2.0 * path_heuristic()->radius();
    // An end of such an edge is at most half the edge farther from q than the edge is.
    constexpr double rounding = 1.0 + 1e-9;
    vertices_->within(q, (reach + 0.5 * longest_) * rounding, near_);
    std::vector<std::size_t> legs;
    std::size_t next = 0;
    for (const auto& vertex : near_) {
      for (std::size_t i = std::max<std::size_t>(next, vertex.id > 0 ? vertex.id - 1 : 0);
           i <= vertex.id && i + 1 < path_.size(); ++i) {
        const Foot foot = nearest_on_motion(parent_->space, path_[i], path_[i + 1], q);
        if (foot.squared_distance <= reach * reach) legs.push_back(i);
        next = i + 1;
      }
    }
    return legs;
  }

  bool runs_into_what_is_back(const std::vector<std::size_t>& legs) {
    ChangingWorld back(*parent_, parent_->scene->with_obstacles(back_));
    for (const std::size_t i : legs) {
      const MotionReport report =
          parent_->check_motion([&] { return back.motion(std::as_const(path_)[i], std::as_const(path_)[i + 1]); });
      if (!report.valid) return true;
    }
    return false;
  }

  std::vector<std::string> names_;
  std::vector<std::size_t> dropped_;  ///< obstacles of the parent's world that S lacks, or will lack at its next solve
  std::vector<std::size_t> back_;     ///< obstacles restored since the last solve of S
  Instance* parent_ = nullptr;
  Instance* sub_ = nullptr;
  Configurations path_;                   ///< found in S
  std::optional<NearestIndex> vertices_;  ///< of the path
  double longest_ = 0.0;                  ///< length of the path's longest edge
  std::vector<NearestIndex::Neighbour> near_;
  std::shared_ptr<ChangingWorld> validity_;  ///< validity in S
  std::unique_ptr<ChangingWorld> left_out_;  ///< the robot among only the dropped obstacles
};

}  // namespace

GuideKind drop_kind() {
  GuideClaims claims =
      path_claims(GuideClaims::Category::environment, "q -> q, without the obstacles named",
                  "S has no path; a start or goal that is valid in C stays valid", "examples/drop.lua");
  claims.feedback =
      "an obstacle that C hit beside the path returns before S is solved again, which is at once where "
      "the path runs into it";
  return GuideKind{
      &drop_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Drop>(drop_settings().read(o)); },
      "rrt_connect", [](const Options& o) { return drop_settings().read(o).resolves; }, std::move(claims)}
      .set_up({.run = {90, 0.5}}, {.run = {430, 9}});
}

}  // namespace trellis
