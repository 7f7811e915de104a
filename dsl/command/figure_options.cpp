// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/figure_options.hpp>

#include <fmt/format.h>

#include <filesystem>

#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/views/latex.hpp>

namespace trellis::command {

namespace {

constexpr double least_column = 60.0;  ///< mm; names and numbers require this width
constexpr double most_column = 400.0;
constexpr std::uint64_t most_curves = 100;
constexpr double zenith = 90.0;
constexpr double turn = 360.0;

}  // namespace

void add_figure_options(Subcommand& verb, FigureOptions& options) {
  verb.number("--column", "MM", least_column, options.column,
              "the figures' width, in millimetres, as of a paper's column; below 127 panels stand below each other");
  verb.flag("--untitled", options.untitled,
            "figures without title and caption, which a text file beside each figure has");
  verb.flag("--serif", options.serif, "figures in a typeface with serifs");
  verb.flag("--scalebar", options.scale_bar, "a scale bar below pictures of the world");
  verb.choice("--panels", {"checks", "time", "both"}, options.panels,
              "of figures of costs: validity checks, CPU time or both (default)");
  verb.integer("--curves", "N", 1, most_curves, options.curves,
               "curves in a panel of success and length, beside the baseline's (default 3)");
  verb.choice("--format", {"markdown", "latex"}, options.format,
              "of the tables that --out writes: markdown (default) or latex");
}

void add_view_options(Subcommand& verb, FigureOptions& options) {
  verb.number("--azimuth", "DEGREES", -turn, options.azimuth,
              "of the direction from which pictures of space are seen, from the x axis (default -60)");
  verb.number("--elevation", "DEGREES", -zenith, options.elevation,
              "of this direction above the horizon, to 90 (default 30; more for flat worlds)");
}

FigureStyle figure_style(const FigureOptions& options, bool drawn) {
  FigureStyle style;
  if (options.column) {
    if (*options.column > most_column) {
      throw Error(fmt::format("--column: at most {:g} mm, got {:g}", most_column, *options.column));
    }
    constexpr double points_per_mm = 72.0 / 25.4;
    style.width = *options.column * points_per_mm;
  }
  style.titles = !options.untitled;
  if (options.serif) style.typeface = draw::Typeface::serif;
  style.scale_bar = options.scale_bar;
  style.checks = options.panels.value_or(2) != 1;
  style.seconds = options.panels.value_or(2) != 0;
  style.curves = static_cast<std::size_t>(options.curves.value_or(style.curves));
  style.azimuth = options.azimuth;
  style.elevation = options.elevation;
  if (options.elevation.value_or(0.0) > zenith) {
    throw Error(fmt::format("--elevation must be a number of at most {:g}, got {:g}", zenith, *options.elevation));
  }
  if (options.azimuth.value_or(0.0) > turn) {
    throw Error(fmt::format("--azimuth must be a number of at most {:g}, got {:g}", turn, *options.azimuth));
  }
  if (drawn) return style;
  const bool of_space = options.azimuth || options.elevation;
  if (of_space) throw Error("--azimuth and --elevation: nothing is drawn without a folder");
  if (options.panels || options.curves) throw Error("--panels and --curves: nothing is drawn without a folder");
  const bool any = style.width || options.untitled || options.serif || options.scale_bar;
  if (any) throw Error("--column, --untitled, --serif and --scalebar: nothing is drawn without a folder");
  return style;
}

void check_format(const FigureOptions& options, bool written) {
  if (options.format && !written) throw Error("--format: no table is written without --out");
}

void write_tables(const FigureOptions& options, const std::string& folder, const std::string& markdown) {
  const std::filesystem::path place(folder);
  if (options.format.value_or(0) == 1) {
    write_file((place / "table.tex").string(), latex(markdown));
  } else {
    write_file((place / "table.md").string(), markdown);
  }
}

}  // namespace trellis::command
