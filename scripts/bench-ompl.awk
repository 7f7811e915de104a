# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the tables of scripts/bench-ompl from the RUN lines of both programs (tests/bench/rrt_bench.hpp says what is in
# them). Plain awk, since nothing else is sure to be there.

BEGIN { FS = "\t" }

$1 == "RUN" {
  side = $2 " " $3
  run = side SUBSEP $4 SUBSEP $5
  if (!($4 in known_scene)) { known_scene[$4] = 1; scenes[++scene_count] = $4 }
  if (!(side in known_side)) { known_side[side] = 1; sides[++side_count] = side }
  found = $6 " " $9 " " $10 " " $11
  if (!(run in what)) {
    what[run] = found
    cpu[run] = $7
    planning[run] = $8
    seeds[side, $4] = ++count[side, $4]
    seed[side, $4, count[side, $4]] = $5
  }
  # Times of different searches must not be compared.
  if (what[run] != found) {
    print "bench-ompl: " side ", " $4 ", seed " $5 ": two runs differ" > "/dev/stderr"
    failed = 1
    exit 1
  }
  if ($7 < cpu[run]) cpu[run] = $7
  if ($8 < planning[run]) planning[run] = $8
}

# The value below which a share p of values[1..n] lies, linear between neighbours. Sorts the values.
function quantile(values, n, p,    i, j, v, at, below) {
  for (i = 2; i <= n; ++i) {
    v = values[i]
    for (j = i - 1; j >= 1 && values[j] > v; --j) values[j + 1] = values[j]
    values[j + 1] = v
  }
  at = 1 + p * (n - 1)
  below = int(at)
  return below >= n ? values[n] : values[below] + (at - below) * (values[below + 1] - values[below])
}

function ratio(a, b) { return b > 0 ? sprintf("%.2f", a / b) : "-" }

function ratios(title, value,    i, scene) {
  printf "\n%-42s %16s %16s %16s\n", title, "planar/OMPL fcl", "fcl/OMPL fcl", "planar/OMPL axes"
  for (i = 1; i <= scene_count; ++i) {
    scene = scenes[i]
    printf "%-42s %16s %16s %16s\n", "  " scene, \
      ratio(value["ompl fcl", scene], value["trellis planar", scene]), \
      ratio(value["ompl fcl", scene], value["trellis fcl", scene]), \
      ratio(value["ompl axes", scene], value["trellis planar", scene])
  }
}

END {
  if (failed) exit 1
  printf "%-15s %-15s %7s %9s %9s %9s %8s %7s %11s %9s %9s\n", "scene", "side", "solved", "CPU ms", "p90", \
    "planning", "checks", "nodes", "iterations", "us/iter", "us/check"
  for (i = 1; i <= scene_count; ++i) {
    for (j = 1; j <= side_count; ++j) {
      scene = scenes[i]
      side = sides[j]
      n = seeds[side, scene]
      if (!n) continue
      solved = all_cpu = all_planning = all_iterations = all_checks = 0
      for (k = 1; k <= n; ++k) {
        run = side SUBSEP scene SUBSEP seed[side, scene, k]
        split(what[run], field, " ")
        solved += field[1]
        times[k] = cpu[run]
        plans[k] = planning[run]
        iterations[k] = field[2]
        checks[k] = field[3]
        nodes[k] = field[4]
        all_cpu += cpu[run]
        all_iterations += field[2]
        all_checks += field[3]
      }
      per_iteration[side, scene] = all_cpu / all_iterations
      to_solve[side, scene] = quantile(times, n, 0.5)
      total[side, scene] = all_cpu
      printf "%-15s %-15s %7s %9.3f %9.3f %9.3f %8d %7d %11d %9.3f %9.3f\n", scene, side, solved "/" n, \
        1e3 * to_solve[side, scene], 1e3 * quantile(times, n, 0.9), 1e3 * quantile(plans, n, 0.5), \
        quantile(checks, n, 0.5), quantile(nodes, n, 0.5), quantile(iterations, n, 0.5), \
        1e6 * per_iteration[side, scene], 1e6 * all_cpu / all_checks
    }
  }
  print "CPU ms, planning (on our side wall clock), checks, nodes, iterations: medians; us/iter: all CPU time by all iterations."
  ratios("OMPL's CPU time per iteration by ours", per_iteration)
  ratios("OMPL's median CPU time to solve by ours", to_solve)
  ratios("OMPL's total CPU time by ours", total)
}
