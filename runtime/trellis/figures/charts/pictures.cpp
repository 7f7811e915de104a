// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/figures/charts/pictures.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <trellis/report/report.hpp>

namespace trellis {

namespace {

/// Points; narrower figures, as for a column of a paper, stack their panels.
constexpr double narrow = 360.0;

bool is_narrow(const FigureStyle& style) { return style.width && *style.width < narrow; }

template <class Figure>
void write(Figure figure, const FigureStyle& style, const std::string& stem) {
  if (style.width) figure.width = *style.width;
  const draw::TypefaceScope typeface(style.typeface);
  if (style.titles) {
    write_picture(draw::plot(figure), stem);
    return;
  }
  const std::string title = std::exchange(figure.title, "");
  const std::string caption = std::exchange(figure.caption, "");
  write_picture(draw::plot(figure), stem);
  write_file(stem + ".txt", fmt::format("{}\n\n{}\n", title, caption), Flush::none);
}

}  // namespace

void write_picture(const draw::Canvas& canvas, const std::string& stem) {
  write_file(stem + ".svg", canvas.render(draw::Format::svg), Flush::none);
  write_file(stem + ".png", canvas.render(draw::Format::png), Flush::none);
  write_file(stem + ".pdf", canvas.render(draw::Format::pdf), Flush::none);
}

void write_figure(draw::Figure figure, const FigureStyle& style, const std::string& stem) {
  // Panels that are already narrow stay two to a row.
  if (is_narrow(style)) figure.columns = figure.columns > 3 ? 2 : 1;
  write(std::move(figure), style, stem);
}

void write_figure(draw::RatioFigure figure, const FigureStyle& style, const std::string& stem) {
  // Beside the names, only one panel fits.
  if (is_narrow(style) && figure.panels.size() > 1) {
    figure.panels.resize(1);
    for (draw::RatioRow& row : figure.rows) row.panels.resize(1);
  }
  write(std::move(figure), style, stem);
}

void write_figure(draw::StripFigure figure, const FigureStyle& style, const std::string& stem) {
  write(std::move(figure), style, stem);
}

void write_figure(draw::PlanarFigure figure, const FigureStyle& style, const std::string& stem) {
  if (is_narrow(style)) figure.columns = std::min<std::size_t>(figure.columns, 2);
  figure.scale_bar = style.scale_bar;
  write(std::move(figure), style, stem);
}

void write_figure(draw::SpatialFigure figure, const FigureStyle& style, const std::string& stem) {
  if (is_narrow(style)) figure.columns = 1;
  figure.camera.azimuth = style.azimuth.value_or(figure.camera.azimuth);
  figure.camera.elevation = style.elevation.value_or(figure.camera.elevation);
  write(std::move(figure), style, stem);
}

void write_figure(draw::MotionFigure figure, const FigureStyle& style, const std::string& stem) {
  figure.scale_bar = style.scale_bar;
  write(std::move(figure), style, stem);
}

}  // namespace trellis
