// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/quantities.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// \param of  returns the field of an efficiency, which may be constant
template <class Of>
constexpr MeasureQuantity stored(Quantity quantity, Of /*of*/, Interval Figure::*over_runs = nullptr,
                                 bool in_table = false) {
  return {quantity,
          [](const Efficiency& e) -> double { return Of{}(e); },
          [](Efficiency& e) -> double& { return Of{}(e); },
          over_runs,
          false,
          in_table};
}

/// One that each estimator has.
template <class Of>
constexpr MeasureQuantity estimated(Quantity quantity, Of of, Interval Figure::*over_runs = nullptr,
                                    bool in_table = false) {
  MeasureQuantity result = stored(quantity, of, over_runs, in_table);
  result.of_estimate = true;
  return result;
}

constexpr MeasureQuantity computed(Quantity quantity, double (*of)(const Efficiency&)) {
  return {quantity, of, nullptr, nullptr, false, false};
}

/// The ends of the 95 % interval of the part `mass` of D_eps.
double mass_lo(const Efficiency& e) { return regularised_mass(e.mass_lo, e.uniform); }
double mass_hi(const Efficiency& e) { return regularised_mass(e.mass_hi, e.uniform); }

using enum Better;
constexpr const char* eps_parts = "D_eps_parts";
constexpr const char* d_parts = "D_parts";

// Of two that have the same interval in summaries (mass), the later one's values are averaged.
constexpr auto of_measure = std::to_array<MeasureQuantity>({
    estimated(
        {"", "D", "D(T‖Q)", "nats", less,
         "the divergence with nothing mixed in: infinite where a part of the target has no sample"},
        [](auto& e) -> auto& { return e.unregularised; }, &Figure::unregularised),
    estimated(
        {d_parts, "mass", "-log Q(A)", "nats", less, "the part of D that says how seldom a sample lies in the target"},
        [](auto& e) -> auto& { return e.unregularised_parts.mass; }, &Figure::mass),
    estimated(
        {d_parts, "spread", "", "nats", less, "the rest of D: how unevenly the samples in the target cover it"},
        [](auto& e) -> auto& { return e.unregularised_parts.spread; }, &Figure::spread),
    estimated(
        {d_parts, "along", "", "nats", less,
         "the part of the spread of D along the path: the divergence of arc length"},
        [](auto& e) -> auto& { return e.unregularised_parts.along; }),
    estimated(
        {d_parts, "across", "", "nats", less, "the part of the spread of D across the path; none from 5 dimensions on"},
        [](auto& e) -> auto& { return e.unregularised_parts.across; }),
    estimated(
        {"", "D_eps", "SE_T(Q)", "nats", less,
         "sampling efficiency, the divergence of the samples with 5 % uniform ones mixed in, so that it is finite"},
        [](auto& e) -> auto& { return e.value; }, &Figure::value, true),
    estimated(
        {eps_parts, "mass", "", "nats", less,
         "the part of D_eps that says how seldom a sample lies in the target. It is counted, and exact"},
        [](auto& e) -> auto& { return e.parts.mass; }, &Figure::mass_part, true),
    estimated(
        {eps_parts, "spread", "", "nats", less, "the rest of D_eps: how unevenly the samples in the target cover it"},
        [](auto& e) -> auto& { return e.parts.spread; }, &Figure::spread_part),
    estimated(
        {eps_parts, "along", "", "nats", less, "the part of the spread of D_eps along the path"},
        [](auto& e) -> auto& { return e.parts.along; }, &Figure::along_part),
    estimated(
        {eps_parts, "across", "", "nats", less, "the part of the spread of D_eps across the path"},
        [](auto& e) -> auto& { return e.parts.across; }, &Figure::across_part),
    computed({eps_parts, "mass_lo", "", "nats", less, "the lower end of the 95 % interval of D_eps_parts.mass"},
             mass_lo),
    computed({eps_parts, "mass_hi", "", "nats", less, "the upper end of the 95 % interval of D_eps_parts.mass"},
             mass_hi),
    computed({eps_parts, "spread_lo", "", "nats", less,
              "the lower end of the interval of D_eps_parts.spread that follows from those of D_eps and of its mass: "
              "with 90 % at least"},
             [](const Efficiency& e) { return e.value_lo - std::min(mass_hi(e), e.value_lo); }),
    computed({eps_parts, "spread_hi", "", "nats", less, "the upper end of that interval"},
             [](const Efficiency& e) { return e.value_hi - std::min(mass_lo(e), e.value_hi); }),
    stored(
        {"", "D_eps_lo", "", "nats", less,
         "the lower end of the 95 % interval of D_eps that the samples support: counting certifies it"},
        [](auto& e) -> auto& { return e.value_lo; }, &Figure::value_lo, true),
    stored(
        {"", "D_eps_hi", "", "nats", less,
         "the upper end of that interval, which allows for what so many samples cannot show"},
        [](auto& e) -> auto& { return e.value_hi; }, &Figure::value_hi, true),
    computed({"", "scale", "", "", less,
              "D_eps from 0, perfect guidance, to 1, uniform sampling: (D_eps - D_perfect) / (D_uniform - D_perfect)"},
             [](const Efficiency& e) { return on_scale(e.value, e.perfect, e.uniform); }),
    computed({"", "scale_lo", "", "", less, "D_eps_lo on that scale"},
             [](const Efficiency& e) { return on_scale(e.value_lo, e.perfect, e.uniform); }),
    computed({"", "scale_hi", "", "", less, "D_eps_hi on that scale"},
             [](const Efficiency& e) { return on_scale(e.value_hi, e.perfect, e.uniform); }),
    stored(
        {"", "D_perfect", "", "nats", none, "D_eps of perfect guidance, samples of the target itself"},
        [](auto& e) -> auto& { return e.perfect; }, &Figure::perfect),
    stored(
        {"", "D_uniform", "", "nats", none, "the divergence of uniform sampling"},
        [](auto& e) -> auto& { return e.uniform; }, &Figure::uniform, true),
    estimated(
        {"", "gain", "", "nats", more, "nats above uniform sampling: D_uniform - D_eps"},
        [](auto& e) -> auto& { return e.gain; }, &Figure::gain),
    stored(
        {"", "D_mass", "-log Q(A)", "nats", less, "-log of the share of the samples in the target"},
        [](auto& e) -> auto& { return e.mass; }, &Figure::mass),
    stored(
        {"", "D_mass_lower95", "", "nats", less,
         "the lower bound of D_mass with 95 % confidence (Clopper and Pearson), which D cannot be below"},
        [](auto& e) -> auto& { return e.mass_lower95; }, &Figure::mass_lower95),
    stored(
        {"", "D_mass_lo", "", "nats", less, "the lower end of the two-sided 95 % interval of D_mass"},
        [](auto& e) -> auto& { return e.mass_lo; }),
    stored(
        {"", "D_mass_hi", "", "nats", less,
         "the upper end of that interval; infinite where no sample lies in the target"},
        [](auto& e) -> auto& { return e.mass_hi; }),
    stored(
        {"", "coverage", "", "share", more, "share of the target within delta of a sample (full metric)"},
        [](auto& e) -> auto& { return e.coverage; }, &Figure::coverage, true),
    stored(
        {"", "free_share", "", "share", none, "valid share of the tube"}, [](auto& e) -> auto& { return e.free_share; },
        &Figure::free_share),
    stored(
        {"along", "D", "", "nats", less, "the divergence of where along the path the samples in the target lie"},
        [](auto& e) -> auto& { return e.along.divergence; }, &Figure::along),
    stored(
        {"along", "empty_share", "", "share", less, "share of the target in parts of the path without a sample"},
        [](auto& e) -> auto& { return e.along.empty_share; }, &Figure::empty_share),
    stored(
        {"along", "D_corrected", "", "nats", less, "along.D without its bias for few samples"},
        [](auto& e) -> auto& { return e.along.corrected; }),
    stored(
        {"along", "D_eps", "", "nats", less, "along.D_corrected of the samples with 5 % uniform ones mixed in"},
        [](auto& e) -> auto& { return e.along.regularised; }),
});

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
    {of_run("time_s", "s", less, "wall clock of the run; scoring is not in it"), &RunTotals::seconds, clock},
    {of_run("cpu_s", "s", less,
            "CPU time of the threads that planned: set-up and planning of all levels; scoring is not in it"),
     &RunTotals::cpu_seconds, clock},
    {of_run("lua_s", "s", none,
            "part of cpu_s: functions of guides in Lua with what they call, and loading their script. Calls are timed "
            "by the wall clock, so it is their share of time_s, times cpu_s"),
     &RunTotals::lua_seconds, clock},
    {of_run("set_up_s", "s", less, "part of time_s: the time to set up the guides"), &RunTotals::set_up_seconds, clock},
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

std::span<const MeasureQuantity> measure_quantities() { return of_measure; }

std::span<const RunQuantity> run_quantities() { return of_runs; }

std::vector<Quantity> quantities() {
  std::vector<Quantity> all(of_runs.begin(), of_runs.end());
  all.insert(all.end(), of_teams.begin(), of_teams.end());
  all.insert(all.end(), of_measure.begin(), of_measure.end());
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
