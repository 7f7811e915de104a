// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/views/glossary.hpp>

#include <trellis/results/quantities.hpp>

namespace trellis {

const std::vector<ReportTerm>& report_terms() {
  static const std::vector<ReportTerm> terms = {
      {"baseline",
       "the strategy that the others are compared with: the experiment's `baseline`, else the first strategy without a "
       "guide, else the first"},
      {"solved", "runs that found a path, of all runs; at least so many (≥) where runs without a guide were cut off"},
      {"validity checks",
       "collision checks of single configurations, summed over all levels; the median over the runs, an unsolved run "
       "infinite"},
      {"checks",
       "validity checks until the first path, the median, with a bar; none: most runs found no path. The baseline "
       "comes "
       "first, then the strategies by their ratio, in several problems by its geometric mean"},
      {"ratio",
       "of the checks, the median over the seeds with its 95 % interval: of a strategy to the baseline; of a row "
       "`without` a guide to the whole strategy, so that the guide pays above 1"},
      {"motion checks", "checked motions between two configurations; each takes several validity checks"},
      {"ms", "milliseconds: set-up and planning of all levels, without scoring; the median over the runs"},
      {"path", "length of the path in the metric of C, metres; the mean over the solved runs"},
      {"p",
       "sign test, paired by seed, corrected by Holm over the comparisons shown: the chance of so clear a difference "
       "if "
       "there were none"},
      {"share", "this level's part of what all runs spent in all levels, in per cent"},
      {"nats", "the unit of divergences: natural logarithms"},
      {"hitting",
       "how much sooner than uniform samples these hit the balls along a path in turn, nats: the log ratio of the "
       "expected numbers of samples. 0 is uniform sampling, more is better. Guides with more of it mostly need fewer "
       "checks; with less SE they do not. By position, and in the full metric, where a wrong heading does not score. "
       "All strategies are compared by as many samples, on paths that other seeds found"},
      {"bottleneck",
       "the place on that path where samples are rarest beside uniform ones, and log of the ratio there with its 95 % "
       "interval. Not shown: the samples show neither that they are rarer somewhere nor that they are more frequent "
       "everywhere"},
      {"SE",
       "sampling efficiency of the paper, SE_T(Q) = D(T||Q), Kullback-Leibler: how unlike the target T the samples Q "
       "are, in nats, with 5 % uniform samples mixed in, so that it is finite; lower is better"},
      {"target", "T: uniform on a tube around the path found, unless the experiment's `measure` says otherwise"},
      {"above uniform",
       "SE of uniform sampling minus that of the samples, nats: + is better than uniform sampling, 0 is "
       "uniform sampling, the most is perfect guidance"},
      {"mass",
       "the part of SE that says how often a sample lies in the target: -log Q(T). It is counted, and "
       "exact"},
      {"spread",
       "the part of SE that says how evenly the samples in the target cover it: D(T || Q given T). Mass "
       "and "
       "spread sum to SE"},
      {"-0.42…+1.20",
       "an interval of nats above uniform that holds the truth with at least 95 %, as samples of known density show: "
       "docs/measure.md. Counting certifies its upper end; the lower end allows for what so many samples cannot show. "
       "Over runs: the mean of the runs' ends with Student's interval"},
      {"blank",
       "too few samples: the interval is wider than 1 nat and does not show on which side of uniform sampling they "
       "are"},
      {"proposals, nodes",
       "nats above uniform of what the level's guide and planner propose, lifted to the root, and of the nodes of its "
       "tree: of all seeds together where there are five or more. Proposals whose densities are known in closed form "
       "are exact: no estimation, whatever their number"},
      {"along", quantity("SE_parts.along").meaning},
      {"across", quantity("SE_parts.across").meaning},
      {"verdict",
       "whether a level pays: an experiment, the strategy with and without it on the same seeds, unscored. The guides "
       "of the level take its place. After each seed a sequential test decides, so that seeds may be added until it "
       "does: at most 5 % of a strategy's tests on a problem ever get a wrong direction. `--ablation` sets how much "
       "work that may take"},
      {"pays",
       "verdict: with the level the strategy costs less. × is the ratio of its validity checks to those without the "
       "level, the median over the seeds, with its 95 % interval, which holds at any number of seeds. A run without "
       "the level is cut off at twice the checks of the run with it: then the ratio is 0.5 or less"},
      {"costs", "verdict: with the level the strategy costs more; the ratio is above 1"},
      {"no difference",
       "verdict: the ratio is between 1/1.25 and 1.25. Changes nothing: each run costs as much as the one without"},
      {"not shown",
       "verdict: the runs show neither. The budget is spent, or so many seeds would show it with a probability of "
       "80 %, if there are at most 200"},
      {"not tested", "verdict: the strategy was not run without the level, or cannot be set up without it"},
      {"never set up", "verdict: the planner solved the problem in all runs before the guides were set up"},
      {"keep it, drop it",
       "verdict of a row that is the strategy without a guide: it costs more without it, or less. `keep 2, drop 1 of "
       "6` "
       "counts problems"},
      {"hardly matters", "verdict: the difference is shown, and below 10 %"},
      {"~", "no difference is shown"},
      {"cheaper, 10 … 90 %",
       "of many problems: runs with fewer checks than the baseline's, and the range of the ratios without their lowest "
       "and highest tenth"},
      {"why",
       "how many times as many of a strategy's nodes lie in the target as of uniform samples, on the paths of other "
       "seeds, where the runs show it"},
      {"(mass), (spread)",
       "beside a verdict: the part of SE that the level's samples reduce most (where it pays) or increase "
       "(where it costs). It explains the verdict and does not decide it"},
      {"after the first path", "checks that an anytime planner, such as rrt_star, spends on shorter paths"},
      {"set-up",
       "time and work to set up the guides for one run alone, as the medial axis of the world; work in units of 0.07 "
       "us, "
       "the median over the "
       "runs. It is listed where it is more than a tenth of a run's work. The runs of a process share what "
       "depends on the world alone: the first one spends its time, and the median of the times does not show it. Work "
       "counts one part in `queries` of it: so many runs share it, by assumption. `trellis run --once` shares nothing"},
      {"Lua %, functions in Lua",
       "the part of the CPU time that functions in Lua take, with what they call and loading their script, in per "
       "cent. It is listed where a guide has such functions"},
      {"oracle", "samples drawn from the target itself, perfect guidance: what the estimator makes of them"},
      {"tree", "nodes of the search; of a roadmap, those that were checked"},
      {"expansion", "what was proposed, before extension: samples of h"},
      {"level solved", "runs in which the level found a path of its own"},
      {"re-solves", "how often the level was solved again, for another path or in a changed world"},
      {"proposals", "samples that the level's planner drew"},
      {"nodes", "nodes of the level's tree or roadmap"},
      {"guided",
       "by guided proposals: checks of motions towards what the guide proposed, and of the guiding path's validation"},
      {"unguided", "by unguided proposals: uniform ones and the goal"},
      {"levels below", "by the levels that guide this one"},
      {"N", "samples that are scored, the median over the runs"},
      {"in target", "samples that lie in the target, the median over the runs"},
      {"D", quantity("D").meaning},
      {"D at least", quantity("D_mass_lower95").meaning},
      {"empty", quantity("along.empty_share").meaning},
      {"covered", quantity("coverage").meaning},
      {"own path", "scored on the path of the same run"},
      {"other seeds", "scored on paths that other seeds found, which no run can fit its samples to"},
      {"all seeds together",
       "samples of all seeds but one, scored together on that one's path: with five seeds or more the first figure of "
       "a "
       "report, because it is what published figures average and because more samples show how thin they are"},
      {"single runs differ",
       "the interval over the runs and that of all seeds together exclude each other: together they cover what each "
       "run misses"},
  };
  return terms;
}

}  // namespace trellis
