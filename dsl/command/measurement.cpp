// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/measurement.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/words.hpp>
#include <trellis/results/quantities.hpp>
#include <trellis/results/records.hpp>

namespace trellis::command {

namespace {

using Json = nlohmann::ordered_json;

/// Returns the default estimator of a space with so many degrees of freedom.
const char* default_estimator(std::size_t degrees) { return degrees < most_across ? "knn" : "arc"; }
constexpr const char* no_density = "the density that the samples were drawn from is not known: a file holds none";

/// Returns notes on possible mistakes in the input.
std::vector<std::string> notes_on(const Space& space, const Configurations& samples) {
  constexpr double many_turns = 4.0;
  std::vector<std::string> notes;
  for (const Factor& factor : space.factors()) {
    if (factor.kind != Factor::Kind::circle) continue;
    const std::size_t j = factor.column;
    const Axis& axis = factor.axis;
    double lo = samples[0][j];
    double hi = lo;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      lo = std::min(lo, samples[i][j]);
      hi = std::max(hi, samples[i][j]);
    }
    const double turns = (hi - lo) / (axis.hi - axis.lo);
    if (turns < many_turns) continue;
    notes.push_back(fmt::format("{} goes from {:g} to {:g}, {:.0f} times around [{:g}, {:g}]: is it in other units?",
                                axis.name, lo, hi, turns, axis.lo, axis.hi));
  }
  return notes;
}

// Document
// -------------------------------------------------------------------------------------------------------------

Json number(double x) {
  if (std::isnan(x)) return nullptr;
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  return x;
}

/// Why the table prints no interval; "" where it does, and without a value.
std::string blank_of(const Efficiency& e) {
  return std::isnan(e.value_lo) ? "" : blank_reason(e.value_lo, e.value_hi, e.uniform);
}

// Table
// ----------------------------------------------------------------------------------------------------------------

std::string figure_text(double x) { return std::isnan(x) ? "-" : fmt::format("{:.3f}", x); }

std::string interval_text(double lo, double hi) {
  return lo == hi ? figure_text(lo) : fmt::format("{:.2f} to {:.2f}", lo, hi);
}

std::string row(std::string_view name, const std::string& text, std::string_view meaning) {
  return fmt::format("  {:<17} {:>13}  {}\n", name, text, meaning);
}
std::string row(std::string_view name, double x, std::string_view meaning) {
  return row(name, figure_text(x), meaning);
}

std::string meaning_of(const std::string& flag) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 10> meanings = {
      {{"underpowered", "as many uniform samples would put fewer than 10 into the target: draw more"},
       {"censored",
        "no sample lies in the target: D_mass_lower95 is all that is known, the rest is what so few leave possible"},
       {"partial", "the samples cover less of the target than as many uniform ones would"},
       {"below mass bound", "D is below what the share of the samples in the target allows: do not believe it"},
       {"lower bound",
        "mass and arc length alone: the divergence is at least this, nats above uniform are at most this"},
       {"indicative", "nearest neighbours are far from the truth in so many dimensions: --estimator arc gives a bound"},
       {"few in target", "fewer than 300 samples lie in the target: the bound may be off by more than 0.1; draw more"},
       {"cannot reach", "part of the target is invalid, and these samples can never be"},
       {"covers the space", "the target covers nearly the whole space: there is nothing to show"},
       {"invalid path", "a configuration of the path is invalid: is 'free' the scene that it was planned in?"}}};
  const auto* const it = std::find_if(meanings.begin(), meanings.end(), [&](const auto& m) { return m.first == flag; });
  return it != meanings.end() ? fmt::format("{}: {}", flag, it->second) : flag;
}

/// Returns a bar for each part of the path, scaled to the highest share of both profiles.
std::string bars(const std::vector<double>& shares, double full) {
  constexpr std::array<std::string_view, 9> blocks = {"·", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  std::string text;
  for (const double share : shares) {
    const auto eighths = static_cast<std::size_t>(std::ceil(8.0 * share / full));
    text += blocks[std::min<std::size_t>(eighths, 8)];
  }
  return text;
}

std::string profile(const Along& along) {
  if (along.target.empty()) return "";
  const double full = std::max(*std::max_element(along.target.begin(), along.target.end()),
                               *std::max_element(along.samples.begin(), along.samples.end()));
  return fmt::format("\n  along the path, start to goal, {} part{} of {:.3g} m\n    target   {}\n    samples  {}\n",
                     along.target.size(), along.target.size() == 1 ? "" : "s",
                     along.length / static_cast<double>(along.target.size()), bars(along.target, full),
                     bars(along.samples, full));
}

}  // namespace

std::vector<EstimatorSpec> measure_estimators(const std::string& asked, std::size_t degrees) {
  std::vector<EstimatorSpec> specs;
  if (asked == "all") {
    for (const auto& kind : measure::estimator_kinds()) specs.push_back(EstimatorSpec::make(kind.component->name));
    const auto first =
        std::find_if(specs.begin(), specs.end(), [&](const auto& s) { return s.name() == default_estimator(degrees); });
    std::rotate(specs.begin(), first, first + 1);
    return specs;
  }
  try {
    specs.push_back(EstimatorSpec::make(asked.empty() ? default_estimator(degrees) : asked));
  } catch (const Error& error) {
    throw Error(fmt::format("{}; all is each of them", error.what()));
  }
  if (asked == "exact") throw Error(fmt::format("exact: {}", no_density));
  return specs;
}

Measurement measure_samples(const Case& c, Configurations samples, const std::vector<EstimatorSpec>& specs) {
  for (std::size_t i = 0; i < samples.size(); ++i) normalise_rotations(c.space, samples[i]);
  const Target target(c.space, c.path, c.position, c.tube, c.valid, c.seed);
  if (target.empty() && !c.valid) {
    throw Error(fmt::format("{}: delta = {:g} is too small for this space: nothing was found within it of the path",
                            c.file, c.tube.delta));
  }
  if (target.empty()) {
    throw Error(
        fmt::format("{}: no valid configuration lies within {:g} of the path: there is no target; examine "
                    "'free' ('{}'), at the path and at delta",
                    c.file, c.tube.delta, c.free));
  }
  Measurement result;
  for (std::size_t i = 0; i < samples.size(); ++i) result.outside += c.space.contains(samples[i]) ? 0 : 1;
  if (result.outside == samples.size()) {
    throw Error(fmt::format("{}: none of the {} samples lies within the bounds of {} (lo, hi)", c.samples,
                            samples.size(), c.file));
  }
  const auto reason_of = [&](const EstimatorSpec& spec) {
    return efficiency(target, samples, {.estimators = {spec}, .density = {}}).reason;
  };
  result.headline = efficiency(target, samples, {.estimators = specs, .density = {}});
  if (result.headline.estimator != specs.front().text() || !result.headline.reason.empty()) {
    throw Error(fmt::format("{}: {} gives no figure: {}", c.samples, specs.front().name(), reason_of(specs.front())));
  }
  result.headline = shown(std::move(result.headline));
  const View goal = std::as_const(c.path).back();
  result.headline.hitting = PathBalls(c.space, c.path, c.position, c.tube.delta).hitting(samples, goal);
  result.log_volume = target.log_volume();
  result.notes = notes_on(c.space, samples);
  for (std::size_t i = 0; c.valid && i < c.path.size(); ++i) {
    if (c.valid(c.path[i])) continue;
    result.headline.flags.emplace_back("invalid path");
    break;
  }
  if (specs.size() == 1) return result;
  for (const EstimatorSpec& spec : specs) {
    Measurement::Answer answer{spec.name(), std::nullopt, ""};
    const auto& others = result.headline.others;
    const auto other =
        std::find_if(others.begin(), others.end(), [&](const Estimate& e) { return e.estimator == spec.text(); });
    if (spec.text() == result.headline.estimator) {
      answer.estimate = result.headline;
    } else if (other != others.end()) {
      answer.estimate = *other;
    } else {
      answer.reason = spec.name() == "exact" ? no_density : reason_of(spec);
    }
    result.answers.push_back(std::move(answer));
  }
  return result;
}

std::string measurement_json(const Case& c, const Measurement& m) {
  const Efficiency& e = m.headline;
  Json json = Json::parse(measured_set(e));
  json["estimator"] = e.estimator;
  json["blank"] = blank_of(e).empty() ? Json(nullptr) : Json(blank_of(e));
  json.erase("others");
  json.erase("reason");
  json["vol_T"] = number(std::exp(m.log_volume));
  json["log_vol_C"] = number(c.space.log_volume());
  json["share_in_target"] = static_cast<double>(e.in_target) / static_cast<double>(e.samples);
  json["outside"] = m.outside;
  json["notes"] = m.notes;
  if (!m.answers.empty()) {
    Json& all = json["estimators"] = Json::object();
    for (const Measurement::Answer& answer : m.answers) {
      Json& one = all[answer.estimator];
      one = Json::parse(estimate_line(answer.estimate.value_or(Estimate{}), e));
      if (!answer.estimate) one["reason"] = answer.reason;
    }
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string measurement_table(const Case& c, const Measurement& m) {
  const Efficiency& e = m.headline;
  const Estimate& figures = e;
  std::string text =
      fmt::format("{}: {} samples {}, {} of them in the target\n", c.samples, e.samples, c.space.name(), e.in_target);
  text += fmt::format("target: {} within {:g} m of the path of {} ({:.3g} m long), {}\n",
                      c.valid ? "the valid configurations" : "the configurations", c.tube.delta, c.file, e.along.length,
                      c.tube.distance == TubeSettings::Distance::planar ? "by position alone" : "in the full metric");
  if (c.valid) text += fmt::format("valid: by '{}', {:.1f} % of the tube\n", c.free, 100.0 * e.free_share);
  if (m.outside > 0) {
    text += fmt::format("outside of the space: {} of the samples; they count, and reach nothing\n", m.outside);
  }
  if (e.repeated > 0) {
    text +=
        fmt::format("repeated: {} of the samples occur more than once; they have mass but no density\n", e.repeated);
  }
  for (const std::string& note : m.notes) text += fmt::format("note: {}\n", note);
  text += fmt::format("estimator: {}\n\n", e.estimator);
  // An interval exists where the target is uniform; the estimates are printed unless it is blank.
  const bool blank = !blank_of(e).empty();
  const bool printed = !blank && !std::isnan(e.value_lo);
  const auto add = [&](const char* name, const std::string& value, const std::string& more = "") {
    const Quantity of = quantity(name);
    const bool first = of.name() == "SE" || of.name() == "above_uniform";
    text += row(name, value, (first ? described(of) : of.meaning) + more);
  };
  add("hitting.nats", figure_text(e.hitting.position.hitting));
  add("hitting.full", figure_text(e.hitting.full.hitting));
  if (const std::string place = bottleneck_text(e.hitting.position, e.hitting.length); !place.empty()) {
    text += row("bottleneck", "", place);
  }
  if (printed) {
    add("SE", interval_text(e.value_lo, e.value_hi));
    add("above_uniform", interval_text(e.uniform - e.value_hi, e.uniform - e.value_lo));
  } else if (blank) {
    add("SE", "", fmt::format(": {} ({} to {})", blank_of(e), figure_text(e.value_lo), figure_text(e.value_hi)));
  }
  if (!blank) {
    text += row("estimate", figures.value,
                fmt::format("SE by {}{}", e.estimator,
                            e.estimator.starts_with("exact") ? "" : ", if the samples show all of the distribution"));
  }
  text += row("  mass", figures.parts.mass, "of it: how seldom a sample lies in the target");
  if (!blank) {
    text += row("  spread", figures.parts.spread, "of it: how unevenly those that do cover the target");
    text += row("    along", figures.parts.along, "of the spread: along the path");
    text += row("    across", figures.parts.across, "of the spread: across it; none from 5 dimensions");
  }
  add("D_uniform", figure_text(e.uniform));
  add("D_perfect", figure_text(e.perfect));
  if (!blank) add("D", figure_text(figures.unregularised));
  add("D_mass", figure_text(e.mass),
      fmt::format("; 95 % interval: {} to {}{}", figure_text(e.mass_lo), figure_text(e.mass_hi),
                  e.repeated > 0 ? "; repeated samples count" : ""));
  add("D_mass_lower95", figure_text(e.mass_lower95));
  add("along.D", figure_text(e.along.divergence));
  add("along.empty_share", figure_text(e.along.empty_share));
  add("coverage", figure_text(e.coverage));
  text += profile(e.along);
  if (!m.answers.empty()) {
    text += fmt::format("\n  {:<10} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "estimator", "SE", "mass", "spread", "D",
                        "above_uniform");
    for (const Measurement::Answer& answer : m.answers) {
      if (!answer.estimate) {
        text += fmt::format("  {:<10} none: {}\n", answer.estimator, answer.reason);
        continue;
      }
      const Estimate& estimate = *answer.estimate;
      text += fmt::format("  {:<10} {:>9} {:>9} {:>9} {:>9} {:>9}\n", answer.estimator, figure_text(estimate.value),
                          figure_text(estimate.parts.mass), figure_text(estimate.parts.spread),
                          figure_text(estimate.unregularised), figure_text(estimate.above_uniform));
    }
  }
  if (!e.flags.empty()) text += '\n';
  for (const std::string& flag : e.flags) text += fmt::format("  ! {}\n", meaning_of(flag));
  return text;
}

}  // namespace trellis::command
