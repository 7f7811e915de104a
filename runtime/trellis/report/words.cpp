// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/words.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace trellis {

std::string fixed(double x, int decimals, bool sign) {
  std::string text = sign ? fmt::format("{:+.{}f}", x, decimals) : fmt::format("{:.{}f}", x, decimals);
  if (!text.empty() && text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) {
    text.erase(0, 1);
    if (sign) text.insert(0, "+");
  }
  return text;
}

std::string count_text(double x) {
  if (std::isinf(x)) return x > 0.0 ? "inf" : "-inf";
  if (std::isnan(x)) return "-";
  return fixed(x, x < 100 && x != std::floor(x) ? 1 : 0);
}

std::string thousands(double x) {
  if (std::isnan(x)) return "–";
  if (std::isinf(x)) return x > 0.0 ? "∞" : "-∞";
  std::string text = fixed(x, 0);
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  for (std::size_t at = text.size(); at > sign + 3;) text.insert(at -= 3, ",");
  return text;
}

std::string two_figures(double x) {
  if (std::isnan(x) || std::isinf(x)) return thousands(x);
  if (x == 0.0) return "0";
  // 0.995 has the magnitude of 1.0, to which it is rounded.
  const auto magnitude = [](double y) { return static_cast<int>(std::floor(std::log10(std::abs(y)))); };
  const double unit = std::pow(10.0, magnitude(x) - 1);
  const double rounded = std::round(x / unit) * unit;
  const int decimals = 1 - magnitude(rounded * (1.0 + 1e-12));
  return decimals > 0 ? fixed(rounded, decimals) : thousands(rounded);
}

int decimals_for(double largest) {
  if (!std::isfinite(largest) || largest >= 1000) return 0;
  return largest >= 100 ? 1 : (largest >= 1 ? 2 : 3);
}

std::string percent(double share) { return std::isfinite(share) ? fixed(100.0 * share, 0) : "-"; }
std::string lua_share_text(double share) {
  constexpr double least = 0.005;
  if (!(share > 0.0)) return "";
  return share < least ? "<1" : percent(share);
}

std::string interval_text(const Interval& interval, int decimals, bool sign) {
  if (std::isnan(interval.value)) return "-";
  if (std::isinf(interval.value)) return interval.value > 0 ? "inf" : "-inf";
  std::string text = fixed(interval.value, decimals, sign);
  if (std::isfinite(interval.hi)) text += " ±" + fixed(0.5 * (interval.hi - interval.lo), decimals);
  return text;
}

std::string ends_text(double lo, double hi, bool sign) {
  const std::string from = fixed(lo, 2, sign);
  const std::string to = fixed(hi, 2, sign);
  return from == to ? from : from + "…" + to;
}

std::string hitting_text(const BallHits& hits) {
  return interval_text({.value = hits.hitting, .lo = hits.hitting_lo, .hi = hits.hitting_hi}, 2, true);
}

std::string bottleneck_text(const BallHits& hits, double length) {
  if (std::isnan(hits.bottleneck)) return "";
  const std::string ends =
      fmt::format("[{}, {}]", std::isinf(hits.bottleneck_lo) ? "-inf" : fixed(hits.bottleneck_lo, 1, true),
                  fixed(hits.bottleneck_hi, 1, true));
  if (hits.bottleneck_lo <= 0.0 && hits.bottleneck_hi >= 0.0) return "not shown " + ends;
  return fmt::format("thinnest at {} m of {} m: {} nats {}", fixed(hits.at, 1), fixed(length, 1),
                     fixed(hits.bottleneck, 1, true), ends);
}

std::string p_text(double p) { return p < 0.001 ? "<0.001" : fixed(p, 3); }

std::string ratio_text(const Interval& ratio) {
  const auto number = [](double x) {
    return std::isinf(x) ? std::string("inf") : x == 0.0 ? std::string("0") : fixed(x, 2);
  };
  if (std::isnan(ratio.value)) return "-";
  if (std::isnan(ratio.lo)) return number(ratio.value);
  return fmt::format("{} [{}, {}]", number(ratio.value), number(ratio.lo), number(ratio.hi));
}

std::string range_text(const Interval& interval, int decimals) {
  if (std::isnan(interval.value)) return "-";
  std::string value = fixed(interval.value, decimals, true);
  if (std::isnan(interval.lo)) return value;
  return fmt::format("{} [{}, {}]", value, fixed(interval.lo, decimals, true), fixed(interval.hi, decimals, true));
}

std::string milliseconds_text(double seconds, int decimals) {
  if (std::isinf(seconds)) return "inf";
  return std::isnan(seconds) ? "-" : fixed(1000.0 * seconds, decimals);
}

std::string averaged_text(std::size_t least, std::size_t most, std::size_t runs) {
  if (least == runs) return plural(runs, "run");
  const std::string few = least == most ? std::to_string(most) : fmt::format("{}–{}", least, most);
  return fmt::format("{} of {}", few, plural(runs, "run"));
}

std::string plural(std::size_t n, const std::string& noun) {
  return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s");
}

std::string plural_y(std::size_t n, const std::string& stem) {
  return fmt::format("{} {}{}", n, stem, n == 1 ? "y" : "ies");
}

std::string wilson_text(const Interval& success) {
  const bool known = std::isfinite(success.lo) && success.n >= least_for_interval;
  return known ? fmt::format("{}–{} %", percent(success.lo), percent(success.hi)) : "-";
}

std::string seeds_text(const std::vector<std::uint64_t>& seeds) {
  if (seeds.empty()) return "no seeds";
  if (seeds.size() == 1) return fmt::format("1 seed ({})", seeds.front());
  bool consecutive = true;
  for (std::size_t i = 1; i < seeds.size(); ++i) consecutive = consecutive && seeds[i] == seeds[i - 1] + 1;
  return consecutive ? fmt::format("{} seeds ({}–{})", seeds.size(), seeds.front(), seeds.back())
                     : fmt::format("{} seeds", seeds.size());
}

char mark_of(const std::string& flag) {
  const auto* const it = std::find_if(notes.begin(), notes.end(), [&](const Note& n) { return n.flag == flag; });
  return it != notes.end() ? it->mark : other_mark;
}

std::string short_level(const std::string& name, std::size_t longest) {
  if (name.size() <= longest) return name;
  // The level of several robots of a team: "robots 1, 2, 5".
  if (name.starts_with("robots ")) {
    return plural(1UL + static_cast<std::size_t>(std::count(name.begin(), name.end(), ',')), "robot");
  }
  const std::size_t end = name.find_first_of(" ({");
  std::string head = name.substr(0, end);
  if (end == std::string::npos) return head;
  // The first argument, if it is a number.
  const std::size_t from = name.find_first_not_of(" ({", end);
  if (from == std::string::npos) return head;
  const std::string argument = name.substr(from, name.find_first_of(",)} ", from) - from);
  char* rest = nullptr;
  const double number = std::strtod(argument.c_str(), &rest);
  return argument.empty() || *rest != '\0' ? head : fmt::format("{}({:.3g})", head, number);
}

}  // namespace trellis
