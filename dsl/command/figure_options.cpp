// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/figure_options.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include <dsl/command/numbers.hpp>
#include <trellis/base/error.hpp>
#include <trellis/report/latex.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

constexpr double least_column = 60.0;  ///< mm; names and numbers require this width
constexpr double most_column = 400.0;

const std::vector<std::string>& formats() {
  static const std::vector<std::string> all = {"markdown", "latex"};
  return all;
}

}  // namespace

FigureStyle figure_style(const FigureOptions& options, bool drawn) {
  FigureStyle style;
  if (const auto column = number_option("--column", options.column, least_column)) {
    if (*column > most_column) {
      throw Error(fmt::format("--column: at most {:g} mm, got {:g}", most_column, *column));
    }
    constexpr double points_per_mm = 72.0 / 25.4;
    style.width = *column * points_per_mm;
  }
  style.titles = !options.untitled;
  if (options.serif) style.typeface = draw::Typeface::serif;
  style.scale_bar = options.scale_bar;
  const bool any = style.width || options.untitled || options.serif || options.scale_bar;
  if (any && !drawn) throw Error("--column, --untitled, --serif and --scalebar: nothing is drawn without a folder");
  return style;
}

void check_format(const FigureOptions& options, bool written) {
  if (options.format.empty()) return;
  const auto& all = formats();
  if (std::find(all.begin(), all.end(), options.format) == all.end()) {
    throw Error(fmt::format("--format: there are {}, got '{}'{}", fmt::join(all, " and "), options.format,
                            did_you_mean(options.format, all)));
  }
  if (!written) throw Error("--format: no table is written without --out");
}

void write_tables(const FigureOptions& options, const std::string& folder, const std::string& markdown) {
  const std::filesystem::path place(folder);
  if (options.format == "latex") {
    write_file((place / "table.tex").string(), latex(markdown));
  } else {
    write_file((place / "table.md").string(), markdown);
  }
}

}  // namespace trellis::command
