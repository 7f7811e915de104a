// SPDX-License-Identifier: GPL-3.0-or-later
// The text of values in reports: the printed one and the page.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <trellis/measure/hitting.hpp>
#include <trellis/measure/statistics.hpp>

namespace trellis {

/// Prints a fixed number of decimals, without "-0.00".
std::string fixed(double x, int decimals, bool sign = false);
/// Prints a median of counts; prints a half only where the count is small. "inf" where most runs are unsolved.
std::string count_text(double x);
/// Returns the decimals of a column of milliseconds, from its largest value.
int decimals_for(double largest);
std::string percent(double share);
/// The share of functions in Lua in per cent: "" for none, "<1" for one that would be rounded to 0.
std::string lua_share_text(double share);
/// Two figures, never an exponent: "0.022", "0.41", "8.4", "94", "1,200"; "∞", "–" for a missing value.
std::string two_figures(double x);
/// A whole number with separators: "51,823"; "∞", "–" for a missing value.
std::string thousands(double x);
/// "1.23 ±0.08", "1.23" without an interval, "-" for a missing value.
std::string interval_text(const Interval& interval, int decimals = 2, bool sign = false);
/// "-0.42…+1.20", the ends of an interval; one number where they print the same.
std::string ends_text(double lo, double hi, bool sign = true);
/// "+1.20 ±0.15", nats of hitting; "-" for a missing value.
std::string hitting_text(const BallHits& hits);
/// "thinnest at 4.2 m of 13.3 m: -0.9 nats [-1.4, -0.4]"; "not shown [-0.3, +0.8]" where the samples show neither that
/// they are rarer than uniform ones at some place nor that they are more frequent everywhere. "" for a missing value.
std::string bottleneck_text(const BallHits& hits, double length);
/// "<0.001", "0.040".
std::string p_text(double p);
/// "0.37 [0.29, 0.52]", a median of ratios; "-" for a missing value, and no brackets without an interval.
std::string ratio_text(const Interval& ratio);
/// "20 runs" where the mean is over all runs, "2 of 20 runs", "2–5 of 20 runs".
std::string averaged_text(std::size_t least, std::size_t most, std::size_t runs);
/// "+20 [-3, +39]", with signs; "-" for a missing value.
std::string range_text(const Interval& interval, int decimals);
/// Milliseconds; "inf" where most runs are unsolved, "-" for a missing value.
std::string milliseconds_text(double seconds, int decimals);
/// "70–99", a share's interval in per cent.
std::string wilson_text(const Interval& success);
std::string plural(std::size_t n, const std::string& noun);
std::string plural_y(std::size_t n, const std::string& stem);
/// "15 seeds (1–15)".
std::string seeds_text(const std::vector<std::uint64_t>& seeds);
/// Shortens a level's name: "shrink { 0.75, resolves = 10 }" becomes "shrink(0.75)", and "robots 1, 2, 5" becomes
/// "3 robots", unless it fits.
std::string short_level(const std::string& name, std::size_t longest);

/// A caveat to a value.
struct Note {
  char mark;
  const char* flag;
  const char* meaning;
};
inline constexpr std::array<Note, 11> notes = {{
    {'c', "censored", "censored: no sample in the target; D is infinite or beyond what so few samples can show"},
    {'b', "below mass bound", "below the mass bound: the estimate is wrong"},
    {'a', "at its bound", "at its bound: the mean of the estimates is beyond what the mass in the target allows"},
    {'p', "partial", "partial: covers clearly less of the target than as many uniform samples would"},
    {'u', "underpowered", "underpowered: as many uniform samples would put fewer than 10 in the target"},
    {'f', "too few samples", "too few samples"},
    {'t', "few in target", "fewer than 300 samples in the target: the bound may be off by more than 0.1"},
    {'l', "lower bound", "at most: from mass and arc length alone, which do not show losses across the path"},
    {'k', "indicative", "indicative: nearest neighbours are far from the truth in so many dimensions"},
    {'w', "covers the space", "the target covers nearly the whole space: there is nothing to show"},
    {'i', "cannot reach", "D is infinite: part of the target is invalid, and these samples never are"},
}};
inline constexpr char median_mark = 'm';
inline constexpr char other_mark = 'x';
char mark_of(const std::string& flag);

}  // namespace trellis
