// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/results/quantities.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

using enum Better;

constexpr Quantity of_run(const char* key, const char* unit, Better better, const char* meaning) {
  return {"", key, "", unit, better, meaning};
}

constexpr bool clock = true;
constexpr auto of_runs = std::to_array<RunQuantity>({
    {of_run("validity_checks", "", less,
            "configurations whose validity was decided, those on motions included, at all levels"),
     &RunTotals::validity_checks},
    {of_run("motion_checks", "", less, "motions checked, at all levels; each takes several validity checks"),
     &RunTotals::motion_checks},
    {of_run("improvement_checks", "", none,
            "part of validity_checks: those of an anytime planner after its first path; 0 of others"),
     &RunTotals::improvement_checks},
    {of_run("shortcut_checks", "", none, "validity checks that shortcutting spent; not in validity_checks"),
     &RunTotals::shortcut_checks},
    {of_run("path_checks", "", none, "configurations checked to certify the paths found; not in validity_checks"),
     &RunTotals::path_checks},
    {of_run("work", "units", less,
            "CPU time by a model in units of 0.07 us, at all levels: validity checks, proposals, searches of graphs, "
            "the set-up of guides"),
     &RunTotals::work},
    {of_run("set_up_work", "units", less,
            "the work to set up the guides for this run alone, of which work counts one part in queries where it "
            "depends on the world alone"),
     &RunTotals::set_up},
    {of_run("time_s", "s", less, "wall clock of the run; neither scoring nor shared_set_up_s is in it"),
     &RunTotals::seconds, clock},
    {of_run("cpu_s", "s", less,
            "CPU time of the threads that planned: set-up and planning of all levels; neither scoring nor "
            "shared_set_up_s is in it"),
     &RunTotals::cpu_seconds, clock},
    {of_run("lua_s", "s", none,
            "part of cpu_s: functions of guides in Lua with what they call, and loading their script. Calls are timed "
            "by the wall clock, so it is their share of time_s, times cpu_s"),
     &RunTotals::lua_seconds, clock},
    {of_run("set_up_s", "s", less, "part of time_s: the time to set up the guides"), &RunTotals::set_up_seconds, clock},
    {of_run("shared_set_up_s", "s", none,
            "the time of the set-ups that depend on the world alone and that this run uses, whichever run computed "
            "them; not in time_s, cpu_s and set_up_s"),
     &RunTotals::shared_set_up_seconds, clock},
    {of_run("path_cpu_s", "s", none, "CPU time of the paths' certificates; not in time_s and cpu_s"),
     &RunTotals::path_seconds, clock},
    {of_run("length", "m", less, "length of the path in the metric, after shortcutting"), &RunTotals::length},
    {of_run("clearance", "m", more,
            "a lower bound on the robot's distance from contact along the path, at most a tenth below the least "
            "distance"),
     &RunTotals::clearance},
    {of_run("refuted_paths", "", none, "paths found that these path_checks refuted, after which the search continued"),
     &RunTotals::refuted_paths},
});

constexpr std::array of_teams = {
    Quantity{"times", "makespan", "", "s", less,
             "of a team: when the last robot is at its goal, at 1 m/s at most; as driven by motion models"},
    Quantity{"times", "sum_of_costs", "", "s", less,
             "of a team: the sum over robots of the time until it is at its goal and stays there"},
    Quantity{"couplings", "conflicts", "", "runs", none,
             "of robots of a team: runs in which they touch on their paths where all robots pass through each other "
             "during the search"},
    Quantity{"couplings", "conflict_checks", "", "", less,
             "of robots of a team: validity checks of all runs, from when a guide that divides the team found their "
             "conflicts until they were resolved"},
    Quantity{"couplings", "needed", "", "share", none,
             "of robots of a team: the share of the seeds solved whose path touches, or is missing, where these robots "
             "pass through each other during the search"},
    Quantity{
        "couplings", "check_ratio", "", "", less,
        "of robots of a team: validity checks divided by those where these robots pass through each other, median; "
        "a path that touches costs infinitely much"}};

}  // namespace

std::span<const RunQuantity> run_quantities() { return of_runs; }

std::vector<Quantity> quantities() {
  std::vector<Quantity> all(of_runs.begin(), of_runs.end());
  all.insert(all.end(), of_teams.begin(), of_teams.end());
  all.insert(all.end(), measure_quantities.begin(), measure_quantities.end());
  return all;
}

std::string described(const Quantity& quantity) {
  std::string text = quantity.unit;
  if (quantity.better != none) {
    text += (text.empty() ? "" : ", ") + std::string(quantity.better == less ? "less is better" : "more is better");
  }
  return text.empty() ? quantity.meaning : text + ": " + quantity.meaning;
}

Quantity quantity(std::string_view name) {
  for (const Quantity& one : quantities()) {
    if (one.name() == name) return one;
  }
  throw Fault(fmt::format("no quantity is called '{}'", name));
}

}  // namespace trellis
