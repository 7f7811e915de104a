// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/chart.hpp>
#include <trellis/draw/motion.hpp>
#include <trellis/draw/planar.hpp>
#include <trellis/draw/ratios.hpp>
#include <trellis/draw/spatial.hpp>
#include <trellis/draw/strips.hpp>

namespace trellis {

/// The style of all figures of a command.
struct FigureStyle {
  std::optional<double> width = {};  ///< points; none: each figure's default width
  bool titles = true;                ///< else titles and captions are in a text file beside the figure
  draw::Typeface typeface = draw::Typeface::sans;
  bool scale_bar = false;  ///< below pictures of planar worlds; those of space have axes
  // Of the figures that compare costs: the panels, and the curves in each, beside the baseline's.
  bool checks = true;
  bool seconds = true;
  std::size_t curves = 3;
  // The view of pictures of space, in degrees; none: that of draw::camera_for().
  std::optional<double> azimuth = {};
  std::optional<double> elevation = {};
};

/// Writes STEM.svg, STEM.png and STEM.pdf. \throws Error where it cannot write one.
void write_picture(const draw::Canvas& canvas, const std::string& stem);

/// Draws a figure in a style and writes it as write_picture() does; without titles, also STEM.txt.
void write_figure(draw::Figure figure, const FigureStyle& style, const std::string& stem);
void write_figure(draw::RatioFigure figure, const FigureStyle& style, const std::string& stem);
void write_figure(draw::StripFigure figure, const FigureStyle& style, const std::string& stem);
void write_figure(draw::PlanarFigure figure, const FigureStyle& style, const std::string& stem);
void write_figure(draw::SpatialFigure figure, const FigureStyle& style, const std::string& stem);
void write_figure(draw::MotionFigure figure, const FigureStyle& style, const std::string& stem);

}  // namespace trellis
