// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/draw/canvas.hpp>

/// Heat strips: shares of samples along an axis relative to those of a target, a strip for each set of samples.
namespace trellis::draw {

struct Strip {
  std::string name{};
  std::vector<double> edges{};   ///< of the bins: one more than there are bins
  std::vector<double> share{};   ///< of the samples, per bin
  std::vector<double> target{};  ///< the target's share of each bin
};

struct StripFigure {
  std::string title{};
  std::string caption{};
  std::string x_label{};
  std::vector<Strip> strips{};  ///< from the top
  double width = 504.0;         ///< points
};

/// Returns the colour of a bin: white where the samples have the target's share, `palette::loss` where they have less
/// and grey where they have more, saturated at a quarter and at four times. A bin without target has no ratio: the
/// colour of the paper.
Colour strip_colour(double share, double target);

/// Draws a figure on white. All strips share one axis. A cross marks a bin of the target without any sample. The strips
/// and texts determine the height. \throws Fault for a strip whose vectors have different lengths.
Canvas plot(const StripFigure& figure);

}  // namespace trellis::draw
