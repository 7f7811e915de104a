// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/team.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/instance/verified_motions.hpp>
#include <trellis/motion/team_model.hpp>
#include <trellis/planner/composed.hpp>

namespace trellis {

namespace {

struct TeamPathSettings : PathGuideSettings {
  TeamPathSettings() { follow = Follow::waypoints; }
  std::vector<std::string> order;
  std::int64_t tries = 64;
  std::int64_t robot_effort = 5000;
  bool windows = true;
};

Settings<TeamPathSettings> with_team_options(Settings<TeamPathSettings> settings) {
  return with_path_options(std::move(settings))
      .integer("effort", &TeamPathSettings::robot_effort, "proposals", Range::at_least(1),
               "budget of each search, of a robot or of when the robots move")
      .integer("tries", &TeamPathSettings::tries, "tries", {.lo = 1, .hi = 1000},
               "how often it begins anew where a search found nothing");
}

const Settings<TeamPathSettings>& decouple_settings() {
  static const auto settings = with_team_options(Settings<TeamPathSettings>(
      Component::Kind::guide, "decouple",
      "each robot of a team finds a path alone, as if the others were not there; then all move along their paths, and "
      "how far each one is at a time is searched, a coordinate for each robot. Robots that cannot pass each other on "
      "these paths have no such path: `couple` joins them",
      "Kant and Zucker 1986, path and velocity decomposition; Simeon, Leroy and Laumond 2002, coordination along fixed "
      "paths"));
  return settings;
}

const Settings<TeamPathSettings>& prioritise_settings() {
  static const auto settings =
      with_team_options(
          Settings<TeamPathSettings>(
              Component::Kind::guide, "prioritise",
              "the robots of a team one after another: each one is searched together with how far those before it are "
              "along the path found for them, so that every search has the coordinates of one robot and one more. "
              "Where a robot finds no path, it plans earlier. Robots with motion models never go back along that path",
              "Erdmann and Lozano-Perez 1987, On multiple moving objects; van den Berg and Overmars 2005"))
          .names("order", &TeamPathSettings::order,
                 "the numbers of robots, the first to plan first; those that are not named follow in the order of the "
                 "team")
          .positional({"order"});
  return settings;
}

const Settings<TeamPathSettings>& couple_settings() {
  static const auto settings =
      with_team_options(Settings<TeamPathSettings>(
                            Component::Kind::guide, "couple",
                            "as decouple; robots that cannot pass each other on their paths plan together: where = "
                            "\"path\" makes them one "
                            "group, until all groups pass or all are one; where = \"conflict\" changes their paths "
                            "only for a while about "
                            "each conflict, while the others move along theirs",
                            "Standley 2010, independence detection; Wagner and Choset 2015, subdimensional expansion; "
                            "Solis et al. 2024, adaptive robot coordination"))
          .choice("where", &TeamPathSettings::windows, {{"path", false}, {"conflict", true}},
                  "which part of their paths robots in conflict plan together: \"path\", all of it; \"conflict\", that "
                  "about the conflict, and more of it where that has no solution");
  return settings;
}

/// h along the trajectory found: from the last state of it that the planner has reached, under the control found there.
/// So the planner drives it again, to the same states.
class ReplayHeuristic final : public Wrapping<Heuristic, Heuristic> {
 public:
  /// \param along  h without controls, once the end is reached
  ReplayHeuristic(std::string name, Space space, const Solution& found, std::unique_ptr<Heuristic> along)
      : Wrapping(std::move(along)),
        name_(std::move(name)),
        space_(std::move(space)),
        states_(found.path),
        trajectory_(found.trajectory) {}

  Source sample(Stream& stream, MutableView out) override {
    replays_ = at_ + 1 < states_.size() && !blocked();
    if (!replays_) {
      part()->sample(stream, out);
      return 1;
    }
    const View here = std::as_const(states_)[at_];
    std::copy(here.begin(), here.end(), out.begin());
    return 0;
  }
  [[nodiscard]] std::uint32_t vertex() const override { return replays_ ? row_ : Wrapping::vertex(); }

  std::uint32_t draw_control(Stream& stream, const ControlQuery& query, MutableView control) override {
    if (!replays_) return Wrapping::draw_control(stream, query, control);
    if (!std::ranges::equal(query.from, std::as_const(states_)[at_])) return 0;
    const View u = std::as_const(trajectory_.controls)[piece_];
    std::copy(u.begin(), u.end(), control.begin());
    wanted_ = std::min(trajectory_.steps[piece_] - used_, query.longest);
    return wanted_;
  }

  void observe(const Outcome& outcome, bool mine) override {
    const bool replayed = mine && replays_;
    Wrapping::observe(outcome, mine && !replays_);
    if (!replayed) return;
    if (wanted_ == 0) {
      ++failures_;
      return;
    }
    const std::uint32_t done = std::exchange(wanted_, 0U);
    if (outcome.added.empty() || !std::ranges::equal(outcome.added, std::as_const(states_)[at_ + done])) {
      ++failures_;
      return;
    }
    failures_ = 0;
    for (std::uint32_t k = 0; k < done; ++k) {
      length_ += space_.distance(std::as_const(states_)[at_ + k], std::as_const(states_)[at_ + k + 1]);
    }
    at_ += done;
    row_ = outcome.added_row;
    used_ += done;
    if (used_ < trajectory_.steps[piece_]) return;
    used_ = 0;
    ++piece_;
  }

  void restart() override {
    Wrapping::restart();
    at_ = piece_ = 0;
    used_ = 0;
    row_ = no_node;
    wanted_ = 0;
  }
  [[nodiscard]] double progress() const override { return length_; }
  [[nodiscard]] double connected() const override { return length_; }
  void record(DensityRecord& record, double share) const override {
    if (at_ + 1 < states_.size()) {
      record.add_atoms(share);
    } else {
      part()->record(record, share);
    }
  }
  [[nodiscard]] std::uint64_t epoch() const override { return Wrapping::epoch() + at_; }
  [[nodiscard]] std::vector<std::string> sources() const override { return {name_, name_ + ": beyond"}; }
  [[nodiscard]] bool stale() const override { return blocked() || part()->stale(); }
  [[nodiscard]] Configurations lifted_path() const override { return part()->lifted_path(); }

 private:
  [[nodiscard]] Guidance* drew_last() const override { return replays_ ? nullptr : part(); }
  /// Whether the trajectory is valid no more.
  [[nodiscard]] bool blocked() const {
    constexpr int most = 3;
    return failures_ >= most;
  }

  std::string name_;
  Space space_;
  Configurations states_;  ///< after each step
  Trajectory trajectory_;
  std::size_t at_ = 0;           ///< the state that is reached
  std::size_t piece_ = 0;        ///< the control from there on
  std::uint32_t used_ = 0;       ///< steps under it so far
  std::uint32_t wanted_ = 0;     ///< steps that were drawn last
  std::uint32_t row_ = no_node;  ///< of the state that is reached; none of the start
  double length_ = 0.0;
  int failures_ = 0;     ///< draws since it last got farther
  bool replays_ = true;  ///< the last sample was a state of the trajectory
};

/// S = C: the instance is solved by dividing it by robots, and the path of the team guides.
class TeamPath final : public PathGuide {
 public:
  TeamPath(std::string name, const TeamPathSettings& settings)
      : PathGuide(name, settings), named_(std::move(name)), windows_(named_ == "couple" && settings.windows) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    if (parent.scene->members().size() < 2) {
      throw Error(
          fmt::format("{}: needs a team, as robots {{ robot.disc(0.3), robot.disc(0.3) }}, and robot '{}' is one",
                      named_, parent.scene->robot_name()));
    }
    if (parent.motion_model) check_driven(*parent.motion_model);
    if (parent.validity_of || parent.scene->robot_dimension() > parent.space.dimension()) {
      throw Error(fmt::format("{}: needs a space whose axes are the robots'; those of {} are not", named_,
                              parent.space.name()));
    }
    return same_instance(parent);
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    // The motions of the path were checked among all robots.
    if (found->solved() && parent.validity->spends_checks()) {
      if (!parent.verified) parent.verified = std::make_shared<VerifiedMotions>();
      parent.verified->hold_at(parent.epoch());
      for (std::size_t i = 0; i + 1 < found->path.size(); ++i) {
        const View from = found->path[i];
        const View to = found->path[i + 1];
        if (!parent.validity->enters_excluded(from, to)) parent.verified->add(from, to);
      }
    }
    auto along = PathGuide::heuristic(parent, sub, found);
    if (!found->solved() || found->trajectory.steps.empty()) return along;
    return std::make_unique<ReplayHeuristic>(named_, parent.space, *found, std::move(along));
  }

 protected:
  [[nodiscard]] bool relaxes() const override { return false; }

 private:
  /// \throws Error for robots that cannot be driven one after the other
  void check_driven(const MotionModel& model) const {
    const TeamModel* team = team_model(model);
    if (team == nullptr) throw Fault("the motion model of a team is not one of a team");
    if (windows_) {
      throw Error(
          "couple: robots with motion models leave their paths about no conflict, since they could not join them "
          "again; "
          "use couple { where = \"path\" } or prioritise(), or drop the motion models first, as couple() >> "
          "holonomic() >> kinodynamic_rrt {}");
    }
    for (std::size_t i = 0; i < team->parts().size(); ++i) {
      const MotionModel& one = *team->parts()[i].model;
      if (can_wait(one)) continue;
      throw Error(fmt::format(
          "{0}: robots wait for each other, and robot {1}, a {2}, cannot: {3}; plan for all robots at once, by "
          "kinodynamic_rrt without {0}, or drop the motion models first, as {0}() >> holonomic() >> kinodynamic_rrt "
          "{{}}",
          named_, i + 1, one.name(),
          one.velocities().empty() ? "its least speed is above 0" : "a control of 0 keeps the speed of its state"));
    }
  }

  std::string named_;
  bool windows_;  ///< robots plan together only about conflicts
};

GuideKind kind_of(const Settings<TeamPathSettings>& (*settings)(), std::string no_path,
                  std::unique_ptr<Guide> (*make)(const Options&), std::int64_t (*resolves)(const Options&)) {
  GuideClaims claims = path_claims(GuideClaims::Category::robot,
                                   "q -> q, in the instance of the whole team; the search of S divides it by robots",
                                   std::move(no_path), "examples/many_robots.lua");
  claims.h =
      "the points of the team's path found in S in turn, whose motions were checked among all robots and are not "
      "checked again";
  claims.needs = GuideClaims::Needs::team;
  GuideKind kind{&settings().component(), make, "rrt_connect", resolves, std::move(claims)};
  kind.divides_team = true;
  kind.planar = {.run = {40}};
  kind.spatial = {.run = {60}};
  return kind;
}

}  // namespace

std::vector<std::size_t> axes_of(const std::vector<TeamMember>& members, const std::vector<std::size_t>& chosen) {
  std::vector<std::size_t> axes;
  for (const std::size_t i : chosen) axes.insert(axes.end(), members[i].axes.begin(), members[i].axes.end());
  std::sort(axes.begin(), axes.end());
  return axes;
}

std::vector<std::size_t> members_named(const std::string& owner, const std::vector<std::string>& numbers,
                                       const std::vector<TeamMember>& members) {
  std::vector<std::size_t> chosen;
  for (const std::string& number : numbers) {
    const auto it = std::find_if(members.begin(), members.end(),
                                 [&](const TeamMember& member) { return std::to_string(member.number) == number; });
    if (it == members.end()) {
      std::vector<std::size_t> known;
      known.reserve(members.size());
      for (const TeamMember& member : members) known.push_back(member.number);
      throw Error(fmt::format("{}: no robot {} in the team, which has {}", owner, number, fmt::join(known, ", ")));
    }
    const auto member = static_cast<std::size_t>(it - members.begin());
    if (std::find(chosen.begin(), chosen.end(), member) != chosen.end()) {
      throw Error(fmt::format("{}: robot {} is there twice", owner, number));
    }
    chosen.push_back(member);
  }
  return chosen;
}

TeamDivision division_of(const std::string& guide, const Options& options, const std::vector<TeamMember>& members) {
  TeamDivision division;
  const bool ordered = guide == "prioritise";
  const TeamPathSettings settings = ordered             ? prioritise_settings().read(options)
                                    : guide == "couple" ? couple_settings().read(options)
                                                        : decouple_settings().read(options);
  division.how = ordered             ? Coordination::order
                 : guide != "couple" ? Coordination::alone
                 : settings.windows  ? Coordination::windows
                                     : Coordination::conflicts;
  division.effort = settings.robot_effort;
  division.tries = settings.tries;
  division.order = members_named(guide, settings.order, members);
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (std::find(division.order.begin(), division.order.end(), i) == division.order.end()) {
      division.order.push_back(i);
    }
  }
  return division;
}

GuideKind decouple_kind() {
  return kind_of(
      decouple_settings, "a robot finds no path alone, or the robots cannot pass each other on their paths",
      [](const Options& o) -> std::unique_ptr<Guide> {
        return std::make_unique<TeamPath>("decouple", decouple_settings().read(o));
      },
      [](const Options& o) { return decouple_settings().read(o).resolves; });
}

GuideKind prioritise_kind() {
  return kind_of(
      prioritise_settings, "a robot finds no path among those before it, in any order tried",
      [](const Options& o) -> std::unique_ptr<Guide> {
        return std::make_unique<TeamPath>("prioritise", prioritise_settings().read(o));
      },
      [](const Options& o) { return prioritise_settings().read(o).resolves; });
}

GuideKind couple_kind() {
  return kind_of(
      couple_settings, "a group of robots finds no path within its budget",
      [](const Options& o) -> std::unique_ptr<Guide> {
        return std::make_unique<TeamPath>("couple", couple_settings().read(o));
      },
      [](const Options& o) { return couple_settings().read(o).resolves; });
}

}  // namespace trellis
