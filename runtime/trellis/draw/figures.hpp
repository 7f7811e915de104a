// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/draw/chart.hpp>

/// The two pictures of the measure, from plain numbers; plot() draws them. A missing value is NaN.
namespace trellis::draw {

struct WaterfallStep {
  std::string label{};
  double value = std::numeric_limits<double>::quiet_NaN();  ///< nats
  double lo = std::numeric_limits<double>::quiet_NaN();     ///< its 95 % interval
  double hi = std::numeric_limits<double>::quiet_NaN();
};

/// The difference between uniform sampling, at 0, and the root's samples, level by level.
struct WaterfallPanel {
  std::string title{};                  ///< "tree", "expansion"
  std::vector<WaterfallStep> levels{};  ///< the nats that each adds; more is better
  WaterfallStep root{.label = "root"};  ///< nats of the root above uniform
};

struct Waterfall {
  std::string title{};
  std::string caption{};
  std::vector<WaterfallPanel> panels{};
};

/// One bar of a waterfall, from one running total to the next, in nats above uniform.
struct WaterfallBar {
  /// `rest`: the part of the root's value that the levels do not explain. `missing`: a level without a value, which
  /// does not change the running total.
  enum class Kind : std::uint8_t { total, gain, loss, rest, missing };

  std::string label{};
  Kind kind = Kind::total;
  double from = 0.0;
  double to = 0.0;
  double lo = std::numeric_limits<double>::quiet_NaN();  ///< the interval, around `to`
  double hi = std::numeric_limits<double>::quiet_NaN();
  std::string text{};  ///< its printed value, with its sign
};

/// Returns the bars: the levels, the rest unless it prints as zero, the root. The first begins at 0, uniform sampling,
/// each other one at the running total of the bars before it; an infinite value does not change the total.
std::vector<WaterfallBar> waterfall_bars(const WaterfallPanel& panel);

/// Panels side by side, or below each other where they have many bars.
Figure waterfall(const Waterfall& waterfall);

/// The distribution along the path of the samples of one strategy, level or role.
struct ProfileSeries {
  std::string name{};
  std::vector<double> share{};  ///< of the samples, per bin: the mean over the runs, not smoothed
  std::vector<double> lo{};     ///< its interval; empty: none
  std::vector<double> hi{};
  std::optional<Colour> colour{};  ///< else a colour of the palette, by name
};

struct ProfilePanel {
  std::string title{};
  std::vector<double> edges{};   ///< of the bins, along the path: one more than there are bins
  std::vector<double> target{};  ///< the target's share of each bin
  std::vector<ProfileSeries> series{};
};

struct Profile {
  std::string title{};
  std::string caption{};
  std::string x_label = "place along the path (share of its length)";
  std::vector<ProfilePanel> panels{};
};

/// Strips above the panel mark the target's bins without a sample of a series; shading marks those without a sample of
/// any series.
Figure profile(const Profile& profile);

}  // namespace trellis::draw
