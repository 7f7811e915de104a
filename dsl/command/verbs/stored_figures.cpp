// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/verbs/stored_figures.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <dsl/command/figure_options.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/base/error.hpp>
#include <trellis/figures/charts/costs_figures.hpp>
#include <trellis/figures/charts/figures.hpp>
#include <trellis/figures/charts/pictures.hpp>
#include <trellis/figures/html.hpp>
#include <trellis/pictures/stored_samples.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/records.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

/// In the order of stored_figure_names().
enum class Kind : std::uint8_t {
  success,
  length,
  ratios,
  sweep,
  correlation,
  waterfall,
  profile,
  strip,
  plane,
  waterfalls
};

bool draws(const StoredFigureOptions& options, Kind kind) {
  return !options.figure || static_cast<Kind>(*options.figure) == kind;
}

/// The runs of a strategy on a problem.
struct Plotted {
  std::string strategy;
  bool ablation = false;
  RunsSummary runs;
};

/// What the documents contain.
struct Stored {
  CostData costs;
  /// By problem, in the documents' order; none that two documents have both.
  std::map<std::string, std::vector<Plotted>> summaries;
  std::vector<std::string> repeated;  ///< "nested on cup", in two documents

  /// \param figure  the one asked for; none: all
  void add(const std::string& file, const std::optional<std::size_t>& figure) {
    const ExperimentFacts facts = read_document(file);
    if (figure && *figure >= static_cast<std::size_t>(Kind::waterfall)) require_format(facts, file);
    ExperimentSummary summary = summarise(facts);
    costs.add(facts, summary, file);
    if (facts.format != document_format) {
      if (facts.measured && !figure) {
        print_message(fmt::format("note: {}: its figures of the measure are left out: trellis {} wrote it in format {}",
                                  file, facts.version, facts.format));
      }
      return;
    }
    for (ProblemSummary& problem : summary.problems) {
      std::vector<Plotted>& there = summaries[problem.problem];
      for (std::size_t s = 0; s < problem.strategies.size(); ++s) {
        StrategySummary& one = problem.strategies[s];
        if (std::any_of(there.begin(), there.end(),
                        [&](const auto& other) { return other.strategy == one.strategy; })) {
          repeated.push_back(fmt::format("{} on {}", one.strategy, problem.problem));
        } else {
          there.push_back({one.strategy, !summary.strategies[s].ablation.empty(), std::move(one.runs)});
        }
      }
    }
  }
};

/// Draws figures into a folder, and lists the files without their endings.
class Plotter {
 public:
  Plotter(const StoredFigureOptions& options, FigureStyle style) : options_(options), style_(style) {}

  void comparisons(const CostData& data, const std::string& baseline) {
    for (std::size_t p = 0; p < data.problems.size(); ++p) {
      const std::filesystem::path place = folder(data.problems[p].name);
      if (draws(options_, Kind::success)) draw(success_figure(data, baseline, p, style_), place / "success");
      if (draws(options_, Kind::length)) draw(length_figure(data, baseline, p, style_), place / "length");
      if (draws(options_, Kind::ratios)) draw(ratio_figure(data.on(p), baseline, style_), place / "ratios");
    }
    if (draws(options_, Kind::ratios) && data.problems.size() > 1) {
      draw(ratio_figure(data, baseline, style_), std::filesystem::path(options_.folder) / "ratios");
    }
    if (draws(options_, Kind::sweep)) sweeps(data, baseline);
    if (draws(options_, Kind::correlation)) {
      draw(correlation_figure(data, baseline), std::filesystem::path(options_.folder) / "correlation");
    }
  }

  /// Draws the figures of the measure.
  void measures(const std::string& problem, const std::vector<Plotted>& summaries) {
    Directories strategies;
    std::vector<NamedSummary> named;
    for (const Plotted& one : summaries) {
      const std::filesystem::path place = folder(problem) / strategies(one.strategy);
      if (!one.ablation) named.push_back({one.strategy, &one.runs});
      const StrategyFigures figures = strategy_figures(problem, one.strategy, one.runs);
      if (draws(options_, Kind::waterfall)) draw(figures.waterfall, place / "waterfall");
      if (draws(options_, Kind::profile)) draw(figures.profile, place / "profile");
      if (draws(options_, Kind::strip)) draw(figures.strip, place / "strip");
      if (draws(options_, Kind::plane)) draw(figures.plane, place / "plane");
    }
    if (draws(options_, Kind::waterfalls)) draw(waterfalls_figure(problem, named), folder(problem) / "waterfalls");
  }

  [[nodiscard]] const std::vector<std::string>& stems() const { return stems_; }

 private:
  std::filesystem::path folder(const std::string& problem) {
    return std::filesystem::path(options_.folder) / directories_(problem);
  }
  void sweeps(const CostData& data, const std::string& baseline) {
    const auto draw_all = [&](const CostData& of, const std::filesystem::path& place) {
      const auto figures = sweep_figures(of, baseline, style_);
      for (std::size_t i = 0; i < figures.size(); ++i) draw(std::optional(figures[i]), place / sweep_name(i));
    };
    for (std::size_t p = 0; p < data.problems.size(); ++p) draw_all(data.on(p), folder(data.problems[p].name));
    if (data.problems.size() > 1) draw_all(data, options_.folder);
  }
  template <class F>
  void draw(const std::optional<F>& figure, const std::filesystem::path& stem) {
    if (!figure) return;
    make_directory(stem.parent_path().string());
    stems_.push_back(stem.string());
    write_figure(*figure, style_, stems_.back());
  }

  const StoredFigureOptions& options_;
  FigureStyle style_;
  Directories directories_;
  std::vector<std::string> stems_;
};

/// Why a figure was not drawn.
std::string nothing_text(const StoredFigureOptions& options) {
  if (!options.figure) return "--figures: the files have no run with a path, so there is nothing to draw";
  const std::string name = "--figure " + stored_figure_names()[*options.figure];
  switch (static_cast<Kind>(*options.figure)) {
    case Kind::success:
    case Kind::ratios: return name + ": the files have no run with a path, so there is nothing to draw";
    case Kind::length: return name + ": no strategy of the files improves its path, so there is nothing to draw";
    case Kind::sweep: return name + ": no three strategies of the files differ in one number of one option alone";
    case Kind::correlation:
      return name +
             ": the files do not have two problems with three scored strategies with guides and a cost beside the "
             "baseline's, so there is nothing to draw";
    case Kind::plane: return name + ": the files have no scored strategy with a guide, so there is nothing to draw";
    case Kind::waterfalls:
      return name + ": no problem of the files has two scored strategies with guides, so there is nothing to draw";
    default: return name + ": the files have no scored strategy, as of `measure = false` or of a sweep";
  }
}

std::string chosen_baseline(const CostData& data, const StoredFigureOptions& options) {
  std::string name = options.baseline.empty() ? data.reference() : options.baseline;
  std::vector<std::string> known;
  for (const CostData::Strategy& strategy : data.strategies) known.push_back(strategy.name);
  if (!name.empty() && std::find(known.begin(), known.end(), name) == known.end()) {
    throw Error(fmt::format("--baseline: there is no strategy '{}'{}; there are: {}", name, did_you_mean(name, known),
                            fmt::join(known, ", ")));
  }
  return name;
}

}  // namespace

const std::vector<std::string>& stored_figure_names() {
  static const std::vector<std::string> names = {"success",   "length",  "ratios", "sweep", "correlation",
                                                 "waterfall", "profile", "strip",  "plane", "waterfalls"};
  return names;
}

void draw_stored_figures(const StoredFigureOptions& options, const FigureStyle& style) {
  Stored stored;
  const bool measured = !options.figure || *options.figure >= static_cast<std::size_t>(Kind::waterfall);
  for (const std::string& file : options.files) stored.add(file, options.figure);
  stored.costs = stored.costs.without_ablations();
  const std::string baseline = chosen_baseline(stored.costs, options);
  if (options.figure && draws(options, Kind::ratios) && baseline.empty()) {
    throw Error("--figure ratios: the files have one strategy, so there is nothing to compare it with");
  }
  if (measured && !stored.repeated.empty()) {
    const std::string text =
        fmt::format("{} is in several files, whose efficiencies do not add up; draw the figures of each file by itself",
                    stored.repeated.front());
    if (options.figure) throw Error("--figure " + stored_figure_names()[*options.figure] + ": " + text);
    print_message(fmt::format("note: {}", text));
  }
  OutputFolder out(options.folder);
  Plotter plotter(options, style);
  plotter.comparisons(stored.costs, baseline);
  if (measured && stored.repeated.empty()) {
    for (const CostData::Problem& problem : stored.costs.problems) {
      plotter.measures(problem.name, stored.summaries[problem.name]);
    }
  }
  if (plotter.stems().empty()) throw Error(nothing_text(options));
  out.keep();
  for (const std::string& stem : plotter.stems()) print_all(fmt::format("{}.svg, .png, .pdf\n", stem));
}

void write_stored_page(const std::vector<std::string>& files, const std::string& file) {
  if (files.size() != 1) {
    throw Error("--html: the page is of one document, whose efficiencies it shows; those of several do not add up");
  }
  require_writable_file(file);
  const ExperimentFacts facts = read_document(files.front());
  require_format(facts, files.front());
  std::optional<StoredSamples> samples;
  if (!facts.samples.empty()) {
    samples.emplace((std::filesystem::path(files.front()).parent_path() / facts.samples).string(), facts);
  }
  write_html(facts, summarise(facts), samples ? &*samples : nullptr, file, {.document = files.front()});
}

}  // namespace trellis::command
