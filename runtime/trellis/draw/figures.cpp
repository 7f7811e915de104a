// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/figures.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/draw/text.hpp>

namespace trellis::draw {

namespace {

using Kind = WaterfallBar::Kind;

constexpr int decimals = 2;
/// Half of the last printed digit.
constexpr double vanishing = 0.005;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

WaterfallBar total(const WaterfallStep& step) {
  return {step.label,
          std::isnan(step.value) ? Kind::missing : Kind::total,
          0.0,
          std::isnan(step.value) ? 0.0 : step.value,
          step.lo,
          step.hi,
          signed_text(step.value, decimals)};
}

/// The bars of one kind, as a series of the chart.
Series bars_of(const std::vector<WaterfallBar>& bars, Kind kind, std::string name, const Colour& colour) {
  Series series{.kind = Series::Kind::bars, .name = std::move(name), .colour = colour};
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const WaterfallBar& bar = bars[i];
    if (bar.kind != kind) continue;
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(kind == Kind::missing ? not_a_number : bar.to);
    series.lo.push_back(bar.lo);
    series.hi.push_back(bar.hi);
    series.base.push_back(bar.from);
    series.text.push_back(bar.text);
  }
  return series;
}

/// Returns the marked bins, with adjacent bins merged.
std::vector<std::pair<double, double>> stretches(const std::vector<double>& edges, const std::vector<bool>& marked) {
  std::vector<std::pair<double, double>> found;
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (!marked[i]) continue;
    if (i > 0 && marked[i - 1]) {
      found.back().second = edges[i + 1];
    } else {
      found.emplace_back(edges[i], edges[i + 1]);
    }
  }
  return found;
}

}  // namespace

std::vector<WaterfallBar> waterfall_bars(const WaterfallPanel& panel) {
  std::vector<WaterfallBar> bars;
  double running = 0.0;
  for (const auto& level : panel.levels) {
    const double change = level.value;
    if (std::isnan(change)) {
      bars.push_back(
          {level.label, Kind::missing, running, running, not_a_number, not_a_number, number_text(change, decimals)});
      continue;
    }
    const double to = running + change;
    bars.push_back({level.label, change < 0.0 ? Kind::loss : Kind::gain, running, to, running + level.lo,
                    running + level.hi, signed_text(change, decimals)});
    if (std::isfinite(to)) running = to;
  }
  if (std::isfinite(panel.root.value)) {
    const double change = panel.root.value - running;
    if (std::abs(change) >= vanishing) {
      bars.push_back(
          {"rest", Kind::rest, running, panel.root.value, not_a_number, not_a_number, signed_text(change, decimals)});
    }
  }
  bars.push_back(total(panel.root));
  return bars;
}

Figure waterfall(const Waterfall& waterfall) {
  Figure figure{.title = waterfall.title, .caption = waterfall.caption, .share_y = true};
  std::size_t most = 0;
  double largest = 0.0;
  for (const auto& source : waterfall.panels) {
    const auto bars = waterfall_bars(source);
    most = std::max(most, bars.size());
    for (const auto& bar : bars) {
      for (const double end : {bar.from, bar.to, bar.lo, bar.hi}) {
        if (std::isfinite(end)) largest = std::max(largest, std::abs(end));
      }
    }
    Panel panel{.title = source.title};
    panel.y.label = "above uniform sampling (nats, more is better)";
    for (const auto& bar : bars) panel.x.categories.push_back(bar.label);
    panel.series = {bars_of(bars, Kind::total, "above uniform", palette::total),
                    bars_of(bars, Kind::gain, "added", palette::gain), bars_of(bars, Kind::loss, "lost", palette::loss),
                    bars_of(bars, Kind::rest, "not explained by the levels", palette::rest),
                    bars_of(bars, Kind::missing, "", palette::muted)};
    // A kind without a bar has no legend entry.
    std::erase_if(panel.series, [](const Series& s) { return s.y.empty(); });
    for (std::size_t i = 0; i + 1 < bars.size(); ++i) {
      const double level = std::isfinite(bars[i].to) ? bars[i].to : bars[i].from;
      const auto x = static_cast<double>(i);
      panel.connectors.push_back({{x + 0.33, level}, {x + 0.67, level}});
    }
    figure.panels.push_back(std::move(panel));
  }
  // Where nothing adds anything, the bars show that, not how it was rounded.
  constexpr double least = 0.5;
  if (largest < least) {
    for (Panel& panel : figure.panels) {
      panel.y.lo = -least;
      panel.y.hi = least;
    }
  }
  constexpr std::size_t side_by_side = 7;
  figure.columns = most <= side_by_side ? 2 : 1;
  figure.panel_height = 170.0;
  return figure;
}

Figure profile(const Profile& profile) {
  Figure figure{.title = profile.title, .caption = profile.caption};
  // One name has one colour in all panels.
  std::vector<std::string> names;
  const auto colour_of = [&](const ProfileSeries& series) {
    if (series.colour) return *series.colour;
    const auto at = std::find(names.begin(), names.end(), series.name);
    const auto index = static_cast<std::size_t>(at - names.begin());
    if (at == names.end()) names.push_back(series.name);
    return palette::nth(index);
  };
  for (const auto& source : profile.panels) {
    Panel panel{.title = source.title};
    panel.x.label = profile.x_label;
    panel.y.label = "share per bin (%)";
    panel.y.lo = 0.0;
    const auto percent = [](std::vector<double> shares) {
      for (double& share : shares) share *= 100.0;
      return shares;
    };
    const std::size_t bins = source.target.size();
    if (source.edges.size() != bins + (bins > 0 ? 1 : 0)) {
      throw Fault(fmt::format("a profile of {} bins has {} edges", bins, source.edges.size()));
    }
    std::vector<bool> blind(bins, !source.series.empty());
    for (const auto& s : source.series) {
      if (s.share.size() != bins)
        throw Fault(fmt::format("a profile's series '{}' has other bins than its target", s.name));
      const Colour colour = colour_of(s);
      panel.series.push_back({.kind = Series::Kind::steps,
                              .name = s.name,
                              .x = source.edges,
                              .y = percent(s.share),
                              .lo = percent(s.lo),
                              .hi = percent(s.hi),
                              .colour = colour});
      std::vector<bool> empty(bins);
      for (std::size_t i = 0; i < bins; ++i) {
        empty[i] = s.share[i] == 0.0 && source.target[i] > 0.0;
        blind[i] = blind[i] && empty[i];
      }
      panel.lanes.push_back({fmt::format("no samples: {}", s.name), colour, stretches(source.edges, empty)});
    }
    for (const auto& [from, to] : stretches(source.edges, blind)) {
      panel.shades.push_back({from, to, "no samples at all"});
    }
    panel.series.push_back({.kind = Series::Kind::steps,
                            .name = "target",
                            .x = source.edges,
                            .y = percent(source.target),
                            .colour = palette::target,
                            .dash = Dash::dashed,
                            .width = 1.3});
    figure.panels.push_back(std::move(panel));
  }
  // Without empty bins, the strips would be empty space.
  const bool complete = std::all_of(figure.panels.begin(), figure.panels.end(), [](const Panel& p) {
    return std::all_of(p.lanes.begin(), p.lanes.end(), [](const Lane& lane) { return lane.stretches.empty(); });
  });
  for (auto& panel : figure.panels) {
    if (complete) panel.lanes.clear();
  }
  // Panels share an axis for shares of a path's length, but not for metres along different paths.
  const auto ends = [](const ProfilePanel& p) {
    return p.edges.empty() ? std::pair(0.0, 0.0) : std::pair(p.edges.front(), p.edges.back());
  };
  figure.share_x = std::all_of(profile.panels.begin(), profile.panels.end(),
                               [&](const ProfilePanel& p) { return ends(p) == ends(profile.panels.front()); });
  figure.columns = figure.panels.size() > 1 ? 2 : 1;
  figure.panel_height = 120.0;
  figure.legend = Legend::above;
  return figure;
}

}  // namespace trellis::draw
